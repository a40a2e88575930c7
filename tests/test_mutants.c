/* Design check 8: wrong formulas must be caught by name, by the very functions that judge the real rows.
 *
 * A mutant is a row of the registry with one function replaced by a slip: of the lecture, or a classical one. It is
 * caught when a p-value of the chi-square test falls under the suite's level, or when density and lost mass do not add
 * up to 1. The right formula of every row that a mutant was made from must pass the same checks with the same
 * parameters. */
#include "mass.h"

/* --- scaffolding
 */

enum { SAMPLES = 1000000 }; /* not scaled: the power of the checks is what is tested */

static const float two_pi = 6.28318531f;

/* The scalar sampler that array_of_one() loops over: mcst_row's sample_n has no other way to know it. */
static void (*one_sample)(const float *p, const float *u1, const float *u2, float *out);

static void array_of_one(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]) {
    for (size_t i = 0; i < n; i++) {
        float one[5] = {0};
        one_sample(p, &u1[i], &u2[i], one);
        for (int k = 0; k < 5; k++)
            if (out[k]) out[k][i] = one[k];
    }
}

typedef struct {
    double p;   /* the least p-value of chi-square and Kolmogorov-Smirnov */
    double gap; /* |mass - 1| in tolerances */
} verdict;

static verdict judge(const mcst_row *row, const float *p, uint64_t seed) {
    mcst_fit fit;
    fit.chi2_u = fit.ks_u1 = fit.ks_u2 = 1;
    one_sample = row->fn[0].sample;
    mcst_fit_xy(row, p, SAMPLES, seed, &fit);
    verdict v;
    v.p = mcst_fit_worst(&fit);
    const mcst_mass m = mcst_mass_of(row, p);
    v.gap = fabs(m.integral - m.lit) / m.tolerance;
    return v;
}

static int is_caught(const verdict *v, double level) { return !(v->p >= level) || !(v->gap <= 1); }

typedef struct {
    const char *name, *row;
    float a, b, cos_o;
    void (*sample)(const float *p, const float *u1, const float *u2, float *out); /* NULL: the row's own */
    void (*pdf)(const float *p, const float *x, float *out);                      /* NULL: the row's own */
} mutant;

/* --- samplers gone wrong
 */

static void put(float *out, float x, float y, float z, float pdf) {
    out[0] = x;
    out[1] = y;
    out[2] = z;
    out[3] = pdf;
    out[4] = 0;
}

/* pow of a negative number: the lecture's x = (2u - 1)^(1/3) without the sign. */
static void cube_root_by_pow(const float *p, const float *u1, const float *u2, float *out) {
    (void)u2;
    put(out, powf(2 * *u1 - 1, 1 / (p[0] + 1)), 0, 0, 1);
}

static void disk_without_root(const float *p, const float *u1, const float *u2, float *out) {
    put(out, p[0] * *u1 * cosf(two_pi * *u2), p[0] * *u1 * sinf(two_pi * *u2), 0, 1);
}

/* The slides' azimuths: one arctangent reaches half of the circle. */
static void ward_one_arctangent(const float *p, const float *u1, const float *u2, float *out) {
    const float phi = atanf(p[1] / p[0] * tanf(two_pi * *u2));
    const float c = cosf(phi) / p[0];
    const float s = sinf(phi) / p[1];
    const float theta = atanf(sqrtf(-logf(1 - *u1) / (c * c + s * s)));
    put(out, sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta), 1);
}

static void ashikhmin_one_arctangent(const float *p, const float *u1, const float *u2, float *out) {
    const float phi = atanf(sqrtf((p[0] + 1) / (p[1] + 1)) * tanf(0.25f * two_pi * *u2));
    const float c = cosf(phi);
    const float s = sinf(phi);
    const float z = powf(1 - *u1, 1 / (p[0] * c * c + p[1] * s * s + 1));
    const float r = sqrtf(1 - z * z);
    put(out, r * c, r * s, z, 1);
}

/* Rows of an environment map drawn uniformly in the polar angle. */
static void uniform_in_theta(const float *p, const float *u1, const float *u2, float *out) {
    const float theta = 0.5f * two_pi * *u1;
    (void)p;
    put(out, sinf(theta) * cosf(two_pi * *u2), sinf(theta) * sinf(two_pi * *u2), cosf(theta), 1);
}

