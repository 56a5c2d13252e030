/* Figure 2: the paper's search balanced by the slant of the view and not, from above and in
 * profile, beside the exact cast: frames a second, wrong rays and PSNR.
 *
 *   figure2 OUT_FOLDER
 *
 * Writes a picture of each beside the curves. One patch of 256 x 256 texels. A ray is wrong where
 * one way hits and the exact cast does not, or where they differ by more than a height step and an
 * eighth of a texel. */
#include "bench/figure.hpp"

#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"
#include "image/image.h"

#include <geotex/cook.h>
#include <geotex/render.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

static void check(gtx_result result, const gtx_error &error)
{
    if (result == GTX_OK)
        return;
    std::fprintf(stderr, "figure2: error: %s\n", error.message);
    std::exit(1);
}

constexpr uint32_t NODES = 256;
/* The cost of the search without balance lies between those of the balanced one. */
static const struct {
    const char *name;
    gtx_method method;
    uint32_t steps[2];
} ways[] = {{"cast", GTX_METHOD_CAST, {0, 0}},
            {"balanced", GTX_METHOD_PAPER, {0, 0}},
            {"25 + 5", GTX_METHOD_PAPER, {25, 5}}};
static const struct {
    const char *name;
    float elevation;
} views[] = {{"above", 85}, {"profile", 8}};
static const int sizes[][2] = {{200, 200}, {400, 400}, {640, 480}, {1024, 768}};
constexpr int PICTURES = 2; /* the size that pictures are kept of */

/* Hills with a row of thin fins, as a brick wall has its joints. */
static gtx_asset *make_field()
{
    static float values[NODES * NODES];
    for (uint32_t k = 0; k < NODES * NODES; ++k) {
        const float x = float(k % NODES), y = float(k / NODES);
        const float hills = 9 * std::sin(x / 23) * std::cos(y / 31) + 4 * std::sin((x + y) / 9);
        const bool fin = k % NODES % 24 < 3 && k / NODES % 40 > 8;
        values[k] = hills + (fin ? 14 : 0);
    }
    gtx_height_grid grid = {};
    grid.nx = grid.ny = NODES;
    grid.values = values;
    grid.spacing[0] = grid.spacing[1] = 1;
    gtx_horizons_desc desc = {};
    desc.tile = 512;
    gtx_asset *asset;
    gtx_error error;
    check(gtx_horizons(&grid, 1, &desc, &asset, nullptr, &error), error);
    return asset;
}

struct Stage {
    gtx_offscreen *context;
    gtx_host_gl gl;
    gtx_renderer *renderer;
    gtx_model *model;
    gtx_info info;
    float near; /* distances that differ by more are wrong */
};

static Stage set_up()
{
    Stage stage = {};
    gtx_error error;
    gtx_asset *asset = make_field();
    gtx_renderer_desc renderer = {};
    renderer.load = gtx_offscreen_load;
    check(gtx_offscreen_create(&stage.context, &error), error);
    check(gtx_host_gl_init(&stage.gl, gtx_offscreen_load, nullptr, &error), error);
    check(gtx_renderer_create(&renderer, &stage.renderer, &error), error);
    check(gtx_model_create(stage.renderer, asset, &stage.model, &error), error);
    gtx_get_info(asset, &stage.info);
    const gtx_patch *patch = gtx_patches(asset);
    stage.near = std::max(patch->extent_z / 254, patch->extent_x / float(patch->rect[2]) / 8);
    gtx_close(asset);
    return stage;
}

static gtx_view view_of(const Stage &stage, float elevation, int width, int height)
{
    gtx_camera camera = {};
    camera.radius = NODES * 0.71f;
    camera.azimuth = 30;
    camera.elevation = elevation;
    camera.distance = 2.2f;
    for (int k = 0; k < 3; ++k)
        camera.target[k] = (stage.info.bounds_min[k] + stage.info.bounds_max[k]) / 2;
    gtx_view view = {};
    gtx_camera_matrices(&camera, float(width) / float(height), view.view, view.projection);
    view.light_direction[0] = 0.4f;
    view.light_direction[1] = 1;
    return view;
}

