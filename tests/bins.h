/* Histograms fitted to a lobe, and the integral of a density over their bins.
 *
 * Each row names reference coordinates (s, t) in [0,1]^2 in which its lobe is spread out at any sharpness: t is an
 * azimuth, s a radius. They come from elementary warps written here, not from the sampler under test. Two directions
 * are needed:
 *
 *     mcst_place(map, ray, s, x)   the point, and the derivative of its measure (length, area, angle) by (s, t), on the
 *                                  ray of all points of one t
 *     mcst_cell(map, x, y, z)      the bin of a sample
 *
 * Azimuths are measured by the diamond angle |y| / (|x| + |y|) per quadrant: no arctangent per sample, exact bin edges.
 * A BRDF is binned by its half-vector (reflection: d(wi) = 4 (wo.h) d(h)) or, for Phong, about the mirror direction. In
 * those coordinates the region that is reflected above the surface is star-shaped about the centre of the lobe, so the
 * density jumps at most once along a line of constant t; the jump is found by bisection, and the lines are summed by an
 * adaptive rule over t. */
#ifndef MCST_BINS_H
#define MCST_BINS_H
#include "registry.h"

enum { MCST_S = 20, MCST_T = 40, MCST_LINE_BINS = 100, MCST_CELLS = MCST_S * MCST_T };

enum mcst_frame { MCST_SELF, MCST_HALF, MCST_MIRROR };
typedef struct {
    const mcst_row *row;
    const float *p;
    enum mcst_coord coord;
    enum mcst_frame frame;
    int s_bins, t_bins;
    double a, b, k;                    /* the constants of the coordinates, see mcst_map_make */
    double steep;                      /* the density at the end nearer to 0, within the inverse of which it falls */
    double noise;                      /* relative change of the density when the point is rounded to floats */
    double wo[3], ex[3], ey[3], ez[3]; /* for MCST_HALF: wo; for MCST_MIRROR: a frame about R */
} mcst_map;

