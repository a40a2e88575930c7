/* Draws every sampler of mcsample.h: its density as a picture, with samples on top, stratified ones at the left and
 * independent ones at the right.
 *
 *     gallery FOLDER        writes FOLDER/gallery.png, the sheet, and FOLDER/GROUP.svg
 *
 * Densities on a line are curves, over bars that count samples. */
#include "gallery_samplers.h"
#include "gallery_draw.h"

enum { COLUMNS = 4, PANEL = 94, GAP = 4, CELL = 2 * PANEL + GAP, GUTTER = 14, MARGIN = 10 };
enum { HEADING = 28, LABEL = 26, LINE_PANEL = 52, BELOW = 12, TOP = 36 };
enum { DOTS = 128, COUNTED = 256, BINS = 16, ROUND = 64, SUBPIXELS = 3 };

/* ---- projections ---- */

/* The point at (x, y) of a panel of side 1, y down; 0 where there is none. */
static int unproject(projection as, float x, float y, vec3 *p) {
    const float a = 2 * x - 1;
    const float b = 1 - 2 * y;
    const float r2 = a * a + b * b;
    const float sine = as == HEMISPHERE || as == LOBE ? sqrtf(fmaxf(2 - r2, 0)) : 2 * sqrtf(fmaxf(1 - r2, 0));
    const float azimuth = 2 * 3.14159265f * x;
    switch (as) {
    case DISK: *p = vec(a, b, 0); return r2 <= 1;
    case LOBE:
    case HEMISPHERE: *p = vec(a * sine, b * sine, 1 - r2); return r2 <= 1;
    case SPHERE: *p = vec(a * sine, b * sine, 1 - 2 * r2); return r2 <= 1;
    case MAP: *p = vec(2 * sqrtf(y - y * y) * cosf(azimuth), 2 * sqrtf(y - y * y) * sinf(azimuth), b); return 1;
    default: *p = vec(x, 1 - y, 0); return as == SQUARE || x <= y;
    }
}

/* The place of a point in such a panel. */
static void project(projection as, vec3 p, double *at) {
    const double spread = sqrt(as == HEMISPHERE || as == LOBE ? 1.0 + p.z : 2 * (1.0 + p.z));
    const double turn = atan2(p.y, p.x) / 6.283185307;
    at[0] = p.x;
    at[1] = 1 - p.y;
    if (as == DISK || as == HEMISPHERE || as == LOBE || as == SPHERE) {
        const double by = as == DISK ? 1 : spread;
        at[0] = by > 0 ? (1 + p.x / by) / 2 : 1;
        at[1] = by > 0 ? (1 - p.y / by) / 2 : 0.5;
    } else if (as == MAP) {
        at[0] = turn < 0 ? turn + 1 : turn;
        at[1] = (1 - p.z) / 2;
    }
}

/* The points u: a scrambled Sobol sequence, or independent ones. */
static void random_point(int independent, uint32_t i, float *u) {
    mcs_pcg32 rng = mcs_pcg32_for(1, 1, i);
    u[0] = independent ? mcs_pcg32_float(&rng) : mcs_sobol(i, 0, 1);
    u[1] = independent ? mcs_pcg32_float(&rng) : mcs_sobol(i, 1, 1);
}

/* ---- densities in the plane and of directions ---- */

/* Pale where the density is 0, dark blue where it is highest. */
static color heat(double density, double highest) {
    static const double stop[4][3] = {{245, 248, 252}, {190, 215, 238}, {120, 174, 217}, {44, 116, 184}};
    const double t = 3 * sqrt(fmin(density / highest, 1));
    const int i = t < 2 ? (int)t : 2;
    color c;
    for (int k = 0; k < 3; k++) c.c[k] = (unsigned char)(stop[i][k] + (t - i) * (stop[i + 1][k] - stop[i][k]) + 0.5);
    return c;
}

static double highest_density(const sampler *s) {
    double highest = 0;
    for (int i = 0; i < PANEL * PANEL; i++) {
        vec3 p;
        const float x = ((float)(i % PANEL) + 0.5f) / PANEL;
        const float y = ((float)i / PANEL + 0.5f) / PANEL;
        if (unproject(s->as, x, y, &p)) highest = fmax(highest, s->density(p));
    }
    return highest;
}

