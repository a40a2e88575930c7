/* Multiple importance sampling: a matte surface under a dim sky and a small bright sun at the zenith. Cosine sampling
 * rarely hits the sun; sampling the sun's cone never sees the sky. One sample of each, weighted by the power heuristic,
 * has both. Irradiance / pi, exactly: sky (1 - s) + sun s with s = sin^2 of the sun's radius = k (2 - k), k = 1 -
 * cos(radius). */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

static const float sky = 0.5f, sun = 5000, k = 1e-4f; /* k: the sun's radius is 0.8 degrees */

/* Radiance times cos / pi. The cone's density is zero outside the sun and so tells where it is. */
static float integrand(mcs_vec3 w) { return (mcs_cone_pdf(k, w) > 0 ? sun : sky) * mcs_cosine_pdf(w); }

int main(void) {
    const double s = (double)k * (2 - (double)k);
    const double exact = sky * (1 - s) + sun * s;
    mcs_pcg32 rng = mcs_pcg32_for(9, 1, 0);
    mcs_stat mis = {0, 0, 0};
    mcs_stat cosine = {0, 0, 0};

    for (int i = 0; i < 1000000; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const float u3 = mcs_pcg32_float(&rng);
        const float u4 = mcs_pcg32_float(&rng);
        mcs_dir a = mcs_cosine_sample(u1, u2);
        mcs_dir b = mcs_cone_sample(k, u3, u4);
        float both = 0;
        if (a.pdf > 0) both += integrand(a.w) / a.pdf * mcs_mis_power(a.pdf, mcs_cone_pdf(k, a.w));
        if (b.pdf > 0) both += integrand(b.w) / b.pdf * mcs_mis_power(b.pdf, mcs_cosine_pdf(b.w));
        mcs_stat_add(&mis, both);
        mcs_stat_add(&cosine, a.pdf > 0 ? integrand(a.w) / a.pdf : 0);
    }
    printf("cosine alone  %.5f +- %.5f, exact %.5f\n", cosine.mean, mcs_stat_error(&cosine), exact);
    printf("both, MIS     %.5f +- %.5f, exact %.5f\n", mis.mean, mcs_stat_error(&mis), exact);
    return !(fabs(mis.mean - exact) <= 5 * mcs_stat_error(&mis)) ||
           !(fabs(cosine.mean - exact) <= 5 * mcs_stat_error(&cosine));
}
