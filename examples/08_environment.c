/* An environment map, latitude-longitude, row 0 at +z: a grey sky with one texel of sun. The table draws directions in
 * proportion to the radiance. Known answer: the irradiance on a surface facing +z is the sum over texels of radiance
 * times (2 pi / W) (cos^2 t0 - cos^2 t1) / 2, t0 and t1 being the polar angles of the texel's upper and lower edge. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { W = 64, H = 32, SUN_COLUMN = 10, SUN_ROW = 7 };

int main(void) {
    const double pi = 3.14159265358979;
    static float sky[H][W];
    const size_t bytes = mcs_env_bytes(W, H);
    mcs_env *env = (mcs_env *)malloc(bytes);
    const mcs_image image = mcs_image_make(&sky[0][0], W, H, 1);
    mcs_pcg32 rng = mcs_pcg32_for(8, 1, 0);
    mcs_stat table = {0, 0, 0};
    mcs_stat cosine = {0, 0, 0};
    double exact = 0;

    for (int y = 0; y < H; y++) {
        const double c0 = cos(pi * y / H);
        const double c1 = cos(pi * (y + 1) / H);
        for (int x = 0; x < W; x++) {
            sky[y][x] = x == SUN_COLUMN && y == SUN_ROW ? 500 : 1;
            if (y < H / 2) exact += sky[y][x] * (2 * pi / W) * (c0 * c0 - c1 * c1) / 2;
        }
    }
    if (!env || mcs_env_build(env, bytes, &image) != MCS_OK) {
        puts("the table could not be built");
        return 1;
    }
    for (int i = 0; i < 1000000; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(env, u1, u2);
        const mcs_dir d = mcs_cosine_sample(u1, u2);
        const mcs_texel at = mcs_env_texel(env, d.w);
        mcs_stat_add(&table, s.pdf > 0 && s.w.z > 0 ? sky[s.row][s.col] * s.w.z / s.pdf : 0);
        mcs_stat_add(&cosine, d.pdf > 0 ? sky[at.row][at.col] * d.w.z / d.pdf : 0);
    }
    free(env);
    printf("irradiance: environment-sampled %.4f +- %.4f, cosine-sampled %.4f +- %.4f, exact %.4f\n", table.mean,
           mcs_stat_error(&table), cosine.mean, mcs_stat_error(&cosine), exact);
    return !(fabs(table.mean - exact) <= 5 * mcs_stat_error(&table)) ||
           !(fabs(cosine.mean - exact) <= 5 * mcs_stat_error(&cosine));
}
