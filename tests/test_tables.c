/* Tables: piecewise constant, discrete, piecewise linear, alias. The truth is the weights themselves, summed in long double. */
#include <float.h>
#include <math.h>
#include "arena.h"
#include "mcs_test.h"
#include "mcsample.h"
#include "stats.h"

typedef long double ld;

enum { GRID = 1 << 24, STRATA = 1 << 16, MAX_N = 1000003 };
static const double level = 1e-5;      /* of one statistical test: Sidak, 1000 of them in the whole suite at 0.01 together */
static const double eps = 0x1p-24;     /* rounding of a float, relative; also the step of u and the largest step of x below 1 */
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
} kind;

static size_t pwc_bytes(uint32_t n) { return mcs_pwc_bytes(n); }
static int pwc_build(void *t, size_t bytes, const float *w, uint32_t n) { return mcs_pwc_build((mcs_pwc *)t, bytes, w, n); }
static draw pwc_sample(const void *t, float u) {
    const mcs_cell c = mcs_pwc_sample((const mcs_pwc *)t, u);
    draw d;
    d.x = c.x;
    d.pdf = c.pdf;
    d.rest = 0;
    d.i = c.i;
    return d;
}
static double pwc_total(const void *t) { return ((const mcs_pwc *)t)->total; }
static unsigned long long pwc_bad(const void *t) { return ((const mcs_pwc *)t)->bad; }

static draw discrete_sample(const void *t, float u) {
    const mcs_pick c = mcs_discrete_sample((const mcs_pwc *)t, u);
    draw d;
    d.x = 0;
    d.pdf = c.pmf;
    d.rest = c.u;
    d.i = c.i;
    return d;
}

static size_t pwl_bytes(uint32_t n) { return mcs_pwl_bytes(n); }
static int pwl_build(void *t, size_t bytes, const float *w, uint32_t n) { return mcs_pwl_build((mcs_pwl *)t, bytes, w, n); }
static draw pwl_sample(const void *t, float u) {
    const mcs_cell c = mcs_pwl_sample((const mcs_pwl *)t, u);
    draw d;
    d.x = c.x;
    d.pdf = c.pdf;
    d.rest = 0;
    d.i = c.i;
    return d;
}
static double pwl_total(const void *t) { return ((const mcs_pwl *)t)->cells.total; }
static unsigned long long pwl_bad(const void *t) { return ((const mcs_pwl *)t)->cells.bad; }

static size_t alias_bytes(uint32_t n) { return mcs_alias_bytes(n); }
static int alias_build(void *t, size_t bytes, const float *w, uint32_t n) { return mcs_alias_build((mcs_alias *)t, bytes, w, n); }
static draw alias_sample(const void *t, float u) {
    const mcs_pick c = mcs_alias_sample((const mcs_alias *)t, u);
    draw d;
    d.x = 0;
    d.pdf = c.pmf;
    d.rest = c.u;
    d.i = c.i;
    return d;
}
static double alias_total(const void *t) { return ((const mcs_alias *)t)->total; }
static unsigned long long alias_bad(const void *t) { return ((const mcs_alias *)t)->bad; }

static const kind kinds[4] = {{"pwc", 0, pwc_bytes, pwc_build, pwc_sample, pwc_total, pwc_bad},
                              {"discrete", 0, pwc_bytes, pwc_build, discrete_sample, pwc_total, pwc_bad},
                              {"pwl", 1, pwl_bytes, pwl_build, pwl_sample, pwl_total, pwl_bad},
                              {"alias", 0, alias_bytes, alias_build, alias_sample, alias_total, alias_bad}};
enum { PWC, DISCRETE, PWL, ALIAS };

/* ---- weights to build from ---- */

typedef struct {
    const char *name;
    uint32_t n;
    int every_u; /* 1 << kind: sweep all 2^24 u, else a chi-square */
    float (*w)(uint32_t i, uint32_t n);
} weights;

