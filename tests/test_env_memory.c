/* What the environment map keeps in memory: probabilities that are integers, places that are skipped, the same bytes
 * whatever was there before. The truth is the picture; the layout is the one documented at mcsi_env_offsets.
 * MCS_TEST_BIG adds a map of 16384 x 8192, in 1.2 GB. */
#include "env_pictures.h"

/* ---- probabilities in integers ---- */

/* A list of cumulative sums against the weights: differences add up to 2^31, nothing gets nothing, everything else at
 * least one and its share. A share moves by one of rounding, its own one, and its part of the ones of all that are lit;
 * `loose` is the relative rounding of the weights, n 2^-22 that of sums of doubles. */
static void check_list(const picture *p, const uint32_t *cdf, const ld *weight, uint32_t n, double loose,
                       const char *what, uint32_t at) {
    uint64_t sum = 0;
    ld total = 0;
    uint32_t lit = 0;
    uint32_t falls = 0;
    for (uint32_t i = 0; i < n; i++) {
        total += weight[i];
        lit += weight[i] > 0;
    }
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t share = cdf[i + 1] - cdf[i];
        const double want = (double)(weight[i] / total * one);
        falls += cdf[i + 1] < cdf[i];
        sum += share;
        CHECK((share > 0) == (weight[i] > 0), "%s: %s %u, entry %u has %u of 2^31 and weight %Lg", p->name, what, at, i,
              share, weight[i]);
        CHECK(fabs(share - want) <= 2 + lit * (want / one) + loose * want + n * 0x1p-22,
              "%s: %s %u, entry %u has %u of 2^31, not %g", p->name, what, at, i, share, want);
    }
    CHECK(cdf[0] == 0 && cdf[n] == one && falls == 0 && sum == one,
          "%s: %s %u: from %u to %u, %u falls, sum 2^31 + %lld", p->name, what, at, cdf[0], cdf[n], falls,
          (long long)sum - (long long)one);
}

/* The density times the solid angle is the product of the two integers over 2^62, rounded once to float. A small one
 * must therefore be an integer to the eye, whatever lies in memory. Returns how many small ones there were. */
static size_t check_integers(const picture *p, const arena *a) {
    const mcs_env *e = env_in(a);
    ld *weight = (ld *)malloc((p->w + p->h) * sizeof *weight);
    ld *row_weight = weight + p->w;
    ld mass = 0;
    const double loose = eps + 1e-12 + 0x1p-51 / (1 - cos(pi / p->h));
    const uint32_t *rows = rows_of(a);
    size_t small = 0;
    if (!weight) exit(2);
    for (uint32_t r = 0; r < p->h; r++) {
        const ld omega = solid_angle(r, p->w, p->h);
        ld sum = 0;
        uint32_t lit = 0;
        for (uint32_t c = 0; c < p->w; c++) {
            sum += weight[c] = p->lum[(size_t)r * p->w + c];
            lit += weight[c] > 0;
        }
        row_weight[r] = sum * omega;
        if (lit) check_list(p, cdf_of(a, r), weight, p->w, 0, "row", r);
        for (uint32_t c = 0; c < p->w; c++) {
            const float pdf = mcs_env_pdf(e, point(p->w, p->h, c, r, 0.5, 0.5));
            const ld found = pdf * omega * 0x1p62L;
            const ld nearest = roundl(found);
            const ld want = lit ? (ld)(rows[r + 1] - rows[r]) * (cdf_of(a, r)[c + 1] - cdf_of(a, r)[c]) : 0;
            mass += pdf * omega;
            CHECK(fabsl(found - want) <= loose * want, "%s: texel (%u, %u) has probability %Lg / 2^62, not %Lg",
                  p->name, c, r, found, want);
            if (found == 0 || found >= 0x1p20L) continue;
            small++;
            CHECK(nearest >= 1 && fabsl(found - nearest) <= loose * nearest,
                  "%s: texel (%u, %u) has probability %Lg / 2^62", p->name, c, r, found);
        }
    }
    check_list(p, rows, row_weight, p->h, 4 * eps, "rows of", 0);
    CHECK(fabsl(mass - 1) <= loose, "%s: probabilities add up to 1 + %Lg", p->name, mass - 1);
    free(weight);
    return small;
}

/* The first and the last number of every row, and many others: each draws the texel whose share holds it, never a black
 * one. */
