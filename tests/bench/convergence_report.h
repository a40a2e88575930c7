/* What convergence.c writes and prints: rows, plots, tables and which targets are met. */
#ifndef MCST_CONVERGENCE_REPORT_H
#define MCST_CONVERGENCE_REPORT_H
#include "convergence_measure.h"
#include "svg.h"

/* ---- What is written ---- */

static void write_rows(FILE *f, const scene *s, const result *r) {
    for (int how = 0; how < STRATEGIES; how++)
        for (int kind = 0; kind < GENERATORS; kind++)
            for (int l = 0; l < levels; l++) {
                const level *v = &r->of[how][kind][l];
                fprintf(f, "\"%s\",\"%s\",%s,%s,%u,%d,%.4g,%.4g,%.3f,%.2g\n", s->m->name, s->e->name,
                        strategy_name[how], generator_name[kind], v->n, v->repetitions, v->rms, v->seconds,
                        slope(r, r->of[how][kind], 1), r->reference_error);
            }
}

/* The strategy that reaches the goal first, with points of this kind. */
static int fastest(const result *r, int kind) {
    int best = 0;
    for (int how = 1; how < STRATEGIES; how++)
        if (price_of(r, r->of[how][kind]).seconds < price_of(r, r->of[best][kind]).seconds) best = how;
    return best;
}

/* The points of a curve, and what they take of both axes. */
static void curve_points(const level *v, double x[LEVELS], double y[LEVELS], double lo[2], double hi[2]) {
    for (int l = 0; l < levels; l++) {
        x[l] = 1e6 * v[l].seconds;
        y[l] = v[l].rms;
    }
    svg_range(levels, x, 1, &lo[0], &hi[0]);
    svg_range(levels, y, 1, &lo[1], &hi[1]);
}

static int plot_panel(const char *file, const material *m, const map *e, const result *r) {
    static const double floor_at = 1e-6, ceiling = 10;
    static const strategy left_out[] = {PRODUCT_4, PRODUCT_16}; /* between their neighbours, with the same error */
    double lo[2] = {1, 1};
    double hi[2] = {0, 0};
    const int plain = fastest(r, INDEPENDENT);
    double x[STRATEGIES + 1][LEVELS], y[STRATEGIES + 1][LEVELS];
    for (int c = 0; c <= STRATEGIES; c++)
        curve_points(c < STRATEGIES ? r->of[c][SOBOL] : r->of[plain][INDEPENDENT], x[c], y[c], lo, hi);
    char text[128];
    snprintf(text, sizeof text, "%s, %.31s", m->name, e->name);
    svg_plot p;
    svg_begin(&p, file, text, "microseconds per estimate, points included", "rms relative error", 1, 1, lo[0] / 1.2,
              hi[0] * 1.2, fmax(lo[1] / 1.5, floor_at), fmin(hi[1] * 1.5, ceiling));
    for (int c = 0; c <= STRATEGIES; c++) {
        const char *name = strategy_name[c < STRATEGIES ? c : plain];
        if (c == (int)left_out[0] || c == (int)left_out[1]) continue;
        snprintf(text, sizeof text, "%s%s%s", name, c < STRATEGIES ? "" : " indep.",
                 y[c][levels - 1] < floor_at ? " (exact)" : "");
        svg_series(&p, text, levels, x[c], y[c], SVG_LINE);
    }
    svg_note(&p, "Sobol points, scrambled, where");
    svg_note(&p, "not said otherwise. A mark: 16,");
    snprintf(text, sizeof text, "64, ..., %u samples.", 16u << 2 * (levels - 1));
    svg_note(&p, text);
    return svg_end(&p);
}

