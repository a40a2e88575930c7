/* Direct light: one sample of the map and one of the BRDF, each with its shadow ray, weighted by the power heuristic. A
 * GGX wall that faces +x, a grey sky with one texel of sun, a black floor. Known answer: a sum over fine cells of the
 * texels. Each sampler alone meets it, too, with a larger error. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { W = 64, H = 32, SUN = 9 * W + 1, FINE = 12, SAMPLES = 200000 };

static float sky[H][W];
static mcs_env *env;
static mcs_frame frame; /* of the wall */
static mcs_vec3 wo;
static mcs_ggx m;

/* Your shadow ray goes here. This one meets the floor wherever it goes down. */
static int visible(mcs_vec3 w) { return w.z > 0; }

static double sample_map(float u1, float u2, int mis) {
    const mcs_texel s = mcs_env_sample(env, u1, u2);
    const mcs_vec3 wi = mcs_to_local(&frame, s.w);
    if (!(s.pdf > 0 && wi.z > 0 && visible(s.w))) return 0;
    const double value = mcs_ggx_eval(&m, wo, wi) * wi.z * sky[s.row][s.col] / s.pdf;
    return mis ? value * mcs_mis_power(s.pdf, mcs_ggx_bounded_pdf(&m, wo, wi)) : value;
}

static double sample_brdf(float u1, float u2, int mis) {
    const mcs_brdf b = mcs_ggx_bounded_sample(&m, wo, u1, u2);
    const mcs_vec3 w = mcs_to_world(&frame, b.wi);
    if (!(b.pdf > 0 && visible(w))) return 0;
    const mcs_texel t = mcs_env_texel(env, w); /* radiance and density in one look-up */
    const double value = b.weight * sky[t.row][t.col];
    return mis ? value * mcs_mis_power(b.pdf, t.pdf) : value;
}

/* The sum over cells that each have the solid angle 2 pi / (FINE W) times dz. It is within 2e-4. */
static double known(void) {
    const double turn = 2 * 3.14159265358979 / (FINE * W);
    double sum = 0;
    for (int i = 0; i < FINE * H * FINE * W; i++) {
        const int row = i / (FINE * W);
        const int col = i % (FINE * W);
        const double top = cos(turn * W / H / 2 * row);
        const double dz = top - cos(turn * W / H / 2 * (row + 1));
        const double z = top - dz / 2;
        const double r = sqrt(1 - z * z);
        const mcs_vec3 w = {(float)(r * cos(turn * (col + 0.5))), (float)(r * sin(turn * (col + 0.5))), (float)z};
        const mcs_vec3 wi = mcs_to_local(&frame, w);
        if (visible(w)) sum += turn * dz * sky[row / FINE][col / FINE] * mcs_ggx_eval(&m, wo, wi) * fmax(wi.z, 0);
    }
    return sum;
}

static int report(const char *name, const mcs_stat *s, double exact) {
    printf("%-10s %.5f +- %.5f, exact %.5f\n", name, s->mean, mcs_stat_error(s), exact);
    return !(fabs(s->mean - exact) <= 5 * mcs_stat_error(s));
}

int main(void) {
    const mcs_vec3 normal = {1, 0, 0};
    const mcs_vec3 to_eye = {0.8f, -0.48f, -0.36f};
    const mcs_image image = mcs_image_make(&sky[0][0], W, H, 1);
    mcs_pcg32 rng = mcs_pcg32_for(14, 1, 0);
    mcs_stat map = {0, 0, 0};
    mcs_stat brdf = {0, 0, 0};
    mcs_stat both = {0, 0, 0};

    for (int i = 0; i < W * H; i++) sky[i / W][i % W] = i == SUN ? 1000 : 1;
    frame = mcs_frame_make(normal);
    wo = mcs_to_local(&frame, to_eye);
    m = mcs_ggx_make(0.1f, 0.1f);
    env = (mcs_env *)malloc(mcs_env_bytes(W, H));
    if (!env || mcs_env_build(env, mcs_env_bytes(W, H), &image) != MCS_OK) {
        puts("the table could not be built");
        return 1;
    }
    for (int i = 0; i < SAMPLES; i++) {
        float u[4];
        mcs_pcg32_fill_n(&rng, 4, u);
        mcs_stat_add(&map, sample_map(u[0], u[1], 0));
        mcs_stat_add(&brdf, sample_brdf(u[2], u[3], 0));
        mcs_stat_add(&both, sample_map(u[0], u[1], 1) + sample_brdf(u[2], u[3], 1));
    }
    const double exact = known();
    free(env);
    return report("map", &map, exact) | report("BRDF", &brdf, exact) | report("both, MIS", &both, exact);
}
