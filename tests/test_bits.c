/* Same bits everywhere: one hash per public function over 2432 deterministic inputs, good, extreme and bad, against
 * tests/bits.txt. Scalar, 4, 8, 16 wide and array forms must all give it, whatever the machine, its byte order, the
 * compiler and its optimisation.
 *
 * The functions are those of part I: a new one without an adapter (registry.h, bits.h) or a line in bits.txt
 * fails by name. Where results change on purpose:   build/tests/test_bits --print > tests/bits.txt
 * Points are mostly samples of the row: a new X_sample changes the hash of X_pdf, too.
 *
 * As CUDA (nvcc -x cu --fmad=false) the same file evaluates every scalar function in kernels too, where a GPU is
 * present. The terms of the promise are no contraction of a*b + c and floats evaluated as floats; any other build
 * skips, and says so. */
#include "functions.h"

#ifndef MCST_BITS
#define MCST_BITS "tests/bits.txt" /* its path from where the test is run */
#endif

static float given[CASES][BITS_IN], result[CASES][BITS_OUT];

/* --- inputs ------------------------------------------------------------------------------------------------------- */

/* Mostly in 2^-7 ... 2, a quarter in 2^-24 ... 2^31, some over all floats, some special. */
static float any_parameter(uint64_t *state) {
    static const float special[16] = {0,     -0.0f, 1e-7f, 1e4f,     1e9f,      FLT_MAX,   FLT_MIN, 0x1p-149f,
                                      1e-6f, -1,    1,     INFINITY, -INFINITY, 0x1p-130f, 0.5f,    2};
    const uint64_t z = mcst_mix(state);
    const uint32_t mantissa = (uint32_t)(z >> 41), e = (uint32_t)(z >> 8 & 0xFFFF);
    switch (z & 31) {
    case 0: return from_bits(0x7fc00000); /* NaN */
    case 1: return special[e % 16];
    case 2: return from_bits((e % 254 + 1) << 23 | mantissa);
    default: return from_bits((z & 3 ? 120 + e % 8 : 103 + e % 55) << 23 | mantissa);
    }
}

static float any_u(uint64_t *state) {
    static const float edge[16] = {0, -0.0f, 0x1p-149f, 0x1p-126f, 0x1p-24f, 0.25f,    0.5f,  0.75f, 1 - 0x1p-24f,
                                   1, -1,    2,         INFINITY,  -1e30f,   0x1p-25f, 0.125f};
    const uint64_t z = mcst_mix(state);
    if (z % 8) return (float)(int32_t)(z >> 40) * 0x1p-24f;
    return z >> 8 & 31 ? edge[z >> 16 & 15] : from_bits(0x7fc00000);
}

/* A unit vector from the pole to the horizon, now and then below it or bad. Only + - * / and sqrt, which no machine
 * rounds differently. */
static void any_direction(uint64_t *state, float w[3]) {
    static const double cosines[8] = {1, 0.7, 0.35, 0.0871557, 1e-2, 1e-3, 1e-6, 1e-7};
    const uint64_t z = mcst_mix(state);
    const double t = (double)(int32_t)(z >> 40) * 0x1p-23 - 1,
                 c = z & 1 ? cosines[z >> 1 & 7] : (double)(int32_t)(z >> 16 & 0xFFFFFF) * 0x1p-24;
    const double s = sqrt((1 - c) * (1 + c)), up = z >> 4 & 7 ? 1 : -1, turn = z >> 7 & 1 ? 1 : -1;
    w[0] = (float)(turn * s * (1 - t * t) / (1 + t * t)), w[1] = (float)(s * 2 * t / (1 + t * t)),
    w[2] = (float)(up * c);
    if (z >> 8 & 15) return;
    switch (z >> 12 & 3) {
    case 0: w[z % 3] = any_parameter(state); break;
    case 1: w[0] = w[1] = w[2] = 0; break;
    case 2: w[0] = from_bits(0x7fc00000); break;
    default: w[0] *= 1e30f, w[1] *= 1e30f, w[2] *= 1e30f;
    }
}

