#!/bin/sh
# hygiene.sh: what a user's build sees of mcsample.h. Run by `make hygiene` in the repository's root; prints a line per group of
# checks and at the end "N passed, N failed", exit status non-zero on any failure. Environment: BUILD (build), JOBS (2), MAKE (make).
#
# The list of public names is taken from what the compiler made of the header (symbols, preprocessed typedefs), never from the
# interface that it is compared with. What sources look like is checked by sources.sh.
set -u
LC_ALL=C
export LC_ALL
dir=${BUILD:-build}/hygiene
jobs=${JOBS:-2} began=${BEGAN:-$(date +%s)}
warnings='-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -DMCS_WARNINGS'

# compile COMPILER STANDARD LEVEL SWITCH FILE: one cell of the matrix, used through xargs below. The object stays.
if [ "${1:-}" = compile ]; then
    case $3 in
        c++*) language=c++ ;;
        *) language=c && warnings="$warnings -Wdouble-promotion" ;;
    esac
    case $5 in none) switch= ;; *) switch=-D$5 ;; esac
    cell=$2-$3-$4-$5-$(basename "$6" .c)
    [ "$4" != fsyntax-only ] || switch="$switch -Wno-unused-command-line-argument" # of -c and -o
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
newest=$(ls /usr/bin/clang-[0-9]* 2>/dev/null | sed -n 's/.*\/\(clang-[0-9]*\)$/\1/p' | sort -t- -k2 -n | tail -n 1)
for c in gcc clang ${newest:-clang-newest}; do
    if command -v $c >/dev/null; then
        compilers="$compilers $c"
        $c --version | head -n 1
    else
        echo "SKIPPED: no $c here, its compilations were left out"
    fi
done
command -v gcc >/dev/null || { echo "gcc is needed: it lists the header's functions" && exit 1; }

# A way to include the header is "none", a switch that leaves something out, or one of these.
ways='MCS_PACKETS=16 MCS_DECLARE MCS_IMPLEMENTATION'
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
for s in none $switches MCS_PACKETS=8 MCS_PACKETS=16; do
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
    printf '#include "mcsample.h"\nint include_%s(void);\nint include_%s(void) { return MCS_VERSION; }\n' "${s%=*}" "${s%=*}" \
        >"$dir/include_$s.c"
    [ -s "$dir/functions.$s" ] && [ -s "$dir/types.$s" ]
    check $? "with $s: $(wc -l <"$dir/functions.$s") functions, $(wc -l <"$dir/types.$s") types"
done

# The files that use everything and nothing of a way; where it only decides where functions are, those of "none".
use() { echo "use_$(include "$1")"; }
include() { case $1 in MCS_DECLARE | MCS_IMPLEMENTATION) echo none ;; *) echo "$1" ;; esac; }

