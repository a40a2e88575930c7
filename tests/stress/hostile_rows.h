/* Hostile arguments of every row of the registry, 8 wide and by array, and of the functions that are no row: vectors,
 * Fresnel, MIS, GGX terms, points, random numbers. A part of hostile.c. */
#ifndef HOSTILE_ROWS_H
#define HOSTILE_ROWS_H
#include "hostile_tally.h"

enum { LANES = 8, ARRAY = 1024 };

/* One argument set of one lane: a quarter of the numbers is hostile, the others are valid. */
typedef struct {
    float p[MCST_P], u[2], x[3];
} arguments;

static void make_arguments(const mcst_row *row, uint64_t *state, arguments *a) {
    const uint64_t pick = mcst_mix(state);
    const uint64_t which = mcst_mix(state);
    const float *g = row->grid[pick % row->grid_size];
    const float *o = mcst_incidence[(pick >> 32) % MCST_COUNT(mcst_incidence)];
    const uint64_t mask = which & (which >> 12); /* each bit set in a quarter of the cases */
    a->p[0] = g[0];
    a->p[1] = g[1];
    a->p[2] = 0;
    float r = sqrtf((1 - o[0]) * (1 + o[0]));
    a->p[3] = pick & 0x100000 ? r * 0.6f : -r * 0.8f;
    a->p[4] = pick & 0x100000 ? -r * 0.8f : r * 0.6f;
    a->p[5] = o[0];
    mcst_uniform(state, 1, &a->u[0], &a->u[1]);
    float azimuth;
    mcst_uniform(state, 1, &azimuth, &a->x[2]);
    r = sqrtf((1 - a->x[2]) * (1 + a->x[2]));
    a->x[0] = r * (2 * azimuth - 1);
    a->x[1] = r * 2 * sqrtf(azimuth * (1 - azimuth));
    if (!row->has_wo) {
        a->p[3] = a->p[4] = 0;
        a->p[5] = 1;
    }
    for (int i = 0; i < 11; i++) {
        float *slot = i < 6 ? &a->p[i] : i < 8 ? &a->u[i - 6] : &a->x[i - 8];
        if (i == 2 || (i < 6 && i >= row->params && !(row->has_wo && i >= 3))) continue;
        if (mask >> i & 1) *slot = st_hostile(mcst_mix(state));
    }
}

/* By the header: 1 bad, 0 good, -1 open. */
static int worse(int a, int b) { return a == 1 || b == 1 ? 1 : a ? a : b; }
static int setting_bad(const mcst_row *row, const float *p) {
    int bad = 0;
    for (int i = 0; i < row->params; i++) bad = worse(bad, st_parameter_bad(row, i, p[i]));
    if (mcst_bad_together(row, p)) bad = 1;
    if (row->has_wo) bad = worse(bad, st_above_bad(p[3], p[4], p[5]));
    return bad;
}
static int u_bad(const mcst_row *row, const float *u) {
    return !(u[0] >= 0 && u[0] < 1) || (row->inputs > 1 && !(u[1] >= 0 && u[1] < 1));
}
static int point_bad(const mcst_row *row, const float *x) {
    if (row->dim < 3) return isnan(x[0]) || (row->dim > 1 && isnan(x[1]));
    if (row->traits & MCST_WHOLE) return st_direction_bad(x[0], x[1], x[2]);
    return st_above_bad(x[0], x[1], x[2]);
}

#define SHOWN                                                                                                        \
    "p %a %a, wo %a %a %a, u %a %a, x %a %a %a", (double)a->p[0], (double)a->p[1], (double)a->p[3], (double)a->p[4], \
        (double)a->p[5], (double)a->u[0], (double)a->u[1], (double)a->x[0], (double)a->x[1], (double)a->x[2]

