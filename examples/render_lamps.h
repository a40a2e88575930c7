/* render_lamps.h - the lamps of render.c: a panel, which is a rectangle that gives light to both sides, and a bulb,
 * which is a ball. A direction to them is drawn evenly in solid angle, or evenly in area for comparison. */
#ifndef RENDER_LAMPS_H
#define RENDER_LAMPS_H
#include "render_base.h"

typedef struct {
    vec3 corner, edge_x, edge_y; /* of the panel; the edges are at right angles */
    vec3 center;                 /* of the bulb */
    float radius;
    vec3 panel_radiance, bulb_radiance;
    float extinction; /* of the haze around them, per length; 0: the air is clear */
} lamp_pair;

/* The lamps as they are seen from a point. */
typedef struct {
    const lamp_pair *both;
    vec3 p;
    int by_area;
    mcs_spherical_rectangle panel; /* unless by_area */
} lamps_view;

/* Light that comes to a point. */
typedef struct {
    vec3 w;
    float pdf; /* with which a strategy draws w from the light, per solid angle; 0: no light is there */
    vec3 radiance;
} incoming;

static incoming incoming_make(vec3 w, float pdf, vec3 radiance) {
    incoming light;
    light.w = w;
    light.pdf = pdf;
    light.radiance = radiance;
    return light;
}

static float panel_cosine(const lamp_pair *both, vec3 w) { return dot(w, unit(cross(both->edge_x, both->edge_y))); }

/* Distances along w, INFINITY where it misses the lamp. */
static float panel_distance(const lamp_pair *both, vec3 p, vec3 w) {
    const vec3 normal = unit(cross(both->edge_x, both->edge_y));
    const float distance = dot(sub(both->corner, p), normal) / dot(w, normal);
    if (!(distance > 0 && distance < INFINITY)) return INFINITY;
    const vec3 from_corner = sub(add(p, scale(distance, w)), both->corner);
    const float along_x = dot(from_corner, both->edge_x) / dot(both->edge_x, both->edge_x);
    const float along_y = dot(from_corner, both->edge_y) / dot(both->edge_y, both->edge_y);
    return along_x >= 0 && along_x <= 1 && along_y >= 0 && along_y <= 1 ? distance : INFINITY;
}

static float bulb_distance(const lamp_pair *both, vec3 p, vec3 w) {
    const vec3 to_center = sub(both->center, p);
    const float middle = dot(to_center, w);
    const vec3 aside = sub(to_center, scale(middle, w));
    const float half_chord2 = both->radius * both->radius - dot(aside, aside);
    return middle > 0 && half_chord2 > 0 ? middle - sqrtf(half_chord2) : INFINITY;
}

/* Of the nearer one. */
static float lamps_distance(const lamp_pair *both, vec3 p, vec3 w) {
    return fminf(panel_distance(both, p, w), bulb_distance(both, p, w));
}

static vec3 lamps_radiance(const lamp_pair *both, vec3 p, vec3 w) {
    const float panel = panel_distance(both, p, w);
    const float bulb = bulb_distance(both, p, w);
    if (bulb < panel) return both->bulb_radiance;
    return panel < INFINITY ? both->panel_radiance : black;
}

static lamps_view lamps_from(const lamp_pair *both, vec3 p, int by_area) {
    lamps_view view;
    memset(&view, 0, sizeof view);
    view.both = both;
    view.p = p;
    view.by_area = by_area;
    if (!by_area) view.panel = mcs_spherical_rectangle_make(p, both->corner, both->edge_x, both->edge_y);
    return view;
}

/* Densities with which each lamp is drawn, half of the samples being for the other one. */
static float pdf_by_angle(const lamps_view *view, vec3 w) {
    const lamp_pair *both = view->both;
    return 0.5f * (mcs_spherical_rectangle_pdf(&view->panel, w) + mcs_ball_pdf(view->p, both->center, both->radius, w));
}

static float pdf_by_area(const lamps_view *view, vec3 w) {
    const lamp_pair *both = view->both;
    const float panel = panel_distance(both, view->p, w);
    const float bulb = bulb_distance(both, view->p, w);
    float pdf = 0;
    if (panel < INFINITY) {
        const float area = sqrtf(dot(both->edge_x, both->edge_x) * dot(both->edge_y, both->edge_y));
        pdf += mcs_pdf_to_solid_angle(1 / area, panel, panel_cosine(both, w));
    }
    if (bulb < INFINITY) {
        const vec3 outwards = scale(1 / both->radius, sub(add(view->p, scale(bulb, w)), both->center));
        pdf += mcs_pdf_to_solid_angle(mcs_sphere_pdf(outwards) / (both->radius * both->radius), bulb, dot(w, outwards));
    }
    return 0.5f * pdf;
}

/* What comes from the direction w, if nothing but a lamp is in the way. */
static incoming lamps_along(const lamps_view *view, vec3 w) {
    const float pdf = view->by_area ? pdf_by_area(view, w) : pdf_by_angle(view, w);
    const vec3 sent = lamps_radiance(view->both, view->p, w);
    if (!(view->both->extinction > 0)) return incoming_make(w, pdf, sent);
    const float distance = lamps_distance(view->both, view->p, w);
    return incoming_make(w, pdf, scale(expf(-view->both->extinction * distance), sent));
}

static incoming lamps_draw_angle(const lamps_view *view, int bulb, float u1, float u2) {
    if (!bulb) return lamps_along(view, mcs_spherical_rectangle_sample(&view->panel, u1, u2).w);
    return lamps_along(view, mcs_ball_sample(view->p, view->both->center, view->both->radius, u1, u2).w);
}

static incoming lamps_draw_area(const lamps_view *view, int bulb, float u1, float u2) {
    const lamp_pair *both = view->both;
    vec3 on_lamp = add(both->corner, add(scale(u1, both->edge_x), scale(u2, both->edge_y)));
    const vec3 outwards = mcs_sphere_sample(u1, u2).w;
    if (bulb) on_lamp = add(both->center, scale(both->radius, outwards));
    const vec3 w = unit(sub(on_lamp, view->p));
    if (bulb && dot(w, outwards) >= 0) return incoming_make(w, 0, black); /* the far side of the bulb */
    return lamps_along(view, w);
}

/* u1 chooses the lamp; what is left of it is as even as before. */
static incoming lamps_draw(const lamps_view *view, float u1, float u2) {
    const int bulb = u1 >= 0.5f;
    const float rest = 2 * u1 - (float)bulb;
    return view->by_area ? lamps_draw_area(view, bulb, rest, u2) : lamps_draw_angle(view, bulb, rest, u2);
}

#endif
