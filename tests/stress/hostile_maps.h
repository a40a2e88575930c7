/* Environment maps, windows, tiles and products of random sizes from hostile pictures, and damaged files. A part of
 * hostile.c. */
#ifndef HOSTILE_MAPS_H
#define HOSTILE_MAPS_H
#include "hostile_tally.h"

/* An image in memory of exactly its span; `bad` of its texels are bad. Guards and gaps between texels would be bad,
 * too. */
typedef struct {
    arena m;
    mcs_image im;
    uint32_t bad;
} picture;

static const float *texel_at(const mcs_image *im, uint32_t x, uint32_t y) {
    const ptrdiff_t step = im->pixel_stride ? im->pixel_stride : (ptrdiff_t)im->channels;
    return im->pixels + (ptrdiff_t)y * (im->row_stride ? im->row_stride : step * (ptrdiff_t)im->w) +
           (ptrdiff_t)x * step;
}
static double luminance(const mcs_image *im, uint32_t x, uint32_t y, int *bad) {
    const float *p = texel_at(im, x, y);
    const int n = im->channels > 1 ? 3 : 1;
    double c[3];
    int i;
    for (*bad = i = 0; i < n; i++) {
        *bad |= !(p[i] >= 0 && p[i] <= FLT_MAX);
        c[i] = (double)counted_as(p[i]);
    }
    return n == 1 ? c[0] : 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}
/* Weight of a texel: 1 lit, 0 black, -1 where rounding decides. Of a weight that is a sum of up to 27 floats each step
 * rounds by 2^-24 of it or, where it is subnormal, by 2^-150. */
static int texel_lit(const mcs_image *im, uint32_t x, uint32_t y) {
    const double floor = im->floor > 0 ? (double)im->floor : 0;
    double v = 0;
    int bad;
    if (im->bilinear) {
        for (int i = -1; i <= 1; i++)
            for (int j = -1; j <= 1; j++) {
                const uint32_t row = i < 0 && y > 0 ? y - 1 : i > 0 && y + 1 < im->h ? y + 1 : y;
                const uint32_t col = (uint32_t)((int)(x + im->w) + j) % im->w;
                v += (i ? 0.25 : 0.5) * (j ? 0.25 : 0.5) * luminance(im, col, row, &bad);
            }
    } else {
        v = luminance(im, x, y, &bad);
    }
    if (!(v > 0)) return 0;
    if (im->channels == 1 && !im->bilinear && !(floor > 0)) return 1;
    const double slack = 32 * (0x1p-24 * (v + floor) + 0x1p-150);
    return v > floor + slack ? 1 : v < floor - slack || floor > FLT_MAX ? 0 : -1;
}

static picture make_picture(uint64_t *state) {
    const uint64_t z = mcst_mix(state);
    const uint64_t y = mcst_mix(state);
    const uint64_t style = z % 9;
    const uint32_t w = z >> 8 & 7 ? 1 + (uint32_t)(z >> 16) % 70 : 1;
    const uint32_t h = z >> 11 & 7 ? 1 + (uint32_t)(z >> 24) % 40 : 1;
    const uint32_t channels = y & 1 ? 1 : 3 + (uint32_t)(y >> 1) % 3;
    const uint32_t step = channels + (y & 16 ? (uint32_t)(y >> 5) % 3 : 0);
    const uint32_t row = (w - 1) * step + channels + (y & 128 ? (uint32_t)(y >> 8) % 9 : step - channels);
    const size_t count = (size_t)(h - 1) * row + (size_t)(w - 1) * step + channels;
    const size_t giant = mcst_mix(state) % ((size_t)w * h);
    picture p;
    float *f;
    p.m = arena_make(count * sizeof *f);
    p.bad = 0;
    f = (float *)(void *)p.m.at;
    p.im = mcs_image_make(f, w, h, channels);
    p.im.bilinear = (y >> 16 & 1) != 0;
    if (step != channels || y >> 17 & 1) p.im.pixel_stride = (ptrdiff_t)step;
    if (y >> 18 & 1) {
        p.im.row_stride = -(ptrdiff_t)row;
        p.im.pixels = f + (size_t)(h - 1) * row;
    } else if (row != w * step || y >> 19 & 1) {
        p.im.row_stride = (ptrdiff_t)row;
    }
    const float level = mcs_u01((uint32_t)mcst_mix(state));
    for (uint32_t j = 0; j < h; j++)
        for (uint32_t i = 0; i < w; i++) {
            float *at = (float *)(uintptr_t)texel_at(&p.im, i, j);
            const int inside = i >= w / 3 && i <= w / 2 && j >= h / 3 && j <= h / 2;
            for (uint32_t c = 0; c < channels; c++) {
                const uint64_t r = mcst_mix(state);
                const float u = (float)(r >> 40);
                switch (style) {
                case 0: at[c] = st_hostile(r); break;
                case 1: at[c] = r & 31 ? u : st_hostile(r >> 5); break;
                case 2: at[c] = 0; break;
                case 3: at[c] = (size_t)j * w + i == giant ? 1e30f : 0; break;
                case 4: at[c] = st_float((uint32_t)(r >> 32) & 0x007fffffu); break;
                case 5: at[c] = r & 1 ? FLT_MAX : 0x1p-149f; break;
                case 6: at[c] = level; break;
                case 7: at[c] = inside ? u : 0; break;
                default: at[c] = u; break;
                }
            }
            int bad;
            (void)luminance(&p.im, i, j, &bad);
            p.bad += (uint32_t)bad;
        }
    if (y >> 20 & 1) p.im.floor = y >> 21 & 1 ? mcs_env_mean(&p.im) : st_hostile(mcst_mix(state));
    return p;
}

