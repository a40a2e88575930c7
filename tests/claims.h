/* The figures of accuracy that mcsample.h states for directions, as numbers: test_oracle.c holds the header to them on its grids,
 * and looks up that the header states them; stress/climb.c searches for inputs that break them.
 *
 * A density is judged in E = 1e-6 (1 + |ln(pdf/peak)|), of Gaussian half-vectors given h or wi in 1e-6 (1 + e), e their exponent;
 * weights in 1e-6; the length of a direction by its distance from 1 in 2^-24. */
#ifndef MCST_CLAIMS_H
#define MCST_CLAIMS_H
#include "registry.h"

enum { CLAIM_PDF_U, CLAIM_PDF_W, CLAIM_EVAL, CLAIM_SAMPLE_WEIGHT, CLAIM_WEIGHT, CLAIM_LENGTH, CLAIMS };
static const char *const mcst_claim_name[CLAIMS] = {"pdf of u", "pdf of w", "eval", "weight of a sample", "weight of w", "length"};

/* A row of the registry, the range of its parameters, and what is promised of it there; 0: nothing. */
typedef struct {
    const char *row;
    double least[2], most[2], claim[CLAIMS];
} mcst_claim;
/* The figures of u for small exponents: a power n of the cosine gives (1-u1)/cos with ln cos = ln(1-u1)/(n+1), at most 16.7 in
 * size. Its logarithm, 1/(n+1) and their product round by half an ulp of that or more, 2.5e-6 in all, and with two exponents
 * 1/(n+1) is a rounded sum. |ln(pdf/peak)| = n/(n+1) 16.7 does not pay for that when n is near 0. */
#define MCST_NO_PARAMETER \
    {0, 0}, { 0, 0 }
#define MCST_ALPHAS \
    {1e-7, 1e-7}, { 1e4, 1e4 }
static const mcst_claim mcst_claims[] = {
    {"linear", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 0}},
    {"tent", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 0}},
    {"exponential", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 0}},
    {"truncexp", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 0}},
    {"normal", MCST_NO_PARAMETER, {0.45, 0.45, 0, 0, 0, 0}},
    {"logistic", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 0}},
    {"power", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 0}},
    {"evenpower", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 0}},
    {"disk", MCST_NO_PARAMETER, {0.1, 0.1, 0, 0, 0, 0}},
    {"concentric", MCST_NO_PARAMETER, {0.1, 0.1, 0, 0, 0, 0}},
    {"sphere", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 4}},
    {"hemisphere", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 4}},
    {"cosine", MCST_NO_PARAMETER, {0.2, 0.2, 0, 0, 0, 4}},
    {"cone", {1e-30, 0}, {2, 0}, {0.2, 0.2, 0, 0, 0, 4}},
    {"phong_lobe", {1, 0}, {1e9, 0}, {0.4, 0, 0, 0, 0, 0}},
    {"phong_lobe", {0.1, 0}, {1, 0}, {1.2, 0, 0, 0, 0, 0}},
    {"phong_lobe", {0, 0}, {1e9, 0}, {2.9, 0.6, 0, 0, 0, 4}},
    {"phong", {1, 0}, {1e9, 0}, {0.4, 0, 0, 0, 0, 0}},
    {"phong", {0.1, 0}, {1, 0}, {1.2, 0, 0, 0, 0, 0}},
    {"phong", {0, 0}, {1e9, 0}, {2.9, 0.6, 0.6, 0.3, 0.3, 4}},
    {"ward_h", MCST_ALPHAS, {1.2, 1, 0, 0, 0, 4}},
    {"ward_gmd", MCST_ALPHAS, {1.2, 1, 1.4, 1.8, 0.8, 4}},
    {"ward_duer", MCST_ALPHAS, {1.2, 1, 1.4, 1.8, 0.8, 4}},
    {"ward_1992", MCST_ALPHAS, {1.2, 1, 1.4, 1.8, 0.8, 4}},
    {"beckmann_h", MCST_ALPHAS, {1.2, 1, 0, 0, 0, 4}},
    {"beckmann", MCST_ALPHAS, {1.2, 1, 1.4, 1.8, 0.8, 4}},
    {"ggx_h", MCST_ALPHAS, {1.2, 1.2, 0, 0, 0, 4}},
    {"ggx", MCST_ALPHAS, {1.2, 1.2, 1.5, 1.6, 0.7, 4}},
    {"ggx_vndf_h", MCST_ALPHAS, {2.1, 1.5, 0, 0, 0, 4}},
    {"ggx_vndf", MCST_ALPHAS, {2.1, 1.5, 1.5, 0.7, 0.7, 4}},
    {"ggx_bounded_h", MCST_ALPHAS, {2.1, 1.5, 0, 0, 0, 4}},
    {"ggx_bounded", MCST_ALPHAS, {2.1, 1.5, 1.5, 0.7, 0.7, 4}},
    {"ashikhmin_h", {1, 1}, {1e9, 1e9}, {0.8, 0, 0, 0, 0, 0}},
    {"ashikhmin_h", {0.1, 0.1}, {1e9, 1e9}, {1.4, 0, 0, 0, 0, 0}},
    {"ashikhmin_h", {0, 0}, {1e9, 1e9}, {3.7, 0.6, 0, 0, 0, 4}},
    {"ashikhmin", {1, 1}, {1e9, 1e9}, {0.8, 0, 0, 0, 0, 0}},
    {"ashikhmin", {0.1, 0.1}, {1e9, 1e9}, {1.4, 0, 0, 0, 0, 0}},
    {"ashikhmin", {0, 0}, {1e9, 1e9}, {3.7, 0.6, 0.6, 0.1, 0.1, 4}},
};

