/* render_material.h - the materials of render.c: a matte base, a lobe, or both; or glass. */
#ifndef RENDER_MATERIAL_H
#define RENDER_MATERIAL_H
#include "render_base.h"

typedef enum { MATTE, PHONG, WARD, GGX_VISIBLE, GGX_BOUNDED, ASHIKHMIN, GLASS, FROSTED_GLASS } lobe_kind;

typedef struct {
    lobe_kind kind;
    union { /* prepared once by the _make functions, then only read */
        mcs_phong phong;
        mcs_ward ward;
        mcs_ggx ggx;
        mcs_ashikhmin ashikhmin;
    } lobe;
    vec3 base;     /* albedo of the matte base */
    vec3 specular; /* reflectance of the lobe, for microfacets at normal incidence */
    float p_lobe;  /* probability that BRDF sampling takes the lobe: 0 matte, 1 no base */
    float share;   /* BRDF samples of MIS for each light sample: few where the lobe is so wide that all is found */
    float eta;     /* of glass: its index of refraction; 0 where light does not pass */

    float alpha_x, alpha_y; /* as product sampling is told */
    mcs_profile profile;
} material;

static material material_make(lobe_kind kind, float p_lobe, vec3 base, vec3 specular, float shape_x, float shape_y) {
    material m;
    memset(&m, 0, sizeof m);
    m.kind = kind;
    m.p_lobe = p_lobe;
    m.base = base;
    m.specular = specular;
    m.share = kind == MATTE ? 0.125f : 1;
    m.alpha_x = shape_x;
    m.alpha_y = shape_y;
    m.profile = kind == PHONG ? MCS_PROFILE_PHONG : MCS_PROFILE_GGX;
    if (kind == WARD) m.profile = MCS_PROFILE_GAUSS;
    /* The width about the mirror direction is half that of a half-vector. */
    if (kind == PHONG) m.alpha_x = m.alpha_y = sqrtf(0.5f / (shape_x + 2));
    if (kind == ASHIKHMIN) {
        m.profile = MCS_PROFILE_ASHIKHMIN;
        m.alpha_x = sqrtf(2 / (shape_x + 2));
        m.alpha_y = sqrtf(2 / (shape_y + 2));
    }
    if (kind == PHONG) m.lobe.phong = mcs_phong_make(shape_x);
    if (kind == WARD) m.lobe.ward = mcs_ward_make(shape_x, shape_y, MCS_WARD_GMD);
    if (kind == GGX_VISIBLE || kind == GGX_BOUNDED) m.lobe.ggx = mcs_ggx_make(shape_x, shape_y);
    if (kind == ASHIKHMIN) m.lobe.ashikhmin = mcs_ashikhmin_make(shape_x, shape_y);
    return m;
}

static material glass_make(float eta, float alpha) {
    material m = material_make(alpha > 0 ? FROSTED_GLASS : GLASS, 1, black, black, alpha, alpha);
    m.eta = eta;
    if (alpha > 0) m.lobe.ggx = mcs_ggx_make(alpha, alpha);
    return m;
}

static mcs_brdf lobe_sample(const material *m, vec3 wo, float u1, float u2) {
    switch (m->kind) {
    case PHONG: return mcs_phong_sample(&m->lobe.phong, wo, u1, u2);
    case WARD: return mcs_ward_sample(&m->lobe.ward, wo, u1, u2);
    case GGX_VISIBLE: return mcs_ggx_vndf_sample(&m->lobe.ggx, wo, u1, u2);
    case GGX_BOUNDED: return mcs_ggx_bounded_sample(&m->lobe.ggx, wo, u1, u2);
    default: return mcs_ashikhmin_sample(&m->lobe.ashikhmin, wo, u1, u2);
    }
}

static float lobe_pdf(const material *m, vec3 wo, vec3 wi) {
    switch (m->kind) {
    case PHONG: return mcs_phong_pdf(&m->lobe.phong, wo, wi);
    case WARD: return mcs_ward_pdf(&m->lobe.ward, wo, wi);
    case GGX_VISIBLE: return mcs_ggx_vndf_pdf(&m->lobe.ggx, wo, wi);
    case GGX_BOUNDED: return mcs_ggx_bounded_pdf(&m->lobe.ggx, wo, wi);
    default: return mcs_ashikhmin_pdf(&m->lobe.ashikhmin, wo, wi);
    }
}