static float hostile_u(uint64_t *state) {
    const uint64_t z = mcst_mix(state);
    return z & 7 ? (float)(z >> 40) * 0x1p-24f : st_hostile(z >> 3);
}
static int good_u(float u) { return u >= 0 && u < 1; }
static mcs_vec3 hostile_direction(uint64_t *state) {
    const float u1 = mcs_u01((uint32_t)mcst_mix(state));
    const float u2 = mcs_u01((uint32_t)mcst_mix(state));
    const uint64_t z = mcst_mix(state);
    mcs_vec3 w = mcs_sphere_sample(u1, u2).w;
    if ((z & 3) == 0) w.x = st_hostile(mcst_mix(state));
    if ((z & 12) == 0) w.y = st_hostile(mcst_mix(state));
    if ((z & 48) == 0) w.z = st_hostile(mcst_mix(state));
    return w;
}

/* What is drawn from: rows and columns of the map, wrapped; which texels may be found out where the picture is at hand.
 */
typedef struct {
    const mcs_env *e;
    const picture *p; /* NULL: any texel may be drawn */
    uint32_t row, rows, col, cols;
} part_of;

static int in_part(const part_of *q, uint32_t row, uint32_t col) {
    return row >= q->row && row - q->row < q->rows && (col + q->e->w - q->col) % q->e->w < q->cols;
}
/* A draw: `off` is how far the length may be from 1, negative where any finite direction will do. */
static void check_texel(const part_of *q, tally *t, mcs_texel s, int good, double off, const char *what) {
    const double l2 = (double)s.w.x * (double)s.w.x + (double)s.w.y * (double)s.w.y + (double)s.w.z * (double)s.w.z;
    const int sound = finite(t, s.w.x) & finite(t, s.w.y) & finite(t, s.w.z) & proper(t, s.pdf);
    const int unit = off < 0 || fabs(sqrt(l2) - 1) <= off;
    const int inside = s.row < q->e->h && s.col < q->e->w;
    t->not_unit += !unit;
    t->outside += !inside;
    t->not_discarded += !good && s.pdf != 0;
    CHECK(sound && unit && inside, "%s: w %a %a %a, pdf %a, texel %u %u of %u x %u", what, (double)s.w.x, (double)s.w.y,
          (double)s.w.z, (double)s.pdf, (unsigned)s.col, (unsigned)s.row, (unsigned)q->e->w, (unsigned)q->e->h);
    CHECK(good || s.pdf == 0, "%s: u is bad, but density %a", what, (double)s.pdf);
    if (!inside || !(s.pdf > 0)) return;
    CHECK(in_part(q, s.row, s.col), "%s: texel %u %u outside %u + %u, %u + %u", what, (unsigned)s.col, (unsigned)s.row,
          (unsigned)q->col, (unsigned)q->cols, (unsigned)q->row, (unsigned)q->rows);
    CHECK(!q->p || texel_lit(&q->p->im, s.col, s.row), "%s: texel %u %u of %u x %u is black, but drawn", what,
          (unsigned)s.col, (unsigned)s.row, (unsigned)q->e->w, (unsigned)q->e->h);
}

enum { DRAWS = 100 };

