/* Products of environment, reflection and cosine: the variance of one sample over those of sampling the map, the BRDF
 * and both by MIS. All come from the same draws, a third from each of product, map and BRDF: their density is nowhere
 * far below any integrand, so that bright events count which the product hardly ever draws. MCS_TEST_VERBOSE=1 prints
 * it. MCS_TEST_MAPS: Radiance pictures, separated by spaces, that are looked at, too. A part of test_product.c. */
#ifndef MCST_PRODUCT_VARIANCE_H
#define MCST_PRODUCT_VARIANCE_H
#include "../examples/hdr.h"
#include "product_sampler.h"

enum { OF_PRODUCT, OF_MAP, OF_BRDF, KINDS };
/* What a direction gives, F, and its densities: of each kind, and as it was drawn. */
typedef struct {
    double F, q, p[KINDS];
} event;

/* 0: the draw is lost. */
static int draw_from(const sampler *d, int kind, float u1, float u2, mcs_vec3 *w) {
    const mcs_reflection *r = &d->s->r;
    const mcs_texel t = kind == OF_PRODUCT ? draw(d, u1, u2) : mcs_env_sample(env_of(d->m), u1, u2);
    *w = t.w;
    if (kind != OF_BRDF) return t.pdf > 0;
    *w = mcs_to_world(&r->frame, mcs_cosine_sample(u1, u2).w);
    if (r->matte >= 1) return 1;
    const mcs_ward gauss = mcs_ward_make(r->alpha_x, r->alpha_y, MCS_WARD_GMD);
    const mcs_phong phong = mcs_phong_make((float)d->s->power);
    const mcs_ashikhmin ashikhmin = mcs_ashikhmin_make((float)d->s->nu, (float)d->s->nv);
    const mcs_ggx ggx = mcs_ggx_make(r->alpha_x, r->alpha_y);
    const mcs_brdf b = r->profile == MCS_PROFILE_GAUSS       ? mcs_ward_sample(&gauss, r->wo, u1, u2)
                       : r->profile == MCS_PROFILE_PHONG     ? mcs_phong_sample(&phong, r->wo, u1, u2)
                       : r->profile == MCS_PROFILE_ASHIKHMIN ? mcs_ashikhmin_sample(&ashikhmin, r->wo, u1, u2)
                                                             : mcs_ggx_vndf_sample(&ggx, r->wo, u1, u2);
    *w = mcs_to_world(&r->frame, b.wi);
    return b.pdf > 0;
}
static event event_at(const sampler *d, mcs_vec3 w) {
    const double light = d->m->light[texel_number(d->m, w)];
    double visible;
    const double reflected = reflect(d->s, w, &visible);
    event e;
    e.F = light * reflected;
    e.p[OF_PRODUCT] = density(d, w);
    e.p[OF_MAP] = light / d->m->total;
    e.p[OF_BRDF] = d->s->r.matte >= 1 ? reflected : visible;
    e.q = (e.p[OF_PRODUCT] + e.p[OF_MAP] + e.p[OF_BRDF]) / KINDS;
    return e;
}

/* Of one sample of each kind, over the square of the mean. */
typedef struct {
    double of[KINDS], mis;
} variances;
/* The integrals of (F - mean p)^2 / p. What is lost differs from the mean by all of it. MIS is the balance heuristic
 * with one sample each of map and BRDF: times two for the same number of samples. */
