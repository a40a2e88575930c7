/* Environment maps of any input: channels, strides, bad pixels and arguments, a turned map. The truth is the image
 * itself. */
#include "env_maps.h"

/* ---- input ---- */

/* Luminance of Rec. 709 primaries; the same map as 1, 3 and 4 channels, with and without a stride, draws the same. */
static void test_channels(void) {
    enum { W = 37, H = 19, STRIDE = W * 4 + 5 };
    static float in[H * STRIDE];
    static const map m = {"channels", W, H, v_random, 0};
    for (uint32_t channels = 1; channels <= 4; channels++) {
        if (channels == 2) continue;
        for (int padded = 0; padded < 2; padded++) {
            const size_t stride = padded ? STRIDE : W * channels;
            arena a = arena_make(mcs_env_bytes(W, H));
            ld sum = 0;
            for (uint32_t r = 0; r < H * STRIDE; r++)
                in[r] = NAN; /* padding and further channels must not be read as light */
            for (uint32_t r = 0; r < H; r++)
                for (uint32_t c = 0; c < W; c++) {
                    float *px = in + r * stride + c * channels;
                    const uint32_t i = (r * W + c) * 3;
                    px[0] = hash01(i);
                    if (channels > 2) {
                        px[1] = hash01(i + 1);
                        px[2] = hash01(i + 2);
                    }
                    if (channels > 3) px[3] = 1e6f * hash01(i);
                    const ld lum = channels == 1 ? px[0] : 0.2126L * px[0] + 0.7152L * px[1] + 0.0722L * px[2];
                    pixels[r * W + c] = (float)lum;
                    sum += prob[r * W + c] = lum * solid_angle(r, W, H);
                }
            for (uint32_t r = 0; r < H; r++) {
                row_prob[r] = 0;
                for (uint32_t c = 0; c < W; c++) row_prob[r] += prob[r * W + c] /= sum;
            }
            const int rc = build_from(env_in(&a), a.bytes, in, W, H, channels, padded ? STRIDE : 0);
            CHECK(rc == MCS_OK && env_in(&a)->bad == 0, "%u channels, stride %zu: returns %d, %llu bad", channels,
                  stride, rc, (unsigned long long)env_in(&a)->bad);
            CHECK(fabs((double)(env_in(&a)->total / sum - 1)) <= 4 * eps, "%u channels, stride %zu: total %g, not %g",
                  channels, stride, env_in(&a)->total, (double)sum);
            check_density(&m, env_in(&a));
            arena_free(&a);
        }
    }
}

/* The same picture however it lies in memory: apart, with padding, upside down, as a channel of a larger one. The
 * memory of the picture ends with its last float, and what is not a pixel is NaN. */
