/* Environment map. The truth is the image itself: luminance times solid angle of each texel, summed in long double. */
#include "stats.h"
#include "env_maps.h"

/* ---- checks of a map ---- */

static const float corner[] = {0.0f,     1.4e-45f, FLT_MIN, 1e-30f, 0x1p-32f,      0x1p-25f,     0x1p-24f,
                               0x1p-12f, 0.25f,    0.5f,    0.75f,  0x0.fffffep0f, 0x0.ffffffp0f};
enum { CORNERS = (int)(sizeof corner / sizeof *corner) };

static void check_samples(const map *m, const mcs_env *e) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 41);
    const int draws = scaled(m->draws);
    for (int i = 0; i < CORNERS; i++)
        for (int j = 0; j < CORNERS; j++) check_sample(m, e, corner[i], corner[j]);
    for (int i = 0; i < draws; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        check_sample(m, e, u1, mcs_pcg32_float(&rng));
    }
}

/* The row never decreases with u2 whatever u1, nor the column with u1 at a given u2; within a cell z falls and phi
 * grows. */
static void check_monotone(const map *m, const mcs_env *e) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 43);
    enum { STEPS = 1 << 14 };
    uint32_t last = 0;
    float z = 2;
    double turn = -1;
    int falls = 0;
    for (int i = 0; i < STEPS; i++) {
        const mcs_texel s = mcs_env_sample(e, mcs_pcg32_float(&rng), ((float)i + 0.5f) / STEPS);
        falls += !(s.row >= last) || !(s.w.z <= z);
        last = s.row;
        z = s.w.z;
    }
    CHECK(falls == 0, "row falls or z grows %d times with u2", falls);
    for (int j = 0; j < 3; j++) {
        falls = 0;
        last = 0;
        turn = -1;
        for (int i = 0; i < STEPS; i++) {
            const mcs_texel s = mcs_env_sample(e, ((float)i + 0.5f) / STEPS, (float)(j + 1) * 0.2500001f);
            double c, r;
            texel_of(m->w, m->h, s.w, &c, &r);
            falls += !(s.col >= last) || !(c >= turn - 4 * eps * m->w);
            last = s.col;
            turn = c;
        }
        CHECK(falls == 0, "column or azimuth falls %d times with u1, u2 = %g", falls, (j + 1) * 0.25);
    }
}

/* L / pdf is the integral of L, whatever was drawn: every sample is off by rounding and the integers only. */
static void check_estimate(const map *m, const mcs_env *e) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 47);
    const int draws = scaled(20000);
    for (int i = 0; i < draws; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(e, u1, mcs_pcg32_float(&rng));
        if (s.col >= m->w || s.row >= m->h) continue;
        const double ratio = pixels[s.row * m->w + s.col] / (double)s.pdf / e->total;
        const double tol = 4 * eps + slack(m, s.col, s.row);
        CHECK(fabs(ratio - 1) <= tol, "texel (%u, %u): L / pdf is 1 + %g of the total", s.col, s.row, ratio - 1);
    }
}

/* ---- statistics ---- */

/* 1e7 draws by _sample_n, binned by a double atan2 and a search of cos(theta), over all texels of the sky. */
static void test_whole_map(void) {
    enum { BATCH = 1 << 14 };
    const map *m = &maps[SKY];
    const int draws = scaled(10000000);
    const size_t texels = (size_t)m->w * m->h;
    arena a = build(m);
    double *observed = (double *)calloc(2 * texels, sizeof *observed);
    double *expected = observed ? observed + texels : NULL;
    static float u1[BATCH], u2[BATCH], x[BATCH], y[BATCH], z[BATCH], pdf[BATCH];
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 53);
    int stray = 0;
    if (!observed) {
        CHECK(0, "out of memory");
        arena_free(&a);
        return;
    }
    for (size_t i = 0; i < texels; i++) expected[i] = (double)prob[i] * draws;
    double cuts[129];
    for (size_t i = 0; i <= m->h; i++) cuts[i] = cos(pi * (double)i / m->h);
    for (int done = 0; done < draws; done += BATCH) {
        const size_t n = draws - done < BATCH ? (size_t)(draws - done) : BATCH;
        mcs_pcg32_fill_n(&rng, n, u1);
        mcs_pcg32_fill_n(&rng, n, u2);
        mcs_env_sample_n(env_in(&a), n, u1, u2, x, y, z, pdf, NULL, NULL);
        for (size_t i = 0; i < n; i++) {
            double turn = atan2(y[i], x[i]) / (2 * pi);
            uint32_t row = (uint32_t)(acos(z[i]) / pi * m->h);
            if (turn < 0) turn += 1;
            const uint32_t col = (uint32_t)(turn * m->w);
            if (row > m->h - 1) row = m->h - 1;
            while (row > 0 && z[i] > cuts[row]) row--;
            while (row < m->h - 1 && z[i] <= cuts[row + 1]) row++;
            if (col < m->w) observed[row * m->w + col] += 1;
            else stray++;
        }
    }
    const double p = chi2_test(observed, expected, texels, NULL, NULL);
    CHECK(p >= level, "chi-square over %zu texels: p = %g", texels, p);
    CHECK(stray == 0, "%d draws without a texel", stray);
    free(observed);
    arena_free(&a);
}

