/* examples/hdr.h, the reader and writer of Radiance pictures: that writing and reading is unbiased, that it reads what
 * Radiance's own reader reads, and that no damage to a file does more than to be named. The files are made here, in
 * memory. */
#define _POSIX_C_SOURCE 200809L /* fmemopen */
#include <float.h>
#include <stdlib.h>

/* Memory as the reader asks for it: the largest request is noted, and so many are granted. */
enum { ALWAYS = 1 << 30 };
static size_t most_asked;
static int granted = ALWAYS;
static void *counted(void *block, size_t size) {
    if (size > most_asked) most_asked = size;
    return granted-- > 0 ? realloc(block, size) : NULL;
}
#define HDR_REALLOC counted
#include "../examples/hdr.h"
#include "mcs_test.h"
#include "mcsample.h"

/* ---- Files ---- */

typedef struct {
    size_t n;
    unsigned char byte[1 << 19];
} bytes;

static void put(bytes *to, const void *from, size_t n) {
    if (n > sizeof to->byte - to->n) abort();
    memcpy(to->byte + to->n, from, n);
    to->n += n;
}

static void put_text(bytes *to, const char *text) { put(to, text, strlen(text)); }

static void put_pixel(bytes *to, int r, int g, int b, int e) {
    const unsigned char pixel[4] = {(unsigned char)r, (unsigned char)g, (unsigned char)b, (unsigned char)e};
    put(to, pixel, 4);
}

/* A header with these lines and this resolution. */
static void begin(bytes *to, const char *lines, const char *resolution) {
    to->n = 0;
    put_text(to, lines);
    put_text(to, "\n");
    put_text(to, resolution);
    put_text(to, "\n");
}

static int load(hdr_picture *p, const bytes *from) {
    static unsigned char copy[sizeof from->byte];
    memcpy(copy, from->byte, from->n);
    FILE *f = fmemopen(copy, from->n, "rb");
    if (!f) abort();
    most_asked = 0;
    const int ok = hdr_read_file(p, f);
    fclose(f);
    return ok;
}

/* A fault is a sentence on one line, and leaves no picture. */
static void check_fault(const hdr_picture *p) {
    CHECK(!p->pixel && p->w == 0 && p->h == 0, "%p, %u x %u", (void *)p->pixel, p->w, p->h);
    CHECK(strlen(p->fault) > 10 && strspn(p->fault, " '") == 0, "'%s'", p->fault);
    for (const char *c = p->fault; *c; c++) CHECK(*c >= ' ' && *c <= '~', "character %d", *c);
}

static void expect_fault(const bytes *file, const char *part) {
    hdr_picture p;
    const int ok = load(&p, file);
    CHECK(!ok, "read as %u x %u", p.w, p.h);
    if (!ok) {
        CHECK(strstr(p.fault, part) != NULL, "'%s' instead of '%s'", p.fault, part);
        check_fault(&p);
    }
    free(p.pixel);
}

static int same(hdr_pixel a, int r, int g, int b, int e) {
    return a.c[0] == r && a.c[1] == g && a.c[2] == b && a.c[3] == e;
}

/* The picture has these pixels, numbered along the rows from the top: pixel i is (i + 128, i, 3 i, 129). */
static void put_numbered(bytes *to, int i) { put_pixel(to, i + 128, i, 3 * i, 129); }
static void expect_numbered(const bytes *file, uint32_t w, uint32_t h) {
    hdr_picture p;
    const int ok = load(&p, file);
    CHECK(ok, "%s", p.fault);
    if (!ok) return;
    CHECK(p.w == w && p.h == h, "%u x %u", p.w, p.h);
    for (uint32_t i = 0; i < w * h; i++) {
        const unsigned char *c = p.pixel[i].c;
        CHECK(same(p.pixel[i], (int)i + 128, (int)i, 3 * (int)i, 129), "pixel %u: %d %d %d %d", i, c[0], c[1], c[2],
              c[3]);
    }
    free(p.pixel);
}

/* ---- Pixels, written and read ---- */

static void decode(hdr_pixel pixel, float rgb[3]) {
    static hdr_picture p;
    if (p.step[1] == 0) hdr_start(&p);
    p.pixel = &pixel;
    hdr_color(&p, 0, rgb);
}

/* The place of a value in its step is as good as uniform: u has 24 bits, of which 8 choose the step and 16 the place in
 * it, whose mean is 2^-17 below 1/2. So the error of a channel in steps has mean 0 and variance 1/12, and the mean of n
 * is within five standard deviations of 0 but in one of 1.7 million cases; 2^-17 is a fortieth of one of them. */
