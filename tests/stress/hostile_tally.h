/* What the parts of hostile.c count and print. */
#ifndef HOSTILE_TALLY_H
#define HOSTILE_TALLY_H
#include "stress.h"

/* What was counted, for the table. */
typedef struct {
    double evaluations, nans, infinities, negative, not_unit, not_discarded, outside;
} tally;
static const tally nothing = {0, 0, 0, 0, 0, 0, 0};
static double all_evaluations;

static int proper(tally *t, float v) { /* finite and not negative */
    t->nans += isnan(v) != 0;
    t->infinities += isinf(v) != 0;
    t->negative += v < 0;
    return v >= 0 && v <= FLT_MAX;
}
static int finite(tally *t, float v) {
    t->nans += isnan(v) != 0;
    t->infinities += isinf(v) != 0;
    return fabsf(v) <= FLT_MAX;
}

static int below_one(tally *t, float v) {
    const int inside = v >= 0 && v < 1;
    t->nans += isnan(v) != 0;
    t->outside += !inside;
    return inside;
}

static void print_head(void) {
    mcst_note("%-22s %12s %5s %5s %9s %9s %14s %9s\n", "", "evaluations", "NaN", "inf", "negative", "not unit",
              "not discarded", "range");
}
static void print_tally(const char *name, const tally *t) {
    mcst_note("%-22s %12.0f %5.0f %5.0f %9.0f %9.0f %14.0f %9.0f\n", name, t->evaluations, t->nans, t->infinities,
              t->negative, t->not_unit, t->not_discarded, t->outside);
    all_evaluations += t->evaluations;
}
#endif
