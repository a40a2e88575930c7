/* gallery_draw.h - what gallery.c draws with: each stroke goes into a picture of pixels, the sheet, and into an SVG
 * file, the one of its group, at the same coordinates. */
#ifndef GALLERY_DRAW_H
#define GALLERY_DRAW_H
#include "bench/svg.h"
#include "gallery_font.h"
#include "render_png.h"

typedef struct {
    unsigned char c[3]; /* red, green, blue */
} color;

static const color WHITE = {{255, 255, 255}};
static const color BLACK = {{0, 0, 0}};
static const color GREY = {{96, 96, 96}};

typedef struct {
    svg_plot group;     /* only its file is used */
    unsigned char *rgb; /* of the sheet, w x h */
    unsigned w, h;
} drawing;

static void put_pixel(drawing *d, int x, int y, color ink, double cover) {
    if (x < 0 || y < 0 || (unsigned)x >= d->w || (unsigned)y >= d->h || cover <= 0) return;
    unsigned char *p = d->rgb + 3 * ((size_t)y * d->w + (size_t)x);
    for (int i = 0; i < 3; i++) p[i] = (unsigned char)(p[i] + (ink.c[i] - p[i]) * fmin(cover, 1) + 0.5);
}

/* A line with round ends on the sheet alone; a dot, where both ends are one. */
static void put_line(drawing *d, const double *from, const double *to, double width, color ink) {
    const double dx = to[0] - from[0];
    const double dy = to[1] - from[1];
    const double square = dx * dx + dy * dy;
    const double r = width / 2;
    for (int y = (int)floor(fmin(from[1], to[1]) - r - 1); y <= fmax(from[1], to[1]) + r + 1; y++)
        for (int x = (int)floor(fmin(from[0], to[0]) - r - 1); x <= fmax(from[0], to[0]) + r + 1; x++) {
            const double px = x + 0.5 - from[0];
            const double py = y + 0.5 - from[1];
            const double t = square > 0 ? fmax(0, fmin(1, (px * dx + py * dy) / square)) : 0;
            put_pixel(d, x, y, ink, r + 0.5 - hypot(px - t * dx, py - t * dy));
        }
}

static void draw_dot(drawing *d, double x, double y, double width, color ink) {
    const double at[2] = {x, y};
    put_line(d, at, at, width, ink);
    fprintf(d->group.out, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" fill=\"#%02x%02x%02x\"/>\n", x, y, width / 2,
            ink.c[0], ink.c[1], ink.c[2]);
}

static void draw_curve(drawing *d, int n, const double (*at)[2], double width, color ink) {
    fprintf(d->group.out, "<path fill=\"none\" stroke=\"#%02x%02x%02x\" stroke-width=\"%.1f\" d=\"", ink.c[0], ink.c[1],
            ink.c[2], width);
    for (int i = 0; i < n; i++) {
        if (i > 0) put_line(d, at[i - 1], at[i], width, ink);
        fprintf(d->group.out, "%c%.2f %.2f", i > 0 ? 'L' : 'M', at[i][0], at[i][1]);
    }
    fprintf(d->group.out, "\"/>\n");
}

/* A box from its left top corner; its height may end within a pixel. */
static void draw_box(drawing *d, const double *at, double w, double h, color ink) {
    for (int y = (int)floor(at[1]); y < at[1] + h; y++)
        for (int x = (int)floor(at[0]); x < at[0] + w; x++) {
            const double across = fmin(at[0] + w, x + 1) - fmax(at[0], x);
            const double down = fmin(at[1] + h, y + 1) - fmax(at[1], y);
            put_pixel(d, x, y, ink, across * down);
        }
    fprintf(d->group.out, "<path fill=\"#%02x%02x%02x\" d=\"M%.2f %.2fh%.2fv%.2fh%.2fz\"/>\n", ink.c[0], ink.c[1],
            ink.c[2], at[0], at[1], w, h, -w);
}

/* Text on the sheet alone, in glyphs of 5 x 8 dots of the given size, from their left top corner. Bold dots are wider by
 * half. */
static void put_text(drawing *d, const double *at, int size, int bold, color ink, const char *text) {
    for (int i = 0; text[i]; i++)
        for (int column = 0; column < 5; column++)
            for (int row = 0; row < 8; row++) {
                if (!(glyph_column(text[i], column) >> row & 1)) continue;
                const int left = (int)at[0] + size * (6 * i + column);
                const int top = (int)at[1] + size * row;
                for (int k = 0; k < size * size; k++) put_pixel(d, left + k % size, top + k / size, ink, 1);
                for (int k = 0; bold && k < size; k++) put_pixel(d, left + size, top + k, ink, 0.5);
            }
}

static void draw_text(drawing *d, const double *at, int size, int bold, color ink, const char *text) {
    put_text(d, at, size, bold, ink, text);
    fprintf(d->group.out,
            "<text font-family=\"monospace\" font-size=\"%d\" font-weight=\"%s\" fill=\"#%02x%02x%02x\" "
            "x=\"%.1f\" y=\"%.1f\">",
            10 * size, bold ? "bold" : "normal", ink.c[0], ink.c[1], ink.c[2], at[0], at[1] + 7 * size);
    svg_text(&d->group, text);
    fprintf(d->group.out, "</text>\n");
}