static variances variance_of(const sampler *d, uint32_t count) {
    const uint32_t n = KINDS * count;
    event *e = (event *)memory(n * sizeof *e);
    double lost[KINDS] = {0, 0, 0};
    double mean = 0;
    double part[KINDS] = {0, 0, 0};
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t kind = i % KINDS;
        mcs_vec3 w;
        if (!draw_from(d, (int)kind, mcs_sobol(i / KINDS, 0, kind), mcs_sobol(i / KINDS, 1, kind), &w)) {
            lost[kind] += 1.0 / count;
            continue;
        }
        e[kept] = event_at(d, w);
        e[kept].q *= n;
        mean += e[kept].F / e[kept].q;
        for (int k = OF_MAP; k <= OF_BRDF && e[kept].F > 0; k++)
            part[k] += e[kept].F * e[kept].p[k] / (e[kept].p[OF_MAP] + e[kept].p[OF_BRDF]) / e[kept].q;
        kept++;
    }
    variances v = {{0, 0, 0}, 0};
    for (int k = 0; k < KINDS; k++) v.of[k] = lost[k];
    v.mis = 2 * lost[OF_BRDF] * part[OF_BRDF] * part[OF_BRDF] / (mean * mean);
    for (uint32_t i = 0; i < kept; i++) {
        const double both = e[i].p[OF_MAP] + e[i].p[OF_BRDF];
        for (int k = 0; k < KINDS; k++) {
            const double p = e[i].p[k];
            if (p > 0 || e[i].F > 0) v.of[k] += pow(e[i].F / mean - p, 2) / p / e[i].q;
            if (k != OF_PRODUCT && p > 0) v.mis += 2 * pow((e[i].F / both - part[k]) / mean, 2) * p / e[i].q;
        }
    }
    free(e);
    return v;
}

enum { ROWS = 17, TWELVE = 12 };
/* Rows of the table; half of the geometric means of MIS / product that own maps gave when this was written, and of the
 * worst of them: weights may be changed a little, but not lose a factor. */
static const struct {
    const char *name;
    mcs_profile profile;
    float alpha; /* 0: matte */
    double half, half_worst;
} table[ROWS] = {{"matte", MCS_PROFILE_GGX, 0, 144, 0},           {"GGX", MCS_PROFILE_GGX, 0.8f, 155, 0},
                 {"GGX", MCS_PROFILE_GGX, 0.5f, 149, 0},          {"GGX", MCS_PROFILE_GGX, 0.3f, 106, 0},
                 {"GGX", MCS_PROFILE_GGX, 0.2f, 60, 0},           {"GGX", MCS_PROFILE_GGX, 0.1f, 93, 0},
                 {"GGX", MCS_PROFILE_GGX, 0.05f, 19.4, 0},        {"GGX", MCS_PROFILE_GGX, 0.02f, 1.64, 0},
                 {"Gauss", MCS_PROFILE_GAUSS, 0.3f, 81, 6.9},     {"Gauss", MCS_PROFILE_GAUSS, 0.1f, 13.8, 1.6},
                 {"Gauss", MCS_PROFILE_GAUSS, 0.05f, 2.1, 0.056}, {"Phong", MCS_PROFILE_PHONG, 0.3f, 8.2, 1.2},
                 {"Phong", MCS_PROFILE_PHONG, 0.1f, 26, 2.5},     {"Phong", MCS_PROFILE_PHONG, 0.05f, 5.6, 0.28},
                 {"A.-S.", MCS_PROFILE_ASHIKHMIN, 0.3f, 120, 11}, {"A.-S.", MCS_PROFILE_ASHIKHMIN, 0.1f, 26, 3.4},
                 {"A.-S.", MCS_PROFILE_ASHIKHMIN, 0.05f, 3, 0.07}};

/* Sums of logarithms, then geometric means. */
typedef struct {
    double env, brdf, mis, worst;
    int n;
} ratios;

