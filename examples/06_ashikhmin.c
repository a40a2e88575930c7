/* Ashikhmin and Shirley's anisotropic Phong lobe. The exponent at azimuth phi is nu cos^2 phi + nv sin^2 phi (nu and nv
 * not squared): with it the density of half-vectors integrates to 1, checked here with uniform directions. Then the
 * albedo from a slant, by BRDF sampling and by cosine sampling. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

static int report(const char *name, double got, double error, double want) {
    printf("%-24s %.5f +- %.5f, expected %.5f\n", name, got, error, want);
    return !(fabs(got - want) <= 5 * error);
}

int main(void) {
    const mcs_ashikhmin m = mcs_ashikhmin_make(5, 80);
    const mcs_vec3 wo = {0, 0.6f, 0.8f};
    mcs_pcg32 rng = mcs_pcg32_for(6, 1, 0);
    mcs_stat mass = {0, 0, 0};
    mcs_stat brdf = {0, 0, 0};
    mcs_stat cosine = {0, 0, 0};
    int wrong = 0;

    for (int i = 0; i < 1000000; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_dir h = mcs_hemisphere_sample(u1, u2);
        const mcs_dir d = mcs_cosine_sample(u1, u2);
        mcs_stat_add(&mass, h.pdf > 0 ? mcs_ashikhmin_h_pdf(&m, h.w) / h.pdf : 0);
        mcs_stat_add(&brdf, mcs_ashikhmin_sample(&m, wo, u1, u2).weight);
        mcs_stat_add(&cosine, d.pdf > 0 ? mcs_ashikhmin_eval(&m, wo, d.w) * d.w.z / d.pdf : 0);
    }
    printf("albedo, cosine-sampled   %.5f +- %.5f\n", cosine.mean, mcs_stat_error(&cosine));
    wrong |=
        report("albedo, BRDF-sampled", brdf.mean, hypot(mcs_stat_error(&brdf), mcs_stat_error(&cosine)), cosine.mean);
    wrong |= report("integral of the density", mass.mean, mcs_stat_error(&mass), 1);
    return wrong;
}
