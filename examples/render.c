/* render.c - the main example of mcsample.h: how a renderer uses it.
 *
 * A row of spheres, one per BRDF, on a matte ground, in the open or in a room, lit by a latitude-longitude environment
 * map: direct illumination with visibility, estimated by uniform, cosine, BRDF, environment, multiple importance or
 * product sampling, or by tables of regions that learn which light they see. Writes PNG and Radiance .hdr pictures and
 * prints what each strategy cost and how far its mean may be off.
 *
 *     cc -O2 -std=c99 -I. -fopenmp examples/render.c -o render -lm       (-fopenmp is optional: without it, one thread)
 *     ./render --strategy all sunrise.hdr
 *
 * Here are the loop over pixels, the tables that are printed, the joining of parts, and main. The rest, by subject:
 *
 *     render_strategy.h    direct illumination: where each strategy calls mcsample.h
 *     render_learning.h    regions of the scene, which learn from shadow rays
 *     render_material.h    materials made of the BRDFs of mcsample.h
 *     render_light.h       the environment map
 *     render_scene.h       spheres, ground, room and camera
 *     render_options.h     the command line
 *     render_picture.h     PNG and Radiance files
 *     render_parts.h       files of parts of a picture, made by many processes
 *
 * World: z up, lengths in sphere radii. Shading happens in the local frame of mcsample.h: normal on +z, wo to the eye,
 * wi to the light. Colours are linear RGB with the primaries of sRGB, kept in a vec3.
 */
#define _POSIX_C_SOURCE 200809L /* clock_gettime, fileno, isatty */
#include <time.h>
#include <unistd.h>
#include "render_parts.h"
#include "render_strategy.h"

/* ---- Rendering ---- */

#define PASS 16 /* samples per pixel between two looks at the error; 1 with --seconds */

typedef struct {
    unsigned spp;
    double samples, wall, cpu; /* light samples; seconds on the clock, and of all threads together */
    double mean, error;        /* of the luminance of the picture; the standard error of that mean, INFINITY: unknown */
    double mse[OBJECTS];       /* mean squared error of a pixel, by object */
} outcome;

typedef struct {
    const char *what;
    double start, last, rows, done; /* seconds; rows times samples, -1 where nobody watches */
} progress;

