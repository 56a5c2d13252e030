/* Rays into an asset: how many a second on one thread, and what they cost in a shader.
 *
 *   rays ASSET.gtx [--rays N]
 *
 * Chords join two points of the asset's bounding sphere, inner rays start anywhere in it towards
 * anywhere, grazing ones just above where chords hit, along the surface: no two rays have anything
 * in common. Each row is the best of three runs, in time of the processor, with the cells that a
 * ray visits, in the mean and at worst. Frames are 640 x 480 of the asset alone, the median of
 * five, finished with glFinish. */
#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"

extern "C" {
#include "trace/caster.h"
}

#include <geotex/render.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <random>
#include <string>
#include <vector>

static void check(gtx_result result, const gtx_error &error)
{
    if (result == GTX_OK)
        return;
    std::fprintf(stderr, "rays: error: %s\n", error.message);
    std::exit(1);
}

/* Of the processor: what else it does in the meantime does not count. */
static double seconds()
{
    return double(std::clock()) / CLOCKS_PER_SEC;
}

using Random = std::mt19937_64;

/* Unit, spread evenly. */
static void direction(Random &random, float out[3])
{
    std::uniform_real_distribution<double> uniform;
    double z = 2 * uniform(random) - 1, turn = 6.283185307179586 * uniform(random);
    double r = std::sqrt(1 - z * z);
    out[0] = float(r * std::cos(turn));
    out[1] = float(r * std::sin(turn));
    out[2] = float(z);
}

static std::vector<gtx_ray> random_rays(const gtx_info &info, size_t count, bool inside)
{
    Random random(1);
    std::uniform_real_distribution<double> uniform;
    float centre[3], radius = 0;
    for (int k = 0; k < 3; ++k) {
        centre[k] = (info.bounds_min[k] + info.bounds_max[k]) / 2;
        radius = std::hypot(radius, info.bounds_max[k] - centre[k]);
    }
    std::vector<gtx_ray> rays(count);
    for (gtx_ray &ray : rays) {
        float from[3], to[3];
        direction(random, from);
        direction(random, to);
        float reach = inside ? float(std::cbrt(uniform(random))) : 1;
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = centre[k] + radius * reach * from[k];
            ray.direction[k] = inside ? to[k] : radius * (to[k] - from[k]);
        }
        ray.t_min = ray.t_max = 0;
    }
    return rays;
}

/* From just above where chords hit, nearly along the surface. */
static std::vector<gtx_ray> grazing_rays(const gtx_caster *caster, const gtx_info &info,
                                         size_t count)
{
    constexpr float above = 0.003f, down = 0.02f; /* radii; a slope */
    Random random(2);
    std::vector<gtx_ray> chords = random_rays(info, 4 * count, false), rays;
    std::vector<gtx_hit> hits(chords.size());
    gtx_raycast(caster, chords.data(), hits.data(), chords.size(), 0);
    float radius = 0;
    for (int k = 0; k < 3; ++k)
        radius = std::hypot(radius, (info.bounds_max[k] - info.bounds_min[k]) / 2);
    for (size_t i = 0; i < hits.size() && rays.size() < count; ++i) {
        const float *n = hits[i].facet;
        float to[3];
        direction(random, to);
        const float along = to[0] * n[0] + to[1] * n[1] + to[2] * n[2];
        gtx_ray ray = {};
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = chords[i].origin[k] + hits[i].t * chords[i].direction[k] +
                            above * radius * n[k];
            ray.direction[k] = to[k] - (along + down) * n[k];
        }
        if (hits[i].patch != UINT32_MAX)
            rays.push_back(ray);
    }
    return rays;
}

enum RayKind { CHORDS, INNER, GRAZING, RAY_KINDS };

