/* Images that break tables of light: one pixel among black ones, sums that overflow a float, one texel, one row, one
 * column, light at the poles only, texels that are no light, 16384 x 8192. As they are, bilinear and with a floor (MIS
 * compensation): the map, windows of it and products.
 *
 * The truth is the image: weight times solid angle of each texel, in long double; of the header only what its comments
 * name is used. Asserted: the density integrates to 1; rows, and columns within a row, have their share of light within
 * the integers that the header documents, every lit texel at least one of them; no draw falls on a black texel, by the
 * header's word and by arithmetic in double; single and array forms give the same bits; directions are unit, densities
 * finite, those of a draw more than 0 and its texel that of its direction; nothing is written outside of the memory.
 * --filter takes an image or a mode; MCS_TEST_SCALE scales the draws, and below 1 the largest image is 1024 x 512. */
#include "latlong.h"
#include "stress.h"

static const double eps = 0x1p-24; /* rounding of a float, relative */
static const ld one = 0x1p31L;     /* probabilities of rows and of columns within a row are integers over this */

/* --- images ----------------------------------------------------------------------------------------------------------
 */

typedef float (*shade)(uint32_t col, uint32_t row, uint32_t w, uint32_t h);

static float hash01(uint32_t c, uint32_t r) { return mcs_u01(mcs_hash(c, r)); }

static float v_black(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)c;
    (void)r;
    (void)w;
    (void)h;
    return 0.0f;
}
static float v_constant(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)c;
    (void)r;
    (void)w;
    (void)h;
    return 0.7f;
}
static float v_random(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return 0.1f + hash01(c, r);
}
static float v_checker(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (c + r) & 1 ? 1.0f : 0.0f;
}
static float v_pixel(uint32_t c, uint32_t r, uint32_t w, uint32_t h) { return c == w / 3 && r == h / 3 ? 1e30f : 0.0f; }
static float v_first(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return c || r ? 0.0f : 1e30f;
}
static float v_last(uint32_t c, uint32_t r, uint32_t w, uint32_t h) { return c == w - 1 && r == h - 1 ? 1e30f : 0.0f; }
static float v_pixel_dim(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    return c == w / 3 && r == h / 3 ? 1e30f : (c ^ r) & 3 ? hash01(c, r) : 0.0f;
}
static float v_peak(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    return c == w / 2 && r == h / 2 ? 1e8f : (c * 5 + r) % 7 ? 0.5f + hash01(c, r) : 0.0f;
}
static float v_suns(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)h;
    return c == (r * 977 + 5) % w ? 1e8f : 0.5f + hash01(c, r);
}
static float v_huge(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (c + r) % 3 ? FLT_MAX : (c ^ r) & 1 ? FLT_MAX / 4 : 0.0f;
}
static float v_subnormal(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (float)((c + r) % 4) * 0x1p-149f;
}
static float v_range(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (c * 7 + r) % 5 ? st_float(mcs_hash(c, r) % 0x7f800000u) : 0.0f;
}
static float v_poles(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    return r == 0 || r == h - 1 ? (float)(c % 3) : 0.0f;
}
static float v_no_poles(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    return r == 0 || r == h - 1 ? 0.0f : 0.5f + hash01(c, r);
}
static float v_seam(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)h;
    return c == 0 || c == w - 1 ? 1.0f + hash01(c, r) : 0.0f;
}
/* Some that are no number, negative or infinite, among others. */
static float v_bad(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    static const float bad[4] = {NAN, -1.0f, -INFINITY, -FLT_MAX};
    const uint32_t z = mcs_hash(c, r);
    (void)w;
    (void)h;
    return z % 300 == 1 ? INFINITY : z % 5 == 0 ? bad[z / 5 % 4] : 0.5f + hash01(r, c);
}
/* A sky brighter towards its horizon, a black ground, and a sun of one texel. */
static float v_sky(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    const float up = 1.0f - 2.0f * ((float)r + 0.5f) / (float)h;
    if (c == w / 5 && r == h / 4) return 1e5f;
    return up > 0 ? 1.0f - 0.7f * up + 0.1f * hash01(c, r) : 0.0f;
}

