/* render_scene.h - the scene of render.c and its camera: where rays go and what they meet. */
#ifndef RENDER_SCENE_H
#define RENDER_SCENE_H
#include "render_lamps.h"
#include "render_light.h"
#include "render_material.h"
#include "render_options.h"

#define SPHERES 8
#define NO_OBJECT (-1)
enum { GROUND = SPHERES, WALLS, OBJECTS };      /* numbers of objects behind those of the spheres */
enum { SMOOTH_SPHERE = 2, FROSTED_SPHERE = 6 }; /* those of glass, by lamps */

/* A plane: all that is in a room lies on one side of it. */
typedef struct {
    vec3 outwards;
    float distance; /* of the plane from the origin */
} wall;
enum { LEFT, RIGHT, FRONT, BACK, CEILING, WALL_COUNT };

/* Spheres on the ground z = 0, in the open, in a room or by lamps, in clear air or haze. The room has a window in its
 * front wall, at the camera's back. */
typedef struct {
    vec3 center[SPHERES]; /* radius 1, resting on the ground */
    material of[SPHERES], tile[2], plaster;
    vec3 side, ahead; /* level axes of the camera, of the row and of the tiles */
    int in_room, by_lamps;
    wall walls[WALL_COUNT];       /* of the room */
    lamp_pair lamps;              /* in place of the environment */
    vec3 eye, forward, right, up; /* right and up reach from the middle to the edges of the picture at distance 1 */
} scene;

typedef struct {
    int object; /* NO_OBJECT: the ray leaves the scene, or meets a lamp, and the rest is unknown */
    const material *m;
    vec3 p, wo; /* world position; local direction to where the ray came from */
    mcs_frame frame;
} surface;

static const char *object_name(scene_kind kind, int object) {
    static const char *const name[OBJECTS] = {"matte",  "Phong",  "Ward.18", "Ward ani", "GGX.06",
                                              "GGX.12", "GGX.40", "A.-S.",   "ground",   "walls"};
    if (kind == LAMPS && object == SMOOTH_SPHERE) return "glass";
    if (kind == LAMPS && object == FROSTED_SPHERE) return "frosted";
    return name[object];
}

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

/* The bulb hangs in front of the spheres, the panel above the upper edge of the picture. */
static void scene_lamps(scene *s) {
    s->lamps.corner = add(scale(-6, s->side), add(scale(-3, s->ahead), vec(0, 0, 5)));
    s->lamps.edge_x = scale(8, s->side);
    s->lamps.edge_y = add(scale(2, s->ahead), vec(0, 0, 1));
    s->lamps.panel_radiance = vec(6, 7, 8.5f);
    s->lamps.center = add(scale(0.2f, s->side), add(scale(-2.6f, s->ahead), vec(0, 0, 0.6f)));
    s->lamps.radius = 0.3f;
    s->lamps.bulb_radiance = vec(30, 18, 8);
    s->lamps.extinction = 0;
}

static void scene_glass(scene *s) {
    s->of[SMOOTH_SPHERE] = glass_make(1.5f, 0);
    s->of[FROSTED_SPHERE] = glass_make(1.5f, 0.15f);
}

static wall wall_make(vec3 outwards, float distance) {
    wall flat;
    flat.outwards = outwards;
    flat.distance = distance;
    return flat;
}

/* Seen with the main light of the map behind the camera at the left, where it models the spheres, or falls through the
 * window, and stays out of the picture. */
static scene scene_make(scene_kind kind, float height_per_width, float main_light) {
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
    s.in_room = kind == ROOM;
    s.by_lamps = has_lamps(kind);
    scene_lamps(&s);
    if (kind == LAMPS) scene_glass(&s);
    if (kind == HAZE) s.lamps.extinction = 0.02f;
    s.walls[LEFT] = wall_make(scale(-1, s.side), 9);
    s.walls[RIGHT] = wall_make(s.side, 9);
    s.walls[FRONT] = wall_make(scale(-1, s.ahead), 6);
    s.walls[BACK] = wall_make(s.ahead, 6);
    s.walls[CEILING] = wall_make(vec(0, 0, 1), 5);
    s.forward = add(scale(cosf(elevation), s.ahead), vec(0, 0, -sinf(elevation)));
    s.eye = sub(vec(0, 0, 0.66f), scale(distance, s.forward));
    s.right = scale(half_width / distance, s.side);
    s.up = scale(height_per_width, cross(s.right, s.forward));
    return s;
}

/* Position or direction by the axes of the scene. */
static vec3 in_scene_axes(const scene *s, vec3 v) { return vec(dot(v, s->side), dot(v, s->ahead), v.z); }

/* ---- rays ---- */

/* Distance along a unit direction to the front of sphere i, or 0. */
static float hit_sphere(const scene *s, int i, vec3 p, vec3 w) {
    const vec3 to_center = sub(s->center[i], p);
    const float middle = dot(to_center, w);
    const float half_chord2 = middle * middle - dot(to_center, to_center) + 1;
    return middle > 0 && half_chord2 > 0 ? middle - sqrtf(half_chord2) : 0;
}

/* Distance along a direction that goes into sphere i, from a point of its surface to the other side; at most 0 along
 * one that goes out of it. */
static float cross_sphere(const scene *s, int i, vec3 p, vec3 w) { return 2 * dot(sub(s->center[i], p), w); }

