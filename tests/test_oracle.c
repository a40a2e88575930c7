/* Design checks 3 to 6 for every row of the registry: mass, accuracy against the long double truth, bad input, round
 * trips.
 *
 * MCS_TEST_VERBOSE=1 prints the worst error of each row, the figures that the header documents. Errors are in units of
 * their tolerance, so that 1 is the limit; the tolerances stand at the top of each check. EPS = 2^-24 is half an ulp of
 * 1. */
#include "asserting.h"
#include "claims.h"
#include "mass.h"

#ifndef MCS_HEADER
#define MCS_HEADER "mcsample.h" /* its path from where the test is run */
#endif

#define EPS 0x1p-24

/* --- the points u ------------------------------------------------------------------------------------------------- */

/* 902: where the logarithm of a cosine near its power 1 rounds worst */
static const float corners[] = {0,    0x1p-149f, 0x1p-24f,     0x1p-12f,           0.25f,       0.49999997f,
                                0.5f, 0.75f,     1 - 0x1p-12f, 1 - 902 * 0x1p-24f, 1 - 0x1p-24f};
enum { CORNERS = 11, STRATA = 12, MAX_U = CORNERS * CORNERS + STRATA * STRATA };

/* Every pair of corners, then one point in each cell of a grid. */
static int make_u(const mcst_row *row, uint64_t seed, float u[MAX_U][2]) {
    const int lines = row->inputs == 1;
    int n = 0;
    for (int i = 0; i < CORNERS; i++)
        for (int j = 0; j < (lines ? 1 : CORNERS); j++, n++) {
            u[n][0] = corners[i];
            u[n][1] = corners[j];
        }
    for (int i = 0; i < STRATA * STRATA; i++, n++) {
        mcst_uniform(&seed, 1, &u[n][0], &u[n][1]);
        if (lines) u[n][0] = fminf(((float)i + u[n][0]) / (STRATA * STRATA), 1 - 0x1p-24f);
        else {
            u[n][0] = fminf(((float)(i / STRATA) + u[n][0]) / STRATA, 1 - 0x1p-24f);
            u[n][1] = fminf(((float)(i % STRATA) + u[n][1]) / STRATA, 1 - 0x1p-24f);
        }
    }
    return n;
}

/* --- check 3: mass ------------------------------------------------------------------------------------------------ */

/* Bins and integrals take the truth in double. A density off by 1e-7 moves a mass by a hundredth of its tolerance, and a
 * coordinate off by 2^-30 is less than a float shows. An edge of 40 bins off by 1e-6 on both sides moves the count of a
 * bin by 8e-5 of itself, where its standard deviation is 9e-3 with 1e7 samples in 800 bins. Only sets of the chi-square
 * test are binned. */
static void check_rough(const mcst_row *row, const float *p, int binned) {
    enum { N = 16 };
    if (row->coord != MCST_BY_TRUTH || !row->rough.map) return;
    for (int i = 0; i < N * N; i++) {
        const double s = (i / N + 0.5) / N;
        const double t = (i % N + 0.5) / N;
        ld want[3] = {0, 0, 0};
        double got[3];
        row->truth.map(p, (ld)s, (ld)t, want);
        row->rough.map(p, s, t, got);
        const float x[3] = {(float)got[0], (float)got[1], (float)got[2]};
        for (int k = 0; k < 3; k++)
            CHECK(fabsl(got[k] - want[k]) <= 0x1p-30, "s %g, t %g: place in double off by %Lg", s, t, got[k] - want[k]);
        const ld pdf = row->truth.pdf_u(p, (ld)s, (ld)t);
        const double by = (double)(row->rough.pdf_u(p, s, t) / pdf - 1);
        CHECK(fabs(by) <= 1e-7, "s %g, t %g: density in double off by %g", s, t, by);
        if (!binned) continue;
        row->truth.invert(p, x, want);
        row->rough.invert(p, x, got);
        for (int k = 0; k < 2; k++)
            CHECK(fabsl(got[k] - want[k]) <= 1e-6, "s %g, t %g: inverse in double off by %Lg", s, t, got[k] - want[k]);
    }
}

static void check_mass(const mcst_row *row, const float *p) {
    const mcst_mass m = mcst_mass_of(row, p);
    CHECK(fabs(m.integral - m.lit) <= m.tolerance, "integral %.8f, not lost %.8f (%g, tolerance %g)", m.integral, m.lit,
          m.integral - m.lit, m.tolerance);
}

