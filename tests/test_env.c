/* Environment map. The truth is the image itself: luminance times solid angle of each texel, summed in long double. */
#include <float.h>
#include <math.h>
#include "arena.h"
#include "latlong.h"
#include "mcs_test.h"
#include "mcsample.h"
#include "stats.h"

typedef long double ld;

enum { MAX_TEXELS = 8192 * 16 };
static const double pi = 3.14159265358979323846;
static const double level = 1e-5;      /* of one statistical test: Sidak, 1000 of them in the whole suite at 0.01 together */
static const double eps = 0x1p-24;     /* rounding of a float, relative; also the step of u */
static const double quantum = 0x1p-31; /* probabilities of rows and of columns are integers over 2^31 */

/* MCS_TEST_SCALE below 1 (sanitizer builds) draws fewer samples. */
static int scaled(int n) {
    const char *s = getenv("MCS_TEST_SCALE");
    const double f = s ? atof(s) : 1;
    return f > 0 && f < 1 ? (int)(n * f) + 1 : n;
}

/* ---- maps ---- */

typedef struct {
    const char *name;
    uint32_t w, h;
    float (*value)(uint32_t col, uint32_t row, uint32_t w, uint32_t h);
    int draws; /* random samples that are checked one by one */
} map;

static float hash01(uint32_t i) { return mcs_u01(mcs_philox(mcst.seed, i, 2).v[0]); }

static float v_one(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)c;
    (void)r;
    (void)w;
    (void)h;
    return 1.0f;
}
static float v_random(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)h;
    return 0.1f + hash01(r * w + c);
}
static float v_checker(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (c + r) & 1 ? 1.0f : 0.0f;
}
static float v_poles(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    return r == 0 || r == h - 1 ? 1.0f + (float)(c % 3) : 0.0f;
}
static float v_equator(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    return r == h / 2 && c % 5 ? 1.0f : 0.0f;
}
static float v_peak(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    return c == w / 3 && r == h / 3 ? 1e30f : (c ^ r) & 3 ? hash01(r * w + c) : 0.0f;
}
static float v_huge(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (c + r) % 3 ? FLT_MAX : FLT_MAX / 4;
}
static float v_tiny(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (float)((c + r) % 4) * 1.4012984643e-45f;
}
static float v_corner(uint32_t c, uint32_t r, uint32_t w, uint32_t h) { return c == w - 1 && r == h - 1 ? 2.0f : 0.0f; }
/* A sky brighter towards its horizon, dark ground, and a sun of one texel in every 32 x 32 that is 1e5 times brighter. */
static float v_sky(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    const float up = 1.0f - 2.0f * ((float)r + 0.5f) / (float)h;
    if (c == w / 5 && r == h / 4) return 1e5f;
    return up > 0 ? 1.0f - 0.7f * up + 0.1f * hash01(r * w + c) : 0.05f;
}

static const map maps[] = {
    {"1 x 1", 1, 1, v_one, 20000},
    {"1 x 16", 1, 16, v_random, 100000},
    {"16 x 1", 16, 1, v_random, 100000},
    {"4 x 2", 4, 2, v_random, 100000},
    {"7 x 5", 7, 5, v_random, 100000},
    {"1 x 1000, poles", 1, 1000, v_poles, 100000},
    {"1000 x 3", 1000, 3, v_random, 100000},
    {"33 x 17, last texel only", 33, 17, v_corner, 20000},
    {"300 x 123, equator", 300, 123, v_equator, 100000},
    {"3 x 4099, poles", 3, 4099, v_poles, 200000},
    {"8192 x 16, checkerboard", 8192, 16, v_checker, 1000000},
    {"100 x 1000, checkerboard", 100, 1000, v_checker, 1000000},
    {"256 x 128, sky and sun", 256, 128, v_sky, 1000000},
    {"130 x 70, one pixel 1e30", 130, 70, v_peak, 100000},
    {"64 x 32, FLT_MAX", 64, 32, v_huge, 100000},
    {"20 x 10, denormals", 20, 10, v_tiny, 100000},
};
enum { MAPS = (int)(sizeof maps / sizeof *maps), POLES = 9, CHECKER = 10, SKY = 12 };

static float pixels[MAX_TEXELS];
static ld prob[MAX_TEXELS], row_prob[8192], total;

static void load(const map *m) {
    total = 0;
    for (uint32_t r = 0; r < m->h; r++)
        for (uint32_t c = 0; c < m->w; c++) {
            const float v = m->value(c, r, m->w, m->h);
            pixels[r * m->w + c] = v;
            total += prob[r * m->w + c] = v * solid_angle(r, m->w, m->h);
        }
    for (uint32_t r = 0; r < m->h; r++) {
        row_prob[r] = 0;
        for (uint32_t c = 0; c < m->w; c++) row_prob[r] += prob[r * m->w + c] /= total;
    }
}

static mcs_env *env_in(const arena *a) { return (mcs_env *)(void *)a->at; }

static mcs_status build_from(mcs_env *e, size_t bytes, const float *p, uint32_t w, uint32_t h, uint32_t channels, size_t stride) {
    mcs_image image = mcs_image_make(p, w, h, channels);
    image.row_stride = (ptrdiff_t)stride;
    return mcs_env_build(e, bytes, &image);
}

