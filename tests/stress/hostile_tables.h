/* Tables of random sizes from hostile numbers. A part of hostile.c. */
#ifndef HOSTILE_TABLES_H
#define HOSTILE_TABLES_H
#include "hostile_tally.h"

enum { PWC, DISCRETE, PWL, ALIAS, FROM_FUNCTION, KINDS };
static const char *const kind_name[KINDS] = {"pwc", "discrete", "pwl", "alias", "pwc of a function"};

static size_t table_bytes(int kind, uint32_t n) {
    return kind == PWL ? mcs_pwl_bytes(n) : kind == ALIAS ? mcs_alias_bytes(n) : mcs_pwc_bytes(n);
}
static float next_of(float x, void *context) { /* a function whose values are the entries of a list, whatever x is */
    uint64_t *state = (uint64_t *)context;
    (void)x;
    return st_hostile(mcst_mix(state));
}
static mcs_status table_build(int kind, arena *m, size_t bytes, const float *f, uint32_t n, uint64_t *state) {
    void *at = m->at;
    if (kind == FROM_FUNCTION) return (mcs_status)mcs_pwc_build_fn((mcs_pwc *)at, bytes, f ? next_of : NULL, state, n);
    if (kind == PWL) return (mcs_status)mcs_pwl_build((mcs_pwl *)at, bytes, f, n);
    if (kind == ALIAS) return (mcs_status)mcs_alias_build((mcs_alias *)at, bytes, f, n);
    return (mcs_status)mcs_pwc_build((mcs_pwc *)at, bytes, f, n);
}

/* What a bad entry or channel is to the header: +infinity FLT_MAX, anything else 0. */
static float counted_as(float x) { return x > FLT_MAX ? FLT_MAX : x > 0 ? x : 0; }

/* Entries of one of six styles, zeros among them; how many of them are bad and the sum of all as they count come back.
 */
static void make_entries(float *f, uint32_t n, uint64_t *state, uint32_t *bad, long double *sum, uint32_t *some) {
    const uint64_t style = mcst_mix(state) % 6;
    const uint64_t giant = mcst_mix(state) % n;
    *bad = *some = 0;
    *sum = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint64_t z = mcst_mix(state);
        switch (style) {
        case 0: f[i] = st_hostile(z); break;
        case 1: f[i] = z & 7 ? (float)(z >> 40) : st_hostile(z >> 3); break;
        case 2: f[i] = 0; break;
        case 3: f[i] = i == giant ? 1e30f : 0; break;
        case 4: f[i] = st_float((uint32_t)(z >> 32) & 0x007fffffu); break;
        default: f[i] = z & 1 ? FLT_MAX : 0x1p-149f; break;
        }
        *bad += !(f[i] >= 0 && f[i] <= FLT_MAX);
        *sum += (long double)counted_as(f[i]);
        *some += f[i] > 0;
    }
}
static int lit(const float *f, uint32_t i) { return f[i] > 0; }

