/* Every public function of mcsample.h in one shape, found by its name in the header's part I: by the rows of registry.h
 * and by the adapters of bits.h. What test_bits.c and test_fenv.c share. With -DMCST_LINKED the adapters are in
 * tests/shared. */
#ifndef MCST_FUNCTIONS_H
#define MCST_FUNCTIONS_H
#define MCST_WIDE
#include "registry.h"
#include "arena.h"
#include "index.h"

/* --- the hash: FNV-1a, 64 bits, over the bit patterns, low byte first --------------------------------------------- */

#define BITS_START 0xcbf29ce484222325u
MCST_HD static inline uint64_t bits_hash(uint64_t hash, const void *words, size_t n) {
    const char *a = (const char *)words;
    size_t i;
    int k;
    for (i = 0; i < n; i++) {
        uint32_t word;
        memcpy(&word, a + i * sizeof word, sizeof word);
        for (k = 0; k < 32; k += 8) hash = (hash ^ (word >> k & 255)) * 0x100000001B3u;
    }
    return hash;
}

/* --- the size of inputs and results ------------------------------------------------------------------------------- */

/* BLOCKS parameter sets with BLOCK cases each, so that an array form has two vectors of 8 and a rest. */
enum {
    BLOCK = 19,
    BLOCKS = 128,
    CASES = BLOCK * BLOCKS,
    BITS_IN = 14,
    BITS_OUT = 10,
    P = 0,
    WO = 3,
    U = 6,
    X = 8,
    WORDS = 11
};

