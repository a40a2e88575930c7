/* Every float: the vector maths of the header and its maps of one number, over all floats of their range (or all 2^24
 * random numbers k 2^-24), at every width.
 *
 * For each of up to two results of a map: the largest error against double or long double mathematics, where it is, how
 * often the result turns back where the exact map does not, and by how much, whether it leaves its range, and whether
 * the 4, 8 and 16 wide forms give the bits of the scalar one. Limits are those that the comments of the header state. A
 * double result is good to 2^-29 of a float ulp and counts as exact.
 *
 * MCS_TEST_SCALE below 1 takes every k-th number, k the next prime; the numbers around the ends and the seams of a
 * range are always all taken. A few sweeps that repeat others with another parameter take every 11th at full scale,
 * too: the table has the counts. */
#define MCST_WIDE
#include "claims.h"

enum { BLOCK = 4096, WIDTHS = 4, SEAMS = 8, AROUND = 64 };

/* --- the maps at four widths ---
 * I(name) is the private name at a width, P(name) the public one; x goes in, y and z come out. */

static float arg[2]; /* the parameters of the map under test */

typedef void block_fn(const float *in, float *y_out, float *z_out);

#define I1(name) mcsi_##name
#define I4(name) mcsi4_##name
#define I8(name) mcsi8_##name
#define I16(name) mcsi16_##name
#define P1(name) mcs_##name
#define P4(name) mcs4_##name
#define P8(name) mcs8_##name
#define P16(name) mcs16_##name

#define AT_WIDTH(map, W)                                                 \
    static void map##_##W(const float *in, float *y_out, float *z_out) { \
        int i;                                                           \
        for (i = 0; i < BLOCK; i += W) {                                 \
            const P##W(f) a = P##W(set)(arg[0]), b = P##W(set)(arg[1]);  \
            const P##W(f) x = P##W(load)(in + i);                        \
            P##W(f) y = x, z = x;                                        \
            (void)a, (void)b;                                            \
            DO_##map(I##W, P##W);                                        \
            P##W(store)(y_out + i, y), P##W(store)(z_out + i, z);        \
        }                                                                \
    }
#ifdef MCS_NO_WIDE
#define MAP(map)     \
    AT_WIDTH(map, 1) \
    static block_fn *const map##_at[WIDTHS] = {map##_1, NULL, NULL, NULL};
#else
#define MAP(map)     \
    AT_WIDTH(map, 1) \
    AT_WIDTH(map, 4) \
    AT_WIDTH(map, 8) AT_WIDTH(map, 16) static block_fn *const map##_at[WIDTHS] = {map##_1, map##_4, map##_8, map##_16};
#endif

#define DO_sincos(I, P) I(sincos_turns)(x, &y, &z)
#define DO_behind(I, P)                          \
    const I(angle) angle = I(angle_of_turns)(x); \
    y = angle.one_plus_cosine;                   \
    z = angle.cosine
#define DO_atan_y(I, P) y = z = I(atan2_turns)(x, P(set)(1.0f))
#define DO_atan_x(I, P) y = I(atan2_turns)(P(set)(1.0f), x), z = I(atan2_turns)(P(set)(-1.0f), x)
#define DO_log(I, P) y = I(log)(x)
#define DO_log1p(I, P) y = I(log1p)(x)
#define DO_exp_neg(I, P) y = I(exp_neg)(x)
#define DO_exp_both(I, P) y = I(exp_both)(x, &z)
#define DO_power(I, P) y = I(pow_unit)(x, a, 0.0, 0, &z)
#define DO_power_plus_1(I, P) y = I(pow_unit)(x, a, 1.0, 0, &z)
#define DO_root(I, P) y = I(pow_unit)(x, a, 1.0, 1, &z)
#define DO_tail(I, P) y = I(normal_tail)(x)
#define DO_quantile(I, P) y = I(normal_quantile)(x)
MAP(sincos)
MAP(behind)
MAP(atan_y)
MAP(atan_x)
MAP(log)
MAP(log1p)
MAP(exp_neg)
MAP(exp_both)
MAP(power)
MAP(power_plus_1)
MAP(root)
MAP(tail)
MAP(quantile)

/* The maps of a row, from u to a coordinate and its density: a line's x, else the first coordinate at u2 = 0, which is
 * the radius or sin(theta) at azimuth 0. And the way back of a line: from x to u and the density. */
static const mcst_row *row; /* under test: its oracle is the truth */

static void fill_lanes(int lanes, float *p) {
    int k;
    memset(p, 0, (size_t)(MCST_P * lanes) * sizeof *p);
    for (k = 0; k < lanes; k++) p[k] = arg[0], p[lanes + k] = arg[1], p[5 * lanes + k] = 1;
}
static void draw_lanes(int form, int lanes, const float *in, float *y_out, float *z_out) {
    const float u2[16] = {0};
    float p[MCST_P * 16], out[5 * 16];
    int i;
    fill_lanes(lanes, p);
    for (i = 0; i < BLOCK; i += lanes) {
        row->fn[form].sample(p, in + i, u2, out);
        memcpy(y_out + i, out, (size_t)lanes * sizeof *out);
        memcpy(z_out + i, out + 3 * lanes, (size_t)lanes * sizeof *out);
    }
}
static void back_lanes(int form, int lanes, const float *in, float *y_out, float *z_out) {
    float p[MCST_P * 16];
    int i;
    fill_lanes(lanes, p);
    for (i = 0; i < BLOCK; i += lanes) {
        row->fn[form].invert(p, in + i, y_out + i);
        row->fn[form].pdf(p, in + i, z_out + i);
    }
}
#define AT_LANES(form, lanes)                                               \
    static void draw_##lanes(const float *in, float *y_out, float *z_out) { \
        draw_lanes(form, lanes, in, y_out, z_out);                          \
    }                                                                       \
    static void back_##lanes(const float *in, float *y_out, float *z_out) { back_lanes(form, lanes, in, y_out, z_out); }
