/* The truth of the rows that are no BRDFs, computed in double where the compiler takes -mlong-double-64: several times as
 * fast as in long double. Compiled once for the programs that bin samples and integrate densities. */
#undef MCST_LINKED
#include <float.h>
#include <math.h>
#if LDBL_MANT_DIG == DBL_MANT_DIG
#define asinl asin
#define atan2l atan2
#define atanl atan
#define cbrtl cbrt
#define copysignl copysign
#define cosl cos
#define erfcl erfc
#define erfl erf
#define expl exp
#define expm1l expm1
#define fabsl fabs
#define fmaxl fmax
#define fminl fmin
#define fmodl fmod
#define hypotl hypot
#define ldexpl ldexp
#define log1pl log1p
#define logl log
#define powl pow
#define rintl rint
#define sinhl sinh
#define sinl sin
#define sqrtl sqrt
#endif
#include "registry.h"

#define ROUGH(row)                                                            \
    mcst_rough_map_fn mcstr_##row##_map;                                      \
    void mcstr_##row##_map(const float *p, double u1, double u2, double *x) { \
        ld exact[3] = {0, 0, 0};                                              \
        mcsto_##row##_map(p, (ld)u1, (ld)u2, exact);                          \
        for (int i = 0; i < 3; i++) x[i] = (double)exact[i];                  \
    }                                                                         \
    mcst_rough_u_fn mcstr_##row##_pdf_u;                                      \
    double mcstr_##row##_pdf_u(const float *p, double u1, double u2) {        \
        return (double)mcsto_##row##_pdf_u(p, (ld)u1, (ld)u2);                \
    }                                                                         \
    mcst_rough_invert_fn mcstr_##row##_invert;                                \
    void mcstr_##row##_invert(const float *p, const float *x, double *u) {    \
        ld exact[2] = {0, 0};                                                 \
        mcsto_##row##_invert(p, x, exact);                                    \
        for (int i = 0; i < 2; i++) u[i] = (double)exact[i];                  \
    }
#define ROUGH_LINE ROUGH
#define ROUGH_PLANE ROUGH
#define ROUGH_DIR ROUGH
#define ROUGH_LIGHT ROUGH
#define ROUGH_POLYGON ROUGH
#define ROUGH_LOBE ROUGH
#define ROUGH_VLOBE ROUGH
#define ROUGH_BRDF(row)
#define ROUGH_ROW(shape, row, fn, arg, base, coord, grid) ROUGH_##shape(row)
MCST_ROWS(ROUGH_ROW)
