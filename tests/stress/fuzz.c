/* A libFuzzer target: raw bytes choose a function and are its arguments. Every public function is reached; every result
 * must be finite and in its range; arrays and tables are allocated at exactly their size, so that the address sanitizer
 * sees a byte too far.
 *
 *     clang -g -O1 -fsanitize=fuzzer,address,undefined,float-cast-overflow -fno-sanitize-recover=all -I. -Itests fuzz.c
 *     -o fuzz
 *
 * With -DMCS_FUZZ_MAIN and any compiler the program replays the files given to it, or, without any, a corpus made from
 * a counter (1e7 inputs times MCS_TEST_SCALE); options as in mcs_test.h. */
#include "forge.h"
#include "latlong.h"
#include "stress.h"

/* --- the input ---------------------------------------------------------------------------------------------------- */

typedef struct {
    const uint8_t *at;
    size_t left;
} bytes;

static void take(bytes *b, void *to, size_t n) { /* zeros after the end */
    const size_t have = n < b->left ? n : b->left;
    memset(to, 0, n);
    if (have) memcpy(to, b->at, have);
    b->at += have;
    b->left -= have;
}
static uint8_t take_u8(bytes *b) {
    uint8_t v;
    take(b, &v, sizeof v);
    return v;
}
static uint32_t take_u32(bytes *b) {
    uint32_t v;
    take(b, &v, sizeof v);
    return v;
}
static uint64_t take_u64(bytes *b) {
    uint64_t v;
    take(b, &v, sizeof v);
    return v;
}
static float take_float(bytes *b) { return st_float(take_u32(b)); }
static mcs_vec3 take_vec3(bytes *b) {
    mcs_vec3 v;
    v.x = take_float(b);
    v.y = take_float(b);
    v.z = take_float(b);
    return v;
}
/* Raw bytes are seldom a direction: where `tame` is set, any vector is brought to unit length. */
static mcs_vec3 take_direction(bytes *b, int tame) {
    mcs_vec3 v = take_vec3(b);
    const double x = (double)v.x;
    const double y = (double)v.y;
    const double z = (double)v.z;
    const double l = sqrt(x * x + y * y + z * z);
    if (tame && l > 0 && l <= 1e39) {
        v.x = (float)(x / l);
        v.y = (float)(y / l);
        v.z = (float)fabs(z / l);
    }
    return v;
}
/* ... nor a random number. */
static float take_u(bytes *b, int tame) {
    const uint32_t v = take_u32(b);
    return tame ? mcs_u01(v) : st_float(v);
}

/* --- what must hold ----------------------------------------------------------------------------------------------- */

static const char *doing = "";
#ifdef MCS_FUZZ_MAIN
#define MUST(cond) CHECK(cond, "%s", doing)
#else
#define MUST(cond) ((cond) ? (void)0 : fail(__LINE__, #cond))
static void fail(int line, const char *what) {
    fprintf(stderr, "fuzz.c:%d: %s: %s\n", line, doing, what);
    abort();
}
#endif

static int finite(float v) { return fabsf(v) <= FLT_MAX; }
static int proper(float v) { return v >= 0 && v <= FLT_MAX; }
static int below_one(float v) { return v >= 0 && v < 1; }
static int finite3(mcs_vec3 v) { return finite(v.x) && finite(v.y) && finite(v.z); }

/* `n` floats of their own allocation. */
static float *floats(size_t n) {
    float *f = (float *)malloc(n * sizeof(float) + !n);
    if (!f) exit(2);
    return f;
}

/* The array forms of a row: numbers from the bytes while there are any, then u and x. */
static void fuzz_arrays(const mcst_row *row, const float *p, const float *u, const float *x, int tame, size_t n,
                        bytes *b) {
    float *in[3];
    for (int k = 0; k < 3; k++) in[k] = floats(n);
    float *to[5];
    for (int k = 0; k < 5; k++) {
        to[k] = floats(n);
        memset(to[k], 0, n * sizeof(float));
    }
    float *value = floats(n);
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) in[k][i] = b->left ? take_u(b, tame && k < 2) : k < 2 ? u[k] : x[k];
    row->sample_n(p, n, in[0], in[1], to);
    for (size_t i = 0; i < n; i++) {
        MUST(finite(to[0][i]) && finite(to[1][i]) && finite(to[2][i]) && proper(to[3][i]) && proper(to[4][i]));
        MUST(to[3][i] > 0 || to[4][i] == 0);
    }
    if (row->pdf_n) {
        row->pdf_n(p, n, in[0], in[1], in[2], value);
        for (size_t i = 0; i < n; i++) MUST(proper(value[i]));
        row->eval_n(p, n, in[0], in[1], in[2], value);
        for (size_t i = 0; i < n; i++) MUST(proper(value[i]));
    }
    for (int k = 0; k < 3; k++) free(in[k]);
    for (int k = 0; k < 5; k++) free(to[k]);
    free(value);
}
/* --- the functions ------------------------------------------------------------------------------------------------ */

