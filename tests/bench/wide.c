/* The 8 wide (-mavx2 -mfma) or 16 wide (-mavx512f and so on) forms of every sampler; with BENCH_W 8 the vector-maths
 * kernels of the header too and, with BENCH_SLEEF, those of SLEEF (https://sleef.org) with the same purpose: 1 ulp,
 * AVX2. */
#define MCS_PACKETS BENCH_W
#include "mcsample.h"
#include "registry.h"
#include "throughput.h"

#if BENCH_W == 8
#define LOOP(name, statement)                                              \
    static void name(size_t n, const float *in, float *out, float *out2) { \
        (void)out2;                                                        \
        for (size_t i = 0; i < n; i += 8) {                                \
            const V x = LOAD(in + i);                                      \
            statement;                                                     \
        }                                                                  \
    }

typedef mcs8_f unaligned __attribute__((aligned(4), may_alias)); /* see forms.h */
#define V mcs8_f
#define LOAD(p) (*(const unaligned *)(const void *)(p))
#define STORE(p, v) (*(unaligned *)(void *)(p) = (v))
LOOP(mcs_sincos, mcs8_f s; mcs8_f c; mcsi8_sincos_turns(x, &s, &c); STORE(out + i, s); STORE(out2 + i, c))
LOOP(mcs_log, STORE(out + i, mcsi8_log(x)))
LOOP(mcs_log1p, STORE(out + i, mcsi8_log1p(x)))
LOOP(mcs_exp, STORE(out + i, mcsi8_exp_neg(x)))
LOOP(mcs_expm1, mcs8_f m; (void)mcsi8_exp_both(x, &m); STORE(out + i, m))
bench_kernel *const bench_kernels_mcs[BENCH_KERNELS] = {mcs_sincos, mcs_log, mcs_log1p, mcs_exp, mcs_expm1};

#ifdef BENCH_SLEEF
#include <immintrin.h>
#include <sleef.h>
#undef V
#undef LOAD
#define V __m256
#define LOAD(p) _mm256_loadu_ps(p)
LOOP(sleef_sincos, Sleef___m256_2 s = Sleef_sincosf8_u10avx2(x); _mm256_storeu_ps(out + i, s.x);
     _mm256_storeu_ps(out2 + i, s.y))
LOOP(sleef_log, _mm256_storeu_ps(out + i, Sleef_logf8_u10avx2(x)))
LOOP(sleef_log1p, _mm256_storeu_ps(out + i, Sleef_log1pf8_u10avx2(x)))
LOOP(sleef_exp, _mm256_storeu_ps(out + i, Sleef_expf8_u10avx2(x)))
LOOP(sleef_expm1, _mm256_storeu_ps(out + i, Sleef_expm1f8_u10avx2(x)))
bench_kernel *const bench_kernels_sleef[BENCH_KERNELS] = {sleef_sincos, sleef_log, sleef_log1p, sleef_exp, sleef_expm1};
#else
bench_kernel *const bench_kernels_sleef[BENCH_KERNELS] = {0};
#endif
#endif

#include "forms.h"