static arena build(const map *m) {
    const arena a = arena_make(mcs_env_bytes(m->w, m->h));
    load(m);
    const int rc = build_from(env_in(&a), a.bytes, pixels, m->w, m->h, 1, 0);
    CHECK(rc == MCS_OK, "build returns %d", rc);
    CHECK(arena_intact(&a), "build wrote outside its %zu bytes", a.bytes);
    CHECK(env_in(&a)->bad == 0, "%llu bad texels", (unsigned long long)env_in(&a)->bad);
    /* row borders are doubles between 0 and 2: the height of a row is off by 2^-51, and no row is lower than the first */
    CHECK(fabs((double)(env_in(&a)->total / total - 1)) <= 1e-12 + 0x1p-51 / (1 - cos(pi / m->h)), "total %g, not %g",
          env_in(&a)->total, (double)total);
    return a;
}

/* ---- checks of a map ---- */

/* Probabilities of rows, and of columns within a row, are integers over 2^31 with at least one where there is light: each moves by
 * one of rounding, its own one, and its share of those for all. The bound is relative to the probability of the texel. */
static double slack(const map *m, uint32_t col, uint32_t row) {
    const double prow = (double)row_prob[row];
    const double pcol = (double)(prob[row * m->w + col] / row_prob[row]);
    return (1 + (2 / prow + m->h) * quantum) * (1 + (2 / pcol + m->w) * quantum) - 1;
}

static void check_density(const map *m, const mcs_env *e) {
    double mass = 0;
    const uint32_t step = m->w > 1000 ? 61 : 1;
    for (uint32_t r = 0; r < m->h; r++)
        for (uint32_t c = 0; c < m->w; c++) {
            const mcs_vec3 w = point(m->w, m->h, c, r, 0.5, 0.5);
            const double omega = (double)solid_angle(r, m->w, m->h);
            const double p = mcs_env_pdf(e, w);
            const double want = (double)prob[r * m->w + c];
            const mcs_texel at = mcs_env_texel(e, w);
            mass += p * omega;
            CHECK(at.col == c && at.row == r, "texel of the centre of (%u, %u): (%u, %u)", c, r, at.col, at.row);
            CHECK((p > 0) == (want > 0), "texel (%u, %u): density %g where the probability is %g", c, r, p, want);
            /* weight of the row, sum of the weights, density: three float roundings */
            if (want > 0 && c % step == 0) {
                const double tol = slack(m, c, r) + 4 * eps;
                CHECK(fabs(p * omega - want) <= tol * want, "texel (%u, %u): probability %g, not %g", c, r, p * omega, want);
            }
        }
    CHECK(fabs(mass - 1) <= 4 * eps, "the density integrates to 1 + %g", mass - 1);
}

/* Everything that must hold for a sample whatever u was. */
static void check_sample(const map *m, const mcs_env *e, float u1, float u2) {
    const mcs_texel s = mcs_env_sample(e, u1, u2);
    const double len = sqrt((double)s.w.x * s.w.x + (double)s.w.y * s.w.y + (double)s.w.z * s.w.z);
    const int inside = s.col < m->w && s.row < m->h;
    CHECK(inside, "u = %a, %a: texel (%u, %u)", (double)u1, (double)u2, s.col, s.row);
    if (!inside) return;
    CHECK(fabs(len - 1) <= 4 * eps, "u = %a, %a: length 1 + %g", (double)u1, (double)u2, len - 1);
    CHECK(pixels[s.row * m->w + s.col] > 0, "u = %a, %a: black texel (%u, %u)", (double)u1, (double)u2, s.col, s.row);
    CHECK(s.pdf > 0 && s.pdf <= FLT_MAX, "u = %a, %a: pdf %g", (double)u1, (double)u2, (double)s.pdf);
    CHECK(mcs_env_pdf(e, s.w) == s.pdf, "u = %a, %a: pdf %g, returned %g", (double)u1, (double)u2, (double)mcs_env_pdf(e, s.w),
          (double)s.pdf);
    mcs_texel at = mcs_env_texel(e, s.w);
    CHECK(at.pdf == s.pdf && at.col == s.col && at.row == s.row, "u = %a, %a: texel (%u, %u), returned (%u, %u)", (double)u1,
          (double)u2, at.col, at.row, s.col, s.row);
    double c, r;
    texel_of(m->w, m->h, s.w, &c, &r);
    double off = fabs(c - s.col - 0.5);
    if (off > m->w / 2.0) off = m->w - off;
    CHECK(off <= 0.5 + 4 * eps * m->w, "u = %a, %a: column %.9g, returned %u", (double)u1, (double)u2, c, s.col);
    CHECK(fabs(r - s.row - 0.5) <= 0.5 + 4 * eps * m->h, "u = %a, %a: row %.9g, returned %u", (double)u1, (double)u2, r, s.row);
    mcs_vec2 back = mcs_env_invert(e, s.w);
    {
        /* In parts of a cell, the place is off by the margin of 4 eps cells times their number that samples keep from borders, by
         * the rounding of the azimuth (2 eps of a turn) or of z (2 eps), and once more that much in the inverse. */
        const double prow = (double)row_prob[s.row];
        const double pcol = (double)(prob[s.row * m->w + s.col] / row_prob[s.row]);
        const double dz = (double)solid_angle(s.row, m->w, m->h) * m->w / (2 * pi);
        const double d1 = pcol * m->w * 8 * eps;
        const double d2 = prow * (m->h * 4 + 4 / dz) * eps;
        const int pole = s.w.x == 0 && s.w.y == 0; /* no azimuth there */
        CHECK(back.x >= 0 && back.x < 1 &&
                  (pole || fabs((double)back.x - u1) <= (d1 < pcol ? d1 : pcol) + 2 * quantum * m->w + 2 * eps),
              "u1 = %a: invert %a", (double)u1, (double)back.x);
        CHECK(back.y >= 0 && back.y < 1 && fabs((double)back.y - u2) <= (d2 < prow ? d2 : prow) + 2 * quantum * m->h + 2 * eps,
              "u2 = %a: invert %a", (double)u2, (double)back.y);
    }
}

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

