/* Rough glass against Walter's formulas in long double: chi-square over the whole sphere, samples and values, energy,
 * symmetry, both sides, equal indices, bad input, widths. */
#include <float.h>
#include <math.h>
#include "mcs_test.h"
#define MCS_PACKETS 16
#include "mcsample.h"
#include "oracle.h"
#include "stats.h"

static const double eps = 0x1p-24; /* rounding of a float, relative */

/* What a program here draws from. */
typedef struct {
    float alpha_x, alpha_y, eta, cosine, azimuth;
} scene;

static const scene scenes[] = {{0.3f, 0.3f, 1.5f, 0.8f, 0.4f},
                               {0.3f, 0.3f, 1 / 1.5f, 0.8f, 0.4f},
                               {0.2f, 0.5f, 1.5f, -0.6f, 1},
                               {0.5f, 0.2f, 1.33f, 0.3f, 2},
                               {0.4f, 0.4f, 1.33f, -0.5f, -2},
                               {0.3f, 0.3f, 1.01f, 0.7f, 0.3f},
                               {0.5f, 0.3f, 0.99f, 0.4f, 1},
                               {0.3f, 0.3f, 1.001f, -0.9f, 1},
                               {1, 1, 1.5f, 0.1f, 3},
                               {0.3f, 0.3f, 2.4f, 0.05f, 0.7f},
                               {0.2f, 0.2f, 1.5f, 1, 0},
                               {0.7f, 0.7f, 1 / 2.4f, 0.5f, 1},
                               {0.1f, 0.1f, 1.5f, -0.75f, -0.5f},
                               {0.25f, 0.6f, 1 / 1.5f, -0.2f, 2.5f}};
enum { SCENES = sizeof scenes / sizeof *scenes };

static o_glass glass_of(const scene *k) {
    o_glass g;
    g.ax = k->alpha_x;
    g.ay = k->alpha_y;
    g.eta = k->eta;
    return g;
}

static o_vec3 wide_of(mcs_vec3 v) { return o_v3(v.x, v.y, v.z); }

static mcs_vec3 narrow_of(o_vec3 v) {
    mcs_vec3 w;
    w.x = (float)v.x;
    w.y = (float)v.y;
    w.z = (float)v.z;
    return w;
}

static mcs_vec3 direction(double cosine, double azimuth) {
    const double sine = sqrt(1 - cosine * cosine);
    return narrow_of(o_vec((ld)(sine * cos(azimuth)), (ld)(sine * sin(azimuth)), (ld)cosine));
}

static double uniform(mcs_pcg32 *r) { return (double)mcs_pcg32_float(r); }

/* ---- chi-square over the whole sphere ---- */

/* The rule has NODES^2 points in a cell, and CLOSE^2 where the density jumps at the horizon, or is 0 somewhere. */
enum { RINGS = 24, SECTORS = 24, NODES = 16, CLOSE = 64, CELLS = RINGS * SECTORS };

/* Polar coordinates about a pole: s in [0,1) is the angle, drawn out within `width` of the pole. */
typedef struct {
    o_vec3 pole, x, y;
    double width;
} globe;

/* About the direction that smooth glass would refract to; where it does not, straight on. */
static globe globe_for(const scene *k, o_vec3 wo) {
    globe g;
    const o_vec3 bent = o_refract(wo, o_vec(0, 0, 1), k->eta);
    g.pole = o_unit(o_len(bent) > 0 ? bent : o_scale(-1, wo));
    o_frame(g.pole, &g.x, &g.y);
    const double bends = fabs((double)k->eta - 1);
    g.width = bends > 0.05 ? 0.6 : bends + 0.001;
    return g;
}