static float hash01(uint32_t i) { return mcs_u01(mcs_philox(mcst.seed, i, 1).v[0]); }
static float w_one(uint32_t i, uint32_t n) {
    (void)i;
    (void)n;
    return 1.0f;
}
static float w_random(uint32_t i, uint32_t n) {
    (void)n;
    return hash01(i);
}
static float w_ends(uint32_t i, uint32_t n) { return i == 0 || i + 1 == n ? 1.0f : 0.0f; }
static float w_ramp(uint32_t i, uint32_t n) {
    (void)n;
    return (float)i;
}
static float w_border(uint32_t i, uint32_t n) { return i < n / 3 || i >= n - n / 4 ? 0.0f : 0.5f + hash01(i); }
static float w_checker(uint32_t i, uint32_t n) {
    (void)n;
    return i & 1 ? 1.0f : 0.0f;
}
static float w_last(uint32_t i, uint32_t n) { return i + 1 == n ? 3.0f : 0.0f; }
static float w_peak8(uint32_t i, uint32_t n) { return i == n / 3 ? 1e8f : i % 5 ? hash01(i) : 0.0f; }
static float w_peak30(uint32_t i, uint32_t n) { return i == n / 2 ? 1e30f : i % 7 ? 1.0f : 0.0f; }
static float w_denormal(uint32_t i, uint32_t n) {
    (void)n;
    return (float)(int)(i % 4) * 1.4012984643e-45f;
}
static float w_huge(uint32_t i, uint32_t n) {
    (void)n;
    return i % 3 ? FLT_MAX : FLT_MAX / 7;
}
static float w_wide(uint32_t i, uint32_t n) {
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

/* Masses of the cells: the weights, or the means of neighbouring vertices. They are normalised by their long double sum. */
static void load(const weights *s, uint32_t extra) {
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
static const float corner[] = {0.0f,     1.4e-45f, FLT_MIN, 1e-30f,         0x1p-32f,      0x1p-25f,      0x1p-24f,
                               0x1p-23f, 0.25f,    0.5f,    0x0.7fffffcp0f, 0x0.800001p0f, 0x0.fffffep0f, 0x0.ffffffp0f};
enum { CORNERS = (int)(sizeof corner / sizeof *corner), US = STRATA + CORNERS };
static float us[US];

static int by_value(const void *a, const void *b) {
    const float x = *(const float *)a;
    const float y = *(const float *)b;
    return (x > y) - (x < y);
}

static void make_us(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 11);
    for (int i = 0; i < STRATA; i++) {
        const double u = (i + (double)mcs_pcg32_float(&r)) / STRATA;
        us[i] = u < 1 - eps ? (float)u : (float)(1 - eps);
    }
    for (int i = 0; i < CORNERS; i++) us[STRATA + i] = corner[i];
    qsort(us, US, sizeof *us, by_value);
}

/* Probabilities are integers over 2^31 with at least one for each entry that is not zero. However the ones are found (one for each
 * and the rest shared, or raised from zero), a cumulative probability moves by one integer for each such entry at most, and by
 * one of rounding. A single probability p moves by its own one, its share of those for all, and one of rounding: 2 + lit p. */
static double slack_of(void) { return (lit + 1.0) * quantum; }

static arena build(const kind *k, uint32_t n, double *total_error) {
    arena a = arena_make(k->bytes(n));
    const int rc = k->build(a.at, a.bytes, weight, n);
    CHECK(rc == MCS_OK, "%s: build returns %d", k->name, rc);
    CHECK(arena_intact(&a), "%s: build wrote outside its %zu bytes", k->name, a.bytes);
    CHECK(k->bad(a.at) == 0, "%s: %llu bad", k->name, k->bad(a.at));
    if (total_error) *total_error = fabs((double)(k->total(a.at) / sum - 1));
    return a;
}

/* ---- piecewise constant and discrete ---- */

static void check_pmf(const mcs_pwc *t, uint32_t n) {
    double total = 0;
    int exact = 1;
    for (uint32_t i = 0; i < n; i++) {
        const double p = mcs_discrete_pmf(t, i);
        const double err = fabs((double)(p - mass[i]));
        total += p;
        exact &= p < 0x1p-7; /* below that an integer over 2^31 is exact in a float */
        CHECK((p > 0) == (mass[i] > 0), "entry %u: pmf %g where the weight is %g", i, p, (double)weight[i]);
        CHECK(err <= (2 + lit * p) * quantum + eps * p, "entry %u: pmf %g, not %g", i, p, (double)mass[i]);
    }
    CHECK(fabs(total - 1) <= (exact ? 0 : eps), "pmf sums to 1 + %g", total - 1);
    CHECK(mcs_discrete_pmf(t, n) == 0 && mcs_discrete_pmf(t, 0xffffffffu) == 0, "pmf past the end");
}

/* All 2^24 u. An interval [c, c + p) holds more than p 2^24 - 1 and fewer than p 2^24 + 1 of them; the float p is off by eps p. */
static void sweep_pwc(const mcs_pwc *t, uint32_t n) {
    int wrong_pdf = 0;
    int falls = 0;
    int outside = 0;
    int dark = 0;
    float last = 0;
    memset(hits, 0, n * sizeof *hits);
    for (uint32_t k = 0; k < GRID; k++) {
        const mcs_cell c = mcs_pwc_sample(t, (float)k * 0x1p-24f);
        outside += !(c.i < n && c.x >= 0 && c.x < 1);
        if (c.i >= n) continue;
        hits[c.i]++;
        dark += !(weight[c.i] > 0);
        falls += !(c.x >= last);
        wrong_pdf += !(mcs_pwc_pdf(t, c.x) == c.pdf);
        last = c.x;
    }
    CHECK(outside == 0, "%d points outside [0,1)", outside);
    CHECK(dark == 0, "%d draws of a zero entry", dark);
    CHECK(falls == 0, "x falls %d times", falls);
    CHECK(wrong_pdf == 0, "pdf(x) differs from the returned pdf %d times", wrong_pdf);
    for (uint32_t i = 0; i < n; i++) {
        const double p = mcs_discrete_pmf(t, i);
        CHECK(fabs(hits[i] - p * GRID) <= 1 + p, "entry %u: %u of 2^24 draws, pmf %a", i, hits[i], p);
    }
}

/* x is rounded three times at most (cell plus fraction, reciprocal, product) and moved one float to stay in its cell. */
static void check_pwc(const mcs_pwc *t, uint32_t n) {
    const double dx = 4 * eps;
    const double slack = slack_of();
    float last = 0;
    for (int k = 0; k < US; k++) {
        const float u = us[k];
        const mcs_cell c = mcs_pwc_sample(t, u);
        const mcs_pick d = mcs_discrete_sample(t, u);
        const float back = mcs_pwc_invert(t, c.x);
        CHECK(c.i < n && c.x >= 0 && c.x < 1, "u = %a: x = %a, i = %u", (double)u, (double)c.x, c.i);
        if (c.i >= n) continue;
        const double p = mcs_discrete_pmf(t, c.i);
        CHECK(weight[c.i] > 0, "u = %a: zero entry %u", (double)u, c.i);
        CHECK(c.x >= last, "u = %a: x falls to %a", (double)u, (double)c.x);
        CHECK(mcs_pwc_pdf(t, c.x) == c.pdf, "u = %a, x = %a: pdf %g, returned %g", (double)u, (double)c.x,
              (double)mcs_pwc_pdf(t, c.x), (double)c.pdf);
        CHECK(fabs(c.pdf - p * n) <= 2 * eps * p * n, "u = %a: pdf %g, pmf * n %g", (double)u, (double)c.pdf, p * n);
        const ld at = (ld)c.x * n - c.i; /* exact: 24 + 20 bits */
        CHECK(fabs((double)(at - 0.5L)) <= 0.5 + 2 * eps * n, "u = %a: x = %a is not in cell %u", (double)u, (double)c.x, c.i);
        double err = fabs((double)(cumulative[c.i] + mass[c.i] * at - u));
        CHECK(err <= slack + p * n * dx + eps, "u = %a: C(x) is off by %g", (double)u, err);
        err = fabs((double)back - u);
        CHECK(back >= 0 && back < 1 && err <= p * n * dx + 2 * eps, "u = %a: invert %a", (double)u, (double)back);
        CHECK(d.i == c.i && d.pmf == mcs_discrete_pmf(t, d.i), "u = %a: discrete %u, %g", (double)u, d.i, (double)d.pmf);
        const ld below = cumulative[d.i] + (ld)d.u * mass[d.i];
        CHECK(d.u >= 0 && d.u < 1 && fabs((double)(below - u)) <= 2 * slack + 2 * eps * (p + u), "u = %a: rest %a of entry %u",
              (double)u, (double)d.u, d.i);
        last = c.x;
    }
}

/* Counts of many draws against n equal groups of entries (64 at most), expectations by the weights, not by the table. */
static void chi_square(const kind *k, const void *t, uint32_t n) {
    static double observed[64], expected[64];
    const uint32_t groups = n < 64 ? n : 64;
    const int draws = 1000000;
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, n);
    int shown = 0;
    for (uint32_t g = 0; g < groups; g++) observed[g] = expected[g] = 0;
    for (uint32_t i = 0; i < n; i++) expected[(uint64_t)i * groups / n] += (double)mass[i] * draws;
    for (int j = 0; j < draws; j++) {
        const draw d = k->sample(t, mcs_pcg32_float(&r));
        if (d.i < n) observed[(uint64_t)d.i * groups / n] += 1;
        else CHECK(shown++ > 0, "entry %u of %u", d.i, n);
    }
    uint32_t full = 0;
    for (uint32_t g = 0; g < groups; g++) full += expected[g] >= 5;
    if (full >= 2) {
        const double p = chi2_test(observed, expected, groups, NULL, NULL);
        CHECK(p >= level, "chi-square p = %g", p);
    } else {
        for (uint32_t g = 0; g < groups; g++) CHECK(expected[g] >= 5 || observed[g] <= 40, "group %u: %g draws", g, observed[g]);
    }
}

static void test_pwc(void) {
    for (int s = 0; s < SETS; s++) {
        if (!mcst_case("%s", sets[s].name)) continue;
        load(&sets[s], 0);
        double total;
        arena a = build(&kinds[PWC], sets[s].n, &total);
        CHECK(total <= 1e-12, "total is off by %g relative", total);
        check_pmf((const mcs_pwc *)a.at, sets[s].n);
        check_pwc((const mcs_pwc *)a.at, sets[s].n);
        if (sets[s].every_u >> PWC & 1) sweep_pwc((const mcs_pwc *)a.at, sets[s].n);
        else chi_square(&kinds[s & 1 ? DISCRETE : PWC], a.at, sets[s].n);
        arena_free(&a);
    }
}

/* ---- piecewise linear ---- */