/* s: x, y, z, pdf, weight of a sample. */
static void check_sample(const mcst_row *row, tally *t, const arguments *a, int bad, const float s[5]) {
    int sound = 1;
    for (int i = 0; i < row->dim; i++) sound &= finite(t, s[i]);
    sound &= proper(t, s[3]) & proper(t, s[4]);
    CHECK(sound, SHOWN);
    if (row->dim == 3) {
        /* 4 ulp; a mirrored direction is as long as wo, and as exact; bad ones count as +z */
        const double l2 = (double)s[0] * (double)s[0] + (double)s[1] * (double)s[1] + (double)s[2] * (double)s[2];
        const double o2 =
            (double)a->p[3] * (double)a->p[3] + (double)a->p[4] * (double)a->p[4] + (double)a->p[5] * (double)a->p[5];
        const double off =
            row->shape != MCST_IS_BRDF || st_above_bad(a->p[3], a->p[4], a->p[5]) == 1 ? 0 : fabs(sqrt(o2) - 1);
        const int due = off <= 0x1p-22;
        const int unit = fabs(sqrt(l2) - 1) <= 4 * 0x1p-24 + off;
        t->not_unit += due && !unit;
        CHECK(!due || unit, SHOWN);
    }
    if (bad == 1 || !(s[3] > 0)) {
        const int discarded = s[3] == 0 && s[4] == 0;
        t->not_discarded += !discarded;
        CHECK(discarded, SHOWN);
    }
}

static void check_value(tally *t, const arguments *a, int bad, float v) {
    CHECK(proper(t, v), SHOWN);
    if (bad == 1) {
        t->not_discarded += v != 0;
        CHECK(v == 0, SHOWN);
    }
}

/* Every function of a row, 8 lanes with arguments of their own. */
static void check_lanes(const mcst_row *row, const mcst_fns *fn, uint64_t seed, long rounds, tally *t) {
    float s[5 * LANES];
    memset(s, 0, sizeof s);
    float p[MCST_P * LANES], u[2 * LANES], x[3 * LANES], v[3][2 * LANES];
    arguments a[LANES];
    for (long k = 0; k < rounds; k++) {
        for (int l = 0; l < LANES; l++) {
            make_arguments(row, &seed, &a[l]);
            for (int i = 0; i < MCST_P; i++) p[i * LANES + l] = a[l].p[i];
            for (int i = 0; i < 2; i++) u[i * LANES + l] = a[l].u[i];
            for (int i = 0; i < 3; i++) x[i * LANES + l] = a[l].x[i];
        }
        fn->sample(p, u, u + LANES, s);
        fn->pdf(p, x, v[0]);
        if (fn->invert) {
            fn->invert(p, x, v[1]);
        } else {
            fn->eval(p, x, v[1]);
            fn->weight(p, x, v[2]);
        }
        for (int l = 0; l < LANES; l++) {
            const int setting = setting_bad(row, a[l].p);
            const int at = worse(setting, point_bad(row, a[l].x));
            float one[5];
            for (int i = 0; i < 5; i++) one[i] = s[i * LANES + l];
            check_sample(row, t, &a[l], u_bad(row, a[l].u) ? 1 : setting, one);
            check_value(t, &a[l], at, v[0][l]);
            if (fn->invert) {
                for (int i = 0; i < row->inputs; i++) {
                    const float back = v[1][i * LANES + l];
                    const int inside = back >= 0 && back < 1;
                    t->nans += isnan(back) != 0;
                    t->outside += !inside;
                    CHECK(inside, "invert%d %a: p %a %a, wo %a %a %a, x %a %a %a", i + 1, (double)back,
                          (double)a[l].p[0], (double)a[l].p[1], (double)a[l].p[3], (double)a[l].p[4], (double)a[l].p[5],
                          (double)a[l].x[0], (double)a[l].x[1], (double)a[l].x[2]);
                }
            } else {
                check_value(t, &a[l], at, v[1][l]);
                check_value(t, &a[l], at, v[2][l]);
            }
        }
    }
    t->evaluations += (double)rounds * LANES * (fn->invert ? 3 : 4);
}

