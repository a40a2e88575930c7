#!/bin/sh
# cross.sh: the same bits everywhere. Builds the hashes (test_bits) with every compiler, optimisation and machine that is installed
# here, and the integer, table and map tests for foreign machines, which run under qemu-user or wine. Where bits are not promised
# (contraction, x87, -ffast-math) it tests what still holds. Run by `make cross` in the repository's root. What is not installed is
# skipped, loudly; "N passed, N failed" at the end, exit status non-zero on any failure.
#
# Arguments: names of jobs, of those below, and gcc-LEVEL, clang-LEVEL for other levels, and ppc64; none: all below.
# Environment: BUILD (build), JOBS (2) at a time, MCS_TEST_SCALE (0.02; 0.01 for the map tests).
set -u
LC_ALL=C
export LC_ALL
all='x87 s390x i386 gcc-O3 clang-O2 clang-O3 gcc-O2 contract nehalem aarch64 arm riscv64 fast-math gcc-O1 clang-O1 gcc-O0 clang-O0 mingw
    nvcc' # the longest first
root=${BUILD:-build}/cross began=${BEGAN:-$(date +%s)}
MCS_TEST_SCALE=${MCS_TEST_SCALE:-0.02}
export MCS_TEST_SCALE
exact='-ffp-contract=off'

# result STATUS TEXT...: one case.
result() {
    status=$1
    shift
    if [ "$status" = 0 ]; then echo "ok   $*"; else echo "FAIL $*"; fi
}
skip() { echo "SKIPPED: $*"; }
have() {
    for c; do command -v "$c" >/dev/null || return 1; done
}

# try TARGET RUNNER TESTS COMPILER...: after a probe that shows that its programs run here, builds and runs each test, NAME or
# NAME:FILTER; RUNNER is the emulator with its arguments, or nothing. Programs end in .exe because wine opens no other. Warnings are
# the business of `make hygiene`.
try() {
    target=$1 runner=$2 tests=$3
    shift 3
    # shellcheck disable=SC2086
    if ! have ${runner%% *} "$1"; then
        skip "$target: $1${runner:+ or ${runner%% *}} is not installed"
        return 0
    fi
    cat >"$dir/probe.c" <<'EOF'
#include <math.h>
#include <stdio.h>
int main(int n, char **a) { return a[0] && sqrt(n) == 1 ? puts("runs") < 0 : 1; }
EOF
    # shellcheck disable=SC2086
    if ! "$@" "$dir/probe.c" -o "$dir/probe.exe" -lm >"$dir/build.log" 2>&1 ||
        ! $runner "$dir/probe.exe" 2>/dev/null | grep runs >"$dir/run.log"; then
        skip "$target: $1 does not build or ${runner:-this machine} does not run a program of three lines"
        return 0
    fi
    for t in $tests; do
        case $t in *:*) filter="--filter ${t#*:}" t=${t%:*} ;; *) filter= ;; esac
        case $t in env*) scale=0.01 ;; *) scale=$MCS_TEST_SCALE ;; esac
        if ! "$@" -w -I. -Itests "tests/test_$t.c" -o "$dir/$t.exe" -lm >"$dir/build.log" 2>&1; then
            head -n 4 "$dir/build.log"
            result 1 "$target test_$t: does not build"
            continue
        fi
        # shellcheck disable=SC2086
        MCS_TEST_SCALE=$scale $runner "$dir/$t.exe" $filter >"$dir/run.log" 2>&1
        status=$?
        tail -n 1 "$dir/run.log" | grep -q ' passed, 0 failed' || status=1
        [ $status = 0 ] || grep -v '^ok' "$dir/run.log" | head -n 12 | sed 's/^/    /'
        grep '^SKIPPED' "$dir/run.log" | sort -u
        result $status "$target test_$t: $(tail -n 1 "$dir/run.log" | tr -d '\r' | sed 's/^[^ ]*: //')"
    done
}

# With contraction the results have no promised bits, but their promised accuracy.
contract() {
    for c in gcc clang; do
        try "contract: $c -march=native" "" oracle "$c" -std=gnu99 -O2 -march=native -ffp-contract=fast
    done
    try "contract: aarch64" qemu-aarch64 oracle aarch64-linux-gnu-gcc -std=gnu99 -O2 -static
}

