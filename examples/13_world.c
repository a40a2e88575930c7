/* Shading in world coordinates: a frame around the normal of the hit, wo into it, a sample of the BRDF, wi out of it.
 * Known answer, of Phong's lobe with exponent 1 under a sky of radiance 1 + a.w: with c the angle between the normal n
 * and the eye, and R the direction to the eye mirrored at n,
 *     (sin c + (pi - c) cos c) / pi + 3/16 (1 + cos c) a.(n + R). */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

/* All in world coordinates, of unit length. */
typedef struct {
    mcs_vec3 normal, to_eye;
} hit;

static const mcs_vec3 a = {0.5f, -0.4f, 0.6f};

static double dot(mcs_vec3 v, mcs_vec3 w) { return (double)v.x * w.x + (double)v.y * w.y + (double)v.z * w.z; }

static double sky(mcs_vec3 w) { return 1 + dot(a, w); }

/* One sample of the light that the hit reflects to the eye. */
static double shade(const hit *h, const mcs_phong *m, mcs_pcg32 *rng) {
    const mcs_frame frame = mcs_frame_make(h->normal);
    const mcs_vec3 wo = mcs_to_local(&frame, h->to_eye);
    const float u1 = mcs_pcg32_float(rng);
    const float u2 = mcs_pcg32_float(rng);
    const mcs_brdf b = mcs_phong_sample(m, wo, u1, u2);
    if (!(b.pdf > 0)) return 0; /* lost below the surface: worth nothing, but still counted */
    return b.weight * sky(mcs_to_world(&frame, b.wi));
}

static double known(const hit *h) {
    const double pi = 3.14159265358979;
    const double cos_c = dot(h->normal, h->to_eye);
    const double c = acos(cos_c);
    const double slope =
        (1 + 2 * cos_c) * dot(a, h->normal) - dot(a, h->to_eye); /* a.(n + R), as R = 2 cos c n - eye */
    return (sin(c) + (pi - c) * cos_c) / pi + 3 * (1 + cos_c) * slope / 16;
}

int main(void) {
    const hit hits[] = {
        {{0, 0, 1}, {0.6f, 0, 0.8f}},
        {{0, 0, -1}, {0.96f, 0, -0.28f}}, /* a ceiling, seen at 74 degrees */
        {{0.6f, 0, -0.8f}, {0, 0.6f, -0.8f}},
        {{-0.48f, 0.64f, 0.6f}, {0, 1, 0}},
    };
    const mcs_phong m = mcs_phong_make(1);
    mcs_pcg32 rng = mcs_pcg32_for(13, 1, 0);
    int wrong = 0;

    for (int i = 0; i < 4; i++) {
        const double exact = known(&hits[i]);
        mcs_stat s = {0, 0, 0};
        for (int k = 0; k < 250000; k++) mcs_stat_add(&s, shade(&hits[i], &m, &rng));
        printf("hit %d reflects %.5f +- %.5f, exact %.5f\n", i, s.mean, mcs_stat_error(&s), exact);
        wrong |= !(fabs(s.mean - exact) <= 5 * mcs_stat_error(&s));
    }
    return wrong;
}
