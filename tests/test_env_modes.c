/* The environment map on pictures of its caller: hits against expectation, bilinear look-ups, MIS compensation,
 * stratified points. Windows: test_env_window.c. MCS_TEST_MAPS="a.hdr b.hdr" adds Radiance pictures, with 1e8 draws
 * each; MCS_TEST_BIG draws as many from the made-up sky. */
#include "env_modes.h"
#include "../examples/hdr.h"
#include "stats.h"

/* ---- real pictures ---- */

/* Calls check for every file in MCS_TEST_MAPS, with its luminance by the weights of Rec. 709. */
static void each_map(void (*check)(const picture *p, const mcs_image *image)) {
    const char *at = getenv("MCS_TEST_MAPS");
    char name[1024];
    int used;
    for (; at && sscanf(at, "%1023s%n", name, &used) == 1; at += used) {
        hdr_picture in;
        const int ok = hdr_read(&in, name);
        CHECK(ok, "%s: %s", name, in.fault);
        if (!ok) continue;
        picture p = blank(name, in.w, in.h);
        float *rgb;
        rgb = (float *)get((size_t)in.w * in.h * 3 * sizeof *rgb);
        for (size_t i = 0; i < (size_t)in.w * in.h; i++) {
            float *c = rgb + 3 * i;
            hdr_color(&in, i, c);
            p.prob[i] = 0.2126L * c[0] + 0.7152L * c[1] + 0.0722L * c[2];
            p.lum[i] = (float)p.prob[i];
        }
        normalise(&p);
        mcs_image image = mcs_image_make(rgb, in.w, in.h, 3);
        check(&p, &image);
        discard(&p);
        free(rgb);
        free(in.pixel);
    }
}

/* Hits of every texel, found by a double arctangent, against the picture; and of whole columns and rows, where the
 * small biases of many texels add up. The numbers are 32-bit integers: with floats, a step of u would be a part of the
 * darkest texels' share. */
static void count_hits(const picture *p, const mcs_image *image, int draws) {
    const size_t texels = (size_t)p->w * p->h;
    double *observed = (double *)get(texels * sizeof *observed);
    double *expected = (double *)get(texels * sizeof *expected);
    arena a = build_image(p->name, image, LIT);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 137);
    size_t black = 0;
    int stray = 0;
    int dof = 0;
    double *line[4];
    for (int k = 0; k < 4; k++) line[k] = (double *)get((k < 2 ? p->w : p->h) * sizeof(double));
    for (size_t i = 0; i < texels; i++) expected[i] = (double)p->prob[i] * draws;
    for (int k = 0; k < draws; k++) {
        const uint32_t b1 = mcs_pcg32_next(&rng);
        const mcs_texel s = mcs_env_sample_bits(env_in(&a), b1, mcs_pcg32_next(&rng));
        double col, row;
        texel_of(p->w, p->h, s.w, &col, &row);
        if (col < p->w && row < p->h) observed[(size_t)row * p->w + (uint32_t)col]++;
        else stray++;
    }
    for (size_t i = 0; i < texels; i++) black += expected[i] == 0 && observed[i] > 0;
    for (size_t i = 0; i < texels; i++) {
        line[0][i % p->w] += observed[i];
        line[1][i % p->w] += expected[i];
        line[2][i / p->w] += observed[i];
        line[3][i / p->w] += expected[i];
    }
    double prob;
    for (int k = 0; k < 4; k += 2) {
        prob = chi2_test(line[k], line[k + 1], k ? p->h : p->w, NULL, &dof);
        CHECK(prob >= level, "%s: %d draws, %s, %d degrees of freedom: p = %g", p->name, draws, k ? "rows" : "columns",
              dof, prob);
    }
    prob = chi2_test(observed, expected, texels, NULL, &dof);
    CHECK(prob >= level && black == 0 && stray == 0,
          "%s: %d draws, %d degrees of freedom: p = %g; %zu black texels hit, %d strayed", p->name, draws, dof, prob,
          black, stray);
    for (int k = 0; k < 4; k++) free(line[k]);
    free(observed);
    free(expected);
    arena_free(&a);
}
static void count_hits_of_map(const picture *p, const mcs_image *image) { count_hits(p, image, scaled(100000000)); }

static void test_hits(void) {
    picture p = make("sky", 1024, 512, v_sky);
    const mcs_image image = image_of(&p);
    count_hits(&p, &image, scaled(getenv("MCS_TEST_BIG") ? 100000000 : 10000000));
    discard(&p);
    each_map(count_hits_of_map);
}