static inline double mcst_dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* A frame about the mirror direction: x is the axis least along z, made orthogonal, y = z cross x. */
static inline void mcst_map_mirror(mcst_map *m) {
    const double *z = m->ez;
    m->frame = MCST_MIRROR;
    m->ez[0] = -m->wo[0];
    m->ez[1] = -m->wo[1];
    m->ez[2] = m->wo[2];
    if (fabs(z[0]) < fabs(z[1])) {
        m->ex[0] = 1 - z[0] * z[0];
        m->ex[1] = -z[0] * z[1];
        m->ex[2] = -z[0] * z[2];
    } else {
        m->ex[0] = -z[1] * z[0];
        m->ex[1] = 1 - z[1] * z[1];
        m->ex[2] = -z[1] * z[2];
    }
    const double l = sqrt(mcst_dot(m->ex, m->ex));
    for (int i = 0; i < 3; i++) m->ex[i] /= l;
    m->ey[0] = z[1] * m->ex[2] - z[2] * m->ex[1];
    m->ey[1] = z[2] * m->ex[0] - z[0] * m->ex[2];
    m->ey[2] = z[0] * m->ex[1] - z[1] * m->ex[0];
}
/* t / (1 + t) with the sign of x, where t is steep times the distance of |x| from c. */
static inline double mcst_cut_share(double c, double steep, double x) {
    return copysign(1 / (1 + 1 / (steep * (fabs(x) - c))), x);
}
/* The constants a, b, k of the coordinates. */
static inline void mcst_map_constants(mcst_map *m, const mcst_row *row) {
    float at_base;
    switch (row->coord) {
    case MCST_UNIT:
        m->a = 0;
        m->b = 1;
        break; /* x = a + b s */
    case MCST_TENT:
        m->b = 2 * m->a;
        m->a = -m->a;
        m->coord = MCST_UNIT;
        break;
    case MCST_BETWEEN:
        m->b -= m->a;
        m->coord = MCST_UNIT;
        break;
    case MCST_CUT:
        m->k = fmax(fmax(m->a, -m->b), 0);
        at_base = (float)(m->a > 0 ? m->k : -m->k);
        m->steep = (double)row->truth.pdf(m->p, &at_base);
        m->a = mcst_cut_share(m->k, m->steep, m->a);
        m->b = mcst_cut_share(m->k, m->steep, m->b) - m->a;
        break;
    case MCST_SPHERE: m->k = 2; break; /* 1 - z = k s */
    case MCST_HEMISPHERE: m->k = 1; break;
    case MCST_CONE: m->k = m->a; break;
    case MCST_COSPOWER: /* exponents along x and y */
        if (row->params == 1) m->b = m->a;
        break;
    case MCST_SLOPES: /* slopes are a X, b Y; above 1 the reflected part of the lobe is the part with slopes below 1 */
        if (row->shape == MCST_IS_BRDF) {
            m->a = fmin(m->a, 1);
            m->b = fmin(m->b, 1);
        }
        break;
    default: break;
    }
}
static inline mcst_map mcst_map_make(const mcst_row *row, const float *p) {
    mcst_map m;
    memset(&m, 0, sizeof m);
    m.row = row;
    m.p = p;
    m.coord = row->coord;
    m.s_bins = row->dim == 1 ? MCST_LINE_BINS : MCST_S;
    m.t_bins = row->dim == 1 ? 1 : MCST_T;
    m.a = (double)p[0];
    m.b = (double)p[1];
    for (int i = 0; i < 3; i++) m.wo[i] = (double)p[3 + i];
    mcst_map_constants(&m, row);
    m.noise = 0x1p-24;
    if (row->coord == MCST_WHOLELINE || row->coord == MCST_BETWEEN) m.noise *= 1 + fabs(m.a) / m.b;
    if (row->coord == MCST_POWER || row->coord == MCST_EVENPOWER) m.noise *= 1 + m.a;
    if (row->coord == MCST_CUT) m.noise *= 1 + m.k * m.steep;
    if (row->shape == MCST_IS_BRDF) {
        /* a component of wi is off by up to 2^-25, the slope of its half-vector by that over |wo + wi| = 2 wo.h, which
         * is a fraction of the lobe's width; wo.h is about the larger of wo.z and the width */
        const double width = row->coord == MCST_SLOPES ? fmin(m.a, m.b) : 1 / sqrt(fmax(m.a, m.b) + 1);
        m.noise /= width;
        if (!(row->traits & MCST_ABOUT_R)) m.noise /= fmax(m.wo[2], width); /* Phong's lobe is of directions */
        m.frame = MCST_HALF;
        if (row->traits & MCST_ABOUT_R) mcst_map_mirror(&m);
    }
    return m;
}

/* s of a distance y in [0,1] from the peak of (1 - y)^n, and the distance at s: r = (n + 1) y; s = r / (1 + r), scaled
 * to reach 1.
 */
static inline double mcst_power_s(double n, double y) {
    const double r = (n + 1) * y;
    return r / (1 + r) * (n + 2) / (n + 1);
}

static inline double mcst_power_y(double n, double s, double *dy_ds) {
    const double v = s * (n + 1) / (n + 2);
    *dy_ds = 1 / ((n + 2) * (1 - v) * (1 - v));
    return v / (1 - v) / (n + 1);
}

/* Diamond angle: t in [0,1) to a unit vector and the derivative of its angle. */
static inline double mcst_azimuth(double t, double *x, double *y) {
    const double q = floor(4 * t);
    const double f = 4 * t - q;
    const double l2 = (1 - f) * (1 - f) + f * f;
    const double l = 1 / sqrt(l2);
    const double c = (1 - f) * l;
    const double s = f * l;
    switch ((int)q & 3) {
    case 0:
        *x = c;
        *y = s;
        break;
    case 1:
        *x = -s;
        *y = c;
        break;
    case 2:
        *x = -c;
        *y = -s;
        break;
    default:
        *x = s;
        *y = -c;
        break;
    }
    return 4 / l2;
}

/* Quadrants and the coordinate that grows there are looked up: of random directions no processor guesses the branch. */
static inline double mcst_diamond(double x, double y) {
    const double size[2] = {fabs(y), fabs(x)};
    const double sum = size[0] + size[1];
    const int below = y < 0;
    const int quadrant = 2 * below + ((x > 0) == below);
    return sum > 0 ? 0.25 * (quadrant + size[quadrant & 1] / sum) : 0;
}

