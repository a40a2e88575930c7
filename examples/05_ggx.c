/* GGX, anisotropic, three ways: half-vectors by the full distribution, by the visible normals, and by the bounded
 * visible normals. All three estimate one albedo; at a slant the visible normals lose far fewer samples and have the
 * lower error. Known answer: the visible microfacets project to exactly the surface, the integral of G1(wo) D(h) max(0,
 * wo.h) being wo.z. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

static int report(const char *name, const mcs_stat *s, double want, double want_error) {
    const double error = mcs_stat_error(s);
    printf("%-26s %.5f +- %.5f, expected %.5f\n", name, s->mean, error, want);
    return !(fabs(s->mean - want) <= 5 * hypot(error, want_error));
}

int main(void) {
    const mcs_ggx m = mcs_ggx_make(0.2f, 0.5f);
    const mcs_vec3 wo = {0.8f, 0.36f, 0.48f};
    const float g1 = mcs_ggx_g1(&m, wo);
    mcs_pcg32 rng = mcs_pcg32_for(5, 1, 0);
    mcs_stat area = {0, 0, 0};
    mcs_stat full = {0, 0, 0};
    mcs_stat visible = {0, 0, 0};
    mcs_stat bounded = {0, 0, 0};
    int wrong = 0;

    for (int i = 0; i < 1000000; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_dir h = mcs_ggx_h_sample(&m, u1, u2); /* its pdf is D(h) h.z */
        const float cos_d = wo.x * h.w.x + wo.y * h.w.y + wo.z * h.w.z;
        mcs_stat_add(&area, h.pdf > 0 && cos_d > 0 ? g1 * cos_d * mcs_ggx_d(&m, h.w) / h.pdf : 0);
        mcs_stat_add(&full, mcs_ggx_sample(&m, wo, u1, u2).weight);
        mcs_stat_add(&visible, mcs_ggx_vndf_sample(&m, wo, u1, u2).weight);
        mcs_stat_add(&bounded, mcs_ggx_bounded_sample(&m, wo, u1, u2).weight);
    }
    wrong |= report("projected visible area", &area, wo.z, 0);
    wrong |= report("albedo, visible normals", &visible, full.mean, mcs_stat_error(&full));
    wrong |= report("albedo, bounded", &bounded, full.mean, mcs_stat_error(&full));
    wrong |= report("albedo, full distribution", &full, visible.mean, mcs_stat_error(&visible));
    return wrong;
}