/* The row never decreases with u2 whatever u1, nor the column with u1 at a given u2; within a cell z falls and phi grows. */
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

/* Eight cells of phi by eight of cos(theta) in each of 4 x 2 texels; a big texel is where theta in place of cos(theta) shows. */
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

/* Both caps of 4099 rows: 1 - |z| = 2 sin^2(theta/2) spreads evenly from 0 to 1 - cos(pi/4099) = 2.9e-7. Taken from x and y. */
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

/* ---- input ---- */

/* Luminance of Rec. 709 primaries; the same map as 1, 3 and 4 channels, with and without a stride, draws the same. */
static void test_channels(void) {
    enum { W = 37, H = 19, STRIDE = W * 4 + 5 };
    static float in[H * STRIDE];
    static const map m = {"channels", W, H, v_random, 0};
    for (uint32_t channels = 1; channels <= 4; channels++) {
        if (channels == 2) continue;
        for (int padded = 0; padded < 2; padded++) {
            const size_t stride = padded ? STRIDE : W * channels;
            arena a = arena_make(mcs_env_bytes(W, H));
            ld sum = 0;
            for (uint32_t r = 0; r < H * STRIDE; r++) in[r] = NAN; /* padding and further channels must not be read as light */
            for (uint32_t r = 0; r < H; r++)
                for (uint32_t c = 0; c < W; c++) {
                    float *px = in + r * stride + c * channels;
                    const uint32_t i = (r * W + c) * 3;
                    px[0] = hash01(i);
                    if (channels > 2) {
                        px[1] = hash01(i + 1);
                        px[2] = hash01(i + 2);
                    }
                    if (channels > 3) px[3] = 1e6f * hash01(i);
                    const ld lum = channels == 1 ? px[0] : 0.2126L * px[0] + 0.7152L * px[1] + 0.0722L * px[2];
                    pixels[r * W + c] = (float)lum;
                    sum += prob[r * W + c] = lum * solid_angle(r, W, H);
                }
            for (uint32_t r = 0; r < H; r++) {
                row_prob[r] = 0;
                for (uint32_t c = 0; c < W; c++) row_prob[r] += prob[r * W + c] /= sum;
            }
            const int rc = build_from(env_in(&a), a.bytes, in, W, H, channels, padded ? STRIDE : 0);
            CHECK(rc == MCS_OK && env_in(&a)->bad == 0, "%u channels, stride %zu: returns %d, %llu bad", channels, stride, rc,
                  (unsigned long long)env_in(&a)->bad);
            CHECK(fabs((double)(env_in(&a)->total / sum - 1)) <= 4 * eps, "%u channels, stride %zu: total %g, not %g", channels,
                  stride, env_in(&a)->total, (double)sum);
            check_density(&m, env_in(&a));
            arena_free(&a);
        }
    }
}

/* The same picture however it lies in memory: apart, with padding, upside down, as a channel of a larger one. The memory of the
 * picture ends with its last float, and what is not a pixel is NaN. */
static void test_strides(void) {
    enum { W = 21, H = 13 };
    static const struct {
        uint32_t channels;
        ptrdiff_t pixel, row; /* row in pixels beyond a packed one; below 0: stored from the bottom up */
    } way[] = {{1, 0, 0}, {1, 1, 0},  {1, 1, 3}, {1, 4, 0}, {1, 4, 5}, {1, 3, -1}, {1, 0, -1}, {1, 1, -4},
               {3, 0, 0}, {3, 0, -1}, {3, 3, 7}, {3, 4, 0}, {3, 9, 2}, {3, 5, -3}, {4, 0, -1}, {4, 6, 1}};
    static float plain[W * H * 3];
    for (size_t k = 0; k < sizeof way / sizeof *way; k++) {
        const uint32_t used = way[k].channels < 3 ? 1 : 3;
        const ptrdiff_t step = way[k].pixel ? way[k].pixel : (ptrdiff_t)way[k].channels;
        const ptrdiff_t apart = way[k].row < 0 ? -way[k].row - 1 : way[k].row;
        const ptrdiff_t row = (W + apart) * step;
        const size_t floats = (size_t)((H - 1) * row + (W - 1) * step) + way[k].channels;
        float *in = (float *)malloc(floats * sizeof *in);
        float *top = in;
        arena a = arena_make(mcs_env_bytes(W, H));
        arena b = arena_make(mcs_env_bytes(W, H));
        if (!in) {
            CHECK(0, "out of memory");
            return;
        }
        for (size_t i = 0; i < floats; i++) in[i] = NAN;
        if (way[k].row < 0) top += (H - 1) * row;
        for (uint32_t r = 0; r < H; r++)
            for (uint32_t c = 0; c < W; c++)
                for (uint32_t j = 0; j < used; j++) {
                    const ptrdiff_t down = way[k].row < 0 ? -(ptrdiff_t)r : (ptrdiff_t)r;
                    plain[(r * W + c) * used + j] = top[down * row + (ptrdiff_t)c * step + (ptrdiff_t)j] =
                        hash01((r * W + c) * 3 + j);
                }
        int rc = build_from(env_in(&a), a.bytes, plain, W, H, used, 0);
        CHECK(rc == MCS_OK, "packed: returns %d", rc);
        mcs_image image = mcs_image_make(top, W, H, way[k].channels);
        image.pixel_stride = way[k].pixel;
        image.row_stride = way[k].row < 0 ? -row : way[k].row || k % 2 ? row : 0;
        rc = mcs_env_build(env_in(&b), b.bytes, &image);
        CHECK(rc == MCS_OK && arena_intact(&b) && memcmp(a.at, b.at, a.bytes) == 0,
              "%u channels, pixels %td apart, rows %td: returns %d, %u bad, or another table", way[k].channels, image.pixel_stride,
              image.row_stride, rc, env_in(&b)->bad);
        free(in);
        arena_free(&a);
        arena_free(&b);
    }
}

