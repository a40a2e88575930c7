/* Light that things hide: a region of the scene learns from shadow rays which part of the map it sees, and the table
 * that is built from it draws from that part. A floor sees one quarter of a grey sky with a lamp in it; a bright sun is
 * in another one. Known answer, the irradiance over pi: 1/4, and 99 (cos^2 t0 - cos^2 t1) / W for the lamp's texel. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { W = 64, H = 32, SUN = 7 * W + 10, LAMP_ROW = 9, LAMP = LAMP_ROW * W + 25 };
enum { ROWS = 16 /* of tiles */, PASSES = 5, SAMPLES = 5000 };

static float sky[H][W];
static mcs_env *env;
static mcs_tiles *tiles;
static mcs_region *region, *fresh; /* what a table is built from, and the rays of samples that are drawn from it */
static mcs_product *table;

/* Whether light of this texel comes through, and a ray for the region. Your shadow ray goes here. */
static int reaches(mcs_texel t) {
    const int through = t.w.x < 0 && t.w.y > 0 && t.w.z > 0;
    mcs_region_add_ray(fresh, mcs_tiles_of_texel(tiles, env, t.col, t.row), through);
    return through;
}

/* A sample of the table and one of the BRDF, weighted by the balance heuristic. */
static double shade(const mcs_frame *frame, const float u[4]) {
    double sum = 0;
    const mcs_texel s = mcs_product_sample(table, tiles, env, u[0], u[1]);
    const float f_cos = mcs_cosine_pdf(mcs_to_local(frame, s.w)); /* the density of d, too */
    if (s.pdf > 0 && f_cos > 0 && reaches(s)) sum += sky[s.row][s.col] * f_cos / s.pdf * mcs_mis_balance(s.pdf, f_cos);
    const mcs_dir d = mcs_cosine_sample(u[2], u[3]);
    const mcs_texel t = mcs_product_texel(table, tiles, env, mcs_to_world(frame, d.w));
    if (d.pdf > 0 && reaches(t)) sum += sky[t.row][t.col] * mcs_mis_balance(d.pdf, t.pdf);
    return sum;
}

static int prepare(void) {
    const mcs_image image = mcs_image_make(&sky[0][0], W, H, 1);
    const size_t bytes = mcs_region_bytes(ROWS);
    for (int i = 0; i < W * H; i++) sky[i / W][i % W] = i == SUN ? 5000 : i == LAMP ? 100 : 1;
    env = (mcs_env *)malloc(mcs_env_bytes(W, H));
    if (mcs_env_build(env, mcs_env_bytes(W, H), &image) != MCS_OK) return 0; /* NULL is refused */
    tiles = (mcs_tiles *)malloc(mcs_tiles_bytes(env, ROWS));
    if (mcs_tiles_build(tiles, mcs_tiles_bytes(env, ROWS), env, ROWS) != MCS_OK) return 0;
    region = (mcs_region *)malloc(bytes);
    fresh = (mcs_region *)malloc(bytes);
    table = (mcs_product *)malloc(mcs_product_table_bytes(ROWS));
    return table && mcs_region_start(region, bytes, tiles) == MCS_OK && mcs_region_start(fresh, bytes, tiles) == MCS_OK;
}

int main(void) {
    const double pi = 3.14159265358979;
    const double exact = 0.25 + 99 * (pow(cos(pi * LAMP_ROW / H), 2) - pow(cos(pi * (LAMP_ROW + 1) / H), 2)) / W;
    const mcs_vec3 up = {0, 0, 1};
    const mcs_reflection matte = {mcs_frame_make(up), up, 1, 1, 1, MCS_PROFILE_GGX};
    mcs_pcg32 rng = mcs_pcg32_for(4, 1, 0);
    double first = 0;
    int wrong = 0;

    if (!prepare()) {
        puts("the tables could not be built");
        return 1;
    }
    mcs_region_add_point(region, tiles, env, &matte); /* a dozen, where normals or materials differ */
    for (int pass = 0; pass < PASSES; pass++) {
        mcs_stat s = {0, 0, 0};
        if (mcs_product_build_region(table, mcs_product_table_bytes(ROWS), tiles, env, region) != MCS_OK) return 1;
        for (int i = 0; i < SAMPLES; i++) {
            float u[4];
            mcs_pcg32_fill_n(&rng, 4, u);
            mcs_stat_add(&s, shade(&matte.frame, u));
        }
        mcs_region_merge(region, fresh); /* after the samples: no table knows the rays of its own */
        mcs_region_decay(fresh, 0);
        printf("pass %d: %.4f +- %.4f, exact %.4f\n", pass, s.mean, mcs_stat_error(&s), exact);
        wrong |= !(fabs(s.mean - exact) <= 5 * mcs_stat_error(&s));
        if (pass == 0) first = mcs_stat_error(&s);
        else wrong |= !(mcs_stat_error(&s) < first / 3); /* what learning is worth */
    }
    free(env);
    free(tiles);
    free(region);
    free(fresh);
    free(table);
    return wrong;
}
