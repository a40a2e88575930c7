/* What the tests of values share: all are against long double. EPS = 2^-24 is half an ulp of 1. */
#ifndef MCST_VALUES_H
#define MCST_VALUES_H
#include "arena.h"
#include "registry.h"

#define EPS 0x1p-24

static inline mcs_vec3 vec3(const float *w) {
    mcs_vec3 v;
    v.x = w[0];
    v.y = w[1];
    v.z = w[2];
    return v;
}

static inline ld relative(float got, ld want) { return fabsl((ld)got - want) / want; }

/* A map of that light, in memory of its own. */
static inline mcs_env *map_of(arena *a, const float *light, uint32_t w, uint32_t h) {
    const mcs_image image = mcs_image_make(light, w, h, 1);
    *a = arena_make(mcs_env_bytes(w, h));
    mcs_env *e = (mcs_env *)(void *)a->at;
    CHECK(mcs_env_build(e, a->bytes, &image) == MCS_OK, "build");
    return e;
}

#endif
