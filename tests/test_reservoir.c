/* Reservoirs: which candidate is kept, against the rules of the papers in long double and by chi-square; merged in any
 * order; estimates by resampling and by what is kept, without bias; those of k the same to the bit however candidates
 * are shared out; bad input. */
#include "mcs_test.h"
#include "mcsample.h"
#include "stats.h"
#include <float.h>
#include <math.h>

enum { CHI2_TESTS = 5 };
/* Standard errors within which all 14 means of this file are, but for once in 100 runs. */
static const double errors_off = 3.4;

/* 53 bits of a counter: what a caller gives. */
static double random_u(uint64_t run, uint64_t i) {
    const mcs_philox4 words = mcs_philox(mcst.seed, i, run);
    return ((double)words.v[0] + (double)(words.v[1] >> 11) * 0x1p-21) * 0x1p-32;
}
/* Over eight decades, one of eight is 0. */
static float random_weight(uint64_t run, uint64_t i) {
    const mcs_philox4 words = mcs_philox(~mcst.seed, i, run);
    return words.v[0] % 8 == 0 ? 0.0f : (float)exp(18 * (double)mcs_u01(words.v[1]) - 9);
}
static void frequencies(const double *count, const double *expected, int bins, const char *what) {
    CHECK(chi2_test(count, expected, (size_t)bins, NULL, NULL) >= sidak(0.01, CHI2_TESTS), "%s", what);
}
static void mean_is(const mcs_stat *s, double truth, const char *what) {
    const double off = fabs(s->mean - truth) / mcs_stat_error(s);
    CHECK(off <= errors_off, "%s: %g instead of %g, %.1f standard errors", what, s->mean, truth, off);
}

/* ---- one ---- */

/* Chao's rule: a candidate is kept with probability w over the sum so far. */
static void one_by_rule(void) {
    enum { RUNS = 200, MOST = 50 };
    if (!mcst_case("the last candidate whose u is below its share")) return;
    for (uint64_t run = 0; run < RUNS; run++) {
        mcs_reservoir r = {0, 0, 0};
        long double total = 0;
        uint32_t last = 0;
        for (uint32_t i = 1; i <= MOST; i++) {
            const float w = random_weight(run, i);
            const double u = random_u(run, i);
            total += (long double)w;
            const int below = w > 0 && (long double)u < (long double)w / total;
            if (below) last = i;
            CHECK(mcs_reservoir_add(&r, i, w, u) == below, "run %u, candidate %u", (unsigned)run, i);
        }
        CHECK(r.i == last && r.n == MOST && fabsl((long double)r.total / total - 1) < 1e-14L, "run %u", (unsigned)run);
        const long double weight = total / MOST / 3.5L;
        CHECK(fabsl((long double)mcs_reservoir_weight(&r, 3.5f) / weight - 1) <= 0x1.001p-24L, "weight");
    }
}

enum { PARTS = 4, EACH = 3, ALL = PARTS * EACH, DRAWS = 200000 };
static const float shares[ALL] = {1, 5, 0, 2.5f, 0.125f, 9, 0, 0, 0, 1e-3f, 4, 3};
static void expect_shares(double *expected) {
    double total = 0;
    for (int i = 0; i < ALL; i++) total += (double)shares[i];
    for (int i = 0; i < ALL; i++) expected[i] = DRAWS * (double)shares[i] / total;
}
static void one_by_weight(void) {
    double count[ALL] = {0};
    double expected[ALL];
    expect_shares(expected);
    if (!mcst_case("as often as its weight")) return;
    for (uint32_t run = 0; run < DRAWS; run++) {
        mcs_reservoir r = {0, 0, 0};
        for (uint32_t i = 0; i < ALL; i++) mcs_reservoir_add(&r, i, shares[i], random_u(run, i));
        count[r.i]++;
    }
    frequencies(count, expected, ALL, "candidates");
}

