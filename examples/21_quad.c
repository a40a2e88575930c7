/* A rectangle as light: one sample of its solid angle and one of the BRDF, weighted by the power heuristic. A GGX floor
 * with normal +z, seen at 53 degrees, reflects a panel that hangs over it; the mirror direction meets its rim. Known
 * answer: a sum over fine cells of the panel. Each sampler alone meets it, too, with a larger error. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

enum { FINE = 1000, SAMPLES = 200000 };

static const mcs_vec3 corner = {-1.6f, -0.4f, 1}, edge_x = {0.7f, 0, 0.7f}, edge_y = {0, 1.2f, 0};
static const mcs_vec3 wo = {0.8f, 0, 0.6f};
static const float radiance = 5;
static mcs_ggx m;
static mcs_spherical_rectangle panel; /* prepared for the point that is lit */

static double sample_panel(float u1, float u2, int mis) {
    const mcs_light_point s = mcs_spherical_rectangle_sample(&panel, u1, u2);
    if (!(s.pdf > 0 && s.w.z > 0)) return 0; /* your shadow ray goes s.distance along s.w */
    const double value = radiance * mcs_ggx_eval(&m, wo, s.w) * s.w.z / s.pdf;
    return mis ? value * mcs_mis_power(s.pdf, mcs_ggx_bounded_pdf(&m, wo, s.w)) : value;
}

/* The density of the panel tells whether a direction meets it. A ray that you trace would tell the same. */
static double sample_brdf(float u1, float u2, int mis) {
    const mcs_brdf b = mcs_ggx_bounded_sample(&m, wo, u1, u2);
    const float panel_pdf = mcs_spherical_rectangle_pdf(&panel, b.wi);
    if (!(b.pdf > 0 && panel_pdf > 0)) return 0;
    const double value = b.weight * radiance;
    return mis ? value * mcs_mis_power(b.pdf, panel_pdf) : value;
}

/* The sum of f cos cos' / distance^2, cos' being that at the panel. A fourth of the cells moves it by 1e-6. */
static double known(void) {
    const mcs_vec3 x = edge_x;
    const mcs_vec3 y = edge_y;
    const double normal[3] = {(double)x.y * y.z - (double)x.z * y.y, (double)x.z * y.x - (double)x.x * y.z,
                              (double)x.x * y.y - (double)x.y * y.x}; /* its length is the area */
    double sum = 0;
    for (int i = 0; i < FINE * FINE; i++) {
        const double along_x = (i % FINE + 0.5) / FINE;
        const double along_y = (i / FINE + 0.5) / FINE;
        const double p[3] = {corner.x + along_x * x.x + along_y * y.x, corner.y + along_x * x.y + along_y * y.y,
                             corner.z + along_x * x.z + along_y * y.z};
        const double distance = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        const mcs_vec3 wi = {(float)(p[0] / distance), (float)(p[1] / distance), (float)(p[2] / distance)};
        const double area_cos = fabs(normal[0] * wi.x + normal[1] * wi.y + normal[2] * wi.z) / (FINE * FINE);
        sum += radiance * mcs_ggx_eval(&m, wo, wi) * wi.z * area_cos / (distance * distance);
    }
    return sum;
}

static int report(const char *name, const mcs_stat *s, double exact) {
    printf("%-10s %.5f +- %.5f, exact %.5f\n", name, s->mean, mcs_stat_error(s), exact);
    return !(fabs(s->mean - exact) <= 5 * mcs_stat_error(s));
}

int main(void) {
    const mcs_vec3 lit = {0, 0, 0};
    mcs_pcg32 rng = mcs_pcg32_for(21, 1, 0);
    mcs_stat light = {0, 0, 0};
    mcs_stat brdf = {0, 0, 0};
    mcs_stat both = {0, 0, 0};

    m = mcs_ggx_make(0.1f, 0.1f);
    panel = mcs_spherical_rectangle_make(lit, corner, edge_x, edge_y);
    for (int i = 0; i < SAMPLES; i++) {
        float u[4];
        mcs_pcg32_fill_n(&rng, 4, u);
        mcs_stat_add(&light, sample_panel(u[0], u[1], 0));
        mcs_stat_add(&brdf, sample_brdf(u[2], u[3], 0));
        mcs_stat_add(&both, sample_panel(u[0], u[1], 1) + sample_brdf(u[2], u[3], 1));
    }
    const double exact = known();
    return report("panel", &light, exact) | report("BRDF", &brdf, exact) | report("both, MIS", &both, exact) |
           !(mcs_stat_error(&both) < mcs_stat_error(&light) && mcs_stat_error(&both) < mcs_stat_error(&brdf));
}
