/* Extremes: every sampler and density over the product of the ends of its parameters, incidences and random numbers,
 * against __float128 (exact.h). That the maps of that truth have its densities is checked first, by numerical
 * Jacobians.
 *
 * Inputs are the literal floats; directions are not made unit, and half-vectors are wo + wi. Densities are judged
 * relative to E = 1e-6 (1 + |ln(pdf/peak)|), because a density e^-x has the rounding of x in it. Where that is
 * exceeded, the bound is widened by what the exact density itself does when the inputs move by half an ulp (ROUNDINGS
 * below); such points are counted and both figures are printed. Lines, planes and lights are held to the figures that the
 * header states, and nothing widens those.
 *
 * --filter picks a row or a case; MCS_TEST_SCALE scales the number of u. */
#include "claims.h"
#include "exact.h"
#include "mass.h"

#define EPS 0x1p-24 /* half an ulp of 1 */
/* Where inputs cancel, so do their descendants: each component of a half-vector carries 3 half ulps (sine or cosine,
 * root, product; column `where` of the lobes), its product with wo one more. So the conditioning term is this many
 * times the exact answer's change when the inputs move by half an ulp. */
#define ROUNDINGS 4
/* Errors are judged where both cosines are at least this. Below, products and squares of cosines leave the normal
 * floats; results must be finite and directions unit there, too, and the errors are printed as a line of their own. */
#define LEAST_COSINE 9.9e-16f

/* --- does the oracle agree with itself? --------------------------------------------------------------------------- */

/* The density at map(u) times the area of the map there, by central differences: 1. */
static qd density_times_area(const mcst_row *row, const setting *s, qd u1, qd u2) {
    const qd step = 1e-9;
    q3 x, d[4];
    exact_map(row, s, u1, u2, &x);
    exact_map(row, s, u1 - step, u2, &d[0]), exact_map(row, s, u1 + step, u2, &d[1]);
    exact_map(row, s, u1, u2 - step, &d[2]), exact_map(row, s, u1, u2 + step, &d[3]);
    d[0] = times(1 / (2 * step), add(d[1], times(-1, d[0]))), d[2] = times(1 / (2 * step), add(d[3], times(-1, d[2])));
    return exact_pdf(row, s, x) * (row->inputs == 1 ? fabsq(d[0].x + d[0].y) : len(cross(d[0], d[2])));
}

/* --- the grid ----------------------------------------------------------------------------------------------------- */

/* Alphas beyond both limits of the header, anisotropy 1e4 and more; exponents likewise. */
static const float alphas[][2] = {{1e-8f, 1e-8f}, {1e-7f, 1e-7f}, {1e-6f, 1e-6f}, {1e-5f, 1e-5f}, {1e-3f, 1e-3f},
                                  {0.01f, 0.01f}, {0.1f, 0.1f},   {0.3f, 0.3f},   {1, 1},         {3, 3},
                                  {100, 100},     {1e4f, 1e4f},   {1e5f, 1e5f},   {1e-7f, 1e-3f}, {1e-3f, 1e-7f},
                                  {1e-6f, 0.01f}, {1e-4f, 1},     {1, 1e-4f},     {0.1f, 1e3f},   {100, 0.01f},
                                  {1e4f, 1},      {0.01f, 1},     {1e-7f, 1e4f}};
static const float exponents[][2] = {
    {0, 0},       {0x1p-149f, 1e-30f}, {0.5f, 0.5f}, {1, 1},    {10, 10},  {1e3f, 1e3f}, {1e5f, 1e5f}, {1e7f, 1e7f},
    {1e9f, 1e9f}, {1e30f, 1e30f},      {0, 1e9f},    {1e9f, 0}, {1, 1e4f}, {1e4f, 1},    {1e5f, 1e9f}, {10, 1000}};
/* Beyond the grid of the registry. */
static const float line_more[][3] = {{ID_linear, 0x1p-149f, 1},
                                     {ID_linear, FLT_MAX, 1},
                                     {ID_linear, FLT_MAX, FLT_MAX},
                                     {ID_linear, 0x1p-149f, 0x1p-149f},
                                     {ID_linear, 1, FLT_MAX},
                                     {ID_tent, 3e17f, 0},
                                     {ID_tent, 2e-18f, 0},
                                     {ID_exponential, 80, 0},
                                     {ID_truncexp, 1e18f, 1e18f},
                                     {ID_truncexp, 0x1p-149f, 1},
                                     {ID_truncexp, 80, 1},
                                     {ID_truncexp, 79.9f, 1},
                                     {ID_truncexp, 1e-8f, 1},
                                     {ID_truncexp, 2e-8f, 1},
                                     {ID_truncexp, 1e-18f, 1e-18f},
                                     {ID_truncexp, 1e18f, 1e-18f},
                                     {ID_normal, 1e30f, 1e18f},
                                     {ID_normal, -1e18f, 1e18f},
                                     {ID_logistic, 1e30f, 1e18f},
                                     {ID_logistic, -1e18f, 1e18f},
                                     {ID_power, 0x1p-149f, 0},
                                     {ID_power, 1e-30f, 0},
                                     {ID_evenpower, 0x1p-149f, 0},
                                     {ID_evenpower, 1e-30f, 0},
                                     {ID_cone, 1e-30f, 0},
                                     {ID_cone, 0.99999994f, 0},
                                     {ID_cone, 1.9999999f, 0},
                                     {ID_disk, 3e17f, 0},
                                     {ID_concentric, 3e17f, 0},
                                     {ID_henyey_greenstein, 0x1p-149f, 0},
                                     {ID_henyey_greenstein, -0.5f, 0},
                                     {ID_von_mises_fisher, 0x1p-149f, 0},
                                     {ID_von_mises_fisher, 0.99999994e-8f, 0},
                                     {ID_smoothstep, -1e24f, -9.999995e23f},
                                     {ID_smoothstep, 1e-30f, 1}};
