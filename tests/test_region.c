/* What parts of a scene learn of their light, and tables of that: visibility, tiles by weight, support, means; products
 * by array, with a share for the lobe and without. MCS_TEST_SCALE scales the number of samples. */
#include "stats.h"
#include "product_sampler.h"

/* ---- regions ---- */

typedef struct {
    arena mem;
    mcs_region *g;
} learned;

static learned region_make(const scene *m) {
    learned l;
    l.mem = arena_make(mcs_region_bytes(m->rows));
    l.g = (mcs_region *)(void *)l.mem.at;
    const mcs_status rc = mcs_region_start(l.g, l.mem.bytes, tiles_of(m));
    CHECK(rc == MCS_OK, "start returns %d", (int)rc);
    return l;
}
static void region_free(learned *l) {
    CHECK(arena_intact(&l->mem), "a region wrote outside its %zu bytes", l->mem.bytes);
    arena_free(&l->mem);
}
static void add_point(learned *l, const scene *m, const surface *s) {
    mcs_region_add_point(l->g, tiles_of(m), env_of(m), &s->r);
}
static uint32_t count_of(const scene *m) { return 2 * m->rows * m->rows; }
static uint32_t tiles_in(const mcs_region *g) { return 2 * g->rows * g->rows; }
/* Rays to tiles by chance, two of three of them through to the first half of the tiles, one of ten to the others. */
static void add_rays(learned *l, uint32_t rays, uint32_t stream) {
    const uint32_t n = tiles_in(l->g);
    for (uint32_t i = 0; i < rays; i++) {
        const uint32_t k = (uint32_t)((float)n * hash01(i, stream));
        mcs_region_add_ray(l->g, k, hash01(i, stream + 1) < (k < n / 2 ? 0.67f : 0.1f));
    }
}
/* `rays` to every tile. */
static void add_rays_to_all(learned *l, uint32_t rays, int through) {
    for (uint32_t k = 0; k < rays * tiles_in(l->g); k++) mcs_region_add_ray(l->g, k % tiles_in(l->g), through);
}
static const float *rays_of(const mcs_region *g, uint32_t k) {
    return MCSI_READ(float, g, sizeof *g) + tiles_in(g) + k;
}
/* V as part I has it, in double; up: where it was inherited from. */
static double visibility_of(const mcs_region *g, const mcs_region *up, uint32_t k) {
    const int rows = (int)g->rows;
    double rays = 2;
    double through = 2 * (up ? visibility_of(up, NULL, k) : 0.25);
    for (int away = 0; away < 9; away++) {
        const int row = (int)k % rows + away % 3 - 1;
        const uint32_t col = (k / g->rows + 2 * g->rows + (uint32_t)(away / 3) - 1) % (2 * g->rows);
        const double counts = pow(0.75, (away % 3 != 1) + (away / 3 != 1));
        if (row < 0 || row >= rows) continue;
        rays += counts * (double)*rays_of(g, col * g->rows + (uint32_t)row);
        through += counts * (double)rays_of(g, col * g->rows + (uint32_t)row)[tiles_in(g)];
    }
    const double own = (double)*rays_of(g, k);
    return fmax(1e-4, ((double)rays_of(g, k)[tiles_in(g)] + 16 * through / rays) / (own + 16));
}

/* The table of a region; in exactly as many bytes as it needs. */
static sampler table_of(const scene *m, const surface *s, const learned *l, const learned *up) {
    sampler d;
    d.m = m;
    d.s = s;
    d.mem = arena_make(mcs_product_table_bytes(m->rows));
    d.p = (mcs_product *)(void *)d.mem.at;
    if (up) mcs_region_inherit(l->g, up->g);
    d.status = mcs_product_build_region(d.p, d.mem.bytes, tiles_of(m), env_of(m), l->g);
    CHECK(d.status == MCS_OK && arena_intact(&d.mem), "build returns %d, or wrote outside", (int)d.status);
    d.share = (double)d.p->brdf_share;
    d.dark = d.p->dark != 0;
    d.most_fine = 0;
    CHECK(!(d.share > 0) && !d.dark, "share %g, dark %d", d.share, d.dark);
    return d;
}
/* What each texel has of the density: over a texel its mean is that of its middle. */
static double *texel_masses(const sampler *d) {
    const scene *m = d->m;
    double *part = (double *)memory((size_t)m->w * m->h * sizeof *part);
    for (uint32_t k = 0; k < m->w * m->h; k++)
        part[k] = density(d, point(m->w, m->h, k % m->w, k / m->w, 0.5, 0.5)) * m->area[k / m->w];
    return part;
}
static double *tile_masses(const sampler *d) {
    double *of_texels = texel_masses(d);
    double *part = (double *)memory(count_of(d->m) * sizeof *part);
    for (uint32_t k = 0; k < count_of(d->m); k++) part[k] = 0;
    for (uint32_t k = 0; k < d->m->w * d->m->h; k++) part[tile_at(d->m, k % d->m->w, k / d->m->w)] += of_texels[k];
    free(of_texels);
    return part;
}

/* ---- visibility, rays, points ---- */

