/* An adversary: for every figure of accuracy that the header states for densities, coordinates, directions, lights,
 * reflectances and frames it looks for the input that breaks it, by random starts and by climbing from the best of
 * them, against the __float128 truth of exact.h. Directions are unit to half an ulp, what a caller in double gives;
 * nothing else is forgiven: no condition comes on top of a figure.
 *
 * The figures are those of claims.h; test_oracle.c looks up that the header states them.
 * At full size the seed is the day, and printed; --seed picks another, MCS_TEST_SCALE scales the number of climbs. */
#include <time.h>
#include "claims.h"
#include "exact.h"

#define EPS 0x1p-24   /* half an ulp of 1 */
enum { CLIMBS = 60 }; /* for each figure, at full size */

/* --- points ------------------------------------------------------------------------------------------------------- */

/* One input. What a figure does not depend on is never changed. */
typedef struct {
    float p[MCST_P], u[2], w[3];
    given_light light;
} point;

static uint64_t state;
static double flat(void) { return (double)(mcst_mix(&state) >> 11) * 0x1p-53; }
static int one_in(unsigned n) { return mcst_mix(&state) % n == 0; }
/* Small steps are as likely as large ones. */
static double any_step(double largest) { return (one_in(2) ? largest : -largest) * pow(10, -7 * flat()); }
static float ulps(float x, int n) {
    for (; n > 0; n--) x = nextafterf(x, INFINITY);
    for (; n < 0; n++) x = nextafterf(x, -INFINITY);
    return x;
}
static float clamped(double x, double least, double most) { return (float)fmin(fmax(x, least), most); }

static void set_direction(float w[3], double cosine, double azimuth) {
    const double c = fmin(fmax(cosine, 1.0001e-15), 1);
    const double s = sqrt((1 - c) * (1 + c));
    w[0] = (float)(s * cos(azimuth));
    w[1] = (float)(s * sin(azimuth));
    w[2] = (float)c;
}
/* A sine of wo below 1e-24 may count as 0. */
static int unit_enough(const float w[3]) {
    const double x = (double)w[0];
    const double y = (double)w[1];
    const double z = (double)w[2];
    const double r2 = x * x + y * y;
    return !(r2 > 0 && r2 < 1e-48) && w[2] >= 1e-15f && fabs(sqrt(x * x + y * y + z * z) - 1) <= EPS;
}
static void any_direction(float w[3]) {
    set_direction(w, one_in(2) ? flat() : pow(10, -15 * flat()), 6.283185307179586 * flat());
}
static void move_direction(float w[3]) {
    const double azimuth = atan2((double)w[1], (double)w[0]);
    float was[3];
    memcpy(was, w, sizeof was);
    if (one_in(3)) {
        const size_t k = mcst_mix(&state) % 3;
        w[k] = ulps(w[k], (int)(mcst_mix(&state) % 9) - 4);
        if (!unit_enough(w)) memcpy(w, was, sizeof was);
    } else if (one_in(2)) set_direction(w, (double)w[2] * exp(any_step(3)), azimuth);
    else set_direction(w, (double)w[2], azimuth + any_step(3));
    if (!unit_enough(w)) memcpy(w, was, sizeof was);
}

static float any_u(void) {
    if (one_in(3)) return one_in(2) ? (float)pow(10, -12 * flat()) : clamped(1 - pow(10, -7.3 * flat()), 0, 1 - EPS);
    return clamped(flat(), 0, 1 - EPS);
}
static float move_u(float u) {
    double x = (double)u;
    if (one_in(3)) x = (double)ulps(u, (int)(mcst_mix(&state) % 9) - 4);
    else if (one_in(2)) x += any_step(1);
    else if (x < 0.5) x *= exp(any_step(3));
    else x = 1 - (1 - x) * exp(any_step(3));
    return clamped(x, 0, 1 - EPS);
}

#include "climb_lights.h"

static const mcst_claim *claim; /* what is under attack */

