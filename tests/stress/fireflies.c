/* Bounds what one sample of a product can be worth, by quadrature over the texels of pictures: for a surface in a
 * picture, the largest F/pdf over the answer, F = L f cos; and the variance beside that of MIS by the power heuristic,
 * a pair for two samples. Then an adversary looks for the worst lamps, surface, material and eye.
 *
 *   --map FILE    a Radiance picture that joins those that are made up here, as do those of MCS_TEST_MAPS, which are
 *                 separated by spaces
 *   --table       geometric means and worst cases of each material, instead of checks, so that two versions of the
 *                 header can be compared
 *   --each        a line for every configuration: picture, material, normal, eye, answer, variance, that of MIS,
 *                 largest sample, that of MIS, share of the lobe
 *
 * MCS_TEST_SCALE thins the configurations out, and halves Radiance pictures. At full size the seed of the adversary is
 * the day; --seed picks another. */
#include <time.h>
#include "fireflies_climb.h"

/* What is claimed of the largest sample, over the answer; and of what the adversary finds, see score_of: twice the
 * most that it found from the seeds 12 and 13. */
static const double most_worth = 1000;
static const double most_climbed = 2e4;
enum { CLIMBS = 4, STEPS = 400, STEPS_LEAST = 16 };
static const char *const materials_of[KINDS] = {"matte", "GGX", "Ward", "Phong", "Ashikhmin-Shirley"};

/* ---- the grid ---- */

typedef struct {
    int n;
    double variance, pair, ratio, worst_ratio, largest, worst_largest; /* sums of logarithms; the worst ones */
    char at_ratio[48], at_largest[48];
} tally;
static tally tallies[MATERIALS];
static int table, each;

static void tally_add(tally *t, const worth *v, const char *where) {
    const double variance = product_variance(v);
    const double pair = pair_variance(v);
    const double ratio = (fmax(variance, 0) + ERROR) / (pair + ERROR);
    const double largest = v->largest / v->answer;
    t->n++;
    t->variance += log(fmax(variance, 0) + 1e-5);
    t->pair += log(fmax(pair, 0) + 1e-5);
    t->ratio += log(ratio);
    t->largest += log(largest);
    if (ratio > t->worst_ratio) {
        t->worst_ratio = ratio;
        snprintf(t->at_ratio, sizeof t->at_ratio, "%s", where);
    }
    if (largest > t->worst_largest) {
        t->worst_largest = largest;
        snprintf(t->at_largest, sizeof t->at_largest, "%s", where);
    }
}
static void tallies_print(void) {
    printf("%-16s %6s %10s %10s %8s %9s %-24s %8s %9s\n", "", "", "variance", "MIS", "ratio", "worst", "", "largest",
           "worst");
    for (int k = 0; k < MATERIALS; k++) {
        const tally *t = &tallies[k];
        if (!t->n) continue;
        printf("%-16s %6d %10.4g %10.4g %8.3g %9.3g %-24s %8.3g %9.3g %s\n", materials[k].name, t->n,
               exp(t->variance / t->n), exp(t->pair / t->n), exp(t->ratio / t->n), t->worst_ratio, t->at_ratio,
               exp(t->largest / t->n), t->worst_largest, t->at_largest);
    }
}
static void check_point(const picture *m, int k, int normal, int eye, mcs_product *memory_of_it) {
    const point s = point_at(m, k, normal, eye, memory_of_it);
    const worth v = worth_of(&s, 1);
    if (!(v.answer > 0)) return;
    char where[48];
    snprintf(where, sizeof where, "%s %d %d", m->name, normal, eye);
    tally_add(&tallies[k], &v, where);
    if (each)
        printf("%s,%s,%d,%d,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", m->name, materials[k].name, normal, eye, v.answer,
               product_variance(&v), pair_variance(&v), v.largest / v.answer, v.pair_largest / v.answer,
               (double)s.p->brdf_share);
    if (table || each) return;
    const material *o = &materials[k];
    const double nothing = worth_nothing(m);
    const double off = o->slack + pow(nothing / v.answer, 2);
    CHECK(!(v.missed > 0), "%s, %s: %g is never drawn", where, o->name, v.missed / v.answer);
    CHECK(v.largest <= most_worth * (v.answer + nothing), "%s, %s: a sample is %.3g times the answer", where, o->name,
          v.largest / v.answer);
    CHECK(product_variance(&v) <= o->of_pair * pair_variance(&v) + off, "%s, %s: variance %.4g, of MIS %.4g", where,
          o->name, product_variance(&v), pair_variance(&v));
}
static void check_picture(const picture *m) {
    mcs_product *memory_of_it = (mcs_product *)memory(mcs_product_bytes(TILE_ROWS));
    const double share = 8 * mcst_scale();
    static double due = 1;
    for (int k = 0; k < MATERIALS; k++) {
        if (!mcst_case("%s/%s", m->name, materials[k].name)) continue;
        for (int i = 0; i < NORMALS * EYES; i++) {
            due += fmin(share, 1);
            if (due < 1) continue;
            due -= 1;
            check_point(m, k, i * 7 % NORMALS, i % EYES, memory_of_it);
        }
    }
    free(memory_of_it);
}

