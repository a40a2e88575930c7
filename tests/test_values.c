/* Values that no sampler test looks at closely: D, G1 and G2 of GGX, the cone of a sine, what a wide alpha magnifies,
 * what the length of a half-vector must not do, the detours' sine and cosine, the steps of R2, mixtures with a bad
 * share, the row of a direction beside a border, cells that only a guard keeps. All against long double. EPS = 2^-24 is
 * half an ulp of 1. */
#include "arena.h"
#include "registry.h"

#define EPS 0x1p-24

static void random_direction(uint64_t *state, float lowest,
                             float w[3]) { /* cosines from 1 to `lowest`, evenly in the logarithm */
    float u, v;
    mcst_uniform(state, 1, &u, &v);
    w[2] = (float)pow((double)lowest, (double)u);
    const double s = sqrt((1 - (double)w[2]) * (1 + (double)w[2]));
    w[0] = (float)(s * cos(6.283185307179586 * (double)v));
    w[1] = (float)(s * sin(6.283185307179586 * (double)v));
}

static mcs_vec3 vec3(const float *w) {
    mcs_vec3 v;
    v.x = w[0];
    v.y = w[1];
    v.z = w[2];
    return v;
}

static ld relative(float got, ld want) { return fabsl((ld)got - want) / want; }

/* ---- GGX ---- */

static ld ggx_t(ld ax, ld ay, o_vec3 w) { return sqrtl(ax * ax * w.x * w.x + ay * ay * w.y * w.y + w.z * w.z); }

/* Roundings, in EPS. t: a product and its square 3, two sums 2, half of it for the root and 1 more: 3.5. G1: 2 z/(z +
 * t): a sum and a quotient more, 5.5. G2: products z t 1, a sum, two products above it, a quotient: 8.5. D: 1/alpha and
 * the product with it 2, squared 5, two sums 7; |h|^2 4, a quotient 1: 12 of q, 25 of its square; 1/pi, two 1/alpha,
 * two products and one more 6: 31. */
static void ggx_values(float ax, float ay, uint64_t seed) {
    const mcs_ggx m = mcs_ggx_make(ax, ay);
    const ld a = (ld)ax;
    const ld b = (ld)ay;
    for (int k = 0; k < 2000; k++) {
        float o[3];
        random_direction(&seed, 1e-6f, o);
        float i[3];
        random_direction(&seed, 1e-6f, i);
        {
            const o_vec3 wo = mcst_o3(o);
            const o_vec3 wi = mcst_o3(i);
            const ld to = ggx_t(a, b, wo);
            const ld ti = ggx_t(a, b, wi);
            const ld d = o_ggx_d(a, b, wo);
            const ld g1 = 2 * wo.z / (wo.z + to);
            const ld g2 = 2 * wo.z * wi.z / (wo.z * ti + wi.z * to);
            const float got_d = mcs_ggx_d(&m, vec3(o));
            const float got1 = mcs_ggx_g1(&m, vec3(o));
            const float got2 = mcs_ggx_g2(&m, vec3(o), vec3(i));
            if (d < (ld)FLT_MAX && d > (ld)FLT_MIN)
                CHECK(relative(got_d, d) <= 32 * EPS, "D at %g %g %g: %g, not %Lg", (double)o[0], (double)o[1],
                      (double)o[2], (double)got_d, d);
            CHECK(relative(got1, g1) <= 6 * EPS, "G1 at %g %g %g: %g, not %Lg", (double)o[0], (double)o[1],
                  (double)o[2], (double)got1, g1);
            CHECK(relative(got2, g2) <= 9 * EPS, "G2 at %g %g %g, %g %g %g: %g, not %Lg", (double)o[0], (double)o[1],
                  (double)o[2], (double)i[0], (double)i[1], (double)i[2], (double)got2, g2);
        }
        i[2] = -i[2];
        CHECK(mcs_ggx_d(&m, vec3(i)) == 0 && mcs_ggx_g1(&m, vec3(i)) == 0 && mcs_ggx_g2(&m, vec3(o), vec3(i)) == 0 &&
                  mcs_ggx_g2(&m, vec3(i), vec3(o)) == 0,
              "below the surface, %g %g %g: D %g, G1 %g, G2 %g", (double)i[0], (double)i[1], (double)i[2],
              (double)mcs_ggx_d(&m, vec3(i)), (double)mcs_ggx_g1(&m, vec3(i)),
              (double)mcs_ggx_g2(&m, vec3(o), vec3(i)));
    }
}

/* Half-vectors within a slope of 10 of the normal, where a wide alpha magnifies the rounding of what it stretches: the
 * density of u, within E of the header, which is 1e-6 at least. */
static void wide_alphas(const mcst_row *row, float ax, float ay) {
    const int bounded = strstr(row->name, "bounded") != NULL;
    uint64_t seed = mcst_seed_for(row->name, "wide", ax > ay);
    int tried = 0;
    for (int k = 0; k < 20000; k++) {
        float v[2];
        mcst_uniform(&seed, 1, &v[0], &v[1]);
        float p[MCST_P];
        p[0] = ax;
        p[1] = ay;
        p[2] = 0;
        random_direction(&seed, 1e-4f, p + 3);
        const double slope = pow(10, 2.5 * (double)v[0] - 1.5);
        const double turn = 6.283185307179586 * (double)v[1];
        const o_vec3 h = o_unit(o_vec((ld)(slope * cos(turn)), (ld)(slope * sin(turn)), 1));
        o_vec2 at;
        if (bounded) at = o_ggx_bounded_h_invert((ld)ax, (ld)ay, mcst_o3(p + 3), h);
        else at = o_ggx_vndf_h_invert((ld)ax, (ld)ay, mcst_o3(p + 3), h);
        float u[2];
        u[0] = (float)at.x;
        u[1] = (float)at.y;
        if (!(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1)) continue; /* no half-vector of this wo */
        float out[5];
        row->fn[0].sample(p, &u[0], &u[1], out);
        const ld want = row->truth.pdf_u(p, (ld)u[0], (ld)u[1]);
        if (!(out[3] > 0 && want > 0)) continue; /* lost */
        tried++;
        CHECK(relative(out[3], want) <= 1e-6L, "wo %g %g %g, u %a %a: %.9g, not %.9Lg", (double)p[3], (double)p[4],
              (double)p[5], (double)u[0], (double)u[1], (double)out[3], want);
    }
    CHECK(tried >= 5000, "%d half-vectors", tried);
}

/* Alphas count as the nearer end of [1e-7, 1e4]. D of the normal is 1/(pi ax ay): 1/pi, two reciprocals and two
 * products, of alphas that are floats (1e-7 is not: 1 more): 6. */
static void ends_of_alpha(void) {
    static const float alpha[][2] = {{1e-7f, 1e-7f}, {1e-9f, 1e-7f},  {0x1p-149f, 1e-7f}, {3e-7f, 3e-7f},
                                     {5e-6f, 5e-6f}, {1e4f, 1e4f},    {1e5f, 1e4f},       {FLT_MAX, 1e4f},
                                     {5e3f, 5e3f},   {INFINITY, 1e4f}};
    const mcs_vec3 up = {0, 0, 1};
    for (size_t i = 0; i < MCST_COUNT(alpha); i++) {
        const mcs_ggx x = mcs_ggx_make(alpha[i][0], 0.5f);
        const mcs_ggx y = mcs_ggx_make(0.5f, alpha[i][0]);
        const ld want = 1 / (O_PI * 0.5L * (ld)alpha[i][1]);
        CHECK(relative(mcs_ggx_d(&x, up), want) <= 8 * EPS && relative(mcs_ggx_d(&y, up), want) <= 8 * EPS,
              "alpha %g: %g and %g, not %Lg", (double)alpha[i][0], (double)mcs_ggx_d(&x, up), (double)mcs_ggx_d(&y, up),
              want);
    }
    CHECK(mcs_is_mirror(1e-8f, 9e-8f) && !mcs_is_mirror(1e-8f, 1e-7f) && !mcs_is_mirror(0.1f, 1e-8f) &&
              !mcs_is_mirror(1e-7f, 1e-7f),
          "mirrors");
}

/* ---- half-vectors at right angles to wo ---- */

/* wo.h below 1/8: its terms cancel, its own rounding would be 8 of them and more. With it to half an ulp the density
 * has (1 - u1) and its product with the norm (6: see D above), |p|^2 3, squared and with g 8, the quotient by 4 wo.h 1:
 * 16 EPS. */
static void cancelling_cosines(const mcst_row *row, float a, float b) {
    uint64_t seed = mcst_seed_for(row->name, "cancel", a > b);
    int tried = 0;
    for (int k = 0; k < 60000; k++) {
        float u[2];
        mcst_uniform(&seed, 1, &u[0], &u[1]);
        float v[2];
        mcst_uniform(&seed, 1, &v[0], &v[1]);
        float p[MCST_P];
        mcst_fill(row, a, b, (float)(0.25 * pow(10, -3 * (double)v[0])), 6.2831853f * v[1], p);
        const ld want = row->truth.pdf_u(p, (ld)u[0], (ld)u[1]);
        if (!(want > 0)) continue;
        ld x[3];
        row->truth.map(p, (ld)u[0], (ld)u[1], x);
        const o_vec3 wo = mcst_o3(p + 3);
        if (o_dot(wo, o_half(wo, o_vec(x[0], x[1], x[2]))) > 0.125L) continue;
        float out[5];
        row->fn[0].sample(p, &u[0], &u[1], out);
        if (!(out[3] > 0)) continue;
        tried++;
        CHECK(relative(out[3], want) <= 16 * EPS, "wo %g %g %g, u %a %a: %.9g, not %.9Lg", (double)p[3], (double)p[4],
              (double)p[5], (double)u[0], (double)u[1], (double)out[3], want);
    }
    CHECK(tried >= 1000, "%d half-vectors", tried);
}

