/* The baseline "text": the formulas as textbooks, papers and the lecture print them, in float, with libm; each gives a
 * sample and its density, and, where wo is given, the reflected direction with the density of that. Nothing here guards
 * against cancellation, overflow or u at the ends of its interval: that is what the comparison is about. Azimuths are
 * arctangents with the quadrant restored, sines and cosines are sinf(2 pi u) and cosf(2 pi u). 1 - u1 stands where the
 * sources write u, so that both sides map the same u to the same point.
 *
 * Sources: Phong lobe: Lafortune and Willems 1994. Ward: Ward 1992 with the arctangent that Walter 2005 restored. GGX
 * and Beckmann: Walter et al. 2007, equations 25 to 36; anisotropic: Burley 2012, appendix B. Visible normals: Heitz
 * 2018, listing 1. Bounded: Eto and Tokuyoshi 2023. Ashikhmin and Shirley 2000 (the exponent unsquared). Concentric
 * map: Shirley and Chiu 1997. Normal: Giles 2010, "Approximating the erfinv function". Frame: Duff et al. 2017.
 * Generator: O'Neill 2014. The rest: Pharr, Jakob, Humphreys 2023, appendix A. */
#ifndef BENCH_TEXT_H
#define BENCH_TEXT_H
#include <math.h>
#include <stdint.h>

#define TEXT_PI 3.14159265f

typedef struct {
    float x, y, z, pdf;
} text_sample;
typedef struct {
    float x, y, z;
} text_vec;

/* ---- one dimension ---- */

static inline text_sample text_line(float x, float pdf) {
    text_sample s;
    s.x = x;
    s.y = s.z = 0;
    s.pdf = pdf;
    return s;
}
static inline text_sample text_linear(float a, float b, float u) {
    const float x = a == b ? u : (a - sqrtf(a * a + (b * b - a * a) * u)) / (a - b);
    return text_line(x, 2 * ((1 - x) * a + x * b) / (a + b));
}
static inline text_sample text_tent(float r, float u) {
    const float x = u < 0.5f ? r * (sqrtf(2 * u) - 1) : r * (1 - sqrtf(2 * (1 - u)));
    return text_line(x, (1 - fabsf(x) / r) / r);
}
static inline text_sample text_exponential(float rate, float u) {
    const float x = -logf(1 - u) / rate;
    return text_line(x, rate * expf(-rate * x));
}
static inline text_sample text_truncexp(float rate, float xmax, float u) {
    const float c = 1 - expf(-rate * xmax);
    const float x = -logf(1 - u * c) / rate;
    return text_line(x, rate * expf(-rate * x) / c);
}
static inline float text_erfinv(float x) {
    float w = -logf((1 - x) * (1 + x));
    float p;
    if (w < 5) {
        w = w - 2.5f;
        p = 2.81022636e-08f;
        p = 3.43273939e-07f + p * w;
        p = -3.5233877e-06f + p * w;
        p = -4.39150654e-06f + p * w;
        p = 0.00021858087f + p * w;
        p = -0.00125372503f + p * w;
        p = -0.00417768164f + p * w;
        p = 0.246640727f + p * w;
        p = 1.50140941f + p * w;
    } else {
        w = sqrtf(w) - 3;
        p = -0.000200214257f;
        p = 0.000100950558f + p * w;
        p = 0.00134934322f + p * w;
        p = -0.00367342844f + p * w;
        p = 0.00573950773f + p * w;
        p = -0.0076224613f + p * w;
        p = 0.00943887047f + p * w;
        p = 1.00167406f + p * w;
        p = 2.83297682f + p * w;
    }
    return p * x;
}
static inline text_sample text_normal(float mean, float sd, float u) {
    const float x = mean + sd * 1.41421356f * text_erfinv(2 * u - 1);
    const float d = x - mean;
    return text_line(x, expf(-d * d / (2 * sd * sd)) / (sd * sqrtf(2 * TEXT_PI)));
}
static inline text_sample text_logistic(float mean, float s, float u) {
    const float x = mean + s * logf(u / (1 - u));
    const float e = expf(-fabsf(x - mean) / s);
    return text_line(x, e / (s * (1 + e) * (1 + e)));
}
/* The share between both ends, by the cumulative distribution and its inverse: in a tail all digits cancel. */
static inline text_sample text_truncnormal(float a, float b, float u) {
    const float from = erff(0.70710678f * a);
    const float to = erff(0.70710678f * b);
    const float x = 1.41421356f * text_erfinv((1 - u) * from + u * to);
    return text_line(x, 0.79788456f * expf(-0.5f * x * x) / (to - from));
}
static inline text_sample text_trunclogistic(float a, float b, float u) {
    const float from = 1 / (1 + expf(-a));
    const float to = 1 / (1 + expf(-b));
    const float p = (1 - u) * from + u * to;
    return text_line(-logf(1 / p - 1), p * (1 - p) / (to - from));
}
static inline text_sample text_power(float n, float u) {
    const float x = powf(u, 1 / (n + 1));
    return text_line(x, (n + 1) * powf(x, n));
}
static inline text_sample text_evenpower(float n, float u) { /* the signed root: powf of a negative number is NaN */
    const float v = 2 * u - 1;
    const float x = copysignf(powf(fabsf(v), 1 / (n + 1)), v);
    return text_line(x, 0.5f * (n + 1) * powf(fabsf(x), n));
}
/* pbrt's search, Newton's method within a bracket, whose ends are told by 1e-6. Where floats lie further apart it never
 * ends; here it does after 100 steps. */
