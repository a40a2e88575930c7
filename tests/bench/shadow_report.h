/* What shadow.c says: gains over MIS in equal time, by strategy. */
#ifndef MCST_SHADOW_REPORT_H
#define MCST_SHADOW_REPORT_H
#include "shadow_measure.h"

#define RAY 300e-9 /* seconds of a shadow ray */

/* Of one draw, means over many. */
typedef struct {
    double variance, seconds;
} cost;

static cost measured_cost(const result *r, const strategy *list, int k) {
    const strategy *s = &list[k];
    cost c = {r->variance[k], r->draw[k] + RAY * r->rays[k]};
    if (!s->draws) return c;
    if (s->technique == PRODUCT) c.seconds += r->seconds[BUILD_PRODUCT] / s->draws;
    if (s->technique == PRODUCT_16) c.seconds += r->seconds[BUILD_PRODUCT_16] / s->draws;
    if (s->technique == LEARNED_256 || s->technique == LEARNED) c.seconds += r->seconds[BUILD_LEARNED] / s->draws;
    return c;
}
/* Of a region that learns from nothing while it draws, until it has sent 2048 rays: by the strategy of each stage until
 * the rays have doubled, with the price of learning and building. Regions that are asked learn as in run_through. */
static cost online_cost(const result *r, const strategy *list, int first) {
    const int asked = first == RUN;
    cost sum = {0, (asked ? r->starts : 1) * TABLE_POINTS * r->seconds[ADD_POINT]};
    double draws = 0;
    for (int stage = 0; stage < STAGE_2048; stage++) {
        const int k = first + stage;
        const double rays = stage_rays(stage + 1) - stage_rays(stage);
        const double more = rays / r->rays[k];
        const cost one = measured_cost(r, list, k);
        const double learning = rays / ADDED_RAYS * r->seconds[ADD_RAYS] + r->seconds[MERGE];
        sum.variance += more * one.variance;
        sum.seconds += more * one.seconds + (asked ? r->learns[stage] : 1) * learning;
        sum.seconds += (asked ? r->builds[stage] : 1) * r->seconds[BUILD_TABLE];
        draws += more;
    }
    sum.variance /= draws;
    sum.seconds /= draws;
    return sum;
}
static cost cost_of(const result *r, const strategy *list, int k) {
    if (list[k].how == ONLINE) return online_cost(r, list, list[k].technique);
    if (list[k].how == BY_LOBE) k = r->small ? MIS_POWER : LEARNED_ALONE;
    return measured_cost(r, list, k);
}
static double gain_of(const result *r, const strategy *list, int k) {
    const cost mis = cost_of(r, list, MIS_POWER);
    const cost c = cost_of(r, list, k);
    return mis.variance * mis.seconds / (c.variance * c.seconds);
}

/* Names by which configurations are told apart. */
typedef enum { BY_SCENE, BY_MAP, BY_MATERIAL, BY_SOURCE, BY_WALLS, KINDS } kind;
static const char *name_of(const result *r, kind by) {
    const int walls = strcmp(r->scene, "courtyard") == 0 || strcmp(r->scene, "room") == 0;
    const char *const names[KINDS] = {r->scene, r->map, r->material, r->from,
                                      walls ? "courtyard, room" : "spheres, leaves"};
    return names[by];
}

/* All results, and the strategies that they are of. */
typedef struct {
    const strategy *list;
    const result *result;
    int count;
} report;

/* Gains of all configurations, or of those that have a name: geometric mean, 5 % quantile, and the shares of them that
 * are below 1 and below 1/1.1. */
typedef struct {
    double mean, low, slower, slower_by_a_tenth;
    int n;
} gains;
static gains gains_of(const report *p, int k, kind by, const char *name) {
    static double gain[4096];
    gains g = {0, 0, 0, 0, 0};
    for (int i = 0; i < p->count; i++) {
        if (name && strcmp(name_of(&p->result[i], by), name) != 0) continue;
        gain[g.n] = gain_of(&p->result[i], p->list, k);
        g.slower += gain[g.n] < 1;
        g.slower_by_a_tenth += gain[g.n] < 1 / 1.1;
        g.mean += log(gain[g.n++]);
    }
    if (g.n == 0) return g;
    g.mean = exp(g.mean / g.n);
    g.slower /= g.n;
    g.slower_by_a_tenth /= g.n;
    bench_spread_of(gain, g.n);
    g.low = gain[g.n / 20];
    return g;
}

static double nanoseconds(const report *p, size_t member) {
    static double value[4096];
    for (int i = 0; i < p->count; i++) memcpy(&value[i], (const char *)&p->result[i] + member, sizeof value[i]);
    return 1e9 * bench_spread_of(value, p->count).median;
}
/* Medians of the configurations. */
static void print_prices(const report *p) {
    static const char *const names[WORKS] = {"a product",     "a product for 16", "a learned product", "a table",
                                             "merging twice", "adding a point",   "256 rays"};
    printf("\nNanoseconds:");
    for (size_t k = 0; k < WORKS; k++)
        printf("%s %s %.0f", k ? "," : "", names[k], nanoseconds(p, offsetof(result, seconds) + k * sizeof(double)));
    printf("\n");
}

