/* Lights anywhere, of any size: spherical rectangles and triangles against the truth of oracle.h; balls and disks away
 * from the origin; points in the plane of a light, lights that are none or too faint, densities per area and per solid
 * angle, lanes and arrays. */
#include <float.h>
#include <math.h>
#include "mcs_test.h"
#define MCS_PACKETS 16
#include "mcsample.h"
#include "oracle.h"
#include "values.h"

static const double eps = 0x1p-24;
enum { LIGHTS = 400, DRAWS = 4 };

static double any(mcs_pcg32 *r) { return 2 * (double)mcs_pcg32_float(r) - 1; }
static double pick(mcs_pcg32 *r, double lo, double hi) { return lo * pow(hi / lo, (double)mcs_pcg32_float(r)); }
static float any_u(mcs_pcg32 *r) {
    static const float special[] = {0, 0x1p-149f, 0x1p-24f, 0.5f, 1 - 0x1p-24f};
    const uint32_t k = mcs_pcg32_next(r) % 15;
    return k < 5 ? special[k] : mcs_pcg32_float(r);
}

/* A light's size along both axes of its plane, the distance of the plane, and how far the light is from the foot of the
 * point, in some ways. */
typedef struct {
    const char *name;
    double width, height, distance, aside;
} kind;
static const kind kinds[] = {{"ordinary", 1, 1, 1, 1},
                             {"near", 1, 1, 1e-4, 1},
                             {"distant", 1, 1, 1e6, 1},
                             {"a sliver", 1, 1e-5, 1, 1},
                             {"grazing", 1, 1, 1e-6, 4},
                             {"a near sliver", 1, 1e-5, 0.01, 1},
                             {"a small sliver", 1e-3, 1e-8, 1, 2},
                             {"a grazing sliver", 1, 1e-4, 1e-3, 4}};
enum { KINDS = sizeof kinds / sizeof *kinds };

typedef struct {
    mcs_vec3 p, a, b, c; /* b and c are edges, or corners */
} shape;

static mcs_vec3 at(const mcs_frame *f, mcs_vec3 from, double x, double y, double z) {
    mcs_vec3 v;
    v.x = (float)((double)from.x + x * (double)f->s.x + y * (double)f->t.x + z * (double)f->n.x);
    v.y = (float)((double)from.y + x * (double)f->s.y + y * (double)f->t.y + z * (double)f->n.y);
    v.z = (float)((double)from.z + x * (double)f->s.z + y * (double)f->t.z + z * (double)f->n.z);
    return v;
}
/* In two of three cases turned anyhow, in one of three not around the origin. */
static shape any_shape(mcs_pcg32 *r, const kind *k, int edges) {
    const mcs_vec3 zero = {0, 0, 0};
    const mcs_vec3 up = {0, 0, 1};
    const mcs_vec3 normal = mcs_sphere_sample(mcs_pcg32_float(r), mcs_pcg32_float(r)).w;
    const mcs_frame f = mcs_frame_make(mcs_pcg32_next(r) % 3 ? normal : up);
    const int grazing = k->distance < 1e-2;
    shape s;
    s.p = zero;
    if (mcs_pcg32_next(r) % 3 == 0 && !grazing) s.p = at(&f, zero, 10 * any(r), 10 * any(r), 10 * any(r));
    const double depth = k->distance > 1 ? pick(r, 1, k->distance) : pick(r, k->distance, 1);
    const double aside = k->aside > 2 ? k->aside : k->aside * any(r);
    const double width = pick(r, k->width < 1 ? k->width : 0.1, 1);
    const double height = k->height < 1 ? width * pick(r, k->height / k->width, 1) : width * pick(r, 0.1, 1);
    s.a = at(&f, s.p, aside + width * any(r), height * any(r), depth);
    if (edges) {
        const double angle = mcs_pcg32_next(r) % 2 ? 0 : 3 * any(r);
        s.b = at(&f, zero, width * cos(angle), width * sin(angle), 0);
        const double up_or_down = mcs_pcg32_next(r) % 2 ? height : -height; /* either face to p */
        s.c = at(&f, zero, -up_or_down * sin(angle), up_or_down * cos(angle), 0);
        return s;
    }
    s.b = at(&f, s.p, aside + width * any(r), height * any(r), depth);
    s.c = at(&f, s.p, aside + width * any(r), height * any(r), depth);
    return s;
}