/* The four parts, joined in this order and shape. */
static mcs_reservoir joined(const mcs_reservoir *part, int shape, uint32_t run) {
    static const int order[][PARTS] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {2, 0, 3, 1}};
    mcs_reservoir r = part[order[shape][0]];
    mcs_reservoir_merge(&r, &part[order[shape][1]], random_u(run, 100));
    if (shape == 2) { /* two pairs */
        mcs_reservoir other = part[order[shape][2]];
        mcs_reservoir_merge(&other, &part[order[shape][3]], random_u(run, 101));
        mcs_reservoir_merge(&r, &other, random_u(run, 102));
        return r;
    }
    mcs_reservoir_merge(&r, &part[order[shape][2]], random_u(run, 101));
    mcs_reservoir_merge(&r, &part[order[shape][3]], random_u(run, 102));
    return r;
}
static void one_merged(void) {
    double expected[ALL];
    expect_shares(expected);
    for (int shape = 0; shape < 3; shape++) {
        double count[ALL] = {0};
        if (!mcst_case("merged in parts, order %d: as often as its weight", shape)) continue;
        for (uint32_t run = 0; run < DRAWS; run++) {
            mcs_reservoir part[PARTS] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
            for (uint32_t i = 0; i < ALL; i++)
                mcs_reservoir_add(&part[i / EACH], i, shares[i], random_u(run, i + 1000 * (uint32_t)shape));
            const mcs_reservoir r = joined(part, shape, run);
            CHECK(r.n == ALL && fabs(r.total - 24.626) < 1e-6, "n = %g, total = %g", r.n, r.total);
            count[r.i]++;
        }
        frequencies(count, expected, ALL, "candidates");
    }
    if (!mcst_case("merged with an empty one, and with itself")) return;
    mcs_reservoir r = {0, 0, 0};
    mcs_reservoir one = {0, 0, 0};
    const mcs_reservoir empty = {0, 0, 0};
    CHECK(mcs_reservoir_add(&one, 7, 2.0f, 0.999) == 1, "the first weight is kept");
    CHECK(mcs_reservoir_merge(&r, &one, 0.999) == 1 && r.i == 7 && r.n == 1 && r.total == 2, "into an empty one");
    CHECK(mcs_reservoir_merge(&r, &empty, 0.0) == 0 && r.i == 7 && r.n == 1 && r.total == 2, "an empty one");
    mcs_reservoir_merge(&r, &r, 0.5);
    CHECK(r.i == 7 && r.n == 2 && r.total == 4, "itself: %g, %g", r.n, r.total);
}

/* ---- resampling: the integral of x^2 over [0,1] is 1/3 ---- */

static double square(double x) { return x * x; }
static float target_near(double x) { return (float)(x < 0.25 ? 0.05 + x : x); }
static float target_far(double x) { return (float)(1.5 - x); }
/* Adds n candidates with density 2 (1 - 0.9 x) / 1.1: x is (1 - sqrt(1 - 0.99 u)) / 0.9. */
static double resample(mcs_reservoir *r, float (*target)(double), int n, uint64_t run, double *kept) {
    for (int i = 0; i < n; i++) {
        const double x = (1 - sqrt(1 - 0.99 * random_u(run, 2 * (uint64_t)i))) / 0.9;
        const double p = 2 * (1 - 0.9 * x) / 1.1;
        if (mcs_reservoir_add(r, (uint32_t)i, (float)((double)target(x) / p), random_u(run, 2 * (uint64_t)i + 1)))
            *kept = x;
    }
    return square(*kept) * (double)mcs_reservoir_weight(r, target(*kept));
}
static void resampling(void) {
    enum { RUNS = 200000 };
    for (int n = 1; n <= 64; n *= 8) {
        if (!mcst_case("resampling from %d candidates has no bias", n)) continue;
        mcs_stat near_stat = {0, 0, 0};
        mcs_stat far_stat = near_stat;
        for (uint64_t run = 0; run < RUNS / (uint64_t)n + 2000; run++) {
            double x = 0;
            mcs_reservoir r = {0, 0, 0};
            mcs_stat_add(&near_stat, resample(&r, target_near, n, run, &x));
            mcs_reservoir other = {0, 0, 0};
            mcs_stat_add(&far_stat, resample(&other, target_far, n, ~run, &x));
        }
        mean_is(&near_stat, 1.0 / 3, "a target like the integrand");
        mean_is(&far_stat, 1.0 / 3, "a target unlike it");
    }
    if (!mcst_case("merged reservoirs of several counts and targets have no bias")) return;
    mcs_stat same = {0, 0, 0};
    mcs_stat different = same;
    for (uint64_t run = 0; run < RUNS / 8; run++) {
        double x = 0;
        double y = 0;
        mcs_reservoir r = {0, 0, 0};
        resample(&r, target_near, 5, 4 * run, &x);
        mcs_reservoir other = {0, 0, 0};
        resample(&other, target_near, 2, 4 * run + 1, &y);
        if (mcs_reservoir_merge(&r, &other, random_u(4 * run + 2, 0))) x = y;
        mcs_stat_add(&same, square(x) * (double)mcs_reservoir_weight(&r, target_near(x)));
        mcs_reservoir third = {0, 0, 0};
        resample(&third, target_far, 9, 4 * run + 3, &y);
        third.total *= (double)target_near(y) / (double)target_far(y);
        if (mcs_reservoir_merge(&r, &third, random_u(4 * run + 2, 1))) x = y;
        mcs_stat_add(&different, square(x) * (double)mcs_reservoir_weight(&r, target_near(x)));
    }
    mean_is(&same, 1.0 / 3, "of one target");
    mean_is(&different, 1.0 / 3, "of two targets");
}