/* Distance along w to where a ray from within the room meets a wall; *which it is. */
static float hit_walls(const scene *s, vec3 p, vec3 w, int *which) {
    float nearest = INFINITY;
    for (int i = 0; i < WALL_COUNT; i++) {
        const wall *flat = &s->walls[i];
        const float speed = dot(w, flat->outwards);
        const float distance = speed > 0 ? (flat->distance - dot(p, flat->outwards)) / speed : INFINITY;
        if (distance < nearest) {
            nearest = distance;
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
    const float distance = hit_walls(s, p, w, &which);
    return in_window(s, which, add(p, scale(distance, w)));
}

static int inside_room(const scene *s, vec3 p) {
    for (int i = 0; i < WALL_COUNT; i++)
        if (dot(p, s->walls[i].outwards) > s->walls[i].distance + 1e-3f) return 0;
    return 1;
}

/* Whether light comes from a direction w above the surface of an object to a point of it: that of a lamp, if there are
 * lamps. All objects are convex, so none shadows itself. Everything stands above the ground. Glass has a shadow, too:
 * the light that it gathers is left out. */
static int visible(const scene *s, vec3 p, vec3 w, int object) {
    const float distance = s->by_lamps ? lamps_distance(&s->lamps, p, w) : INFINITY;
    if (!(p.z + distance * w.z > 0)) return 0; /* the ground */
    if (s->in_room && !leaves_room(s, p, w)) return 0;
    for (int i = 0; i < SPHERES; i++) {
        const float in_between = i != object ? hit_sphere(s, i, p, w) : 0;
        if (in_between > 0 && in_between < distance) return 0;
    }
    return 1;
}

/* Spheres get tangents along their circles of latitude, as if turned on a lathe: the anisotropic ones need a direction.
 */
static mcs_frame sphere_frame(vec3 normal) {
    if (normal.x * normal.x + normal.y * normal.y < 1e-8f) return mcs_frame_make(normal);
    mcs_frame frame;
    frame.n = normal;
    frame.s = unit(vec(-normal.y, normal.x, 0));
    frame.t = cross(normal, frame.s);
    return frame;
}

/* Of the point hit->p of hit->object, which is wall `which` if it is a wall. */
static void surface_finish(const scene *s, surface *hit, int which) {
    if (hit->object == GROUND) {
        hit->p.z = 0;
        hit->frame = mcs_frame_make(vec(0, 0, 1));
        hit->m =
            &s->tile[fmodf(floorf(0.5f * dot(hit->p, s->side) + 0.5f) + floorf(0.5f * dot(hit->p, s->ahead)), 2) != 0];
    } else if (hit->object == WALLS) {
        hit->frame = mcs_frame_make(scale(-1, s->walls[which].outwards));
        hit->m = &s->plaster;
    } else {
        hit->frame = sphere_frame(unit(sub(hit->p, s->center[hit->object])));
        hit->m = &s->of[hit->object];
    }
}

/* What a ray along w meets first. It comes from the camera, which looks through the walls that are between it and the
 * room, or from a point of the object `from`. Returns 0 where that is light. */
static int intersect(const scene *s, vec3 p, vec3 w, int from, surface *hit) {
    float nearest = INFINITY;
    int which = LEFT;
    hit->object = NO_OBJECT;
    if (w.z < 0) {
        nearest = -p.z / w.z;
        hit->object = GROUND;
    }
    if (s->in_room) {
        const float distance = hit_walls(s, p, w, &which);
        if (distance < nearest) {
            nearest = distance;
            hit->object = in_window(s, which, add(p, scale(distance, w))) ? NO_OBJECT : WALLS;
        }
    }
    for (int i = 0; i < SPHERES; i++) {
        const float distance = i == from ? cross_sphere(s, i, p, w) : hit_sphere(s, i, p, w);
        if (distance > 0 && distance < nearest) {
            nearest = distance;
            hit->object = i;
        }
    }
    if (s->by_lamps && lamps_distance(&s->lamps, p, w) < nearest) hit->object = NO_OBJECT;
    hit->p = add(p, scale(nearest, w));
    if (s->in_room && !inside_room(s, hit->p)) hit->object = NO_OBJECT;
    if (hit->object == NO_OBJECT) return 0;
    surface_finish(s, hit, which);
    hit->wo = mcs_to_local(&hit->frame, scale(-1, w));
    return 1;
}

/* Of the light that a ray meets which meets nothing else. */
static vec3 light_in_sight(const scene *s, const environment *e, vec3 p, vec3 w) {
    return s->by_lamps ? lamps_radiance(&s->lamps, p, w) : radiance(e, w);
}

/* What product sampling is told of a surface; Fresnel's factor as the mirror direction has it. */
static mcs_reflection reflection_of(const surface *hit) {
    const material *m = hit->m;
    const float base = m->p_lobe < 1 ? luminance(m->base) : 0;
    float lobe = 0;
    if (m->p_lobe > 0)
        lobe = m->kind == PHONG ? luminance(m->specular) : mcs_schlick(luminance(m->specular), hit->wo.z);
    mcs_reflection r;
    r.frame = hit->frame;
    r.wo = hit->wo;
    r.alpha_x = m->alpha_x;
    r.alpha_y = m->alpha_y;
    r.matte = base / (base + lobe);
    r.profile = m->profile;
    return r;
}

/* ---- the camera ---- */

/* Through a point of the picture, (0, 0) its upper left corner and (1, 1) the lower right one. */
static vec3 camera_ray(const scene *s, float across, float down) {
    return unit(add(s->forward, add(scale(2 * across - 1, s->right), scale(1 - 2 * down, s->up))));
}

#endif