AT_LANES(0, 1)
#ifdef MCST_WIDE
AT_LANES(1, 4)
AT_LANES(2, 8)
AT_LANES(3, 16)
static block_fn *const row_at[WIDTHS] = {draw_1, draw_4, draw_8, draw_16};
static block_fn *const row_back_at[WIDTHS] = {back_1, back_4, back_8, back_16};
#else
static block_fn *const row_at[WIDTHS] = {draw_1, NULL, NULL, NULL};
static block_fn *const row_back_at[WIDTHS] = {back_1, NULL, NULL, NULL};
#endif

/* --- the truth -------------------------------------------------------------------------------------------------------
 * Near 0, where most floats are, two or three terms of the series: what is left out is below 2^-52. */

typedef void exact_fn(const float *in, int n, double want[2][BLOCK]);

#define EXACT(map)                                                       \
    static void map##_n(const float *in, int n, double want[2][BLOCK]) { \
        int i;                                                           \
        for (i = 0; i < n; i++) {                                        \
            double w[2] = {0, 0};                                        \
            exact_##map((double)in[i], w);                               \
            want[0][i] = w[0], want[1][i] = w[1];                        \
        }                                                                \
    }

#define TWO_PI 6.283185307179586476925
#define SMALL 0x1p-18

static void exact_sincos(double t, double want[2]) {
    const int k = (int)floor(4 * t + 0.5);
    const double r = TWO_PI * (t - 0.25 * k);
    double s, c;
    if (fabs(r) < SMALL) s = r * (1 - r * r / 6), c = 1 - 0.5 * r * r;
    else s = sin(r), c = cos(r);
    want[0] = k == 0 || k == 4 ? s : k == 1 ? c : k == 2 ? -s : -c;
    want[1] = k == 0 || k == 4 ? c : k == 1 ? -s : k == 2 ? -c : s;
}
static void exact_behind(double t, double want[2]) { /* 1 + cos(2 pi t) = 2 cos^2(pi t) = 2 sin^2(pi (t - 1/2)) */
    const double s = sin(0.5 * TWO_PI * (t - 0.5));
    want[0] = 2 * s * s;
    want[1] = -cos(TWO_PI * (t - 0.5));
}
static double atan_in_turns(double y) {
    return (fabs(y) < SMALL       ? y * (1 - y * y / 3)
            : fabs(y) > 1 / SMALL ? copysign(0.25 * TWO_PI, y) - 1 / y
                                  : atan(y)) /
           TWO_PI;
}
static void exact_atan_y(double y, double want[2]) {
    want[0] = want[1] = y < 0 ? 1 + atan_in_turns(y) : atan_in_turns(y);
}
static void exact_atan_x(double x, double want[2]) {
    const double t = atan_in_turns(x);
    want[0] = 0.25 - t, want[1] = 0.75 + t;
}
static void exact_log(double x, double want[2]) { want[0] = log(x); }
static void exact_log1p(double x, double want[2]) {
    want[0] = fabs(x) < SMALL ? x * (1 - x * (0.5 - x / 3)) : x > 0x1p60 ? log(x) : log1p(x);
}
/* Where e^x is 0: the power of two next to it is 2^-126 or less, as the float product with 1/ln 2 has it. */
static int vanishes(double x) { return x < -110 || rintf((float)x * 1.44269504f) <= -126; }
static void exact_exp_neg(double x, double want[2]) {
    want[0] = !(x < 0) ? (isnan(x) ? 0 : 1) : x > -SMALL ? 1 + x * (1 + x * (0.5 + x / 6)) : vanishes(x) ? 0 : exp(x);
}
static void exact_exp_both(double x, double want[2]) {
    if (x > -SMALL) want[1] = x * (1 + x * (0.5 + x / 6)), want[0] = 1 + want[1];
    else want[0] = exp(x), want[1] = expm1(x);
}
/* *over, the second result, is x over the first. */
static void exact_power_of(double x, double n, double want[2]) {
    want[0] = x > 0 ? (n * log2(x) < -125.5 ? 0 : pow(x, n)) : n == 0;
    want[1] = x / want[0];
}
static void exact_power(double x, double want[2]) { exact_power_of(x, (double)arg[0], want); }
static void exact_power_plus_1(double x, double want[2]) { exact_power_of(x, (double)arg[0] + 1, want); }
static void exact_root(double x, double want[2]) {
    const double n = (double)arg[0] + 1;
    want[0] = n == 1 ? x : n == 2 ? sqrt(x) : n == 3 ? cbrt(x) : pow(x, 1 / n);
    want[1] = x / want[0];
}
static void exact_tail(double y, double want[2]) {
    want[0] = y < SMALL                ? 0.5 - y * (1 - y * y / 6) * 0.39894228040143267794
              : vanishes(-0.5 * y * y) ? 0
                                       : 0.5 * erfc(y * 0.70710678118654752440);
}
/* Halley's iteration, started where the last one ended: the numbers come in order. On erf about the median, on erfc in
 * the tails.
 */
