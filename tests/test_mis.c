/* Weights of multiple importance sampling, and the running mean that knows its error. */
#include <float.h>
#include <math.h>
#include "mcs_test.h"
#include "mcsample.h"
#include "oracle.h"
#include "stats.h"

static const double eps = 0x1p-24; /* rounding of a float, relative */
static const double level = 1e-5; /* of one statistical test: Sidak, 1000 of them in the whole suite at 0.01 together */
static const double z_level = 4.42; /* that level of the normal distribution, both sides */

/* ---- multiple importance sampling ---- */

static const float densities[] = {0.0f,  1e-45f, 1e-40f,     FLT_MIN,  1e-30f, 1e-20f, 1e-10f,
                                  0.3f,  1.0f,   1.0000001f, 3.0f,     1e10f,  1e19f,  1e20f,
                                  1e30f, 1e38f,  FLT_MAX,    INFINITY, NAN,    -1.0f,  -INFINITY};
enum { DENSITIES = (int)(sizeof densities / sizeof *densities) };

/* Quotient g/f: eps; balance: 1 + g/f and the reciprocal once each, 3 eps. Power: the square makes it 3, then the same,
 * 5 eps. A weight below FLT_MIN may be lost. */
static void check_heuristics(float f, float g) {
    const ld lf = f;
    const ld lg = g;
    const double b = mcs_mis_balance(f, g);
    const double p = mcs_mis_power(f, g);
    CHECK(b >= 0 && b <= 1 && p >= 0 && p <= 1, "f = %g, g = %g: balance %g, power %g", (double)f, (double)g, b, p);
    if (f == 0) CHECK(b == 0 && p == 0, "f = 0, g = %g: balance %g, power %g", (double)g, b, p);
    if (!(f >= 0 && g >= 0) || (f == 0 && g == 0)) return;
    CHECK(fabs((double)(b + (ld)mcs_mis_balance(g, f) - 1)) <= 6 * eps, "f = %g, g = %g: balance sums to %g", (double)f,
          (double)g, b + mcs_mis_balance(g, f));
    CHECK(fabs((double)(p + (ld)mcs_mis_power(g, f) - 1)) <= 10 * eps, "f = %g, g = %g: power sums to %g", (double)f,
          (double)g, p + mcs_mis_power(g, f));
    if (isinf(f) || isinf(g)) {
        CHECK(b == (f == g     ? 0.5
                    : isinf(f) ? 1
                               : 0) &&
                  p == b,
              "f = %g, g = %g: balance %g, power %g", (double)f, (double)g, b, p);
    } else {
        const double wb = (double)(lf / (lf + lg));
        const double wp = (double)(lf * lf / (lf * lf + lg * lg));
        CHECK(fabs(b - wb) <= 3 * eps * wb + FLT_MIN, "f = %g, g = %g: balance %g, not %g", (double)f, (double)g, b,
              wb);
        CHECK(fabs(p - wp) <= 5 * eps * wp + FLT_MIN, "f = %g, g = %g: power %g, not %g", (double)f, (double)g, p, wp);
    }
}

