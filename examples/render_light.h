/* render_light.h - the light of render.c: a map of radiance, row 0 around +z, and the tables of mcsample.h that sample
 * it. The map is read from a file, or it is a made-up sky. */
#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H
#include "hdr.h"
#include "render_base.h"

#define TILES 16u /* rows of tiles of product sampling */

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
    mcs_texel l = mcs_env_texel(e->table, w);
    return radiance_at(e, l.col, l.row);
}

static hdr_pixel encode(vec3 c) {
    const float rgb[3] = {c.x, c.y, c.z};
    return hdr_encode(rgb);
}

/* In the map's own axes. */
static vec3 texel_direction(const environment *e, uint32_t x, uint32_t y) {
    const float theta = PI * ((float)y + 0.5f) / (float)e->map.h;
    const float phi = 2 * PI * ((float)x + 0.5f) / (float)e->map.w;
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
    for (uint32_t y = 0; y < e->map.h; y++) {
        for (uint32_t x = 0; x < e->map.w; x++) {
            const vec3 d = texel_direction(e, x, y);
            const float near_sun = dot(d, to_sun);
            const float disc = fminf(fmaxf((near_sun - sun_cos) / edge, 0), 1);
            vec3 c;
            if (d.z > 0) {
                c = mix(powf(1 - d.z, 4), zenith, horizon);
                c = add(c, scale(powf(fmaxf(near_sun, 0), 12), haze));
            } else {
                c = mix(expf(30 * d.z), soil, scale(0.6f, horizon));
            }
            e->map.pixel[(size_t)y * e->map.w + x] = encode(add(c, scale(disc, sun)));
        }
    }
    return 1;
}

/* What the camera wants to know of the map: how bright it makes the ground, and where its main light stands, which is
 * taken as the direction of the squared luminance of the upper half. */
static void map_survey(environment *e) {
    double lx = 0;
    double ly = 0;
    double irradiance = 0;
    for (unsigned y = 0; y < e->map.h / 2; y++) {
        const float area = 2 * PI / (float)e->map.w *
                           (cosf(PI * (float)y / (float)e->map.h) - cosf(PI * (float)(y + 1) / (float)e->map.h));
        for (unsigned x = 0; x < e->map.w; x++) {
            const vec3 d = mcs_to_world(&e->table->frame, texel_direction(e, x, y));
            const double l = luminance(radiance_at(e, x, y));
            lx += l * l * area * d.x;
            ly += l * l * area * d.y;
            irradiance += l * area * d.z;
        }
    }
    e->irradiance = (float)irradiance;
    e->main_light = (float)atan2(ly, lx);
}

static int environment_make(environment *e, const char *map) {
    const char *name = map ? map : "built-in sky";
    if (!map && !map_sky(e, name)) return 0;
    if (map && !hdr_read(&e->map, map)) return complain(name, "%s", e->map.fault);
    const unsigned w = e->map.w;
    const unsigned h = e->map.h;
    size_t bytes = mcs_env_bytes(w, h);
    if (bytes == 0) return complain(name, "%u x %u texels are more than a sampling table takes", w, h);
    e->table = malloc(bytes);
    float *pixel;
    pixel = malloc((size_t)w * h * sizeof *pixel);
    if (!e->table || !pixel) {
        free(pixel);
        return complain(name, "not enough memory for the sampling table");
    }
    for (size_t i = 0; i < (size_t)w * h; i++)
        pixel[i] = luminance(radiance_at(e, (unsigned)(i % w), (unsigned)(i / w)));
    const mcs_image image = mcs_image_make(pixel, w, h, 1);
    int status = mcs_env_build(e->table, bytes, &image);
    free(pixel);
    if (status != MCS_OK) return complain(name, "no sampling table (status %d)", status);
    if (!(e->table->total > 0)) return complain(name, "the map is black: there is nothing to light the scene with");
    if (map)
        e->table->frame.t =
            vec(0, -1, 0); /* columns of a panorama run clockwise seen from above, azimuth the other way */
    map_survey(e);
    bytes = mcs_tiles_bytes(e->table, TILES);
    e->tiles = malloc(bytes);
    if (!e->tiles) return complain(name, "not enough memory for the tiles");
    status = mcs_tiles_build(e->tiles, bytes, e->table, TILES);
    return status == MCS_OK ? 1 : complain(name, "no tiles (status %d)", status);
}

#endif
