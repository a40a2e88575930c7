/* render_point.h - a point that is lit: what strategies of render.c are given. */
#ifndef RENDER_POINT_H
#define RENDER_POINT_H
#include "render_learning.h"

typedef struct {
    const scene *s;
    const environment *e;
    const surface *hit;
    strategy how;
    mcs_pcg32 *rng;
    const lamps_view *lamps; /* in place of e, where s->by_lamps */
    learning *regions;       /* NULL for strategies that do not learn */
    const region *region;    /* of the point; for these alone */
    shadow_rays *rays;       /* on their way to the regions */
    uint32_t drawn;          /* light samples so far */
} lit_point;

/* Whether nothing stands between the point and the light that is along w. */
static int point_sees(const lit_point *x, vec3 w) { return visible(x->s, x->hit->p, w, x->hit->object); }

/* A direction drawn from the BRDF. */
static bounce point_bounce(const lit_point *x) {
    const float u_choice = mcs_pcg32_float(x->rng);
    const float u1 = mcs_pcg32_float(x->rng);
    const float u2 = mcs_pcg32_float(x->rng);
    return material_sample(x->hit->m, x->hit->wo, u_choice, u1, u2);
}

/* Whether one BRDF sample is due, of which there are `share` for each light sample. */
static int point_bounce_is_due(lit_point *x, float share) {
    if (share < 1 && !(mcs_pcg32_float(x->rng) < share)) return 0;
    x->drawn++;
    return 1;
}

#endif