/* ---- Ashikhmin and Shirley ---- */

/* The half-vector is up to 4 ulp off unit length, and 2 (h.wo) h - wo would carry twice that into wi, across it as well
 * as along. Where |h|^2 is off by 2 EPS or more, its correction is right to the rounding of |h|^2 and of 2 - |h|^2, EPS
 * each, which does not depend on how far off |h|^2 is: the regression of the error of wi on what the length alone would
 * do is far below 1/2; it is 1 without correction. */
static void reflection_at_rounded_half(void) {
    uint64_t seed = mcst_seed_for("ashikhmin", "length", 0);
    double xx = 0;
    double xy = 0;
    int n = 0;
    for (int k = 0; k < 1500000; k++) {
        const float wo[3] = {0.6f * 0.70710678f, 0.8f * 0.70710678f, 0.70710678f};
        float u[4];
        mcst_uniform(&seed, 2, &u[0], &u[2]);
        u[0] = 1 - u[0] * u[0];
        if (!(u[0] < 1)) continue;
        const mcs_ashikhmin m =
            mcs_ashikhmin_make((float)pow(10, 5 * (double)u[1]), (float)pow(10, 5 * (double)u[3] - 2));
        mcs_vec3 h = mcs_ashikhmin_h_sample(&m, u[0], u[2]).w;
        const ld off = o_dot(o_v3(h.x, h.y, h.z), o_v3(h.x, h.y, h.z)) - 1;
        if (fabsl(off) < 2 * EPS) continue;
        mcs_brdf s = mcs_ashikhmin_sample(&m, vec3(wo), u[0], u[2]);
        if (!(s.pdf > 0)) continue;
        const o_vec3 unit = o_unit(o_v3(h.x, h.y, h.z));
        const o_vec3 exact = o_reflect(mcst_o3(wo), unit);
        const ld c = o_dot(unit, exact);
        const o_vec3 across = o_add(unit, o_scale(-c, exact));
        const ld sine = o_len(across);
        if (sine * c < 0.3L) continue; /* nothing goes across */
        const ld err = o_dot(o_add(o_v3(s.wi.x, s.wi.y, s.wi.z), o_scale(-1, exact)), across) / sine;
        n++;
        xx += (double)(2 * c * sine * off * (2 * c * sine * off));
        xy += (double)(2 * c * sine * off * err);
    }
    CHECK(n >= 1000, "%d half-vectors of that length", n);
    CHECK(fabs(xy / xx) <= 0.5, "%g of the rounding of the length goes into the direction", xy / xx);
}

/* ---- one number ---- */

/* k = 1 - sqrt(1 - s) as s/(1 + sqrt(1 - s)): 1 - s EPS, of which its root has half and 1 more; that is half of the sum
 * at most, whose rounding is 1 more, the quotient 1: 2.75. */
static void cones(void) {
    uint64_t seed = mcst_seed_for("cone", "sine", 0);
    for (int i = 0; i < 100000; i++) {
        float u, v;
        mcst_uniform(&seed, 1, &u, &v);
        const float s = i % 2 ? u : (float)pow(10, -30 * (double)u);
        const float k = mcs_cone_from_sin2(s);
        const ld want = (ld)s / (1 + sqrtl(1 - (ld)s));
        if (s > 0) CHECK(relative(k, want) <= 3 * EPS, "sin^2 = %g: %g, not %Lg", (double)s, (double)k, want);
    }
    CHECK(mcs_cone_from_sin2(0) == 0 && mcs_cone_from_sin2(-1) == 0 && mcs_cone_from_sin2(1) == 1 &&
              mcs_cone_from_sin2(2) == 1,
          "at the ends, and beyond: %g %g %g %g", (double)mcs_cone_from_sin2(0), (double)mcs_cone_from_sin2(-1),
          (double)mcs_cone_from_sin2(1), (double)mcs_cone_from_sin2(2));
}

/* To 1e-12, as its comment says: two series to x^13 and x^14 on an eighth of a turn leave x^15/15! = 2e-14, arguments
 * 4e-16. */
static void detour_angles(void) {
    for (int i = 0; i <= 100000; i++) {
        const double t = i / 100000.0;
        double s, c;
        mcsi_sincos_d(t, &s, &c);
        ld sine, cosine;
        o_sincos2pi((ld)t, &sine, &cosine);
        CHECK(fabsl((ld)s - sine) <= 1e-12L && fabsl((ld)c - cosine) <= 1e-12L, "t = %g: off by %Lg and %Lg", t,
              (ld)s - sine, (ld)c - cosine);
    }
}

/* Steps 1/g and 1/g^2, g^3 = g + 1: each is a multiple of 2^-32, off by half of one, and a coordinate is cut to 2^-24.
 */
static void r2_steps(void) {
    ld g = 1.3L;
    for (uint32_t i = 0; i < 30; i++) g -= (g * g * g - g - 1) / (3 * g * g - 1);
    for (uint32_t i = 1; i <= 4096; i++) {
        const mcs_vec2 first = mcs_r2(0, 5);
        const mcs_vec2 p = mcs_r2(i, 5);
        const ld x = (ld)p.x - (ld)first.x - (ld)i / g;
        const ld y = (ld)p.y - (ld)first.y - (ld)i / (g * g);
        const ld bound = (ld)i * 0x1p-33L + 0x1p-24L;
        CHECK(fabsl(x - rintl(x)) <= bound && fabsl(y - rintl(y)) <= bound, "point %u: off by %Lg and %Lg", i,
              x - rintl(x), y - rintl(y));
    }
}

/* Densities of points and directions without a lobe, within what the header says: in E, 1e-6 as they are constant or
 * cosines. */
static void constants(const char *name, double bound) {
    const mcst_row *row = mcst_find(name);
    uint64_t seed = mcst_seed_for(name, "constants", 0);
    for (int k = 0; k < 3000; k++) {
        float p[MCST_P];
        mcst_grid_get(row, (size_t)k % mcst_grid_count(row), p);
        float u[2];
        mcst_uniform(&seed, 1, &u[0], &u[1]);
        float out[5];
        row->fn[0].sample(p, &u[0], &u[1], out);
        ld want = row->truth.pdf_u(p, (ld)u[0], (ld)u[1]);
        CHECK(relative(out[3], want) <= bound * 1e-6L, "%s: pdf of u %.9g, not %.9Lg", name, (double)out[3], want);
        float pdf;
        row->fn[0].pdf(p, out, &pdf);
        want = row->truth.pdf(p, out);
        const ld off =
            row->dim == 3 ? fabsl(o_len(mcst_o3(out)) - 1) : 0; /* densities of directions are of unit ones */
        if (want > 0)
            CHECK(relative(pdf, want) <= bound * 1e-6L + off, "%s: pdf of x %.9g, not %.9Lg", name, (double)pdf, want);
    }
}

/* Densities of the truth are the slopes of its maps: u1 over 1 - z, by the azimuths. Bins by the truth could not tell. A
 * central difference of 2e-7 is off by the square of 1e-7 over the distance of u1 from 0 and 1, which is 1e-2 or more; a
 * power of g near 1 is three times as steep. Distances from the nearer pole have 2^-62 of themselves or more. */
static void slopes(const mcst_row *row, const float *p) {
    const ld step = 1e-7L;
    for (int k = 1; k < 100; k++) {
        const ld u1 = k / 100.0L;
        ld m[2];
        ld middle[3];
        row->truth.map(p, u1, 0.3L, middle);
        for (int i = 0; i < 2; i++) {
            ld x[3];
            row->truth.map(p, i ? u1 + step : u1 - step, 0.3L, x);
            m[i] =
                middle[2] > 0 ? o_one_minus_cos(o_vec(x[0], x[1], x[2])) : -o_one_minus_cos(o_vec(x[0], x[1], -x[2]));
        }
        const ld want = 2 * step / (2 * O_PI * (m[1] - m[0]));
        const ld got = row->truth.pdf_u(p, u1, 0.3L);
        CHECK(fabsl(got / want - 1) <= 1e-8L, "u1 = %Lg: density %.9Lg, slope %.9Lg", u1, got, want);
    }
}

/* At |g| = 1 all is at one pole. At 0 the density is that of sphere, to the bit, and so is the map, but for the rounding
 * of a sine. */
static void ends_of_henyey_greenstein(void) {
    static const float some[] = {0, 0x1p-149f, 0x1p-24f, 0.3f, 0.5f, 0.9f, 1 - 0x1p-24f};
    const mcs_vec3 aside = {0x1p-20f, 0, 1};
    const mcs_vec3 aside_below = {0, 0x1p-20f, -1};
    for (int i = 0; i < 49; i++) {
        const float u1 = some[i / 7];
        const float u2 = some[i % 7];
        for (int k = -1; k < 2; k += 2) {
            const float g = (float)k;
            const mcs_dir s = mcs_henyey_greenstein_sample(g, u1, u2);
            CHECK(s.w.x == 0 && s.w.y == 0 && s.w.z == g && s.pdf == FLT_MAX, "g = %g, u %g %g: %g %g %g, pdf %g",
                  (double)g, (double)u1, (double)u2, (double)s.w.x, (double)s.w.y, (double)s.w.z, (double)s.pdf);
            CHECK(mcs_henyey_greenstein_pdf(g, s.w) == FLT_MAX, "g = %g: pdf at the pole", (double)g);
            CHECK(mcs_henyey_greenstein_pdf(-g, s.w) == 0, "g = %g: pdf at the other pole", (double)-g);
        }
        const mcs_dir even = mcs_sphere_sample(u1, u2);
        const mcs_dir s = mcs_henyey_greenstein_sample(0, u1, u2);
        CHECK(s.pdf == even.pdf && mcs_henyey_greenstein_pdf(0, s.w) == even.pdf && s.w.z == even.w.z &&
                  fabsf(s.w.x - even.w.x) <= 2 * (float)EPS && fabsf(s.w.y - even.w.y) <= 2 * (float)EPS,
              "g = 0, u %g %g: pdf %.9g, z %.9g, not %.9g", (double)u1, (double)u2, (double)s.pdf, (double)s.w.z,
              (double)even.w.z);
    }
    CHECK(mcs_henyey_greenstein_pdf(1, aside) == 0 && mcs_henyey_greenstein_pdf(-1, aside_below) == 0,
          "beside the poles");
}

