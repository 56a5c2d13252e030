/* A scene -> an image: an offscreen context, polygons and patches in one z-buffer. */
#include "cli/view/still.hpp"

#include "cli/view/contours.hpp"
#include "cli/view/legend.hpp"
#include "host/camera.h"
#include "mesh/material/srgb.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gtx {

Studio::Offscreen::Offscreen(bool gles)
{
    gtx_error error;
    require_ok((gles ? gtx_offscreen_create_es : gtx_offscreen_create)(&context, &error), error);
}

Studio::Offscreen::~Offscreen()
{
    gtx_offscreen_destroy(context);
}

Studio::Studio(const StillOptions &options_)
    : options(options_), offscreen(options_.gles), renderer(gtx_offscreen_load)
{
    gtx_error error;
    require_ok(gtx_framebuffer_create(&renderer.gl, int(options.width), int(options.height),
                                      &target, &error), error);
    for (int k = 0; k < 4; ++k)
        renderer.background[k] = float(options.background[k]) / 255;
    renderer.settle_worlds();
}

void Studio::show(const Scene &shown)
{
    scene = &shown;
    if (!options.vulkan) {
        renderer.show(shown);
        return;
    }
    if (!shown.meshes.empty() || !shown.worlds.empty())
        throw Error(GTX_ERROR_UNSUPPORTED, "by Vulkan only assets are drawn");
    vulkan = std::make_unique<VulkanDrawer>();
    for (const PlacedAsset &placed : shown.assets)
        vulkan->add(placed.asset.get());
    vulkan->resize(options.width, options.height);
}

void Studio::draw_by_gl(const gtx_view &view, Still &out)
{
    gtx_framebuffer_bind(&renderer.gl, &target);
    renderer.draw(view, options.debug);
    gtx_framebuffer_read_color(&renderer.gl, &target, out.color.data());
    gtx_framebuffer_read_depth(&renderer.gl, &target, out.depth.data());
}

void Studio::draw_by_vulkan(const gtx_view &view, Still &out)
{
    Vector<gtx_instance> places;
    Vector<size_t> models;
    for (const PlacedAsset &placed : scene->assets) {
        models.push_back(places.size());
        places.push_back(place_in_scene(placed, scene->centre));
    }
    vulkan->draw(view, places, models, renderer.background);
    vulkan->read(out.color, out.depth);
}

static void set_light(const StillOptions &options, gtx_view &view)
{
    light_from_camera(view);
    if (!options.has_light)
        return;
    const double degree = std::acos(-1.0) / 180;
    const double a = options.light[0] * degree, e = options.light[1] * degree;
    view.light_direction[0] = float(std::sin(a) * std::cos(e));
    view.light_direction[1] = float(std::sin(e));
    view.light_direction[2] = float(std::cos(a) * std::cos(e));
    view.ambient = std::max(float(options.light[2]), 1e-6f); /* 0 would be the stock share */
}

Still Studio::draw(const Shot &shot)
{
    gtx_camera camera = {};
    camera.radius = float(scene->radius);
    camera.azimuth = float(shot.camera[0]);
    camera.elevation = float(shot.camera[1]);
    camera.distance = float(shot.camera[2]);
    gtx_view view = {};
    view.method = options.method;
    view.viewport_width = options.width;
    view.viewport_height = options.height;
    view.max_error = float(options.max_error);
    view.level = options.level;
    gtx_camera_matrices(&camera, float(options.width) / float(options.height), view.view,
                        view.projection);
    set_light(options, view);
    Still still;
    still.color.resize(4 * size_t(options.width) * options.height);
    still.depth.resize(size_t(options.width) * options.height);
    if (vulkan)
        draw_by_vulkan(view, still);
    else
        draw_by_gl(view, still);
    for (size_t i = 0; i < still.depth.size(); ++i) {
        float &d = still.depth[i];
        if (d < 1) /* what is drawn is solid, whatever a model's own alpha says */
            still.color[4 * i + 3] = 255;
        d = d < 1 ? gtx_camera_distance(view.projection, 0, d)
                  : std::numeric_limits<float>::infinity();
    }
    tint(still);
    if (options.contours)
        draw_contours(contours_of(*scene, options.contour_step), *scene, view, still.depth,
                      still.color);
    add_text(still, shot.label);
    return still;
}

void Studio::tint(Still &still) const
{
    if (options.debug == DebugView::NORMALS)
        return;
    for (size_t k = 0; k < 3; ++k) {
        const float share = srgb_to_linear(options.light_color[k]);
        uint8_t lit[256];
        for (int v = 0; v < 256; ++v)
            lit[v] = linear_to_srgb(srgb_to_linear(uint8_t(v)) * share);
        for (size_t i = 0; share < 1 && i < still.depth.size(); ++i)
            if (std::isfinite(still.depth[i]))
                still.color[4 * i + k] = lit[still.color[4 * i + k]];
    }
}

/* Text is drawn onto the empty framebuffer and laid over the picture, so that neither the light nor
 * a see-through background has a say in it. */
void Studio::add_text(Still &still, const std::string &label)
{
    const gtx_host_gl &gl = renderer.gl;
    Legend legend = options.legend ? legend_of(*scene, options.debug) : Legend();
    if (options.legend && options.contours)
        legend.entries.push_back(contours_legend(contours_of(*scene, options.contour_step).step));
    gtx_shapes shapes = {};
    add_label(shapes, options.width, options.height, label);
    add_legend(shapes, options.width, options.height, legend);
    if (!shapes.index_count && !shapes.failed)
        return;
    gtx_error error;
    gl.ClearColor(0, 0, 0, 0);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    require_ok(gtx_text_draw(&gl, &renderer.program, &shapes, int(options.width),
                             int(options.height), &error), error);
    Vector<uint8_t> over(still.color.size());
    gtx_framebuffer_read_color(&gl, &target, over.data());
    for (size_t i = 0; i < over.size(); i += 4)
        if (over[i + 3])
            std::copy_n(&over[i], 4, &still.color[i]);
}

} // namespace gtx