# test_bits is a CUDA program too, with kernels of the scalar functions: it runs them where there is a GPU and says loudly where
# there is none. nvcc lets a function for kernels call one of the host, and only warns.
cuda() {
    try nvcc "" bits nvcc -x cu --fmad=false -O2 -Xcompiler $exact
    have nvcc || return 0
    nvcc -x cu -ptx -I. -Itests tests/test_bits.c -o "$dir/bits.ptx" >"$dir/build.log" 2>&1
    status=$?
    grep -E '^[^ ]*(mcsample\.h|bits\.[ch])\([0-9]+\): .*calling a __host__ function' "$dir/build.log" >"$dir/bad.log" && status=1
    [ $status = 0 ] || cat "$dir/bad.log" "$dir/build.log" | head -n 4 | cut -c 1-240
    result $status "nvcc: no function for kernels calls one of the host ($(wc -l <"$dir/bad.log") do)"
}

# The x87 unit computes with significands of 64 bits. With -std=gnu99, gcc's default, they stay in variables too until one happens
# to be stored; with -std=c99 every assignment rounds. What holds are the stated accuracy, finite results for any input, and all
# that is integers; what does not are the bits, of array forms against scalar ones too.
x87() {
    for flags in "$ia32 -std=c99 -mno-sse" "$ia32 -std=gnu99 -mno-sse" "gcc -std=gnu99 -msse2"; do
        rm -f "$dir/bits.exe"
        # shellcheck disable=SC2086
        try "x87: $flags" "" "oracle rng points tables:1000 tables_input:1000 env:maps env_input env_memory bits:adapters" $flags -O2 -mfpmath=387 $exact
        [ -e "$dir/bits.exe" ] || continue
        "$dir/bits.exe" --print >"$dir/bits.log" 2>&1
        grep '^mcs_' "$dir/bits.log" | sort >"$dir/bits.txt"
        grep -v '^mcs_' "$dir/bits.log" | head -n 4 >"$dir/bad.log"
        sed 's/^/    /' "$dir/bad.log"
        [ -s "$dir/bits.txt" ] && [ ! -s "$dir/bad.log" ]
        result $? "x87: $flags: finite results for the inputs of test_bits"
        sort tests/bits.txt | comm -13 - "$dir/bits.txt" >"$dir/other.txt"
        echo "    does not hold: the same bits ($(wc -l <"$dir/other.txt") of $(wc -l <"$dir/bits.txt") functions give others)"
    done
}

# With -ffast-math bad input is not recognised, subnormal numbers are 0, and a sum that was ordered to keep its digits may be taken
# in another order. What holds is finite results for good input; the error is stated in the program.
fast_math() {
    cat >"$dir/fast.c" <<'EOF'
#include "registry.h"

/* isfinite is taken for granted by the compiler here. */
static int finite_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (bits >> 23 & 255) != 255;
}

/* How far the parameters and the incidence are from 1, as a factor. */
static double span(const mcst_row *row, const float *p) {
    double s = 1 / (double)p[5];
    int i;
    for (i = 0; i < row->params; i++)
        if (p[i] != 0) s = fmax(s, fmax(fabs((double)p[i]), 1 / fabs((double)p[i])));
    return s;
}