static void check_lit(const picture *p, const arena *a) {
    const uint32_t *rows = rows_of(a);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 89);
    const int draws = env_in(a)->uniform ? 0 : scaled(100000);
    for (uint32_t r = 0; r < p->h; r++)
        for (uint32_t k = 0; k < 2 && rows[r] < rows[r + 1]; k++) {
            const mcs_texel s =
                mcs_env_sample_bits(env_in(a), mcs_pcg32_next(&rng), k ? 2 * (rows[r + 1] - 1) + 1 : 2 * rows[r]);
            CHECK(s.row == r, "%s: %s of row %u draws row %u", p->name, k ? "end" : "begin", r, s.row);
        }
    for (int i = 0; i < draws; i++) {
        const uint32_t b1 = mcs_pcg32_next(&rng);
        const uint32_t b2 = mcs_pcg32_next(&rng);
        const mcs_texel s = mcs_env_sample_bits(env_in(a), b1, b2);
        const int in = s.col < p->w && s.row < p->h;
        const uint32_t *cdf = cdf_of(a, in ? s.row : 0) + (in ? s.col : 0);
        CHECK(in && p->lum[(size_t)s.row * p->w + s.col] > 0 && s.pdf > 0, "%s: black texel (%u, %u) drawn", p->name,
              s.col, s.row);
        CHECK(in && rows[s.row] <= b2 / 2 && b2 / 2 < rows[s.row + 1] && cdf[0] <= b1 / 2 && b1 / 2 < cdf[1],
              "%s: bits %08x, %08x draw texel (%u, %u)", p->name, b1, b2, s.col, s.row);
    }
}

static void test_integers(void) {
    static const picture all[] = {{"1 x 1", 1, 1, v_random, NULL},
                                  {"7 x 5", 7, 5, v_random, NULL},
                                  {"1 x 1000", 1, 1000, v_thirds, NULL},
                                  {"1000 x 1", 1000, 1, v_wide, NULL},
                                  {"100 x 999", 100, 999, v_checker, NULL},
                                  {"denormals", 20, 10, v_tiny, NULL},
                                  {"FLT_MAX", 64, 32, v_huge, NULL},
                                  {"1e-38 to 1e38", 515, 33, v_wide, NULL},
                                  {"sky", 512, 256, v_sky, NULL},
                                  {"region", 93, 50, v_region, NULL},
                                  {"sun in every row", 4096, 16, v_sun_rows, NULL}};
    const shade any[4] = {v_random, v_wide, v_region, v_thirds};
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 97);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        picture p = all[k];
        draw(&p);
        arena a = build(&p, LIT);
        check_integers(&p, &a);
        check_lit(&p, &a);
        arena_free(&a);
        free(p.lum);
    }
    for (int i = 0; i < 12; i++) {
        const uint32_t w = 15 + mcs_pcg32_next(&rng) % 200;
        const picture p = make("random shape", w, 12 + mcs_pcg32_next(&rng) % 100, any[i % 4]);
        arena a = build(&p, LIT);
        check_integers(&p, &a);
        check_lit(&p, &a);
        arena_free(&a);
        free(p.lum);
    }
    {
        const picture p = make("suns", 64, 32, v_suns);
        arena a = build(&p, LIT);
        const size_t small = check_integers(&p, &a);
        CHECK(small >= p.w - 1, "%zu texels of a few 2^-62", small);
        check_lit(&p, &a);
        arena_free(&a);
        free(p.lum);
    }
}

/* Texels 1e8 times darker than one of their row: 15 to 30 integers each, to within 2, and bits that reach each of them.
 */
static void test_contrast(void) {
    const picture p = make("sun in every row", 4096, 16, v_sun_rows);
    arena a = build(&p, LIT);
    const mcs_env *e = env_in(&a);
    ld total = 0;
    for (uint32_t r = 0; r < p.h; r++)
        for (uint32_t c = 0; c < p.w; c++) total += p.lum[r * p.w + c] * solid_angle(r, p.w, p.h);
    for (uint32_t r = 0; r < p.h; r++) {
        ld sum = 0;
        for (uint32_t c = 0; c < p.w; c++) sum += p.lum[r * p.w + c];
        const ld row = sum * solid_angle(r, p.w, p.h) / total;
        for (uint32_t c = 0; c < p.w; c++) {
            const mcs_texel s = mcs_env_sample_bits(e, middle(cdf_of(&a, r), c), middle(rows_of(&a), r));
            const double found = (double)(s.pdf * solid_angle(r, p.w, p.h) / row) * one;
            const double want = (double)(p.lum[r * p.w + c] / sum) * one;
            CHECK(s.row == r && s.col == c, "texel (%u, %u) reached by none: (%u, %u)", c, r, s.col, s.row);
            /* the row's own integer: 2 and its part of 16, of at least 2^31/128 */
            CHECK(fabs(found - want) <= 2 + p.w * (want / one) + want * (18 * 128 / (double)one + 6 * eps),
                  "texel (%u, %u): %g of 2^31 of its row, not %g", c, r, found, want);
            CHECK(mcs_env_pdf(e, s.w) == s.pdf, "texel (%u, %u): pdf", c, r);
        }
    }
    arena_free(&a);
    free(p.lum);
}