/* A lamp that the horizon cuts, as the surface turns away from it. The mean direction of the light of its tile sinks
 * below the horizon before the lamp does: without a bound on the values of tiles, and without a share for the lobe, a
 * sample was worth up to 3.6e4 times the answer, at a relative variance of 73. */
static void check_turning(int k) {
    picture m = picture_made_up(0);
    mcs_product *memory_of_it = (mcs_product *)memory(mcs_product_bytes(TILE_ROWS));
    for (int degrees = 78; degrees <= 90; degrees++) {
        point s;
        memset(&s, 0, sizeof s);
        s.m = &m;
        s.made_of = materials[k];
        const double tilt = (degrees + 0.4) * pi / 180;
        s.r.frame = mcs_frame_make(unit(-cos(tilt), 0, sin(tilt)));
        s.r.wo = mcs_to_local(&s.r.frame, unit(-0.98238, -0.10341, 0.15511));
        reflection_set(&s);
        CHECK(product_set(&s, memory_of_it), "no product");
        const worth v = worth_of(&s, 1);
        CHECK(v.largest <= 100 * v.answer && product_variance(&v) <= 0.3,
              "%s, tilt %d: a sample is %.3g times the answer, variance %.3g", materials[k].name, degrees,
              v.largest / v.answer, product_variance(&v));
    }
    free(memory_of_it);
    picture_free(&m);
}

/* ---- the adversary ---- */

static void attack(material_kind kind) {
    const double scale = mcst_scale();
    const int climbs = (int)ceil(CLIMBS * scale);
    double worst = 0;
    char where[512] = "";
    state = mcst_seed_for("fireflies", materials_of[kind], 0);
    for (int n = 0; n < climbs; n++) {
        trial best;
        const double score = climb(kind, (int)fmax(STEPS * fmin(10 * scale, 1), STEPS_LEAST), &best);
        if (!(score > worst)) continue;
        worst = score;
        trial_print(&best, where, sizeof where);
    }
    CHECK(worst <= most_climbed, "%.3g at %s", worst, where);
    mcst_note("  %-20s %9.3g at %s\n", materials_of[kind], worst, where);
}

/* What the adversary found once. */
static void check_found(const trial *t, double most) {
    picture m = picture_make("lamps", CLIMB_W, CLIMB_H);
    mcs_product *memory_of_it = (mcs_product *)memory(mcs_product_bytes(TILE_ROWS));
    const worth v = trial_worth(t, &m, memory_of_it);
    const double score = score_of(&v, &m);
    CHECK(score <= most, "a sample is %.3g times the answer", score);
    free(memory_of_it);
    picture_free(&m);
}
/* A lamp below the horizon that has all nodes of a grid, and other light of its tile above it. A sample was worth 1.9e4
 * times the answer when such a tile weighed no more than its grid; now it is 1500. */
