/* Tables by array, from functions and of any input: bad weights and numbers, memory of any size, at any place. */
#include "table_kinds.h"

/* ---- batch forms ---- */

static void test_batch(void) {
    enum { MAX = 67 };
    const size_t counts[] = {1000, 4099};
    static float u[4200], x[4200 + 8], pdf[4200 + 8];
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 31);
    load(&sets[CHECKER], 0);
    arena c = build(&kinds[PWC], sets[CHECKER].n, NULL);
    load(&sets[RAMP], 1);
    arena l = build(&kinds[PWL], sets[RAMP].n, NULL);
    for (size_t n = 0; n <= MAX + 2; n++) {
        const size_t count = n <= MAX ? n : counts[n - MAX - 1];
        for (size_t shift = 0; shift < 4; shift++) {
            mcs_pcg32_fill_n(&r, count + shift, u);
            for (int pass = 0; pass < 8; pass++) {
                const int linear = pass & 1;
                const int inplace = pass >> 1 == 3;
                float *px = pass >> 1 == 1 ? NULL : x + shift + 1;
                float *pp = pass >> 1 == 2 ? NULL : pdf + shift + 1;
                const float *in = inplace ? px : u + shift;
                int same = 1;
                for (size_t i = 0; i < count + 8; i++) x[i] = pdf[i] = -7.0f;
                if (inplace) memcpy(px, u + shift, count * sizeof *u);
                if (linear) mcs_pwl_sample_n((const mcs_pwl *)l.at, count, in, px, pp);
                else mcs_pwc_sample_n((const mcs_pwc *)c.at, count, in, px, pp);
                for (size_t i = 0; i < count; i++) {
                    const draw d = kinds[linear ? PWL : PWC].sample(linear ? l.at : c.at, u[shift + i]);
                    same &= (!px || px[i] == d.x) && (!pp || pp[i] == d.pdf);
                }
                const int kept = x[shift] == -7.0f && pdf[shift] == -7.0f && x[shift + count + 1] == -7.0f &&
                                 pdf[shift + count + 1] == -7.0f;
                CHECK(same, "n = %zu, shift %zu, pass %d: differs from scalar", count, shift, pass);
                CHECK(kept, "n = %zu, shift %zu, pass %d: written outside", count, shift, pass);
            }
        }
    }
    arena_free(&c);
    arena_free(&l);
}

/* Draws of every kind, of few cells and of so many that memory is fetched ahead, to arrays that may be missing. u may be
 * where the densities go. */
