/* A plot as an SVG file: scatter or line series over log or linear axes, with grid, ticks and a legend.
 *
 *     svg_plot p;
 *     svg_begin(&p, "file.svg", "title", "time, ns", "error, ulp", 1, 1, xmin, xmax, ymin, ymax);   the flags: log axis
 *     svg_series(&p, "name", n, x, y, SVG_LINE);      the first call gets the first marker, dash and colour
 *     svg_keep_off(&p, n, x, y);                      no label is to lie on the marks of these points
 *     svg_label(&p, x, y, "text");                    beside a point, or not at all where there is no room
 *     svg_note(&p, "text");                           a line below the legend
 *     svg_link(&p, from, to);                         a thin line from (from[0], from[1])
 *     svg_better(&p);                                 lower left is better
 *     if (svg_end(&p)) fail;
 *
 * Series differ in marker shape and dash pattern, so that no colour is needed to tell them apart (colours: Okabe and
 * Ito 2008, which the colour-blind can tell apart too). Points that an axis cannot show (not finite, not positive on a
 * log axis, outside of the limits) are left out; lines are cut at the frame. */
#ifndef BENCH_SVG_H
#define BENCH_SVG_H
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SVG_POINTS, SVG_LINE, SVG_LINE_ONLY }; /* markers; markers joined by a line; a line without markers */
enum { SVG_W = 1000, SVG_H = 600, SVG_L = 84, SVG_R = 770, SVG_T = 50, SVG_B = 530 }; /* sheet and frame in pixels */
enum { SVG_SHAPES = 8, SVG_BOXES = 512 };

typedef struct {
    FILE *out;
    int log[2], series, row; /* axis 0: x, 1: y; rows of the legend used */
    double min[2], max[2];
    int boxes;
    double box[SVG_BOXES][4]; /* left, right, top, bottom of what labels keep off: marks, other labels */
} svg_plot;

/* Widens [*lo, *hi] (empty while lo > hi) to hold the values that a log or linear axis can show. */
static inline void svg_range(int n, const double *v, int is_log, double *lo, double *hi) {
    for (int i = 0; i < n; i++) {
        if (!isfinite(v[i]) || (is_log && v[i] <= 0)) continue;
        if (*lo > *hi) *lo = *hi = v[i];
        if (v[i] < *lo) *lo = v[i];
        if (v[i] > *hi) *hi = v[i];
    }
}

static inline void svg_text(svg_plot *p, const char *s) {
    for (; *s; s++) {
        switch (*s) {
        case '<': fputs("&lt;", p->out); break;
        case '>': fputs("&gt;", p->out); break;
        case '&': fputs("&amp;", p->out); break;
        default: putc(*s, p->out);
        }
    }
}

static inline double svg_at(const svg_plot *p, int axis, double v) {
    const double lo = p->min[axis];
    const double hi = p->max[axis];
    const double t = p->log[axis] ? (log(v) - log(lo)) / (log(hi) - log(lo)) : (v - lo) / (hi - lo);
    return axis ? SVG_B - t * (SVG_B - SVG_T) : SVG_L + t * (SVG_R - SVG_L);
}

static inline void svg_tick(svg_plot *p, int axis, double v, int labelled) {
    const double at = svg_at(p, axis, v);
    const int e = (int)floor(log10(fabs(v) > 0 ? fabs(v) : 1) + 1e-9);
    if (!(v >= p->min[axis] * (1 - 1e-9) && v <= p->max[axis] * (1 + 1e-9)) && v != 0) return;
    fprintf(p->out, "<path d=\"M%.1f %.1f%c%.1f\" stroke=\"%s\"/>\n", axis ? (double)SVG_L : at,
            axis ? at : (double)SVG_B, axis ? 'H' : 'V', (double)(axis ? SVG_R : SVG_T),
            labelled ? "#c8c8c8" : "#ececec");
    if (!labelled) return;
    fprintf(p->out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", axis ? SVG_L - 8.0 : at,
            axis ? at + 5 : SVG_B + 22.0, axis ? "end" : "middle");
    if (p->log[axis] && (e < -3 || e > 4)) {
        if (v > 1.5 * pow(10, e)) fprintf(p->out, "%.0f&#183;", v / pow(10, e));
        fprintf(p->out, "10<tspan dy=\"-6\" font-size=\"11\">%d</tspan></text>\n", e);
    } else {
        fprintf(p->out, "%g</text>\n", v);
    }
}

