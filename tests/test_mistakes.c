/* The commonest mistakes of users, as MCS_ASSERT tells them: directions that are not unit vectors, random numbers
 * outside [0,1). What a careful caller gives, normalised in float and turned by many float frames, must pass. */
#include "asserting.h"
#include "registry.h"

static const float wrong_length[] = {0,      0.3f,  0.5f, 0.7f, 0.9f, 0.99f, 0.999f,
                                     1.001f, 1.01f, 1.1f, 1.9f, 2.5f, 1e20f, NAN};
static const float wrong_u[] = {1, -1e-7f, 2, -INFINITY, INFINITY, NAN};
enum {
    LENGTHS = sizeof wrong_length / sizeof *wrong_length,
    US = sizeof wrong_u / sizeof *wrong_u,
    TURNS = 100,
    CAREFUL = 2000
};

/* A direction above the surface, as a user's program makes it. */
static mcs_vec3 careful(uint64_t *state) {
    mcs_vec3 w;
    do {
        w.x = (float)(int32_t)(mcst_mix(state) >> 32) * 0x1p-31f;
        w.y = (float)(int32_t)(mcst_mix(state) >> 32) * 0x1p-31f;
        w.z = (float)(uint32_t)(mcst_mix(state) >> 33) * 0x1p-31f;
    } while (w.x * w.x + w.y * w.y + w.z * w.z < 1e-4f);
    const float inverse = 1 / sqrtf(w.x * w.x + w.y * w.y + w.z * w.z);
    w.x *= inverse;
    w.y *= inverse;
    w.z *= inverse;
    return w;
}

/* A function of a row at a point that is to be judged: does it assert? */
static int tells(const mcst_row *row, int which, const float *p, const float *x) {
    const float u = 0.3f;
    asserted = 0;
    float out[5];
    switch (which) {
    case 0: row->fn[0].pdf(p, x, out); break;
    case 1:
        if (row->fn[0].invert) row->fn[0].invert(p, x, out);
        break;
    case 2: row->fn[0].sample(p, &u, &u, out); break;
    case 3:
        if (row->fn[0].eval) row->fn[0].eval(p, x, out);
        break;
    default:
        if (row->fn[0].weight) row->fn[0].weight(p, x, out);
    }
    return asserted;
}

static void check_numbers(const mcst_row *row, const float *p) {
    for (int i = 0; i < US; i++) {
        const float good = 0.3f;
        asserted = 0;
        float out[5];
        row->fn[0].sample(p, &wrong_u[i], &good, out);
        CHECK(asserted > 0, "u1 = %g", (double)wrong_u[i]);
        asserted = 0;
        row->fn[0].sample(p, &good, &wrong_u[i], out);
        CHECK(row->inputs < 2 || asserted > 0, "u2 = %g", (double)wrong_u[i]);
    }
}
static void check_lengths(const mcst_row *row, int which, float *p) {
    static const int takes_point[] = {1, 1, 0, 1, 1};
    float x[3];
    for (int i = 0; i < LENGTHS; i++) {
        const float w[3] = {0.48f, 0.6f, 0.64f};
        const float length = wrong_length[i];
        for (int k = 0; k < 3; k++) {
            x[k] = w[k];
            p[3 + k] = w[k];
        }
        CHECK(!tells(row, which, p, x), "function %d tells of unit vectors", which);
        for (int k = 0; k < 3; k++) x[k] = length * w[k];
        CHECK(!takes_point[which] || tells(row, which, p, x), "function %d, point of length %g", which, (double)length);
        for (int k = 0; k < 3; k++) {
            x[k] = w[k];
            p[3 + k] = length * w[k];
        }
        CHECK(!row->has_wo || tells(row, which, p, x), "function %d, wo of length %g", which, (double)length);
    }
}
/* The wo of an array form. */
static void check_arrays(const mcst_row *row, float *p) {
    for (int i = 0; i < LENGTHS; i++) {
        const float u[3] = {0.1f, 0.2f, 0.3f};
        float y[5][3];
        float *const to[5] = {y[0], y[1], y[2], y[3], y[4]};
        p[3] = 0;
        p[4] = 0.6f * wrong_length[i];
        p[5] = 0.8f * wrong_length[i];
        asserted = 0;
        row->sample_n(p, 3, u, u, to);
        CHECK(asserted > 0, "array form, wo of length %g", (double)wrong_length[i]);
        if (!row->pdf_n) continue;
        asserted = 0;
        row->pdf_n(p, 3, u, u, u, y[0]);
        CHECK(asserted > 0, "densities in arrays, wo of length %g", (double)wrong_length[i]);
    }
}
static void check_careful(const mcst_row *row, float *p) {
    uint64_t state = mcst.seed;
    for (int i = 0; i < CAREFUL; i++) {
        const mcs_vec3 w = careful(&state);
        const mcs_vec3 wo = careful(&state);
        const float good[3] = {w.x, w.y, w.z};
        p[3] = wo.x;
        p[4] = wo.y;
        p[5] = wo.z;
        for (int which = 0; which < 5; which++)
            CHECK(!tells(row, which, p, good), "function %d tells of a careful caller's vectors", which);
    }
}