static double quantile(double p) {
    static double z;
    const double q = p - 0.5, tail = p < 0.5 ? p : 1 - p, side = p < 0.5 ? -1 : 1;
    const int middle = fabs(q) < 0.25;
    double step;
    int i = 0;
    if (q == 0) return 0;
    if (!middle && !(side * z > 0.6)) z = side;
    if (middle && !(fabs(z) < 0.7)) z = 0;
    do {
        const double f = middle ? 0.5 * erf(z * 0.70710678118654752440) - q
                                : side * (tail - 0.5 * erfc(side * z * 0.70710678118654752440));
        const double r = f * 2.50662827463100050242 * exp(0.5 * z * z);
        step = r / (1 + 0.5 * z * r);
        z -= step;
    } while (fabs(step) > 1e-5 * fabs(z) && ++i < 100);
    return z;
}
static void exact_quantile(double p, double want[2]) { want[0] = quantile(p); }
static void exact_normal(double u, double want[2]) {
    const double z = quantile(fmax(u, 0x1p-25));
    want[0] = (double)arg[0] + (double)arg[1] * z;
    want[1] = 0.39894228040143267794 * exp(-0.5 * z * z) / (double)arg[1];
}

static void exact_exponential(double u, double want[2]) {
    want[0] = (u < SMALL ? u * (1 + u * (0.5 + u / 3)) : -log1p(-u)) / (double)arg[0];
    want[1] = (double)arg[0] * (1 - u);
}
static void exact_logistic(double u, double want[2]) {
    const double v = fmax(u, 0x1p-25);
    want[0] = (double)arg[0] + (double)arg[1] * (u > 0.25 ? log1p((2 * u - 1) / (1 - u)) : log(v / (1 - v)));
    want[1] = v * (1 - v) / (double)arg[1];
}
static void exact_row(double u, double want[2]) {
    const float p[MCST_P] = {arg[0], arg[1], 0, 0, 0, 1};
    ld x[3];
    row->truth.map(p, (ld)u, 0, x);
    want[0] = (double)x[0];
    want[1] = (double)row->truth.pdf_u(p, (ld)u, 0);
}

/* The y of an integral by Newton's method, from that of an integral nearby. The bell falls by at most c + y of itself,
 * so that a step leaves (c + y) step^2 / 2 of error. A start beyond the root may lead below 0, and from 0 on the method
 * does not pass the root. */
static ld next_point(const o_bell *of, ld c, ld mass, ld y) {
    if (mass == 0) return 0;
    for (int i = 0; i < 100; i++) {
        const ld step = (mass - of->mass(c, y)) / of->bell(c, y);
        y = fmaxl(y + step, 0);
        if ((1 + c + y) * step * step <= 1e-13L * y) break;
    }
    return y;
}
/* The truth of a bell between two ends, of which oracle.h finds each point anew, over u that come in order. */
static void exact_cut(double u, double want[2]) {
    static o_cut k;
    static ld y;
    static struct {
        const mcst_row *row;
        float a, b;
    } of;
    const o_bell *bell = !strcmp(row->name, "truncnormal") ? &o_normal_of : &o_logistic_of;
    if (of.row != row || of.a != arg[0] || of.b != arg[1]) {
        of.row = row;
        of.a = arg[0];
        of.b = arg[1];
        k = o_cut_make(bell, (ld)arg[0], (ld)arg[1]);
        y = 0;
    }
    const ld mass = o_cut_mass(&k, (ld)u);
    if (bell == &o_normal_of) y = next_point(bell, k.c, fabsl(mass), y);
    else {
        const ld beyond = fabsl(mass) * (1 + expl(-k.c));
        y = log1pl(beyond * expl(-k.c)) - log1pl(-beyond);
    }
    want[0] = (double)copysignl(k.c + y, mass);
    want[1] = (double)(bell->bell(k.c, y) / (k.left + k.right));
}

/* The same for any float as u: bad input gives 0, density 0. */
static void exact_any_row(double u, double want[2]) {
    if (u >= 0 && u < 1) exact_row(u, want);
}
static void exact_any_cut(double u, double want[2]) {
    if (u >= 0 && u < 1) exact_cut(u, want);
}
static void exact_any_normal(double u, double want[2]) {
    if (u >= 0 && u < 1) exact_normal(u, want);
}
EXACT(sincos)
EXACT(behind)
EXACT(atan_y)
EXACT(atan_x)
EXACT(log)
EXACT(log1p)
EXACT(exp_neg)
EXACT(exp_both)
EXACT(power)
EXACT(power_plus_1)
EXACT(root)
EXACT(tail)
EXACT(quantile)
EXACT(normal)
EXACT(exponential)
EXACT(logistic)
EXACT(row)
EXACT(any_row)
EXACT(any_normal)
EXACT(cut)
EXACT(any_cut)

/* --- sweeps ----------------------------------------------------------------------------------------------------------
 */

/* ULP: of the exact value, or of `scale` where that is larger. RELATIVE: 1e-7 of the value, and a subnormal's spacing.
 * DENSITY: E = 1e-6 (1 + |ln(value/scale)|) of it, scale being the peak; a density is the peak times a float, so digits
 * below FLT_MIN times the peak are gone. NONE: no truth, only range, order and bits. */
enum unit { ULP, RELATIVE, DENSITY, NONE };
static const char *const unit_name[] = {"ulp", "e-7", "E", "-"};

typedef struct {
    const char *name;
    enum unit unit;
    double limit, scale;
    int rises; /* 1, -1; 0: not looked at */
    double lo, hi;
    int nan_gives_0;
} result;