static void test_strides(void) {
    enum { W = 21, H = 13 };
    static const struct {
        uint32_t channels;
        ptrdiff_t pixel, row; /* row in pixels beyond a packed one; below 0: stored from the bottom up */
    } way[] = {{1, 0, 0}, {1, 1, 0},  {1, 1, 3}, {1, 4, 0}, {1, 4, 5}, {1, 3, -1}, {1, 0, -1}, {1, 1, -4},
               {3, 0, 0}, {3, 0, -1}, {3, 3, 7}, {3, 4, 0}, {3, 9, 2}, {3, 5, -3}, {4, 0, -1}, {4, 6, 1}};
    static float plain[W * H * 3];
    for (size_t k = 0; k < sizeof way / sizeof *way; k++) {
        const uint32_t used = way[k].channels < 3 ? 1 : 3;
        const ptrdiff_t step = way[k].pixel ? way[k].pixel : (ptrdiff_t)way[k].channels;
        const ptrdiff_t apart = way[k].row < 0 ? -way[k].row - 1 : way[k].row;
        const ptrdiff_t row = (W + apart) * step;
        const size_t floats = (size_t)((H - 1) * row + (W - 1) * step) + way[k].channels;
        float *in = (float *)malloc(floats * sizeof *in);
        float *top = in;
        arena a = arena_make(mcs_env_bytes(W, H));
        arena b = arena_make(mcs_env_bytes(W, H));
        if (!in) {
            CHECK(0, "out of memory");
            return;
        }
        for (size_t i = 0; i < floats; i++) in[i] = NAN;
        if (way[k].row < 0) top += (H - 1) * row;
        for (uint32_t r = 0; r < H; r++)
            for (uint32_t c = 0; c < W; c++)
                for (uint32_t j = 0; j < used; j++) {
                    const ptrdiff_t down = way[k].row < 0 ? -(ptrdiff_t)r : (ptrdiff_t)r;
                    plain[(r * W + c) * used + j] = top[down * row + (ptrdiff_t)c * step + (ptrdiff_t)j] =
                        hash01((r * W + c) * 3 + j);
                }
        int rc = build_from(env_in(&a), a.bytes, plain, W, H, used, 0);
        CHECK(rc == MCS_OK, "packed: returns %d", rc);
        mcs_image image = mcs_image_make(top, W, H, way[k].channels);
        image.pixel_stride = way[k].pixel;
        image.row_stride = way[k].row < 0 ? -row : way[k].row || k % 2 ? row : 0;
        rc = mcs_env_build(env_in(&b), b.bytes, &image);
        CHECK(rc == MCS_OK && arena_intact(&b) && memcmp(a.at, b.at, a.bytes) == 0,
              "%u channels, pixels %td apart, rows %td: returns %d, %u bad, or another table", way[k].channels,
              image.pixel_stride, image.row_stride, rc, env_in(&b)->bad);
        free(in);
        arena_free(&a);
        arena_free(&b);
    }
}

static void test_refused_strides(void) {
    enum { W = 20, H = 10, C = 3 };
    const ptrdiff_t most = PTRDIFF_MAX;
    const ptrdiff_t least = -PTRDIFF_MAX - 1;
    const struct {
        ptrdiff_t pixel, row;
        mcs_status status;
    } way[] = {{0, (W - 1) * C + C, MCS_OK},
               {5, (W - 1) * 5 + C, MCS_OK}, /* a row may end with the last channel of its last pixel */
               {5, -(W - 1) * 5 - C, MCS_OK},
               {0, W * C - 1, MCS_ERR_SIZE},
               {0, -W * C + 1, MCS_ERR_SIZE},
               {5, (W - 1) * 5 + C - 1, MCS_ERR_SIZE},
               {5, -(W - 1) * 5 - C + 1, MCS_ERR_SIZE},
               {0, 1, MCS_ERR_SIZE},
               {0, -1, MCS_ERR_SIZE},
               {1, 0, MCS_ERR_SIZE},
               {2, 1000, MCS_ERR_SIZE},
               {-1, 0, MCS_ERR_SIZE},
               {-3, 1000, MCS_ERR_SIZE},
               {least, 0, MCS_ERR_SIZE},
               {most, 0, MCS_ERR_SIZE},
               {most, most, MCS_ERR_SIZE},
               {most / W, 0, MCS_ERR_SIZE},
               {most / W + 1, 0, MCS_ERR_SIZE},
               {most / 4, 0, MCS_ERR_SIZE},
               {0, most, MCS_ERR_SIZE},
               {0, least, MCS_ERR_SIZE},
               {0, most / H, MCS_ERR_SIZE},
               {0, most / 4 / H + 1, MCS_ERR_SIZE}, /* the picture would be larger than memory */
               {0, -(most / 4 / H) - 1, MCS_ERR_SIZE}};
    static float in[2 * H * (W * 5)];
    const size_t need = mcs_env_bytes(W, H);
    for (size_t i = 0; i < sizeof in / sizeof *in; i++) in[i] = hash01((uint32_t)i);
    for (size_t k = 0; k < sizeof way / sizeof *way; k++) {
        arena a = arena_make(need);
        mcs_image image = mcs_image_make(in + sizeof in / sizeof *in / 2, W, H, C);
        image.pixel_stride = way[k].pixel;
        image.row_stride = way[k].row;
        int rc[3];
        rc[0] = mcs_env_build(env_in(&a), need, &image);
        const float mean = mcs_env_mean(&image);
        if (way[k].status) {
            rc[1] = mcs_env_build_rows(env_in(&a), need, &image, 0, 1);
            rc[2] = mcs_env_finish(env_in(&a), need, &image);
            CHECK(rc[0] == way[k].status && rc[1] == way[k].status && rc[2] == way[k].status && mean == 0,
                  "pixels %td, rows %td apart: %d, %d, %d, mean %g", way[k].pixel, way[k].row, rc[0], rc[1], rc[2],
                  (double)mean);
            CHECK(untouched(a.at, need), "pixels %td, rows %td apart: refused, yet written", way[k].pixel, way[k].row);
        } else {
            CHECK(rc[0] == MCS_OK && mean > 0, "pixels %td, rows %td apart: %d, mean %g", way[k].pixel, way[k].row,
                  rc[0], (double)mean);
        }
        CHECK(arena_intact(&a), "written outside");
        arena_free(&a);
    }
}

