/* The claims of the registry's rows: the sentences of mcsample.h that state them, and what is claimed for given
 * parameters. */
#ifndef MCST_CLAIMS_H
#define MCST_CLAIMS_H
#include "registry.h"

static const char *const mcst_claim_name[CLAIMS] = {
    "pdf of u", "pdf of w", "eval", "weight of a sample", "weight of w", "length", "where", "distance", "place"};

/* The sentences that state them. */
/* clang-format off */
static const char *const mcst_claim_sentences[] = {
    "1 E is a relative error of 1e-6 (1 + |ln(pdf/peak)|)",
    /* [1d] */
    "pdf of u and of x within 0.45 E (normal), 0.3 E (the others)",
    "x is within 7 ulp (normal), 4 ulp (the others) of the exact map or of its scale.",
    /* [square] */
    "coordinates within 4 ulp of 1, pdf of u 0.7 E, of a point 0.5 E",
    /* [disk] */
    "coordinates within 2^-22 of the radius, pdf within 0.16 E",
    /* [triangle] */
    "coordinates within half an ulp of the exact map, for u of 0 and of 2^-125 and more; pdf exact",
    /* [lights] */
    "every coordinate within 1.25 x 2^-23 of the exact map, unit length within 4 x 2^-24",
    "pdf and distance within 1e-7 of themselves, for d up to 1e9 radii and p at least 1e-8 d from the surface.",
    "coordinates within 2^-24, pdf and distance within 1e-7 of themselves, for samples whose distance is 1e-4 radii or "
    "more",
    "w within 1.1 x 2^-24 of the exact map by coordinate, places on the light within 1.1 x 2^-24, pdf within 2e-7 and "
    "distance within 1e-7 of itself, for solid angles of 1e-12 and more, lights 1e5 times as long as wide, and p "
    "further from the plane of the light than 1e-8 of its size and distance",
    /* [sphere] */
    "every coordinate within 1.4 x 2^-23 of the exact map, unit length within 4 x 2^-24, pdf within 0.2 E.",
    /* [frame], [fresnel] */
    "brought to unit length, each coordinate within 2^-23",
    "reflectance within 1.6e-6 (dielectric), 1.2e-6 (conductor) of itself, refracted directions within 2^-23 by "
    "coordinate, their length within 4 x 2^-24, for eta in [1/3, 3] and all cosines",
    /* [media] */
    "every coordinate within 1.25 x 2^-23 of the exact map (von_mises_fisher 1.4 x 2^-23), unit length within "
    "4 x 2^-24, pdf of u within 0.2 E, of w within 0.6 E (henyey_greenstein), 0.2 E "
    "(rayleigh), 0.4 E (von_mises_fisher).",
    /* [phong] */
    "pdf of u 0.4 E (n below 1: 1.2 E, below 0.1: 2.9 E), of w and eval 0.6 E, weight 0.3e-6, |w| 4 x "
    "2^-24",
    /* [ward] */
    "pdf of u 1.2 E; of h and wi 1e-6 (1 + e), eval 1.4e-6 (1 + e), e the exponent, while e is below 87; "
    "weight 0.8e-6, of a sample 1.8e-6; |h| and |wi| 4 x 2^-24",
    /* [beckmann] */
    "that of [ward]: pdf, eval and weights are held to the same figures",
    /* [ggx] */
    "h and ggx: pdf of u 1.2 E, of h or wi 1.2 E; vndf, bounded: pdf of u 2.1 E, of h or wi 1.5 E; eval "
    "1.5 E, weight 0.7e-6, of a sample 0.7e-6 (ggx 1.6e-6); |h| and |wi| 4 x 2^-24",
    "albedos are fits: within 0.25 % for alpha_x = alpha_y in [0.01,1] and all angles; f and its compensation reflect 1 "
    "within 0.4 % there.",
    /* [glass] */
    "pdf of u 4 E, of wi and f 3 E, weights 1e-6;",
    /* [ashikhmin] */
    "pdf of u 0.8 E (an exponent below 1: 1.4 E, below 0.1: 3.7 E), of h, wi and eval 0.6 E, weight "
    "0.1e-6, |h| and |wi| 4 x 2^-24",
};
/* clang-format on */

/* The figure for parameters p: of the narrowest range that holds them. What a row does not claim is 1, in its units. */
static inline double mcst_claim_of(const mcst_row *row, int what, const float *p) {
    for (size_t i = 0; i < row->claims_size; i++) {
        const mcst_claim *c = &row->claims[i];
        if (c->claim[what] == 0) continue;
        if ((double)p[0] < c->least[0]) continue;
        if (row->params > 1 && (double)p[1] < c->least[1]) continue;
        return c->claim[what];
    }
    return 1;
}

/* 1 where the comments of the header say the sentence, wherever its lines break. */
static inline int mcst_header_says(const char *path, const char *sentence) {
    FILE *f = fopen(path, "r");
    static char text[1 << 20];
    size_t n = 0;
    int start_of_line = 1;
    if (!f) return 0;
    int c;
    while ((c = getc(f)) != EOF && n + 1 < sizeof text) {
        if (c == '\n') {
            start_of_line = 1;
            c = ' ';
        } else if (start_of_line && (c == ' ' || c == '*')) continue;
        else start_of_line = 0;
        if (c == ' ' && n > 0 && text[n - 1] == ' ') continue;
        text[n++] = (char)c;
    }
    text[n] = 0;
    fclose(f);
    return strstr(text, sentence) != NULL;
}
#endif
