/* The truth of directions towards lights: part of exact.h. From the papers that the header names, in their words. The
 * angles of a small light cancel: of a solid angle of 1e-17 the 113 bits leave 1e-16. */

/* A light as it is given to the header: where it is lit, and numbers. */
typedef struct {
    int id;
    float p[3];
    float at[3][3]; /* centre; centre and normal; corner and two edges; three corners */
    float r;        /* radius of the first two */
} given_light;

/* The same, seen from p. What only depends on the light is found once, as many directions are asked about. */
typedef struct {
    int id;
    q3 at[3];
    qd r;
    qd rim;        /* of a ball: the largest angle between its centre and a direction that meets it */
    qd all;        /* its solid angle; of a disk, which has no use for it, 0 */
    int sides;     /* of polygons */
    q3 inwards[4]; /* the unit normal of the plane through the eye and a side */
    q3 normal;     /* of their plane, of unit length */
    qd farthest;   /* the distance of their farthest corner */
} light;

/* Where a sample meets it; x, y: the place on the light, as the header counts it. */
typedef struct {
    q3 w;
    qd distance, x, y;
} place;

static inline void put3(float v[3], float x, float y, float z) {
    v[0] = x;
    v[1] = y;
    v[2] = z;
}
/* Those of the registry: the floats that row_lights.h makes of two parameters. */
static inline given_light row_light(int id, float a, float b) {
    const float h = a * b;
    const float z = 1.0f - 0.0625f * a;
    given_light g;
    memset(&g, 0, sizeof g);
    g.id = id;
    g.r = b;
    put3(g.at[0], -0.5f * a, 0.25f * a, a);
    if (id == ID_disk_light) put3(g.at[1], 0.48f, 0.6f, -0.64f);
    if (id == ID_spherical_rectangle) {
        put3(g.at[0], -0.25f * a, -0.5f * h, z - 0.0625f * h);
        put3(g.at[1], a, 0, 0.25f * a);
        put3(g.at[2], 0, h, 0.125f * h);
    }
    if (id == ID_spherical_triangle) {
        put3(g.at[0], -a, -h, 1.25f - 0.25f * h);
        put3(g.at[1], 0.9f * a, -0.5f * h, 1.25f - 0.125f * h);
        put3(g.at[2], 0.25f * a, h, 1.25f + 0.25f * h);
    }
    return g;
}
static inline q3 unit(q3 v) { return times(1 / len(v), v); }
static inline q3 minus(q3 a, q3 b) { return add(a, times(-1, b)); }
static inline qd angle_between(q3 a, q3 b) { return atan2q(len(cross(a, b)), dot(a, b)); }
/* v in the frame of the unit vector n, as Duff et al. 2017 build it: -0 has a sign, too. */
static inline q3 in_frame(q3 n, q3 v) {
    const qd sign = copysignq(1, n.z);
    const qd a = -1 / (sign + n.z);
    const q3 s = vec(1 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x);
    const q3 t = vec(n.x * n.y * a, sign + n.y * n.y * a, -n.y);
    return add(add(times(v.x, s), times(v.y, t)), times(v.z, n));
}

/* --- ball: the cone of Wang 1992, or all directions --- */

static inline qd ball_radius(const light *l) { return fmaxq(l->r, (qd)1e-15 * len(l->at[0])); }
static inline q3 ball_axis(const light *l) { return len(l->at[0]) < (qd)1e-18f ? vec(0, 0, 1) : unit(l->at[0]); }
static inline qd ball_versine(const light *l) {
    const qd sine = ball_radius(l) / len(l->at[0]);
    return len(l->at[0]) > ball_radius(l) ? sine * sine / (1 + root_of(1 - sine * sine)) : 2;
}
/* The surface is where |t w - c| = r: of the two roots of t, whose product is c^2 - r^2, one does not cancel. */
static inline place ball_seen(const light *l, qd u1, qd u2) {
    const qd d = len(l->at[0]);
    const qd r = ball_radius(l);
    const qd m = ball_versine(l) * u1;
    const qd along = d * (1 - m);
    const qd root = root_of(fmaxq(r * r - d * d * m * (2 - m), 0));
    place s;
    s.w = in_frame(ball_axis(l), at_versine(m, 2 * pi * u2));
    s.x = s.y = 0;
    if (d > r) s.distance = (d - r) * (d + r) / (along + root);
    else s.distance = along >= 0 ? along + root : (r - d) * (r + d) / (root - along);
    return s;
}
static inline qd ball_rim(const light *l) {
    const qd d = len(l->at[0]);
    return d > ball_radius(l) ? asinq(ball_radius(l) / d) : pi;
}
static inline qd ball_miss(const light *l, q3 w) { return l->rim < pi ? angle_between(l->at[0], w) - l->rim : -pi; }

