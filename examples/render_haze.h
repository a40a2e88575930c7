/* render_haze.h - haze around the lamps of render.c, alike in all places. It takes from the light that goes through it,
 * and scatters some to the camera. Light that it scatters to surfaces, or twice, is left out. Strategies do at a droplet
 * what they do at a surface, with the phase function in place of the BRDF and all directions in place of a hemisphere. */
#ifndef RENDER_HAZE_H
#define RENDER_HAZE_H
#include "render_point.h"

static const float haze_albedo = 0.95f;  /* what it scatters of the light that it takes */
static const float haze_mean_cos = 0.6f; /* most of that goes on nearly as before */

/* Whether haze scatters a ray along w that would meet `hit`, or a lamp. *droplet becomes the point where it does, in a
 * frame whose +z is along the ray. How far a ray gets has the exponential density. */
static int haze_meets(const scene *s, vec3 p, vec3 w, const surface *hit, mcs_pcg32 *rng, surface *droplet) {
    if (!(s->lamps.extinction > 0)) return 0;
    const float all = hit->object == NO_OBJECT ? lamps_distance(&s->lamps, p, w) : dot(sub(hit->p, p), w);
    const float flight = mcs_exponential_sample(s->lamps.extinction, mcs_pcg32_float(rng)).x;
    droplet->object = NO_OBJECT;
    droplet->m = NULL;
    droplet->p = add(p, scale(flight, w));
    droplet->frame = mcs_frame_make(w);
    droplet->wo = vec(0, 0, -1);
    return flight < all;
}

/* The phase function: the density of directions, and the part of the light that goes there. */
static float haze_phase(const lit_point *x, vec3 w) {
    return mcs_henyey_greenstein_pdf(haze_mean_cos, mcs_to_local(&x->hit->frame, w));
}

/* Light from w, which was drawn with that density; `other` is that of the strategy beside it, or 0. */
static vec3 haze_value(const lit_point *x, vec3 w, float pdf, float other) {
    if (!(pdf > 0 && point_sees(x, w))) return black;
    const float scattered = haze_albedo * haze_phase(x, w) / pdf;
    return scale(mcs_mis_power(pdf, other) * scattered, lamps_along(x->lamps, w).radiance);
}

static vec3 haze_by_sphere(const lit_point *x) {
    const float u1 = mcs_pcg32_float(x->rng);
    const float u2 = mcs_pcg32_float(x->rng);
    const mcs_dir d = mcs_sphere_sample(u1, u2);
    return haze_value(x, d.w, d.pdf, 0);
}

static vec3 haze_by_phase(const lit_point *x, int mis) {
    const float u1 = mcs_pcg32_float(x->rng);
    const float u2 = mcs_pcg32_float(x->rng);
    const mcs_dir d = mcs_henyey_greenstein_sample(haze_mean_cos, u1, u2);
    const vec3 w = mcs_to_world(&x->hit->frame, d.w);
    return haze_value(x, w, haze_phase(x, w), mis ? lamps_along(x->lamps, w).pdf : 0);
}

static vec3 haze_by_lamps(const lit_point *x, int mis) {
    const float u1 = mcs_pcg32_float(x->rng);
    const float u2 = mcs_pcg32_float(x->rng);
    const incoming light = lamps_draw(x->lamps, u1, u2);
    return haze_value(x, light.w, light.pdf, mis ? haze_phase(x, light.w) : 0);
}

/* The light that a droplet scatters to the camera: the mean of so many estimates. */
static vec3 haze_scatter(lit_point *x, uint32_t estimates) {
    vec3 sum = black;
    for (uint32_t i = 0; i < estimates; i++) {
        switch (x->how) {
        case BRDF: sum = add(sum, haze_by_phase(x, 0)); break;
        case MIS:
            sum = add(sum, add(haze_by_phase(x, 1), haze_by_lamps(x, 1)));
            x->drawn++;
            break;
        case ANGLE: sum = add(sum, haze_by_lamps(x, 0)); break;
        default: sum = add(sum, haze_by_sphere(x)); /* UNIFORM, COSINE */
        }
        x->drawn++;
    }
    return scale(1 / (float)estimates, sum);
}

#endif
