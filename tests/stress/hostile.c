/* Hostile input: any bit pattern as any argument of every function, mixed with valid arguments so that each check behind another
 * one is reached. Asserted: every result is finite; densities, weights, values and inverses are in range; directions are unit; bad
 * input by the header's rules has density and weight 0. Then tables of random sizes from random numbers, in memory of exactly the
 * size that was asked for, between guards.
 *
 * At full scale (MCS_TEST_SCALE=1) more than 1e9 evaluations; a part is picked with --filter. */
#include "stress.h"
#define MCST_W 8
#include "adapters.h"

enum { LANES = 8, ARRAY = 1024 };

/* The functions of each row, 8 wide. */
#define ST_FNS_LINE(row) MCST_FNS_UV(mcst8_, row)
#define ST_FNS_PLANE(row) MCST_FNS_UV(mcst8_, row)
#define ST_FNS_DIR(row) MCST_FNS_UV(mcst8_, row)
#define ST_FNS_LOBE(row) MCST_FNS_UV(mcst8_, row)
#define ST_FNS_VLOBE(row) MCST_FNS_UV(mcst8_, row)
#define ST_FNS_BRDF(row) MCST_FNS_BRDF(mcst8_, row)
#define ST_FNS(shape, row, fn, arg, base, coord, grid) ST_FNS_##shape(row),
static const mcst_fns wide[] = {MCST_ROWS(ST_FNS)};

/* What was counted, for the table. */
typedef struct {
    double evaluations, nans, infinities, negative, not_unit, not_discarded, outside;
} tally;
static double all_evaluations;

