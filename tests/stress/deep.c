/* Deep statistics: a thousand million samples of the array form of every row against the integral of its shipped
 * density, and the smallest error of a density that such a test sees.
 *
 * One case per row: chi-square over the bins of bins.h, Kolmogorov-Smirnov over the marginals of the bins and over the
 * random numbers that the inverse gives back. Then the same samples against densities that are off by 0.1, 0.3 and 1 %:
 * the width of the lobe (its alphas, exponents, rate, deviation), a tilt from the centre outwards, a tilt around the
 * azimuth. At full scale 0.3 % must be told from the right density here, and by at least 99 in 100 of such runs.
 * --filter 'ggx/' runs one row; MCS_TEST_SCALE scales the samples. */
#include "bins.h"

enum { CELLS_U = 65536, SHIFTS = 3, BACK_EVERY = 4 };
static const double samples_at_full_scale = 1e9, samples_of_make_test = 1e7;
static const double shifts[SHIFTS] = {0.001, 0.003, 0.01};

/* --- counting ----------------------------------------------------------------------------------------------------- */

static double observed[MCST_CELLS + 1], expected[MCST_CELLS + 1], back[2][CELLS_U], taken_back;

/* One line on stderr every ten seconds. */
static void progress(const char *name, double share) {
    static time_t last;
    const time_t now = time(NULL);
    if (!last) last = now;
    if (now - last < 10) return;
    last = now;
    fprintf(stderr, "    %s: %.0f %%\n", name, 100 * share);
}

/* Fills observed and, from one block in BACK_EVERY (the inverse is dearer than the sample), back; returns how many
 * samples were drawn, 0 when one was not finite or came back outside [0,1). */
static double draw(const mcst_row *row, const float *p, const mcst_map *map, double n, uint64_t seed) {
    static float buffer[7][MCST_BLOCK];
    float *const out[5] = {buffer[2], buffer[3], buffer[4], buffer[5], buffer[6]};
    const int lost_cell = map->s_bins * map->t_bins, brdf = row->shape == MCST_IS_BRDF;
    double done = 0;
    long block;
    int i;
    memset(buffer, 0, sizeof buffer);
    memset(observed, 0, sizeof observed);
    memset(back, 0, sizeof back);
    taken_back = 0;
    for (block = 0; done < n; block++) {
        mcst_uniform(&seed, MCST_BLOCK, buffer[0], buffer[1]);
        row->sample_n(p, MCST_BLOCK, buffer[0], buffer[1], out);
        for (i = 0; i < MCST_BLOCK; i++) {
            const float x[3] = {out[0][i], out[1][i], out[2][i]};
            const int lost = brdf && !(out[3][i] > 0);
            float u[2] = {0, 0};
            if (!(isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]) && isfinite(out[3][i]))) return 0;
            observed[lost ? lost_cell : mcst_cell(map, (double)x[0], (double)x[1], (double)x[2])] += 1;
            if (!row->fn[0].invert || block % BACK_EVERY) continue;
            row->fn[0].invert(p, x, u);
            if (!(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1)) return 0;
            back[0][(int)(u[0] * CELLS_U)] += 1;
            back[1][(int)(u[1] * CELLS_U)] += 1;
            taken_back += 1;
        }
        done += MCST_BLOCK;
        progress(row->name, done / n);
    }
    return done;
}

/* --- chi-square --------------------------------------------------------------------------------------------------- */

/* Cells to groups. The random numbers are multiples of 2^-24, so a ring of constant s, an interval of one of them, gets
 * a share that is up to 2^-24 off its mass m. That adds n 2^-48 / m to chi-square: rings are joined until it is below
 * 0.01. */
static int group_of[MCST_CELLS + 1];

