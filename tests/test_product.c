/* Product of environment, reflection and cosine: means against the integral of the picture itself, for surfaces, for
 * weights of the caller and for mutants, and how fast well-spread points come near. MCS_TEST_SCALE scales the number of
 * samples, from 10 on there are 1e7 for every mean. The parts about edges and about variance lie in headers of their
 * own: one program takes less time to compile than three. */
#include "product_edges.h"
#include "product_variance.h"

/* ---- means ---- */

typedef struct {
    double mean, error;
} estimate;

static estimate estimate_of(const sampler *d, int count, uint64_t stream) {
    static float u1[CHUNK], u2[CHUNK], x[CHUNK], y[CHUNK], z[CHUNK], pdf[CHUNK];
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, stream);
    double sum = 0;
    double sum2 = 0;
    double shift = -1;
    int n = 0;
    for (int i = 0; i < count; i += CHUNK) {
        fill(&rng, CHUNK, u1, u2);
        mcs_product_sample_n(d->p, tiles_of(d->m), env_of(d->m), CHUNK, u1, u2, x, y, z, pdf, NULL, NULL);
        for (int k = 0; k < CHUNK; k++, n++) {
            double v = 0;
            mcs_vec3 w;
            w.x = x[k];
            w.y = y[k];
            w.z = z[k];
            double c, row;
            texel_of(d->m->w, d->m->h, w, &c, &row);
            const uint32_t col = c < d->m->w ? (uint32_t)c : d->m->w - 1;
            const uint32_t at = row < d->m->h ? (uint32_t)row : d->m->h - 1;
            double visible;
            if (pdf[k] > 0) v = d->m->light[(size_t)at * d->m->w + col] * reflect_f(d->s, w, &visible) / (double)pdf[k];
            if (shift < 0) shift = v; /* sums about a value of the right size keep their digits */
            sum += v - shift;
            sum2 += (v - shift) * (v - shift);
        }
    }
    estimate r;
    r.mean = shift + sum / n;
    r.error = sqrt(fmax(sum2 - sum * sum / n, 0) / ((double)n - 1) / n);
    return r;
}

static void test_mean(void) {
    static const struct {
        const char *name;
        light_fn value;
        uint32_t w, h, rows;
        int lobe, normal;
        double cosine;
    } cases[] = {
        {"smooth", v_smooth, 64, 32, 16, 0, 4, 0.7}, {"sun", v_sun, 64, 32, 16, 0, 6, 0.7},
        {"half", v_half, 50, 25, 16, 1, 2, 0.5},     {"noise", v_noise, 64, 32, 32, 2, 5, 0.4},
        {"sun", v_sun, 100, 47, 16, 3, 0, 0.8},      {"smooth", v_smooth, 64, 32, 32, 4, 1, 0.6},
        {"sparse", v_sparse, 40, 20, 32, 6, 3, 0.6}, {"room", v_room, 64, 32, 16, 7, 4, 0.9},
        {"smooth", v_smooth, 64, 32, 16, 8, 4, 0.5}, {"room", v_room, 64, 32, 16, 9, 0, 0.6},
        {"sun", v_sun, 64, 32, 16, 10, 5, 0.7},      {"noise", v_noise, 64, 32, 32, 11, 4, 0.5},
        {"room", v_room, 100, 47, 16, 12, 6, 0.8},   {"smooth", v_smooth, 50, 25, 16, 13, 2, 0.6},
        {"room", v_room, 64, 32, 32, 14, 3, 0.4},    {"sparse", v_sparse, 40, 20, 16, 15, 4, 0.7},
        {"half", v_half, 64, 32, 16, 16, 0, 0.9},    {"room", v_room, 160, 80, 64, 2, 5, 0.4},
        {"half", v_half, 50, 25, 64, 0, 4, 0.6},     {"sun", v_sun, 128, 64, 64, 10, 2, 0.7},
    };
    enum { CASES = (int)(sizeof cases / sizeof *cases) };
    const double f = scale();
    const int count = (int)(f >= 10 ? 1e7 : f < 1 ? 1e6 * f : 1e6);
    mcst_group("product, means");
    for (int i = 0; i < CASES; i++) {
        if (!mcst_case("%s, %s", cases[i].name, lobes[cases[i].lobe].name)) continue;
        scene m = scene_make(cases[i].name, cases[i].w, cases[i].h, cases[i].value, cases[i].rows);
        const surface s =
            surface_make(normals[cases[i].normal], local_wo(cases[i].cosine, 0.11 * i), lobes[cases[i].lobe]);
        sampler d = sampler_make(&m, &s);
        const double truth = true_light(&m, &s);
        const estimate e = estimate_of(&d, count, 80 + (uint64_t)i);
        /* Four standard errors: 6e-5 for one, 1.2e-3 for all; 1e-6 for the quadrature and the densities as floats. */
        CHECK(fabs(e.mean - truth) <= 4 * e.error + 1e-6 * truth, "mean %.7g with error %.2g, not %.7g", e.mean,
              e.error, truth);
        CHECK(lobes[cases[i].lobe].ax >= 0.03f || d.share > 0, "no share for the lobe");
        mcst_note("    %-28s mean %.7g, off by %5.2f standard errors of %.1e\n", mcst.name, e.mean,
                  (e.mean - truth) / e.error, e.error / truth);
        sampler_free(&d);
        scene_free(&m);
    }
}

