/* The adversary of fireflies.c: up to three lamps before even light or none, any surface, material and eye. It climbs
 * towards the largest sample. */
#ifndef MCST_FIREFLIES_CLIMB_H
#define MCST_FIREFLIES_CLIMB_H
#include "fireflies_grid.h"

enum { LAMPS = 3, CLIMB_W = 128, CLIMB_H = 64 };
#define LEAST_ALPHA (-1.7) /* a logarithm: 0.02 */

static uint64_t state;
static double flat(void) { return (double)(mcst_mix(&state) >> 11) * 0x1p-53; }
static int one_in(unsigned n) { return mcst_mix(&state) % n == 0; }
/* Small steps are as likely as large ones. */
static double any_step(double largest) { return (one_in(2) ? largest : -largest) * pow(10, -3 * flat()); }

/* A lamp: texels and the logarithm of its radiance, to base 10. */
typedef struct {
    double row, col, high, wide, radiance;
} lamp;
typedef struct {
    int lamps;
    lamp lamp[LAMPS];
    double background; /* a logarithm, too; below -2 there is none */
    double normal_z, normal_turn, eye_z, eye_turn;
    double a, b, matte; /* logarithms of the material's numbers */
    material_kind kind;
} trial;

static double clamped(double x, double least, double most) { return fmin(fmax(x, least), most); }
static double wrapped(double x, double period) { return x - period * floor(x / period); }

static lamp any_lamp(void) {
    lamp l;
    l.row = CLIMB_H * flat();
    l.col = CLIMB_W * flat();
    l.high = pow(10, 1.2 * flat());
    l.wide = pow(10, 1.2 * flat());
    l.radiance = 4 * flat();
    return l;
}
static trial any_trial(material_kind kind) {
    trial t;
    memset(&t, 0, sizeof t);
    t.kind = kind;
    t.lamps = 1 + (int)(mcst_mix(&state) % LAMPS);
    for (int k = 0; k < LAMPS; k++) t.lamp[k] = any_lamp();
    t.background = one_in(3) ? -3 : -2 + 2 * flat();
    t.normal_z = 2 * flat() - 1;
    t.normal_turn = flat();
    t.eye_z = pow(10, -1.3 * flat());
    t.eye_turn = flat();
    t.a = LEAST_ALPHA * flat();
    t.b = one_in(2) ? t.a : LEAST_ALPHA * flat();
    t.matte = one_in(2) ? 0 : flat();
    return t;
}
static void move_lamp(lamp *l) {
    if (one_in(3)) l->row = clamped(l->row + any_step(CLIMB_H), 0, CLIMB_H - 1);
    if (one_in(3)) l->col = wrapped(l->col + any_step(CLIMB_W), CLIMB_W);
    if (one_in(4)) l->high = clamped(l->high * exp(any_step(3)), 1, CLIMB_H);
    if (one_in(4)) l->wide = clamped(l->wide * exp(any_step(3)), 1, CLIMB_W);
    if (one_in(3)) l->radiance = clamped(l->radiance + any_step(3), 0, 4);
}
static void move_trial(trial *t) {
    do {
        if (one_in(2)) move_lamp(&t->lamp[mcst_mix(&state) % LAMPS]);
        if (one_in(8)) t->lamps = 1 + (int)(mcst_mix(&state) % LAMPS);
        if (one_in(6)) t->background = clamped(t->background + any_step(2), -3, 0);
        if (one_in(4)) t->normal_z = clamped(t->normal_z + any_step(1), -1, 1);
        if (one_in(4)) t->normal_turn = wrapped(t->normal_turn + any_step(0.5), 1);
        if (one_in(4)) t->eye_z = clamped(t->eye_z * exp(any_step(2)), 0.05, 1);
        if (one_in(4)) t->eye_turn = wrapped(t->eye_turn + any_step(0.5), 1);
        if (one_in(4)) t->a = clamped(t->a + any_step(1), LEAST_ALPHA, 0);
        if (one_in(4)) t->b = clamped(one_in(4) ? t->a : t->b + any_step(1), LEAST_ALPHA, 0);
        if (one_in(6)) t->matte = clamped(t->matte + any_step(0.5), 0, 0.9);
    } while (one_in(3));
}

