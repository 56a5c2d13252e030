/* Frame times: the culled source mesh, cast and the paper's search, interleaved in one run.
 *
 *   bench ASSET.gtx MODEL [FRAMES]
 *
 * The mesh is indexed, in vertex-cache order, its back faces culled. Every cell of the table is the
 * median of FRAMES frames (default 12) over four azimuths, each finished with glFinish; the methods
 * take turns frame by frame, so that a machine that slows down slows all of them. Compare ratios. */
#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"
#include "host/polygons.h"
#include "mesh/mesh.hpp"

#include <geotex/render.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

using namespace gtx;

static void check(gtx_result result, const gtx_error &error)
{
    if (result == GTX_OK)
        return;
    std::fprintf(stderr, "bench: error: %s\n", error.message);
    std::exit(1);
}

static double milliseconds()
{
    using clock = std::chrono::steady_clock;
    return std::chrono::duration<double, std::milli>(clock::now().time_since_epoch()).count();
}

struct Bench {
    gtx_offscreen *context = nullptr;
    gtx_host_gl gl = {};
    gtx_polygon_program program = {};
    gtx_renderer *renderer = nullptr;
    gtx_model *model = nullptr;
    gtx_polygons polygons = {};
    gtx_info info = {};
};

static void open_context(Bench &bench)
{
    gtx_error error;
    gtx_renderer_desc desc = {};
    desc.load = gtx_offscreen_load;
    check(gtx_offscreen_create(&bench.context, &error), error);
    check(gtx_host_gl_init(&bench.gl, gtx_offscreen_load, nullptr, &error), error);
    check(gtx_polygon_program_create(&bench.gl, &bench.program, &error), error);
    check(gtx_renderer_create(&desc, &bench.renderer, &error), error);
}

static void upload_asset(Bench &bench, const char *path)
{
    gtx_error error;
    gtx_asset *asset;
    check(gtx_open_file(path, nullptr, &asset, &error), error);
    gtx_get_info(asset, &bench.info);
    check(gtx_model_create(bench.renderer, asset, &bench.model, &error), error);
    gtx_close(asset);
}

static size_t upload_mesh(Bench &bench, const char *path)
{
    Task task(0, nullptr, nullptr);
    CleanReport report;
    Mesh mesh = clean_mesh(import_mesh(path, task), task, report);
    Vec3d anchor(bench.info.anchor[0], bench.info.anchor[1], bench.info.anchor[2]);

    size_t corners = 3 * mesh.triangle_count();
    std::vector<gtx_polygon_vertex> vertices(corners);
    for (size_t c = 0; c < corners; ++c) {
        Vec3f p(mesh.position(c / 3, int(c % 3)) - anchor);
        Vec3f n = mesh.normals[c];
        Rgba8 color = mesh.colors.empty() ? Rgba8{} : mesh.colors[c];
        vertices[c] = {{p.x, p.y, p.z}, {n.x, n.y, n.z}, {color.r, color.g, color.b, 255}};
    }
    std::vector<uint32_t> indices(corners), remap(corners);
    size_t unique = meshopt_generateVertexRemap(remap.data(), nullptr, corners, vertices.data(),
                                                corners, sizeof vertices[0]);
    meshopt_remapIndexBuffer<uint32_t>(indices.data(), nullptr, corners, remap.data());
    meshopt_remapVertexBuffer(vertices.data(), vertices.data(), corners, sizeof vertices[0],
                              remap.data());
    meshopt_optimizeVertexCache(indices.data(), indices.data(), corners, unique);
    meshopt_optimizeVertexFetch(vertices.data(), indices.data(), corners, vertices.data(), unique,
                                sizeof vertices[0]);
    gtx_error error;
    check(gtx_polygons_create(&bench.gl, vertices.data(), uint32_t(unique), indices.data(),
                              uint32_t(corners), &bench.polygons, &error), error);
    return mesh.triangle_count();
}

static void draw_mesh(Bench &bench, const gtx_view &view)
{
    const gtx_host_gl &gl = bench.gl;
    gl.Enable(GL_CULL_FACE);
    gl.CullFace(GL_BACK);
    gtx_polygons_draw(&gl, &bench.program, &bench.polygons, nullptr, view.view, view.projection,
                      view.light_direction, view.ambient);
    gl.Disable(GL_CULL_FACE);
}

static void draw_patches(Bench &bench, gtx_view view, gtx_method method)
{
    gtx_error error;
    gtx_instance instance = {};
    instance.model = bench.model;
    for (int i = 0; i < 16; i += 5)
        instance.transform[i] = 1;
    view.method = method;
    check(gtx_draw(bench.renderer, &view, &instance, 1, &error), error);
}