/* Where the results of draws go; any may be NULL. Of picks x is the rest. */
typedef struct {
    uint32_t *entry;
    float *x, *pdf;
} drawn;
static void sample_n(int which, const void *t, size_t n, const float *u, drawn d) {
    switch (which) {
    case PWC: mcs_pwc_sample_n((const mcs_pwc *)t, n, u, d.x, d.pdf); break;
    case PWL: mcs_pwl_sample_n((const mcs_pwl *)t, n, u, d.x, d.pdf); break;
    case DISCRETE: mcs_discrete_sample_n((const mcs_discrete *)t, n, u, d.entry, d.pdf, d.x); break;
    default: mcs_alias_sample_n((const mcs_alias *)t, n, u, d.entry, d.pdf, d.x);
    }
}
static void check_large(int which, const arena *a, mcs_pcg32 *r, size_t n) {
    enum { ROOM = 1000 };
    static float u[ROOM], x[ROOM + 1], pdf[ROOM + 1];
    static uint32_t entry[ROOM + 1];
    for (int missing = 0; missing < 8; missing++) {
        const int picks = which == DISCRETE || which == ALIAS;
        mcs_pcg32_fill_n(r, n, u);
        for (size_t k = 0; k <= n; k++) {
            x[k] = pdf[k] = k < n ? u[k] : -7.0f;
            entry[k] = 7;
        }
        const drawn to = {missing & 4 ? NULL : entry, missing & 2 ? NULL : x, missing & 1 ? NULL : pdf};
        sample_n(which, a->at, n, missing & 1 ? u : pdf, to);
        int same = x[n] == -7.0f && pdf[n] == -7.0f && entry[n] == 7;
        for (size_t k = 0; k < n; k++) {
            const draw d = kinds[which].sample(a->at, u[k]);
            same &= (missing & 1 || pdf[k] == d.pdf) && (missing & 2 || x[k] == (picks ? d.rest : d.x));
            same &= missing & 4 || !picks || entry[k] == d.i;
        }
        CHECK(same, "%s, n = %zu, without %d: differs from scalar", kinds[which].name, n, missing);
    }
}
static void test_large(void) {
    enum { CELLS = (1 << 17) + 3 };
    float *w = (float *)malloc((CELLS + 1) * sizeof *w);
    CHECK(w != NULL, "out of memory");
    if (!w) return;
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 32);
    mcs_pcg32_fill_n(&r, CELLS + 1, w);
    for (int which = 0; which < 4; which++) {
        const uint32_t cells[2] = {1000, CELLS};
        for (int large = 0; large < 2; large++) {
            arena a = arena_make(kinds[which].bytes(cells[large]));
            CHECK(kinds[which].build(a.at, a.bytes, w, cells[large]) == MCS_OK, "%s: not built", kinds[which].name);
            for (size_t n = 0; n < 70; n++) check_large(which, &a, &r, n);
            check_large(which, &a, &r, 1000);
            arena_free(&a);
        }
    }
    free(w);
}

/* ---- from a function ---- */

static float f_square(float x, void *ctx) { return *(float *)ctx * x * x; }
static float f_bump(float x, void *ctx) { return *(float *)ctx * expf(-50.0f * (x - 0.4f) * (x - 0.4f)); }
static float f_bad(float x, void *ctx) {
    (void)ctx;
    return x < 0.25f ? NAN : x < 0.5f ? -1.0f : x < 0.75f ? INFINITY : 2e38f;
}
static double exact_square(double x) { return x * x * x; }
static double exact_bump(double x) { return sqrt(3.14159265358979323846 / 50) / 2 * erf(sqrt(50) * (x - 0.4)); }

/* Gauss's rule with 4 points is off by 6e-10 h^9 max|f^(8)| a cell, at most 1e-26 here. What remains is rounding: of x,
 * one part in 2^24 of it, which moves f by x f'/f as much, and inside f: 3 eps, and for the bump 3 eps of its exponent
 * and one of expf. */
