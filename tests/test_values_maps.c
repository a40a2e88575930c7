/* Values of maps and products that no sampler test looks at closely: the row of a direction beside a border, texels
 * that are alone or alike, the share of a lobe, tiny tiles, fine grids, black rows. */
#include "values.h"

/* ---- rows of a map ---- */

/* 1 - cos of border k of h, from the nearer pole. */
static ld border(uint32_t k, uint32_t h) {
    const ld s = sinl(0.5L * O_PI * (ld)k / (ld)h);
    return 2 * s * s;
}

/* Directions beside the borders of rows: 1 - cos(theta) of a float direction is known to 4 EPS (two products and a sum
 * 2, 1 + |z| 1, a quotient 1) and the error of its length, the guess from the angle only to 2^-23 turns: a row off that
 * is not set right shows. */
static void rows_beside_borders(uint32_t h) {
    float *light = (float *)malloc(2 * (size_t)h * sizeof *light);
    arena a = arena_make(mcs_env_bytes(2, h));
    mcs_env *e = (mcs_env *)(void *)a.at;
    uint64_t seed = mcst_seed_for("env", "rows", h);
    int beside = 0;
    if (!light) exit(2);
    for (uint32_t k = 0; k < 2 * h; k++) light[k] = (float)(1 + k % 3);
    const mcs_image image = mcs_image_make(light, 2, h, 1);
    CHECK(mcs_env_build(e, a.bytes, &image) == MCS_OK, "build");
    for (int i = 0; i < 300000; i++) {
        float u, v;
        mcst_uniform(&seed, 1, &u, &v);
        const uint32_t k = 1 + (uint32_t)(mcst_mix(&seed) % (h - 1));
        double theta = ST_PI * k / h;
        theta += fmin(theta, ST_PI - theta) * ldexp((double)u - 0.5, -18 - (int)(mcst_mix(&seed) % 6));
        float w[3];
        w[0] = (float)(sin(theta) * cos(6.283185307179586 * (double)v));
        w[1] = (float)(sin(theta) * sin(6.283185307179586 * (double)v));
        w[2] = (float)cos(theta);
        const o_vec3 o = o_v3(w[0], w[1], fabsf(w[2]));
        const ld t = o_one_minus_cos(o);
        const ld slack = t * (4 * EPS + fabsl(o_dot(o, o) - 1));
        uint32_t m = w[2] < 0 ? h - k : k; /* from the nearer pole the border that it lies beside, or the one before */
        if (2 * m > h) m = h - m;          /* across the equator */
        if (fabsl(t - border(m, h)) <= slack || 2 * m == h) continue;
        if (t < border(m, h)) m--;
        beside++;
        const uint32_t row = mcs_env_texel(e, vec3(w)).row;
        CHECK(row == (w[2] < 0 ? h - 1 - m : m), "(%a, %a, %a): row %u, not %u", (double)w[0], (double)w[1],
              (double)w[2], row, w[2] < 0 ? h - 1 - m : m);
    }
    CHECK(beside >= 10000, "%d directions", beside);
    /* What holds whatever the angle's rounding is: the angle only has to be right to 2^-23 turns, 1 - cos says which
     * row it is. */
    for (int i = 0; i < 200000; i++) {
        const uint32_t last = (h - 1) / 2;
        const uint32_t m = (uint32_t)(mcst_mix(&seed) % (last + 1));
        const int down = i & 1;
        const int off = (int)(mcst_mix(&seed) % 3) - 1;
        float u, v;
        mcst_uniform(&seed, 1, &u, &v);
        const float t = (float)(border(m, h) + (fminl(border(m + 1, h), 1) - border(m, h)) *
                                                   (ld)(i & 2 ? u * 0x1p-6f : 1 - u * 0x1p-6f));
        if (!((ld)t > border(m, h) && ((ld)t < border(m + 1, h) || m == last))) continue; /* beyond a border */
        u = (float)(acos(1 - (double)t) / (2 * ST_PI) + off * 0x1p-23);
        u = u > 0 ? u : 0;
        const uint32_t row = mcsi_env_row_at(e, down ? -t : t, u);
        CHECK(row == (down ? h - 1 - m : m), "1 - cos %a, %d of 2^-23 turns off: row %u, not %u", (double)t, off, row,
              down ? h - 1 - m : m);
    }
    free(light);
    arena_free(&a);
}

/* Borders of rows: the series ends at t^17 with t below pi/4, what is left out is below 1e-18; 16 roundings of 2^-53.
 */
