/* render_png.h - pictures of 8 bits a channel as PNG files in memory, for render.c and gallery.c. */
#ifndef RENDER_PNG_H
#define RENDER_PNG_H
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* 256 bytes, the end of the block, and lengths of runs. Of the last ones only 3 to 10 and 258 are used. */
#define SYMBOLS 286

/* Lengths of a prefix code for n symbols counted: Shannon's lengths, then shortened until the code is complete, as
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

/* The symbol for what begins at data[at]: a byte, or a run of the byte before it. *step is how many bytes it stands
 * for. */
static uint32_t next_symbol(const unsigned char *data, size_t n, size_t at, size_t *step) {
    size_t run = 0;
    while (at > 0 && run < 258 && at + run < n && data[at + run] == data[at - 1]) run++;
    *step = run < 3 ? 1 : run < 10 ? run : run < 258 ? 10 : 258;
    if (run < 3) return data[at];
    return run < 258 ? 257 + (uint32_t)*step - 3 : 285;
}

/* zlib stream (RFC 1950) of one deflate block (RFC 1951) with its own prefix code and no matches but runs: a rendered
 * picture has hardly any repetition to match, but its filtered bytes are far from evenly spread; a drawn one has large
 * even areas. `out` has room for 2 n + 1024 bytes. */
static size_t zlib_pack(const unsigned char *data, size_t n, unsigned char *out) {
    uint32_t count[SYMBOLS] = {0};
    uint32_t next = 0;
    uint32_t s1 = 1;
    uint32_t s2 = 0;
    size_t symbols = 0;
    size_t step;
    bit_writer b = {NULL, 0, 0};
    b.at = out;
    for (size_t i = 0; i < n; i++) {
        s1 = (s1 + data[i]) % 65521;
        s2 = (s2 + s1) % 65521; /* Adler-32 */
    }
    for (size_t i = 0; i < n; i += step, symbols++) count[next_symbol(data, n, i, &step)]++;
    unsigned char length[SYMBOLS];
    code_lengths(count, symbols, length);
    uint32_t code[SYMBOLS];
    for (uint32_t bits = 1; bits <= 15; bits++, next <<= 1)
        for (size_t i = 0; i < SYMBOLS; i++)
            if (length[i] == bits) code[i] = next++;
    put_bits(&b, 0x0178, 16);    /* zlib: deflate, 32 KiB window */
    put_bits(&b, 1 | 2 << 1, 3); /* the last block; its own codes */
    put_bits(&b, SYMBOLS - 257, 10);
    put_bits(&b, 15, 4); /* all symbols, 1 distance code, all 19 length codes: */
    for (size_t i = 0; i < 19; i++)
        put_bits(&b, i < 3 ? 0 : 4, 3); /* 16-18 unused, so that 0-15 are themselves in 4 bits */
    for (size_t i = 0; i < SYMBOLS; i++) put_code(&b, length[i], 4);
    put_code(&b, 1, 4); /* the distance 1, in one bit */
    for (size_t i = 0; i < n; i += step) {
        const uint32_t symbol = next_symbol(data, n, i, &step);
        put_code(&b, code[symbol], length[symbol]);
        if (symbol > 256) put_bits(&b, 0, 1);
    }
    put_code(&b, code[256], length[256]);
    put_bits(&b, 0, 7);
    return (size_t)(put_u32(b.at, s2 << 16 | s1) - out);
}

/* Returns where the next chunk goes. `data` may be where it goes to, 8 bytes behind `at`. */
static unsigned char *png_chunk(unsigned char *at, const char *type, const unsigned char *data, size_t n) {
    uint32_t crc = 0xffffffffu;
    if (n > 0) memmove(at + 8, data, n);
    memcpy(put_u32(at, (uint32_t)n), type, 4);
    for (size_t i = 4; i < n + 8; i++) { /* over the type and the data */
        crc ^= at[i];
        for (int k = 0; k < 8; k++) crc = crc >> 1 ^ (0xedb88320u & (0u - (crc & 1)));
    }
    return put_u32(at + 8 + n, ~crc);
}

/* A row of n bytes, less what PNG's filter 1 (the pixel at the left), 2 (that above) or 3 (their average) foretells.
 * Returns how large the differences are. above is NULL for the first row. */
static unsigned long filter_row(int filter, const unsigned char *row, const unsigned char *above, size_t n,
                                unsigned char *out) {
    unsigned long size = 0;
    for (size_t x = 0; x < n; x++) {
        const int a = x < 3 ? 0 : row[x - 3];
        const int b = above ? above[x] : 0;
        out[x] = (unsigned char)(row[x] - (filter == 1 ? a : filter == 2 ? b : (a + b) / 2));
        size += out[x] < 128 ? out[x] : 256ul - out[x];
    }
    return size;
}

/* The PNG file of w x h pixels, in memory that the caller frees: numbers of the 256 colours of the palette, or, where
 * that is NULL, red, green and blue. NULL says that there is not enough memory. Each row of colours has the filter with
 * the least differences: that is the average where there is noise. */
static unsigned char *png_make(const unsigned char *pixels, const unsigned char *palette, unsigned w, unsigned h,
                               size_t *size) {
    const size_t stride = (size_t)w * (palette ? 1 : 3);
    const size_t raw_size = (stride + 1) * h;
    unsigned char *raw = malloc(raw_size);
    unsigned char *png = malloc(2 * raw_size + 4096);
    for (size_t y = 0; raw && png && y < h; y++) {
        const unsigned char *row = pixels + y * stride;
        const unsigned char *above = y > 0 ? row - stride : NULL;
        unsigned char *out = raw + y * (stride + 1);
        unsigned long least = 0;
        out[0] = 0;
        for (int filter = 1; !palette && filter <= 3; filter++) {
            const unsigned long differences = filter_row(filter, row, above, stride, out + 1);
            if (filter > 1 && differences >= least) continue;
            least = differences;
            out[0] = (unsigned char)filter;
        }
        if (palette) memcpy(out + 1, row, stride);
        else filter_row(out[0], row, above, stride, out + 1);
    }
    if (raw && png) {
        unsigned char head[13];
        memcpy(png, "\211PNG\r\n\032\n", 8);
        memcpy(put_u32(put_u32(head, w), h), palette ? "\10\3\0\0\0" : "\10\2\0\0\0", 5); /* 8 bits, not interlaced */
        unsigned char *at = png_chunk(png + 8, "IHDR", head, 13);
        if (palette) at = png_chunk(at, "PLTE", palette, (size_t)256 * 3);
        at = png_chunk(at, "IDAT", at + 8, zlib_pack(raw, raw_size, at + 8));
        at = png_chunk(at, "IEND", NULL, 0);
        *size = (size_t)(at - png);
    } else {
        free(png);
        png = NULL;
    }
    free(raw);
    return png;
}

#endif