static void test_refused_strides(void) {
    enum { W = 20, H = 10, C = 3 };
    const ptrdiff_t most = PTRDIFF_MAX;
    const ptrdiff_t least = -PTRDIFF_MAX - 1;
    const struct {
        ptrdiff_t pixel, row;
        mcs_status status;
    } way[] = {{0, (W - 1) * C + C, MCS_OK},
               {5, (W - 1) * 5 + C, MCS_OK}, /* a row may end with the last channel of its last pixel */
               {5, -(W - 1) * 5 - C, MCS_OK},
               {0, W * C - 1, MCS_ERR_SIZE},
               {0, -W * C + 1, MCS_ERR_SIZE},
               {5, (W - 1) * 5 + C - 1, MCS_ERR_SIZE},
               {5, -(W - 1) * 5 - C + 1, MCS_ERR_SIZE},
               {0, 1, MCS_ERR_SIZE},
               {0, -1, MCS_ERR_SIZE},
               {1, 0, MCS_ERR_SIZE},
               {2, 1000, MCS_ERR_SIZE},
               {-1, 0, MCS_ERR_SIZE},
               {-3, 1000, MCS_ERR_SIZE},
               {least, 0, MCS_ERR_SIZE},
               {most, 0, MCS_ERR_SIZE},
               {most, most, MCS_ERR_SIZE},
               {most / W, 0, MCS_ERR_SIZE},
               {most / W + 1, 0, MCS_ERR_SIZE},
               {most / 4, 0, MCS_ERR_SIZE},
               {0, most, MCS_ERR_SIZE},
               {0, least, MCS_ERR_SIZE},
               {0, most / H, MCS_ERR_SIZE},
               {0, most / 4 / H + 1, MCS_ERR_SIZE}, /* the picture would be larger than memory */
               {0, -(most / 4 / H) - 1, MCS_ERR_SIZE}};
    static float in[2 * H * (W * 5)];
    const size_t need = mcs_env_bytes(W, H);
    for (size_t i = 0; i < sizeof in / sizeof *in; i++) in[i] = hash01((uint32_t)i);
    for (size_t k = 0; k < sizeof way / sizeof *way; k++) {
        arena a = arena_make(need);
        mcs_image image = mcs_image_make(in + sizeof in / sizeof *in / 2, W, H, C);
        image.pixel_stride = way[k].pixel;
        image.row_stride = way[k].row;
        int rc[3];
        rc[0] = mcs_env_build(env_in(&a), need, &image);
        const float mean = mcs_env_mean(&image);
        if (way[k].status) {
            rc[1] = mcs_env_build_rows(env_in(&a), need, &image, 0, 1);
            rc[2] = mcs_env_finish(env_in(&a), need, &image);
            CHECK(rc[0] == way[k].status && rc[1] == way[k].status && rc[2] == way[k].status && mean == 0,
                  "pixels %td, rows %td apart: %d, %d, %d, mean %g", way[k].pixel, way[k].row, rc[0], rc[1], rc[2], (double)mean);
            CHECK(untouched(a.at, need), "pixels %td, rows %td apart: refused, yet written", way[k].pixel, way[k].row);
        } else {
            CHECK(rc[0] == MCS_OK && mean > 0, "pixels %td, rows %td apart: %d, mean %g", way[k].pixel, way[k].row, rc[0],
                  (double)mean);
        }
        CHECK(arena_intact(&a), "written outside");
        arena_free(&a);
    }
}

/* Each bad channel is 0, but +infinity is FLT_MAX: mean, total and draws are those of a picture that says so, as it is, bilinear
 * and with a floor; `way` 0: whole texels are bad, 1: channels of them, 2: and some of these infinite. */
static void check_bad_pixels(uint32_t channels, int way, int mode) {
    enum { W = 24, H = 12 };
    const float bad[5] = {NAN, -1.0f, -INFINITY, -FLT_MAX, -FLT_MIN};
    static float in[W * H * 3], clean[W * H * 3];
    arena a = arena_make(mcs_env_bytes(W, H));
    arena b = arena_make(mcs_env_bytes(W, H));
    mcs_image broken = mcs_image_make(in, W, H, channels);
    mcs_image right = mcs_image_make(clean, W, H, channels);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 67);
    uint32_t count = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        int some = 0;
        for (uint32_t j = 0; j < channels; j++) {
            const uint32_t k = i * channels + j;
            const int here = i % 3 == 1 && (way == 0 || channels == 1 || (i / 3 + j) % 2);
            const int sun = way == 2 && here && i % 5 == 0;
            in[k] = sun ? INFINITY : here ? bad[i / 3 % 5] : 0.1f + hash01(k);
            clean[k] = sun ? FLT_MAX : here ? 0.0f : 0.1f + hash01(k);
            some |= here;
        }
        count += (uint32_t)some;
    }
    broken.bilinear = right.bilinear = mode == 1;
    if (mode == 2) {
        broken.floor = mcs_env_mean(&broken);
        right.floor = mcs_env_mean(&right);
    }
    CHECK(mcs_env_mean(&broken) == mcs_env_mean(&right) && mcs_env_mean(&right) <= FLT_MAX, "mean %g, not %g",
          (double)mcs_env_mean(&broken), (double)mcs_env_mean(&right));
    int rc = mcs_env_build(env_in(&a), a.bytes, &broken);
    CHECK(rc == MCS_OK && env_in(&a)->bad == count && arena_intact(&a), "%u channels: returns %d, %llu bad, not %u", channels, rc,
          (unsigned long long)env_in(&a)->bad, count);
    rc = mcs_env_build(env_in(&b), b.bytes, &right);
    CHECK(rc == MCS_OK && env_in(&b)->bad == 0 && env_in(&a)->total == env_in(&b)->total && env_in(&b)->total <= DBL_MAX,
          "%u channels: total %g, not %g", channels, env_in(&a)->total, env_in(&b)->total);
    CHECK(mcs_env_check(env_in(&a), a.bytes) == MCS_OK, "no table");
    for (uint32_t i = 0; i < 20000; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(env_in(&a), u1, u2);
        const mcs_texel t = mcs_env_sample(env_in(&b), u1, u2);
        CHECK(s.w.x == t.w.x && s.w.y == t.w.y && s.w.z == t.w.z && s.pdf == t.pdf && s.col == t.col && s.row == t.row,
              "u = %a, %a: not as with clean pixels", (double)u1, (double)u2);
    }
    arena_free(&a);
    arena_free(&b);
}
static void test_bad_pixels(void) {
    for (uint32_t channels = 1; channels <= 3; channels += 2)
        for (int way = 0; way < 3; way++)
            for (int mode = 0; mode < 3; mode++) check_bad_pixels(channels, way, mode);
}