static void fuzz_row(const mcst_row *row, bytes *b) {
    const int tame = take_u8(b) & 1;
    const size_t n = take_u8(b);
    float out[5] = {0};
    float v[2] = {0};
    float p[MCST_P];
    for (int k = 0; k < 3; k++) p[k] = take_float(b);
    if (tame) /* any bits to a number between 2^-24 and 2^24, mostly in range */
        for (int k = 0; k < 3; k++) p[k] = fabsf(p[k]) > 0x1p-24f && fabsf(p[k]) < 0x1p24f ? fabsf(p[k]) : 0.5f;
    const mcs_vec3 wo = take_direction(b, tame);
    float u[2];
    u[0] = take_u(b, tame);
    u[1] = take_u(b, tame);
    const mcs_vec3 w = take_direction(b, tame);
    p[3] = wo.x;
    p[4] = wo.y;
    p[5] = wo.z;
    float x[3];
    x[0] = w.x;
    x[1] = w.y;
    x[2] = w.z;
    row->fn[0].sample(p, &u[0], &u[1], out);
    MUST(finite(out[0]) && finite(out[1]) && finite(out[2]) && proper(out[3]) && proper(out[4]));
    MUST(out[3] > 0 || out[4] == 0);
    row->fn[0].pdf(p, x, v);
    MUST(proper(v[0]));
    row->fn[0].pdf(p, out, v);
    MUST(proper(v[0]));
    if (row->fn[0].invert) {
        v[0] = v[1] = 0;
        row->fn[0].invert(p, x, v);
        MUST(below_one(v[0]) && below_one(v[1]));
    } else {
        row->fn[0].eval(p, x, &v[0]);
        row->fn[0].weight(p, x, &v[1]);
        MUST(proper(v[0]) && proper(v[1]));
    }
    fuzz_arrays(row, p, u, x, tame, n, b);
}

static void fuzz_numbers(bytes *b) {
    const uint32_t i = take_u32(b);
    const uint32_t dim = take_u32(b);
    const uint32_t seed = take_u32(b);
    const uint32_t nx = take_u32(b);
    const uint32_t ny = take_u32(b);
    const uint64_t key = take_u64(b);
    const uint64_t counter = take_u64(b);
    const size_t n = take_u8(b);
    const mcs_vec2 s = mcs_stratified(i, nx, ny, seed);
    const mcs_vec2 r = mcs_r2(i, seed);
    const mcs_philox4 block = mcs_philox(key, counter, ~key);
    mcs_pcg32 g = mcs_pcg32_make(key, counter);
    float *out = floats(n);
    MUST(below_one(s.x) && below_one(s.y) && below_one(r.x) && below_one(r.y));
    MUST(below_one(mcs_latin(i, nx, dim, seed)) && below_one(mcs_sobol(i, dim, seed)) && below_one(mcs_u01(i)));
    MUST(mcs_u01_open(i) > 0 && mcs_u01_open(i) < 1);
    MUST(mcs_u01(mcs_sobol_bits(i, dim, seed)) == mcs_sobol(i, dim, seed));
    MUST(mcs_u01(mcs_hash(i, seed)) < 1);
    MUST(mcs_sobol_pixel(nx, ny, i | 64u, seed) % 64u == 0);
    mcs_pcg32_advance(&g, key);
    mcs_pcg32 back = g;
    MUST(below_one(mcs_pcg32_float(&g)));
    mcs_pcg32_advance(&g, ~(uint64_t)0);
    MUST(mcs_pcg32_next(&g) == mcs_pcg32_next(&back));
    mcs_pcg32_fill_n(&g, n, out);
    for (size_t k = 0; k < n; k++) MUST(below_one(out[k]));
    mcs_sobol_n(i, dim, seed, n, out);
    for (size_t k = 0; k < n; k++) MUST(out[k] == mcs_sobol(i + (uint32_t)k, dim, seed));
    mcs_philox_fill_n(key, counter, n, out);
    for (size_t k = 0; k < n; k++) MUST(below_one(out[k]));
    MUST(below_one(mcs_u01(block.v[i & 3])));
    free(out);
}

