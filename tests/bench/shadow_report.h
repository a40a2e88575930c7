/* What shadow.c says: gains over MIS in equal time, by strategy. */
#ifndef MCST_SHADOW_REPORT_H
#define MCST_SHADOW_REPORT_H
#include "shadow_measure.h"

#define RAY 300e-9 /* seconds of a shadow ray */

/* Behind the named strategies come pairs and mixtures of each stage, then the variants. */
enum { STAGE_PAIR = STRATEGIES, STAGE_MIXTURE = STAGE_PAIR + STAGES, VARIANTS_FROM = STAGE_MIXTURE + STAGES };
/* Rows of the report that are no strategies of their own: what learns while it draws. */
enum { ONLINE_PAIR = STRATEGIES, ONLINE_MIXTURE, CHOICE_256, CHOICE, ROWS };
enum { REGIMES = 2 };
static const int draws_of[REGIMES] = {1, 16};

static const char *row_name(int row) {
    static const char *const names[] = {"region + BRDF online", "region or BRDF online", "choice 256", "choice"};
    return row < STRATEGIES ? named[row].name : names[row - STRATEGIES];
}

/* Seconds of one draw, with its part of preparing the point. */
static double seconds_of(const result *r, const strategy *s, double rays, int draws) {
    const price kind = price_of(s->technique);
    const double build = kind == PRICE_PRODUCT || kind == PRICE_LEARNED ? r->build[kind] / draws : 0;
    return r->draw[s->how][kind] + build + RAY * rays;
}
/* Variance times seconds of one draw, the lower the better. */
static double effort(const result *r, const strategy *all, int k, int draws) {
    return r->variance[k] * seconds_of(r, &all[k], r->rays[k], draws);
}
/* Of a region that learns from nothing while it draws, until it has sent 2048 rays: by MIS before it has a table, by
 * the table of each stage until the rays have doubled, with the price of learning and building. */
static double online_effort(const result *r, const strategy *all, int first) {
    double variance = 0;
    double seconds = 0;
    double weight = 0;
    for (int stage = -1; stage < STAGE_ONLINE; stage++) {
        const int k = stage < 0 ? MIS_POWER : first + stage;
        const double rays = stage < 0 ? STAGE_FIRST : STAGE_FIRST << stage;
        const double samples = rays / r->rays[k];
        variance += samples * r->variance[k];
        seconds += samples * seconds_of(r, &all[k], r->rays[k], 1) + 2 * rays * r->learn + r->build[PRICE_TABLE];
        weight += samples;
    }
    seconds += TABLE_POINTS * r->add_point;
    return variance / weight * (seconds / weight);
}
/* The form that suits: the region's table, paired with the BRDF, for one draw and where little of the light is visible;
 * else the product at the point that knows the visible light. */
static int chosen(const result *r, int row, int draws) {
    const int table = draws == 1 || r->visible < 0.1;
    if (row == CHOICE) return table ? REGION_PAIR : LEARNED_ALONE;
    return table ? REGION_PAIR_256 : LEARNED_ALONE_256;
}
static double row_effort(const result *r, const strategy *all, int row, int draws) {
    if (row == CHOICE || row == CHOICE_256) return effort(r, all, chosen(r, row, draws), draws);
    if (row == ONLINE_PAIR) return online_effort(r, all, STAGE_PAIR);
    if (row == ONLINE_MIXTURE) return online_effort(r, all, STAGE_MIXTURE);
    return effort(r, all, row, draws);
}
static double row_gain(const result *r, const strategy *all, int row, int draws) {
    return effort(r, all, MIS_POWER, draws) / row_effort(r, all, row, draws);
}

/* The geometric mean of n gains and their 5 % quantile; sorts them. */
typedef struct {
    double mean, low;
} gains;
static gains gains_of(double *gain, int n) {
    gains g = {0, 0};
    for (int i = 0; i < n; i++) g.mean += log(gain[i]) / n;
    g.mean = exp(g.mean);
    bench_spread_of(gain, n);
    g.low = gain[n / 20];
    return g;
}