static const float incidence[][2] = {{1, 0},
                                     {0.99999994f, 0},
                                     {0.99999994f, 2.2f},
                                     {0.9f, 0.4f},
                                     {0.5f, 1.5707964f},
                                     {0.5f, -2.5f},
                                     {0.1f, 0},
                                     {0.1f, 2.1f},
                                     {0.01f, 1.1f},
                                     {1e-3f, -0.4f},
                                     {1e-3f, 3.1415927f},
                                     {1e-5f, 2.8f},
                                     {1e-7f, 0},
                                     {1e-7f, 0.785f},
                                     {1e-7f, -1.5707964f},
                                     {1e-12f, 0.5f},
                                     {1e-15f, 1.9f},
                                     {1e-18f, -0.9f},
                                     {0x1p-126f, 2.0f},
                                     {0x1p-140f, -2.0f}};
static const float corners[] = {0,     0x1p-149f,   0x1p-140f, FLT_MIN,     0x1p-64f, 0x1p-24f,     0x1p-12f,    0.125f,
                                0.25f, 0.49999997f, 0.5f,      0.50000006f, 0.75f,    1 - 0x1p-12f, 1 - 0x1p-24f};
enum { CORNERS = 15, U_MAX = CORNERS * CORNERS + 64 * 64 };

static int make_u(const mcst_row *row, uint64_t seed, int strata, float (*u)[2]) {
    const int lines = row->inputs == 1;
    int i, j, n = 0;
    for (i = 0; i < CORNERS; i++)
        for (j = 0; j < (lines ? 1 : CORNERS); j++, n++) u[n][0] = corners[i], u[n][1] = corners[j];
    for (i = 0; i < strata * strata; i++, n++) {
        mcst_uniform(&seed, 1, &u[n][0], &u[n][1]);
        if (lines) u[n][0] = fminf(((float)i + u[n][0]) / (float)(strata * strata), 1 - 0x1p-24f);
        else {
            u[n][0] = fminf(((float)(i / strata) + u[n][0]) / (float)strata, 1 - 0x1p-24f);
            u[n][1] = fminf(((float)(i % strata) + u[n][1]) / (float)strata, 1 - 0x1p-24f);
        }
    }
    return n;
}

/* --- scores ------------------------------------------------------------------------------------------------------- */

enum { PDF_U, PDF_X, FAR_, VALUE, WEIGHT, AGREE, WHERE, SINE, DISTANCE, PLACE, SCORES };
/* Densities, values and weights in E; where, and place on a light: in half ulps of 1 (lines and disks: of the size);
 * sine and distance: relative, in 1e-6. */
static const char *const score_name[SCORES] = {"pdf(u)", "pdf(x)", "far",  "eval",     "weight",
                                               "agree",  "where",  "sine", "distance", "place"};
typedef struct {
    int beyond; /* a cosine below LEAST_COSINE: errors are recorded, not judged */
    double evaluations, nans, infinities, not_unit, zero, ill[SCORES], raw[SCORES], judged[SCORES];
    char at[SCORES][160]; /* where raw is largest */
} tally;

/* What is looked at: parameters and wo, random numbers or a direction. Formatted only where a message or a record wants
 * it, as a hundred thousand points cost seconds. */
typedef struct {
    const float *p;
    const float *at;
    int numbers; /* at `at`: 2 random numbers, or 3 coordinates */
} place_in_words;

static const char *in_words(const place_in_words *w) {
    static char text[160];
    const float *p = w->p;
    const float *at = w->at;
    const int n =
        snprintf(text, sizeof text, "p %g %g, wo %a %a %a, %s %a %a", (double)p[0], (double)p[1], (double)p[3],
                 (double)p[4], (double)p[5], w->numbers == 2 ? "u" : "w", (double)at[0], (double)at[1]);
    if (w->numbers == 3) snprintf(text + n, sizeof text - (size_t)n, " %a", (double)at[2]);
    return text;
}

/* raw: the error over its bound; judged: over the bound with its conditioning term, which is found only when needed. */
static void score(tally *t, int what, double raw, double judged, const place_in_words *where) {
    if (!(raw <= t->raw[what])) t->raw[what] = raw, snprintf(t->at[what], sizeof t->at[what], "%s", in_words(where));
    if (!(judged <= t->judged[what])) t->judged[what] = judged;
}

/* What is asked of the oracle. */
typedef struct {
    const mcst_row *row;
    const float *p;
    q3 x;      /* where the density is asked for, or */
    qd u1, u2; /* the random numbers whose sample it is */
    int of_u, what;
} question;

static qd answer(const question *q, const setting *s) {
    q3 x = q->x;
    if (q->of_u) exact_map(q->row, s, q->u1, q->u2, &x);
    if (q->what == VALUE || q->what == WEIGHT) {
        const qd f = s->wo.z > 0 && x.z > 0 ? exact_value(s, x) : 0;
        return q->what == VALUE ? f : f > 0 ? f * x.z / exact_pdf(q->row, s, x) : 0;
    }
    return exact_pdf(q->row, s, x);
}

/* Lines, planes and lights are what the floats say that are given, and the header's figures hold for them as they are.
 * Of other rows inputs may be off by half an ulp, and then the bound is 1 E. */
