/* The error of a picture by frequency, where all pixels estimate the same smooth integral: points across a picture,
 * and points that every pixel has by itself. Writes spectrum.csv and spectrum.svg, prints how much power is below 1/16
 * cycles a pixel, and the time per pixel of mcs_sobol_pixel. */
#include "bench.h"
#include "mcsample.h"
#include "spectrum.h"
#include "svg.h"

enum { MOST = 16, CURVES = 5, SEEDS = 8 };

static uint32_t seed;
static mcs_vec2 sobol_at(uint32_t index, uint32_t key) {
    mcs_vec2 p;
    p.x = mcs_sobol(index, 0, key);
    p.y = mcs_sobol(index, 1, key);
    return p;
}
static mcs_vec2 across(uint32_t x, uint32_t y, uint32_t s, uint32_t n) {
    return sobol_at(mcs_sobol_pixel(x, y, n, seed) + s, seed);
}
static mcs_vec2 alone(uint32_t x, uint32_t y, uint32_t s, uint32_t n) {
    (void)n;
    return sobol_at(s, mcs_hash(x, mcs_hash(y, seed)));
}
static mcs_vec2 independent(uint32_t x, uint32_t y, uint32_t s, uint32_t n) {
    (void)n;
    const mcs_philox4 words = mcs_philox(seed, (uint64_t)x << 32 | y, s);
    mcs_vec2 p;
    p.x = mcs_u01(words.v[0]);
    p.y = mcs_u01(words.v[1]);
    return p;
}
/* A Gaussian less its mean, erf(1)^2 pi/4. */
static double bell(mcs_vec2 p) {
    return exp(-(double)p.x * (double)p.x - (double)p.y * (double)p.y) - 0.557746285351034;
}

static const struct {
    const char *name;
    spectrum_point point;
    uint32_t n;
} curves[CURVES] = {{"independent, 4", independent, 4},
                    {"Sobol by pixel, 4", alone, 4},
                    {"across, 1", across, 1},
                    {"across, 4", across, 4},
                    {"across, 16", across, MOST}};

/* Mean power and variance over seeds. */
static spectrum measure(int curve, int seeds) {
    spectrum mean = {{0}, {0}, 0};
    for (int k = 0; k < seeds; k++) {
        bench_progress("spectrum: %s, picture %d of %d", curves[curve].name, k + 1, seeds);
        seed = (uint32_t)k;
        const spectrum one = spectrum_of(curves[curve].point, bell, 0, 0, curves[curve].n);
        mean.variance += one.variance / seeds;
        for (int b = 1; b < SPECTRUM_BANDS; b++) {
            mean.power[b] += one.power[b] / seeds;
            mean.count[b] = one.count[b];
        }
    }
    bench_progress("%s", "");
    return mean;
}

static int plot(const spectrum *of) {
    double x[SPECTRUM_BANDS - 1], y[SPECTRUM_BANDS - 1];
    svg_plot p;
    svg_begin(&p, bench_path("spectrum.svg"), "Power of a picture's error", "cycles per pixel",
              "over white noise of that variance", 1, 1, 1.0 / SPECTRUM_W, 0.5, 1e-3, 3);
    for (int c = 0; c < CURVES; c++) {
        for (int b = 1; b < SPECTRUM_BANDS; b++) {
            x[b - 1] = (double)b / SPECTRUM_W;
            y[b - 1] = of[c].power[b];
        }
        svg_series(&p, curves[c].name, SPECTRUM_BANDS - 1, x, y, SVG_LINE_ONLY);
    }
    svg_note(&p, "256 x 256 pixels, each of");
    svg_note(&p, "them 1, 4 or 16 points of a");
    svg_note(&p, "Gaussian; across: of");
    svg_note(&p, "mcs_sobol_pixel");
    return svg_end(&p);
}

static void print_time(void) {
    enum { PIXELS = 1 << 20, ROUNDS = 5 };
    double ns[ROUNDS];
    uint32_t sum = 0;
    for (int r = 0; r < ROUNDS; r++) {
        const double start = bench_seconds();
        for (uint32_t i = 0; i < PIXELS; i++) sum += mcs_sobol_pixel(i % 1024, i / 1024, MOST, (uint32_t)r);
        ns[r] = 1e9 * (bench_seconds() - start) / PIXELS;
    }
    bench.sink += sum;
    printf("mcs_sobol_pixel: %.1f ns\n", bench_spread_of(ns, ROUNDS).median);
}

int main(int argc, char **argv) {
    spectrum of[CURVES];
    bench_start(argc, argv, "spectrum");
    FILE *csv = bench_csv("spectrum.csv", "points,cycles_per_pixel,power");
    printf("\nError of pictures: power below 1/16 cycles a pixel over that of white noise, and variance of a pixel\n");
    for (int c = 0; c < CURVES; c++) {
        of[c] = measure(c, bench.quick ? 1 : SEEDS);
        for (int b = 1; b < SPECTRUM_BANDS; b++)
            fprintf(csv, "\"%s\",%.5f,%.4g\n", curves[c].name, (double)b / SPECTRUM_W, of[c].power[b]);
        printf("%-18s %7.3f %9.2e\n", curves[c].name, spectrum_mean(&of[c], 1, SPECTRUM_W / 16), of[c].variance);
    }
    bench_close(csv, "spectrum.csv");
    print_time();
    return plot(of) != 0;
}
