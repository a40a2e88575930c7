/* Windows of the environment map: rectangles of texels that are drawn from alone. */
#include "env_modes.h"
#include "stats.h"

typedef struct {
    uint32_t row, rows, col, cols;
} rectangle;
static int inside(const picture *p, const rectangle *t, uint32_t col, uint32_t row) {
    return row >= t->row && row < t->row + t->rows && (col + p->w - t->col) % p->w < t->cols;
}

static const float corner[] = {0.0f, 1.4e-45f, 0x1p-32f, 0x1p-24f, 0.5f, 0x0.fffffep0f, 0x0.ffffffp0f};
enum { CORNERS = (int)(sizeof corner / sizeof *corner), BATCH = 1024 };

/* u1 and u2: corners with each other, then random ones. */
static void numbers(int i, mcs_pcg32 *rng, float *u1, float *u2) {
    *u1 = i < CORNERS * CORNERS ? corner[i % CORNERS] : mcs_pcg32_float(rng);
    *u2 = i < CORNERS * CORNERS ? corner[i / CORNERS] : mcs_pcg32_float(rng);
}

/* A window of a picture: its texels' light, solid angle, and by how much their integers may move it. */
typedef struct {
    const picture *p;
    const mcs_env *e;
    const mcs_env_window *m;
    rectangle t;
    ld all, omega, moved;
    int uniform;
    char what[120];
} windowed;

static windowed windowed_of(const picture *p, const mcs_env *e, const mcs_env_window *m, rectangle t) {
    windowed v;
    memset(&v, 0, sizeof v);
    v.p = p;
    v.e = e;
    v.m = m;
    v.t = t;
    snprintf(v.what, sizeof v.what, "%s, rows %u + %u, columns %u + %u", p->name, t.row, t.rows, t.col, t.cols);
    for (uint32_t r = 0; r < p->h; r++)
        for (uint32_t c = 0; c < p->w; c++) {
            const ld prob = p->prob[(size_t)r * p->w + c];
            if (!inside(p, &t, c, r)) continue;
            v.omega += solid_angle(r, p->w, p->h);
            v.all += prob;
            if (prob > 0) v.moved += prob * slack(p, c, r);
        }
    v.uniform = !(v.all > 0) || e->uniform;
    return v;
}

/* The density of every texel; expected: of so many draws. */
static void check_window_density(const windowed *v, int draws, double *expected) {
    const picture *p = v->p;
    const rectangle t = v->t;
    ld mass = 0;
    for (uint32_t r = 0; r < p->h; r++) {
        const ld each = solid_angle(r, p->w, p->h);
        ld in_row = 0;
        for (uint32_t c = 0; c < p->w; c++)
            in_row += inside(p, &t, c, r) && v->all > 0 ? p->prob[(size_t)r * p->w + c] / v->all : 0;
        for (uint32_t c = 0; c < p->w; c++) {
            const int in = inside(p, &t, c, r);
            const double found = (double)(mcs_env_window_pdf(v->m, v->e, point(p->w, p->h, c, r, 0.5, 0.5)) * each);
            const double want = (double)(!in          ? 0
                                         : v->uniform ? each / v->omega
                                                      : p->prob[(size_t)r * p->w + c] / v->all);
            double off = 4 * eps;
            /* the integers of the texel in the map, of the window's part of the map, of the row in the window; four
             * roundings */
            if (!v->uniform && want > 0)
                off += slack(p, c, r) + (double)(v->moved / v->all) + (2 / (double)in_row + t.rows) * quantum;
            mass += found;
            expected[(size_t)r * p->w + c] = want * draws;
            CHECK((found > 0) == (want > 0), "%s: texel (%u, %u): probability %g, not %g", v->what, c, r, found, want);
            if (want > 0)
                CHECK(fabs(found - want) <= want * off, "%s: texel (%u, %u): probability %g, not %g", v->what, c, r,
                      found, want);
        }
    }
    CHECK(fabsl(mass - 1) <= 2 * eps, "%s: the density integrates to 1 + %Lg", v->what, mass - 1);
}