static void test_bias(void) {
    const int n = 300000;
    mcst_group("bias");
    for (int exponent = -100; exponent <= 60; exponent += 40) {
        if (!mcst_case("brightest channel below 2^%d", exponent)) continue;
        mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, (uint64_t)(exponent + 200));
        double off = 0;
        double light = 0;
        double read = 0;
        double dark = 0;
        double dark_read = 0;
        double dark_n = 0;
        const double sigma = sqrt(1 / 12.0 / (3.0 * n));
        const double step = ldexp(1, exponent - 8);
        for (int i = 0; i < n; i++) {
            const int top = i % 3;
            float c[3];
            for (int k = 0; k < 3; k++) c[k] = ldexpf(mcs_pcg32_float(&rng), exponent);
            c[top] = ldexpf(0.5f + 0.5f * mcs_pcg32_float(&rng), exponent);
            float back[3];
            decode(hdr_encode(c), back);
            for (int k = 0; k < 3; k++) {
                const double error = ((double)back[k] - (double)c[k]) / step;
                CHECK(fabs(error) <= 0.5, "%g read as %g", (double)c[k], (double)back[k]);
                off += error / (3.0 * n);
                light += (double)c[k] / step;
                read += (double)back[k] / step;
                if ((double)c[k] >= 8 * step) continue;
                dark += (double)c[k] / step;
                dark_read += (double)back[k] / step;
                dark_n++;
            }
        }
        CHECK(fabs(off) <= 5 * sigma, "mean error %g steps, sigma %g", off, sigma);
        CHECK(fabs(read / light - 1) <= 5 * sigma * 3.0 * n / light, "light %g %%", 100 * (read / light - 1));
        CHECK(fabs(dark_read / dark - 1) <= 5 * sqrt(dark_n / 12) / dark, "dark channels %g %%",
              100 * (dark_read / dark - 1));
        mcst_note("    2^%d: mean error %+.5f steps, light %+.5f %%, dark channels %+.4f %%\n", exponent, off,
                  100 * (read / light - 1), 100 * (dark_read / dark - 1));
    }
}

static void test_pixels(void) {
    static const float nothing[][3] = {
        {0, 0, 0}, {-1, -0.0f, 0}, {NAN, -INFINITY, 0}, {0x1p-107f, 1e-33f, FLT_MIN / 8}};
    static const float most[][3] = {{FLT_MAX, 0, 1}, {1, INFINITY, NAN}, {0x1.fffffep126f, -INFINITY, 0x1p126f}};
    mcst_group("pixels");
    float c[3];
    if (mcst_case("black is black")) {
        for (size_t i = 0; i < sizeof nothing / sizeof *nothing; i++) {
            const hdr_pixel p = hdr_encode(nothing[i]);
            CHECK(same(p, 0, 0, 0, 0), "row %d", (int)i);
            decode(p, c);
            CHECK(c[0] == 0 && c[1] == 0 && c[2] == 0, "row %d: %g %g %g", (int)i, (double)c[0], (double)c[1],
                  (double)c[2]);
        }
    }
    if (mcst_case("the brightest are not black")) {
        for (size_t i = 0; i < sizeof most / sizeof *most; i++) {
            const hdr_pixel p = hdr_encode(most[i]);
            const int top = i == 1;
            CHECK(p.c[top] == 255 && p.c[3] == 255, "row %d: %d, exponent %d", (int)i, p.c[top], p.c[3]);
            decode(p, c);
            CHECK(c[top] == HDR_MOST, "row %d: %g", (int)i, (double)c[top]);
        }
    }
    if (mcst_case("known values")) {
        static const float value[][3] = {
            {1, 0.5f, 0.25f}, {0x1.fffffep-1f, 0, 0x1p-9f}, {3, 255, 256}, {0x1p-100f, 0, 0x1p-101f}};
        static const int code[][4] = {{128, 64, 32, 129}, {255, 0, 0, 128}, {1, 127, 128, 137}, {128, 0, 64, 29}};
        for (int i = 0; i < 4; i++) {
            const hdr_pixel p = hdr_encode(value[i]);
            CHECK(same(p, code[i][0], code[i][1], code[i][2], code[i][3]), "row %d: %d %d %d %d", i, p.c[0], p.c[1],
                  p.c[2], p.c[3]);
        }
        hdr_pixel p = {{128, 64, 0, 129}};
        decode(p, c); /* as Radiance: (m + 1/2) 2^(e - 136) */
        CHECK(c[0] == 128.5f / 128 && c[1] == 64.5f / 128 && c[2] == 0.5f / 128, "%g %g %g", (double)c[0], (double)c[1],
              (double)c[2]);
    }
    if (mcst_case("what has been read is written as it was")) { /* from 1e-32 to HDR_MOST */
        for (int e = 23; e <= 187; e++) {
            for (int m = 0; m < 256; m += 5) {
                const hdr_pixel p = {
                    {(unsigned char)(128 + m / 2), (unsigned char)m, (unsigned char)(255 - m), (unsigned char)e}};
                decode(p, c);
                const hdr_pixel again = hdr_encode(c);
                CHECK(!memcmp(&p, &again, sizeof p), "%d %d %d %d", p.c[0], p.c[1], p.c[2], p.c[3]);
            }
        }
    }
}

/* ---- Headers ---- */

