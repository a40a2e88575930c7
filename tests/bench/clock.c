/* clock ROUNDS COMMAND...: runs the shell commands in turn, ROUNDS times, and prints for each the median, least and
 * greatest processor time (user and system, children included) in milliseconds. Processor time, as it is what a
 * compiler costs on an idle machine. */
#include "bench.h"
#include <sys/resource.h>

static double processor_ms(void) {
    struct rusage r;
    getrusage(RUSAGE_CHILDREN, &r);
    return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) * 1e3 +
           (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec) * 1e-3;
}

int main(int argc, char **argv) {
    const int rounds = argc > 2 ? atoi(argv[1]) : 0;
    const int commands = argc - 2;
    if (rounds < 1) {
        fprintf(stderr, "usage: clock ROUNDS COMMAND...\n");
        return 2;
    }
    double *ms;
    ms = malloc((size_t)rounds * (size_t)commands * sizeof *ms);
    if (!ms) return 2;
    for (int r = 0; r < rounds; r++) {
        for (int c = 0; c < commands; c++) {
            const double began = processor_ms();
            bench_progress("include: round %d of %d, command %d of %d", r + 1, rounds, c + 1, commands);
            if (system(argv[c + 2])) {
                fprintf(stderr, "clock: failed: %s\n", argv[c + 2]);
                return 1;
            }
            ms[c * rounds + r] = processor_ms() - began;
        }
    }
    bench_progress("%s", "");
    for (int c = 0; c < commands; c++) {
        const bench_spread s = bench_spread_of(ms + c * rounds, rounds);
        printf("%.1f %.1f %.1f\n", s.median, s.min, s.max);
    }
    free(ms);
    return 0;
}