/* ---- k ---- */

enum { MANY = 200, ROOM = 256 };
typedef struct {
    mcs_kept kept[ROOM];
    mcs_reservoir_k r;
} room;
static void empty_room(room *a, uint32_t k) {
    memset(a->kept, 0x55, sizeof a->kept);
    a->r = mcs_reservoir_k_make(a->kept, k);
}
static int same_rooms(const room *a, const room *b) {
    return a->r.count == b->r.count && a->r.next == b->r.next &&
           !memcmp(a->kept, b->kept, a->r.count * sizeof a->kept[0]);
}

/* Efraimidis and Spirakis: the largest of the keys v^(1/w), v uniform in (0,1]: the least of -ln(v)/w. v is 1 - u. */
static long double key_of(uint64_t run, uint32_t i) {
    const float w = random_weight(run, i);
    return w > 0 ? -log1pl(-(long double)random_u(run, i)) / (long double)w : HUGE_VALL;
}
/* How far off, relative, the key may be: 1.5 ulp of the logarithm, and u as a float, which moves it by the 2^-24th part
 * of u/(1 - u). Both are in E = -ln(1 - u). */
static long double key_error(uint64_t run, uint32_t i) {
    const long double e = -log1pl(-(long double)random_u(run, i));
    return 0x1p-24L * (3 + expm1l(e) / e);
}
/* The kept have their keys, in order, and no other one has a key less than theirs, but for what rounding does. */
static void check_keys(const room *a, uint64_t run, uint32_t k) {
    uint32_t positive = 0;
    char is_kept[MANY] = {0};
    for (uint32_t j = 0; j < a->r.count; j++) {
        const mcs_kept c = a->kept[j];
        is_kept[c.i]++;
        CHECK(c.w == random_weight(run, c.i), "k = %u, place %u: the weight", k, j);
        CHECK(fabsl((long double)c.key / key_of(run, c.i) - 1) <= key_error(run, c.i), "k = %u, place %u", k, j);
        CHECK(j == 0 || a->kept[j - 1].key <= c.key, "k = %u, place %u: the order", k, j);
        CHECK(c.key <= a->r.next, "k = %u, place %u: next", k, j);
    }
    int reached = 0;
    for (uint32_t i = 0; i < MANY; i++) {
        const long double over = key_of(run, i) / (long double)a->r.next - 1;
        positive += key_of(run, i) < HUGE_VALL;
        CHECK(is_kept[i] <= 1, "%u is kept twice", i);
        if (is_kept[i]) continue;
        CHECK(over >= -key_error(run, i), "%u is not kept", i);
        reached |= over <= key_error(run, i);
    }
    CHECK(a->r.count == (k < positive ? k : positive), "k = %u: %u kept", k, a->r.count);
    CHECK(reached == (k < positive), "k = %u: next is the least of the others", k);
}
/* Candidates shared out among parts at random, added in random order, and the parts merged in random order. */
static void share_out(room *to, uint32_t k, uint64_t run, uint32_t how) {
    static room part[5];
    for (int p = 0; p < 5; p++) empty_room(&part[p], k);
    const uint32_t step = 2 * (mcs_hash(how, 1) % 50) + 1; /* odd, so that j step + how visits all below 256 */
    for (uint32_t j = 0; j < 256; j++) {
        const uint32_t i = (j * step + how) % 256;
        if (i < MANY) mcs_reservoir_k_add(&part[mcs_hash(i, how) % 5].r, i, random_weight(run, i), random_u(run, i));
    }
    mcs_reservoir_k_merge(&part[1].r, &part[2].r);
    mcs_reservoir_k_merge(&part[4].r, &part[3].r);
    if (how % 2) mcs_reservoir_k_merge(&part[0].r, &part[1].r);
    mcs_reservoir_k_merge(&part[4].r, how % 2 ? &part[0].r : &part[1].r);
    if (how % 2 == 0) mcs_reservoir_k_merge(&part[4].r, &part[0].r);
    *to = part[4];
}
static void k_shared_out(void) {
    static room all, parts;
    static const uint32_t ks[] = {0, 1, 2, 7, 64, 250};
    for (uint32_t c = 0; c < sizeof ks / sizeof ks[0]; c++) {
        if (!mcst_case("k = %u: the least keys, the same bits however candidates are shared out", ks[c])) continue;
        for (uint64_t run = 0; run < 20; run++) {
            empty_room(&all, ks[c]);
            for (uint32_t i = 0; i < MANY; i++) mcs_reservoir_k_add(&all.r, i, random_weight(run, i), random_u(run, i));
            check_keys(&all, run, ks[c]);
            for (uint32_t how = 0; how < 6; how++) {
                share_out(&parts, ks[c], run, how);
                CHECK(same_rooms(&all, &parts), "run %u, order %u", (unsigned)run, how);
            }
        }
    }
}
static void k_of_equal_keys(void) {
    static room a, b;
    if (!mcst_case("equal keys are in the order of numbers")) return;
    empty_room(&a, 3);
    empty_room(&b, 3);
    for (uint32_t i = 0; i < 8; i++) {
        mcs_reservoir_k_add(&a.r, i, 2.0f, 0.25);
        mcs_reservoir_k_add(&b.r, 7 - i, 2.0f, 0.25);
    }
    CHECK(same_rooms(&a, &b) && a.kept[0].i == 0 && a.kept[2].i == 2 && a.r.next == a.kept[0].key, "3 of 8");
}