/* A batch is drawn as one by one; so many are not. */
static int unequal_in_batch(const windowed *v, const float *u1, const float *u2) {
    static float out[4][BATCH];
    static uint32_t cols[BATCH], rows[BATCH];
    int unequal = 0;
    mcs_env_window_sample_n(v->m, v->e, BATCH, u1, u2, out[0], out[1], out[2], out[3], cols, rows);
    for (int k = 0; k < BATCH; k++) {
        const mcs_texel s = mcs_env_window_sample(v->m, v->e, u1[k], u2[k]);
        unequal += !(s.w.x == out[0][k] && s.w.y == out[1][k] && s.w.z == out[2][k] && s.pdf == out[3][k]);
        unequal += !(s.col == cols[k] && s.row == rows[k]);
    }
    return unequal;
}
static void check_window_draws(const windowed *v, int draws, double *observed) {
    static float u1[BATCH], u2[BATCH];
    const picture *p = v->p;
    const rectangle t = v->t;
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 151);
    int stray = 0;
    int unequal = 0;
    for (int i = 0; i < draws + CORNERS * CORNERS; i++) {
        const int at = i % BATCH;
        numbers(i, &rng, &u1[at], &u2[at]);
        const mcs_texel s = mcs_env_window_sample(v->m, v->e, u1[at], u2[at]);
        double col, row;
        texel_of(p->w, p->h, s.w, &col, &row);
        col = fmin(floor(col), p->w - 1.0);
        row = fmin(floor(row), p->h - 1.0);
        stray += !(inside(p, &t, s.col, s.row) && inside(p, &t, (uint32_t)col, (uint32_t)row));
        unequal += !(mcs_env_window_pdf(v->m, v->e, s.w) == s.pdf && s.pdf > 0);
        if (!v->uniform)
            CHECK(p->lum[(size_t)s.row * p->w + s.col] > 0, "%s: black texel (%u, %u)", v->what, s.col, s.row);
        if (i >= CORNERS * CORNERS) observed[(size_t)(uint32_t)row * p->w + (uint32_t)col]++;
        if (at == BATCH - 1) unequal += unequal_in_batch(v, u1, u2);
    }
    CHECK(stray == 0, "%s: %d draws outside", v->what, stray);
    CHECK(unequal == 0, "%s: %d draws whose density is another, alone or in a batch", v->what, unequal);
}

static void check_window_order(const windowed *v) {
    uint32_t last_row = 0;
    uint32_t last_col = 0;
    uint32_t falls = 0;
    for (int i = 0; i < 512; i++) {
        const mcs_texel down = mcs_env_window_sample(v->m, v->e, hash01((uint32_t)i), ((float)i + 0.5f) / 512);
        const mcs_texel along = mcs_env_window_sample(v->m, v->e, ((float)i + 0.5f) / 512, 0.4f);
        const uint32_t col = (along.col + v->p->w - v->t.col) % v->p->w;
        falls += down.row < last_row || col < last_col;
        last_row = down.row;
        last_col = col;
    }
    CHECK(falls == 0, "%s: rows fall with u2 or columns with u1 %u times", v->what, falls);
}

/* The table of a rectangle against the picture within it. `uniform`: the picture, or what the window shows of it, has
 * no shape. */
static void check_window(const picture *p, const mcs_env *e, rectangle t, int draws) {
    const size_t texels = (size_t)p->w * p->h;
    arena a = arena_make(mcs_env_window_bytes(t.rows));
    mcs_env_window *m = (mcs_env_window *)(void *)a.at;
    double *observed = (double *)get(texels * sizeof *observed);
    double *expected = (double *)get(texels * sizeof *expected);
    const windowed v = windowed_of(p, e, m, t);
    const mcs_status rc = mcs_env_window_build(m, a.bytes, e, t.row, t.rows, t.col, t.cols);
    CHECK(rc == MCS_OK && !m->uniform == (v.all > 0 && !e->uniform), "%s: returns %d, uniform %u", v.what, rc,
          m->uniform);
    CHECK(arena_intact(&a), "%s: written outside", v.what);
    check_window_density(&v, draws, expected);
    check_window_draws(&v, draws, observed);
    if (t.rows * t.cols > 1 && draws >= 1000) {
        int dof;
        const double prob = chi2_test(observed, expected, texels, NULL, &dof);
        CHECK(prob >= level || dof == 0, "%s: chi-square of %d degrees of freedom: p = %g", v.what, dof, prob);
    }
    check_window_order(&v);
    free(observed);
    free(expected);
    arena_free(&a);
}

