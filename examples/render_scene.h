/* render_scene.h - the scene of render.c and its camera: where rays go and what they meet. */
#ifndef RENDER_SCENE_H
#define RENDER_SCENE_H
#include "render_material.h"

#define SPHERES 8
#define NO_OBJECT (-1)
enum { GROUND = SPHERES, WALLS, OBJECTS }; /* numbers of objects behind those of the spheres */

/* A plane: all that is in a room lies on one side of it. */
typedef struct {
    vec3 outwards;
    float distance; /* of the plane from the origin */
} wall;
enum { LEFT, RIGHT, FRONT, BACK, CEILING, WALL_COUNT };

/* Spheres on the ground z = 0, in the open or in a room. The room has a window in its front wall, at the camera's back.
 */
typedef struct {
    vec3 center[SPHERES]; /* radius 1, resting on the ground */
    material of[SPHERES], tile[2], plaster;
    vec3 side, ahead; /* level axes of the camera, of the row and of the tiles */
    int in_room;
    wall walls[WALL_COUNT];
    vec3 eye, forward, right, up; /* right and up reach from the middle to the edges of the picture at distance 1 */
} scene;

typedef struct {
    const material *m;
    vec3 p, wo; /* world position; local direction to the eye */
    mcs_frame frame;
    int object;
} surface;

/* ---- building it ---- */

static void scene_materials(scene *s) {
    const vec3 none = {0, 0, 0};
    const vec3 gloss = {0.05f, 0.05f, 0.05f};
    const vec3 silver = {0.95f, 0.93f, 0.88f};
    const vec3 gold = {1.00f, 0.72f, 0.30f};
    const vec3 copper = {0.95f, 0.60f, 0.48f};
    const vec3 steel = {0.62f, 0.61f, 0.60f};
    s->of[0] = material_make(MATTE, 0, vec(0.78f, 0.36f, 0.18f), none, 0, 0);
    s->of[1] = material_make(PHONG, 0.5f, vec(0.52f, 0.05f, 0.04f), vec(0.14f, 0.14f, 0.14f), 120, 0);
    s->of[2] = material_make(WARD, 1, none, copper, 0.18f, 0.18f);
    s->of[3] = material_make(WARD, 1, none, steel, 0.06f, 0.35f);
    s->of[4] = material_make(GGX_VISIBLE, 1, none, gold, 0.06f, 0.06f);
    s->of[5] = material_make(GGX_VISIBLE, 0.5f, vec(0.03f, 0.12f, 0.42f), gloss, 0.12f, 0.12f);
    s->of[6] = material_make(GGX_BOUNDED, 1, none, silver, 0.40f, 0.40f);
    s->of[7] = material_make(ASHIKHMIN, 0.5f, vec(0.04f, 0.26f, 0.12f), vec(0.12f, 0.14f, 0.10f), 15, 600);
    s->tile[0] = material_make(MATTE, 0, vec(0.38f, 0.35f, 0.31f), none, 0, 0);
    s->tile[1] = material_make(MATTE, 0, vec(0.25f, 0.22f, 0.19f), none, 0, 0);
    s->plaster = material_make(MATTE, 0, vec(0.62f, 0.60f, 0.56f), none, 0, 0);
}

static wall wall_make(vec3 outwards, float distance) {
    wall a;
    a.outwards = outwards;
    a.distance = distance;
    return a;
}

/* Seen with the main light of the map behind the camera at the left, where it models the spheres, or falls through the
 * window, and stays out of the picture. */
static scene scene_make(int in_room, unsigned w, unsigned h, float main_light) {
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
    scene_materials(&s);
    s.in_room = in_room;
    s.walls[LEFT] = wall_make(scale(-1, s.side), 9);
    s.walls[RIGHT] = wall_make(s.side, 9);
    s.walls[FRONT] = wall_make(scale(-1, s.ahead), 6);
    s.walls[BACK] = wall_make(s.ahead, 6);
    s.walls[CEILING] = wall_make(vec(0, 0, 1), 5);
    s.forward = add(scale(cosf(elevation), s.ahead), vec(0, 0, -sinf(elevation)));
    s.eye = sub(vec(0, 0, 0.66f), scale(distance, s.forward));
    s.right = scale(half_width / distance, s.side);
    s.up = scale((float)h / (float)w, cross(s.right, s.forward));
    return s;
}

/* Position or direction by the axes of the scene. */
static vec3 in_scene_axes(const scene *s, vec3 v) { return vec(dot(v, s->side), dot(v, s->ahead), v.z); }

/* ---- rays ---- */