int main(int argc, char **argv) {
    double worst = 0;
    const uint32_t nan_bits = 0x7fc00000;
    long kept = 0, bad = 0;
    float nan;
    size_t i, j;
    int k, a, b;
    memcpy(&nan, &nan_bits, sizeof nan);
    mcst_start(argc, argv);
    mcst_group("fast-math");
    if (mcst_case("both halves of a constant map")) { /* signed zeros are not kept apart */
        const float white[2] = {1, 1};
        const mcs_image image = mcs_image_make(white, 1, 2, 1);
        static double room[512];
        int below = 0;
        CHECK(mcs_env_build((mcs_env *)(void *)room, sizeof room, &image) == MCS_OK, "build");
        for (k = 0; k < 1000; k++)
            below += mcs_env_sample((const mcs_env *)(const void *)room, 0.5f, ((float)k + 0.5f) / 1000).w.z < 0;
        CHECK(below == 500, "%d of 1000 below the equator", below);
    }
    if (mcst_case("powers that are 0 in floats")) {
        volatile float e, x;
        for (e = 1e5f; e <= 1e9f; e *= 10)
            for (x = 0; x < 0.9f; x += 0.125f) {
                const float pdf = mcs_power_pdf(e, x), u = mcs_evenpower_invert(e, x);
                CHECK(pdf == 0 && u == 0.5f, "%g^%g: density %g, inverse %g", (double)x, (double)e, (double)pdf, (double)u);
            }
    }
    for (i = 0; i < MCST_NROWS; i++) {
        const mcst_row *row = &mcst_rows[i];
        if (!mcst_case("%s", row->name)) continue;
        for (j = 0; j < mcst_grid_count(row); j++) {
            float p[MCST_P];
            double tol;
            mcst_grid_get(row, j, p);
            if (span(row, p) > 100) continue;
            /* A sum in another order loses up to the ratio of its terms, products of two parameters at most; 16 roundings. */
            tol = 16 * 0x1p-24 * span(row, p) * span(row, p);
            for (a = 0; a < 16; a++)
                for (b = 0; b < 16; b++) {
                    const float u1 = ((float)a + 0.3f) / 16, u2 = ((float)b + 0.7f) / 16;
                    const ld want = row->truth.pdf_u(p, u1, u2);
                    ld x[3] = {0, 0, 0};
                    float out[5] = {0};
                    /* A tent's x is the difference of its radius and something, a smoothstep's is above its end: their rounding counts. */
                    double err = 0, size = row->coord == MCST_TENT || row->coord == MCST_BETWEEN ? fabs((double)p[0]) : row->dim == 3;
                    row->truth.map(p, u1, u2, x);
                    row->fn[0].sample(p, &u1, &u2, out);
                    for (k = 0; k < 5; k++) CHECK(finite_bits(out[k]), "p %g %g: result %d", (double)p[0], (double)p[1], k);
                    for (k = 0; k < row->dim; k++) {
                        err = fmax(err, fabs((double)(out[k] - x[k])));
                        size = fmax(size, fabs((double)x[k]));
                    }
                    CHECK(err <= tol * size, "p %g %g, u %g %g: point off by %g", (double)p[0], (double)p[1], (double)u1,
                          (double)u2, err);
                    worst = fmax(worst, err / size / tol);
                    err = fabs((double)(out[3] - want));
                    CHECK(err <= tol * (double)want, "p %g %g, u %g %g: pdf %g, exact %Lg", (double)p[0], (double)p[1],
                          (double)u1, (double)u2, (double)out[3], want);
                    if (want > 0) worst = fmax(worst, err / (double)want / tol);
                    row->fn[0].sample(p, &nan, &u2, out);
                    bad++, kept += out[3] != 0;
                }
        }
    }
    printf("holds: finite results; points and densities within 2^-20 s^2 relative, s the widest of parameters and 1/cos (worst "
           "%.2g)\n"
           "does not hold: bad input is refused (u = NaN got a density in %ld of %ld)\n", worst, kept, bad);
    return mcst_finish();
}
EOF
    for c in gcc clang; do
        if ! have $c; then
            skip "fast-math: no $c here"
            continue
        fi
        for flags in "-O2" "-O3 -march=native"; do
            # shellcheck disable=SC2086
            if $c -std=gnu99 $flags -ffast-math -w -I. -Itests "$dir/fast.c" -o "$dir/fast" -lm >"$dir/build.log" 2>&1; then
                "$dir/fast" >"$dir/run.log" 2>&1
                result $? "fast-math: $c $flags: $(tail -n 1 "$dir/run.log")"
                grep -E '^holds|^does not|FAIL|^    ' "$dir/run.log" | head -n 12 | sed 's/^/    /'
            else
                head -n 4 "$dir/build.log"
                result 1 "fast-math: $c $flags does not build"
            fi
        done
    done
}

# The tests of every machine. Of the tables those of 1000 entries, as a million takes an emulator minutes.
usual='bits rng points tables:1000 tables_input:1000'
ia32='gcc -m32'
if have i686-linux-gnu-gcc; then ia32='i686-linux-gnu-gcc -static'; fi

