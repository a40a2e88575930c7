/* Stand-ins for region tables, with the names that the library will give them. Where mcsample.h has them, this header
 * goes, but for the rule that bench programs vary. */
#ifndef MCST_SHADOW_REGION_H
#define MCST_SHADOW_REGION_H
#include "mcsample.h"
#include <math.h>
#include <string.h>

/* How the table of a region follows from what it has learned. */
typedef struct {
    float exponent; /* of the visible share V */
    float prior;    /* V of a region without rays and without a parent */
    float count;    /* so many rays the prior weighs */
    float floor;    /* V is at least this */
    float even;     /* for each draw by the reflection, so many without regard to it */
} region_rule;

static const region_rule region_usual = {1, 0.25f, 2, 0.0001f, 0.2f};
#define REGION_WIDTH 0.1f /* lobes are widened by this, as points of a region have other mirror directions */

/* What a region has learned of each of its n tiles: float squares[n], rays[n], through[n] follow. */
typedef struct {
    uint32_t tiles;
    float points;
} mcs_region;

static float *region_squares(const mcs_region *g) { return (float *)(uintptr_t)(g + 1); }
static float *region_rays(const mcs_region *g) { return region_squares(g) + g->tiles; }
static float *region_through(const mcs_region *g) { return region_squares(g) + 2 * g->tiles; }

static size_t mcs_region_bytes(uint32_t rows) {
    return sizeof(mcs_region) + 3 * 2 * (size_t)rows * rows * sizeof(float);
}
static mcs_status mcs_region_start(mcs_region *g, size_t bytes, const mcs_tiles *t) {
    if (bytes < mcs_region_bytes(t->rows)) return MCS_ERR_MEMORY;
    memset(g, 0, bytes);
    g->tiles = t->rows * t->cols;
    return MCS_OK;
}
/* Adds a point of the region: the squares of its reflection towards the tiles. */
static void region_add(mcs_region *g, const mcs_tiles *t, const mcs_env *e, const mcs_reflection *r, float width) {
    float value[2 * MCSI_TILE_ROWS_MAX * MCSI_TILE_ROWS_MAX];
    mcsi_surface s = mcsi_surface_make(e, r);
    s.ax2 += width * width;
    s.ay2 += width * width;
    mcsi_tile_values_n(&s, g->tiles, MCSI_READ(float, t, mcsi_tiles_offsets_of(t).light), value);
    float *squares = region_squares(g);
    for (uint32_t k = 0; k < g->tiles; k++) squares[k] += value[k] * value[k];
    g->points += 1;
}
static void mcs_region_add_point(mcs_region *g, const mcs_tiles *t, const mcs_env *e, const mcs_reflection *r) {
    region_add(g, t, e, r, REGION_WIDTH);
}
/* Adds a shadow ray of the region, in a direction of the tile. */
static void mcs_region_add_ray(mcs_region *g, uint32_t tile, int through) {
    region_rays(g)[tile] += 1;
    region_through(g)[tile] += through ? 1.0f : 0.0f;
}
/* Adds all that another region has learned. */
static void mcs_region_merge(mcs_region *g, const mcs_region *other) {
    float *sum = region_squares(g);
    const float *more = region_squares(other);
    for (uint32_t k = 0; k < 3 * g->tiles; k++) sum[k] += more[k];
    g->points += other->points;
}
/* All that was learned counts `keep` times as much as before. */
static void mcs_region_decay(mcs_region *g, float keep) {
    float *sum = region_squares(g);
    for (uint32_t k = 0; k < 3 * g->tiles; k++) sum[k] *= keep;
    g->points *= keep;
}

/* The tile of a texel, and of a world direction. */
static uint32_t mcs_tiles_of_texel(const mcs_tiles *t, const mcs_env *e, uint32_t col, uint32_t row) {
    return mcsi_tile_of(col, t->cols, e->w) * t->rows + mcsi_tile_of(row, t->rows, e->h);
}
static uint32_t mcs_tiles_find(const mcs_tiles *t, const mcs_env *e, mcs_vec3 w) {
    const mcs_texel x = mcs_env_texel(e, w);
    return mcs_tiles_of_texel(t, e, x.col, x.row);
}

