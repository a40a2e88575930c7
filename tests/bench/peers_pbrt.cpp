/* Samplers of pbrt-v4 for peers.c: those of util/scattering.h, and of util/sampling.cpp, which is linked. Its shapes and
 * materials call them in the same way. */
#include "peers.h"
#include <pbrt/util/sampling.h>
#include <pbrt/util/scattering.h>

using namespace pbrt;

/* What sampling.cpp wants of the rest of pbrt: to report failures, and to register statistics that nobody prints. */
namespace pbrt {
void LogFatal(LogLevel, const char *file, int line, const char *what) {
    fprintf(stderr, "%s:%d: %s\n", file, line, what);
    exit(1);
}
StatRegisterer::StatRegisterer(AccumFunc, PixelAccumFunc) {}
void StatsAccumulator::ReportRareCheck(const char *, float, int64_t, int64_t) {}
namespace detail {
std::string FloatToString(float) { return ""; }
void stringPrintfRecursive(std::string *, const char *) {}
std::string copyToFormatString(const char **, std::string *) { return ""; }
} // namespace detail
} // namespace pbrt

static const peers_task *tasks;

static void prepare(const peers_task *t, size_t) { tasks = t; }

static Point3f point_of(const float *p) { return Point3f(p[0], p[1], p[2]); }
static Vector3f vector_of(const float *v) { return Vector3f(v[0], v[1], v[2]); }

static void triangle(size_t task, const peers_samples *s) {
    const peers_task &t = tasks[task];
    const Point3f p = point_of(t.point);
    const pstd::array<Point3f, 3> v = {point_of(t.corner[0]), point_of(t.corner[1]), point_of(t.corner[2])};
    for (size_t i = 0; i < s->n; i++) {
        float pdf;
        const pstd::array<float, 3> b = SampleSphericalTriangle(v, p, Point2f(s->u1[i], s->u2[i]), &pdf);
        peers_put(s, i, Normalize(b[0] * v[0] + b[1] * v[1] + b[2] * v[2] - p), pdf);
    }
}

static void rectangle(size_t task, const peers_samples *s) {
    const peers_task &t = tasks[task];
    const Point3f p = point_of(t.point);
    const Point3f corner = point_of(t.corner[0]);
    const Vector3f edge_x = vector_of(t.edge[0]);
    const Vector3f edge_y = vector_of(t.edge[1]);
    for (size_t i = 0; i < s->n; i++) {
        float pdf;
        const Point2f u(s->u1[i], s->u2[i]);
        const Point3f on_light = SampleSphericalRectangle(p, corner, edge_x, edge_y, u, &pdf);
        peers_put(s, i, Normalize(on_light - p), pdf);
    }
}

/* wo goes back along the ray, which goes along +z. The y axis of its frame is -y. */
static void henyey_greenstein(size_t task, const peers_samples *s) {
    const float g = tasks[task].g;
    for (size_t i = 0; i < s->n; i++) {
        float pdf;
        const Vector3f w = SampleHenyeyGreenstein(Vector3f(0, 0, -1), g, Point2f(s->u1[i], s->u2[i]), &pdf);
        peers_put(s, i, Vector3f(w.x, -w.y, w.z), pdf);
    }
}

static void ggx(size_t task, const peers_samples *s) {
    const TrowbridgeReitzDistribution lobe(tasks[task].alpha, tasks[task].alpha);
    const Vector3f wo = vector_of(tasks[task].wo);
    for (size_t i = 0; i < s->n; i++) {
        const Vector3f wm = lobe.Sample_wm(wo, Point2f(s->u1[i], s->u2[i]));
        peers_put(s, i, Reflect(wo, wm), lobe.PDF(wo, wm) / (4 * AbsDot(wo, wm)));
    }
}

const peers_peer peer = {"pbrt", prepare, {triangle, rectangle, henyey_greenstein, ggx}, 0, 0};