static void check_visibility(void) {
    scene m = scene_make(SMOOTH, 64, 32, 16);
    learned l = region_make(&m);
    learned up = region_make(&m);
    const uint32_t n = count_of(&m);
    add_rays(&l, 5000, 30);
    add_rays(&up, 1000, 40);
    mcs_region_add_ray(l.g, 3, -7); /* any number but 0 is through */
    for (int i = 0; i < 200; i++) mcs_region_add_ray(l.g, 5, 0);
    for (int inherited = 0; inherited < 2; inherited++) {
        if (inherited) mcs_region_inherit(l.g, up.g);
        for (uint32_t k = 0; k < n; k++) {
            const double v = (double)mcs_region_visibility(l.g, k);
            const double want = visibility_of(l.g, inherited ? up.g : NULL, k);
            CHECK(fabs(v - want) <= 8 * eps * want, "tile %u: V %g, not %g", k, v, want);
        }
    }
    CHECK(l.g->rays == 5201 && up.g->rays == 1000, "%g and %g rays", (double)l.g->rays, (double)up.g->rays);
    for (int i = 0; i < 1000000; i++) mcs_region_add_ray(l.g, 5, 0);
    CHECK(mcs_region_visibility(l.g, 5) == 1e-4f, "next to all hidden: V %g", (double)mcs_region_visibility(l.g, 5));
    CHECK(mcs_region_visibility(l.g, n) == 0 && mcs_region_visibility(l.g, UINT32_MAX) == 0, "no tile");
    for (int i = 0; i < 26; i++) mcs_region_merge(l.g, l.g); /* a tile counts up to 2^24 */
    add_rays(&l, 5000, 50);
    for (uint32_t k = 0; k < n; k++) {
        const double v = (double)mcs_region_visibility(l.g, k);
        CHECK(v >= 1e-4f && v <= 1, "tile %u: V %g of %g rays", k, v, (double)rays_of(l.g, k)[0]);
    }
    region_free(&l);
    region_free(&up);
    scene_free(&m);
}
/* A tile, and the region, that have 2^24 rays count no more, neither those that come through: V stays. */
static void check_full(void) {
    scene m = scene_make(SMOOTH, 64, 32, 16);
    learned l = region_make(&m);
    const float full = 0x1p24f;
    for (int i = 0; i < 8; i++) mcs_region_add_ray(l.g, 5, i == 0);
    for (int i = 0; i < 21; i++) mcs_region_merge(l.g, l.g);
    const float v = mcs_region_visibility(l.g, 5);
    for (int i = 0; i < 1000; i++) mcs_region_add_ray(l.g, 5, 1);
    const float *rays = rays_of(l.g, 5);
    CHECK(rays[0] == full && rays[count_of(&m)] == full / 8 && mcs_region_visibility(l.g, 5) == v,
          "%g of %g rays came through", (double)rays[count_of(&m)], (double)rays[0]);
    CHECK(l.g->rays == full && l.g->through == full / 8, "in all %g of %g", (double)l.g->through, (double)l.g->rays);
    mcs_region_add_ray(l.g, 6, 1);
    CHECK(rays[1] == 1 && rays[count_of(&m) + 1] == 1 && l.g->rays == full, "another tile is full, too");
    region_free(&l);
    scene_free(&m);
}
/* V0 become the V of another region, or of the region itself; those of arrays may be contracted otherwise. */
static void check_inherit(void) {
    scene m = scene_make(SMOOTH, 64, 32, 16);
    learned l[2] = {region_make(&m), region_make(&m)};
    for (uint32_t i = 0; i < 6; i++) {
        float v[2 * 16 * 16];
        learned *to = &l[i % 4 / 2];
        const learned *from = &l[i % 2];
        add_rays(to, 3000, 30 + i);
        for (uint32_t k = 0; k < count_of(&m); k++) v[k] = mcs_region_visibility(from->g, k);
        mcs_region_inherit(to->g, from->g);
        for (uint32_t k = 0; k < count_of(&m); k++) {
            const double v0 = (double)*rays_of(to->g, 2 * count_of(&m) + k);
            CHECK(fabs(v0 - (double)v[k]) <= 8 * eps * (double)v[k], "tile %u: V0 %g, not %g%s", k, v0, (double)v[k],
                  to == from ? ", of the region itself" : "");
        }
    }
    region_free(&l[0]);
    region_free(&l[1]);
    scene_free(&m);
}
/* What is added to a tile that does not exist, and what a surface reflects that is seen from below, changes nothing. */
static void check_ignored(void) {
    scene m = scene_make(SUN, 64, 32, 16);
    learned l = region_make(&m);
    surface s = surface_make(normals[4], local_wo(0.5, 0.1), lobes[2]);
    add_point(&l, &m, &s);
    add_rays(&l, 100, 30);
    arena before = arena_make(l.mem.bytes);
    memcpy(before.at, l.mem.at, before.bytes);
    mcs_region_add_ray(l.g, count_of(&m), 1);
    mcs_region_add_ray(l.g, UINT32_MAX, 0);
    for (int k = 0; k < BAD_W; k++) {
        s.r.wo = bad_w[k];
        add_point(&l, &m, &s);
    }
    s.r.wo.z = -0.5f;
    add_point(&l, &m, &s);
    CHECK(arena_differ(&l.mem, &before) == before.bytes, "byte %zu changed", arena_differ(&l.mem, &before));
    arena_free(&before);
    region_free(&l);
    scene_free(&m);
}
/* Parts that are merged are the whole: bit for bit in rays, in any order; to rounding in points. */
static void check_merge(void) {
    scene m = scene_make(ROOM, 64, 32, 16);
    learned whole = region_make(&m);
    learned part[2] = {region_make(&m), region_make(&m)};
    learned swapped = region_make(&m);
    for (int k = 0; k < 2; k++) {
        add_rays(&whole, 1000, k ? 40 : 30);
        add_rays(&part[k], 1000, k ? 40 : 30);
    }
    mcs_region_merge(swapped.g, part[1].g);
    mcs_region_merge(swapped.g, part[0].g);
    CHECK(arena_differ(&swapped.mem, &whole.mem) == whole.mem.bytes, "merged rays are others than all in one");
    for (int k = 0; k < 2; k++) {
        const surface s = surface_make(normals[k], local_wo(0.5, 0.1), lobes[k]);
        add_point(&whole, &m, &s);
        add_point(&part[k], &m, &s);
    }
    mcs_region_merge(part[0].g, part[1].g);
    const float *a = MCSI_READ(float, whole.g, sizeof *whole.g);
    const float *b = MCSI_READ(float, part[0].g, sizeof *whole.g);
    CHECK(whole.g->points == 2 && part[0].g->points == 2, "%g and %g points", (double)whole.g->points,
          (double)part[0].g->points);
    for (uint32_t k = 0; k < count_of(&m); k++)
        CHECK(fabs((double)a[k] - (double)b[k]) <= 4 * eps * (double)a[k], "tile %u: squares %g, merged %g", k,
              (double)a[k], (double)b[k]);
    for (int k = 0; k < 2; k++) region_free(&part[k]);
    region_free(&swapped);
    region_free(&whole);
    scene_free(&m);
}
static void check_decay(void) {
    static const struct {
        float keep, factor;
    } cases[] = {{0.5f, 0.5f}, {0.3f, 0.3f}, {1, 1}, {2, 1}, {INFINITY, 1}, {0, 0}, {-1, 0}, {NAN, 0}};
    scene m = scene_make(ROOM, 64, 32, 16);
    const surface s = surface_make(normals[4], local_wo(0.5, 0.1), lobes[2]);
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        learned l = region_make(&m);
        learned kept = region_make(&m);
        add_point(&l, &m, &s);
        add_rays(&l, 3000, 30);
        mcs_region_merge(kept.g, l.g);
        mcs_region_decay(l.g, cases[i].keep);
        const float *a = MCSI_READ(float, l.g, sizeof *l.g);
        const float *b = MCSI_READ(float, kept.g, sizeof *l.g);
        int bad = l.g->points != kept.g->points * cases[i].factor || l.g->rows != 16;
        bad += l.g->through != kept.g->through * cases[i].factor;
        for (uint32_t k = 0; k < 3 * count_of(&m); k++) bad += a[k] != b[k] * cases[i].factor;
        CHECK(bad == 0, "decay by %g: %d wrong", (double)cases[i].keep, bad);
        region_free(&l);
        region_free(&kept);
    }
    scene_free(&m);
}

