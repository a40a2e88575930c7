/* The strategies of shadow.c: what they draw from, and how they join it with the BRDF's samples. */
#ifndef MCST_SHADOW_STRATEGY_H
#define MCST_SHADOW_STRATEGY_H
#include "maps.h"
#include "shadow_material.h"
#include "shadow_region.h"
#include "shadow_scene.h"

/* Tables of a region are built whenever its rays have doubled: stage 0 after 32, stage 8 after 8192. */
enum { STAGES = 9, STAGE_FIRST = 32, STAGE_256 = 3, STAGE_ONLINE = 6 };

/* What samples are drawn from. Prepared products are built at each point, tables once per region and stage. */
typedef enum {
    BRDF,
    MAP,
    PRODUCT,     /* mcs_product_build */
    REPAIRED,    /* without fireflies */
    LEARNED_256, /* and with the visible light that the region knows from 256 rays */
    LEARNED,     /* from all rays */
    TABLE,       /* of stage 0 */
    TABLE_256 = TABLE + STAGE_256,
    TABLE_ALL = TABLE + STAGES - 1,
    VARIANT, /* tables by other rules */
    TECHNIQUES = VARIANT + 96
} technique;

/* How many different prices techniques have. */
typedef enum { PRICE_BRDF, PRICE_MAP, PRICE_PRODUCT, PRICE_LEARNED, PRICE_TABLE, PRICES } price;
static price price_of(int t) {
    if (t >= TABLE) return PRICE_TABLE;
    return t >= REPAIRED ? PRICE_LEARNED : (price)t;
}

/* Of samples from a technique and from the BRDF. */
typedef enum {
    ALONE,
    PAIR_POWER,   /* one of each, power heuristic */
    PAIR_BALANCE, /* one of each, balance heuristic */
    MIXTURE,      /* one of both: the BRDF's with probability `share`; 0 is by the lobe */
    WAYS
} way;

typedef struct {
    const char *name;
    way how;
    int technique;
    float share;
} strategy;

enum {
    MAP_ALONE,
    BRDF_ALONE,
    MIS_POWER,
    MIS_ONE,
    PRODUCT_ALONE,
    PRODUCT_PAIR,
    REPAIRED_ALONE,
    LEARNED_ALONE_256,
    LEARNED_ALONE,
    REGION_PAIR_256,
    REGION_PAIR,
    REGION_MIXTURE_256,
    REGION_MIXTURE,
    REGION_ALONE,
    STRATEGIES
};

/* Tiles that a lobe covers when it is seen from above. */
static float lobe_tiles(const coat *c) {
    const mcs_frame frame = mcs_frame_make(vector(0, 0, 1));
    const mcs_reflection r = coat_reflection(c, &frame, vector(0, 0, 1));
    return 2 * TILES * TILES * r.alpha_x * r.alpha_y;
}
/* How samples of a region's table are joined with those of the BRDF: in pairs, by the power heuristic where the lobe is
 * smaller than a tile; in mixtures, with a share that is the larger, the narrower the lobe. */
static void fit_to_lobe(strategy *s, const coat *c) {
    const float tiles = lobe_tiles(c);
    if (s->technique < TABLE || s->how == ALONE) return;
    if (s->how == MIXTURE) s->share = fmaxf((1 - c->m->matte) / (1 + sqrtf(tiles)), 0.1f);
    else s->how = tiles < 1 && c->m->matte == 0 ? PAIR_POWER : PAIR_BALANCE;
}

/* ---- One point with one material under one map ---- */

typedef struct {
    const map *map;
    const coat *coat;
    const point *point;
    mcs_product *const *product; /* by technique */
} setting;

