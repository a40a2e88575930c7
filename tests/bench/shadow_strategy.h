/* The strategies of shadow.c: what they draw from, and how they join it with the BRDF's samples. */
#ifndef MCST_SHADOW_STRATEGY_H
#define MCST_SHADOW_STRATEGY_H
#include "maps.h"
#include "shadow_material.h"
#include "shadow_scene.h"

/* Tables of a region are built at once, and whenever its rays have doubled: stage 0 knows of none, stage 1 of 32, stage 9
 * of 8192. */
enum {
    STAGE_32 = 1,
    STAGE_128 = 3,
    STAGE_256 = 4,
    STAGE_1024 = 6,
    STAGE_2048 = 7,
    STAGES = 10,
    STAGE_LAST = STAGES - 1
};
static int stage_rays(int k) { return k > 0 ? 16 << k : 0; }

/* What samples are drawn from. Products of a point are built at each one, tables once per region and stage. */
typedef enum {
    BRDF,
    MAP,
    PRODUCT,     /* for one draw */
    PRODUCT_16,  /* for 16 draws */
    LEARNED_256, /* for 16 draws, with what the region knows from 256 rays */
    LEARNED,     /* from all rays */
    TABLE,       /* of stage 0 */
    TECHNIQUES = TABLE + STAGES
} technique;

/* Of samples from a technique and from the BRDF. */
typedef enum {
    ONE,          /* one sample: from the BRDF with probability `share` */
    PAIR_POWER,   /* a sample of the technique and `share` of the BRDF, 0 or 1 of them, by the power heuristic */
    PAIR_BALANCE, /* the same by the balance heuristic */
    ASKED,        /* what a region answers at stage `technique` */
    RUNNING,      /* the same of one that learns while it draws, which may have given up */
    ONLINE,       /* a region that learns while it draws: the strategies of stages, from number `technique` on */
    BY_LOBE       /* LEARNED_ALONE; MIS_POWER where the lobe is small */
} way;

typedef struct {
    char name[32];
    way how;
    int technique;
    int draws; /* that share what is prepared at a point; 0: nothing is */
    float share;
} strategy;

/* PAIR, FEW and PAYING are the first of STAGES each, RUN of STAGE_2048. */
enum {
    MAP_ALONE,
    BRDF_ALONE,
    MIS_POWER,
    MIS_ONE,
    PRODUCT_ALONE,
    PRODUCT_ALONE_16,
    LEARNED_ALONE_256,
    LEARNED_ALONE,
    PAIR,
    FEW = PAIR + STAGES,
    PAYING = FEW + STAGES,
    RUN = PAYING + STAGES,
    MEASURED = RUN + STAGE_2048,
    PAIR_ONLINE = MEASURED,
    FEW_ONLINE,
    PAYING_ONLINE,
    LEARNED_OR_MIS,
    STRATEGIES
};

/* Whether all is a lobe that covers less than a tile, seen from above. */
static int lobe_is_small(const coat *c) {
    const mcs_reflection r = coat_seen_from_above(c);
    return r.matte == 0 && 2 * TILES * TILES * r.alpha_x * r.alpha_y < 1;
}
/* Lists all strategies. Samples of a table are paired with as many of the BRDF, by the power heuristic where the lobe
 * is small; or with an eighth of them. A region that is asked, by mcs_region_pays and mcs_region_share, takes one or
 * the other, or MIS. */
static void list_strategies(const coat *c, strategy *list) {
    static const strategy plain[] = {{"map", ONE, MAP, 0, 0},
                                     {"BRDF", ONE, BRDF, 0, 0},
                                     {"MIS power", PAIR_POWER, MAP, 0, 1},
                                     {"MIS one-sample", ONE, MAP, 0, 0.5f},
                                     {"product", ONE, PRODUCT, 1, 0},
                                     {"product", ONE, PRODUCT_16, 16, 0},
                                     {"product learned 256", ONE, LEARNED_256, 16, 0},
                                     {"product learned 8192", ONE, LEARNED, 16, 0}};
    static const strategy joined[] = {{"region + BRDF online", ONLINE, PAIR, 0, 0},
                                      {"region + BRDF/8 online", ONLINE, FEW, 0, 0},
                                      {"region if it pays online", ONLINE, RUN, 0, 0},
                                      {"product or MIS 8192", BY_LOBE, 0, 16, 0}};
    memcpy(list, plain, sizeof plain);
    memcpy(list + PAIR_ONLINE, joined, sizeof joined);
    const int small = lobe_is_small(c);
    for (int k = 0; k < STAGES; k++) {
        strategy *pair = &list[PAIR + k];
        strategy *few = &list[FEW + k];
        *pair = (strategy){"", small ? PAIR_POWER : PAIR_BALANCE, TABLE + k, 0, 1};
        *few = (strategy){"", PAIR_BALANCE, TABLE + k, 0, 0.125f};
        list[PAYING + k] = (strategy){"", ASKED, k, 0, 0};
        snprintf(pair->name, sizeof pair->name, "region + BRDF %d", stage_rays(k));
        snprintf(few->name, sizeof few->name, "region + BRDF/8 %d", stage_rays(k));
        snprintf(list[PAYING + k].name, sizeof pair->name, "region if it pays %d", stage_rays(k));
        if (k >= STAGE_2048) continue;
        list[RUN + k] = (strategy){"", RUNNING, k, 0, 0};
        snprintf(list[RUN + k].name, sizeof pair->name, "region that learns %d", stage_rays(k));
    }
}