static void fuzz_vectors(bytes *b) {
    const int tame = take_u8(b) & 1;
    const mcs_vec3 v = take_direction(b, tame);
    const mcs_vec3 w = take_direction(b, tame);
    const mcs_vec3 any = take_vec3(b);
    const mcs_frame f = mcs_frame_make(v);
    const mcs_ggx m = mcs_ggx_make(take_float(b), take_float(b));
    const float p = take_float(b);
    const float q = take_float(b);
    const float r = take_float(b);
    const mcs_vec3 h = mcs_half(v, w);
    const mcs_frame g = mcs_frame_from_tangent(v, any);
    const mcs_vec3 t = mcs_refract(v, w, p);
    MUST(finite3(g.s) && finite3(g.t) && finite3(g.n));
    MUST(finite3(t) && finite3(mcs_refract(any, w, q)));
    MUST(proper(mcs_fresnel_dielectric(p, q)) && mcs_fresnel_dielectric(p, q) <= 1);
    MUST(proper(mcs_fresnel_conductor(p, q, r)) && mcs_fresnel_conductor(p, q, r) <= 1);
    MUST(finite3(f.s) && finite3(f.t) && finite3(f.n));
    MUST(finite3(mcs_to_world(&f, any)) && finite3(mcs_to_local(&f, any)));
    MUST(finite3(mcs_reflect(v, w)) && finite3(mcs_reflect(any, w)) && finite3(mcs_half(any, w)));
    MUST(fabs(sqrt((double)h.x * (double)h.x + (double)h.y * (double)h.y + (double)h.z * (double)h.z) - 1) <=
         4 * 0x1p-24);
    MUST(proper(mcs_cos_d(v, w)) && proper(mcs_cos_d(any, v)));
    MUST(proper(mcs_schlick(p, q)) && mcs_schlick(p, q) <= 1);
    MUST(proper(mcs_mis_balance(p, q)) && mcs_mis_balance(p, q) <= 1);
    MUST(proper(mcs_mis_power(p, q)) && mcs_mis_power(p, q) <= 1);
    MUST(proper(mcs_mix_pdf(p, q, r)) && proper(mcs_reflect_pdf(p, q)));
    MUST(proper(mcs_ggx_d(&m, w)) && proper(mcs_ggx_g1(&m, w)) && proper(mcs_ggx_g2(&m, v, w)));
    MUST(mcs_ggx_g1(&m, w) <= 1.000001f && mcs_ggx_g2(&m, v, w) <= 1.000001f);
    MUST(proper(mcs_ggx_albedo(&m, w)) && mcs_ggx_albedo(&m, w) <= 1);
    MUST(proper(mcs_ggx_mean_albedo(&m)) && mcs_ggx_mean_albedo(&m) <= 1 && proper(mcs_ggx_compensation(&m, v, w)));
    const mcs_brdf s = mcs_ggx_glass_sample(&m, p, v, q, r, take_float(b));
    MUST(finite3(s.wi) && proper(s.pdf) && proper(s.weight) && s.weight <= 1.000001f);
    MUST(proper(mcs_ggx_glass_pdf(&m, p, v, w)) && proper(mcs_ggx_glass_eval(&m, p, v, w)));
    MUST(proper(mcs_ggx_glass_weight(&m, p, v, w)) && proper(mcs_ggx_glass_pdf(&m, q, any, w)));
    MUST(proper(mcs_cone_from_sin2(p)) && mcs_cone_from_sin2(p) <= 1);
    MUST(mcs_is_mirror(p, q) == (p < 1e-7f && q < 1e-7f));
}

static double take_moderate(bytes *b) { /* within 1e150, so that squares are doubles */
    const uint64_t v = take_u64(b);
    double x;
    memcpy(&x, &v, sizeof x);
    return fabs(x) <= 1e150 ? x : 0;
}
static void fuzz_estimator(bytes *b) {
    mcs_stat all = {0, 0, 0};
    mcs_stat parts[2] = {{0, 0, 0}, {0, 0, 0}};
    for (size_t i = 0; b->left; i++) {
        const double x = take_moderate(b);
        mcs_stat_add(&all, x);
        mcs_stat_add(&parts[i & 1], x);
    }
    mcs_stat_merge(&parts[0], &parts[1]);
    MUST(parts[0].n == all.n && isfinite(parts[0].mean));
    MUST(isfinite(all.mean) && mcs_stat_variance(&all) >= 0 && isfinite(mcs_stat_variance(&all)));
    MUST(isfinite(mcs_stat_error(&all)) && isfinite(mcs_stat_ci(&all, 1.96)) && isfinite(mcs_stat_variance(&parts[0])));
}

static void fuzz_reservoirs(bytes *b) {
    mcs_kept kept[2][4];
    mcs_reservoir one[2] = {{0, 0, 0}, {0, 0, 0}};
    mcs_reservoir_k some[2] = {mcs_reservoir_k_make(kept[0], take_u8(b) % 5), mcs_reservoir_k_make(kept[1], 4)};
    for (uint32_t i = 0; b->left; i++) {
        const float w = take_float(b);
        const double u = (double)take_float(b);
        MUST(mcs_reservoir_add(&one[i & 1], i, w, u) <= (w > 0));
        MUST(mcs_reservoir_k_add(&some[i & 1], i, w, u) <= (w > 0));
    }
    mcs_reservoir_merge(&one[0], &one[1], 0.5);
    MUST(one[0].total >= 0 && isfinite(one[0].total) && proper(mcs_reservoir_weight(&one[0], 1e-30f)));
    mcs_reservoir_k_merge(&some[0], &some[1]);
    MUST(some[0].count <= some[0].k);
    for (uint32_t i = 0; i <= some[0].count; i++) MUST(proper(mcs_reservoir_k_weight(&some[0], i)));
}

enum { PWC, PWL, ALIAS, FROM_FUNCTION, KINDS };

static float next_entry(float x, void *context) {
    (void)x;
    return take_float((bytes *)context);
}
static mcs_status build(int kind, void *t, size_t size, const float *f, uint32_t n, bytes *b) {
    if (kind == PWL) return (mcs_status)mcs_pwl_build((mcs_pwl *)t, size, f, n);
    if (kind == ALIAS) return (mcs_status)mcs_alias_build((mcs_alias *)t, size, f, n);
    if (kind == FROM_FUNCTION) return (mcs_status)mcs_pwc_build_fn((mcs_pwc *)t, size, next_entry, b, n);
    return (mcs_status)mcs_pwc_build((mcs_pwc *)t, size, f, n);
}
static size_t size_of(int kind, uint32_t n) {
    return kind == PWL ? mcs_pwl_bytes(n) : kind == ALIAS ? mcs_alias_bytes(n) : mcs_pwc_bytes(n);
}

