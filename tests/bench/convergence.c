/* Run time against error: direct illumination of a surface by an environment map, estimated by every strategy with
 * every kind of points; root-mean-square (rms) error over the number of samples and over seconds. Writes
 * convergence.csv, a plot per material, and convergence.svg of five curves for one scene; prints the time to reach 1 %,
 * the slopes, the variances over that of product sampling, product sampling with 1, 4, 16 and 64 samples per shading
 * point against MIS, which targets are met, and how far errors and references can be trusted. "product 4" is product
 * sampling with a set-up for every 4 samples, as if the shading point were another one then: the time is that of the
 * set-ups too.
 *
 *     convergence [--quick] [map.hdr ...]
 *
 * Times and errors are measured apart: times over short estimates in turns (measure_seconds), errors over few long
 * runs, whose pieces are the shorter estimates (measure_errors). Errors with independent points are the measured
 * variance per sample over n, so their slope is -1/2 by construction. Standard errors of the rms errors are printed.
 *
 * The truth is a quadrature in double over the texels of the map, with its own formulas (reference_at). It shares with
 * the measured estimates only the map, and is compared with them at the end. */
#define _POSIX_C_SOURCE 200809L
#include "convergence_report.h"

/* The references of a material at every shading point: one quadrature for all maps of a size. */
static void refer(int m, const map *maps, int count, double value[][POINTS], double error[][POINTS]) {
    for (int i = 0; i < POINTS; i++) {
        for (int e = 0; e < count; e++) {
            const scene s = scene_make(&materials[m], &maps[e], i);
            int same = 0;
            while (same < e && (maps[same].w != maps[e].w || maps[same].h != maps[e].h)) same++;
            if (same < e) continue; /* done with an earlier map of that size */
            bench_progress("%s: reference %d of %d", materials[m].name, i + 1, POINTS);
            double v[MAX_MAPS], err[MAX_MAPS];
            references(&s, maps, count, v, err);
            for (int l = e; l < count; l++)
                if (maps[l].w == maps[e].w && maps[l].h == maps[e].h) {
                    value[l][i] = v[l];
                    error[l][i] = err[l];
                }
        }
    }
}

static void measure_material(int m, const map *maps, int count, result *all, FILE *csv) {
    double value[MAX_MAPS][POINTS], error[MAX_MAPS][POINTS];
    refer(m, maps, count, value, error);
    for (int e = 0; e < count; e++) {
        result *r = &all[m * count + e];
        scene s[POINTS];
        for (int i = 0; i < POINTS; i++) {
            s[i] = scene_make(&materials[m], &maps[e], i);
            r->reference[i] = value[e][i];
            r->reference_error = fmax(r->reference_error, error[e][i] / value[e][i]);
        }
        bench_progress("%s, %s: scene %d of %d", materials[m].name, maps[e].name, m * count + e + 1, MATERIALS * count);
        measure(s, r);
        write_rows(csv, s, r);
    }
}

static int print_all(const map *maps, int count, const result *all) {
    print_prices(maps, count, all);
    print_slopes(maps, count, all);
    print_variances(maps, count, all);
    print_points(maps, count, all);
    print_gains(count, all);
    print_targets(maps, count, all);
    print_doubts(count, all);
    return print_references(count, all);
}

int main(int argc, char **argv) {
    static map maps[MAX_MAPS];
    const double start = bench_seconds();
    int count = 3;
    int kept = 1;
    const char *files[MAX_MAPS];
    for (int i = 1; i < argc; i++) { /* bench_start takes what is left */
        if (argv[i][0] != '-' && strcmp(argv[i - 1], "--out") != 0 && count < MAX_MAPS) files[count++] = argv[i];
        else argv[kept++] = argv[i];
    }
    bench_start(kept, argv, "convergence");
    levels = bench.quick ? 5 : LEVELS;
    batches = bench.quick ? BATCHES / 2 : BATCHES;
    const uint32_t h = bench.quick ? 128 : 256;
    int ok = map_make(&maps[0], "sky", sky, 1, h) && map_make(&maps[1], "sun", sunlit, 0, h) &&
             map_make(&maps[2], "flat", flat, 1, h);
    for (int e = 3; ok && e < count; e++) ok = map_read(&maps[e], files[e]);
    result *all = calloc((size_t)(MATERIALS * count), sizeof *all);
    prepared = malloc(mcs_product_bytes(TILES));
    if (!ok || !all || !prepared) return 1;
    FILE *csv =
        bench_csv("convergence.csv",
                  "material,map,strategy,points,samples,repetitions,rms_relative_error,seconds,slope,reference_error");
    for (int m = 0; m < MATERIALS && ok; m++) {
        measure_material(m, maps, count, all, csv);
        ok = plot_material(&materials[m], maps, count, &all[m * count]) == 0;
    }
    bench_progress("%s", "");
    bench_close(csv, "convergence.csv");
    if (ok && plot_story(maps, count, all)) {
        fprintf(stderr, "cannot write %s\n", bench_path("convergence.svg"));
        ok = 0;
    }
    const int bad = print_all(maps, count, all);
    printf("convergence: %.0f s; %s\n", bench_seconds() - start, bench.out);
    for (int e = 0; e < count; e++) {
        free(maps[e].light);
        free(maps[e].table);
        free(maps[e].tiles);
    }
    free(all);
    free(prepared);
    return !ok || bad;
}