static inline void svg_axis(svg_plot *p, int axis) {
    const double lo = p->min[axis];
    const double hi = p->max[axis];
    if (p->log[axis]) {
        const int first = (int)floor(log10(lo));
        const int last = (int)ceil(log10(hi));
        const double decades = log10(hi / lo);
        const int step = decades > 20 ? 5 : decades > 10 ? 2 : 1;
        for (int e = first; e <= last; e++) {
            for (int m = 1; m < 10; m++) {
                const int labelled = m == 1          ? e % step == 0
                                     : decades < 1.3 ? m < 6 || m == 8
                                                     : decades < 3 && (m == 2 || m == 5);
                if (m == 1 || decades < 8) svg_tick(p, axis, (double)m * pow(10, e), labelled);
            }
        }
    } else {
        const double raw = (hi - lo) / 7;
        const double unit = pow(10, floor(log10(raw)));
        double step = raw / unit > 5 ? 10 : raw / unit > 2 ? 5 : 2;
        step *= raw / unit > 1 ? unit : unit / 2;
        for (double v = ceil(lo / step - 1e-9); v * step <= hi * (1 + 1e-9); v++) svg_tick(p, axis, v * step + 0.0, 1);
    }
}

static inline void svg_begin(svg_plot *p, const char *file, const char *title, const char *xlabel, const char *ylabel,
                             int xlog, int ylog, double xmin, double xmax, double ymin, double ymax) {
    p->out = fopen(file, "w");
    p->series = p->row = p->boxes = 0;
    p->log[0] = xlog;
    p->log[1] = ylog;
    p->min[0] = xmin;
    p->max[0] = xmax;
    p->min[1] = ymin;
    p->max[1] = ymax;
    if (!p->out) return;
    fprintf(p->out, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\"", SVG_W,
            SVG_H, SVG_W, SVG_H);
    fprintf(p->out, " font-family=\"Helvetica, Arial, sans-serif\" font-size=\"15\" fill=\"none\">\n<title>");
    svg_text(p, title);
    fprintf(p->out, "</title>\n<rect width=\"%d\" height=\"%d\" fill=\"white\"/>\n", SVG_W, SVG_H);
    fprintf(p->out, "<clipPath id=\"frame\"><rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/></clipPath>\n", SVG_L,
            SVG_T, SVG_R - SVG_L, SVG_B - SVG_T);
    fprintf(p->out, "<g fill=\"black\">\n");
    svg_axis(p, 0);
    svg_axis(p, 1);
    fprintf(p->out, "<text x=\"%d\" y=\"%d\" font-size=\"18\" font-weight=\"bold\">", SVG_L, SVG_T - 20);
    svg_text(p, title);
    fprintf(p->out, "</text>\n<text x=\"%d\" y=\"%d\" text-anchor=\"middle\" font-size=\"16\">", (SVG_L + SVG_R) / 2,
            SVG_B + 52);
    svg_text(p, xlabel);
    fprintf(p->out,
            "</text>\n<text transform=\"translate(22 %d) rotate(-90)\" text-anchor=\"middle\" font-size=\"16\">",
            (SVG_T + SVG_B) / 2);
    svg_text(p, ylabel);
    fprintf(p->out, "</text>\n</g>\n<path d=\"M%d %dH%dV%dH%dZ\" stroke=\"black\"/>\n", SVG_L, SVG_T, SVG_R, SVG_B,
            SVG_L);
}

