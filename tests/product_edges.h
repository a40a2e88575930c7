/* Products of environment, reflection and cosine at their edges: no light is left out, whatever is asked of them, in
 * any memory, by array, in a turned map; where tiles lie. A part of test_product.c. */
#ifndef MCST_PRODUCT_EDGES_H
#define MCST_PRODUCT_EDGES_H
#include "product_sampler.h"

/* ---- support ---- */

/* One after another: the first `most` of GGX, or those that are not GGX. */
static lobe lobe_of(int shaped, int i, int most) {
    return lobes[shaped ? FIRST_GAUSS + i % (LOBES - FIRST_GAUSS) : i % most];
}

typedef struct {
    picture kind;
    uint32_t w, h;
    int normals, sub;
} supported_map;
/* The axes, then random ones; every other one nearly a pole or nearly on the equator. */
static mcs_vec3 normal_of_support(int i) {
    const double sign = 1 - i % 2 * 2;
    const mcs_vec3 n = i < 6 ? vec(i / 2 == 0 ? sign : 0, i / 2 == 1 ? sign : 0, i / 2 == 2 ? sign : 0)
                             : mcs_sphere_sample(hash01((uint32_t)i, 7), hash01((uint32_t)i, 8)).w;
    if (i % 4 == 3) return vec(n.x, n.y, n.z * 1e-3);
    if (i % 4 == 1) return vec(n.x * 1e-3, n.y * 1e-3, n.z + 1e-9);
    return n;
}
static void check_supported(const sampler *d, int sub) {
    uint32_t k = 0;
    const int bad = d->share > 0 ? 0 : unsupported(d, sub, &k);
    CHECK(bad == 0, "normal %a %a %a: %d texels cannot be drawn, one of them (%u, %u) that rises to %g", d->s->n[0],
          d->s->n[1], d->s->n[2], bad, k % d->m->w, k / d->m->w, highest(d->m, d->s->n, k % d->m->w, k / d->m->w, sub));
}
static void check_map_is_supported(const supported_map *map, uint32_t rows, int shaped) {
    scene m = scene_make(map->kind, map->w, map->h, rows);
    for (int i = 0; i < map->normals; i++) {
        const surface s =
            surface_make(normal_of_support(i), local_wo(0.05 + 0.019 * i, 0.07 * i), lobe_of(shaped, i, 6));
        sampler d = sampler_make(&m, &s);
        check_supported(&d, map->sub);
        sampler_free(&d);
    }
    scene_free(&m);
}

