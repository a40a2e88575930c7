/* Products of environment, reflection and cosine: their density, texel by texel, against light, fit of the tile and
 * lobe; samples against the integral of the density. MCS_TEST_SCALE scales the number of samples. */
#include "stats.h"
#include "product_sampler.h"

/* ---- chi-square, mass, proportion ---- */

static double *expected, *observed;

/* Reflection as tiles have it towards a place of one, and the ten-thousandth of a white surface's that each value has
 * got; negative: no light. `sharp`: what that may be wrong by, relative, from a direction rounded by 8 eps: where D of
 * GGX is steepest, where the others are. Their falloff is the 256th power of a sum and a quotient, by eight squares
 * (767 eps), of an x with some 32. */
static double reflect_at(const sampler *d, box b, double t1, double t2, span *s, uint32_t *r, double *sharp) {
    *sharp = (2 / fmin(d->s->ax, d->s->ay) + 4) * 8 * eps;
    t1 = fmax(0, fmin(t1, 1 - 0x1p-32));
    t2 = fmax(0, fmin(t2, 1 - 0x1p-32));
    mcs_vec3 w;
    if (!(direction_at(d->m, b, t1, t2, &w, r, s) > 0)) return -1;
    double v[3];
    to3(v, w);
    if (d->s->profile != MCS_PROFILE_GGX) {
        const fall f = fall_at(d->s, v);
        const double root = fmin(f.root, 8);
        *sharp = (2 * root / f.scale + 4 / d->s->wo[2]) * 8 * eps + (767 + 32 * root * root) * eps;
    }
    double visible;
    return reflect_as(d->s, v, 1, &visible) + 1e-4 / pi;
}
/* The place that a node stands for: its own, but the outer ones for those a hundredth off the border. */
static double place_of_node(int k) { return k == 0 ? 0.01 : k == FINE ? 0.99 : (double)k / FINE; }
/* A node, less the hundredth of the mean that it has got, and the reflection that it stands for; what either may be
 * wrong by. */
