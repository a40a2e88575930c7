/* The grid of fireflies.c: pictures, materials, normals and eyes. */
#ifndef MCST_FIREFLIES_GRID_H
#define MCST_FIREFLIES_GRID_H
#include "../../examples/hdr.h"
#include "fireflies_worth.h"

/* The variance is that of MIS at most, where it is not smaller than its own errors. Of lobes that are narrower than the
 * cells of grids, MIS takes one sample for certain where the product's share is a matter of chance: what they exceed
 * MIS by is what was found, with half of it added. */
#define ERROR 0.005
static const material materials[] = {
    {"matte", MATTE, 0, 0, 1, 1.1, ERROR},
    {"GGX 0.5", GGX, 0.5f, 0.5f, 0, 1.1, ERROR},
    {"GGX 0.2", GGX, 0.2f, 0.2f, 0, 1.1, ERROR},
    {"GGX 0.1", GGX, 0.1f, 0.1f, 0, 1.1, ERROR},
    {"GGX 0.05", GGX, 0.05f, 0.05f, 0, 2.5, 0.07},
    {"GGX 0.02", GGX, 0.02f, 0.02f, 0, 2.5, 1.5},
    {"Ward 0.2, 0.05", WARD, 0.2f, 0.05f, 0, 5, 0.1},
    {"Phong 50", PHONG, 50, 50, 0, 1.1, 0.1},
    {"Phong 500", PHONG, 500, 500, 0, 3, 0.6},
    {"A.-S. 100, 10", ASHIKHMIN, 100, 10, 0, 1.1, ERROR},
    {"matte, GGX 0.1", GGX, 0.1f, 0.1f, 0.5f, 1.1, ERROR},
};
enum { MATERIALS = (int)(sizeof materials / sizeof *materials), NORMALS = 16, EYES = 3 };

/* ---- pictures that were made up: radiance by texel ---- */

typedef float (*light_fn)(double up, double turn, uint32_t row, uint32_t col);

/* Even light, and a lamp within one of 16 x 32 tiles. */
static inline float lamp_light(double up, double turn, uint32_t row, uint32_t col) {
    (void)up;
    (void)turn;
    return col >= 4 && col < 12 && row >= 116 && row < 124 ? 1000.0f : 1.0f;
}
/* A low sun that stands half below the map's own horizon, and what it lights. */
static inline float sunset_light(double up, double turn, uint32_t row, uint32_t col) {
    if (col >= 100 && col < 102 && row >= 127 && row < 129) return 1e5f;
    return (float)(up > 0 ? (1 - 0.8 * up) * (1.5 + cos(2 * pi * (turn - 0.2))) : 0.05);
}
static inline float two_light(double up, double turn, uint32_t row, uint32_t col) {
    (void)up;
    (void)turn;
    return row == 80 && col == 100 ? 1000.0f : row == 120 && col == 300 ? 1.0f : 0.0f;
}
static inline float sky_light(double up, double turn, uint32_t row, uint32_t col) {
    if (row == 75 && col == 333) return 3e5f;
    return (float)(up > 0 ? 0.6 + 0.4 * (1 - up) + 0.2 * cos(2 * pi * turn) * (1 - up) : 0.15);
}
static inline float room_light(double up, double turn, uint32_t row, uint32_t col) {
    const int window = row >= 100 && row < 124 && col % 128 >= 20 && col % 128 < 34 && col < 384;
    return window ? 20.0f : (float)(0.01 * (1.2 + up + 0.1 * cos(12 * pi * turn)));
}
static const struct {
    const char *name;
    light_fn light;
} made_up[] = {
    {"lamp", lamp_light}, {"sunset", sunset_light}, {"two texels", two_light}, {"sky", sky_light}, {"room", room_light},
};
enum { MADE_UP = (int)(sizeof made_up / sizeof *made_up) };

static inline picture picture_made_up(int k) {
    picture m = picture_make(made_up[k].name, 512, 256);
    for (uint32_t row = 0; row < m.h; row++)
        for (uint32_t col = 0; col < m.w; col++)
            m.light[(size_t)row * m.w + col] =
                made_up[k].light(0.5 * (m.z[row] + m.z[row + 1]), (col + 0.5) / m.w, row, col);
    picture_finish(&m);
    return m;
}
/* The luminance of a Radiance picture, by means of n x n pixels. */
static inline picture picture_read(const char *file, uint32_t n) {
    const char *folder = strrchr(file, '/');
    hdr_picture p;
    const int ok = hdr_read(&p, file) && p.w >= n && p.h >= n;
    CHECK(ok, "%s: %s", file, p.fault);
    picture m = picture_make(folder ? folder + 1 : file, ok ? p.w / n : 2, ok ? p.h / n : 1);
    for (size_t row = 0; ok && row < m.h * n; row++)
        for (size_t col = 0; col < m.w * n; col++) {
            float c[3];
            hdr_color(&p, row * p.w + col, c);
            m.light[row / n * m.w + col / n] += (0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2]) / (float)(n * n);
        }
    if (ok) free(p.pixel);
    picture_finish(&m);
    return m;
}

/* ---- surfaces ---- */

static inline mcs_vec3 unit(double x, double y, double z) {
    const double length = sqrt(x * x + y * y + z * z);
    const mcs_vec3 w = {(float)(x / length), (float)(y / length), (float)(z / length)};
    return w;
}
static inline mcs_vec3 from_angles(double z, double turn) {
    const double sine = sqrt(fmax(1 - z * z, 0));
    return unit(sine * cos(2 * pi * turn), sine * sin(2 * pi * turn), z);
}
/* The first half is spread over the sphere by the golden angle. The others have the brightest light at the horizon, 3
 * or 0.4 degrees above or below it. */
static inline mcs_vec3 normal_at(const picture *m, int k) {
    static const double tilt[4] = {-3, -0.4, 0.4, 3};
    if (k < NORMALS / 2) return from_angles(1 - (2 * k + 1.0) / (NORMALS / 2), 0.381966 * k);
    const double up = tilt[k % 4] * pi / 180;
    const mcs_frame f = mcs_frame_make(m->brightest);
    return mcs_to_world(&f, from_angles(sin(up), 0.1 + 0.15 * k));
}
/* Three inclinations. Where light is at the horizon, the last two have it near the plane of the mirror direction. */
static inline mcs_vec3 eye_at(const picture *m, const mcs_frame *f, int normal, int k) {
    static const double cosine[EYES] = {0.92, 0.5, 0.12};
    const mcs_vec3 light = mcs_to_local(f, m->brightest);
    double turn = 0.618034 * (3 * normal + k);
    if (normal >= NORMALS / 2 && k > 0) turn = atan2(-(double)light.y, -(double)light.x) / (2 * pi) + 0.004 * normal;
    return from_angles(cosine[k], turn);
}
static inline point point_at(const picture *m, int k, int normal, int eye, mcs_product *memory_of_it) {
    point s;
    memset(&s, 0, sizeof s);
    s.m = m;
    s.made_of = materials[k];
    s.r.frame = mcs_frame_make(normal_at(m, normal));
    s.r.wo = eye_at(m, &s.r.frame, normal, eye);
    reflection_set(&s);
    CHECK(product_set(&s, memory_of_it), "%s: no product", m->name);
    return s;
}
#endif
