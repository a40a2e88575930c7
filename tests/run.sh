#!/bin/sh
# run.sh JOBS PROGRAM...: runs the test programs JOBS at a time, prints each one's output in one piece when it ends, and at the
# very end the sum of their cases as "N passed, N failed". Non-zero when a case failed, and when a program crashed, ended without
# its summary line or ran no case (with FILTER set, single programs may run none, but not all of them).
# FILTER and SEED are handed to every program as --filter and --seed. Programs in a folder stress run at MCS_STRESS_SCALE, 0.002.
set -u
jobs=$1
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
            case $program in */stress/*) export MCS_TEST_SCALE="${MCS_STRESS_SCALE:-0.002}" ;; esac
            "$program" ${FILTER:+--filter "$FILTER"} ${SEED:+--seed "$SEED"}
            echo $? >"$tmp/$i/status"
        } >"$tmp/$i/output" 2>&1
        echo "$i $program"
    done
}

fail() {
    echo "FAIL $1"
    failed=$((failed + 1))
}

# Reads the indices and adds the programs up.
report() {
    passed=0 failed=0 ended=0
    while read -r i program; do
        ended=$((ended + 1))
        echo "== $program"
        cat "$tmp/$i/output"
        status=$(cat "$tmp/$i/status")
        summary=$(sed -n 's/^\([0-9][0-9]*\) passed, \([0-9][0-9]*\) failed$/\1 \2/p' "$tmp/$i/output" | tail -n 1)
        if [ -z "$summary" ]; then
            fail "$program: no summary line, exit status $status"
            continue
        fi
        p=${summary% *} f=${summary#* }
        passed=$((passed + p)) failed=$((failed + f))
        if [ "$p" = 0 ] && [ "$f" = 0 ]; then
            if [ -z "${FILTER:-}" ]; then fail "$program: ran no case"; elif [ "$status" -gt 1 ]; then fail "$program: exit status $status"; fi
        elif [ "$f" = 0 ] && [ "$status" != 0 ]; then
            fail "$program: every case passed, yet exit status $status"
        fi
    done
    [ "$ended" = "$1" ] || fail "$ended of $1 programs ended"
    if [ "$passed" = 0 ] && [ "$failed" = 0 ]; then fail "no case ran"; fi
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