/* Where kappa is below 1e-8 all is that of sphere, but for the rounding of a sine; where it is not, still nearly so. */
static void ends_of_von_mises_fisher(void) {
    static const float some[] = {0, 0x1p-149f, 0x1p-24f, 0.3f, 0.5f, 0.9f, 1 - 0x1p-24f};
    static const float flat[] = {0, 0x1p-149f, 1e-20f, 0.99999994e-8f, 1.00000011e-8f};
    for (int i = 0; i < 49 * 5; i++) {
        const float u1 = some[i % 7];
        const float u2 = some[i / 7 % 7];
        const float kappa = flat[i / 49];
        const mcs_dir even = mcs_sphere_sample(u1, u2);
        const mcs_dir s = mcs_von_mises_fisher_sample(kappa, u1, u2);
        CHECK(fabsf(s.w.x - even.w.x) <= 2 * (float)EPS && fabsf(s.w.y - even.w.y) <= 2 * (float)EPS &&
                  fabsf(s.w.z - even.w.z) <= 2 * (float)EPS,
              "kappa %g, u %g %g: z %.9g, not %.9g", (double)kappa, (double)u1, (double)u2, (double)s.w.z,
              (double)even.w.z);
        CHECK(relative(s.pdf, (ld)even.pdf) <= 2e-7L &&
                  relative(mcs_von_mises_fisher_pdf(kappa, s.w), (ld)even.pdf) <= 3e-7L,
              "kappa %g: pdf %.9g", (double)kappa, (double)s.pdf);
        CHECK(kappa >= 1e-8f || (s.pdf == even.pdf && mcs_von_mises_fisher_pdf(kappa, s.w) == even.pdf),
              "kappa %g: pdf %.9g", (double)kappa, (double)s.pdf);
    }
}

/* ---- lights, as they are seen from the origin ---- */

static const mcs_vec3 origin = {0, 0, 0};