# --- the matrix: compilers x standards x switches. A file that only includes the header is compiled at -O0: there is nothing in it to
# optimise. The one that uses everything goes through the front end each time, and through code generation (a minute of work with
# packets) in plain form, with MCS_NO_WIDE, which changes bodies where the other switches only leave some out, and with packets in C at
# -O2: those of 16 lanes, but by gcc, which takes twice as long for them, those of 8: packets have one text, and gcc compiles the others
# for test_width. As C++ it is generated at -O0 alone, for linking: the optimiser sees the same bodies. All switches go with C99 and
# C++17. The standards after C++17, as far as the compiler knows them, may deprecate what those allow: the front end will say. The newest
# clang is asked about the oldest and newest standards.
packets() { [ "$1" = gcc ] && echo MCS_PACKETS=8 || echo MCS_PACKETS=16; }
for c in $compilers; do
    echo "$c c99 O2 $(packets "$c") $dir/use_$(packets "$c").c"
    if [ "$c" = "$newest" ]; then
        for std in c99 c2x c++11 c++2b; do
            for s in none $ways; do echo "$c $std fsyntax-only $s $dir/$(use $s).c"; done
        done
        for std in c99 c++17; do echo "$c $std O0 none $dir/include_none.c"; done
        echo "$c c99 O2 none $dir/use_none.c"
        echo "$c c++17 O0 none $dir/use_none.c"
        continue
    fi
    for std in c++20 c++2b; do # 2b: C++23, by the name that older compilers know, too
        "$c" -x c++ -std=$std -fsyntax-only /dev/null 2>/dev/null || continue
        for s in none MCS_NO_WIDE MCS_PACKETS=16; do echo "$c $std fsyntax-only $s $dir/$(use $s).c"; done
    done
    for std in c11 c17 c++11; do
        for s in none MCS_NO_WIDE MCS_PACKETS=16; do echo "$c $std fsyntax-only $s $dir/$(use $s).c"; done
    done
    for std in c99 c++17; do
        for s in none $switches $ways; do
            echo "$c $std fsyntax-only $s $dir/$(use $s).c"
            [ $s != MCS_IMPLEMENTATION ] || continue
            echo "$c $std O0 $s $dir/include_$(include $s).c"
            case $std-$s in
                c99-none | c99-MCS_NO_WIDE) levels='O0 O2' ;;
                c++17-none) levels=O0 ;;
                *) levels= ;;
            esac
            for level in $levels; do echo "$c $std $level $s $dir/use_$s.c"; done
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
set -- "$dir"/matrix/*-none-use_none.o "$dir"/matrix/*-use_MCS_PACKETS=*.o
gcc "$dir/main.c" "$@" -o "$dir/units" -lm -lstdc++ 2>"$dir/units.log" && "$dir/units"
linked=$?
[ $# -ge 4 ] && [ $linked = 0 ]
check $? "$# units that include the header and use everything link into one program" "$(head -n 4 "$dir/units.log")"

# --- functions that are not used leave no code, not even at -O0: units that only include the header hold their own function alone
for c in $compilers; do
    nm --defined-only "$dir"/matrix/"$c"-*-O0-*-include_*.o >"$dir/left"
    left=$(awk 'NF == 3 && $3 !~ /include_/ { print $3 }' "$dir/left" | sort -u | head -n 4)
    [ -s "$dir/left" ] && [ -z "$left" ]
    check $? "$c: at -O0 the header alone leaves no code" $left
done

# --- symbols of an optimised object that uses everything
for c in $compilers; do
    nm "$dir/matrix/$c-c99-O2-$(packets "$c")-use_$(packets "$c").o" >"$dir/symbols" || bad "$c: nothing to look at"
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
names=$(grep -F mcsample.h "$dir/aux.MCS_PACKETS=16" | sed -nE -e 's/; \/\* .*//' -e 's/^\/\* [^ ]*:[0-9]+:[NOI]F \*\/ [^(]*[ *]([A-Za-z0-9_]+) \(.*/\1/p' |
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

. "$(dirname "$0")/sources.sh"

# --- every standard header before ours: all of them in every mode of every compiler, and each alone, which leaves out what the others
# undo. Headers of the C library and of the C++ library are the same for all compilers: one compiler a language tells of them.
std_headers='assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic stdbit
    stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype'
mkdir -p "$dir/after"
for h in $std_headers; do
    exists="__has_include(<$h.h>)"
    [ $h != stdatomic ] || exists="$exists && (!defined(__cplusplus) || __cplusplus > 202002L)" # of C++ from C++23 on
    printf '#if %s\n#include <%s.h>\n#endif\n' "$exists" $h | tee "$dir/after/$h.c" >>"$dir/after/all.h"
done
printf '#include "all.h"\n' >"$dir/after/all.c"
for f in "$dir"/after/*.c; do
    printf '#include "mcsample.h"\nmcs_sample1 after(float u);\nmcs_sample1 after(float u) { return mcs_normal_sample(0, 1, u); }\n' >>"$f"
done
second=$(echo "$compilers gcc" | awk '{ print $2 }')
for f in "$dir"/after/*.c; do printf '%s\n' "gcc -x c $f" "$second -x c++ $f"; done >"$dir/after/list"
for c in $compilers; do
    for std in c99 c11 c17 c2x gnu99 gnu2x; do echo "$c -x c -std=$std $dir/after/all.c"; done
    for std in c++11 c++14 c++17 gnu++17 c++20 c++2b; do echo "$c -x c++ -std=$std $dir/after/all.c"; done
done >>"$dir/after/list"
xargs -P "$jobs" -I '{}' sh -c '{} -I. -w -fsyntax-only >/dev/null 2>&1 || echo "{}"' <"$dir/after/list" >"$dir/after/failed"
[ -s "$dir/after/list" ] && [ ! -s "$dir/after/failed" ]
check $? "$(wc -l <"$dir/after/list") compilations after standard headers" "$(head -n 3 "$dir/after/failed")"

# --- names that headers of Windows, X11, POSIX, OpenCL, Arduino or an engine define as macros: here each is what no compiler takes
{
    cat "$dir/base.h"
    for m in near far min max small hyper interface IN OUT OPTIONAL CONST VOID ERROR TRUE FALSE PASCAL CALLBACK DELETE STRICT OPAQUE \
        TRANSPARENT ABSOLUTE RELATIVE pascal cdecl boolean rad1 rad2 grp1 frm1 rct1 ico1 stc1 lst1 cmb1 edt1 scr1 ctl1 pi uuid_t \
        None Always Success Bool Status True False Above Below Convex Complex Expose KeyPress Button1 ShiftMask Unsorted Window Font \
        I J complex imaginary major minor makedev unix linux i386 MIN MAX PI DOMAIN OVERFLOW howmany roundup alloca sa_handler si_pid \
        st_atime h_addr ECHO B0 B1 F bit sq degrees radians abs half kernel global local constant check verify TEXT LOG LIKELY \
        UNUSED A B C D E G H K L M O S T W X Y Z EPS ONE LANES WIDTH BLOCK; do
        printf '#undef %s\n#define %s @\n' $m $m
    done
    printf '#include "mcsample.h"\n'
} >"$dir/macros.c"
for c in $compilers; do
    for language in c c++; do
        $c -x $language -I. -w -fsyntax-only "$dir/macros.c" 2>"$dir/macros.log"
        check $? "$c -x $language: none of $(grep -c '^#define' "$dir/macros.c") macros is a name of the header" \
            "$(grep -m 1 error "$dir/macros.log")"
    done
done

# --- wide forms exist, and how wide array forms are for every level of x86-64: a constant unless the processor is to be asked
cat >"$dir/lanes.c" <<'EOF'
#define MCS_NO_LIGHTS
#define MCS_NO_LOBES
#define MCS_NO_MEDIA
#define MCS_NO_TABLES
#include "mcsample.h"
void lanes_differ(void);
void eight(const float *u, float *to);
void eight(const float *u, float *to) { mcs8_store(to, mcs8_exponential_sample(mcs8_set(1.0f), mcs8_load(u)).x); }
int main(void) {
    if (mcs_lanes() != EXPECT) lanes_differ();
    return 0;
}
EOF
for c in $compilers; do
    case "$($c -dumpmachine)" in x86_64*) ;; *) continue ;; esac
    unknown=
    for set in x86-64:4:4 x86-64-v2:4:4 x86-64-v3:8:8 x86-64-v3:4:4 x86-64-v4:16:16 x86-64-v4:8:8 x86-64-v4:4:4 sapphirerapids:16:16 \
        sapphirerapids:8:8 znver4:16:16 znver5:16:16; do
        march=${set%%:*} lanes=${set##*:} most=${set#*:}
        most=${most%:*}
        if ! $c -march=$march -E -x c /dev/null >/dev/null 2>&1; then
            unknown="$unknown $march"
            continue
        fi
        $c -O2 -march=$march -DMCS_MAX_LANES=$most -DMCS_PACKETS=8 -DEXPECT=$lanes -w -Wno-psabi -I. "$dir/lanes.c" -o "$dir/lanes" -lm 2>"$dir/lanes.log"
        check $? "$c -march=$march, MCS_MAX_LANES $most: mcs8_ forms, array forms of $lanes lanes" "$(grep -m 1 -E 'error|lanes_differ' "$dir/lanes.log")"
    done
    [ -z "$unknown" ] || echo "SKIPPED: $c does not know -march:$unknown"
    lanes=1
    if grep -qw avx2 /proc/cpuinfo && grep -qw fma /proc/cpuinfo; then lanes=8; fi
    if grep -qw avx512dq /proc/cpuinfo && grep -qw avx512vl /proc/cpuinfo && grep -qw avx512bw /proc/cpuinfo; then lanes=16; fi
    printf '#include "mcsample.h"\nint main(void) { return mcs_lanes() != %d; }\n' $lanes >"$dir/picked.c"
    $c -O2 -w -I. "$dir/picked.c" -o "$dir/picked" -lm && "$dir/picked"
    check $? "$c: array forms of $lanes lanes on this processor"
    # clang that passes for MSVC has vectors, though it does not define __GNUC__.
    [ "$c" = gcc ] || {
        $c -fgnuc-version=0 -O2 -march=x86-64-v3 -DMCS_MAX_LANES=8 -DMCS_PACKETS=8 -DEXPECT=8 -w -I. "$dir/lanes.c" -o "$dir/lanes" -lm 2>"$dir/lanes.log"
        check $? "$c without __GNUC__: mcs8_ forms, array forms of 8 lanes" "$(grep -m 1 -E 'error|lanes_differ' "$dir/lanes.log")"
    }
done

# --- MCS_FN is the linkage of every function: with none, an object exports all of the public ones; modules of C++ can export them too
# At -O0 and with packets of 4 lanes: where a function is defined is no matter of the optimiser, nor of the lanes, as packets have one
# text.
printf '#include "mcsample.h"\n' >"$dir/library.c"
grep -vE '^mcs(8|16)_' "$dir/functions.MCS_PACKETS=16" >"$dir/functions.four"
for c in $compilers; do
    $c -std=c99 -O0 -w -Wno-psabi -DMCS_FN= -DMCS_PACKETS=4 -fPIC -I. -c "$dir/library.c" -o "$dir/library.o" &&
        nm --defined-only "$dir/library.o" | sed -n 's/^[0-9a-f]* T //p' | sort >"$dir/exported"
    lost=$(comm -23 "$dir/functions.four" "$dir/exported" | head -n 3)
    [ -s "$dir/exported" ] && [ -z "$lost" ]
    check $? "$c: with MCS_FN empty an object exports all $(wc -l <"$dir/functions.four") functions" $lost
done
if [ -n "$newest" ]; then
    {
        printf 'module;\n#include "mcsample.h"\nexport module mcs;\n'
        sed 's/.*/export using ::&;/' "$dir/functions.MCS_PACKETS=16"
    } >"$dir/module.cppm"
    $newest -std=c++20 -DMCS_FN=inline -DMCS_PACKETS=16 -w -I. --precompile "$dir/module.cppm" -o "$dir/module.pcm" 2>"$dir/module.log"
    check $? "$newest: with MCS_FN inline a module of C++20 exports all of them" "$(grep -m 1 error "$dir/module.log")"
else
    echo "SKIPPED: modules of C++ take a newer clang"
fi

# --- the declared way: files that only declare what one compiles, by any compiler of either language
mkdir -p "$dir/declared_way"
cat >"$dir/declared_way/user.c" <<'EOF'
#include "mcsample.h"
#include <stdlib.h>
static float total(mcs_texel t) { return t.w.x + t.w.y + t.w.z + t.pdf; }
/* Not 0 when something is wrong: a map of 2 x 1 texels, of which the second is black. */
int main(void) {
    const float pixels[2] = {1.0f, 0.0f};
    const mcs_image image = mcs_image_make(pixels, 2, 1, 1);
    const size_t bytes = mcs_env_bytes(2, 1);
    mcs_env *e = (mcs_env *)malloc(bytes);
    float u[3] = {0.25f, 0.5f, 0.75f}, x[3], y[3], z[3], pdf[3];
    mcs_vec3 up = {0.0f, 0.0f, 1.0f};
    mcs_ggx m = mcs_ggx_make(0.2f, 0.3f);
    if (!e || mcs_env_build(e, bytes, &image) != MCS_OK || mcs_env_sample(e, 0.9f, 0.5f).col != 0) return 1;
    mcs_env_sample_n(e, 3, u, u, x, y, z, pdf, NULL, NULL);
    for (int i = 0; i < 3; i++)
        if (x[i] + y[i] + z[i] + pdf[i] != total(mcs_env_sample(e, u[i], u[i]))) return 2;
    free(e);
    mcs_ggx_vndf_sample_n(&m, up, 3, u, u, x, y, z, pdf, NULL);
    for (int i = 0; i < 3; i++)
        if (pdf[i] != mcs_ggx_vndf_sample(&m, up, u[i], u[i]).pdf) return 3;
    if (MCS_PRODUCT_BYTES(16) != mcs_product_bytes(16)) return 4;
    return mcs_lanes() < 1;
}
EOF
cat >"$dir/declared_way/compile" <<'EOF'
compiler=$1 language=$2 dir=$3
# Where it optimises, g++ leaves out what only libstdc++ has.
case $language in c) level=-O0 ;; *) level=-O1 ;; esac
"$compiler" -x "$language" $level -ffp-contract=off -Wall -Wextra -Werror -DMCS_DECLARE -I. -c "$dir/user.c" -o "$dir/user-$compiler-$language.o"
"$compiler" -x "$language" $level -ffp-contract=off -Wall -Wextra -Werror -DMCS_DECLARE -DMCS_IMPLEMENTATION -I. -c "$dir/../library.c" \
    -o "$dir/one-$compiler-$language.o"
