/* Products of environment, reflection and cosine: the variance of one sample, by quadrature, over those of sampling the
 * map, the BRDF and both by MIS. MCS_TEST_VERBOSE=1 prints it. MCS_TEST_MAPS: Radiance pictures, separated by spaces,
 * that are looked at, too. A part of test_product.c. */
#ifndef MCST_PRODUCT_VARIANCE_H
#define MCST_PRODUCT_VARIANCE_H
#include "../examples/hdr.h"
#include "product_sampler.h"

/* ---- variances ---- */

typedef struct {
    double env, brdf, mis, product; /* per sample, over the square of the mean */
} variances;

/* Middles of equal parts, about `sub` to a texel, of each of the pieces that a fit's cells cut it into, and the width
 * of each. */
enum { SUB_MOST = 16 };
static int middles(const fit *f, double t, double part, int sub, double *x, double *wide) {
    double at[FINE + 1];
    const int pieces = fit_pieces(f, t, part, at);
    int n = 0;
    for (int i = 0; i < pieces; i++) {
        const double size = at[i + 1] - at[i];
        const int parts = (int)ceil(sub * size);
        for (int k = 0; k < parts; k++, n++) {
            x[n] = at[i] + (k + 0.5) / parts * size;
            wide[n] = size / parts;
        }
    }
    return n;
}
/* A surface in a map. tile_rows, tile_parts: where every row of every tile begins among its light, and how much it has;
 * row_slack: of a tile, see product_sampler.h. */
typedef struct {
    const scene *m;
    const surface *s;
    const double *tile_rows, *tile_parts, *row_slack;
    sampler d;
    fit *fits;
    double mean, env, brdf, product; /* integrals of F; of F^2 over a density */
    double a_env, a_brdf, m_env;     /* of MIS with the balance heuristic: squares of either part, the mean of one */
} study;

/* A texel with light; its top and height in half the cosine's distance from 1, which is linear in what is equal areas.
 */
typedef struct {
    uint32_t c, r, tile;
    double light, top, height;
    span at;
} lit_texel;

/* The density at u of a tile is that of its fit: q of the tiles alone. */
static void check_looked_up(const study *v, const lit_texel *t, const double *w, double u1, double u2, double q) {
    const scene *m = v->m;
    double visible;
    reflect(v->s, w, &visible);
    const mcs_vec3 to = vec(w[0], w[1], w[2]);
    const double pp = q + v->d.share * visible;
    const double q2 = density(&v->d, to);
    const double lobe_wrong = lobe_off(v->s, to, visible);
    const double tol = 2 * (slack_of_row(m, t->r) + slack_of(m, t->light, t->r) + v->row_slack[t->tile] + 8 * eps);
    const places off = places_off(m, &t->at, t->r, v->row_slack[t->tile]);
    const doubt of = fit_doubt(&v->fits[t->tile], u1, u2, off);
    CHECK(fabs(q2 - pp) <= tol * q + v->d.share * lobe_wrong + 4 * eps * q2 + t->light * (varies(&of, off) + of.blur),
          "%s: density %g, not %g", m->name, q2, pp);
}

/* Adds the point (x, y) of a texel in the direction w, which stands for the solid angle a. */
static void add_point(study *v, const lit_texel *t, const double *w, double x, double y, double a, int look_up) {
    const double u1 = t->at.t1 + x * t->at.part1;
    const double u2 = t->at.t2 + y * t->at.part2;
    const double q = fmax(t->light * fit_at(&v->fits[t->tile], u1, u2), 0);
    double visible;
    const double F = t->light * reflect(v->s, w, &visible);
    if (!(F > 0)) return;
    const double pe = t->light / v->m->total;
    const double pb = v->s->matte >= 1 ? F / t->light : visible;
    if (look_up && surely_in(v->m, x, y)) check_looked_up(v, t, w, u1, u2, q);
    v->mean += a * F;
    v->env += a * F * F / pe;
    v->brdf += a * F * F / pb;
    v->product += a * F * F / (q + v->d.share * visible);
    v->a_env += a * F * F * pe / ((pe + pb) * (pe + pb));
    v->a_brdf += a * F * F * pb / ((pe + pb) * (pe + pb));
    v->m_env += a * F * pe / (pe + pb);
}

