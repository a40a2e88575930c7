/* Samplers of a peer, pbrt or Cycles, beside ours: error and run time on one core. `make bench-peers` links it with the
 * peer's own sources, by peers_pbrt.cpp or peers_cycles.cpp, where they are given.
 *
 * Lights are triangles and rectangles of random shape, of 0.001 to 6 sr. For GGX alpha is uniform in [0.1, 1] and wo in
 * the hemisphere. "many" is 64 samples of each of 1024 tasks; making a light ready for the point is not timed. "one" is
 * a sample of each of 16384 lights, with that. All get the same random numbers, and give direction and density. Columns
 * are those of peers.py: the error of the direction in units of 2^-24, then |density/exact - 1|, each as what 99 % of
 * the samples keep to and as the largest. The truth is that of oracle.h, for GGX of the map that the peer has. */
#include "bench.h"
#include "mcsample.h"
#include "oracle.h"
#include "peers.h"

enum { LIGHTS = 1024, ONE = 16384, EACH = 64, COUNT = LIGHTS * EACH, SLICES = 16, ROUNDS = 40, FORMS = 3 };

static peers_task tasks[ONE];
static mcs_spherical_triangle triangles[LIGHTS];
static mcs_spherical_rectangle rectangles[LIGHTS];
static float u1[COUNT], u2[COUNT], out[4][COUNT], unused[3][EACH];
static double errors[2][COUNT];
static mcs_pcg32 rng;

/* ---- the truth ---- */

typedef struct {
    o_vec3 w;
    ld pdf;
} truth;

static o_vec3 truth_of(const float *v) { return o_v3(v[0], v[1], v[2]); }
static o_vec3 corner_of(const peers_task *t, int k) {
    return o_add(truth_of(t->corner[k]), o_scale(-1.0L, truth_of(t->point)));
}
/* Heitz 2018, "Sampling the GGX distribution of visible normals": the half of the disk that is behind the stretched wo
 * is squeezed to what is seen of it. */
static o_vec3 heitz_wi(ld alpha, o_vec3 wo, o_vec2 disk) {
    const o_vec3 top = o_unit(o_vec(alpha * wo.x, alpha * wo.y, wo.z));
    const o_vec3 side = o_unit(o_vec(-top.y, top.x, 0.0L));
    const ld chord = sqrtl(1.0L - disk.x * disk.x);
    const ld y = chord + 0.5L * (1.0L + top.z) * (disk.y - chord);
    const ld z = sqrtl(fmaxl(1.0L - disk.x * disk.x - y * y, 0.0L));
    const o_vec3 on_disk = o_add(o_scale(disk.x, side), o_scale(y, o_cross(top, side)));
    const o_vec3 h = o_add(on_disk, o_scale(z, top));
    return o_reflect(wo, o_unit(o_vec(alpha * h.x, alpha * h.y, h.z)));
}
static o_vec2 disk_of(ld a, ld b) {
    const o_vec3 turned = o_polar(1.0L, b);
    return peer.concentric ? o_concentric_map(1.0L, a, b) : o_v2(sqrtl(a) * turned.x, sqrtl(a) * turned.y);
}
/* The sample at (a, b), of the peer's map or of ours. */
static truth exact(int kind, const peers_task *t, ld a, ld b, int of_peer) {
    const ld g = (ld)t->g;
    const ld alpha = (ld)t->alpha;
    const o_vec3 wo = truth_of(t->wo);
    truth e;
    if (kind == PEERS_TRIANGLE) {
        const o_triangle l = o_triangle_make(corner_of(t, 0), corner_of(t, 1), corner_of(t, 2));
        e.w = o_spherical_triangle_map(l, a, b);
        e.pdf = 1.0L / l.all;
    } else if (kind == PEERS_RECTANGLE) {
        const o_rectangle l = o_rectangle_make(corner_of(t, 0), truth_of(t->edge[0]), truth_of(t->edge[1]));
        e.w = o_spherical_rectangle_map(l, a, b);
        e.pdf = 1.0L / l.all;
    } else if (kind == PEERS_HENYEY_GREENSTEIN) {
        e.w = o_henyey_greenstein_map(g, a, b + (of_peer ? (ld)peer.turn : 0.0L));
        e.pdf = o_henyey_greenstein_pdf_u(g, a, b);
    } else {
        e.w = of_peer ? heitz_wi(alpha, wo, disk_of(a, b)) : o_ggx_vndf_map(alpha, alpha, wo, a, b);
        e.pdf = o_ggx_vndf_pdf(alpha, alpha, wo, e.w);
    }
    return e;
}

