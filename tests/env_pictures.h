/* What the tests of a map's memory draw from: pictures in several shades, and where their tables keep what. */
#ifndef MCST_ENV_PICTURES_H
#define MCST_ENV_PICTURES_H
#define SHADE_STREAM 3
#include "env_shades.h"

static const uint32_t one = 1u << 31; /* probabilities of rows and of columns are integers over this */

/* ---- pictures ---- */

typedef struct {
    const char *name;
    uint32_t w, h;
    shade value;
    float *lum;
} picture;

static inline float v_tiny(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (float)((c + r) % 4) * 1.4012984643e-45f;
}
static inline float v_huge(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (c + r) % 3 ? FLT_MAX : FLT_MAX / 4;
}
static inline float v_wide(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)h;
    return (c * 7 + r) % 5 ? powf(10.0f, 76.0f * hash01(r * w + c) - 38.0f) : 0.0f;
}
/* In a row next to a sun, every texel but one is a single integer of a row that is a single integer. */
static inline float v_suns(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    if (r == h / 3) return c == w / 2 ? 1e30f : 1.0f;
    if (r == h / 2) return c == w / 4 ? 1e-5f : 1e-20f * (1.0f + hash01(c));
    return hash01(r * w + c);
}
static inline float v_sky(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    const float up = 1.0f - 2.0f * ((float)r + 0.5f) / (float)h;
    if (c == w / 5 && r == h / 4) return 1e5f;
    return up > 0 ? 1.0f - 0.7f * up + 0.1f * hash01(r * w + c) : 0.0f;
}
/* Light in a rectangle; some of it black. */
static inline float v_region(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    const int in = c >= w / 3 && c < w / 3 + w / 5 && r >= h / 4 && r < h / 4 + h / 3;
    return in && (c + r) % 7 ? 0.5f + hash01(r * w + c) : 0.0f;
}
/* Rows black but for every third one. */
static inline float v_thirds(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)h;
    return r % 3 == 1 ? hash01(r * w + c) : 0.0f;
}
/* One texel per row 1e8 times brighter than the others, which differ by up to 3. */
static inline float v_sun_rows(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)h;
    return c == (r * 977 + 5) % w ? 1e8f : 0.5f + hash01(r * w + c);
}

static inline void draw(picture *p) {
    p->lum = (float *)memory((size_t)p->w * p->h * sizeof *p->lum);
    for (uint32_t r = 0; r < p->h; r++)
        for (uint32_t c = 0; c < p->w; c++) p->lum[(size_t)r * p->w + c] = p->value(c, r, p->w, p->h);
}
static inline picture make(const char *name, uint32_t w, uint32_t h, shade value) {
    picture p;
    p.name = name;
    p.w = w;
    p.h = h;
    p.value = value;
    draw(&p);
    return p;
}

static inline mcs_env *env_in(const arena *a) { return (mcs_env *)(void *)a->at; }
static inline uint32_t *rows_of(const arena *a) { return (uint32_t *)(void *)(a->at + env_in(a)->offset.row_sums); }
static inline uint32_t *cdf_of(const arena *a, uint32_t row) {
    return (uint32_t *)(void *)(a->at + env_in(a)->offset.col_sums) + (size_t)row * (env_in(a)->w + 1);
}
static inline unsigned char *guide_of(const arena *a, uint32_t row) {
    return a->at + env_in(a)->offset.col_guide + (size_t)row * env_in(a)->offset.guide_length * 2;
}

static inline arena build(const picture *p, brightness want) {
    const arena a = arena_make(mcs_env_bytes(p->w, p->h));
    const mcs_image image = mcs_image_make(p->lum, p->w, p->h, 1);
    const mcs_status rc = mcs_env_build(env_in(&a), a.bytes, &image);
    CHECK(rc == MCS_OK && arena_intact(&a), "%s: build returns %d", p->name, rc);
    CHECK(brightness_of(env_in(&a)) == want, "%s: total %g, uniform %u", p->name, env_in(&a)->total,
          env_in(&a)->uniform);
    return a;
}

static inline int same(mcs_texel s, mcs_texel t) {
    return s.w.x == t.w.x && s.w.y == t.w.y && s.w.z == t.w.z && s.pdf == t.pdf && s.col == t.col && s.row == t.row;
}
/* Bits in the middle of what cell i of a cumulative list gets: twice a number below 2^31. */
static inline uint32_t middle(const uint32_t *cdf, uint32_t i) { return cdf[i] + cdf[i + 1]; }
#endif
