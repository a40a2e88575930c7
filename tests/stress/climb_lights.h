/* Lights for the adversary of climb.c: part of it. Any light that the header takes, anywhere, not only those of the
 * registry's rows; inputs count as they are. What the header does not promise of a light has no score. */

/* A vector of the length `size` in any direction. */
static void any_vector(double size, double v[3]) {
    const double z = one_in(4) ? any_step(1) : 2 * flat() - 1;
    const double azimuth = 6.283185307179586 * (one_in(4) ? floor(4 * flat()) / 4 + any_step(0.1) : flat());
    const double s = sqrt((1 - z) * (1 + z));
    v[0] = size * s * cos(azimuth);
    v[1] = size * s * sin(azimuth);
    v[2] = size * z;
}
static double any_power(double least, double most) { return pow(10, least + (most - least) * flat()); }
static void put(float to[3], const double from[3]) { put3(to, (float)from[0], (float)from[1], (float)from[2]); }

/* Two edges from a corner that lies anywhere about the foot of the perpendicular from the origin, as far as they are
 * long or much further and nearer. Edges of a rectangle are at right angles half of the time. */
static void any_polygon(given_light *g, double size) {
    double edge[2][3];
    double normal[3];
    double corner[3];
    any_vector(size, edge[0]);
    any_vector(size * any_power(-5, 0), edge[1]);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        normal[i] = (edge[0][j] * edge[1][k] - edge[0][k] * edge[1][j]) / size;
    }
    const double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    const double height = size * any_power(-9, 4) / fmax(length, 1e-30);
    const int square = one_in(2);
    const double along = one_in(2) ? flat() : any_step(1e3);
    const double across = one_in(2) ? flat() : any_step(1e3);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        corner[i] = height * normal[i] - along * edge[0][i] - across * edge[1][i];
        if (square) edge[1][i] = (normal[j] * edge[0][k] - normal[k] * edge[0][j]) / size;
    }
    put(g->at[0], corner);
    for (int n = 0; n < 2; n++) {
        if (g->id == ID_spherical_triangle)
            for (int i = 0; i < 3; i++) edge[n][i] += corner[i];
        put(g->at[n + 1], edge[n]);
    }
}
static void make_unit(float v[3]) {
    const double l = sqrt((double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2]);
    if (l > 0) put3(v, (float)((double)v[0] / l), (float)((double)v[1] / l), (float)((double)v[2] / l));
}
static given_light any_light(int id) {
    const double size = one_in(2) ? 1 : any_power(-9, 9);
    double v[3];
    given_light g;
    memset(&g, 0, sizeof g);
    g.id = id;
    if (id == ID_ball || id == ID_disk_light) {
        any_vector(size, v);
        put(g.at[0], v);
        any_vector(1, v);
        put(g.at[1], v);
        make_unit(g.at[1]);
        g.r = (float)(size * (one_in(4) ? 1 + any_step(0.1) : any_power(id == ID_ball ? -9 : -6, 4)));
    } else any_polygon(&g, size);
    if (one_in(2)) return g;
    any_vector(size * any_power(-3, 3), v);
    put(g.p, v);
    for (int i = 0; i < (id == ID_spherical_triangle ? 3 : 1); i++)
        for (int k = 0; k < 3; k++) g.at[i][k] += g.p[k];
    return g;
}
static void move_light(given_light *g) {
    float *const v = one_in(4) ? g->p : g->at[mcst_mix(&state) % 3];
    const size_t k = mcst_mix(&state) % 3;
    if (one_in(3)) v[k] = ulps(v[k], (int)(mcst_mix(&state) % 9) - 4);
    else if (one_in(2)) v[k] += (float)(any_step(1) * (fabs((double)v[0]) + fabs((double)v[1]) + fabs((double)v[2])));
    else {
        const float factor = (float)exp(any_step(2));
        for (int i = 0; i < 3; i++) v[i] *= factor;
    }
    if (one_in(3)) g->r = one_in(2) ? ulps(g->r, (int)(mcst_mix(&state) % 9) - 4) : g->r * (float)exp(any_step(2));
    if (one_in(20)) v[k] = 0;
    if (g->id == ID_disk_light) make_unit(g->at[1]);
}

