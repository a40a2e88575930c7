/* Uniform variates: published reference outputs, jump-ahead, integer to float, batch fills. */
#include <math.h>
#include "mcs_test.h"
#define MCS_PACKETS 16
#include "mcsample.h"
#include "stats.h"

enum { FILL_MAX = 67, GUARD = 16 };
static const double level = 1e-5; /* of one statistical test: Sidak, 1000 of them in the whole suite at 0.01 together */
static const float guard_value = -12345.5f; /* no generator of [0,1) can write it */

/* ---- PCG32 ---- */

/* O'Neill's bounded draw of the demo: rejection of the first 2^32 mod bound values. */
static uint32_t demo_bounded(mcs_pcg32 *r, uint32_t bound) {
    const uint32_t threshold = (0u - bound) % bound;
    uint32_t v;
    do v = mcs_pcg32_next(r);
    while (v < threshold);
    return v % bound;
}

/* The five rounds of the pcg32 demo (pcg-c, test-high/expected/check-pcg32.out): six words, stepped back over and drawn
 * again, 65 coins, 33 dice, a shuffle of 52 cards. Coins as bits, the first in bit 0; heads are 1. Dice from 1. */
static void test_pcg32_demo(void) {
    static const uint32_t words[5][6] = {
        {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu},
        {0x74ab93adu, 0x1c1da000u, 0x494ff896u, 0x34462f2fu, 0xd308a3e5u, 0x0fa83babu},
        {0x39af5f9fu, 0x04196b18u, 0xc3c3eb28u, 0xc076c60cu, 0xc693e135u, 0xf8f63932u},
        {0x55ce6851u, 0x97a7726du, 0x17e10815u, 0x58007d43u, 0x962fb148u, 0xb9bb55bdu},
        {0xfcef7cd6u, 0x1b488b5au, 0xd0daf7eau, 0x1d9a70f7u, 0x241a37cfu, 0x9a3857b7u}};
    static const char coins[] = "HHTTTHTHHHTHTTTHHHHHTTTHHHTHTHTHTTHTTTHHHHHHTTTTHHTTTTTHTTTTTTTHT";
    static const char rolls[] = "341122324324335231315141564662633";
    mcs_pcg32 r = mcs_pcg32_make(42, 54);
    for (int round = 0; round < 5; round++) {
        for (int i = 0; i < 6; i++) {
            const uint32_t v = mcs_pcg32_next(&r);
            CHECK(v == words[round][i], "round %d word %d: %08x, not %08x", round, i, v, words[round][i]);
        }
        mcs_pcg32_advance(&r, (uint64_t)0 - 6);
        for (int i = 0; i < 6; i++) CHECK(mcs_pcg32_next(&r) == words[round][i], "round %d word %d again", round, i);
        for (int i = 0; i < 65; i++) {
            const char c = demo_bounded(&r, 2) ? 'H' : 'T';
            CHECK(round || c == coins[i], "coin %d: %c", i, c);
        }
        for (int i = 0; i < 33; i++) {
            const char c = (char)('1' + (int)demo_bounded(&r, 6));
            CHECK(round || c == rolls[i], "roll %d: %c", i, c);
        }
        for (int i = 52; i > 1; i--) demo_bounded(&r, (uint32_t)i);
    }
}

