/* Direct light under a map where things stand in the way: the variance of every strategy times what it costs, over that
 * of multiple importance sampling by the power heuristic. Writes shadow.csv, a line per configuration and strategy, and
 * prints geometric means and 5 % quantiles over the configurations.
 *
 *     shadow [--quick] [--variants] [--out DIRECTORY] [map.hdr ...]
 *
 * A configuration is a scene (spheres, courtyard, room, leaves), a map and a material. The points of a scene are those
 * that an eye sees; they fall into regions, by object, main axis of the normal and cell of 3/8 of the object's size. Of
 * each configuration 16 regions are measured, picked by their area in the picture.
 *
 *   one draw       a path tracer's case: each sample has a point of its own, which is prepared for it alone
 *   16 draws       preparing a point is shared by 16 draws
 *
 *   variance       of one draw at a point, by quadrature over 256 directions from four densities: exact but for the
 *                  noise of the quadrature, and heavy tails show although few samples would meet them. Means over 16
 *                  points of a region of the variance and of the answer; variance over answer^2, the answer at least
 *                  1/20 of the scene's; mean of the regions.
 *   seconds        of sampler, density, value and look-up of light, measured without a scene, and 300 ns for each
 *                  shadow ray. Samples of value 0 send none.
 *   gain           (variance x seconds) of MIS over that of the strategy
 *   online         a region begins with nothing, its tables are built anew whenever its rays have doubled, until 2048
 *                  rays: the variance is the mean over all samples, the seconds are those of learning and building, too
 *
 * --variants also measures region tables by other rules than region_usual, to choose its constants by. */
#define _POSIX_C_SOURCE 200809L
#include "shadow_report.h"

