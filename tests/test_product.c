/* Product of environment, reflection and cosine: means against the integral of the picture itself, for surfaces and for
 * weights of the caller, and how fast well-spread points come near. MCS_TEST_SCALE scales the number of samples, from
 * 10 on there are 1e7 for every mean. The parts about edges and about variance lie in headers of their own: one program
 * takes less time to compile than three. */
#include "product_edges.h"
#include "product_variance.h"

/* ---- means ---- */

/* Lobes of the header, whose products are built of weights: reflection times cosine. */
enum { BY_SURFACE, PHONG, WARD, BECKMANN, ASHIKHMIN, MODELS };
static const char *const model_name[] = {"", "Phong 20", "Ward 0.3 x 0.2", "Beckmann 0.4", "Ashikhmin-Shirley 30, 10"};
static double model(int k, mcs_vec3 wo, mcs_vec3 wi) {
    const mcs_phong phong = mcs_phong_make(20);
    const mcs_ward ward = mcs_ward_make(0.3f, 0.2f, MCS_WARD_GMD);
    const mcs_beckmann beckmann = mcs_beckmann_make(0.4f, 0.4f);
    const mcs_ashikhmin ashikhmin = mcs_ashikhmin_make(30, 10);
    const double f = (double)(k == PHONG      ? mcs_phong_eval(&phong, wo, wi)
                              : k == WARD     ? mcs_ward_eval(&ward, wo, wi)
                              : k == BECKMANN ? mcs_beckmann_eval(&beckmann, wo, wi)
                                              : mcs_ashikhmin_eval(&ashikhmin, wo, wi));
    return wi.z > 0 ? f * (double)wi.z : 0;
}
static double reflected(const surface *s, int k, mcs_vec3 w) {
    double visible;
    return k == BY_SURFACE ? reflect(s, w, &visible) : model(k, s->r.wo, mcs_to_local(&s->r.frame, w));
}

/* The mean of `count` samples of what a surface or model k reflects is `truth`: within four standard errors, 6e-5 for
 * one, 1.2e-3 for all, and a part `off` of it. */
static void check_mean(const sampler *d, int k, int count, uint64_t stream, double truth, double off) {
    static float u1[CHUNK], u2[CHUNK], x[CHUNK], y[CHUNK], z[CHUNK], pdf[CHUNK];
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, stream);
    double sum = 0;
    double sum2 = 0;
    int n = 0;
    while (n < count) {
        fill(&rng, CHUNK, u1, u2);
        mcs_product_sample_n(d->p, tiles_of(d->m), env_of(d->m), CHUNK, u1, u2, x, y, z, pdf, NULL, NULL);
        for (int i = 0; i < CHUNK; i++, n++) {
            mcs_vec3 w;
            w.x = x[i];
            w.y = y[i];
            w.z = z[i];
            double v = -truth; /* sums about a value of the right size keep their digits */
            if (pdf[i] > 0) v += d->m->light[texel_number(d->m, w)] * reflected(d->s, k, w) / (double)pdf[i];
            sum += v;
            sum2 += v * v;
        }
    }
    const double error = sqrt(fmax(sum2 - sum * sum / n, 0) / ((double)n - 1) / n);
    CHECK(fabs(sum / n) <= 4 * error + off * truth, "mean %.7g with error %.2g, not %.7g", truth + sum / n, error,
          truth);
    mcst_note("    %-28s mean %.7g, off by %5.2f standard errors of %.1e\n", mcst.name, truth + sum / n,
              sum / n / error, error / truth);
}

