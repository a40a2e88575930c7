/* The point sets: net properties counted, uniform marginals and independent randomisations by chi-square, permutations,
 * array and wide forms against scalar ones, and what all of it is for: the rate at which the error of a smooth integral
 * falls, and the spectrum of the error across a picture. */
#include "mcs_test.h"
#define MCS_PACKETS 16
#include "mcsample.h"
#include "spectrum.h"
#include "stats.h"
#include <math.h>

enum { LOG_N = 12, N = 1 << LOG_N, SEEDS = 16 };

/* (t, m, 2)-net in base 2: every elementary interval of area 2^(t - LOG_N) of dimensions a and b holds 2^t of the N
 * points from `first` on. Counts the shapes (k bits of a, LOG_N - t - k of b) of which one does not. */
static int broken_shapes(uint32_t first, uint32_t a, uint32_t b, int t, uint32_t seed) {
    static int hit[N];
    const int bits = LOG_N - t;
    int broken = 0;
    for (int k = 0; k <= bits; k++) {
        int even = 1;
        memset(hit, 0, sizeof hit);
        for (uint32_t i = 0; i < N; i++) {
            const uint64_t x = mcs_sobol_bits(first + i, a, seed);
            const uint64_t y = mcs_sobol_bits(first + i, b, seed);
            hit[(x >> (32 - k)) << (bits - k) | y >> (32 - bits + k)]++;
        }
        for (uint32_t i = 0; i < 1u << bits; i++) even &= hit[i] == 1 << t;
        broken += !even;
    }
    return broken;
}

/* Owen's scrambling flips a bit by those above it: two numbers, scrambled, differ first where they did before. Sobol's
 * numbers of two indices differ by the sum of the columns of the bits in which the indices differ. Columns by the
 * recurrence of the primitive polynomial: degree s, inner coefficients a and first numbers m of new-joe-kuo-6 (Joe and
 * Kuo 2008). */
static void columns(void) {
    static const struct { uint32_t s, a, m[3]; } poly[3] = {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}};
    if (!mcst_case("dimensions 0 to 3 are Sobol's: every column")) return;
    for (uint32_t d = 0; d < 4; d++) {
        uint32_t column[32];
        for (uint32_t k = 0; k < 32; k++) {
            uint32_t m = 1;
            if (d) {
                const uint32_t s = poly[d - 1].s;
                if (k < s) m = poly[d - 1].m[k];
                else {
                    m = column[k - s] >> (31 - (k - s));
                    m ^= m << s;
                    for (uint32_t j = 1; j < s; j++)
                        m ^= (poly[d - 1].a >> (s - 1 - j) & 1) * (column[k - j] >> (31 - (k - j)) << j);
                }
            }
            column[k] = m << (31 - k);
        }
        uint32_t bad = 0;
        for (uint32_t lead = 0; lead < 32;
             lead++) /* sums of columns that cancel above bit `lead` show every bit of theirs */
            for (uint32_t draw = 0; draw < 128; draw++) {
                const uint32_t i = mcs_hash(draw, 100 + lead);
                const uint32_t sum = (mcs_hash(draw, 200 + lead) | 1u << 31) >> lead;
                uint32_t mask = 0;
                uint32_t rest = sum;
                for (uint32_t k = 32; k-- > 0;)
                    if (rest >> (31 - k) & 1) {
                        mask |= 1u << k;
                        rest ^= column[k];
                    }
                bad += (mcs_sobol_bits(i, d, draw) ^ mcs_sobol_bits(i ^ mask, d, draw)) >> (31 - lead) != 1;
            }
        CHECK(bad == 0, "dimension %u: %u sums of columns", d, bad);
    }
}

