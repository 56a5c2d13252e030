/* Figure 9: four horizons seen from the top, in profile and obliquely, over the size of the
 * picture, against the mesh of the same grids.
 *
 *   figure9 OUT_FOLDER own|GRID_FOLDER [--frames N] [--sizes WxH,...]
 *
 * The grids are those of samples/horizons. The mesh has two triangles a cell, indexed, in
 * vertex-cache order; like the horizons it is seen from both sides, so none is culled. */
#include "bench/figure.hpp"

#include "../samples/horizons.h"
#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"
#include "host/polygons.h"

#include <geotex/render.h>
#include <meshoptimizer.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

static void check(gtx_result result, const gtx_error &error)
{
    if (result == GTX_OK)
        return;
    std::fprintf(stderr, "figure9: error: %s\n", error.message);
    std::exit(1);
}

constexpr float VERTICAL = 4;
static const struct {
    const char *name;
    float azimuth, elevation;
} views[] = {{"top", 0, 89}, {"profile", 0, 0}, {"oblique", 30, 35}};

static const struct {
    const char *name;
    gtx_method method;
} methods[] = {{"mesh", GTX_METHOD_AUTO}, {"cast", GTX_METHOD_CAST}, {"lod", GTX_METHOD_LOD},
               {"auto", GTX_METHOD_AUTO}, {"paper", GTX_METHOD_PAPER}};

struct Stage {
    gtx_offscreen *context;
    gtx_host_gl gl;
    gtx_polygon_program program;
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_info info;
    gtx_polygons mesh;
    size_t triangles;
};

/* ---- the mesh ---- */

/* The vertices of a grid's nodes, and of each cell's two triangles their corners. */
static void add_grid(const gtx_height_grid &grid, const gtx_info &info,
                     std::vector<gtx_polygon_vertex> &vertices, std::vector<uint32_t> &indices)
{
    constexpr uint32_t NONE = 0xffffffffu;
    std::vector<uint32_t> name(size_t(grid.nx) * grid.ny, NONE);
    auto height = [&](uint32_t i, uint32_t j) {
        return -VERTICAL * grid.values[size_t(j) * grid.nx + i];
    };
    for (uint32_t j = 0; j < grid.ny; ++j)
        for (uint32_t i = 0; i < grid.nx; ++i) {
            if (std::isnan(height(i, j)))
                continue;
            name[size_t(j) * grid.nx + i] = uint32_t(vertices.size());
            const uint32_t e = std::min(i + 1, grid.nx - 1), n = std::min(j + 1, grid.ny - 1);
            const float rise = height(e, j) - height(i, j), ahead = height(i, n) - height(i, j);
            gtx_polygon_vertex v = {};
            v.position[0] = float(grid.origin[0] + i * grid.spacing[0] - info.anchor[0]);
            v.position[1] = float(height(i, j) - info.anchor[1]);
            v.position[2] = float(-grid.origin[1] - j * grid.spacing[1] - info.anchor[2]);
            v.normal[0] = std::isnan(rise) ? 0 : float(-rise / grid.spacing[0]);
            v.normal[1] = 1;
            v.normal[2] = std::isnan(ahead) ? 0 : float(ahead / grid.spacing[1]);
            gtx_color(GTX_COLORS_VIRIDIS, grid.property[size_t(j) * grid.nx + i] / 25, v.color);
            v.color[3] = 255;
            vertices.push_back(v);
        }
    for (uint32_t j = 0; j + 1 < grid.ny; ++j)
        for (uint32_t i = 0; i + 1 < grid.nx; ++i) {
            const size_t at = size_t(j) * grid.nx + i;
            const uint32_t a = name[at], b = name[at + 1], c = name[at + grid.nx],
                           d = name[at + grid.nx + 1];
            if (std::max(std::max(a, b), std::max(c, d)) != NONE)
                indices.insert(indices.end(), {a, b, d, a, d, c});
        }
}

static void upload_mesh(Stage &stage, const gtx_height_grid *grids)
{
    std::vector<gtx_polygon_vertex> vertices;
    std::vector<uint32_t> indices;
    for (int k = 0; k < LAYERS; ++k)
        add_grid(grids[k], stage.info, vertices, indices);
    meshopt_optimizeVertexCache(indices.data(), indices.data(), indices.size(), vertices.size());
    meshopt_optimizeVertexFetch(vertices.data(), indices.data(), indices.size(), vertices.data(),
                                vertices.size(), sizeof vertices[0]);
    gtx_error error;
    const gtx_polygon_data data = {vertices.data(), indices.data(), uint32_t(vertices.size()),
                                   uint32_t(indices.size())};
    check(gtx_polygons_create(&stage.gl, &data, &stage.mesh, &error), error);
    stage.triangles = indices.size() / 3;
}

/* ---- the scene ---- */