static void check_draws(int kind, const arena *m, const float *f, uint32_t n, int uniform, uint64_t *state, tally *t) {
    const mcs_pwc *pwc = (const mcs_pwc *)(const void *)m->at;
    const mcs_pwl *pwl = (const mcs_pwl *)(const void *)m->at;
    const mcs_alias *alias = (const mcs_alias *)(const void *)m->at;
    for (int k = 0; k < 400; k++) {
        const uint64_t z = mcst_mix(state);
        float u = z & 3 ? (float)(z >> 40) * 0x1p-24f : st_hostile(z >> 2);
        const int good = u >= 0 && u < 1;
        uint32_t i;
        float x, pdf, back;
        if (kind == DISCRETE || kind == ALIAS) {
            const mcs_pick c = kind == ALIAS ? mcs_alias_sample(alias, u) : mcs_discrete_sample(pwc, u);
            x = c.u;
            pdf = c.pmf;
            i = c.i;
            CHECK(proper(t, pdf) && pdf <= 1, "%u entries, u %a: pmf %a", (unsigned)n, (double)u, (double)pdf);
            CHECK(i < n, "%u entries, u %a: entry %u", (unsigned)n, (double)u, (unsigned)i);
            CHECK(!good || pdf == (kind == ALIAS ? mcs_alias_pmf(alias, i) : mcs_discrete_pmf(pwc, i)), "u %a: pmf %a",
                  (double)u, (double)pdf);
            back = x;
            (void)proper(t, kind == ALIAS ? mcs_alias_pmf(alias, (uint32_t)(z >> 16))
                                          : mcs_discrete_pmf(pwc, (uint32_t)(z >> 16)));
        } else {
            const mcs_cell c = kind == PWL ? mcs_pwl_sample(pwl, u) : mcs_pwc_sample(pwc, u);
            const float at = kind == PWL ? mcs_pwl_pdf(pwl, c.x) : mcs_pwc_pdf(pwc, c.x);
            x = c.x;
            pdf = c.pdf;
            i = c.i;
            CHECK(proper(t, pdf), "%u cells, u %a: pdf %a", (unsigned)n, (double)u, (double)pdf);
            CHECK(i < n && (double)x * n >= i && (double)x * n < (double)i + 1, "%u cells, u %a: x %a in cell %u",
                  (unsigned)n, (double)u, (double)x, (unsigned)i);
            CHECK(!good || kind == PWL || pdf == at, "u %a: pdf %a, %a at x", (double)u, (double)pdf, (double)at);
            u = z & 4 ? st_hostile(z >> 3) : x;
            back = kind == PWL ? mcs_pwl_invert(pwl, u) : mcs_pwc_invert(pwc, u);
            CHECK(proper(t, kind == PWL ? mcs_pwl_pdf(pwl, u) : mcs_pwc_pdf(pwc, u)), "pdf at %a", (double)u);
        }
        CHECK(below_one(t, x) && below_one(t, back), "%u cells: x or rest %a, invert %a", (unsigned)n, (double)x,
              (double)back);
        if (!good) CHECK(pdf == 0, "u %a is bad, but density %a", (double)u, (double)pdf);
        else if (f && !uniform)
            CHECK(kind == PWL ? lit(f, i) || lit(f, i + 1) : lit(f, i), "entry %u is zero, but drawn", (unsigned)i);
        if (good && kind != PWL) CHECK(pdf > 0, "u %a: density 0 at its own sample", (double)u);
    }
    t->evaluations += 400 * 3;
}

static void check_probabilities(int kind, const arena *m, const float *f, uint32_t n, int uniform, tally *t) {
    const mcs_pwc *table = (const mcs_pwc *)(const void *)m->at;
    const mcs_alias *alias = (const mcs_alias *)(const void *)m->at;
    double all = 0;
    for (uint32_t i = 0; i < n; i++) {
        const float q = kind == ALIAS ? mcs_alias_pmf(alias, i) : mcs_discrete_pmf(table, i);
        CHECK((q > 0) == (uniform || lit(f, i)), "entry %u of %u, weight %a: probability %a", (unsigned)i, (unsigned)n,
              (double)f[i], (double)q);
        all += (double)q;
    }
    t->evaluations += n;
    CHECK(fabs(all - 1) <= 0x1p-24, "probabilities add up to 1 + %g", all - 1); /* each rounded to 24 digits */
}

static void sample_array(int kind, const arena *m, size_t n, const float *u, float *x, float *pdf) {
    if (kind == PWL) mcs_pwl_sample_n((const mcs_pwl *)(const void *)m->at, n, u, x, pdf);
    else mcs_pwc_sample_n((const mcs_pwc *)(const void *)m->at, n, u, x, pdf);
}
/* Arrays with exactly n places; in place. */
static void check_array(int kind, const arena *m, uint64_t *state, tally *t) {
    const size_t count = mcst_mix(state) % 70;
    arena u = arena_make(count * sizeof(float));
    arena x = arena_make(u.bytes);
    arena pdf = arena_make(u.bytes);
    float *in = (float *)(void *)u.at;
    float *ox = (float *)(void *)x.at;
    float *op = (float *)(void *)pdf.at;
    for (uint32_t i = 0; i < count; i++)
        in[i] = i & 3 ? (float)(mcst_mix(state) >> 40) * 0x1p-24f : st_hostile(mcst_mix(state));
    sample_array(kind, m, count, in, ox, op);
    for (uint32_t i = 0; i < count; i++)
        CHECK(below_one(t, ox[i]) && proper(t, op[i]), "u %a: %a %a", (double)in[i], (double)ox[i], (double)op[i]);
    sample_array(kind, m, count, in, in, NULL);
    CHECK(!memcmp(u.at, x.at, u.bytes), "in place is different");
    CHECK(arena_intact(&u) && arena_intact(&x) && arena_intact(&pdf), "arrays of %u: written outside", (unsigned)count);
    t->evaluations += (double)count * 2;
    arena_free(&u);
    arena_free(&x);
    arena_free(&pdf);
}