/* A texel of a map of 2 rows x rows, alone in its tile. */
typedef struct {
    uint32_t w, h, col, row;
} lone_texel;
/* The normal: at right angles to the texel's corner, away from the middle, then towards the corner by 2^-i. */
static surface barely_lit(const lone_texel *at, int shaped, int i) {
    double corner[3];
    to3(corner, point(at->w, at->h, at->col, at->row, 0, 1));
    double middle[3];
    to3(middle, point(at->w, at->h, at->col, at->row, 0.5, 0.5));
    double n[3];
    for (int k = 0; k < 3; k++) n[k] = dot3(corner, middle) * corner[k] - middle[k];
    const double z = sqrt(dot3(n, n));
    for (int k = 0; k < 3; k++) n[k] = n[k] / z + ldexp(corner[k], -i);
    return surface_make(vec(n[0], n[1], n[2]), local_wo(0.5, 0.1), lobe_of(shaped, i, 5));
}
/* A sun far below the horizon; and, with `two`, another light in the row where that lies deepest. */
static void add_lights_below(float *light, const lone_texel *at, const surface *s, int two) {
    uint32_t deep[2] = {0, 0};
    double low[2] = {1, 1};
    for (uint32_t k = 0; k < at->w * at->h; k++) {
        const int in_row = k / at->w == at->row;
        double v[3];
        to3(v, point(at->w, at->h, k % at->w, k / at->w, 0.5, 0.5));
        if (!(dot3(s->n, v) < low[in_row])) continue;
        low[in_row] = dot3(s->n, v);
        deep[in_row] = k;
    }
    CHECK(low[0] < -0.8 && low[1] < -0.8, "the other lights at %g, %g", low[0], low[1]);
    light[deep[0]] = 1e18f;
    if (two) light[deep[1]] = 1e9f;
}
/* z: how far the texel rises over the horizon, by 2^-i of the corner. */
static void check_barely_lit(const sampler *d, const lone_texel *at, double z, int i) {
    check_supported(d, 4);
    for (int j = 0; j < 64; j++) {
        const mcs_texel t = draw(d, hash01((uint32_t)j, 9), hash01((uint32_t)j, 10));
        CHECK(t.pdf >= 0 && t.pdf <= FLT_MAX && agrees(d, t), "2^-%d over the horizon: pdf %g, again %g", i,
              (double)t.pdf, density(d, t.w));
        if (z > 4 * eps && !(d->share > 0))
            CHECK(t.pdf > 0 && t.row == at->row && t.col == at->col, "2^-%d over the horizon: texel (%u, %u), pdf %g",
                  i, t.col, t.row, (double)t.pdf);
    }
}
static void check_barely_visible(uint32_t rows, int others, int shaped) {
    const lone_texel at = {2 * rows, rows, rows * 5 / 8, rows * 5 / 16};
    for (int i = 2; i <= 24; i++) {
        const surface s = barely_lit(&at, shaped, i);
        float *light = (float *)memory(at.w * at.h * sizeof *light);
        memset(light, 0, at.w * at.h * sizeof *light);
        light[at.row * at.w + at.col] = 1;
        if (others) add_lights_below(light, &at, &s, others == 2);
        scene m = scene_from("texel", at.w, at.h, light, rows);
        sampler d = sampler_make(&m, &s);
        check_barely_lit(&d, &at, highest(&m, s.n, at.col, at.row, 4), i);
        sampler_free(&d);
        scene_free(&m);
    }
}

static void test_support(void) {
    static const supported_map maps[] = {
        {CONSTANT, 1, 1, 50, 32}, {NOISE, 7, 5, 50, 16},      {NOISE, 33, 17, 50, 4},    {SPARSE, 50, 25, 50, 4},
        {SUN, 64, 32, 30, 3},     {POLES, 64, 32, 50, 3},     {SPARSE, 100, 1000, 2, 2}, {POLES, 2, 40, 50, 8},
        {NOISE, 3, 2, 50, 16},    {ONE_TEXEL, 41, 21, 50, 4},
    };
    static const char *const beside[] = {"", " beside a sun", " beside a sun, in a row with another"};
    mcst_group("product, support");
    for (int shaped = 0; shaped < 2; shaped++)
        for (uint32_t rows = 16; rows <= 64; rows *= 2) {
            const char *of = shaped ? ", Gauss and Phong" : "";
            for (int a = 0; a < (int)(sizeof maps / sizeof *maps); a++)
                if (mcst_case("%u x %u, %s, %u rows of tiles%s", maps[a].w, maps[a].h, picture_name[maps[a].kind], rows,
                              of))
                    check_map_is_supported(&maps[a], rows, shaped);
            /* A texel of which just one corner rises over the horizon. */
            for (int a = 0; a < 3; a++)
                if (mcst_case("barely visible%s, %u rows of tiles%s", beside[a], rows, of))
                    check_barely_visible(rows, a, shaped);
        }
}

/* ---- extremes ---- */

/* A black map is drawn from like an even one, as the environment's. */
static void check_black(const sampler *d, const scene *even) {
    sampler e = sampler_make(even, d->s);
    for (uint32_t j = 0; j < 20; j++) {
        const mcs_texel a = draw(d, hash01(j, 13), hash01(j, 19));
        const mcs_texel b = draw(&e, hash01(j, 13), hash01(j, 19));
        CHECK(density(d, a.w) == density(&e, a.w) && !memcmp(&a, &b, sizeof a), "density %g, of an even map %g",
              density(d, a.w), density(&e, a.w));
    }
    CHECK(arena_differ(&d->mem, &e.mem) == d->mem.bytes, "another product than an even map's");
    sampler_free(&e);
}

