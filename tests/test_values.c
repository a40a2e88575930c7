/* Values of points, directions and numbers that no sampler test looks at closely: densities that are constant, ends of
 * the support, phase functions, the cone of a sine, the detours' sine and cosine, the steps of R2, mixtures with a bad
 * share. Of lobes, lights, tables and maps: test_values_*.c. */
#include "values.h"

/* ---- points and directions ---- */

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

/* In a vacuum there is no next collision before any end, by arrays neither, and MCS_ASSERT has nothing to tell. */
static void vacuum(void) {
    static const float rates[] = {0, -0.0f, 0x1p-149f, 1e-30f, 0.99e-18f};
    for (int i = 0; i < 5; i++) {
        const float u[4] = {0, 0.25f, 0.5f, 1 - 0x1p-24f};
        float x[4];
        float pdf[4];
        mcs_exponential_sample_n(rates[i], 4, u, x, pdf);
        for (int k = 0; k < 4; k++) {
            const mcs_sample1 s = mcs_exponential_sample(rates[i], u[k]);
            CHECK(s.x == FLT_MAX && s.pdf == 0 && x[k] == FLT_MAX && pdf[k] == 0, "rate %a: %g %g, arrays %g %g",
                  (double)rates[i], (double)s.x, (double)s.pdf, (double)x[k], (double)pdf[k]);
        }
        CHECK(mcs_exponential_pdf(rates[i], 1) == 0 && mcs_exponential_invert(rates[i], 1) == 0, "rate %a",
              (double)rates[i]);
    }
    CHECK(mcs_exponential_sample(-1, 0.5f).x == 0 && mcs_exponential_sample(1e-18f, 0.5f).pdf > 0, "other rates");
}
/* Outside the support densities are 0 and inverses are the nearer end. Rims take in the rounding of what lies on them,
 * 5e-7. */
static void beyond_the_ends_of_lines(void) {
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
    CHECK(mcs_truncnormal_pdf(-2, 3, -2.1f) == 0 && mcs_truncnormal_pdf(-2, 3, 3.1f) == 0 &&
              mcs_truncnormal_pdf(-2, 3, 3) > 0 && mcs_truncnormal_pdf(0, 1e-6f, 2e-6f) == 0 &&
              mcs_truncnormal_invert(-2, 3, -5) == 0 && mcs_truncnormal_invert(-2, 3, 4) == top &&
              mcs_truncnormal_invert(0, 1e-6f, 1) == top && mcs_truncnormal_sample(1, 1.0000001f, top).x == 1.0000001f,
          "truncnormal: %g %g", (double)mcs_truncnormal_invert(-2, 3, -5), (double)mcs_truncnormal_invert(-2, 3, 4));
    CHECK(mcs_trunclogistic_pdf(-2, 3, -2.1f) == 0 && mcs_trunclogistic_pdf(-2, 3, 3.1f) == 0 &&
              mcs_trunclogistic_invert(-2, 3, -5) == 0 && mcs_trunclogistic_invert(-2, 3, 4) == top &&
              mcs_trunclogistic_pdf(-2, INFINITY, INFINITY) == 0 && mcs_trunclogistic_pdf(-INFINITY, 3, -1e30f) == 0,
          "trunclogistic: %g %g", (double)mcs_trunclogistic_invert(-2, 3, -5),
          (double)mcs_trunclogistic_invert(-2, 3, 4));
    CHECK(mcs_truncnormal_sample(2, 2, 0.5f).pdf == 0 && mcs_truncnormal_sample(2, 2, 0.5f).x == 0 &&
              mcs_truncnormal_pdf(3, 2, 2.5f) == 0 && mcs_trunclogistic_invert(INFINITY, INFINITY, 2) == 0 &&
              mcs_truncnormal_sample(2e18f, INFINITY, 0.5f).pdf == 0 &&
              mcs_trunclogistic_pdf(-INFINITY, -INFINITY, 2) == 0,
          "no room between the ends: %g", (double)mcs_truncnormal_sample(2, 2, 0.5f).pdf);
}
static void beyond_the_ends_of_areas(void) {
    const float top = 0.99999994f;
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

/* For small u x is u m, as exact as all other: 4 ulp. ln(1 - p) where p is hardly more than the rounding of 1 - p showed
 * it for one number in 500. */
static void truncexp_small_u(void) {
    uint64_t seed = mcst.seed;
    double worst = 0;
    for (int i = 0; i < 20000; i++) {
        const float rate = ldexpf(1.5f, -(i % 25));
        float u, depth;
        mcst_uniform(&seed, 1, &u, &depth);
        u = ldexpf(0.5f + 0.5f * u, (int)(-24 * depth) - 1);
        const ld x = o_truncexp_map(rate, 1, u);
        worst = fmax(worst, fabs((double)((mcs_truncexp_sample(rate, 1, u).x - x) / x)));
    }
    CHECK(worst <= 8 * EPS, "%.3g ulp", worst / (2 * EPS));
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

/* ---- phase functions ---- */

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

/* ---- numbers ---- */

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

int main(int argc, char **argv) {
    static const char *const even[] = {"disk", "concentric", "sphere", "hemisphere", "cosine", "cone"};
    mcst_start(argc, argv);
    media_values();
    mcst_group("values, others");
    for (size_t i = 0; i < 6; i++)
        if (mcst_case("constants of %s", even[i])) constants(even[i], i < 2 ? 0.1 : 0.15);
    if (mcst_case("beyond the ends")) {
        beyond_the_ends_of_lines();
        beyond_the_ends_of_areas();
    }
    if (mcst_case("a vacuum")) vacuum();
    if (mcst_case("truncexp of small u")) truncexp_small_u();
    if (mcst_case("bilinear without a good height")) bilinear_uniform();
    if (mcst_case("triangle: nearest floats, inside")) triangle_points();
    if (mcst_case("jitter")) jitter();
    if (mcst_case("cone of a sine")) cones();
    if (mcst_case("sine and cosine of the detours")) detour_angles();
    if (mcst_case("steps of R2")) r2_steps();
    if (mcst_case("counters of philox")) philox_counters();
    if (mcst_case("mixtures with a bad share")) bad_shares();
    return mcst_finish();
}
