/* Design check 7: the 4, 8 and 16 wide forms and the array forms give what the scalar form gives, bit for bit, for
 * every row; and the registry is complete: every public sampler of the header has a row or a test of its own.
 *
 * Same bits need a build without contraction (the header's terms). Where the compiler contracts a*b + c, values differ
 * by roundings and by what a sharp lobe makes of them: there only gross errors (0.1 %) are looked for. */
#define MCST_WIDE /* -DMCST_ARRAYS: array forms alone, in a third of the time */
#include "index.h"
#include "registry.h"

static int lanes_contract,
    arrays_contract; /* the wide forms; the array forms, which choose their instructions at run time */

static void find_contraction(void) {
    lanes_contract = mcst_contracts(), arrays_contract = mcst_arrays_contract();
    printf("a*b + c is contracted in: %s\n", lanes_contract    ? "everything"
                                             : arrays_contract ? "the array forms"
                                                               : "nothing");
}

enum { N = 67, LANES = 16 };

/* Contraction moves all results by roundings, which 1e-3 of them and 1e-6 allow for. */
static int same(float a, float b, int contracted) {
    if (!contracted) return !memcmp(&a, &b, sizeof a);
    return fabs((double)a - (double)b) <= 1e-3 * fmax(fabs((double)a), fabs((double)b)) + 1e-6;
}
/* The same for result k of a sample, whose own ones are `want`. Contraction moves wi.z by 4 roundings, 2^-22. The weight
 * of a BRDF grows at most in proportion to wi.z, so that it moves by as large a part of itself. */
static int same_sample(const mcst_row *row, int k, float a, const float want[5], int contracted) {
    if (same(a, want[k], contracted)) return 1;
    return contracted && k == 4 && row->shape == MCST_IS_BRDF &&
           fabs((double)a - (double)want[4]) * (double)want[2] <= 0x1p-22 * (double)want[4] + 1e-6 * (double)want[2];
}

/* Random numbers of all kinds: mostly ordinary, some at the edges, some bad. */
static float any_u(uint64_t *state) {
    static const float edge[] = {0, -0.0f, 0x1p-149f, 0x1p-24f, 0.25f, 0.5f, 0.75f, 1 - 0x1p-24f, 1, -1, 2};
    const uint64_t z = mcst_mix(state);
    if (z % 8) return (float)(int32_t)(z >> 40) * 0x1p-24f;
    return z >> 8 & 1 ? edge[(z >> 9) % 11] : z >> 9 & 1 ? NAN : edge[(z >> 10) % 8];
}

/* A parameter set of the grid, sometimes a bad one. */
static void any_p(const mcst_row *row, uint64_t *state, float *p) {
    const uint64_t z = mcst_mix(state);
    mcst_grid_get(row, (size_t)(z % mcst_grid_count(row)), p);
    if (z >> 40 & 15) return;
    p[(z >> 44) % 6] = z >> 50 & 1 ? NAN : z >> 51 & 1 ? -1.0f : 0.0f;
}

/* The scalar results for lane l: 5 of sample, then pdf, invert (2), eval, weight at the point x. */
enum { RESULTS = 10 };
static void scalar(const mcst_row *row, const float *p, const float *u, const float *x, float *out) {
    memset(out, 0, RESULTS * sizeof *out);
    row->fn[0].sample(p, &u[0], &u[1], out);
    row->fn[0].pdf(p, x, &out[5]);
    if (row->fn[0].invert) row->fn[0].invert(p, x, &out[6]);
    if (row->fn[0].eval) {
        row->fn[0].eval(p, x, &out[8]);
        row->fn[0].weight(p, x, &out[9]);
    }
}