/* --- disk_light: uniform in area --- */

static inline qd disk_radius(const light *l) {
    const q3 c = l->at[0];
    return fmaxq(l->r, (qd)1e-15 * fmaxq(fmaxq(fabsq(c.x), fabsq(c.y)), fabsq(c.z)));
}
/* From the point `at` of its plane: an area a has a |cos| / distance^2. */
static inline qd disk_density(const light *l, q3 at) {
    const qd cosine = fabsq(dot(at, unit(l->at[1]))) / len(at);
    return cosine < (qd)1e-7 ? 0 : dot(at, at) / (pi * square(disk_radius(l)) * cosine);
}
static inline place disk_seen(const light *l, qd u1, qd u2) {
    const q3 at = add(l->at[0], times(disk_radius(l), in_frame(unit(l->at[1]), concentric(u1, u2))));
    place s;
    s.w = unit(at);
    s.distance = len(at);
    s.x = s.y = 0;
    return s;
}
/* Where w meets the plane, from the centre; *t is how far that is. */
static inline q3 disk_off(const light *l, q3 w, qd *t) {
    *t = dot(l->at[0], l->at[1]) / dot(w, l->at[1]);
    return minus(times(*t, w), l->at[0]);
}
/* By how much w misses it, to first order: |off|^2 - r^2 over its gradient among unit vectors w. */
static inline qd disk_miss(const light *l, q3 w) {
    qd t;
    w = unit(w);
    const q3 off = disk_off(l, w, &t);
    const qd r = disk_radius(l);
    const q3 gradient = times(2 * t, minus(off, times(dot(off, w) / dot(w, l->at[1]), l->at[1])));
    return t > 0 && t < HUGE_VALQ ? (len(off) - r) * (len(off) + r) / len(gradient) : pi;
}

/* --- spherical_rectangle: Urena, Fajardo and King 2013, x by the solid angle itself --- */

typedef struct {
    q3 x, y, z; /* axes, z from the eye to the plane */
    qd x0, x1, y0, y1, z0;
    qd left[2]; /* what is before x0, of the strip */
} frame_of_rectangle;

