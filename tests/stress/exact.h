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

/* --- the oracle --------------------------------------------------------------------------------------------------- */

static inline q3 vec(qd x, qd y, qd z) {
    q3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
static inline qd dot(q3 a, q3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline qd len(q3 a) { return sqrtq(dot(a, a)); }
static inline q3 add(q3 a, q3 b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline q3 times(qd k, q3 a) { return vec(k * a.x, k * a.y, k * a.z); }
static inline q3 cross(q3 a, q3 b) { return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static inline qd square(qd x) { return x * x; }

/* The direction with versine m = 1 - cos(theta), by the half angle: a versine of 2^-149 is no less than any other. */
static inline q3 at_versine(qd m, qd phi) {
    const qd half = m / 2;
    const qd sine = 2 * sqrtq(half * (1 - half));
    qd s, c;
    sincosq(phi, &s, &c);
    return vec(sine * c, sine * s, 1 - m);
}
static inline q3 at_tangent2(qd tan2, qd phi) {
    qd sine, z, s, c;
    sincosq(atanq(sqrtq(tan2)), &sine, &z);
    sincosq(phi, &s, &c);
    return vec(sine * c, sine * s, z);
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
    return h.z > 0 ? sqrtq((nu + 1) * (nv + 1)) / (2 * pi) * expq(s * logq(c)) : 0;
}
static inline qd ggx_lambda(qd ax, qd ay, q3 w) { return (sqrtq(1 + alpha2_of(ax, ay, w) * tan2_of(w)) - 1) / 2; }
static inline qd beckmann_lambda(qd ax, qd ay, q3 w) {
    const qd spread = sqrtq(alpha2_of(ax, ay, w) * tan2_of(w));
    const qd a = 1 / spread;
    return spread > 0 ? (expq(-a * a) / (a * sqrtq(pi)) - erfcq(a)) / 2 : 0;
}
static inline qd bound(qd ax, qd ay, q3 wo) { /* Eto and Tokuyoshi 2023 */
    const qd a = fminq(fminq(ax, ay), 1);
    const qd s = 1 + sqrtq(wo.x * wo.x + wo.y * wo.y);
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
        if (erfcq(-z / sqrtq(2)) / 2 < u) lo = z;
        else hi = z;
    }
    z = (lo + hi) / 2;
    for (int i = 0; i < 7; i++) z -= (erfcq(-z / sqrtq(2)) / 2 - u) * sqrtq(2 * pi) * expq(z * z / 2);
    return z;
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

#define ST_ID(shape, row, fn, arg, base, coord, grid) ID_##row,
enum { MCST_ROWS(ST_ID) IDS };

/* Lobes beyond the list count as microfacets of the formulas below, and fail where they are not; other rows have none.
 */
static inline int exact_has(const mcst_row *row) {
    static const int ids[] = {ID_linear,
                              ID_tent,
                              ID_exponential,
                              ID_truncexp,
                              ID_normal,
                              ID_logistic,
                              ID_power,
                              ID_evenpower,
                              ID_disk,
                              ID_concentric,
                              ID_sphere,
                              ID_hemisphere,
                              ID_cosine,
                              ID_cone,
                              ID_henyey_greenstein,
                              ID_rayleigh,
                              ID_von_mises_fisher,
                              ID_smoothstep,
                              ID_triangle};
    if (row->shape == MCST_IS_LOBE || row->shape == MCST_IS_VLOBE || row->shape == MCST_IS_BRDF) return 1;
    for (size_t i = 0; i < MCST_COUNT(ids); i++)
        if (ids[i] == row - mcst_rows) return 1;
    printf("SKIPPED: %s: exact.h has no truth of 113 bits for it\n", row->name);
    return 0;
}

/* A setting: parameters as the header clamps them, and wo. */
typedef struct {
    int id, half, visible; /* BRDF over half-vectors; 1 visible, 2 bounded */
    qd a, b;
    q3 wo;
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
        const qd phi = atan2q(sqrtq(s->a + 1) * sine, sqrtq(s->b + 1) * cosine);
        sincosq(phi, &sine, &cosine);
        const qd e = s->a * square(cosine) + s->b * square(sine);
        return at_versine(-expm1q(log1pq(-u1) / (e + 1)), phi);
    } else {
        const qd r2 = s->id == ID_ggx || s->id == ID_ggx_h ? u1 / (1 - u1) : -log1pq(-u1);
        return at_tangent2(r2 * (square(s->a * cosine) + square(s->b * sine)), atan2q(s->b * sine, s->a * cosine));
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

static inline void exact_map(const mcst_row *row, const setting *s, qd u1, qd u2, q3 *x) {
    const qd a = s->a;
    const qd b = s->b;
    const qd least = 0x1p-25;
    const qd d = 2 * u1 - 1;
    const qd e = 2 * u2 - 1;
    *x = vec(0, 0, 0);
    switch (s->id) {
    case ID_linear: x->x = u1 > 0 ? u1 * (a + b) / (a + sqrtq(a * a * (1 - u1) + b * b * u1)) : 0; return;
    case ID_tent: x->x = u1 < 0.5 ? -a * (1 - sqrtq(2 * u1)) : a * (1 - sqrtq(2 * (1 - u1))); return;
    case ID_exponential: x->x = -log1pq(-u1) / a; return;
    case ID_truncexp: x->x = a > 0 ? -log1pq(u1 * expm1q(-a * b)) / a : u1 * b; return;
    case ID_normal: x->x = a + b * normal_quantile(fmaxq(u1, least)); return;
    case ID_logistic: x->x = a + b * logq(fmaxq(u1, least) / (1 - u1)); return;
    case ID_power: x->x = u1 > 0 ? expq(logq(u1) / (a + 1)) : 0; return;
    case ID_evenpower: x->x = d != 0 ? copysignq(expq(logq(fabsq(d)) / (a + 1)), d) : 0; return;
    case ID_smoothstep: x->x = a + (b - a) * smoothstep_t(u1); return;
    case ID_disk:
        x->x = a * sqrtq(u1) * cosq(2 * pi * u2);
        x->y = a * sqrtq(u1) * sinq(2 * pi * u2);
        return;
    case ID_concentric: {
        const qd r = fabsq(d) > fabsq(e) ? d : e;
        const qd phi = r == 0 ? 0 : fabsq(d) > fabsq(e) ? pi / 4 * (e / d) : pi / 2 - pi / 4 * (d / e);
        x->x = a * r * cosq(phi);
        x->y = a * r * sinq(phi);
        return;
    }
    case ID_triangle: *x = vec(u1 - fminq(u1, u2) / 2, u2 - fminq(u1, u2) / 2, 0); return;
    case ID_sphere: *x = at_versine(2 * u1, 2 * pi * u2); return;
    case ID_hemisphere: *x = at_versine(u1, 2 * pi * u2); return;
    case ID_cosine: *x = vec(sqrtq(u1) * cosq(2 * pi * u2), sqrtq(u1) * sinq(2 * pi * u2), sqrtq(1 - u1)); return;
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

static inline qd exact_pdf(const mcst_row *row, const setting *s, q3 x) {
    const qd a = s->a;
    const qd b = s->b;
    const qd z = b > 0 ? (x.x - a) / b : 0;
    switch (s->id) {
    case ID_linear: return x.x >= 0 && x.x <= 1 ? 2 * (a * (1 - x.x) + b * x.x) / (a + b) : 0;
    case ID_tent: return fabsq(x.x) <= a ? (1 - fabsq(x.x) / a) / a : 0;
    case ID_exponential: return x.x >= 0 ? a * expq(-a * x.x) : 0;
    case ID_truncexp: return x.x < 0 || x.x > b ? 0 : a > 0 ? a * expq(-a * x.x) / -expm1q(-a * b) : 1 / b;
    case ID_normal: return expq(-z * z / 2) / (b * sqrtq(2 * pi));
    case ID_logistic: return expq(-fabsq(z)) / (b * square(1 + expq(-fabsq(z))));
    case ID_power: return x.x < 0 || x.x > 1 ? 0 : x.x > 0 ? (a + 1) * expq(a * logq(x.x)) : a > 0 ? 0 : 1;
    case ID_evenpower:
        return fabsq(x.x) > 1 ? 0 : x.x != 0 ? (a + 1) / 2 * expq(a * logq(fabsq(x.x))) : a > 0 ? 0 : (qd)0.5;
    case ID_smoothstep: {
        const qd t = (x.x - a) / (b - a);
        return t >= 0 && t <= 1 ? 2 * t * t * (3 - 2 * t) / (b - a) : 0;
    }
    case ID_disk:
    case ID_concentric: return x.x * x.x + x.y * x.y <= a * a * (1 + (qd)1e-30) ? 1 / (pi * a * a) : 0;
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
        return (1 - a * a) / (4 * pi * s2 * sqrtq(s2));
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
    case ID_ward_1992: return ward_gauss(a, b, h) / (4 * sqrtq(zo * zi));
    case ID_beckmann:
        return beckmann_d(a, b, h) / (4 * zo * zi * (1 + beckmann_lambda(a, b, s->wo) + beckmann_lambda(a, b, wi)));
    case ID_ashikhmin: return ashikhmin_h(a, b, h) / (2 * len(h) * fmaxq(zo, zi)); /* 4 wo.h = 2 |H| */
    default: return ggx_d(a, b, h) / (4 * zo * zi * (1 + ggx_lambda(a, b, s->wo) + ggx_lambda(a, b, wi)));
    }
}

static inline void exact_start(void) { pi = acosq(-1); }
#endif