static int proper(tally *t, float v) { /* finite and not negative */
    t->nans += isnan(v) != 0;
    t->infinities += isinf(v) != 0;
    t->negative += v < 0;
    return v >= 0 && v <= FLT_MAX;
}
static int finite(tally *t, float v) {
    t->nans += isnan(v) != 0;
    t->infinities += isinf(v) != 0;
    return fabsf(v) <= FLT_MAX;
}

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
    if (row->coord == MCST_UNIT && p[0] == 0 && p[1] == 0) bad = 1;
    if (row->has_wo) bad = worse(bad, st_above_bad(p[3], p[4], p[5]));
    return bad;
}
static int u_bad(const mcst_row *row, const float *u) {
    return !(u[0] >= 0 && u[0] < 1) || (row->inputs > 1 && !(u[1] >= 0 && u[1] < 1));
}
static int point_bad(const mcst_row *row, const float *x) {
    if (row->dim < 3) return isnan(x[0]) || (row->dim > 1 && isnan(x[1]));
    if (row->coord == MCST_SPHERE || row->coord == MCST_CONE) return st_direction_bad(x[0], x[1], x[2]);
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
        const double o2 = (double)a->p[3] * (double)a->p[3] + (double)a->p[4] * (double)a->p[4] + (double)a->p[5] * (double)a->p[5];
        const double off = row->shape != MCST_IS_BRDF || st_above_bad(a->p[3], a->p[4], a->p[5]) == 1 ? 0 : fabs(sqrt(o2) - 1);
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

static void print_head(void) {
    mcst_note("%-22s %12s %5s %5s %9s %9s %14s %9s\n", "", "evaluations", "NaN", "inf", "negative", "not unit", "not discarded",
              "range");
}
static void print_tally(const char *name, const tally *t) {
    mcst_note("%-22s %12.0f %5.0f %5.0f %9.0f %9.0f %14.0f %9.0f\n", name, t->evaluations, t->nans, t->infinities, t->negative,
              t->not_unit, t->not_discarded, t->outside);
    all_evaluations += t->evaluations;
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
                    CHECK(inside, "invert%d %a: p %a %a, wo %a %a %a, x %a %a %a", i + 1, (double)back, (double)a[l].p[0],
                          (double)a[l].p[1], (double)a[l].p[3], (double)a[l].p[4], (double)a[l].p[5], (double)a[l].x[0],
                          (double)a[l].x[1], (double)a[l].x[2]);
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

/* --- functions that are no row: vectors, Fresnel, MIS, GGX terms, points, random numbers ------------------------------------ */

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

enum { COS_D, SCHLICK, BALANCE, POWER_, MIX, REFLECT_PDF, GGX_D, GGX_G1, GGX_G2, FROM_SIN2, VALUES };
static const float value_top[VALUES] = {2, 1, 1, 1, FLT_MAX, FLT_MAX, FLT_MAX, 1, 1, 1};
static const char *const value_name[VALUES] = {"cos_d",       "schlick", "mis_balance", "mis_power", "mix_pdf",
                                               "reflect_pdf", "ggx_d",   "ggx_g1",      "ggx_g2",    "cone_from_sin2"};

static void check_vectors(uint64_t seed, long rounds, tally *t) {
    const mcst_row *row = mcst_find("ggx");
    float in[11][LANES], out[7][3][LANES];
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
        float value[VALUES][LANES]; /* arguments as in `arguments`, in order */
        memcpy(value, r, sizeof value);
        for (int l = 0; l < LANES; l++) {
            const double n2 = dot(out[2], out[2], l);
            int sound = 1;
            for (int i = 0; i < 7; i++)
                for (int j = 0; j < 3; j++) sound &= finite(t, out[i][j][l]);
            CHECK(sound, "frame, reflect or half of %a %a %a and %a %a %a", (double)in[3][l], (double)in[4][l], (double)in[5][l],
                  (double)in[8][l], (double)in[9][l], (double)in[10][l]);
            /* a frame is as orthonormal as n is unit: to 4 ulp beyond that */
            for (int i = 0; i < 3; i++) {
                const double l2 = dot(out[i], out[i], l);
                const double across = dot(out[i], out[(i + 1) % 3], l);
                const int due = fabs(n2 - 1) <= 0x1p-22;
                const int unit = fabs(sqrt(l2) - 1) <= 4 * 0x1p-23 && fabs(across) <= 4 * 0x1p-23;
                t->not_unit += due && !unit;
                CHECK(!due || unit, "frame of %a %a %a: length %.9g, across %.3g", (double)in[3][l], (double)in[4][l],
                      (double)in[5][l], sqrt(l2), across);
            }
            sound = fabs(sqrt(dot(out[6], out[6], l)) - 1) <= 4 * 0x1p-24;
            t->not_unit += !sound;
            CHECK(sound, "half of %a %a %a and %a %a %a", (double)in[3][l], (double)in[4][l], (double)in[5][l], (double)in[8][l],
                  (double)in[9][l], (double)in[10][l]);
            for (int i = 0; i < VALUES; i++) {
                const float top = value_top[i] * (value_top[i] < 3 ? 1.000001f : 1);
                sound = proper(t, value[i][l]) && value[i][l] <= top;
                t->outside += value[i][l] > top;
                CHECK(sound, "%s = %a: in %a %a %a %a %a %a %a %a %a %a %a", value_name[i], (double)value[i][l], (double)in[0][l],
                      (double)in[1][l], (double)in[2][l], (double)in[3][l], (double)in[4][l], (double)in[5][l], (double)in[6][l],
                      (double)in[7][l], (double)in[8][l], (double)in[9][l], (double)in[10][l]);
            }
        }
    }
    t->evaluations += (double)rounds * LANES * (7 + VALUES);
}

static int below_one(tally *t, float v) {
    const int inside = v >= 0 && v < 1;
    t->nans += isnan(v) != 0;
    t->outside += !inside;
    return inside;
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

/* --- tables ----------------------------------------------------------------------------------------------------------------- */

enum { PWC, DISCRETE, PWL, ALIAS, FROM_FUNCTION, KINDS };
static const char *const kind_name[KINDS] = {"pwc", "discrete", "pwl", "alias", "pwc of a function"};

static size_t table_bytes(int kind, uint32_t n) {
    return kind == PWL ? mcs_pwl_bytes(n) : kind == ALIAS ? mcs_alias_bytes(n) : mcs_pwc_bytes(n);
}
static float next_of(float x, void *context) { /* a function whose values are the entries of a list, whatever x is */
    uint64_t *state = (uint64_t *)context;
    (void)x;
    return st_hostile(mcst_mix(state));
}
static mcs_status table_build(int kind, arena *m, size_t bytes, const float *f, uint32_t n, uint64_t *state) {
    void *at = m->at;
    if (kind == FROM_FUNCTION) return (mcs_status)mcs_pwc_build_fn((mcs_pwc *)at, bytes, f ? next_of : NULL, state, n);
    if (kind == PWL) return (mcs_status)mcs_pwl_build((mcs_pwl *)at, bytes, f, n);
    if (kind == ALIAS) return (mcs_status)mcs_alias_build((mcs_alias *)at, bytes, f, n);
    return (mcs_status)mcs_pwc_build((mcs_pwc *)at, bytes, f, n);
}

/* What a bad entry or channel is to the header: +infinity FLT_MAX, anything else 0. */
static float counted_as(float x) { return x > FLT_MAX ? FLT_MAX : x > 0 ? x : 0; }

/* Entries of one of six styles, zeros among them; how many of them are bad and the sum of all as they count come back. */
static void make_entries(float *f, uint32_t n, uint64_t *state, uint32_t *bad, long double *sum, uint32_t *some) {
    const uint64_t style = mcst_mix(state) % 6;
    const uint64_t giant = mcst_mix(state) % n;
    *bad = *some = 0;
    *sum = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint64_t z = mcst_mix(state);
        switch (style) {
        case 0: f[i] = st_hostile(z); break;
        case 1: f[i] = z & 7 ? (float)(z >> 40) : st_hostile(z >> 3); break;
        case 2: f[i] = 0; break;
        case 3: f[i] = i == giant ? 1e30f : 0; break;
        case 4: f[i] = st_float((uint32_t)(z >> 32) & 0x007fffffu); break;
        default: f[i] = z & 1 ? FLT_MAX : 0x1p-149f; break;
        }
        *bad += !(f[i] >= 0 && f[i] <= FLT_MAX);
        *sum += (long double)counted_as(f[i]);
        *some += f[i] > 0;
    }
}
static int lit(const float *f, uint32_t i) { return f[i] > 0; }

static void check_draws(int kind, const arena *m, const float *f, uint32_t n, int uniform, uint64_t *state, tally *t) {
    const mcs_pwc *pwc = (const mcs_pwc *)(const void *)m->at;
    const mcs_pwl *pwl = (const mcs_pwl *)(const void *)m->at;
    const mcs_alias *alias = (const mcs_alias *)(const void *)m->at;
    for (int k = 0; k < 400; k++) {
        const uint64_t z = mcst_mix(state);
        float u = z & 3 ? (float)(z >> 40) * 0x1p-24f : st_hostile(z >> 2);
        const int good = u >= 0 && u < 1;
        uint32_t i;
        float x, pdf, back;
        if (kind == DISCRETE || kind == ALIAS) {
            const mcs_pick c = kind == ALIAS ? mcs_alias_sample(alias, u) : mcs_discrete_sample(pwc, u);
            x = c.u;
            pdf = c.pmf;
            i = c.i;
            CHECK(proper(t, pdf) && pdf <= 1, "%u entries, u %a: pmf %a", (unsigned)n, (double)u, (double)pdf);
            CHECK(i < n, "%u entries, u %a: entry %u", (unsigned)n, (double)u, (unsigned)i);
            CHECK(!good || pdf == (kind == ALIAS ? mcs_alias_pmf(alias, i) : mcs_discrete_pmf(pwc, i)), "u %a: pmf %a", (double)u,
                  (double)pdf);
            back = x;
            (void)proper(t, kind == ALIAS ? mcs_alias_pmf(alias, (uint32_t)(z >> 16)) : mcs_discrete_pmf(pwc, (uint32_t)(z >> 16)));
        } else {
            const mcs_cell c = kind == PWL ? mcs_pwl_sample(pwl, u) : mcs_pwc_sample(pwc, u);
            const float at = kind == PWL ? mcs_pwl_pdf(pwl, c.x) : mcs_pwc_pdf(pwc, c.x);
            x = c.x;
            pdf = c.pdf;
            i = c.i;
            CHECK(proper(t, pdf), "%u cells, u %a: pdf %a", (unsigned)n, (double)u, (double)pdf);
            CHECK(i < n && (double)x * n >= i && (double)x * n < (double)i + 1, "%u cells, u %a: x %a in cell %u", (unsigned)n,
                  (double)u, (double)x, (unsigned)i);
            CHECK(!good || kind == PWL || pdf == at, "u %a: pdf %a, %a at x", (double)u, (double)pdf, (double)at);
            u = z & 4 ? st_hostile(z >> 3) : x;
            back = kind == PWL ? mcs_pwl_invert(pwl, u) : mcs_pwc_invert(pwc, u);
            CHECK(proper(t, kind == PWL ? mcs_pwl_pdf(pwl, u) : mcs_pwc_pdf(pwc, u)), "pdf at %a", (double)u);
        }
        CHECK(below_one(t, x) && below_one(t, back), "%u cells: x or rest %a, invert %a", (unsigned)n, (double)x, (double)back);
        if (!good) CHECK(pdf == 0, "u %a is bad, but density %a", (double)u, (double)pdf);
        else if (f && !uniform)
            CHECK(kind == PWL ? lit(f, i) || lit(f, i + 1) : lit(f, i), "entry %u is zero, but drawn", (unsigned)i);
        if (good && kind != PWL) CHECK(pdf > 0, "u %a: density 0 at its own sample", (double)u);
    }
    t->evaluations += 400 * 3;
}

static void check_table(int kind, uint32_t n, uint64_t *state, tally *t) {
    const uint32_t entries = n + (kind == PWL);
    const size_t bytes = table_bytes(kind, n);
    arena source = arena_make(entries * sizeof(float));
    arena copy = arena_make(source.bytes);
    arena m = arena_make(bytes);
    float *f = (float *)(void *)source.at;
    uint32_t bad, some;
    long double sum;
    make_entries(f, entries, state, &bad, &sum, &some);
    memcpy(copy.at, source.at, source.bytes);
    mcs_status e = table_build(kind, &m, bytes - 1, f, n, state);
    CHECK(e == MCS_ERR_MEMORY && untouched(m.at, bytes), "%u entries, a byte too few: %d", (unsigned)n, (int)e);
    e = table_build(kind, &m, bytes, NULL, n, state);
    CHECK(e == MCS_ERR_ARG && untouched(m.at, bytes), "no entries: %d", (int)e);
    e = table_build(kind, &m, bytes, f, 0, state);
    CHECK(e == MCS_ERR_SIZE && untouched(m.at, bytes), "0 entries: %d", (int)e);
    e = table_build(kind, &m, bytes, f, n, state);
    CHECK(arena_intact(&m) && arena_intact(&source) && !memcmp(copy.at, source.at, source.bytes), "%u entries: written outside",
          (unsigned)n);
    if (kind == FROM_FUNCTION) {
        CHECK(e == MCS_OK || e == MCS_UNIFORM, "%u entries: status %d", (unsigned)n, (int)e);
        check_draws(PWC, &m, NULL, n, 1, state, t);
    } else {
        const mcs_pwc *head = (const mcs_pwc *)(const void *)m.at;
        const mcs_alias *alias = (const mcs_alias *)(const void *)m.at;
        const double total = kind == ALIAS ? alias->total : head->total;
        const uint32_t counted = kind == ALIAS ? alias->bad : head->bad;
        /* of vertices the sum over cells of the means; n additions round, each by 2^-53 of the sum */
        const long double ends = kind == PWL ? (long double)counted_as(f[0]) + (long double)counted_as(f[n]) : 0;
        const long double want = sum - 0.5L * ends;
        CHECK(e == (some ? MCS_OK : MCS_UNIFORM), "%u entries, %u not zero: status %d", (unsigned)n, (unsigned)some, (int)e);
        CHECK(counted == bad, "%u bad entries, counted %u", (unsigned)bad, (unsigned)counted);
        CHECK(fabsl((long double)total - want) <= (long double)n * 0x1p-53L * want, "total %g, sum %Lg", total, want);
        check_draws(kind, &m, f, n, e == MCS_UNIFORM, state, t);
        if (kind == DISCRETE || kind == ALIAS) {
            double all = 0;
            for (uint32_t i = 0; i < n; i++) {
                const float q = kind == ALIAS ? mcs_alias_pmf(alias, i) : mcs_discrete_pmf(head, i);
                CHECK((q > 0) == (e == MCS_UNIFORM || lit(f, i)), "entry %u of %u, weight %a: probability %a", (unsigned)i,
                      (unsigned)n, (double)f[i], (double)q);
                all += (double)q;
            }
            t->evaluations += n;
            CHECK(fabs(all - 1) <= 0x1p-24, "probabilities add up to 1 + %g", all - 1); /* each rounded to 24 digits */
        } else {                                                                        /* arrays with exactly n places; in place */
            const size_t count = mcst_mix(state) % 70;
            arena u = arena_make(count * sizeof(float));
            arena x = arena_make(u.bytes);
            arena pdf = arena_make(u.bytes);
            float *in = (float *)(void *)u.at;
            float *ox = (float *)(void *)x.at;
            float *op = (float *)(void *)pdf.at;
            for (uint32_t i = 0; i < count; i++)
                in[i] = i & 3 ? (float)(mcst_mix(state) >> 40) * 0x1p-24f : st_hostile(mcst_mix(state));
            if (kind == PWL) mcs_pwl_sample_n((const mcs_pwl *)(const void *)m.at, count, in, ox, op);
            else mcs_pwc_sample_n(head, count, in, ox, op);
            for (uint32_t i = 0; i < count; i++)
                CHECK(below_one(t, ox[i]) && proper(t, op[i]), "u %a: %a %a", (double)in[i], (double)ox[i], (double)op[i]);
            if (kind == PWL) mcs_pwl_sample_n((const mcs_pwl *)(const void *)m.at, count, in, in, NULL);
            else mcs_pwc_sample_n(head, count, in, in, NULL);
            CHECK(!memcmp(u.at, x.at, u.bytes), "in place is different");
            CHECK(arena_intact(&u) && arena_intact(&x) && arena_intact(&pdf), "arrays of %u: written outside", (unsigned)count);
            t->evaluations += (double)count * 2;
            arena_free(&u);
            arena_free(&x);
            arena_free(&pdf);
        }
    }
    CHECK(arena_intact(&m) && arena_intact(&source), "%u entries: written outside while drawing", (unsigned)n);
    arena_free(&source);
    arena_free(&copy);
    arena_free(&m);
}

/* --- environment maps and products ------------------------------------------------------------------------------------------ */

/* An image in memory of exactly its span; `bad` of its texels are bad. Guards and gaps between texels would be bad, too. */
typedef struct {
    arena m;
    mcs_image im;
    uint32_t bad;
} picture;

static const float *texel_at(const mcs_image *im, uint32_t x, uint32_t y) {
    const ptrdiff_t step = im->pixel_stride ? im->pixel_stride : (ptrdiff_t)im->channels;
    return im->pixels + (ptrdiff_t)y * (im->row_stride ? im->row_stride : step * (ptrdiff_t)im->w) + (ptrdiff_t)x * step;
}
static double luminance(const mcs_image *im, uint32_t x, uint32_t y, int *bad) {
    const float *p = texel_at(im, x, y);
    const int n = im->channels > 1 ? 3 : 1;
    double c[3];
    int i;
    for (*bad = i = 0; i < n; i++) {
        *bad |= !(p[i] >= 0 && p[i] <= FLT_MAX);
        c[i] = (double)counted_as(p[i]);
    }
    return n == 1 ? c[0] : 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}
/* Weight of a texel: 1 lit, 0 black, -1 where rounding decides. Of a weight that is a sum of up to 27 floats each step rounds by
 * 2^-24 of it or, where it is subnormal, by 2^-150. */
static int texel_lit(const mcs_image *im, uint32_t x, uint32_t y) {
    const double floor = im->floor > 0 ? (double)im->floor : 0;
    double v = 0;
    int bad;
    if (im->bilinear) {
        for (int i = -1; i <= 1; i++)
            for (int j = -1; j <= 1; j++) {
                const uint32_t row = i < 0 && y > 0 ? y - 1 : i > 0 && y + 1 < im->h ? y + 1 : y;
                const uint32_t col = (uint32_t)((int)(x + im->w) + j) % im->w;
                v += (i ? 0.25 : 0.5) * (j ? 0.25 : 0.5) * luminance(im, col, row, &bad);
            }
    } else {
        v = luminance(im, x, y, &bad);
    }
    if (!(v > 0)) return 0;
    if (im->channels == 1 && !im->bilinear && !(floor > 0)) return 1;
    const double slack = 32 * (0x1p-24 * (v + floor) + 0x1p-150);
    return v > floor + slack ? 1 : v < floor - slack || floor > FLT_MAX ? 0 : -1;
}

static picture make_picture(uint64_t *state) {
    const uint64_t z = mcst_mix(state);
    const uint64_t y = mcst_mix(state);
    const uint64_t style = z % 9;
    const uint32_t w = z >> 8 & 7 ? 1 + (uint32_t)(z >> 16) % 70 : 1;
    const uint32_t h = z >> 11 & 7 ? 1 + (uint32_t)(z >> 24) % 40 : 1;
    const uint32_t channels = y & 1 ? 1 : 3 + (uint32_t)(y >> 1) % 3;
    const uint32_t step = channels + (y & 16 ? (uint32_t)(y >> 5) % 3 : 0);
    const uint32_t row = (w - 1) * step + channels + (y & 128 ? (uint32_t)(y >> 8) % 9 : step - channels);
    const size_t count = (size_t)(h - 1) * row + (size_t)(w - 1) * step + channels;
    const size_t giant = mcst_mix(state) % ((size_t)w * h);
    picture p;
    float *f;
    p.m = arena_make(count * sizeof *f);
    p.bad = 0;
    f = (float *)(void *)p.m.at;
    p.im = mcs_image_make(f, w, h, channels);
    p.im.bilinear = (y >> 16 & 1) != 0;
    if (step != channels || y >> 17 & 1) p.im.pixel_stride = (ptrdiff_t)step;
    if (y >> 18 & 1) {
        p.im.row_stride = -(ptrdiff_t)row;
        p.im.pixels = f + (size_t)(h - 1) * row;
    } else if (row != w * step || y >> 19 & 1) {
        p.im.row_stride = (ptrdiff_t)row;
    }
    const float level = mcs_u01((uint32_t)mcst_mix(state));
    for (uint32_t j = 0; j < h; j++)
        for (uint32_t i = 0; i < w; i++) {
            float *at = (float *)(uintptr_t)texel_at(&p.im, i, j);
            const int inside = i >= w / 3 && i <= w / 2 && j >= h / 3 && j <= h / 2;
            for (uint32_t c = 0; c < channels; c++) {
                const uint64_t r = mcst_mix(state);
                const float u = (float)(r >> 40);
                switch (style) {
                case 0: at[c] = st_hostile(r); break;
                case 1: at[c] = r & 31 ? u : st_hostile(r >> 5); break;
                case 2: at[c] = 0; break;
                case 3: at[c] = (size_t)j * w + i == giant ? 1e30f : 0; break;
                case 4: at[c] = st_float((uint32_t)(r >> 32) & 0x007fffffu); break;
                case 5: at[c] = r & 1 ? FLT_MAX : 0x1p-149f; break;
                case 6: at[c] = level; break;
                case 7: at[c] = inside ? u : 0; break;
                default: at[c] = u; break;
                }
            }
            int bad;
            (void)luminance(&p.im, i, j, &bad);
            p.bad += (uint32_t)bad;
        }
    if (y >> 20 & 1) p.im.floor = y >> 21 & 1 ? mcs_env_mean(&p.im) : st_hostile(mcst_mix(state));
    return p;
}

static float hostile_u(uint64_t *state) {
    const uint64_t z = mcst_mix(state);
    return z & 7 ? (float)(z >> 40) * 0x1p-24f : st_hostile(z >> 3);
}
static int good_u(float u) { return u >= 0 && u < 1; }
static mcs_vec3 hostile_direction(uint64_t *state) {
    const float u1 = mcs_u01((uint32_t)mcst_mix(state));
    const float u2 = mcs_u01((uint32_t)mcst_mix(state));
    const uint64_t z = mcst_mix(state);
    mcs_vec3 w = mcs_sphere_sample(u1, u2).w;
    if ((z & 3) == 0) w.x = st_hostile(mcst_mix(state));
    if ((z & 12) == 0) w.y = st_hostile(mcst_mix(state));
    if ((z & 48) == 0) w.z = st_hostile(mcst_mix(state));
    return w;
}

/* What is drawn from: rows and columns of the map, wrapped; which texels may be found out where the picture is at hand. */
typedef struct {
    const mcs_env *e;
    const picture *p; /* NULL: any texel may be drawn */
    uint32_t row, rows, col, cols;
} part_of;

static int in_part(const part_of *q, uint32_t row, uint32_t col) {
    return row >= q->row && row - q->row < q->rows && (col + q->e->w - q->col) % q->e->w < q->cols;
}
/* A draw: `off` is how far the length may be from 1, negative where any finite direction will do. */
static void check_texel(const part_of *q, tally *t, mcs_texel s, int good, double off, const char *what) {
    const double l2 = (double)s.w.x * (double)s.w.x + (double)s.w.y * (double)s.w.y + (double)s.w.z * (double)s.w.z;
    const int sound = finite(t, s.w.x) & finite(t, s.w.y) & finite(t, s.w.z) & proper(t, s.pdf);
    const int unit = off < 0 || fabs(sqrt(l2) - 1) <= off;
    const int inside = s.row < q->e->h && s.col < q->e->w;
    t->not_unit += !unit;
    t->outside += !inside;
    t->not_discarded += !good && s.pdf != 0;
    CHECK(sound && unit && inside, "%s: w %a %a %a, pdf %a, texel %u %u of %u x %u", what, (double)s.w.x, (double)s.w.y,
          (double)s.w.z, (double)s.pdf, (unsigned)s.col, (unsigned)s.row, (unsigned)q->e->w, (unsigned)q->e->h);
    CHECK(good || s.pdf == 0, "%s: u is bad, but density %a", what, (double)s.pdf);
    if (!inside || !(s.pdf > 0)) return;
    CHECK(in_part(q, s.row, s.col), "%s: texel %u %u outside %u + %u, %u + %u", what, (unsigned)s.col, (unsigned)s.row,
          (unsigned)q->col, (unsigned)q->cols, (unsigned)q->row, (unsigned)q->rows);
    CHECK(!q->p || texel_lit(&q->p->im, s.col, s.row), "%s: texel %u %u of %u x %u is black, but drawn", what, (unsigned)s.col,
          (unsigned)s.row, (unsigned)q->e->w, (unsigned)q->e->h);
}

enum { DRAWS = 100 };

/* Draws and densities of a map or, where m is given, of a window; with the axes as frame pdf and texel of a draw are its own. */
static void check_map(const part_of *q, const mcs_env_window *m, int axes, uint64_t *state, tally *t) {
    const mcs_env *e = q->e;
    const size_t count = mcst_mix(state) % 70;
    arena in = arena_make(2 * count * sizeof(float));
    arena out = arena_make(4 * count * sizeof(float));
    float *u = (float *)(void *)in.at;
    float *x = (float *)(void *)out.at;
    float *y = x + count;
    float *z = y + count;
    float *pdf = z + count;
    for (size_t k = 0; k < DRAWS; k++) {
        const float u1 = hostile_u(state);
        const float u2 = hostile_u(state);
        const int bits = !m && k % 4 == 0;
        const int good = bits || (good_u(u1) && good_u(u2));
        const uint32_t b1 = (uint32_t)mcst_mix(state);
        const uint32_t b2 = k % 8 ? (uint32_t)mcst_mix(state) : 0xffffffffu;
        const mcs_texel s = m      ? mcs_env_window_sample(m, e, u1, u2)
                            : bits ? mcs_env_sample_bits(e, b1, b2)
                                   : mcs_env_sample(e, u1, u2);
        const mcs_vec3 w = hostile_direction(state);
        const int bad = st_direction_bad(w.x, w.y, w.z);
        const mcs_texel a = mcs_env_texel(e, w);
        const mcs_texel own = mcs_env_texel(e, s.w);
        const float here = m ? mcs_env_window_pdf(m, e, s.w) : own.pdf;
        const float there = m ? mcs_env_window_pdf(m, e, w) : a.pdf;
        const float weight = mcs_env_weight(e, there);
        const mcs_vec2 back = mcs_env_invert(e, k & 1 ? w : s.w);
        check_texel(q, t, s, good, axes ? st_map_off : -1, m ? "window" : "map");
        CHECK(!good || !axes || s.pdf > 0, "u %a %a: density 0 at its own sample", (double)u1, (double)u2);
        CHECK(!good || !axes || (here == s.pdf && own.row == s.row && own.col == s.col),
              "u %a %a, bits %08x %08x, %u x %u: pdf %a, %a of its direction; texel %u %u, %u %u", (double)u1, (double)u2,
              (unsigned)(bits ? b1 : 0), (unsigned)(bits ? b2 : 0), (unsigned)e->w, (unsigned)e->h, (double)s.pdf, (double)here,
              (unsigned)s.col, (unsigned)s.row, (unsigned)own.col, (unsigned)own.row);
        CHECK(proper(t, here) && proper(t, there) && a.row < e->h && a.col < e->w, "pdf %a and, of %a %a %a, %a", (double)here,
              (double)w.x, (double)w.y, (double)w.z, (double)there);
        CHECK(!axes || bad != 1 || there == 0, "%a %a %a is bad, but density %a", (double)w.x, (double)w.y, (double)w.z,
              (double)there);
        if (axes && bad == 0) {
            const int lit = q->p ? texel_lit(&q->p->im, a.col, a.row) : 1;
            const int due = in_part(q, a.row, a.col) ? lit : 0;
            CHECK(due < 0 || (there > 0) == due, "%a %a %a in texel %u %u, lit %d: pdf %a", (double)w.x, (double)w.y, (double)w.z,
                  (unsigned)a.col, (unsigned)a.row, due, (double)there);
        }
        CHECK(finite(t, weight) && weight >= 0, "weight %a of density %a", (double)weight, (double)there);
        CHECK(below_one(t, back.x) && below_one(t, back.y), "invert %a %a", (double)back.x, (double)back.y);
    }
    for (size_t k = 0; k < 2 * count; k++) u[k] = hostile_u(state);
    if (m) mcs_env_window_sample_n(m, e, count, u, u + count, x, y, z, pdf, NULL, NULL);
    else mcs_env_sample_n(e, count, u, u + count, x, y, z, pdf, NULL, NULL);
    for (size_t k = 0; k < count; k++) {
        const mcs_texel s = m ? mcs_env_window_sample(m, e, u[k], u[count + k]) : mcs_env_sample(e, u[k], u[count + k]);
        CHECK(finite(t, x[k]) && finite(t, y[k]) && finite(t, z[k]) && pdf[k] == s.pdf,
              "array: u %a %a, w %a %a %a, pdf %a, not %a", (double)u[k], (double)u[count + k], (double)x[k], (double)y[k],
              (double)z[k], (double)pdf[k], (double)s.pdf);
        if (mcst_mix(state) & 1) x[k] = st_hostile(mcst_mix(state));
    }
    mcs_env_pdf_n(e, count, x, y, z, pdf);
    for (size_t k = 0; k < count; k++) CHECK(proper(t, pdf[k]), "array: pdf %a", (double)pdf[k]);
    CHECK(arena_intact(&in) && arena_intact(&out), "arrays of %u: written outside", (unsigned)count);
    arena_free(&in);
    arena_free(&out);
    t->evaluations += DRAWS * (m ? 6 : 4) + (double)count * 3;
}

static void check_window(const picture *p, const mcs_env *e, uint64_t *state, tally *t) {
    const uint64_t z = mcst_mix(state);
    const uint64_t wild = mcst_mix(state);
    const uint32_t row = (uint32_t)z % e->h;
    const uint32_t rows = 1 + (uint32_t)(z >> 16) % (e->h - row);
    const uint32_t col = (uint32_t)(z >> 32) % e->w;
    const uint32_t cols = 1 + (uint32_t)(z >> 48) % e->w;
    const size_t bytes = mcs_env_window_bytes(rows);
    arena m = arena_make(bytes);
    mcs_env_window *at = (mcs_env_window *)(void *)m.at;
    int some = 0;
    int none = 1;
    mcs_status s = mcs_env_window_build(at, bytes - 1, e, row, rows, col, cols);
    CHECK(s == MCS_ERR_MEMORY && untouched(m.at, bytes), "%u rows, a byte too few: %d", (unsigned)rows, (int)s);
    s = mcs_env_window_build(at, bytes, e, e->h - row, row + 1 + (uint32_t)wild % 9, col, cols);
    CHECK(s == MCS_ERR_SIZE && untouched(m.at, bytes), "rows beyond the map: %d", (int)s);
    s = mcs_env_window_build(at, bytes, e, row, rows, col, e->w + 1 + (uint32_t)(wild >> 32) / 2);
    CHECK(s == MCS_ERR_SIZE && untouched(m.at, bytes), "columns beyond the map: %d", (int)s);
    s = mcs_env_window_build(at, bytes, e, row, rows, col, cols);
    for (uint32_t i = row; i < row + rows; i++)
        for (uint32_t j = 0; j < cols; j++) {
            const int lit = texel_lit(&p->im, (col + j) % e->w, i);
            some |= lit == 1;
            none &= lit == 0;
        }
    CHECK((!some || s == MCS_OK) && (!none || s == MCS_UNIFORM) && (s == MCS_OK || s == MCS_UNIFORM),
          "window %u + %u, %u + %u of %u x %u: status %d", (unsigned)col, (unsigned)cols, (unsigned)row, (unsigned)rows,
          (unsigned)e->w, (unsigned)e->h, (int)s);
    part_of q;
    q.e = e;
    q.p = s == MCS_UNIFORM ? NULL : p;
    q.row = row;
    q.rows = rows;
    q.col = col;
    q.cols = cols;
    check_map(&q, at, 1, state, t);
    CHECK(arena_intact(&m), "window of %u rows: written outside", (unsigned)rows);
    arena_free(&m);
}

/* A reflection; `sane`: unit directions and a frame to go with them. */
static mcs_reflection make_reflection(uint64_t *state, int *sane) {
    const uint64_t z = mcst_mix(state);
    const float a = mcs_u01((uint32_t)mcst_mix(state));
    const float b = mcs_u01((uint32_t)mcst_mix(state));
    mcs_reflection r;
    r.frame = mcs_frame_make(mcs_sphere_sample(a, b).w);
    r.wo = mcs_hemisphere_sample(b, a).w;
    r.alpha_x = z & 1 ? a : 1e-3f * a;
    r.alpha_y = z & 2 ? b : 1e-3f * b;
    r.matte = z & 4 ? b : (float)(z >> 3 & 1);
    r.profile = (mcs_profile)(z >> 60 & 3);
    *sane = r.wo.z > 0;
    if (z & 16) return r;
    float *slot[15];
    slot[0] = &r.frame.s.x;
    slot[1] = &r.frame.s.y;
    slot[2] = &r.frame.s.z;
    slot[3] = &r.frame.t.x;
    slot[4] = &r.frame.t.y;
    slot[5] = &r.frame.t.z;
    slot[6] = &r.frame.n.x;
    slot[7] = &r.frame.n.y;
    slot[8] = &r.frame.n.z;
    slot[9] = &r.wo.x;
    slot[10] = &r.wo.y;
    slot[11] = &r.wo.z;
    slot[12] = &r.alpha_x;
    slot[13] = &r.alpha_y;
    slot[14] = &r.matte;
    for (int i = 0; i < 15; i++)
        if ((z >> (20 + 2 * i) & (z & 32 ? 3 : 1)) == 0) {
            *slot[i] = st_hostile(mcst_mix(state));
            *sane &= i > 11;
        }
    return r;
}

/* Draws of a product and the one-shot form, of one reflection or of weights. */
static void check_product(const part_of *q, const mcs_tiles *tiles, uint64_t *state, tally *t) {
    /* own lobe: |wi| 4 ulp, a frame that is orthonormal to 4 ulp of 2^-23 in 3 ways, three rounded terms each: 34 2^-24 */
    const double lobe_off = 0x1p-18;
    const size_t bytes = mcs_product_bytes(tiles->rows);
    const size_t n = (size_t)tiles->rows * tiles->cols;
    const size_t count = mcst_mix(state) % 70;
    const int weights = mcst_mix(state) % 4 == 0;
    arena m = arena_make(bytes);
    arena in = arena_make(2 * count * sizeof(float));
    arena out = arena_make(4 * count * sizeof(float));
    arena list = arena_make(n * sizeof(float));
    float *u = (float *)(void *)in.at;
    float *x = (float *)(void *)out.at;
    float *y = x + count;
    float *z = y + count;
    float *pdf = z + count;
    float *weight = (float *)(void *)list.at;
    mcs_product *p = (mcs_product *)(void *)m.at;
    part_of all = *q;
    int sane;
    const mcs_reflection r = make_reflection(state, &sane);
    mcs_status s = mcs_product_build(p, bytes - 1, tiles, q->e, &r);
    CHECK(s == MCS_ERR_MEMORY && untouched(m.at, bytes), "product, a byte too few: %d", (int)s);
    for (size_t k = 0; k < n; k++) {
        const mcs_vec3 w = mcs_tiles_direction(tiles, q->e, (uint32_t)k);
        CHECK(finite(t, w.x) && finite(t, w.y) && finite(t, w.z), "tile %u: direction %a %a %a", (unsigned)k, (double)w.x,
              (double)w.y, (double)w.z);
        weight[k] = st_hostile(mcst_mix(state));
    }
    s = weights ? mcs_product_build_weights(p, bytes, tiles, q->e, weight) : mcs_product_build(p, bytes, tiles, q->e, &r);
    CHECK((s == MCS_OK || s == MCS_UNIFORM) && arena_intact(&m), "product: status %d", (int)s);
    if (mcst_mix(state) % 4 == 0) p->brdf_share = 0; /* as the header allows */
    all.p = NULL;
    for (size_t k = 0; k < DRAWS; k++) {
        const float u1 = hostile_u(state);
        const float u2 = hostile_u(state);
        const int good = good_u(u1) && good_u(u2);
        const int tiled = !(p->brdf_share > 0);
        const mcs_vec3 w = hostile_direction(state);
        const mcs_texel a = mcs_product_sample(p, u1, u2);
        const mcs_texel b = mcs_oneshot_sample(tiles, q->e, &r, u1, u2);
        const float back = mcs_product_pdf(p, a.w);
        const float there = mcs_product_pdf(p, w);
        const float shot_back = mcs_oneshot_pdf(tiles, q->e, &r, b.w);
        const float shot_there = mcs_oneshot_pdf(tiles, q->e, &r, w);
        check_texel(tiled ? q : &all, t, a, good, tiled ? st_map_off : sane ? lobe_off : -1, "product");
        check_texel(&all, t, b, good, sane ? lobe_off : -1, "one-shot");
        CHECK(proper(t, back) && proper(t, there) && proper(t, shot_back) && proper(t, shot_there), "pdf %a %a, %a %a",
              (double)back, (double)there, (double)shot_back, (double)shot_there);
        CHECK(!(a.pdf > 0) || back > 0, "product: pdf %a, 0 of its direction", (double)a.pdf);
        CHECK(!(b.pdf > 0) || shot_back > 0, "one-shot: pdf %a, 0 of its direction", (double)b.pdf);
        if (st_direction_bad(w.x, w.y, w.z) == 1)
            CHECK(there == 0 && shot_there == 0, "%a %a %a is bad, but densities %a, %a", (double)w.x, (double)w.y, (double)w.z,
                  (double)there, (double)shot_there);
    }
    for (size_t k = 0; k < 2 * count; k++) u[k] = hostile_u(state);
    mcs_product_sample_n(p, count, u, u + count, x, y, z, pdf, NULL, NULL);
    for (size_t k = 0; k < count; k++) {
        const mcs_texel one = mcs_product_sample(p, u[k], u[count + k]);
        CHECK(finite(t, x[k]) && finite(t, y[k]) && finite(t, z[k]) && proper(t, pdf[k]), "array: u %a %a, w %a %a %a, pdf %a",
              (double)u[k], (double)u[count + k], (double)x[k], (double)y[k], (double)z[k], (double)pdf[k]);
        CHECK((pdf[k] > 0) == (one.pdf > 0), "array: u %a %a, pdf %a, not %a", (double)u[k], (double)u[count + k], (double)pdf[k],
              (double)one.pdf);
    }
    CHECK(arena_intact(&m) && arena_intact(&in) && arena_intact(&out) && arena_intact(&list), "product: written outside");
    arena_free(&m);
    arena_free(&in);
    arena_free(&out);
    arena_free(&list);
    t->evaluations += DRAWS * 6 + (double)count * 2 + (double)n;
}

static void check_tiles(const part_of *q, uint64_t *state, tally *t) {
    const size_t bytes = mcs_tiles_bytes(q->e, 16);
    arena m = arena_make(bytes);
    mcs_tiles *tiles = (mcs_tiles *)(void *)m.at;
    mcs_status s = mcs_tiles_build(tiles, bytes - 1, q->e, 16);
    CHECK(s == MCS_ERR_MEMORY && untouched(m.at, bytes), "tiles, a byte too few: %d", (int)s);
    s = mcs_tiles_build(tiles, bytes, q->e, 16 + (uint32_t)(mcst_mix(state) % 16) + 1);
    CHECK(s == MCS_ERR_SIZE || s == MCS_ERR_MEMORY, "tiles of a wrong number of rows: %d", (int)s);
    s = mcs_tiles_build(tiles, bytes, q->e, 16);
    CHECK(s == (q->p ? MCS_OK : MCS_UNIFORM) && arena_intact(&m), "tiles: status %d", (int)s);
    for (int k = 0; k < 4; k++) check_product(q, tiles, state, t);
    CHECK(arena_intact(&m), "tiles: written outside");
    arena_free(&m);
}

/* Some bytes of a table changed: what mcs_env_check lets pass is drawn from inside the map and its memory. */
static void check_damage(const arena *map, uint64_t *state, tally *t) {
    const int changes = 1 + (int)(mcst_mix(state) % 3);
    arena m = arena_make(map->bytes);
    mcs_env *e = (mcs_env *)(void *)m.at;
    const size_t less = mcst_mix(state) % map->bytes;
    memcpy(m.at, map->at, map->bytes);
    mcs_status s = mcs_env_check(e, less);
    CHECK(s == MCS_ERR_MEMORY, "%u of %u bytes: %d", (unsigned)less, (unsigned)map->bytes, (int)s);
    for (int i = 0; i < changes; i++) {
        const uint64_t z = mcst_mix(state);
        const size_t reach = z & 1 ? map->bytes : z & 2 ? sizeof *e : 2 * sizeof *e < map->bytes ? 2 * sizeof *e : map->bytes;
        m.at[(z >> 16) % reach] ^= (unsigned char)(z & 4 ? 1u << (z >> 8 & 7) : z >> 8);
    }
    s = mcs_env_check(e, map->bytes);
    CHECK(s == MCS_OK || s == MCS_ERR_FORMAT || s == MCS_ERR_MEMORY, "damaged: %d", (int)s);
    for (int i = 0; s == MCS_OK && i < DRAWS; i++) {
        const mcs_texel a = mcs_env_sample(e, hostile_u(state), hostile_u(state));
        const mcs_texel b = mcs_env_sample_bits(e, (uint32_t)mcst_mix(state), (uint32_t)mcst_mix(state));
        const mcs_texel c = mcs_env_texel(e, i & 1 ? hostile_direction(state) : a.w);
        const mcs_vec2 back = mcs_env_invert(e, i & 1 ? b.w : a.w);
        const int inside = a.row < e->h && a.col < e->w && b.row < e->h && b.col < e->w && c.row < e->h && c.col < e->w;
        t->outside += !inside;
        CHECK(inside, "damaged: texels %u %u, %u %u, %u %u of %u x %u", (unsigned)a.col, (unsigned)a.row, (unsigned)b.col,
              (unsigned)b.row, (unsigned)c.col, (unsigned)c.row, (unsigned)e->w, (unsigned)e->h);
        CHECK(proper(t, a.pdf) && proper(t, b.pdf) && proper(t, c.pdf), "damaged: pdf %a %a %a", (double)a.pdf, (double)b.pdf,
              (double)c.pdf);
        CHECK(below_one(t, back.x) && below_one(t, back.y), "damaged: invert %a %a", (double)back.x, (double)back.y);
        t->evaluations += 4;
    }
    CHECK(arena_intact(&m), "damaged: written outside");
    arena_free(&m);
}

static void check_env(int tiled, uint64_t *state, tally *t) {
    picture p = make_picture(state);
    const size_t bytes = mcs_env_bytes(p.im.w, p.im.h);
    arena m = arena_make(bytes);
    arena parts = arena_make(bytes);
    arena copy = arena_make(p.m.bytes);
    mcs_env *e = (mcs_env *)(void *)m.at;
    mcs_env *other = (mcs_env *)(void *)parts.at;
    const uint32_t cut = (uint32_t)mcst_mix(state) % (p.im.h + 1);
    const float mean = mcs_env_mean(&p.im);
    mcs_image wrong = p.im;
    int some = 0;
    int none = 1;
    memcpy(copy.at, p.m.at, p.m.bytes);
    CHECK(finite(t, mean) && mean >= 0, "mean %a", (double)mean);
    mcs_status s = mcs_env_build(e, bytes - 1, &p.im);
    CHECK(s == MCS_ERR_MEMORY && untouched(m.at, bytes), "%u x %u, a byte too few: %d", (unsigned)p.im.w, (unsigned)p.im.h, (int)s);
    wrong.channels = 2;
    s = mcs_env_build(e, bytes, &wrong);
    CHECK(s == MCS_ERR_ARG && untouched(m.at, bytes), "2 channels: %d", (int)s);
    wrong = p.im;
    wrong.pixel_stride = PTRDIFF_MAX >> mcst_mix(state) % 8;
    wrong.row_stride = PTRDIFF_MIN;
    s = mcs_env_build(e, bytes, &wrong);
    CHECK(s == MCS_ERR_SIZE && untouched(m.at, bytes), "strides beyond memory: %d", (int)s);
    s = mcs_env_build(e, bytes, &p.im);
    CHECK(arena_intact(&m) && arena_intact(&p.m) && !memcmp(copy.at, p.m.at, p.m.bytes), "%u x %u: written outside",
          (unsigned)p.im.w, (unsigned)p.im.h);
    for (uint32_t i = 0; i < p.im.h; i++)
        for (uint32_t j = 0; j < p.im.w; j++) {
            const int lit = texel_lit(&p.im, j, i);
            some |= lit == 1;
            none &= lit == 0;
        }
    CHECK((!some || s == MCS_OK) && (!none || s == MCS_UNIFORM) && (s == MCS_OK || s == MCS_UNIFORM), "%u x %u: status %d",
          (unsigned)p.im.w, (unsigned)p.im.h, (int)s);
    CHECK(e->bad == p.bad, "%u bad texels, counted %u", (unsigned)p.bad, (unsigned)e->bad);
    CHECK(e->total >= 0 && e->total <= 1e300, "total %g", e->total);
    CHECK(mcs_env_check(e, bytes) == MCS_OK, "%u x %u: not a table: %d", (unsigned)p.im.w, (unsigned)p.im.h,
          (int)mcs_env_check(e, bytes));
    CHECK(mcs_env_build_rows(other, bytes, &p.im, cut, p.im.h) == MCS_OK &&
              mcs_env_build_rows(other, bytes, &p.im, 0, cut) == MCS_OK,
          "parts, cut at %u", (unsigned)cut);
    CHECK(mcs_env_build_rows(other, bytes, &p.im, cut, p.im.h + 1) == MCS_ERR_SIZE, "rows beyond the image");
    CHECK(mcs_env_finish(other, bytes, &p.im) == s && arena_intact(&parts) && !memcmp(m.at, parts.at, bytes), "%u x %u cut at %u",
          (unsigned)p.im.w, (unsigned)p.im.h, (unsigned)cut);
    part_of q;
    q.e = e;
    q.p = s == MCS_UNIFORM ? NULL : &p;
    q.row = q.col = 0;
    q.rows = e->h;
    q.cols = e->w;
    check_map(&q, NULL, 1, state, t);
    for (int k = 0; k < 2; k++) check_window(&p, e, state, t);
    if (tiled) check_tiles(&q, state, t);
    for (int k = 0; k < 4; k++) check_damage(&m, state, t);
    e->frame = mcs_frame_make(hostile_direction(state));
    check_map(&q, NULL, 0, state, t);
    CHECK(arena_intact(&m) && arena_intact(&p.m), "%u x %u: written outside while drawing", (unsigned)p.im.w, (unsigned)p.im.h);
    arena_free(&m);
    arena_free(&parts);
    arena_free(&copy);
    arena_free(&p.m);
}

int main(int argc, char **argv) {
    const double scale = mcst_scale();
    const long rounds = (long)fmax(1000, 1.5e6 * scale);
    const long calls = (long)fmax(20, 1e4 * scale);
    const long tables = (long)fmax(20, 2000 * scale);
    const long maps = (long)fmax(100, 5e4 * scale);
    const long products = (long)fmax(20, 1e4 * scale);
    mcst_start(argc, argv);
    print_head();
    tally t;
    for (size_t i = 0; i < MCST_NROWS; i++) {
        const mcst_row *row = &mcst_rows[i];
        memset(&t, 0, sizeof t);
        mcst_group(row->name);
        if (mcst_case("eight lanes")) check_lanes(row, &wide[i], mcst_seed_for(row->name, "lanes", 0), rounds, &t);
        if (mcst_case("arrays")) check_arrays(row, mcst_seed_for(row->name, "arrays", 0), calls, &t);
        mcst_close_case();
        if (t.evaluations > 0) print_tally(row->name, &t);
    }
    memset(&t, 0, sizeof t);
    mcst_group("vectors");
    if (mcst_case("frame, reflection, Fresnel, MIS, GGX terms")) {
        check_vectors(mcst_seed_for("vectors", "lanes", 0), rounds, &t);
        print_tally("vectors", &t);
    }
    memset(&t, 0, sizeof t);
    mcst_group("numbers");
    if (mcst_case("random numbers and points")) {
        check_numbers(mcst_seed_for("numbers", "", 0), 2 * rounds, &t);
        print_tally("numbers", &t);
    }
    mcst_group("tables");
    uint64_t state;
    for (int kind = 0; kind < KINDS; kind++) {
        memset(&t, 0, sizeof t);
        if (!mcst_case("%s", kind_name[kind])) continue;
        state = mcst_seed_for("tables", kind_name[kind], 0);
        for (long k = 0; k < tables; k++) {
            const uint64_t z = mcst_mix(&state);
            check_table(kind, k < 40 ? (uint32_t)k + 1 : 1 + (uint32_t)(z >> 40) % (z % 50 ? 5000 : 200000), &state, &t);
        }
        mcst_close_case();
        print_tally(kind_name[kind], &t);
    }
    mcst_group("environment");
    for (int kind = 0; kind < 2; kind++) {
        memset(&t, 0, sizeof t);
        if (!mcst_case(kind ? "products" : "maps")) continue;
        state = mcst_seed_for("environment", kind ? "products" : "maps", 0);
        for (long k = 0; k < (kind ? products : maps); k++) check_env(kind, &state, &t);
        mcst_close_case();
        print_tally(kind ? "env, product" : "env", &t);
    }
    mcst_note("%.3g evaluations\n", all_evaluations);
    return mcst_finish();
}
