/* Run time beside error: for every sampler and form, ns per sample (sample with pdf, data in the first-level cache) and
 * the error of the same code over the parameter grid of the tests, against tests/oracle.h.
 *
 * Forms: text (text.h), scalar, w4, w8, w16 (loops over the functions of that width; the last two only where the
 * processor has the unit they are compiled for), n (the array form, which picks the width at run time) and, for
 * materials, n+weight.
 *
 * Error of the place: for directions the largest error of a component in units of 2^-24, the ulp of a unit vector's
 * largest component; for disks in ulp of the largest component of the exact point; for lines in ulp of the value, or of
 * the scale where the value is a difference (tent: r; normal, logistic: |mean| + sd; smoothstep: |a|; truncnormal,
 * trunclogistic about 0: 1). Error of the density: |pdf / exact - 1| in units of 1e-6 (1 + |ln(exact / peak)|), where
 * exact is the density at the exact point of u. Left out: densities of reflected directions within 40 2^-24 of the
 * horizon, where lost or not is a matter of rounding. Results that are not finite are counted apart.
 *
 * Of a wo and parameters per sample: hits.h.
 *
 * Writes throughput.csv, hits.csv, and for eight samplers throughput.svg (place) and throughput_pdf.svg; prints the table, and
 * which targets are met. */
#define MCS_PACKETS 4
#include "bench.h"
#include "mcsample.h"
#include "registry.h"
#include "svg.h"
#include "text.h"
#include "throughput.h"

#define BENCH_W 1
#include "forms.h"
#define BENCH_W 4
#include "forms.h"

/* ---- the forms of text.h ---- */

#define TEXT(name, call, keep)                                                                                         \
    static void name##_text(const float *p, size_t n, const float *u1, const float *u2, float *const out[BENCH_OUT]) { \
        const float a = p[0], b = p[1];                                                                                \
        const text_vec wo = {p[3], p[4], p[5]};                                                                        \
        float *const x = out[0], *const y = out[1], *const z = out[2], *const pdf = out[3];                            \
        size_t i;                                                                                                      \
        (void)a, (void)b, (void)wo, (void)y, (void)z;                                                                  \
        for (i = 0; i < n; i++) {                                                                                      \
            const float u = u1[i], v = u2[i];                                                                          \
            const text_sample s = call;                                                                                \
            (void)v;                                                                                                   \
            keep;                                                                                                      \
            pdf[i] = s.pdf;                                                                                            \
        }                                                                                                              \
    }