static void check_table(int kind, uint32_t n, uint64_t *state, tally *t) {
    const uint32_t entries = n + (kind == PWL);
    const size_t bytes = table_bytes(kind, n);
    arena source = arena_make(entries * sizeof(float));
    arena copy = arena_make(source.bytes);
    arena m = arena_make(bytes);
    float *f = (float *)(void *)source.at;
    uint32_t bad, some;
    long double sum;
    make_entries(f, entries, state, &bad, &sum, &some);
    memcpy(copy.at, source.at, source.bytes);
    mcs_status e = table_build(kind, &m, bytes - 1, f, n, state);
    CHECK(e == MCS_ERR_MEMORY && untouched(m.at, bytes), "%u entries, a byte too few: %d", (unsigned)n, (int)e);
    e = table_build(kind, &m, bytes, NULL, n, state);
    CHECK(e == MCS_ERR_ARG && untouched(m.at, bytes), "no entries: %d", (int)e);
    e = table_build(kind, &m, bytes, f, 0, state);
    CHECK(e == MCS_ERR_SIZE && untouched(m.at, bytes), "0 entries: %d", (int)e);
    e = table_build(kind, &m, bytes, f, n, state);
    CHECK(arena_intact(&m) && arena_intact(&source) && !memcmp(copy.at, source.at, source.bytes),
          "%u entries: written outside", (unsigned)n);
    if (kind == FROM_FUNCTION) {
        CHECK(e == MCS_OK, "%u entries: status %d", (unsigned)n, (int)e);
        check_draws(PWC, &m, NULL, n, 1, state, t);
    } else {
        const mcs_pwc *head = (const mcs_pwc *)(const void *)m.at;
        const mcs_alias *alias = (const mcs_alias *)(const void *)m.at;
        const double total = kind == ALIAS ? alias->total : head->total;
        const uint32_t counted = kind == ALIAS ? alias->bad : head->bad;
        /* of vertices the sum over cells of the means; n additions round, each by 2^-53 of the sum */
        const long double ends = kind == PWL ? (long double)counted_as(f[0]) + (long double)counted_as(f[n]) : 0;
        const long double want = sum - 0.5L * ends;
        const int uniform = (kind == ALIAS ? alias->uniform : head->uniform) == 1;
        CHECK(e == MCS_OK && uniform == !some, "%u entries, %u not zero: status %d", (unsigned)n, (unsigned)some,
              (int)e);
        CHECK(counted == bad, "%u bad entries, counted %u", (unsigned)bad, (unsigned)counted);
        CHECK(fabsl((long double)total - want) <= (long double)n * 0x1p-53L * want, "total %g, sum %Lg", total, want);
        check_draws(kind, &m, f, n, uniform, state, t);
        if (kind == DISCRETE || kind == ALIAS) check_probabilities(kind, &m, f, n, uniform, t);
        else check_array(kind, &m, state, t);
    }
    CHECK(arena_intact(&m) && arena_intact(&source), "%u entries: written outside while drawing", (unsigned)n);
    arena_free(&source);
    arena_free(&copy);
    arena_free(&m);
}

static void test_tables(double scale) {
    const long tables = (long)fmax(20, 2000 * scale);
    mcst_group("tables");
    for (int kind = 0; kind < KINDS; kind++) {
        tally t = nothing;
        if (!mcst_case("%s", kind_name[kind])) continue;
        uint64_t state = mcst_seed_for("tables", kind_name[kind], 0);
        for (long k = 0; k < tables; k++) {
            const uint64_t z = mcst_mix(&state);
            check_table(kind, k < 40 ? (uint32_t)k + 1 : 1 + (uint32_t)(z >> 40) % (z % 50 ? 5000 : 200000), &state,
                        &t);
        }
        mcst_close_case();
        print_tally(kind_name[kind], &t);
    }
}
#endif