/* Each bad channel is 0, but +infinity is FLT_MAX: mean, total and draws are those of a picture that says so, as it is,
 * bilinear and with a floor; `way` 0: whole texels are bad, 1: channels of them, 2: and some of these infinite. */
static void check_bad_pixels(uint32_t channels, int way, int mode) {
    enum { W = 24, H = 12 };
    const float bad[5] = {NAN, -1.0f, -INFINITY, -FLT_MAX, -FLT_MIN};
    static float in[W * H * 3], clean[W * H * 3];
    arena a = arena_make(mcs_env_bytes(W, H));
    arena b = arena_make(mcs_env_bytes(W, H));
    mcs_image broken = mcs_image_make(in, W, H, channels);
    mcs_image right = mcs_image_make(clean, W, H, channels);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 67);
    uint32_t count = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        int some = 0;
        for (uint32_t j = 0; j < channels; j++) {
            const uint32_t k = i * channels + j;
            const int here = i % 3 == 1 && (way == 0 || channels == 1 || (i / 3 + j) % 2);
            const int sun = way == 2 && here && i % 5 == 0;
            in[k] = sun ? INFINITY : here ? bad[i / 3 % 5] : 0.1f + hash01(k);
            clean[k] = sun ? FLT_MAX : here ? 0.0f : 0.1f + hash01(k);
            some |= here;
        }
        count += (uint32_t)some;
    }
    broken.bilinear = right.bilinear = mode == 1;
    if (mode == 2) {
        broken.floor = mcs_env_mean(&broken);
        right.floor = mcs_env_mean(&right);
    }
    CHECK(mcs_env_mean(&broken) == mcs_env_mean(&right) && mcs_env_mean(&right) <= FLT_MAX, "mean %g, not %g",
          (double)mcs_env_mean(&broken), (double)mcs_env_mean(&right));
    int rc = mcs_env_build(env_in(&a), a.bytes, &broken);
    CHECK(rc == MCS_OK && env_in(&a)->bad == count && arena_intact(&a), "%u channels: returns %d, %llu bad, not %u",
          channels, rc, (unsigned long long)env_in(&a)->bad, count);
    rc = mcs_env_build(env_in(&b), b.bytes, &right);
    CHECK(rc == MCS_OK && env_in(&b)->bad == 0 && env_in(&a)->total == env_in(&b)->total &&
              env_in(&b)->total <= DBL_MAX,
          "%u channels: total %g, not %g", channels, env_in(&a)->total, env_in(&b)->total);
    CHECK(mcs_env_check(env_in(&a), a.bytes) == MCS_OK, "no table");
    for (uint32_t i = 0; i < 20000; i++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(env_in(&a), u1, u2);
        const mcs_texel t = mcs_env_sample(env_in(&b), u1, u2);
        CHECK(s.w.x == t.w.x && s.w.y == t.w.y && s.w.z == t.w.z && s.pdf == t.pdf && s.col == t.col && s.row == t.row,
              "u = %a, %a: not as with clean pixels", (double)u1, (double)u2);
    }
    arena_free(&a);
    arena_free(&b);
}
static void test_bad_pixels(void) {
    for (uint32_t channels = 1; channels <= 3; channels += 2)
        for (int way = 0; way < 3; way++)
            for (int mode = 0; mode < 3; mode++) check_bad_pixels(channels, way, mode);
}

