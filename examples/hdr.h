/* hdr.h - reads and writes Radiance pictures (.hdr, .pic), for render.c and for the tests of mcsample.h.
 *
 *     hdr_picture p;
 *     float rgb[3];
 *     if (!hdr_read(&p, "sunrise.hdr")) return fprintf(stderr, "%s\n", p.fault), 1;
 *     hdr_color(&p, (size_t)row * p.w + col, rgb);
 *     free(p.pixel);
 *
 * A pixel has three mantissas of 8 bits and one exponent (Ward, "Real Pixels", Graphics Gems II, 1991). Radiance's
 * writer truncates the mantissas, as most others do, and its reader adds one half to them. So it is here: the mean
 * error of a channel is zero. Without the half it would be half a step, and a step is 1 in 128 to 256 of the brightest
 * channel of the pixel.
 *
 * The reader takes what Radiance's own takes (its common/header.c, resolu.c and color.c have the rules):
 *
 *   lines        end with LF or CRLF; the first one usually is #?RADIANCE, or #? with another name; an empty one ends
 *                the header
 *   FORMAT       32-bit_rle_rgbe, which is also meant where there is no such line, or 32-bit_rle_xyze
 *   EXPOSURE     has been multiplied into the pixels, several of them one after the other; so has COLORCORR, channel by
 *                channel. Both are divided out again
 *   PRIMARIES    are the chromaticities x, y of red, green, blue and white; colours become those of Rec. 709, white
 *                becomes (1, 1, 1), what lies outside of the gamut is clipped. Without this line RGB is taken for that
 *                of Rec. 709. The white of XYZ is (1, 1, 1), as Radiance has it, if there is no such line
 *   resolution   all eight orientations; pixels are put in the order of -Y h +X w, row by row from the top left
 *   scan lines   flat, with runs of whole pixels, or with runs of each channel
 *
 * No file, damaged or hostile, does more than to leave a sentence in `fault`. Memory grows with what has been decoded.
 */
#ifndef HDR_H
#define HDR_H
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef HDR_REALLOC
#define HDR_REALLOC realloc
#endif
#define HDR_PIXELS (1L << 27) /* The most that are read: 512 MiB. */
#define HDR_MOST \
    0x1p60f /* Brighter channels are read as this, so that products with them stay in the range of a float. */

typedef struct {
    unsigned char c[4]; /* As in the file: three mantissas, then the exponent, which is 0 for black. */
} hdr_pixel;

typedef struct {
    double m[3][3];
} hdr_matrix;

typedef struct {
    uint32_t w, h;
    hdr_pixel *pixel;  /* w * h of them. The caller frees this. */
    float step[256];   /* What 1 in a mantissa stands for, by exponent. */
    int converts;      /* Whether `matrix` is to be applied. */
    hdr_matrix matrix; /* From the file's components to linear Rec. 709. */
    size_t done, room; /* While reading: pixels decoded, pixels allocated. */
    char fault[200];   /* Why there is no picture. */
} hdr_picture;

/* An empty picture whose pixels will need no conversion. */
static inline void hdr_start(hdr_picture *p) {
    memset(p, 0, sizeof *p);
    for (int i = 1; i < 256; i++) p->step[i] = ldexpf(1, i - 136);
}

/* Linear Rec. 709. */
static inline void hdr_color(const hdr_picture *p, size_t i, float rgb[3]) {
    const unsigned char *c = p->pixel[i].c;
    const float step = p->step[c[3]];
    const float own[3] = {((float)c[0] + 0.5f) * step, ((float)c[1] + 0.5f) * step, ((float)c[2] + 0.5f) * step};
    for (int k = 0; k < 3; k++) {
        float value = own[k];
        if (p->converts) {
            const double *row = p->matrix.m[k];
            const double sum = row[0] * (double)own[0] + row[1] * (double)own[1] + row[2] * (double)own[2];
            value = sum > 0 ? (float)(sum < (double)HDR_MOST ? sum : (double)HDR_MOST) : 0;
        }
        rgb[k] = value < HDR_MOST ? value : HDR_MOST;
    }
}

/* ---- Writing ---- */

/* Negative channels and NaN become 0. Multiplying by a power of two is exact, so no mantissa can be rounded up to 256.
 */