typedef struct {
    enum { FLOATS, GRID, EVERYTHING } of; /* floats; the numbers k 2^-24; all 2^32 floats, NaN too, but -0 */
    float lo, hi;
    float seam[SEAMS];
    int seams;
    int64_t stride; /* at full scale */
} range;

typedef struct {
    double worst, at, back, back_at; /* back: largest step against the direction, in ulp */
    long long backs, outside, bits;
    double outside_at, bits_at;
} found;

/* Floats in order of their value: -0 and 0 share a place, NaN is beyond the infinities. */
static int64_t place(float x) {
    int32_t i;
    memcpy(&i, &x, sizeof i);
    return i < 0 ? -(int64_t)(i & 0x7fffffff) : (int64_t)i;
}
static float number(const range *r, int64_t at) {
    const uint32_t bits = at < 0 ? 0x80000000u | (uint32_t)-at : (uint32_t)at;
    float x;
    if (r->of == GRID) return (float)at * 0x1p-24f;
    memcpy(&x, &bits, sizeof x);
    return x;
}
static int64_t index_of(const range *r, float x) {
    if (r->of == EVERYTHING && isinf(x)) return x < 0 ? -0x7fffffff : 0x7fffffff;
    return r->of == GRID ? (int64_t)((double)x * 0x1p24) : place(x);
}

/* The spacing of floats at |x|, 2^-149 at the least. */
static double spacing(double x) {
    uint64_t bits;
    double s;
    memcpy(&bits, &x, sizeof bits);
    bits = bits >> 52 & 0x7ff;
    if (bits < 1023 - 126) bits = 1023 - 126;
    bits = (bits - 23) << 52;
    memcpy(&s, &bits, sizeof s);
    return s;
}

/* The worst error of a block, in the unit of the result. A NaN is no error: it is out of range. */
static double worst_of(const result *r, const float *got, const double *want, int n, int *at) {
    static double error[BLOCK];
    const double least = fmax(r->scale, 0x1p-126);
    double worst = 0;
    int k;
    switch (r->unit) {
    case ULP:
        for (k = 0; k < n; k++) {
            double size = fabs(want[k]), per_ulp;
            uint64_t bits;
            size = size > least ? size : least;
            memcpy(&bits, &size, sizeof bits);
            bits = ((uint64_t)(2 * 1023 + 23) << 52) -
                   (bits & (uint64_t)0x7ff << 52); /* 1 over the spacing of floats there */
            memcpy(&per_ulp, &bits, sizeof bits);
            error[k] = fabs((double)got[k] - want[k]) * per_ulp;
        }
        break;
    case RELATIVE:
        for (k = 0; k < n; k++) error[k] = fabs((double)got[k] - want[k]) / (1e-7 * fabs(want[k]) + 0x1p-149);
        break;
    case DENSITY:
        for (k = 0; k < n; k++) {
            const double size = fmin(want[k], (double)FLT_MAX), e = size > 0 ? 1 + fabs(log(size / r->scale)) : 1;
            error[k] = fabs((double)got[k] - size) / (1e-6 * e * size + 0x1p-126 * r->scale + 0x1p-149);
        }
        break;
    default: return 0;
    }
    for (k = 0; k < n; k++)
        if (error[k] > worst) worst = error[k], *at = k;
    return worst;
}

/* The least prime from `at_full_scale` over the scale on, or 1. */
static int64_t stride(int64_t at_full_scale) {
    const int64_t least = (int64_t)ceil((double)at_full_scale / fmin(1, mcst_scale()) - 1e-9);
    int64_t k = least, d;
    if (k < 2) return 1;
    for (;; k++) {
        for (d = 2; d * d <= k && k % d; d++) {}
        if (d * d > k) return k;
    }
}

/* One line on stderr every ten seconds. */
static void progress(const char *name, double share) {
    static time_t last;
    const time_t now = time(NULL);
    if (!last) last = now;
    if (now - last < 10) return;
    last = now;
    fprintf(stderr, "    %s: %.0f %%\n", name, 100 * share);
}

static void sweep_piece(const range *r, block_fn *const at[WIDTHS], exact_fn *exact, const result *results,
                        int64_t from, int64_t to, int64_t step, found *f, long long *count) {
    static float in[BLOCK], got[2][BLOCK + 1], other[2][BLOCK]; /* got[o][0] is the last result of the block before */
    static double want[2][BLOCK];
    int64_t i = from;
    int first = 1, done = 0, n, k, w, o;
    while (!done) {
        for (n = 0; n < BLOCK && !done; n++) {
            in[n] = number(r, i);
            done = i >= to;
            i = to - i < step ? to : i + step;
        }
        for (k = n; k < BLOCK; k++) in[k] = in[n - 1];
        for (o = 0; o < 2; o++) got[o][0] = got[o][BLOCK];
        at[0](in, &got[0][1], &got[1][1]);
        for (w = 1; w < WIDTHS && at[w]; w++) {
            at[w](in, other[0], other[1]);
            for (o = 0; o < 2; o++) {
                if (!memcmp(&got[o][1], other[o], sizeof other[o])) continue;
                for (k = 0; k < n; k++)
                    if (memcmp(&got[o][k + 1], &other[o][k], sizeof(float)) && !f[o].bits++)
                        f[o].bits_at = (double)in[k];
            }
        }
        if (exact) exact(in, n, want);
        for (o = 0; o < 2 && results[o].name; o++) {
            const result *res = &results[o];
            const float *y = &got[o][1], lo = (float)res->lo, hi = (float)res->hi, sign = (float)res->rises;
            const int nan = isnan(in[0]) || isnan(in[n - 1]);
            int outside = 0, backs = 0;
            if (exact) {
                const double e = worst_of(res, y, want[o], n, &k);
                if (e > f[o].worst) f[o].worst = e, f[o].at = (double)in[k];
            }
            for (k = 0; k < n; k++) outside += !(y[k] >= lo && y[k] <= hi), backs += sign * y[k] < sign * y[k - 1];
            if (outside || nan)
                for (k = 0; k < n; k++)
                    if (!(y[k] >= lo && y[k] <= (res->nan_gives_0 && isnan(in[k]) ? 0 : hi)) && !f[o].outside++)
                        f[o].outside_at = (double)in[k];
            for (k = first; k < n && backs; k++) {
                const double size = fmax(fabs((double)y[k]), res->unit == ULP ? res->scale : 0);
                const double back = (double)(sign * y[k - 1] - sign * y[k]) / spacing(size);
                if (!(back > 0) || (nan && (isnan(in[k]) || k == 0 || isnan(in[k - 1])))) continue;
                f[o].backs++;
                if (back > f[o].back) f[o].back = back, f[o].back_at = (double)in[k];
            }
        }
        first = 0;
        *count += n;
        progress(mcst.name, (double)(i - from) / (double)(to - from + 1));
    }
}

