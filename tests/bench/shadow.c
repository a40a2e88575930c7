/* Direct light under a map where things stand in the way: the variance of every strategy times what it costs, over that
 * of multiple importance sampling by the power heuristic. Writes shadow.csv, a line per configuration and strategy, and
 * prints geometric means and 5 % quantiles over the configurations.
 *
 *     shadow [--quick] [--out DIRECTORY] [map.hdr ...]
 *
 * A configuration is a scene (spheres, courtyard, room, leaves), a map and a material. The points of a scene are those
 * that an eye sees; they fall into regions, by object, main axis of the normal and cell of 3/8 of the object's size. Of
 * each configuration up to 32 regions are measured, picked by their area in the picture.
 *
 *   draws          A product is prepared for one draw, as in a path tracer, where each sample has a point of its own,
 *                  or for 16 that share it. Other strategies prepare nothing at a point.
 *   variance       of one draw at a point, by quadrature over 256 directions from four densities: exact but for the
 *                  noise of the quadrature, and heavy tails show although few samples would meet them. Means over 16
 *                  points of a region of the variance and of the answer; variance over answer^2, the answer at least
 *                  1/20 of the scene's; mean of the regions
 *   seconds        of sampler, density, value and look-up of light, measured without a scene, and 300 ns for each
 *                  shadow ray. Samples of value 0 send none.
 *   gain           (variance x seconds) of MIS over that of the strategy
 *   256, 8192      rays from which a region has learned; their price is not counted. Its object stands in for what it
 *                  has not seen, with the rays of the regions that are measured.
 *   online         A region begins without rays; its tables are built anew whenever these have doubled, until 2048
 *                  rays: the variance is the mean over all samples, the seconds are those of learning and building,
 *                  too. "If it pays" learns as part I has it: not where it cannot pay, and not after 1024 rays.
 *   largest        sample over the answer of its region */
#define _POSIX_C_SOURCE 200809L
#include "shadow_report.h"

enum { MADE_UP = 2 }; /* the first maps */

/* Measures configuration i of all scenes, maps and materials. */
static void measure_one(bench_case *c, int i, const view *views, const map *maps, int count, result *r) {
    const int map_number = i / MATERIALS % count;
    c->view = &views[i / (count * MATERIALS)];
    c->map = &maps[map_number];
    c->coat = coat_make(&materials[i % MATERIALS]);
    c->rng = mcs_pcg32_make(2, (uint64_t)i);
    r->scene = c->view->scene.name;
    r->map = c->map->name;
    r->from = map_number < MADE_UP ? "formulas" : "files";
    r->material = c->coat.m->name;
    bench_progress("%s, %s, %s: %d of %d", r->scene, r->map, r->material, i + 1, SCENES * count * MATERIALS);
    measure(c, r);
}

int main(int argc, char **argv) {
    static map maps[MAX_MAPS];
    static view views[SCENES];
    const double start = bench_seconds();
    int count = MADE_UP;
    int kept = 1;
    const char *files[MAX_MAPS];
    for (int i = 1; i < argc; i++) { /* bench_start takes what is left */
        if (argv[i][0] != '-' && strcmp(argv[i - 1], "--out") != 0 && count < MAX_MAPS) files[count++] = argv[i];
        else argv[kept++] = argv[i];
    }
    bench_start(kept, argv, "shadow");
    const uint32_t h = bench.quick ? 128 : 256;
    int ok = map_make(&maps[0], "sky", sky, 1, h) && map_make(&maps[1], "sun", sunlit, 0, h);
    for (int e = MADE_UP; ok && e < count; e++) ok = map_read(&maps[e], files[e]);
    for (int i = 0; ok && i < SCENES; i++) ok = view_make(&views[i], i);
    const int cases = SCENES * count * MATERIALS;
    result *results = calloc((size_t)cases, sizeof *results);
    bench_case *c = calloc(1, sizeof *c);
    if (!ok || !results || !c) return 1;
    FILE *csv = bench_csv("shadow.csv", "scene,map,material,strategy,draws,variance,ns,gain,rays,largest");
    int n = 0;
    for (int i = 0; i < cases; i++) {
        if (bench.quick && (i + i / MATERIALS) % 5 != 0) continue;
        measure_one(c, i, views, maps, count, &results[n]);
        write_row(csv, &results[n++], c->strategy);
    }
    bench_progress("%s", "");
    bench_close(csv, "shadow.csv");
    const report all = {c->strategy, results, n};
    print_prices(&all);
    print_strategies(&all);
    print_choice(&all);
    print_groups(&all);
    printf("shadow: %.0f s; %s\n", bench_seconds() - start, bench.out);
    return 0;
}