/* --- check 4: accuracy -----------------------------------------------------------------------------------------------
 */

enum { PDF_U, PDF_X, PDF_FAR, WHERE, WIDTH, UNIT, WEIGHT, WEIGHT_X, EVAL, CLOSURE, INVERT, ROUND_TRIP, ERRORS };
static const char *const error_name[ERRORS] = {"pdf(u)", "pdf(x)",    "far",  "where",   "width",  "unit",
                                               "weight", "weight(x)", "eval", "closure", "invert", "trip"};
static double worst[ERRORS];

/* Scores err against its tolerance. */
static int within(int what, double err, double tol) {
    const double score = err / tol;
    if (!(score <= worst[what])) worst[what] = score;
    return err <= tol;
}

/* Is got within a relative tolerance of want? Densities beyond FLT_MAX saturate. A density is the peak times a float in
 * [0,1]; where that float is subnormal its digits are gone, and all that is asked is that the density is small, too. */
static int near(int what, float got, ld want, double rel, ld peak) {
    const ld top = (ld)FLT_MAX;
    const ld w = want > top ? top : want;
    return within(what, (double)fabsl((ld)got - w), rel * (double)fabsl(w) + MCST_FAINT * (double)peak + 0x1p-149);
}

/* 1e-6 (1 + |ln(pdf / peak)|): a density e^-x has the rounding of x in it. */
static double pdf_tol(ld pdf, ld peak) {
    return 1e-6 * (1 + (pdf > 0 && peak > 0 ? fabs((double)logl(pdf / peak)) : 0));
}

/* The same for a given direction. A Gaussian half-vector has factors beside e^-e: the peak of the product is not where
 * e is 0, and the rounding is that of e itself, which has 12 EPS: twice the 5 of a slope over its alpha, and two more.
 */
static double direction_tol(const mcst_row *row, const float *p, const float *x, ld pdf, ld peak) {
    const o_vec3 v = o_v3(x[0], x[1], x[2]);
    const o_vec3 h = row->shape == MCST_IS_BRDF ? o_add(mcst_o3(p + 3), v) : v;
    return row->traits & MCST_GAUSS && h.z > 0 ? 1e-6 * (1 + (double)(o_slope_rr((ld)p[0], (ld)p[1], h) / (h.z * h.z)))
                                               : pdf_tol(pdf, peak);
}

static int is_azimuth(const mcst_row *row, int i) {
    return row->shape == MCST_IS_VLOBE ? i == 0 : row->dim > 1 && !(row->traits & MCST_SQUARE) && i == 1;
}

/* Distance of two values of random number i; of an azimuth a full turn is no turn. */
static double u_error(const mcst_row *row, int i, double a, double b) {
    const double d = fabs(a - b);
    return is_azimuth(row, i) ? fmin(d, fabs(1 - d)) : d;
}

/* |(h.x/ax, h.y/ay, h.z)| */
static double stretched_length(const float *p, o_vec3 h) {
    const ld x = h.x / (ld)p[0];
    const ld y = h.y / (ld)p[1];
    return (double)sqrtl(x * x + y * y + h.z * h.z);
}

/* How much the map to visible normals magnifies a rounding: h is (ax n.x, ay n.y, n.z) made unit and n is known to EPS
 * |n|, so the wider alpha times |n| against the length of that vector. */
static double magnification(const float *p, const mcst_row *row, const ld *x) {
    const o_vec3 v = o_vec(x[0], x[1], x[2]);
    return fmax((double)p[0], (double)p[1]) *
           stretched_length(p, row->shape == MCST_IS_BRDF ? o_half(mcst_o3(p + 3), v) : v);
}

static void describe(const mcst_row *row, const float *p) {
    if (row->has_wo)
        mcst_case("%g %g, wo %g %g %g", (double)p[0], (double)p[1], (double)p[3], (double)p[4], (double)p[5]);
    else mcst_case("%g %g", (double)p[0], (double)p[1]);
}

/* A point of the grid: parameters, numbers, where they lead and how much the exact map magnifies rounding; all errors
 * are in units of their tolerances. */
typedef struct {
    const mcst_row *row;
    const float *p, *u;
    ld peak;
    double extent, magnified;
    ld exact[3];
    float x[3], out[5];
} grid_point;

/* Where: CLAIM_WHERE, but relative to the point itself where that is stricter. Lobes have 4 ulp, that is 8 EPS, and the
 * reflection 2 (h.wo) h - wo magnifies an error of h (3 EPS) by 4 and adds 3 roundings. */
