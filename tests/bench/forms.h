/* One array loop per sampler of the registry over the functions of one width; material and parameters are prepared
 * outside of the loop. No include guard: included once per BENCH_W = 1, 4, 8 or 16, for bench1_<row> and so on, of the
 * type bench_form, and the array bench1_forms in the order of the registry. n is a multiple of BENCH_W; a weight is
 * left to the compiler to leave out. The array bench1_hits_forms has the same loops with a wo and a material per sample,
 * which is made from its parameters, and with the weight. */
#define FORM_CAT_(a, b, c) a##b##c
#define FORM_CAT(a, b, c) FORM_CAT_(a, b, c)
#if BENCH_W == 1
#define M_(name) FORM_CAT(mcs, _, name)
#define F_ float
#else
#define M_(name) FORM_CAT(mcs, BENCH_W, _##name)
#define F_ FORM_CAT(mcs, BENCH_W, _f)
#endif
#define B_(name) FORM_CAT(bench, BENCH_W, _##name)

#define L_ B_
#include "row_lights.h"
#undef L_

#define FORM_ARGS_0
#define FORM_ARGS_1 a,
#define FORM_ARGS_2 a, b,
#define FORM_ARGS_corners a, b, M_(set)(1.0f), M_(set)(3.0f),
#define FORM_ARGS_cross a, M_(set)(0.0f), M_(set)(0.0f), b,
#define FORM_ARGS_ball B_(origin)(), B_(aside)(a), b,
#define FORM_ARGS_disk_light B_(origin)(), B_(aside)(a), B_(tilted)(), b,
#define FORM_MAKE_rectangle const M_(spherical_rectangle) m = B_(row_rectangle)(a, b)
#define FORM_MAKE_triangle const M_(spherical_triangle) m = B_(row_triangle)(a, b)
#define FORM_MAKE_phong const M_(phong) m = M_(phong_make)(a)
#define FORM_MAKE_ward const M_(ward) m = M_(ward_make)(a, b, MCS_WARD_GMD)
#define FORM_MAKE_ward_gmd FORM_MAKE_ward
#define FORM_MAKE_ward_duer const M_(ward) m = M_(ward_make)(a, b, MCS_WARD_DUER)
#define FORM_MAKE_ward_1992 const M_(ward) m = M_(ward_make)(a, b, MCS_WARD_1992)
#define FORM_MAKE_beckmann const M_(beckmann) m = M_(beckmann_make)(a, b)
#define FORM_MAKE_ggx const M_(ggx) m = M_(ggx_make)(a, b)
#define FORM_MAKE_ashikhmin const M_(ashikhmin) m = M_(ashikhmin_make)(a, b)

#define FORM(row, prepare, type, call, keep)                                                                       \
    static void B_(row)(const float *p, size_t n, const float *u1, const float *u2, float *const out[BENCH_OUT]) { \
        const F_ a = M_(set)(p[0]), b = M_(set)(p[1]);                                                             \
        const M_(vec3) wo = {M_(set)(p[3]), M_(set)(p[4]), M_(set)(p[5])};                                         \
        float *const x = out[0], *const y = out[1], *const z = out[2], *const pdf = out[3];                        \
        size_t i;                                                                                                  \
        prepare;                                                                                                   \
        (void)a, (void)b, (void)wo, (void)y, (void)z, (void)u2;                                                    \
        for (i = 0; i < n; i += BENCH_W) {                                                                         \
            const M_(type) s = call;                                                                               \
            keep;                                                                                                  \
            M_(store)(pdf + i, s.pdf);                                                                             \
        }                                                                                                          \
    }