static size_t cell_of(const globe *g, o_vec3 w) {
    const double angle = atan2((double)o_len(o_cross(g->pole, w)), (double)o_dot(g->pole, w));
    const double s = angle / (angle + g->width) * ((double)O_PI + g->width) / (double)O_PI;
    const double t = atan2((double)o_dot(g->y, w), (double)o_dot(g->x, w)) / (2 * (double)O_PI) + 0.5;
    const int ring = (int)fmin(RINGS - 1, RINGS * s);
    const int sector = (int)fmin(SECTORS - 1, SECTORS * t);
    return (size_t)(ring * SECTORS + sector);
}

/* The direction at (s, t) of the unit square, and its solid angle there for the square's area 1. */
static o_vec3 place(const globe *g, double s, double t, double *solid_angle) {
    const double most = (double)O_PI / ((double)O_PI + g->width);
    const double angle = g->width * s * most / (1 - s * most);
    const double slope = g->width * most / ((1 - s * most) * (1 - s * most));
    const double azimuth = 2 * (double)O_PI * (t - 0.5);
    *solid_angle = sin(angle) * slope * 2 * (double)O_PI;
    const o_vec3 across = o_add(o_scale((ld)cos(azimuth), g->x), o_scale((ld)sin(azimuth), g->y));
    return o_add(o_scale((ld)cos(angle), g->pole), o_scale((ld)sin(angle), across));
}

/* Does the horizon cross the cell? Its border is looked at. */
static int crossed(const globe *g, int ring, int sector) {
    int above = 0;
    for (int i = 0; i < 64; i++) {
        double part;
        const double along = i % 16 / 15.0;
        const double s = i < 16 ? 0 : i < 32 ? 1 : along;
        const double t = i < 32 ? along : i < 48;
        above += place(g, (ring + s) / RINGS, (sector + t) / SECTORS, &part).z > 0;
    }
    return above != 0 && above != 64;
}

/* The integrals of the density over a cell, and of f times the cosine of wi, by n^2 points. Returns how often both are
 * 0. */
static int integrate(const scene *k, const globe *g, o_vec3 wo, int cell, int n, double sums[2]) {
    int dark = 0;
    sums[0] = sums[1] = 0;
    for (int i = 0; i < n * n; i++) {
        double part;
        const double s = cell / SECTORS + (i / n + 0.5) / n;
        const double t = cell % SECTORS + (i % n + 0.5) / n;
        const o_vec3 wi = place(g, s / RINGS, t / SECTORS, &part);
        const double pdf = (double)o_ggx_glass_pdf(glass_of(k), wo, wi);
        const double f = (double)o_ggx_glass_eval(glass_of(k), wo, wi);
        sums[0] += part * pdf / ((double)CELLS * n * n);
        sums[1] += part * f * fabs((double)wi.z) / ((double)CELLS * n * n);
        dark += !(pdf > 0);
    }
    return dark;
}

static void check_sphere(const scene *k, mcs_pcg32 *r) {
    enum { MILLION = 1000000 };
    const mcs_ggx m = mcs_ggx_make(k->alpha_x, k->alpha_y);
    const mcs_vec3 wo = direction((double)k->cosine, (double)k->azimuth);
    const globe g = globe_for(k, wide_of(wo));
    double mass[CELLS] = {0};
    double count[CELLS] = {0};
    double weights = 0;
    double kept = 0;
    double light = 0;
    for (int i = 0; i < MILLION; i++) {
        const float u1 = mcs_pcg32_float(r);
        const float u2 = mcs_pcg32_float(r);
        const mcs_brdf s = mcs_ggx_glass_sample(&m, k->eta, wo, u1, u2, mcs_pcg32_float(r));
        CHECK(s.weight <= 1.000001f, "weight %g", (double)s.weight);
        if (!(s.pdf > 0)) continue;
        count[cell_of(&g, wide_of(s.wi))]++;
        weights += (double)s.weight / MILLION;
        kept++;
    }
    double total = 0;
    for (int i = 0; i < CELLS; i++) {
        double sums[2];
        const int dark = integrate(k, &g, wide_of(wo), i, NODES, sums);
        if (dark || crossed(&g, i / SECTORS, i % SECTORS)) integrate(k, &g, wide_of(wo), i, CLOSE, sums);
        mass[i] = sums[0];
        total += sums[0];
        light += sums[1];
    }
    /* A sliver of a cell may have no point of the rule. */
    for (int i = 0; i < CELLS; i++) mass[i] = fmax(0.01, mass[i] * kept / total);
    double statistic;
    int freedom;
    const double p = chi2_test(count, mass, CELLS, &statistic, &freedom);
    mcst_note("    p %.4f, %d degrees, mass %.5f kept %.5f, light %.5f weights %.5f\n", p, freedom, total,
              kept / MILLION, light, weights);
    CHECK(p >= sidak(0.01, SCENES) && freedom > 50, "p = %g, %d degrees of freedom", p, freedom);
    /* Four standard deviations of a share of a million, and the rule. */
    CHECK(fabs(total - kept / MILLION) <= 0.002 + 0.0005, "mass %g, kept %g", total, kept / MILLION);
    CHECK(fabs(light - weights) <= 0.002 + 0.0005 && light <= 1.0005, "light %g, weights %g", light, weights);
}