static void nets(void) {
    if (mcst_case("dimensions 0 and 1 are a (0,2)-sequence"))
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            CHECK(broken_shapes(0, 0, 1, 0, seed) == 0, "seed %u, the first points", seed);
            CHECK(broken_shapes(5u << LOG_N, 0, 1, 0, seed) == 0, "seed %u, a later block", seed);
            CHECK(broken_shapes(0, 4, 5, 0, seed) == 0, "seed %u, the second group", seed);
        }
    if (mcst_case("every dimension alone is a (0,1)-sequence"))
        for (uint32_t seed = 0; seed < SEEDS; seed++)
            for (uint32_t d = 0; d < 12; d++) {
                static unsigned char hit[N];
                int one = 1;
                memset(hit, 0, sizeof hit);
                for (uint32_t i = 0; i < N; i++) one &= !hit[mcs_sobol_bits(3u * N + i, d, seed) >> (32 - LOG_N)]++;
                CHECK(one, "seed %u, dimension %u", seed, d);
            }
    /* t of a projection is the sum of degree - 1 over the primitive polynomials of its dimensions (Niederreiter 1987);
     * dimension 0 adds nothing, 1 to 3 have degrees 1, 2, 3. */
    if (mcst_case("dimensions 0 to 3 are Sobol's: t of every pair"))
        for (uint32_t seed = 0; seed < SEEDS; seed++)
            for (uint32_t d = 0; d < 2; d++) {
                CHECK(broken_shapes(0, d, 2, 1, seed) == 0, "seed %u: %u and 2", seed, d);
                CHECK(broken_shapes(0, d, 3, 2, seed) == 0, "seed %u: %u and 3", seed, d);
                CHECK(broken_shapes(0, 2, 3, 3, seed) == 0, "seed %u: 2 and 3", seed);
            }
}

/* chi-square over `bins` equal bins; the level is Sidak's for the 26 tests of this file at 0.01. */
static void uniform(const double *count, int bins, double total, const char *what) {
    double expected[4096];
    for (int i = 0; i < bins; i++) expected[i] = total / bins;
    CHECK(chi2_test(count, expected, (size_t)bins, NULL, NULL) >= sidak(0.01, 26), "%s is not uniform", what);
}

static void randomisation(void) {
    enum { BINS = 1024, DRAWS = 1 << 20 };
    static double count[BINS];
    if (mcst_case("one point over many seeds is uniform, alone and in pairs")) {
        for (uint32_t d = 0; d < 5; d++) {
            memset(count, 0, sizeof count);
            for (uint32_t s = 0; s < DRAWS; s++) count[mcs_sobol_bits(77, d, s) >> 22]++;
            uniform(count, BINS, DRAWS, "a point of Sobol");
        }
        memset(count, 0, sizeof count);
        for (uint32_t s = 0; s < DRAWS; s++)
            count[(mcs_sobol_bits(77, 0, s) >> 27) * 32 + (mcs_sobol_bits(77, 1, s) >> 27)]++;
        uniform(count, BINS, DRAWS, "two dimensions of a point");
        /* two points of one sequence: in different halves by the net, else uniform */
        memset(count, 0, sizeof count);
        for (uint32_t s = 0; s < DRAWS; s++)
            count[(mcs_sobol_bits(0, 0, s) >> 27) * 32 + ((mcs_sobol_bits(1, 0, s) << 1) >> 27)]++;
        uniform(count, BINS, DRAWS, "the second point behind its first bit");
        memset(count, 0, sizeof count);
        for (uint32_t s = 0; s < DRAWS; s++) {
            const mcs_vec2 p = mcs_r2(5, s);
            count[(int)(p.x * 32) * 32 + (int)(p.y * 32)]++;
        }
        uniform(count, BINS, DRAWS, "a point of R2");
    }
    if (mcst_case("hash: bits and pairs")) {
        memset(count, 0, sizeof count);
        for (uint32_t i = 0; i < DRAWS; i++) count[mcs_hash(i, 3) >> 22]++;
        uniform(count, BINS, DRAWS, "the hash of a counter");
        memset(count, 0, sizeof count);
        for (uint32_t i = 0; i < DRAWS; i++) count[(mcs_hash(i, 0) & 31) * 32 + (mcs_hash(i, 1) & 31)]++;
        uniform(count, BINS, DRAWS, "hashes of neighbouring keys");
    }
    /* Indices that differ in bit 3 alone: shuffled, bit 0, 1, 2 or 3 is the lowest in which they differ, with
     * probabilities of 1/2, 1/4, 1/8, 1/8, and as far from the top the scrambled numbers of a group's first dimension
     * differ first. */
    if (mcst_case("groups: shuffled by the seed, and each by itself")) {
        double seen[16] = {0};
        double expected[16];
        for (uint32_t i = 0; i < 16; i++)
            expected[i] = (1 << 16) / (double)((2u << (i % 4 - i % 4 / 3)) * (2u << (i / 4 - i / 12)));
        for (uint32_t s = 0; s < 1 << 16; s++) {
            uint32_t at[2];
            for (uint32_t d = 0; d < 2; d++) {
                const uint32_t x = mcs_sobol_bits(77, 4 + 4 * d, s) ^ mcs_sobol_bits(77 ^ 8, 4 + 4 * d, s);
                for (at[d] = 0; at[d] < 3 && !(x >> (31 - at[d])); at[d]++) {}
            }
            seen[at[0] * 4 + at[1]]++;
        }
        CHECK(chi2_test(seen, expected, 16, NULL, NULL) >= sidak(0.01, 26), "the shuffles of groups 1 and 2");
    }
}

