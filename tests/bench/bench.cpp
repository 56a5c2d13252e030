/* Frame times: the culled source mesh, cast, shell, auto and the paper's search, interleaved.
 *
 *   bench ASSET.gtx MODEL [--frames N] [--max-error PIXELS] [--sizes WxH,...] [--methods NAME,...]
 *
 * The mesh is indexed, in vertex-cache order, its back faces culled. Every time is the median of N
 * frames (default 12) over four azimuths, each finished with glFinish; the methods take turns frame by
 * frame, so that a machine that slows down slows all of them. Compare ratios. IoU is that of the
 * silhouette with the mesh's, over the four azimuths; holes are pixels that the mesh covers with all
 * their neighbours, and the method does not. Work is the time of all processors together. */
#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"
#include "host/polygons.h"
#include "mesh/mesh.hpp"

#include <geotex/render.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <sstream>

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

/* What takes turns in a run; the mesh is drawn by the host. */
static const struct {
    const char *name;
    gtx_method method;
} methods[] = {{"mesh", GTX_METHOD_AUTO}, {"cast", GTX_METHOD_CAST}, {"shell", GTX_METHOD_SHELL},
               {"auto", GTX_METHOD_AUTO}, {"paper", GTX_METHOD_PAPER}};
enum { MESH, CAST, SHELL, AUTO, PAPER, METHODS };

/* What is asked for. */
struct Options {
    int frames = 12;
    float max_error = 0;
    std::vector<std::array<int, 2>> sizes = {{100, 100}, {200, 200},  {400, 400},  {640, 480},
                                             {800, 600}, {1024, 768}, {1280, 1024}};
    std::vector<int> methods = {MESH, CAST, SHELL, AUTO, PAPER}; /* the mesh first */
};

static gtx_view view_of(const Bench &bench, const Options &options, int width, int height,
                        int turn)
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
    view.viewport_height = uint32_t(height);
    view.max_error = options.max_error;
    return view;
}

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
        draw_patches(bench, view, methods[method].method);
    bench.gl.Finish();
}

static std::vector<bool> covered_pixels(Bench &bench, const gtx_framebuffer &target)
{
    std::vector<float> depth(size_t(target.width) * size_t(target.height));
    gtx_framebuffer_read_depth(&bench.gl, &target, depth.data());
    std::vector<bool> covered;
    for (float d : depth)
        covered.push_back(d < 1);
    return covered;
}

/* Times, and pixels that both the mesh and the method cover, or either. */
struct Column {
    std::vector<double> times, work; /* milliseconds; of all processors together */
    size_t both = 0, either = 0, holes = 0;
};

/* Whether a pixel and its eight neighbours are covered. */
static bool is_inside(const std::vector<bool> &covered, size_t pixel, size_t width)
{
    const size_t x = pixel % width, y = pixel / width;
    if (x == 0 || y == 0 || x + 1 == width || (y + 1) * width == covered.size())
        return false;
    for (size_t k = 0; k < 9; ++k)
        if (!covered[(y + k / 3 - 1) * width + x + k % 3 - 1])
            return false;
    return true;
}

static double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

/* Counts what each method covers, over the four azimuths; warms up. Returns the mesh's pixels. */
static size_t compare_outlines(Bench &bench, const Options &options, const gtx_framebuffer &target,
                               std::vector<Column> &columns)
{
    size_t pixels = 0;
    for (int turn = 0; turn < 4; ++turn) {
        const gtx_view view = view_of(bench, options, target.width, target.height, turn);
        std::vector<bool> mesh;
        for (size_t i = 0; i < columns.size(); ++i) {
            draw(bench, options.methods[i], view);
            const std::vector<bool> covered = covered_pixels(bench, target);
            if (i == 0)
                mesh = covered;
            for (size_t p = 0; p < mesh.size(); ++p) {
                columns[i].both += covered[p] && mesh[p];
                columns[i].either += covered[p] || mesh[p];
                columns[i].holes += !covered[p] && is_inside(mesh, p, size_t(target.width));
            }
        }
        pixels += size_t(std::count(mesh.begin(), mesh.end(), true));
    }
    return pixels;
}

