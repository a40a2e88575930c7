/* What the header says of balls and disks that give light, as they are seen from the origin. Elsewhere, and rectangles
 * and triangles: test_lights.c. */
#include "values.h"

static const mcs_vec3 origin = {0, 0, 0};

/* ---- balls ---- */

/* A centre within 1 of the point by coordinate; some lie nearly along z, or nearly across it. */
static mcs_vec3 any_centre(uint64_t *state) {
    float u[4];
    mcst_uniform(state, 2, u, u + 2);
    mcs_vec3 c = {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
    if (u[3] < 0.2f) c.z *= 1e-6f;
    if (u[3] > 0.8f) {
        c.x *= 1e-6f;
        c.y *= 1e-6f;
    }
    return c;
}

/* What the header says of a ball whose radius is `ratio` times the distance of its centre, of random numbers and of those
 * at the rim. Density and distance are rounded once, and are good to 1e-8 before. */
static void balls(double least, double most) {
    uint64_t state = mcst_seed_for("ball", "values", (size_t)(1e3 * least));
    for (int i = 0; i < 200000; i++) {
        float u[2];
        float v[2];
        const mcs_vec3 c = any_centre(&state);
        const o_vec3 centre = o_v3(c.x, c.y, c.z);
        mcst_uniform(&state, 2, u, v);
        const double log_ratio = log(least) + (double)v[0] * log(most / least);
        const double ratio = least > 0.5 && i % 2 ? most - (most - least) * pow(1e-7, (double)v[0]) : exp(log_ratio);
        const float r = (float)(ratio * (double)o_len(centre));
        if (i % 8 == 0) u[0] = 1 - 0x1p-24f;
        const mcs_light s = mcs_ball_sample(origin, c, r, u[0], u[1]);
        const float pdf = mcs_ball_pdf(origin, c, r, s.w);
        const o_vec3 w = o_ball_map(centre, (ld)r, (ld)u[0], (ld)u[1]);
        const o_vec3 off = o_add(o_v3(s.w.x, s.w.y, s.w.z), o_scale(-1, w));
        const ld err = fmaxl(fmaxl(fabsl(off.x), fabsl(off.y)), fabsl(off.z));
        const ld want = o_ball_pdf_u(centre, (ld)r, (ld)u[0], (ld)u[1]);
        const ld distance = o_ball_distance(centre, (ld)r, w);
        CHECK(err <= 1.25 * 2 * EPS && relative(s.pdf, want) <= 7e-8L && relative(pdf, want) <= 7e-8L &&
                  relative(s.distance, distance) <= 7e-8L,
              "c (%a, %a, %a), r %a, u %a %a: w off by %Lg, pdf %.9g and %.9g, not %.9Lg, distance %.9g, not %.9Lg",
              (double)c.x, (double)c.y, (double)c.z, (double)r, (double)u[0], (double)u[1], err, (double)s.pdf,
              (double)pdf, want, (double)s.distance, distance);
    }
}

/* On the surface, and in the middle; just past the rim; a ball that is too small; one that hardly fits into floats. */
static void ends_of_balls(void) {
    const mcs_vec3 ahead = {0, 0, 1};
    const mcs_vec3 at = {0, 0, 0};
    for (int i = 0; i < 100; i++) {
        const float u1 = (float)i / 100;
        const mcs_light on = mcs_ball_sample(origin, ahead, 1, u1, 0.3f);
        const mcs_light in = mcs_ball_sample(origin, at, 3, u1, 0.3f);
        CHECK(relative(on.pdf, 0.25L / O_PI) <= EPS && fabsf(on.distance - 2 * fmaxf(1 - 2 * u1, 0)) <= 2 * (float)EPS,
              "on the surface, u1 = %g: pdf %.9g, distance %.9g", (double)u1, (double)on.pdf, (double)on.distance);
        CHECK(in.pdf == on.pdf && in.distance == 3 && fabsf(in.w.z - (1 - 2 * u1)) <= 2 * (float)EPS,
              "in the middle, u1 = %g: pdf %.9g, distance %.9g", (double)u1, (double)in.pdf, (double)in.distance);
    }
    for (int i = 0; i < 6; i++) {
        const float r = (float)pow(10, -i);
        const double rim = asin((double)r / 2);
        const mcs_vec3 c = {0, 0, 2};
        const mcs_vec3 inside = {(float)sin(rim + 0x1p-25), 0, (float)cos(rim + 0x1p-25)};
        const mcs_vec3 past = {(float)sin(rim * (1 + 1e-6) + 0x1p-22), 0, (float)cos(rim * (1 + 1e-6) + 0x1p-22)};
        CHECK(mcs_ball_pdf(origin, c, r, inside) > 0 && mcs_ball_pdf(origin, c, r, past) == 0,
              "r = %g: pdf %g past the rim", (double)r, (double)mcs_ball_pdf(origin, c, r, past));
    }
    const mcs_light speck = mcs_ball_sample(origin, ahead, 1e-18f, 0.5f, 0.5f);
    CHECK(relative(speck.pdf, 1 / (O_PI * 1e-30L)) <= 1e-6L && speck.distance == 1 && speck.w.z == 1,
          "a speck: pdf %g, distance %.9g", (double)speck.pdf, (double)speck.distance);
    const mcs_vec3 far_away = {-1e18f, 1e18f, -1e18f};
    const mcs_light sun = mcs_ball_sample(origin, far_away, 1e18f, 0.5f, 0.5f);
    CHECK(sun.distance > 7e17f && sun.distance < 1.8e18f && sun.pdf > 0, "a sun: pdf %g, distance %g", (double)sun.pdf,
          (double)sun.distance);
}

/* ---- disks ---- */

/* What the header says of a disk whose radius is `ratio` times the distance of its centre. `level` of the height of that
 * above the point is taken away, so that some disks are seen from their edge. */
static void disk_lights(double ratio, float level) {
    uint64_t state = mcst_seed_for("disk_light", "values", (size_t)(1e3 * ratio));
    for (int i = 0; i < 100000; i++) {
        float u[2];
        float v[2];
        mcst_uniform(&state, 2, u, v);
        const mcs_vec3 n = mcs_sphere_sample(v[0], v[1]).w;
        mcs_vec3 c = any_centre(&state);
        const float r = (float)(ratio * (double)o_len(o_v3(c.x, c.y, c.z)));
        const float height = level * (c.x * n.x + c.y * n.y + c.z * n.z);
        c.x -= height * n.x;
        c.y -= height * n.y;
        c.z -= height * n.z;
        const o_vec3 centre = o_v3(c.x, c.y, c.z);
        const o_vec3 normal = o_v3(n.x, n.y, n.z);
        const o_vec3 w = o_disk_light_map(centre, normal, (ld)r, (ld)u[0], (ld)u[1]);
        const ld distance = o_len(o_disk_light_point(centre, normal, (ld)r, (ld)u[0], (ld)u[1]));
        if (distance < 1e-4L * (ld)r || fabsl(o_dot(w, normal)) < 1.1e-7L) continue;
        const mcs_light s = mcs_disk_light_sample(origin, c, n, r, u[0], u[1]);
        const o_vec3 off = o_add(o_v3(s.w.x, s.w.y, s.w.z), o_scale(-1, w));
        const ld err = fmaxl(fmaxl(fabsl(off.x), fabsl(off.y)), fabsl(off.z));
        const ld want = o_disk_light_pdf_u(centre, normal, (ld)r, (ld)u[0], (ld)u[1]);
        const ld want_w = o_disk_light_pdf(centre, normal, (ld)r, o_v3(s.w.x, s.w.y, s.w.z));
        const float pdf = mcs_disk_light_pdf(origin, c, n, r, s.w);
        CHECK(err <= EPS && relative(s.pdf, want) <= 1e-7L && relative(s.distance, distance) <= 1e-7L,
              "c (%a, %a, %a), r %a, u %a %a: w off by %Lg, pdf %.9g, not %.9Lg, distance %.9g, not %.9Lg", (double)c.x,
              (double)c.y, (double)c.z, (double)r, (double)u[0], (double)u[1], err, (double)s.pdf, want,
              (double)s.distance, distance);
        if (fabsl(o_dot(w, normal)) > 1e-6L)
            CHECK(relative(pdf, want_w) <= 1e-7L, "c (%a, %a, %a), r %a, u %a %a: pdf of w %.9g, not %.9Lg",
                  (double)c.x, (double)c.y, (double)c.z, (double)r, (double)u[0], (double)u[1], (double)pdf, want_w);
    }
}

/* In the plane, in the middle, behind, past the rim, and where floats end. */
static void ends_of_disk_lights(void) {
    const mcs_vec3 up = {0, 0, 1};
    const mcs_vec3 down = {0, 0, -1};
    const mcs_vec3 at = {0, 0, 0};
    const mcs_vec3 beside = {2, 0, 0};
    const mcs_vec3 above = {0, 0, 2};
    const mcs_light edge = mcs_disk_light_sample(origin, beside, up, 1, 0.3f, 0.6f);
    const mcs_light middle = mcs_disk_light_sample(origin, at, up, 1, 0.5f, 0.5f);
    CHECK(edge.pdf == 0 && edge.distance == 0 && edge.w.x > 0.8f && edge.w.z == 0, "from its plane: %g %g %g, pdf %g",
          (double)edge.w.x, (double)edge.w.y, (double)edge.w.z, (double)edge.pdf);
    CHECK(middle.pdf == 0 && middle.distance == 0 && middle.w.z == 1, "from its middle: %g, pdf %g", (double)middle.w.z,
          (double)middle.pdf);
    CHECK(mcs_disk_light_pdf(origin, beside, up, 1, vec3((const float[]){1, 0, 0})) == 0, "along its plane");
    CHECK(relative(mcs_disk_light_pdf(origin, above, up, 1, up), 4 / O_PI) <= 1e-7L &&
              relative(mcs_disk_light_pdf(origin, above, down, 1, up), 4 / O_PI) <= 1e-7L &&
              mcs_disk_light_pdf(origin, above, up, 1, down) == 0 &&
              mcs_disk_light_invert(origin, above, up, 1, down).x == 0,
          "from both sides, and behind: %g", (double)mcs_disk_light_pdf(origin, above, up, 1, down));
    const double rim = atan(0.5);
    const mcs_vec3 past = {(float)sin(rim + 1e-6), 0, (float)cos(rim + 1e-6)};
    const mcs_vec3 just = {(float)sin(rim), 0, (float)cos(rim)};
    CHECK(mcs_disk_light_pdf(origin, above, up, 1, just) > 0 && mcs_disk_light_pdf(origin, above, up, 1, past) == 0,
          "the rim");
    const mcs_vec3 far_away = {1e18f, -1e18f, 1e18f};
    const mcs_light speck = mcs_disk_light_sample(origin, far_away, up, 1e-18f, 0.5f, 0.5f);
    CHECK(speck.pdf > 1e29f && speck.pdf <= FLT_MAX && speck.distance > 1.7e18f, "a speck: pdf %g", (double)speck.pdf);
}

int main(int argc, char **argv) {
    static const double ratio[] = {1e-7, 1e-2, 1, 30, 3000};
    mcst_start(argc, argv);
    mcst_group("values, lights");
    if (mcst_case("balls from afar")) balls(1e-9, 0.5);
    if (mcst_case("balls nearby")) balls(0.5, 1);
    if (mcst_case("balls from inside")) balls(1, 2);
    if (mcst_case("balls from deep inside")) balls(2, 1e9);
    if (mcst_case("balls at their ends")) ends_of_balls();
    for (size_t i = 0; i < MCST_COUNT(ratio); i++)
        if (mcst_case("disks of %g", ratio[i])) disk_lights(ratio[i], 0);
    if (mcst_case("disks seen from their edge")) disk_lights(0.5, 0.9999f);
    if (mcst_case("disks at their ends")) ends_of_disk_lights();
    return mcst_finish();
}