/* Bounds as part I has them, in tiles of which there are 512, with and without half of the rays through. */
static void check_pays(void) {
    static const struct {
        float alpha_x, alpha_y, matte;
        int open, hidden; /* whether it pays there */
    } cases[] = {
        {1, 1, 1, 1, 1},         {1e-4f, 1e-4f, 0.01f, 1, 1}, {0.0441f, 0.0441f, 0, 0, 0}, {0.0443f, 0.0443f, 0, 0, 1},
        {0.1f, 0.156f, 0, 0, 1}, {0.1f, 0.157f, 0, 1, 1},     {0.157f, 0.1f, 0, 1, 1},     {INFINITY, 1, 0, 1, 1},
        {0, 1, 0, 0, 0},         {NAN, NAN, 0, 0, 0},         {-1, 0.5f, NAN, 0, 0}};
    scene m = scene_make(ROOM, 64, 32, 16);
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        surface s = surface_make(normals[4], local_wo(0.5, 0.1), lobes[2]);
        s.r.alpha_x = cases[i].alpha_x;
        s.r.alpha_y = cases[i].alpha_y;
        s.r.matte = cases[i].matte;
        learned l = region_make(&m);
        CHECK(mcs_region_pays(l.g, &s.r) == cases[i].hidden, "case %d, no rays", i);
        add_rays_to_all(&l, 1, 1);
        add_rays_to_all(&l, 1, 0);
        CHECK(mcs_region_pays(l.g, &s.r) == cases[i].hidden, "case %d, half the rays through", i);
        mcs_region_add_ray(l.g, 0, 1);
        CHECK(l.g->through == 513 && l.g->rays == 1025, "%g of %g rays", (double)l.g->through, (double)l.g->rays);
        CHECK(mcs_region_pays(l.g, &s.r) == cases[i].open, "case %d, more through", i);
        region_free(&l);
    }
    scene_free(&m);
}

/* ---- tables ---- */

/* Light of a tile, its mean direction, shorter than 1, and how far its corners lie from that. */
typedef struct {
    double light, mean[3], radius;
} bundle;
static bundle bundle_of(const scene *m, uint32_t tile) {
    const box b = tile_box(m, tile);
    bundle t = {0, {0, 0, 0}, 0};
    double v[3];
    for (uint32_t r = b.r0; r < b.r1; r++)
        for (uint32_t c = b.c0; c < b.c1; c++) {
            const double light = weight_of(m, c, r) * m->area[r];
            to3(v, point(m->w, m->h, c, r, 0.5, 0.5));
            t.light += light;
            for (int k = 0; k < 3; k++) t.mean[k] += light * v[k];
        }
    for (int k = 0; k < 3 && t.light > 0; k++) t.mean[k] /= t.light;
    for (int i = 0; i < 4; i++) {
        double away = 0;
        to3(v, point(m->w, m->h, i & 1 ? b.c1 : b.c0, i & 2 ? b.r1 : b.r0, 0, 0));
        for (int k = 0; k < 3; k++) away += pow(v[k] - t.mean[k] / sqrt(dot3(t.mean, t.mean)), 2);
        t.radius = fmax(t.radius, sqrt(away));
    }
    return t;
}
/* The root mean square over white matte surfaces, with the ten-thousandth that each value has got; -1 where a tile
 * straddles a horizon or has no light, and is not known. */
static double rms_of(const bundle *t, const surface *s, int surfaces) {
    double sum = 0;
    for (int i = 0; i < surfaces && t->light > 0; i++) {
        const double c = dot3(s[i].n, t->mean);
        if (fabs(c) < t->radius + 1e-5) return -1;
        if (c > 0) sum += pow((c + 1e-4) / pi, 2);
    }
    return t->light > 0 ? sqrt(sum / fmax(surfaces, 1)) : -1;
}
/* Every tile weighs what part I says, but for those that are not known. The even part is a sixth of all: with S the mean
 * of the weights over the light that is seen, m/5 = (S - m/5)/5. */
