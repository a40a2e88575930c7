/* What GGX reflects, and what its compensation adds, against quadrature in double that shares no code with the header:
 * the directional and the mean albedo, and white furnaces. */
#include <float.h>
#include <math.h>
#include "mcs_test.h"
#define MCS_PACKETS 16
#include "mcsample.h"

/* What the header claims. */
static const double albedo_claim = 0.0025;
static const double furnace_claim = 0.004;

static const double half_turn = 3.14159265358979323846;

/* ---- the truth: isotropic GGX, Smith with correlated heights, Fresnel's factor 1 ---- */

/* Lambda of a direction of that cosine. */
static double lambda(double alpha, double cosine) {
    const double tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return (sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}

/* G2 / G1(wo) of a visible normal, which is a point of the projected half-disk of Heitz 2018; 0 below the surface. wo
 * is in the plane y = 0, at the cosine `cosine`. */
static double of_normal(double alpha, double cosine, double radius, double angle) {
    const double sine = sqrt(1 - cosine * cosine);
    const double length = hypot(alpha * sine, cosine);
    const double view_x = alpha * sine / length;
    const double view_z = cosine / length;
    const double t1 = radius * cos(angle);
    const double height = sqrt(1 - t1 * t1);
    const double raised = (1 + view_z) / 2;
    const double t2 = (1 - raised) * height + raised * radius * sin(angle);
    const double along = sqrt(fmax(0, 1 - t1 * t1 - t2 * t2));
    /* The axes are y, (-view_z, 0, view_x) and the view. */
    const double x = alpha * (along * view_x - t2 * view_z);
    const double y = alpha * t1;
    const double z = fmax(0, along * view_z + t2 * view_x);
    const double reflected_z = 2 * (x * sine + z * cosine) * z / (x * x + y * y + z * z) - cosine;
    if (!(reflected_z > 0)) return 0;
    const double lambda_o = lambda(alpha, cosine);
    return (1 + lambda_o) / (1 + lambda_o + lambda(alpha, fmin(1, reflected_z)));
}

/* The mean of that over the disk by the midpoint rule, graded towards the rim. */
static double albedo(double alpha, double cosine, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        const double v = (i + 0.5) / n;
        const double radius = v * (2 - v);
        double ring = 0;
        for (int k = 0; k < n; k++) ring += of_normal(alpha, cosine, radius, half_turn * (2 * k + 1) / n);
        sum += 2 * radius * (2 - 2 * v) * ring / n;
    }
    return sum / n;
}

/* Midpoints of cosines that are dense near the horizon, with their part of the integral of 2 cosine. */
static double graded(int i, int n, double *part) {
    const double v = (i + 0.5) / n;
    *part = 2 * (v * v * v) * 3 * v * v / n;
    return v * v * v;
}

/* ---- the header ---- */

static mcs_vec3 direction(double cosine, double azimuth) {
    const double sine = sqrt(1 - cosine * cosine);
    mcs_vec3 w;
    w.x = (float)(sine * cos(azimuth));
    w.y = (float)(sine * sin(azimuth));
    w.z = (float)cosine;
    return w;
}

/* What the compensation reflects of a white furnace. */
static double compensated(const mcs_ggx *m, mcs_vec3 wo) {
    enum { N = 600 };
    double sum = 0;
    for (int i = 0; i < N; i++) {
        double part;
        const double cosine = graded(i, N, &part);
        sum += half_turn * part * (double)mcs_ggx_compensation(m, wo, direction(cosine, i));
    }
    return sum;
}

static const float alphas[] = {0.01f, 0.0137f, 0.02f, 0.033f, 0.05f, 0.08f, 0.13f, 0.2f,
                               0.3f,  0.42f,   0.5f,  0.6f,   0.7f,  0.8f,  0.9f,  1};
enum { ALPHAS = sizeof alphas / sizeof *alphas, COSINES = 24 };

