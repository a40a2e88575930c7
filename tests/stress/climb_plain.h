/* Functions of a few floats that have no row, for the adversary of climb.c: part of it. What is given is what floats
 * say, and directions are unit to half an ulp. */

enum { INPUTS = 7 };

typedef struct {
    const char *name;
    double claim; /* of the header, in the unit of the score */
    void (*any)(float x[INPUTS]);
    void (*move)(float x[INPUTS]);
    double (*score)(const float x[INPUTS]);
} plain_figure;

/* --- a smooth surface: eta, k, the cosine ------------------------------------------------------------------------- */

static float any_eta(void) {
    const double x = one_in(2) ? pow(3, 2 * flat() - 1) : 1 + any_step(0.5);
    return clamped(x, 0.33333334, 3);
}
/* The cosine at which total reflection begins, with the sign of its side. */
static double critical_cosine(double eta) {
    return eta < 1 ? sqrt((1 - eta) * (1 + eta)) : -sqrt((1 - 1 / eta) * (1 + 1 / eta));
}
static double any_cosine(double eta) {
    const double c = one_in(3) ? any_step(1) : one_in(2) ? 1 - fabs(any_step(1)) : critical_cosine(eta) + any_step(0.1);
    return one_in(2) ? c : -c;
}
static void any_surface(float x[INPUTS]) {
    x[0] = any_eta();
    x[1] = one_in(4) ? 0 : clamped(pow(10, 12 * flat() - 9), 1.01e-9, 1e3);
    x[2] = clamped(any_cosine((double)x[0]), -1, 1);
}
static void move_surface(float x[INPUTS]) {
    static const double least[] = {0.33333334, 1.01e-9, -1};
    static const double most[] = {3, 1e3, 1};
    const size_t i = mcst_mix(&state) % 3;
    const double moved = one_in(3)   ? (double)ulps(x[i], (int)(mcst_mix(&state) % 9) - 4)
                         : one_in(2) ? (double)x[i] + any_step(1)
                                     : (double)x[i] * exp(any_step(1));
    x[i] = clamped(moved, least[i], most[i]);
}

/* Born and Wolf: the mean of both polarisations, by amplitudes. */
static qd exact_dielectric(qd c, qd eta) {
    const qd n = c < 0 ? 1 / eta : eta;
    const qd cosine = fabsq(c);
    const qd cos2_t = 1 - (1 - cosine) * (1 + cosine) / (n * n);
    if (cos2_t <= 0) return 1;
    const qd t = sqrtq(cos2_t);
    const qd parallel = (n * cosine - t) / (n * cosine + t);
    const qd across = (cosine - n * t) / (cosine + n * t);
    return (parallel * parallel + across * across) / 2;
}
/* The square root a + ib of (eta + ik)^2 - sin^2, from which both polarisations follow. */
static qd exact_conductor(qd cosine, qd eta, qd k) {
    const qd s2 = (1 - cosine) * (1 + cosine);
    const qd real = eta * eta - k * k - s2;
    const qd size = sqrtq(real * real + square(2 * eta * k));
    const qd a = real > 0 ? sqrtq((size + real) / 2) : eta * k / sqrtq((size - real) / 2);
    const qd across = (size + cosine * cosine - 2 * a * cosine) / (size + cosine * cosine + 2 * a * cosine);
    const qd tangents = s2 * s2 + cosine * cosine * size;
    return across / 2 * (1 + (tangents - 2 * a * cosine * s2) / (tangents + 2 * a * cosine * s2));
}
static double relative_to(float got, qd want) {
    return want > (qd)0x1p-100 ? fabs((double)(((qd)got - want) / want)) / 1e-6 : 0;
}
static double dielectric_score(const float x[INPUTS]) {
    return relative_to(mcs_fresnel_dielectric(x[2], x[0]), exact_dielectric(x[2], x[0]));
}
static double conductor_score(const float x[INPUTS]) {
    if (x[1] == 0) return relative_to(mcs_fresnel_conductor(fabsf(x[2]), x[0], 0), exact_dielectric(fabsf(x[2]), x[0]));
    return relative_to(mcs_fresnel_conductor(fabsf(x[2]), x[0], x[1]), exact_conductor(fabsf(x[2]), x[0], x[1]));
}

/* --- eta and two directions --------------------------------------------------------------------------------------- */

static q3 exactly(const float *x) { return vec(x[0], x[1], x[2]); }
static q3 exactly_of(mcs_vec3 v) { return vec(v.x, v.y, v.z); }
static mcs_vec3 given(const float *x) {
    mcs_vec3 v;
    v.x = x[0];
    v.y = x[1];
    v.z = x[2];
    return v;
}

