/* render_strategy.h - direct illumination in render.c: each strategy estimates the integral of f L V cos over the
 * hemisphere. */
#ifndef RENDER_STRATEGY_H
#define RENDER_STRATEGY_H
#include "render_learning.h"
#include "render_light.h"
#include "render_options.h"
#include "render_scene.h"

/* A point that is being lit. */
typedef struct {
    const scene *s;
    const environment *e;
    const surface *x;
    mcs_pcg32 *rng;
    learning *l; /* NULL for strategies that do not learn */
    uint16_t region;
    shadow_rays *rays;
    uint32_t drawn; /* light samples so far */
} lit_point;

static bounce draw_bounce(const lit_point *p) {
    const float u0 = mcs_pcg32_float(p->rng);
    const float u1 = mcs_pcg32_float(p->rng);
    const float u2 = mcs_pcg32_float(p->rng);
    return material_sample(p->x->m, p->x->wo, u0, u1, u2);
}

/* f L cos */
static vec3 integrand(const lit_point *p, vec3 wi, mcs_texel l) {
    return mul(material_eval(p->x->m, p->x->wo, wi), radiance_at(p->e, l.col, l.row));
}

/* ---- one sample ---- */

/* With mis, one half of a multi-sample estimator with the power heuristic (Veach and Guibas, "Optimally combining
 * sampling techniques", 1995); without, an estimator by itself. Likewise the environment. */
static vec3 sample_brdf(const lit_point *p, int mis) {
    const bounce b = draw_bounce(p);
    const vec3 w = mcs_to_world(&p->x->frame, b.wi);
    if (!(b.pdf > 0 && visible(p->s, p->x->p, w, p->x->object))) return vec(0, 0, 0);
    const mcs_texel l = mcs_env_texel(p->e->table, w);
    const vec3 value = mul(b.weight, radiance_at(p->e, l.col, l.row));
    return mis ? scale(mcs_mis_power(p->x->m->share * b.pdf, l.pdf) / p->x->m->share, value) : value;
}

static vec3 sample_environment(const lit_point *p, int mis) {
    const float u1 = mcs_pcg32_float(p->rng);
    const float u2 = mcs_pcg32_float(p->rng);
    const mcs_texel l = mcs_env_sample(p->e->table, u1, u2);
    const vec3 wi = mcs_to_local(&p->x->frame, l.w);
    if (!(l.pdf > 0 && wi.z > 0 && visible(p->s, p->x->p, l.w, p->x->object))) return vec(0, 0, 0);
    const vec3 value = scale(1 / l.pdf, integrand(p, wi, l));
    return mis ? scale(mcs_mis_power(l.pdf, p->x->m->share * material_pdf(p->x->m, p->x->wo, wi)), value) : value;
}

static vec3 sample_hemisphere(const lit_point *p, int cosine) {
    const float u1 = mcs_pcg32_float(p->rng);
    const float u2 = mcs_pcg32_float(p->rng);
    const mcs_dir d = cosine ? mcs_cosine_sample(u1, u2) : mcs_hemisphere_sample(u1, u2);
    const vec3 w = mcs_to_world(&p->x->frame, d.w);
    if (!(d.pdf > 0 && visible(p->s, p->x->p, w, p->x->object))) return vec(0, 0, 0);
    return scale(1 / d.pdf, integrand(p, d.w, mcs_env_texel(p->e->table, w)));
}

/* Whether one BRDF sample is due, of which there are m->share for each other sample. */
static int brdf_is_due(lit_point *p) {
    if (p->x->m->share < 1 && !(mcs_pcg32_float(p->rng) < p->x->m->share)) return 0;
    p->drawn++;
    return 1;
}

/* ---- products: many samples ---- */

/* Whether the light of this texel reaches the point. The regions are told. */
static int light_reaches(const lit_point *p, mcs_texel l) {
    const int through = visible(p->s, p->x->p, l.w, p->x->object);
    if (p->l)
        shadow_rays_add(p->l, p->rays, p->region, mcs_tiles_of_texel(p->e->tiles, p->e->table, l.col, l.row), through);
    return through;
}

