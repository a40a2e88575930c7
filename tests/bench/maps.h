/* Maps of luminance for the benchmarks: from files, and made-up ones. */
#ifndef MCST_MAPS_H
#define MCST_MAPS_H
#include "../../examples/hdr.h"
#include "bench.h"
#include "mcsample.h"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { MAX_MAPS = 16 };

typedef struct {
    char name[32];
    uint32_t w, h;
    float *light;
    mcs_env *table;
    mcs_tiles *tiles;
    int smooth;
} map;

enum { TILES = 16 }; /* rows of tiles */

static void unit_from(double elevation, double azimuth, double w[3]) { /* degrees */
    const double e = elevation * PI / 180;
    const double a = azimuth * PI / 180;
    w[0] = cos(e) * cos(a);
    w[1] = cos(e) * sin(a);
    w[2] = sin(e);
}

static const double sun_place[2] = {35, 40}; /* elevation and azimuth, degrees */

/* Clear sky without the disc of the sun: pale at the horizon, bright around the sun, a darker ground; continuous
 * everywhere. */
static double sky(const double w[3], double near_sun) {
    const double up = 1 - fabs(w[2]);
    const double haze = near_sun > 0 ? 2 * pow(near_sun, 12) + 8 * pow(near_sun, 80) : 0;
    const double air = 0.3 + 0.7 * up * up * up * up + haze;
    return w[2] > 0 ? air : 0.15 + (air - 0.15) * exp(12 * w[2]);
}
/* A disc 0.8 degrees in radius, which gives level ground 13 times the light of its sky. */
static double sunlit(const double w[3], double near_sun) {
    return 0.05 * sky(w, 0) + (near_sun > cos(0.8 * PI / 180) ? 2000 : 0);
}
static double flat(const double w[3], double near_sun) {
    (void)w;
    (void)near_sun;
    return 1;
}

static int map_table(map *m) {
    const mcs_image image = mcs_image_make(m->light, m->w, m->h, 1);
    size_t bytes = mcs_env_bytes(m->w, m->h);
    m->table = malloc(bytes);
    if (!m->table || mcs_env_build(m->table, bytes, &image) != MCS_OK) {
        fprintf(stderr, "%s: no sampling table\n", m->name);
        return 0;
    }
    bytes = mcs_tiles_bytes(m->table, TILES);
    m->tiles = malloc(bytes);
    if (!m->tiles || mcs_tiles_build(m->tiles, bytes, m->table, TILES) != MCS_OK) {
        fprintf(stderr, "%s: no tiles\n", m->name);
        return 0;
    }
    return 1;
}

static int map_make(map *m, const char *name, double (*light)(const double w[3], double near_sun), int smooth,
                    uint32_t h) {
    enum { SUB = 4 }; /* looks per texel and axis, for the edge of the sun */
    snprintf(m->name, sizeof m->name, "%s", name);
    m->w = 2 * h;
    m->h = h;
    m->smooth = smooth;
    m->light = malloc((size_t)m->w * h * sizeof *m->light);
    if (!m->light) return 0;
    double sun[3];
    unit_from(sun_place[0], sun_place[1], sun);
    for (uint32_t y = 0; y < h; y++) {
        for (uint32_t x = 0; x < m->w; x++) {
            double sum = 0;
            for (uint32_t k = 0; k < SUB * SUB; k++) {
                double w[3];
                unit_from(90 - 180 * (y + (k / SUB + 0.5) / SUB) / h, 360 * (x + (k % SUB + 0.5) / SUB) / m->w, w);
                sum += light(w, w[0] * sun[0] + w[1] * sun[1] + w[2] * sun[2]);
            }
            m->light[(size_t)y * m->w + x] = (float)(sum / (SUB * SUB));
        }
    }
    return map_table(m);
}

/* The luminance of a Radiance picture by the weights of Rec. 709. */
static int map_read(map *m, const char *file) {
    const char *base = strrchr(file, '/');
    hdr_picture picture;
    if (!hdr_read(&picture, file)) {
        fprintf(stderr, "%s: %s\n", file, picture.fault);
        return 0;
    }
    snprintf(m->name, sizeof m->name, "%s", base ? base + 1 : file);
    if (strchr(m->name, '.')) *strchr(m->name, '.') = 0;
    m->w = picture.w;
    m->h = picture.h;
    m->light = malloc((size_t)m->w * m->h * sizeof *m->light);
    for (size_t i = 0; m->light && i < (size_t)m->w * m->h; i++) {
        float c[3];
        hdr_color(&picture, i, c);
        m->light[i] = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
    }
    free(picture.pixel);
    if (m->light) return map_table(m);
    fprintf(stderr, "%s: not enough memory\n", file);
    return 0;
}
#endif