/* One file per material: a panel per map, each a complete picture inside the sheet. */
static int plot_material(const material *m, const map *maps, int count, const result *r) {
    int bad = 0;
    char file[64];
    snprintf(file, sizeof file, "convergence-%s.svg", m->file);
    char name[640];
    snprintf(name, sizeof name, "%s", bench_path(file));
    char panel[sizeof name + 8];
    snprintf(panel, sizeof panel, "%s.panel", name);
    svg_plot sheet;
    sheet.out = fopen(name, "w");
    if (!sheet.out) {
        perror(name);
        return -1;
    }
    fprintf(sheet.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            SVG_W, count * (SVG_H + PANEL_GAP) + 2 * PANEL_GAP);
    char buffer[4096];
    size_t got;
    for (int e = 0; e < count && !bad; e++) {
        bad = plot_panel(panel, m, &maps[e], &r[e]);
        FILE *f = fopen(panel, "r");
        bad |= !f;
        fprintf(sheet.out, "<g transform=\"translate(0 %d)\">\n", e * (SVG_H + PANEL_GAP));
        while (f && (got = fread(buffer, 1, sizeof buffer, f)) > 0) bad |= fwrite(buffer, 1, got, sheet.out) != got;
        fprintf(sheet.out, "</g>\n");
        if (f) fclose(f);
    }
    remove(panel);
    fprintf(sheet.out, "<text x=\"10\" y=\"%d\" font-size=\"10\" font-family=\"Helvetica, Arial, sans-serif\">",
            count * (SVG_H + PANEL_GAP) + PANEL_GAP);
    svg_text(&sheet, bench.title);
    fprintf(sheet.out, "</text>\n</svg>\n");
    bad |= ferror(sheet.out);
    if (fclose(sheet.out) || bad) {
        fprintf(stderr, "cannot write %s\n", name);
        return -1;
    }
    return 0;
}

/* convergence.svg: five curves for one scene, a glossy surface under a sky with a sun. plot_material draws all strategies
 * for all scenes. */
static int plot_story(const map *maps, int count, const result *all) {
    static const struct {
        const char *name;
        strategy how;
        generator kind;
    } curve[] = {{"surface alone", BRDF, INDEPENDENT},
                 {"map alone", ENVIRONMENT, INDEPENDENT},
                 {"MIS", MIS_POWER, INDEPENDENT},
                 {"MIS, Sobol", MIS_POWER, SOBOL},
                 {"product, Sobol", PRODUCT_64, SOBOL}};
    enum { CURVES = sizeof curve / sizeof *curve };
    int m = 0;
    int e = 0;
    while (m + 1 < MATERIALS && strcmp(materials[m].file, "ggx-sharp") != 0) m++;
    while (e + 1 < count && strcmp(maps[e].name, "sun") != 0) e++;
    const result *r = &all[m * count + e];
    double lo[2] = {1, 1};
    double hi[2] = {0, 0};
    double x[CURVES][LEVELS], y[CURVES][LEVELS];
    for (int c = 0; c < CURVES; c++) curve_points(r->of[curve[c].how][curve[c].kind], x[c], y[c], lo, hi);
    char text[128];
    const double sobol = 1e6 * price_of(r, r->of[MIS_POWER][SOBOL]).seconds;
    const double plain = 1e6 * price_of(r, r->of[MIS_POWER][INDEPENDENT]).seconds;
    snprintf(text, sizeof text,
             "Sky and sun on a glossy surface: MIS takes %.0f us to 1 %% error, with Sobol points %.0f us", plain,
             sobol);
    svg_plot p;
    svg_begin(&p, bench_path("convergence.svg"), text, "microseconds per estimate", "rms relative error", 1, 1,
              lo[0] / 1.5, hi[0] * 1.5, lo[1] / 3, hi[1] * 1.5);
    const double goal[2][2] = {{lo[0] / 1.5, GOAL}, {hi[0] * 1.5, GOAL}};
    svg_link(&p, goal[0], goal[1]);
    for (int c = 0; c < CURVES; c++) svg_series(&p, curve[c].name, levels, x[c], y[c], SVG_LINE);
    svg_better(&p);
    svg_note(&p, "GGX, alpha 0.05. Points are");
    svg_note(&p, "independent where not Sobol.");
    snprintf(text, sizeof text, "Marks: 16 to %u samples.", 16u << 2 * (levels - 1));
    svg_note(&p, text);
    svg_note(&p, "Grey line: 1 % error.");
    return svg_end(&p);
}

static void print_time(double seconds, char mark) {
    const double us = 1e6 * seconds;
    if (us < 1e6) printf(" %c%-8.3g", mark, us);
    else printf(" %c%-8.1e", mark, us);
}