/* ---- what is drawn from ---- */

static float uniform(float from, float to) { return from + (to - from) * mcs_pcg32_float(&rng); }
static mcs_vec3 uniform_direction(void) { return mcs_sphere_sample(uniform(0, 1), uniform(0, 1)).w; }

/* 1024 away: Cycles draws from the area of a triangle that is far away, and takes those of few square units for such. */
static void make_light(peers_task *t) {
    const float far = 1024.0f;
    const float size = expf(uniform(-4.0f, 1.5f));
    const mcs_vec3 to = uniform_direction();
    const mcs_frame f = mcs_frame_make(uniform_direction());
    const float centre[3] = {to.x, to.y, to.z};
    const float axes[2][3] = {{f.s.x, f.s.y, f.s.z}, {f.t.x, f.t.y, f.t.z}};
    for (int k = 0; k < 2; k++) {
        const float length = size * uniform(0.25f, 1.0f);
        for (int j = 0; j < 3; j++) t->edge[k][j] = far * length * axes[k][j];
    }
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++) t->corner[k][j] = far * (centre[j] + size * uniform(-1.0f, 1.0f));
}
static void make_task(peers_task *t, int kind) {
    const int light = kind == PEERS_TRIANGLE || kind == PEERS_RECTANGLE;
    memset(t, 0, sizeof *t);
    t->g = 0.8f;
    t->alpha = uniform(0.1f, 1.0f);
    const mcs_vec3 wo = uniform_direction();
    t->wo[0] = wo.x;
    t->wo[1] = wo.y;
    t->wo[2] = fabsf(wo.z);
    for (ld solid_angle = 0; light && !(solid_angle >= 0.001L && solid_angle <= 6.0L);) {
        make_light(t);
        solid_angle = 1.0L / exact(kind, t, 0.0L, 0.0L, 0).pdf;
    }
}
static mcs_vec3 vec3_of(const float *v) {
    const mcs_vec3 w = {v[0], v[1], v[2]};
    return w;
}
static mcs_spherical_triangle make_triangle(const peers_task *t) {
    const mcs_vec3 c = vec3_of(t->corner[2]);
    return mcs_spherical_triangle_make(vec3_of(t->point), vec3_of(t->corner[0]), vec3_of(t->corner[1]), c);
}
static mcs_spherical_rectangle make_rectangle(const peers_task *t) {
    const mcs_vec3 edge_y = vec3_of(t->edge[1]);
    return mcs_spherical_rectangle_make(vec3_of(t->point), vec3_of(t->corner[0]), vec3_of(t->edge[0]), edge_y);
}
static void make_tasks(int kind, size_t n) {
    rng = mcs_pcg32_make(1, (uint64_t)kind);
    for (size_t i = 0; i < n; i++) make_task(&tasks[i], kind);
    for (size_t i = 0; i < LIGHTS && kind == PEERS_TRIANGLE; i++) triangles[i] = make_triangle(&tasks[i]);
    for (size_t i = 0; i < LIGHTS && kind == PEERS_RECTANGLE; i++) rectangles[i] = make_rectangle(&tasks[i]);
    mcs_pcg32_fill_n(&rng, COUNT, u1);
    mcs_pcg32_fill_n(&rng, COUNT, u2);
    peer.prepare(tasks, n);
}

/* ---- ours ---- */