/* ---- in parts ---- */

/* Ranges that hold every row, in random order, some empty, some twice: the same bytes, in memory that held others. */
static void test_parts(void) {
    const shade any[5] = {v_random, v_wide, v_region, v_thirds, v_black};
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 101);
    for (int i = 0; i < 60; i++) {
        uint32_t n = 0;
        uint32_t y = 0;
        const picture p = make("parts", 1 + mcs_pcg32_next(&rng) % 150, 1 + mcs_pcg32_next(&rng) % 120, any[i % 5]);
        mcs_image image = mcs_image_make(p.lum, p.w, p.h, 1);
        arena a = arena_make(mcs_env_bytes(p.w, p.h));
        arena b = arena_make(a.bytes);
        mcs_status rc = MCS_OK;
        image.bilinear = i % 3 == 1;
        image.floor = i % 4 == 2 ? mcs_env_mean(&image) : 0;
        arena_past(&b, i % ARENA_PASTS);
        const mcs_status whole = mcs_env_build(env_in(&a), a.bytes, &image);
        uint32_t first[160], end[160];
        while (y < p.h) {
            const uint32_t rest = p.h - y;
            const uint32_t to = y + (i % 2 ? 1 + mcs_pcg32_next(&rng) % rest : 1);
            first[n] = y;
            end[n++] = y = to;
        }
        for (uint32_t k = 0; k < 3; k++, n++) {
            first[n] = mcs_pcg32_next(&rng) % p.h;
            end[n] = first[n] + (k ? 0 : mcs_pcg32_next(&rng) % (p.h - first[n] + 1));
        }
        while (n > 0) {
            const uint32_t k = mcs_pcg32_next(&rng) % n--;
            rc = rc ? rc : mcs_env_build_rows(env_in(&b), b.bytes, &image, first[k], end[k]);
            first[k] = first[n];
            end[k] = end[n];
        }
        CHECK(rc == MCS_OK && mcs_env_finish(env_in(&b), b.bytes, &image) == whole && arena_intact(&b),
              "%u x %u: returns %d", p.w, p.h, rc);
        CHECK(memcmp(a.at, b.at, a.bytes) == 0, "%u x %u: another table than at once", p.w, p.h);
        CHECK(mcs_env_check(env_in(&b), b.bytes) == MCS_OK, "%u x %u: no table", p.w, p.h);
        arena_free(&a);
        arena_free(&b);
        free(p.lum);
    }
}

static void test_refused_parts(void) {
    const picture p = make("refused", 12, 9, v_random);
    const mcs_image image = mcs_image_make(p.lum, p.w, p.h, 1);
    arena a = arena_make(mcs_env_bytes(p.w, p.h));
    mcs_env *e = env_in(&a);
    const mcs_status rc[9] = {mcs_env_build_rows(e, a.bytes, &image, 0, p.h + 1),
                              mcs_env_build_rows(e, a.bytes, &image, 5, 4),
                              mcs_env_build_rows(e, a.bytes, &image, 0xffffffffu, 0),
                              mcs_env_build_rows(e, a.bytes, &image, 0xffffffffu, 0xffffffffu),
                              mcs_env_build_rows(NULL, a.bytes, &image, 0, 1),
                              mcs_env_build_rows(e, a.bytes - 1, &image, 0, 1),
                              mcs_env_build_rows(e, a.bytes, NULL, 0, 1),
                              mcs_env_finish(e, a.bytes - 1, &image),
                              mcs_env_finish(e, a.bytes, NULL)};
    const mcs_status want[9] = {MCS_ERR_SIZE,   MCS_ERR_SIZE, MCS_ERR_SIZE,   MCS_ERR_SIZE, MCS_ERR_ARG,
                                MCS_ERR_MEMORY, MCS_ERR_ARG,  MCS_ERR_MEMORY, MCS_ERR_ARG};
    for (int i = 0; i < 9; i++) CHECK(rc[i] == want[i], "refusal %d: %d, not %d", i, rc[i], want[i]);
    CHECK(mcs_env_build(e, a.bytes, NULL) == MCS_ERR_ARG, "build without an image");
    CHECK(untouched(a.at, a.bytes) && arena_intact(&a), "a refused build wrote");
    arena_free(&a);
    free(p.lum);
}

