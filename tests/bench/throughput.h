/* What throughput.c and wide.c share: wide.c holds the 8 and 16 wide forms, compiled for units that the processor may
 * lack. */
#ifndef BENCH_THROUGHPUT_H
#define BENCH_THROUGHPUT_H
#include <stddef.h>

enum {
    BENCH_OUT = 5,
    BENCH_N = 4096,
    BENCH_KERNELS = 5
}; /* outputs: x, y, z, pdf, weight; samples of a pass; vector-maths kernels */

/* p: three parameters, then wo, as in tests/registry.h */
typedef void bench_form(const float *p, size_t n, const float *u1, const float *u2, float *const out[BENCH_OUT]);
/* Two parameters and a wo per sample, with all five outputs. */
typedef struct {
    float a[BENCH_N], b[BENCH_N], wo_x[BENCH_N], wo_y[BENCH_N], wo_z[BENCH_N];
} bench_hits;
typedef void bench_hits_form(const bench_hits *hits, const float *u1, const float *u2, float *const out[BENCH_OUT]);
/* a vector-maths kernel over an array; out2: the cosine, which sincos alone has */
typedef void bench_kernel(size_t n, const float *x, float *out, float *out2);

extern bench_form *const bench1_forms[], *const bench4_forms[], *const bench8_forms[], *const bench16_forms[];
/* NULL for rows without a wo and a weight. */
extern bench_hits_form *const bench1_hits_forms[], *const bench4_hits_forms[], *const bench8_hits_forms[],
                                                                                   *const bench16_hits_forms[];
extern bench_kernel *const bench_kernels_mcs[BENCH_KERNELS], *const bench_kernels_sleef[BENCH_KERNELS]; /* 8 wide */
#endif