static mcs_texel setting_sample(const setting *s, int t, float u1, float u2) {
    if (t == MAP) return mcs_env_sample(s->map->table, u1, u2);
    if (t > MAP) return mcs_product_sample(s->product[t], s->map->tiles, s->map->table, u1, u2);
    const mcs_dir d = coat_sample(s->coat, s->point->wo, u1, u2);
    mcs_texel x;
    x.w = mcs_to_world(&s->point->frame, d.w);
    const mcs_texel of_map = mcs_env_texel(s->map->table, x.w);
    x.col = of_map.col;
    x.row = of_map.row;
    x.pdf = d.pdf;
    return x;
}
static float setting_pdf(const setting *s, int t, mcs_vec3 w) {
    if (t == MAP) return mcs_env_pdf(s->map->table, w);
    if (t > MAP) return mcs_product_pdf(s->product[t], s->map->tiles, s->map->table, w);
    return coat_pdf(s->coat, s->point->wo, mcs_to_local(&s->point->frame, w));
}
/* f cos L */
static float setting_value(const setting *s, const mcs_texel *x) {
    const float light = s->map->light[(size_t)x->row * s->map->w + x->col];
    const mcs_vec3 local = mcs_to_local(&s->point->frame, x->w);
    return light > 0 && local.z > 0 ? coat_value(s->coat, s->point->wo, local) * light : 0;
}

/* ---- Estimates, as a renderer would make them, without the shadow ray ---- */

/* The sample of one technique, weighed against another one. */
static float one_of_pair(const setting *s, const strategy *how, int t, const float *u) {
    const mcs_texel x = setting_sample(s, t, u[0], u[1]);
    if (!(x.pdf > 0)) return 0;
    const float value = setting_value(s, &x);
    if (!(value > 0)) return 0;
    const float other = setting_pdf(s, t == BRDF ? how->technique : BRDF, x.w);
    const float weight = how->how == PAIR_POWER ? mcs_mis_power(x.pdf, other) : mcs_mis_balance(x.pdf, other);
    return value / x.pdf * weight;
}
static float estimate(const setting *s, const strategy *how, const float u[4]) {
    if (how->how == PAIR_POWER || how->how == PAIR_BALANCE)
        return one_of_pair(s, how, how->technique, u) + one_of_pair(s, how, BRDF, u + 2);
    const float share = how->how == MIXTURE ? how->share : 0;
    const int brdf = u[0] < share;
    const float u1 = brdf ? u[0] / share : (u[0] - share) / (1 - share);
    const mcs_texel x = setting_sample(s, brdf ? BRDF : how->technique, fminf(u1, 0.99999994f), u[1]);
    const float value = x.pdf > 0 ? setting_value(s, &x) : 0;
    if (!(value > 0)) return 0;
    if (how->how == ALONE) return value / x.pdf;
    const float other = setting_pdf(s, brdf ? how->technique : BRDF, x.w);
    return value / mcs_mix_pdf(share, brdf ? x.pdf : other, brdf ? other : x.pdf);
}

/* ---- The same, exactly: sums over samples of any density ---- */

/* Integrals over directions: of the squares of an estimate's parts, of the parts themselves (by both halves of the
 * samples, whose product has no bias), and of the density of shadow rays. */
typedef struct {
    double square, part[2][2], rays, largest;
} tally;

/* A sample that stands for `weight` steradians. */
typedef struct {
    double value, weight;
    int through, half;
    const float *pdf; /* by technique */
} look_up;

static void tally_add(tally *sum, const strategy *how, const look_up *l) {
    const double share = (double)how->share;
    double p = (double)l->pdf[how->technique];
    const double b = (double)l->pdf[BRDF];
    const int pair = how->how == PAIR_POWER || how->how == PAIR_BALANCE;
    if (how->how == MIXTURE) p = share * b + (1 - share) * p;
    sum->rays += l->weight * (pair ? p + b : p);
    if (!l->through || !(p + b > 0)) return;
    double of_first = 1;
    double of_brdf = 0;
    if (pair) {
        const double p_power = how->how == PAIR_POWER ? p * p : p;
        const double b_power = how->how == PAIR_POWER ? b * b : b;
        of_first = p_power / (p_power + b_power);
        of_brdf = b_power / (p_power + b_power);
    }
    const double first = p > 0 ? of_first * l->value / p : 0;
    const double brdf = b > 0 ? of_brdf * l->value / b : 0;
    sum->square += l->weight * l->value * (of_first * first + of_brdf * brdf);
    sum->part[0][l->half] += 2 * l->weight * l->value * of_first;
    sum->part[1][l->half] += 2 * l->weight * l->value * of_brdf;
    sum->largest = fmax(sum->largest, fmax(first, brdf));
}
static double tally_variance(const tally *sum) {
    return sum->square - sum->part[0][0] * sum->part[0][1] - sum->part[1][0] * sum->part[1][1];
}
#endif