static void test_pcg32_advance(void) {
    static const uint64_t far[] = {
        1, 0xffffffffu, 0x100000000u, 0x8000000000000000u, 0x123456789abcdef1u, 0xffffffffffffffffu};
    if (mcst_case("forward and backward equal stepping")) {
        mcs_pcg32 step = mcs_pcg32_make(mcst.seed, 3);
        const mcs_pcg32 start = step;
        uint64_t k;
        for (k = 0; k <= 3000; k++) {
            mcs_pcg32 jump = start;
            mcs_pcg32 back = step;
            mcs_pcg32_advance(&jump, k);
            mcs_pcg32_advance(&back, (uint64_t)0 - k);
            CHECK(jump.state == step.state && jump.inc == step.inc, "forward %llu", (unsigned long long)k);
            CHECK(back.state == start.state && back.inc == start.inc, "backward %llu", (unsigned long long)k);
            mcs_pcg32_next(&step);
        }
        for (; k < 1000003; k++) mcs_pcg32_next(&step);
        {
            mcs_pcg32 jump = start;
            mcs_pcg32_advance(&jump, k);
            CHECK(jump.state == step.state, "forward %llu", (unsigned long long)k);
        }
    }
    if (mcst_case("jumps add modulo the period 2^64")) {
        for (size_t i = 0; i < sizeof far / sizeof *far; i++)
            for (size_t j = 0; j < sizeof far / sizeof *far; j++) {
                mcs_pcg32 a = mcs_pcg32_make(7, 9);
                mcs_pcg32 b = a;
                mcs_pcg32_advance(&a, far[i]);
                mcs_pcg32_advance(&a, far[j]);
                mcs_pcg32_advance(&b, far[i] + far[j]);
                CHECK(a.state == b.state, "%llx + %llx", (unsigned long long)far[i], (unsigned long long)far[j]);
            }
    }
}

/* Over all pairs of 256 streams and 64 places, equal words come by chance about 256*255/2*64/2^32 = 5e-4 times in all.
 */
static void test_pcg32_streams(void) {
    enum { STREAMS = 256, WORDS = 64 };
    static uint32_t v[STREAMS][WORDS];
    int same = 0;
    for (int a = 0; a < STREAMS; a++) {
        mcs_pcg32 r = mcs_pcg32_make(mcst.seed, (uint64_t)a);
        for (int i = 0; i < WORDS; i++) v[a][i] = mcs_pcg32_next(&r);
    }
    for (int a = 0; a < STREAMS; a++)
        for (int b = 0; b < a; b++)
            for (int i = 0; i < WORDS; i++) same += v[a][i] == v[b][i];
    CHECK(same <= 1, "%d equal words", same);
}

static void test_pcg32_float(void) {
    mcs_pcg32 a = mcs_pcg32_make(1, 2);
    mcs_pcg32 b = a;
    for (int i = 0; i < 100000; i++) {
        const float f = mcs_pcg32_float(&a);
        const float g = mcs_u01(mcs_pcg32_next(&b));
        CHECK(f == g, "draw %d: %a, not %a", i, (double)f, (double)g);
    }
}

/* ---- Philox ---- */

/* Random123 (Salmon, Moraes, Dror, Shaw 2011), kat_vectors, the three lines "philox4x32 10". */
static void test_philox_known_answers(void) {
    static const struct {
        uint64_t key, lo, hi;
        uint32_t v[4];
    } kat[3] = {{0, 0, 0, {0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u}},
                {0xffffffffffffffffu,
                 0xffffffffffffffffu,
                 0xffffffffffffffffu,
                 {0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu}},
                {0x299f31d0a4093822u,
                 0x85a308d3243f6a88u,
                 0x0370734413198a2eu,
                 {0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}}};
    for (int i = 0; i < 3; i++) {
        const mcs_philox4 b = mcs_philox(kat[i].key, kat[i].lo, kat[i].hi);
        for (int j = 0; j < 4; j++)
            CHECK(b.v[j] == kat[i].v[j], "vector %d word %d: %08x, not %08x", i, j, b.v[j], kat[i].v[j]);
    }
}

/* 128 bits made of three words. */
typedef void mixer(uint64_t a, uint64_t b, uint64_t c, uint32_t out[4]);
static void mix_philox(uint64_t a, uint64_t b, uint64_t c, uint32_t out[4]) {
    const mcs_philox4 block = mcs_philox(a, b, c);
    memcpy(out, block.v, sizeof block.v);
}
/* One flipped input bit flips each of the 128 output bits with probability 1/2. Over T trials the count of flips of one
 * output bit by one input bit is binomial(T, 1/2); 192 input by 128 output bits are 24576 counts, and 6.5 standard
 * deviations are passed by one of them with probability 24576 * 8e-11 = 2e-6. Returns how many do. */
