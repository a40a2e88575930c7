/* Frames, the rim of the cone, microfacet helpers, Phong's direction, a line with tiny weights; lanes of frames, helpers
 * and weights of multiple importance sampling. */
#include <float.h>
#include <math.h>
#include "mcs_test.h"
#define MCS_PACKETS 16
#include "mcsample.h"
#include "oracle.h"

static const double eps = 0x1p-24; /* rounding of a float, relative */

static mcs_vec3 unit(double x, double y, double z) {
    const double len = sqrt(x * x + y * y + z * z);
    mcs_vec3 v;
    v.x = (float)(x / len);
    v.y = (float)(y / len);
    v.z = (float)(z / len);
    return v;
}

static mcs_vec3 random_unit(mcs_pcg32 *r) {
    const double z = 1 - 2.0 * mcs_pcg32_float(r);
    const double phi = 6.283185307179586 * mcs_pcg32_float(r);
    const double s = sqrt((1 - z) * (1 + z));
    return unit(s * cos(phi), s * sin(phi), z);
}

static double dot(mcs_vec3 a, mcs_vec3 b) { return (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z; }

static int finite3(mcs_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

/* ---- frame ---- */

/* With d = |n|^2 - 1 of the rounded normal the exact formulas (Duff et al. 2017) are off by d at most in every product
 * of two axes. An axis has components of up to 1 that pass five roundings, so its products with the other unit axes
 * move by 5 sqrt(3). */
static void check_frame(mcs_vec3 n) {
    const mcs_frame f = mcs_frame_make(n);
    const double d = fabs(dot(n, n) - 1);
    const double tol = 10 * eps + d;
    CHECK(f.n.x == n.x && f.n.y == n.y && f.n.z == n.z, "n = (%a, %a, %a): not kept", (double)n.x, (double)n.y,
          (double)n.z);
    CHECK(fabs(dot(f.s, f.s) - 1) <= tol && fabs(dot(f.t, f.t) - 1) <= tol, "n = (%a, %a, %a): lengths 1 + %g, 1 + %g",
          (double)n.x, (double)n.y, (double)n.z, dot(f.s, f.s) / 2 - 0.5, dot(f.t, f.t) / 2 - 0.5);
    CHECK(fabs(dot(f.s, f.t)) <= tol && fabs(dot(f.s, n)) <= tol && fabs(dot(f.t, n)) <= tol,
          "n = (%a, %a, %a): products %g, %g, %g", (double)n.x, (double)n.y, (double)n.z, dot(f.s, f.t), dot(f.s, n),
          dot(f.t, n));
    const double det = ((double)f.s.y * f.t.z - (double)f.s.z * f.t.y) * n.x +
                       ((double)f.s.z * f.t.x - (double)f.s.x * f.t.z) * n.y +
                       ((double)f.s.x * f.t.y - (double)f.s.y * f.t.x) * n.z;
    CHECK(fabs(det - 1) <= 3 * tol, "n = (%a, %a, %a): determinant %g", (double)n.x, (double)n.y, (double)n.z, det);
}

/* There and back: three axes off by 10 eps + d each way, and twice three products and two sums. */
static void check_round_trip(mcs_vec3 n, mcs_vec3 v) {
    const mcs_frame f = mcs_frame_make(n);
    const mcs_vec3 w = mcs_to_world(&f, v);
    const mcs_vec3 back = mcs_to_local(&f, w);
    const double tol = 3 * (10 * eps + fabs(dot(n, n) - 1)) + 12 * eps;
    const double err = fmax(fabs((double)back.x - v.x), fmax(fabs((double)back.y - v.y), fabs((double)back.z - v.z)));
    const double x = (double)f.s.x * v.x + (double)f.t.x * v.y + (double)f.n.x * v.z;
    const double y = (double)f.s.y * v.x + (double)f.t.y * v.y + (double)f.n.y * v.z;
    const double z = (double)f.s.z * v.x + (double)f.t.z * v.y + (double)f.n.z * v.z;
    CHECK(err <= tol, "v = (%a, %a, %a): off by %g", (double)v.x, (double)v.y, (double)v.z, err);
    CHECK(fabs(w.x - x) <= 6 * eps && fabs(w.y - y) <= 6 * eps && fabs(w.z - z) <= 6 * eps,
          "v = (%a, %a, %a): to_world", (double)v.x, (double)v.y, (double)v.z);
}

static const mcs_vec3 odd_normals[] = {
    {0, 0, 1},           {0, 0, -1},           {-0.0f, -0.0f, 1},   {-0.0f, 0, -1},
    {1, 0, 0},           {-1, 0, 0},           {0, 1, 0},           {0, -1, 0},
    {1, 0, -0.0f},       {0, 1, -0.0f},        {1e-40f, 1e-42f, 1}, {1e-45f, -1e-45f, -1},
    {1e-40f, 0, -1},     {1e-20f, 1e-30f, -1}, {1e-8f, -1e-8f, -1}, {0, 1e-10f, -1},
    {1, 1e-40f, 1e-45f}, {1e-40f, 1, -1e-45f},
};
static const mcs_vec3 bad_normals[] = {
    {0, 0, 0},
    {-0.0f, -0.0f, -0.0f},
    {NAN, 0, 1},
    {0, NAN, 1},
    {0, 0, NAN},
    {INFINITY, 0, 0},
    {0, -INFINITY, 0},
    {0, 0, INFINITY},
    {0, 0, -INFINITY},
    {1e30f, 1e30f, 1e30f},
    {1e30f, 0, -1},
    {FLT_MAX, FLT_MAX, -FLT_MAX},
    {1e-30f, 0, 0},
    {0, 0, 1e-40f},
    {INFINITY, NAN, -INFINITY},
};

/* s and t are rounded once, eps/2 for a coordinate; what double loses is 1e-9 of that at most, at an angle of 1e-6. */
static void check_tangent(mcs_vec3 n, mcs_vec3 tangent) {
    const mcs_frame f = mcs_frame_from_tangent(n, tangent);
    o_vec3 s, t;
    o_frame_from_tangent(o_v3(n.x, n.y, n.z), o_v3(tangent.x, tangent.y, tangent.z), &s, &t);
    const double off =
        fmax(fmax(fabs((double)(f.s.x - s.x)), fabs((double)(f.s.y - s.y))), fabs((double)(f.s.z - s.z)));
    const double across =
        fmax(fmax(fabs((double)(f.t.x - t.x)), fabs((double)(f.t.y - t.y))), fabs((double)(f.t.z - t.z)));
    CHECK(off <= 0.51 * eps && across <= 0.51 * eps + 1e-9 && f.n.x == n.x && f.n.y == n.y && f.n.z == n.z,
          "n (%a, %a, %a), tangent (%a, %a, %a): off by %g and %g", (double)n.x, (double)n.y, (double)n.z,
          (double)tangent.x, (double)tangent.y, (double)tangent.z, off / eps, across / eps);
    const double d = 10 * eps + fabs(dot(n, n) - 1);
    CHECK(fabs(dot(f.s, f.s) - 1) <= d && fabs(dot(f.t, f.t) - 1) <= d && fabs(dot(f.s, f.t)) <= d &&
              fabs(dot(f.s, n)) <= d && fabs(dot(f.t, n)) <= d,
          "n (%a, %a, %a), tangent (%a, %a, %a): not orthonormal", (double)n.x, (double)n.y, (double)n.z,
          (double)tangent.x, (double)tangent.y, (double)tangent.z);
}

static int same3(mcs_vec3 a, mcs_vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static void check_no_tangent(mcs_vec3 n, mcs_vec3 tangent) {
    const mcs_frame f = mcs_frame_from_tangent(n, tangent);
    const mcs_frame want = mcs_frame_make(n);
    CHECK(same3(f.s, want.s) && same3(f.t, want.t) && same3(f.n, want.n),
          "n (%a, %a, %a), tangent (%a, %a, %a): not that of mcs_frame_make", (double)n.x, (double)n.y, (double)n.z,
          (double)tangent.x, (double)tangent.y, (double)tangent.z);
}

static mcs_vec3 scaled(double k, mcs_vec3 a, double l, mcs_vec3 b) {
    mcs_vec3 v;
    v.x = (float)(k * a.x + l * b.x);
    v.y = (float)(k * a.y + l * b.y);
    v.z = (float)(k * a.z + l * b.z);
    return v;
}

/* The tangents of `bad_normals` that have a length are good ones. */
static void test_tangents(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 157);
    const mcs_vec3 zero = {0, 0, 0};
    for (int i = 0; i < 300000; i++) {
        const mcs_vec3 n = random_unit(&r);
        const mcs_vec3 tangent = random_unit(&r);
        const double size = pow(10, 70.0 * mcs_pcg32_float(&r) - 32);
        const double beside = pow(10, -5.0 * mcs_pcg32_float(&r));
        check_tangent(n, tangent);
        check_tangent(n, scaled(size, tangent, 0, zero));
        const mcs_vec3 close = scaled(i & 1 ? 1 : -1, n, beside, tangent);
        o_vec3 s, t;
        const o_vec3 up = o_unit(o_v3(n.x, n.y, n.z));
        o_frame(up, &s, &t);
        const o_vec3 to = o_v3(close.x, close.y, close.z);
        const ld angle = hypotl(o_dot(s, to), o_dot(t, to)) / o_len(to);
        if (angle > 1.001e-6L) check_tangent(n, close);
        if (angle < 0.999e-6L) check_no_tangent(n, close);
        check_no_tangent(n, scaled(size, n, 0, zero));
    }
    for (size_t i = 0; i < sizeof odd_normals / sizeof *odd_normals; i++) {
        for (size_t k = 0; k < sizeof bad_normals / sizeof *bad_normals; k++) {
            const mcs_vec3 bad = bad_normals[k];
            const mcs_frame f = mcs_frame_from_tangent(bad, odd_normals[i]);
            CHECK(finite3(f.s) && finite3(f.t) && same3(f.n, mcs_frame_make(bad).n), "bad normal %d", (int)k);
            if (!finite3(bad) || same3(bad, zero)) check_no_tangent(odd_normals[i], bad);
        }
    }
    const mcs_vec3 up = {0, 0, 1};
    const mcs_vec3 tiny = {0, 1e-45f, 0};
    const mcs_vec3 huge = {FLT_MAX, -FLT_MAX, FLT_MAX};
    check_tangent(up, tiny);
    check_tangent(up, huge);
}

static void test_frame(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 101);
    if (mcst_case("orthonormal: 1e6 random normals"))
        for (size_t i = 0; i < 1000000; i++) check_frame(random_unit(&r));
    if (mcst_case("orthonormal: near both poles, near the equator"))
        for (size_t i = 0; i < 300000; i++) {
            const double s = pow(10, -12.0 * mcs_pcg32_float(&r));
            const double phi = 6.283185307179586 * mcs_pcg32_float(&r);
            check_frame(unit(s * cos(phi), s * sin(phi), i & 1 ? -1 : 1));
            check_frame(unit(cos(phi), sin(phi), i & 1 ? -s : s));
        }
    if (mcst_case("orthonormal: axes, signed zeros, subnormals"))
        for (size_t i = 0; i < sizeof odd_normals / sizeof *odd_normals; i++) check_frame(odd_normals[i]);
    if (mcst_case("bad normals give a finite frame"))
        for (size_t i = 0; i < sizeof bad_normals / sizeof *bad_normals; i++) {
            const mcs_frame f = mcs_frame_make(bad_normals[i]);
            CHECK(finite3(f.s) && finite3(f.t) && finite3(f.n), "normal (%g, %g, %g)", (double)bad_normals[i].x,
                  (double)bad_normals[i].y, (double)bad_normals[i].z);
        }
    if (mcst_case("to_local undoes to_world")) {
        for (size_t i = 0; i < 300000; i++) check_round_trip(random_unit(&r), random_unit(&r));
        for (size_t i = 0; i < sizeof odd_normals / sizeof *odd_normals; i++)
            check_round_trip(odd_normals[i], random_unit(&r));
    }
    if (mcst_case("+z goes to the normal, exactly"))
        for (size_t i = 0; i < 1000; i++) {
            const mcs_vec3 n = random_unit(&r);
            const mcs_vec3 up = {0, 0, 1};
            const mcs_frame f = mcs_frame_make(n);
            const mcs_vec3 w = mcs_to_world(&f, up);
            CHECK(w.x == n.x && w.y == n.y && w.z == n.z, "normal (%a, %a, %a)", (double)n.x, (double)n.y, (double)n.z);
        }
}

/* Components up to 1e37 count, larger ones and NaN are as 0. Vectors along an axis scale exactly: one product, and
 * zeros added. */
static void same_moved(const mcs_frame *f, mcs_vec3 v, mcs_vec3 instead, float scale) {
    const mcs_vec3 w = mcs_to_world(f, v);
    const mcs_vec3 x = mcs_to_world(f, instead);
    const mcs_vec3 l = mcs_to_local(f, v);
    const mcs_vec3 m = mcs_to_local(f, instead);
    CHECK(w.x == x.x * scale && w.y == x.y * scale && w.z == x.z * scale, "(%g, %g, %g): to_world", (double)v.x,
          (double)v.y, (double)v.z);
    CHECK(l.x == m.x * scale && l.y == m.y * scale && l.z == m.z * scale, "(%g, %g, %g): to_local", (double)v.x,
          (double)v.y, (double)v.z);
}

static void test_huge_vectors(void) {
    static const float beyond[] = {1.01e37f, 2e37f, -2e37f, FLT_MAX, INFINITY, -INFINITY, NAN};
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 149);
    for (int i = 0; i < 100; i++) {
        const mcs_frame f = mcs_frame_make(random_unit(&r));
        for (int k = 0; k < 3; k++) {
            const mcs_vec3 axis = {k == 0, k == 1, k == 2};
            const mcs_vec3 far = {1e37f * axis.x, 1e37f * axis.y, 1e37f * axis.z};
            const mcs_vec3 rest = {k == 0 ? 0 : 0.5f, k == 1 ? 0 : -0.25f, k == 2 ? 0 : 0.75f};
            same_moved(&f, far, axis, 1e37f);
            for (int j = 0; j < (int)(sizeof beyond / sizeof *beyond); j++) {
                const mcs_vec3 v = {k == 0 ? beyond[j] : rest.x, k == 1 ? beyond[j] : rest.y,
                                    k == 2 ? beyond[j] : rest.z};
                same_moved(&f, v, rest, 1);
            }
        }
    }
}