static inline hdr_pixel hdr_encode(const float rgb[3]) {
    const float most = 0x1.fep126f; /* 255 with the highest exponent */
    hdr_pixel p = {{0, 0, 0, 0}};
    float top = 0;
    float c[3];
    for (int k = 0; k < 3; k++) {
        c[k] = rgb[k] > 0 ? rgb[k] < most ? rgb[k] : most : 0;
        if (c[k] > top) top = c[k];
    }
    if (top <= 1e-32f) return p; /* as Radiance does */
    int exponent;
    frexpf(top, &exponent);
    for (int k = 0; k < 3; k++) p.c[k] = (unsigned char)ldexpf(c[k], 8 - exponent);
    p.c[3] = (unsigned char)(exponent + 128);
    return p;
}

/* The pixels follow, row by row from the top. */
static inline void hdr_write_header(FILE *f, uint32_t w, uint32_t h) {
    fprintf(f, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %lu +X %lu\n", (unsigned long)h, (unsigned long)w);
}

/* ---- Reading: all functions return 0 after a fault ---- */

static inline int hdr_fail(hdr_picture *p, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(p->fault, sizeof p->fault, format, args);
    va_end(args);
    for (char *c = p->fault; *c; c++) /* Parts of the file may be in it. */
        if (*c < ' ' || *c > '~') *c = '?';
    return 0;
}

/* For the end of the file where there should be more. */
static inline int hdr_cut(hdr_picture *p, FILE *f, uint32_t number, uint32_t lines) {
    if (ferror(f)) return hdr_fail(p, "%s", strerror(errno));
    return hdr_fail(p, "the file ends in scan line %lu of %lu", (unsigned long)number, (unsigned long)lines);
}

/* ---- Colours ---- */

typedef struct {
    int xyz, primaries;
    double scale[3];                      /* the product of EXPOSURE and COLORCORR */
    double chroma[8];                     /* x and y of red, green, blue and white */
    int columns, from_right, from_bottom; /* the orientation; the scan lines are columns or rows */
} hdr_header;

static inline hdr_matrix hdr_product(hdr_matrix a, hdr_matrix b) {
    hdr_matrix product;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            product.m[i][k] = a.m[i][0] * b.m[0][k] + a.m[i][1] * b.m[1][k] + a.m[i][2] * b.m[2][k];
    return product;
}

static inline void hdr_apply(const hdr_matrix *a, const double v[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a->m[i][0] * v[0] + a->m[i][1] * v[1] + a->m[i][2] * v[2];
}

/* By cofactors, for matrices that have one. */
static inline hdr_matrix hdr_inverse(hdr_matrix a) {
    hdr_matrix inverse;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            const int i1 = (i + 1) % 3;
            const int i2 = (i + 2) % 3;
            const int k1 = (k + 1) % 3;
            const int k2 = (k + 2) % 3;
            inverse.m[k][i] = a.m[i1][k1] * a.m[i2][k2] - a.m[i1][k2] * a.m[i2][k1];
        }
    }
    const double det = a.m[0][0] * inverse.m[0][0] + a.m[0][1] * inverse.m[1][0] + a.m[0][2] * inverse.m[2][0];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) inverse.m[i][k] /= det;
    return inverse;
}

/* X, Y and Z of a chromaticity with Y = 1. */
static inline void hdr_white(const double xy[2], double out[3]) {
    out[0] = xy[0] / xy[1];
    out[1] = 1;
    out[2] = (1 - xy[0] - xy[1]) / xy[1];
}

/* From RGB to XYZ: each primary as strong as it takes to make (1, 1, 1) white. Returns 0 where the primaries span no
 * triangle that their four or so digits could tell from a line, and where white lies outside of it: then a strength is
 * not positive. */
static inline int hdr_to_xyz(const double chroma[8], hdr_matrix *out) {
    const double *r = chroma;
    const double *g = chroma + 2;
    const double *b = chroma + 4;
    const double twice_area = (g[0] - r[0]) * (b[1] - r[1]) - (b[0] - r[0]) * (g[1] - r[1]);
    if (!(fabs(twice_area) > 1e-6)) return 0;
    for (int k = 0; k < 3; k++) {
        out->m[0][k] = chroma[2 * k];
        out->m[1][k] = chroma[2 * k + 1];
        out->m[2][k] = 1 - chroma[2 * k] - chroma[2 * k + 1];
    }
    const hdr_matrix inverse = hdr_inverse(*out);
    double white[3];
    hdr_white(chroma + 6, white);
    double strength[3];
    hdr_apply(&inverse, white, strength);
    for (int k = 0; k < 3; k++) {
        if (!(strength[k] > 0 && strength[k] < 1e30)) return 0;
        for (int i = 0; i < 3; i++) out->m[i][k] *= strength[k];
    }
    return 1;
}

