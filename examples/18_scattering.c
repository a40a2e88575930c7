/* A medium without end: a way to the next collision, there an end or a turn. Light starts along +z; there are `rate`
 * collisions on a unit of length, a part `albedo` of them scatters, and g is the mean cosine of Henyey and Greenstein.
 * Known answers: after n turns the mean cosine to the start is g^n; the mean depth of absorption is
 * 1 / (rate (1 - albedo g)). */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

enum { TURNS = 6, PATHS = 200000 };

static const float rate = 2, albedo = 0.9f, g = 0.7f;
static mcs_stat depth, cosine[TURNS + 1];

static void trace(mcs_pcg32 *rng) {
    mcs_vec3 along = {0, 0, 1};
    double z = 0;
    for (int turns = 0;; turns++) {
        if (turns <= TURNS) mcs_stat_add(&cosine[turns], along.z);
        const mcs_sample1 way = mcs_exponential_sample(rate, mcs_pcg32_float(rng));
        if (!(way.pdf > 0)) break;
        z += way.x * along.z;
        if (!(mcs_pcg32_float(rng) < albedo)) break;
        const float u1 = mcs_pcg32_float(rng);
        const float u2 = mcs_pcg32_float(rng);
        const mcs_dir d = mcs_henyey_greenstein_sample(g, u1, u2);
        if (!(d.pdf > 0)) break;
        const mcs_frame frame = mcs_frame_make(along); /* its +z is where the light was going: -wo, not wo */
        along = mcs_to_world(&frame, d.w);             /* the density is the phase function: the weight is 1 */
    }
    mcs_stat_add(&depth, z);
}

static int report(const char *what, int turns, const mcs_stat *s, double exact) {
    printf("%s %d: %.5f +- %.5f, exact %.5f\n", what, turns, s->mean, mcs_stat_error(s), exact);
    return !(fabs(s->mean - exact) <= 5 * mcs_stat_error(s));
}

int main(void) {
    mcs_pcg32 rng = mcs_pcg32_for(4, 1, 0);
    int wrong = 0;

    for (int i = 0; i < PATHS; i++) trace(&rng);
    for (int n = 1; n <= TURNS; n++) wrong |= report("mean cosine after turn", n, &cosine[n], pow(g, n));
    wrong |= report("mean depth, paths", PATHS, &depth, 1 / (rate * (1 - (double)albedo * g)));
    return wrong;
}