#define TEXT1(name, call) TEXT(name, call, x[i] = s.x)
#define TEXT2(name, call) TEXT(name, call, (x[i] = s.x, y[i] = s.y))
#define TEXT3(name, call) TEXT(name, call, (x[i] = s.x, y[i] = s.y, z[i] = s.z))
TEXT1(linear, text_linear(a, b, u))
TEXT1(tent, text_tent(a, u))
TEXT1(exponential, text_exponential(a, u))
TEXT1(truncexp, text_truncexp(a, b, u))
TEXT1(normal, text_normal(a, b, u))
TEXT1(logistic, text_logistic(a, b, u))
TEXT1(truncnormal, text_truncnormal(a, b, u))
TEXT1(trunclogistic, text_trunclogistic(a, b, u))
TEXT1(power, text_power(a, u))
TEXT1(evenpower, text_evenpower(a, u))
TEXT1(smoothstep, text_smoothstep(a, b, u))
TEXT2(disk, text_disk(a, u, v))
TEXT2(concentric, text_concentric(a, u, v))
TEXT2(bilinear, text_bilinear(a, b, 1, 3, u, v))
TEXT2(triangle, text_triangle(u, v))
TEXT3(sphere, text_sphere(u, v))
TEXT3(hemisphere, text_hemisphere(u, v))
TEXT3(cosine, text_cosine(u, v))
TEXT3(cone, text_cone(a, u, v))
TEXT3(ball, text_ball(-0.5f * a, 0.25f * a, a, b, u, v))
static const float tilted[3] = {0.48f, 0.6f, -0.64f};
TEXT3(disk_light, text_disk_light((const float[]){-0.5f * a, 0.25f * a, a}, tilted, b, u, v))
TEXT3(spherical_rectangle, text_spherical_rectangle(a, b, u, v))
TEXT3(spherical_triangle, text_spherical_triangle(a, b, u, v))
TEXT3(henyey_greenstein, text_henyey_greenstein(a, u, v))
TEXT3(rayleigh, text_rayleigh(u, v))
TEXT3(von_mises_fisher, text_von_mises_fisher(a, u, v))
TEXT3(phong_lobe, text_phong_lobe(a, u, v))
TEXT3(phong, text_phong(a, wo, u, v))
#define TEXT_LOBE(name)                                               \
    TEXT3(name##_h_iso, text_##name##_h_iso(a, u, v))                 \
    TEXT3(name##_h, text_##name##_h(a, b, u, v))                      \
    TEXT3(name##_iso, text_reflect(wo, text_##name##_h_iso(a, u, v))) \
    TEXT3(name, text_reflect(wo, text_##name##_h(a, b, u, v)))
TEXT_LOBE(ward)
TEXT_LOBE(beckmann)
TEXT_LOBE(ggx)
TEXT_LOBE(ashikhmin)
TEXT3(ggx_vndf_h, text_ggx_vndf_h(a, b, wo, u, v))
TEXT3(ggx_vndf, text_reflect(wo, text_ggx_vndf_h(a, b, wo, u, v)))
TEXT3(ggx_bounded_h, text_ggx_bounded_h(a, b, wo, u, v))
TEXT3(ggx_bounded, text_reflect(wo, text_ggx_bounded_h(a, b, wo, u, v)))

/* The published visible-normal samplers map u to other points than the header does (Heitz by his own parametrisation;
 * the bounded caps with azimuths from +x instead of from that of wo), so they have truths of their own. */
static o_vec3 heitz_h(const float *p, ld u1, ld u2) {
    const ld ax = p[0], ay = p[1];
    const o_vec3 wo = mcst_o3(p + 3), e = o_unit(o_vec(ax * wo.x, ay * wo.y, wo.z));
    const ld l = sqrtl(e.x * e.x + e.y * e.y), r = sqrtl(u1);
    const o_vec3 t1 = l > 0 ? o_vec(-e.y / l, e.x / l, 0) : o_vec(1, 0, 0), t2 = o_cross(e, t1);
    ld a, b, s, c;
    o_sincos2pi(u2, &s, &c);
    a = r * c;
    b = 0.5L * (1 - e.z) * sqrtl(1 - a * a) + 0.5L * (1 + e.z) * r * s;
    c = sqrtl(fmaxl(0, 1 - a * a - b * b));
    return o_unit(o_vec(ax * (a * t1.x + b * t2.x + c * e.x), ay * (a * t1.y + b * t2.y + c * e.y),
                        fmaxl(0, a * t1.z + b * t2.z + c * e.z)));
}
static ld heitz_h_pdf_u(const float *p, ld u1, ld u2) {
    return o_ggx_vndf_h_pdf(p[0], p[1], mcst_o3(p + 3), heitz_h(p, u1, u2));
}
static ld heitz_pdf_u(const float *p, ld u1, ld u2) {
    return o_reflected_pdf(mcst_o3(p + 3), heitz_h(p, u1, u2), heitz_h_pdf_u(p, u1, u2));
}
static void put(o_vec3 v, ld *x) { x[0] = v.x, x[1] = v.y, x[2] = v.z; }
static void heitz_h_map(const float *p, ld u1, ld u2, ld *x) { put(heitz_h(p, u1, u2), x); }
static void heitz_map(const float *p, ld u1, ld u2, ld *x) { put(o_reflect(mcst_o3(p + 3), heitz_h(p, u1, u2)), x); }
static ld from_x(const float *p, ld u1) { /* an azimuth from +x as one from the stretched wo */
    const ld x = (ld)p[0] * p[3], y = (ld)p[1] * p[4];
    return x == 0 && y == 0 ? u1 : u1 - o_turn(y, x);
}
static void caps_h_map(const float *p, ld u1, ld u2, ld *x) {
    put(o_ggx_bounded_h_map(p[0], p[1], mcst_o3(p + 3), from_x(p, u1), u2), x);
}
static ld caps_h_pdf_u(const float *p, ld u1, ld u2) {
    return o_ggx_bounded_h_pdf_u(p[0], p[1], mcst_o3(p + 3), from_x(p, u1), u2);
}
static void caps_map(const float *p, ld u1, ld u2, ld *x) {
    put(o_ggx_bounded_map(p[0], p[1], mcst_o3(p + 3), from_x(p, u1), u2), x);
}
static ld caps_pdf_u(const float *p, ld u1, ld u2) {
    return o_ggx_bounded_pdf_u(p[0], p[1], mcst_o3(p + 3), from_x(p, u1), u2);
}

/* ---- what is measured ---- */

enum { TEXT, SCALAR, W4, W8, W16, ARRAY, WEIGHT, FORMS, ROUNDS_MAX = 41 };
static const char *const form_name[FORMS] = {"text", "scalar", "w4", "w8", "w16", "n", "n+weight"};
enum { ALL, ISO, ANISO }; /* which parameter sets of the grid */

typedef struct {
    double max, rms, pdf_max, pdf_rms; /* rms: sums of squares until summed_up */
    long points, pdf_points, bad;
    int worse; /* parameter sets in which the largest error of the place exceeds that of text */
    float at[MCST_P + 2], pdf_at[MCST_P + 2]; /* parameters and u of the two largest errors */
} errors;

typedef struct {
    const char *name, *row;
    int subset;
    float a, b; /* the parameters that are timed */
    bench_form *text;
    double target; /* text against n */
    void (*text_map)(const float *p, ld u1, ld u2, ld *x);
    ld (*text_pdf_u)(const float *p, ld u1, ld u2);
} sampler;

/* Rows that the list leaves out are measured without a text. Ward 1992 and Duer have the samples and densities of ward
 * and other weights: their function is in the list. */
static const sampler listed[] = {
    {"linear", "linear", ALL, 1, 3, linear_text, 0, NULL, NULL},
    {"tent", "tent", ALL, 2, 0, tent_text, 0, NULL, NULL},
    {"exponential", "exponential", ALL, 2, 0, exponential_text, 0, NULL, NULL},
    {"truncexp", "truncexp", ALL, 3, 1, truncexp_text, 0, NULL, NULL},
    {"normal", "normal", ALL, 1, 2, normal_text, 0, NULL, NULL},
    {"logistic", "logistic", ALL, 1, 2, logistic_text, 0, NULL, NULL},
    {"truncnormal", "truncnormal", ALL, -1, 2, truncnormal_text, 0, NULL, NULL},
    {"trunclogistic", "trunclogistic", ALL, -1, 2, trunclogistic_text, 0, NULL, NULL},
    {"power", "power", ALL, 10, 0, power_text, 0, NULL, NULL},
    {"evenpower", "evenpower", ALL, 2, 0, evenpower_text, 0, NULL, NULL},
    {"smoothstep", "smoothstep", ALL, 2, 5, smoothstep_text, 0, NULL, NULL},
    {"disk", "disk", ALL, 2, 0, disk_text, 10, NULL, NULL},
    {"concentric", "concentric", ALL, 2, 0, concentric_text, 0, NULL, NULL},
    {"bilinear", "bilinear", ALL, 2, 5, bilinear_text, 0, NULL, NULL},
    {"triangle", "triangle", ALL, 0, 0, triangle_text, 0, NULL, NULL},
    {"sphere", "sphere", ALL, 0, 0, sphere_text, 0, NULL, NULL},
    {"hemisphere", "hemisphere", ALL, 0, 0, hemisphere_text, 0, NULL, NULL},
    {"cosine", "cosine", ALL, 0, 0, cosine_text, 10, NULL, NULL},
    {"cone", "cone", ALL, 0.5f, 0, cone_text, 0, NULL, NULL},
    {"ball", "ball", ALL, 2, 1, ball_text, 0, NULL, NULL},
    {"disk_light", "disk_light", ALL, 2, 1, disk_light_text, 0, NULL, NULL},
    {"spherical_rectangle", "spherical_rectangle", ALL, 0.5f, 1, spherical_rectangle_text, 0, NULL, NULL},
    {"spherical_triangle", "spherical_triangle", ALL, 0.5f, 1, spherical_triangle_text, 0, NULL, NULL},
    {"henyey_greenstein", "henyey_greenstein", ALL, 0.5f, 0, henyey_greenstein_text, 0, NULL, NULL},
    {"rayleigh", "rayleigh", ALL, 0, 0, rayleigh_text, 0, NULL, NULL},
    {"von_mises_fisher", "von_mises_fisher", ALL, 10, 0, von_mises_fisher_text, 0, NULL, NULL},
    {"phong_lobe", "phong_lobe", ALL, 50, 0, phong_lobe_text, 12, NULL, NULL},
    {"phong", "phong", ALL, 50, 0, phong_text, 12, NULL, NULL},
    {"ward_h iso", "ward_h", ISO, 0.3f, 0.3f, ward_h_iso_text, 0, NULL, NULL},
    {"ward_h aniso", "ward_h", ANISO, 0.1f, 0.4f, ward_h_text, 40, NULL, NULL},
    {"ward iso", "ward_gmd", ISO, 0.3f, 0.3f, ward_iso_text, 0, NULL, NULL},
    {"ward aniso", "ward_gmd", ANISO, 0.1f, 0.4f, ward_text, 40, NULL, NULL},
    {"beckmann_h iso", "beckmann_h", ISO, 0.3f, 0.3f, beckmann_h_iso_text, 0, NULL, NULL},
    {"beckmann_h aniso", "beckmann_h", ANISO, 0.1f, 0.4f, beckmann_h_text, 0, NULL, NULL},
    {"beckmann iso", "beckmann", ISO, 0.3f, 0.3f, beckmann_iso_text, 0, NULL, NULL},
    {"beckmann aniso", "beckmann", ANISO, 0.1f, 0.4f, beckmann_text, 0, NULL, NULL},
    {"ggx_h iso", "ggx_h", ISO, 0.3f, 0.3f, ggx_h_iso_text, 15, NULL, NULL},
    {"ggx_h aniso", "ggx_h", ANISO, 0.1f, 0.4f, ggx_h_text, 0, NULL, NULL},
    {"ggx iso", "ggx", ISO, 0.3f, 0.3f, ggx_iso_text, 15, NULL, NULL},
    {"ggx aniso", "ggx", ANISO, 0.1f, 0.4f, ggx_text, 0, NULL, NULL},
    {"ggx_vndf_h", "ggx_vndf_h", ALL, 0.1f, 0.4f, ggx_vndf_h_text, 25, heitz_h_map, heitz_h_pdf_u},
    {"ggx_vndf", "ggx_vndf", ALL, 0.1f, 0.4f, ggx_vndf_text, 25, heitz_map, heitz_pdf_u},
    {"ggx_bounded_h", "ggx_bounded_h", ALL, 0.1f, 0.4f, ggx_bounded_h_text, 0, caps_h_map, caps_h_pdf_u},
    {"ggx_bounded", "ggx_bounded", ALL, 0.1f, 0.4f, ggx_bounded_text, 0, caps_map, caps_pdf_u},
    {"ashikhmin_h iso", "ashikhmin_h", ISO, 50, 50, ashikhmin_h_iso_text, 0, NULL, NULL},
    {"ashikhmin_h aniso", "ashikhmin_h", ANISO, 10, 100, ashikhmin_h_text, 30, NULL, NULL},
    {"ashikhmin iso", "ashikhmin", ISO, 50, 50, ashikhmin_iso_text, 0, NULL, NULL},
    {"ashikhmin aniso", "ashikhmin", ANISO, 10, 100, ashikhmin_text, 30, NULL, NULL},
};
enum { LISTED = sizeof listed / sizeof listed[0], SAMPLERS_MAX = LISTED + MCST_NROWS };
static sampler samplers[SAMPLERS_MAX];
static int sampler_count;

static int is_listed(const mcst_row *row) {
    int k;
    for (k = 0; k < sampler_count; k++)
        if (!strcmp(mcst_find(samplers[k].row)->function, row->function)) return 1;
    return 0;
}
static void list_samplers(void) {
    int i;
    memcpy(samplers, listed, sizeof listed);
    sampler_count = LISTED;
    for (i = 0; i < MCST_NROWS; i++) {
        const mcst_row *const row = &mcst_rows[i];
        const sampler plain = {row->name, row->name, ALL, row->grid[0][0], row->grid[0][1], NULL, 0, NULL, NULL};
        if (!is_listed(row)) samplers[sampler_count++] = plain;
    }
}

static float u1[BENCH_N], u2[BENCH_N], out_x[BENCH_N], out_y[BENCH_N], out_z[BENCH_N], out_pdf[BENCH_N],
    out_weight[BENCH_N];
static double ns[SAMPLERS_MAX][FORMS][ROUNDS_MAX];
static errors error_of[SAMPLERS_MAX][FORMS];
static int rounds, have[FORMS];

/* Runs a form over n points (a multiple of 16); 0 where it does not exist. */
static int run_form(const sampler *s, int form, const float *p, size_t n, const float *a, const float *b) {
    const mcst_row *const row = mcst_find(s->row);
    const size_t k = (size_t)(row - mcst_rows);
    float *out[BENCH_OUT] = {out_x, out_y, out_z, out_pdf, NULL};
    if (!have[form] || (form == TEXT && !s->text)) return 0;
    switch (form) {
    case TEXT: s->text(p, n, a, b, out); break;
    case SCALAR: bench1_forms[k](p, n, a, b, out); break;
    case W4: bench4_forms[k](p, n, a, b, out); break;
    case W8: bench8_forms[k](p, n, a, b, out); break;
    case W16: bench16_forms[k](p, n, a, b, out); break;
    case WEIGHT:
        if (row->shape != MCST_IS_BRDF) return 0;
        out[4] = out_weight; /* fall through */
    default: row->sample_n(p, n, a, b, out);
    }
    return 1;
}

/* ---- error ---- */

enum {
    CORNERS = 10,
    COLUMNS = 12,
    ROWS = 13,
    POINTS = CORNERS * CORNERS + COLUMNS * ROWS
}; /* 256, a multiple of every width */

/* Every pair of corners of the unit square and of what lies near them, then a jittered grid; on a line corners, then a
 * jittered row. All are multiples of 2^-24, as a generator gives them. */
static void make_points(int lines, float *a, float *b) {
    static const float corner[CORNERS] = {0,    0x1p-24f,       0x1p-23f, 0x1p-12f,     0.25f,
                                          0.5f, 0x1.fffffcp-2f, 0.75f,    1 - 0x1p-12f, 1 - 0x1p-24f};
    uint64_t state = 1;
    int i, n = 0, rest;
    for (i = 0; i < CORNERS * (lines ? 1 : CORNERS); i++, n++) a[n] = corner[i % CORNERS], b[n] = corner[i / CORNERS];
    rest = POINTS - n;
    for (i = 0; i < rest; i++, n++) {
        mcst_uniform(&state, 1, &a[n], &b[n]);
        a[n] = floorf(0x1p24f * ((float)(lines ? i : i % COLUMNS) + a[n]) / (float)(lines ? rest : COLUMNS)) * 0x1p-24f;
        b[n] = floorf(0x1p24f * ((float)(i / COLUMNS % ROWS) + b[n]) / ROWS) * 0x1p-24f;
        a[n] = fminf(a[n], 1 - 0x1p-24f), b[n] = fminf(b[n], 1 - 0x1p-24f);
    }
}

typedef struct {
    double x[POINTS][3], pdf[POINTS], peak, scale;
} exact_points;

static void make_exact(const mcst_row *row, const float *p, void (*map)(const float *, ld, ld, ld *),
                       ld (*pdf_u)(const float *, ld, ld), const float *a, const float *b, exact_points *e) {
    int i, k;
    e->peak = 0;
    e->scale = mcst_line_scale(row, p);
    for (i = 0; i < POINTS; i++) {
        ld x[3] = {0, 0, 0};
        map(p, a[i], b[i], x);
        for (k = 0; k < 3; k++) e->x[i][k] = (double)x[k];
        e->pdf[i] = (double)pdf_u(p, a[i], b[i]);
        if (e->pdf[i] > e->peak && e->pdf[i] < 1e300) e->peak = e->pdf[i];
    }
}

static double ulp_of(double size) { /* of a float; not below the least subnormal */
    int e;
    frexp(fabs(size), &e);
    return ldexp(1, e < -125 ? -149 : e - 24);
}

static void keep_case(double *max, float *at, double err, const float *p, float a, float b) {
    *max = err;
    memcpy(at, p, MCST_P * sizeof *p);
    at[MCST_P] = a, at[MCST_P + 1] = b;
}

/* Adds the points in out_* to the sums of e; returns the largest error of the place. */
static double add_errors(const mcst_row *row, const exact_points *t, const float *p, const float *a, const float *b,
                         errors *e) {
    double worst = 0;
    int i, k;
    for (i = 0; i < POINTS; i++) {
        const double x[3] = {(double)out_x[i], (double)out_y[i], (double)out_z[i]}, pdf = (double)out_pdf[i];
        const double want = fmin(t->pdf[i], (double)FLT_MAX);
        double size = t->scale, off = 0, err;
        int finite = isfinite(pdf);
        for (k = 0; k < row->dim; k++) {
            finite &= isfinite(x[k]) != 0;
            off = fmax(off, fabs(x[k] - t->x[i][k]));
            size = fmax(size, fabs(t->x[i][k]));
        }
        e->points++;
        if (!finite) {
            e->bad++;
            continue;
        }
        err = off / (row->dim == 3 ? 0x1p-24 : ulp_of(size));
        e->rms += err * err;
        worst = fmax(worst, err);
        if (err > e->max) keep_case(&e->max, e->at, err, p, a[i], b[i]);
        if (row->shape == MCST_IS_BRDF && fabs(t->x[i][2]) <= 40 * 0x1p-24) continue;
        if (want > 0) { /* where the float exponent ends only smallness is asked for */
            const double most = fabs(pdf - want) - 0x1p-126 * t->peak - 0x1p-149;
            err = fmax(0, most) / want / (1e-6 * (1 + fabs(log(t->pdf[i] / t->peak))));
        } else {
            err = pdf > 0 ? 1e6
                          : 0; /* a lost sample has no relative error: found where there is nothing counts as 100 % */
        }
        e->pdf_points++;
        e->pdf_rms += err * err;
        if (err > e->pdf_max) keep_case(&e->pdf_max, e->pdf_at, err, p, a[i], b[i]);
    }
    return worst;
}

static void measure_errors(const sampler *s, errors *e) {
    static exact_points truth, text_truth;
    float a[POINTS], b[POINTS], p[MCST_P];
    const mcst_row *const row = mcst_find(s->row);
    const size_t sets = mcst_grid_count(row);
    size_t i;
    int f;
    make_points(row->inputs == 1, a, b);
    for (i = 0; i < sets; i++) {
        double text_worst = 0;
        mcst_grid_get(row, i, p);
        if ((s->subset == ISO && p[0] != p[1]) || (s->subset == ANISO && p[0] == p[1])) continue;
        make_exact(row, p, row->truth.map, row->truth.pdf_u, a, b, &truth);
        if (s->text_map) make_exact(row, p, s->text_map, s->text_pdf_u, a, b, &text_truth);
        for (f = 0; f < FORMS; f++) {
            double worst;
            if (!run_form(s, f, p, POINTS, a, b)) continue;
            worst = add_errors(row, f == TEXT && s->text_map ? &text_truth : &truth, p, a, b, &e[f]);
            if (f == TEXT) text_worst = worst;
            else e[f].worse += worst > text_worst;
        }
    }
    for (f = 0; f < FORMS; f++) {
        if (e[f].points > e[f].bad) e[f].rms = sqrt(e[f].rms / (double)(e[f].points - e[f].bad));
        if (e[f].pdf_points) e[f].pdf_rms = sqrt(e[f].pdf_rms / (double)e[f].pdf_points);
    }
}

/* ---- time ---- */

static void timed_set(const sampler *s, float p[MCST_P]) { mcst_fill(mcst_find(s->row), s->a, s->b, 0.7f, 0.7f, p); }

static double seconds_of(const sampler *s, int form, const float *p, int passes) {
    const double began = bench_seconds();
    double took;
    int i;
    for (i = 0; i < passes; i++) run_form(s, form, p, BENCH_N, u1, u2);
    took = bench_seconds() - began;
    bench_consume(BENCH_N, out_x);
    bench_consume(BENCH_N, out_y);
    bench_consume(BENCH_N, out_z);
    bench_consume(BENCH_N, out_pdf);
    if (form == WEIGHT) bench_consume(BENCH_N, out_weight);
    return took;
}

static void measure_times(double slice) {
    static int passes[SAMPLERS_MAX][FORMS];
    float p[MCST_P];
    int k, f, r;
    for (r = -1; r < rounds; r++) { /* round -1 warms up and finds out how many passes take a slice of time */
        bench_progress("throughput: round %d of %d", r + 1, rounds);
        for (k = 0; k < sampler_count; k++) {
            timed_set(&samplers[k], p);
            for (f = 0; f < FORMS; f++) {
                if (r < 0) {
                    double one;
                    if (!run_form(&samplers[k], f, p, BENCH_N, u1, u2)) continue;
                    one = seconds_of(&samplers[k], f, p, 2) / 2;
                    passes[k][f] = 1 + (int)(slice / one);
                } else if (passes[k][f]) {
                    ns[k][f][r] = seconds_of(&samplers[k], f, p, passes[k][f]) * 1e9 / ((double)BENCH_N * passes[k][f]);
                }
            }
        }
    }
}

/* Median over the rounds of how many times faster `form` is than `base`; the two were neighbours in time in every
 * round. */
static double speedup(double (*of)[ROUNDS_MAX], int base, int form) {
    double ratio[ROUNDS_MAX];
    int r;
    if (!(of[form][0] > 0 && of[base][0] > 0)) return 0;
    for (r = 0; r < rounds; r++) ratio[r] = of[base][r] / of[form][r];
    return bench_spread_of(ratio, rounds).median;
}

static bench_spread spread_of(const double *v) {
    double copy[ROUNDS_MAX];
    memcpy(copy, v, sizeof copy);
    return bench_spread_of(copy, rounds);
}

/* ---- vector maths, random numbers, short and long calls: rows with forms of their own ---- */

typedef struct {
    const char *name, *form;
    double rounds_ns[ROUNDS_MAX], max, rms; /* ulp of the value; max < 0: does not apply */
} extra;
enum { EXTRA_MAX = 40 };
static extra extras[EXTRA_MAX];
static int extra_count;

static const char *const kernel_name[BENCH_KERNELS] = {"kernel sincos", "kernel log", "kernel log1p", "kernel exp",
                                                       "kernel expm1"};
static void libm_sincos(size_t n, const float *x, float *out, float *out2) {
    size_t i;
    for (i = 0; i < n; i++) out[i] = sinf(x[i]), out2[i] = cosf(x[i]);
}
#define LIBM(name)                                                               \
    static void libm_##name(size_t n, const float *x, float *out, float *out2) { \
        size_t i;                                                                \
        (void)out2;                                                              \
        for (i = 0; i < n; i++) out[i] = name##f(x[i]);                          \
    }
LIBM(log)
LIBM(log1p)
LIBM(exp)
LIBM(expm1)
static bench_kernel *const kernels_libm[BENCH_KERNELS] = {libm_sincos, libm_log, libm_log1p, libm_exp, libm_expm1};

static double sin_turns(double t) { /* sin(2 pi t), t in [0, 1], relatively accurate at its zeros */
    const double k = floor(4 * t + 0.5), r = 2 * 3.14159265358979323846 * (t - 0.25 * k);
    return k == 1 ? cos(r) : k == 2 ? -sin(r) : k == 3 ? -cos(r) : sin(r);
}
static double cos_turns(double t) { return t < 0.75 ? sin_turns(t + 0.25) : sin_turns(t - 0.75); }

/* The i-th of n floats whose bit patterns cover [lo, hi] evenly, both of one sign. */
static float float_between(float lo, float hi, uint32_t i, uint32_t n) {
    uint32_t a, b;
    float x;
    memcpy(&a, &lo, 4);
    memcpy(&b, &hi, 4);
    a = a < b ? a + (uint32_t)((uint64_t)(b - a) * i / (n - 1)) : a - (uint32_t)((uint64_t)(a - b) * i / (n - 1));
    memcpy(&x, &a, 4);
    return x;
}

/* Largest and rms error over the range that samplers use: log over all normal floats, log1p from -1 to 1e38, exp and
 * expm1 of what is negative, the former down to 2^-100, below which it may be 0, sincos over a turn. Double libm counts as
 * exact. */
static void kernel_error(int k, bench_kernel *f, int turns, extra *e) {
    static const float lo[BENCH_KERNELS] = {0x1p-30f, FLT_MIN, -0x1p-60f, -0x1p-40f, -0x1p-60f};
    static const float hi[BENCH_KERNELS] = {1, 1e38f, -0.99999994f, -69, -80};
    const uint32_t n = bench.quick ? 1u << 17 : 1u << 21;
    double sum = 0, values = 0;
    uint32_t i, j;
    e->max = 0;
    for (i = 0; i < n; i += BENCH_N) {
        for (j = 0; j < BENCH_N; j++) {
            out_z[j] =
                k == 2 && (i + j) % 2 ? float_between(FLT_MIN, 1e38f, i + j, n) : float_between(lo[k], hi[k], i + j, n);
            if (k == 0 && !turns) out_z[j] = (float)(6.283185307179586 * (double)out_z[j]);
        }
        f(BENCH_N, out_z, out_x, out_y);
        for (j = 0; j < BENCH_N; j++) {
            const double x = (double)out_z[j];
            const double want[2] = {k == 0   ? turns ? sin_turns(x) : sin(x)
                                      : k == 1 ? log(x)
                                    : k == 2 ? log1p(x)
                                    : k == 3 ? exp(x)
                                             : expm1(x),
                                    turns ? cos_turns(x) : cos(x)};
            const double got[2] = {(double)out_x[j], (double)out_y[j]};
            int c;
            for (c = 0; c < (k == 0 ? 2 : 1); c++) {
                const double err = got[c] == want[c] ? 0 : fabs(got[c] - want[c]) / ulp_of(want[c]);
                e->max = fmax(e->max, err);
                sum += err * err, values++;
            }
        }
    }
    e->rms = sqrt(sum / values);
}

static void fill_kernel_input(int k,
                              int turns) { /* uniform random numbers turned into what samplers hand to the kernel */
    size_t i;
    for (i = 0; i < BENCH_N; i++)
        out_z[i] = k == 0   ? (turns ? u1[i] : 6.2831853f * u1[i])
                   : k == 1 ? u1[i] + 0x1p-25f
                   : k == 2 ? -u1[i]
                            : -10 * u1[i];
}

static void random_text(void) {
    text_pcg32 r = {1, 3};
    size_t i;
    for (i = 0; i < BENCH_N; i++) out_x[i] = text_pcg32_float(&r);
}
static void random_pcg_scalar(void) {
    mcs_pcg32 r = mcs_pcg32_make(1, 1);
    size_t i;
    for (i = 0; i < BENCH_N; i++) out_x[i] = mcs_pcg32_float(&r);
}
static void random_pcg_n(void) {
    mcs_pcg32 r = mcs_pcg32_make(1, 1);
    mcs_pcg32_fill_n(&r, BENCH_N, out_x);
}
static void random_philox_scalar(void) {
    size_t i, k;
    for (i = 0; i < BENCH_N / 4; i++) {
        const mcs_philox4 block = mcs_philox(1, i, 0);
        for (k = 0; k < 4; k++) out_x[4 * i + k] = mcs_u01(block.v[k]);
    }
}
static void random_philox_n(void) { mcs_philox_fill_n(1, 0, BENCH_N, out_x); }
static void random_sobol_scalar(void) {
    uint32_t i;
    for (i = 0; i < BENCH_N; i++) out_x[i] = mcs_sobol(i, 1, 1);
}
static void random_sobol_n(void) { mcs_sobol_n(0, 1, 1, BENCH_N, out_x); }

/* Array functions called for few points at a time, BENCH_N in all. */
#define SHORT_CALLS(count)                                                                                         \
    static void cosine_by_##count(void) {                                                                          \
        for (size_t i = 0; i < BENCH_N; i += count)                                                                \
            mcs_cosine_sample_n(count, u1 + i, u2 + i, out_x + i, out_y + i, out_z + i, out_pdf + i);              \
    }                                                                                                              \
    static void bounded_by_##count(void) {                                                                         \
        for (size_t i = 0; i < BENCH_N; i += count)                                                                \
            mcs_ggx_bounded_sample_n(&short_ggx, short_wo, count, u1 + i, u2 + i, out_x + i, out_y + i, out_z + i, \
                                     out_pdf + i, out_weight + i);                                                 \
    }
static mcs_vec3 short_wo; /* not constants, so that no call is computed beforehand */
static mcs_ggx short_ggx;
SHORT_CALLS(1)
SHORT_CALLS(4)
SHORT_CALLS(8)
static void cosine_scalar(void) {
    for (size_t i = 0; i < BENCH_N; i++) {
        const mcs_dir s = mcs_cosine_sample(u1[i], u2[i]);
        out_x[i] = s.w.x;
        out_y[i] = s.w.y;
        out_z[i] = s.w.z;
        out_pdf[i] = s.pdf;
    }
}
static void bounded_scalar(void) {
    for (size_t i = 0; i < BENCH_N; i++) {
        const mcs_brdf s = mcs_ggx_bounded_sample(&short_ggx, short_wo, u1[i], u2[i]);
        out_x[i] = s.wi.x;
        out_y[i] = s.wi.y;
        out_z[i] = s.wi.z;
        out_pdf[i] = s.pdf;
        out_weight[i] = s.weight;
    }
}

/* Arrays of LONG points, which no cache holds: two of random numbers, four of results. */
enum { LONG = 1 << 22, LONG_ARRAYS = 6 };
static float *long_arrays; /* NULL without memory */
static float *long_array(int k) { return long_arrays + (size_t)k * LONG; }
static void long_cosine(void) {
    mcs_cosine_sample_n(LONG, long_array(0), long_array(1), long_array(2), long_array(3), long_array(4), long_array(5));
}
static void long_memset(void) { memset(long_array(2), 0, (LONG_ARRAYS - 2) * LONG * sizeof *long_arrays); }
static void prepare_calls(void) {
    mcs_pcg32 r = mcs_pcg32_make(1, 2);
    short_ggx = mcs_ggx_make(0.1f, 0.4f);
    short_wo = mcs_cone_sample(0.5f, 0.5f, 0.1f).w;
    long_arrays = aligned_alloc(64, LONG_ARRAYS * LONG * sizeof *long_arrays); /* whole lines, which are streamed */
    if (long_arrays) mcs_pcg32_fill_n(&r, LONG_ARRAYS * LONG, long_arrays);
    else puts("SKIPPED: long arrays: not enough memory");
}

static const struct {
    const char *name, *form;
    void (*fill)(void);
    size_t points;
} others[] = {{"pcg32", "text", random_text, BENCH_N},
              {"pcg32", "scalar", random_pcg_scalar, BENCH_N},
              {"pcg32", "n", random_pcg_n, BENCH_N},
              {"philox", "scalar", random_philox_scalar, BENCH_N},
              {"philox", "n", random_philox_n, BENCH_N},
              {"sobol", "scalar", random_sobol_scalar, BENCH_N},
              {"sobol", "n", random_sobol_n, BENCH_N},
              {"cosine calls", "scalar", cosine_scalar, BENCH_N},
              {"cosine calls", "n = 1", cosine_by_1, BENCH_N},
              {"cosine calls", "n = 4", cosine_by_4, BENCH_N},
              {"cosine calls", "n = 8", cosine_by_8, BENCH_N},
              {"bounded calls", "scalar", bounded_scalar, BENCH_N},
              {"bounded calls", "n = 1", bounded_by_1, BENCH_N},
              {"bounded calls", "n = 4", bounded_by_4, BENCH_N},
              {"bounded calls", "n = 8", bounded_by_8, BENCH_N},
              {"cosine 2^22", "memset", long_memset, LONG},
              {"cosine 2^22", "n", long_cosine, LONG}};
enum { OTHERS = sizeof others / sizeof others[0] };

static void measure_extras(double slice) {
    struct {
        bench_kernel *kernel;
        void (*fill)(void);
        int which, turns, passes;
        size_t points;
    } run[EXTRA_MAX];
    int k, r, i;
    for (k = 0; k < BENCH_KERNELS; k++) {
        bench_kernel *const forms[3] = {kernels_libm[k], have[W8] ? bench_kernels_mcs[k] : NULL,
                                        have[W8] ? bench_kernels_sleef[k] : NULL};
        static const char *const names[3] = {"text", "w8", "sleef"};
        for (i = 0; i < 3; i++) {
            if (!forms[i]) continue;
            run[extra_count].kernel = forms[i], run[extra_count].which = k, run[extra_count].turns = i == 1;
            run[extra_count].points = BENCH_N;
            extras[extra_count].name = kernel_name[k], extras[extra_count].form = names[i];
            kernel_error(k, forms[i], i == 1, &extras[extra_count++]);
        }
    }
    prepare_calls();
    for (k = 0; k < OTHERS; k++) {
        if (others[k].points == LONG && !long_arrays) continue;
        run[extra_count].kernel = NULL, run[extra_count].fill = others[k].fill;
        run[extra_count].points = others[k].points;
        extras[extra_count].name = others[k].name, extras[extra_count].form = others[k].form;
        extras[extra_count++].max = -1;
    }
    for (r = -1; r < rounds; r++) {
        bench_progress("vector maths, random numbers, calls: round %d of %d", r + 1, rounds);
        for (k = 0; k < extra_count; k++) {
            const int passes = r < 0 ? 2 : run[k].passes;
            double began;
            if (run[k].kernel) fill_kernel_input(run[k].which, run[k].turns);
            if (r < 0 && run[k].kernel) run[k].kernel(BENCH_N, out_z, out_x, out_y);
            began = bench_seconds();
            for (i = 0; i < passes; i++) {
                if (run[k].kernel) run[k].kernel(BENCH_N, out_z, out_x, out_y);
                else run[k].fill();
            }
            began = (bench_seconds() - began) / passes;
            bench_consume(BENCH_N, out_x);
            bench_consume(BENCH_N, out_y);
            if (r < 0) run[k].passes = 1 + (int)(slice / began);
            else extras[k].rounds_ns[r] = began * 1e9 / (double)run[k].points;
        }
    }
}

static const extra *find_extra(const char *name, const char *form) {
    int i;
    for (i = 0; i < extra_count; i++)
        if (!strcmp(extras[i].name, name) && !strcmp(extras[i].form, form)) return &extras[i];
    return NULL;
}
static double extra_speedup(const char *name, const char *base, const char *form) { /* 0: one of them is missing */
    const extra *const a = find_extra(name, base), *const b = find_extra(name, form);
    double ratio[ROUNDS_MAX];
    int r;
    if (!a || !b) return 0;
    for (r = 0; r < rounds; r++) ratio[r] = a->rounds_ns[r] / b->rounds_ns[r];
    return bench_spread_of(ratio, rounds).median;
}

/* ---- output ---- */

static void write_case(FILE *f, const float *at, char end) {
    fprintf(f, "%g %g %g %.9g %.9g%c", (double)at[0], (double)at[1], (double)at[5], (double)at[6], (double)at[7], end);
}

static void write_csv(void) {
    FILE *f = bench_csv(
        "throughput.csv",
        "sampler,form,ns_median,ns_min,ns_max,times_faster_than_text,error_unit,error_max,error_rms,pdf_error_max,pdf_"
        "error_rms,"
        "not_finite,points,sets_worse_than_text,timed_a,timed_b,error_at_a_b_cos_u1_u2,pdf_error_at_a_b_cos_u1_u2");
    int k, i;
    for (k = 0; k < sampler_count; k++) {
        const mcst_row *const row = mcst_find(samplers[k].row);
        for (i = 0; i < FORMS; i++) {
            const errors *const e = &error_of[k][i];
            bench_spread t;
            if (!(ns[k][i][0] > 0)) continue;
            t = spread_of(ns[k][i]);
            fprintf(f, "%s,%s,%.4g,%.4g,%.4g,%.4g,%s,%.4g,%.4g,%.4g,%.4g,%ld,%ld,%d,%g,%g,", samplers[k].name,
                    form_name[i], t.median, t.min, t.max, speedup(ns[k], TEXT, i), row->dim == 3 ? "2^-24" : "ulp",
                    e->max, e->rms, e->pdf_max, e->pdf_rms, e->bad, e->points, e->worse, (double)samplers[k].a,
                    (double)samplers[k].b);
            write_case(f, e->at, ',');
            write_case(f, e->pdf_at, '\n');
        }
    }
    for (k = 0; k < extra_count; k++) {
        const extra *const e = &extras[k];
        const bench_spread t = spread_of(e->rounds_ns);
        fprintf(f, "%s,%s,%.4g,%.4g,%.4g,", e->name, e->form, t.median, t.min, t.max);
        if (find_extra(e->name, "text")) fprintf(f, "%.4g", extra_speedup(e->name, "text", e->form));
        if (e->max >= 0) fprintf(f, ",ulp,%.4g,%.4g,,,,,,,,,\n", e->max, e->rms);
        else fprintf(f, ",,,,,,,,,,,,\n");
    }
    bench_close(f, "throughput.csv");
}

/* Eight samplers of all kinds, by the names of their rows. The table and the CSV file have all. */
static const char *const shown[] = {"disk",     "normal",  "cosine",      "phong",
                                    "ward iso", "ggx iso", "ggx_bounded", "ashikhmin iso"};
enum { SHOWN = sizeof shown / sizeof *shown };

static int is_shown(const char *name) {
    int i;
    for (i = 0; i < SHOWN; i++)
        if (strcmp(shown[i], name) == 0) return 1;
    return 0;
}

/* A line per sampler, from its textbook form to its array form. Errors below `least` and above `most` stand there. */
static void write_svg(const char *file, int pdf, const char *ylabel, double least, double most) {
    static const int form[2] = {TEXT, ARRAY};
    double x[2][SHOWN], y[2][SHOWN], error[SHOWN], lo = 1, hi = 0;
    const char *name[SHOWN];
    char label[64];
    int n = 0, k, i;
    svg_plot plot;
    for (k = 0; k < sampler_count && n < SHOWN; k++) {
        if (!is_shown(samplers[k].name)) continue;
        for (i = 0; i < 2; i++) {
            const errors *const e = &error_of[k][form[i]];
            x[i][n] = spread_of(ns[k][form[i]]).median;
            y[i][n] = fmin(most, fmax(least, pdf ? e->pdf_max : e->max));
        }
        error[n] = pdf ? error_of[k][TEXT].pdf_max : error_of[k][TEXT].max;
        name[n++] = samplers[k].name;
    }
    for (i = 0; i < 2; i++) svg_range(n, x[i], 1, &lo, &hi);
    svg_begin(&plot, bench_path(file),
              pdf ? "From textbook formulas to mcsample.h: time and error of a density"
                  : "From textbook formulas to mcsample.h: time and error of a sample",
              "time per sample with its density, ns", ylabel, 1, 1, lo / 2, hi * 2.5, least / 3, most * 3);
    for (k = 0; k < n; k++) {
        const double from[2] = {x[0][k], y[0][k]};
        const double to[2] = {x[1][k], y[1][k]};
        svg_link(&plot, from, to);
    }
    for (i = 0; i < 2; i++) svg_keep_off(&plot, n, x[i], y[i]);
    svg_series(&plot, "mcsample.h, arrays", n, x[1], y[1], SVG_POINTS);
    svg_series(&plot, "textbook, libm", n, x[0], y[0], SVG_POINTS);
    for (k = 0; k < n; k++) {
        snprintf(label, sizeof label, error[k] > most ? "%s: %.0e" : "%s", name[k], error[k]);
        svg_label(&plot, x[0][k], y[0][k], label);
    }
    svg_better(&plot);
    svg_note(&plot, "a line: one sampler");
    svg_note(&plot, "largest error over all parameters");
    svg_note(&plot, "a number: error beyond the top");
    if (svg_end(&plot)) {
        fprintf(stderr, "cannot write %s\n", bench_path(file));
        exit(2);
    }
}

static void print_ns(double v) {
    if (v > 0) printf(" %7.*f", v < 9.995 ? 2 : 1, v);
    else printf(" %7s", "-");
}

static void print_tables(void) {
    int k, f;
    printf("\n%-18s ns per sample, sample with pdf (median of %d)%*s text against   largest error, ulp   density, "
           "1e-6(1+|ln|)\n",
           "", rounds, 16, "");
    printf("%-18s", "sampler");
    for (f = 0; f < FORMS; f++) printf(" %7s", f == WEIGHT ? "n+wgt" : form_name[f]);
    printf(" %7s %6s %10s %9s %10s %9s\n", "scalar", "n", "text", "n", "text", "n");
    for (k = 0; k < sampler_count; k++) {
        const errors *const t = &error_of[k][TEXT], *const n = &error_of[k][ARRAY];
        printf("%-18s", samplers[k].name);
        for (f = 0; f < FORMS; f++) print_ns(ns[k][f][0] > 0 ? spread_of(ns[k][f]).median : 0);
        printf(" %6.1fx %5.1fx %10.3g %9.3g %10.3g %9.3g", speedup(ns[k], TEXT, SCALAR), speedup(ns[k], TEXT, ARRAY),
               t->max, n->max, t->pdf_max, n->pdf_max);
        if (t->bad) printf("  text: %ld of %ld not finite", t->bad, t->points);
        putchar('\n');
    }
    printf("\n%-18s %-8s %9s %9s %9s %9s %9s\n", "", "form", "ns", "min", "max", "max ulp", "rms ulp");
    for (k = 0; k < extra_count; k++) {
        const bench_spread s = spread_of(extras[k].rounds_ns);
        printf("%-18s %-8s %9.3f %9.3f %9.3f", extras[k].name, extras[k].form, s.median, s.min, s.max);
        if (extras[k].max >= 0) printf(" %9.3f %9.3f", extras[k].max, extras[k].rms);
        putchar('\n');
    }
    if (!have[W8]) puts("SKIPPED: w8, vector-maths kernels: the processor lacks AVX2 and FMA");
    if (!have[W16]) puts("SKIPPED: w16: the processor lacks AVX-512");
    if (!bench_kernels_sleef[0]) puts("SKIPPED: libsleef-dev not installed");
}

#include "hits.h"

static int unmet;
static void verdict(const char *what, const char *of, double measured, const char *relation, double wanted, int met) {
    printf("%-8s %-30s %-18s %9.3g %s %g\n", met ? "met" : "NOT MET", what, of, measured, relation, wanted);
    unmet += !met;
}

/* Where one call takes longer than the formula: apart, where the formula is as good as ours but for some ulp, and where
 * it buys its time by results that are not finite or off by more. */
static void print_slower(int as_good) {
    int some = 0;
    printf("slower, one by one, than a formula that is %s:", as_good ? "as exact" : "not (see its errors)");
    for (int k = 0; k < sampler_count; k++) {
        const errors *const t = &error_of[k][TEXT];
        const int good = !t->bad && t->max <= 16 && t->pdf_max <= 100;
        const double times = samplers[k].text ? speedup(ns[k], TEXT, SCALAR) : 1;
        if (times >= 1 || good != as_good) continue;
        printf("%s %s %.2fx", some ? "," : "", samplers[k].name, times);
        some = 1;
    }
    puts(some ? "" : " none");
}

/* What the project asks for: figures of merit that are reported, not gates, as a shared machine has no business failing
 * a build. */
static void print_targets(void) {
    double against;
    int k, f;
    puts("\ntargets");
    for (k = 0; k < sampler_count; k++)
        if (samplers[k].target > 0)
            verdict("n, times as fast as text", samplers[k].name, speedup(ns[k], TEXT, ARRAY), ">=", samplers[k].target,
                    speedup(ns[k], TEXT, ARRAY) >= samplers[k].target);
    for (k = 0; k < sampler_count; k++) {
        const errors *const e = &error_of[k][ARRAY];
        if (!(e->max <= 4)) verdict("n, largest error, ulp", samplers[k].name, e->max, "<=", 4, 0);
        if (!(e->pdf_max <= 1)) verdict("n, error of the density", samplers[k].name, e->pdf_max, "<=", 1, 0);
        if (e->bad) verdict("n, results not finite", samplers[k].name, (double)e->bad, "<=", 0, 0);
    }
    for (f = 0; f < BENCH_KERNELS; f++) {
        const extra *const e = find_extra(kernel_name[f], "w8");
        if (e) verdict("kernel, largest error, ulp", kernel_name[f], e->max, "<=", 1.5, e->max <= 1.5);
        against = extra_speedup(kernel_name[f], "sleef", "w8");
        if (against > 0) verdict("8 wide, as fast as SLEEF u10", kernel_name[f], against, ">=", 1, against >= 1);
    }
    against = fmax(extra_speedup("pcg32", "scalar", "n"), extra_speedup("philox", "scalar", "n"));
    verdict("fill, times as fast as scalar", "pcg32 or philox", against, ">=", 3, against >= 3);
    print_slower(1);
    print_slower(0);
    printf("%d not met\n", unmet);
}

/* Arrays that a compiled kernel of Mitsuba beats, or that miss what was asked, and what bounds them: instructions on
 * vectors of 512 bits that gcc 12 makes for 16 points, with those before and behind the loop. Two a cycle is what Zen 4
 * issues. */
static void print_bounds(void) {
    static const struct {
        const char *row;
        double asked;
        int instructions;
    } bound[] = {{"henyey_greenstein", 1.0, 150}, {"von_mises_fisher", 2.2, 273}};
    puts("\nbounds");
    for (int b = 0; b < (int)(sizeof bound / sizeof *bound); b++)
        for (int k = 0; k < sampler_count; k++)
            if (!strcmp(samplers[k].row, bound[b].row))
                printf("%-20s n %6.2f ns, asked %.1f: %d vector instructions for 16 points, at two a cycle %.1f cycles "
                       "a point\n",
                       bound[b].row, spread_of(ns[k][ARRAY]).median, bound[b].asked, bound[b].instructions,
                       bound[b].instructions / 32.0);
    for (int k = 0; k < HITS_ROWS; k++)
        if (!strcmp(hits_of[k].row, "beckmann"))
            printf(
                "%-20s hits %6.2f ns, asked 4.5: 434 vector instructions for 16 points, at two a cycle 13.6 cycles a "
                "point\n",
                "beckmann", spread_of(hits_ns[k][HITS_N]).median);
}

int main(int argc, char **argv) {
    mcs_pcg32 rng = mcs_pcg32_make(1, 1);
    double slice;
    int k;
    bench_start(argc, argv, "throughput");
    rounds = bench.quick ? 9 : 31;
    slice = bench.quick ? 3e-4 : 2e-3;
    have[TEXT] = have[SCALAR] = have[W4] = have[ARRAY] = have[WEIGHT] = 1;
#if defined(__GNUC__) && (defined(__x86_64__) || defined(__i386__))
    have[W8] = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    have[W16] =
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
#endif
    mcs_pcg32_fill_n(&rng, BENCH_N, u1);
    mcs_pcg32_fill_n(&rng, BENCH_N, u2);
    list_samplers();
    for (k = 0; k < sampler_count; k++) {
        bench_progress("throughput: errors of %s, %d of %d", samplers[k].name, k + 1, sampler_count);
        measure_errors(&samplers[k], error_of[k]);
    }
    measure_times(slice);
    measure_extras(slice);
    measure_hits(slice);
    bench_progress("%s", "");
    write_csv();
    write_svg("throughput.svg", 0, "largest error of the sample, ulp", 0.3, 1e4);
    write_svg("throughput_pdf.svg", 1, "largest error of the pdf, 1e-6 (1 + |ln(pdf/peak)|)", 0.01, 1e6);
    print_tables();
    report_hits();
    print_targets();
    print_bounds();
    printf("wrote %s/throughput.csv, hits.csv, throughput.svg, throughput_pdf.svg\n", bench.out);
    return 0;
}