/* ---- pictures of pixels ---- */

static void put_picture(drawing *d, const unsigned char *rgb, unsigned side, const double *at) {
    for (unsigned i = 0; i < side * side; i++) {
        const color c = {{rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}};
        put_pixel(d, (int)at[0] + (int)(i % side), (int)at[1] + (int)(i / side), c, 1);
    }
}

static void write_base64(FILE *f, const unsigned char *data, size_t n) {
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        const unsigned b1 = i + 1 < n ? data[i + 1] : 0;
        const unsigned b2 = i + 2 < n ? data[i + 2] : 0;
        const unsigned three = (unsigned)data[i] << 16 | b1 << 8 | b2;
        fprintf(f, "%c%c%c%c", digit[three >> 18], digit[three >> 12 & 63], i + 1 < n ? digit[three >> 6 & 63] : '=',
                i + 2 < n ? digit[three & 63] : '=');
    }
}

/* A square picture into the SVG file alone, shown at `at` and at `again`, w wide. Returns 0 without memory. */
static int embed_picture(drawing *d, const unsigned char *rgb, unsigned side, const double at[2][2], double w) {
    size_t size = 0;
    unsigned char *png = png_make(rgb, NULL, side, side, &size);
    if (!png) return 0;
    fprintf(d->group.out, "<image id=\"at%.0f-%.0f\" x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\" href=\"",
            at[0][0], at[0][1], at[0][0], at[0][1], w, w);
    fprintf(d->group.out, "data:image/png;base64,");
    write_base64(d->group.out, png, size);
    fprintf(d->group.out, "\"/>\n<use href=\"#at%.0f-%.0f\" x=\"%.0f\"/>\n", at[0][0], at[0][1], at[1][0] - at[0][0]);
    free(png);
    return 1;
}

/* ---- files ---- */

/* Begins the SVG file of a group that reaches from `top` to `bottom` on the sheet. Returns 0 where it cannot. */
static int begin_group(drawing *d, const char *file, int top, int bottom) {
    d->group.out = fopen(file, "w");
    if (!d->group.out) return 0;
    fprintf(d->group.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%u\" height=\"%d\" viewBox=\"0 %d %u %d\">\n"
            "<rect y=\"%d\" width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            d->w, bottom - top, top, d->w, bottom - top, top);
    return 1;
}

static int end_group(drawing *d) { return svg_end(&d->group) == 0; }

/* Kinds of colours: the upper 5 bits of each channel. */
enum { KINDS = 1 << 15, COLORS = 256 };
typedef struct {
    unsigned long pixels, sum[3];
} kind;

static unsigned kind_of(const unsigned char *c) { return (c[0] >> 3u) * 1024u + (c[1] >> 3u) * 32u + (c[2] >> 3u); }

/* The palette becomes the means of the 256 commonest kinds. */
static void choose_palette(const drawing *d, unsigned char *palette) {
    static kind kinds[KINDS];
    memset(kinds, 0, sizeof kinds);
    for (size_t i = 0; i < (size_t)d->w * d->h; i++) {
        kind *k = &kinds[kind_of(d->rgb + 3 * i)];
        k->pixels++;
        for (int j = 0; j < 3; j++) k->sum[j] += d->rgb[3 * i + (size_t)j];
    }
    for (int n = 0; n < COLORS; n++) {
        kind *most = kinds;
        for (kind *k = kinds; k < kinds + KINDS; k++)
            if (k->pixels > most->pixels) most = k;
        for (int j = 0; j < 3; j++)
            palette[3 * n + j] = (unsigned char)(most->pixels ? most->sum[j] / most->pixels : 0);
        most->pixels = 0;
    }
}

static unsigned char nearest_color(const unsigned char *c, const unsigned char *palette) {
    int best = 0;
    long least = 1L << 30;
    for (int n = 0; n < COLORS; n++) {
        long square = 0;
        for (int j = 0; j < 3; j++) square += (c[j] - palette[3 * n + j]) * (c[j] - palette[3 * n + j]);
        if (square < least) {
            least = square;
            best = n;
        }
    }
    return (unsigned char)best;
}

/* A palette makes the file a third as long. */
static int write_sheet(const drawing *d, const char *file) {
    static short known[KINDS];
    unsigned char palette[3 * COLORS];
    size_t size = 0;
    unsigned char *index = malloc((size_t)d->w * d->h);
    choose_palette(d, palette);
    for (int i = 0; i < KINDS; i++) known[i] = -1;
    for (size_t i = 0; index && i < (size_t)d->w * d->h; i++) {
        short *k = &known[kind_of(d->rgb + 3 * i)];
        if (*k < 0) *k = nearest_color(d->rgb + 3 * i, palette);
        index[i] = (unsigned char)*k;
    }
    unsigned char *png = index ? png_make(index, palette, d->w, d->h, &size) : NULL;
    FILE *f = png ? fopen(file, "wb") : NULL;
    int ok = f && fwrite(png, 1, size, f) == size;
    if (f && fclose(f) != 0) ok = 0;
    free(png);
    free(index);
    return ok;
}

#endif