/* One call of every wide form with a different parameter set, u and point in each lane. */
static void check_lanes(const mcst_row *row, int form, int lanes, uint64_t *state) {
    float p[MCST_P * LANES], u1[LANES], u2[LANES], x[3 * LANES], out[RESULTS * LANES], want[LANES][RESULTS];
    int i, l;
    memset(out, 0, sizeof out);
    for (l = 0; l < lanes; l++) {
        float q[MCST_P], u[2], y[3], drawn[5] = {0};
        any_p(row, state, q);
        u[0] = any_u(state), u[1] = any_u(state);
        for (i = 0; i < 3; i++) y[i] = any_u(state);
        if (mcst_mix(state) % 4) { /* mostly a point that the sampler draws */
            const float v[2] = {any_u(state), any_u(state)};
            row->fn[0].sample(q, &v[0], &v[1], drawn);
            memcpy(y, drawn, sizeof y);
        }
        scalar(row, q, u, y, want[l]);
        for (i = 0; i < MCST_P; i++) p[i * lanes + l] = q[i];
        for (i = 0; i < 3; i++) x[i * lanes + l] = y[i];
        u1[l] = u[0], u2[l] = u[1];
    }
    row->fn[form].sample(p, u1, u2, out);
    row->fn[form].pdf(p, x, out + 5 * lanes);
    if (row->fn[form].invert) row->fn[form].invert(p, x, out + 6 * lanes);
    if (row->fn[form].eval) {
        row->fn[form].eval(p, x, out + 8 * lanes);
        row->fn[form].weight(p, x, out + 9 * lanes);
    }
    for (l = 0; l < lanes; l++)
        for (i = 0; i < RESULTS; i++) {
            if (lanes_contract && (i == 6 || i == 7))
                continue; /* the azimuth of a point at the pole is nothing but its roundings */
            const int ok = i < 5 ? same_sample(row, i, out[i * lanes + l], want[l], lanes_contract)
                                 : same(out[i * lanes + l], want[l][i], lanes_contract);
            CHECK(ok,
                  "%d wide, lane %d, result %d: %.9g, scalar %.9g (p %g %g, wo %g %g %g, u %a %a, x %.9g %.9g %.9g)",
                  lanes, l, i, (double)out[i * lanes + l], (double)want[l][i], (double)p[l], (double)p[lanes + l],
                  (double)p[3 * lanes + l], (double)p[4 * lanes + l], (double)p[5 * lanes + l], (double)u1[l],
                  (double)u2[l], (double)x[l], (double)x[lanes + l], (double)x[2 * lanes + l]);
        }
}

/* --- array forms -------------------------------------------------------------------------------------------------- */

static const float guard = -123456.0f;
enum { ROOM = N + 8 };

/* Which of x, y, z, pdf, weight or distance the array form writes. */
static int writes(const mcst_row *row, int k) {
    return k < row->dim || k == 3 || (k == 4 && (row->shape == MCST_IS_BRDF || row->traits & MCST_DISTANCE));
}

/* What an array form wrote at `to`, beginning with entry `first` of a row of guards: `want`, n of them, and nothing
 * else. */
static void check_written(const char *what, const float *to, size_t first, const float *want, size_t n) {
    size_t i;
    for (i = 0; i < ROOM; i++) {
        if (i >= first && i < first + n)
            CHECK(same(to[i], want[i - first], arrays_contract), "%s[%zu] of %zu: %.9g, scalar %.9g", what, i - first,
                  n, (double)to[i], (double)want[i - first]);
        else CHECK(to[i] == guard, "%s: wrote at %zu of %zu", what, i - first, n);
    }
}

/* Of every n, now and then without some outputs, from places of every alignment. Fills want: x, y, z, pdf, weight. */
static void check_sample_n(const mcst_row *row, const float *p, uint64_t *state, const float *u1, const float *u2,
                           int shift, float want[5][N]) {
    float buffer[5][ROOM];
    const float *v1 = u1 + shift, *v2 = u2 + (shift * 2) % 4;
    size_t n, i;
    int k;
    for (i = 0; i < N; i++) {
        float out[5] = {0};
        row->fn[0].sample(p, &v1[i], &v2[i], out);
        for (k = 0; k < 5; k++) want[k][i] = out[k];
    }
    for (n = 0; n <= N; n++) {
        const unsigned missing = n % 6 ? 0 : 1 + (unsigned)(mcst_mix(state) % 31);
        float *out[5];
        for (k = 0; k < 5; k++) {
            for (i = 0; i < ROOM; i++) buffer[k][i] = guard;
            out[k] = missing >> k & 1 ? NULL : buffer[k] + (shift + k) % 4;
        }
        row->sample_n(p, n, v1, v2, out);
        for (k = 0; k < 5; k++) {
            char what[32];
            snprintf(what, sizeof what, "output %d", k);
            check_written(what, buffer[k], (size_t)((shift + k) % 4), want[k], out[k] && writes(row, k) ? n : 0);
        }
    }
}