static void test_heuristics(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 107);
    if (mcst_case("heuristics: extremes"))
        for (int i = 0; i < DENSITIES * DENSITIES; i++)
            check_heuristics(densities[i / DENSITIES], densities[i % DENSITIES]);
    if (mcst_case("heuristics: 1e-38 to 1e38, and close to each other"))
        for (int i = 0; i < 300000; i++) {
            const double f = pow(10, 76.0 * mcs_pcg32_float(&r) - 38);
            check_heuristics((float)f, (float)pow(10, 76.0 * mcs_pcg32_float(&r) - 38));
            check_heuristics((float)(f * 1e-2), (float)(f * 1e-2 * pow(10, 4.0 * mcs_pcg32_float(&r) - 2)));
        }
    /* 1 - c, two products and the sum: 3 eps of a sum of positive terms. Negative densities and NaN count as 0. */
    if (mcst_case("mix_pdf")) {
        const float c[] = {0.0f, 0x1p-24f, 0.25f, 0.3f, 0.5f, 0.999f, 1.0f};
        for (int j = 0; j < 7; j++)
            for (int i = 0; i < DENSITIES * DENSITIES; i++) {
                const float f = densities[i / DENSITIES];
                const float g = densities[i % DENSITIES];
                const float p = mcs_mix_pdf(c[j], f, g);
                const double want = (double)((ld)c[j] * (f > 0 ? f : 0) + (1 - (ld)c[j]) * (g > 0 ? g : 0));
                CHECK(isfinite(p), "c = %g, f = %g, g = %g: %g", (double)c[j], (double)f, (double)g, (double)p);
                if (want <= FLT_MAX)
                    CHECK(fabs(p - want) <= 3 * eps * want + FLT_MIN, "c = %g, f = %g, g = %g: %g, not %g",
                          (double)c[j], (double)f, (double)g, (double)p, want);
            }
        for (int i = 0; i < 100000; i++) {
            const float w = mcs_pcg32_float(&r);
            const float f = 10 * mcs_pcg32_float(&r);
            const float g = 10 * mcs_pcg32_float(&r);
            const double want = (double)((ld)w * f + (1 - (ld)w) * g);
            const double p = mcs_mix_pdf(w, f, g);
            CHECK(fabs(p - want) <= 3 * eps * want, "c = %g, f = %g, g = %g: %g, not %g", (double)w, (double)f,
                  (double)g, p, want);
        }
        for (int i = 0; i < DENSITIES; i++)
            CHECK(isfinite(mcs_mix_pdf(densities[i], 1.0f, 2.0f)), "c = %g", (double)densities[i]);
        CHECK(mcs_mix_pdf(NAN, 1.0f, 2.0f) == 0, "c = NaN: %g", (double)mcs_mix_pdf(NAN, 1.0f, 2.0f));
    }
}

/* The integral of 12 x^2 (1 - x) over [0,1] is 1. Strategies: density 3 x^2 and density 2 (1 - x); each misses one
 * factor. */
static void test_mis_estimates(void) {
    enum { ROWS = 5, N = 200000 };
    static const char *const names[ROWS] = {"balance 1+1", "power 1+1", "balance 1+3", "power 3+1", "one sample, 0.3"};
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 109);
    mcs_stat s[ROWS];
    memset(s, 0, sizeof s);
    for (int row = 0; row < ROWS; row++)
        for (int i = 0; i < N; i++) {
            const int nf = row == 3 ? 3 : 1;
            const int ng = row == 2 ? 3 : 1;
            double sum = 0;
            for (int k = 0; k < (row == 4 ? 1 : nf + ng); k++) {
                const int first = row == 4 ? mcs_pcg32_float(&r) < 0.3f : k < nf;
                const float u = mcs_pcg32_float(&r);
                const float x = first ? mcs_power_sample(2, u).x : mcs_linear_sample(1, 0, u).x;
                const float pf = mcs_power_pdf(2, x);
                const float pg = mcs_linear_pdf(1, 0, x);
                const double f = 12.0 * x * x * (1.0 - x);
                if (row == 4) {
                    const double p = mcs_mix_pdf(0.3f, pf, pg);
                    sum += p > 0 ? f / p : 0;
                } else {
                    const float mine = first ? (float)nf * pf : (float)ng * pg;
                    const float other = first ? (float)ng * pg : (float)nf * pf;
                    const double w = row & 1 ? mcs_mis_power(mine, other) : mcs_mis_balance(mine, other);
                    sum += mine > 0 ? w * f / mine : 0;
                }
            }
            mcs_stat_add(&s[row], sum);
        }
    for (int row = 0; row < ROWS; row++) {
        const double off = fabs(s[row].mean - 1) / mcs_stat_error(&s[row]);
        CHECK(off <= z_level, "%s: %g, %g standard errors from 1", names[row], s[row].mean, off);
        for (int i = 0; i < row; i++) {
            const double e = hypot(mcs_stat_error(&s[row]), mcs_stat_error(&s[i]));
            CHECK(fabs(s[row].mean - s[i].mean) <= z_level * e, "%s and %s disagree", names[row], names[i]);
        }
    }
}

/* ---- estimator ---- */

/* Badly conditioned: mean 1e9, deviation 1, so the condition number is k = 1e9. Chan, Golub and LeVeque 1983, table 1:
 * updating has a relative error of the sum of squares of n k u at most, u = 2^-53 (the textbook sum of squares n k^2 u,
 * of which nothing is left). The mean moves by half an ulp of itself at most in each step. */
enum { HARD = 4000 };
static double hard[HARD];
static ld hard_mean, hard_m2;

