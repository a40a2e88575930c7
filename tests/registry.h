/* The registry: one row per continuous sampler of mcsample.h, and everything the generic checks need to know about it.
 *
 * Define MCST_WIDE before including to get the 4, 8 and 16 wide forms too (they cost compile time); a compiler without
 * vectors and -DMCST_ARRAYS leave them out, -DMCST_EIGHT those of 4 and 16. With -DMCST_LINKED the functions of the
 * rows are only declared: make compiles them once, in tests/shared (-DMCST_SHARED), for all programs. Without it a
 * program holds them itself, so that it can be compiled alone. The other samplers (tables, alias, discrete,
 * environment, product) have tests of their own: see mcst_exempt. */
#ifndef MCST_REGISTRY_H
#define MCST_REGISTRY_H
#include <float.h>
#include <math.h>
#include <string.h>
#ifdef MCST_WIDE
#define MCS_PACKETS 16
#endif
#include "mcsample.h"
#include "mcs_test.h"
#include "oracle.h"
#include "stats.h"

/* M(X, shape, row, function prefix, parameter count or material, prefix of eval, reference coordinates, parameter grid,
 * claims, the parameters that make the width as bits, traits). Everything that tests know about a sampler beside its
 * truth in oracle.h is said here. MCST_ROWS hands the first seven to X. Some rows alone are built much faster: define
 * MCST_LIST as MCST_LINES, or as one row (tests/mutants.sh). */
#define MCST_LINES(M, X)                                                          \
    M(X, LINE, linear, linear, 2, -, UNIT, linear, line, 1, 0)                    \
    M(X, LINE, tent, tent, 1, -, TENT, radius, line, 0, 0)                        \
    M(X, LINE, exponential, exponential, 1, -, HALFLINE, rate, line, 1, 0)        \
    M(X, LINE, truncexp, truncexp, 2, -, TRUNCATED, truncexp, line, 1, 0)         \
    M(X, LINE, normal, normal, 2, -, WHOLELINE, normal, normal, 2, MCST_QUANTILE) \
    M(X, LINE, logistic, logistic, 2, -, WHOLELINE, normal, line, 2, 0)           \
    M(X, LINE, truncnormal, truncnormal, 2, -, CUT, cut, line, 3, 0)              \
    M(X, LINE, trunclogistic, trunclogistic, 2, -, CUT, cut, line, 3, 0)          \
    M(X, LINE, power, power, 1, -, POWER, power, line, 1, 0)                      \
    M(X, LINE, evenpower, evenpower, 1, -, EVENPOWER, power, line, 1, 0)          \
    M(X, LINE, smoothstep, smoothstep, 2, -, BETWEEN, ends, line, 2, 0)
#define MCST_LIGHTS(M, X)                                                                                      \
    M(X, LIGHT, ball, ball, ball, -, BY_TRUTH, ball, ball, 0, MCST_WHOLE | MCST_DISTANCE)                      \
    M(X, LIGHT, disk_light, disk_light, disk_light, -, BY_TRUTH, disk_light, disk_light, 0, MCST_LIT)          \
    M(X, POLYGON, spherical_rectangle, spherical_rectangle, rectangle, -, BY_TRUTH, light, light, 0, MCST_LIT) \
    M(X, POLYGON, spherical_triangle, spherical_triangle, triangle, -, BY_TRUTH, light, light, 0, MCST_LIT)
#define MCST_MEDIA(M, X)                                                                                 \
    M(X, DIR, henyey_greenstein, henyey_greenstein, 1, -, BY_TRUTH, asymmetry, asymmetry, 1, MCST_WHOLE) \
    M(X, DIR, rayleigh, rayleigh, 0, -, SPHERE, none, rayleigh, 0, MCST_WHOLE)                           \
    M(X, DIR, von_mises_fisher, von_mises_fisher, 1, -, BY_TRUTH, sharpness, sharpness, 1, MCST_WHOLE)
#ifndef MCST_LIST
#define MCST_LIST(M, X)                                                                          \
    MCST_LINES(M, X)                                                                             \
    M(X, PLANE, disk, disk, 1, -, DISK, radius, disk, 0, 0)                                      \
    M(X, PLANE, concentric, concentric, 1, -, DISK, radius, disk, 0, MCST_SQUARE)                \
    M(X, PLANE, triangle, triangle, 0, -, BY_TRUTH, none, triangle, 0, MCST_SQUARE)              \
    M(X, PLANE, bilinear, bilinear, corners, -, BY_TRUTH, corners, bilinear, 1, MCST_SQUARE)     \
    M(X, PLANE, bilinear_cross, bilinear, cross, -, BY_TRUTH, corners, bilinear, 1, MCST_SQUARE) \
    M(X, DIR, sphere, sphere, 0, -, SPHERE, none, direction, 0, MCST_WHOLE)                      \
    M(X, DIR, hemisphere, hemisphere, 0, -, HEMISPHERE, none, direction, 0, 0)                   \
    M(X, DIR, cosine, cosine, 0, -, HEMISPHERE, none, direction, 0, 0)                           \
    M(X, DIR, cone, cone, 1, -, CONE, cone, cone, 0, MCST_WHOLE)                                 \
    MCST_LIGHTS(M, X)                                                                            \
    MCST_MEDIA(M, X)                                                                             \
    M(X, LOBE, phong_lobe, phong_lobe, phong, -, COSPOWER, phong, phong_lobe, 1, 0)              \
    M(X, BRDF, phong, phong, phong, phong, COSPOWER, phong, phong, 1, MCST_ABOUT_R)              \
    M(X, LOBE, ward_h, ward_h, ward, -, SLOPES, alpha, gauss_h, 3, MCST_GAUSS)                   \
    M(X, BRDF, ward_gmd, ward, ward_gmd, ward, SLOPES, alpha, gauss, 3, MCST_GAUSS)              \
    M(X, BRDF, ward_duer, ward, ward_duer, ward, SLOPES, alpha, gauss, 3, MCST_GAUSS)            \
    M(X, BRDF, ward_1992, ward, ward_1992, ward, SLOPES, alpha, gauss, 3, MCST_GAUSS)            \
    M(X, LOBE, beckmann_h, beckmann_h, beckmann, -, SLOPES, alpha, gauss_h, 3, MCST_GAUSS)       \
    M(X, BRDF, beckmann, beckmann, beckmann, beckmann, SLOPES, alpha, gauss, 3, MCST_GAUSS)      \
    M(X, LOBE, ggx_h, ggx_h, ggx, -, SLOPES, alpha, ggx_h, 3, 0)                                 \
    M(X, BRDF, ggx, ggx, ggx, ggx, SLOPES, alpha, ggx, 3, 0)                                     \
    M(X, VLOBE, ggx_vndf_h, ggx_vndf_h, ggx, -, SLOPES, alpha, visible_h, 3, MCST_VISIBLE)       \
    M(X, BRDF, ggx_vndf, ggx_vndf, ggx, ggx, SLOPES, alpha, visible, 3, MCST_VISIBLE)            \
    M(X, VLOBE, ggx_bounded_h, ggx_bounded_h, ggx, -, SLOPES, alpha, visible_h, 3, MCST_VISIBLE) \
    M(X, BRDF, ggx_bounded, ggx_bounded, ggx, ggx, SLOPES, alpha, visible, 3, MCST_VISIBLE)      \
    M(X, LOBE, ashikhmin_h, ashikhmin_h, ashikhmin, -, COSPOWER, exponents, ashikhmin_h, 3, 0)   \
    M(X, BRDF, ashikhmin, ashikhmin, ashikhmin, ashikhmin, COSPOWER, exponents, ashikhmin, 3, 0)