typedef struct {
    picture kind;
    uint32_t w, h;
    mcs_profile profile;
} extreme_map;
static void check_extreme_surfaces(const extreme_map *map, uint32_t rows) {
    static const float alphas[] = {1e-6f, 1e-4f, 1e-3f, 0.0f, 1e4f, 1e10f, INFINITY, NAN, -1.0f, 0.3f};
    static const float mattes[] = {0.0f, 1.0f, 0.5f, NAN, -1.0f, 2.0f};
    scene m = scene_make(map->kind, map->w, map->h, rows);
    scene even = scene_make(CONSTANT, map->w, map->h, rows);
    for (int i = 0; i < 10 * 6; i++) {
        surface s = surface_make(normals[i % NORMALS], local_wo(i % 5 ? 0.2 * (i % 5) : 1e-6, 0.1 * i), lobes[0]);
        s.r.alpha_x = alphas[i % 10];
        s.r.alpha_y = alphas[i % 3 ? i % 10 : 9 - i % 10];
        s.r.matte = mattes[i / 10];
        s.r.profile = map->profile;
        sampler d = sampler_make(&m, &s);
        check_sane(&d, 1);
        if (map->kind == BLACK_MAP) check_black(&d, &even);
        sampler_free(&d);
    }
    scene_free(&m);
    scene_free(&even);
}

/* An eye below the surface, or a light: at `to`. */
static void check_dark(const scene *m, const surface *s, mcs_vec3 to) {
    sampler d = sampler_make(m, s);
    CHECK(d.dark, "the product is not dark");
    check_sane(&d, 1);
    for (int j = 0; j < HARD; j++)
        CHECK(!(draw(&d, hard_u[j], 0.3f).pdf > 0) && density(&d, to) == 0, "eye (%g, %g, %g): density",
              (double)s->r.wo.x, (double)s->r.wo.y, (double)s->r.wo.z);
    sampler_free(&d);
}
static void check_below(void) {
    static const mcs_vec3 wo[] = {{0, 0, -1},  {1, 0, 0},        {0.6f, 0, -0.8f}, {0, 0, 0},
                                  {NAN, 0, 1}, {0, 0, INFINITY}, {0, 0, 5}};
    const mcs_vec3 to = point(64, 32, 21, 10, 0.5, 0.5);
    scene m = scene_make(ONE_TEXEL, 64, 32, 16);
    for (int i = 0; i < 4; i++) {
        const surface s = surface_make(vec(-(double)to.x, -(double)to.y, -(double)to.z), local_wo(0.5, 0), lobes[i]);
        check_dark(&m, &s, to);
    }
    for (int i = 0; i < (int)(sizeof wo / sizeof *wo); i++) {
        surface s = surface_make(to, local_wo(0.5, 0), lobes[2]);
        s.r.wo = wo[i];
        check_dark(&m, &s, to);
    }
    scene_free(&m);
}

static void check_bad_frames(void) {
    static const float wrong[] = {NAN, INFINITY, 0.0f, 1e30f, -INFINITY};
    scene m = scene_make(SUN, 64, 32, 16);
    for (int i = 0; i < 60; i++) {
        surface s = surface_make(normals[i % NORMALS], local_wo(0.6, 0.2), lobes[i % 2 ? 3 : i % 4 ? 0 : 8]);
        mcs_vec3 *at = i % 3 == 0 ? &s.r.frame.s : i % 3 == 1 ? &s.r.frame.t : &s.r.frame.n;
        if (i % 4 < 2) at->x = wrong[i % 5];
        if (i % 4 != 1) at->y = wrong[i % 5];
        if (i % 4 > 1) at->z = wrong[i % 5];
        sampler d = sampler_make(&m, &s);
        check_sane(&d, 0);
        sampler_free(&d);
    }
    scene_free(&m);
}