/* Draws by weight without replacement: i first, then j, with probability w_i/W w_j/(W - w_i). */
static void k_by_weight(void) {
    enum { FEW = 6, PAIRS = FEW * FEW };
    static const float w[FEW] = {1, 2, 0.5f, 4, 0.1f, 3};
    double count[PAIRS] = {0};
    double expected[PAIRS];
    if (!mcst_case("the first two of draws without replacement")) return;
    for (int i = 0; i < PAIRS; i++) {
        const double first = (double)w[i / FEW];
        expected[i] = i / FEW == i % FEW ? 0 : DRAWS * first / 10.6 * (double)w[i % FEW] / (10.6 - first);
    }
    for (uint32_t run = 0; run < DRAWS; run++) {
        mcs_kept kept[2];
        mcs_reservoir_k r = mcs_reservoir_k_make(kept, 2);
        for (uint32_t i = 0; i < FEW; i++) mcs_reservoir_k_add(&r, i, w[i], random_u(run, i));
        count[kept[0].i * FEW + kept[1].i]++;
    }
    frequencies(count, expected, PAIRS, "pairs");
}

/* ---- sums over all candidates ---- */

enum { LIGHTS = 30 };
static double light(uint32_t i) { return (1 + i % 5) * (double)(i % 3 == 0 ? 4.0f : 0.25f); }
static float guess(uint32_t i) { return i % 3 == 0 ? 4.0f : i % 7 == 1 ? 0.01f : 0.25f; } /* of a light */
static double k_sum(const mcs_reservoir_k *r) {
    double sum = 0;
    for (uint32_t j = 0; j < r->count; j++) sum += light(r->kept[j].i) * (double)mcs_reservoir_k_weight(r, j);
    return sum;
}
static void sums(void) {
    enum { RUNS = 50000 };
    static const uint32_t ks[] = {3, 5, 12, 29, 30, 40};
    double truth = 0;
    for (uint32_t i = 0; i < LIGHTS; i++) truth += light(i);
    for (uint32_t c = 0; c < sizeof ks / sizeof ks[0]; c++) {
        if (!mcst_case("the sum by %u of 30 has no bias", ks[c])) continue;
        mcs_stat s = {0, 0, 0};
        for (uint32_t run = 0; run < RUNS; run++) {
            mcs_kept kept[40];
            mcs_reservoir_k r = mcs_reservoir_k_make(kept, ks[c]);
            for (uint32_t i = 0; i < LIGHTS; i++) mcs_reservoir_k_add(&r, i, guess(i), random_u(run, i));
            if (ks[c] >= LIGHTS) CHECK(fabs(k_sum(&r) / truth - 1) < 1e-12, "%g instead of %g", k_sum(&r), truth);
            mcs_stat_add(&s, k_sum(&r));
        }
        if (ks[c] < LIGHTS) mean_is(&s, truth, "a sum");
    }
    if (mcst_case("merged from 5 and from 3 it has no bias")) {
        mcs_stat s = {0, 0, 0};
        for (uint32_t run = 0; run < RUNS; run++) {
            mcs_kept kept[2][5];
            mcs_reservoir_k r[2] = {mcs_reservoir_k_make(kept[0], 5), mcs_reservoir_k_make(kept[1], 3)};
            for (uint32_t i = 0; i < LIGHTS; i++) mcs_reservoir_k_add(&r[i % 2], i, guess(i), random_u(run, i));
            mcs_reservoir_k_merge(&r[0], &r[1]);
            mcs_stat_add(&s, k_sum(&r[0]));
        }
        mean_is(&s, truth, "a sum");
    }
    if (!mcst_case("the sum by one of 30 has no bias")) return;
    mcs_stat s = {0, 0, 0};
    for (uint32_t run = 0; run < RUNS; run++) {
        mcs_reservoir r = {0, 0, 0};
        for (uint32_t i = 0; i < LIGHTS; i++) mcs_reservoir_add(&r, i, guess(i), random_u(run, i));
        mcs_stat_add(&s, light(r.i) * r.n * (double)mcs_reservoir_weight(&r, guess(r.i)));
    }
    mean_is(&s, truth, "a sum");
}

