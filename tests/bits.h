/* The functions of mcsample.h that have no row in registry.h, in one uniform shape, for functions.h.
 *
 * No include guard: like adapters.h this file is included once per width, MCST_W = 1, 4, 8 or 16, and without MCST_W
 * for its lists alone. F_ and U_ are the types of floats and words, M_(x) is the name x of mcsample.h at that width and
 * B_(x) the name of its adapter. As in adapters.h entry i of lane l is at i * W + l:
 *
 *     B_(x)(in, out)   in: 0..2 parameters, 3..5 a direction, 6, 7 random numbers, 8..10 a point, 11..13 words
 *                      out: BITS_OUT entries, set to 0 before
 *
 * Words travel as the bits of floats. A name needs its function here and its place in one of the lists: floats at every
 * width, words at every width, what there is only once, what takes a map or a product, what needs more memory than a
 * thread of a kernel should have, and array forms with the number of their maps or products: their bits1_x is what the
 * scalar form gives, and bits_array_x computes n cases of one map or product. */
/* clang-format off */
#ifndef BITS_WIDE
#define BITS_WIDE(X) \
    X(u01) X(u01_open) X(sobol) X(r2) X(cone_from_sin2) X(frame_make) X(frame_from_tangent) X(to_world) X(to_local) \
    X(reflect) X(reflect_pdf) X(half) X(cos_d) X(schlick) X(fresnel_dielectric) X(fresnel_conductor) X(refract) \
    X(pdf_to_solid_angle) X(pdf_to_area) X(spherical_rectangle_make) X(spherical_triangle_make) \
    X(phong_make) X(ward_make) X(beckmann_make) X(ggx_make) X(ashikhmin_make) X(is_mirror) X(ggx_d) X(ggx_g1) \
    X(ggx_g2) X(ggx_albedo) X(ggx_mean_albedo) X(ggx_compensation) X(ggx_glass_sample) \
    X(ggx_glass_pdf) X(ggx_glass_eval) X(ggx_glass_weight) X(mis_balance) X(mis_power) X(mix_pdf) X(set)
#define BITS_WORDS(X) \
    X(hash) X(sobol_bits) X(load) X(store)
#define BITS_SCALAR(X) \
    X(pcg32_for) X(pcg32_make) X(pcg32_next) X(pcg32_float) X(pcg32_advance) X(pcg32_fill_n) X(philox) \
    X(philox_fill_n) X(sobol_n) X(to_world_n) X(to_local_n) X(sobol_pixel) X(stratified) X(latin) \
    X(pwc_bytes) X(pwc_build) X(pwc_build_fn) X(pwc_sample) X(pwc_sample_bits) X(pwc_pdf) X(pwc_invert) \
    X(pwc_sample_n) X(discrete_bytes) X(discrete_build) X(discrete_sample) X(discrete_sample_bits) \
    X(discrete_pmf) X(discrete_sample_n) X(pwl_bytes) X(pwl_build) \
    X(pwl_sample) X(pwl_sample_bits) X(pwl_pdf) X(pwl_invert) X(pwl_sample_n) X(pwc2_bytes) X(pwc2_build) \
    X(pwc2_sample) X(pwc2_pdf) X(pwc2_invert) X(pwc2_sample_n) X(alias_bytes) X(alias_build) X(alias_sample) \
    X(alias_sample_bits) X(alias_pmf) X(alias_sample_n) X(reservoir_add) X(reservoir_merge) X(reservoir_weight) \
    X(reservoir_k_make) X(reservoir_k_add) X(reservoir_k_merge) X(reservoir_k_weight) X(stat_add) X(stat_merge) \
    X(stat_variance) X(stat_error) X(stat_ci)
#define BITS_MAPPED(X) \
    X(image_make) X(env_bytes) X(env_build) X(env_build_rows) X(env_finish) X(env_check) X(env_mean) X(env_sample) \
    X(env_sample_bits) X(env_pdf) X(env_invert) X(env_texel) X(env_weight) X(env_window_bytes) X(env_window_build) \
    X(env_window_sample) X(env_window_pdf) X(tiles_bytes) X(tiles_build) X(tiles_direction) X(tiles_of_texel) \
    X(tiles_of_direction) X(product_bytes) X(product_table_bytes) X(product_sample) X(product_pdf) X(product_texel) \
    X(region_bytes) X(region_visibility) X(region_pays) X(region_share)
#define BITS_HOST(X) \
    X(product_build) X(product_build_region) X(product_build_weights) X(region_start) X(region_add_point) \
    X(region_add_ray) X(region_merge) X(region_inherit) X(region_decay)
#define BITS_ARRAYS(X) \
    X(env_sample_n, BITS_MAPS) X(env_texel_n, BITS_MAPS) X(env_pdf_n, BITS_MAPS) X(env_window_sample_n, BITS_MAPS) \
    X(product_sample_n, BITS_MAPS * BITS_PRODUCTS) X(product_pdf_n, BITS_MAPS * BITS_PRODUCTS)
#endif
/* clang-format on */

#ifdef MCST_W
#if MCST_W == 1
#define F_ float
#define U_ uint32_t
#define M_(x) mcs_##x
#define B_(x) bits1_##x
#elif MCST_W == 4
#define F_ mcs4_f
#define U_ mcs4_u
#define M_(x) mcs4_##x
#define B_(x) bits4_##x
#elif MCST_W == 8
#define F_ mcs8_f
#define U_ mcs8_u
#define M_(x) mcs8_##x
#define B_(x) bits8_##x
#else
#define F_ mcs16_f
#define U_ mcs16_u
#define M_(x) mcs16_##x
#define B_(x) bits16_##x
#endif

#define FN(name) MCST_FN void B_(name)(const float *in, float *out)

MCST_HD static F_ B_(in)(const float *in, int i) {
    F_ v;
    memcpy(&v, in + i * MCST_W, sizeof v);
    return v;
}
MCST_HD static M_(vec3) B_(in3)(const float *in, int i) {
    M_(vec3) v;
    v.x = B_(in)(in, i), v.y = B_(in)(in, i + 1), v.z = B_(in)(in, i + 2);
    return v;
}
MCST_HD static U_ B_(word)(const float *in, int i) {
    U_ v;
    memcpy(&v, in + i * MCST_W, sizeof v);
    return v;
}
MCST_HD static void B_(put)(float *out, int i, F_ v) { memcpy(out + i * MCST_W, &v, sizeof v); }
MCST_HD static void B_(put_word)(float *out, int i, U_ v) { memcpy(out + i * MCST_W, &v, sizeof v); }
#define IN(i) B_(in)(in, i)
#define IN3(i) B_(in3)(in, i)
#define WORD(i) B_(word)(in, i)
#define PUT(i, v) B_(put)(out, i, v)
#define PUT_WORD(i, v) B_(put_word)(out, i, v)
MCST_HD static void B_(put2)(float *out, int i, M_(vec2) v) { PUT(i, v.x), PUT(i + 1, v.y); }
MCST_HD static void B_(put3)(float *out, int i, M_(vec3) v) { PUT(i, v.x), PUT(i + 1, v.y), PUT(i + 2, v.z); }

FN(set) {
    (void)in;
    PUT(0, M_(set)(0.7f));
}
FN(load) { PUT(0, M_(load)(in + 6 * MCST_W)); }
FN(store) { M_(store)(out, IN(6)); }
FN(u01) { PUT(0, M_(u01)(WORD(11))); }
FN(u01_open) { PUT(0, M_(u01_open)(WORD(11))); }
FN(hash) { PUT_WORD(0, M_(hash)(WORD(11), WORD(12))); }
FN(sobol_bits) { /* dimension and seed are the same for all lanes */
    PUT_WORD(0, M_(sobol_bits)(WORD(11), 0, 0)), PUT_WORD(1, M_(sobol_bits)(WORD(11), 1, 7));
    PUT_WORD(2, M_(sobol_bits)(WORD(11), 6, 0x9e3779b9u)), PUT_WORD(3, M_(sobol_bits)(WORD(11), 0xffffffffu, 1));
}
FN(sobol) {
    PUT(0, M_(sobol)(WORD(11), 0, 0)), PUT(1, M_(sobol)(WORD(11), 3, 7)), PUT(2, M_(sobol)(WORD(11), 1000, 1));
}
FN(r2) { B_(put2)(out, 0, M_(r2)(WORD(11), 0)), B_(put2)(out, 2, M_(r2)(WORD(11), 0x9e3779b9u)); }
FN(cone_from_sin2) { PUT(0, M_(cone_from_sin2)(IN(6))); }