static void make_hard(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 113);
    hard_mean = hard_m2 = 0;
    for (int i = 0; i < HARD; i++) hard_mean += hard[i] = 1e9 + mcs_normal_sample(0, 1, mcs_pcg32_float(&r)).x;
    hard_mean /= HARD;
    for (int i = 0; i < HARD; i++) hard_m2 += (hard[i] - hard_mean) * (hard[i] - hard_mean);
}

static void check_hard(const char *what, const mcs_stat *s) {
    const double u = 0x1p-53;
    const double k = 1e9;
    const double mean = fabs((double)(s->mean - hard_mean));
    const double m2 = fabs((double)(s->m2 / hard_m2 - 1));
    CHECK(s->n == HARD, "%s: n = %g", what, s->n);
    CHECK(mean <= HARD * u * 1e9, "%s: mean is off by %g", what, mean);
    CHECK(m2 <= HARD * k * u, "%s: sum of squares is off by %g relative", what, m2);
    CHECK(fabs(mcs_stat_variance(s) / (double)(hard_m2 / (HARD - 1)) - 1) <= HARD * k * u, "%s: variance %g", what,
          mcs_stat_variance(s));
    CHECK(fabs(mcs_stat_error(s) / sqrt(mcs_stat_variance(s) / HARD) - 1) <= 4 * u, "%s: standard error %g", what,
          mcs_stat_error(s));
    CHECK(fabs(mcs_stat_ci(s, 1.96) / (1.96 * mcs_stat_error(s)) - 1) <= 4 * u, "%s: half width %g", what,
          mcs_stat_ci(s, 1.96));
}

static mcs_stat stat_of(int from, int to) {
    mcs_stat s = {0, 0, 0};
    for (; from < to; from++) mcs_stat_add(&s, hard[from]);
    return s;
}

static mcs_stat stat_merged(mcs_stat a, mcs_stat b) {
    mcs_stat_merge(&a, &b);
    return a;
}

/* Merges as a tree: halves, quarters, down to single values. */
static mcs_stat stat_tree(int from, int to) {
    const int mid = from + (to - from) / 2;
    if (to - from <= 1) return stat_of(from, to);
    return stat_merged(stat_tree(from, mid), stat_tree(mid, to));
}

static int same_stat(mcs_stat a, mcs_stat b) { return a.n == b.n && a.mean == b.mean && a.m2 == b.m2; }

/* Any five of these values, each with either sign: mean and sum of squares as sums in long double, of values divided by
 * 2^600, give them; sums of squares above DBL_MAX are DBL_MAX. Rounding: 5 steps of the mean, each to 2 u of the
 * largest value, and of m2, each to 6 u of the terms, which share a sign. A mean may be off by what its terms cancel,
 * and m2 by its square root's part in that. */
static void check_huge(const mcs_stat *s, const double *x, int n) {
    const ld u = 0x1p-53L;
    const ld down = ldexpl(1, -600);
    ld mean = 0;
    ld m2 = 0;
    ld size = 0;
    for (int i = 0; i < n; i++) {
        mean += (ld)x[i] * down / n;
        size = fmaxl(size, fabsl((ld)x[i]) * down);
    }
    for (int i = 0; i < n; i++) m2 += ((ld)x[i] * down - mean) * ((ld)x[i] * down - mean);
    CHECK(s->n == n && fabsl((ld)s->mean * down - mean) <= 10 * u * size, "%g %g %g ...: mean %g, not %Lg 2^600", x[0],
          x[1], x[2], s->mean, mean);
    const ld off = 30 * u * m2 + 2 * (10 * u * size) * sqrtl(n * m2) + n * (10 * u * size) * (10 * u * size);
    if ((m2 - off) / down < DBL_MAX * down)
        CHECK(s->m2 >= 0 && fabsl((ld)s->m2 * down * down - m2) <= off + 0x1p-1074L,
              "%g %g %g ...: m2 %g, not %Lg 2^1200", x[0], x[1], x[2], s->m2, m2);
    else CHECK(s->m2 == DBL_MAX, "%g %g %g ...: m2 %g, not DBL_MAX", x[0], x[1], x[2], s->m2);
    CHECK(mcs_stat_variance(s) <= DBL_MAX && mcs_stat_error(s) <= DBL_MAX, "variance %g", mcs_stat_variance(s));
}
static void test_huge_stat(void) {
    static const double sizes[] = {0, 1, 1e139, 1e140, 1e150, 1.3e154, 1e200, 1e299, 1e300, 1e307, 1e308, DBL_MAX};
    enum { SIZES = (int)(sizeof sizes / sizeof *sizes) };
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 141);
    for (int i = 0; i < 100000; i++) {
        const int cut = i % 6;
        mcs_stat s = {0, 0, 0};
        mcs_stat parts[2];
        parts[0] = parts[1] = s;
        double x[5];
        for (int k = 0; k < 5; k++) {
            const double size = sizes[mcs_pcg32_next(&r) % SIZES];
            x[k] = mcs_pcg32_next(&r) & 1 ? size : -size;
            mcs_stat_add(&s, x[k]);
            mcs_stat_add(&parts[k >= cut], x[k]);
        }
        check_huge(&s, x, 5);
        mcs_stat_merge(&parts[0], &parts[1]);
        check_huge(&parts[0], x, 5);
    }
}

