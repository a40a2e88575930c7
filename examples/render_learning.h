/* render_learning.h - what render.c learns of its light: the scene cut into regions, each with an mcs_region and the
 * product that is built of it.
 *
 * A region is a piece of one object that faces one way: object, cell of a grid, main axis of the normal. Passes over
 * the picture send shadow rays, which wait until the pass is over; during a pass nothing changes that samples are drawn
 * from. So no sample is drawn from a table that knows of its ray, and the estimate stays unbiased. And as rays are
 * counted, in whole numbers, the picture does not depend on the order in which threads deliver them. A region that has
 * sent ENOUGH rays learns no more, and its samples cost less.
 */
#ifndef RENDER_LEARNING_H
#define RENDER_LEARNING_H
#include "render_light.h"
#include "render_options.h"
#include "render_scene.h"

enum {
    CELLS = 20,     /* of an object along either axis, at most */
    AXES = 6,       /* x, y, z, each in both directions */
    POINTS = 12,    /* whose reflections are added to a region */
    PROBES = 65536, /* points of the picture among which these are found, at most */
    ENOUGH = 1024   /* rays after which a region learns no more */
};

typedef struct {
    int object;
    int learns;          /* 0: its rays are no longer asked for */
    float share;         /* BRDF samples for each of the table */
    mcs_reflection kind; /* of its material: what one point reflects */
    mcs_region *known;   /* the points, and rays of passes that are over */
    mcs_region *fresh;   /* rays that wait */
    mcs_product *table;  /* built of `known`; NULL where nobody draws from it */
    float tabulated;     /* rays when the table was built */
} region;