/* The sentences that state them. */
static const char *const mcst_claim_sentences[] = {
    "pdf errors are relative, in units of E = 1e-6 (1 + |ln(pdf/peak)|)",
    "pdf of u and of x within 0.45 E (normal), 0.2 E (the others)",                                           /* [1d] */
    "coordinates within 2^-23 R, pdf 0.1 E.",                                                                 /* [disk] */
    "unit length within 4 x 2^-24, pdf within 0.2 E.",                                                        /* [sphere] */
    "pdf of u 0.4 E (n below 1: 1.2 E, below 0.1: 2.9 E), of w and eval 0.6 E, weight 0.3e-6, |w| 4 x 2^-24", /* [phong] */
    "pdf of u 1.2 E; of h and wi 1e-6 (1 + e), eval 1.4e-6 (1 + e), e the exponent, while e is below 87; weight 0.8e-6, of a "
    "sample 1.8e-6; |h| and |wi| 4 x 2^-24",        /* [ward] */
    "Parameters, edges, cost and accuracy as Ward", /* [beckmann] */
    "h and ggx: pdf of u 1.2 E, of h or wi 1.2 E; vndf, bounded: pdf of u 2.1 E, of h or wi 1.5 E; eval 1.5 E, weight 0.7e-6, of a "
    "sample 0.7e-6 (ggx 1.6e-6); |h| and |wi| 4 x 2^-24", /* [ggx] */
    "pdf of u 0.8 E (an exponent below 1: 1.4 E, below 0.1: 3.7 E), of h, wi and eval 0.6 E, weight 0.1e-6, |h| and |wi| 4 x 2^-24",
};

/* The figure for parameters p: of the narrowest range that holds them. Rows that the table leaves out have 1, in their units. */
static inline double mcst_claim_of(const mcst_row *row, int what, const float *p) {
    for (size_t i = 0; i < MCST_COUNT(mcst_claims); i++) {
        const mcst_claim *c = &mcst_claims[i];
        if (strcmp(c->row, row->name) != 0 || c->claim[what] == 0) continue;
        if ((double)p[0] < c->least[0] && row->coord == MCST_COSPOWER) continue;
        if (row->params > 1 && (double)p[1] < c->least[1] && row->coord == MCST_COSPOWER) continue;
        return c->claim[what];
    }
    return 1;
}

/* Is its unit 1e-6 (1 + e)? */
static inline int mcst_is_gauss(const mcst_row *row) {
    return strncmp(row->name, "ward", 4) == 0 || strncmp(row->name, "beckmann", 8) == 0;
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
