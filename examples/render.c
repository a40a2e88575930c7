/* render.c - the main example of mcsample.h: how a renderer uses it.
 *
 * A row of spheres, one per material, on a matte ground. Light comes from a latitude-longitude environment map, in the
 * open or through the window of a room, or at night from two lamps, in clear air or haze. A sample of the picture is a
 * camera ray, what it hits, and an estimate of the light that is reflected from there: the integral of f L V cos over
 * the directions wi, where f is the BRDF, L the radiance that comes from wi, V whether anything is in its way, and cos
 * that of wi to the normal. Each strategy draws wi in another way. All have the same mean; variance and cost differ,
 * which is printed.
 *
 *     cc -O2 -std=c99 -I. -fopenmp examples/render.c -o render -lm       (-fopenmp is optional: without it, one thread)
 *     ./render --strategy all sunrise.hdr
 *
 * Read this file from here to its end. What it calls is, by subject, in
 *
 *     render_point.h       a point that is lit
 *     render_product.h     strategies that draw from map times BRDF
 *     render_learning.h    regions of the scene, which learn from shadow rays
 *     render_material.h    materials made of the BRDFs of mcsample.h, and glass
 *     render_light.h       the environment map
 *     render_lamps.h       lamps: a rectangle and a ball
 *     render_haze.h        haze between them
 *     render_scene.h       spheres, ground, room and camera: what rays meet
 *     render_options.h     the command line
 *     render_progress.h    how long to go on
 *     render_report.h      the error of a picture, and the tables that are printed
 *     render_picture.h     pixels, PNG and Radiance files
 *     render_parts.h       parts of a picture, made by many processes
 *
 * World: z up, lengths in sphere radii. Shading happens in the local frame of mcsample.h: normal on +z, wo to the eye,
 * wi to the light. Colours are linear RGB with the primaries of sRGB, kept in a vec3. Letters, in all files but those
 * of formats: s scene, e environment, o options, x a lit point, p a position, w a direction in the world, m a material.
 */
#define _POSIX_C_SOURCE 200809L /* clock_gettime, fileno, isatty */
#include "render_haze.h"
#include "render_parts.h"
#include "render_product.h"
#include "render_progress.h"

/* What is rendered, and how. */
typedef struct {
    const options *o;
    const scene *s;
    const environment *e;
    strategy how;
    learning *regions; /* NULL for strategies that do not learn */
} job;

static vec3 trace(const job *j, vec3 w, int *seen, pixel_sums *pixel, shadow_rays *rays);
static vec3 shade(const job *j, const surface *hit, pixel_sums *pixel, shadow_rays *rays);
static vec3 reflect(lit_point *x, uint32_t estimates);
static vec3 reflect_hemisphere(const lit_point *x, int cosine);
static vec3 reflect_brdf(const lit_point *x, int mis);
static vec3 reflect_light(const lit_point *x, int mis);
static incoming light_draw(const lit_point *x);
static incoming light_along(const lit_point *x, vec3 w);

/* ---- from the camera to a surface ---- */

/* One sample of a pixel. */
static void sample_pixel(const job *j, uint32_t col, uint32_t row, pixel_sums *pixel, shadow_rays *rays) {
    const float right = (float)col + mcs_pcg32_float(&pixel->rng); /* a box filter: anywhere in the pixel */
    const float down = (float)row + mcs_pcg32_float(&pixel->rng);
    const vec3 w = camera_ray(j->s, right / (float)j->o->width, down / (float)j->o->height);
    int seen = NO_OBJECT;
    const vec3 color = trace(j, w, &seen, pixel, rays);
    pixel_add(pixel, seen, color);
}

/* The light that the camera sees along w. Glass sends the ray on, until it meets light or another material. What glass
 * has sent on 32 times counts as black: hardly anything is left of it. *seen becomes the object that is met first. */
static vec3 trace(const job *j, vec3 w, int *seen, pixel_sums *pixel, shadow_rays *rays) {
    vec3 p = j->s->eye;
    vec3 weight = {1, 1, 1};
    surface hit = {NO_OBJECT, NULL, p, w, mcs_frame_make(w)};
    surface droplet;
    for (int passed = 0; passed < 32; passed++) {
        const int met = intersect(j->s, p, w, hit.object, &hit);
        if (passed == 0) *seen = hit.object;
        if (haze_meets(j->s, p, w, &hit, &pixel->rng, &droplet)) return mul(weight, shade(j, &droplet, pixel, rays));
        if (!met) return mul(weight, light_in_sight(j->s, j->e, p, w));
        if (!(hit.m->eta > 0)) return mul(weight, shade(j, &hit, pixel, rays));
        const float u_choice = mcs_pcg32_float(&pixel->rng);
        const float u1 = mcs_pcg32_float(&pixel->rng);
        const float u2 = mcs_pcg32_float(&pixel->rng);
        const bounce b = glass_sample(hit.m, hit.wo, u_choice, u1, u2);
        if (!(b.pdf > 0)) return black;
        weight = mul(weight, b.weight);
        p = hit.p;
        w = mcs_to_world(&hit.frame, b.wi);
    }
    return black;
}