static float lobe_eval(const material *m, vec3 wo, vec3 wi) {
    switch (m->kind) {
    case PHONG: return mcs_phong_eval(&m->lobe.phong, wo, wi);
    case WARD: return mcs_ward_eval(&m->lobe.ward, wo, wi);
    case GGX_VISIBLE:
    case GGX_BOUNDED: return mcs_ggx_eval(&m->lobe.ggx, wo, wi);
    default: return mcs_ashikhmin_eval(&m->lobe.ashikhmin, wo, wi);
    }
}

/* Fresnel's factor, which the lobes of mcsample.h leave to the caller. Phong has no half-vector and a constant
 * reflectance. */
static vec3 fresnel(const material *m, vec3 wo, vec3 wi) {
    const float cosine = mcs_cos_d(wo, wi);
    if (m->kind == PHONG) return m->specular;
    return vec(mcs_schlick(m->specular.x, cosine), mcs_schlick(m->specular.y, cosine),
               mcs_schlick(m->specular.z, cosine));
}

/* f cos(theta_wi) */
static vec3 material_eval(const material *m, vec3 wo, vec3 wi) {
    vec3 f = black;
    if (!(wi.z > 0 && wo.z > 0)) return f;
    if (m->p_lobe < 1) f = scale(1 / PI, m->base);
    if (m->p_lobe > 0) f = add(f, scale(lobe_eval(m, wo, wi), fresnel(m, wo, wi)));
    return scale(wi.z, f);
}

static float material_pdf(const material *m, vec3 wo, vec3 wi) {
    if (m->p_lobe <= 0) return mcs_cosine_pdf(wi);
    if (m->p_lobe >= 1) return lobe_pdf(m, wo, wi);
    return mcs_mix_pdf(m->p_lobe, lobe_pdf(m, wo, wi), mcs_cosine_pdf(wi));
}

typedef struct {
    vec3 wi;
    float pdf;   /* 0: the sample is lost; it still counts, with the value 0 */
    vec3 weight; /* f cos / pdf */
} bounce;

static bounce material_sample(const material *m, vec3 wo, float u_choice, float u1, float u2) {
    bounce b = {{0, 0, 1}, 0, {0, 0, 0}};
    if (u_choice < m->p_lobe) {
        const mcs_brdf drawn = lobe_sample(m, wo, u1, u2);
        b.wi = drawn.wi;
        b.pdf = drawn.pdf;
        /* The weight is in closed form, no quotient of f and pdf. */
        if (b.pdf > 0 && m->p_lobe >= 1) b.weight = scale(drawn.weight, fresnel(m, wo, b.wi));
    } else {
        const mcs_dir drawn = mcs_cosine_sample(u1, u2);
        b.wi = drawn.w;
        b.pdf = drawn.pdf;
        if (m->p_lobe <= 0) b.weight = m->base;
    }
    if (m->p_lobe > 0 && m->p_lobe < 1) {
        b.pdf = material_pdf(m, wo, b.wi);
        if (b.pdf > 0) b.weight = scale(1 / b.pdf, material_eval(m, wo, b.wi));
    }
    return b;
}

/* Where a path from the camera goes on at glass, on either side of the surface. Smooth glass reflects to one direction
 * and refracts to one, each drawn with the probability with which light takes it. */
static bounce glass_sample(const material *m, vec3 wo, float u_choice, float u1, float u2) {
    const vec3 normal = {0, 0, 1};
    bounce b = {{0, 0, 1}, 1, {1, 1, 1}};
    if (m->kind == FROSTED_GLASS) {
        const mcs_brdf drawn = mcs_ggx_glass_sample(&m->lobe.ggx, m->eta, wo, u1, u2, u_choice);
        b.wi = drawn.wi;
        b.pdf = drawn.pdf;
        b.weight = vec(drawn.weight, drawn.weight, drawn.weight);
    } else if (u_choice < mcs_fresnel_dielectric(wo.z, m->eta)) {
        b.wi = mcs_reflect(wo, normal);
    } else {
        b.wi = mcs_refract(wo, normal, m->eta);
    }
    /* Radiance is per solid angle, which refraction changes by the square of the index. */
    const float squeeze = wo.z > 0 ? 1 / (m->eta * m->eta) : m->eta * m->eta;
    if (b.wi.z * wo.z < 0) b.weight = scale(squeeze, b.weight);
    return b;
}

#endif
