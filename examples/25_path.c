/* A path tracer: at each bounce one sample of the light and one of the BRDF, weighted by the power heuristic, and
 * Russian roulette. The inside of a matte unit sphere, a cap of which is the light. Known answer: any two points of a
 * sphere exchange as much light as any other two, so that all of it reflects r f L / (1 - r), where r is the albedo, f
 * the share of the cap in the area and L its radiance. Paths that meet the light by chance meet the answer, too, with a
 * larger error. */
#include "mcsample.h"
#include <math.h>
#include <stdio.h>

enum { PATHS = 100000 };

static const float cap = 0.02f; /* 1 - cos of the cap's angle from +z at the centre: mcs_cone_* draws points of it */
static const float radiance = 50;
static const float albedo = 0.8f;
static const float inverse_pi = 0.318309886f;

static float dot(mcs_vec3 a, mcs_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static mcs_vec3 unit(mcs_vec3 v) {
    const float scale = 1 / sqrtf(dot(v, v));
    const mcs_vec3 u = {scale * v.x, scale * v.y, scale * v.z};
    return u;
}

/* Light that comes straight from the cap. Your shadow ray goes from p to s.w; in a sphere nothing is in the way. */
static double sample_light(const mcs_frame *frame, mcs_vec3 p, const float u[2]) {
    const mcs_dir s = mcs_cone_sample(cap, u[0], u[1]); /* a point of the cap, and its density per area */
    const mcs_vec3 d = {s.w.x - p.x, s.w.y - p.y, s.w.z - p.z};
    const mcs_vec3 w = unit(d);
    const float pdf = mcs_pdf_to_solid_angle(s.pdf, sqrtf(dot(d, d)), dot(w, s.w));
    const mcs_vec3 wi = mcs_to_local(frame, w);
    if (!(pdf > 0 && wi.z > 0)) return 0;
    return radiance * albedo * inverse_pi * wi.z / pdf * mcs_mis_power(pdf, mcs_cosine_pdf(wi));
}

/* What p reflects. */
static double trace(mcs_vec3 p, mcs_pcg32 *rng, int mis) {
    double sum = 0;
    float throughput = 1;
    for (;;) {
        float u[5];
        mcs_pcg32_fill_n(rng, 5, u);
        const mcs_vec3 normal = {-p.x, -p.y, -p.z};
        const mcs_frame frame = mcs_frame_make(normal);
        if (mis) sum += throughput * sample_light(&frame, p, u);

        const mcs_dir b = mcs_cosine_sample(u[2], u[3]);
        if (!(b.pdf > 0)) return sum;
        const mcs_vec3 w = mcs_to_world(&frame, b.w);
        const float distance = 2 * b.w.z; /* your ray tells it, and what it meets */
        const mcs_vec3 q = {p.x + distance * w.x, p.y + distance * w.y, p.z + distance * w.z};
        p = unit(q);
        throughput *= albedo; /* f cos / pdf */
        const float light_pdf = mcs_pdf_to_solid_angle(mcs_cone_pdf(cap, p), distance, dot(w, p));
        if (light_pdf > 0) sum += throughput * radiance * (mis ? mcs_mis_power(b.pdf, light_pdf) : 1);

        /* Paths that matter little end early; those that go on stand for them. */
        const float survival = fminf(throughput, 0.95f);
        if (u[4] >= survival) return sum;
        throughput /= survival;
    }
}

static int report(const char *name, const mcs_stat *s, double exact) {
    printf("%-10s %.4f +- %.4f, exact %.4f\n", name, s->mean, mcs_stat_error(s), exact);
    return !(fabs(s->mean - exact) <= 5 * mcs_stat_error(s));
}

int main(void) {
    const mcs_vec3 bottom = {0, 0, -1};
    const double exact = albedo * (cap / 2) * radiance / (1 - albedo);
    mcs_stat chance = {0, 0, 0};
    mcs_stat both = {0, 0, 0};
    for (uint32_t i = 0; i < PATHS; i++) {
        mcs_pcg32 rng = mcs_pcg32_for(25, i, 0); /* the seed, the pixel, the sample */
        mcs_stat_add(&chance, trace(bottom, &rng, 0));
        mcs_stat_add(&both, trace(bottom, &rng, 1));
    }
    return report("BRDF", &chance, exact) | report("with light", &both, exact) |
           !(mcs_stat_error(&both) < mcs_stat_error(&chance));
}