static void check_row(const mcst_row *row) {
    float p[MCST_P];
    mcst_grid_get(row, 0, p);
    check_numbers(row, p);
    if (row->dim < 3) return;
    for (int which = 0; which < 5; which++) {
        if (which == 1 && !row->fn[0].invert) continue;
        if (which > 2 && !row->fn[0].eval) continue;
        check_lengths(row, which, p);
    }
    if (row->has_wo) check_arrays(row, p);
    check_careful(row, p);
}

/* Calls FUNCTION with a good vector `w` and with wrong ones. */
#define TELLS(name, call)                                                       \
    do {                                                                        \
        mcs_vec3 w = unit;                                                      \
        asserted = 0;                                                           \
        (void)(call);                                                           \
        CHECK(!asserted, name " tells of a unit vector");                       \
        for (int i_ = 0; i_ < LENGTHS; i_++) {                                  \
            const float l_ = wrong_length[i_];                                  \
            w.x = l_ * unit.x;                                                  \
            w.y = l_ * unit.y;                                                  \
            w.z = l_ * unit.z;                                                  \
            asserted = 0;                                                       \
            (void)(call);                                                       \
            CHECK(asserted > 0, name " says nothing of length %g", (double)l_); \
        }                                                                       \
    } while (0)
#define TELLS_U(name, call)                                                 \
    do {                                                                    \
        float u = 0.3f;                                                     \
        asserted = 0;                                                       \
        (void)(call);                                                       \
        CHECK(!asserted, name " tells of a good u");                        \
        for (int i_ = 0; i_ < US; i_++) {                                   \
            u = wrong_u[i_];                                                \
            asserted = 0;                                                   \
            (void)(call);                                                   \
            CHECK(asserted > 0, name " says nothing of u = %g", (double)u); \
        }                                                                   \
    } while (0)

static void check_vectors(void) {
    const mcs_vec3 unit = {0.48f, 0.6f, 0.64f};
    const mcs_vec3 tangent = {3, 0, 1};
    const mcs_ggx m = mcs_ggx_make(0.3f, 0.3f);
    TELLS("mcs_frame_make", mcs_frame_make(w));
    TELLS("mcs_frame_from_tangent", mcs_frame_from_tangent(w, tangent));
    TELLS("mcs_reflect, wo", mcs_reflect(w, unit));
    TELLS("mcs_reflect, h", mcs_reflect(unit, w));
    TELLS("mcs_half, wo", mcs_half(w, unit));
    TELLS("mcs_half, wi", mcs_half(unit, w));
    TELLS("mcs_cos_d, wo", mcs_cos_d(w, unit));
    TELLS("mcs_cos_d, wi", mcs_cos_d(unit, w));
    TELLS("mcs_refract, w", mcs_refract(w, unit, 1.5f));
    TELLS("mcs_refract, h", mcs_refract(unit, w, 1.5f));
    TELLS("mcs_ggx_d", mcs_ggx_d(&m, w));
    TELLS("mcs_ggx_g1", mcs_ggx_g1(&m, w));
    TELLS("mcs_ggx_g2, wo", mcs_ggx_g2(&m, w, unit));
    TELLS("mcs_ggx_g2, wi", mcs_ggx_g2(&m, unit, w));
    TELLS("mcs_ggx_albedo", mcs_ggx_albedo(&m, w));
    TELLS("mcs_ggx_compensation, wo", mcs_ggx_compensation(&m, w, unit));
    TELLS("mcs_ggx_compensation, wi", mcs_ggx_compensation(&m, unit, w));
    TELLS("mcs_ggx_glass_sample", mcs_ggx_glass_sample(&m, 1.5f, w, 0.5f, 0.5f, 0.5f));
    TELLS("mcs_ggx_glass_pdf", mcs_ggx_glass_pdf(&m, 1.5f, w, unit));
    TELLS("mcs_ggx_glass_eval, wo", mcs_ggx_glass_eval(&m, 1.5f, w, unit));
    TELLS("mcs_ggx_glass_eval, wi", mcs_ggx_glass_eval(&m, 1.5f, unit, w));
    TELLS("mcs_ggx_glass_weight", mcs_ggx_glass_weight(&m, 1.5f, unit, w));
}

