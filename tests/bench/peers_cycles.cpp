/* Samplers of Cycles for peers.c: what its kernel for processors includes. */
#define CCL_NAMESPACE_BEGIN namespace ccl {
#define CCL_NAMESPACE_END }
#include "kernel/globals.h"
#include "kernel/light/area.h"
#include "kernel/light/triangle.h"
#include "kernel/closure/bsdf_microfacet.h"
#include "kernel/closure/volume_util.h"
#include "peers.h"
#include <vector>

using namespace ccl;

/* A scene of lights: triangles that are seen from both sides, with corners in the space of the world, and rectangles. */
static const peers_task *tasks;
static KernelGlobalsCPU &scene = *new KernelGlobalsCPU;
static std::vector<packed_float3> corners;
static std::vector<packed_uint3> triangles;
static std::vector<uint> shader_of;
static std::vector<KernelLight> rectangles;
static KernelShader shader;
static KernelObject object;
static const uint object_flag = SD_OBJECT_TRANSFORM_APPLIED;

static float3 float3_of(const float *v) { return make_float3(v[0], v[1], v[2]); }

/* Light goes to the side of dir, in all directions. */
static KernelLight rectangle_of(const peers_task &t) {
    KernelLight l = {};
    const float3 edge_u = float3_of(t.edge[0]);
    const float3 edge_v = float3_of(t.edge[1]);
    l.co = float3_of(t.corner[0]) + 0.5f * (edge_u + edge_v);
    l.area.len_u = len(edge_u);
    l.area.len_v = len(edge_v);
    l.area.axis_u = edge_u / l.area.len_u;
    l.area.axis_v = edge_v / l.area.len_v;
    l.area.invarea = 1 / (l.area.len_u * l.area.len_v);
    l.area.dir = normalize(cross(edge_u, edge_v));
    if (dot(l.co - float3_of(t.point), l.area.dir) > 0) l.area.dir = -l.area.dir;
    l.area.tan_half_spread = FLT_MAX;
    return l;
}

static void prepare(const peers_task *t, size_t n) {
    tasks = t;
    corners.clear();
    triangles.clear();
    rectangles.clear();
    for (uint i = 0; i < n; i++) {
        for (const float *corner : t[i].corner) corners.push_back(float3_of(corner));
        triangles.push_back(make_uint3(3 * i, 3 * i + 1, 3 * i + 2));
        rectangles.push_back(rectangle_of(t[i]));
    }
    shader_of.assign(n, 0);
    shader.flags = SD_MIS_FRONT | SD_MIS_BACK;
    scene.data.integrator.use_light_tree = 1;
    scene.tri_verts.data = corners.data();
    scene.tri_vindex.data = triangles.data();
    scene.tri_shader.data = shader_of.data();
    scene.shaders.data = &shader;
    scene.objects.data = &object;
    scene.object_flag.data = &object_flag;
}

/* What a thread has beyond the scene is not read. A sample that is given up has the density 0. */
static void triangle(size_t task, const peers_samples *s) {
    const KernelGlobals kg = static_cast<const ThreadKernelGlobalsCPU *>(&scene);
    const float3 p = float3_of(tasks[task].point);
    for (size_t i = 0; i < s->n; i++) {
        LightSample l;
        const float2 u = make_float2(s->u1[i], s->u2[i]);
        const bool drawn = triangle_light_sample<false>(kg, int(task), 0, u, -1, &l, p);
        peers_put(s, i, l.D, drawn ? l.pdf : 0);
    }
}

static void rectangle(size_t task, const peers_samples *s) {
    const float3 p = float3_of(tasks[task].point);
    for (size_t i = 0; i < s->n; i++) {
        LightSample l;
        const bool drawn = area_light_sample<false>(&rectangles[task], make_float2(s->u1[i], s->u2[i]), p, &l);
        peers_put(s, i, l.D, drawn ? l.pdf : 0);
    }
}

/* u1 = 0 is -z here, and the frame of +z is turned by an eighth. */
static void henyey_greenstein(size_t task, const peers_samples *s) {
    const float g = tasks[task].g;
    for (size_t i = 0; i < s->n; i++) {
        float pdf;
        const float2 u = make_float2(1 - s->u1[i], s->u2[i]);
        const float3 w = phase_henyey_greenstein_sample(make_float3(0, 0, 1), g, u, &pdf);
        peers_put(s, i, w, pdf);
    }
}

/* What bsdf_microfacet_sample does for one alpha in local coordinates, but for Fresnel's factor and the value. It calls
 * wi what is wo here. */
static void ggx(size_t task, const peers_samples *s) {
    const float alpha = tasks[task].alpha;
    const float3 wo = float3_of(tasks[task].wo);
    for (size_t i = 0; i < s->n; i++) {
        const float3 h = microfacet_ggx_sample_vndf(wo, alpha, alpha, make_float2(s->u1[i], s->u2[i]));
        const float d = bsdf_D<MicrofacetType::GGX>(alpha * alpha, h.z);
        const float lambda = bsdf_lambda<MicrofacetType::GGX>(alpha * alpha, wo.z);
        peers_put(s, i, 2 * dot(h, wo) * h - wo, 0.25f * d / wo.z / (1 + lambda));
    }
}

const peers_peer peer = {"Cycles", prepare, {triangle, rectangle, henyey_greenstein, ggx}, -0.125f, 1};
