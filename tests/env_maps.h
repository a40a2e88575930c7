/* What the tests of environment maps draw from: images with the probability of every texel, summed in long double. */
#ifndef MCST_ENV_MAPS_H
#define MCST_ENV_MAPS_H
#define SHADE_STREAM 2
#include "env_shades.h"

enum { MAX_TEXELS = 8192 * 16 };
static const double level = 1e-5; /* of one statistical test: Sidak, 1000 of them in the whole suite at 0.01 together */
static const double quantum = 0x1p-31; /* probabilities of rows and of columns are integers over 2^31 */

/* ---- maps ---- */

typedef struct {
    const char *name;
    uint32_t w, h;
    shade value;
    int draws; /* random samples that are checked one by one */
} map;

static inline float v_one(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)c;
    (void)r;
    (void)w;
    (void)h;
    return 1.0f;
}
static inline float v_poles(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    return r == 0 || r == h - 1 ? 1.0f + (float)(c % 3) : 0.0f;
}
static inline float v_equator(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    return r == h / 2 && c % 5 ? 1.0f : 0.0f;
}
static inline float v_peak(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    return c == w / 3 && r == h / 3 ? 1e30f : (c ^ r) & 3 ? hash01(r * w + c) : 0.0f;
}
static inline float v_huge(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (c + r) % 3 ? FLT_MAX : FLT_MAX / 4;
}
static inline float v_tiny(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (float)((c + r) % 4) * 1.4012984643e-45f;
}
static inline float v_corner(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    return c == w - 1 && r == h - 1 ? 2.0f : 0.0f;
}
/* A sky brighter towards its horizon, dark ground, and a sun of one texel in every 32 x 32 that is 1e5 times brighter.
 */
