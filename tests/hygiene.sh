#!/bin/sh
# hygiene.sh: what a user's build sees of mcsample.h. Run by `make hygiene` in the repository's root; prints a line per group of
# checks and at the end "N passed, N failed", exit status non-zero on any failure. Environment: BUILD (build), JOBS (2).
#
# The list of public names is taken from what the compiler made of the header (symbols, preprocessed typedefs), never from the
# index that it is compared with.
set -u
LC_ALL=C
export LC_ALL
dir=${BUILD:-build}/hygiene
jobs=${JOBS:-2}
warnings='-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror'

# compile COMPILER STANDARD LEVEL SWITCH FILE: one cell of the matrix, used through xargs below. The object stays.
if [ "${1:-}" = compile ]; then
    case $3 in
        c++*) language=c++ ;;
        *) language=c && warnings="$warnings -Wdouble-promotion" ;;
    esac
    case $5 in none) switch= ;; *) switch=-D$5 ;; esac
    cell=$2-$3-$4-$(basename "$6" .c)
    unit=-DUNIT=unit_$(echo "$cell" | tr -c 'a-zA-Z0-9\n' _)
    # shellcheck disable=SC2086
    if "$2" -x $language -std="$3" -"$4" $warnings -I. $switch "$unit" -c "$6" -o "$dir/matrix/$cell.o" 2>"$dir/matrix/$cell.log"; then
        if [ -s "$dir/matrix/$cell.log" ]; then echo "ok, noted"; else echo ok; fi
    else
        echo "FAIL $2 -std=$3 -$4 $switch $6"
        head -n 4 "$dir/matrix/$cell.log"
    fi
    exit 0
fi

passed=0 failed=0
ok() {
    passed=$((passed + 1))
    echo "ok   $*"
}
bad() {
    failed=$((failed + 1))
    echo "FAIL $*"
}
# check STATUS TEXT...: one case.
check() {
    if [ "$1" = 0 ]; then shift && ok "$@"; else shift && bad "$@"; fi
}

rm -rf "$dir"
mkdir -p "$dir/matrix" || exit 1
echo "warnings: $warnings; in C -Wdouble-promotion, too"
compilers=
for c in gcc clang; do
    if command -v $c >/dev/null; then
        compilers="$compilers $c"
        $c --version | head -n 1
    else
        echo "SKIPPED: no $c here, its compilations were left out"
    fi
done
command -v gcc >/dev/null || { echo "gcc is needed: it lists the header's functions" && exit 1; }

# prototypes SWITCH: one line per function that the header defines, public and private, as the compiler (gcc -aux-info) sees it:
# return type, name, parameters in parentheses.
prototypes() {
    echo '#include "mcsample.h"' >"$dir/all.c"
    gcc -std=c99 -w -I. ${1:+-D$1} -aux-info "$dir/all.aux" -fsyntax-only "$dir/all.c" 2>"$dir/all.log" &&
        sed -nE -e 's/; \/\* .*//' -e 's/^\/\* [^ ]*:[0-9]+:[NOI]F \*\/ (static |extern |inline )*([^(]*[ *]mcs[a-z0-9]*_[A-Za-z0-9_]* \(.*\));?$/\2/p' "$dir/all.aux"
}
# types SWITCH: every typedef name that the header makes.
types() {
    echo '#include "mcsample.h"' | gcc -E -P -I. ${1:+-D$1} -x c - | tr '\n' ' ' | sed 's/;/;\n/g' |
        sed -n -e 's/^ *}* *\(mcs[a-z0-9]*_[A-Za-z0-9_]*\) *;$/\1/p' \
            -e 's/.*typedef .*[ *]\(mcs[a-z0-9]*_[A-Za-z0-9_]*\)\( *\[[0-9]*\]\)*\( *__attribute__.*\)* *;$/\1/p' | sort -u
}