/* Texels of one row, so that probability is luminance: what bad channels leave of it, by hand. */
static void test_bad_channels(void) {
    enum { W = 9 };
    static const float in[W][3] = {{-150, 1000, 100}, {1, 1, 1},     {1, NAN, 1},        {-5, -1, 3},      {-1, -2, -3},
                                   {NAN, NAN, NAN},   {0, 2, -1000}, {-1e30f, 1e-3f, 0}, {-0.0f, -0.0f, 0}};
    static const double want[W] = {
        0.7152 * 1000 + 0.0722 * 100, 1, 0.2126 + 0.0722, 0.0722 * 3, 0, 0, 0.7152 * 2, 0.7152e-3, 0};
    static const float suns[4][3] = {
        {INFINITY, 0, 0}, {FLT_MAX, FLT_MAX, FLT_MAX}, {INFINITY, -INFINITY, NAN}, {1e30f, 0, 0}};
    static const double sun_want[4] = {0.2126, 1, 0.2126, 0.2126 * 1e30 / FLT_MAX};
    arena a = arena_make(mcs_env_bytes(W, 1));
    mcs_image image = mcs_image_make(&in[0][0], W, 1, 3);
    double sum = 0;
    for (uint32_t i = 0; i < W; i++) sum += want[i];
    CHECK(mcs_env_build(env_in(&a), a.bytes, &image) == MCS_OK && env_in(&a)->bad == 7, "%u bad", env_in(&a)->bad);
    CHECK(fabs(env_in(&a)->total / (sum * 4 * pi / W) - 1) <= 4 * eps, "total %g, not %g", env_in(&a)->total,
          sum * 4 * pi / W);
    CHECK(fabs(mcs_env_mean(&image) / (sum / W) - 1) <= 4 * eps, "mean %g, not %g", (double)mcs_env_mean(&image),
          sum / W);
    for (uint32_t i = 0; i < W; i++) {
        const double p = mcs_env_pdf(env_in(&a), point(W, 1, i, 0, 0.5, 0.5)) * 4 * pi / W;
        const double due = want[i] / sum;
        CHECK((p > 0) == (due > 0) && fabs(p - due) <= 5 * eps * due + (2 + W * due) * quantum,
              "texel %u: probability %g, not %g", i, p, due);
    }
    /* an overflowed half is a sun; nothing overflows with it */
    image = mcs_image_make(&suns[0][0], 4, 1, 3);
    sum = 0;
    for (uint32_t i = 0; i < 4; i++) sum += sun_want[i];
    for (int mode = 0; mode < 2; mode++) {
        const double whole = sum * FLT_MAX * pi;
        image.bilinear = mode;
        CHECK(mcs_env_build(env_in(&a), a.bytes, &image) == MCS_OK && env_in(&a)->bad == 2, "suns: %u bad",
              env_in(&a)->bad);
        CHECK(fabs(env_in(&a)->total / whole - 1) <= 5 * eps, "suns: total %g, not %g", env_in(&a)->total, whole);
        CHECK(fabs(mcs_env_mean(&image) / (whole / (4 * pi)) - 1) <= 5 * eps, "suns: mean %g",
              (double)mcs_env_mean(&image));
        for (uint32_t i = 0; i < 4; i++) {
            const double p = mcs_env_pdf(env_in(&a), point(4, 1, i, 0, 0.5, 0.5)) * pi;
            const double before = sun_want[(i + 3) % 4];
            const double here = sun_want[i];
            const double after = sun_want[(i + 1) % 4];
            const double due = (mode ? 0.25 * before + 0.5 * here + 0.25 * after : here) / sum;
            CHECK(p > 0 && fabs(p - due) <= 8 * eps * due + (2 + 4 * due) * quantum,
                  "suns, texel %u: probability %g, not %g", i, p, due);
        }
    }
    arena_free(&a);
}
/* Nothing but FLT_MAX or infinity: an even map whose sums are finite. */
static void test_all_infinite(void) {
    enum { W = 37, H = 19 };
    static float in[W * H * 3];
    for (int k = 0; k < 4; k++)
        for (int mode = 0; mode < 2; mode++) {
            const float fill = k & 1 ? INFINITY : FLT_MAX;
            arena a = arena_make(mcs_env_bytes(W, H));
            mcs_image image = mcs_image_make(in, W, H, k & 2 ? 3 : 1);
            for (int i = 0; i < W * H * 3; i++) in[i] = fill;
            image.bilinear = mode;
            CHECK(mcs_env_build(env_in(&a), a.bytes, &image) == MCS_OK && env_in(&a)->bad == (k & 1 ? W * H : 0),
                  "%u bad", env_in(&a)->bad);
            CHECK(env_in(&a)->uniform && fabs(env_in(&a)->total / (4 * pi * FLT_MAX) - 1) <= 4 * eps, "total %g",
                  env_in(&a)->total);
            CHECK(mcs_env_mean(&image) <= FLT_MAX && mcs_env_mean(&image) >= FLT_MAX * (1 - 4 * (float)eps), "mean %g",
                  (double)mcs_env_mean(&image));
            CHECK(fabs(mcs_env_sample(env_in(&a), 0.3f, 0.6f).pdf * 4 * pi - 1) <= 4 * eps, "density");
            arena_free(&a);
        }
}