/* The visible share of a tile: the prior counts like `count` rays; that of a parent region is the better one. */
static float region_visible(const mcs_region *g, const mcs_region *parent, uint32_t k, const region_rule *how) {
    float prior = how->prior;
    if (parent) prior = (region_through(parent)[k] + how->count * prior) / (region_rays(parent)[k] + how->count);
    return fmaxf((region_through(g)[k] + how->count * prior) / (region_rays(g)[k] + how->count), how->floor);
}
/* V to the exponent, for all tiles. */
static void region_shadow(const mcs_region *g, const mcs_region *parent, const region_rule *how, float *shadow) {
    for (uint32_t k = 0; k < g->tiles; k++) {
        const float visible = region_visible(g, parent, k, how);
        shadow[k] = how->exponent == 1 ? visible : powf(visible, how->exponent);
    }
}
/* The table of a region: each tile weighs its light, V to the exponent, and the root mean square of the reflection, to
 * which a part of that of all visible light is added. */
static mcs_status region_build(mcs_product *p, const mcs_tiles *t, const mcs_env *e, const mcs_region *g,
                               const float *shadow, float even) {
    float weight[2 * MCSI_TILE_ROWS_MAX * MCSI_TILE_ROWS_MAX];
    const float *light = MCSI_READ(float, t, mcsi_tiles_offsets_of(t).light);
    float reflected = 0;
    float all = 0;
    for (uint32_t k = 0; k < g->tiles; k++) {
        weight[k] = sqrtf(region_squares(g)[k] / g->points);
        reflected += light[k] * shadow[k] * weight[k];
        all += light[k] * shadow[k];
    }
    const float more = reflected > 0 ? even * reflected / all : 1;
    for (uint32_t k = 0; k < g->tiles; k++) weight[k] = (weight[k] + more) * shadow[k];
    return mcs_product_build_weights(p, mcs_product_bytes(t->rows), t, e, weight);
}
static mcs_status mcs_product_build_region(mcs_product *p, size_t bytes, const mcs_tiles *t, const mcs_env *e,
                                           const mcs_region *g, const mcs_region *parent) {
    float shadow[2 * MCSI_TILE_ROWS_MAX * MCSI_TILE_ROWS_MAX];
    if (bytes < mcs_product_bytes(t->rows)) return MCS_ERR_MEMORY;
    region_shadow(g, parent, &region_usual, shadow);
    return region_build(p, t, e, g, shadow, region_usual.even);
}

/* ---- A product at a point that knows the visible light, and has no fireflies ---- */

/* Beside what mcs_product_build does: anisotropic lobes count as narrow as their narrower width; a tile weighs at least
 * half of its own bilinear mean; `least` of the samples come from the lobe, unless the surface is matte; tiles have
 * shadow[k] of their light. */
static void learned_build(mcs_product *p, const mcs_tiles *t, const mcs_env *e, const mcs_reflection *r,
                          const float *shadow) {
    mcs_product_build(p, mcs_product_bytes(t->rows), t, e, r);
    const mcsi_surface s = mcsi_surface_make(e, r);
    const uint32_t n = t->rows * t->cols;
    float light[2 * MCSI_TILE_ROWS_MAX * MCSI_TILE_ROWS_MAX];
    mcsi_product_lists l = mcsi_product_lists_of(p, t);
    const float narrow = (float)n * fminf(s.ax2, s.ay2) * s.wo.z;
    const float already = mcsi_lobe_in_cells(&s, n);
    if (s.matte < 1 && narrow < MCSI_GRIDS_BELOW && !(already < MCSI_GRIDS_BELOW)) mcsi_product_refine(p, t, &s);
    for (uint32_t k = 0; k < n; k++) {
        const mcsi_tile tile = {k % t->rows, k / t->rows};
        const mcsi_warp_source w = mcsi_product_warp_source(p, t, tile);
        const float corners = 0.25f * (w.corner.v00 + w.corner.v01 + w.corner.v10 + w.corner.v11);
        const float mean = w.value + w.evenness * (corners - w.value);
        light[k] = l.light[k] * shadow[k];
        if (l.value[k] > 0 && !mcsi_product_grid(p, tile)) l.value[k] = fmaxf(l.value[k], 0.5f * mean);
    }
    l.light = light;
    mcsi_tile_shares_n(&l);
    uint32_t *row_sums = MCSI_WRITE(uint32_t, p, p->at.row_sums);
    double *per_share = MCSI_WRITE(double, p, p->at.per_share);
    const uint32_t all = mcsi_shares_build(row_sums, l.row_weight, t->rows);
    p->row_total = all * (1.0 / MCSI_ONE);
    for (uint32_t i = 0; i < t->rows; i++) {
        const uint32_t share = row_sums[i + 1] - row_sums[i];
        per_share[i] = share ? share / ((double)all * l.tile_sums[n + i]) : 0.0;
    }
    p->dark = all == 0;
}
#endif
