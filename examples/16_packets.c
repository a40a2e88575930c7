/* Packets: eight samples at once, for renderers that trace eight rays at once. mcs8_X is mcs_X for eight points. The
 * types mcs8_f, mcs8_u and mcs8_i have C's operators; a comparison is -1 in the lanes where it is true, and & selects.
 * Known answer: Phong's lobe of exponent 1, seen at an angle c, reflects (sin c + (pi - c) cos c) / pi of even light.
 * gcc notes how vectors are passed between functions; all are inlined here, so -Wno-psabi may silence it. */
#define MCS_PACKETS 8
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

#ifdef MCS_NO_WIDE
int main(void) {
    puts("SKIPPED: this compiler has no vector types, so there are no packets");
    return 0;
}
#else
enum { PACKETS = 100000 };

/* The weights of eight samples, 0 where one is lost. */
static mcs8_f reflect_packet(const mcs8_phong *m, mcs8_vec3 wo, mcs_pcg32 *rng) {
    float u[16];
    mcs_pcg32_fill_n(rng, 16, u);
    const mcs8_brdf b = mcs8_phong_sample(m, wo, mcs8_load(u), mcs8_load(u + 8));
    const mcs8_i kept = (mcs8_i)(b.pdf > 0);
    return (mcs8_f)((mcs8_i)b.weight & kept);
}

int main(void) {
    const double pi = 3.14159265358979;
    const double c = acos(0.6);
    const double exact = (sin(c) + (pi - c) * cos(c)) / pi;
    const mcs8_phong m = mcs8_phong_make(mcs8_set(1));
    const mcs8_vec3 wo = {mcs8_set(0.8f), mcs8_set(0), mcs8_set(0.6f)}; /* lanes may differ */
    mcs_pcg32 rng = mcs_pcg32_for(16, 1, 0);
    mcs_stat s = {0, 0, 0};

    for (int i = 0; i < PACKETS; i++) {
        float value[8];
        mcs8_store(value, reflect_packet(&m, wo, &rng));
        for (int lane = 0; lane < 8; lane++) mcs_stat_add(&s, value[lane]);
    }
    printf("reflected: %.5f +- %.5f, exact %.5f\n", s.mean, mcs_stat_error(&s), exact);
    return !(fabs(s.mean - exact) <= 5 * mcs_stat_error(&s));
}
#endif