/* ---- bilinear look-ups ---- */

/* The look-up of the radiance: texels are values at their centres in (phi, theta), columns wrap, rows end at the poles.
 */
static double look_up(const picture *p, double col, double row) {
    const double x = floor(col - 0.5);
    const double y = floor(row - 0.5);
    const double fx = col - 0.5 - x;
    const double fy = row - 0.5 - y;
    const uint32_t c0 = x < 0 ? p->w - 1 : (uint32_t)x;
    const uint32_t c1 = c0 + 1 < p->w ? c0 + 1 : 0;
    const uint32_t r0 = y < 0 ? 0 : (uint32_t)y;
    const uint32_t r1 = y < 0 ? 0 : r0 + 1 < p->h ? r0 + 1 : r0;
    const float *a = p->lum + (size_t)r0 * p->w;
    const float *b = p->lum + (size_t)r1 * p->w;
    return (1 - fy) * ((1 - fx) * a[c0] + fx * a[c1]) + fy * ((1 - fx) * b[c0] + fx * b[c1]);
}
/* The documented weights: (1 2 1)/4 along rows and along columns. */
static void weigh_filtered(picture *p) {
    for (uint32_t r = 0; r < p->h; r++)
        for (uint32_t c = 0; c < p->w; c++) {
            ld sum = 0;
            for (int i = -1; i <= 1; i++)
                for (int j = -1; j <= 1; j++) {
                    const uint32_t y = i < 0 && r == 0 ? 0 : i > 0 && r + 1 == p->h ? r : r + (uint32_t)i;
                    const uint32_t x = (c + p->w + (uint32_t)j) % p->w;
                    sum += (ld)p->lum[(size_t)y * p->w + x] * (2 - abs(i)) * (2 - abs(j)) / 16;
                }
            p->prob[(size_t)r * p->w + c] = sum;
        }
    normalise(p);
}

static double lit_part(double col, double row, void *ctx) {
    const picture *p = (const picture *)ctx;
    return look_up(p, col, row) * sin(pi * row / p->h) * (2 * pi / p->w) * (pi / p->h);
}
/* Integral of the look-up over the sphere, by quarters of texels, where it is smooth. */
static double integral(picture *p) {
    double sum = 0;
    for (uint32_t r = 0; r < 2 * p->h; r++)
        for (uint32_t c = 0; c < 2 * p->w; c++)
            if (p->prob[(size_t)(r / 2) * p->w + c / 2] > 0)
                sum += quad2(lit_part, p, c / 2.0, (c + 1) / 2.0, r / 2.0, (r + 1) / 2.0, 1e-8, 0, 1, NULL);
    return sum;
}

/* L / pdf of draws: at most four times the integral of the weights, apart from the integers and from roundings: four of
 * floats in the weights, two in the density. */
static moments check_draws(const picture *p, const mcs_env *e, int draws) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 139);
    moments m = {0, 0, 0, 0};
    for (int i = 0; i < draws; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(e, u1, mcs_pcg32_float(&rng));
        double col, row;
        texel_of(p->w, p->h, s.w, &col, &row);
        const double weight = look_up(p, fmin(col, p->w - 1e-9), fmin(row, p->h - 1e-9)) / s.pdf / (double)p->total;
        add(&m, weight);
        CHECK(s.pdf > 0 && weight <= 4 * (1 + slack(p, s.col, s.row) + 8 * eps),
              "%s: texel (%u, %u): L / pdf is %g of the total", p->name, s.col, s.row, weight);
    }
    return m;
}