/* ---- cone ---- */

/* Draws at its rim: k u1, its cosine, the sine and their products are each rounded, so 1 - cos of the vector lies past
 * k at times. They are all inside, yet 4e-6 of k past it is out: the header allows 5e-7, and x of the vector built
 * here, its square, 1 + cos and the quotient round by 6 eps = 4e-7. */
static void test_cone_rim(float k) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 151);
    const double t = k * (1 + 4e-6);
    mcs_vec3 past = {0, 0, 0};
    int lost = 0;
    for (int i = 0; i < 1 << 18; i++) {
        const float u1 = i & 1 ? (float)(1 - (1 + (i >> 1) % 4) * eps) : mcs_pcg32_float(&r);
        const float u2 = mcs_pcg32_float(&r);
        lost += !(mcs_cone_pdf(k, mcs_cone_sample(k, u1, u2).w) > 0);
    }
    CHECK(lost == 0, "%d of 2^18 draws lie outside", lost);
    past.x = (float)sqrt(t * (2 - t));
    past.z = (float)(1 - t);
    CHECK(mcs_cone_pdf(k, past) == 0, "density %g past the rim", (double)mcs_cone_pdf(k, past));
}

/* ---- microfacet helpers ---- */

static double far_from(mcs_vec3 a, o_vec3 b) {
    return fmax(fabs((double)(a.x - b.x)), fmax(fabs((double)(a.y - b.y)), fabs((double)(a.z - b.z))));
}

