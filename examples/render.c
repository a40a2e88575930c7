/* render.c - the main example of mcsample.h: how a renderer uses it.
 *
 * A row of spheres, one per BRDF, on a matte ground, lit by a latitude-longitude environment map: direct illumination
 * with visibility, estimated by uniform, cosine, BRDF, environment, multiple importance or product sampling. Writes PNG
 * and Radiance .hdr pictures and prints what each strategy cost and how far its mean may be off.
 *
 *     cc -O2 -std=c99 -I. -fopenmp examples/render.c -o render -lm       (-fopenmp is optional: without it, one thread)
 *     ./render --strategy all sunrise.hdr
 *
 * World: z up, lengths in sphere radii. Shading happens in the local frame of mcsample.h: normal on +z, wo to the eye,
 * wi to the light. Colours are linear RGB with the primaries of sRGB, kept in a vec3.
 */
#define _POSIX_C_SOURCE 200809L /* clock_gettime, fileno, isatty */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include "hdr.h"
#include "mcsample.h"

#ifdef _OPENMP
#include <omp.h>
#define OMP(directive) _Pragma(#directive)
#else
#define OMP(directive)
#endif

#define PI 3.14159265f

typedef mcs_vec3 vec3;

static vec3 vec(float x, float y, float z) {
    vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
static vec3 add(vec3 a, vec3 b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static vec3 sub(vec3 a, vec3 b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static vec3 mul(vec3 a, vec3 b) { return vec(a.x * b.x, a.y * b.y, a.z * b.z); }
static vec3 scale(float s, vec3 a) { return vec(s * a.x, s * a.y, s * a.z); }
static float dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec3 cross(vec3 a, vec3 b) { return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static vec3 unit(vec3 a) { return scale(1 / sqrtf(dot(a, a)), a); }
static vec3 mix(float t, vec3 a, vec3 b) { return add(scale(1 - t, a), scale(t, b)); }
static float luminance(vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; } /* Rec. 709 */

/* Says on stderr what is wrong with a file or an argument. Returns 0, so that a failing function can end with it. */
static int complain(const char *what, const char *format, ...) {
    va_list args;
    va_start(args, format);
    fprintf(stderr, "render: %s: ", what);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    return 0;
}

/* ---- Environment: a map of radiance, row 0 around +z, and the table of mcsample.h that samples it ---- */

#define TILES 16u /* rows of tiles of product sampling */

typedef struct {
    hdr_picture map; /* at 4 bytes a texel most look-ups find theirs in the cache */
    mcs_env *table;
    mcs_tiles *tiles; /* for product sampling */
    float irradiance; /* luminance of the irradiance on level ground with nothing in the way */
    float main_light; /* azimuth */
} environment;

static vec3 radiance_at(const environment *e, unsigned col, unsigned row) {
    float c[3];
    hdr_color(&e->map, (size_t)row * e->map.w + col, c);
    return vec(c[0], c[1], c[2]);
}

static vec3 radiance(const environment *e, vec3 w) {
    mcs_texel l = mcs_env_texel(e->table, w);
    return radiance_at(e, l.col, l.row);
}

static hdr_pixel encode(vec3 c) {
    const float rgb[3] = {c.x, c.y, c.z};
    return hdr_encode(rgb);
}

/* In the map's own axes. */
static vec3 texel_direction(const environment *e, uint32_t x, uint32_t y) {
    const float theta = PI * ((float)y + 0.5f) / (float)e->map.h;
    const float phi = 2 * PI * ((float)x + 0.5f) / (float)e->map.w;
    return vec(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}

/* A clear late afternoon, for a run without a map: blue sky, pale horizon, brown ground, and a sun four degrees wide,
 * since the true half degree would be smaller than a texel. */
static int map_sky(environment *e, const char *name) {
    const vec3 zenith = {0.15f, 0.29f, 0.66f};
    const vec3 horizon = {0.95f, 0.98f, 1.06f};
    const vec3 soil = {0.16f, 0.13f, 0.11f};
    const vec3 sun = {1500, 1180, 800};
    const vec3 haze = {2.2f, 1.5f, 0.8f};
    const vec3 to_sun = unit(vec(1, 0, 0.70f));
    const float sun_cos = cosf(2 * PI / 180);
    const float edge = 0.3f * (1 - sun_cos);
    hdr_start(&e->map);
    e->map.w = 512;
    e->map.h = 256;
    e->map.pixel = malloc(512 * 256 * sizeof *e->map.pixel);
    if (!e->map.pixel) return complain(name, "not enough memory");
    for (uint32_t y = 0; y < e->map.h; y++) {
        for (uint32_t x = 0; x < e->map.w; x++) {
            const vec3 d = texel_direction(e, x, y);
            const float near_sun = dot(d, to_sun);
            const float disc = fminf(fmaxf((near_sun - sun_cos) / edge, 0), 1);
            vec3 c;
            if (d.z > 0) {
                c = mix(powf(1 - d.z, 4), zenith, horizon);
                c = add(c, scale(powf(fmaxf(near_sun, 0), 12), haze));
            } else {
                c = mix(expf(30 * d.z), soil, scale(0.6f, horizon));
            }
            e->map.pixel[(size_t)y * e->map.w + x] = encode(add(c, scale(disc, sun)));
        }
    }
    return 1;
}

/* What the camera wants to know of the map: how bright it makes the ground, and where its main light stands, which is
 * taken as the direction of the squared luminance of the upper half. */
static void map_survey(environment *e) {
    double lx = 0;
    double ly = 0;
    double irradiance = 0;
    for (unsigned y = 0; y < e->map.h / 2; y++) {
        const float area = 2 * PI / (float)e->map.w *
                           (cosf(PI * (float)y / (float)e->map.h) - cosf(PI * (float)(y + 1) / (float)e->map.h));
        for (unsigned x = 0; x < e->map.w; x++) {
            const vec3 d = mcs_to_world(&e->table->frame, texel_direction(e, x, y));
            const double l = luminance(radiance_at(e, x, y));
            lx += l * l * area * d.x;
            ly += l * l * area * d.y;
            irradiance += l * area * d.z;
        }
    }
    e->irradiance = (float)irradiance;
    e->main_light = (float)atan2(ly, lx);
}

static int environment_make(environment *e, const char *map) {
    const char *name = map ? map : "built-in sky";
    if (!map && !map_sky(e, name)) return 0;
    if (map && !hdr_read(&e->map, map)) return complain(name, "%s", e->map.fault);
    const unsigned w = e->map.w;
    const unsigned h = e->map.h;
    size_t bytes = mcs_env_bytes(w, h);
    if (bytes == 0) return complain(name, "%u x %u texels are more than a sampling table takes", w, h);
    e->table = malloc(bytes);
    float *pixel;
    pixel = malloc((size_t)w * h * sizeof *pixel);
    if (!e->table || !pixel) {
        free(pixel);
        return complain(name, "not enough memory for the sampling table");
    }
    for (size_t i = 0; i < (size_t)w * h; i++)
        pixel[i] = luminance(radiance_at(e, (unsigned)(i % w), (unsigned)(i / w)));
    const mcs_image image = mcs_image_make(pixel, w, h, 1);
    int status = mcs_env_build(e->table, bytes, &image);
    free(pixel);
    if (status != MCS_OK) return complain(name, "no sampling table (status %d)", status);
    if (!(e->table->total > 0)) return complain(name, "the map is black: there is nothing to light the scene with");
    if (map)
        e->table->frame.t =
            vec(0, -1, 0); /* columns of a panorama run clockwise seen from above, azimuth the other way */
    map_survey(e);
    bytes = mcs_tiles_bytes(e->table, TILES);
    e->tiles = malloc(bytes);
    if (!e->tiles) return complain(name, "not enough memory for the tiles");
    status = mcs_tiles_build(e->tiles, bytes, e->table, TILES);
    return status == MCS_OK ? 1 : complain(name, "no tiles (status %d)", status);
}

/* ---- Materials: a matte base, a lobe, or both ---- */

typedef enum { MATTE, PHONG, WARD, GGX_VISIBLE, GGX_BOUNDED, ASHIKHMIN } lobe_kind;

typedef struct {
    lobe_kind kind;
    union { /* prepared once by the _make functions, then only read */
        mcs_phong phong;
        mcs_ward ward;
        mcs_ggx ggx;
        mcs_ashikhmin ashikhmin;
    } lobe;
    vec3 base;     /* albedo of the matte base */
    vec3 specular; /* reflectance of the lobe, for microfacets at normal incidence */
    float p_lobe;  /* probability that BRDF sampling takes the lobe: 0 matte, 1 no base */
    float share; /* BRDF samples of MIS for each environment sample: few where the lobe is so wide that all is found */

    float alpha_x, alpha_y; /* as product sampling is told */
    mcs_profile profile;
} material;

static mcs_brdf lobe_sample(const material *m, vec3 wo, float u1, float u2) {
    switch (m->kind) {
    case PHONG: return mcs_phong_sample(&m->lobe.phong, wo, u1, u2);
    case WARD: return mcs_ward_sample(&m->lobe.ward, wo, u1, u2);
    case GGX_VISIBLE: return mcs_ggx_vndf_sample(&m->lobe.ggx, wo, u1, u2);
    case GGX_BOUNDED: return mcs_ggx_bounded_sample(&m->lobe.ggx, wo, u1, u2);
    default: return mcs_ashikhmin_sample(&m->lobe.ashikhmin, wo, u1, u2);
    }
}

static float lobe_pdf(const material *m, vec3 wo, vec3 wi) {
    switch (m->kind) {
    case PHONG: return mcs_phong_pdf(&m->lobe.phong, wo, wi);
    case WARD: return mcs_ward_pdf(&m->lobe.ward, wo, wi);
    case GGX_VISIBLE: return mcs_ggx_vndf_pdf(&m->lobe.ggx, wo, wi);
    case GGX_BOUNDED: return mcs_ggx_bounded_pdf(&m->lobe.ggx, wo, wi);
    default: return mcs_ashikhmin_pdf(&m->lobe.ashikhmin, wo, wi);
    }
}

static float lobe_eval(const material *m, vec3 wo, vec3 wi) {
    switch (m->kind) {
    case PHONG: return mcs_phong_eval(&m->lobe.phong, wo, wi);
    case WARD: return mcs_ward_eval(&m->lobe.ward, wo, wi);
    case GGX_VISIBLE:
    case GGX_BOUNDED: return mcs_ggx_eval(&m->lobe.ggx, wo, wi);
    default: return mcs_ashikhmin_eval(&m->lobe.ashikhmin, wo, wi);
    }
}

/* Fresnel's factor, which the lobes of mcsample.h leave to the caller. Phong has no half-vector and a constant
 * reflectance. */
static vec3 fresnel(const material *m, vec3 wo, vec3 wi) {
    const float c = mcs_cos_d(wo, wi);
    if (m->kind == PHONG) return m->specular;
    return vec(mcs_schlick(m->specular.x, c), mcs_schlick(m->specular.y, c), mcs_schlick(m->specular.z, c));
}

/* f cos(theta_wi) */
static vec3 material_eval(const material *m, vec3 wo, vec3 wi) {
    vec3 f = {0, 0, 0};
    if (!(wi.z > 0 && wo.z > 0)) return f;
    if (m->p_lobe < 1) f = scale(1 / PI, m->base);
    if (m->p_lobe > 0) f = add(f, scale(lobe_eval(m, wo, wi), fresnel(m, wo, wi)));
    return scale(wi.z, f);
}

static float material_pdf(const material *m, vec3 wo, vec3 wi) {
    if (m->p_lobe <= 0) return mcs_cosine_pdf(wi);
    if (m->p_lobe >= 1) return lobe_pdf(m, wo, wi);
    return mcs_mix_pdf(m->p_lobe, lobe_pdf(m, wo, wi), mcs_cosine_pdf(wi));
}

typedef struct {
    vec3 wi;
    float pdf;   /* 0: the sample is lost; it still counts, with the value 0 */
    vec3 weight; /* f cos / pdf */
} bounce;

static bounce material_sample(const material *m, vec3 wo, float u_choice, float u1, float u2) {
    bounce b = {{0, 0, 1}, 0, {0, 0, 0}};
    if (u_choice < m->p_lobe) {
        mcs_brdf s = lobe_sample(m, wo, u1, u2);
        b.wi = s.wi;
        b.pdf = s.pdf;
        if (b.pdf > 0 && m->p_lobe >= 1) b.weight = scale(s.weight, fresnel(m, wo, s.wi)); /* closed form, no f / pdf */
    } else {
        const mcs_dir s = mcs_cosine_sample(u1, u2);
        b.wi = s.w;
        b.pdf = s.pdf;
        if (m->p_lobe <= 0) b.weight = m->base;
    }
    if (m->p_lobe > 0 && m->p_lobe < 1) {
        b.pdf = material_pdf(m, wo, b.wi);
        if (b.pdf > 0) b.weight = scale(1 / b.pdf, material_eval(m, wo, b.wi));
    }
    return b;
}

/* ---- Scene ---- */

#define SPHERES 8
#define NO_OBJECT (-1)
#define GROUND SPHERES /* index of the ground, the plane z = 0 */

typedef struct {
    vec3 center[SPHERES]; /* radius 1, resting on the ground */
    material of[SPHERES], tile[2];
    vec3 side, ahead;             /* level axes of the camera, of the row and of the tiles */
    vec3 eye, forward, right, up; /* right and up reach from the middle to the edges of the picture at distance 1 */
} scene;

typedef struct {
    const material *m;
    vec3 p, wo; /* world position; local direction to the eye */
    mcs_frame frame;
    int object;
} surface;

static material material_make(lobe_kind kind, float p_lobe, vec3 base, vec3 specular, float a, float b) {
    material m;
    memset(&m, 0, sizeof m);
    m.kind = kind;
    m.p_lobe = p_lobe;
    m.base = base;
    m.specular = specular;
    m.share = kind == MATTE ? 0.125f : 1;
    m.alpha_x = a;
    m.alpha_y = b;
    m.profile = kind == PHONG ? MCS_PROFILE_PHONG : MCS_PROFILE_GGX;
    if (kind == WARD || kind == ASHIKHMIN) m.profile = MCS_PROFILE_GAUSS;
    if (kind == PHONG)
        m.alpha_x = m.alpha_y = sqrtf(0.5f / (a + 2)); /* about the mirror direction: half that of a half-vector */
    if (kind == ASHIKHMIN) {
        m.alpha_x = sqrtf(2 / (a + 2));
        m.alpha_y = sqrtf(2 / (b + 2));
    }
    if (kind == PHONG) m.lobe.phong = mcs_phong_make(a);
    if (kind == WARD) m.lobe.ward = mcs_ward_make(a, b, MCS_WARD_GMD);
    if (kind == GGX_VISIBLE || kind == GGX_BOUNDED) m.lobe.ggx = mcs_ggx_make(a, b);
    if (kind == ASHIKHMIN) m.lobe.ashikhmin = mcs_ashikhmin_make(a, b);
    return m;
}

/* Seen with the main light of the map behind the camera at the left, where it models the spheres and stays out of the
 * picture. */
static scene scene_make(unsigned w, unsigned h, float main_light) {
    const vec3 none = {0, 0, 0};
    const vec3 gloss = {0.05f, 0.05f, 0.05f};
    const vec3 silver = {0.95f, 0.93f, 0.88f};
    const vec3 gold = {1.00f, 0.72f, 0.30f};
    const vec3 copper = {0.95f, 0.60f, 0.48f};
    const vec3 steel = {0.62f, 0.61f, 0.60f};
    const float half_width = 7.75f;
    const float distance = 26;
    const float elevation = 27 * PI / 180;
    const float azimuth = main_light - 118 * PI / 180;
    scene s;
    s.ahead = vec(cosf(azimuth), sinf(azimuth), 0);
    s.side = vec(s.ahead.y, -s.ahead.x, 0);
    for (int i = 0; i < SPHERES; i++)
        s.center[i] =
            add(vec(0, 0, 1), add(scale(1.82f * (float)i - 6.24f, s.side), scale(i % 2 ? 0.75f : -0.75f, s.ahead)));
    s.of[0] = material_make(MATTE, 0, vec(0.78f, 0.36f, 0.18f), none, 0, 0);
    s.of[1] = material_make(PHONG, 0.5f, vec(0.52f, 0.05f, 0.04f), vec(0.14f, 0.14f, 0.14f), 120, 0);
    s.of[2] = material_make(WARD, 1, none, copper, 0.18f, 0.18f);
    s.of[3] = material_make(WARD, 1, none, steel, 0.06f, 0.35f);
    s.of[4] = material_make(GGX_VISIBLE, 1, none, gold, 0.06f, 0.06f);
    s.of[5] = material_make(GGX_VISIBLE, 0.5f, vec(0.03f, 0.12f, 0.42f), gloss, 0.12f, 0.12f);
    s.of[6] = material_make(GGX_BOUNDED, 1, none, silver, 0.40f, 0.40f);
    s.of[7] = material_make(ASHIKHMIN, 0.5f, vec(0.04f, 0.26f, 0.12f), vec(0.12f, 0.14f, 0.10f), 15, 600);
    s.tile[0] = material_make(MATTE, 0, vec(0.38f, 0.35f, 0.31f), none, 0, 0);
    s.tile[1] = material_make(MATTE, 0, vec(0.25f, 0.22f, 0.19f), none, 0, 0);
    s.forward = add(scale(cosf(elevation), s.ahead), vec(0, 0, -sinf(elevation)));
    s.eye = sub(vec(0, 0, 0.66f), scale(distance, s.forward));
    s.right = scale(half_width / distance, s.side);
    s.up = scale((float)h / (float)w, cross(s.right, s.forward));
    return s;
}

/* Distance along a unit direction to the front of sphere i, or 0. */
static float hit_sphere(const scene *s, int i, vec3 p, vec3 w) {
    const vec3 d = sub(s->center[i], p);
    const float b = dot(d, w);
    const float disc = b * b - dot(d, d) + 1;
    return b > 0 && disc > 0 ? b - sqrtf(disc) : 0;
}

/* From a point on an object in the direction w above its surface. All objects are convex, so none shadows itself, and
 * everything stands above the ground, so the ground stops exactly the directions that point down. */
static int visible(const scene *s, vec3 p, vec3 w, int object) {
    if (w.z <= 0) return 0;
    for (int i = 0; i < SPHERES; i++)
        if (i != object && hit_sphere(s, i, p, w) > 0) return 0;
    return 1;
}

/* Spheres get tangents along their circles of latitude, as if turned on a lathe: the anisotropic ones need a direction.
 */
static mcs_frame sphere_frame(vec3 n) {
    if (n.x * n.x + n.y * n.y < 1e-8f) return mcs_frame_make(n);
    mcs_frame f;
    f.n = n;
    f.s = unit(vec(-n.y, n.x, 0));
    f.t = cross(n, f.s);
    return f;
}

static int intersect(const scene *s, vec3 p, vec3 w, surface *x) {
    float nearest = INFINITY;
    x->object = NO_OBJECT;
    if (w.z < 0) {
        nearest = -p.z / w.z;
        x->object = GROUND;
    }
    for (int i = 0; i < SPHERES; i++) {
        const float t = hit_sphere(s, i, p, w);
        if (t > 0 && t < nearest) {
            nearest = t;
            x->object = i;
        }
    }
    if (x->object == NO_OBJECT) return 0;
    x->p = add(p, scale(nearest, w));
    if (x->object == GROUND) {
        x->p.z = 0;
        x->frame = mcs_frame_make(vec(0, 0, 1));
        x->m = &s->tile[fmodf(floorf(0.5f * dot(x->p, s->side)) + floorf(0.5f * dot(x->p, s->ahead)), 2) != 0];
    } else {
        x->frame = sphere_frame(unit(sub(x->p, s->center[x->object])));
        x->m = &s->of[x->object];
    }
    x->wo = mcs_to_local(&x->frame, scale(-1, w));
    return 1;
}

/* ---- Direct illumination: each strategy estimates the integral of f L V cos over the hemisphere ---- */

typedef enum { UNIFORM, COSINE, BRDF, ENVIRONMENT, MIS, PRODUCT, STRATEGIES } strategy;
static const char *const strategy_name[STRATEGIES] = {"uniform", "cosine", "brdf", "env", "mis", "product"};

/* With mis, one half of a multi-sample estimator with the power heuristic (Veach and Guibas, "Optimally combining
 * sampling techniques", 1995); without, an estimator by itself. Likewise the environment. */
static vec3 sample_brdf(const scene *s, const environment *e, const surface *x, int mis, mcs_pcg32 *rng) {
    const float u0 = mcs_pcg32_float(rng);
    const float u1 = mcs_pcg32_float(rng);
    const float u2 = mcs_pcg32_float(rng);
    bounce b = material_sample(x->m, x->wo, u0, u1, u2);
    const vec3 w = mcs_to_world(&x->frame, b.wi);
    if (!(b.pdf > 0 && visible(s, x->p, w, x->object))) return vec(0, 0, 0);
    mcs_texel l = mcs_env_texel(e->table, w);
    const vec3 value = mul(b.weight, radiance_at(e, l.col, l.row));
    return mis ? scale(mcs_mis_power(x->m->share * b.pdf, l.pdf) / x->m->share, value) : value;
}

static vec3 sample_environment(const scene *s, const environment *e, const surface *x, int mis, mcs_pcg32 *rng) {
    const float u1 = mcs_pcg32_float(rng);
    const float u2 = mcs_pcg32_float(rng);
    mcs_texel l = mcs_env_sample(e->table, u1, u2);
    const vec3 wi = mcs_to_local(&x->frame, l.w);
    if (!(l.pdf > 0 && wi.z > 0 && visible(s, x->p, l.w, x->object))) return vec(0, 0, 0);
    const vec3 value = scale(1 / l.pdf, mul(material_eval(x->m, x->wo, wi), radiance_at(e, l.col, l.row)));
    return mis ? scale(mcs_mis_power(l.pdf, x->m->share * material_pdf(x->m, x->wo, wi)), value) : value;
}

static vec3 sample_hemisphere(const scene *s, const environment *e, const surface *x, int cosine, mcs_pcg32 *rng) {
    const float u1 = mcs_pcg32_float(rng);
    const float u2 = mcs_pcg32_float(rng);
    const mcs_dir d = cosine ? mcs_cosine_sample(u1, u2) : mcs_hemisphere_sample(u1, u2);
    const vec3 w = mcs_to_world(&x->frame, d.w);
    if (!(d.pdf > 0 && visible(s, x->p, w, x->object))) return vec(0, 0, 0);
    mcs_texel l = mcs_env_texel(e->table, w);
    return scale(1 / d.pdf, mul(material_eval(x->m, x->wo, d.w), radiance_at(e, l.col, l.row)));
}

/* What product sampling is told of a surface; Fresnel's factor as the mirror direction has it. */
static mcs_reflection reflection_of(const surface *x, uint32_t draws) {
    const material *m = x->m;
    const float base = m->p_lobe < 1 ? luminance(m->base) : 0;
    float lobe = 0;
    if (m->p_lobe > 0) lobe = m->kind == PHONG ? luminance(m->specular) : mcs_schlick(luminance(m->specular), x->wo.z);
    mcs_reflection r;
    r.frame = x->frame;
    r.wo = x->wo;
    r.alpha_x = m->alpha_x;
    r.alpha_y = m->alpha_y;
    r.matte = base / (base + lobe);
    r.profile = m->profile;
    r.draws = draws;
    return r;
}

/* The value of a light sample: radiance times f cos over the density. */
static vec3 product_value(const scene *s, const environment *e, const surface *x, mcs_texel l) {
    const vec3 wi = mcs_to_local(&x->frame, l.w);
    if (!(l.pdf > 0 && wi.z > 0 && visible(s, x->p, l.w, x->object))) return vec(0, 0, 0);
    return scale(1 / l.pdf, mul(material_eval(x->m, x->wo, wi), radiance_at(e, l.col, l.row)));
}

/* A table for the point; then samples, a block at a time. */
static vec3 sample_product(const scene *s, const environment *e, const surface *x, uint32_t lights, mcs_pcg32 *rng) {
    enum { BLOCK = 32 };
    union {
        mcs_product p;
        char room[MCS_PRODUCT_BYTES(TILES)];
    } point;
    const mcs_reflection r = reflection_of(x, lights);
    vec3 sum = {0, 0, 0};
    if (mcs_product_build(&point.p, sizeof point, e->tiles, e->table, &r, NULL) != MCS_OK) return sum;
    uint32_t n;
    for (; lights > 0; lights -= n) {
        n = lights < BLOCK ? lights : BLOCK;
        float u1[BLOCK];
        mcs_pcg32_fill_n(rng, n, u1);
        float u2[BLOCK];
        mcs_pcg32_fill_n(rng, n, u2);
        float wx[BLOCK], wy[BLOCK], wz[BLOCK], pdf[BLOCK];
        uint32_t col[BLOCK], row[BLOCK];
        mcs_product_sample_n(&point.p, e->tiles, e->table, n, u1, u2, wx, wy, wz, pdf, col, row);
        for (uint32_t i = 0; i < n; i++) {
            mcs_texel l;
            l.w = vec(wx[i], wy[i], wz[i]);
            l.pdf = pdf[i];
            l.col = col[i];
            l.row = row[i];
            sum = add(sum, product_value(s, e, x, l));
        }
    }
    return sum;
}

/* The mean of so many estimates; *drawn counts the light samples. */
static vec3 direct(const scene *s, const environment *e, const surface *x, strategy how, uint32_t lights,
                   mcs_pcg32 *rng, uint32_t *drawn) {
    vec3 sum = {0, 0, 0};
    *drawn += lights;
    if (how == PRODUCT) return scale(1 / (float)lights, sample_product(s, e, x, lights, rng));
    for (uint32_t i = 0; i < lights; i++) {
        switch (how) {
        case BRDF: sum = add(sum, sample_brdf(s, e, x, 0, rng)); break;
        case ENVIRONMENT: sum = add(sum, sample_environment(s, e, x, 0, rng)); break;
        case MIS:
            if (x->m->share == 1 || mcs_pcg32_float(rng) < x->m->share) {
                sum = add(sum, sample_brdf(s, e, x, 1, rng));
                ++*drawn;
            }
            sum = add(sum, sample_environment(s, e, x, 1, rng));
            break;
        default: sum = add(sum, sample_hemisphere(s, e, x, how == COSINE, rng));
        }
    }
    return scale(1 / (float)lights, sum);
}

/* ---- Rendering ---- */

#define PASS 16 /* samples per pixel between two looks at the error; 1 with --seconds */

typedef struct {
    unsigned w, h, spp, lights;
    double seconds; /* of processor time after which to stop, 0: take spp samples */
    double error;   /* relative standard error of the mean at which to stop, 0: take spp samples */
    uint64_t seed;
    int help, threads, wanted[STRATEGIES];
    float stops;
    const char *out, *map, *stack;
} options;

typedef struct {
    mcs_pcg32 rng;
    vec3 sum;
    mcs_stat luminance; /* of this pixel's samples */
    uint32_t drawn;     /* light samples */
    int object;         /* that all samples hit, or NO_OBJECT */
} pixel;

typedef struct {
    unsigned spp;
    double samples, wall, cpu; /* light samples; seconds on the clock, and of all threads together */
    double mean, error;        /* of the luminance of the picture; the standard error of that mean, INFINITY: unknown */
    double mse[SPHERES + 1];   /* mean squared error of a pixel, by object */
} outcome;

typedef struct {
    const char *what;
    double start, last, rows, done; /* seconds; rows of all passes, -1 where nobody watches */
} progress;

static double seconds(clockid_t clock_id) {
    struct timespec t;
    clock_gettime(clock_id, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void progress_row(progress *p) {
    if (p->rows < 0) return;
    OMP(omp critical(progress)) {
        const double now = seconds(CLOCK_MONOTONIC);
        p->done++;
        if (now - p->last > 0.2) {
            p->last = now;
            fprintf(stderr, "\r%-8s row %.0f of %.0f, %.0f s left \033[K", p->what, p->done, p->rows,
                    fmax(0, (now - p->start) * (p->rows / p->done - 1)));
        }
    }
}

static void render_row(const options *o, const scene *s, const environment *e, strategy how, uint32_t y, uint32_t n,
                       pixel *row) {
    for (uint32_t x = 0; x < o->w; x++) {
        pixel *p = row + x;
        for (uint32_t i = 0; i < n; i++) {
            const float px =
                2 * ((float)x + mcs_pcg32_float(&p->rng)) / (float)o->w - 1; /* a box filter: anywhere in the pixel */
            const float py = 1 - 2 * ((float)y + mcs_pcg32_float(&p->rng)) / (float)o->h;
            const vec3 w = unit(add(s->forward, add(scale(px, s->right), scale(py, s->up))));
            surface at;
            const vec3 c =
                intersect(s, s->eye, w, &at) ? direct(s, e, &at, how, o->lights, &p->rng, &p->drawn) : radiance(e, w);
            p->object = p->luminance.n > 0 && at.object != p->object ? NO_OBJECT : at.object;
            p->sum = add(p->sum, c);
            mcs_stat_add(&p->luminance, luminance(c));
        }
    }
}

/* The pixels are strata of equal size, each with its own independent samples: the variance of the mean of the picture
 * is the sum of the variances of the pixel means over the square of their number. What differs between pixels is
 * picture, not error. As with any estimate: where samples hardly ever find a small bright light, both the mean and its
 * error come out low until they do. */
static void picture_statistics(const pixel *p, size_t n, outcome *r) {
    double variance = 0;
    double count[SPHERES + 1] = {0};
    r->mean = r->samples = 0;
    memset(r->mse, 0, sizeof r->mse);
    for (size_t i = 0; i < n; i++) {
        const double e = mcs_stat_error(&p[i].luminance);
        r->mean += p[i].luminance.mean;
        r->samples += p[i].drawn;
        variance += e * e;
        if (p[i].object != NO_OBJECT) {
            r->mse[p[i].object] += e * e;
            count[p[i].object]++;
        }
    }
    for (int k = 0; k <= SPHERES; k++) r->mse[k] /= fmax(count[k], 1);
    r->mean /= (double)n;
    r->error = r->spp > 1 ? sqrt(variance) / (double)n : INFINITY; /* one sample tells nothing of its error */
}

/* Every pixel has its own stream, seeded from (seed, pixel, strategy), and owns all that it
 * changes: the picture does not depend on the number of threads. */
static outcome render(const options *o, const scene *s, const environment *e, strategy how, pixel *image) {
    const size_t pixels = (size_t)o->w * o->h;
    outcome r = {0, 0, 0, 0, 0, 0, {0}};
    const unsigned pass = o->seconds > 0 ? 1 : PASS;
    progress p = {strategy_name[how], seconds(CLOCK_MONOTONIC), 0, o->h * ceil(o->spp / (double)pass), 0};
    const double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    const int watched = isatty(fileno(stderr));
    if (!watched) p.rows = -1;
    for (size_t i = 0; i < pixels; i++) {
        memset(&image[i], 0, sizeof image[i]);
        image[i].rng = mcs_pcg32_for(o->seed, i, how);
    }
    while (r.spp < o->spp && !(o->error > 0 && r.spp > 0 && r.error <= o->error * r.mean) &&
           !(o->seconds > 0 && r.spp > 1 && r.cpu >= o->seconds)) {
        const uint32_t n = o->spp - r.spp < pass ? o->spp - r.spp : pass;
        OMP(omp parallel for schedule(dynamic) num_threads(o->threads))
        for (int y = 0; y < (int)o->h; y++) {
            render_row(o, s, e, how, (uint32_t)y, n, image + (size_t)y * o->w);
            progress_row(&p);
        }
        r.spp += n;
        picture_statistics(image, pixels, &r);
        if (watched && o->error > 0 && r.mean > 0) /* the error falls with the root of the samples */
            p.rows = fmin(p.rows, p.done * fmax(1, pow(r.error / (o->error * r.mean), 2)));
        r.cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
        if (watched && o->seconds > 0) p.rows = fmin(p.rows, p.done * fmax(1, o->seconds / r.cpu));
    }
    if (watched) fputs("\r\033[K", stderr);
    r.wall = seconds(CLOCK_MONOTONIC) - p.start;
    return r;
}

/* ---- Writing pictures ---- */

static vec3 pixel_color(const pixel *p) { return scale(1 / (float)p->luminance.n, p->sum); }

static int file_close(FILE *f, const char *name) {
    const int bad = ferror(f);
    if (fclose(f) != 0 || bad) return complain(name, "cannot write: %s", strerror(errno));
    return 1;
}

static int hdr_write(const char *name, const pixel *image, unsigned w, unsigned h) {
    FILE *f = fopen(name, "wb");
    if (!f) return complain(name, "%s", strerror(errno));
    hdr_write_header(f, w, h);
    for (size_t i = 0; i < (size_t)w * h; i++) {
        const hdr_pixel p = encode(pixel_color(&image[i]));
        fwrite(p.c, 1, 4, f);
    }
    return file_close(f, name);
}

/* Exposure, a filmic curve without hard clipping (Narkowicz, "ACES filmic tone mapping curve", 2015), sRGB coding, 8
 * bits. */
static unsigned char display(float linear, float exposure) {
    const float x = fminf(linear * exposure, 1e4f);
    const float y = fminf(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 1);
    return (unsigned char)(255 * (y <= 0.0031308f ? 12.92f * y : 1.055f * powf(y, 1 / 2.4f) - 0.055f) + 0.5f);
}

#define SYMBOLS 257 /* 256 bytes and the end of the block */

/* Lengths of a prefix code for n bytes counted: Shannon's lengths, then shortened until the code is complete, as
 * deflate wants it. No count is taken as less than n / 8192, which keeps the lengths at 14 bits and below. */
static void code_lengths(const uint32_t *count, size_t n, unsigned char *length) {
    const uint64_t total = n + SYMBOLS * (n / 8192 + 1);
    uint32_t used = 0; /* sum of 2^(15 - length): 2^15 when complete */
    for (uint32_t i = 0; i < SYMBOLS; i++) {
        for (length[i] = 1; (count[i] + n / 8192 + 1) << length[i] < total;) length[i]++;
        used += 1u << (15 - length[i]);
    }
    for (uint32_t i = 0; used < 1u << 15; i = (i + 1) % SYMBOLS)
        if (used + (1u << (15 - length[i])) <= 1u << 15) used += 1u << (15 - length[i]--);
}

typedef struct {
    unsigned char *at;
    uint32_t bits, n;
} bit_writer;

static void put_bits(bit_writer *b, uint32_t value, uint32_t n) {
    b->bits |= value << b->n;
    for (b->n += n; b->n >= 8; b->n -= 8) {
        *b->at++ = (unsigned char)b->bits;
        b->bits >>= 8;
    }
}

static void put_code(bit_writer *b, uint32_t code, uint32_t n) { /* codes go out highest bit first */
    uint32_t reversed = 0;
    for (uint32_t i = 0; i < n; i++) reversed |= (code >> i & 1) << (n - 1 - i);
    put_bits(b, reversed, n);
}

static unsigned char *put_u32(unsigned char *at, uint32_t v) {
    *at++ = (unsigned char)(v >> 24);
    *at++ = (unsigned char)(v >> 16);
    *at++ = (unsigned char)(v >> 8);
    *at++ = (unsigned char)v;
    return at;
}

/* zlib stream (RFC 1950) of one deflate block (RFC 1951) with its own prefix code and no matches: a rendered picture
 * has hardly any repetition to match, but its filtered bytes are far from evenly spread. `out` has room for 2 n + 1024
 * bytes. */
static size_t zlib_pack(const unsigned char *data, size_t n, unsigned char *out) {
    uint32_t count[SYMBOLS] = {0};
    uint32_t next = 0;
    uint32_t s1 = 1;
    uint32_t s2 = 0;
    bit_writer b = {NULL, 0, 0};
    b.at = out;
    for (size_t i = 0; i < n; i++) {
        count[data[i]]++;
        s1 = (s1 + data[i]) % 65521;
        s2 = (s2 + s1) % 65521; /* Adler-32 */
    }
    unsigned char length[SYMBOLS];
    code_lengths(count, n, length);
    uint32_t code[SYMBOLS];
    for (uint32_t bits = 1; bits <= 15; bits++, next <<= 1)
        for (size_t i = 0; i < SYMBOLS; i++)
            if (length[i] == bits) code[i] = next++;
    put_bits(&b, 0x0178, 16);    /* zlib: deflate, 32 KiB window */
    put_bits(&b, 1 | 2 << 1, 3); /* the last block; its own codes */
    put_bits(&b, 0, 10);
    put_bits(&b, 15, 4); /* 257 byte codes, 1 distance code, all 19 length codes: */
    for (size_t i = 0; i < 19; i++)
        put_bits(&b, i < 3 ? 0 : 4, 3); /* 16-18 unused, so that 0-15 are themselves in 4 bits */
    for (size_t i = 0; i < SYMBOLS; i++) put_code(&b, length[i], 4);
    put_code(&b, 0, 4); /* no distances */
    for (size_t i = 0; i < n; i++) put_code(&b, code[data[i]], length[data[i]]);
    put_code(&b, code[SYMBOLS - 1], length[SYMBOLS - 1]);
    put_bits(&b, 0, 7);
    return (size_t)(put_u32(b.at, s2 << 16 | s1) - out);
}

static void png_chunk(FILE *f, const char *type, const unsigned char *data, size_t n) {
    uint32_t crc = 0xffffffffu;
    unsigned char head[8];
    memcpy(put_u32(head, (uint32_t)n), type, 4);
    for (size_t i = 4; i < n + 8; i++) { /* over the type and the data */
        crc ^= i < 8 ? head[i] : data[i - 8];
        for (int k = 0; k < 8; k++) crc = crc >> 1 ^ (0xedb88320u & (0u - (crc & 1)));
    }
    unsigned char tail[4];
    put_u32(tail, ~crc);
    fwrite(head, 1, 8, f);
    fwrite(data, 1, n, f);
    fwrite(tail, 1, 4, f);
}

static int png_write(const char *name, const pixel *image, unsigned w, unsigned h, float exposure) {
    const size_t stride = (size_t)w * 3;
    const size_t raw_size = (stride + 1) * h;
    unsigned char *rows = calloc(2, stride);
    unsigned char *raw = malloc(raw_size);
    unsigned char *packed = malloc(2 * raw_size + 1024);
    FILE *f = rows && raw && packed ? fopen(name, "wb") : NULL;
    int ok = f ? 1 : complain(name, "%s", strerror(errno));
    for (size_t y = 0; ok && y < h; y++) { /* PNG's average filter: the one that suits pictures with noise */
        unsigned char *row = rows + (y & 1) * stride;
        unsigned char *above = rows + (~y & 1) * stride;
        unsigned char *out = raw + y * (stride + 1);
        for (size_t x = 0; x < w; x++) {
            vec3 c = pixel_color(&image[y * w + x]);
            row[3 * x] = display(c.x, exposure);
            row[3 * x + 1] = display(c.y, exposure);
            row[3 * x + 2] = display(c.z, exposure);
        }
        *out++ = 3;
        for (size_t x = 0; x < stride; x++)
            out[x] = (unsigned char)(row[x] - ((x < 3 ? 0 : row[x - 3]) + above[x]) / 2);
    }
    if (ok) {
        fwrite("\211PNG\r\n\032\n", 1, 8, f);
        unsigned char head[13];
        memcpy(put_u32(put_u32(head, w), h), "\10\2\0\0\0", 5); /* 8 bits, RGB, not interlaced */
        png_chunk(f, "IHDR", head, 13);
        png_chunk(f, "IDAT", packed, zlib_pack(raw, raw_size, packed));
        png_chunk(f, "IEND", head, 0);
        ok = file_close(f, name);
    }
    free(rows);
    free(raw);
    free(packed);
    return ok;
}

static float exposure_for(const options *o, const environment *e) {
    return (e->irradiance > 0 ? 0.9f * PI / e->irradiance : 1) * exp2f(o->stops);
}

/* The caller frees the name. Returns NULL after a complaint. */
static char *picture_name(const options *o, strategy how, const char *extension) {
    const size_t size = strlen(o->out) + strlen(strategy_name[how]) + strlen(extension) + 2;
    char *name = malloc(size);
    if (name) snprintf(name, size, "%s-%s%s", o->out, strategy_name[how], extension);
    else complain(o->out, "not enough memory");
    return name;
}

static int write_pictures(const options *o, strategy how, const environment *e, const pixel *image) {
    char *png = picture_name(o, how, ".png");
    char *hdr = picture_name(o, how, ".hdr");
    const int ok =
        png && hdr && png_write(png, image, o->w, o->h, exposure_for(o, e)) && hdr_write(hdr, image, o->w, o->h);
    free(png);
    free(hdr);
    return ok;
}

/* Whether a file can be written, asked before the time is spent on what goes into it. What was in it stays for now. */
static int can_write(const char *name) {
    struct stat status;
    const int exists = lstat(name, &status) == 0; /* if only as a link to nothing */
    if (stat(name, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
        return 1; /* a device or a pipe */
    FILE *f = fopen(name, "ab");
    if (!f) return complain(name, "cannot write: %s", strerror(errno));
    fclose(f);
    if (!exists) remove(name);
    return 1;
}

static int can_write_pictures(const options *o) {
    int ok = !o->stack || can_write(o->stack);
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        char *png = picture_name(o, (strategy)i, ".png");
        char *hdr = picture_name(o, (strategy)i, ".hdr");
        ok = png && hdr && can_write(png) && can_write(hdr);
        free(png);
        free(hdr);
    }
    return ok;
}

/* ---- The command ---- */

/* Sends what has been printed on its way: to a file or a pipe nothing would go before the end, and nothing at all after
 * Ctrl-C. */
static int flush_output(void) {
    if (fflush(stdout) != 0 || ferror(stdout)) return complain("standard output", "cannot write: %s", strerror(errno));
    return 1;
}

static void usage(void) {
    fputs("usage: render [options] [map.hdr]     (--option value or --option=value)\n"
          "Spheres under a Radiance environment map (row 0 up), or under a built-in sky with a sun.\n"
          "  --strategy LIST    uniform, cosine, brdf, env, mis, product, several with commas, or all (mis)\n"
          "  --spp N            samples per pixel (64; with --error or --seconds: at most N, 16384); 1 leaves the "
          "error unknown\n"
          "  --lights N         estimates of the light at each point that a sample sees (1)\n"
          "  --seconds T        stop each strategy after T seconds of processor time: pictures of equal cost\n"
          "  --error E          stop when the standard error of the mean of the picture is E times the mean\n"
          "  --size WxH         size of the picture (960x320)\n"
          "  --stops X          brighten the PNG by X stops from what suits the map (0)\n"
          "  --out PREFIX       write PREFIX-STRATEGY.png and PREFIX-STRATEGY.hdr (render)\n"
          "  --stack FILE       write all pictures into one PNG too, one below the other\n"
          "  --threads N        threads (all processors; one if built without OpenMP); the picture does not depend on "
          "it\n"
          "  --seed N           another set of random numbers (1)\n"
          "  -h, --help         this text\n"
          "The exit status is 0, 2 for a wrong argument, 1 if anything else fails or the error is not reached.\n"
          "The camera has the main light of the map behind it at the left.\n"
          "examples/product.png: render --strategy mis,product --lights 16 --seconds 2 --size 480x160 --threads 1\n"
          "    --out build/product --stack examples/product.png\n",
          stdout);
}

/* The shortest decimal text of a number without an exponent. */
static const char *plain(double v, char text[64]) {
    int digits = 0;
    do snprintf(text, 64, "%.*f", digits, v);
    while (strtod(text, NULL) != v && digits++ < 20);
    return text;
}

static int parse_name(const char *name, const char *text, const char **value) {
    if (!*text) return complain(name, "the name is empty");
    *value = text;
    return 1;
}

static int parse_size(const char *text, options *o) {
    char more;
    if (sscanf(text, "%6ux%6u%c", &o->w, &o->h, &more) != 2)
        return complain("--size", "'%s' is not WIDTHxHEIGHT", text);
    if (o->w - 1 < 16384 && o->h - 1 < 16384 && o->w * o->h <= 1u << 25) return 1;
    return complain("--size", "each side is from 1 to 16384, with at most %u pixels in all", 1u << 25);
}

static int parse_strategies(const char *list, options *o) {
    memset(o->wanted, 0, sizeof o->wanted);
    for (;;) {
        const size_t n = strcspn(list, ",");
        int known = 0;
        for (int i = 0; i < STRATEGIES; i++)
            if ((n == 3 && !strncmp(list, "all", 3)) ||
                (n == strlen(strategy_name[i]) && !strncmp(list, strategy_name[i], n)))
                known = o->wanted[i] = 1;
        if (!known)
            return complain("--strategy", "'%.*s' is none of uniform, cosine, brdf, env, mis, product, all", (int)n,
                            list);
        if (!list[n]) return 1;
        list += n + 1;
    }
}

typedef enum {
    O_STRATEGY,
    O_SIZE,
    O_OUT,
    O_STACK,
    O_SPP,
    O_LIGHTS,
    O_SECONDS,
    O_ERROR,
    O_STOPS,
    O_THREADS,
    O_SEED,
    OPTIONS
} option;
static const struct {
    const char *name;
    double low, high; /* of numbers */
    int whole;
} option_table[OPTIONS] = {{"--strategy", 0, 0, 0},     {"--size", 0, 0, 0},     {"--out", 0, 0, 0},
                           {"--stack", 0, 0, 0},        {"--spp", 1, 1e6, 1},    {"--lights", 1, 4096, 1},
                           {"--seconds", 1e-3, 1e6, 0}, {"--error", 1e-7, 1, 0}, {"--stops", -20, 20, 0},
                           {"--threads", 1, 1024, 1},   {"--seed", 0, 9e15, 1}};

static int parse_number(option which, const char *text, double *value) {
    const double low = option_table[which].low;
    const double high = option_table[which].high;
    const int whole = option_table[which].whole;
    errno = 0;
    char *end;
    *value = strtod(text, &end);
    if (end != text && !*end && !errno && *value >= low && *value <= high && (!whole || *value == floor(*value)))
        return 1;
    char from[64], to[64];
    return complain(option_table[which].name, "'%s' is not a %s from %s to %s", text, whole ? "whole number" : "number",
                    plain(low, from), plain(high, to));
}

static int parse_value(option which, const char *text, options *o) {
    switch (which) {
    case O_STRATEGY: return parse_strategies(text, o);
    case O_SIZE: return parse_size(text, o);
    case O_OUT: return parse_name(option_table[which].name, text, &o->out);
    case O_STACK: return parse_name(option_table[which].name, text, &o->stack);
    default: break;
    }
    double v;
    if (!parse_number(which, text, &v)) return 0;
    switch (which) {
    case O_SPP: o->spp = (uint32_t)v; break;
    case O_LIGHTS: o->lights = (uint32_t)v; break;
    case O_SECONDS: o->seconds = v; break;
    case O_ERROR: o->error = v; break;
    case O_STOPS: o->stops = (float)v; break;
    case O_THREADS: o->threads = (int)v; break;
    default: o->seed = (uint64_t)v;
    }
    return 1;
}

/* The option that an argument names, alone or with =value. OPTIONS: none. */
static option find_option(const char *argument) {
    const size_t n = strcspn(argument, "=");
    int i = 0;
    while (i < OPTIONS && !(strlen(option_table[i].name) == n && !strncmp(argument, option_table[i].name, n))) i++;
    return (option)i;
}

/* Returns 0 for a wrong argument. */
static int parse_arguments(int argc, char **argv, options *o) {
    memset(o, 0, sizeof *o);
    o->w = 960;
    o->h = 320;
    o->seed = 1;
    o->lights = 1;
    o->wanted[MIS] = 1;
    o->out = "render";
    for (int i = 1; i < argc; i++) {
        const option which = find_option(argv[i]);
        const char *text = strchr(argv[i], '=');
        if (!strcmp(argv[i], "-h") || !strcmp(argv[i], "--help")) return o->help = 1;
        if (argv[i][0] != '-') {
            if (o->map) return complain(argv[i], "only one map can be given");
            if (!parse_name("map", argv[i], &o->map)) return 0;
            continue;
        }
        if (which == OPTIONS) return complain(argv[i], "unknown option; --help lists them");
        if (!text && i + 1 == argc) return complain(argv[i], "its value is missing");
        if (!parse_value(which, text ? text + 1 : argv[++i], o)) return 0;
    }
    if (!o->spp) o->spp = o->error > 0 || o->seconds > 0 ? 16384 : 64;
#ifdef _OPENMP
    if (!o->threads) o->threads = omp_get_max_threads();
#else
    o->threads = 1;
#endif
    return 1;
}

static double efficiency(const outcome *r) {
    return r->error > 0 && r->cpu > 0 ? 1 / (r->error * r->error * r->cpu) : 0;
}

static void print_head(void) { puts("strategy  spp     samples    wall s   cpu s       mean  std error  efficiency"); }

static void print_row(strategy how, const outcome *r) {
    printf("%-8s%5u  %10.0f  %8.2f  %6.2f  %9.6g", strategy_name[how], r->spp, r->samples, r->wall, r->cpu, r->mean);
    if (r->spp > 1) printf("  %9.3g  %10.4g\n", r->error, efficiency(r));
    else printf("  %9s  %10s\n", "unknown", "unknown");
}

static void print_comparison(const options *o, const outcome *result) {
    int best = -1;
    for (int i = 0; i < STRATEGIES; i++)
        if (o->wanted[i] && (best < 0 || efficiency(&result[i]) > efficiency(&result[best]))) best = i;
    puts("\nstrategy  of best  deviation");
    for (int i = 0; i < STRATEGIES; i++) {
        const outcome *r = &result[i];
        const outcome *b = &result[best];
        if (!o->wanted[i]) continue;
        printf("%-8s  %7.3f  %9.2f\n", strategy_name[i], efficiency(b) > 0 ? efficiency(r) / efficiency(b) : 1,
               i != best ? (r->mean - b->mean) / fmax(hypot(r->error, b->error), 1e-300) : 0);
    }
    puts("of best: efficiency over the highest;\n"
         "deviation: from the mean of the most efficient, in standard errors of the difference");
}

/* Over the pixels that show nothing but that object. */
static void print_objects(const options *o, const outcome *result) {
    static const char *const name[] = {"matte",  "Phong",  "Ward.18", "Ward ani", "GGX.06",
                                       "GGX.12", "GGX.40", "A.-S.",   "ground"};
    printf("\nmean squared error of a pixel x cpu s, over that of mis\nstrategy");
    for (int k = 0; k <= SPHERES; k++) printf(" %9s", name[k]);
    putchar('\n');
    for (int i = 0; i < STRATEGIES; i++) {
        if (!o->wanted[i] || i == MIS) continue;
        printf("%-8s", strategy_name[i]);
        for (int k = 0; k <= SPHERES; k++) {
            const double mis = result[MIS].mse[k] * result[MIS].cpu;
            printf(" %9.3g", mis > 0 ? result[i].mse[k] * result[i].cpu / mis : 0);
        }
        putchar('\n');
    }
}

int main(int argc, char **argv) {
    unsigned shown = 0;
    unsigned count = 0;
    options o;
    if (!parse_arguments(argc, argv, &o)) return 2;
    if (o.help) {
        usage();
        return flush_output() ? 0 : 1;
    }
    if (!can_write_pictures(&o)) return 1;
    environment e;
    memset(&e, 0, sizeof e);
    for (int i = 0; i < STRATEGIES; i++) count += o.wanted[i] != 0;
    const size_t pixels = (size_t)o.w * o.h;
    pixel *image;
    image = malloc((o.stack ? count : 1) * pixels * sizeof *image); /* a stack needs all of them at once */
    int ok = image ? environment_make(&e, o.map) : complain("--size", "not enough memory for the picture");
    const scene s = scene_make(o.w, o.h, e.main_light);
    if (ok) {
        printf("%s %u x %u, picture %u x %u, %d thread%s\n", o.map ? o.map : "built-in sky", e.map.w, e.map.h, o.w, o.h,
               o.threads, o.threads > 1 ? "s" : "");
        print_head();
        ok = flush_output();
    }
    outcome result[STRATEGIES];
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o.wanted[i]) continue;
        result[i] = render(&o, &s, &e, (strategy)i, image + (o.stack ? shown : 0) * pixels);
        print_row((strategy)i, &result[i]);
        ok = flush_output() && write_pictures(&o, (strategy)i, &e, image + (o.stack ? shown++ : 0) * pixels);
    }
    if (ok) puts("samples: light samples; efficiency: 1 / (std error^2 x cpu s)");
    if (ok && count > 1 && o.spp > 1) print_comparison(&o, result);
    if (ok && count > 1 && o.spp > 1 && o.wanted[MIS]) print_objects(&o, result);
    ok = ok && flush_output() && (!o.stack || png_write(o.stack, image, o.w, shown * o.h, exposure_for(&o, &e)));
    char error[64];
    for (int i = 0; ok && i < STRATEGIES; i++)
        if (o.wanted[i] && o.error > 0 && !(result[i].error <= o.error * result[i].mean))
            ok = complain(strategy_name[i], "error %s not reached with %u sample%s per pixel", plain(o.error, error),
                          result[i].spp, result[i].spp > 1 ? "s" : "");
    free(image);
    free(e.map.pixel);
    free(e.table);
    free(e.tiles);
    return ok ? 0 : 1;
}