static const struct subject {
    const char *name;
    shade value;
    uint32_t w, h, cut_w, cut_h; /* the latter below full scale */
} subjects[] = {
    {"1 x 1", v_constant, 1, 1, 1, 1},
    {"1 x 1, black", v_black, 1, 1, 1, 1},
    {"1 x 1000", v_random, 1, 1000, 1, 1000},
    {"1000 x 1", v_random, 1000, 1, 1000, 1},
    {"1 x 65536", v_range, 1, 65536, 1, 65536},
    {"65536 x 1", v_range, 65536, 1, 65536, 1},
    {"3 x 4099, poles", v_poles, 3, 4099, 3, 4099},
    {"8191 x 16, checkers", v_checker, 8191, 16, 8191, 16},
    {"black", v_black, 96, 48, 96, 48},
    {"constant", v_constant, 77, 39, 77, 39},
    {"random, odd", v_random, 333, 111, 333, 111},
    {"checkers", v_checker, 100, 63, 100, 63},
    {"1e30 among zeros", v_pixel, 130, 70, 130, 70},
    {"1e30 at +z", v_first, 64, 33, 64, 33},
    {"1e30 at -z", v_last, 65, 32, 65, 32},
    {"1e30 over dim", v_pixel_dim, 130, 70, 130, 70},
    {"1e8 over dark", v_peak, 200, 100, 200, 100},
    {"1e8 in each row", v_suns, 256, 128, 256, 128},
    {"FLT_MAX", v_huge, 96, 64, 96, 64},
    {"subnormal", v_subnormal, 90, 45, 90, 45},
    {"every float", v_range, 210, 107, 210, 107},
    {"poles lit", v_poles, 100, 50, 100, 50},
    {"poles black", v_no_poles, 100, 50, 100, 50},
    {"at the seam", v_seam, 90, 46, 90, 46},
    {"bad texels", v_bad, 90, 45, 90, 45},
    {"sky", v_sky, 16384, 8192, 1024, 512},
};

enum mode { PLAIN, BILINEAR, FLOOR, MODES };
static const char *const mode_name[MODES] = {"plain", "bilinear", "floor"};
/* Relative rounding of a weight: a bilinear one is two sums of three floats, one above a floor is a difference of two.
 */
static const double loose[MODES] = {0, 4 * 0x1p-24, 0x1p-24};
/* The products with powers of 2 of a bilinear weight round where they are subnormal, 11 times by up to 2^-150: smaller
 * weights than these may be lost, and not much larger ones be wrong by more than `loose`. */
static const ld bilinear_least = 11 * 0x1p-150L, bilinear_sharp = 11 * 0x1p-126L;

typedef struct {
    const char *name;
    enum mode mode;
    arena pixels;
    mcs_image im;
    ld total, *row;            /* weight times solid angle: of the sphere, of each row */
    uint32_t *lit, lit_rows;   /* texels of each row with a weight */
    uint32_t bad;              /* texels that are negative or no finite number */
    int even, sharp;           /* all weights are alike; all weights are right to `loose` */
    uint32_t sun_col, sun_row; /* a texel with the largest weight */
    double *cosine, *sine;     /* of the azimuth of the middle of each column */
    ld *weight, *between;      /* a row of weights; of what is filtered across rows */
} picture;

/* What a texel counts as: +infinity as FLT_MAX, NaN and negative numbers as 0. */
static ld light(float x) { return x > FLT_MAX ? (ld)FLT_MAX : x > 0 ? (ld)x : 0; }
/* The weights of a row of texels, which is how the header defines them: the texel, filtered by (1 2 1)/4 both ways with
 * columns that wrap, or less the floor. */
static const ld *weights(const picture *p, uint32_t y) {
    const uint32_t w = p->im.w;
    const uint32_t h = p->im.h;
    const float *at = p->im.pixels + (size_t)y * w;
    const float *up = y > 0 ? at - w : at;
    const float *down = y + 1 < h ? at + w : at;
    for (uint32_t x = 0; x < w; x++) {
        if (p->mode == BILINEAR) p->between[x] = 0.25L * light(up[x]) + 0.5L * light(at[x]) + 0.25L * light(down[x]);
        else p->weight[x] = light(at[x]) > p->im.floor ? light(at[x]) - (ld)p->im.floor : 0;
    }
    for (uint32_t x = 0; p->mode == BILINEAR && x < w; x++)
        p->weight[x] =
            0.25L * p->between[x ? x - 1 : w - 1] + 0.5L * p->between[x] + 0.25L * p->between[x + 1 < w ? x + 1 : 0];
    return p->weight;
}
/* 1: lit, 0: black, -1: rounding decides. */
static int lit_by(const picture *p, ld weight) {
    return !(weight > 0) ? 0 : p->mode != BILINEAR || weight >= bilinear_least ? 1 : -1;
}
static int black(const picture *p, uint32_t x, uint32_t y) {
    const uint32_t w = p->im.w;
    const uint32_t h = p->im.h;
    const uint32_t row[3] = {y, y > 0 ? y - 1 : y, y + 1 < h ? y + 1 : y};
    const uint32_t col[3] = {x, x ? x - 1 : w - 1, x + 1 < w ? x + 1 : 0};
    const int n = p->mode == BILINEAR ? 3 : 1;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            if (light(p->im.pixels[(size_t)row[i] * w + col[j]]) > p->im.floor) return 0;
    return 1;
}