static void borders_of_rows(void) {
    for (int i = 0; i <= 100000; i++) {
        const double x = i / 100000.0;
        const double got = mcsi_one_minus_cos_pi(x);
        const ld s = sinl(0.5L * O_PI * (ld)x);
        const ld want = 2 * s * s;
        CHECK(fabsl((ld)got - want) <= 16 * 0x1p-53L * want, "x = %g: %.17g, not %.17Lg", x, got, want);
    }
}

/* ---- texels of a map ---- */

/* The only light in every place of a row of some chunks. */
static void lone_texels(void) {
    enum { W = 2 * MCSI_ENV_CHUNK + MCSI_ENV_CHUNK / 2, H = 3 };
    for (uint32_t c = 0; c < W; c++) {
        float light[W * H];
        memset(light, 0, sizeof light);
        light[W + c] = 1;
        arena a;
        mcs_env *e = map_of(&a, light, W, H);
        const mcs_texel t = mcs_env_sample(e, 0.3f, 0.7f);
        CHECK(t.col == c && t.row == 1 && t.pdf > 0 && mcs_env_pdf(e, t.w) == t.pdf,
              "column %u: drawn %u, %u, density %g", c, t.col, t.row, (double)t.pdf);
        arena_free(&a);
    }
}

/* Rows of two levels, each of which fills a chunk, are not even. */
static void rows_of_two_levels(void) {
    enum { W = 2 * MCSI_ENV_CHUNK, H = 4 };
    int right = 0;
    float light[W * H];
    for (int i = 0; i < W * H; i++) light[i] = i % W < W / 2 ? 1.0f : 3.0f;
    arena a;
    mcs_env *e = map_of(&a, light, W, H);
    for (int i = 0; i < 1000; i++) right += mcs_env_sample(e, ((float)i + 0.5f) / 1000, 0.4f).col >= W / 2;
    CHECK(right >= 749 && right <= 751, "%d of 1000 in the brighter half, not 750", right);
    arena_free(&a);
}

/* Random bits on the very border of two texels belong to the second, half a unit before it to the first. */
static void borders_of_texels(void) {
    enum { W = 100, H = 12 };
    uint64_t seed = mcst_seed_for("env", "texels", 0);
    float light[W * H];
    for (uint32_t c = 0; c < W * H; c++) light[c] = mcst_mix(&seed) % 3 ? (float)(1 + mcst_mix(&seed) % 1000) : 0.0f;
    arena a;
    mcs_env *e = map_of(&a, light, W, H);
    const mcsi_window all = mcsi_env_whole(e);
    for (uint32_t r = 0; r < H; r++) {
        const uint32_t *cdf = mcsi_env_sums(e, r);
        for (uint32_t c = 0; c < W; c++) {
            if (cdf[c] == cdf[c + 1]) continue;
            mcs_texel t = mcs_env_sample_bits(e, 2 * cdf[c], all.rows.sums[r] + all.rows.sums[r + 1]);
            CHECK(t.col == c && t.row == r, "border %u of row %u: %u, %u", c, r, t.col, t.row);
            t = mcs_env_sample_bits(e, 2 * cdf[c + 1] - 1, 2 * all.rows.sums[r]);
            CHECK(t.col == c && t.row == r, "before border %u of row %u: %u, %u", c + 1, r, t.col, t.row);
        }
    }
    arena_free(&a);
}

/* Of a constant map arrays look the texels up: rows alone, columns alone, both. */
static void texels_of_even_maps(void) {
    enum { N = 50 };
    uint64_t seed = mcst_seed_for("env", "even", 0);
    float light[8 * 4];
    for (int i = 0; i < 8 * 4; i++) light[i] = 2;
    arena a;
    mcs_env *e = map_of(&a, light, 8, 4);
    float u1[N], u2[N];
    mcst_uniform(&seed, N, u1, u2);
    for (int form = 1; form < 4; form++) {
        uint32_t col[N];
        memset(col, 0xa5, sizeof col);
        uint32_t row[N];
        memset(row, 0xa5, sizeof row);
        mcs_env_sample_n(e, N, u1, u2, NULL, NULL, NULL, NULL, form & 1 ? col : NULL, form & 2 ? row : NULL);
        for (int i = 0; i < N; i++) {
            const mcs_texel t = mcs_env_sample(e, u1[i], u2[i]);
            CHECK((!(form & 1) || col[i] == t.col) && (!(form & 2) || row[i] == t.row),
                  "outputs %d: %u, %u, not %u, %u", form, col[i], row[i], t.col, t.row);
        }
    }
    arena_free(&a);
}

/* ---- product ---- */

