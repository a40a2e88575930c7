/* What the benchmarks share: clock, repetitions, the description of machine and build, files, progress.
 *
 *     bench_start(argc, argv, "throughput");            --quick, --out DIRECTORY (default build/bench, made when
 *     missing) FILE *csv = bench_csv("throughput.csv", "sampler,form,...");
 *     bench_progress("%d of %d", i, n);                 one line on stderr that overwrites itself; only on a terminal
 *     bench_spread s = bench_spread_of(times, rounds);  median, min, max
 *
 * Times are of interleaved repetitions: whatever is to be compared takes turns, so that other load and changes of clock
 * speed meet all of it. BENCH_FLAGS is the compiler's command line as a string, defined by the Makefile. */
#ifndef BENCH_H
#define BENCH_H
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#ifndef BENCH_FLAGS
#define BENCH_FLAGS "unknown flags"
#endif
#if defined(__clang__)
#define BENCH_COMPILER __VERSION__
#elif defined(__GNUC__)
#define BENCH_COMPILER "gcc " __VERSION__
#else
#define BENCH_COMPILER "unknown compiler"
#endif

static struct {
    const char *out;
    int quick;
    char title[512];      /* compiler, flags, processor: one line */
    volatile double sink; /* results that are summed up here cannot be optimised away */
} bench;

typedef struct {
    double median, min, max;
} bench_spread;

/* Of a builder of the header that is given what it needs: MCS_OK is 0. */
static inline void bench_built(int status) {
    if (status == 0) return;
    fprintf(stderr, "a builder returned %d\n", status);
    exit(2);
}

static inline double bench_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int bench_ascending(const void *a, const void *b) {
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static inline bench_spread bench_spread_of(double *v, int n) { /* sorts v */
    qsort(v, (size_t)n, sizeof *v, bench_ascending);
    bench_spread s;
    s.min = v[0];
    s.max = v[n - 1];
    s.median = n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
    return s;
}

/* sink += the sum of an array of results; sums that are not finite are left out */
static inline void bench_consume(size_t n, const float *v) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += (double)v[i];
    if (sum - sum == 0) bench.sink = bench.sink + sum;
}

static inline void bench_cpu(char *name, size_t size) {
    FILE *f = fopen("/proc/cpuinfo", "r");
    snprintf(name, size, "unknown processor");
    char line[256];
    while (f && fgets(line, sizeof line, f)) {
        const char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) || !value) continue;
        line[strcspn(line, "\n")] = 0;
        snprintf(name, size, "%s", value + 2);
        break;
    }
    if (f) fclose(f);
}

static inline int bench_make_directory(const char *path) {
    char part[512];
    for (size_t i = 0; i < sizeof part - 1; i++) {
        if (i && (path[i] == '/' || !path[i])) {
            part[i] = 0;
            if (mkdir(part, 0777) && errno != EEXIST) return -1;
        }
        part[i] = path[i];
        if (!path[i]) return 0;
    }
    return -1;
}

static inline void bench_start(int argc, char **argv, const char *name) {
    const char *units = "";
    bench.out = "build/bench";
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--quick")) bench.quick = 1;
        else if (!strcmp(argv[i], "--out") && i + 1 < argc) bench.out = argv[++i];
        else {
            fprintf(stderr, "usage: %s [--quick] [--out DIRECTORY]\n", name);
            exit(2);
        }
    }
    if (bench_make_directory(bench.out)) {
        fprintf(stderr, "%s: cannot make %s: %s\n", name, bench.out, strerror(errno));
        exit(2);
    }
    char cpu[128];
    bench_cpu(cpu, sizeof cpu);
#if defined(__GNUC__) && (defined(__x86_64__) || defined(__i386__))
    __builtin_cpu_init();
    units =
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")
            ? ", AVX-512"
        : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? ", AVX2"
                                                                          : ", no AVX2";
#endif
    snprintf(bench.title, sizeof bench.title, "%s; %s; %s%s%s", BENCH_COMPILER, BENCH_FLAGS, cpu, units,
             bench.quick ? "; quick run" : "");
    printf("%s: %s\n", name, bench.title);
}

/* The path of an output file, valid until the next call. */
static inline const char *bench_path(const char *file) {
    static char path[600];
    snprintf(path, sizeof path, "%s/%s", bench.out, file);
    return path;
}

/* A CSV file whose first line says, behind a '#', what ran where; its second line names the columns. Exits when it
 * cannot be made.
 */
static inline FILE *bench_csv(const char *file, const char *columns) {
    FILE *f = fopen(bench_path(file), "w");
    if (!f) {
        fprintf(stderr, "cannot write %s: %s\n", bench_path(file), strerror(errno));
        exit(2);
    }
    fprintf(f, "# %s\n%s\n", bench.title, columns);
    return f;
}

/* Closes a file of bench_csv; exits when not all of it was written. */
static inline void bench_close(FILE *f, const char *file) {
    const int bad = ferror(f);
    if (fclose(f) || bad) {
        fprintf(stderr, "cannot write %s\n", bench_path(file));
        exit(2);
    }
}

#ifdef __GNUC__
__attribute__((format(printf, 1, 2)))
#endif
static inline void
bench_progress(const char *format, ...) { /* an empty text wipes the line */
    if (!isatty(STDERR_FILENO)) return;
    va_list args;
    va_start(args, format);
    fputs("\r\033[K", stderr);
    vfprintf(stderr, format, args);
    va_end(args);
    fflush(stderr);
}
#endif