static int make_groups(const mcst_map *map, const double *mass, double n, int brdf) {
    const double least = 100 * n * 0x1p-48;
    double pool = 0; /* the mass of the group that is still being joined; its number */
    int joined = 0, groups = 0, cells = map->s_bins * map->t_bins, i, j;
    for (i = 0; i < cells; i += map->t_bins) {
        double ring = 0;
        for (j = i; j < i + map->t_bins; j++) ring += mass[j];
        if (ring >= least) {
            for (j = i; j < i + map->t_bins; j++) group_of[j] = groups++;
            continue;
        }
        if (pool == 0) joined = groups++;
        for (j = i; j < i + map->t_bins; j++) group_of[j] = joined;
        pool += ring;
        if (pool >= least) pool = 0;
    }
    if (pool > 0) /* what is left over, at most one group, joins its neighbour */
        for (i = 0; i < cells; i++)
            if (group_of[i] == joined) group_of[i] = joined > 0 ? joined - 1 : joined + 1;
    if (brdf) group_of[cells] = groups++;
    return groups;
}

static void gather(const double *cells, int n, double *groups) {
    int i;
    memset(groups, 0, (MCST_CELLS + 1) * sizeof *groups);
    for (i = 0; i < n; i++) groups[group_of[i]] += cells[i];
}

/* P(X > x) for a chi-square distributed X with noncentrality lambda: Poisson(lambda / 2) mixes central ones of dof + 2
 * j. */
static double noncentral(double x, double dof, double lambda) {
    const double mean = 0.5 * lambda, reach = 12 * sqrt(mean) + 40;
    double sum = 0, j;
    for (j = floor(fmax(0, mean - reach)); j <= mean + reach; j++)
        sum += st_poisson(j, mean) * gamma_q(0.5 * dof + j, 0.5 * x);
    return sum;
}

/* The noncentrality that a test at `level` sees with probability 0.99. */
static double visible(double dof, double level) {
    double lo = dof, hi = 2 * dof + 1000, x;
    int i;
    for (i = 0; i < 60; i++) {
        x = 0.5 * (lo + hi);
        if (chi2_p(x, dof) > level) lo = x;
        else hi = x;
    }
    x = hi, lo = 0, hi = 4 * (x - dof) + 1000;
    for (i = 0; i < 40; i++) {
        const double lambda = 0.5 * (lo + hi);
        if (noncentral(x, dof, lambda) < 0.99) lo = lambda;
        else hi = lambda;
    }
    return hi;
}

/* --- wrong densities ---------------------------------------------------------------------------------------------- */

static const mcst_row *right;
static unsigned varied;
static float factor;

static void off_pdf(const float *p, const float *x, float *out) {
    float q[MCST_P];
    memcpy(q, p, sizeof q);
    if (varied & 1) q[0] *= factor;
    if (varied & 2) q[1] *= factor;
    right->fn[0].pdf(q, x, out);
}

enum kind { WIDTH_OFF, TILT_OUT, TILT_AROUND, KINDS };
static const char *const kind_name[KINDS] = {"width", "outwards", "around"};

/* The masses of the cells, and of what is lost, under a density that is eps off. The tilts are constant over a cell. */
static void wrong_masses(enum kind kind, const mcst_row *row, const float *p, const mcst_map *map, double eps,
                         const double *mass, double *wrong) {
    const int cells = map->s_bins * map->t_bins, all = cells + (row->shape == MCST_IS_BRDF);
    double sum = 0;
    int i;
    if (kind == WIDTH_OFF) {
        mcst_row off = *row;
        off.fn[0].pdf = off_pdf;
        factor = (float)(1 + eps);
        wrong[cells] = fmax(0, 1 - mcst_masses(&off, p, 1e-8, wrong));
        return;
    }
    for (i = 0; i < all; i++) {
        const double s = (i / map->t_bins + 0.5) / map->s_bins, t = (i % map->t_bins + 0.5) / map->t_bins;
        wrong[i] = mass[i] * (i == cells ? 1 : 1 + eps * (kind == TILT_OUT ? 2 * s - 1 : cos(2 * ST_PI * t)));
        sum += wrong[i];
    }
    for (i = 0; i < all; i++) wrong[i] /= sum;
}

/* --- one row ------------------------------------------------------------------------------------------------------ */