/* With vertex values f, g of the cell and the mean value m of all cells: density lerp(f, g, at)/m, slope n (g - f)/m per length. */
static void check_pwl(const mcs_pwl *t, uint32_t n) {
    const double dx = 4 * eps;
    const double slack = slack_of();
    const ld mean = sum / n;
    float last = 0;
    for (int k = 0; k < US; k++) {
        const float u = us[k];
        const mcs_cell c = mcs_pwl_sample(t, u);
        const float again = mcs_pwl_pdf(t, c.x);
        const float back = mcs_pwl_invert(t, c.x);
        CHECK(c.i < n && c.x >= 0 && c.x < 1, "u = %a: x = %a, i = %u", (double)u, (double)c.x, c.i);
        if (c.i >= n) continue;
        const ld f = weight[c.i];
        const ld g = weight[c.i + 1];
        const ld at = (ld)c.x * n - c.i;
        const ld want = (f + (g - f) * at) / mean;
        const double slope = fabs((double)((g - f) / mean)) * n;
        const double near = (double)want + slope * dx; /* largest density within the rounding of x */
        const double relative = slack / (double)mass[c.i] + 8 * eps;
        CHECK(mass[c.i] > 0, "u = %a: zero cell %u", (double)u, c.i);
        CHECK(c.x >= last, "u = %a: x falls to %a", (double)u, (double)c.x);
        CHECK(fabs((double)(at - 0.5L)) <= 0.5 + 2 * eps * n, "u = %a: x = %a is not in cell %u", (double)u, (double)c.x, c.i);
        CHECK(fabs((double)(again - want)) <= relative * near + slope * eps, "u = %a: pdf(%a) = %g, not %g", (double)u, (double)c.x,
              (double)again, (double)want);
        CHECK(fabs((double)(c.pdf - want)) <= relative * near + slope * dx, "u = %a: returned pdf %g at %a, not %g", (double)u,
              (double)c.pdf, (double)c.x, (double)want);
        const double err = fabs((double)(cumulative[c.i] + (f * at + (g - f) * at * at / 2) / sum - u));
        CHECK(err <= slack + near * dx + eps, "u = %a: C(x) is off by %g", (double)u, err);
        CHECK(back >= 0 && back < 1 && fabs((double)back - u) <= near * dx + 4 * eps, "u = %a: invert %a", (double)u, (double)back);
        last = c.x;
    }
}

static void sweep_pwl(const mcs_pwl *t, uint32_t n) {
    int falls = 0;
    int outside = 0;
    int dark = 0;
    float last = 0;
    memset(hits, 0, n * sizeof *hits);
    for (uint32_t k = 0; k < GRID; k++) {
        const mcs_cell c = mcs_pwl_sample(t, (float)k * 0x1p-24f);
        outside += !(c.i < n && c.x >= 0 && c.x < 1);
        if (c.i >= n) continue;
        hits[c.i]++;
        dark += !(mass[c.i] > 0) || !(c.pdf >= 0 && c.pdf <= FLT_MAX);
        falls += !(c.x >= last);
        last = c.x;
    }
    CHECK(outside == 0, "%d points outside [0,1)", outside);
    CHECK(dark == 0, "%d draws of a zero cell or without a finite pdf", dark);
    CHECK(falls == 0, "x falls %d times", falls);
    for (uint32_t i = 0; i < n; i++) {
        const double p = (double)mass[i];
        CHECK(fabs(hits[i] - p * GRID) <= 1 + 2 * slack_of() * GRID, "cell %u: %u of 2^24 draws, mass %a", i, hits[i], p);
    }
}

/* The sum of two vertices exceeds FLT_MAX: 2/3 of the mass lies in the first of two cells, evenly. */
static void test_pwl_overflow(void) {
    const float f[3] = {2e38f, 2e38f, 1};
    arena a = arena_make(mcs_pwl_bytes(2));
    mcs_pwl *t = (mcs_pwl *)a.at;
    CHECK(mcs_pwl_build(t, a.bytes, f, 2) == MCS_OK, "build");
    CHECK(fabs(mcs_pwl_pdf(t, 0.2f) * 0.75 - 1) <= 1e-6, "density %.9g, not 4/3", (double)mcs_pwl_pdf(t, 0.2f));
    arena_free(&a);
}

static void test_pwl(void) {
    static const float triangle[3][2] = {{0, 1}, {1, 0}, {1, 0x1.000002p0f}};
    for (int s = 0; s < SETS; s++) {
        if (!mcst_case("%s", sets[s].name)) continue;
        load(&sets[s], 1);
        double total;
        arena a = build(&kinds[PWL], sets[s].n, &total);
        CHECK(total <= 1e-12, "total is off by %g relative", total);
        check_pwl((const mcs_pwl *)a.at, sets[s].n);
        if (sets[s].every_u >> PWL & 1) sweep_pwl((const mcs_pwl *)a.at, sets[s].n);
        else chi_square(&kinds[PWL], a.at, sets[s].n);
        arena_free(&a);
    }
    if (mcst_case("vertices whose sum overflows")) test_pwl_overflow();
    if (mcst_case("one cell is the linear density")) {
        for (int s = 0; s < 3; s++) {
            arena a = arena_make(mcs_pwl_bytes(1));
            const int rc = mcs_pwl_build((mcs_pwl *)a.at, a.bytes, triangle[s], 1);
            CHECK(rc == MCS_OK, "build returns %d", rc);
            for (int k = 0; k < US; k++) {
                const mcs_cell c = mcs_pwl_sample((const mcs_pwl *)a.at, us[k]);
                const mcs_sample1 l = mcs_linear_sample(triangle[s][0], triangle[s][1], us[k]);
                CHECK(fabs((double)c.x - l.x) <= 4 * eps, "u = %a: %a, not %a", (double)us[k], (double)c.x, (double)l.x);
                CHECK(fabs((double)c.pdf - l.pdf) <= 8 * eps * l.pdf + 2 * 4 * eps, "u = %a: pdf %g, not %g", (double)us[k],
                      (double)c.pdf, (double)l.pdf);
            }
            arena_free(&a);
        }
    }
}

/* ---- alias: integers over n 2^31, bounded as above; their cumulative sums are doubles, rounded three times at either end ---- */

/* Of n columns an entry holds at most n + 1 intervals of u (its own and parts of others), each counted to within one of 2^24. */
static void sweep_alias(const mcs_alias *t, uint32_t n) {
    int outside = 0;
    int dark = 0;
    int wrong = 0;
    double off = 0;
    memset(hits, 0, n * sizeof *hits);
    for (uint32_t k = 0; k < GRID; k++) {
        const mcs_pick c = mcs_alias_sample(t, (float)k * 0x1p-24f);
        outside += !(c.i < n && c.u >= 0 && c.u < 1);
        if (c.i >= n) continue;
        hits[c.i]++;
        dark += !(weight[c.i] > 0);
        wrong += !(mcs_alias_pmf(t, c.i) == c.pmf);
    }
    CHECK(outside == 0, "%d picks outside", outside);
    CHECK(dark == 0, "%d draws of a zero entry", dark);
    CHECK(wrong == 0, "pmf(i) differs from the returned pmf %d times", wrong);
    for (uint32_t i = 0; i < n; i++) {
        const double p = mcs_alias_pmf(t, i);
        const double err = fabs(hits[i] - p * GRID);
        CHECK(err <= n + 1, "entry %u: %u of 2^24 draws, pmf %a", i, hits[i], p);
        off += err;
    }
    CHECK(off <= 4.0 * n, "%g of 2^24 draws misplaced, 2 intervals a column", off);
}

