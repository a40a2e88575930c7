/* render_picture.h - the pictures of render.c: pixels, and how they get into PNG and Radiance files. */
#ifndef RENDER_PICTURE_H
#define RENDER_PICTURE_H
#include <errno.h>
#include <sys/stat.h>
#include "hdr.h"
#include "render_light.h"
#include "render_options.h"

typedef struct {
    mcs_pcg32 rng;
    vec3 sum;
    mcs_stat luminance; /* of this pixel's samples */
    uint32_t drawn;     /* light samples */
    int object;         /* that all samples hit, or NO_OBJECT */
} pixel;

static vec3 pixel_color(const pixel *p) { return scale(1 / (float)p->luminance.n, p->sum); }

static int file_close(FILE *f, const char *name) {
    const int bad = ferror(f);
    if (fclose(f) != 0 || bad) return complain(name, "cannot write: %s", strerror(errno));
    return 1;
}

static int hdr_write(const char *name, const pixel *image, unsigned w, unsigned h) {
    FILE *f = fopen(name, "wb");
    if (!f) return complain(name, "%s", strerror(errno));
    hdr_write_header(f, w, h);
    for (size_t i = 0; i < (size_t)w * h; i++) {
        const hdr_pixel p = encode(pixel_color(&image[i]));
        fwrite(p.c, 1, 4, f);
    }
    return file_close(f, name);
}

/* Exposure, a filmic curve without hard clipping (Narkowicz, "ACES filmic tone mapping curve", 2015), sRGB coding, 8
 * bits. */
static unsigned char display(float linear, float exposure) {
    const float x = fminf(linear * exposure, 1e4f);
    const float y = fminf(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 1);
    return (unsigned char)(255 * (y <= 0.0031308f ? 12.92f * y : 1.055f * powf(y, 1 / 2.4f) - 0.055f) + 0.5f);
}

#define SYMBOLS 257 /* 256 bytes and the end of the block */

/* Lengths of a prefix code for n bytes counted: Shannon's lengths, then shortened until the code is complete, as
 * deflate wants it. No count is taken as less than n / 8192, which keeps the lengths at 14 bits and below. */
static void code_lengths(const uint32_t *count, size_t n, unsigned char *length) {
    const uint64_t total = n + SYMBOLS * (n / 8192 + 1);
    uint32_t used = 0; /* sum of 2^(15 - length): 2^15 when complete */
    for (uint32_t i = 0; i < SYMBOLS; i++) {
        for (length[i] = 1; (count[i] + n / 8192 + 1) << length[i] < total;) length[i]++;
        used += 1u << (15 - length[i]);
    }
    for (uint32_t i = 0; used < 1u << 15; i = (i + 1) % SYMBOLS)
        if (used + (1u << (15 - length[i])) <= 1u << 15) used += 1u << (15 - length[i]--);
}

typedef struct {
    unsigned char *at;
    uint32_t bits, n;
} bit_writer;

static void put_bits(bit_writer *b, uint32_t value, uint32_t n) {
    b->bits |= value << b->n;
    for (b->n += n; b->n >= 8; b->n -= 8) {
        *b->at++ = (unsigned char)b->bits;
        b->bits >>= 8;
    }
}

static void put_code(bit_writer *b, uint32_t code, uint32_t n) { /* codes go out highest bit first */
    uint32_t reversed = 0;
    for (uint32_t i = 0; i < n; i++) reversed |= (code >> i & 1) << (n - 1 - i);
    put_bits(b, reversed, n);
}

static unsigned char *put_u32(unsigned char *at, uint32_t v) {
    *at++ = (unsigned char)(v >> 24);
    *at++ = (unsigned char)(v >> 16);
    *at++ = (unsigned char)(v >> 8);
    *at++ = (unsigned char)v;
    return at;
}

/* zlib stream (RFC 1950) of one deflate block (RFC 1951) with its own prefix code and no matches: a rendered picture
 * has hardly any repetition to match, but its filtered bytes are far from evenly spread. `out` has room for 2 n + 1024
 * bytes. */
static size_t zlib_pack(const unsigned char *data, size_t n, unsigned char *out) {
    uint32_t count[SYMBOLS] = {0};
    uint32_t next = 0;
    uint32_t s1 = 1;
    uint32_t s2 = 0;
    bit_writer b = {NULL, 0, 0};
    b.at = out;
    for (size_t i = 0; i < n; i++) {
        count[data[i]]++;
        s1 = (s1 + data[i]) % 65521;
        s2 = (s2 + s1) % 65521; /* Adler-32 */
    }
    unsigned char length[SYMBOLS];
    code_lengths(count, n, length);
    uint32_t code[SYMBOLS];
    for (uint32_t bits = 1; bits <= 15; bits++, next <<= 1)
        for (size_t i = 0; i < SYMBOLS; i++)
            if (length[i] == bits) code[i] = next++;
    put_bits(&b, 0x0178, 16);    /* zlib: deflate, 32 KiB window */
    put_bits(&b, 1 | 2 << 1, 3); /* the last block; its own codes */
    put_bits(&b, 0, 10);
    put_bits(&b, 15, 4); /* 257 byte codes, 1 distance code, all 19 length codes: */
    for (size_t i = 0; i < 19; i++)
        put_bits(&b, i < 3 ? 0 : 4, 3); /* 16-18 unused, so that 0-15 are themselves in 4 bits */
    for (size_t i = 0; i < SYMBOLS; i++) put_code(&b, length[i], 4);
    put_code(&b, 0, 4); /* no distances */
    for (size_t i = 0; i < n; i++) put_code(&b, code[data[i]], length[data[i]]);
    put_code(&b, code[SYMBOLS - 1], length[SYMBOLS - 1]);
    put_bits(&b, 0, 7);
    return (size_t)(put_u32(b.at, s2 << 16 | s1) - out);
}

