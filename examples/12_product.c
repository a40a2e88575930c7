/* Product sampling: directions drawn in proportion, nearly, to radiance times cosine, by a table for the one point. The
 * map is that of 08_environment.c, a grey sky with one texel of sun, seen by a matte surface that faces +z. The known
 * answer is the same: the sum over texels of radiance times (2 pi / W) (cos^2 t0 - cos^2 t1) / 2. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { W = 64, H = 32, SUN_COLUMN = 10, SUN_ROW = 7, TILE_ROWS = 16, SAMPLES = 100000 };

int main(void) {
    const double pi = 3.14159265358979;
    static float sky[H][W];
    const mcs_image image = mcs_image_make(&sky[0][0], W, H, 1);
    const size_t bytes = mcs_env_bytes(W, H);
    const size_t point_bytes = mcs_product_bytes(TILE_ROWS);
    mcs_env *env = (mcs_env *)malloc(bytes);
    mcs_product *point = (mcs_product *)malloc(point_bytes);
    const mcs_vec3 up = {0, 0, 1};
    const mcs_reflection matte = {mcs_frame_make(up), up, 1, 1, 1, MCS_PROFILE_GGX};
    mcs_pcg32 rng = mcs_pcg32_for(12, 1, 0);
    mcs_stat plain = {0, 0, 0};
    mcs_stat prepared = {0, 0, 0};
    double exact = 0;

    for (int y = 0; y < H; y++) {
        const double c0 = cos(pi * y / H);
        const double c1 = cos(pi * (y + 1) / H);
        for (int x = 0; x < W; x++) {
            sky[y][x] = x == SUN_COLUMN && y == SUN_ROW ? 500 : 1;
            if (y < H / 2) exact += sky[y][x] * (2 * pi / W) * (c0 * c0 - c1 * c1) / 2;
        }
    }
    if (!env || !point || mcs_env_build(env, bytes, &image) != MCS_OK) {
        puts("the table could not be built");
        return 1;
    }
    mcs_tiles *tiles = (mcs_tiles *)malloc(mcs_tiles_bytes(env, TILE_ROWS)); /* once per map */
    if (!tiles || mcs_tiles_build(tiles, mcs_tiles_bytes(env, TILE_ROWS), env, TILE_ROWS) != MCS_OK) {
        puts("no tiles");
        return 1;
    }
    if (mcs_product_build(point, point_bytes, tiles, env, &matte, NULL) != MCS_OK) { /* once per point */
        puts("the product could not be built");
        return 1;
    }
    for (int i = 0; i < SAMPLES; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_texel e = mcs_env_sample(env, u1, u2);
        const mcs_texel p = mcs_product_sample(point, tiles, env, u1, u2);
        mcs_stat_add(&plain, e.pdf > 0 && e.w.z > 0 ? sky[e.row][e.col] * e.w.z / e.pdf : 0);
        mcs_stat_add(&prepared, p.pdf > 0 && p.w.z > 0 ? sky[p.row][p.col] * p.w.z / p.pdf : 0);
    }
    free(env);
    free(tiles);
    free(point);
    printf("irradiance: map %.4f +- %.4f, product %.4f +- %.4f, exact %.4f\n", plain.mean, mcs_stat_error(&plain),
           prepared.mean, mcs_stat_error(&prepared), exact);
    return !(fabs(prepared.mean - exact) <= 5 * mcs_stat_error(&prepared));
}