/* The solid angle of what is between the foot of the perpendicular and (x, y). */
static inline qd quadrant(qd x, qd y, qd z) { return atanq(x * y / (z * root_of(x * x + y * y + z * z))); }
static inline frame_of_rectangle rectangle_of(const light *l) {
    frame_of_rectangle f;
    f.x = unit(l->at[1]);
    const q3 edge_y = minus(l->at[2], times(dot(l->at[2], f.x), f.x));
    f.y = unit(edge_y);
    f.z = cross(f.x, f.y);
    if (dot(l->at[0], f.z) < 0) f.z = times(-1, f.z);
    f.z0 = dot(l->at[0], f.z);
    f.x0 = dot(l->at[0], f.x);
    f.y0 = dot(l->at[0], f.y);
    f.x1 = f.x0 + len(l->at[1]);
    f.y1 = f.y0 + len(edge_y);
    f.left[0] = quadrant(f.x0, f.y0, f.z0);
    f.left[1] = quadrant(f.x0, f.y1, f.z0);
    return f;
}
/* The solid angle of the strip before x. */
static inline qd strip(const frame_of_rectangle *f, qd x) {
    return quadrant(x, f->y1, f->z0) - quadrant(x, f->y0, f->z0) - f->left[1] + f->left[0];
}
static inline qd rectangle_angle(const light *l) {
    const frame_of_rectangle f = rectangle_of(l);
    return strip(&f, f.x1);
}
/* By bisection and Newton's method in the angle of x about the y axis. */
static inline qd rectangle_x(const frame_of_rectangle *f, qd share) {
    qd lo = atanq(f->x0 / f->z0);
    qd hi = atanq(f->x1 / f->z0);
    for (int i = 0; i < 40; i++) {
        const qd middle = (lo + hi) / 2;
        if (strip(f, f->z0 * tanq(middle)) < share) lo = middle;
        else hi = middle;
    }
    qd angle = (lo + hi) / 2;
    for (int i = 0; i < 3; i++) {
        const qd x = f->z0 * tanq(angle);
        const qd d2 = x * x + f->z0 * f->z0;
        angle -= (strip(f, x) - share) / (f->y1 / root_of(d2 + f->y1 * f->y1) - f->y0 / root_of(d2 + f->y0 * f->y0));
    }
    return fminq(fmaxq(f->z0 * tanq(angle), f->x0), f->x1);
}
/* 1 - h, where h = y / sqrt(d^2 + y^2) */
static inline qd less_than_1(qd d, qd y) {
    const qd s = root_of(d * d + y * y);
    return y > 0 ? d * d / (s * (s + y)) : (s - y) / s;
}
static inline place rectangle_seen(const light *l, qd u1, qd u2) {
    const frame_of_rectangle f = rectangle_of(l);
    const qd x = rectangle_x(&f, u1 * strip(&f, f.x1));
    const qd d = root_of(x * x + f.z0 * f.z0);
    const qd above = (1 - u2) * less_than_1(d, f.y0) + u2 * less_than_1(d, f.y1);   /* 1 - h */
    const qd below = (1 - u2) * less_than_1(d, -f.y0) + u2 * less_than_1(d, -f.y1); /* 1 + h */
    const qd y = fminq(fmaxq(d * (below - above) / (2 * root_of(above * below)), f.y0), f.y1);
    const q3 at = add(add(times(x, f.x), times(y, f.y)), times(f.z0, f.z));
    place s;
    s.w = unit(at);
    s.distance = len(at);
    s.x = (x - f.x0) / (f.x1 - f.x0);
    s.y = (y - f.y0) / (f.y1 - f.y0);
    return s;
}

/* --- spherical_triangle: Arvo 1995, solid angles by Van Oosterom and Strackee 1983 --- */

