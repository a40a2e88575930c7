/* Statistics and quadrature for the tests, in double: chi-square and Kolmogorov-Smirnov tests, adaptive integrals. */
#ifndef MCS_STATS_H
#define MCS_STATS_H
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#define ST_PI 3.14159265358979323846

/* ---- distributions ---- */

/* x^a exp(-x) / Gamma(a+1). Large a by the saddle point of Loader 2000, "Fast and accurate computation of binomial
 * probabilities": exp(-a (m - log1p(m)) - S(a)) / sqrt(2 pi a), m = (x - a)/a, S Stirling's series (DLMF 5.11.1; at a =
 * 16 the first term left out is 3e-14). The difference m - log1p(m) near 0 by its own series, so that its product with
 * a keeps its digits. */
static inline double st_poisson(double a, double x) {
    if (a < 16.0) return exp(a * log(x) - x) / tgamma(a + 1.0);
    const double m = (x - a) / a;
    double g = m - log1p(m);
    if (fabs(m) < 0.05) { /* sum over k >= 2 of (-1)^k m^k / k: 14 terms leave 0.05^14 */
        g = 0.0;
        for (int k = 15; k >= 2; k--) g = 1.0 / (double)k - m * g;
        g *= m * m;
    }
    const double r = 1.0 / (a * a);
    const double s = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r * (1.0 / 1680.0 - r / 1188.0)))) / a;
    return exp(-a * g - s) / sqrt(2.0 * ST_PI * a);
}

/* Regularised upper incomplete gamma Q(a, x): below x = a + 1 one minus the series DLMF 8.11.4 (8.7.1), above it the
 * continued fraction DLMF 8.9.2 in its even part, by the method of Lentz as in Thompson and Barnett 1986, "Coulomb and
 * Bessel functions of complex arguments and order". Both settle within some multiple of sqrt(a) terms. */
static inline double gamma_q(double a, double x) {
    enum { TERMS = 200000 };
    double sum = 1.0;
    double term = 1.0;
    if (!(a > 0.0) || !(x >= 0.0)) return (double)NAN;
    if (x == 0.0) return 1.0;
    if (isinf(x)) return 0.0;
    if (x < a + 1.0) {
        for (int i = 1; i < TERMS && term > sum * DBL_EPSILON * 0.1; i++) {
            term *= x / (a + (double)i);
            sum += term;
        }
        return 1.0 - st_poisson(a, x) * sum;
    }
    double b = x + 1.0 - a;
    double c = 1e300;
    double d = 1.0 / b;
    double h = d;
    for (int i = 1; i < TERMS; i++) {
        const double an = -(double)i * ((double)i - a);
        b += 2.0;
        d = an * d + b;
        c = b + an / c;
        if (fabs(d) < 1e-300) d = 1e-300;
        if (fabs(c) < 1e-300) c = 1e-300;
        d = 1.0 / d;
        const double step = d * c;
        h *= step;
        if (fabs(step - 1.0) < DBL_EPSILON) break;
    }
    return st_poisson(a, x) * a * h;
}

static inline double chi2_p(double stat, double dof) { return gamma_q(0.5 * dof, 0.5 * stat); }

/* Probability that the Kolmogorov-Smirnov distance of n samples exceeds d: the asymptotic distribution at
 * lambda = (sqrt n + 0.12 + 0.11/sqrt n) d (Stephens 1970, "Use of the Kolmogorov-Smirnov, Cramer-von Mises and related
 * statistics"). Two series of the same theta function, each where it needs few terms. */
static inline double ks_p(double d, double n) {
    const double l = (sqrt(n) + 0.12 + 0.11 / sqrt(n)) * d;
    double sum = 0.0;
    if (!(d >= 0.0) || !(n >= 1.0)) return (double)NAN;
    if (l < 0.04) return 1.0; /* the complement is below exp(-pi^2 / (8 l^2)) < 1e-300 */
    double k;
    if (l < 1.18) {
        for (int j = 1; j <= 5; j++) {
            k = (double)(2 * j - 1) * ST_PI / l;
            sum += exp(-k * k / 8.0);
        }
        return 1.0 - sqrt(2.0 * ST_PI) / l * sum;
    }
    for (int j = 5; j >= 1; j--) {
        k = (double)j * l;
        sum += (j & 1 ? 2.0 : -2.0) * exp(-2.0 * k * k);
    }
    return sum;
}

/* Level of each of `tests` independent tests when all together are to fail by chance with probability alpha (Sidak
 * 1967). */
static inline double sidak(double alpha, double tests) { return -expm1(log1p(-alpha) / tests); }