static const char *const good_headers[] = {
    "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n",
    "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n",
    "#?RGBE\nFORMAT=32-bit_rle_rgbe\n",
    "#?AUTOPANO\nFORMAT= \t32-bit_rle_rgbe \n",
    "#?\nFORMAT=\n",
    "#?RADIANCE\n",
    "FORMAT=32-bit_rle_rgbe\n",
    "",
    "#?RADIANCE\n# a comment\nrpict -vp 0 0 0\n\tFORMAT=ascii\n\tEXPOSURE=7\nVIEW= -vtl\nPIXASPECT=0.5\nformat=none\n",
    "#?RADIANCE\nFORMAT=32-bit_rle_xyze\nFORMAT=32-bit_rle_rgbe\n",
    "#?RADIANCE\nEXPOSURE=4\nEXPOSURE= 0.25 # back\nCOLORCORR= 2 .5 1\nCOLORCORR=.5 2 1 \r\n",
};
static const char *const bad_headers[][2] = {
    {"#?RADIANCE\nFORMAT=32-bit_rle_rgb\n", "FORMAT is '32-bit_rle_rgb';"},
    {"#?RADIANCE\nFORMAT=32-bit_rle_xyzee\n", "FORMAT is '32-bit_rle_xyzee';"},
    {"#?RADIANCE\nFORMAT=Radiance_spectra\r\n", "FORMAT is 'Radiance_spectra';"},
    {"#?RADIANCE\nFORMAT=\033[31m\177\200\n", "FORMAT is '\?[31m\?\?';"},
    {"#?RADIANCE\nEXPOSURE=0\n", "an EXPOSURE line has no positive number"},
    {"#?RADIANCE\nEXPOSURE=-1\n", "an EXPOSURE line has no positive number"},
    {"#?RADIANCE\nEXPOSURE=bright\n", "an EXPOSURE line has no positive number"},
    {"#?RADIANCE\nEXPOSURE=nan\n", "an EXPOSURE line has no positive number"},
    {"#?RADIANCE\nEXPOSURE=1e999\n", "an EXPOSURE line has no positive number"},
    {"#?RADIANCE\nEXPOSURE=1e20\nEXPOSURE=1e20\n", "EXPOSURE and COLORCORR lines multiply to 1e+40"},
    {"#?RADIANCE\nCOLORCORR=1 1e-200 1\nCOLORCORR=1 1e-200 1\n", "EXPOSURE and COLORCORR lines multiply to 0"},
    {"#?RADIANCE\nCOLORCORR=1 1\n", "a COLORCORR line does not have three positive numbers"},
    {"#?RADIANCE\nCOLORCORR=1 1 0\n", "a COLORCORR line does not have three positive numbers"},
    {"#?RADIANCE\nPRIMARIES=.64 .33 .3 .6 .15 .06 .3127\n", "PRIMARIES line does not have eight numbers"},
    {"#?RADIANCE\nPRIMARIES=0 0 0 0 0 0 0 0\n", "PRIMARIES are no triangle"},
    {"#?RADIANCE\nPRIMARIES=.1 .1 .2 .2 .3 .3 .25 .25\n", "PRIMARIES are no triangle"},
    {"#?RADIANCE\nPRIMARIES=.64 .33 .3 .6 .15 .06 .05 .9\n", "PRIMARIES are no triangle"},
    {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\nPRIMARIES=1 0 0 1 0 0 .3 0\n", "white of the PRIMARIES"},
    {"\211PNG\n", "no Radiance picture"},
};
static const char *const resolutions[] = {"-Y 2 +X 3",   "-Y 2 +X 3\r",      "-Y   2   +X   3", "-Y2+X3",
                                          "-Y 02 X 003", "-Y 2 +X 3 and so", "-Y\t2 +X\t3"};
static const char *const bad_resolutions[][2] = {{"-Y -2 +X 3", "two positive numbers"},
                                                 {"-Y 2 +X 0", "two positive numbers"},
                                                 {"-Y +X", "two positive numbers"},
                                                 {"2 3", "is not like"},
                                                 {"-Y 2", "is not like"},
                                                 {"", "is not like"},
                                                 {"P6 3 2 255", "is not like"},
                                                 {"-Y 999999999 +X 999999999", "more than"},
                                                 {"-Y 1 +X 134217729", "more than"},
                                                 {"-Y 99999999999999999999 +X 9", "more than"},
                                                 {"-Y 9 +X 99999999999999999999", "more than"}};
static const char plain[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";

static void put_six(bytes *file) {
    for (int k = 0; k < 6; k++) put_numbered(file, k);
}

static void test_good_headers(bytes *file) {
    for (size_t i = 0; i < sizeof good_headers / sizeof *good_headers; i++) {
        if (!mcst_case("read, %d", (int)i)) continue;
        begin(file, good_headers[i], "-Y 2 +X 3");
        put_six(file);
        expect_numbered(file, 3, 2);
        hdr_picture p;
        if (load(&p, file)) CHECK(!p.converts, "a conversion of '%s'", good_headers[i]);
        free(p.pixel);
    }
    for (size_t i = 0; i < sizeof resolutions / sizeof *resolutions; i++) {
        if (!mcst_case("resolution, %d", (int)i)) continue;
        begin(file, plain, resolutions[i]);
        put_six(file);
        put_text(file, "something that follows");
        expect_numbered(file, 3, 2);
    }
    if (mcst_case("all lines end with CRLF")) {
        file->n = 0;
        put_text(file, "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 2 +X 3\r\n");
        put_six(file);
        expect_numbered(file, 3, 2);
    }
    if (mcst_case("long lines")) {
        file->n = 0;
        put_text(file, "#?RADIANCE\n");
        for (int line = 0; line < 20; line++) {
            put_text(file, "# ");
            for (int k = 0; k < 100 + 100 * line; k++) put_text(file, "FORMAT=x");
            put_text(file, "\n");
        }
        put_text(file, "\n-Y 2 +X 3\n");
        put_six(file);
        expect_numbered(file, 3, 2);
    }
}

static void test_bad_headers(bytes *file) {
    for (size_t i = 0; i < sizeof bad_headers / sizeof *bad_headers; i++) {
        if (!mcst_case("refused, %d", (int)i)) continue;
        begin(file, bad_headers[i][0], "-Y 2 +X 3");
        if (bad_headers[i][0][0] != '#') begin(file, bad_headers[i][0], "IHDR");
        put_six(file);
        expect_fault(file, bad_headers[i][1]);
    }
    for (size_t i = 0; i < sizeof bad_resolutions / sizeof *bad_resolutions; i++) {
        if (!mcst_case("resolution refused, %d", (int)i)) continue;
        begin(file, plain, bad_resolutions[i][0]);
        put_six(file);
        expect_fault(file, bad_resolutions[i][1]);
    }
    if (mcst_case("no file")) {
        hdr_picture p;
        CHECK(!hdr_read(&p, "build/there/is/no.hdr") && strstr(p.fault, "No such file"), "'%s'", p.fault);
        check_fault(&p);
        CHECK(!hdr_read(&p, ".") && strstr(p.fault, "directory"), "'%s'", p.fault);
        check_fault(&p);
        file->n = 0;
        expect_fault(file, "empty");
    }
}

static void test_headers(void) {
    static bytes file;
    mcst_group("headers");
    test_good_headers(&file);
    test_bad_headers(&file);
}

/* ---- Orientations ---- */

/* The scan lines go along the second axis, one after the other along the first. + on Y is up, + on X to the right. */
static void test_orientations(void) {
    static bytes file;
    mcst_group("orientations");
    for (int which = 0; which < 8; which++) {
        const int y_first = which & 1;
        const int x_sign = which & 2 ? '-' : '+';
        const int y_sign = which & 4 ? '-' : '+';
        const int w = 7;
        const int h = 5;
        const int outer = y_first ? h : w;
        const int inner = y_first ? w : h;
        char x_axis[20];
        snprintf(x_axis, sizeof x_axis, "%cX %d", x_sign, w);
        char y_axis[20];
        snprintf(y_axis, sizeof y_axis, "%cY %d", y_sign, h);
        char resolution[40];
        snprintf(resolution, sizeof resolution, "%s %s", y_first ? y_axis : x_axis, y_first ? x_axis : y_axis);
        if (!mcst_case("%s", resolution)) continue;
        begin(&file, "#?RADIANCE\n", resolution);
        for (int i = 0; i < outer; i++) {
            for (int k = 0; k < inner; k++) {
                const int from_left = y_first ? k : i;
                const int from_bottom = y_first ? i : k;
                const int x = x_sign == '+' ? from_left : w - 1 - from_left;
                const int y = y_sign == '+' ? h - 1 - from_bottom : from_bottom;
                put_numbered(&file, y * w + x);
            }
        }
        expect_numbered(&file, (uint32_t)w, (uint32_t)h);
        granted = 1; /* for the pixels as they come, not for turning them */
        hdr_picture p;
        CHECK(which == 5 ? load(&p, &file) : !load(&p, &file) && strstr(p.fault, "not enough memory to turn"), "'%s'",
              p.fault);
        granted = ALWAYS;
        free(p.pixel);
    }
}

/* ---- Scan lines ---- */

static void put_run(bytes *to, int count) { put_pixel(to, 1, 1, 1, count); }

/* A channel of a coded scan line: so many alike. */
static void put_alike(bytes *to, uint32_t n, int value) {
    while (n > 0) {
        const uint32_t part = n < 127 ? n : 127;
        const unsigned char code[2] = {(unsigned char)(128 + part), (unsigned char)value};
        put(to, code, 2);
        n -= part;
    }
}

static void put_coded(bytes *to, uint32_t w, int r, int g, int b, int e) {
    put_pixel(to, 2, 2, (int)(w >> 8), (int)(w & 255));
    put_alike(to, w, r);
    put_alike(to, w, g);
    put_alike(to, w, b);
    put_alike(to, w, e);
}

/* All pixels of the picture are alike. */
static void expect_alike(const bytes *file, uint32_t w, uint32_t h, int r, int g, int b, int e) {
    hdr_picture p;
    const int ok = load(&p, file);
    uint32_t i = 0;
    CHECK(ok, "%s", p.fault);
    if (!ok) return;
    CHECK(p.w == w && p.h == h, "%u x %u", p.w, p.h);
    while (i < w * h && same(p.pixel[i], r, g, b, e)) i++;
    CHECK(i == w * h, "pixel %u", i);
    free(p.pixel);
}

static void check_width(bytes *file, uint32_t w) {
    char resolution[40];
    snprintf(resolution, sizeof resolution, "-Y 2 +X %u", w);
    if (mcst_case("width %u, flat", w)) {
        begin(file, "#?RADIANCE\n", resolution);
        for (uint32_t k = 0; k < 2 * w; k++) put_pixel(file, 200, 2, (int)(k % 7), 130);
        hdr_picture p;
        const int ok = load(&p, file);
        CHECK(ok && p.w == w && p.h == 2, "%s", p.fault);
        for (uint32_t k = 0; ok && k < 2 * w; k++) CHECK(same(p.pixel[k], 200, 2, (int)(k % 7), 130), "pixel %u", k);
        free(p.pixel);
    }
    if (mcst_case("width %u, runs of channels", w)) { /* Radiance takes them in any width below 32768 */
        begin(file, "#?RADIANCE\n", resolution);
        put_coded(file, w, 7, 0, 255, 131);
        put_coded(file, w, 7, 0, 255, 131);
        expect_alike(file, w, 2, 7, 0, 255, 131);
    }
    if (mcst_case("width %u, runs of pixels", w)) {
        begin(file, "#?RADIANCE\n", resolution);
        for (int line = 0; line < 2; line++) {
            put_pixel(file, 129, 3, 4, 127);
            for (uint32_t left = w - 1; left > 0; left >>= 8) put_run(file, (int)(left & 255));
        }
        expect_alike(file, w, 2, 129, 3, 4, 127);
    }
}

/* too wide for runs of channels */
static void check_width_40000(bytes *file) {
    begin(file, "#?RADIANCE\n", "-Y 2 +X 40000");
    for (int k = 0; k < 40000; k++) put_pixel(file, 2, 2, 100, 64);
    put_pixel(file, 2, 2, 100, 64);
    put_run(file, 39999 & 255);
    put_run(file, 39999 >> 8);
    expect_alike(file, 40000, 2, 2, 2, 100, 64);
}

static void check_literals(bytes *file) {
    begin(file, "#?RADIANCE\n", "-Y 1 +X 100");
    put_pixel(file, 2, 2, 0, 100);
    for (int channel = 0; channel < 4; channel++) {
        put_pixel(file, 0, 0, 0, 60);
        for (int k = 0; k < 60; k++) put(file, &(unsigned char){(unsigned char)(k + channel + 1)}, 1);
        put(file, "\0\050", 2);
        for (int k = 60; k < 100; k++) put(file, &(unsigned char){(unsigned char)(k + channel + 1)}, 1);
    }
    hdr_picture p;
    CHECK(load(&p, file), "%s", p.fault);
    for (int k = 0; p.pixel && k < 100; k++) CHECK(same(p.pixel[k], k + 1, k + 2, k + 3, k + 4), "pixel %d", k);
    free(p.pixel);
}

static void check_literal_of_128(bytes *file) {
    begin(file, "#?RADIANCE\n", "-Y 1 +X 128");
    put_pixel(file, 2, 2, 0, 128);
    for (int channel = 0; channel < 4; channel++) {
        put(file, "\200", 1);
        for (int k = 0; k < 128; k++) put(file, "\311", 1);
    }
    expect_alike(file, 128, 1, 201, 201, 201, 201);
}

static void check_no_code(bytes *file) {
    begin(file, "#?RADIANCE\n", "-Y 2 +X 3"); /* (2, 2, 0, 5) in a width of 3, (1, 1, 1, 9) as the first of a line */
    put_pixel(file, 2, 2, 0, 5);
    put_pixel(file, 200, 200, 200, 129);
    put_run(file, 1);
    put_pixel(file, 1, 1, 1, 9);
    put_run(file, 2);
    hdr_picture p;
    CHECK(load(&p, file), "%s", p.fault);
    if (p.pixel) {
        CHECK(same(p.pixel[0], 2, 2, 0, 5) && same(p.pixel[2], 200, 200, 200, 129), "first line");
        CHECK(same(p.pixel[3], 1, 1, 1, 9) && same(p.pixel[5], 1, 1, 1, 9), "second line");
    }
    free(p.pixel);
}

static void check_own_bytes(bytes *file) {
    static const int red[6] = {150, 150, 150, 160, 160, 170};
    begin(file, "#?RADIANCE\n", "-Y 1 +X 6");
    put_pixel(file, 150, 1, 2, 129);
    put_run(file, 2);
    put_pixel(file, 160, 1, 2, 129);
    put_run(file, 1);
    put_pixel(file, 170, 1, 2, 129);
    hdr_picture p;
    CHECK(load(&p, file), "%s", p.fault);
    for (int k = 0; p.pixel && k < 6; k++) CHECK(same(p.pixel[k], red[k], 1, 2, 129), "pixel %d", k);
    free(p.pixel);
}

/* as Radiance: the rest of the run is dropped */
static void check_runs_beyond(bytes *file) {
    begin(file, "#?RADIANCE\n", "-Y 2 +X 9");
    put_pixel(file, 150, 1, 2, 129);
    for (int k = 0; k < 6; k++) put_run(file, 0);
    put_run(file, 1); /* times 256^6 */
    put_pixel(file, 150, 1, 2, 129);
    put_run(file, 200);
    expect_alike(file, 9, 2, 150, 1, 2, 129);
}

static void check_black(bytes *file) {
    begin(file, "#?RADIANCE\n", "-Y 1 +X 2");
    put_pixel(file, 0, 0, 0, 140);
    put_pixel(file, 0, 0, 0, 0);
    hdr_picture p;
    CHECK(load(&p, file), "%s", p.fault);
    for (size_t i = 0; p.pixel && i < 2; i++) {
        float c[3];
        hdr_color(&p, i, c);
        CHECK(c[0] == 0 && c[1] == 0 && c[2] == 0, "%g %g %g", (double)c[0], (double)c[1], (double)c[2]);
    }
    free(p.pixel);
}

static void check_another_width(bytes *file) {
    begin(file, "#?RADIANCE\n", "-Y 2 +X 20");
    put_coded(file, 20, 200, 0, 255, 131);
    put_coded(file, 21, 200, 0, 255, 131);
    expect_fault(file, "scan line 2 is coded for a width of 21 instead of 20");
}

static void check_channels_beyond(bytes *file) {
    for (int run = 0; run < 2; run++) {
        begin(file, "#?RADIANCE\n", "-Y 1 +X 8");
        put_pixel(file, 2, 2, 0, 8);
        put_alike(file, 7, 3);
        if (run) put_alike(file, 2, 3);
        else put(file, "\002ab", 3);
        expect_fault(file, "a run in scan line 1 goes beyond its end");
    }
}

static void test_scanlines(void) {
    static const uint32_t widths[] = {1, 2, 7, 8, 9, 127, 128, 129, 255, 32767};
    static bytes file;
    mcst_group("scan lines");
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) check_width(&file, widths[i]);
    if (mcst_case("width 40000, flat and runs of pixels")) check_width_40000(&file);
    if (mcst_case("literal channels and empty codes")) check_literals(&file);
    if (mcst_case("a literal of 128")) check_literal_of_128(&file);
    if (mcst_case("what looks like a code where none can be")) check_no_code(&file);
    if (mcst_case("each run has its own bytes")) check_own_bytes(&file);
    if (mcst_case("runs of pixels beyond the line, and of none")) check_runs_beyond(&file);
    if (mcst_case("black with an exponent")) check_black(&file);
    if (mcst_case("another width")) check_another_width(&file);
    if (mcst_case("a run of channels beyond the line")) check_channels_beyond(&file);
}

/* ---- Colours ---- */

static void expect_matrix(const char *lines, const double m[3][3], double tolerance) {
    static bytes file;
    begin(&file, lines, "-Y 1 +X 1");
    put_pixel(&file, 200, 150, 100, 130);
    hdr_picture p;
    CHECK(load(&p, &file), "%s", p.fault);
    if (!p.pixel) return;
    float c[3];
    hdr_color(&p, 0, c);
    for (int i = 0; i < 3; i++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) {
            CHECK(fabs(p.matrix.m[i][k] - m[i][k]) <= tolerance, "[%d][%d] %g instead of %g", i, k, p.matrix.m[i][k],
                  m[i][k]);
            sum += p.matrix.m[i][k] * (200.5 - 50 * k) / 64;
        }
        sum = fmax(sum, 0);
        CHECK(fabs((double)c[i] - sum) <= 1e-6 * fabs(sum), "channel %d: %.9g instead of %.9g", i, (double)c[i], sum);
    }
    free(p.pixel);
}

