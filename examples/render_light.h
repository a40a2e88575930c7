/* render_light.h - the light of render.c: a map of radiance, row 0 around +z, and the tables of mcsample.h that sample
 * it. The map is read from a file, or it is a made-up sky. */
#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H
#include "hdr.h"
#include "render_base.h"
#include "render_options.h"

#define TILES 16u             /* rows of tiles of product sampling */
#define LAMPS_IRRADIANCE 3.0f /* about, where they are */

typedef struct {
    hdr_picture map; /* at 4 bytes a texel most look-ups find theirs in the cache */
    mcs_env *table;
    mcs_tiles *tiles; /* for product sampling */
    float irradiance; /* luminance of the irradiance on level ground with nothing in the way */
    float main_light; /* azimuth */
} environment;

static vec3 radiance_at(const environment *e, unsigned col, unsigned row) {
    float c[3];
    hdr_color(&e->map, (size_t)row * e->map.w + col, c);
    return vec(c[0], c[1], c[2]);
}

static vec3 radiance(const environment *e, vec3 w) {
    const mcs_texel t = mcs_env_texel(e->table, w);
    return radiance_at(e, t.col, t.row);
}

static hdr_pixel encode(vec3 c) {
    const float rgb[3] = {c.x, c.y, c.z};
    return hdr_encode(rgb);
}

/* In the map's own axes. */
static vec3 texel_direction(const environment *e, uint32_t col, uint32_t row) {
    const float theta = PI * ((float)row + 0.5f) / (float)e->map.h;
    const float phi = 2 * PI * ((float)col + 0.5f) / (float)e->map.w;
    return vec(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}

/* A clear late afternoon, for a run without a map: blue sky, pale horizon, brown ground, and a sun four degrees wide,
 * since the true half degree would be smaller than a texel. */
static int map_sky(environment *e, const char *name) {
    const vec3 zenith = {0.15f, 0.29f, 0.66f};
    const vec3 horizon = {0.95f, 0.98f, 1.06f};
    const vec3 soil = {0.16f, 0.13f, 0.11f};
    const vec3 sun = {1500, 1180, 800};
    const vec3 haze = {2.2f, 1.5f, 0.8f};
    const vec3 to_sun = unit(vec(1, 0, 0.70f));
    const float sun_cos = cosf(2 * PI / 180);
    const float edge = 0.3f * (1 - sun_cos);
    hdr_start(&e->map);
    e->map.w = 512;
    e->map.h = 256;
    e->map.pixel = malloc(512 * 256 * sizeof *e->map.pixel);
    if (!e->map.pixel) return complain(name, "not enough memory");
    for (uint32_t row = 0; row < e->map.h; row++) {
        for (uint32_t col = 0; col < e->map.w; col++) {
            const vec3 w = texel_direction(e, col, row);
            const float near_sun = dot(w, to_sun);
            const float disc = fminf(fmaxf((near_sun - sun_cos) / edge, 0), 1);
            vec3 color;
            if (w.z > 0) {
                color = mix(powf(1 - w.z, 4), zenith, horizon);
                color = add(color, scale(powf(fmaxf(near_sun, 0), 12), haze));
            } else {
                color = mix(expf(30 * w.z), soil, scale(0.6f, horizon));
            }
            e->map.pixel[(size_t)row * e->map.w + col] = encode(add(color, scale(disc, sun)));
        }
    }
    return 1;
}

/* What the camera wants to know of the map: how bright it makes the ground, and where its main light stands, which is
 * taken as the direction of the squared luminance of the upper half. */
static void map_survey(environment *e) {
    double sum_x = 0;
    double sum_y = 0;
    double irradiance = 0;
    for (unsigned row = 0; row < e->map.h / 2; row++) {
        const float area = 2 * PI / (float)e->map.w *
                           (cosf(PI * (float)row / (float)e->map.h) - cosf(PI * (float)(row + 1) / (float)e->map.h));
        for (unsigned col = 0; col < e->map.w; col++) {
            const vec3 w = mcs_to_world(&e->table->frame, texel_direction(e, col, row));
            const double bright = luminance(radiance_at(e, col, row));
            sum_x += bright * bright * area * w.x;
            sum_y += bright * bright * area * w.y;
            irradiance += bright * area * w.z;
        }
    }
    e->irradiance = (float)irradiance;
    e->main_light = (float)atan2(sum_y, sum_x);
}

/* Lamps take the place of the map: then nothing is read but what brightness the picture is for. */
static int environment_make(environment *e, const options *o) {
    const char *name = o->map ? o->map : "built-in sky";
    memset(e, 0, sizeof *e);
    e->irradiance = LAMPS_IRRADIANCE;
    if (has_lamps(o->kind)) return 1;
    if (!o->map && !map_sky(e, name)) return 0;
    if (o->map && !hdr_read(&e->map, o->map)) return complain(name, "%s", e->map.fault);
    const unsigned width = e->map.w;
    const unsigned height = e->map.h;
    size_t bytes = mcs_env_bytes(width, height);
    if (bytes == 0) return complain(name, "%u x %u texels are more than a sampling table takes", width, height);
    e->table = malloc(bytes);
    float *pixel = malloc((size_t)width * height * sizeof *pixel);
    if (!e->table || !pixel) {
        free(pixel);
        return complain(name, "not enough memory for the sampling table");
    }
    for (size_t i = 0; i < (size_t)width * height; i++)
        pixel[i] = luminance(radiance_at(e, (unsigned)(i % width), (unsigned)(i / width)));
    const mcs_image image = mcs_image_make(pixel, width, height, 1);
    int status = mcs_env_build(e->table, bytes, &image);
    free(pixel);
    if (status != MCS_OK) return complain(name, "no sampling table (status %d)", status);
    if (!(e->table->total > 0)) return complain(name, "the map is black: there is nothing to light the scene with");
    /* Columns of a panorama run clockwise seen from above, azimuth the other way. */
    if (o->map) e->table->frame.t = vec(0, -1, 0);
    map_survey(e);
    bytes = mcs_tiles_bytes(e->table, TILES);
    e->tiles = malloc(bytes);
    if (!e->tiles) return complain(name, "not enough memory for the tiles");
    status = mcs_tiles_build(e->tiles, bytes, e->table, TILES);
    return status == MCS_OK ? 1 : complain(name, "no tiles (status %d)", status);
}

static void environment_free(environment *e) {
    free(e->map.pixel);
    free(e->table);
    free(e->tiles);
}

#endif