/* The range of a parameter: that of the claim or, where it has none, what may be given. */
static double least_of(const mcst_row *row, int i) {
    return claim->most[i] > claim->least[i] ? claim->least[i] : row->dim < 3 ? row->domain.least[i] : claim->least[i];
}
static double most_of(const mcst_row *row, int i) {
    return claim->most[i] > claim->least[i] ? claim->most[i] : row->dim < 3 ? row->domain.most[i] : claim->most[i];
}
static float any_parameter(const mcst_row *row, int i) {
    const double least = least_of(row, i);
    const double most = most_of(row, i);
    if (row->dim < 3 && row->domain.either_sign && i == 0 && one_in(2)) return -any_parameter(row, i);
    const double floor_ = fmax(least, 1e-30);
    if (!(most > least)) return (float)least;
    if (least == 0 && one_in(20)) return 0;
    if (one_in(2)) return clamped(pow(10, 4 * flat() - 2.5), least, most); /* what materials have */
    return clamped(floor_ * pow(most / floor_, flat()), least, most);
}
static float move_parameter(const mcst_row *row, int i, float v) {
    const double x = one_in(3) ? (double)ulps(v, (int)(mcst_mix(&state) % 9) - 4) : (double)v * exp(any_step(3));
    if (row->dim < 3 && row->domain.either_sign && v < 0 && i == 0)
        return clamped(x, -most_of(row, i), -least_of(row, i));
    return clamped(x, least_of(row, i), most_of(row, i));
}

static void any_light_point(const mcst_row *row, point *t) {
    memset(t, 0, sizeof *t);
    t->light = any_light((int)(row - mcst_rows));
    t->u[0] = any_u();
    t->u[1] = any_u();
    const mcs_light_point s = header_sample(&t->light, t->u[0], t->u[1]);
    put3(t->w, s.w.x, s.w.y, s.w.z);
}
static void move_light_point(point *t) {
    do {
        if (one_in(2)) move_light(&t->light);
        if (one_in(2)) t->u[0] = move_u(t->u[0]);
        if (one_in(2)) t->u[1] = move_u(t->u[1]);
        const mcs_light_point s = header_sample(&t->light, t->u[0], t->u[1]);
        put3(t->w, s.w.x, s.w.y, s.w.z);
        if (one_in(2)) t->w[mcst_mix(&state) % 3] *= 1 + (float)(any_step(16) * 0x1p-23);
    } while (one_in(3));
}

static void sample_at(const mcst_row *row, point *t) {
    float out[5] = {0};
    row->fn[0].sample(t->p, &t->u[0], &t->u[1], out);
    if (row->dim < 3 || unit_enough(out)) memcpy(t->w, out, sizeof t->w);
}
static void any_point(const mcst_row *row, point *t) {
    if (row->traits & MCST_DISTANCE) {
        any_light_point(row, t);
        return;
    }
    memset(t, 0, sizeof *t);
    do {
        t->p[0] = any_parameter(row, 0);
        t->p[1] = row->params > 1 && one_in(3) ? clamped((double)t->p[0], least_of(row, 1), most_of(row, 1))
                                               : any_parameter(row, 1);
    } while (mcst_bad_together(row, t->p));
    t->p[5] = 1;
    if (row->has_wo) any_direction(t->p + 3);
    t->u[0] = any_u();
    t->u[1] = any_u();
    any_direction(t->w);
    if (row->dim < 3 || !one_in(4)) sample_at(row, t);
}
static int is_of_u(int figure) {
    return figure == CLAIM_PDF_U || figure == CLAIM_SAMPLE_WEIGHT || figure == CLAIM_LENGTH || figure == CLAIM_WHERE;
}
static void move_point(const mcst_row *row, int figure, point *t) {
    const int of_u = is_of_u(figure);
    if (row->traits & MCST_DISTANCE) {
        move_light_point(t);
        return;
    }
    do {
        float p[2] = {t->p[0], t->p[1]};
        if (one_in(4)) t->p[0] = move_parameter(row, 0, t->p[0]);
        if (one_in(4)) t->p[1] = move_parameter(row, 1, one_in(8) && row->params > 1 ? t->p[0] : t->p[1]);
        if (mcst_bad_together(row, t->p)) memcpy(t->p, p, sizeof p);
        if (row->has_wo && one_in(3)) move_direction(t->p + 3);
        if (of_u && one_in(2)) t->u[0] = move_u(t->u[0]);
        if (of_u && one_in(2)) t->u[1] = move_u(t->u[1]);
        if (row->dim == 3 && !of_u && one_in(2)) move_direction(t->w);
        if (row->dim < 3 && !of_u) {
            t->u[0] = move_u(t->u[0]);
            t->u[1] = move_u(t->u[1]);
            sample_at(row, t);
        }
    } while (one_in(3));
}

/* --- scores ------------------------------------------------------------------------------------------------------- */