static o_vec3 wide(mcs_vec3 v) { return o_v3(v.x, v.y, v.z); }
static o_vec3 seen(const shape *s, mcs_vec3 v) { return o_add(wide(v), o_scale(-1.0L, wide(s->p))); }
static mcs_vec3 opposite(mcs_vec3 w) {
    const mcs_vec3 v = {-w.x, -w.y, -w.z};
    return v;
}
static double off(o_vec3 w, mcs_vec3 got) {
    return fmax(fabs((double)(w.x - (ld)got.x)),
                fmax(fabs((double)(w.y - (ld)got.y)), fabs((double)(w.z - (ld)got.z))));
}

/* Figures of the header for the sample s, in its units. The rounding of a coordinate is half of 2^-24; the rest is what
 * double loses. */
static void check_sample(const char *what, mcs_light_point s, o_light exact, ld pdf, float u1, float u2) {
    CHECK(off(exact.w, s.w) <= 1.1 * eps, "%s, u %a %a: w is off by %g x 2^-24", what, (double)u1, (double)u2,
          off(exact.w, s.w) / eps);
    CHECK(fabsl(o_len(wide(s.w)) - 1) <= 4 * eps, "%s, u %a %a: length", what, (double)u1, (double)u2);
    const double place = fmax(fabs((double)((ld)s.x - exact.x)), fabs((double)((ld)s.y - exact.y)));
    CHECK(place <= eps * 1.1, "%s, u %a %a: place %.9g %.9g, not %.9Lg %.9Lg", what, (double)u1, (double)u2,
          (double)s.x, (double)s.y, exact.x, exact.y);
    CHECK(fabsl((ld)s.pdf / pdf - 1) <= 0.2e-6L, "%s: pdf %.9g, not %.9Lg", what, (double)s.pdf, pdf);
    CHECK(fabsl((ld)s.distance / exact.distance - 1) <= 1e-7L, "%s, u %a %a: distance %.9g, not %.9Lg", what,
          (double)u1, (double)u2, (double)s.distance, exact.distance);
}
/* The exact inverse of the float w, while lights are so large that their own roundings are small. */
static void check_inverse(const char *what, mcs_vec2 u, o_vec2 exact) {
    CHECK(fabs((double)((ld)u.x - exact.x)) <= 2 * eps && fabs((double)((ld)u.y - exact.y)) <= 2 * eps,
          "%s: inverse %.9g %.9g, not %.9Lg %.9Lg", what, (double)u.x, (double)u.y, exact.x, exact.y);
}

static void rectangles(mcs_pcg32 *r, const kind *k) {
    for (int i = 0; i < LIGHTS; i++) {
        const shape s = any_shape(r, k, 1);
        const o_rectangle o = o_rectangle_make(seen(&s, s.a), wide(s.b), wide(s.c));
        const mcs_spherical_rectangle l = mcs_spherical_rectangle_make(s.p, s.a, s.b, s.c);
        const ld pdf = o_spherical_rectangle_pdf_u(o, 0, 0);
        for (int j = 0; j < DRAWS; j++) {
            const float u1 = any_u(r);
            const float u2 = any_u(r);
            const mcs_light_point d = mcs_spherical_rectangle_sample(&l, u1, u2);
            check_sample(k->name, d, o_rectangle_light(o, u1, u2), pdf, u1, u2);
            CHECK(mcs_spherical_rectangle_pdf(&l, d.w) == d.pdf && mcs_spherical_rectangle_pdf(&l, opposite(d.w)) == 0,
                  "%s: pdf of w and -w", k->name);
            if (o_spherical_rectangle_pdf(o, wide(d.w)) > 0 && o.width > 0.1L * o.z && o.height > 0.1L * o.z &&
                o.z > 0.1L * o.width)
                check_inverse(k->name, mcs_spherical_rectangle_invert(&l, d.w),
                              o_spherical_rectangle_invert(o, wide(d.w)));
        }
    }
}
static void triangles(mcs_pcg32 *r, const kind *k) {
    for (int i = 0; i < LIGHTS; i++) {
        const shape s = any_shape(r, k, 0);
        const o_triangle o = o_triangle_make(seen(&s, s.a), seen(&s, s.b), seen(&s, s.c));
        const mcs_spherical_triangle l = mcs_spherical_triangle_make(s.p, s.a, s.b, s.c);
        const ld pdf = o_spherical_triangle_pdf_u(o, 0, 0);
        if (!(pdf < 1e12L)) continue;
        for (int j = 0; j < DRAWS; j++) {
            const float u1 = any_u(r);
            const float u2 = any_u(r);
            const mcs_light_point d = mcs_spherical_triangle_sample(&l, u1, u2);
            check_sample(k->name, d, o_triangle_light(o, u1, u2), pdf, u1, u2);
            CHECK(1 - d.x - d.y >= 0 && d.x >= 0 && d.y >= 0, "%s: weights %.9g %.9g", k->name, (double)d.x,
                  (double)d.y);
            CHECK(mcs_spherical_triangle_pdf(&l, d.w) == d.pdf && mcs_spherical_triangle_pdf(&l, opposite(d.w)) == 0,
                  "%s: pdf of w and -w", k->name);
            if (o_spherical_triangle_pdf(o, wide(d.w)) > 0 && pdf < 10) {
                const o_vec2 exact = o_spherical_triangle_invert(o, wide(d.w));
                if (exact.y > 0.01L) check_inverse(k->name, mcs_spherical_triangle_invert(&l, d.w), exact);
            }
        }
    }
}