/* ---- what is skipped ---- */

/* Overwrites the columns' sums and guides of row r. */
static void poison(const arena *a, uint32_t r) {
    memset(cdf_of(a, r), 0xff, (env_in(a)->w + 1) * sizeof(uint32_t));
    memset(guide_of(a, r), 0xff, env_in(a)->offset.guide_length * 2);
}
static size_t zeros(const unsigned char *p, size_t n) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++) count += p[i] == 0;
    return count;
}
static size_t row_bytes(const mcs_env *e) {
    return (e->w + (size_t)1) * sizeof(uint32_t) + e->offset.guide_length * (size_t)2;
}

enum { DRAWS = 4096 };
static float u1[DRAWS], u2[DRAWS], x[4][DRAWS], again[4][DRAWS];

/* Draws and densities of all texels, for a table before and after its memory was spoilt. */
static double record(const mcs_env *e, float *pdf) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 103);
    double sum = 0;
    for (int i = 0; i < scaled(250); i++) {
        mcs_pcg32_fill_n(&rng, DRAWS, u1);
        mcs_pcg32_fill_n(&rng, DRAWS, u2);
        mcs_env_sample_n(e, DRAWS, u1, u2, x[0], x[1], x[2], x[3], NULL, NULL);
        mcs_env_pdf_n(e, DRAWS, x[0], x[1], x[2], again[3]);
        for (int k = 0; k < DRAWS; k++) sum += x[0][k] + 2 * x[1][k] + 4 * x[2][k] + x[3][k] + again[3][k];
        for (int k = 0; k < DRAWS; k += 16) {
            const mcs_texel s = mcs_env_sample(e, u1[k], u2[k]);
            const mcs_vec2 u = mcs_env_invert(e, s.w);
            sum += (double)s.pdf + mcs_env_pdf(e, s.w) + u.x + u.y + s.col + s.row;
        }
    }
    for (uint32_t r = 0; r < e->h; r++)
        for (uint32_t c = 0; c < e->w; c++) {
            const mcs_vec3 v = point(e->w, e->h, c, r, 0.5, 0.5);
            const mcs_vec2 u = mcs_env_invert(e, v);
            *pdf++ = mcs_env_pdf(e, v);
            sum += u.x + u.y;
        }
    return sum;
}

/* Draws, densities and inverse without the memory of rows that hold nothing to know. `lit`: rows of light that the map
 * has. */
static void check_skips(picture p, brightness want, uint32_t lit, int uniform) {
    arena a = build(&p, want);
    const mcs_env *e = env_in(&a);
    const size_t texels = (size_t)p.w * p.h;
    float *before = (float *)malloc(2 * texels * sizeof *before);
    float *after = before + texels;
    uint32_t unread = 0;
    if (!before) exit(2);
    CHECK(!e->uniform == !uniform, "%s: uniform is %u", p.name, e->uniform);
    const double first = record(e, before);
    for (uint32_t r = 0; r < p.h; r++) {
        int black = 1;
        for (uint32_t c = 0; c < p.w; c++) black &= p.lum[(size_t)r * p.w + c] == 0;
        const size_t none = zeros((unsigned char *)cdf_of(&a, r), (p.w + (size_t)1) * 4) +
                            zeros(guide_of(&a, r), e->offset.guide_length * (size_t)2);
        CHECK(!black || none == row_bytes(e), "%s: %zu of %zu bytes of black row %u are not 0", p.name,
              row_bytes(e) - none, row_bytes(e), r);
        if (black || uniform) {
            poison(&a, r);
            unread++;
        }
    }
    CHECK(unread == (uniform ? p.h : p.h - lit), "%s: %u rows spoilt", p.name, unread);
    if (uniform) memset(rows_of(&a), 0xff, e->offset.col_sums - e->offset.row_sums);
    const double second = record(e, after);
    CHECK(first == second && memcmp(before, after, texels * sizeof *before) == 0,
          "%s: draws or densities read what was spoilt", p.name);
    CHECK(unread == 0 || mcs_env_check(e, a.bytes) == MCS_ERR_FORMAT, "%s: spoilt, and accepted", p.name);
    if (uniform)
        for (uint32_t r = 0; r < texels; r++)
            CHECK(fabs(after[r] * 4 * pi - 1) <= 2 * eps, "%s: density %g", p.name, (double)after[r]);
    free(before);
    free(p.lum);
    arena_free(&a);
}