/* The light that a surface, or a droplet of haze, sends to where the ray came from. */
static vec3 shade(const job *j, const surface *hit, pixel_sums *pixel, shadow_rays *rays) {
    lit_point x = {.s = j->s, .e = j->e, .hit = hit, .how = j->how, .rng = &pixel->rng, .regions = j->regions};
    lamps_view lamps;
    if (j->s->by_lamps) {
        lamps = lamps_from(&j->s->lamps, hit->p, j->how == AREA);
        x.lamps = &lamps;
    }
    if (j->regions) {
        x.region = region_of(j->regions, j->s, hit);
        x.rays = rays;
    }
    const vec3 sent = hit->m ? reflect(&x, j->o->lights) : haze_scatter(&x, j->o->lights);
    pixel->drawn += x.drawn;
    return sent;
}

/* ---- estimates of the light that a surface reflects ---- */

/* The mean of so many estimates. */
static vec3 reflect(lit_point *x, uint32_t estimates) {
    vec3 sum = black;
    x->drawn += estimates;
    if (x->how == PRODUCT || x->how == LEARNED) return scale(1 / (float)estimates, reflect_product(x, estimates));
    if (x->how == REGION) return scale(1 / (float)estimates, reflect_region(x, estimates));
    for (uint32_t i = 0; i < estimates; i++) {
        switch (x->how) {
        case UNIFORM: sum = add(sum, reflect_hemisphere(x, 0)); break;
        case COSINE: sum = add(sum, reflect_hemisphere(x, 1)); break;
        case BRDF: sum = add(sum, reflect_brdf(x, 0)); break;
        case MIS:
            if (point_bounce_is_due(x, x->hit->m->share)) sum = add(sum, reflect_brdf(x, 1));
            sum = add(sum, reflect_light(x, 1));
            break;
        default: sum = add(sum, reflect_light(x, 0)); /* ENVIRONMENT, ANGLE, AREA */
        }
    }
    return scale(1 / (float)estimates, sum);
}

/* By a direction of the hemisphere above the point, whatever its material and its light. */
static vec3 reflect_hemisphere(const lit_point *x, int cosine) {
    const float u1 = mcs_pcg32_float(x->rng);
    const float u2 = mcs_pcg32_float(x->rng);
    const mcs_dir d = cosine ? mcs_cosine_sample(u1, u2) : mcs_hemisphere_sample(u1, u2);
    const vec3 w = mcs_to_world(&x->hit->frame, d.w);
    if (!(d.pdf > 0 && point_sees(x, w))) return black;
    const vec3 f_cos = material_eval(x->hit->m, x->hit->wo, d.w);
    return scale(1 / d.pdf, mul(f_cos, light_along(x, w).radiance));
}

/* By a direction drawn from the BRDF. With mis it is one half of a multi-sample estimator with the power heuristic
 * (Veach and Guibas, "Optimally combining sampling techniques", 1995), without it an estimator by itself. */
static vec3 reflect_brdf(const lit_point *x, int mis) {
    const bounce b = point_bounce(x);
    const vec3 w = mcs_to_world(&x->hit->frame, b.wi);
    if (!(b.pdf > 0 && point_sees(x, w))) return black;
    const incoming light = light_along(x, w);
    const vec3 value = mul(b.weight, light.radiance);
    if (!mis) return value;
    const float share = x->hit->m->share;
    return scale(mcs_mis_power(share * b.pdf, light.pdf) / share, value);
}

/* By a direction drawn from the light. With mis it is the other half. */
static vec3 reflect_light(const lit_point *x, int mis) {
    const material *m = x->hit->m;
    const incoming light = light_draw(x);
    const vec3 wi = mcs_to_local(&x->hit->frame, light.w);
    if (!(light.pdf > 0 && wi.z > 0 && point_sees(x, light.w))) return black;
    const vec3 value = scale(1 / light.pdf, mul(material_eval(m, x->hit->wo, wi), light.radiance));
    if (!mis) return value;
    return scale(mcs_mis_power(light.pdf, m->share * material_pdf(m, x->hit->wo, wi)), value);
}

/* ---- light that comes to a point ---- */

static incoming light_draw(const lit_point *x) {
    const float u1 = mcs_pcg32_float(x->rng);
    const float u2 = mcs_pcg32_float(x->rng);
    if (x->s->by_lamps) return lamps_draw(x->lamps, u1, u2);
    const mcs_texel t = mcs_env_sample(x->e->table, u1, u2);
    return incoming_make(t.w, t.pdf, radiance_at(x->e, t.col, t.row));
}