#endif
#define MCST_SEVEN(X, shape, row, fn, arg, base, coord, grid, claims, vary, traits) \
    X(shape, row, fn, arg, base, coord, grid)
#define MCST_ROWS(X) MCST_LIST(MCST_SEVEN, X)

/* Samplers of mcsample.h that are not rows, because a table is not a handful of parameters, and a row has two random
 * numbers. */
static const char *const mcst_exempt[] = {"pwc",        "pwl",     "discrete",  "alias", "env",
                                          "env_window", "product", "ggx_glass", "pwc2"};

enum { MCST_P = 6 }; /* numbers in a parameter set: p[0..2] of the sampler, p[3..5] = wo */

enum mcst_measure { MCST_LENGTH, MCST_AREA, MCST_SOLID_ANGLE, MCST_SOLID_ANGLE_OF_H };
/* Coordinates of a BRDF are held to 16 roundings, of a lobe to 8, of others to CLAIM_WHERE: test_oracle.c. LIGHT is DIR
 * with a distance, POLYGON DIR of a light that is prepared. */
enum mcst_shape { MCST_IS_LINE, MCST_IS_PLANE, MCST_IS_DIR, MCST_IS_LOBE, MCST_IS_VLOBE, MCST_IS_BRDF };
/* The coordinates (s, t) in [0,1]^2 in which a lobe has a comparable mass everywhere: see bins.h. */
enum mcst_coord {
    MCST_UNIT,
    MCST_TENT,
    MCST_HALFLINE,
    MCST_TRUNCATED,
    MCST_WHOLELINE,
    MCST_POWER,
    MCST_EVENPOWER,
    MCST_BETWEEN, /* from the first parameter to the second */
    MCST_CUT,     /* the same of a bell, about the end nearer to 0 */
    MCST_DISK,
    MCST_SPHERE,
    MCST_HEMISPHERE,
    MCST_CONE,
    MCST_COSPOWER,
    MCST_SLOPES,
    MCST_BY_TRUTH /* the random numbers of the truth, for a row that has no coordinates of its own: slower */
};

/* In adapters.h: the forms of one width, and the array forms. */
typedef void mcst_sample_fn(const float *p, const float *u1, const float *u2, float *out);
typedef void mcst_value_fn(const float *p, const float *x, float *out);
typedef void mcst_sample_n_fn(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]);
typedef void mcst_value_n_fn(const float *p, size_t n, const float *x, const float *y, const float *z, float *out);
/* Of as many wo and parameters; in[0..1] are the random numbers, or in[0..2] the points. Of the latter out[0..1] are
 * density and value. */
typedef void mcst_hits_fn(const float *p, const mcs_hits *hits, size_t n, const float *const in[3],
                          float *const out[5]);
/* In truth.h: the truth for the same float inputs. */
typedef void mcst_map_fn(const float *p, ld u1, ld u2, ld *x);
typedef ld mcst_exact_fn(const float *p, const float *x);
typedef ld mcst_exact_u_fn(const float *p, ld u1, ld u2);
typedef void mcst_exact_invert_fn(const float *p, const float *x, ld *u);
/* In tests/shared/rough.c: the same truth computed in double, several times as fast, for bins and integrals. */
typedef void mcst_rough_map_fn(const float *p, double u1, double u2, double *x);
typedef double mcst_rough_u_fn(const float *p, double u1, double u2);
typedef void mcst_rough_invert_fn(const float *p, const float *x, double *u);

typedef struct {
    mcst_sample_fn *sample;
    mcst_value_fn *pdf, *invert, *eval, *weight;
} mcst_fns;

typedef struct {
    mcst_map_fn *map;
    mcst_exact_fn *pdf;
    mcst_exact_u_fn *pdf_u;
    mcst_exact_invert_fn *invert;
    mcst_exact_fn *eval, *weight;
} mcst_truth;

/* NULL without -DMCST_LINKED, and of BRDFs. */
typedef struct {
    mcst_rough_map_fn *map;
    mcst_rough_u_fn *pdf_u;
    mcst_rough_invert_fn *invert;
} mcst_rough;

/* Two parameters, the incidence (cosine, azimuth in radians) and the samples that the chi-square test draws, in
 * millions. */
typedef struct {
    float a, b, cos_o, azimuth;
    int millions;
} mcst_set;

/* What sets a row apart, as bits. */
enum {
    MCST_QUANTILE = 1,  /* the place is the quantile of the normal distribution, which has a few roundings more */
    MCST_SQUARE = 2,    /* no random number is an azimuth */
    MCST_ABOUT_R = 4,   /* a lobe about the mirrored direction, not of half-vectors */
    MCST_GAUSS = 8,     /* Gaussian half-vectors: the error of a density grows with their exponent */
    MCST_VISIBLE = 16,  /* visible normals */
    MCST_WHOLE = 32,    /* directions of the whole sphere: one below the horizon is as good */
    MCST_DISTANCE = 64, /* the distance of a light, where others have a weight */
    MCST_FREE = MCST_WHOLE | MCST_SQUARE,
    MCST_LIT = MCST_FREE | MCST_DISTANCE
};

/* The figures of accuracy that mcsample.h states, as numbers: test_oracle.c holds the header to them on its grids, and
 * looks up that the header states them (claims.h); stress/climb.c searches for inputs that break them.
 *
 * A density is judged in E = 1e-6 (1 + |ln(pdf/peak)|), of Gaussian half-vectors given h or wi in 1e-6 (1 + e), e their
 * exponent; weights in 1e-6; the length of a direction by its distance from 1 in 2^-24; a direction,
 * and a place on a light, by its worst coordinate, in 2^-24. Points of lines and planes are judged by the worst
 * coordinate, too, in 2^-24 of their scale, which mcst_where_scale tells. Of lights density and distance are judged in
 * 1e-6. */