static void test_extremes(void) {
    static const extreme_map maps[] = {{SUN, 64, 32, MCS_PROFILE_GGX},      {ONE_TEXEL, 41, 21, MCS_PROFILE_GGX},
                                       {CONSTANT, 30, 20, MCS_PROFILE_GGX}, {BLACK_MAP, 30, 20, MCS_PROFILE_GGX},
                                       {CONSTANT, 1, 1, MCS_PROFILE_GGX},   {POLES, 64, 32, MCS_PROFILE_GGX},
                                       {SPARSE, 100, 200, MCS_PROFILE_GGX}, {SUN, 64, 32, MCS_PROFILE_GAUSS},
                                       {SUN, 64, 32, MCS_PROFILE_PHONG},    {SUN, 64, 32, MCS_PROFILE_ASHIKHMIN}};
    static const char *const profile_name[] = {"", ", Gauss", ", Phong", ", A.-S."};
    mcst_group("product, extremes");
    for (int a = 0; a < (int)(sizeof maps / sizeof *maps); a++)
        if (mcst_case("%u x %u, %s%s", maps[a].w, maps[a].h, picture_name[maps[a].kind], profile_name[maps[a].profile]))
            check_extreme_surfaces(&maps[a], a % 2 ? 32 : 16);
    if (mcst_case("eye or light below the surface")) check_below();
    if (mcst_case("bad frames")) check_bad_frames();
}

/* ---- memory ---- */

static void check_refused_products(const sampler *d) {
    const size_t bytes = d->mem.bytes;
    const mcs_tiles *t = tiles_of(d->m);
    const mcs_env *e = env_of(d->m);
    const mcs_reflection *r = &d->s->r;
    CHECK(d->m->tiles.bytes % 4 == 0 && bytes % 4 == 0, "%zu and %zu bytes", d->m->tiles.bytes, bytes);
    CHECK(mcs_product_build(d->p, bytes - 1, t, e, r, NULL) == MCS_ERR_MEMORY, "one byte too few");
    CHECK(mcs_product_build(NULL, bytes, t, e, r, NULL) == MCS_ERR_ARG, "no memory");
    CHECK(mcs_product_build(d->p, bytes, NULL, e, r, NULL) == MCS_ERR_ARG, "no tiles");
    CHECK(mcs_product_build(d->p, bytes, t, NULL, r, NULL) == MCS_ERR_ARG, "no map");
    CHECK(mcs_product_build(d->p, bytes, t, e, NULL, NULL) == MCS_ERR_ARG, "no reflection");
    CHECK(mcs_product_build((mcs_product *)(void *)(d->mem.at + 2), bytes, t, e, r, NULL) == MCS_ERR_ARG, "misaligned");
    CHECK(mcs_product_build_weights(d->p, bytes, t, e, NULL) == MCS_ERR_ARG, "no weights");
    CHECK(arena_intact(&d->mem), "refused arguments, yet wrote outside");
    CHECK(mcs_product_build(d->p, bytes, t, e, r, NULL) == MCS_OK, "the same again");
}
static void check_refused_tiles(const scene *m) {
    static const uint32_t wrong[] = {0, 1, 8, 15, 17, 24, 48, 65, 128, 0x80000000u, 0xffffffffu};
    arena a = arena_make(m->tiles.bytes);
    mcs_tiles *t = (mcs_tiles *)(void *)a.at;
    CHECK(mcs_tiles_build(NULL, a.bytes, env_of(m), m->rows) == MCS_ERR_ARG, "no memory");
    CHECK(mcs_tiles_build(t, a.bytes, NULL, m->rows) == MCS_ERR_ARG, "no map");
    CHECK(mcs_tiles_build((mcs_tiles *)(void *)(a.at + 2), a.bytes, env_of(m), m->rows) == MCS_ERR_ARG, "misaligned");
    CHECK(mcs_tiles_build(t, a.bytes - 1, env_of(m), m->rows) == MCS_ERR_MEMORY, "one byte too few");
    for (int i = 0; i < (int)(sizeof wrong / sizeof *wrong); i++)
        CHECK(mcs_tiles_bytes(env_of(m), wrong[i]) == 0 && mcs_product_bytes(wrong[i]) == 0 &&
                  mcs_tiles_build(t, a.bytes, env_of(m), wrong[i]) == MCS_ERR_SIZE,
              "%u rows", wrong[i]);
    CHECK(mcs_tiles_bytes(NULL, 16) == 0, "no map");
    CHECK(untouched(a.at, a.bytes), "refused arguments, yet wrote");
    arena_free(&a);
}
static arena arena_copy(const arena *from) {
    arena a = arena_make(from->bytes);
    memcpy(a.at, from->at, a.bytes);
    return a;
}
/* Product, tiles and map hold no pointers: copies of them are as good, for draws and for another product. */
static void check_copies(const sampler *d) {
    scene other = *d->m;
    other.env = arena_copy(&d->m->env);
    other.tiles = arena_copy(&d->m->tiles);
    arena product = arena_copy(&d->mem);
    sampler copy = *d;
    copy.m = &other;
    copy.p = (mcs_product *)(void *)product.at;
    for (uint32_t i = 0; i < 200; i++) {
        const float u1 = hash01(i, 16);
        const float u2 = hash01(i, 17);
        const mcs_texel a = draw(d, u1, u2);
        const mcs_texel b = draw(&copy, u1, u2);
        CHECK(!memcmp(&a, &b, sizeof a), "u = %a, %a: the copy draws another", (double)u1, (double)u2);
    }
    sampler again = sampler_make(&other, d->s);
    CHECK(arena_differ(&again.mem, &d->mem) == d->mem.bytes, "copies of map and tiles give another table");
    sampler_free(&again);
    arena_free(&product);
    arena_free(&other.tiles);
    arena_free(&other.env);
}