/* The radiance about the mirror direction, in a map of a texel per tile, over what a product reflects in all. */
static ld mirrored_part(const mcs_product *p, const mcs_env *e, const float *light, const mcs_reflection *r) {
    const mcs_vec3 mirror = {-r->wo.x, -r->wo.y, r->wo.z};
    const mcs_texel x = mcs_env_texel(e, mcs_to_world(&r->frame, mirror));
    const float *row_weight = MCSI_READ(float, p, p->at.row_weight);
    ld total = 0;
    for (uint32_t i = 0; i < p->rows; i++) total += (ld)row_weight[i];
    return fminl((ld)light[x.row * e->w + x.col] / (ld)e->total / total, 1);
}

/* The lobe's share as the header has it: (1 - matte) sqrt(R/S) x/(1 + x), x/(1 + x) at most 0.95, where x = m + m^2 and
 * m + 0.007 is a fourteenth of the mean solid angle of a tile over 4 pi alpha_x alpha_y cos(theta_o), without the
 * cosine for Phong's lobe, three times as much without GGX's tails. Some ten roundings of m; the map's probabilities
 * are those of its light to 1e-6. */
static void share_of_the_lobe(void) {
    static const float alphas[][2] = {{1, 1},         {0.08f, 0.08f}, {0.03f, 0.03f},
                                      {0.02f, 0.01f}, {0.01f, 0.01f}, {1e-3f, 1e-3f}};
    static const float mattes[] = {0, 0.25f, 1};
    static const mcs_profile profiles[] = {MCS_PROFILE_GGX, MCS_PROFILE_GAUSS, MCS_PROFILE_PHONG, MCS_PROFILE_ASHIKHMIN,
                                           (mcs_profile)4};
    enum { PROFILES = (int)(sizeof profiles / sizeof *profiles) };
    float light[32 * 16];
    for (int i = 0; i < 32 * 16; i++) light[i] = (float)(1 + i % 5);
    const mcs_image image = mcs_image_make(light, 32, 16, 1);
    arena map = arena_make(mcs_env_bytes(32, 16));
    arena memory = arena_make(mcs_product_bytes(16));
    mcs_env *e = (mcs_env *)(void *)map.at;
    mcs_product *p = (mcs_product *)(void *)memory.at;
    CHECK(mcs_env_build(e, map.bytes, &image) == MCS_OK, "map");
    arena tiles = arena_make(mcs_tiles_bytes(e, 16));
    mcs_tiles *t = (mcs_tiles *)(void *)tiles.at;
    CHECK(mcs_tiles_build(t, tiles.bytes, e, 16) == MCS_OK, "tiles");
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < PROFILES; k++) {
                const mcs_vec3 up = {0, 0, 1};
                /* towards light of 3 and of 1: as much as is reflected in all, and less */
                const mcs_vec3 wo[] = {{0.6f, 0.01f, 0.8f}, {0.48f, 0.36f, 0.8f}};
                mcs_reflection r;
                memset(&r, 0, sizeof r);
                r.frame = mcs_frame_make(up);
                r.wo = wo[i % 2];
                r.alpha_x = alphas[i][0];
                r.alpha_y = alphas[i][1];
                r.matte = mattes[j];
                r.profile = profiles[k];
                CHECK(mcs_product_build(p, memory.bytes, t, e, &r, NULL) == MCS_OK, "product");
                const ld lobe = (ld)alphas[i][0] * (ld)alphas[i][1] * (profiles[k] == MCS_PROFILE_PHONG ? 1 : 0.8L);
                const ld m = (k % 4 ? 3 : 1) / (14 * 512.0L * lobe) - 0.007L;
                const ld of_width = m > 0 ? fminl((m + m * m) / (1 + m + m * m), 0.95L) : 0;
                const ld want = (1 - (ld)mattes[j]) * of_width * sqrtl(mirrored_part(p, e, light, &r));
                CHECK(fabsl((ld)p->brdf_share - want) <= 32 * EPS, "alphas %g %g, matte %g, profile %d: %g, not %Lg",
                      (double)alphas[i][0], (double)alphas[i][1], (double)mattes[j], k, (double)p->brdf_share, want);
            }
    arena_free(&map);
    arena_free(&tiles);
    arena_free(&memory);
}

/* However little a tile weighs beside another, in its row or in another one, it can be drawn, and where it weighs
 * nothing it cannot: not by u = 0 either. */
