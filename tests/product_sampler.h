/* What the tests of products share: a product with what it was built from; its density over a tile's light, which is
 * piecewise bilinear, measured and known within bounds; what holds of every draw. */
#ifndef MCST_PRODUCT_SAMPLER_H
#define MCST_PRODUCT_SAMPLER_H
#include "product_scene.h"

/* ---- a product ---- */

enum { FINE = 7, FINE_TILES = 32 };
typedef struct {
    const scene *m;
    const surface *s;
    mcs_product *p;
    arena mem;
    double share;  /* of the lobe */
    int most_fine; /* so many tiles may have more than one part */
    mcs_status status;
    int dark; /* what the product says */
} sampler;

/* Built from weights where these are not NULL; then the surface places it. */
static inline sampler sampler_of(const scene *m, const surface *s, const float *weight) {
    sampler d;
    d.m = m;
    d.s = s;
    d.mem = arena_make(mcs_product_bytes(m->rows));
    d.p = (mcs_product *)(void *)d.mem.at;
    d.status = weight ? mcs_product_build_weights(d.p, d.mem.bytes, tiles_of(m), env_of(m), weight)
                      : mcs_product_build(d.p, d.mem.bytes, tiles_of(m), env_of(m), &s->r, NULL);
    CHECK(d.status == MCS_OK && arena_intact(&d.mem), "build returns %d, or wrote outside its %zu bytes", (int)d.status,
          d.mem.bytes);
    d.share = (double)d.p->brdf_share;
    d.dark = d.p->dark != 0;
    const int glossy = !weight && !(s->r.matte >= 1); /* not a number counts as 0 */
    CHECK(d.share >= 0 && d.share <= 0.95f && (glossy || !(d.share > 0)), "share %g", d.share);
    d.most_fine = glossy ? FINE_TILES : 0;
    return d;
}
static inline sampler sampler_make(const scene *m, const surface *s) { return sampler_of(m, s, NULL); }
static inline void sampler_free(sampler *d) { arena_free(&d->mem); }
static inline mcs_texel draw(const sampler *d, float u1, float u2) {
    return mcs_product_sample(d->p, tiles_of(d->m), env_of(d->m), u1, u2);
}
static inline double density(const sampler *d, mcs_vec3 w) {
    return (double)mcs_product_pdf(d->p, tiles_of(d->m), env_of(d->m), w);
}
/* What the tiles have of the density. */
static inline double tile_density(const sampler *d, mcs_vec3 w) {
    const float share = d->p->brdf_share;
    d->p->brdf_share = 0; /* as the header allows */
    const double alone = density(d, w);
    d->p->brdf_share = share;
    return (1 - d->share) * alone;
}

/* ---- places among a tile's light ---- */

/* Probabilities of rows and of columns are integers, once of the map and once of the tile's window (its rows): each
 * moves by one of rounding, its own one, and its share of those for all. Relative; of a row, of light in a row, of
 * places among a tile's rows. */
static inline double slack_of_row(const scene *m, uint32_t r) {
    return (2 * m->total / m->row_sum[r] + m->h) * quantum;
}
static inline double slack_of(const scene *m, double light, uint32_t r) {
    return (2 * m->row_sum[r] / (light * m->area[r]) + m->w) * quantum;
}
/* A texel's place among the light of its tile: t1 by columns within the row, t2 by rows, as where it begins and how
 * much it has. The light of the row, per area, and of the tile. */
typedef struct {
    double t1, part1, t2, part2, line, all;
} span;
static inline span span_of(const scene *m, uint32_t c, uint32_t r) {
    const box b = tile_box(m, tile_at(m, c, r));
    span s = {0, weight_of(m, c, r), 0, 0, 0, 0};
    for (uint32_t y = b.r0; y < b.r1; y++)
        for (uint32_t x = b.c0; x < b.c1; x++) {
            const double light = weight_of(m, x, y);
            s.all += light * m->area[y];
            if (y < r) s.t2 += light * m->area[y];
            if (y == r) s.line += light;
            if (y == r && x < c) s.t1 += light;
        }
    s.t1 /= s.line;
    s.part1 /= s.line;
    s.t2 /= s.all;
    s.part2 = s.line * m->area[r] / s.all;
    return s;
}
static inline double slack_of_tile(const scene *m, box b) {
    double most = 0;
    for (uint32_t r = b.r0; r < b.r1 && b.c0 < b.c1; r++) {
        const double light = span_of(m, b.c0, r).line;
        if (light > 0) most = fmax(most, 2 * (slack_of_row(m, r) + slack_of(m, light, r)));
    }
    return most;
}
typedef struct {
    double t1, t2;
} places;
/* Whether the direction at a place in a texel, 0 to 1 each way, lies in that texel however it was rounded: directions,
 * as floats, lie 2^-22 of the map's texels wrong. */