/* In place: two of the outputs are the inputs, as given or crossed. */
static void check_in_place(const mcst_row *row, const float *p, const float *u1, const float *u2, int crossed) {
    float a[N], b[N], rest[3][N];
    float *out[5] = {NULL, rest[0], rest[0], rest[1], rest[2]};
    const int first = 0, second = row->dim > 1 ? 1 : 3;
    size_t i;
    int k;
    memcpy(a, u1, sizeof a);
    memcpy(b, u2, sizeof b);
    out[first] = crossed ? b : a, out[second] = crossed ? a : b;
    row->sample_n(p, N, a, b, out);
    for (i = 0; i < N; i++) {
        float one[5] = {0};
        row->fn[0].sample(p, &u1[i], &u2[i], one);
        for (k = 0; k < 5; k++)
            if (writes(row, k))
                CHECK(same_sample(row, k, out[k][i], one, arrays_contract),
                      "in place%s, output %d[%zu]: %.9g, scalar %.9g", crossed ? ", crossed" : "", k, i,
                      (double)out[k][i], (double)one[k]);
    }
}

/* pdf_n and eval_n at the points x[0..2]; pdf_n in place, too. */
static void check_values_n(const mcst_row *row, const float *p, float x[5][N]) {
    float value[2][N], y[N], f[ROOM];
    size_t n, i;
    int k;
    for (i = 0; i < N; i++) {
        const float at[3] = {x[0][i], x[1][i], x[2][i]};
        row->fn[0].pdf(p, at, &value[0][i]);
        row->fn[0].eval(p, at, &value[1][i]);
    }
    for (n = 0; n <= N; n++)
        for (k = 0; k < 2; k++) {
            for (i = 0; i < ROOM; i++) f[i] = guard;
            (k ? row->eval_n : row->pdf_n)(p, n, x[0], x[1], x[2], f + n % 4);
            check_written(k ? "eval_n" : "pdf_n", f, n % 4, value[k], n);
        }
    memcpy(y, x[1], sizeof y);
    row->pdf_n(p, N, x[0], y, x[2], y);
    for (i = 0; i < N; i++)
        CHECK(same(y[i], value[0][i], arrays_contract), "pdf_n in place [%zu]: %.9g, scalar %.9g", i, (double)y[i],
              (double)value[0][i]);
}

static void check_arrays(const mcst_row *row, const float *p, uint64_t *state) {
    float u1[ROOM], u2[ROOM], want[5][N];
    int i;
    for (i = 0; i < ROOM; i++) u1[i] = any_u(state), u2[i] = any_u(state);
    for (i = 0; i < 4; i++) check_sample_n(row, p, state, u1, u2, i, want);
    for (i = 0; i < 2; i++) check_in_place(row, p, u1, u2, i);
    if (row->pdf_n) check_values_n(row, p, want);
}

/* --- hits, each with a wo and parameters of its own ---------------------------------------------------------------- */

/* N of them, some with bad parameters, a bad wo, or both: hit i is in p[0..5][i], u[0..1][i] and x[0..2][i]. */
typedef struct {
    int own_parameters; /* 0: all have those of the first; 2: one for both axes */
    int values;         /* densities and values of x are wanted, not samples */
    float p[MCST_P][N], u[2][N], x[3][N];
} hit_arrays;

