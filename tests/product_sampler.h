/* What the tests of products share: a product with what it was built from; its density over a tile's light, which is
 * piecewise bilinear, measured and known within bounds; what holds of every draw. */
#ifndef MCST_PRODUCT_SAMPLER_H
#define MCST_PRODUCT_SAMPLER_H
#include "product_scene.h"

/* ---- places among a tile's light ---- */

/* The tile of a texel as the block comment has it: rows x 2 rows of them, column by column; and its texels. */
static inline uint32_t tile_at(const scene *m, uint32_t c, uint32_t r) {
    return (uint32_t)(((c + 1.0) * 2 * m->rows - 1) / m->w) * m->rows + (uint32_t)(((r + 1.0) * m->rows - 1) / m->h);
}
typedef struct {
    uint32_t r0, r1, c0, c1;
    const double *line;
} box;
static inline box tile_box(const scene *m, uint32_t tile) {
    const uint32_t i = tile % m->rows;
    const uint32_t j = tile / m->rows;
    box b;
    b.r0 = i * m->h / m->rows;
    b.r1 = (i + 1) * m->h / m->rows;
    b.c0 = j * m->w / (2 * m->rows);
    b.c1 = (j + 1) * m->w / (2 * m->rows);
    b.line = m->line + (size_t)j * m->h;
    return b;
}
/* Probabilities of rows and of columns are integers, once of the map and once of the tile's window (its rows): each
 * moves by one of rounding, its own one, and its share of those for all. Relative; of a row, of light in a row, of
 * places among a tile's rows. */
static inline double slack_of_row(const scene *m, uint32_t r) {
    return (2 * m->total / m->row_sum[r] + m->h) * quantum;
}
static inline double slack_of(const scene *m, double light, uint32_t r) {
    return (2 * m->row_sum[r] / (light * m->area[r]) + m->w) * quantum;
}
static inline double slack_of_tile(const scene *m, box b) {
    double most = 0;
    for (uint32_t r = b.r0; r < b.r1; r++) {
        if (b.line[r] > 0) most = fmax(most, 2 * (slack_of_row(m, r) + slack_of(m, b.line[r], r)));
    }
    return most;
}
/* A texel's place among the light of its tile: t1 by columns within the row, t2 by rows, as where it begins and how
 * much it has. */
typedef struct {
    double t1, part1, t2, part2, line;
} span;
static inline span span_of(const scene *m, uint32_t c, uint32_t r) {
    const box b = tile_box(m, tile_at(m, c, r));
    double all = 0;
    span s;
    memset(&s, 0, sizeof s);
    for (uint32_t k = b.r0; k < b.r1; k++) {
        const double row = b.line[k] * m->area[k];
        if (k < r) s.t2 += row;
        if (k == r) s.part2 = row;
        all += row;
    }
    s.t2 /= all;
    s.part2 /= all;
    s.line = b.line[r];
    for (uint32_t k = b.c0; k < c; k++) s.t1 += weight_of(m, k, r);
    s.t1 /= s.line;
    s.part1 = weight_of(m, c, r) / s.line;
    return s;
}
/* By how much places in a texel are off: directions, as floats, lie 2^-22 of the map's texels wrong; probabilities are
 * integers. */
typedef struct {
    double t1, t2;
} places;
static inline places places_off(const scene *m, const span *s, uint32_t r, double row_slack) {
    places off;
    off.t1 = s->part1 * m->w * 0x1p-22 + 2 * slack_of(m, s->line, r);
    off.t2 = s->part2 * m->h * 0x1p-22 + row_slack;
    return off;
}
/* Whether the direction at a place in a texel, 0 to 1 each way, lies in that texel however it was rounded. */
static inline int surely_in(const scene *m, double x, double y) {
    return fmin(x, 1 - x) > m->w * 0x1p-22 && fmin(y, 1 - y) > m->h * 0x1p-22;
}
/* The direction at (t1, t2) of a tile, its texel's row and span, and the light of that; 0 for a black tile. */
static inline double direction_at(const scene *m, box b, double t1, double t2, mcs_vec3 *w, uint32_t *row, span *s) {
    double all = 0;
    double part = 0;
    for (uint32_t r = b.r0; r < b.r1; r++) all += b.line[r] * m->area[r];
    if (!(all > 0)) return 0;
    memset(s, 0, sizeof *s);
    uint32_t r;
    for (r = b.r0; r < b.r1; r++, s->t2 += part) {
        part = b.line[r] * m->area[r] / all;
        if (t2 < s->t2 + part) break;
    }
    if (r == b.r1) return 0;
    *row = r;
    s->part2 = part;
    s->line = b.line[r];
    uint32_t c;
    for (c = b.c0; c + 1 < b.c1 && t1 >= s->t1 + weight_of(m, c, r) / s->line; c++)
        s->t1 += weight_of(m, c, r) / s->line;
    const double light = weight_of(m, c, r);
    s->part1 = light / s->line;
    *w = point(m->w, m->h, c, r, (t1 - s->t1) / s->part1, (t2 - s->t2) / part);
    return light;
}