static int avalanche(mixer *mix) {
    enum { TRIALS = 256 };
    static int flips[192][128];
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 77);
    int bad = 0;
    memset(flips, 0, sizeof flips);
    for (int t = 0; t < TRIALS; t++) {
        uint64_t w[3];
        for (int in = 0; in < 3; in++) {
            w[in] = mcs_pcg32_next(&r);
            w[in] = w[in] << 32 | mcs_pcg32_next(&r);
        }
        uint32_t base[4];
        mix(w[0], w[1], w[2], base);
        for (int in = 0; in < 192; in++) {
            w[in >> 6] ^= (uint64_t)1 << (in & 63);
            uint32_t b[4];
            mix(w[0], w[1], w[2], b);
            w[in >> 6] ^= (uint64_t)1 << (in & 63);
            for (int out = 0; out < 128; out++)
                flips[in][out] += (int)((b[out >> 5] ^ base[out >> 5]) >> (out & 31) & 1u);
        }
    }
    for (int in = 0; in < 192; in++)
        for (int out = 0; out < 128; out++) bad += !(fabs(flips[in][out] - TRIALS / 2.0) <= 6.5 * sqrt(TRIALS / 4.0));
    return bad;
}

/* ---- generators of neighbours ---- */

/* Ways to a generator for pixel and sample: that of the header, and those that were tried before it was there. */
typedef mcs_pcg32 start(uint64_t seed, uint64_t pixel, uint64_t sample);
static mcs_pcg32 start_stream(uint64_t seed, uint64_t pixel, uint64_t sample) {
    return mcs_pcg32_make(seed + sample, pixel);
}
static mcs_pcg32 start_seed(uint64_t seed, uint64_t pixel, uint64_t sample) {
    return mcs_pcg32_make(seed ^ pixel, sample);
}

/* The first four words of a generator, as 128 bits that depend on its arguments. */
static start *mixed_by;
static void mix_first_words(uint64_t a, uint64_t b, uint64_t c, uint32_t out[4]) {
    mcs_pcg32 r = mixed_by(a, b, c);
    for (int i = 0; i < 4; i++) out[i] = mcs_pcg32_next(&r);
}

enum { NEIGHBOURS = 1 << 20, FAMILIES = 11 };
static const char *const family_name[FAMILIES] = {"(k, k, 0)",     "(1, k << 40, 0)", "(1, k, 0)",         "(k, 0, 0)",
                                                  "(1, 0, k)",     "(1, 0, k << 40)", "(0, k, k)",         "(k, k, k)",
                                                  "(seed, -k, 7)", "(k << 44, 0, 0)", "(seed, x + y w, s)"};
static void family(int i, uint64_t k, uint64_t a[3]) {
    const uint64_t x = k & 127;
    const uint64_t y = k >> 7 & 127;
    const uint64_t s = k >> 14; /* a corner of a picture that is 1920 pixels wide, with 64 samples */
    const uint64_t all[FAMILIES][3] = {{k, k, 0},
                                       {1, k << 40, 0},
                                       {1, k, 0},
                                       {k, 0, 0},
                                       {1, 0, k},
                                       {1, 0, k << 40},
                                       {0, k, k},
                                       {k, k, k},
                                       {mcst.seed, 0 - k, 7},
                                       {k << 44, 0, 0},
                                       {mcst.seed, x + y * 1920, s}};
    memcpy(a, all[i], sizeof all[i]);
}