static inline int surely_in(const scene *m, places at) {
    return fmin(at.t1, 1 - at.t1) > m->w * 0x1p-22 && fmin(at.t2, 1 - at.t2) > m->h * 0x1p-22;
}
/* Where in a texel a direction in it lies, by its azimuth and by area: 0 to 1, but for rounding. */
static inline places place_in(const scene *m, uint32_t c, uint32_t r, mcs_vec3 w) {
    const double top = pow(sin(0.5 * pi * r / m->h), 2);
    const double height = pow(sin(0.5 * pi * (r + 1) / m->h), 2) - top;
    double col, row;
    texel_of(m->w, m->h, w, &col, &row);
    places in;
    in.t1 = col - c;
    in.t2 = (pow(sin(0.5 * pi * row / m->h), 2) - top) / height;
    if (fabs(in.t1 - 0.5) > 0.5 * m->w) in.t1 -= in.t1 > 0 ? m->w : -(double)m->w;
    return in;
}
/* What lies at (t1, t2) of a tile: a texel with its light and span, the place in it, and the direction. */
typedef struct {
    uint32_t c, r;
    double light;
    span s;
    places in;
    mcs_vec3 w;
} spot;
/* 0 for a black tile. */
static inline int spot_at(const scene *m, box b, double t1, double t2, spot *at) {
    for (at->r = b.r0; at->r < b.r1; at->r++)
        for (at->c = b.c0; at->c < b.c1; at->c++) {
            at->s = span_of(m, at->c, at->r);
            if (!(t1 < at->s.t1 + at->s.part1 && t2 < at->s.t2 + at->s.part2)) continue;
            at->light = weight_of(m, at->c, at->r);
            at->in.t1 = (t1 - at->s.t1) / at->s.part1;
            at->in.t2 = (t2 - at->s.t2) / at->s.part2;
            at->w = point(m->w, m->h, at->c, at->r, at->in.t1, at->in.t2);
            return 1;
        }
    return 0;
}

/* ---- the density within a tile ---- */

/* Density over light within a tile, as a function of the places (t1, t2): continuous, and bilinear in each of `parts`
 * by `parts` equal cells. Its nodes are at k / parts, those of one t1 together; `blur`: by how much a value may be
 * wrong. Nodes that are not known are looked at. */
typedef struct {
    double v, blur;
} node;
typedef struct {
    const sampler *d;
    uint32_t tile;
    box b;
    double slack; /* of places among its rows */
    int parts, known;
    node at[(FINE + 1) * (FINE + 1)];
} fit;

static inline fit fit_start(const sampler *d, uint32_t tile) {
    fit f;
    memset(&f, 0, sizeof f);
    f.d = d;
    f.tile = tile;
    f.b = tile_box(d->m, tile);
    f.slack = slack_of_tile(d->m, f.b);
    f.parts = 1;
    return f;
}
/* By how much places in a texel are off: directions, and probabilities that are integers. Relative slack of the density
 * in a texel. */
static inline places places_off(const fit *f, const span *s, uint32_t c, uint32_t r) {
    const scene *m = f->d->m;
    places off;
    off.t1 = s->part1 * m->w * 0x1p-22 + 2 * slack_of(m, weight_of(m, c, r) / s->part1, r);
    off.t2 = s->part2 * m->h * 0x1p-22 + f->slack;
    return off;
}
static inline double slack_in(const fit *f, uint32_t c, uint32_t r) {
    return slack_of_row(f->d->m, r) + slack_of(f->d->m, weight_of(f->d->m, c, r), r) + f->slack;
}
static inline const node *fit_node(const fit *f, int k1, int k2) { return f->at + k1 * (f->parts + 1) + k2; }
static inline int cell_of(int parts, double t) { return t > 0 ? (int)fmin(t * parts, parts - 1) : 0; }
static inline double fit_at(const fit *f, double t1, double t2) {
    const int i = cell_of(f->parts, t1);
    const int j = cell_of(f->parts, t2);
    const node *u = fit_node(f, i, j);
    const node *v = fit_node(f, i + 1, j);
    const double y = t2 * f->parts - j;
    const double a = u[0].v + y * (u[1].v - u[0].v);
    const double b = v[0].v + y * (v[1].v - v[0].v);
    return a + (t1 * f->parts - i) * (b - a);
}
/* Of the cells that a place may lie in: the largest value, what it may be wrong by, how steep it is. */
typedef struct {
    double top, blur, slope1, slope2;
} doubt;
static inline void doubt_add(doubt *d, const double *v, double blur, int parts) {
    for (int k = 0; k < 4; k++) d->top = fmax(d->top, fabs(v[k]));
    d->blur = fmax(d->blur, blur);
    d->slope1 = fmax(d->slope1, parts * fmax(fabs(v[2] - v[0]), fabs(v[3] - v[1])));
    d->slope2 = fmax(d->slope2, parts * fmax(fabs(v[1] - v[0]), fabs(v[3] - v[2])));
}
/* By how much it varies when places are off, and with 8 roundings on the way from nodes to a value. */
static inline double varies(const doubt *d, places off) {
    return d->slope1 * off.t1 + d->slope2 * off.t2 + 8 * eps * d->top;
}
/* Density over light at a place of a tile; `blur` is infinite where it might belong to another texel. 0: no light. */
typedef struct {
    double q, blur;
    places off;
} look;
static inline int look_at(const fit *f, double t1, double t2, look *l) {
    spot at;
    if (!spot_at(f->d->m, f->b, t1, t2, &at)) return 0;
    l->q = tile_density(f->d, at.w) / at.light;
    l->off = places_off(f, &at.s, at.c, at.r);
    l->blur = surely_in(f->d->m, at.in) ? l->q * slack_in(f, at.c, at.r) : INFINITY;
    return 1;
}
/* The nodes v of a cell, in the order of a fit, from four points at `in` and 1 - in of either side; of three choices
 * the first that is good. 0: no light. */