static picture make(const struct subject *s, enum mode mode) {
    const double pi = acos(-1.0);
    const int full = mcst_scale() >= 1;
    const uint32_t w = full ? s->w : s->cut_w;
    const uint32_t h = full ? s->h : s->cut_h;
    ld first = -1;
    ld top = -1;
    picture p;
    p.name = s->name;
    p.mode = mode;
    p.total = 0;
    p.lit_rows = p.bad = 0;
    p.even = p.sharp = 1;
    p.sun_col = p.sun_row = 0;
    float *to;
    p.pixels = arena_make((size_t)w * h * sizeof *to);
    to = (float *)(void *)p.pixels.at;
    p.row = (ld *)memory(h * sizeof *p.row);
    p.lit = (uint32_t *)memory(h * sizeof *p.lit);
    p.cosine = (double *)memory(w * sizeof *p.cosine);
    p.sine = (double *)memory(w * sizeof *p.sine);
    p.weight = (ld *)memory(w * sizeof *p.weight);
    p.between = (ld *)memory(w * sizeof *p.between);
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++) to[(size_t)y * w + x] = s->value(x, y, w, h);
    for (uint32_t x = 0; x < w; x++) {
        p.cosine[x] = cos(2 * pi * (x + 0.5) / w);
        p.sine[x] = sin(2 * pi * (x + 0.5) / w);
    }
    p.im = mcs_image_make(to, w, h, 1);
    p.im.bilinear = mode == BILINEAR;
    if (mode == FLOOR) p.im.floor = mcs_env_mean(&p.im);
    for (uint32_t y = 0; y < h; y++) {
        const ld *v = weights(&p, y);
        ld sum = 0;
        p.lit[y] = 0;
        if (y == 0) first = v[0];
        for (uint32_t x = 0; x < w; x++) {
            sum += v[x];
            p.lit[y] += v[x] > 0;
            p.even &= v[x] == first;
            p.sharp &= mode != BILINEAR || v[x] == 0 || v[x] >= bilinear_sharp;
            p.bad += !(to[(size_t)y * w + x] >= 0 && to[(size_t)y * w + x] <= FLT_MAX);
            if (v[x] > top) {
                top = v[x];
                p.sun_col = x;
                p.sun_row = y;
            }
        }
        p.row[y] = sum * solid_angle(y, w, h);
        p.total += p.row[y];
        p.lit_rows += p.lit[y] > 0;
    }
    return p;
}
static void discard(picture *p) {
    CHECK(arena_intact(&p->pixels), "%s: written around the image", p->name);
    arena_free(&p->pixels);
    free(p->row);
    free(p->lit);
    free(p->cosine);
    free(p->sine);
    free(p->weight);
    free(p->between);
}

/* --- what is drawn from ------------------------------------------------------------------------------------------- */

enum { MAP, WINDOW, PRODUCT, KINDS };

typedef struct {
    int kind;
    const picture *p;
    const mcs_env *e;
    const mcs_env_window *window;
    const mcs_product *product;
    const mcs_tiles *tiles;
    uint32_t row, rows, col, cols;
    int lit; /* 0: there is no light to draw */
} source;

static mcs_texel draw(const source *s, float u1, float u2) {
    return s->kind == MAP      ? mcs_env_sample(s->e, u1, u2)
           : s->kind == WINDOW ? mcs_env_window_sample(s->window, s->e, u1, u2)
                               : mcs_product_sample(s->product, s->tiles, s->e, u1, u2);
}
static void draw_n(const source *s, size_t n, const float *u1, const float *u2, float *x, float *y, float *z,
                   float *pdf) {
    if (s->kind == MAP) mcs_env_sample_n(s->e, n, u1, u2, x, y, z, pdf, NULL, NULL);
    else if (s->kind == WINDOW) mcs_env_window_sample_n(s->window, s->e, n, u1, u2, x, y, z, pdf, NULL, NULL);
    else mcs_product_sample_n(s->product, s->tiles, s->e, n, u1, u2, x, y, z, pdf, NULL, NULL);
}
static float density(const source *s, mcs_vec3 w) {
    return s->kind == MAP      ? mcs_env_pdf(s->e, w)
           : s->kind == WINDOW ? mcs_env_window_pdf(s->window, s->e, w)
                               : mcs_product_pdf(s->product, s->tiles, s->e, w);
}
static int inside(const source *s, uint32_t col, uint32_t row) {
    const uint32_t w = s->p->im.w;
    return row >= s->row && row - s->row < s->rows && col < w && (col + w - s->col) % w < s->cols;
}