static void test_mean(void) {
    static const struct {
        picture kind;
        uint32_t w, h, rows;
        int lobe, normal;
        double cosine;
    } cases[] = {
        {SMOOTH, 64, 32, 16, 0, 4, 0.7},  {SUN, 64, 32, 16, 0, 6, 0.7},     {HALF, 50, 25, 16, 1, 2, 0.5},
        {NOISE, 64, 32, 32, 2, 5, 0.4},   {SUN, 100, 47, 16, 3, 0, 0.8},    {SMOOTH, 64, 32, 32, 4, 1, 0.6},
        {SPARSE, 40, 20, 32, 6, 3, 0.6},  {ROOM, 64, 32, 16, 7, 4, 0.9},    {SMOOTH, 64, 32, 16, 8, 4, 0.5},
        {ROOM, 64, 32, 16, 9, 0, 0.6},    {SUN, 64, 32, 16, 10, 5, 0.7},    {NOISE, 64, 32, 32, 11, 4, 0.5},
        {ROOM, 100, 47, 16, 12, 6, 0.8},  {SMOOTH, 50, 25, 16, 13, 2, 0.6}, {ROOM, 64, 32, 32, 14, 3, 0.4},
        {SPARSE, 40, 20, 16, 15, 4, 0.7}, {HALF, 64, 32, 16, 16, 0, 0.9},   {ROOM, 160, 80, 64, 2, 5, 0.4},
        {HALF, 50, 25, 64, 0, 4, 0.6},    {SUN, 128, 64, 64, 10, 2, 0.7},   {SUN, 64, 32, 16, 17, 5, 0.7},
        {ROOM, 64, 32, 16, 18, 4, 0.5},   {HALF, 50, 25, 32, 19, 0, 0.9},
    };
    const int count = (int)(1e6 * (scale() >= 10 ? 10 : fmin(scale(), 1)));
    mcst_group("product, means");
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        const lobe l = lobes[cases[i].lobe];
        if (!mcst_case("%s, %s", picture_name[cases[i].kind], l.name)) continue;
        scene m = scene_make(cases[i].kind, cases[i].w, cases[i].h, cases[i].rows);
        const surface s = surface_make(normals[cases[i].normal], local_wo(cases[i].cosine, 0.11 * i), l);
        sampler d = sampler_make(&m, &s);
        /* 1e-6 for the quadrature and the densities as floats */
        check_mean(&d, BY_SURFACE, count, 80 + (uint64_t)i, true_light(&m, &s), 1e-6);
        CHECK(l.ax >= 0.03f || d.share > 0, "no share for the lobe");
        sampler_free(&d);
        scene_free(&m);
    }
}

/* ---- weights of the caller ---- */

/* The density is where light and weight are, and one in all. */
static void check_weighed(const sampler *d, const float *weight) {
    const scene *m = d->m;
    double sum = 0;
    uint32_t bad = 0;
    for (uint32_t k = 0; k < m->w * m->h; k++) {
        const uint32_t c = k % m->w;
        const uint32_t r = k / m->w;
        const double p = density(d, point(m->w, m->h, c, r, 0.5, 0.5));
        bad += !(p >= 0 && p <= FLT_MAX) || (p > 0) != (m->light[k] > 0 && weight[tile_at(m, c, r)] > 0);
        sum += p * m->area[r];
    }
    CHECK(bad == 0, "%u texels that can be drawn and should not, or the other way", bad);
    CHECK(d->dark || fabs(sum - 1) <= 1e-5, "the density integrates to %g", sum);
}
/* The reflected light, by midpoints. */
static double model_light(const scene *m, const surface *s, int k) {
    enum { SUB = 16 };
    double truth = 0;
    for (uint32_t r = 0; r < m->h; r++)
        for (uint32_t i = 0; i < m->w * SUB * SUB; i++) {
            const uint32_t c = i / (SUB * SUB);
            const mcs_vec3 w = point(m->w, m->h, c, r, (i / SUB % SUB + 0.5) / SUB, (i % SUB + 0.5) / SUB);
            truth += m->light[r * m->w + c] * m->area[r] / (SUB * SUB) * reflected(s, k, w);
        }
    return truth;
}
static void check_model(int k) {
    const int count = (int)(3e5 * (scale() >= 10 ? 30 : fmin(scale(), 1)));
    scene m = scene_make(k % 2 ? ROOM : SUN, 64, 32, k <= WARD ? 16 : 32);
    const surface s = surface_make(normals[2 + k], local_wo(0.4 + 0.1 * k, 0.2 * k), lobes[0]);
    float weight[2048];
    for (uint32_t q = 0; q < 2 * m.rows * m.rows; q++) {
        const mcs_vec3 w = mcs_to_local(&s.r.frame, mcs_tiles_direction(tiles_of(&m), env_of(&m), q));
        /* a tile may reach above the horizon when its mean direction does not */
        weight[q] = (float)model(k, s.r.wo, w.z < 0.1f ? vec(w.x, w.y, 0.1) : w) + 1e-3f;
    }
    sampler d = sampler_of(&m, &s, weight);
    CHECK(!d.dark, "dark");
    check_weighed(&d, weight);
    check_sane(&d, 1);
    /* midpoints 1/16 of a texel apart, 0.006, in lobes wider than 0.1: (0.006/0.1)^2 / 24 */
    check_mean(&d, k, count, 73, model_light(&m, &s, k), 1.5e-4);
    sampler_free(&d);
    scene_free(&m);
}
static void check_weights(const float *weight, int dark) {
    scene m = scene_make(SUN, 64, 32, 16);
    const surface s = surface_make(normals[4], local_wo(0.5, 0), lobes[0]);
    sampler d = sampler_of(&m, &s, weight);
    CHECK(d.dark == dark, "dark: %d", d.dark);
    if (d.dark == dark) check_weighed(&d, weight);
    check_sane(&d, 1);
    sampler_free(&d);
    scene_free(&m);
}