/* How many points a texel takes each way, by the size of its lobe's features; w: its middle. */
static int points_of(const study *v, const double *w, double size, int least) {
    const surface *s = v->s;
    double away = 0;
    for (int k = 0; k < 3; k++) away += (w[k] - s->mirror[k]) * (w[k] - s->mirror[k]);
    int sub = s->matte >= 1 ? 1 : (int)ceil(size / (0.35 * sqrt(s->width * s->width + away / 4)));
    if (s->profile != MCS_PROFILE_GGX) {
        const fall at = fall_at(s, w);
        sub = at.root - 2 * size / at.scale < 6 ? (int)ceil(fmin(size / (0.35 * at.scale), SUB_MOST)) : 1;
    }
    return sub > least ? sub < SUB_MOST ? sub : SUB_MOST : least;
}
/* half: half the cosine's distance from 1. */
static void direction_to(double *w, double half, double azimuth) {
    const double sine = 2 * sqrt(half * (1 - half));
    w[0] = sine * cos(azimuth);
    w[1] = sine * sin(azimuth);
    w[2] = 1 - 2 * half;
}
/* Points at the middles of equal areas, at least `least` by `least` of a texel, in each piece of it that lies in one
 * cell of the fit; the density is looked up in one texel of a thousand. */
static void add_texel(study *v, const lit_texel *t, int least) {
    const scene *m = v->m;
    const double size = pi / m->h;
    double w[3];
    direction_to(w, t->top + 0.5 * t->height, 2 * pi * (t->c + 0.5) / m->w);
    if (dot3(v->s->n, w) < -size) return;
    const int sub = points_of(v, w, size, least);
    double x[SUB_MOST + FINE], wide[SUB_MOST + FINE];
    const int across = middles(&v->fits[t->tile], t->at.t1, t->at.part1, sub, x, wide);
    double y[SUB_MOST + FINE], high[SUB_MOST + FINE];
    const int down = middles(&v->fits[t->tile], t->at.t2, t->at.part2, sub, y, high);
    const int looked_up = hash01(t->r * m->w + t->c, 22) < 1e-3f;
    for (int i = 0; i < down; i++)
        for (int j = 0; j < across; j++) {
            if (across * down > 1) direction_to(w, t->top + t->height * y[i], 2 * pi * (t->c + x[j]) / m->w);
            add_point(v, t, w, x[j], y[i], m->area[t->r] * wide[j] * high[i],
                      looked_up && i == down / 2 && j == across / 2);
        }
}
static void add_row(study *v, uint32_t r, int least) {
    const scene *m = v->m;
    const uint32_t row_tile = tile_at(m, 0, r);
    const double top = pow(sin(0.5 * pi * r / m->h), 2);
    lit_texel t = {0, 0, UINT32_MAX, 0, 0, 0, {0, 0, 0, 0, 0}};
    t.r = r;
    t.top = top;
    t.height = pow(sin(0.5 * pi * (r + 1) / m->h), 2) - top;
    for (t.c = 0; t.c < m->w; t.c++) {
        const uint32_t tile = tile_at(m, t.c, r);
        if (tile != t.tile) {
            const size_t column = (size_t)(tile - row_tile) / m->rows;
            t.tile = tile;
            t.at.t1 = t.at.part1 = 0;
            t.at.line = tile_box(m, tile).line[r];
            t.at.t2 = v->tile_rows[column * m->h + r];
            t.at.part2 = v->tile_parts[column * m->h + r];
        }
        t.light = m->light[(size_t)r * m->w + t.c];
        if (!(t.light > 0)) continue;
        t.at.t1 += t.at.part1;
        t.at.part1 = t.light / t.at.line;
        add_texel(v, &t, least);
    }
}

static variances variance_of(const scene *m, const surface *s, int least, const double *tile_rows,
                             const double *tile_parts, const double *row_slack) {
    const uint32_t tiles = 2 * m->rows * m->rows;
    int fine = 0;
    study v;
    memset(&v, 0, sizeof v);
    v.m = m;
    v.s = s;
    v.tile_rows = tile_rows;
    v.tile_parts = tile_parts;
    v.row_slack = row_slack;
    v.d = sampler_make(m, s);
    v.fits = (fit *)memory(tiles * sizeof *v.fits);
    for (uint32_t k = 0; k < tiles; k++) {
        v.fits[k] = fit_tile(&v.d, k);
        fine += v.fits[k].parts > 1;
    }
    CHECK(fine <= v.d.most_fine, "%s: %d tiles of many parts", m->name, fine);
    for (uint32_t r = 0; r < m->h; r++) add_row(&v, r, least);
    const double mean = v.mean;
    variances result;
    result.env = v.env / mean / mean - 1;
    result.brdf = v.brdf / mean / mean - 1;
    result.product = v.product / mean / mean - 1;
    /* two samples, one of each: times two for the same number of samples */
    result.mis = 2 * (v.a_env - v.m_env * v.m_env + v.a_brdf - (mean - v.m_env) * (mean - v.m_env)) / mean / mean;
    sampler_free(&v.d);
    free(v.fits);
    return result;
}

