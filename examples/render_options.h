/* render_options.h - the command line of render.c. */
#ifndef RENDER_OPTIONS_H
#define RENDER_OPTIONS_H
#include <errno.h>
#include "render_base.h"

#ifdef _OPENMP
#include <omp.h>
#define OMP(directive) _Pragma(#directive)
#else
#define OMP(directive)
#endif

typedef enum { OPEN, ROOM, LAMPS, HAZE, SCENES } scene_kind;
static const char *const scene_name[SCENES] = {"spheres", "room", "lamps", "haze"};

static int has_lamps(scene_kind kind) { return kind == LAMPS || kind == HAZE; }

/* Those from ANGLE on are for lamps alone, those that name an environment or its tables for the other scenes. AREA is
 * not for haze: next to a lamp its values have no bound, and their variance is infinite. */
typedef enum { UNIFORM, COSINE, BRDF, ENVIRONMENT, MIS, PRODUCT, REGION, LEARNED, ANGLE, AREA, STRATEGIES } strategy;
static const char *const strategy_name[STRATEGIES] = {"uniform", "cosine", "brdf",    "env",   "mis",
                                                      "product", "region", "learned", "angle", "area"};

static int strategy_fits(strategy how, scene_kind kind) {
    if (how == ANGLE) return has_lamps(kind);
    if (how == AREA) return kind == LAMPS;
    return !has_lamps(kind) || how <= BRDF || how == MIS;
}

typedef enum {
    O_SCENE,
    O_STRATEGY,
    O_SIZE,
    O_OUT,
    O_STACK,
    O_BESIDE,
    O_PART,
    O_SPP,
    O_LIGHTS,
    O_SECONDS,
    O_ERROR,
    O_STOPS,
    O_THREADS,
    O_SEED,
    OPTIONS
} option;

typedef struct {
    unsigned width, height, spp, lights;
    double seconds; /* of processor time after which to stop, 0: take spp samples */
    double error;   /* relative standard error of the mean at which to stop, 0: take spp samples */
    uint64_t seed;
    unsigned part, parts; /* from 1; 1 and 1: the whole */
    scene_kind kind;
    int help, merge, threads, all, wanted[STRATEGIES]; /* all: every strategy that fits the scene */
    int given[OPTIONS];                                /* which options were */
    int files;
    char **file; /* the map, or what to merge */
    float stops;
    const char *out, *map, *stack, *beside;
} options;

static void usage(void) {
    fputs(
        "usage: render [options] [map.hdr]     (--option value or --option=value)\n"
        "Spheres under a Radiance environment map (row 0 up), or under a built-in sky with a sun.\n"
        "  --scene NAME       spheres: in the open; room: the same in a room with one window; lamps: at night by a\n"
        "                     rectangle and a ball, two of the spheres being of glass; haze: lamps in haze, without\n"
        "                     glass (spheres)\n"
        "  --strategy LIST    uniform, cosine, brdf, env; mis: the last two; product: map times BRDF; region: tables\n"
        "                     of parts of the scene, and brdf; learned: products that know what such a part sees;\n"
        "                     several with commas, or all (mis). With lamps uniform, cosine, brdf, mis, angle, area:\n"
        "                     lamps evenly in either; in haze the same but area\n"
        "  --spp N            samples per pixel (64; with --error or --seconds: at most N, 16384); 1 leaves the "
        "error unknown\n"
        "  --lights N         estimates of the light at each point that a sample sees (1)\n"
        "  --seconds T        stop each strategy after T seconds of processor time: pictures of equal cost\n"
        "  --error E          stop when the standard error of the mean of the picture is E times the mean\n"
        "  --size WxH         size of the picture (960x320)\n"
        "  --stops X          brighten the PNG by X stops from what suits the map (0)\n"
        "  --out PREFIX       write PREFIX-STRATEGY.png and PREFIX-STRATEGY.hdr (render)\n"
        "  --stack FILE       write all pictures into one PNG too, one below the other\n"
        "  --beside FILE      the same, one beside the other\n"
        "  --threads N        threads (all processors; one if built without OpenMP); the picture does not depend on "
        "it\n"
        "  --seed N           another set of random numbers (1)\n"
        "  --part K/N         render every Nth row from the Kth one on, and write what --merge needs into\n"
        "                     PREFIX-STRATEGY-K-of-N.sums; not for region and learned, which learn from all rows\n"
        "  --merge FILES      join all parts to the tables and pictures of a single run, bit for bit\n"
        "  -h, --help         this text\n"
        "Brackets at the end of an option's text hold its default.\n"
        "The exit status is 0, 2 for a wrong argument, 1 if anything else fails or the error is not reached.\n"
        "The camera has the main light of the map behind it at the left.\n"
        "examples/product.png: render --strategy mis,product --lights 16 --seconds 2 --size 480x160 --threads 1\n"
        "    --out build/product --stack examples/product.png\n"
        "examples/room.png: render --scene room --strategy mis,region --seconds 4 --size 344x158 --threads 1\n"
        "    --out build/room --beside examples/room.png\n"
        "Parts, by eight processes here, by Open MPI or by Slurm, and what joins them:\n"
        "    seq 8 | xargs -P 8 -I{} render --threads 1 --out s --part {}/8\n"
        "    mpirun -n 8 sh -c 'render --threads 1 --out s --part $((OMPI_COMM_WORLD_RANK + 1))/8'\n"
        "    srun -n 8 sh -c 'render --threads 1 --out s --part $((SLURM_PROCID + 1))/8'\n"
        "    render --merge s-*-of-8.sums --out s\n",
        stdout);
}