/* Sweeps the range and the neighbourhoods of its seams, prints a line for each result and judges it. */
static void sweep(const range *r, block_fn *const at[WIDTHS], exact_fn *exact, const result *results) {
    const int64_t from = index_of(r, r->lo), to = index_of(r, r->hi), step = stride(r->stride);
    const clock_t began = clock();
    long long count = 0;
    found f[2];
    int i, o;
    memset(f, 0, sizeof f);
    sweep_piece(r, at, exact, results, from, to, step, f, &count);
    for (i = -2; i < r->seams && step > 1; i++) {
        const int64_t seam = i == -2 ? from : i == -1 ? to : index_of(r, r->seam[i]);
        const int64_t a = seam - AROUND > from ? seam - AROUND : from, b = seam + AROUND < to ? seam + AROUND : to;
        if (a <= b) sweep_piece(r, at, exact, results, a, b, 1, f, &count);
    }
    for (o = 0; o < 2 && results[o].name; o++) {
        const result *res = &results[o];
        char error[64] = "", back[64] = "";
        if (res->unit != NONE)
            snprintf(error, sizeof error, "%7.3f %-3s (limit %g) at %.9g", f[o].worst, unit_name[res->unit], res->limit,
                     f[o].at);
        if (res->rises) snprintf(back, sizeof back, "%lld back, %.2g ulp", f[o].backs, f[o].back);
        printf("  %-30s %-10s [%.8g, %.8g] %11lld  %-46s %-26s %6.1f s\n", o ? "" : mcst.name, res->name, (double)r->lo,
               (double)r->hi, count, error, back, (double)(clock() - began) / CLOCKS_PER_SEC);
        CHECK(res->unit == NONE || f[o].worst <= res->limit, "%s: %.3f %s at %.9g (%a), limit %g", res->name,
              f[o].worst, unit_name[res->unit], f[o].at, f[o].at, res->limit);
        /* Two errors of opposite signs turn a map back by twice the limit at most. */
        CHECK(!res->rises || res->unit != ULP || f[o].back <= 2 * res->limit, "%s turns back by %.3g ulp at %.9g (%a)",
              res->name, f[o].back, f[o].back_at, f[o].back_at);
        CHECK(f[o].outside == 0, "%s: %lld outside [%g, %g], first at %.9g (%a)", res->name, f[o].outside, res->lo,
              res->hi, f[o].outside_at, f[o].outside_at);
        if (!mcst_contracts())
            CHECK(f[o].bits == 0, "%s: %lld results have other bits at another width, first at %.9g (%a)", res->name,
                  f[o].bits, f[o].bits_at, f[o].bits_at);
    }
    fflush(stdout);
}

/* --- the tables --------------------------------------------------------------------------------------------------- */

#define BELOW_1 0.99999994f
#define SIN_COS(lo, hi, up, down)                                                      \
    {                                                                                  \
        "sin, cos", sincos_at, sincos_n, 0, {FLOATS, lo, hi, {0}, 0, 1}, {             \
            {"sin", ULP, 1.4, 0, up, -1, 1, 0}, { "cos", ULP, 1.4, 0, down, -1, 1, 0 } \
        }                                                                              \
    }

/* The header gives no number for 1 + cos = z (c0 + z c1 + ...): z, the product of the small second term, its sum with
 * c0 and the last product are 3.1 roundings of 2^-24 relative, and 2^-24 relative is at most 1 ulp; the fit is below
 * 0.1. atan2: 2^-23 of a turn is an ulp of 1. */