static void tiny_tiles(void) {
    enum { ROWS = 16, TILES = 2 * ROWS * ROWS };
    static float weight[TILES];
    arena memory = arena_make(mcs_product_bytes(ROWS));
    mcs_product *p = (mcs_product *)(void *)memory.at;
    float light[32 * 16];
    for (uint32_t k = 0; k < 32 * 16; k++) light[k] = (float)(1 + k % 5);
    arena map;
    mcs_env *e = map_of(&map, light, 32, 16);
    arena tiles = arena_make(mcs_tiles_bytes(e, ROWS));
    mcs_tiles *t = (mcs_tiles *)(void *)tiles.at;
    CHECK(mcs_tiles_build(t, tiles.bytes, e, ROWS) == MCS_OK, "tiles");
    memset(weight, 0, sizeof weight);
    weight[5 * ROWS + 7] = 1;
    weight[9 * ROWS + 7] = 1e-12f;
    weight[9 * ROWS + 3] = 1e-12f;
    CHECK(mcs_product_build_weights(p, memory.bytes, t, e, weight) == MCS_OK, "product");
    for (uint32_t k = 0; k < TILES; k++)
        CHECK((mcs_product_pdf(p, t, e, mcs_tiles_direction(t, e, k)) > 0) == (weight[k] > 0),
              "tile %u of weight %g: density %g", k, (double)weight[k],
              (double)mcs_product_pdf(p, t, e, mcs_tiles_direction(t, e, k)));
    for (uint32_t k = 0; k < 4; k++) {
        const mcs_texel x = mcs_product_sample(p, t, e, k & 1 ? 0.5f : 0, k & 2 ? 0.5f : 0);
        CHECK(x.pdf > 0 && relative(mcs_product_pdf(p, t, e, x.w), (ld)x.pdf) <= 1e-5L,
              "draw %u: density %g, of its direction %g", k, (double)x.pdf, (double)mcs_product_pdf(p, t, e, x.w));
    }
    arena_free(&map);
    arena_free(&tiles);
    arena_free(&memory);
}

/* A fine grid: 8 x 8 values column by column, bilinear between, then what its rows of nodes weigh by trapezoids over
 * the columns. Relative to its mean, from the sums: some 20 roundings of floats, most of them of the sums. */
static void fine_grids(void) {
    enum { M = MCSI_NODES };
    uint64_t seed = mcst_seed_for("product", "fine", 0);
    float v[MCSI_GRID + MCSI_NODES];
    for (int round = 0; round < 2000; round++) {
        double mean = 0;
        for (int k = 0; k < MCSI_GRID; k++) v[k] = (float)(1 + mcst_mix(&seed) % 1000);
        for (int i = 0; i < M; i++) {
            double sum = 0.5 * ((double)v[i] + (double)v[(M - 1) * M + i]);
            for (int j = 1; j < M - 1; j++) sum += (double)v[j * M + i];
            v[MCSI_GRID + i] = (float)sum;
            mean += (i == 0 || i == M - 1 ? 0.5 : 1) * sum / ((M - 1) * (M - 1));
        }
        float u[2];
        mcst_uniform(&seed, 1, &u[0], &u[1]);
        if (round % 3 == 0) u[0] = round % 2 ? 1.0f : 0.0f;
        if (round % 5 == 0) u[1] = round % 4 < 2 ? 1.0f : 0.0f;
        double x = (M - 1) * (double)u[0];
        double y = (M - 1) * (double)u[1];
        const int j = x < M - 2 ? (int)x : M - 2;
        const int i = y < M - 2 ? (int)y : M - 2;
        x -= j;
        y -= i;
        const ld want = (ld)((1 - x) * ((1 - y) * (double)v[j * M + i] + y * (double)v[j * M + i + 1]) +
                             x * ((1 - y) * (double)v[(j + 1) * M + i] + y * (double)v[(j + 1) * M + i + 1])) /
                        (ld)mean;
        const double got = (double)mcsi_grid_density(v, u[0], u[1]);
        /* values of up to 1000 times the least, differences of which are rounded; places to 7 * 2^-24 */
        CHECK(fabsl((ld)got - want) <= 20 * EPS * want + 40 * EPS * 1000 / (ld)mean, "at %g, %g: %g, not %Lg",
              (double)u[0], (double)u[1], got, want);
    }
}

static mcs_reflection glossy(float alpha) {
    const mcs_vec3 n = {0.6f, 0, 0.8f};
    const mcs_vec3 wo = {0.6f, 0, 0.8f};
    mcs_reflection r;
    memset(&r, 0, sizeof r);
    r.frame.s.x = 0.8f;
    r.frame.s.z = -0.6f;
    r.frame.t.y = 1;
    r.frame.n = n;
    r.wo = wo;
    r.alpha_x = r.alpha_y = alpha;
    r.matte = 0.25f;
    return r;
}

typedef struct {
    arena map, tiles, memory;
    mcs_env *e;
    mcs_tiles *t;
    mcs_product *p;
    mcs_reflection r;
} lit_surface;