EOF
for c in $compilers; do
    for language in c c++; do echo "$c $language $dir/declared_way"; done
done | xargs -P "$jobs" -n 3 sh "$dir/declared_way/compile" >"$dir/declared_way/log" 2>&1
programs=0 wrong=
for c in $compilers; do
    for user in c c++; do
        for other in $compilers; do
            for one in c c++; do
                program=$dir/declared_way/$c-$user-$other-$one
                gcc "$dir/declared_way/user-$c-$user.o" "$dir/declared_way/one-$other-$one.o" -o "$program" -lm 2>"$program.log" && "$program"
                status=$?
                [ $status = 0 ] || wrong="$wrong $c:$user:$other:$one($status)"
                programs=$((programs + 1))
            done
        done
    done
done
check "$([ $programs -ge 4 ] && [ -z "$wrong" ]; echo $?)" "$programs programs of a file that declares and one that compiles" $wrong \
    "$(head -n 2 "$dir/declared_way/log")"
for c in $compilers; do
    left=$(nm --defined-only "$dir/declared_way/one-$c-c.o" | sed -n 's/^[0-9a-f]* [TDBRVW] //p' | grep -vxFf "$dir/public")
    lost=$(sed -n 's/^MCS_API .*\(mcs_[a-z0-9_]*\)(.*/\1/p' mcsample.h | sort -u >"$dir/api"
        nm --defined-only "$dir/declared_way/one-$c-c.o" | sed -n 's/^[0-9a-f]* T //p' | sort | comm -23 "$dir/api" -)
    check "$([ -s "$dir/api" ] && [ -z "$left$lost" ]; echo $?)" "$c: MCS_IMPLEMENTATION exports what MCS_API declares, $(wc -l <"$dir/api") functions" \
        $left $lost