#define FORM_U M_(load)(u1 + i), M_(load)(u2 + i)
#define FORM_XYZ(v) M_(store)(x + i, v.x), M_(store)(y + i, v.y), M_(store)(z + i, v.z)
#define FORM_LINE(row, fn, args) \
    FORM(row, (void)0, sample1, M_(fn##_sample)(FORM_ARGS_##args M_(load)(u1 + i)), M_(store)(x + i, s.x))
#define FORM_PLANE(row, fn, args)                                         \
    FORM(row, (void)0, sample2, M_(fn##_sample)(FORM_ARGS_##args FORM_U), \
         (M_(store)(x + i, s.x), M_(store)(y + i, s.y)))
#define FORM_DIR(row, fn, args) FORM(row, (void)0, dir, M_(fn##_sample)(FORM_ARGS_##args FORM_U), FORM_XYZ(s.w))
#define FORM_LIGHT(row, fn, args) FORM(row, (void)0, light, M_(fn##_sample)(FORM_ARGS_##args FORM_U), FORM_XYZ(s.w))
#define FORM_POLYGON(row, fn, mat) FORM(row, FORM_MAKE_##mat, light_point, M_(fn##_sample)(&m, FORM_U), FORM_XYZ(s.w))
#define FORM_LOBE(row, fn, mat) FORM(row, FORM_MAKE_##mat, dir, M_(fn##_sample)(&m, FORM_U), FORM_XYZ(s.w))
#define FORM_VLOBE(row, fn, mat) FORM(row, FORM_MAKE_##mat, dir, M_(fn##_sample)(&m, wo, FORM_U), FORM_XYZ(s.w))
#define FORM_BRDF(row, fn, mat) FORM(row, FORM_MAKE_##mat, brdf, M_(fn##_sample)(&m, wo, FORM_U), FORM_XYZ(s.wi))
#define FORM_ROW(shape, row, fn, arg, base, coord, grid) FORM_##shape(row, fn, arg)
#define FORM_NAME(shape, row, fn, arg, base, coord, grid) B_(row),
MCST_ROWS(FORM_ROW)
bench_form *const B_(forms)[] = {MCST_ROWS(FORM_NAME)};

#define FORM_HITS_LINE(row, fn, arg)
#define FORM_HITS_PLANE FORM_HITS_LINE
#define FORM_HITS_DIR FORM_HITS_LINE
#define FORM_HITS_LIGHT FORM_HITS_LINE
#define FORM_HITS_POLYGON FORM_HITS_LINE
#define FORM_HITS_LOBE FORM_HITS_LINE
#define FORM_HITS_VLOBE FORM_HITS_LINE
#define FORM_HITS_BRDF(row, fn, mat)                                                                            \
    static void B_(row##_hits)(const bench_hits *hits, const float *u1, const float *u2,                        \
                               float *const out[BENCH_OUT]) {                                                   \
        for (size_t i = 0; i < BENCH_N; i += BENCH_W) {                                                         \
            const F_ a = M_(load)(hits->a + i), b = M_(load)(hits->b + i);                                      \
            const M_(vec3) wo = {M_(load)(hits->wo_x + i), M_(load)(hits->wo_y + i), M_(load)(hits->wo_z + i)}; \
            FORM_MAKE_##mat;                                                                                    \
            const M_(brdf) s = M_(fn##_sample)(&m, wo, FORM_U);                                                 \
            (void)b;                                                                                            \
            M_(store)(out[0] + i, s.wi.x);                                                                      \
            M_(store)(out[1] + i, s.wi.y);                                                                      \
            M_(store)(out[2] + i, s.wi.z);                                                                      \
            M_(store)(out[3] + i, s.pdf);                                                                       \
            M_(store)(out[4] + i, s.weight);                                                                    \
        }                                                                                                       \
    }
#define FORM_HITS_NONE(row) NULL,
#define FORM_HITS_NAME_LINE FORM_HITS_NONE
#define FORM_HITS_NAME_PLANE FORM_HITS_NONE
#define FORM_HITS_NAME_DIR FORM_HITS_NONE
#define FORM_HITS_NAME_LIGHT FORM_HITS_NONE
#define FORM_HITS_NAME_POLYGON FORM_HITS_NONE
#define FORM_HITS_NAME_LOBE FORM_HITS_NONE
#define FORM_HITS_NAME_VLOBE FORM_HITS_NONE
#define FORM_HITS_NAME_BRDF(row) B_(row##_hits),
#define FORM_HITS_ROW(shape, row, fn, arg, base, coord, grid) FORM_HITS_##shape(row, fn, arg)
#define FORM_HITS_NAME(shape, row, fn, arg, base, coord, grid) FORM_HITS_NAME_##shape(row)
MCST_ROWS(FORM_HITS_ROW)
bench_hits_form *const B_(hits_forms)[] = {MCST_ROWS(FORM_HITS_NAME)};

#undef FORM_CAT_
#undef FORM_CAT
#undef M_
#undef F_
#undef B_
#undef FORM_ARGS_0
#undef FORM_ARGS_1
#undef FORM_ARGS_2
#undef FORM_ARGS_corners
#undef FORM_ARGS_cross
#undef FORM_ARGS_ball
#undef FORM_ARGS_disk_light
#undef FORM_MAKE_rectangle
#undef FORM_MAKE_triangle
#undef FORM_MAKE_phong
#undef FORM_MAKE_ward
#undef FORM_MAKE_ward_gmd
#undef FORM_MAKE_ward_duer
#undef FORM_MAKE_ward_1992
#undef FORM_MAKE_beckmann
#undef FORM_MAKE_ggx
#undef FORM_MAKE_ashikhmin
#undef FORM
#undef FORM_U
#undef FORM_XYZ
#undef FORM_LINE
#undef FORM_PLANE
#undef FORM_DIR
#undef FORM_LIGHT
#undef FORM_POLYGON
#undef FORM_LOBE
#undef FORM_VLOBE
#undef FORM_BRDF
#undef FORM_ROW
#undef FORM_NAME
#undef FORM_HITS_LINE
#undef FORM_HITS_PLANE
#undef FORM_HITS_DIR
#undef FORM_HITS_LIGHT
#undef FORM_HITS_POLYGON
#undef FORM_HITS_LOBE
#undef FORM_HITS_VLOBE
#undef FORM_HITS_BRDF
#undef FORM_HITS_NONE
#undef FORM_HITS_NAME_LINE
#undef FORM_HITS_NAME_PLANE
#undef FORM_HITS_NAME_DIR
#undef FORM_HITS_NAME_LIGHT
#undef FORM_HITS_NAME_POLYGON
#undef FORM_HITS_NAME_LOBE
#undef FORM_HITS_NAME_VLOBE
#undef FORM_HITS_NAME_BRDF
#undef FORM_HITS_ROW
#undef FORM_HITS_NAME
#undef BENCH_W