static void trial_picture(const trial *t, picture *m) {
    const float even = t->background > -2 ? (float)pow(10, t->background) : 0.0f;
    for (size_t i = 0; i < (size_t)m->w * m->h; i++) m->light[i] = even;
    for (int k = 0; k < t->lamps; k++) {
        const lamp *l = &t->lamp[k];
        for (int row = (int)l->row; row < (int)l->row + (int)l->high && row < CLIMB_H; row++)
            for (int col = (int)l->col; col < (int)l->col + (int)l->wide; col++)
                m->light[row * CLIMB_W + col % CLIMB_W] = (float)pow(10, l->radiance);
    }
    picture_finish(m);
}
static worth trial_worth(const trial *t, picture *m, mcs_product *memory_of_it) {
    const double a = pow(10, t->a);
    const double b = pow(10, t->b);
    point s;
    memset(&s, 0, sizeof s);
    trial_picture(t, m);
    s.m = m;
    s.made_of.kind = t->kind;
    s.made_of.matte = (float)t->matte;
    s.made_of.a = (float)a;
    s.made_of.b = (float)b;
    if (t->kind == PHONG) s.made_of.a = (float)fmax(2 / (a * a), 10); /* nothing is known of smaller ones */
    if (t->kind == ASHIKHMIN) {
        s.made_of.a = (float)(2 / (a * a) - 2);
        s.made_of.b = (float)(2 / (b * b) - 2);
    }
    s.r.frame = mcs_frame_make(from_angles(t->normal_z, t->normal_turn));
    s.r.wo = from_angles(t->eye_z, t->eye_turn);
    reflection_set(&s);
    CHECK(product_set(&s, memory_of_it), "no product");
    return worth_of(&s, 0.5); /* an error of a per cent does not matter here */
}
static void trial_print(const trial *t, char *to, size_t size) {
    int n = snprintf(to, size, "kind %d, %.9g %.9g, matte %.9g, normal %.9g %.9g, eye %.9g %.9g, even %.9g",
                     (int)t->kind, pow(10, t->a), pow(10, t->b), t->matte, t->normal_z, t->normal_turn, t->eye_z,
                     t->eye_turn, t->background > -2 ? pow(10, t->background) : 0);
    for (int k = 0; k < t->lamps && n < (int)size; k++)
        n += snprintf(to + n, size - (size_t)n, "; lamp %d %d, %d x %d, %.9g", (int)t->lamp[k].row, (int)t->lamp[k].col,
                      (int)t->lamp[k].high, (int)t->lamp[k].wide, pow(10, t->lamp[k].radiance));
}

/* What is climbed: the largest sample over the answer, unless MIS has one as large. An answer that is worth nothing is
 * forgiven, as where next to all light is below the horizon. */
static double score_of(const worth *v, const picture *m) {
    if (!(v->answer > 0)) return 0;
    return v->largest / fmax(v->answer + worth_nothing(m), v->pair_largest);
}
static double climb(material_kind kind, int steps, trial *best) {
    picture m = picture_make("lamps", CLIMB_W, CLIMB_H);
    mcs_product *memory_of_it = (mcs_product *)memory(mcs_product_bytes(TILE_ROWS));
    double most = -1;
    for (int i = 0; i < steps; i++) {
        trial t = i < steps / 4 ? any_trial(kind) : *best;
        if (i >= steps / 4) move_trial(&t);
        const worth v = trial_worth(&t, &m, memory_of_it);
        const double score = score_of(&v, &m);
        if (!(score > most)) continue;
        most = score;
        *best = t;
    }
    free(memory_of_it);
    picture_free(&m);
    return most;
}
#endif
