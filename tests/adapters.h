/* One uniform shape for every sampler of mcsample.h, at one width.
 *
 * No include guard: registry.h includes this file with MCST_W = 1 (scalar) and, under MCST_WIDE, once more each for 4,
 * 8 and 16; with MCST_LINKED tests/shared does, and elsewhere the functions are declared already. With W = MCST_W and
 * every array in structure-of-arrays order (entry i of lane l is at i * W + l), a row's functions are
 *
 *     sample(p, u1, u2, out)   p: 6 numbers (3 parameters, then wo); out: x, y, z, pdf, weight
 *     pdf(p, x, out)           x: 3 numbers, out: 1           invert(p, x, out)   out: u1, u2
 *     eval(p, x, out)          out: f                         weight(p, x, out)
 *
 * The parameters are per lane too, so that a lane that looks at its neighbour's parameters is found. */
#if defined(MCST_SHARED) || !defined(MCST_LINKED)
#define MCST_CAT_(a, b) a##b
#define MCST_CAT(a, b) MCST_CAT_(a, b)
#if MCST_W == 1
#define M_(name) MCST_CAT(mcs_, name)
#define A_(name) MCST_CAT(mcst1_, name)
#define F_ float
#elif MCST_W == 4
#define M_(name) MCST_CAT(mcs4_, name)
#define A_(name) MCST_CAT(mcst4_, name)
#define F_ mcs4_f
#elif MCST_W == 8
#define M_(name) MCST_CAT(mcs8_, name)
#define A_(name) MCST_CAT(mcst8_, name)
#define F_ mcs8_f
#else
#define M_(name) MCST_CAT(mcs16_, name)
#define A_(name) MCST_CAT(mcst16_, name)
#define F_ mcs16_f
#endif

MCST_HD static inline M_(vec3) A_(load3)(const float *a) {
    M_(vec3) v;
    v.x = M_(load)(a);
    v.y = M_(load)(a + MCST_W);
    v.z = M_(load)(a + 2 * MCST_W);
    return v;
}

MCST_HD static inline void A_(store3)(float *a, M_(vec3) v) {
    M_(store)(a, v.x);
    M_(store)(a + MCST_W, v.y);
    M_(store)(a + 2 * MCST_W, v.z);
}

#define L_ A_
#include "row_lights.h"
#undef L_

#define LD(i) M_(load)(p + (i)*MCST_W)
#define WO A_(load3)(p + 3 * MCST_W)
#define ARGS_0
#define ARGS_1 LD(0),
#define ARGS_2 LD(0), LD(1),
#define ARGS_corners LD(0), LD(1), M_(set)(1.0f), M_(set)(3.0f),
#define ARGS_cross LD(0), M_(set)(0.0f), M_(set)(0.0f), LD(1),
#define ARGS_ball A_(origin)(), A_(aside)(LD(0)), LD(1),
#define ARGS_disk_light A_(origin)(), A_(aside)(LD(0)), A_(tilted)(), LD(1),
#define MAKE_rectangle const M_(spherical_rectangle) m = A_(row_rectangle)(LD(0), LD(1))
#define MAKE_triangle const M_(spherical_triangle) m = A_(row_triangle)(LD(0), LD(1))
#define MAKE_phong const M_(phong) m = M_(phong_make)(LD(0))
#define MAKE_ward MAKE_ward_gmd
#define MAKE_ward_gmd const M_(ward) m = M_(ward_make)(LD(0), LD(1), MCS_WARD_GMD)
#define MAKE_ward_duer const M_(ward) m = M_(ward_make)(LD(0), LD(1), MCS_WARD_DUER)
#define MAKE_ward_1992 const M_(ward) m = M_(ward_make)(LD(0), LD(1), MCS_WARD_1992)
#define MAKE_beckmann const M_(beckmann) m = M_(beckmann_make)(LD(0), LD(1))
#define MAKE_ggx const M_(ggx) m = M_(ggx_make)(LD(0), LD(1))
#define MAKE_ashikhmin const M_(ashikhmin) m = M_(ashikhmin_make)(LD(0), LD(1))

