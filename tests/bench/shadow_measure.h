/* What shadow.c measures in one configuration: a scene, a map and a material. */
#ifndef MCST_SHADOW_MEASURE_H
#define MCST_SHADOW_MEASURE_H
#include "bench.h"
#include "shadow_strategy.h"

enum { STRATEGIES_MAX = 400, TESTED = 16, TABLE_POINTS = 32, SAMPLES = 32 };

static const strategy named[STRATEGIES] = {{"map", ALONE, MAP, 0},
                                           {"BRDF", ALONE, BRDF, 0},
                                           {"MIS power", PAIR_POWER, MAP, 0},
                                           {"MIS one-sample", MIXTURE, MAP, 0.5f},
                                           {"product", ALONE, PRODUCT, 0},
                                           {"product + BRDF", PAIR_BALANCE, PRODUCT, 0},
                                           {"product repaired", ALONE, REPAIRED, 0},
                                           {"product learned 256", ALONE, LEARNED_256, 0},
                                           {"product learned", ALONE, LEARNED, 0},
                                           {"region + BRDF 256", PAIR_BALANCE, TABLE_256, 0},
                                           {"region + BRDF", PAIR_BALANCE, TABLE_ALL, 0},
                                           {"region or BRDF 256", MIXTURE, TABLE_256, 0},
                                           {"region or BRDF", MIXTURE, TABLE_ALL, 0},
                                           {"region alone", ALONE, TABLE_ALL, 0}};

/* ---- What is measured ---- */

typedef struct {
    const char *scene, *map, *material;
    int made_up;                     /* the map is */
    double variance[STRATEGIES_MAX]; /* of one draw, over the square of the answer: see summarise */
    double rays[STRATEGIES_MAX];     /* shadow rays of one draw */
    double largest[STRATEGIES_MAX];  /* the largest sample over the answer of its region */
    double draw[WAYS][PRICES];       /* seconds of one draw without rays */
    double build[PRICES];            /* seconds of preparing a point; of the table of a region */
    double learn;                    /* seconds that a region takes to learn of one ray */
    double add_point;
    double cells;   /* the lobe's solid angle in tiles, mean of the points */
    double visible; /* the visible share of the reflected light */
} result;

/* Sets of points whose reflections a table can be made of. */
typedef struct {
    int count;
    float width; /* by which lobes are widened */
    int mean;    /* of the reflection, not of its square */
} point_set;
enum { SET_USUAL, SET_4, SET_12, SET_128, SET_NARROW, SET_WIDE, SET_MEAN, SETS };
static const point_set point_sets[SETS] = {
    {TABLE_POINTS, REGION_WIDTH, 0}, {4, REGION_WIDTH, 0}, {12, REGION_WIDTH, 0},
    {128, REGION_WIDTH, 0},          {TABLE_POINTS, 0, 0}, {TABLE_POINTS, 0.3f, 0},
    {TABLE_POINTS, REGION_WIDTH, 1}};

/* Tables by other rules. */
typedef struct {
    const char *name;
    region_rule rule;
    int parent; /* whether the parent region gives the prior */
    int set;    /* of points */
} variant;
enum { VARIANT_STAGES = 3 };
static const int variant_stage[VARIANT_STAGES] = {1, STAGE_256, STAGES - 1};

/* All that one configuration needs. */
typedef struct {
    const view *view;
    const map *map;
    coat coat;
    mcs_pcg32 rng;
    mcs_product *product[TECHNIQUES];
    mcs_region *region, *parent, *set[SETS], *spare;
    float shadow[2][2 * TILES * TILES]; /* V to the exponent, from 256 rays and from all */
    float open[2 * TILES * TILES];      /* all 1 */
    strategy *strategy;
    const variant *variant;
    int strategies, variants;
    double variance[REGIONS][STRATEGIES_MAX], largest[REGIONS][STRATEGIES_MAX], mean[REGIONS];
    uint32_t looks;
} bench_case;

static uint32_t below(mcs_pcg32 *rng, uint32_t n) {
    const uint32_t i = (uint32_t)((double)mcs_pcg32_float(rng) * n);
    return i < n ? i : n - 1;
}
static const point *any_point(bench_case *c, const region *r) {
    return &c->view->point[r->first + below(&c->rng, r->count)];
}
static const point *any_of_parent(bench_case *c, const region *r) {
    return &c->view->point[r->parent_first + below(&c->rng, r->parent_count)];
}
static setting setting_of(const bench_case *c, const point *p) {
    const setting s = {c->map, &c->coat, p, c->product};
    return s;
}

/* ---- Training ---- */

/* Draws from a technique at a point of a region, and teaches the region what the shadow ray meets, if there is one.
 * Returns the number of rays. */