/* The k-th draw of check_map. */
static void check_draw(const part_of *q, const mcs_env_window *m, int axes, size_t k, uint64_t *state, tally *t) {
    const mcs_env *e = q->e;
    const float u1 = hostile_u(state);
    const float u2 = hostile_u(state);
    const int bits = !m && k % 4 == 0;
    const int good = bits || (good_u(u1) && good_u(u2));
    const uint32_t b1 = (uint32_t)mcst_mix(state);
    const uint32_t b2 = k % 8 ? (uint32_t)mcst_mix(state) : 0xffffffffu;
    const mcs_texel s = m      ? mcs_env_window_sample(m, e, u1, u2)
                        : bits ? mcs_env_sample_bits(e, b1, b2)
                               : mcs_env_sample(e, u1, u2);
    const mcs_vec3 w = hostile_direction(state);
    const int bad = st_direction_bad(w.x, w.y, w.z);
    const mcs_texel a = mcs_env_texel(e, w);
    const mcs_texel own = mcs_env_texel(e, s.w);
    const float here = m ? mcs_env_window_pdf(m, e, s.w) : own.pdf;
    const float there = m ? mcs_env_window_pdf(m, e, w) : a.pdf;
    const float weight = mcs_env_weight(e, there);
    const mcs_vec2 back = mcs_env_invert(e, k & 1 ? w : s.w);
    check_texel(q, t, s, good, axes ? st_map_off : -1, m ? "window" : "map");
    CHECK(!good || !axes || s.pdf > 0, "u %a %a: density 0 at its own sample", (double)u1, (double)u2);
    CHECK(!good || !axes || (here == s.pdf && own.row == s.row && own.col == s.col),
          "u %a %a, bits %08x %08x, %u x %u: pdf %a, %a of its direction; texel %u %u, %u %u", (double)u1, (double)u2,
          (unsigned)(bits ? b1 : 0), (unsigned)(bits ? b2 : 0), (unsigned)e->w, (unsigned)e->h, (double)s.pdf,
          (double)here, (unsigned)s.col, (unsigned)s.row, (unsigned)own.col, (unsigned)own.row);
    CHECK(proper(t, here) && proper(t, there) && a.row < e->h && a.col < e->w, "pdf %a and, of %a %a %a, %a",
          (double)here, (double)w.x, (double)w.y, (double)w.z, (double)there);
    CHECK(!axes || bad != 1 || there == 0, "%a %a %a is bad, but density %a", (double)w.x, (double)w.y, (double)w.z,
          (double)there);
    if (axes && bad == 0) {
        const int lit = q->p ? texel_lit(&q->p->im, a.col, a.row) : 1;
        const int due = in_part(q, a.row, a.col) ? lit : 0;
        CHECK(due < 0 || (there > 0) == due, "%a %a %a in texel %u %u, lit %d: pdf %a", (double)w.x, (double)w.y,
              (double)w.z, (unsigned)a.col, (unsigned)a.row, due, (double)there);
    }
    CHECK(finite(t, weight) && weight >= 0, "weight %a of density %a", (double)weight, (double)there);
    CHECK(below_one(t, back.x) && below_one(t, back.y), "invert %a %a", (double)back.x, (double)back.y);
}

/* Draws and densities of a map or, where m is given, of a window; with the axes as frame pdf and texel of a draw are
 * its own. */
static void check_map(const part_of *q, const mcs_env_window *m, int axes, uint64_t *state, tally *t) {
    const mcs_env *e = q->e;
    const size_t count = mcst_mix(state) % 70;
    arena in = arena_make(2 * count * sizeof(float));
    arena out = arena_make(4 * count * sizeof(float));
    float *u = (float *)(void *)in.at;
    float *x = (float *)(void *)out.at;
    float *y = x + count;
    float *z = y + count;
    float *pdf = z + count;
    for (size_t k = 0; k < DRAWS; k++) check_draw(q, m, axes, k, state, t);
    for (size_t k = 0; k < 2 * count; k++) u[k] = hostile_u(state);
    if (m) mcs_env_window_sample_n(m, e, count, u, u + count, x, y, z, pdf, NULL, NULL);
    else mcs_env_sample_n(e, count, u, u + count, x, y, z, pdf, NULL, NULL);
    for (size_t k = 0; k < count; k++) {
        const mcs_texel s = m ? mcs_env_window_sample(m, e, u[k], u[count + k]) : mcs_env_sample(e, u[k], u[count + k]);
        CHECK(finite(t, x[k]) && finite(t, y[k]) && finite(t, z[k]) && pdf[k] == s.pdf,
              "array: u %a %a, w %a %a %a, pdf %a, not %a", (double)u[k], (double)u[count + k], (double)x[k],
              (double)y[k], (double)z[k], (double)pdf[k], (double)s.pdf);
        if (mcst_mix(state) & 1) x[k] = st_hostile(mcst_mix(state));
    }
    mcs_env_pdf_n(e, count, x, y, z, pdf);
    for (size_t k = 0; k < count; k++) CHECK(proper(t, pdf[k]), "array: pdf %a", (double)pdf[k]);
    CHECK(arena_intact(&in) && arena_intact(&out), "arrays of %u: written outside", (unsigned)count);
    arena_free(&in);
    arena_free(&out);
    t->evaluations += DRAWS * (m ? 6 : 4) + (double)count * 3;
}

