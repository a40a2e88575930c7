/* The samplers on a graphics processor, as a renderer compiles them: with multiplications and additions fused.
 *
 *     make cuda       this, and tests/test_bits.c, which compares hashes of every scalar function without fusing
 *
 * chi-square: every set of every row of the registry, drawn by a kernel; densities and bins are the host's.
 * rates: samples in 10^9 per second, made from counters and kept in registers; and as an array form, which reads two
 * random numbers and writes a direction and its density, beside the rate at which the device copies as many bytes. */
#include <algorithm>
#include <vector>
#include "chi2_rows.h"

static int bad(cudaError_t error) {
    CHECK(error == cudaSuccess, "%s", cudaGetErrorString(error));
    return error != cudaSuccess;
}

/* --- chi-square --------------------------------------------------------------------------------------------------- */

typedef void kernel(const float *p, size_t n, const float *u, float *out);
/* u: n numbers u1, then n numbers u2. out: n of each of x, y, z, pdf, weight. */
template <void (*F)(const float *, const float *, const float *, float *)>
__global__ void draw(const float *p, size_t n, const float *u, float *out) {
    const size_t i = blockIdx.x * (size_t)blockDim.x + threadIdx.x;
    if (i >= n) return;
    float x[5] = {0, 0, 0, 0, 0};
    F(p, u + i, u + n + i, x);
    for (int k = 0; k < 5; k++) out[k * n + i] = x[k];
}
#define DRAW(shape, row, fn, arg, base, coord, grid) draw<mcst1_##row##_sample>,
static kernel *const kernels[] = {MCST_ROWS(DRAW)};

/* What draws for the row under test: memory of the device, and one of the kernels. */
static struct {
    float *p, *u, *out;
    kernel *draw;
} device;

/* A sample_n of the registry. */
static void draw_on_device(const float *p, size_t n, const float *u1, const float *u2, float *const out[5]) {
    if (bad(cudaMemcpy(device.p, p, MCST_P * sizeof *p, cudaMemcpyHostToDevice))) return;
    if (bad(cudaMemcpy(device.u, u1, n * sizeof *u1, cudaMemcpyHostToDevice))) return;
    if (bad(cudaMemcpy(device.u + n, u2, n * sizeof *u2, cudaMemcpyHostToDevice))) return;
    device.draw<<<(unsigned)((n + 127) / 128), 128>>>(device.p, n, device.u, device.out);
    if (bad(cudaGetLastError())) return;
    for (size_t k = 0; k < 5; k++)
        if (bad(cudaMemcpy(out[k], device.out + k * n, n * sizeof **out, cudaMemcpyDeviceToHost))) return;
}

static void check_rows(void) {
    if (bad(cudaMalloc(&device.p, MCST_P * sizeof(float)))) return;
    if (bad(cudaMalloc(&device.u, 2 * MCST_BLOCK * sizeof(float)))) return;
    if (bad(cudaMalloc(&device.out, 5 * MCST_BLOCK * sizeof(float)))) return;
    for (size_t i = 0; i < MCST_NROWS; i++) {
        mcst_row row = mcst_rows[i];
        row.sample_n = draw_on_device;
        device.draw = kernels[i];
        mcst_chi2_row(&row);
    }
    cudaFree(device.p);
    cudaFree(device.u);
    cudaFree(device.out);
}

/* --- rates -------------------------------------------------------------------------------------------------------- */

/* What is drawn from, the same for all threads. */
typedef struct {
    const mcs_env *env;
    mcs_vec3 wo;
    float alpha_x, alpha_y;
} setting;
typedef struct {
    mcs_vec3 w;
    float pdf;
} drawn;

/* A sampler: a name, and one direction from two numbers. */
struct cosine {
    static const char *name() { return "cosine"; }
    static __device__ drawn sample(const setting &, float u1, float u2) {
        const mcs_dir s = mcs_cosine_sample(u1, u2);
        return {s.w, s.pdf};
    }
};
struct visible_normals {
    static const char *name() { return "GGX, visible normals"; }
    static __device__ drawn sample(const setting &from, float u1, float u2) {
        const mcs_ggx m = mcs_ggx_make(from.alpha_x, from.alpha_y);
        const mcs_brdf s = mcs_ggx_vndf_sample(&m, from.wo, u1, u2);
        return {s.wi, s.pdf};
    }
};
struct map_of_light {
    static const char *name() { return "map of 2048 x 1024"; }
    static __device__ drawn sample(const setting &from, float u1, float u2) {
        const mcs_texel s = mcs_env_sample(from.env, u1, u2);
        return {s.w, s.pdf};
    }
};

