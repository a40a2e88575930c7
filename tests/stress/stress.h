/* What the stress tests share: numbers of every class a float has, memory between guards (arena.h), the ranges that the
 * header documents. */
#ifndef MCS_STRESS_H
#define MCS_STRESS_H
#include <float.h>
#include <math.h>
#include "arena.h"
#include "registry.h"

static inline float st_float(uint32_t bits) {
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

/* Any float: half of the time any bit pattern, otherwise a number at an edge of some range, NaN and infinities among
 * them. */
static inline float st_hostile(uint64_t z) {
    static const float edge[32] = {0.0f,    -0.0f,       0x1p-149f,   -0x1p-149f,  0x1p-127f, FLT_MIN,    -FLT_MIN,
                                   1e-30f,  1e-18f,      9e-19f,      1e-7f,       9e-8f,     0x1p-24f,   0.25f,
                                   0.5f,    0.49999997f, 0.70710678f, 0.99999994f, 1.0f,      1.0000001f, -1.0f,
                                   2.0f,    -2.0f,       1e4f,        1.1e9f,      1e18f,     1.1e18f,    1e30f,
                                   FLT_MAX, -FLT_MAX,    INFINITY,    -INFINITY};
    const uint32_t bits = (uint32_t)(z >> 32);
    if (z & 1) return st_float(bits);
    if ((z & 30) == 0) return st_float(0x7fc00000u | (bits & 0x803fffffu)); /* quiet NaN of either sign, any payload */
    if ((z & 30) == 2) return st_float(bits & 0x807fffffu);                 /* subnormal */
    return edge[z >> 5 & 31];
}

/* Is parameter i outside the range that the header documents for the row? -1: the header leaves it open. */
static inline int st_parameter_bad(const mcst_row *row, int i, float v) { return row->domain.bad(i, v); }

/* 1: no direction by the header (squared length not within (1/4, 4), NaN), 0: a direction, -1: too near the limits to
 * say. */
static inline int st_direction_bad(float x, float y, float z) {
    const double l2 = (double)x * (double)x + (double)y * (double)y + (double)z * (double)z;
    if (!(l2 > 0.2499999 && l2 < 4.000001)) return 1;
    return l2 > 0.2500001 && l2 < 3.999999 ? 0 : -1;
}
static inline int st_above_bad(float x, float y, float z) { return z > 0 ? st_direction_bad(x, y, z) : 1; }

/* How far the length of a direction of a map may be from 1, in 2^-24: sine of a root 2, sine and cosine of the azimuth
 * 1.4 ulp or 2.8, their products 1, the cosine 0.5. */
static const double st_map_off = 7 * 0x1p-24;
#endif
