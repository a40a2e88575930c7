/* Environment maps that come from a file: what mcs_env_check refuses, and that what it lets pass does no harm. */
#include "env_pictures.h"
#include "forge.h"

/* ---- from a file ---- */

/* Exactly as many bytes as there are, so that the address sanitizer sees a read beyond them. */
static mcs_env *copy_of(const void *from, size_t bytes) {
    void *to = malloc(bytes ? bytes : 1);
    if (!to) exit(2);
    memcpy(to, from, bytes);
    return (mcs_env *)to;
}

/* A forged table that was accepted may be wrong, but draws texels of the map, with densities that are numbers and along
 * unit directions: dot products of the frame are off by 1e-4 at most, thus squares of lengths by 3 times as much. */
static void check_harmless(const mcs_env *e, const char *what, size_t at) {
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 113);
    enum { N = 68 };
    int outside = 0;
    int no_density = 0;
    int no_direction = 0;
    int no_inverse = 0;
    float a[N];
    for (int i = 0; i < N; i++) a[i] = i < 4 ? (float)(i & 1) * 0x0.ffffffp0f : mcs_pcg32_float(&rng);
    float b[N];
    for (int i = 0; i < N; i++) b[i] = i < 4 ? (float)(i >> 1) * 0x0.ffffffp0f : mcs_pcg32_float(&rng);
    float out[4][N];
    mcs_env_sample_n(e, N, a, b, out[0], out[1], out[2], out[3], NULL, NULL);
    float pdf[N];
    mcs_env_pdf_n(e, N, out[0], out[1], out[2], pdf);
    for (int i = 0; i < N; i++) {
        const mcs_texel s = mcs_env_sample(e, a[i], b[i]);
        const mcs_texel t = mcs_env_texel(e, s.w);
        const mcs_vec2 u = mcs_env_invert(e, s.w);
        const double length = sqrt((double)s.w.x * s.w.x + (double)s.w.y * s.w.y + (double)s.w.z * s.w.z);
        outside += !(s.col < e->w && s.row < e->h && t.col < e->w && t.row < e->h);
        no_density +=
            !(s.pdf >= 0 && s.pdf <= FLT_MAX && t.pdf >= 0 && t.pdf <= FLT_MAX && out[3][i] >= 0 && pdf[i] >= 0);
        no_direction += !(fabs(length - 1) <= 1.6e-4);
        no_inverse += !(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
    }
    CHECK(outside + no_density + no_direction + no_inverse == 0,
          "%s %zu changed, accepted: of %d draws %d outside the map, %d without density, %d without direction, %d "
          "inverses",
          what, at, N, outside, no_density, no_direction, no_inverse);
}

static int in_frame(size_t at) {
    return at >= offsetof(mcs_env, frame) && at < offsetof(mcs_env, frame) + sizeof(mcs_frame);
}

/* Memory of a table, `was`, that now differs: refused with MCS_ERR_FORMAT or, where the size that the header tells is
 * larger, MCS_ERR_MEMORY. A changed frame may be one, and a forged table, too: then they are harmless. Puts the table
 * back and returns whether the forged one was refused. */
static int check_damaged(mcs_env *e, const arena *was, const char *what, size_t at) {
    const mcs_env *good = env_in(was);
    mcs_status rc = mcs_env_check(e, was->bytes);
    CHECK(rc == MCS_ERR_FORMAT || rc == MCS_ERR_MEMORY || (rc == MCS_OK && in_frame(at)), "%s %zu changed: %d", what,
          at, rc);
    if (e->w == good->w && e->h == good->h && memcmp(&e->offset, &good->offset, sizeof e->offset) == 0) {
        seal(e);
        rc = mcs_env_check(e, was->bytes);
        CHECK(rc == MCS_OK || rc == MCS_ERR_FORMAT, "%s %zu forged: %d", what, at, rc);
        if (rc == MCS_OK) check_harmless(e, what, at);
    }
    memcpy(e, was->at, was->bytes);
    return rc != MCS_OK;
}

/* What must be noticed when the word at i of the header is `now` instead of `was`; odd: it is none of its neighbours.
 */