/* ---- weights of the caller; mutants ---- */

enum { PHONG, WARD, BECKMANN, ASHIKHMIN, MODELS };
/* Reflection times cosine of a lobe of the header. */
static double model(int k, mcs_vec3 wo, mcs_vec3 wi) {
    double f = 0;
    if (k == PHONG) {
        const mcs_phong m = mcs_phong_make(20);
        f = (double)mcs_phong_eval(&m, wo, wi);
    } else if (k == WARD) {
        const mcs_ward m = mcs_ward_make(0.3f, 0.2f, MCS_WARD_GMD);
        f = (double)mcs_ward_eval(&m, wo, wi);
    } else if (k == BECKMANN) {
        const mcs_beckmann m = mcs_beckmann_make(0.4f, 0.4f);
        f = (double)mcs_beckmann_eval(&m, wo, wi);
    } else {
        const mcs_ashikhmin m = mcs_ashikhmin_make(30, 10);
        f = (double)mcs_ashikhmin_eval(&m, wo, wi);
    }
    return wi.z > 0 ? f * (double)wi.z : 0;
}

/* Weights of tiles for a lobe; no tile is left out. */
static float *weights_of_model(int k, const scene *m, const surface *s) {
    const uint32_t n = 2 * m->rows * m->rows;
    float *weight = (float *)memory(n * sizeof *weight);
    for (uint32_t q = 0; q < n; q++) {
        mcs_vec3 w = mcs_to_local(&s->r.frame, mcs_tiles_direction(tiles_of(m), env_of(m), q));
        /* a tile may reach above the horizon when its mean direction does not */
        w = w.z < 0.1f ? vec(w.x, w.y, 0.1) : w;
        weight[q] = (float)model(k, s->r.wo, w) + 1e-3f;
    }
    return weight;
}
/* The reflected light, by midpoints; and that the density is where light is, and one in all. */
static double check_model_density(int k, const sampler *d) {
    enum { SUB = 16 };
    const scene *m = d->m;
    const mcs_reflection *r = &d->s->r;
    double truth = 0;
    double sum = 0;
    for (uint32_t y = 0; y < m->h; y++)
        for (uint32_t x = 0; x < m->w; x++) {
            const double light = m->light[y * m->w + x];
            const double omega = m->area[y];
            const double p = density(d, point(m->w, m->h, x, y, 0.5, 0.5));
            CHECK((p > 0) == (light > 0), "texel (%u, %u): density %g of light %g", x, y, p, light);
            sum += p * omega;
            for (int i = 0; i < SUB * SUB; i++) {
                const mcs_vec3 w = point(m->w, m->h, x, y, (i / SUB + 0.5) / SUB, (i % SUB + 0.5) / SUB);
                truth += light * omega / (SUB * SUB) * model(k, r->wo, mcs_to_local(&r->frame, w));
            }
        }
    CHECK(fabs(sum - 1) <= 1e-5, "the density integrates to %g", sum);
    return truth;
}
static void check_model(int k) {
    const double f = scale();
    const int count = (int)(f >= 10 ? 1e7 : f < 1 ? 3e5 * f : 3e5);
    double sum = 0;
    double sum2 = 0;
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 73);
    scene m = scene_make("sun", 64, 32, k % 2 ? v_sun : v_room, k < 2 ? 16 : 32);
    const surface s = surface_make(normals[3 + k], local_wo(0.5 + 0.1 * k, 0.2 * k), lobes[0]);
    float *weight = weights_of_model(k, &m, &s);
    sampler d = sampler_weights(&m, &s, weight);
    CHECK(d.status == MCS_OK && !d.dark, "build returns %d, dark: %d", (int)d.status, d.dark);
    const double truth = check_model_density(k, &d);
    for (int i = 0; i < count; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_texel t = mcs_product_sample(d.p, tiles_of(d.m), env_of(d.m), u1, u2);
        double v = 0;
        if (t.pdf > 0)
            v = m.light[t.row * m.w + t.col] * model(k, s.r.wo, mcs_to_local(&s.r.frame, t.w)) / (double)t.pdf;
        sum += v;
        sum2 += v * v;
        if (i % 64 == 0)
            CHECK(t.pdf > 0 && agrees(&d, t), "u = %a, %a: pdf %g, returned %g", (double)u1, (double)u2,
                  density(&d, t.w), (double)t.pdf);
    }
    const double error = sqrt(fmax(sum2 - sum * sum / count, 0) / count / (count - 1.0));
    /* midpoints 1/16 of a texel apart, 0.006, in lobes wider than 0.1: (0.006/0.1)^2 / 24 */
    CHECK(fabs(sum / count - truth) <= 4 * error + 1.5e-4 * truth, "mean %g with error %g, not %g", sum / count, error,
          truth);
    free(weight);
    sampler_free(&d);
    scene_free(&m);
}

