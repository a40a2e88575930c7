/* What the stress tests share: numbers of every class a float has, memory between guards, the ranges that the header documents. */
#ifndef MCS_STRESS_H
#define MCS_STRESS_H
#include <float.h>
#include <math.h>
#include "registry.h"

static inline float st_float(uint32_t bits) {
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

/* Any float: half of the time any bit pattern, otherwise a number at an edge of some range, NaN and infinities among them. */
static inline float st_hostile(uint64_t z) {
    static const float edge[32] = {0.0f,        -0.0f,       0x1p-149f, -0x1p-149f, 0x1p-127f, FLT_MIN,  -FLT_MIN, 1e-30f,
                                   1e-18f,      9e-19f,      1e-7f,     9e-8f,      0x1p-24f,  0.25f,    0.5f,     0.49999997f,
                                   0.70710678f, 0.99999994f, 1.0f,      1.0000001f, -1.0f,     2.0f,     -2.0f,    1e4f,
                                   1.1e9f,      1e18f,       1.1e18f,   1e30f,      FLT_MAX,   -FLT_MAX, INFINITY, -INFINITY};
    const uint32_t bits = (uint32_t)(z >> 32);
    if (z & 1) return st_float(bits);
    if ((z & 30) == 0) return st_float(0x7fc00000u | (bits & 0x803fffffu)); /* quiet NaN of either sign, any payload */
    if ((z & 30) == 2) return st_float(bits & 0x807fffffu);                 /* subnormal */
    return edge[z >> 5 & 31];
}

/* Is parameter i outside the range that the header documents for the row? -1: the header leaves it open. */
static inline int st_parameter_bad(const mcst_row *row, int i, float v) {
    if (isnan(v)) return 1;
    if (row->coord == MCST_SLOPES) return !(v > 0);
    if (row->coord == MCST_COSPOWER) return !(v >= 0);
    switch (row->coord) {
    case MCST_TENT:
    case MCST_HALFLINE:
    case MCST_DISK: return !(v >= 1e-18f && v <= 1e18f);
    case MCST_TRUNCATED: return i ? !(v >= 1e-18f && v <= 1e18f) : v < 0 ? 1 : v <= 1e18f ? 0 : -1;
    case MCST_WHOLELINE: return i ? !(v >= 1e-18f && v <= 1e18f) : fabsf(v) <= 1e30f ? 0 : isinf(v) ? 1 : -1;
    case MCST_CONE: return v <= 0 || v > 2 ? 1 : v < 1e-30f ? -1 : 0;
    case MCST_POWER:
    case MCST_EVENPOWER: return !(v >= 0 && v <= 1e9f);
    case MCST_UNIT: return v < 0 || isinf(v); /* linear; both 0 is bad, too */
    default: return 0;
    }
}

/* 1: no direction by the header (squared length not within (1/4, 4), NaN), 0: a direction, -1: too near the limits to say. */
static inline int st_direction_bad(float x, float y, float z) {
    const double l2 = (double)x * (double)x + (double)y * (double)y + (double)z * (double)z;
    if (!(l2 > 0.2499999 && l2 < 4.000001)) return 1;
    return l2 > 0.2500001 && l2 < 3.999999 ? 0 : -1;
}
static inline int st_above_bad(float x, float y, float z) { return z > 0 ? st_direction_bad(x, y, z) : 1; }

/* Memory of exactly the size asked for, between two guards of `GUARD` bytes. */
enum { ST_GUARD = 64 };
typedef struct {
    unsigned char *raw, *at;
    size_t bytes;
} st_memory;
static inline st_memory st_memory_make(size_t bytes) {
    st_memory m;
    m.bytes = bytes;
    m.raw = (unsigned char *)malloc(bytes + 2 * ST_GUARD);
    if (!m.raw) {
        fprintf(stderr, "out of memory\n");
        exit(2);
    }
    memset(m.raw, 0xa5, bytes + 2 * ST_GUARD);
    m.at = m.raw + ST_GUARD;
    return m;
}
static inline int st_untouched(const unsigned char *p, size_t n) {
    while (n > 0 && p[n - 1] == 0xa5) n--;
    return n == 0;
}
static inline int st_intact(const st_memory *m) {
    return st_untouched(m->raw, ST_GUARD) && st_untouched(m->at + m->bytes, ST_GUARD);
}
static inline void st_memory_free(st_memory *m) { free(m->raw); }
#endif