/* ---- One point with one material under one map ---- */

typedef union {
    mcs_product p;
    unsigned char bytes[MCS_PRODUCT_BYTES(TILES)];
} product;

typedef struct {
    const map *map;
    const coat *coat;
    const point *point;
    product *by; /* of the point and its region, by technique */
} setting;

static mcs_reflection setting_reflection(const setting *s) {
    return coat_reflection(s->coat, &s->point->frame, s->point->wo);
}
/* A direction's texel; its density by the technique, or by the map where that is the BRDF. */
static mcs_texel setting_texel(const setting *s, int t, mcs_vec3 w) {
    return t > MAP ? mcs_product_texel(&s->by[t].p, s->map->tiles, s->map->table, w) : mcs_env_texel(s->map->table, w);
}
/* The same of a direction that is drawn from the BRDF, with *pdf as the density of that. */
static mcs_texel setting_of_brdf(const setting *s, int t, const float *u, float *pdf) {
    const mcs_dir d = coat_sample(s->coat, s->point->wo, u[0], u[1]);
    *pdf = d.pdf;
    return setting_texel(s, t, mcs_to_world(&s->point->frame, d.w));
}
static mcs_texel setting_sample(const setting *s, int t, const float *u) {
    if (t == MAP) return mcs_env_sample(s->map->table, u[0], u[1]);
    if (t > MAP) return mcs_product_sample(&s->by[t].p, s->map->tiles, s->map->table, u[0], u[1]);
    float pdf;
    mcs_texel x = setting_of_brdf(s, BRDF, u, &pdf);
    x.pdf = pdf;
    return x;
}
static float setting_pdf(const setting *s, int t, mcs_vec3 w) {
    if (t == MAP) return mcs_env_pdf(s->map->table, w);
    if (t > MAP) return mcs_product_pdf(&s->by[t].p, s->map->tiles, s->map->table, w);
    return coat_pdf(s->coat, s->point->wo, mcs_to_local(&s->point->frame, w));
}
/* f cos L */
static float setting_value(const setting *s, const mcs_texel *x) {
    const float light = s->map->light[(size_t)x->row * s->map->w + x->col];
    const mcs_vec3 local = mcs_to_local(&s->point->frame, x->w);
    return light > 0 && local.z > 0 ? coat_value(s->coat, s->point->wo, local) * light : 0;
}

/* ---- Estimates, as a renderer would make them, without the shadow ray ---- */

/* A sample of the technique or of the BRDF, with the densities that the strategy asks for; the value is 0 where it is
 * lost. */
typedef struct {
    float value, pdf, brdf;
} drawn;
static drawn draw(const setting *s, const strategy *how, int from_brdf, const float *u) {
    drawn d = {0, 0, 0};
    const mcs_texel x =
        from_brdf ? setting_of_brdf(s, how->technique, u, &d.brdf) : setting_sample(s, how->technique, u);
    d.pdf = x.pdf;
    if ((from_brdf ? d.brdf : d.pdf) > 0) d.value = setting_value(s, &x);
    const int alone = how->how == ONE && !(how->share > 0);
    if (!from_brdf && !alone && d.value > 0) d.brdf = setting_pdf(s, BRDF, x.w);
    return d;
}
static float estimate(const setting *s, const strategy *how, const float u[5]) {
    if (how->how == ONE) {
        const drawn d = draw(s, how, u[2] < how->share, u);
        return d.value > 0 ? d.value / mcs_mix_pdf(how->share, d.brdf, d.pdf) : 0;
    }
    float sum = 0;
    for (int from_brdf = 0; from_brdf < 2; from_brdf++) {
        if (from_brdf && !(u[4] < how->share)) continue;
        const drawn d = draw(s, how, from_brdf, u + 2 * from_brdf);
        if (!(d.value > 0)) continue;
        const float brdf = how->share * d.brdf;
        const float own = from_brdf ? brdf : d.pdf;
        const float other = from_brdf ? d.pdf : brdf;
        sum += d.value / own * (how->how == PAIR_POWER ? mcs_mis_power(own, other) : mcs_mis_balance(own, other));
    }
    return sum;
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
    float pdf[TECHNIQUES];
} look_up;

static void tally_add(tally *sum, const strategy *how, const look_up *l) {
    const double share = (double)how->share;
    const int one = how->how == ONE;
    const double b = (one ? 1 : share) * (double)l->pdf[BRDF];
    const double of_technique = (double)l->pdf[how->technique];
    const double p = one ? share * b + (1 - share) * of_technique : of_technique;
    sum->rays += l->weight * (one ? p : p + b);
    if (!l->through || !(p + b > 0)) return;
    double of_brdf = 0;
    if (how->how == PAIR_BALANCE) of_brdf = b / (p + b);
    if (how->how == PAIR_POWER) of_brdf = b * b / (p * p + b * b);
    const double of_first = 1 - of_brdf;
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