static int is_literal(const mcst_row *row) { return row->dim < 3 || row->traits & MCST_DISTANCE; }
static double limit_of(const question *q) {
    return is_literal(q->row) ? mcst_claim_of(q->row, q->what == PDF_U ? CLAIM_PDF_U : CLAIM_PDF_W, q->p) : 1;
}

/* The change of the exact answer, relative to it, when every input moves by half an ulp: the sum over parameters, wo
 * and, if it is the question, x. */
static double conditioning(question q, qd want) {
    if (is_literal(q.row)) return 0;
    const setting s = setting_of(q.row, q.p);
    qd sum = 0;
    int i;
    for (i = 0; i < 8; i++) {
        setting t = s;
        question r = q;
        qd *const slot[8] = {&t.a, &t.b, &t.wo.x, &t.wo.y, &t.wo.z, &r.x.x, &r.x.y, &r.x.z};
        qd worst = 0;
        int side;
        if (i >= 5 && q.of_u) continue;
        for (side = -1; side <= 1; side += 2) {
            const qd was = *slot[i];
            *slot[i] = was * (1 + side * (qd)EPS);
            worst = fmaxq(worst, fabsq(answer(&r, &t) - want));
            *slot[i] = was;
        }
        sum += worst;
    }
    return ROUNDINGS * (double)(sum / want);
}

/* Is got within E of want? Densities beyond FLT_MAX saturate. A density is its peak times a float in [0,1]: where that
 * float is subnormal its digits are gone, and all that is asked is that the density is small, too. */
static int judge(tally *t, question q, float got, qd want, double unit, double peak, const place_in_words *where) {
    const double top = want > (qd)FLT_MAX ? FLT_MAX : (double)want, floor_ = MCST_FAINT * peak + 0x1p-148;
    const double err = fabs((double)((qd)got - (want > (qd)FLT_MAX ? (qd)FLT_MAX : want))),
                 raw = err <= floor_ ? 0 : err / (unit * top);
    const double limit = limit_of(&q);
    double judged = raw / limit;
    if (!(judged <= 1)) {
        const double wider = conditioning(q, want);
        unit *= limit;
        judged = err / (top * (unit + wider));
        t->ill[q.what] += judged <= 1;
        CHECK(judged <= 1 || t->beyond,
              "%s %s: %.9g, exact %.9g, error %.3g (bound %.3g, with half an ulp of the inputs %.3g)", in_words(where),
              score_name[q.what], (double)got, top, err / top, unit, unit + wider);
    }
    score(t, q.what, raw, judged, where);
    return judged <= 1;
}
/* A bound: the digits of double will do where it has the ratio. */
static double unit_of(const mcst_row *row, qd pdf, double peak) {
    if ((row->traits & MCST_DISTANCE) || !(pdf > 0 && peak > 0)) return 1e-6;
    const qd ratio = pdf / (qd)peak;
    const int in_double = ratio > (qd)1e-300 && ratio < (qd)1e300;
    return 1e-6 * (1 + (in_double ? fabs(log((double)ratio)) : fabs((double)logq(ratio))));
}

/* How far the exact sample itself moves, in half ulps of 1, when parameters and wo move by half an ulp. */
static double movement(const mcst_row *row, const float *p, qd u1, qd u2, q3 from) {
    const setting s = setting_of(row, p);
    qd sum = 0;
    int i, side;
    for (i = 0; i < 5; i++) {
        qd worst = 0;
        for (side = -1; side <= 1; side += 2) {
            setting t = s;
            qd *const slot[5] = {&t.a, &t.b, &t.wo.x, &t.wo.y, &t.wo.z};
            q3 x;
            *slot[i] *= 1 + side * (qd)EPS;
            exact_map(row, &t, u1, u2, &x);
            worst = fmaxq(worst, len(add(x, times(-1, from))));
        }
        sum += worst;
    }
    return ROUNDINGS * (double)sum / EPS;
}

static void count_point(const mcst_row *row, const float *p, tally *t, const float s[5]) {
    const double l2 = (double)s[0] * (double)s[0] + (double)s[1] * (double)s[1] + (double)s[2] * (double)s[2];
    const double o2 = (double)p[3] * (double)p[3] + (double)p[4] * (double)p[4] + (double)p[5] * (double)p[5];
    int i;
    for (i = 0; i < 5; i++) t->nans += isnan(s[i]) != 0, t->infinities += isinf(s[i]) != 0;
    /* 4 ulp; a mirrored direction is as long as wo */
    if (row->dim == 3)
        t->not_unit += !(fabs(sqrt(l2) - 1) <= 4 * EPS + (row->shape == MCST_IS_BRDF ? fabs(sqrt(o2) - 1) : 0));
}

/* A point and its density, both exact. */
typedef struct {
    q3 x;
    qd pdf;
} exact_point;

/* A drawn point and what is exact of it. Scores go to `scores`: the second tally has what lies beyond the promises. */
typedef struct {
    const mcst_row *row;
    const setting *s;
    const float *p, *u;
    double peak, extent;
    q3 x, at;           /* the exact point; the float point */
    float w[3], out[5]; /* the float point; all that sample gives */
    qd pdf_u, pdf_x;    /* the exact density at x and at `at` */
    float pdf;          /* what _pdf gives at `at` */
    tally *scores;
    place_in_words where;
} drawn_point;

