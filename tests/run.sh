#!/bin/sh
# run.sh JOBS PROGRAM...: runs the test programs JOBS at a time and prints the sum of their cases at the very end as "N passed,
# N failed". Of a program in which all is well it prints the summary line, and before it what was SKIPPED; of any other one, and
# with MCS_TEST_VERBOSE=1 of each, it prints the whole output in one piece. The exit status is not 0 when a case failed, and when a
# program crashed, ended without its summary line or ran no case (with FILTER set, single programs may run none, but not all of
# them).
# Before the sum it says how long it took, since BEGAN if that is set, and where the programs are: in BUILD/tests.
# FILTER and SEED are handed to every program as --filter and --seed. Programs in a folder stress run at MCS_STRESS_SCALE, 0.002.
set -u
jobs=$1 began=${BEGAN:-$(date +%s)}
shift
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
trap 'exit 1' HUP INT TERM

# Every worker walks the whole list; mkdir, being atomic, decides who takes a program. Prints the index of each one that ended.
worker() {
    i=0
    for program in "$@"; do
        i=$((i + 1))
        mkdir "$tmp/$i" 2>/dev/null || continue
        {
            case $program in */*) ;; *) program=./$program ;; esac
            ( # the scale is that of this program alone
                case $program in */stress/*) export MCS_TEST_SCALE="${MCS_STRESS_SCALE:-0.002}" ;; esac
                "$program" ${FILTER:+--filter "$FILTER"} ${SEED:+--seed "$SEED"}
            )
            echo $? >"$tmp/$i/status"
        } >"$tmp/$i/output" 2>&1
        echo "$i $program"
    done
}

fail() {
    echo "FAIL $1"
    failed=$((failed + 1))
}

verbose() { case ${MCS_TEST_VERBOSE:-0} in 0) return 1 ;; *) return 0 ;; esac; }

# What is wrong with a program, one line each, but for its failed cases.
complaints() { # PROGRAM STATUS SUMMARY PASSED FAILED
    if [ -z "$3" ]; then
        echo "$1: no summary line, exit status $2"
    elif [ "$4" = 0 ] && [ "$5" = 0 ]; then
        if [ -z "${FILTER:-}" ]; then echo "$1: ran no case"; elif [ "$2" -gt 1 ]; then echo "$1: exit status $2"; fi
    elif [ "$5" = 0 ] && [ "$2" != 0 ]; then
        echo "$1: every case passed, yet exit status $2"
    fi
}

# Reads the indices and adds the programs up.
report() {
    passed=0 failed=0 ended=0
    while read -r i program; do
        ended=$((ended + 1))
        output=$tmp/$i/output
        status=$(cat "$tmp/$i/status")
        summary=$(sed -n 's/^.*: \([0-9][0-9]*\) passed, \([0-9][0-9]*\) failed, [0-9.]* s$/\1 \2/p' "$output" | tail -n 1)
        p=${summary% *} f=${summary#* }
        wrong=$(complaints "$program" "$status" "$summary" "$p" "$f")
        if verbose || [ -n "$wrong" ] || [ "$f" != 0 ]; then
            echo "== $program"
            cat "$output"
        else
            grep '^SKIPPED' "$output"
            [ "$p" = 0 ] || tail -n 1 "$output"
        fi
        passed=$((passed + ${p:-0})) failed=$((failed + ${f:-0}))
        [ -z "$wrong" ] || fail "$wrong"
    done
    [ "$ended" = "$1" ] || fail "$ended of $1 programs ended"
    if [ "$passed" = 0 ] && [ "$failed" = 0 ]; then fail "no case ran"; fi
    echo "took $(($(date +%s) - began)) s; programs in ${BUILD:-build}/tests"
    echo "$passed passed, $failed failed"
    [ "$failed" = 0 ]
}

{
    while [ "$jobs" -gt 0 ]; do
        worker "$@" &
        jobs=$((jobs - 1))
    done
    wait
} | report $#