#define MCST_FAINT 0x1p-100 /* of the peak: below it a density may be 0 */
enum {
    CLAIM_PDF_U,
    CLAIM_PDF_W,
    CLAIM_EVAL,
    CLAIM_SAMPLE_WEIGHT,
    CLAIM_WEIGHT,
    CLAIM_LENGTH,
    CLAIM_WHERE,
    CLAIM_DISTANCE,
    CLAIM_PLACE,
    CLAIMS
};

/* A range of parameters and what is promised there; 0: nothing. */
typedef struct {
    double least[2], most[2], claim[CLAIMS];
} mcst_claim;

/* What may be given as parameters. Bad is what the header documents as outside: 1, 0, or -1 where it leaves it open;
 * for what is bad of two see mcst_bad_together. Valid ones are drawn from least to most; 0: there is no
 * second one. */
typedef struct {
    int (*bad)(int i, float v);
    double least[2], most[2];
    int either_sign; /* the first one may be negative */
} mcst_domain;

typedef struct {
    const char *name, *function; /* the public sampler is mcs_<function>_sample */
    enum mcst_shape shape;
    enum mcst_measure measure;
    enum mcst_coord coord;
    int inputs, dim, params; /* random numbers, coordinates of a point, parameters before wo */
    int has_wo;
    const float (*grid)[2];
    size_t grid_size;
    const mcst_set *chi;
    size_t chi_size;
    mcst_fns fn[4]; /* widths 1, 4, 8, 16; the wide ones only under MCST_WIDE */
    mcst_sample_n_fn *sample_n;
    mcst_value_n_fn *pdf_n, *eval_n;
    mcst_hits_fn *sample_hits_n, *pdf_hits_n;
    mcst_truth truth;
    mcst_rough rough;
    const mcst_claim *claims; /* narrower ranges first */
    size_t claims_size;
    unsigned vary, traits;
    mcst_domain domain;
} mcst_row;

/* --- parameter grids, extremes included --------------------------------------------------------------------------- */

static const float mcst_grid_none[][2] = {{0, 0}};
static const float mcst_grid_linear[][2] = {{1, 3},    {1, 1},         {0, 1},           {1, 0},        {1e-6f, 1},
                                            {1e6f, 1}, {1, 1.000001f}, {1e-30f, 3e-30f}, {2e30f, 1e30f}};
static const float mcst_grid_radius[][2] = {{1, 0}, {0.3f, 0}, {1e-6f, 0}, {1e6f, 0}, {1e-18f, 0}, {1e18f, 0}};
static const float mcst_grid_rate[][2] = {{1, 0}, {0.3f, 0}, {50, 0}, {1e-6f, 0}, {1e6f, 0}, {1e-18f, 0}, {1e18f, 0}};
static const float mcst_grid_truncexp[][2] = {{3, 1},        {0, 1},      {1, 1},       {1e-6f, 1},
                                              {1e-3f, 1},    {20, 1},     {1000, 1},    {0.5f, 1e-3f},
                                              {1e-3f, 1e6f}, {1e-30f, 2}, {1e6f, 1e6f}, {1e-18f, 1e18f}};
static const float mcst_grid_normal[][2] = {{0, 1}, {-3, 100}, {5, 0.01f}, {0.3f, 1e-6f}, {0, 1e-18f}, {1e10f, 1e18f}};
static const float mcst_grid_power[][2] = {{2, 0},  {0, 0},   {1, 0},    {0.5f, 0}, {1e-3f, 0},
                                           {10, 0}, {100, 0}, {1e4f, 0}, {1e6f, 0}, {1e9f, 0}};
static const float mcst_grid_ends[][2] = {{0, 1},      {-1, 1},    {2, 5},      {-3, -2.5f},     {1000, 1001},
                                          {0, 1e-18f}, {0, 1e18f}, {-1e18f, 0}, {-1e-30f, 0.5f}, {-1e6f, 1e-6f}};
static const float mcst_grid_cut[][2] = {{-1, 1},
                                         {0, 1},
                                         {8, 9},
                                         {-9, -8},
                                         {30, 31},
                                         {-31, -30},
                                         {-3, 0.5f},
                                         {-40, -2},
                                         {-INFINITY, INFINITY},
                                         {-INFINITY, 1},
                                         {1e6f, INFINITY},
                                         {-FLT_MAX, -2e17f},
                                         {1, 1.0000001f},
                                         {-1e-20f, 1},
                                         {1e-9f, 2e-9f},
                                         {-1e-4f, 3e-4f},
                                         {3.16e-4f, 5e-4f},
                                         {0.5f, 0.50001f},
                                         {-20.000002f, -20},
                                         {-1e-18f, 1e-18f},
                                         {-5, 7}};
/* Two of four heights; the others stand in adapters.h. */
static const float mcst_grid_corners[][2] = {{2, 5}, {1, 3},     {1, 1},    {0, 0},         {0, 4},
                                             {4, 0}, {1e-6f, 1}, {1e6f, 3}, {1e30f, 2e30f}, {1e-30f, 3e-30f}};
static const float mcst_grid_cone[][2] = {{0.5f, 0}, {2, 0},     {1.9997f, 0}, {1.99f, 0}, {1.9f, 0},
                                          {1, 0},    {0.01f, 0}, {1e-5f, 0},   {1e-8f, 0}, {1e-20f, 0}};
/* Of a light aside: the distance is 1.1456 times the first number. */
static const float mcst_grid_ball[][2] = {
    {1, 0.5f},      {1, 1.1456f},       {1, 1.1457f},   {1, 1.1f},         {1, 1e-2f},   {1e3f, 0.1f}, {1e-3f, 1e-9f},
    {1e10f, 100},   {1e18f, 1e10f},     {0, 1},         {-0.5f, 1},        {1e-30f, 1},  {-3, 2},      {1e-18f, 1e-18f},
    {1e18f, 1e18f}, {1e-18f, 1.2e-18f}, {1e-4f, 1e18f}, {-1e-18f, 1e-18f}, {1, 1.14564f}};
static const float mcst_grid_disk_light[][2] = {{1, 0.5f},  {1, 1e-3f},       {-1, 1},        {0.1f, 1},
                                                {1e6f, 10}, {1e-17f, 1e-17f}, {1e18f, 3e17f}, {1e-3f, 1}};
static const float mcst_grid_asymmetry[][2] = {
    {0.5f, 0},    {0, 0},      {0.9f, 0},     {-0.3f, 0},       {-0.8f, 0},       {0.99f, 0},
    {-0.999f, 0}, {1e-3f, 0},  {-1e-30f, 0},  {0.1f, 0},        {1e-8f, 0},       {-0.03f, 0},
    {0.9999f, 0}, {-1e-6f, 0}, {-0.9999f, 0}, {0.99999994f, 0}, {-0.99999994f, 0}};