static drawn_point draw_point(const mcst_row *row, const setting *s, const float *p, const float *u,
                              const exact_point *exact, tally *t) {
    drawn_point d;
    memset(&d, 0, sizeof d);
    d.row = row;
    d.s = s;
    d.p = p;
    d.u = u;
    d.x = exact->x;
    d.pdf_u = exact->pdf;
    row->fn[0].sample(p, &u[0], &u[1], d.out);
    count_point(row, p, t, d.out);
    t->evaluations += 2;
    memcpy(d.w, d.out, sizeof d.w);
    d.at = vec(d.w[0], d.w[1], d.w[2]);
    const int grazing = p[5] < LEAST_COSINE || (row->shape == MCST_IS_BRDF && d.w[2] < LEAST_COSINE);
    d.scores = row->has_wo && grazing ? t + 1 : t;
    d.where.p = p;
    d.where.at = u;
    d.where.numbers = 2;
    return d;
}

/* Where the header states a figure for coordinates, it is that. What is subnormal in units of the range has lost
 * digits. */
static void check_coordinates(const drawn_point *d, double limit) {
    const qd exact[3] = {d->x.x, d->x.y, d->x.z};
    double err = 0;
    for (int i = 0; i < d->row->dim; i++) {
        const double off = fabs((double)((qd)d->w[i] - exact[i]));
        if (off <= 0x1p-125 * d->extent + 0x1p-148) continue;
        err = fmax(err, off / (EPS * mcst_where_scale(d->row, d->p, (double)exact[i])));
    }
    score(d->scores, WHERE, err, err / limit, &d->where);
    CHECK(err <= limit, "%s: (%.9g %.9g %.9g), exact (%.9g %.9g %.9g): %.3g half ulps, bound %.3g", in_words(&d->where),
          (double)d->w[0], (double)d->w[1], (double)d->w[2], (double)d->x.x, (double)d->x.y, (double)d->x.z, err,
          limit);
}

/* 4 ulp of 1; of a reflection (h.wo) h - wo magnifies 3 half ulps of h by 4 and adds 3 roundings. */
static void check_where(const drawn_point *d) {
    const mcst_row *row = d->row;
    const q3 x = d->x;
    if (row->claims[0].claim[CLAIM_WHERE] > 0) {
        check_coordinates(d, row->claims[0].claim[CLAIM_WHERE]);
        return;
    }
    const double err = (double)len(add(d->at, times(-1, x))) / EPS;
    const double limit = row->shape == MCST_IS_BRDF ? 16 : 8;
    if (err <= limit) {
        score(d->scores, WHERE, err, err / limit, &d->where);
        return;
    }
    const double wider = limit + movement(row, d->p, d->u[0], d->u[1], x);
    score(d->scores, WHERE, err, err / wider, &d->where);
    d->scores->ill[WHERE] += err <= wider;
    CHECK(err <= wider || d->scores->beyond, "%s: (%.9g %.9g %.9g), exact (%.9g %.9g %.9g): %.3g half ulps, bound %.3g",
          in_words(&d->where), (double)d->w[0], (double)d->w[1], (double)d->w[2], (double)x.x, (double)x.y, (double)x.z,
          err, wider);
}

/* sin(theta), and the point across the lobe in units of its width: both relative, where sin^2(theta) is a normal float
 * (u of 2^-100, which no generator makes, would need more). */
static void check_sine(const drawn_point *d) {
    const setting *s = d->s;
    const q3 x = d->x;
    const q3 at = d->at;
    const int slopes = d->row->coord == MCST_SLOPES;
    const int power = d->row->coord == MCST_COSPOWER;
    const qd b = s->id == ID_phong_lobe ? s->a : s->b;
    const qd wx = slopes ? s->a : power ? 1 / root_of(s->a + 1) : 1;
    const qd wy = slopes ? s->b : power ? 1 / root_of(b + 1) : 1;
    const qd sine = root_of(x.x * x.x + x.y * x.y);
    const qd got = root_of(at.x * at.x + at.y * at.y);
    if (!(sine * sine > 0x1p-124)) return;
    const double across = (double)(root_of(square((at.x - x.x) / wx) + square((at.y - x.y) / wy)) /
                                   root_of(square(x.x / wx) + square(x.y / wy)));
    const double along = fabs((double)(got / sine - 1));
    const double rel = fmax(across, along) / 1e-6;
    if (rel <= 1) {
        score(d->scores, SINE, rel, rel, &d->where);
        return;
    }
    /* of visible normals h = c + i is a sum: relative to the whole of it, not to what is left */
    const double whole = (double)(sine * fminq(1, fminq(wx, wy) / fmaxq(wx, wy)));
    const double wider = 1 + movement(d->row, d->p, d->u[0], d->u[1], x) * EPS / whole / 1e-6;
    score(d->scores, SINE, rel, rel / wider, &d->where);
    d->scores->ill[SINE] += rel <= wider;
    CHECK(rel <= wider || d->scores->beyond,
          "%s: sin(theta) %.9g, exact %.9g: off by %.3g along, %.3g across the lobe (bound %.3g)", in_words(&d->where),
          (double)got, (double)sine, along, across, 1e-6 * wider);
}

/* Is the sample kept? A lost one has density and weight 0; near the horizon either is right. */
static int check_kept(const drawn_point *d) {
    const int lost = d->row->shape == MCST_IS_BRDF && !(d->x.z > 0);
    const int at_horizon = fabsq(d->x.z) <= 40 * (qd)EPS;
    if (d->row->shape != MCST_IS_BRDF || !(lost || at_horizon)) return 1;
    CHECK(!lost || d->out[3] == 0 || at_horizon, "%s: lost, but pdf %g", in_words(&d->where), (double)d->out[3]);
    if (!(d->out[3] > 0)) {
        CHECK(d->out[4] == 0, "%s: lost, but weight %g", in_words(&d->where), (double)d->out[4]);
        return 0;
    }
    return !lost;
}

