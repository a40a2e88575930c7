/* render_scene.h - the scene of render.c and its camera: where rays go and what they meet. */
#ifndef RENDER_SCENE_H
#define RENDER_SCENE_H
#include "render_material.h"

#define SPHERES 8
#define NO_OBJECT (-1)
#define GROUND SPHERES /* index of the ground, the plane z = 0 */

typedef struct {
    vec3 center[SPHERES]; /* radius 1, resting on the ground */
    material of[SPHERES], tile[2];
    vec3 side, ahead;             /* level axes of the camera, of the row and of the tiles */
    vec3 eye, forward, right, up; /* right and up reach from the middle to the edges of the picture at distance 1 */
} scene;

typedef struct {
    const material *m;
    vec3 p, wo; /* world position; local direction to the eye */
    mcs_frame frame;
    int object;
} surface;

/* Seen with the main light of the map behind the camera at the left, where it models the spheres and stays out of the
 * picture. */
static scene scene_make(unsigned w, unsigned h, float main_light) {
    const vec3 none = {0, 0, 0};
    const vec3 gloss = {0.05f, 0.05f, 0.05f};
    const vec3 silver = {0.95f, 0.93f, 0.88f};
    const vec3 gold = {1.00f, 0.72f, 0.30f};
    const vec3 copper = {0.95f, 0.60f, 0.48f};
    const vec3 steel = {0.62f, 0.61f, 0.60f};
    const float half_width = 7.75f;
    const float distance = 26;
    const float elevation = 27 * PI / 180;
    const float azimuth = main_light - 118 * PI / 180;
    scene s;
    s.ahead = vec(cosf(azimuth), sinf(azimuth), 0);
    s.side = vec(s.ahead.y, -s.ahead.x, 0);
    for (int i = 0; i < SPHERES; i++)
        s.center[i] =
            add(vec(0, 0, 1), add(scale(1.82f * (float)i - 6.24f, s.side), scale(i % 2 ? 0.75f : -0.75f, s.ahead)));
    s.of[0] = material_make(MATTE, 0, vec(0.78f, 0.36f, 0.18f), none, 0, 0);
    s.of[1] = material_make(PHONG, 0.5f, vec(0.52f, 0.05f, 0.04f), vec(0.14f, 0.14f, 0.14f), 120, 0);
    s.of[2] = material_make(WARD, 1, none, copper, 0.18f, 0.18f);
    s.of[3] = material_make(WARD, 1, none, steel, 0.06f, 0.35f);
    s.of[4] = material_make(GGX_VISIBLE, 1, none, gold, 0.06f, 0.06f);
    s.of[5] = material_make(GGX_VISIBLE, 0.5f, vec(0.03f, 0.12f, 0.42f), gloss, 0.12f, 0.12f);
    s.of[6] = material_make(GGX_BOUNDED, 1, none, silver, 0.40f, 0.40f);
    s.of[7] = material_make(ASHIKHMIN, 0.5f, vec(0.04f, 0.26f, 0.12f), vec(0.12f, 0.14f, 0.10f), 15, 600);
    s.tile[0] = material_make(MATTE, 0, vec(0.38f, 0.35f, 0.31f), none, 0, 0);
    s.tile[1] = material_make(MATTE, 0, vec(0.25f, 0.22f, 0.19f), none, 0, 0);
    s.forward = add(scale(cosf(elevation), s.ahead), vec(0, 0, -sinf(elevation)));
    s.eye = sub(vec(0, 0, 0.66f), scale(distance, s.forward));
    s.right = scale(half_width / distance, s.side);
    s.up = scale((float)h / (float)w, cross(s.right, s.forward));
    return s;
}

/* Distance along a unit direction to the front of sphere i, or 0. */
static float hit_sphere(const scene *s, int i, vec3 p, vec3 w) {
    const vec3 d = sub(s->center[i], p);
    const float b = dot(d, w);
    const float disc = b * b - dot(d, d) + 1;
    return b > 0 && disc > 0 ? b - sqrtf(disc) : 0;
}

/* From a point on an object in the direction w above its surface. All objects are convex, so none shadows itself, and
 * everything stands above the ground, so the ground stops exactly the directions that point down. */
static int visible(const scene *s, vec3 p, vec3 w, int object) {
    if (w.z <= 0) return 0;
    for (int i = 0; i < SPHERES; i++)
        if (i != object && hit_sphere(s, i, p, w) > 0) return 0;
    return 1;
}

/* Spheres get tangents along their circles of latitude, as if turned on a lathe: the anisotropic ones need a direction.
 */
static mcs_frame sphere_frame(vec3 n) {
    if (n.x * n.x + n.y * n.y < 1e-8f) return mcs_frame_make(n);
    mcs_frame f;
    f.n = n;
    f.s = unit(vec(-n.y, n.x, 0));
    f.t = cross(n, f.s);
    return f;
}

static int intersect(const scene *s, vec3 p, vec3 w, surface *x) {
    float nearest = INFINITY;
    x->object = NO_OBJECT;
    if (w.z < 0) {
        nearest = -p.z / w.z;
        x->object = GROUND;
    }
    for (int i = 0; i < SPHERES; i++) {
        const float t = hit_sphere(s, i, p, w);
        if (t > 0 && t < nearest) {
            nearest = t;
            x->object = i;
        }
    }
    if (x->object == NO_OBJECT) return 0;
    x->p = add(p, scale(nearest, w));
    if (x->object == GROUND) {
        x->p.z = 0;
        x->frame = mcs_frame_make(vec(0, 0, 1));
        x->m = &s->tile[fmodf(floorf(0.5f * dot(x->p, s->side)) + floorf(0.5f * dot(x->p, s->ahead)), 2) != 0];
    } else {
        x->frame = sphere_frame(unit(sub(x->p, s->center[x->object])));
        x->m = &s->of[x->object];
    }
    x->wo = mcs_to_local(&x->frame, scale(-1, w));
    return 1;
}

#endif