static void test_stat_values(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 127);
    make_hard();
    if (mcst_case("mean 1e9, deviation 1")) {
        const mcs_stat s = stat_of(0, HARD);
        check_hard("adding", &s);
    }
    if (mcst_case("merge of any partition is the whole")) {
        mcs_stat s = stat_tree(0, HARD);
        check_hard("tree", &s);
        for (int i = 0; i <= HARD; i += i < 20 || i >= HARD - 20 ? 1 : 97) {
            s = stat_merged(stat_of(0, i), stat_of(i, HARD));
            check_hard("two parts", &s);
            s = stat_merged(stat_of(i, HARD), stat_of(0, i));
            check_hard("two parts, swapped", &s);
        }
        for (int i = 0; i < 100; i++) {
            int from = 0;
            memset(&s, 0, sizeof s);
            while (from < HARD) {
                int to = from + (int)(mcs_pcg32_next(&r) % 500);
                if (to > HARD) to = HARD;
                const mcs_stat part = stat_of(from, to);
                mcs_stat_merge(&s, &part);
                from = to;
            }
            check_hard("many parts", &s);
        }
    }
    if (mcst_case("empty and single")) {
        mcs_stat empty = {0, 0, 0};
        mcs_stat one = empty;
        mcs_stat_add(&one, 3.5);
        mcs_stat s = stat_of(0, 10);
        CHECK(same_stat(stat_merged(empty, s), s) && same_stat(stat_merged(s, empty), s), "empty is neutral");
        CHECK(same_stat(stat_merged(empty, empty), empty), "empty and empty");
        CHECK(one.n == 1 && one.mean == 3.5 && one.m2 == 0, "single: %g, %g, %g", one.n, one.mean, one.m2);
        CHECK(mcs_stat_variance(&empty) == 0 && mcs_stat_error(&empty) == 0 && mcs_stat_ci(&empty, 2) == 0,
              "empty: variance %g, error %g", mcs_stat_variance(&empty), mcs_stat_error(&empty));
        CHECK(mcs_stat_variance(&one) == 0 && mcs_stat_error(&one) == 0 && mcs_stat_ci(&one, 2) == 0,
              "single: variance %g, error %g", mcs_stat_variance(&one), mcs_stat_error(&one));
        s = one;
        mcs_stat_merge(&s, &s);
        CHECK(same_stat(s, stat_merged(one, one)), "merged with itself: %g, %g, %g", s.n, s.mean, s.m2);
        s = stat_of(0, 10);
        mcs_stat_merge(&s, &s);
        CHECK(same_stat(s, stat_merged(stat_of(0, 10), stat_of(0, 10))), "ten values merged with themselves");
        s = one;
        mcs_stat_add(&s, 5.5);
        CHECK(s.mean == 4.5 && s.m2 == 2 && mcs_stat_variance(&s) == 2 && fabs(mcs_stat_error(&s) - 1) <= 0x1p-52,
              "3.5 and 5.5");
    }
    if (mcst_case("equal values have no variance")) {
        mcs_stat s = {0, 0, 0};
        for (int i = 0; i < 1000; i++) mcs_stat_add(&s, 0.1);
        CHECK(s.mean == 0.1 && s.m2 == 0 && mcs_stat_error(&s) == 0, "mean %g, sum of squares %g", s.mean, s.m2);
    }
    if (mcst_case("values up to DBL_MAX")) test_huge_stat();
}