/* One lit texel: density wherever the look-up finds light, weights bounded at every point, their mean the integral. */
static void check_one_lit(uint32_t w, uint32_t h, uint32_t col, uint32_t row, float value) {
    picture p = blank("one lit texel", w, h);
    mcs_image image = image_of(&p);
    static const double at[10] = {0.002, 0.1, 0.3, 0.45, 0.499, 0.501, 0.6, 0.75, 0.9, 0.998};
    double worst = 0;
    p.lum[row * w + col] = value;
    weigh_filtered(&p);
    image.bilinear = 1;
    arena a = build_image(p.name, &image, LIT);
    CHECK(fabs((double)(env_in(&a)->total / p.total - 1)) <= 8 * eps, "%u x %u, (%u, %u): total %g, not %Lg", w, h, col,
          row, env_in(&a)->total, p.total);
    for (uint32_t r = 0; r < h; r++)
        for (uint32_t c = 0; c < w; c++)
            for (uint32_t i = 0; i < 10; i++)
                for (uint32_t j = 0; j < 10; j++) {
                    const mcs_vec3 v = point(w, h, c, r, at[i], at[j]);
                    const double pdf = mcs_env_pdf(env_in(&a), v);
                    double x, y;
                    texel_of(w, h, v, &x, &y);
                    const double light = look_up(&p, x, y);
                    CHECK(light <= 0 || pdf > 0, "%u x %u, (%u, %u) lit: no density at (%g, %g), light %g", w, h, col,
                          row, x, y, light);
                    CHECK((pdf > 0) == (p.prob[r * w + c] > 0), "%u x %u, (%u, %u) lit: density %g in (%u, %u)", w, h,
                          col, row, pdf, c, r);
                    if (!(light > 0) || !(pdf > 0)) continue;
                    worst = fmax(worst, light / pdf / (double)p.total / (1 + slack(&p, c, r) + 8 * eps));
                }
    CHECK(worst > 0 && worst <= 4, "%u x %u, (%u, %u) lit: weights up to %g of the total", w, h, col, row, worst);
    const moments m = check_draws(&p, env_in(&a), scaled(20000));
    const double truth = integral(&p) / (double)p.total;
    CHECK(fabs(m.mean - truth) <= sigmas * error_of(&m) + 8 * eps, "%u x %u, (%u, %u) lit: mean %g +- %g, not %g", w, h,
          col, row, m.mean, error_of(&m), truth);
    arena_free(&a);
    discard(&p);
}

static void test_one_lit(void) {
    static const uint32_t size[6][2] = {{24, 12}, {7, 5}, {1, 9}, {9, 1}, {2, 2}, {1, 1}};
    static const float value[3] = {1, 3e38f, 1e-30f};
    uint32_t n = 0;
    for (uint32_t k = 0; k < 6; k++)
        for (uint32_t r = 0; r < size[k][1]; r++)
            for (uint32_t c = 0; c < size[k][0]; c++) {
                const int seam = c == 0 || c == size[k][0] - 1 || c == size[k][0] / 2;
                const int pole = r == 0 || r == size[k][1] - 1 || r == size[k][1] / 2;
                if (seam && pole) check_one_lit(size[k][0], size[k][1], c, r, value[n++ % 3]);
            }
    CHECK(n == 9 + 9 + 3 + 3 + 4 + 1, "%u places tried", n);
}

static void report_weights(const picture *from, const mcs_image *plain) {
    picture p = blank(from->name, from->w, from->h);
    mcs_image image = *plain;
    memcpy(p.lum, from->lum, (size_t)p.w * p.h * sizeof *p.lum);
    weigh_filtered(&p);
    image.bilinear = 1;
    arena a = build_image(p.name, &image, LIT);
    const moments m = check_draws(&p, env_in(&a), scaled(1000000));
    mcst_note("     %s: weights up to %.4f of the total, mean %.6f, rms deviation %.4f\n", p.name, m.worst, m.mean,
              sqrt(variance_of(&m)));
    arena_free(&a);
    discard(&p);
}

static void test_largest_weight(void) {
    const shade all[3] = {v_sky, v_region, v_checker};
    const char *const name[3] = {"sky 512 x 256", "region 512 x 256", "checkerboard 512 x 256"};
    for (int k = 0; k < 3; k++) {
        picture p = make(name[k], 512, 256, all[k]);
        const mcs_image image = image_of(&p);
        report_weights(&p, &image);
        discard(&p);
    }
    each_map(report_weights);
}

/* ---- MIS compensation ---- */

