/* render_report.h - what render.c tells of a picture: its error and its cost, in tables. */
#ifndef RENDER_REPORT_H
#define RENDER_REPORT_H
#include "render_picture.h"

typedef struct {
    unsigned spp;
    double samples, wall, cpu; /* light samples; seconds on the clock, and of all threads together */
    double mean, error;        /* of the luminance of the picture; the standard error of that mean, INFINITY: unknown */
    double mse[OBJECTS];       /* mean squared error of a pixel, by object */
} outcome;

/* The pixels are strata of equal size, each with its own independent samples: the variance of the mean of the picture
 * is the sum of the variances of the pixel means over the square of their number. What differs between pixels is
 * picture, not error. As with any estimate: where samples hardly ever find a small bright light, both the mean and its
 * error come out low until they do. */
static void picture_statistics(const pixel_sums *pixel, size_t count, outcome *result) {
    double pixels = 0;
    double variance = 0;
    double pixels_of[OBJECTS] = {0};
    result->mean = result->samples = 0;
    memset(result->mse, 0, sizeof result->mse);
    for (const pixel_sums *end = pixel + count; pixel < end; pixel++) {
        if (!(pixel->luminance.n > 0)) continue; /* in another part */
        pixels++;
        const double error = mcs_stat_error(&pixel->luminance);
        result->mean += pixel->luminance.mean;
        result->samples += pixel->drawn;
        variance += error * error;
        if (pixel->object != NO_OBJECT) {
            result->mse[pixel->object] += error * error;
            pixels_of[pixel->object]++;
        }
    }
    for (int i = 0; i < OBJECTS; i++) result->mse[i] /= fmax(pixels_of[i], 1);
    result->mean /= pixels;
    result->error = result->spp > 1 ? sqrt(variance) / pixels : INFINITY; /* one sample tells nothing of its error */
}

static double efficiency(const outcome *result) {
    return result->error > 0 && result->cpu > 0 ? 1 / (result->error * result->error * result->cpu) : 0;
}

/* Sends what has been printed on its way: to a file or a pipe nothing would go before the end, and nothing at all after
 * Ctrl-C. */
static int flush_output(void) {
    if (fflush(stdout) != 0 || ferror(stdout)) return complain("standard output", "cannot write: %s", strerror(errno));
    return 1;
}

static void print_title(const options *o, const environment *e) {
    if (has_lamps(o->kind)) printf("two lamps, ");
    else printf("%s %u x %u, ", o->map ? o->map : "built-in sky", e->map.w, e->map.h);
    printf("picture %u x %u, ", o->width, o->height);
    if (o->given[O_PART]) printf("part %u of %u, ", o->part, o->parts);
    printf("%d thread%s\n", o->threads, o->threads > 1 ? "s" : "");
}

static void print_head(void) { puts("strategy  spp     samples    wall s   cpu s       mean  std error  efficiency"); }

static void print_row(strategy how, const outcome *result) {
    printf("%-8s%5u  %10.0f  %8.2f  %6.2f  %9.6g", strategy_name[how], result->spp, result->samples, result->wall,
           result->cpu, result->mean);
    if (result->spp > 1) printf("  %9.3g  %10.4g\n", result->error, efficiency(result));
    else printf("  %9s  %10s\n", "unknown", "unknown");
}

static void print_comparison(const options *o, const outcome *result) {
    int best = -1;
    for (int i = 0; i < STRATEGIES; i++)
        if (o->wanted[i] && (best < 0 || efficiency(&result[i]) > efficiency(&result[best]))) best = i;
    const double most = efficiency(&result[best]);
    puts("\nstrategy  of best  deviation");
    for (int i = 0; i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        const double error = fmax(hypot(result[i].error, result[best].error), 1e-300);
        printf("%-8s  %7.3f  %9.2f\n", strategy_name[i], most > 0 ? efficiency(&result[i]) / most : 1,
               i != best ? (result[i].mean - result[best].mean) / error : 0);
    }
    puts("of best: efficiency over the highest;\n"
         "deviation: from the mean of the most efficient, in standard errors of the difference");
}

/* Over the pixels that show nothing but that object. */
static void print_objects(const options *o, const outcome *result) {
    const int objects = o->kind == ROOM ? OBJECTS : WALLS;
    printf("\nmean squared error of a pixel x cpu s, over that of mis\nstrategy");
    for (int k = 0; k < objects; k++) printf(" %9s", object_name(o->kind, k));
    putchar('\n');
    for (int i = 0; i < STRATEGIES; i++) {
        if (!o->wanted[i] || i == MIS) continue;
        printf("%-8s", strategy_name[i]);
        for (int k = 0; k < objects; k++) {
            const double mis = result[MIS].mse[k] * result[MIS].cpu;
            printf(" %9.3g", mis > 0 ? result[i].mse[k] * result[i].cpu / mis : 0);
        }
        putchar('\n');
    }
}

static void print_files(const options *o) {
    if (o->given[O_PART]) printf("files: %s-STRATEGY-%u-of-%u.sums, for --merge\n", o->out, o->part, o->parts);
    else printf("files: %s-STRATEGY.png and .hdr\n", o->out);
}

static void print_tables(const options *o, unsigned count, const outcome *result) {
    puts("samples: light samples; efficiency: 1 / (std error^2 x cpu s)");
    print_files(o);
    if (count < 2 || o->spp < 2 || o->given[O_PART]) return;
    print_comparison(o, result);
    if (o->wanted[MIS]) print_objects(o, result);
}

static int reached_error(const options *o, const outcome *result) {
    char error[64];
    for (int i = 0; i < STRATEGIES; i++)
        if (o->wanted[i] && o->error > 0 && !(result[i].error <= o->error * result[i].mean))
            return complain(strategy_name[i], "error %s not reached with %u sample%s per pixel", plain(o->error, error),
                            result[i].spp, result[i].spp > 1 ? "s" : "");
    return 1;
}

#endif
