#!/bin/sh
# analyze.sh: what tools say about mcsample.h. valgrind memcheck and clang's memory sanitizer on the tests of widths, tables and
# environment maps at a small scale; gcc -fanalyzer, clang-tidy and cppcheck over the header. Run in the repository's root. Every
# finding fails unless the list below explains it. What is not installed is skipped, loudly; "N passed, N failed" at the end.
#
# Arguments: names of parts (valgrind, msan, fanalyzer, tidy, cppcheck); none: all. Environment: BUILD (build), MCS_TEST_SCALE
# (0.02).
set -u
LC_ALL=C
export LC_ALL
dir=${BUILD:-build}/analyze began=${BEGAN:-$(date +%s)}
only=" $* "
MCS_TEST_SCALE=${MCS_TEST_SCALE:-0.02}
export MCS_TEST_SCALE
mkdir -p "$dir" || exit 1

# Findings that are known and right as they are: a pattern for grep -E, a tab, the reason. Everything else fails.
known() {
    cat <<'END'
bugprone-easily-swappable-parameters	(u1, u2), (ax, ay), (x, y): neighbours of one type are what formulas have
bugprone-implicit-widening-of-multiplication-result	4 * MCSI_W is 64 at most
bugprone-macro-parentheses	the argument is the name of a parameter in a declaration, where parentheses do not stand
variableScope	C99 style of the header: declarations at the head of the function
use of uninitialized value 'l\.(ggx|gauss|phong)	mcsi_lobe_make: memset has set all of l to 0 before
use of uninitialized value '\*tile_	mcsi_product_heaviest: entries below count have been written
shiftTooManyBitsSigned	masks from signs: >> of a negative int keeps its sign with every compiler the header is for
Condition 'k<[mn]' is always false	wrong: n was set by ?: a line before, and the tests run these loops
use of uninitialized value '(sum\[[47]\]|\*&both)	mcsi_nodes_draw, mcsi_draw_grid: loops set all of them, which the analyzer follows for a few turns
mcsample.h:[0-9]+:[0-9]+: .*garbage value \[clang-analyzer-core.UndefinedBinaryOperatorResult	arrays and places that a function fills through a pointer in every case; valgrind and msan run them
Condition '\(unsigned long\)bytes==bytes' is always true	not where size_t has 32 bits
redundantPointerOp	MCSI_EACH takes the name of a batch, and a loop that is handed one has a pointer to it
'l\.(rays|through)\[k\]' is assigned a value that is never used	l holds pointers into the caller's region
argument angles that points at uninitialized variable	the loop fills it: what it takes of it before are addresses of its arrays
Same expression on both sides of '-'	MCSI_W - 1, where MCSI_W is 1
Condition 'i<rows' is always false	wrong: there are 16 rows and more, and the tests run these loops
Uninitialized variables: d\.tail	what mcsi_cut_make leaves open each bell sets before it reads it
Using argument l that points at uninitialized variable l	prepared lights are filled a member at a time, each before it is read
clarifyCondition	!flag & (a > b): both are 0 or 1, and & saves a jump
END
}

passed=0 failed=0
# result STATUS TEXT...: one case.
result() {
    status=$1
    shift
    if [ "$status" = 0 ]; then passed=$((passed + 1)) && echo "ok   $*"; else failed=$((failed + 1)) && echo "FAIL $*"; fi
}
skip() { echo "SKIPPED: $*"; }
wanted() { [ "$only" = "  " ] || case $only in *" $1 "*) true ;; *) false ;; esac; }
have() { command -v "$1" >/dev/null; }

# findings LOG PATTERN TEXT...: the case "no line of LOG that matches PATTERN is unknown".
findings() {
    log=$1 pattern=$2
    shift 2
    known | cut -f 1 >"$dir/known"
    grep -E "$pattern" "$log" | sort -u >"$dir/found"
    grep -vEf "$dir/known" "$dir/found" | head -n 20 >"$dir/new"
    cat "$dir/new"
    [ ! -s "$dir/new" ]
    result $? "$* ($(wc -l <"$dir/found") findings, $(grep -cEf "$dir/known" "$dir/found") of them known)"
}
# ran NAME STATUS: the case that the test $dir/NAME ran clean; its output is in run.log.
ran() {
    [ "$2" = 0 ] || tail -n 20 "$dir/run.log"
    result "$2" "$1: $(grep ' passed, ' "$dir/run.log" | tail -n 1)"
}