static void test_build_fn(void) {
    enum { N = 1000 };
    static const struct {
        float (*f)(float, void *);
        double (*integral)(double);
    } fn[2] = {{f_square, exact_square}, {f_bump, exact_bump}};
    for (int j = 0; j < 2; j++) {
        float scale = j ? 1.0f : 3.0f;
        arena a = arena_make(mcs_pwc_bytes(N));
        mcs_pwc *t = (mcs_pwc *)a.at;
        const int rc = mcs_pwc_build_fn(t, a.bytes, fn[j].f, &scale, N);
        const double whole = fn[j].integral(1) - fn[j].integral(0);
        CHECK(rc == MCS_OK && t->bad == 0 && arena_intact(&a), "build returns %d", rc);
        for (uint32_t i = 0; i < N; i++) {
            const double p = (fn[j].integral((i + 1.0) / N) - fn[j].integral((double)i / N)) / whole;
            const double got = mcs_discrete_pmf(t, i);
            const double x = (i + 0.5) / N;
            const double d = fabs(x - 0.4);
            const double roundings = j ? 6 + 100 * d * x + 150 * d * d : 6;
            CHECK(fabs(got - p) <= roundings * eps * p + (2 + N * p) * quantum, "function %d, cell %u: %g, not %g", j,
                  i, got, p);
        }
        arena_free(&a);
    }
    {
        arena a = arena_make(mcs_pwc_bytes(16));
        mcs_pwc *t = (mcs_pwc *)a.at;
        const int rc = mcs_pwc_build_fn(t, a.bytes, f_bad, NULL, 16);
        CHECK(rc == MCS_OK && t->bad == 12, "build returns %d, %llu bad", rc, pwc_bad(t));
        /* an infinite one weighs FLT_MAX; 8 cells have one integer each before the rest is shared */
        for (uint32_t i = 0; i < 16; i++) {
            const double w = i < 8 ? 0 : i < 12 ? (double)FLT_MAX : (double)2e38f;
            const double p = w / (4 * ((double)FLT_MAX + (double)2e38f));
            CHECK(fabs(mcs_discrete_pmf(t, i) - p) <= eps * p + (i < 8 ? 0 : 2 + 8 * p) * quantum,
                  "cell %u: %g, not %g", i, (double)mcs_discrete_pmf(t, i), p);
        }
        CHECK(mcs_pwc_build_fn(t, a.bytes, NULL, NULL, 16) == MCS_ERR_ARG, "no function");
        CHECK(mcs_pwc_build_fn(NULL, a.bytes, f_bad, NULL, 16) == MCS_ERR_ARG, "no memory");
        CHECK(mcs_pwc_build_fn(t, a.bytes - 1, f_bad, NULL, 16) == MCS_ERR_MEMORY, "too little memory");
        CHECK(arena_intact(&a), "written outside");
        arena_free(&a);
    }
}

/* Four points are exact up to degree 7. In float 8 x^7 is off by 7 eps from x and 6 from products, 1 more from the sum
 * and one from the mean: 15 eps = 9e-7 of a mean. A probability takes the share of the other cell, 1/4 or 3/4, of both
 * errors; where that is 3/4, 8 x^7 is below 1/16 and its own error 3 eps. */
static float f_seven(float x, void *ctx) {
    (void)ctx;
    return 1.0f + 8.0f * (x * x * x) * (x * x * x) * x;
}
static double exact_seven(double x) { return x + pow(x, 8); }
static void test_degree_seven(void) {
    for (uint32_t n = 1; n <= 2; n++) {
        arena a = arena_make(mcs_pwc_bytes(n));
        mcs_pwc *t = (mcs_pwc *)a.at;
        CHECK(mcs_pwc_build_fn(t, a.bytes, f_seven, NULL, n) == MCS_OK, "build");
        CHECK(fabs(t->total / n / 2 - 1) <= 1e-6, "%u cells: integral %.9g, not 2", n, t->total / n);
        for (uint32_t i = 0; i < n; i++) {
            const double p = (exact_seven((i + 1.0) / n) - exact_seven((double)i / n)) / 2;
            const double got = mcs_discrete_pmf(t, i);
            CHECK(fabs(got - p) <= 1e-6 * p, "%u cells, cell %u: %.9g, not %.9g", n, i, got, p);
        }
        arena_free(&a);
    }
}

/* ---- bad input, memory, relocation ---- */