/* ---- samples and values ---- */

static double pick(mcs_pcg32 *r, double lo, double hi) { return lo * pow(hi / lo, uniform(r)); }

/* Both sides, all angles, smooth to rough, indices far apart and nearly alike. */
static scene any_scene(mcs_pcg32 *r) {
    static const float indices[] = {1.5f, 1 / 1.5f, 1.33f, 1 / 1.33f, 2.4f, 1 / 2.4f};
    scene k;
    k.alpha_x = (float)pick(r, 1e-3, 1);
    k.alpha_y = mcs_pcg32_next(r) % 2 ? k.alpha_x : (float)pick(r, 1e-3, 1);
    k.eta = indices[mcs_pcg32_next(r) % 6];
    if (mcs_pcg32_next(r) % 3 == 0) k.eta = (float)(1 + (mcs_pcg32_next(r) % 2 ? 1 : -1) * pick(r, 1e-6, 0.1));
    k.cosine = (float)(mcs_pcg32_next(r) % 3 ? uniform(r) : pick(r, 1e-4, 1));
    k.cosine = fmaxf(k.cosine, 1e-6f) * (mcs_pcg32_next(r) % 2 ? 1.0f : -1.0f);
    k.azimuth = (float)(6.28 * uniform(r));
    return k;
}

/* F, or (1 - F) J c, the factors of a density that depend on the cosine c. */
static ld share_of(const scene *k, o_vec3 wo, ld c, int refracts) {
    const ld share = o_glass_share(k->eta, wo, c, refracts);
    if (!refracts) return share;
    const ld n_o = o_index_at(wo, k->eta);
    const ld n_i = wo.z < 0 ? 1 : k->eta;
    const ld cos2_t = fmaxl(0, o_snell(c, n_i / n_o));
    return share * c * sqrtl(cos2_t) / powl(n_o * c - n_i * sqrtl(cos2_t), 2);
}
/* How much more than c they change, relative, for changes as large as `step`. */
static double conditioning(const scene *k, o_vec3 wo, ld c, int refracts, ld step) {
    const ld here = share_of(k, wo, c, refracts);
    const ld up = share_of(k, wo, fminl(1, c * (1 + step)), refracts);
    const ld down = share_of(k, wo, c * (1 - step), refracts);
    return (double)(fmaxl(fabsl(up - here), fabsl(down - here)) / (here * step));
}

/* The unit of densities, where D is d: 1e-6 (1 + |ln(d / its peak)|). */
static double unit_of(const scene *k, ld d) {
    return 1e-6 * (1 + fabs((double)logl(d * O_PI * (ld)k->alpha_x * (ld)k->alpha_y)));
}

static struct { double bent, mirrored, pdf_u, weight, pdf, eval, ratio; } worst;

/* A direction is off by what its half-vector is off, 4 eps, times the change of wi with h: 2 for reflection, and for
 * refraction |n_o c - q| / n_i with what the cosine moves, n_o^2 c / (n_i q). */
