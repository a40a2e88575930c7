/* Tables on the unit square: shares against the list itself in long double, samples against densities and inverses,
 * chi-square, array forms, bad input, errors, the same bytes in any memory. */
#include "arena.h"
#include "mcs_test.h"
#include "mcsample.h"
#include "stats.h"
#include <float.h>
#include <math.h>

enum { SIZES = 7, FILLS = 8, MOST = 70 * 90 };
static const uint32_t sizes[SIZES][2] = {{1, 1}, {1, 9}, {9, 1}, {2, 3}, {6, 5}, {70, 90}, {33, 4}};
static const char *const fill_name[FILLS] = {"random",        "steep",       "one cell",      "zeros",
                                             "huge and tiny", "bad entries", "one tiny cell", "all tiny"};
static float list[MOST];
static const long double step = 0x1p-24L;    /* of u, and the rounding of a float below 1 */
static const long double quantum = 0x1p-31L; /* of shares */

static float entry(int fill, uint32_t i, uint32_t n) {
    static const float extreme[] = {FLT_MAX, 1e-45f, 0, 1, 3e38f, FLT_MIN};
    static const float bad[] = {NAN, -1, 2, INFINITY, -INFINITY, 1e30f, 0};
    const float u = mcs_u01(mcs_hash(i, (uint32_t)fill));
    switch (fill) {
    case 0: return u < 0.2f ? 0 : u;
    case 1: return expf(60 * u - 30);
    case 2: return i == n / 2 ? 3.0f : 0.0f;
    case 3: return 0;
    case 4: return extreme[mcs_hash(i, 3) % 6];
    case 5: return bad[mcs_hash(i, 4) % 7];
    case 6: return i == n / 2 ? 1e-45f : i == 0 ? 1.0f : 0.0f;
    default: return u < 0.9f ? 0 : 1e-44f * u;
    }
}
static uint32_t fill_list(int fill, uint32_t n) {
    uint32_t bad = 0;
    for (uint32_t i = 0; i < n; i++) {
        list[i] = entry(fill, i, n);
        bad += !(list[i] >= 0 && list[i] <= FLT_MAX);
    }
    return bad;
}
static long double counts_as(float x) { return x > 0 ? (long double)fminf(x, FLT_MAX) : 0; }

/* Shares of 2^31 are off by as many as there are entries, as each that is not zero has one beforehand, and by one that
 * is cut off. The weight of a row is a float. */
