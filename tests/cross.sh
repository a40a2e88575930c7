#!/bin/sh
# cross.sh: the same bits everywhere. Builds the hashes (test_bits) and the integer and table tests with every compiler, optimisation
# and machine that is installed here, and runs them, foreign ones under qemu-user or wine. Run by `make cross` in the repository's
# root. What is not installed is skipped, loudly; "N passed, N failed" at the end, exit status non-zero on any failure.
#
# Arguments: names of targets (x86-64, i386, aarch64, arm, riscv64, s390x, ppc64, mingw, nvcc, contract, fast-math); none: all.
# Environment: BUILD (build), MCS_TEST_SCALE (0.02).
set -u
LC_ALL=C
export LC_ALL
dir=${BUILD:-build}/cross
only=" $* "
MCS_TEST_SCALE=${MCS_TEST_SCALE:-0.02}
export MCS_TEST_SCALE
mkdir -p "$dir" || exit 1

passed=0 failed=0 skipped=0
# result STATUS TEXT...: one case.
result() {
    status=$1
    shift
    if [ "$status" = 0 ]; then passed=$((passed + 1)) && echo "ok   $*"; else failed=$((failed + 1)) && echo "FAIL $*"; fi
}
skip() {
    skipped=$((skipped + 1))
    echo "SKIPPED: $*"
}
wanted() { [ "$only" = "  " ] || case $only in *" $1 "*) true ;; *) false ;; esac; }
have() {
    for c; do command -v "$c" >/dev/null || return 1; done
}

# build NAME FLAGS COMPILER...: builds tests/test_NAME.c into $dir/NAME; warnings are the business of `make hygiene`.
build() {
    program=$dir/$1 source=tests/test_$1.c
    shift
    "$@" -w -I. -Itests "$source" -o "$program" -lm >"$dir/build.log" 2>&1
}
# try TARGET RUNNER TESTS COMPILER...: builds and runs each test, NAME or NAME:FILTER; RUNNER is the emulator with its arguments, or
# nothing.
try() {
    target=$1 runner=$2 tests=$3
    shift 3
    for t in $tests; do
        case $t in *:*) filter="--filter ${t#*:}" t=${t%:*} ;; *) filter= ;; esac
        if ! build "$t" "$@"; then
            head -n 4 "$dir/build.log"
            result 1 "$target test_$t: does not build"
            continue
        fi
        # shellcheck disable=SC2086
        $runner "$dir/$t" $filter >"$dir/run.log" 2>&1
        status=$?
        tail -n 1 "$dir/run.log" | grep -q ' passed, 0 failed' || status=1
        [ $status = 0 ] || grep -v '^ok' "$dir/run.log" | head -n 12
        grep '^SKIPPED' "$dir/run.log" | grep -v mcs_env_ | sort -u
        result $status "$target test_$t: $(tail -n 1 "$dir/run.log" | tr -d '\r')"
    done
}
# foreign TARGET RUNNER COMPILER...: the tests for another machine, after a probe that shows that its programs run here.
foreign() {
    wanted "$1" || return 0
    target=$1 runner=$2
    shift 2
    # shellcheck disable=SC2086
    if ! have ${runner%% *} "$1"; then
        skip "$target: $1${runner:+ or ${runner%% *}} is not installed"
        return 0
    fi
    printf '#include <math.h>\n#include <stdio.h>\nint main(int n, char **a) { return a[0] && sqrt(n) == 1 ? puts("runs") < 0 : 1; }\n' >"$dir/probe.c"
    # shellcheck disable=SC2086
    if "$@" "$dir/probe.c" -o "$dir/probe" -lm >"$dir/build.log" 2>&1 && $runner "$dir/probe" 2>/dev/null | grep -q runs; then
        try "$target" "$runner" "bits rng points tables:1000" "$@" # tables of 1000 entries: a million takes an emulator minutes
    else
        skip "$target: $1 does not build or ${runner:-this machine} does not run a program of three lines"
    fi
}
exact='-ffp-contract=off'

if wanted x86-64; then
    for c in gcc clang; do
        for level in O0 O1 O2 O3; do
            if have $c; then try "$c -$level" "" bits $c -std=c99 -$level $exact; else skip "$c -$level: no $c here"; fi
        done
    done