static void test_black(void) {
    enum { W = 10, H = 6 };
    static const map m = {"black", W, H, v_one, 0};
    static float in[W * H];
    const float fill[3] = {0.0f, -0.0f, NAN};
    for (int k = 0; k < 3; k++) {
        arena a = arena_make(mcs_env_bytes(W, H));
        mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 71);
        for (int i = 0; i < W * H; i++) in[i] = fill[k];
        load(&m);
        const int rc = build_from(env_in(&a), a.bytes, in, W, H, 1, 0);
        CHECK(rc == MCS_OK && env_in(&a)->uniform && arena_intact(&a), "all %g: returns %d", (double)fill[k], rc);
        CHECK(env_in(&a)->total == 0 && env_in(&a)->bad == (k == 2 ? W * H : 0), "all %g: total %g, %llu bad",
              (double)fill[k], env_in(&a)->total, (unsigned long long)env_in(&a)->bad);
        for (int i = 0; i < 20000; i++) {
            const float u1 = mcs_pcg32_float(&rng);
            const float u2 = mcs_pcg32_float(&rng);
            const float pdf = mcs_env_sample(env_in(&a), u1, u2).pdf;
            CHECK(fabs(pdf * 4 * pi - 1) <= 4 * eps + 2 * W * H * quantum, "u = %a, %a: density %g", (double)u1,
                  (double)u2, (double)pdf);
            check_sample(&m, env_in(&a), u1, u2);
        }
        arena_free(&a);
    }
}