static void check_where(const grid_point *g) {
    const mcst_row *row = g->row;
    const float *u = g->u;
    const float *x = g->x;
    const ld *exact = g->exact;
    double err = 0;
    double size = 0;
    for (int i = 0; i < row->dim; i++) {
        err = fmax(err, fabs((double)((ld)x[i] - exact[i])));
        size = fmax(size, fabs((double)exact[i]));
    }
    if (row->dim == 1) size = fmax(size, mcst_line_scale(row, g->p));
    else if (row->dim == 3) size = 1;
    const double claim = mcst_claim_of(row, CLAIM_WHERE, g->p);
    double steps = row->shape == MCST_IS_BRDF    ? 16
                   : row->shape == MCST_IS_DIR   ? claim
                   : row->traits & MCST_QUANTILE ? 12
                                                 : 8;
    steps *= 1 + g->magnified;
    CHECK(within(WHERE, err, steps * EPS * size + 0x1p-149 * fmax(1, g->extent)),
          "u %a %a: (%.9g %.9g %.9g), exact (%.9Lg %.9Lg %.9Lg)", (double)u[0], (double)u[1], (double)x[0],
          (double)x[1], (double)x[2], exact[0], exact[1], exact[2]);
}
/* The same relative to the lobe's own width: slopes in units of alpha, off by a fraction of themselves or, of visible
 * normals, which are sums c + i, of the whole vector; the least radius is about the root of the least subnormal. */