/* x^2 over [0,1]: integral 1/3, variance 4/45, kurtosis 15/7. Over R repetitions, (R - 1) var(means) N / (4/45) is
 * chi-square with R - 1 degrees of freedom (means of 64 and more values: their excess kurtosis, -6/7 / 64, moves its
 * deviation by 0.3 %), and the mean of the reported variances is off by sqrt((2/(N-1) - 6/7/N) / R) relative. */
static void test_standard_error(void) {
    enum { R = 400 };
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 131);
    double last = 0;
    for (int n = 64; n <= 4096; n *= 4) {
        mcs_stat means = {0, 0, 0};
        mcs_stat reported, errors;
        reported = errors = means;
        for (int i = 0; i < R; i++) {
            mcs_stat s = {0, 0, 0};
            for (int j = 0; j < n; j++) {
                const double x = mcs_pcg32_float(&r);
                mcs_stat_add(&s, x * x);
            }
            mcs_stat_add(&means, s.mean);
            mcs_stat_add(&reported, mcs_stat_variance(&s));
            mcs_stat_add(&errors, mcs_stat_error(&s));
        }
        const double p = chi2_p(means.m2 * n * 45 / 4, R - 1);
        const double off = fabs(reported.mean * 45 / 4 - 1) / sqrt((2.0 / (n - 1) - 6.0 / 7 / n) / R);
        CHECK(p >= level / 2 && 1 - p >= level / 2, "N = %d: the spread of the means has p = %g", n, p);
        CHECK(off <= z_level, "N = %d: reported variance %g, %g deviations from 4/45", n, reported.mean, off);
        CHECK(fabs(means.mean - 1.0 / 3) <= z_level * sqrt(4.0 / 45 / n / R), "N = %d: mean %g", n, means.mean);
        /* Four times the samples halve the error. Its mean has a relative deviation of sqrt((2 - 6/7) / N / R) / 2; the
         * mean of a root lies below the root of the mean by (2 - 6/7) / (8 N), which is known to a tenth of itself. */
        const double ratio = errors.mean * sqrt(n) / (1 - (2 - 6.0 / 7) / (8.0 * n)) / sqrt(4.0 / 45);
        CHECK(fabs(ratio - 1) <= z_level * sqrt((2 - 6.0 / 7) / n / R) / 2 + 0.1 / (8.0 * n),
              "N = %d: error sqrt(N) / sigma = %g", n, ratio);
        CHECK(last == 0 || errors.mean < last, "N = %d: the error does not fall", n);
        last = errors.mean;
    }
}

/* Intervals mean +- 1.96 standard errors of 400 normal values hold the truth as often as |t| of 399 degrees of freedom
 * stays below 1.96: P(|normal| < z) - phi(z) (z^3 + z) / (2 * 399). The count over 2000 repetitions is binomial: tails
 * summed exactly. */
static void test_coverage(void) {
    enum { REPEAT = 2000, N = 400 };
    const double z = 1.96;
    const double p =
        erf(z / sqrt(2.0)) - exp(-z * z / 2) / sqrt(2 * 3.14159265358979323846) * (z * z * z + z) / (2.0 * (N - 1));
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 137);
    double below = 0;
    double above = 0;
    int held = 0;
    for (int i = 0; i < REPEAT; i++) {
        mcs_stat s = {0, 0, 0};
        for (int j = 0; j < N; j++) mcs_stat_add(&s, mcs_normal_sample(5, 2, mcs_u01_open(mcs_pcg32_next(&r))).x);
        held += fabs(s.mean - 5) <= mcs_stat_ci(&s, z);
    }
    for (int i = 0; i <= REPEAT; i++) {
        const double mass = exp(lgamma(REPEAT + 1.0) - lgamma(i + 1.0) - lgamma(REPEAT - i + 1.0) + i * log(p) +
                                (REPEAT - i) * log1p(-p));
        if (i <= held) below += mass;
        if (i >= held) above += mass;
    }
    CHECK(below >= level / 2 && above >= level / 2, "%d of %d intervals hold the mean, expected %g", held, REPEAT,
          p * REPEAT);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("mis");
    test_heuristics();
    if (mcst_case("estimates of a known integral agree")) test_mis_estimates();
    mcst_group("estimator");
    test_stat_values();
    if (mcst_case("standard error falls as 1/sqrt(N)")) test_standard_error();
    if (mcst_case("confidence interval covers")) test_coverage();
    return mcst_finish();
}