static void test_alias(void) {
    for (int s = 0; s < SETS; s++) {
        const uint32_t n = sets[s].n;
        double psum = 0;
        if (!mcst_case("%s", sets[s].name)) continue;
        load(&sets[s], 0);
        double total;
        arena a = build(&kinds[ALIAS], n, &total);
        CHECK(total <= 1e-12, "total is off by %g relative", total);
        for (uint32_t i = 0; i < n; i++) {
            const double p = mcs_alias_pmf((const mcs_alias *)a.at, i);
            psum += p;
            CHECK((p > 0) == (mass[i] > 0), "entry %u: pmf %g, probability %g", i, p, (double)mass[i]);
            CHECK(fabs((double)(p - mass[i])) <= (2 + lit * p) * quantum / n + 6 * 0x1p-53 + eps * p, "entry %u: pmf %g, not %g", i,
                  p, (double)mass[i]);
        }
        CHECK(fabs(psum - 1) <= eps, "pmf sums to 1 + %g", psum - 1);
        CHECK(mcs_alias_pmf((const mcs_alias *)a.at, n) == 0, "pmf past the end");
        for (int k = 0; k < US; k++) {
            const mcs_pick c = mcs_alias_sample((const mcs_alias *)a.at, us[k]);
            CHECK(c.i < n && weight[c.i] > 0 && c.u >= 0 && c.u < 1, "u = %a: entry %u, rest %a", (double)us[k], c.i, (double)c.u);
            CHECK(c.pmf == mcs_alias_pmf((const mcs_alias *)a.at, c.i), "u = %a: returned pmf %g", (double)us[k], (double)c.pmf);
        }
        if (sets[s].every_u >> ALIAS & 1) sweep_alias((const mcs_alias *)a.at, n);
        else chi_square(&kinds[ALIAS], a.at, n);
        arena_free(&a);
    }
}

/* The rest of u is uniform again, within each entry and over all: 64 cells by entry, for entries that 2^24 u resolve. */
static void test_rest(const kind *k) {
    static double observed[7 * 64], expected[7 * 64];
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 21);
    const int draws = 1000000;
    load(&sets[SEVEN], 0);
    arena a = build(k, 7, NULL);
    for (int j = 0; j < 7 * 64; j++) {
        observed[j] = 0;
        expected[j] = (double)mass[j / 64] * draws / 64;
    }
    for (int j = 0; j < draws; j++) {
        const draw d = k->sample(a.at, mcs_pcg32_float(&r));
        if (d.i < 7 && d.rest >= 0 && d.rest < 1) observed[d.i * 64 + (uint32_t)(d.rest * 64)] += 1;
    }
    const double p = chi2_test(observed, expected, 7 * 64, NULL, NULL);
    CHECK(p >= level, "chi-square of entry and rest: p = %g", p);
    arena_free(&a);
}

/* ---- batch forms ---- */

static void test_batch(void) {
    enum { MAX = 67 };
    const size_t counts[] = {1000, 4099};
    static float u[4200], x[4200 + 8], pdf[4200 + 8];
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 31);
    load(&sets[CHECKER], 0);
    arena c = build(&kinds[PWC], sets[CHECKER].n, NULL);
    load(&sets[RAMP], 1);
    arena l = build(&kinds[PWL], sets[RAMP].n, NULL);
    for (size_t n = 0; n <= MAX + 2; n++) {
        const size_t count = n <= MAX ? n : counts[n - MAX - 1];
        for (size_t shift = 0; shift < 4; shift++) {
            mcs_pcg32_fill_n(&r, count + shift, u);
            for (int pass = 0; pass < 8; pass++) {
                const int linear = pass & 1;
                const int inplace = pass >> 1 == 3;
                float *px = pass >> 1 == 1 ? NULL : x + shift + 1;
                float *pp = pass >> 1 == 2 ? NULL : pdf + shift + 1;
                const float *in = inplace ? px : u + shift;
                int same = 1;
                for (size_t i = 0; i < count + 8; i++) x[i] = pdf[i] = -7.0f;
                if (inplace) memcpy(px, u + shift, count * sizeof *u);
                if (linear) mcs_pwl_sample_n((const mcs_pwl *)l.at, count, in, px, pp);
                else mcs_pwc_sample_n((const mcs_pwc *)c.at, count, in, px, pp);
                for (size_t i = 0; i < count; i++) {
                    const draw d = kinds[linear ? PWL : PWC].sample(linear ? l.at : c.at, u[shift + i]);
                    same &= (!px || px[i] == d.x) && (!pp || pp[i] == d.pdf);
                }
                const int kept =
                    x[shift] == -7.0f && pdf[shift] == -7.0f && x[shift + count + 1] == -7.0f && pdf[shift + count + 1] == -7.0f;
                CHECK(same, "n = %zu, shift %zu, pass %d: differs from scalar", count, shift, pass);
                CHECK(kept, "n = %zu, shift %zu, pass %d: written outside", count, shift, pass);
            }
        }
    }
    arena_free(&c);
    arena_free(&l);
}

/* ---- from a function ---- */

static float f_square(float x, void *ctx) { return *(float *)ctx * x * x; }
static float f_bump(float x, void *ctx) { return *(float *)ctx * expf(-50.0f * (x - 0.4f) * (x - 0.4f)); }
static float f_bad(float x, void *ctx) {
    (void)ctx;
    return x < 0.25f ? NAN : x < 0.5f ? -1.0f : x < 0.75f ? INFINITY : 2e38f;
}
static double exact_square(double x) { return x * x * x; }
static double exact_bump(double x) { return sqrt(3.14159265358979323846 / 50) / 2 * erf(sqrt(50) * (x - 0.4)); }

/* Gauss's rule with 4 points is off by 6e-10 h^9 max|f^(8)| a cell, at most 1e-26 here. What remains is rounding: of x, one part in
 * 2^24 of it, which moves f by x f'/f as much, and inside f: 3 eps, and for the bump 3 eps of its exponent and one of expf. */
static void test_build_fn(void) {
    enum { N = 1000 };
    static const struct {
        float (*f)(float, void *);
        double (*integral)(double);
    } fn[2] = {{f_square, exact_square}, {f_bump, exact_bump}};
    for (int j = 0; j < 2; j++) {
        float scale = j ? 1.0f : 3.0f;
        arena a = arena_make(mcs_pwc_bytes(N));
        mcs_pwc *t = (mcs_pwc *)a.at;
        const int rc = mcs_pwc_build_fn(t, a.bytes, fn[j].f, &scale, N);
        const double whole = fn[j].integral(1) - fn[j].integral(0);
        CHECK(rc == MCS_OK && t->bad == 0 && arena_intact(&a), "build returns %d", rc);
        for (uint32_t i = 0; i < N; i++) {
            const double p = (fn[j].integral((i + 1.0) / N) - fn[j].integral((double)i / N)) / whole;
            const double got = mcs_discrete_pmf(t, i);
            const double x = (i + 0.5) / N;
            const double d = fabs(x - 0.4);
            const double roundings = j ? 6 + 100 * d * x + 150 * d * d : 6;
            CHECK(fabs(got - p) <= roundings * eps * p + (2 + N * p) * quantum, "function %d, cell %u: %g, not %g", j, i, got, p);
        }
        arena_free(&a);
    }
    {
        arena a = arena_make(mcs_pwc_bytes(16));
        mcs_pwc *t = (mcs_pwc *)a.at;
        const int rc = mcs_pwc_build_fn(t, a.bytes, f_bad, NULL, 16);
        CHECK(rc == MCS_OK && t->bad == 12, "build returns %d, %llu bad", rc, pwc_bad(t));
        for (uint32_t i = 0; i < 16;
             i++) { /* an infinite one weighs FLT_MAX; 8 cells have one integer each before the rest is shared */
            const double w = i < 8 ? 0 : i < 12 ? (double)FLT_MAX : (double)2e38f;
            const double p = w / (4 * ((double)FLT_MAX + (double)2e38f));
            CHECK(fabs(mcs_discrete_pmf(t, i) - p) <= eps * p + (i < 8 ? 0 : 2 + 8 * p) * quantum, "cell %u: %g, not %g", i,
                  (double)mcs_discrete_pmf(t, i), p);
        }
        CHECK(mcs_pwc_build_fn(t, a.bytes, NULL, NULL, 16) == MCS_ERR_ARG, "no function");
        CHECK(mcs_pwc_build_fn(NULL, a.bytes, f_bad, NULL, 16) == MCS_ERR_ARG, "no memory");
        CHECK(mcs_pwc_build_fn(t, a.bytes - 1, f_bad, NULL, 16) == MCS_ERR_MEMORY, "too little memory");
        CHECK(arena_intact(&a), "written outside");
        arena_free(&a);
    }
}