/* Mean, weights and densities with the mean taken off, plain and filtered. */
static void check_compensated(picture p, int bilinear) {
    mcs_image image = image_of(&p);
    ld lowest = 4;
    size_t lit = 0;
    image.bilinear = bilinear;
    if (bilinear) weigh_filtered(&p);
    const ld mean = p.total / (4 * acosl(-1.0L));
    image.floor = 0.5f; /* must not matter to the mean */
    image.floor = mcs_env_mean(&image);
    CHECK(fabs((double)(image.floor / mean - 1)) <= 6 * eps, "%s: mean %.9g, not %.9Lg", p.name, (double)image.floor,
          mean);
    for (uint32_t r = 0; r < p.h; r++)
        for (uint32_t c = 0; c < p.w; c++) {
            ld *w = &p.prob[(size_t)r * p.w + c];
            const ld v = *w * p.total / solid_angle(r, p.w, p.h);
            *w = v - image.floor;
            if (*w < 0) *w = 0;
            if (fabsl(v / image.floor - 1) < lowest) lowest = fabsl(v / image.floor - 1);
        }
    CHECK(lowest > 1e-5L, "%s: a texel at the mean, unfit for this test", p.name);
    normalise(&p);
    arena a = build_image(p.name, &image, LIT);
    CHECK(env_in(&a)->incomplete == 1, "%s: not marked as incomplete", p.name);
    CHECK(fabs((double)(env_in(&a)->total / p.total - 1)) <= 6 * eps / (double)lowest, "%s: total %g, not %Lg", p.name,
          env_in(&a)->total, p.total);
    for (uint32_t r = 0; r < p.h; r++)
        for (uint32_t c = 0; c < p.w; c++) {
            const double want = (double)p.prob[(size_t)r * p.w + c];
            const double omega = (double)solid_angle(r, p.w, p.h);
            const double found = mcs_env_pdf(env_in(&a), point(p.w, p.h, c, r, 0.5, 0.5)) * omega;
            lit += want > 0;
            CHECK((found > 0) == (want > 0), "%s: texel (%u, %u): probability %g, not %g", p.name, c, r, found, want);
            /* the roundings of a weight grow by what is taken off: once in the texel, once in the total */
            if (want > 0)
                CHECK(fabs(found - want) <= want * (slack(&p, c, r) + 16 * eps / (double)lowest),
                      "%s: texel (%u, %u): probability %g, not %g", p.name, c, r, found, want);
        }
    CHECK(lit > 0 && lit < (size_t)p.w * p.h, "%s: %zu texels above the mean", p.name, lit);
    asserted = 0;
    for (size_t i = 0; i < 10; i++) {
        const mcs_texel s = mcs_env_sample(env_in(&a), hash01((uint32_t)i), 0.5f);
        CHECK(mcs_env_weight(env_in(&a), s.pdf) == 0, "%s: a weight without the other strategy", p.name);
    }
    CHECK(asserted == 10, "%s: %d of 10 uses alone reported", p.name, asserted);
    asserted = 0;
    arena_free(&a);
    discard(&p);
}

static void test_compensation(void) {
    check_compensated(make("lamp", 64, 32, v_lamp), 0);
    check_compensated(make("sky", 256, 128, v_sky), 0);
    check_compensated(make("random, odd", 93, 51, v_random), 0);
    check_compensated(make("lamp", 64, 32, v_lamp), 1);
    check_compensated(make("sky", 256, 128, v_sky), 1);
}

static void test_complete_weight(void) {
    picture p = make("lamp", 64, 32, v_lamp);
    arena a = build(&p, LIT);
    asserted = 0;
    CHECK(env_in(&a)->incomplete == 0, "incomplete without a floor");
    CHECK(mcs_env_weight(env_in(&a), 0.25f) == 4 && mcs_env_weight(env_in(&a), 3.0f) == 1.0f / 3.0f, "1 / pdf");
    CHECK(mcs_env_weight(env_in(&a), 0.0f) == 0 && mcs_env_weight(env_in(&a), -1.0f) == 0 &&
              mcs_env_weight(env_in(&a), NAN) == 0,
          "no density, no weight");
    CHECK(asserted == 0, "asserted %d times", asserted);
    arena_free(&a);
    discard(&p);
}

/* Uniform and map together by the balance heuristic, one draw of each: light times 1 + cos(theta)/2, summed over the
 * texels. */
