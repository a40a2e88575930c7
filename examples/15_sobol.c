/* Well-spread points, pixel by pixel: a pixel has a seed, a sample an index, and every number that a path asks for its
 * own dimension. The samples of a pixel depend on each other, so its error cannot be told from them; pixels do not, so
 * the error of their mean can. Known answer: x + y over the pixel times the reflection of a sky 1 + cos, so 1 + 2/3. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

enum { PIXELS = 4096, SAMPLES = 64 /* a power of two */ };

/* A point (x, y) of a pixel that shows a white matte surface of brightness x + y, and one direction of its light. */
static double value(float x, float y, float u1, float u2) {
    const mcs_dir d = mcs_cosine_sample(u1, u2);
    const double pi = 3.14159265358979;
    return d.pdf > 0 ? (x + y) / pi * (1 + d.w.z) * d.w.z / d.pdf : 0;
}

static double pixel_sobol(uint32_t pixel) {
    const uint32_t seed = mcs_hash(pixel, 15);
    double sum = 0;
    for (uint32_t i = 0; i < SAMPLES; i++)
        sum += value(mcs_sobol(i, 0, seed), mcs_sobol(i, 1, seed), mcs_sobol(i, 2, seed), mcs_sobol(i, 3, seed));
    return sum / SAMPLES;
}

static double pixel_independent(uint32_t pixel) {
    double sum = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        mcs_pcg32 rng = mcs_pcg32_for(15, pixel, i);
        float u[4];
        mcs_pcg32_fill_n(&rng, 4, u);
        sum += value(u[0], u[1], u[2], u[3]);
    }
    return sum / SAMPLES;
}

int main(void) {
    const double exact = 1 + 2.0 / 3;
    mcs_stat sobol = {0, 0, 0};
    mcs_stat independent = {0, 0, 0};

    for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
        mcs_stat_add(&sobol, pixel_sobol(pixel));
        mcs_stat_add(&independent, pixel_independent(pixel));
    }
    printf("independent  %.6f +- %.6f, a pixel +- %.4f\n", independent.mean, mcs_stat_error(&independent),
           sqrt(mcs_stat_variance(&independent)));
    printf("Sobol        %.6f +- %.6f, a pixel +- %.4f, exact %.6f\n", sobol.mean, mcs_stat_error(&sobol),
           sqrt(mcs_stat_variance(&sobol)), exact);
    return !(fabs(independent.mean - exact) <= 5 * mcs_stat_error(&independent)) ||
           !(fabs(sobol.mean - exact) <= 5 * mcs_stat_error(&sobol)) ||
           !(mcs_stat_error(&sobol) < mcs_stat_error(&independent) / 4);
}
