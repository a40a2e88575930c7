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
    const char *name;
    light_fn value;
    uint32_t w, h;
    int normals, sub;
} supported_map;

/* The axes, then random ones; every other one nearly a pole or nearly on the equator. */
static mcs_vec3 normal_of_support(int i) {
    const float u1 = hash01((uint32_t)i, 7);
    const float u2 = hash01((uint32_t)i, 8);
    const double sign = 1 - i % 2 * 2;
    const mcs_vec3 n =
        i < 6 ? vec(i / 2 == 0 ? sign : 0, i / 2 == 1 ? sign : 0, i / 2 == 2 ? sign : 0) : mcs_sphere_sample(u1, u2).w;
    if (i % 4 == 3) return vec(n.x, n.y, n.z * 1e-3);
    if (i % 4 == 1) return vec(n.x * 1e-3, n.y * 1e-3, n.z + 1e-9);
    return n;
}

static void check_map_is_supported(const supported_map *map, uint32_t rows, int shaped) {
    scene m = scene_make(map->name, map->w, map->h, map->value, rows);
    uint32_t c = 0;
    uint32_t r = 0;
    for (int i = 0; i < map->normals; i++) {
        const surface s =
            surface_make(normal_of_support(i), local_wo(0.05 + 0.019 * i, 0.07 * i), lobe_of(shaped, i, 6));
        sampler d = sampler_make(&m, &s);
        const int bad = d.share > 0 ? 0 : unsupported(&d, map->sub, &c, &r);
        CHECK(bad == 0, "normal %a %a %a: %d texels cannot be drawn, the first (%u, %u) that rises to %g", s.n[0],
              s.n[1], s.n[2], bad, c, r, highest(&m, s.n, c, r, map->sub));
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
    for (uint32_t r = 0; r < at->h; r++)
        for (uint32_t c = 0; c < at->w; c++) {
            const int in_row = r == at->row;
            double v[3];
            to3(v, point(at->w, at->h, c, r, 0.5, 0.5));
            if (dot3(s->n, v) < low[in_row]) {
                low[in_row] = dot3(s->n, v);
                deep[in_row] = r * at->w + c;
            }
        }
    CHECK(low[0] < -0.8 && low[1] < -0.8, "the other lights at %g, %g", low[0], low[1]);
    light[deep[0]] = 1e18f;
    if (two) light[deep[1]] = 1e9f;
}
/* z: how far the texel rises over the horizon, by 2^-i of the corner. */
static void check_barely_lit(const sampler *d, const lone_texel *at, double z, int i) {
    uint32_t c = 0;
    uint32_t r = 0;
    const int bad = d->share > 0 ? 0 : unsupported(d, 4, &c, &r);
    CHECK(bad == 0, "%d texels cannot be drawn, the first rises to %g", bad, z);
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

static void check_support(int shaped) {
    static const supported_map maps[] = {
        {"1 x 1", v_constant, 1, 1, 50, 32},
        {"7 x 5", v_noise, 7, 5, 50, 16},
        {"33 x 17", v_noise, 33, 17, 50, 4},
        {"50 x 25, sparse", v_sparse, 50, 25, 50, 4},
        {"64 x 32, sun", v_sun, 64, 32, 30, 3},
        {"64 x 32, poles", v_poles, 64, 32, 50, 3},
        {"100 x 1000, sparse", v_sparse, 100, 1000, 2, 2},
        {"2 x 40, poles", v_poles, 2, 40, 50, 8},
        {"3 x 2", v_noise, 3, 2, 50, 16},
        {"41 x 21, one texel", v_one_texel, 41, 21, 50, 4},
    };
    static const char *const beside[] = {"", " beside a sun", " beside a sun, in a row with another"};
    const char *of = shaped ? ", Gauss and Phong" : "";
    for (int a = 0; a < (int)(sizeof maps / sizeof *maps); a++)
        for (uint32_t rows = 16; rows <= 64; rows *= 2)
            if (mcst_case("%s, %u rows of tiles%s", maps[a].name, rows, of))
                check_map_is_supported(&maps[a], rows, shaped);
    /* A texel of which just one corner rises over the horizon. */
    for (int a = 0; a < 3; a++)
        for (uint32_t rows = 16; rows <= 64; rows *= 2)
            if (mcst_case("barely visible%s, %u rows of tiles%s", beside[a], rows, of))
                check_barely_visible(rows, a, shaped);
}

static void test_support(void) {
    mcst_group("product, support");
    check_support(0);
    check_support(1);
}

/* ---- extremes ---- */

/* A black map is drawn from like an even one, as the environment's. */
static void check_black(const sampler *d, const scene *even) {
    sampler e = sampler_make(even, d->s);
    CHECK(d->dark == e.dark, "black: dark %d, of an even map %d", d->dark, e.dark);
    for (uint32_t j = 0; j < 20; j++) {
        const float u1 = hash01(j, 13);
        const float u2 = hash01(j, 19);
        const mcs_vec3 w = mcs_sphere_sample(u1, u2).w;
        const mcs_texel a = draw(d, u1, u2);
        const mcs_texel b = draw(&e, u1, u2);
        CHECK(density(d, w) == density(&e, w) && !memcmp(&a, &b, sizeof a), "black: density %g, of an even map %g",
              density(d, w), density(&e, w));
    }
    sampler_free(&e);
}

typedef struct {
    const char *name;
    light_fn value;
    uint32_t w, h;
    mcs_profile profile;
} extreme_map;

static void check_extreme_surfaces(const extreme_map *map, uint32_t rows) {
    static const float alphas[] = {1e-6f, 1e-4f, 1e-3f, 0.0f, 1e4f, 1e10f, INFINITY, NAN, -1.0f, 0.3f};
    static const float mattes[] = {0.0f, 1.0f, 0.5f, NAN, -1.0f, 2.0f};
    scene m = scene_make(map->name, map->w, map->h, map->value, rows);
    scene even = scene_make("constant", map->w, map->h, v_constant, m.rows);
    for (int i = 0; i < 10 * 6; i++) {
        surface s = surface_make(normals[i % NORMALS], local_wo(i % 5 ? 0.2 * (i % 5) : 1e-6, 0.1 * i), lobes[0]);
        s.r.alpha_x = alphas[i % 10];
        s.r.alpha_y = alphas[i % 3 ? i % 10 : 9 - i % 10];
        s.r.matte = mattes[i / 10];
        s.r.profile = s.profile = map->profile;
        sampler d = sampler_make(&m, &s);
        check_sane(&d, 1);
        if (map->value == v_black) check_black(&d, &even);
        sampler_free(&d);
    }
    scene_free(&m);
    scene_free(&even);
}

static void check_eyes_below(void) {
    scene m = scene_make("sun", 64, 32, v_sun, 16);
    static const float bad_wo[][3] = {{0, 0, -1},  {1, 0, 0},        {0.6f, 0, -0.8f}, {0, 0, 0},
                                      {NAN, 0, 1}, {0, 0, INFINITY}, {0, 0, 5}};
    for (int i = 0; i < (int)(sizeof bad_wo / sizeof *bad_wo); i++) {
        surface s = surface_make(normals[4], local_wo(0.5, 0), lobes[2]);
        s.r.wo.x = bad_wo[i][0];
        s.r.wo.y = bad_wo[i][1];
        s.r.wo.z = bad_wo[i][2];
        sampler d = sampler_make(&m, &s);
        CHECK(d.dark, "the product is not dark");
        check_sane(&d, 1);
        for (int j = 0; j < HARD; j++)
            CHECK(!(draw(&d, hard_u[j], 0.3f).pdf > 0) && density(&d, normals[4]) == 0, "eye (%g, %g, %g): density",
                  (double)s.r.wo.x, (double)s.r.wo.y, (double)s.r.wo.z);
        sampler_free(&d);
    }
    scene_free(&m);
}

static void check_light_below(void) {
    scene m = scene_make("one texel", 64, 32, v_one_texel, 16);
    for (int i = 0; i < 4; i++) {
        const mcs_vec3 to = point(64, 32, 21, 10, 0.5, 0.5);
        const surface s = surface_make(vec(-(double)to.x, -(double)to.y, -(double)to.z), local_wo(0.5, 0), lobes[i]);
        sampler d = sampler_make(&m, &s);
        CHECK(d.dark, "the product is not dark");
        CHECK(!(draw(&d, 0.3f, 0.6f).pdf > 0) && density(&d, to) == 0, "the light behind has density %g",
              density(&d, to));
        check_sane(&d, 1);
        sampler_free(&d);
    }
    scene_free(&m);
}

static void check_bad_frames(void) {
    scene m = scene_make("sun", 64, 32, v_sun, 16);
    for (int i = 0; i < 60; i++) {
        static const float wrong[] = {NAN, INFINITY, 0.0f, 1e30f, -INFINITY};
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
    static const extreme_map maps[] = {
        {"sun", v_sun, 64, 32, MCS_PROFILE_GGX},           {"one texel", v_one_texel, 41, 21, MCS_PROFILE_GGX},
        {"constant", v_constant, 30, 20, MCS_PROFILE_GGX}, {"black", v_black, 30, 20, MCS_PROFILE_GGX},
        {"1 x 1", v_constant, 1, 1, MCS_PROFILE_GGX},      {"poles", v_poles, 64, 32, MCS_PROFILE_GGX},
        {"sparse", v_sparse, 100, 200, MCS_PROFILE_GGX},   {"sun", v_sun, 64, 32, MCS_PROFILE_GAUSS},
        {"sun", v_sun, 64, 32, MCS_PROFILE_PHONG}};
    mcst_group("product, extremes");
    for (int a = 0; a < (int)(sizeof maps / sizeof *maps); a++) {
        const mcs_profile profile = maps[a].profile;
        const char *of = profile == MCS_PROFILE_GAUSS ? ", Gauss" : profile == MCS_PROFILE_PHONG ? ", Phong" : "";
        if (mcst_case("%s%s", maps[a].name, of)) check_extreme_surfaces(&maps[a], a % 2 ? 32 : 16);
    }
    if (mcst_case("eye below the surface")) check_eyes_below();
    if (mcst_case("light below the surface")) check_light_below();
    if (mcst_case("bad frames")) check_bad_frames();
}

/* ---- memory ---- */

static void check_refused_products(const scene *m, const sampler *d, const mcs_reflection *r, size_t bytes) {
    CHECK(m->tiles.bytes % 4 == 0 && d->mem.bytes % 4 == 0, "%zu and %zu bytes", m->tiles.bytes, d->mem.bytes);
    CHECK(mcs_product_build(d->p, bytes - 1, tiles_of(m), env_of(m), r, NULL) == MCS_ERR_MEMORY, "one byte too few");
    CHECK(mcs_product_build(NULL, bytes, tiles_of(m), env_of(m), r, NULL) == MCS_ERR_ARG, "no memory");
    CHECK(mcs_product_build(d->p, bytes, NULL, env_of(m), r, NULL) == MCS_ERR_ARG, "no tiles");
    CHECK(mcs_product_build(d->p, bytes, tiles_of(m), NULL, r, NULL) == MCS_ERR_ARG, "no map");
    CHECK(mcs_product_build(d->p, bytes, tiles_of(m), env_of(m), NULL, NULL) == MCS_ERR_ARG, "no reflection");
    CHECK(mcs_product_build((mcs_product *)(void *)(d->mem.at + 4), bytes, tiles_of(m), env_of(m), r, NULL) ==
              MCS_ERR_ARG,
          "misaligned");
    CHECK(mcs_product_build_weights(d->p, bytes, tiles_of(m), env_of(m), NULL) == MCS_ERR_ARG, "no weights");
    CHECK(arena_intact(&d->mem), "refused arguments, yet wrote outside");
    CHECK(mcs_product_build(d->p, bytes, tiles_of(m), env_of(m), r, NULL) == MCS_OK, "the same again");
}

/* `moved`: memory for tiles. What is refused leaves it alone; then the tiles are copied there. */
static void check_moved_tiles(const scene *m, const sampler *d, size_t bytes, arena *moved) {
    CHECK(mcs_tiles_build(NULL, moved->bytes, env_of(m), m->rows) == MCS_ERR_ARG, "no memory");
    CHECK(mcs_tiles_build((mcs_tiles *)(void *)moved->at, moved->bytes, NULL, m->rows) == MCS_ERR_ARG, "no map");
    CHECK(mcs_tiles_build((mcs_tiles *)(void *)(moved->at + 4), moved->bytes, env_of(m), m->rows) == MCS_ERR_ARG,
          "misaligned");
    CHECK(mcs_tiles_build((mcs_tiles *)(void *)moved->at, moved->bytes - 1, env_of(m), m->rows) == MCS_ERR_MEMORY,
          "one byte too few");
    CHECK(untouched(moved->at, moved->bytes), "refused arguments, yet wrote");
    memcpy(moved->at, m->tiles.at, moved->bytes);
    for (uint32_t i = 0; i < 200; i++) {
        const float u1 = hash01(i, 14);
        const float u2 = hash01(i, 15);
        const mcs_texel a = draw(d, u1, u2);
        const mcs_texel b = mcs_product_sample(d->p, (const mcs_tiles *)(const void *)moved->at, env_of(m), u1, u2);
        CHECK(!memcmp(&a, &b, sizeof a), "u = %a, %a: moved tiles draw another", (double)u1, (double)u2);
    }
    {
        scene other = *m;
        other.tiles = *moved;
        sampler e = sampler_make(&other, d->s);
        CHECK(!memcmp(e.mem.at + sizeof(mcs_product), d->mem.at + sizeof(mcs_product), bytes - sizeof(mcs_product)),
              "moved tiles give another table");
        sampler_free(&e);
    }
}

/* Product, tiles and map hold no pointers: copies of them are as good. */
static void check_copies(const scene *m, const sampler *d) {
    scene other = *m;
    other.env = arena_make(m->env.bytes);
    other.tiles = arena_make(m->tiles.bytes);
    arena product = arena_make(d->mem.bytes);
    memcpy(other.env.at, m->env.at, m->env.bytes);
    memcpy(other.tiles.at, m->tiles.at, m->tiles.bytes);
    memcpy(product.at, d->mem.at, d->mem.bytes);
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
    arena_free(&product);
    arena_free(&other.tiles);
    arena_free(&other.env);
}

static void check_room_on_stack(void) {
    struct {
        char before;
        union {
            mcs_product p;
            char room[MCS_PRODUCT_BYTES(16)];
        } at;
    } on_stack;
    scene m = scene_make("smooth", 64, 32, v_smooth, 16);
    const surface s = surface_make(normals[0], local_wo(0.7, 0.1), lobes[0]);
    const mcs_status rc = mcs_product_build(&on_stack.at.p, sizeof on_stack.at, tiles_of(&m), env_of(&m), &s.r, NULL);
    CHECK(rc == MCS_OK && !on_stack.at.p.dark, "refused or dark: %d", rc);
    CHECK(((uintptr_t)&on_stack.at.p + mcsi_product_layout(16).per_share) % offsetof(mcsi_aligned, at) == 0,
          "lists are misaligned");
    scene_free(&m);
}

static void check_refused_sizes(void) {
    static const uint32_t wrong[] = {0, 1, 8, 15, 17, 24, 48, 65, 128, 0x80000000u, 0xffffffffu};
    scene m = scene_make("sun", 64, 32, v_sun, 16);
    for (int i = 0; i < (int)(sizeof wrong / sizeof *wrong); i++) {
        CHECK(mcs_tiles_bytes(env_of(&m), wrong[i]) == 0, "%u rows: %zu bytes", wrong[i],
              mcs_tiles_bytes(env_of(&m), wrong[i]));
        CHECK(mcs_product_bytes(wrong[i]) == 0, "%u rows: %zu bytes", wrong[i], mcs_product_bytes(wrong[i]));
        CHECK(mcs_tiles_build((mcs_tiles *)(void *)m.tiles.at, m.tiles.bytes, env_of(&m), wrong[i]) == MCS_ERR_SIZE,
              "%u rows", wrong[i]);
    }
    CHECK(mcs_tiles_bytes(NULL, 16) == 0, "no map");
    scene_free(&m);
}

static void test_memory(void) {
    mcst_group("product, memory");
    for (uint32_t rows = 16; rows <= 64; rows *= 2) {
        const surface s = surface_make(normals[4], local_wo(0.7, 0.2), lobes[2]);
        if (!mcst_case("%u rows of tiles", rows)) continue;
        scene m = scene_make("sun", 100, 47, v_sun, rows);
        sampler d = sampler_make(&m, &s);
        arena moved = arena_make(m.tiles.bytes);
        check_refused_products(&m, &d, &s.r, mcs_product_bytes(rows));
        check_moved_tiles(&m, &d, mcs_product_bytes(rows), &moved);
        check_copies(&m, &d);
        arena_free(&moved);
        sampler_free(&d);
        scene_free(&m);
    }
    /* behind something small: a product is aligned as the numbers in it are */
    if (mcst_case("room on the stack")) check_room_on_stack();
    if (mcst_case("refused sizes")) check_refused_sizes();
}
/* A draw by array is that of sample. Where a*b + c is contracted the places of both differ by rounding, and with them
 * perhaps the texel: there its density has to be that of its direction. */
static int same_draw(const sampler *d, float u1, float u2, mcs_texel by_array) {
    const mcs_texel t = mcs_product_sample(d->p, tiles_of(d->m), env_of(d->m), u1, u2);
    if (!mcst_arrays_contract()) return !memcmp(&t, &by_array, sizeof t);
    if (!(by_array.pdf > 0)) return !(t.pdf > 0);
    double col, row;
    texel_of(d->m->w, d->m->h, by_array.w, &col, &row);
    by_array.col = col < d->m->w ? (uint32_t)col : d->m->w - 1;
    by_array.row = row < d->m->h ? (uint32_t)row : d->m->h - 1;
    return t.pdf > 0 && agrees(d, by_array);
}
static void check_arrays(const sampler *d, mcs_pcg32 *rng) {
    enum { MOST = 150 };
    float u1[MOST + 1], u2[MOST + 1], out[4][MOST + 1], all[4][MOST + 1];
    uint32_t col[2][MOST + 1], row[2][MOST + 1];
    for (int n = 0; n <= 72; n++) {
        const int count = n <= 70 ? n : n == 71 ? 129 : MOST;
        for (int k = 0; k < 18; k++) { /* bit 0 to 3: outputs that are wanted; 16, 17: over the inputs */
            const int wanted = k < 16 ? k : 15;
            float *x = k == 16 ? u1 : k == 17 ? u2 : out[0];
            float *y = k == 16 ? u2 : k == 17 ? u1 : out[1];
            if (n % 7 && k < 15 && k) continue;
            const int off = n & 1;
            fill(rng, (size_t)count + 1, u1, u2);
            if (count > 3) {
                u1[off + 2] = NAN;
                u2[off + 3] = 1.0f;
            }
            if (count > 4) u1[off + 4] = 0.0f;
            mcs_product_sample_n(d->p, tiles_of(d->m), env_of(d->m), (size_t)count, u1 + off, u2 + off, all[0] + off,
                                 all[1] + off, all[2] + off, all[3] + off, col[0] + off, row[0] + off);
            for (int i = off; i < count + off; i++) {
                mcs_texel t;
                t.w.x = all[0][i];
                t.w.y = all[1][i];
                t.w.z = all[2][i];
                t.pdf = all[3][i];
                t.col = col[0][i];
                t.row = row[0][i];
                CHECK(same_draw(d, u1[i], u2[i], t), "n = %d, entry %d: not that of sample(%a, %a)", count, i,
                      (double)u1[i], (double)u2[i]);
            }
            mcs_product_sample_n(d->p, tiles_of(d->m), env_of(d->m), (size_t)count, u1 + off, u2 + off,
                                 wanted & 1 ? x + off : NULL, wanted & 2 ? y + off : NULL,
                                 wanted & 4 ? out[2] + off : NULL, wanted & 8 ? out[3] + off : NULL,
                                 wanted & 2 ? col[1] + off : NULL, wanted & 1 ? row[1] + off : NULL);
            for (int i = off; i < count + off; i++)
                CHECK((!(wanted & 1) || !memcmp(all[0] + i, x + i, 4)) &&
                          (!(wanted & 2) || !memcmp(all[1] + i, y + i, 4)) &&
                          (!(wanted & 4) || !memcmp(all[2] + i, out[2] + i, 4)) &&
                          (!(wanted & 8) || !memcmp(all[3] + i, out[3] + i, 4)) &&
                          (!(wanted & 2) || col[0][i] == col[1][i]) && (!(wanted & 1) || row[0][i] == row[1][i]),
                      "n = %d, entry %d, outputs %d: not those of all", count, i, k);
        }
    }
}

static int has_fine(const sampler *d) {
    const uint8_t *grid_of = MCSI_READ(uint8_t, d->p, mcsi_product_layout(d->m->rows).grid_of);
    uint32_t grids = 0;
    for (uint32_t k = 0; k < 2 * d->m->rows * d->m->rows; k++) grids += grid_of[k] > 0;
    return grids > 0;
}

static void test_arrays(void) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 72);
    mcst_group("product, arrays");
    for (int i = 0; i < 6;
         i++) { /* the last one has fine grids and no share for the lobe: then arrays go through them, too */
        static const int of[] = {0, 2, 8, 1, 2, 4};
        if (!mcst_case("%s%s", lobes[of[i]].name, i == 3 ? ", black" : i == 4 ? ", constant" : "")) continue;
        scene m = scene_make("sun", 64, 32, i == 3 ? v_black : i == 4 ? v_constant : v_sun, 16);
        const surface s = surface_make(normals[i], local_wo(0.5, 0.1), lobes[of[i]]);
        sampler d = sampler_make(&m, &s);
        CHECK((i == 2) == (d.share > 0), "share %g", d.share);
        CHECK((i == 2 || i == 5) == has_fine(&d), "grids of fine tiles");
        check_arrays(&d, &rng);
        sampler_free(&d);
        scene_free(&m);
    }
}

/* ---- a turned map ---- */

static void test_turned(void) {
    mcst_group("product, turned map");
    const mcs_frame f = mcs_frame_make(vec(0.48, -0.6, 0.64));
    if (!mcst_case("sun")) return;
    scene m = scene_make("sun", 64, 32, v_sun, 16);
    surface s = surface_make(normals[4], local_wo(0.7, 0.2), lobes[2]);
    surface turned = s;
    mcs_env *env = (mcs_env *)(void *)m.env.at;
    turned.r.frame.s = mcs_to_world(&f, s.r.frame.s);
    turned.r.frame.t = mcs_to_world(&f, s.r.frame.t);
    turned.r.frame.n = mcs_to_world(&f, s.r.frame.n);
    double *const expected = (double *)memory(64 * 32 * sizeof *expected);
    sampler d = sampler_make(&m, &s);
    for (uint32_t r = 0; r < 32; r++)
        for (uint32_t c = 0; c < 64; c++) expected[r * 64 + c] = density(&d, point(64, 32, c, r, 0.5, 0.5));
    env->frame = f;
    sampler e = sampler_make(&m, &turned);
    for (uint32_t r = 0; r < 32; r++)
        for (uint32_t c = 0; c < 64; c++) {
            const double p = density(&e, mcs_to_world(&f, point(64, 32, c, r, 0.5, 0.5)));
            const double want = expected[r * 64 + c];
            /* Cosines move by some 4 eps, weights by that over a cosine; tiles on the horizon have one of a
                 * hundredth at least where they are not at the floor; shares are integers over 2^24 */
            CHECK(fabs(p - want) <= 1e-4 * want + 1e-6, "texel (%u, %u): density %g, not %g", c, r, p, want);
        }
    for (int i = 0; i < 500; i++) {
        const mcs_texel t = draw(&e, hash01((uint32_t)i, 16), hash01((uint32_t)i, 17));
        const mcs_vec3 local = mcs_to_local(&f, t.w);
        double col, row;
        texel_of(64, 32, local, &col, &row);
        /* a place within rounding of a border of its texel: 4 eps of a turn */
        CHECK(fabs(col - t.col - 0.5) <= 0.5 + 64 * 8 * eps / sin(pi * (row + 1e-3) / 32) &&
                  fabs(row - t.row - 0.5) <= 0.5 + 32 * 8 * eps,
              "texel (%u, %u), direction at (%g, %g)", t.col, t.row, col, row);
    }
    sampler_free(&d);
    sampler_free(&e);
    free(expected);
    scene_free(&m);
}

/* ---- directions of tiles ---- */

static void test_directions(void) {
    static const struct {
        const char *name;
        light_fn value;
        uint32_t w, h, rows;
    } maps[] = {{"sun", v_sun, 64, 32, 16},           {"sparse", v_sparse, 50, 25, 16}, {"room", v_room, 200, 100, 64},
                {"constant", v_constant, 64, 32, 32}, {"half", v_half, 7, 5, 16},       {"1 x 1", v_constant, 1, 1, 16},
                {"black", v_black, 64, 32, 16}};
    mcst_group("product, directions");
    for (int a = 0; a < (int)(sizeof maps / sizeof *maps); a++) {
        if (!mcst_case("%s", maps[a].name)) continue;
        scene m = scene_make(maps[a].name, maps[a].w, maps[a].h, maps[a].value, maps[a].rows);
        for (uint32_t j = 0; j < 2 * m.rows; j++)
            for (uint32_t i = 0; i < m.rows; i++) {
                const mcs_vec3 w = mcs_tiles_direction(tiles_of(&m), env_of(&m), j * m.rows + i);
                const double len = sqrt((double)w.x * w.x + (double)w.y * w.y + (double)w.z * w.z);
                const uint32_t c0 = j * m.w / (2 * m.rows);
                const uint32_t c1 = (j + 1) * m.w / (2 * m.rows);
                const uint32_t r0 = i * m.h / m.rows;
                const uint32_t r1 = (i + 1) * m.h / m.rows;
                double t0 = pi * r0 / m.h;
                double t1 = pi * r1 / m.h;
                CHECK(fabs(len - 1) <= 8 * eps, "tile %u: length 1 + %g", j * m.rows + i, len - 1);
                double col, row;
                texel_of(m.w, m.h, w, &col, &row);
                /* The mean of directions at one height lies nearer to the pole: tan(theta) of it is at least their tan
                 * times the cosine of half their azimuths' range. */
                const double bulge = c1 > c0 && c1 - c0 < m.w / 2 + 1 ? cos(pi * (c1 - c0) / m.w) : 0;
                if (t1 <= pi / 2) t0 = atan(tan(t0) * bulge);
                if (t0 >= pi / 2) t1 = pi - atan(tan(pi - t1) * bulge);
                CHECK(row * pi / m.h >= t0 - 1e-6 && row * pi / m.h <= t1 + 1e-6,
                      "tile (%u, %u): row %g, not in %u to %u", i, j, row, r0, r1);
                if (fabs((double)w.x) + fabs((double)w.y) > 1e-4)
                    CHECK((col >= c0 - 1e-2 && col <= c1 + 1e-2) || col >= m.w + c0 - 1e-2,
                          "tile (%u, %u): column %g, not in %u to %u", i, j, col, c0, c1);
            }
        scene_free(&m);
    }
}
#endif
