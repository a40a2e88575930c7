/* What is estimated in convergence.c, and how: materials, kinds of points, strategies and shading points. */
#ifndef MCST_CONVERGENCE_SCENE_H
#define MCST_CONVERGENCE_SCENE_H
#include "maps.h"

#define GOAL 0.01 /* the relative error whose price the table tells */

/* LEVELS numbers of samples: 16, 64, ...; a block of samples is one of them */
enum { LEVELS = 7, BLOCK_LEVEL = 3, BLOCK = 16 << 2 * BLOCK_LEVEL, POINTS = 4, BATCHES = 8, PANEL_GAP = 10 };

/* ---- Materials: reflectance 1, no Fresnel factor ---- */

typedef enum { MATTE, GGX, WARD, ASHIKHMIN, PHONG } material_kind;

typedef struct {
    const char *name, *file;
    material_kind kind;
    float a, b; /* alpha along x and y, or exponents */
    int smooth;
} material;

static const material materials[] = {{"matte", "matte", MATTE, 0, 0, 1},
                                     {"GGX 0.5", "ggx-rough", GGX, 0.5f, 0.5f, 1},
                                     {"GGX 0.05", "ggx-sharp", GGX, 0.05f, 0.05f, 0},
                                     {"Ward 0.1, 0.4", "ward", WARD, 0.1f, 0.4f, 0},
                                     {"A.-Shirley 20, 500", "ashikhmin", ASHIKHMIN, 20, 500, 0},
                                     {"Phong 200", "phong", PHONG, 200, 0, 0}};
enum { MATERIALS = sizeof materials / sizeof *materials };

/* ---- The scene of one estimate, and the arrays of a block of samples ---- */

typedef struct {
    const material *m;
    const map *e;
    mcs_frame frame;
    mcs_vec3 wo;
    mcs_reflection like; /* what product sampling is told */
    union {
        mcs_ggx ggx;
        mcs_ward ward;
        mcs_ashikhmin ashikhmin;
        mcs_phong phong;
    } lobe;
} scene;

typedef struct {
    float u1[BLOCK], u2[BLOCK], x[BLOCK], y[BLOCK], z[BLOCK];
    float pdf[BLOCK], weight[BLOCK], f[BLOCK]; /* of the BRDF */
    float env_pdf[BLOCK], light[BLOCK];        /* of the map */
    float value[BLOCK];                        /* what the samples say of the reflected light */
} block;

static void brdf_sample_n(const scene *s, block *b, size_t n) {
    switch (s->m->kind) {
    case GGX: mcs_ggx_vndf_sample_n(&s->lobe.ggx, s->wo, n, b->u1, b->u2, b->x, b->y, b->z, b->pdf, b->weight); return;
    case WARD: mcs_ward_sample_n(&s->lobe.ward, s->wo, n, b->u1, b->u2, b->x, b->y, b->z, b->pdf, b->weight); return;
    case ASHIKHMIN:
        mcs_ashikhmin_sample_n(&s->lobe.ashikhmin, s->wo, n, b->u1, b->u2, b->x, b->y, b->z, b->pdf, b->weight);
        return;
    case PHONG: mcs_phong_sample_n(&s->lobe.phong, s->wo, n, b->u1, b->u2, b->x, b->y, b->z, b->pdf, b->weight); return;
    default:
        mcs_cosine_sample_n(n, b->u1, b->u2, b->x, b->y, b->z, b->pdf);
        for (size_t i = 0; i < n; i++) b->weight[i] = 1;
    }
}

