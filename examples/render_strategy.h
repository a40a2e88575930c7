/* render_strategy.h - direct illumination in render.c: each strategy estimates the integral of f L V cos over the
 * hemisphere. */
#ifndef RENDER_STRATEGY_H
#define RENDER_STRATEGY_H
#include "render_light.h"
#include "render_options.h"
#include "render_scene.h"

/* With mis, one half of a multi-sample estimator with the power heuristic (Veach and Guibas, "Optimally combining
 * sampling techniques", 1995); without, an estimator by itself. Likewise the environment. */
static vec3 sample_brdf(const scene *s, const environment *e, const surface *x, int mis, mcs_pcg32 *rng) {
    const float u0 = mcs_pcg32_float(rng);
    const float u1 = mcs_pcg32_float(rng);
    const float u2 = mcs_pcg32_float(rng);
    bounce b = material_sample(x->m, x->wo, u0, u1, u2);
    const vec3 w = mcs_to_world(&x->frame, b.wi);
    if (!(b.pdf > 0 && visible(s, x->p, w, x->object))) return vec(0, 0, 0);
    mcs_texel l = mcs_env_texel(e->table, w);
    const vec3 value = mul(b.weight, radiance_at(e, l.col, l.row));
    return mis ? scale(mcs_mis_power(x->m->share * b.pdf, l.pdf) / x->m->share, value) : value;
}

static vec3 sample_environment(const scene *s, const environment *e, const surface *x, int mis, mcs_pcg32 *rng) {
    const float u1 = mcs_pcg32_float(rng);
    const float u2 = mcs_pcg32_float(rng);
    mcs_texel l = mcs_env_sample(e->table, u1, u2);
    const vec3 wi = mcs_to_local(&x->frame, l.w);
    if (!(l.pdf > 0 && wi.z > 0 && visible(s, x->p, l.w, x->object))) return vec(0, 0, 0);
    const vec3 value = scale(1 / l.pdf, mul(material_eval(x->m, x->wo, wi), radiance_at(e, l.col, l.row)));
    return mis ? scale(mcs_mis_power(l.pdf, x->m->share * material_pdf(x->m, x->wo, wi)), value) : value;
}

static vec3 sample_hemisphere(const scene *s, const environment *e, const surface *x, int cosine, mcs_pcg32 *rng) {
    const float u1 = mcs_pcg32_float(rng);
    const float u2 = mcs_pcg32_float(rng);
    const mcs_dir d = cosine ? mcs_cosine_sample(u1, u2) : mcs_hemisphere_sample(u1, u2);
    const vec3 w = mcs_to_world(&x->frame, d.w);
    if (!(d.pdf > 0 && visible(s, x->p, w, x->object))) return vec(0, 0, 0);
    mcs_texel l = mcs_env_texel(e->table, w);
    return scale(1 / d.pdf, mul(material_eval(x->m, x->wo, d.w), radiance_at(e, l.col, l.row)));
}

/* What product sampling is told of a surface; Fresnel's factor as the mirror direction has it. */
static mcs_reflection reflection_of(const surface *x, uint32_t draws) {
    const material *m = x->m;
    const float base = m->p_lobe < 1 ? luminance(m->base) : 0;
    float lobe = 0;
    if (m->p_lobe > 0) lobe = m->kind == PHONG ? luminance(m->specular) : mcs_schlick(luminance(m->specular), x->wo.z);
    mcs_reflection r;
    r.frame = x->frame;
    r.wo = x->wo;
    r.alpha_x = m->alpha_x;
    r.alpha_y = m->alpha_y;
    r.matte = base / (base + lobe);
    r.profile = m->profile;
    r.draws = draws;
    return r;
}

/* The value of a light sample: radiance times f cos over the density. */
static vec3 product_value(const scene *s, const environment *e, const surface *x, mcs_texel l) {
    const vec3 wi = mcs_to_local(&x->frame, l.w);
    if (!(l.pdf > 0 && wi.z > 0 && visible(s, x->p, l.w, x->object))) return vec(0, 0, 0);
    return scale(1 / l.pdf, mul(material_eval(x->m, x->wo, wi), radiance_at(e, l.col, l.row)));
}

/* A product that is prepared at the point, drawn from a block at a time. */
static vec3 sample_product(const scene *s, const environment *e, const surface *x, uint32_t lights, mcs_pcg32 *rng) {
    enum { BLOCK = 32 };
    union {
        mcs_product p;
        char room[MCS_PRODUCT_BYTES(TILES)];
    } point;
    const mcs_reflection r = reflection_of(x, lights);
    vec3 sum = {0, 0, 0};
    if (mcs_product_build(&point.p, sizeof point, e->tiles, e->table, &r, NULL) != MCS_OK) return sum;
    uint32_t n;
    for (; lights > 0; lights -= n) {
        n = lights < BLOCK ? lights : BLOCK;
        float u1[BLOCK];
        mcs_pcg32_fill_n(rng, n, u1);
        float u2[BLOCK];
        mcs_pcg32_fill_n(rng, n, u2);
        float wx[BLOCK], wy[BLOCK], wz[BLOCK], pdf[BLOCK];
        uint32_t col[BLOCK], row[BLOCK];
        mcs_product_sample_n(&point.p, e->tiles, e->table, n, u1, u2, wx, wy, wz, pdf, col, row);
        for (uint32_t i = 0; i < n; i++) {
            mcs_texel l;
            l.w = vec(wx[i], wy[i], wz[i]);
            l.pdf = pdf[i];
            l.col = col[i];
            l.row = row[i];
            sum = add(sum, product_value(s, e, x, l));
        }
    }
    return sum;
}

/* The mean of so many estimates; *drawn counts the light samples. */
static vec3 direct(const scene *s, const environment *e, const surface *x, strategy how, uint32_t lights,
                   mcs_pcg32 *rng, uint32_t *drawn) {
    vec3 sum = {0, 0, 0};
    *drawn += lights;
    if (how == PRODUCT) return scale(1 / (float)lights, sample_product(s, e, x, lights, rng));
    for (uint32_t i = 0; i < lights; i++) {
        switch (how) {
        case BRDF: sum = add(sum, sample_brdf(s, e, x, 0, rng)); break;
        case ENVIRONMENT: sum = add(sum, sample_environment(s, e, x, 0, rng)); break;
        case MIS:
            if (x->m->share == 1 || mcs_pcg32_float(rng) < x->m->share) {
                sum = add(sum, sample_brdf(s, e, x, 1, rng));
                ++*drawn;
            }
            sum = add(sum, sample_environment(s, e, x, 1, rng));
            break;
        default: sum = add(sum, sample_hemisphere(s, e, x, how == COSINE, rng));
        }
    }
    return scale(1 / (float)lights, sum);
}

#endif