static void check_width(const grid_point *g) {
    const mcst_row *row = g->row;
    const float *u = g->u;
    const float *x = g->x;
    const ld *exact = g->exact;
    const mcst_map map = mcst_map_make(row, g->p);
    const double wx = row->coord == MCST_SLOPES ? map.a : 1 / sqrt(map.a + 1);
    const double wy = row->coord == MCST_SLOPES ? map.b : 1 / sqrt(map.b + 1);
    const double dx = (double)((ld)x[0] - exact[0]) / wx;
    const double dy = (double)((ld)x[1] - exact[1]) / wy;
    const double ex = (double)exact[0] / wx;
    const double ey = (double)exact[1] / wy;
    const double scale = row->shape == MCST_IS_VLOBE ? stretched_length(g->p, o_vec(exact[0], exact[1], exact[2]))
                                                     : sqrt(ex * ex + ey * ey);
    CHECK(within(WIDTH, sqrt(dx * dx + dy * dy), 16 * EPS * (1 + g->magnified) * scale + 0x1p-73),
          "u %a %a: off by (%g %g) of the lobe's width", (double)u[0], (double)u[1], dx, dy);
}
/* Rounded over the rim: 0 or what is inside; of a light that is prepared for p, the density of the sample. */
static void check_rim(const grid_point *g, float pdf) {
    const mcst_row *row = g->row;
    const float *u = g->u;
    if (row->domain.bad == mcst_bad_light) {
        CHECK(pdf == g->out[3], "u %a %a: pdf(x) %.9g on the rim, of the sample %.9g", (double)u[0], (double)u[1],
              (double)pdf, (double)g->out[3]);
        return;
    }
    const float *p = g->p;
    const float *x = g->x;
    float inside[3];
    for (int i = 0; i < 3; i++)
        inside[i] = x[i] * (1 - 8 * (float)EPS) + (row->shape == MCST_IS_VLOBE ? 8 * (float)EPS * p[3 + i] : 0);
    if (row->shape == MCST_IS_DIR) inside[2] = x[2]; /* towards the axis of a cone */
    const ld pdf_x = row->truth.pdf(p, inside);
    CHECK(pdf >= 0 && (ld)pdf <= pdf_x * 1.001L, "u %a %a: pdf(x) %.9g on the rim, %.9Lg inside", (double)u[0],
          (double)u[1], (double)pdf, pdf_x);
}
static void check_values(const grid_point *g, float pdf, ld pdf_x) {
    const mcst_row *row = g->row;
    const float *u = g->u;
    const float *p = g->p;
    const float *x = g->x;
    const float *out = g->out;
    const ld peak = g->peak;
    const ld f = row->truth.eval(p, x);
    const ld w = row->truth.weight(p, x);
    /* a weight is a function of the cosines alone; the float wi.z is known to EPS, so to EPS / wi.z of itself */
    const double wtol = 2e-6 + 40 * EPS / (double)x[2];
    float value;
    row->fn[0].eval(p, x, &value);
    float weight;
    row->fn[0].weight(p, x, &weight);
    if (pdf_x > 0) /* not rounded over the rim of a Phong lobe */
        CHECK(near(WEIGHT, out[4], w, wtol, 1), "u %a %a: weight %.9g, exact %.9Lg", (double)u[0], (double)u[1],
              (double)out[4], w);
    double tol = mcst_claim_of(row, CLAIM_WEIGHT, p) * 1e-6;
    CHECK(near(WEIGHT_X, weight, w, tol, 1), "u %a %a: weight(x) %.9g, exact %.9Lg", (double)u[0], (double)u[1],
          (double)weight, w);
    tol = mcst_claim_of(row, CLAIM_EVAL, p) * direction_tol(row, p, x, pdf_x, peak);
    CHECK(near(EVAL, value, f, tol, peak), "u %a %a: eval(x) %.9g, exact %.9Lg (%.3g)", (double)u[0], (double)u[1],
          (double)value, f, (double)((ld)value / f - 1));
    if (f < (ld)FLT_MAX && pdf_x < (ld)FLT_MAX && f > (ld)FLT_MIN && pdf_x > (ld)FLT_MIN)
        CHECK(within(CLOSURE, fabs((double)weight * (double)pdf / ((double)value * (double)x[2]) - 1), 2 * tol + 1e-6),
              "u %a %a: weight pdf = %.9g, f cos = %.9g", (double)u[0], (double)u[1], (double)weight * (double)pdf,
              (double)value * (double)x[2]);
}
static void check_inverse(const grid_point *g) {
    const mcst_row *row = g->row;
    const float *u = g->u;
    const float *p = g->p;
    const float *x = g->x;
    float back[2] = {0, 0};
    ld truth[2] = {0, 0};
    ld moved[2] = {0, 0};
    /* a few roundings; visible normals first take c = d h - i apart, with d of five */
    const double base = (row->shape == MCST_IS_VLOBE ? 16 : 8) * EPS;
    double step[2] = {0, 0};
    row->truth.invert(p, x, truth);
    row->fn[0].invert(p, x, back);
    CHECK(back[0] >= 0 && back[0] < 1 && back[1] >= 0 && back[1] < 1, "u %a %a: invert gives %a %a", (double)u[0],
          (double)u[1], (double)back[0], (double)back[1]);
    /* what 8 ulp in each coordinate do to the exact inverse: its arithmetic takes about as many roundings */
    for (int k = 0; k < 2 * row->dim; k++) {
        float y[3];
        memcpy(y, x, sizeof y);
        y[k / 2] *= k % 2 ? 1 + 8 * 0x1p-23f : 1 - 8 * 0x1p-23f;
        row->truth.invert(p, y, moved);
        for (int i = 0; i < row->inputs; i++)
            step[i] = fmax(step[i], u_error(row, i, (double)moved[i], (double)truth[i]));
    }
    for (int i = 0; i < row->inputs; i++) {
        const double d = u_error(row, i, (double)back[i], (double)truth[i]);
        const double trip = u_error(row, i, (double)back[i], (double)u[i]);
        if (x[0] == 0 && x[1] == 0 && is_azimuth(row, i)) continue; /* without a radius there is no azimuth */
        CHECK(within(INVERT, d, base + 2 * step[i]), "u %a %a: invert u%d %.9g, exact %.9Lg", (double)u[0],
              (double)u[1], i + 1, (double)back[i], truth[i]);
        /* the trip back: the roundings of the point, then those of its inverse */
        CHECK(within(ROUND_TRIP, trip, base + 2 * step[i]), "u%d of %a %a comes back as %a", i + 1, (double)u[0],
              (double)u[1], (double)back[i]);
    }
}
static void check_point(const mcst_row *row, const float *p, const float *u, ld peak, double extent) {
    const ld pdf_u = row->truth.pdf_u(p, u[0], u[1]);
    grid_point g;
    memset(&g, 0, sizeof g);
    g.row = row;
    g.p = p;
    g.u = u;
    g.peak = peak;
    g.extent = extent;
    row->truth.map(p, u[0], u[1], g.exact);
    if (row->traits & MCST_VISIBLE) g.magnified = magnification(p, row, g.exact);
    row->fn[0].sample(p, &u[0], &u[1], g.out);
    const float *out = g.out;
    const float *x = g.x;
    for (int i = 0; i < 3; i++) g.x[i] = out[i];
    for (int i = 0; i < 5; i++)
        CHECK(isfinite(out[i]), "u %a %a: out[%d] = %g", (double)u[0], (double)u[1], i, (double)out[i]);
    check_where(&g);
    if (row->dim == 3) {
        const ld l2 = (ld)x[0] * x[0] + (ld)x[1] * x[1] + (ld)x[2] * x[2];
        CHECK(within(UNIT, fabs((double)(sqrtl(l2) - 1)), 4 * EPS), "u %a %a: length - 1 = %Lg", (double)u[0],
              (double)u[1], sqrtl(l2) - 1);
    }
    if (row->shape == MCST_IS_LOBE || row->shape == MCST_IS_VLOBE) check_width(&g);
    /* the returned density belongs to u */
    double tol = mcst_claim_of(row, CLAIM_PDF_U, p) * pdf_tol(pdf_u, peak);
    if (row->shape != MCST_IS_BRDF ||
        fabsl(g.exact[2]) > 40 * EPS) /* otherwise above or below the horizon is a matter of rounding */
        CHECK(near(PDF_U, out[3], pdf_u, tol, peak), "u %a %a: pdf %.9g, exact %.9Lg (%.3g, tolerance %.3g)",
              (double)u[0], (double)u[1], (double)out[3], pdf_u, (double)((ld)out[3] / pdf_u - 1), tol);
    if (row->shape == MCST_IS_BRDF && !(out[3] > 0)) {
        CHECK(out[4] == 0, "lost, but weight %g", (double)out[4]);
        return;
    }
    /* _pdf belongs to the float point */
    const ld pdf_x = row->truth.pdf(p, x);
    float pdf;
    row->fn[0].pdf(p, x, &pdf);
    if (pdf_x == 0 && (row->shape == MCST_IS_PLANE || row->shape == MCST_IS_DIR || row->shape == MCST_IS_VLOBE)) {
        check_rim(&g, pdf);
        return;
    }
    tol = mcst_claim_of(row, CLAIM_PDF_W, p) * direction_tol(row, p, x, pdf_x, peak);
    CHECK(near(PDF_X, pdf, pdf_x, tol, peak), "u %a %a: pdf(x) %.9g, exact %.9Lg (%.3g, tolerance %.3g)", (double)u[0],
          (double)u[1], (double)pdf, pdf_x, (double)((ld)pdf / pdf_x - 1), tol);
    if (row->fn[0].eval) check_values(&g, pdf, pdf_x);
    if (row->fn[0].invert) check_inverse(&g);
}