# reference NAME PROTOTYPES TYPES: writes $dir/NAME.c, in which every public function is called once, as user code would, with
# arguments from elsewhere, each in a function of its own whose name starts with UNIT, and every public type is used. It includes the
# header twice.
reference() {
    {
        printf '#include "mcsample.h"\n#include "mcsample.h"\n'
        printf '#ifdef __cplusplus\nextern "C" {\n#endif\n'
        printf '#define PASTE_(a, b) a##_##b\n#define PASTE(a, b) PASTE_(a, b)\n#define UNIT_(name) PASTE(UNIT, name)\n'
        printf 'void hygiene_fill(void *p, size_t size);\nvoid hygiene_use(const void *p, size_t size);\n'
        awk '{
            open = index($0, " (")
            head = substr($0, 1, open - 1)
            match(head, /[A-Za-z0-9_]+$/)
            name = substr(head, RSTART)
            type = substr(head, 1, RSTART - 1)
            args = ""
            print "void UNIT_(" name ")(void);\nvoid UNIT_(" name ")(void) {"
            n = parameters(substr($0, open + 2, length($0) - open - 2))
            for (i = 1; i <= n; i++) {
                if (part[i] ~ /\(\*/) {
                    args = args ", 0" # a function pointer
                } else {
                    match(part[i], /[A-Za-z0-9_]+$/)
                    print "    " substr(part[i], 1, RSTART - 1) "a" i ";\n    hygiene_fill(&a" i ", sizeof a" i ");"
                    args = args ", a" i
                }
            }
            call = name "(" substr(args, 3) ");"
            if (type ~ /^void *$/) print "    " call
            else print "    " type "r = " call "\n    hygiene_use(&r, sizeof r);"
            print "}"
        }
        # Splits at the commas outside parentheses into part[1..n].
        function parameters(text,    n, i, c, depth) {
            if (text == "void") return 0
            n = 1
            part[1] = ""
            for (i = 1; i <= length(text); i++) {
                c = substr(text, i, 1)
                if (c == "(") depth++
                if (c == ")") depth--
                if (c == "," && !depth) { part[++n] = ""; i++ } else part[n] = part[n] c
            }
            return n
        }' "$2"
        printf 'void UNIT_(types)(void);\nvoid UNIT_(types)(void) {\n'
        sed 's/.*/    hygiene_use(0, sizeof(&));/' "$3"
        printf '}\n#ifdef __cplusplus\n}\n#endif\n'
    } >"$dir/$1.c"
}

switches=$(grep -oE '\bMCS_NO_[A-Z0-9]+' mcsample.h | sort -u)
name='s/^[^(]*[ *](mcs[a-z0-9]*_[A-Za-z0-9_]*) \(.*/\1/'
for s in none $switches; do
    [ "$s" = none ] && define= || define=$s
    prototypes "$define" >"$dir/all.$s"
    grep -E '^[^(]*[ *]mcs[0-9]*_[A-Za-z0-9_]* \(' "$dir/all.$s" >"$dir/prototypes.$s"
    sed -E "$name" "$dir/prototypes.$s" | sort -u >"$dir/functions.$s"
    if ! [ -s "$dir/all.$s" ]; then
        bad "with $s: does not compile"
        head -n 5 "$dir/all.log"
        echo "$passed passed, $failed failed"
        exit 1
    fi
    mv "$dir/all.aux" "$dir/aux.$s"
    types "$define" | grep -E '^mcs[0-9]*_' >"$dir/types.$s"
    reference "use_$s" "$dir/prototypes.$s" "$dir/types.$s"
    printf '#include "mcsample.h"\nint include_%s(void);\nint include_%s(void) { return MCS_VERSION; }\n' "$s" "$s" >"$dir/include_$s.c"
    [ -s "$dir/functions.$s" ] && [ -s "$dir/types.$s" ]
    check $? "with $s: $(wc -l <"$dir/functions.$s") functions, $(wc -l <"$dir/types.$s") types"
done

# --- the matrix: compilers x standards x switches. A file that only includes the header is compiled at -O0 and -O2; the one that uses
# everything goes through the front end each time, and through code generation (a minute of work) in plain form and with
# MCS_NO_WIDE, which changes bodies where the other switches only leave some out. The standards after C++17, as far as the compiler
# knows them, may deprecate what those allow: the front end will say.
for c in $compilers; do
    for std in c++20 c++2b; do # 2b: C++23, by the name that older compilers know, too
        "$c" -x c++ -std=$std -fsyntax-only /dev/null 2>/dev/null || continue
        for s in none MCS_NO_WIDE; do echo "$c $std fsyntax-only $s $dir/use_$s.c"; done
    done
    for std in c99 c11 c17 c++11 c++17; do
        for s in none $switches; do
            echo "$c $std fsyntax-only $s $dir/use_$s.c"
            for level in O0 O2; do
                echo "$c $std $level $s $dir/include_$s.c"
                case $std-$s in c99-none | c++17-none | c99-MCS_NO_WIDE | c++17-MCS_NO_WIDE) echo "$c $std $level $s $dir/use_$s.c" ;; esac
            done
        done
    done