/* The largest errors of an image in a mode: masses and lengths in 2^-24, shares in parts of their bounds. */
typedef struct {
    double draws, mass[KINDS], row, col, length;
} tally;

/* --- densities of all texels -------------------------------------------------------------------------------------- */

typedef struct {
    float *x, *y, *z, *pdf;
} row_of_texels;

/* Directions of the middles of a row's texels, halfway in azimuth and in cos(theta). */
static void middles(const picture *p, uint32_t y, const row_of_texels *to) {
    const double pi = acos(-1.0);
    const double h = p->im.h;
    const double a = pow(sin(pi / 2 * y / h), 2);
    const double b = pow(sin(pi / 2 * (y + 1) / h), 2);
    const double half = 0.5 * (a + b);
    const double s = 2 * sqrt(half * (1 - half));
    for (uint32_t x = 0; x < p->im.w; x++) {
        to->x[x] = (float)(s * p->cosine[x]);
        to->y[x] = (float)(s * p->sine[x]);
        to->z[x] = (float)(1 - 2 * half);
    }
}

/* Height of a row in cos(theta), relative: a difference of doubles below 1, off by 2^-52 together. The row m from a
 * pole is sin(pi (m + 1/2)/h) pi/h high, and its borders are about (pi m/h)^2/2, of which they are off by 2^-53 each:
 * by m/2 2^-53 or, at the equator, h/pi 2^-53, times what rounding there is in computing them, a few. */
static double height_off(const picture *p) { return p->im.h * 0x1p-51; }

/* The shares of a list of probabilities that add up to 1 against those of the truth: an integer over 2^31 is off by one
 * of rounding, its own one, its part of the ones of all `lit` entries, and n 2^-22 by the rounding of n sums in double;
 * `off` is the relative error of everything else. */
static double share_bound(ld want, uint32_t lit, uint32_t n, double off) {
    return (double)((2 + lit * want + n * 0x1p-22L) / one + off * want);
}
static void check_share(const picture *p, double found, double want, double bound, double *worst, const char *what,
                        uint32_t x, uint32_t y) {
    const double err = fabs(found - want);
    if (bound > 0) *worst = fmax(*worst, err / bound);
    CHECK(err <= bound, "%s: %s %u, %u: %.9g, not %.9g, in 2^-31", p->name, what, (unsigned)x, (unsigned)y,
          found * (double)one, want * (double)one);
}
/* A probability in units of 2^-31, where the eye can tell that it is an integer: at least 1. `off`: its relative error.
 */
static void check_integer(const picture *p, double units, double off, const char *what, uint32_t x, uint32_t y) {
    const double nearest = fmax(1, floor(units + 0.5));
    if (units * off > 0.1) return;
    CHECK(fabs(units - nearest) <= nearest * off, "%s: %s %u, %u: %.9g of 2^31", p->name, what, (unsigned)x,
          (unsigned)y, units);
}

/* Every texel of the map: its density, its place, its share. */
static void check_map_texels(const source *s, const row_of_texels *t, tally *to) {
    const picture *p = s->p;
    const uint32_t w = p->im.w;
    const uint32_t h = p->im.h;
    const uint32_t step = (size_t)w * h > 1 << 22 ? 61 : 1;
    const double height = height_off(p);
    const double off = loose[p->mode];
    ld mass = 0;
    for (uint32_t y = 0; y < h; y++) {
        const ld omega = solid_angle(y, w, h);
        const ld *v = weights(p, y);
        const double want = (double)(p->even ? omega * w / (4 * acosl(-1.0L)) : p->row[y] / p->total);
        ld found = 0;
        ld sum = 0;
        uint32_t wrong = 0;
        middles(p, y, t);
        mcs_env_pdf_n(s->e, w, t->x, t->y, t->z, t->pdf);
        for (uint32_t x = 0; x < w; x++) {
            const int due = p->even ? 1 : lit_by(p, v[x]);
            found += t->pdf[x] * omega;
            sum += v[x];
            wrong += !(t->pdf[x] >= 0 && t->pdf[x] <= FLT_MAX) || (due >= 0 && (t->pdf[x] > 0) != due);
        }
        mass += found;
        CHECK(wrong == 0, "%s: row %u: density of %u texels dark where there is light, or the reverse", p->name,
              (unsigned)y, (unsigned)wrong);
        for (uint32_t x = y % step; x < w; x += step) {
            mcs_vec3 dir;
            dir.x = t->x[x];
            dir.y = t->y[x];
            dir.z = t->z[x];
            const mcs_texel at = mcs_env_texel(s->e, dir);
            CHECK(at.col == x && at.row == y && at.pdf == t->pdf[x], "%s: texel %u %u is %u %u; pdf %a, in an array %a",
                  p->name, (unsigned)x, (unsigned)y, (unsigned)at.col, (unsigned)at.row, (double)at.pdf,
                  (double)t->pdf[x]);
        }
        if (!p->sharp) continue;
        /* densities and, of a row, its weight, a float; the truth's total is as far off as its weights */
        check_share(p, (double)found, want,
                    p->even ? want * (eps + height) : share_bound(want, p->lit_rows, h, 2 * eps + 2 * off + 2 * height),
                    &to->row, "row", y, y);
        if (p->even) continue;
        if (want > 0) check_integer(p, (double)(found * one), eps + height, "row", y, y);
        for (uint32_t x = 0; found > 0 && x < w; x++) { /* a density over the sum of densities */
            const double share = (double)(t->pdf[x] * omega / found);
            const double due = (double)(v[x] / sum);
            check_share(p, share, due, due > 0 ? share_bound(due, p->lit[y], w, 2 * eps + 2 * off) : 0, &to->col,
                        "texel", x, y);
            if (due > 0) check_integer(p, share * (double)one, 2.01 * eps, "texel", x, y);
        }
    }
    to->mass[MAP] = fmax(to->mass[MAP], fabs((double)(mass - 1)) / eps);
    /* the integers add up to 2^62: what is left is the rounding of each density, and heights */
    CHECK(fabsl(mass - 1) <= eps + height, "%s: the density integrates to 1 + %Lg", p->name, mass - 1);
}