/* Four points are exact up to degree 7. In float 8 x^7 is off by 7 eps from x and 6 from products, 1 more from the sum and one from
 * the mean: 15 eps = 9e-7 of a mean. A probability takes the share of the other cell, 1/4 or 3/4, of both errors; where that is
 * 3/4, 8 x^7 is below 1/16 and its own error 3 eps. */
static float f_seven(float x, void *ctx) {
    (void)ctx;
    return 1.0f + 8.0f * (x * x * x) * (x * x * x) * x;
}
static double exact_seven(double x) { return x + pow(x, 8); }
static void test_degree_seven(void) {
    for (uint32_t n = 1; n <= 2; n++) {
        arena a = arena_make(mcs_pwc_bytes(n));
        mcs_pwc *t = (mcs_pwc *)a.at;
        CHECK(mcs_pwc_build_fn(t, a.bytes, f_seven, NULL, n) == MCS_OK, "build");
        CHECK(fabs(t->total / n / 2 - 1) <= 1e-6, "%u cells: integral %.9g, not 2", n, t->total / n);
        for (uint32_t i = 0; i < n; i++) {
            const double p = (exact_seven((i + 1.0) / n) - exact_seven((double)i / n)) / 2;
            const double got = mcs_discrete_pmf(t, i);
            CHECK(fabs(got - p) <= 1e-6 * p, "%u cells, cell %u: %.9g, not %.9g", n, i, got, p);
        }
        arena_free(&a);
    }
}

/* ---- bad input, memory, relocation ---- */

static void test_errors(const kind *k) {
    const uint32_t n = 100;
    const uint32_t many[] = {0xffffffffu, 0xfffffffeu, 0x80000000u, 0x7fffffffu, 0x10000000u, 0x0fffffffu};
    arena a = arena_make(k->bytes(n) + 8);
    load(&sets[RAMP], 1);
    CHECK(k->build(NULL, a.bytes, weight, n) == MCS_ERR_ARG, "no memory");
    CHECK(k->build(a.at, a.bytes, NULL, n) == MCS_ERR_ARG, "no weights");
    CHECK(k->build(a.at, a.bytes, weight, 0) == MCS_ERR_SIZE, "n = 0");
    CHECK(k->build(a.at + 1, a.bytes - 8, weight, n) == MCS_ERR_ARG, "memory off by 1");
    CHECK(k->build(a.at + 4, a.bytes - 8, weight, n) == MCS_ERR_ARG, "memory off by 4");
    for (size_t i = 0; i < k->bytes(n); i += i < 80 || i + 9 > k->bytes(n) ? 1 : 7) {
        const int rc = k->build(a.at, i, weight, n);
        CHECK(rc == MCS_ERR_MEMORY, "%zu of %zu bytes: %d", i, k->bytes(n), rc);
    }
    for (size_t i = 0; i < sizeof many / sizeof *many; i++) {
        const size_t bytes = k->bytes(many[i]);
        const int rc = k->build(a.at, a.bytes, weight, many[i]);
        CHECK(rc == MCS_ERR_SIZE || rc == MCS_ERR_MEMORY, "n = %u: %d", many[i], rc);
        CHECK(bytes == 0 || bytes / 4 >= many[i], "n = %u: %zu bytes", many[i], bytes);
    }
    CHECK(k->build(a.at, SIZE_MAX, weight, 0xffffffffu) == MCS_ERR_SIZE, "n = 2^32 - 1 is refused whatever the memory");
    CHECK(k->bytes(0) == 0, "bytes(0) = %zu", k->bytes(0));
    CHECK(untouched(a.at, a.bytes) && arena_intact(&a), "a refused build wrote");
    arena_free(&a);
}

/* Bad entries are 0, but +infinity is FLT_MAX: the table is that of such a list. */
static void test_bad_weights(const kind *k) {
    const float inf = INFINITY;
    const float nothing[5] = {NAN, -1, -inf, -FLT_MAX, -FLT_MIN};
    const uint32_t n = 40;
    arena a = arena_make(k->bytes(n));
    arena b = arena_make(k->bytes(n));
    static float clean[41];
    int rc;
    for (uint32_t suns = 0; suns < 2; suns++) {
        uint32_t bad = 0;
        for (uint32_t i = 0; i < n + k->extra; i++) {
            weight[i] = clean[i] = hash01(i + 100);
            if (i % 4 == 1) {
                weight[i] = nothing[i / 4 % 5];
                clean[i] = 0;
                bad++;
            }
            if (suns && i % 8 == 2) {
                weight[i] = inf;
                clean[i] = FLT_MAX;
                bad++;
            }
        }
        rc = k->build(a.at, a.bytes, weight, n);
        CHECK(rc == MCS_OK && k->bad(a.at) == bad, "build returns %d, %llu bad, not %u", rc, k->bad(a.at), bad);
        rc = k->build(b.at, b.bytes, clean, n);
        CHECK(rc == MCS_OK && k->bad(b.at) == 0 && k->total(a.at) == k->total(b.at) && k->total(a.at) <= n * (double)FLT_MAX,
              "build returns %d, %llu bad, total %g", rc, k->bad(b.at), k->total(a.at));
        for (int j = 0; j < US; j += 7) {
            const draw c = k->sample(a.at, us[j]);
            const draw d = k->sample(b.at, us[j]);
            CHECK(c.i == d.i && c.x == d.x && c.pdf == d.pdf && c.rest == d.rest, "u = %a: not as with clean entries",
                  (double)us[j]);
        }
    }
    for (uint32_t i = 0; i < n + k->extra; i++) weight[i] = inf;
    rc = k->build(a.at, a.bytes, weight, n);
    CHECK(rc == MCS_OK && k->bad(a.at) == n + k->extra && fabs(k->total(a.at) / (n * (double)FLT_MAX) - 1) <= 1e-12,
          "all infinite: build returns %d, %llu bad, total %g", rc, k->bad(a.at), k->total(a.at));
    for (uint32_t i = 0; i < 1 << 12; i++) {
        const draw d = k->sample(a.at, (float)i * 0x1p-12f);
        const double want = k == &kinds[DISCRETE] || k == &kinds[ALIAS] ? 1.0 / n : 1.0;
        CHECK(fabs(d.pdf - want) <= (2 * eps + 2 * n * quantum) * want, "all infinite: u = %u/2^12: density %g", i, (double)d.pdf);
    }
    for (int j = 0; j < 3; j++) {
        const float fill[3] = {0, -0.0f, NAN};
        for (uint32_t i = 0; i < n + k->extra; i++) weight[i] = fill[j];
        rc = k->build(a.at, a.bytes, weight, n);
        CHECK(rc == MCS_UNIFORM && arena_intact(&a), "all %g: build returns %d", (double)fill[j], rc);
        CHECK(k->bad(a.at) == (j == 2 ? n + k->extra : 0) && k->total(a.at) == 0, "all %g: %llu bad, total %g", (double)fill[j],
              k->bad(a.at), k->total(a.at));
        for (uint32_t i = 0; i < n; i++) hits[i] = 0;
        for (uint32_t i = 0; i < 1 << 16; i++) {
            const draw d = k->sample(a.at, (float)i * 0x1p-16f);
            const double want = k == &kinds[DISCRETE] || k == &kinds[ALIAS] ? 1.0 / n : 1.0;
            CHECK(fabs(d.pdf - want) <= 2 * eps * want + n * quantum && d.i < n, "u = %u/2^16: entry %u, density %g", i, d.i,
                  (double)d.pdf);
            if (d.i < n) hits[d.i]++;
        }
        for (uint32_t i = 0; i < n; i++) CHECK(fabs(hits[i] - 65536.0 / n) <= 2, "entry %u: %u draws of 65536", i, hits[i]);
    }
    arena_free(&a);
    arena_free(&b);
}