/* The shortest decimal text of a number without an exponent. */
static const char *plain(double v, char text[64]) {
    int digits = 0;
    do snprintf(text, 64, "%.*f", digits, v);
    while (strtod(text, NULL) != v && digits++ < 20);
    return text;
}

static int parse_name(const char *name, const char *text, const char **value) {
    if (!*text) return complain(name, "the name is empty");
    *value = text;
    return 1;
}

static int parse_size(const char *text, options *o) {
    char more;
    if (sscanf(text, "%6ux%6u%c", &o->width, &o->height, &more) != 2)
        return complain("--size", "'%s' is not WIDTHxHEIGHT", text);
    if (o->width - 1 < 16384 && o->height - 1 < 16384 && o->width * o->height <= 1u << 25) return 1;
    return complain("--size", "each side is from 1 to 16384, with at most %u pixels in all", 1u << 25);
}

static int parse_part(const char *text, options *o) {
    char more;
    if (sscanf(text, "%6u/%6u%c", &o->part, &o->parts, &more) == 2 && o->part - 1 < o->parts) return 1;
    return complain("--part", "'%s' is not K/N, part K of N", text);
}

static int parse_scene_kind(const char *text, scene_kind *kind) {
    int i = 0;
    while (i < SCENES && strcmp(text, scene_name[i])) i++;
    *kind = (scene_kind)i;
    return i < SCENES;
}

static int parse_scene(const char *text, options *o) {
    if (parse_scene_kind(text, &o->kind)) return 1;
    return complain("--scene", "'%s' is none of spheres, room, lamps, haze", text);
}

static int parse_strategies(const char *list, options *o) {
    memset(o->wanted, 0, sizeof o->wanted);
    o->all = 0;
    for (;;) {
        const size_t n = strcspn(list, ",");
        int known = n == 3 && !strncmp(list, "all", 3);
        if (known) o->all = 1;
        for (int i = 0; i < STRATEGIES; i++)
            if (n == strlen(strategy_name[i]) && !strncmp(list, strategy_name[i], n)) known = o->wanted[i] = 1;
        if (!known)
            return complain(
                "--strategy",
                "'%.*s' is none of uniform, cosine, brdf, env, mis, product, region, learned, angle, area, all", (int)n,
                list);
        if (!list[n]) return 1;
        list += n + 1;
    }
}

static const struct {
    const char *name;
    double low, high; /* of numbers */
    int whole;
} option_table[OPTIONS] = {{"--scene", 0, 0, 0},        {"--strategy", 0, 0, 0}, {"--size", 0, 0, 0},
                           {"--out", 0, 0, 0},          {"--stack", 0, 0, 0},    {"--beside", 0, 0, 0},
                           {"--part", 0, 0, 0},         {"--spp", 1, 1e6, 1},    {"--lights", 1, 4096, 1},
                           {"--seconds", 1e-3, 1e6, 0}, {"--error", 1e-7, 1, 0}, {"--stops", -20, 20, 0},
                           {"--threads", 1, 1024, 1},   {"--seed", 0, 9e15, 1}};

static int parse_number(option which, const char *text, double *value) {
    const double low = option_table[which].low;
    const double high = option_table[which].high;
    const int whole = option_table[which].whole;
    errno = 0;
    char *end;
    *value = strtod(text, &end);
    if (end != text && !*end && !errno && *value >= low && *value <= high && (!whole || *value == floor(*value)))
        return 1;
    char from[64], to[64];
    return complain(option_table[which].name, "'%s' is not a %s from %s to %s", text, whole ? "whole number" : "number",
                    plain(low, from), plain(high, to));
}