static uint32_t bits_of(float x) {
    uint32_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}
static void draw_table(int kind, const void *t, uint32_t n, float u, float x, uint32_t i) {
    const int good = u >= 0 && u < 1;
    const uint32_t b1 = bits_of(u);
    const uint32_t b2 = bits_of(x);
    if (kind == PWL) {
        const mcs_cell c = mcs_pwl_sample((const mcs_pwl *)t, u);
        const mcs_cell s = mcs_pwl_sample_bits((const mcs_pwl *)t, b1, b2);
        MUST(below_one(s.x) && proper(s.pdf) && s.i < n);
        MUST(below_one(c.x) && proper(c.pdf) && c.i < n && (good || c.pdf == 0));
        MUST(proper(mcs_pwl_pdf((const mcs_pwl *)t, x)) && below_one(mcs_pwl_invert((const mcs_pwl *)t, x)));
    } else if (kind == ALIAS) {
        const mcs_pick c = mcs_alias_sample((const mcs_alias *)t, u);
        const mcs_pick s = mcs_alias_sample_bits((const mcs_alias *)t, b1, b2);
        MUST(below_one(s.u) && s.i < n && s.pmf > 0 && s.pmf <= 1);
        MUST(below_one(c.u) && c.pmf <= 1 && c.i < n && (good ? c.pmf > 0 : c.pmf == 0));
        MUST(proper(mcs_alias_pmf((const mcs_alias *)t, i)) &&
             (!good || mcs_alias_pmf((const mcs_alias *)t, c.i) == c.pmf));
    } else {
        const mcs_pwc *pwc = (const mcs_pwc *)t;
        const mcs_cell c = mcs_pwc_sample(pwc, u);
        const mcs_cell s = mcs_pwc_sample_bits(pwc, b1, b2);
        const mcs_pick d = mcs_discrete_sample(pwc, u);
        const mcs_pick p = mcs_discrete_sample_bits(pwc, b1, b2);
        MUST(below_one(s.x) && s.i < n && s.pdf > 0 && mcs_pwc_pdf(pwc, s.x) == s.pdf);
        MUST(below_one(p.u) && p.i == s.i && p.pmf > 0 && mcs_discrete_pmf(pwc, p.i) == p.pmf);
        MUST(below_one(c.x) && proper(c.pdf) && c.i < n && (good ? c.pdf > 0 : c.pdf == 0));
        MUST(below_one(d.u) && d.i == c.i && d.pmf <= 1 && (good ? d.pmf > 0 : d.pmf == 0));
        MUST(!good || (mcs_pwc_pdf(pwc, c.x) == c.pdf && mcs_discrete_pmf(pwc, d.i) == d.pmf));
        MUST(proper(mcs_pwc_pdf(pwc, x)) && below_one(mcs_pwc_invert(pwc, x)) && proper(mcs_discrete_pmf(pwc, i)));
    }
}

static void fuzz_table(int kind, bytes *b) {
    const uint32_t wild = take_u32(b);
    const uint32_t n = 1 + wild % 2048;
    const uint32_t entries = n + (kind == PWL);
    const size_t size = size_of(kind, n);
    const size_t less = take_u8(b);
    const size_t count = take_u8(b) % 70;
    float *f = floats(entries);
    float *u = floats(count);
    float *x = floats(count);
    float *pdf = floats(count);
    void *t = malloc(size);
    void *copy = malloc(size);
    if (!t || !copy) exit(2);
    for (size_t k = 0; k < count; k++) u[k] = take_u(b, k & 1);
    for (uint32_t i = 0; i < entries; i++) f[i] = b->left ? take_float(b) : i ? f[i / 2] : 0;
    /* sizes that are not what was allocated, and a table that starts at a wrong address */
    mcs_status e = build(kind, t, size < less + 1 ? 0 : size - less - 1, f, n, b);
    MUST(e == MCS_ERR_MEMORY);
    if (size_of(kind, wild) > size || size_of(kind, wild) == 0) {
        e = build(kind, t, size, f, wild, b);
        MUST(e == MCS_ERR_MEMORY || e == MCS_ERR_SIZE);
    }
    e = build(kind, (char *)t + 4, size, f, n, b);
    MUST(e == MCS_ERR_ARG);
    MUST(build(kind, t, size, f, n, b) == MCS_OK);
    memcpy(copy, t, size); /* tables hold no addresses */
    free(t);
    for (size_t k = 0; k < count; k++) draw_table(kind, copy, n, u[k], u[count - 1 - k], wild);
    if (kind != ALIAS) {
        if (kind == PWL) mcs_pwl_sample_n((const mcs_pwl *)copy, count, u, x, pdf);
        else mcs_pwc_sample_n((const mcs_pwc *)copy, count, u, x, pdf);
        for (size_t k = 0; k < count; k++) MUST(below_one(x[k]) && proper(pdf[k]));
    }
    free(copy);
    free(f);
    free(u);
    free(x);
    free(pdf);
}

