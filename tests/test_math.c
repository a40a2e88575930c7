/* The vector maths of the header, scalar pass, against double libm: largest error in ulp over a dense sweep of every
 * range, and the sign, range and monotonicity that the samplers rely on. Double results are good to 2^-29 of a float
 * ulp, so they count as exact here. The bounds are those that the header documents; MCS_TEST_VERBOSE=1 prints what was
 * found. */
#include "mcs_test.h"
#include "mcsample.h"
#include <math.h>

static double ulp_error(float got, double want) {
    int e;
    frexp(want, &e);
    if (e < -125) e = -125; /* below FLT_MIN the spacing stays 2^-149 */
    return fabs((double)got - want) / ldexp(1.0, e - 24);
}

static float float_of(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}
static uint32_t bits_of(float x) {
    uint32_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}

typedef struct {
    const char *name;
    float (*f)(float);
    double (*exact)(double);
    float lo, hi;   /* of one sign: swept by their bits */
    uint32_t step;  /* odd, so that all low bits occur */
    double bound;   /* ulp */
    int increasing; /* 1 or -1: the direction of the exact map, to be kept within the bound */
} kernel;

static float sin_turns(float t) {
    float s, c;
    mcsi_sincos_turns(t, &s, &c);
    return s;
}
static float cos_turns(float t) {
    float s, c;
    mcsi_sincos_turns(t, &s, &c);
    return c;
}
/* Exact reduction first, as sin(2 pi t) in double loses relative accuracy at its zeros. */
static double exact_sin_turns(double t) {
    const int k = (int)floor(4 * t + 0.5);
    const double r = 6.283185307179586476925 * (t - 0.25 * k);
    return k == 0 || k == 4 ? sin(r) : k == 1 ? cos(r) : k == 2 ? -sin(r) : -cos(r);
}
static double exact_cos_turns(double t) {
    const int k = (int)floor(4 * t + 0.5);
    const double r = 6.283185307179586476925 * (t - 0.25 * k);
    return k == 0 || k == 4 ? cos(r) : k == 1 ? -sin(r) : k == 2 ? -cos(r) : sin(r);
}
static float log1p_of(float x) { return mcsi_log1p(x); }
static float log_of(float x) { return mcsi_log(x); }
static float exp_of(float x) { return mcsi_exp_neg(x); }
static float exp_shared(float x) {
    float m;
    return mcsi_exp_both(x, &m);
}
static float expm1_shared(float x) {
    float m;
    mcsi_exp_both(x, &m);
    return m;
}
static float tail_of(float y) { return mcsi_normal_tail(y); }
static double exact_tail(double y) { return 0.5 * erfc(y * 0.70710678118654752440); }
static float atan_turns(float y) { return mcsi_atan2_turns(y, 1.0f); }
static double exact_atan_turns(double y) { return atan(y) * 0.15915494309189533577; }
static float cube_root(float x) {
    float over;
    return mcsi_pow_unit(x, 2.0f, 1.0, 1, &over);
}
static float cube(float x) { return mcsi_power(3.0f, 0.0, x); }
static double exact_cube(double x) { return x * x * x; }
static float power_37(float x) { return mcsi_power(37.5f, 0.0, x); }
static double exact_power_37(double x) { return pow(x, 37.5); }

static void sweep(const kernel *k) {
    const uint32_t a = bits_of(k->lo) & 0x7fffffffu;
    const uint32_t b = bits_of(k->hi) & 0x7fffffffu;
    const uint32_t sign = bits_of(k->lo) & 0x80000000u;
    const uint32_t from = a < b ? a : b;
    const uint32_t to = a < b ? b : a;
    double worst = 0;
    double at = 0;
    float before = k->f(float_of(from | sign));
    const int rises = sign ? -k->increasing : k->increasing; /* with growing magnitude */
    for (uint32_t i = from; i <= to; i = to - i < k->step && i != to ? to : i + k->step) {
        const float x = float_of(i | sign);
        const float y = k->f(x);
        const double e = ulp_error(y, k->exact((double)x));
        if (!(e <= worst)) {
            worst = e;
            at = (double)x;
        }
        /* Monotone up to rounding: a step back may be no larger than both errors, 2 bound ulp. */
        if (rises)
            CHECK((double)(y - before) * rises >= -2 * k->bound * fabs((double)y) * 0x1p-23, "%s(%.9g) turns back",
                  k->name, (double)x);
        before = y;
    }
    mcst_note("     %-14s max %.3f ulp at %.9g\n", k->name, worst, at);
    CHECK(worst <= k->bound, "%s: %.3f ulp at %.9g, bound %g", k->name, worst, at, k->bound);
}

/* Bounds: half an ulp for the last rounding, plus the roundings before it weighted by their share of the result, plus
 * the fit (below 0.1 ulp but for the tail, 0.5); they hold with and without contraction. Exponentials and powers are
 * swept down to 2^-125.5, below which they are 0. The tail, worst where Phi is just below 1/2: v = 1/(1 + 0.35 y) has a
 * relative error of 2^-24, which d ln G/d ln v = 2.3 makes 2.3 ulp; the sums of Horner's rule 2, its products 2, e^x 1,
 * the last product 0.5: 8 ulp. The quantile likewise: t 1, v 0.5, Horner 3, the difference t - R 1 ulp. */