enum { WINDOWS = 20, STEPPED = 14 }; /* from STEPPED on their widths are given */

/* Number i of a picture's windows: all of it; all of it, from elsewhere on; across the seam; single texels; in the first
 * and the last row; any; and as wide as columns are looked for by another number of steps. */
static rectangle window_of(const picture *p, int i, mcs_pcg32 *rng) {
    static const uint32_t steps[] = {16, 17, 32, 33, 64, 65};
    rectangle t = {0, p->h, 0, p->w};
    if (i > 1) {
        t.row = mcs_pcg32_next(rng) % p->h;
        t.rows = 1 + mcs_pcg32_next(rng) % (p->h - t.row);
    }
    if (i > 0) {
        t.col = mcs_pcg32_next(rng) % p->w;
        t.cols = 1 + mcs_pcg32_next(rng) % p->w;
    }
    if (i == 1) t.cols = p->w;
    if (i == 2) {
        t.col = p->w - 1;
        t.cols = p->w > 1 ? 2 : 1;
    }
    if (i == 3 || i == 4) t.rows = t.cols = 1;
    if (i == 5) {
        t.row = 0;
        t.rows = 1;
    }
    if (i == 6) {
        t.row = p->h - 1;
        t.rows = 1;
        t.cols = 1;
    }
    if (i >= STEPPED && p->w > steps[i - STEPPED]) {
        t.cols = steps[i - STEPPED];
        t.col = mcs_pcg32_next(rng) % (p->w - t.cols);
    }
    return t;
}
static void check_windows(picture p, brightness want) {
    arena a = build(&p, want);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 157);
    const int draws = scaled(20000);
    for (int i = 0; i < WINDOWS; i++) check_window(&p, env_in(&a), window_of(&p, i, &rng), draws);
    arena_free(&a);
    discard(&p);
}

/* Windows a texel wide or high in tall and wide maps, where a rounding of a direction is a part of it. */
static void check_narrow(picture p) {
    arena a = build(&p, LIT);
    const rectangle all[] = {{0, 1, 0, p.w},
                             {1, 1, 0, p.w},
                             {p.h / 3, 1, 0, 1},
                             {p.h / 2 - 1, 1, p.w / 2, 1},
                             {p.h / 2, 1, p.w - 1, 1},
                             {p.h / 2 - 1, 2, p.w - 1, p.w > 1 ? 2 : 1},
                             {p.h - p.h / 5, 1, 0, p.w},
                             {p.h - 1, 1, p.w / 3, 1}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i].row + all[i].rows <= p.h) check_window(&p, env_in(&a), all[i], scaled(20000));
    arena_free(&a);
    discard(&p);
}

static void test_windows(void) {
    check_windows(make("sky", 96, 48, v_sky), LIT);
    check_windows(make("region", 96, 48, v_region), LIT);
    check_windows(make("checkerboard", 31, 17, v_checker), LIT);
    check_windows(make("random", 5, 3, v_random), LIT);
    check_windows(make("random column", 1, 12, v_random), LIT);
    check_windows(make("random row", 12, 1, v_random), LIT);
}
static void test_uniform_windows(void) {
    check_windows(make("constant", 64, 32, v_constant), LIT);
    check_windows(make("constant, odd", 9, 7, v_constant), LIT);
    check_windows(make("black", 9, 6, v_black), BLACK);
}
static void test_narrow_windows(void) {
    check_narrow(make("tall", 4, 4096, v_random));
    check_narrow(make("wide", 8192, 2, v_random));
    check_narrow(make("tall, constant", 4, 4096, v_constant));
    check_narrow(make("tall, constant, odd", 3, 4095, v_constant));
    check_narrow(make("wide, constant", 8192, 2, v_constant));
    check_narrow(make("tall, region", 64, 2048, v_region));
}