static void test_refused(void) {
    const uint32_t w = 20;
    const uint32_t h = 10;
    const uint32_t big = 0xffffffffu;
    const size_t need = mcs_env_bytes(w, h);
    arena a = arena_make(need + 8);
    unsigned char *at = a.at;
    load(&maps[15]);
    CHECK(build_from(NULL, need, pixels, w, h, 1, 0) == MCS_ERR_ARG, "no memory");
    CHECK(build_from(env_in(&a), need, NULL, w, h, 1, 0) == MCS_ERR_ARG, "no pixels");
    CHECK(build_from(env_in(&a), need, pixels, 0, h, 1, 0) == MCS_ERR_SIZE, "no columns");
    CHECK(build_from(env_in(&a), need, pixels, w, 0, 1, 0) == MCS_ERR_SIZE, "no rows");
    CHECK(build_from(env_in(&a), need, pixels, w, h, 0, 0) == MCS_ERR_ARG, "no channels");
    CHECK(build_from(env_in(&a), need, pixels, w, h, 2, 0) == MCS_ERR_ARG, "two channels");
    CHECK(build_from(env_in(&a), need, pixels, w, h, 1, w - 1) == MCS_ERR_SIZE, "stride below a row");
    CHECK(build_from((mcs_env *)(void *)(at + 2), need, pixels, w, h, 1, 0) == MCS_ERR_ARG, "misaligned memory");
    for (size_t i = 0; i < need; i++) {
        const int rc = build_from(env_in(&a), i, pixels, w, h, 1, 0);
        CHECK(rc == MCS_ERR_MEMORY, "%zu of %zu bytes: %d", i, need, rc);
    }
    CHECK(mcs_env_bytes(0, 1) == 0 && mcs_env_bytes(1, 0) == 0, "bytes of an empty map");
    CHECK(mcs_env_bytes(big, big) == 0, "bytes of 2^64 texels: %zu", mcs_env_bytes(big, big));
    CHECK(build_from(env_in(&a), SIZE_MAX, pixels, big, big, 1, 0) == MCS_ERR_SIZE, "2^64 texels");
    CHECK(build_from(env_in(&a), need, pixels, big, big, 4, 0) == MCS_ERR_SIZE, "2^64 texels");
    CHECK(build_from(env_in(&a), need, pixels, big, 1, big, 0) < 0, "2^64 floats in a row");
    CHECK(build_from(env_in(&a), need, pixels, w, h, 1, SIZE_MAX / 2) < 0, "a stride beyond memory");
    mcs_image wide = mcs_image_make(pixels, 32, 1, 1);
    wide.pixel_stride = PTRDIFF_MAX / 16 + 1;
    CHECK(mcs_env_mean(&wide) == 0 && mcs_env_build(env_in(&a), SIZE_MAX, &wide) == MCS_ERR_SIZE,
          "a row of 2^64 floats, by the stride of its pixels");
    CHECK(untouched(at, need + 8) && arena_intact(&a), "a refused build wrote");
    arena_free(&a);
}

static void test_bad_sampler_input(void) {
    const float odd[] = {1.0f, -1e-45f, -0.5f, 1.5f, 1e30f, INFINITY, -INFINITY, NAN};
    const size_t n = sizeof odd / sizeof *odd;
    const map *m = &maps[4];
    arena a = build(m);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++) {
            const float u1 = k == 1 ? 0.3f : odd[i];
            const float u2 = k == 0 ? 0.3f : odd[i];
            const mcs_texel s = mcs_env_sample(env_in(&a), u1, u2);
            CHECK(s.pdf == 0 && fabsf(s.w.x) <= 2 && fabsf(s.w.y) <= 2 && fabsf(s.w.z) <= 2 && s.col < m->w &&
                      s.row < m->h,
                  "u = %g, %g: pdf %g at (%g, %g, %g)", (double)u1, (double)u2, (double)s.pdf, (double)s.w.x,
                  (double)s.w.y, (double)s.w.z);
        }
    for (size_t i = 4; i < n; i++)
        for (size_t j = 0; j < 3; j++) {
            mcs_vec3 w = {0.5f, 0.5f, 0.5f};
            if (i == 4) w.x = w.y = w.z = 0;
            else if (j == 0) w.x = odd[i];
            else if (j == 1) w.y = odd[i];
            else w.z = odd[i];
            const float pdf = mcs_env_pdf(env_in(&a), w);
            const mcs_vec2 u = mcs_env_invert(env_in(&a), w);
            CHECK(pdf == 0, "w = (%g, %g, %g): pdf %g", (double)w.x, (double)w.y, (double)w.z, (double)pdf);
            CHECK(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1, "w = (%g, %g, %g): invert", (double)w.x, (double)w.y,
                  (double)w.z);
            const mcs_texel at = mcs_env_texel(env_in(&a), w);
            CHECK(at.pdf == 0 && at.col < m->w && at.row < m->h && at.w.z == 1, "w = (%g, %g, %g): texel (%u, %u)",
                  (double)w.x, (double)w.y, (double)w.z, at.col, at.row);
        }
    arena_free(&a);
}