static const float mcst_grid_sharpness[][2] = {{1, 0},     {0, 0},     {1e-30f, 0}, {1e-9f, 0}, {1e-8f, 0}, {3e-8f, 0},
                                               {1e-6f, 0}, {1e-3f, 0}, {0.1f, 0},   {0.34f, 0}, {0.5f, 0},  {3, 0},
                                               {8, 0},     {16, 0},    {30, 0},     {40, 0},    {50, 0},    {100, 0},
                                               {1e4f, 0},  {1e6f, 0},  {1e8f, 0}};
/* Half the width of a light at the distance 1, and its height over its width. */
static const float mcst_grid_light[][2] = {{0.5f, 1},   {1e-6f, 1}, {1, 1e-5f},     {1e-6f, 0.1f}, {1e4f, 1},
                                           {30, 0.03f}, {3, 1},     {1e-3f, 1e-3f}, {1e3f, 10},    {1e-4f, 1e-5f}};
static const float mcst_grid_phong[][2] = {{10, 0},  {0, 0},    {1e-3f, 0}, {1e-2f, 0}, {0.5f, 0}, {1, 0},   {2, 0},
                                           {100, 0}, {1e3f, 0}, {1e4f, 0},  {1e5f, 0},  {1e6f, 0}, {1e9f, 0}};
static const float mcst_grid_alpha[][2] = {{0.5f, 0.2f},   {0.2f, 0.5f},   {1, 1},         {0.3f, 0.3f},
                                           {0.1f, 0.1f},   {0.01f, 0.01f}, {1e-3f, 1e-3f}, {1e-4f, 1e-4f},
                                           {1e-5f, 1e-5f}, {1e-6f, 1e-6f}, {0.01f, 1},     {1, 0.01f},
                                           {1e-6f, 1e-4f}, {3, 3},         {10, 10},       {10, 0.1f}};
static const float mcst_grid_exponents[][2] = {
    {10, 100},    {100, 10},      {0, 0},         {1, 1},       {3, 0.5f},     {100, 100},
    {1e3f, 1e3f}, {1e4f, 1e4f},   {1e6f, 1e6f},   {1e9f, 1e9f}, {0, 100},      {1e4f, 1},
    {1e9f, 1e5f}, {1e-3f, 1e-3f}, {1e-2f, 1e-2f}, {1e-3f, 100}, {1e4f, 1e-2f}, {1e-2f, 1e9f}};

/* --- what may be given -------------------------------------------------------------------------------------------- */

static inline int mcst_outside(float v, float least, float most) { return !(v >= least && v <= most); }
static inline int mcst_bad_none(int i, float v) {
    (void)i;
    (void)v;
    return 0;
}
static inline int mcst_bad_linear(int i, float v) {
    (void)i;
    return !(v >= 0 && v <= FLT_MAX);
}
static inline int mcst_bad_radius(int i, float v) { return i == 0 && mcst_outside(v, 1e-18f, 1e18f); }
/* Below 1e-18 nothing is met, at FLT_MAX and with density 0. */
static inline int mcst_bad_rate(int i, float v) {
    if (i != 0) return 0;
    return mcst_outside(v, 0, 1e18f) ? 1 : v >= 1e-18f ? 0 : -1;
}
static inline int mcst_bad_truncexp(int i, float v) {
    if (i == 1) return mcst_outside(v, 1e-18f, 1e18f);
    return !(v >= 0) ? 1 : v <= 1e18f ? 0 : -1;
}
static inline int mcst_bad_normal(int i, float v) {
    if (i == 1) return mcst_outside(v, 1e-18f, 1e18f);
    return !(fabsf(v) <= FLT_MAX) ? 1 : fabsf(v) <= 1e30f ? 0 : -1;
}
static inline int mcst_bad_power(int i, float v) { return i == 0 && mcst_outside(v, 0, 1e9f); }
static inline int mcst_bad_ends(int i, float v) { return i < 2 && !(fabsf(v) <= FLT_MAX); }
static inline int mcst_bad_cut(int i, float v) { return i == 0 ? !(v < 1e18f) : i == 1 && !(v > -1e18f); }
/* A bad height makes the density uniform. */
static inline int mcst_bad_corners(int i, float v) { return i < 2 && !(v >= 0 && v <= FLT_MAX) ? -1 : 0; }
static inline int mcst_bad_cone(int i, float v) { return i != 0 ? 0 : !(v > 0 && v <= 2) ? 1 : v < 1e-30f ? -1 : 0; }
static inline int mcst_bad_ball(int i, float v) {
    return i == 0 ? !(fabsf(v) <= 1e18f) : i == 1 && mcst_outside(v, 1e-18f, 1e18f);
}
static inline int mcst_bad_asymmetry(int i, float v) { return i == 0 && mcst_outside(v, -1, 1); }
static inline int mcst_bad_sharpness(int i, float v) { return i == 0 && mcst_outside(v, 0, 1e8f); }
/* A light without an area; beyond the grids there are such that are no lights for float. */
static inline int mcst_bad_light(int i, float v) {
    if (i >= 2) return 0;
    return !(fabsf(v) <= FLT_MAX) || v == 0 ? 1 : v >= 1e-6f && v <= (i ? 10 : 1e4f) ? 0 : -1;
}
static inline int mcst_bad_phong(int i, float v) { return i == 0 && !(v >= 0); }
static inline int mcst_bad_alpha(int i, float v) {
    (void)i;
    return !(v > 0);
}
static inline int mcst_bad_exponents(int i, float v) {
    (void)i;
    return !(v >= 0);
}
/* clang-format off */
#define MCST_DOMAIN_none {mcst_bad_none, {1e-18, 0}, {1e18, 0}, 0}
#define MCST_DOMAIN_linear {mcst_bad_linear, {1e-45, 1e-45}, {3.4e38, 3.4e38}, 0}
#define MCST_DOMAIN_radius {mcst_bad_radius, {1e-18, 0}, {1e18, 0}, 0}
#define MCST_DOMAIN_rate {mcst_bad_rate, {1e-18, 0}, {1e18, 0}, 0}
#define MCST_DOMAIN_truncexp {mcst_bad_truncexp, {1e-30, 1e-18}, {1e18, 1e18}, 0}
#define MCST_DOMAIN_normal {mcst_bad_normal, {1e-30, 1e-18}, {1e30, 1e18}, 1}
#define MCST_DOMAIN_power {mcst_bad_power, {1e-30, 1e-30}, {1e9, 1e9}, 0}
#define MCST_DOMAIN_ends {mcst_bad_ends, {1e-30, 2}, {1, 9e17}, 1}
#define MCST_DOMAIN_cut {mcst_bad_cut, {1e-30, 2}, {1, 9e17}, 1}
#define MCST_DOMAIN_corners {mcst_bad_corners, {1e-45, 1e-45}, {3.4e38, 3.4e38}, 0}
#define MCST_DOMAIN_cone {mcst_bad_cone, {1e-30, 0}, {2, 0}, 0}
#define MCST_DOMAIN_ball {mcst_bad_ball, {1e-18, 1e-18}, {1e18, 1e18}, 1}
#define MCST_DOMAIN_disk_light {mcst_bad_ball, {1e-18, 1e-18}, {1e18, 1e18}, 1}
#define MCST_DOMAIN_asymmetry {mcst_bad_asymmetry, {1e-30, 0}, {0.99999994, 0}, 1}
#define MCST_DOMAIN_sharpness {mcst_bad_sharpness, {1e-30, 0}, {1e8, 0}, 0}
#define MCST_DOMAIN_light {mcst_bad_light, {1e-6, 1e-5}, {1e4, 10}, 0}
#define MCST_DOMAIN_phong {mcst_bad_phong, {1e-30, 1e-30}, {1e9, 1e9}, 0}
#define MCST_DOMAIN_alpha {mcst_bad_alpha, {1e-7, 1e-7}, {1e4, 1e4}, 0}
#define MCST_DOMAIN_exponents {mcst_bad_exponents, {1e-30, 1e-30}, {1e9, 1e9}, 0}
/* clang-format on */