static inline float v_sky(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
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
static ld row_angle[8192]; /* the solid angle of a texel of the row */

static inline void load(const map *m) {
    total = 0;
    for (uint32_t r = 0; r < m->h; r++) {
        row_angle[r] = solid_angle(r, m->w, m->h);
        for (uint32_t c = 0; c < m->w; c++) {
            const volatile float v = m->value(c, r, m->w, m->h); /* with the digits of a float: x87 keeps more */
            pixels[r * m->w + c] = v;
            total += prob[r * m->w + c] = v * row_angle[r];
        }
    }
    for (uint32_t r = 0; r < m->h; r++) {
        row_prob[r] = 0;
        for (uint32_t c = 0; c < m->w; c++) row_prob[r] += prob[r * m->w + c] /= total;
    }
}

static inline mcs_env *env_in(const arena *a) { return (mcs_env *)(void *)a->at; }

static inline mcs_status build_from(mcs_env *e, size_t bytes, const float *p, uint32_t w, uint32_t h, uint32_t channels,
                                    size_t stride) {
    mcs_image image = mcs_image_make(p, w, h, channels);
    image.row_stride = (ptrdiff_t)stride;
    return mcs_env_build(e, bytes, &image);
}

static inline arena build(const map *m) {
    const arena a = arena_make(mcs_env_bytes(m->w, m->h));
    load(m);
    const int rc = build_from(env_in(&a), a.bytes, pixels, m->w, m->h, 1, 0);
    CHECK(rc == MCS_OK, "build returns %d", rc);
    CHECK(arena_intact(&a), "build wrote outside its %zu bytes", a.bytes);
    CHECK(env_in(&a)->bad == 0, "%llu bad texels", (unsigned long long)env_in(&a)->bad);
    /* row borders are doubles between 0 and 2: the height of a row is off by 2^-51, and no row is lower than the first
     */
    CHECK(fabs((double)(env_in(&a)->total / total - 1)) <= 1e-12 + 0x1p-51 / (1 - cos(pi / m->h)), "total %g, not %g",
          env_in(&a)->total, (double)total);
    return a;
}

/* ---- checks of a map ---- */

/* Probabilities of rows, and of columns within a row, are integers over 2^31 with at least one where there is light:
 * each moves by one of rounding, its own one, and its share of those for all. The bound is relative to the probability
 * of the texel. */
static inline double slack(const map *m, uint32_t col, uint32_t row) {
    const double prow = (double)row_prob[row];
    const double pcol = (double)(prob[row * m->w + col] / row_prob[row]);
    return (1 + (2 / prow + m->h) * quantum) * (1 + (2 / pcol + m->w) * quantum) - 1;
}

static inline void check_density(const map *m, const mcs_env *e) {
    double mass = 0;
    const uint32_t step = m->w > 1000 ? 61 : 1;
    for (uint32_t r = 0; r < m->h; r++) {
        const double omega = (double)solid_angle(r, m->w, m->h);
        for (uint32_t c = 0; c < m->w; c++) {
            const mcs_vec3 w = point(m->w, m->h, c, r, 0.5, 0.5);
            const double p = mcs_env_pdf(e, w);
            const double want = (double)prob[r * m->w + c];
            const mcs_texel at = mcs_env_texel(e, w);
            mass += p * omega;
            CHECK(at.col == c && at.row == r, "texel of the centre of (%u, %u): (%u, %u)", c, r, at.col, at.row);
            CHECK((p > 0) == (want > 0), "texel (%u, %u): density %g where the probability is %g", c, r, p, want);
            /* weight of the row, sum of the weights, density: three float roundings */
            if (want > 0 && c % step == 0) {
                const double tol = slack(m, c, r) + 4 * eps;
                CHECK(fabs(p * omega - want) <= tol * want, "texel (%u, %u): probability %g, not %g", c, r, p * omega,
                      want);
            }
        }
    }
    CHECK(fabs(mass - 1) <= 4 * eps, "the density integrates to 1 + %g", mass - 1);
}

/* Everything that must hold for a sample whatever u was. */
static inline void check_sample(const map *m, const mcs_env *e, float u1, float u2) {
    const mcs_texel s = mcs_env_sample(e, u1, u2);
    const double len = sqrt((double)s.w.x * s.w.x + (double)s.w.y * s.w.y + (double)s.w.z * s.w.z);
    const int inside = s.col < m->w && s.row < m->h;
    CHECK(inside, "u = %a, %a: texel (%u, %u)", (double)u1, (double)u2, s.col, s.row);
    if (!inside) return;
    CHECK(fabs(len - 1) <= 4 * eps, "u = %a, %a: length 1 + %g", (double)u1, (double)u2, len - 1);
    CHECK(pixels[s.row * m->w + s.col] > 0, "u = %a, %a: black texel (%u, %u)", (double)u1, (double)u2, s.col, s.row);
    CHECK(s.pdf > 0 && s.pdf <= FLT_MAX, "u = %a, %a: pdf %g", (double)u1, (double)u2, (double)s.pdf);
    CHECK(mcs_env_pdf(e, s.w) == s.pdf, "u = %a, %a: pdf %g, returned %g", (double)u1, (double)u2,
          (double)mcs_env_pdf(e, s.w), (double)s.pdf);
    const mcs_texel at = mcs_env_texel(e, s.w);
    CHECK(at.pdf == s.pdf && at.col == s.col && at.row == s.row, "u = %a, %a: texel (%u, %u), returned (%u, %u)",
          (double)u1, (double)u2, at.col, at.row, s.col, s.row);
    double c, r;
    texel_of(m->w, m->h, s.w, &c, &r);
    double off = fabs(c - s.col - 0.5);
    if (off > m->w / 2.0) off = m->w - off;
    CHECK(off <= 0.5 + 4 * eps * m->w, "u = %a, %a: column %.9g, returned %u", (double)u1, (double)u2, c, s.col);
    CHECK(fabs(r - s.row - 0.5) <= 0.5 + 4 * eps * m->h, "u = %a, %a: row %.9g, returned %u", (double)u1, (double)u2, r,
          s.row);
    const mcs_vec2 back = mcs_env_invert(e, s.w);
    {
        /* In parts of a cell, the place is off by the margin of 4 eps cells times their number that samples keep from
         * borders, by the rounding of the azimuth (2 eps of a turn) or of z (2 eps), and once more that much in the
         * inverse. */
        const double prow = (double)row_prob[s.row];
        const double pcol = (double)(prob[s.row * m->w + s.col] / row_prob[s.row]);
        const double dz = (double)row_angle[s.row] * m->w / (2 * pi);
        const double d1 = pcol * m->w * 8 * eps;
        const double d2 = prow * (m->h * 4 + 4 / dz) * eps;
        const int pole = s.w.x == 0 && s.w.y == 0; /* no azimuth there */
        CHECK(back.x >= 0 && back.x < 1 &&
                  (pole || fabs((double)back.x - u1) <= (d1 < pcol ? d1 : pcol) + 2 * quantum * m->w + 2 * eps),
              "u1 = %a: invert %a", (double)u1, (double)back.x);
        CHECK(back.y >= 0 && back.y < 1 &&
                  fabs((double)back.y - u2) <= (d2 < prow ? d2 : prow) + 2 * quantum * m->h + 2 * eps,
              "u2 = %a: invert %a", (double)u2, (double)back.y);
    }
}
#endif