static void check_direction(const scene *k, o_vec3 wo, ld c, mcs_vec3 got, o_vec3 want, int refracts) {
    const double err = (double)fmaxl(fabsl(got.x - want.x), fmaxl(fabsl(got.y - want.y), fabsl(got.z - want.z))) / eps;
    double moves = 2;
    if (refracts) {
        const double n_o = (double)o_index_at(wo, k->eta);
        const double n_i = wo.z < 0 ? 1 : (double)k->eta;
        const double q = n_i * (double)sqrtl(o_snell(c, n_i / n_o));
        moves = fabs(n_o * (double)c - q) / n_i * (1 + n_o * (double)c / q);
    }
    double *const most = refracts ? &worst.bent : &worst.mirrored;
    *most = fmax(*most, err / (2 + 4 * moves));
    CHECK(err <= 2 + 8 * moves, "eta %a, wo %Lg %Lg %Lg: off by %g of 2^-24, moves %g", (double)k->eta, wo.x, wo.y,
          wo.z, err, moves);
}

static void check_sample(const scene *k, mcs_pcg32 *r) {
    const mcs_ggx m = mcs_ggx_make(k->alpha_x, k->alpha_y);
    const mcs_vec3 wo = direction((double)k->cosine, (double)k->azimuth);
    const o_vec3 o = wide_of(wo);
    const float u1 = mcs_pcg32_float(r);
    const float u2 = mcs_pcg32_float(r);
    const float u3 = mcs_pcg32_float(r);
    const mcs_brdf s = mcs_ggx_glass_sample(&m, k->eta, wo, u1, u2, u3);
    const ld c = o_ggx_glass_cos_u(k->alpha_x, k->alpha_y, o, u1, u2);
    const ld reflected = o_glass_share(k->eta, o, c, 0);
    const int refracts = u3 >= reflected;
    if (fabsl(u3 - reflected) <= 1e-3L * reflected) return; /* the fate may be the other one */
    const o_vec3 wi = o_ggx_glass_map(glass_of(k), o, u1, u2, refracts);
    const double far = conditioning(k, o, c, refracts, 1e-6L);
    if (!(far < 1e3)) return; /* at the critical angle */
    check_direction(k, o, c, s.wi, wi, refracts);
    if (fabsl(wi.z) < 1e-5L) return;
    const int lost = (wi.z * o.z < 0) != refracts;
    CHECK((s.pdf > 0) == !lost && (s.weight > 0) == !lost, "lost: pdf %g, weight %g", (double)s.pdf, (double)s.weight);
    if (lost) return;
    const o_view view = o_view_of(k->alpha_x, k->alpha_y, o_upwards(o), 0);
    const double unit = unit_of(k, o_visible_d_u(k->alpha_x, k->alpha_y, view, u1, u2));
    const ld pdf = o_ggx_glass_pdf_u(glass_of(k), o, u1, u2, refracts);
    const double err = (double)fabsl(s.pdf / pdf - 1);
    worst.pdf_u = fmax(worst.pdf_u, err / (unit * (1 + far)));
    CHECK(err <= (4 + far) * unit, "eta %a: pdf %g, not %Lg: off by %g of %g", (double)k->eta, (double)s.pdf, pdf, err,
          unit * far);
    const o_vec3 given = o_vec(wi.x, wi.y, s.wi.z); /* as with the other lobes, the cosine is that of the float */
    const ld weight =
        o_glass_g(k->alpha_x, k->alpha_y, o, given, refracts) / o_ggx_g1(k->alpha_x, k->alpha_y, o_upwards(o));
    const double weight_err = (double)fabsl(s.weight / weight - 1);
    worst.weight = fmax(worst.weight, weight_err);
    CHECK(weight_err <= 1e-6, "weight %g, not %Lg", (double)s.weight, weight);
}

/* The lengths of floats are off by some eps, which moves q^2 = (n_i wi.h)^2 by e against what Snell's law makes of
 * wo.h: q by the part e / (2 q^2) of itself. */
