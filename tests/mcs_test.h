/* A small test harness: groups hold cases, cases hold checks.
 *
 *     int main(int argc, char **argv) {
 *         mcst_start(argc, argv);
 *         mcst_group("disk");
 *         if (mcst_case("radius %g", r)) CHECK(x <= r, "x = %g", x);
 *         return mcst_finish();
 *     }
 *
 * Command line of every test binary: --list (names only), --filter TEXT (cases whose "group/name" holds TEXT; ^TEXT:
 * the others), --seed N. When all is well a program prints one line, "NAME: N passed, N failed, N s": cases, not
 * checks, and seconds of processor time. Before it stand the checks that failed, and lines that begin with SKIPPED.
 * With MCS_TEST_VERBOSE=1 there is also a line for every group and what mcst_note() is given. The exit status is 1 when
 * a case failed or none ran. A comparison must be written so that NaN fails it: CHECK(err <= tol), never CHECK(!(err >
 * tol)). */
#ifndef MCS_TEST_H
#define MCS_TEST_H
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MCST_SHOWN = 5 }; /* messages printed per case before the rest is only counted */

static struct {
    const char *program, *filter;
    int list, verbose;
    uint64_t seed;
    char group[64], name[160];
    int open, group_open, bad, group_cases, group_failed;
    long long checks;
    int passed, failed;
    clock_t began;
} mcst = {"", NULL, 0, 0, 20261122, "", "", 0, 0, 0, 0, 0, 0, 0, 0, 0};

static void mcst_close_case(void) {
    if (!mcst.open) return;
    mcst.open = 0;
    mcst.group_cases++;
    if (mcst.bad) {
        mcst.failed++;
        mcst.group_failed++;
        printf("  FAIL %s/%s: %d check%s failed\n", mcst.group, mcst.name, mcst.bad, mcst.bad == 1 ? "" : "s");
    } else {
        mcst.passed++;
    }
}

static void mcst_close_group(void) {
    mcst_close_case();
    if (mcst.group_open && mcst.group_cases && (mcst.verbose || mcst.group_failed))
        printf("%-4s %-28s %4d cases %12lld checks %7.2f s\n", mcst.group_failed ? "FAIL" : "ok", mcst.group,
               mcst.group_cases, mcst.checks, (double)(clock() - mcst.began) / CLOCKS_PER_SEC);
    fflush(stdout);
    mcst.group_open = 0;
}

static void mcst_start(int argc, char **argv) {
    const char *folder = strrchr(argv[0], '/');
    const char *verbose = getenv("MCS_TEST_VERBOSE");
    mcst.program = folder ? folder + 1 : argv[0];
    mcst.verbose = verbose && *verbose && strcmp(verbose, "0") != 0;
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--list")) mcst.list = 1;
        else if (!strcmp(argv[i], "--filter") && i + 1 < argc) mcst.filter = argv[++i];
        else if (!strcmp(argv[i], "--seed") && i + 1 < argc) mcst.seed = strtoull(argv[++i], NULL, 0);
        else {
            fprintf(stderr, "usage: %s [--list] [--filter TEXT] [--seed N]\n", argv[0]);
            exit(2);
        }
    }
}

static void mcst_group(const char *group) {
    mcst_close_group();
    snprintf(mcst.group, sizeof mcst.group, "%s", group);
    mcst.group_open = 1;
    mcst.group_cases = mcst.group_failed = 0;
    mcst.checks = 0;
    mcst.began = clock();
}

/* Opens a case; non-zero when it is to be run. */
static int mcst_case(const char *fmt, ...) {
    mcst_close_case();
    va_list a;
    va_start(a, fmt);
    vsnprintf(mcst.name, sizeof mcst.name, fmt, a);
    va_end(a);
    char full[256];
    snprintf(full, sizeof full, "%s/%s", mcst.group, mcst.name);
    if (mcst.filter) {
        const int others = mcst.filter[0] == '^';
        if ((strstr(full, mcst.filter + others) != NULL) == others) return 0;
    }
    if (mcst.list) {
        puts(full);
        return 0;
    }
    mcst.open = 1;
    mcst.bad = 0;
    return 1;
}

static void mcst_fail(const char *file, int line, const char *what, const char *fmt, ...) {
    if (++mcst.bad > MCST_SHOWN) return;
    printf("    %s:%d: %s/%s: %s: ", file, line, mcst.group, mcst.name, what);
    va_list a;
    va_start(a, fmt);
    vprintf(fmt, a);
    va_end(a);
    putchar('\n');
}

/* Detail, for MCS_TEST_VERBOSE=1 alone. */
static inline void mcst_note(const char *fmt, ...) {
    if (!mcst.verbose || mcst.list) return;
    va_list a;
    va_start(a, fmt);
    vprintf(fmt, a);
    va_end(a);
}

/* 1 where this build contracts a*b + c: with c the rounded product, only a fused operation finds what the rounding took
 * away. */
#define MCST_CONTRACTS(function)                               \
    static inline int function(void) {                         \
        volatile float v[3] = {1 + 0x1p-12f, 1 + 0x1p-12f, 0}; \
        v[2] = -(v[0] * v[1]);                                 \
        const float a = v[0];                                  \
        const float b = v[1];                                  \
        const float c = v[2];                                  \
        return a * b + c != 0;                                 \
    }
MCST_CONTRACTS(mcst_contracts)
/* The same for array forms, which may contract where nothing else does, by the units they pick at run time. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__CUDACC__)
__attribute__((target("avx2,fma"))) MCST_CONTRACTS(mcst_contracts_fma) static inline int mcst_arrays_contract(void) {
    return mcst_contracts() || (__builtin_cpu_supports("fma") && mcst_contracts_fma());
}
#else
static inline int mcst_arrays_contract(void) { return mcst_contracts(); }
#endif

#define CHECK(cond, ...) ((void)(mcst.checks++, (cond) ? 0 : (mcst_fail(__FILE__, __LINE__, #cond, __VA_ARGS__), 0)))

static int mcst_finish(void) {
    mcst_close_group();
    if (mcst.list) return 0;
    printf("%s: %d passed, %d failed, %.1f s\n", mcst.program, mcst.passed, mcst.failed,
           (double)clock() / CLOCKS_PER_SEC);
    return mcst.failed != 0 || mcst.passed == 0;
}
#endif