/* 1 over 1 - e^(-w next): the rounding of w next, the exponential and the division. */
static void weights_of_k(void) {
    long double worst = 0;
    if (!mcst_case("weights of those that are kept")) return;
    for (uint32_t i = 0; i < 300000; i++) {
        mcs_kept c = {0, (float)exp2(270 * random_u(1, i) - 145), 0};
        mcs_reservoir_k r = {&c, 1, 1, exp2(300 * random_u(2, i) - 150) / (i % 2 ? 1.0 : (double)c.w)};
        const long double truth = -1 / expm1l(-(long double)c.w * (long double)r.next);
        const float weight = mcs_reservoir_k_weight(&r, 0);
        if (!(c.w > 0) || truth > (long double)FLT_MAX) CHECK(weight >= 1 && weight <= FLT_MAX, "%g", (double)weight);
        else if (truth < 0x1p120L) worst = fmaxl(worst, fabsl((long double)weight / truth - 1));
        CHECK(mcs_reservoir_k_weight(&r, 1) == 0, "beyond those that are kept");
    }
    CHECK(worst <= 2.5e-7L, "%.3Lg", worst);
    mcst_note("weights: %.3Lg\n", worst);
}

/* ---- bad input ---- */

static const float odd_weight[] = {NAN, -1, -INFINITY, INFINITY, 0, -0.0f, FLT_MAX, 1e-45f, 1};
static const double odd_u[] = {NAN, -1, -INFINITY, INFINITY, 1, 2, 1e300, 1e-300, 0, 0.5, 1 - 0x1p-53};
enum { ODD_WEIGHTS = sizeof odd_weight / sizeof odd_weight[0], ODD_US = sizeof odd_u / sizeof odd_u[0] };
static int below_limit(double x) { return x >= 0 && x <= DBL_MAX; }