/* The array forms: one setting a call, arrays of any length. */
static void check_arrays(const mcst_row *row, uint64_t seed, long calls, tally *t) {
    static float u[2][ARRAY], x[3][ARRAY], out[5][ARRAY], value[2][ARRAY];
    for (long k = 0; k < calls; k++) {
        const uint64_t z = mcst_mix(&seed);
        const size_t n = z % ARRAY + 1;
        float *const to[5] = {out[0], out[1], out[2], out[3], out[4]};
        arguments all;
        make_arguments(row, &seed, &all);
        arguments one;
        for (size_t i = 0; i < n; i++) {
            for (int j = 0; j < 2; j++) u[j][i] = (z >> (3 * j)) % 4 ? all.u[j] : st_hostile(mcst_mix(&seed));
            for (int j = 0; j < 3; j++) x[j][i] = all.x[j];
            if (i % 4 == 0) make_arguments(row, &seed, &one);
            all.u[0] = one.u[i % 2];
            all.u[1] = one.u[1 - i % 2];
            all.x[0] = one.x[i % 2];
            all.x[1] = one.x[1 - i % 2];
            all.x[2] = one.x[2];
        }
        memset(out, 0, sizeof out);
        row->sample_n(all.p, n, u[0], u[1], to);
        if (row->pdf_n) {
            row->pdf_n(all.p, n, x[0], x[1], x[2], value[0]);
            row->eval_n(all.p, n, x[0], x[1], x[2], value[1]);
        }
        const int setting = setting_bad(row, all.p);
        for (size_t i = 0; i < n; i++) {
            float s[5];
            for (int j = 0; j < 5; j++) s[j] = out[j][i];
            for (int j = 0; j < 2; j++) all.u[j] = u[j][i];
            for (int j = 0; j < 3; j++) all.x[j] = x[j][i];
            check_sample(row, t, &all, u_bad(row, all.u) ? 1 : setting, s);
            if (!row->pdf_n) continue;
            check_value(t, &all, worse(setting, point_bad(row, all.x)), value[0][i]);
            check_value(t, &all, worse(setting, point_bad(row, all.x)), value[1][i]);
        }
        t->evaluations += (double)n * (row->pdf_n ? 3 : 1);
    }
}

/* --- functions that are no row: vectors, Fresnel, MIS, GGX terms, points, random numbers -------------------------- */

static mcs8_f eight(const float *v) {
    mcs8_f r;
    memcpy(&r, v, sizeof r);
    return r;
}
static mcs8_vec3 eight3(float v[][LANES]) {
    mcs8_vec3 r;
    r.x = eight(v[0]);
    r.y = eight(v[1]);
    r.z = eight(v[2]);
    return r;
}
static double dot(float a[3][LANES], float b[3][LANES], int l) {
    return (double)a[0][l] * (double)b[0][l] + (double)a[1][l] * (double)b[1][l] + (double)a[2][l] * (double)b[2][l];
}
static void put(float out[3][LANES], mcs8_vec3 v) {
    memcpy(out[0], &v.x, sizeof v.x);
    memcpy(out[1], &v.y, sizeof v.y);
    memcpy(out[2], &v.z, sizeof v.z);
}

enum {
    COS_D,
    SCHLICK,
    BALANCE,
    POWER_,
    MIX,
    REFLECT_PDF,
    GGX_D,
    GGX_G1,
    GGX_G2,
    FROM_SIN2,
    DIELECTRIC,
    CONDUCTOR,
    ALBEDO,
    MEAN_ALBEDO,
    COMPENSATION,
    GLASS_PDF,
    GLASS_EVAL,
    GLASS_WEIGHT,
    GLASS_SAMPLE_PDF,
    GLASS_SAMPLE_WEIGHT,
    VALUES
};
static const float value_top[VALUES] = {2, 1, 1, 1, FLT_MAX, FLT_MAX, FLT_MAX, 1, 1,       1,
                                        1, 1, 1, 1, FLT_MAX, FLT_MAX, FLT_MAX, 1, FLT_MAX, 1};
static const char *const value_name[VALUES] = {"cos_d",
                                               "schlick",
                                               "mis_balance",
                                               "mis_power",
                                               "mix_pdf",
                                               "reflect_pdf",
                                               "ggx_d",
                                               "ggx_g1",
                                               "ggx_g2",
                                               "cone_from_sin2",
                                               "dielectric",
                                               "conductor",
                                               "albedo",
                                               "mean_albedo",
                                               "compensation",
                                               "glass_pdf",
                                               "glass_eval",
                                               "glass_weight",
                                               "glass_sample, pdf",
                                               "glass_sample, weight"};

/* in: arguments as in `arguments`, in order; out: the frame, two turned directions, the mirrored one, the half-vector,
 * the refracted one, the frame of a tangent, one that glass draws. */