/* Over 2^20 neighbours: the first number of k beside that of k + 1, and the first beside the second of each, as pairs
 * over 64 x 64 cells, counts that are too even as unlikely as those that are too uneven, and their correlation: for
 * independent numbers it is 0 with a standard deviation of 1/sqrt(n), n = 2^20 or 2^19. Returns the least p of the
 * four, each doubled as it has two sides. */
static double least_p(start *of, int which) {
    static double count[4096], expect[4096];
    static float u[2][NEIGHBOURS];
    double least = 1;
    for (int k = 0; k < NEIGHBOURS; k++) {
        uint64_t a[3];
        family(which, (uint64_t)k, a);
        mcs_pcg32 r = of(a[0], a[1], a[2]);
        u[0][k] = mcs_pcg32_float(&r);
        u[1][k] = mcs_pcg32_float(&r);
    }
    for (int along = 0; along < 2; along++) {
        const int step = along ? 2 : 1;
        const double n = NEIGHBOURS / step;
        double sum = 0;
        for (int k = 0; k < 4096; k++) {
            count[k] = 0;
            expect[k] = n / 4096;
        }
        for (int k = 0; k < NEIGHBOURS; k += step) {
            const float v = u[0][k];
            const float w = along ? u[0][k + 1] : u[1][k];
            count[(int)(v * 64) * 64 + (int)(w * 64)] += 1;
            sum += 12 * ((double)v - 0.5) * ((double)w - 0.5);
        }
        const double p = chi2_test(count, expect, 4096, NULL, NULL);
        least = fmin(least, 2 * fmin(p, 1 - p));
        least = fmin(least, erfc(fabs(sum) / sqrt(2 * n)));
    }
    return least;
}

static void test_neighbours(void) {
    for (int i = 0; i < FAMILIES; i++)
        if (mcst_case("neighbours %s", family_name[i])) {
            const double p = least_p(mcs_pcg32_for, i);
            CHECK(p >= level, "p = %g", p);
        }
    if (mcst_case("avalanche of the first words")) {
        mixed_by = mcs_pcg32_for;
        const int off = avalanche(mix_first_words);
        CHECK(off == 0, "%d of the 24576 counts are off", off);
    }
    if (mcst_case("the reference start fails these tests")) { /* what they are worth: mcs_pcg32_make is no substitute */
        static const int visible[] = {0, 1, 2, 3, 10};
        for (int i = 0; i < (int)(sizeof visible / sizeof *visible); i++) {
            const double p = fmin(least_p(start_stream, visible[i]), least_p(start_seed, visible[i]));
            CHECK(p < level, "%s: p = %g", family_name[visible[i]], p);
        }
        mixed_by = start_stream;
        CHECK(avalanche(mix_first_words) > 0, "its first words depend on all bits");
    }
}

/* ---- integer to float ---- */

static void test_u01(void) {
    if (mcst_case("u01: all 2^24 values, exact, each for 256 words")) {
        const uint32_t low[3] = {0, 0xff, 0x5a};
        int bad = 0;
        for (uint32_t k = 0; k < 1u << 24; k++) {
            const double want = k * 0x1p-24;
            for (int j = 0; j < 3; j++) bad += !((double)mcs_u01(k << 8 | low[j]) == want);
        }
        CHECK(bad == 0, "%d of 3 * 2^24 values differ from (bits >> 8) * 2^-24", bad);
        for (uint32_t k = 0; k < 256; k++) {
            CHECK(mcs_u01(k) == 0.0f, "low bits %x", k);
            CHECK(mcs_u01(0xffffff00u | k) == 0x0.ffffffp0f, "top word %x: %a", 0xffffff00u | k,
                  (double)mcs_u01(0xffffff00u | k));
        }
        CHECK(mcs_u01(0xffffffffu) < 1.0f, "top word reaches 1");
    }
    if (mcst_case("u01_open: all 2^23 values, inside (0,1), symmetric")) {
        int bad = 0;
        for (uint32_t k = 0; k < 1u << 23; k++) {
            const uint32_t bits = k << 9 | (k * 37 & 511);
            const float u = mcs_u01_open(bits);
            bad += !((double)u == (k + 0.5) * 0x1p-23) || !(u > 0.0f && u < 1.0f) || !(mcs_u01_open(~bits) == 1.0f - u);
        }
        CHECK(bad == 0, "%d of 2^23 values are wrong", bad);
        CHECK(mcs_u01_open(0) == 0x1p-24f, "%a", (double)mcs_u01_open(0));
        CHECK(mcs_u01_open(0xffffffffu) == 0x0.ffffffp0f, "%a", (double)mcs_u01_open(0xffffffffu));
    }
}