/* From the horizon over alpha itself, where most is lost, to the normal. */
static double cosine_of(int i, double alpha) {
    const double y = (i + 0.5) / (COSINES - 1);
    return i == COSINES - 1 ? 1 : alpha * y / (1 + alpha - y);
}

static void check_furnaces(float alpha) {
    const mcs_ggx m = mcs_ggx_make(alpha, alpha);
    double worst_albedo = 0;
    double worst_furnace = 0;
    for (int i = 0; i < COSINES; i++) {
        const double cosine = cosine_of(i, (double)alpha);
        const mcs_vec3 wo = direction(cosine, 0.7 * i);
        const double want = albedo((double)alpha, cosine, 200);
        const double got = (double)mcs_ggx_albedo(&m, wo);
        const double sum = want + compensated(&m, wo);
        worst_albedo = fmax(worst_albedo, fabs(got - want) / want);
        worst_furnace = fmax(worst_furnace, fabs(sum - 1));
        CHECK(fabs(got - want) <= albedo_claim * want, "cosine %g: %g, not %g", cosine, got, want);
        CHECK(fabs(sum - 1) <= furnace_claim, "cosine %g: furnace %g", cosine, sum);
        CHECK(fabs(want / got - 1) <= furnace_claim, "cosine %g: furnace by Turquin's factor %g", cosine, want / got);
    }
    mcst_note("    albedo %.4f, furnace %.4f\n", worst_albedo, worst_furnace);
}

static void check_mean(float alpha) {
    enum { N = 100 };
    const mcs_ggx m = mcs_ggx_make(alpha, alpha);
    double want = 0;
    for (int i = 0; i < N; i++) {
        double part;
        const double cosine = graded(i, N, &part);
        want += part * albedo((double)alpha, cosine, 80);
    }
    const double got = (double)mcs_ggx_mean_albedo(&m);
    mcst_note("    mean, alpha %g: %.4f\n", (double)alpha, fabs(got - want) / want);
    CHECK(fabs(got - want) <= albedo_claim * want, "alpha %g: %g, not %g", (double)alpha, got, want);
}

/* The truth itself: 1 - ln 2 is what alpha = 1 reflects at normal incidence, where G2 / G1 is the cosine of wi over
 * (1 + cosine of wi) / 2 and the reflected directions are uniform over the sphere. A mirror reflects all, as does a
 * surface that is seen from the horizon. */
static void check_truth(void) {
    CHECK(fabs(albedo(1, 1, 200) - (1 - log(2))) <= 1e-4, "normal incidence: %g", albedo(1, 1, 200));
    CHECK(fabs(albedo(1e-4, 0.5, 200) - 1) <= 1e-4, "mirror: %g", albedo(1e-4, 0.5, 200));
    CHECK(fabs(albedo(0.5, 1e-9, 200) - 1) <= 1e-4, "horizon: %g", albedo(0.5, 1e-9, 200));
    for (int i = 0; i < COSINES; i += 5) {
        const double coarse = albedo(0.3, cosine_of(i, 0.3), 200);
        const double fine = albedo(0.3, cosine_of(i, 0.3), 500);
        CHECK(fabs(coarse - fine) <= 3e-4, "200 nodes: %g, 500: %g", coarse, fine);
    }
}

/* f itself, as the header has it: what a vndf sample weighs on the average. */
static void check_samples(float alpha, float cosine) {
    enum { N = 512 };
    const mcs_ggx m = mcs_ggx_make(alpha, alpha);
    const mcs_vec3 wo = direction((double)cosine, 1);
    double sum = 0;
    for (int i = 0; i < N * N; i++)
        sum += (double)mcs_ggx_vndf_sample(&m, wo, (float)(i % N) / N, ((float)(i / N) + 0.5f) / N).weight;
    sum /= N * N;
    const double want = albedo((double)alpha, (double)cosine, 300);
    CHECK(fabs(sum - want) <= 1e-3, "alpha %g: samples weigh %g, not %g", (double)alpha, sum, want);
}