static double ks_back(const double *counts, double n) {
    /* The distance at the edges of 65536 cells. Inside of a cell it grows by about the standard deviation of its count,
     * 1/256 of 1/sqrt(n), which is left out. A number comes back within 64 2^-24 of itself (test_oracle.c: a few
     * roundings, and 8 ulp in each coordinate), so the share below an edge may be off by that, and by one more number
     * on the edge, without anything being wrong. */
    static double flat[CELLS_U];
    double sum = 0, d = 0;
    int i;
    for (i = 0; i < CELLS_U; i++) {
        flat[i] = n / CELLS_U;
        sum += counts[i] - flat[i];
        d = fmax(d, fabs(sum) / n);
    }
    return ks_p(fmax(0, d - 65 * 0x1p-24), n);
}

/* What was drawn: groups of cells, observed and expected. */
static struct {
    const mcst_row *row;
    float p[MCST_P];
    mcst_map map;
    double mass[MCST_CELLS + 1], o[MCST_CELLS + 1], e[MCST_CELLS + 1], done;
    int cells, brdf, groups, dof;
} drawn;

/* Fills expected; returns how many samples fell where the density is 0. Marginals: the p of Kolmogorov-Smirnov along s
 * and t. */
static double check_marginals(double level, double *p_s, double *p_t) {
    const mcst_map *map = &drawn.map;
    double so[MCST_LINE_BINS + 1] = {0}, se[MCST_LINE_BINS + 1] = {0}, to[MCST_T + 1] = {0}, te[MCST_T + 1] = {0},
                               stray = 0;
    int i;
    for (i = 0; i <= drawn.cells; i++) {
        const int t = i < drawn.cells ? i % map->t_bins : map->t_bins;
        expected[i] = i < drawn.cells || drawn.brdf ? drawn.mass[i] * drawn.done : 0;
        if (i < drawn.cells && drawn.mass[i] == 0) {
            stray += observed[i];
            observed[i] = 0;
        }
        so[i / map->t_bins] += observed[i];
        se[i / map->t_bins] += expected[i];
        to[t] += observed[i];
        te[t] += expected[i];
    }
    *p_s = mcst_ks_bins(so, se, (size_t)(map->s_bins + drawn.brdf), drawn.done);
    *p_t = map->t_bins > 1 ? mcst_ks_bins(to, te, (size_t)(map->t_bins + drawn.brdf), drawn.done) : 1;
    CHECK(*p_s >= level, "KS along s p = %g", *p_s);
    CHECK(*p_t >= level, "KS along t p = %g", *p_t);
    return stray;
}

/* The samples against the right density. */
static void check_right(double level) {
    const mcst_row *row = drawn.row;
    double p_chi2, p_s, p_t, p_u1 = 1, p_u2 = 1, p_stray;
    const double stray = check_marginals(level, &p_s, &p_t);
    /* As in mcst_fit_xy: what may fall into cells that the quadrature takes for dark. */
    p_stray = stray > 0 ? 1 - gamma_q(stray, (1e-8 * drawn.map.t_bins + drawn.map.noise) * drawn.done) : 1;
    if (row->fn[0].invert) {
        p_u1 = ks_back(back[0], taken_back);
        if (row->inputs == 2) p_u2 = ks_back(back[1], taken_back);
    }
    drawn.groups = make_groups(&drawn.map, drawn.mass, drawn.done, drawn.brdf);
    gather(observed, drawn.cells + drawn.brdf, drawn.o);
    gather(expected, drawn.cells + drawn.brdf, drawn.e);
    p_chi2 = chi2_test(drawn.o, drawn.e, (size_t)drawn.groups, NULL, &drawn.dof);
    printf("  %-14s %.3g samples, %d degrees of freedom; p: chi-square %.3g, stray %.3g, KS s %.3g t %.3g u1 %.3g u2 "
           "%.3g\n",
           row->name, drawn.done, drawn.dof, p_chi2, p_stray, p_s, p_t, p_u1, p_u2);
    CHECK(p_chi2 >= level, "chi-square p = %g", p_chi2);
    CHECK(p_stray >= level, "%g samples where the density is 0, p = %g", stray, p_stray);
    CHECK(p_u1 >= level, "KS of u1 p = %g", p_u1);
    CHECK(p_u2 >= level, "KS of u2 p = %g", p_u2);
}