/* One light sample of a product that is paired with `share` BRDF samples by the balance heuristic. */
static vec3 product_value(const lit_point *p, mcs_texel l, float share) {
    const vec3 wi = mcs_to_local(&p->x->frame, l.w);
    if (!(l.pdf > 0 && wi.z > 0 && light_reaches(p, l))) return vec(0, 0, 0);
    const float brdf = share > 0 ? share * material_pdf(p->x->m, p->x->wo, wi) : 0;
    return scale(1 / (l.pdf + brdf), integrand(p, wi, l));
}

/* Samples of a product alone, a block at a time. */
static vec3 sample_product(const lit_point *p, const mcs_product *product, uint32_t lights, float share) {
    enum { BLOCK = 32 };
    vec3 sum = {0, 0, 0};
    uint32_t n;
    for (; lights > 0; lights -= n) {
        n = lights < BLOCK ? lights : BLOCK;
        if (n == 1) {
            const float u1 = mcs_pcg32_float(p->rng);
            const float u2 = mcs_pcg32_float(p->rng);
            sum = add(sum, product_value(p, mcs_product_sample(product, p->e->tiles, p->e->table, u1, u2), share));
            continue;
        }
        float u1[BLOCK];
        mcs_pcg32_fill_n(p->rng, n, u1);
        float u2[BLOCK];
        mcs_pcg32_fill_n(p->rng, n, u2);
        float wx[BLOCK], wy[BLOCK], wz[BLOCK], pdf[BLOCK];
        uint32_t col[BLOCK], row[BLOCK];
        mcs_product_sample_n(product, p->e->tiles, p->e->table, n, u1, u2, wx, wy, wz, pdf, col, row);
        for (uint32_t i = 0; i < n; i++) {
            mcs_texel l;
            l.w = vec(wx[i], wy[i], wz[i]);
            l.pdf = pdf[i];
            l.col = col[i];
            l.row = row[i];
            sum = add(sum, product_value(p, l, share));
        }
    }
    return sum;
}

/* Of a product that is prepared for this point. Where the strategy learns, the light is dimmed to what its region sees.
 */
static vec3 sample_prepared(const lit_point *p, uint32_t lights) {
    union {
        mcs_product p;
        char room[MCS_PRODUCT_BYTES(TILES)];
    } here;
    const mcs_reflection r = reflection_of(p->x);
    const mcs_region *g = p->l ? p->l->list[p->region].known : NULL;
    if (mcs_product_build(&here.p, sizeof here, p->e->tiles, p->e->table, &r, g) != MCS_OK) return vec(0, 0, 0);
    return sample_product(p, &here.p, lights, 0);
}

/* The other half of what is paired with the table of a region. */
static vec3 sample_brdf_beside(const lit_point *p, const mcs_product *table) {
    const bounce b = draw_bounce(p);
    if (!(b.pdf > 0)) return vec(0, 0, 0);
    const mcs_texel l = mcs_product_texel(table, p->e->tiles, p->e->table, mcs_to_world(&p->x->frame, b.wi));
    if (!light_reaches(p, l)) return vec(0, 0, 0);
    const float share = p->x->m->share;
    return scale(mcs_mis_balance(share * b.pdf, l.pdf) / share, mul(b.weight, radiance_at(p->e, l.col, l.row)));
}

static vec3 sample_region(lit_point *p, uint32_t lights) {
    const mcs_product *table = p->l->list[p->region].table;
    vec3 sum = sample_product(p, table, lights, p->x->m->share);
    for (uint32_t i = 0; i < lights; i++)
        if (brdf_is_due(p)) sum = add(sum, sample_brdf_beside(p, table));
    return sum;
}

/* ---- all strategies ---- */

/* The mean of so many estimates. */
static vec3 direct(lit_point *p, strategy how, uint32_t lights) {
    vec3 sum = {0, 0, 0};
    p->drawn += lights;
    if (how == PRODUCT || how == LEARNED) return scale(1 / (float)lights, sample_prepared(p, lights));
    if (how == REGION) return scale(1 / (float)lights, sample_region(p, lights));
    for (uint32_t i = 0; i < lights; i++) {
        switch (how) {
        case BRDF: sum = add(sum, sample_brdf(p, 0)); break;
        case ENVIRONMENT: sum = add(sum, sample_environment(p, 0)); break;
        case MIS:
            if (brdf_is_due(p)) sum = add(sum, sample_brdf(p, 1));
            sum = add(sum, sample_environment(p, 1));
            break;
        default: sum = add(sum, sample_hemisphere(p, how == COSINE));
        }
    }
    return scale(1 / (float)lights, sum);
}

#endif