static void make_hits(const mcst_row *row, uint64_t *state, hit_arrays *h) {
    float first[MCST_P];
    any_p(row, state, first);
    for (int i = 0; i < N; i++) {
        const float v[2] = {any_u(state), any_u(state)};
        float p[MCST_P];
        float drawn[5] = {0};
        any_p(row, state, p);
        if (!h->own_parameters) memcpy(p, first, 3 * sizeof *p);
        if (h->own_parameters == 2 && row->params > 1) p[1] = p[0];
        row->fn[0].sample(p, &v[0], &v[1], drawn);
        for (int k = 0; k < MCST_P; k++) h->p[k][i] = p[k];
        for (int k = 0; k < 2; k++) h->u[k][i] = any_u(state);
        for (int k = 0; k < 3; k++) h->x[k][i] = mcst_mix(state) % 4 ? drawn[k] : any_u(state);
    }
}
/* What scalar calls give: x, y, z, pdf, weight of samples, or pdf and f of the points. */
static void scalar_hits(const mcst_row *row, const hit_arrays *h, float want[5][N]) {
    for (int i = 0; i < N; i++) {
        float p[MCST_P];
        float out[5] = {0};
        const float x[3] = {h->x[0][i], h->x[1][i], h->x[2][i]};
        for (int k = 0; k < MCST_P; k++) p[k] = h->p[k][i];
        if (h->values) {
            row->fn[0].pdf(p, x, &out[0]);
            row->fn[0].eval(p, x, &out[1]);
        } else {
            row->fn[0].sample(p, &h->u[0][i], &h->u[1][i], out);
        }
        for (int k = 0; k < 5; k++) want[k][i] = out[k];
    }
}
/* A call for n hits from `first` on. */
static void call_hits(const mcst_row *row, hit_arrays *h, size_t first, size_t n, float *const out[5]) {
    const float p[MCST_P] = {h->p[0][0], h->p[1][0], h->p[2][0], 0, 0, 0};
    const mcs_hits hits = {h->p[3] + first, h->p[4] + first, h->p[5] + first,
                           h->own_parameters ? h->p[0] + first : NULL,
                           h->own_parameters == 1 && row->params > 1 ? h->p[1] + first : NULL};
    float(*const in)[N] = h->values ? h->x : h->u;
    const float *const from[3] = {in[0] + first, in[1] + first, h->values ? in[2] + first : NULL};
    (h->values ? row->pdf_hits_n : row->sample_hits_n)(p, &hits, n, from, out);
}
/* Of every n, now and then without some outputs, from places of every alignment. */
static void check_every_n(const mcst_row *row, hit_arrays *h, uint64_t *state) {
    float want[5][N];
    scalar_hits(row, h, want);
    for (size_t n = 0; n <= N; n++) {
        const size_t first = n < N - 3 ? n % 4 : 0;
        const unsigned missing = n % 6 ? 0 : 1 + (unsigned)(mcst_mix(state) % 31);
        float buffer[5][ROOM];
        float *out[5];
        for (int k = 0; k < 5; k++) {
            for (int i = 0; i < ROOM; i++) buffer[k][i] = guard;
            out[k] = missing >> k & 1 ? NULL : buffer[k] + (n + (size_t)k) % 4;
        }
        call_hits(row, h, first, n, out);
        for (int k = 0; k < 5; k++) {
            const int written = out[k] && (!h->values || k < 2);
            char what[48];
            snprintf(what, sizeof what, "%s of hits, output %d", h->values ? "value" : "sample", k);
            check_written(what, buffer[k], (n + (size_t)k) % 4, want[k] + first, written ? n : 0);
        }
    }
}
/* In place: the outputs are what hits have, or random numbers and points, in another order. */
static void check_hits_in_place(const mcst_row *row, const hit_arrays *h, int of_hits) {
    float want[5][N], rest[3][N];
    hit_arrays a = *h;
    float(*const in)[N] = h->values ? a.x : a.u;
    float *const to_hits[5] = {a.p[4], a.p[5], a.p[3], a.p[1], a.p[0]};
    float *const to_points[5] = {in[1], in[0], rest[0], rest[1], rest[2]};
    float *const *const out = of_hits ? to_hits : to_points;
    scalar_hits(row, h, want);
    call_hits(row, &a, 0, N, out);
    for (int k = 0; k < (h->values ? 2 : 5); k++)
        for (int i = 0; i < N; i++)
            CHECK(same(out[k][i], want[k][i], arrays_contract), "hits in place, output %d[%d]: %.9g, scalar %.9g", k, i,
                  (double)out[k][i], (double)want[k][i]);
}
static void check_hits(const mcst_row *row, uint64_t *state) {
    static hit_arrays h;
    for (int round = 0; round < 24; round++) {
        h.own_parameters = round % 3;
        h.values = round & 1;
        make_hits(row, state, &h);
        check_every_n(row, &h, state);
        check_hits_in_place(row, &h, round >> 1 & 1);
    }
}