static void check_edges(void) {
    const mcs_ggx m = mcs_ggx_make(0.4f, 0.4f);
    const mcs_ggx rough = mcs_ggx_make(1, 1);
    const mcs_ggx rougher = mcs_ggx_make(7, 9);
    const mcs_ggx smooth = mcs_ggx_make(1e-7f, 1e-7f);
    const mcs_ggx bad = mcs_ggx_make(-1, 1);
    const mcs_vec3 w = direction(0.3, 1);
    const mcs_vec3 v = direction(0.8, 2);
    const mcs_vec3 below = direction(-0.8, 2);
    const mcs_vec3 horizon = direction(1e-30, 2);
    const mcs_vec3 none = {NAN, 0, 0};
    CHECK(mcs_ggx_compensation(&m, w, v) == mcs_ggx_compensation(&m, v, w), "reciprocal");
    CHECK(mcs_ggx_compensation(&m, below, v) == 0 && mcs_ggx_compensation(&m, v, below) == 0, "below");
    CHECK(mcs_ggx_compensation(&m, none, v) == 0 && mcs_ggx_compensation(&m, v, none) == 0, "NaN");
    CHECK(mcs_ggx_albedo(&m, none) == 0 && mcs_ggx_albedo(&m, below) == 0, "albedo of nothing");
    CHECK(mcs_ggx_albedo(&bad, v) == 0 && mcs_ggx_mean_albedo(&bad) == 0 && mcs_ggx_compensation(&bad, v, w) == 0,
          "bad material");
    CHECK(mcs_ggx_albedo(&rough, v) == mcs_ggx_albedo(&rougher, v), "alpha above 1");
    CHECK(mcs_ggx_mean_albedo(&rough) == mcs_ggx_mean_albedo(&rougher), "mean, alpha above 1");
    CHECK(mcs_ggx_albedo(&smooth, v) == 1 && mcs_ggx_mean_albedo(&smooth) == 1, "mirror");
    CHECK(mcs_ggx_albedo(&m, horizon) == 1 && mcs_ggx_compensation(&m, horizon, w) >= 0, "horizon");
}

/* Where alphas differ: a guess, held to what the header says of it. */
static void check_guess(float alpha_x, float alpha_y, double tol) {
    enum { N = 200 };
    const mcs_ggx m = mcs_ggx_make(alpha_x, alpha_y);
    double worst = 0;
    for (int k = 0; k < 5; k++)
        for (int j = 1; j <= 12; j++) {
            const mcs_vec3 wo = direction(pow(j / 12.0, 3), k * half_turn / 8);
            double sum = 0;
            for (int i = 0; i < N * N; i++)
                sum += (double)mcs_ggx_vndf_sample(&m, wo, (float)(i % N) / N, ((float)(i / N) + 0.5f) / N).weight;
            worst = fmax(worst, fabs((double)mcs_ggx_albedo(&m, wo) * N * N / sum - 1));
        }
    mcst_note("    alphas %g and %g: %.4f\n", (double)alpha_x, (double)alpha_y, worst);
    CHECK(worst <= tol, "alphas %g and %g: %g", (double)alpha_x, (double)alpha_y, worst);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("energy");
    if (mcst_case("the truth: 1 - ln 2, mirrors, the horizon")) check_truth();
    for (int i = 0; i < ALPHAS; i++)
        if (mcst_case("albedo and furnace, alpha %g", (double)alphas[i])) check_furnaces(alphas[i]);
    if (mcst_case("mean albedo"))
        for (int i = 0; i < ALPHAS; i += 3) check_mean(alphas[i]);
    if (mcst_case("samples weigh the albedo"))
        for (int i = 0; i < ALPHAS; i += 5) check_samples(alphas[i], 0.05f + 0.06f * (float)i);
    if (mcst_case("edges")) check_edges();
    if (mcst_case("alphas that differ")) {
        check_guess(0.15f, 0.3f, 0.05);
        check_guess(0.5f, 1, 0.16);
    }
    return mcst_finish();
}