/* From the pole over 45 degrees to a cosine of 1e-6, azimuths off the axes. */
static const float mcst_incidence[][2] = {{1, 0},         {0.95f, 0.4f},       {0.70710678f, 0.7f},
                                          {0.35f, 2.1f},  {0.0871557f, -2.5f}, {0.01f, 1.1f},
                                          {1e-3f, -0.4f}, {1e-6f, 2.8f}};

/* The sub-grids of the chi-square test. At least one set of each row has 1e7 samples or more. A reflected direction is
 * a float: its half-vector is off by 2^-24, so with alpha = 1e-6 the bins, not the sampler, would be at fault; those
 * are left to the oracle. */
static const mcst_set mcst_chi_none[] = {{0, 0, 0, 0, 10}};
static const mcst_set mcst_chi_linear[] = {
    {1, 3, 0, 0, 10}, {1, 1, 0, 0, 2}, {0, 1, 0, 0, 2}, {1, 0, 0, 0, 2}, {1e6f, 1, 0, 0, 2}};
static const mcst_set mcst_chi_radius[] = {{1, 0, 0, 0, 10}, {0.3f, 0, 0, 0, 2}, {1e6f, 0, 0, 0, 2}};
static const mcst_set mcst_chi_rate[] = {{1, 0, 0, 0, 10}, {0.3f, 0, 0, 0, 2}, {1e6f, 0, 0, 0, 2}};
static const mcst_set mcst_chi_truncexp[] = {
    {3, 1, 0, 0, 10}, {0, 1, 0, 0, 2}, {1e-3f, 1, 0, 0, 2}, {50, 2, 0, 0, 2}, {1e-3f, 1e6f, 0, 0, 2}};
static const mcst_set mcst_chi_normal[] = {{0, 1, 0, 0, 10}, {-3, 100, 0, 0, 2}, {5, 0.01f, 0, 0, 2}};
static const mcst_set mcst_chi_power[] = {
    {2, 0, 0, 0, 10}, {0, 0, 0, 0, 2}, {0.5f, 0, 0, 0, 2}, {10, 0, 0, 0, 2}, {100, 0, 0, 0, 2}};
static const mcst_set mcst_chi_ends[] = {
    {0, 1, 0, 0, 10}, {-1, 1, 0, 0, 2}, {2, 5, 0, 0, 2}, {0, 1e-18f, 0, 0, 2}, {-1e18f, 0, 0, 0, 2}};
static const mcst_set mcst_chi_cut[] = {{-1, 1, 0, 0, 10},   {8, 9, 0, 0, 2},
                                        {-31, -30, 0, 0, 2}, {-INFINITY, INFINITY, 0, 0, 2},
                                        {-3, 0.5f, 0, 0, 2}, {0.5f, 0.51f, 0, 0, 2}};
static const mcst_set mcst_chi_corners[] = {
    {2, 5, 0, 0, 10}, {0, 0, 0, 0, 2}, {0, 4, 0, 0, 2}, {4, 0, 0, 0, 2}, {1e6f, 1, 0, 0, 2}};
static const mcst_set mcst_chi_cone[] = {
    {0.5f, 0, 0, 0, 10}, {2, 0, 0, 0, 2}, {0.01f, 0, 0, 0, 2}, {1e-8f, 0, 0, 0, 2}};
static const mcst_set mcst_chi_ball[] = {
    {1, 0.5f, 0, 0, 10}, {0.3f, 0.5f, 0, 0, 2}, {-1, 1.1456f, 0, 0, 2}, {1, 1e-2f, 0, 0, 2}, {0, 1, 0, 0, 2}};
static const mcst_set mcst_chi_disk_light[] = {{1, 0.5f, 0, 0, 10}, {0.3f, 0.5f, 0, 0, 2}, {-1, 1e-2f, 0, 0, 2}};
static const mcst_set mcst_chi_asymmetry[] = {
    {0.5f, 0, 0, 0, 10}, {0, 0, 0, 0, 2}, {0.9f, 0, 0, 0, 2}, {-0.8f, 0, 0, 0, 2}, {0.999f, 0, 0, 0, 2}};
static const mcst_set mcst_chi_sharpness[] = {{1, 0, 0, 0, 10}, {0, 0, 0, 0, 2},   {0.1f, 0, 0, 0, 2},
                                              {10, 0, 0, 0, 2}, {100, 0, 0, 0, 2}, {1e6f, 0, 0, 0, 2}};
static const mcst_set mcst_chi_light[] = {
    {0.5f, 1, 0, 0, 10}, {30, 0.3f, 0, 0, 2}, {1e-3f, 1e-2f, 0, 0, 2}, {1e4f, 1, 0, 0, 2}};
static const mcst_set mcst_chi_phong[] = {{10, 0, 0.5f, 0.7f, 10},     {0, 0, 0.7f, 2, 2},    {1, 0, 1, 0, 2},
                                          {100, 0, 0.0871557f, -2, 2}, {1e4f, 0, 0.7f, 1, 2}, {50, 0, 1e-3f, 1.1f, 2},
                                          {1e6f, 0, 0.3f, -1, 2}};
static const mcst_set mcst_chi_alpha[] = {
    {0.5f, 0.2f, 0.5f, 0.7f, 10}, {0.1f, 0.1f, 1, 0, 2},   {1e-3f, 1e-3f, 0.0871557f, 2, 2}, {0.01f, 1, 0.7f, -2.5f, 2},
    {1, 1, 1e-3f, 1.1f, 2},       {10, 3, 0.26f, 0.3f, 2}, {1e-4f, 1e-4f, 0.7f, 1, 2}};
static const mcst_set mcst_chi_exponents[] = {{10, 100, 0.5f, 0.7f, 10},       {0, 0, 0.7f, 2, 2},
                                              {1e3f, 1e3f, 0.0871557f, -2, 2}, {1e5f, 10, 0.7f, 1, 2},
                                              {1, 1, 1e-3f, 1.1f, 2},          {1e6f, 1e6f, 1, 0, 2}};