/* --- vectors in frames of their own --- */

typedef void turn_n(size_t n, const float *normal_x, const float *normal_y, const float *normal_z, const float *x,
                    const float *y, const float *z, float *turned_x, float *turned_y, float *turned_z);

static float any_component(uint64_t *state) {
    static const float beyond[] = {INFINITY, -INFINITY, 2e37f, -2e37f};
    const float x = 2 * any_u(state) - 1;
    return mcst_mix(state) % 32 ? x : beyond[mcst_mix(state) % 4];
}
/* mcs_to_world_n and mcs_to_local_n for every n: now and then without some outputs, else in place of the vectors. */
static void check_turned(turn_n *turned, mcs_vec3 (*turn)(const mcs_frame *, mcs_vec3), uint64_t *state) {
    for (size_t n = 0; n <= N; n++) {
        const unsigned missing = (unsigned)(mcst_mix(state) % 16);
        float normal[3][ROOM], v[3][ROOM], buffer[3][ROOM], want[3][N];
        float *out[3];
        for (int k = 0; k < 3; k++) {
            for (int i = 0; i < ROOM; i++) {
                normal[k][i] = any_component(state);
                v[k][i] = i < (int)n ? any_component(state) : guard;
                buffer[k][i] = guard;
            }
            out[k] = missing > 7 ? v[k] : missing >> k & 1 ? NULL : buffer[k];
        }
        for (size_t i = 0; i < n; i++) {
            const mcs_vec3 own = {normal[0][i], normal[1][i], normal[2][i]};
            const mcs_vec3 from = {v[0][i], v[1][i], v[2][i]};
            const mcs_frame frame = mcs_frame_make(own);
            const mcs_vec3 w = turn(&frame, from);
            want[0][i] = w.x;
            want[1][i] = w.y;
            want[2][i] = w.z;
        }
        turned(n, normal[0], normal[1], normal[2], v[0], v[1], v[2], out[0], out[1], out[2]);
        for (int k = 0; k < 3; k++) check_written("turned", out[k] ? out[k] : buffer[k], 0, want[k], out[k] ? n : 0);
    }
}

static void check_turns(void) {
    uint64_t state = mcst_seed_for("frames", "width", 0);
    for (int round = 0; round < 100; round++) {
        check_turned(mcs_to_world_n, mcs_to_world, &state);
        check_turned(mcs_to_local_n, mcs_to_local, &state);
    }
}

/* --- arrays larger than caches, which are written past them --- */

/* Draws of n = 2^21 + 13 points at once are those of calls of 1000, and nothing else is written: arrays begin at a
 * multiple of 64 bytes (off 0), do not, and are those of the input (in place). */
static void check_long(size_t off, int in_place) {
    enum { LONG = (1 << 21) + 13, PIECE = 1000, SPACE = LONG + 64, ARRAYS = 6 };
    float *const memory = (float *)malloc((ARRAYS * SPACE + 16) * sizeof *memory);
    float *array[ARRAYS];
    if (!memory) exit(2);
    for (int k = 0; k < ARRAYS; k++)
        array[k] = memory + (64 - ((uintptr_t)memory & 63)) / sizeof *memory % 16 + (size_t)k * (SPACE / 16 * 16) + off;
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 11);
    mcs_pcg32_fill_n(&rng, LONG, array[0]);
    mcs_pcg32_fill_n(&rng, LONG, array[1]);
    float *const x = in_place ? array[0] : array[2];
    for (int k = 2; k < ARRAYS; k++) array[k][LONG] = -7.0f;
    float piece[4][PIECE], *u1 = (float *)malloc(LONG * sizeof *u1);
    if (!u1) exit(2);
    memcpy(u1, array[0], LONG * sizeof *u1);
    mcs_cosine_sample_n(LONG, array[0], array[1], x, array[3], array[4], array[5]);
    int differ = 0;
    for (size_t i = 0; i < LONG; i += PIECE) {
        const size_t n = LONG - i < PIECE ? LONG - i : (size_t)PIECE;
        mcs_cosine_sample_n(n, u1 + i, array[1] + i, piece[0], piece[1], piece[2], piece[3]);
        differ += memcmp(piece[0], x + i, n * sizeof *x) != 0;
        for (int k = 1; k < 4; k++) differ += memcmp(piece[k], array[2 + k] + i, n * sizeof *x) != 0;
    }
    CHECK(differ == 0, "%d pieces differ", differ);
    for (int k = 2; k < ARRAYS; k++) CHECK(array[k][LONG] == -7.0f, "written behind array %d", k);
    free(u1);
    free(memory);
}

