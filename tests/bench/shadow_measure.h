/* What shadow.c measures in one configuration: a scene, a map and a material. */
#ifndef MCST_SHADOW_MEASURE_H
#define MCST_SHADOW_MEASURE_H
#include "bench.h"
#include "shadow_strategy.h"

enum { TESTED = 16, TABLE_POINTS = 16, SAMPLES = 32, ADDED_RAYS = 256 };

/* What is timed beside draws. */
typedef enum { BUILD_PRODUCT, BUILD_PRODUCT_16, BUILD_LEARNED, BUILD_TABLE, MERGE, ADD_POINT, ADD_RAYS, WORKS } work;

typedef struct {
    const char *scene, *map, *material;
    const char *from;          /* where the map is from: "files" or "formulas" */
    double variance[MEASURED]; /* of one draw, over the square of the answer: see summarise */
    double rays[MEASURED];     /* shadow rays of one draw */
    double largest[MEASURED];  /* the largest sample over the answer of its region */
    double draw[MEASURED];     /* seconds of one draw without rays */
    double seconds[WORKS];
    int small; /* whether the lobe is */
    /* Shares of the regions that learn while they draw: how many get points, build a table at a stage, learn in it. */
    double starts;
    double builds[STAGE_2048];
    double learns[STAGE_2048];
} result;

typedef union {
    mcs_region g;
    unsigned char bytes[16 + 16 * 2 * TILES * TILES];
} knowledge;

/* All that one configuration needs. */
typedef struct {
    const view *view;
    const map *map;
    coat coat;
    mcs_pcg32 rng;
    strategy strategy[STRATEGIES];
    int pays[REGIONS][STAGES];                 /* mcs_region_pays, before the table of a stage is built */
    int answer[REGIONS][STAGES];               /* what to do then: number of the strategy */
    int running[REGIONS][STAGE_2048];          /* of one that learns while it draws */
    knowledge region[REGIONS], early[REGIONS]; /* from all rays, from 256 */
    knowledge whole, spare;
    product product[REGIONS][TECHNIQUES];
    double variance[REGIONS][MEASURED], largest[REGIONS][MEASURED], mean[REGIONS];
    double draw[PAYING][REGIONS], seconds[WORKS][REGIONS];
    uint32_t looks;
} bench_case;

static const point *any_point(bench_case *c, int i) {
    const region *r = &c->view->region[i];
    const uint32_t k = (uint32_t)((double)mcs_pcg32_float(&c->rng) * r->count);
    return &c->view->point[r->first + (k < r->count ? k : r->count - 1)];
}
static setting setting_of(bench_case *c, int i, const point *p) {
    const setting s = {c->map, &c->coat, p, c->product[i]};
    return s;
}
/* The number of the strategy that number k is in region i. */
static int chosen(const bench_case *c, int i, int k) {
    const strategy *s = &c->strategy[k];
    if (s->how == ASKED) return c->answer[i][s->technique];
    return s->how == RUNNING ? c->running[i][s->technique] : k;
}

/* ---- Training ---- */

/* Draws from a technique at a point of a region, and adds the shadow ray, if there is one. */
static void teach(bench_case *c, int i, const point *p, int t) {
    const setting s = setting_of(c, i, p);
    float u[2];
    for (int k = 0; k < 2; k++) u[k] = mcs_pcg32_float(&c->rng);
    const mcs_texel x = setting_sample(&s, t, u);
    if (!(x.pdf > 0) || !(setting_value(&s, &x) > 0)) return;
    const uint32_t tile = mcs_tiles_of_texel(c->map->tiles, c->map->table, x.col, x.row);
    mcs_region_add_ray(&c->region[i].g, tile, is_free(&c->view->scene, p->place, x.w));
}

/* Builds the table of a region. Its object stands in for what it has not seen, with the rays of all regions of it that
 * are measured, and no others. A region that is the only one of its object has nothing to inherit. */
static void build_table(bench_case *c, int i, int stage) {
    int parts = 0;
    bench_built(mcs_region_start(&c->whole.g, sizeof c->whole, c->map->tiles));
    for (int k = 0; k < c->view->regions; k++) {
        if (c->view->region[k].object != c->view->region[i].object) continue;
        mcs_region_merge(&c->whole.g, &c->region[k].g);
        parts++;
    }
    const mcs_reflection r = coat_seen_from_above(&c->coat);
    mcs_product *p = &c->product[i][TABLE + stage].p;
    c->pays[i][stage] = mcs_region_pays(&c->region[i].g, &r);
    if (parts > 1) mcs_region_inherit(&c->region[i].g, &c->whole.g);
    bench_built(mcs_product_build_region(p, sizeof(product), c->map->tiles, c->map->table, &c->region[i].g));
    const float share = c->pays[i][stage] ? mcs_region_share(p, &r) : 0;
    c->answer[i][stage] = MIS_POWER;
    if (share > 0) c->answer[i][stage] = (share < 1 ? FEW : PAIR) + stage;
}

/* All regions learn side by side from the rays of their own samples, a table of the stage before paired with the BRDF;
 * at first the map and the BRDF. */
