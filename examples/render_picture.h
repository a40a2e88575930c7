/* render_picture.h - the pictures of render.c: pixels, and how they get into PNG and Radiance files. */
#ifndef RENDER_PICTURE_H
#define RENDER_PICTURE_H
#include <errno.h>
#include <sys/stat.h>
#include "hdr.h"
#include "render_light.h"
#include "render_options.h"
#include "render_png.h"
#include "render_scene.h"

typedef struct {
    mcs_pcg32 rng;
    vec3 sum;
    mcs_stat luminance; /* of this pixel's samples */
    uint32_t drawn;     /* light samples */
    int object;         /* that all samples hit, or NO_OBJECT */
} pixel_sums;

static vec3 pixel_color(const pixel_sums *pixel) { return scale(1 / (float)pixel->luminance.n, pixel->sum); }

/* One sample, whose camera ray hit that object. */
static void pixel_add(pixel_sums *pixel, int object, vec3 color) {
    pixel->object = pixel->luminance.n > 0 && object != pixel->object ? NO_OBJECT : object;
    pixel->sum = add(pixel->sum, color);
    mcs_stat_add(&pixel->luminance, luminance(color));
}

static int file_close(FILE *f, const char *name) {
    const int bad = ferror(f);
    if (fclose(f) != 0 || bad) return complain(name, "cannot write: %s", strerror(errno));
    return 1;
}

static int hdr_write(const char *name, const pixel_sums *image, unsigned width, unsigned height) {
    FILE *f = fopen(name, "wb");
    if (!f) return complain(name, "%s", strerror(errno));
    hdr_write_header(f, width, height);
    for (size_t i = 0; i < (size_t)width * height; i++) {
        const hdr_pixel coded = encode(pixel_color(&image[i]));
        fwrite(coded.c, 1, 4, f);
    }
    return file_close(f, name);
}

/* How a picture gets onto a screen. */
typedef struct {
    float exposure;
    int soft; /* for what has deep shadows beside sunshine: both keep their shape, at the cost of contrast */
} tone;

/* Exposure, a curve without hard clipping, sRGB coding, 8 bits. The curve is filmic (Narkowicz, "ACES filmic tone
 * mapping curve", 2015), or the soft one of Reinhard et al. ("Photographic tone reproduction for digital images", 2002)
 * whose white is 40. */
static unsigned char display(float linear, tone t) {
    const float x = fminf(linear * t.exposure, 1e4f);
    const float filmic = x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
    const float y = fminf(t.soft ? x * (1 + x / 1600) / (1 + x) : filmic, 1);
    return (unsigned char)(255 * (y <= 0.0031308f ? 12.92f * y : 1.055f * powf(y, 1 / 2.4f) - 0.055f) + 0.5f);
}

/* Pictures of equal size that one file shows side by side or one below the other. */
typedef struct {
    const pixel_sums *image; /* of one, then of the next */
    unsigned width, height, across, down;
} sheet;

static const pixel_sums *sheet_pixel(const sheet *all, size_t col, size_t row) {
    const size_t which = col / all->width + row / all->height; /* across or down is 1 */
    return all->image + (which * all->height + row % all->height) * all->width + col % all->width;
}

static int png_write(const char *name, const sheet *all, tone t) {
    const unsigned width = all->width * all->across;
    const unsigned height = all->height * all->down;
    unsigned char *rgb = malloc((size_t)width * height * 3);
    size_t size = 0;
    for (size_t i = 0; rgb && i < (size_t)width * height; i++) {
        const vec3 color = pixel_color(sheet_pixel(all, i % width, i / width));
        rgb[3 * i] = display(color.x, t);
        rgb[3 * i + 1] = display(color.y, t);
        rgb[3 * i + 2] = display(color.z, t);
    }
    unsigned char *png = rgb ? png_make(rgb, NULL, width, height, &size) : NULL;
    FILE *f = png ? fopen(name, "wb") : NULL;
    int ok = f ? 1 : complain(name, "%s", strerror(errno));
    if (ok) {
        fwrite(png, 1, size, f);
        ok = file_close(f, name);
    }
    free(rgb);
    free(png);
    return ok;
}

/* In the room, little light is left: six stops. */
static tone tone_for(const options *o, const environment *e) {
    const float plain = e->irradiance > 0 ? 0.9f * PI / e->irradiance : 1;
    tone t;
    t.exposure = plain * exp2f(o->stops + (o->kind == ROOM ? 6 : 0));
    t.soft = o->kind == ROOM;
    return t;
}

/* The caller frees the name. Returns NULL after a complaint. */
static char *picture_name(const options *o, strategy how, const char *extension) {
    const size_t size = strlen(o->out) + strlen(strategy_name[how]) + strlen(extension) + 2;
    char *name = malloc(size);
    if (name) snprintf(name, size, "%s-%s%s", o->out, strategy_name[how], extension);
    else complain(o->out, "not enough memory");
    return name;
}

static int write_pictures(const options *o, strategy how, const environment *e, const pixel_sums *image) {
    char *png = picture_name(o, how, ".png");
    char *hdr = picture_name(o, how, ".hdr");
    const sheet one = {image, o->width, o->height, 1, 1};
    const int ok = png && hdr && png_write(png, &one, tone_for(o, e)) && hdr_write(hdr, image, o->width, o->height);
    free(png);
    free(hdr);
    return ok;
}

/* All of `count` pictures in one file. */
static int write_sheets(const options *o, const environment *e, const pixel_sums *image, unsigned count) {
    const sheet stack = {image, o->width, o->height, 1, count};
    const sheet beside = {image, o->width, o->height, count, 1};
    if (o->stack && !png_write(o->stack, &stack, tone_for(o, e))) return 0;
    return !o->beside || png_write(o->beside, &beside, tone_for(o, e));
}

/* Whether a file can be written, asked before the time is spent on what goes into it. What was in it stays for now. */
static int can_write(const char *name) {
    struct stat status;
    const int exists = lstat(name, &status) == 0; /* if only as a link to nothing */
    if (stat(name, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
        return 1; /* a device or a pipe */
    FILE *f = fopen(name, "ab");
    if (!f) return complain(name, "cannot write: %s", strerror(errno));
    fclose(f);
    if (!exists) remove(name);
    return 1;
}

static int can_write_pictures(const options *o) {
    int ok = (!o->stack || can_write(o->stack)) && (!o->beside || can_write(o->beside));
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        char *png = picture_name(o, (strategy)i, ".png");
        char *hdr = picture_name(o, (strategy)i, ".hdr");
        ok = png && hdr && can_write(png) && can_write(hdr);
        free(png);
        free(hdr);
    }
    return ok;
}

#endif
