/* render_parts.h - a picture of render.c in parts: the sums of each, in a file of its own, and how they are joined.
 *
 * Part K of N has rows K - 1, K - 1 + N, ... of a picture. Each pixel has its own stream of random numbers and is in one
 * part. So parts can be rendered in any order and on any machine, and what they are joined to is, to the bit, what a
 * single run makes.
 *
 * A file is a line that says what is rendered and one that says which part it is, then of each pixel of the part nine
 * numbers of 32 bits, two for a double, highest byte first.
 */
#ifndef RENDER_PARTS_H
#define RENDER_PARTS_H
#include "render_picture.h"
#include "render_scene.h"

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

static void put_pixel(FILE *f, const pixel *p) {
    unsigned char record[RECORD];
    unsigned char *at = put_float(record, p->sum.x);
    at = put_float(at, p->sum.y);
    at = put_float(at, p->sum.z);
    at = put_double(at, p->luminance.mean);
    at = put_double(at, p->luminance.m2);
    at = put_u32(at, p->drawn);
    at = put_u32(at, (uint32_t)(p->object + 1));
    fwrite(record, 1, (size_t)(at - record), f);
}

/* Returns 0 after a complaint. */
static int sums_write(const options *o, strategy how, const environment *e, const pixel *image, const double took[2]) {
    char *name = sums_name(o, how);
    FILE *f = name ? fopen(name, "wb") : NULL;
    int ok = f ? 1 : complain(name ? name : o->out, "%s", strerror(errno));
    if (ok) {
        const uint64_t hash = map_hash(e);
        fprintf(f, "render sums %s: %ux%u room %d seed %.0f spp %u lights %u parts %u", MCS_VERSION_STRING, o->w, o->h,
                o->in_room, (double)o->seed, o->spp, o->lights, o->parts);
        fprintf(f, " irradiance %08lx map %08lx%08lx\n", (unsigned long)float_bits(e->irradiance),
                (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
        fprintf(f, "%s part %u wall %.6f cpu %.6f\n", strategy_name[how], o->part, took[0], took[1]);
        for (size_t y = o->part - 1; y < o->h; y += o->parts)
            for (size_t x = 0; x < o->w; x++) put_pixel(f, &image[y * o->w + x]);
        ok = file_close(f, name);
    }
    free(name);
    return ok;
}

/* ---- reading ---- */

static int sums_damaged(const char *name) { return complain(name, "no file of --part, or a damaged one"); }

/* The two lines at the beginning. Returns 0 after a complaint. */
static int sums_begin(FILE *f, sums *s) {
    char line[TITLE];
    char how[16];
    unsigned long irradiance;
    options *o = &s->o;
    memset(o, 0, sizeof *o);
    if (!fgets(s->title, TITLE, f) || !fgets(line, TITLE, f)) return sums_damaged(s->name);
    if (sscanf(s->title, "render sums %*s %ux%u room %d seed %*s spp %u lights %u parts %u irradiance %lx", &o->w,
               &o->h, &o->in_room, &o->spp, &o->lights, &o->parts, &irradiance) != 7 ||
        sscanf(line, "%15s part %u wall %lf cpu %lf", how, &o->part, &s->wall, &s->cpu) != 4)
        return sums_damaged(s->name);
    s->irradiance = (uint32_t)irradiance;
    int i = 0;
    while (i < STRATEGIES && strcmp(strategy_name[i], how)) i++;
    s->how = (strategy)i;
    if (i == STRATEGIES || o->w - 1 >= 16384 || o->h - 1 >= 16384 || o->w * o->h > 1u << 25 || o->spp == 0 ||
        o->parts > o->h || o->part - 1 >= o->parts)
        return sums_damaged(s->name);
    return 1;
}

/* Returns 0 where there is none. */
static int get_pixel(FILE *f, const sums *s, pixel *p) {
    unsigned char record[RECORD];
    if (fread(record, 1, RECORD, f) != RECORD) return 0;
    const unsigned char *at = record;
    p->sum.x = get_float(&at);
    p->sum.y = get_float(&at);
    p->sum.z = get_float(&at);
    p->luminance.n = s->o.spp;
    p->luminance.mean = get_double(&at);
    p->luminance.m2 = get_double(&at);
    p->drawn = get_u32(&at);
    const uint32_t object = get_u32(&at);
    p->object = (int)object - 1;
    return object <= OBJECTS;
}

/* Into rows of the image of its strategy that are all zeros. Returns 0 after a complaint. */
static int sums_pixels(FILE *f, const sums *s, pixel *image) {
    const options *o = &s->o;
    if (image[(size_t)(o->part - 1) * o->w].luminance.n > 0)
        return complain(s->name, "part %u of %s is given twice", o->part, strategy_name[s->how]);
    for (size_t y = o->part - 1; y < o->h; y += o->parts)
        for (size_t x = 0; x < o->w; x++)
            if (!get_pixel(f, s, &image[y * o->w + x])) return sums_damaged(s->name);
    return fgetc(f) == EOF ? 1 : sums_damaged(s->name);
}

/* Reads the lines of a file, and its pixels unless image is NULL. Returns 0 after a complaint. */
static int sums_read(const char *name, sums *s, pixel *const image[STRATEGIES]) {
    FILE *f = fopen(name, "rb");
    if (!f) return complain(name, "%s", strerror(errno));
    s->name = name;
    int ok = sums_begin(f, s);
    if (ok && image) ok = sums_pixels(f, s, image[s->how]);
    fclose(f);
    return ok;
}

/* What is common to all files goes to *first, which strategies they have to first->o.wanted. Returns 0 after a
 * complaint. */
static int sums_survey(const options *o, sums *first) {
    int wanted[STRATEGIES] = {0};
    for (int i = 0; i < o->files; i++) {
        sums s;
        if (!sums_read(o->file[i], &s, NULL)) return 0;
        if (i == 0) *first = s;
        if (strcmp(first->title, s.title)) return complain(s.name, "is no part of the same picture as %s", first->name);
        wanted[s.how] = 1;
    }
    memcpy(first->o.wanted, wanted, sizeof wanted);
    first->o.out = o->out;
    first->o.stops = o->stops;
    first->o.stack = o->stack;
    first->o.beside = o->beside;
    return 1;
}

/* Whether an image has all its parts. Returns 0 after a complaint. */
static int sums_complete(const options *o, strategy how, const pixel *image) {
    for (unsigned k = 0; k < o->parts; k++)
        if (!(image[(size_t)k * o->w].luminance.n > 0))
            return complain("--merge", "part %u of %u of %s is missing", k + 1, o->parts, strategy_name[how]);
    return 1;
}

#endif
