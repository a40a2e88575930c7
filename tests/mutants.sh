#!/bin/sh
# mutants.sh JOBS [NAME...]: does a test fail when the header is wrong? Every record of tests/mutants.txt is a slip in mcsample.h.
# Here each is made in a copy of the header, the programs that should notice are built against it, and the cases named are run.
# A mutant that no case fails for has survived, and counts as failed. So do a text that the header does not hold as often as the
# record says, a mutant that does not compile, and cases that fail (or do not exist) with the header as it is. Stored hashes
# (test_bits) are not asked: they notice any change, wrong or not.
# JOBS mutants at a time; 0: only whether the list fits the header. NAME: only these records. Variables: CC, BUILD; everything lies
# in BUILD/mutants.
set -u
jobs=$1
shift
dir=${BUILD:-build}/mutants started=${BEGAN:-$(date +%s)}
list=tests/mutants.txt
rm -rf "$dir"
mkdir -p "$dir" || exit 1
ulimit -c 0
trap 'exit 1' HUP INT TERM

# DIR/NAME/: mcsample.h, kill (lines: program, filter), why (equivalent mutants); DIR/names. Problems go to DIR/wrong.
ONLY="$*" DIR=$dir LC_ALL=C awk '
    function flush_record(   k, from, to, found, i, at, line, out, many, path) {
        if (name == "") return
        if (only == "" || index(" " only " ", " " name " ")) {
            from = 1; to = lines; many = 0
            if (scope != "") {
                for (k = 1; k <= lines; k++) if (index(header[k], scope)) { from = k; many++ }
                if (many != 1) wrong("\"" scope "\" stands on " many " lines, not on one")
                for (to = from; to < lines && header[to] !~ /^( *\/\*.*)?[^ #].*[^{]}$/ && header[to] !~ /^}/; to++) {}
            }
            path = ENVIRON["DIR"] "/" name
            system("mkdir -p \"" path "\"")
            out = path "/mcsample.h"
            found = 0
            for (k = 1; k <= lines; k++) {
                line = header[k]
                if (k >= from && k <= to) {
                    at = ""
                    while ((i = index(line, find)) > 0) {
                        at = at substr(line, 1, i - 1) make
                        line = substr(line, i + length(find))
                        found++
                    }
                    line = at line
                }
                print line > out
            }
            close(out)
            if (find == "" || found != times) wrong("\"" find "\" occurs " found " times, not " times)
            if (find == make) wrong("nothing is replaced")
            if ((kill == "") == (why == "")) wrong("wants either kill: or equivalent:")
            printf "%s", kill > (path "/kill")
            close(path "/kill")
            print lanes > (path "/lanes")
            close(path "/lanes")
            if (why != "") print why > (path "/why")
            print name > (ENVIRON["DIR"] "/names")
        }
        name = scope = find = make = kill = why = ""
        times = 1
        lanes = 4
    }
    function wrong(what) { print name ": " what > (ENVIRON["DIR"] "/wrong") }
    function rest() { return substr($0, index($0, ": ") + 2) }
    BEGIN { only = ENVIRON["ONLY"]; times = 1; lanes = 4; name = "" }
    FNR == NR { header[++lines] = $0; next }
    /^#/ { next }
    /^name: /       { flush_record(); name = rest(); if (seen[name]++) wrong("a second record of that name"); next }
    /^in: /         { scope = rest(); next }
    /^find: /       { find = rest(); next }
    /^make: /       { make = rest(); next }
    /^make:$/       { make = ""; next }
    /^times: /      { times = rest() + 0; next }
    /^lanes: /      { lanes = rest() + 0; next }
    /^kill: /       { kill = kill rest() "\n"; next }
    /^equivalent: / { why = rest(); next }
    NF              { wrong("line " FNR " is not understood: " $0) }
    END { flush_record() }
' mcsample.h "$list" || exit 1
[ -s "$dir/names" ] || { echo "no such mutant"; exit 1; }

# Where the filter begins with the name of a row of the registry, and the program looks at one row after the other, that row alone
# is built, which takes a fraction of the time.
build() { # HEADER_FOLDER PROGRAM FILTER OUTPUT LANES
    row=
    case $2 in test_oracle | test_width) row=$(sed -n "s/^ *\(M(X, [A-Z]*, ${3%%[/ ]*},[^)]*)\).*/\1/p" tests/registry.h) ;; esac
    cc=${CC:-cc} quad=
    case $2 in stress/extremes | stress/climb) cc=gcc quad=-lquadmath ;; esac # their truth is __float128
    $cc -O1 -DMCS_MAX_LANES="$5" ${row:+"-DMCST_LIST(M, X)=$row"} -std=c99 -w -Wno-psabi -ffp-contract=off -I"$1" -I. -Itests \
        "tests/$2.c" -o "$4" $quad -lm >"$4.log" 2>&1
}
binary() { # FOLDER PROGRAM FILTER
    case $2 in test_oracle | test_width) echo "$1/$2.${3%%[/ ]*}" ;; *) echo "$1/${2##*/}" ;; esac
}
# The cases named must pass with the header as it is, and how long that takes sets how long a mutant may take.
baseline() {
    sort -u "$dir"/*/kill | while read -r program filter; do
        exe=$(binary "$dir" "$program" "$filter")
        [ -x "$exe" ] || build . "$program" "$filter" "$exe" 4 || { echo "$program does not compile" >>"$dir/wrong"; continue; }
        began=$(date +%s)
        "$exe" --filter "$filter" >"$exe.out" 2>&1 ||
            echo "$program --filter '$filter' fails with the header as it is" >>"$dir/wrong"
        echo "$(($(date +%s) - began)) $program $filter" >>"$dir/seconds"
    done
}
# killed, SURVIVED or what is wrong, in one line.
judge() { # NAME
    at=$dir/$1
    if [ -s "$at/why" ]; then
        echo "equivalent $1: $(cat "$at/why")"
        return
    fi
    while read -r program filter; do
        exe=$(binary "$at" "$program" "$filter")
        [ -x "$exe" ] || build "$at" "$program" "$filter" "$exe" "$(cat "$at/lanes")" || { echo "FAIL $1: does not compile"; return; }
        seconds=$(awk -v of="$program $filter" '{ t = $1; sub(/^[0-9]+ /, ""); if ($0 == of) { print t; exit } }' "$dir/seconds")
        timeout -k 5 $((60 + 20 * ${seconds:-0})) "$exe" --filter "$filter" >"$exe.out" 2>&1
        status=$?
        [ "$status" = 0 ] && continue
        how="$program, $filter"
        [ "$status" = 1 ] || how="$how: exit status $status"
        rm -f "$exe"
        echo "killed     $1 ($how)"
        return
    done <"$at/kill"
    echo "SURVIVED   $1"
}
worker() {
    while read -r name; do
        mkdir "$dir/$name/taken" 2>/dev/null || continue
        judge "$name"
    done <"$dir/names"
}

if [ "$jobs" = 0 ]; then
    if [ -s "$dir/wrong" ]; then sed 's/^/FAIL /' "$dir/wrong"; else echo "$(grep -c . "$dir/names") mutants fit the header"; fi
    [ ! -s "$dir/wrong" ]
    exit
fi
baseline
while [ "$jobs" -gt 0 ]; do
    worker &
    jobs=$((jobs - 1))
done | tee "$dir/report"
wait
[ ! -s "$dir/wrong" ] || sed 's/^/FAIL /' "$dir/wrong"
echo "took $(($(date +%s) - started)) s; headers and programs in $dir"
awk -v wrong="$([ -s "$dir/wrong" ] && grep -c . "$dir/wrong" || echo 0)" -v all="$(grep -c . "$dir/names")" '
    /^killed/ { passed++ }
    /^equivalent/ { same++ }
    END {
        if (same) print same " mutants are equivalent to the header"
        print passed + 0 " passed, " all - same - passed + wrong " failed"
        exit passed + same != all || wrong != 0 || all == 0
    }' "$dir/report"
