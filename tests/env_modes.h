/* What the tests of the environment map's modes draw from: pictures that are made up, their tables, and means of samples.
 */
#ifndef MCST_ENV_MODES_H
#define MCST_ENV_MODES_H
#include "asserting.h"
#define SHADE_STREAM 4
#include "env_shades.h"

static const double level = 1e-5; /* of one statistical test: Sidak, 1000 of them in the whole suite at 0.01 together */
static const double sigmas = 4.42;     /* the same level for a mean, both sides */
static const double quantum = 0x1p-31; /* probabilities of rows and of columns are integers over 2^31 */

static inline void *get(size_t bytes) {
    void *p = calloc(bytes, 1);
    if (!p) {
        fprintf(stderr, "out of memory\n");
        exit(2);
    }
    return p;
}

/* ---- pictures ---- */

/* Luminance; then what the table should have, from luminance as it is, filtered, or less a floor: probabilities of
 * texels and of rows, and the integral over the sphere. */
typedef struct {
    const char *name;
    uint32_t w, h;
    float *lum;
    ld *prob, *row_prob, total;
} picture;

/* A sky brighter towards its horizon, dark ground, and a sun of one texel that is 1e5 times brighter. */
static inline float v_sky(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    const float up = 1.0f - 2.0f * ((float)r + 0.5f) / (float)h;
    if (c == w / 5 && r == h / 4) return 1e5f;
    return up > 0 ? 1.0f - 0.7f * up + 0.1f * hash01(r * w + c) : 0.05f;
}
/* Light in a rectangle across the seam; some of it black. */
static inline float v_region(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    const int in = (c < w / 4 || c >= w - w / 8) && r >= h / 4 && r < h / 4 + h / 3;
    return in && (c + r) % 7 ? 0.5f + hash01(r * w + c) : 0.0f;
}
/* Even light and a lamp of a few texels. */
static inline float v_lamp(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    return r >= h / 4 && r < h / 4 + 3 && c >= w / 2 && c < w / 2 + 4 ? 40.0f : 1.0f;
}
/* Smooth light: 1 + cos(phi) sin(theta) / 2 + 0.3 cos(theta) at the middle of the texel. */
static inline double smooth(mcs_vec3 v) { return 1 + 0.5 * v.x + 0.3 * v.z; }
static inline float v_smooth(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    return (float)smooth(point(w, h, c, r, 0.5, 0.5));
}

static inline picture blank(const char *name, uint32_t w, uint32_t h) {
    picture p;
    p.name = name;
    p.w = w;
    p.h = h;
    p.total = 0;
    p.lum = (float *)get((size_t)w * h * sizeof *p.lum);
    p.prob = (ld *)get((size_t)w * h * sizeof *p.prob);
    p.row_prob = (ld *)get(h * sizeof *p.row_prob);
    return p;
}
static inline void discard(picture *p) {
    free(p->lum);
    free(p->prob);
    free(p->row_prob);
}
/* prob[] holds weights per solid angle. */
static inline void normalise(picture *p) {
    p->total = 0;
    for (uint32_t r = 0; r < p->h; r++) {
        const ld omega = solid_angle(r, p->w, p->h);
        for (uint32_t c = 0; c < p->w; c++) p->total += p->prob[(size_t)r * p->w + c] *= omega;
    }
    for (uint32_t r = 0; r < p->h && p->total > 0; r++) {
        p->row_prob[r] = 0;
        for (uint32_t c = 0; c < p->w; c++) p->row_prob[r] += p->prob[(size_t)r * p->w + c] /= p->total;
    }
}
static inline void weigh(picture *p) {
    for (size_t i = 0; i < (size_t)p->w * p->h; i++) p->prob[i] = p->lum[i];
    normalise(p);
}
static inline picture make(const char *name, uint32_t w, uint32_t h, shade value) {
    picture p = blank(name, w, h);
    for (uint32_t r = 0; r < h; r++)
        for (uint32_t c = 0; c < w; c++) p.lum[(size_t)r * w + c] = value(c, r, w, h);
    weigh(&p);
    return p;
}

static inline mcs_env *env_in(const arena *a) { return (mcs_env *)(void *)a->at; }
static inline arena build_image(const char *name, const mcs_image *image, brightness want) {
    const arena a = arena_make(mcs_env_bytes(image->w, image->h));
    const mcs_status rc = mcs_env_build(env_in(&a), a.bytes, image);
    CHECK(rc == MCS_OK && arena_intact(&a), "%s: build returns %d", name, rc);
    CHECK(brightness_of(env_in(&a)) == want, "%s: total %g, uniform %u", name, env_in(&a)->total, env_in(&a)->uniform);
    return a;
}
static inline mcs_image image_of(const picture *p) { return mcs_image_make(p->lum, p->w, p->h, 1); }
static inline arena build(const picture *p, brightness want) {
    const mcs_image image = image_of(p);
    return build_image(p->name, &image, want);
}

/* Probabilities of rows, and of columns within a row, are integers over 2^31 with at least one where there is light:
 * each moves by one of rounding, its own one, and its share of those for all. Relative to the probability of the texel.
 */
static inline double slack(const picture *p, uint32_t col, uint32_t row) {
    const double prow = (double)p->row_prob[row];
    const double pcol = (double)(p->prob[(size_t)row * p->w + col] / p->row_prob[row]);
    return (1 + (2 / prow + p->h) * quantum) * (1 + (2 / pcol + p->w) * quantum) - 1;
}

/* Mean and variance as they come (Welford 1962), so that equal values have no variance. */
typedef struct {
    double n, mean, squares, worst;
} moments;
static inline void add(moments *m, double x) {
    const double off = x - m->mean;
    m->n++;
    m->mean += off / m->n;
    m->squares += off * (x - m->mean);
    m->worst = fmax(m->worst, x);
}
static inline double variance_of(const moments *m) { return m->squares / (m->n - 1); }
static inline double error_of(const moments *m) { return sqrt(variance_of(m) / m->n); }

#endif