static void put(const peers_samples *s, size_t i, mcs_vec3 w, float pdf) {
    s->x[i] = w.x;
    s->y[i] = w.y;
    s->z[i] = w.z;
    s->pdf[i] = pdf;
}
static void triangle_calls(size_t task, const peers_samples *s) {
    for (size_t i = 0; i < s->n; i++) {
        const mcs_light_point l = mcs_spherical_triangle_sample(&triangles[task], s->u1[i], s->u2[i]);
        put(s, i, l.w, l.pdf);
    }
}
static void triangle_one(size_t task, const peers_samples *s) {
    const mcs_spherical_triangle t = make_triangle(&tasks[task]);
    const mcs_light_point l = mcs_spherical_triangle_sample(&t, s->u1[0], s->u2[0]);
    put(s, 0, l.w, l.pdf);
}
static void triangle_arrays(size_t task, const peers_samples *s) {
    mcs_spherical_triangle_sample_n(&triangles[task], s->n, s->u1, s->u2, s->x, s->y, s->z, s->pdf, unused[0],
                                    unused[1], unused[2]);
}
static void rectangle_calls(size_t task, const peers_samples *s) {
    for (size_t i = 0; i < s->n; i++) {
        const mcs_light_point l = mcs_spherical_rectangle_sample(&rectangles[task], s->u1[i], s->u2[i]);
        put(s, i, l.w, l.pdf);
    }
}
static void rectangle_one(size_t task, const peers_samples *s) {
    const mcs_spherical_rectangle r = make_rectangle(&tasks[task]);
    const mcs_light_point l = mcs_spherical_rectangle_sample(&r, s->u1[0], s->u2[0]);
    put(s, 0, l.w, l.pdf);
}
static void rectangle_arrays(size_t task, const peers_samples *s) {
    mcs_spherical_rectangle_sample_n(&rectangles[task], s->n, s->u1, s->u2, s->x, s->y, s->z, s->pdf, unused[0],
                                     unused[1], unused[2]);
}
static void henyey_greenstein_calls(size_t task, const peers_samples *s) {
    const float g = tasks[task].g;
    for (size_t i = 0; i < s->n; i++) {
        const mcs_dir d = mcs_henyey_greenstein_sample(g, s->u1[i], s->u2[i]);
        put(s, i, d.w, d.pdf);
    }
}
static void henyey_greenstein_arrays(size_t task, const peers_samples *s) {
    mcs_henyey_greenstein_sample_n(tasks[task].g, s->n, s->u1, s->u2, s->x, s->y, s->z, s->pdf);
}
static void ggx_calls(size_t task, const peers_samples *s) {
    const mcs_ggx m = mcs_ggx_make(tasks[task].alpha, tasks[task].alpha);
    const mcs_vec3 wo = vec3_of(tasks[task].wo);
    for (size_t i = 0; i < s->n; i++) {
        const mcs_brdf b = mcs_ggx_vndf_sample(&m, wo, s->u1[i], s->u2[i]);
        put(s, i, b.wi, b.pdf);
    }
}
static void ggx_arrays(size_t task, const peers_samples *s) {
    const mcs_ggx m = mcs_ggx_make(tasks[task].alpha, tasks[task].alpha);
    mcs_ggx_vndf_sample_n(&m, vec3_of(tasks[task].wo), s->n, s->u1, s->u2, s->x, s->y, s->z, s->pdf, unused[0]);
}

/* ---- the comparison ---- */

typedef struct {
    const char *name;
    int kind;
    size_t tasks, each;
    peers_draw *calls, *arrays;
} row;
static const row rows[] = {
    {"triangle light, many", PEERS_TRIANGLE, LIGHTS, EACH, triangle_calls, triangle_arrays},
    {"triangle light, one", PEERS_TRIANGLE, ONE, 1, triangle_one, NULL},
    {"rectangle light, many", PEERS_RECTANGLE, LIGHTS, EACH, rectangle_calls, rectangle_arrays},
    {"rectangle light, one", PEERS_RECTANGLE, ONE, 1, rectangle_one, NULL},
    {"Henyey-Greenstein 0.8", PEERS_HENYEY_GREENSTEIN, LIGHTS, EACH, henyey_greenstein_calls, henyey_greenstein_arrays},
    {"GGX, visible normals", PEERS_GGX, LIGHTS, EACH, ggx_calls, ggx_arrays},
};