static void test_bad_u(const kind *k) {
    const float u[] = {1.0f, -1e-45f, -0.5f, 1.5f, 1e30f, FLT_MAX, INFINITY, -INFINITY, NAN};
    load(&sets[SEVEN], k->extra);
    arena a = build(k, 7, NULL);
    for (size_t i = 0; i < sizeof u / sizeof *u; i++) {
        const draw d = k->sample(a.at, u[i]);
        CHECK(d.pdf == 0 && d.i < 7 && d.x >= 0 && d.x <= 1 && d.rest >= 0 && d.rest < 1,
              "u = %g: entry %u, x = %g, density %g, rest %g", (double)u[i], d.i, (double)d.x, (double)d.pdf, (double)d.rest);
        if (k == &kinds[PWC] && u[i] != 1.0f) {
            const float p = mcs_pwc_pdf((const mcs_pwc *)a.at, u[i]);
            const float v = mcs_pwc_invert((const mcs_pwc *)a.at, u[i]);
            CHECK(p == 0 && v >= 0 && v < 1, "x = %g: pdf %g, invert %g", (double)u[i], (double)p, (double)v);
        }
        if (k == &kinds[PWL] && u[i] != 1.0f) {
            const float p = mcs_pwl_pdf((const mcs_pwl *)a.at, u[i]);
            const float v = mcs_pwl_invert((const mcs_pwl *)a.at, u[i]);
            CHECK(p == 0 && v >= 0 && v < 1, "x = %g: pdf %g, invert %g", (double)u[i], (double)p, (double)v);
        }
    }
    arena_free(&a);
}

static void test_relocation(const kind *k) {
    static draw before[US];
    load(&sets[PEAK], k->extra);
    arena a = build(k, sets[PEAK].n, NULL);
    for (int j = 0; j < US; j++) before[j] = k->sample(a.at, us[j]);
    arena b = arena_make(a.bytes);
    memcpy(b.at, a.at, a.bytes);
    memset(a.at, 0xff, a.bytes);
    for (int j = 0; j < US; j++) {
        const draw c = before[j];
        const draw d = k->sample(b.at, us[j]);
        CHECK(c.i == d.i && c.x == d.x && c.pdf == d.pdf && c.rest == d.rest, "u = %a: the copy differs", (double)us[j]);
    }
    arena_free(&a);
    arena_free(&b);
}

/* The product of 64 random bits and n, schoolbook in base 2^16: above bit 64 the column, the 32 bits below it the place in it. Half
 * the pairs lie at a border of columns, where the last of b2 decides. The rest is one quotient, rounded to float: eps of it. */
static void test_alias_bits(uint32_t n) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 157);
    arena a = arena_make(mcs_alias_bytes(n));
    const mcs_alias *t = (const mcs_alias *)a.at;
    for (uint32_t i = 0; i < n; i++) weight[i] = 0.1f + hash01(i);
    CHECK(mcs_alias_build((mcs_alias *)a.at, a.bytes, weight, n) == MCS_OK, "build");
    for (uint32_t i = 0; i < 8000; i++) {
        const uint32_t r1 = mcs_pcg32_next(&r);
        const uint32_t r2 = mcs_pcg32_next(&r);
        const uint64_t b = i & 1 ? UINT64_MAX / n * (r1 % (n + 1)) + r2 % (2 * n) : (uint64_t)r1 << 32 | r2;
        const mcs_pick c = mcs_alias_sample_bits(t, (uint32_t)(b >> 32), (uint32_t)b);
        uint64_t carry = 0;
        uint64_t digits = 0;
        for (int d = 0; d < 4; d++) {
            carry += (b >> 16 * d & 0xffff) * n;
            digits = digits >> 16 | (carry & 0xffff) << 48;
            carry >>= 16;
        }
        const mcsi_column *k = mcsi_columns(t) + carry;
        const double place = (double)(digits >> 32) / 2;
        const double kept = k->cut;
        const double rest = place < kept ? place / kept : (place - kept) / (0x1p31 - kept);
        CHECK(c.i == (place < kept ? carry : k->alias), "n = %u, bits %016llx: entry %u, column %llu", n, (unsigned long long)b,
              c.i, (unsigned long long)carry);
        CHECK(fabs(c.u - rest) <= 1.0001 * eps * rest, "n = %u, bits %016llx: rest %a, not %a", n, (unsigned long long)b,
              (double)c.u, rest);
    }
    arena_free(&a);
}

/* The table's integers, of entries below 2^-7, where a float pmf holds them exactly. */
static void load_integers(const mcs_pwc *t, uint32_t n, uint32_t *cdf) {
    cdf[0] = 0;
    for (uint32_t i = 0; i < n; i++) cdf[i + 1] = cdf[i] + (uint32_t)(mcs_discrete_pmf(t, i) * 0x1p31f);
    CHECK(cdf[n] == 1u << 31, "pmf adds up to %u of 2^31", cdf[n]);
}
static uint32_t *integers_of(uint32_t n) {
    uint32_t *const cdf = malloc((n + 1) * sizeof *cdf);
    if (!cdf) exit(puts("no memory"));
    return cdf;
}

/* 64 bits over 2^33 are a place among 2^31 shares: found by bisection, and the rest within the entry, in long double, whose 64
 * digits hold the difference. Half the bits lie at a border of entries. The rest is rounded twice, as double and as float. x of
 * pwc is (i + rest)/n, rounded to double and to float and moved by a float into its cell. */