/* --- balls and disks ---------------------------------------------------------------------------------------------- */

static mcs_vec3 plus(mcs_vec3 v, mcs_vec3 w) {
    const mcs_vec3 sum = {v.x + w.x, v.y + w.y, v.z + w.z};
    return sum;
}
static mcs_vec3 any_place(mcs_pcg32 *r, double size) {
    const mcs_vec3 v = {(float)(size * any(r)), (float)(size * any(r)), (float)(size * any(r))};
    return v;
}
static mcs_vec3 any_on_grid(mcs_pcg32 *r, double size) {
    const mcs_vec3 v = any_place(r, size);
    const mcs_vec3 on_grid = {floorf(v.x * 1024) / 1024, floorf(v.y * 1024) / 1024, floorf(v.z * 1024) / 1024};
    return on_grid;
}
static int same_light(mcs_light a, mcs_light b) {
    return a.w.x == b.w.x && a.w.y == b.w.y && a.w.z == b.w.z && a.pdf == b.pdf && a.distance == b.distance;
}
/* On a grid whose sums are floats, p and the light may be moved together. */
static void moved_together(mcs_pcg32 *r) {
    const mcs_vec3 zero = {0, 0, 0};
    for (int i = 0; i < 20000; i++) {
        const mcs_vec3 c = any_on_grid(r, 4);
        const mcs_vec3 p = any_on_grid(r, 1000);
        const mcs_vec3 moved = plus(p, c);
        const mcs_vec3 n = mcs_sphere_sample(mcs_pcg32_float(r), mcs_pcg32_float(r)).w;
        const float radius = (float)pick(r, 1e-3, 10);
        const float u1 = any_u(r);
        const float u2 = any_u(r);
        const mcs_light ball = mcs_ball_sample(p, moved, radius, u1, u2);
        const mcs_light disk = mcs_disk_light_sample(p, moved, n, radius, u1, u2);
        CHECK(same_light(ball, mcs_ball_sample(zero, c, radius, u1, u2)) &&
                  same_light(disk, mcs_disk_light_sample(zero, c, n, radius, u1, u2)),
              "samples, u %a %a", (double)u1, (double)u2);
        CHECK(mcs_ball_pdf(p, moved, radius, disk.w) == mcs_ball_pdf(zero, c, radius, disk.w) &&
                  mcs_disk_light_pdf(p, moved, n, radius, ball.w) == mcs_disk_light_pdf(zero, c, n, radius, ball.w),
              "densities, u %a %a", (double)u1, (double)u2);
        const mcs_vec2 in_ball = mcs_ball_invert(p, moved, radius, ball.w);
        const mcs_vec2 in_disk = mcs_disk_light_invert(p, moved, n, radius, disk.w);
        const mcs_vec2 want_ball = mcs_ball_invert(zero, c, radius, ball.w);
        const mcs_vec2 want_disk = mcs_disk_light_invert(zero, c, n, radius, disk.w);
        CHECK(in_ball.x == want_ball.x && in_ball.y == want_ball.y && in_disk.x == want_disk.x &&
                  in_disk.y == want_disk.y,
              "inverses, u %a %a", (double)u1, (double)u2);
    }
}
/* Where centre - p is no float, it is not rounded to one: density and distance are rounded once, which moves them by
 * 2^-24 of themselves, and are good to 1e-8 before. */
