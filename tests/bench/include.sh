#!/bin/sh
# What including mcsample.h costs: milliseconds that it adds to the compilation (-O2) of a file that has <math.h>, for gcc and clang,
# C and C++, with all of the header inline, with its large parts only declared, with packets, with each MCS_NO_* switch and with all
# of them; and bytes of machine code of a function that calls one sampler, scalar and as an array form. Medians of compilations that
# take turns. With "quick": gcc, the ways to include it.
# AGAINST=HEADER, a file or a git revision of mcsample.h: that header takes its turns, too, and then ratios are printed.
# Called by the Makefile from the directory of mcsample.h: include.sh OUTPUT_DIRECTORY [quick], CLOCK naming the program of clock.c.
LC_ALL=C
export LC_ALL
out=$1
dir=$out/include
rounds=${ROUNDS:-5}
mkdir -p "$dir" || exit 2
switches=$(sed -n 's/^ \* \(MCS_NO_[A-Z0-9_]*\) .*/\1/p' mcsample.h)
[ -n "$switches" ] || { echo "include.sh: mcsample.h lists no switch" >&2; exit 2; }
ways='none MCS_DECLARE MCS_PACKETS=16'
cases="math $ways $switches all"
pairs='gcc:c g++:c++ clang:c clang++:c++'
[ "${2:-}" = quick ] && rounds=${ROUNDS:-3} cases="math $ways" pairs='gcc:c g++:c++'
if [ -n "${AGAINST:-}" ]; then
    mkdir -p "$dir/against"
    if [ -f "$AGAINST" ]; then cp "$AGAINST" "$dir/against/mcsample.h"; else git show "$AGAINST:mcsample.h" >"$dir/against/mcsample.h"; fi || exit 2
    rounds=${ROUNDS:-11} cases="math against $ways" pairs='gcc:c g++:c++ clang:c clang++:c++'
fi

echo '#include <math.h>' >"$dir/math.c"
printf '#include <math.h>\n#include "mcsample.h"\n' >"$dir/header.c"

cpu=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1)
compilers=''
set -- "$rounds"
: >"$dir/list"
for pair in $pairs; do
    compiler=${pair%%:*} language=${pair#*:}
    if ! command -v "$compiler" >/dev/null 2>&1; then
        echo "SKIPPED: $compiler not installed"
        continue
    fi
    compilers="$compilers$compiler $("$compiler" --version | head -n 1 | grep -oE '[0-9]+\.[0-9.]+' | head -n 1), "
    for case in $cases; do
        source=header flags='' folder=.
        case $case in
        math) source=math ;;
        none) ;;
        against) folder=$dir/against ;;
        all) for s in $switches; do flags="$flags -D$s"; done ;;
        *) flags=-D$case ;;
        esac
        set -- "$@" "$compiler -O2 -x $language $flags -I$folder -c $dir/$source.c -o $dir/timed.o"
        echo "$compiler $language $case" >>"$dir/list"
    done
done
"$CLOCK" "$@" >"$dir/times" || exit 2

# Bytes of code and constants of a function with the given body, under the given name, per compiler.
code() {
    printf '%s\n' '#include "mcsample.h"' 'void use(const float *u, size_t n, float *x, float *y, float *z, float *pdf);' \
        'void use(const float *u, size_t n, float *x, float *y, float *z, float *pdf) {' \
        "    $2" '    (void)u, (void)n, (void)x, (void)y, (void)z, (void)pdf;' '}' >"$dir/code.c"
    for pair in $pairs; do
        compiler=${pair%%:*} language=${pair#*:}
        command -v "$compiler" >/dev/null 2>&1 || continue
        "$compiler" -O2 -x "$language" -I. -c "$dir/code.c" -o "$dir/code.o" || exit 2
        echo "$compiler $language $1 $(size -A "$dir/code.o" | awk '/^\.(text|rodata)/ { sum += $2 } END { print sum + 0 }')"
    done
}
{
    code nothing ''
    code disk_scalar 'mcs_sample2 s = mcs_disk_sample(1, u[0], u[1]); *x = s.x, *y = s.y, *pdf = s.pdf;'
    code disk_n 'mcs_disk_sample_n(1, n, u, u + n, x, y, pdf);'
    lobe='mcs_ggx m = mcs_ggx_make(u[2], u[3]); mcs_vec3 wo = {u[4], u[5], u[6]};'
    code ggx_vndf_scalar "$lobe mcs_brdf s = mcs_ggx_vndf_sample(&m, wo, u[0], u[1]);
    *x = s.wi.x, *y = s.wi.y, *z = s.wi.z, *pdf = s.pdf;"
    code ggx_vndf_n "$lobe mcs_ggx_vndf_sample_n(&m, wo, n, u, u + n, x, y, z, pdf, NULL);"
} >"$dir/code" || exit 2

{
    echo "# ${compilers}flags -O2; processor time of the compiler; ${cpu:-unknown processor}"
    echo 'compiler,language,case,ms_median,ms_min,ms_max,ms_added,bytes'
    paste -d ' ' "$dir/list" "$dir/times" | awk '
        $3 == "math" { base[$1] = $4 }
        { name = $3 == "math" ? "<math.h> alone" : $3 == "none" ? "mcsample.h" : $3 == "all" ? "all switches" : $3 == "against" ? "older header" : $3
          printf "%s,%s,%s,%s,%s,%s,%.1f,\n", $1, $2, name, $4, $5, $6, $4 - base[$1] }'
    awk '{ printf "%s,%s,code: %s,,,,,%s\n", $1, $2, $3, $4 }' "$dir/code"
} >"$out/include.csv"

echo "include: $(sed -n '1s/^# //p' "$out/include.csv")"
awk -F, '
    function row(ms, min, max, added) { printf "%-9s %-4s %-18s %9s %7s %7s %9s\n", $1, $2, $3, ms, min, max, added }
    NR == 2 { $1 = "compiler"; $2 = ""; $3 = "compiled"; row("ms", "min", "max", "added") }
    NR > 2 && $4 != "" { row($4, $5, $6, $7) }
    NR > 2 && $4 == "" { printf "%-9s %-4s %-24s %s bytes\n", $1, $2, $3, $8 }' "$out/include.csv"
[ -z "${AGAINST:-}" ] || awk -F, -v header="$AGAINST" '
    $3 == "older header" { older[$1] = $7 }
    $3 != "older header" && $1 in older && $4 != "" { printf "%-9s %-18s %5.2f of %s\n", $1, $3, $7 / older[$1], header }' "$out/include.csv"
echo "wrote $out/include.csv"
