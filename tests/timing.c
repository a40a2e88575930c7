/* ns per sample of the scalar functions in a loop, of the _n forms (width chosen at run time) and, where this file is compiled
 * with AVX2, of the 8-wide functions themselves: disk, Phong, Ward, GGX visible normals. Everything in cache, all outputs wanted.
 * The forms take turns, so that a change of clock speed meets all of them. Median, and the span from the 10th to the 90th
 * percentile. No gate: a shared machine has no business failing a build. Some compilers (clang -O2) vectorise the scalar loop by
 * themselves, and _n may use 16 lanes: the first line says what the processor has. */
#define _POSIX_C_SOURCE 199309L
#include "mcsample.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 4096, PASSES = 20, ROUNDS = 101, FORMS = 3, OUT = 5 };

static float u1[N], u2[N], out[OUT][N];
static const mcs_vec3 wo = {0.6f, 0, 0.8f};

static void keep_direction(size_t i, mcs_brdf s) {
    out[0][i] = s.wi.x;
    out[1][i] = s.wi.y;
    out[2][i] = s.wi.z;
    out[3][i] = s.pdf;
    out[4][i] = s.weight;
}

static void disk_scalar(void) {
    size_t i;
    for (i = 0; i < N; i++) {
        mcs_sample2 s = mcs_disk_sample(2, u1[i], u2[i]);
        out[0][i] = s.x;
        out[1][i] = s.y;
        out[2][i] = s.pdf;
    }
}
static void disk_n(void) { mcs_disk_sample_n(2, N, u1, u2, out[0], out[1], out[2]); }

/* The scalar loop and the _n call of a lobe; make is the expression that prepares its constants. */
#define LOBE(name, type, make)                                                                \
    static void name##_scalar(void) {                                                         \
        const type m = make;                                                                  \
        size_t i;                                                                             \
        for (i = 0; i < N; i++) keep_direction(i, mcs_##name##_sample(&m, wo, u1[i], u2[i])); \
    }                                                                                         \
    static void name##_n(void) {                                                              \
        const type m = make;                                                                  \
        mcs_##name##_sample_n(&m, wo, N, u1, u2, out[0], out[1], out[2], out[3], out[4]);     \
    }
LOBE(phong, mcs_phong, mcs_phong_make(50))
LOBE(ward, mcs_ward, mcs_ward_make(0.1f, 0.4f, MCS_WARD_GMD))
LOBE(ggx_vndf, mcs_ggx, mcs_ggx_make(0.1f, 0.4f))

#ifdef __AVX2__
static mcs8_f load(const float *a) {
    mcs8_f v;
    memcpy(&v, a, sizeof v);
    return v;
}
static void store(float *a, mcs8_f v) { memcpy(a, &v, sizeof v); }
static mcs8_f spread(float x) {
    const float a[8] = {x, x, x, x, x, x, x, x};
    return load(a);
}

static void disk_wide(void) {
    size_t i;
    for (i = 0; i < N; i += 8) {
        mcs8_sample2 s = mcs8_disk_sample(spread(2), load(u1 + i), load(u2 + i));
        store(out[0] + i, s.x);
        store(out[1] + i, s.y);
        store(out[2] + i, s.pdf);
    }
}

#define WIDE_LOBE(name, type, make)                                                \
    static void name##_wide(void) {                                                \
        const type m = make;                                                       \
        const mcs8_vec3 o = {spread(wo.x), spread(wo.y), spread(wo.z)};            \
        size_t i;                                                                  \
        for (i = 0; i < N; i += 8) {                                               \
            mcs8_brdf s = mcs8_##name##_sample(&m, o, load(u1 + i), load(u2 + i)); \
            store(out[0] + i, s.wi.x);                                             \
            store(out[1] + i, s.wi.y);                                             \
            store(out[2] + i, s.wi.z);                                             \
            store(out[3] + i, s.pdf);                                              \
            store(out[4] + i, s.weight);                                           \
        }                                                                          \
    }
WIDE_LOBE(phong, mcs8_phong, mcs8_phong_make(spread(50)))
WIDE_LOBE(ward, mcs8_ward, mcs8_ward_make(spread(0.1f), spread(0.4f), MCS_WARD_GMD))
WIDE_LOBE(ggx_vndf, mcs8_ggx, mcs8_ggx_make(spread(0.1f), spread(0.4f)))
#define WIDE(name) name##_wide
#else
#define WIDE(name) NULL
#endif

typedef void (*form)(void);
static const struct {
    const char *name;
    form run[FORMS];
    int outputs;
} kernels[] = {{"disk", {disk_scalar, disk_n, WIDE(disk)}, 3},
               {"phong", {phong_scalar, phong_n, WIDE(phong)}, OUT},
               {"ward", {ward_scalar, ward_n, WIDE(ward)}, OUT},
               {"ggx_vndf", {ggx_vndf_scalar, ggx_vndf_n, WIDE(ggx_vndf)}, OUT}};
enum { KERNELS = sizeof kernels / sizeof kernels[0] };

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(void) {
    static const char *const names[FORMS] = {"scalar", "_n", "8 wide"};
    static double ns[KERNELS][FORMS][ROUNDS], sum[KERNELS][FORMS];
    mcs_pcg32 rng = mcs_pcg32_make(1, 1);
    int k, f, r, pass, o, i;

#ifdef __AVX2__
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) {
        puts("SKIPPED: compiled for AVX2 and FMA, which this processor lacks");
        return 0;
    }
#endif
    mcs_pcg32_fill_n(&rng, N, u1);
    mcs_pcg32_fill_n(&rng, N, u2);
    for (r = 0; r < ROUNDS; r++) {
        for (k = 0; k < KERNELS; k++) {
            for (f = 0; f < FORMS; f++) {
                double began = seconds();
                if (!kernels[k].run[f]) continue;
                for (pass = 0; pass < PASSES; pass++) kernels[k].run[f]();
                ns[k][f][r] = (seconds() - began) * 1e9 / ((double)N * PASSES);
                sum[k][f] = 0;
                for (o = 0; o < kernels[k].outputs; o++)
                    for (i = 0; i < N; i++) sum[k][f] += out[o][i];
            }
        }
    }
#ifdef __VERSION__
    printf("compiler %s, ", __VERSION__);
#endif
#ifdef __AVX2__
    printf("compiled for AVX2");
#else
    printf("compiled for the baseline processor");
#endif
#if defined(__GNUC__) && defined(__x86_64__)
    printf(", running on one with%s AVX2 and with%s AVX-512", __builtin_cpu_supports("avx2") ? "" : "out",
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") ? "" : "out");
#endif
    putchar('\n');
    printf("%-10s %-8s %10s %18s %16s %14s\n", "sampler", "form", "ns/sample", "10 %..90 %", "against scalar", "checksum");
    for (k = 0; k < KERNELS; k++) {
        for (f = 0; f < FORMS; f++) {
            if (!kernels[k].run[f]) continue;
            qsort(ns[k][f], ROUNDS, sizeof ns[k][f][0], ascending);
            printf("%-10s %-8s %10.2f %9.2f..%7.2f %15.2fx %14.6g\n", kernels[k].name, names[f], ns[k][f][ROUNDS / 2],
                   ns[k][f][ROUNDS / 10], ns[k][f][ROUNDS - 1 - ROUNDS / 10], ns[k][0][ROUNDS / 2] / ns[k][f][ROUNDS / 2],
                   sum[k][f]);
        }
    }
    return 0;
}