static void png_chunk(FILE *f, const char *type, const unsigned char *data, size_t n) {
    uint32_t crc = 0xffffffffu;
    unsigned char head[8];
    memcpy(put_u32(head, (uint32_t)n), type, 4);
    for (size_t i = 4; i < n + 8; i++) { /* over the type and the data */
        crc ^= i < 8 ? head[i] : data[i - 8];
        for (int k = 0; k < 8; k++) crc = crc >> 1 ^ (0xedb88320u & (0u - (crc & 1)));
    }
    unsigned char tail[4];
    put_u32(tail, ~crc);
    fwrite(head, 1, 8, f);
    fwrite(data, 1, n, f);
    fwrite(tail, 1, 4, f);
}

/* Pictures of equal size, w x h, that one file shows side by side or one below the other. */
typedef struct {
    const pixel *image; /* of one, then of the next */
    unsigned w, h, across, down;
} sheet;

static const pixel *sheet_pixel(const sheet *s, size_t x, size_t y) {
    const size_t which = x / s->w + y / s->h; /* across or down is 1 */
    return s->image + (which * s->h + y % s->h) * s->w + x % s->w;
}

static int png_write(const char *name, const sheet *s, float exposure) {
    const unsigned w = s->w * s->across;
    const unsigned h = s->h * s->down;
    const size_t stride = (size_t)w * 3;
    const size_t raw_size = (stride + 1) * h;
    unsigned char *rows = calloc(2, stride);
    unsigned char *raw = malloc(raw_size);
    unsigned char *packed = malloc(2 * raw_size + 1024);
    FILE *f = rows && raw && packed ? fopen(name, "wb") : NULL;
    int ok = f ? 1 : complain(name, "%s", strerror(errno));
    for (size_t y = 0; ok && y < h; y++) { /* PNG's average filter: the one that suits pictures with noise */
        unsigned char *row = rows + (y & 1) * stride;
        unsigned char *above = rows + (~y & 1) * stride;
        unsigned char *out = raw + y * (stride + 1);
        for (size_t x = 0; x < w; x++) {
            vec3 c = pixel_color(sheet_pixel(s, x, y));
            row[3 * x] = display(c.x, exposure);
            row[3 * x + 1] = display(c.y, exposure);
            row[3 * x + 2] = display(c.z, exposure);
        }
        *out++ = 3;
        for (size_t x = 0; x < stride; x++)
            out[x] = (unsigned char)(row[x] - ((x < 3 ? 0 : row[x - 3]) + above[x]) / 2);
    }
    if (ok) {
        fwrite("\211PNG\r\n\032\n", 1, 8, f);
        unsigned char head[13];
        memcpy(put_u32(put_u32(head, w), h), "\10\2\0\0\0", 5); /* 8 bits, RGB, not interlaced */
        png_chunk(f, "IHDR", head, 13);
        png_chunk(f, "IDAT", packed, zlib_pack(raw, raw_size, packed));
        png_chunk(f, "IEND", head, 0);
        ok = file_close(f, name);
    }
    free(rows);
    free(raw);
    free(packed);
    return ok;
}

/* In the room, little light is left: three stops. */
static float exposure_for(const options *o, const environment *e) {
    const float plain = e->irradiance > 0 ? 0.9f * PI / e->irradiance : 1;
    return plain * exp2f(o->stops + (o->in_room ? 3 : 0));
}

/* The caller frees the name. Returns NULL after a complaint. */
static char *picture_name(const options *o, strategy how, const char *extension) {
    const size_t size = strlen(o->out) + strlen(strategy_name[how]) + strlen(extension) + 2;
    char *name = malloc(size);
    if (name) snprintf(name, size, "%s-%s%s", o->out, strategy_name[how], extension);
    else complain(o->out, "not enough memory");
    return name;
}

static int write_pictures(const options *o, strategy how, const environment *e, const pixel *image) {
    char *png = picture_name(o, how, ".png");
    char *hdr = picture_name(o, how, ".hdr");
    const sheet one = {image, o->w, o->h, 1, 1};
    const int ok = png && hdr && png_write(png, &one, exposure_for(o, e)) && hdr_write(hdr, image, o->w, o->h);
    free(png);
    free(hdr);
    return ok;
}

/* All of `count` pictures in one file. */
static int write_sheets(const options *o, const environment *e, const pixel *image, unsigned count) {
    const sheet stack = {image, o->w, o->h, 1, count};
    const sheet beside = {image, o->w, o->h, count, 1};
    if (o->stack && !png_write(o->stack, &stack, exposure_for(o, e))) return 0;
    return !o->beside || png_write(o->beside, &beside, exposure_for(o, e));
}

/* Whether a file can be written, asked before the time is spent on what goes into it. What was in it stays for now. */
static int can_write(const char *name) {
    struct stat status;
    const int exists = lstat(name, &status) == 0; /* if only as a link to nothing */
    if (stat(name, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
        return 1; /* a device or a pipe */
    FILE *f = fopen(name, "ab");
    if (!f) return complain(name, "cannot write: %s", strerror(errno));
    fclose(f);
    if (!exists) remove(name);
    return 1;
}

static int can_write_pictures(const options *o) {
    int ok = (!o->stack || can_write(o->stack)) && (!o->beside || can_write(o->beside));
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        char *png = picture_name(o, (strategy)i, ".png");
        char *hdr = picture_name(o, (strategy)i, ".hdr");
        ok = png && hdr && can_write(png) && can_write(hdr);
        free(png);
        free(hdr);
    }
    return ok;
}

#endif