FN(frame_make) {
    const M_(frame) f = M_(frame_make)(IN3(3));
    B_(put3)(out, 0, f.s), B_(put3)(out, 3, f.t), B_(put3)(out, 6, f.n);
}
FN(frame_from_tangent) {
    const M_(frame) f = M_(frame_from_tangent)(IN3(3), IN3(8));
    B_(put3)(out, 0, f.s), B_(put3)(out, 3, f.t), B_(put3)(out, 6, f.n);
}
FN(to_world) {
    const M_(frame) f = M_(frame_make)(IN3(3));
    B_(put3)(out, 0, M_(to_world)(&f, IN3(8)));
}
FN(to_local) {
    const M_(frame) f = M_(frame_make)(IN3(3));
    B_(put3)(out, 0, M_(to_local)(&f, IN3(8)));
}
FN(reflect) { B_(put3)(out, 0, M_(reflect)(IN3(3), IN3(8))); }
FN(reflect_pdf) { PUT(0, M_(reflect_pdf)(IN(0), IN(6))); }
FN(half) { B_(put3)(out, 0, M_(half)(IN3(3), IN3(8))); }
FN(cos_d) { PUT(0, M_(cos_d)(IN3(3), IN3(8))); }
FN(schlick) { PUT(0, M_(schlick)(IN(6), IN(7))); }
/* A parameter is mostly no index of refraction: a random number makes one of 1/2 to 5/2. Where a function is called
 * several times, it is in a loop: each call is inlined, and at 16 lanes has up to 40 kB. */
FN(fresnel_dielectric) {
    const F_ eta = 0.5f + 2.0f * IN(7);
    const F_ cosine[4] = {IN(10), IN(10), IN(6), -IN(6)};
    int i;
    for (i = 0; i < 4; i++) PUT(i, M_(fresnel_dielectric)(cosine[i], i ? eta : IN(0)));
}
FN(fresnel_conductor) {
    const F_ eta = 0.5f + 2.0f * IN(7);
    const F_ cosine[4] = {IN(10), IN(10), IN(10), IN(6)};
    const F_ k[4] = {IN(1), IN(1), IN(6), IN(0)};
    int i;
    for (i = 0; i < 4; i++) PUT(i, M_(fresnel_conductor)(cosine[i], i ? eta : IN(0), k[i]));
}
FN(refract) {
    const F_ eta[2] = {IN(0), 0.5f + 2.0f * IN(7)};
    int i;
    for (i = 0; i < 2; i++) B_(put3)(out, 3 * i, M_(refract)(IN3(3), IN3(8), eta[i]));
}