/* A wi at about the distance s from wo, or from -wo when s is negative: where half-vectors cancel. */
static mcs_vec3 beside(mcs_pcg32 *r, mcs_vec3 wo, double s) {
    const mcs_vec3 d = random_unit(r);
    const double sign = s < 0 ? -1 : 1;
    return unit(sign * wo.x + fabs(s) * d.x, sign * wo.y + fabs(s) * d.y, sign * wo.z + fabs(s) * d.z);
}

/* dot product 3 eps, doubled 6, product with a component 2 more of up to 2, difference 1: 11 eps */
static void check_reflect(mcs_pcg32 *r) {
    for (int i = 0; i < 300000; i++) {
        const mcs_vec3 wo = random_unit(r);
        const mcs_vec3 h = random_unit(r);
        const mcs_vec3 wi = mcs_reflect(wo, h);
        const double err = far_from(wi, o_reflect(o_v3(wo.x, wo.y, wo.z), o_v3(h.x, h.y, h.z)));
        CHECK(err <= 12 * eps, "off by %g", err);
    }
}

/* wo + wi is rounded once a component, hence right to eps however much it cancels; squares, sum and root 3, quotient 1
 */
static void check_half(mcs_pcg32 *r) {
    for (int i = 0; i < 300000; i++) {
        const double s = pow(10, -7.0 * mcs_pcg32_float(r));
        const mcs_vec3 wo = random_unit(r);
        const mcs_vec3 wi = i % 3 ? beside(r, wo, i % 3 == 1 ? s : -s) : random_unit(r);
        const o_vec3 o = o_v3(wo.x, wo.y, wo.z);
        const o_vec3 in = o_v3(wi.x, wi.y, wi.z);
        const mcs_vec3 h = mcs_half(wo, wi);
        const double c = mcs_cos_d(wo, wi);
        const double want = (double)o_cos_d(o, in);
        CHECK(fabs(c - want) <= 5 * eps * want, "cos_d %g, not %g", c, want);
        if (want == 0) continue; /* exactly opposed */
        CHECK(far_from(h, o_half(o, in)) <= 6 * eps, "half is off by %g", far_from(h, o_half(o, in)));
    }
}