static void load(Stage &stage, const char *folder)
{
    gtx_error error;
    gtx_height_grid grids[LAYERS];
    for (int k = 0; k < LAYERS; ++k)
        check(std::strcmp(folder, "own") ? read_layer(folder, k, &grids[k], &error)
                                         : make_layer(k, &grids[k]), error);
    gtx_horizons_desc desc = {};
    desc.depths = 1;
    desc.vertical = VERTICAL;
    desc.lod_levels = 5;
    gtx_asset *asset;
    check(gtx_horizons(grids, LAYERS, &desc, &asset, nullptr, &error), error);
    gtx_get_info(asset, &stage.info);
    gtx_renderer_desc renderer = {};
    renderer.load = gtx_offscreen_load;
    check(gtx_offscreen_create(&stage.context, &error), error);
    check(gtx_host_gl_init(&stage.gl, gtx_offscreen_load, nullptr, &error), error);
    check(gtx_polygon_program_create(&stage.gl, &stage.program, &error), error);
    check(gtx_renderer_create(&renderer, &stage.renderer, &error), error);
    check(gtx_model_create(stage.renderer, asset, &stage.model, &error), error);
    gtx_close(asset);
    upload_mesh(stage, grids);
}

static gtx_view view_of(const Stage &stage, size_t which, int width, int height)
{
    gtx_camera camera = {};
    float square = 0;
    for (int k = 0; k < 3; ++k) {
        camera.target[k] = (stage.info.bounds_min[k] + stage.info.bounds_max[k]) / 2;
        square += std::pow(stage.info.bounds_max[k] - stage.info.bounds_min[k], 2.f);
    }
    camera.radius = std::sqrt(square) / 2;
    camera.azimuth = views[which].azimuth;
    camera.elevation = views[which].elevation;
    camera.distance = 2.65f;
    gtx_view view = {};
    gtx_camera_matrices(&camera, float(width) / float(height), view.view, view.projection);
    view.light_direction[1] = 1;
    view.ambient = 0.2f;
    view.viewport_width = uint32_t(width);
    view.viewport_height = uint32_t(height);
    return view;
}

static void draw(const Stage &stage, size_t method, gtx_view view)
{
    stage.gl.DepthMask(GL_TRUE);
    stage.gl.ClearDepthf(1);
    stage.gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    stage.gl.Enable(GL_DEPTH_TEST);
    stage.gl.DepthFunc(GL_LESS);
    gtx_error error;
    if (!method) {
        gtx_polygons_draw(&stage.gl, &stage.program, &stage.mesh, nullptr, &view);
    } else {
        gtx_instance instance = {};
        instance.model = stage.model;
        for (int i = 0; i < 16; i += 5)
            instance.transform[i] = 1;
        view.method = methods[method].method;
        check(gtx_draw(stage.renderer, &view, &instance, 1, &error), error);
    }
    stage.gl.Finish();
}

static uint64_t covered_pixels(const Stage &stage, const gtx_framebuffer &target)
{
    std::vector<float> depth(size_t(target.width) * size_t(target.height));
    gtx_framebuffer_read_depth(&stage.gl, &target, depth.data());
    return uint64_t(std::count_if(depth.begin(), depth.end(), [](float d) { return d < 1; }));
}

static std::vector<FigureRow> measure(const Stage &stage, int frames, const std::string &sizes)
{
    std::vector<FigureRow> rows;
    for (size_t v = 0; v < sizeof views / sizeof *views; ++v) {
        std::stringstream list(sizes);
        for (std::string size; std::getline(list, size, ',');) {
            int width, height;
            gtx_error error;
            gtx_framebuffer target;
            if (std::sscanf(size.c_str(), "%dx%d", &width, &height) != 2)
                continue;
            check(gtx_framebuffer_create(&stage.gl, width, height, &target, &error), error);
            const gtx_view view = view_of(stage, v, width, height);
            for (size_t m = 0; m < sizeof methods / sizeof *methods; ++m) {
                const FigureTimes times = time_frames(frames, [&] { draw(stage, m, view); });
                rows.push_back({views[v].name, methods[m].name, size,
                                covered_pixels(stage, target), times.frames, times.median,
                                times.least});
                print_row(rows.back(), rows.size() == 1);
            }
            gtx_framebuffer_destroy(&stage.gl, &target);
        }
    }
    return rows;
}

int main(int argc, char **argv)
{
    int frames = 5;
    std::string sizes = "100x100,200x200,400x400,640x480,800x600,1024x768,1280x1024";
    bool good = argc >= 3 && argc % 2 == 1;
    for (int i = 3; good && i < argc; i += 2) {
        if (!std::strcmp(argv[i], "--frames"))
            good = (frames = std::atoi(argv[i + 1])) > 0;
        else if (!std::strcmp(argv[i], "--sizes"))
            sizes = argv[i + 1];
        else
            good = false;
    }
    if (!good) {
        std::fprintf(stderr, "figure9 OUT_FOLDER own|GRID_FOLDER [--frames N] [--sizes WxH,...]\n");
        return 1;
    }
    Stage stage = {};
    load(stage, argv[2]);
    const char *platform = reinterpret_cast<const char *>(stage.gl.GetString(GL_RENDERER));
    std::printf("Figure 9: %zu triangles, %u patches; %s\n", stage.triangles,
                stage.info.patch_count, platform);
    const std::vector<FigureRow> rows = measure(stage, frames, sizes);
    if (!write_figure(argv[1], "figure9", "Figure 9: four horizons from three sides", platform,
                      rows)) {
        std::fprintf(stderr, "figure9: error: %s cannot be written\n", argv[1]);
        return 1;
    }
    return 0;
}