/* Directions that the sampler would never pick: density and weight must be as exact there. */
static void check_far(const mcst_row *row, const float *p, uint64_t seed, ld peak) {
    for (int i = 0; i < 40; i++) {
        float u[2];
        mcst_uniform(&seed, 1, &u[0], &u[1]);
        float x[3];
        x[2] = i < 30 ? u[0] : i < 35 ? 1e-4f * u[0] : -u[0];
        const double r = sqrt(1 - (double)x[2] * (double)x[2]);
        x[0] = (float)(r * cos(6.283185307179586 * (double)u[1]));
        x[1] = (float)(r * sin(6.283185307179586 * (double)u[1]));
        const ld want = row->truth.pdf(p, x);
        float pdf;
        row->fn[0].pdf(p, x, &pdf);
        double tol = mcst_claim_of(row, CLAIM_PDF_W, p) * direction_tol(row, p, x, want, peak);
        CHECK(near(PDF_FAR, pdf, want, tol, peak), "pdf at %.9g %.9g %.9g: %.9g, exact %.9Lg (%.3g)", (double)x[0],
              (double)x[1], (double)x[2], (double)pdf, want, (double)((ld)pdf / want - 1));
        if (row->fn[0].eval) { /* also 0 where the density is */
            const ld w = row->truth.weight(p, x);
            float weight;
            row->fn[0].weight(p, x, &weight);
            tol = mcst_claim_of(row, CLAIM_WEIGHT, p) * 1e-6;
            CHECK(near(WEIGHT_X, weight, w, tol, 1), "weight at %.9g %.9g %.9g: %.9g, exact %.9Lg", (double)x[0],
                  (double)x[1], (double)x[2], (double)weight, w);
        }
    }
}

static void check_accuracy(const mcst_row *row, const float *p, uint64_t seed) {
    static float u[MAX_U][2];
    const int n = make_u(row, seed, u);
    ld peak = 0;
    double extent = 0;
    for (int i = 0; i < n; i++) {
        const ld pdf = row->truth.pdf_u(p, u[i][0], u[i][1]);
        ld x[3];
        row->truth.map(p, u[i][0], u[i][1], x);
        extent = fmax(extent, fabs((double)x[0]));
        if (pdf > peak && pdf < 1e300L) peak = pdf;
    }
    asserted = 0;
    for (int i = 0; i < n; i++) check_point(row, p, u[i], peak, extent);
    if (row->dim == 3) check_far(row, p, seed, peak);
    CHECK(asserted == 0, "good parameters asserted %d times", asserted);
}