static int parse_value(option which, const char *text, options *o) {
    switch (which) {
    case O_SCENE: return parse_scene(text, o);
    case O_STRATEGY: return parse_strategies(text, o);
    case O_SIZE: return parse_size(text, o);
    case O_OUT: return parse_name(option_table[which].name, text, &o->out);
    case O_STACK: return parse_name(option_table[which].name, text, &o->stack);
    case O_BESIDE: return parse_name(option_table[which].name, text, &o->beside);
    case O_PART: return parse_part(text, o);
    default: break;
    }
    double v;
    if (!parse_number(which, text, &v)) return 0;
    switch (which) {
    case O_SPP: o->spp = (uint32_t)v; break;
    case O_LIGHTS: o->lights = (uint32_t)v; break;
    case O_SECONDS: o->seconds = v; break;
    case O_ERROR: o->error = v; break;
    case O_STOPS: o->stops = (float)v; break;
    case O_THREADS: o->threads = (int)v; break;
    default: o->seed = (uint64_t)v;
    }
    return 1;
}

static unsigned count_strategies(const options *o) {
    unsigned count = 0;
    for (int i = 0; i < STRATEGIES; i++) count += o->wanted[i] != 0;
    return count;
}

/* The option that an argument names, alone or with =value. OPTIONS: none. */
static option find_option(const char *argument) {
    const size_t n = strcspn(argument, "=");
    int i = 0;
    while (i < OPTIONS && !(strlen(option_table[i].name) == n && !strncmp(argument, option_table[i].name, n))) i++;
    return (option)i;
}

/* Whether options go together. Returns 0 after a complaint. */
static int check_scene(options *o) {
    if (has_lamps(o->kind) && o->files > 0) return complain(o->file[0], "--scene %s takes no map", scene_name[o->kind]);
    for (int i = 0; i < STRATEGIES; i++) {
        if (o->all && strategy_fits((strategy)i, o->kind)) o->wanted[i] = 1;
        if (o->wanted[i] && !strategy_fits((strategy)i, o->kind))
            return complain("--strategy", "'%s' is not for --scene %s", strategy_name[i], scene_name[o->kind]);
    }
    return 1;
}

static int check_part(const options *o) {
    if (o->wanted[REGION] || o->wanted[LEARNED])
        return complain("--part", "region and learned learn from the whole picture");
    if (o->seconds > 0 || o->error > 0)
        return complain("--part", "--spp alone says when a part ends, neither --seconds nor --error");
    if (o->given[O_STOPS] || o->stack || o->beside)
        return complain("--part", "--stops, --stack and --beside are for --merge, which writes the pictures");
    if (o->parts > o->height) return complain("--part", "%u rows are no %u parts", o->height, o->parts);
    return 1;
}

static int check_merge(const options *o) {
    for (int i = 0; i < OPTIONS; i++)
        if (o->given[i] && i != O_OUT && i != O_STOPS && i != O_STACK && i != O_BESIDE)
            return complain(option_table[i].name, "is not for --merge: the files say what was rendered");
    if (o->files == 0) return complain("--merge", "no files are given");
    return 1;
}

static int check_options(options *o) {
    if (o->merge) return check_merge(o);
    if (o->files > 1) return complain(o->file[1], "only one map can be given");
    if (o->files == 1) o->map = o->file[0];
    return check_scene(o) && (!o->given[O_PART] || check_part(o));
}

/* Returns 0 for a wrong argument. Moves the names of files to the front of argv. */
static int parse_arguments(int argc, char **argv, options *o) {
    memset(o, 0, sizeof *o);
    o->part = o->parts = 1;
    o->file = argv;
    o->width = 960;
    o->height = 320;
    o->seed = 1;
    o->lights = 1;
    o->wanted[MIS] = 1;
    o->out = "render";
    for (int i = 1; i < argc; i++) {
        const option which = find_option(argv[i]);
        const char *text = strchr(argv[i], '=');
        if (!strcmp(argv[i], "-h") || !strcmp(argv[i], "--help")) return o->help = 1;
        if (argv[i][0] != '-') {
            if (!*argv[i]) return complain("map", "the name is empty");
            argv[o->files++] = argv[i];
            continue;
        }
        if (!strcmp(argv[i], "--merge")) {
            o->merge = 1;
            continue;
        }
        if (which == OPTIONS) return complain(argv[i], "unknown option; --help lists them");
        if (!text && i + 1 == argc) return complain(argv[i], "its value is missing");
        if (!parse_value(which, text ? text + 1 : argv[++i], o)) return 0;
        o->given[which] = 1;
    }
    if (!o->spp) o->spp = o->error > 0 || o->seconds > 0 ? 16384 : 64;
#ifdef _OPENMP
    if (!o->threads) o->threads = omp_get_max_threads();
#else
    o->threads = 1;
#endif
    return check_options(o);
}

#endif