/* A centre within 1 of the point by coordinate; some lie nearly along z, or nearly across it. */
static mcs_vec3 any_centre(uint64_t *state) {
    float u[4];
    mcst_uniform(state, 2, u, u + 2);
    mcs_vec3 c = {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
    if (u[3] < 0.2f) c.z *= 1e-6f;
    if (u[3] > 0.8f) {
        c.x *= 1e-6f;
        c.y *= 1e-6f;
    }
    return c;
}
/* What the header says of a ball whose radius is `ratio` times the distance of its centre, of random numbers and of those
 * at the rim. Density and distance are rounded once, and are good to 1e-8 before. */
static void balls(double least, double most) {
    uint64_t state = mcst_seed_for("ball", "values", (size_t)(1e3 * least));
    for (int i = 0; i < 200000; i++) {
        float u[2];
        float v[2];
        const mcs_vec3 c = any_centre(&state);
        const o_vec3 centre = o_v3(c.x, c.y, c.z);
        mcst_uniform(&state, 2, u, v);
        const double log_ratio = log(least) + (double)v[0] * log(most / least);
        const double ratio = least > 0.5 && i % 2 ? most - (most - least) * pow(1e-7, (double)v[0]) : exp(log_ratio);
        const float r = (float)(ratio * (double)o_len(centre));
        if (i % 8 == 0) u[0] = 1 - 0x1p-24f;
        const mcs_light s = mcs_ball_sample(origin, c, r, u[0], u[1]);
        const float pdf = mcs_ball_pdf(origin, c, r, s.w);
        const o_vec3 w = o_ball_map(centre, (ld)r, (ld)u[0], (ld)u[1]);
        const o_vec3 off = o_add(o_v3(s.w.x, s.w.y, s.w.z), o_scale(-1, w));
        const ld err = fmaxl(fmaxl(fabsl(off.x), fabsl(off.y)), fabsl(off.z));
        const ld want = o_ball_pdf_u(centre, (ld)r, (ld)u[0], (ld)u[1]);
        const ld distance = o_ball_distance(centre, (ld)r, w);
        CHECK(err <= 1.25 * 2 * EPS && relative(s.pdf, want) <= 7e-8L && relative(pdf, want) <= 7e-8L &&
                  relative(s.distance, distance) <= 7e-8L,
              "c (%a, %a, %a), r %a, u %a %a: w off by %Lg, pdf %.9g and %.9g, not %.9Lg, distance %.9g, not %.9Lg",
              (double)c.x, (double)c.y, (double)c.z, (double)r, (double)u[0], (double)u[1], err, (double)s.pdf,
              (double)pdf, want, (double)s.distance, distance);
    }
}
/* On the surface, and in the middle; just past the rim; a ball that is too small; one that hardly fits into floats. */
static void ends_of_balls(void) {
    const mcs_vec3 ahead = {0, 0, 1};
    const mcs_vec3 at = {0, 0, 0};
    for (int i = 0; i < 100; i++) {
        const float u1 = (float)i / 100;
        const mcs_light on = mcs_ball_sample(origin, ahead, 1, u1, 0.3f);
        const mcs_light in = mcs_ball_sample(origin, at, 3, u1, 0.3f);
        CHECK(relative(on.pdf, 0.25L / O_PI) <= EPS && fabsf(on.distance - 2 * fmaxf(1 - 2 * u1, 0)) <= 2 * (float)EPS,
              "on the surface, u1 = %g: pdf %.9g, distance %.9g", (double)u1, (double)on.pdf, (double)on.distance);
        CHECK(in.pdf == on.pdf && in.distance == 3 && fabsf(in.w.z - (1 - 2 * u1)) <= 2 * (float)EPS,
              "in the middle, u1 = %g: pdf %.9g, distance %.9g", (double)u1, (double)in.pdf, (double)in.distance);
    }
    for (int i = 0; i < 6; i++) {
        const float r = (float)pow(10, -i);
        const double rim = asin((double)r / 2);
        const mcs_vec3 c = {0, 0, 2};
        const mcs_vec3 inside = {(float)sin(rim + 0x1p-25), 0, (float)cos(rim + 0x1p-25)};
        const mcs_vec3 past = {(float)sin(rim * (1 + 1e-6) + 0x1p-22), 0, (float)cos(rim * (1 + 1e-6) + 0x1p-22)};
        CHECK(mcs_ball_pdf(origin, c, r, inside) > 0 && mcs_ball_pdf(origin, c, r, past) == 0,
              "r = %g: pdf %g past the rim", (double)r, (double)mcs_ball_pdf(origin, c, r, past));
    }
    const mcs_light speck = mcs_ball_sample(origin, ahead, 1e-18f, 0.5f, 0.5f);
    CHECK(relative(speck.pdf, 1 / (O_PI * 1e-30L)) <= 1e-6L && speck.distance == 1 && speck.w.z == 1,
          "a speck: pdf %g, distance %.9g", (double)speck.pdf, (double)speck.distance);
    const mcs_vec3 far_away = {-1e18f, 1e18f, -1e18f};
    const mcs_light sun = mcs_ball_sample(origin, far_away, 1e18f, 0.5f, 0.5f);
    CHECK(sun.distance > 7e17f && sun.distance < 1.8e18f && sun.pdf > 0, "a sun: pdf %g, distance %g", (double)sun.pdf,
          (double)sun.distance);
}

/* What the header says of a disk whose radius is `ratio` times the distance of its centre. `level` of the height of that
 * above the point is taken away, so that some disks are seen from their edge. */
static void disk_lights(double ratio, float level) {
    uint64_t state = mcst_seed_for("disk_light", "values", (size_t)(1e3 * ratio));
    for (int i = 0; i < 100000; i++) {
        float u[2];
        float v[2];
        mcst_uniform(&state, 2, u, v);
        const mcs_vec3 n = mcs_sphere_sample(v[0], v[1]).w;
        mcs_vec3 c = any_centre(&state);
        const float r = (float)(ratio * (double)o_len(o_v3(c.x, c.y, c.z)));
        const float height = level * (c.x * n.x + c.y * n.y + c.z * n.z);
        c.x -= height * n.x;
        c.y -= height * n.y;
        c.z -= height * n.z;
        const o_vec3 centre = o_v3(c.x, c.y, c.z);
        const o_vec3 normal = o_v3(n.x, n.y, n.z);
        const o_vec3 w = o_disk_light_map(centre, normal, (ld)r, (ld)u[0], (ld)u[1]);
        const ld distance = o_len(o_disk_light_point(centre, normal, (ld)r, (ld)u[0], (ld)u[1]));
        if (distance < 1e-4L * (ld)r || fabsl(o_dot(w, normal)) < 1.1e-7L) continue;
        const mcs_light s = mcs_disk_light_sample(origin, c, n, r, u[0], u[1]);
        const o_vec3 off = o_add(o_v3(s.w.x, s.w.y, s.w.z), o_scale(-1, w));
        const ld err = fmaxl(fmaxl(fabsl(off.x), fabsl(off.y)), fabsl(off.z));
        const ld want = o_disk_light_pdf_u(centre, normal, (ld)r, (ld)u[0], (ld)u[1]);
        const ld want_w = o_disk_light_pdf(centre, normal, (ld)r, o_v3(s.w.x, s.w.y, s.w.z));
        const float pdf = mcs_disk_light_pdf(origin, c, n, r, s.w);
        CHECK(err <= EPS && relative(s.pdf, want) <= 1e-7L && relative(s.distance, distance) <= 1e-7L,
              "c (%a, %a, %a), r %a, u %a %a: w off by %Lg, pdf %.9g, not %.9Lg, distance %.9g, not %.9Lg", (double)c.x,
              (double)c.y, (double)c.z, (double)r, (double)u[0], (double)u[1], err, (double)s.pdf, want,
              (double)s.distance, distance);
        if (fabsl(o_dot(w, normal)) > 1e-6L)
            CHECK(relative(pdf, want_w) <= 1e-7L, "c (%a, %a, %a), r %a, u %a %a: pdf of w %.9g, not %.9Lg",
                  (double)c.x, (double)c.y, (double)c.z, (double)r, (double)u[0], (double)u[1], (double)pdf, want_w);
    }
}
/* In the plane, in the middle, behind, past the rim, and where floats end. */
static void ends_of_disk_lights(void) {
    const mcs_vec3 up = {0, 0, 1};
    const mcs_vec3 down = {0, 0, -1};
    const mcs_vec3 at = {0, 0, 0};
    const mcs_vec3 beside = {2, 0, 0};
    const mcs_vec3 above = {0, 0, 2};
    const mcs_light edge = mcs_disk_light_sample(origin, beside, up, 1, 0.3f, 0.6f);
    const mcs_light middle = mcs_disk_light_sample(origin, at, up, 1, 0.5f, 0.5f);
    CHECK(edge.pdf == 0 && edge.distance == 0 && edge.w.x > 0.8f && edge.w.z == 0, "from its plane: %g %g %g, pdf %g",
          (double)edge.w.x, (double)edge.w.y, (double)edge.w.z, (double)edge.pdf);
    CHECK(middle.pdf == 0 && middle.distance == 0 && middle.w.z == 1, "from its middle: %g, pdf %g", (double)middle.w.z,
          (double)middle.pdf);
    CHECK(mcs_disk_light_pdf(origin, beside, up, 1, vec3((const float[]){1, 0, 0})) == 0, "along its plane");
    CHECK(relative(mcs_disk_light_pdf(origin, above, up, 1, up), 4 / O_PI) <= 1e-7L &&
              relative(mcs_disk_light_pdf(origin, above, down, 1, up), 4 / O_PI) <= 1e-7L &&
              mcs_disk_light_pdf(origin, above, up, 1, down) == 0 &&
              mcs_disk_light_invert(origin, above, up, 1, down).x == 0,
          "from both sides, and behind: %g", (double)mcs_disk_light_pdf(origin, above, up, 1, down));
    const double rim = atan(0.5);
    const mcs_vec3 past = {(float)sin(rim + 1e-6), 0, (float)cos(rim + 1e-6)};
    const mcs_vec3 just = {(float)sin(rim), 0, (float)cos(rim)};
    CHECK(mcs_disk_light_pdf(origin, above, up, 1, just) > 0 && mcs_disk_light_pdf(origin, above, up, 1, past) == 0,
          "the rim");
    const mcs_vec3 far_away = {1e18f, -1e18f, 1e18f};
    const mcs_light speck = mcs_disk_light_sample(origin, far_away, up, 1e-18f, 0.5f, 0.5f);
    CHECK(speck.pdf > 1e29f && speck.pdf <= FLT_MAX && speck.distance > 1.7e18f, "a speck: pdf %g", (double)speck.pdf);
}

/* Outside the support densities are 0 and inverses are the nearer end. Rims take in the rounding of what lies on them,
 * 5e-7. */
static void beyond_the_ends(void) {
    const float top = 0.99999994f;
    CHECK(mcs_linear_pdf(1, 3, -0.1f) == 0 && mcs_linear_pdf(1, 3, 1.1f) == 0 && mcs_linear_invert(1, 3, -2) == 0 &&
              mcs_linear_invert(3, 1, 4) == top && mcs_linear_invert(1, 0, 1.5f) == top,
          "linear: %g %g %g", (double)mcs_linear_invert(1, 3, -2), (double)mcs_linear_invert(3, 1, 4),
          (double)mcs_linear_invert(1, 0, 1.5f));
    CHECK(mcs_tent_pdf(2, -2.1f) == 0 && mcs_tent_pdf(2, 2.1f) == 0 && mcs_tent_invert(2, -3) == 0 &&
              mcs_tent_invert(2, 3) == top,
          "tent: %g %g", (double)mcs_tent_invert(2, -3), (double)mcs_tent_invert(2, 3));
    CHECK(mcs_exponential_pdf(2, -0x1p-149f) == 0 && mcs_exponential_pdf(2, -1) == 0 &&
              mcs_exponential_invert(2, -1) == 0 && mcs_exponential_invert(2, 1e30f) == top,
          "exponential: %g", (double)mcs_exponential_pdf(2, -1));
    CHECK(mcs_truncexp_pdf(2, 3, -1) == 0 && mcs_truncexp_pdf(2, 3, 3.1f) == 0 && mcs_truncexp_pdf(0, 3, 3.1f) == 0 &&
              mcs_truncexp_invert(2, 3, -1) == 0 && mcs_truncexp_invert(2, 3, 4) == top &&
              mcs_truncexp_invert(0, 3, 4) == top,
          "truncexp: %g, %g %g", (double)mcs_truncexp_pdf(2, 3, 3.1f), (double)mcs_truncexp_invert(2, 3, -1),
          (double)mcs_truncexp_invert(2, 3, 4));
    CHECK(mcs_power_pdf(2, -0.5f) == 0 && mcs_power_pdf(2, 1.5f) == 0 && mcs_power_invert(2, -0.5f) == 0 &&
              mcs_power_invert(2, 1.5f) == top && mcs_evenpower_pdf(2, -1.5f) == 0 && mcs_evenpower_pdf(2, 1.5f) == 0 &&
              mcs_evenpower_invert(2, -1.5f) == 0 && mcs_evenpower_invert(2, 1.5f) == top,
          "powers: %g %g %g", (double)mcs_power_invert(2, 1.5f), (double)mcs_evenpower_invert(2, -1.5f),
          (double)mcs_evenpower_invert(2, 1.5f));
    CHECK(mcs_smoothstep_pdf(2, 5, 1.9f) == 0 && mcs_smoothstep_pdf(2, 5, 5.1f) == 0 &&
              mcs_smoothstep_invert(2, 5, -3) == 0 && mcs_smoothstep_invert(2, 5, 6) == top,
          "smoothstep: %g %g", (double)mcs_smoothstep_invert(2, 5, -3), (double)mcs_smoothstep_invert(2, 5, 6));
    CHECK(mcs_smoothstep_sample(2, 5, 0).x == 2 && mcs_smoothstep_sample(-3, 1e-3f, 0).x == -3 &&
              mcs_smoothstep_sample(2, 5, top).x <= 5 && mcs_smoothstep_pdf(2, 5, 2) == 0,
          "smoothstep at its ends: %g %g", (double)mcs_smoothstep_sample(2, 5, 0).x,
          (double)mcs_smoothstep_sample(2, 5, top).x);
    CHECK(mcs_disk_pdf(3, 3.00001f, 0) == 0 && mcs_concentric_pdf(3, 0, -3.00001f) == 0 && mcs_disk_pdf(3, 3, 0) > 0,
          "disks, 3e-6 past the rim: %g", (double)mcs_disk_pdf(3, 3.00001f, 0));
    CHECK(mcs_bilinear_pdf(1, 2, 3, 4, -0.1f, 0.5f) == 0 && mcs_bilinear_pdf(1, 2, 3, 4, 0.5f, 1.1f) == 0 &&
              mcs_bilinear_pdf(1, 2, 3, 4, 1, 1) > 0 && mcs_bilinear_invert(1, 2, 3, 4, 2, -1).x == top &&
              mcs_bilinear_invert(1, 2, 3, 4, 2, -1).y == 0,
          "bilinear: %g %g", (double)mcs_bilinear_pdf(1, 2, 3, 4, 1, 1),
          (double)mcs_bilinear_invert(1, 2, 3, 4, 2, -1).x);
    CHECK(mcs_triangle_pdf(0, 0) == 2 && mcs_triangle_pdf(1, 0) == 2 && mcs_triangle_pdf(0.25f, 0.75f) == 2 &&
              mcs_triangle_pdf(-0x1p-149f, 0.5f) == 0 && mcs_triangle_pdf(0.5f, -0x1p-149f) == 0 &&
              mcs_triangle_pdf(0.5f, 0.50000006f) == 2 && mcs_triangle_pdf(0.5f, 0.5000002f) == 0,
          "triangle: corners, and just outside");
    const mcs_vec2 u = mcs_triangle_invert(FLT_MAX, -3);
    CHECK(u.x == top && u.y == 0, "triangle: far outside %g %g", (double)u.x, (double)u.y);
}

/* Without a good height the density is uniform: each of four bad heights, at each corner, and four zeros. */
static void bilinear_uniform(void) {
    static const float bad[] = {-1, -0x1p-149f, NAN, INFINITY};
    for (int i = 0; i < 17; i++) {
        float w[4] = {1, 2, 3, 4};
        if (i < 16) w[i / 4] = bad[i % 4];
        else memset(w, 0, sizeof w);
        const mcs_sample2 s = mcs_bilinear_sample(w[0], w[1], w[2], w[3], 0.25f, 0.625f);
        const mcs_vec2 u = mcs_bilinear_invert(w[0], w[1], w[2], w[3], 0.25f, 0.625f);
        CHECK(s.x == 0.25f && s.y == 0.625f && s.pdf == 1 && u.x == 0.25f && u.y == 0.625f &&
                  mcs_bilinear_pdf(w[0], w[1], w[2], w[3], 0.25f, 0.625f) == 1,
              "heights %g %g %g %g: (%g, %g), pdf %g", (double)w[0], (double)w[1], (double)w[2], (double)w[3],
              (double)s.x, (double)s.y, (double)s.pdf);
    }
}

/* What the header says of points of a triangle: each coordinate is the nearest float, and b2 is not negative. Half of
 * 2^24 points are of a scrambled sequence, the others lie on the sides of the square that become the side b2 = 0. */
static void triangle_points(void) {
    int wide = 0;
    int negative = 0;
    int outside = 0;
    for (uint32_t i = 0; i < 1u << 24; i++) {
        const float border = (float)i * 0x1p-24f;
        const float u1 = i & 1 ? mcs_sobol(i, 0, 7) : i & 2 ? 0.99999994f : border;
        const float u2 = i & 1 ? mcs_sobol(i, 1, 7) : i & 2 ? border : 0.99999994f;
        const mcs_sample2 s = mcs_triangle_sample(u1, u2);
        const double m = 0.5 * fmin((double)u1, (double)u2);
        wide += s.x != (float)((double)u1 - m) || s.y != (float)((double)u2 - m);
        negative += 1 - s.x - s.y < 0;
        outside += mcs_triangle_pdf(s.x, s.y) != 2;
    }
    CHECK(wide == 0 && negative == 0 && outside == 0, "%d not the nearest, %d of b2 below 0, %d outside", wide,
          negative, outside);
}

/* A cosine to the power 0 is 1 down to the least cosine, whose tangent squared is beyond any float. */
static void even_phong(void) {
    const mcs_phong m = mcs_phong_make(0);
    const mcs_vec3 low = {1, 0, 1e-25f};
    CHECK(relative(mcs_phong_lobe_pdf(&m, low), 0.5L / O_PI) <= 2 * EPS, "%g", (double)mcs_phong_lobe_pdf(&m, low));
}

static void opposed(void) {
    const float w[][3] = {{0, 0, 1}, {0.6f, 0, 0.8f}, {1, 0, 0}, {-0.48f, 0.6f, 0.64f}};
    for (size_t i = 0; i < MCST_COUNT(w); i++) {
        const float back[3] = {-w[i][0], -w[i][1], -w[i][2]};
        const mcs_vec3 h = mcs_half(vec3(w[i]), vec3(back));
        CHECK(h.x == 0 && h.y == 0 && h.z == 1, "(%g, %g, %g)", (double)h.x, (double)h.y, (double)h.z);
    }
}

/* The place in a stratum is the middle of one of equal parts: turned round, bits and strata give the same from the
 * other end. */
static void jitter(void) {
    for (uint32_t k = 0; k <= 20; k++)
        for (uint32_t i = 0; i < 1000; i++) {
            const uint32_t n = 1u << k;
            const uint32_t bits = mcs_hash(i, k);
            const uint32_t at = bits % n;
            const float a = mcsi_jitter(at, n, bits);
            const float b = mcsi_jitter(n - 1 - at, n, ~bits);
            CHECK((double)a + (double)b == 1, "%u of %u, bits %u: %.9g and %.9g", at, n, bits, (double)a, (double)b);
        }
}

/* Blocks of counters whose lower word overflows within a vector, and of the last ones. */
static void philox_counters(void) {
    static const uint64_t first[] = {0xfffffffdu, 0xfffffffffu, 0xfffffffffffffffdu, 0x1fffffff8u};
    float u[4 * 40];
    for (size_t i = 0; i < MCST_COUNT(first); i++) {
        mcs_philox_fill_n(77, first[i], MCST_COUNT(u), u);
        for (size_t k = 0; k < MCST_COUNT(u); k++)
            CHECK(u[k] == mcs_u01(mcs_philox(77, first[i] + k / 4, 0).v[k % 4]), "counter %llx, number %zu",
                  (unsigned long long)first[i], k);
    }
}

static void bad_shares(void) {
    CHECK(mcs_mix_pdf(-0.5f, 1, 2) == 2 && mcs_mix_pdf(-INFINITY, 1, 2) == 2 && mcs_mix_pdf(1.5f, 1, 2) == 1 &&
              mcs_mix_pdf(INFINITY, 1, 2) == 1,
          "shares outside [0,1]: %g %g %g %g", (double)mcs_mix_pdf(-0.5f, 1, 2), (double)mcs_mix_pdf(-INFINITY, 1, 2),
          (double)mcs_mix_pdf(1.5f, 1, 2), (double)mcs_mix_pdf(INFINITY, 1, 2));
}

/* ---- tables ---- */

/* Beside 3e38 the halves of 1e-45 round to 0, yet no cell that has light may lose it. */
static void tiny_cells(void) {
    const float f[] = {3e38f, 0, 0x1p-149f, 0x1p-149f, 0, 0};
    arena a = arena_make(mcs_pwl_bytes(5));
    mcs_pwl *t = (mcs_pwl *)(void *)a.at;
    CHECK(mcs_pwl_build(t, a.bytes, f, 5) == MCS_OK, "build");
    for (int i = 0; i < 5; i++)
        CHECK((mcs_pwl_pdf(t, ((float)i + 0.5f) / 5) > 0) == (i < 4), "cell %d: density %g", i,
              (double)mcs_pwl_pdf(t, ((float)i + 0.5f) / 5));
    arena_free(&a);
}

/* Shares add up to 2^31 whatever the rounding of the sums: none is left for zeros behind the last entry. */
static void zeros_behind(void) {
    uint64_t seed = mcst_seed_for("pwc", "zeros", 0);
    arena a = arena_make(mcs_pwc_bytes(7));
    mcs_pwc *t = (mcs_pwc *)(void *)a.at;
    for (int i = 0; i < 20000; i++) {
        float f[7] = {0, 0, 0, 0, 0, 0, 0};
        double sum = 0;
        for (int k = 0; k < 4; k++) {
            float u, v;
            mcst_uniform(&seed, 1, &u, &v);
            f[k] = (float)pow(10, 6 * (double)u);
        }
        CHECK(mcs_pwc_build(t, a.bytes, f, 7) == MCS_OK, "build");
        for (int k = 0; k < 7; k++) sum += (double)mcs_discrete_pmf(t, (uint32_t)k);
        CHECK(mcs_discrete_pmf(t, 4) == 0 && mcs_discrete_pmf(t, 5) == 0 && mcs_discrete_pmf(t, 6) == 0,
              "%g %g %g %g: %g", (double)f[0], (double)f[1], (double)f[2], (double)f[3],
              (double)mcs_discrete_pmf(t, 6));
        CHECK(fabs(sum - 1) <= 4 * EPS, "%g %g %g %g: all together %g", (double)f[0], (double)f[1], (double)f[2],
              (double)f[3], sum);
    }
    arena_free(&a);
}

/* Beyond 2^53 shares do not fit a double: where sums no longer grow the last entries must still get theirs. Of 2^23 + 1
 * entries n 2^31 - n rounds up. */
static void alias_of_many(void) {
    const uint32_t n = (1u << 23) + 1;
    float *w = (float *)malloc(n * sizeof *w);
    arena a = arena_make(mcs_alias_bytes(n));
    mcs_alias *t = (mcs_alias *)(void *)a.at;
    int lost = 0;
    if (!w) exit(2);
    for (uint32_t i = 0; i < n; i++) w[i] = i ? 1e-30f : 1e30f;
    CHECK(mcs_alias_build(t, a.bytes, w, n) == MCS_OK, "build");
    for (uint32_t i = 0; i < n; i++) lost += !(mcs_alias_pmf(t, i) > 0);
    CHECK(lost == 0 && mcs_alias_pmf(t, n - 1) < 1e-6f, "%d of %u have no share; the last one has %g", lost, n,
          (double)mcs_alias_pmf(t, n - 1));
    free(w);
    arena_free(&a);
}

/* The last i in [lo, hi] with cdf[i] <= U, for U on borders and between them. */
static void searches(void) {
    enum { N = 40 };
    uint64_t seed = mcst_seed_for("cdf", "search", 0);
    for (int round = 0; round < 20000; round++) {
        const uint32_t n = 1 + (uint32_t)(mcst_mix(&seed) % N);
        uint32_t cdf[N + 1];
        cdf[0] = 0;
        for (uint32_t i = 1; i <= n; i++)
            cdf[i] = cdf[i - 1] + (uint32_t)(mcst_mix(&seed) % 4 ? mcst_mix(&seed) % 1000 : 0);
        if (cdf[n] == 0) continue;
        uint32_t U;
        do U = mcst_mix(&seed) % 2 ? cdf[mcst_mix(&seed) % (n + 1)] : (uint32_t)(mcst_mix(&seed) % cdf[n]);
        while (U >= cdf[n]);
        uint32_t want;
        for (want = n; cdf[want] > U;) want--;
        const uint32_t lo = (uint32_t)(mcst_mix(&seed) % (want + 1));
        const uint32_t hi = want + (uint32_t)(mcst_mix(&seed) % (n - want));
        const uint32_t i = mcsi_cdf_search(cdf, n, lo, hi, U);
        CHECK(i == want, "%u in [%u, %u] of %u: %u, not %u", U, lo, hi, n, i, want);
    }
}

/* 0 and 1 belong to the first and the last cell, what lies outside to none. */
static void ends_of_tables(void) {
    const float f[] = {3, 1, 2, 5, 4, 7};
    arena a = arena_make(mcs_pwc_bytes(5));
    arena b = arena_make(mcs_pwl_bytes(5));
    mcs_pwc *c = (mcs_pwc *)(void *)a.at;
    mcs_pwl *l = (mcs_pwl *)(void *)b.at;
    const float top = 0.99999994f;
    CHECK(mcs_pwc_build(c, a.bytes, f, 5) == MCS_OK && mcs_pwl_build(l, b.bytes, f, 5) == MCS_OK, "build");
    CHECK(relative(mcs_pwc_pdf(c, 0), 1) <= EPS && relative(mcs_pwc_pdf(c, 1), 4 / 3.0L) <= EPS, "pwc: %g and %g",
          (double)mcs_pwc_pdf(c, 0), (double)mcs_pwc_pdf(c, 1));
    CHECK(relative(mcs_pwl_pdf(l, 0), 3 / 3.4L) <= EPS && relative(mcs_pwl_pdf(l, 1), 7 / 3.4L) <= EPS,
          "pwl: %g and %g", (double)mcs_pwl_pdf(l, 0), (double)mcs_pwl_pdf(l, 1));
    CHECK(mcs_pwc_pdf(c, -0.1f) == 0 && mcs_pwc_pdf(c, 1.1f) == 0 && mcs_pwl_pdf(l, -0.1f) == 0 &&
              mcs_pwl_pdf(l, 1.1f) == 0,
          "outside");
    CHECK(mcs_pwc_invert(c, -1) == 0 && mcs_pwc_invert(c, 0) == 0 && mcs_pwc_invert(c, 1) == top &&
              mcs_pwc_invert(c, 2) == top,
          "pwc: %g to %g", (double)mcs_pwc_invert(c, 0), (double)mcs_pwc_invert(c, 1));
    CHECK(mcs_pwl_invert(l, -1) == 0 && mcs_pwl_invert(l, 0) == 0 && mcs_pwl_invert(l, 1) == top &&
              mcs_pwl_invert(l, 2) == top,
          "pwl: %g to %g", (double)mcs_pwl_invert(l, 0), (double)mcs_pwl_invert(l, 1));
    CHECK(mcs_discrete_pmf(c, 5) == 0 && mcs_discrete_pmf(c, UINT32_MAX) == 0, "entries beyond the last: %g",
          (double)mcs_discrete_pmf(c, 5));
    arena_free(&a);
    arena_free(&b);
}

/* ---- rows of a map ---- */

/* 1 - cos of border k of h, from the nearer pole. */
static ld border(uint32_t k, uint32_t h) {
    const ld s = sinl(0.5L * O_PI * (ld)k / (ld)h);
    return 2 * s * s;
}

/* Directions beside the borders of rows: 1 - cos(theta) of a float direction is known to 4 EPS (two products and a sum
 * 2, 1 + |z| 1, a quotient 1) and the error of its length, the guess from the angle only to 2^-23 turns: a row off that
 * is not set right shows. */
static void rows_beside_borders(uint32_t h) {
    float *light = (float *)malloc(2 * (size_t)h * sizeof *light);
    arena a = arena_make(mcs_env_bytes(2, h));
    mcs_env *e = (mcs_env *)(void *)a.at;
    uint64_t seed = mcst_seed_for("env", "rows", h);
    int beside = 0;
    if (!light) exit(2);
    for (uint32_t k = 0; k < 2 * h; k++) light[k] = (float)(1 + k % 3);
    const mcs_image image = mcs_image_make(light, 2, h, 1);
    CHECK(mcs_env_build(e, a.bytes, &image) == MCS_OK, "build");
    for (int i = 0; i < 300000; i++) {
        float u, v;
        mcst_uniform(&seed, 1, &u, &v);
        const uint32_t k = 1 + (uint32_t)(mcst_mix(&seed) % (h - 1));
        double theta = ST_PI * k / h;
        theta += fmin(theta, ST_PI - theta) * ldexp((double)u - 0.5, -18 - (int)(mcst_mix(&seed) % 6));
        float w[3];
        w[0] = (float)(sin(theta) * cos(6.283185307179586 * (double)v));
        w[1] = (float)(sin(theta) * sin(6.283185307179586 * (double)v));
        w[2] = (float)cos(theta);
        const o_vec3 o = o_v3(w[0], w[1], fabsf(w[2]));
        const ld t = o_one_minus_cos(o);
        const ld slack = t * (4 * EPS + fabsl(o_dot(o, o) - 1));
        uint32_t m = w[2] < 0 ? h - k : k; /* from the nearer pole the border that it lies beside, or the one before */
        if (2 * m > h) m = h - m;          /* across the equator */
        if (fabsl(t - border(m, h)) <= slack || 2 * m == h) continue;
        if (t < border(m, h)) m--;
        beside++;
        const uint32_t row = mcs_env_texel(e, vec3(w)).row;
        CHECK(row == (w[2] < 0 ? h - 1 - m : m), "(%a, %a, %a): row %u, not %u", (double)w[0], (double)w[1],
              (double)w[2], row, w[2] < 0 ? h - 1 - m : m);
    }
    CHECK(beside >= 10000, "%d directions", beside);
    /* What holds whatever the angle's rounding is: the angle only has to be right to 2^-23 turns, 1 - cos says which
     * row it is. */
    for (int i = 0; i < 200000; i++) {
        const uint32_t last = (h - 1) / 2;
        const uint32_t m = (uint32_t)(mcst_mix(&seed) % (last + 1));
        const int down = i & 1;
        const int off = (int)(mcst_mix(&seed) % 3) - 1;
        float u, v;
        mcst_uniform(&seed, 1, &u, &v);
        const float t = (float)(border(m, h) + (fminl(border(m + 1, h), 1) - border(m, h)) *
                                                   (ld)(i & 2 ? u * 0x1p-6f : 1 - u * 0x1p-6f));
        if (!((ld)t > border(m, h) && ((ld)t < border(m + 1, h) || m == last))) continue; /* beyond a border */
        u = (float)(acos(1 - (double)t) / (2 * ST_PI) + off * 0x1p-23);
        u = u > 0 ? u : 0;
        const uint32_t row = mcsi_env_row_at(e, down ? -t : t, u);
        CHECK(row == (down ? h - 1 - m : m), "1 - cos %a, %d of 2^-23 turns off: row %u, not %u", (double)t, off, row,
              down ? h - 1 - m : m);
    }
    free(light);
    arena_free(&a);
}

/* ---- texels of a map ---- */

static mcs_env *map_of(arena *a, const float *light, uint32_t w, uint32_t h) {
    const mcs_image image = mcs_image_make(light, w, h, 1);
    *a = arena_make(mcs_env_bytes(w, h));
    mcs_env *e = (mcs_env *)(void *)a->at;
    CHECK(mcs_env_build(e, a->bytes, &image) == MCS_OK, "build");
    return e;
}

/* The only light in every place of a row of some chunks. */
static void lone_texels(void) {
    enum { W = 200, H = 3 };
    for (uint32_t c = 0; c < W; c++) {
        float light[W * H];
        memset(light, 0, sizeof light);
        light[W + c] = 1;
        arena a;
        mcs_env *e = map_of(&a, light, W, H);
        const mcs_texel t = mcs_env_sample(e, 0.3f, 0.7f);
        CHECK(t.col == c && t.row == 1 && t.pdf > 0 && mcs_env_pdf(e, t.w) == t.pdf,
              "column %u: drawn %u, %u, density %g", c, t.col, t.row, (double)t.pdf);
        arena_free(&a);
    }
}

/* Rows of two levels, each of which fills a chunk, are not even. */
static void rows_of_two_levels(void) {
    enum { W = 128, H = 4 };
    int right = 0;
    float light[W * H];
    for (int i = 0; i < W * H; i++) light[i] = i % W < W / 2 ? 1.0f : 3.0f;
    arena a;
    mcs_env *e = map_of(&a, light, W, H);
    for (int i = 0; i < 1000; i++) right += mcs_env_sample(e, ((float)i + 0.5f) / 1000, 0.4f).col >= W / 2;
    CHECK(right >= 749 && right <= 751, "%d of 1000 in the brighter half, not 750", right);
    arena_free(&a);
}

/* Random bits on the very border of two texels belong to the second, half a unit before it to the first. */
static void borders_of_texels(void) {
    enum { W = 100, H = 12 };
    uint64_t seed = mcst_seed_for("env", "texels", 0);
    float light[W * H];
    for (uint32_t c = 0; c < W * H; c++) light[c] = mcst_mix(&seed) % 3 ? (float)(1 + mcst_mix(&seed) % 1000) : 0.0f;
    arena a;
    mcs_env *e = map_of(&a, light, W, H);
    const mcsi_window all = mcsi_env_whole(e);
    for (uint32_t r = 0; r < H; r++) {
        const uint32_t *cdf = mcsi_env_sums(e, r);
        for (uint32_t c = 0; c < W; c++) {
            if (cdf[c] == cdf[c + 1]) continue;
            mcs_texel t = mcs_env_sample_bits(e, 2 * cdf[c], all.rows.sums[r] + all.rows.sums[r + 1]);
            CHECK(t.col == c && t.row == r, "border %u of row %u: %u, %u", c, r, t.col, t.row);
            t = mcs_env_sample_bits(e, 2 * cdf[c + 1] - 1, 2 * all.rows.sums[r]);
            CHECK(t.col == c && t.row == r, "before border %u of row %u: %u, %u", c + 1, r, t.col, t.row);
        }
    }
    arena_free(&a);
}

/* Of a constant map arrays look the texels up: rows alone, columns alone, both. */
static void texels_of_even_maps(void) {
    enum { N = 50 };
    uint64_t seed = mcst_seed_for("env", "even", 0);
    float light[8 * 4];
    for (int i = 0; i < 8 * 4; i++) light[i] = 2;
    arena a;
    mcs_env *e = map_of(&a, light, 8, 4);
    float u1[N], u2[N];
    mcst_uniform(&seed, N, u1, u2);
    for (int form = 1; form < 4; form++) {
        uint32_t col[N];
        memset(col, 0xa5, sizeof col);
        uint32_t row[N];
        memset(row, 0xa5, sizeof row);
        mcs_env_sample_n(e, N, u1, u2, NULL, NULL, NULL, NULL, form & 1 ? col : NULL, form & 2 ? row : NULL);
        for (int i = 0; i < N; i++) {
            const mcs_texel t = mcs_env_sample(e, u1[i], u2[i]);
            CHECK((!(form & 1) || col[i] == t.col) && (!(form & 2) || row[i] == t.row),
                  "outputs %d: %u, %u, not %u, %u", form, col[i], row[i], t.col, t.row);
        }
    }
    arena_free(&a);
}

/* Borders of rows: the series ends at t^17 with t below pi/4, what is left out is below 1e-18; 16 roundings of 2^-53.
 */
static void borders_of_rows(void) {
    for (int i = 0; i <= 100000; i++) {
        const double x = i / 100000.0;
        const double got = mcsi_one_minus_cos_pi(x);
        const ld s = sinl(0.5L * O_PI * (ld)x);
        const ld want = 2 * s * s;
        CHECK(fabsl((ld)got - want) <= 16 * 0x1p-53L * want, "x = %g: %.17g, not %.17Lg", x, got, want);
    }
}

/* ---- product ---- */

/* The radiance about the mirror direction, in a map of a texel per tile, over what a product reflects in all. */
static ld mirrored_part(const mcs_product *p, const mcs_env *e, const float *light, const mcs_reflection *r) {
    const mcs_vec3 mirror = {-r->wo.x, -r->wo.y, r->wo.z};
    const mcs_texel x = mcs_env_texel(e, mcs_to_world(&r->frame, mirror));
    const float *row_weight = MCSI_READ(float, p, p->at.row_weight);
    ld total = 0;
    for (uint32_t i = 0; i < p->rows; i++) total += (ld)row_weight[i];
    return fminl((ld)light[x.row * e->w + x.col] / (ld)e->total / total, 1);
}
/* The lobe's share as the header has it: (1 - matte) sqrt(R/S) x/(1 + x), x/(1 + x) at most 0.95, where x = m + m^2 and
 * m + 0.007 is a fourteenth of the mean solid angle of a tile over 4 pi alpha_x alpha_y cos(theta_o), without the
 * cosine for Phong's lobe, three times as much without GGX's tails. Some ten roundings of m; the map's probabilities
 * are those of its light to 1e-6. */
static void share_of_the_lobe(void) {
    static const float alphas[][2] = {{1, 1},         {0.08f, 0.08f}, {0.03f, 0.03f},
                                      {0.02f, 0.01f}, {0.01f, 0.01f}, {1e-3f, 1e-3f}};
    static const float mattes[] = {0, 0.25f, 1};
    float light[32 * 16];
    const mcs_image image = mcs_image_make(light, 32, 16, 1);
    arena map = arena_make(mcs_env_bytes(32, 16));
    arena memory = arena_make(mcs_product_bytes(16));
    mcs_env *e = (mcs_env *)(void *)map.at;
    mcs_product *p = (mcs_product *)(void *)memory.at;
    for (int i = 0; i < 32 * 16; i++) light[i] = (float)(1 + i % 5);
    CHECK(mcs_env_build(e, map.bytes, &image) == MCS_OK, "map");
    arena tiles = arena_make(mcs_tiles_bytes(e, 16));
    mcs_tiles *t = (mcs_tiles *)(void *)tiles.at;
    CHECK(mcs_tiles_build(t, tiles.bytes, e, 16) == MCS_OK, "tiles");
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) {
                const mcs_vec3 up = {0, 0, 1};
                /* towards light of 3 and of 1: as much as is reflected in all, and less */
                const mcs_vec3 wo[] = {{0.6f, 0.01f, 0.8f}, {0.48f, 0.36f, 0.8f}};
                mcs_reflection r;
                memset(&r, 0, sizeof r);
                r.frame = mcs_frame_make(up);
                r.wo = wo[i % 2];
                r.alpha_x = alphas[i][0];
                r.alpha_y = alphas[i][1];
                r.matte = mattes[j];
                r.profile = k == 0 ? MCS_PROFILE_GGX : k == 1 ? MCS_PROFILE_GAUSS : MCS_PROFILE_PHONG;
                CHECK(mcs_product_build(p, memory.bytes, t, e, &r, NULL) == MCS_OK, "product");
                const ld lobe = (ld)alphas[i][0] * (ld)alphas[i][1] * (k == 2 ? 1 : 0.8L);
                const ld m = (k ? 3 : 1) / (14 * 512.0L * lobe) - 0.007L;
                const ld of_width = m > 0 ? fminl((m + m * m) / (1 + m + m * m), 0.95L) : 0;
                const ld want = (1 - (ld)mattes[j]) * of_width * sqrtl(mirrored_part(p, e, light, &r));
                CHECK(fabsl((ld)p->brdf_share - want) <= 32 * EPS, "alphas %g %g, matte %g, profile %d: %g, not %Lg",
                      (double)alphas[i][0], (double)alphas[i][1], (double)mattes[j], k, (double)p->brdf_share, want);
            }
    arena_free(&map);
    arena_free(&tiles);
    arena_free(&memory);
}