static uint32_t teach(bench_case *c, mcs_region *g, const point *p, int t) {
    const setting s = setting_of(c, p);
    const float u1 = mcs_pcg32_float(&c->rng);
    const float u2 = mcs_pcg32_float(&c->rng);
    const mcs_texel x = setting_sample(&s, t, u1, u2);
    if (!(x.pdf > 0) || !(setting_value(&s, &x) > 0)) return 0;
    const uint32_t tile = mcs_tiles_of_texel(c->map->tiles, c->map->table, x.col, x.row);
    mcs_region_add_ray(g, tile, is_free(&c->view->scene, p->place, x.w));
    return 1;
}

/* Adds a set of points of a region to an accumulator. */
static void add_set(bench_case *c, const region *r, const point_set *how, mcs_region *g) {
    const mcs_tiles *tiles = c->map->tiles;
    const size_t bytes = mcs_region_bytes(TILES);
    mcs_region_start(g, bytes, tiles);
    float *squares = region_squares(g);
    for (int i = 0; i < how->count; i++) {
        const point *p = any_point(c, r);
        const mcs_reflection f = coat_reflection(&c->coat, &p->frame, p->wo);
        mcs_region_start(c->spare, bytes, tiles);
        region_add(c->spare, tiles, c->map->table, &f, how->width);
        float *more = region_squares(c->spare);
        for (uint32_t n = 0; how->mean && n < g->tiles; n++) more[n] = sqrtf(more[n]);
        mcs_region_merge(g, c->spare);
    }
    for (uint32_t n = 0; how->mean && n < g->tiles; n++) squares[n] *= squares[n] / (float)how->count;
}

static void build_variants(bench_case *c, int stage) {
    float shadow[2 * TILES * TILES];
    for (int k = 0; k < VARIANT_STAGES; k++) {
        if (variant_stage[k] != stage) continue;
        for (int i = 0; i < c->variants; i++) {
            const variant *v = &c->variant[i];
            region_shadow(c->region, v->parent ? c->parent : NULL, &v->rule, shadow);
            region_build(c->product[VARIANT + VARIANT_STAGES * i + k], c->map->tiles, c->map->table, c->set[v->set],
                         shadow, v->rule.even);
        }
    }
}

/* A region learns from the rays of its own samples, a table of the stage before paired with the BRDF; at first the map
 * and the BRDF. Its parent has three times as many rays of its own, up to 3072. */
static void train(bench_case *c, const region *r) {
    const size_t bytes = mcs_region_bytes(TILES);
    mcs_region_start(c->region, bytes, c->map->tiles);
    mcs_region_start(c->parent, bytes, c->map->tiles);
    const int sets = c->variants ? SETS : 1;
    for (int k = 0; k < sets; k++) add_set(c, r, &point_sets[k], c->set[k]);
    memcpy(c->region, c->set[SET_USUAL], bytes);
    uint32_t rays = 0;
    for (int stage = 0; stage < STAGES; stage++) {
        const int from = stage ? TABLE + stage - 1 : MAP;
        for (uint32_t tries = 0; rays < (uint32_t)STAGE_FIRST << stage && tries < 100000; tries++) {
            const point *p = any_point(c, r);
            rays += teach(c, c->region, p, from) + teach(c, c->region, p, BRDF);
            for (int k = 0; k < 3 && rays < 1024; k++) {
                const point *other = any_of_parent(c, r);
                teach(c, c->parent, other, from);
                teach(c, c->parent, other, BRDF);
            }
        }
        mcs_product_build_region(c->product[TABLE + stage], mcs_product_bytes(TILES), c->map->tiles, c->map->table,
                                 c->region, c->parent);
        if (stage == STAGE_256) region_shadow(c->region, c->parent, &region_usual, c->shadow[0]);
        build_variants(c, stage);
    }
    region_shadow(c->region, c->parent, &region_usual, c->shadow[1]);
}

/* ---- Points ---- */

static void learned_at(mcs_product *p, const setting *s, const float *shadow, float least) {
    const mcs_reflection r = coat_reflection(s->coat, &s->point->frame, s->point->wo);
    learned_build(p, s->map->tiles, s->map->table, &r, shadow);
    if (r.matte < 1) p->brdf_share = fmaxf(p->brdf_share, least);
}
static void prepare(const bench_case *c, const setting *s) {
    const mcs_reflection r = coat_reflection(s->coat, &s->point->frame, s->point->wo);
    mcs_product_build(c->product[PRODUCT], mcs_product_bytes(TILES), s->map->tiles, s->map->table, &r);
    learned_at(c->product[REPAIRED], s, c->open, 0.02f);
    learned_at(c->product[LEARNED_256], s, c->shadow[0], 0.1f);
    learned_at(c->product[LEARNED], s, c->shadow[1], 0.1f);
}

