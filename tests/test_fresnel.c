/* Fresnel's reflectances and refraction against textbook forms in long double: both sides, grazing, near the critical
 * and near Brewster's angle, and where the indices are almost alike. */
#include <float.h>
#include <math.h>
#include "mcs_test.h"
#define MCS_PACKETS 16
#include "mcsample.h"
#include "oracle.h"

static const double eps = 0x1p-24; /* rounding of a float, relative */
/* What the header claims, relative. In units of eps, by its rounding: for dielectrics q takes 1.5 (its square one half,
 * the root 1), the divisor of r_p 3.5 (n_t^2 c 2, n_i q 2.5, the sum 1), so its square 8, the numerator 3, and r_p^2 with
 * the sum 26. For conductors |w| takes 1.5, its root 2.25, the other part 4.25, the longer divisor 6.6, and all 19.3. */
static const double dielectric_claim = 1.6e-6;
static const double conductor_claim = 1.2e-6;
enum { MANY = 400000 };

static double pick(mcs_pcg32 *r, double lo, double hi) { return lo * pow(hi / lo, (double)mcs_pcg32_float(r)); }

static float pick_eta(mcs_pcg32 *r) {
    static const float special[] = {1 - 0x1p-24f, 1 + 0x1p-23f, 1 - 1e-6f, 1 + 1e-6f, 1,     1.5f, 1 / 1.5f,
                                    1.33f,        2.42f,        1 / 3.0f,  3,         0.25f, 4,    0.5f};
    const uint32_t kind = mcs_pcg32_next(r) % 4;
    if (kind == 0) return special[mcs_pcg32_next(r) % (sizeof special / sizeof *special)];
    if (kind == 1) return (float)(1 + (mcs_pcg32_next(r) % 2 ? 1 : -1) * pick(r, 1e-7, 0.1));
    return (float)pick(r, 0.25, 4);
}

/* The critical cosine on the side of the higher index, with its sign; 0 where the indices are alike. */
static double critical(double eta) { return eta < 1 ? sqrt((1 - eta) * (1 + eta)) : -sqrt(1 - 1 / (eta * eta)); }

static float any_cosine(mcs_pcg32 *r, double eta) {
    static const float special[] = {0, 1, 1e-7f, 1e-15f, 0x1p-24f, 1 - 0x1p-24f, -1, -1e-7f, FLT_MIN, 0.5f};
    const double sign = mcs_pcg32_next(r) % 2 ? 1 : -1;
    switch (mcs_pcg32_next(r) % 7) {
    case 0: return special[mcs_pcg32_next(r) % (sizeof special / sizeof *special)];
    case 1: return (float)(sign * pick(r, 1e-8, 1));
    case 2: return (float)(sign * (1 - pick(r, 1e-8, 1)));
    case 3: return (float)(critical(eta) * (1 + sign * pick(r, 1e-9, 0.1)));
    case 4: return nextafterf((float)critical(eta), (float)sign);
    case 5: return (float)((1 + sign * pick(r, 1e-9, 0.1)) / sqrt(1 + eta * eta));
    default: return (float)(sign * (double)mcs_pcg32_float(r));
    }
}

static float pick_cosine(mcs_pcg32 *r, double eta) { return fminf(1, fmaxf(-1, any_cosine(r, eta))); }

/* How far rounding in double moves q = n_t cos_t: q^2 is a sum of terms whose sizes add up to `terms`, each off by
 * 2^-52 of itself at most. Of an index far from 1 that is seen near the critical angle. */
static double moved(double q2, double terms) { return sqrt(fmax(q2, 0) + 0x1p-52 * terms) - sqrt(fmax(q2, 0)); }

/* The relative change of the reflectance by that. */
static double conditioning(double cos_i, double eta) {
    const double n_i = cos_i < 0 ? eta : 1;
    const double n_t = cos_i < 0 ? 1 : eta;
    const double c = fabs(cos_i);
    const double q2 = (n_t * n_t - n_i * n_i) + n_i * n_i * c * c;
    const double terms = fabs(n_t * n_t - n_i * n_i) + n_i * n_i * c * c;
    const double q = sqrt(fmax(q2, 0));
    return 4 * moved(q2, terms) * fmax(1 / (n_i * c + q), n_i / (n_t * n_t * c + n_i * q));
}

/* ---- the oracle itself ---- */