static void check_half_of_bad(void) {
    const mcs_vec3 dirs[] = {{0, 0, 1},
                             {0, 0, -1},
                             {0.6f, 0, -0.8f},
                             {-0.6f, 0, 0.8f},
                             {0, 0, 0},
                             {1e-25f, 0, 1},
                             {1e-25f, 0, -1},
                             {NAN, 0, 1},
                             {0, INFINITY, 0},
                             {0, -INFINITY, 0},
                             {FLT_MAX, FLT_MAX, FLT_MAX},
                             {-FLT_MAX, FLT_MAX, 0},
                             {0, 0, 2.5f},
                             {0, 0, 0.4f}};
    const int n = (int)(sizeof dirs / sizeof *dirs);
    for (int i = 0; i < n * n; i++) {
        const mcs_vec3 wo = dirs[i / n];
        const mcs_vec3 wi = dirs[i % n];
        const mcs_vec3 h = mcs_half(wo, wi);
        const mcs_vec3 w = mcs_reflect(wo, wi);
        const float c = mcs_cos_d(wo, wi);
        CHECK(finite3(h) && finite3(w) && isfinite(c),
              "directions %d and %d: half (%g, %g, %g), reflect (%g, %g, %g), cos_d %g", i / n, i % n, (double)h.x,
              (double)h.y, (double)h.z, (double)w.x, (double)w.y, (double)w.z, (double)c);
        CHECK(c == 0 || (fabs(dot(wo, wo) - 1) < 0.1 && fabs(dot(wi, wi) - 1) < 0.1),
              "bad directions %d and %d: cos_d %g", i / n, i % n, (double)c);
    }
}