/* Behind something small: a product is aligned as the numbers in it are. */
static void check_room_on_stack(void) {
    typedef struct {
        char before;
        double at;
    } aligned;
    struct {
        char before;
        union {
            mcs_product p;
            char room[MCS_PRODUCT_BYTES(16)];
        } at;
    } on_stack;
    scene m = scene_make(SMOOTH, 64, 32, 16);
    const surface s = surface_make(normals[0], local_wo(0.7, 0.1), lobes[0]);
    CHECK(!mcs_product_build(&on_stack.at.p, sizeof on_stack.at, tiles_of(&m), env_of(&m), &s.r, NULL), "refused");
    CHECK(((uintptr_t)&on_stack.at.p + on_stack.at.p.at.per_share) % offsetof(aligned, at) == 0, "misaligned");
    scene_free(&m);
}
static void test_memory(void) {
    mcst_group("product, memory");
    for (uint32_t rows = 16; rows <= 64; rows *= 2) {
        const surface s = surface_make(normals[4], local_wo(0.7, 0.2), lobes[2]);
        if (!mcst_case("%u rows of tiles", rows)) continue;
        scene m = scene_make(SUN, 100, 47, rows);
        sampler d = sampler_make(&m, &s);
        check_refused_products(&d);
        check_refused_tiles(&m);
        check_copies(&d);
        sampler_free(&d);
        scene_free(&m);
    }
    if (mcst_case("room on the stack")) check_room_on_stack();
}

/* ---- arrays ---- */