/* Texels of one row, so that probability is luminance: what bad channels leave of it, by hand. */
static void test_bad_channels(void) {
    enum { W = 9 };
    static const float in[W][3] = {{-150, 1000, 100}, {1, 1, 1},     {1, NAN, 1},        {-5, -1, 3},      {-1, -2, -3},
                                   {NAN, NAN, NAN},   {0, 2, -1000}, {-1e30f, 1e-3f, 0}, {-0.0f, -0.0f, 0}};
    static const double want[W] = {0.7152 * 1000 + 0.0722 * 100, 1, 0.2126 + 0.0722, 0.0722 * 3, 0, 0, 0.7152 * 2, 0.7152e-3, 0};
    static const float suns[4][3] = {{INFINITY, 0, 0}, {FLT_MAX, FLT_MAX, FLT_MAX}, {INFINITY, -INFINITY, NAN}, {1e30f, 0, 0}};
    static const double sun_want[4] = {0.2126, 1, 0.2126, 0.2126 * 1e30 / FLT_MAX};
    arena a = arena_make(mcs_env_bytes(W, 1));
    mcs_image image = mcs_image_make(&in[0][0], W, 1, 3);
    double sum = 0;
    for (uint32_t i = 0; i < W; i++) sum += want[i];
    CHECK(mcs_env_build(env_in(&a), a.bytes, &image) == MCS_OK && env_in(&a)->bad == 7, "%u bad", env_in(&a)->bad);
    CHECK(fabs(env_in(&a)->total / (sum * 4 * pi / W) - 1) <= 4 * eps, "total %g, not %g", env_in(&a)->total, sum * 4 * pi / W);
    CHECK(fabs(mcs_env_mean(&image) / (sum / W) - 1) <= 4 * eps, "mean %g, not %g", (double)mcs_env_mean(&image), sum / W);
    for (uint32_t i = 0; i < W; i++) {
        const double p = mcs_env_pdf(env_in(&a), point(W, 1, i, 0, 0.5, 0.5)) * 4 * pi / W;
        const double due = want[i] / sum;
        CHECK((p > 0) == (due > 0) && fabs(p - due) <= 5 * eps * due + (2 + W * due) * quantum, "texel %u: probability %g, not %g",
              i, p, due);
    }
    /* an overflowed half is a sun; nothing overflows with it */
    image = mcs_image_make(&suns[0][0], 4, 1, 3);
    sum = 0;
    for (uint32_t i = 0; i < 4; i++) sum += sun_want[i];
    for (int mode = 0; mode < 2; mode++) {
        const double whole = sum * FLT_MAX * pi;
        image.bilinear = mode;
        CHECK(mcs_env_build(env_in(&a), a.bytes, &image) == MCS_OK && env_in(&a)->bad == 2, "suns: %u bad", env_in(&a)->bad);
        CHECK(fabs(env_in(&a)->total / whole - 1) <= 5 * eps, "suns: total %g, not %g", env_in(&a)->total, whole);
        CHECK(fabs(mcs_env_mean(&image) / (whole / (4 * pi)) - 1) <= 5 * eps, "suns: mean %g", (double)mcs_env_mean(&image));
        for (uint32_t i = 0; i < 4; i++) {
            const double p = mcs_env_pdf(env_in(&a), point(4, 1, i, 0, 0.5, 0.5)) * pi;
            const double before = sun_want[(i + 3) % 4];
            const double here = sun_want[i];
            const double after = sun_want[(i + 1) % 4];
            const double due = (mode ? 0.25 * before + 0.5 * here + 0.25 * after : here) / sum;
            CHECK(p > 0 && fabs(p - due) <= 8 * eps * due + (2 + 4 * due) * quantum, "suns, texel %u: probability %g, not %g", i, p,
                  due);
        }
    }
    arena_free(&a);
}
/* Nothing but FLT_MAX or infinity: an even map whose sums are finite. */
static void test_all_infinite(void) {
    enum { W = 37, H = 19 };
    static float in[W * H * 3];
    for (int k = 0; k < 4; k++)
        for (int mode = 0; mode < 2; mode++) {
            const float fill = k & 1 ? INFINITY : FLT_MAX;
            arena a = arena_make(mcs_env_bytes(W, H));
            mcs_image image = mcs_image_make(in, W, H, k & 2 ? 3 : 1);
            for (int i = 0; i < W * H * 3; i++) in[i] = fill;
            image.bilinear = mode;
            CHECK(mcs_env_build(env_in(&a), a.bytes, &image) == MCS_OK && env_in(&a)->bad == (k & 1 ? W * H : 0), "%u bad",
                  env_in(&a)->bad);
            CHECK(env_in(&a)->uniform && fabs(env_in(&a)->total / (4 * pi * FLT_MAX) - 1) <= 4 * eps, "total %g",
                  env_in(&a)->total);
            CHECK(mcs_env_mean(&image) <= FLT_MAX && mcs_env_mean(&image) >= FLT_MAX * (1 - 4 * (float)eps), "mean %g",
                  (double)mcs_env_mean(&image));
            CHECK(fabs(mcs_env_sample(env_in(&a), 0.3f, 0.6f).pdf * 4 * pi - 1) <= 4 * eps, "density");
            arena_free(&a);
        }
}

