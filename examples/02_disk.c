/* Points on a disk of radius R: the polar map and Shirley and Chiu's concentric map (less distortion, keeps strata
 * compact). Both have density 1/(pi R^2) per area. The integral of x^2 over the disk is pi R^4 / 4. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

static int report(const char *name, const mcs_stat *s, double exact) {
    printf("%-12s %.5f +- %.5f, exact %.5f\n", name, s->mean, mcs_stat_error(s), exact);
    return !(fabs(s->mean - exact) <= 5 * mcs_stat_error(s));
}

int main(void) {
    const float R = 2;
    const double exact = 3.14159265358979 * R * R * R * R / 4;
    mcs_pcg32 rng = mcs_pcg32_for(2, 1, 0);
    mcs_stat polar = {0, 0, 0};
    mcs_stat concentric = {0, 0, 0};
    int wrong = 0;

    for (int i = 0; i < 1000000; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_sample2 p = mcs_disk_sample(R, u1, u2);
        const mcs_sample2 c = mcs_concentric_sample(R, u1, u2);
        mcs_stat_add(&polar, p.pdf > 0 ? p.x * p.x / p.pdf : 0);
        mcs_stat_add(&concentric, c.pdf > 0 ? c.x * c.x / c.pdf : 0);
    }
    wrong |= report("polar", &polar, exact);
    wrong |= report("concentric", &concentric, exact);
    return wrong;
}