/* --- environment maps and products -------------------------------------------------------------------------------- */

static void *room(size_t size) {
    void *p = malloc(size + !size);
    if (!p) exit(2);
    return p;
}

/* Draws and densities of a map, of a window of it where m is given, with the axes as frame or without: then only inside
 * the map. */
static void draw_env(const mcs_env *e, const mcs_env_window *m, int axes, bytes *b) {
    const size_t count = take_u8(b) % 40;
    float *u = floats(2 * count);
    float *to[4];
    for (int i = 0; i < 4; i++) to[i] = floats(count);
    for (size_t k = 0; k < count; k++) {
        const float u1 = u[k] = take_u(b, k & 1);
        const float u2 = u[count + k] = take_u(b, k & 1);
        const mcs_vec3 w = take_direction(b, k & 1);
        const int good = below_one(u1) && below_one(u2);
        const mcs_texel s = m ? mcs_env_window_sample(m, e, u1, u2) : mcs_env_sample(e, u1, u2);
        const mcs_texel at = mcs_env_texel(e, w);
        const mcs_texel bits = mcs_env_sample_bits(e, take_u32(b), ~(uint32_t)k);
        const mcs_texel own = mcs_env_texel(e, s.w);
        const float here = m ? mcs_env_window_pdf(m, e, s.w) : mcs_env_pdf(e, s.w);
        const float there = m ? mcs_env_window_pdf(m, e, w) : mcs_env_pdf(e, w);
        const mcs_vec2 back = mcs_env_invert(e, w);
        const mcs_vec2 again = mcs_env_invert(e, s.w);
        MUST(s.row < e->h && s.col < e->w && at.row < e->h && at.col < e->w && bits.row < e->h && bits.col < e->w);
        MUST(proper(s.pdf) && proper(here) && proper(there) && proper(bits.pdf) && proper(at.pdf));
        MUST(below_one(back.x) && below_one(back.y) && below_one(again.x) && below_one(again.y));
        MUST(proper(mcs_env_weight(e, there)) && (good || s.pdf == 0));
        if (!axes) continue;
        MUST(finite3(s.w) && finite3(bits.w) && finite3(at.w) && bits.pdf > 0);
        MUST(!good || (s.pdf > 0 && here == s.pdf && own.row == s.row && own.col == s.col));
    }
    if (m) mcs_env_window_sample_n(m, e, count, u, u + count, to[0], to[1], to[2], to[3], NULL, NULL);
    else mcs_env_sample_n(e, count, u, u + count, to[0], to[1], to[2], to[3], NULL, NULL);
    for (size_t k = 0; k < count; k++) {
        MUST(proper(to[3][k]) && (!axes || (finite(to[0][k]) && finite(to[1][k]) && finite(to[2][k]))));
        if (k & 1) to[0][k] = take_float(b);
    }
    mcs_env_pdf_n(e, count, to[0], to[1], to[2], to[3]);
    for (size_t k = 0; k < count; k++) MUST(proper(to[3][k]));
    for (int i = 0; i < 4; i++) free(to[i]);
    free(u);
}