static question question_of(const drawn_point *d, int what) {
    question q;
    q.row = d->row;
    q.p = d->p;
    q.u1 = d->u[0];
    q.u2 = d->u[1];
    q.x = d->at;
    q.of_u = what == PDF_U;
    q.what = what;
    return q;
}

/* The returned density belongs to u, _pdf to the float point, and the two differ by the rounding of the point alone.
 * Returns whether there is more to ask. */
static int check_densities(drawn_point *d, tally *t) {
    const double peak = d->peak;
    tally *const g = d->scores;
    if (d->row->dim < 3 && d->pdf_u == 0 && d->out[3] == 0) return 0; /* the density is 0 there */
    if (d->out[3] == 0 && d->pdf_u > (qd)(MCST_FAINT * peak + 0x1p-148)) t->zero++;
    const double unit_u = unit_of(d->row, d->pdf_u, peak);
    if (!judge(g, question_of(d, PDF_U), d->out[3], d->pdf_u, unit_u, peak, &d->where)) return 0;
    d->row->fn[0].pdf(d->p, d->w, &d->pdf);
    d->pdf_x = exact_pdf(d->row, d->s, d->at);
    if (d->row->traits & MCST_DISTANCE && light_at_rim(&d->s->light, d->at)) return 0; /* either is right */
    if (d->pdf_x == 0 && d->row->traits & MCST_DISTANCE) {
        CHECK(d->pdf == 0, "%s: pdf(x) %.9g where the light is missed", in_words(&d->where), (double)d->pdf);
        return 0;
    }
    if (d->pdf_x == 0) { /* rounded over the rim of disk, cone or cap: 0 or what is inside */
        CHECK(d->pdf >= 0 && (double)d->pdf <= (double)d->pdf_u * 1.001, "%s: pdf(x) %.9g on the rim, %.9g inside",
              in_words(&d->where), (double)d->pdf, (double)d->pdf_u);
        return 0;
    }
    const double unit_x = unit_of(d->row, d->pdf_x, peak);
    judge(g, question_of(d, PDF_X), d->pdf, d->pdf_x, unit_x, peak, &d->where);
    if (d->out[3] > FLT_MIN && d->pdf > FLT_MIN && d->pdf < FLT_MAX && (double)d->pdf_x > 0x1p-120 * peak) {
        const double ratio = (double)((qd)d->pdf / (qd)d->out[3] / (d->pdf_x / d->pdf_u));
        score(g, AGREE, fabs(ratio - 1) / (unit_u + unit_x), 0, &d->where);
    }
    return 1;
}

static void check_value(const drawn_point *d, tally *t) {
    tally *const g = d->scores;
    const qd f = exact_value(d->s, d->at);
    const qd weight = f > 0 ? f * d->at.z / d->pdf_x : 0;
    float value = 0;
    float v = 0;
    d->row->fn[0].eval(d->p, d->w, &value);
    d->row->fn[0].weight(d->p, d->w, &v);
    t->evaluations += 2;
    judge(g, question_of(d, VALUE), value, f, unit_of(d->row, d->pdf_x, d->peak), d->peak * (double)(f / d->pdf_x),
          &d->where);
    if (!(f > 0)) return;
    judge(g, question_of(d, WEIGHT), v, weight, 1e-6, 0, &d->where);
    /* the weight of the sample is a function of the cosines; wi.z is known to half an ulp of 1 */
    if (!g->beyond)
        CHECK(fabs((double)((qd)d->out[4] / fminq(weight, FLT_MAX)) - 1) <= 2e-6 + 40 * EPS / (double)d->w[2] ||
                  weight < (qd)0x1p-100,
              "%s: weight %.9g, exact %.9g", in_words(&d->where), (double)d->out[4], (double)weight);
}

static void check_distance(const drawn_point *d) {
    const place at = light_seen(&d->s->light, d->u[0], d->u[1]);
    double err = at.distance == 0 ? (double)d->out[4] : fabs((double)((qd)d->out[4] / at.distance - 1)) / 1e-6;
    double limit = mcst_claim_of(d->row, CLAIM_DISTANCE, d->p);
    score(d->scores, DISTANCE, err, err / limit, &d->where);
    CHECK(err <= limit, "%s: distance %.9g, exact %.9g", in_words(&d->where), (double)d->out[4], (double)at.distance);
    if (1 / d->pdf_u < (qd)1e-12) return; /* nothing is promised of the place */
    const given_light given = row_light(d->s->id, d->p[0], d->p[1]);
    const mcs_light_point s = header_sample(&given, d->u[0], d->u[1]);
    err = (double)fmaxq(fabsq(s.x - at.x), fabsq(s.y - at.y)) / EPS;
    limit = mcst_claim_of(d->row, CLAIM_PLACE, d->p);
    score(d->scores, PLACE, err, err / limit, &d->where);
    CHECK(err <= limit, "%s: at %.9g %.9g of the light, exact %.9g %.9g", in_words(&d->where), (double)s.x, (double)s.y,
          (double)at.x, (double)at.y);
}

static void check_point(drawn_point *d, tally *t) {
    for (int i = 0; i < 5; i++)
        CHECK(isfinite(d->out[i]), "%s: out[%d] = %g", in_words(&d->where), i, (double)d->out[i]);
    check_where(d);
    if (d->row->traits & MCST_DISTANCE) check_distance(d);
    else if (d->row->dim == 3 && d->row->shape != MCST_IS_BRDF) check_sine(d);
    if (check_kept(d) && check_densities(d, t) && d->row->fn[0].eval) check_value(d, t);
}

