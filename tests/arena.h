/* The caller's memory of a table: exactly as many bytes as were asked for, between two guards, all filled with one
 * pattern, so that a test sees what was written and what was not. */
#ifndef MCST_ARENA_H
#define MCST_ARENA_H
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ARENA_GUARD = 64, ARENA_FILL = 0xa5 };

/* Memory of a test, which ends without. */
static inline void *memory(size_t bytes) {
    void *p = malloc(bytes);
    if (!p) {
        fprintf(stderr, "out of memory\n");
        exit(2);
    }
    return p;
}

typedef struct {
    unsigned char *raw, *at;
    size_t bytes;
} arena;

static inline arena arena_make(size_t bytes) {
    arena a;
    a.bytes = bytes;
    a.raw = (unsigned char *)memory(bytes + 2 * ARENA_GUARD);
    memset(a.raw, ARENA_FILL, bytes + 2 * ARENA_GUARD);
    a.at = a.raw + ARENA_GUARD;
    return a;
}

/* Memory before a build, for a test that the bytes of a table do not depend on it: zeros, ones, noise. */
enum { ARENA_PASTS = 3 };
static inline void arena_past(arena *a, int past) {
    unsigned state = 1;
    for (size_t i = 0; i < a->bytes; i++) {
        state = state * 1664525u + 1013904223u;
        a->at[i] = (unsigned char)(past == 0 ? 0 : past == 1 ? 0xff : state >> 24);
    }
}
/* The first byte in which two are different, or `bytes`. */
static inline size_t arena_differ(const arena *a, const arena *b) {
    size_t i = 0;
    while (i < a->bytes && a->at[i] == b->at[i]) i++;
    return i;
}

static inline size_t filled(const unsigned char *p, size_t n) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++) count += p[i] == ARENA_FILL;
    return count;
}

static inline int untouched(const unsigned char *p, size_t n) { return filled(p, n) == n; }

static inline int arena_intact(const arena *a) {
    return untouched(a->raw, ARENA_GUARD) && untouched(a->at + a->bytes, ARENA_GUARD);
}

static inline void arena_free(arena *a) { free(a->raw); }
#endif
