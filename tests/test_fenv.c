/* Floating-point exceptions and modes. Valid input raises no invalid operation, no division by zero and no overflow:
 * hosts that trap them must survive every function, so operands of branches and lanes that are not taken count too. And
 * flush-to-zero with denormals-are-zero, which renderers set, changes nothing but what is subnormal.
 *
 * The functions are those of the header's part I, by the adapters of functions.h, so that a new one is covered at once.
 */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* feenableexcept */
#endif
#include <fenv.h>
#if defined(__clang__)
#pragma clang fp exceptions( \
    maytrap) /* else lanes of its own making divide 0 by 0: in functions that are compiled here */
#undef MCST_LINKED
#undef MCS_DECLARE
#endif
#if !defined(FE_INVALID) || !defined(FE_DIVBYZERO) || !defined(FE_OVERFLOW) || defined(__FAST_MATH__)
#define FENV_NONE /* a machine without these flags, or a build that does as it likes with them */
#endif
#ifdef FENV_NONE
#undef FE_INVALID
#undef FE_DIVBYZERO
#undef FE_OVERFLOW
enum { FE_INVALID, FE_DIVBYZERO, FE_OVERFLOW };
#endif
#include "functions.h"
#if defined(__unix__) || defined(__APPLE__)
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>
#define FENV_FORK
#endif

static float given[CASES][BITS_IN];
enum { TRAPS = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW, NS = 68 };
/* Inputs are drawn as often as this: what one draw of them raises may be missing in another. */
enum { DRAWS = 4 };

/* --- valid inputs ------------------------------------------------------------------------------------------------- */

static double unit_of(uint64_t *state) { return (double)(mcst_mix(state) >> 11) * 0x1p-53; }
static float spread(uint64_t *state, double lo, double hi) { return (float)(lo * pow(hi / lo, unit_of(state))); }

static float valid_u(uint64_t *state) {
    static const float edge[8] = {0, 0x1p-149f, 0x1p-126f, 0x1p-24f, 0.25f, 0.5f, 0.75f, 1 - 0x1p-24f};
    const uint64_t z = mcst_mix(state);
    return z % 4 ? (float)(int32_t)(z >> 40) * 0x1p-24f : edge[z >> 8 & 7];
}

/* A unit vector: above the surface, or anywhere, the horizon included. */
static void valid_direction(uint64_t *state, int above, float w[3]) {
    static const double cosines[8] = {1, 0.7, 0.35, 0.0871557, 1e-2, 1e-4, 1e-7, 1e-15};
    const uint64_t z = mcst_mix(state);
    const int axis = (int)(z >> 4 & 7), horizon = !above && (z >> 8 & 15) == 0;
    const double c = horizon ? 0 : z & 1 ? cosines[z >> 1 & 7] : 1 - unit_of(state), s = sqrt((1 - c) * (1 + c));
    const double turn = 2 * ST_PI * unit_of(state);
    w[0] = (float)(s * (axis < 2 ? 1 - axis : cos(turn))), w[1] = (float)(s * (axis == 1 ? -1 : axis ? sin(turn) : 0));
    w[2] = (float)(above || z & 128 ? c : -c);
}

/* Parameters of a row: of its grid, with their largest and least; or of a function without a row, any positive float.
 */
static void valid_parameters(const mcst_row *row, uint64_t *state, float set[3]) {
    const mcst_domain *d;
    const uint64_t z = mcst_mix(state);
    if (!row) {
        static const float edge[8] = {0, 0x1p-149f, FLT_MIN, 1e-30f, 1, 1e30f, 0x1p126f, 0x1p-24f};
        set[0] = z & 1 ? edge[z >> 1 & 7] : spread(state, 1e-37, 1e38),
        set[1] = z & 16 ? edge[z >> 5 & 7] : spread(state, 1e-37, 1e38);
        return;
    }
    if (z & 1) {
        memcpy(set, row->grid[(z >> 1) % row->grid_size], 2 * sizeof *set);
        return;
    }
    d = &row->domain;
    set[0] = (d->either_sign && !(z & 2) ? -1.0f : 1.0f) * spread(state, d->least[0], d->most[0]);
    if (d->least[1] == 0) return;
    if (row->coord == MCST_UNIT && z & 2) return;
    const int apart = row->coord == MCST_TRUNCATED || row->coord == MCST_WHOLELINE || row->coord == MCST_BETWEEN ||
                      row->coord == MCST_CUT;
    if (!apart && z & (row->coord == MCST_UNIT ? 4 : 2)) set[1] = set[0];
    else set[1] = spread(state, d->least[1], d->most[1]);
}