static unsigned char hit[1 << 20]; /* how often a cell was */

static void one_to_a_cell(uint32_t nx, uint32_t ny) {
    int one = 1;
    int inside = 1;
    memset(hit, 0, sizeof hit);
    for (uint32_t i = 0; i < nx * ny; i++) {
        const mcs_vec2 p = mcs_stratified(i, nx, ny, 9);
        const uint32_t x = (uint32_t)((double)p.x * nx);
        const uint32_t y = (uint32_t)((double)p.y * ny);
        inside &= p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1;
        one &= x == i % nx && y == i / nx && !hit[y * nx + x]++;
    }
    CHECK(one && inside, "cells or range");
}

static void one_to_a_slab(void) {
    for (uint32_t n = 1; n < 5000; n += n < 70 ? 1 : 331)
        for (uint32_t d = 0; d < 6; d++) {
            int one = 1;
            memset(hit, 0, n);
            for (uint32_t i = 0; i < n; i++) {
                const float x = mcs_latin(i, n, d, 4);
                const uint32_t slab = (uint32_t)((double)x * n);
                one &= x >= 0 && x < 1 && slab < n && !hit[slab]++;
            }
            CHECK(one, "n = %u, dimension %u", n, d);
        }
}

static void slabs_are_uniform(void) {
    enum { SLABS = 24, DRAWS = 1 << 18 };
    static double count[SLABS * SLABS];
    memset(count, 0, sizeof count);
    for (uint32_t i = 0; i < DRAWS; i++)
        count[(int)(mcs_latin(7, SLABS, 0, i) * SLABS) * SLABS + (int)(mcs_latin(7, SLABS, 1, i) * SLABS)]++;
    uniform(count, SLABS * SLABS, DRAWS, "the slab");
}

/* each point in each slab, each pair of points in each pair of slabs; points 0 and 8 of 16 differ in the bit that moves
 * last */
static void permutation_is_random(void) {
    enum { LARGEST = 16, LEFT = LARGEST - 1, DRAWS = 1 << 18 };
    static double slab[LARGEST], pair[LARGEST * LEFT];
    for (uint32_t n = 9; n <= LARGEST; n += 7)
        for (uint32_t k = 0; k < 3; k++) { /* the first, the middle, the last point */
            memset(slab, 0, sizeof slab);
            for (uint32_t i = 0; i < DRAWS; i++) slab[(int)((double)mcs_latin(k * (n - 1) / 2, n, 0, i) * n)]++;
            uniform(slab, (int)n, DRAWS, "the slab of one point");
        }
    memset(pair, 0, sizeof pair);
    for (uint32_t i = 0; i < DRAWS; i++) {
        const int a = (int)(mcs_latin(0, LARGEST, 0, i) * LARGEST);
        const int b = (int)(mcs_latin(8, LARGEST, 0, i) * LARGEST);
        pair[a * LEFT + b - (b > a)]++; /* b: of the slabs that a leaves */
    }
    uniform(pair, LARGEST * LEFT, DRAWS, "the pair of slabs of two points");
}