static void measure(const gtx_caster *caster, const gtx_info &info, size_t count, RayKind kind,
                    uint32_t flags)
{
    static const char *const names[RAY_KINDS] = {"chords", "inner rays", "grazing"};
    std::vector<gtx_ray> rays = kind == GRAZING ? grazing_rays(caster, info, count)
                                                : random_rays(info, count, kind == INNER);
    count = rays.size();
    std::vector<gtx_hit> hits(count);
    double best = INFINITY;
    for (int run = 0; run < 3; ++run) {
        double start = seconds();
        gtx_raycast(caster, rays.data(), hits.data(), count, flags);
        best = std::fmin(best, seconds() - start);
    }
    size_t met = 0;
    for (const gtx_hit &hit : hits)
        met += hit.patch != UINT32_MAX;
    uint64_t cells = 0, most = 0;
    for (const gtx_ray &ray : rays) {
        gtx_line line;
        const uint64_t visited =
            gtx_read_ray(&ray, &line) ? gtx_cast_line(caster, &line, flags).visited : 0;
        cells += visited;
        most = std::max(most, visited);
    }
    std::printf("%-10s %-9s %9zu %8.1f %% %10.3f %8.2f %6llu\n", names[kind],
                flags & GTX_RAY_ANY ? "any hit" : "first hit", count,
                100 * double(met) / double(count), double(count) / best / 1e6,
                double(cells) / double(count), static_cast<unsigned long long>(most));
}

enum { WIDTH = 640, HEIGHT = 480 };

struct Stage {
    gtx_offscreen *context = nullptr;
    gtx_host_gl gl = {};
    gtx_framebuffer framebuffer = {};
    gtx_renderer *renderer = nullptr;
    gtx_model *model = nullptr;
    gtx_rays *rays = nullptr;
    gtx_view view = {};
};

static void open_stage(Stage &stage, const gtx_asset *asset, const gtx_info &info)
{
    gtx_error error;
    gtx_renderer_desc desc = {};
    desc.load = gtx_offscreen_load;
    check(gtx_offscreen_create(&stage.context, &error), error);
    check(gtx_host_gl_init(&stage.gl, gtx_offscreen_load, nullptr, &error), error);
    check(gtx_framebuffer_create(&stage.gl, WIDTH, HEIGHT, &stage.framebuffer, &error), error);
    check(gtx_renderer_create(&desc, &stage.renderer, &error), error);
    check(gtx_model_create(stage.renderer, asset, &stage.model, &error), error);
    gtx_rays_desc all = {};
    all.assets = &asset;
    all.asset_count = all.max_instances = 1;
    gtx_ray_instance instance = {};
    for (int i = 0; i < 16; i += 5)
        instance.transform[i] = 1;
    check(gtx_rays_create(stage.renderer, &all, &stage.rays, &error), error);
    check(gtx_rays_place(stage.renderer, stage.rays, &instance, 1, &error), error);
    gtx_camera camera = {};
    for (int k = 0; k < 3; ++k) {
        camera.target[k] = (info.bounds_min[k] + info.bounds_max[k]) / 2;
        camera.radius = std::hypot(camera.radius, info.bounds_max[k] - camera.target[k]);
    }
    camera.azimuth = 30;
    camera.elevation = 15;
    camera.distance = 2.7f;
    gtx_camera_matrices(&camera, float(WIDTH) / HEIGHT, stage.view.view, stage.view.projection);
}

/* Draws with `light` as what the surface is lit by. */
static GLuint cast_program(const gtx_shading *shading)
{
    uint32_t programs[GTX_SHADING_PROGRAMS];
    gtx_shading_programs(shading, programs);
    return programs[0];
}