static void check_word(mcs_env *e, const arena *a, size_t i, uint32_t now, uint32_t was, int odd) {
    const int no = check_damaged(e, a, "header word at", i);
    /* magic, version, the whole layout and both sizes are what everything else is found by */
    if (i < offsetof(mcs_env, total) || i == offsetof(mcs_env, w) || i == offsetof(mcs_env, h) ||
        (i >= offsetof(mcs_env, row0) && i <= offsetof(mcs_env, col1)))
        CHECK(no, "header word at %zu: %08x accepted for %08x", i, now, was);
    /* and words of the frame that are no numbers, sizes of a column that are off by more than rounding */
    if ((i == offsetof(mcs_env, turn) || i == offsetof(mcs_env, inner) || in_frame(i)) &&
        (now == 0x7f800000u || now == 0xffffffffu))
        CHECK(no, "NaN at %zu accepted", i);
    if ((i == offsetof(mcs_env, turn) || i == offsetof(mcs_env, inner)) && odd)
        CHECK(no, "column of %08x turns accepted for %08x", now, was);
}
static void check_header(mcs_env *e, const arena *a) {
    unsigned char *byte = (unsigned char *)e;
    for (size_t i = 0; i < sizeof *e; i++) { /* every bit of the header, then whole bytes */
        const unsigned char was = byte[i];
        for (size_t k = 0; k < 11; k++) {
            byte[i] = (unsigned char)(k < 8 ? was ^ 1u << k : k == 8 ? 0 : k == 9 ? 0xff : 0x7f);
            if (byte[i] != was) check_damaged(e, a, "header byte", i);
        }
    }
    for (size_t i = 0; i < sizeof *e; i += 4) { /* words to what numbers break at */
        const uint32_t odd[8] = {0, 1, 65535, 65536, 65537, 0x7f800000u, 0x80000000u, 0xffffffffu};
        uint32_t was;
        memcpy(&was, byte + i, 4);
        for (size_t k = 0; k < 10; k++) {
            const uint32_t now = k < 8 ? odd[k] : k == 8 ? was + 1 : was - 1;
            memcpy(byte + i, &now, 4);
            if (now != was) check_word(e, a, i, now, was, k < 8);
        }
    }
}
static void check_sums(const picture *p, mcs_env *e, const arena *a, mcs_pcg32 *rng) {
    const size_t bytes = a->bytes;
    const int all_lit = p->value == v_random && !e->uniform;
    unsigned char *byte = (unsigned char *)e;
    size_t guides_tried = 0;
    for (size_t i = 0; i < (size_t)scaled(4000); i++) {
        const size_t at = sizeof *e + mcs_pcg32_next(rng) % (bytes - sizeof *e);
        const size_t n = 1 + mcs_pcg32_next(rng) % 8;
        for (size_t k = at; k < at + n && k < bytes; k++)
            byte[k] = (unsigned char)(i % 3 ? mcs_pcg32_next(rng) : i % 2 ? 0xff : 0);
        const size_t guides = env_in(a)->offset.col_guide;
        const int changed = memcmp(e, a->at, bytes) != 0;
        const int no = changed && check_damaged(e, a, "table byte", at);
        /* guides follow from the sums: none but the right one passes, forged or not */
        if (all_lit && changed && at >= guides &&
            at + n <= guides + (size_t)p->h * env_in(a)->offset.guide_length * 2) {
            guides_tried++;
            CHECK(no, "guide byte %zu changed, accepted", at);
        }
    }
    CHECK(!all_lit || guides_tried > 0, "no guide tried");
}
static void check_cut(const arena *a, mcs_pcg32 *rng) {
    const size_t bytes = a->bytes;
    for (size_t i = 0; i < bytes;
         i += i < sizeof(mcs_env) || i + 64 >= bytes ? 1 : 1 + mcs_pcg32_next(rng) % (bytes / 64 + 1)) {
        mcs_env *cut = copy_of(a->at, i);
        CHECK(mcs_env_check(cut, i) == MCS_ERR_MEMORY, "%zu of %zu bytes: %d", i, bytes, mcs_env_check(cut, i));
        free(cut);
    }
}
static void check_other_formats(mcs_env *e, const arena *a, mcs_pcg32 *rng) {
    const size_t bytes = a->bytes;
    unsigned char *byte = (unsigned char *)e;
    for (size_t i = 4; i <= 8; i += 4) { /* another byte order: of the words, of the whole header */
        for (size_t k = 0; k < sizeof *e; k++) byte[k] = a->at[i == 4 ? k ^ 3 : k ^ 7];
        CHECK(mcs_env_check(e, bytes) == MCS_ERR_FORMAT, "bytes swapped by %zu: %d", i, mcs_env_check(e, bytes));
    }
    memcpy(e, a->at, bytes);
    e->magic ^= 0x20202020u;
    seal(e);
    CHECK(mcs_env_check(e, bytes) == MCS_ERR_FORMAT, "magic");
    memcpy(e, a->at, bytes);
    e->version++;
    seal(e);
    CHECK(mcs_env_check(e, bytes) == MCS_ERR_FORMAT, "a later version");
    memcpy(e, a->at, bytes);
    e->total = -1;
    seal(e);
    CHECK(mcs_env_check(e, bytes) == MCS_ERR_FORMAT, "negative light");
    memset(e, 0, bytes);
    CHECK(mcs_env_check(e, bytes) == MCS_ERR_FORMAT, "zeros");
    memset(e, 0xff, bytes);
    CHECK(mcs_env_check(e, bytes) == MCS_ERR_FORMAT, "ones");
    for (size_t i = 0; i < bytes; i++) byte[i] = (unsigned char)mcs_pcg32_next(rng);
    CHECK(mcs_env_check(e, bytes) == MCS_ERR_FORMAT, "noise");
    CHECK(mcs_env_check(NULL, bytes) == MCS_ERR_ARG, "no memory");
    for (size_t i = 1; i < 8; i += 2)
        CHECK(mcs_env_check((const mcs_env *)(const void *)(a->at + i), bytes - 8) == MCS_ERR_ARG, "off by %zu", i);
}