/* Techniques that the reference is drawn from, each as often. None leaves out what another one finds. */
static const int drawn[] = {BRDF, MAP, LEARNED, TABLE_ALL};
enum { DRAWN = sizeof drawn / sizeof *drawn };

/* Adds a sample to the tallies of all strategies. */
static void look_at(bench_case *c, const setting *s, const mcs_texel *x, int half, tally *sums) {
    float pdf[TECHNIQUES];
    look_up l;
    l.value = (double)setting_value(s, x);
    if (!(l.value > 0)) return;
    const int techniques = VARIANT + VARIANT_STAGES * c->variants;
    for (int t = 0; t < techniques; t++) pdf[t] = setting_pdf(s, t, x->w);
    double all = 0;
    for (int k = 0; k < DRAWN; k++) all += (double)pdf[drawn[k]];
    if (!(all > 0)) return;
    l.weight = 1 / (all * 2 * SAMPLES);
    l.through = is_free(&c->view->scene, s->point->place, x->w);
    l.half = half;
    l.pdf = pdf;
    for (int k = 0; k < c->strategies; k++) tally_add(&sums[k], &c->strategy[k], &l);
}

/* The variances at a point are added to those of its region. */
static void test_point(bench_case *c, const point *p, int number, result *out) {
    static tally sums[STRATEGIES_MAX];
    const setting s = setting_of(c, p);
    prepare(c, &s);
    memset(sums, 0, sizeof sums);
    for (int half = 0; half < 2; half++) {
        for (int k = 0; k < DRAWN; k++) {
            const uint32_t seed = c->looks++;
            for (uint32_t i = 0; i < SAMPLES; i++) {
                const float u1 = mcs_sobol(i, 0, seed);
                const float u2 = mcs_sobol(i, 1, seed);
                const mcs_texel x = setting_sample(&s, drawn[k], u1, u2);
                if (x.pdf > 0) look_at(c, &s, &x, half, sums);
            }
        }
    }
    const tally *brdf = &sums[BRDF_ALONE];
    const double answer = 0.5 * (brdf->part[0][0] + brdf->part[0][1]);
    c->mean[number] += answer / TESTED;
    for (int k = 0; k < c->strategies; k++) {
        c->variance[number][k] += tally_variance(&sums[k]) / TESTED;
        out->rays[k] += sums[k].rays / TESTED / c->view->regions;
        c->largest[number][k] = fmax(c->largest[number][k], sums[k].largest);
    }
}

/* Variance over the square of the answer, mean of the regions. Both are means over the points of a region; an answer
 * below a twentieth of the scene's counts as that. */
static void summarise(const bench_case *c, result *out) {
    double all = 0;
    for (int i = 0; i < c->view->regions; i++) all += c->mean[i] / c->view->regions;
    for (int k = 0; k < c->strategies; k++) {
        out->variance[k] = 0;
        for (int i = 0; i < c->view->regions; i++) {
            const double answer = fmax(c->mean[i], 0.05 * all);
            out->variance[k] += c->variance[i][k] / (answer * answer) / c->view->regions;
            out->largest[k] = fmax(out->largest[k], c->largest[i][k] / answer);
        }
    }
}

/* ---- Prices ---- */

enum { TIMED = 64, ROUNDS = 5, DRAWS = 4 };

static double thread_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double time_draws(bench_case *c, const strategy *how, const point *const *p) {
    double seconds[ROUNDS];
    float u[4];
    for (int round = 0; round < ROUNDS; round++) {
        float sum = 0;
        const double start = thread_seconds();
        for (int i = 0; i < TIMED * DRAWS; i++) {
            const setting s = setting_of(c, p[i % TIMED]);
            for (int k = 0; k < 4; k++) u[k] = mcs_pcg32_float(&c->rng);
            sum += estimate(&s, how, u);
        }
        seconds[round] = (thread_seconds() - start) / (TIMED * DRAWS);
        bench_consume(1, &sum);
    }
    return bench_spread_of(seconds, ROUNDS).median;
}

/* Of the products that were built last, at any points of the region. */
static void time_all_draws(bench_case *c, const region *r, result *out) {
    static const strategy timed[] = {{"", ALONE, BRDF, 0},
                                     {"", ALONE, MAP, 0},
                                     {"", ALONE, PRODUCT, 0},
                                     {"", ALONE, LEARNED, 0},
                                     {"", ALONE, TABLE_ALL, 0},
                                     {"", PAIR_POWER, MAP, 0},
                                     {"", MIXTURE, MAP, 0.5f},
                                     {"", PAIR_BALANCE, PRODUCT, 0},
                                     {"", PAIR_BALANCE, TABLE_ALL, 0},
                                     {"", PAIR_POWER, TABLE_ALL, 0},
                                     {"", MIXTURE, TABLE_ALL, 0.5f}};
    const point *p[TIMED];
    for (int i = 0; i < TIMED; i++) p[i] = any_point(c, r);
    for (size_t k = 0; k < sizeof timed / sizeof *timed; k++)
        out->draw[timed[k].how][price_of(timed[k].technique)] = time_draws(c, &timed[k], p);
}