/* Fills `given`; the points of a row are mostly its own samples. */
static void make_inputs(const mcst_row *row) {
    uint64_t state = 6;
    int b, i, k;
    for (b = 0; b < BLOCKS; b++) {
        float set[U] = {0};
        set[0] = any_parameter(&state), set[1] = b % 2 ? set[0] : any_parameter(&state);
        if (b % 8 == 7) set[0] = -set[0];
        any_direction(&state, set + WO);
        for (i = b * BLOCK; i < (b + 1) * BLOCK; i++) {
            float drawn[5] = {0};
            const float v[2] = {any_u(&state), any_u(&state)};
            memcpy(given[i], set, sizeof set);
            given[i][U] = any_u(&state), given[i][U + 1] = any_u(&state);
            any_direction(&state, given[i] + X);
            if (row && i % 4) {
                row->fn[0].sample(given[i], &v[0], &v[1], drawn);
                memcpy(given[i] + X, drawn, 3 * sizeof(float));
            }
            for (k = WORDS; k < BITS_IN; k++) given[i][k] = 0;
            for (k = WORDS; k < BITS_IN; k++) {
                const uint32_t word = (uint32_t)(mcst_mix(&state) >> 32);
                memcpy(&given[i][k], &word, sizeof word);
            }
        }
    }
}

/* --- evaluation --------------------------------------------------------------------------------------------------- */

/* Fills `result` at width w; neighbouring lanes get cases of different parameter sets. */
static void evaluate(target t, int w) {
    const int lanes = w ? 2 << w : 1;
    int i, k, l;
    for (i = 0; i < CASES; i += lanes) {
        float in[BITS_IN * 16], out[BITS_OUT * 16] = {0};
        for (l = 0; l < lanes; l++)
            for (k = 0; k < BITS_IN; k++) memcpy(&in[k * lanes + l], &given[(i + l) * 1009 % CASES][k], sizeof *in);
        call(t, w, lanes, in, out);
        for (l = 0; l < lanes; l++)
            for (k = 0; k < BITS_OUT; k++) memcpy(&result[(i + l) * 1009 % CASES][k], &out[k * lanes + l], sizeof *out);
    }
}

/* By the array form of a row: the cases of a block, which share their parameters. */
static void evaluate_blocks(target t) {
    const mcst_row *row = &mcst_rows[t.at];
    int b, i, k;
    for (b = 0; b < BLOCKS; b++) {
        float in[BITS_IN][BLOCK], out[5][BLOCK] = {{0}};
        float *const to[5] = {out[0], out[1], out[2], out[3], out[4]};
        const float *p = given[b * BLOCK];
        for (i = 0; i < BLOCK; i++)
            for (k = U; k < WORDS; k++) in[k][i] = given[b * BLOCK + i][k];
        if (t.form == SAMPLE_N) row->sample_n(p, BLOCK, in[U], in[U + 1], to);
        else (t.form == PDF_N ? row->pdf_n : row->eval_n)(p, BLOCK, in[X], in[X + 1], in[X + 2], out[0]);
        for (i = 0; i < BLOCK; i++)
            for (k = 0; k < 5; k++) result[b * BLOCK + i][k] = out[k][i];
    }
}

/* By an array form of hits: all cases in one call, where neighbours have the cases of different parameter sets. */
static void evaluate_hits(target t) {
    static float in[WORDS][CASES], out[5][CASES];
    float *const to[5] = {out[0], out[1], out[2], out[3], out[4]};
    float *from[WORDS];
    int i, k;
    for (k = 0; k < WORDS; k++) {
        from[k] = in[k];
        for (i = 0; i < CASES; i++) in[k][i] = given[i * 1009 % CASES][k];
    }
    memset(out, 0, sizeof out);
    call_hits(t, CASES, from, to);
    for (i = 0; i < CASES; i++)
        for (k = 0; k < 5; k++) result[i * 1009 % CASES][k] = out[k][i];
}

/* By an array form of maps or products: all cases of one of them in one call. */
static void evaluate_kinds(target t) {
    static float in[5][CASES], out[6][CASES];
    static int from[CASES];
    int i, j, k, n;
    for (k = 0; k < others[t.at].kinds; k++) {
        for (i = n = 0; i < CASES; i++) {
            if (bits_kind_of(given[i], others[t.at].kinds) != k) continue;
            for (j = 0; j < 5; j++) in[j][n] = given[i][U + j];
            from[n++] = i;
        }
        memset(out, 0, sizeof out);
        others[t.at].array(k, (size_t)n, in, out);
        for (i = 0; i < n; i++)
            for (j = 0; j < 6; j++) result[from[i]][j] = out[j][i];
    }
}

static void evaluate_arrays(target t) {
    memset(result, 0, sizeof result);
    if (t.form == OTHER) evaluate_kinds(t);
    else if (t.form >= SAMPLE_HITS_N) evaluate_hits(t);
    else evaluate_blocks(t);
}

/* --- the same on a GPU -------------------------------------------------------------------------------------------- */

