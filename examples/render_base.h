/* render_base.h - what all parts of render.c use: colours and directions, and how a failure is told. */
#ifndef RENDER_BASE_H
#define RENDER_BASE_H
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "mcsample.h"

#define PI 3.14159265f

typedef mcs_vec3 vec3;

static vec3 vec(float x, float y, float z) {
    vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
static const vec3 black = {0, 0, 0};
static vec3 add(vec3 a, vec3 b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static vec3 sub(vec3 a, vec3 b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static vec3 mul(vec3 a, vec3 b) { return vec(a.x * b.x, a.y * b.y, a.z * b.z); }
static vec3 scale(float s, vec3 a) { return vec(s * a.x, s * a.y, s * a.z); }
static float dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec3 cross(vec3 a, vec3 b) { return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static vec3 unit(vec3 a) { return scale(1 / sqrtf(dot(a, a)), a); }
static vec3 mix(float t, vec3 a, vec3 b) { return add(scale(1 - t, a), scale(t, b)); }
static float luminance(vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; } /* Rec. 709 */

/* Says on stderr what is wrong with a file or an argument. Returns 0, so that a failing function can end with it. */
static int complain(const char *what, const char *format, ...) {
    va_list args;
    va_start(args, format);
    fprintf(stderr, "render: %s: ", what);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    return 0;
}

#endif