static void train(bench_case *c) {
    const int regions = c->view->regions;
    for (int i = 0; i < regions; i++) {
        bench_built(mcs_region_start(&c->region[i].g, sizeof c->region[i], c->map->tiles));
        for (int k = 0; k < TABLE_POINTS; k++) {
            const setting s = setting_of(c, i, any_point(c, i));
            const mcs_reflection f = setting_reflection(&s);
            mcs_region_add_point(&c->region[i].g, c->map->tiles, c->map->table, &f);
        }
    }
    for (int stage = 0; stage < STAGES; stage++) {
        const int from = stage ? TABLE + stage - 1 : MAP;
        for (int i = 0; i < regions; i++) {
            const float rays = (float)stage_rays(stage);
            for (int tries = 0; c->region[i].g.rays < rays && tries < 100000; tries++) {
                const point *p = any_point(c, i);
                teach(c, i, p, from);
                teach(c, i, p, BRDF);
            }
        }
        for (int i = 0; i < regions; i++) build_table(c, i, stage);
        if (stage == STAGE_256) memcpy(c->early, c->region, sizeof c->early);
    }
}

/* What the regions do that learn while they draw. They begin by MIS and count their rays, but where these can be of no
 * use: then mcs_region_pays says 0 before the first. After 32 they have points and a table, or after 128 where a lobe
 * may pay only if little comes through. One that does not pay any more, or has no use for its table after 256 rays,
 * gives up. None learns from more than 1024. */
static void run_through(bench_case *c, result *out) {
    const mcs_reflection r = coat_seen_from_above(&c->coat);
    const double part = 1.0 / c->view->regions;
    for (int i = 0; i < c->view->regions; i++) {
        bench_built(mcs_region_start(&c->spare.g, sizeof c->spare, c->map->tiles));
        int learns = mcs_region_pays(&c->spare.g, &r);
        c->spare.g.rays = 1;
        c->spare.g.through = 1;
        const int first = mcs_region_pays(&c->spare.g, &r) ? STAGE_32 : STAGE_128;
        for (int stage = 0; stage < STAGE_2048; stage++) {
            const int pays = c->pays[i][stage];
            const int builds = stage >= first && learns && pays;
            c->running[i][stage] = builds ? c->answer[i][stage] : MIS_POWER;
            learns = learns && pays && (c->running[i][stage] != MIS_POWER || stage < STAGE_256);
            if (builds) out->builds[stage] += part;
            if (builds && stage == first) out->starts += part;
            if (learns && stage < STAGE_1024) out->learns[stage] += part;
        }
    }
}

/* ---- Points ---- */

static void build_product(const bench_case *c, const setting *s, int t, const mcs_region *g) {
    const mcs_reflection r = setting_reflection(s);
    bench_built(mcs_product_build(&s->by[t].p, sizeof(product), c->map->tiles, c->map->table, &r, g));
}

/* Techniques that the reference is drawn from, each as often. None leaves out what another one finds. */
static const int drawn_from[] = {BRDF, MAP, LEARNED, TABLE + STAGE_LAST};
enum { DRAWN_FROM = sizeof drawn_from / sizeof *drawn_from };

/* Adds a sample at a point of region i to the tallies of all strategies. */
static void look_at(bench_case *c, const setting *s, int i, const mcs_texel *x, int half, tally *sums) {
    look_up l;
    l.value = (double)setting_value(s, x);
    if (!(l.value > 0)) return;
    for (int t = 0; t < TECHNIQUES; t++) l.pdf[t] = setting_pdf(s, t, x->w);
    double all = 0;
    for (int k = 0; k < DRAWN_FROM; k++) all += (double)l.pdf[drawn_from[k]];
    if (!(all > 0)) return;
    l.weight = 1 / (all * 2 * SAMPLES);
    l.through = is_free(&c->view->scene, s->point->place, x->w);
    l.half = half;
    for (int k = 0; k < MEASURED; k++) tally_add(&sums[k], &c->strategy[chosen(c, i, k)], &l);
}

/* The variances at a point are added to those of its region. */
static void test_point(bench_case *c, const setting *s, int i, result *out) {
    tally sums[MEASURED];
    memset(sums, 0, sizeof sums);
    for (int half = 0; half < 2; half++) {
        for (int k = 0; k < DRAWN_FROM; k++) {
            const uint32_t seed = c->looks++;
            for (uint32_t n = 0; n < SAMPLES; n++) {
                const float u[2] = {mcs_sobol(n, 0, seed), mcs_sobol(n, 1, seed)};
                const mcs_texel x = setting_sample(s, drawn_from[k], u);
                if (x.pdf > 0) look_at(c, s, i, &x, half, sums);
            }
        }
    }
    const tally *brdf = &sums[BRDF_ALONE];
    c->mean[i] += 0.5 * (brdf->part[0][0] + brdf->part[0][1]) / TESTED;
    for (int k = 0; k < MEASURED; k++) {
        c->variance[i][k] += tally_variance(&sums[k]) / TESTED;
        c->largest[i][k] = fmax(c->largest[i][k], sums[k].largest);
        out->rays[k] += sums[k].rays / TESTED / c->view->regions;
    }
}

