/* Sampling any density by numeric inversion: hand over a function, get a table that follows it, in memory of your own.
 * Here g(x) = exp(-20 (x - 0.3)^2) on [0,1]; the mean of x g(x) / pdf is the integral of x g(x), however coarse the
 * table is. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static float bump(float x, void *ctx) {
    (void)ctx;
    return expf(-20 * (x - 0.3f) * (x - 0.3f));
}

int main(void) {
    /* Integral of x g = 0.3 (integral of g) + (exp(-20 0.3^2) - exp(-20 0.7^2)) / 40, integral of g by the error
     * function. */
    const double width = sqrt(20.0);
    const double mass = sqrt(3.14159265358979) / (2 * width) * (erf(0.7 * width) + erf(0.3 * width));
    const double exact = 0.3 * mass + (exp(-1.8) - exp(-9.8)) / 40;
    const uint32_t cells = 64;
    const size_t bytes = mcs_pwc_bytes(cells);
    mcs_pwc *table = (mcs_pwc *)malloc(bytes);
    mcs_pcg32 rng = mcs_pcg32_for(7, 1, 0);
    mcs_stat s = {0, 0, 0};

    if (!table || mcs_pwc_build_fn(table, bytes, bump, NULL, cells) != MCS_OK) {
        puts("the table could not be built");
        return 1;
    }
    for (int i = 0; i < 1000000; i++) {
        mcs_cell c = mcs_pwc_sample(table, mcs_pcg32_float(&rng));
        mcs_stat_add(&s, c.pdf > 0 ? c.x * bump(c.x, NULL) / c.pdf : 0);
    }
    free(table);
    printf("integral of x exp(-20 (x - 0.3)^2): %.6f +- %.6f, exact %.6f\n", s.mean, mcs_stat_error(&s), exact);
    return !(fabs(s.mean - exact) <= 5 * mcs_stat_error(&s));
}
