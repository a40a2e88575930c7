/* What one sample of a product can be worth, by quadrature: pictures, materials, and the sums over a picture. Nothing
 * is drawn. Of the header it takes the builders, mcs_product_pdf, and eval and pdf of the BRDFs, which other tests
 * prove. */
#ifndef MCST_FIREFLIES_WORTH_H
#define MCST_FIREFLIES_WORTH_H
#include <float.h>
#include <math.h>
#include "arena.h"
#include "registry.h"

static const double pi = 3.14159265358979323846;
enum { TILE_ROWS = 16 };

/* ---- pictures ---- */

typedef struct {
    char name[32];
    uint32_t w, h;
    float *light;
    double total;              /* of light times solid angle */
    double *z, *cosine, *sine; /* cosines of the borders of rows; of the azimuths of the middles of columns */
    int sparse;                /* most of it is black */
    mcs_vec3 brightest;        /* towards the middle of the brightest texel */
    mcs_env *env;
    mcs_tiles *tiles;
} picture;

static inline mcs_vec3 direction_at(const picture *m, double row, double col) {
    const double theta = pi * row / m->h;
    const double phi = 2 * pi * col / m->w;
    const mcs_vec3 w = {(float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta)};
    return w;
}
/* Sums of a picture whose lights were set, and what is built from it. */
static inline void picture_finish(picture *m) {
    float most = -1;
    size_t lit = 0;
    m->total = 0;
    for (uint32_t row = 0; row < m->h; row++)
        for (uint32_t col = 0; col < m->w; col++) {
            const float light = m->light[(size_t)row * m->w + col];
            m->total += (double)light * (m->z[row] - m->z[row + 1]) * 2 * pi / m->w;
            lit += light > 0;
            if (!(light > most)) continue;
            most = light;
            m->brightest = direction_at(m, row + 0.5, col + 0.5);
        }
    m->sparse = lit < (size_t)m->w * m->h / 16;
    const mcs_image image = mcs_image_make(m->light, m->w, m->h, 1);
    CHECK(mcs_env_build(m->env, mcs_env_bytes(m->w, m->h), &image) == MCS_OK, "%s: no map", m->name);
    CHECK(mcs_tiles_build(m->tiles, mcs_tiles_bytes(m->env, TILE_ROWS), m->env, TILE_ROWS) == MCS_OK, "%s: no tiles",
          m->name);
}
/* A picture of w x h texels, all black; picture_finish has to follow. */
static inline picture picture_make(const char *name, uint32_t w, uint32_t h) {
    picture m;
    memset(&m, 0, sizeof m);
    snprintf(m.name, sizeof m.name, "%s", name);
    m.w = w;
    m.h = h;
    m.light = (float *)memory((size_t)w * h * sizeof *m.light);
    memset(m.light, 0, (size_t)w * h * sizeof *m.light);
    m.z = (double *)memory((h + 1) * sizeof *m.z);
    for (uint32_t row = 0; row <= h; row++) m.z[row] = cos(pi * row / h);
    m.cosine = (double *)memory(w * sizeof *m.cosine);
    m.sine = (double *)memory(w * sizeof *m.sine);
    for (uint32_t col = 0; col < w; col++) {
        m.cosine[col] = cos(2 * pi * (col + 0.5) / w);
        m.sine[col] = sin(2 * pi * (col + 0.5) / w);
    }
    m.env = (mcs_env *)memory(mcs_env_bytes(w, h));
    const mcs_image image = mcs_image_make(m.light, w, h, 1);
    CHECK(mcs_env_build(m.env, mcs_env_bytes(w, h), &image) == MCS_OK, "%s: no map", name);
    m.tiles = (mcs_tiles *)memory(mcs_tiles_bytes(m.env, TILE_ROWS));
    return m;
}
static inline void picture_free(picture *m) {
    free(m->light);
    free(m->z);
    free(m->cosine);
    free(m->sine);
    free(m->env);
    free(m->tiles);
}

/* ---- materials ---- */

typedef enum { MATTE, GGX, WARD, PHONG, ASHIKHMIN, KINDS } material_kind;
typedef struct {
    const char *name;
    material_kind kind;
    float a, b;            /* alphas, or exponents */
    float matte;           /* how much of it is matte */
    double of_pair, slack; /* a product's variance is at most so many times that of MIS, and so much more */
} material;

/* A material at a point of a scene, and the product there. */
typedef struct {
    const picture *m;
    material made_of;
    mcs_reflection r;
    mcs_ggx ggx;
    mcs_ward ward;
    mcs_phong phong;
    mcs_ashikhmin ashikhmin;
    mcs_product *p;
} point;