static void frame(Stage &stage, const char *name, int rays, const std::string &light)
{
    const std::string text = "layout(location = 0) out vec4 color;\n"
                             "void main() {\n"
                             "    gtx_surface s;\n"
                             "    if (!gtx_find(s)) discard;\n"
                             "    vec3 p = gtx_world_point(s), n = gtx_world_normal(s);\n"
                             "    float turn = gtx_ray_turn(gl_FragCoord.xy);\n"
                             "    color = vec4(vec3(" + light + "), 1.0);\n"
                             "    gtx_write_depth(s);\n"
                             "}\n";
    gtx_error error;
    gtx_shading *shading;
    gtx_instance instance = {};
    instance.model = stage.model;
    for (int i = 0; i < 16; i += 5)
        instance.transform[i] = 1;
    check(gtx_shading_create(stage.renderer, text.c_str(), &shading, &error), error);
    gtx_rays_bind(stage.renderer, stage.rays, cast_program(shading));
    stage.view.shading = shading;
    std::array<double, 5> times;
    for (size_t i = 0; i <= times.size(); ++i) { /* the first compiles */
        using clock = std::chrono::steady_clock;
        const auto start = clock::now();
        gtx_framebuffer_bind(&stage.gl, &stage.framebuffer);
        stage.gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        check(gtx_draw(stage.renderer, &stage.view, &instance, 1, &error), error);
        stage.gl.Finish();
        if (i)
            times[i - 1] = std::chrono::duration<double, std::milli>(clock::now() - start).count();
    }
    std::sort(times.begin(), times.end());
    std::printf("%-24s %6d %10.1f\n", name, rays, times[2]);
    gtx_shading_destroy(stage.renderer, shading);
}

static void measure_frames(const gtx_asset *asset, const gtx_info &info)
{
    Stage stage;
    open_stage(stage, asset, info);
    const float reach = info.bounds_max[0] - info.bounds_min[0];
    const std::string sun = "gtx_sunlight(p, n, vec3(0.48, 0.8, 0.36), ";
    const std::string sky = "gtx_skylight(p, n, " + std::to_string(reach) + ", ";
    std::printf("%-24s %6s %10s   %s\n", "frame", "rays", "ms",
                reinterpret_cast<const char *>(stage.gl.GetString(GL_RENDERER)));
    frame(stage, "cast, no shadow", 0, "max(n.y, 0.0)");
    frame(stage, "hard shadow", 1, sun + "0.0, 1, 0.0)");
    frame(stage, "soft shadow", 8, sun + "0.08, 8, turn)");
    frame(stage, "ambient occlusion", 8, sky + "8, turn)");
    gtx_rays_destroy(stage.renderer, stage.rays);
    gtx_model_destroy(stage.renderer, stage.model);
    gtx_renderer_destroy(stage.renderer);
    gtx_framebuffer_destroy(&stage.gl, &stage.framebuffer);
    gtx_offscreen_destroy(stage.context);
}

int main(int argc, char **argv)
{
    size_t count = 500000;
    if (argc == 4 && std::strcmp(argv[2], "--rays") == 0)
        count = std::strtoull(argv[3], nullptr, 10);
    if ((argc != 2 && argc != 4) || !count) {
        std::fprintf(stderr, "usage: rays ASSET.gtx [--rays N]\n");
        return 1;
    }
    gtx_error error;
    gtx_asset *asset;
    gtx_caster *caster;
    gtx_info info;
    check(gtx_open_file(argv[1], nullptr, &asset, &error), error);
    gtx_get_info(asset, &info);
    double start = seconds();
    check(gtx_caster_create(asset, nullptr, &caster, &error), error);
    std::printf("%u patches, caster made in %.0f ms\n", info.patch_count,
                1e3 * (seconds() - start));
    std::printf("%-10s %-9s %9s %10s %10s %8s %6s\n", "rays", "query", "count", "hit", "M rays/s",
                "cells", "most");
    for (RayKind kind : {CHORDS, INNER, GRAZING})
        for (uint32_t flags : {uint32_t(0), uint32_t(GTX_RAY_ANY)})
            measure(caster, info, count, kind, flags);
    measure_frames(asset, info);
    gtx_caster_destroy(caster);
    gtx_close(asset);
}
