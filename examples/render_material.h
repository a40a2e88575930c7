/* render_material.h - the materials of render.c: a matte base, a lobe, or both. */
#ifndef RENDER_MATERIAL_H
#define RENDER_MATERIAL_H
#include "render_base.h"

typedef enum { MATTE, PHONG, WARD, GGX_VISIBLE, GGX_BOUNDED, ASHIKHMIN } lobe_kind;

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
    float share; /* BRDF samples of MIS for each environment sample: few where the lobe is so wide that all is found */

    float alpha_x, alpha_y; /* as product sampling is told */
    mcs_profile profile;
} material;

static material material_make(lobe_kind kind, float p_lobe, vec3 base, vec3 specular, float a, float b) {
    material m;
    memset(&m, 0, sizeof m);
    m.kind = kind;
    m.p_lobe = p_lobe;
    m.base = base;
    m.specular = specular;
    m.share = kind == MATTE ? 0.125f : 1;
    m.alpha_x = a;
    m.alpha_y = b;
    m.profile = kind == PHONG ? MCS_PROFILE_PHONG : MCS_PROFILE_GGX;
    if (kind == WARD || kind == ASHIKHMIN) m.profile = MCS_PROFILE_GAUSS;
    if (kind == PHONG)
        m.alpha_x = m.alpha_y = sqrtf(0.5f / (a + 2)); /* about the mirror direction: half that of a half-vector */
    if (kind == ASHIKHMIN) {
        m.alpha_x = sqrtf(2 / (a + 2));
        m.alpha_y = sqrtf(2 / (b + 2));
    }
    if (kind == PHONG) m.lobe.phong = mcs_phong_make(a);
    if (kind == WARD) m.lobe.ward = mcs_ward_make(a, b, MCS_WARD_GMD);
    if (kind == GGX_VISIBLE || kind == GGX_BOUNDED) m.lobe.ggx = mcs_ggx_make(a, b);
    if (kind == ASHIKHMIN) m.lobe.ashikhmin = mcs_ashikhmin_make(a, b);
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
    const float c = mcs_cos_d(wo, wi);
    if (m->kind == PHONG) return m->specular;
    return vec(mcs_schlick(m->specular.x, c), mcs_schlick(m->specular.y, c), mcs_schlick(m->specular.z, c));
}

/* f cos(theta_wi) */
static vec3 material_eval(const material *m, vec3 wo, vec3 wi) {
    vec3 f = {0, 0, 0};
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
        mcs_brdf s = lobe_sample(m, wo, u1, u2);
        b.wi = s.wi;
        b.pdf = s.pdf;
        if (b.pdf > 0 && m->p_lobe >= 1) b.weight = scale(s.weight, fresnel(m, wo, s.wi)); /* closed form, no f / pdf */
    } else {
        const mcs_dir s = mcs_cosine_sample(u1, u2);
        b.wi = s.w;
        b.pdf = s.pdf;
        if (m->p_lobe <= 0) b.weight = m->base;
    }
    if (m->p_lobe > 0 && m->p_lobe < 1) {
        b.pdf = material_pdf(m, wo, b.wi);
        if (b.pdf > 0) b.weight = scale(1 / b.pdf, material_eval(m, wo, b.wi));
    }
    return b;
}

#endif