static inline double mcst_place_line(const mcst_map *m, double s, double *x) {
    double j, w;
    switch (m->coord) {
    case MCST_UNIT: *x = m->a + m->b * s; return m->b;
    case MCST_HALFLINE: /* s = a x / (1 + a x) */ *x = s / (1 - s) / m->a; return 1 / (m->a * (1 - s) * (1 - s));
    case MCST_TRUNCATED: /* the same, scaled to reach 1 at x = b */
        w = 1 + m->a * m->b * (1 - s);
        *x = s * m->b / w;
        return m->b * (1 + m->a * m->b) / (w * w);
    case MCST_WHOLELINE: /* s = 1/2 + (1/2) z / (1 + |z|), x = a + b z */
        w = 1 - fabs(2 * s - 1);
        *x = m->a + m->b * (2 * s - 1) / w;
        return 2 * m->b / (w * w);
    case MCST_CUT: /* mcst_cut_share is a + b s */
        j = m->a + m->b * s;
        w = 1 - fabs(j);
        *x = copysign(m->k + fabs(j) / (w * m->steep), j);
        return m->b / (w * w * m->steep);
    case MCST_POWER: *x = 1 - mcst_power_y(m->a, s, &j); return j;
    default: /* MCST_EVENPOWER: a copy towards each end */
        *x = 1 - mcst_power_y(m->a, s < 0.5 ? 2 * s : 2 - 2 * s, &j);
        if (s < 0.5) *x = -*x;
        return 2 * j;
    }
}

/* The truth in double will do where there is one: test_oracle.c. */
static inline double mcst_place_by_truth(const mcst_map *m, double s, double t, double x[3]) {
    if (m->row->rough.map) {
        m->row->rough.map(m->p, s, t, x);
        return 1 / m->row->rough.pdf_u(m->p, s, t);
    }
    ld exact[3] = {0, 0, 0};
    m->row->truth.map(m->p, (ld)s, (ld)t, exact);
    for (int i = 0; i < 3; i++) x[i] = (double)exact[i];
    return (double)(1 / m->row->truth.pdf_u(m->p, (ld)s, (ld)t));
}

/* All points of one t: the cosine and sine of their azimuth, and its derivative by t. An integral asks for many of
 * them. */
typedef struct {
    double t, x, y, turn;
    double exponent; /* for MCST_COSPOWER */
} mcst_ray;

static inline mcst_ray mcst_ray_of(const mcst_map *m, double t) {
    mcst_ray ray;
    ray.t = t;
    ray.turn = mcst_azimuth(t, &ray.x, &ray.y);
    ray.exponent = 0;
    if (m->coord == MCST_COSPOWER) { /* an azimuth that spreads out the narrower axis */
        ray.x /= sqrt(m->a + 1);
        ray.y /= sqrt(m->b + 1);
        const double l2 = ray.x * ray.x + ray.y * ray.y;
        const double l = sqrt(l2);
        ray.turn /= sqrt((m->a + 1) * (m->b + 1)) * l2;
        ray.x /= l;
        ray.y /= l;
        ray.exponent = m->a * ray.x * ray.x + m->b * ray.y * ray.y;
    }
    return ray;
}