typedef struct {
    double v, blur, wanted, off;
} known_node;
/* 0: there is no light, or the node may lie in another texel. */
static int know_node(const sampler *d, box b, double row_slack, const fit *f, double mean, int k1, int k2,
                     known_node *n) {
    static const int step[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const double t1 = place_of_node(k1);
    const double t2 = place_of_node(k2);
    double sharp;
    uint32_t r;
    span s;
    n->wanted = reflect_at(d, b, t1, t2, &s, &r, &sharp);
    if (!(n->wanted > 0)) return 0;
    const places off = places_off(d->m, &s, r, row_slack);
    const double in1 = t1 - s.t1;
    const double in2 = t2 - s.t2;
    if (!(fmin(in1, s.part1 - in1) > off.t1)) return 0;
    if (!(fmin(in2, s.part2 - in2) > off.t2)) return 0;
    n->off = sharp * n->wanted;
    for (int k = 0; k < 4; k++) {
        double beside;
        span s1;
        const double v = reflect_at(d, b, t1 + step[k][0] * off.t1, t2 + step[k][1] * off.t2, &s1, &r, &beside);
        n->off = fmax(n->off, fabs(v - n->wanted) + sharp * n->wanted);
    }
    n->v = fit_node(f, k1, k2)->v - 0.01 / 1.01 * mean;
    n->blur = fit_node(f, k1, k2)->blur;
    return 1;
}
/* The nodes of a grid go with the reflection towards the places they stand for, by one factor in all tiles, which is
 * narrowed down to `least` to `most`. */
static void check_nodes(const sampler *d, uint32_t tile, const fit *f, double mean, double *least, double *most) {
    const box b = tile_box(d->m, tile);
    const double row_slack = slack_of_tile(d->m, b);
    known_node best = {0, 0, 0, 0};
    int n = 0;
    known_node known[(FINE + 1) * (FINE + 1)];
    for (int k = 0; k < (FINE + 1) * (FINE + 1); k++) {
        if (!know_node(d, b, row_slack, f, mean, k / (FINE + 1), k % (FINE + 1), &known[n])) continue;
        if (known[n].v > best.v) best = known[n];
        n++;
    }
    if (!n) return;
    const double factor = best.v / best.wanted;
    double wrong = best.blur / best.v + best.off / best.wanted;
    double light = 0;
    for (int k = 0; k < n; k++)
        CHECK(fabs(known[k].v - factor * known[k].wanted) <=
                  known[k].blur + factor * (known[k].off + wrong * known[k].wanted) + 16 * eps * (best.v + mean),
              "tile %u: a node has %g, not %g", tile, known[k].v, factor * known[k].wanted);
    /* Shares of rows and of columns are integers over 2^24, each at most 2 wrong; every entry adds one. */
    for (uint32_t r = b.r0; r < b.r1; r++) light += b.line[r] * d->m->area[r];
    wrong += (4 / (mean * light) + 4.0 * d->m->rows) * 0x1p-24;
    *least = fmax(*least, factor * (1 - wrong));
    *most = fmin(*most, factor * (1 + wrong));
}
/* A node counts in the mean by the cells around it, a quarter of each; with nothing anywhere else it has all of that.
 * To each is added: 0.03 of the mean to corners, 0.01 on a grid. */
static void check_range_of_nodes(uint32_t tile, const fit *f, double mean) {
    const double least = f->parts > 1 ? 0.01 : 0.03;
    for (int k1 = 0; k1 <= f->parts; k1++)
        for (int k2 = 0; k2 <= f->parts; k2++) {
            const node *v = fit_node(f, k1, k2);
            const int cells = (k1 % f->parts ? 2 : 1) * (k2 % f->parts ? 2 : 1);
            const double most = 4.0 * f->parts * f->parts / cells;
            CHECK(v->v >= least / (1 + least) * mean * (1 - 1e-4) - v->blur &&
                      v->v <= (most + least) / (1 + least) * mean * (1 + 1e-4) + v->blur,
                  "tile %u: node (%d, %d) of %d parts has %g within %g, their mean is %g", tile, k1, k2, f->parts, v->v,
                  v->blur, mean);
        }
}
/* The density at (x, y) of a texel, 0 to 1 each way, is that of the lobe and light times the fit of the tile. */
static void check_place(const sampler *d, uint32_t c, uint32_t r, double x, double y, const fit *f, const span *s,
                        double row_slack) {
    const scene *m = d->m;
    const double light = m->light[(size_t)r * m->w + c];
    const mcs_vec3 w = point(m->w, m->h, c, r, 0.01 + 0.98 * x, 0.01 + 0.98 * y);
    double want = 0;
    double tol = 0;
    const double all = density(d, w);
    const double rest = tile_density(d, w);
    double visible;
    reflect_f(d->s, w, &visible);
    /* and the mixture's rounding */
    CHECK(fabs(all - rest - d->share * visible) <= d->share * lobe_off(d->s, w, visible) + 4 * eps * rest,
          "texel (%u, %u): density %g of tiles, %g of the lobe, %g in all", c, r, rest, d->share * visible, all);
    if (light > 0) {
        const double t1 = s->t1 + (0.01 + 0.98 * x) * s->part1;
        const double t2 = s->t2 + (0.01 + 0.98 * y) * s->part2;
        const places off = places_off(m, s, r, row_slack);
        const doubt o = fit_doubt(f, t1, t2, off);
        want = light * fit_at(f, t1, t2);
        tol = want * 2 * (slack_of_row(m, r) + slack_of(m, light, r) + row_slack + 8 * eps) +
              light * (varies(&o, off) + o.blur);
    }
    CHECK(rest >= 0 && rest <= FLT_MAX && fabs(rest - want) <= tol,
          "texel (%u, %u), %g of it across and %g down: density %.8g, not %.8g within %.2g; %d parts", c, r, x, y, rest,
          want, tol, f->parts);
}
/* At the middle of a texel, and at a random place of every other one. Adds what the lobe has there to `seen`; returns
 * what the texel has of the density. */
static double check_texel(const sampler *d, uint32_t c, uint32_t r, const fit *f, double row_slack, double *seen) {
    const scene *m = d->m;
    const double light = m->light[(size_t)r * m->w + c];
    span s = {0, 1, 0, 1, 0};
    double lobe_mass = 0;
    if (light > 0) s = span_of(m, c, r);
    check_place(d, c, r, 0.5, 0.5, f, &s, row_slack);
    if ((r + c) % 2)
        check_place(d, c, r, (double)hash01(r * m->w + c, 20), (double)hash01(r * m->w + c, 21), f, &s, row_slack);
    if (d->share > 0) lobe_mass = texel_mass(m, d->s, c, r).visible;
    *seen += lobe_mass;
    return (light > 0 ? fmax(light * fit_mean(f, &s), 0) : 0) * m->area[r] + d->share * lobe_mass;
}
/* Density times solid angle over the whole map is 1 less what the lobe loses; within a tile it goes with the light
 * times its fit. The number of tiles of many parts. */
static int check_density(const sampler *d) {
    static const span whole = {0, 1, 0, 1, 0};
    const scene *m = d->m;
    const uint32_t n = m->w * m->h;
    double sum = 0;
    double seen = 0;
    double least_factor = 0;
    double most_factor = INFINITY;
    int fine = 0;
    for (uint32_t tile = 0; tile < 2 * m->rows * m->rows; tile++) {
        const box b = tile_box(m, tile);
        const fit f = fit_tile(d, tile);
        const double mean = fit_mean(&f, &whole);
        const double row_slack = slack_of_tile(m, b);
        fine += f.parts > 1;
        check_range_of_nodes(tile, &f, mean);
        if (f.parts > 1) check_nodes(d, tile, &f, mean, &least_factor, &most_factor);
        for (uint32_t r = b.r0; r < b.r1; r++)
            for (uint32_t c = b.c0; c < b.c1; c++) {
                expected[r * m->w + c] = check_texel(d, c, r, &f, row_slack, &seen);
                sum += expected[r * m->w + c];
            }
    }
    expected[n] =
        d->share * fmax(1 - seen, 0); /* a lobe high over the horizon loses less than the quadrature is wrong by */
    CHECK(fabs(sum + expected[n] - 1) <= 1e-5, "the density integrates to %g, the lobe loses %g", sum, expected[n]);
    CHECK(fine <= d->most_fine, "%d tiles of many parts", fine);
    CHECK(least_factor <= most_factor,
          "tiles of many parts: at least %.9g of the reflection in one, at most %.9g in another", least_factor,
          most_factor);
    return fine;
}

static void check_counts(const sampler *d, int count, mcs_pcg32 *rng, double tests) {
    static float u1[CHUNK], u2[CHUNK], x[CHUNK], y[CHUNK], z[CHUNK], pdf[CHUNK];
    const uint32_t n = d->m->w * d->m->h;
    double all = 0;
    for (uint32_t j = 0; j <= n; j++) {
        observed[j] = 0;
        all += expected[j];
    }
    int i;
    for (i = 0; i < count; i += CHUNK) {
        fill(rng, CHUNK, u1, u2);
        mcs_product_sample_n(d->p, tiles_of(d->m), env_of(d->m), CHUNK, u1, u2, x, y, z, pdf, NULL, NULL);
        for (int k = 0; k < CHUNK; k++) {
            mcs_vec3 w;
            w.x = x[k];
            w.y = y[k];
            w.z = z[k];
            if (pdf[k] > 0) {
                double col, row;
                texel_of(d->m->w, d->m->h, w, &col, &row);
                observed[(uint32_t)(row < d->m->h ? row : d->m->h - 1) * d->m->w +
                         (uint32_t)(col < d->m->w ? col : d->m->w - 1)] += 1;
            } else {
                observed[n] += 1;
                CHECK(d->share > 0, "u = %a, %a: lost", (double)u1[k], (double)u2[k]);
            }
            if (k % 32 == 0 && pdf[k] > 0) {
                const mcs_texel t = draw(d, u1[k], u2[k]);
                CHECK(agrees(d, t), "u = %a, %a: pdf %g, returned %g, within %g", (double)u1[k], (double)u2[k],
                      density(d, t.w), (double)t.pdf, apart(d, t));
            }
        }
    }
    for (uint32_t j = 0; j <= n; j++) expected[j] *= i / all;
    double stat;
    int dof;
    const double p = chi2_test(observed, expected, n + 1, &stat, &dof);
    /* not a number: everything in one bin, where a miss has been counted as impossible */
    CHECK(p >= sidak(level, tests) || (isnan(p) && dof == 0), "p = %g, chi-square %g with %d degrees of freedom", p,
          stat, dof);
}

/* How far light rises over the horizon. */
static double rises(const scene *m, const surface *s) {
    double top = -1;
    for (uint32_t r = 0; r < m->h; r++)
        for (uint32_t c = 0; c < m->w; c++)
            if (m->light[(size_t)r * m->w + c] > 0) top = fmax(top, highest(m, s->n, c, r, 1));
    return top;
}

/* Directions of the normal that a case looks at. All at a scale of 1. The density of every texel and its quadrature
 * cost the same however few samples there are, so below 1 a case takes that part of its normals, rounded up. The cases
 * begin with different ones: maps and lobes together still meet all of them. A normal that is looked at
 * is so in full. */
static int normals_tried(void) { return scale() < 1 ? (int)ceil(NORMALS * scale()) : NORMALS; }

/* How often a share for the lobe and tiles of many parts were met. */
typedef struct {
    int shared, fine;
} met;

static void check_normal(const scene *m, const surface *s, mcs_pcg32 *rng, double tests, met *all) {
    const int count = (int)(10000 * scale()) + CHUNK;
    const int lit = rises(m, s) > 1e-3;
    sampler d = sampler_make(m, s);
    CHECK(!lit || !d.dark, "there is light, but the product is dark");
    all->shared += d.share > 0;
    if (!d.dark && lit) {
        all->fine += check_density(&d);
        check_counts(&d, count, rng, tests);
    }
    sampler_free(&d);
}

static void test_chi2(void) {
    static const struct {
        const char *name;
        light_fn value;
    } maps[] = {{"smooth", v_smooth}, {"sun", v_sun}, {"noise", v_noise}, {"one texel", v_one_texel}, {"half", v_half}};
    enum { MAPS = (int)(sizeof maps / sizeof *maps) };
    const int tried = normals_tried();
    const double tests = (double)(MAPS * LOBES) * tried;
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 71);
    met all = {0, 0};
    mcst_group("product, chi-square");
    for (int a = 0; a < MAPS; a++)
        for (int l = 0; l < LOBES; l++) {
            const uint32_t rows = (a + l) % 3 ? 16 : (a + l) % 2 ? 64 : 32;
            const uint32_t odd = (uint32_t)(a + l) % 4 == 3;
            const int first = tried < NORMALS ? (a * LOBES + l) * tried % NORMALS : 0;
            if (!mcst_case("%s, %s", maps[a].name, lobes[l].name)) continue;
            scene m = scene_make(maps[a].name, odd ? 50 : 64, odd ? 25 : 32, maps[a].value, rows);
            expected = (double *)memory((m.w * m.h + 1) * sizeof *expected);
            observed = (double *)memory((m.w * m.h + 1) * sizeof *observed);
            for (int k = 0; k < tried; k++) {
                const int b = (first + k) % NORMALS;
                surface s = surface_make(normals[b], local_wo(0.25 + 0.12 * b, 0.3 * b), lobes[l]);
                s.r.draws = b % 3 ? 64 : (uint32_t)(a + l) % 2;
                check_normal(&m, &s, &rng, tests, &all);
            }
            free(expected);
            free(observed);
            scene_free(&m);
        }
    if (mcst_case("a share for the lobe was tested")) CHECK(all.shared > 10 || mcst.filter, "%d times", all.shared);
    if (mcst_case("tiles of many parts were tested")) CHECK(all.fine > 100 || mcst.filter, "%d times", all.fine);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    test_chi2();
    return mcst_finish();
}