# --- at run time. The width test's checks of the wide forms run in full; arrays and tables are cut by MCS_TEST_SCALE and filters.
# NAME:FILTER, as a tool makes a test 20 times slower and more.
cuts='width: tables_input:batches tables_input:memory tables:1000 env: env_input:'
if wanted valgrind; then
    if have valgrind; then
        for cut in $cuts; do
            t=${cut%:*} filter=${cut#*:}
            gcc -std=c99 -O1 -g -ffp-contract=off -w -I. -Itests "tests/test_$t.c" -o "$dir/$t" -lm >"$dir/run.log" 2>&1 &&
                valgrind -q --error-exitcode=9 --leak-check=full "$dir/$t" ${filter:+--filter "$filter"} >"$dir/run.log" 2>&1
            ran "valgrind test_${cut%:}" $?
        done
    else
        skip "valgrind is not installed"
    fi
fi
if wanted msan; then
    if have clang && echo 'int main(void) { return 0; }' | clang -fsanitize=memory -x c - -o "$dir/probe" 2>/dev/null &&
        "$dir/probe"; then
        for cut in $cuts; do
            t=${cut%:*} filter=${cut#*:}
            clang -std=c99 -O1 -g -fsanitize=memory -fno-omit-frame-pointer -ffp-contract=off -w -I. -Itests "tests/test_$t.c" \
                -o "$dir/$t" -lm >"$dir/run.log" 2>&1 &&
                "$dir/$t" ${filter:+--filter "$filter"} >"$dir/run.log" 2>&1
            ran "msan test_${cut%:}" $?
        done
    else
        skip "clang or its memory sanitizer is not installed"
    fi
fi

# --- by reading. Static functions that nobody calls, and functions of headers, are looked at only when asked for.
printf '#include "mcsample.h"\n' >"$dir/header.c"
if wanted fanalyzer; then
    if have gcc; then
        gcc -std=c99 -O1 -fanalyzer -fkeep-static-functions -fkeep-inline-functions -DMCS_NO_WIDE \
            -I. -c "$dir/header.c" -o "$dir/header.o" >"$dir/fanalyzer.log" 2>&1 || echo 'error: not built' >>"$dir/fanalyzer.log"
        findings "$dir/fanalyzer.log" 'warning:|error:' "gcc -fanalyzer"
        keeps=$(nm "$dir/header.o" | grep -c ' t mcs_')
        [ "$keeps" -gt 100 ]
        result $? "gcc -fanalyzer has seen $keeps functions"
    else
        skip "gcc is not installed"
    fi
fi
if wanted tidy; then
    if have clang-tidy; then
        clang-tidy --quiet --checks='-*,bugprone-*,clang-analyzer-*,cert-*' --header-filter='.*' "$dir/header.c" -- -std=c99 -I. \
            >"$dir/tidy.log" 2>&1 || echo 'error: clang-tidy failed' >>"$dir/tidy.log"
        clang-tidy --quiet --checks='-*,clang-analyzer-*' --header-filter='.*' "$dir/header.c" -- -std=c99 -I. -DMCS_NO_WIDE \
            -Xclang -analyzer-opt-analyze-headers >>"$dir/tidy.log" 2>&1 || echo 'error: clang-tidy failed' >>"$dir/tidy.log"
        findings "$dir/tidy.log" '(warning|error):' "clang-tidy bugprone, cert, analyzer"
    else
        skip "clang-tidy is not installed"
    fi
fi
if wanted cppcheck; then
    if have cppcheck; then # what gcc's preprocessor made of the header: cppcheck's own fails on its macros
        gcc -E -std=c99 -DMCS_NO_WIDE -I. "$dir/header.c" >"$dir/expanded.c" &&
            cppcheck --quiet --enable=warning,style,performance,portability --std=c99 "$dir/expanded.c" >"$dir/cppcheck.log" 2>&1 ||
            echo 'error: cppcheck failed' >>"$dir/cppcheck.log"
        findings "$dir/cppcheck.log" '(warning|error|style|performance|portability):' "cppcheck"
    else
        skip "cppcheck is not installed"
    fi
fi

echo "took $(($(date +%s) - began)) s; what tools printed in $dir"
echo "$passed passed, $failed failed"
[ $failed = 0 ] && [ $passed != 0 ]