fi

# -O1, for what the levels do is shown above and -O2 doubles the build time. The C library of another machine is linked in. s390x evaluates floats as double under -std=c99, as -std=gnu99 does not.
foreign aarch64 qemu-aarch64 aarch64-linux-gnu-gcc -std=c99 -O1 -static $exact
foreign arm qemu-arm arm-linux-gnueabihf-gcc -std=c99 -O1 -static $exact
foreign riscv64 qemu-riscv64 riscv64-linux-gnu-gcc -std=c99 -O1 -static $exact
foreign s390x qemu-s390x s390x-linux-gnu-gcc -std=gnu99 -O1 -static $exact
if [ "$only" = "  " ]; then skip "ppc64: slow, and s390x is big-endian too; run by name"; else foreign ppc64 qemu-ppc64 powerpc64-linux-gnu-gcc -std=c99 -O1 -static $exact; fi
sse='-std=c99 -O1 -msse2 -mfpmath=sse'
# shellcheck disable=SC2086
if have i686-linux-gnu-gcc; then foreign i386 "" i686-linux-gnu-gcc $sse -static $exact; else foreign i386 "" gcc -m32 $sse $exact; fi
wine=$(command -v wine64 || command -v wine || ls /usr/lib/wine/wine64 2>/dev/null)
foreign mingw "env WINEDEBUG=-all WINEPREFIX=$(cd "$dir" && pwd)/wine ${wine:-wine}" x86_64-w64-mingw32-gcc -std=c99 -O1 -static $exact

# Every scalar function in a kernel: test_bits is a CUDA program too, and runs its kernels where there is a GPU.
if wanted nvcc; then
    if have nvcc; then try nvcc "" bits nvcc -x cu --fmad=false -O2 -Xcompiler $exact; else skip "nvcc is not installed"; fi
fi

# With contraction the results have no promised bits, but their promised accuracy.
if wanted contract; then
    try "contract: gcc -march=native" "" oracle gcc -std=gnu99 -O2 -march=native -ffp-contract=fast
    if have clang; then try "contract: clang -march=native" "" oracle clang -std=gnu99 -O2 -march=native -ffp-contract=fast; else skip "contract: no clang here"; fi
    if have aarch64-linux-gnu-gcc qemu-aarch64; then
        try "contract: aarch64" qemu-aarch64 oracle aarch64-linux-gnu-gcc -std=gnu99 -O2 -static
    else
        skip "contract: no aarch64-linux-gnu-gcc or qemu-aarch64 here"
    fi
fi

# With -ffast-math bad input is not recognised, subnormal numbers are 0, and a sum that was ordered to keep its digits may be taken in
# another order. What holds is finite results for good input; the error is stated in the program.
if wanted fast-math; then
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
                    double err = 0, size = row->dim == 3;
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
    printf("holds: finite results; points and densities within 2^-20 s^2 relative, s the widest of parameters and 1/cos (worst %.2g)\n"
           "does not hold: bad input is refused (u = NaN got a density in %ld of %ld)\n", worst, kept, bad);
    return mcst_finish();
}
EOF
    for c in gcc clang; do
        if ! have $c; then skip "fast-math: no $c here"; continue; fi
        for flags in "-O2" "-O3 -march=native"; do
            # shellcheck disable=SC2086
            if $c -std=gnu99 $flags -ffast-math -w -I. -Itests "$dir/fast.c" -o "$dir/fast" -lm >"$dir/build.log" 2>&1; then
                "$dir/fast" >"$dir/run.log" 2>&1
                result $? "fast-math: $c $flags: $(tail -n 1 "$dir/run.log")"
                grep -E '^holds|^does not|FAIL|^    ' "$dir/run.log" | head -n 12
            else
                head -n 4 "$dir/build.log"
                result 1 "fast-math: $c $flags does not build"
            fi
        done
    done
fi

[ $skipped = 0 ] || echo "$skipped SKIPPED, see above"
echo "$passed passed, $failed failed"
[ $failed = 0 ] && [ $passed != 0 ]