static inline qd triple(q3 a, q3 b, q3 c) { return dot(a, cross(minus(b, a), minus(c, a))); }
static inline qd triangle_angle(const light *l) {
    const q3 a = unit(l->at[0]);
    const q3 b = unit(l->at[1]);
    const q3 c = unit(l->at[2]);
    return 2 * atan2q(fabsq(triple(a, b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}
/* C' at the angle v from A towards C makes with A and B the solid angle E of
 *     tan(E/2) = [A, B, T] tan(v/2) / (1 + A.B + B.T tan(v/2)),
 * where T is the unit vector at right angles to A there: theirs, divided by 1 + cos(v). Then from B to C' by cosines. */
static inline place triangle_seen(const light *l, qd u1, qd u2) {
    const q3 a = unit(l->at[0]);
    const q3 b = unit(l->at[1]);
    const q3 c = unit(l->at[2]);
    const q3 t = unit(cross(cross(a, minus(c, a)), a));
    const qd half = u1 * l->all / 2;
    const qd v =
        2 * atan2q(sinq(half) * (1 + dot(a, b)), cosq(half) * fabsq(triple(a, b, add(a, t))) - sinq(half) * dot(b, t));
    const q3 end = add(times(cosq(v), a), times(sinq(v), t));
    const q3 way = unit(cross(cross(b, minus(end, b)), b));
    const qd to_end = angle_between(b, end);
    const qd part = 2 * asinq(root_of(u2) * sinq(to_end / 2)); /* 1 - z = u2 (1 - C'.B) */
    const q3 w = add(times(cosq(part), b), times(sinq(part), way));
    const q3 normal = cross(minus(l->at[1], l->at[0]), minus(l->at[2], l->at[0]));
    place s;
    s.w = w;
    s.distance = dot(l->at[0], normal) / dot(w, normal);
    const q3 at = minus(times(s.distance, w), l->at[2]);
    s.x = dot(cross(at, minus(l->at[1], l->at[2])), normal) / dot(normal, normal);
    s.y = dot(cross(minus(l->at[0], l->at[2]), at), normal) / dot(normal, normal);
    return s;
}

/* --- all of them --- */

static inline int corners_of(const light *l, q3 corner[4]) {
    corner[0] = l->at[0];
    if (l->id == ID_spherical_triangle) {
        corner[1] = l->at[1];
        corner[2] = l->at[2];
        return 3;
    }
    const q3 x = unit(l->at[1]);
    const q3 y = minus(l->at[2], times(dot(l->at[2], x), x));
    corner[1] = add(l->at[0], l->at[1]);
    corner[2] = add(corner[1], y);
    corner[3] = add(l->at[0], y);
    return 4;
}
static inline void find_sides(light *l) {
    q3 corner[4];
    const int n = corners_of(l, corner);
    for (int i = 0; i < n; i++) {
        l->inwards[i] = unit(cross(corner[i], minus(corner[(i + 1) % n], corner[i])));
        if (dot(l->inwards[i], corner[(i + 2) % n]) < 0) l->inwards[i] = times(-1, l->inwards[i]);
    }
    l->normal = unit(cross(minus(corner[1], corner[0]), minus(corner[2], corner[0])));
    if (dot(l->normal, corner[0]) < 0) l->normal = times(-1, l->normal);
    l->farthest = 0;
    for (int i = 0; i < n; i++) l->farthest = fmaxq(l->farthest, len(corner[i]));
    l->sides = n;
}
/* By which angle w misses a cone of corners: that to the plane of the side that it is furthest beyond. Behind p all
 * sides of a small light are close to w, but the plane of the light is not. */
static inline qd corners_miss(const light *l, q3 w) {
    const qd length = len(w);
    qd miss = -dot(l->normal, w) / length;
    for (int i = 0; i < l->sides; i++) miss = fmaxq(miss, -dot(l->inwards[i], w) / length);
    return miss;
}
static inline qd light_miss(const light *l, q3 w) {
    if (l->id == ID_ball) return ball_miss(l, w);
    if (l->id == ID_disk_light) return disk_miss(l, w);
    return corners_miss(l, w);
}
/* How far off a direction has the density of the light nevertheless, as rounding may move a sample over the rim: by half
 * an ulp in each coordinate. Prepared lights have it in front of their plane alone. */
static inline qd light_needed(const light *l, q3 w) { return l->sides && dot(l->normal, w) <= 0 ? -pi : (qd)0x1p-24; }
/* The angle by which the sides of corners are off along w. In double, axes and corners seen from p are off by 4 x 2^-53
 * of the farthest one; part I states 1e-15. Where w meets the plane at the distance t, that is as much over t. */
static inline qd side_slack(const light *l, q3 w) {
    const qd t = fabsq(dot(l->at[0], l->normal) / dot(unit(w), l->normal));
    return fmaxq((qd)1e-14, (qd)1e-15 * l->farthest / t);
}
/* How far off it may have one: what the header states, and the rounding of double. */
static inline qd light_forgiven(const light *l, q3 w) {
    if (l->id == ID_ball) return (qd)0x1p-20;
    if (l->id == ID_disk_light) return (qd)0x1p-23 * len(w) * len(l->at[1]) / fabsq(dot(w, l->at[1]));
    return (qd)0x1p-22 + side_slack(l, w);
}
/* Where either answer is right. */
static inline int light_at_rim(const light *l, q3 w) {
    const qd miss = light_miss(l, w);
    return miss > light_needed(l, w) && miss <= light_forgiven(l, w);
}

static inline light seen_from_p(const given_light *g) {
    light l;
    memset(&l, 0, sizeof l);
    l.id = g->id;
    l.r = g->r;
    const q3 p = vec(g->p[0], g->p[1], g->p[2]);
    for (int i = 0; i < 3; i++) {
        const int is_place = i == 0 || g->id == ID_spherical_triangle; /* else an edge or a normal */
        const q3 at = vec(g->at[i][0], g->at[i][1], g->at[i][2]);
        l.at[i] = is_place ? minus(at, p) : at;
    }
    if (l.id == ID_ball) {
        l.rim = ball_rim(&l);
        l.all = 2 * pi * ball_versine(&l);
    } else if (l.id == ID_spherical_rectangle || l.id == ID_spherical_triangle) {
        find_sides(&l);
        l.all = l.id == ID_spherical_rectangle ? rectangle_angle(&l) : triangle_angle(&l);
    }
    return l;
}

static inline place light_seen(const light *l, qd u1, qd u2) {
    return l->id == ID_ball                  ? ball_seen(l, u1, u2)
           : l->id == ID_disk_light          ? disk_seen(l, u1, u2)
           : l->id == ID_spherical_rectangle ? rectangle_seen(l, u1, u2)
                                             : triangle_seen(l, u1, u2);
}
static inline qd light_pdf(const light *l, q3 w) {
    qd t;
    if (!(light_miss(l, w) <= light_needed(l, w))) return 0;
    return l->id == ID_disk_light ? disk_density(l, add(l->at[0], disk_off(l, w, &t))) : 1 / l->all;
}

/* --- what the header says --- */

static inline mcs_vec3 vec3_of(const float v[3]) {
    mcs_vec3 w;
    w.x = v[0];
    w.y = v[1];
    w.z = v[2];
    return w;
}
static inline mcs_light_point with_place(mcs_light s) {
    mcs_light_point at;
    at.w = s.w;
    at.pdf = s.pdf;
    at.distance = s.distance;
    at.x = at.y = 0;
    return at;
}
static inline mcs_light_point header_sample(const given_light *g, float u1, float u2) {
    const mcs_vec3 p = vec3_of(g->p);
    const mcs_vec3 a = vec3_of(g->at[0]);
    const mcs_vec3 b = vec3_of(g->at[1]);
    const mcs_vec3 c = vec3_of(g->at[2]);
    if (g->id == ID_ball) return with_place(mcs_ball_sample(p, a, g->r, u1, u2));
    if (g->id == ID_disk_light) return with_place(mcs_disk_light_sample(p, a, b, g->r, u1, u2));
    if (g->id == ID_spherical_rectangle) {
        const mcs_spherical_rectangle l = mcs_spherical_rectangle_make(p, a, b, c);
        return mcs_spherical_rectangle_sample(&l, u1, u2);
    }
    const mcs_spherical_triangle l = mcs_spherical_triangle_make(p, a, b, c);
    return mcs_spherical_triangle_sample(&l, u1, u2);
}
static inline float header_pdf(const given_light *g, const float w[3]) {
    const mcs_vec3 p = vec3_of(g->p);
    const mcs_vec3 a = vec3_of(g->at[0]);
    const mcs_vec3 b = vec3_of(g->at[1]);
    const mcs_vec3 c = vec3_of(g->at[2]);
    if (g->id == ID_ball) return mcs_ball_pdf(p, a, g->r, vec3_of(w));
    if (g->id == ID_disk_light) return mcs_disk_light_pdf(p, a, b, g->r, vec3_of(w));
    if (g->id == ID_spherical_rectangle) {
        const mcs_spherical_rectangle l = mcs_spherical_rectangle_make(p, a, b, c);
        return mcs_spherical_rectangle_pdf(&l, vec3_of(w));
    }
    const mcs_spherical_triangle l = mcs_spherical_triangle_make(p, a, b, c);
    return mcs_spherical_triangle_pdf(&l, vec3_of(w));
}
