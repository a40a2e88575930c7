/* render_progress.h - how long render.c goes on with a picture: its passes, when they end, and what a watcher sees. */
#ifndef RENDER_PROGRESS_H
#define RENDER_PROGRESS_H
#include <time.h>
#include <unistd.h>
#include "render_report.h"

#define PASS 16 /* samples per pixel between two looks at the error; 1 with --seconds */

typedef struct {
    const char *what;
    int watched;       /* whether somebody sees it */
    double start, cpu; /* seconds, on the clock and of all threads, when it began */
    double told;       /* seconds on the clock when it was shown last */
    double done, all;  /* rows times samples: so far, and as many as are likely */
} progress;

static double seconds(clockid_t clock_id) {
    struct timespec t;
    clock_gettime(clock_id, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static progress progress_start(const options *o, strategy how) {
    const unsigned rows = (o->height + o->parts - o->part) / o->parts;
    progress bar;
    bar.what = strategy_name[how];
    bar.watched = isatty(fileno(stderr));
    bar.start = seconds(CLOCK_MONOTONIC);
    bar.cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    bar.told = bar.done = 0;
    bar.all = rows * (double)o->spp;
    return bar;
}

/* So many samples of each pixel of a row. */
static void progress_row(progress *bar, uint32_t samples) {
    if (!bar->watched) return;
    OMP(omp critical(progress)) {
        const double now = seconds(CLOCK_MONOTONIC);
        bar->done += samples;
        if (now - bar->told > 0.2) {
            bar->told = now;
            fprintf(stderr, "\r%-8s %.0f %%, %.0f s left \033[K", bar->what, 100 * bar->done / bar->all,
                    fmax(0, (now - bar->start) * (bar->all / bar->done - 1)));
        }
    }
}

/* Behind a pass: the error falls with the root of the samples. */
static void progress_pass(progress *bar, const options *o, outcome *result) {
    result->cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - bar->cpu;
    double longer = INFINITY;
    if (o->error > 0 && result->mean > 0) longer = pow(result->error / (o->error * result->mean), 2);
    if (o->seconds > 0) longer = fmin(longer, o->seconds / result->cpu);
    bar->all = fmin(bar->all, bar->done * fmax(1, longer));
}

static void progress_end(const progress *bar, outcome *result) {
    if (bar->watched) fputs("\r\033[K", stderr);
    result->wall = seconds(CLOCK_MONOTONIC) - bar->start;
}

/* Whether another pass is needed. */
static int unfinished(const options *o, const outcome *result) {
    if (o->error > 0 && result->spp > 0 && result->error <= o->error * result->mean) return 0;
    if (o->seconds > 0 && result->spp > 1 && result->cpu >= o->seconds) return 0;
    return result->spp < o->spp;
}

/* When a strategy learns that learns: after 1, 2, 4, 8, ... samples of each pixel. */
static int lesson_is_due(unsigned done) { return (done & (done - 1)) == 0; }

/* Samples per pixel of the next pass: it ends where a lesson is due. */
static unsigned pass_length(const options *o, int learns, unsigned done) {
    const unsigned left = o->spp - done;
    const unsigned most = o->seconds > 0 ? 1 : left < PASS ? left : PASS;
    unsigned samples = 1;
    while (samples < most && !(learns && lesson_is_due(done + samples))) samples++;
    return samples;
}

#endif