static gtx_view view_of(const Bench &bench, int width, int height, int turn)
{
    gtx_camera camera = {};
    float diagonal = 0;
    for (int i = 0; i < 3; ++i) {
        camera.target[i] = (bench.info.bounds_min[i] + bench.info.bounds_max[i]) / 2;
        float side = bench.info.bounds_max[i] - bench.info.bounds_min[i];
        diagonal += side * side;
    }
    camera.radius = std::sqrt(diagonal) / 2;
    camera.azimuth = 20 + 90 * float(turn % 4);
    camera.elevation = 15;
    camera.distance = 2.65f;
    gtx_view view = {};
    gtx_camera_matrices(&camera, float(width) / float(height), view.view, view.projection);
    for (int i = 0; i < 3; ++i)
        view.light_direction[i] = view.view[4 * i + 2];
    view.ambient = 0.2f;
    return view;
}

enum { MESH, CAST, PAPER, METHODS };

static void draw(Bench &bench, int method, const gtx_view &view)
{
    bench.gl.DepthMask(GL_TRUE);
    bench.gl.ClearDepthf(1);
    bench.gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    bench.gl.Enable(GL_DEPTH_TEST);
    bench.gl.DepthFunc(GL_LESS);
    if (method == MESH)
        draw_mesh(bench, view);
    else
        draw_patches(bench, view, method == CAST ? GTX_METHOD_CAST : GTX_METHOD_PAPER);
    bench.gl.Finish();
}

static size_t covered_pixels(Bench &bench, const gtx_framebuffer &target)
{
    std::vector<float> depth(size_t(target.width) * size_t(target.height));
    gtx_framebuffer_read_depth(&bench.gl, &target, depth.data());
    return size_t(std::count_if(depth.begin(), depth.end(), [](float d) { return d < 1; }));
}

static void measure_size(Bench &bench, int width, int height, int frames)
{
    gtx_error error;
    gtx_framebuffer target;
    check(gtx_framebuffer_create(&bench.gl, width, height, &target, &error), error);
    std::vector<double> times[METHODS];
    for (int method = 0; method < METHODS; ++method) /* warm up */
        draw(bench, method, view_of(bench, width, height, 0));
    size_t pixels = 0;
    for (int frame = 0; frame < frames; ++frame)
        for (int method = 0; method < METHODS; ++method) {
            gtx_view view = view_of(bench, width, height, frame);
            double start = milliseconds();
            draw(bench, method, view);
            times[method].push_back(milliseconds() - start);
            if (method == MESH && frame == 0)
                pixels = covered_pixels(bench, target);
        }
    double median[METHODS];
    for (int method = 0; method < METHODS; ++method) {
        std::sort(times[method].begin(), times[method].end());
        median[method] = times[method][times[method].size() / 2];
    }
    char size[32];
    std::snprintf(size, sizeof size, "%dx%d", width, height);
    std::printf("| %-9s | %8zu | %8.2f | %8.2f | %8.2f | %6.2f | %6.2f |\n", size, pixels,
                median[MESH], median[CAST], median[PAPER], median[MESH] / median[CAST],
                median[PAPER] / median[CAST]);
    std::fflush(stdout);
    gtx_framebuffer_destroy(&bench.gl, &target);
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "bench ASSET.gtx MODEL [FRAMES]\n");
        return 1;
    }
    int frames = argc > 3 ? std::max(1, std::atoi(argv[3])) : 12;
    static const int sizes[][2] = {{100, 100}, {200, 200}, {400, 400}, {640, 480},
                                   {800, 600}, {1024, 768}, {1280, 1024}};
    Bench bench;
    open_context(bench);
    upload_asset(bench, argv[1]);
    size_t triangles = 0;
    try {
        triangles = upload_mesh(bench, argv[2]);
    } catch (const Error &e) {
        std::fprintf(stderr, "%s: error: %s\n", argv[2], e.what());
        return 1;
    }
    gtx_model_size size = gtx_model_gpu_size(bench.model);
    std::printf("%s: %zu triangles, %u patches, %.2f bytes a triangle on the GPU (colour apart)\n",
                argv[2], triangles, bench.info.patch_count, double(size.geometry) / double(triangles));
    std::printf("%s, median milliseconds of %d frames\n", bench.gl.GetString(GL_RENDERER), frames);
    std::printf("| window    | pixels   | mesh     | cast     | paper    | mesh/cast | paper/cast |\n"
                "|---|---|---|---|---|---|---|\n");
    for (const int *s : sizes)
        measure_size(bench, s[0], s[1], frames);
    gtx_polygons_destroy(&bench.gl, &bench.polygons);
    gtx_model_destroy(bench.renderer, bench.model);
    gtx_renderer_destroy(bench.renderer);
    gtx_polygon_program_destroy(&bench.gl, &bench.program);
    gtx_offscreen_destroy(bench.context);
    return 0;
}
