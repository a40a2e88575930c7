/* The chi-square programs: every set of every row that `mine` accepts, one case each. The rows are shared out over two
 * programs, so that two processors share the work; the level of a single p-value is that of the whole suite. */
#ifndef MCST_CHI2_ROWS_H
#define MCST_CHI2_ROWS_H
#include "bins.h"

/* One case a set. */
static inline void mcst_chi2_row(const mcst_row *row) {
    const double level = mcst_level();
    mcst_group(row->name);
    for (size_t j = 0; j < row->chi_size; j++) {
        const mcst_set *set = &row->chi[j];
        const double n = set->millions * 1e6 * mcst_scale();
        if (!mcst_case("chi-square %g %g cos %g, %g samples", (double)set->a, (double)set->b, (double)set->cos_o, n))
            continue;
        float p[MCST_P];
        mcst_fill(row, set->a, set->b, set->cos_o, set->azimuth, p);
        mcst_fit fit;
        mcst_fit_xy(row, p, n, mcst_seed_for(row->name, "chi2", j), &fit);
        mcst_fit_u(row, p, n / 20, mcst_seed_for(row->name, "u-space", j), &fit);
        CHECK(fit.chi2 >= level, "p = %g, mass %.8f", fit.chi2, fit.mass);
        CHECK(fit.stray >= level, "p = %g, mass %.8f", fit.stray, fit.mass);
        CHECK(fit.ks_s >= level, "p = %g, mass %.8f", fit.ks_s, fit.mass);
        CHECK(fit.ks_t >= level, "p = %g, mass %.8f", fit.ks_t, fit.mass);
        CHECK(fit.chi2_u >= level, "p = %g", fit.chi2_u);
        CHECK(fit.ks_u1 >= level, "p = %g", fit.ks_u1);
        CHECK(fit.ks_u2 >= level, "p = %g", fit.ks_u2);
        mcst_note("  %-14s %-60s mass %.7f  p: %.3f %.3f %.3f %.3f  u-space %.3f %.3f %.3f\n", row->name, mcst.name,
                  fit.mass, fit.chi2, fit.stray, fit.ks_s, fit.ks_t, fit.chi2_u, fit.ks_u1, fit.ks_u2);
    }
}

static inline int mcst_chi2_main(int argc, char **argv, int (*mine)(const mcst_row *row)) {
    mcst_start(argc, argv);
    for (size_t i = 0; i < MCST_NROWS; i++)
        if (mine(&mcst_rows[i])) mcst_chi2_row(&mcst_rows[i]);
    return mcst_finish();
}
#endif
