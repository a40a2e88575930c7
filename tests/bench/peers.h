/* What peers.c asks of a peer: pbrt in peers_pbrt.cpp, Cycles in peers_cycles.cpp, which call the peer's own sources. */
#ifndef PEERS_H
#define PEERS_H
#include <stddef.h>

enum { PEERS_TRIANGLE, PEERS_RECTANGLE, PEERS_HENYEY_GREENSTEIN, PEERS_GGX, PEERS_KINDS };

/* One thing to draw from. A kind reads the members that it needs. */
typedef struct {
    float point[3];     /* that is lit */
    float corner[3][3]; /* of the triangle; the first one is that of the rectangle, too */
    float edge[2][3];   /* of the rectangle */
    float g;            /* of Henyey-Greenstein */
    float alpha, wo[3]; /* of GGX */
} peers_task;

/* n samples: their random numbers, and where directions and densities per solid angle go. */
typedef struct {
    size_t n;
    const float *u1, *u2;
    float *x, *y, *z, *pdf;
} peers_samples;
typedef void peers_draw(size_t task, const peers_samples *s);

typedef struct {
    const char *name;
    void (*prepare)(const peers_task *tasks, size_t n); /* makes the scene; the tasks stay where they are */
    peers_draw *draw[PEERS_KINDS];
    float turn;     /* u2 = 0 of Henyey-Greenstein is at this azimuth, in turns */
    int concentric; /* GGX takes (u1, u2) to a disk: by the concentric map, else sqrt(u1) is the radius and u2 the turn */
} peers_peer;

#ifdef __cplusplus
extern "C" const peers_peer peer;

template <class Vector> static void peers_put(const peers_samples *s, size_t i, Vector w, float pdf) {
    s->x[i] = w.x;
    s->y[i] = w.y;
    s->z[i] = w.z;
    s->pdf[i] = pdf;
}
#else
extern const peers_peer peer;
#endif
#endif