/* However little a tile weighs beside another, in its row or in another one, it can be drawn, and where it weighs
 * nothing it cannot: not by u = 0 either. */
static void tiny_tiles(void) {
    enum { ROWS = 16, TILES = 2 * ROWS * ROWS };
    static float weight[TILES];
    arena memory = arena_make(mcs_product_bytes(ROWS));
    mcs_product *p = (mcs_product *)(void *)memory.at;
    float light[32 * 16];
    for (uint32_t k = 0; k < 32 * 16; k++) light[k] = (float)(1 + k % 5);
    arena map;
    mcs_env *e = map_of(&map, light, 32, 16);
    arena tiles = arena_make(mcs_tiles_bytes(e, ROWS));
    mcs_tiles *t = (mcs_tiles *)(void *)tiles.at;
    CHECK(mcs_tiles_build(t, tiles.bytes, e, ROWS) == MCS_OK, "tiles");
    memset(weight, 0, sizeof weight);
    weight[5 * ROWS + 7] = 1;
    weight[9 * ROWS + 7] = 1e-12f;
    weight[9 * ROWS + 3] = 1e-12f;
    CHECK(mcs_product_build_weights(p, memory.bytes, t, e, weight) == MCS_OK, "product");
    for (uint32_t k = 0; k < TILES; k++)
        CHECK((mcs_product_pdf(p, t, e, mcs_tiles_direction(t, e, k)) > 0) == (weight[k] > 0),
              "tile %u of weight %g: density %g", k, (double)weight[k],
              (double)mcs_product_pdf(p, t, e, mcs_tiles_direction(t, e, k)));
    for (uint32_t k = 0; k < 4; k++) {
        const mcs_texel x = mcs_product_sample(p, t, e, k & 1 ? 0.5f : 0, k & 2 ? 0.5f : 0);
        CHECK(x.pdf > 0 && relative(mcs_product_pdf(p, t, e, x.w), (ld)x.pdf) <= 1e-5L,
              "draw %u: density %g, of its direction %g", k, (double)x.pdf, (double)mcs_product_pdf(p, t, e, x.w));
    }
    arena_free(&map);
    arena_free(&tiles);
    arena_free(&memory);
}

