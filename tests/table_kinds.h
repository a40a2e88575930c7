/* What the tests of tables share: the four kinds behind one interface, weights to build from, numbers to draw with. */
#ifndef MCST_TABLE_KINDS_H
#define MCST_TABLE_KINDS_H
#include <float.h>
#include <math.h>
#include "arena.h"
#include "mcs_test.h"
#include "mcsample.h"

typedef long double ld;

enum { GRID = 1 << 24, STRATA = 1 << 16, MAX_N = 1000003 };
static const double level = 1e-5; /* of one statistical test: Sidak, 1000 of them in the whole suite at 0.01 together */
static const double eps =
    0x1p-24; /* rounding of a float, relative; also the step of u and the largest step of x below 1 */
static const double quantum = 0x1p-31; /* probabilities of a table are integers over 2^31 */

/* ---- the three kinds behind one interface ---- */

typedef struct {
    float x, pdf, rest;
    uint32_t i;
} draw;

typedef struct {
    const char *name;
    uint32_t extra; /* weights beyond the number of cells */
    size_t (*bytes)(uint32_t n);
    int (*build)(void *t, size_t bytes, const float *w, uint32_t n);
    draw (*sample)(const void *t, float u);
    double (*total)(const void *t);
    unsigned long long (*bad)(const void *t);
    uint32_t (*uniform)(const void *t);
} kind;

static inline size_t pwc_bytes(uint32_t n) { return mcs_pwc_bytes(n); }
static inline int pwc_build(void *t, size_t bytes, const float *w, uint32_t n) {
    return mcs_pwc_build((mcs_pwc *)t, bytes, w, n);
}
static inline draw pwc_sample(const void *t, float u) {
    const mcs_cell c = mcs_pwc_sample((const mcs_pwc *)t, u);
    draw d;
    d.x = c.x;
    d.pdf = c.pdf;
    d.rest = 0;
    d.i = c.i;
    return d;
}
static inline double pwc_total(const void *t) { return ((const mcs_pwc *)t)->total; }
static inline unsigned long long pwc_bad(const void *t) { return ((const mcs_pwc *)t)->bad; }
static inline uint32_t pwc_uniform(const void *t) { return ((const mcs_pwc *)t)->uniform; }

static inline size_t discrete_bytes(uint32_t n) { return mcs_discrete_bytes(n); }
static inline int discrete_build(void *t, size_t bytes, const float *w, uint32_t n) {
    return mcs_discrete_build((mcs_discrete *)t, bytes, w, n);
}
static inline draw discrete_sample(const void *t, float u) {
    const mcs_pick c = mcs_discrete_sample((const mcs_discrete *)t, u);
    draw d;
    d.x = 0;
    d.pdf = c.pmf;
    d.rest = c.u;
    d.i = c.i;
    return d;
}

static inline size_t pwl_bytes(uint32_t n) { return mcs_pwl_bytes(n); }
static inline int pwl_build(void *t, size_t bytes, const float *w, uint32_t n) {
    return mcs_pwl_build((mcs_pwl *)t, bytes, w, n);
}
static inline draw pwl_sample(const void *t, float u) {
    const mcs_cell c = mcs_pwl_sample((const mcs_pwl *)t, u);
    draw d;
    d.x = c.x;
    d.pdf = c.pdf;
    d.rest = 0;
    d.i = c.i;
    return d;
}
static inline double pwl_total(const void *t) { return ((const mcs_pwl *)t)->cells.total; }
static inline unsigned long long pwl_bad(const void *t) { return ((const mcs_pwl *)t)->cells.bad; }
static inline uint32_t pwl_uniform(const void *t) { return ((const mcs_pwl *)t)->cells.uniform; }

static inline size_t alias_bytes(uint32_t n) { return mcs_alias_bytes(n); }
static inline int alias_build(void *t, size_t bytes, const float *w, uint32_t n) {
    return mcs_alias_build((mcs_alias *)t, bytes, w, n);
}
static inline draw alias_sample(const void *t, float u) {
    const mcs_pick c = mcs_alias_sample((const mcs_alias *)t, u);
    draw d;
    d.x = 0;
    d.pdf = c.pmf;
    d.rest = c.u;
    d.i = c.i;
    return d;
}
static inline double alias_total(const void *t) { return ((const mcs_alias *)t)->total; }
static inline unsigned long long alias_bad(const void *t) { return ((const mcs_alias *)t)->bad; }
static inline uint32_t alias_uniform(const void *t) { return ((const mcs_alias *)t)->uniform; }

static const kind kinds[4] = {
    {"pwc", 0, pwc_bytes, pwc_build, pwc_sample, pwc_total, pwc_bad, pwc_uniform},
    {"discrete", 0, discrete_bytes, discrete_build, discrete_sample, pwc_total, pwc_bad, pwc_uniform},
    {"pwl", 1, pwl_bytes, pwl_build, pwl_sample, pwl_total, pwl_bad, pwl_uniform},
    {"alias", 0, alias_bytes, alias_build, alias_sample, alias_total, alias_bad, alias_uniform}};
enum { PWC, DISCRETE, PWL, ALIAS };

/* ---- weights to build from ---- */

typedef struct {
    const char *name;
    uint32_t n;
    int every_u; /* 1 << kind: sweep all 2^24 u, else a chi-square */
    float (*w)(uint32_t i, uint32_t n);
} weights;