static void check_oracle(mcs_pcg32 *r) {
    for (int i = 0; i < 10000; i++) {
        const ld n = pick_eta(r);
        const ld k = i % 3 ? (ld)pick(r, 1e-3, 10) : 0;
        const ld c = 0.01L + 0.99L * mcs_pcg32_float(r);
        const ld normal = ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
        CHECK(fabsl(o_fresnel_conductor(1, n, k) - normal) <= 1e-12L * normal, "normal incidence: %Lg %Lg", n, k);
        CHECK(o_fresnel_conductor(0, n, k) == 1 || n == 1 || k == 0, "grazing: %Lg %Lg", n, k);
        const ld want = o_fresnel_dielectric(c, n);
        const ld cancelled = n == 1 ? 0 : 1e-17L / fabsl(n - 1);
        CHECK(fabsl(o_fresnel_conductor(c, n, 0) - want) <= (1e-12L + cancelled) * want, "k = 0: %Lg at %Lg", n, c);
        const ld cos2_t = o_snell(c, n);
        if (cos2_t < 1e-6L) continue;
        const ld back = o_fresnel_dielectric(-sqrtl(cos2_t), n);
        CHECK(fabsl(back - want) <= (1e-10L + cancelled) * want, "from behind: %Lg at %Lg: %Lg, not %Lg", n, c, back,
              want);
        const ld angle = acosl(c);
        const ld angle_t = asinl(sqrtl(1 - c * c) / n);
        if (fabsl(n - 1) < 1e-3L || c > 0.999L) continue;
        const ld s = sinl(angle - angle_t) / sinl(angle + angle_t);
        const ld p = tanl(angle - angle_t) / tanl(angle + angle_t);
        CHECK(fabsl((s * s + p * p) / 2 - want) <= 1e-9L * want, "Fresnel's sines and tangents: %Lg at %Lg", n, c);
    }
}

/* ---- dielectrics ---- */

static double worst;

static void check_dielectric(float c, float eta, double tol) {
    const double want = (double)o_fresnel_dielectric(c, eta);
    const double got = (double)mcs_fresnel_dielectric(c, eta);
    const double err = want > 0 ? fabs(got - want) / want : fabs(got);
    worst = fmax(worst, err);
    CHECK(err <= tol && got >= 0 && got <= 1, "cos_i %a, eta %a: %.9g, not %.9g, off by %.3g", (double)c, (double)eta,
          got, want, err);
}

static void test_dielectric(mcs_pcg32 *r) {
    if (mcst_case("dielectric: within 1.6e-6 for eta in [1/4, 4]")) {
        worst = 0;
        for (int i = 0; i < MANY; i++) {
            const float eta = pick_eta(r);
            check_dielectric(pick_cosine(r, (double)eta), eta, dielectric_claim);
        }
        mcst_note("    dielectric: %.3g\n", worst);
    }
    if (mcst_case("dielectric: for eta in [1e-3, 1e3]"))
        for (int i = 0; i < MANY; i++) {
            const float eta = (float)pick(r, 1.001e-3, 999);
            const float c = pick_cosine(r, (double)eta);
            check_dielectric(c, eta, dielectric_claim + conditioning((double)c, (double)eta));
        }
    if (mcst_case("dielectric: edges")) {
        const double glass[2] = {(double)mcs_fresnel_dielectric(1, 1.5f), (double)mcs_fresnel_dielectric(-1, 1.5f)};
        CHECK(fabs(glass[0] - 0.04) <= 1e-7 && fabs(glass[1] - 0.04) <= 1e-7, "glass: %.9g, %.9g", glass[0], glass[1]);
        CHECK(mcs_fresnel_dielectric(-0.7f, 1.5f) == 1 && mcs_fresnel_dielectric(0.7f, 1 / 1.5f) == 1,
              "total reflection");
        CHECK(mcs_fresnel_dielectric(0, 1) == 0 && mcs_fresnel_dielectric(1e-30f, 1) == 0, "alike, grazing");
        CHECK(mcs_fresnel_dielectric(2, 1.5f) == mcs_fresnel_dielectric(1, 1.5f) &&
                  mcs_fresnel_dielectric(-INFINITY, 1.5f) == mcs_fresnel_dielectric(-1, 1.5f),
              "cosines beyond 1");
    }
}

/* ---- conductors ---- */

static void check_conductor(float c, float eta, float k, double tol) {
    const double want = (double)o_fresnel_conductor(c, eta, k >= 1e-9f ? (ld)k : 0);
    const double got = (double)mcs_fresnel_conductor(c, eta, k);
    const double err = want > 0 ? fabs(got - want) / want : fabs(got);
    worst = fmax(worst, err);
    CHECK(err <= tol && got >= 0 && got <= 1, "cos_i %a, eta %a, k %a: %.9g, not %.9g, off by %.3g", (double)c,
          (double)eta, (double)k, got, want, err);
}