static void test_black(void) {
    enum { W = 10, H = 6 };
    static const map m = {"black", W, H, v_one, 0};
    static float in[W * H];
    const float fill[3] = {0.0f, -0.0f, NAN};
    for (int k = 0; k < 3; k++) {
        arena a = arena_make(mcs_env_bytes(W, H));
        mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 71);
        for (int i = 0; i < W * H; i++) in[i] = fill[k];
        load(&m);
        const int rc = build_from(env_in(&a), a.bytes, in, W, H, 1, 0);
        CHECK(rc == MCS_UNIFORM && arena_intact(&a), "all %g: returns %d", (double)fill[k], rc);
        CHECK(env_in(&a)->total == 0 && env_in(&a)->bad == (k == 2 ? W * H : 0), "all %g: total %g, %llu bad", (double)fill[k],
              env_in(&a)->total, (unsigned long long)env_in(&a)->bad);
        for (int i = 0; i < 20000; i++) {
            const float u1 = mcs_pcg32_float(&rng);
            const float u2 = mcs_pcg32_float(&rng);
            const float pdf = mcs_env_sample(env_in(&a), u1, u2).pdf;
            CHECK(fabs(pdf * 4 * pi - 1) <= 4 * eps + 2 * W * H * quantum, "u = %a, %a: density %g", (double)u1, (double)u2,
                  (double)pdf);
            check_sample(&m, env_in(&a), u1, u2);
        }
        arena_free(&a);
    }
}

static void test_refused(void) {
    const uint32_t w = 20;
    const uint32_t h = 10;
    const uint32_t big = 0xffffffffu;
    const size_t need = mcs_env_bytes(w, h);
    arena a = arena_make(need + 8);
    unsigned char *at = a.at;
    load(&maps[15]);
    CHECK(build_from(NULL, need, pixels, w, h, 1, 0) == MCS_ERR_ARG, "no memory");
    CHECK(build_from(env_in(&a), need, NULL, w, h, 1, 0) == MCS_ERR_ARG, "no pixels");
    CHECK(build_from(env_in(&a), need, pixels, 0, h, 1, 0) == MCS_ERR_SIZE, "no columns");
    CHECK(build_from(env_in(&a), need, pixels, w, 0, 1, 0) == MCS_ERR_SIZE, "no rows");
    CHECK(build_from(env_in(&a), need, pixels, w, h, 0, 0) == MCS_ERR_ARG, "no channels");
    CHECK(build_from(env_in(&a), need, pixels, w, h, 2, 0) == MCS_ERR_ARG, "two channels");
    CHECK(build_from(env_in(&a), need, pixels, w, h, 1, w - 1) == MCS_ERR_SIZE, "stride below a row");
    CHECK(build_from((mcs_env *)(void *)(at + 2), need, pixels, w, h, 1, 0) == MCS_ERR_ARG, "misaligned memory");
    for (size_t i = 0; i < need; i++) {
        const int rc = build_from(env_in(&a), i, pixels, w, h, 1, 0);
        CHECK(rc == MCS_ERR_MEMORY, "%zu of %zu bytes: %d", i, need, rc);
    }
    CHECK(mcs_env_bytes(0, 1) == 0 && mcs_env_bytes(1, 0) == 0, "bytes of an empty map");
    CHECK(mcs_env_bytes(big, big) == 0, "bytes of 2^64 texels: %zu", mcs_env_bytes(big, big));
    CHECK(build_from(env_in(&a), SIZE_MAX, pixels, big, big, 1, 0) == MCS_ERR_SIZE, "2^64 texels");
    CHECK(build_from(env_in(&a), need, pixels, big, big, 4, 0) == MCS_ERR_SIZE, "2^64 texels");
    CHECK(build_from(env_in(&a), need, pixels, big, 1, big, 0) < 0, "2^64 floats in a row");
    CHECK(build_from(env_in(&a), need, pixels, w, h, 1, SIZE_MAX / 2) < 0, "a stride beyond memory");
    CHECK(untouched(at, need + 8) && arena_intact(&a), "a refused build wrote");
    arena_free(&a);
}