/* --- what is promised --- */

/* Numbers of the header's range, and of corners a solid angle of 1e-12 and more, a length of at most 1e5 widths, and a
 * plane that is not next to p: the normal is off by a few 2^-53, and p is off as much of its distance. */
static int is_light(const given_light *g, const light *l) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (!(fabsf(g->at[i][k]) <= 1e18f && fabsf(g->p[k]) <= 1e18f)) return 0;
    if (g->id == ID_ball || g->id == ID_disk_light) return g->r >= 1e-18f && g->r <= 1e18f;
    const int corners = g->id == ID_spherical_triangle;
    const q3 edge_x = corners ? minus(l->at[1], l->at[0]) : l->at[1];
    const q3 edge_y = corners ? minus(l->at[2], l->at[0]) : l->at[2];
    const qd twice_area = len(cross(edge_x, edge_y));
    const qd length = fmaxq(fmaxq(len(edge_x), corners ? len(edge_y) : twice_area / len(edge_x)),
                            corners ? len(minus(edge_x, edge_y)) : 0);
    if (!(twice_area > 0 && length * length <= (qd)1e5 * twice_area)) return 0;
    const qd height = fabsq(dot(l->at[0], cross(edge_x, edge_y))) / twice_area;
    if (!(height > (qd)1e-8 * (length + len(l->at[0])))) return 0;
    return (corners ? triangle_angle(l) : rectangle_angle(l)) >= (qd)1e-12;
}
/* Density and distance of a ball up to 1e9 radii away and at least 1e-8 d from its surface, all of a disk from 1e-4
 * radii on. In double d^2 - r^2 is off by 5 x 2^-53 d^2: 2 by the rounded differences, 1 by the squares, 2 by the sums.
 * At 1e-8 d from the surface it is 2e-8 d^2, so that is 2.8e-8 of it. With 6e-8 of the float, 1e-7 holds. */
static int is_promised(const light *l, int figure, qd distance) {
    if (l->id == ID_disk_light) return distance >= (qd)1e-4 * l->r;
    if (l->id != ID_ball || figure == CLAIM_WHERE || figure == CLAIM_LENGTH) return 1;
    const qd d = len(l->at[0]);
    return d <= (qd)1e9 * l->r && fabsq(d - l->r) >= (qd)1e-8 * d;
}

/* --- scores --- */

static double relative_error(float got, qd want) {
    if (want == 0) return got == 0 ? 0 : 1e9;
    return want < (qd)FLT_MAX && want > (qd)FLT_MIN ? fabs((double)(((qd)got - want) / want)) / 1e-6 : 0;
}
static double largest(q3 v) { return (double)fmaxq(fmaxq(fabsq(v.x), fabsq(v.y)), fabsq(v.z)); }

static double score_of_direction(const given_light *g, const light *l, const float w[3]) {
    const q3 x = vec(w[0], w[1], w[2]);
    qd t = 1;
    if (light_at_rim(l, x)) return 0;
    if (g->id == ID_disk_light) disk_off(l, x, &t);
    return is_promised(l, CLAIM_PDF_W, t) ? relative_error(header_pdf(g, w), light_pdf(l, x)) : 0;
}
static double score_of_light(int figure, const given_light *g, const float u[2], const float w[3]) {
    const light l = seen_from_p(g);
    if (!is_light(g, &l)) return 0;
    if (figure == CLAIM_PDF_W) return score_of_direction(g, &l, w);
    const mcs_light_point got = header_sample(g, u[0], u[1]);
    const q3 at = vec(got.w.x, got.w.y, got.w.z);
    const place want = light_seen(&l, u[0], u[1]);
    if (!is_promised(&l, figure, want.distance)) return 0;
    switch (figure) {
    case CLAIM_LENGTH: return fabs((double)(len(at) - 1)) / EPS;
    case CLAIM_WHERE: return largest(minus(at, want.w)) / EPS;
    case CLAIM_PLACE: return largest(vec(got.x - want.x, got.y - want.y, 0)) / EPS;
    case CLAIM_DISTANCE: return got.pdf > 0 ? relative_error(got.distance, want.distance) : 0;
    default: return relative_error(got.pdf, light_pdf(&l, want.w));
    }
}