static double seconds(clockid_t clock_id) {
    struct timespec t;
    clock_gettime(clock_id, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void progress_row(progress *p, uint32_t samples) {
    if (p->rows < 0) return;
    OMP(omp critical(progress)) {
        const double now = seconds(CLOCK_MONOTONIC);
        p->done += samples;
        if (now - p->last > 0.2) {
            p->last = now;
            fprintf(stderr, "\r%-8s %.0f %%, %.0f s left \033[K", p->what, 100 * p->done / p->rows,
                    fmax(0, (now - p->start) * (p->rows / p->done - 1)));
        }
    }
}

/* What is rendered, and how. */
typedef struct {
    const options *o;
    const scene *s;
    const environment *e;
    strategy how;
    learning *l; /* NULL for strategies that do not learn */
} job;

static void render_pixel(const job *j, float x, float y, pixel *p, shadow_rays *rays) {
    const float px = (x + mcs_pcg32_float(&p->rng)) / (float)j->o->w; /* a box filter: anywhere in the pixel */
    const float py = (y + mcs_pcg32_float(&p->rng)) / (float)j->o->h;
    const vec3 w = camera_ray(j->s, px, py);
    surface at;
    vec3 c;
    if (intersect(j->s, j->s->eye, w, &at)) {
        const uint16_t number = j->l ? region_of(j->l, j->s, &at) : 0;
        lit_point here = {j->s, j->e, &at, &p->rng, j->l, number, rays, 0};
        c = direct(&here, j->how, j->o->lights);
        p->drawn += here.drawn;
    } else {
        c = radiance(j->e, w);
    }
    p->object = p->luminance.n > 0 && at.object != p->object ? NO_OBJECT : at.object;
    p->sum = add(p->sum, c);
    mcs_stat_add(&p->luminance, luminance(c));
}

/* n samples of each pixel of row y. */
static void render_row(const job *j, uint32_t y, uint32_t n, pixel *row) {
    shadow_rays rays;
    rays.count = 0;
    for (uint32_t x = 0; x < j->o->w; x++)
        for (uint32_t i = 0; i < n; i++) render_pixel(j, (float)x, (float)y, row + x, &rays);
    if (j->l) shadow_rays_deliver(j->l, &rays);
}

/* Samples per pixel of the next pass. What learns begins with short passes, 1, 1, 2, 4, ...: it learns each time that
 * the samples have doubled. */
static unsigned pass_length(const job *j, unsigned done) {
    unsigned n = PASS;
    if (j->l && done < n) n = done > 0 ? done : 1;
    if (j->o->seconds > 0) n = 1;
    return n < j->o->spp - done ? n : j->o->spp - done;
}

/* The pixels are strata of equal size, each with its own independent samples: the variance of the mean of the picture
 * is the sum of the variances of the pixel means over the square of their number. What differs between pixels is
 * picture, not error. As with any estimate: where samples hardly ever find a small bright light, both the mean and its
 * error come out low until they do. */
static void picture_statistics(const pixel *p, size_t n, outcome *r) {
    double pixels = 0;
    double variance = 0;
    double count[OBJECTS] = {0};
    r->mean = r->samples = 0;
    memset(r->mse, 0, sizeof r->mse);
    for (size_t i = 0; i < n; i++) {
        if (!(p[i].luminance.n > 0)) continue; /* in another part */
        pixels++;
        const double e = mcs_stat_error(&p[i].luminance);
        r->mean += p[i].luminance.mean;
        r->samples += p[i].drawn;
        variance += e * e;
        if (p[i].object != NO_OBJECT) {
            r->mse[p[i].object] += e * e;
            count[p[i].object]++;
        }
    }
    for (int k = 0; k < OBJECTS; k++) r->mse[k] /= fmax(count[k], 1);
    r->mean /= pixels;
    r->error = r->spp > 1 ? sqrt(variance) / pixels : INFINITY; /* one sample tells nothing of its error */
}

/* Whether another pass is needed. */
static int unfinished(const options *o, const outcome *r) {
    if (o->error > 0 && r->spp > 0 && r->error <= o->error * r->mean) return 0;
    if (o->seconds > 0 && r->spp > 1 && r->cpu >= o->seconds) return 0;
    return r->spp < o->spp;
}

static void render_passes(const job *j, pixel *image, outcome *r, progress *p) {
    const options *o = j->o;
    const double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - r->cpu;
    while (unfinished(o, r)) {
        const uint32_t n = pass_length(j, r->spp);
        OMP(omp parallel for schedule(dynamic) num_threads(o->threads))
        for (int y = (int)o->part - 1; y < (int)o->h; y += (int)o->parts) {
            render_row(j, (uint32_t)y, n, image + (size_t)y * o->w);
            progress_row(p, n);
        }
        r->spp += n;
        if (j->l && (r->spp & (r->spp - 1)) == 0) learning_advance(j->l);
        picture_statistics(image, (size_t)o->w * o->h, r);
        if (p->rows >= 0 && o->error > 0 && r->mean > 0) /* the error falls with the root of the samples */
            p->rows = fmin(p->rows, p->done * fmax(1, pow(r->error / (o->error * r->mean), 2)));
        r->cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
        if (p->rows >= 0 && o->seconds > 0) p->rows = fmin(p->rows, p->done * fmax(1, o->seconds / r->cpu));
    }
}

/* Every pixel has its own stream, seeded from (seed, pixel, strategy), and owns all that it changes. What pixels learn
 * from each other changes between passes only. So the picture does not depend on the number of threads. Returns 0 after
 * a complaint. */
static int render(const options *o, const scene *s, const environment *e, strategy how, pixel *image, outcome *r) {
    const size_t pixels = (size_t)o->w * o->h;
    memset(r, 0, sizeof *r);
    progress p = {strategy_name[how], seconds(CLOCK_MONOTONIC), 0, 0, 0};
    p.rows = (o->h + o->parts - o->part) / o->parts * (double)o->spp;
    const double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    const int watched = isatty(fileno(stderr));
    if (!watched) p.rows = -1;
    for (size_t i = 0; i < pixels; i++) {
        memset(&image[i], 0, sizeof image[i]);
        image[i].rng = mcs_pcg32_for(o->seed, i, how);
    }
    job j = {o, s, e, how, NULL};
    if (how == REGION || how == LEARNED) {
        j.l = learning_make(s, e, pixels, how == REGION);
        if (!j.l) return 0;
    }
    r->cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    render_passes(&j, image, r, &p);
    if (watched) fputs("\r\033[K", stderr);
    r->wall = seconds(CLOCK_MONOTONIC) - p.start;
    learning_free(j.l);
    return 1;
}

/* ---- The command ---- */

/* Sends what has been printed on its way: to a file or a pipe nothing would go before the end, and nothing at all after
 * Ctrl-C. */
static int flush_output(void) {
    if (fflush(stdout) != 0 || ferror(stdout)) return complain("standard output", "cannot write: %s", strerror(errno));
    return 1;
}

static double efficiency(const outcome *r) {
    return r->error > 0 && r->cpu > 0 ? 1 / (r->error * r->error * r->cpu) : 0;
}

static void print_head(void) { puts("strategy  spp     samples    wall s   cpu s       mean  std error  efficiency"); }

static void print_row(strategy how, const outcome *r) {
    printf("%-8s%5u  %10.0f  %8.2f  %6.2f  %9.6g", strategy_name[how], r->spp, r->samples, r->wall, r->cpu, r->mean);
    if (r->spp > 1) printf("  %9.3g  %10.4g\n", r->error, efficiency(r));
    else printf("  %9s  %10s\n", "unknown", "unknown");
}

static void print_comparison(const options *o, const outcome *result) {
    int best = -1;
    for (int i = 0; i < STRATEGIES; i++)
        if (o->wanted[i] && (best < 0 || efficiency(&result[i]) > efficiency(&result[best]))) best = i;
    puts("\nstrategy  of best  deviation");
    for (int i = 0; i < STRATEGIES; i++) {
        const outcome *r = &result[i];
        const outcome *b = &result[best];
        if (!o->wanted[i]) continue;
        printf("%-8s  %7.3f  %9.2f\n", strategy_name[i], efficiency(b) > 0 ? efficiency(r) / efficiency(b) : 1,
               i != best ? (r->mean - b->mean) / fmax(hypot(r->error, b->error), 1e-300) : 0);
    }
    puts("of best: efficiency over the highest;\n"
         "deviation: from the mean of the most efficient, in standard errors of the difference");
}

/* Over the pixels that show nothing but that object. */
static void print_objects(const options *o, const outcome *result) {
    static const char *const name[] = {"matte",  "Phong",  "Ward.18", "Ward ani", "GGX.06",
                                       "GGX.12", "GGX.40", "A.-S.",   "ground",   "walls"};
    const int objects = o->in_room ? OBJECTS : WALLS;
    printf("\nmean squared error of a pixel x cpu s, over that of mis\nstrategy");
    for (int k = 0; k < objects; k++) printf(" %9s", name[k]);
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

/* Renders every strategy that is wanted, prints its row and writes its pictures. `next` is how far the image of one is
 * from that of the next: 0 where all share one. Returns 0 after a complaint. */
static int render_all(const options *o, const scene *s, const environment *e, pixel *image, size_t next,
                      outcome *result) {
    printf("%s %u x %u, picture %u x %u, ", o->map ? o->map : "built-in sky", e->map.w, e->map.h, o->w, o->h);
    if (o->given[O_PART]) printf("part %u of %u, ", o->part, o->parts);
    printf("%d thread%s\n", o->threads, o->threads > 1 ? "s" : "");
    print_head();
    int ok = flush_output();
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        ok = render(o, s, e, (strategy)i, image, &result[i]);
        if (ok) print_row((strategy)i, &result[i]);
        const double took[2] = {result[i].wall, result[i].cpu};
        ok = ok && flush_output();
        if (ok && o->given[O_PART]) ok = sums_write(o, (strategy)i, e, image, took);
        else if (ok) ok = write_pictures(o, (strategy)i, e, image);
        image += next;
    }
    return ok;
}

static void print_tables(const options *o, unsigned count, const outcome *result) {
    puts("samples: light samples; efficiency: 1 / (std error^2 x cpu s)");
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

/* ---- Parts ---- */

static unsigned count_strategies(const options *o) {
    unsigned count = 0;
    for (int i = 0; i < STRATEGIES; i++) count += o->wanted[i] != 0;
    return count;
}

/* Reads the pixels of all files, `image` being all zeros, and prints the rows that single runs print. Processor times
 * are added; of wall times, the longest stays. Returns 0 after a complaint. */
static int merge_files(const options *asked, const options *o, pixel *image, outcome *result) {
    const size_t pixels = (size_t)o->w * o->h;
    pixel *start[STRATEGIES] = {NULL};
    for (int i = 0; i < STRATEGIES; i++) {
        start[i] = image;
        if (o->wanted[i]) image += pixels;
    }
    memset(result, 0, STRATEGIES * sizeof *result);
    for (int i = 0; i < asked->files; i++) {
        sums s;
        if (!sums_read(asked->file[i], &s, start)) return 0;
        result[s.how].wall = fmax(result[s.how].wall, s.wall);
        result[s.how].cpu += s.cpu;
    }
    for (int i = 0; i < STRATEGIES; i++)
        if (o->wanted[i] && !sums_complete(o, (strategy)i, start[i])) return 0;
    printf("%u parts, picture %u x %u\n", o->parts, o->w, o->h);
    print_head();
    for (int i = 0; i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        result[i].spp = o->spp;
        picture_statistics(start[i], pixels, &result[i]);
        print_row((strategy)i, &result[i]);
    }
    return 1;
}

/* Does what a single run does behind the rendering. Returns 0 after a complaint. */
static int merge(const options *asked) {
    sums first;
    if (!sums_survey(asked, &first) || !can_write_pictures(&first.o)) return 0;
    const options *o = &first.o;
    environment e;
    memset(&e, 0, sizeof e);
    e.irradiance = bits_float(first.irradiance);
    const unsigned count = count_strategies(o);
    const size_t pixels = (size_t)o->w * o->h;
    pixel *image = calloc(count * pixels, sizeof *image);
    outcome result[STRATEGIES];
    int ok = image ? merge_files(asked, o, image, result) : complain("--merge", "not enough memory for the picture");
    if (ok) print_tables(o, count, result);
    ok = ok && flush_output();
    const pixel *next = image;
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        ok = write_pictures(o, (strategy)i, &e, next);
        next += pixels;
    }
    ok = ok && write_sheets(o, &e, image, count);
    free(image);
    return ok;
}

/* ---- Main ---- */

int main(int argc, char **argv) {
    options o;
    if (!parse_arguments(argc, argv, &o)) return 2;
    if (o.help) {
        usage();
        return flush_output() ? 0 : 1;
    }
    if (o.merge) return merge(&o) ? 0 : 1;
    if (!(o.given[O_PART] ? can_write_sums(&o) : can_write_pictures(&o))) return 1;
    const unsigned count = count_strategies(&o);
    const size_t pixels = (size_t)o.w * o.h;
    const int sheets = o.stack || o.beside; /* they need all pictures at once */
    pixel *image;
    image = malloc((sheets ? count : 1) * pixels * sizeof *image);
    environment e;
    memset(&e, 0, sizeof e);
    int ok = image ? environment_make(&e, o.map) : complain("--size", "not enough memory for the picture");
    if (ok) {
        const scene s = scene_make(o.in_room, o.w, o.h, e.main_light);
        outcome result[STRATEGIES];
        ok = render_all(&o, &s, &e, image, sheets ? pixels : 0, result);
        if (ok) print_tables(&o, count, result);
        ok = ok && flush_output() && (!sheets || write_sheets(&o, &e, image, count)) && reached_error(&o, result);
    }
    free(image);
    free(e.map.pixel);
    free(e.table);
    free(e.tiles);
    return ok ? 0 : 1;
}