static trial lamp_below_the_horizon(void) {
    const trial t = {.lamps = 2,
                     .lamp = {{39, 22, 3, 2, log10(193.265316)}, {21, 69, 64, 13, log10(1.36999125)}},
                     .background = log10(0.75248552),
                     .normal_z = -0.479984987,
                     .normal_turn = 0.874600045,
                     .eye_z = 0.258854201,
                     .eye_turn = 0.226671993,
                     .b = log10(0.12916617),
                     .matte = 0.0220154809,
                     .kind = GGX};
    return t;
}
/* The tail of Ashikhmin-Shirley's lobe along its wide axis, from a grazing eye: the lamp there is seen by half-vectors
 * of slope 2.2, where cos^10 has 1e-4 left and the Gaussian of the same width 1e-12. A sample was worth 1e6 times the
 * answer when that Gaussian stood for the lobe; now it is less than the answer. */
static trial lamp_in_the_tail(void) {
    const trial t = {.lamps = 2,
                     .lamp = {{63, 118, 4, 3, log10(1.5000047)}, {26, 94, 4, 9, log10(6529.61168)}},
                     .background = log10(0.0157938664),
                     .normal_z = 0.611074517,
                     .normal_turn = 0.00622489342,
                     .eye_z = 0.0500695336,
                     .eye_turn = 0.207424908,
                     .a = log10(0.0199526231),
                     .b = log10(sqrt(2 / 12.0)),
                     .kind = ASHIKHMIN};
    return t;
}

/* The options of this program are taken out; the others are left. Returns how many there are. */
static int own_options(int argc, char **argv, char *files, size_t size) {
    const char *list = getenv("MCS_TEST_MAPS");
    int n = 1;
    snprintf(files, size, "%s", list ? list : "");
    for (int i = 1; i < argc; i++) {
        const size_t length = strlen(files);
        if (!strcmp(argv[i], "--table")) table = 1;
        else if (!strcmp(argv[i], "--each")) each = 1;
        else if (!strcmp(argv[i], "--map") && i + 1 < argc) snprintf(files + length, size - length, " %s", argv[++i]);
        else argv[n++] = argv[i];
    }
    return n;
}
int main(int argc, char **argv) {
    char files[4096];
    const int n = own_options(argc, argv, files, sizeof files);
    if (mcst_scale() >= 1) mcst.seed = (uint64_t)time(NULL) / 86400;
    mcst_start(n, argv);
    mcst_group("fireflies");
    for (int k = 0; !table && !each && k <= 2; k += 2)
        if (mcst_case("a lamp that the horizon cuts, %s", materials[k].name)) check_turning(k);
    for (int k = 0; k < MADE_UP; k++) {
        picture m = picture_made_up(k);
        check_picture(&m);
        picture_free(&m);
    }
    for (char *file = strtok(files, " "); file; file = strtok(NULL, " ")) {
        picture m = picture_read(file, mcst_scale() < 1 ? 2 : 1);
        check_picture(&m);
        picture_free(&m);
    }
    if (table) tallies_print();
    if (table || each) return mcst_finish();
    mcst_group("fireflies, climbing");
    const trial below = lamp_below_the_horizon();
    const trial in_the_tail = lamp_in_the_tail();
    if (mcst_case("a lamp below the horizon")) check_found(&below, 3000);
    if (mcst_case("a lamp in the tail of Ashikhmin-Shirley")) check_found(&in_the_tail, 10);
    for (int kind = 0; kind < KINDS; kind++)
        if (mcst_case("%s", materials_of[kind])) attack((material_kind)kind);
    mcst_close_group();
    if (mcst.failed || mcst.verbose) printf("seed %llu\n", (unsigned long long)mcst.seed);
    return mcst_finish();
}