/* Regions 0 to OBJECTS - 1 are whole objects. They stand in where no probe fell. */
typedef struct {
    const environment *light;
    uint32_t count;
    region list[4096];
    uint16_t number[OBJECTS][AXES][CELLS][CELLS]; /* of the region there; 0: none */
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

/* 2 k where the largest component of the normal is component k, 2 k + 1 where it is negative. */
static unsigned main_axis(vec3 normal) {
    const float x = fabsf(normal.x);
    const float y = fabsf(normal.y);
    const float z = fabsf(normal.z);
    if (x >= y && x >= z) return normal.x < 0;
    if (y >= z) return 2u + (normal.y < 0);
    return 4u + (normal.z < 0);
}

static unsigned cell_of(float place) {
    if (!(place > 0)) return 0;
    return place < CELLS - 1 ? (unsigned)place : CELLS - 1;
}

/* Cells are a sixth wide on spheres, where a lobe looks another way in each, a ninth if the lobe is narrow, and 1.5 on
 * objects that are larger. */
static float cells_per_length(const surface *hit) {
    if (hit->object >= SPHERES) return 1 / 1.5f;
    const material *m = hit->m;
    return m->p_lobe == 1 && m->alpha_x * m->alpha_y < 0.01f ? 9 : 6;
}

/* Where the number of the region of a point is kept. Cells are squares as seen along the main axis of the normal. The
 * center of a unit sphere lies its normal away. */
static uint16_t *region_place(learning *regions, const scene *s, const surface *hit) {
    const float per_length = cells_per_length(hit);
    const vec3 n = in_scene_axes(s, hit->frame.n);
    const vec3 p = hit->object < SPHERES ? n : in_scene_axes(s, hit->p);
    const unsigned axis = main_axis(n);
    const unsigned i = cell_of((axis < 2 ? p.y : p.x) * per_length + CELLS / 2);
    const unsigned j = cell_of((axis < 4 ? p.z : p.y) * per_length + CELLS / 2);
    return &regions->number[hit->object][axis][i][j];
}

static const region *region_of(learning *regions, const scene *s, const surface *hit) {
    const uint16_t number = *region_place(regions, s, hit);
    return &regions->list[number ? number : hit->object];
}

/* ---- making regions ---- */

static void learning_free(learning *regions) {
    for (uint32_t i = 0; regions && i < regions->count; i++) {
        free(regions->list[i].known);
        free(regions->list[i].fresh);
        free(regions->list[i].table);
    }
    free(regions);
}

static int region_make(learning *regions, int object, int with_table) {
    const size_t bytes = mcs_region_bytes(TILES);
    region *g = &regions->list[regions->count++];
    g->object = object;
    g->learns = 1;
    g->known = malloc(bytes);
    g->fresh = malloc(bytes);
    if (with_table) g->table = malloc(mcs_product_table_bytes(TILES));
    if ((with_table && !g->table) || mcs_region_start(g->known, bytes, regions->light->tiles) != MCS_OK ||
        mcs_region_start(g->fresh, bytes, regions->light->tiles) != MCS_OK)
        return complain("regions", "not enough memory");
    return 1;
}

/* A whole object stands in for what a region has not seen yet. */
static void region_tabulate(const learning *regions, region *g) {
    const mcs_region *whole = regions->list[g->object].known;
    if (g->known != whole) mcs_region_inherit(g->known, whole);
    g->tabulated = g->known->rays;
    g->learns = g->tabulated < ENOUGH;
    if (!g->table) return;
    const mcs_status status = mcs_product_build_region(g->table, mcs_product_table_bytes(TILES), regions->light->tiles,
                                                       regions->light->table, g->known);
    g->share = status == MCS_OK ? mcs_region_share(g->table, &g->kind) : 0;
    if (!(g->share > 0)) g->share = 1; /* where MIS may do better */
}

/* Looks at points all over the picture: each makes the region that it lies in, and is added to it if that has too few.
 */
static int learning_probe(learning *regions, const scene *s, uint32_t probes) {
    for (uint32_t i = 0; i < probes; i++) {
        surface hit;
        const vec3 w = camera_ray(s, mcs_sobol(i, 0, 0), mcs_sobol(i, 1, 0));
        if (!intersect(s, s->eye, w, NO_OBJECT, &hit)) continue;
        uint16_t *number = region_place(regions, s, &hit);
        if (!*number && regions->count < sizeof regions->list / sizeof *regions->list) {
            *number = (uint16_t)regions->count;
            if (!region_make(regions, hit.object, regions->list[0].table != NULL)) return 0;
        }
        region *g = &regions->list[*number ? *number : hit.object];
        if (g->known->points >= POINTS) continue;
        const mcs_reflection r = reflection_of(&hit);
        g->kind = regions->list[hit.object].kind = r;
        mcs_region_add_point(g->known, regions->light->tiles, regions->light->table, &r);
        mcs_region_add_point(regions->list[hit.object].known, regions->light->tiles, regions->light->table, &r);
    }
    return 1;
}

/* Returns NULL after a complaint. */
static learning *learning_make(const scene *s, const environment *e, size_t pixels, int with_tables) {
    learning *regions = calloc(1, sizeof *regions);
    if (!regions) {
        complain("regions", "not enough memory");
        return NULL;
    }
    regions->light = e;
    int ok = 1;
    for (int i = 0; ok && i < OBJECTS; i++) ok = region_make(regions, i, with_tables);
    ok = ok && learning_probe(regions, s, pixels < PROBES ? (uint32_t)pixels : PROBES);
    for (uint32_t i = 0; ok && i < regions->count; i++) region_tabulate(regions, &regions->list[i]);
    if (ok) return regions;
    learning_free(regions);
    return NULL;
}

/* ---- learning ---- */

static void shadow_rays_deliver(learning *regions, shadow_rays *rays) {
    OMP(omp critical(deliver)) {
        for (uint32_t i = 0; i < rays->count; i++) {
            mcs_region_add_ray(regions->list[rays->ray[i].region].fresh, rays->ray[i].tile, rays->ray[i].through);
        }
    }
    rays->count = 0;
}

static void shadow_rays_add(learning *regions, shadow_rays *rays, const region *g, uint32_t tile, int through) {
    if (rays->count == sizeof rays->ray / sizeof *rays->ray) shadow_rays_deliver(regions, rays);
    shadow_ray *ray = &rays->ray[rays->count++];
    ray->region = (uint16_t)(g - regions->list);
    ray->tile = (uint16_t)tile;
    ray->through = (uint16_t)through;
}

/* Between passes, by one thread: rays that wait become known, and tables that know half of them or less are built anew.
 */
static void learning_advance(learning *regions) {
    for (uint32_t i = 0; i < regions->count; i++) {
        const region *g = &regions->list[i];
        if (!(g->fresh->rays > 0)) continue;
        mcs_region_merge(g->known, g->fresh);
        if (i >= OBJECTS) mcs_region_merge(regions->list[g->object].known, g->fresh);
        mcs_region_decay(g->fresh, 0);
    }
    for (uint32_t i = 0; i < regions->count; i++) {
        const float rays = regions->list[i].known->rays;
        if (rays > 0 && rays >= 2 * regions->list[i].tabulated) region_tabulate(regions, &regions->list[i]);
    }
}

#endif