static void check_weights(const scene *m, const surface *s, int surfaces, const learned *l, const learned *up) {
    sampler d = table_of(m, s, l, up);
    double *part = tile_masses(&d);
    const uint32_t n = count_of(m);
    double seen = 0;
    double all = 0;
    for (uint32_t k = 0; k < n; k++) {
        seen += bundle_of(m, k).light * visibility_of(l->g, up ? up->g : NULL, k);
        all += part[k];
    }
    const double even = surfaces ? all / seen / 6 : 0;
    double factor = 0; /* of a weight over what it should be: one for all */
    int known = 0;
    int low = 0;
    for (uint32_t k = 0; k < n; k++) {
        const bundle t = bundle_of(m, k);
        const double rms = surfaces ? rms_of(&t, s, surfaces) : 1;
        if (!(t.light > 0 && (rms > 0.05 || rms == 0))) continue;
        const double value = part[k] / (t.light * visibility_of(l->g, up ? up->g : NULL, k));
        if (rms > 0.05 && !(factor > 0)) factor = (value - even) / rms;
        const double want = even + factor * rms;
        known += rms > 0.05;
        low += rms == 0;
        /* Shares are integers over 2^24 of a row, and of rows; columns and rows of the map over 2^31. */
        if (factor > 0 || rms == 0)
            CHECK(fabs(value - want) <= (2e-4 + 8 * 0x1p-24 / part[k]) * value, "tile %u: %g, not %g", k, value, want);
    }
    CHECK(known > 100 && (surfaces != 1 || low > 100), "%d tiles known, %d below", known, low);
    free(part);
    sampler_free(&d);
}
static void test_weights(void) {
    mcst_group("region, weights of tiles");
    for (int i = 0; i < 16; i++) {
        const int surfaces = i % 4;
        if (!mcst_case("%d surfaces%s%s", surfaces, i & 4 ? ", rays" : "", i & 8 ? ", a region above" : "")) continue;
        scene m = scene_make(i % 3 ? ROOM : SMOOTH, 96, 64, i & 1 ? 32 : 16);
        learned l = region_make(&m);
        learned up = region_make(&m);
        surface s[3];
        for (int k = 0; k < 3; k++)
            s[k] = surface_make(normals[(i + 2 * k) % NORMALS], local_wo(0.5, 0.1 * k), lobes[0]);
        for (int k = 0; k < surfaces; k++) add_point(&l, &m, &s[k]);
        if (i & 4) add_rays(&l, 8 * count_of(&m), 30);
        add_rays(&up, 4 * count_of(&m), 60);
        check_weights(&m, s, surfaces, &l, i & 8 ? &up : NULL);
        region_free(&l);
        region_free(&up);
        scene_free(&m);
    }
}
/* The table of one point goes with the reflection of that point, lobes wider by 0.005. */
static void check_one_point(const lobe *of, int hidden) {
    scene m = scene_make(ROOM, 96, 64, 16);
    const surface s = surface_make(normals[4], local_wo(0.7, 0.1), *of);
    const uint32_t n = count_of(&m);
    learned l = region_make(&m);
    add_point(&l, &m, &s);
    add_rays(&l, 4000, 30);
    if (hidden) add_rays_to_all(&l, 100, 0);
    sampler d = table_of(&m, &s, &l, NULL);
    double *part = tile_masses(&d);
    float *value = (float *)memory(n * sizeof *value);
    mcsi_surface wide = mcsi_surface_make(env_of(&m), &s.r);
    wide.ax2 += 0.005f;
    wide.ay2 += 0.005f;
    mcsi_tile_values_n(&wide, n, MCSI_READ(float, tiles_of(&m), mcsi_tiles_offsets_of(tiles_of(&m)).light), value);
    double seen = 0;
    double reflected = 0;
    for (uint32_t k = 0; k < n; k++) {
        const double light = bundle_of(&m, k).light * visibility_of(l.g, NULL, k);
        seen += light;
        reflected += light * (double)value[k];
    }
    for (uint32_t k = 0; k < n; k++) {
        const double light = bundle_of(&m, k).light * visibility_of(l.g, NULL, k);
        const double want = light * ((double)value[k] + 0.2 * reflected / seen) / (1.2 * reflected);
        CHECK(fabs(part[k] - want) <= 1e-3 * want + 16 * 0x1p-24, "tile %u: %g, not %g", k, part[k], want);
    }
    free(part);
    free(value);
    sampler_free(&d);
    region_free(&l);
    scene_free(&m);
}

/* What part I has of samples of the BRDF, in tiles of which there are 512, for tables of little and of much reach. And
 * the reach itself, where f is 1. */
static void check_share(void) {
    static const struct {
        float alpha_x, alpha_y, matte;
        float little, much;
    } cases[] = {{1, 1, 1, 0.125f, 0.125f},
                 {0.01f, 0.01f, 1, 0.125f, 0.125f},
                 {0.01f, 0.01f, 0.99f, 1, 1},
                 {0.354f, 0.354f, 0, 0.125f, 0.125f},
                 {0.354f, 0.353f, 0, 1, 1},
                 {0.353f, 0.354f, 0, 1, 1},
                 {0.5f, 0.4f, 0.5f, 0.125f, 0.125f},
                 {0.1f, 0.157f, 0, 1, 1},
                 {0.1f, 0.156f, 0, 0, 1},
                 {0.156f, 0.1f, 0, 0, 1},
                 {0.0443f, 0.0443f, 0, 0, 1},
                 {0.0441f, 0.0441f, 0, 0, 0},
                 {1, 0.001f, 0, 0, 0},
                 {NAN, NAN, NAN, 0, 0}};
    scene m = scene_make(ROOM, 64, 32, 16);
    const surface s = surface_make(normals[4], local_wo(0.5, 0.1), lobes[2]);
    const uint32_t n = count_of(&m);
    for (int much = 0; much < 2; much++) {
        learned l = region_make(&m);
        for (uint32_t k = 0; k < 40 * n; k++) mcs_region_add_ray(l.g, k % n, !much || k % n < n / 4);
        sampler d = table_of(&m, &s, &l, NULL);
        double light = 0;
        double through = 0;
        double twice = 0;
        for (uint32_t k = 0; k < n; k++) {
            const double v = visibility_of(l.g, NULL, k);
            const double of_tile = bundle_of(&m, k).light;
            light += of_tile;
            through += of_tile * v;
            twice += of_tile * v * v;
        }
        const double reach = light * twice / (through * through);
        CHECK((reach > 2.5) == much && fabs((double)d.p->reach - reach) <= 1e-3 * reach, "reach %g, not %g",
              (double)d.p->reach, reach);
        for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
            mcs_reflection r = s.r;
            r.alpha_x = cases[i].alpha_x;
            r.alpha_y = cases[i].alpha_y;
            r.matte = cases[i].matte;
            const float share = mcs_region_share(d.p, &r);
            CHECK(share == (much ? cases[i].much : cases[i].little), "case %d, reach %g: %g", i, reach, (double)share);
        }
        mcs_reflection small = s.r;
        small.alpha_x = small.alpha_y = 0.1f;
        d.p->reach = 2.5f;
        CHECK(mcs_region_share(d.p, &small) == 1, "reach 2.5");
        sampler_free(&d);
        region_free(&l);
    }
    scene_free(&m);
}

