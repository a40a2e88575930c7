/* gallery_samplers.h - what gallery.c draws: for every sampler of mcsample.h how a point is drawn and how dense points
 * are, both as functions of the same shape, and the words beside them. */
#ifndef GALLERY_SAMPLERS_H
#define GALLERY_SAMPLERS_H
#include <math.h>
#include <stdlib.h>
#include "mcsample.h"

typedef mcs_vec3 vec3;

/* Where points are, and how they are brought onto the square of a panel. Directions keep their areas: as many dots are
 * due wherever the colour is the same. */
typedef enum {
    LINE,       /* x */
    SQUARE,     /* x and y in [0,1] */
    DISK,       /* of radius 1 */
    TRIANGLE,   /* b0 and b1 */
    HEMISPHERE, /* directions above the surface, seen from above, the normal in the centre */
    LOBE,       /* the same, for densities that depend on wo, which a ring marks */
    SPHERE,     /* all directions, +z in the centre, -z all along the rim */
    MAP         /* all directions by azimuth, from left to right, and height */
} projection;

typedef struct {
    const char *name, *formula;
    projection as;
    vec3 (*draw)(float u1, float u2);
    float (*density)(vec3 at);
    float low, high; /* what a panel of a line shows */
} sampler;

typedef struct {
    const char *file, *title;
    int count;
    const sampler *of;
} group;

#define GROUP(file, title, of) \
    { file, title, sizeof of / sizeof *of, of }

static vec3 vec(float x, float y, float z) {
    vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}

/* ---- a line ---- */

/* draw_NAME and density_NAME of a density on a line with one parameter, or two. */
#define LINE_1(name, a)                                   \
    static vec3 draw_##name(float u1, float u2) {         \
        (void)u2;                                         \
        return vec(mcs_##name##_sample((a), u1).x, 0, 0); \
    }                                                     \
    static float density_##name(vec3 at) { return mcs_##name##_pdf((a), at.x); }
#define LINE_2(name, a, b)                                     \
    static vec3 draw_##name(float u1, float u2) {              \
        (void)u2;                                              \
        return vec(mcs_##name##_sample((a), (b), u1).x, 0, 0); \
    }                                                          \
    static float density_##name(vec3 at) { return mcs_##name##_pdf((a), (b), at.x); }
LINE_2(linear, 0.4f, 2)
LINE_1(tent, 1)
LINE_1(exponential, 1)
LINE_2(truncexp, 1, 2)
LINE_2(normal, 0, 1)
LINE_2(logistic, 0, 1)
LINE_2(truncnormal, -1, 2)
LINE_2(trunclogistic, 0.5f, 4)
LINE_1(power, 3)
LINE_1(evenpower, 2)
LINE_2(smoothstep, 0, 1)

static const sampler lines[] = {
    {"linear 0.4 to 2", "2 ((1-x) a + x b) / (a+b)", LINE, draw_linear, density_linear, 0, 1},
    {"tent", "(1 - |x|/r) / r", LINE, draw_tent, density_tent, -1, 1},
    {"exponential", "rate e^(-rate x)", LINE, draw_exponential, density_exponential, 0, 5},
    {"truncexp, m = 2", "rate e^(-rate x)/(1-e^(-rate m))", LINE, draw_truncexp, density_truncexp, 0, 2},
    {"normal", "e^(-x^2/2) / sqrt(2 pi)", LINE, draw_normal, density_normal, -4, 4},
    {"logistic", "e^-x / (1 + e^-x)^2", LINE, draw_logistic, density_logistic, -8, 8},
    {"truncnormal -1 to 2", "c e^(-x^2/2)", LINE, draw_truncnormal, density_truncnormal, -1, 2},
    {"trunclogistic 0.5 to 4", "c e^-x / (1 + e^-x)^2", LINE, draw_trunclogistic, density_trunclogistic, 0.5f, 4},
    {"power, e = 3", "(e+1) x^e", LINE, draw_power, density_power, 0, 1},
    {"evenpower, e = 2", "(e+1)/2 |x|^e", LINE, draw_evenpower, density_evenpower, -1, 1},
    {"smoothstep", "2 (3 x^2 - 2 x^3)", LINE, draw_smoothstep, density_smoothstep, 0, 1}};

