/* Values of tables that no sampler test looks at closely: cells that only a guard keeps, ends, searches, shares that
 * hardly fit into a double. */
#include "values.h"

/* Beside 3e38 the halves of 1e-45 round to 0, yet no cell that has light may lose it. */
static void tiny_cells(void) {
    const float f[] = {3e38f, 0, 0x1p-149f, 0x1p-149f, 0, 0};
    arena a = arena_make(mcs_pwl_bytes(5));
    mcs_pwl *t = (mcs_pwl *)(void *)a.at;
    CHECK(mcs_pwl_build(t, a.bytes, f, 5) == MCS_OK, "build");
    for (int i = 0; i < 5; i++)
        CHECK((mcs_pwl_pdf(t, ((float)i + 0.5f) / 5) > 0) == (i < 4), "cell %d: density %g", i,
              (double)mcs_pwl_pdf(t, ((float)i + 0.5f) / 5));
    arena_free(&a);
}

/* Shares add up to 2^31 whatever the rounding of the sums: none is left for zeros behind the last entry. */
static void zeros_behind(void) {
    uint64_t seed = mcst_seed_for("pwc", "zeros", 0);
    arena a = arena_make(mcs_pwc_bytes(7));
    mcs_pwc *t = (mcs_pwc *)(void *)a.at;
    for (int i = 0; i < 20000; i++) {
        float f[7] = {0, 0, 0, 0, 0, 0, 0};
        double sum = 0;
        for (int k = 0; k < 4; k++) {
            float u, v;
            mcst_uniform(&seed, 1, &u, &v);
            f[k] = (float)pow(10, 6 * (double)u);
        }
        CHECK(mcs_pwc_build(t, a.bytes, f, 7) == MCS_OK, "build");
        for (int k = 0; k < 7; k++) sum += (double)mcs_discrete_pmf(t, (uint32_t)k);
        CHECK(mcs_discrete_pmf(t, 4) == 0 && mcs_discrete_pmf(t, 5) == 0 && mcs_discrete_pmf(t, 6) == 0,
              "%g %g %g %g: %g", (double)f[0], (double)f[1], (double)f[2], (double)f[3],
              (double)mcs_discrete_pmf(t, 6));
        CHECK(fabs(sum - 1) <= 4 * EPS, "%g %g %g %g: all together %g", (double)f[0], (double)f[1], (double)f[2],
              (double)f[3], sum);
    }
    arena_free(&a);
}

/* Beyond 2^53 shares do not fit a double: where sums no longer grow the last entries must still get theirs. Of 2^23 + 1
 * entries n 2^31 - n rounds up. */
static void alias_of_many(void) {
    const uint32_t n = (1u << 23) + 1;
    float *w = (float *)malloc(n * sizeof *w);
    arena a = arena_make(mcs_alias_bytes(n));
    mcs_alias *t = (mcs_alias *)(void *)a.at;
    int lost = 0;
    if (!w) exit(2);
    for (uint32_t i = 0; i < n; i++) w[i] = i ? 1e-30f : 1e30f;
    CHECK(mcs_alias_build(t, a.bytes, w, n) == MCS_OK, "build");
    for (uint32_t i = 0; i < n; i++) lost += !(mcs_alias_pmf(t, i) > 0);
    CHECK(lost == 0 && mcs_alias_pmf(t, n - 1) < 1e-6f, "%d of %u have no share; the last one has %g", lost, n,
          (double)mcs_alias_pmf(t, n - 1));
    free(w);
    arena_free(&a);
}

/* The last i with sums[i] <= U, for U on borders and between them: among some entries, and by a guide. Half of the steps
 * are small beside what an entry of the guide stands for, so that many entries share one. */