/* From the direction w, with the density with which light_draw draws it. */
static incoming light_along(const lit_point *x, vec3 w) {
    if (x->s->by_lamps) return lamps_along(x->lamps, w);
    const mcs_texel t = mcs_env_texel(x->e->table, w);
    return incoming_make(w, t.pdf, radiance_at(x->e, t.col, t.row));
}

/* ---- the picture ---- */

/* So many samples of each pixel of a row. */
static void render_row(const job *j, uint32_t row, uint32_t samples, pixel_sums *pixel) {
    shadow_rays rays;
    rays.count = 0;
    for (uint32_t col = 0; col < j->o->width; col++)
        for (uint32_t i = 0; i < samples; i++) sample_pixel(j, col, row, pixel + col, &rays);
    if (j->regions) shadow_rays_deliver(j->regions, &rays);
}

/* Every pixel has its own stream of random numbers, seeded from (seed, pixel, strategy), and owns all that it changes.
 * What pixels learn from each other changes between passes only. So the picture does not depend on the number of
 * threads. Returns 0 after a complaint. */
static int render(job *j, pixel_sums *image, outcome *result) {
    const options *o = j->o;
    const size_t pixels = (size_t)o->width * o->height;
    const int learns = j->how == REGION || j->how == LEARNED;
    progress bar = progress_start(o, j->how);
    memset(result, 0, sizeof *result);
    memset(image, 0, pixels * sizeof *image);
    for (size_t i = 0; i < pixels; i++) image[i].rng = mcs_pcg32_for(o->seed, i, j->how);
    j->regions = learns ? learning_make(j->s, j->e, pixels, j->how == REGION) : NULL;
    if (learns && !j->regions) return 0;
    while (unfinished(o, result)) {
        const uint32_t samples = pass_length(o, learns, result->spp);
        OMP(omp parallel for schedule(dynamic) num_threads(o->threads))
        for (int row = (int)o->part - 1; row < (int)o->height; row += (int)o->parts) {
            render_row(j, (uint32_t)row, samples, image + (size_t)row * o->width);
            progress_row(&bar, samples);
        }
        result->spp += samples;
        if (learns && lesson_is_due(result->spp)) learning_advance(j->regions);
        picture_statistics(image, pixels, result);
        progress_pass(&bar, o, result);
    }
    progress_end(&bar, result);
    learning_free(j->regions);
    return 1;
}

/* Renders every strategy that is wanted, prints its row and writes its pictures. `next` is how far the image of one is
 * from that of the next: 0 where all share one. Returns 0 after a complaint. */
static int render_all(job *j, pixel_sums *image, size_t next, outcome *result) {
    const options *o = j->o;
    print_title(o, j->e);
    print_head();
    int ok = flush_output();
    for (int i = 0; ok && i < STRATEGIES; i++) {
        if (!o->wanted[i]) continue;
        j->how = (strategy)i;
        ok = render(j, image, &result[i]);
        if (ok) print_row(j->how, &result[i]);
        ok = ok && flush_output();
        if (ok)
            ok = o->given[O_PART] ? sums_write(o, j->how, j->e, image, &result[i])
                                  : write_pictures(o, j->how, j->e, image);
        image += next;
    }
    return ok;
}

int main(int argc, char **argv) {
    options o;
    if (!parse_arguments(argc, argv, &o)) return 2;
    if (o.help) {
        usage();
        return flush_output() ? 0 : 1;
    }
    if (o.merge) return merge(&o) ? 0 : 1;
    if (!(o.given[O_PART] ? can_write_sums(&o) : can_write_pictures(&o))) return 1;
    const unsigned count = count_strategies(&o);
    const size_t pixels = (size_t)o.width * o.height;
    const int sheets = o.stack || o.beside; /* they need all pictures at once */
    pixel_sums *image = malloc((sheets ? count : 1) * pixels * sizeof *image);
    environment e;
    memset(&e, 0, sizeof e);
    int ok = image ? environment_make(&e, &o) : complain("--size", "not enough memory for the picture");
    if (ok) {
        const scene s = scene_make(o.kind, (float)o.height / (float)o.width, e.main_light);
        job j = {&o, &s, &e, UNIFORM, NULL};
        outcome result[STRATEGIES];
        ok = render_all(&j, image, sheets ? pixels : 0, result);
        if (ok) print_tables(&o, count, result);
        ok = ok && flush_output() && (!sheets || write_sheets(&o, &e, image, count)) && reached_error(&o, result);
    }
    free(image);
    environment_free(&e);
    return ok ? 0 : 1;
}