/* A fine grid: 8 x 8 values column by column, bilinear between, then what its rows of nodes weigh by trapezoids over
 * the columns. Relative to its mean, from the sums: some 20 roundings of floats, most of them of the sums. */
static void fine_grids(void) {
    enum { M = MCSI_NODES };
    uint64_t seed = mcst_seed_for("product", "fine", 0);
    float v[MCSI_GRID + MCSI_NODES];
    for (int round = 0; round < 2000; round++) {
        double mean = 0;
        for (int k = 0; k < MCSI_GRID; k++) v[k] = (float)(1 + mcst_mix(&seed) % 1000);
        for (int i = 0; i < M; i++) {
            double sum = 0.5 * ((double)v[i] + (double)v[(M - 1) * M + i]);
            for (int j = 1; j < M - 1; j++) sum += (double)v[j * M + i];
            v[MCSI_GRID + i] = (float)sum;
            mean += (i == 0 || i == M - 1 ? 0.5 : 1) * sum / ((M - 1) * (M - 1));
        }
        float u[2];
        mcst_uniform(&seed, 1, &u[0], &u[1]);
        if (round % 3 == 0) u[0] = round % 2 ? 1.0f : 0.0f;
        if (round % 5 == 0) u[1] = round % 4 < 2 ? 1.0f : 0.0f;
        double x = (M - 1) * (double)u[0];
        double y = (M - 1) * (double)u[1];
        const int j = x < M - 2 ? (int)x : M - 2;
        const int i = y < M - 2 ? (int)y : M - 2;
        x -= j;
        y -= i;
        const ld want = (ld)((1 - x) * ((1 - y) * (double)v[j * M + i] + y * (double)v[j * M + i + 1]) +
                             x * ((1 - y) * (double)v[(j + 1) * M + i] + y * (double)v[(j + 1) * M + i + 1])) /
                        (ld)mean;
        const double got = (double)mcsi_grid_density(v, u[0], u[1]);
        /* values of up to 1000 times the least, differences of which are rounded; places to 7 * 2^-24 */
        CHECK(fabsl((ld)got - want) <= 20 * EPS * want + 40 * EPS * 1000 / (ld)mean, "at %g, %g: %g, not %Lg",
              (double)u[0], (double)u[1], got, want);
    }
}

