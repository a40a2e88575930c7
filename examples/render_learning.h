/* render_learning.h - what render.c learns of its light: the scene cut into regions, each with an mcs_region and the
 * product that is built of it.
 *
 * A region is a piece of one object that faces one way: object, cell of a grid, main axis of the normal. Passes over
 * the picture send shadow rays, which wait until the pass is over; during a pass nothing changes that samples are drawn
 * from. So no sample is drawn from a table that knows of its ray, and the estimate stays unbiased. And as rays are
 * counted, in whole numbers, the picture does not depend on the order in which threads deliver them.
 */
#ifndef RENDER_LEARNING_H
#define RENDER_LEARNING_H
#include "render_light.h"
#include "render_options.h"
#include "render_scene.h"

enum {
    CELLS = 16,    /* of an object along each axis, at most */
    AXES = 6,      /* x, y, z, each in both directions */
    POINTS = 12,   /* whose reflections are added to a region */
    PROBES = 65536 /* points of the picture among which these are found, at most */
};

typedef struct {
    int object;
    mcs_region *known;  /* the points, and rays of passes that are over */
    mcs_region *fresh;  /* rays that wait */
    mcs_product *table; /* built of `known`; NULL where nobody draws from it */
    float tabulated;    /* rays when the table was built */
} region;

/* Regions 0 to OBJECTS - 1 are whole objects. They stand in where no probe fell. */
typedef struct {
    const environment *light;
    uint32_t count;
    region list[4096];
    uint16_t number[OBJECTS][AXES][CELLS][CELLS][CELLS]; /* of the region there; 0: none */
} learning;

/* Shadow rays on their way to the regions. */
typedef struct {
    uint16_t region, tile, through;
} shadow_ray;
typedef struct {
    uint32_t count;
    shadow_ray ray[1024];
} shadow_rays;

/* ---- which region a point belongs to ---- */

/* 2 k where the largest component of n is component k, 2 k + 1 where it is negative. */
static unsigned main_axis(vec3 n) {
    const float x = fabsf(n.x);
    const float y = fabsf(n.y);
    const float z = fabsf(n.z);
    if (x >= y && x >= z) return n.x < 0;
    if (y >= z) return 2u + (n.y < 0);
    return 4u + (n.z < 0);
}

static unsigned cell_of(float x) { return (unsigned)fminf(fmaxf(x, 0), CELLS - 1); }

/* Where the number of the region of a point is kept. */
static uint16_t *region_place(learning *l, const scene *s, const surface *x) {
    const int of_sphere = x->object < SPHERES;
    const float edge = of_sphere ? 0.75f : 1.5f; /* three eighths of a sphere; objects that are larger have 16 cells */
    const float low = of_sphere ? -1 : -0.5f * CELLS * edge;
    const vec3 p = in_scene_axes(s, of_sphere ? sub(x->p, s->center[x->object]) : x->p);
    const unsigned a = cell_of((p.x - low) / edge);
    const unsigned b = cell_of((p.y - low) / edge);
    const unsigned c = cell_of((p.z - low) / edge);
    return &l->number[x->object][main_axis(in_scene_axes(s, x->frame.n))][a][b][c];
}

static uint16_t region_of(learning *l, const scene *s, const surface *x) {
    const uint16_t number = *region_place(l, s, x);
    return number ? number : (uint16_t)x->object;
}

/* ---- making regions ---- */

static void learning_free(learning *l) {
    for (uint32_t i = 0; l && i < l->count; i++) {
        free(l->list[i].known);
        free(l->list[i].fresh);
        free(l->list[i].table);
    }
    free(l);
}

static int region_make(learning *l, int object, int with_table) {
    const size_t bytes = mcs_region_bytes(TILES);
    region *g = &l->list[l->count++];
    g->object = object;
    g->known = malloc(bytes);
    g->fresh = malloc(bytes);
    if (with_table) g->table = malloc(mcs_product_table_bytes(TILES));
    if (!g->known || !g->fresh || (with_table && !g->table)) return complain("regions", "not enough memory");
    mcs_region_start(g->known, bytes, l->light->tiles);
    mcs_region_start(g->fresh, bytes, l->light->tiles);
    return 1;
}