static void test_skips(void) {
    check_skips(make("constant", 128, 64, v_constant), LIT, 64, 1);
    check_skips(make("constant, odd", 31, 17, v_constant), LIT, 17, 1);
    check_skips(make("black", 128, 64, v_black), BLACK, 0, 1);
    check_skips(make("every third row", 128, 66, v_thirds), LIT, 22, 0);
    check_skips(make("dark ground", 256, 128, v_sky), LIT, 64, 0);
    check_skips(make("region", 200, 96, v_region), LIT, 32, 0);
}

/* Outside [row0, row1) x [col0, col1), the smallest rectangle of light, densities are found without reading the sums.
 */
static void test_region(void) {
    const picture p = make("region", 200, 96, v_region);
    arena a = build(&p, LIT);
    const mcs_env *e = env_in(&a);
    uint32_t row0 = p.h;
    uint32_t row1 = 0;
    uint32_t col0 = p.w;
    uint32_t col1 = 0;
    uint32_t zero = 0;
    for (uint32_t r = 0; r < p.h; r++)
        for (uint32_t c = 0; c < p.w; c++) {
            if (!(p.lum[r * p.w + c] > 0)) continue;
            row0 = r < row0 ? r : row0;
            row1 = r + 1;
            col0 = c < col0 ? c : col0;
            col1 = c + 1 > col1 ? c + 1 : col1;
        }
    CHECK(e->row0 == row0 && e->row1 == row1 && e->col0 == col0 && e->col1 == col1, "light in [%u, %u) x [%u, %u)",
          e->row0, e->row1, e->col0, e->col1);
    for (uint32_t r = 0; r < p.h; r++) {
        uint32_t *cdf = cdf_of(&a, r);
        for (uint32_t c = 0; c < col0; c++) cdf[c] = 0x9e3779b9u * (c + 1);
        for (uint32_t c = col1 + 1; c <= p.w; c++) cdf[c] = 0x9e3779b9u * (c + 1);
        if (r < row0 || r >= row1) poison(&a, r);
    }
    for (uint32_t r = 0; r < p.h; r++)
        for (uint32_t c = 0; c < p.w; c++) {
            const mcs_vec3 v = point(p.w, p.h, c, r, 0.5, 0.5);
            const float pdf = mcs_env_pdf(e, v);
            float batch = -1;
            mcs_env_pdf_n(e, 1, &v.x, &v.y, &v.z, &batch);
            zero += pdf == 0;
            CHECK((pdf > 0) == (p.lum[r * p.w + c] > 0) && batch == pdf, "texel (%u, %u): density %g, in a batch %g", c,
                  r, (double)pdf, (double)batch);
        }
    CHECK(zero >= p.w * p.h - (row1 - row0) * (col1 - col0), "%u texels without density", zero);
    arena_free(&a);
    free(p.lum);
}

/* ---- bits, and the largest maps ---- */

/* Every texel of a map has bits that reach it: those in the middle of its share. First, middle and last ones lie in it,
 * as seen by a double arctangent and by mcs_env_texel: the margin that keeps places off borders is enough. */