/* --- check 5: bad input ------------------------------------------------------------------------------------------- */

static const float odd[] = {0,      -0.0f, 1,      -1,           2,       -2,      0.5f,    0x1p-149f, -0x1p-149f,
                            1e-30f, 1e30f, 1e-10f, 1 - 0x1p-24f, FLT_MIN, FLT_MAX, -FLT_MAX};
enum { ODD = 16 };

static float odd_number(uint64_t *state) {
    const uint64_t z = mcst_mix(state);
    const unsigned k = (unsigned)(z % (ODD + 6));
    if (k < ODD) return odd[k];
    if (k == ODD) return NAN;
    if (k == ODD + 1) return INFINITY;
    if (k == ODD + 2) return -INFINITY;
    if (k == ODD + 3) { /* any bit pattern */
        const uint32_t bits = (uint32_t)(z >> 32);
        float f;
        memcpy(&f, &bits, sizeof f);
        return f;
    }
    return (float)(int32_t)(z >> 40) * 0x1p-24f;
}

static int finite5(const float *out) {
    return isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2]) && isfinite(out[3]) && isfinite(out[4]) &&
           out[3] >= 0 && out[4] >= 0;
}

/* One call of everything with p, u, x: all results finite, densities, weights and values not negative, inverses in
 * [0,1). */
static void call_all(const mcst_row *row, const float *p, const float *u, const float *x, float out[5]) {
    float v[2] = {0, 0};
    memset(out, 0, 5 * sizeof *out);
    row->fn[0].sample(p, &u[0], &u[1], out);
    CHECK(finite5(out), "sample p %g %g, wo %g %g %g, u %g %g: %g %g %g, pdf %g, weight %g", (double)p[0], (double)p[1],
          (double)p[3], (double)p[4], (double)p[5], (double)u[0], (double)u[1], (double)out[0], (double)out[1],
          (double)out[2], (double)out[3], (double)out[4]);
    row->fn[0].pdf(p, x, v);
    CHECK(isfinite(v[0]) && v[0] >= 0, "pdf p %g %g, wo %g %g %g, x %g %g %g: %g", (double)p[0], (double)p[1],
          (double)p[3], (double)p[4], (double)p[5], (double)x[0], (double)x[1], (double)x[2], (double)v[0]);
    if (row->fn[0].invert) {
        v[0] = v[1] = 0;
        row->fn[0].invert(p, x, v);
        CHECK(v[0] >= 0 && v[0] < 1 && v[1] >= 0 && v[1] < 1, "invert p %g %g, wo %g %g %g, x %g %g %g: %g %g",
              (double)p[0], (double)p[1], (double)p[3], (double)p[4], (double)p[5], (double)x[0], (double)x[1],
              (double)x[2], (double)v[0], (double)v[1]);
    }
    if (row->fn[0].eval) {
        row->fn[0].eval(p, x, &v[0]);
        row->fn[0].weight(p, x, &v[1]);
        CHECK(isfinite(v[0]) && v[0] >= 0 && isfinite(v[1]) && v[1] >= 0,
              "p %g %g, wo %g %g %g, wi %g %g %g: eval %g, weight %g", (double)p[0], (double)p[1], (double)p[3],
              (double)p[4], (double)p[5], (double)x[0], (double)x[1], (double)x[2], (double)v[0], (double)v[1]);
    }
}

/* Bad by the interface: pdf and weight are 0. */
static void must_be_zero(const mcst_row *row, const float *p, const float *u, const char *why) {
    float out[5];
    call_all(row, p, u, (const float[3]){0.6f, 0, 0.8f}, out);
    CHECK(out[3] == 0 && out[4] == 0, "%s: p %g %g, wo %g %g %g, u %g %g: pdf %g, weight %g", why, (double)p[0],
          (double)p[1], (double)p[3], (double)p[4], (double)p[5], (double)u[0], (double)u[1], (double)out[3],
          (double)out[4]);
}