/* Threads of a launch, draws of a thread, and entries of an array: 1.5 GB in six arrays. */
enum { BLOCK = 128, BLOCKS = 1 << 13, DRAWS = 256, ENTRIES = 1 << 26, ROUNDS = 5 };

/* Numbers from a counter, directions in registers: a sum of them is all that is written. */
template <class SAMPLER> __global__ void in_registers(setting from, const float *, float *out) {
    const uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    mcs_pcg32 rng = mcs_pcg32_for(1, i, 0);
    float sum = 0;
    for (int k = 0; k < DRAWS; k++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const drawn d = SAMPLER::sample(from, u1, u2);
        sum += d.w.x + d.w.y + d.w.z + d.pdf;
    }
    out[i] = sum;
}
/* Two numbers are read; a direction and its density are written. */
template <class SAMPLER> __global__ void in_arrays(setting from, const float *u, float *out) {
    const size_t i = blockIdx.x * (size_t)blockDim.x + threadIdx.x;
    const size_t n = gridDim.x * (size_t)blockDim.x;
    const drawn d = SAMPLER::sample(from, u[i], u[n + i]);
    out[i] = d.w.x;
    out[n + i] = d.w.y;
    out[2 * n + i] = d.w.z;
    out[3 * n + i] = d.pdf;
}
/* Four numbers a call. */
__global__ void philox(setting, const float *, float *out) {
    const size_t i = blockIdx.x * (size_t)blockDim.x + threadIdx.x;
    const size_t n = gridDim.x * (size_t)blockDim.x;
    const mcs_philox4 words = mcs_philox(1, i, 0);
    for (size_t k = 0; k < 4; k++) out[k * n + i] = mcs_u01(words.v[k]);
}
/* Four coordinates of a point. */
__global__ void sobol(setting, const float *, float *out) {
    const size_t i = blockIdx.x * (size_t)blockDim.x + threadIdx.x;
    const size_t n = gridDim.x * (size_t)blockDim.x;
    for (uint32_t k = 0; k < 4; k++) out[k * n + i] = mcs_sobol((uint32_t)i, k, 1);
}

typedef void rated(setting from, const float *u, float *out);

/* The median time of a launch in seconds. */
static double seconds(rated *run, unsigned blocks, const setting &from, const float *u, float *out) {
    cudaEvent_t began, ended;
    if (bad(cudaEventCreate(&began)) || bad(cudaEventCreate(&ended))) return NAN;
    float ms[ROUNDS + 1];
    for (float &each : ms) {
        cudaEventRecord(began);
        run<<<blocks, BLOCK>>>(from, u, out);
        cudaEventRecord(ended);
        if (bad(cudaEventSynchronize(ended)) || bad(cudaEventElapsedTime(&each, began, ended))) return NAN;
    }
    cudaEventDestroy(began);
    cudaEventDestroy(ended);
    std::sort(ms + 1, ms + ROUNDS + 1); /* the first one warms up */
    return 1e-3 * (double)ms[1 + ROUNDS / 2];
}
static int registers(rated *run) {
    cudaFuncAttributes a;
    return bad(cudaFuncGetAttributes(&a, run)) ? 0 : a.numRegs;
}
/* Bytes per second that the device copies, read and written both counted. */
static double copy_rate(float *to, const float *from) {
    const size_t bytes = (size_t)2 * ENTRIES * sizeof *to;
    cudaEvent_t began, ended;
    if (bad(cudaEventCreate(&began)) || bad(cudaEventCreate(&ended))) return NAN;
    float best = INFINITY;
    for (int i = 0; i <= ROUNDS; i++) {
        float ms = 0;
        cudaEventRecord(began);
        cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice);
        cudaEventRecord(ended);
        if (bad(cudaEventSynchronize(ended)) || bad(cudaEventElapsedTime(&ms, began, ended))) return NAN;
        best = fminf(best, ms);
    }
    cudaEventDestroy(began);
    cudaEventDestroy(ended);
    return 2e3 * (double)bytes / (double)best;
}

