/* Products of environment, reflection and cosine: their density, texel by texel, against light, fit of the tile and
 * lobe; samples against the integral of the density. MCS_TEST_SCALE scales the number of samples. */
#include "stats.h"
#include "product_sampler.h"

/* ---- fits ---- */

/* Every node from the cell that knows it best. 0: no light. */
static int fit_parts(fit *f, int parts) {
    f->parts = parts;
    f->known = 1;
    for (int k = 0; k < (parts + 1) * (parts + 1); k++) f->at[k].blur = INFINITY;
    for (int c = 0; c < parts * parts; c++) {
        const int k1 = c / parts;
        const int k2 = c % parts;
        double v[4], blur;
        if (!look_at_cell(f, k1, k2, v, &blur)) {
            *f = fit_start(f->d, f->tile);
            f->known = 1; /* black */
            return 0;
        }
        CHECK(blur < INFINITY, "tile %u: cell (%d, %d) of %d parts cannot be known", f->tile, k1, k2, parts);
        for (int k = 0; k < 4; k++) {
            node *n = f->at + (k1 + (k >> 1)) * (parts + 1) + k2 + (k & 1);
            if (n->blur < INFINITY)
                CHECK(fabs(v[k] - n->v) <= blur + n->blur, "tile %u: cell (%d, %d) has %g at a node, another %g",
                      f->tile, k1, k2, v[k], n->v);
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
static fit fit_tile(const sampler *d, uint32_t tile) {
    fit f = fit_start(d, tile);
    if (!fit_parts(&f, 1) || !d->most_fine) return f;
    for (int k = 0; k < 16; k++) {
        const double t1 = (k / 4 * 2 + 0.5) / FINE;
        const double t2 = (k % 4 * 2 + 0.5) / FINE;
        look l;
        if (!look_at(&f, t1, t2, &l)) continue;
        const doubt o = fit_doubt(&f, t1, t2, l.off);
        if (fabs(l.q - fit_at(&f, t1, t2)) <= l.blur + o.blur + varies(&o, l.off)) continue;
        fit_parts(&f, FINE);
        break;
    }
    return f;
}
/* The part of a stretch of places that lies in cell k, between *from and the result. */
static double fit_piece(const fit *f, double t, double part, int k, double *from) {
    *from = fmax(t, (double)k / f->parts);
    return fmax(*from, fmin(t + part, (k + 1.0) / f->parts));
}
/* Its mean over a texel, or the tile: over a piece in one cell, where it is bilinear, it is that of the middle. */
static double fit_mean(const fit *f, const span *s) {
    double sum = 0;
    for (int i = 0; i < f->parts; i++)
        for (int j = 0; j < f->parts; j++) {
            double x0, y0;
            const double x1 = fit_piece(f, s->t1, s->part1, i, &x0);
            const double y1 = fit_piece(f, s->t2, s->part2, j, &y0);
            sum += (x1 - x0) * (y1 - y0) * fit_at(f, 0.5 * (x0 + x1), 0.5 * (y0 + y1));
        }
    return sum / (s->part1 * s->part2);
}

/* ---- nodes ---- */

/* Reflection as tiles have it towards a place of one, and the ten-thousandth of a white surface's that each value has
 * got; negative: no light. `sharp`: what that may be wrong by, relative, from a direction rounded by 8 eps: where D of
 * GGX is steepest, where the others are. Their falloff is the 256th power of a sum and a quotient, by eight squares
 * (767 eps), of an x with some 32. */
static double reflect_at(const fit *f, double t1, double t2, spot *at, double *sharp) {
    const surface *s = f->d->s;
    *sharp = (2 / fmin(s->ax, s->ay) + 4) * 8 * eps;
    if (!spot_at(f->d->m, f->b, fmax(0, fmin(t1, 1 - 0x1p-32)), fmax(0, fmin(t2, 1 - 0x1p-32)), at)) return -1;
    double v[3];
    to3(v, at->w);
    if (s->r.profile != MCS_PROFILE_GGX) {
        const fall of = fall_at(s, v);
        const double root = fmin(of.root, 8);
        *sharp = (2 * root / of.scale + 4 / s->wo[2]) * 8 * eps + (767 + 32 * root * root) * eps;
    }
    double visible;
    return reflect_as(s, v, 1, &visible) + 1e-4 / pi;
}
/* The place that a node stands for: its own, but the outer ones for those a hundredth off the border. */
static double place_of_node(int k) { return k == 0 ? 0.01 : k == FINE ? 0.99 : (double)k / FINE; }
/* A node, and the reflection that it stands for; what either may be wrong by. */
typedef struct {
    double v, blur, wanted, off;
} known_node;
/* 0: there is no light, or the node may lie in another texel. */
static int know_node(const fit *f, int k1, int k2, known_node *n) {
    const double t1 = place_of_node(k1);
    const double t2 = place_of_node(k2);
    double sharp;
    spot at, beside;
    n->wanted = reflect_at(f, t1, t2, &at, &sharp);
    if (!(n->wanted > 0)) return 0;
    const places off = places_off(f, &at.s, at.c, at.r);
    if (!(fmin(t1 - at.s.t1, at.s.t1 + at.s.part1 - t1) > off.t1)) return 0;
    if (!(fmin(t2 - at.s.t2, at.s.t2 + at.s.part2 - t2) > off.t2)) return 0;
    n->off = sharp * n->wanted;
    for (int k = 0; k < 4; k++) {
        const double by = k % 2 ? 1 : -1;
        double other;
        const double v = reflect_at(f, t1 + (k < 2 ? by * off.t1 : 0), t2 + (k < 2 ? 0 : by * off.t2), &beside, &other);
        n->off = fmax(n->off, fabs(v - n->wanted) + sharp * n->wanted);
    }
    n->v = fit_node(f, k1, k2)->v;
    n->blur = fit_node(f, k1, k2)->blur;
    return 1;
}
/* At least what a tile weighs without a grid. A lobe widened by the spread of the tile's light has a lower peak, and so
 * has reflection towards a mean direction or a corner. The peak lies in the plane of incidence. To the corners, 3 % of
 * their mean are added. */
static double most_without_grid(const surface *s) {
    const double steps = 4096;
    const double in_plane = sqrt(s->wo[0] * s->wo[0] + s->wo[1] * s->wo[1]);
    const double x = in_plane > 0 ? -s->wo[0] / in_plane : 1;
    const double y = in_plane > 0 ? -s->wo[1] / in_plane : 0;
    double most = 0;
    for (int k = 0; k < (int)steps; k++) {
        const double angle = pi / 2 * k / steps;
        double v[3];
        for (int i = 0; i < 3; i++) v[i] = sin(angle) * (x * s->s[i] + y * s->t[i]) + cos(angle) * s->n[i];
        double visible;
        most = fmax(most, reflect_as(s, v, 1, &visible) + 1e-4 / pi);
    }
    return 1.03 * most;
}
/* The nodes of a grid go with the reflection towards the places they stand for, by one factor in all tiles, which is
 * narrowed down to `least` to `most`. To each the same is added: a hundredth of their mean, or a 128th of what the tile
 * would weigh without a grid if that is more. The factor is that of the brightest and the darkest one. */
static void check_nodes(const fit *f, double mean, double *least, double *most) {
    known_node best = {0, 0, 0, 0};
    known_node dark = {0, 0, INFINITY, 0};
    int n = 0;
    known_node known[(FINE + 1) * (FINE + 1)];
    for (int k = 0; k < (FINE + 1) * (FINE + 1); k++) {
        if (!know_node(f, k / (FINE + 1), k % (FINE + 1), &known[n])) continue;
        if (known[n].wanted > best.wanted) best = known[n];
        if (known[n].wanted < dark.wanted) dark = known[n];
        n++;
    }
    if (!n || best.wanted < 2 * dark.wanted) return; /* all alike: nothing tells what was added */
    const double spread = best.wanted - dark.wanted;
    const double factor = (best.v - dark.v) / spread;
    double wrong = (best.blur + dark.blur) / (best.v - dark.v) + (best.off + dark.off) / spread;
    const double added = dark.v - factor * dark.wanted;
    const double off = dark.blur + factor * (dark.off + wrong * dark.wanted) + 16 * eps * (best.v + mean);
    const double hundredth = 0.01 / 1.01 * mean;
    CHECK(added >= hundredth - off && added <= fmax(hundredth, factor * most_without_grid(f->d->s) / 128) + off,
          "tile %u: nodes got %g, a hundredth is %g, %g without a grid", f->tile, added, hundredth,
          factor * most_without_grid(f->d->s));
    for (int k = 0; k < n; k++)
        CHECK(fabs(known[k].v - added - factor * known[k].wanted) <=
                  known[k].blur + off + factor * (known[k].off + wrong * known[k].wanted),
              "tile %u: a node has %g, not %g", f->tile, known[k].v, added + factor * known[k].wanted);
    /* Shares of rows and of columns are integers over 2^24, each at most 2 wrong; every entry adds one. */
    wrong += (4 / (mean * span_of(f->d->m, f->b.c0, f->b.r0).all) + 4.0 * f->d->m->rows) * 0x1p-24;
    *least = fmax(*least, factor * (1 - wrong));
    *most = fmin(*most, factor * (1 + wrong));
}
/* A node counts in the mean by the cells around it, a quarter of each; with nothing anywhere else it has all of that.
 * To each is added: 0.03 of the mean to corners, 0.01 on a grid. */
static void check_range_of_nodes(const fit *f, double mean) {
    const double least = f->parts > 1 ? 0.01 : 0.03;
    for (int k = 0; k < (f->parts + 1) * (f->parts + 1); k++) {
        const node *v = f->at + k;
        const int cells = (k / (f->parts + 1) % f->parts ? 2 : 1) * (k % (f->parts + 1) % f->parts ? 2 : 1);
        const double most = 4.0 * f->parts * f->parts / cells;
        CHECK(v->v >= least / (1 + least) * mean * (1 - 1e-4) - v->blur &&
                  v->v <= (most + least) / (1 + least) * mean * (1 + 1e-4) + v->blur,
              "tile %u: node %d of %d parts has %g within %g, their mean is %g", f->tile, k, f->parts, v->v, v->blur,
              mean);
    }
}

/* ---- chi-square, mass, proportion ---- */

static double *expected, *observed;
/* The density at (x, y) of a texel, 0 to 1 each way, is that of the lobe and light times the fit of the tile. */
static void check_place(const fit *f, uint32_t c, uint32_t r, double x, double y) {
    const sampler *d = f->d;
    const double light = d->m->light[(size_t)r * d->m->w + c];
    const mcs_vec3 w = point(d->m->w, d->m->h, c, r, 0.01 + 0.98 * x, 0.01 + 0.98 * y);
    const double all = density(d, w);
    const double rest = tile_density(d, w);
    double want = 0;
    double tol = 0;
    double visible;
    reflect(d->s, w, &visible);
    /* and the mixture's rounding */
    CHECK(fabs(all - rest - d->share * visible) <= d->share * lobe_off(d->s, w, visible) + 4 * eps * rest,
          "texel (%u, %u): density %g of tiles, %g of the lobe, %g in all", c, r, rest, d->share * visible, all);
    if (light > 0) {
        const span s = span_of(d->m, c, r);
        const double t1 = s.t1 + (0.01 + 0.98 * x) * s.part1;
        const double t2 = s.t2 + (0.01 + 0.98 * y) * s.part2;
        const places off = places_off(f, &s, c, r);
        const doubt o = fit_doubt(f, t1, t2, off);
        want = light * fit_at(f, t1, t2);
        tol = want * 2 * (slack_in(f, c, r) + 8 * eps) + light * (varies(&o, off) + o.blur);
    }
    CHECK(rest >= 0 && rest <= FLT_MAX && fabs(rest - want) <= tol,
          "texel (%u, %u), %g of it across and %g down: density %.8g, not %.8g within %.2g; %d parts", c, r, x, y, rest,
          want, tol, f->parts);
}
/* At the middle of a texel, and at a random place of every other one. Adds what the lobe has there to `seen`; returns
 * what the texel has of the density. */
static double check_texel(const fit *f, uint32_t c, uint32_t r, double *seen) {
    const scene *m = f->d->m;
    const double light = m->light[(size_t)r * m->w + c];
    double lobe_mass = 0;
    check_place(f, c, r, 0.5, 0.5);
    if ((r + c) % 2) check_place(f, c, r, (double)hash01(r * m->w + c, 20), (double)hash01(r * m->w + c, 21));
    if (f->d->share > 0) lobe_mass = texel_mass(m, f->d->s, c, r).visible;
    *seen += lobe_mass;
    const span s = span_of(m, c, r);
    return (light > 0 ? fmax(light * fit_mean(f, &s), 0) : 0) * m->area[r] + f->d->share * lobe_mass;
}
/* Density times solid angle over the whole map is 1 less what the lobe loses; within a tile it goes with the light
 * times its fit. The number of tiles of many parts. */
static int check_density(const sampler *d) {
    static const span whole = {0, 1, 0, 1, 0, 0};
    const scene *m = d->m;
    const uint32_t n = m->w * m->h;
    double sum = 0;
    double seen = 0;
    double least_factor = 0;
    double most_factor = INFINITY;
    int fine = 0;
    for (uint32_t tile = 0; tile < 2 * m->rows * m->rows; tile++) {
        const fit f = fit_tile(d, tile);
        const double mean = fit_mean(&f, &whole);
        fine += f.parts > 1;
        check_range_of_nodes(&f, mean);
        if (f.parts > 1) check_nodes(&f, mean, &least_factor, &most_factor);
        for (uint32_t r = f.b.r0; r < f.b.r1; r++)
            for (uint32_t c = f.b.c0; c < f.b.c1; c++) {
                expected[r * m->w + c] = check_texel(&f, c, r, &seen);
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

/* The chi-square test of so many draws: p, and the statistic with its degrees of freedom. */
typedef struct {
    double p, stat;
    int dof;
} verdict;
static verdict count_draws(const sampler *d, int count, mcs_pcg32 *rng) {
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
            observed[pdf[k] > 0 ? texel_number(d->m, w) : n] += 1;
            CHECK(pdf[k] > 0 || d->share > 0, "u = %a, %a: lost", (double)u1[k], (double)u2[k]);
            if (k % 32 || !(pdf[k] > 0)) continue;
            const mcs_texel t = draw(d, u1[k], u2[k]);
            CHECK(agrees(d, t), "u = %a, %a: pdf %g, returned %g, within %g", (double)u1[k], (double)u2[k],
                  density(d, t.w), (double)t.pdf, apart(d, t));
        }
    }
    for (uint32_t j = 0; j <= n; j++) expected[j] *= i / all;
    verdict v;
    v.p = chi2_test(observed, expected, n + 1, &v.stat, &v.dof);
    return v;
}
/* Right densities fail once in a hundred runs of all cases. So what fails is drawn again, ten times as often: a wrong
 * density fails then for certain, a right one once in ten thousand runs. */
static void check_counts(const sampler *d, int count, mcs_pcg32 *rng, double tests) {
    const double least = sidak(level, tests);
    verdict v = count_draws(d, count, rng);
    if (v.p < least) v = count_draws(d, 10 * count, rng);
    /* not a number: everything in one bin, where a miss has been counted as impossible */
    CHECK(v.p >= least || (isnan(v.p) && v.dof == 0), "p = %g, chi-square %g with %d degrees of freedom", v.p, v.stat,
          v.dof);
}

/* How far light rises over the horizon. */
static double rises(const scene *m, const surface *s) {
    double top = -1;
    for (uint32_t k = 0; k < m->w * m->h; k++)
        if (m->light[k] > 0) top = fmax(top, highest(m, s->n, k % m->w, k / m->w, 1));
    return top;
}

/* How often a share for the lobe and tiles of many parts were met. */
static int shared, fine_tiles;
static void check_normal(const scene *m, const surface *s, mcs_pcg32 *rng, double tests) {
    const int lit = rises(m, s) > 1e-3;
    sampler d = sampler_make(m, s);
    CHECK(!lit || !d.dark, "there is light, but the product is dark");
    shared += d.share > 0;
    if (!d.dark && lit) {
        fine_tiles += check_density(&d);
        check_counts(&d, (int)(10000 * scale()) + CHUNK, rng, tests);
    }
    sampler_free(&d);
}

static void test_chi2(void) {
    enum { MAPS = HALF + 1 };
    /* Directions of the normal that a case looks at, each in full. Their density costs the same however few samples
     * there are; maps and lobes together still meet all of them. */
    const int tried = (int)ceil(NORMALS * fmin(scale(), 1));
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 71);
    mcst_group("product, chi-square");
    for (int a = 0; a < MAPS; a++)
        for (int l = 0; l < LOBES; l++) {
            const uint32_t rows = (a + l) % 3 ? 16 : (a + l) % 2 ? 64 : 32;
            const uint32_t odd = (uint32_t)(a + l) % 4 == 3;
            const int first = tried < NORMALS ? (a * LOBES + l) * tried % NORMALS : 0;
            if (!mcst_case("%s, %s", picture_name[a], lobes[l].name)) continue;
            scene m = scene_make((picture)a, odd ? 50 : 64, odd ? 25 : 32, rows);
            expected = (double *)memory((m.w * m.h + 1) * sizeof *expected);
            observed = (double *)memory((m.w * m.h + 1) * sizeof *observed);
            for (int k = 0; k < tried; k++) {
                const int b = (first + k) % NORMALS;
                surface s = surface_make(normals[b], local_wo(0.25 + 0.12 * b, 0.3 * b), lobes[l]);
                check_normal(&m, &s, &rng, (double)(MAPS * LOBES) * tried);
            }
            free(expected);
            free(observed);
            scene_free(&m);
        }
    if (mcst_case("a share for the lobe and tiles of many parts were tested"))
        CHECK((shared > 10 && fine_tiles > 100) || mcst.filter, "%d and %d times", shared, fine_tiles);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    test_chi2();
    return mcst_finish();
}