static inline float text_smoothstep_p(float a, float b, float x) {
    const float t = (x - a) / (b - a);
    return 2 * t * t * t - t * t * t * t;
}
static inline float text_smoothstep_pdf(float a, float b, float x) {
    const float t = (x - a) / (b - a);
    return 2 / (b - a) * t * t * (3 - 2 * t);
}
static inline text_sample text_smoothstep(float a, float b, float u) {
    float x0 = a;
    float x1 = b;
    if (u < 1e-6f) return text_line(a, 0);
    float x = a + (b - a) * u;
    for (int i = 0; i < 100; i++) {
        if (!(x0 < x && x < x1)) x = (x0 + x1) / 2;
        const float f = text_smoothstep_p(a, b, x) - u;
        if (f < 0) x0 = x;
        else x1 = x;
        if (x1 - x0 < 1e-6f || fabsf(f) < 1e-6f) break;
        x -= f / text_smoothstep_pdf(a, b, x);
    }
    return text_line(x, text_smoothstep_pdf(a, b, x));
}

/* ---- plane and directions ---- */

static inline text_sample text_disk(float R, float u1, float u2) {
    const float r = R * sqrtf(u1);
    const float phi = 2 * TEXT_PI * u2;
    text_sample s;
    s.x = r * cosf(phi);
    s.y = r * sinf(phi);
    s.z = 0;
    s.pdf = 1 / (TEXT_PI * R * R);
    return s;
}
static inline text_sample text_concentric(float R, float u1, float u2) {
    const float a = 2 * u1 - 1;
    const float b = 2 * u2 - 1;
    text_sample s;
    s.x = s.y = s.z = 0;
    s.pdf = 1 / (TEXT_PI * R * R);
    if (a == 0 && b == 0) return s;
    float r, phi;
    if (fabsf(a) > fabsf(b)) {
        r = a;
        phi = TEXT_PI / 4 * (b / a);
    } else {
        r = b;
        phi = TEXT_PI / 2 - TEXT_PI / 4 * (a / b);
    }
    s.x = R * r * cosf(phi);
    s.y = R * r * sinf(phi);
    return s;
}
static inline text_sample text_bilinear(float w00, float w10, float w01, float w11, float u1, float u2) {
    const text_sample y = text_linear(w00 + w10, w01 + w11, u2);
    text_sample s = text_linear((1 - y.x) * w00 + y.x * w01, (1 - y.x) * w10 + y.x * w11, u1);
    s.y = y.x;
    s.pdf =
        4 * ((1 - s.y) * ((1 - s.x) * w00 + s.x * w10) + s.y * ((1 - s.x) * w01 + s.x * w11)) / (w00 + w10 + w01 + w11);
    return s;
}
static inline text_sample text_triangle(float u1, float u2) { /* pbrt, SampleUniformTriangle */
    text_sample s;
    if (u1 < u2) {
        s.x = u1 / 2;
        s.y = u2 - s.x;
    } else {
        s.y = u2 / 2;
        s.x = u1 - s.y;
    }
    s.z = 0;
    s.pdf = 2;
    return s;
}
static inline text_sample text_direction(float sine, float cosine, float phi, float pdf) {
    text_sample s;
    s.x = sine * cosf(phi);
    s.y = sine * sinf(phi);
    s.z = cosine;
    s.pdf = pdf;
    return s;
}
static inline text_sample text_sphere(float u1, float u2) {
    const float z = 1 - 2 * u1;
    return text_direction(sqrtf(1 - z * z), z, 2 * TEXT_PI * u2, 1 / (4 * TEXT_PI));
}
static inline text_sample text_hemisphere(float u1, float u2) {
    const float z = 1 - u1;
    return text_direction(sqrtf(1 - z * z), z, 2 * TEXT_PI * u2, 1 / (2 * TEXT_PI));
}
static inline text_sample text_cosine(float u1, float u2) {
    text_sample s = text_disk(1, u1, u2);
    s.z = sqrtf(fmaxf(0, 1 - s.x * s.x - s.y * s.y));
    s.pdf = s.z / TEXT_PI;
    return s;
}
static inline text_sample text_cone(float k, float u1, float u2) {
    const float least = 1 - k;
    const float z = (1 - u1) + u1 * least;
    return text_direction(sqrtf(1 - z * z), z, 2 * TEXT_PI * u2, 1 / (2 * TEXT_PI * (1 - least)));
}