static inline void svg_mark(svg_plot *p, int series, double x, double y) {
    static const char *const path[SVG_SHAPES] = {"m-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z",
                                                 "m-4.5 -4.5h9v9h-9z",
                                                 "m0 -6l5.5 10h-11z",
                                                 "m0 -6.5l6 6.5l-6 6.5l-6 -6.5z",
                                                 "m0 6l5.5 -10h-11z",
                                                 "m-5 -5l10 10m0 -10l-10 10",
                                                 "m0 -6v12m-6 -6h12",
                                                 "m-5 -3l10 6m0 -6l-10 6m5 -9v12"};
    fprintf(p->out, "<path d=\"M%.1f %.1f%s\"/>\n", x, y, path[series % SVG_SHAPES]);
}

static inline void svg_style(svg_plot *p, int series) {
    static const char *const colour[SVG_SHAPES] = {"#000000", "#0072b2", "#d55e00", "#009e73",
                                                   "#cc79a7", "#56b4e9", "#8a6d00", "#7f3c8d"};
    const char *c = colour[series % SVG_SHAPES];
    const int open = series % SVG_SHAPES > 4 ||
                     series / SVG_SHAPES % 2; /* crosses have no inside; from the ninth on, hollow marks */
    fprintf(p->out, "<g stroke=\"%s\" fill=\"%s\" stroke-width=\"1.8\">\n", c, open ? "white" : c);
}

static inline void svg_stroke(svg_plot *p, int series, double x, double y) { /* opens a path at (x, y) */
    static const char *const dash[SVG_SHAPES] = {"", "9 4", "2 3", "9 3 2 3", "5 3", "14 4", "9 3 2 3 2 3", "1 5"};
    fprintf(p->out, "<path fill=\"none\" stroke-dasharray=\"%s\" d=\"M%.1f %.1f", dash[series % SVG_SHAPES], x, y);
}

static inline void svg_series(svg_plot *p, const char *name, int n, const double *x, const double *y, int kind) {
    const int s = p->series++;
    int joined = 0;
    const double ly = SVG_T + 14.0 + 24.0 * p->row++;
    if (!p->out) return;
    svg_style(p, s);
    fprintf(p->out, "<g clip-path=\"url(#frame)\">\n");
    if (kind != SVG_POINTS) {
        for (int i = 0; i < n; i++) {
            if (!isfinite(x[i]) || !isfinite(y[i]) || (p->log[0] && x[i] <= 0) || (p->log[1] && y[i] <= 0)) continue;
            if (!joined++) svg_stroke(p, s, svg_at(p, 0, x[i]), svg_at(p, 1, y[i]));
            else fprintf(p->out, "L%.1f %.1f", svg_at(p, 0, x[i]), svg_at(p, 1, y[i]));
        }
        if (joined) fprintf(p->out, "\"/>\n");
    }
    fprintf(p->out, "</g>\n");
    for (int i = 0; i < n && kind != SVG_LINE_ONLY; i++)
        if (x[i] >= p->min[0] && x[i] <= p->max[0] && y[i] >= p->min[1] && y[i] <= p->max[1])
            svg_mark(p, s, svg_at(p, 0, x[i]), svg_at(p, 1, y[i]));
    if (kind != SVG_POINTS) {
        svg_stroke(p, s, SVG_R + 16, ly);
        fprintf(p->out, "h40\"/>\n");
    }
    if (kind != SVG_LINE_ONLY) svg_mark(p, s, SVG_R + 36, ly);
    fprintf(p->out, "</g>\n<text fill=\"black\" x=\"%d\" y=\"%.1f\">", SVG_R + 66, ly + 5);
    svg_text(p, name);
    fprintf(p->out, "</text>\n");
}