/* One tile alone has weight (kind 1), or the others have 1e-44 (kind 2), or all have the same (kind 0). */
static void check_far_weights(const scene *m, const surface *s, float size, int kind) {
    uint32_t bad = 0;
    double sum = 0;
    float weight[512];
    for (uint32_t q = 0; q < 512; q++) weight[q] = !kind || q == 100 ? size : kind == 1 ? 0 : 1e-44f;
    sampler d = sampler_weights(m, s, weight);
    CHECK(d.status == MCS_OK && !d.dark, "%g: build returns %d, dark: %d", (double)size, (int)d.status, d.dark);
    for (uint32_t r = 0; r < 32; r++)
        for (uint32_t c = 0; c < 64; c++) {
            const double p = density(&d, point(64, 32, c, r, 0.5, 0.5));
            bad += !(p >= 0) || (p > 0) != (weight[tile_at(m, c, r)] > 0);
            sum += p * m->area[r];
        }
    CHECK(bad == 0, "weights of %g: %u texels that can be drawn and should not, or the other way", (double)size, bad);
    CHECK(fabs(sum - 1) <= 1e-5, "weights of %g: the density integrates to %g", (double)size, sum);
    check_sane(&d, 1);
    sampler_free(&d);
}
/* An infinite weight is a sun, other bad ones are black. Kind 1: none is good; 2: nor infinite. */
static void check_bad_weights(const scene *m, const surface *s, int kind) {
    static const float wrong[] = {NAN, INFINITY, -1, -0.0f, -INFINITY};
    float weight[512];
    for (uint32_t q = 0; q < 512; q++) weight[q] = kind || q % 3 ? wrong[q % 5] : 1;
    for (uint32_t q = 0; kind == 2 && q < 512; q++) weight[q] = weight[q] > 0 ? NAN : weight[q];
    sampler d = sampler_weights(m, s, weight);
    CHECK(d.status == MCS_OK && d.dark == (kind == 2), "build returns %d, dark: %d", (int)d.status, d.dark);
    check_sane(&d, 1);
    for (uint32_t r = 0; r < 32; r++)
        for (uint32_t c = 0; c < 64; c++) {
            const double p = density(&d, point(64, 32, c, r, 0.5, 0.5));
            const double want = weight[tile_at(m, c, r)];
            CHECK(p >= 0 && p <= FLT_MAX && (p > 0) == (want > 0), "texel (%u, %u): density %g of weight %g", c, r, p,
                  want);
        }
    sampler_free(&d);
}