/* The point at s of a ray and |d measure / d(s, t)|. */
static inline double mcst_place(const mcst_map *m, const mcst_ray *ray, double s, double x[3]) {
    if (m->coord == MCST_BY_TRUTH) return mcst_place_by_truth(m, s, ray->t, x);
    if (m->t_bins == 1) return mcst_place_line(m, s, x);
    const double c = ray->x;
    const double n = ray->y;
    double jac = ray->turn;
    double r, z, v[3], l;
    switch (m->coord) {
    case MCST_DISK: /* s = (r / a)^2 */
        r = m->a * sqrt(s);
        x[0] = r * c;
        x[1] = r * n;
        return jac * 0.5 * m->a * m->a;
    case MCST_SPHERE:
    case MCST_HEMISPHERE:
    case MCST_CONE:
        r = sqrt(m->k * s * (2 - m->k * s));
        v[0] = r * c;
        v[1] = r * n;
        v[2] = 1 - m->k * s;
        jac *= m->k;
        break;
    case MCST_COSPOWER: /* 1 - z with the exponent there */
        z = mcst_power_y(ray->exponent, s, &r);
        jac *= r;
        r = sqrt(z * (2 - z));
        v[0] = r * c;
        v[1] = r * n;
        v[2] = 1 - z;
        break;
    default: /* MCST_SLOPES: slopes (a X, b Y), 1 - s = 1 / sqrt(1 + X^2 + Y^2); d(h) = cos^3 d(slopes) */
        r = sqrt(s * (2 - s)) / (1 - s);
        v[0] = m->a * r * c;
        v[1] = m->b * r * n;
        l = 1 / sqrt(1 + v[0] * v[0] + v[1] * v[1]);
        v[0] *= l;
        v[1] *= l;
        v[2] = l;
        jac *= l * l * l * m->a * m->b / ((1 - s) * (1 - s) * (1 - s));
    }
    if (m->frame == MCST_HALF) {
        l = mcst_dot(m->wo, v);
        for (int i = 0; i < 3; i++) x[i] = 2 * l * v[i] - m->wo[i];
        return 4 * fabs(l) * jac;
    }
    for (int i = 0; i < 3; i++)
        x[i] = m->frame == MCST_MIRROR ? v[0] * m->ex[i] + v[1] * m->ey[i] + v[2] * m->ez[i] : v[i];
    return jac;
}

static inline int mcst_cell_at(const mcst_map *m, double s, double t) {
    int i = (int)(s * m->s_bins);
    int j = (int)(t * m->t_bins);
    if (!(s > 0)) i = 0;
    if (i >= m->s_bins) i = m->s_bins - 1;
    if (j >= m->t_bins) j = m->t_bins - 1;
    return i * m->t_bins + j;
}

/* The coordinates of a point or direction in the frame of the map. */
static inline void mcst_in_frame(const mcst_map *m, double x, double y, double w, double v[3]) {
    v[0] = x;
    v[1] = y;
    v[2] = w;
    if (m->frame == MCST_HALF) {
        for (int i = 0; i < 3; i++) v[i] += m->wo[i];
    } else if (m->frame == MCST_MIRROR) {
        const double d[3] = {x, y, w};
        v[0] = mcst_dot(d, m->ex);
        v[1] = mcst_dot(d, m->ey);
        v[2] = mcst_dot(d, m->ez);
    }
}
static inline int mcst_cell(const mcst_map *m, double x, double y, double w) {
    if (m->coord == MCST_BY_TRUTH) {
        const float at[3] = {(float)x, (float)y, (float)w};
        if (m->row->rough.invert) {
            double v[2];
            m->row->rough.invert(m->p, at, v);
            return mcst_cell_at(m, v[0], v[1]);
        }
        ld u[2] = {0, 0};
        m->row->truth.invert(m->p, at, u);
        return mcst_cell_at(m, (double)u[0], (double)u[1]);
    }
    double t = 0;
    double v[3];
    mcst_in_frame(m, x, y, w, v);
    double s, n, z;
    switch (m->coord) {
    case MCST_UNIT: s = (x - m->a) / m->b; break;
    case MCST_HALFLINE: s = m->a * x / (1 + m->a * x); break;
    case MCST_TRUNCATED: s = x * (1 + m->a * m->b) / (m->b * (1 + m->a * x)); break;
    case MCST_WHOLELINE:
        n = (x - m->a) / m->b;
        s = 0.5 + 0.5 * n / (1 + fabs(n));
        break;
    case MCST_CUT: s = (mcst_cut_share(m->k, m->steep, x) - m->a) / m->b; break;
    case MCST_POWER: s = mcst_power_s(m->a, 1 - x); break;
    case MCST_EVENPOWER:
        s = 0.5 * mcst_power_s(m->a, 1 - fabs(x));
        if (x > 0) s = 1 - s;
        break;
    case MCST_DISK:
        s = (v[0] * v[0] + v[1] * v[1]) / (m->a * m->a);
        t = mcst_diamond(v[0], v[1]);
        break;
    case MCST_SPHERE:
    case MCST_HEMISPHERE:
    case MCST_CONE: /* 1 - z without the cancellation */
        s = (v[2] > 0 ? (v[0] * v[0] + v[1] * v[1]) / (1 + v[2]) : 1 - v[2]) / m->k;
        t = mcst_diamond(v[0], v[1]);
        break;
    case MCST_COSPOWER:
        n = v[0] * v[0] + v[1] * v[1];
        z = sqrt(n + v[2] * v[2]);
        s = n > 0 ? mcst_power_s((m->a * v[0] * v[0] + m->b * v[1] * v[1]) / n,
                                 v[2] > 0 ? n / (z * (z + v[2])) : 1 - v[2] / z)
                  : 0;
        t = mcst_diamond(v[0] * sqrt(m->a + 1), v[1] * sqrt(m->b + 1));
        break;
    default:
        v[0] /= m->a;
        v[1] /= m->b;
        n = v[0] * v[0] + v[1] * v[1];
        z = sqrt(n + v[2] * v[2]);
        s = v[2] > 0 ? n / (z * (z + v[2])) : 1;
        t = mcst_diamond(v[0], v[1]);
    }
    return mcst_cell_at(m, s, t);
}