static void test_refused_windows(void) {
    picture p = make("random", 20, 10, v_random);
    arena a = build(&p, LIT);
    arena b = arena_make(mcs_env_window_bytes(4) + 8);
    mcs_env_window *m = (mcs_env_window *)(void *)b.at;
    const size_t need = mcs_env_window_bytes(4);
    static const rectangle bad[] = {{0, 0, 0, 5},           {0, 4, 0, 0},           {7, 4, 0, 5},
                                    {10, 1, 0, 5},          {0, 11, 0, 5},          {0, 4, 20, 1},
                                    {0, 4, 0, 21},          {0xffffffffu, 4, 0, 5}, {1, 0xffffffffu, 0, 5},
                                    {0, 4, 0xffffffffu, 2}, {0, 4, 5, 0xffffffffu}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const rectangle *t = &bad[i];
        const mcs_status rc = mcs_env_window_build(m, need, env_in(&a), t->row, t->rows, t->col, t->cols);
        CHECK(rc == MCS_ERR_SIZE, "rows %u + %u, columns %u + %u: %d", t->row, t->rows, t->col, t->cols, rc);
    }
    for (size_t i = 0; i < need; i++)
        CHECK(mcs_env_window_build(m, i, env_in(&a), 3, 4, 18, 5) == MCS_ERR_MEMORY, "%zu of %zu bytes", i, need);
    CHECK(mcs_env_window_build(NULL, need, env_in(&a), 3, 4, 18, 5) == MCS_ERR_ARG, "no memory");
    CHECK(mcs_env_window_build(m, need, NULL, 3, 4, 18, 5) == MCS_ERR_ARG, "no map");
    CHECK(mcs_env_window_build((mcs_env_window *)(void *)(b.at + 2), need, env_in(&a), 3, 4, 18, 5) == MCS_ERR_ARG,
          "misaligned");
    CHECK(mcs_env_window_bytes(0) == 0 && mcs_env_window_bytes(65537) == 0 && mcs_env_window_bytes(0xffffffffu) == 0 &&
              mcs_env_window_bytes(65536) > 65536 * 4,
          "bytes");
    CHECK(untouched(b.at, b.bytes) && arena_intact(&b), "a refused build wrote");
    CHECK(mcs_env_window_build(m, need, env_in(&a), 3, 4, 18, 5) == MCS_OK, "a good one");
    arena_free(&a);
    arena_free(&b);
    discard(&p);
}

/* A window whose share of a row is a few units of 2^31, far from the row's beginning: begin + u mass must not round up
 * to its end. */
static void test_few_units(void) {
    const float px[3] = {1e30f, 1e-20f, 1};
    const mcs_image image = mcs_image_make(px, 3, 1, 1);
    arena a = arena_make(mcs_env_bytes(3, 1));
    arena b = arena_make(mcs_env_window_bytes(1));
    mcs_env *e = (mcs_env *)(void *)a.at;
    mcs_env_window *m = (mcs_env_window *)(void *)b.at;
    CHECK(mcs_env_build(e, a.bytes, &image) == MCS_OK && mcs_env_window_build(m, b.bytes, e, 0, 1, 1, 1) == MCS_OK,
          "build");
    for (int i = 1; i < 256; i++) {
        const float u = 1 - (float)i * 0x1p-24f;
        const mcs_texel s = mcs_env_window_sample(m, e, u, 0.5f);
        CHECK(s.col == 1 && s.pdf > 0 && mcs_env_window_pdf(m, e, s.w) == s.pdf, "u1 = %a: column %u, pdf %g, %g",
              (double)u, s.col, (double)s.pdf, (double)mcs_env_window_pdf(m, e, s.w));
    }
    arena_free(&a);
    arena_free(&b);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("env windows");
    if (mcst_case("random rectangles")) test_windows();
    if (mcst_case("constant and black maps")) test_uniform_windows();
    if (mcst_case("a texel wide or high")) test_narrow_windows();
    if (mcst_case("refused")) test_refused_windows();
    mcst_group("env windows of few units");
    if (mcst_case("the last u stays inside")) test_few_units();
    return mcst_finish();
}