static double of_cosine(const scene *k, o_vec3 o, o_vec3 i) {
    const o_facet f = o_facet_of(k->eta, o, i);
    const ld e = fabsl(f.n_i * f.n_i * (o_dot(i, i) - 1)) + fabsl(f.n_o * f.n_o * (o_dot(o, o) - 1));
    return (double)(e / (2 * f.n_i * f.n_i * f.c_i * f.c_i));
}
/* Walter's J has wi.h, and the square of n_o wo.h + n_i wi.h, which feels it where the indices are alike. The header
 * takes q from wo.h. */
static double of_lengths(const scene *k, o_vec3 o, o_vec3 i) {
    const o_facet f = o_facet_of(k->eta, o, i);
    const double q = (double)(f.n_i * fabsl(f.c_i));
    if (!f.refracts) return 0;
    return of_cosine(k, o, i) * (1 + 2 * q / fabs((double)(f.n_o * f.c_o) - q));
}

/* Densities and f of the wi that a sample has. */
static void check_values(const scene *k, mcs_pcg32 *r) {
    const mcs_ggx m = mcs_ggx_make(k->alpha_x, k->alpha_y);
    const mcs_vec3 wo = direction((double)k->cosine, (double)k->azimuth);
    const float u1 = mcs_pcg32_float(r);
    const float u2 = mcs_pcg32_float(r);
    const mcs_brdf s = mcs_ggx_glass_sample(&m, k->eta, wo, u1, u2, mcs_pcg32_float(r));
    const mcs_vec3 wi = s.wi;
    const o_vec3 o = wide_of(wo);
    const o_vec3 i = wide_of(wi);
    const o_facet f = o_facet_of(k->eta, o, i);
    const ld want = o_ggx_glass_pdf(glass_of(k), o, i);
    const ld want_f = o_ggx_glass_eval(glass_of(k), o, i);
    const ld want_w = o_ggx_glass_weight(glass_of(k), o, i);
    const double pdf = (double)mcs_ggx_glass_pdf(&m, k->eta, wo, wi);
    const double value = (double)mcs_ggx_glass_eval(&m, k->eta, wo, wi);
    const double weight = (double)mcs_ggx_glass_weight(&m, k->eta, wo, wi);
    const double length = of_lengths(k, o, i);
    CHECK((pdf > 0) == (want > 0) || !(length < 0.1) || fabsl(f.c_o) < 1e-6L, "pdf %g, not %Lg", pdf, want);
    if (!(want > 0 && pdf > 0)) return;
    const double far = conditioning(k, o, f.c_o, f.refracts, 1e-6L);
    if (!(far < 1e3 && length < 0.1)) return;
    const double unit = unit_of(k, o_ggx_d(k->alpha_x, k->alpha_y, o_upwards(f.h)));
    const double tol = 3 * unit + 4 * eps * far + 1.1 * length;
    const double err = fabs(pdf / (double)want - 1);
    const double err_f = fabs(value / (double)want_f - 1);
    worst.pdf = fmax(worst.pdf, err / tol);
    worst.eval = fmax(worst.eval, err_f / tol);
    CHECK(err <= tol, "eta %a: pdf %g, not %Lg: off by %g of %g", (double)k->eta, pdf, want, err, tol);
    CHECK(err_f <= tol, "eta %a: f %g, not %Lg: off by %g of %g", (double)k->eta, value, want_f, err_f, tol);
    CHECK(fabs(weight / (double)want_w - 1) <= 1e-6, "weight %g, not %Lg", weight, want_w);
    worst.ratio = fmax(worst.ratio, fabs(weight / (double)want_w - 1));
    /* Symmetry: the same with wo and wi exchanged. */
    const double back = (double)mcs_ggx_glass_eval(&m, k->eta, wi, wo);
    const double far_i = conditioning(k, i, fabsl(f.c_i), f.refracts, 1e-6L);
    if (!(far_i < 1e3)) return;
    const double ratio = value / back * (double)(f.n_o * f.n_o / (f.n_i * f.n_i));
    CHECK(fabs(ratio - 1) <= 2 * tol + 4 * eps * far_i + 1.1 * (of_lengths(k, i, o) + far_i * of_cosine(k, o, i)),
          "f / n_i^2: ratio %.9g, tolerance %g", ratio, tol);
}