static void check_shares(const mcs_pwc2 *t, uint32_t w, uint32_t h) {
    long double total = 0;
    long double sum = 0;
    for (uint32_t i = 0; i < w * h; i++) total += counts_as(list[i]);
    CHECK(fabsl((long double)t->total - total) <= 1e-12L * total && t->uniform == !(total > 0), "total %g", t->total);
    for (uint32_t row = 0; row < h; row++) {
        long double in_row = 0;
        for (uint32_t col = 0; col < w; col++) in_row += counts_as(list[row * w + col]);
        for (uint32_t col = 0; col < w; col++) {
            const float x = ((float)col + 0.5f) / (float)w;
            const float y = ((float)row + 0.5f) / (float)h;
            const long double cell = counts_as(list[row * w + col]);
            const long double of_row = total > 0 ? in_row / total : 1 / (long double)h;
            const long double of_cell = in_row > 0 ? cell / in_row : total > 0 ? 0 : 1 / (long double)w;
            const long double share = (long double)mcs_pwc2_pdf(t, x, y) / w / h;
            const long double error = of_row * (w + 2) * quantum + (of_cell + (w + 2) * quantum) * (h + 2) * quantum;
            sum += share;
            CHECK(fabsl(share - of_row * of_cell) <= error + 5 * step * of_row * of_cell, "cell %u, %u: %Lg", col, row,
                  share);
            CHECK((share > 0) == (cell > 0 || !(total > 0)), "cell %u, %u: %Lg", col, row, share);
        }
    }
    CHECK(fabsl(sum - 1) <= 3 * step, "shares add up to 1 and %Lg", sum - 1);
}
/* x is a float: off by less than 4 steps, as it may have to move into its cell. */
static void check_sample(const mcs_pwc2 *t, float u1, float u2) {
    const mcs_cell2 s = mcs_pwc2_sample(t, u1, u2);
    const mcs_vec2 u = mcs_pwc2_invert(t, s.x, s.y);
    CHECK(s.x >= 0 && s.x < 1 && s.y >= 0 && s.y < 1, "%g, %g", (double)s.x, (double)s.y);
    CHECK(s.col == (uint32_t)((double)s.x * t->w) && s.row == (uint32_t)((double)s.y * t->h), "cell %u, %u", s.col,
          s.row);
    CHECK(s.pdf > 0 && s.pdf == mcs_pwc2_pdf(t, s.x, s.y), "density %g", (double)s.pdf);
    CHECK(t->uniform || counts_as(list[s.row * t->w + s.col]) > 0, "an empty cell %u, %u", s.col, s.row);
    const mcs_pwc *rows = mcsi_pwc2_rows(t);
    const long double slope1 = (long double)mcs_pwc_pdf(mcsi_pwc2_columns(t, s.row), s.x);
    const long double slope2 = (long double)mcs_pwc_pdf(rows, s.y);
    CHECK(fabsl((long double)u.x - (long double)u1) <= step * (1 + 4 * slope1), "u1 %g, %g", (double)u1, (double)u.x);
    CHECK(fabsl((long double)u.y - (long double)u2) <= step * (1 + 4 * slope2), "u2 %g, %g", (double)u2, (double)u.y);
}
static void check_samples(const mcs_pwc2 *t) {
    static const float edges[] = {0, 0x1p-24f, 0.25f, 0.5f, 0.99999994f};
    for (uint32_t i = 0; i < 25; i++) check_sample(t, edges[i % 5], edges[i / 5]);
    for (uint32_t i = 0; i < 3000; i++) check_sample(t, mcs_sobol(i, 0, 1), mcs_sobol(i, 1, 1));
    float x = 0;
    float y = 0;
    for (uint32_t i = 0; i < 1000; i++) {
        const float u = (float)i / 1000;
        const mcs_cell2 along = mcs_pwc2_sample(t, u, 0.4f);
        const mcs_cell2 down = mcs_pwc2_sample(t, 0.6f, u);
        CHECK(along.x >= x && down.y >= y, "u = %g: %g, %g", (double)u, (double)along.x, (double)down.y);
        x = along.x;
        y = down.y;
    }
}
static void tables(void) {
    for (int s = 0; s < SIZES; s++)
        for (int fill = 0; fill < FILLS; fill++) {
            const uint32_t w = sizes[s][0];
            const uint32_t h = sizes[s][1];
            if (!mcst_case("%u x %u, %s", w, h, fill_name[fill])) continue;
            const uint32_t bad = fill_list(fill, w * h);
            arena a = arena_make(mcs_pwc2_bytes(w, h));
            arena b = arena_make(a.bytes);
            mcs_pwc2 *t = (mcs_pwc2 *)(void *)a.at;
            arena_past(&b, 2);
            CHECK(mcs_pwc2_build(t, a.bytes, list, w, h) == MCS_OK, "build");
            CHECK(mcs_pwc2_build((mcs_pwc2 *)(void *)b.at, b.bytes, list, w, h) == MCS_OK, "build again");
            CHECK(arena_differ(&a, &b) == a.bytes && arena_intact(&a), "bytes, or memory around them");
            CHECK(t->w == w && t->h == h && t->bad == bad, "%u bad entries, not %u", t->bad, bad);
            check_shares(t, w, h);
            check_samples(t);
            arena_free(&a);
            arena_free(&b);
        }
}

/* 6 x 5 cells by independent numbers. */
static void frequencies(void) {
    enum { W = 6, H = 5, DRAWS = 300000 };
    static double room[128];
    double count[W * H] = {0};
    double expected[W * H];
    double total = 0;
    if (!mcst_case("chi-square")) return;
    fill_list(0, W * H);
    mcs_pwc2 *t = (mcs_pwc2 *)(void *)room;
    CHECK(mcs_pwc2_build(t, sizeof room, list, W, H) == MCS_OK, "build");
    for (uint32_t i = 0; i < W * H; i++) total += (double)list[i];
    for (uint32_t i = 0; i < W * H; i++) expected[i] = DRAWS * (double)list[i] / total;
    for (uint32_t i = 0; i < DRAWS; i++) {
        const mcs_philox4 v = mcs_philox(mcst.seed, i, 0);
        const mcs_cell2 s = mcs_pwc2_sample(t, mcs_u01(v.v[0]), mcs_u01(v.v[1]));
        count[s.row * W + s.col]++;
    }
    CHECK(chi2_test(count, expected, W * H, NULL, NULL) >= 1e-5, "cells");
}