/* The density as side x side pixels, white where there are no points. */
static void paint(const sampler *s, unsigned side, unsigned char *rgb) {
    const double highest = highest_density(s);
    for (unsigned i = 0; i < side * side; i++) {
        double sum[3] = {0, 0, 0};
        for (unsigned k = 0; k < SUBPIXELS * SUBPIXELS; k++) {
            const float x = ((float)(i % side) + ((float)(k % SUBPIXELS) + 0.5f) / SUBPIXELS) / (float)side;
            const float y = ((float)(i / side) + ((float)(k / SUBPIXELS) + 0.5f) / SUBPIXELS) / (float)side;
            vec3 p;
            const color c = unproject(s->as, x, y, &p) ? heat(s->density(p), highest) : WHITE;
            for (int j = 0; j < 3; j++) sum[j] += c.c[j];
        }
        for (int j = 0; j < 3; j++) rgb[3 * i + (unsigned)j] = (unsigned char)(sum[j] / (SUBPIXELS * SUBPIXELS) + 0.5);
    }
}

/* The border of a panel and, for a lobe, a ring where wo is. */
static void draw_border(drawing *d, const sampler *s, const double *at) {
    double edge[ROUND + 1][2];
    const int corners = s->as == TRIANGLE ? 3 : s->as == SQUARE || s->as == MAP ? 4 : ROUND;
    static const double corner[5][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}, {0, 0}};
    for (int i = 0; i <= corners; i++) {
        const double turn = 6.283185307 * i / ROUND;
        const double *c = corner[s->as == TRIANGLE && i == 3 ? 0 : i % 5];
        edge[i][0] = at[0] + PANEL * (corners < ROUND ? c[0] : (1 + cos(turn)) / 2);
        edge[i][1] = at[1] + PANEL * (corners < ROUND ? c[1] : (1 + sin(turn)) / 2);
    }
    draw_curve(d, corners + 1, (const double(*)[2])edge, 0.8, GREY);
    if (s->as != LOBE) return;
    const color orange = {{213, 94, 0}};
    double wo[2];
    project(s->as, eye, wo);
    for (int i = 0; i <= ROUND; i++) {
        edge[i][0] = at[0] + PANEL * wo[0] + 3 * cos(6.283185307 * i / ROUND);
        edge[i][1] = at[1] + PANEL * wo[1] + 3 * sin(6.283185307 * i / ROUND);
    }
    draw_curve(d, ROUND + 1, (const double(*)[2])edge, 1.4, orange);
}

/* Two panels. Returns 0 without memory. */
static int draw_area(drawing *d, const sampler *s, const double *at) {
    static unsigned char rgb[4 * PANEL * PANEL * 3];
    const double place[2][2] = {{at[0], at[1]}, {at[0] + PANEL + GAP, at[1]}};
    paint(s, 2 * PANEL, rgb);
    if (!embed_picture(d, rgb, 2 * PANEL, place, PANEL)) return 0;
    paint(s, PANEL, rgb);
    for (int independent = 0; independent < 2; independent++) {
        put_picture(d, rgb, PANEL, place[independent]);
        draw_border(d, s, place[independent]);
        for (uint32_t i = 0; i < DOTS; i++) {
            float u[2];
            double dot[2];
            random_point(independent, i, u);
            const vec3 p = s->draw(u[0], u[1]);
            if (!(s->density(p) > 0)) continue; /* lost below the surface */
            project(s->as, p, dot);
            draw_dot(d, place[independent][0] + PANEL * dot[0], place[independent][1] + PANEL * dot[1], 2.4, BLACK);
        }
    }
    return 1;
}

/* ---- densities on a line ---- */

static void draw_line(drawing *d, const sampler *s, const double *at, int independent) {
    const color bar = {{148, 190, 226}};
    double height[BINS] = {0};
    double curve[2 * PANEL + 1][2];
    double highest = 0;
    for (uint32_t i = 0; i < COUNTED; i++) {
        float u[2];
        random_point(independent, i, u);
        const double x = (s->draw(u[0], u[1]).x - s->low) / (s->high - s->low);
        if (x >= 0 && x < 1) height[(int)(x * BINS)] += (double)BINS / COUNTED / (s->high - s->low);
    }
    for (int i = 0; i <= 2 * PANEL; i++) {
        const float x = fminf(((float)i + 0.25f) / (2 * PANEL), 0.9999f);
        curve[i][0] = at[0] + i / 2.0;
        curve[i][1] = s->density(vec(s->low + x * (s->high - s->low), 0, 0));
        highest = fmax(highest, curve[i][1]);
    }
    const double scale = (LINE_PANEL - 1) / (1.25 * highest);
    const double bottom = at[1] + LINE_PANEL;
    for (int i = 0; i < BINS; i++) {
        const double up = fmin(scale * height[i], LINE_PANEL - 1);
        const double corner[2] = {at[0] + (double)PANEL * i / BINS + 0.4, bottom - up};
        draw_box(d, corner, (double)PANEL / BINS - 0.8, up, bar);
    }
    for (int i = 0; i <= 2 * PANEL; i++) curve[i][1] = bottom - scale * curve[i][1];
    draw_curve(d, 2 * PANEL + 1, (const double(*)[2])curve, 1.2, BLACK);
    const double floor_line[2][2] = {{at[0], bottom}, {at[0] + PANEL, bottom}};
    draw_curve(d, 2, floor_line, 0.8, GREY);
}