#ifndef MCS_NO_WIDE
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi" /* wide functions are inlined: no vector crosses a call */
#endif
#define WIDE(W)                                                                                                    \
    static void wide##W(const uint32_t *bits) {                                                                    \
        mcs##W##_u b;                                                                                              \
        mcs##W##_f u, open;                                                                                        \
        int i;                                                                                                     \
        memcpy(&b, bits, sizeof b);                                                                                \
        u = mcs##W##_u01(b);                                                                                       \
        open = mcs##W##_u01_open(b);                                                                               \
        for (i = 0; i < W; i++)                                                                                    \
            CHECK(u[i] == mcs_u01(bits[i]) && open[i] == mcs_u01_open(bits[i]), #W " wide, lane %d, word %08x", i, \
                  bits[i]);                                                                                        \
    }
WIDE(4)
WIDE(8)
WIDE(16)

static void test_u01_wide(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 6);
    for (int i = 0; i < 10000; i++) {
        uint32_t bits[16];
        for (int k = 0; k < 16; k++)
            bits[k] = i == 0 ? 0xffffffffu - (uint32_t)k : i == 1 ? (uint32_t)k << 7 : mcs_pcg32_next(&r);
        wide4(bits);
        wide8(bits);
        wide16(bits);
    }
}
#endif

/* ---- fills ---- */

typedef void fill_fn(void *state, uint64_t where, size_t n, float *out);

static void fill_pcg(void *state, uint64_t where, size_t n, float *out) {
    (void)where;
    mcs_pcg32_fill_n((mcs_pcg32 *)state, n, out);
}

static void fill_philox(void *state, uint64_t where, size_t n, float *out) {
    mcs_philox_fill_n(*(uint64_t *)state, where, n, out);
}

/* Fills n values at a place of every alignment of a float within 64 bytes; the guards on both sides must stay. */
static void check_fill(fill_fn *fill, void *state, uint64_t where, size_t n, size_t shift, const float *want) {
    static float buf[GUARD + 16 + 4096 + GUARD];
    const size_t begin = GUARD + shift;
    const size_t total = begin + n + GUARD;
    int same = 1;
    int kept = 1;
    for (size_t i = 0; i < total; i++) buf[i] = guard_value;
    fill(state, where, n, buf + begin);
    for (size_t i = 0; i < total; i++) {
        if (i >= begin && i < begin + n) same &= buf[i] == want[i - begin];
        else kept &= buf[i] == guard_value;
    }
    CHECK(same, "n = %zu, shift %zu: differs from the scalar sequence", n, shift);
    CHECK(kept, "n = %zu, shift %zu: written outside", n, shift);
}