static void place_is_uniform(void) {
    enum { BINS = 16, SEED_COUNT = 1 << 14 };
    static double count[BINS * BINS];
    for (uint32_t k = 0; k < 3; k++) { /* 2: Latin hypercube */
        const uint32_t nx = k ? 3 : 4;
        const uint32_t ny = k == 1 ? 5 : nx + k / 2;
        memset(count, 0, sizeof count);
        for (uint32_t s = 0; s < SEED_COUNT; s++)
            for (uint32_t i = 0; i < nx * ny; i++) {
                const mcs_vec2 p = mcs_stratified(i, nx, ny, s);
                double x = (double)p.x * nx;
                double y = (double)p.y * ny;
                if (k == 2) {
                    x = (double)mcs_latin(i, nx * ny, 0, s) * (nx * ny);
                    y = (double)mcs_latin(i, nx * ny, 1, s) * (nx * ny);
                }
                count[(int)((x - floor(x)) * BINS) * BINS + (int)((y - floor(y)) * BINS)]++;
            }
        uniform(count, BINS * BINS, (double)SEED_COUNT * nx * ny, "the place within a cell");
    }
}

static void counts_out_of_range(void) {
    const uint32_t odd[] = {0, 1u << 21, 0xffffffffu};
    for (uint32_t i = 0; i < 9; i++) {
        const mcs_vec2 p = mcs_stratified(0xfffffff0u + i, odd[i % 3], odd[i / 3], i);
        const float l = mcs_latin(0xfffffff0u + i, odd[i % 3], odd[i / 3], i);
        CHECK(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1 && l >= 0 && l < 1, "%u, %u", odd[i % 3], odd[i / 3]);
    }
}