static void time_frames(Bench &bench, const Options &options, const gtx_framebuffer &target,
                        std::vector<Column> &columns)
{
    for (int frame = 0; frame < options.frames; ++frame)
        for (size_t i = 0; i < columns.size(); ++i) {
            const gtx_view view = view_of(bench, options, target.width, target.height, frame);
            const std::clock_t work = std::clock();
            const double start = milliseconds();
            draw(bench, options.methods[i], view);
            columns[i].times.push_back(milliseconds() - start);
            columns[i].work.push_back(1e3 * double(std::clock() - work) / CLOCKS_PER_SEC);
        }
}

static void measure_size(Bench &bench, const Options &options, int width, int height)
{
    gtx_error error;
    gtx_framebuffer target;
    check(gtx_framebuffer_create(&bench.gl, width, height, &target, &error), error);
    std::vector<Column> columns(options.methods.size());
    const size_t pixels = compare_outlines(bench, options, target, columns);
    time_frames(bench, options, target, columns);
    const double mesh = median(columns[0].times), mesh_work = median(columns[0].work);
    for (size_t i = 0; i < columns.size(); ++i) {
        const Column &c = columns[i];
        const double time = median(c.times), work = median(c.work);
        const double least = *std::min_element(c.times.begin(), c.times.end());
        char size[32];
        std::snprintf(size, sizeof size, "%dx%d", width, height);
        std::printf("| %-9s | %7zu | %-6s | %8.2f | %8.2f | %6.2f | %8.2f | %6.2f | %6.4f | %5zu |\n",
                    size, pixels / 4, methods[options.methods[i]].name, time, least, mesh / time,
                    work, mesh_work / work,
                    double(c.both) / double(std::max<size_t>(c.either, 1)), c.holes);
    }
    std::fflush(stdout);
    gtx_framebuffer_destroy(&bench.gl, &target);
}

static std::vector<std::string> split(const std::string &list)
{
    std::vector<std::string> out;
    std::stringstream stream(list);
    for (std::string word; std::getline(stream, word, ',');)
        out.push_back(word);
    return out;
}

static bool parse_methods(const std::string &list, Options &options)
{
    options.methods = {MESH};
    for (const std::string &word : split(list))
        for (int m = CAST; m < METHODS; ++m)
            if (word == methods[m].name)
                options.methods.push_back(m);
    return options.methods.size() == split(list).size() + 1;
}

static bool parse(int argc, char **argv, Options &options)
{
    bool good = argc >= 3 && argc % 2 == 1;
    for (int i = 3; good && i < argc; i += 2) {
        const std::string name = argv[i], value = argv[i + 1];
        if (name == "--frames") {
            good = (options.frames = std::atoi(value.c_str())) > 0;
        } else if (name == "--max-error") {
            good = (options.max_error = float(std::atof(value.c_str()))) > 0;
        } else if (name == "--methods") {
            good = parse_methods(value, options);
        } else if (name == "--sizes") {
            options.sizes.clear();
            for (const std::string &word : split(value)) {
                std::array<int, 2> size;
                good = good && std::sscanf(word.c_str(), "%dx%d", &size[0], &size[1]) == 2;
                options.sizes.push_back(size);
            }
        } else {
            good = false;
        }
    }
    return good;
}

int main(int argc, char **argv)
{
    Options options;
    if (!parse(argc, argv, options)) {
        std::fprintf(stderr, "bench ASSET.gtx MODEL [--frames N] [--max-error PIXELS] "
                             "[--sizes WxH,...] [--methods cast,shell,auto,paper]\n");
        return 1;
    }
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
    if (!bench.info.shell_levels)
        options.methods.erase(std::remove(options.methods.begin(), options.methods.end(), SHELL),
                              options.methods.end());
    std::printf("%s, milliseconds of %d frames, levels within %g pixels\n",
                bench.gl.GetString(GL_RENDERER), options.frames,
                options.max_error > 0 ? double(options.max_error) : 0.5);
    std::printf("| window    | pixels  | method | median   | least    | mesh/  | work     | mesh/  | IoU    "
                "| holes |\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::array<int, 2> &s : options.sizes)
        measure_size(bench, options, s[0], s[1]);
    gtx_polygons_destroy(&bench.gl, &bench.polygons);
    gtx_model_destroy(bench.renderer, bench.model);
    gtx_renderer_destroy(bench.renderer);
    gtx_polygon_program_destroy(&bench.gl, &bench.program);
    gtx_offscreen_destroy(bench.context);
    return 0;
}