static inline int look_at_cell(const fit *f, int k1, int k2, double *v, double *blur) {
    static const double inset[] = {0.1, 0.2, 0.3};
    *blur = INFINITY;
    for (int i = 0; i < 3 && !(*blur < INFINITY); i++) {
        const double in = inset[i];
        const double x = in / (1 - 2 * in); /* out to the node, in units of what is between the points */
        double wrong = 0;
        places far = {0, 0};
        doubt o = {0, 0, 0, 0};
        look l[4];
        for (int k = 0; k < 4; k++) {
            if (!look_at(f, (k1 + (k & 2 ? 1 - in : in)) / f->parts, (k2 + (k & 1 ? 1 - in : in)) / f->parts, l + k))
                return 0;
            wrong = fmax(wrong, l[k].blur);
            far.t1 = fmax(far.t1, l[k].off.t1);
            far.t2 = fmax(far.t2, l[k].off.t2);
        }
        for (int k = 0; k < 4; k++)
            v[k] = (1 + x) * ((1 + x) * l[k].q - x * l[k ^ 1].q) - x * ((1 + x) * l[k ^ 2].q - x * l[k ^ 3].q);
        doubt_add(&o, v, 0, f->parts);
        *blur = (1 + 2 * x) * (1 + 2 * x) * (wrong + varies(&o, far));
    }
    return 1;
}
static inline doubt fit_doubt(const fit *f, double t1, double t2, places off) {
    const int i1 = cell_of(f->parts, t1 + off.t1);
    const int j1 = cell_of(f->parts, t2 + off.t2);
    doubt d = {0, 0, 0, 0};
    for (int i = cell_of(f->parts, t1 - off.t1); i <= i1; i++)
        for (int j = cell_of(f->parts, t2 - off.t2); j <= j1; j++) {
            double v[4];
            double blur = 0;
            if (!f->known && !look_at_cell(f, i, j, v, &blur)) continue;
            for (int k = 0; k < 4 && f->known; k++) {
                const node *n = fit_node(f, i + (k >> 1), j + (k & 1));
                v[k] = n->v;
                blur = fmax(blur, n->blur);
            }
            doubt_add(&d, v, blur, f->parts);
        }
    return d;
}
/* By how much sample may differ from the density at the direction it returns: the place that was drawn and that of the
 * direction lie 2^-21 of the map's texels apart (the margin at a texel's border is 2^-22 of them, a turn is found to
 * 2^-23, as floats are). Places are rounded to floats. */
static inline double apart(const sampler *d, mcs_texel t) {
    const scene *m = d->m;
    const double light = weight_of(m, t.col, t.row);
    if (!(light > 0)) return 4 * eps * (double)t.pdf;
    fit f = fit_start(d, tile_at(m, t.col, t.row));
    f.parts = d->most_fine ? FINE : 1; /* what is bilinear over the tile is so in its parts */
    const span s = span_of(m, t.col, t.row);
    const places in = place_in(m, t.col, t.row, t.w);
    const places off = {s.part1 * m->w * 0x1p-21 + 2 * eps, s.part2 * m->h * 0x1p-21 + 2 * eps};
    const doubt o = fit_doubt(&f, s.t1 + in.t1 * s.part1, s.t2 + in.t2 * s.part2, off);
    return (double)t.pdf * 4 * eps + light * varies(&o, off);
}
static inline int agrees(const sampler *d, mcs_texel t) { return fabs(density(d, t.w) - (double)t.pdf) <= apart(d, t); }

/* ---- what holds of every draw ---- */