typedef struct {
    double env, brdf, mis, worst;
} ratios;

enum { VARIED = 8, SHAPED = 3, TWELVE = 12 };
/* Rows of the tables, of GGX and of the other lobes; 0: matte. */
static const float varied[VARIED] = {0, 0.8f, 0.5f, 0.3f, 0.2f, 0.1f, 0.05f, 0.02f},
                   shaped_alpha[SHAPED] = {0.3f, 0.1f, 0.05f};

static void add_map(const scene *m, mcs_profile profile, ratios *sum, int *n) {
    const int most = profile == MCS_PROFILE_GGX ? VARIED : SHAPED;
    const size_t rows = 2 * (size_t)m->rows * m->h;
    double *tile_rows = (double *)memory(rows * sizeof *tile_rows);
    double *tile_parts = (double *)memory(rows * sizeof *tile_parts);
    double row_slack[64 * 128];
    for (uint32_t c = 0; c < 2 * m->rows; c++) /* columns of tiles; rows of texels, each tile's by itself */
        for (uint32_t r = 0; r < m->rows; r++) {
            const box b = tile_box(m, c * m->rows + r);
            double all = 0;
            double *at = tile_rows + (size_t)c * m->h;
            double *part = tile_parts + (size_t)c * m->h;
            for (uint32_t y = b.r0; y < b.r1; y++) {
                at[y] = all;
                part[y] = b.line[y] * m->area[y];
                all += part[y];
            }
            for (uint32_t y = b.r0; y < b.r1 && all > 0; y++) {
                at[y] /= all;
                part[y] /= all;
            }
            row_slack[c * m->rows + r] = slack_of_tile(m, b);
        }
    for (int k = 0; k < most; k++)
        for (int i = 0; i < TWELVE; i++) {
            /* normals spread over the sphere by the golden angle, the eye at cosines of 0.35 to 0.95 */
            const double z = 1 - (2 * i + 1.0) / TWELVE;
            const double turn = 0.381966 * i;
            const double golden = fmod(0.618034 * i, 1);
            const float alpha = (profile == MCS_PROFILE_GGX ? varied : shaped_alpha)[k];
            lobe l = lobes[0];
            if (alpha > 0) {
                l.ax = l.ay = alpha;
                l.matte = 0;
                l.profile = profile;
            }
            const surface s =
                surface_make(vec(sqrt(1 - z * z) * cos(2 * pi * turn), sqrt(1 - z * z) * sin(2 * pi * turn), z),
                             local_wo(0.35 + 0.6 * golden, 2.4 * i), l);
            /* lobes and cosines are smooth on the scale of a tile, 0.2: eight points of a tile each way leave
             * 0.025^2/24 of them */
            const variances v = variance_of(m, &s, m->h / m->rows < 8 ? 2 : 1, tile_rows, tile_parts, row_slack);
            CHECK(v.product > -1e-6 && v.env > 0 && v.mis > 0, "%s, alpha %g, normal %d: variances %g, %g, %g", m->name,
                  (double)alpha, i, v.product, v.env, v.mis);
            sum[k].env += log(v.env / v.product);
            sum[k].brdf += log(v.brdf / v.product);
            sum[k].mis += log(v.mis / v.product);
            sum[k].worst = fmin(sum[k].worst, v.mis / v.product);
            n[k]++;
        }
    free(tile_rows);
    free(tile_parts);
}