enum { LONGEST = 131 };
static void array_forms(void) {
    static double room[12000];
    float u1[LONGEST], u2[LONGEST], x[LONGEST + 1], y[LONGEST + 1], pdf[LONGEST + 1];
    uint32_t col[LONGEST + 1], row[LONGEST + 1];
    if (!mcst_case("the array form is the scalar one, in place, NULL")) return;
    fill_list(0, MOST);
    mcs_pwc2 *t = (mcs_pwc2 *)(void *)room;
    CHECK(mcs_pwc2_build(t, sizeof room, list, 70, 90) == MCS_OK, "build");
    for (uint32_t i = 0; i < LONGEST; i++) {
        u1[i] = mcs_sobol(i, 0, 5);
        u2[i] = i % 50 == 49 ? 1.0f : mcs_sobol(i, 1, 5);
    }
    u1[7] = NAN;
    for (size_t n = 0; n <= LONGEST; n += 1 + n / 9) {
        memcpy(x, u1, sizeof u1);
        memcpy(pdf, u2, sizeof u2);
        x[n] = y[n] = pdf[n] = -7;
        col[n] = row[n] = 77;
        mcs_pwc2_sample_n(t, n, x, pdf, x, y, pdf, col, row);
        mcs_pwc2_sample_n(t, n, u1, u2, NULL, NULL, NULL, NULL, NULL);
        for (size_t i = 0; i < n; i++) {
            const mcs_cell2 s = mcs_pwc2_sample(t, u1[i], u2[i]);
            CHECK(s.x == x[i] && s.y == y[i] && s.pdf == pdf[i] && s.col == col[i] && s.row == row[i], "%d of %d",
                  (int)i, (int)n);
        }
        CHECK(x[n] == -7 && y[n] == -7 && pdf[n] == -7 && col[n] == 77 && row[n] == 77, "behind %d", (int)n);
    }
}

static void bad_input(void) {
    static double room[128];
    static const float odd[] = {NAN, -1, -1e-30f, 1, 2, INFINITY, -INFINITY};
    if (!mcst_case("bad numbers and points")) return;
    fill_list(0, 30);
    mcs_pwc2 *t = (mcs_pwc2 *)(void *)room;
    CHECK(mcs_pwc2_build(t, sizeof room, list, 6, 5) == MCS_OK, "build");
    for (int i = 0; i < 7; i++) {
        const mcs_cell2 a = mcs_pwc2_sample(t, odd[i], 0.5f);
        const mcs_cell2 b = mcs_pwc2_sample(t, 0.5f, odd[i]);
        CHECK(a.pdf == 0 && b.pdf == 0 && a.x >= 0 && a.x < 1 && b.y >= 0 && b.y < 1 && a.col < 6 && b.row < 5, "u %g",
              (double)odd[i]);
        const int inside = odd[i] == 1;
        CHECK(inside || (mcs_pwc2_pdf(t, odd[i], 0.5f) == 0 && mcs_pwc2_pdf(t, 0.5f, odd[i]) == 0), "at %g",
              (double)odd[i]);
        const mcs_vec2 u = mcs_pwc2_invert(t, odd[i], odd[i]);
        const float end = odd[i] >= 1 ? 0.99999994f : 0;
        CHECK(u.x == end && u.y == end, "inverse of %g: %g, %g", (double)odd[i], (double)u.x, (double)u.y);
    }
}
static void errors(void) {
    static double room[128];
    mcs_pwc2 *t = (mcs_pwc2 *)(void *)room;
    if (!mcst_case("errors, and nothing is written")) return;
    const size_t bytes = mcs_pwc2_bytes(6, 5);
    CHECK(bytes > 0 && bytes <= sizeof room && bytes % 8 == 0, "%d bytes", (int)bytes);
    CHECK(mcs_pwc2_bytes(0, 5) == 0 && mcs_pwc2_bytes(5, 0) == 0 && mcs_pwc2_bytes(65537, 1) == 0, "sizes");
    CHECK(mcs_pwc2_bytes(1, 65537) == 0 && mcs_pwc2_bytes(65536, 1) > 0 && mcs_pwc2_bytes(1, 65536) > 0, "sizes");
    CHECK(mcs_pwc2_build(NULL, bytes, list, 6, 5) == MCS_ERR_ARG, "no memory");
    CHECK(mcs_pwc2_build(t, bytes, NULL, 6, 5) == MCS_ERR_ARG, "no list");
    CHECK(mcs_pwc2_build((mcs_pwc2 *)(void *)((char *)room + 1), bytes, list, 6, 5) == MCS_ERR_ARG, "misaligned");
    CHECK(mcs_pwc2_build(t, bytes, list, 6, 0) == MCS_ERR_SIZE, "no rows");
    CHECK(mcs_pwc2_build(t, bytes - 1, list, 6, 5) == MCS_ERR_MEMORY, "too little memory");
    for (int i = 0; i < 128; i++) CHECK(room[i] == 0, "written");
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("pwc2");
    tables();
    frequencies();
    array_forms();
    mcst_group("pwc2 bad input");
    bad_input();
    errors();
    return mcst_finish();
}