/* Chi-square of counts against expected counts; returns p. Both arrays must cover the same total: give lost samples a
 * bin. Bins expecting less than 5 are pooled in index order until a pool reaches 5; what is left at the end joins the
 * group closed last. p = 0 when a bin that expects exactly nothing was hit; NaN when an expectation is negative or NaN,
 * or when fewer than two groups are left: then nothing was tested. */
static inline double chi2_test(const double *observed, const double *expected, size_t bins, double *stat, int *dof) {
    double sum = 0.0;
    double group_o = 0.0;
    double group_e = 0.0;
    double pool_o = 0.0;
    double pool_e = 0.0;
    int groups = 0;
    int impossible = 0;
    int bad = 0;
    for (size_t i = 0; i <= bins; i++) {
        double close_o, close_e;
        if (i == bins) { /* the last group is still open, so that what is left of the pool can join it */
            close_o = close_e = 0.0;
            group_o += pool_o;
            group_e += pool_e;
        } else {
            bad |= !(expected[i] >= 0.0) || !(observed[i] >= 0.0);
            impossible |= expected[i] == 0.0 && observed[i] > 0.0;
            if (expected[i] >= 5.0) {
                close_o = observed[i];
                close_e = expected[i];
            } else {
                pool_o += observed[i];
                pool_e += expected[i];
                if (pool_e < 5.0) continue;
                close_o = pool_o;
                close_e = pool_e;
                pool_o = pool_e = 0.0;
            }
        }
        if (group_e > 0.0) {
            const double diff = group_o - group_e;
            sum += diff * diff / group_e;
            groups++;
        }
        group_o = close_o;
        group_e = close_e;
    }
    if (stat) *stat = sum;
    if (dof) *dof = groups > 1 ? groups - 1 : 0;
    if (bad) return (double)NAN;
    if (impossible) return 0.0;
    return groups > 1 ? chi2_p(sum, (double)(groups - 1)) : (double)NAN;
}

/* ---- quadrature ---- */

typedef double (*quad1_fn)(double x, void *ctx);
typedef double (*quad2_fn)(double x, double y, void *ctx);

typedef struct {
    double x0, x1, y0, y1, value, error;
    int axis, cuts[2]; /* to halve next: 0 x, 1 y; how often each was halved */
} quad_cell;

typedef struct {
    quad1_fn f1;
    quad2_fn f2;
    void *ctx;
} quad_of;