/* --- is the registry complete? ------------------------------------------------------------------------------------ */

static int is_known(const char *name) {
    size_t i;
    for (i = 0; i < MCST_NROWS; i++)
        if (!strcmp(mcst_rows[i].function, name)) return 1;
    for (i = 0; i < MCST_COUNT(mcst_exempt); i++)
        if (!strcmp(mcst_exempt[i], name)) return 1;
    return 0;
}

/* Every mcs_NAME_sample has a row or is exempt, and every row's sampler is there. */
static void check_registry(void) {
    char name[MCST_NAME];
    size_t i;
    int k;
    CHECK(mcst_read_names() && mcst_name_count > 100,
          "%d functions in %s; run the test where it is, or compile with -DMCS_HEADER", mcst_name_count, MCS_HEADER);
    for (k = 0; k < mcst_name_count; k++) {
        const size_t length = strlen(mcst_name[k]), tail = strlen("_sample");
        if (length < 4 + tail || strcmp(mcst_name[k] + length - tail, "_sample") != 0) continue;
        snprintf(name, sizeof name, "%.*s", (int)(length - tail - 4), mcst_name[k] + 4);
        CHECK(is_known(name), "%s has no row in registry.h", mcst_name[k]);
    }
    for (i = 0; i < MCST_NROWS; i++) {
        snprintf(name, sizeof name, "mcs_%s_sample", mcst_rows[i].function);
        CHECK(mcst_name_at(name, mcst_name, mcst_name_count) >= 0, "row %s: %s is not in %s", mcst_rows[i].name, name,
              MCS_HEADER);
    }
}

int main(int argc, char **argv) {
    size_t i, j;
    int w;
    mcst_start(argc, argv);
    if (!mcst.list) find_contraction();
    mcst_group("registry");
    if (mcst_case("every sampler has a row")) check_registry();
    for (i = 0; i < MCST_NROWS; i++) {
        const mcst_row *row = &mcst_rows[i];
        uint64_t state = mcst_seed_for(row->name, "width", 0);
        const int rounds = (int)(800 * fmin(1, mcst_scale())) + 1;
        mcst_group(row->name);
        for (w = 1; w < 4; w++) {
            if (!row->fn[w].sample || !mcst_case("%d wide", 2 << w)) continue;
            for (j = 0; j < (size_t)rounds; j++) check_lanes(row, w, 2 << w, &state);
        }
        for (j = 0; j < 4; j++) {
            float p[MCST_P];
            mcst_grid_get(row, (j * 37) % mcst_grid_count(row), p);
            if (mcst_case("arrays %g %g, wo %g %g %g", (double)p[0], (double)p[1], (double)p[3], (double)p[4],
                          (double)p[5]))
                check_arrays(row, p, &state);
        }
        if (row->sample_hits_n && mcst_case("hits")) check_hits(row, &state);
    }
    mcst_group("frames");
    if (mcst_case("arrays of vectors")) check_turns();
    mcst_group("long arrays");
    for (i = 0; i < 3; i++)
        if (mcst_case("%s", i == 0 ? "aligned" : i == 1 ? "not aligned" : "in place")) check_long(i == 1, i == 2);
    return mcst_finish();
}