static void test_conductor(mcs_pcg32 *r) {
    /* Silver, gold, copper, aluminium, chromium, iron, tungsten, lithium: index and extinction near 550 nm. */
    static const float metal[][2] = {{0.055f, 3.32f}, {0.43f, 2.46f}, {0.94f, 2.58f}, {0.96f, 6.69f},
                                     {3.18f, 3.31f},  {2.95f, 2.93f}, {3.5f, 2.72f},  {0.22f, 2.6f}};
    if (mcst_case("conductor: metals within 1.2e-6")) {
        worst = 0;
        for (int i = 0; i < MANY; i++) {
            const float *m = metal[i % 8];
            check_conductor(fabsf(pick_cosine(r, (double)m[0])), m[0], m[1], conductor_claim);
        }
        mcst_note("    metals: %.3g\n", worst);
    }
    if (mcst_case("conductor: within 1.2e-6 for eta in [1/4, 4], any k")) {
        worst = 0;
        for (int i = 0; i < MANY; i++) {
            const float eta = pick_eta(r);
            const float k = i % 4 ? (float)pick(r, 1e-10, 999) : 0;
            check_conductor(fabsf(pick_cosine(r, (double)eta)), eta, k, conductor_claim);
        }
        mcst_note("    conductor: %.3g\n", worst);
    }
    if (mcst_case("conductor: for eta and k up to 1e3"))
        for (int i = 0; i < MANY; i++) {
            const float eta = (float)pick(r, 1.001e-3, 999);
            const float k = i % 4 ? (float)pick(r, 1e-10, 999) : 0;
            const float c = fabsf(pick_cosine(r, (double)eta));
            check_conductor(c, eta, k, conductor_claim + conditioning((double)c, (double)eta));
        }
    if (mcst_case("conductor: edges")) {
        CHECK(mcs_fresnel_conductor(-1, 0.2f, 3) == mcs_fresnel_conductor(0, 0.2f, 3) &&
                  mcs_fresnel_conductor(INFINITY, 0.2f, 3) == mcs_fresnel_conductor(1, 0.2f, 3),
              "cosines beyond 0 and 1");
        CHECK(mcs_fresnel_conductor(0, 1, 0) == 0 && mcs_fresnel_conductor(0.3f, 1, 0) == 0, "nothing");
        CHECK(mcs_fresnel_conductor(0.5f, 1.5f, 9e-10f) == mcs_fresnel_conductor(0.5f, 1.5f, 0),
              "hardly any extinction");
    }
}

/* ---- refraction ---- */

static o_vec3 wide_of(mcs_vec3 v) { return o_v3(v.x, v.y, v.z); }

static double far_from(mcs_vec3 a, o_vec3 b) {
    return (double)fmaxl(fabsl(a.x - b.x), fmaxl(fabsl(a.y - b.y), fabsl(a.z - b.z)));
}

static mcs_vec3 narrow_of(o_vec3 v, ld length) {
    mcs_vec3 w;
    w.x = (float)(length * v.x);
    w.y = (float)(length * v.y);
    w.z = (float)(length * v.z);
    return w;
}

static o_vec3 random_unit(mcs_pcg32 *r) { return o_polar(2.0L * mcs_pcg32_float(r), mcs_pcg32_float(r)); }

/* A direction at the given cosine to h, of about unit length. */
static mcs_vec3 at_cosine(mcs_pcg32 *r, o_vec3 h, ld c, ld length) {
    o_vec3 s, t;
    o_frame(h, &s, &t);
    ld sine, cosine;
    o_sincos2pi(mcs_pcg32_float(r), &sine, &cosine);
    const ld across = sqrtl((1 - c) * (1 + c));
    return narrow_of(o_add(o_scale(c, h), o_add(o_scale(across * cosine, s), o_scale(across * sine, t))), length);
}

static int is_zero(mcs_vec3 w) { return w.x == 0 && w.y == 0 && w.z == 0; }

/* A coordinate is rounded by half of eps, by eps where it is 1 or more. Near the critical angle double moves q^2 by
 * 60 x 2^-53 at most for eta = 3, which is 1.4 eps of q where that is 0: less than 2 eps = 2^-23 in all. `slack`: the
 * same for an eta far from 1. */