/* --- the density over the bins ------------------------------------------------------------------------------------ */

/* Gauss-Legendre on [0,1] with 8 points (Abramowitz and Stegun 1964, table 25.4). */
static const double mcst_gl_x[8] = {0.5 - 0.4801449282487681, 0.5 - 0.3983332387068134, 0.5 - 0.2627662049581645,
                                    0.5 - 0.0917173212478249, 0.5 + 0.0917173212478249, 0.5 + 0.2627662049581645,
                                    0.5 + 0.3983332387068134, 0.5 + 0.4801449282487681};
static const double mcst_gl_w[8] = {0.0506142681451881, 0.1111905172266872, 0.1568533229389437, 0.1813418916891810,
                                    0.1813418916891810, 0.1568533229389437, 0.1111905172266872, 0.0506142681451881};

typedef struct {
    const mcst_row *row;
    const float *p;
    mcst_map map;
} mcst_density;

/* The density with respect to (s, t): the shipped float density of the rounded point, times the derivative. */
static inline double mcst_density_at(const mcst_density *d, const mcst_ray *ray, double s) {
    double x[3] = {0, 0, 0};
    const double jac = mcst_place(&d->map, ray, s, x);
    float xf[3];
    xf[0] = (float)x[0];
    xf[1] = (float)x[1];
    xf[2] = (float)x[2];
    float pdf;
    d->row->fn[0].pdf(d->p, xf, &pdf);
    return (double)pdf * jac;
}

static inline double mcst_panel(const mcst_density *d, const mcst_ray *ray, double s0, double s1) {
    double sum = 0;
    for (int i = 0; i < 8; i++) sum += mcst_gl_w[i] * mcst_density_at(d, ray, s0 + (s1 - s0) * mcst_gl_x[i]);
    return sum * (s1 - s0);
}

/* A smooth stretch. On a line it is cut into eight; a power of a cosine has a root at the horizon, so there the pieces
 * shrink towards it. */
static inline double mcst_smooth(const mcst_density *d, const mcst_ray *ray, double s0, double s1) {
    double sum = 0;
    if (d->map.t_bins == 1) {
        for (int i = 0; i < 8; i++) sum += mcst_panel(d, ray, s0 + (s1 - s0) * i / 8, s0 + (s1 - s0) * (i + 1) / 8);
        return sum;
    }
    if (d->map.coord == MCST_COSPOWER && s1 == 1) {
        for (int i = 0; i < 5; i++) {
            const double cut = s0 + 0.75 * (s1 - s0);
            sum += mcst_panel(d, ray, s0, cut);
            s0 = cut;
        }
    }
    return sum + mcst_panel(d, ray, s0, s1);
}