static inline void reflection_set(point *s) {
    const material *o = &s->made_of;
    s->r.matte = o->kind == MATTE ? 1 : o->matte;
    s->r.alpha_x = o->a;
    s->r.alpha_y = o->b;
    s->r.profile = MCS_PROFILE_GGX;
    switch (o->kind) {
    case GGX: s->ggx = mcs_ggx_make(o->a, o->b); break;
    case WARD:
        s->ward = mcs_ward_make(o->a, o->b, MCS_WARD_GMD);
        s->r.profile = MCS_PROFILE_GAUSS;
        break;
    case PHONG:
        s->phong = mcs_phong_make(o->a);
        s->r.profile = MCS_PROFILE_PHONG;
        s->r.alpha_x = s->r.alpha_y = (float)sqrt(1 / (2 * (double)o->a + 4));
        break;
    case ASHIKHMIN:
        s->ashikhmin = mcs_ashikhmin_make(o->a, o->b);
        s->r.profile = MCS_PROFILE_ASHIKHMIN;
        s->r.alpha_x = (float)sqrt(2 / ((double)o->a + 2));
        s->r.alpha_y = (float)sqrt(2 / ((double)o->b + 2));
        break;
    default: s->r.alpha_x = s->r.alpha_y = 1;
    }
}
/* The only place that knows how a product is built. */
static inline int product_set(point *s, mcs_product *memory_of_it) {
    s->p = memory_of_it;
    return mcs_product_build(s->p, mcs_product_bytes(TILE_ROWS), s->m->tiles, s->m->env, &s->r, NULL) == MCS_OK;
}

/* Reflection times cosine, and the density with which the BRDF would be sampled. */
typedef struct {
    double value, pdf;
} reflected;
static inline reflected reflect(const point *s, mcs_vec3 w) {
    const double matte = (double)s->r.matte;
    const double cosine = w.z > 0 ? (double)w.z / pi : 0;
    reflected lobe = {0, 0};
    switch (s->made_of.kind) {
    case GGX:
        lobe.value = (double)mcs_ggx_eval(&s->ggx, s->r.wo, w);
        lobe.pdf = (double)mcs_ggx_vndf_pdf(&s->ggx, s->r.wo, w);
        break;
    case WARD:
        lobe.value = (double)mcs_ward_eval(&s->ward, s->r.wo, w);
        lobe.pdf = (double)mcs_ward_pdf(&s->ward, s->r.wo, w);
        break;
    case PHONG:
        lobe.value = (double)mcs_phong_eval(&s->phong, s->r.wo, w);
        lobe.pdf = (double)mcs_phong_pdf(&s->phong, s->r.wo, w);
        break;
    case ASHIKHMIN:
        lobe.value = (double)mcs_ashikhmin_eval(&s->ashikhmin, s->r.wo, w);
        lobe.pdf = (double)mcs_ashikhmin_pdf(&s->ashikhmin, s->r.wo, w);
        break;
    default: break;
    }
    const reflected both = {matte * cosine + (1 - matte) * lobe.value * (double)w.z,
                            matte * cosine + (1 - matte) * lobe.pdf};
    return both;
}

/* ---- sums ---- */

/* Integrals over a picture, of F = L f cos. `fineness` divides the cells. */
typedef struct {
    double fineness;
    double answer, second, largest;                    /* of F, F^2/pdf; the largest F/pdf */
    double missed;                                     /* of F where the product has no density */
    double map, map_second, lobe_second, pair_largest; /* of MIS by the power heuristic, one sample of each: mean and
                                                          second moments of its parts, and the largest worth of one */
} worth;

/* Adds the direction w, which is to be looked up in the picture at light L and stands for a solid angle. */
static inline void add_direction(worth *sum, const point *s, mcs_vec3 w, double light, double solid) {
    const mcs_vec3 to = mcs_to_local(&s->r.frame, w);
    if (!(to.z > 0)) return;
    const reflected f = reflect(s, to);
    const double value = light * f.value;
    if (!(value > 0)) return;
    const double pdf = (double)mcs_product_pdf(s->p, s->m->tiles, s->m->env, w);
    const double of_map = light / s->m->total;
    const double scale = 1 / (of_map * of_map + f.pdf * f.pdf);
    sum->answer += value * solid;
    if (pdf > 0) {
        sum->second += value * value / pdf * solid;
        sum->largest = fmax(sum->largest, value / pdf);
    } else sum->missed += value * solid;
    const double map_worth = value * of_map * scale;
    const double lobe_worth = value * f.pdf * scale;
    sum->map += map_worth * of_map * solid;
    sum->map_second += map_worth * map_worth * of_map * solid;
    sum->lobe_second += lobe_worth * lobe_worth * f.pdf * solid;
    sum->pair_largest = fmax(sum->pair_largest, fmax(map_worth, lobe_worth));
}
/* The distance over which the lobe changes about w, a local direction. The slopes of the half-vector change by at most
 * sqrt(1 + |m|^2)/|h.z| per angle. */