/* A mirror pair at grazing incidence: |H|^2 = 4 z^2 and L = ax/(2 sqrt(pi) z), so the weight is G2 = sqrt(pi) z/ax. z L
 * takes 8 eps (t 2, its constant 1, e^x 2, three operations), the rest 7; what the form leaves out is below 1. */
static void check_grazing_mirror(void) {
    for (int i = 9; i < 16; i++) { /* the form holds for z far below ax */
        const float z = (float)pow(10, -i);
        const float a = 0.1f;
        const mcs_beckmann m = mcs_beckmann_make(a, a);
        const mcs_vec3 wo = {1, 0, z};
        const mcs_vec3 wi = {-1, 0, z};
        const double got = (double)mcs_beckmann_weight(&m, wo, wi);
        const double want = 1.772453850905516 * (double)z / (double)a;
        CHECK(fabs(got - want) <= 16 * eps * want, "z = %g: %g, not %g", (double)z, got, want);
    }
}

/* H = wo + wi is about (6e-20, 0, 2e-15): the square of x, and with it the azimuth, lies below FLT_MIN. Within E of the
 * header, which is 1e-6 at least. */
static void check_near_normal(void) {
    const mcs_ashikhmin m = mcs_ashikhmin_make(1e9f, 0.0194f);
    const mcs_vec3 wo = {-1.8e-16f, -1, 1.03e-15f};
    for (int i = 60; i < 127; i += 6) {
        const mcs_vec3 wi = mcs_ashikhmin_sample(&m, wo, 0x1.e23e8cp-2f, (float)ldexp(0x1.0007b2p0, -i)).wi;
        const double got = (double)mcs_ashikhmin_pdf(&m, wo, wi);
        const double want = (double)o_ashikhmin_pdf(1e9f, 0.0194f, o_v3(wo.x, wo.y, wo.z), o_v3(wi.x, wi.y, wi.z));
        CHECK(fabs(got - want) <= 1e-6 * want, "u2 = 2^-%d: %g, not %g", i, got, want);
    }
}

static void check_reflect_pdf(mcs_pcg32 *r) {
    const float odd[] = {0.0f, -0.0f, -1e-3f, -1.0f, -INFINITY, NAN};
    for (int i = 0; i < 100000; i++) {
        const float p = (float)pow(10, 40.0 * mcs_pcg32_float(r) - 20);
        const float c = (float)pow(10, -8.0 * mcs_pcg32_float(r));
        const double want = p / (4.0 * c);
        const double got = mcs_reflect_pdf(p, c);
        CHECK(fabs(got - want) <= 2 * eps * want, "%g / (4 * %g): %g", (double)p, (double)c, got);
    }
    for (int i = 0; i < 6; i++)
        CHECK(mcs_reflect_pdf(1.0f, odd[i]) == 0, "cos_d %g: %g", (double)odd[i],
              (double)mcs_reflect_pdf(1.0f, odd[i]));
    CHECK(isfinite(mcs_reflect_pdf(FLT_MAX, 1e-30f)) && isfinite(mcs_reflect_pdf(NAN, 0.5f)) &&
              isfinite(mcs_reflect_pdf(INFINITY, 0.5f)) && isfinite(mcs_reflect_pdf(1.0f, 1e-45f)),
          "overflow, NaN and infinity");
}

/* 1 - c is exact or rounded once, its fifth power 5 + 3, its product with 1 - f0 two more, the sum one */
static void check_schlick(mcs_pcg32 *r) {
    const float odd[] = {-1.0f, -1e-30f, 0.0f, 1e-30f, 0.5f, 1.0f, 1.0000001f, 2.0f, 1e30f, INFINITY, -INFINITY, NAN};
    for (int i = 0; i < 100000; i++) {
        const float f0 = i % 7 ? mcs_pcg32_float(r) : 0.0f;
        const float c = i % 5 ? mcs_pcg32_float(r) : (float)(1 - pow(10, -7.0 * mcs_pcg32_float(r)));
        const double want = (double)o_schlick(f0, c);
        const double got = mcs_schlick(f0, c);
        CHECK(fabs(got - want) <= 12 * eps * want + FLT_MIN, "f0 = %g, cos_d = %g: %g, not %g", (double)f0, (double)c,
              got, want);
    }
    CHECK(mcs_schlick(0.04f, 0.0f) == 1.0f && mcs_schlick(0.04f, 1.0f) == 0.04f, "both ends");
    for (int i = 0; i < 144; i++) {
        const float f = mcs_schlick(odd[i / 12], odd[i % 12]);
        CHECK(isfinite(f), "f0 = %g, cos_d = %g: %g", (double)odd[i / 12], (double)odd[i % 12], (double)f);
    }
}