static void finish(const char *what, mcs_profile profile, ratios *sum, const int *n) {
    const int most = profile == MCS_PROFILE_GGX ? VARIED : SHAPED;
    mcst_note("    %s: variance per sample, geometric means over %d\n", what, n[0]);
    mcst_note("    %-8s %10s %10s %10s %10s\n", "alpha", "env/prod", "BRDF/prod", "MIS/prod", "worst");
    for (int k = 0; k < most; k++) {
        const float alpha = (profile == MCS_PROFILE_GGX ? varied : shaped_alpha)[k];
        ratios *q = sum + k;
        q->env = exp(q->env / n[k]);
        q->brdf = exp(q->brdf / n[k]);
        q->mis = exp(q->mis / n[k]);
        mcst_note("    %-8.3g %10.4g %10.4g %10.4g %10.3g\n", alpha > 0 ? (double)alpha : INFINITY, q->env, q->brdf,
                  q->mis, q->worst);
    }
}

static void start(ratios *sum, int *n) {
    for (int k = 0; k < VARIED; k++) {
        memset(sum + k, 0, sizeof *sum);
        sum[k].worst = 1e300;
        n[k] = 0;
    }
}

static void add_own_maps(const char *what, mcs_profile profile, ratios *sum, int *n) {
    static const struct {
        const char *name;
        light_fn value;
    } maps[] = {{"smooth", v_smooth}, {"sun", v_sun}, {"room", v_room}};
    start(sum, n);
    for (int k = 0; k < 3; k++) {
        scene m = scene_make(maps[k].name, 128, 64, maps[k].value, 16);
        add_map(&m, profile, sum, n);
        scene_free(&m);
    }
    finish(what, profile, sum, n);
}

static void test_variance(void) {
    const char *list = getenv("MCS_TEST_MAPS");
    mcst_group("product, variance");
    ratios sum[VARIED];
    int n[VARIED];
    if (mcst_case("own maps")) {
        add_own_maps("own maps, 16 x 32 tiles", MCS_PROFILE_GGX, sum, n);
        /* Quadrature without noise: half of what it gave when this was written, so that weights may be changed a
         * little, but not lose a factor. */
        CHECK(sum[0].env >= 293, "matte: environment / product %g", sum[0].env);
        for (int k = 0; k < VARIED; k++) {
            static const double half[VARIED] = {144, 155, 149, 106, 60, 93, 19.4, 1.64};
            CHECK(sum[k].mis >= half[k], "row %d: MIS / product %g", k, sum[k].mis);
        }
    }
    for (int lobe_kind = 0; lobe_kind < 2; lobe_kind++) {
        static const double half[2][SHAPED] = {{81, 13.8, 2.1}, {8.2, 26, 5.6}},
                            half_worst[2][SHAPED] = {{6.9, 1.6, 0.056}, {1.2, 2.5, 0.28}};
        if (!mcst_case("own maps, %s", lobe_kind ? "Phong" : "Gauss")) continue;
        add_own_maps(lobe_kind ? "Phong, own maps, 16 x 32 tiles" : "Gauss, own maps, 16 x 32 tiles",
                     lobe_kind ? MCS_PROFILE_PHONG : MCS_PROFILE_GAUSS, sum, n);
        for (int k = 0; k < SHAPED; k++) /* half of what it gave, too */
            CHECK(sum[k].mis >= half[lobe_kind][k] && sum[k].worst >= half_worst[lobe_kind][k],
                  "row %d: MIS / product %g, at worst %g", k, sum[k].mis, sum[k].worst);
    }
    if (list && *list && mcst_case("captured maps")) {
        char *names = (char *)memory(strlen(list) + 1);
        start(sum, n);
        memcpy(names, list, strlen(list) + 1);
        for (char *name = strtok(names, " "); name; name = strtok(NULL, " ")) {
            hdr_picture p;
            const int ok = hdr_read(&p, name);
            CHECK(ok, "%s: %s", name, p.fault);
            if (!ok) continue;
            float *light;
            light = (float *)memory((size_t)p.w * p.h * sizeof *light);
            for (size_t i = 0; i < (size_t)p.w * p.h; i++) {
                float c[3];
                hdr_color(&p, i, c);
                light[i] = 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
            }
            free(p.pixel);
            scene m = scene_from(name, p.w, p.h, light, 16);
            add_map(&m, MCS_PROFILE_GGX, sum, n);
            scene_free(&m);
        }
        finish("captured maps, 16 x 32 tiles", MCS_PROFILE_GGX, sum, n);
        CHECK(sum[0].env >= 60, "matte: environment / product %g", sum[0].env);
        for (int k = 1; k <= 4; k++)
            CHECK(sum[k].mis >= 20, "alpha %g: MIS / product %g", (double)varied[k], sum[k].mis);
        free(names);
    }
}
#endif