/* Sums of rows: what becomes of (1, 1, 1). */
static void expect_white(const char *lines) {
    static bytes file;
    begin(&file, lines, "-Y 1 +X 1");
    put_pixel(&file, 128, 128, 128, 129);
    hdr_picture p;
    CHECK(load(&p, &file), "%s", p.fault);
    float c[3] = {0, 0, 0};
    if (p.pixel) hdr_color(&p, 0, c);
    for (int k = 0; k < 3; k++) CHECK(fabs((double)c[k] - 128.5 / 128) < 1e-6, "channel %d: %.9g", k, (double)c[k]);
    free(p.pixel);
}

/* Published matrices, rounded to four digits or made with whites of four digits: hence the tolerances. */
static void test_colours(void) {
    static const double as_is[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const double scaled[3][3] = {{1 / 12.0, 0, 0}, {0, 1 / 3.0, 0}, {0, 0, 1 / 1.5}};
    /* ITU-R BT.2087: BT.2020 to BT.709 */
    static const double from2020[3][3] = {
        {1.6605, -0.5876, -0.0728}, {-0.1246, 1.1329, -0.0083}, {-0.0182, -0.1006, 1.1187}};
    /* IEC 61966-2-1: XYZ to sRGB */
    static const double srgb[3][3] = {{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}};
    /* Lindbloom, "RGB/XYZ matrices": XYZ of D50 to sRGB, by Bradford's adaptation */
    static const double srgb50[3][3] = {
        {3.1338561, -1.6168667, -0.4906146}, {-0.9787684, 1.9161415, 0.0334540}, {0.0719453, -0.2289914, 1.4052427}};
    mcst_group("colours");
    if (mcst_case("as they are")) expect_matrix("#?RADIANCE\n", as_is, 0);
    if (mcst_case("EXPOSURE and COLORCORR"))
        expect_matrix("#?RADIANCE\nEXPOSURE=2\nCOLORCORR=4 1 .5\nEXPOSURE=1.5\n", scaled, 1e-15);
    if (mcst_case("PRIMARIES of Rec. 709")) /* is a conversion, but to the same */
        expect_matrix("#?RADIANCE\nPRIMARIES=.64 .33 .3 .6 .15 .06 .3127 .329\n", as_is, 1e-12);
    if (mcst_case("PRIMARIES of Rec. 2020"))
        expect_matrix("#?RADIANCE\nPRIMARIES= 0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290\n", from2020, 0.6e-4);
    if (mcst_case("COLORCORR goes before PRIMARIES")) {
        static const double corrected[3][3] = {{1.6605 / 2, -0.5876 / 4, -0.0728 * 2},
                                               {-0.1246 / 2, 1.1329 / 4, -0.0083 * 2},
                                               {-0.0182 / 2, -0.1006 / 4, 1.1187 * 2}};
        expect_matrix("#?RADIANCE\nPRIMARIES= .708 .292 .170 .797 .131 .046 .3127 .329\nCOLORCORR=2 4 .5\n", corrected,
                      1.2e-4);
    }
    if (mcst_case("the last PRIMARIES count"))
        expect_matrix("#?RGBE\nPRIMARIES=.5 .3 .2 .6 .2 .1 .3 .3\nPRIMARIES=.64 .33 .3 .6 .15 .06 .3127 .329\n", as_is,
                      1e-12);
    if (mcst_case("XYZ with a white of D65"))
        expect_matrix("#?RADIANCE\nFORMAT=32-bit_rle_xyze\nPRIMARIES=1 0 0 1 0 0 .3127 .3290\n", srgb, 5e-4);
    if (mcst_case("XYZ with a white of D50"))
        expect_matrix("#?RADIANCE\nFORMAT=32-bit_rle_xyze\nPRIMARIES=1 0 0 1 0 0 .34567 .35850\n", srgb50, 5e-4);
    if (mcst_case("white stays white")) {
        expect_white("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n");
        expect_white("#?RADIANCE\nPRIMARIES= .640 .330 .290 .600 .150 .060 .3333 .3333\n"); /* Radiance's own */
        expect_white(
            "#?RADIANCE\nPRIMARIES= .7347 .2653 0 1 .0001 -.077 .32168 .33767\n"); /* ACES 2065-1, an imaginary blue */
    }
    if (mcst_case("EXPOSURE goes with PRIMARIES"))
        expect_white("#?RADIANCE\nEXPOSURE=.5\nPRIMARIES= .64 .33 .29 .6 .15 .06 .3333 .3333\nEXPOSURE=2\n");
    if (mcst_case("bright and dark")) { /* clipped at HDR_MOST after the scale */
        static bytes file;
        begin(&file, "#?RADIANCE\nCOLORCORR=1 1e20 1e-20\n", "-Y 1 +X 2");
        put_pixel(&file, 255, 255, 255, 200);
        put_pixel(&file, 255, 0, 255, 1);
        hdr_picture p;
        CHECK(load(&p, &file), "%s", p.fault);
        if (p.pixel) {
            float c[3];
            hdr_color(&p, 0, c);
            CHECK(c[0] == HDR_MOST && c[2] == HDR_MOST, "%g %g", (double)c[0], (double)c[2]);
            CHECK(fabs((double)c[1] / (255.5 * ldexp(1, 64) / 1e20) - 1) < 1e-6, "%g", (double)c[1]);
            hdr_color(&p, 1, c);
            CHECK(fabs((double)c[2] / (255.5 * ldexp(1, -135) * 1e20) - 1) < 1e-6, "%g", (double)c[2]);
        }
        free(p.pixel);
    }
}

/* ---- Damage ---- */

enum { KINDS = 4 };

/* A small picture of each kind of scan line, with all the settings. */
static void make_kind(bytes *file, int kind) {
    static const char *const lines[KINDS] = {
        "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n", "#?RGBE\nFORMAT=32-bit_rle_xyze\nEXPOSURE=2.5\nCOLORCORR=1 2 .5\n",
        "#?RADIANCE\n# made\nPRIMARIES=.64 .33 .29 .6 .15 .06 .3333 .3333\nFORMAT=32-bit_rle_rgbe\n", "#?RADIANCE\n"};
    static const char *const resolution[KINDS] = {"-Y 3 +X 9\r", "+X 4 -Y 12", "+Y 2 -X 300", "-Y 4 +X 5"};
    begin(file, lines[kind], resolution[kind]);
    switch (kind) {
    case 0:
        for (int i = 0; i < 3; i++) put_coded(file, 9, 128 + i, i, 3 * i, 129);
        break;
    case 1:
        for (int i = 0; i < 4; i++) {
            put_pixel(file, 2, 2, 0, 12);
            for (int channel = 0; channel < 4; channel++) {
                put_alike(file, 5, 131);
                put(file, "\007abcdefg", 8);
            }
        }
        break;
    case 2:
        for (int i = 0; i < 2; i++) {
            put_pixel(file, 130 + i, 7, 9, 128);
            put_run(file, 299 - 256);
            put_run(file, 1);
        }
        break;
    default:
        for (int i = 0; i < 20; i++) put_numbered(file, i);
    }
}

/* Either a fault or a whole picture with colours that a renderer can use; and no more memory than twice what was
 * decoded, one coded scan line or the first block. */
static int check_damaged(const bytes *file) {
    hdr_picture p;
    const int ok = load(&p, file);
    if (ok) {
        CHECK(p.w > 0 && p.h > 0 && p.pixel, "%u x %u", p.w, p.h);
        for (size_t i = 0; i < (size_t)p.w * p.h; i++) {
            float c[3];
            hdr_color(&p, i, c);
            for (int k = 0; k < 3; k++) CHECK(c[k] >= 0 && c[k] <= HDR_MOST, "pixel %d: %g", (int)i, (double)c[k]);
        }
    } else {
        check_fault(&p);
    }
    CHECK(most_asked <= 8 * (p.done + 32767), "%lu bytes for %lu pixels", (unsigned long)most_asked,
          (unsigned long)p.done);
    free(p.pixel);
    return ok;
}

static uint32_t below(mcs_pcg32 *rng, uint32_t n) { return (uint32_t)((uint64_t)mcs_pcg32_next(rng) * n >> 32); }

static void test_damage(void) {
    static bytes file, damaged;
    mcst_group("damage");
    for (int kind = 0; kind < KINDS; kind++) {
        make_kind(&file, kind);
        if (mcst_case("kind %d, whole", kind)) CHECK(check_damaged(&file), "refused");
        if (mcst_case("kind %d, truncated anywhere", kind)) {
            for (size_t n = 0; n < file.n; n++) {
                damaged.n = 0;
                put(&damaged, file.byte, n);
                CHECK(!check_damaged(&damaged), "read from %d of %d bytes", (int)n, (int)file.n);
            }
        }
        if (mcst_case("kind %d, bits flipped", kind)) {
            for (size_t bit = 0; bit < 8 * file.n; bit++) {
                damaged.n = 0;
                put(&damaged, file.byte, file.n);
                damaged.byte[bit / 8] ^= (unsigned char)(1 << bit % 8);
                check_damaged(&damaged);
            }
        }
        if (mcst_case("kind %d, random bytes", kind)) {
            mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, (uint64_t)(77 + kind));
            int read = 0;
            for (int i = 0; i < 5000; i++) {
                damaged.n = 0;
                put(&damaged, file.byte, file.n);
                for (uint32_t k = below(&rng, 8) + 1; k > 0; k--)
                    damaged.byte[below(&rng, (uint32_t)file.n)] = (unsigned char)below(&rng, 256);
                read += check_damaged(&damaged);
            }
            CHECK(read > 50 && read < 4950, "%d of 5000 were read", read); /* both ways are taken */
        }
    }
    if (mcst_case("sizes without pixels")) {
        static const char *const resolution[] = {"-Y 11585 +X 11585", "-Y 1 +X 134217728", "-Y 134217728 +X 1",
                                                 "+X 32767 -Y 4096"};
        for (int i = 0; i < 4; i++) {
            for (int pixels = 0; pixels < 3; pixels++) {
                begin(&file, "#?RADIANCE\n", resolution[i]);
                for (int k = 0; k < pixels; k++) put_pixel(&file, 130, 1, 2, 128);
                expect_fault(&file, "the file ends in scan line");
                CHECK(most_asked <= 1 << 16, "%s: %lu bytes", resolution[i], (unsigned long)most_asked);
            }
        }
    }
    if (mcst_case("too little memory")) {
        begin(&file, "#?RADIANCE\n", "-Y 2 +X 100000");
        put_pixel(&file, 130, 1, 2, 128);
        for (int k = 0; k < 3; k++) put_run(&file, 255);
        granted = 1;
        hdr_picture p;
        CHECK(!load(&p, &file) && strstr(p.fault, "not enough memory"), "'%s'", p.fault);
        check_fault(&p);
        granted = ALWAYS;
    }
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    test_bias();
    test_pixels();
    test_headers();
    test_orientations();
    test_scanlines();
    test_colours();
    test_damage();
    return mcst_finish();
}