static inline o_vec3 mcst_o3(const float *x) { return o_v3(x[0], x[1], x[2]); }

static inline o_vec2 mcst_o2(const float *x) {
    o_vec2 v;
    v.x = x[0];
    v.y = x[1];
    return v;
}

/* --- claims ------------------------------------------------------------------------------------------------------- */

/* clang-format off */
/* The figures of u for small exponents: a power n of the cosine gives (1-u1)/cos with ln cos = ln(1-u1)/(n+1), at most
 * 16.7 in size. Its logarithm, 1/(n+1) and their product round by half an ulp of that or more, 2.5e-6 in all, and with
 * two exponents 1/(n+1) is a rounded sum. |ln(pdf/peak)| = n/(n+1) 16.7 does not pay for that when n is near 0. */
#define MCST_NO_PARAMETER {0, 0}, {0, 0}
#define MCST_ALPHAS {1e-7, 1e-7}, {1e4, 1e4}
/* The worst that climb.c finds is 0.25, of truncexp: five roundings of 0.06 E are in the density of u, two of them in
 * 1 - e^-x. */
static const mcst_claim mcst_claims_line[] = {{MCST_NO_PARAMETER, {0.3, 0.3, 0, 0, 0, 0, 8}}};
static const mcst_claim mcst_claims_normal[] = {{MCST_NO_PARAMETER, {0.45, 0.45, 0, 0, 0, 0, 14}}};
/* 1/pi as a float is off by 0.04, and is divided by the radius twice, for 0.06 each. In 2^-24 of the radius: at the angle
 * 0 the root rounds by 0.5, its product with the radius by 1, the cosine by 0.5 and the last product by 1. At an eighth
 * of a turn the cosine is off by 1.33, and the others, times 0.71, by 1.6. There the concentric map adds 0.83, as its
 * angle comes from two coordinates that round by 0.5 and their quotient. */
static const mcst_claim mcst_claims_disk[] = {{MCST_NO_PARAMETER, {0.16, 0.16, 0, 0, 0, 0, 4}}};
/* The density is a constant that is a float: a thousandth of 1e-6 is less than half of an ulp. */
static const mcst_claim mcst_claims_triangle[] = {{MCST_NO_PARAMETER, {0.001, 0.001, 0, 0, 0, 0, 1}}};
static const mcst_claim mcst_claims_bilinear[] = {{MCST_NO_PARAMETER, {0.7, 0.5, 0, 0, 0, 0, 8}}};
/* A coordinate is a sine times the cosine of an azimuth. The sine is off by up to 1.25 (all floats u1 were tried), of
 * which its own rounding is 0.5. The cosine is off by up to 1.33, where it is about 0.7. Together that is at most 2.23
 * (all floats u2 were tried), and the product rounds by 0.5: 2.73. Phase functions have the square of the sine from
 * doubles, rounded once: 0.75 instead of 1.25, and 2.37 in all. */
static const mcst_claim mcst_claims_direction[] = {{MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 4, 2.8}}};
static const mcst_claim mcst_claims_rayleigh[] = {{MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 4, 2.5}}};
static const mcst_claim mcst_claims_cone[] = {{{1e-30, 0}, {2, 0}, {0.2, 0.2, 0, 0, 0, 4, 2.8}}};
static const mcst_claim mcst_claims_ball[] = {{{-1e18, 1e-18}, {1e18, 1e18}, {0.1, 0.1, 0, 0, 0, 4, 2.5, 0.1}}};
static const mcst_claim mcst_claims_disk_light[] = {{{-1e18, 1e-18}, {1e18, 1e18}, {0.1, 0.1, 0, 0, 0, 4, 1, 0.1}}};
static const mcst_claim mcst_claims_light[] = {{{9.99e-7, 9.99e-6}, {1e4, 10}, {0.2, 0.2, 0, 0, 0, 4, 1.1, 0.1, 1.1}}};
static const mcst_claim mcst_claims_asymmetry[] = {{{-1, 0}, {0.99999994, 0}, {0.2, 0.6, 0, 0, 0, 4, 2.5}}};
static const mcst_claim mcst_claims_sharpness[] = {{{0, 0}, {1e8, 0}, {0.2, 0.4, 0, 0, 0, 4, 2.8}}}; /* uniform below 1e-8 */
static const mcst_claim mcst_claims_phong_lobe[] = {
    {{1, 0}, {1e9, 0}, {0.4, 0, 0, 0, 0, 0}},
    {{0.1, 0}, {1, 0}, {1.2, 0, 0, 0, 0, 0}},
    {{0, 0}, {1e9, 0}, {2.9, 0.6, 0, 0, 0, 4}},
};
static const mcst_claim mcst_claims_phong[] = {
    {{1, 0}, {1e9, 0}, {0.4, 0, 0, 0, 0, 0}},
    {{0.1, 0}, {1, 0}, {1.2, 0, 0, 0, 0, 0}},
    {{0, 0}, {1e9, 0}, {2.9, 0.6, 0.6, 0.3, 0.3, 4}},
};
static const mcst_claim mcst_claims_gauss_h[] = {{MCST_ALPHAS, {1.2, 1, 0, 0, 0, 4}}};
static const mcst_claim mcst_claims_gauss[] = {{MCST_ALPHAS, {1.2, 1, 1.4, 1.8, 0.8, 4}}};
static const mcst_claim mcst_claims_ggx_h[] = {{MCST_ALPHAS, {1.2, 1.2, 0, 0, 0, 4}}};
static const mcst_claim mcst_claims_ggx[] = {{MCST_ALPHAS, {1.2, 1.2, 1.5, 1.6, 0.7, 4}}};
static const mcst_claim mcst_claims_visible_h[] = {{MCST_ALPHAS, {2.1, 1.5, 0, 0, 0, 4}}};
static const mcst_claim mcst_claims_visible[] = {{MCST_ALPHAS, {2.1, 1.5, 1.5, 0.7, 0.7, 4}}};
static const mcst_claim mcst_claims_ashikhmin_h[] = {
    {{1, 1}, {1e9, 1e9}, {0.8, 0, 0, 0, 0, 0}},
    {{0.1, 0.1}, {1e9, 1e9}, {1.4, 0, 0, 0, 0, 0}},
    {{0, 0}, {1e9, 1e9}, {3.7, 0.6, 0, 0, 0, 4}},
};
static const mcst_claim mcst_claims_ashikhmin[] = {
    {{1, 1}, {1e9, 1e9}, {0.8, 0, 0, 0, 0, 0}},
    {{0.1, 0.1}, {1e9, 1e9}, {1.4, 0, 0, 0, 0, 0}},
    {{0, 0}, {1e9, 1e9}, {3.7, 0.6, 0.6, 0.1, 0.1, 4}},
};
/* clang-format on */