static void print_prices(const map *maps, int count, const result *all) {
    printf("\nMicroseconds to 1 %% rms relative error by strategy, with Sobol points; * the fastest\n%-18s %-10s",
           "material", "map");
    for (int how = 0; how < STRATEGIES; how++) printf(" %-10s", strategy_name[how]);
    printf("\n");
    for (int m = 0; m < MATERIALS; m++) {
        for (int e = 0; e < count; e++) {
            const result *r = &all[m * count + e];
            printf("%-18s %-10s", materials[m].name, maps[e].name);
            for (int how = 0; how < STRATEGIES; how++) {
                const price p = price_of(r, r->of[how][SOBOL]);
                print_time(p.seconds, p.mark);
                printf("%c", how == fastest(r, SOBOL) ? '*' : ' ');
            }
            printf("\n");
        }
    }
    printf("\nThe fastest to 1 %% by kind of points: strategy, samples, microseconds\n%-18s %-10s", "material", "map");
    for (int kind = GENERATORS - 1; kind >= 0; kind--) printf(" %-32s", generator_name[kind]);
    printf(" independent/Sobol\n");
    for (int m = 0; m < MATERIALS; m++) {
        for (int e = 0; e < count; e++) {
            const result *r = &all[m * count + e];
            printf("%-18s %-10s", materials[m].name, maps[e].name);
            price p[GENERATORS];
            for (int kind = GENERATORS - 1; kind >= 0; kind--) {
                const int best = fastest(r, kind);
                p[kind] = price_of(r, r->of[best][kind]);
                printf(" %-11s %c%-8.0f", strategy_name[best], p[kind].mark, p[kind].samples);
                print_time(p[kind].seconds, p[kind].mark);
                printf(" ");
            }
            printf(" %.3g\n", p[INDEPENDENT].seconds / p[SOBOL].seconds);
        }
    }
    printf("< the fewest samples tried, 16, are enough; ~ extrapolated; > extrapolated, but bright samples were so "
           "rare that\n"
           "it is a lower bound; all others interpolated between sample counts that differ by 4\n");
}

/* "rms error falls faster than N^-0.9 on the smooth scenes" */
static void print_slopes(const map *maps, int count, const result *all) {
    int missed = 0;
    int tried = 0;
    printf("\nSlope of log(rms error) over log(samples) with Sobol points where material and map are smooth; ! not "
           "below -0.9\n");
    printf("%-18s %-10s", "material", "map");
    for (int how = 0; how < STRATEGIES; how++)
        if (!like_product_64(how)) printf(" %-11s", strategy_name[how]);
    printf("\n");
    for (int m = 0; m < MATERIALS; m++) {
        for (int e = 0; e < count; e++) {
            const result *r = &all[m * count + e];
            if (!materials[m].smooth || !maps[e].smooth) continue;
            printf("%-18s %-10s", materials[m].name, maps[e].name);
            for (int how = 0; how < STRATEGIES; how++) {
                const double s = slope(r, r->of[how][SOBOL], 1);
                if (like_product_64(how)) continue;
                if (isnan(s)) {
                    printf(" %-11s", "exact");
                    continue;
                }
                printf(" %-5.2f%c     ", s, s < -0.9 ? ' ' : '!');
                missed += !(s < -0.9);
                tried++;
            }
            printf("\n");
        }
    }
    printf("rms error falls faster than N^-0.9 on the smooth scenes: %s (%d of %d)\n"
           "The sky is looked up without interpolation: once other error is gone, the steps between its texels bound "
           "the slope.\n",
           missed ? "MISSED" : "yes", tried - missed, tried);
}

/* Relative variance per sample. */
static double variance_of(const result *r, int how) {
    const level *v = &r->of[how][INDEPENDENT][0];
    return v->rms * v->rms * v->n;
}

static void print_variances(const map *maps, int count, const result *all) {
    static const strategy rival[] = {COSINE, BRDF, ENVIRONMENT, MIS_BALANCE, MIS_POWER};
    enum { RIVALS = sizeof rival / sizeof *rival };
    printf("\nVariance per sample over that of product sampling, with independent points\n%-18s %-10s", "material",
           "map");
    for (int k = 0; k < RIVALS; k++) printf(" %-11s", strategy_name[rival[k]]);
    printf("\n");
    for (int m = 0; m < MATERIALS; m++) {
        for (int e = 0; e < count; e++) {
            const result *r = &all[m * count + e];
            printf("%-18s %-10s", materials[m].name, maps[e].name);
            for (int k = 0; k < RIVALS; k++)
                printf(" %-11.3g", variance_of(r, (int)rival[k]) / variance_of(r, PRODUCT_64));
            printf("\n");
        }
    }
}