/* A whole object stands in for what a region has not seen yet. */
static void region_tabulate(const learning *l, region *g) {
    const mcs_region *whole = l->list[g->object].known;
    if (g->known != whole) mcs_region_inherit(g->known, whole);
    g->tabulated = g->known->rays;
    if (!g->table) return;
    mcs_product_build_region(g->table, mcs_product_table_bytes(TILES), l->light->tiles, l->light->table, g->known);
}

/* Looks at points all over the picture: each makes the region that it lies in, and is added to it if that has too few.
 */
static int learning_probe(learning *l, const scene *s, uint32_t probes) {
    for (uint32_t i = 0; i < probes; i++) {
        surface x;
        if (!intersect(s, s->eye, camera_ray(s, mcs_sobol(i, 0, 0), mcs_sobol(i, 1, 0)), &x)) continue;
        uint16_t *number = region_place(l, s, &x);
        if (!*number && l->count < sizeof l->list / sizeof *l->list) {
            *number = (uint16_t)l->count;
            if (!region_make(l, x.object, l->list[0].table != NULL)) return 0;
        }
        region *g = &l->list[*number ? *number : x.object];
        if (g->known->points >= POINTS) continue;
        const mcs_reflection r = reflection_of(&x);
        mcs_region_add_point(g->known, l->light->tiles, l->light->table, &r);
        mcs_region_add_point(l->list[x.object].known, l->light->tiles, l->light->table, &r);
    }
    return 1;
}

/* Returns NULL after a complaint. */
static learning *learning_make(const scene *s, const environment *e, size_t pixels, int with_tables) {
    learning *l = calloc(1, sizeof *l);
    if (!l) {
        complain("regions", "not enough memory");
        return NULL;
    }
    l->light = e;
    int ok = 1;
    for (int i = 0; ok && i < OBJECTS; i++) ok = region_make(l, i, with_tables);
    ok = ok && learning_probe(l, s, pixels < PROBES ? (uint32_t)pixels : PROBES);
    for (uint32_t i = 0; ok && i < l->count; i++) region_tabulate(l, &l->list[i]);
    if (ok) return l;
    learning_free(l);
    return NULL;
}

/* ---- learning ---- */

static void shadow_rays_deliver(learning *l, shadow_rays *r) {
    OMP(omp critical(deliver)) {
        for (uint32_t i = 0; i < r->count; i++) {
            mcs_region_add_ray(l->list[r->ray[i].region].fresh, r->ray[i].tile, r->ray[i].through);
        }
    }
    r->count = 0;
}

static void shadow_rays_add(learning *l, shadow_rays *r, uint16_t number, uint32_t tile, int through) {
    if (r->count == sizeof r->ray / sizeof *r->ray) shadow_rays_deliver(l, r);
    shadow_ray *ray = &r->ray[r->count++];
    ray->region = number;
    ray->tile = (uint16_t)tile;
    ray->through = (uint16_t)through;
}

/* Between passes, by one thread: rays that wait become known, and tables that know half of them or less are built anew.
 */
static void learning_advance(learning *l) {
    for (uint32_t i = 0; i < l->count; i++) {
        const region *g = &l->list[i];
        if (!(g->fresh->rays > 0)) continue;
        mcs_region_merge(g->known, g->fresh);
        if (i >= OBJECTS) mcs_region_merge(l->list[g->object].known, g->fresh);
        mcs_region_decay(g->fresh, 0);
    }
    for (uint32_t i = 0; i < l->count; i++) {
        const float rays = l->list[i].known->rays;
        if (rays > 0 && rays >= 2 * l->list[i].tabulated) region_tabulate(l, &l->list[i]);
    }
}

#endif
