/* A wavefront: all hits of a picture in arrays, and stage after stage a loop over all of them. The stages that have an
 * array form use the widest vectors of the processor. Matte surfaces turned at random under a white sky and above grey
 * ground. Known answer: a surface of normal n sees of the sky the share (1 + n.z) / 2. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { HITS = 10000, ROUNDS = 50, W = 8, H = 4 };

static const float white = 1, grey = 0.25f;
static float normal_x[HITS], normal_y[HITS], normal_z[HITS]; /* what tracing the camera's rays has left */
static float x[HITS], y[HITS], z[HITS], pdf[HITS];           /* directions: local, then in the world */
static float u1[HITS], u2[HITS];
static uint32_t col[HITS], row[HITS];

static void to_world(void) {
    for (int i = 0; i < HITS; i++) {
        const mcs_vec3 n = {normal_x[i], normal_y[i], normal_z[i]};
        const mcs_vec3 wi = {x[i], y[i], z[i]};
        const mcs_frame frame = mcs_frame_make(n);
        const mcs_vec3 w = mcs_to_world(&frame, wi);
        x[i] = w.x;
        y[i] = w.y;
        z[i] = w.z;
    }
}

int main(void) {
    static float map[H][W];
    const mcs_image image = mcs_image_make(&map[0][0], W, H, 1);
    mcs_env *env = (mcs_env *)malloc(mcs_env_bytes(W, H));
    mcs_pcg32 rng = mcs_pcg32_for(17, 1, 0);
    mcs_stat difference = {0, 0, 0}; /* to the known answer of the hit */

    for (int i = 0; i < W * H; i++) map[i / W][i % W] = i < W * H / 2 ? white : grey;
    if (!env || mcs_env_build(env, mcs_env_bytes(W, H), &image) != MCS_OK) {
        puts("the table could not be built");
        return 1;
    }
    mcs_pcg32_fill_n(&rng, HITS, u1);
    mcs_pcg32_fill_n(&rng, HITS, u2);
    mcs_sphere_sample_n(HITS, u1, u2, normal_x, normal_y, normal_z, NULL);
    for (int round = 0; round < ROUNDS; round++) {
        mcs_pcg32_fill_n(&rng, HITS, u1);
        mcs_pcg32_fill_n(&rng, HITS, u2);
        mcs_cosine_sample_n(HITS, u1, u2, x, y, z, pdf); /* white and matte: the weight is 1 */
        to_world();
        mcs_env_texel_n(env, HITS, x, y, z, NULL, col, row);
        for (int i = 0; i < HITS; i++) {
            const double light = pdf[i] > 0 ? map[row[i]][col[i]] : 0;
            mcs_stat_add(&difference, light - (grey + (white - grey) * (1 + normal_z[i]) / 2));
        }
    }
    free(env);
    printf("%d samples of %d hits are off by %.5f +- %.5f\n", ROUNDS * HITS, HITS, difference.mean,
           mcs_stat_error(&difference));
    return !(fabs(difference.mean) <= 5 * mcs_stat_error(&difference));
}