static void check_refract(mcs_vec3 w, mcs_vec3 h, float eta, double slack) {
    const o_vec3 want = o_refract(wide_of(w), wide_of(h), eta);
    const mcs_vec3 got = mcs_refract(w, h, eta);
    const ld c = o_dot(o_unit(wide_of(w)), o_unit(wide_of(h)));
    const ld n = o_relative_index(c, eta);
    if (is_zero(got) || o_len(want) == 0) {
        CHECK(o_snell(c, n) <= fmax(1e-14, slack * slack) && n != 1, "none: w %a %a %a, h %a %a %a, eta %a, cos^2 %Lg",
              (double)w.x, (double)w.y, (double)w.z, (double)h.x, (double)h.y, (double)h.z, (double)eta, o_snell(c, n));
        return;
    }
    const double err = far_from(got, want);
    const double length = (double)fabsl(o_len(wide_of(got)) - 1);
    worst = fmax(worst, err / eps);
    CHECK(err <= 2 * eps + slack && length <= 4 * eps, "w %a %a %a, h %a %a %a, eta %a: off by %g and %g of 2^-24",
          (double)w.x, (double)w.y, (double)w.z, (double)h.x, (double)h.y, (double)h.z, (double)eta, err / eps,
          length / eps);
}

static void test_refract(mcs_pcg32 *r) {
    static const float lengths[] = {1, 1, 1, 0.51f, 1.99f};
    if (mcst_case("refract: within 2^-23 for eta in [1/4, 4]")) {
        worst = 0;
        for (int i = 0; i < MANY; i++) {
            const float eta = pick_eta(r);
            const o_vec3 up = i % 5 ? random_unit(r) : o_vec(0, 0, i % 2 ? 1 : -1);
            const mcs_vec3 h = narrow_of(up, lengths[mcs_pcg32_next(r) % 5]);
            const ld c = fmaxl(-1, fminl(1, pick_cosine(r, (double)eta)));
            check_refract(at_cosine(r, up, c, lengths[mcs_pcg32_next(r) % 5]), h, eta, 0);
        }
        mcst_note("    refract: %.3g of 2^-24\n", worst);
    }
    if (mcst_case("refract: for eta in [1e-3, 1e3]"))
        for (int i = 0; i < MANY; i++) {
            const float eta = (float)pick(r, 1.001e-3, 999);
            const o_vec3 h = random_unit(r);
            const ld c = fmaxl(-1, fminl(1, pick_cosine(r, (double)eta)));
            const double n_i = fmax(1, (double)eta);
            const double q2 = n_i * n_i * ((double)(c * c) - critical((double)eta) * critical((double)eta));
            const double slack =
                moved(fabs(q2) < 1e-6 * n_i * n_i ? 0 : fabs(q2), 20 * n_i * n_i) / fmin(1, (double)eta);
            check_refract(at_cosine(r, h, c, 1), narrow_of(h, 1), eta, slack);
        }
    if (mcst_case("refract: edges")) {
        const mcs_vec3 up = {0, 0, 1};
        const mcs_vec3 level = {1, 0, 0};
        const mcs_vec3 steep = {0.28f, 0, 0.96f};
        const mcs_vec3 below = {0.28f, 0, -0.96f};
        const mcs_vec3 oblique = {0.96f, 0, -0.28f};
        mcs_vec3 t = mcs_refract(up, up, 1.5f);
        CHECK(t.x == 0 && t.y == 0 && t.z == -1, "straight: %g %g %g", (double)t.x, (double)t.y, (double)t.z);
        t = mcs_refract(level, up, 1);
        CHECK(t.x == -1 && t.y == 0 && t.z == 0, "alike, grazing: %g %g %g", (double)t.x, (double)t.y, (double)t.z);
        CHECK(mcs_refract(steep, up, 1.5f).z < -0.96f && mcs_refract(below, up, 1.5f).z > 0, "sides");
        CHECK(is_zero(mcs_refract(oblique, up, 1.5f)) && !is_zero(mcs_refract(oblique, up, 1 / 1.5f)),
              "total reflection");
    }
}

/* ---- bad input ---- */