/* ---- tables ---- */

enum { ENTRIES = 16 };
static const float entry[ENTRIES + 1] = {3, 4, 6, 9, 11, 8, 4, 2, 1, 2, 5, 7, 6, 4, 2, 1, 1};
static mcs_pwc *cells;
static mcs_pwl *vertices;
static mcs_discrete *weights;
static mcs_alias *columns;

/* Entries of a list as the even cells of [0,1). */
static uint32_t entry_at(vec3 at) { return at.x >= 0 ? (uint32_t)(at.x * ENTRIES) : ENTRIES; }
static vec3 entry_middle(uint32_t i) { return vec(((float)i + 0.5f) / ENTRIES, 0, 0); }

static vec3 draw_pwc(float u1, float u2) {
    (void)u2;
    return vec(mcs_pwc_sample(cells, u1).x, 0, 0);
}
static float density_pwc(vec3 at) { return mcs_pwc_pdf(cells, at.x); }
static vec3 draw_pwl(float u1, float u2) {
    (void)u2;
    return vec(mcs_pwl_sample(vertices, u1).x, 0, 0);
}
static float density_pwl(vec3 at) { return mcs_pwl_pdf(vertices, at.x); }
static vec3 draw_discrete(float u1, float u2) {
    (void)u2;
    return entry_middle(mcs_discrete_sample(weights, u1).i);
}
static float density_discrete(vec3 at) { return ENTRIES * mcs_discrete_pmf(weights, entry_at(at)); }
static vec3 draw_alias(float u1, float u2) {
    (void)u2;
    return entry_middle(mcs_alias_sample(columns, u1).i);
}
static float density_alias(vec3 at) { return ENTRIES * mcs_alias_pmf(columns, entry_at(at)); }

static const sampler tables[] = {
    {"pwc", "steps, from a list", LINE, draw_pwc, density_pwc, 0, 1},
    {"pwl", "pieces of lines, from a list", LINE, draw_pwl, density_pwl, 0, 1},
    {"discrete", "entries in proportion to a list", LINE, draw_discrete, density_discrete, 0, 1},
    {"alias", "the same, in one look-up", LINE, draw_alias, density_alias, 0, 1}};

/* ---- the plane ---- */

static vec3 draw_bilinear(float u1, float u2) {
    const mcs_sample2 s = mcs_bilinear_sample(1, 3, 6, 0, u1, u2);
    return vec(s.x, s.y, 0);
}
static float density_bilinear(vec3 at) { return mcs_bilinear_pdf(1, 3, 6, 0, at.x, at.y); }
static vec3 draw_concentric(float u1, float u2) {
    const mcs_sample2 s = mcs_concentric_sample(1, u1, u2);
    return vec(s.x, s.y, 0);
}
static float density_concentric(vec3 at) { return mcs_concentric_pdf(1, at.x, at.y); }
static vec3 draw_disk(float u1, float u2) {
    const mcs_sample2 s = mcs_disk_sample(1, u1, u2);
    return vec(s.x, s.y, 0);
}
static float density_disk(vec3 at) { return mcs_disk_pdf(1, at.x, at.y); }
static vec3 draw_triangle(float u1, float u2) {
    const mcs_sample2 s = mcs_triangle_sample(u1, u2);
    return vec(s.x, s.y, 0);
}
static float density_triangle(vec3 at) { return mcs_triangle_pdf(at.x, at.y); }

static const sampler planes[] = {
    {"bilinear 1, 3, 6, 0", "heights at four corners", SQUARE, draw_bilinear, density_bilinear, 0, 0},
    {"concentric", "1 / (pi radius^2)", DISK, draw_concentric, density_concentric, 0, 0},
    {"disk", "1 / (pi radius^2), by angle", DISK, draw_disk, density_disk, 0, 0},
    {"triangle", "1 / area", TRIANGLE, draw_triangle, density_triangle, 0, 0}};

/* ---- directions about +z ---- */