/* Directions that the sampler does not pick: mirrored, opposed, back, across, grazing, below, and any. */
static void check_far(const mcst_row *row, const setting *s, const float *p, uint64_t seed, double peak, tally *t) {
    static const float z_of[] = {1, 0.9f, 0.3f, 0.01f, 1e-4f, 1e-7f, 1e-12f, 1e-18f, 1e-30f, 0x1p-140f, 0, -0.5f};
    int i;
    for (i = 0; i < 44; i++) {
        question q;
        float w[3], pdf = -1, u, v;
        const place_in_words where = {p, w, 3};
        tally *g = t;
        qd want;
        mcst_uniform(&seed, 1, &u, &v);
        if (i < 24) {
            const double z = (double)z_of[i / 2], r = sqrt(1 - z * z),
                         l = sqrt((double)p[3] * (double)p[3] + (double)p[4] * (double)p[4]);
            const double side = i % 2 ? 1 : -1; /* away from wo, or towards it */
            w[0] = (float)(l > 0 ? side * r * (double)p[3] / l : r),
            w[1] = (float)(l > 0 ? side * r * (double)p[4] / l : 0), w[2] = (float)z;
        } else if (i == 24) w[0] = -p[3], w[1] = -p[4], w[2] = p[5];
        else if (i == 25) w[0] = p[3], w[1] = p[4], w[2] = p[5];
        else if (i == 26) w[0] = -p[3], w[1] = -p[4], w[2] = -p[5];
        else if (i == 27) w[0] = -p[4], w[1] = p[3], w[2] = p[5];
        else {
            const double z = (double)u, r = sqrt(1 - z * z);
            w[0] = (float)(r * cos(6.283185307179586 * (double)v)),
            w[1] = (float)(r * sin(6.283185307179586 * (double)v)), w[2] = u;
        }
        q.row = row, q.p = p, q.x = vec(w[0], w[1], w[2]), q.u1 = q.u2 = 0, q.of_u = 0, q.what = FAR_;
        if ((row->has_wo && p[5] < LEAST_COSINE) || (w[2] > 0 && w[2] < LEAST_COSINE)) g = t + 1;
        row->fn[0].pdf(p, w, &pdf);
        t->evaluations++, t->nans += isnan(pdf) != 0, t->infinities += isinf(pdf) != 0;
        want = exact_pdf(row, s, q.x);
        if (row->shape == MCST_IS_VLOBE && want == 0) continue; /* the rim of the cap: see check_point */
        if (row->traits & MCST_DISTANCE && light_at_rim(&s->light, q.x)) continue;
        if (s->id == ID_cone && fabsq((1 - q.x.z / len(q.x)) / s->a - 1) < (qd)1e-6) continue; /* the rim of the cone */
        judge(g, q, pdf, want, unit_of(row, want, peak), peak, &where);
        if (row->fn[0].eval && w[2] > 0) {
            const qd f = exact_value(s, q.x);
            float value = -1, weight = -1;
            row->fn[0].eval(p, w, &value), row->fn[0].weight(p, w, &weight);
            t->evaluations += 2;
            t->nans += isnan(value) || isnan(weight), t->infinities += isinf(value) || isinf(weight);
            CHECK(value >= 0 && weight >= 0 && value <= FLT_MAX && weight <= FLT_MAX, "%s: eval %g, weight %g",
                  in_words(&where), (double)value, (double)weight);
            q.what = VALUE;
            judge(g, q, value, f, unit_of(row, want, peak), want > 0 ? peak * (double)(f / want) : 0, &where);
        }
    }
}

/* Directions next to the rim of a light, inside and outside, by angles and by shares of its size. */
static void check_rim(const mcst_row *row, const setting *s, const float *p, uint64_t seed, tally *t) {
    static const float beyond[] = {0x1p-26f, 0x1p-24f, 0x1.8p-24f, 0x1p-23f, 0x1.4p-23f, 0x1.8p-23f,
                                   0x1p-22f, 0x1p-21f, 0x1p-19f,   0x1p-15f, 1e-3f,      0.1f};
    const q3 middle = light_seen(&s->light, (qd)0.5, (qd)0.5).w;
    for (int i = 0; i < 256; i++) {
        float along;
        float across;
        mcst_uniform(&seed, 1, &along, &across);
        const qd end = i / 2 % 2;
        const q3 rim = light_seen(&s->light, i % 2 ? end : along, i % 2 ? along : end).w;
        const q3 way = minus(rim, middle);
        if (!(len(way) > (qd)1e-20)) continue;
        for (size_t k = 0; k < 4 * MCST_COUNT(beyond); k++) {
            const qd step = (k % 2 ? 1 : -1) * (qd)beyond[k / 4];
            const q3 at = add(rim, times(k / 2 % 2 ? step : step / len(way), way));
            const q3 w = times(1 / len(at), at);
            const float x[3] = {(float)w.x, (float)w.y, (float)w.z};
            const place_in_words where = {p, x, 3};
            float pdf = -1;
            question q;
            q.row = row;
            q.p = p;
            q.x = vec(x[0], x[1], x[2]);
            q.u1 = q.u2 = 0;
            q.of_u = 0;
            q.what = FAR_;
            if (light_at_rim(&s->light, q.x)) continue;
            row->fn[0].pdf(p, x, &pdf);
            t->evaluations++;
            const qd want = exact_pdf(row, s, q.x);
            CHECK(want > 0 || pdf == 0, "%s: pdf %.9g, but it misses by %.3g", in_words(&where), (double)pdf,
                  (double)light_miss(&s->light, q.x));
            if (want > 0) judge(t, q, pdf, want, 1e-6, 0, &where);
        }
    }
}