static void any_pair(float x[INPUTS]) {
    double v[3];
    x[0] = any_eta();
    for (int i = 1; i <= 4; i += 3) {
        any_vector(1, v);
        put(x + i, v);
    }
    if (one_in(2)) { /* at a cosine to h of one's choice */
        const double c = fmin(fmax(any_cosine((double)x[0]), -1), 1);
        const q3 h = exactly(x + 4);
        const q3 side = cross(h, exactly(x + 1));
        if (len(side) < (qd)1e-3) return;
        const q3 s = times(1 / len(side), side);
        const q3 w = add(times(c, h), times(sqrt((1 - c) * (1 + c)), s));
        put3(x + 1, (float)w.x, (float)w.y, (float)w.z);
    }
}
static void move_pair(float x[INPUTS]) {
    const size_t i = mcst_mix(&state) % INPUTS;
    const double moved = one_in(3) ? (double)ulps(x[i], (int)(mcst_mix(&state) % 9) - 4) : (double)x[i] + any_step(1);
    x[i] = i == 0 ? clamped(moved, 0.33333334, 3) : (float)moved;
    make_unit(x + 1);
    make_unit(x + 4);
}

/* Snell's law in vectors; where the reflection is total, or within 1e-14 of it in the square of the cosine, `want` is
 * not set. */
static int exact_refraction(const float x[INPUTS], q3 *want) {
    const q3 w = unit(exactly(x + 1));
    const q3 h = unit(exactly(x + 4));
    const qd c = dot(w, h);
    const qd n = c < 0 ? (qd)x[0] : 1 / (qd)x[0];
    const qd cos2_t = 1 - n * n * (1 - fabsq(c)) * (1 + fabsq(c));
    if (cos2_t <= (qd)1e-14) return 0;
    *want = add(times(-n, w), times(n * c - copysignq(sqrtq(cos2_t), c), h));
    return 1;
}
static double refract_score(const float x[INPUTS]) {
    q3 want;
    if (!exact_refraction(x, &want)) return 0;
    return largest(minus(exactly_of(mcs_refract(given(x + 1), given(x + 4), x[0])), want)) / EPS;
}
static double refract_length_score(const float x[INPUTS]) {
    q3 want;
    if (!exact_refraction(x, &want)) return 0;
    return fabs((double)(len(exactly_of(mcs_refract(given(x + 1), given(x + 4), x[0]))) - 1)) / EPS;
}

/* What s and t of a frame lack of being unit, at right angles to each other and to n, in ulps of 1. */
static double frame_score(const float x[INPUTS]) {
    const mcs_frame f = mcs_frame_make(given(x + 1));
    const q3 s = exactly_of(f.s);
    const q3 t = exactly_of(f.t);
    const q3 n = exactly_of(f.n);
    const qd off[5] = {len(s) - 1, len(t) - 1, dot(s, t), dot(s, n), dot(t, n)};
    double worst = 0;
    for (int i = 0; i < 5; i++) worst = fmax(worst, fabs((double)off[i]) / (2 * EPS));
    return worst;
}
/* The tangent is the second direction, which has another frame where it is too near to n. */
static double tangent_score(const float x[INPUTS]) {
    const q3 n = exactly(x + 1);
    const q3 tangent = exactly(x + 4);
    if (len(cross(n, tangent)) < (qd)1.01e-6 * len(tangent)) return 0;
    const q3 s = unit(minus(times(dot(n, n), tangent), times(dot(tangent, n), n)));
    return largest(minus(exactly_of(mcs_frame_from_tangent(given(x + 1), given(x + 4)).s), s)) / EPS;
}

static const plain_figure plain_figures[] = {
    {"reflectance of a dielectric", 1.6, any_surface, move_surface, dielectric_score},
    {"reflectance of a conductor", 1.2, any_surface, move_surface, conductor_score},
    {"refracted direction", 2, any_pair, move_pair, refract_score},
    {"its length", 4, any_pair, move_pair, refract_length_score},
    {"frame", 4, any_pair, move_pair, frame_score},
    {"frame from a tangent", 2, any_pair, move_pair, tangent_score},
};

static void attack_plain(const plain_figure *f, int climbs) {
    float at[INPUTS] = {0};
    double worst = -1;
    state = mcst_seed_for(f->name, "", 0);
    for (int n = 0; n < climbs; n++) {
        float best[INPUTS] = {0};
        double score = -1;
        for (int i = 0; i < 600; i++) {
            float x[INPUTS];
            memcpy(x, best, sizeof x);
            if (i < 100) f->any(x);
            else do
                    f->move(x);
                while (one_in(3));
            const double here = f->score(x);
            if (here <= score) continue;
            score = here;
            memcpy(best, x, sizeof best);
        }
        if (score <= worst) continue;
        worst = score;
        memcpy(at, best, sizeof at);
    }
    CHECK(worst <= f->claim, "%.3g at %a %a %a %a %a %a %a", worst, (double)at[0], (double)at[1], (double)at[2],
          (double)at[3], (double)at[4], (double)at[5], (double)at[6]);
    mcst_note("  %-45s %6.3f of %4.2f\n", f->name, worst, f->claim);
}
