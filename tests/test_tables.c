/* Tables: piecewise constant, discrete, piecewise linear, alias. The truth is the weights themselves, summed in long
 * double. */
#include "stats.h"
#include "table_kinds.h"

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

/* All 2^24 u. An interval [c, c + p) holds more than p 2^24 - 1 and fewer than p 2^24 + 1 of them; the float p is off
 * by eps p. */
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

/* x is rounded three times at most (cell plus fraction, reciprocal, product) and moved one float to stay in its cell.
 */
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
        CHECK(fabs((double)(at - 0.5L)) <= 0.5 + 2 * eps * n, "u = %a: x = %a is not in cell %u", (double)u,
              (double)c.x, c.i);
        double err = fabs((double)(cumulative[c.i] + mass[c.i] * at - u));
        CHECK(err <= slack + p * n * dx + eps, "u = %a: C(x) is off by %g", (double)u, err);
        err = fabs((double)back - u);
        CHECK(back >= 0 && back < 1 && err <= p * n * dx + 2 * eps, "u = %a: invert %a", (double)u, (double)back);
        CHECK(d.i == c.i && d.pmf == mcs_discrete_pmf(t, d.i), "u = %a: discrete %u, %g", (double)u, d.i,
              (double)d.pmf);
        const ld below = cumulative[d.i] + (ld)d.u * mass[d.i];
        CHECK(d.u >= 0 && d.u < 1 && fabs((double)(below - u)) <= 2 * slack + 2 * eps * (p + u),
              "u = %a: rest %a of entry %u", (double)u, (double)d.u, d.i);
        last = c.x;
    }
}

/* Counts of many draws against n equal groups of entries (64 at most), expectations by the weights, not by the table.
 */
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
        for (uint32_t g = 0; g < groups; g++)
            CHECK(expected[g] >= 5 || observed[g] <= 40, "group %u: %g draws", g, observed[g]);
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

/* With vertex values f, g of the cell and the mean value m of all cells: density lerp(f, g, at)/m, slope n (g - f)/m
 * per length. */
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
        CHECK(fabs((double)(at - 0.5L)) <= 0.5 + 2 * eps * n, "u = %a: x = %a is not in cell %u", (double)u,
              (double)c.x, c.i);
        CHECK(fabs((double)(again - want)) <= relative * near + slope * eps, "u = %a: pdf(%a) = %g, not %g", (double)u,
              (double)c.x, (double)again, (double)want);
        CHECK(fabs((double)(c.pdf - want)) <= relative * near + slope * dx, "u = %a: returned pdf %g at %a, not %g",
              (double)u, (double)c.pdf, (double)c.x, (double)want);
        const double err = fabs((double)(cumulative[c.i] + (f * at + (g - f) * at * at / 2) / sum - u));
        CHECK(err <= slack + near * dx + eps, "u = %a: C(x) is off by %g", (double)u, err);
        CHECK(back >= 0 && back < 1 && fabs((double)back - u) <= near * dx + 4 * eps, "u = %a: invert %a", (double)u,
              (double)back);
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
        CHECK(fabs(hits[i] - p * GRID) <= 1 + 2 * slack_of() * GRID, "cell %u: %u of 2^24 draws, mass %a", i, hits[i],
              p);
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
                CHECK(fabs((double)c.x - l.x) <= 4 * eps, "u = %a: %a, not %a", (double)us[k], (double)c.x,
                      (double)l.x);
                CHECK(fabs((double)c.pdf - l.pdf) <= 8 * eps * l.pdf + 2 * 4 * eps, "u = %a: pdf %g, not %g",
                      (double)us[k], (double)c.pdf, (double)l.pdf);
            }
            arena_free(&a);
        }
    }
}

/* ---- alias: integers over n 2^31, bounded as above; their cumulative sums are doubles, rounded three times at either
 * end ---- */

/* Of n columns an entry holds at most n + 1 intervals of u (its own and parts of others), each counted to within one of
 * 2^24. */
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
            CHECK(fabs((double)(p - mass[i])) <= (2 + lit * p) * quantum / n + 6 * 0x1p-53 + eps * p,
                  "entry %u: pmf %g, not %g", i, p, (double)mass[i]);
        }
        CHECK(fabs(psum - 1) <= eps, "pmf sums to 1 + %g", psum - 1);
        CHECK(mcs_alias_pmf((const mcs_alias *)a.at, n) == 0, "pmf past the end");
        for (int k = 0; k < US; k++) {
            const mcs_pick c = mcs_alias_sample((const mcs_alias *)a.at, us[k]);
            CHECK(c.i < n && weight[c.i] > 0 && c.u >= 0 && c.u < 1, "u = %a: entry %u, rest %a", (double)us[k], c.i,
                  (double)c.u);
            CHECK(c.pmf == mcs_alias_pmf((const mcs_alias *)a.at, c.i), "u = %a: returned pmf %g", (double)us[k],
                  (double)c.pmf);
        }
        if (sets[s].every_u >> ALIAS & 1) sweep_alias((const mcs_alias *)a.at, n);
        else chi_square(&kinds[ALIAS], a.at, n);
        arena_free(&a);
    }
}

/* The rest of u is uniform again, within each entry and over all: 64 cells by entry, for entries that 2^24 u resolve.
 */
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

/* The product of 64 random bits and n, schoolbook in base 2^16: above bit 64 the column, the 32 bits below it the place
 * in it. Half the pairs lie at a border of columns, where the last of b2 decides. The rest is one quotient, rounded to
 * float: eps of it. */
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
        CHECK(c.i == (place < kept ? carry : k->alias), "n = %u, bits %016llx: entry %u, column %llu", n,
              (unsigned long long)b, c.i, (unsigned long long)carry);
        CHECK(fabs(c.u - rest) <= 1.0001 * eps * rest, "n = %u, bits %016llx: rest %a, not %a", n,
              (unsigned long long)b, (double)c.u, rest);
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

