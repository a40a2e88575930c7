/* Values of lobes that no sampler test looks at closely: D, G1 and G2 of GGX, what a wide alpha magnifies, cosines that
 * cancel, what the length of a half-vector must not do. */
#include "values.h"

static void random_direction(uint64_t *state, float lowest,
                             float w[3]) { /* cosines from 1 to `lowest`, evenly in the logarithm */
    float u, v;
    mcst_uniform(state, 1, &u, &v);
    w[2] = (float)pow((double)lowest, (double)u);
    const double s = sqrt((1 - (double)w[2]) * (1 + (double)w[2]));
    w[0] = (float)(s * cos(6.283185307179586 * (double)v));
    w[1] = (float)(s * sin(6.283185307179586 * (double)v));
}

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

/* ---- half-vectors ---- */

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

static void opposed(void) {
    const float w[][3] = {{0, 0, 1}, {0.6f, 0, 0.8f}, {1, 0, 0}, {-0.48f, 0.6f, 0.64f}};
    for (size_t i = 0; i < MCST_COUNT(w); i++) {
        const float back[3] = {-w[i][0], -w[i][1], -w[i][2]};
        const mcs_vec3 h = mcs_half(vec3(w[i]), vec3(back));
        CHECK(h.x == 0 && h.y == 0 && h.z == 1, "(%g, %g, %g)", (double)h.x, (double)h.y, (double)h.z);
    }
}

/* ---- Phong ---- */

/* A cosine to the power 0 is 1 down to the least cosine, whose tangent squared is beyond any float. */
static void even_phong(void) {
    const mcs_phong m = mcs_phong_make(0);
    const mcs_vec3 low = {1, 0, 1e-25f};
    CHECK(relative(mcs_phong_lobe_pdf(&m, low), 0.5L / O_PI) <= 2 * EPS, "%g", (double)mcs_phong_lobe_pdf(&m, low));
}

int main(int argc, char **argv) {
    static const char *const visible[] = {"ggx_vndf_h", "ggx_vndf", "ggx_bounded_h", "ggx_bounded"};
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
    mcst_group("values, others");
    if (mcst_case("Phong's lobe of power 0 at the horizon")) even_phong();
    if (mcst_case("half of opposed directions")) opposed();
    if (mcst_case("Ashikhmin and Shirley: the length of h")) reflection_at_rounded_half();
    return mcst_finish();
}