static void test_discrete_bits(uint32_t n) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 163);
    arena a = arena_make(mcs_pwc_bytes(n));
    arena b = arena_make(mcs_pwl_bytes(n));
    const mcs_pwc *t = (const mcs_pwc *)a.at;
    const mcs_pwl *l = (const mcs_pwl *)b.at;
    uint32_t *const cdf = integers_of(n);
    for (uint32_t i = 0; i <= n; i++) weight[i] = i % 5 ? 0.1f + hash01(i) : 0;
    CHECK(mcs_pwc_build((mcs_pwc *)a.at, a.bytes, weight, n) == MCS_OK &&
              mcs_pwl_build((mcs_pwl *)b.at, b.bytes, weight, n) == MCS_OK,
          "build");
    load_integers(t, n, cdf);
    for (uint32_t i = 0; i < 100000; i++) {
        const uint32_t r1 = mcs_pcg32_next(&r);
        const uint32_t r2 = mcs_pcg32_next(&r);
        const uint64_t v = i & 1 ? ((uint64_t)cdf[r1 % (n + 1)] << 33) + r2 % 5 - 2 : (uint64_t)r1 << 32 | r2;
        const mcs_pick d = mcs_discrete_sample_bits(t, (uint32_t)(v >> 32), (uint32_t)v);
        const mcs_cell c = mcs_pwc_sample_bits(t, (uint32_t)(v >> 32), (uint32_t)v);
        uint32_t lo = 0;
        uint32_t hi = n;
        while (hi - lo > 1) {
            const uint32_t k = lo + (hi - lo) / 2;
            if (cdf[k] <= v >> 33) lo = k;
            else hi = k;
        }
        const ld rest = (ld)(v - ((uint64_t)cdf[lo] << 33)) / ((cdf[lo + 1] - cdf[lo]) * 0x1p33L);
        const ld x = (lo + rest) / n;
        CHECK(d.i == lo && c.i == lo, "n = %u, bits %016llx: entries %u and %u, not %u", n, (unsigned long long)v, d.i, c.i, lo);
        CHECK(d.pmf == mcs_discrete_pmf(t, lo) && c.pdf == mcs_pwc_pdf(t, c.x) && weight[lo] > 0,
              "n = %u, bits %016llx: pmf %g, pdf %g", n, (unsigned long long)v, (double)d.pmf, (double)c.pdf);
        CHECK(d.u >= 0 && d.u < 1 && fabs((double)(d.u - rest)) <= 1.0001 * eps * (double)rest,
              "n = %u, bits %016llx: rest %a, not %a", n, (unsigned long long)v, (double)d.u, (double)rest);
        CHECK(c.x >= 0 && c.x < 1 && fabs((double)(c.x - x)) <= 2.0001 * eps * (double)x, "n = %u, bits %016llx: x %a, not %a", n,
              (unsigned long long)v, (double)c.x, (double)x);
    }
    for (uint32_t i = 0; i < 100000;
         i++) { /* the forms with a float, of which test_pwc and test_pwl know more, are those of its bits */
        const uint32_t b1 = mcs_pcg32_next(&r) & 0xffffff00u >> (i & 7);
        const float u = (float)(b1 >> 1) * 0x1p-31f;
        const mcs_pick d = mcs_discrete_sample(t, u);
        const mcs_pick e = mcs_discrete_sample_bits(t, b1, 0);
        const mcs_cell c = mcs_pwc_sample(t, u);
        const mcs_cell f = mcs_pwc_sample_bits(t, b1, 0);
        const mcs_cell g = mcs_pwl_sample(l, u);
        const mcs_cell h = mcs_pwl_sample_bits(l, b1, 0);
        CHECK(d.i == e.i && d.u == e.u && d.pmf == e.pmf && c.i == f.i && c.x == f.x && c.pdf == f.pdf && g.i == h.i &&
                  g.x == h.x && g.pdf == h.pdf,
              "n = %u, u = %a: other draws by bits", n, (double)u);
    }
    for (uint32_t k = 0; k < 2; k++) { /* one entry that holds all 2^64, up to the last; of pwl, with no density there */
        const float one[2] = {1, k ? 0.0f : 1.0f};
        CHECK(mcs_pwl_build((mcs_pwl *)b.at, b.bytes, one, 1) == MCS_OK, "build");
        const mcs_cell c = mcs_pwl_sample_bits(l, 0xffffffffu, 0xffffffffu);
        CHECK(c.x == 0x0.ffffffp0f && c.pdf >= 0, "the last bits: x %a, pdf %g", (double)c.x, (double)c.pdf);
    }
    CHECK(mcs_pwc_build((mcs_pwc *)a.at, a.bytes, weight + 1, 1) == MCS_OK, "build");
    CHECK(mcs_discrete_sample_bits(t, 0xffffffffu, 0xffffffffu).u == 0x0.ffffffp0f, "the last bits: rest");
    CHECK(mcs_pwc_sample_bits(t, 0xffffffffu, 0xffffffffu).x == 0x0.ffffffp0f, "the last bits: x");
    arena_free(&a);
    arena_free(&b);
    free(cdf);
}

/* The u to reuse has its digits at a million entries: of draws from one entry, 64 cells of it, and 64 cells of what is behind
 * the 14th digit, are alike; hardly any number comes twice: of 2^14 floats of [0,1) 5 pairs do, by chance, 40 of them never.
 * With the 24 bits of a float u an entry has 16 numbers. */
static void test_reused_digits(void) {
    enum { N = 1000000, DRAWS = 1 << 14, ENTRIES = 20 };
    static float rest[DRAWS];
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 167);
    arena a = arena_make(mcs_pwc_bytes(N));
    const mcs_pwc *t = (const mcs_pwc *)a.at;
    uint32_t *const cdf = integers_of(N);
    uint32_t i;
    for (i = 0; i < N; i++) weight[i] = 0.1f + hash01(i);
    CHECK(mcs_pwc_build((mcs_pwc *)a.at, a.bytes, weight, N) == MCS_OK, "build");
    load_integers(t, N, cdf);
    for (uint32_t j = 0; j < ENTRIES; j++) {
        double cells[64] = {0};
        double digits[64] = {0};
        i = mcs_pcg32_next(&r) % N;
        uint32_t equal = 0;
        for (uint32_t k = 0; k < DRAWS; k++) {
            const uint64_t place = (uint64_t)mcs_pcg32_next(&r) << 32 | mcs_pcg32_next(&r);
            const uint64_t v = ((uint64_t)cdf[i] << 33) + (uint64_t)((ld)place * 0x1p-64L * ((cdf[i + 1] - cdf[i]) * 0x1p33L));
            const mcs_pick d = mcs_discrete_sample_bits(t, (uint32_t)(v >> 32), (uint32_t)v);
            const double fine = (double)d.u * 0x1p14;
            CHECK(d.i == i, "entry %u drawn, not %u", d.i, i);
            cells[(int)((double)d.u * 64)] += 1;
            digits[(int)((fine - floor(fine)) * 64)] += 1;
            rest[k] = d.u;
        }
        qsort(rest, DRAWS, sizeof *rest, by_value);
        for (uint32_t k = 1; k < DRAWS; k++) equal += rest[k] == rest[k - 1];
        double expected[64];
        for (uint32_t k = 0; k < 64; k++) expected[k] = DRAWS / 64;
        const double p = chi2_test(cells, expected, 64, NULL, NULL);
        const double q = chi2_test(digits, expected, 64, NULL, NULL);
        CHECK(p >= level && q >= level, "entry %u: chi-square of the rest p = %g, of its last digits %g", i, p, q);
        CHECK(equal <= 40, "entry %u: %u of %d numbers come again", i, equal, DRAWS);
    }
    arena_free(&a);
    free(cdf);
}