/* Normals spread over the sphere by the golden angle, the eye at cosines of 0.35 to 0.95. */
static void add_map(const scene *m, ratios *sum) {
    const uint32_t count = (uint32_t)(4096 * fmin(fmax(scale(), 1), 64)); /* fewer are too few for what is asked */
    for (int k = 0; k < ROWS * TWELVE; k++) {
        const int i = k % TWELVE;
        const double z = 1 - (2 * i + 1.0) / TWELVE;
        const double turn = 2 * pi * 0.381966 * i;
        const float alpha = table[k / TWELVE].alpha;
        const lobe l = {"", alpha > 0 ? alpha : 1, alpha > 0 ? alpha : 1, alpha > 0 ? 0 : 1, table[k / TWELVE].profile};
        const surface s = surface_make(vec(sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z),
                                       local_wo(0.35 + 0.6 * fmod(0.618034 * i, 1), 2.4 * i), l);
        sampler d = sampler_make(m, &s);
        const variances v = variance_of(&d, count);
        const double product = v.of[OF_PRODUCT];
        CHECK(product > 0 && product < INFINITY && v.mis > 0, "%s, alpha %g, normal %d: variances %g, %g", m->name,
              (double)alpha, i, product, v.mis);
        ratios *q = sum + k / TWELVE;
        q->env += log(v.of[OF_MAP] / product);
        q->brdf += log(v.of[OF_BRDF] / product);
        q->mis += log(v.mis / product);
        q->worst = q->n++ ? fmin(q->worst, v.mis / product) : v.mis / product;
        sampler_free(&d);
    }
}
static void finish(const char *what, ratios *sum) {
    mcst_note("    %s: variance per sample, geometric means over %d\n    %-8s %-6s %10s %10s %10s %10s\n", what,
              sum[0].n, "", "alpha", "env/prod", "BRDF/prod", "MIS/prod", "worst");
    for (int k = 0; k < ROWS; k++) {
        ratios *q = sum + k;
        q->env = exp(q->env / q->n);
        q->brdf = exp(q->brdf / q->n);
        q->mis = exp(q->mis / q->n);
        mcst_note("    %-8s %-6.3g %10.4g %10.4g %10.4g %10.3g\n", table[k].name, (double)table[k].alpha, q->env,
                  q->brdf, q->mis, q->worst);
    }
}

static void check_own_maps(void) {
    static const picture maps[] = {SMOOTH, SUN, ROOM};
    ratios sum[ROWS] = {{0, 0, 0, 0, 0}};
    for (int k = 0; k < 3; k++) {
        scene m = scene_make(maps[k], 128, 64, 16);
        add_map(&m, sum);
        scene_free(&m);
    }
    finish("own maps, 16 x 32 tiles", sum);
    CHECK(sum[0].env >= 293, "matte: environment / product %g", sum[0].env);
    for (int k = 0; k < ROWS; k++)
        CHECK(sum[k].mis >= table[k].half && sum[k].worst >= table[k].half_worst,
              "%s, alpha %g: MIS / product %g, at worst %g", table[k].name, (double)table[k].alpha, sum[k].mis,
              sum[k].worst);
}
static void check_captured_maps(const char *at) {
    ratios sum[ROWS] = {{0, 0, 0, 0, 0}};
    char name[1024];
    int used;
    for (; sscanf(at, "%1023s%n", name, &used) == 1; at += used) {
        hdr_picture p;
        CHECK(hdr_read(&p, name), "%s: %s", name, p.fault);
        if (!p.pixel) continue;
        float *light = (float *)memory((size_t)p.w * p.h * sizeof *light);
        for (size_t i = 0; i < (size_t)p.w * p.h; i++) {
            float c[3];
            hdr_color(&p, i, c);
            light[i] = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
        }
        free(p.pixel);
        scene m = scene_from(name, p.w, p.h, light, 16);
        add_map(&m, sum);
        scene_free(&m);
    }
    finish("captured maps, 16 x 32 tiles", sum);
    CHECK(sum[0].env >= 60, "matte: environment / product %g", sum[0].env);
    for (int k = 1; k <= 4; k++)
        CHECK(sum[k].mis >= 20, "alpha %g: MIS / product %g", (double)table[k].alpha, sum[k].mis);
}

static void test_variance(void) {
    const char *list = getenv("MCS_TEST_MAPS");
    mcst_group("product, variance");
    if (mcst_case("own maps")) check_own_maps();
    if (list && *list && mcst_case("captured maps")) check_captured_maps(list);
}
#endif