/* f and, if wanted, the density of BRDF sampling for samples first to last - 1 of the block. */
static void brdf_eval_n(const scene *s, block *b, size_t first, size_t last, int want_pdf) {
    const float *x = b->x + first;
    const float *y = b->y + first;
    const float *z = b->z + first;
    float *f = b->f + first;
    float *pdf = b->pdf + first;
    const size_t n = last - first;
    switch (s->m->kind) {
    case GGX:
        mcs_ggx_eval_n(&s->lobe.ggx, s->wo, n, x, y, z, f);
        if (want_pdf) mcs_ggx_vndf_pdf_n(&s->lobe.ggx, s->wo, n, x, y, z, pdf);
        return;
    case WARD:
        mcs_ward_eval_n(&s->lobe.ward, s->wo, n, x, y, z, f);
        if (want_pdf) mcs_ward_pdf_n(&s->lobe.ward, s->wo, n, x, y, z, pdf);
        return;
    case ASHIKHMIN:
        mcs_ashikhmin_eval_n(&s->lobe.ashikhmin, s->wo, n, x, y, z, f);
        if (want_pdf) mcs_ashikhmin_pdf_n(&s->lobe.ashikhmin, s->wo, n, x, y, z, pdf);
        return;
    case PHONG:
        mcs_phong_eval_n(&s->lobe.phong, s->wo, n, x, y, z, f);
        if (want_pdf) mcs_phong_pdf_n(&s->lobe.phong, s->wo, n, x, y, z, pdf);
        return;
    default:
        for (size_t i = 0; i < n; i++) {
            f[i] = (float)(1 / PI);
            pdf[i] = z[i] > 0 ? z[i] * (float)(1 / PI) : 0;
        }
    }
}

/* Light and density of the map in the directions that BRDF sampling found. */
static void map_look(const scene *s, block *b, size_t n) {
    for (size_t i = 0; i < n; i++) {
        const mcs_vec3 w = {b->x[i], b->y[i], b->z[i]};
        const mcs_texel t = mcs_env_texel(s->e->table, mcs_to_world(&s->frame, w));
        b->light[i] = s->e->light[(size_t)t.row * s->e->w + t.col];
        b->env_pdf[i] = t.pdf;
    }
}

static void map_sample(const scene *s, block *b, size_t first, size_t last) {
    for (size_t i = first; i < last; i++) {
        const mcs_texel t = mcs_env_sample(s->e->table, b->u1[i], b->u2[i]);
        const mcs_vec3 w = mcs_to_local(&s->frame, t.w);
        b->x[i] = w.x;
        b->y[i] = w.y;
        b->z[i] = w.z;
        b->light[i] = s->e->light[(size_t)t.row * s->e->w + t.col];
        b->env_pdf[i] = t.pdf;
    }
}

/* ---- Points ---- */

typedef enum { INDEPENDENT, STRATIFIED, SOBOL, GENERATORS } generator;
static const char *const generator_name[GENERATORS] = {"independent", "stratified", "Sobol"};

typedef struct {
    generator kind;
    mcs_pcg32 rng;
    uint32_t seed, nx, ny; /* strata: n is a power of two */
} source;

static source source_make(generator kind, uint32_t seed, uint32_t n) {
    source g;
    g.kind = kind;
    g.seed = seed;
    g.rng = mcs_pcg32_make(seed, 0);
    for (g.nx = 1; g.nx * g.nx < n; g.nx *= 2) {}
    g.ny = n / g.nx;
    return g;
}

static void source_points(source *g, block *b, uint32_t first, size_t n) {
    switch (g->kind) {
    case INDEPENDENT:
        mcs_pcg32_fill_n(&g->rng, n, b->u1);
        mcs_pcg32_fill_n(&g->rng, n, b->u2);
        return;
    case STRATIFIED:
        for (size_t i = 0; i < n; i++) {
            const mcs_vec2 u = mcs_stratified(first + (uint32_t)i, g->nx, g->ny, g->seed);
            b->u1[i] = u.x;
            b->u2[i] = u.y;
        }
        return;
    default: mcs_sobol_n(first, 0, g->seed, n, b->u1); mcs_sobol_n(first, 1, g->seed, n, b->u2);
    }
}

/* ---- Strategies: each fills value for n samples, whose mean is an estimate of the reflected light ---- */

typedef enum {
    UNIFORM,
    COSINE,
    BRDF,
    ENVIRONMENT,
    MIS_BALANCE,
    MIS_POWER,
    ONE_SAMPLE,
    PRODUCT_1,
    PRODUCT_4,
    PRODUCT_16,
    PRODUCT_64,
    STRATEGIES
} strategy;
static const char *const strategy_name[STRATEGIES] = {"uniform",     "cosine",     "BRDF",       "map",
                                                      "MIS balance", "MIS power",  "one-sample", "product 1",
                                                      "product 4",   "product 16", "product 64"};

static float heuristic(strategy how, float pf, float pg) {
    return how == MIS_BALANCE ? mcs_mis_balance(pf, pg) : how == MIS_POWER ? mcs_mis_power(pf, pg) : 1;
}