/* Many samples by the array form, without the oracle: finite, unit, and no density 0 that is not lost. */
static void sweep(const mcst_row *row, const float *p, uint64_t seed, size_t blocks, tally *t) {
    enum { N = 4096 };
    static float u[2][N], out[5][N];
    float *const to[5] = {out[0], out[1], out[2], out[3], out[4]};
    size_t b, i;
    int j;
    memset(out, 0, sizeof out);
    for (b = 0; b < blocks; b++) {
        mcst_uniform(&seed, N, u[0], u[1]);
        for (i = 0; i < CORNERS; i++) u[0][i] = corners[i], u[1][N - 1 - i] = corners[i];
        row->sample_n(p, N, u[0], u[1], to);
        for (i = 0; i < N; i++) {
            float s[5];
            for (j = 0; j < 5; j++) s[j] = out[j][i];
            count_point(row, p, t, s);
            if (!(s[3] > 0) && (row->shape != MCST_IS_BRDF || s[2] > 0)) {
                const setting set = setting_of(row, p);
                q3 x;
                qd pdf;
                exact_map(row, &set, u[0][i], u[1][i], &x);
                pdf = exact_pdf(row, &set, x);
                if (pdf > (qd)FLT_MIN && !(row->shape == MCST_IS_BRDF && x.z <= 40 * (qd)EPS)) t->zero++;
            }
        }
        t->evaluations += N;
    }
}

/* Are the settings of a row those of its grid in the registry, and a few more? */
static int has_own_grid(const mcst_row *row) { return row->coord != MCST_SLOPES && row->coord != MCST_COSPOWER; }

static size_t settings_of(const mcst_row *row, float (*list)[2]) {
    size_t n = 0, i;
    const float(*more)[2] = row->coord == MCST_SLOPES ? alphas : row->coord == MCST_COSPOWER ? exponents : row->grid;
    const size_t count = row->coord == MCST_SLOPES     ? MCST_COUNT(alphas)
                         : row->coord == MCST_COSPOWER ? MCST_COUNT(exponents)
                                                       : row->grid_size;
    for (i = 0; i < count; i++) {
        if (row->coord == MCST_COSPOWER && row->params == 1 && more[i][0] != more[i][1] && more[i][1] > 1e-20f)
            continue;
        list[n][0] = more[i][0], list[n++][1] = more[i][1];
    }
    for (i = 0; i < MCST_COUNT(line_more); i++)
        if ((int)line_more[i][0] == (int)(row - mcst_rows))
            list[n][0] = line_more[i][1], list[n++][1] = line_more[i][2];
    return n;
}

static void check_setting(const mcst_row *row, const float *p, uint64_t seed, double scale, tally *t) {
    static float u[U_MAX][2];
    static exact_point exact[U_MAX];
    const int strata = (int)fmin(64, fmax(4, sqrt((row->has_wo ? 1024 : 4096) * scale))),
              n = make_u(row, seed, strata, u);
    const setting s = setting_of(row, p);
    double peak = 0, extent = 0;
    int i;
    for (i = 0; i < n; i++) {
        exact_map(row, &s, u[i][0], u[i][1], &exact[i].x);
        exact[i].pdf = exact_pdf(row, &s, exact[i].x);
        extent = fmax(extent, fabs((double)exact[i].x.x));
        if (exact[i].pdf > (qd)peak && exact[i].pdf < (qd)1e300) peak = (double)exact[i].pdf;
    }
    for (i = 0; i < n; i++) {
        drawn_point d = draw_point(row, &s, p, u[i], &exact[i], t);
        d.peak = peak;
        d.extent = extent;
        check_point(&d, t);
    }
    if (row->dim == 3) check_far(row, &s, p, seed, peak, t);
    if (row->traits & MCST_DISTANCE) check_rim(row, &s, p, seed, t);
    sweep(row, p, seed, (size_t)fmax(1, 4 * scale), t);
}

/* Densities per area and per solid angle: within an ulp, 0 where an argument is 0, FLT_MAX where it is more. */
static void check_conversions(void) {
    static const float v[] = {0, 0x1p-149f, 1e-38f, 1e-30f, 1e-18f,  3e-7f, 0.1f,  0.7f,   0.99999994f,
                              1, 1.3f,      5.7f,   1e9f,   1.1e18f, 1e30f, 3e38f, FLT_MAX};
    enum { N = MCST_COUNT(v) };
    for (int i = 0; i < N * N * N; i++) {
        const float pdf = v[i % N];
        const float distance = v[i / N % N];
        const float cosine = i / N % 2 ? -v[i / N / N] : v[i / N / N];
        const qd d2 = (qd)distance * distance;
        const int none = pdf == 0 || distance == 0 || cosine == 0;
        for (int k = 0; k < 2; k++) {
            const qd per = none ? 1 : fabsq(k ? cosine / d2 : d2 / cosine);
            const qd want = none ? 0 : fminq(pdf * per, FLT_MAX);
            const float got =
                k ? mcs_pdf_to_area(pdf, distance, cosine) : mcs_pdf_to_solid_angle(pdf, distance, cosine);
            CHECK(fabsq(got - want) <= want * (qd)0x1p-23 + (qd)0x1p-149 && (!none || got == 0),
                  "pdf %a, distance %a, cosine %a: %.9g, exact %.9g", (double)pdf, (double)distance, (double)cosine,
                  (double)got, (double)want);
        }
    }
}

