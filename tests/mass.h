/* Does a density integrate to what its sampler does not lose? Two independent ways to the same number: the integral of
 * the density over directions in the coordinates of bins.h, and the area of the random numbers whose sample is not
 * lost. */
#ifndef MCST_MASS_H
#define MCST_MASS_H
#include "bins.h"

typedef struct {
    const mcst_row *row;
    const float *p;
    int radial; /* the random number along which a lit stretch begins and ends */
} mcst_lit_line;

static inline int mcst_is_lit(const mcst_lit_line *l, double u, double v) {
    float a = (float)u;
    float b = (float)v;
    float out[5];
    l->row->fn[0].sample(l->p, l->radial ? &b : &a, l->radial ? &a : &b, out);
    return out[3] > 0;
}

/* The length of {u : the sample at (u, v) is not lost}: scanned, then every change bisected. */
static inline double mcst_lit_length(double v, void *ctx) {
    enum { SCAN = 128 };
    const mcst_lit_line *l = (const mcst_lit_line *)ctx;
    const double top = 1 - 0x1p-24;
    double length = 0;
    double lo = 0;
    double last = 0;
    int was = mcst_is_lit(l, 0, v);
    for (int i = 1; i <= SCAN; i++) {
        const double to_go = 1 - (double)i / SCAN;
        const double u = fmin(1 - to_go * to_go * to_go, top); /* the bands are narrow near 1 */
        double a = last;
        double b = u;
        last = u;
        if (mcst_is_lit(l, u, v) == was) continue;
        while (b - a > 0x1p-25) {
            const double mid = 0.5 * (a + b);
            if (mcst_is_lit(l, mid, v) == was) a = mid;
            else b = mid;
        }
        if (was) length += b - lo;
        was = !was;
        lo = b;
    }
    return was ? length + 1 - lo : length;
}

typedef struct {
    double integral, lit, tolerance;
} mcst_mass;

static int mcst_masses_skipped;

/* Where the rounding of a point moves it by more than a fifth of the lobe's width there is nothing to integrate: a
 * float or two hold all of it. Such a set is no case; it is named and counted. */
static inline int mcst_mass_resolved(const mcst_row *row, const float *p) {
    const double noise = mcst_map_make(row, p).noise;
    if (noise <= 0.2) return 1;
    if (!mcst.list && (!mcst.filter || strstr(mcst.group, mcst.filter))) {
        mcst_masses_skipped++;
        printf("SKIPPED: mass of %s %g %g, wo %g %g %g: rounding moves a point by %.1f widths of the lobe\n", row->name,
               (double)p[0], (double)p[1], (double)p[3], (double)p[4], (double)p[5], noise);
    }
    return 0;
}

/* The two must agree within 1e-5, and what the rounding of the points does to a sharp lobe: noise per point, averaged
 * over 6400 points or more (4 sigma), and to second order its square. */
static inline mcst_mass mcst_mass_of(const mcst_row *row, const float *p) {
    static double mass[MCST_CELLS];
    const double noise = mcst_map_make(row, p).noise;
    mcst_mass m;
    m.lit = 1;
    m.tolerance = 1e-5 + 4 * noise / sqrt(6400.0) + noise * noise;
    m.integral = mcst_masses(row, p, 1e-7, mass);
    if (row->shape == MCST_IS_BRDF) {
        mcst_lit_line l;
        l.row = row;
        l.p = p;
        l.radial = strstr(row->name, "vndf") || strstr(row->name, "bounded");
        m.lit = quad1(mcst_lit_length, &l, 0, 1 - 0x1p-24, 0, 2e-7, 16, NULL);
    }
    return m;
}
#endif