static void check_window(const picture *p, const mcs_env *e, uint64_t *state, tally *t) {
    const uint64_t z = mcst_mix(state);
    const uint64_t wild = mcst_mix(state);
    const uint32_t row = (uint32_t)z % e->h;
    const uint32_t rows = 1 + (uint32_t)(z >> 16) % (e->h - row);
    const uint32_t col = (uint32_t)(z >> 32) % e->w;
    const uint32_t cols = 1 + (uint32_t)(z >> 48) % e->w;
    const size_t bytes = mcs_env_window_bytes(rows);
    arena m = arena_make(bytes);
    mcs_env_window *at = (mcs_env_window *)(void *)m.at;
    int some = 0;
    int none = 1;
    mcs_status s = mcs_env_window_build(at, bytes - 1, e, row, rows, col, cols);
    CHECK(s == MCS_ERR_MEMORY && untouched(m.at, bytes), "%u rows, a byte too few: %d", (unsigned)rows, (int)s);
    s = mcs_env_window_build(at, bytes, e, e->h - row, row + 1 + (uint32_t)wild % 9, col, cols);
    CHECK(s == MCS_ERR_SIZE && untouched(m.at, bytes), "rows beyond the map: %d", (int)s);
    s = mcs_env_window_build(at, bytes, e, row, rows, col, e->w + 1 + (uint32_t)(wild >> 32) / 2);
    CHECK(s == MCS_ERR_SIZE && untouched(m.at, bytes), "columns beyond the map: %d", (int)s);
    s = mcs_env_window_build(at, bytes, e, row, rows, col, cols);
    for (uint32_t i = row; i < row + rows; i++)
        for (uint32_t j = 0; j < cols; j++) {
            const int lit = texel_lit(&p->im, (col + j) % e->w, i);
            some |= lit == 1;
            none &= lit == 0;
        }
    const int black = at->uniform && !(e->uniform && e->total > 0);
    CHECK(s == MCS_OK && (!some || !black) && (!none || black), "window %u + %u, %u + %u of %u x %u: status %d",
          (unsigned)col, (unsigned)cols, (unsigned)row, (unsigned)rows, (unsigned)e->w, (unsigned)e->h, (int)s);
    part_of q;
    q.e = e;
    q.p = black ? NULL : p;
    q.row = row;
    q.rows = rows;
    q.col = col;
    q.cols = cols;
    check_map(&q, at, 1, state, t);
    CHECK(arena_intact(&m), "window of %u rows: written outside", (unsigned)rows);
    arena_free(&m);
}

/* A reflection; `sane`: unit directions and a frame to go with them. */
static mcs_reflection make_reflection(uint64_t *state, int *sane) {
    const uint64_t z = mcst_mix(state);
    const float a = mcs_u01((uint32_t)mcst_mix(state));
    const float b = mcs_u01((uint32_t)mcst_mix(state));
    mcs_reflection r;
    r.frame = mcs_frame_make(mcs_sphere_sample(a, b).w);
    r.wo = mcs_hemisphere_sample(b, a).w;
    r.alpha_x = z & 1 ? a : 1e-3f * a;
    r.alpha_y = z & 2 ? b : 1e-3f * b;
    r.matte = z & 4 ? b : (float)(z >> 3 & 1);
    r.profile = (mcs_profile)(z >> 60 & 3);
    *sane = r.wo.z > 0;
    if (z & 16) return r;
    float *slot[15];
    slot[0] = &r.frame.s.x;
    slot[1] = &r.frame.s.y;
    slot[2] = &r.frame.s.z;
    slot[3] = &r.frame.t.x;
    slot[4] = &r.frame.t.y;
    slot[5] = &r.frame.t.z;
    slot[6] = &r.frame.n.x;
    slot[7] = &r.frame.n.y;
    slot[8] = &r.frame.n.z;
    slot[9] = &r.wo.x;
    slot[10] = &r.wo.y;
    slot[11] = &r.wo.z;
    slot[12] = &r.alpha_x;
    slot[13] = &r.alpha_y;
    slot[14] = &r.matte;
    for (int i = 0; i < 15; i++)
        if ((z >> (20 + 2 * i) & (z & 32 ? 3 : 1)) == 0) {
            *slot[i] = st_hostile(mcst_mix(state));
            *sane &= i > 11;
        }
    return r;
}