/* Eight cells of phi by eight of cos(theta) in each of 4 x 2 texels; a big texel is where theta in place of cos(theta)
 * shows. */
static void test_inside_texels(void) {
    enum { CELLS = 8 * 64 };
    static double observed[CELLS], expected[CELLS];
    const map *m = &maps[3];
    const int draws = scaled(2000000);
    arena a = build(m);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 59);
    for (int i = 0; i < CELLS; i++) {
        observed[i] = 0;
        expected[i] = (double)prob[i / 64] * draws / 64;
    }
    for (int i = 0; i < draws; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(env_in(&a), u1, mcs_pcg32_float(&rng));
        double turn = atan2(s.w.y, s.w.x) / (2 * pi);
        const double down = (1 - s.w.z) * 8; /* two rows of eight: cos(pi/2) is 0 */
        if (turn < 0) turn += 1;
        int c = (int)(turn * 32);
        int r = (int)down;
        if (c > 31) c = 31;
        if (r > 15) r = 15;
        if (c >= 0 && r >= 0) observed[((r / 8) * 4 + c / 8) * 64 + (r % 8) * 8 + c % 8] += 1;
    }
    const double p = chi2_test(observed, expected, CELLS, NULL, NULL);
    CHECK(p >= level, "chi-square: p = %g", p);
    arena_free(&a);
}

/* Both caps of 4099 rows: 1 - |z| = 2 sin^2(theta/2) spreads evenly from 0 to 1 - cos(pi/4099) = 2.9e-7. Taken from x
 * and y. */
static void test_caps(void) {
    static double observed[64], expected[64];
    const map *m = &maps[POLES];
    const int draws = scaled(500000);
    const double cap = pow(sin(pi / 2 / m->h), 2);
    arena a = build(m);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 61);
    for (int i = 0; i < 64; i++) {
        observed[i] = 0;
        expected[i] = draws / 64.0;
    }
    for (int i = 0; i < draws; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(env_in(&a), u1, mcs_pcg32_float(&rng));
        const double half = atan2(hypot((double)s.w.x, (double)s.w.y), fabs((double)s.w.z)) / 2;
        int cell = (int)(32 * pow(sin(half), 2) / cap);
        if (cell > 31) cell = 31;
        observed[(s.w.z < 0) * 32 + cell] += 1;
    }
    const double p = chi2_test(observed, expected, 64, NULL, NULL);
    CHECK(p >= level, "chi-square: p = %g", p);
    arena_free(&a);
}

/* ---- batches, memory ---- */

/* The texels of directions by array, with any output left out, are those one by one; bad directions too. */
static void check_texels(const mcs_env *e, size_t n, float *x, const float *y, const float *z) {
    enum { ROOM = 4096 };
    static uint32_t col[ROOM], row[ROOM];
    static float pdf[ROOM];
    const float kept = n ? x[n - 1] : 0;
    if (n > ROOM) return;
    if (n) x[n - 1] = NAN;
    for (size_t skip = 0; skip < 8; skip++) {
        int same = 1;
        mcs_env_texel_n(e, n, x, y, z, skip & 4 ? NULL : pdf, skip & 1 ? NULL : col, skip & 2 ? NULL : row);
        for (size_t i = 0; i < n; i++) {
            const mcs_vec3 w = {x[i], y[i], z[i]};
            const mcs_texel t = mcs_env_texel(e, w);
            same &= (skip & 1 || col[i] == t.col) && (skip & 2 || row[i] == t.row) && (skip & 4 || pdf[i] == t.pdf);
        }
        CHECK(same, "n = %zu, without %zx: other texels than one by one", n, skip);
    }
    if (n) x[n - 1] = kept;
}