/* The ends s = 0 and s = 1 may be singular (a horizon at infinite slope): they are looked at just inside. */
static inline double mcst_inside(double s) { return fmin(fmax(s, 1e-9), 1 - 1e-9); }
static inline int mcst_is_positive(const mcst_density *d, const mcst_ray *ray, double s) {
    return mcst_density_at(d, ray, mcst_inside(s)) > 0;
}

/* The integral over [s0, s1] of a ray. in0 and in1 say whether the density is positive at its ends; where it is at one
 * of them alone the span is cut at the jump. */
static inline double mcst_span(const mcst_density *d, const mcst_ray *ray, double s0, double s1, int in0, int in1) {
    double lo = mcst_inside(s0);
    double hi = mcst_inside(s1);
    if (in0 == in1) return mcst_smooth(d, ray, s0, s1);
    for (int i = 0; i < 30; i++) {
        const double mid = 0.5 * (lo + hi);
        if ((mcst_density_at(d, ray, mid) > 0) == in0) lo = mid;
        else hi = mid;
    }
    return in0 ? mcst_smooth(d, ray, s0, lo) : mcst_smooth(d, ray, hi, s1);
}

static inline void mcst_line(const mcst_density *d, double t, double weight, double *sums) {
    const int n = d->map.s_bins;
    const mcst_ray ray = mcst_ray_of(&d->map, t);
    int in0 = mcst_is_positive(d, &ray, 0);
    for (int i = 0; i < n; i++) {
        const double s1 = (i + 1.0) / n;
        const int in1 = mcst_is_positive(d, &ray, s1);
        sums[i] += weight * mcst_span(d, &ray, (double)i / n, s1, in0, in1);
        in0 = in1;
    }
}

static inline void mcst_column_rule(const mcst_density *d, double t0, double t1, double *sums) {
    /* Gauss-Legendre, 4 points (Abramowitz and Stegun 1964, table 25.4) */
    static const double x[2] = {0.1699905217924281, 0.4305681557970263},
                        w[2] = {0.3260725774312731, 0.1739274225687269};
    const double mid = 0.5 * (t0 + t1);
    const double len = t1 - t0;
    for (int i = 0; i < 2; i++) {
        mcst_line(d, mid - len * x[i], len * w[i], sums);
        mcst_line(d, mid + len * x[i], len * w[i], sums);
    }
}

/* Adds the integral over [t0, t1] to out; `whole` is the plain rule on it. Halved until the two agree within tol (sum
 * over s), or as well as the rounding of the points allows. */
static inline void mcst_column(const mcst_density *d, double t0, double t1, const double *whole, double tol, int depth,
                               double *out) {
    double a[MCST_S] = {0};
    double b[MCST_S] = {0};
    double diff = 0;
    double mass = 0;
    const double mid = 0.5 * (t0 + t1);
    mcst_column_rule(d, t0, mid, a);
    mcst_column_rule(d, mid, t1, b);
    for (int i = 0; i < MCST_S; i++) {
        diff += fabs(whole[i] - a[i] - b[i]);
        mass += whole[i];
    }
    if (depth > 0 && !(diff <= tol + d->map.noise * mass)) {
        mcst_column(d, t0, mid, a, tol * 0.7, depth - 1, out);
        mcst_column(d, mid, t1, b, tol * 0.7, depth - 1, out);
        return;
    }
    for (int i = 0; i < MCST_S; i++) out[i] += a[i] + b[i];
}

/* mass[i * t_bins + j]: the integral of the density over each bin; returns their sum. tol bounds the estimated error of
 * a column of bins. */
static inline double mcst_masses(const mcst_row *row, const float *p, double tol, double *mass) {
    double total = 0;
    mcst_density d;
    d.row = row;
    d.p = p;
    d.map = mcst_map_make(row, p);
    if (d.map.t_bins == 1) {
        for (int i = 0; i < d.map.s_bins; i++) mass[i] = 0;
        mcst_line(&d, 0, 1, mass);
        for (int i = 0; i < d.map.s_bins; i++) total += mass[i];
        return total;
    }
    for (int j = 0; j < MCST_T; j++) {
        double whole[MCST_S] = {0};
        double sums[MCST_S] = {0};
        const double t0 = (double)j / MCST_T;
        const double t1 = (j + 1.0) / MCST_T;
        mcst_column_rule(&d, t0, t1, whole);
        mcst_column(&d, t0, t1, whole, tol, 14, sums);
        for (int i = 0; i < MCST_S; i++) total += mass[i * MCST_T + j] = sums[i];
    }
    return total;
}