/* A product that is built with a region has the same values, of light that is dimmed by V. */
static void check_dimmed(const lobe *of) {
    scene m = scene_make(ROOM, 96, 64, 16);
    const surface s = surface_make(normals[4], local_wo(0.7, 0.1), *of);
    learned l = region_make(&m);
    add_rays(&l, 4000, 30);
    sampler d = sampler_make(&m, &s);
    d.p->brdf_share = 0;
    double *open = tile_masses(&d);
    CHECK(mcs_product_build(d.p, d.mem.bytes, tiles_of(&m), env_of(&m), &s.r, l.g) == MCS_OK && arena_intact(&d.mem),
          "product with a region");
    CHECK(d.p->brdf_share == (s.r.matte < 1 ? 0.1f : 0.0f), "share %g", (double)d.p->brdf_share);
    d.p->brdf_share = 0;
    double *dimmed = tile_masses(&d);
    double all = 0;
    for (uint32_t k = 0; k < count_of(&m); k++) all += open[k] * visibility_of(l.g, NULL, k);
    for (uint32_t k = 0; k < count_of(&m); k++) {
        const double want = open[k] * visibility_of(l.g, NULL, k) / all;
        CHECK(fabs(dimmed[k] - want) <= 1e-3 * want + 32 * 0x1p-24, "tile %u: %g, not %g", k, dimmed[k], want);
    }
    free(open);
    free(dimmed);
    sampler_free(&d);
    region_free(&l);
    scene_free(&m);
}

/* ---- what holds of every table: density where light is, and one in all; draws after it ---- */

static void check_table(const sampler *d, mcs_pcg32 *rng, double tests) {
    const scene *m = d->m;
    const uint32_t n = m->w * m->h;
    const int count = (int)(20000 * scale()) + CHUNK;
    static float u1[CHUNK], u2[CHUNK], x[CHUNK], y[CHUNK], z[CHUNK], pdf[CHUNK];
    double *expected = texel_masses(d);
    double *observed = (double *)memory(n * sizeof *observed);
    double sum = 0;
    uint32_t bad = 0;
    int lost = 0;
    for (uint32_t k = 0; k < n; k++) {
        observed[k] = 0;
        bad += (expected[k] > 0) != (m->light[k] > 0);
        sum += expected[k];
    }
    CHECK(bad == 0, "%u texels that can be drawn and should not, or the other way", bad);
    CHECK(fabs(sum - 1) <= 1e-5, "the density integrates to %g", sum);
    int drawn;
    for (drawn = 0; drawn < count; drawn += CHUNK) {
        fill(rng, CHUNK, u1, u2);
        mcs_product_sample_n(d->p, tiles_of(m), env_of(m), CHUNK, u1, u2, x, y, z, pdf, NULL, NULL);
        for (int k = 0; k < CHUNK; k++) {
            mcs_vec3 w;
            w.x = x[k];
            w.y = y[k];
            w.z = z[k];
            lost += !(pdf[k] > 0);
            observed[texel_number(m, w)] += 1;
        }
    }
    for (uint32_t k = 0; k < n; k++) expected[k] *= drawn / sum;
    double stat;
    int dof;
    const double p = chi2_test(observed, expected, n, &stat, &dof);
    CHECK(lost == 0 && (p >= sidak(level, tests) || (isnan(p) && dof == 0)),
          "%d lost; p = %g, chi-square %g with %d degrees of freedom", lost, p, stat, dof);
    check_sane(d, 1);
    free(expected);
    free(observed);
}

enum { NO_RAYS, SOME_RAYS, ALL_HIDDEN, LIGHT_HIDDEN, ABOVE_HIDDEN, DECAYED, LESSONS };
static const char *const lesson_name[] = {
    "no rays",        "some rays", "nothing comes through", "the brightest hidden", "hidden in the region above",
    "all has decayed"};
/* Teaches a region, and the one above it. */
static void teach(int lesson, const scene *m, learned *l, learned *up) {
    if (lesson == SOME_RAYS) add_rays(l, 3000, 30);
    if (lesson == ALL_HIDDEN) add_rays_to_all(l, 500, 0);
    if (lesson == ABOVE_HIDDEN) add_rays_to_all(up, 500, 0);
    for (uint32_t k = 0; lesson == LIGHT_HIDDEN && k < count_of(m); k++)
        for (int i = 0; i < 30 && bundle_of(m, k).light > 0.05 * m->total; i++) mcs_region_add_ray(l->g, k, 0);
    for (int i = 0; lesson == DECAYED && i < 160; i++) mcs_region_decay(l->g, i % 2 ? 0.5f : 0.6f);
}

static void test_tables(void) {
    static const picture maps[] = {SMOOTH, SUN, NOISE, ONE_TEXEL, HALF, SPARSE, POLES};
    enum { MAPS = (int)(sizeof maps / sizeof *maps) };
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 75);
    mcst_group("region, tables");
    for (int i = 0; i < MAPS * LESSONS; i++) {
        const int lesson = i % LESSONS;
        if (!mcst_case("%s, %s", picture_name[maps[i / LESSONS]], lesson_name[lesson])) continue;
        scene m = scene_make(maps[i / LESSONS], i % 4 ? 64 : 50, i % 4 ? 32 : 25, i % 5 ? 16 : 64);
        learned l = region_make(&m);
        learned up = region_make(&m);
        surface s = surface_make(normals[0], local_wo(0.5, 0.1), lobes[0]);
        for (int k = 0; k < i % 7; k++) {
            s = surface_make(normals[(i + k) % NORMALS], local_wo(0.3 + 0.1 * k, 0.3 * k), lobes[(i * 5 + k) % LOBES]);
            add_point(&l, &m, &s);
        }
        teach(lesson, &m, &l, &up);
        sampler d = table_of(&m, &s, &l, &up);
        check_table(&d, &rng, MAPS * LESSONS);
        sampler_free(&d);
        region_free(&l);
        region_free(&up);
        scene_free(&m);
    }
}

/* The mean of what a surface reflects of all light, hidden or not, by a table or product that has learned that the
 * brightest is hidden. Four standard errors are 6e-5 for one; 1e-6 for the quadrature and the densities as floats. */