static inline double lobe_scale(const point *s, mcs_vec3 w) {
    if (s->made_of.kind == MATTE) return 1;
    const double x = (double)w.x + (double)s->r.wo.x;
    const double y = (double)w.y + (double)s->r.wo.y;
    const double z = (double)s->r.wo.z + fmax((double)w.z, 0);
    if (s->made_of.kind == PHONG) {
        const double away = (double)w.z - (double)s->r.wo.z;
        const double root = sqrt(0.5 * (double)s->made_of.a * (x * x + y * y + away * away));
        return sqrt(2 / (double)s->made_of.a) / (s->m->sparse ? fmax(root, 1) : root > 7 ? 0.25 * root : 1);
    }
    const double ax = (double)s->r.alpha_x;
    const double ay = (double)s->r.alpha_y;
    double q = (x * x / (ax * ax) + y * y / (ay * ay)) / (z * z);
    const double scale = fmin(ax, ay) * z / sqrt(1 + (x * x + y * y) / (z * z));
    if (s->made_of.kind == GGX) return scale * sqrt(1 + q);
    if (s->made_of.kind == ASHIKHMIN) { /* cos^power(theta_h) is exp(-q), too */
        const double flat = fmax(x * x + y * y, DBL_MIN);
        const double power = ((double)s->made_of.a * x * x + (double)s->made_of.b * y * y) / flat;
        q = 0.5 * power * log1p(flat / (z * z));
    }
    return s->m->sparse ? scale / fmax(sqrt(q), 1) : q > 49 ? 1 : scale;
}
/* Adds a texel: its middle, where nothing changes much within it; else cells, each by two Gauss points each way; where
 * the horizon crosses it, by 8 x 8 middles at least. */
static inline void add_texel(worth *sum, const point *s, uint32_t row, uint32_t col) {
    const picture *m = s->m;
    const double light = (double)m->light[(size_t)row * m->w + col];
    if (!(light > 0)) return;
    const double z = 0.5 * (m->z[row] + m->z[row + 1]);
    const double sine = sqrt(1 - z * z);
    const mcs_vec3 middle = {(float)(sine * m->cosine[col]), (float)(sine * m->sine[col]), (float)z};
    const mcs_vec3 to = mcs_to_local(&s->r.frame, middle);
    const double size = pi / m->h;
    if ((double)to.z < -size) return;
    const double solid = (m->z[row] - m->z[row + 1]) * 2 * pi / m->w;
    const int cut = (double)to.z < size;
    const double parts = sum->fineness * size / lobe_scale(s, to);
    if (!cut && parts < 0.2) {
        add_direction(sum, s, middle, light, solid);
        return;
    }
    const int least = cut ? 8 : 2;
    const int n = (int)fmin(fmax(2 * ceil(parts / 0.7), least), 32 * fmin(sum->fineness, 1));
    const double off = cut ? 0 : 0.5 / sqrt(3.0) - 0.25; /* of a Gauss point from the middle of half a cell */
    for (int i = 0; i < n; i++) {
        const double down = (i + 0.5 + (i % 2 ? 2 : -2) * off) / n;
        const double at = m->z[row] + (m->z[row + 1] - m->z[row]) * down;
        const double ring = sqrt(1 - at * at);
        for (int j = 0; j < n; j++) {
            const double phi = 2 * pi * (col + (j + 0.5 + (j % 2 ? 2 : -2) * off) / n) / m->w;
            const mcs_vec3 w = {(float)(ring * cos(phi)), (float)(ring * sin(phi)), (float)at};
            add_direction(sum, s, w, light, solid / (n * n));
        }
    }
}
static inline worth worth_of(const point *s, double fineness) {
    worth sum;
    memset(&sum, 0, sizeof sum);
    sum.fineness = fineness;
    for (uint32_t row = 0; row < s->m->h; row++)
        for (uint32_t col = 0; col < s->m->w; col++) add_texel(&sum, s, row, col);
    return sum;
}
/* What is too little to count, for an answer: the header gives no tile less than a ten-thousandth of what a white
 * surface would reflect that faces its light. */
static inline double worth_nothing(const picture *m) { return 1e-4 / pi * m->total; }
/* Variance of one sample of the product, relative to the square of the answer. */
static inline double product_variance(const worth *v) { return v->second / (v->answer * v->answer) - 1; }
/* Of a pair of MIS, times two: a pair stands for two samples. */
static inline double pair_variance(const worth *v) {
    const double of_lobe = v->answer - v->map;
    return 2 * (v->map_second - v->map * v->map + v->lobe_second - of_lobe * of_lobe) / (v->answer * v->answer);
}
#endif