enum { VECTORS = 12 };
static void check_lane_of_vectors(float in[11][LANES], float out[VECTORS][3][LANES], float value[VALUES][LANES], int l,
                                  tally *t) {
    const double n2 = dot(out[2], out[2], l);
    int sound = 1;
    for (int i = 0; i < VECTORS; i++)
        for (int j = 0; j < 3; j++) sound &= finite(t, out[i][j][l]);
    CHECK(sound, "frame, reflect or half of %a %a %a and %a %a %a", (double)in[3][l], (double)in[4][l],
          (double)in[5][l], (double)in[8][l], (double)in[9][l], (double)in[10][l]);
    /* a frame is as orthonormal as n is unit: to 4 ulp beyond that */
    for (int i = 0; i < 6; i++) {
        float(*const frame)[3][LANES] = i < 3 ? out : out + 8;
        const double l2 = dot(frame[i % 3], frame[i % 3], l);
        const double across = dot(frame[i % 3], frame[(i + 1) % 3], l);
        const int due = fabs(n2 - 1) <= 0x1p-22;
        const int unit = fabs(sqrt(l2) - 1) <= 4 * 0x1p-23 && fabs(across) <= 4 * 0x1p-23;
        t->not_unit += due && !unit;
        CHECK(!due || unit, "frame of %a %a %a: length %.9g, across %.3g", (double)in[3][l], (double)in[4][l],
              (double)in[5][l], sqrt(l2), across);
    }
    sound = fabs(sqrt(dot(out[6], out[6], l)) - 1) <= 4 * 0x1p-24;
    t->not_unit += !sound;
    CHECK(sound, "half of %a %a %a and %a %a %a", (double)in[3][l], (double)in[4][l], (double)in[5][l],
          (double)in[8][l], (double)in[9][l], (double)in[10][l]);
    for (int i = 0; i < VALUES; i++) {
        const float top = value_top[i] * (value_top[i] < 3 ? 1.000001f : 1);
        sound = proper(t, value[i][l]) && value[i][l] <= top;
        t->outside += value[i][l] > top;
        CHECK(sound, "%s = %a: in %a %a %a %a %a %a %a %a %a %a %a", value_name[i], (double)value[i][l],
              (double)in[0][l], (double)in[1][l], (double)in[2][l], (double)in[3][l], (double)in[4][l],
              (double)in[5][l], (double)in[6][l], (double)in[7][l], (double)in[8][l], (double)in[9][l],
              (double)in[10][l]);
    }
}

static void check_vectors(uint64_t seed, long rounds, tally *t) {
    const mcst_row *row = mcst_find("ggx");
    float in[11][LANES], out[VECTORS][3][LANES];
    for (long k = 0; k < rounds; k++) {
        for (int l = 0; l < LANES; l++) {
            arguments a;
            make_arguments(row, &seed, &a);
            for (int i = 0; i < 11; i++) in[i][l] = i < 6 ? a.p[i] : i < 8 ? a.u[i - 6] : a.x[i - 8];
        }
        const mcs8_vec3 v = eight3(in + 3);
        const mcs8_vec3 w = eight3(in + 8);
        mcs8_ggx m = mcs8_ggx_make(eight(in[0]), eight(in[1]));
        mcs8_frame f = mcs8_frame_make(v);
        put(out[0], f.s);
        put(out[1], f.t);
        put(out[2], f.n);
        put(out[3], mcs8_to_world(&f, w));
        put(out[4], mcs8_to_local(&f, w));
        put(out[5], mcs8_reflect(v, w));
        put(out[6], mcs8_half(v, w));
        put(out[7], mcs8_refract(v, w, eight(in[0])));
        f = mcs8_frame_from_tangent(v, w);
        put(out[8], f.s);
        put(out[9], f.t);
        put(out[10], f.n);
        mcs8_f r[VALUES];
        r[COS_D] = mcs8_cos_d(v, w);
        r[SCHLICK] = mcs8_schlick(eight(in[6]), eight(in[10]));
        r[BALANCE] = mcs8_mis_balance(eight(in[6]), eight(in[7]));
        r[POWER_] = mcs8_mis_power(eight(in[6]), eight(in[7]));
        r[MIX] = mcs8_mix_pdf(eight(in[6]), eight(in[7]), eight(in[8]));
        r[REFLECT_PDF] = mcs8_reflect_pdf(eight(in[6]), eight(in[9]));
        r[GGX_D] = mcs8_ggx_d(&m, w);
        r[GGX_G1] = mcs8_ggx_g1(&m, w);
        r[GGX_G2] = mcs8_ggx_g2(&m, v, w);
        r[FROM_SIN2] = mcs8_cone_from_sin2(eight(in[7]));
        r[DIELECTRIC] = mcs8_fresnel_dielectric(eight(in[10]), eight(in[0]));
        r[CONDUCTOR] = mcs8_fresnel_conductor(eight(in[10]), eight(in[0]), eight(in[1]));
        r[ALBEDO] = mcs8_ggx_albedo(&m, w);
        r[MEAN_ALBEDO] = mcs8_ggx_mean_albedo(&m);
        r[COMPENSATION] = mcs8_ggx_compensation(&m, v, w);
        r[GLASS_PDF] = mcs8_ggx_glass_pdf(&m, eight(in[6]), v, w);
        r[GLASS_EVAL] = mcs8_ggx_glass_eval(&m, eight(in[7]), v, w);
        r[GLASS_WEIGHT] = mcs8_ggx_glass_weight(&m, eight(in[6]), v, w);
        const mcs8_brdf s = mcs8_ggx_glass_sample(&m, eight(in[0]), v, eight(in[6]), eight(in[7]), eight(in[10]));
        r[GLASS_SAMPLE_PDF] = s.pdf;
        r[GLASS_SAMPLE_WEIGHT] = s.weight;
        put(out[11], s.wi);
        float value[VALUES][LANES];
        memcpy(value, r, sizeof value);
        for (int l = 0; l < LANES; l++) check_lane_of_vectors(in, out, value, l, t);
    }
    t->evaluations += (double)rounds * LANES * (VECTORS - 2 + VALUES);
}