static void check_unbiased(picture kind, int of_point, uint64_t stream) {
    static float u1[CHUNK], u2[CHUNK];
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, stream);
    scene m = scene_make(kind, 64, 32, 16);
    const surface s = surface_make(normals[4], local_wo(0.7, 0.1), lobes[of_point ? 2 : 0]);
    learned l = region_make(&m);
    add_point(&l, &m, &s);
    teach(LIGHT_HIDDEN, &m, &l, NULL);
    sampler d = of_point ? sampler_make(&m, &s) : table_of(&m, &s, &l, NULL);
    if (of_point) CHECK(mcs_product_build(d.p, d.mem.bytes, tiles_of(&m), env_of(&m), &s.r, l.g) == MCS_OK, "no table");
    uint32_t first = 0;
    CHECK(unsupported(&d, 4, &first) == 0, "texel %u cannot be drawn", first);
    const double truth = true_light(&m, &s);
    double sum = 0;
    double sum2 = 0;
    int n = 0;
    while (n < 500000 * fmin(fmax(scale(), 0.2), 10)) {
        fill(&rng, CHUNK, u1, u2);
        for (int k = 0; k < CHUNK; k++, n++) {
            const mcs_texel t = draw(&d, u1[k], u2[k]);
            double visible;
            const double v =
                t.pdf > 0 ? m.light[t.row * m.w + t.col] * reflect(&s, t.w, &visible) / (double)t.pdf - truth : -truth;
            sum += v;
            sum2 += v * v;
        }
    }
    const double error = sqrt((sum2 - sum * sum / n) / n / (n - 1.0));
    CHECK(fabs(sum / n) <= 4 * error + 1e-6 * truth && error < 0.01 * truth, "mean %g with error %g, not %g",
          truth + sum / n, error, truth);
    sampler_free(&d);
    region_free(&l);
    scene_free(&m);
}

/* ---- memory ---- */

static void check_refused(void) {
    static const uint32_t wrong[] = {0, 1, 8, 15, 17, 24, 48, 65, 128, 0x80000000u, 0xffffffffu};
    scene m = scene_make(SUN, 64, 32, 16);
    const mcs_tiles *t = tiles_of(&m);
    const mcs_env *e = env_of(&m);
    arena a = arena_make(mcs_region_bytes(16));
    arena b = arena_make(mcs_product_table_bytes(16));
    mcs_region *g = (mcs_region *)(void *)a.at;
    mcs_product *p = (mcs_product *)(void *)b.at;
    learned l = region_make(&m);
    CHECK(mcs_region_start(g, a.bytes - 1, t) == MCS_ERR_MEMORY, "one byte too few");
    CHECK(mcs_region_start(NULL, a.bytes, t) == MCS_ERR_ARG && mcs_region_start(g, a.bytes, NULL) == MCS_ERR_ARG,
          "NULL");
    CHECK(mcs_region_start((mcs_region *)(void *)(a.at + 2), a.bytes, t) == MCS_ERR_ARG, "misaligned");
    CHECK(mcs_product_build_region(p, b.bytes - 1, t, e, l.g) == MCS_ERR_MEMORY, "one byte too few");
    CHECK(mcs_product_build_region(NULL, b.bytes, t, e, l.g) == MCS_ERR_ARG &&
              mcs_product_build_region(p, b.bytes, NULL, e, l.g) == MCS_ERR_ARG &&
              mcs_product_build_region(p, b.bytes, t, NULL, l.g) == MCS_ERR_ARG &&
              mcs_product_build_region(p, b.bytes, t, e, NULL) == MCS_ERR_ARG,
          "NULL");
    CHECK(mcs_product_build_region((mcs_product *)(void *)(b.at + 2), b.bytes, t, e, l.g) == MCS_ERR_ARG, "misaligned");
    arena c = arena_make(mcs_product_bytes(16));
    const surface s = surface_make(normals[4], local_wo(0.5, 0.1), lobes[2]);
    scene finer = scene_make(SUN, 64, 32, 32);
    learned other = region_make(&finer);
    CHECK(mcs_product_build_region(p, b.bytes, t, e, other.g) == MCS_ERR_SIZE &&
              mcs_product_build((mcs_product *)(void *)c.at, c.bytes, t, e, &s.r, other.g) == MCS_ERR_SIZE,
          "a region of more rows");
    CHECK(arena_intact(&b) && arena_intact(&c) && untouched(c.at, c.bytes), "a region of more rows, yet wrote");
    CHECK(untouched(a.at, a.bytes) && untouched(b.at, b.bytes), "refused arguments, yet wrote");
    for (int i = 0; i < (int)(sizeof wrong / sizeof *wrong); i++) {
        mcs_tiles bad = *t;
        bad.rows = wrong[i];
        l.g->rows = wrong[i];
        CHECK(mcs_region_start(g, 0, &bad) == MCS_ERR_SIZE && mcs_region_start(g, a.bytes, &bad) == MCS_ERR_SIZE,
              "a region for %u rows", wrong[i]);
        CHECK(mcs_product_build_region(p, b.bytes, &bad, e, l.g) == MCS_ERR_SIZE &&
                  mcs_product_build_weights(p, 0, &bad, e, &s.r.matte) == MCS_ERR_SIZE &&
                  mcs_product_build(p, b.bytes, &bad, e, &s.r, NULL) == MCS_ERR_SIZE,
              "a product for %u rows", wrong[i]);
        CHECK(untouched(a.at, a.bytes) && untouched(b.at, b.bytes), "%u rows, yet wrote", wrong[i]);
        CHECK(mcs_region_bytes(wrong[i]) == 0 && mcs_product_table_bytes(wrong[i]) == 0, "%u rows", wrong[i]);
    }
    CHECK(mcs_region_bytes(16) == 8208 && mcs_region_bytes(32) == 16 + 16 * 2048 &&
              mcs_region_bytes(64) == 16 + 16 * 8192,
          "bytes of regions");
    CHECK(MCS_PRODUCT_BYTES(16) == mcs_product_bytes(16) && MCS_PRODUCT_BYTES(64) == mcs_product_bytes(64) &&
              mcs_product_table_bytes(64) < mcs_product_bytes(64),
          "bytes of products");
    CHECK(MCSI_ALIGN < 7 || (mcs_product_bytes(16) == 18592 && mcs_product_table_bytes(16) == 6688 &&
                             mcs_product_bytes(64) == 150496 && mcs_product_table_bytes(64) == 99808),
          "bytes of products, as part I has them where a double is aligned to 8");
    region_free(&l);
    region_free(&other);
    arena_free(&a);
    arena_free(&b);
    arena_free(&c);
    scene_free(&m);
    scene_free(&finer);
}
/* The same bytes whatever the memory held: of a region, of its table, of a product with it. */
static void check_same_bytes(void) {
    for (uint32_t rows = 16; rows <= 64; rows *= 2) {
        scene m = scene_make(SPARSE, 50, 37, rows);
        const surface s = surface_make(normals[4], local_wo(0.6, 0.2), lobes[4]);
        const size_t bytes[3] = {mcs_region_bytes(rows), mcs_product_table_bytes(rows), mcs_product_bytes(rows)};
        arena a[ARENA_PASTS][3];
        for (int past = 0; past < ARENA_PASTS; past++) {
            for (int k = 0; k < 3; k++) {
                a[past][k] = arena_make(bytes[k]);
                arena_past(&a[past][k], past);
            }
            learned l;
            l.mem = a[past][0];
            l.g = (mcs_region *)(void *)l.mem.at;
            int rc = mcs_region_start(l.g, bytes[0], tiles_of(&m));
            add_point(&l, &m, &s);
            add_rays(&l, 2000, 30);
            rc |=
                mcs_product_build_region((mcs_product *)(void *)a[past][1].at, bytes[1], tiles_of(&m), env_of(&m), l.g);
            rc |=
                mcs_product_build((mcs_product *)(void *)a[past][2].at, bytes[2], tiles_of(&m), env_of(&m), &s.r, l.g);
            CHECK(rc == MCS_OK, "%u rows: refused", rows);
        }
        for (int past = 0; past < ARENA_PASTS; past++)
            for (int k = 0; k < 3; k++)
                CHECK(arena_differ(&a[0][k], &a[past][k]) == bytes[k] && arena_intact(&a[past][k]),
                      "%u rows: byte %zu of %d is another one", rows, arena_differ(&a[0][k], &a[past][k]), k);
        for (int past = 0; past < ARENA_PASTS; past++)
            for (int k = 0; k < 3; k++) arena_free(&a[past][k]);
        scene_free(&m);
    }
}