static void test_bad_sampler_input(void) {
    const float odd[] = {1.0f, -1e-45f, -0.5f, 1.5f, 1e30f, INFINITY, -INFINITY, NAN};
    const size_t n = sizeof odd / sizeof *odd;
    const map *m = &maps[4];
    arena a = build(m);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++) {
            const float u1 = k == 1 ? 0.3f : odd[i];
            const float u2 = k == 0 ? 0.3f : odd[i];
            const mcs_texel s = mcs_env_sample(env_in(&a), u1, u2);
            CHECK(s.pdf == 0 && fabsf(s.w.x) <= 2 && fabsf(s.w.y) <= 2 && fabsf(s.w.z) <= 2 && s.col < m->w && s.row < m->h,
                  "u = %g, %g: pdf %g at (%g, %g, %g)", (double)u1, (double)u2, (double)s.pdf, (double)s.w.x, (double)s.w.y,
                  (double)s.w.z);
        }
    for (size_t i = 4; i < n; i++)
        for (size_t j = 0; j < 3; j++) {
            mcs_vec3 w = {0.5f, 0.5f, 0.5f};
            if (i == 4) w.x = w.y = w.z = 0;
            else if (j == 0) w.x = odd[i];
            else if (j == 1) w.y = odd[i];
            else w.z = odd[i];
            const float pdf = mcs_env_pdf(env_in(&a), w);
            mcs_vec2 u = mcs_env_invert(env_in(&a), w);
            CHECK(pdf == 0, "w = (%g, %g, %g): pdf %g", (double)w.x, (double)w.y, (double)w.z, (double)pdf);
            CHECK(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1, "w = (%g, %g, %g): invert", (double)w.x, (double)w.y, (double)w.z);
            mcs_texel at = mcs_env_texel(env_in(&a), w);
            CHECK(at.pdf == 0 && at.col < m->w && at.row < m->h && at.w.z == 1, "w = (%g, %g, %g): texel (%u, %u)", (double)w.x,
                  (double)w.y, (double)w.z, at.col, at.row);
        }
    arena_free(&a);
}

/* Exact axes and signed zeros: +z is in row 0, -z in the last, and a column is found for both. */
static void test_axes(void) {
    const float v[] = {0.0f, -0.0f, 1.0f, -1.0f};
    const map *m = &maps[4];
    arena a = build(m);
    for (int i = 0; i < 64; i++) {
        const mcs_vec3 w = {v[i & 3], v[i >> 2 & 3], v[i >> 4]};
        const mcs_texel at = mcs_env_texel(env_in(&a), w);
        const float pdf = mcs_env_pdf(env_in(&a), w);
        if (w.x == 0 && w.y == 0 && w.z == 0) continue;
        CHECK(at.col < m->w && at.row < m->h && pdf > 0 && pdf <= FLT_MAX, "(%g, %g, %g): (%u, %u), pdf %g", (double)w.x,
              (double)w.y, (double)w.z, at.col, at.row, (double)pdf);
        if (w.x == 0 && w.y == 0) CHECK(at.row == (w.z > 0 ? 0 : m->h - 1), "pole %g: row %u", (double)w.z, at.row);
    }
    arena_free(&a);
}

/* ---- orientation ---- */

static double dot(mcs_vec3 a, mcs_vec3 b) { return (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z; }

/* A turned map is the same map: drawn where the turned sample lies, with its density. Turning rounds each coordinate by 4 eps,
 * so a direction closer than that to a border of its texel may be found on the other side of it: 8 eps of a turn for columns,
 * divided by sin(theta), and for rows; such ones are counted, and few. */
static void test_frame(void) {
    const map *m = &maps[SKY];
    const int draws = scaled(200000);
    const mcs_vec3 up[4] = {{0, 0, -1}, {1, 0, 0}, {0.6f, 0, 0.8f}, {-0.48f, 0.6f, -0.64f}};
    arena a = build(m);
    arena b = build(m);
    mcs_env *turned = env_in(&b);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 83);
    for (int k = 0; k < 4; k++) {
        int near = 0;
        double mass = 0;
        turned->frame = mcs_frame_make(up[k]);
        if (k == 3) { /* and turned about its axis, and mirrored */
            const mcs_vec3 s = turned->frame.s;
            turned->frame.s = turned->frame.t;
            turned->frame.t = s;
        }
        CHECK(mcs_env_check(turned, b.bytes) == MCS_OK, "axis %d: not a table any more", k);
        for (int i = 0; i < draws; i++) {
            const float u1 = mcs_pcg32_float(&rng);
            const float u2 = mcs_pcg32_float(&rng);
            const mcs_texel s = mcs_env_sample(env_in(&a), u1, u2);
            const mcs_texel t = mcs_env_sample(turned, u1, u2);
            const mcs_frame *f = &turned->frame;
            const double x = (double)f->s.x * s.w.x + (double)f->t.x * s.w.y + (double)f->n.x * s.w.z;
            const double y = (double)f->s.y * s.w.x + (double)f->t.y * s.w.y + (double)f->n.y * s.w.z;
            const double z = (double)f->s.z * s.w.x + (double)f->t.z * s.w.y + (double)f->n.z * s.w.z;
            CHECK(t.col == s.col && t.row == s.row && t.pdf == s.pdf, "axis %d: another texel or density", k);
            CHECK(fabs(t.w.x - x) <= 4 * eps && fabs(t.w.y - y) <= 4 * eps && fabs(t.w.z - z) <= 4 * eps,
                  "axis %d: (%g, %g, %g) turned the wrong way", k, (double)t.w.x, (double)t.w.y, (double)t.w.z);
            mcs_vec3 local;
            local.x = (float)dot(f->s, t.w);
            local.y = (float)dot(f->t, t.w);
            local.z = (float)dot(f->n, t.w);
            double col, row;
            texel_of(m->w, m->h, local, &col, &row);
            const double margin_row = 8 * eps * m->h;
            const double margin_col = 8 * eps * m->w / hypot((double)local.x, (double)local.y);
            col -= floor(col);
            row -= floor(row);
            mcs_texel at = mcs_env_texel(turned, t.w);
            CHECK(mcs_env_pdf(turned, t.w) == at.pdf &&
                      at.pdf == mcs_env_pdf(env_in(&a), point(m->w, m->h, at.col, at.row, 0.5, 0.5)),
                  "axis %d: pdf %g is not the texel's", k, (double)at.pdf);
            if (at.col == s.col && at.row == s.row) continue;
            near++;
            CHECK((at.col == s.col || col <= margin_col || 1 - col <= margin_col) &&
                      (at.row == s.row || row <= margin_row || 1 - row <= margin_row),
                  "axis %d: drawn in (%u, %u), found in (%u, %u)", k, s.col, s.row, at.col, at.row);
        }
        /* at both borders of a column 8 eps w / sin(theta), 1.3 in the mean, at those of a row 8 eps h, twice as much allowed */
        CHECK(near <= draws * 64 * eps * m->w + 10, "axis %d: %d of %d draws found in a neighbour", k, near, draws);
        for (uint32_t r = 0; r < m->h; r++)
            for (uint32_t c = 0; c < m->w; c++) {
                const mcs_vec3 p = point(m->w, m->h, c, r, 0.5, 0.5);
                const mcs_vec3 w = mcs_to_world(&turned->frame, p);
                float pdf = 0;
                mcs_env_pdf_n(turned, 1, &w.x, &w.y, &w.z, &pdf);
                CHECK(pdf == mcs_env_pdf(turned, w), "axis %d: pdf_n %g", k, (double)pdf);
                mass += pdf * (double)solid_angle(r, m->w, m->h);
            }
        CHECK(fabs(mass - 1) <= 4 * eps, "axis %d: the density integrates to 1 + %g", k, mass - 1);
    }
    arena_free(&a);
    arena_free(&b);
}

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
        mcs_env_texel_n(e, n, x, y, z, skip & 1 ? NULL : col, skip & 2 ? NULL : row, skip & 4 ? NULL : pdf);
        for (size_t i = 0; i < n; i++) {
            const mcs_vec3 w = {x[i], y[i], z[i]};
            const mcs_texel t = mcs_env_texel(e, w);
            same &= (skip & 1 || col[i] == t.col) && (skip & 2 || row[i] == t.row) && (skip & 4 || pdf[i] == t.pdf);
        }
        CHECK(same, "n = %zu, without %zx: other texels than one by one", n, skip);
    }
    if (n) x[n - 1] = kept;
}