/* Every texel of a window: nothing outside; where it has light, the density of the map times a number of the row's own.
 */
static void check_window_texels(const source *s, const row_of_texels *t, tally *to) {
    const picture *p = s->p;
    const uint32_t w = p->im.w;
    const uint32_t h = p->im.h;
    ld mass = 0;
    uint32_t outside = 0;
    uint32_t wrong = 0;
    uint32_t unlike = 0;
    for (uint32_t y = 0; y < h; y++) {
        const ld omega = solid_angle(y, w, h);
        ld here = 0;
        ld there = 0;
        middles(p, y, t);
        mcs_env_pdf_n(s->e, w, t->x, t->y, t->z, t->pdf);
        for (uint32_t x = 0; x < w; x++) {
            const int in = inside(s, x, y);
            mcs_vec3 dir;
            dir.x = t->x[x];
            dir.y = t->y[x];
            dir.z = t->z[x];
            const float pdf = mcs_env_window_pdf(s->window, s->e, dir);
            outside += !in && pdf != 0;
            wrong += !(pdf >= 0 && pdf <= FLT_MAX);
            if (!in) t->pdf[x] = 0;
            there += t->pdf[x];
            here += pdf;
            t->x[x] = pdf;
        }
        mass += here * omega;
        const ld times = there > 0 ? here / there : 0;
        for (uint32_t x = 0; s->lit && x < w; x++) /* four densities, each rounded once */
            unlike += !(fabsl(t->x[x] - times * t->pdf[x]) <= 4.01 * eps * t->x[x]);
    }
    CHECK(outside == 0 && wrong == 0 && unlike == 0,
          "%s, window %u + %u, %u + %u: %u densities outside, %u no densities, %u not those of the map", p->name,
          (unsigned)s->col, (unsigned)s->cols, (unsigned)s->row, (unsigned)s->rows, (unsigned)outside, (unsigned)wrong,
          (unsigned)unlike);
    to->mass[WINDOW] = fmax(to->mass[WINDOW], fabs((double)(mass - 1)) / eps);
    CHECK(fabsl(mass - 1) <= eps + height_off(p), "%s, window %u + %u, %u + %u: the density integrates to 1 + %Lg",
          p->name, (unsigned)s->col, (unsigned)s->cols, (unsigned)s->row, (unsigned)s->rows, mass - 1);
}

/* Every texel of a product. Within one, the density is a bilinear function of the place in azimuth and cos(theta): its
 * middle is its mean. Places are known to 2^-22 of a column or row (as the header says), and no such function, of four
 * numbers with mean 1, changes by more than 4 across a tile, nor more than that across a texel. Its four numbers take 6
 * roundings, its value 4, the density 1. */