/* ---- what it has in common with its neighbours ---- */

static void check_neighbours(const scene *k, mcs_pcg32 *r) {
    const mcs_ggx m = mcs_ggx_make(k->alpha_x, k->alpha_y);
    const mcs_vec3 wo = direction(fabs((double)k->cosine), (double)k->azimuth);
    mcs_vec3 below = wo;
    below.z = -wo.z;
    const float u1 = mcs_pcg32_float(r);
    const float u2 = mcs_pcg32_float(r);
    const mcs_brdf s = mcs_ggx_glass_sample(&m, k->eta, wo, u1, u2, 0);
    const mcs_brdf v = mcs_ggx_vndf_sample(&m, wo, u1, u2);
    CHECK(mcst_contracts() || (s.wi.x == v.wi.x && s.wi.y == v.wi.y && s.wi.z == v.wi.z),
          "reflected as by mcs_ggx_vndf_sample");
    CHECK(fabs((double)s.weight - (double)v.weight) <= 8 * eps, "weight %g, not %g", (double)s.weight,
          (double)v.weight);
    const float f = mcs_fresnel_dielectric(mcs_cos_d(wo, v.wi), k->eta) * mcs_ggx_eval(&m, wo, v.wi);
    const float g = mcs_ggx_glass_eval(&m, k->eta, wo, v.wi);
    /* |wo + wi| / 2 and wo.h differ by what the lengths are off. */
    const double c = (double)mcs_cos_d(wo, v.wi);
    const double far = conditioning(k, wide_of(wo), (ld)c, 0, 1e-6L);
    if (v.pdf > 0 && far < 1e3) {
        const double unit = unit_of(k, o_ggx_d(k->alpha_x, k->alpha_y, o_add(wide_of(wo), wide_of(v.wi))));
        CHECK(fabs((double)g / (double)f - 1) <= 3 * unit + far * eps * (8 + 2 / (c * c)), "f %g, not %g", (double)g,
              (double)f);
    }
    /* The surface from behind is that of the inverse index; of 2 that is exact. */
    const float u3 = mcs_pcg32_float(r);
    const mcs_brdf a = mcs_ggx_glass_sample(&m, 2, below, u1, u2, u3);
    const mcs_brdf b = mcs_ggx_glass_sample(&m, 0.5f, wo, u1, u2, u3);
    CHECK(a.wi.x == b.wi.x && a.wi.y == b.wi.y && a.wi.z == -b.wi.z && a.pdf == b.pdf && a.weight == b.weight,
          "from behind: %g %g %g, not %g %g %g", (double)a.wi.x, (double)a.wi.y, (double)a.wi.z, (double)b.wi.x,
          (double)b.wi.y, (double)b.wi.z);
    mcs_vec3 wi = b.wi;
    wi.z = -wi.z;
    CHECK(mcs_ggx_glass_eval(&m, 2, below, wi) == mcs_ggx_glass_eval(&m, 0.5f, wo, b.wi), "f from behind");
}