/* Gauss-Kronrod 7-15 (Kronrod 1965); error estimate of QUADPACK's qk15 (Piessens et al. 1983). */
static inline void quad_rule1(const quad_of *q, quad_cell *c) {
    static const double node[8] = {0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
                                   0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
                                   0.586087235467691130294144691693013, 0.405845151377397166906606412076961,
                                   0.207784955007898467600689403773245, 0.0};
    static const double wk[8] = {0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
                                 0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
                                 0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
                                 0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
    static const double wg[4] = {0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
                                 0.381830050505118944950369775488975, 0.417959183673469387755102040816327};
    const double mid = 0.5 * (c->x0 + c->x1);
    const double half = 0.5 * (c->x1 - c->x0);
    double k = 0.0;
    double g = 0.0;
    double spread = 0.0;
    double v[15];
    for (int i = 0; i < 15; i++) {
        const int j = i < 8 ? i : 14 - i;
        v[i] = q->f1(mid + (i < 8 ? -node[j] : node[j]) * half, q->ctx);
        k += wk[j] * v[i];
        if (j & 1) g += wg[j / 2] * v[i];
    }
    for (int i = 0; i < 15; i++) spread += wk[i < 8 ? i : 14 - i] * fabs(v[i] - 0.5 * k);
    c->value = k * half;
    c->error = fabs(k - g);
    if (c->error > 0.0 && spread > 0.0) c->error = spread * fmin(1.0, pow(200.0 * c->error / spread, 1.5));
    c->error *= fabs(half);
    c->axis = 0;
}

/* Genz and Malik 1980, "Remarks on algorithm 006: an adaptive algorithm for numerical integration over an N-dimensional
 * rectangular region", N = 2: 17 points, degree 7, error against the degree 5 embedded in it; cut along the larger
 * fourth difference. */
static inline void quad_rule2(const quad_of *q, quad_cell *c) {
    const double l2 = 0.35856858280031809;
    const double l3 = 0.94868329805051380;
    const double l5 = 0.68824720161168530; /* sqrt of 9/70, 9/10, 9/19 */
    const double mx = 0.5 * (c->x0 + c->x1);
    const double my = 0.5 * (c->y0 + c->y1);
    const double hx = 0.5 * (c->x1 - c->x0);
    const double hy = 0.5 * (c->y1 - c->y0);
    const double f0 = q->f2(mx, my, q->ctx);
    double two[2];
    two[0] = q->f2(mx - l2 * hx, my, q->ctx) + q->f2(mx + l2 * hx, my, q->ctx);
    two[1] = q->f2(mx, my - l2 * hy, q->ctx) + q->f2(mx, my + l2 * hy, q->ctx);
    double three[2];
    three[0] = q->f2(mx - l3 * hx, my, q->ctx) + q->f2(mx + l3 * hx, my, q->ctx);
    three[1] = q->f2(mx, my - l3 * hy, q->ctx) + q->f2(mx, my + l3 * hy, q->ctx);
    const double s4 = q->f2(mx - l3 * hx, my - l3 * hy, q->ctx) + q->f2(mx + l3 * hx, my - l3 * hy, q->ctx) +
                      q->f2(mx - l3 * hx, my + l3 * hy, q->ctx) + q->f2(mx + l3 * hx, my + l3 * hy, q->ctx);
    const double s5 = q->f2(mx - l5 * hx, my - l5 * hy, q->ctx) + q->f2(mx + l5 * hx, my - l5 * hy, q->ctx) +
                      q->f2(mx - l5 * hx, my + l5 * hy, q->ctx) + q->f2(mx + l5 * hx, my + l5 * hy, q->ctx);
    const double s2 = two[0] + two[1];
    const double s3 = three[0] + three[1];
    c->value =
        -424.0 / 2187.0 * f0 + 980.0 / 6561.0 * s2 + 340.0 / 6561.0 * s3 + 200.0 / 19683.0 * s4 + 6859.0 / 78732.0 * s5;
    const double low = -971.0 / 729.0 * f0 + 245.0 / 486.0 * s2 + 65.0 / 1458.0 * s3 + 25.0 / 729.0 * s4;
    c->error = fabs((c->value - low) * 4.0 * hx * hy);
    c->value *= 4.0 * hx * hy;
    double fourth[2];
    for (int i = 0; i < 2; i++)
        fourth[i] = fabs(two[i] - 2.0 * f0 - (three[i] - 2.0 * f0) / 7.0); /* 1/7 = (9/70) / (9/10) */
    c->axis = fourth[1] > fourth[0];
    if (fabs(fourth[0] - fourth[1]) <= 1e-10 * (fourth[0] + fourth[1])) /* no preference: the relatively longer side */
        c->axis = c->cuts[1] < c->cuts[0];
}

static inline void quad_rule(const quad_of *q, quad_cell *c) {
    if (q->f2) quad_rule2(q, c);
    else quad_rule1(q, c);
}

/* Global adaptive subdivision: the cell with the largest estimated error is halved until the sum of the errors meets
 * the tolerance or QUAD_CELLS are in use. In one dimension and with split > 1 the first and the last piece are also
 * graded towards the ends of the range, QUAD_GRADES times by 4: poles and horizons, where densities peak and break off,
 * tend to lie there. */
enum { QUAD_CELLS = 1024, QUAD_GRADES = 6 };
static inline double quad_adapt(const quad_of *q, quad_cell box, int split, double rel_tol, double abs_tol,
                                double *err) {
    int n = 0;
    const int nx = split < 1 ? 1 : split > 16 ? 16 : split;
    const int ny = q->f2 ? nx : 1;
    quad_cell cell[QUAD_CELLS];
    for (n = 0; n < nx * ny; n++) {
        cell[n] = box;
        cell[n].x0 = box.x0 + (box.x1 - box.x0) * (n % nx) / nx;
        cell[n].x1 = n % nx + 1 == nx ? box.x1 : box.x0 + (box.x1 - box.x0) * (n % nx + 1) / nx;
        cell[n].y0 = box.y0 + (box.y1 - box.y0) * (n / nx) / ny;
        cell[n].y1 = n / nx + 1 == ny ? box.y1 : box.y0 + (box.y1 - box.y0) * (n / nx + 1) / ny;
    }
    for (int i = 0; nx > 1 && ny == 1 && i < QUAD_GRADES;
         i++) { /* cell 0 stays the one at x0, cell nx - 1 the one at x1 */
        cell[n] = cell[0];
        cell[0].x1 = cell[n].x0 = cell[0].x0 + 0.25 * (cell[0].x1 - cell[0].x0);
        cell[n + 1] = cell[nx - 1];
        cell[nx - 1].x0 = cell[n + 1].x1 = cell[nx - 1].x1 - 0.25 * (cell[nx - 1].x1 - cell[nx - 1].x0);
        n += 2;
    }
    int i;
    for (i = 0; i < n; i++) quad_rule(q, &cell[i]);
    double value, error;
    for (;;) {
        quad_cell *b = &cell[n];
        value = error = 0.0;
        int worst;
        for (worst = i = 0; i < n; i++) {
            value += cell[i].value;
            error += cell[i].error;
            if (cell[i].error > cell[worst].error) worst = i;
        }
        if (!(error > fmax(abs_tol, rel_tol * fabs(value))) || n == QUAD_CELLS) break;
        quad_cell *a = &cell[worst];
        const double mid = a->axis ? 0.5 * (a->y0 + a->y1) : 0.5 * (a->x0 + a->x1);
        if (a->axis ? mid == a->y0 || mid == a->y1 : mid == a->x0 || mid == a->x1) break; /* as fine as double goes */
        a->cuts[a->axis]++;
        *b = *a;
        if (a->axis) a->y1 = b->y0 = mid;
        else a->x1 = b->x0 = mid;
        n++;
        quad_rule(q, a);
        quad_rule(q, b);
    }
    if (err) *err = error;
    return value;
}

static inline quad_cell quad_box(double x0, double x1, double y0, double y1) {
    quad_cell c = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, {0, 0}};
    c.x0 = x0;
    c.x1 = x1;
    c.y0 = y0;
    c.y1 = y1;
    return c;
}