MCST_HD static inline float from_bits(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Built once and kept until the end: maps, for each of them a window across the seam, tiles, a region, and a product for
 * each of some surfaces. Building one per case as for the tables above would take an emulator minutes. */
enum {
    BITS_RANDOM,
    BITS_SUN,
    BITS_RGB,
    BITS_BILINEAR,
    BITS_FLOOR,
    BITS_CONSTANT,
    BITS_BLACK,
    BITS_MAPS,
    BITS_SURFACES = 4,
    BITS_PRODUCTS = BITS_SURFACES + 1 /* that of the region last */
};
typedef struct {
    mcs_env *env;
    mcs_env_window *window;
    mcs_tiles *tiles;
    mcs_product *product[BITS_PRODUCTS];
    mcs_region *region;
    mcs_status status[3 + BITS_PRODUCTS];
    size_t tile_bytes;
} bits_map;
/* The map or product of a case, of so many. */
MCST_HD static inline int bits_kind_of(const float *in, int kinds) {
    uint32_t word;
    memcpy(&word, in + WORDS + 2, sizeof word);
    return (int)(word % (uint32_t)kinds);
}

/* --- the adapters of bits.h --------------------------------------------------------------------------------------- */

typedef void bits_fn(const float *in, float *out);
/* For n cases of one map, or of one product. in: random numbers 0, 1, points 2, 3, 4. */
typedef void bits_array_fn(int kind, size_t n, float (*in)[CASES], float (*out)[CASES]);
#include "bits.h"
#ifdef MCST_LINKED
#define BITS_DECLARE(x) bits_fn bits1_##x, bits4_##x, bits8_##x, bits16_##x;
#define BITS_DECLARE_ONCE(x) bits_fn bits1_##x;
#define BITS_DECLARE_ARRAY(x, kinds) \
    bits_fn bits1_##x;               \
    bits_array_fn bits_array_##x;
/* clang-format off */
BITS_WIDE(BITS_DECLARE) BITS_WORDS(BITS_DECLARE) BITS_SCALAR(BITS_DECLARE_ONCE) BITS_MAPPED(BITS_DECLARE_ONCE)
BITS_HOST(BITS_DECLARE_ONCE) BITS_ARRAYS(BITS_DECLARE_ARRAY)
    /* clang-format on */
    const bits_map *bits_map_at(int kind);
extern int bits_valid; /* tables and maps have no bad entries */
#else
#ifdef __CUDACC__
namespace gpu {
static int present() {
    int count = 0;
    return cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
}
} // namespace gpu
#endif
static int bits_valid; /* tables and maps have no bad entries */
#define MCST_W 1
#include "bits.h"
#ifdef MCST_WIDE
#define MCST_W 8
#include "bits.h"
#ifndef MCST_EIGHT
#define MCST_W 4
#include "bits.h"
#define MCST_W 16
#include "bits.h"
#endif
#endif
#endif

#ifndef MCST_SHARED
/* --- functions by name -------------------------------------------------------------------------------------------- */

#if defined(MCST_WIDE) && defined(MCST_EIGHT)
#define FOUR(x) \
    { bits1_##x, NULL, bits8_##x, NULL }
#elif defined(MCST_WIDE)
#define FOUR(x) \
    { bits1_##x, bits4_##x, bits8_##x, bits16_##x }
#else
#define FOUR(x) \
    { bits1_##x, NULL, NULL, NULL }
#endif

/* A function of the header: a row and which of its functions, or one of bits.h. */
enum { SAMPLE, PDF, INVERT, EVAL, WEIGHT, SAMPLE_N, PDF_N, EVAL_N, SAMPLE_HITS_N, PDF_HITS_N, FORMS, OTHER = FORMS };
static const char *const suffix[FORMS] = {"sample",   "pdf",   "invert", "eval",          "weight",
                                          "sample_n", "pdf_n", "eval_n", "sample_hits_n", "pdf_hits_n"};
static const struct {
    const char *name;
    bits_fn *fn[4];
    int floats; /* all results are floats, and finite ones */
    int kinds;  /* of an array form: how many maps or products there are */
    bits_array_fn *array;
} others[] = {
#define LISTED(x) {"mcs_" #x, FOUR(x), 1, 0, NULL},
#define LISTED_WORD(x) {"mcs_" #x, FOUR(x), 0, 0, NULL},
#define LISTED_ONCE(x) {"mcs_" #x, {bits1_##x, NULL, NULL, NULL}, 0, 0, NULL},
#define LISTED_ARRAY(x, kinds) {"mcs_" #x, {bits1_##x, NULL, NULL, NULL}, 1, kinds, bits_array_##x},
    BITS_WIDE(LISTED) BITS_WORDS(LISTED_WORD) BITS_SCALAR(LISTED_ONCE) BITS_MAPPED(LISTED_ONCE) BITS_HOST(LISTED_ONCE)
        BITS_ARRAYS(LISTED_ARRAY)};

typedef struct {
    int form, at; /* at: in mcst_rows, or in others */
} target;

static inline void call(target t, int w, int lanes, const float *in, float *out) {
    const mcst_fns *f = &mcst_rows[t.form == OTHER ? 0 : t.at].fn[w];
    switch (t.form) {
    case SAMPLE: f->sample(in, in + U * lanes, in + (U + 1) * lanes, out); break;
    case PDF: f->pdf(in, in + X * lanes, out); break;
    case INVERT: f->invert(in, in + X * lanes, out); break;
    case EVAL: f->eval(in, in + X * lanes, out); break;
    case WEIGHT: f->weight(in, in + X * lanes, out); break;
    default: others[t.at].fn[w](in, out);
    }
}

/* The first target of a name; at = -1: none. */
static inline target find_target(const char *name) {
    target t = {OTHER, -1};
    size_t i;
    for (i = 0; i < MCST_COUNT(others); i++)
        if (!strcmp(name, others[i].name)) {
            t.at = (int)i;
            return t;
        }
    for (i = 0; i < MCST_NROWS; i++)
        for (t.form = 0; t.form < FORMS; t.form++) {
            char text[64];
            snprintf(text, sizeof text, "mcs_%s_%s", mcst_rows[i].function, suffix[t.form]);
            if (strcmp(name, text) != 0) continue;
            t.at = (int)i;
            return t;
        }
    return t;
}

/* n hits by an array form, where entry k of hit i is in[k][i], as an adapter of bits.h has them. The parameters and wo of
 * each are in[P], in[P + 1] and from in[WO] on. */
static inline void call_hits(target t, size_t n, float *const in[WORDS], float *const out[5]) {
    const mcst_row *row = &mcst_rows[t.at];
    const float *const with[3] = {in[t.form == PDF_HITS_N ? X : U], in[t.form == PDF_HITS_N ? X + 1 : U + 1],
                                  in[X + 2]};
    const mcs_hits hits = {in[WO], in[WO + 1], in[WO + 2], in[P], row->params > 1 ? in[P + 1] : NULL};
    const float p[MCST_P] = {0};
    (t.form == PDF_HITS_N ? row->pdf_hits_n : row->sample_hits_n)(p, &hits, n, with, out);
}

/* The next row of the same function: Ward's three models. */
static inline int next_row(target *t) {
    const char *function = t->form == OTHER ? NULL : mcst_rows[t->at].function;
    while (function && ++t->at < MCST_NROWS)
        if (!strcmp(mcst_rows[t->at].function, function)) return 1;
    return 0;
}

/* The ways to evaluate: width indices 0..3, then */
enum { ARRAYS = 4, WAYS };
static const char *const way_name[WAYS] = {"scalar", "4 wide", "8 wide", "16 wide", "arrays"};

static inline int has_way(target t, int way) {
    const int arrays = t.form >= SAMPLE_N && t.form < FORMS;
    if (way == ARRAYS) return t.form == OTHER ? others[t.at].array != NULL : arrays;
    if (arrays || way > ARRAYS) return 0;
    return t.form == OTHER ? others[t.at].fn[way] != NULL : mcst_rows[t.at].fn[way].sample != NULL;
}
#endif
#endif
