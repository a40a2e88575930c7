/* The scenes of shadow.c: what stands in the way of light, the points that an eye sees, and their regions. +z is up, as
 * in the maps. */
#ifndef MCST_SHADOW_SCENE_H
#define MCST_SHADOW_SCENE_H
#include "mcsample.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- Vectors ---- */

static mcs_vec3 vector(float x, float y, float z) {
    mcs_vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
static float dot(mcs_vec3 a, mcs_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
/* a + t b */
static mcs_vec3 along(mcs_vec3 a, float t, mcs_vec3 b) { return vector(a.x + t * b.x, a.y + t * b.y, a.z + t * b.z); }
static mcs_vec3 unit(mcs_vec3 v) { return along(vector(0, 0, 0), 1 / sqrtf(dot(v, v)), v); }
static float component(mcs_vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/* ---- What stands in the way ---- */

typedef struct {
    mcs_vec3 centre;
    float radius;
} ball;

typedef struct {
    mcs_vec3 low, high;
} block;

typedef struct {
    mcs_vec3 centre, normal;
    float radius;
} leaf;

enum { BALLS = 8, BLOCKS = 16, TWIGS = 40, LEAVES_OF_TWIG = 10 };

/* Leaves in the ball round them. */
typedef struct {
    ball around;
    leaf leaf[LEAVES_OF_TWIG];
} twig;

typedef struct {
    const char *name;
    mcs_vec3 eye, target;
    ball ball[BALLS];
    block block[BLOCKS];
    twig twig[TWIGS];
    int balls, blocks, twigs;
} scene;

typedef struct {
    float distance;
    mcs_vec3 normal;
    int object; /* blocks, then balls; all twigs are one */
} hit;

/* The distance to a surface, or -1. */
static float meet_ball(const ball *b, mcs_vec3 from, mcs_vec3 w) {
    const mcs_vec3 to = along(b->centre, -1, from);
    const float middle = dot(to, w);
    const float under = b->radius * b->radius - dot(to, to) + middle * middle;
    return under > 0 ? middle - sqrtf(under) : -1;
}
static int misses(const ball *b, mcs_vec3 from, mcs_vec3 w) {
    const mcs_vec3 to = along(b->centre, -1, from);
    const float middle = dot(to, w);
    const float outside = dot(to, to) - b->radius * b->radius;
    return outside > 0 && (middle < 0 || outside > middle * middle);
}
static float meet_leaf(const leaf *l, mcs_vec3 from, mcs_vec3 w) {
    const float fall = dot(w, l->normal);
    const float distance = dot(along(l->centre, -1, from), l->normal) / fall;
    if (!(distance > 0)) return -1;
    const mcs_vec3 off = along(along(from, distance, w), -1, l->centre);
    return dot(off, off) < l->radius * l->radius ? distance : -1;
}
/* *axis is that of the side that is met. */
static float meet_block(const block *b, mcs_vec3 from, mcs_vec3 w, int *axis) {
    float enter = -1e30f;
    float leave = 1e30f;
    for (int k = 0; k < 3; k++) {
        const float inverse = 1 / component(w, k);
        const float one = (component(b->low, k) - component(from, k)) * inverse;
        const float other = (component(b->high, k) - component(from, k)) * inverse;
        const float nearer = one < other ? one : other;
        const float farther = one < other ? other : one;
        if (nearer > enter) {
            enter = nearer;
            *axis = k;
        }
        leave = farther < leave ? farther : leave;
    }
    return enter < leave ? enter : -1;
}

/* What is seen first; the distance is 0 where that is nothing. */
static hit look(const scene *s, mcs_vec3 from, mcs_vec3 w) {
    hit h = {0, {0, 0, 0}, 0};
    for (int k = 0; k < s->blocks; k++) {
        int axis = 0;
        const float distance = meet_block(&s->block[k], from, w, &axis);
        if (!(distance > 0) || (h.distance > 0 && distance > h.distance)) continue;
        const float side = component(w, axis) > 0 ? -1.0f : 1.0f;
        h.normal = vector(axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0);
        h.distance = distance;
        h.object = k;
    }
    for (int k = 0; k < s->balls; k++) {
        const float distance = meet_ball(&s->ball[k], from, w);
        if (!(distance > 0) || (h.distance > 0 && distance > h.distance)) continue;
        h.normal = unit(along(along(from, distance, w), -1, s->ball[k].centre));
        h.distance = distance;
        h.object = BLOCKS + k;
    }
    for (int k = 0; k < s->twigs; k++) {
        for (int i = 0; i < LEAVES_OF_TWIG && !misses(&s->twig[k].around, from, w); i++) {
            const leaf *l = &s->twig[k].leaf[i];
            const float distance = meet_leaf(l, from, w);
            if (!(distance > 0) || (h.distance > 0 && distance > h.distance)) continue;
            h.normal = dot(l->normal, w) > 0 ? along(vector(0, 0, 0), -1, l->normal) : l->normal;
            h.distance = distance;
            h.object = BLOCKS + BALLS;
        }
    }
    return h;
}
/* Whether nothing stands in the direction w of a point. */
static int is_free(const scene *s, mcs_vec3 from, mcs_vec3 w) { return !(look(s, from, w).distance > 0); }

/* ---- The four scenes ---- */

static void add_ball(scene *s, float x, float y, float z, float radius) {
    s->ball[s->balls].centre = vector(x, y, z);
    s->ball[s->balls++].radius = radius;
}
static void add_block(scene *s, mcs_vec3 low, mcs_vec3 high) {
    s->block[s->blocks].low = low;
    s->block[s->blocks++].high = high;
}

static void make_spheres(scene *s) {
    s->name = "spheres";
    s->eye = vector(5.5f, -4.5f, 3.2f);
    s->target = vector(0, 0, 0.5f);
    add_block(s, vector(-4, -4, -0.1f), vector(4, 4, 0));
    add_ball(s, 0, 0, 1, 1);
    add_ball(s, 1.9f, -0.7f, 0.6f, 0.6f);
    add_ball(s, -0.6f, -1.9f, 0.7f, 0.7f);
    add_ball(s, 0.9f, 1.8f, 0.8f, 0.8f);
    add_ball(s, 1.4f, -2.2f, 0.4f, 0.4f);
}

static void make_courtyard(scene *s) {
    s->name = "courtyard";
    s->eye = vector(1.7f, -2.2f, 1.7f);
    s->target = vector(-0.9f, 1.4f, 0.9f);
    add_block(s, vector(-2.3f, -2.8f, -0.1f), vector(2.3f, 2.8f, 0));
    add_block(s, vector(-2.3f, -2.8f, 0), vector(-2, 2.8f, 3));
    add_block(s, vector(2, -2.8f, 0), vector(2.3f, 2.8f, 3));
    add_block(s, vector(-2, 2.5f, 0), vector(2, 2.8f, 3));
    add_block(s, vector(-2, -2.8f, 0), vector(2, -2.5f, 3));
    add_block(s, vector(-1.6f, 0.9f, 0), vector(-0.8f, 1.7f, 0.9f));
    add_ball(s, 0.3f, 0.9f, 0.5f, 0.5f);
    add_ball(s, -0.6f, -0.3f, 0.3f, 0.3f);
}

/* The window is in the wall towards +x, whose four parts leave it free. */
static void make_room(scene *s) {
    s->name = "room";
    s->eye = vector(1.9f, -1.7f, 1.5f);
    s->target = vector(-1.2f, 1.1f, 0.9f);
    add_block(s, vector(-2.6f, -2.1f, -0.1f), vector(2.6f, 2.1f, 0));
    add_block(s, vector(-2.6f, -2.1f, 2.7f), vector(2.6f, 2.1f, 2.8f));
    add_block(s, vector(-2.6f, -2.1f, -0.1f), vector(-2.5f, 2.1f, 2.8f));
    add_block(s, vector(-2.6f, 2, -0.1f), vector(2.6f, 2.1f, 2.8f));
    add_block(s, vector(-2.6f, -2.1f, -0.1f), vector(2.6f, -2, 2.8f));
    add_block(s, vector(2.5f, -2.1f, -0.1f), vector(2.6f, 2.1f, 0.9f));
    add_block(s, vector(2.5f, -2.1f, 2.1f), vector(2.6f, 2.1f, 2.8f));
    add_block(s, vector(2.5f, -2.1f, 0.9f), vector(2.6f, -0.6f, 2.1f));
    add_block(s, vector(2.5f, 1, 0.9f), vector(2.6f, 2.1f, 2.1f));
    add_block(s, vector(-1.9f, 0.9f, 0), vector(-0.9f, 1.5f, 0.8f));
    add_ball(s, 0.1f, 1, 0.45f, 0.45f);
    add_ball(s, -0.9f, -0.3f, 0.35f, 0.35f);
}

static mcs_vec3 random_direction(mcs_pcg32 *rng) {
    const float u1 = mcs_pcg32_float(rng);
    const float u2 = mcs_pcg32_float(rng);
    return mcs_sphere_sample(u1, u2).w;
}

/* A crown of 400 leaves over level ground. */
static void make_leaves(scene *s) {
    mcs_pcg32 rng = mcs_pcg32_make(7, 7);
    s->name = "leaves";
    s->eye = vector(4.2f, -3.6f, 2.2f);
    s->target = vector(0, 0, 1.6f);
    add_block(s, vector(-3.5f, -3.5f, -0.1f), vector(3.5f, 3.5f, 0));
    add_block(s, vector(-0.1f, -0.1f, 0), vector(0.1f, 0.1f, 2));
    add_ball(s, 1, -0.9f, 0.5f, 0.5f);
    s->twigs = TWIGS;
    for (int k = 0; k < TWIGS; k++) {
        twig *t = &s->twig[k];
        const float far = 1.3f * cbrtf(mcs_pcg32_float(&rng));
        t->around.centre = along(vector(0, 0, 2.6f), far, random_direction(&rng));
        t->around.radius = 0.5f;
        for (int i = 0; i < LEAVES_OF_TWIG; i++) {
            leaf *l = &t->leaf[i];
            l->radius = 0.1f + 0.08f * mcs_pcg32_float(&rng);
            l->centre = along(t->around.centre, 0.3f, random_direction(&rng));
            l->normal = random_direction(&rng);
        }
    }
}

enum { SCENES = 4 };
static void (*const scene_makers[SCENES])(scene *) = {make_spheres, make_courtyard, make_room, make_leaves};

/* ---- Points and regions ---- */

typedef struct {
    mcs_vec3 place;
    mcs_frame frame;
    mcs_vec3 wo;
    uint32_t key; /* object, main axis, cell: points of a region have the same one */
} point;

/* Points first to first + count - 1. */
typedef struct {
    uint32_t first, count, object;
} region;

enum { PICTURE = 40000, REGIONS = 32, REGION_LEAST = 48, CELLS = 27, AXES = 6 };

typedef struct {
    scene scene;
    point *point;
    uint32_t points;
    region region[REGIONS];
    int regions;
} view;

/* The axis of the largest component of a normal, and its sign: 0 to 5. */
static uint32_t main_axis(mcs_vec3 n) {
    uint32_t axis = 0;
    for (uint32_t k = 1; k < 3; k++)
        if (fabsf(component(n, (int)k)) > fabsf(component(n, (int)axis))) axis = k;
    return 2 * axis + (component(n, (int)axis) < 0);
}

static block bounds_of(const scene *s, int object) {
    if (object < BLOCKS) return s->block[object];
    const ball crown = {{0, 0, 2.6f}, 1.8f};
    const ball b = object < BLOCKS + BALLS ? s->ball[object - BLOCKS] : crown;
    const mcs_vec3 half = vector(b.radius, b.radius, b.radius);
    block bounds;
    bounds.low = along(b.centre, -1, half);
    bounds.high = along(b.centre, 1, half);
    return bounds;
}

static uint32_t key_of(const scene *s, int object, mcs_vec3 place, mcs_vec3 normal) {
    const block bounds = bounds_of(s, object);
    float size = 0;
    for (int k = 0; k < 3; k++) size = fmaxf(size, component(bounds.high, k) - component(bounds.low, k));
    uint32_t cell = 0;
    for (int k = 0; k < 3; k++) {
        const float at = (component(place, k) - component(bounds.low, k)) / (0.375f * size);
        cell = 3 * cell + (uint32_t)fminf(fmaxf(at, 0), 2);
    }
    return ((uint32_t)object * AXES + main_axis(normal)) * CELLS + cell;
}

static int by_key(const void *a, const void *b) {
    const point *x = a;
    const point *y = b;
    return (x->key > y->key) - (x->key < y->key);
}

/* A random point of the picture; 0 where nothing is seen. */
static int see(const scene *s, mcs_pcg32 *rng, point *p) {
    const float wide = 0.6f; /* of half the picture at distance 1 */
    const mcs_vec3 ahead = unit(along(s->target, -1, s->eye));
    const mcs_vec3 right = unit(vector(ahead.y, -ahead.x, 0));
    const mcs_vec3 up = vector(right.y * ahead.z, -right.x * ahead.z, right.x * ahead.y - right.y * ahead.x);
    const float x = wide * (2 * mcs_pcg32_float(rng) - 1);
    const float y = wide * (2 * mcs_pcg32_float(rng) - 1);
    const mcs_vec3 w = unit(along(along(ahead, x, right), y, up));
    const hit h = look(s, s->eye, w);
    if (!(h.distance > 0)) return 0;
    const mcs_vec3 place = along(s->eye, h.distance, w);
    p->place = along(place, 1e-3f, h.normal);
    p->frame = mcs_frame_make(h.normal);
    p->wo = mcs_to_local(&p->frame, along(vector(0, 0, 0), -1, w));
    p->key = key_of(s, h.object, place, h.normal);
    return p->wo.z > 0.01f;
}

/* Looks at a scene and picks up to REGIONS regions, in proportion to the area that they have in the picture. */
static int view_make(view *v, int number) {
    memset(v, 0, sizeof *v);
    scene_makers[number](&v->scene);
    v->point = malloc(PICTURE * sizeof *v->point);
    if (!v->point) return 0;
    mcs_pcg32 rng = mcs_pcg32_make(1, 1);
    for (int i = 0; i < PICTURE; i++) v->points += (uint32_t)see(&v->scene, &rng, &v->point[v->points]);
    qsort(v->point, v->points, sizeof *v->point, by_key);
    uint32_t end = 0;
    for (uint32_t k = 0; k < REGIONS; k++) {
        const uint32_t middle = (2 * k + 1) * v->points / (2 * REGIONS);
        if (middle < end) continue;
        const uint32_t key = v->point[middle].key;
        uint32_t first = middle;
        while (first > 0 && v->point[first - 1].key == key) first--;
        for (end = middle; end < v->points && v->point[end].key == key; end++) {}
        const region r = {first, end - first, key / (AXES * CELLS)};
        if (r.count >= REGION_LEAST) v->region[v->regions++] = r;
    }
    return v->regions > 0;
}
#endif