static void test_errors(const kind *k) {
    const uint32_t n = 100;
    const uint32_t many[] = {0xffffffffu, 0xfffffffeu, 0x80000000u, 0x7fffffffu, 0x10000000u, 0x0fffffffu};
    arena a = arena_make(k->bytes(n) + 8);
    load(&sets[RAMP], 1);
    CHECK(k->build(NULL, a.bytes, weight, n) == MCS_ERR_ARG, "no memory");
    CHECK(k->build(a.at, a.bytes, NULL, n) == MCS_ERR_ARG, "no weights");
    CHECK(k->build(a.at, a.bytes, weight, 0) == MCS_ERR_SIZE, "n = 0");
    CHECK(k->build(a.at + 1, a.bytes - 8, weight, n) == MCS_ERR_ARG, "memory off by 1");
    CHECK(k->build(a.at + 4, a.bytes - 8, weight, n) == MCS_ERR_ARG, "memory off by 4");
    for (size_t i = 0; i < k->bytes(n); i += i < 80 || i + 9 > k->bytes(n) ? 1 : 7) {
        const int rc = k->build(a.at, i, weight, n);
        CHECK(rc == MCS_ERR_MEMORY, "%zu of %zu bytes: %d", i, k->bytes(n), rc);
    }
    for (size_t i = 0; i < sizeof many / sizeof *many; i++) {
        const size_t bytes = k->bytes(many[i]);
        const int rc = k->build(a.at, a.bytes, weight, many[i]);
        CHECK(rc == MCS_ERR_SIZE || rc == MCS_ERR_MEMORY, "n = %u: %d", many[i], rc);
        CHECK(bytes == 0 || bytes / 4 >= many[i], "n = %u: %zu bytes", many[i], bytes);
    }
    CHECK(k->build(a.at, SIZE_MAX, weight, 0xffffffffu) == MCS_ERR_SIZE, "n = 2^32 - 1 is refused whatever the memory");
    CHECK(k->bytes(0) == 0, "bytes(0) = %zu", k->bytes(0));
    CHECK(untouched(a.at, a.bytes) && arena_intact(&a), "a refused build wrote");
    arena_free(&a);
}

static double even_density(const kind *k, uint32_t n) {
    return k == &kinds[DISCRETE] || k == &kinds[ALIAS] ? 1.0 / n : 1.0;
}

/* Entries that are no weights count as 0, with `suns` infinite ones as the largest float; `b`: room for a table without
 * them. */
static void check_cleaned(const kind *k, uint32_t n, int suns, const arena *a, const arena *b) {
    static const float nothing[5] = {NAN, -1, -INFINITY, -FLT_MAX, -FLT_MIN};
    static float clean[41];
    uint32_t bad = 0;
    for (uint32_t i = 0; i < n + k->extra; i++) {
        weight[i] = clean[i] = hash01(i + 100);
        if (i % 4 == 1) {
            weight[i] = nothing[i / 4 % 5];
            clean[i] = 0;
            bad++;
        }
        if (suns && i % 8 == 2) {
            weight[i] = INFINITY;
            clean[i] = FLT_MAX;
            bad++;
        }
    }
    int rc = k->build(a->at, a->bytes, weight, n);
    CHECK(rc == MCS_OK && k->bad(a->at) == bad, "build returns %d, %llu bad, not %u", rc, k->bad(a->at), bad);
    rc = k->build(b->at, b->bytes, clean, n);
    CHECK(rc == MCS_OK && k->bad(b->at) == 0 && k->total(a->at) == k->total(b->at) &&
              k->total(a->at) <= n * (double)FLT_MAX,
          "build returns %d, %llu bad, total %g", rc, k->bad(b->at), k->total(a->at));
    for (int j = 0; j < US; j += 7) {
        const draw c = k->sample(a->at, us[j]);
        const draw d = k->sample(b->at, us[j]);
        CHECK(c.i == d.i && c.x == d.x && c.pdf == d.pdf && c.rest == d.rest, "u = %a: not as with clean entries",
              (double)us[j]);
    }
}
static void check_all_infinite(const kind *k, uint32_t n, const arena *a) {
    for (uint32_t i = 0; i < n + k->extra; i++) weight[i] = INFINITY;
    const int rc = k->build(a->at, a->bytes, weight, n);
    CHECK(rc == MCS_OK && !k->uniform(a->at) && k->bad(a->at) == n + k->extra &&
              fabs(k->total(a->at) / (n * (double)FLT_MAX) - 1) <= 1e-12,
          "all infinite: build returns %d, %llu bad, total %g", rc, k->bad(a->at), k->total(a->at));
    for (uint32_t i = 0; i < 1 << 12; i++) {
        const draw d = k->sample(a->at, (float)i * 0x1p-12f);
        const double want = even_density(k, n);
        CHECK(fabs(d.pdf - want) <= (2 * eps + 2 * n * quantum) * want, "all infinite: u = %u/2^12: density %g", i,
              (double)d.pdf);
    }
}
static void check_all_zero(const kind *k, uint32_t n, int j, const arena *a) {
    const float fill[3] = {0, -0.0f, NAN};
    for (uint32_t i = 0; i < n + k->extra; i++) weight[i] = fill[j];
    const int rc = k->build(a->at, a->bytes, weight, n);
    CHECK(rc == MCS_OK && k->uniform(a->at) && arena_intact(a), "all %g: build returns %d", (double)fill[j], rc);
    CHECK(k->bad(a->at) == (j == 2 ? n + k->extra : 0) && k->total(a->at) == 0, "all %g: %llu bad, total %g",
          (double)fill[j], k->bad(a->at), k->total(a->at));
    for (uint32_t i = 0; i < n; i++) hits[i] = 0;
    for (uint32_t i = 0; i < 1 << 16; i++) {
        const draw d = k->sample(a->at, (float)i * 0x1p-16f);
        const double want = even_density(k, n);
        CHECK(fabs(d.pdf - want) <= 2 * eps * want + n * quantum && d.i < n, "u = %u/2^16: entry %u, density %g", i,
              d.i, (double)d.pdf);
        if (d.i < n) hits[d.i]++;
    }
    for (uint32_t i = 0; i < n; i++) CHECK(fabs(hits[i] - 65536.0 / n) <= 2, "entry %u: %u draws of 65536", i, hits[i]);
}