/* Calls FUNCTION with a good index of refraction and with wrong ones. */
#define TELLS_ETA(name, call)                                                   \
    do {                                                                        \
        float eta = 1.5f;                                                       \
        asserted = 0;                                                           \
        (void)(call);                                                           \
        CHECK(!asserted, name " tells of a good index");                        \
        for (int i_ = 0; i_ < 4; i_++) {                                        \
            eta = wrong_eta[i_];                                                \
            asserted = 0;                                                       \
            (void)(call);                                                       \
            CHECK(asserted > 0, name " says nothing of index %g", (double)eta); \
        }                                                                       \
    } while (0)

static void check_indices(void) {
    const mcs_vec3 unit = {0.48f, 0.6f, 0.64f};
    const float wrong_eta[] = {0, -1.5f, 1.1e3f, NAN};
    TELLS_ETA("mcs_fresnel_dielectric", mcs_fresnel_dielectric(0.5f, eta));
    TELLS_ETA("mcs_fresnel_conductor", mcs_fresnel_conductor(0.5f, eta, 3));
    TELLS_ETA("mcs_refract", mcs_refract(unit, unit, eta));
    const mcs_ggx m = mcs_ggx_make(0.3f, 0.3f);
    TELLS_ETA("mcs_ggx_glass_sample", mcs_ggx_glass_sample(&m, eta, unit, 0.5f, 0.5f, 0.5f));
    TELLS_ETA("mcs_ggx_glass_pdf", mcs_ggx_glass_pdf(&m, eta, unit, unit));
    asserted = 0;
    mcs_ggx_glass_sample(&m, 1.5f, unit, 0.5f, 0.5f, 1);
    CHECK(asserted > 0, "third random number");
    asserted = 0;
    mcs_fresnel_conductor(0.5f, 0.2f, -3);
    CHECK(asserted > 0, "negative extinction");
}