/* The same beside borders of rows and columns, across which the rounding of angles may lead, and for lengths that are
 * not 1, where the row is not that of the angle. */
static void check_texels_beside_borders(const map *m, const mcs_env *e) {
    enum { N = 4096 };
    static float x[N], y[N], z[N];
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 83);
    for (int i = 0; i < N; i++) {
        const double u = mcs_pcg32_float(&rng) * (m->w + 1.0);
        const double v = mcs_pcg32_float(&rng) * (m->h + 1.0);
        const double phi = 2 * pi * (i & 1 ? floor(u) : u) / m->w;
        const double theta = pi * (i & 2 ? floor(v) : v) / m->h;
        const double length = i & 4 ? 1 : 0.6 + mcs_pcg32_float(&rng);
        x[i] = (float)(length * sin(theta) * cos(phi));
        y[i] = (float)(length * sin(theta) * sin(phi));
        z[i] = (float)(length * cos(theta));
    }
    check_texels(e, N, x, y, z);
}

static void test_batch(void) {
    enum { MAX = 67, ROOM = 2100 };
    static float u1[ROOM], u2[ROOM], out[4][ROOM];
    static uint32_t col[ROOM], row[ROOM];
    const map *m = &maps[SKY];
    arena a = build(m);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 73);
    for (size_t n = 0; n <= MAX + 1; n++) {
        const size_t count = n <= MAX ? n : 2053;
        for (size_t shift = 0; shift < 4; shift++) {
            const size_t at = shift + 1;
            mcs_pcg32_fill_n(&rng, ROOM, u1);
            mcs_pcg32_fill_n(&rng, ROOM, u2);
            for (uint32_t skip = 0; skip < 16; skip += n <= MAX ? 1 : 15) {
                int same = 1;
                int kept = 1;
                float *p[4];
                for (int k = 0; k < 4; k++) {
                    for (size_t i = 0; i < count + 8; i++) out[k][i] = -7.0f;
                    p[k] = skip >> k & 1 ? NULL : out[k] + at;
                }
                for (size_t i = 0; i < count + 8; i++) col[i] = row[i] = 77777;
                mcs_env_sample_n(env_in(&a), count, u1 + shift, u2 + at, p[0], p[1], p[2], p[3],
                                 skip & 4 ? NULL : col + at, skip & 8 ? NULL : row + at);
                for (size_t i = 0; i < count; i++) {
                    const mcs_texel s = mcs_env_sample(env_in(&a), u1[shift + i], u2[at + i]);
                    const float want[4] = {s.w.x, s.w.y, s.w.z, s.pdf};
                    for (int k = 0; k < 4; k++) same &= !p[k] || p[k][i] == want[k];
                    same &= (skip & 4 || col[at + i] == s.col) && (skip & 8 || row[at + i] == s.row);
                }
                for (int k = 0; k < 4; k++) kept &= out[k][at - 1] == -7.0f && out[k][at + count] == -7.0f;
                for (size_t i = 0; i < count + 8; i++)
                    if (i < at || i >= at + count) kept &= col[i] == 77777 && row[i] == 77777;
                CHECK(same, "n = %zu, shift %zu, without %x: differs from scalar", count, shift, skip);
                CHECK(kept, "n = %zu, shift %zu, without %x: written outside", count, shift, skip);
                if (skip == 0) {
                    static float pdf[ROOM];
                    for (size_t i = 0; i < count + 8; i++) pdf[i] = -7.0f;
                    mcs_env_pdf_n(env_in(&a), count, out[0] + at, out[1] + at, out[2] + at, pdf + at);
                    for (size_t i = 0; i < count; i++)
                        CHECK(pdf[at + i] == out[3][at + i], "n = %zu: pdf_n of sample %zu", count, i);
                    CHECK(pdf[at - 1] == -7.0f && pdf[at + count] == -7.0f, "n = %zu: pdf_n wrote outside", count);
                    mcs_env_pdf_n(env_in(&a), count, out[0] + at, out[1] + at, out[2] + at, NULL);
                    check_texels(env_in(&a), count, out[0] + at, out[1] + at, out[2] + at);
                    memcpy(pdf, u1 + shift, count * sizeof *pdf); /* in place */
                    mcs_env_sample_n(env_in(&a), count, pdf, u2 + at, pdf, NULL, NULL, NULL, NULL, NULL);
                    CHECK(memcmp(pdf, out[0] + at, count * sizeof *pdf) == 0, "n = %zu: in place", count);
                }
            }
        }
    }
    arena_free(&a);
}