/* A prepared material is opaque: it is seen through its functions. */
#define MAKE(name, ...)                                                   \
    FN(name##_make) {                                                     \
        const M_(name) m = M_(name##_make)(__VA_ARGS__);                  \
        PUT(0, M_(name##_pdf)(&m, IN3(3), IN3(8)));                       \
        PUT(1, M_(name##_eval)(&m, IN3(3), IN3(8)));                      \
        B_(put3)(out, 2, M_(name##_sample)(&m, IN3(3), IN(6), IN(7)).wi); \
    }
MAKE(phong, IN(0))
MAKE(beckmann, IN(0), IN(1))
MAKE(ggx, IN(0), IN(1))
MAKE(ashikhmin, IN(0), IN(1))
#undef MAKE
FN(ward_make) {
    const mcs_ward_model models[3] = {MCS_WARD_GMD, MCS_WARD_DUER, MCS_WARD_1992};
    int i;
    for (i = 0; i < 3; i++) {
        const M_(ward) m = M_(ward_make)(IN(0), IN(1), models[i]);
        PUT(3 * i, M_(ward_pdf)(&m, IN3(3), IN3(8))), PUT(3 * i + 1, M_(ward_eval)(&m, IN3(3), IN3(8)));
        PUT(3 * i + 2, M_(ward_sample)(&m, IN3(3), IN(6), IN(7)).weight);
    }
}
FN(is_mirror) { PUT_WORD(0, (U_)M_(is_mirror)(IN(0), IN(1)) & 1u); } /* lanes give all bits for yes */
/* A light beside and before the point, with the places on it. */
FN(pdf_to_solid_angle) { PUT(0, M_(pdf_to_solid_angle)(IN(0), IN(1), IN(5))); }
FN(pdf_to_area) { PUT(0, M_(pdf_to_area)(IN(0), IN(1), IN(5))); }
#define POLYGON(name)                                                                     \
    FN(name##_make) {                                                                     \
        const M_(vec3) up = {M_(set)(0.0f), IN(6), M_(set)(1.0f)};                        \
        const M_(name) l = M_(name##_make)(IN3(8), up, IN3(3), IN3(0));                   \
        const M_(light_point) s = M_(name##_sample)(&l, IN(6), IN(7));                    \
        B_(put3)(out, 0, s.w), PUT(3, s.pdf), PUT(4, s.x), PUT(5, s.y);                   \
        PUT(6, M_(name##_pdf)(&l, IN3(3))), B_(put2)(out, 7, M_(name##_invert)(&l, s.w)); \
    }
POLYGON(spherical_rectangle)
POLYGON(spherical_triangle)
#undef POLYGON
#define GGX const M_(ggx) m = M_(ggx_make)(IN(0), IN(1))
FN(ggx_d) {
    GGX;
    PUT(0, M_(ggx_d)(&m, IN3(8)));
}
FN(ggx_g1) {
    GGX;
    PUT(0, M_(ggx_g1)(&m, IN3(8)));
}
FN(ggx_g2) {
    GGX;
    PUT(0, M_(ggx_g2)(&m, IN3(3), IN3(8)));
}
FN(ggx_albedo) {
    GGX;
    PUT(0, M_(ggx_albedo)(&m, IN3(8)));
}
FN(ggx_mean_albedo) {
    GGX;
    PUT(0, M_(ggx_mean_albedo)(&m));
}
FN(ggx_compensation) {
    GGX;
    PUT(0, M_(ggx_compensation)(&m, IN3(3), IN3(8)));
}
/* The third random number and the index are made of what there is. The second case is seen from behind. */
FN(ggx_glass_sample) {
    GGX;
    const F_ eta = 0.5f + 2.0f * IN(10) * IN(10);
    M_(vec3) wo = IN3(3);
    int i;
    for (i = 0; i < 2; i++) {
        const M_(brdf) s = M_(ggx_glass_sample)(&m, eta, wo, IN(6), IN(7), 0.5f * (IN(6) + IN(7)));
        B_(put3)(out, 5 * i, s.wi), PUT(5 * i + 3, s.pdf);
        if (!i) PUT(4, s.weight);
        wo.z = -wo.z;
    }
}
/* There and back, by reflection or by refraction as z has it. */
#define GLASS(name)                                                                                \
    FN(ggx_glass_##name) {                                                                         \
        GGX;                                                                                       \
        const F_ eta[2] = {0.5f + 2.0f * IN(7), IN(0)};                                            \
        M_(vec3) w[3];                                                                             \
        int i;                                                                                     \
        w[0] = IN3(3), w[1] = IN3(8), w[2] = w[1], w[2].z = -w[2].z;                               \
        for (i = 0; i < 4; i++) {                                                                  \
            const int with = 1 + i / 2;                                                            \
            PUT(i, M_(ggx_glass_##name)(&m, eta[i == 1], w[i % 2 * with], w[(1 - i % 2) * with])); \
        }                                                                                          \
    }
GLASS(pdf)
GLASS(eval)
GLASS(weight)
#undef GLASS
#undef GGX
FN(mis_balance) { PUT(0, M_(mis_balance)(IN(0), IN(1))); }
FN(mis_power) { PUT(0, M_(mis_power)(IN(0), IN(1))); }
FN(mix_pdf) { PUT(0, M_(mix_pdf)(IN(6), IN(0), IN(1))); }

#if MCST_W == 1
#define WORD2(i) ((uint64_t)WORD(i) << 32 | WORD((i) + 1))
MCST_HD static void bits_put_word2(float *out, int i, uint64_t v) {
    PUT_WORD(i, (uint32_t)v), PUT_WORD(i + 1, (uint32_t)(v >> 32));
}
MCST_HD static void bits_put_double(float *out, int i, double v) {
    uint64_t word;
    memcpy(&word, &v, sizeof word);
    bits_put_word2(out, i, word);
}
/* Arrays longer than `out` are seen through their hash. */
MCST_HD static void bits_put_array(float *out, int i, const void *a, size_t n) {
    bits_put_word2(out, i, bits_hash(BITS_START, a, n));
}
enum { BITS_LONG = 200, BITS_CELLS = 40 };

FN(pcg32_for) {
    const mcs_pcg32 r = mcs_pcg32_for(WORD2(11), WORD2(12), WORD(13));
    bits_put_word2(out, 0, r.state), bits_put_word2(out, 2, r.inc);
}
FN(pcg32_make) {
    const mcs_pcg32 r = mcs_pcg32_make(WORD2(11), WORD(13));
    bits_put_word2(out, 0, r.state), bits_put_word2(out, 2, r.inc);
}
FN(pcg32_next) {
    mcs_pcg32 r = mcs_pcg32_make(WORD2(11), WORD(13));
    int i;
    for (i = 0; i < 8; i++) PUT_WORD(i, mcs_pcg32_next(&r));
}
FN(pcg32_float) {
    mcs_pcg32 r = mcs_pcg32_make(WORD2(11), WORD(13));
    int i;
    for (i = 0; i < 8; i++) PUT(i, mcs_pcg32_float(&r));
}
FN(pcg32_advance) {
    mcs_pcg32 r = mcs_pcg32_make(1, WORD(13));
    mcs_pcg32_advance(&r, WORD2(11));
    bits_put_word2(out, 0, r.state);
    mcs_pcg32_advance(&r, WORD(11));
    bits_put_word2(out, 2, r.state);
}
FN(pcg32_fill_n) {
    mcs_pcg32 r = mcs_pcg32_make(1, WORD(13));
    float a[BITS_LONG];
    const size_t n = WORD(11) % (BITS_LONG + 1);
    mcs_pcg32_fill_n(&r, n, a);
    bits_put_array(out, 0, a, n), bits_put_word2(out, 2, r.state);
}
FN(philox) {
    const mcs_philox4 c = mcs_philox(WORD2(11), WORD2(12), WORD(13));
    int i;
    for (i = 0; i < 4; i++) PUT_WORD(i, c.v[i]);
}
FN(philox_fill_n) {
    float a[BITS_LONG];
    const size_t n = WORD(13) % (BITS_LONG + 1);
    mcs_philox_fill_n(WORD2(11), WORD2(12), n, a);
    bits_put_array(out, 0, a, n);
}
FN(sobol_n) {
    float a[BITS_LONG];
    const size_t n = WORD(13) % (BITS_LONG + 1);
    mcs_sobol_n(WORD(11), WORD(12) % 9, WORD(13), n, a);
    bits_put_array(out, 0, a, n);
}
/* Unit normals, or nearly, and one of any kind. */
MCST_HD static size_t bits_turns(const float *in, float from[6][BITS_LONG]) {
    mcs_pcg32 r = mcs_pcg32_make(1, WORD(13));
    int k;
    for (k = 0; k < 6; k++) mcs_pcg32_fill_n(&r, BITS_LONG, from[k]);
    mcs_sphere_sample_n(BITS_LONG, from[0], from[1], from[0], from[1], from[2], NULL);
    for (k = 0; k < 3; k++) from[k][0] = IN(3 + k), from[3 + k][0] = IN(8 + k);
    return WORD(11) % (BITS_LONG + 1);
}
FN(to_world_n) {
    float f[6][BITS_LONG];
    const size_t n = bits_turns(in, f);
    mcs_to_world_n(n, f[0], f[1], f[2], f[3], f[4], f[5], f[3], f[4], f[5]);
    for (int k = 0; k < 3; k++) bits_put_array(out, 2 * k, f[3 + k], n);
}
FN(to_local_n) {
    float f[6][BITS_LONG];
    const size_t n = bits_turns(in, f);
    mcs_to_local_n(n, f[0], f[1], f[2], f[3], f[4], f[5], f[3], f[4], f[5]);
    for (int k = 0; k < 3; k++) bits_put_array(out, 2 * k, f[3 + k], n);
}
FN(sobol_pixel) { PUT_WORD(0, mcs_sobol_pixel(WORD(11), WORD(12), WORD(13) >> (WORD(12) & 31), WORD(13))); }
FN(stratified) { B_(put2)(out, 0, mcs_stratified(WORD(11), WORD(12) % 50, WORD(13) % 70, WORD(13))); }
FN(latin) { PUT(0, mcs_latin(WORD(11), WORD(12) % 5000, WORD(13) % 9, WORD(13))); }

/* A bad entry, unless a test wants none. */
MCST_HD static float bits_bad(float x) {
#ifdef __CUDA_ARCH__
    return x;
#else
    return bits_valid ? 0.0f : x;
#endif
}

/* Small tables, built anew for every case: of 1 to BITS_CELLS entries, some of them 0 or bad, now and then all 0. */
MCST_HD static uint32_t bits_entries(const float *in, float *f) {
    const uint32_t n = 1 + WORD(11) % BITS_CELLS;
    uint32_t i;
    for (i = 0; i <= n; i++) {
        const uint32_t h = mcs_hash(WORD(12), i);
        f[i] = WORD(13) % 16 == 0 || h % 8 == 0 ? 0.0f
               : h % 128 == 1                   ? bits_bad(-1.0f)
                                                : mcs_u01(h) * (h % 8 == 1 ? 1e6f : 1.0f);
    }
    return n;
}
/* What a builder says: an error, or whether all was zero. */
MCST_HD static uint32_t bits_said(mcs_status status, uint32_t black) {
    return status < 0 ? (uint32_t)status : black != 0;
}
#define TABLE(kind)                                                     \
    uint64_t room[4 * BITS_CELLS] = {0};                                \
    float f[BITS_CELLS + 1];                                            \
    const uint32_t n = bits_entries(in, f);                             \
    mcs_##kind *t = (mcs_##kind *)(void *)room;                         \
    const mcs_status status = mcs_##kind##_build(t, sizeof room, f, n); \
    (void)status

FN(pwc_bytes) { PUT_WORD(0, (uint32_t)mcs_pwc_bytes(WORD(11) >> (WORD(12) & 31))); }
FN(pwc_build) {
    TABLE(pwc);
    PUT_WORD(0, bits_said(status, t->uniform)), PUT_WORD(1, t->bad), bits_put_double(out, 2, t->total);
}
MCST_HD static float bits_curve(float x, void *k) { return *(const float *)k * (1.0f + x * x); }
FN(pwc_build_fn) {
    uint64_t room[4 * BITS_CELLS] = {0};
    mcs_pwc *t = (mcs_pwc *)(void *)room;
    float k = IN(0);
    const mcs_status status = mcs_pwc_build_fn(t, sizeof room, bits_curve, &k, 1 + WORD(11) % BITS_CELLS);
    PUT_WORD(0, bits_said(status, t->uniform));
    PUT_WORD(1, t->bad), bits_put_double(out, 2, t->total), PUT(4, mcs_pwc_pdf(t, 0.3f)), PUT(5, mcs_pwc_pdf(t, 0.7f));
}
#define TABLE_DENSITY(kind)                                \
    FN(kind##_sample) {                                    \
        TABLE(kind);                                       \
        const mcs_cell c = mcs_##kind##_sample(t, IN(6));  \
        PUT(0, c.x), PUT(1, c.pdf), PUT_WORD(2, c.i);      \
    }                                                      \
    FN(kind##_pdf) {                                       \
        TABLE(kind);                                       \
        PUT(0, mcs_##kind##_pdf(t, IN(6)));                \
    }                                                      \
    FN(kind##_invert) {                                    \
        TABLE(kind);                                       \
        PUT(0, mcs_##kind##_invert(t, IN(6)));             \
    }                                                      \
    FN(kind##_sample_n) {                                  \
        TABLE(kind);                                       \
        mcs_##kind##_sample_n(t, 2, in + 6, out, out + 2); \
    }
TABLE_DENSITY(pwc)
TABLE_DENSITY(pwl)
#undef TABLE_DENSITY
FN(discrete_bytes) { PUT_WORD(0, (uint32_t)mcs_discrete_bytes(WORD(11) >> (WORD(12) & 31))); }
FN(discrete_build) {
    TABLE(discrete);
    PUT_WORD(0, bits_said(status, t->uniform)), PUT_WORD(1, t->bad), bits_put_double(out, 2, t->total);
}
FN(discrete_sample) {
    TABLE(discrete);
    const mcs_pick c = mcs_discrete_sample(t, IN(6));
    PUT_WORD(0, c.i), PUT(1, c.pmf), PUT(2, c.u);
}
FN(discrete_pmf) {
    TABLE(discrete);
    PUT(0, mcs_discrete_pmf(t, WORD(13) % BITS_CELLS));
}
FN(discrete_sample_bits) {
    TABLE(discrete);
    const mcs_pick c = mcs_discrete_sample_bits(t, WORD(11), WORD(12));
    PUT_WORD(0, c.i), PUT(1, c.pmf), PUT(2, c.u);
}
#define TABLE_BITS(kind)                                                    \
    FN(kind##_sample_bits) {                                                \
        TABLE(kind);                                                        \
        const mcs_cell c = mcs_##kind##_sample_bits(t, WORD(11), WORD(12)); \
        PUT(0, c.x), PUT(1, c.pdf), PUT_WORD(2, c.i);                       \
    }
TABLE_BITS(pwc)
TABLE_BITS(pwl)
#undef TABLE_BITS
FN(pwl_bytes) { PUT_WORD(0, (uint32_t)mcs_pwl_bytes(WORD(11) >> (WORD(12) & 31))); }
FN(pwl_build) {
    TABLE(pwl);
    PUT_WORD(0, bits_said(status, t->cells.uniform)), PUT_WORD(1, t->cells.bad),
        bits_put_double(out, 2, t->cells.total);
}
FN(alias_bytes) { /* beyond the header */
    const size_t bytes = mcs_alias_bytes(WORD(11) >> (WORD(12) & 31));
    PUT_WORD(0, (uint32_t)(bytes ? bytes - sizeof(mcs_alias) + 16 : 0));
}
FN(alias_build) {
    TABLE(alias);
    PUT_WORD(0, bits_said(status, t->uniform)), PUT_WORD(1, t->bad), bits_put_double(out, 2, t->total);
}
FN(alias_sample) {
    TABLE(alias);
    const mcs_pick c = mcs_alias_sample(t, IN(6));
    PUT_WORD(0, c.i), PUT(1, c.pmf), PUT(2, c.u);
}
FN(alias_sample_bits) {
    TABLE(alias);
    const mcs_pick c = mcs_alias_sample_bits(t, WORD(11), WORD(12));
    PUT_WORD(0, c.i), PUT(1, c.pmf), PUT(2, c.u);
}
FN(alias_pmf) {
    TABLE(alias);
    PUT(0, mcs_alias_pmf(t, WORD(13) % BITS_CELLS));
}
#define TABLE_PICKS(kind)                                          \
    FN(kind##_sample_n) {                                          \
        TABLE(kind);                                               \
        uint32_t i;                                                \
        mcs_##kind##_sample_n(t, 1, in + 6, &i, out + 1, out + 2); \
        PUT_WORD(0, i);                                            \
    }
TABLE_PICKS(discrete)
TABLE_PICKS(alias)
#undef TABLE_PICKS
#undef TABLE

#define TABLE2                                                             \
    uint64_t room[6 * BITS_CELLS + 20] = {0};                              \
    float f[BITS_CELLS + 1];                                               \
    const uint32_t n = bits_entries(in, f);                                \
    const uint32_t w = 1 + WORD(12) % n;                                   \
    mcs_pwc2 *t = (mcs_pwc2 *)(void *)room;                                \
    const mcs_status status = mcs_pwc2_build(t, sizeof room, f, w, n / w); \
    (void)status
FN(pwc2_bytes) { /* of sizes that a machine of 32 bits has room for, or of none */
    const uint32_t w = WORD(11) >> (WORD(13) & 31), h = WORD(12) >> (WORD(11) & 31);
    PUT_WORD(0, (uint32_t)mcs_pwc2_bytes(w, 1 + h % 256)), PUT_WORD(1, (uint32_t)mcs_pwc2_bytes(1 + w % 256, h));
}
FN(pwc2_build) {
    TABLE2;
    PUT_WORD(0, bits_said(status, t->uniform)), PUT_WORD(1, t->bad), bits_put_double(out, 2, t->total);
}
FN(pwc2_sample) {
    TABLE2;
    const mcs_cell2 c = mcs_pwc2_sample(t, IN(6), IN(7));
    PUT(0, c.x), PUT(1, c.y), PUT(2, c.pdf), PUT_WORD(3, c.col), PUT_WORD(4, c.row);
}
FN(pwc2_pdf) {
    TABLE2;
    PUT(0, mcs_pwc2_pdf(t, IN(6), IN(7)));
}
FN(pwc2_invert) {
    TABLE2;
    B_(put2)(out, 0, mcs_pwc2_invert(t, IN(6), IN(7)));
}
FN(pwc2_sample_n) {
    TABLE2;
    uint32_t cell[2];
    mcs_pwc2_sample_n(t, 1, in + 6, in + 7, out, out + 1, out + 2, cell, cell + 1);
    PUT_WORD(3, cell[0]), PUT_WORD(4, cell[1]);
}
#undef TABLE2

/* Candidate i of a reservoir: weights over 20 decades, one of eight is 0 or bad. */
MCST_HD static float bits_weight(const float *in, uint32_t i) {
    const uint32_t h = mcs_hash(WORD(11), i);
    return h % 8 == 0 ? bits_bad(-1.0f) : (1.0f + mcs_u01(h)) * (h % 8 == 1 ? 1e10f : h % 8 == 2 ? 1e-10f : 1.0f);
}
MCST_HD static mcs_reservoir bits_reservoir(const float *in, uint32_t count) {
    mcs_reservoir r = {0.0, 0.0, 0};
    uint32_t i;
    for (i = 0; i < count; i++) mcs_reservoir_add(&r, i, bits_weight(in, i), (double)mcs_u01(mcs_hash(WORD(12), i)));
    return r;
}
MCST_HD static void bits_put_reservoir(float *out, mcs_reservoir r) {
    bits_put_double(out, 0, r.total), bits_put_double(out, 2, r.n), PUT_WORD(4, r.i);
}
FN(reservoir_add) { bits_put_reservoir(out, bits_reservoir(in, WORD(13) % 9)); }
FN(reservoir_merge) {
    mcs_reservoir r = bits_reservoir(in, WORD(13) % 9);
    const mcs_reservoir other = bits_reservoir(in + 1, WORD(13) / 9 % 9);
    PUT_WORD(5, (uint32_t)mcs_reservoir_merge(&r, &other, (double)IN(6)));
    bits_put_reservoir(out, r);
}
FN(reservoir_weight) {
    const mcs_reservoir r = bits_reservoir(in, WORD(13) % 9);
    PUT(0, mcs_reservoir_weight(&r, IN(6)));
}
enum { BITS_KEPT = 3 };
MCST_HD static mcs_reservoir_k bits_reservoir_k(const float *in, mcs_kept *kept, uint32_t count) {
    mcs_reservoir_k r = mcs_reservoir_k_make(kept, BITS_KEPT);
    uint32_t i;
    for (i = 0; i < count; i++) mcs_reservoir_k_add(&r, i, bits_weight(in, i), (double)mcs_u01(mcs_hash(WORD(12), i)));
    return r;
}
MCST_HD static void bits_put_reservoir_k(float *out, const mcs_reservoir_k *r) {
    uint32_t i;
    for (i = 0; i < r->count; i++) bits_put_double(out, 2 * (int)i, r->kept[i].key);
    PUT_WORD(6, r->count ? r->kept[r->count - 1].i : r->k);
    PUT_WORD(7, r->count), bits_put_double(out, 8, r->next);
}
FN(reservoir_k_make) {
    mcs_kept kept[BITS_KEPT];
    const mcs_reservoir_k r = mcs_reservoir_k_make(WORD(11) % 4 ? kept : NULL, WORD(12) % (BITS_KEPT + 1));
    bits_put_reservoir_k(out, &r);
}
FN(reservoir_k_add) {
    mcs_kept kept[BITS_KEPT];
    const mcs_reservoir_k r = bits_reservoir_k(in, kept, WORD(13) % 9);
    bits_put_reservoir_k(out, &r);
}
FN(reservoir_k_merge) {
    mcs_kept kept[2][BITS_KEPT];
    mcs_reservoir_k r = bits_reservoir_k(in, kept[0], WORD(13) % 9);
    const mcs_reservoir_k other = bits_reservoir_k(in + 1, kept[1], WORD(13) / 9 % 9);
    mcs_reservoir_k_merge(&r, &other);
    bits_put_reservoir_k(out, &r);
}
FN(reservoir_k_weight) {
    mcs_kept kept[BITS_KEPT];
    const mcs_reservoir_k r = bits_reservoir_k(in, kept, WORD(13) % 9);
    int i;
    for (i = 0; i <= BITS_KEPT; i++) PUT(i, mcs_reservoir_k_weight(&r, (uint32_t)i));
}

MCST_HD static mcs_stat bits_stat(const float *in, int count) {
    mcs_stat s = {0.0, 0.0, 0.0};
    int i;
    for (i = 0; i < count; i++) mcs_stat_add(&s, (double)(int32_t)mcs_hash(WORD(11), (uint32_t)i) * 1e-3);
    return s;
}
MCST_HD static void bits_put_stat(float *out, mcs_stat s) {
    bits_put_double(out, 0, s.n), bits_put_double(out, 2, s.mean), bits_put_double(out, 4, s.m2);
}
FN(stat_add) { bits_put_stat(out, bits_stat(in, (int)(WORD(12) % 9))); }
FN(stat_merge) {
    mcs_stat s = bits_stat(in, (int)(WORD(12) % 9));
    const mcs_stat other = bits_stat(in + 1, (int)(WORD(13) % 9));
    mcs_stat_merge(&s, &other);
    bits_put_stat(out, s);
}
#define STAT const mcs_stat s = bits_stat(in, (int)(WORD(12) % 9))
FN(stat_variance) {
    STAT;
    bits_put_double(out, 0, mcs_stat_variance(&s));
}
FN(stat_error) {
    STAT;
    bits_put_double(out, 0, mcs_stat_error(&s));
}
FN(stat_ci) {
    STAT;
    bits_put_double(out, 0, mcs_stat_ci(&s, 1.96));
}
#undef STAT

/* --- environment maps --------------------------------------------------------------------------------------------- */

#define HOST(name) MCST_HOST_FN void bits1_##name(const float *in, float *out)
/* Black, bad and very bright entries among others. */
MCST_HD static void bits_picture(uint32_t seed, uint32_t n, float *f) {
    uint32_t i;
    for (i = 0; i < n; i++) {
        const uint32_t h = mcs_hash(seed, i);
        f[i] = h % 8 == 0     ? 0.0f
               : h % 128 == 1 ? bits_bad(-1.0f)
               : h % 128 == 9 ? bits_bad(from_bits(0x7fc00000))
                              : mcs_u01(h) * (h % 8 == 1 ? 1e4f : 1.0f);
    }
}
/* Zeros. Their number of bytes stands in front of them, for those who copy them. */
static void *bits_memory(size_t bytes) {
    uint64_t *const p = (uint64_t *)memory(bytes + 2 * sizeof *p);
    memset(p, 0, bytes + 2 * sizeof *p);
    p[0] = bytes;
    return p + 2;
}
MCST_HD static void bits_put_texel(float *out, int i, mcs_texel t) {
    bits1_put3(out, i, t.w), PUT(i + 3, t.pdf), PUT_WORD(i + 4, t.col), PUT_WORD(i + 5, t.row);
}

/* Shadow rays to anywhere, one of a thousand beyond the last tile. */
static void bits_rays(mcs_region *g, uint32_t seed, uint32_t n) {
    const uint32_t tiles = 2 * g->rows * g->rows;
    uint32_t i;
    for (i = 0; i < n; i++) {
        const uint32_t h = mcs_hash(seed, i);
        mcs_region_add_ray(g, h % (tiles + tiles / 1000 + 1), (int)(h >> 24 & 2));
    }
}
static void bits_map_build(int kind, bits_map *m) {
    static const uint32_t size[BITS_MAPS][2] = {{40, 12}, {130, 33}, {24, 17}, {40, 12}, {130, 33}, {16, 16}, {7, 5}};
    /* Roughness, matte part, cosine of the direction to the eye. */
    static const float surface[BITS_SURFACES][4] = {
        {1, 1, 1, 0.8f}, {0.6f, 0.3f, 0.3f, 0.5f}, {0.01f, 0.02f, 0, 0.9f}, {1, 1, 1, -0.1f}};
    const uint32_t w = size[kind][0], h = size[kind][1], rows = kind == BITS_RGB ? 32 : 16;
    float *const f = (float *)memory((size_t)w * h * 7 * sizeof *f);
    memset(f, 0, (size_t)w * h * 7 * sizeof *f);
    mcs_image im = mcs_image_make(f, w, h, 1);
    size_t bytes = mcs_env_bytes(w, h);
    uint32_t i;
    int k;
    if (kind == BITS_CONSTANT)
        for (i = 0; i < w * h; i++) f[i] = 0.7f;
    else if (kind != BITS_BLACK) bits_picture(kind == BITS_SUN || kind == BITS_FLOOR ? 1 : 0, w * h * 7, f);
    if (kind == BITS_SUN || kind == BITS_FLOOR) {
        for (i = 0; i < w; i++) f[i] = f[w + i] = f[20 * w + i] = f[21 * w + i] = f[(h - 1) * w + i] = 0.0f;
        f[9 * w + w - 1] = 3e8f;
    }
    if (kind == BITS_RGB) { /* the last row of the picture first */
        im.channels = 3, im.pixel_stride = 5, im.row_stride = -(ptrdiff_t)(5 * w + 2);
        im.pixels = f + (h - 1) * (5 * w + 2);
    }
    if (kind == BITS_FLOOR) im.floor = mcs_env_mean(&im);
    im.bilinear = kind == BITS_BILINEAR;
    m->env = (mcs_env *)bits_memory(bytes), m->status[0] = mcs_env_build(m->env, bytes, &im);
    free(f);
    if (kind == BITS_RGB) m->env->frame = mcs_frame_make(mcsi_vec3(0.48f, -0.6f, 0.64f));
    bytes = mcs_env_window_bytes(h), m->window = (mcs_env_window *)bits_memory(bytes);
    m->status[1] = mcs_env_window_build(m->window, bytes, m->env, h / 4, h / 2 + 1, 3 * w / 4, w / 2);
    m->tile_bytes = mcs_tiles_bytes(m->env, rows), m->tiles = (mcs_tiles *)bits_memory(m->tile_bytes);
    m->status[2] = mcs_tiles_build(m->tiles, m->tile_bytes, m->env, rows);
    bytes = mcs_region_bytes(rows), m->region = (mcs_region *)bits_memory(bytes);
    if (mcs_region_start(m->region, bytes, m->tiles)) exit(2);
    bits_rays(m->region, (uint32_t)kind, 4000);
    for (k = 0; k < BITS_SURFACES; k++) {
        const float *s = surface[k];
        mcs_reflection r;
        r.frame = mcs_frame_make(mcsi_vec3(0.6f, 0.48f, 0.64f));
        r.wo = mcsi_vec3(0.0f, mcsi_sqrt(1.0f - s[3] * s[3]), s[3]), r.alpha_x = s[0], r.alpha_y = s[1], r.matte = s[2];
        r.profile = (mcs_profile)(k % 3);
        bytes = mcs_product_bytes(rows), m->product[k] = (mcs_product *)bits_memory(bytes);
        m->status[3 + k] = mcs_product_build(m->product[k], bytes, m->tiles, m->env, &r, NULL);
        mcs_region_add_point(m->region, m->tiles, m->env, &r);
    }
    bytes = mcs_product_table_bytes(rows), m->product[k] = (mcs_product *)bits_memory(bytes);
    m->status[3 + k] = mcs_product_build_region(m->product[k], bytes, m->tiles, m->env, m->region);
}
#ifdef __CUDACC__
static __device__ bits_map bits_gpu_maps[BITS_MAPS]; /* copies of those below */
#endif
MCST_FN const bits_map *bits_map_at(int kind) {
#ifdef __CUDA_ARCH__
    return &bits_gpu_maps[kind];
#else
    static bits_map maps[BITS_MAPS];
    if (!maps[kind].env) bits_map_build(kind, &maps[kind]);
    return &maps[kind];
#endif
}
#define PRODUCT_OF(in) bits_kind_of(in, BITS_MAPS *BITS_PRODUCTS)
#define MAP const bits_map *const m = bits_map_at(bits_kind_of(in, BITS_MAPS))
#define PRODUCT \
    MAP;        \
    const mcs_product *const p = m->product[PRODUCT_OF(in) / BITS_MAPS]

FN(image_make) {
    const mcs_image im = mcs_image_make(in, WORD(11), WORD(12), WORD(13));
    PUT_WORD(0, im.pixels == in), PUT_WORD(1, im.w), PUT_WORD(2, im.h), PUT_WORD(3, im.channels);
    PUT_WORD(4, (uint32_t)im.bilinear);
    PUT_WORD(5, (uint32_t)im.pixel_stride), PUT_WORD(6, (uint32_t)im.row_stride), PUT(7, im.floor);
}
FN(env_bytes) { /* of sizes that a machine of 32 bits has room for, or of none */
    const uint32_t w = WORD(11) >> (WORD(13) & 31), h = WORD(12) >> (WORD(13) >> 5 & 31);
    PUT_WORD(0, (uint32_t)mcs_env_bytes(w, 1 + h % 256)), PUT_WORD(1, (uint32_t)mcs_env_bytes(w % 256, h));
}

/* A small map of its own for each case; now and then one that is refused. */
enum { BITS_SMALL = 9, BITS_ROOM = 600 };
typedef struct {
    uint64_t room[BITS_ROOM];
    float pixels[5 * BITS_SMALL * BITS_SMALL];
    size_t bytes;
    mcs_image image;
} bits_case;
MCST_HD static void bits_case_make(const float *in, bits_case *c) {
    const uint32_t h = WORD(11);
    memset(c, 0, sizeof *c);
    if (WORD(13) % 32) bits_picture(WORD(12), 5 * BITS_SMALL * BITS_SMALL, c->pixels);
    c->image = mcs_image_make(c->pixels, 1 + h % BITS_SMALL, 1 + (h >> 8) % BITS_SMALL, h >> 16 & 1 ? 3 : 1);
    c->image.bilinear = h >> 17 & 1, c->image.pixel_stride = h >> 18 & 1 ? 5 : 0;
    if (h >> 19 & 1) c->image.row_stride = 5 * BITS_SMALL;
    if ((h >> 20 & 3) == 0) c->image.floor = h >> 22 & 1 ? IN(0) : mcs_env_mean(&c->image);
    c->bytes = mcs_env_bytes(c->image.w, c->image.h);
    switch (h >> 24) {
    case 0: c->image.channels = 2; break;
    case 1: c->image.channels = 0; break;
    case 2: c->image.w = 0; break;
    case 3: c->image.h = 1u << 17; break;
    case 4: c->image.row_stride = 1, c->image.w = BITS_SMALL; break;
    case 5: c->image.pixel_stride = -1; break;
    case 6: c->image.pixels = NULL; break;
    case 7: c->bytes--; break;
    default: break;
    }
}
/* All that a map is, but its places in memory. */
MCST_HD static void bits_put_env(const float *in, float *out, const bits_case *c, mcs_status status) {
    const mcs_env *e = (const mcs_env *)(const void *)c->room;
    const uint32_t words[] = {e->magic, e->version, e->w,    e->h,       e->bad,       e->row0,
                              e->row1,  e->col0,    e->col1, e->uniform, e->incomplete};
    float drawn[12] = {0};
    PUT_WORD(0, bits_said(status, !(e->total > 0)));
    if (status < 0) return;
    bits_put_double(out, 1, e->total), bits_put_array(out, 3, words, MCST_COUNT(words));
    bits_put_texel(drawn, 0, mcs_env_sample(e, IN(6), IN(7))), bits_put_texel(drawn, 6, mcs_env_texel(e, IN3(8)));
    bits_put_array(out, 5, drawn, MCST_COUNT(drawn)), bits_put_array(out, 7, (const float *)(const void *)&e->frame, 9);
}
FN(env_build) {
    bits_case c;
    bits_case_make(in, &c);
    bits_put_env(in, out, &c, mcs_env_build((mcs_env *)(void *)c.room, c.bytes, &c.image));
}
/* The rows in two parts, the later first. */
MCST_HD static mcs_status bits_rows(const float *in, bits_case *c) {
    const uint32_t cut = WORD(13) % BITS_SMALL, middle = cut < c->image.h ? cut : c->image.h;
    const mcs_status status = mcs_env_build_rows((mcs_env *)(void *)c->room, c->bytes, &c->image, middle, c->image.h);
    return status ? status : mcs_env_build_rows((mcs_env *)(void *)c->room, c->bytes, &c->image, 0, middle);
}
FN(env_build_rows) {
    bits_case c;
    mcs_status status;
    bits_case_make(in, &c);
    status = bits_rows(in, &c);
    bits_put_env(in, out, &c, status ? status : mcs_env_finish((mcs_env *)(void *)c.room, c.bytes, &c.image));
    PUT_WORD(9,
             (uint32_t)mcs_env_build_rows((mcs_env *)(void *)c.room, c.bytes, &c.image, WORD(12) % 16, WORD(13) % 16));
}
FN(env_finish) { /* of a map whose rows are built, whatever its own answer */
    bits_case c;
    bits_case_make(in, &c);
    bits_rows(in, &c);
    bits_put_env(in, out, &c, mcs_env_finish((mcs_env *)(void *)c.room, c.bytes, &c.image));
    PUT_WORD(9, (uint32_t)mcs_env_finish(NULL, c.bytes, &c.image));
}
FN(env_check) {
    bits_case c;
    mcs_env *const e = (mcs_env *)(void *)c.room;
    uint32_t *list;
    bits_case_make(in, &c);
    if (mcs_env_build(e, c.bytes, &c.image) < 0) {
        PUT_WORD(0, (uint32_t)mcs_env_check(e, sizeof c.room)); /* zeros */
        return;
    }
    PUT_WORD(1, (uint32_t)mcs_env_check(e, c.bytes)), PUT_WORD(2, (uint32_t)mcs_env_check(e, c.bytes - 1));
    PUT_WORD(3, (uint32_t)mcs_env_check(e, WORD(12) % c.bytes)), PUT_WORD(4, (uint32_t)mcs_env_check(NULL, c.bytes));
    switch (WORD(12) >> 8 & 7) { /* damage that is the same in every byte order */
    case 0: e->magic ^= 1u << (WORD(13) & 31); break;
    case 1: e->version++; break;
    case 2: e->h++; break;
    case 3: e->uniform = 2; break;
    case 4: e->offset.col_sums += 8; break;
    case 5: e->incomplete = 2; break;
    default:
        list = (uint32_t *)(void *)((char *)e + (WORD(12) >> 8 & 1 ? e->offset.col_sums : e->offset.row_sums));
        list[WORD(12) % (c.image.h + 1)] ^= 1u << (WORD(13) & 31);
    }
    PUT_WORD(5, (uint32_t)mcs_env_check(e, c.bytes));
}
FN(env_mean) {
    bits_case c;
    bits_case_make(in, &c);
    PUT(0, mcs_env_mean(&c.image));
}
FN(env_sample) {
    MAP;
    bits_put_texel(out, 0, mcs_env_sample(m->env, IN(6), IN(7)));
}
FN(env_sample_bits) {
    MAP;
    bits_put_texel(out, 0, mcs_env_sample_bits(m->env, WORD(11), WORD(12)));
}
FN(env_pdf) {
    MAP;
    PUT(0, mcs_env_pdf(m->env, IN3(8)));
}
FN(env_invert) {
    MAP;
    bits1_put2(out, 0, mcs_env_invert(m->env, IN3(8)));
    bits1_put2(out, 2, mcs_env_invert(m->env, mcs_env_sample(m->env, IN(6), IN(7)).w));
}
FN(env_texel) {
    MAP;
    const mcs_texel t = mcs_env_texel(m->env, IN3(8));
    bits_put_texel(out, 0, mcs_env_texel(m->env, mcs_env_sample(m->env, IN(6), IN(7)).w));
    PUT(6, t.pdf), PUT_WORD(7, t.col), PUT_WORD(8, t.row);
}
FN(env_weight) {
    MAP;
    PUT(0, mcs_env_weight(m->env, IN(0))), PUT(1, mcs_env_weight(m->env, mcs_env_sample(m->env, IN(6), IN(7)).pdf));
}
FN(env_window_bytes) { PUT_WORD(0, (uint32_t)mcs_env_window_bytes(WORD(11) >> (WORD(12) & 31))); }

MCST_HD static uint32_t bits_black(const mcs_env *e, const mcs_env_window *m) {
    return m->uniform && !(e->uniform && e->total > 0);
}
/* A window of its own for each case: some are refused, some go across the seam, some are black. */
#define WINDOW                                                                                        \
    MAP;                                                                                              \
    uint64_t room[300] = {0};                                                                         \
    mcs_env_window *const v = (mcs_env_window *)(void *)room;                                         \
    const uint32_t row = WORD(11) % (m->env->h + 1), rows = (WORD(11) >> 16) % (m->env->h - row + 2); \
    const uint32_t col = WORD(12) % (m->env->w + 1), cols = (WORD(12) >> 16) % (m->env->w + 2);       \
    const size_t bytes = mcs_env_window_bytes(rows) - (WORD(13) >> 28 == 0 && rows);                  \
    const mcs_status status = mcs_env_window_build(v, bytes, m->env, row, rows, col, cols);           \
    const mcs_texel t = mcs_env_window_sample(status < 0 ? m->window : v, m->env, IN(6), IN(7))
FN(env_window_build) {
    WINDOW;
    PUT_WORD(0, bits_said(status, bits_black(m->env, v))), bits_put_texel(out, 1, t);
}
FN(env_window_sample) {
    MAP;
    bits_put_texel(out, 0, mcs_env_window_sample(m->window, m->env, IN(6), IN(7))),
        PUT_WORD(6, bits_said(m->status[1], bits_black(m->env, m->window)));
}
FN(env_window_pdf) {
    WINDOW;
    PUT(0, mcs_env_window_pdf(status < 0 ? m->window : v, m->env, t.w)),
        PUT(1, mcs_env_window_pdf(m->window, m->env, IN3(8)));
}
#undef WINDOW

/* --- products ----------------------------------------------------------------------------------------------------- */

MCST_HD static mcs_reflection bits_reflection(const float *in) {
    mcs_reflection r;
    r.frame = mcs_frame_make(IN3(8)), r.wo = IN3(3), r.alpha_x = IN(0), r.alpha_y = IN(1);
    r.matte = WORD(12) % 4 ? mcs_u01(WORD(12)) : IN(6), r.profile = (mcs_profile)(WORD(11) >> 2 & 3);
    return r;
}
FN(tiles_bytes) {
    MAP;
    PUT_WORD(0, (uint32_t)mcs_tiles_bytes(m->env, 16u << (WORD(11) & 3))),
        PUT_WORD(1, (uint32_t)mcs_tiles_bytes(m->env, WORD(12)));
    PUT_WORD(2, (uint32_t)mcs_tiles_bytes(NULL, 16));
}
FN(tiles_build) {
    MAP;
    PUT_WORD(0, bits_said(m->status[2], !(m->env->total > 0))), bits_put_array(out, 1, m->tiles, 3);
    PUT_WORD(3,
             (uint32_t)mcs_tiles_build(m->tiles, m->tile_bytes - 1 - WORD(11) % m->tile_bytes, m->env, m->tiles->rows));
    PUT_WORD(4, (uint32_t)mcs_tiles_build(m->tiles, m->tile_bytes, m->env, WORD(11) % 16));
    PUT_WORD(5, (uint32_t)mcs_tiles_build(m->tiles, m->tile_bytes, NULL, 16));
    bits1_put3(out, 6, mcs_tiles_direction(m->tiles, m->env, WORD(12) % 512));
}
FN(tiles_direction) {
    MAP;
    bits1_put3(out, 0, mcs_tiles_direction(m->tiles, m->env, WORD(11) % 600));
    bits1_put3(out, 3, mcs_tiles_direction(m->tiles, m->env, WORD(12)));
}
FN(tiles_of_texel) {
    MAP;
    PUT_WORD(0, mcs_tiles_of_texel(m->tiles, m->env, WORD(11) % 140, WORD(12) % 35));
    PUT_WORD(1, mcs_tiles_of_texel(m->tiles, m->env, WORD(11), WORD(12) % 35));
}
FN(tiles_of_direction) {
    MAP;
    PUT_WORD(0, mcs_tiles_of_direction(m->tiles, m->env, IN3(8)));
}
FN(product_bytes) { /* beyond the header */
    const size_t bytes = mcs_product_bytes(16u << (WORD(11) & 3));
    PUT_WORD(0, (uint32_t)(bytes ? bytes - sizeof(mcs_product) : 0)),
        PUT_WORD(1, (uint32_t)mcs_product_bytes(WORD(12)));
}
FN(product_table_bytes) {
    const size_t bytes = mcs_product_table_bytes(16u << (WORD(11) & 3));
    PUT_WORD(0, (uint32_t)(bytes ? bytes - sizeof(mcs_product) : 0)),
        PUT_WORD(1, (uint32_t)mcs_product_table_bytes(WORD(12)));
}
static uint64_t bits_room[MCS_PRODUCT_BYTES(32) / 8 + 1];
/* Its share of the lobe and a sample with its density show a product. */
static void bits_put_product(const float *in, float *out, mcs_status status) {
    MAP;
    const mcs_product *p = (const mcs_product *)(const void *)bits_room;
    mcs_texel t;
    PUT_WORD(0, bits_said(status, p->dark));
    if (status < 0) return;
    t = mcs_product_sample(p, m->tiles, m->env, IN(6), IN(7));
    PUT(1, (float)p->row_total), PUT(2, p->brdf_share), bits_put_texel(out, 3, t),
        PUT(9, mcs_product_pdf(p, m->tiles, m->env, t.w));
}
HOST(product_build) {
    MAP;
    const mcs_reflection r = bits_reflection(in);
    const mcs_reflection *given_one = WORD(11) % 32 == 1 ? NULL : &r;
    const mcs_region *region = WORD(12) % 4 == 1 ? m->region : NULL;
    const size_t bytes = mcs_product_bytes(m->tiles->rows) - (WORD(11) % 32 == 0);
    bits_put_product(in, out,
                     mcs_product_build((mcs_product *)(void *)bits_room, bytes, m->tiles, m->env, given_one, region));
}
HOST(product_build_weights) {
    MAP;
    float weight[2048];
    mcs_product *const p = (mcs_product *)(void *)bits_room;
    bits_picture(WORD(12), m->tiles->rows * m->tiles->cols, weight);
    bits_put_product(
        in, out, mcs_product_build_weights(p, sizeof bits_room, m->tiles, m->env, WORD(11) % 32 == 1 ? NULL : weight));
}
FN(product_sample) {
    PRODUCT;
    bits_put_texel(out, 0, mcs_product_sample(p, m->tiles, m->env, IN(6), IN(7)));
    PUT_WORD(6, bits_said(m->status[3 + PRODUCT_OF(in) / BITS_MAPS], p->dark));
}
FN(product_pdf) {
    PRODUCT;
    PUT(0, mcs_product_pdf(p, m->tiles, m->env, IN3(8))),
        PUT(1, mcs_product_pdf(p, m->tiles, m->env, mcs_product_sample(p, m->tiles, m->env, IN(6), IN(7)).w));
}

/* --- regions ------------------------------------------------------------------------------------------------------ */

FN(product_texel) {
    MAP;
    bits_put_texel(out, 0, mcs_product_texel(m->product[WORD(11) % BITS_SURFACES], m->tiles, m->env, IN3(8)));
}
FN(region_bytes) {
    PUT_WORD(0, (uint32_t)mcs_region_bytes(16u << (WORD(11) & 3))), PUT_WORD(1, (uint32_t)mcs_region_bytes(WORD(12)));
}
FN(region_visibility) {
    MAP;
    PUT(0, mcs_region_visibility(m->region, WORD(11) % 600));
    PUT(1, mcs_region_visibility(m->region, WORD(12)));
}
FN(region_pays) {
    MAP;
    mcs_reflection r = bits_reflection(in);
    PUT_WORD(0, (uint32_t)mcs_region_pays(m->region, &r));
    r.matte = 0;
    r.alpha_x = 0.1f;
    r.alpha_y = 0.25f * IN(6); /* up to 12.8 tiles */
    PUT_WORD(1, (uint32_t)mcs_region_pays(m->region, &r));
}
FN(region_share) {
    MAP;
    mcs_reflection r = bits_reflection(in);
    const mcs_product *p = m->product[BITS_SURFACES];
    PUT(0, mcs_region_share(p, &r)), PUT(1, p->reach);
    r.matte = 0;
    r.alpha_x = 0.1f;
    r.alpha_y = 0.25f * IN(6);
    PUT(2, mcs_region_share(p, &r));
    r.alpha_x = IN(6);
    PUT(3, mcs_region_share(p, &r));
}
static uint64_t bits_region_room[2][1 + (16 + 16 * 2048) / 8];
/* One of two regions of a case: of one point and some rays. */
static mcs_region *bits_region(const float *in, uint32_t which) {
    MAP;
    mcs_region *g = (mcs_region *)(void *)bits_region_room[which];
    const mcs_reflection r = bits_reflection(in);
    if (mcs_region_start(g, sizeof bits_region_room[which], m->tiles)) exit(2);
    mcs_region_add_point(g, m->tiles, m->env, &r);
    bits_rays(g, WORD(12) + which, 20);
    return g;
}
/* All of it. */
static void bits_put_region(float *out, int i, const mcs_region *g) {
    bits_put_array(out, i, g, mcs_region_bytes(g->rows) / sizeof(float));
}
HOST(region_start) {
    MAP;
    mcs_region *g = (mcs_region *)(void *)bits_region_room[0];
    const size_t bytes = mcs_region_bytes(m->tiles->rows);
    PUT_WORD(0, (uint32_t)mcs_region_start(g, bytes - 1 - WORD(11) % bytes, m->tiles));
    PUT_WORD(1, (uint32_t)mcs_region_start(NULL, bytes, m->tiles)),
        PUT_WORD(2, (uint32_t)mcs_region_start(g, bytes, NULL));
    PUT_WORD(3, (uint32_t)mcs_region_start(g, bytes, m->tiles)), bits_put_region(out, 4, g);
}
HOST(region_add_point) {
    MAP;
    mcs_region *g = bits_region(in, 0);
    mcs_reflection r = bits_reflection(in);
    bits_put_region(out, 0, g);
    r.alpha_x = r.alpha_y = 0.3f, r.wo = mcsi_vec3(0.6f, 0.0f, 0.8f);
    mcs_region_add_point(g, m->tiles, m->env, &r);
    bits_put_region(out, 2, g);
}
HOST(region_add_ray) {
    mcs_region *g = bits_region(in, 0);
    mcs_region_add_ray(g, WORD(11) % 520, (int)(WORD(13) & 1)), mcs_region_add_ray(g, WORD(12), 1);
    bits_put_region(out, 0, g);
}
HOST(region_merge) {
    mcs_region *g = bits_region(in, 0);
    mcs_region_merge(g, bits_region(in, 1));
    bits_put_region(out, 0, g);
    mcs_region_merge(g, g);
    bits_put_region(out, 2, g);
}
HOST(region_inherit) {
    MAP;
    mcs_region *g = bits_region(in, 0);
    mcs_region_inherit(g, m->region);
    bits_put_region(out, 0, g);
}
HOST(region_decay) {
    mcs_region *g = bits_region(in, 0);
    mcs_region_decay(g, IN(6));
    bits_put_region(out, 0, g);
}
HOST(product_build_region) {
    MAP;
    const mcs_region *g = WORD(11) % 32 == 1 ? NULL : bits_region(in, 0);
    const size_t bytes = mcs_product_table_bytes(m->tiles->rows) - (WORD(11) % 32 == 0);
    mcs_product *const p = (mcs_product *)(void *)bits_room;
    bits_put_product(in, out, mcs_product_build_region(p, bytes, m->tiles, m->env, g));
}

/* --- array forms -------------------------------------------------------------------------------------------------- */

#define ARRAY(name) MCST_HOST_FN void bits_array_##name(int k, size_t n, float(*in)[CASES], float(*out)[CASES])
#define DRAW(name, ...)                                                                     \
    ARRAY(name) {                                                                           \
        static uint32_t col[CASES], row[CASES];                                             \
        mcs_##name(__VA_ARGS__, n, in[0], in[1], out[0], out[1], out[2], out[3], col, row); \
        memcpy(out[4], col, n * sizeof *col);                                               \
        memcpy(out[5], row, n * sizeof *row);                                               \
    }
HOST(env_sample_n) {
    MAP;
    bits_put_texel(out, 0, mcs_env_sample(m->env, IN(6), IN(7)));
}
DRAW(env_sample_n, bits_map_at(k)->env)
HOST(env_texel_n) {
    MAP;
    const mcs_texel t = mcs_env_texel(m->env, IN3(8));
    PUT_WORD(0, t.col), PUT_WORD(1, t.row), PUT(2, t.pdf);
}
ARRAY(env_texel_n) {
    static uint32_t col[CASES], row[CASES];
    mcs_env_texel_n(bits_map_at(k)->env, n, in[2], in[3], in[4], out[2], col, row);
    memcpy(out[0], col, n * sizeof *col);
    memcpy(out[1], row, n * sizeof *row);
}
HOST(env_pdf_n) { bits1_env_pdf(in, out); }
ARRAY(env_pdf_n) { mcs_env_pdf_n(bits_map_at(k)->env, n, in[2], in[3], in[4], out[0]); }
HOST(env_window_sample_n) {
    MAP;
    bits_put_texel(out, 0, mcs_env_window_sample(m->window, m->env, IN(6), IN(7)));
}
DRAW(env_window_sample_n, bits_map_at(k)->window, bits_map_at(k)->env)
HOST(product_sample_n) {
    PRODUCT;
    bits_put_texel(out, 0, mcs_product_sample(p, m->tiles, m->env, IN(6), IN(7)));
}
DRAW(product_sample_n, bits_map_at(k % BITS_MAPS)->product[k / BITS_MAPS], bits_map_at(k % BITS_MAPS)->tiles,
     bits_map_at(k % BITS_MAPS)->env)
HOST(product_pdf_n) {
    PRODUCT;
    PUT(0, mcs_product_pdf(p, m->tiles, m->env, IN3(8)));
}
ARRAY(product_pdf_n) {
    const bits_map *m = bits_map_at(k % BITS_MAPS);
    mcs_product_pdf_n(m->product[k / BITS_MAPS], m->tiles, m->env, n, in[2], in[3], in[4], out[0]);
}
#undef ARRAY
#undef DRAW
#undef HOST
#undef MAP
#undef PRODUCT
#undef PRODUCT_OF
#undef WORD2
#endif

#undef FN
#undef IN
#undef IN3
#undef WORD
#undef PUT
#undef PUT_WORD
#undef MCST_W
#undef F_
#undef U_
#undef M_
#undef B_
#endif