/* A region that learns whatever comes. */
static void fuzz_region(mcs_region *g, const mcs_tiles *t, const mcs_env *e, const mcs_reflection *r, bytes *b) {
    const size_t size = mcs_region_bytes(16);
    MUST(mcs_region_start(g, size - 1, t) == MCS_ERR_MEMORY && mcs_region_start(g, size, t) == MCS_OK);
    for (uint32_t left = take_u8(b) % 40; left > 0; left--) {
        const uint32_t k = take_u32(b);
        switch (k >> 28) {
        case 0: mcs_region_add_point(g, t, e, r); break;
        case 1: mcs_region_decay(g, take_float(b)); break;
        case 2: mcs_region_merge(g, g); break;
        case 4: mcs_region_inherit(g, g); break;
        case 3: mcs_region_add_ray(g, k << 4 | 3, 1); break; /* mostly no tile */
        default: mcs_region_add_ray(g, k % 512, (int)(k >> 27 & 1));
        }
        const float v = mcs_region_visibility(g, k % 600);
        MUST((mcs_region_pays(g, r) & ~1) == 0);
        MUST(v >= 0 && v <= 1 && mcs_tiles_of_direction(t, e, take_direction(b, k & 1)) <= 512 &&
             mcs_tiles_of_texel(t, e, k % 80, k >> 16) <= 512);
    }
}
/* Draws of a product, and densities. */
static void draw_product(const mcs_product *p, const mcs_tiles *t, const mcs_env *e, size_t count, bytes *b) {
    float *u = floats(2 * count);
    float *to[4];
    for (int i = 0; i < 4; i++) to[i] = floats(count);
    for (size_t k = 0; k < count; k++) {
        const float u1 = u[k] = take_u(b, k & 1);
        const float u2 = u[count + k] = take_u(b, k & 1);
        const mcs_vec3 w = take_direction(b, k & 1);
        const mcs_texel a = mcs_product_sample(p, t, e, u1, u2);
        const int good = below_one(u1) && below_one(u2);
        MUST(finite3(a.w) && proper(a.pdf) && (good || a.pdf == 0) && a.row < e->h && a.col < e->w);
        MUST(proper(mcs_product_pdf(p, t, e, w)));
        MUST(!(a.pdf > 0) || (mcs_product_pdf(p, t, e, a.w) > 0 && mcs_product_pdf(p, t, e, a.w) <= FLT_MAX));
    }
    mcs_product_sample_n(p, t, e, count, u, u + count, to[0], to[1], to[2], to[3], NULL, NULL);
    for (size_t k = 0; k < count; k++) {
        MUST(finite(to[0][k]) && finite(to[1][k]) && finite(to[2][k]) && proper(to[3][k]));
        if (k & 1) to[0][k] = take_float(b);
    }
    mcs_product_pdf_n(p, t, e, count, to[0], to[1], to[2], to[count & 3]);
    for (size_t k = 0; k < count; k++) MUST(proper(to[count & 3][k]));
    for (int i = 0; i < 4; i++) free(to[i]);
    free(u);
}
static void fuzz_product(const mcs_env *e, bytes *b) {
    const size_t size = mcs_tiles_bytes(e, 16);
    const size_t product_size = mcs_product_bytes(16);
    const int tame = take_u8(b) & 1;
    const int kind = take_u8(b) % 4;
    mcs_tiles *t = (mcs_tiles *)room(size);
    mcs_region *g = (mcs_region *)room(mcs_region_bytes(16));
    mcs_product *p = (mcs_product *)room(product_size);
    MUST(mcs_tiles_build(t, size - 1, e, 16) == MCS_ERR_MEMORY &&
         mcs_tiles_build(t, size, e, take_u8(b) | 1u) == MCS_ERR_SIZE);
    mcs_status s = mcs_tiles_build(t, size, e, 16);
    MUST(s == MCS_OK);
    mcs_reflection r;
    r.frame = mcs_frame_make(take_direction(b, tame));
    if (!tame) {
        r.frame.s = take_vec3(b);
        r.frame.t = take_vec3(b);
        r.frame.n = take_vec3(b);
    }
    r.wo = take_direction(b, tame);
    r.alpha_x = take_float(b);
    r.alpha_y = take_float(b);
    r.matte = take_float(b);
    r.profile = (mcs_profile)(take_u8(b) & 3);
    if (tame) {
        r.alpha_x = mcs_schlick(0, r.alpha_x);
        r.alpha_y = mcs_schlick(0, r.alpha_y);
        r.matte = mcs_schlick(0, r.matte);
    }
    MUST(mcs_product_build(p, product_size - 1, t, e, &r, NULL) == MCS_ERR_MEMORY);
    float weight[512];
    for (size_t k = 0; k < 512; k++) weight[k] = k < 64 ? take_float(b) : weight[k / 8];
    for (size_t k = 0; k < 512; k++) MUST(finite3(mcs_tiles_direction(t, e, (uint32_t)k)));
    fuzz_region(g, t, e, &r, b);
    s = kind == 0   ? mcs_product_build_weights(p, product_size, t, e, weight)
        : kind == 1 ? mcs_product_build_region(p, mcs_product_table_bytes(16), t, e, g)
                    : mcs_product_build(p, product_size, t, e, &r, kind == 2 ? g : NULL);
    MUST(s == MCS_OK && (kind != 1 || !p->dark));
    const float share = mcs_region_share(p, &r);
    MUST(p->reach >= 0 && p->reach <= 1.001e4f && (share == 0 || share == 0.125f || share == 1));
    draw_product(p, t, e, take_u8(b) % 40, b);
    free(g);
    free(p);
    free(t);
}

/* A rectangle of rows and columns in the map, and any other. */
typedef struct {
    uint32_t row, rows, col, cols, wild_row, wild_rows, wild_col, wild_cols;
} rectangle;