static void by_hemisphere(const scene *s, block *b, size_t n, strategy how) {
    if (how == UNIFORM) mcs_hemisphere_sample_n(n, b->u1, b->u2, b->x, b->y, b->z, b->weight);
    else mcs_cosine_sample_n(n, b->u1, b->u2, b->x, b->y, b->z, b->weight);
    brdf_eval_n(s, b, 0, n, 0);
    map_look(s, b, n);
    for (size_t i = 0; i < n; i++) b->value[i] = b->f[i] * b->z[i] / b->weight[i] * b->light[i];
}

static void by_brdf(const scene *s, block *b, size_t n, strategy how) {
    brdf_sample_n(s, b, n);
    map_look(s, b, n);
    for (size_t i = 0; i < n; i++)
        b->value[i] = b->pdf[i] > 0 ? b->weight[i] * b->light[i] * heuristic(how, b->pdf[i], b->env_pdf[i]) : 0;
}

static void by_map(const scene *s, block *b, size_t n, strategy how) {
    map_sample(s, b, 0, n);
    brdf_eval_n(s, b, 0, n, how != ENVIRONMENT);
    for (size_t i = 0; i < n; i++)
        b->value[i] = b->z[i] > 0
                          ? b->f[i] * b->z[i] * b->light[i] / b->env_pdf[i] * heuristic(how, b->env_pdf[i], b->pdf[i])
                          : 0;
}

/* One-sample model (Veach and Guibas 1995): u1 also chooses the technique, and what is left of it is stretched over
 * [0,1) again, so that the points stay well spread. BRDF samples are moved to the front of the block. */
static void by_one(const scene *s, block *b, size_t n) {
    size_t front = 0;
    size_t back = n;
    float kept[BLOCK][2];
    uint16_t from[BLOCK];
    for (size_t i = 0; i < n; i++) {
        const int brdf = b->u1[i] < 0.5f;
        const size_t to = brdf ? front++ : --back;
        kept[to][0] = 2 * b->u1[i] - (brdf ? 0 : 1);
        kept[to][1] = b->u2[i];
        from[to] = (uint16_t)i;
    }
    for (size_t i = 0; i < n; i++) {
        b->u1[i] = kept[i][0];
        b->u2[i] = kept[i][1];
    }
    brdf_sample_n(s, b, front);
    map_look(s, b, front);
    map_sample(s, b, front, n);
    brdf_eval_n(s, b, front, n, 1);
    for (size_t i = 0; i < n; i++) {
        const float value = i < front     ? b->pdf[i] > 0 ? b->weight[i] * b->pdf[i] : 0
                            : b->z[i] > 0 ? b->f[i] * b->z[i]
                                          : 0;
        b->value[from[i]] = value > 0 ? value * b->light[i] / mcs_mix_pdf(0.5f, b->pdf[i], b->env_pdf[i]) : 0;
    }
}

/* Set-ups in greater number than for PRODUCT_64 and else the same: the same error. */
static int like_product_64(int how) { return how >= PRODUCT_1 && how < PRODUCT_64; }

static mcs_product *prepared; /* at the shading point whose turn it is */

/* A set-up for every `run` samples. */
static void by_product(const scene *s, block *b, size_t n, uint32_t run) {
    for (size_t i = 0; i < n; i++) {
        if (i % run == 0)
            bench_built(
                mcs_product_build(prepared, mcs_product_bytes(TILES), s->e->tiles, s->e->table, &s->like, NULL));
        const mcs_texel t = mcs_product_sample(prepared, s->e->tiles, s->e->table, b->u1[i], b->u2[i]);
        const mcs_vec3 w = mcs_to_local(&s->frame, t.w);
        b->x[i] = w.x;
        b->y[i] = w.y;
        b->z[i] = w.z;
        b->light[i] = s->e->light[(size_t)t.row * s->e->w + t.col];
        b->env_pdf[i] = t.pdf;
    }
    brdf_eval_n(s, b, 0, n, 0);
    for (size_t i = 0; i < n; i++)
        b->value[i] = b->z[i] > 0 && b->env_pdf[i] > 0 ? b->f[i] * b->z[i] * b->light[i] / b->env_pdf[i] : 0;
}