static const variant variants[] = {{"usual", {1, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"no V", {0, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"exponent .5", {0.5f, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"exponent .7", {0.7f, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"floor 0", {1, 0.25f, 2, 0, 0.2f}, 1, SET_USUAL},
                                   {"prior .1", {1, 0.1f, 2, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"prior .5", {1, 0.5f, 2, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"count .5", {1, 0.25f, 0.5f, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"count 1", {1, 0.25f, 1, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"count 4", {1, 0.25f, 4, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"count 8", {1, 0.25f, 8, 0.0001f, 0.2f}, 1, SET_USUAL},
                                   {"floor .001", {1, 0.25f, 2, 0.001f, 0.2f}, 1, SET_USUAL},
                                   {"floor .01", {1, 0.25f, 2, 0.01f, 0.2f}, 1, SET_USUAL},
                                   {"even 0", {1, 0.25f, 2, 0.0001f, 0}, 1, SET_USUAL},
                                   {"even .1", {1, 0.25f, 2, 0.0001f, 0.1f}, 1, SET_USUAL},
                                   {"even .4", {1, 0.25f, 2, 0.0001f, 0.4f}, 1, SET_USUAL},
                                   {"even 1", {1, 0.25f, 2, 0.0001f, 1}, 1, SET_USUAL},
                                   {"even 3", {1, 0.25f, 2, 0.0001f, 3}, 1, SET_USUAL},
                                   {"no parent", {1, 0.25f, 2, 0.0001f, 0.2f}, 0, SET_USUAL},
                                   {"no parent; count 1", {1, 0.25f, 1, 0.0001f, 0.2f}, 0, SET_USUAL},
                                   {"4 points", {1, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_4},
                                   {"12 points", {1, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_12},
                                   {"128 points", {1, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_128},
                                   {"lobes as they are", {1, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_NARROW},
                                   {"lobes + .3", {1, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_WIDE},
                                   {"mean; not rms", {1, 0.25f, 2, 0.0001f, 0.2f}, 1, SET_MEAN},
                                   {"first: .7; .05; 12", {0.7f, 0.25f, 2, 0.05f, 0}, 1, SET_12}};
enum { VARIANTS = sizeof variants / sizeof *variants };

enum { MADE_UP = 2 }; /* the first maps */
static strategy all[STRATEGIES_MAX];

/* Fills the list of strategies; returns how many there are. */
static int list_strategies(int with_variants) {
    memcpy(all, named, sizeof named);
    for (int k = 0; k < STAGES; k++) {
        all[STAGE_PAIR + k] = named[REGION_PAIR];
        all[STAGE_PAIR + k].technique = TABLE + k;
        all[STAGE_PAIR + k].name = "stage pair";
        all[STAGE_MIXTURE + k] = named[REGION_MIXTURE];
        all[STAGE_MIXTURE + k].technique = TABLE + k;
        all[STAGE_MIXTURE + k].name = "stage mixture";
    }
    int n = VARIANTS_FROM;
    if (!with_variants) return n;
    for (int k = 0; k < VARIANTS * VARIANT_STAGES; k++) {
        all[n] = named[REGION_PAIR];
        all[n].technique = VARIANT + k;
        all[n++].name = variants[k / VARIANT_STAGES].name;
        all[n] = named[REGION_MIXTURE];
        all[n].technique = VARIANT + k;
        all[n++].name = variants[k / VARIANT_STAGES].name;
    }
    return n;
}

static bench_case *case_make(int with_variants) {
    bench_case *c = calloc(1, sizeof *c);
    if (!c) return NULL;
    c->strategies = list_strategies(with_variants);
    c->strategy = all;
    c->variant = variants;
    c->variants = with_variants ? VARIANTS : 0;
    for (int t = PRODUCT; t < VARIANT + VARIANT_STAGES * c->variants; t++) {
        c->product[t] = malloc(mcs_product_bytes(TILES));
        if (!c->product[t]) return NULL;
    }
    c->region = malloc(mcs_region_bytes(TILES));
    c->parent = malloc(mcs_region_bytes(TILES));
    c->spare = malloc(mcs_region_bytes(TILES));
    for (int k = 0; k < SETS; k++) c->set[k] = malloc(mcs_region_bytes(TILES));
    for (int k = 0; k < 2 * TILES * TILES; k++) c->open[k] = 1;
    return c->region && c->parent && c->spare && c->set[SETS - 1] ? c : NULL;
}

/* Geometric means over all configurations by variant, variances alone: gains at 64, 256 and 8192 rays. */
static void print_variants(const result *results, int count) {
    printf("\nVariance by other rules over that by the usual one, region + BRDF and region or BRDF, %s\n",
           "after 64, 256 and 8192 rays");
    for (int v = 0; v < VARIANTS; v++) {
        printf("%-20s", variants[v].name);
        for (int k = 0; k < 2 * VARIANT_STAGES; k++) {
            const int usual = VARIANTS_FROM + 2 * (k % VARIANT_STAGES) + k / VARIANT_STAGES;
            const int other = usual + 2 * VARIANT_STAGES * v;
            double sum = 0;
            for (int i = 0; i < count; i++) sum += log(results[i].variance[other] / results[i].variance[usual]);
            printf(" %8.3f", exp(sum / count));
        }
        printf("\n");
    }
}

/* Measures configuration i of all scenes, maps and materials. */
static void measure_one(bench_case *c, int i, const view *views, const map *maps, int count, result *r) {
    const material *m = &materials[i % MATERIALS];
    c->view = &views[i / (count * MATERIALS)];
    c->map = &maps[i / MATERIALS % count];
    c->coat = coat_make(m);
    c->rng = mcs_pcg32_make(2, (uint64_t)i);
    r->scene = c->view->scene.name;
    r->map = c->map->name;
    r->made_up = i / MATERIALS % count < MADE_UP;
    r->material = m->name;
    bench_progress("%s, %s, %s: %d of %d", r->scene, r->map, r->material, i + 1, SCENES * count * MATERIALS);
    measure(c, r);
}

static void print_all(const result *results, int count, int with_variants) {
    print_prices(results, count);
    print_strategies(results, count, all, 0);
    print_strategies(results, count, all, 1);
    print_groups(results, count, all);
    if (with_variants) print_variants(results, count);
}

int main(int argc, char **argv) {
    static map maps[MAX_MAPS];
    static view views[SCENES];
    const double start = bench_seconds();
    int count = MADE_UP;
    int kept = 1;
    int with_variants = 0;
    const char *files[MAX_MAPS];
    for (int i = 1; i < argc; i++) { /* bench_start takes what is left */
        if (!strcmp(argv[i], "--variants")) with_variants = 1;
        else if (argv[i][0] != '-' && strcmp(argv[i - 1], "--out") != 0 && count < MAX_MAPS) files[count++] = argv[i];
        else argv[kept++] = argv[i];
    }
    bench_start(kept, argv, "shadow");
    const uint32_t h = bench.quick ? 128 : 256;
    int ok = map_make(&maps[0], "sky", sky, 1, h) && map_make(&maps[1], "sun", sunlit, 0, h);
    for (int e = MADE_UP; ok && e < count; e++) ok = map_read(&maps[e], files[e]);
    for (int i = 0; ok && i < SCENES; i++) ok = view_make(&views[i], i);
    const int cases = SCENES * count * MATERIALS;
    result *results = calloc((size_t)cases, sizeof *results);
    bench_case *c = case_make(with_variants);
    if (!ok || !results || !c) return 1;
    FILE *csv = bench_csv("shadow.csv", "scene,map,material,strategy,variance,rays,largest,ns_1,gain_1,ns_16,gain_16,"
                                        "lobe_tiles,visible");
    int n = 0;
    for (int i = 0; i < cases; i++) {
        if (bench.quick && (i + i / MATERIALS) % 5 != 0) continue;
        measure_one(c, i, views, maps, count, &results[n]);
        write_row(csv, &results[n++], all, c->strategies);
    }
    bench_progress("%s", "");
    bench_close(csv, "shadow.csv");
    print_all(results, n, with_variants);
    printf("shadow: %.0f s; %s\n", bench_seconds() - start, bench.out);
    return 0;
}
