/* What the tests of environment maps share: what a texel covers and where it lies, in double and long double. */
#ifndef MCST_LATLONG_H
#define MCST_LATLONG_H
#include <math.h>
#include <stdint.h>
#include "mcsample.h"

/* cos(pi r / h) - cos(pi (r+1) / h) without cancellation, times the width of a column. */
static inline long double solid_angle(uint32_t r, uint32_t w, uint32_t h) {
    const long double p = acosl(-1.0L);
    return 2 * p / w * 2 * sinl(p / 2 / h) * sinl(p * (r + 0.5L) / h);
}

/* Direction of a point of a texel, from fractions of its column and of its cos(theta) range. */
static inline mcs_vec3 point(uint32_t w, uint32_t h, uint32_t col, uint32_t row, double fc, double fr) {
    const double pi = acos(-1.0);
    const double phi = 2 * pi * (col + fc) / w;
    /* (1 - cos theta) / 2 = sin^2(theta/2) keeps its digits at the poles */
    const double a = pow(sin(pi / 2 * row / h), 2);
    const double b = pow(sin(pi / 2 * (row + 1) / h), 2);
    const double half = a + (b - a) * fr;
    const double s = 2 * sqrt(half * (1 - half));
    mcs_vec3 v;
    v.x = (float)(s * cos(phi));
    v.y = (float)(s * sin(phi));
    v.z = (float)(1 - 2 * half);
    return v;
}
/* Texel of a direction, with fractions of its width and of its height in theta. */
static inline void texel_of(uint32_t w, uint32_t h, mcs_vec3 v, double *col, double *row) {
    const double pi = acos(-1.0);
    double turn = atan2(v.y, v.x) / (2 * pi);
    if (turn < 0) turn += 1;
    *col = turn * w;
    *row = atan2(sqrt((double)v.x * v.x + (double)v.y * v.y), v.z) / pi * h;
}

/* What a table says of its picture: black ones are drawn as even light. */
typedef enum { LIT, BLACK, NEITHER } brightness;
static inline brightness brightness_of(const mcs_env *e) {
    return e->total > 0 ? LIT : e->total == 0 && e->uniform ? BLACK : NEITHER;
}
#endif
