/* A wavefront: all hits of a picture in arrays, and stage after stage a loop over all of them. The stages that have an
 * array form use the widest vectors of the processor. Surfaces turned at random, of three materials and seen from
 * anywhere, under a white sky and above grey ground. Directions come from the lobe and from the map, joined by the
 * balance heuristic. Known answer: the mean is that of directions from the lobe alone. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { HITS = 10000, ROUNDS = 50, W = 8, H = 4, MATERIALS = 3 };

static float map[H][W];
static const float roughness[MATERIALS] = {0.1f, 0.3f, 0.8f};
static float normal_x[HITS], normal_y[HITS], normal_z[HITS]; /* what tracing the camera's rays has left */
static float wo_x[HITS], wo_y[HITS], wo_z[HITS];             /* in the frame of the normal */
static float alpha[HITS];                                    /* what shading has left */
static const mcs_hits hits = {wo_x, wo_y, wo_z, alpha, alpha};
static float x[HITS], y[HITS], z[HITS]; /* wi: local, or in the world */
static float u1[HITS], u2[HITS];
static float lobe_pdf[HITS], map_pdf[HITS], weight[HITS], value[HITS];
static uint32_t col[HITS], row[HITS];
static double joined[HITS], lobe_alone[HITS]; /* estimates of the light that goes to the eye */

static void draw_numbers(mcs_pcg32 *rng) {
    mcs_pcg32_fill_n(rng, HITS, u1);
    mcs_pcg32_fill_n(rng, HITS, u2);
}

static void draw_from_lobe(const mcs_env *env) {
    mcs_ggx_bounded_sample_hits_n(NULL, &hits, HITS, u1, u2, x, y, z, lobe_pdf, weight);
    mcs_to_world_n(HITS, normal_x, normal_y, normal_z, x, y, z, x, y, z);
    mcs_env_texel_n(env, HITS, x, y, z, map_pdf, col, row);
    for (int i = 0; i < HITS; i++) {
        lobe_alone[i] = weight[i] > 0 ? weight[i] * map[row[i]][col[i]] : 0;
        joined[i] = lobe_alone[i] * mcs_mis_balance(lobe_pdf[i], map_pdf[i]);
    }
}
static void draw_from_map(const mcs_env *env) {
    mcs_env_sample_n(env, HITS, u1, u2, x, y, z, map_pdf, col, row);
    mcs_to_local_n(HITS, normal_x, normal_y, normal_z, x, y, z, x, y, z);
    mcs_ggx_bounded_pdf_hits_n(NULL, &hits, HITS, x, y, z, lobe_pdf, value);
    for (int i = 0; i < HITS; i++) {
        if (!(lobe_pdf[i] > 0)) continue;
        const float reflected = value[i] * z[i] * map[row[i]][col[i]] / map_pdf[i];
        joined[i] += reflected * mcs_mis_balance(map_pdf[i], lobe_pdf[i]);
    }
}

int main(void) {
    const mcs_image image = mcs_image_make(&map[0][0], W, H, 1);
    mcs_env *env = (mcs_env *)malloc(mcs_env_bytes(W, H));
    mcs_pcg32 rng = mcs_pcg32_for(17, 1, 0);
    mcs_stat difference = {0, 0, 0};

    for (int i = 0; i < W * H; i++) map[i / W][i % W] = i < W * H / 2 ? 1 : 0.25f;
    if (!env || mcs_env_build(env, mcs_env_bytes(W, H), &image) != MCS_OK) {
        puts("the table could not be built");
        return 1;
    }
    draw_numbers(&rng);
    mcs_sphere_sample_n(HITS, u1, u2, normal_x, normal_y, normal_z, NULL);
    draw_numbers(&rng);
    mcs_hemisphere_sample_n(HITS, u1, u2, wo_x, wo_y, wo_z, NULL);
    for (int i = 0; i < HITS; i++) alpha[i] = roughness[i % MATERIALS];
    for (int round = 0; round < ROUNDS; round++) {
        draw_numbers(&rng);
        draw_from_lobe(env);
        draw_numbers(&rng);
        draw_from_map(env);
        for (int i = 0; i < HITS; i++) mcs_stat_add(&difference, joined[i] - lobe_alone[i]);
    }
    free(env);
    printf("%d samples of %d hits are off by %.5f +- %.5f\n", ROUNDS * HITS, HITS, difference.mean,
           mcs_stat_error(&difference));
    return !(fabs(difference.mean) <= 5 * mcs_stat_error(&difference));
}