/* A run of n samples as n / piece estimates in their order, of `piece` samples each, a power of two. With two-sample
 * MIS half of a piece is from the BRDF and half from the map, each half with points of its own. */
static void estimate(const scene *s, strategy how, generator kind, uint32_t seed, uint32_t n, uint32_t piece,
                     double *value) {
    const int two = how == MIS_BALANCE || how == MIS_POWER;
    const uint32_t each = two ? n / 2 : n;
    const uint32_t part = two ? piece / 2 : piece;
    const uint32_t step = part < BLOCK ? part : BLOCK;
    for (uint32_t k = 0; k < n / piece; k++) value[k] = 0;
    for (int half = 0; half <= two; half++) {
        source g = source_make(kind, 2 * seed + (uint32_t)half, each);
        for (uint32_t at = 0; at < each; at += BLOCK) {
            const uint32_t size = each - at < BLOCK ? each - at : BLOCK;
            block b;
            source_points(&g, &b, at, size);
            if (how == UNIFORM || how == COSINE) by_hemisphere(s, &b, size, how);
            else if (how == ONE_SAMPLE) by_one(s, &b, size);
            else if (how >= PRODUCT_1) by_product(s, &b, size, 1u << 2 * (how - PRODUCT_1));
            else if (how == ENVIRONMENT || half) by_map(s, &b, size, how);
            else by_brdf(s, &b, size, how);
            for (uint32_t i = 0; i < size; i += step) {
                double sum = 0;
                for (uint32_t k = i; k < i + step; k++) sum += (double)b.value[k];
                value[(at + i) / part] += sum / part;
            }
        }
    }
}

/* ---- Shading points ---- */

/* Elevation and azimuth of the normal and of the direction that a mirror would show. At the first a glossy highlight
 * falls beside the sun, at the others it is 18, 49 and 27 degrees away; the sun shines on all of them. */
static const double shading_point[POINTS][4] = {
    {90, 0, 36.5, 41}, {50, 20, 45, 60}, {20, 80, 60, 100}, {0, 10, 15, 60}};

/* Width of slopes: exponents are those of the half-vector, Phong's that of the reflected direction, which turns twice
 * as far. */
static float alpha_of(material_kind kind, float a) {
    return kind == PHONG ? sqrtf(0.5f / (a + 2)) : kind == ASHIKHMIN ? sqrtf(2 / (a + 2)) : a;
}

static scene scene_make(const material *m, const map *e, int point) {
    double n[3];
    unit_from(shading_point[point][0], shading_point[point][1], n);
    double t[3];
    unit_from(shading_point[point][2], shading_point[point][3], t);
    const double d = 2 * (n[0] * t[0] + n[1] * t[1] + n[2] * t[2]);
    mcs_vec3 normal;
    normal.x = (float)n[0];
    normal.y = (float)n[1];
    normal.z = (float)n[2];
    mcs_vec3 wo;
    wo.x = (float)(d * n[0] - t[0]);
    wo.y = (float)(d * n[1] - t[1]);
    wo.z = (float)(d * n[2] - t[2]);
    scene s;
    s.m = m;
    s.e = e;
    s.frame = mcs_frame_make(normal);
    s.wo = mcs_to_local(&s.frame, wo);
    if (m->kind == GGX) s.lobe.ggx = mcs_ggx_make(m->a, m->b);
    if (m->kind == WARD) s.lobe.ward = mcs_ward_make(m->a, m->b, MCS_WARD_GMD);
    if (m->kind == ASHIKHMIN) s.lobe.ashikhmin = mcs_ashikhmin_make(m->a, m->b);
    if (m->kind == PHONG) s.lobe.phong = mcs_phong_make(m->a);
    s.like.frame = s.frame;
    s.like.wo = s.wo;
    s.like.matte = m->kind == MATTE;
    s.like.profile = m->kind == PHONG       ? MCS_PROFILE_PHONG
                     : m->kind == WARD      ? MCS_PROFILE_GAUSS
                     : m->kind == ASHIKHMIN ? MCS_PROFILE_ASHIKHMIN
                                            : MCS_PROFILE_GGX;
    s.like.alpha_x = alpha_of(m->kind, m->a);
    s.like.alpha_y = alpha_of(m->kind, m->kind == PHONG ? m->a : m->b);
    return s;
}
#endif
