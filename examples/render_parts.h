/* render_parts.h - a picture of render.c in parts: the sums of each, in a file of its own, and how they are joined.
 *
 * Part K of N has rows K - 1, K - 1 + N, ... of a picture. Each pixel has its own stream of random numbers, and is in
 * one part. So parts can be rendered in any order and on any machine, and what they are joined to is, to the bit, what
 * a single run makes.
 *
 * A file is a line that says what is rendered and one that says which part it is, then of each pixel of the part nine
 * numbers of 32 bits, two for a double, highest byte first.
 */
#ifndef RENDER_PARTS_H
#define RENDER_PARTS_H
#include "render_report.h"

enum { TITLE = 256, RECORD = 36 };

typedef struct {
    const char *name;
    char title[TITLE]; /* the same in all files that belong together */
    options o;
    uint32_t irradiance; /* its bits */
    strategy how;
    double wall, cpu;
} sums;

/* ---- numbers ---- */

static uint32_t float_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float bits_float(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static unsigned char *put_float(unsigned char *at, float x) { return put_u32(at, float_bits(x)); }

static unsigned char *put_double(unsigned char *at, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return put_u32(put_u32(at, (uint32_t)(bits >> 32)), (uint32_t)bits);
}

static uint32_t get_u32(const unsigned char **at) {
    const unsigned char *b = *at;
    *at += 4;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static float get_float(const unsigned char **at) { return bits_float(get_u32(at)); }

static double get_double(const unsigned char **at) {
    const uint64_t high = get_u32(at);
    const uint64_t bits = high << 32 | get_u32(at);
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* ---- writing ---- */

/* FNV-1a, of the texels of a map. */
static uint64_t map_hash(const environment *e) {
    const unsigned char *byte = (const unsigned char *)e->map.pixel;
    const size_t bytes = (size_t)e->map.w * e->map.h * sizeof *e->map.pixel;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ byte[i]) * 0x100000001b3u;
    return hash;
}

static char *sums_name(const options *o, strategy how) {
    char extension[64];
    snprintf(extension, sizeof extension, "-%u-of-%u.sums", o->part, o->parts);
    return picture_name(o, how, extension);
}

static int can_write_sums(const options *o) {
    int ok = 1;
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        char *name = sums_name(o, (strategy)i);
        ok = name && can_write(name);
        free(name);
    }
    return ok;
}

static void put_pixel(FILE *f, const pixel_sums *pixel) {
    unsigned char record[RECORD];
    unsigned char *at = put_float(record, pixel->sum.x);
    at = put_float(at, pixel->sum.y);
    at = put_float(at, pixel->sum.z);
    at = put_double(at, pixel->luminance.mean);
    at = put_double(at, pixel->luminance.m2);
    at = put_u32(at, pixel->drawn);
    at = put_u32(at, (uint32_t)(pixel->object + 1));
    fwrite(record, 1, (size_t)(at - record), f);
}

/* Returns 0 after a complaint. */
static int sums_write(const options *o, strategy how, const environment *e, const pixel_sums *image,
                      const outcome *result) {
    char *name = sums_name(o, how);
    FILE *f = name ? fopen(name, "wb") : NULL;
    int ok = f ? 1 : complain(name ? name : o->out, "%s", strerror(errno));
    if (ok) {
        const uint64_t hash = map_hash(e);
        fprintf(f, "render sums %s: %ux%u scene %s seed %.0f spp %u lights %u parts %u", MCS_VERSION_STRING, o->width,
                o->height, scene_name[o->kind], (double)o->seed, o->spp, o->lights, o->parts);
        fprintf(f, " irradiance %08lx map %08lx%08lx\n", (unsigned long)float_bits(e->irradiance),
                (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
        fprintf(f, "%s part %u wall %.6f cpu %.6f\n", strategy_name[how], o->part, result->wall, result->cpu);
        for (size_t row = o->part - 1; row < o->height; row += o->parts)
            for (size_t col = 0; col < o->width; col++) put_pixel(f, &image[row * o->width + col]);
        ok = file_close(f, name);
    }
    free(name);
    return ok;
}

/* ---- reading ---- */

static int sums_damaged(const char *name) { return complain(name, "no file of --part, or a damaged one"); }

/* The two lines at the beginning. Returns 0 after a complaint. */
static int sums_begin(FILE *f, sums *part) {
    char line[TITLE];
    char how[16], kind[16];
    unsigned long irradiance;
    options *o = &part->o;
    memset(o, 0, sizeof *o);
    if (!fgets(part->title, TITLE, f) || !fgets(line, TITLE, f)) return sums_damaged(part->name);
    if (sscanf(part->title, "render sums %*s %ux%u scene %15s seed %*s spp %u lights %u parts %u irradiance %lx",
               &o->width, &o->height, kind, &o->spp, &o->lights, &o->parts, &irradiance) != 7 ||
        sscanf(line, "%15s part %u wall %lf cpu %lf", how, &o->part, &part->wall, &part->cpu) != 4)
        return sums_damaged(part->name);
    part->irradiance = (uint32_t)irradiance;
    int i = 0;
    while (i < STRATEGIES && strcmp(strategy_name[i], how)) i++;
    part->how = (strategy)i;
    if (i == STRATEGIES || !parse_scene_kind(kind, &o->kind) || o->width - 1 >= 16384 || o->height - 1 >= 16384 ||
        o->width * o->height > 1u << 25 || o->spp == 0 || o->parts > o->height || o->part - 1 >= o->parts)
        return sums_damaged(part->name);
    return 1;
}

/* Returns 0 where there is none. */
static int get_pixel(FILE *f, const sums *part, pixel_sums *pixel) {
    unsigned char record[RECORD];
    if (fread(record, 1, RECORD, f) != RECORD) return 0;
    const unsigned char *at = record;
    pixel->sum.x = get_float(&at);
    pixel->sum.y = get_float(&at);
    pixel->sum.z = get_float(&at);
    pixel->luminance.n = part->o.spp;
    pixel->luminance.mean = get_double(&at);
    pixel->luminance.m2 = get_double(&at);
    pixel->drawn = get_u32(&at);
    const uint32_t object = get_u32(&at);
    pixel->object = (int)object - 1;
    return object <= OBJECTS;
}

/* Into rows of the image of its strategy that are all zeros. Returns 0 after a complaint. */
static int sums_pixels(FILE *f, const sums *part, pixel_sums *image) {
    const options *o = &part->o;
    if (image[(size_t)(o->part - 1) * o->width].luminance.n > 0)
        return complain(part->name, "part %u of %s is given twice", o->part, strategy_name[part->how]);
    for (size_t row = o->part - 1; row < o->height; row += o->parts)
        for (size_t col = 0; col < o->width; col++)
            if (!get_pixel(f, part, &image[row * o->width + col])) return sums_damaged(part->name);
    return fgetc(f) == EOF ? 1 : sums_damaged(part->name);
}

/* Reads the lines of a file, and its pixels unless image is NULL. Returns 0 after a complaint. */
static int sums_read(const char *name, sums *part, pixel_sums *const image[STRATEGIES]) {
    FILE *f = fopen(name, "rb");
    if (!f) return complain(name, "%s", strerror(errno));
    part->name = name;
    int ok = sums_begin(f, part);
    if (ok && image) ok = sums_pixels(f, part, image[part->how]);
    fclose(f);
    return ok;
}

/* What is common to all files goes to *first, which strategies they have to first->o.wanted. Returns 0 after a
 * complaint. */
static int sums_survey(const options *o, sums *first) {
    int wanted[STRATEGIES] = {0};
    for (int i = 0; i < o->files; i++) {
        sums part;
        if (!sums_read(o->file[i], &part, NULL)) return 0;
        if (i == 0) *first = part;
        if (strcmp(first->title, part.title))
            return complain(part.name, "is no part of the same picture as %s", first->name);
        wanted[part.how] = 1;
    }
    memcpy(first->o.wanted, wanted, sizeof wanted);
    first->o.out = o->out;
    first->o.stops = o->stops;
    first->o.stack = o->stack;
    first->o.beside = o->beside;
    return 1;
}

/* Whether an image has all its parts. Returns 0 after a complaint. */
static int sums_complete(const options *o, strategy how, const pixel_sums *image) {
    for (unsigned k = 0; k < o->parts; k++)
        if (!(image[(size_t)k * o->width].luminance.n > 0))
            return complain("--merge", "part %u of %u of %s is missing", k + 1, o->parts, strategy_name[how]);
    return 1;
}

/* ---- joining ---- */

/* Reads the pixels of all files, `image` being all zeros, and prints the rows that single runs print. Processor times
 * are added; of wall times, the longest stays. Returns 0 after a complaint. */
static int merge_files(const options *asked, const options *o, pixel_sums *image, outcome *result) {
    const size_t pixels = (size_t)o->width * o->height;
    pixel_sums *start[STRATEGIES] = {NULL};
    for (int i = 0; i < STRATEGIES; i++) {
        start[i] = image;
        if (o->wanted[i]) image += pixels;
    }
    memset(result, 0, STRATEGIES * sizeof *result);
    for (int i = 0; i < asked->files; i++) {
        sums part;
        if (!sums_read(asked->file[i], &part, start)) return 0;
        result[part.how].wall = fmax(result[part.how].wall, part.wall);
        result[part.how].cpu += part.cpu;
    }
    for (int i = 0; i < STRATEGIES; i++)
        if (o->wanted[i] && !sums_complete(o, (strategy)i, start[i])) return 0;
    printf("%u parts, picture %u x %u\n", o->parts, o->width, o->height);
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
    const size_t pixels = (size_t)o->width * o->height;
    pixel_sums *image = calloc(count * pixels, sizeof *image);
    outcome result[STRATEGIES];
    int ok = image ? merge_files(asked, o, image, result) : complain("--merge", "not enough memory for the picture");
    if (ok) print_tables(o, count, result);
    ok = ok && flush_output();
    const pixel_sums *next = image;
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        ok = write_pictures(o, (strategy)i, &e, next);
        next += pixels;
    }
    ok = ok && write_sheets(o, &e, image, count);
    free(image);
    return ok;
}

#endif
