/* The maps of one dimension over all of the 2^24 numbers that mcs_u01 gives: the estimator that they make at the ends
 * of unbounded densities, and that they never fall. */
#define MCST_WIDE
#define MCST_LIST MCST_LINES /* alone: the others cost compile time */
#include "registry.h"

enum { CELLS = 1 << 24, BLOCK = 1 << 12, PACKET_16 = 3, ARRAY, FORMS };
static const char *const form_name[FORMS] = {"scalar", "4 wide", "8 wide", "16 wide", "array"};

/* x and pdf of k 2^-24 for a block of k from `first` on, by one of the forms. */
static void draw_block(const mcst_row *row, const float *p, int form, int first, float *x, float *pdf) {
    static float u[BLOCK];
    const int lanes = form < ARRAY ? (form ? 2 << form : 1) : 0;
    float set[MCST_P * 16], out[5 * 16];
    int i, k;
    for (i = 0; i < BLOCK; i++) u[i] = (float)(first + i) * 0x1p-24f;
    if (!lanes) {
        float *const arrays[5] = {x, NULL, NULL, pdf, NULL};
        row->sample_n(p, BLOCK, u, u, arrays);
        return;
    }
    for (k = 0; k < MCST_P * lanes; k++) set[k] = p[k / lanes];
    for (i = 0; i < BLOCK; i += lanes) {
        row->fn[form].sample(set, u + i, u + i, out);
        memcpy(x + i, out, (size_t)lanes * sizeof *x);
        memcpy(pdf + i, out + 3 * lanes, (size_t)lanes * sizeof *pdf);
    }
}

/* The integral of f(x) = e^(-|x| / width), estimated with every u = k h, h = 2^-24, once, is a sum of rectangles h F(u)
 * with F(u) = f(x(u)) / pdf(u). F falls on [0,1/4] at least and rises on its mirror image. So k = 0 counts h F(h/2);
 * those of k = 1 ... n - 1 lie between I, the integral of f from x(h) to x(n h), and I + h F(h); and those of k = 1 ...
 * 2^24 - 1 between I, from x(h) to x(1 - h), and I + 2 h F(h). Near the middle F turns back by less than 4, which moves
 * the sum by less than 8 h. x is within 7 ulp of |x| < 17.4 and pdf within 0.45 E of a density above 2e-8 of the peak,
 * which moves F by 7 * 17.4 * 2^-23 + 0.45e-6 * 18.8 < 2.4e-5 of itself. The array form sums all k, the others the
 * first block. */
static void check_zero(const char *name, double width) {
    const mcst_row *row = mcst_find(name);
    const double h = 0x1p-24, rounding = 2.4e-5, turn = 8 * h;
    const ld places[3] = {0x1p-25L, 0x1p-24L, BLOCK * 0x1p-24L};
    double f[3], F[3];
    float p[MCST_P];
    int form, i;
    mcst_fill(row, 0, 1, 1, 0, p);
    for (i = 0; i < 3; i++) {
        ld x[3];
        row->truth.map(p, places[i], 0, x);
        f[i] = exp(-fabs((double)x[0]) / width), F[i] = f[i] / (double)row->truth.pdf_u(p, places[i], 0);
    }
    for (form = 0; form < FORMS; form++) {
        static float x[BLOCK], pdf[BLOCK];
        const int all = form == ARRAY;
        const double least = h * F[0] + (all ? 2 * width * (1 - f[1]) : width * (f[2] - f[1]));
        const double most = least + (all ? 2 : 1) * h * F[1];
        double sum = 0, largest = 0;
        int k;
        if (!mcst_case("%s: integral of e^-|x/%g|, %s", name, width, form_name[form])) continue;
        for (k = 0; k < (all ? CELLS : BLOCK); k += BLOCK) {
            draw_block(row, p, form, k, x, pdf);
            for (i = 0; i < BLOCK; i++) {
                const double part = h * exp(-fabs((double)x[i]) / width) / (double)pdf[i];
                sum += part;
                largest = fmax(largest, part);
            }
        }
        CHECK(sum >= least * (1 - rounding) - turn, "%.9g, not within %.9g ... %.9g", sum, least, most);
        CHECK(sum <= most * (1 + rounding) + turn, "%.9g, not within %.9g ... %.9g", sum, least, most);
        CHECK(largest <= h * F[0] * (1 + rounding), "one sample gives %g of it, not %g", largest, h * F[0]);
    }
}

/* Parameters beside those of the grid, spread evenly over logarithms. */
enum { DRAWN = 12 };
static float between(uint64_t *state, double lo, double hi) {
    return (float)(lo * pow(hi / lo, (double)(mcst_mix(state) >> 40) * 0x1p-24));
}
static void draw_set(const mcst_row *row, uint64_t *state, float p[MCST_P]) {
    const double lo[MCST_SLOPES] = {1e-5, 1e-18, 1e-18, 1e-3, 1e-3, 1e-3, 1e-3, 1e-30, 1e-3};
    const double hi[MCST_SLOPES] = {1, 1e18, 1e18, 1e3, 1e3, 1e9, 1e9, 9e-4, 40};
    const int own = row->coord >= MCST_SLOPES; /* a line beyond the list has its domain */
    const float a =
        between(state, own ? row->domain.least[0] : lo[row->coord], own ? row->domain.most[0] : hi[row->coord]);
    const float b = between(state, 1e-3, 1e3);
    const float from = mcst_mix(state) & 1 ? a : -a;
    if (row->coord == MCST_CUT) mcst_fill(row, from, from + b, 1, 0, p);
    else mcst_fill(row, a, b, 1, 0, p);
}

/* No x below that of the u before, by the array form, whose bits the others share. Parameters of `linear` that are of a
 * size are the hard case: its closed form in float falls at up to 1e6 of the 2^24 steps. The arrays of truncated bells
 * are drawn one by one, so that packets of 16 lanes take their place, and have every eighth block here;
 * tests/stress/floats.c has all, for the grid. */
static void check_increase(const mcst_row *row) {
    const int cut = row->coord == MCST_CUT;
    const int step = (cut ? 8 : 1) * BLOCK;
    uint64_t state = mcst_seed_for(row->name, "increase", 0);
    size_t set;
    for (set = 0; set < row->grid_size + DRAWN; set++) {
        static float x[BLOCK + 1], pdf[BLOCK]; /* the last x of the block before, and a block */
        float p[MCST_P];
        int i, k, falls = 0, first = -1;
        if (set < row->grid_size) mcst_fill(row, row->grid[set][0], row->grid[set][1], 1, 0, p);
        else draw_set(row, &state, p);
        if (!mcst_case("%s %g %g", row->name, (double)p[0], (double)p[1])) continue;
        x[BLOCK] = -FLT_MAX;
        for (k = 0; k < CELLS; k += step) {
            const int before = falls;
            x[0] = x[BLOCK];
            draw_block(row, p, cut ? PACKET_16 : ARRAY, k, x + 1, pdf);
            for (i = 0; i < BLOCK; i++) falls += !(x[i + 1] >= x[i]);
            for (i = 0; falls > before && first < 0; i++)
                if (!(x[i + 1] >= x[i])) first = k + i;
        }
        CHECK(falls == 0, "x falls at %d of 2^24 steps, first to u = %d 2^-24", falls, first);
    }
}

int main(int argc, char **argv) {
    size_t row;
    mcst_start(argc, argv);
    mcst_group("increasing");
    for (row = 0; row < MCST_NROWS; row++) check_increase(&mcst_rows[row]);
    mcst_group("u = 0");
    check_zero("normal", 1);
    check_zero("logistic", 2);
    return mcst_finish();
}