/* Integral of f over [x0, x1]. The range is first cut into `split` (1 to 16) equal pieces: 1 for a smooth integrand,
 * more where a peak may hide between the points. *err (err may be NULL) is the estimated absolute error: above
 * max(abs_tol, rel_tol |integral|) only when the integrand did not allow more. NaN from f comes through. */
static inline double quad1(quad1_fn f, void *ctx, double x0, double x1, double rel_tol, double abs_tol, int split,
                           double *err) {
    quad_of q;
    q.f1 = f;
    q.f2 = NULL;
    q.ctx = ctx;
    return quad_adapt(&q, quad_box(x0, x1, 0.0, 1.0), split, rel_tol, abs_tol, err);
}

typedef struct {
    quad2_fn f;
    void *ctx;
    double x0, x1, y, tol, worst;
    int split;
} quad_row;

static inline double quad_row_at(double x, void *ctx) {
    quad_row *r = (quad_row *)ctx;
    return r->f(x, r->y, r->ctx);
}
static inline double quad_row_sum(double y, void *ctx) {
    quad_row *r = (quad_row *)ctx;
    r->y = y;
    double err;
    const double v = quad1(quad_row_at, r, r->x0, r->x1, 0.0, r->tol, r->split, &err);
    r->worst = fmax(r->worst, err);
    return v;
}

/* The same over [x0, x1] x [y0, y1]; `split` cuts each axis. split 1, a small rectangle: cubature, few points where f
 * is smooth. It does not see an edge that only cuts off the rim of a cell (2.6 % on each side), so it is for bins,
 * where that does not matter. split > 1, or when cubature does not settle: nested integrals, x inside, where an edge
 * across the rectangle is a point to close in on. They are repeated with one more piece per axis until two in a row
 * agree: an edge along the rim of a piece in one (0.4 % on each side) is well inside a piece of the other. */
static inline double quad2(quad2_fn f, void *ctx, double x0, double x1, double y0, double y1, double rel_tol,
                           double abs_tol, int split, double *err) {
    enum { ROUNDS = 6 };
    quad_of q;
    q.f1 = NULL;
    q.f2 = f;
    q.ctx = ctx;
    double e;
    double value = quad_adapt(&q, quad_box(x0, x1, y0, y1), split, split > 1 ? 0.01 : rel_tol, abs_tol,
                              &e); /* at least the magnitude */
    double tol = fmax(abs_tol, rel_tol * fabs(value));
    if (split > 1 || e > tol) {
        quad_row row;
        row.f = f;
        row.ctx = ctx;
        row.x0 = x0;
        row.x1 = x1;
        for (int i = 0; i < ROUNDS; i++) {
            row.tol = 0.1 * tol / fabs(y1 - y0);
            row.worst = 0.0;
            row.split = split + i;
            const double last = value;
            double e_rows;
            value = quad1(quad_row_sum, &row, y0, y1, 0.0, 0.4 * tol, split + i, &e_rows);
            e = e_rows + row.worst * fabs(y1 - y0) + (i ? fabs(value - last) : 0.0);
            tol = fmax(abs_tol, rel_tol * fabs(value));
            if (i && !(e > tol)) break;
        }
    }
    if (err) *err = e;
    return value;
}
#endif