/* A map of noise with a sun, in memory of the device. */
static mcs_env *map_make(void) {
    const uint32_t w = 2048, h = 1024;
    std::vector<float> pixels((size_t)w * h);
    for (uint32_t i = 0; i < w * h; i++) pixels[i] = 0.5f + mcs_u01(mcs_hash(i, 1));
    for (uint32_t y = 300; y < 306; y++)
        for (uint32_t x = 700; x < 706; x++) pixels[(size_t)y * w + x] = 2e4f;
    const mcs_image image = mcs_image_make(pixels.data(), w, h, 1);
    std::vector<uint64_t> memory(mcs_env_bytes(w, h) / sizeof(uint64_t) + 1);
    mcs_env *const env = (mcs_env *)memory.data();
    const mcs_status status = mcs_env_build(env, memory.size() * sizeof(uint64_t), &image);
    CHECK(status == MCS_OK, "%d", (int)status);
    void *copy = NULL;
    if (bad(cudaMalloc(&copy, memory.size() * sizeof(uint64_t)))) return NULL;
    if (bad(cudaMemcpy(copy, env, memory.size() * sizeof(uint64_t), cudaMemcpyHostToDevice))) return NULL;
    return (mcs_env *)copy;
}

template <class SAMPLER>
static void rate(const char *detail, const setting &from, const float *u, float *out, double copied) {
    const double made = (double)BLOCKS * BLOCK * DRAWS / seconds(in_registers<SAMPLER>, BLOCKS, from, u, out);
    const double stored = ENTRIES / seconds(in_arrays<SAMPLER>, ENTRIES / BLOCK, from, u, out);
    const double bytes = 6 * sizeof(float) * stored;
    CHECK(made > 0 && stored > 0, "%g %g", made, stored);
    printf("  %-22s %-18s %8.1f G/s in registers (%3d of them), %6.1f G/s in arrays, %3.0f %% of a copy\n",
           SAMPLER::name(), detail, made * 1e-9, registers(in_registers<SAMPLER>), stored * 1e-9, 100 * bytes / copied);
}
static void rate_numbers(const char *name, rated *run, const setting &from, float *out, double copied) {
    const double made = 4.0 * ENTRIES / seconds(run, ENTRIES / BLOCK, from, NULL, out);
    CHECK(made > 0, "%g", made);
    printf("  %-22s %-18s %8.1f G/s in arrays (%3d registers), %3.0f %% of a copy\n", name, "", made * 1e-9,
           registers(run), 100 * sizeof(float) * made / copied);
}

static void print_rates(void) {
    cudaDeviceProp device_properties;
    float *u = NULL;
    float *out = NULL;
    if (bad(cudaGetDeviceProperties(&device_properties, 0))) return;
    if (bad(cudaMalloc(&u, (size_t)2 * ENTRIES * sizeof *u))) return;
    if (bad(cudaMalloc(&out, (size_t)4 * ENTRIES * sizeof *out))) return;
    setting from = {map_make(), {0.48f, 0.36f, 0.8f}, 0, 0};
    philox<<<ENTRIES / 2 / BLOCK, BLOCK>>>(from, NULL, u); /* fills 4 ENTRIES / 2 numbers */
    if (bad(cudaGetLastError())) return;
    const double copied = copy_rate(out, u);
    printf("  %s: copies %.2f TB/s\n", device_properties.name, copied * 1e-12);
    rate_numbers("Philox", philox, from, out, copied);
    rate_numbers("Sobol, 4 dimensions", sobol, from, out, copied);
    rate<cosine>("", from, u, out, copied);
    static const float alphas[][2] = {{0.3f, 0.3f}, {0.05f, 0.05f}, {0.5f, 0.05f}, {1, 1}};
    for (const float *alpha : alphas) {
        char detail[48];
        snprintf(detail, sizeof detail, "alpha %g, %g", (double)alpha[0], (double)alpha[1]);
        from.alpha_x = alpha[0];
        from.alpha_y = alpha[1];
        rate<visible_normals>(detail, from, u, out, copied);
    }
    rate<map_of_light>("", from, u, out, copied);
    cudaFree(u);
    cudaFree(out);
    cudaFree((void *)from.env);
}

int main(int argc, char **argv) {
    int devices = 0;
    mcst_start(argc, argv);
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
        puts("SKIPPED: ALL OF IT: it compiles, but NOTHING WAS RUN, as there is no GPU here");
        return 0;
    }
    check_rows();
    mcst_group("rates");
    if (mcst_case("print")) print_rates();
    return mcst_finish();
}