static void away_from_origin(mcs_pcg32 *r) {
    for (int i = 0; i < 20000; i++) {
        const mcs_vec3 p = any_place(r, 1);
        const mcs_vec3 centre = plus(any_place(r, 100), p);
        const o_vec3 to_centre = o_add(wide(centre), o_scale(-1.0L, wide(p)));
        const mcs_vec3 n = mcs_sphere_sample(mcs_pcg32_float(r), mcs_pcg32_float(r)).w;
        const float radius = (float)((double)o_len(to_centre) * pick(r, 1e-4, 0.5));
        const float u1 = mcs_pcg32_float(r);
        const float u2 = mcs_pcg32_float(r);
        const mcs_light ball = mcs_ball_sample(p, centre, radius, u1, u2);
        const o_vec3 w = o_ball_map(to_centre, (ld)radius, (ld)u1, (ld)u2);
        const ld pdf = o_ball_pdf_u(to_centre, (ld)radius, (ld)u1, (ld)u2);
        CHECK(fabsl((ld)ball.pdf / pdf - 1) <= 7e-8L &&
                  fabsl((ld)mcs_ball_pdf(p, centre, radius, ball.w) / pdf - 1) <= 7e-8L &&
                  fabsl((ld)ball.distance / o_ball_distance(to_centre, (ld)radius, w) - 1) <= 7e-8L &&
                  off(w, ball.w) <= 2.5 * eps,
              "a ball, u %a %a: %.9g %.9g", (double)u1, (double)u2, (double)ball.pdf, (double)ball.distance);
        const o_vec3 place = o_disk_light_point(to_centre, wide(n), (ld)radius, (ld)u1, (ld)u2);
        if (fabsl(o_dot(o_unit(place), wide(n))) < 1e-3L) continue;
        const mcs_light disk = mcs_disk_light_sample(p, centre, n, radius, u1, u2);
        CHECK(fabsl((ld)disk.distance / o_len(place) - 1) <= 7e-8L && off(o_unit(place), disk.w) <= eps,
              "a disk, u %a %a: distance %.9g, not %.9Lg", (double)u1, (double)u2, (double)disk.distance, o_len(place));
    }
}

/* Lengths that MCS_ASSERT takes for 1 do not move a direction over the rim of a ball: by 1e-4 of its 1 - cos it stays
 * inside, or outside. */
static void rim_by_lengths(mcs_pcg32 *r) {
    const mcs_vec3 zero = {0, 0, 0};
    const float lengths[4] = {0.9996f, 1 - 0x1p-20f, 1 + 0x1p-20f, 1.0004f};
    for (int i = 0; i < 20000; i++) {
        const mcs_vec3 c = any_place(r, 4);
        const float radius = (float)((double)o_len(wide(c)) * (1 - pick(r, 1e-6, 0.99)));
        const float u2 = any_u(r);
        const o_vec3 in = o_ball_map(wide(c), (ld)radius, 0.9999L, (ld)u2);
        const o_vec3 out = o_ball_map(wide(c), (ld)radius, 1.0001L, (ld)u2);
        const ld length = (ld)lengths[i % 4];
        const mcs_vec3 w_in = {(float)(length * in.x), (float)(length * in.y), (float)(length * in.z)};
        const mcs_vec3 w_out = {(float)(length * out.x), (float)(length * out.y), (float)(length * out.z)};
        const float pdf = mcs_ball_sample(zero, c, radius, 0.5f, u2).pdf;
        CHECK(mcs_ball_pdf(zero, c, radius, w_in) == pdf && mcs_ball_pdf(zero, c, radius, w_out) == 0,
              "radius %.9g, length %.9Lg, u2 %a: %.9g inside, %.9g outside", (double)radius, length, (double)u2,
              (double)mcs_ball_pdf(zero, c, radius, w_in), (double)mcs_ball_pdf(zero, c, radius, w_out));
    }
}

/* --- no light at all ---------------------------------------------------------------------------------------------- */

/* pdf 0, and a unit direction to a place on the light. */
static void check_dark(const char *what, mcs_light_point s, float pdf, mcs_vec2 u) {
    const ld length = o_len(wide(s.w));
    CHECK(s.pdf == 0 && s.distance == 0 && pdf == 0, "%s: pdf %g, of +z %g, distance %g", what, (double)s.pdf,
          (double)pdf, (double)s.distance);
    CHECK(fabsl(length - 1) <= 4 * eps, "%s: %g %g %g", what, (double)s.w.x, (double)s.w.y, (double)s.w.z);
    CHECK(s.x >= 0 && s.x <= 1 && s.y >= 0 && s.y <= 1, "%s: at %g %g", what, (double)s.x, (double)s.y);
    CHECK(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1, "%s: inverse %g %g", what, (double)u.x, (double)u.y);
}
static void dark(const char *what, shape s) {
    const mcs_vec3 up = {0, 0, 1};
    const mcs_spherical_rectangle q = mcs_spherical_rectangle_make(s.p, s.a, s.b, s.c);
    const mcs_spherical_triangle t = mcs_spherical_triangle_make(s.p, s.a, s.b, s.c);
    for (int i = 0; i < 9; i++) {
        const float u1 = i % 3 < 2 ? 0.5f * (float)(i % 3) : 1 - 0x1p-24f;
        const float u2 = i / 3 < 2 ? 0.5f * (float)(i / 3) : 1 - 0x1p-24f;
        check_dark(what, mcs_spherical_rectangle_sample(&q, u1, u2), mcs_spherical_rectangle_pdf(&q, up),
                   mcs_spherical_rectangle_invert(&q, up));
        check_dark(what, mcs_spherical_triangle_sample(&t, u1, u2), mcs_spherical_triangle_pdf(&t, up),
                   mcs_spherical_triangle_invert(&t, up));
    }
}
/* In the plane of a light: beside it, on it, on a side and at a corner; then lights without an area; then numbers that
 * are not finite, in each place. Edges and corners are told apart by nobody here: b and c are both. */
