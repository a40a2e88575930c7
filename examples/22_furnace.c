/* Rough glass in a furnace, where light comes from everywhere: it reflects and refracts nothing but the furnace. The
 * radiance is 1 in air and eta^2 in glass, as refraction squeezes light into a solid angle that is smaller by eta^2. So
 * a path from the eye that refracts multiplies what it finds by (n_o / n_i)^2: 1/eta^2 on its way into glass and eta^2
 * out of it. Some light is missing, which one microfacet sends and another one stops: little if the glass is smooth.
 * Known answer, seen along the normal: the mean, over the angles theta to which microfacets are turned, of F G1 of the
 * direction that is reflected and (1 - F) G1 of the one that is refracted. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

enum { FINE = 100000, SAMPLES = 200000 };

static const float eta = 1.5f; /* glass below, air above */

static double radiance(mcs_vec3 w) { return w.z > 0 ? 1 : eta * eta; }

/* What one sample brings to the eye. */
static double sample(const mcs_ggx *m, mcs_vec3 wo, const float u[3], int *refracted) {
    const mcs_brdf s = mcs_ggx_glass_sample(m, eta, wo, u[0], u[1], u[2]);
    if (!(s.pdf > 0)) return 0;
    *refracted = s.wi.z * wo.z < 0;
    if (!*refracted) return s.weight * radiance(s.wi);
    const double squeeze = wo.z > 0 ? 1 / (eta * eta) : eta * eta; /* (n_o / n_i)^2 */
    return s.weight * squeeze * radiance(s.wi);
}

/* The part of the microfacets that see a direction at this angle to the normal. */
static double g1(double alpha, double angle) { return 2 / (1 + sqrt(1 + pow(alpha * tan(angle), 2))); }

/* Fresnel's equations for light that meets a surface at an angle, and goes on at another one. */
static double fresnel(double before, double behind) {
    const double less = before - behind;
    const double sum = before + behind;
    return (pow(sin(less) / sin(sum), 2) + pow(tan(less) / tan(sum), 2)) / 2;
}

/* ratio is the index behind the surface over that on the side of the eye. The microfacets that are seen along the
 * normal have tan^2(theta) = alpha^2 v / (1 - v) for an even v. */
static void known(double alpha, double ratio, double *reflected, double *refracted) {
    *reflected = *refracted = 0;
    for (int i = 0; i < FINE; i++) {
        const double v = (i + 0.5) / FINE;
        const double theta = atan(alpha * sqrt(v / (1 - v)));
        const int total = sin(theta) >= ratio;
        const double behind = total ? 0 : asin(sin(theta) / ratio);
        const double f = total ? 1 : fresnel(theta, behind);
        if (2 * theta < asin(1)) *reflected += f * g1(alpha, 2 * theta) / FINE;
        *refracted += (1 - f) * g1(alpha, theta - behind) / FINE;
    }
}

static int report(const char *what, const mcs_stat *s, double exact) {
    printf("  %s %.5f +- %.5f, exact %.5f\n", what, s->mean, mcs_stat_error(s), exact);
    return !(fabs(s->mean - exact) <= 5 * mcs_stat_error(s));
}

/* Seen from a z of 1, in air, or -1, in glass. */
static int furnace(float alpha, float z, mcs_pcg32 *rng) {
    const mcs_ggx m = mcs_ggx_make(alpha, alpha);
    const mcs_vec3 wo = {0, 0, z};
    double exact[2];
    mcs_stat part[2] = {{0, 0, 0}, {0, 0, 0}};
    mcs_stat sum = {0, 0, 0};
    for (int i = 0; i < SAMPLES; i++) {
        float u[3];
        int refracted = 0;
        mcs_pcg32_fill_n(rng, 3, u);
        const double light = sample(&m, wo, u, &refracted);
        mcs_stat_add(&part[refracted], light);
        mcs_stat_add(&part[!refracted], 0);
        mcs_stat_add(&sum, light);
    }
    known(alpha, z > 0 ? eta : 1 / eta, &exact[0], &exact[1]);
    printf("alpha %.2f, seen from the %s, radiance %.2f\n", alpha, z > 0 ? "air" : "glass", radiance(wo));
    return report("reflected", &part[0], radiance(wo) * exact[0]) |
           report("refracted", &part[1], radiance(wo) * exact[1]) |
           report("together ", &sum, radiance(wo) * (exact[0] + exact[1]));
}

int main(void) {
    mcs_pcg32 rng = mcs_pcg32_for(22, 3, 0);
    int wrong = furnace(0.05f, 1, &rng) | furnace(0.5f, 1, &rng);
    wrong |= furnace(0.05f, -1, &rng) | furnace(0.5f, -1, &rng);
    return wrong;
}