/* ---- a product ---- */

/* Density over light within a tile, as a function of the places (t1, t2): continuous, and bilinear in each of `parts`
 * by `parts` equal cells. Its nodes are at k / parts, those of one t1 together; `blur`: by how much a value may be
 * wrong. */
enum { FINE = 7, FINE_TILES = 32 };
typedef struct {
    double v, blur;
} node;
typedef struct {
    int parts;
    node at[(FINE + 1) * (FINE + 1)];
} fit;
typedef struct {
    const scene *m;
    const surface *s;
    mcs_product *p;
    mcs_product *alone; /* the same with no share for the lobe */
    arena mem, mem_alone;
    double share;  /* of the lobe */
    int most_fine; /* so many tiles may have more than one part */
    mcs_status status;
    int dark; /* what the product says */
} sampler;

static inline void sampler_start(sampler *d, const scene *m, const surface *s) {
    memset(d, 0, sizeof *d);
    d->m = m;
    d->s = s;
    d->mem = arena_make(mcs_product_bytes(m->rows));
    d->mem_alone = arena_make(mcs_product_bytes(m->rows));
    d->p = (mcs_product *)(void *)d->mem.at;
    d->alone = (mcs_product *)(void *)d->mem_alone.at;
}
static inline void sampler_ready(sampler *d) {
    memcpy(d->mem_alone.at, d->mem.at, d->mem.bytes);
    d->share = (double)d->alone->brdf_share;
    d->alone->brdf_share = 0;
    d->dark = d->alone->dark != 0;
    CHECK(arena_intact(&d->mem), "wrote outside its %zu bytes", d->mem.bytes);
}
static inline sampler sampler_make(const scene *m, const surface *s) {
    sampler d;
    sampler_start(&d, m, s);
    d.status = mcs_product_build(d.p, d.mem.bytes, tiles_of(m), env_of(m), &s->r, NULL);
    sampler_ready(&d);
    CHECK(d.status == MCS_OK, "build returns %d", (int)d.status);
    CHECK(d.share >= 0 && d.share <= 0.95f && (!(s->r.matte >= 1) || !(d.share > 0)), "share %g", d.share);
    if (!(s->r.matte >= 1)) d.most_fine = FINE_TILES; /* not a number counts as 0 */
    return d;
}
static inline void sampler_free(sampler *d) {
    arena_free(&d->mem);
    arena_free(&d->mem_alone);
}
static inline mcs_texel draw(const sampler *d, float u1, float u2) {
    return mcs_product_sample(d->p, tiles_of(d->m), env_of(d->m), u1, u2);
}
static inline double density(const sampler *d, mcs_vec3 w) {
    return (double)mcs_product_pdf(d->p, tiles_of(d->m), env_of(d->m), w);
}
/* What the tiles have of the density. */
static inline double tile_density(const sampler *d, mcs_vec3 w) {
    return (1 - d->share) * (double)mcs_product_pdf(d->alone, tiles_of(d->m), env_of(d->m), w);
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
static inline doubt fit_doubt(const fit *f, double t1, double t2, places off) {
    const int i1 = cell_of(f->parts, t1 + off.t1);
    const int j1 = cell_of(f->parts, t2 + off.t2);
    doubt d = {0, 0, 0, 0};
    for (int i = cell_of(f->parts, t1 - off.t1); i <= i1; i++)
        for (int j = cell_of(f->parts, t2 - off.t2); j <= j1; j++) {
            const node *a = fit_node(f, i, j);
            const node *b = fit_node(f, i + 1, j);
            double v[4];
            v[0] = a[0].v;
            v[1] = a[1].v;
            v[2] = b[0].v;
            v[3] = b[1].v;
            doubt_add(&d, v, fmax(fmax(a[0].blur, a[1].blur), fmax(b[0].blur, b[1].blur)), f->parts);
        }
    return d;
}
/* Of a stretch of places, where in it cells begin and end: from 0 to 1, at most parts + 1 of them; the number of
 * pieces. */
static inline int fit_pieces(const fit *f, double t, double part, double *at) {
    int n = 0;
    at[0] = 0;
    for (int k = 1; k < f->parts; k++) {
        const double x = ((double)k / f->parts - t) / part;
        if (x > 0 && x < 1) at[++n] = x;
    }
    at[++n] = 1;
    return n;
}
/* Its mean over a texel, or with part1 = part2 = 1 the tile: of what is bilinear it is that of the middle. */
static inline double fit_mean(const fit *f, const span *s) {
    double sum = 0;
    double x[FINE + 1];
    const int n1 = fit_pieces(f, s->t1, s->part1, x);
    double y[FINE + 1];
    const int n2 = fit_pieces(f, s->t2, s->part2, y);
    for (int i = 0; i < n1; i++)
        for (int j = 0; j < n2; j++)
            sum += (x[i + 1] - x[i]) * (y[j + 1] - y[j]) *
                   fit_at(f, s->t1 + 0.5 * (x[i] + x[i + 1]) * s->part1, s->t2 + 0.5 * (y[j] + y[j + 1]) * s->part2);
    return sum;
}
/* Density over light at a place of a tile; `blur` is infinite where it might belong to another texel. */
typedef struct {
    double q, blur;
    places off;
} look;
static inline int look_at(const sampler *d, box b, double row_slack, double t1, double t2, look *l) {
    const scene *m = d->m;
    mcs_vec3 w;
    uint32_t r;
    span s;
    const double light = direction_at(m, b, t1, t2, &w, &r, &s);
    if (!(light > 0)) return 0;
    l->q = tile_density(d, w) / light;
    l->off = places_off(m, &s, r, row_slack);
    l->blur = l->q * (slack_of_row(m, r) + slack_of(m, light, r) + row_slack);
    if (!surely_in(m, (t1 - s.t1) / s.part1, (t2 - s.t2) / s.part2)) l->blur = INFINITY;
    return 1;
}
/* The nodes v of a cell, in the order of a fit, from four points at `in` and 1 - in of either side; of three choices
 * the first that is good. 0: no light. */
static inline int look_at_cell(const sampler *d, box b, double row_slack, int parts, int k1, int k2, double *v,
                               double *blur) {
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
            if (!look_at(d, b, row_slack, (k1 + (k & 2 ? 1 - in : in)) / parts, (k2 + (k & 1 ? 1 - in : in)) / parts,
                         l + k))
                return 0;
            wrong = fmax(wrong, l[k].blur);
            far.t1 = fmax(far.t1, l[k].off.t1);
            far.t2 = fmax(far.t2, l[k].off.t2);
        }
        double u[4];
        for (int k = 0; k < 4; k++)
            u[k] = (1 + x) * ((1 + x) * l[k].q - x * l[k ^ 1].q) - x * ((1 + x) * l[k ^ 2].q - x * l[k ^ 3].q);
        doubt_add(&o, u, 0, parts);
        *blur = (1 + 2 * x) * (1 + 2 * x) * (wrong + varies(&o, far));
        memcpy(v, u, sizeof u);
    }
    return 1;
}
/* Every node from the cell that knows it best. 0: no light. */
static inline int fit_parts(const sampler *d, uint32_t tile, double row_slack, int parts, fit *f) {
    const box b = tile_box(d->m, tile);
    memset(f, 0, sizeof *f);
    f->parts = parts;
    for (int k = 0; k < (parts + 1) * (parts + 1); k++) f->at[k].blur = INFINITY;
    for (int c = 0; c < parts * parts; c++) {
        const int k1 = c / parts;
        const int k2 = c % parts;
        double v[4], blur;
        if (!look_at_cell(d, b, row_slack, parts, k1, k2, v, &blur)) {
            memset(f, 0, sizeof *f);
            f->parts = 1;
            return 0;
        }
        CHECK(blur < INFINITY, "tile %u: cell (%d, %d) of %d parts cannot be known", tile, k1, k2, parts);
        for (int k = 0; k < 4; k++) {
            node *n = f->at + (k1 + (k >> 1)) * (parts + 1) + k2 + (k & 1);
            if (n->blur < INFINITY)
                CHECK(fabs(v[k] - n->v) <= blur + n->blur, "tile %u: cell (%d, %d) has %g at a node, another %g", tile,
                      k1, k2, v[k], n->v);
            if (!(blur >= n->blur)) {
                n->v = v[k];
                n->blur = blur;
            }
        }
    }
    return 1;
}
/* In one part, where no tile may have more, or if the middles of every other cell each way, one of which lies beside
 * every node, agree with that. */