/* The smoother, the less is lost; smooth glass is that of [fresnel]. */
static void check_smooth(void) {
    for (int i = 0; i < SCENES; i++) {
        const mcs_vec3 wo = direction((double)scenes[i].cosine, (double)scenes[i].azimuth);
        const mcs_vec3 up = {0, 0, 1};
        const float eta = scenes[i].eta;
        const mcs_vec3 bent = mcs_refract(wo, up, eta);
        double before = 0;
        for (float alpha = 0.3f; alpha > 1e-7f; alpha *= 0.1f) {
            const mcs_ggx m = mcs_ggx_make(alpha, alpha);
            mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 9);
            double sum = 0;
            mcs_brdf s;
            for (int n = 0; n < 4096; n++) {
                const float u1 = mcs_pcg32_float(&r);
                const float u2 = mcs_pcg32_float(&r);
                s = mcs_ggx_glass_sample(&m, eta, wo, u1, u2, mcs_pcg32_float(&r));
                sum += (double)s.weight / 4096;
            }
            CHECK(sum <= 1 + 1e-6 && sum >= before - 0.02, "alpha %g: %g", (double)alpha, sum);
            CHECK(alpha > 1e-4f || fabs(sum - 1) <= 1e-3, "alpha %g: %g", (double)alpha, sum);
            before = sum;
            s = mcs_ggx_glass_sample(&m, eta, wo, 0.3f, 0.2f, 0.9999999f);
            if (alpha < 1e-5f && bent.z != 0 && s.wi.z * wo.z < 0)
                CHECK(fabsf(s.wi.x - bent.x) <= 1e-4f && fabsf(s.wi.y - bent.y) <= 1e-4f, "eta %g: bent to %g %g",
                      (double)eta, (double)s.wi.x, (double)s.wi.y);
        }
    }
}

/* ---- equal indices, bad input ---- */

static void check_alike(mcs_pcg32 *r) {
    const mcs_ggx m = mcs_ggx_make(0.3f, 0.4f);
    for (int i = 0; i < 1000; i++) {
        const mcs_vec3 wo = direction(2 * uniform(r) - 1, i);
        const mcs_vec3 on = {-wo.x, -wo.y, -wo.z};
        const mcs_vec3 other = direction(2 * uniform(r) - 1, 2 * i);
        const float u1 = mcs_pcg32_float(r);
        const mcs_brdf s = mcs_ggx_glass_sample(&m, 1, wo, u1, mcs_pcg32_float(r), i % 2 ? 0 : mcs_pcg32_float(r));
        const o_vec3 up = o_upwards(wide_of(wo));
        CHECK(fabsf(s.wi.x - on.x) <= 0x1p-23f && fabsf(s.wi.y - on.y) <= 0x1p-23f && fabsf(s.wi.z - on.z) <= 0x1p-23f,
              "not straight on");
        CHECK(s.pdf == FLT_MAX && fabsl(s.weight - o_ggx_g1(0.3f, 0.4f, up)) <= 1e-6L, "pdf %g, weight %g",
              (double)s.pdf, (double)s.weight);
        CHECK(mcs_ggx_glass_pdf(&m, 1, wo, on) == 0 && mcs_ggx_glass_eval(&m, 1, wo, on) == 0 &&
                  mcs_ggx_glass_weight(&m, 1, wo, s.wi) == 0 && mcs_ggx_glass_pdf(&m, 1, wo, other) == 0 &&
                  mcs_ggx_glass_eval(&m, 1, wo, other) == 0,
              "given directions");
    }
}

static int nothing(mcs_brdf s) {
    return s.pdf == 0 && s.weight == 0 && isfinite(s.wi.x) && isfinite(s.wi.y) && isfinite(s.wi.z);
}