#ifdef __CUDACC__
namespace gpu {
typedef void (*kernel)(const float *in, float *out);
__device__ int here() { return (int)(blockIdx.x * blockDim.x + threadIdx.x); }
template <void (*F)(const float *, const float *, const float *, float *)>
__global__ void sample(const float *in, float *out) {
    const int i = here();
    if (i < CASES) F(in + i * BITS_IN, in + i * BITS_IN + U, in + i * BITS_IN + U + 1, out + i * BITS_OUT);
}
template <void (*F)(const float *, const float *, float *)> __global__ void value(const float *in, float *out) {
    const int i = here();
    if (i < CASES) F(in + i * BITS_IN, in + i * BITS_IN + X, out + i * BITS_OUT);
}
template <void (*F)(const float *, float *)> __global__ void other(const float *in, float *out) {
    const int i = here();
    if (i < CASES) F(in + i * BITS_IN, out + i * BITS_OUT);
}
#define GPU_LINE(r) {sample<mcst1_##r##_sample>, value<mcst1_##r##_pdf>, value<mcst1_##r##_invert>, NULL, NULL},
#define GPU_PLANE GPU_LINE
#define GPU_DIR GPU_LINE
#define GPU_LIGHT GPU_LINE
#define GPU_POLYGON GPU_LINE
#define GPU_LOBE GPU_LINE
#define GPU_VLOBE GPU_LINE
#define GPU_BRDF(r) \
    {sample<mcst1_##r##_sample>, value<mcst1_##r##_pdf>, NULL, value<mcst1_##r##_eval>, value<mcst1_##r##_weight>},
#define GPU_ROW(shape, row, fn, arg, base, coord, grid) GPU_##shape(row)
static const kernel rows[][SAMPLE_N] = {MCST_ROWS(GPU_ROW)};
#define GPU_OTHER(x) other<bits1_##x>,
#define GPU_NONE(...) NULL,
static const kernel rest[] = {BITS_WIDE(GPU_OTHER) BITS_WORDS(GPU_OTHER) BITS_SCALAR(GPU_OTHER) BITS_MAPPED(GPU_OTHER)
                                  BITS_HOST(GPU_NONE) BITS_ARRAYS(GPU_NONE)};
static int has(target t) { return t.form == OTHER ? rest[t.at] != NULL : t.form < SAMPLE_N; }

/* p becomes a copy of it in memory of the device. */
static cudaError_t copy(void **p) {
    const void *const from = *p;
    const size_t bytes = (size_t)((const uint64_t *)from)[-2];
    const cudaError_t e = cudaMalloc(p, bytes);
    return e == cudaSuccess ? cudaMemcpy(*p, from, bytes, cudaMemcpyHostToDevice) : e;
}
static cudaError_t copy_map(int k) {
    bits_map m = *bits_map_at(k);
    cudaError_t e = copy((void **)&m.env);
    if (e == cudaSuccess) e = copy((void **)&m.window);
    if (e == cudaSuccess) e = copy((void **)&m.tiles);
    if (e == cudaSuccess) e = copy((void **)&m.region);
    for (int i = 0; i < BITS_PRODUCTS && e == cudaSuccess; i++) e = copy((void **)&m.product[i]);
    if (e == cudaSuccess) e = cudaMemcpyToSymbol(bits_gpu_maps, &m, sizeof m, (size_t)k * sizeof m);
    return e;
}
static cudaError_t copy_maps() {
    cudaError_t e = cudaSuccess;
    for (int k = 0; k < BITS_MAPS && e == cudaSuccess; k++) e = copy_map(k);
    return e;
}

static const char *evaluate(target t) {
    static const cudaError_t copied = copy_maps();
    float *in = NULL;
    float *out = NULL;
    cudaError_t e = copied;
    if (e == cudaSuccess) e = cudaMalloc(&in, sizeof given);
    if (e == cudaSuccess) e = cudaMalloc(&out, sizeof result);
    if (e == cudaSuccess) e = cudaMemcpy(in, given, sizeof given, cudaMemcpyHostToDevice);
    if (e == cudaSuccess) e = cudaMemset(out, 0, sizeof result);
    if (e == cudaSuccess) (t.form == OTHER ? rest[t.at] : rows[t.at][t.form])<<<(CASES + 63) / 64, 64>>>(in, out);
    if (e == cudaSuccess) e = cudaGetLastError();
    if (e == cudaSuccess) e = cudaMemcpy(result, out, sizeof result, cudaMemcpyDeviceToHost);
    cudaFree(in);
    cudaFree(out);
    return e == cudaSuccess ? NULL : cudaGetErrorString(e);
}
} // namespace gpu
#endif

/* --- stored hashes ------------------------------------------------------------------------------------------------ */

static char stored_name[MCST_NAMES][MCST_NAME];
static uint64_t stored[MCST_NAMES];
static int stored_count;

static void read_stored(void) {
    FILE *f = fopen(MCST_BITS, "rb");
    unsigned hi, lo;
    if (!f) return;
    while (stored_count < MCST_NAMES && fscanf(f, "%47s %8x%8x", stored_name[stored_count], &hi, &lo) == 3)
        stored[stored_count++] = (uint64_t)hi << 32 | lo;
    fclose(f);
}

/* One more way than those of functions.h. */
enum { GPU = WAYS };
static const char *name_of(int way) { return way == GPU ? "GPU" : way_name[way]; }

static int can(target t, int way) {
#ifdef __CUDACC__
    if (way == GPU) return gpu::has(t) && gpu::present();
#endif
    return way < WAYS && has_way(t, way);
}

static uint64_t hash_of(target t, int way) {
    uint64_t hash = BITS_START;
    do {
        const float *r = result[0];
        int i;
        make_inputs(t.form == OTHER ? NULL : &mcst_rows[t.at]);
        if (way < ARRAYS) evaluate(t, way);
        else if (way == ARRAYS) evaluate_arrays(t);
#ifdef __CUDACC__
        else {
            const char *error = gpu::evaluate(t);
            CHECK(!error, "%s", error);
        }
#endif
        if (t.form != OTHER || others[t.at].floats)
            for (i = 0; i < CASES * BITS_OUT; i++)
                CHECK(r[i] - r[i] == 0, "%s: result %d of case %d is %g", name_of(way), i % BITS_OUT, i / BITS_OUT,
                      (double)r[i]);
        hash = bits_hash(hash, r, CASES * BITS_OUT);
    } while (next_row(&t));
    return hash;
}

static void check(const char *name, int promised) {
    const target t = find_target(name);
    const int line = mcst_name_at(name, stored_name, stored_count);
    int way;
    CHECK(t.at >= 0, "%s has no row in registry.h and no adapter in bits.h", name);
    CHECK(line >= 0, "%s has no hash in %s", name, MCST_BITS);
    for (way = 0; promised && t.at >= 0 && line >= 0 && way <= GPU; way++)
        if (can(t, way)) {
            const uint64_t got = hash_of(t, way);
            CHECK(got == stored[line], "%s: %08x%08x, stored %08x%08x", name_of(way), (unsigned)(got >> 32),
                  (unsigned)got, (unsigned)(stored[line] >> 32), (unsigned)stored[line]);
        }
}

static void print(void) {
    int i;
    for (i = 0; i < mcst_name_count; i++) {
        const target t = find_target(mcst_name[i]);
        if (t.at >= 0) {
            const uint64_t hash = hash_of(t, t.form >= SAMPLE_N && t.form < FORMS ? ARRAYS : 0);
            printf("%s %08x%08x\n", mcst_name[i], (unsigned)(hash >> 32), (unsigned)hash);
        }
    }
}

int main(int argc, char **argv) {
    const char *reason = MCSI_FLT_EVAL > 0        ? "floats are not evaluated as floats"
                         : mcst_arrays_contract() ? "a*b + c is contracted"
                                                  : NULL;
    int i;
    mcst_read_names();
    read_stored();
    if (argc == 2 && !strcmp(argv[1], "--print")) {
        print();
        return 0;
    }
    mcst_start(argc, argv);
    if (!mcst.list) {
        if (reason) printf("SKIPPED: %s in this build, so no hash is compared\n", reason);
#ifdef MCS_NO_WIDE
        puts("SKIPPED: 4, 8 and 16 wide, which this compiler does not have");
#endif
#ifdef __CUDACC__
        if (!gpu::present()) puts("SKIPPED: ALL KERNELS: they compile, but NOT ONE WAS RUN, as there is no GPU here");
#endif
    }
    mcst_group("bits");
    if (mcst_case("part I, the adapters and %s agree", MCST_BITS)) {
        CHECK(mcst_name_count > 100,
              "%d functions in part I of %s; run the test where it is, or compile with -DMCS_HEADER", mcst_name_count,
              MCS_HEADER);
        CHECK(stored_count == mcst_name_count, "%d hashes for %d functions", stored_count, mcst_name_count);
        for (i = 0; i < stored_count; i++)
            CHECK(mcst_name_at(stored_name[i], mcst_name, mcst_name_count) >= 0, "%s is stored, but not in part I",
                  stored_name[i]);
        for (i = 0; i < (int)MCST_COUNT(others); i++)
            CHECK(mcst_name_at(others[i].name, mcst_name, mcst_name_count) >= 0,
                  "%s has an adapter, but is not in part I", others[i].name);
    }
    for (i = 0; i < mcst_name_count; i++)
        if (mcst_case("%s", mcst_name[i])) check(mcst_name[i], reason == NULL);
    return mcst_finish();
}