static void print_strategies(const report *p) {
    static const struct {
        int strategy;
        const char *aim; /* of the project, for all maps */
    } rows[] = {{MAP_ALONE, ""},
                {BRDF_ALONE, ""},
                {MIS_POWER, ""},
                {MIS_ONE, ""},
                {PRODUCT_ALONE, ""},
                {PAIR + STAGE_256, ""},
                {PAIR + STAGE_LAST, ""},
                {PAIR_ONLINE, ""},
                {PAYING + STAGE_256, ""},
                {PAYING + STAGE_LAST, "1.9 / 1"},
                {PAYING_ONLINE, "1.7 / 1"},
                {FEW + STAGE_256, ""},
                {FEW + STAGE_LAST, ""},
                {FEW_ONLINE, ""},
                {PRODUCT_ALONE_16, ""},
                {LEARNED_ALONE_256, ""},
                {LEARNED_ALONE, ""},
                {LEARNED_OR_MIS, "2.2 / 1"}};
    printf("\nGain over MIS in equal time, %.0f ns a ray: geometric mean / 5 %% quantile\n", 1e9 * RAY);
    printf("%-24s %6s %15s %9s %15s %10s %9s\n", "", "draws", "all maps", "aim", "from files", "ns a draw", "largest");
    for (size_t j = 0; j < sizeof rows / sizeof *rows; j++) {
        const int k = rows[j].strategy;
        const gains all = gains_of(p, k, BY_SOURCE, NULL);
        const gains files = gains_of(p, k, BY_SOURCE, "files");
        printf("%-24s %6.0d %6.2f / %-6.2f %9s", p->list[k].name, p->list[k].draws, all.mean, all.low, rows[j].aim);
        if (files.n) printf(" %6.2f / %-6.2f", files.mean, files.low);
        else printf(" %15s", "");
        double largest = 0;
        for (int i = 0; k < MEASURED && i < p->count; i++) largest = fmax(largest, p->result[i].largest[k]);
        if (k < MEASURED)
            printf(" %10.0f %9.0f", nanoseconds(p, offsetof(result, draw) + (size_t)k * sizeof(double)), largest);
        printf("\n");
    }
}

/* What to choose where: the same gains with walls around and without, and how often a strategy loses to MIS. */
static void print_choice(const report *p) {
    static const int rows[] = {PRODUCT_ALONE,    PAIR + STAGE_LAST, PAYING + STAGE_LAST, PAYING_ONLINE,
                               PRODUCT_ALONE_16, LEARNED_ALONE,     LEARNED_OR_MIS};
    printf("\n%-24s %6s %17s %17s %17s %8s %12s\n", "gain: mean / 5 %", "draws", "spheres, leaves", "courtyard, room",
           "all maps", "slower", "by a tenth");
    for (size_t j = 0; j < sizeof rows / sizeof *rows; j++) {
        const int k = rows[j];
        const gains all = gains_of(p, k, BY_SOURCE, NULL);
        const gains open = gains_of(p, k, BY_WALLS, "spheres, leaves");
        const gains walls = gains_of(p, k, BY_WALLS, "courtyard, room");
        printf("%-24s %6.0d %8.2f / %-6.2f %8.2f / %-6.2f %8.2f / %-6.2f %6.0f %% %10.0f %%\n", p->list[k].name,
               p->list[k].draws, open.mean, open.low, walls.mean, walls.low, all.mean, all.low, 100 * all.slower,
               100 * all.slower_by_a_tenth);
    }
}

/* Geometric means over the configurations of one scene, map or material. */
static void print_groups(const report *p) {
    static const int columns[] = {PAIR + STAGE_LAST, PAYING + STAGE_LAST, PAYING_ONLINE,
                                  FEW + STAGE_LAST,  PRODUCT_ALONE_16,    LEARNED_ALONE};
    printf("\n%-16s %14s %14s %14s %15s %14s %14s\n", "geometric means", "region + BRDF", "if it pays", "online",
           "region + BRDF/8", "product x 16", "learned x 16");
    for (kind by = BY_SCENE; by < BY_SOURCE; by++) {
        for (int i = 0; i < p->count; i++) {
            const char *name = name_of(&p->result[i], by);
            int first = 0;
            while (strcmp(name_of(&p->result[first], by), name) != 0) first++;
            if (first < i) continue;
            printf("%-16s", name);
            for (size_t j = 0; j < sizeof columns / sizeof *columns; j++)
                printf(" %14.2f", gains_of(p, columns[j], by, name).mean);
            printf("\n");
        }
    }
}

static void write_row(FILE *csv, const result *r, const strategy *list) {
    for (int k = 0; k < STRATEGIES; k++) {
        const cost c = cost_of(r, list, k);
        fprintf(csv, "%s,%s,%s,%s,%d,%.6g,%.1f,%.4g,", r->scene, r->map, r->material, list[k].name, list[k].draws,
                c.variance, 1e9 * c.seconds, gain_of(r, list, k));
        if (k < MEASURED) fprintf(csv, "%.6g,%.6g", r->rays[k], r->largest[k]);
        else fprintf(csv, ",");
        fprintf(csv, "\n");
    }
}
#endif