/* A sample below the surface is turned over instead of rejected. */
static void ward_flipped(const float *p, const float *u1, const float *u2, float *out) {
    const mcs_ward m = mcs_ward_make(p[0], p[1], MCS_WARD_GMD);
    const mcs_dir h = mcs_ward_h_sample(&m, *u1, *u2);
    const float c = p[3] * h.w.x + p[4] * h.w.y + p[5] * h.w.z;
    put(out, 2 * c * h.w.x - p[3], 2 * c * h.w.y - p[4], fabsf(2 * c * h.w.z - p[5]), h.pdf / (4 * fabsf(c)));
}

/* A table of 20 columns, drawn by walking along it. */
enum { COLUMNS = 20 };
static float column_weight(int i) { return (float)(1 + (i * i) % 7); }

static float column_total(void) {
    float sum = 0;
    for (int i = 0; i < COLUMNS; i++) sum += column_weight(i);
    return sum;
}

static void columns(const float *p, const float *u1, const float *u2, float *out) {
    float left = *u1 * column_total();
    int i = 0;
    (void)p;
    (void)u2;
    while (i < COLUMNS - 1 && left >= column_weight(i)) left -= column_weight(i++);
    put(out, ((float)i + left / column_weight(i)) / COLUMNS, 0, 0, 1);
}

/* --- densities gone wrong ----------------------------------------------------------------------------------------- */

static float column_density(const float *x, int shift) {
    const int i = (int)(*x * COLUMNS);
    return column_weight((i + shift) % COLUMNS) * COLUMNS / column_total();
}

static void columns_right(const float *p, const float *x, float *out) {
    (void)p;
    *out = column_density(x, 0);
}

static void columns_off_by_one(const float *p, const float *x, float *out) {
    (void)p;
    *out = column_density(x, 1);
}

static void without_sine(const float *p, const float *x, float *out) {
    (void)p;
    (void)x;
    *out = 2 / (two_pi * two_pi);
}

static void ashikhmin_squared(const float *p, const float *h, float *out) { /* slide 20 */
    const float r2 = h[0] * h[0] + h[1] * h[1];
    const float s = r2 > 0 ? (p[0] * p[0] * h[0] * h[0] + p[1] * p[1] * h[1] * h[1]) / r2 : 0;
    *out = sqrtf((p[0] + 1) * (p[1] + 1)) / two_pi * powf(h[2], s);
}

static void ward_without_cosine(const float *p, const float *h, float *out) { /* slide 17's proportionality */
    const float x = h[0] / (h[2] * p[0]);
    const float y = h[1] / (h[2] * p[1]);
    *out = expf(-(x * x + y * y)) * 2 / (two_pi * p[0] * p[1]);
}

static void changed_parameters(const char *row, const float *p, float a, float b, const float *x, float *out) {
    float q[MCST_P];
    memcpy(q, p, sizeof q);
    q[0] = a;
    q[1] = b;
    mcst_find(row)->fn[0].pdf(q, x, out);
}

static void ggx_swapped_axes(const float *p, const float *h, float *out) {
    changed_parameters("ggx_h", p, p[1], p[0], h, out);
}

static void ggx_alpha_off(const float *p, const float *h, float *out) {
    changed_parameters("ggx_h", p, 1.01f * p[0], 1.01f * p[1], h, out);
}

static void phong_exponent_off(const float *p, const float *w, float *out) {
    changed_parameters("phong_lobe", p, 1.01f * p[0], 0, w, out);
}

static void ashikhmin_exponent_off(const float *p, const float *h, float *out) {
    changed_parameters("ashikhmin_h", p, 1.01f * p[0], 1.01f * p[1], h, out);
}

static void ggx_without_cosine(const float *p, const float *h, float *out) { /* D is not the density of h: D cos is */
    mcst_find("ggx_h")->fn[0].pdf(p, h, out);
    *out /= h[2];
}

static void ggx_without_jacobian(const float *p, const float *wi, float *out) {
    const float h[3] = {p[3] + wi[0], p[4] + wi[1], p[5] + wi[2]};
    mcst_find("ggx")->fn[0].pdf(p, wi, out);
    *out *= 2 * sqrtf(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]); /* 4 wo.h = 2 |wo + wi| */
}

static void vndf_without_g1(const float *p, const float *h, float *out) {
    const mcs_ggx m = mcs_ggx_make(p[0], p[1]);
    const mcs_vec3 wo = {p[3], p[4], p[5]};
    mcst_find("ggx_vndf_h")->fn[0].pdf(p, h, out);
    *out /= mcs_ggx_g1(&m, wo);
}