static void check_draw_of_product(const part_of *q, const mcs_product *p, const mcs_tiles *tiles, int sane,
                                  uint64_t *state, tally *t) {
    /* own lobe: |wi| 4 ulp, a frame that is orthonormal to 4 ulp of 2^-23 in 3 ways, three rounded terms each: 34 2^-24
     */
    const double lobe_off = 0x1p-18;
    part_of all = *q;
    all.p = NULL;
    const float u1 = hostile_u(state);
    const float u2 = hostile_u(state);
    const int good = good_u(u1) && good_u(u2);
    const int tiled = !(p->brdf_share > 0);
    const mcs_vec3 w = hostile_direction(state);
    const mcs_texel a = mcs_product_sample(p, tiles, q->e, u1, u2);
    const float back = mcs_product_pdf(p, tiles, q->e, a.w);
    const float there = mcs_product_pdf(p, tiles, q->e, w);
    check_texel(tiled ? q : &all, t, a, good, tiled ? st_map_off : sane ? lobe_off : -1, "product");
    CHECK(proper(t, back) && proper(t, there), "pdf %a %a", (double)back, (double)there);
    CHECK(!(a.pdf > 0) || back > 0, "product: pdf %a, 0 of its direction", (double)a.pdf);
    if (st_direction_bad(w.x, w.y, w.z) == 1)
        CHECK(there == 0, "%a %a %a is bad, but a density of %a", (double)w.x, (double)w.y, (double)w.z, (double)there);
}

static void check_arrays_of_product(const part_of *q, const mcs_product *p, const mcs_tiles *tiles, uint64_t *state,
                                    size_t count, tally *t) {
    arena in = arena_make(2 * count * sizeof(float));
    arena out = arena_make(4 * count * sizeof(float));
    float *u = (float *)(void *)in.at;
    float *x = (float *)(void *)out.at;
    float *y = x + count;
    float *z = y + count;
    float *pdf = z + count;
    for (size_t k = 0; k < 2 * count; k++) u[k] = hostile_u(state);
    mcs_product_sample_n(p, tiles, q->e, count, u, u + count, x, y, z, pdf, NULL, NULL);
    for (size_t k = 0; k < count; k++) {
        const mcs_texel one = mcs_product_sample(p, tiles, q->e, u[k], u[count + k]);
        CHECK(finite(t, x[k]) && finite(t, y[k]) && finite(t, z[k]) && proper(t, pdf[k]),
              "array: u %a %a, w %a %a %a, pdf %a", (double)u[k], (double)u[count + k], (double)x[k], (double)y[k],
              (double)z[k], (double)pdf[k]);
        CHECK((pdf[k] > 0) == (one.pdf > 0), "array: u %a %a, pdf %a, not %a", (double)u[k], (double)u[count + k],
              (double)pdf[k], (double)one.pdf);
    }
    for (size_t k = 0; k < count; k++)
        if (mcst_mix(state) & 1) x[k] = st_hostile(mcst_mix(state));
    mcs_product_pdf_n(p, tiles, q->e, count, x, y, z, pdf);
    for (size_t k = 0; k < count; k++) {
        const mcs_vec3 w = {x[k], y[k], z[k]};
        CHECK(proper(t, pdf[k]) && (pdf[k] > 0) == (mcs_product_pdf(p, tiles, q->e, w) > 0),
              "array: density %a of %a %a %a, not %a", (double)pdf[k], (double)w.x, (double)w.y, (double)w.z,
              (double)mcs_product_pdf(p, tiles, q->e, w));
    }
    CHECK(arena_intact(&in) && arena_intact(&out), "product, arrays: written outside");
    arena_free(&in);
    arena_free(&out);
}