/* Bad entries are 0, but +infinity is FLT_MAX: the table is that of such a list. */
static void test_bad_weights(const kind *k) {
    const uint32_t n = 40;
    arena a = arena_make(k->bytes(n));
    arena b = arena_make(k->bytes(n));
    for (int suns = 0; suns < 2; suns++) check_cleaned(k, n, suns, &a, &b);
    check_all_infinite(k, n, &a);
    for (int j = 0; j < 3; j++) check_all_zero(k, n, j, &a);
    arena_free(&a);
    arena_free(&b);
}

static void test_bad_u(const kind *k) {
    const float u[] = {1.0f, -1e-45f, -0.5f, 1.5f, 1e30f, FLT_MAX, INFINITY, -INFINITY, NAN};
    load(&sets[SEVEN], k->extra);
    arena a = build(k, 7, NULL);
    for (size_t i = 0; i < sizeof u / sizeof *u; i++) {
        const draw d = k->sample(a.at, u[i]);
        CHECK(d.pdf == 0 && d.i < 7 && d.x >= 0 && d.x <= 1 && d.rest >= 0 && d.rest < 1,
              "u = %g: entry %u, x = %g, density %g, rest %g", (double)u[i], d.i, (double)d.x, (double)d.pdf,
              (double)d.rest);
        if (k == &kinds[PWC] && u[i] != 1.0f) {
            const float p = mcs_pwc_pdf((const mcs_pwc *)a.at, u[i]);
            const float v = mcs_pwc_invert((const mcs_pwc *)a.at, u[i]);
            CHECK(p == 0 && v >= 0 && v < 1, "x = %g: pdf %g, invert %g", (double)u[i], (double)p, (double)v);
        }
        if (k == &kinds[PWL] && u[i] != 1.0f) {
            const float p = mcs_pwl_pdf((const mcs_pwl *)a.at, u[i]);
            const float v = mcs_pwl_invert((const mcs_pwl *)a.at, u[i]);
            CHECK(p == 0 && v >= 0 && v < 1, "x = %g: pdf %g, invert %g", (double)u[i], (double)p, (double)v);
        }
    }
    arena_free(&a);
}