static void check_every(const picture *p, const arena *a, int places) {
    const mcs_env *e = env_in(a);
    const uint32_t *rows = rows_of(a);
    uint32_t missed = 0;
    uint32_t strayed = 0;
    for (uint32_t r = 0; r < p->h; r++) {
        const uint32_t *cdf = cdf_of(a, r);
        const uint32_t down[3] = {middle(rows, r), 2 * rows[r], 2 * (rows[r + 1] - 1) + 1};
        if (rows[r] == rows[r + 1]) continue;
        for (uint32_t c = 0; c < p->w; c++) {
            const uint32_t along[3] = {middle(cdf, c), 2 * cdf[c], 2 * (cdf[c + 1] - 1) + 1};
            if (!(p->lum[(size_t)r * p->w + c] > 0)) continue;
            for (int k = 0; k < places; k++) {
                const mcs_texel s = mcs_env_sample_bits(e, along[k % 3], down[k / 3]);
                missed += s.col != c || s.row != r;
                if (places > 1) {
                    const mcs_texel t = mcs_env_texel(e, s.w);
                    double col, row;
                    texel_of(p->w, p->h, s.w, &col, &row);
                    strayed += !(t.col == c && t.row == r && t.pdf == s.pdf && floor(col) == c && floor(row) == r);
                }
            }
        }
    }
    CHECK(missed == 0, "%s: %u times not the texel of the bits", p->name, missed);
    CHECK(strayed == 0, "%s: %u directions found in another texel", p->name, strayed);
}

/* Columns by bisection alone: the least bits that draw column c or a later one draw c itself. */
static void check_bisected(const picture *p, const mcs_env *e, uint32_t b2) {
    const uint32_t row = mcs_env_sample_bits(e, 0, b2).row;
    uint32_t unreached = 0;
    for (uint32_t c = 0; c < p->w; c++) {
        uint32_t lo = 0;
        uint32_t hi = 0xffffffffu;
        if (!(p->lum[(size_t)row * p->w + c] > 0)) continue;
        while (lo < hi) {
            const uint32_t mid = lo + (hi - lo) / 2;
            if (mcs_env_sample_bits(e, mid, b2).col >= c) hi = mid;
            else lo = mid + 1;
        }
        unreached += mcs_env_sample_bits(e, lo, b2).col != c;
    }
    CHECK(unreached == 0, "%s: %u texels of row %u that no bits reach", p->name, unreached, row);
}

static void check_bits(const picture *p, const mcs_env *e) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 107);
    const int draws = scaled(1000000);
    uint32_t last_col = 0;
    uint32_t last_row = 0;
    uint32_t falls = 0;
    float z = 2;
    for (uint64_t b = 0; b <= 0xffffffffu; b += mcs_pcg32_next(&rng) >> 15) {
        const mcs_texel s = mcs_env_sample_bits(e, (uint32_t)b, 0x9e3779b9u);
        const mcs_texel t = mcs_env_sample_bits(e, mcs_pcg32_next(&rng), (uint32_t)b);
        falls += s.col < last_col || t.row < last_row || !(t.w.z <= z);
        last_col = s.col;
        last_row = t.row;
        z = t.w.z;
    }
    CHECK(falls == 0, "%s: %u falls", p->name, falls);
    for (int i = 0; i < draws; i++) {
        /* at most 24 bits that count, so that a float holds b 2^-32: any of the 24-bit grid, and small ones */
        const uint32_t x1 = mcs_pcg32_next(&rng);
        const uint32_t x2 = mcs_pcg32_next(&rng);
        const uint32_t b1 = i & 1 ? x1 & 0xffffff00u : x1 >> 8 >> (x1 & 15);
        const uint32_t b2 = i & 2 ? x2 & 0xffffff00u : x2 >> 8 >> (x2 & 15);
        const float f1 = (float)b1 * 0x1p-32f;
        const float f2 = (float)b2 * 0x1p-32f;
        const mcs_texel s = mcs_env_sample_bits(e, b1, b2);
        const mcs_texel t = mcs_env_sample(e, f1, f2);
        CHECK(same(s, t), "%s: u = %a, %a: (%u, %u), by bits (%u, %u)", p->name, (double)f1, (double)f2, t.col, t.row,
              s.col, s.row);
    }
}

/* Random places of the largest maps, by floats: what was drawn is what is found. */
static void check_found(const picture *p, const mcs_env *e) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 109);
    const int draws = scaled(1000000);
    int off = 0;
    int strayed = 0;
    for (int i = 0; i < draws; i++) {
        const float v = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(e, v, mcs_pcg32_float(&rng));
        const mcs_texel t = mcs_env_texel(e, s.w);
        double col, row;
        texel_of(p->w, p->h, s.w, &col, &row);
        off += !(t.col == s.col && t.row == s.row && t.pdf == s.pdf && s.pdf > 0);
        strayed += floor(col) != s.col || floor(row) != s.row;
    }
    CHECK(off == 0 && strayed == 0, "%s: of %d draws the header finds %d in another texel, a double arctangent %d",
          p->name, draws, off, strayed);
}