/* by up to 4.3 eps: found among 4e7 random ones */
static void check_short_halves(void) {
    static const float hard[][4] = {{0x1.388p+13f, 0x1.fffffep-1f, 0x1.f747p-1f, 0x1.3de148p-3f},
                                    {0x1.9p+6f, 0x1p-149f, 0x1.b5900ep-1f, 0x1.51b582p-1f}};
    for (int i = 0; i < 2; i++) {
        const float *a = hard[i];
        const mcs_ashikhmin m = mcs_ashikhmin_make(a[0], a[1]);
        const mcs_vec3 h = mcs_ashikhmin_h_sample(&m, a[2], a[3]).w;
        CHECK(fabs(sqrt(dot(h, h)) - 1) <= 4 * eps, "exponents %g %g: %g eps off", (double)a[0], (double)a[1],
              (sqrt(dot(h, h)) - 1) / eps);
    }
}

static void test_microfacet(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 103);
    if (mcst_case("reflect")) check_reflect(&r);
    if (mcst_case("half and cos_d, down to 1e-7 from grazing and from opposed")) check_half(&r);
    if (mcst_case("half of opposed and bad directions is finite, cos_d of bad ones 0")) check_half_of_bad();
    if (mcst_case("weight of Beckmann's mirror direction, cosines down to 1e-15")) check_grazing_mirror();
    if (mcst_case("density of Ashikhmin and Shirley near the normal, wo grazing")) check_near_normal();
    if (mcst_case("reflect_pdf")) check_reflect_pdf(&r);
    if (mcst_case("schlick")) check_schlick(&r);
    if (mcst_case("half-vectors that were too short")) check_short_halves();
}

/* ---- one dimension ---- */

/* Subnormal weights, and numbers u that only some generator of the caller makes: x within 4 ulp, its density within 0.2
 * E, as the header promises for all; densities below 2^-126 of the peak may be lost. */
static void test_linear_tiny(void) {
    static const float weights[] = {0.0f, 1e-45f, 3e-45f, 1e-44f, 1e-42f, 1e-40f, 1e-38f, FLT_MIN, 1e-30f},
                       u[] = {0.0f,   1e-45f, 1e-40f, FLT_MIN, 1e-35f, 1e-32f,
                              1e-25f, 1e-20f, 1e-12f, 1e-6f,   0.3f,   0.99999994f};
    enum { WEIGHTS = (int)(sizeof weights / sizeof *weights), US = (int)(sizeof u / sizeof *u) };
    for (int i = 1; i < WEIGHTS * WEIGHTS; i++)
        for (int k = 0; k < US; k++) {
            const float a = weights[i / WEIGHTS];
            const float b = weights[i % WEIGHTS];
            const mcs_sample1 s = mcs_linear_sample(a, b, u[k]);
            const ld x = o_linear_map(a, b, u[k]);
            const ld pdf = o_linear_pdf_u(a, b, u[k]);
            const ld peak = 2 * fmaxl(a, b) / ((ld)a + b);
            const ld e = pdf > 0 ? 1e-6L * (1 + fabsl(logl(pdf / peak))) : 0;
            CHECK(o_ulp(s.x, x) <= 4, "a = %g, b = %g, u = %g: x %g, not %Lg", (double)a, (double)b, (double)u[k],
                  (double)s.x, x);
            CHECK(fabsl((ld)s.pdf - pdf) <= 0.2L * e * pdf + FLT_MIN * peak, "a = %g, b = %g, u = %g: pdf %g, not %Lg",
                  (double)a, (double)b, (double)u[k], (double)s.pdf, pdf);
        }
}

/* ---- Phong's direction ---- */

/* Its lobe is turned by a frame, which keeps lengths only to several roundings. |w|^2 is rounded by 3 eps of itself and
 * the factor that mends w by half of that, its own rounding and that of the product: 3.5 eps. */
