/* The Monte Carlo estimator: the integral of f is the mean of f(x)/p(x) over samples x of density p.
 * Here f(x) = x^2 cos x on [-1,1] and p(x) = 3x^2/2, which follows most of f. The exact value is 4 cos 1 - 2 sin 1.
 * The standard error falls as 1/sqrt(N): an error four times lower costs 16 times the samples. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

int main(void) {
    const double exact = 4 * cos(1.0) - 2 * sin(1.0);
    mcs_pcg32 rng = mcs_pcg32_for(1, 1, 0);
    int wrong = 0;

    printf("%10s %10s %10s %12s %10s\n", "samples", "estimate", "exact", "std. error", "off by");
    for (int n = 1 << 8; n <= 1 << 20; n *= 16) {
        mcs_stat s = {0, 0, 0};
        for (int i = 0; i < n; i++) {
            mcs_sample1 x = mcs_evenpower_sample(2, mcs_pcg32_float(&rng));
            if (x.pdf > 0) mcs_stat_add(&s, x.x * x.x * cos(x.x) / x.pdf);
            else mcs_stat_add(&s, 0); /* density 0: worth nothing, but still counted */
        }
        printf("%10d %10.6f %10.6f %12.2e %10.1e\n", n, s.mean, exact, mcs_stat_error(&s), fabs(s.mean - exact));
        if (!(fabs(s.mean - exact) <= 5 * mcs_stat_error(&s))) wrong = 1;
    }
    return wrong;
}