static void check_file(picture p, brightness want) {
    arena a = build(&p, want);
    mcs_env *e = copy_of(a.at, a.bytes);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 127);
    CHECK(mcs_env_check(e, a.bytes) == MCS_OK && mcs_env_check(e, a.bytes + 8) == MCS_OK, "a good table");
    check_harmless(e, "nothing", 0);
    check_header(e, &a);
    check_sums(&p, e, &a, &rng);
    check_cut(&a, &rng);
    check_other_formats(e, &a, &rng);
    free(e);
    free(p.lum);
    arena_free(&a);
}

static void test_damage(void) {
    check_file(make("random", 40, 14, v_random), LIT);
    check_file(make("every third row", 13, 9, v_thirds), LIT);
    check_file(make("sky", 64, 32, v_sky), LIT);
    check_file(make("one texel", 1, 1, v_random), LIT);
    check_file(make("constant", 9, 5, v_constant), LIT);
    check_file(make("black", 9, 5, v_black), BLACK);
}

/* ---- what no damage passes ---- */

static int orthonormal(const mcs_frame *f) {
    const mcs_vec3 *const v[3] = {&f->s, &f->t, &f->n};
    int ok = 1;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++) {
            const ld dot = (ld)v[i]->x * v[j]->x + (ld)v[i]->y * v[j]->y + (ld)v[i]->z * v[j]->z;
            ok &= fabsl(dot - (i == j)) <= 1e-4L;
        }
    return ok;
}