/* The forms with a float, of which test_pwc and test_pwl know more, are those of its bits. */
static void check_forms_of_bits(const mcs_pwc *t, const mcs_pwl *l, uint32_t n, mcs_pcg32 *r) {
    for (uint32_t i = 0; i < 100000; i++) {
        const uint32_t b1 = mcs_pcg32_next(r) & 0xffffff00u >> (i & 7);
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
}
/* Tables of one entry that holds all 2^64, up to the last. */
static void check_last_bits(const arena *a, const arena *b) {
    const mcs_pwc *t = (const mcs_pwc *)a->at;
    const mcs_pwl *l = (const mcs_pwl *)b->at;
    for (uint32_t k = 0; k < 2; k++) { /* with no density there in the second */
        const float one[2] = {1, k ? 0.0f : 1.0f};
        CHECK(mcs_pwl_build((mcs_pwl *)b->at, b->bytes, one, 1) == MCS_OK, "build");
        const mcs_cell c = mcs_pwl_sample_bits(l, 0xffffffffu, 0xffffffffu);
        CHECK(c.x == 0x0.ffffffp0f && c.pdf >= 0, "the last bits: x %a, pdf %g", (double)c.x, (double)c.pdf);
    }
    CHECK(mcs_pwc_build((mcs_pwc *)a->at, a->bytes, weight + 1, 1) == MCS_OK, "build");
    CHECK(mcs_discrete_sample_bits(t, 0xffffffffu, 0xffffffffu).u == 0x0.ffffffp0f, "the last bits: rest");
    CHECK(mcs_pwc_sample_bits(t, 0xffffffffu, 0xffffffffu).x == 0x0.ffffffp0f, "the last bits: x");
}

/* 64 bits over 2^33 are a place among 2^31 shares: found by bisection, and the rest within the entry, in long double,
 * whose 64 digits hold the difference. Half the bits lie at a border of entries. The rest is rounded twice, as double
 * and as float. x of pwc is (i + rest)/n, rounded to double and to float and moved by a float into its cell. */
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
        CHECK(d.i == lo && c.i == lo, "n = %u, bits %016llx: entries %u and %u, not %u", n, (unsigned long long)v, d.i,
              c.i, lo);
        CHECK(d.pmf == mcs_discrete_pmf(t, lo) && c.pdf == mcs_pwc_pdf(t, c.x) && weight[lo] > 0,
              "n = %u, bits %016llx: pmf %g, pdf %g", n, (unsigned long long)v, (double)d.pmf, (double)c.pdf);
        CHECK(d.u >= 0 && d.u < 1 && fabs((double)(d.u - rest)) <= 1.0001 * eps * (double)rest,
              "n = %u, bits %016llx: rest %a, not %a", n, (unsigned long long)v, (double)d.u, (double)rest);
        CHECK(c.x >= 0 && c.x < 1 && fabs((double)(c.x - x)) <= 2.0001 * eps * (double)x,
              "n = %u, bits %016llx: x %a, not %a", n, (unsigned long long)v, (double)c.x, (double)x);
    }
    check_forms_of_bits(t, l, n, &r);
    check_last_bits(&a, &b);
    arena_free(&a);
    arena_free(&b);
    free(cdf);
}

/* The u to reuse has its digits at a million entries: of draws from one entry, 64 cells of it, and 64 cells of what is
 * behind the 14th digit, are alike; hardly any number comes twice: of 2^14 floats of [0,1) 5 pairs do, by chance, 40 of
 * them never. With the 24 bits of a float u an entry has 16 numbers. */
static void test_reused_digits(void) {
    enum { N = 1000000, DRAWS = 1 << 14, ENTRIES = 20 };
    static float rest[DRAWS];
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 167);
    arena a = arena_make(mcs_pwc_bytes(N));
    const mcs_pwc *t = (const mcs_pwc *)a.at;
    uint32_t *const cdf = integers_of(N);
    for (uint32_t i = 0; i < N; i++) weight[i] = 0.1f + hash01(i);
    CHECK(mcs_pwc_build((mcs_pwc *)a.at, a.bytes, weight, N) == MCS_OK, "build");
    load_integers(t, N, cdf);
    for (uint32_t j = 0; j < ENTRIES; j++) {
        double cells[64] = {0};
        double digits[64] = {0};
        const uint32_t i = mcs_pcg32_next(&r) % N;
        uint32_t equal = 0;
        for (uint32_t k = 0; k < DRAWS; k++) {
            const uint64_t place = (uint64_t)mcs_pcg32_next(&r) << 32 | mcs_pcg32_next(&r);
            const uint64_t v =
                ((uint64_t)cdf[i] << 33) + (uint64_t)((ld)place * 0x1p-64L * ((cdf[i + 1] - cdf[i]) * 0x1p33L));
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

/* Tables of more entries than a float u can tell apart: the mean of 1/(n pmf) over draws is 1 when frequencies are the
 * pmf. Half the weights are 0.01, half 1.99: the variance of one draw is 0.5/0.01 + 0.5/1.99 - 1 = 49.3. Four standard
 * errors. */
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
        const float pmf =
            k == &kinds[ALIAS] ? mcs_alias_pmf((const mcs_alias *)t, c.i) : mcs_discrete_pmf((const mcs_pwc *)t, c.i);
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
    return mcst_finish();
}