/* Exact axes and signed zeros: +z is in row 0, -z in the last, and a column is found for both. */
static void test_axes(void) {
    const float v[] = {0.0f, -0.0f, 1.0f, -1.0f};
    const map *m = &maps[4];
    arena a = build(m);
    for (int i = 0; i < 64; i++) {
        const mcs_vec3 w = {v[i & 3], v[i >> 2 & 3], v[i >> 4]};
        const mcs_texel at = mcs_env_texel(env_in(&a), w);
        const float pdf = mcs_env_pdf(env_in(&a), w);
        if (w.x == 0 && w.y == 0 && w.z == 0) continue;
        CHECK(at.col < m->w && at.row < m->h && pdf > 0 && pdf <= FLT_MAX, "(%g, %g, %g): (%u, %u), pdf %g",
              (double)w.x, (double)w.y, (double)w.z, at.col, at.row, (double)pdf);
        if (w.x == 0 && w.y == 0) CHECK(at.row == (w.z > 0 ? 0 : m->h - 1), "pole %g: row %u", (double)w.z, at.row);
    }
    arena_free(&a);
}

/* Where sums keep more digits than a double has, that of a window's begin and a place in it can lie between the largest
 * double below 2^31 and 2^31 itself: it is a place in the first column, which is bright; the last one has a few of
 * 2^31. */
static void test_seam(void) {
    const float light[8] = {1, 1e-15f, 1, 1e-15f, 1, 1e-15f, 1, 1e-15f};
    const mcs_image image = mcs_image_make(light, 2, 4, 1);
    arena a = arena_make(mcs_env_bytes(2, 4));
    arena b = arena_make(mcs_env_window_bytes(4));
    mcs_env_window *const m = (mcs_env_window *)(void *)b.at;
    CHECK(mcs_env_build(env_in(&a), a.bytes, &image) == MCS_OK, "map");
    CHECK(mcs_env_window_build(m, b.bytes, env_in(&a), 0, 4, 1, 2) == MCS_OK, "window");
    for (int i = -36; i < -24; i++) {
        const mcs_texel t = mcs_env_window_sample(m, env_in(&a), (float)ldexp(0x0.ffffffp0, i), 0.853553414f);
        CHECK(t.col < 2 && t.pdf > 0, "u below 2^%d: column %u, pdf %g", i, t.col, (double)t.pdf);
    }
    arena_free(&a);
    arena_free(&b);
}

/* ---- orientation ---- */

