/* The functions of mcsample.h that have no row in registry.h, in one uniform shape, for the hashes of test_bits.c.
 *
 * No include guard: test_bits.c includes this file once per width, with BITS_W lanes, F_ and U_ the types of floats and words, M_(x)
 * the name x of mcsample.h at that width and B_(x) the name of its adapter. As in adapters.h entry i of lane l is at i * W + l:
 *
 *     B_(x)(in, out)   in: 0..2 parameters, 3..5 a direction, 6, 7 random numbers, 8..10 a point, 11..13 words
 *                      out: BITS_OUT entries, set to 0 before
 *
 * Words travel as the bits of floats. A name needs its function here and its place in one of the three lists: floats at every width, words at every width, and what there is only once. */
#ifndef BITS_WIDE
#define BITS_WIDE(X)                                                                                                              \
    X(u01)                                                                                                                        \
    X(u01_open) X(sobol) X(r2) X(cone_from_sin2) X(frame_make) X(to_world) X(to_local) X(reflect) X(reflect_pdf) X(half) X(cos_d) \
        X(schlick) X(phong_make) X(ward_make) X(beckmann_make) X(ggx_make) X(ashikhmin_make) X(is_mirror) X(ggx_d) X(ggx_g1)      \
            X(ggx_g2) X(mis_balance) X(mis_power) X(mix_pdf)
#define BITS_WORDS(X) X(hash) X(sobol_bits)
#define BITS_SCALAR(X)                                                                                                         \
    X(pcg32_make)                                                                                                              \
    X(pcg32_next) X(pcg32_float) X(pcg32_advance) X(pcg32_fill_n) X(philox) X(philox_fill_n) X(sobol_n) X(stratified) X(latin) \
        X(pwc_bytes) X(pwc_build) X(pwc_build_fn) X(pwc_sample) X(pwc_pdf) X(pwc_invert) X(pwc_sample_n) X(discrete_sample)    \
            X(discrete_pmf) X(pwl_bytes) X(pwl_build) X(pwl_sample) X(pwl_pdf) X(pwl_invert) X(pwl_sample_n) X(alias_bytes)    \
                X(alias_build) X(alias_sample) X(alias_pmf) X(stat_add) X(stat_merge) X(stat_variance) X(stat_error) X(stat_ci)
#endif

#define FN(name) BITS_HD static void B_(name)(const float *in, float *out)

BITS_HD static F_ B_(in)(const float *in, int i) {
    F_ v;
    memcpy(&v, in + i * BITS_W, sizeof v);
    return v;
}
BITS_HD static M_(vec3) B_(in3)(const float *in, int i) {
    M_(vec3) v;
    v.x = B_(in)(in, i), v.y = B_(in)(in, i + 1), v.z = B_(in)(in, i + 2);
    return v;
}
BITS_HD static U_ B_(word)(const float *in, int i) {
    U_ v;
    memcpy(&v, in + i * BITS_W, sizeof v);
    return v;
}
BITS_HD static void B_(put)(float *out, int i, F_ v) { memcpy(out + i * BITS_W, &v, sizeof v); }
BITS_HD static void B_(put_word)(float *out, int i, U_ v) { memcpy(out + i * BITS_W, &v, sizeof v); }
#define IN(i) B_(in)(in, i)
#define IN3(i) B_(in3)(in, i)
#define WORD(i) B_(word)(in, i)
#define PUT(i, v) B_(put)(out, i, v)
#define PUT_WORD(i, v) B_(put_word)(out, i, v)
BITS_HD static void B_(put2)(float *out, int i, M_(vec2) v) { PUT(i, v.x), PUT(i + 1, v.y); }
BITS_HD static void B_(put3)(float *out, int i, M_(vec3) v) { PUT(i, v.x), PUT(i + 1, v.y), PUT(i + 2, v.z); }

FN(u01) { PUT(0, M_(u01)(WORD(11))); }
FN(u01_open) { PUT(0, M_(u01_open)(WORD(11))); }
FN(hash) { PUT_WORD(0, M_(hash)(WORD(11), WORD(12))); }
FN(sobol_bits) { /* dimension and seed are the same for all lanes */
    PUT_WORD(0, M_(sobol_bits)(WORD(11), 0, 0)), PUT_WORD(1, M_(sobol_bits)(WORD(11), 1, 7));
    PUT_WORD(2, M_(sobol_bits)(WORD(11), 6, 0x9e3779b9u)), PUT_WORD(3, M_(sobol_bits)(WORD(11), 0xffffffffu, 1));
}
FN(sobol) { PUT(0, M_(sobol)(WORD(11), 0, 0)), PUT(1, M_(sobol)(WORD(11), 3, 7)), PUT(2, M_(sobol)(WORD(11), 1000, 1)); }
FN(r2) { B_(put2)(out, 0, M_(r2)(WORD(11), 0)), B_(put2)(out, 2, M_(r2)(WORD(11), 0x9e3779b9u)); }
FN(cone_from_sin2) { PUT(0, M_(cone_from_sin2)(IN(6))); }