static inline fit fit_tile(const sampler *d, uint32_t tile) {
    const box b = tile_box(d->m, tile);
    const double row_slack = slack_of_tile(d->m, b);
    fit f;
    if (!fit_parts(d, tile, row_slack, 1, &f) || !d->most_fine) return f;
    for (int k = 0; k < 16; k++) {
        const double t1 = (k / 4 * 2 + 0.5) / FINE;
        const double t2 = (k % 4 * 2 + 0.5) / FINE;
        look l;
        if (!look_at(d, b, row_slack, t1, t2, &l)) continue;
        const doubt o = fit_doubt(&f, t1, t2, l.off);
        if (fabs(l.q - fit_at(&f, t1, t2)) <= l.blur + o.blur + varies(&o, l.off)) continue;
        fit_parts(d, tile, row_slack, FINE, &f);
        break;
    }
    return f;
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
/* By how much sample may differ from the density at the direction it returns: the place that was drawn and that of the
 * direction lie 2^-21 of the map's texels apart (the margin at a texel's border is 2^-22 of them, a turn is found to
 * 2^-23, as floats are). Places are rounded to floats. */
static inline double apart(const sampler *d, mcs_texel t) {
    const scene *m = d->m;
    const box b = tile_box(m, tile_at(m, t.col, t.row));
    const double light = weight_of(m, t.col, t.row);
    const double row_slack = slack_of_tile(m, b);
    const int parts = d->most_fine ? FINE : 1; /* what is bilinear over the tile is so in its parts */
    doubt o = {0, 0, 0, 0};
    if (!(light > 0)) return 4 * eps * (double)t.pdf;
    const span s = span_of(m, t.col, t.row);
    places in = place_in(m, t.col, t.row, t.w);
    places off;
    off.t1 = s.part1 * m->w * 0x1p-21 + 2 * eps;
    off.t2 = s.part2 * m->h * 0x1p-21 + 2 * eps;
    in.t1 = s.t1 + in.t1 * s.part1;
    in.t2 = s.t2 + in.t2 * s.part2;
    const int i1 = cell_of(parts, in.t1 + off.t1);
    const int j1 = cell_of(parts, in.t2 + off.t2);
    for (int i = cell_of(parts, in.t1 - off.t1); i <= i1; i++)
        for (int j = cell_of(parts, in.t2 - off.t2); j <= j1; j++) {
            double v[4], blur;
            if (look_at_cell(d, b, row_slack, parts, i, j, v, &blur)) doubt_add(&o, v, blur, parts);
        }
    return (double)t.pdf * 4 * eps + light * varies(&o, off);
}
static inline int agrees(const sampler *d, mcs_texel t) { return fabs(density(d, t.w) - (double)t.pdf) <= apart(d, t); }
/* Random numbers are drawn so many at a time. */
enum { CHUNK = 1000 };
static inline void fill(mcs_pcg32 *rng, size_t n, float *u1, float *u2) {
    mcs_pcg32_fill_n(rng, n, u1);
    mcs_pcg32_fill_n(rng, n, u2);
}

/* A product from weights; sampler's surface places it. */
static inline sampler sampler_weights(const scene *m, const surface *s, const float *weight) {
    sampler d;
    sampler_start(&d, m, s);
    d.status = mcs_product_build_weights(d.p, d.mem.bytes, tiles_of(m), env_of(m), weight);
    sampler_ready(&d);
    CHECK(!(d.share > 0), "share %g", d.share);
    return d;
}

/* ---- what holds of every draw ---- */

/* Number of texels with light above the horizon that cannot be drawn. A float direction is not told from the horizon
 * within eps. */
static inline int unsupported(const sampler *d, int sub, uint32_t *col, uint32_t *row) {
    const scene *m = d->m;
    int n = 0;
    for (uint32_t r = 0; r < m->h; r++)
        for (uint32_t c = 0; c < m->w; c++)
            if (m->light[(size_t)r * m->w + c] > 0 && highest(m, d->s->n, c, r, sub) > 4 * eps &&
                !(density(d, point(m->w, m->h, c, r, 0.5, 0.5)) > 0)) {
                if (!n) {
                    *col = c;
                    *row = r;
                }
                n++;
            }
    return n;
}

static const float hard_u[] = {0.0f, 1.4e-45f, FLT_MIN, 0x1p-32f, 0x1p-24f, 0.25f, 0.5f, 0x0.fffffep0f, 0x0.ffffffp0f};
static const float bad_u[] = {-1.0f, -1e-9f, 1.0f, 2.0f, INFINITY, -INFINITY, NAN};
enum { HARD = (int)(sizeof hard_u / sizeof *hard_u), BAD = (int)(sizeof bad_u / sizeof *bad_u) };

static inline int sane(const mcs_texel *t, const scene *m) {
    const double len = sqrt((double)t->w.x * t->w.x + (double)t->w.y * t->w.y + (double)t->w.z * t->w.z);
    return t->pdf >= 0 && t->pdf <= FLT_MAX && fabs(len - 1) <= 8 * eps && t->col < m->w && t->row < m->h;
}
/* Whatever the surface is: finite, not negative, of unit length; sample and density agree; bad u give 0. `frame_ok`: a
 * lobe can be placed. */
static inline void check_sane(const sampler *d, int frame_ok) {
    for (int i = 0; i < HARD + 40; i++)
        for (int j = 0; j < (i < HARD ? HARD : 1); j++) {
            const float u1 = i < HARD ? hard_u[i] : hash01((uint32_t)i, 11);
            const float u2 = i < HARD ? hard_u[j] : hash01((uint32_t)i, 12);
            const mcs_texel t = draw(d, u1, u2);
            if (frame_ok)
                CHECK(sane(&t, d->m), "u = %a, %a: (%g, %g, %g), pdf %g", (double)u1, (double)u2, (double)t.w.x,
                      (double)t.w.y, (double)t.w.z, (double)t.pdf);
            else
                CHECK(t.pdf >= 0 && t.pdf <= FLT_MAX && isfinite(t.w.x) && isfinite(t.w.y) && isfinite(t.w.z) &&
                          t.col < d->m->w && t.row < d->m->h,
                      "u = %a, %a: (%g, %g, %g), pdf %g", (double)u1, (double)u2, (double)t.w.x, (double)t.w.y,
                      (double)t.w.z, (double)t.pdf);
            if (t.pdf > 0)
                CHECK(agrees(d, t), "u = %a, %a: pdf %.8g, returned %.8g", (double)u1, (double)u2, density(d, t.w),
                      (double)t.pdf);
        }
    for (int i = 0; i < BAD; i++)
        for (int j = 0; j < 2; j++) {
            const mcs_texel t = draw(d, j ? 0.5f : bad_u[i], j ? bad_u[i] : 0.5f);
            CHECK(!(t.pdf > 0) && t.pdf >= 0 && (!frame_ok || sane(&t, d->m)), "u%d = %g: pdf %g, (%g, %g, %g)", j + 1,
                  (double)bad_u[i], (double)t.pdf, (double)t.w.x, (double)t.w.y, (double)t.w.z);
        }
    {
        static const float bad_w[][3] = {{0, 0, 0},        {NAN, 0, 1},       {0, NAN, 1}, {0, 0, NAN},
                                         {INFINITY, 0, 0}, {0, 0, -INFINITY}, {3, 0, 0},   {0, 0.4f, 0}};
        for (int i = 0; i < (int)(sizeof bad_w / sizeof *bad_w); i++) {
            mcs_vec3 w;
            w.x = bad_w[i][0];
            w.y = bad_w[i][1];
            w.z = bad_w[i][2];
            CHECK(density(d, w) == 0, "density of (%g, %g, %g): %g", (double)w.x, (double)w.y, (double)w.z,
                  density(d, w));
        }
    }
}
#endif