/* ---- the sheet ---- */

static int panel_height(const group *g) { return g->of->as == LINE ? LINE_PANEL : PANEL; }
static int group_height(const group *g) {
    const int rows = (g->count + COLUMNS - 1) / COLUMNS;
    return HEADING + rows * (LABEL + panel_height(g) + BELOW);
}

static int draw_sampler(drawing *d, const sampler *s, const double *at) {
    const double formula[2] = {at[0], at[1] + 11};
    const double panel[2] = {at[0], at[1] + LABEL - 3};
    const double other[2] = {at[0] + PANEL + GAP, panel[1]};
    draw_text(d, at, 1, 1, BLACK, s->name);
    draw_text(d, formula, 1, 0, GREY, s->formula);
    if (s->as != LINE) return draw_area(d, s, panel);
    draw_line(d, s, panel, 0);
    draw_line(d, s, other, 1);
    return 1;
}

/* What is what, at the top of the sheet. */
static void draw_legend(drawing *d) {
    static const char *const line[2] = {
        "samplers of mcsample.h: the colour, or the curve, is the density. a dot is a sample, a bar counts samples.",
        "left: a stratified sequence, mcs_sobol. right: independent numbers, mcs_pcg32. 128 points, on lines 256."};
    for (int i = 0; i < 2; i++) {
        const double at[2] = {MARGIN, MARGIN + 12 * i};
        put_text(d, at, 1, i == 0, BLACK, line[i]);
    }
}

static int draw_group(drawing *d, const char *folder, const group *g, int top) {
    char file[1024];
    const int length = snprintf(file, sizeof file, "%s/%s.svg", folder, g->file);
    if (length >= (int)sizeof file || !begin_group(d, file, top, top + group_height(g))) return 0;
    const double heading[2] = {MARGIN, top + 6};
    const char *sides = "left: mcs_sobol. right: mcs_pcg32.";
    const double right[2] = {(int)d->w - MARGIN - 6 * (int)strlen(sides), top + 14};
    draw_text(d, heading, 2, 0, BLACK, g->title);
    draw_text(d, right, 1, 0, GREY, sides);
    int ok = 1;
    for (int i = 0; i < g->count; i++) {
        const int row = i / COLUMNS;
        const double at[2] = {MARGIN + (CELL + GUTTER) * (i % COLUMNS),
                              top + HEADING + row * (LABEL + panel_height(g) + BELOW)};
        ok = ok && draw_sampler(d, &g->of[i], at);
    }
    ok = end_group(d) && ok;
    printf("%s: %d samplers: %s\n", file, g->count, g->title);
    return ok;
}

int main(int argc, char **argv) {
    drawing d = {0};
    char file[1024];
    if (argc != 2 || snprintf(file, sizeof file, "%s/gallery.png", argv[1]) >= (int)sizeof file) {
        fputs("usage: gallery FOLDER\n", stderr);
        return 2;
    }
    d.w = 2 * MARGIN + COLUMNS * CELL + (COLUMNS - 1) * GUTTER;
    d.h = TOP;
    for (int i = 0; i < GROUPS; i++) d.h += (unsigned)group_height(&groups[i]);
    d.rgb = malloc((size_t)d.w * d.h * 3);
    int ok = d.rgb && make_samplers();
    if (ok) memset(d.rgb, 255, (size_t)d.w * d.h * 3);
    int top = TOP;
    if (ok) draw_legend(&d);
    for (int i = 0; ok && i < GROUPS; i++) {
        ok = draw_group(&d, argv[1], &groups[i], top);
        top += group_height(&groups[i]);
    }
    ok = ok && write_sheet(&d, file);
    if (ok) printf("%s: all of them, %u x %u pixels\n", file, d.w, d.h);
    else fprintf(stderr, "gallery: cannot write %s, or not enough memory\n", argv[1]);
    return !ok;
}