static mcs_reflection glossy(float alpha) {
    const mcs_vec3 n = {0.6f, 0, 0.8f};
    const mcs_vec3 wo = {0.6f, 0, 0.8f};
    mcs_reflection r;
    memset(&r, 0, sizeof r);
    r.frame.s.x = 0.8f;
    r.frame.s.z = -0.6f;
    r.frame.t.y = 1;
    r.frame.n = n;
    r.wo = wo;
    r.alpha_x = r.alpha_y = alpha;
    r.matte = 0.25f;
    return r;
}

typedef struct {
    arena map, tiles, memory;
    mcs_env *e;
    mcs_tiles *t;
    mcs_product *p;
    mcs_reflection r;
} lit_surface;

static lit_surface surface_under(const float *light, uint32_t w, uint32_t h, float alpha) {
    lit_surface s;
    s.e = map_of(&s.map, light, w, h);
    s.tiles = arena_make(mcs_tiles_bytes(s.e, 16));
    s.t = (mcs_tiles *)(void *)s.tiles.at;
    s.memory = arena_make(mcs_product_bytes(16));
    s.p = (mcs_product *)(void *)s.memory.at;
    s.r = glossy(alpha);
    CHECK(mcs_tiles_build(s.t, s.tiles.bytes, s.e, 16) == MCS_OK, "tiles");
    CHECK(mcs_product_build(s.p, s.memory.bytes, s.t, s.e, &s.r, NULL) == MCS_OK, "product");
    s.p->brdf_share = 0;
    return s;
}