static rectangle take_rectangle(bytes *b, uint32_t w, uint32_t h) {
    rectangle t;
    t.row = take_u8(b) % h;
    t.rows = 1 + take_u8(b) % (h - t.row);
    t.col = take_u8(b) % w;
    t.cols = 1 + take_u8(b) % w;
    t.wild_row = take_u32(b);
    t.wild_rows = take_u32(b);
    t.wild_col = take_u32(b);
    t.wild_cols = take_u32(b);
    return t;
}
static void fuzz_window(const mcs_env *e, const rectangle *t, bytes *b) {
    const size_t size = mcs_env_window_bytes(t->rows);
    mcs_env_window *m = (mcs_env_window *)room(size);
    MUST(mcs_env_window_build(m, size - 1, e, t->row, t->rows, t->col, t->cols) == MCS_ERR_MEMORY);
    mcs_status s;
    if (mcs_env_window_bytes(t->wild_rows) <= size) {
        s = mcs_env_window_build(m, size, e, t->wild_row, t->wild_rows, t->wild_col, t->wild_cols);
        MUST(s == MCS_OK || s == MCS_ERR_SIZE);
    }
    s = mcs_env_window_build(m, size, e, t->row, t->rows, t->col, t->cols);
    MUST(s == MCS_OK);
    draw_env(e, m, 1, b);
    free(m);
}
/* A table of the image in `e`, and in `other` in two parts; `wrong`: an image that is not there. */
static void fuzz_builds(const mcs_image *im, const mcs_image *wrong, uint32_t cut, mcs_env *e, mcs_env *other,
                        size_t size) {
    memset(e, 0, size);
    memset(other, 0, size);
    MUST(mcs_env_build(e, size - 1, im) == MCS_ERR_MEMORY);
    mcs_status s;
    if (mcs_env_bytes(wrong->w, wrong->h) == 0 || mcs_env_bytes(wrong->w, wrong->h) > size) {
        s = mcs_env_build(e, size, wrong);
        MUST(s == MCS_ERR_SIZE || s == MCS_ERR_MEMORY);
    }
    s = mcs_env_build(e, size, im);
    MUST(s == MCS_OK && e->total >= 0 && e->total <= 1e300 && mcs_env_check(e, size) == MCS_OK);
    MUST(mcs_env_build_rows(other, size, im, cut, im->h) == MCS_OK &&
         mcs_env_build_rows(other, size, im, 0, cut) == MCS_OK);
    MUST(mcs_env_finish(other, size, im) == s && !memcmp(e, other, size));
}
/* An image whose floats are what is left of the input, over and over; then the map, a window and, if asked for,
 * products. */
static void fuzz_env(int products, bytes *b) {
    const uint32_t w = 1 + take_u8(b) % 70;
    const uint32_t h = 1 + take_u8(b) % 40;
    const uint32_t kind = take_u8(b);
    const uint32_t gaps = take_u8(b);
    const uint32_t channels = kind & 1 ? 1 : 3 + (kind >> 1) % 2;
    const uint32_t step = channels + gaps % 3;
    const uint32_t row = (w - 1) * step + channels + gaps / 3 % 7;
    const uint32_t cut = take_u8(b) % (h + 1);
    const size_t n = (size_t)(h - 1) * row + (size_t)(w - 1) * step + channels;
    const size_t size = mcs_env_bytes(w, h);
    const rectangle t = take_rectangle(b, w, h);
    float *f = floats(n);
    mcs_env *e = (mcs_env *)room(size);
    mcs_env *other = (mcs_env *)room(size);
    mcs_image im = mcs_image_make(f, w, h, channels);
    im.pixel_stride = (ptrdiff_t)step;
    im.row_stride = (ptrdiff_t)row;
    im.bilinear = (kind & 8) != 0;
    if (kind & 16) {
        im.pixels = f + (size_t)(h - 1) * row;
        im.row_stride = -im.row_stride;
    }
    mcs_image wrong = im;
    wrong.w = take_u32(b);
    wrong.h = take_u32(b);
    wrong.pixel_stride = (ptrdiff_t)take_u64(b);
    wrong.row_stride = (ptrdiff_t)take_u64(b);
    im.floor = kind & 32 ? take_float(b) : 0;
    bytes pixels = *b;
    for (size_t k = 0; k < n; k++) {
        if (!pixels.left) pixels = *b;
        f[k] = take_float(&pixels);
    }
    if ((kind & 96) == 96) im.floor = mcs_env_mean(&im);
    MUST(proper(mcs_env_mean(&im)));
    fuzz_builds(&im, &wrong, cut, e, other, size);
    free(e);
    free(f); /* tables hold no addresses */
    draw_env(other, NULL, 1, b);
    fuzz_window(other, &t, b);
    if (products) fuzz_product(other, b);
    for (int i = 0; i < 2; i++) {
        other->frame.s = take_vec3(b);
        other->frame.t = take_vec3(b);
        other->frame.n = take_direction(b, 1);
        if (i) other->frame = mcs_frame_make(other->frame.n);
        draw_env(other, NULL, 0, b);
    }
    free(other);
}

/* A table as it comes from a file: the input itself, or a map of the input's size with bytes of it changed; half of
 * them with checksums that fit, as they would hide from everything else that is checked. */
