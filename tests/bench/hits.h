/* For throughput.c: a wo and parameters per sample, as a wavefront renderer has them, by scalar calls, packets and the
 * array forms for hits; beside them the array form with one wo and one material for all. Parameters are uniform over a
 * range, so that neighbours differ. Writes hits.csv and prints a table. */
#ifndef BENCH_HITS_H
#define BENCH_HITS_H

enum { HITS_SCALAR, HITS_W4, HITS_W8, HITS_W16, HITS_ONE, HITS_N, HITS_PDF, HITS_BOTH, HITS_FORMS };
static const char *const hits_form_name[HITS_FORMS] = {"scalar", "w4", "w8", "w16", "n", "hits", "pdf", "pdf+f"};

/* A row, and the ranges of its parameters; b is 0 where there is no second one. */
static const struct {
    const char *row;
    float a[2], b[2];
} hits_of[] = {{"phong", {10, 200}, {0, 0}},
               {"ward_gmd", {0.05f, 0.6f}, {0.05f, 0.6f}},
               {"beckmann", {0.05f, 0.6f}, {0.05f, 0.6f}},
               {"ggx", {0.05f, 0.6f}, {0.05f, 0.6f}},
               {"ggx_vndf", {0.2f, 0.6f}, {0.2f, 0.6f}},
               {"ggx_bounded", {0.2f, 0.6f}, {0.2f, 0.6f}},
               {"ashikhmin", {10, 200}, {10, 200}}};
enum { HITS_ROWS = sizeof hits_of / sizeof *hits_of };
static double hits_ns[HITS_ROWS][HITS_FORMS][ROUNDS_MAX];
static bench_hits hits_in;

static void fill_hits(int k) {
    static float x[BENCH_N], y[BENCH_N];
    uint64_t state = 1;
    for (size_t i = 0; i < BENCH_N; i++) {
        mcst_uniform(&state, 1, &x[i], &y[i]);
        hits_in.a[i] = hits_of[k].a[0] + (hits_of[k].a[1] - hits_of[k].a[0]) * x[i];
        hits_in.b[i] = hits_of[k].b[0] + (hits_of[k].b[1] - hits_of[k].b[0]) * y[i];
    }
    mcst_uniform(&state, BENCH_N, x, y);
    mcs_cosine_sample_n(BENCH_N, x, y, hits_in.wo_x, hits_in.wo_y, hits_in.wo_z, NULL);
}

/* 0 where there is no such form. */
static int run_hits(int k, int form) {
    const mcst_row *const row = mcst_find(hits_of[k].row);
    const size_t at = (size_t)(row - mcst_rows);
    static bench_hits_form *const *const forms[] = {bench1_hits_forms, bench4_hits_forms, bench8_hits_forms,
                                                    bench16_hits_forms};
    static const int needs[] = {SCALAR, W4, W8, W16};
    const mcs_hits hits = {hits_in.wo_x, hits_in.wo_y, hits_in.wo_z, hits_in.a, row->params > 1 ? hits_in.b : NULL};
    const float p[MCST_P] = {hits_in.a[0], hits_in.b[0], 0, hits_in.wo_x[0], hits_in.wo_y[0], hits_in.wo_z[0]};
    static float x[BENCH_N], y[BENCH_N], z[BENCH_N]; /* given directions: hits of the other order */
    static const float *const numbers[3] = {u1, u2, NULL};
    static const float *const points[3] = {x, y, z};
    float *const out[BENCH_OUT] = {out_x, out_y, out_z, out_pdf, out_weight};
    float *const values[BENCH_OUT] = {out_pdf, form == HITS_BOTH ? out_weight : NULL, NULL, NULL, NULL};
    switch (form) {
    case HITS_ONE: row->sample_n(p, BENCH_N, u1, u2, out); break;
    case HITS_N: row->sample_hits_n(p, &hits, BENCH_N, numbers, out); break;
    case HITS_PDF:
    case HITS_BOTH:
        if (!(z[0] > 0)) mcs_cosine_sample_n(BENCH_N, u1, u2, x, y, z, NULL);
        row->pdf_hits_n(p, &hits, BENCH_N, points, values);
        break;
    default:
        if (!have[needs[form]]) return 0;
        forms[form][at](&hits_in, u1, u2, out);
    }
    return 1;
}
static void measure_hits(double slice) {
    static int passes[HITS_ROWS][HITS_FORMS];
    for (int r = -1; r < rounds; r++) { /* as measure_times does */
        bench_progress("hits: round %d of %d", r + 1, rounds);
        for (int k = 0; k < HITS_ROWS; k++) {
            fill_hits(k);
            for (int f = 0; f < HITS_FORMS; f++) {
                const int turns = r < 0 ? 2 : passes[k][f];
                if (turns == 0 || !run_hits(k, f)) continue;
                const double began = bench_seconds();
                for (int i = 0; i < turns; i++) run_hits(k, f);
                const double one = (bench_seconds() - began) / turns;
                bench_consume(BENCH_N, out_x);
                bench_consume(BENCH_N, out_pdf);
                bench_consume(BENCH_N, out_weight);
                if (r < 0) passes[k][f] = 1 + (int)(slice / one);
                else hits_ns[k][f][r] = one * 1e9 / BENCH_N;
            }
        }
    }
}

static void report_hits(void) {
    FILE *const csv = bench_csv("hits.csv", "sampler,form,ns_median,ns_min,ns_max");
    printf("\n%-18s a wo and parameters per sample, ns: samples with pdf and weight; pdf, pdf and f of directions\n",
           "");
    printf("%-18s", "sampler");
    for (int f = 0; f < HITS_FORMS; f++) printf(" %7s", hits_form_name[f]);
    printf(" %12s %8s\n", "scalar/hits", "w4/hits");
    for (int k = 0; k < HITS_ROWS; k++) {
        printf("%-18s", hits_of[k].row);
        for (int f = 0; f < HITS_FORMS; f++) {
            const bench_spread s = spread_of(hits_ns[k][f]);
            print_ns(s.median);
            if (s.median > 0)
                fprintf(csv, "%s,%s,%.4g,%.4g,%.4g\n", hits_of[k].row, hits_form_name[f], s.median, s.min, s.max);
        }
        printf(" %11.1fx %7.1fx\n", speedup(hits_ns[k], HITS_SCALAR, HITS_N), speedup(hits_ns[k], HITS_W4, HITS_N));
    }
    bench_close(csv, "hits.csv");
}
#endif