static void check_numbers(uint64_t seed, long rounds, tally *t) {
    static float out[ARRAY];
    for (long k = 0; k < rounds; k++) {
        const uint64_t z = mcst_mix(&seed);
        const uint64_t y = mcst_mix(&seed);
        const uint32_t a = (uint32_t)z >> (z >> 59);
        const uint32_t b = (uint32_t)y >> (y >> 59);
        const uint32_t c = (uint32_t)(y >> 32);
        const uint32_t d = (uint32_t)(z >> 32);
        const mcs_vec2 s = mcs_stratified(c, a, b, d);
        const mcs_vec2 r = mcs_r2(c, d);
        mcs_pcg32 g = mcs_pcg32_make(z, y);
        float v[9];
        v[0] = s.x;
        v[1] = s.y;
        v[2] = r.x;
        v[3] = r.y;
        v[4] = mcs_latin(c, a, b, d);
        v[5] = mcs_sobol(c, a, d);
        v[6] = mcs_u01(c);
        v[7] = mcs_u01_open(c);
        mcs_pcg32_advance(&g, z ^ y);
        v[8] = mcs_pcg32_float(&g);
        for (size_t i = 0; i < 9; i++)
            CHECK(below_one(t, v[i]), "function %d: %a for %u %u %u %u", (int)i, (double)v[i], (unsigned)c, (unsigned)a,
                  (unsigned)b, (unsigned)d);
        CHECK(v[7] > 0, "u01_open of %u is 0", (unsigned)c);
        if (k % 64 == 0) {
            const size_t n = z % ARRAY + 1;
            for (int which = 0; which < 3; which++) {
                if (which == 0) mcs_philox_fill_n(z, y, n, out);
                else if (which == 1) mcs_sobol_n(c, a, d, n, out);
                else mcs_pcg32_fill_n(&g, n, out);
                for (size_t i = 0; i < n; i++) CHECK(below_one(t, out[i]), "array %d: %a", which, (double)out[i]);
                t->evaluations += (double)n;
            }
        }
        t->evaluations += 9;
    }
}

static void test_rows(double scale) {
    const long rounds = (long)fmax(1000, 1.5e6 * scale);
    const long calls = (long)fmax(20, 1e4 * scale);
    for (size_t i = 0; i < MCST_NROWS; i++) {
        const mcst_row *row = &mcst_rows[i];
        tally t = nothing;
        mcst_group(row->name);
        if (row->fn[2].sample && mcst_case("eight lanes"))
            check_lanes(row, &row->fn[2], mcst_seed_for(row->name, "lanes", 0), rounds, &t);
        if (mcst_case("arrays")) check_arrays(row, mcst_seed_for(row->name, "arrays", 0), calls, &t);
        mcst_close_case();
        if (t.evaluations > 0) print_tally(row->name, &t);
    }
    mcst_group("vectors");
    if (mcst_case("frame, reflection, Fresnel, MIS, GGX terms")) {
        tally t = nothing;
        check_vectors(mcst_seed_for("vectors", "lanes", 0), rounds, &t);
        print_tally("vectors", &t);
    }
    mcst_group("numbers");
    if (mcst_case("random numbers and points")) {
        tally t = nothing;
        check_numbers(mcst_seed_for("numbers", "", 0), 2 * rounds, &t);
        print_tally("numbers", &t);
    }
}
#endif
