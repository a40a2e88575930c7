/* What all tests of environment maps draw from: shades of pictures, by column and row. SHADE_STREAM is the number of the
 * random numbers that a test has for itself. */
#ifndef MCST_ENV_SHADES_H
#define MCST_ENV_SHADES_H
#include <float.h>
#include <math.h>
#include "arena.h"
#include "latlong.h"
#include "mcs_test.h"
#include "mcsample.h"

typedef long double ld;

static const double pi = 3.14159265358979323846;
static const double eps = 0x1p-24; /* rounding of a float, relative; also the step of u */

/* MCS_TEST_SCALE below 1 (sanitizer builds) draws fewer samples. */
static inline int scaled(int n) {
    const char *s = getenv("MCS_TEST_SCALE");
    const double f = s ? atof(s) : 1;
    return f > 0 && f < 1 ? (int)(n * f) + 1 : n;
}

typedef float (*shade)(uint32_t col, uint32_t row, uint32_t w, uint32_t h);

static inline float hash01(uint32_t i) { return mcs_u01(mcs_philox(mcst.seed, i, SHADE_STREAM).v[0]); }

static inline float v_random(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)h;
    return 0.1f + hash01(r * w + c);
}
static inline float v_constant(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)c;
    (void)r;
    (void)w;
    (void)h;
    return 0.7f;
}
static inline float v_black(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)c;
    (void)r;
    (void)w;
    (void)h;
    return 0.0f;
}
static inline float v_checker(uint32_t c, uint32_t r, uint32_t w, uint32_t h) {
    (void)w;
    (void)h;
    return (c + r) & 1 ? 1.0f : 0.0f;
}
#endif