static void test_weights(void) {
    static const char *const names[] = {"Phong 20", "Ward 0.3 x 0.2", "Beckmann 0.4", "Ashikhmin-Shirley 30, 10"};
    static const float sizes[] = {1e-44f, 1e-38f, 1e-35f, 1e-30f, 1e-10f, 1, 1e10f, 1e30f, 3e38f};
    mcst_group("product, weights");
    for (int k = 0; k < MODELS; k++)
        if (mcst_case("%s", names[k])) check_model(k);
    const surface s = surface_make(normals[4], local_wo(0.5, 0), lobes[0]);
    if (mcst_case("weights far from 1")) {
        scene m = scene_make("sun", 64, 32, v_sun, 16);
        for (int k = 0; k < 3 * (int)(sizeof sizes / sizeof *sizes); k++)
            check_far_weights(&m, &s, sizes[k / 3], k % 3);
        scene_free(&m);
    }
    if (mcst_case("bad weights")) {
        scene m = scene_make("sun", 64, 32, v_sun, 16);
        for (int k = 0; k < 3; k++) check_bad_weights(&m, &s, k);
        scene_free(&m);
    }
}

/* What drops a part of the support must be seen: by the support test, and as bias. */
static void test_mutants(void) {
    static const char *const names[] = {"tile weight by the mean direction alone", "a low tile dropped",
                                        "a bright tile dropped"};
    const double f = scale();
    const int count = (int)(f >= 10 ? 1e7 : f < 1 ? 2e6 * f : 2e6);
    mcst_group("product, mutants");
    for (int k = 0; k < 3; k++) {
        uint32_t c = 0;
        uint32_t r = 0;
        uint32_t drop = 512;
        double best = 2;
        if (!mcst_case("%s", names[k])) continue;
        scene m = scene_make("", 64, 32, k ? v_noise : v_rim, 16);
        const surface s = surface_make(normals[4], local_wo(0.7, 0.1), lobes[0]);
        float weight[512];
        for (uint32_t q = 0; q < 512; q++) {
            const mcs_vec3 w = mcs_tiles_direction(tiles_of(&m), env_of(&m), q);
            const double z = s.n[0] * w.x + s.n[1] * w.y + s.n[2] * w.z;
            weight[q] = z > 0 ? (float)z : 0;
            if (k) weight[q] = (float)fmax(z, 0.02);
            if (fabs(z - (k == 1 ? 0.3 : 0.9)) < best) {
                best = fabs(z - (k == 1 ? 0.3 : 0.9));
                drop = q;
            }
        }
        sampler d = sampler_weights(&m, &s, weight);
        const double truth = true_light(&m, &s);
        estimate e;
        if (k) {
            CHECK(unsupported(&d, 4, &c, &r) == 0, "the whole one fails");
            e = estimate_of(&d, count, 90);
            CHECK(fabs(e.mean - truth) <= 4 * e.error + 1e-6 * truth, "the whole one: mean %g with error %g, not %g",
                  e.mean, e.error, truth);
            sampler_free(&d);
            weight[drop] = 0;
            d = sampler_weights(&m, &s, weight);
        }
        const int bad = unsupported(&d, 4, &c, &r);
        CHECK(bad > 0, "not seen by the support");
        e = estimate_of(&d, count, 91);
        /* At least 0.2 % of the integral is missed and more of the rim; the error is about a third of the mean over
         * sqrt(n), 0.023 % here: 8 of it. The fewer samples of a small MCS_TEST_SCALE cannot tell. */
        if (count >= 2000000)
            CHECK(!(fabs(e.mean - truth) <= 4 * e.error + 1e-6 * truth), "mean %g with error %g, truth %g", e.mean,
                  e.error, truth);
        mcst_note("    %-48s %4d texels, mean off by %.1f standard errors\n", names[k], bad,
                  (e.mean - truth) / e.error);
        sampler_free(&d);
        scene_free(&m);
    }
}

/* ---- well-spread points ---- */

enum { SPREAD_STEPS = 11 };
static int spread_seeds(void) { return scale() < 1 ? 32 : 64; }
/* Errors of means of scrambled Sobol points at 64, 128, ... of them. */
typedef struct {
    int seeds, steps;
    double square[SPREAD_STEPS]; /* sum over seeds of squared relative errors */
    double sum2;                 /* of all samples' squares */
} spread;