/* The lost mass of this set, 4 %, spread over the rest. */
static void phong_renormalised(const float *p, const float *wi, float *out) {
    static double mass = 0;
    static double cells[MCST_CELLS];
    if (!(mass > 0)) mass = mcst_masses(mcst_find("phong"), p, 1e-6, cells);
    mcst_find("phong")->fn[0].pdf(p, wi, out);
    *out = (float)((double)*out / mass);
}

static void phong_with_brdf_norm(const float *p, const float *w, float *out) { /* n + 2 is the BRDF's */
    mcst_find("phong_lobe")->fn[0].pdf(p, w, out);
    *out *= (p[0] + 2) / (p[0] + 1);
}

/* Beckmann visible normals, G1 D max(0, wo.h) / wo.z, with G1 = 1/(1 + Lambda): the rational fit that renderers use for
 * Lambda (Walter et al. 2007) is up to 0.3 % off, so that density does not integrate to 1. There is no such row: only
 * the mass is looked at. */
static double lambda_exact(double a) { return 0.5 * (erf(a) - 1) + exp(-a * a) / (2 * a * sqrt(acos(-1.0))); }

static double lambda_rational(double a) {
    return a < 1.6 ? (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a) : 0;
}

static void beckmann_visible(const float *p, const float *h, double (*lambda)(double), float *out) {
    const double wx = (double)p[3] * (double)p[0];
    const double wy = (double)p[4] * (double)p[1];
    const double wz = (double)p[5];
    const double cosine = (double)p[3] * (double)h[0] + (double)p[4] * (double)h[1] + wz * (double)h[2];
    float pdf_h;
    mcst_find("beckmann_h")->fn[0].pdf(p, h, &pdf_h);
    *out = cosine > 0 ? (float)((double)pdf_h / (double)h[2] * cosine / wz / (1 + lambda(wz / sqrt(wx * wx + wy * wy))))
                      : 0;
}

static void beckmann_exact(const float *p, const float *h, float *out) { beckmann_visible(p, h, lambda_exact, out); }

static void beckmann_rational(const float *p, const float *h, float *out) {
    beckmann_visible(p, h, lambda_rational, out);
}

/* --- the list
 */

static const mutant mutants[] = {
    /* slips of the lecture */
    {"Ashikhmin-Shirley exponent with squared n", "ashikhmin_h", 3, 8, 1, NULL, ashikhmin_squared},
    {"Ashikhmin-Shirley azimuth by one arctangent", "ashikhmin_h", 10, 100, 1, ashikhmin_one_arctangent, NULL},
    {"Ward density without 1/cos^3", "ward_h", 0.5f, 0.2f, 1, NULL, ward_without_cosine},
    {"Ward azimuth by one arctangent", "ward_h", 0.5f, 0.2f, 1, ward_one_arctangent, NULL},
    {"3x^2/2 by pow of a negative number", "evenpower", 2, 0, 1, cube_root_by_pow, NULL},
    /* classical mistakes */
    {"no half-vector Jacobian 1/(4 wo.h)", "ggx", 0.5f, 0.2f, 0.5f, NULL, ggx_without_jacobian},
    {"no sin(theta) in a latitude-longitude density", "sphere", 0, 0, 1, uniform_in_theta, without_sine},
    {"axes swapped in an anisotropic density", "ggx_h", 0.5f, 0.2f, 1, NULL, ggx_swapped_axes},
    {"density of the next column", "linear", 1, 1, 1, columns, columns_off_by_one},
    {"Phong exponent 1 % off", "phong_lobe", 10, 0, 1, NULL, phong_exponent_off},
    {"Ashikhmin-Shirley exponents 1 % off", "ashikhmin_h", 10, 100, 1, NULL, ashikhmin_exponent_off},
    {"GGX alpha 1 % off", "ggx_h", 0.5f, 0.2f, 1, NULL, ggx_alpha_off},
    {"GGX D without cos as the density of h", "ggx_h", 0.5f, 0.2f, 1, NULL, ggx_without_cosine},
    {"disk with r = u", "disk", 1, 0, 1, disk_without_root, NULL},
    {"lost samples flipped above the surface", "ward_gmd", 0.5f, 0.2f, 0.5f, ward_flipped, NULL},
    {"visible normals without G1", "ggx_vndf_h", 0.5f, 0.2f, 0.5f, NULL, vndf_without_g1},
    {"lost mass renormalised", "phong", 10, 0, 0.5f, NULL, phong_renormalised},
    {"Phong density with n + 2", "phong_lobe", 10, 0, 1, NULL, phong_with_brdf_norm},
};