/* A region that has learned of hostile surfaces and rays, and V of it. */
static void teach_region(const part_of *q, const mcs_tiles *tiles, mcs_region *g, uint64_t *state, tally *t) {
    int sane;
    for (int i = 0; i < 40; i++) {
        const uint64_t z = mcst_mix(state);
        if (z % 8 == 0) {
            const mcs_reflection r = make_reflection(state, &sane);
            mcs_region_add_point(g, tiles, q->e, &r);
            CHECK((mcs_region_pays(g, &r) & ~1) == 0, "pays %d", mcs_region_pays(g, &r));
        } else if (z % 64 == 1) {
            mcs_region_decay(g, st_hostile(mcst_mix(state)));
        } else if (z % 64 == 2) {
            mcs_region_merge(g, g);
        } else if (z % 64 == 3) {
            mcs_region_inherit(g, g);
        } else {
            mcs_region_add_ray(g, (uint32_t)(z >> 32), (int)(z >> 8 & 1));
            mcs_region_add_ray(g, (uint32_t)(z >> 32) % 512, (int)(z >> 8 & 1));
        }
        const float v = mcs_region_visibility(g, (uint32_t)(z >> 40) % 600);
        CHECK(finite(t, v) && v >= 0 && v <= 1, "V %a", (double)v);
        const uint32_t k = mcs_tiles_of_direction(tiles, q->e, hostile_direction(state));
        CHECK(k <= 512, "tile %u", (unsigned)k);
    }
}

/* Draws of a product, of a reflection, a region or weights. */
static void check_product(const part_of *q, const mcs_tiles *tiles, uint64_t *state, tally *t) {
    const size_t bytes = mcs_product_bytes(tiles->rows);
    const size_t n = (size_t)tiles->rows * tiles->cols;
    const size_t count = mcst_mix(state) % 70;
    const int kind = (int)(mcst_mix(state) % 4);
    arena m = arena_make(bytes);
    arena list = arena_make(n * sizeof(float));
    arena region = arena_make(mcs_region_bytes(tiles->rows));
    mcs_region *g = (mcs_region *)(void *)region.at;
    float *weight = (float *)(void *)list.at;
    mcs_product *p = (mcs_product *)(void *)m.at;
    int sane;
    const mcs_reflection r = make_reflection(state, &sane);
    mcs_status s = mcs_product_build(p, bytes - 1, tiles, q->e, &r, NULL);
    CHECK(s == MCS_ERR_MEMORY && untouched(m.at, bytes), "product, a byte too few: %d", (int)s);
    for (size_t k = 0; k < n; k++) {
        const mcs_vec3 w = mcs_tiles_direction(tiles, q->e, (uint32_t)k);
        CHECK(finite(t, w.x) && finite(t, w.y) && finite(t, w.z), "tile %u: direction %a %a %a", (unsigned)k,
              (double)w.x, (double)w.y, (double)w.z);
        weight[k] = st_hostile(mcst_mix(state));
    }
    CHECK(mcs_region_start(g, region.bytes, tiles) == MCS_OK, "region");
    teach_region(q, tiles, g, state, t);
    s = kind == 0   ? mcs_product_build_weights(p, bytes, tiles, q->e, weight)
        : kind == 1 ? mcs_product_build_region(p, bytes, tiles, q->e, g)
                    : mcs_product_build(p, bytes, tiles, q->e, &r, kind == 2 ? g : NULL);
    CHECK(s == MCS_OK && arena_intact(&m) && (kind != 1 || !p->dark), "product: status %d", (int)s);
    const float share = mcs_region_share(p, &r);
    CHECK(share == 0 || share == 0.125f || share == 1, "share %a", (double)share);
    CHECK(p->reach >= 0 && p->reach <= (kind == 1 ? 1.001e4f : 0), "reach %a", (double)p->reach);
    if (mcst_mix(state) % 4 == 0) p->brdf_share = 0; /* as the header allows */
    for (size_t k = 0; k < DRAWS; k++) check_draw_of_product(q, p, tiles, sane, state, t);
    check_arrays_of_product(q, p, tiles, state, count, t);
    CHECK(arena_intact(&m) && arena_intact(&list) && arena_intact(&region), "product: written outside");
    arena_free(&m);
    arena_free(&list);
    arena_free(&region);
    t->evaluations += DRAWS * 3 + (double)count * 2 + (double)n;
}