static const struct kernel {
    const char *name;
    block_fn *const *at;
    exact_fn *exact;
    float parameter;
    range over;
    result of[2];
} kernels[] = {
    /* between the turning points */
    SIN_COS(-0.125f, 0.0f, 1, 1),
    SIN_COS(0.0f, 0.25f, 1, -1),
    SIN_COS(0.25f, 0.5f, -1, -1),
    SIN_COS(0.5f, 0.75f, -1, 1),
    SIN_COS(0.75f, 1.0f, 1, 1),
    {"1 + cos",
     behind_at,
     behind_n,
     0,
     {FLOATS, 0.375f, 0.62499994f, {0.5f}, 1, 1},
     {{"1 + cos", ULP, 3.2, 0, 0, 0, 0.3, 0}}},
    {"atan2(y, 1), y to 1",
     atan_y_at,
     atan_y_n,
     0,
     {FLOATS, 0, 1, {0}, 0, 1},
     {{"turns", ULP, 1, 1, 1, 0, 0.125, 0}, {"turns", RELATIVE, 1.5, 0, 0, 0, 0.125, 0}}},
    {"atan2(y, 1), y beyond 1",
     atan_y_at,
     atan_y_n,
     0,
     {FLOATS, 1, FLT_MAX, {0}, 0, 1},
     {{"turns", ULP, 1, 1, 1, 0.125, 0.25, 0}}},
    {"atan2(y, 1), y below -1",
     atan_y_at,
     atan_y_n,
     0,
     {FLOATS, -FLT_MAX, -1, {0}, 0, 1},
     {{"turns", ULP, 1, 1, 1, 0.75, 1 - 0x1p-24, 0}}},
    {"atan2(y, 1), y from -1 to 0",
     atan_y_at,
     atan_y_n,
     0,
     {FLOATS, -1, -0x1p-149f, {0}, 0, 1},
     {{"turns", ULP, 1, 1, 1, 0.75, 1 - 0x1p-24, 0}}},
    {"atan2 of 1 and of -1, any x below -1",
     atan_x_at,
     atan_x_n,
     0,
     {FLOATS, -FLT_MAX, -1, {0}, 0, 1},
     {{"y = 1", ULP, 1, 1, -1, 0.25, 0.5, 0}, {"y = -1", ULP, 1, 1, 1, 0.5, 0.75, 0}}},
    {"atan2 of 1 and of -1, any x from -1 to 0",
     atan_x_at,
     atan_x_n,
     0,
     {FLOATS, -1, 0, {0}, 0, 1},
     {{"y = 1", ULP, 1, 1, -1, 0.25, 0.5, 0}, {"y = -1", ULP, 1, 1, 1, 0.5, 0.75, 0}}},
    {"ln x",
     log_at,
     log_n,
     0,
     {FLOATS, FLT_MIN, FLT_MAX, {0.70710678f, 1, 1.41421354f}, 3, 1},
     {{"ln", ULP, 1, 0, 1, -88, 89, 0}}},
    {"ln of 1 + x",
     log1p_at,
     log1p_n,
     0,
     {FLOATS, -BELOW_1, 1e38f, {-0.29289321f, 0, 0.41421357f}, 3, 1},
     {{"ln", ULP, 1.5, 0, 1, -17, 88, 0}}},
    {"e^min(x, 0), NaN too",
     exp_neg_at,
     exp_neg_n,
     0,
     {EVERYTHING, -INFINITY, INFINITY, {-87.5f, -86.98961f, 0}, 3, 1},
     {{"exp", ULP, 1, 0, 1, 0, 1, 0}}},
    {"e^x, e^x - 1",
     exp_both_at,
     exp_both_n,
     0,
     {FLOATS, -80, 0, {-0.34657359f}, 1, 1},
     {{"exp", ULP, 1, 0, 1, 0, 1, 0}, {"exp - 1", ULP, 1, 0, 1, -1, 0, 0}}},
    {"x^0.5", power_at, power_n, 0.5f, {FLOATS, 0, 1, {FLT_MIN}, 1, 11}, {{"power", ULP, 1, 0, 1, 0, 1, 0}}},
    {"x^3", power_at, power_n, 3, {FLOATS, 0, 1, {0}, 0, 1}, {{"power", ULP, 1, 0, 1, 0, 1, 0}}},
    {"x^37.5", power_at, power_n, 37.5f, {FLOATS, 0, 1, {0}, 0, 11}, {{"power", ULP, 1, 0, 1, 0, 1, 0}}},
    {"x^1e9", power_at, power_n, 1e9f, {FLOATS, 0.9999f, 1, {0}, 0, 1}, {{"power", ULP, 1, 0, 1, 0, 1, 0}}},
    {"x^(2.5 + 1)",
     power_plus_1_at,
     power_plus_1_n,
     2.5f,
     {FLOATS, 0, 1, {0}, 0, 11},
     {{"power", ULP, 1, 0, 1, 0, 1, 0}}},
    {"x^(1e9 + 1)",
     power_plus_1_at,
     power_plus_1_n,
     1e9f,
     {FLOATS, 0.9999f, 1, {0}, 0, 1},
     {{"power", ULP, 1, 0, 1, 0, 1, 0}}},
    {"x^(1 / (0 + 1))", root_at, root_n, 0, {FLOATS, 0, 1, {FLT_MIN}, 1, 11}, {{"root", ULP, 1, 0, 1, 0, 1, 0}}},
    {"x^(1 / (2 + 1))", root_at, root_n, 2, {FLOATS, 0, 1, {FLT_MIN}, 1, 1}, {{"root", ULP, 1, 0, 1, 0, 1, 0}}},
    {"x^(1 / (1e9 + 1))", root_at, root_n, 1e9f, {FLOATS, 0, 1, {FLT_MIN}, 1, 11}, {{"root", ULP, 1, 0, 1, 0, 1, 0}}},
    {"normal tail",
     tail_at,
     tail_n,
     0,
     {FLOATS, 0, INFINITY, {1, 13.19f, 14.5f}, 3, 1},
     {{"Phi(-y)", ULP, 8, 0, -1, 0, 0.5, 0}}},
    {"normal quantile",
     quantile_at,
     quantile_n,
     0,
     {FLOATS, FLT_MIN, BELOW_1, {0.125f, 0.5f, 0.875f}, 3, 1},
     {{"quantile", ULP, 6, 0, 1, -13, 5.5, 0}}},
};