static void test_weights(void) {
    static const float sizes[] = {1e-44f, 1e-38f, 1e-35f, 1e-30f, 1e-10f, 1, 1e10f, 1e30f, 3e38f};
    static const float wrong[] = {NAN, INFINITY, -1, -0.0f, -INFINITY};
    float weight[512];
    mcst_group("product, weights");
    for (int k = 1; k < MODELS; k++)
        if (mcst_case("%s", model_name[k])) check_model(k);
    /* One tile alone has weight (kind 1), or the others have 1e-44 (kind 2), or all have the same (kind 0). */
    for (int kind = 0; kind < 3; kind++)
        for (int i = 0; i < (int)(sizeof sizes / sizeof *sizes); i++) {
            if (!mcst_case("weights far from 1: %g, %d", (double)sizes[i], kind)) continue;
            for (int q = 0; q < 512; q++) weight[q] = !kind || q == 100 ? sizes[i] : kind == 1 ? 0 : 1e-44f;
            check_weights(weight, 0);
        }
    /* An infinite weight is a sun, other bad ones are black. Kind 1: none is good; 2: nor infinite. */
    for (int kind = 0; kind < 3; kind++) {
        if (!mcst_case("bad weights, %d", kind)) continue;
        for (int q = 0; q < 512; q++) {
            weight[q] = kind || q % 3 ? wrong[q % 5] : 1;
            if (kind == 2 && weight[q] > 0) weight[q] = NAN;
        }
        check_weights(weight, kind == 2);
    }
}

/* ---- well-spread points ---- */

/* Means of scrambled Sobol points at 64 and at `most` of them: adds the logarithm of how much better they are than
 * independent points, and the power of the number of points that their error goes with. */
static void check_spread(const scene *m, const surface *s, uint32_t most, int seeds, double *gain, double *rate) {
    sampler d = sampler_make(m, s);
    const double truth = true_light(m, s);
    double first = 0; /* sums of squared relative errors */
    double last = 0;
    double sum2 = 0; /* of all samples' squares */
    CHECK(!(d.share > 0), "share %g", d.share);
    for (int seed = 0; seed < seeds; seed++) {
        const uint32_t key = (uint32_t)(mcst.seed + 7919u * (uint32_t)seed);
        double sum = 0;
        for (uint32_t i = 0; i < most; i++) {
            const mcs_texel t = draw(&d, mcs_sobol(i, 0, key), mcs_sobol(i, 1, key));
            const double light = m->light[t.row * m->w + t.col];
            const double v = t.pdf > 0 ? light * reflected(s, BY_SURFACE, t.w) / (double)t.pdf / truth : 0;
            sum += v;
            sum2 += v * v;
            if (i == 63) first += pow(sum / 64 - 1, 2);
        }
        last += pow(sum / most - 1, 2);
    }
    const double error = sqrt(last / seeds);
    const double alone = sqrt((sum2 / seeds / most - 1) / most);
    const double slope = 0.5 * log(last / first) / log(most / 64.0);
    mcst_note("    %-32s error %.2e at %u, 1/%.1f of independent: N^%.2f\n", mcst.name, error, most, alone / error,
              slope);
    CHECK(error <= alone, "error %.2e at %u, of independent points %.2e", error, most, alone);
    *gain += log(alone / error);
    *rate += slope;
    sampler_free(&d);
}

static void test_spread(void) {
    const lobe shiny = {"alpha 0.3", 0.3f, 0.3f, 0, MCS_PROFILE_GGX};
    const int seeds = scale() < 1 ? 32 : 64;
    double gain = 0;
    double rate = 0;
    int cases = 0;
    mcst_group("product, spread points");
    for (int k = 0; k < 4; k++) {
        const lobe l = k % 2 ? shiny : lobes[0];
        if (!mcst_case("%s, %s", k < 2 ? "smooth" : "room", l.name)) continue;
        scene m = scene_make(k < 2 ? SMOOTH : ROOM, 256, 128, 16);
        const surface s = surface_make(normals[4], local_wo(0.7, 0.3), l);
        check_spread(&m, &s, scale() >= 10 ? 65536 : 4096, seeds, &gain, &rate);
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
    test_directions();
    test_spread();
    test_variance();
    return mcst_finish();
}
