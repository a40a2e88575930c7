/* A thousand lights, one shadow ray: a reservoir sees some lights, drawn evenly, and keeps one in proportion to what it
 * would give if nothing were in the way. Only that one is worth a shadow ray. A white matte surface with normal +z; a
 * wall hides the lights at one side. Known answer: the sum over all lights that it does not hide. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

enum { LIGHTS = 1000, CANDIDATES = 32, SAMPLES = 50000 };

/* Small enough to count as a point. */
typedef struct {
    mcs_vec3 towards; /* a unit vector */
    float distance, intensity;
} lamp;

static lamp lamps[LIGHTS];

/* What the surface reflects of it, if nothing is in the way. */
static float unshadowed(const lamp *l) {
    return l->intensity * mcs_cosine_pdf(l->towards) / (l->distance * l->distance); /* f cos is cos/pi */
}

/* Your shadow ray goes here. */
static int visible(const lamp *l) { return l->towards.x < 0.3f; }

static double sample_one(mcs_pcg32 *rng) {
    const lamp *l = &lamps[mcs_pcg32_next(rng) % LIGHTS]; /* even within 1000 / 2^32 */
    return visible(l) ? (double)LIGHTS * unshadowed(l) : 0;
}

static double sample_reservoir(mcs_pcg32 *rng) {
    const float p = 1.0f / LIGHTS; /* the probability with which a candidate is drawn */
    mcs_reservoir r = {0, 0, 0};
    for (int k = 0; k < CANDIDATES; k++) {
        const uint32_t i = mcs_pcg32_next(rng) % LIGHTS;
        mcs_reservoir_add(&r, i, unshadowed(&lamps[i]) / p, mcs_pcg32_float(rng));
    }
    if (!(r.total > 0)) return 0;
    const float target = unshadowed(&lamps[r.i]);
    return visible(&lamps[r.i]) ? (double)target * mcs_reservoir_weight(&r, target) : 0;
}

static int report(const char *name, const mcs_stat *s, double exact) {
    printf("%-17s %.4f +- %.4f, exact %.4f\n", name, s->mean, mcs_stat_error(s), exact);
    return !(fabs(s->mean - exact) <= 5 * mcs_stat_error(s));
}

int main(void) {
    mcs_pcg32 rng = mcs_pcg32_for(23, 1, 0);
    mcs_stat one = {0, 0, 0};
    mcs_stat reservoir = {0, 0, 0};
    double exact = 0;

    for (int i = 0; i < LIGHTS; i++) {
        float u[4];
        mcs_pcg32_fill_n(&rng, 4, u);
        const lamp l = {mcs_hemisphere_sample(u[0], u[1]).w, 1 + 9 * u[2], 1 / (0.01f + u[3])};
        lamps[i] = l;
        exact += visible(&l) ? unshadowed(&l) : 0;
    }
    for (int i = 0; i < SAMPLES; i++) {
        mcs_stat_add(&one, sample_one(&rng));
        mcs_stat_add(&reservoir, sample_reservoir(&rng));
    }
    return report("one light, evenly", &one, exact) | report("reservoir", &reservoir, exact) |
           !(mcs_stat_error(&reservoir) < mcs_stat_error(&one) / 3);
}