/* (bits) * 2^-32 as a float is 1 for the last 128 integers. */
static float u_by_rounding(uint32_t bits) { return (float)bits * 0x1p-32f; }

static int leaves_unit_interval(float (*u)(uint32_t bits)) {
    for (uint32_t i = 0; i < 1024; i++) {
        const float v = u(0xFFFFFFFFu - i);
        const float w = u(i);
        if (!(v >= 0 && v < 1 && w >= 0 && w < 1)) return 1;
    }
    return 0;
}

static float u_right(uint32_t bits) { return mcs_u01(bits); }

static void check_mutant(const mutant *t, double level) {
    mcst_row row = *mcst_find(t->row);
    float p[MCST_P];
    mcst_fill(&row, t->a, t->b, t->cos_o, 0.7f, p);
    if (t->sample) {
        row.fn[0].sample = t->sample;
        row.sample_n = array_of_one;
    }
    if (t->pdf) row.fn[0].pdf = t->pdf;
    const verdict v = judge(&row, p, mcst_seed_for(t->name, "mutant", 0));
    CHECK(is_caught(&v, level), "survived: p = %g, mass %.3g tolerances off", v.p, v.gap);
    mcst_note("  %-50s %s%s%s p = %.3g, mass %.3g tolerances off\n", t->name,
              is_caught(&v, level) ? "caught by" : "SURVIVED", !(v.p >= level) ? " chi-square" : "",
              !(v.gap <= 1) ? " mass" : "", v.p, v.gap);
}
/* The formula that the mutant is a slip of passes where the mutant does not. */
static void check_control(const mutant *t, double level) {
    mcst_row row = *mcst_find(t->row);
    float p[MCST_P];
    mcst_fill(&row, t->a, t->b, t->cos_o, 0.7f, p);
    if (t->sample == columns) {
        row.fn[0].sample = columns;
        row.sample_n = array_of_one;
        row.fn[0].pdf = columns_right;
    }
    const verdict v = judge(&row, p, mcst_seed_for(t->name, "control", 0));
    CHECK(!is_caught(&v, level), "p = %g, mass %.3g tolerances off", v.p, v.gap);
}
/* The mass of Beckmann's visible normals with a density of theirs. */
static mcst_mass mass_with(void (*pdf)(const float *p, const float *x, float *out)) {
    mcst_row row = *mcst_find("ggx_vndf_h");
    float p[MCST_P];
    mcst_fill(&row, 0.5f, 0.5f, 0.5f, 0.7f, p);
    row.fn[0].pdf = pdf;
    return mcst_mass_of(&row, p);
}

int main(int argc, char **argv) {
    const double level = mcst_level();
    mcst_start(argc, argv);
    mcst_group("mutants");
    for (size_t i = 0; i < MCST_COUNT(mutants); i++)
        if (mcst_case("%s", mutants[i].name)) check_mutant(&mutants[i], level);
    if (mcst_case("Beckmann visible normals with a rational Lambda")) {
        const mcst_mass m = mass_with(beckmann_rational);
        CHECK(!(fabs(m.integral - 1) <= m.tolerance), "survived: mass %.8f", m.integral);
        mcst_note("  %-50s %s mass %.6f\n", mcst.name, fabs(m.integral - 1) <= m.tolerance ? "SURVIVED" : "caught by",
                  m.integral);
    }
    if (mcst_case("u = bits * 2^-32")) {
        CHECK(leaves_unit_interval(u_by_rounding), "survived");
        mcst_note("  %-50s %s\n", mcst.name,
                  leaves_unit_interval(u_by_rounding) ? "caught by range: gives 1" : "SURVIVED");
    }
    mcst_group("controls");
    for (size_t i = 0; i < MCST_COUNT(mutants); i++)
        if (mcst_case("right formula for: %s", mutants[i].name)) check_control(&mutants[i], level);
    if (mcst_case("Beckmann visible normals with the exact Lambda")) {
        const mcst_mass m = mass_with(beckmann_exact);
        CHECK(fabs(m.integral - 1) <= m.tolerance, "mass %.8f", m.integral);
    }
    if (mcst_case("mcs_u01 stays below 1")) CHECK(!leaves_unit_interval(u_right), "mcs_u01 left [0,1)");
    return mcst_finish();
}