static void check_phong_length(float n, mcs_vec3 wo, float u1, float u2) {
    enum { MANY = 21 }; /* one round of the widest unit, and a rest */
    const mcs_phong m = mcs_phong_make(n);
    const mcs_vec3 wi = mcs_phong_sample(&m, wo, u1, u2).wi;
    double off = fabs(sqrt(dot(wi, wi)) - 1);
    CHECK(off <= 3.5 * eps, "n %a, wo %a %a %a, u %a %a: length off by %g of 2^-24", (double)n, (double)wo.x,
          (double)wo.y, (double)wo.z, (double)u1, (double)u2, off / eps);
    float a[MANY], b[MANY];
    for (int i = 0; i < MANY; i++) {
        a[i] = u1;
        b[i] = u2;
    }
    float x[MANY], y[MANY], z[MANY];
    mcs_phong_sample_n(&m, wo, MANY, a, b, x, y, z, NULL, NULL);
    for (int i = 0; i < MANY; i++) {
        const mcs_vec3 w = {x[i], y[i], z[i]};
        off = fabs(sqrt(dot(w, w)) - 1);
        CHECK(off <= 3.5 * eps, "array, entry %d: length off by %g of 2^-24", i, off / eps);
    }
#ifndef MCS_NO_WIDE
    {
        const mcs8_phong wide = mcs8_phong_make(mcs8_set(n));
        const mcs8_vec3 eye = {mcs8_set(wo.x), mcs8_set(wo.y), mcs8_set(wo.z)};
        const mcs8_brdf s = mcs8_phong_sample(&wide, eye, mcs8_set(u1), mcs8_set(u2));
        for (int i = 0; i < 8; i++) {
            const mcs_vec3 w = {s.wi.x[i], s.wi.y[i], s.wi.z[i]};
            off = fabs(sqrt(dot(w, w)) - 1);
            CHECK(off <= 3.5 * eps, "lane %d: length off by %g of 2^-24", i, off / eps);
        }
    }
#endif
}

static void test_phong_length(void) {
    static const float exponents[] = {0, 0.01f, 0.5f, 1, 10, 1e3f, 1e9f};
    const mcs_vec3 bad = {-0x1.999998p-1f, 0x1.333332p-1f, 0x1.76231p-11f};
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 151);
    check_phong_length(0.01f, bad, 0x1.b443e8p-2f, 0x1.9a40d8p-2f);
    for (int i = 0; i < 100000; i++) {
        const double z = i & 1 ? pow(10, -6.0 * mcs_pcg32_float(&r)) : 1 - (double)mcs_pcg32_float(&r);
        const double phi = 6.283185307179586 * mcs_pcg32_float(&r);
        const double s = sqrt((1 - z) * (1 + z));
        const float u1 = mcs_pcg32_float(&r);
        const float u2 = mcs_pcg32_float(&r);
        check_phong_length(exponents[i % 7], unit(s * cos(phi), s * sin(phi), z), u1, u2);
    }
}

/* ---- widths ---- */

static const float odd_floats[] = {0.0f,  1e-45f, 1e-40f,     FLT_MIN,  1e-30f, 1e-20f, 1e-10f,
                                   0.3f,  1.0f,   1.0000001f, 3.0f,     1e10f,  1e19f,  1e20f,
                                   1e30f, 1e38f,  FLT_MAX,    INFINITY, NAN,    -1.0f,  -INFINITY};
enum { ODD_FLOATS = (int)(sizeof odd_floats / sizeof *odd_floats) };

/* Every lane of a wide form has the bits of the scalar one, in a build without contraction of a*b + c. NaN never
 * appears. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi" /* wide functions are inlined: no vector crosses a call */
