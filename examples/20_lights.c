/* Many lights: draw one in proportion to its power, then a direction within it. The table leaves the rest of u, even
 * again, for the next choice. Known answer: a sphere that is seen whole, of radius r at distance d, lights a matte
 * surface by pi L (r/d)^2 cos, with the cosine of its centre; a white surface reflects that over pi. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LIGHTS = 10, SAMPLES = 500000 };

typedef struct {
    mcs_vec3 centre;
    float radius, radiance;
} sphere;

static const mcs_vec3 lit = {3, -2, 1}; /* a point of the surface, whose normal is +z */

/* One sample of all lights. Your shadow ray, from lit along d.w as far as d.distance, would make it 0 where the light is
 * hidden. */
static double reflected(const sphere *lights, const mcs_discrete *table, float u1, float u2) {
    const mcs_pick pick = mcs_discrete_sample(table, u1);
    if (!(pick.pmf > 0)) return 0;
    const sphere *l = &lights[pick.i];
    const mcs_light d = mcs_ball_sample(lit, l->centre, l->radius, pick.u, u2);
    if (!(d.pdf > 0)) return 0;
    return l->radiance * mcs_cosine_pdf(d.w) / (pick.pmf * d.pdf); /* f cos is cos/pi, as mcs_cosine_pdf */
}

int main(void) {
    static sphere lights[LIGHTS];
    static float power[LIGHTS];
    const size_t bytes = mcs_discrete_bytes(LIGHTS);
    mcs_discrete *table = (mcs_discrete *)malloc(bytes);
    mcs_pcg32 rng = mcs_pcg32_for(4, 1, 0);
    mcs_stat s = {0, 0, 0};
    double exact = 0;

    for (int i = 0; i < LIGHTS; i++) {
        float u[5];
        mcs_pcg32_fill_n(&rng, 5, u);
        const mcs_vec3 towards = mcs_cone_sample(0.5f, u[0], u[1]).w; /* at least 30 degrees high: seen whole */
        const float distance = 3 + 3 * u[2];
        const mcs_vec3 centre = {lit.x + distance * towards.x, lit.y + distance * towards.y,
                                 lit.z + distance * towards.z};
        const sphere l = {centre, 0.5f + 0.9f * u[3], 1 / (0.01f + u[4])};
        lights[i] = l;
        power[i] = l.radiance * l.radius * l.radius;
        exact += l.radiance * pow((double)l.radius / distance, 2) * towards.z;
    }
    if (!table || mcs_discrete_build(table, bytes, power, LIGHTS) != MCS_OK) {
        puts("the table could not be built");
        return 1;
    }
    for (int i = 0; i < SAMPLES; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        mcs_stat_add(&s, reflected(lights, table, u1, u2));
    }
    free(table);
    printf("%d lights: %.5f +- %.5f, exact %.5f\n", LIGHTS, s.mean, mcs_stat_error(&s), exact);
    return !(fabs(s.mean - exact) <= 5 * mcs_stat_error(&s));
}