static void bad_one(void) {
    if (!mcst_case("one: bad weights and random numbers")) return;
    for (int k = 0; k < ODD_WEIGHTS * ODD_US; k++) {
        const float w = odd_weight[k % ODD_WEIGHTS];
        const double u = odd_u[k / ODD_WEIGHTS];
        mcs_reservoir r = {0, 0, 0};
        const int taken = mcs_reservoir_add(&r, 5, w, u);
        CHECK(taken == (w > 0) && (r.total > 0) == (w > 0) && r.total <= (double)FLT_MAX && r.n == 1, "%g, %g",
              (double)w, u);
        CHECK(r.i == (w > 0 ? 5 : 0), "the first one: %g, %g", (double)w, u);
        mcs_reservoir_add(&r, 6, 2.0f, 0.25);
        mcs_reservoir_add(&r, 7, w, u);
        CHECK(r.n == 3 && below_limit(r.total) && r.i >= 5 && (w > 0 || r.i == 6), "%g, %g", (double)w, u);
        for (int t = 0; t < ODD_WEIGHTS; t++) {
            const float target = odd_weight[t];
            const float weight = mcs_reservoir_weight(&r, target);
            CHECK(target > 0 && target <= FLT_MAX ? weight >= 0 && weight <= FLT_MAX : weight == 0, "target %g",
                  (double)target);
        }
        const double odd_total[] = {NAN, -1, -INFINITY, INFINITY, DBL_MAX};
        for (int t = 0; t < 5; t++) {
            mcs_reservoir to = r;
            mcs_reservoir other = {0, 4, 9};
            other.total = odd_total[t];
            const int moved = mcs_reservoir_merge(&to, &other, u);
            CHECK(to.n == 7 && to.total > 0 && to.total <= DBL_MAX, "total %g", odd_total[t]);
            CHECK(moved == (to.i == 9) && (t > 2 || !moved), "total %g: %d", odd_total[t], moved);
            const float weight = mcs_reservoir_weight(&other, 1.0f);
            CHECK(t > 2 ? weight == FLT_MAX : weight == 0, "total %g weighs %g", odd_total[t], (double)weight);
            mcs_reservoir_add(&other, 5, 2.0f, u);
            CHECK(t > 2 ? other.total == DBL_MAX : other.total == 2 && other.i == 5, "total %g: %g with 2 more",
                  odd_total[t], other.total);
        }
    }
    const mcs_reservoir empty = {0, 0, 0};
    CHECK(mcs_reservoir_weight(&empty, 1) == 0, "an empty one");
    const mcs_reservoir heavy = {1e300, 1, 0};
    CHECK(mcs_reservoir_weight(&heavy, 1) == FLT_MAX, "a heavy one");
}
static void bad_k(void) {
    static room a;
    if (!mcst_case("k: bad weights and random numbers")) return;
    for (uint32_t k = 0; k < 6; k++) {
        empty_room(&a, k);
        for (uint32_t c = 0; c < ODD_WEIGHTS * ODD_US; c++) {
            const float w = odd_weight[c % ODD_WEIGHTS];
            const int is_kept = mcs_reservoir_k_add(&a.r, c, w, odd_u[c / ODD_WEIGHTS]);
            CHECK(!is_kept || (w > 0 && k > 0), "%g is kept", (double)w);
            CHECK(a.r.count <= k && below_limit(fabs(a.r.next)), "k = %u: next %g", k, a.r.next);
        }
        CHECK(a.r.count == k && a.kept[k].i == 0x55555555, "k = %u: %u kept, or written behind them", k, a.r.count);
        for (uint32_t j = 0; j <= k; j++) {
            const float weight = mcs_reservoir_k_weight(&a.r, j);
            CHECK(j < k ? weight >= 1 && weight <= FLT_MAX : weight == 0, "k = %u: weight %g", k, (double)weight);
        }
    }
    mcs_reservoir_k none = mcs_reservoir_k_make(NULL, 4);
    CHECK(none.k == 0 && !mcs_reservoir_k_add(&none, 1, 1.0f, 0.5) && none.count == 0, "no memory");
    mcs_reservoir_k_merge(&none, &a.r);
    CHECK(none.count == 0 && mcs_reservoir_k_weight(&none, 0) == 0, "merged without memory");
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("reservoir of one");
    one_by_rule();
    one_by_weight();
    one_merged();
    mcst_group("resampling");
    resampling();
    mcst_group("reservoir of k");
    k_shared_out();
    k_of_equal_keys();
    k_by_weight();
    mcst_group("sums");
    sums();
    weights_of_k();
    mcst_group("bad reservoirs");
    bad_one();
    bad_k();
    return mcst_finish();
}