/* One number that is bad, or an end, among good ones: all draws are as they are one by one. */
static void test_odd_numbers(void) {
    enum { N = 67 };
    static const float odd[] = {1, 2, -0.5f, -1e-30f, -0.0f, 0, INFINITY, -INFINITY, NAN, 0.99999994f};
    arena a = build(&maps[SKY]);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 89);
    for (size_t k = 0; k < 2 * N * sizeof odd / sizeof *odd; k++) {
        float u[2][N], x[N], y[N], z[N], pdf[N];
        mcs_pcg32_fill_n(&rng, N, u[0]);
        mcs_pcg32_fill_n(&rng, N, u[1]);
        u[k % 2][k / 2 % N] = odd[k / 2 / N];
        mcs_env_sample_n(env_in(&a), N, u[0], u[1], x, y, z, pdf, NULL, NULL);
        for (size_t i = 0; i < N; i++) {
            const mcs_texel s = mcs_env_sample(env_in(&a), u[0][i], u[1][i]);
            CHECK(x[i] == s.w.x && y[i] == s.w.y && z[i] == s.w.z && pdf[i] == s.pdf, "draw %zu, u%zu of %zu is %g", i,
                  k % 2 + 1, k / 2 % N, (double)odd[k / 2 / N]);
        }
    }
    arena_free(&a);
}

static void test_relocation(void) {
    enum { N = 20000 };
    static mcs_texel before[N];
    arena a = build(&maps[SKY]);
    arena b = arena_make(a.bytes);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 79);
    mcs_pcg32 again = rng;
    for (int i = 0; i < N; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        before[i] = mcs_env_sample(env_in(&a), u1, mcs_pcg32_float(&rng));
    }
    memcpy(env_in(&b), env_in(&a), a.bytes);
    memset(env_in(&a), 0xff, a.bytes);
    for (int i = 0; i < N; i++) {
        const float u1 = mcs_pcg32_float(&again);
        const mcs_texel s = mcs_env_sample(env_in(&b), u1, mcs_pcg32_float(&again));
        const mcs_texel t = before[i];
        CHECK(s.w.x == t.w.x && s.w.y == t.w.y && s.w.z == t.w.z && s.pdf == t.pdf && s.col == t.col && s.row == t.row,
              "sample %d differs", i);
        CHECK(mcs_env_pdf(env_in(&b), s.w) == s.pdf, "sample %d: pdf", i);
    }
    arena_free(&a);
    arena_free(&b);
}

static void test_size(void) {
    const uint32_t w[2] = {1024, 8192};
    for (int i = 0; i < 2; i++) {
        const double each = (double)mcs_env_bytes(w[i], w[i] / 2) / ((double)w[i] * w[i] / 2);
        mcst_note("     %u x %u: %.3f bytes a texel\n", w[i], w[i] / 2, each);
        CHECK(each >= 4 && each <= 16, "%u x %u: %g bytes a texel", w[i], w[i] / 2,
              each); /* at most what the largest peer takes */
    }
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("env maps");
    for (int i = 0; i < MAPS; i++) {
        if (!mcst_case("%s", maps[i].name)) continue;
        arena a = build(&maps[i]);
        check_density(&maps[i], env_in(&a));
        check_samples(&maps[i], env_in(&a));
        check_monotone(&maps[i], env_in(&a));
        check_estimate(&maps[i], env_in(&a));
        check_texels_beside_borders(&maps[i], env_in(&a));
        arena_free(&a);
    }
    mcst_group("env statistics");
    if (mcst_case("chi-square of 1e7 draws over the sky")) test_whole_map();
    if (mcst_case("uniform in solid angle inside 4 x 2 texels")) test_inside_texels();
    if (mcst_case("uniform in solid angle inside both caps of 4099 rows")) test_caps();
    mcst_group("env memory and batches");
    if (mcst_case("n = 0..67 and 2053, shifted, NULL outputs, in place, pdf_n")) test_batch();
    if (mcst_case("odd numbers in arrays")) test_odd_numbers();
    if (mcst_case("moved by memcpy")) test_relocation();
    if (mcst_case("bytes a texel")) test_size();
    return mcst_finish();
}