static void add_seed(const sampler *d, uint32_t key, double truth, spread *e) {
    const scene *m = d->m;
    double sum = 0;
    int step = 0;
    for (uint32_t i = 0; i < 64u << (e->steps - 1); i++) {
        const mcs_texel t = draw(d, mcs_sobol(i, 0, key), mcs_sobol(i, 1, key));
        double v = 0;
        double visible;
        if (t.pdf > 0) v = m->light[t.row * m->w + t.col] * reflect_f(d->s, t.w, &visible) / (double)t.pdf;
        sum += v;
        e->sum2 += v * v;
        if (i + 1 == 64u << step) {
            e->square[step] += pow(sum / (i + 1) / truth - 1, 2);
            step++;
        }
    }
}
/* Least squares of the logarithm of the error over that of the number of points. */
static double slope_of(const spread *e) {
    double sx = 0;
    double sy = 0;
    double sxx = 0;
    double sxy = 0;
    for (int step = 0; step < e->steps; step++) {
        const double x = log(64u << step);
        const double y = 0.5 * log(e->square[step] / e->seeds);
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return (e->steps * sxy - sx * sy) / (e->steps * sxx - sx * sx);
}
/* Adds the logarithm of how much better they are than independent points, and the slope. */
static void check_spread(const scene *m, const surface *s, double *gain, double *rate) {
    spread e = {spread_seeds(), scale() >= 10 ? SPREAD_STEPS : 7, {0}, 0};
    const uint32_t most = 64u << (e.steps - 1);
    sampler d = sampler_make(m, s);
    const double truth = true_light(m, s);
    CHECK(!(d.share > 0), "share %g", d.share);
    for (int seed = 0; seed < e.seeds; seed++) add_seed(&d, (uint32_t)(mcst.seed + 7919u * (uint32_t)seed), truth, &e);
    const double slope = slope_of(&e);
    const double alone = sqrt((e.sum2 / e.seeds / most / truth / truth - 1) / most);
    const double error = sqrt(e.square[e.steps - 1] / e.seeds);
    mcst_note("    %-32s error %.2e at 64, %.2e at %u, 1/%.1f of independent: N^%.2f%s\n", mcst.name,
              sqrt(e.square[0] / e.seeds), error, most, alone / error, slope, slope <= -0.9 ? "" : ", -0.9 not met");
    CHECK(error <= alone, "error %.2e at %u, of independent points %.2e", error, most, alone);
    *gain += log(alone / error);
    *rate += slope;
    sampler_free(&d);
}

static void test_spread(void) {
    const int seeds = spread_seeds();
    double gain = 0;
    double rate = 0;
    int cases = 0;
    mcst_group("product, spread points");
    for (int k = 0; k < 4; k++) {
        const int shiny = k % 2;
        const int room = k / 2;
        lobe l = lobes[0];
        if (shiny) {
            l.matte = 0;
            l.ax = l.ay = 0.3f;
            l.name = "alpha 0.3";
        }
        if (!mcst_case("%s, %s", room ? "room" : "smooth", l.name)) continue;
        scene m = scene_make("", 256, 128, room ? v_room : v_smooth, 16);
        const surface s = surface_make(normals[4], local_wo(0.7, 0.3), l);
        check_spread(&m, &s, &gain, &rate);
        cases++;
        scene_free(&m);
    }
    /* The logarithm of an rms of 64 errors has a standard deviation of 1/sqrt(2*64), and the mean of four at most
     * that, however much they have in common: independent points would pass at three of them once in 700 runs. Their
     * rate is -0.5. */
    if (cases == 4 && mcst_case("all together")) {
        CHECK(gain / cases >= 3 / sqrt(2.0 * seeds), "1/%.2f of independent", exp(gain / cases));
        CHECK(rate / cases < -0.5, "N^%.2f", rate / cases);
    }
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    test_mean();
    test_support();
    test_extremes();
    test_memory();
    test_arrays();
    test_turned();
    test_weights();
    test_mutants();
    test_directions();
    test_spread();
    test_variance();
    return mcst_finish();
}
