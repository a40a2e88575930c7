/* An environment table holds no pointers: written to a file and mapped, it serves any number of programs at once,
 * without being built again. mcs_env_check says whether what was mapped is a table of this version and byte order, and
 * all of it. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L /* fileno, mmap */
#include <sys/mman.h>
#define HAVE_MMAP 1
#endif
#include "mcsample.h"
#include <stdio.h>
#include <stdlib.h>

enum { W = 64, H = 32 };

/* The contents of a file, to be read only. */
static const void *file_map(FILE *f, size_t bytes) {
#ifdef HAVE_MMAP
    void *p = mmap(NULL, bytes, PROT_READ, MAP_SHARED, fileno(f), 0);
    return p == MAP_FAILED ? NULL : p;
#else
    void *p = malloc(bytes);
    rewind(f);
    return p && fread(p, 1, bytes, f) == bytes ? p : NULL;
#endif
}

int main(void) {
    static float sky[H][W];
    const size_t bytes = mcs_env_bytes(W, H);
    const mcs_image image = mcs_image_make(&sky[0][0], W, H, 1);
    mcs_env *built = (mcs_env *)malloc(bytes);
    mcs_pcg32 rng = mcs_pcg32_for(11, 1, 0);
    FILE *f = tmpfile();
    int differ = 0;

    for (int i = 0; i < W * H; i++) sky[i / W][i % W] = mcs_pcg32_float(&rng);
    if (!f || !built || mcs_env_build(built, bytes, &image) != MCS_OK) {
        puts("no file or no memory");
        return 1;
    }
    if (fwrite(built, 1, bytes, f) != bytes || fflush(f) != 0) {
        puts("the file could not be written");
        return 1;
    }
    const mcs_env *shared = (const mcs_env *)file_map(f, bytes);
    if (!shared) {
        puts("the file could not be mapped");
        return 1;
    }

    const int whole = mcs_env_check(shared, bytes);   /* before anything else is asked of it */
    const int cut = mcs_env_check(shared, bytes / 2); /* as if the file had been cut short */
    /* no table begins here */
    const int other = mcs_env_check((const mcs_env *)(const void *)((const char *)shared + 64), bytes - 64);
    int draws = 0;
    for (; draws < 100000 && whole == MCS_OK; draws++) {
        const float u1 = mcs_pcg32_float(&rng);
        const float u2 = mcs_pcg32_float(&rng);
        const mcs_texel a = mcs_env_sample(built, u1, u2);
        const mcs_texel b = mcs_env_sample(shared, u1, u2);
        differ +=
            !(a.w.x == b.w.x && a.w.y == b.w.y && a.w.z == b.w.z && a.pdf == b.pdf && a.col == b.col && a.row == b.row);
    }
    printf("a table of %zu bytes: status %d, expected %d; %d of %d samples differ\n", bytes, whole, MCS_OK, differ,
           draws);
    printf("cut short: status %d, expected %d; no table: status %d, expected %d\n", cut, MCS_ERR_MEMORY, other,
           MCS_ERR_FORMAT);
    return !(whole == MCS_OK && differ == 0 && cut == MCS_ERR_MEMORY && other == MCS_ERR_FORMAT);
}