/* What was not built is all zeros here, or NULL. A condition is told before anything is read of it. */
#define TELLS_UNBUILT(call)               \
    do {                                  \
        jmp_buf here;                     \
        asserted = 0;                     \
        asserted_way_out = &here;         \
        if (!setjmp(here)) (void)(call);  \
        asserted_way_out = NULL;          \
        CHECK(asserted > 0, "%s", #call); \
    } while (0)
static void check_unbuilt(void) {
    static double room[128];
    const mcs_pwc *pwc = (const mcs_pwc *)(const void *)room;
    const mcs_pwl *pwl = (const mcs_pwl *)(const void *)room;
    const mcs_pwc2 *pwc2 = (const mcs_pwc2 *)(const void *)room;
    const mcs_alias *alias = (const mcs_alias *)(const void *)room;
    const mcs_env *e = (const mcs_env *)(const void *)room;
    const mcs_tiles *t = (const mcs_tiles *)(const void *)room;
    const mcs_product *p = (const mcs_product *)(const void *)room;
    TELLS_UNBUILT(mcs_pwc_sample(pwc, 0.5f));
    TELLS_UNBUILT(mcs_pwc_sample(NULL, 0.5f));
    TELLS_UNBUILT(mcs_pwc_sample_bits(pwc, 1, 2));
    TELLS_UNBUILT(mcs_pwc_pdf(pwc, 0.5f));
    TELLS_UNBUILT(mcs_pwl_sample(pwl, 0.5f));
    TELLS_UNBUILT(mcs_discrete_sample(pwc, 0.5f));
    TELLS_UNBUILT(mcs_pwc2_sample(pwc2, 0.5f, 0.5f));
    TELLS_UNBUILT(mcs_alias_sample(alias, 0.5f));
    TELLS_UNBUILT(mcs_env_sample(e, 0.5f, 0.5f));
    TELLS_UNBUILT(mcs_env_sample(NULL, 0.5f, 0.5f));
    TELLS_UNBUILT(mcs_product_sample(p, t, e, 0.5f, 0.5f));
}
static void check_tables(void) {
    const mcs_vec3 unit = {0.48f, 0.6f, 0.64f};
    const float weights[] = {1, 2, 3, 4, 5, 6, 7, 8};
    const mcs_image image = mcs_image_make(weights, 4, 2, 1);
    static double pwc_room[128];
    mcs_pwc *pwc = (mcs_pwc *)(void *)pwc_room;
    static double pwl_room[128];
    mcs_pwl *pwl = (mcs_pwl *)(void *)pwl_room;
    static double alias_room[128];
    mcs_alias *alias = (mcs_alias *)(void *)alias_room;
    static double pwc2_room[128];
    mcs_pwc2 *pwc2 = (mcs_pwc2 *)(void *)pwc2_room;
    static double e_room[128];
    mcs_env *e = (mcs_env *)(void *)e_room;
    static double window_room[128];
    mcs_env_window *window = (mcs_env_window *)(void *)window_room;
    CHECK(!mcs_pwc_build(pwc, sizeof pwc_room, weights, 8) && !mcs_pwl_build(pwl, sizeof pwl_room, weights, 7) &&
              !mcs_alias_build(alias, sizeof alias_room, weights, 8) && !mcs_env_build(e, sizeof e_room, &image) &&
              !mcs_env_window_build(window, sizeof window_room, e, 0, 1, 1, 2) &&
              !mcs_pwc2_build(pwc2, sizeof pwc2_room, weights, 4, 2),
          "builds");
    TELLS_U("mcs_pwc_sample", mcs_pwc_sample(pwc, u));
    TELLS_U("mcs_pwl_sample", mcs_pwl_sample(pwl, u));
    TELLS_U("mcs_discrete_sample", mcs_discrete_sample(pwc, u));
    TELLS_U("mcs_alias_sample", mcs_alias_sample(alias, u));
    TELLS_U("mcs_pwc2_sample, u1", mcs_pwc2_sample(pwc2, u, 0.5f));
    TELLS_U("mcs_pwc2_sample, u2", mcs_pwc2_sample(pwc2, 0.5f, u));
    TELLS_U("mcs_env_sample, u1", mcs_env_sample(e, u, 0.5f));
    TELLS_U("mcs_env_sample, u2", mcs_env_sample(e, 0.5f, u));
    TELLS_U("mcs_env_window_sample", mcs_env_window_sample(window, e, u, u));
    TELLS("mcs_env_pdf", mcs_env_pdf(e, w));
    TELLS("mcs_env_texel", mcs_env_texel(e, w));
    TELLS("mcs_env_invert", mcs_env_invert(e, w));
    TELLS("mcs_env_window_pdf", mcs_env_window_pdf(window, e, w));
}

static void check_reservoirs(void) {
    mcs_kept kept[2];
    mcs_reservoir_k k = mcs_reservoir_k_make(kept, 2);
    mcs_reservoir r = {0, 0, 0};
    const mcs_reservoir other = {1, 1, 0};
    TELLS_U("mcs_reservoir_add", mcs_reservoir_add(&r, 1, 1.0f, (double)u));
    TELLS_U("mcs_reservoir_merge", mcs_reservoir_merge(&r, &other, (double)u));
    TELLS_U("mcs_reservoir_k_add", mcs_reservoir_k_add(&k, 1, 1.0f, (double)u));
}

/* A region has another size than what it is used with: that is told, and the region stays as it is. */
static void check_regions(const mcs_tiles *t, const mcs_tiles *larger, const mcs_env *e, const mcs_reflection *r) {
    const size_t bytes = mcs_region_bytes(16);
    const size_t big_bytes = mcs_region_bytes(32);
    mcs_region *g = (mcs_region *)malloc(bytes);
    mcs_region *kept = (mcs_region *)malloc(bytes);
    mcs_region *big = (mcs_region *)malloc(big_bytes);
    static double room[MCS_PRODUCT_BYTES(32) / 8 + 1];
    mcs_product *p = (mcs_product *)(void *)room;
    asserted = 0;
    CHECK(g && kept && big && !mcs_region_start(g, bytes, t) && !mcs_region_start(big, big_bytes, larger), "regions");
    mcs_region_add_point(g, t, e, r);
    mcs_region_merge(g, g);
    CHECK(!mcs_product_build_region(p, sizeof room, t, e, g) && !mcs_product_build(p, sizeof room, t, e, r, g) &&
              !asserted,
          "asserts of a region of the right size");
    memcpy(kept, g, bytes);
    mcs_region_merge(g, big);
    CHECK(asserted > 0, "merged with another size");
    asserted = 0;
    mcs_region_add_point(g, larger, e, r);
    CHECK(asserted > 0, "a point by other tiles");
    asserted = 0;
    mcs_region_inherit(g, big);
    CHECK(asserted > 0, "inherits from another size");
    CHECK(memcmp(kept, g, bytes) == 0, "regions and tiles of another size change a region");
    free(kept);
    free(g);
    free(big);
}

/* A product is sampled with tiles of another size than it was built from. Every tile has light, so that draws end
 * somewhere. */
static void check_products(void) {
    enum { W = 64, H = 32 };
    const mcs_vec3 unit = {0.48f, 0.6f, 0.64f};
    static float even[W * H];
    for (int k = 0; k < W * H; k++) even[k] = 1;
    const mcs_image image = mcs_image_make(even, W, H, 1);
    mcs_env *e = (mcs_env *)malloc(mcs_env_bytes(W, H));
    CHECK(e && !mcs_env_build(e, mcs_env_bytes(W, H), &image), "map");
    const size_t bytes = mcs_tiles_bytes(e, 32);
    mcs_tiles *t = (mcs_tiles *)malloc(bytes);
    mcs_tiles *other = (mcs_tiles *)malloc(bytes);
    static double p_room[MCS_PRODUCT_BYTES(16) / 8 + 1];
    mcs_product *p = (mcs_product *)(void *)p_room;
    const mcs_reflection r = {mcs_frame_make(unit), unit, 0.5f, 0.5f, 0.5f, MCS_PROFILE_GGX};
    CHECK(t && other && !mcs_tiles_build(t, bytes, e, 16) && !mcs_tiles_build(other, bytes, e, 32), "tiles");
    CHECK(!mcs_product_build(p, sizeof p_room, t, e, &r, NULL), "product");
    TELLS_U("mcs_product_sample", mcs_product_sample(p, t, e, u, u));
    TELLS("mcs_product_pdf", mcs_product_pdf(p, t, e, w));
    TELLS("mcs_tiles_of_direction", mcs_tiles_of_direction(t, e, w));
    asserted = 0;
    mcs_product_sample(p, other, e, 0.5f, 0.5f);
    CHECK(asserted > 0, "a sample by other tiles");
    asserted = 0;
    mcs_product_pdf(p, other, e, unit);
    CHECK(asserted > 0, "a density by other tiles");
    asserted = 0;
    mcs_product_sample_n(p, other, e, 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL);
    CHECK(asserted > 0, "an array by other tiles");
    asserted = 0;
    mcs_product_pdf_n(p, other, e, 0, NULL, NULL, NULL, NULL);
    CHECK(asserted > 0, "densities by other tiles");
    check_regions(t, other, e, &r);
    free(t);
    free(other);
    free(e);
}

/* Turned there and back by float frames, 100 of them. */
static void check_turns(void) {
    uint64_t state = mcst.seed;
    for (int i = 0; i < 500; i++) {
        mcs_vec3 w = careful(&state);
        for (int k = 0; k < TURNS; k++) {
            const mcs_frame f = mcs_frame_make(careful(&state));
            w = k % 2 ? mcs_to_local(&f, w) : mcs_to_world(&f, w);
        }
        asserted = 0;
        mcs_sphere_pdf(w);
        CHECK(!asserted, "|w|^2 - 1 = %g", (double)(w.x * w.x + w.y * w.y + w.z * w.z) - 1);
    }
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("mistakes of rows");
    for (size_t i = 0; i < MCST_NROWS; i++)
        if (mcst_case("%s", mcst_rows[i].name)) check_row(&mcst_rows[i]);
    mcst_group("mistakes elsewhere");
    if (mcst_case("functions of directions")) check_vectors();
    if (mcst_case("indices of refraction")) check_indices();
    if (mcst_case("tables and maps")) check_tables();
    if (mcst_case("tables and maps not built")) check_unbuilt();
    if (mcst_case("reservoirs")) check_reservoirs();
    if (mcst_case("products")) check_products();
    if (mcst_case("turned by 100 frames")) check_turns();
    return mcst_finish();
}