static double seconds_per_sample(const result *r, int how) {
    return r->of[how][INDEPENDENT][BLOCK_LEVEL].seconds / BLOCK;
}

/* Mean squared error of the best kind of MIS in the same time, over that of a strategy. */
static double gain_over_mis(const result *r, int how) {
    double mis = HUGE_VAL;
    for (int k = MIS_BALANCE; k <= ONE_SAMPLE; k++) mis = fmin(mis, variance_of(r, k) * seconds_per_sample(r, k));
    return mis / (variance_of(r, how) * seconds_per_sample(r, how));
}

/* A shading point as a renderer meets it: one set-up, then the few samples that the point is given. */
static void print_points(const map *maps, int count, const result *all) {
    static const strategy shown[] = {PRODUCT_1, PRODUCT_4, PRODUCT_16, PRODUCT_64};
    enum { SHOWN = sizeof shown / sizeof *shown };
    printf("\nProduct sampling by samples per shading point, independent: microseconds a point, set-up counted; rms "
           "relative error "
           "of\n");
    printf("its estimate; mean squared error of MIS (the best of balance, power, one-sample) in the same time, over "
           "its own\n%-29s",
           "");
    for (int k = 0; k < SHOWN; k++) printf(" %-21s", strategy_name[shown[k]]);
    printf("\n%-18s %-10s", "material", "map");
    for (int k = 0; k < SHOWN; k++) printf(" us    error %%  MIS/it");
    printf("\n");
    for (int m = 0; m < MATERIALS; m++) {
        for (int e = 0; e < count; e++) {
            const result *r = &all[m * count + e];
            printf("%-18s %-10s", materials[m].name, maps[e].name);
            for (int k = 0; k < SHOWN; k++) {
                const int how = (int)shown[k];
                const double samples = pow(4, k);
                const double t = seconds_per_sample(r, how);
                const double v = variance_of(r, how);
                printf(" %-5.3g %-8.3g %-6.3g", 1e6 * samples * t, 100 * sqrt(v / samples), gain_over_mis(r, how));
            }
            printf("\n");
        }
    }
}
/* The same over the maps: geometric mean and worst. */
static void print_gains(int count, const result *all) {
    static const strategy shown[] = {PRODUCT_1, PRODUCT_4, PRODUCT_16, PRODUCT_64};
    printf("\n%-29s", "MIS/it, mean / worst map");
    for (int k = 0; k < 4; k++) printf(" %-17s", strategy_name[shown[k]]);
    printf("\n");
    for (int m = 0; m < MATERIALS; m++) {
        printf("%-29s", materials[m].name);
        for (int k = 0; k < 4; k++) {
            double mean = 0;
            double worst = HUGE_VAL;
            for (int e = 0; e < count; e++) {
                const double gain = gain_over_mis(&all[m * count + e], (int)shown[k]);
                mean += log(gain) / count;
                worst = fmin(worst, gain);
            }
            printf(" %6.3g / %-8.3g", exp(mean), worst);
        }
        printf("\n");
    }
}

static int unmet;
static void verdict(const char *what, const char *material_name, const char *map_name, double measured,
                    const char *relation, double wanted) {
    const int met = relation[0] == '<' ? measured <= wanted : measured >= wanted;
    char of[64];
    snprintf(of, sizeof of, "%s, %s", material_name, map_name);
    printf("%-8s %-47s %-30s %9.3g %s %g\n", met ? "met" : "NOT MET", what, of, measured, relation, wanted);
    unmet += !met;
}