static void surface_free(lit_surface *s) {
    arena_free(&s->map);
    arena_free(&s->tiles);
    arena_free(&s->memory);
}

/* Even light and a surface that both stay the same when y changes sign: so does the density, by columns from both ends
 * of the map. Weights of tiles are integers over 2^24 of a row, of which there are 32; a place among the light is known
 * to 2^-21 of the map, 2^-16 of a tile, whose density changes by a few times itself at most: 1e-4. */
static void mirrored(float alpha) {
    enum { W = 64, H = 32 };
    uint64_t seed = mcst_seed_for("product", "mirror", alpha > 0.1f);
    float light[W * H];
    for (int i = 0; i < W * H; i++) light[i] = (float)(2 + i / W % 3);
    lit_surface s = surface_under(light, W, H, alpha);
    for (int i = 0; i < 5000; i++) {
        float u1, u2;
        mcst_uniform(&seed, 1, &u1, &u2);
        mcs_dir a, b;
        a = b = mcs_sphere_sample(u1, i % 4 ? u2 : u2 * 0.03f);
        b.w.y = -b.w.y;
        const double p = (double)mcs_product_pdf(s.p, s.t, s.e, a.w);
        const double q = (double)mcs_product_pdf(s.p, s.t, s.e, b.w);
        CHECK(fabs(p - q) <= 1e-4 * p, "(%g, %g, %g): %g, mirrored %g", (double)a.w.x, (double)a.w.y, (double)a.w.z, p,
              q);
    }
    surface_free(&s);
}

/* Rows without light within tiles that have some. */
static void black_rows(void) {
    enum { W = 64, H = 32 };
    uint64_t seed = mcst_seed_for("product", "black rows", 0);
    int lit = 0;
    float light[W * H];
    for (int i = 0; i < W * H; i++) light[i] = i / W % 2 ? 1.0f : 0.0f;
    lit_surface s = surface_under(light, W, H, 0.5f);
    for (int i = 0; i < 3000; i++) {
        float u1, u2;
        mcst_uniform(&seed, 1, &u1, &u2);
        const mcs_vec3 w = mcs_sphere_sample(u1, u2).w;
        const int black = mcs_env_texel(s.e, w).row % 2 == 0;
        const double p = (double)mcs_product_pdf(s.p, s.t, s.e, w);
        CHECK(black ? p == 0 : p >= 0, "(%g, %g, %g): %g", (double)w.x, (double)w.y, (double)w.z, p);
        lit += p > 0;
    }
    CHECK(lit > 500, "%d of 3000 directions", lit);
    surface_free(&s);
}

static void media_values(void) {
    static const char *const media[] = {"henyey_greenstein", "rayleigh", "von_mises_fisher"};
    mcst_group("values, media");
    for (size_t i = 0; i < MCST_COUNT(media); i++) {
        const mcst_row *row = mcst_find(media[i]);
        for (size_t j = 0; j < mcst_grid_count(row); j++) {
            float p[MCST_P];
            mcst_grid_get(row, j, p);
            if (mcst_case("slopes of %s %g", media[i], (double)p[0])) slopes(row, p);
        }
    }
    if (mcst_case("Henyey-Greenstein at its ends")) ends_of_henyey_greenstein();
    if (mcst_case("von Mises-Fisher at its end")) ends_of_von_mises_fisher();
}

/* The cases of maps. */
static void map_values(void) {
    static const uint32_t heights[] = {5, 64, 1000, 4099};
    mcst_group("values, rows of a map");
    for (size_t i = 0; i < MCST_COUNT(heights); i++)
        if (mcst_case("%u rows", heights[i])) rows_beside_borders(heights[i]);
    if (mcst_case("borders of rows")) borders_of_rows();
    mcst_group("values, texels of a map");
    if (mcst_case("one lit texel")) lone_texels();
    if (mcst_case("rows of two levels")) rows_of_two_levels();
    if (mcst_case("borders of texels")) borders_of_texels();
    if (mcst_case("even maps by arrays")) texels_of_even_maps();
}
static void light_values(void) {
    mcst_group("values, lights");
    if (mcst_case("balls from afar")) balls(1e-9, 0.5);
    if (mcst_case("balls nearby")) balls(0.5, 1);
    if (mcst_case("balls from inside")) balls(1, 2);
    if (mcst_case("balls from deep inside")) balls(2, 1e9);
    if (mcst_case("balls at their ends")) ends_of_balls();
    static const double ratio[] = {1e-7, 1e-2, 1, 30, 3000};
    for (size_t i = 0; i < MCST_COUNT(ratio); i++)
        if (mcst_case("disks of %g", ratio[i])) disk_lights(ratio[i], 0);
    if (mcst_case("disks seen from their edge")) disk_lights(0.5, 0.9999f);
    if (mcst_case("disks at their ends")) ends_of_disk_lights();
}

int main(int argc, char **argv) {
    static const char *const visible[] = {"ggx_vndf_h", "ggx_vndf", "ggx_bounded_h", "ggx_bounded"};
    static const char *const even[] = {"disk", "concentric", "sphere", "hemisphere", "cosine", "cone"};
    static const struct {
        const char *row;
        float a, b;
    } halves[] = {{"ward_gmd", 1, 1}, {"beckmann", 3, 3},  {"ggx", 1, 1},       {"ggx", 0.5f, 2},
                  {"ggx", 3, 3},      {"ashikhmin", 1, 1}, {"ashikhmin", 0, 0}, {"ashikhmin", 3, 0.5f}};
    mcst_start(argc, argv);
    mcst_group("values, GGX");
    for (size_t i = 0; i < MCST_COUNT(mcst_grid_alpha); i++)
        if (mcst_case("D, G1, G2 of %g %g", (double)mcst_grid_alpha[i][0], (double)mcst_grid_alpha[i][1]))
            ggx_values(mcst_grid_alpha[i][0], mcst_grid_alpha[i][1], mcst_seed_for("ggx", "values", i));
    for (size_t i = 0; i < 8; i++)
        if (mcst_case("%s of a wide alpha along %s", visible[i / 2], i % 2 ? "y" : "x"))
            wide_alphas(mcst_find(visible[i / 2]), i % 2 ? 1.0f : 100.0f, i % 2 ? 100.0f : 0.5f);
    if (mcst_case("ends of alpha")) ends_of_alpha();
    mcst_group("values, a cosine that cancels");
    for (size_t i = 0; i < MCST_COUNT(halves); i++)
        if (mcst_case("%s %g %g", halves[i].row, (double)halves[i].a, (double)halves[i].b))
            cancelling_cosines(mcst_find(halves[i].row), halves[i].a, halves[i].b);
    media_values();
    light_values();
    mcst_group("values, others");
    for (size_t i = 0; i < 6; i++)
        if (mcst_case("constants of %s", even[i])) constants(even[i], i < 2 ? 0.1 : 0.15);
    if (mcst_case("beyond the ends")) beyond_the_ends();
    if (mcst_case("bilinear without a good height")) bilinear_uniform();
    if (mcst_case("triangle: nearest floats, inside")) triangle_points();
    if (mcst_case("Phong's lobe of power 0 at the horizon")) even_phong();
    if (mcst_case("half of opposed directions")) opposed();
    if (mcst_case("jitter")) jitter();
    if (mcst_case("Ashikhmin and Shirley: the length of h")) reflection_at_rounded_half();
    if (mcst_case("cone of a sine")) cones();
    if (mcst_case("sine and cosine of the detours")) detour_angles();
    if (mcst_case("steps of R2")) r2_steps();
    if (mcst_case("counters of philox")) philox_counters();
    if (mcst_case("mixtures with a bad share")) bad_shares();
    if (mcst_case("piecewise linear cells of 1e-45 beside 3e38")) tiny_cells();
    if (mcst_case("searches of cumulative sums")) searches();
    if (mcst_case("ends of tables")) ends_of_tables();
    if (mcst_case("zeros behind the last entry")) zeros_behind();
    if (mcst_case("alias shares of 2^23 + 1 entries")) alias_of_many();
    map_values();
    mcst_group("values, product");
    if (mcst_case("share of the lobe")) share_of_the_lobe();
    if (mcst_case("tiny tiles")) tiny_tiles();
    if (mcst_case("fine grids")) fine_grids();
    if (mcst_case("mirrored, alpha 0.5")) mirrored(0.5f);
    if (mcst_case("mirrored, alpha 0.1")) mirrored(0.1f);
    if (mcst_case("black rows")) black_rows();
    return mcst_finish();
}