/* The outputs of an array of draws. */
enum { MOST = 150 };
typedef struct {
    float f[4][MOST + 1];
    uint32_t k[2][MOST + 1];
} outputs;
/* n draws from entry `off` on into those outputs that are wanted: x, y, z, pdf, col, row. */
static void draw_array(const sampler *d, int n, int off, const float *const u[2], int wanted, outputs *out) {
    float *f[4];
    for (int k = 0; k < 4; k++) f[k] = wanted >> k & 1 ? out->f[k] + off : NULL;
    mcs_product_sample_n(d->p, tiles_of(d->m), env_of(d->m), (size_t)n, u[0] + off, u[1] + off, f[0], f[1], f[2], f[3],
                         wanted & 16 ? out->k[0] + off : NULL, wanted & 32 ? out->k[1] + off : NULL);
}
/* Bad numbers are among them. Where x and y are wanted they go over u1 and u2, or the other way. */
static void check_array(const sampler *d, mcs_pcg32 *rng, int n, int off) {
    float u1[MOST + 1], u2[MOST + 1];
    const float *const own[2] = {u1, u2};
    outputs all, some;
    fill(rng, MOST + 1, u1, u2);
    if (n > 4) {
        u1[off + 2] = NAN;
        u2[off + 3] = 1.0f;
        u1[off + 4] = 0.0f;
    }
    draw_array(d, n, off, own, 63, &all);
    for (int i = off; i < n + off; i++) {
        const mcs_texel t = {{all.f[0][i], all.f[1][i], all.f[2][i]}, all.f[3][i], all.k[0][i], all.k[1][i]};
        CHECK(same_draw(d, draw(d, u1[i], u2[i]), t), "n = %d, entry %d: not that of sample(%a, %a)", n, i,
              (double)u1[i], (double)u2[i]);
    }
    for (int wanted = 0; wanted < 64; wanted += n % 7 ? 21 : 1) {
        const int swap = wanted >> 2 & 1;
        memcpy(some.f[swap], u1, sizeof u1);
        memcpy(some.f[!swap], u2, sizeof u2);
        const float *const over[2] = {some.f[swap], some.f[!swap]};
        draw_array(d, n, off, wanted % 4 == 3 ? over : own, wanted, &some);
        for (int k = 0; k < 6; k++)
            CHECK(!(wanted >> k & 1) ||
                      !memcmp(k < 4 ? (void *)(all.f[k] + off) : (void *)(all.k[k - 4] + off),
                              k < 4 ? (void *)(some.f[k] + off) : (void *)(some.k[k - 4] + off), (size_t)n * 4),
                  "n = %d: output %d of %d is not that of all", n, k, wanted);
    }
}
static int has_fine(const sampler *d) {
    const uint8_t *grid_of = (const uint8_t *)d->p + d->p->at.grid_of;
    int grids = 0;
    for (uint32_t k = 0; k < 2 * d->m->rows * d->m->rows; k++) grids += grid_of[k] > 0;
    return grids > 0;
}

static void test_arrays(void) {
    /* of the last one the lobe's share is taken: then arrays go through grids alone, too */
    static const struct {
        int lobe, share, fine;
        picture map;
    } cases[] = {{0, 0, 0, SUN},       {2, 0, 0, SUN},      {8, 1, 1, SUN},
                 {1, 0, 0, BLACK_MAP}, {2, 0, 0, CONSTANT}, {4, 1, 1, SUN}};
    const int last = (int)(sizeof cases / sizeof *cases) - 1;
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 72);
    mcst_group("product, arrays");
    for (int i = 0; i <= last; i++) {
        if (!mcst_case("%s, %s", lobes[cases[i].lobe].name, picture_name[cases[i].map])) continue;
        scene m = scene_make(cases[i].map, 64, 32, 16);
        const surface s = surface_make(normals[i], local_wo(0.5, 0.1), lobes[cases[i].lobe]);
        sampler d = sampler_make(&m, &s);
        CHECK(cases[i].share == (d.share > 0) && cases[i].fine == has_fine(&d), "share %g, grids %d", d.share,
              has_fine(&d));
        if (i == last) d.p->brdf_share = 0;
        for (int n = 0; n <= 72; n++) check_array(&d, &rng, n <= 70 ? n : n == 71 ? 129 : MOST, n & 1);
        sampler_free(&d);
        scene_free(&m);
    }
}

