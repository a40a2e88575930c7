/* Latitude-longitude pictures as the environment map's tests need them: what a texel covers and where it lies, in double and long
 * double; and a reader of Radiance files. */
#ifndef MCST_HDR_H
#define MCST_HDR_H
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "mcsample.h"

/* cos(pi r / h) - cos(pi (r+1) / h) without cancellation, times the width of a column. */
static inline long double solid_angle(uint32_t r, uint32_t w, uint32_t h) {
    const long double p = acosl(-1.0L);
    return 2 * p / w * 2 * sinl(p / 2 / h) * sinl(p * (r + 0.5L) / h);
}

/* Direction of a point of a texel, from fractions of its column and of its cos(theta) range. */
static inline mcs_vec3 point(uint32_t w, uint32_t h, uint32_t col, uint32_t row, double fc, double fr) {
    const double pi = acos(-1.0), phi = 2 * pi * (col + fc) / w;
    /* (1 - cos theta) / 2 = sin^2(theta/2) keeps its digits at the poles */
    const double a = pow(sin(pi / 2 * row / h), 2), b = pow(sin(pi / 2 * (row + 1) / h), 2);
    const double half = a + (b - a) * fr, s = 2 * sqrt(half * (1 - half));
    mcs_vec3 v;
    v.x = (float)(s * cos(phi)), v.y = (float)(s * sin(phi)), v.z = (float)(1 - 2 * half);
    return v;
}
/* Texel of a direction, with fractions of its width and of its height in theta. */
static inline void texel_of(uint32_t w, uint32_t h, mcs_vec3 v, double *col, double *row) {
    const double pi = acos(-1.0);
    double turn = atan2(v.y, v.x) / (2 * pi);
    if (turn < 0) turn += 1;
    *col = turn * w;
    *row = atan2(sqrt((double)v.x * v.x + (double)v.y * v.y), v.z) / pi * h;
}

typedef struct {
    uint32_t w, h;
    float *rgb;
} hdr_picture;

/* One scan line (Ward, "Real Pixels", Graphics Gems II, 1991) into w times four bytes: flat, runs of whole pixels, or each channel
 * coded by itself. */
static inline int hdr_line(FILE *f, unsigned char *line, uint32_t w) {
    unsigned char p[4];
    uint32_t i = 0, shift = 0, n, k;
    if (fread(p, 1, 4, f) != 4) return 0;
    if (w >= 8 && w < 32768 && p[0] == 2 && p[1] == 2 && p[2] < 128) {
        if (((uint32_t)p[2] << 8 | p[3]) != w) return 0;
        for (k = 0; k < 4; k++)
            for (i = 0; i < w;) {
                int code = getc(f), value = 0;
                const int run = code > 128;
                if (code == EOF || (run && (value = getc(f)) == EOF)) return 0;
                n = (uint32_t)(run ? code - 128 : code);
                if (n == 0 || n > w - i) return 0;
                for (; n > 0; n--) {
                    if (!run && (value = getc(f)) == EOF) return 0;
                    line[4 * i++ + k] = (unsigned char)value;
                }
            }
        return 1;
    }
    for (;;) {
        if (p[0] == 1 && p[1] == 1 && p[2] == 1) { /* the pixel before again: p[3] times, in a series the low byte comes first */
            if (i == 0 || shift > 16 || (uint32_t)p[3] << shift > w - i) return 0;
            for (n = (uint32_t)p[3] << shift; n > 0; n--, i++) memcpy(line + 4 * i, line + 4 * i - 4, 4);
            shift += 8;
        } else {
            memcpy(line + 4 * i++, p, 4);
            shift = 0;
        }
        if (i == w) return 1;
        if (fread(p, 1, 4, f) != 4) return 0;
    }
}

/* Returns NULL, or why there is no picture. The caller frees rgb. */
static inline const char *hdr_read(hdr_picture *to, const char *name) {
    FILE *f = fopen(name, "rb");
    char text[1024] = "";
    unsigned char *line = NULL;
    uint32_t x, y, k;
    int ok;
    to->rgb = NULL, to->w = to->h = 0;
    if (!f) return "cannot be opened";
    ok = fgets(text, sizeof text, f) && !strncmp(text, "#?", 2);
    while (ok && text[0] != '\n') {
        ok = fgets(text, sizeof text, f) != NULL;
        if (ok && !strncmp(text, "FORMAT=", 7)) ok = !strncmp(text, "FORMAT=32-bit_rle_rgbe", 22);
    }
    ok = ok && fgets(text, sizeof text, f) && sscanf(text, "-Y %9u +X %9u", &to->h, &to->w) == 2 && to->w && to->h &&
         to->w <= 65536 && to->h <= 65536;
    if (ok)
        to->rgb = (float *)malloc((size_t)to->w * to->h * 3 * sizeof *to->rgb), line = (unsigned char *)malloc(4 * (size_t)to->w);
    ok = ok && to->rgb && line;
    for (y = 0; ok && y < to->h; y++) {
        ok = hdr_line(f, line, to->w);
        for (x = 0; ok && x < to->w; x++)
            for (k = 0; k < 3; k++) to->rgb[3 * ((size_t)y * to->w + x) + k] = ldexpf(line[4 * x + k], line[4 * x + 3] - 136);
    }
    free(line);
    fclose(f);
    if (!ok) free(to->rgb), to->rgb = NULL;
    return ok ? NULL : "is no whole 32-bit_rle_rgbe picture with rows from the top";
}
#endif