/* Of a slice of the tasks, for all of its samples: in a millisecond other programs seldom get their turn. */
static double nanoseconds(const row *r, peers_draw *draw, size_t slice) {
    const size_t tasks_each = r->tasks / SLICES;
    const double began = bench_seconds();
    for (size_t task = slice * tasks_each; task < (slice + 1) * tasks_each; task++) {
        const size_t at = task * r->each;
        const peers_samples s = {r->each, u1 + at, u2 + at, out[0] + at, out[1] + at, out[2] + at, out[3] + at};
        draw(task, &s);
    }
    return (bench_seconds() - began) * 1e9;
}

/* The errors of what was drawn last. Directions below the surface, or all but below, count for nobody. */
static void show_errors(const row *r, int of_peer) {
    size_t n = 0;
    for (size_t i = 0; i < r->tasks * r->each; i++) {
        const truth e = exact(r->kind, &tasks[i / r->each], (ld)u1[i], (ld)u2[i], of_peer);
        if (r->kind == PEERS_GGX && e.w.z < 1e-5L) continue;
        const o_vec3 w = o_v3(out[0][i], out[1][i], out[2][i]);
        errors[0][n] = (double)(o_len(o_add(w, o_scale(-1.0L, e.w))) * 0x1p24L);
        errors[1][n] = (double)fabsl((ld)out[3][i] / e.pdf - 1.0L);
        for (int k = 0; k < 2; k++) errors[k][n] = isnan(errors[k][n]) ? INFINITY : errors[k][n];
        n++;
    }
    for (int k = 0; k < 2; k++) qsort(errors[k], n, sizeof **errors, bench_ascending);
    printf(" %14.2g %9.2g", errors[0][n * 99 / 100], errors[0][n - 1]);
    printf(" %14.1e %9.1e\n", errors[1][n * 99 / 100], errors[1][n - 1]);
}

/* Whatever is compared takes turns, so that no branch learns a slice by heart. */
static void compare(const row *r) {
    peers_draw *const forms[FORMS] = {r->calls, r->arrays, peer.draw[r->kind]};
    const char *const whose[FORMS] = {"here, a call", "here, arrays", peer.name};
    double least[FORMS][SLICES];
    make_tasks(r->kind, r->tasks);
    for (size_t turn = 0; turn < ROUNDS * SLICES * FORMS; turn++) {
        const size_t slice = turn / FORMS % SLICES;
        const size_t k = turn % FORMS;
        const double taken = forms[k] ? nanoseconds(r, forms[k], slice) : 0;
        least[k][slice] = turn < SLICES * FORMS ? taken : fmin(least[k][slice], taken);
    }
    for (size_t k = 0; k < FORMS; k++) {
        if (!forms[k]) continue;
        double sum = 0;
        for (size_t slice = 0; slice < SLICES; slice++) {
            nanoseconds(r, forms[k], slice);
            sum += least[k][slice];
        }
        printf("%-24s %-12s %6.2f", k ? "" : r->name, whose[k], sum / (double)(r->tasks * r->each));
        show_errors(r, k == FORMS - 1);
    }
}

int main(int argc, char **argv) {
    bench_start(argc, argv, "peers");
    printf("%s, by " PEERS_FLAGS "; ns a sample (least of %d)\n", peer.name, ROUNDS);
    printf("%-24s %-12s %6s %14s %9s %14s %9s\n", "", "", "ns", "direction 99 %", "largest", "density 99 %", "largest");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) compare(&rows[i]);
    return 0;
}