static void fuzz_file(bytes *b) {
    const uint32_t kind = take_u8(b);
    const uint32_t raw = kind & 1;
    const uint32_t forged = kind & 2;
    const uint32_t w = 1 + take_u8(b) % 20;
    const uint32_t h = 1 + take_u8(b) % 12;
    const uint32_t changes = take_u8(b) % 4;
    const size_t table = mcs_env_bytes(w, h);
    const size_t size = raw ? b->left : table;
    const size_t less = take_u32(b);
    mcs_env *e = (mcs_env *)room(size);
    mcs_status s;
    if (raw) {
        bytes whole = *b;
        take(&whole, e, size);
    } else {
        float pixels[20 * 12];
        const mcs_image im = mcs_image_make(pixels, w, h, 1);
        for (uint32_t i = 0; i < w * h; i++) pixels[i] = i < 16 ? take_float(b) : pixels[i / 2];
        memset(e, 0, size);
        s = mcs_env_build(e, size, &im);
        MUST(s == MCS_OK && mcs_env_check(e, size) == MCS_OK);
        for (uint32_t i = 0; i < changes; i++) {
            const uint32_t at = take_u32(b);
            ((unsigned char *)e)[at % size] ^= take_u8(b);
        }
    }
    if (forged && size >= sizeof *e && mcs_env_bytes(e->w, e->h) == size && is_laid_out(e)) seal(e);
    mcs_env *cut = (mcs_env *)room(size ? less % size : 0);
    memcpy(cut, e, size ? less % size : 0);
    s = mcs_env_check(cut, size ? less % size : 0);
    MUST(raw || s == MCS_ERR_MEMORY || s == MCS_ERR_FORMAT);
    free(cut);
    s = mcs_env_check(e, size);
    MUST(s == MCS_OK || s == MCS_ERR_MEMORY || s == MCS_ERR_FORMAT);
    if (s == MCS_OK) {
        const uint32_t y = take_u8(b) % e->h;
        const uint32_t rows = 1 + take_u8(b) % (e->h - y);
        const uint32_t x = take_u8(b) % e->w;
        const uint32_t cols = 1 + take_u8(b) % e->w;
        const size_t window_size = mcs_env_window_bytes(rows);
        mcs_env_window *m = (mcs_env_window *)room(window_size);
        draw_env(e, NULL, 0, b);
        s = mcs_env_window_build(m, window_size, e, y, rows, x, cols);
        MUST(s == MCS_OK);
        draw_env(e, m, 0, b);
        free(m);
    }
    free(e);
}

enum {
    NUMBERS = MCST_NROWS,
    VECTORS,
    ESTIMATOR,
    RESERVOIRS,
    TABLES,
    ENV = TABLES + KINDS,
    PRODUCT,
    ENV_FILE,
    FUNCTIONS
};
static const char *const other_name[FUNCTIONS - MCST_NROWS] = {
    "numbers",           "vectors",     "estimator", "reservoirs",      "pwc", "pwl", "alias",
    "pwc of a function", "environment", "product",   "environment file"};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    bytes b;
    b.at = data;
    b.left = size;
    const int which = take_u8(&b) % FUNCTIONS;
    doing = which < (int)MCST_NROWS ? mcst_rows[which].name : other_name[which - (int)MCST_NROWS];
    if (which < (int)MCST_NROWS) fuzz_row(&mcst_rows[which], &b);
    else if (which == NUMBERS) fuzz_numbers(&b);
    else if (which == VECTORS) fuzz_vectors(&b);
    else if (which == ESTIMATOR) fuzz_estimator(&b);
    else if (which == RESERVOIRS) fuzz_reservoirs(&b);
    else if (which == ENV || which == PRODUCT) fuzz_env(which == PRODUCT, &b);
    else if (which == ENV_FILE) fuzz_file(&b);
    else fuzz_table(which - TABLES, &b);
    return 0;
}

#ifdef MCS_FUZZ_MAIN
static int replay(const char *path) {
    uint8_t *data = NULL;
    size_t size = 0;
    size_t room = 0;
    FILE *f = fopen(path, "rb");
    if (!f) return 0;
    size_t got;
    do {
        if (size == room) data = (uint8_t *)realloc(data, room = 2 * room + 4096);
        if (!data) exit(2);
        got = fread(data + size, 1, room - size, f);
        size += got;
    } while (got);
    fclose(f);
    LLVMFuzzerTestOneInput(data, size);
    free(data);
    return 1;
}

/* Input number i: words of every class of float, any bits, or small numbers, for the function i modulo their number. */
static void replay_number(uint64_t i) {
    uint64_t state = mcst.seed + i;
    const uint64_t z = mcst_mix(&state);
    uint8_t data[1200];
    const size_t size = 64 + z % (sizeof data - 64);
    size_t k = 0;
    for (; k + 4 <= size; k += 4) {
        const uint64_t word = mcst_mix(&state);
        const float f = (z >> 40) & 1 ? st_hostile(word) : mcs_u01((uint32_t)(word >> 32));
        memcpy(data + k, &f, sizeof f);
        if ((word & 15) == 0) memcpy(data + k, &word, 4);
    }
    for (; k < size; k++) data[k] = (uint8_t)k;
    data[0] = (uint8_t)(i % FUNCTIONS);
    data[1] = (uint8_t)(z >> 48);
    data[2] = (uint8_t)(z >> 56);
    LLVMFuzzerTestOneInput(data, size);
}

int main(int argc, char **argv) {
    if (argc > 1 && argv[1][0] != '-') {
        mcst_group("fuzz files");
        for (int which = 1; which < argc; which++)
            if (mcst_case("%s", argv[which])) CHECK(replay(argv[which]), "cannot be read");
        return mcst_finish();
    }
    mcst_start(argc, argv);
    const uint64_t n = (uint64_t)fmax(1000, 1e7 * mcst_scale() / FUNCTIONS);
    mcst_group("fuzz");
    for (int which = 0; which < FUNCTIONS; which++)
        if (mcst_case("%s", which < (int)MCST_NROWS ? mcst_rows[which].name : other_name[which - (int)MCST_NROWS]))
            for (uint64_t i = 0; i < n; i++) replay_number(i * FUNCTIONS + (uint64_t)which);
    return mcst_finish();
}
#endif