#endif
#define WIDE(W)                                                                                                      \
    static void wide##W(const float(*in)[16]) {                                                                      \
        mcs##W##_f v[6], c, b, p, m, d, rp;                                                                          \
        mcs##W##_vec3 n, w, h, world, local, mirror;                                                                 \
        mcs##W##_frame f;                                                                                            \
        int i, k;                                                                                                    \
        for (k = 0; k < 6; k++)                                                                                      \
            for (i = 0; i < W; i++) v[k][i] = in[k][i];                                                              \
        n.x = v[0], n.y = v[1], n.z = v[2], w.x = v[3], w.y = v[4], w.z = v[5];                                      \
        f = mcs##W##_frame_make(n);                                                                                  \
        world = mcs##W##_to_world(&f, w);                                                                            \
        local = mcs##W##_to_local(&f, w);                                                                            \
        mirror = mcs##W##_reflect(n, w);                                                                             \
        h = mcs##W##_half(n, w);                                                                                     \
        c = mcs##W##_cos_d(n, w);                                                                                    \
        rp = mcs##W##_reflect_pdf(v[0], v[1]);                                                                       \
        b = mcs##W##_mis_balance(v[0], v[3]);                                                                        \
        p = mcs##W##_mis_power(v[0], v[3]);                                                                          \
        m = mcs##W##_mix_pdf(v[1], v[0], v[3]);                                                                      \
        d = mcs##W##_schlick(v[0], v[1]);                                                                            \
        for (i = 0; i < W; i++) {                                                                                    \
            const mcs_vec3 sn = {in[0][i], in[1][i], in[2][i]}, sw = {in[3][i], in[4][i], in[5][i]};                 \
            const mcs_frame sf = mcs_frame_make(sn);                                                                 \
            const mcs_vec3 sworld = mcs_to_world(&sf, sw), slocal = mcs_to_local(&sf, sw), sh = mcs_half(sn, sw),    \
                           sm = mcs_reflect(sn, sw);                                                                 \
            const float got[] = {f.s.x[i],   f.s.y[i], f.s.z[i],   f.t.x[i],    f.t.y[i],    f.t.z[i],   f.n.x[i],   \
                                 f.n.y[i],   f.n.z[i], world.x[i], world.y[i],  world.z[i],  local.x[i], local.y[i], \
                                 local.z[i], h.x[i],   h.y[i],     h.z[i],      c[i],        rp[i],      b[i],       \
                                 p[i],       m[i],     d[i],       mirror.x[i], mirror.y[i], mirror.z[i]};           \
            const float want[] = {sf.s.x,                                                                            \
                                  sf.s.y,                                                                            \
                                  sf.s.z,                                                                            \
                                  sf.t.x,                                                                            \
                                  sf.t.y,                                                                            \
                                  sf.t.z,                                                                            \
                                  sf.n.x,                                                                            \
                                  sf.n.y,                                                                            \
                                  sf.n.z,                                                                            \
                                  sworld.x,                                                                          \
                                  sworld.y,                                                                          \
                                  sworld.z,                                                                          \
                                  slocal.x,                                                                          \
                                  slocal.y,                                                                          \
                                  slocal.z,                                                                          \
                                  sh.x,                                                                              \
                                  sh.y,                                                                              \
                                  sh.z,                                                                              \
                                  mcs_cos_d(sn, sw),                                                                 \
                                  mcs_reflect_pdf(in[0][i], in[1][i]),                                               \
                                  mcs_mis_balance(in[0][i], in[3][i]),                                               \
                                  mcs_mis_power(in[0][i], in[3][i]),                                                 \
                                  mcs_mix_pdf(in[1][i], in[0][i], in[3][i]),                                         \
                                  mcs_schlick(in[0][i], in[1][i]),                                                   \
                                  sm.x,                                                                              \
                                  sm.y,                                                                              \
                                  sm.z};                                                                             \
            for (k = 0; k < (int)(sizeof got / sizeof *got); k++)                                                    \
                CHECK(got[k] == want[k], #W " wide, output %d, lane %d: %a, scalar %a; first input %a", k, i,        \
                      (double)got[k], (double)want[k], (double)in[0][i]);                                            \
        }                                                                                                            \
    }

#ifndef MCS_NO_WIDE
WIDE(4)
WIDE(8)
WIDE(16)

static void test_widths(void) {
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 139);
    const int n_odd = (int)(sizeof odd_normals / sizeof *odd_normals);
    const int n_bad = (int)(sizeof bad_normals / sizeof *bad_normals);
    for (int i = 0; i < 20000; i++) {
        float in[6][16];
        for (int k = 0; k < 16; k++) {
            const uint32_t pick = mcs_pcg32_next(&r) % 8;
            const mcs_vec3 n = pick == 0   ? odd_normals[mcs_pcg32_next(&r) % (uint32_t)n_odd]
                               : pick == 1 ? bad_normals[mcs_pcg32_next(&r) % (uint32_t)n_bad]
                                           : random_unit(&r);
            mcs_vec3 w = random_unit(&r);
            if (pick == 2) w.x = odd_floats[mcs_pcg32_next(&r) % ODD_FLOATS];
            if (pick == 3) {
                w.x = -n.x;
                w.y = -n.y;
                w.z = -n.z;
            }
            in[0][k] = n.x;
            in[1][k] = n.y;
            in[2][k] = n.z;
            in[3][k] = w.x;
            in[4][k] = w.y;
            in[5][k] = w.z;
        }
        wide4((const float(*)[16])in);
        wide8((const float(*)[16])in);
        wide16((const float(*)[16])in);
    }
}
#endif

int main(int argc, char **argv) {
    static const float cones[] = {0.5f, 0.01f, 1e-5f, 1e-8f};
    mcst_start(argc, argv);
    mcst_group("frame");
    test_frame();
    if (mcst_case("vectors of 1e37, and beyond")) test_huge_vectors();
    if (mcst_case("from a tangent, of any length and down to 1e-6 from the normal")) test_tangents();
    mcst_group("cone");
    for (int i = 0; i < 4; i++)
        if (mcst_case("rim of k = %g", (double)cones[i])) test_cone_rim(cones[i]);
    mcst_group("microfacet");
    test_microfacet();
    mcst_group("phong");
    if (mcst_case("directions of unit length")) test_phong_length();
    mcst_group("one dimension");
    if (mcst_case("linear: subnormal weights, tiny u")) test_linear_tiny();
#ifndef MCS_NO_WIDE
    mcst_group("frame, microfacet, mis: widths");
    if (mcst_contracts()) puts("SKIPPED: the bits of the wide forms, as this build contracts a*b + c");
    else if (mcst_case("4, 8, 16 wide have the bits of scalar")) test_widths();
#endif
    return mcst_finish();
}