/* Points: mostly samples of the row; else, on a line or plane, about its scale or any float, and a direction that is
 * any. */
static void valid_point(const mcst_row *row, uint64_t *state, const float *of, float x[3]) {
    const uint64_t z = mcst_mix(state);
    valid_direction(state, 0, x);
    if (!row) return;
    if (z & 3) {
        const float u[2] = {valid_u(state), valid_u(state)};
        float out[5] = {0};
        row->fn[0].sample(of, &u[0], &u[1], out);
        memcpy(x, out, 3 * sizeof *x);
    } else if (row->shape == MCST_IS_LINE || row->shape == MCST_IS_PLANE) {
        for (int k = 0; k < 3; k++) {
            const double size =
                z & 4 ? fabs((double)of[k & 1]) * (double)spread(state, 0.1, 10) : (double)spread(state, 1e-45, 3.4e38);
            x[k] = (z >> (4 + k) & 1 ? 1.0f : -1.0f) * (float)fmin(size, FLT_MAX);
        }
    }
}

static void make_valid(const mcst_row *row, int draw) {
    uint64_t state = mcst_seed_for(row ? row->name : "others", "valid", (size_t)draw);
    int b, i, k;
    for (b = 0; b < BLOCKS; b++) {
        float set[U] = {0};
        valid_parameters(row, &state, set);
        valid_direction(&state, 1, set + WO);
        for (i = b * BLOCK; i < (b + 1) * BLOCK; i++) {
            memcpy(given[i], set, sizeof set);
            given[i][U] = valid_u(&state), given[i][U + 1] = valid_u(&state);
            valid_point(row, &state, set, given[i] + X);
            for (k = WORDS; k < BITS_IN; k++) {
                const uint32_t word = (uint32_t)(mcst_mix(&state) >> 32);
                memcpy(&given[i][k], &word, sizeof word);
            }
        }
    }
}

/* --- exceptions --------------------------------------------------------------------------------------------------- */

static const char *flags_of(int raised) {
    static char text[64];
    snprintf(text, sizeof text, "%s%s%s", raised & FE_INVALID ? " invalid" : "",
             raised & FE_DIVBYZERO ? " division by zero" : "", raised & FE_OVERFLOW ? " overflow" : "");
    return text;
}
/* What a call raises, and of what it was made, for the message. */
static void judge(const char *way, const float *in, size_t n) {
    const int raised = fetestexcept(TRAPS);
    CHECK(!raised, "%s, n = %lu:%s; p %a %a, wo %a %a %a, u %a %a, x %a %a %a", way, (unsigned long)n, flags_of(raised),
          (double)in[0], (double)in[1], (double)in[WO], (double)in[WO + 1], (double)in[WO + 2], (double)in[U],
          (double)in[U + 1], (double)in[X], (double)in[X + 1], (double)in[X + 2]);
}

static void raise_by_lanes(target t, int w) {
    const int lanes = w ? 2 << w : 1;
    int i, k, l;
    for (i = 0; i < CASES; i += lanes) {
        float in[BITS_IN * 16], out[BITS_OUT * 16] = {0};
        for (l = 0; l < lanes; l++)
            for (k = 0; k < BITS_IN; k++) memcpy(&in[k * lanes + l], &given[(i + l) * 1009 % CASES][k], sizeof *in);
        feclearexcept(FE_ALL_EXCEPT);
        call(t, w, lanes, in, out);
        judge(way_name[w], given[i * 1009 % CASES], (size_t)lanes);
    }
}

/* Array forms with every n up to 67. */
static void raise_by_arrays(target t) {
    static float in[5][CASES], out[6][CASES];
    float *const to[5] = {out[0], out[1], out[2], out[3], out[4]};
    size_t n;
    int b, i, k;
    for (b = 0; b + NS < CASES; b += 97)
        for (n = 0; n < NS; n += t.form == OTHER ? 1 : 1 + (size_t)b % 5) {
            for (i = 0; i < NS; i++)
                for (k = 0; k < 5; k++) in[k][i] = given[b + i][U + k];
            if (t.form != OTHER) {
                const mcst_row *row = &mcst_rows[t.at];
                feclearexcept(FE_ALL_EXCEPT);
                if (t.form == SAMPLE_N) row->sample_n(given[b], n, in[0], in[1], to);
                else (t.form == PDF_N ? row->pdf_n : row->eval_n)(given[b], n, in[2], in[3], in[4], out[0]);
                judge("array", given[b], n);
                continue;
            }
            for (k = 0; k < others[t.at].kinds; k++) {
                feclearexcept(FE_ALL_EXCEPT);
                others[t.at].array(k, n, in, out);
                judge("array", given[b], n);
            }
        }
}

