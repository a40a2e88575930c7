/* The truth of every row of the registry, in oracle.h, in one uniform shape: part of registry.h, or of
 * tests/shared/rows.c.
 *
 *     map(p, u1, u2, x)   the exact point         pdf(p, x), pdf_u(p, u1, u2)   its density
 *     invert(p, x, u)     eval(p, x)   weight(p, x) */
#define OA_0
#define OA_1 (ld) p[0],
#define OA_2 (ld) p[0], (ld)p[1],
#define OA_corners o_corners((ld)p[0], (ld)p[1], 1.0L, 3.0L),
#define OA_cross o_corners((ld)p[0], 0.0L, 0.0L, (ld)p[1]),
#define OA_ball o_scale((ld)p[0], o_vec(-0.5L, 0.25L, 1.0L)), (ld)p[1],
#define OA_disk_light o_scale((ld)p[0], o_vec(-0.5L, 0.25L, 1.0L)), o_v3(0.48f, 0.6f, -0.64f), (ld)p[1],
#define OA_rectangle o_row_rectangle(p[0], p[1]),
#define OA_triangle o_row_triangle(p[0], p[1]),
#define OA_phong OA_1
#define OA_ward OA_2
#define OA_ward_gmd OA_2 0,
#define OA_ward_duer OA_2 1,
#define OA_ward_1992 OA_2 2,
#define OA_beckmann OA_2
#define OA_ggx OA_2
#define OA_ashikhmin OA_2
#define OWO mcst_o3(p + 3)

#define MCST_O_LINE(row, fn, args)                                                                                 \
    MCST_HOST_FN void mcsto_##row##_map(const float *p, ld u1, ld u2, ld *x) {                                     \
        (void)p, (void)u2;                                                                                         \
        x[0] = o_##fn##_map(OA_##args u1);                                                                         \
    }                                                                                                              \
    MCST_HOST_FN ld mcsto_##row##_pdf(const float *p, const float *x) { return o_##fn##_pdf(OA_##args(ld) x[0]); } \
    MCST_HOST_FN ld mcsto_##row##_pdf_u(const float *p, ld u1, ld u2) {                                            \
        (void)u2;                                                                                                  \
        return o_##fn##_pdf_u(OA_##args u1);                                                                       \
    }                                                                                                              \
    MCST_HOST_FN void mcsto_##row##_invert(const float *p, const float *x, ld *u) {                                \
        u[0] = o_##fn##_invert(OA_##args(ld) x[0]);                                                                \
    }

/* `point` takes the floats of a point to the oracle's type; `put` stores a mapped point; `lead` may end in wo. */
#define MCST_O_UV(row, fn, lead, type, point, put)                             \
    MCST_HOST_FN void mcsto_##row##_map(const float *p, ld u1, ld u2, ld *x) { \
        const type v = o_##fn##_map(lead u1, u2);                              \
        (void)p;                                                               \
        put;                                                                   \
    }                                                                          \
    MCST_HOST_FN ld mcsto_##row##_pdf(const float *p, const float *x) {        \
        (void)p;                                                               \
        return o_##fn##_pdf(lead point(x));                                    \
    }                                                                          \
    MCST_HOST_FN ld mcsto_##row##_pdf_u(const float *p, ld u1, ld u2) {        \
        (void)p;                                                               \
        return o_##fn##_pdf_u(lead u1, u2);                                    \
    }
#define MCST_O_INVERT(row, fn, lead, point)                                         \
    MCST_HOST_FN void mcsto_##row##_invert(const float *p, const float *x, ld *u) { \
        const o_vec2 v = o_##fn##_invert(lead point(x));                            \
        (void)p;                                                                    \
        u[0] = v.x, u[1] = v.y;                                                     \
    }
#define MCST_PUT2 x[0] = v.x, x[1] = v.y
#define MCST_PUT3 x[0] = v.x, x[1] = v.y, x[2] = v.z
#define MCST_LEAD_WO(args) OA_##args OWO,
#define MCST_O_PLANE(row, fn, args)                           \
    MCST_O_UV(row, fn, OA_##args, o_vec2, mcst_o2, MCST_PUT2) \
    MCST_O_INVERT(row, fn, OA_##args, mcst_o2)
#define MCST_O_DIR(row, fn, args)                             \
    MCST_O_UV(row, fn, OA_##args, o_vec3, mcst_o3, MCST_PUT3) \
    MCST_O_INVERT(row, fn, OA_##args, mcst_o3)
#define MCST_O_LIGHT(row, fn, args) MCST_O_DIR(row, fn, args)
#define MCST_O_POLYGON(row, fn, args) MCST_O_DIR(row, fn, args)
#define MCST_O_LOBE(row, fn, args) MCST_O_DIR(row, fn, args)
#define MCST_O_VLOBE(row, fn, args)                                    \
    MCST_O_UV(row, fn, MCST_LEAD_WO(args), o_vec3, mcst_o3, MCST_PUT3) \
    MCST_O_INVERT(row, fn, MCST_LEAD_WO(args), mcst_o3)
#define MCST_O_BRDF(row, fn, args)                                         \
    MCST_O_UV(row, fn, MCST_LEAD_WO(args), o_vec3, mcst_o3, MCST_PUT3)     \
    MCST_HOST_FN ld mcsto_##row##_eval(const float *p, const float *x) {   \
        return o_##fn##_eval(MCST_LEAD_WO(args) mcst_o3(x));               \
    }                                                                      \
    MCST_HOST_FN ld mcsto_##row##_weight(const float *p, const float *x) { \
        return o_##fn##_weight(MCST_LEAD_WO(args) mcst_o3(x));             \
    }
#define MCST_O(shape, row, fn, arg, base, coord, grid) MCST_O_##shape(row, fn, arg)
MCST_ROWS(MCST_O)
