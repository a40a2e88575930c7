/* render_product.h - the strategies of render.c that draw from map times BRDF: a table that is built for the point, or
 * one of the region that the point lies in. */
#ifndef RENDER_PRODUCT_H
#define RENDER_PRODUCT_H
#include "render_point.h"

/* Whether the region of the point wants to know of its rays. */
static int point_learns(const lit_point *x) { return x->region && x->region->learns; }

static void point_tell(const lit_point *x, uint32_t tile, int through) {
    shadow_rays_add(x->regions, x->rays, x->region, tile, through);
}

/* Whether the light of this texel reaches the point. */
static int texel_reaches(const lit_point *x, mcs_texel t) {
    const int through = point_sees(x, t.w);
    if (point_learns(x)) point_tell(x, mcs_tiles_of_texel(x->e->tiles, x->e->table, t.col, t.row), through);
    return through;
}

/* One light sample of a product that is paired with `share` BRDF samples by the balance heuristic. */
static vec3 product_value(const lit_point *x, mcs_texel t, float share) {
    const material *m = x->hit->m;
    const vec3 wi = mcs_to_local(&x->hit->frame, t.w);
    if (!(t.pdf > 0 && wi.z > 0 && texel_reaches(x, t))) return black;
    const float brdf = share > 0 ? share * material_pdf(m, x->hit->wo, wi) : 0;
    const vec3 f_cos = material_eval(m, x->hit->wo, wi);
    return scale(1 / (t.pdf + brdf), mul(f_cos, radiance_at(x->e, t.col, t.row)));
}

/* Many samples of a product are drawn a block at a time, by the array form. */
static vec3 product_sum_n(const lit_point *x, const mcs_product *product, uint32_t samples, float share) {
    enum { BLOCK = 32 };
    float u1[BLOCK], u2[BLOCK], wx[BLOCK], wy[BLOCK], wz[BLOCK], pdf[BLOCK];
    uint32_t col[BLOCK], row[BLOCK];
    vec3 sum = black;
    uint32_t n;
    for (; samples > 0; samples -= n) {
        n = samples < BLOCK ? samples : BLOCK;
        mcs_pcg32_fill_n(x->rng, n, u1);
        mcs_pcg32_fill_n(x->rng, n, u2);
        mcs_product_sample_n(product, x->e->tiles, x->e->table, n, u1, u2, wx, wy, wz, pdf, col, row);
        for (uint32_t i = 0; i < n; i++) {
            mcs_texel t;
            t.w = vec(wx[i], wy[i], wz[i]);
            t.pdf = pdf[i];
            t.col = col[i];
            t.row = row[i];
            sum = add(sum, product_value(x, t, share));
        }
    }
    return sum;
}

static vec3 product_sum(const lit_point *x, const mcs_product *product, uint32_t samples, float share) {
    if (samples > 1) return product_sum_n(x, product, samples, share);
    const float u1 = mcs_pcg32_float(x->rng);
    const float u2 = mcs_pcg32_float(x->rng);
    return product_value(x, mcs_product_sample(product, x->e->tiles, x->e->table, u1, u2), share);
}

/* Of a product that is prepared for this point. Where the strategy learns, the light is dimmed to what its region sees.
 */
static vec3 reflect_product(const lit_point *x, uint32_t samples) {
    union {
        mcs_product product;
        char room[MCS_PRODUCT_BYTES(TILES)];
    } here;
    const mcs_reflection r = reflection_of(x->hit);
    const mcs_region *known = x->region ? x->region->known : NULL;
    const int status = mcs_product_build(&here.product, sizeof here, x->e->tiles, x->e->table, &r, known);
    return status == MCS_OK ? product_sum(x, &here.product, samples, 0) : black;
}

/* A BRDF sample, the other half of what is paired with the table of a region. */
static vec3 region_bounce(const lit_point *x, const mcs_product *table) {
    const bounce b = point_bounce(x);
    if (!(b.pdf > 0)) return black;
    const vec3 w = mcs_to_world(&x->hit->frame, b.wi);
    const int through = point_sees(x, w);
    if (point_learns(x)) point_tell(x, mcs_tiles_of_direction(x->e->tiles, x->e->table, w), through);
    if (!through) return black;
    const mcs_texel t = mcs_product_texel(table, x->e->tiles, x->e->table, w);
    const float share = x->region->share;
    return scale(mcs_mis_balance(share * b.pdf, t.pdf) / share, mul(b.weight, radiance_at(x->e, t.col, t.row)));
}

static vec3 reflect_region(lit_point *x, uint32_t samples) {
    const mcs_product *table = x->region->table;
    vec3 sum = product_sum(x, table, samples, x->region->share);
    for (uint32_t i = 0; i < samples; i++)
        if (point_bounce_is_due(x, x->region->share)) sum = add(sum, region_bounce(x, table));
    return sum;
}

#endif