static void draw(const Stage &stage, gtx_view view, size_t way)
{
    gtx_error error;
    gtx_instance instance = {};
    instance.model = stage.model;
    for (int i = 0; i < 16; i += 5)
        instance.transform[i] = 1;
    stage.gl.DepthMask(GL_TRUE);
    stage.gl.ClearDepthf(1);
    stage.gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    stage.gl.Enable(GL_DEPTH_TEST);
    stage.gl.DepthFunc(GL_LESS);
    view.method = ways[way].method;
    for (int k = 0; k < 2; ++k)
        view.search_steps[k] = ways[way].steps[k];
    check(gtx_draw(stage.renderer, &view, &instance, 1, &error), error);
    stage.gl.Finish();
}

struct Picture {
    std::vector<uint8_t> color;
    std::vector<float> depth;
};

static Picture read(const Stage &stage, const gtx_framebuffer &target)
{
    const size_t pixels = size_t(target.width) * size_t(target.height);
    Picture out = {std::vector<uint8_t>(4 * pixels), std::vector<float>(pixels)};
    gtx_framebuffer_read_color(&stage.gl, &target, out.color.data());
    gtx_framebuffer_read_depth(&stage.gl, &target, out.depth.data());
    return out;
}

/* OUT/figure2_SCENE_WAY.png */
static void keep(const std::string &folder, const char *scene, size_t way, const int size[2],
                 const Picture &picture)
{
    const std::string path = folder + "/figure2_" + scene + "_" + std::to_string(way) + ".png";
    gtx_error error;
    check(gtx_image_write_png(path.c_str(), uint32_t(size[0]), uint32_t(size[1]), 4,
                              picture.color.data(), &error), error);
}

/* Prints how a picture differs from the exact one. */
static void judge(const Stage &stage, const gtx_view &view, const Picture &exact,
                  const Picture &picture)
{
    uint64_t rays = 0, wrong = 0;
    double square = 0;
    for (size_t p = 0; p < exact.depth.size(); ++p) {
        const bool hit[2] = {exact.depth[p] < 1, picture.depth[p] < 1};
        if (!hit[0] && !hit[1])
            continue;
        ++rays;
        const float apart = gtx_camera_distance(view.projection, 0, exact.depth[p]) -
                            gtx_camera_distance(view.projection, 0, picture.depth[p]);
        wrong += hit[0] != hit[1] || std::fabs(apart) > stage.near;
        for (size_t k = 0; k < 3; ++k)
            square += std::pow(double(exact.color[4 * p + k]) - picture.color[4 * p + k], 2);
    }
    std::printf("    %llu of %llu rays wrong, PSNR %.1f dB\n",
                static_cast<unsigned long long>(wrong), static_cast<unsigned long long>(rays),
                10 * std::log10(255. * 255 * 3 * double(rays) / square));
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        std::fprintf(stderr, "figure2 OUT_FOLDER\n");
        return 1;
    }
    const Stage stage = set_up();
    const char *platform = reinterpret_cast<const char *>(stage.gl.GetString(GL_RENDERER));
    std::printf("Figure 2: one patch of %u x %u texels; %s\n", NODES, NODES, platform);
    std::vector<FigureRow> rows;
    for (const auto &from : views)
        for (const auto &size : sizes) {
            gtx_error error;
            gtx_framebuffer target;
            check(gtx_framebuffer_create(&stage.gl, size[0], size[1], &target, &error), error);
            const gtx_view view = view_of(stage, from.elevation, size[0], size[1]);
            Picture exact;
            for (size_t way = 0; way < sizeof ways / sizeof *ways; ++way) {
                const FigureTimes times = time_frames(8, [&] { draw(stage, view, way); });
                const Picture picture = read(stage, target);
                if (!way)
                    exact = picture;
                if (&size == &sizes[PICTURES])
                    keep(argv[1], from.name, way, size, picture);
                const uint64_t pixels =
                    uint64_t(std::count_if(picture.depth.begin(), picture.depth.end(),
                                           [](float d) { return d < 1; }));
                rows.push_back({from.name, ways[way].name,
                                std::to_string(size[0]) + "x" + std::to_string(size[1]), pixels,
                                times.frames, times.median, times.least});
                print_row(rows.back(), rows.size() == 1);
                if (way)
                    judge(stage, view, exact, picture);
            }
            gtx_framebuffer_destroy(&stage.gl, &target);
        }
    if (!write_figure(argv[1], "figure2", "Figure 2: the search balanced and not", platform,
                      rows)) {
        std::fprintf(stderr, "figure2: error: %s cannot be written\n", argv[1]);
        return 1;
    }
    return 0;
}