static inline float hash01(uint32_t i) { return mcs_u01(mcs_philox(mcst.seed, i, 1).v[0]); }
static inline float w_one(uint32_t i, uint32_t n) {
    (void)i;
    (void)n;
    return 1.0f;
}
static inline float w_random(uint32_t i, uint32_t n) {
    (void)n;
    return hash01(i);
}
static inline float w_ends(uint32_t i, uint32_t n) { return i == 0 || i + 1 == n ? 1.0f : 0.0f; }
static inline float w_ramp(uint32_t i, uint32_t n) {
    (void)n;
    return (float)i;
}
static inline float w_border(uint32_t i, uint32_t n) { return i < n / 3 || i >= n - n / 4 ? 0.0f : 0.5f + hash01(i); }
static inline float w_checker(uint32_t i, uint32_t n) {
    (void)n;
    return i & 1 ? 1.0f : 0.0f;
}
static inline float w_last(uint32_t i, uint32_t n) { return i + 1 == n ? 3.0f : 0.0f; }
static inline float w_peak8(uint32_t i, uint32_t n) { return i == n / 3 ? 1e8f : i % 5 ? hash01(i) : 0.0f; }
static inline float w_peak30(uint32_t i, uint32_t n) { return i == n / 2 ? 1e30f : i % 7 ? 1.0f : 0.0f; }
static inline float w_denormal(uint32_t i, uint32_t n) {
    (void)n;
    return (float)(int)(i % 4) * 1.4012984643e-45f;
}
static inline float w_huge(uint32_t i, uint32_t n) {
    (void)n;
    return i % 3 ? FLT_MAX : FLT_MAX / 7;
}
static inline float w_wide(uint32_t i, uint32_t n) {
    (void)n;
    return powf(10.0f, 76.0f * hash01(i) - 38.0f);
}

static const weights sets[] = {
    {"one entry", 1, 0, w_one},
    {"two", 2, 0, w_one},
    {"both ends of four: 1/2 is a border", 4, 1 << PWC, w_ends},
    {"seven random", 7, 1 << PWC | 1 << PWL | 1 << ALIAS, w_random},
    {"ramp of 100", 100, 0, w_ramp},
    {"zeros at both ends", 48, 1 << PWC | 1 << PWL, w_border},
    {"last entry only", 33, 0, w_last},
    {"checkerboard 1000", 1000, 1 << PWC, w_checker},
    {"peak 1e8 of 4096", 4096, 1 << PWC | 1 << PWL | 1 << ALIAS, w_peak8},
    {"peak 1e30 of 257", 257, 1 << PWC | 1 << PWL | 1 << ALIAS, w_peak30},
    {"denormals", 12, 0, w_denormal},
    {"FLT_MAX 1000", 1000, 0, w_huge},
    {"10^-38 to 10^38", 500, 0, w_wide},
    {"a million", 1000003, 0, w_random},
    {"checkerboard of a million", 1000000, 0, w_checker},
};
enum { SEVEN = 3, RAMP = 4, CHECKER = 7, PEAK = 8, SETS = (int)(sizeof sets / sizeof *sets) };

static float weight[MAX_N + 1];
static ld mass[MAX_N], cumulative[MAX_N + 1], sum;
static uint32_t lit;
static uint32_t hits[MAX_N];

/* Masses of the cells: the weights, or the means of neighbouring vertices. They are normalised by their long double
 * sum. */
static inline void load(const weights *s, uint32_t extra) {
    for (uint32_t i = 0; i < s->n + extra; i++) weight[i] = s->w(i, s->n + extra);
    sum = 0;
    lit = 0;
    cumulative[0] = 0;
    for (uint32_t i = 0; i < s->n; i++) sum += mass[i] = extra ? ((ld)weight[i] + weight[i + 1]) / 2 : weight[i];
    for (uint32_t i = 0; i < s->n; i++) {
        mass[i] /= sum;
        cumulative[i + 1] = cumulative[i] + mass[i];
        lit += mass[i] > 0;
    }
}

/* u in increasing order: the middle of each stratum moved at random, and the corners of the floats of [0,1). */
static const float corner[] = {0.0f,           1.4e-45f,      FLT_MIN,       1e-30f,       0x1p-32f,
                               0x1p-25f,       0x1p-24f,      0x1p-23f,      0.25f,        0.5f,
                               0x0.7fffffcp0f, 0x0.800001p0f, 0x0.fffffep0f, 0x0.ffffffp0f};
enum { CORNERS = (int)(sizeof corner / sizeof *corner), US = STRATA + CORNERS };
static float us[US];

static inline int by_value(const void *a, const void *b) {
    const float x = *(const float *)a;
    const float y = *(const float *)b;
    return (x > y) - (x < y);
}

static inline void make_us(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 11);
    for (int i = 0; i < STRATA; i++) {
        const double u = (i + (double)mcs_pcg32_float(&r)) / STRATA;
        us[i] = u < 1 - eps ? (float)u : (float)(1 - eps);
    }
    for (int i = 0; i < CORNERS; i++) us[STRATA + i] = corner[i];
    qsort(us, US, sizeof *us, by_value);
}

/* Probabilities are integers over 2^31 with at least one for each entry that is not zero. However the ones are found
 * (one for each and the rest shared, or raised from zero), a cumulative probability moves by one integer for each such
 * entry at most, and by one of rounding. A single probability p moves by its own one, its share of those for all, and
 * one of rounding: 2 + lit p. */
static inline double slack_of(void) { return (lit + 1.0) * quantum; }

static inline arena build(const kind *k, uint32_t n, double *total_error) {
    arena a = arena_make(k->bytes(n));
    const int rc = k->build(a.at, a.bytes, weight, n);
    CHECK(rc == MCS_OK, "%s: build returns %d", k->name, rc);
    CHECK(arena_intact(&a), "%s: build wrote outside its %zu bytes", k->name, a.bytes);
    CHECK(k->bad(a.at) == 0, "%s: %llu bad", k->name, k->bad(a.at));
    if (total_error) *total_error = fabs((double)(k->total(a.at) / sum - 1));
    return a;
}
#endif