static void check_tiles(const part_of *q, uint64_t *state, tally *t) {
    const size_t bytes = mcs_tiles_bytes(q->e, 16);
    arena m = arena_make(bytes);
    mcs_tiles *tiles = (mcs_tiles *)(void *)m.at;
    mcs_status s = mcs_tiles_build(tiles, bytes - 1, q->e, 16);
    CHECK(s == MCS_ERR_MEMORY && untouched(m.at, bytes), "tiles, a byte too few: %d", (int)s);
    s = mcs_tiles_build(tiles, bytes, q->e, 16 + (uint32_t)(mcst_mix(state) % 16) + 1);
    CHECK(s == MCS_ERR_SIZE || s == MCS_ERR_MEMORY, "tiles of a wrong number of rows: %d", (int)s);
    s = mcs_tiles_build(tiles, bytes, q->e, 16);
    CHECK(s == MCS_OK && arena_intact(&m), "tiles: status %d", (int)s);
    for (int k = 0; k < 4; k++) check_product(q, tiles, state, t);
    CHECK(arena_intact(&m), "tiles: written outside");
    arena_free(&m);
}

/* Some bytes of a table changed: what mcs_env_check lets pass is drawn from inside the map and its memory. */
static void check_damage(const arena *map, uint64_t *state, tally *t) {
    const int changes = 1 + (int)(mcst_mix(state) % 3);
    arena m = arena_make(map->bytes);
    mcs_env *e = (mcs_env *)(void *)m.at;
    const size_t less = mcst_mix(state) % map->bytes;
    memcpy(m.at, map->at, map->bytes);
    mcs_status s = mcs_env_check(e, less);
    CHECK(s == MCS_ERR_MEMORY, "%u of %u bytes: %d", (unsigned)less, (unsigned)map->bytes, (int)s);
    for (int i = 0; i < changes; i++) {
        const uint64_t z = mcst_mix(state);
        const size_t reach = z & 1                        ? map->bytes
                             : z & 2                      ? sizeof *e
                             : 2 * sizeof *e < map->bytes ? 2 * sizeof *e
                                                          : map->bytes;
        m.at[(z >> 16) % reach] ^= (unsigned char)(z & 4 ? 1u << (z >> 8 & 7) : z >> 8);
    }
    s = mcs_env_check(e, map->bytes);
    CHECK(s == MCS_OK || s == MCS_ERR_FORMAT || s == MCS_ERR_MEMORY, "damaged: %d", (int)s);
    for (int i = 0; s == MCS_OK && i < DRAWS; i++) {
        const mcs_texel a = mcs_env_sample(e, hostile_u(state), hostile_u(state));
        const mcs_texel b = mcs_env_sample_bits(e, (uint32_t)mcst_mix(state), (uint32_t)mcst_mix(state));
        const mcs_texel c = mcs_env_texel(e, i & 1 ? hostile_direction(state) : a.w);
        const mcs_vec2 back = mcs_env_invert(e, i & 1 ? b.w : a.w);
        const int inside = a.row < e->h && a.col < e->w && b.row < e->h && b.col < e->w && c.row < e->h && c.col < e->w;
        t->outside += !inside;
        CHECK(inside, "damaged: texels %u %u, %u %u, %u %u of %u x %u", (unsigned)a.col, (unsigned)a.row,
              (unsigned)b.col, (unsigned)b.row, (unsigned)c.col, (unsigned)c.row, (unsigned)e->w, (unsigned)e->h);
        CHECK(proper(t, a.pdf) && proper(t, b.pdf) && proper(t, c.pdf), "damaged: pdf %a %a %a", (double)a.pdf,
              (double)b.pdf, (double)c.pdf);
        CHECK(below_one(t, back.x) && below_one(t, back.y), "damaged: invert %a %a", (double)back.x, (double)back.y);
        t->evaluations += 4;
    }
    CHECK(arena_intact(&m), "damaged: written outside");
    arena_free(&m);
}

/* What mcs_env_build refuses, it leaves alone. */
static void check_refused(const picture *p, const arena *m, uint64_t *state) {
    mcs_env *e = (mcs_env *)(void *)m->at;
    const size_t bytes = m->bytes;
    mcs_image wrong = p->im;
    mcs_status s = mcs_env_build(e, bytes - 1, &p->im);
    CHECK(s == MCS_ERR_MEMORY && untouched(m->at, bytes), "%u x %u, a byte too few: %d", (unsigned)p->im.w,
          (unsigned)p->im.h, (int)s);
    wrong.channels = 2;
    s = mcs_env_build(e, bytes, &wrong);
    CHECK(s == MCS_ERR_ARG && untouched(m->at, bytes), "2 channels: %d", (int)s);
    wrong = p->im;
    wrong.pixel_stride = PTRDIFF_MAX >> mcst_mix(state) % 8;
    wrong.row_stride = PTRDIFF_MIN;
    s = mcs_env_build(e, bytes, &wrong);
    CHECK(s == MCS_ERR_SIZE && untouched(m->at, bytes), "strides beyond memory: %d", (int)s);
}