done
left=$(gcc -std=c99 -E -P -DMCS_DECLARE -I. "$dir/library.c" | grep -oE 'mcsi_?(4|8|16|avx)[a-z0-9]*_[a-z]*\(|mcsi_(env|tile|product|pwc|cdf)[a-z_]*\(' | sort -u | head -n 3)
check "$([ -z "$left" ]; echo $?)" "with MCS_DECLARE no wide pass and no body of a table or map is left" $left
printf '#include "mcsample.h"\n#define MCS_IMPLEMENTATION\n#include "mcsample.h"\n' >"$dir/late.c"
! gcc -DMCS_DECLARE -I. -fsyntax-only "$dir/late.c" 2>"$dir/late.log" && grep -q 'define MCS_IMPLEMENTATION before' "$dir/late.log"
check $? "MCS_IMPLEMENTATION behind the first include is refused"

# --- a shared library, called by Python; at -O0, which calls as any level does
if command -v python3 >/dev/null && python3 -c 'import ctypes' 2>/dev/null; then
    cat >"$dir/call.py" <<'EOF'
import ctypes as c, sys
lib = c.CDLL(sys.argv[1])
class Sample2(c.Structure):
    _fields_ = [("x", c.c_float), ("y", c.c_float), ("pdf", c.c_float)]