/* The same bytes whatever the memory held, for every number of entries up to 70 and some others, dark lists among them. */
static void test_same_bytes(const kind *k) {
    const uint32_t many[] = {127, 128, 129, 1000, 4095, 4096, 4097, 65537};
    for (uint32_t c = 0; c < 70 + sizeof many / sizeof *many; c++) {
        const uint32_t n = c < 70 ? c + 1 : many[c - 70];
        for (int style = 0; style < 3; style++) {
            for (uint32_t i = 0; i < n + k->extra; i++) weight[i] = style == 0 ? hash01(i) : style == 1 && i % 3 == 0 ? 1e30f : 0;
            if (style == 1) weight[n / 2] = NAN;
            arena a[ARENA_PASTS];
            for (int past = 0; past < ARENA_PASTS; past++) {
                a[past] = arena_make(k->bytes(n));
                arena_past(&a[past], past);
                const int rc = k->build(a[past].at, a[past].bytes, weight, n);
                CHECK(rc >= 0 && arena_intact(&a[past]), "n = %u: build returns %d", n, rc);
                CHECK(arena_differ(&a[0], &a[past]) == a[0].bytes, "n = %u, list %d: byte %zu of %zu is another one", n, style,
                      arena_differ(&a[0], &a[past]), a[0].bytes);
            }
            for (int past = 0; past < ARENA_PASTS; past++) arena_free(&a[past]);
        }
    }
}
static int from_curve(void *t, size_t bytes, const float *w, uint32_t n) {
    float scale = 2 + w[0];
    return mcs_pwc_build_fn((mcs_pwc *)t, bytes, f_square, &scale, n);
}
static const kind curve = {"pwc from a function", 0, pwc_bytes, from_curve, pwc_sample, pwc_total, pwc_bad};

/* Tables of more entries than a float u can tell apart: the mean of 1/(n pmf) over draws is 1 when frequencies are the pmf. Half
 * the weights are 0.01, half 1.99: the variance of one draw is 0.5/0.01 + 0.5/1.99 - 1 = 49.3. Four standard errors. */
static void test_long(const kind *k, uint32_t n) {
    enum { DRAWS = 1 << 20 };
    const size_t bytes = k->bytes(n);
    float *const w = malloc(n * sizeof *w);
    void *const t = malloc(bytes);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 151);
    double total = 0;
    int wrong = 0;
    if (!w || !t) exit(puts("no memory"));
    for (uint32_t i = 0; i < n; i++) w[i] = i & 1 ? 1.99f : 0.01f;
    CHECK(k->build(t, bytes, w, n) == MCS_OK, "build");
    for (uint32_t i = 0; i <= DRAWS; i++) {
        const uint32_t b1 = i < DRAWS ? mcs_pcg32_next(&rng) : 0xffffffffu;
        const uint32_t b2 = i < DRAWS ? mcs_pcg32_next(&rng) : 0xffffffffu;
        const mcs_pick c = k == &kinds[ALIAS] ? mcs_alias_sample_bits((const mcs_alias *)t, b1, b2)
                                              : mcs_discrete_sample_bits((const mcs_pwc *)t, b1, b2);
        const float pmf = k == &kinds[ALIAS] ? mcs_alias_pmf((const mcs_alias *)t, c.i) : mcs_discrete_pmf((const mcs_pwc *)t, c.i);
        if (i < DRAWS) total += 1 / ((double)n * (double)c.pmf);
        wrong += !(c.i < n && c.u >= 0 && c.u < 1 && c.pmf == pmf);
        if (k == &kinds[PWC]) {
            const mcs_cell cell = mcs_pwc_sample_bits((const mcs_pwc *)t, b1, b2);
            wrong += !(cell.i == c.i && cell.pdf == mcs_pwc_pdf((const mcs_pwc *)t, cell.x));
        }
    }
    CHECK(wrong == 0, "%d wrong picks", wrong);
    CHECK(fabs(total / DRAWS - 1) <= 4 * sqrt(49.3 / DRAWS), "n = %u: mean of 1/(n pmf) is %g", n, total / DRAWS);
    free(w);
    free(t);
}
/* n 2^31 above 2^54, where the room for shares, n 2^31 - n, rounds up as double: shares must still add up. */
static void test_huge_alias(void) {
    const uint32_t n = 8388610;
    const size_t bytes = mcs_alias_bytes(n);
    float *const w = malloc(n * sizeof *w);
    mcs_alias *const t = malloc(bytes);
    double total = 0;
    if (!w || !t) exit(puts("no memory"));
    for (uint32_t i = 0; i < n; i++) w[i] = i ? 1e-30f : 1e30f;
    CHECK(mcs_alias_build(t, bytes, w, n) == MCS_OK, "build");
    for (uint32_t i = 0; i < n; i++) total += (double)mcs_alias_pmf(t, i);
    CHECK(fabs(total - 1) <= 0x1p-20, "probabilities add up to %g", total);
    free(w);
    free(t);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    make_us();
    mcst_group("pwc and discrete");
    test_pwc();
    if (mcst_case("rest of u")) test_rest(&kinds[DISCRETE]);
    if (mcst_case("1000 entries by 64 bits, exactly")) test_discrete_bits(1000);
    if (mcst_case("a million entries by 64 bits, exactly")) test_discrete_bits(1000000);
    if (mcst_case("discrete, 1000001 entries by 64 bits")) test_long(&kinds[DISCRETE], 1000001);
    if (mcst_case("pwc, 1000001 cells by 64 bits")) test_long(&kinds[PWC], 1000001);
    if (mcst_case("digits of the rest at a million entries")) test_reused_digits();
    mcst_group("pwl");
    test_pwl();
    mcst_group("alias");
    test_alias();
    if (mcst_case("rest of u")) test_rest(&kinds[ALIAS]);
    if (mcst_case("3 entries by 64 bits, exactly")) test_alias_bits(3);
    if (mcst_case("1000 entries by 64 bits, exactly")) test_alias_bits(1000);
    if (mcst_case("2^18 entries by 64 bits")) test_long(&kinds[ALIAS], 1u << 18);
    if (mcst_case("1000001 entries by 64 bits")) test_long(&kinds[ALIAS], 1000001);
    if (mcst_case("8388610 entries")) test_huge_alias();
    if (mcst_case("last of more cells than floats")) CHECK(mcsi_in_cell((1u << 25) - 1, 0.9, 1u << 25) < 1, "x is 1");
    mcst_group("table batches");
    if (mcst_case("n = 0..67, 1000, 4099, shifted, in place, NULL outputs")) test_batch();
    mcst_group("pwc from a function");
    if (mcst_case("against exact integrals; bad values; errors")) test_build_fn();
    if (mcst_case("exact for degree 7")) test_degree_seven();
    mcst_group("table memory and bad input");
    for (int k = 0; k < 4; k++) {
        if (k != DISCRETE && mcst_case("%s: refused builds", kinds[k].name)) test_errors(&kinds[k]);
        if (mcst_case("%s: bad and zero weights", kinds[k].name)) test_bad_weights(&kinds[k]);
        if (mcst_case("%s: u outside [0,1)", kinds[k].name)) test_bad_u(&kinds[k]);
        if (mcst_case("%s: moved by memcpy", kinds[k].name)) test_relocation(&kinds[k]);
        if (k != DISCRETE && mcst_case("%s: the same bytes in any memory", kinds[k].name)) test_same_bytes(&kinds[k]);
    }
    if (mcst_case("%s: the same bytes in any memory", curve.name)) test_same_bytes(&curve);
    return mcst_finish();
}