static void print_tally(const char *name, const tally *t, int head) {
    int i;
    if (head) {
        printf("%-14s %11s %4s %4s %9s %9s |", "", "evaluations", "NaN", "inf", "not unit", "density 0");
        for (i = 0; i < SCORES; i++) printf(" %16s", score_name[i]);
        puts("  raw/judged (ill)");
        return;
    }
    printf("%-14s %11.0f %4.0f %4.0f %9.0f %9.0f |", name, t->evaluations, t->nans, t->infinities, t->not_unit,
           t->zero);
    for (i = 0; i < SCORES; i++) {
        char cell[40];
        if (t->ill[i] > 0) snprintf(cell, sizeof cell, "%.2g/%.2g (%.0f)", t->raw[i], t->judged[i], t->ill[i]);
        else snprintf(cell, sizeof cell, "%.3g", t->raw[i]);
        printf(" %16s", cell);
    }
    putchar('\n');
    for (i = 0; i < SCORES && getenv("MCS_TEST_VERBOSE"); i++)
        if (t->raw[i] > 0) printf("    %-8s %.3g at %s\n", score_name[i], t->raw[i], t->at[i]);
    fflush(stdout);
}

/* The density of the oracle at random points. */
static void check_oracle(const mcst_row *row) {
    uint64_t seed = mcst_seed_for(row->name, "oracle", 0);
    size_t j;
    for (j = 0; j < 20; j++) { /* away from seams; wo is unit to 2^-24, the area is to that power 4 */
        setting s;
        float u1, u2, p[MCST_P];
        double got;
        mcst_uniform(&seed, 1, &u1, &u2);
        mcst_fill(row, row->grid[j % row->grid_size][0], row->grid[j % row->grid_size][1], 0.2f + 0.7f * u2, 4 * u1, p);
        s = setting_of(row, p);
        u1 = 0.05f + 0.4f * u1, u2 = 0.55f + 0.4f * u2;
        got = (double)density_times_area(row, &s, u1, u2);
        CHECK(fabs(got - 1) <= 1e-6 || (got == 0 && row->shape == MCST_IS_BRDF), "p %g %g, u %g %g: %.9g", (double)p[0],
              (double)p[1], (double)u1, (double)u2, got);
    }
}

static float list[64][2]; /* settings of a row */

static void check_settings(const mcst_row *row, tally *t) {
    const size_t settings = settings_of(row, list), incidences = row->has_wo ? MCST_COUNT(incidence) : 1;
    size_t j, k;
    for (j = 0; j < settings; j++) {
        if (!mcst_case("%g %g", (double)list[j][0], (double)list[j][1])) continue;
        for (k = 0; k < incidences; k++) {
            float p[MCST_P];
            mcst_fill(row, list[j][0], list[j][1], incidence[k][0], incidence[k][1], p);
            check_setting(row, p, mcst_seed_for(row->name, "extremes", j * MCST_COUNT(incidence) + k), mcst_scale(), t);
        }
    }
    if (t->evaluations > 0 && mcst_case("NaN, infinities, lengths, densities of 0"))
        CHECK(t->nans == 0 && t->infinities == 0 && t->not_unit == 0 && t->zero == 0,
              "%.0f NaN, %.0f infinite, %.0f not unit, %.0f of density 0", t->nans, t->infinities, t->not_unit,
              t->zero);
}

/* The masses of a grid without incidences are those of test_oracle: what is beyond it is left. */
static void check_masses(const mcst_row *row) {
    const size_t settings = settings_of(row, list);
    size_t j;
    for (j = has_own_grid(row) && !row->has_wo ? row->grid_size : 0; j < settings; j++) {
        mcst_mass m;
        float p[MCST_P];
        mcst_fill(row, list[j][0], list[j][1], j % 2 ? 0.1f : 0.9f, 0.7f, p);
        if (row->coord == MCST_SLOPES && (p[0] < 1e-7f || p[0] > 1e4f)) continue; /* clamped: bins.h does not know */
        if (row->coord == MCST_COSPOWER && p[0] > 1e9f) continue;
        if (!mcst_mass_resolved(row, p)) continue;
        if (!mcst_case("%s %g %g", row->name, (double)list[j][0], (double)list[j][1])) continue;
        m = mcst_mass_of(row, p);
        CHECK(fabs(m.integral - m.lit) <= m.tolerance, "integral %.8f, not lost %.8f (%g, tolerance %g)", m.integral,
              m.lit, m.integral - m.lit, m.tolerance);
    }
}

int main(int argc, char **argv) {
    static tally all[MCST_NROWS][2];
    int i, j;
    exact_start();
    mcst_start(argc, argv);
    for (i = 0; i < MCST_NROWS; i++) {
        const mcst_row *row = &mcst_rows[i];
        char group[64];
        all[i][1].beyond = 1;
        snprintf(group, sizeof group, "%s oracle", row->name);
        mcst_group(group);
        if (mcst_case("density times area of the map")) check_oracle(row);
        mcst_group(row->name);
        check_settings(row, all[i]);
    }
    mcst_group("oracle");
    if (mcst_case("conversions of densities")) check_conversions();
    mcst_group("mass");
    for (i = 0; i < MCST_NROWS; i++) check_masses(&mcst_rows[i]);
    mcst_group("");
    if (mcst.list) return mcst_finish();
    if (mcst_masses_skipped) printf("SKIPPED: %d masses, named above\n", mcst_masses_skipped);
    print_tally("", NULL, 1);
    for (i = 0; i < MCST_NROWS; i++)
        for (j = 0; j < (mcst_rows[i].dim == 3 ? 2 : 1); j++)
            if (all[i][0].evaluations > 0) print_tally(j ? "  beyond" : mcst_rows[i].name, &all[i][j], 0);
    return mcst_finish();
}