/* The same of hits, whose neighbours have different parameters and wo. */
static void raise_by_hits(target t) {
    static float in[WORDS][NS], out[5][NS];
    float *const to[5] = {out[0], out[1], out[2], out[3], out[4]};
    for (int b = 0; b + NS < CASES; b += 97)
        for (size_t n = 0; n < NS; n += 1 + (size_t)b % 5) {
            float *from[WORDS];
            for (int k = 0; k < WORDS; k++) {
                from[k] = in[k];
                for (int i = 0; i < NS; i++) in[k][i] = given[(b + i) * 1009 % CASES][k];
            }
            feclearexcept(FE_ALL_EXCEPT);
            call_hits(t, n, from, to);
            judge("hits", given[b * 1009 % CASES], n);
        }
}

static void raise_ways(target t) {
    for (int way = 0; way < WAYS; way++) {
        if (!has_way(t, way)) continue;
        if (way < ARRAYS) raise_by_lanes(t, way);
        else if (t.form == SAMPLE_HITS_N || t.form == PDF_HITS_N) raise_by_hits(t);
        else if (way == ARRAYS) raise_by_arrays(t);
    }
}
static void raise_all(target t) {
    do {
        for (int draw = 0; draw < DRAWS; draw++) {
            make_valid(t.form == OTHER ? NULL : &mcst_rows[t.at], draw);
            raise_ways(t);
        }
    } while (next_row(&t));
}

/* --- the same where exceptions trap ------------------------------------------------------------------------------- */

#if defined(__GLIBC__) && defined(FENV_FORK)
/* A child with the exceptions unmasked goes through every function; what it dies of is its exit status. */
static void test_traps(void) {
    int status = 0;
    pid_t child;
    fflush(stdout);
    feclearexcept(FE_ALL_EXCEPT);
    child = fork();
    if (child == 0) {
        int i;
        if (feenableexcept(TRAPS) == -1) _exit(77);
        for (i = 0; i < mcst_name_count; i++) {
            const target t = find_target(mcst_name[i]);
            if (t.at >= 0) raise_all(t);
        }
        _exit(0);
    }
    CHECK(child > 0 && waitpid(child, &status, 0) == child, "no child");
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77) puts("SKIPPED: traps, which this processor does not have");
    else CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0, "a child with traps ends by status %d", status);
}
#endif

/* --- flush to zero, denormals are zero ---------------------------------------------------------------------------- */

#if (defined(__x86_64__) || defined(__i386__)) && defined(__SSE2__)
#define FENV_FLUSH
static unsigned long flush_mode(int on) {
    unsigned mode, old;
    __asm__ __volatile__("stmxcsr %0" : "=m"(mode));
    old = mode, mode = on ? mode | 0x8040u : mode & ~0x8040u;
    __asm__ __volatile__("ldmxcsr %0" : : "m"(mode));
    return old;
}
#elif defined(__aarch64__)
#define FENV_FLUSH
static unsigned long flush_mode(int on) {
    unsigned long mode, old;
    __asm__ __volatile__("mrs %0, fpcr" : "=r"(mode));
    old = mode, mode = on ? mode | 1ul << 24 : mode & ~(1ul << 24);
    __asm__ __volatile__("msr fpcr, %0" : : "r"(mode));
    return old;
}
#endif

#ifdef FENV_FLUSH
/* The size that a coordinate on a line or plane is judged by. */
static double line_of(const mcst_row *row, const float *p) {
    switch (row->coord) {
    case MCST_WHOLELINE:
    case MCST_CUT: return mcst_line_scale(row, p) + 0x1p-24;
    case MCST_TENT:
    case MCST_DISK: return (double)p[0];
    case MCST_HALFLINE: return 0x1p-24 / (double)p[0];
    case MCST_TRUNCATED: return 0x1p-24 * (double)p[1];
    case MCST_BETWEEN: return fabs((double)p[0]) + 0x1p-24 * ((double)p[1] - (double)p[0]);
    default: return 0x1p-24;
    }
}
/* How small a BRDF's value may be to be lost: its Gaussian is subnormal below 2^-126, times what the cosines make of
 * it. */