static void test_long(uint32_t w, uint32_t h, shade value) {
    const picture p = make(w > h ? "wide" : "tall", w, h, value);
    arena a = build(&p, LIT);
    check_every(&p, &a, 9);
    check_bits(&p, env_in(&a));
    check_found(&p, env_in(&a));
    if (w > h) check_bisected(&p, env_in(&a), 0x55555555u);
    arena_free(&a);
    free(p.lum);
}

/* ---- the same bytes whatever the memory held ---- */

typedef int (*builder)(void *to, size_t bytes, const void *from);
static void check_same(size_t bytes, builder f, const void *from, const char *what, uint32_t i, uint32_t j) {
    arena a[ARENA_PASTS];
    int rc[ARENA_PASTS];
    for (int past = 0; past < ARENA_PASTS; past++) {
        a[past] = arena_make(bytes);
        arena_past(&a[past], past);
        rc[past] = f(a[past].at, bytes, from);
        CHECK(rc[past] >= 0 && rc[past] == rc[0] && arena_intact(&a[past]), "%s (%u, %u): returns %d", what, i, j,
              rc[past]);
        CHECK(arena_differ(&a[0], &a[past]) == bytes, "%s (%u, %u): byte %zu of %zu is another one", what, i, j,
              arena_differ(&a[0], &a[past]), bytes);
    }
    for (int past = 0; past < ARENA_PASTS; past++) arena_free(&a[past]);
}
static int image_builds(void *to, size_t bytes, const void *from) {
    return mcs_env_build((mcs_env *)to, bytes, (const mcs_image *)from);
}
static int rows_build(void *to, size_t bytes, const void *from) {
    const mcs_image *im = (const mcs_image *)from;
    const int rc = mcs_env_build_rows((mcs_env *)to, bytes, im, im->h / 2, im->h);
    return rc                                                           ? rc
           : mcs_env_build_rows((mcs_env *)to, bytes, im, 0, im->h / 2) ? -1
                                                                        : mcs_env_finish((mcs_env *)to, bytes, im);
}
typedef struct {
    const mcs_env *e;
    const mcs_tiles *t;
    const mcs_reflection *r;
    const float *weight;
    uint32_t row, rows, col, cols;
} source;
static int window_builds(void *to, size_t bytes, const void *from) {
    const source *s = (const source *)from;
    return mcs_env_window_build((mcs_env_window *)to, bytes, s->e, s->row, s->rows, s->col, s->cols);
}
static int tiles_build(void *to, size_t bytes, const void *from) {
    const source *s = (const source *)from;
    return mcs_tiles_build((mcs_tiles *)to, bytes, s->e, s->rows);
}
static int product_builds(void *to, size_t bytes, const void *from) {
    const source *s = (const source *)from;
    return s->weight ? mcs_product_build_weights((mcs_product *)to, bytes, s->t, s->e, s->weight)
                     : mcs_product_build((mcs_product *)to, bytes, s->t, s->e, s->r, NULL);
}

static void test_same_maps(void) {
    const shade any[6] = {v_random, v_region, v_thirds, v_black, v_constant, v_suns};
    for (uint32_t w = 1; w < 40; w += w < 12 ? 1 : 9)
        for (uint32_t h = 1; h < 40; h += h < 12 ? 1 : 9)
            for (uint32_t i = 0; i < 6; i++) {
                picture p = make("map", w, h, any[i]);
                mcs_image image = mcs_image_make(p.lum, w, h, 1);
                image.bilinear = (w + h) % 2;
                image.floor = w % 3 ? 0 : mcs_env_mean(&image);
                if ((w * h) % 5 == 0) p.lum[w * h / 2] = NAN;
                check_same(mcs_env_bytes(w, h), image_builds, &image, "map", w, h);
                check_same(mcs_env_bytes(w, h), rows_build, &image, "map in parts", w, h);
                free(p.lum);
            }
}
static void test_same_windows(void) {
    const shade any[4] = {v_random, v_thirds, v_black, v_constant};
    for (uint32_t i = 0; i < 4; i++) {
        const picture p = make("window", 19, 23, any[i]);
        arena a = build(&p, i == 2 ? BLACK : LIT);
        source s;
        memset(&s, 0, sizeof s);
        s.e = env_in(&a);
        for (s.rows = 1; s.rows <= 23; s.rows++) {
            s.row = (5 * s.rows) % (24 - s.rows);
            s.col = (7 * s.rows) % 19;
            s.cols = 1 + (11 * s.rows) % 19;
            check_same(mcs_env_window_bytes(s.rows), window_builds, &s, p.name, s.row, s.rows);
        }
        arena_free(&a);
        free(p.lum);
    }
}
/* Maps that rows of tiles divide and do not divide, or that have fewer rows than tiles; surfaces that are matte, rough,
 * glossy enough for fine grids, turned from every light, and seen from behind. */