/* From the file's components to Rec. 709. White is adapted as the eye's cones would adapt to it, by Bradford's matrix
 * (Lam, "Metamerism and colour constancy", thesis, University of Bradford, 1985). */
static inline int hdr_conversion(hdr_picture *p, const hdr_header *header) {
    static const double rec709[8] = {0.640, 0.330, 0.300, 0.600, 0.150, 0.060, 0.3127, 0.3290};
    static const hdr_matrix cones = {{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
    hdr_matrix to_xyz = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    p->matrix = to_xyz;
    p->converts = header->xyz || header->primaries;
    if (p->converts) {
        double white[3] = {1, 1, 1};
        if (header->primaries) hdr_white(header->chroma + 6, white);
        if (!header->xyz && !hdr_to_xyz(header->chroma, &to_xyz))
            return hdr_fail(p, "the PRIMARIES are no triangle around their white");
        double white709[3];
        hdr_white(rec709 + 6, white709);
        double from[3];
        hdr_apply(&cones, white, from);
        double to[3];
        hdr_apply(&cones, white709, to);
        hdr_matrix adapted = hdr_product(cones, to_xyz);
        for (int i = 0; i < 3; i++) {
            if (!(from[i] > 0 && from[i] < 1e30)) return hdr_fail(p, "the white of the PRIMARIES is no colour");
            for (int k = 0; k < 3; k++) adapted.m[i][k] *= to[i] / from[i];
        }
        hdr_matrix rec709_to_xyz;
        hdr_to_xyz(rec709, &rec709_to_xyz);
        p->matrix = hdr_product(hdr_inverse(rec709_to_xyz), hdr_product(hdr_inverse(cones), adapted));
    }
    for (int k = 0; k < 3; k++) {
        if (!(header->scale[k] >= 1e-30 && header->scale[k] <= 1e30))
            return hdr_fail(p, "the EXPOSURE and COLORCORR lines multiply to %g, from which no radiance follows",
                            header->scale[k]);
        if (header->scale[k] != 1) p->converts = 1;
        for (int i = 0; i < 3; i++) p->matrix.m[i][k] /= header->scale[k];
    }
    return 1;
}

/* ---- Header ---- */

enum { HDR_LINE = 2048, HDR_END = -1 };

/* One line without its end; what does not fit is dropped. Returns its length, or HDR_END where the file ends before its
 * end. */
static inline int hdr_line(FILE *f, char line[HDR_LINE]) {
    int n = 0;
    int c;
    while ((c = getc(f)) != EOF && c != '\n')
        if (n < HDR_LINE - 1) line[n++] = (char)c;
    if (n > 0 && line[n - 1] == '\r') n--;
    line[n] = 0;
    return c == EOF ? HDR_END : n;
}

/* What follows the name of a setting, or NULL if the line is not about it. */
static inline const char *hdr_setting(const char *line, const char *name) {
    const size_t n = strlen(name);
    return strncmp(line, name, n) ? NULL : line + n;
}

/* So many finite numbers. */
static inline int hdr_numbers(const char *text, int n, double *value) {
    for (int k = 0; k < n; k++) {
        char *end;
        value[k] = strtod(text, &end);
        if (end == text || !isfinite(value[k])) return 0;
        text = end;
    }
    return 1;
}

static inline int hdr_header_line(hdr_picture *p, hdr_header *header, const char *line) {
    const char *value;
    double number[3];
    if ((value = hdr_setting(line, "FORMAT=")) != NULL) {
        value += strspn(value, " \t");
        const int n = (int)strcspn(value, " \t\r");
        header->xyz = n == 15 && !strncmp(value, "32-bit_rle_xyze", 15);
        if (n > 0 && !header->xyz && !(n == 15 && !strncmp(value, "32-bit_rle_rgbe", 15)))
            return hdr_fail(p, "the FORMAT is '%.*s'; 32-bit_rle_rgbe and 32-bit_rle_xyze are read", n < 60 ? n : 60,
                            value);
    } else if ((value = hdr_setting(line, "EXPOSURE=")) != NULL) {
        if (!hdr_numbers(value, 1, number) || number[0] <= 0)
            return hdr_fail(p, "an EXPOSURE line has no positive number");
        for (int k = 0; k < 3; k++) header->scale[k] *= number[0];
    } else if ((value = hdr_setting(line, "COLORCORR=")) != NULL) {
        if (!hdr_numbers(value, 3, number) || number[0] <= 0 || number[1] <= 0 || number[2] <= 0)
            return hdr_fail(p, "a COLORCORR line does not have three positive numbers");
        for (int k = 0; k < 3; k++) header->scale[k] *= number[k];
    } else if ((value = hdr_setting(line, "PRIMARIES=")) != NULL) {
        if (!hdr_numbers(value, 8, header->chroma)) return hdr_fail(p, "a PRIMARIES line does not have eight numbers");
        header->primaries = 1;
    }
    return 1;
}

/* The axis that comes first tells scan lines from the pixels in them; a minus sign, which end of it comes first. */
static inline int hdr_resolution(hdr_picture *p, hdr_header *header, const char *line) {
    const char *x = strrchr(line, 'X');
    const char *y = strrchr(line, 'Y');
    if (!x || !y) return hdr_fail(p, "the resolution line '%.60s' is not like '-Y height +X width'", line);
    const long w = strtol(x + 1, NULL, 10);
    const long h = strtol(y + 1, NULL, 10);
    if (w <= 0 || h <= 0) return hdr_fail(p, "the resolution line '%.60s' does not have two positive numbers", line);
    if (w > HDR_PIXELS / h)
        return hdr_fail(p, "%ld x %ld pixels are more than the %ld that are read", w, h, HDR_PIXELS);
    header->columns = x < y;
    header->from_right = x > line && x[-1] == '-';
    header->from_bottom = !(y > line && y[-1] == '-');
    p->w = (uint32_t)w;
    p->h = (uint32_t)h;
    return 1;
}

static inline int hdr_read_header(hdr_picture *p, hdr_header *header, FILE *f) {
    memset(header, 0, sizeof *header);
    for (int k = 0; k < 3; k++) header->scale[k] = 1;
    const int first = getc(f);
    if (first == EOF) return hdr_fail(p, "%s", ferror(f) ? strerror(errno) : "the file is empty");
    ungetc(first, f);
    char line[HDR_LINE];
    int n = hdr_line(f, line);
    int ok = 1;
    const int marked = !strncmp(line, "#?", 2);
    for (; ok && n > 0; n = hdr_line(f, line)) ok = hdr_header_line(p, header, line);
    if (ok && n == 0) n = hdr_line(f, line);
    if (ferror(f)) return hdr_fail(p, "%s", strerror(errno));
    if (ok && n == HDR_END) ok = hdr_fail(p, "the file ends in its header");
    ok = ok && hdr_resolution(p, header, line) && hdr_conversion(p, header);
    if (!ok && !marked) return hdr_fail(p, "this is no Radiance picture: it does not begin with '#?'");
    return ok;
}

/* ---- Pixels ---- */

/* Makes room for n more pixels. */
static inline int hdr_reserve(hdr_picture *p, size_t n) {
    const size_t all = (size_t)p->w * p->h;
    const size_t need = p->done + n;
    size_t room = p->room > 0 ? p->room : 4096;
    if (need <= p->room) return 1;
    while (room < need) room *= 2;
    if (room > all) room = all;
    hdr_pixel *pixel = (hdr_pixel *)HDR_REALLOC(p->pixel, room * sizeof *pixel);
    if (!pixel)
        return hdr_fail(p, "there is not enough memory for %lu x %lu pixels", (unsigned long)p->w, (unsigned long)p->h);
    p->pixel = pixel;
    p->room = room;
    return 1;
}

/* A scan line whose four channels are coded one after the other. A byte n up to 128 announces n bytes, one above a run
 * of n - 128 that are alike. */
static inline int hdr_read_channels(hdr_picture *p, FILE *f, uint32_t length, uint32_t number, uint32_t lines) {
    if (!hdr_reserve(p, length)) return 0;
    hdr_pixel *line = p->pixel + p->done;
    for (int channel = 0; channel < 4; channel++) {
        for (uint32_t i = 0; i < length;) {
            const int code = getc(f);
            const int run = code > 128;
            const uint32_t n = (uint32_t)(run ? code - 128 : code);
            const uint32_t end = i + n;
            int value = run ? getc(f) : 0;
            if (code == EOF) return hdr_cut(p, f, number, lines);
            if (n > length - i) return hdr_fail(p, "a run in scan line %lu goes beyond its end", (unsigned long)number);
            for (; i < end; i++) {
                if (!run) value = getc(f);
                if (value == EOF) return hdr_cut(p, f, number, lines);
                line[i].c[channel] = (unsigned char)value;
            }
        }
    }
    p->done += length;
    return 1;
}

/* A scan line of whole pixels, of which `first` has been read. (1, 1, 1, n) repeats the pixel before it n times;
 * several in a row hold the bytes of n, the lowest first. A run ends with the line even if n is larger, as in Radiance.
 */
static inline int hdr_read_pixels(hdr_picture *p, FILE *f, hdr_pixel first, uint32_t length, uint32_t number,
                                  uint32_t lines) {
    hdr_pixel pixel = first;
    uint32_t left = length;
    uint32_t shift = 0;
    uint32_t n = 1;
    for (;;) {
        if (!hdr_reserve(p, n)) return 0;
        for (left -= n; n > 0; n--) p->pixel[p->done++] = pixel;
        if (left == 0) return 1;
        hdr_pixel next;
        if (fread(next.c, 1, 4, f) != 4) return hdr_cut(p, f, number, lines);
        if (next.c[0] == 1 && next.c[1] == 1 && next.c[2] == 1) {
            const uint64_t run = shift < 32 ? (uint64_t)next.c[3] << shift : next.c[3] > 0 ? left : 0;
            n = run < left ? (uint32_t)run : left;
            if (shift < 32) shift += 8;
        } else {
            pixel = next;
            n = 1;
            shift = 0;
        }
    }
}

static inline int hdr_read_scanline(hdr_picture *p, FILE *f, uint32_t length, uint32_t number, uint32_t lines) {
    hdr_pixel first;
    if (fread(first.c, 1, 4, f) != 4) return hdr_cut(p, f, number, lines);
    const uint32_t coded = (uint32_t)first.c[2] << 8 | first.c[3];
    if (first.c[0] != 2 || first.c[1] != 2 || first.c[2] > 127)
        return hdr_read_pixels(p, f, first, length, number, lines);
    if (coded == length) return hdr_read_channels(p, f, length, number, lines);
    if (length < 8 || length > 32767)
        return hdr_read_pixels(p, f, first, length, number, lines); /* too short or long to be coded */
    return hdr_fail(p, "scan line %lu is coded for a width of %lu instead of %lu", (unsigned long)number,
                    (unsigned long)coded, (unsigned long)length);
}

/* From the order of the file to that of -Y h +X w. */
static inline int hdr_turn(hdr_picture *p, const hdr_header *header) {
    const size_t w = p->w;
    const size_t h = p->h;
    if (!header->columns && !header->from_right && !header->from_bottom) return 1;
    hdr_pixel *turned = (hdr_pixel *)HDR_REALLOC(NULL, w * h * sizeof *turned);
    if (!turned)
        return hdr_fail(p, "there is not enough memory to turn %lu x %lu pixels", (unsigned long)w, (unsigned long)h);
    for (size_t y = 0; y < h; y++) {
        const size_t row = header->from_bottom ? h - 1 - y : y;
        for (size_t x = 0; x < w; x++) {
            const size_t col = header->from_right ? w - 1 - x : x;
            turned[y * w + x] = p->pixel[header->columns ? col * h + row : row * w + col];
        }
    }
    free(p->pixel);
    p->pixel = turned;
    return 1;
}

/* From where the file stands. Bytes after the picture are left alone. */
static inline int hdr_read_file(hdr_picture *p, FILE *f) {
    hdr_start(p);
    hdr_header header;
    int ok = hdr_read_header(p, &header, f);
    const uint32_t length = header.columns ? p->h : p->w;
    const uint32_t lines = header.columns ? p->w : p->h;
    for (uint32_t i = 0; ok && i < lines; i++) ok = hdr_read_scanline(p, f, length, i + 1, lines);
    for (size_t i = 0; ok && i < p->done;
         i++) { /* Black with an exponent is black: the half would make a faint grey of it. */
        unsigned char *c = p->pixel[i].c;
        if (!(c[0] | c[1] | c[2])) c[3] = 0;
    }
    ok = ok && hdr_turn(p, &header);
    if (!ok) {
        free(p->pixel);
        p->pixel = NULL;
        p->w = p->h = 0;
    }
    return ok;
}

static inline int hdr_read(hdr_picture *p, const char *name) {
    FILE *f = fopen(name, "rb");
    if (!f) {
        hdr_start(p);
        return hdr_fail(p, "%s", strerror(errno));
    }
    const int ok = hdr_read_file(p, f);
    fclose(f);
    return ok;
}
#endif