static void test_mis(void) {
    picture p = make("lamp", 64, 32, v_lamp);
    mcs_image image = image_of(&p);
    const int draws = scaled(400000);
    moments m[2] = {{0, 0, 0, 0}, {0, 0, 0, 0}};
    ld truth = 0;
    for (uint32_t r = 0; r < p.h; r++)
        for (uint32_t c = 0; c < p.w; c++) { /* the mean of cos(theta) in a row is that of its borders */
            const ld z = (cosl(acosl(-1.0L) * r / p.h) + cosl(acosl(-1.0L) * (r + 1) / p.h)) / 2;
            truth += p.lum[r * p.w + c] * solid_angle(r, p.w, p.h) * (1 + z / 2);
        }
    for (int k = 0; k < 2; k++) {
        mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 149);
        image.floor = k ? mcs_env_mean(&image) : 0;
        arena a = build_image(p.name, &image, LIT);
        for (int i = 0; i < draws; i++) {
            const float u1 = mcs_pcg32_float(&rng);
            const float u2 = mcs_pcg32_float(&rng);
            const double z = 1 - 2 * (double)mcs_pcg32_float(&rng);
            const double phi = 2 * pi * mcs_pcg32_float(&rng);
            const double s = sqrt(1 - z * z);
            double sum = 0;
            mcs_vec3 w[2];
            w[0] = mcs_env_sample(env_in(&a), u1, u2).w;
            w[1].x = (float)(s * cos(phi));
            w[1].y = (float)(s * sin(phi));
            w[1].z = (float)z;
            for (int j = 0; j < 2; j++) {
                double col, row;
                texel_of(p.w, p.h, w[j], &col, &row);
                col = fmin(col, p.w - 1.0);
                row = fmin(row, p.h - 1.0);
                sum += p.lum[(uint32_t)row * p.w + (uint32_t)col] * (1 + 0.5 * w[j].z) /
                       (mcs_env_pdf(env_in(&a), w[j]) + 1 / (4 * pi));
            }
            add(&m[k], sum);
        }
        CHECK(fabs(m[k].mean - (double)truth) <= sigmas * error_of(&m[k]), "floor %g: %g +- %g, not %Lg",
              (double)image.floor, m[k].mean, error_of(&m[k]), truth);
        arena_free(&a);
    }
    mcst_note("     variance of light and uniform together: %.4g, with compensation %.4g\n", variance_of(&m[0]),
              variance_of(&m[1]));
    CHECK(variance_of(&m[1]) < variance_of(&m[0]), "compensation: variance %g, without %g", variance_of(&m[1]),
          variance_of(&m[0]));
    discard(&p);
}

/* ---- well-spread points ---- */

/* 4096 points of a smooth sky, for light on the ground: its integral is 1.2 pi. The error of stratified and of Sobol
 * points, over repetitions with other seeds, is at most a fifth of that of independent ones. */
static void test_spread(void) {
    enum { SIDE = 64, POINTS = SIDE * SIDE };
    picture p = make("smooth", 256, 128, v_smooth);
    arena a = build(&p, LIT);
    const int rounds = scaled(256) < 64 ? 64 : scaled(256);
    const char *const name[3] = {"independent", "stratified", "Sobol"};
    double rms[3];
    for (int k = 0; k < 3; k++) {
        mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 163);
        double squares = 0;
        for (int i = 0; i < rounds; i++) {
            const uint32_t seed = mcs_pcg32_next(&rng);
            double sum = 0;
            for (uint32_t j = 0; j < POINTS; j++) {
                mcs_vec2 u;
                if (k == 0) {
                    u.x = mcs_pcg32_float(&rng);
                    u.y = mcs_pcg32_float(&rng);
                } else if (k == 1) {
                    u = mcs_stratified(j, SIDE, SIDE, seed);
                } else {
                    u.x = mcs_sobol(j, 0, seed);
                    u.y = mcs_sobol(j, 1, seed);
                }
                const mcs_texel s = mcs_env_sample(env_in(&a), u.x, u.y);
                sum += smooth(s.w) * (s.w.z > 0 ? (double)s.w.z : 0) / s.pdf;
            }
            squares += pow(sum / POINTS - 1.2 * pi, 2);
        }
        rms[k] = sqrt(squares / rounds);
        mcst_note("     %s points: rms error %.3g, %.1f times less\n", name[k], rms[k], rms[0] / rms[k]);
        CHECK(k == 0 || rms[k] <= rms[0] / 5, "%s points: rms error %g, independent %g", name[k], rms[k], rms[0]);
    }
    arena_free(&a);
    discard(&p);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("env hits");
    if (mcst_case("chi-square of all texels")) test_hits();
    mcst_group("env bilinear");
    if (mcst_case("one lit texel")) test_one_lit();
    if (mcst_case("largest weight")) test_largest_weight();
    mcst_group("env compensation");
    if (mcst_case("mean, densities, refused alone")) test_compensation();
    if (mcst_case("weight of a complete map")) test_complete_weight();
    if (mcst_case("with uniform directions")) test_mis();
    mcst_group("env well-spread points");
    if (mcst_case("stratified and Sobol against independent")) test_spread();
    return mcst_finish();
}