/* Distance along a unit direction to the front of sphere i, or 0. */
static float hit_sphere(const scene *s, int i, vec3 p, vec3 w) {
    const vec3 d = sub(s->center[i], p);
    const float b = dot(d, w);
    const float disc = b * b - dot(d, d) + 1;
    return b > 0 && disc > 0 ? b - sqrtf(disc) : 0;
}

/* Distance along w to where a ray from within the room meets a wall; *which it is. */
static float hit_walls(const scene *s, vec3 p, vec3 w, int *which) {
    float nearest = INFINITY;
    for (int i = 0; i < WALL_COUNT; i++) {
        const wall *a = &s->walls[i];
        const float speed = dot(w, a->outwards);
        const float t = speed > 0 ? (a->distance - dot(p, a->outwards)) / speed : INFINITY;
        if (t < nearest) {
            nearest = t;
            *which = i;
        }
    }
    return nearest;
}

/* Whether a point of a wall lies in the window. */
static int in_window(const scene *s, int which, vec3 p) {
    const float along = dot(p, s->side);
    return which == FRONT && along > -5 && along < 3 && p.z > 1.4f && p.z < 4.4f;
}

static int leaves_room(const scene *s, vec3 p, vec3 w) {
    int which = LEFT;
    const float t = hit_walls(s, p, w, &which);
    return in_window(s, which, add(p, scale(t, w)));
}

static int inside_room(const scene *s, vec3 p) {
    for (int i = 0; i < WALL_COUNT; i++)
        if (dot(p, s->walls[i].outwards) > s->walls[i].distance + 1e-3f) return 0;
    return 1;
}

/* Whether light comes from a direction w above the surface of an object to a point of it. All objects are convex, so
 * none shadows itself, and everything stands above the ground, so the ground stops exactly the directions that point
 * down. */
static int visible(const scene *s, vec3 p, vec3 w, int object) {
    if (w.z <= 0) return 0;
    if (s->in_room && !leaves_room(s, p, w)) return 0;
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

/* Of the point x->p of x->object, which is wall `which` if it is a wall. */
static void surface_finish(const scene *s, surface *x, int which) {
    if (x->object == GROUND) {
        x->p.z = 0;
        x->frame = mcs_frame_make(vec(0, 0, 1));
        x->m = &s->tile[fmodf(floorf(0.5f * dot(x->p, s->side)) + floorf(0.5f * dot(x->p, s->ahead)), 2) != 0];
    } else if (x->object == WALLS) {
        x->frame = mcs_frame_make(scale(-1, s->walls[which].outwards));
        x->m = &s->plaster;
    } else {
        x->frame = sphere_frame(unit(sub(x->p, s->center[x->object])));
        x->m = &s->of[x->object];
    }
}

/* What the camera sees along w. It looks through the walls that are between it and the room. */
static int intersect(const scene *s, vec3 p, vec3 w, surface *x) {
    float nearest = INFINITY;
    int which = LEFT;
    x->object = NO_OBJECT;
    if (w.z < 0) {
        nearest = -p.z / w.z;
        x->object = GROUND;
    }
    if (s->in_room) {
        const float t = hit_walls(s, p, w, &which);
        if (t < nearest) {
            nearest = t;
            x->object = in_window(s, which, add(p, scale(t, w))) ? NO_OBJECT : WALLS;
        }
    }
    for (int i = 0; i < SPHERES; i++) {
        const float t = hit_sphere(s, i, p, w);
        if (t > 0 && t < nearest) {
            nearest = t;
            x->object = i;
        }
    }
    x->p = add(p, scale(nearest, w));
    if (s->in_room && !inside_room(s, x->p)) x->object = NO_OBJECT;
    if (x->object == NO_OBJECT) return 0;
    surface_finish(s, x, which);
    x->wo = mcs_to_local(&x->frame, scale(-1, w));
    return 1;
}

/* What product sampling is told of a surface; Fresnel's factor as the mirror direction has it. */
static mcs_reflection reflection_of(const surface *x) {
    const material *m = x->m;
    const float base = m->p_lobe < 1 ? luminance(m->base) : 0;
    float lobe = 0;
    if (m->p_lobe > 0) lobe = m->kind == PHONG ? luminance(m->specular) : mcs_schlick(luminance(m->specular), x->wo.z);
    mcs_reflection r;
    r.frame = x->frame;
    r.wo = x->wo;
    r.alpha_x = m->alpha_x;
    r.alpha_y = m->alpha_y;
    r.matte = base / (base + lobe);
    r.profile = m->profile;
    return r;
}

/* ---- the camera ---- */

/* Through a point of the picture, (0, 0) its upper left corner and (1, 1) the lower right one. */
static vec3 camera_ray(const scene *s, float x, float y) {
    return unit(add(s->forward, add(scale(2 * x - 1, s->right), scale(1 - 2 * y, s->up))));
}

#endif