static double dot(mcs_vec3 a, mcs_vec3 b) { return (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z; }

/* One draw of the map and of the turned one; 1 where the direction is found in a neighbour of the texel that was drawn.
 */
static int check_turned_draw(const map *m, const mcs_env *straight, const mcs_env *turned, int k, float u1, float u2) {
    const mcs_texel s = mcs_env_sample(straight, u1, u2);
    const mcs_texel t = mcs_env_sample(turned, u1, u2);
    const mcs_frame *f = &turned->frame;
    const double x = (double)f->s.x * s.w.x + (double)f->t.x * s.w.y + (double)f->n.x * s.w.z;
    const double y = (double)f->s.y * s.w.x + (double)f->t.y * s.w.y + (double)f->n.y * s.w.z;
    const double z = (double)f->s.z * s.w.x + (double)f->t.z * s.w.y + (double)f->n.z * s.w.z;
    CHECK(t.col == s.col && t.row == s.row && t.pdf == s.pdf, "axis %d: another texel or density", k);
    CHECK(fabs(t.w.x - x) <= 4 * eps && fabs(t.w.y - y) <= 4 * eps && fabs(t.w.z - z) <= 4 * eps,
          "axis %d: (%g, %g, %g) turned the wrong way", k, (double)t.w.x, (double)t.w.y, (double)t.w.z);
    mcs_vec3 local;
    local.x = (float)dot(f->s, t.w);
    local.y = (float)dot(f->t, t.w);
    local.z = (float)dot(f->n, t.w);
    double col, row;
    texel_of(m->w, m->h, local, &col, &row);
    const double margin_row = 8 * eps * m->h;
    const double margin_col = 8 * eps * m->w / hypot((double)local.x, (double)local.y);
    col -= floor(col);
    row -= floor(row);
    mcs_texel at = mcs_env_texel(turned, t.w);
    CHECK(mcs_env_pdf(turned, t.w) == at.pdf &&
              at.pdf == mcs_env_pdf(straight, point(m->w, m->h, at.col, at.row, 0.5, 0.5)),
          "axis %d: pdf %g is not the texel's", k, (double)at.pdf);
    if (at.col == s.col && at.row == s.row) return 0;
    CHECK((at.col == s.col || col <= margin_col || 1 - col <= margin_col) &&
              (at.row == s.row || row <= margin_row || 1 - row <= margin_row),
          "axis %d: drawn in (%u, %u), found in (%u, %u)", k, s.col, s.row, at.col, at.row);
    return 1;
}
static void check_turned_mass(const map *m, const mcs_env *turned, int k) {
    double mass = 0;
    for (uint32_t r = 0; r < m->h; r++)
        for (uint32_t c = 0; c < m->w; c++) {
            const mcs_vec3 p = point(m->w, m->h, c, r, 0.5, 0.5);
            const mcs_vec3 w = mcs_to_world(&turned->frame, p);
            float pdf = 0;
            mcs_env_pdf_n(turned, 1, &w.x, &w.y, &w.z, &pdf);
            CHECK(pdf == mcs_env_pdf(turned, w), "axis %d: pdf_n %g", k, (double)pdf);
            mass += pdf * (double)solid_angle(r, m->w, m->h);
        }
    CHECK(fabs(mass - 1) <= 4 * eps, "axis %d: the density integrates to 1 + %g", k, mass - 1);
}

/* A turned map is the same map: drawn where the turned sample lies, with its density. Turning rounds each coordinate by
 * 4 eps, so a direction closer than that to a border of its texel may be found on the other side of it: 8 eps of a turn
 * for columns, divided by sin(theta), and for rows; such ones are counted, and few. */
static void test_frame(void) {
    const map *m = &maps[SKY];
    const int draws = scaled(200000);
    const mcs_vec3 up[4] = {{0, 0, -1}, {1, 0, 0}, {0.6f, 0, 0.8f}, {-0.48f, 0.6f, -0.64f}};
    arena a = build(m);
    arena b = build(m);
    mcs_env *turned = env_in(&b);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 83);
    for (int k = 0; k < 4; k++) {
        int neighbours = 0;
        turned->frame = mcs_frame_make(up[k]);
        if (k == 3) { /* and turned about its axis, and mirrored */
            const mcs_vec3 s = turned->frame.s;
            turned->frame.s = turned->frame.t;
            turned->frame.t = s;
        }
        CHECK(mcs_env_check(turned, b.bytes) == MCS_OK, "axis %d: not a table any more", k);
        for (int i = 0; i < draws; i++) {
            const float u1 = mcs_pcg32_float(&rng);
            const float u2 = mcs_pcg32_float(&rng);
            neighbours += check_turned_draw(m, env_in(&a), turned, k, u1, u2);
        }
        /* at both borders of a column 8 eps w / sin(theta), 1.3 in the mean, at those of a row 8 eps h, twice as much
         * allowed */
        CHECK(neighbours <= draws * 64 * eps * m->w + 10, "axis %d: %d of %d draws found in a neighbour", k, neighbours,
              draws);
        check_turned_mass(m, turned, k);
    }
    arena_free(&a);
    arena_free(&b);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("env input");
    if (mcst_case("1, 3, 4 channels and strides")) test_channels();
    if (mcst_case("pixel and row strides")) test_strides();
    if (mcst_case("refused strides")) test_refused_strides();
    if (mcst_case("bad pixels")) test_bad_pixels();
    if (mcst_case("bad channels, infinite ones")) test_bad_channels();
    if (mcst_case("all infinite")) test_all_infinite();
    if (mcst_case("black")) test_black();
    if (mcst_case("refused builds")) test_refused();
    if (mcst_case("bad u and directions")) test_bad_sampler_input();
    if (mcst_case("a window over the seam")) test_seam();
    if (mcst_case("axes")) test_axes();
    if (mcst_case("turned")) test_frame();
    return mcst_finish();
}