static void pdf_must_be_zero(const mcst_row *row, const float *p, const float *x, const char *why) {
    float v;
    row->fn[0].pdf(p, x, &v);
    CHECK(v == 0, "%s: pdf %g at %g %g %g, p %g %g, wo %g %g %g", why, (double)v, (double)x[0], (double)x[1],
          (double)x[2], (double)p[0], (double)p[1], (double)p[3], (double)p[4], (double)p[5]);
    if (row->fn[0].eval) {
        row->fn[0].eval(p, x, &v);
        CHECK(v == 0, "%s: eval %g", why, (double)v);
        row->fn[0].weight(p, x, &v);
        CHECK(v == 0, "%s: weight %g", why, (double)v);
    }
}

/* Every function is to report a parameter out of range. */
static void must_assert(const mcst_row *row, const float *p, const float *u, const float *x) {
    static const char *const name[] = {"sample", "pdf", "invert", "eval", "weight"};
    const mcst_fns *f = &row->fn[0];
    float out[5];
    for (int i = 0; i < 5; i++) {
        asserted = 0;
        if (i == 0) f->sample(p, &u[0], &u[1], out);
        else if (i == 1) f->pdf(p, x, out);
        else if (i == 2 && f->invert) f->invert(p, x, out);
        else if (i == 3 && f->eval) f->eval(p, x, out);
        else if (i == 4 && f->weight) f->weight(p, x, out);
        else continue;
        CHECK(asserted > 0, "%s(%g, %g) does not assert", name[i], (double)p[0], (double)p[1]);
    }
}

static const float fine[2] = {0.3f, 0.6f}, side[3] = {0.36f, 0.48f, 0.8f};

static void check_bad_u(const mcst_row *row, const float *p) {
    static const float bad_u[] = {-1, -0x1p-149f, 1, 1.5f, -FLT_MAX, FLT_MAX};
    for (int i = 0; i < 9; i++) {
        const float v = i < 6 ? bad_u[i] : i == 6 ? NAN : i == 7 ? INFINITY : -INFINITY;
        for (int j = 0; j < row->inputs; j++) {
            float u[2] = {0.3f, 0.6f};
            u[j] = v;
            must_be_zero(row, p, u, "bad u");
        }
    }
    for (int j = 0; j < 2; j++) { /* -0 is 0 */
        float u[2] = {0.3f, 0.6f};
        u[j] = 0;
        float zero[5];
        call_all(row, p, u, side, zero);
        u[j] = -0.0f;
        float out[5];
        call_all(row, p, u, side, out);
        CHECK(out[3] == zero[3] && out[0] == zero[0] && out[1] == zero[1] && out[2] == zero[2],
              "u%d = -0 is not 0: pdf %g and %g", j + 1, (double)out[3], (double)zero[3]);
    }
}

static void check_bad_wo(const mcst_row *row, const float *p) {
    static const float bad_wo[][3] = {{0, 0, 0},          {0, 0, -1},           {0.6f, 0, -0.8f},    {1, 0, 0},
                                      {1, 0, -0x1p-149f}, {-0.6f, 0.8f, -0.0f}, {6e-31f, 0, 8e-31f}, {6e29f, 0, 8e29f}};
    for (int i = 0; i < 8 + 9; i++) {
        float q[MCST_P];
        memcpy(q, p, sizeof q);
        if (i < 8) memcpy(q + 3, bad_wo[i], sizeof bad_wo[i]);
        else q[3 + (i - 8) % 3] = i < 11 ? NAN : i < 14 ? INFINITY : -INFINITY;
        must_be_zero(row, q, fine, "bad wo");
        pdf_must_be_zero(row, q, side, "bad wo");
    }
}