#define ABOUT_0(name)                                                                     \
    static vec3 draw_##name(float u1, float u2) { return mcs_##name##_sample(u1, u2).w; } \
    static float density_##name(vec3 at) { return mcs_##name##_pdf(at); }
#define ABOUT_1(of, name, a)                                                                 \
    static vec3 draw_##of(float u1, float u2) { return mcs_##name##_sample((a), u1, u2).w; } \
    static float density_##of(vec3 at) { return mcs_##name##_pdf((a), at); }
ABOUT_0(sphere)
ABOUT_0(hemisphere)
ABOUT_0(cosine)
ABOUT_0(rayleigh)
ABOUT_1(cone, cone, 0.3f)
ABOUT_1(forward, henyey_greenstein, 0.6f)
ABOUT_1(backward, henyey_greenstein, -0.3f)
ABOUT_1(von_mises_fisher, von_mises_fisher, 8)

static const sampler directions[] = {
    {"hemisphere", "1 / (2 pi)", HEMISPHERE, draw_hemisphere, density_hemisphere, 0, 0},
    {"cosine", "z / pi", HEMISPHERE, draw_cosine, density_cosine, 0, 0},
    {"cone, k = 0.3", "1 / (2 pi k)", HEMISPHERE, draw_cone, density_cone, 0, 0},
    {"sphere, -z at the rim", "1 / (4 pi)", SPHERE, draw_sphere, density_sphere, 0, 0},
    {"henyey_greenstein, g = 0.6", "(1-g^2)/(4 pi (1+g^2-2gz)^1.5)", SPHERE, draw_forward, density_forward, 0, 0},
    {"henyey_greenstein, g = -0.3", "(1-g^2)/(4 pi (1+g^2-2gz)^1.5)", SPHERE, draw_backward, density_backward, 0, 0},
    {"rayleigh", "3 (1 + z^2) / (16 pi)", SPHERE, draw_rayleigh, density_rayleigh, 0, 0},
    {"von_mises_fisher, kappa = 8", "in proportion to e^(kappa z)", SPHERE, draw_von_mises_fisher,
     density_von_mises_fisher, 0, 0}};

/* ---- lobes ---- */

static vec3 eye; /* wo */
static mcs_phong phong;
static mcs_ward ward;
static mcs_beckmann beckmann;
static mcs_ggx ggx;
static mcs_ashikhmin ashikhmin;

/* Half-vectors: all, and those that wo sees. */
#define NORMALS(name, m)                                                                            \
    static vec3 draw_##name##_h(float u1, float u2) { return mcs_##name##_h_sample(&m, u1, u2).w; } \
    static float density_##name##_h(vec3 at) { return mcs_##name##_h_pdf(&m, at); }
#define VISIBLE(name, m)                                                                                 \
    static vec3 draw_##name##_h(float u1, float u2) { return mcs_##name##_h_sample(&m, eye, u1, u2).w; } \
    static float density_##name##_h(vec3 at) { return mcs_##name##_h_pdf(&m, eye, at); }
/* Directions of light. */
#define REFLECTED(name, m)                                                                          \
    static vec3 draw_##name(float u1, float u2) { return mcs_##name##_sample(&m, eye, u1, u2).wi; } \
    static float density_##name(vec3 at) { return mcs_##name##_pdf(&m, eye, at); }
NORMALS(ward, ward)
NORMALS(beckmann, beckmann)
NORMALS(ggx, ggx)
NORMALS(ashikhmin, ashikhmin)
VISIBLE(ggx_vndf, ggx)
VISIBLE(ggx_bounded, ggx)
REFLECTED(phong, phong)
REFLECTED(ward, ward)
REFLECTED(beckmann, beckmann)
REFLECTED(ggx, ggx)
REFLECTED(ggx_vndf, ggx)
REFLECTED(ggx_bounded, ggx)
REFLECTED(ashikhmin, ashikhmin)
static vec3 draw_phong_lobe(float u1, float u2) { return mcs_phong_lobe_sample(&phong, u1, u2).w; }
static float density_phong_lobe(vec3 at) { return mcs_phong_lobe_pdf(&phong, at); }