static double lost_eval(const mcst_row *row, const float *in) {
    if (row->coord != MCST_SLOPES) return 0;
    return 0x1p-125 / (ST_PI * (double)in[0] * (double)in[1] * 4 * (double)in[WO + 2] * fabs((double)in[X + 2]));
}
/* Input with nothing subnormal in it, nor in quotients of a point and a radius, and cosines of 0 or 1e-7 and more. */
static void make_normal(const mcst_row *row) {
    int i, k;
    make_valid(row, 0);
    for (i = 0; i < CASES; i++) {
        float *const in = given[i];
        const float least = row->shape == MCST_IS_PLANE ? in[0] * 0x1p-60f : FLT_MIN;
        for (k = 0; k < WORDS; k++)
            if (fabsf(in[k]) < FLT_MIN || (k >= X && fabsf(in[k]) < least)) in[k] = 0;
        if (in[WO + 2] < 1e-7f) in[WO + 2] = 1e-7f;
        if (in[X + 2] != 0 && fabsf(in[X + 2]) < 1e-7f) in[X + 2] = in[X + 2] > 0 ? 1e-7f : -1e-7f;
    }
}
/* Results of a row with the mode off and on: points within the documented error of one another, as both are within it
 * of the truth; densities within 2 E, and below 2^-100 of the largest of the same parameters only as small: a density
 * is a product of a few factors, each of which may lose what is below 2^-126 of its own size. */
static void check_flush(const mcst_row *row) {
    static float plain[FORMS][CASES][BITS_OUT];
    static const int forms[] = {SAMPLE, PDF, INVERT, EVAL, WEIGHT};
    const int vector = row->shape != MCST_IS_LINE && row->shape != MCST_IS_PLANE;
    double peak[FORMS][BITS_OUT], worst = 0;
    int i, k, f, mode;
    make_normal(row);
    for (mode = 0; mode < 2; mode++)
        for (f = 0; f < (int)MCST_COUNT(forms); f++) {
            target t = {SAMPLE, (int)(row - mcst_rows)};
            t.form = forms[f];
            if ((t.form == EVAL && !row->fn[0].eval) || (t.form == WEIGHT && !row->fn[0].weight) ||
                (t.form == INVERT && !row->fn[0].invert))
                continue;
            for (i = 0; i < CASES; i++) {
                float out[BITS_OUT] = {0};
                flush_mode(mode);
                call(t, 0, 1, given[i], out);
                flush_mode(0);
                if (!mode) {
                    memcpy(plain[t.form][i], out, sizeof out);
                    continue;
                }
                if (i % BLOCK == 0)
                    for (k = 0; k < BITS_OUT; k++) {
                        int j;
                        for (peak[t.form][k] = 0, j = i; j < i + BLOCK; j++)
                            peak[t.form][k] = fmax(peak[t.form][k], fabs((double)plain[t.form][j][k]));
                    }
                for (k = 0; k < 5; k++) {
                    const double a = (double)plain[t.form][i][k], b = (double)out[k], top = peak[t.form][k];
                    const int density = t.form == SAMPLE ? k >= 3 : t.form != INVERT, point = t.form == SAMPLE && k < 3;
                    const double larger = fmax(fabs(a), fabs(b));
                    const double e =
                        density ? 2e-6 * (1 + (larger > 0 ? log(fmax(top, larger) / larger) : 0)) : 0x1p-20;
                    const double of = density ? larger : point && !vector ? fmax(larger, line_of(row, given[i])) : 1;
                    CHECK(isfinite(b) && fabs(a - b) <= e * of + (density ? 0x1p-100 * top + FLT_MIN : 0) +
                                                            (t.form == EVAL ? lost_eval(row, given[i]) : 0),
                          "%s %d: %a becomes %a; p %a %a, wo %a %a %a, u %a %a, x %a %a %a", suffix[t.form], k, a, b,
                          (double)given[i][0], (double)given[i][1], (double)given[i][WO], (double)given[i][WO + 1],
                          (double)given[i][WO + 2], (double)given[i][U], (double)given[i][U + 1], (double)given[i][X],
                          (double)given[i][X + 1], (double)given[i][X + 2]);
                    CHECK(!density || b >= 0, "%s %d: %g", suffix[t.form], k, b);
                    if (density && larger > 0x1p-60 * top) worst = fmax(worst, fabs(a - b) / larger);
                }
            }
        }
    if (getenv("MCS_TEST_VERBOSE")) printf("    %-16s %.3g\n", row->name, worst);
}
/* Built as usual, of numbers that are 0 where they are drawn from. */
static void draw_subnormal(void) {
    const float list[9] = {1e-40f, 2e-40f, 0x1p-149f, 1e-40f, 3e-40f, 0, 1e-40f, 1e-42f, 5e-39f};
    double memory[6][32];
    mcs_pwc *pwc = (mcs_pwc *)(void *)memory[0];
    mcs_discrete *discrete = (mcs_discrete *)(void *)memory[1];
    mcs_pwl *pwl = (mcs_pwl *)(void *)memory[2];
    mcs_alias *alias = (mcs_alias *)(void *)memory[3];
    mcs_pwc2 *pwc2 = (mcs_pwc2 *)(void *)memory[4];
    const size_t bytes = 2 * sizeof *memory;
    CHECK(mcs_pwc_build(pwc, sizeof *memory, list, 9) == MCS_OK, "pwc");
    CHECK(mcs_discrete_build(discrete, sizeof *memory, list, 9) == MCS_OK, "discrete");
    CHECK(mcs_pwl_build(pwl, sizeof *memory, list, 9) == MCS_OK, "pwl");
    CHECK(mcs_alias_build(alias, sizeof *memory, list, 9) == MCS_OK, "alias");
    CHECK(mcs_pwc2_build(pwc2, bytes, list, 3, 3) == MCS_OK, "pwc2");
    for (int i = 0; i < 64; i++) {
        const float u = (float)i / 64;
        flush_mode(1);
        const mcs_cell a = mcs_pwc_sample(pwc, u);
        const mcs_cell b = mcs_pwl_sample(pwl, u);
        const mcs_cell c = mcs_pwl_sample_bits(pwl, (uint32_t)i << 26, 7);
        const mcs_pick d = mcs_discrete_sample(discrete, u);
        const mcs_pick f = mcs_alias_sample(alias, u);
        const mcs_cell2 g = mcs_pwc2_sample(pwc2, u, u);
        flush_mode(0);
        const float results[] = {a.x, a.pdf, b.x, b.pdf, c.x, c.pdf, d.pmf, d.u, f.pmf, f.u, g.x, g.y, g.pdf};
        for (int k = 0; k < (int)(sizeof results / sizeof *results); k++)
            CHECK(results[k] >= 0 && results[k] <= 9 * 9, "u %g, result %d: %g", (double)u, k, (double)results[k]);
    }
}
#endif