/* ---- a turned map ---- */
static void test_turned(void) {
    const mcs_frame f = mcs_frame_make(vec(0.48, -0.6, 0.64));
    mcst_group("product, turned map");
    if (!mcst_case("sun")) return;
    scene m = scene_make(SUN, 64, 32, 16);
    const surface s = surface_make(normals[4], local_wo(0.7, 0.2), lobes[2]);
    surface turned = s;
    turned.r.frame.s = mcs_to_world(&f, s.r.frame.s);
    turned.r.frame.t = mcs_to_world(&f, s.r.frame.t);
    turned.r.frame.n = mcs_to_world(&f, s.r.frame.n);
    double expected[64 * 32];
    sampler d = sampler_make(&m, &s);
    for (uint32_t k = 0; k < 64 * 32; k++) expected[k] = density(&d, point(64, 32, k % 64, k / 64, 0.5, 0.5));
    ((mcs_env *)(void *)m.env.at)->frame = f;
    sampler e = sampler_make(&m, &turned);
    for (uint32_t k = 0; k < 64 * 32; k++) {
        const double p = density(&e, mcs_to_world(&f, point(64, 32, k % 64, k / 64, 0.5, 0.5)));
        /* Cosines move by some 4 eps, weights by that over a cosine; tiles on the horizon have one of a hundredth at
         * least where they are not at the floor; shares are integers over 2^24 */
        CHECK(fabs(p - expected[k]) <= 1e-4 * expected[k] + 1e-6, "texel (%u, %u): density %g, not %g", k % 64, k / 64,
              p, expected[k]);
    }
    for (int i = 0; i < 500; i++) {
        const mcs_texel t = draw(&e, hash01((uint32_t)i, 16), hash01((uint32_t)i, 17));
        double col, row;
        texel_of(64, 32, mcs_to_local(&f, t.w), &col, &row);
        /* a place within rounding of a border of its texel: 4 eps of a turn */
        CHECK(fabs(col - t.col - 0.5) <= 0.5 + 64 * 8 * eps / sin(pi * (row + 1e-3) / 32) &&
                  fabs(row - t.row - 0.5) <= 0.5 + 32 * 8 * eps,
              "texel (%u, %u), direction at (%g, %g)", t.col, t.row, col, row);
    }
    sampler_free(&d);
    sampler_free(&e);
    scene_free(&m);
}

/* ---- directions of tiles ---- */

/* Half of the solid angle of a box lies above its middle. */
static mcs_vec3 middle_of(const scene *m, const box *b) {
    const double z = (cos(pi * b->r0 / m->h) + cos(pi * b->r1 / m->h)) / 2;
    const double phi = pi * (b->c0 + b->c1) / m->w;
    const double across = sqrt((1 - z) * (1 + z));
    return vec(across * cos(phi), across * sin(phi), z);
}
/* The mean of the light of its texels, each at its middle; where there is none, the middle of the tile. Azimuths of
 * texels are floats, and the mean of light beside the pole may be short. */
static void check_direction(const scene *m, uint32_t tile) {
    const mcs_vec3 w = mcs_tiles_direction(tiles_of(m), env_of(m), tile);
    const box b = tile_box(m, tile);
    double sum[3] = {0, 0, 0};
    for (uint32_t r = b.r0; r < b.r1; r++)
        for (uint32_t c = b.c0; c < b.c1; c++) {
            double v[3];
            to3(v, point(m->w, m->h, c, r, 0.5, 0.5));
            for (int k = 0; k < 3; k++) sum[k] += weight_of(m, c, r) * m->area[r] * v[k];
        }
    if (!(dot3(sum, sum) > 0)) to3(sum, middle_of(m, &b));
    const mcs_vec3 want = vec(sum[0], sum[1], sum[2]);
    CHECK(fabs((double)w.x - want.x) <= 32 * eps && fabs((double)w.y - want.y) <= 32 * eps &&
              fabs((double)w.z - want.z) <= 32 * eps,
          "tile %u: direction (%g, %g, %g), not (%g, %g, %g)", tile, (double)w.x, (double)w.y, (double)w.z,
          (double)want.x, (double)want.y, (double)want.z);
}
static void test_directions(void) {
    static const struct {
        picture kind;
        uint32_t w, h, rows;
    } maps[] = {{SUN, 64, 32, 16}, {SPARSE, 50, 25, 16}, {ROOM, 200, 100, 64},   {CONSTANT, 64, 32, 32},
                {HALF, 7, 5, 16},  {CONSTANT, 1, 1, 16}, {BLACK_MAP, 64, 32, 16}};
    mcst_group("product, directions");
    for (int a = 0; a < (int)(sizeof maps / sizeof *maps); a++) {
        if (!mcst_case("%s, %u x %u", picture_name[maps[a].kind], maps[a].w, maps[a].h)) continue;
        scene m = scene_make(maps[a].kind, maps[a].w, maps[a].h, maps[a].rows);
        for (uint32_t k = 0; k < 2 * m.rows * m.rows; k++) check_direction(&m, k);
        scene_free(&m);
    }
}
#endif