FN(frame_make) {
    const M_(frame) f = M_(frame_make)(IN3(3));
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
#undef GGX
FN(mis_balance) { PUT(0, M_(mis_balance)(IN(0), IN(1))); }
FN(mis_power) { PUT(0, M_(mis_power)(IN(0), IN(1))); }
FN(mix_pdf) { PUT(0, M_(mix_pdf)(IN(6), IN(0), IN(1))); }

#if BITS_W == 1
#define WORD2(i) ((uint64_t)WORD(i) << 32 | WORD((i) + 1))
BITS_HD static void bits_put_word2(float *out, int i, uint64_t v) {
    PUT_WORD(i, (uint32_t)v), PUT_WORD(i + 1, (uint32_t)(v >> 32));
}
BITS_HD static void bits_put_double(float *out, int i, double v) {
    uint64_t word;
    memcpy(&word, &v, sizeof word);
    bits_put_word2(out, i, word);
}
/* Arrays longer than `out` are seen through their hash. */
BITS_HD static void bits_put_array(float *out, int i, const float *a, size_t n) {
    bits_put_word2(out, i, bits_hash(BITS_START, a, n));
}
enum { BITS_LONG = 200, BITS_CELLS = 40 };

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
FN(stratified) { B_(put2)(out, 0, mcs_stratified(WORD(11), WORD(12) % 50, WORD(13) % 70, WORD(13))); }
FN(latin) { PUT(0, mcs_latin(WORD(11), WORD(12) % 5000, WORD(13) % 9, WORD(13))); }

/* Small tables, built anew for every case: of 1 to BITS_CELLS entries, some of them 0 or bad, now and then all 0. */
BITS_HD static uint32_t bits_entries(const float *in, float *f) {
    const uint32_t n = 1 + WORD(11) % BITS_CELLS;
    uint32_t i;
    for (i = 0; i <= n; i++) {
        const uint32_t h = mcs_hash(WORD(12), i);
        f[i] = WORD(13) % 16 == 0 || h % 8 == 0 ? 0.0f : h % 128 == 1 ? -1.0f : mcs_u01(h) * (h % 8 == 1 ? 1e6f : 1.0f);
    }
    return n;
}
#define TABLE(kind)                                                     \
    uint64_t room[4 * BITS_CELLS];                                      \
    float f[BITS_CELLS + 1];                                            \
    const uint32_t n = bits_entries(in, f);                             \
    mcs_##kind *t = (mcs_##kind *)(void *)room;                         \
    const mcs_status status = mcs_##kind##_build(t, sizeof room, f, n); \
    (void)status

FN(pwc_bytes) { PUT_WORD(0, (uint32_t)mcs_pwc_bytes(WORD(11) >> (WORD(12) & 31))); }
FN(pwc_build) {
    TABLE(pwc);
    PUT_WORD(0, (uint32_t)status), PUT_WORD(1, t->bad), bits_put_double(out, 2, t->total);
}
BITS_HD static float bits_curve(float x, void *k) { return *(const float *)k * (1.0f + x * x); }
FN(pwc_build_fn) {
    uint64_t room[4 * BITS_CELLS];
    mcs_pwc *t = (mcs_pwc *)(void *)room;
    float k = IN(0);
    PUT_WORD(0, (uint32_t)mcs_pwc_build_fn(t, sizeof room, bits_curve, &k, 1 + WORD(11) % BITS_CELLS));
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
FN(discrete_sample) {
    TABLE(pwc);
    const mcs_pick c = mcs_discrete_sample(t, IN(6));
    PUT_WORD(0, c.i), PUT(1, c.pmf), PUT(2, c.u);
}
FN(discrete_pmf) {
    TABLE(pwc);
    PUT(0, mcs_discrete_pmf(t, WORD(13) % BITS_CELLS));
}
FN(pwl_bytes) { PUT_WORD(0, (uint32_t)mcs_pwl_bytes(WORD(11) >> (WORD(12) & 31))); }
FN(pwl_build) {
    TABLE(pwl);
    PUT_WORD(0, (uint32_t)status), PUT_WORD(1, t->cells.bad), bits_put_double(out, 2, t->cells.total);
}
FN(alias_bytes) { PUT_WORD(0, (uint32_t)mcs_alias_bytes(WORD(11) >> (WORD(12) & 31))); }
FN(alias_build) {
    TABLE(alias);
    PUT_WORD(0, (uint32_t)status), PUT_WORD(1, t->bad), bits_put_double(out, 2, t->total);
}
FN(alias_sample) {
    TABLE(alias);
    const mcs_pick c = mcs_alias_sample(t, IN(6));
    PUT_WORD(0, c.i), PUT(1, c.pmf), PUT(2, c.u);
}
FN(alias_pmf) {
    TABLE(alias);
    PUT(0, mcs_alias_pmf(t, WORD(13) % BITS_CELLS));
}
#undef TABLE

BITS_HD static mcs_stat bits_stat(const float *in, int count) {
    mcs_stat s = {0.0, 0.0, 0.0};
    int i;
    for (i = 0; i < count; i++) mcs_stat_add(&s, (double)(int32_t)mcs_hash(WORD(11), (uint32_t)i) * 1e-3);
    return s;
}
BITS_HD static void bits_put_stat(float *out, mcs_stat s) {
    bits_put_double(out, 0, s.n), bits_put_double(out, 2, s.mean), bits_put_double(out, 4, s.m2);
}
FN(stat_add) { bits_put_stat(out, bits_stat(in, (int)(WORD(12) % 9))); }
FN(stat_merge) { bits_put_stat(out, mcs_stat_merge(bits_stat(in, (int)(WORD(12) % 9)), bits_stat(in + 1, (int)(WORD(13) % 9)))); }
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
#undef WORD2
#endif

#undef FN
#undef IN
#undef IN3
#undef WORD
#undef PUT
#undef PUT_WORD
#undef BITS_W
#undef F_
#undef U_
#undef M_
#undef B_