static void test_relocation(const kind *k) {
    static draw before[US];
    load(&sets[PEAK], k->extra);
    arena a = build(k, sets[PEAK].n, NULL);
    for (int j = 0; j < US; j++) before[j] = k->sample(a.at, us[j]);
    arena b = arena_make(a.bytes);
    memcpy(b.at, a.at, a.bytes);
    memset(a.at, 0xff, a.bytes);
    for (int j = 0; j < US; j++) {
        const draw c = before[j];
        const draw d = k->sample(b.at, us[j]);
        CHECK(c.i == d.i && c.x == d.x && c.pdf == d.pdf && c.rest == d.rest, "u = %a: the copy differs",
              (double)us[j]);
    }
    arena_free(&a);
    arena_free(&b);
}

/* The same bytes whatever the memory held, for every number of entries up to 70 and some others, dark lists among them.
 */
static void test_same_bytes(const kind *k) {
    const uint32_t many[] = {127, 128, 129, 1000, 4095, 4096, 4097, 65537};
    for (uint32_t c = 0; c < 70 + sizeof many / sizeof *many; c++) {
        const uint32_t n = c < 70 ? c + 1 : many[c - 70];
        for (int style = 0; style < 3; style++) {
            for (uint32_t i = 0; i < n + k->extra; i++)
                weight[i] = style == 0 ? hash01(i) : style == 1 && i % 3 == 0 ? 1e30f : 0;
            if (style == 1) weight[n / 2] = NAN;
            arena a[ARENA_PASTS];
            for (int past = 0; past < ARENA_PASTS; past++) {
                a[past] = arena_make(k->bytes(n));
                arena_past(&a[past], past);
                const int rc = k->build(a[past].at, a[past].bytes, weight, n);
                CHECK(rc >= 0 && arena_intact(&a[past]), "n = %u: build returns %d", n, rc);
                CHECK(arena_differ(&a[0], &a[past]) == a[0].bytes, "n = %u, list %d: byte %zu of %zu is another one", n,
                      style, arena_differ(&a[0], &a[past]), a[0].bytes);
            }
            for (int past = 0; past < ARENA_PASTS; past++) arena_free(&a[past]);
        }
    }
}
static int from_curve(void *t, size_t bytes, const float *w, uint32_t n) {
    float scale = 2 + w[0];
    return mcs_pwc_build_fn((mcs_pwc *)t, bytes, f_square, &scale, n);
}
static const kind curve = {
    "pwc from a function", 0, pwc_bytes, from_curve, pwc_sample, pwc_total, pwc_bad, pwc_uniform};
int main(int argc, char **argv) {
    mcst_start(argc, argv);
    make_us();
    mcst_group("table batches");
    if (mcst_case("n = 0..67, 1000, 4099, shifted, in place, NULL outputs")) test_batch();
    if (mcst_case("tables of 1000 and of 131075 cells, of every kind")) test_large();
    mcst_group("pwc from a function");
    if (mcst_case("against exact integrals; bad values; errors")) test_build_fn();
    if (mcst_case("exact for degree 7")) test_degree_seven();
    mcst_group("table memory and bad input");
    for (int k = 0; k < 4; k++) {
        if (k != DISCRETE && mcst_case("%s: refused builds", kinds[k].name)) test_errors(&kinds[k]);
        if (mcst_case("%s: bad and zero weights", kinds[k].name)) test_bad_weights(&kinds[k]);
        if (mcst_case("%s: u outside [0,1)", kinds[k].name)) test_bad_u(&kinds[k]);
        if (mcst_case("%s: moved by memcpy", kinds[k].name)) test_relocation(&kinds[k]);
        if (k != DISCRETE && mcst_case("%s: the same bytes in any memory", kinds[k].name)) test_same_bytes(&kinds[k]);
    }
    if (mcst_case("%s: the same bytes in any memory", curve.name)) test_same_bytes(&curve);
    return mcst_finish();
}