static void check_env(int tiled, uint64_t *state, tally *t) {
    picture p = make_picture(state);
    const size_t bytes = mcs_env_bytes(p.im.w, p.im.h);
    arena m = arena_make(bytes);
    arena parts = arena_make(bytes);
    arena copy = arena_make(p.m.bytes);
    mcs_env *e = (mcs_env *)(void *)m.at;
    mcs_env *other = (mcs_env *)(void *)parts.at;
    const uint32_t cut = (uint32_t)mcst_mix(state) % (p.im.h + 1);
    const float mean = mcs_env_mean(&p.im);
    int some = 0;
    int none = 1;
    memcpy(copy.at, p.m.at, p.m.bytes);
    CHECK(finite(t, mean) && mean >= 0, "mean %a", (double)mean);
    check_refused(&p, &m, state);
    const mcs_status s = mcs_env_build(e, bytes, &p.im);
    CHECK(arena_intact(&m) && arena_intact(&p.m) && !memcmp(copy.at, p.m.at, p.m.bytes), "%u x %u: written outside",
          (unsigned)p.im.w, (unsigned)p.im.h);
    for (uint32_t i = 0; i < p.im.h; i++)
        for (uint32_t j = 0; j < p.im.w; j++) {
            const int lit = texel_lit(&p.im, j, i);
            some |= lit == 1;
            none &= lit == 0;
        }
    const int black = !(e->total > 0);
    CHECK(s == MCS_OK && (!some || !black) && (!none || black), "%u x %u: status %d", (unsigned)p.im.w,
          (unsigned)p.im.h, (int)s);
    CHECK(e->bad == p.bad, "%u bad texels, counted %u", (unsigned)p.bad, (unsigned)e->bad);
    CHECK(e->total >= 0 && e->total <= 1e300, "total %g", e->total);
    CHECK(mcs_env_check(e, bytes) == MCS_OK, "%u x %u: not a table: %d", (unsigned)p.im.w, (unsigned)p.im.h,
          (int)mcs_env_check(e, bytes));
    CHECK(mcs_env_build_rows(other, bytes, &p.im, cut, p.im.h) == MCS_OK &&
              mcs_env_build_rows(other, bytes, &p.im, 0, cut) == MCS_OK,
          "parts, cut at %u", (unsigned)cut);
    CHECK(mcs_env_build_rows(other, bytes, &p.im, cut, p.im.h + 1) == MCS_ERR_SIZE, "rows beyond the image");
    CHECK(mcs_env_finish(other, bytes, &p.im) == s && arena_intact(&parts) && !memcmp(m.at, parts.at, bytes),
          "%u x %u cut at %u", (unsigned)p.im.w, (unsigned)p.im.h, (unsigned)cut);
    part_of q;
    q.e = e;
    q.p = black ? NULL : &p;
    q.row = q.col = 0;
    q.rows = e->h;
    q.cols = e->w;
    check_map(&q, NULL, 1, state, t);
    for (int k = 0; k < 2; k++) check_window(&p, e, state, t);
    if (tiled) check_tiles(&q, state, t);
    for (int k = 0; k < 4; k++) check_damage(&m, state, t);
    e->frame = mcs_frame_make(hostile_direction(state));
    check_map(&q, NULL, 0, state, t);
    CHECK(arena_intact(&m) && arena_intact(&p.m), "%u x %u: written outside while drawing", (unsigned)p.im.w,
          (unsigned)p.im.h);
    arena_free(&m);
    arena_free(&parts);
    arena_free(&copy);
    arena_free(&p.m);
}

static void test_maps(double scale) {
    const long count[2] = {(long)fmax(100, 5e4 * scale), (long)fmax(20, 1e4 * scale)}; /* maps; maps with products */
    mcst_group("environment");
    for (int kind = 0; kind < 2; kind++) {
        tally t = nothing;
        if (!mcst_case(kind ? "products" : "maps")) continue;
        uint64_t state = mcst_seed_for("environment", kind ? "products" : "maps", 0);
        for (long k = 0; k < count[kind]; k++) check_env(kind, &state, &t);
        mcst_close_case();
        print_tally(kind ? "env, product" : "env", &t);
    }
}
#endif
