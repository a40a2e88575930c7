/* The materials of shadow.c: each a matte part and a lobe, with sampler, density and value of both together. */
#ifndef MCST_SHADOW_MATERIAL_H
#define MCST_SHADOW_MATERIAL_H
#include "mcsample.h"
#include <math.h>

typedef enum { LOBE_GGX, LOBE_WARD, LOBE_PHONG, LOBE_ASHIKHMIN } lobe_kind;

/* Reflectance 1, no Fresnel factor. */
typedef struct {
    const char *name;
    float matte; /* the weight of the matte part; the lobe has the rest */
    lobe_kind lobe;
    float a, b; /* alpha along x and y, or exponents */
} material;

static const material materials[] = {{"matte", 1, LOBE_GGX, 1, 1},
                                     {"GGX .5", 0, LOBE_GGX, 0.5f, 0.5f},
                                     {"GGX .2", 0, LOBE_GGX, 0.2f, 0.2f},
                                     {"GGX .1", 0, LOBE_GGX, 0.1f, 0.1f},
                                     {"GGX .05", 0, LOBE_GGX, 0.05f, 0.05f},
                                     {"GGX .02", 0, LOBE_GGX, 0.02f, 0.02f},
                                     {"Ward .2 .05", 0, LOBE_WARD, 0.2f, 0.05f},
                                     {"Phong 50", 0, LOBE_PHONG, 50, 50},
                                     {"Phong 500", 0, LOBE_PHONG, 500, 500},
                                     {"A.-S. 100 10", 0, LOBE_ASHIKHMIN, 100, 10},
                                     {"matte + GGX .1", 0.5f, LOBE_GGX, 0.1f, 0.1f}};
enum { MATERIALS = sizeof materials / sizeof *materials };

/* A material made ready. */
typedef struct {
    const material *m;
    mcs_ggx ggx; /* by the kind of lobe, one of these four */
    mcs_ward ward;
    mcs_phong phong;
    mcs_ashikhmin ashikhmin;
} coat;

static coat coat_make(const material *m) {
    coat c;
    memset(&c, 0, sizeof c);
    c.m = m;
    switch (m->lobe) {
    case LOBE_WARD: c.ward = mcs_ward_make(m->a, m->b, MCS_WARD_GMD); break;
    case LOBE_PHONG: c.phong = mcs_phong_make(m->a); break;
    case LOBE_ASHIKHMIN: c.ashikhmin = mcs_ashikhmin_make(m->a, m->b); break;
    default: c.ggx = mcs_ggx_make(m->a, m->b);
    }
    return c;
}

static float lobe_pdf(const coat *c, mcs_vec3 wo, mcs_vec3 wi) {
    switch (c->m->lobe) {
    case LOBE_WARD: return mcs_ward_pdf(&c->ward, wo, wi);
    case LOBE_PHONG: return mcs_phong_pdf(&c->phong, wo, wi);
    case LOBE_ASHIKHMIN: return mcs_ashikhmin_pdf(&c->ashikhmin, wo, wi);
    default: return mcs_ggx_bounded_pdf(&c->ggx, wo, wi);
    }
}
static float lobe_value(const coat *c, mcs_vec3 wo, mcs_vec3 wi) {
    switch (c->m->lobe) {
    case LOBE_WARD: return mcs_ward_eval(&c->ward, wo, wi);
    case LOBE_PHONG: return mcs_phong_eval(&c->phong, wo, wi);
    case LOBE_ASHIKHMIN: return mcs_ashikhmin_eval(&c->ashikhmin, wo, wi);
    default: return mcs_ggx_eval(&c->ggx, wo, wi);
    }
}
static mcs_brdf lobe_sample(const coat *c, mcs_vec3 wo, float u1, float u2) {
    switch (c->m->lobe) {
    case LOBE_WARD: return mcs_ward_sample(&c->ward, wo, u1, u2);
    case LOBE_PHONG: return mcs_phong_sample(&c->phong, wo, u1, u2);
    case LOBE_ASHIKHMIN: return mcs_ashikhmin_sample(&c->ashikhmin, wo, u1, u2);
    default: return mcs_ggx_bounded_sample(&c->ggx, wo, u1, u2);
    }
}

/* f cos of both parts. */
static float coat_value(const coat *c, mcs_vec3 wo, mcs_vec3 wi) {
    const float matte = c->m->matte;
    if (!(wi.z > 0)) return 0;
    const float lobe = matte < 1 ? lobe_value(c, wo, wi) : 0;
    return (matte * 0.318309886f + (1 - matte) * lobe) * wi.z;
}
static float coat_pdf(const coat *c, mcs_vec3 wo, mcs_vec3 wi) {
    const float matte = c->m->matte;
    const float lobe = matte < 1 ? lobe_pdf(c, wo, wi) : 0;
    return matte > 0 ? mcs_mix_pdf(matte, mcs_cosine_pdf(wi), lobe) : lobe;
}
/* Draws from one part or the other; the density is that of both together, 0 where the sample is lost. */
static mcs_dir coat_sample(const coat *c, mcs_vec3 wo, float u1, float u2) {
    const float matte = c->m->matte;
    mcs_dir d;
    if (u1 < matte) {
        d = mcs_cosine_sample(u1 / matte, u2);
        d.pdf = matte < 1 ? coat_pdf(c, wo, d.w) : d.pdf;
        return d;
    }
    const mcs_brdf b = lobe_sample(c, wo, matte > 0 ? fminf((u1 - matte) / (1 - matte), 0.99999994f) : u1, u2);
    d.w = b.wi;
    d.pdf = b.pdf > 0 && matte > 0 ? coat_pdf(c, wo, b.wi) : b.pdf;
    return d;
}

/* What product sampling is told of it. */
static mcs_reflection coat_reflection(const coat *c, const mcs_frame *frame, mcs_vec3 wo) {
    const material *m = c->m;
    mcs_reflection r;
    r.frame = *frame;
    r.wo = wo;
    r.matte = m->matte;
    r.alpha_x = m->a;
    r.alpha_y = m->b;
    r.profile = MCS_PROFILE_GGX;
    if (m->lobe == LOBE_WARD) r.profile = MCS_PROFILE_GAUSS;
    if (m->lobe == LOBE_ASHIKHMIN) {
        r.profile = MCS_PROFILE_ASHIKHMIN;
        r.alpha_x = sqrtf(2 / (m->a + 2));
        r.alpha_y = sqrtf(2 / (m->b + 2));
    }
    if (m->lobe == LOBE_PHONG) {
        r.profile = MCS_PROFILE_PHONG;
        r.alpha_x = r.alpha_y = sqrtf(1 / (2 * m->a + 4));
    }
    return r;
}
static mcs_reflection coat_seen_from_above(const coat *c) {
    const mcs_vec3 up = {0, 0, 1};
    const mcs_frame frame = mcs_frame_make(up);
    return coat_reflection(c, &frame, up);
}
#endif
