/* The truth of the stress tests: every sampler and density in __float128 (gcc with libquadmath), as the papers print
 * them (sources in the header): angles, tangents and powers of cosines, with 113 bits in place of care. Parameters are
 * clamped as the header clamps them; directions are the literal floats and not made unit, half-vectors are wo + wi.
 * extremes.c checks by numerical Jacobians that the maps have the densities. */
#ifndef MCS_EXACT_H
#define MCS_EXACT_H
#include <quadmath.h>
#include "stress.h"

__extension__ typedef __float128 qd;
typedef struct {
    qd x, y, z;
} q3;
static qd pi; /* exact_start() sets it */

#define ST_ID(shape, row, fn, arg, base, coord, grid) ID_##row,
enum { MCST_ROWS(ST_ID) IDS };

/* --- the oracle --------------------------------------------------------------------------------------------------- */

/* The root of x by that of the nearest long double, which is off by 2^-64 of it at most. Newton's correction leaves
 * 2^-128 of what it is, and needs no more digits than a long double has: sqrtq divides in 113 bits. */
static inline qd root_of(qd x) {
    const ld y = sqrtl((ld)x);
    return y > 0 && y < INFINITY ? (qd)y + (ld)(x - (qd)y * y) / (2 * y) : y;
}

static inline q3 vec(qd x, qd y, qd z) {
    q3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
static inline qd dot(q3 a, q3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline qd len(q3 a) { return root_of(dot(a, a)); }
static inline q3 add(q3 a, q3 b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline q3 times(qd k, q3 a) { return vec(k * a.x, k * a.y, k * a.z); }
static inline q3 cross(q3 a, q3 b) { return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static inline qd square(qd x) { return x * x; }

/* The direction with versine m = 1 - cos(theta), by the half angle: a versine of 2^-149 is no less than any other. */
static inline q3 at_versine(qd m, qd phi) {
    const qd half = m / 2;
    const qd sine = 2 * root_of(half * (1 - half));
    qd s, c;
    sincosq(phi, &s, &c);
    return vec(sine * c, sine * s, 1 - m);
}
/* The direction whose slopes are x and y. */
static inline q3 at_slopes(qd x, qd y) {
    const qd z = 1 / root_of(1 + x * x + y * y);
    return vec(x * z, y * z, z);
}
/* tan^2 of a direction, and cos^2(phi)/ax^2 + sin^2(phi)/ay^2 (Walter et al. 2007, anisotropic as in Heitz 2014) */
static inline qd tan2_of(q3 h) { return (h.x * h.x + h.y * h.y) / (h.z * h.z); }
static inline qd per_alpha2(qd ax, qd ay, q3 h) {
    const qd r2 = h.x * h.x + h.y * h.y;
    return r2 > 0 ? (square(h.x) / square(ax) + square(h.y) / square(ay)) / r2 : 0;
}
static inline qd alpha2_of(qd ax, qd ay, q3 w) { /* alpha^2 in the direction of w */
    const qd r2 = w.x * w.x + w.y * w.y;
    return r2 > 0 ? (square(ax * w.x) + square(ay * w.y)) / r2 : 0;
}

static inline qd beckmann_d(qd ax, qd ay, q3 h) {
    const qd c = h.z / len(h);
    return h.z > 0 ? expq(-tan2_of(h) * per_alpha2(ax, ay, h)) / (pi * ax * ay * c * c * c * c) : 0;
}
static inline qd ggx_d(qd ax, qd ay, q3 h) {
    const qd c = h.z / len(h);
    return h.z > 0 ? 1 / (pi * ax * ay * c * c * c * c * square(1 + tan2_of(h) * per_alpha2(ax, ay, h))) : 0;
}
static inline qd ashikhmin_h(qd nu, qd nv, q3 h) {
    const qd r2 = h.x * h.x + h.y * h.y;
    const qd c = h.z / len(h);
    const qd s = r2 > 0 ? (nu * h.x * h.x + nv * h.y * h.y) / r2 : 0;
    return h.z > 0 ? root_of((nu + 1) * (nv + 1)) / (2 * pi) * expq(s * logq(c)) : 0;
}
static inline qd ggx_lambda(qd ax, qd ay, q3 w) { return (root_of(1 + alpha2_of(ax, ay, w) * tan2_of(w)) - 1) / 2; }
static inline qd beckmann_lambda(qd ax, qd ay, q3 w) {
    const qd spread = root_of(alpha2_of(ax, ay, w) * tan2_of(w));
    const qd a = 1 / spread;
    return spread > 0 ? (expq(-a * a) / (a * root_of(pi)) - erfcq(a)) / 2 : 0;
}
static inline qd bound(qd ax, qd ay, q3 wo) { /* Eto and Tokuyoshi 2023 */
    const qd a = fminq(fminq(ax, ay), 1);
    const qd s = 1 + root_of(wo.x * wo.x + wo.y * wo.y);
    return (1 - a * a) * s * s / (s * s + a * a * wo.z * wo.z);
}
/* The view direction where the surface is a hemisphere. */
static inline q3 stretched(qd ax, qd ay, q3 wo) {
    const q3 v = vec(ax * wo.x, ay * wo.y, wo.z);
    return times(1 / len(v), v);
}
static inline q3 mirror(q3 wo, q3 h) { return add(times(2 * dot(wo, h), h), times(-1, wo)); }

static inline qd
normal_quantile(qd u) { /* bisection to a start, then Newton: the cumulative is erfc(-z / sqrt 2) / 2 */
    qd lo = -14;
    qd hi = 14;
    if (u > 0.5) return -normal_quantile(1 - u);
    qd z;
    for (int i = 0; i < 12; i++) {
        z = (lo + hi) / 2;
        if (erfcq(-z / root_of(2)) / 2 < u) lo = z;
        else hi = z;
    }
    z = (lo + hi) / 2;
    for (int i = 0; i < 7; i++) z -= (erfcq(-z / root_of(2)) / 2 - u) * root_of(2 * pi) * expq(z * z / 2);
    return z;
}

/* --- the parts of bells between two ends ---
 * Mirrored so that the end nearer to 0 is a: either a < 0 < b, or both are in the upper tail. A point of a bell
 * may be so far out that 113 bits do not hold how far it is from a, or from the mean: it is the sum of x.x and x.y. */

typedef struct {
    int mirrored;
    qd a, b;
} ends;

static inline ends ends_of(qd a, qd b) {
    ends e;
    e.mirrored = -a > b;
    e.a = e.mirrored ? -b : a;
    e.b = e.mirrored ? -a : b;
    return e;
}
static inline q3 beyond(qd from, qd t) { return vec(from + t, from - (from + t) + t, 0); }
static inline q3 beyond_end(const ends *e, qd t) { return e->mirrored ? beyond(-e->a, -t) : beyond(e->a, t); }

/* Mills' ratio: the mass beyond z over the density at z. From 4 on by Laplace's continued fraction, whose error falls
 * as e^(-2 z sqrt(2 n)): 100 terms leave e^-113. */
static inline qd mills(qd z) {
    if (z < 4) return root_of(pi / 2) * expq(z * z / 2) * erfcq(z / root_of(2));
    qd f = z;
    for (int n = 100; n > 0; n--) f = z + n / f;
    return 1 / f;
}
/* What is beyond a + t of what is beyond a, a >= 1. */
static inline qd normal_left(qd a, qd t) { return expq(-t * (a + t / 2)) * mills(a + t) / mills(a); }
static inline qd normal_from_0(qd x) { return erfq(x / root_of(2)) / 2; }

static inline q3 truncnormal(const ends *e, qd u) {
    if (e->a >= 1) { /* Newton's method for a concave logarithm, from beyond the root: it never steps over it */
        const qd left = 1 - u * (1 - normal_left(e->a, e->b - e->a));
        qd t = fminq(e->b - e->a, -logq(left) / e->a);
        for (int i = 0; i < 12; i++) t += logq(normal_left(e->a, t) / left) * mills(e->a + t);
        return beyond_end(e, fminq(fmaxq(t, 0), e->b - e->a));
    }
    const qd share = normal_from_0(e->a) + u * (normal_from_0(e->b) - normal_from_0(e->a));
    qd lo = fmaxq(e->a, -15);
    qd hi = fminq(e->b, 15);
    for (int i = 0; i < 50; i++) {
        const qd middle = (lo + hi) / 2;
        if (normal_from_0(middle) < share) lo = middle;
        else hi = middle;
    }
    qd x = (lo + hi) / 2;
    for (int i = 0; i < 4; i++) x -= (normal_from_0(x) - share) * root_of(2 * pi) * expq(x * x / 2);
    x = fminq(fmaxq(x, e->a), e->b);
    return vec(e->mirrored ? -x : x, 0, 0);
}
static inline qd truncnormal_pdf(const ends *e, qd x, qd t) {
    if (e->a >= 1) return expq(-t * (e->a + t / 2)) / (mills(e->a) * (1 - normal_left(e->a, e->b - e->a)));
    return expq(-x * x / 2) / (root_of(2 * pi) * (normal_from_0(e->b) - normal_from_0(e->a)));
}

/* What is between a and b of what is beyond a: the logistic one has 1/(1 + e^x) beyond x. */
static inline qd logistic_between(const ends *e) { return -expm1q(e->a - e->b) / (1 + expq(-e->b)); }
static inline q3 trunclogistic(ends e, qd u) {
    e.a = fmaxq(e.a, -5000); /* beyond it is e^-5000 of all */
    const qd passed = u * logistic_between(&e);
    return beyond_end(&e, fminq(log1pq((1 + expq(-e.a)) * passed / (1 - passed)), e.b - e.a));
}
static inline qd trunclogistic_pdf(const ends *e, qd x, qd t) {
    const qd over_left = e->a > 0 ? expq(-t) * (1 + expq(-e->a)) : expq(-fabsq(x)) * (1 + expq(e->a));
    return over_left / (square(1 + expq(-fabsq(x))) * logistic_between(e));
}

static inline qd cut_pdf(int id, const ends *e, q3 x) {
    const qd side = e->mirrored ? -1 : 1;
    const qd t = side * x.x - e->a + side * x.y;
    if (!(t >= 0 && t <= e->b - e->a)) return 0;
    return id == ID_truncnormal ? truncnormal_pdf(e, side * x.x, t) : trunclogistic_pdf(e, side * x.x, t);
}

static inline qd linear(qd a, qd b, qd u) {
    return u > 0 ? u * (a + b) / (a + root_of(a * a * (1 - u) + b * b * u)) : 0;
}
/* Two steps of it. Where a side has no height, that is how the heights beside it are shared. */
static inline q3 bilinear(qd w00, qd w10, qd w01, qd w11, qd u1, qd u2) {
    if (w00 + w10 + w01 + w11 == 0) return vec(u1, u2, 0);
    const qd y = linear(w00 + w10, w01 + w11, u2);
    const int flat = (w00 + w10) * (1 - y) + (w01 + w11) * y == 0;
    const qd at = flat ? 1 - y : y;
    return vec(linear(w00 * (1 - at) + w01 * at, w10 * (1 - at) + w11 * at, u1), y, 0);
}
static inline qd bilinear_pdf(qd w00, qd w10, qd w01, qd w11, qd x, qd y) {
    const qd sum = w00 + w10 + w01 + w11;
    if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1)) return 0;
    return sum == 0 ? 1 : 4 * ((1 - y) * ((1 - x) * w00 + x * w10) + y * ((1 - x) * w01 + x * w11)) / sum;
}

/* Shirley and Chiu 1997, on the disk of radius 1. */
static inline q3 concentric(qd u1, qd u2) {
    const qd d = 2 * u1 - 1;
    const qd e = 2 * u2 - 1;
    const qd r = fabsq(d) > fabsq(e) ? d : e;
    const qd phi = r == 0 ? 0 : fabsq(d) > fabsq(e) ? pi / 4 * (e / d) : pi / 2 - pi / 4 * (d / e);
    return vec(r * cosq(phi), r * sinq(phi), 0);
}

static inline qd smoothstep_t(qd u) { /* t^3 (2 - t) = u: bisection to a start, then Newton */
    qd lo = 0;
    qd hi = 1;
    qd t = 0;
    if (!(u > 0)) return 0;
    for (int i = 0; i < 70; i++) {
        t = (lo + hi) / 2;
        if (t * t * t * (2 - t) < u) lo = t;
        else hi = t;
    }
    for (int i = 0; i < 3; i++) t -= (t * t * t * (2 - t) - u) / (2 * t * t * (3 - 2 * t));
    return t;
}

#include "exact_lights.h"

/* A setting: parameters as the header clamps them, and wo; and a light, if it is one. */
typedef struct {
    int id, half, visible; /* BRDF over half-vectors; 1 visible, 2 bounded */
    qd a, b;
    q3 wo;
    light light;
} setting;

static inline setting setting_of(const mcst_row *row, const float *p) {
    setting s;
    s.id = (int)(row - mcst_rows);
    s.half = row->shape == MCST_IS_BRDF && s.id != ID_phong;
    s.visible = strstr(row->name, "vndf") ? 1 : strstr(row->name, "bounded") ? 2 : 0;
    s.a = p[0];
    s.b = p[1];
    if (row->coord == MCST_SLOPES) {
        s.a = fminf(fmaxf(p[0], 1e-7f), 1e4f);
        s.b = fminf(fmaxf(p[1], 1e-7f), 1e4f);
    }
    if (row->coord == MCST_COSPOWER) {
        s.a = fminf(p[0], 1e9f);
        s.b = fminf(p[1], 1e9f);
    }
    s.wo = vec(p[3], p[4], p[5]);
    const given_light given = row_light(s.id, p[0], p[1]);
    s.light = seen_from_p(&given);
    return s;
}

static inline q3 half_vector_map(const setting *s, qd u1, qd u2) {
    const qd turn = 2 * pi * u2;
    if (s->visible) {
        const q3 i = stretched(s->a, s->b, s->wo);
        const qd k = s->visible == 2 ? bound(s->a, s->b, s->wo) : 1;
        q3 h = add(at_versine(u2 * (1 + k * i.z), atan2q(i.y, i.x) + 2 * pi * u1), i);
        h = vec(s->a * h.x, s->b * h.y, h.z);
        return times(1 / len(h), h);
    }
    qd sine, cosine;
    sincosq(turn, &sine, &cosine);
    if (s->id == ID_ashikhmin || s->id == ID_ashikhmin_h) {
        const qd phi = atan2q(root_of(s->a + 1) * sine, root_of(s->b + 1) * cosine);
        sincosq(phi, &sine, &cosine);
        const qd e = s->a * square(cosine) + s->b * square(sine);
        return at_versine(-expm1q(log1pq(-u1) / (e + 1)), phi);
    } else {
        const qd r2 = s->id == ID_ggx || s->id == ID_ggx_h ? u1 / (1 - u1) : -log1pq(-u1);
        const qd r = root_of(r2);
        return at_slopes(r * s->a * cosine, r * s->b * sine);
    }
}

/* The density of half-vectors at h, any length. */
static inline qd half_vector_density(const setting *s, q3 h) {
    const qd c = h.z / len(h);
    if (!(h.z > 0)) return 0;
    if (s->visible) {
        const q3 i = stretched(s->a, s->b, s->wo);
        const q3 m = vec(h.x / s->a, h.y / s->b, h.z);
        const qd od = dot(s->wo, h) / len(h);
        const qd t = len(vec(s->a * s->wo.x, s->b * s->wo.y, s->wo.z));
        if (!(od > 0 && s->wo.z > 0)) return 0;
        if (s->visible == 1) return ggx_d(s->a, s->b, h) * od / (s->wo.z * (1 + ggx_lambda(s->a, s->b, s->wo)));
        if (2 * dot(i, m) * m.z / dot(m, m) - i.z < -bound(s->a, s->b, s->wo) * i.z) return 0; /* below the cap */
        return 2 * od * ggx_d(s->a, s->b, h) / (bound(s->a, s->b, s->wo) * s->wo.z + t);
    }
    if (s->id == ID_ashikhmin || s->id == ID_ashikhmin_h) return ashikhmin_h(s->a, s->b, h);
    return (s->id == ID_ggx || s->id == ID_ggx_h ? ggx_d(s->a, s->b, h) : beckmann_d(s->a, s->b, h)) * c;
}

/* Of a row that was added to registry.h alone. */
static inline void without_truth(const setting *s) {
    fprintf(stderr, "exact.h has no truth of row %s\n", mcst_rows[s->id].name);
    exit(2);
}

static inline q3 line_map(const setting *s, qd u1) {
    const qd a = s->a;
    const qd b = s->b;
    const qd least = 0x1p-25;
    const qd d = 2 * u1 - 1;
    q3 x = vec(0, 0, 0);
    switch (s->id) {
    case ID_linear: x.x = linear(a, b, u1); break;
    case ID_tent: x.x = u1 < 0.5 ? -a * (1 - root_of(2 * u1)) : a * (1 - root_of(2 * (1 - u1))); break;
    case ID_exponential: x.x = -log1pq(-u1) / a; break;
    case ID_truncexp: x.x = a > 0 ? -log1pq(u1 * expm1q(-a * b)) / a : u1 * b; break;
    case ID_normal: x = beyond(a, b * normal_quantile(fmaxq(u1, least))); break;
    case ID_logistic: x = beyond(a, b * logq(fmaxq(u1, least) / (1 - u1))); break;
    case ID_power: x.x = u1 > 0 ? expq(logq(u1) / (a + 1)) : 0; break;
    case ID_truncnormal:
    case ID_trunclogistic: {
        const ends cut = ends_of(a, b);
        const qd u = cut.mirrored ? 1 - fmaxq(u1, least) : fmaxq(u1, least);
        x = s->id == ID_truncnormal ? truncnormal(&cut, u) : trunclogistic(cut, u);
        break;
    }
    case ID_evenpower: x.x = d != 0 ? copysignq(expq(logq(fabsq(d)) / (a + 1)), d) : 0; break;
    case ID_smoothstep: x.x = a + (b - a) * smoothstep_t(u1); break;
    default: without_truth(s);
    }
    return x;
}

static inline void exact_map(const mcst_row *row, const setting *s, qd u1, qd u2, q3 *x) {
    const qd a = s->a;
    const qd b = s->b;
    *x = vec(0, 0, 0);
    if (row->dim == 1) {
        *x = line_map(s, u1);
        return;
    }
    switch (s->id) {
    case ID_disk:
        x->x = a * root_of(u1) * cosq(2 * pi * u2);
        x->y = a * root_of(u1) * sinq(2 * pi * u2);
        return;
    case ID_concentric: *x = times(a, concentric(u1, u2)); return;
    case ID_bilinear: *x = bilinear(a, b, 1, 3, u1, u2); return;
    case ID_bilinear_cross: *x = bilinear(a, 0, 0, b, u1, u2); return;
    case ID_ball:
    case ID_disk_light:
    case ID_spherical_rectangle:
    case ID_spherical_triangle: *x = light_seen(&s->light, u1, u2).w; return;
    case ID_triangle: *x = vec(u1 - fminq(u1, u2) / 2, u2 - fminq(u1, u2) / 2, 0); return;
    case ID_sphere: *x = at_versine(2 * u1, 2 * pi * u2); return;
    case ID_hemisphere: *x = at_versine(u1, 2 * pi * u2); return;
    case ID_cosine: *x = vec(root_of(u1) * cosq(2 * pi * u2), root_of(u1) * sinq(2 * pi * u2), root_of(1 - u1)); return;
    case ID_cone: *x = at_versine(a * u1, 2 * pi * u2); return;
    case ID_henyey_greenstein: {
        const qd root = (1 - a * a) / (1 + a - 2 * a * u1);
        *x = at_versine((1 - a) * u1 * (root + 1 - a) / (1 + a - 2 * a * u1), 2 * pi * u2);
        return;
    }
    case ID_rayleigh: { /* the root by Newton's method, from that of the lower powers */
        qd m = 4 * u1 / 3;
        for (int i = 0; i < 40; i++) m -= (m * (6 - m * (3 - m)) - 8 * u1) / (6 - m * (6 - 3 * m));
        *x = at_versine(m, 2 * pi * u2);
        return;
    }
    case ID_von_mises_fisher: *x = at_versine(a > 0 ? -log1pq(u1 * expm1q(-2 * a)) / a : 2 * u1, 2 * pi * u2); return;
    case ID_phong_lobe: *x = at_versine(-expm1q(log1pq(-u1) / (a + 1)), 2 * pi * u2); return;
    case ID_phong: { /* Duff et al. 2017 */
        const q3 l = at_versine(-expm1q(log1pq(-u1) / (a + 1)), 2 * pi * u2);
        const q3 n = times(1 / len(s->wo), vec(-s->wo.x, -s->wo.y, s->wo.z));
        const q3 f = vec(1 - n.x * n.x / (1 + n.z), -n.x * n.y / (1 + n.z), -n.x);
        *x = add(add(times(l.x, f), times(l.y, cross(n, f))), times(l.z, n));
        return;
    }
    default:
        *x = half_vector_map(s, u1, u2);
        if (row->shape == MCST_IS_BRDF) *x = mirror(s->wo, *x);
    }
}

static inline qd line_pdf(const setting *s, q3 x) {
    const qd a = s->a;
    const qd b = s->b;
    const qd z = b > 0 ? (x.x - a + x.y) / b : 0;
    switch (s->id) {
    case ID_linear: return x.x >= 0 && x.x <= 1 ? 2 * (a * (1 - x.x) + b * x.x) / (a + b) : 0;
    case ID_tent: return fabsq(x.x) <= a ? (1 - fabsq(x.x) / a) / a : 0;
    case ID_exponential: return x.x >= 0 ? a * expq(-a * x.x) : 0;
    case ID_truncexp: return x.x < 0 || x.x > b ? 0 : a > 0 ? a * expq(-a * x.x) / -expm1q(-a * b) : 1 / b;
    case ID_normal: return expq(-z * z / 2) / (b * root_of(2 * pi));
    case ID_logistic: return expq(-fabsq(z)) / (b * square(1 + expq(-fabsq(z))));
    case ID_truncnormal:
    case ID_trunclogistic: {
        const ends cut = ends_of(a, b);
        return cut_pdf(s->id, &cut, x);
    }
    case ID_power: return x.x < 0 || x.x > 1 ? 0 : x.x > 0 ? (a + 1) * expq(a * logq(x.x)) : a > 0 ? 0 : 1;
    case ID_evenpower:
        return fabsq(x.x) > 1 ? 0 : x.x != 0 ? (a + 1) / 2 * expq(a * logq(fabsq(x.x))) : a > 0 ? 0 : (qd)0.5;
    case ID_smoothstep: {
        const qd t = (x.x - a) / (b - a);
        return t >= 0 && t <= 1 ? 2 * t * t * (3 - 2 * t) / (b - a) : 0;
    }
    default: without_truth(s); return 0;
    }
}

static inline qd exact_pdf(const mcst_row *row, const setting *s, q3 x) {
    const qd a = s->a;
    const qd b = s->b;
    if (row->dim == 1) return line_pdf(s, x);
    switch (s->id) {
    case ID_disk:
    case ID_concentric: return x.x * x.x + x.y * x.y <= a * a * (1 + (qd)1e-30) ? 1 / (pi * a * a) : 0;
    case ID_bilinear: return bilinear_pdf(a, b, 1, 3, x.x, x.y);
    case ID_bilinear_cross: return bilinear_pdf(a, 0, 0, b, x.x, x.y);
    case ID_ball:
    case ID_disk_light:
    case ID_spherical_rectangle:
    case ID_spherical_triangle: return light_pdf(&s->light, x);
    case ID_triangle: return x.x >= 0 && x.y >= 0 && x.x + x.y <= 1 ? 2 : 0;
    case ID_sphere: return 1 / (4 * pi);
    case ID_hemisphere: return x.z > 0 ? 1 / (2 * pi) : 0;
    case ID_cosine: return x.z > 0 ? x.z / pi : 0;
    case ID_cone: { /* the versine is tan(theta/2) sin(theta) */
        const qd r2 = x.x * x.x + x.y * x.y;
        const qd l = len(x);
        const qd m = x.z > 0 ? r2 / (l * (l + x.z)) : 1 - x.z / l;
        return m <= a ? 1 / (2 * pi * a) : 0;
    }
    case ID_henyey_greenstein: {
        const qd s2 = 1 + a * a - 2 * a * x.z / len(x);
        return (1 - a * a) / (4 * pi * s2 * root_of(s2));
    }
    case ID_rayleigh: return 3 * (1 + x.z * x.z / dot(x, x)) / (16 * pi);
    case ID_von_mises_fisher:
        return a > 0 ? a * expq(a * (x.z / len(x) - 1)) / (-2 * pi * expm1q(-2 * a)) : 1 / (4 * pi);
    case ID_phong_lobe: return x.z > 0 ? (a + 1) / (2 * pi) * expq(-a / 2 * log1pq(tan2_of(x))) : 0;
    case ID_phong: {
        const q3 r = vec(-s->wo.x, -s->wo.y, s->wo.z);
        const qd c = dot(r, x) / (len(r) * len(x));
        return s->wo.z > 0 && x.z > 0 && c > 0 ? (a + 1) / (2 * pi) * expq(a * logq(c)) : 0;
    }
    default:
        if (row->shape == MCST_IS_BRDF) {
            const q3 h = add(s->wo, x);
            if (!(s->wo.z > 0 && x.z > 0)) return 0;
            if (s->visible == 1) return ggx_d(a, b, h) / (4 * s->wo.z * (1 + ggx_lambda(a, b, s->wo)));
            if (s->visible == 2)
                return ggx_d(a, b, h) /
                       (2 * (bound(a, b, s->wo) * s->wo.z + len(vec(a * s->wo.x, b * s->wo.y, s->wo.z))));
            return half_vector_density(s, h) / (2 * len(h)); /* 4 wo.h, wo.h = |wo + wi| / 2 */
        }
        return half_vector_density(s, x);
    }
}

static inline qd ward_gauss(qd a, qd b, q3 h) { return expq(-tan2_of(h) * per_alpha2(a, b, h)) / (pi * a * b); }
/* f of a BRDF, wo and wi above the surface. */
static inline qd exact_value(const setting *s, q3 wi) {
    const q3 h = add(s->wo, wi);
    const qd zo = s->wo.z;
    const qd zi = wi.z;
    const qd a = s->a;
    const qd b = s->b;
    switch (s->id) {
    case ID_phong: {
        const q3 r = vec(-s->wo.x, -s->wo.y, s->wo.z);
        const qd c = dot(r, wi) / (len(r) * len(wi));
        return c > 0 ? (a + 2) / (2 * pi) * expq(a * logq(c)) : 0;
    }
    case ID_ward_gmd: return ward_gauss(a, b, h) * dot(h, h) / square(square(h.z));
    case ID_ward_duer: return ward_gauss(a, b, h) / (4 * zo * zi);
    case ID_ward_1992: return ward_gauss(a, b, h) / (4 * root_of(zo * zi));
    case ID_beckmann:
        return beckmann_d(a, b, h) / (4 * zo * zi * (1 + beckmann_lambda(a, b, s->wo) + beckmann_lambda(a, b, wi)));
    case ID_ashikhmin: return ashikhmin_h(a, b, h) / (2 * len(h) * fmaxq(zo, zi)); /* 4 wo.h = 2 |H| */
    default: return ggx_d(a, b, h) / (4 * zo * zi * (1 + ggx_lambda(a, b, s->wo) + ggx_lambda(a, b, wi)));
    }
}

static inline void exact_start(void) { pi = acosq(-1); }
#endif