/* ---- batches, memory ---- */

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
                mcs_env_sample_n(env_in(&a), count, u1 + shift, u2 + at, p[0], p[1], p[2], p[3], skip & 4 ? NULL : col + at,
                                 skip & 8 ? NULL : row + at);
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
        CHECK(each >= 4 && each <= 16, "%u x %u: %g bytes a texel", w[i], w[i] / 2, each); /* at most what the largest peer takes */
    }
}

/* Where sums keep more digits than a double has, that of a window's begin and a place in it can lie between the largest double
 * below 2^31 and 2^31 itself: it is a place in the first column, which is bright; the last one has a few of 2^31. */
static void test_seam(void) {
    const float light[8] = {1, 1e-15f, 1, 1e-15f, 1, 1e-15f, 1, 1e-15f};
    const mcs_image image = mcs_image_make(light, 2, 4, 1);
    arena a = arena_make(mcs_env_bytes(2, 4));
    arena b = arena_make(mcs_env_window_bytes(4));
    mcs_env_window *const m = (mcs_env_window *)(void *)b.at;
    CHECK(mcs_env_build(env_in(&a), a.bytes, &image) == MCS_OK, "map");
    CHECK(mcs_env_window_build(m, b.bytes, env_in(&a), 0, 4, 1, 2) == MCS_OK, "window");
    for (int i = -36; i < -24; i++) {
        const mcs_texel t = mcs_env_window_sample(m, env_in(&a), (float)ldexp(0x0.ffffffp0, i), 0.853553414f);
        CHECK(t.col < 2 && t.pdf > 0, "u below 2^%d: column %u, pdf %g", i, t.col, (double)t.pdf);
    }
    arena_free(&a);
    arena_free(&b);
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
        arena_free(&a);
    }
    mcst_group("env statistics");
    if (mcst_case("chi-square of 1e7 draws over the sky")) test_whole_map();
    if (mcst_case("uniform in solid angle inside 4 x 2 texels")) test_inside_texels();
    if (mcst_case("uniform in solid angle inside both caps of 4099 rows")) test_caps();
    mcst_group("env input");
    if (mcst_case("1, 3, 4 channels and strides")) test_channels();
    if (mcst_case("pixel and row strides")) test_strides();
    if (mcst_case("refused strides")) test_refused_strides();
    if (mcst_case("bad pixels")) test_bad_pixels();
    if (mcst_case("bad channels, infinite ones")) test_bad_channels();
    if (mcst_case("all infinite")) test_all_infinite();
    if (mcst_case("black")) test_black();
    if (mcst_case("refused builds")) test_refused();
    if (mcst_case("bad u and directions")) test_bad_sampler_input();
    if (mcst_case("a window over the seam")) test_seam();
    if (mcst_case("axes")) test_axes();
    if (mcst_case("turned")) test_frame();
    mcst_group("env memory and batches");
    if (mcst_case("n = 0..67 and 2053, shifted, NULL outputs, in place, pdf_n")) test_batch();
    if (mcst_case("moved by memcpy")) test_relocation();
    if (mcst_case("bytes a texel")) test_size();
    return mcst_finish();
}