class Cell(c.Structure):
    _fields_ = [("x", c.c_float), ("pdf", c.c_float), ("i", c.c_uint32)]
n, f = 5, c.c_float
u1, u2 = (f * n)(*[0.1 * k for k in range(n)]), (f * n)(*[0.9 - 0.1 * k for k in range(n)])
x, y, pdf = (f * n)(), (f * n)(), (f * n)()
lib.mcs_disk_sample_n(f(2), c.c_size_t(n), u1, u2, x, y, pdf)
assert all(abs(x[k] ** 2 + y[k] ** 2 - 4 * u1[k]) < 1e-5 and abs(pdf[k] - 0.0795775) < 1e-6 for k in range(n))
lib.mcs_pwc_bytes.restype = c.c_size_t
size = lib.mcs_pwc_bytes(4)
table, weights = (c.c_double * (size // 8))(), (f * 4)(0, 1, 0, 3)
assert lib.mcs_pwc_build(table, c.c_size_t(size), weights, 4) == 0
lib.mcs_pwc_sample.restype = Cell
assert lib.mcs_pwc_sample(table, f(0.5)).i == 3
if len(sys.argv) > 2: # a library of everything has the samplers of one point, too
    lib.mcs_disk_sample.restype = Sample2
    s = lib.mcs_disk_sample(f(2), f(u1[1]), f(u2[1]))
    assert abs(s.x - x[1]) < 1e-6 and abs(s.y - y[1]) < 1e-6 and s.pdf == pdf[1]
EOF
    for c in gcc clang; do
        command -v $c >/dev/null || continue
        for way in '' '-DMCS_FN='; do
            MAKEFLAGS='' "${MAKE:-make}" -s lib CC=$c CFLAGS="-O0 $way" BUILD="$dir/$c" >"$dir/call.log" 2>&1 &&
                python3 "$dir/call.py" "$dir/$c/lib/libmcsample.so" ${way:+all} 2>"$dir/call.log"
            check $? "$c${way:+ $way}: Python calls the shared library of make lib" "$(tail -n 1 "$dir/call.log")"
        done
    done
else
    echo "SKIPPED: no Python with ctypes here: nothing calls the shared library"
fi

# --- pasted into another file, the header cannot include itself and does without packets and wide loops
mkdir -p "$dir/pasted"
{
    cat mcsample.h
    printf 'int main(void) {\n    float u[2] = {0.25f, 0.75f}, x[2], pdf[2];\n    mcs_tent_sample_n(1, 2, u, x, pdf);\n'
    printf '    return !(mcs_lanes() == 1 && x[0] < 0.0f && x[0] == -x[1] && pdf[0] == pdf[1]);\n}\n'
} >"$dir/pasted/pasted.c"
for c in $compilers; do
    for language in c c++; do
        "$c" -x $language -O1 -Wall -Wextra -Werror "$dir/pasted/pasted.c" -o "$dir/pasted/pasted" -lm 2>"$dir/pasted/log" && "$dir/pasted/pasted"
        check $? "$c -x $language: pasted into a file it compiles and runs" "$(grep -m 1 -E 'error|warning' "$dir/pasted/log")"
    done
done

# --- a renamed copy has packets by MCS_SELF, and an error that says so without
mkdir -p "$dir/renamed"
cp mcsample.h "$dir/renamed/sampling.h"
printf '#include "sampling.h"\nint main(void) { return mcs8_set(1.0f)[7] != 1.0f; }\n' >"$dir/renamed/renamed.c"
for c in $compilers; do
    $c -std=c99 -w -DMCS_PACKETS=8 -fsyntax-only "$dir/renamed/renamed.c" 2>"$dir/renamed/log"
    grep -q 'error.*MCS_SELF' "$dir/renamed/log" &&
        $c -std=c99 -w -DMCS_PACKETS=8 '-DMCS_SELF="sampling.h"' -fsyntax-only "$dir/renamed/renamed.c" 2>"$dir/renamed/log"
    check $? "$c: a renamed copy asks for MCS_SELF and has packets with it" "$(grep -m 1 error "$dir/renamed/log")"
done

# --- a status that is ignored is warned of in the caller's file
printf '#include "mcsample.h"\nvoid build(mcs_pwc *t);\nvoid build(mcs_pwc *t) { mcs_pwc_build(t, 0, 0, 1); }\n' >"$dir/status.c"
for c in $compilers; do
    for language in c c++; do
        "$c" -x $language -I. -c "$dir/status.c" -o "$dir/status.o" 2>"$dir/status.log"
        [ "$(grep -c 'warning:' "$dir/status.log")" = 1 ] && grep -q 'status\.c.*unused-result' "$dir/status.log"
        check $? "$c -x $language: a status that is ignored is warned of" "$(grep -m 1 -E 'error|warning' "$dir/status.log")"
    done
done

# --- HIP: functions for kernels call none of the host
if [ -n "$newest" ] && $newest --print-targets | grep -q amdgcn; then
    {
        for m in host device global; do echo "#define __${m}__ __attribute__(($m))"; done
        printf '#include "mcsample.h"\n__global__ void kernel(float *to) {\n    mcs_vec3 wo = {0, 0, 1};\n'
        printf '    mcs_ggx m = mcs_ggx_make(0.1f, 0.2f);\n    to[0] = mcs_ggx_vndf_sample(&m, wo, 0.1f, 0.2f).pdf;\n'
        printf '    to[1] = mcs_normal_sample(0, 1, 0.3f).x + mcs_env_sample((const mcs_env *)(to + 2), 0.3f, 0.3f).pdf;\n}\n'
    } >"$dir/kernel.hip"
    for side in host device; do
        $newest -x hip -nogpuinc -nogpulib --offload-arch=gfx90a --cuda-$side-only -fsyntax-only -I. "$dir/kernel.hip" 2>"$dir/hip.log"
        check $? "$newest -x hip, $side" "$(grep -m 1 error "$dir/hip.log")"
    done
else
    echo "SKIPPED: no clang here compiles HIP"
fi

# --- what including the header costs. Gated is what does not depend on the machine: what is left for the compiler after preprocessing.
# Processor time is for make bench to measure.
# Attributes of targets are left out: the pragma in their place is one line, but takes gcc a sixth longer.
# The limits are what the header has, and some 5 lines and 300 bytes more. A density on a line adds some 45 lines and 4000 bytes.
cost() { # WAY LINES BYTES: what the header gives the compiler, and the limits of it
    lines=$2 bytes=$3
    # shellcheck disable=SC2046
    set -- "$1" $(gcc -std=c99 -E -P $([ "$1" = none ] || echo "-D$1") -I. "$dir/library.c" |
        sed 's/__attribute__((target("[^"]*"))) //' | wc -lc)
    [ "$2" -gt 1000 ] && [ "$2" -le "$lines" ] && [ "$3" -le "$bytes" ]
    check $? "$1: the header gives the compiler $2 lines (limit $lines), $3 bytes (limit $bytes)"
}
cost none 12415 750400
cost MCS_DECLARE 4185 220500
cost MCS_PACKETS=16 21435 1252300

echo "took $(($(date +%s) - began)) s; what compilers printed in $dir"
echo "$passed passed, $failed failed"
[ $failed = 0 ]