/* Every bit of a table: none but those of the frame may be another, and the frame only as long as it is orthonormal. */
static void check_every_bit(picture p, brightness want) {
    arena a = build(&p, want);
    size_t passed = 0;
    for (size_t bit = 0; bit < 8 * a.bytes; bit++) {
        a.at[bit / 8] ^= (unsigned char)(1u << bit % 8);
        const mcs_status rc = mcs_env_check(env_in(&a), a.bytes);
        passed += rc == MCS_OK;
        CHECK((rc == MCS_OK) == (in_frame(bit / 8) && orthonormal(&env_in(&a)->frame)),
              "%s: bit %zu of byte %zu of %zu: %d", p.name, bit % 8, bit / 8, a.bytes, rc);
        a.at[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
    CHECK(passed > 0 && mcs_env_check(env_in(&a), a.bytes) == MCS_OK, "%s: %zu frames pass", p.name, passed);
    arena_free(&a);
    free(p.lum);
}
static void test_every_bit(void) {
    check_every_bit(make("7 x 5", 7, 5, v_random), LIT);
    check_every_bit(make("7 x 5, every third row", 7, 5, v_thirds), LIT);
    check_every_bit(make("7 x 5, region", 7, 5, v_region), LIT);
    check_every_bit(make("7 x 5, constant", 7, 5, v_constant), LIT);
    check_every_bit(make("7 x 5, black", 7, 5, v_black), BLACK);
    check_every_bit(make("1 x 1", 1, 1, v_random), LIT);
    check_every_bit(make("16 x 2", 16, 2, v_random), LIT);
}

/* Some bits turned over. */
static void turn_bits(unsigned char *byte, size_t bytes, int bits, mcs_pcg32 *rng) {
    for (int k = 0; k < bits; k++) {
        const size_t bit = mcs_pcg32_next(rng) % (8 * bytes);
        byte[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
}

/* Two words of a row exchanged, or one bit of both turned over, 64 bytes or a multiple apart: sums take such words
 * together. */
static void damage_words(unsigned char *row, int exchange, mcs_pcg32 *rng) {
    const size_t lane = mcs_pcg32_next(rng) % 8 * 8;
    const uint32_t first = mcs_pcg32_next(rng) % 4;
    const uint32_t second = mcs_pcg32_next(rng) % 4;
    const uint32_t bit = mcs_pcg32_next(rng) % 64;
    for (int k = 0; k < 8; k++) {
        unsigned char *const x1 = row + first * 64 + lane + k;
        unsigned char *const x2 = row + second * 64 + lane + k;
        const unsigned char was = *x1;
        if (exchange) {
            *x1 = *x2;
            *x2 = was;
        } else if ((int)bit / 8 == k) {
            *x1 ^= (unsigned char)(1u << bit % 8);
            *x2 ^= (unsigned char)(1u << bit % 8);
        }
    }
}

/* A block zeroed, exchanged with another, or filled with noise. */
enum block_damage { ZEROED, EXCHANGED, NOISE };
static void damage_block(unsigned char *byte, const arena *whole, enum block_damage damage, mcs_pcg32 *rng) {
    const size_t n = 1 + mcs_pcg32_next(rng) % 256;
    const size_t from = mcs_pcg32_next(rng) % (whole->bytes - n);
    const size_t to = mcs_pcg32_next(rng) % (whole->bytes - n);
    if (damage == ZEROED) memset(byte + to, 0, n);
    if (damage == EXCHANGED) {
        memcpy(byte + from, whole->at + to, n);
        memcpy(byte + to, whole->at + from, n);
    }
    for (size_t k = 0; damage == NOISE && k < n; k++) byte[to + k] = (unsigned char)mcs_pcg32_next(rng);
}

/* Damage of any kind outside the frame: one bit, two and three of them, blocks of bytes, words of a row. */
static void test_random_damage(void) {
    const picture p = make("sky", 64, 32, v_sky);
    arena a = build(&p, LIT);
    mcs_env *e = copy_of(a.at, a.bytes);
    unsigned char *byte = (unsigned char *)e;
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 137);
    const size_t frame = offsetof(mcs_env, frame);
    for (int i = 0; i < scaled(60000); i++) {
        const int kind = i % 8;
        if (kind < 3) turn_bits(byte, a.bytes, kind + 1, &rng);
        else if (kind < 6) damage_block(byte, &a, (enum block_damage)(kind - 3), &rng);
        else {
            const size_t row = mcs_pcg32_next(&rng) % 32 * (65 * sizeof(uint32_t));
            damage_words(byte + e->offset.col_sums + row, kind == 6, &rng);
        }
        memcpy(byte + frame, a.at + frame, sizeof(mcs_frame));
        const mcs_status rc = mcs_env_check(e, a.bytes);
        CHECK((rc == MCS_OK) == (memcmp(e, a.at, a.bytes) == 0), "damage %d of kind %d: %d", i, kind, rc);
        memcpy(e, a.at, a.bytes);
    }
    free(e);
    free(p.lum);
    arena_free(&a);
}

static mcs_frame turned(const mcs_frame *f, const mcs_frame *by) { /* in float, as a scene graph would */
    mcs_frame r;
    r.s = mcs_to_world(by, f->s);
    r.t = mcs_to_world(by, f->t);
    r.n = mcs_to_world(by, f->n);
    return r;
}
/* Frames that a user may set: those of mcs_frame_make, mirrored, and products of 100 rotations; and that are none. */
static void test_frames(void) {
    const picture p = make("7 x 5", 7, 5, v_random);
    arena a = build(&p, LIT);
    mcs_env *e = env_in(&a);
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 139);
    for (int i = 0; i < 2000; i++) {
        const float off[6] = {1e-3f, -1e-3f, 1.0f, -0.2f, 1e30f, NAN};
        float u = mcs_pcg32_float(&rng);
        mcs_frame f = mcs_frame_make(mcs_sphere_sample(u, mcs_pcg32_float(&rng)).w);
        float *number = &f.s.x + (i % 3) * 3 + i / 3 % 3;
        e->frame = f;
        CHECK(mcs_env_check(e, a.bytes) == MCS_OK, "a frame of mcs_frame_make is refused");
        e->frame.t.x = -f.t.x;
        e->frame.t.y = -f.t.y;
        e->frame.t.z = -f.t.z;
        CHECK(mcs_env_check(e, a.bytes) == MCS_OK, "a mirrored frame is refused");
        mcs_frame g = f;
        for (int k = 0; k < 100; k++) {
            u = mcs_pcg32_float(&rng);
            const mcs_frame by = mcs_frame_make(mcs_sphere_sample(u, mcs_pcg32_float(&rng)).w);
            g = turned(&g, &by);
        }
        e->frame = g;
        CHECK(mcs_env_check(e, a.bytes) == MCS_OK, "a product of 100 rotations is refused");
        *number += fabsf(*number) > 0.5f || i % 6 > 2 ? off[i % 6] : 0;
        e->frame = f;
        CHECK((mcs_env_check(e, a.bytes) == MCS_OK) == orthonormal(&f), "a frame with %g added: %d", (double)off[i % 6],
              mcs_env_check(e, a.bytes));
        f = g;
        f.n.x *= 0.8f;
        f.n.y *= 0.8f;
        f.n.z *= 0.8f;
        e->frame = f;
        CHECK(mcs_env_check(e, a.bytes) == MCS_ERR_FORMAT, "a short normal is accepted");
        for (int k = 0; k < 3; k++) { /* skewed, so that one dot product alone is 1e-3 */
            mcs_vec3 *const skewed = k == 0 ? &e->frame.s : k == 1 ? &e->frame.t : &e->frame.n;
            const mcs_vec3 to = k == 0 ? g.t : k == 1 ? g.n : g.s;
            e->frame = g;
            skewed->x += 1e-3f * to.x;
            skewed->y += 1e-3f * to.y;
            skewed->z += 1e-3f * to.z;
            CHECK(mcs_env_check(e, a.bytes) == MCS_ERR_FORMAT, "axis %d is skewed and accepted", k);
        }
    }
    arena_free(&a);
    free(p.lum);
}

static void test_file(void) {
    const picture p = make("sky", 256, 128, v_sky);
    arena a = build(&p, LIT);
    arena b = arena_make(a.bytes);
    arena m = arena_make(mcs_env_window_bytes(20));
    mcs_env_window *window = (mcs_env_window *)(void *)m.at;
    mcs_pcg32 rng = mcs_pcg32_make(mcst.seed, 131);
    FILE *f = tmpfile();
    CHECK(f && fwrite(a.at, 1, a.bytes, f) == a.bytes, "the table cannot be written");
    if (f) rewind(f);
    CHECK(f && fread(b.at, 1, b.bytes, f) == b.bytes && fgetc(f) == EOF && fclose(f) == 0, "the table cannot be read");
    CHECK(a.at != b.at && mcs_env_check(env_in(&b), b.bytes) == MCS_OK, "refused after it was read: %d",
          mcs_env_check(env_in(&b), b.bytes));
    CHECK(mcs_env_window_build(window, m.bytes, env_in(&a), 30, 20, 250, 17) == MCS_OK, "window");
    for (int i = 0; i < 20000; i++) {
        const float f1 = mcs_pcg32_float(&rng);
        const float f2 = mcs_pcg32_float(&rng);
        const mcs_texel s = mcs_env_sample(env_in(&b), f1, f2);
        CHECK(same(s, mcs_env_sample(env_in(&a), f1, f2)), "draw %d differs", i);
        CHECK(
            same(mcs_env_window_sample(window, env_in(&a), f1, f2), mcs_env_window_sample(window, env_in(&b), f1, f2)),
            "draw %d through the window differs", i);
    }
    arena_free(&a);
    arena_free(&b);
    arena_free(&m);
    free(p.lum);
}

int main(int argc, char **argv) {
    mcst_start(argc, argv);
    mcst_group("env files");
    if (mcst_case("damaged tables")) test_damage();
    if (mcst_case("every bit of small tables")) test_every_bit();
    if (mcst_case("random damage")) test_random_damage();
    if (mcst_case("frames")) test_frames();
    if (mcst_case("written and read")) test_file();
    return mcst_finish();
}