static void check_product_texels(const source *s, const row_of_texels *t, tally *to) {
    const picture *p = s->p;
    const uint32_t w = p->im.w;
    const uint32_t h = p->im.h;
    const double bound = 11 * eps + height_off(p) + 4 * 0x1p-22 * ((double)w + h);
    ld mass = 0;
    uint32_t wrong = 0;
    for (uint32_t y = 0; y < h; y++) {
        const ld omega = solid_angle(y, w, h);
        middles(p, y, t);
        for (uint32_t x = 0; x < w; x++) {
            mcs_vec3 dir;
            dir.x = t->x[x];
            dir.y = t->y[x];
            dir.z = t->z[x];
            const float pdf = mcs_product_pdf(s->product, s->tiles, s->e, dir);
            wrong += !(pdf >= 0 && pdf <= FLT_MAX) || (pdf > 0 && p->total > 0 && black(p, x, y));
            mass += pdf * omega;
        }
    }
    CHECK(wrong == 0, "%s, product: %u densities of black texels, or none", p->name, (unsigned)wrong);
    to->mass[PRODUCT] = fmax(to->mass[PRODUCT], fabs((double)(mass - s->lit)) / eps);
    CHECK(fabsl(mass - s->lit) <= bound, "%s, product: the density integrates to %d + %Lg, bound %g", p->name, s->lit,
          mass - s->lit, bound);
}

/* --- draws -----------------------------------------------------------------------------------------------------------
 */

static const float corner[] = {0.0f,     0x1p-149f,     FLT_MIN,       1e-30f,        0x1p-32f,
                               0x1p-25f, 0x1p-24f,      0x1p-12f,      0.25f,         0.5f,
                               0.75f,    0x0.fffffcp0f, 0x0.fffffdp0f, 0x0.fffffep0f, 0x0.ffffffp0f};
enum { CORNERS = (int)MCST_COUNT(corner), BATCH = 256 };

/* One draw; its density is that of its direction, to the bit unless it is a product's, which follows the place in the
 * texel. */
static void check_draw(const source *s, mcs_texel d, const char *what, double u1, double u2, tally *to) {
    const picture *p = s->p;
    const double x = d.w.x;
    const double y = d.w.y;
    const double z = d.w.z;
    const double off = fabs(sqrt(x * x + y * y + z * z) - 1);
    const int in = inside(s, d.col, d.row);
    const int positive = d.pdf > 0 && d.pdf <= FLT_MAX;
    to->draws++;
    to->length = fmax(to->length, off / eps);
    CHECK(off <= st_map_off, "%s, %s: u %a %a: length 1 + %g", p->name, what, u1, u2, off);
    if (s->kind == PRODUCT && !s->lit) {
        CHECK(d.pdf == 0, "%s, %s: u %a %a: pdf %a without light", p->name, what, u1, u2, (double)d.pdf);
        return;
    }
    CHECK(in && positive, "%s, %s: u %a %a: texel %u %u, pdf %a", p->name, what, u1, u2, (unsigned)d.col,
          (unsigned)d.row, (double)d.pdf);
    if (!in) return;
    CHECK(!s->lit || p->even || !black(p, d.col, d.row), "%s, %s: u %a %a: texel %u %u is black", p->name, what, u1, u2,
          (unsigned)d.col, (unsigned)d.row);
    mcs_texel own = mcs_env_texel(s->e, d.w);
    CHECK(own.col == d.col && own.row == d.row, "%s, %s: u %a %a: texel %u %u, of its direction %u %u", p->name, what,
          u1, u2, (unsigned)d.col, (unsigned)d.row, (unsigned)own.col, (unsigned)own.row);
    own.pdf = density(s, d.w);
    CHECK(s->kind == PRODUCT ? own.pdf > 0 : own.pdf == d.pdf, "%s, %s: u %a %a: pdf %a, of its direction %a", p->name,
          what, u1, u2, (double)d.pdf, (double)own.pdf);
    double c, r;
    /* atan2 of the floats in double: each is off by 2^-24 of itself, an azimuth by as many radians or 2^-24 columns of
     * w/2 pi, the angle to the pole likewise; the header may have placed it that far on the other side. */
    texel_of(p->im.w, p->im.h, d.w, &c, &r);
    double aside = fabs(c - d.col - 0.5);
    aside = aside > p->im.w / 2.0 ? p->im.w - aside : aside;
    CHECK(aside <= 0.5 + eps * p->im.w && fabs(r - d.row - 0.5) <= 0.5 + eps * p->im.h,
          "%s, %s: u %a %a: texel %u %u, by its direction column %.9g, row %.9g", p->name, what, u1, u2,
          (unsigned)d.col, (unsigned)d.row, c, r);
}