static void searches(void) {
    enum { N = 40, GUIDE = 2 * N };
    uint64_t seed = mcst_seed_for("cdf", "search", 0);
    for (int round = 0; round < 20000; round++) {
        const uint32_t n = 1 + (uint32_t)(mcst_mix(&seed) % N);
        uint32_t sums[N + 1];
        sums[0] = 0;
        for (uint32_t i = 1; i <= n; i++) {
            const uint32_t most = mcst_mix(&seed) % 2 ? 1000 : MCSI_ONE / N;
            sums[i] = sums[i - 1] + (uint32_t)(mcst_mix(&seed) % 4 ? mcst_mix(&seed) % most : 0);
        }
        if (mcst_mix(&seed) % 2) sums[n] = sums[n - 1] + 1; /* the last entry is small, too: those before it move up */
        for (uint32_t i = n, gap = MCSI_ONE - sums[n]; i > mcst_mix(&seed) % n; i--) sums[i] += gap;
        uint32_t guide[GUIDE + 1];
        const uint32_t shift = mcsi_guide_shift(n, 1);
        CHECK(mcsi_guide_length(shift) <= GUIDE + 1, "a guide of %u for %u", mcsi_guide_length(shift), n);
        mcsi_guide_build(guide, sizeof *guide, shift, sums, n);
        uint32_t U;
        do U = mcst_mix(&seed) % 2 ? sums[mcst_mix(&seed) % (n + 1)] : (uint32_t)(mcst_mix(&seed) % MCSI_ONE);
        while (U >= MCSI_ONE);
        uint32_t want;
        for (want = n; sums[want] > U;) want--;
        const uint32_t lo = (uint32_t)(mcst_mix(&seed) % (want + 1));
        const uint32_t hi = want + (uint32_t)(mcst_mix(&seed) % (n - want));
        const uint32_t i = mcsi_cdf_search(sums, lo, hi, U);
        CHECK(i == want, "%u in [%u, %u] of %u: %u, not %u", U, lo, hi, n, i, want);
        const mcsi_cdf c = {sums, guide, n, shift, sizeof *guide};
        const uint32_t found = mcsi_cdf_find(&c, U);
        CHECK(found == want, "%u by the guide of %u: %u, not %u", U, n, found, want);
    }
}

/* 0 and 1 belong to the first and the last cell, what lies outside to none. */
static void ends_of_tables(void) {
    const float f[] = {3, 1, 2, 5, 4, 7};
    arena a = arena_make(mcs_pwc_bytes(5));
    arena b = arena_make(mcs_pwl_bytes(5));
    mcs_pwc *c = (mcs_pwc *)(void *)a.at;
    mcs_pwl *l = (mcs_pwl *)(void *)b.at;
    const float top = 0.99999994f;
    CHECK(mcs_pwc_build(c, a.bytes, f, 5) == MCS_OK && mcs_pwl_build(l, b.bytes, f, 5) == MCS_OK, "build");
    CHECK(relative(mcs_pwc_pdf(c, 0), 1) <= EPS && relative(mcs_pwc_pdf(c, 1), 4 / 3.0L) <= EPS, "pwc: %g and %g",
          (double)mcs_pwc_pdf(c, 0), (double)mcs_pwc_pdf(c, 1));
    CHECK(relative(mcs_pwl_pdf(l, 0), 3 / 3.4L) <= EPS && relative(mcs_pwl_pdf(l, 1), 7 / 3.4L) <= EPS,
          "pwl: %g and %g", (double)mcs_pwl_pdf(l, 0), (double)mcs_pwl_pdf(l, 1));
    CHECK(mcs_pwc_pdf(c, -0.1f) == 0 && mcs_pwc_pdf(c, 1.1f) == 0 && mcs_pwl_pdf(l, -0.1f) == 0 &&
              mcs_pwl_pdf(l, 1.1f) == 0,
          "outside");
    CHECK(mcs_pwc_invert(c, -1) == 0 && mcs_pwc_invert(c, 0) == 0 && mcs_pwc_invert(c, 1) == top &&
              mcs_pwc_invert(c, 2) == top,
          "pwc: %g to %g", (double)mcs_pwc_invert(c, 0), (double)mcs_pwc_invert(c, 1));
    CHECK(mcs_pwl_invert(l, -1) == 0 && mcs_pwl_invert(l, 0) == 0 && mcs_pwl_invert(l, 1) == top &&
              mcs_pwl_invert(l, 2) == top,
          "pwl: %g to %g", (double)mcs_pwl_invert(l, 0), (double)mcs_pwl_invert(l, 1));
    CHECK(mcs_discrete_pmf(c, 5) == 0 && mcs_discrete_pmf(c, UINT32_MAX) == 0, "entries beyond the last: %g",
          (double)mcs_discrete_pmf(c, 5));
    arena_free(&a);
    arena_free(&b);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("values, others");
    if (mcst_case("piecewise linear cells of 1e-45 beside 3e38")) tiny_cells();
    if (mcst_case("searches of cumulative sums")) searches();
    if (mcst_case("ends of tables")) ends_of_tables();
    if (mcst_case("zeros behind the last entry")) zeros_behind();
    if (mcst_case("alias shares of 2^23 + 1 entries")) alias_of_many();
    return mcst_finish();
}