#define MCST_LINE(row, fn, args, unused)                                                          \
    MCST_FN void A_(row##_sample)(const float *p, const float *u1, const float *u2, float *out) { \
        const M_(sample1) s = M_(fn##_sample)(ARGS_##args M_(load)(u1));                          \
        (void)p, (void)u2;                                                                        \
        M_(store)(out, s.x);                                                                      \
        M_(store)(out + 3 * MCST_W, s.pdf);                                                       \
    }                                                                                             \
    MCST_FN void A_(row##_pdf)(const float *p, const float *x, float *out) {                      \
        M_(store)(out, M_(fn##_pdf)(ARGS_##args M_(load)(x)));                                    \
    }                                                                                             \
    MCST_FN void A_(row##_invert)(const float *p, const float *x, float *out) {                   \
        M_(store)(out, M_(fn##_invert)(ARGS_##args M_(load)(x)));                                 \
    }

#define MCST_PLANE(row, fn, args, unused)                                                         \
    MCST_FN void A_(row##_sample)(const float *p, const float *u1, const float *u2, float *out) { \
        const M_(sample2) s = M_(fn##_sample)(ARGS_##args M_(load)(u1), M_(load)(u2));            \
        (void)p;                                                                                  \
        M_(store)(out, s.x);                                                                      \
        M_(store)(out + MCST_W, s.y);                                                             \
        M_(store)(out + 3 * MCST_W, s.pdf);                                                       \
    }                                                                                             \
    MCST_FN void A_(row##_pdf)(const float *p, const float *x, float *out) {                      \
        (void)p;                                                                                  \
        M_(store)(out, M_(fn##_pdf)(ARGS_##args M_(load)(x), M_(load)(x + MCST_W)));              \
    }                                                                                             \
    MCST_FN void A_(row##_invert)(const float *p, const float *x, float *out) {                   \
        const M_(vec2) u = M_(fn##_invert)(ARGS_##args M_(load)(x), M_(load)(x + MCST_W));        \
        (void)p;                                                                                  \
        M_(store)(out, u.x);                                                                      \
        M_(store)(out + MCST_W, u.y);                                                             \
    }

/* A direction from a sampler whose leading arguments are given by `lead` (with its comma) after the statement `make`.
 * The sampler returns a `type`, and `more` stores what it has beside w and pdf. `lead` comes last, as it has commas. */
#define MCST_TOWARDS(row, fn, type, more, make, ...)                                              \
    MCST_FN void A_(row##_sample)(const float *p, const float *u1, const float *u2, float *out) { \
        make;                                                                                     \
        const M_(type) s = M_(fn##_sample)(__VA_ARGS__ M_(load)(u1), M_(load)(u2));               \
        A_(store3)(out, s.w);                                                                     \
        M_(store)(out + 3 * MCST_W, s.pdf);                                                       \
        more;                                                                                     \
    }                                                                                             \
    MCST_FN void A_(row##_pdf)(const float *p, const float *x, float *out) {                      \
        make;                                                                                     \
        M_(store)(out, M_(fn##_pdf)(__VA_ARGS__ A_(load3)(x)));                                   \
    }                                                                                             \
    MCST_FN void A_(row##_invert)(const float *p, const float *x, float *out) {                   \
        make;                                                                                     \
        const M_(vec2) u = M_(fn##_invert)(__VA_ARGS__ A_(load3)(x));                             \
        M_(store)(out, u.x);                                                                      \
        M_(store)(out + MCST_W, u.y);                                                             \
    }
#define MCST_DIRECTION(row, fn, make, lead) MCST_TOWARDS(row, fn, dir, (void)0, make, lead)
#define LEAD_M &m,
#define LEAD_M_WO &m, WO,
#define MCST_DIR(row, fn, args, unused) MCST_DIRECTION(row, fn, (void)p, ARGS_##args)
#define MCST_LIGHT(row, fn, args, unused) \
    MCST_TOWARDS(row, fn, light, M_(store)(out + 4 * MCST_W, s.distance), (void)p, ARGS_##args)
#define MCST_POLYGON(row, fn, mat, unused) \
    MCST_TOWARDS(row, fn, light_point, M_(store)(out + 4 * MCST_W, s.distance), MAKE_##mat, LEAD_M)
#define MCST_LOBE(row, fn, mat, unused) MCST_DIRECTION(row, fn, MAKE_##mat, LEAD_M)
#define MCST_VLOBE(row, fn, mat, unused) MCST_DIRECTION(row, fn, MAKE_##mat, LEAD_M_WO)

#define MCST_BRDF(row, fn, mat, base)                                                             \
    MCST_FN void A_(row##_sample)(const float *p, const float *u1, const float *u2, float *out) { \
        MAKE_##mat;                                                                               \
        const M_(brdf) s = M_(fn##_sample)(&m, WO, M_(load)(u1), M_(load)(u2));                   \
        A_(store3)(out, s.wi);                                                                    \
        M_(store)(out + 3 * MCST_W, s.pdf);                                                       \
        M_(store)(out + 4 * MCST_W, s.weight);                                                    \
    }                                                                                             \
    MCST_FN void A_(row##_pdf)(const float *p, const float *x, float *out) {                      \
        MAKE_##mat;                                                                               \
        M_(store)(out, M_(fn##_pdf)(&m, WO, A_(load3)(x)));                                       \
    }                                                                                             \
    MCST_FN void A_(row##_eval)(const float *p, const float *x, float *out) {                     \
        MAKE_##mat;                                                                               \
        M_(store)(out, M_(base##_eval)(&m, WO, A_(load3)(x)));                                    \
    }                                                                                             \
    MCST_FN void A_(row##_weight)(const float *p, const float *x, float *out) {                   \
        MAKE_##mat;                                                                               \
        M_(store)(out, M_(fn##_weight)(&m, WO, A_(load3)(x)));                                    \
    }

#define MCST_ADAPT(shape, row, fn, arg, base, coord, grid) MCST_##shape(row, fn, arg, base)
MCST_ROWS(MCST_ADAPT)

#if MCST_W == 1
/* The array forms: out[0..4] = x, y, z, pdf, and weight or distance. */
#define MCST_N_LINE(row, fn, args, unused)                                                                           \
    MCST_HOST_FN void mcstn_##row(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]) { \
        (void)p, (void)u2;                                                                                           \
        mcs_##fn##_sample_n(ARGS_##args n, u1, out[0], out[3]);                                                      \
    }
#define MCST_N_PLANE(row, fn, args, unused)                                                                          \
    MCST_HOST_FN void mcstn_##row(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]) { \
        (void)p;                                                                                                     \
        mcs_##fn##_sample_n(ARGS_##args n, u1, u2, out[0], out[1], out[3]);                                          \
    }
#define MCST_N_DIRECTION(row, fn, make, lead)                                                                        \
    MCST_HOST_FN void mcstn_##row(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]) { \
        make;                                                                                                        \
        mcs_##fn##_sample_n(lead n, u1, u2, out[0], out[1], out[2], out[3]);                                         \
    }
#define MCST_N_DIR(row, fn, args, unused) MCST_N_DIRECTION(row, fn, (void)p, ARGS_##args)
#define MCST_N_LIGHT(row, fn, args, unused)                                                                          \
    MCST_HOST_FN void mcstn_##row(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]) { \
        mcs_##fn##_sample_n(ARGS_##args n, u1, u2, out[0], out[1], out[2], out[3], out[4]);                          \
    }
#define MCST_N_POLYGON(row, fn, mat, unused)                                                                         \
    MCST_HOST_FN void mcstn_##row(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]) { \
        MAKE_##mat;                                                                                                  \
        mcs_##fn##_sample_n(&m, n, u1, u2, out[0], out[1], out[2], out[3], out[4], NULL, NULL);                      \
    }
#define MCST_N_LOBE(row, fn, mat, unused) MCST_N_DIRECTION(row, fn, MAKE_##mat, LEAD_M)
#define MCST_N_VLOBE(row, fn, mat, unused) MCST_N_DIRECTION(row, fn, MAKE_##mat, LEAD_M_WO)
#define MCST_N_BRDF(row, fn, mat, base)                                                                                \
    MCST_HOST_FN void mcstn_##row(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]) {   \
        MAKE_##mat;                                                                                                    \
        mcs_##fn##_sample_n(&m, WO, n, u1, u2, out[0], out[1], out[2], out[3], out[4]);                                \
    }                                                                                                                  \
    MCST_HOST_FN void mcstn_##row##_pdf(const float *p, size_t n, const float *x, const float *y, const float *z,      \
                                        float *out) {                                                                  \
        MAKE_##mat;                                                                                                    \
        mcs_##fn##_pdf_n(&m, WO, n, x, y, z, out);                                                                     \
    }                                                                                                                  \
    MCST_HOST_FN void mcstn_##row##_eval(const float *p, size_t n, const float *x, const float *y, const float *z,     \
                                         float *out) {                                                                 \
        MAKE_##mat;                                                                                                    \
        mcs_##base##_eval_n(&m, WO, n, x, y, z, out);                                                                  \
    }                                                                                                                  \
    MCST_HOST_FN void mcstn_##row##_sample_hits(const float *p, const mcs_hits *hits, size_t n,                        \
                                                const float *const in[3], float *const out[5]) {                       \
        MAKE_##mat;                                                                                                    \
        mcs_##fn##_sample_hits_n(&m, hits, n, in[0], in[1], out[0], out[1], out[2], out[3], out[4]);                   \
    }                                                                                                                  \
    MCST_HOST_FN void mcstn_##row##_pdf_hits(const float *p, const mcs_hits *hits, size_t n, const float *const in[3], \
                                             float *const out[5]) {                                                    \
        MAKE_##mat;                                                                                                    \
        mcs_##fn##_pdf_hits_n(&m, hits, n, in[0], in[1], in[2], out[0], out[1]);                                       \
    }
#define MCST_ADAPT_N(shape, row, fn, arg, base, coord, grid) MCST_N_##shape(row, fn, arg, base)
MCST_ROWS(MCST_ADAPT_N)
#undef MCST_N_LINE
#undef MCST_N_PLANE
#undef MCST_N_DIRECTION
#undef MCST_N_DIR
#undef MCST_N_LIGHT
#undef MCST_N_POLYGON
#undef MCST_N_LOBE
#undef MCST_N_VLOBE
#undef MCST_N_BRDF
#undef MCST_ADAPT_N
#endif

#undef MCST_CAT_
#undef MCST_CAT
#undef M_
#undef A_
#undef F_
#undef LD
#undef WO
#undef ARGS_0
#undef ARGS_1
#undef ARGS_2
#undef ARGS_corners
#undef ARGS_cross
#undef ARGS_ball
#undef ARGS_disk_light
#undef MAKE_rectangle
#undef MAKE_triangle
#undef MAKE_phong
#undef MAKE_ward
#undef MAKE_ward_gmd
#undef MAKE_ward_duer
#undef MAKE_ward_1992
#undef MAKE_beckmann
#undef MAKE_ggx
#undef MAKE_ashikhmin
#undef MCST_LINE
#undef MCST_PLANE
#undef MCST_TOWARDS
#undef MCST_DIRECTION
#undef LEAD_M
#undef LEAD_M_WO
#undef MCST_DIR
#undef MCST_LIGHT
#undef MCST_POLYGON
#undef MCST_LOBE
#undef MCST_VLOBE
#undef MCST_BRDF
#undef MCST_ADAPT
#endif
#undef MCST_W