/* Medians of the configurations, in nanoseconds. */
static void print_prices(const result *results, int count) {
    static const struct {
        const char *name;
        size_t member;
    } prices[] = {{"draw from the BRDF", offsetof(result, draw[ALONE][PRICE_BRDF])},
                  {"map", offsetof(result, draw[ALONE][PRICE_MAP])},
                  {"product", offsetof(result, draw[ALONE][PRICE_PRODUCT])},
                  {"table of a region", offsetof(result, draw[ALONE][PRICE_TABLE])},
                  {"MIS pair", offsetof(result, draw[PAIR_POWER][PRICE_MAP])},
                  {"region + BRDF", offsetof(result, draw[PAIR_BALANCE][PRICE_TABLE])},
                  {"region or BRDF", offsetof(result, draw[MIXTURE][PRICE_TABLE])},
                  {"building a product", offsetof(result, build[PRICE_PRODUCT])},
                  {"a table, stand-in", offsetof(result, build[PRICE_TABLE])},
                  {"adding a point", offsetof(result, add_point)},
                  {"a ray", offsetof(result, learn)}};
    static double value[4096];
    printf("\nNanoseconds without rays:");
    for (size_t k = 0; k < sizeof prices / sizeof *prices; k++) {
        for (int i = 0; i < count; i++)
            memcpy(&value[i], (const char *)&results[i] + prices[k].member, sizeof value[i]);
        printf("%s %s %.0f", k ? "," : "", prices[k].name, 1e9 * bench_spread_of(value, count).median);
    }
    printf("\n");
}

/* Of the configurations under maps from files, or of all. */
static void print_strategies(const result *results, int count, const strategy *all, int of_files) {
    static double gain[4096];
    int n = 0;
    for (int i = 0; i < count; i++) n += !(of_files && results[i].made_up);
    if (n == 0) return;
    printf("\nGain over MIS in equal time, 300 ns a ray: geometric mean / 5 %% quantile of %d configurations%s\n", n,
           of_files ? ", maps from files" : "");
    printf("%-24s %-15s %-15s %s\n", "", "1 draw a point", "16 draws", "largest sample / answer");
    for (int row = 0; row < ROWS; row++) {
        double largest = 0;
        printf("%-24s", row_name(row));
        for (int regime = 0; regime < REGIMES; regime++) {
            n = 0;
            for (int i = 0; i < count; i++) {
                if (of_files && results[i].made_up) continue;
                gain[n++] = row_gain(&results[i], all, row, draws_of[regime]);
                if (row < STRATEGIES) largest = fmax(largest, results[i].largest[row]);
            }
            const gains g = gains_of(gain, n);
            printf(" %6.2f / %-6.2f", g.mean, g.low);
        }
        if (row < STRATEGIES) printf(" %.0f", largest);
        printf("\n");
    }
}

/* Geometric means over the configurations of one scene, map or material. */
static void print_group(const result *results, int count, const strategy *all, size_t member) {
    static const int rows[] = {PRODUCT_PAIR, LEARNED_ALONE, REGION_MIXTURE, REGION_PAIR, ONLINE_PAIR};
    enum { COLUMNS = sizeof rows / sizeof *rows };
    for (int i = 0; i < count; i++) {
        const char *name = *(const char *const *)(const void *)((const char *)&results[i] + member);
        double sum[COLUMNS] = {0};
        int seen = 0;
        int number = 0;
        for (int k = 0; k < count; k++) {
            const char *other = *(const char *const *)(const void *)((const char *)&results[k] + member);
            if (strcmp(other, name) != 0) continue;
            seen |= k < i;
            number++;
            for (int j = 0; j < COLUMNS; j++)
                sum[j] += log(row_gain(&results[k], all, rows[j], rows[j] == LEARNED_ALONE ? 16 : 1));
        }
        if (seen) continue;
        printf("%-16s", name);
        for (int j = 0; j < COLUMNS; j++) printf(" %14.2f", exp(sum[j] / number));
        printf("\n");
    }
}
static void print_groups(const result *results, int count, const strategy *all) {
    printf("\n%-16s %14s %14s %14s %14s %14s\n", "geometric means", "product+BRDF", "learned x 16", "region or BRDF",
           "region + BRDF", "online");
    print_group(results, count, all, offsetof(result, scene));
    print_group(results, count, all, offsetof(result, map));
    print_group(results, count, all, offsetof(result, material));
}

static void write_row(FILE *csv, const result *r, const strategy *all, int strategies) {
    for (int k = 0; k < strategies; k++) {
        fprintf(csv, "%s,%s,%s,%s,%.6g,%.6g,%.6g", r->scene, r->map, r->material, all[k].name, r->variance[k],
                r->rays[k], r->largest[k]);
        for (int regime = 0; regime < REGIMES; regime++)
            fprintf(csv, ",%.1f,%.4g", 1e9 * seconds_of(r, &all[k], r->rays[k], draws_of[regime]),
                    effort(r, all, MIS_POWER, draws_of[regime]) / effort(r, all, k, draws_of[regime]));
        fprintf(csv, ",%.4g,%.4g\n", r->cells, r->visible);
    }
}
#endif