static void no_lights(void) {
    static const shape in_plane[] = {{{5, 0, 1}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                     {{0.25f, 0.25f, 1}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                     {{0.5f, 0, 1}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                     {{0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 4; i++) {
        shape s = in_plane[i];
        const mcs_spherical_rectangle q = mcs_spherical_rectangle_make(s.p, s.a, s.b, s.c);
        check_dark("in the plane", mcs_spherical_rectangle_sample(&q, 0.3f, 0.6f), mcs_spherical_rectangle_pdf(&q, s.b),
                   mcs_spherical_rectangle_invert(&q, s.b));
        s.b.z = s.c.z = 1;
        const mcs_spherical_triangle t = mcs_spherical_triangle_make(s.p, s.a, s.b, s.c);
        check_dark("in the plane", mcs_spherical_triangle_sample(&t, 0.3f, 0.6f), mcs_spherical_triangle_pdf(&t, s.b),
                   mcs_spherical_triangle_invert(&t, s.b));
    }
    const mcs_vec3 zero = {0, 0, 0};
    const shape good = {{0, 0, 0}, {1, 0, 2}, {2, 0, 4}, {3, 0, 6}};
    dark("a line", good);
    shape s = good;
    s.b = s.c = s.a = zero;
    dark("a point", s);
    for (int i = 0; i < 36; i++) {
        s = good;
        s.c.y = 1;
        float *const number[12] = {&s.p.x, &s.p.y, &s.p.z, &s.a.x, &s.a.y, &s.a.z,
                                   &s.b.x, &s.b.y, &s.b.z, &s.c.x, &s.c.y, &s.c.z};
        *number[i % 12] = bad[i / 12];
        dark("not finite", s);
    }
}
/* The same in planes that are turned anyhow, with all digits of floats: p is an exact sum of the corner and of 32nds of
 * the edges, on the light or beside it. */
static void in_turned_planes(mcs_pcg32 *r) {
    const mcs_vec3 up = {0, 0, 1};
    for (int found = 0; found < 200;) {
        float v[12]; /* p, a corner, two edges */
        float corner[6];
        int exact = 1;
        const float x = floorf(64 * mcs_pcg32_float(r)) / 32 - 1;
        const float y = floorf(64 * mcs_pcg32_float(r)) / 32 - 1;
        for (int k = 3; k < 12; k++) v[k] = (float)any(r);
        for (int k = 0; k < 3; k++) {
            const double p = (double)v[3 + k] + (double)x * (double)v[6 + k] + (double)y * (double)v[9 + k];
            v[k] = (float)p;
            exact &= (double)v[k] == p;
            for (int j = 0; j < 2; j++) {
                const double place = (double)v[3 + k] + (double)v[6 + 3 * j + k];
                corner[3 * j + k] = (float)place;
                exact &= (double)corner[3 * j + k] == place;
            }
        }
        if (!exact) continue;
        found++;
        const mcs_vec3 at_p = vec3(v);
        const mcs_vec3 a = vec3(v + 3);
        const mcs_spherical_rectangle q = mcs_spherical_rectangle_make(at_p, a, vec3(v + 6), vec3(v + 9));
        check_dark("rectangle", mcs_spherical_rectangle_sample(&q, 0.3f, 0.6f), mcs_spherical_rectangle_pdf(&q, up),
                   mcs_spherical_rectangle_invert(&q, up));
        const mcs_spherical_triangle t = mcs_spherical_triangle_make(at_p, a, vec3(corner), vec3(corner + 3));
        check_dark("triangle", mcs_spherical_triangle_sample(&t, 0.3f, 0.6f), mcs_spherical_triangle_pdf(&t, up),
                   mcs_spherical_triangle_invert(&t, up));
    }
}
/* Triangles with a corner far beyond the others, where p is next to a side: each corner in turn is the far one. The
 * angle of p and that side is a hundredth at least, so that double leaves 1e-13 of the solid angle. */
static void far_corners(mcs_pcg32 *r) {
    const mcs_vec3 zero = {0, 0, 0};
    for (int i = 0; i < 600; i++) {
        const double far_off = pow(10, i / 40 + 3);
        const mcs_vec3 away = mcs_sphere_sample(mcs_pcg32_float(r), mcs_pcg32_float(r)).w;
        const mcs_frame f = mcs_frame_make(away);
        const double turn = 3 * any(r);
        mcs_vec3 corner[5];
        corner[0] = at(&f, zero, 0, 0, far_off);
        corner[1] = at(&f, zero, pick(r, 0.01, 1), 0, -1);
        corner[2] = at(&f, zero, cos(turn), (sin(turn) < 0 ? -0.1 : 0.1) + sin(turn), any(r));
        corner[3] = corner[0];
        corner[4] = corner[1];
        const mcs_vec3 *v = corner + i % 3;
        const mcs_spherical_triangle t = mcs_spherical_triangle_make(zero, v[0], v[1], v[2]);
        const o_vec3 a = o_unit(wide(v[0]));
        const o_vec3 b = o_unit(wide(v[1]));
        const o_vec3 c = o_unit(wide(v[2]));
        const ld angle = o_solid_angle(o_volume(a, b, c), a, b, c);
        const mcs_light_point s = mcs_spherical_triangle_sample(&t, any_u(r), any_u(r));
        CHECK(fabsl((ld)s.pdf * angle - 1) <= 0.2e-6L, "corner %d at %g: pdf %.9g, not %.9Lg", i % 3, far_off,
              (double)s.pdf, 1 / angle);
        CHECK(fabsl(o_len(wide(s.w)) - 1) <= 4 * eps, "corner %d at %g: length", i % 3, far_off);
        /* In the middle w is 1e-3 from each side at least: its rounding moves u by less than 2^-24 / 1e-3. */
        const mcs_vec3 w = mcs_spherical_triangle_sample(&t, 0.5f, 0.5f).w;
        const mcs_vec2 u = mcs_spherical_triangle_invert(&t, w);
        CHECK(mcs_spherical_triangle_pdf(&t, w) == s.pdf, "corner %d at %g: pdf of the middle", i % 3, far_off);
        CHECK(fabsf(u.x - 0.5f) < 1e-4f && fabsf(u.y - 0.5f) < 1e-4f, "corner %d at %g: inverse %.9g %.9g", i % 3,
              far_off, (double)u.x, (double)u.y);
    }
}
/* A disk whose density is below all floats counts as none: it has no distance either. */
static void faint_disk(void) {
    const mcs_vec3 p = {0, 0, 0};
    const mcs_vec3 centre = {2e-18f, -1e-18f, 4e-18f};
    const mcs_vec3 normal = {0.48f, 0.6f, -0.64f};
    const mcs_light s = mcs_disk_light_sample(p, centre, normal, 1e18f, 0.5f, 0.5f);
    CHECK(s.pdf == 0 && s.distance == 0, "%g %g", (double)s.pdf, (double)s.distance);
}
/* Balls and disks where p or the centre is not finite, or out of range. */
static void bad_places(void) {
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1.1e18f};
    const mcs_vec3 up = {0, 0, 1};
    for (int i = 0; i < 24; i++) {
        mcs_vec3 p = {1, 2, 3};
        mcs_vec3 centre = {3, 1, 2};
        float *const number[6] = {&p.x, &p.y, &p.z, &centre.x, &centre.y, &centre.z};
        *number[i % 6] = bad[i / 6];
        const mcs_light s[2] = {mcs_ball_sample(p, centre, 1, 0.3f, 0.6f),
                                mcs_disk_light_sample(p, centre, up, 1, 0.3f, 0.6f)};
        for (int k = 0; k < 2; k++)
            CHECK(s[k].pdf == 0 && s[k].distance == 0 && fabsl(o_len(wide(s[k].w)) - 1) <= 4 * eps,
                  "number %d, %g: pdf %g, distance %g", i % 6, (double)bad[i / 6], (double)s[k].pdf,
                  (double)s[k].distance);
        CHECK(mcs_ball_pdf(p, centre, 1, up) == 0 && mcs_disk_light_pdf(p, centre, up, 1, up) == 0, "number %d, %g",
              i % 6, (double)bad[i / 6]);
    }
}
/* Where p approaches the plane over the light, the solid angle approaches 2 pi. */
static void half_of_all(void) {
    const mcs_vec3 a = {-1, -1, 0};
    const mcs_vec3 edge_x = {3, 0, 0};
    const mcs_vec3 edge_y = {0, 3, 0};
    const mcs_vec3 b = {2, -1, 0};
    const mcs_vec3 c = {-1, 2, 0};
    for (int i = 0; i < 40; i++) {
        const mcs_vec3 p = {0, 0, (float)-pow(10, -i / 3.0)};
        const ld h = -(ld)p.z;
        const mcs_spherical_rectangle q = mcs_spherical_rectangle_make(p, a, edge_x, edge_y);
        const o_rectangle o = o_rectangle_make(o_vec(-1, -1, h), wide(edge_x), wide(edge_y));
        const mcs_light_point s = mcs_spherical_rectangle_sample(&q, 0.3f, 0.6f);
        if (h < 1e-8L) /* the truth has no more digits there */
            CHECK(fabsl(o_len(wide(s.w)) - 1) <= 4 * eps && fabsl((ld)s.pdf * 2 * O_PI - 1) <= 0.2e-6L,
                  "rectangle, %Lg over it", h);
        else
            check_sample("rectangle", s, o_rectangle_light(o, (ld)0.3f, (ld)0.6f), o_spherical_rectangle_pdf_u(o, 0, 0),
                         0.3f, 0.6f);
        const mcs_spherical_triangle t = mcs_spherical_triangle_make(p, a, b, c);
        const mcs_light_point d = mcs_spherical_triangle_sample(&t, 0.3f, 0.6f);
        const o_triangle ot = o_triangle_make(o_vec(-1, -1, h), o_vec(2, -1, h), o_vec(-1, 2, h));
        if (h >= 1e-7L)
            check_sample("triangle", d, o_triangle_light(ot, (ld)0.3f, (ld)0.6f), o_spherical_triangle_pdf_u(ot, 0, 0),
                         0.3f, 0.6f);
        else CHECK(fabsl(o_len(wide(d.w)) - 1) <= 4 * eps && (d.pdf == 0 || h > 5e-9L), "triangle, %Lg over it", h);
    }
}

/* --- densities ---------------------------------------------------------------------------------------------------- */

static void conversions(mcs_pcg32 *r) {
    static const float none[][3] = {{0, 2, 0.5f},    {3, 0, 0.5f},  {3, 2, 0},           {3, 2, -0.0f},
                                    {0, 0, 0},       {-1, 2, 0.5f}, {3, -2, 0.5f},       {NAN, 2, 0.5f},
                                    {3, NAN, 0.5f},  {3, 2, NAN},   {INFINITY, 2, 0.5f}, {3, INFINITY, 0.5f},
                                    {3, 2, INFINITY}};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        const float *x = none[i];
        CHECK(mcs_pdf_to_solid_angle(x[0], x[1], x[2]) == 0 && mcs_pdf_to_area(x[0], x[1], x[2]) == 0, "%g %g %g",
              (double)x[0], (double)x[1], (double)x[2]);
    }
    CHECK(mcs_pdf_to_solid_angle(3, 2, -0.5f) == 24 && mcs_pdf_to_area(24, 2, 0.5f) == 3, "24 and 3");
    CHECK(mcs_pdf_to_solid_angle(1e30f, 1e30f, 1e-30f) == FLT_MAX && mcs_pdf_to_area(1e30f, 1e-30f, 1) == FLT_MAX,
          "more than any float");
    for (int i = 0; i < 100000; i++) {
        const float pdf = (float)pick(r, 1e-12, 1e12);
        const float distance = (float)pick(r, 1e-6, 1e6);
        const float cosine = (float)(any(r) * pick(r, 1e-8, 1));
        const double g = (double)distance * (double)distance / fabs((double)cosine);
        const float to = mcs_pdf_to_solid_angle(pdf, distance, cosine);
        const float back = mcs_pdf_to_area(pdf, distance, cosine);
        CHECK(cosine == 0 || (fabs((double)to / ((double)pdf * g) - 1) <= 1.01 * eps &&
                              fabs((double)back / ((double)pdf / g) - 1) <= 1.01 * eps),
              "%g %g %g: %g and %g", (double)pdf, (double)distance, (double)cosine, (double)to, (double)back);
    }
}

/* --- widths ------------------------------------------------------------------------------------------------------- */

/* Distances and places on the light in lanes and arrays; what else there is, test_width looks at. */
#ifndef MCS_NO_WIDE
#define PLACES(W)                                                                                                     \
    static void places##W(const shape *s, const float *u1, const float *u2, const mcs_light_point *want) {            \
        mcs##W##_vec3 v[4];                                                                                           \
        for (int i = 0; i < 4; i++) {                                                                                 \
            const mcs_vec3 *from = i == 0 ? &s->p : i == 1 ? &s->a : i == 2 ? &s->b : &s->c;                          \
            v[i].x = mcs##W##_set(from->x);                                                                           \
            v[i].y = mcs##W##_set(from->y);                                                                           \
            v[i].z = mcs##W##_set(from->z);                                                                           \
        }                                                                                                             \
        const mcs##W##_spherical_rectangle q = mcs##W##_spherical_rectangle_make(v[0], v[1], v[2], v[3]);             \
        const mcs##W##_spherical_triangle t = mcs##W##_spherical_triangle_make(v[0], v[1], v[2], v[3]);               \
        const mcs##W##_light_point a = mcs##W##_spherical_rectangle_sample(&q, mcs##W##_load(u1), mcs##W##_load(u2)); \
        const mcs##W##_light_point b = mcs##W##_spherical_triangle_sample(&t, mcs##W##_load(u1), mcs##W##_load(u2));  \
        for (int k = 0; k < W; k++)                                                                                   \
            CHECK(a.x[k] == want[k].x && a.y[k] == want[k].y && b.x[k] == want[16 + k].x &&                           \
                      b.y[k] == want[16 + k].y && a.distance[k] == want[k].distance &&                                \
                      b.distance[k] == want[16 + k].distance,                                                         \
                  #W " wide, lane %d: %.9g %.9g %.9g %.9g, distances %.9g %.9g", k, (double)a.x[k], (double)a.y[k],   \
                  (double)b.x[k], (double)b.y[k], (double)a.distance[k], (double)b.distance[k]);                      \
    }
PLACES(4)
PLACES(8)
PLACES(16)
#endif
static void check_places(mcs_pcg32 *r) {
    for (int i = 0; i < 200; i++) {
        const shape s = any_shape(r, &kinds[i % KINDS], i % 2);
        const mcs_spherical_rectangle q = mcs_spherical_rectangle_make(s.p, s.a, s.b, s.c);
        const mcs_spherical_triangle t = mcs_spherical_triangle_make(s.p, s.a, s.b, s.c);
        float u1[16];
        float u2[16];
        mcs_light_point want[32];
        for (int k = 0; k < 16; k++) {
            u1[k] = any_u(r);
            u2[k] = any_u(r);
            want[k] = mcs_spherical_rectangle_sample(&q, u1[k], u2[k]);
            want[16 + k] = mcs_spherical_triangle_sample(&t, u1[k], u2[k]);
        }
#ifndef MCS_NO_WIDE
        places4(&s, u1, u2, want);
        places8(&s, u1, u2, want);
        places16(&s, u1, u2, want);
#endif
        float got[32];
        float got_x[32];
        float got_y[32];
        mcs_spherical_rectangle_sample_n(&q, 13, u1, u2, NULL, NULL, NULL, NULL, got, got_x, got_y);
        mcs_spherical_triangle_sample_n(&t, 13, u1, u2, NULL, NULL, NULL, NULL, got + 16, got_x + 16, got_y + 16);
        for (int k = 0; k < 29; k++)
            CHECK((k > 12 && k < 16) || (got_x[k] == want[k].x && got_y[k] == want[k].y && got[k] == want[k].distance),
                  "arrays, %d: %.9g %.9g, distance %.9g", k, (double)got_x[k], (double)got_y[k], (double)got[k]);
    }
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcs_pcg32 r = mcs_pcg32_make(mcst.seed, 317);
    mcst_group("lights");
    for (int i = 0; i < KINDS; i++) {
        if (mcst_case("rectangle, %s", kinds[i].name)) rectangles(&r, &kinds[i]);
        if (mcst_case("triangle, %s", kinds[i].name)) triangles(&r, &kinds[i]);
    }
    if (mcst_case("half of all directions")) half_of_all();
    if (mcst_contracts()) puts("SKIPPED: the bits of balls and disks that are moved, as this build contracts a*b + c");
    else if (mcst_case("balls and disks, moved with p")) moved_together(&r);
    if (mcst_case("balls and disks, away from the origin")) away_from_origin(&r);
    if (mcst_case("the rim of balls, by lengths")) rim_by_lengths(&r);
    if (mcst_case("no light")) no_lights();
    if (mcst_case("in planes that are turned")) in_turned_planes(&r);
    if (mcst_case("a far corner")) far_corners(&r);
    if (mcst_case("a disk too faint")) faint_disk();
    if (mcst_case("balls and disks, bad places")) bad_places();
    if (mcst_case("per area and per solid angle")) conversions(&r);
    if (mcst_arrays_contract()) puts("SKIPPED: the bits of lanes and arrays, as this build contracts a*b + c");
    else if (mcst_case("places in lanes and arrays")) check_places(&r);
    return mcst_finish();
}