static void check_draws(const source *s, long n, const char *what, tally *to) {
    arena in = arena_make(2 * BATCH * sizeof(float));
    arena out = arena_make(5 * BATCH * sizeof(float));
    float *u1 = (float *)(void *)in.at;
    float *u2 = u1 + BATCH;
    float *x = (float *)(void *)out.at;
    float *y = x + BATCH;
    float *z = y + BATCH;
    float *pdf = z + BATCH;
    float *again = pdf + BATCH;
    uint64_t state = mcst_seed_for(s->p->name, what, (size_t)s->p->mode);
    long unequal = 0;
    for (long at = 0; at < n + CORNERS * CORNERS; at += BATCH) {
        mcst_uniform(&state, BATCH, u1, u2);
        for (int k = 0; k < BATCH && at + k < CORNERS * CORNERS; k++) {
            u1[k] = corner[(at + k) % CORNERS];
            u2[k] = corner[(at + k) / CORNERS];
        }
        draw_n(s, BATCH, u1, u2, x, y, z, pdf);
        if (s->kind == MAP) mcs_env_pdf_n(s->e, BATCH, x, y, z, again);
        for (int k = 0; k < BATCH; k++) {
            const mcs_texel d = draw(s, u1[k], u2[k]);
            unequal += !(d.w.x == x[k] && d.w.y == y[k] && d.w.z == z[k] && d.pdf == pdf[k]);
            unequal += s->kind == MAP && !(again[k] == pdf[k]);
            check_draw(s, d, what, (double)u1[k], (double)u2[k], to);
            if (s->kind == MAP) {
                static const uint32_t odd[8] = {0,           1,           255,         0x7fffffffu,
                                                0x80000000u, 0xffffff00u, 0xfffffffeu, 0xffffffffu};
                const uint64_t b = mcst_mix(&state);
                const uint32_t b1 = b & 7 ? (uint32_t)(b >> 32) : odd[b >> 6 & 7];
                const uint32_t b2 = b & 56 ? (uint32_t)mcst_mix(&state) : odd[b >> 9 & 7];
                check_draw(s, mcs_env_sample_bits(s->e, b1, b2), "bits", b1, b2, to);
            }
        }
    }
    CHECK(unequal == 0, "%s, %s: %ld draws are others in an array", s->p->name, what, unequal);
    CHECK(arena_intact(&in) && arena_intact(&out), "%s, %s: written around arrays", s->p->name, what);
    arena_free(&in);
    arena_free(&out);
}

/* --- one image in one mode ---------------------------------------------------------------------------------------- */

static int any_lit(const source *s) {
    int some = 0;
    for (uint32_t y = s->row; y < s->row + s->rows; y++) {
        const ld *v = weights(s->p, y);
        for (uint32_t x = 0; x < s->cols; x++) {
            const int lit = lit_by(s->p, v[(s->col + x) % s->p->im.w]);
            if (lit > 0) return 1;
            some |= lit;
        }
    }
    return some;
}

/* Windows: across the seam, the brightest texel, the last row's second half. */
static void check_windows(const source *map, const row_of_texels *t, long n, tally *to) {
    const picture *p = map->p;
    const uint32_t w = p->im.w;
    const uint32_t h = p->im.h;
    const uint32_t part[3][4] = {{h / 4, (h + 1) / 2, w - (w + 3) / 4, (w + 1) / 2},
                                 {p->sun_row, 1, p->sun_col, 1},
                                 {h - 1, 1, w / 2, (w + 1) / 2}};
    for (int i = 0; i < 3; i++) {
        source s = *map;
        arena a = arena_make(mcs_env_window_bytes(part[i][1]));
        mcs_env_window *m = (mcs_env_window *)(void *)a.at;
        s.kind = WINDOW;
        s.window = m;
        s.row = part[i][0];
        s.rows = part[i][1];
        s.col = part[i][2];
        s.cols = part[i][3];
        const int due = any_lit(&s);
        const mcs_status rc = mcs_env_window_build(m, a.bytes, s.e, s.row, s.rows, s.col, s.cols);
        s.lit = !m->uniform || (s.e->uniform && s.e->total > 0);
        CHECK(rc == MCS_OK && (s.lit ? due != 0 : due <= 0), "%s, window %d: status %d", p->name, i, (int)rc);
        check_window_texels(&s, t, to);
        check_draws(&s, n, "window", to);
        CHECK(arena_intact(&a), "%s, window %d: written outside", p->name, i);
        arena_free(&a);
    }
}

/* Products with a matte surface that leans, and with a rough lobe. Only the tiles: the lobe's own share goes where it
 * likes. */