/* ---- which tile ---- */

static void check_tile_of(picture kind, uint32_t w, uint32_t h, uint32_t rows) {
    scene m = scene_make(kind, w, h, rows);
    const mcs_frame f = mcs_frame_make(vec(0.48, -0.6, 0.64));
    const mcs_tiles *t = tiles_of(&m);
    const uint32_t n = count_of(&m);
    for (int turned = 0; turned < 2; turned++) {
        if (turned) ((mcs_env *)(void *)m.env.at)->frame = f;
        const mcs_env *e = env_of(&m);
        for (uint32_t k = 0; k < w * h; k++) {
            const uint32_t want = tile_at(&m, k % w, k / w);
            const mcs_vec3 v =
                point(w, h, k % w, k / w, (double)hash01(k, 70) * 0.98 + 0.01, (double)hash01(k, 71) * 0.98 + 0.01);
            const uint32_t by_direction = mcs_tiles_of_direction(t, e, turned ? mcs_to_world(&f, v) : v);
            CHECK(mcs_tiles_of_texel(t, e, k % w, k / w) == want && by_direction == want,
                  "texel %u: tile %u, by direction %u, not %u", k, mcs_tiles_of_texel(t, e, k % w, k / w), by_direction,
                  want);
        }
        for (uint32_t k = 0; k < 200; k++) {
            const mcs_texel x = mcs_env_sample(e, hash01(k, 72), hash01(k, 73));
            CHECK(mcs_tiles_of_texel(t, e, x.col, x.row) == mcs_tiles_of_direction(t, e, x.w), "draw %u", k);
        }
        for (int k = 0; k < BAD_W; k++) CHECK(mcs_tiles_of_direction(t, e, bad_w[k]) == n, "a bad direction");
        CHECK(mcs_tiles_of_texel(t, e, w, 0) == n && mcs_tiles_of_texel(t, e, 0, h) == n &&
                  mcs_tiles_of_texel(t, e, UINT32_MAX, UINT32_MAX) == n,
              "outside the map");
    }
    scene_free(&m);
}

/* ---- arrays ---- */

enum { MOST = 100 };
/* Draws and densities, those of draws and of any directions, bad ones among them; the densities also over x, y or z. */
static void check_array(const sampler *d, int n, uint32_t stream) {
    float u1[MOST], u2[MOST], v[4][MOST], to[3][MOST];
    uint32_t col[MOST], row[MOST];
    for (int i = 0; i < n; i++) {
        u1[i] = i % 13 == 5 ? bad_u[i % BAD] : hash01((uint32_t)i, stream);
        u2[i] = i % 17 == 7 ? bad_u[i % BAD] : hash01((uint32_t)i, stream + 1);
    }
    mcs_product_sample_n(d->p, tiles_of(d->m), env_of(d->m), (size_t)n, u1, u2, v[0], v[1], v[2], v[3], col, row);
    for (int i = 0; i < n; i++) {
        const mcs_texel t = {{v[0][i], v[1][i], v[2][i]}, v[3][i], col[i], row[i]};
        CHECK(same_draw(d, draw(d, u1[i], u2[i]), t), "n = %d, entry %d: not that of sample(%a, %a)", n, i,
              (double)u1[i], (double)u2[i]);
        const mcs_vec3 w = i % 11 == 3 ? bad_w[i % BAD_W] : i % 2 ? t.w : mcs_sphere_sample(u1[i], u2[i]).w;
        to[0][i] = w.x;
        to[1][i] = w.y;
        to[2][i] = w.z;
    }
    for (int over = 0; over < 4; over++) {
        memcpy(v, to, sizeof to);
        mcs_product_pdf_n(d->p, tiles_of(d->m), env_of(d->m), (size_t)n, v[0], v[1], v[2], v[over]);
        for (int i = 0; i < n; i++) {
            const mcs_vec3 w = {to[0][i], to[1][i], to[2][i]};
            const float want = mcs_product_pdf(d->p, tiles_of(d->m), env_of(d->m), w);
            CHECK(mcst_arrays_contract() ? v[over][i] >= 0 && v[over][i] <= FLT_MAX : !memcmp(&v[over][i], &want, 4),
                  "n = %d, entry %d, over %d: density %a, not %a", n, i, over, (double)v[over][i], (double)want);
        }
    }
}
/* One texel with light below the map's equator: a surface that faces away from it still sees the pole, which is what
 * draws get that are lost. */