static void strata(void) {
    const uint32_t sizes[][2] = {{1, 1}, {2, 3}, {16, 16}, {7, 100}, {1, 4099}, {1000, 1000}, {1u << 20, 1}};
    for (uint32_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        if (mcst_case("one point to a cell, %u x %u", sizes[k][0], sizes[k][1]))
            one_to_a_cell(sizes[k][0], sizes[k][1]);
    if (mcst_case("Latin hypercube: one point to a slab in each dimension")) one_to_a_slab();
    if (mcst_case(
            "Latin hypercube: the slab of a point is uniform over seeds, and pairs of dimensions are independent"))
        slabs_are_uniform();
    if (mcst_case("Latin hypercube: the permutation is random over seeds")) permutation_is_random();
    if (mcst_case("the place within a cell is uniform, and independent in x and y")) place_is_uniform();
    if (mcst_case("counts out of range")) counts_out_of_range();
}

/* Coverage of R2 in one dimension. Gaps of N points of i alpha mod 1 are at most |q_(k-1) alpha| < 1/q_k for q_k <= N <
 * q_(k+1), the denominators of the convergents of alpha (three-gap theorem, Sos 1958); q_(k+1) <= (a_(k+1) + 1) q_k, so
 * gap N <= a + 1 with the largest partial quotient a up to there; one more for the rounding of points to 2^-24. */
static double gap_bound(double alpha, double n) {
    double a = 0;
    double q0 = 0;
    double q1 = 1;
    while (q1 <= n) {
        const double part = floor(1 / alpha);
        const double q = part * q1 + q0;
        alpha = 1 / alpha - part;
        a = part > a ? part : a;
        q0 = q1;
        q1 = q;
    }
    return a + 2;
}
static int by_value(const void *a, const void *b) {
    const float x = *(const float *)a;
    const float y = *(const float *)b;
    return x < y ? -1 : x > y;
}
static void r2_gaps(void) {
    static float v[2][N];
    if (!mcst_case("R2: no large gap in either projection")) return;
    for (uint32_t n = 16; n <= N; n *= 2) {
        for (uint32_t i = 0; i < n; i++) {
            const mcs_vec2 p = mcs_r2(i, 11);
            v[0][i] = p.x;
            v[1][i] = p.y;
        }
        for (uint32_t d = 0; d < 2; d++) {
            qsort(v[d], n, sizeof v[d][0], by_value);
            float gap = v[d][0] + 1 - v[d][n - 1];
            for (uint32_t i = 1; i < n; i++) gap = v[d][i] - v[d][i - 1] > gap ? v[d][i] - v[d][i - 1] : gap;
            CHECK((double)gap * n <= gap_bound(d ? 0.56984029099805327 : 0.75487766624669276, n),
                  "%u points, dimension %u: gap %g", n, d, (double)gap);
        }
    }
}

static void forms(void) {
    enum { MAX = 67 };
    float out[MAX + 2];
    if (mcst_case("the array form is the scalar one, every n, nothing beyond it, NULL"))
        for (uint32_t d = 0; d < 6; d++)
            for (uint32_t n = 0; n <= MAX; n++) {
                int same = 1;
                for (uint32_t i = 0; i < MAX + 2; i++) out[i] = -7;
                mcs_sobol_n(1000 + d, d, 5, n, out + 1);
                mcs_sobol_n(1000 + d, d, 5, n, NULL);
                for (uint32_t i = 0; i < n; i++) same &= out[1 + i] == mcs_sobol(1000 + d + i, d, 5);
                CHECK(same && out[0] == -7 && out[n + 1] == -7, "dimension %u, n = %u", d, n);
            }
#ifndef MCS_NO_WIDE
    if (mcst_case("wide forms"))
        for (uint32_t d = 0; d < 6; d++) {
            mcs4_u i4;
            mcs8_u i8;
            mcs16_u i16;
            for (uint32_t k = 0; k < 16; k++) i4[k & 3] = i8[k & 7] = i16[k] = 0;
            for (uint32_t k = 0; k < 16; k++) {
                i16[k] = mcs_hash(k, d);
                i8[k & 7] = i16[k & 7];
                i4[k & 3] = i16[k & 3];
            }
            for (uint32_t k = 0; k < 16; k++) {
                CHECK(mcs16_sobol_bits(i16, d, 3)[k] == mcs_sobol_bits(i16[k], d, 3), "16 wide, dimension %u", d);
                CHECK(mcs8_sobol_bits(i8, d, 3)[k & 7] == mcs_sobol_bits(i8[k & 7], d, 3), "8 wide, dimension %u", d);
                CHECK(mcs4_sobol_bits(i4, d, 3)[k & 3] == mcs_sobol_bits(i4[k & 3], d, 3), "4 wide, dimension %u", d);
                CHECK(mcs8_r2(i8, d).y[k & 7] == mcs_r2(i8[k & 7], d).y, "R2, 8 wide");
            }
        }
#endif
}

/* rms error over seeds of the mean of a smooth function of two dimensions, from 2^6 to 2^14 points: the slope of its
 * logarithm. Owen 1997: N^-1.5 up to logarithms for scrambled nets; independent points have -0.5. With 64 seeds the
 * logarithm (base 4) of an rms has a standard deviation of 1/sqrt(2*64)/ln 4 = 0.064, the fitted slope over 5 points
 * one of 0.064 sqrt(12/(5*24)) = 0.02: the bound of -1.3 leaves five of them to the -1.4 of the logarithms. Latin
 * hypercubes remove what is a sum of one-dimensional terms (Stein 1987). */
static double smooth(double x, double y) { return x * x * y + (x - 0.3) * y * y * y; }
static const double smooth_mean = 1.0 / 6 + 0.2 / 4;
static double slope(mcs_vec2 (*point)(uint32_t i, uint32_t n, uint32_t seed), double *last) {
    double sx = 0;
    double sy = 0;
    double sxx = 0;
    double sxy = 0;
    double e = 0;
    uint32_t runs = 0;
    for (uint32_t k = 3; k <= 7; k++) {
        const uint32_t n = 1u << (2 * k);
        e = 0;
        for (uint32_t seed = 0; seed < 64; seed++) {
            double m = 0;
            for (uint32_t i = 0; i < n; i++) {
                const mcs_vec2 p = point(i, n, seed);
                m += smooth((double)p.x, (double)p.y);
            }
            m = m / n - smooth_mean;
            e += m * m;
        }
        e = sqrt(e / 64);
        sx += k;
        sy += log(e) / log(4);
        sxx += k * (double)k;
        sxy += k * log(e) / log(4);
        runs++;
    }
    *last = e;
    return (runs * sxy - sx * sy) / (runs * sxx - sx * sx);
}
static mcs_vec2 by_sobol(uint32_t i, uint32_t n, uint32_t seed) {
    (void)n;
    mcs_vec2 p;
    p.x = mcs_sobol(i, 0, seed);
    p.y = mcs_sobol(i, 1, seed);
    return p;
}
static mcs_vec2 by_sobol_23(uint32_t i, uint32_t n, uint32_t seed) {
    (void)n;
    mcs_vec2 p;
    p.x = mcs_sobol(i, 2, seed);
    p.y = mcs_sobol(i, 3, seed);
    return p;
}
static mcs_vec2 by_strata(uint32_t i, uint32_t n, uint32_t seed) {
    uint32_t side = 1;
    while (side * side < n) side *= 2;
    return mcs_stratified(i, side, side, seed);
}
static mcs_vec2 by_latin(uint32_t i, uint32_t n, uint32_t seed) {
    mcs_vec2 p;
    p.x = mcs_latin(i, n, 0, seed);
    p.y = mcs_latin(i, n, 1, seed);
    return p;
}
static mcs_vec2 by_r2(uint32_t i, uint32_t n, uint32_t seed) {
    (void)n;
    return mcs_r2(i, seed);
}
static mcs_vec2 by_philox(uint32_t i, uint32_t n, uint32_t seed) {
    const mcs_philox4 v = mcs_philox(seed, i, n);
    mcs_vec2 p;
    p.x = mcs_u01(v.v[0]);
    p.y = mcs_u01(v.v[1]);
    return p;
}
static void rates(void) {
    if (!mcst_case("rates on a smooth integrand")) return;
    double sobol;
    double s = slope(by_sobol, &sobol);
    CHECK(s <= -1.3, "Sobol 0, 1: N^%.2f", s);
    double pair;
    s = slope(by_sobol_23, &pair);
    CHECK(s <= -1.3, "Sobol 2, 3: N^%.2f", s);
    double strata_error;
    s = slope(by_strata, &strata_error); /* one point to a cell: the variance is that within cells, N^-2, so N^-1 */
    CHECK(fabs(s + 1) <= 0.1, "stratified: N^%.2f", s);
    double r2;
    s = slope(by_r2, &r2);
    CHECK(s <= -0.54, "R2: N^%.2f",
          s); /* N^-1, but for a factor up to a + 1 = 13 between good and bad N: 1 - ln 13 / ln 2^8 */
    double independent;
    s = slope(by_philox, &independent);
    CHECK(fabs(s + 0.5) <= 0.1, "independent: N^%.2f", s);
    double latin;
    s = slope(by_latin, &latin);
    CHECK(fabs(s + 0.5) <= 0.1 && latin < 0.6 * independent, "Latin hypercube: N^%.2f, error %g of %g", s, latin,
          independent);
}

/* ---- points across a picture ---- */

/* The pixels of a square whose sides are 2^k and a multiple of which is (x, y) have 4^k blocks of points in a row, from
 * a multiple of that on. */
static int square_is_block(uint32_t x, uint32_t y, uint32_t k, uint32_t log_n, uint32_t seed) {
    const uint32_t pixels = 1u << (2 * k);
    const uint32_t first = mcs_sobol_pixel(x, y, 1u << log_n, seed) >> log_n >> (2 * k);
    int good = 1;
    memset(hit, 0, pixels);
    for (uint32_t i = 0; i < pixels; i++) {
        const uint32_t index = mcs_sobol_pixel(x + i % (1u << k), y + (i >> k), 1u << log_n, seed);
        good &= index % (1u << log_n) == 0 && index >> log_n >> (2 * k) == first;
        good &= !hit[(index >> log_n) % pixels]++;
    }
    return good;
}
static void squares(void) {
    if (mcst_case("squares of pixels have blocks of points"))
        for (uint32_t log_n = 0; log_n <= 20; log_n++)
            for (uint32_t k = 0; k <= 6; k++) {
                const uint32_t side = 1u << k;
                CHECK(square_is_block(0, 0, k, log_n, 1), "2^%u points, %u pixels at (0, 0)", log_n, side);
                CHECK(square_is_block(37 * side, 5 * side, k, log_n, 2), "2^%u points, %u pixels", log_n, side);
                CHECK(square_is_block(0u - side, side << 9, k, log_n, 3), "2^%u points, %u pixels", log_n, side);
            }
    if (mcst_case("the points of a pixel are a net"))
        for (uint32_t i = 0; i < 8; i++) {
            const uint32_t first = mcs_sobol_pixel(1000 + i % 4, i / 4, N, i / 2);
            CHECK(broken_shapes(first, 0, 1, 0, i / 2) == 0, "pixel %u", i);
            CHECK(broken_shapes(first, 4, 5, 0, i / 2) == 0, "pixel %u, the second group", i);
        }
    if (mcst_case("how many points a pixel has: rounded up, 1 to 2^20")) {
        CHECK(mcs_sobol_pixel(3, 5, 0, 1) == mcs_sobol_pixel(3, 5, 1, 1), "0");
        CHECK(mcs_sobol_pixel(3, 5, 3, 1) == mcs_sobol_pixel(3, 5, 4, 1), "3");
        CHECK(mcs_sobol_pixel(3, 5, 513, 1) == mcs_sobol_pixel(3, 5, 1024, 1), "513");
        CHECK(mcs_sobol_pixel(3, 5, 0xffffffffu, 1) == mcs_sobol_pixel(3, 5, 1u << 20, 1), "2^32 - 1");
    }
}

/* Which of the 24 orders the quadrants have in the square of 2^(level + 1) pixels at (x, y). */
static uint32_t order(uint32_t x, uint32_t y, uint32_t level, uint32_t seed) {
    uint32_t digit[4];
    for (uint32_t i = 0; i < 4; i++) {
        const uint32_t index = mcs_sobol_pixel(x + (i % 2 << level), y + (i / 2 << level), 4, seed);
        digit[i] = index >> 2 >> (2 * level) & 3;
    }
    const uint32_t second = digit[1] - (digit[1] > digit[0]);
    const uint32_t third = digit[2] - (digit[2] > digit[0]) - (digit[2] > digit[1]);
    return digit[0] * 6 + second * 2 + third;
}
static void orders(void) {
    enum { ORDERS = 24, DRAWS = 1 << 17 };
    static double count[ORDERS * ORDERS];
    if (!mcst_case("the order of four is random over squares, levels and seeds")) return;
    memset(count, 0, sizeof count);
    for (uint32_t i = 0; i < DRAWS; i++) count[order(i % 512 * 2, i / 512 * 2, 0, 1)]++;
    uniform(count, ORDERS, DRAWS, "the order of a square");
    memset(count, 0, sizeof count);
    for (uint32_t i = 0; i < DRAWS; i++)
        count[order(i % 512 * 4, i / 512 * 4, 0, 1) * ORDERS + order(i % 512 * 4 + 2, i / 512 * 4, 0, 1)]++;
    uniform(count, ORDERS * ORDERS, DRAWS, "the pair of orders of neighbours");
    memset(count, 0, sizeof count);
    for (uint32_t i = 0; i < DRAWS; i++) count[order(0, 0, 0, i) * ORDERS + order(0, 0, 1, i)]++;
    uniform(count, ORDERS * ORDERS, DRAWS, "the pair of orders of two levels");
    memset(count, 0, sizeof count);
    for (uint32_t i = 0; i < DRAWS; i++) {
        const uint32_t x = i % 512 * 2;
        const uint32_t y = i / 512 * 2;
        count[order(x, y, 0, 1) * ORDERS + order(x, y, 0, 2)]++;
    }
    uniform(count, ORDERS * ORDERS, DRAWS, "the pair of orders of neighbouring seeds");
}

/* Seed and first dimension of the pictures below. */
static uint32_t picture_seed, picture_dim;
static mcs_vec2 pixel_sobol(uint32_t x, uint32_t y, uint32_t s, uint32_t n) {
    const uint32_t index = mcs_sobol_pixel(x, y, n, picture_seed) + s;
    mcs_vec2 p;
    p.x = mcs_sobol(index, picture_dim, picture_seed);
    p.y = mcs_sobol(index, picture_dim + 1, picture_seed);
    return p;
}
static mcs_vec2 pixel_philox(uint32_t x, uint32_t y, uint32_t s, uint32_t n) {
    (void)n;
    return by_philox(s, x, y);
}
static double smooth_error(mcs_vec2 p) { return smooth((double)p.x, (double)p.y) - smooth_mean; }
/* erf(1)^2 pi/4 is its mean. */
static double bell_error(mcs_vec2 p) {
    return exp(-(double)p.x * (double)p.x - (double)p.y * (double)p.y) - 0.557746285;
}

/* A wave has its own frequency alone. */
static void transform(void) {
    double re[SPECTRUM_W], im[SPECTRUM_W];
    if (!mcst_case("the transform of a wave")) return;
    for (uint32_t wave = 0; wave < SPECTRUM_W; wave += 5) {
        for (uint32_t i = 0; i < SPECTRUM_W; i++) {
            const double turn = 2 * 3.14159265358979323846 * (i * wave % SPECTRUM_W) / SPECTRUM_W;
            re[i] = cos(turn);
            im[i] = sin(turn);
        }
        spectrum_transform(re, im, 1);
        for (uint32_t i = 0; i < SPECTRUM_W; i++)
            CHECK(fabs(re[i] - (i == wave ? SPECTRUM_W : 0)) < 1e-10 && fabs(im[i]) < 1e-10, "wave %u at %u: %g, %g",
                  wave, i, re[i], im[i]);
    }
}
/* Below 1/16 cycles a pixel are 800 frequencies, of which half are those of the other half mirrored: the mean of 400
 * numbers with an exponential distribution, where the error is white, has a standard deviation of 0.05. */
static void spectra(void) {
    enum { LOW = SPECTRUM_W / 16 };
    transform();
    for (uint32_t n = 1; n <= 16; n *= 4) {
        if (mcst_case("independent points, %u a pixel: white noise", n)) {
            const spectrum s = spectrum_of(pixel_philox, smooth_error, 0, 0, n);
            CHECK(fabs(spectrum_mean(&s, 1, LOW) - 1) <= 0.25, "%g", spectrum_mean(&s, 1, LOW));
        }
        if (!mcst_case("points across a picture, %u a pixel: low frequencies have at most a tenth", n)) continue;
        for (picture_seed = 0; picture_seed < 3; picture_seed++)
            for (picture_dim = 0; picture_dim < 6; picture_dim += 2) {
                /* In steps of half a tile or less; the last one lies across the end of the numbers of pixels. */
                const uint32_t at = picture_seed < 2 ? 77 * picture_seed : 0u - 100;
                const uint32_t low = picture_dim == 2 ? LOW / 2 : LOW;
                spectrum s = spectrum_of(pixel_sobol, smooth_error, at, 2 * at, n);
                CHECK(spectrum_mean(&s, 1, low) <= 0.1, "seed %u, dimension %u: %g", picture_seed, picture_dim,
                      spectrum_mean(&s, 1, low));
                if (picture_dim > 0) continue;
                s = spectrum_of(pixel_sobol, bell_error, at, 2 * at, n);
                CHECK(spectrum_mean(&s, 1, low) <= 0.1, "a bell, seed %u: %g", picture_seed, spectrum_mean(&s, 1, low));
            }
    }
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("points, nets");
    nets();
    columns();
    mcst_group("points, randomisation");
    randomisation();
    mcst_group("points, strata");
    strata();
    r2_gaps();
    mcst_group("points, forms");
    forms();
    mcst_group("points, rates");
    rates();
    mcst_group("points, pictures");
    squares();
    orders();
    spectra();
    return mcst_finish();
}