/* --- the functions of the rows ------------------------------------------------------------------------------------ */

#if defined(MCS_NO_WIDE) || defined(MCST_ARRAYS)
#undef MCST_WIDE
#endif
#ifdef __CUDACC__ /* for kernels too */
#define MCST_HD __host__ __device__
#else
#define MCST_HD
#endif

#ifdef MCST_LINKED
#define MCST_FN
#define MCST_HOST_FN
#define MCST_DECLARE_UV(row)                                                                               \
    mcst_value_fn mcst1_##row##_invert, mcst4_##row##_invert, mcst8_##row##_invert, mcst16_##row##_invert; \
    mcst_exact_invert_fn mcsto_##row##_invert;                                                             \
    mcst_rough_map_fn mcstr_##row##_map;                                                                   \
    mcst_rough_u_fn mcstr_##row##_pdf_u;                                                                   \
    mcst_rough_invert_fn mcstr_##row##_invert;
#define MCST_DECLARE_LINE MCST_DECLARE_UV
#define MCST_DECLARE_PLANE MCST_DECLARE_UV
#define MCST_DECLARE_DIR MCST_DECLARE_UV
#define MCST_DECLARE_LIGHT MCST_DECLARE_UV
#define MCST_DECLARE_POLYGON MCST_DECLARE_UV
#define MCST_DECLARE_LOBE MCST_DECLARE_UV
#define MCST_DECLARE_VLOBE MCST_DECLARE_UV
#define MCST_DECLARE_BRDF(row)                                                                             \
    mcst_value_fn mcst1_##row##_eval, mcst4_##row##_eval, mcst8_##row##_eval, mcst16_##row##_eval;         \
    mcst_value_fn mcst1_##row##_weight, mcst4_##row##_weight, mcst8_##row##_weight, mcst16_##row##_weight; \
    mcst_value_n_fn mcstn_##row##_pdf, mcstn_##row##_eval;                                                 \
    mcst_hits_fn mcstn_##row##_sample_hits, mcstn_##row##_pdf_hits;                                        \
    mcst_exact_fn mcsto_##row##_eval, mcsto_##row##_weight;
#define MCST_DECLARE(shape, row, fn, arg, base, coord, grid)                                                \
    mcst_sample_fn mcst1_##row##_sample, mcst4_##row##_sample, mcst8_##row##_sample, mcst16_##row##_sample; \
    mcst_value_fn mcst1_##row##_pdf, mcst4_##row##_pdf, mcst8_##row##_pdf, mcst16_##row##_pdf;              \
    mcst_sample_n_fn mcstn_##row;                                                                           \
    mcst_map_fn mcsto_##row##_map;                                                                          \
    mcst_exact_fn mcsto_##row##_pdf;                                                                        \
    mcst_exact_u_fn mcsto_##row##_pdf_u;                                                                    \
    MCST_DECLARE_##shape(row)
MCST_ROWS(MCST_DECLARE)
#else
#define MCST_FN MCST_HD static inline
#define MCST_HOST_FN static inline
#define MCST_W 1
#include "adapters.h"
#ifdef MCST_WIDE
#define MCST_W 8
#include "adapters.h"
#ifndef MCST_EIGHT
#define MCST_W 4
#include "adapters.h"
#define MCST_W 16
#include "adapters.h"
#endif
#endif
#include "truth.h"
#endif

/* --- the table ---------------------------------------------------------------------------------------------------- */