static lit_surface surface_under(const float *light, uint32_t w, uint32_t h, float alpha) {
    lit_surface s;
    s.e = map_of(&s.map, light, w, h);
    s.tiles = arena_make(mcs_tiles_bytes(s.e, 16));
    s.t = (mcs_tiles *)(void *)s.tiles.at;
    s.memory = arena_make(mcs_product_bytes(16));
    s.p = (mcs_product *)(void *)s.memory.at;
    s.r = glossy(alpha);
    CHECK(mcs_tiles_build(s.t, s.tiles.bytes, s.e, 16) == MCS_OK, "tiles");
    CHECK(mcs_product_build(s.p, s.memory.bytes, s.t, s.e, &s.r, NULL) == MCS_OK, "product");
    s.p->brdf_share = 0;
    return s;
}

static void surface_free(lit_surface *s) {
    arena_free(&s->map);
    arena_free(&s->tiles);
    arena_free(&s->memory);
}

/* Even light and a surface that both stay the same when y changes sign: so does the density, by columns from both ends
 * of the map. Weights of tiles are integers over 2^24 of a row, of which there are 32; a place among the light is known
 * to 2^-21 of the map, 2^-16 of a tile, whose density changes by a few times itself at most: 1e-4. */
static void mirrored(float alpha) {
    enum { W = 64, H = 32 };
    uint64_t seed = mcst_seed_for("product", "mirror", alpha > 0.1f);
    float light[W * H];
    for (int i = 0; i < W * H; i++) light[i] = (float)(2 + i / W % 3);
    lit_surface s = surface_under(light, W, H, alpha);
    for (int i = 0; i < 5000; i++) {
        float u1, u2;
        mcst_uniform(&seed, 1, &u1, &u2);
        mcs_dir a, b;
        a = b = mcs_sphere_sample(u1, i % 4 ? u2 : u2 * 0.03f);
        b.w.y = -b.w.y;
        const double p = (double)mcs_product_pdf(s.p, s.t, s.e, a.w);
        const double q = (double)mcs_product_pdf(s.p, s.t, s.e, b.w);
        CHECK(fabs(p - q) <= 1e-4 * p, "(%g, %g, %g): %g, mirrored %g", (double)a.w.x, (double)a.w.y, (double)a.w.z, p,
              q);
    }
    surface_free(&s);
}

/* Rows without light within tiles that have some. */
static void black_rows(void) {
    enum { W = 64, H = 32 };
    uint64_t seed = mcst_seed_for("product", "black rows", 0);
    int lit = 0;
    float light[W * H];
    for (int i = 0; i < W * H; i++) light[i] = i / W % 2 ? 1.0f : 0.0f;
    lit_surface s = surface_under(light, W, H, 0.5f);
    for (int i = 0; i < 3000; i++) {
        float u1, u2;
        mcst_uniform(&seed, 1, &u1, &u2);
        const mcs_vec3 w = mcs_sphere_sample(u1, u2).w;
        const int black = mcs_env_texel(s.e, w).row % 2 == 0;
        const double p = (double)mcs_product_pdf(s.p, s.t, s.e, w);
        CHECK(black ? p == 0 : p >= 0, "(%g, %g, %g): %g", (double)w.x, (double)w.y, (double)w.z, p);
        lit += p > 0;
    }
    CHECK(lit > 500, "%d of 3000 directions", lit);
    surface_free(&s);
}

int main(int argc, char **argv) {
    static const uint32_t heights[] = {5, 64, 1000, 4099};
    mcst_start(argc, argv);
    mcst_group("values, rows of a map");
    for (size_t i = 0; i < MCST_COUNT(heights); i++)
        if (mcst_case("%u rows", heights[i])) rows_beside_borders(heights[i]);
    if (mcst_case("borders of rows")) borders_of_rows();
    mcst_group("values, texels of a map");
    if (mcst_case("one lit texel")) lone_texels();
    if (mcst_case("rows of two levels")) rows_of_two_levels();
    if (mcst_case("borders of texels")) borders_of_texels();
    if (mcst_case("even maps by arrays")) texels_of_even_maps();
    mcst_group("values, product");
    if (mcst_case("share of the lobe")) share_of_the_lobe();
    if (mcst_case("tiny tiles")) tiny_tiles();
    if (mcst_case("fine grids")) fine_grids();
    if (mcst_case("mirrored, alpha 0.5")) mirrored(0.5f);
    if (mcst_case("mirrored, alpha 0.1")) mirrored(0.1f);
    if (mcst_case("black rows")) black_rows();
    return mcst_finish();
}