/* ---- lights ---- */

/* pbrt, Sphere::Sample for a point outside or inside, without the point hit and a rotation of the light: a cone about
 * the centre by the coordinate system of Duff et al. */
static inline text_sample text_ball(float x, float y, float z, float radius, float u1, float u2) {
    const float d2 = x * x + y * y + z * z;
    const float sin2_max = radius * radius / d2;
    const float cos_max = sin2_max < 1 ? sqrtf(fmaxf(0, 1 - sin2_max)) : -1;
    const float cos_theta = sin2_max < 0.00068523f ? sqrtf(1 - sin2_max * u1) : (cos_max - 1) * u1 + 1;
    const float sine = sqrtf(fmaxf(0, 1 - cos_theta * cos_theta));
    const float one_minus = sin2_max < 0.00068523f ? sin2_max / 2 : 1 - cos_max;
    text_sample s = text_direction(sine, cos_theta, 2 * TEXT_PI * u2, 1 / (2 * TEXT_PI * one_minus));
    const float inverse = 1 / sqrtf(d2);
    x *= inverse;
    y *= inverse;
    z *= inverse;
    const float sign = copysignf(1, z);
    const float a = -1 / (sign + z);
    const float b = x * y * a;
    const float w_x = s.x * (1 + sign * x * x * a) + s.y * b + s.z * x;
    const float w_y = s.x * sign * b + s.y * (sign + y * y * a) + s.z * y;
    s.z = s.z * z - s.x * sign * x - s.y * y;
    s.x = w_x;
    s.y = w_y;
    return s;
}

/* pbrt, Disk::Sample and the conversion of its density, for a normal of unit length */
static inline text_sample text_disk_light(const float c[3], const float n[3], float radius, float u1, float u2) {
    const text_sample d = text_concentric(radius, u1, u2);
    const float sign = copysignf(1, n[2]);
    const float a = -1 / (sign + n[2]);
    const float b = n[0] * n[1] * a;
    text_sample s;
    s.x = c[0] + d.x * (1 + sign * n[0] * n[0] * a) + d.y * b;
    s.y = c[1] + d.x * sign * b + d.y * (sign + n[1] * n[1] * a);
    s.z = c[2] - d.x * sign * n[0] - d.y * n[1];
    const float distance2 = s.x * s.x + s.y * s.y + s.z * s.z;
    const float inverse = 1 / sqrtf(distance2);
    s.x *= inverse;
    s.y *= inverse;
    s.z *= inverse;
    s.pdf = distance2 / (TEXT_PI * radius * radius * fabsf(s.x * n[0] + s.y * n[1] + s.z * n[2]));
    return s;
}