/* A thin line between two points, cut at the frame. */
static inline void svg_link(svg_plot *p, const double *from, const double *to) {
    if (!p->out) return;
    fprintf(p->out,
            "<path clip-path=\"url(#frame)\" stroke=\"#808080\" stroke-width=\"1.5\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n",
            svg_at(p, 0, from[0]), svg_at(p, 1, from[1]), svg_at(p, 0, to[0]), svg_at(p, 1, to[1]));
}

/* Says in the lower left corner that it is the place to be, with an arrow to it. */
static inline void svg_better(svg_plot *p) {
    if (!p->out) return;
    fprintf(p->out, "<path stroke=\"#009e73\" stroke-width=\"2.5\" d=\"M%d %dl-18 18m0 -11v11h11\"/>\n", SVG_L + 30,
            SVG_B - 30);
    fprintf(p->out, "<text fill=\"#009e73\" font-weight=\"bold\" x=\"%d\" y=\"%d\">lower left is better</text>\n",
            SVG_L + 38, SVG_B - 16);
}

static inline void svg_keep_box(svg_plot *p, double left, double right, double top, double bottom) {
    if (p->boxes == SVG_BOXES) return;
    double *box = p->box[p->boxes];
    box[0] = left;
    box[1] = right;
    box[2] = top;
    box[3] = bottom;
    p->boxes++;
}

static inline void svg_keep_off(svg_plot *p, int n, const double *x, const double *y) {
    for (int i = 0; i < n; i++) {
        const double at[2] = {svg_at(p, 0, x[i]), svg_at(p, 1, y[i])};
        svg_keep_box(p, at[0] - 6, at[0] + 6, at[1] - 6, at[1] + 6);
    }
}

static inline void svg_label(svg_plot *p, double x, double y, const char *s) {
    /* tried in this order; from the point, negative: the text ends there */
    static const int place[][2] = {{9, 4}, {-9, 4}, {9, 16}, {9, -8}, {-9, 16}, {-9, -8}, {9, -20}, {-9, -20}};
    const double width = 6.7 * (double)strlen(s); /* of the widest of the fonts, at 12 pixels */
    if (!p->out) return;
    for (int i = 0; i < (int)(sizeof place / sizeof *place); i++) {
        const double left = svg_at(p, 0, x) + place[i][0] - (place[i][0] < 0 ? width : 0);
        const double base = svg_at(p, 1, y) + place[i][1];
        if (left < SVG_L || left + width > SVG_R || base > SVG_B || base < SVG_T + 12) continue;
        int k;
        for (k = 0; k < p->boxes; k++)
            if (left < p->box[k][1] && left + width > p->box[k][0] && base - 10 < p->box[k][3] &&
                base + 3 > p->box[k][2])
                break;
        if (k < p->boxes) continue;
        svg_keep_box(p, left, left + width, base - 10, base + 3);
        fprintf(p->out,
                "<text fill=\"#303030\" stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\" font-size=\"12\" "
                "text-anchor=\"%s\" x=\"%.1f\" y=\"%.1f\">",
                place[i][0] < 0 ? "end" : "start", place[i][0] < 0 ? left + width : left, base);
        svg_text(p, s);
        fprintf(p->out, "</text>\n");
        return;
    }
}

static inline void svg_note(svg_plot *p, const char *s) {
    const double ly = SVG_T + 19.0 + 24.0 * p->row++;
    if (!p->out) return;
    fprintf(p->out, "<text fill=\"#303030\" font-size=\"13\" x=\"%d\" y=\"%.1f\">", SVG_R + 16, ly);
    svg_text(p, s);
    fprintf(p->out, "</text>\n");
}

/* 0 when the whole file was written. */
static inline int svg_end(svg_plot *p) {
    if (!p->out) return -1;
    fprintf(p->out, "</svg>\n");
    const int bad = ferror(p->out);
    return fclose(p->out) || bad ? -1 : 0;
}
#endif