static void test_same_products(void) {
    static const struct {
        uint32_t w, h;
        shade value;
    } maps[] = {{64, 32, v_sky},    {50, 37, v_random}, {7, 5, v_thirds},
                {40, 70, v_region}, {33, 30, v_black},  {32, 16, v_constant}};
    static const mcs_profile profiles[] = {MCS_PROFILE_GAUSS, MCS_PROFILE_PHONG, MCS_PROFILE_GGX,
                                           MCS_PROFILE_GAUSS, MCS_PROFILE_GAUSS, MCS_PROFILE_ASHIKHMIN};
    static float weight[2 * 32 * 32];
    for (size_t k = 0; k < sizeof maps / sizeof *maps; k++)
        for (uint32_t rows = 16; rows <= 32; rows *= 2) {
            const picture p = make("product", maps[k].w, maps[k].h, maps[k].value);
            arena a = build(&p, maps[k].value == v_black ? BLACK : LIT);
            arena b = arena_make(mcs_tiles_bytes(env_in(&a), rows));
            source s;
            memset(&s, 0, sizeof s);
            s.e = env_in(&a);
            s.rows = rows;
            s.t = (const mcs_tiles *)(void *)b.at;
            check_same(b.bytes, tiles_build, &s, "tiles", p.w, rows);
            const mcs_status rc = mcs_tiles_build((mcs_tiles *)(void *)b.at, b.bytes, s.e, rows);
            CHECK(rc == MCS_OK, "tiles: %d", rc);
            for (size_t i = 0; i < 6; i++) {
                mcs_reflection r;
                memset(&r, 0, sizeof r);
                r.frame = mcs_frame_make(mcs_sphere_sample(0.3f, i == 3 ? 0.999f : 0.2f).w);
                r.wo.z = i == 4 ? -1.0f : 1.0f;
                r.alpha_x = i == 2 ? 0.03f : i == 5 ? 1e-3f : 0.4f;
                r.alpha_y = r.alpha_x;
                r.matte = i == 0 ? 1.0f : 0.2f;
                r.profile = profiles[i];
                s.r = &r;
                check_same(mcs_product_bytes(rows), product_builds, &s, "product", p.w, (uint32_t)i);
            }
            for (size_t i = 0; i < 2 * rows * rows; i++) weight[i] = i % 3 ? hash01((uint32_t)i) : 0;
            s.weight = weight;
            check_same(mcs_product_table_bytes(rows), product_builds, &s, "product of weights", p.w, rows);
            arena_free(&a);
            arena_free(&b);
            free(p.lum);
        }
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("env integers");
    if (mcst_case("rows and columns add up to 2^31, densities to 1")) test_integers();
    if (mcst_case("texels 1e8 times brighter than their rows")) test_contrast();
    mcst_group("env in parts");
    if (mcst_case("ranges of rows in any order")) test_parts();
    if (mcst_case("refused ranges")) test_refused_parts();
    mcst_group("env skips");
    if (mcst_case("constant, black, black rows")) test_skips();
    if (mcst_case("outside a lit region")) test_region();
    mcst_group("env largest maps");
    if (mcst_case("65536 x 3")) test_long(65536, 3, v_random);
    if (mcst_case("3 x 65536")) test_long(3, 65536, v_random);
    if (mcst_case("65536 x 4, 1e-38 to 1e38")) test_long(65536, 4, v_wide);
    if (mcst_case("4 x 65536, 1e-38 to 1e38")) test_long(4, 65536, v_wide);
    if (getenv("MCS_TEST_BIG") && mcst_case("16384 x 8192")) {
        const picture p = make("16384 x 8192", 16384, 8192, v_random);
        arena a = build(&p, LIT);
        check_every(&p, &a, 1);
        arena_free(&a);
        free(p.lum);
    }
    mcst_group("env memory of before");
    if (mcst_case("maps")) test_same_maps();
    if (mcst_case("windows")) test_same_windows();
    if (mcst_case("tiles and products")) test_same_products();
    return mcst_finish();
}