static void test_fills(void) {
    static float want[4096];
    if (mcst_case("pcg32_fill_n equals the scalar sequence, n = 0..67 and 4093")) {
        for (size_t n = 0; n <= FILL_MAX + 1; n++) {
            const size_t count = n <= FILL_MAX ? n : 4093;
            for (size_t shift = 0; shift < 16; shift++) {
                mcs_pcg32 a = mcs_pcg32_make(n, shift);
                mcs_pcg32 b = a;
                for (size_t i = 0; i < count; i++) want[i] = mcs_pcg32_float(&a);
                check_fill(fill_pcg, &b, 0, count, shift, want);
                CHECK(a.state == b.state && a.inc == b.inc, "n = %zu: state after the fill", count);
            }
        }
    }
    if (mcst_case("philox_fill_n equals the blocks, n = 0..67 and 4093")) {
        static const uint64_t starts[] = {0, 1, 0xfffffffcu,
                                          0xfffffffffffffffcu}; /* carries into the upper half, and wraps */
        uint64_t key = 0x0123456789abcdefu;
        for (size_t s = 0; s < sizeof starts / sizeof *starts; s++)
            for (size_t n = 0; n <= FILL_MAX + 1; n++) {
                const size_t count = n <= FILL_MAX ? n : 4093;
                for (size_t i = 0; i < count; i++) want[i] = mcs_u01(mcs_philox(key, starts[s] + i / 4, 0).v[i & 3]);
                for (size_t shift = 0; shift<16; shift += n> 20 ? 3 : 1)
                    check_fill(fill_philox, &key, starts[s], count, shift, want);
            }
    }
    if (mcst_case("fills accept NULL")) {
        mcs_pcg32 a = mcs_pcg32_make(1, 1);
        mcs_pcg32 b = a;
        mcs_pcg32_fill_n(&a, 0, NULL);
        mcs_pcg32_fill_n(&a, 5, NULL);
        mcs_pcg32_advance(&b, 5);
        CHECK(a.state == b.state && a.inc == b.inc, "the state is not 5 draws on");
        mcs_philox_fill_n(1, 2, 0, NULL);
        mcs_philox_fill_n(1, 2, 5, NULL);
    }
}

/* 2^22 floats over 2^12 cells; then neighbours (u_2i, u_2i+1) over 64 x 64 cells. Expected counts 1024 and 512. */
static void check_uniform(const char *what, const float *u, size_t n) {
    static double count[4096], expect[4096];
    for (int pairs = 0; pairs < 2; pairs++) {
        const double total = pairs ? (double)n / 2 : (double)n;
        for (size_t i = 0; i < 4096; i++) {
            count[i] = 0;
            expect[i] = total / 4096;
        }
        if (pairs)
            for (size_t i = 0; i + 1 < n; i += 2) count[(int)(u[i] * 64) * 64 + (int)(u[i + 1] * 64)] += 1;
        else
            for (size_t i = 0; i < n; i++) count[(int)(u[i] * 4096)] += 1;
        const double p = chi2_test(count, expect, 4096, NULL, NULL);
        CHECK(p >= level, "%s%s: p = %g", what, pairs ? ", pairs" : "", p);
    }
}

static void test_uniformity(void) {
    const size_t n = (size_t)1 << 22;
    float *u = (float *)malloc(n * sizeof *u);
    CHECK(u != NULL, "out of memory");
    if (u) {
        mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 5);
        mcs_pcg32_fill_n(&r, n, u);
        check_uniform("pcg32", u, n);
        mcs_philox_fill_n(mcst.seed, 0, n, u);
        check_uniform("philox", u, n);
    }
    free(u);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("pcg32");
    if (mcst_case("five rounds of the published demo")) test_pcg32_demo();
    test_pcg32_advance();
    if (mcst_case("streams differ")) test_pcg32_streams();
    if (mcst_case("float is u01 of the word")) test_pcg32_float();
    mcst_group("philox");
    if (mcst_case("known-answer vectors")) test_philox_known_answers();
    if (mcst_case("avalanche")) CHECK(avalanche(mix_philox) == 0, "some of the 24576 counts are off");
    mcst_group("neighbouring generators");
    test_neighbours();
    mcst_group("u01");
    test_u01();
#ifndef MCS_NO_WIDE
    if (mcst_case("4, 8, 16 wide equal scalar")) test_u01_wide();
#endif
    mcst_group("fills");
    test_fills();
    if (mcst_case("chi-square of values and pairs")) test_uniformity();
    return mcst_finish();
}