static const sampler normals[] = {
    {"phong_lobe, n = 20", "(n+1)/(2 pi) z^n", HEMISPHERE, draw_phong_lobe, density_phong_lobe, 0, 0},
    {"ward_h, alpha 0.5, 0.2", "e^-(slopes/alpha)^2/(pi ab z^3)", HEMISPHERE, draw_ward_h, density_ward_h, 0, 0},
    {"beckmann_h, alpha 0.4", "D h.z, D of gaussian slopes", HEMISPHERE, draw_beckmann_h, density_beckmann_h, 0, 0},
    {"ashikhmin_h, n = 5, 80", "c z^(nu cos^2 + nv sin^2)", HEMISPHERE, draw_ashikhmin_h, density_ashikhmin_h, 0, 0},
    {"ggx_h, alpha 0.4", "D h.z", HEMISPHERE, draw_ggx_h, density_ggx_h, 0, 0},
    {"ggx_vndf_h", "2 D wo.h / (wo.z + t)", LOBE, draw_ggx_vndf_h, density_ggx_vndf_h, 0, 0},
    {"ggx_bounded_h", "2 D wo.h / (k wo.z + t)", LOBE, draw_ggx_bounded_h, density_ggx_bounded_h, 0, 0}};

static const sampler reflections[] = {
    {"phong, n = 20", "(n+1)/(2 pi) cos^n(mirror, wi)", LOBE, draw_phong, density_phong, 0, 0},
    {"ward, alpha 0.5, 0.2", "ward_h / (4 wo.h)", LOBE, draw_ward, density_ward, 0, 0},
    {"beckmann, alpha 0.4", "D h.z / (4 wo.h)", LOBE, draw_beckmann, density_beckmann, 0, 0},
    {"ashikhmin, n = 5, 80", "ashikhmin_h / (4 wo.h)", LOBE, draw_ashikhmin, density_ashikhmin, 0, 0},
    {"ggx, alpha 0.4", "D h.z / (4 wo.h)", LOBE, draw_ggx, density_ggx, 0, 0},
    {"ggx_vndf", "D / (2 (wo.z + t))", LOBE, draw_ggx_vndf, density_ggx_vndf, 0, 0},
    {"ggx_bounded, the one to use", "D / (2 (k wo.z + t))", LOBE, draw_ggx_bounded, density_ggx_bounded, 0, 0}};

/* ---- environment maps ---- */

enum { SKY_W = 64, SKY_H = 32, TILE_ROWS = 16 };
static mcs_env *env, *bright;
static mcs_env_window *window;
static mcs_tiles *tiles;
static mcs_product *product;

static vec3 draw_env(float u1, float u2) { return mcs_env_sample(env, u1, u2).w; }
static float density_env(vec3 at) { return mcs_env_pdf(env, at); }
static vec3 draw_bright(float u1, float u2) { return mcs_env_sample(bright, u1, u2).w; }
static float density_bright(vec3 at) { return mcs_env_pdf(bright, at); }
static vec3 draw_window(float u1, float u2) { return mcs_env_window_sample(window, env, u1, u2).w; }
static float density_window(vec3 at) { return mcs_env_window_pdf(window, env, at); }
static vec3 draw_product(float u1, float u2) { return mcs_product_sample(product, tiles, env, u1, u2).w; }
static float density_product(vec3 at) { return mcs_product_pdf(product, tiles, env, at); }

static const sampler maps[] = {
    {"env, a sky with a sun", "radiance / its integral", MAP, draw_env, density_env, 0, 0},
    {"env, floor = mean", "radiance above the mean, for mis", MAP, draw_bright, density_bright, 0, 0},
    {"env_window", "radiance within a rectangle", MAP, draw_window, density_window, 0, 0},
    {"product, facing -x", "nearly radiance * f * cosine", MAP, draw_product, density_product, 0, 0}};