/* The greatest density: of a grid of u, then uphill from there. Only its logarithm counts. */
static double peak_of(const mcst_row *row, const float *p) {
    enum { GRID = 16 };
    ld at[2] = {0.5L, 0.5L};
    ld peak = 0;
    for (int i = 0; i < GRID; i++)
        for (int j = 0; j < GRID; j++) {
            const ld u1 = 1 - (ld)((GRID - i) * (GRID - i)) / (GRID * GRID);
            const ld u2 = ((ld)j + 0.25L) / GRID;
            const ld pdf = row->truth.pdf_u(p, u1, u2);
            if (pdf > peak && pdf < 1e300L) {
                peak = pdf;
                at[0] = u1;
                at[1] = u2;
            }
        }
    for (ld step = 1.0L / GRID; step > 1e-6L; step *= 0.6L)
        for (int i = 0; i < 8; i++) {
            static const int way[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
            const ld u1 = fminl(fmaxl(at[0] + step * way[i][0], 0), 1 - (ld)EPS);
            const ld u2 = at[1] + step * way[i][1];
            const ld pdf = row->truth.pdf_u(p, u1, u2 - floorl(u2));
            if (pdf > peak && pdf < 1e300L) {
                peak = pdf;
                at[0] = u1;
                at[1] = u2 - floorl(u2);
            }
        }
    return (double)peak;
}

/* The error of got in 1e-6 (1 + |ln(density/peak)|) of want; what is below MCST_FAINT of the peak does not count. The
 * peak is looked for only where the score would be above `least` without it. Densities above FLT_MAX saturate;
 * subnormal ones are only small. */
static double in_units(const mcst_row *row, const float *p, float got, qd want, qd density, double least) {
    const double error = fabs((double)(((qd)got - want) / want));
    if (!(want < (qd)FLT_MAX && want > (qd)FLT_MIN)) return 0;
    if (!(error / 1e-6 > least)) return error / 1e-6;
    const double peak = fmax(peak_of(row, p), (double)density);
    return (error - MCST_FAINT * peak / (double)density) / (1e-6 * (1 + log(peak / (double)density)));
}
/* The exponent e of a Gaussian half-vector; 0 of another row. */
static double exponent_of(const mcst_row *row, const setting *s, q3 x) {
    const q3 h = row->shape == MCST_IS_BRDF ? add(s->wo, x) : x;
    return row->traits & MCST_GAUSS ? (double)(tan2_of(h) * per_alpha2(s->a, s->b, h)) : 0;
}
/* The error of a density or value at a given direction, in its unit; what is below MCST_FAINT of the peak does not
 * count here either. */
static double at_direction(const mcst_row *row, const setting *s, const float *p, q3 x, float got, qd want, qd density,
                           double least) {
    if (!(row->traits & MCST_GAUSS)) return in_units(row, p, got, want, density, least);
    if (!(want < (qd)FLT_MAX && want > (qd)FLT_MIN)) return 0;
    const double unit = 1e-6 * (1 + exponent_of(row, s, x));
    const double error = fabs((double)(((qd)got - want) / want));
    if (!(error / unit > least)) return error / unit;
    return (error - MCST_FAINT * fmax(peak_of(row, p), (double)density) / (double)density) / unit;
}

/* What the weight of a sample belongs to: the half-vector of the exact point and the float direction wi. */
static qd weight_of_sample(const setting *s, qd u1, qd u2, q3 wi) {
    const qd zo = s->wo.z;
    const qd a = s->a;
    const qd b = s->b;
    const q3 h = s->half ? half_vector_map(s, u1, u2) : wi;
    const qd d = dot(s->wo, h);
    const qd c = h.z;
    switch (s->id) {
    case ID_phong: return (a + 2) / (a + 1) * wi.z;
    case ID_ward_gmd: return 2 * wi.z / (zo + wi.z);
    case ID_ward_duer: return d * c * c * c / zo;
    case ID_ward_1992: return d * c * c * c * root_of(wi.z / zo);
    case ID_beckmann: return d / (zo * c * (1 + beckmann_lambda(a, b, s->wo) + beckmann_lambda(a, b, wi)));
    case ID_ashikhmin: return wi.z / fmaxq(zo, wi.z);
    default: break;
    }
    if (!s->visible) return d / (zo * c * (1 + ggx_lambda(a, b, s->wo) + ggx_lambda(a, b, wi)));
    if (s->visible == 1) return (1 + ggx_lambda(a, b, s->wo)) / (1 + ggx_lambda(a, b, s->wo) + ggx_lambda(a, b, wi));
    return (bound(a, b, s->wo) * zo + len(vec(a * s->wo.x, b * s->wo.y, zo))) /
           (2 * zo * (1 + ggx_lambda(a, b, s->wo) + ggx_lambda(a, b, wi)));
}

static double weight_error(float got, qd want) {
    if (!(want < (qd)FLT_MAX && want > (qd)0x1p-100)) return 0;
    return fabs((double)(((qd)got - want) / want)) / 1e-6;
}

/* The worst coordinate, in 2^-24 of its scale. What is subnormal, as such or in units of a point in the middle, has lost
 * digits. */
static double where_error(const mcst_row *row, const setting *s, const point *t, const float *got) {
    q3 want;
    q3 middle;
    exact_map(row, s, t->u[0], t->u[1], &want);
    exact_map(row, s, (qd)0.75, (qd)0.625, &middle);
    const qd exact[3] = {want.x, want.y, want.z};
    const double lost = 0x1p-125 * fmax(1, (double)largest(middle));
    double worst = 0;
    for (int i = 0; i < row->dim; i++) {
        const double off = fabs((double)((qd)got[i] - exact[i]));
        if (off > lost) worst = fmax(worst, off / (EPS * mcst_where_scale(row, t->p, (double)exact[i])));
    }
    return worst;
}

static double score_of(const mcst_row *row, int figure, const point *t, double least) {
    if (row->traits & MCST_DISTANCE) return score_of_light(figure, &t->light, t->u, t->w);
    const setting s = setting_of(row, t->p);
    q3 x = vec(t->w[0], t->w[1], t->w[2]);
    float out[5] = {0};
    float got = 0;
    if (is_of_u(figure)) row->fn[0].sample(t->p, &t->u[0], &t->u[1], out);
    if (figure == CLAIM_LENGTH) {
        const double l2 =
            (double)out[0] * (double)out[0] + (double)out[1] * (double)out[1] + (double)out[2] * (double)out[2];
        return fabs(sqrt(l2) - 1) / EPS;
    }
    if (figure == CLAIM_SAMPLE_WEIGHT) {
        if (!(out[3] > 0) || out[2] < 1e-15f) return 0;
        return weight_error(out[4], weight_of_sample(&s, t->u[0], t->u[1], vec(out[0], out[1], out[2])));
    }
    if (figure == CLAIM_WHERE) return where_error(row, &s, t, out);
    qd pdf;
    if (figure == CLAIM_PDF_U) {
        exact_map(row, &s, t->u[0], t->u[1], &x);
        if (row->shape == MCST_IS_BRDF && !(out[3] > 0) && x.z <= 40 * (qd)EPS) return 0; /* lost, or nearly */
        if (row->dim == 3 && !(row->traits & MCST_WHOLE) && x.z < (qd)1e-15) return 0;
        pdf = exact_pdf(row, &s, x);
        return in_units(row, t->p, out[3], pdf, pdf, least);
    }
    if (row->coord == MCST_CONE && fabsq((1 - x.z / len(x)) / s.a - 1) < (qd)1e-6) return 0; /* the rim */
    pdf = exact_pdf(row, &s, x);
    if (!(pdf > (qd)0x1p-1022) || exponent_of(row, &s, x) > 87) return 0;
    if (row->dim < 3) {
        row->fn[0].pdf(t->p, t->w, &got);
        return in_units(row, t->p, got, pdf, pdf, least);
    }
    if (figure == CLAIM_PDF_W) {
        row->fn[0].pdf(t->p, t->w, &got);
        if (row->shape == MCST_IS_VLOBE && got == 0) return 0; /* the rim of the cap */
        return at_direction(row, &s, t->p, x, got, pdf, pdf, least);
    }
    const qd f = exact_value(&s, x);
    if (figure == CLAIM_EVAL) {
        row->fn[0].eval(t->p, t->w, &got);
        return at_direction(row, &s, t->p, x, got, f, pdf, least);
    }
    row->fn[0].weight(t->p, t->w, &got);
    return weight_error(got, f * x.z / pdf);
}

/* Where a figure was found above what the header promised then; climbs begin there, too. */
static const struct {
    const char *row;
    point at;
} known[] = {
    {"ggx_vndf",
     {{0x1.126bcep+2f, 0x1.7bc3dap-3f, 0, 0x1.f8e284p-1f, -0x1.543c68p-3f, 0x1.07b004p-10f},
      {0x1.feed64p-1f, 0x1.9aeb1ep-1f},
      {0, 0, 1},
      {0, {0, 0, 0}, {{0, 0, 0}}, 0}}},
    {"ggx_bounded",
     {{0x1.0e3e94p+0f, 0x1.41c456p-6f, 0, 0x1.a323dap-1f, 0x1.260756p-1f, 0x1.c9b3bp-8f},
      {0x1.50dc1ap-21f, 0x1.4974cap-1f},
      {0, 0, 1},
      {0, {0, 0, 0}, {{0, 0, 0}}, 0}}},
    {"sphere", /* where its sine and the cosine of its azimuth are both at their worst */
     {{0}, {0x1.fca59ep-2f, 0x1.77fc02p-2f}, {0, 0, 1}, {0, {0, 0, 0}, {{0, 0, 0}}, 0}}},
    {"truncexp", /* ln(1 - p) for p next to the rounding of 1 - p */
     {{0x1.b2e10ap-9f, 0x1.83f95ap-5f}, {0x1.e01274p-22f, 0}, {0, 0, 1}, {0, {0, 0, 0}, {{0, 0, 0}}, 0}}},
    {"cone", /* 2 - t with roundings of its own */
     {{0x1.ed0e62p-1f, 0, 0, 0, 0, 1}, {0x1.ffff96p-1f, 0x1.d3ff8ep-3f}, {0, 0, 1}, {0, {0, 0, 0}, {{0, 0, 0}}, 0}}},
    {"ball", /* a direction within the rim whose length is off by 11 ulp */
     {{0},
      {0x1.fffffep-1f, 0x1.cf1d68p-2f},
      {-0x1.768cbap-1f, -0x1.1411ccp-2f, -0x1.40a124p-1f},
      {ID_ball,
       {-0x1.2711c6p-7f, -0x1.959c06p-30f, 0x1.d4a966p-15f},
       {{-0x1.79af78p-5f, 0x1.7fad26p-4f, 0x1.5c0ec8p-9f}, {0, 0, 1}, {0, 0, 0}},
       0x1.9ccf22p-4f}}},
    {"disk_light", /* a normal whose z is -0 */
     {{0},
      {0x1.3008aep-1f, 0x1.2f5c5ap-1f},
      {0x1.be14bep-7f, -0x1.77d492p-1f, 0x1.5ba168p-1f},
      {ID_disk_light,
       {0, 0, 0},
       {{0x1.af67fp+15f, -0x1.57a23p+20f, 0x1.16fca8p+20f}, {0x1.ffffe8p-1f, 0x1.398fa6p-10f, -0.0f}, {0, 0, 0}},
       0x1.85dd2ap+23f}}},
    {"spherical_rectangle", /* it nearly touches p, which sees that its sides are rounded */
     {{0},
      {0x1.edc4aep-3f, 0},
      {0x1.0e9734p-4f, 0x1.ebec24p-1f, -0x1.13c528p-2f},
      {ID_spherical_rectangle,
       {-0x1.cee4d2p-33f, -0x1.0b7ec6p-33f, 0x1.6d061p-33f},
       {{-0x1.d19454p-33f, 0x1.046554p-30f, 0x1.caf626p-31f},
        {0x1.39f06ep-38f, -0x1.0c54a6p-28f, -0x1.4fcae4p-29f},
        {0x1.16a4ecp-42f, 0x1.29d608p-44f, 0x1.72cec4p-43f}},
       0}}},
    {"spherical_triangle", /* a sliver next to p: 1 + a.b + b.c + c.a cancels */
     {{0},
      {0x1.bd159cp-1, 0x1.53c50ap-2},
      {0x1.42c54ep-3, -0x1.a7d95p-1, -0x1.13a748p-1},
      {ID_spherical_triangle,
       {0, 0, 0},
       {{-0x1.f772e6p-18, 0x1.4aa276p-15, 0x1.ae0ed4p-16},
        {0x1.523c4ap-16, -0x1.bc4a58p-14, -0x1.20e6bep-14},
        {-0x1.f75a04p-18, 0x1.4aad4cp-15, 0x1.adef4cp-16}},
       0}}},
    {"spherical_triangle", /* one nearly in the plane of p: its normal cancels */
     {{0},
      {0, 0x1.fffff8p-1},
      {-0x1.d41342p-1, 0x1.175bd8p-2, -0x1.32d9a4p-2},
      {ID_spherical_triangle,
       {0x1.43a872p-3, 0x1.dc7ffep-5, -0x1.6c6d26p-5},
       {{-0x1.4eb7p-1, 0x1.32e8b8p-2, -0x1.3da11ep-2},
        {0x1.0b0cb6p-2, 0x1.c45786p-6, -0x1.63f6a6p-7},
        {-0x1.4eb99ap-1, 0x1.32e55ap-2, -0x1.3da01ap-2}},
       0}}},
};

static double climb(const mcst_row *row, int figure, int starts, int steps, point *at) {
    double best = -1;
    for (size_t i = 0; i < MCST_COUNT(known); i++)
        if (strcmp(known[i].row, row->name) == 0 && one_in(2)) {
            const double score = score_of(row, figure, &known[i].at, best);
            if (score > best) {
                best = score;
                *at = known[i].at;
            }
        }
    for (int i = 0; i < starts; i++) {
        point t;
        any_point(row, &t);
        const double score = score_of(row, figure, &t, best);
        if (score > best) {
            best = score;
            *at = t;
        }
    }
    for (int i = 0; i < steps; i++) {
        point t = *at;
        move_point(row, figure, &t);
        const double score = score_of(row, figure, &t, best);
        if (score > best) {
            best = score;
            *at = t;
        }
    }
    return best;
}

static void describe(const mcst_row *row, const point *t, char where[400]) {
    const given_light *g = &t->light;
    size_t n = 0;
    if (row->traits & MCST_DISTANCE) {
        n = (size_t)snprintf(where, 400, "p %a %a %a, r %a, at", (double)g->p[0], (double)g->p[1], (double)g->p[2],
                             (double)g->r);
        for (int i = 0; i < 9; i++) n += (size_t)snprintf(where + n, 400 - n, " %a", (double)g->at[i / 3][i % 3]);
    } else
        n = (size_t)snprintf(where, 400, "p %a %a, wo %a %a %a", (double)t->p[0], (double)t->p[1], (double)t->p[3],
                             (double)t->p[4], (double)t->p[5]);
    snprintf(where + n, 400 - n, ", u %a %a, w %a %a %a", (double)t->u[0], (double)t->u[1], (double)t->w[0],
             (double)t->w[1], (double)t->w[2]);
}

/* Attacks one figure of the claim. */
static void attack(const mcst_row *row, const char *group, int figure, int climbs) {
    double worst = 0;
    char where[400] = "";
    state = mcst_seed_for(row->name, mcst_claim_name[figure], 0);
    for (int n = 0; n < climbs; n++) {
        point at;
        const double score = climb(row, figure, 100, 500, &at);
        if (!(score > worst)) continue;
        worst = score;
        describe(row, &at, where);
    }
    CHECK(worst <= claim->claim[figure], "%.3g at %s", worst, where);
    mcst_note("  %-26s %-18s %6.3f of %4.2f at %s\n", group, mcst_claim_name[figure], worst, claim->claim[figure],
              where);
}

#include "climb_plain.h"

int main(int argc, char **argv) {
    const double scale = mcst_scale();
    exact_start();
    if (scale >= 1) mcst.seed = (uint64_t)time(NULL) / 86400;
    mcst_start(argc, argv);
    for (size_t i = 0; i < MCST_NROWS; i++) {
        const mcst_row *row = &mcst_rows[i];
        for (size_t j = 0; j < row->claims_size; j++) {
            claim = &row->claims[j];
            char group[64];
            snprintf(group, sizeof group, row->params ? "%s %g to %g" : "%s", row->name, least_of(row, 0),
                     most_of(row, 0));
            mcst_group(group);
            for (int k = 0; k < CLAIMS; k++)
                if (claim->claim[k] != 0 && mcst_case("%s", mcst_claim_name[k]))
                    attack(row, group, k, (int)ceil(CLIMBS * scale));
        }
    }
    mcst_group("functions without a row");
    for (size_t i = 0; i < MCST_COUNT(plain_figures); i++)
        if (mcst_case("%s", plain_figures[i].name)) attack_plain(&plain_figures[i], (int)ceil(10 * CLIMBS * scale));
    mcst_close_group();
    if (mcst.failed || mcst.verbose) printf("seed %llu\n", (unsigned long long)mcst.seed);
    return mcst_finish();
}