/* Variance over the square of the answer, mean of the regions. Both are means over the points of a region; an answer
 * below a twentieth of the scene's counts as that. */
static void summarise(bench_case *c, result *out) {
    const int regions = c->view->regions;
    double all = 0;
    for (int i = 0; i < regions; i++) all += c->mean[i] / regions;
    for (int k = 0; k < MEASURED; k++) {
        for (int i = 0; i < regions; i++) {
            const double answer = fmax(c->mean[i], 0.05 * all);
            out->variance[k] += c->variance[i][k] / (answer * answer) / regions;
            out->largest[k] = fmax(out->largest[k], c->largest[i][k] / answer);
        }
        if (k < PAYING) out->draw[k] = bench_spread_of(c->draw[k], regions).median;
        for (int i = 0; k >= PAYING && i < regions; i++) out->draw[k] += out->draw[chosen(c, i, k)] / regions;
    }
    for (int k = 0; k < WORKS; k++) out->seconds[k] = bench_spread_of(c->seconds[k], regions).median;
}

/* ---- Prices ---- */

static double thread_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void do_work(bench_case *c, int i, work what) {
    const mcs_tiles *t = c->map->tiles;
    const setting s = setting_of(c, i, any_point(c, i));
    const mcs_reflection f = setting_reflection(&s);
    switch (what) {
    case BUILD_PRODUCT: build_product(c, &s, PRODUCT, NULL); break;
    case BUILD_PRODUCT_16: build_product(c, &s, PRODUCT_16, NULL); break;
    case BUILD_LEARNED: build_product(c, &s, LEARNED, &c->region[i].g); break;
    case BUILD_TABLE:
        mcs_region_inherit(&c->spare.g, &c->whole.g);
        bench_built(mcs_product_build_region(&c->product[i][TABLE + STAGE_LAST].p, sizeof(product), t, c->map->table,
                                             &c->region[i].g));
        break;
    case MERGE: /* what a pass has learned, with the region and with its object */
        for (int k = 0; k < 2; k++) mcs_region_merge(&c->spare.g, &c->early[i].g);
        break;
    case ADD_POINT: mcs_region_add_point(&c->spare.g, t, c->map->table, &f); break;
    default:
        for (uint32_t k = 0; k < ADDED_RAYS; k++) {
            const uint32_t col = (uint32_t)((uint64_t)(k * 2654435761u) * c->map->w >> 32);
            const uint32_t row = (uint32_t)((uint64_t)(k * 40503u << 16) * c->map->h >> 32);
            mcs_region_add_ray(&c->spare.g, mcs_tiles_of_texel(t, c->map->table, col, row), (int)(k & 1));
        }
    }
}

/* Times draws at random points of a region, those of products at a point that these are built for; then all work. */
static void time_region(bench_case *c, int i, const setting *s) {
    enum { DRAWS = 64, REPEATS = 16 };
    float u[5 * DRAWS];
    setting at[DRAWS];
    for (int n = 0; n < 5 * DRAWS; n++) u[n] = mcs_pcg32_float(&c->rng);
    for (int n = 0; n < DRAWS; n++) at[n] = setting_of(c, i, any_point(c, i));
    for (int k = -PAYING; k < PAYING; k++) { /* the second round counts */
        const strategy *how = &c->strategy[k < 0 ? k + PAYING : k];
        float sum = 0;
        const double start = thread_seconds();
        for (int n = 0; n < DRAWS; n++) sum += estimate(how->draws ? s : &at[n], how, u + 5 * n);
        if (k >= 0) c->draw[k][i] = (thread_seconds() - start) / DRAWS;
        bench_consume(1, &sum);
    }
    bench_built(mcs_region_start(&c->spare.g, sizeof c->spare, c->map->tiles));
    for (int k = 0; k < WORKS; k++) {
        const double start = thread_seconds();
        for (int n = 0; n < REPEATS; n++) do_work(c, i, (work)k);
        c->seconds[k][i] = (thread_seconds() - start) / REPEATS;
    }
}

static void measure(bench_case *c, result *out) {
    memset(c->variance, 0, sizeof c->variance);
    memset(c->largest, 0, sizeof c->largest);
    memset(c->mean, 0, sizeof c->mean);
    list_strategies(&c->coat, c->strategy);
    out->small = lobe_is_small(&c->coat);
    train(c);
    run_through(c, out);
    for (int i = 0; i < c->view->regions; i++) {
        for (int k = 0; k < TESTED; k++) {
            const setting s = setting_of(c, i, any_point(c, i));
            build_product(c, &s, PRODUCT, NULL);
            build_product(c, &s, PRODUCT_16, NULL);
            build_product(c, &s, LEARNED_256, &c->early[i].g);
            build_product(c, &s, LEARNED, &c->region[i].g);
            test_point(c, &s, i, out);
            if (k == TESTED - 1) time_region(c, i, &s);
        }
    }
    summarise(c, out);
}
#endif