/* Limits of a line's x in ulp and of its density in E, as the header states them. */
static double x_limit_of(const mcst_row *of) { return of->traits & MCST_QUANTILE ? 7 : 4; }
/* The normal distribution: 0.38 E for deviations that are powers of 2; the quotient of others rounds once more, 2^-24
 * of 1.7 E where that is worst. */
static double pdf_limit_of(const mcst_row *of) { return of->claims[0].claim[CLAIM_PDF_U]; }

/* sin(theta) of a lobe within 1e-6 of itself, of the others every coordinate within 2^-23 of the radius. */
static const struct radius {
    const char *name;
    float a, b;
    enum unit unit;
    double limit, scale, pdf_limit;
} radii[] = {
    {"disk", 1, 0, ULP, 1, 1, 0.1},
    {"disk", 1e-18f, 0, RELATIVE, 10, 0, 0.1},
    {"sphere", 0, 0, ULP, 1, 1, 0.15},
    {"hemisphere", 0, 0, ULP, 1, 1, 0.15},
    {"cosine", 0, 0, ULP, 1, 1, 0.15},
    {"cone", 0.5f, 0, ULP, 1, 1, 0.15},
    {"cone", 1.9997f, 0, ULP, 1, 1, 0.15},
    {"cone", 1e-20f, 0, RELATIVE, 10, 0, 0.15},
    {"henyey_greenstein", 0.5f, 0, ULP, 1, 1, 0.2},
    {"henyey_greenstein", 0.9999f, 0, RELATIVE, 10, 0, 0.2},
    {"henyey_greenstein", -0.9f, 0, ULP, 1, 1, 0.2},
    {"rayleigh", 0, 0, ULP, 1, 1, 0.2},
    {"von_mises_fisher", 0, 0, ULP, 1, 1, 0.2},
    {"von_mises_fisher", 1, 0, ULP, 1, 1, 0.2},
    {"von_mises_fisher", 1e8f, 0, RELATIVE, 10, 0, 0.2},
    {"phong_lobe", 0, 0, RELATIVE, 10, 0, 0.7},
    {"phong_lobe", 1e-3f, 0, RELATIVE, 10, 0, 2.6},
    {"phong_lobe", 10, 0, RELATIVE, 10, 0, 0.4},
    {"phong_lobe", 1e9f, 0, RELATIVE, 10, 0, 0.4},
    {"ward_h", 0.5f, 0.5f, RELATIVE, 10, 0, 0.7},
    {"ward_h", 1e-6f, 1e-6f, RELATIVE, 10, 0, 0.7},
    {"ward_h", 10, 0.1f, RELATIVE, 10, 0, 0.7},
    {"ggx_h", 0.5f, 0.5f, RELATIVE, 10, 0, 0.7},
    {"ggx_h", 1e-6f, 1e-6f, RELATIVE, 10, 0, 0.7},
    {"ggx_h", 10, 0.1f, RELATIVE, 10, 0, 0.7},
    {"ashikhmin_h", 1e-3f, 1e-3f, RELATIVE, 10, 0, 2.6},
    {"ashikhmin_h", 10, 10, RELATIVE, 10, 0, 0.3},
    {"ashikhmin_h", 100, 10, RELATIVE, 10, 0, 0.3},
    {"ashikhmin_h", 1e9f, 1e9f, RELATIVE, 10, 0, 0.3},
};

static double peak_of(exact_fn *exact) {
    static float u[BLOCK];
    static double want[2][BLOCK];
    double peak = 0;
    int i;
    for (i = 0; i < BLOCK; i++) u[i] = i < BLOCK - 1 ? (float)i / BLOCK : BELOW_1;
    exact(u, BLOCK, want);
    for (i = 0; i < BLOCK; i++) peak = fmax(peak, want[1][i]);
    return peak;
}

static void set_result(result *r, const char *name, enum unit unit, double limit, double scale, int rises, double lo,
                       double hi) {
    r->name = name, r->unit = unit, r->limit = limit, r->scale = scale, r->rises = rises, r->lo = lo, r->hi = hi;
    r->nan_gives_0 = 0;
}

/* The support; unbounded densities reach as far as u = 2^-25 does. */
static void support(const mcst_row *of, double *lo, double *hi) {
    const double a = (double)arg[0], b = (double)arg[1], noise = 0x1p-23 * fabs(a);
    *lo = 0, *hi = 1;
    switch (of->coord) {
    case MCST_TENT: *lo = -a, *hi = a; break;
    case MCST_HALFLINE: *hi = 17 / a; break;
    case MCST_TRUNCATED: *hi = b; break;
    case MCST_WHOLELINE: {
        const float p[MCST_P] = {arg[0], arg[1], 0, 0, 0, 1};
        ld x[3];
        of->truth.map(p, 0x1p-25L, 0, x);
        const double far = (a - (double)x[0]) * (1 + 0x1p-20) + noise;
        *lo = a - far, *hi = a + far;
        break;
    }
    case MCST_EVENPOWER: *lo = -1; break;
    case MCST_BETWEEN:
    case MCST_CUT: *lo = a, *hi = b; break;
    default: break;
    }
}

static double scale_of(const mcst_row *of) { return mcst_line_scale(of, arg); }

static const range grid = {GRID, 0, BELOW_1, {0.25f, 0.5f, 0.75f}, 3, 1};