static const kernel kernels[] = {
    {"sin", sin_turns, exact_sin_turns, 0x1p-30f, 1.0f, 13, 1.5, 0},
    {"sin, t < 0", sin_turns, exact_sin_turns, -0x1p-30f, -0.125f, 31, 1.5, 1},
    {"cos", cos_turns, exact_cos_turns, 0x1p-30f, 1.0f, 13, 1.5, 0},
    {"log", log_of, log, FLT_MIN, FLT_MAX, 257, 1.5, 1},
    {"log1p, x > 0", log1p_of, log1p, FLT_MIN, 1e38f, 257, 1.5, 1},
    {"log1p, x < 0", log1p_of, log1p, -0x1p-60f, -0.99999994f, 67, 1.5, 1},
    {"exp", exp_of, exp, -0x1p-40f, -86.98f, 67, 1.5, 1},
    {"exp of both", exp_shared, exp, -0x1p-40f, -80.0f, 67, 1.5, 1},
    {"expm1 of both", expm1_shared, expm1, -0x1p-60f, -80.0f, 67, 1.5, 1},
    {"atan2, turns", atan_turns, exact_atan_turns, FLT_MIN, 1e30f, 257, 4, 1},
    {"x^(1/3)", cube_root, cbrt, 0x1p-149f, 1.0f, 257, 1, 1},
    {"x^3", cube, exact_cube, 2.6e-13f, 1.0f, 67, 1, 1},
    {"x^37.5", power_37, exact_power_37, 0.0985f, 1.0f, 7, 1, 1},
    {"normal tail", tail_of, exact_tail, 0x1p-20f, 13.0f, 37, 8, -1},
};

/* The quantile against the tail in double: a step of one ulp of x moves Phi(x) by phi(x) ulp(x). */
static void quantile(void) {
    double worst = 0;
    double at = 0;
    float before = -20;
    for (uint32_t i = bits_of(FLT_MIN); i < bits_of(1.0f); i += 97) {
        const float p = float_of(i);
        const float x = mcsi_normal_quantile(p);
        const double X = (double)x;
        const double phi = 0.39894228040143267794 * exp(-0.5 * X * X);
        const double off =
            X < 0 ? exact_tail(-X) - (double)p : (1 - (double)p) - exact_tail(X); /* towards too large an x */
        const double e = x == 0 ? fabs(off) / (phi * 0x1p-149) : fabs(off) / phi / ldexp(1.0, ilogb(X) - 23);
        if (!(e <= worst)) {
            worst = e;
            at = (double)p;
        }
        CHECK(x >= before || (double)(before - x) <= 0x1p-20 * fabs(X), "quantile(%.9g) turns back", (double)p);
        before = x;
    }
    mcst_note("     %-14s max %.3f ulp at %.9g\n", "quantile", worst, at);
    CHECK(worst <= 6, "quantile: %.3f ulp at %.9g", worst, at);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("kernels, ulp");
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        if (mcst_case("%s", kernels[i].name)) sweep(&kernels[i]);
    if (mcst_case("quantile")) quantile();

    mcst_group("kernels, exact points");
    if (mcst_case("turns")) {
        CHECK(sin_turns(0) == 0 && cos_turns(0) == 1, "at 0");
        CHECK(sin_turns(0.25f) == 1 && cos_turns(0.25f) == 0, "at a quarter");
        CHECK(sin_turns(0.5f) == 0 && cos_turns(0.5f) == -1, "at a half");
        CHECK(sin_turns(0.75f) == -1 && cos_turns(0.75f) == 0, "at three quarters");
        CHECK(sin_turns(0.49999997f) > 0 && sin_turns(0.50000006f) < 0, "signs around a half");
    }
    if (mcst_case("ends")) {
        CHECK(mcsi_log(1.0f) == 0 && mcsi_log1p(0.0f) == 0, "log 1");
        CHECK(mcsi_exp_neg(0.0f) == 1 && mcsi_exp_neg(-1e30f) == 0 && mcsi_exp_neg(-INFINITY) == 0, "exp at its ends");
        CHECK(mcsi_exp_neg(NAN) == 0, "exp of NaN");
        for (float x = -86; x > -110; x -= 0x1p-8f) {
            const float y = mcsi_exp_neg(x);
            CHECK(y >= FLT_MIN || (y == 0 && x < -86.98f), "exp(%g) = %g is subnormal", (double)x, (double)y);
        }
        for (float x = 0.11f; x > 0.05f; x -= 0x1p-16f) {
            const float y = power_37(x);
            CHECK(y >= FLT_MIN || (y == 0 && x < 0.0985f), "%g^37.5 = %g is subnormal", (double)x, (double)y);
        }
        for (float x = 0x1p-120f; x > 0; x *= 0.875f) { /* the first root of x is x, where that is subnormal, too */
            float over;
            const float y = mcsi_pow_unit(x, 0.0f, 1.0, 1, &over);
            CHECK(fabsf(y - x) <= 0x1p-149f + 2 * FLT_EPSILON * x, "%a^1 = %a", (double)x, (double)y);
            CHECK(fabsf(over - 1) <= 2 * FLT_EPSILON, "%a over its root is %a", (double)x, (double)over);
            if (x < 0x1p-146f) break; /* 7/8 of it rounds to it */
        }
        CHECK(mcsi_power(0.0f, 0.0, 0.0f) == 1 && mcsi_power(2.0f, 0.0, 0.0f) == 0, "powers of 0");
        CHECK(mcsi_power(1e9f, 0.0, 1.0f) == 1 && mcsi_power(1e9f, 0.0, 0.5f) == 0, "high powers");
        CHECK(mcsi_atan2_turns(0, 0) == 0 && mcsi_atan2_turns(-1e-30f, 1) < 1, "azimuth of 0, and just below a turn");
        CHECK(mcsi_normal_quantile(0.5f) == 0, "median");
    }
    return mcst_finish();
}