/* --- chi-square and Kolmogorov-Smirnov ---------------------------------------------------------------------------- */

enum { MCST_BLOCK = 2048, MCST_GRID_U = 16, MCST_FINE_U = 1024 };

typedef struct {
    double chi2, stray, ks_s,
        ks_t; /* p-values; stray: too many samples where the integral is 0; ks_t is 1 in one dimension */
    double chi2_u, ks_u1, ks_u2; /* the same in u-space, 1 where there is no inverse */
    double mass;                 /* integral of the density */
} mcst_fit;

/* p-value of the largest distance between two distributions given on the same bins (at bin edges only, so
 * conservative). */
static inline double mcst_ks_bins(const double *observed, const double *expected, size_t bins, double n) {
    double o = 0;
    double e = 0;
    double d = 0;
    for (size_t i = 0; i < bins; i++) {
        o += observed[i];
        e += expected[i];
        d = fmax(d, fabs(o - e) / n);
        if (!(d >= 0)) return NAN;
    }
    return ks_p(d, n);
}

/* Draws n samples in the array form and compares their histogram with the integral of the density. A BRDF's lost
 * samples are one more bin. */
static inline void mcst_fit_xy(const mcst_row *row, const float *p, double n, uint64_t seed, mcst_fit *fit) {
    static float buffer[7][MCST_BLOCK];
    static double observed[MCST_CELLS + 1], expected[MCST_CELLS + 1];
    double so[MCST_LINE_BINS + 1] = {0};
    double se[MCST_LINE_BINS + 1] = {0};
    double to[MCST_T + 1] = {0};
    double te[MCST_T + 1] = {0};
    float *const out[5] = {buffer[2], buffer[3], buffer[4], buffer[5], buffer[6]};
    const mcst_map map = mcst_map_make(row, p);
    const int cells = map.s_bins * map.t_bins;
    const int brdf = row->shape == MCST_IS_BRDF;
    const double tol = 1e-8;
    double done = 0;
    double stray = 0;
    memset(buffer, 0, sizeof buffer);
    memset(observed, 0, sizeof observed);
    while (done < n) {
        mcst_uniform(&seed, MCST_BLOCK, buffer[0], buffer[1]);
        row->sample_n(p, MCST_BLOCK, buffer[0], buffer[1], out);
        for (int i = 0; i < MCST_BLOCK; i++) {
            const int lost = brdf && !(out[3][i] > 0);
            if (!(isfinite(out[0][i]) && isfinite(out[1][i]) && isfinite(out[2][i]) && isfinite(out[3][i]))) {
                fit->chi2 = fit->stray = fit->ks_s = fit->ks_t = fit->mass = NAN;
                return;
            }
            observed[lost ? cells : mcst_cell(&map, (double)out[0][i], (double)out[1][i], (double)out[2][i])] += 1;
        }
        done += MCST_BLOCK;
    }
    fit->mass = mcst_masses(row, p, tol, expected);
    for (int i = 0; i < cells; i++) {
        expected[i] *= done;
        if (expected[i] == 0) {
            stray += observed[i];
            observed[i] = 0;
        }
    }
    expected[cells] = brdf ? fmax(0, 1 - fit->mass) * done : 0;
    for (int i = 0; i < cells; i++) {
        so[i / map.t_bins] += observed[i];
        se[i / map.t_bins] += expected[i];
        to[i % map.t_bins] += observed[i];
        te[i % map.t_bins] += expected[i];
    }
    so[map.s_bins] = to[map.t_bins] = observed[cells];
    se[map.s_bins] = te[map.t_bins] = expected[cells];
    fit->chi2 = chi2_test(observed, expected, (size_t)(cells + brdf), NULL, NULL);
    /* A corner of the lit region that falls between the points of the rule has at most the mass that mcst_column stops
     * at: the number of samples there is at most Poisson with that mean, and P(X >= stray) is the complement of
     * gamma_q. */
    fit->stray = stray > 0 ? 1 - gamma_q(stray, (tol * map.t_bins + map.noise) * done) : 1;
    fit->ks_s = mcst_ks_bins(so, se, (size_t)(map.s_bins + brdf), done);
    fit->ks_t = map.t_bins == 1 ? 1 : mcst_ks_bins(to, te, (size_t)(map.t_bins + brdf), done);
}