done >"$dir/matrix.list"
xargs -P "$jobs" -n 5 sh "$0" compile <"$dir/matrix.list" >"$dir/matrix.log"
grep -v '^ok' "$dir/matrix.log" | head -n 60
good=$(grep -c '^ok' "$dir/matrix.log")
cells=$(wc -l <"$dir/matrix.list")
passed=$((passed + good)) failed=$((failed + cells - good))
echo "     $good of $cells compilations without a warning, $(grep -c '^ok, noted' "$dir/matrix.log") of them with a note"

# --- the objects that use everything, of both languages, both levels and all compilers, link into one program
cat >"$dir/main.c" <<'EOF'
#include <stddef.h>
void hygiene_fill(void *p, size_t size);
void hygiene_use(const void *p, size_t size);
void hygiene_fill(void *p, size_t size) { (void)p, (void)size; }
void hygiene_use(const void *p, size_t size) { (void)p, (void)size; }
int main(void) { return 0; }
EOF
set -- "$dir"/matrix/*-use_none.o
gcc "$dir/main.c" "$@" -o "$dir/units" -lm -lstdc++ 2>"$dir/units.log" && "$dir/units"
linked=$?
[ $# -ge 4 ] && [ $linked = 0 ]
check $? "$# units that include the header and use everything link into one program" "$(head -n 4 "$dir/units.log")"

# --- a unit that only includes the header has hardly any code, even at -O0: gcc keeps the two functions that must not be inlined (and
# what those call), one function returns the version, the rest is what describes it
# to debuggers and unwinders
for c in $compilers; do
    most=$(size "$dir"/matrix/"$c"-*-O0-include_*.o | awk 'NR > 1 && $1 > most { most = $1 } END { print most + 0 }')
    [ "$most" -gt 0 ] && [ "$most" -le 16384 ]
    check $? "$c: at -O0 the header alone leaves $most bytes (limit 16384: two functions are never inlined)"
done

# --- symbols of an optimised object that uses everything
for c in $compilers; do
    nm "$dir/matrix/$c-c99-O2-use_none.o" >"$dir/symbols" || bad "$c: nothing to look at"
    mutable=$(awk '$(NF-1) ~ /^[DdBbCGgSsVvu]$/ { print $NF }' "$dir/symbols")
    [ -s "$dir/symbols" ] && [ -z "$mutable" ]
    check $? "$c: no mutable data" $mutable
    # Block copies that the compiler makes (bcmp is clang's memcmp), the processor query of _n, and libm where tables are built; nothing else.
    foreign=$(sed -n 's/^ *[Uw] //p' "$dir/symbols" | grep -vxE \
        'hygiene_(fill|use)|mem(cpy|set|move|cmp)|bcmp|__cpu_model|__cpu_indicator_init|_GLOBAL_OFFSET_TABLE_|(sqrt|exp|exp2|expm1|log|log1p|log2|pow|sin|cos|floor|fma|ldexp)f?')
    [ -s "$dir/symbols" ] && [ -z "$foreign" ]
    check $? "$c: no allocation, no stdio, nothing foreign" $foreign
    echo "     outside references: $(sed -n 's/^ *[Uw] //p' "$dir/symbols" | grep -v hygiene_ | tr '\n' ' ')"
    # Tables inside a function (name.number, read-only) belong to it and cannot clash.
    names=$(sed -n 's/^[0-9a-f]* [tTrR] //p' "$dir/symbols" | grep -E '^[a-z]' | grep -vE '^(mcsi?[0-9]*_|unit_)|\.[0-9]+$')
    [ -s "$dir/symbols" ] && [ -z "$names" ]
    check $? "$c: every symbol starts with mcs_ or mcsi_" $names
done
names=$(grep -F mcsample.h "$dir/aux.none" | sed -nE -e 's/; \/\* .*//' -e 's/^\/\* [^ ]*:[0-9]+:[NOI]F \*\/ [^(]*[ *]([A-Za-z0-9_]+) \(.*/\1/p' |
    grep -vE '^mcsi?[0-9]*_')
check "$([ -z "$names" ]; echo $?)" "every function, static ones included, starts with mcs_ or mcsi_" $names

# --- macros and included headers
grep -oE '^ *# *include *<[^>]*>' mcsample.h | sort -u >"$dir/base.h"
foreign=$(grep -oE '<[^>]*>' "$dir/base.h" | grep -vxE '<(stddef|stdint|math|string|float|limits)\.h>')
check "$([ -z "$foreign" ]; echo $?)" "includes only small standard headers" $foreign
gcc -dM -E -I. -x c "$dir/base.h" | awk '{ print $2 }' | sed 's/(.*//' | sort -u >"$dir/macros.base"
gcc -dM -E -I. -x c "$dir/include_none.c" | awk '{ print $2 }' | sed 's/(.*//' | sort -u >"$dir/macros.header"
comm -13 "$dir/macros.base" "$dir/macros.header" >"$dir/macros.new"
foreign=$(grep -vE '^(MCSI?_.*|MCSAMPLE_H)$' "$dir/macros.new")
[ -s "$dir/macros.new" ] && [ -z "$foreign" ]
check $? "every macro left defined ($(wc -l <"$dir/macros.new")) starts with MCS_ or MCSI_, or is the guard" $foreign
lines=$(grep -nE '[^ -~]' mcsample.h | head -n 5)
check "$([ -z "$lines" ]; echo $?)" "only printable ASCII, no tabs" "$lines"

# --- the index against the names
sed -n '/^\/\* INDEX/,/END OF INDEX/p' mcsample.h | grep -oE '\bmcs_[A-Za-z0-9_]+' | sort >"$dir/index"
grep -h '^mcs_' "$dir/functions.none" "$dir/types.none" | sort -u >"$dir/public"
twice=$(uniq -d "$dir/index")
[ -s "$dir/index" ] && [ -z "$twice" ]
check $? "the index ($(wc -l <"$dir/index") names) has every name once" $twice
missing=$(comm -13 "$dir/index" "$dir/public")
check "$([ -z "$missing" ]; echo $?)" "every public name is in the index" $missing
extra=$(sort -u "$dir/index" | comm -23 - "$dir/public")
check "$([ -z "$extra" ]; echo $?)" "every name in the index exists" $extra
lost=$(cat "$dir/functions.none" "$dir/types.none" | sed -n 's/^mcs[0-9][0-9]*_/mcs_/p' | sort -u | comm -23 - "$dir/public" | grep -vx mcs_f)
check "$([ -z "$lost" ]; echo $?)" "every 4, 8 and 16 wide name has a scalar one" $lost

# --- what including the header costs: gcc -O2, one sampler, against <math.h> alone; median of 9, taken in turn
cat >"$dir/clock.c" <<'EOF'
/* Runs a command; prints its wall-clock time and its processor time (user + system, children included) in milliseconds. */
#define _XOPEN_SOURCE 700
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>
int main(int argc, char **argv) {
    struct timespec a, b;
    struct rusage r;
    int status;
    if (argc != 2) return 2;
    clock_gettime(CLOCK_MONOTONIC, &a);
    status = system(argv[1]);
    clock_gettime(CLOCK_MONOTONIC, &b);
    getrusage(RUSAGE_CHILDREN, &r);
    printf("%.0f %.0f\n", (double)(b.tv_sec - a.tv_sec) * 1e3 + (double)(b.tv_nsec - a.tv_nsec) * 1e-6,
           (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) * 1e3 + (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec) * 1e-3);
    return status != 0;
}
EOF
printf '#include <math.h>\nfloat area(float r);\nfloat area(float r) { return sqrtf(r); }\n' >"$dir/cost_math.c"
printf '#include "mcsample.h"\nfloat area(float u);\nfloat area(float u) { return mcs_disk_sample(1, u, u).x; }\n' >"$dir/cost_header.c"
if gcc -O2 "$dir/clock.c" -o "$dir/clock"; then
    for i in 1 2 3 4 5 6 7 8 9; do
        for f in math header; do
            "$dir/clock" "gcc -std=c99 -O2 -I. -c $dir/cost_$f.c -o $dir/cost.o" >>"$dir/cost.$f" || bad "cost_$f.c, round $i"
        done
    done
    # The gate is on processor time, which for one compiler process is the wall-clock time of an idle machine.
    median() { awk -v c="$2" '{ print $c }' "$dir/cost.$1" | sort -n | sed -n 5p; }
    cost=$(($(median header 2) - $(median math 2)))
    [ $cost -le 150 ]
    check $? "including the header costs $cost ms of processor time (limit 150): $(median header 2) against $(median math 2) ms;" \
        "wall clock $(median header 1) against $(median math 1) ms"
fi

echo "$passed passed, $failed failed"
[ $failed = 0 ]