static void check_bad(void) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, -1, 2, 1, 0, -0.0f, 1e-45f, 9.9e-4f, 1.01e3f, FLT_MAX};
    enum { ODD = (int)(sizeof odd / sizeof *odd) };
    const mcs_ggx m = mcs_ggx_make(0.3f, 0.4f);
    const mcs_ggx bad = mcs_ggx_make(0, 0.4f);
    const mcs_vec3 w = {0.6f, 0, 0.8f};
    const mcs_vec3 v = {-0.36f, 0.48f, -0.8f};
    const mcs_vec3 level = {0.6f, 0.8f, 0};
    CHECK(nothing(mcs_ggx_glass_sample(&bad, 1.5f, w, 0.5f, 0.5f, 0.5f)), "bad material");
    CHECK(nothing(mcs_ggx_glass_sample(&m, 1.5f, level, 0.5f, 0.5f, 0.5f)), "level wo");
    CHECK(mcs_ggx_glass_pdf(&m, 1.5f, w, v) > 0 && mcs_ggx_glass_eval(&m, 1.5f, v, w) > 0, "good");
    CHECK(mcs_ggx_glass_pdf(&bad, 1.5f, w, v) == 0 && mcs_ggx_glass_eval(&bad, 1.5f, w, v) == 0 &&
              mcs_ggx_glass_weight(&bad, 1.5f, w, v) == 0,
          "bad material");
    CHECK(mcs_ggx_glass_pdf(&m, 1.5f, level, v) == 0 && mcs_ggx_glass_eval(&m, 1.5f, w, level) == 0 &&
              mcs_ggx_glass_weight(&m, 1.5f, w, level) == 0,
          "level");
    for (int i = 0; i < ODD; i++) {
        const float x = odd[i];
        const mcs_vec3 none = {x, 0, x};
        if (!(x >= 0 && x < 1))
            CHECK(nothing(mcs_ggx_glass_sample(&m, 1.5f, w, x, 0.5f, 0.5f)) &&
                      nothing(mcs_ggx_glass_sample(&m, 1.5f, w, 0.5f, x, 0.5f)) &&
                      nothing(mcs_ggx_glass_sample(&m, 1.5f, w, 0.5f, 0.5f, x)),
                  "u = %g", (double)x);
        if (!(x >= 1e-3f && x <= 1e3f))
            CHECK(nothing(mcs_ggx_glass_sample(&m, x, w, 0.5f, 0.5f, 0.5f)) && mcs_ggx_glass_pdf(&m, x, w, v) == 0 &&
                      mcs_ggx_glass_eval(&m, x, w, v) == 0 && mcs_ggx_glass_weight(&m, x, w, v) == 0,
                  "eta = %g", (double)x);
        if (x != 1 && x != -1)
            CHECK(nothing(mcs_ggx_glass_sample(&m, 1.5f, none, 0.5f, 0.5f, 0.5f)) &&
                      mcs_ggx_glass_pdf(&m, 1.5f, none, v) == 0 && mcs_ggx_glass_eval(&m, 1.5f, w, none) == 0,
                  "direction of %g", (double)x);
    }
}

int main(int argc, char **argv) {
    enum { MANY = 200000 };
    mcst_start(argc, argv);
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 307);
    mcst_group("glass");
    if (mcst_contracts()) puts("SKIPPED: the bits of the directions of GGX, as this build contracts a*b + c");
    for (int i = 0; i < SCENES; i++)
        if (mcst_case("chi-square: alphas %g %g, eta %g, cosine %g", (double)scenes[i].alpha_x,
                      (double)scenes[i].alpha_y, (double)scenes[i].eta, (double)scenes[i].cosine))
            check_sphere(&scenes[i], &r);
    if (mcst_case("samples")) {
        for (int i = 0; i < MANY; i++) {
            const scene k = any_scene(&r);
            check_sample(&k, &r);
        }
        mcst_note("    mirrored %.3f, bent %.3f, pdf %.3f, weight %.3g\n", worst.mirrored, worst.bent, worst.pdf_u,
                  worst.weight);
    }
    if (mcst_case("values, symmetry")) {
        for (int i = 0; i < MANY; i++) {
            const scene k = any_scene(&r);
            check_values(&k, &r);
        }
        mcst_note("    pdf %.3f, f %.3f, weight %.3g\n", worst.pdf, worst.eval, worst.ratio);
    }
    if (mcst_case("reflection is that of GGX, and from behind it is the inverse index"))
        for (int i = 0; i < MANY / 10; i++) {
            const scene k = any_scene(&r);
            check_neighbours(&k, &r);
        }
    if (mcst_case("smooth: nothing is lost")) check_smooth();
    if (mcst_case("equal indices")) check_alike(&r);
    if (mcst_case("bad input")) check_bad();
    return mcst_finish();
}