/* The same samples against densities that are off; lambda99: the noncentrality that is seen 99 times in 100. */
static void check_wrong(enum kind kind, double level, double lambda99) {
    static double wrong[MCST_CELLS + 1], w[MCST_CELLS + 1];
    const int full = mcst_scale() >= 1;
    double value[SHIFTS], lambda = 0, eps99;
    int i, j;
    for (j = 0; j < SHIFTS; j++) {
        wrong_masses(kind, drawn.row, drawn.p, &drawn.map, shifts[j], drawn.mass, wrong);
        for (i = 0; i <= drawn.cells; i++) wrong[i] *= drawn.done;
        gather(wrong, drawn.cells + drawn.brdf, w);
        value[j] = chi2_test(drawn.o, w, (size_t)drawn.groups, NULL, NULL);
        for (lambda = i = 0; i < drawn.groups; i++)
            if (drawn.e[i] >= 5) lambda += (w[i] - drawn.e[i]) * (w[i] - drawn.e[i]) / drawn.e[i];
        if (full && shifts[j] >= 0.003)
            CHECK(value[j] < level, "%s off by %g: survived, p = %g", kind_name[kind], shifts[j], value[j]);
    }
    eps99 = shifts[SHIFTS - 1] * sqrt(lambda99 / lambda);
    if (full) CHECK(eps99 <= 0.003, "%s: seen 99 times in 100 only from %g on", kind_name[kind], eps99);
    printf("  %-14s %-9s p at 0.1 %%: %-9.3g 0.3 %%: %-9.3g 1 %%: %-9.3g seen 99 times in 100 from %.3f %% on, %.2f %% "
           "in make "
           "test\n",
           "", kind_name[kind], value[0], value[1], value[2], 100 * eps99,
           100 * eps99 * sqrt(drawn.done / samples_of_make_test));
}

static void check_row(const mcst_row *row, double n, double level) {
    const mcst_set *set = &row->chi[0];
    const clock_t began = clock();
    double lambda99;
    int kind;
    drawn.row = row;
    drawn.brdf = row->shape == MCST_IS_BRDF;
    mcst_fill(row, set->a, set->b, set->cos_o, set->azimuth, drawn.p);
    drawn.map = mcst_map_make(row, drawn.p);
    drawn.cells = drawn.map.s_bins * drawn.map.t_bins;
    drawn.done = draw(row, drawn.p, &drawn.map, n, mcst_seed_for(row->name, "deep", 0));
    CHECK(drawn.done > 0, "a sample is not finite, or comes back outside [0,1)");
    if (!(drawn.done > 0)) return;
    drawn.mass[drawn.cells] = fmax(0, 1 - mcst_masses(row, drawn.p, 1e-8, drawn.mass));
    check_right(level);
    right = row, varied = row->vary;
    lambda99 = visible(drawn.dof, level);
    for (kind = 0; kind < KINDS; kind++)
        if (kind == WIDTH_OFF ? row->vary != 0 : kind != TILT_AROUND || drawn.map.t_bins > 1)
            check_wrong((enum kind)kind, level, lambda99);
    printf("  %-14s %.1f s\n", "", (double)(clock() - began) / CLOCKS_PER_SEC);
    fflush(stdout);
}

int main(int argc, char **argv) {
    const double n = samples_at_full_scale * mcst_scale();
    double tests = 0, level;
    size_t i;
    for (i = 0; i < MCST_NROWS; i++) tests += mcst_fit_tests(&mcst_rows[i]);
    level = sidak(0.01, tests);
    mcst_start(argc, argv);
    for (i = 0; i < MCST_NROWS; i++) {
        mcst_group(mcst_rows[i].name);
        if (mcst_case("%g samples", n)) check_row(&mcst_rows[i], n, level);
    }
    return mcst_finish();
}
