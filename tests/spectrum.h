/* The spectrum of the error of a picture: how much of its power is at which frequency, over that of white noise of the
 * same variance. A picture has SPECTRUM_W x SPECTRUM_W pixels, and each pixel estimates the same integral over the unit
 * square. */
#ifndef MCST_SPECTRUM_H
#define MCST_SPECTRUM_H
#include <math.h>
#include <stdint.h>

/* Frequency band b is [b, b + 1) / SPECTRUM_W cycles a pixel, in any direction. */
enum { SPECTRUM_W = 256, SPECTRUM_BANDS = SPECTRUM_W / 2 };

/* Point s of the n of pixel (x, y). */
typedef mcs_vec2 (*spectrum_point)(uint32_t x, uint32_t y, uint32_t s, uint32_t n);
/* What is integrated, less its mean. */
typedef double (*spectrum_function)(mcs_vec2 p);

typedef struct {
    double power[SPECTRUM_BANDS]; /* over that of white noise: 1 everywhere for independent pixels */
    double count[SPECTRUM_BANDS]; /* how many frequencies are in the band */
    double variance;              /* of a pixel */
} spectrum;

/* Discrete Fourier transform of SPECTRUM_W numbers, `step` apart (Cooley and Tukey 1965). */
static inline void spectrum_transform(double *re, double *im, uint32_t step) {
    static double from_re[SPECTRUM_W], from_im[SPECTRUM_W];
    for (uint32_t half_size = 1; half_size < SPECTRUM_W; half_size *= 2) {
        const uint32_t stride = SPECTRUM_W / 2 / half_size;
        for (uint32_t i = 0; i < SPECTRUM_W; i++) {
            from_re[i] = re[i * step];
            from_im[i] = im[i * step];
        }
        for (uint32_t k = 0; k < half_size; k++) {
            const double turn = 3.14159265358979323846 * k / half_size;
            const double c = cos(turn);
            const double s = -sin(turn);
            for (uint32_t i = 0; i < stride; i++) {
                const uint32_t even = 2 * k * stride + i;
                const uint32_t odd = even + stride;
                const double odd_re = c * from_re[odd] - s * from_im[odd];
                const double odd_im = c * from_im[odd] + s * from_re[odd];
                const uint32_t low = (k * stride + i) * step;
                const uint32_t high = low + SPECTRUM_W / 2 * step;
                re[low] = from_re[even] + odd_re;
                im[low] = from_im[even] + odd_im;
                re[high] = from_re[even] - odd_re;
                im[high] = from_im[even] - odd_im;
            }
        }
    }
}

/* Of the picture whose upper left pixel is (x0, y0), with n points a pixel. The mean of the picture is left out. */
static inline spectrum spectrum_of(spectrum_point point, spectrum_function f, uint32_t x0, uint32_t y0, uint32_t n) {
    static double re[SPECTRUM_W * SPECTRUM_W], im[SPECTRUM_W * SPECTRUM_W];
    for (uint32_t i = 0; i < SPECTRUM_W * SPECTRUM_W; i++) {
        double sum = 0;
        for (uint32_t s = 0; s < n; s++) sum += f(point(x0 + i % SPECTRUM_W, y0 + i / SPECTRUM_W, s, n));
        re[i] = sum / n;
        im[i] = 0;
    }
    for (uint32_t y = 0; y < SPECTRUM_W; y++) spectrum_transform(&re[y * SPECTRUM_W], &im[y * SPECTRUM_W], 1);
    for (uint32_t x = 0; x < SPECTRUM_W; x++) spectrum_transform(&re[x], &im[x], SPECTRUM_W);
    spectrum all = {{0}, {0}, 0};
    for (uint32_t i = 1; i < SPECTRUM_W * SPECTRUM_W; i++) {
        const double x = i % SPECTRUM_W < SPECTRUM_W / 2 ? i % SPECTRUM_W : SPECTRUM_W - i % SPECTRUM_W;
        const double y = i / SPECTRUM_W < SPECTRUM_W / 2 ? i / SPECTRUM_W : SPECTRUM_W - i / SPECTRUM_W;
        const uint32_t band = (uint32_t)sqrt(x * x + y * y);
        const double power = re[i] * re[i] + im[i] * im[i];
        all.variance += power;
        if (band >= SPECTRUM_BANDS) continue; /* the corners: no whole circle lies in them */
        all.power[band] += power;
        all.count[band]++;
    }
    const double white = all.variance / (SPECTRUM_W * SPECTRUM_W - 1);
    for (uint32_t b = 1; b < SPECTRUM_BANDS; b++) all.power[b] /= all.count[b] * white;
    all.variance = white / (SPECTRUM_W * SPECTRUM_W);
    return all;
}

/* The mean over the frequencies of all bands within [from, to). */
static inline double spectrum_mean(const spectrum *s, uint32_t from, uint32_t to) {
    double sum = 0;
    double count = 0;
    for (uint32_t b = from; b < to; b++) {
        sum += s->power[b] * s->count[b];
        count += s->count[b];
    }
    return sum / count;
}
#endif
