/* Phong: the lobe ((n+1)/(2 pi)) cos^n about the mirror direction. The albedo is the integral of f cos over the
 * hemisphere, so the mean of the weight f cos / pdf. Seen from straight above it is exactly 1; seen at a slant part of
 * the lobe dips under the surface: such a sample has pdf 0 and weight 0 and still counts. The slanted albedo is checked
 * against cosine sampling. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

static int report(const char *name, double got, double error, double want) {
    printf("%-28s %.5f +- %.5f, expected %.5f\n", name, got, error, want);
    return !(fabs(got - want) <= 5 * error);
}

int main(void) {
    const mcs_phong m = mcs_phong_make(50);
    const mcs_vec3 above = {0, 0, 1};
    const mcs_vec3 slant = {0.8f, 0, 0.6f};
    mcs_pcg32 rng = mcs_pcg32_for(3, 1, 0);
    mcs_stat top = {0, 0, 0};
    mcs_stat lobe = {0, 0, 0};
    mcs_stat cosine = {0, 0, 0};
    int wrong = 0;

    for (int i = 0; i < 1000000; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_dir d = mcs_cosine_sample(u1, u2);
        mcs_stat_add(&top, mcs_phong_sample(&m, above, u1, u2).weight);
        mcs_stat_add(&lobe, mcs_phong_sample(&m, slant, u1, u2).weight);
        mcs_stat_add(&cosine, d.pdf > 0 ? mcs_phong_eval(&m, slant, d.w) * d.w.z / d.pdf : 0);
    }
    wrong |= report("albedo from above", top.mean, mcs_stat_error(&top), 1);
    wrong |=
        report("albedo at 53 degrees", lobe.mean, hypot(mcs_stat_error(&lobe), mcs_stat_error(&cosine)), cosine.mean);
    return wrong;
}