int main(int argc, char **argv) {
    int i;
    mcst_start(argc, argv);
#ifdef FENV_NONE
    mcst_group("exceptions");
    if (mcst_case("none in this build"))
        puts("SKIPPED: exceptions and modes, which this machine or build does not have");
    return mcst_finish();
#endif
    bits_valid = 1;
    mcst_read_names();
    mcst_group("exceptions");
    if (mcst_case("the exceptions can be seen")) { /* or the rest would pass unseen */
        volatile float zero = 0, huge = FLT_MAX, r;
        feclearexcept(FE_ALL_EXCEPT);
        r = zero / zero;
        CHECK(fetestexcept(FE_INVALID), "invalid");
        r = 1 / zero;
        CHECK(fetestexcept(FE_DIVBYZERO), "division by zero");
        r = huge * huge;
        CHECK(fetestexcept(FE_OVERFLOW), "overflow");
        (void)r;
        CHECK(mcst_name_count > 100, "%d functions in part I of %s", mcst_name_count, MCS_HEADER);
    }
    for (i = 0; i < BITS_MAPS; i++)
        if (mcst_case("building map %d, its window, tiles and products", i)) {
            feclearexcept(FE_ALL_EXCEPT);
            bits_map_at(i);
            CHECK(!fetestexcept(TRAPS), "%s", flags_of(fetestexcept(TRAPS)));
        }
    for (i = 0; i < mcst_name_count; i++) {
        const target t = find_target(mcst_name[i]);
        if (t.at >= 0 && mcst_case("%s", mcst_name[i])) raise_all(t);
    }
#if defined(__GLIBC__) && defined(FENV_FORK)
    if (mcst_case("every function with traps on")) test_traps();
#else
    if (!mcst.list) puts("SKIPPED: traps, for which there is no feenableexcept");
#endif
    mcst_group("flush to zero");
#ifdef FENV_FLUSH
    if (mcst_case("the mode is on")) {
        volatile float tiny = FLT_MIN, subnormal = 0x1p-130f, flushed, zero;
        flush_mode(1);
        flushed = tiny * 0.25f, zero = subnormal * 0x1p20f;
        flush_mode(0);
        CHECK(flushed == 0 && zero == 0, "%a %a", (double)flushed, (double)zero);
    }
    for (i = 0; i < MCST_NROWS; i++)
        if (mcst_case("%s", mcst_rows[i].name)) check_flush(&mcst_rows[i]);
    if (mcst_case("tables of subnormal numbers")) draw_subnormal();
#else
    if (!mcst.list) puts("SKIPPED: flush to zero, which this test cannot set here");
#endif
    return mcst_finish();
}
