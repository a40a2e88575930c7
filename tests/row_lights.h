/* The lights of the rows, for their two parameters: those of oracle.h. No include guard: for adapters.h and
 * bench/forms.h, once per width, with the types F_ and M_(x) and the names L_(x) of these functions. */
MCST_HD static inline M_(vec3) L_(vec3_of)(F_ x, F_ y, F_ z) {
    M_(vec3) v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
/* The point that is lit. */
MCST_HD static inline M_(vec3) L_(origin)(void) { return L_(vec3_of)(M_(set)(0.0f), M_(set)(0.0f), M_(set)(0.0f)); }
/* A light that lies neither on an axis nor in front: at (-1/2, 1/4, 1) times a distance. */
MCST_HD static inline M_(vec3) L_(aside)(F_ distance) {
    return L_(vec3_of)(-0.5f * distance, 0.25f * distance, distance);
}
/* The normal of a disk: 50 degrees from that direction. */
MCST_HD static inline M_(vec3) L_(tilted)(void) { return L_(vec3_of)(M_(set)(0.48f), M_(set)(0.6f), M_(set)(-0.64f)); }
MCST_HD static inline M_(spherical_rectangle) L_(row_rectangle)(F_ a, F_ b) {
    const F_ height = a * b;
    const F_ zero = M_(set)(0.0f);
    const F_ z = 1.0f - 0.0625f * a;
    return M_(spherical_rectangle_make)(L_(origin)(), L_(vec3_of)(-0.25f * a, -0.5f * height, z - 0.0625f * height),
                                        L_(vec3_of)(a, zero, 0.25f * a), L_(vec3_of)(zero, height, 0.125f * height));
}
MCST_HD static inline M_(spherical_triangle) L_(row_triangle)(F_ a, F_ b) {
    const F_ height = a * b;
    return M_(spherical_triangle_make)(L_(origin)(), L_(vec3_of)(-a, -height, 1.25f - 0.25f * height),
                                       L_(vec3_of)(0.9f * a, -0.5f * height, 1.25f - 0.125f * height),
                                       L_(vec3_of)(0.25f * a, height, 1.25f + 0.25f * height));
}