/* clang-format off */
#if defined(MCST_WIDE) && defined(MCST_EIGHT)
#define MCST_FOR_WIDTHS(M, row) {M(mcst1_, row), {0}, M(mcst8_, row), {0}}
#elif defined(MCST_WIDE)
#define MCST_FOR_WIDTHS(M, row) {M(mcst1_, row), M(mcst4_, row), M(mcst8_, row), M(mcst16_, row)}
#else
#define MCST_FOR_WIDTHS(M, row) {M(mcst1_, row), {0}, {0}, {0}}
#endif
#define MCST_FNS_UV(w, row) {w##row##_sample, w##row##_pdf, w##row##_invert, NULL, NULL}
#define MCST_FNS_BRDF(w, row) {w##row##_sample, w##row##_pdf, NULL, w##row##_eval, w##row##_weight}
#define MCST_TAIL_UV(row) \
    MCST_FOR_WIDTHS(MCST_FNS_UV, row), mcstn_##row, NULL, NULL, NULL, NULL, \
        {mcsto_##row##_map, mcsto_##row##_pdf, mcsto_##row##_pdf_u, mcsto_##row##_invert, NULL, NULL}, MCST_ROUGH(row)
#ifdef MCST_LINKED
#define MCST_ROUGH(row) {mcstr_##row##_map, mcstr_##row##_pdf_u, mcstr_##row##_invert}
#else
#define MCST_ROUGH(row) {NULL, NULL, NULL}
#endif
#define MCST_TAIL_BRDF(row) \
    MCST_FOR_WIDTHS(MCST_FNS_BRDF, row), mcstn_##row, mcstn_##row##_pdf, mcstn_##row##_eval, \
        mcstn_##row##_sample_hits, mcstn_##row##_pdf_hits, \
        {mcsto_##row##_map, mcsto_##row##_pdf, mcsto_##row##_pdf_u, NULL, mcsto_##row##_eval, mcsto_##row##_weight}, \
        {NULL, NULL, NULL}
#define MCST_COUNT(array) (sizeof(array) / sizeof(array)[0])
#define MCST_COUNT_0 0
#define MCST_COUNT_1 1
#define MCST_COUNT_2 2
#define MCST_COUNT_corners 2
#define MCST_COUNT_cross 2
#define MCST_COUNT_ball 2
#define MCST_COUNT_disk_light 2
#define MCST_COUNT_rectangle 2
#define MCST_COUNT_triangle 2
#define MCST_COUNT_phong 1
#define MCST_COUNT_ward 2
#define MCST_COUNT_ward_gmd 2
#define MCST_COUNT_ward_duer 2
#define MCST_COUNT_ward_1992 2
#define MCST_COUNT_beckmann 2
#define MCST_COUNT_ggx 2
#define MCST_COUNT_ashikhmin 2
#define MCST_SHAPE_LINE(row) MCST_IS_LINE, MCST_LENGTH
#define MCST_SHAPE_PLANE(row) MCST_IS_PLANE, MCST_AREA
#define MCST_SHAPE_DIR(row) MCST_IS_DIR, MCST_SOLID_ANGLE
#define MCST_SHAPE_LIGHT(row) MCST_IS_DIR, MCST_SOLID_ANGLE
#define MCST_SHAPE_POLYGON(row) MCST_IS_DIR, MCST_SOLID_ANGLE
#define MCST_SHAPE_LOBE(row) MCST_IS_LOBE, MCST_SOLID_ANGLE_OF_H
#define MCST_SHAPE_VLOBE(row) MCST_IS_VLOBE, MCST_SOLID_ANGLE_OF_H
#define MCST_SHAPE_BRDF(row) MCST_IS_BRDF, MCST_SOLID_ANGLE
#define MCST_SIZE_LINE 1, 1
#define MCST_SIZE_PLANE 2, 2
#define MCST_SIZE_DIR 2, 3
#define MCST_SIZE_LIGHT 2, 3
#define MCST_SIZE_POLYGON 2, 3
#define MCST_SIZE_LOBE 2, 3
#define MCST_SIZE_VLOBE 2, 3
#define MCST_SIZE_BRDF 2, 3
#define MCST_WO_LINE 0
#define MCST_WO_PLANE 0
#define MCST_WO_DIR 0
#define MCST_WO_LIGHT 0
#define MCST_WO_POLYGON 0
#define MCST_WO_LOBE 0
#define MCST_WO_VLOBE 1
#define MCST_WO_BRDF 1
#define MCST_T_LINE(row) MCST_TAIL_UV(row)
#define MCST_T_PLANE(row) MCST_TAIL_UV(row)
#define MCST_T_DIR(row) MCST_TAIL_UV(row)
#define MCST_T_LIGHT(row) MCST_TAIL_UV(row)
#define MCST_T_POLYGON(row) MCST_TAIL_UV(row)
#define MCST_T_LOBE(row) MCST_TAIL_UV(row)
#define MCST_T_VLOBE(row) MCST_TAIL_UV(row)
#define MCST_T_BRDF(row) MCST_TAIL_BRDF(row)
#define MCST_TABLE(X, shape, row, fn, arg, base, coord, grid, claims, vary, traits) \
    {#row, #fn, MCST_SHAPE_##shape(row), MCST_##coord, MCST_SIZE_##shape, MCST_COUNT_##arg, MCST_WO_##shape, \
     mcst_grid_##grid, MCST_COUNT(mcst_grid_##grid), mcst_chi_##grid, MCST_COUNT(mcst_chi_##grid), \
     MCST_T_##shape(row), \
     mcst_claims_##claims, MCST_COUNT(mcst_claims_##claims), vary, traits, MCST_DOMAIN_##grid},
/* clang-format on */

#ifndef MCST_SHARED
static const mcst_row mcst_rows[] = {MCST_LIST(MCST_TABLE, )};
enum { MCST_NROWS = MCST_COUNT(mcst_rows) };

static inline const mcst_row *mcst_find(const char *name) {
    for (size_t i = 0; i < MCST_NROWS; i++)
        if (!strcmp(mcst_rows[i].name, name)) return &mcst_rows[i];
    fprintf(stderr, "registry: no row %s\n", name);
    exit(2);
}
#endif

static inline void mcst_fill(const mcst_row *row, float a, float b, float cos_o, float azimuth, float p[MCST_P]) {
    const double s = sqrt((1 - (double)cos_o) * (1 + (double)cos_o));
    p[0] = a;
    p[1] = b;
    p[2] = 0;
    p[3] = row->has_wo ? (float)(s * cos((double)azimuth)) : 0;
    p[4] = row->has_wo ? (float)(s * sin((double)azimuth)) : 0;
    p[5] = row->has_wo ? cos_o : 1;
}

/* The full grid: sampler parameters times incidences. */
static inline size_t mcst_grid_count(const mcst_row *row) {
    return row->grid_size * (row->has_wo ? MCST_COUNT(mcst_incidence) : 1);
}

static inline void mcst_grid_get(const mcst_row *row, size_t i, float p[MCST_P]) {
    const float *g = row->grid[i % row->grid_size];
    const float *o = mcst_incidence[i / row->grid_size];
    mcst_fill(row, g[0], g[1], o[0], o[1], p);
}

/* Where the x of a line is a difference, its rounding is that of the terms: their size. */
static inline double mcst_line_scale(const mcst_row *row, const float *p) {
    const double a = fabs((double)p[0]);
    const double b = fabs((double)p[1]);
    switch (row->coord) {
    case MCST_TENT:
    case MCST_BETWEEN: return a;
    case MCST_WHOLELINE: return a + b;
    /* a place near 0 is where a share is: about 0 a difference of shares, beside it one that double rounds */
    case MCST_CUT: return fmin(1, fmax(a, b)) * (p[0] < 0 && p[1] > 0 ? 1 : 1e-5);
    default: return 0;
    }
}

/* What the error of a coordinate x is measured by, in CLAIM_WHERE: 1 of directions and of the unit square, the radius of
 * a disk, x itself of a triangle, and of a line x or the terms of which it is the difference. */
static inline double mcst_where_scale(const mcst_row *row, const float *p, double x) {
    if (row->dim == 1) return fmax(fabs(x), mcst_line_scale(row, p));
    if (row->coord == MCST_DISK) return fabs((double)p[0]);
    return row->dim == 2 && row->params == 0 ? fabs(x) : 1;
}

/* Parameters that are bad together, while each is good. */
static inline int mcst_bad_together(const mcst_row *row, const float *p) {
    if (row->coord == MCST_UNIT) return p[0] == 0 && p[1] == 0;
    if (row->coord == MCST_CUT) return !(fminf(p[1], 1e18f) - fmaxf(p[0], -1e18f) >= 1e-18f);
    return row->coord == MCST_BETWEEN && mcst_outside(p[1] - p[0], 1e-18f, 1e18f);
}

/* --- random numbers of the tests: splitmix64 (Steele, Lea, Flood 2014) -------------------------------------------- */

static inline uint64_t mcst_mix(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static inline void mcst_uniform(uint64_t *state, size_t n, float *u1, float *u2) {
    for (size_t i = 0; i < n; i++) {
        const uint64_t z = mcst_mix(state);
        u1[i] = (float)(int32_t)(z >> 40) * 0x1p-24f;
        u2[i] = (float)(int32_t)(z >> 16 & 0xFFFFFF) * 0x1p-24f;
    }
}

/* A seed for one use (a test's tag) of one row and parameter set, from the seed of the run. */
static inline uint64_t mcst_seed_for(const char *row, const char *use, size_t set) {
    uint64_t state = mcst.seed + 0x632BE59BD9B4E019u * (set + 1);
    for (; *row; row++) state = (state ^ (unsigned char)*row) * 0x100000001B3u;
    for (; *use; use++) state = (state ^ (unsigned char)*use) * 0x100000001B3u;
    return mcst_mix(&state);
}

/* MCS_TEST_SCALE multiplies sample counts (sanitizer runs are slow). */
static inline double mcst_scale(void) {
    const char *s = getenv("MCS_TEST_SCALE");
    const double v = s ? atof(s) : 1;
    return v > 0 ? v : 1;
}
#endif