static const group groups[] = {GROUP("lines", "1d: numbers", lines),
                               GROUP("tables", "tables", tables),
                               GROUP("planes", "square, disk, triangle", planes),
                               GROUP("directions", "sphere, media: directions about +z", directions),
                               GROUP("normals", "half-vectors of lobes. ring: wo", normals),
                               GROUP("reflections", "directions wi that lobes reflect. ring: wo", reflections),
                               GROUP("maps", "environment maps, unrolled", maps)};
enum { GROUPS = sizeof groups / sizeof *groups };

/* ---- tables and materials ---- */

/* A broad sun in a sky over dark ground. */
static float sky_at(unsigned col, unsigned row) {
    const float pi = 3.14159265f;
    const float theta = pi * ((float)row + 0.5f) / SKY_H;
    const float phi = 2 * pi * ((float)col + 0.5f) / SKY_W;
    const float to_sun = sinf(theta) * sinf(1) * cosf(phi - 2.2f) + cosf(theta) * cosf(1);
    const float sky = row < SKY_H / 2 ? 0.5f + 1.2f * sinf(theta) * sinf(theta) : 0.15f;
    return sky + (row < SKY_H / 2 ? 12 * expf(25 * (to_sun - 1)) : 0);
}

static int make_tables(void) {
    const size_t bytes = 4096;
    cells = (mcs_pwc *)malloc(bytes);
    vertices = (mcs_pwl *)malloc(bytes);
    weights = (mcs_discrete *)malloc(bytes);
    columns = (mcs_alias *)malloc(bytes);
    return cells && vertices && weights && columns && mcs_pwc_build(cells, bytes, entry, ENTRIES) == MCS_OK &&
           mcs_pwl_build(vertices, bytes, entry, ENTRIES) == MCS_OK &&
           mcs_discrete_build(weights, bytes, entry, ENTRIES) == MCS_OK &&
           mcs_alias_build(columns, bytes, entry, ENTRIES) == MCS_OK;
}

static int make_maps(void) {
    static float sky[SKY_H][SKY_W];
    for (unsigned row = 0; row < SKY_H; row++)
        for (unsigned col = 0; col < SKY_W; col++) sky[row][col] = sky_at(col, row);
    mcs_image image = mcs_image_make(&sky[0][0], SKY_W, SKY_H, 1);
    const size_t bytes = mcs_env_bytes(SKY_W, SKY_H);
    env = (mcs_env *)malloc(bytes);
    bright = (mcs_env *)malloc(bytes);
    window = (mcs_env_window *)malloc(mcs_env_window_bytes(12));
    product = (mcs_product *)malloc(mcs_product_bytes(TILE_ROWS));
    if (!env || !bright || !window || !product || mcs_env_build(env, bytes, &image) != MCS_OK) return 0;
    image.floor = mcs_env_mean(&image);
    tiles = (mcs_tiles *)malloc(mcs_tiles_bytes(env, TILE_ROWS));
    const mcs_vec3 up = {0, 0, 1};
    const mcs_vec3 normal = {-1, 0, 0};
    const mcs_reflection matte = {mcs_frame_make(normal), up, 1, 1, 1, MCS_PROFILE_GGX};
    return tiles && mcs_env_build(bright, bytes, &image) == MCS_OK &&
           mcs_env_window_build(window, mcs_env_window_bytes(12), env, 4, 12, 14, 30) == MCS_OK &&
           mcs_tiles_build(tiles, mcs_tiles_bytes(env, TILE_ROWS), env, TILE_ROWS) == MCS_OK &&
           mcs_product_build(product, mcs_product_bytes(TILE_ROWS), tiles, env, &matte, NULL) == MCS_OK;
}

/* Returns 0 where there is not enough memory. */
static int make_samplers(void) {
    eye = vec(-sinf(1.2f), 0, cosf(1.2f));
    phong = mcs_phong_make(20);
    ward = mcs_ward_make(0.5f, 0.2f, MCS_WARD_GMD);
    beckmann = mcs_beckmann_make(0.4f, 0.4f);
    ggx = mcs_ggx_make(0.4f, 0.4f);
    ashikhmin = mcs_ashikhmin_make(5, 80);
    return make_tables() && make_maps();
}

#endif