static void check_bad_points(const mcst_row *row, const float *p) {
    static const float bad_wi[][3] = {{0, 0, -1}, {0.6f, 0, -0.8f}, {1, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < 3 * row->dim; i++) {
        float x[3] = {0.36f, 0.48f, 0.8f};
        x[i % row->dim] = i < row->dim ? NAN : i < 2 * row->dim ? INFINITY : -INFINITY;
        pdf_must_be_zero(row, p, x, "bad point");
        if (row->fn[0].invert && i < row->dim) { /* of NaN; infinity is past the end of a line */
            float v[2] = {0, 0};
            row->fn[0].invert(p, x, v);
            CHECK(v[0] == 0 && v[1] == 0, "NaN for coordinate %d: invert gives %g %g", i, (double)v[0], (double)v[1]);
        }
    }
    for (int i = 0; row->shape == MCST_IS_BRDF && i < 4; i++)
        pdf_must_be_zero(row, p, bad_wi[i], "wi not above the surface");
}

static void check_bad_parameters(const mcst_row *row, const float *p) {
    static const float bad_parameter[] = {0, -0.0f, -0x1p-149f, -1, -FLT_MAX, 3};
    for (int i = 0; i < 7; i++) {
        const float v = i < 6 ? bad_parameter[i] : NAN;
        for (int j = 0; j < row->params; j++) {
            float q[MCST_P];
            memcpy(q, p, sizeof q);
            q[j] = v;
            if (row->domain.bad(j, v) != 1 && !mcst_bad_together(row, q)) continue;
            must_be_zero(row, q, fine, "bad parameter");
            pdf_must_be_zero(row, q, side, "bad parameter");
            must_assert(row, q, fine, side);
        }
    }
}

static void check_odd_numbers(const mcst_row *row, const float *p) {
    uint64_t state = mcst_seed_for(row->name, "odd", 0);
    const int rounds = (int)(6000 * fmin(1, mcst_scale()));
    for (int k = 0; k < rounds; k++) {
        float q[MCST_P];
        memcpy(q, p, sizeof q);
        float u[2];
        memcpy(u, fine, sizeof u);
        float x[3];
        memcpy(x, side, sizeof x);
        for (int i = 0; i < 11; i++) { /* a third of all inputs are odd */
            float *slot = i < 6 ? &q[i] : i < 8 ? &u[i - 6] : &x[i - 8];
            if (mcst_mix(&state) % 3 == 0) *slot = odd_number(&state);
        }
        float out[5];
        call_all(row, q, u, x, out);
    }
}

static void check_bad_input(const mcst_row *row) {
    float p[MCST_P];
    mcst_fill(row, row->grid[0][0], row->grid[0][1], 0.70710678f, 0.7f, p);
    if (mcst_case("u outside [0,1)")) check_bad_u(row, p);
    if (row->has_wo && mcst_case("wo below the surface or no direction")) check_bad_wo(row, p);
    if (mcst_case("a point or direction that is none")) check_bad_points(row, p);
    if (row->params && mcst_case("parameters out of range")) check_bad_parameters(row, p);
    if (mcst_case("odd numbers everywhere")) check_odd_numbers(row, p);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("claims");
    if (mcst_case("the header states them"))
        for (size_t i = 0; i < MCST_COUNT(mcst_claim_sentences); i++)
            CHECK(mcst_header_says(MCS_HEADER, mcst_claim_sentences[i]), "not in %s: %s", MCS_HEADER,
                  mcst_claim_sentences[i]);
    for (size_t i = 0; i < MCST_NROWS; i++) {
        const mcst_row *row = &mcst_rows[i];
        mcst_group(row->name);
        memset(worst, 0, sizeof worst);
        float p[MCST_P];
        for (size_t j = 0; j < mcst_grid_count(row); j++) {
            mcst_grid_get(row, j, p);
            describe(row, p);
            if (mcst.open) check_accuracy(row, p, mcst_seed_for(row->name, "accuracy", j));
        }
        mcst_note("  %-14s", row->name);
        for (int k = 0; k < ERRORS; k++) mcst_note(" %s %.2f", error_name[k], worst[k]);
        mcst_note("\n");
        char group[64];
        snprintf(group, sizeof group, "%s mass", row->name);
        mcst_group(group);
        for (size_t j = 0; j < row->chi_size + row->grid_size; j++) {
            const mcst_set *set = &row->chi[j];
            const size_t g = j - row->chi_size;
            /* the sets of the chi-square test, then every set of parameters at one incidence each */
            if (j < row->chi_size) mcst_fill(row, set->a, set->b, set->cos_o, set->azimuth, p);
            else mcst_grid_get(row, row->has_wo ? g + row->grid_size * (g % 7) : g, p);
            if (!mcst_mass_resolved(row, p)) { /* at 45 degrees instead, where half-vectors are known better */
                if (!row->has_wo) continue;
                mcst_fill(row, p[0], p[1], 0.70710678f, 0.7f, p);
                if (!mcst_mass_resolved(row, p)) continue;
            }
            describe(row, p);
            if (!mcst.open) continue;
            check_mass(row, p);
            check_rough(row, p, j < row->chi_size);
        }
        snprintf(group, sizeof group, "%s bad input", row->name);
        mcst_group(group);
        check_bad_input(row);
    }
    mcst_group("");
    if (mcst_masses_skipped && !mcst.list) printf("SKIPPED: %d masses, named above\n", mcst_masses_skipped);
    return mcst_finish();
}