/* Over all u a line with the parameters of its grid. */
static void sweep_line(void) {
    exact_fn *exact = row->traits & MCST_QUANTILE ? normal_n : row->coord == MCST_CUT ? cut_n : row_n;
    result of[2];
    double lo, hi;
    size_t j;
    for (j = 0; j < row->grid_size; j++) {
        arg[0] = row->grid[j][0], arg[1] = row->grid[j][1];
        if (!mcst_case("%s %g %g", row->name, (double)arg[0], (double)arg[1])) continue;
        support(row, &lo, &hi);
        set_result(&of[0], "x", ULP, x_limit_of(row), scale_of(row), 1, lo, hi);
        set_result(&of[1], "pdf", DENSITY, pdf_limit_of(row), peak_of(exact), 0, 0, (double)FLT_MAX);
        sweep(&grid, row_at, exact, of);
    }
}

/* Over all u the radius of one of a plane, a direction or a half-vector. */
static void sweep_radius(const struct radius *r) {
    const int past_equator =
        (row->traits & MCST_WHOLE) && !(row->coord == MCST_CONE && r->a <= 1); /* sin falls again */
    result of[2];
    arg[0] = r->a, arg[1] = r->b;
    if (!mcst_case("%s %g %g", row->name, (double)arg[0], (double)arg[1])) return;
    set_result(&of[0], "x", r->unit, r->limit, r->scale, !past_equator, 0, row->coord == MCST_DISK ? (double)r->a : 1);
    set_result(&of[1], "pdf", DENSITY, r->pdf_limit, peak_of(row_n), 0, 0, (double)FLT_MAX);
    sweep(&grid, row_at, row_n, of);
}

/* The settings of the table above; a row that is not in it is held to what it claims. */
static void sweep_radii(void) {
    const struct radius other = {row->name, row->grid[0][0], row->grid[0][1], RELATIVE, 10, 0, pdf_limit_of(row)};
    int found_one = 0;
    size_t i;
    for (i = 0; i < MCST_COUNT(radii); i++)
        if (!strcmp(radii[i].name, row->name)) found_one = 1, sweep_radius(&radii[i]);
    if (!found_one) sweep_radius(&other);
}

/* All floats of [0,1) as u of a map. */
static void sweep_unit(const char *name, exact_fn *exact) {
    const range unit = {FLOATS, 0, BELOW_1, {0.25f, 0.5f, 0.75f}, 3, 1};
    result of[2];
    double lo, hi;
    row = mcst_find(name);
    if (!mcst_case("u of %s in [0,1)", row->name)) return;
    arg[0] = row->grid[0][0], arg[1] = row->grid[0][1];
    support(row, &lo, &hi);
    set_result(&of[0], "x", ULP, x_limit_of(row), scale_of(row), 1, lo, hi);
    set_result(&of[1], "pdf", DENSITY, pdf_limit_of(row), peak_of(exact), 0, 0, (double)FLT_MAX);
    sweep(&unit, row_at, exact, of);
}

/* Any float as u of a line, and as its x: then to u and the density. */
static void sweep_any(void) {
    const range as_u = {EVERYTHING, -INFINITY, INFINITY, {-1, 0, 0.5f, 1}, 4, 101};
    const range as_x = {EVERYTHING, -INFINITY, INFINITY, {-1, 0, 0.5f, 1}, 4, 11};
    exact_fn *exact = row->traits & MCST_QUANTILE ? any_normal_n : row->coord == MCST_CUT ? any_cut_n : any_row_n;
    result of[2];
    double lo, hi;
    arg[0] = row->grid[0][0], arg[1] = row->grid[0][1];
    if (mcst_case("u of %s", row->name)) {
        support(row, &lo, &hi);
        set_result(&of[0], "x", ULP, x_limit_of(row), scale_of(row), 0, fmin(lo, 0), hi);
        set_result(&of[1], "pdf", DENSITY, pdf_limit_of(row), peak_of(exact), 0, 0, (double)FLT_MAX);
        sweep(&as_u, row_at, exact, of);
    }
    if (mcst_case("x of %s", row->name)) {
        set_result(&of[0], "u", NONE, 0, 0, 1, 0, 1 - 0x1p-24);
        set_result(&of[1], "pdf", NONE, 0, 0, 0, 0, (double)FLT_MAX);
        of[1].nan_gives_0 = 1;
        sweep(&as_x, row_back_at, NULL, of);
    }
}

static int is_line(const mcst_row *of) { return of->shape == MCST_IS_LINE; }
/* What has a radius about +z that grows with one random number: half-vectors without a direction to the eye, but no
 * directions to a light. */
static int is_radial(const mcst_row *of) {
    return !is_line(of) && !of->has_wo && !(of->traits & (MCST_SQUARE | MCST_DISTANCE));
}

int main(int argc, char **argv) {
    size_t i;
    mcst_start(argc, argv);
    mcst_group("vector maths");
    for (i = 0; i < MCST_COUNT(kernels); i++) {
        const struct kernel *k = &kernels[i];
        if (!mcst_case("%s", k->name)) continue;
        arg[0] = k->parameter;
        sweep(&k->over, k->at, k->exact, k->of);
    }
    mcst_group("u to x");
    for (row = mcst_rows; row < mcst_rows + MCST_NROWS; row++)
        if (is_line(row)) sweep_line();
    mcst_group("u to radius");
    for (row = mcst_rows; row < mcst_rows + MCST_NROWS; row++)
        if (is_radial(row)) sweep_radii();
    mcst_group("any float");
    sweep_unit("exponential", exponential_n);
    sweep_unit("logistic", logistic_n);
    for (row = mcst_rows; row < mcst_rows + MCST_NROWS; row++)
        if (is_line(row)) sweep_any();
    return mcst_finish();
}