/* Random numbers are drawn so many at a time. */
enum { CHUNK = 1000 };
static inline void fill(mcs_pcg32 *rng, size_t n, float *u1, float *u2) {
    mcs_pcg32_fill_n(rng, n, u1);
    mcs_pcg32_fill_n(rng, n, u2);
}
/* The texel that a direction lies in. */
static inline uint32_t texel_number(const scene *m, mcs_vec3 w) {
    double col, row;
    texel_of(m->w, m->h, w, &col, &row);
    return (uint32_t)fmin(row, m->h - 1) * m->w + (uint32_t)fmin(col, m->w - 1);
}
/* Number of texels with light above the horizon that cannot be drawn; `first` is one of them. A float direction is not
 * told from the horizon within eps. */
static inline int unsupported(const sampler *d, int sub, uint32_t *first) {
    const scene *m = d->m;
    int n = 0;
    for (uint32_t k = m->w * m->h; k-- > 0;) {
        const uint32_t c = k % m->w;
        const uint32_t r = k / m->w;
        if (!(m->light[k] > 0) || density(d, point(m->w, m->h, c, r, 0.5, 0.5)) > 0) continue;
        if (!(highest(m, d->s->n, c, r, sub) > 4 * eps)) continue;
        *first = k;
        n++;
    }
    return n;
}

/* A draw by array is that of sample. Where a*b + c is contracted the places of both differ by rounding, and with them
 * perhaps the texel: there its density has to be that of its direction. */
static inline int same_draw(const sampler *d, mcs_texel t, mcs_texel by_array) {
    if (!mcst_arrays_contract()) return !memcmp(&t, &by_array, sizeof t);
    const uint32_t k = texel_number(d->m, by_array.w);
    by_array.col = k % d->m->w;
    by_array.row = k / d->m->w;
    return (t.pdf > 0) == (by_array.pdf > 0) && (!(t.pdf > 0) || agrees(d, by_array));
}
static const float hard_u[] = {0.0f, 1.4e-45f, FLT_MIN, 0x1p-32f, 0x1p-24f, 0.25f, 0.5f, 0x0.fffffep0f, 0x0.ffffffp0f};
static const float bad_u[] = {-1.0f, -1e-9f, 1.0f, 2.0f, INFINITY, -INFINITY, NAN};
static const mcs_vec3 bad_w[] = {{0, 0, 0},        {NAN, 0, 1},       {0, NAN, 1}, {0, 0, NAN},
                                 {INFINITY, 0, 0}, {0, 0, -INFINITY}, {3, 0, 0},   {0, 0.4f, 0}};
enum {
    HARD = (int)(sizeof hard_u / sizeof *hard_u),
    BAD = (int)(sizeof bad_u / sizeof *bad_u),
    BAD_W = (int)(sizeof bad_w / sizeof *bad_w)
};

/* Finite, not negative, in the map; of unit length, where a lobe can be placed (`frame_ok`). */
static inline int sane(const mcs_texel *t, const scene *m, int frame_ok) {
    const double len = sqrt((double)t->w.x * t->w.x + (double)t->w.y * t->w.y + (double)t->w.z * t->w.z);
    return t->pdf >= 0 && t->pdf <= FLT_MAX && isfinite(t->w.x) && isfinite(t->w.y) && isfinite(t->w.z) &&
           (!frame_ok || fabs(len - 1) <= 8 * eps) && t->col < m->w && t->row < m->h;
}
/* Whatever the surface is: sample and density agree; bad u give 0. */
static inline void check_sane(const sampler *d, int frame_ok) {
    for (int i = 0; i < HARD * HARD + 40 + 2 * BAD; i++) {
        const int bad = i - HARD * HARD - 40;
        float u1 = i < HARD * HARD ? hard_u[i / HARD] : hash01((uint32_t)i, 11);
        float u2 = i < HARD * HARD ? hard_u[i % HARD] : hash01((uint32_t)i, 12);
        if (bad >= 0) *(bad % 2 ? &u1 : &u2) = bad_u[bad / 2];
        const mcs_texel t = draw(d, u1, u2);
        CHECK(sane(&t, d->m, frame_ok) && !(bad >= 0 && t.pdf > 0), "u = %a, %a: (%g, %g, %g), pdf %g", (double)u1,
              (double)u2, (double)t.w.x, (double)t.w.y, (double)t.w.z, (double)t.pdf);
        CHECK(!(t.pdf > 0) || agrees(d, t), "u = %a, %a: pdf %.8g, returned %.8g", (double)u1, (double)u2,
              density(d, t.w), (double)t.pdf);
    }
    for (int i = 0; i < BAD_W; i++)
        CHECK(density(d, bad_w[i]) == 0, "density of (%g, %g, %g): %g", (double)bad_w[i].x, (double)bad_w[i].y,
              (double)bad_w[i].z, density(d, bad_w[i]));
}
#endif