/* Takes n samples back to u and compares those with the uniform density on the square. */
static inline void mcst_fit_u(const mcst_row *row, const float *p, double n, uint64_t seed, mcst_fit *fit) {
    static float buffer[7][MCST_BLOCK];
    static double observed[MCST_GRID_U * MCST_GRID_U], expected[MCST_GRID_U * MCST_GRID_U], fine[2][MCST_FINE_U],
        flat[MCST_FINE_U];
    float *const out[5] = {buffer[2], buffer[3], buffer[4], buffer[5], buffer[6]};
    const int cells = row->inputs == 1 ? MCST_GRID_U : MCST_GRID_U * MCST_GRID_U;
    double done = 0;
    fit->chi2_u = fit->ks_u1 = fit->ks_u2 = 1;
    if (!row->fn[0].invert) return;
    memset(buffer, 0, sizeof buffer);
    memset(observed, 0, sizeof observed);
    memset(fine, 0, sizeof fine);
    while (done < n) {
        mcst_uniform(&seed, MCST_BLOCK, buffer[0], buffer[1]);
        row->sample_n(p, MCST_BLOCK, buffer[0], buffer[1], out);
        for (int i = 0; i < MCST_BLOCK; i++) {
            const float x[3] = {out[0][i], out[1][i], out[2][i]};
            float u[2] = {0, 0};
            row->fn[0].invert(p, x, u);
            if (!(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1)) {
                fit->chi2_u = fit->ks_u1 = fit->ks_u2 = NAN;
                return;
            }
            observed[(int)(u[0] * MCST_GRID_U) + (row->inputs == 2 ? MCST_GRID_U * (int)(u[1] * MCST_GRID_U) : 0)] += 1;
            fine[0][(int)(u[0] * MCST_FINE_U)] += 1;
            fine[1][(int)(u[1] * MCST_FINE_U)] += 1;
        }
        done += MCST_BLOCK;
    }
    for (int i = 0; i < cells; i++) expected[i] = done / cells;
    for (int i = 0; i < MCST_FINE_U; i++) flat[i] = done / MCST_FINE_U;
    fit->chi2_u = chi2_test(observed, expected, (size_t)cells, NULL, NULL);
    fit->ks_u1 = mcst_ks_bins(fine[0], flat, MCST_FINE_U, done);
    if (row->inputs == 2) fit->ks_u2 = mcst_ks_bins(fine[1], flat, MCST_FINE_U, done);
}

/* p-values that mcst_fit holds for a row, for Sidak's correction. */
static inline int mcst_fit_tests(const mcst_row *row) {
    return (row->dim == 1 ? 3 : 4) + (row->fn[0].invert ? (row->inputs == 1 ? 2 : 3) : 0);
}

/* The level of one p-value when the whole suite (every set of every row, however the programs share them) has level
 * 0.01. */
static inline double mcst_level(void) {
    double tests = 0;
    for (size_t i = 0; i < MCST_NROWS; i++) tests += (double)mcst_rows[i].chi_size * mcst_fit_tests(&mcst_rows[i]);
    return sidak(0.01, tests);
}

static inline double mcst_fit_worst(const mcst_fit *f) {
    const double v[7] = {f->chi2, f->stray, f->ks_s, f->ks_t, f->chi2_u, f->ks_u1, f->ks_u2};
    double worst = 1;
    for (int i = 0; i < 7; i++) {
        if (isnan(v[i])) return NAN;
        worst = fmin(worst, v[i]);
    }
    return worst;
}
#endif