static void time_builds(bench_case *c, const region *r, result *out) {
    enum { KINDS = 4 };
    double seconds[KINDS][ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        double spent[KINDS] = {0};
        for (int i = 0; i < 8; i++) {
            const point *p = any_point(c, r);
            const setting s = setting_of(c, p);
            const mcs_reflection f = coat_reflection(s.coat, &p->frame, p->wo);
            const double start = thread_seconds();
            mcs_product_build(c->product[PRODUCT], mcs_product_bytes(TILES), s.map->tiles, s.map->table, &f);
            const double built = thread_seconds();
            learned_at(c->product[LEARNED], &s, c->shadow[1], 0.1f);
            const double learned = thread_seconds();
            mcs_product_build_region(c->product[TABLE], mcs_product_bytes(TILES), s.map->tiles, s.map->table, c->region,
                                     c->parent);
            const double region_built = thread_seconds();
            mcs_region_add_point(c->spare, s.map->tiles, s.map->table, &f);
            const double added = thread_seconds();
            spent[0] += (built - start) / 8;
            spent[1] += (learned - built) / 8;
            spent[2] += (region_built - learned) / 8;
            spent[3] += (added - region_built) / 8;
        }
        for (int k = 0; k < KINDS; k++) seconds[k][round] = spent[k];
    }
    out->build[PRICE_PRODUCT] = bench_spread_of(seconds[0], ROUNDS).median;
    out->build[PRICE_LEARNED] = 1.25 * out->build[PRICE_PRODUCT]; /* the stand-in is slower than the library will be */
    out->build[PRICE_TABLE] = bench_spread_of(seconds[2], ROUNDS).median;
    out->add_point = bench_spread_of(seconds[3], ROUNDS).median;
}

static void time_learning(bench_case *c, result *out) {
    double seconds[ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        const double start = thread_seconds();
        for (uint32_t i = 0; i < 256; i++) {
            const uint32_t col = i * 2654435761u % c->map->w;
            const uint32_t row = i * 40503u % c->map->h;
            const uint32_t tile = mcs_tiles_of_texel(c->map->tiles, c->map->table, col, row);
            mcs_region_add_ray(c->spare, tile, (int)(i & 1));
        }
        seconds[round] = (thread_seconds() - start) / 256;
        bench_consume(1, region_rays(c->spare));
    }
    out->learn = bench_spread_of(seconds, ROUNDS).median;
}

/* ---- What a library could know, to choose by ---- */

/* By the light of tiles and the reflection towards them: how much of the reflected light is visible; and how many tiles
 * the lobe has. */
static void describe(bench_case *c, const region *r, result *out) {
    float visible[2 * TILES * TILES];
    region_rule plain = region_usual;
    plain.exponent = 1;
    region_shadow(c->region, c->parent, &plain, visible);
    const float *light = MCSI_READ(float, c->map->tiles, mcsi_tiles_offsets_of(c->map->tiles).light);
    double all = 0;
    double seen = 0;
    for (uint32_t k = 0; k < c->region->tiles; k++) {
        const double value = sqrt((double)region_squares(c->region)[k]) * (double)light[k];
        seen += value * (double)visible[k];
        all += value;
    }
    out->visible += seen / all / c->view->regions;
    const point *p = any_point(c, r);
    const mcs_reflection f = coat_reflection(&c->coat, &p->frame, p->wo);
    const mcsi_surface s = mcsi_surface_make(c->map->table, &f);
    out->cells += (double)mcsi_lobe_in_cells(&s, c->region->tiles) / c->view->regions;
}

static void measure(bench_case *c, result *out) {
    memset(c->variance, 0, sizeof c->variance);
    memset(c->largest, 0, sizeof c->largest);
    memset(c->mean, 0, sizeof c->mean);
    for (int k = 0; k < c->strategies; k++) fit_to_lobe(&c->strategy[k], &c->coat);
    for (int i = 0; i < c->view->regions; i++) {
        const region *r = &c->view->region[i];
        train(c, r);
        for (int k = 0; k < TESTED; k++) test_point(c, any_point(c, r), i, out);
        describe(c, r, out);
    }
    const region *middle = &c->view->region[c->view->regions / 2];
    time_all_draws(c, middle, out);
    time_builds(c, middle, out);
    time_learning(c, out);
    summarise(c, out);
}
#endif