typedef struct {
    float x, y, z;
} text_vec3;
static inline text_vec3 text_vector(float x, float y, float z) {
    text_vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
static inline float text_dot(text_vec3 a, text_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline text_vec3 text_cross(text_vec3 a, text_vec3 b) {
    return text_vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline text_vec3 text_sum(float s, text_vec3 a, float t, text_vec3 b) {
    return text_vector(s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z);
}
static inline text_vec3 text_unit(text_vec3 a) { return text_sum(1 / sqrtf(text_dot(a, a)), a, 0, a); }
static inline float text_clamped(float x, float lo, float hi) { return fminf(fmaxf(x, lo), hi); }
static inline float text_acos(float x) { return acosf(text_clamped(x, -1, 1)); }

/* Urena, Fajardo and King 2013, listing, with the rectangle of the tests */
static inline text_sample text_spherical_rectangle(float a, float b, float u1, float u2) {
    const float height = a * b;
    const text_vec3 corner = text_vector(-0.25f * a, -0.5f * height, 1.0f - 0.0625f * a - 0.0625f * height);
    const text_vec3 edge_x = text_vector(a, 0, 0.25f * a), edge_y = text_vector(0, height, 0.125f * height);
    const text_vec3 x = text_unit(edge_x), y = text_unit(edge_y);
    text_vec3 z = text_cross(x, y);
    float z0 = text_dot(corner, z);
    if (z0 > 0) {
        z0 = -z0;
        z = text_sum(-1, z, 0, z);
    }
    const float x0 = text_dot(corner, x), y0 = text_dot(corner, y);
    const float x1 = x0 + sqrtf(text_dot(edge_x, edge_x)), y1 = y0 + sqrtf(text_dot(edge_y, edge_y));
    const text_vec3 n0 = text_unit(text_vector(0, z0, -y0)), n1 = text_unit(text_vector(-z0, 0, x1));
    const text_vec3 n2 = text_unit(text_vector(0, -z0, y1)), n3 = text_unit(text_vector(z0, 0, -x0));
    const float g2 = text_acos(-text_dot(n2, n3)), g3 = text_acos(-text_dot(n3, n0));
    const float k = 2 * TEXT_PI - g2 - g3;
    const float angle = text_acos(-text_dot(n0, n1)) + text_acos(-text_dot(n1, n2)) - k;
    const float au = u1 * angle + k;
    const float fu = (cosf(au) * n0.z - n2.z) / sinf(au);
    const float cu = text_clamped(copysignf(1 / sqrtf(fu * fu + n0.z * n0.z), fu), -1, 1);
    const float xu = text_clamped(-(cu * z0) / sqrtf(fmaxf(1 - cu * cu, 1e-12f)), x0, x1);
    const float d = sqrtf(xu * xu + z0 * z0);
    const float h0 = y0 / sqrtf(d * d + y0 * y0), h1 = y1 / sqrtf(d * d + y1 * y1);
    const float h = h0 + u2 * (h1 - h0);
    const float yv = h * h < 1 - 1e-6f ? h * d / sqrtf(1 - h * h) : y1;
    const text_vec3 w = text_unit(text_sum(1, text_sum(xu, x, yv, y), z0, z));
    text_sample s;
    s.x = w.x;
    s.y = w.y;
    s.z = w.z;
    s.pdf = 1 / angle;
    return s;
}
/* Arvo 1995, with the triangle of the tests */
static inline text_sample text_spherical_triangle(float p, float q, float u1, float u2) {
    const float height = p * q;
    const text_vec3 a = text_unit(text_vector(-p, -height, 1.25f - 0.25f * height));
    const text_vec3 b = text_unit(text_vector(0.9f * p, -0.5f * height, 1.25f - 0.125f * height));
    const text_vec3 c = text_unit(text_vector(0.25f * p, height, 1.25f + 0.25f * height));
    const text_vec3 ab = text_unit(text_cross(a, b)), bc = text_unit(text_cross(b, c)),
                    ca = text_unit(text_cross(c, a));
    const float alpha = text_acos(-text_dot(ab, ca));
    const float beta = text_acos(-text_dot(bc, ab)), gamma = text_acos(-text_dot(ca, bc));
    const float area = alpha + beta + gamma - TEXT_PI;
    const float sn = sinf(u1 * area - alpha), cs = cosf(u1 * area - alpha);
    const float u = cs - cosf(alpha), v = sn + sinf(alpha) * text_dot(a, b);
    const float at = text_clamped(((v * cs - u * sn) * cosf(alpha) - v) / ((v * sn + u * cs) * sinf(alpha)), -1, 1);
    const text_vec3 from_a = text_unit(text_sum(1, c, -text_dot(c, a), a));
    const text_vec3 end = text_sum(at, a, sqrtf(1 - at * at), from_a);
    const float z = 1 - u2 * (1 - text_dot(end, b));
    const text_vec3 from_b = text_unit(text_sum(1, end, -text_dot(end, b), b));
    const text_vec3 w = text_sum(z, b, sqrtf(fmaxf(0, 1 - z * z)), from_b);
    text_sample s;
    s.x = w.x;
    s.y = w.y;
    s.z = w.z;
    s.pdf = 1 / area;
    return s;
}

/* ---- phase functions ---- */

static inline text_sample text_henyey_greenstein(float g, float u1, float u2) {
    const float s = (1 - g * g) / (1 + g - 2 * g * u1);
    const float z = fabsf(g) < 1e-3f ? 1 - 2 * u1 : (1 + g * g - s * s) / (2 * g);
    const float sine = sqrtf(fmaxf(0, 1 - z * z));
    return text_direction(sine, z, 2 * TEXT_PI * u2, (1 - g * g) / (4 * TEXT_PI * s * s * s));
}
static inline text_sample text_rayleigh(float u1, float u2) {
    const float c = 2 - 4 * u1;
    const float a = cbrtf(c + sqrtf(c * c + 1));
    const float z = a - 1 / a;
    return text_direction(sqrtf(fmaxf(0, 1 - z * z)), z, 2 * TEXT_PI * u2, 3 / (16 * TEXT_PI) * (1 + z * z));
}
static inline text_sample text_von_mises_fisher(float kappa, float u1, float u2) {
    const float e = expf(-2 * kappa);
    const float z = kappa > 0 ? 1 + logf((1 - u1) + u1 * e) / kappa : 1 - 2 * u1;
    const float pdf = kappa > 0 ? kappa / (2 * TEXT_PI * (1 - e)) * expf(kappa * (z - 1)) : 1 / (4 * TEXT_PI);
    return text_direction(sqrtf(fmaxf(0, 1 - z * z)), z, 2 * TEXT_PI * u2, pdf);
}

/* ---- lobes ---- */

static inline text_sample text_phong_lobe(float n, float u1, float u2) {
    const float theta = acosf(powf(1 - u1, 1 / (n + 1)));
    return text_direction(sinf(theta), cosf(theta), 2 * TEXT_PI * u2, (n + 1) / (2 * TEXT_PI) * powf(cosf(theta), n));
}
/* phi with tan(phi) = stretch tan(2 pi u), in the quadrant of 2 pi u */
static inline float text_azimuth(float stretch, float u) {
    float phi = atanf(stretch * tanf(2 * TEXT_PI * u));
    if (u > 0.25f) phi += TEXT_PI;
    if (u > 0.75f) phi += TEXT_PI;
    return phi;
}
static inline text_sample text_ward_h_iso(float a, float u1, float u2) {
    const float theta = atanf(a * sqrtf(-logf(1 - u1)));
    const float c = cosf(theta);
    const float t = tanf(theta);
    return text_direction(sinf(theta), c, 2 * TEXT_PI * u2, expf(-t * t / (a * a)) / (TEXT_PI * a * a * c * c * c));
}
static inline text_sample text_ward_h(float ax, float ay, float u1, float u2) {
    const float phi = text_azimuth(ay / ax, u2);
    const float x = cosf(phi);
    const float y = sinf(phi);
    const float e = x * x / (ax * ax) + y * y / (ay * ay);
    const float theta = atanf(sqrtf(-logf(1 - u1) / e));
    const float c = cosf(theta);
    const float t = tanf(theta);
    return text_direction(sinf(theta), c, phi, expf(-t * t * e) / (TEXT_PI * ax * ay * c * c * c));
}
static inline text_sample text_beckmann_h_iso(float a, float u1, float u2) {
    const float theta = atanf(sqrtf(-a * a * logf(1 - u1)));
    const float c = cosf(theta);
    const float t = tanf(theta);
    const float d = expf(-t * t / (a * a)) / (TEXT_PI * a * a * c * c * c * c);
    return text_direction(sinf(theta), c, 2 * TEXT_PI * u2, d * c);
}
static inline text_sample text_beckmann_h(float ax, float ay, float u1, float u2) {
    const float phi = text_azimuth(ay / ax, u2);
    const float x = cosf(phi);
    const float y = sinf(phi);
    const float e = x * x / (ax * ax) + y * y / (ay * ay);
    const float theta = atanf(sqrtf(-logf(1 - u1) / e));
    const float c = cosf(theta);
    const float t = tanf(theta);
    const float d = expf(-t * t * e) / (TEXT_PI * ax * ay * c * c * c * c);
    return text_direction(sinf(theta), c, phi, d * c);
}
static inline text_sample text_ggx_h_iso(float a, float u1, float u2) {
    const float theta = atanf(a * sqrtf(u1 / (1 - u1)));
    const float c = cosf(theta);
    const float q = (a * a - 1) * c * c + 1;
    return text_direction(sinf(theta), c, 2 * TEXT_PI * u2, a * a * c / (TEXT_PI * q * q));
}
static inline text_sample text_ggx_h(float ax, float ay, float u1, float u2) {
    const float phi = text_azimuth(ay / ax, u2);
    const float x = cosf(phi);
    const float y = sinf(phi);
    const float e = x * x / (ax * ax) + y * y / (ay * ay);
    const float theta = atanf(sqrtf(u1 / (1 - u1) / e));
    const float c = cosf(theta);
    const float t = tanf(theta);
    const float q = c * c * (1 + t * t * e);
    return text_direction(sinf(theta), c, phi, c / (TEXT_PI * ax * ay * q * q));
}
static inline text_sample text_ashikhmin_h_iso(float n, float u1, float u2) {
    const float c = powf(1 - u1, 1 / (n + 1));
    return text_direction(sqrtf(1 - c * c), c, 2 * TEXT_PI * u2, (n + 1) / (2 * TEXT_PI) * powf(c, n));
}
static inline text_sample text_ashikhmin_h(float nu, float nv, float u1, float u2) {
    const float phi = text_azimuth(sqrtf((nu + 1) / (nv + 1)), u2);
    const float x = cosf(phi);
    const float y = sinf(phi);
    const float e = nu * x * x + nv * y * y;
    const float c = powf(1 - u1, 1 / (e + 1));
    return text_direction(sqrtf(1 - c * c), c, phi, sqrtf((nu + 1) * (nv + 1)) / (2 * TEXT_PI) * powf(c, e));
}

/* ---- reflected ---- */

static inline text_sample text_reflect(text_vec wo, text_sample h) {
    const float d = wo.x * h.x + wo.y * h.y + wo.z * h.z;
    text_sample s;
    s.x = 2 * d * h.x - wo.x;
    s.y = 2 * d * h.y - wo.y;
    s.z = 2 * d * h.z - wo.z;
    s.pdf = d > 0 && s.z > 0 ? h.pdf / (4 * d) : 0;
    return s;
}
static inline text_sample text_phong(float n, text_vec wo, float u1, float u2) {
    const text_sample l = text_phong_lobe(n, u1, u2);
    text_vec r = {-wo.x, -wo.y, wo.z};
    const float sign = copysignf(1, r.z);
    const float a = -1 / (sign + r.z);
    const float b = r.x * r.y * a;
    text_sample s;
    s.x = (1 + sign * r.x * r.x * a) * l.x + b * l.y + r.x * l.z;
    s.y = sign * b * l.x + (sign + r.y * r.y * a) * l.y + r.y * l.z;
    s.z = -sign * r.x * l.x - r.y * l.y + r.z * l.z;
    s.pdf = s.z > 0 ? l.pdf : 0;
    return s;
}

/* ---- visible normals ---- */

static inline float text_ggx_d(float ax, float ay, text_sample h) {
    const float q = h.x * h.x / (ax * ax) + h.y * h.y / (ay * ay) + h.z * h.z;
    return 1 / (TEXT_PI * ax * ay * q * q);
}
static inline text_sample text_normalised(float x, float y, float z) {
    const float l = sqrtf(x * x + y * y + z * z);
    text_sample s;
    s.x = x / l;
    s.y = y / l;
    s.z = z / l;
    s.pdf = 0;
    return s;
}
static inline text_sample text_ggx_vndf_h(float ax, float ay, text_vec v, float u1, float u2) {
    const text_sample e = text_normalised(ax * v.x, ay * v.y, v.z);
    const float l = e.x * e.x + e.y * e.y;
    const float k = 1 / sqrtf(l);
    const text_vec t1 = {l > 0 ? -e.y * k : 1, l > 0 ? e.x * k : 0, 0};
    const text_vec t2 = {e.y * t1.z - e.z * t1.y, e.z * t1.x - e.x * t1.z, e.x * t1.y - e.y * t1.x};
    const float r = sqrtf(u1);
    const float phi = 2 * TEXT_PI * u2;
    const float a = r * cosf(phi);
    float b = r * sinf(phi);
    const float s = 0.5f * (1 + e.z);
    b = (1 - s) * sqrtf(1 - a * a) + s * b;
    const float c = sqrtf(fmaxf(0, 1 - a * a - b * b));
    text_sample h = text_normalised(ax * (a * t1.x + b * t2.x + c * e.x), ay * (a * t1.y + b * t2.y + c * e.y),
                                    fmaxf(0, a * t1.z + b * t2.z + c * e.z));
    const float g1 = 1 / (1 + (-1 + sqrtf(1 + (ax * ax * v.x * v.x + ay * ay * v.y * v.y) / (v.z * v.z))) / 2);
    const float d = v.x * h.x + v.y * h.y + v.z * h.z;
    h.pdf = g1 * fmaxf(0, d) * text_ggx_d(ax, ay, h) / v.z;
    return h;
}
static inline float text_bound(float ax, float ay, text_vec v) {
    const float a = fminf(fminf(ax, ay), 1);
    const float s = 1 + sqrtf(v.x * v.x + v.y * v.y);
    const float a2 = a * a;
    const float s2 = s * s;
    return (1 - a2) * s2 / (s2 + a2 * v.z * v.z);
}
static inline text_sample text_ggx_bounded_h(float ax, float ay, text_vec v, float u1, float u2) {
    const text_sample i = text_normalised(ax * v.x, ay * v.y, v.z);
    const float k = text_bound(ax, ay, v);
    const float b = k * i.z;
    const float phi = 2 * TEXT_PI * u1;
    const float z = (1 - u2) * (1 + b) - b;
    const float sine = sqrtf(fminf(fmaxf(1 - z * z, 0), 1));
    text_sample h = text_normalised(ax * (i.x + sine * cosf(phi)), ay * (i.y + sine * sinf(phi)), i.z + z);
    const float t = sqrtf(ax * v.x * ax * v.x + ay * v.y * ay * v.y + v.z * v.z);
    h.pdf = text_ggx_d(ax, ay, h) / (2 * (k * v.z + t)) * 4 * (v.x * h.x + v.y * h.y + v.z * h.z);
    return h;
}

/* ---- random numbers ---- */

typedef struct {
    uint64_t state, inc;
} text_pcg32;
static inline uint32_t text_pcg32_next(text_pcg32 *rng) {
    const uint64_t old = rng->state;
    rng->state = old * 6364136223846793005u + rng->inc;
    const uint32_t x = (uint32_t)(((old >> 18u) ^ old) >> 27u);
    const uint32_t rot = (uint32_t)(old >> 59u);
    return (x >> rot) | (x << ((32u - rot) & 31u));
}
static inline float text_pcg32_float(text_pcg32 *rng) { return (float)text_pcg32_next(rng) * 0x1p-32f; }
#endif