static void check_products(const source *map, const row_of_texels *t, long n, tally *to) {
    const picture *p = map->p;
    const int count = (size_t)p->im.w * p->im.h > 1 << 22 ? 1 : 2; /* some ten seconds each */
    arena a = arena_make(mcs_tiles_bytes(map->e, 16));
    arena b = arena_make(mcs_product_bytes(16));
    mcs_tiles *tiles = (mcs_tiles *)(void *)a.at;
    mcs_product *product = (mcs_product *)(void *)b.at;
    mcs_status rc = mcs_tiles_build(tiles, a.bytes, map->e, 16);
    CHECK(rc == MCS_OK, "%s, tiles: status %d", p->name, (int)rc);
    for (int i = 0; i < count; i++) {
        source s = *map;
        mcs_reflection r;
        memset(&r, 0, sizeof r);
        r.frame = mcs_frame_make(mcs_sphere_sample(i ? 0.4f : 0.1f, i ? 0.7f : 0.3f).w);
        r.wo = mcs_hemisphere_sample(0.4f, 0.2f).w;
        r.alpha_x = 0.2f;
        r.alpha_y = 0.4f;
        r.matte = i ? 0.1f : 1.0f;
        rc = mcs_product_build(product, b.bytes, tiles, map->e, &r, NULL);
        product->brdf_share = 0;
        s.kind = PRODUCT;
        s.product = product;
        s.tiles = tiles;
        s.lit = !product->dark;
        CHECK(rc == MCS_OK, "%s, product: status %d", p->name, (int)rc);
        check_product_texels(&s, t, to);
        check_draws(&s, n, "product", to);
    }
    CHECK(arena_intact(&a) && arena_intact(&b), "%s, product: written outside", p->name);
    arena_free(&a);
    arena_free(&b);
}

static void check_image(const struct subject *subject, enum mode mode) {
    const long n = (long)fmax(500, 4e5 * mcst_scale());
    picture p = make(subject, mode);
    const uint32_t w = p.im.w;
    const uint32_t h = p.im.h;
    arena a = arena_make(mcs_env_bytes(w, h));
    mcs_env *e = (mcs_env *)(void *)a.at;
    const mcs_status rc = mcs_env_build(e, a.bytes, &p.im);
    row_of_texels t;
    tally to;
    memset(&to, 0, sizeof to);
    source map;
    memset(&map, 0, sizeof map);
    t.x = (float *)memory(4 * (size_t)w * sizeof *t.x);
    t.y = t.x + w;
    t.z = t.y + w;
    t.pdf = t.z + w;
    map.kind = MAP;
    map.p = &p;
    map.e = e;
    map.rows = h;
    map.cols = w;
    map.lit = e->total > 0;
    {
        const int due = any_lit(&map);
        CHECK(rc == MCS_OK && (map.lit ? due != 0 : due <= 0), "%s: status %d", p.name, (int)rc);
    }
    CHECK(arena_intact(&a) && e->bad == p.bad, "%s: written outside, or %u bad, not %u", p.name, (unsigned)e->bad,
          (unsigned)p.bad);
    /* borders of rows are doubles below 2, and no row is lower than the first; sums in double */
    if (p.sharp)
        CHECK(fabsl(e->total - p.total) <= p.total * (1e-12L + loose[mode] + 0x1p-51L / (1 - cosl(acosl(-1.0L) / h))),
              "%s: total %g, not %Lg", p.name, e->total, p.total);
    check_map_texels(&map, &t, &to);
    check_draws(&map, n, "map", &to);
    check_windows(&map, &t, n / 4, &to);
    if (w >= 32 && h >= 16) check_products(&map, &t, n / 4, &to);
    CHECK(arena_intact(&a), "%s: written outside while drawing", p.name);
    mcst_note("  %-20s %5u %5u %-8s %8.0f %6.2f %6.2f", p.name, (unsigned)w, (unsigned)h, mode_name[mode], to.draws,
              to.mass[MAP], to.mass[WINDOW]);
    if (w >= 32 && h >= 16) mcst_note(" %7.1f", to.mass[PRODUCT]);
    else mcst_note(" %7s", "-");
    if (p.sharp) mcst_note(" %6.3f %6.3f", to.row, to.col);
    else mcst_note(" %6s %6s", "-", "-");
    mcst_note(" %6.2f\n", to.length);
    arena_free(&a);
    discard(&p);
    free(t.x);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_note("  mass, length: largest error in 2^-24; shares: of rows, of texels in their row, largest error over its "
              "bound\n"
              "  %-20s %5s %5s %-8s %8s %6s %6s %7s %6s %6s %6s\n",
              "", "width", "rows", "mode", "draws", "map", "window", "product", "rows", "texels", "length");
    mcst_group("images");
    for (size_t i = 0; i < MCST_COUNT(subjects); i++)
        for (int mode = 0; mode < MODES; mode++)
            if (mcst_case("%s, %s", subjects[i].name, mode_name[mode])) check_image(&subjects[i], (enum mode)mode);
    return mcst_finish();
}
