/* Arrays: the _n forms take one array per coordinate, any n and any alignment, and use the widest vectors this
 * processor has. An output that is not wanted is NULL; an output may be the input array. Here: cosine-distributed
 * directions, mean z = 2/3. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

enum { N = 1000, ROUNDS = 1000 };

int main(void) {
    static float u1[N], u2[N], z[N];
    const double exact = 2.0 / 3;
    mcs_pcg32 rng = mcs_pcg32_for(10, 1, 0);
    mcs_stat s = {0, 0, 0};

    for (int round = 0; round < ROUNDS; round++) {
        mcs_pcg32_fill_n(&rng, N, u1);
        mcs_pcg32_fill_n(&rng, N, u2);
        mcs_cosine_sample_n(N, u1, u2, NULL, NULL, z, NULL);
        for (int i = 0; i < N; i++) mcs_stat_add(&s, z[i]);
    }
    printf("mean z of %d directions: %.5f +- %.5f, exact %.5f\n", N * ROUNDS, s.mean, mcs_stat_error(&s), exact);
    return !(fabs(s.mean - exact) <= 5 * mcs_stat_error(&s));
}