static scene low_light(uint32_t rows) {
    float *light = (float *)memory(50 * 32 * sizeof *light);
    for (int k = 0; k < 50 * 32; k++) light[k] = k == 21 * 50 + 16 ? 5.0f : 0.0f;
    return scene_from("low light", 50, 32, light, rows);
}
static void test_arrays(void) {
    /* lobe, its share, and whether light is below the surface: then nothing has a density */
    static const struct {
        lobe l;
        double least, most;
        picture kind;
        int below;
    } cases[] = {{{"alpha 0.5", 0.5f, 0.5f, 0, MCS_PROFILE_GGX}, 0, 0, SUN, 0},
                 {{"alpha 0.03", 0.03f, 0.03f, 0, MCS_PROFILE_GGX}, 1e-3, 0.1, ROOM, 0},
                 {{"alpha 0.02", 0.02f, 0.02f, 0.5f, MCS_PROFILE_GGX}, 1e-3, 0.1, HALF, 0},
                 {{"alpha 0.001", 1e-3f, 1e-3f, 0, MCS_PROFILE_GGX}, 0.949, 0.951, SUN, 0},
                 {{"Gauss 0.1", 0.11f, 0.11f, 0, MCS_PROFILE_GAUSS}, 1e-3, 0.1, SPARSE, 0},
                 {{"Gauss 0.003", 3e-3f, 3e-3f, 0, MCS_PROFILE_GAUSS}, 0.949, 0.951, SUN, 0},
                 {{"Phong", 0.11f, 0.11f, 0, MCS_PROFILE_PHONG}, 1e-4, 1e-3, POLES, 0},
                 {{"Phong", 3e-3f, 3e-3f, 0, MCS_PROFILE_PHONG}, 0.949, 0.951, SUN, 0},
                 {{"A.-S. 163, 10", 0.11f, 0.41f, 0, MCS_PROFILE_ASHIKHMIN}, 1e-4, 0.1, SPARSE, 0},
                 {{"A.-S. 222220", 3e-3f, 3e-3f, 0, MCS_PROFILE_ASHIKHMIN}, 0.949, 0.951, SUN, 0},
                 {{"alpha 0.001, light below", 1e-3f, 1e-3f, 0, MCS_PROFILE_GGX}, 0, 0, ONE_TEXEL, 1},
                 {{"alpha 0.5, light below", 0.5f, 0.5f, 0, MCS_PROFILE_GGX}, 0, 0, ONE_TEXEL, 1},
                 {{"alpha 0.01, black", 0.01f, 0.01f, 0, MCS_PROFILE_GGX}, 0.2, 0.951, BLACK_MAP, 0}};
    static const int counts[] = {0, 1, 7, 31, 32, 33, 100};
    mcst_group("arrays of products");
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++)
        for (int kind = 0; kind < 3; kind++) {
            static const char *const kind_name[] = {"", ", the eye below", ", of a region"};
            if (!mcst_case("%s, %s%s", cases[i].l.name, picture_name[cases[i].kind], kind_name[kind])) continue;
            const uint32_t rows = i % 2 ? 32 : 16;
            scene m = cases[i].below ? low_light(rows) : scene_make(cases[i].kind, 50, 32, rows);
            const mcs_vec3 to = point(50, 32, 16, 21, 0.5, 0.5);
            surface s = surface_make(cases[i].below ? vec(-(double)to.x, -(double)to.y, -(double)to.z) : normals[4],
                                     local_wo(0.5, 0.1), cases[i].l);
            if (kind == 1) s.r.wo.z = -s.r.wo.z;
            learned l = region_make(&m);
            add_point(&l, &m, &s);
            sampler d = kind == 2 ? table_of(&m, &s, &l, NULL) : sampler_make(&m, &s);
            if (kind == 0)
                CHECK(d.share >= cases[i].least && d.share <= cases[i].most && d.dark == cases[i].below,
                      "share %g, dark %d", d.share, d.dark);
            for (int k = 0; k < (int)(sizeof counts / sizeof *counts); k++)
                for (uint32_t round = 0; round < 4; round++) check_array(&d, counts[k], 80 + 2 * round);
            sampler_free(&d);
            region_free(&l);
            scene_free(&m);
        }
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("region, what it has learned");
    if (mcst_case("visibility")) check_visibility();
    if (mcst_case("a full count")) check_full();
    if (mcst_case("inherited")) check_inherit();
    if (mcst_case("what is ignored")) check_ignored();
    if (mcst_case("merge")) check_merge();
    if (mcst_case("decay")) check_decay();
    if (mcst_case("whether it pays")) check_pays();
    if (mcst_case("samples of the BRDF")) check_share();
    test_weights();
    mcst_group("region, one point");
    for (int i = 0; i < 8; i++) {
        static const int of[] = {0, 1, 2, 10};
        if (mcst_case("%s%s", lobes[of[i / 2]].name, i % 2 ? ", hidden" : ""))
            check_one_point(&lobes[of[i / 2]], i % 2);
    }
    for (int i = 0; i < 2; i++)
        if (mcst_case("%s, dimmed", lobes[i].name)) check_dimmed(&lobes[i]);
    test_tables();
    mcst_group("region, means");
    for (int i = 0; i < 4; i++)
        if (mcst_case("%s, %s", i % 2 ? "room" : "sun", i / 2 ? "product" : "table"))
            check_unbiased(i % 2 ? ROOM : SUN, i / 2, 90 + (uint64_t)i);
    mcst_group("region, memory");
    if (mcst_case("refused arguments")) check_refused();
    if (mcst_case("the same bytes")) check_same_bytes();
    mcst_group("tiles of texels and directions");
    for (uint32_t rows = 16; rows <= 64; rows *= 2)
        for (int i = 0; i < 5; i++) {
            static const uint32_t size[][2] = {{64, 32}, {50, 25}, {7, 5}, {1, 1}, {200, 131}};
            if (mcst_case("%u x %u, %u rows", size[i][0], size[i][1], rows))
                check_tile_of(i % 2 ? NOISE : SMOOTH, size[i][0], size[i][1], rows);
        }
    test_arrays();
    return mcst_finish();
}