static void test_bad(void) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, -1, 0, -0.0f, 1e-45f, 9.9e-4f, 1.01e3f, FLT_MAX, -FLT_MAX};
    enum { ODD = (int)(sizeof odd / sizeof *odd) };
    const mcs_vec3 w = {0.6f, 0, 0.8f};
    const mcs_vec3 up = {0, 0, 1};
    for (int i = 0; i < ODD; i++) {
        const float x = odd[i];
        CHECK(mcs_fresnel_dielectric(0.5f, x) == 0 && mcs_fresnel_conductor(0.5f, x, 1) == 0, "eta %g", (double)x);
        CHECK((mcs_fresnel_conductor(0.5f, 1.5f, x) == 0) == !(x >= 0 && x <= 1e3f), "k %g", (double)x);
        CHECK(is_zero(mcs_refract(w, up, x)), "refract, eta %g", (double)x);
        for (int k = 0; k < 3; k++) {
            const mcs_vec3 v = {k == 0 ? x : 0, k == 1 ? x : 0, k == 2 ? x : 0};
            const int good = x == -1;
            CHECK(is_zero(mcs_refract(v, up, 1.5f)) != good && is_zero(mcs_refract(up, v, 1.5f)) != good, "%g along %d",
                  (double)x, k);
        }
    }
    CHECK(mcs_fresnel_dielectric(NAN, 1.5f) == 0 && mcs_fresnel_conductor(NAN, 0.2f, 3) == 0, "NaN cosine");
}

/* ---- widths ---- */

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi" /* wide functions are inlined: no vector crosses a call */
#endif
/* in: a cosine, eta, k, w, h */
enum { INPUTS = 9 };
#define WIDE(W)                                                                                                    \
    static void wide##W(const float(*in)[16]) {                                                                    \
        const mcs##W##_vec3 w = {mcs##W##_load(in[3]), mcs##W##_load(in[4]), mcs##W##_load(in[5])};                \
        const mcs##W##_vec3 h = {mcs##W##_load(in[6]), mcs##W##_load(in[7]), mcs##W##_load(in[8])};                \
        const mcs##W##_f eta = mcs##W##_load(in[1]);                                                               \
        const mcs##W##_f d = mcs##W##_fresnel_dielectric(mcs##W##_load(in[0]), eta);                               \
        const mcs##W##_f m = mcs##W##_fresnel_conductor(mcs##W##_load(in[0]), eta, mcs##W##_load(in[2]));          \
        const mcs##W##_vec3 t = mcs##W##_refract(w, h, eta);                                                       \
        for (int i = 0; i < W; i++) {                                                                              \
            const mcs_vec3 one_w = {in[3][i], in[4][i], in[5][i]};                                                 \
            const mcs_vec3 one_h = {in[6][i], in[7][i], in[8][i]};                                                 \
            const mcs_vec3 one = mcs_refract(one_w, one_h, in[1][i]);                                              \
            CHECK(d[i] == mcs_fresnel_dielectric(in[0][i], in[1][i]), #W " wide, lane %d: dielectric", i);         \
            CHECK(m[i] == mcs_fresnel_conductor(in[0][i], in[1][i], in[2][i]), #W " wide, lane %d: conductor", i); \
            CHECK(t.x[i] == one.x && t.y[i] == one.y && t.z[i] == one.z, #W " wide, lane %d: refract", i);         \
        }                                                                                                          \
    }

#ifndef MCS_NO_WIDE
WIDE(4)
WIDE(8)
WIDE(16)

static void test_widths(mcs_pcg32 *r) {
    for (int i = 0; i < 20000; i++) {
        float in[INPUTS][16];
        for (int l = 0; l < 16; l++) {
            const uint32_t bad = mcs_pcg32_next(r) % 64;
            const float eta = pick_eta(r);
            const float c = pick_cosine(r, (double)eta);
            const o_vec3 h = random_unit(r);
            const mcs_vec3 w = at_cosine(r, h, fmaxl(-1, fminl(1, c)), 1);
            const float x[INPUTS] = {c,          eta,       (float)pick(r, 1e-10, 100), w.x, w.y, w.z, (float)h.x,
                                     (float)h.y, (float)h.z};
            for (int k = 0; k < INPUTS; k++) in[k][l] = bad < INPUTS && k == (int)bad ? NAN : x[k];
        }
        wide4((const float(*)[16])in);
        wide8((const float(*)[16])in);
        wide16((const float(*)[16])in);
    }
}
#endif

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 211);
    mcst_group("fresnel");
    if (mcst_case("the oracle: normal incidence, from behind, sines and tangents")) check_oracle(&r);
    test_dielectric(&r);
    test_conductor(&r);
    test_refract(&r);
    if (mcst_case("bad input")) test_bad();
#ifndef MCS_NO_WIDE
    mcst_group("fresnel: widths");
    if (mcst_contracts()) puts("SKIPPED: the bits of the wide forms, as this build contracts a*b + c");
    else if (mcst_case("4, 8, 16 wide have the bits of scalar")) test_widths(&r);
#endif
    return mcst_finish();
}