# job NAME: builds and runs in a folder of its own. Foreign machines at -O1, for what the levels do is shown here and -O2 doubles
# the build time; the C library of another machine is linked in. s390x evaluates floats as double under -std=c99, as -std=gnu99
# does not. Each run of .ci/run waits for it, so it has what the order of bytes could be seen in: the bits of every function, and files;
# without packets, whose text is that of the array forms. ppc64, which has that order too, has the usual tests.
# nehalem is x86 without AVX2: its arrays, and the builds of maps and products, take their points one by one.
job() {
    dir=$root/$1
    mkdir -p "$dir" || exit 1
    # shellcheck disable=SC2086
    case $1 in
    gcc-* | clang-*) try "$1" "" bits "${1%-*}" -std=c99 "-${1#*-}" $exact ;;
    aarch64) try aarch64 qemu-aarch64 "$usual" aarch64-linux-gnu-gcc -std=c99 -O1 -static $exact ;;
    arm) try arm qemu-arm "$usual" arm-linux-gnueabihf-gcc -std=c99 -O1 -static $exact ;;
    riscv64) try riscv64 qemu-riscv64 "$usual" riscv64-linux-gnu-gcc -std=c99 -O1 -static $exact ;;
    s390x) try s390x qemu-s390x "bits hdr env_files env_input" s390x-linux-gnu-gcc -std=gnu99 -O1 -static $exact -DMCST_ARRAYS ;;
    ppc64) try ppc64 qemu-ppc64 "$usual env env_input env_files" powerpc64-linux-gnu-gcc -std=c99 -O1 -static $exact ;;
    nehalem) try nehalem 'qemu-x86_64 -cpu Nehalem' bits gcc -std=c99 -O1 -static $exact -DMCST_ARRAYS ;;
    i386) try i386 "" "$usual env env_input env_memory env_files" $ia32 -std=c99 -O1 -msse2 -mfpmath=sse $exact ;;
    x87) x87 ;;
    mingw)
        wine=$(command -v wine64 || command -v wine || ls /usr/lib/wine/wine64 2>/dev/null)
        WINEPREFIX=$(cd "$dir" && pwd)/wine WINEDEBUG=-all
        export WINEPREFIX WINEDEBUG
        try mingw "${wine:-wine}" "$usual" x86_64-w64-mingw32-gcc -std=c99 -O1 -static $exact
        ;;
    nvcc) cuda ;;
    contract) contract ;;
    fast-math) fast_math ;;
    *) result 1 "no job is named $1" ;;
    esac
}

# shellcheck disable=SC2086
[ $# != 0 ] || set -- $all
mkdir -p "$root" || exit 1
locks=$(mktemp -d) || exit 1
trap 'rm -rf "$locks"' EXIT
trap 'exit 1' HUP INT TERM

# Every worker walks the whole list; mkdir, being atomic, decides who takes a job. Prints the name of each one that ended.
worker() {
    for name; do
        mkdir "$locks/$name" 2>/dev/null || continue
        began=$(date +%s)
        job "$name" >"$locks/$name/output" 2>&1
        echo "== $name, $(($(date +%s) - began)) s" >"$locks/$name/title"
        echo "$name"
    done
}
{
    jobs=${JOBS:-2}
    while [ "$jobs" -gt 0 ]; do
        worker "$@" &
        jobs=$((jobs - 1))
    done
    wait
} | {
    while read -r name; do
        cat "$locks/$name/title" "$locks/$name/output"
        cat "$locks/$name/output" >>"$locks/output"
    done
    [ -e "$locks/output" ] || exit 1
    passed=$(grep -c '^ok ' "$locks/output") failed=$(grep -c '^FAIL ' "$locks/output")
    skipped=$(grep -c '^SKIPPED' "$locks/output")
    [ "$skipped" = 0 ] || echo "$skipped SKIPPED, see above"
    echo "took $(($(date +%s) - began)) s; programs in $root"
    echo "$passed passed, $failed failed"
    [ "$failed" = 0 ] && [ "$passed" != 0 ]
}
