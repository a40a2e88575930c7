/* Lights by solid angle against lights by area. A sample by area is worth its cosine at the light over its squared
 * distance, which vary over a light that is near and large. Over a distant small one nothing varies much, and either
 * will do. Known answer, what a white matte surface with normal +z reflects: Lambert's formula. With p and q neighbours
 * among the corners it is the sum of angle(p, q) (p x q).z / |p x q|, over 2 pi. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

enum { SAMPLES = 200000 };

/* Above the surface, as seen from the point that is lit. */
typedef struct {
    mcs_vec3 corner, edge_x, edge_y;
} quad;

static double dot(mcs_vec3 v, mcs_vec3 w) { return (double)v.x * w.x + (double)v.y * w.y + (double)v.z * w.z; }

static double by_solid_angle(const mcs_spherical_rectangle *light, float u1, float u2) {
    const mcs_light_point s = mcs_spherical_rectangle_sample(light, u1, u2);
    return s.pdf > 0 ? mcs_cosine_pdf(s.w) / s.pdf : 0; /* f cos is cos/pi, as mcs_cosine_pdf */
}

static double by_area(const quad *q, float u1, float u2) {
    const mcs_vec3 x = q->edge_x;
    const mcs_vec3 y = q->edge_y;
    const mcs_vec3 normal = {x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z, x.x * y.y - x.y * y.x};
    const mcs_vec3 p = {q->corner.x + u1 * x.x + u2 * y.x, q->corner.y + u1 * x.y + u2 * y.y,
                        q->corner.z + u1 * x.z + u2 * y.z};
    const double area = sqrt(dot(normal, normal));
    const double distance = sqrt(dot(p, p));
    const mcs_vec3 w = {(float)(p.x / distance), (float)(p.y / distance), (float)(p.z / distance)};
    const float pdf = mcs_pdf_to_solid_angle((float)(1 / area), (float)distance, (float)(dot(w, normal) / area));
    return pdf > 0 ? mcs_cosine_pdf(w) / pdf : 0;
}

static double known(const quad *q) {
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        double p[2][3]; /* this corner and the next one */
        for (int k = 0; k < 2; k++) {
            const int across = (i + k) % 4 == 1 || (i + k) % 4 == 2;
            const int up = (i + k) % 4 >= 2;
            p[k][0] = (double)q->corner.x + across * (double)q->edge_x.x + up * (double)q->edge_y.x;
            p[k][1] = (double)q->corner.y + across * (double)q->edge_x.y + up * (double)q->edge_y.y;
            p[k][2] = (double)q->corner.z + across * (double)q->edge_x.z + up * (double)q->edge_y.z;
        }
        const double cross[3] = {p[0][1] * p[1][2] - p[0][2] * p[1][1], p[0][2] * p[1][0] - p[0][0] * p[1][2],
                                 p[0][0] * p[1][1] - p[0][1] * p[1][0]};
        const double length = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
        const double along = p[0][0] * p[1][0] + p[0][1] * p[1][1] + p[0][2] * p[1][2];
        sum += atan2(length, along) * cross[2] / length;
    }
    return fabs(sum) / (2 * 3.14159265358979);
}

static int report(const char *way, const mcs_stat *s, double exact) {
    const double deviation = sqrt(mcs_stat_variance(s)) / exact;
    printf("  %s %.7g +- %.2g, a sample +- %.3g %%\n", way, s->mean, mcs_stat_error(s), 100 * deviation);
    return !(fabs(s->mean - exact) <= 5 * mcs_stat_error(s) + 1e-6 * exact); /* floats, that is */
}

/* Wanted is the least quotient of variances, by area over by solid angle. */
static int compare(const char *name, const quad *q, double wanted, mcs_pcg32 *rng) {
    const mcs_vec3 lit = {0, 0, 0};
    const mcs_spherical_rectangle light = mcs_spherical_rectangle_make(lit, q->corner, q->edge_x, q->edge_y);
    const double exact = known(q);
    mcs_stat angle = {0, 0, 0};
    mcs_stat area = {0, 0, 0};
    for (int i = 0; i < SAMPLES; i++) {
        const float u1 = mcs_pcg32_float(rng);
        const float u2 = mcs_pcg32_float(rng);
        mcs_stat_add(&angle, by_solid_angle(&light, u1, u2));
        mcs_stat_add(&area, by_area(q, u1, u2));
    }
    const double ratio = mcs_stat_variance(&area) / mcs_stat_variance(&angle);
    printf("%s: exact %.7g, by area %.0f times the variance\n", name, exact, ratio);
    return report("by solid angle", &angle, exact) | report("by area       ", &area, exact) | !(ratio > wanted);
}

int main(void) {
    const quad distant = {{10, 20, 30}, {0.1f, 0, 0}, {0, 0.08f, 0.06f}};
    const quad near_by = {{-1, -2, 0.3f}, {4, 0, 0}, {0, 5, 0}};
    const quad upright = {{0.2f, -3, 0.01f}, {0, 6, 0}, {0, 0, 4}};
    mcs_pcg32 rng = mcs_pcg32_for(24, 1, 0);
    return compare("distant and small", &distant, 1, &rng) | compare("near and large", &near_by, 10, &rng) |
           compare("a wall beside the point", &upright, 10, &rng);
}