/* What the project asks of product sampling: figures of merit that are reported, not gates. */
static void print_targets(const map *maps, int count, const result *all) {
    const double ask[2] = {
        60, 20}; /* of matte over the map alone, of GGX 0.5 over MIS, as geometric means over the maps read */
    const int against[2] = {ENVIRONMENT, MIS_BALANCE};
    puts("\ntargets");
    for (int m = 0; m < MATERIALS; m++) {
        double product = 0;
        for (int e = 0; e < count; e++) {
            const result *r = &all[m * count + e];
            const double mis = fmin(variance_of(r, MIS_BALANCE), variance_of(r, MIS_POWER));
            verdict("product: variance over that of the better MIS", materials[m].name, maps[e].name,
                    variance_of(r, PRODUCT_64) / mis, "<=", 1.1);
            if (e >= 3 && m < 2) product += log(variance_of(r, against[m]) / variance_of(r, PRODUCT_64)) / (count - 3);
        }
        if (count > 3 && m < 2)
            verdict(m ? "product: MIS balance has times its variance" : "product: the map has times its variance",
                    materials[m].name, "all maps read", exp(product), ">=", ask[m]);
    }
    printf("%d not met\n", unmet);
}

/* How far the rms figures would differ in another run. */
static void print_doubts(int count, const result *all) {
    static double doubt[MATERIALS * MAX_MAPS * STRATEGIES];
    printf("\nStandard error of the rms errors above, relative, from run to run: median / largest of scenes and "
           "strategies\n%-18s",
           "samples");
    for (int l = 0; l < levels; l++) printf(" %-11u", 16u << 2 * l);
    printf("\n");
    int i;
    for (int kind = GENERATORS - 1; kind >= 0; kind--) {
        printf("%-18s", generator_name[kind]);
        for (int l = 0; l < levels; l++) {
            int used;
            for (used = i = 0; i < MATERIALS * count; i++)
                for (int how = 0; how < STRATEGIES; how++)
                    if (!like_product_64(how)) doubt[used++] = all[i].of[how][kind][l].doubt;
            const bench_spread d = bench_spread_of(doubt, used);
            printf(" %4.1f /%4.0f %%", 100 * d.median, 100 * d.max);
        }
        printf("\n");
    }
    printf("Times are the quickest of %d batches; above %d samples they are multiples of that for %d.\n", batches,
           BLOCK, BLOCK);
}

/* The quadrature against the means of MIS and of product sampling with Sobol points and the most samples:
 * integrals over the lobe and the map's table that share no code with it. 8 runs a point: were their means normal, t
 * would have 7 degrees of freedom and exceed 9 by chance once in 2e4. They are not where few samples are very bright:
 * all 8 runs may miss those. So a difference must also exceed 5 standard errors that take no luck into account: the
 * variance of a scrambled Sobol net in two dimensions is at most twice that of independent points (Owen 1997). */
static int print_references(int count, const result *all) {
    static const strategy checked[] = {MIS_POWER, PRODUCT_64};
    double quadrature = 0;
    int all_bad = 0;
    for (int i = 0; i < MATERIALS * count; i++) quadrature = fmax(quadrature, all[i].reference_error);
    printf("\nReferences: %d integrals by quadrature, largest relative error %.1e (estimated, halving the cells)\n",
           MATERIALS * count * POINTS, quadrature);
    for (int k = 0; k < (int)(sizeof checked / sizeof *checked); k++) {
        double worst = 0;
        double worst_t = 0;
        int bad = 0;
        for (int i = 0; i < MATERIALS * count; i++) {
            for (int p = 0; p < POINTS; p++) {
                const mcs_stat *s = &all[i].of[checked[k]][SOBOL][levels - 1].at[p];
                const level *plain = &all[i].of[checked[k]][INDEPENDENT][0];
                const double off = fabs(s->mean - 1);
                const double se = mcs_stat_error(s);
                const double bound = sqrt(2 * plain->square[p] * plain->n / (16.0 * pow(4, levels - 1) * s->n));
                const double known = all[i].reference_error + 1e-6; /* 1e-6 for the rounding of directions */
                worst = fmax(worst, off);
                worst_t = fmax(worst_t, fmax(off - known, 0) / se);
                bad += !(off <= fmax(9 * se, 5 * bound) + known);
            }
        }
        printf("the means of %-10s with Sobol points differ by at most %.1e, %.1f of their standard errors: %s\n",
               strategy_name[checked[k]], worst, worst_t, bad ? "FAIL" : "they agree");
        all_bad += bad;
    }
    return all_bad;
}
#endif
