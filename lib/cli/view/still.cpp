/* A scene -> an image: an offscreen context, polygons and patches in one z-buffer. */
#include "cli/view/still.hpp"

#include "cli/view/scene_renderer.hpp"
#include "cli/view/vulkan.hpp"
#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"

#include <limits>

namespace gtx {

/* A context that lives as long as its picture. */
struct Offscreen {
    gtx_offscreen *context = nullptr;
    explicit Offscreen(bool gles)
    {
        gtx_error error;
        require_ok((gles ? gtx_offscreen_create_es : gtx_offscreen_create)(&context, &error),
                   error);
    }
    Offscreen(const Offscreen &) = delete;
    ~Offscreen() { gtx_offscreen_destroy(context); }
};

static gtx_view view_of(const Scene &scene, const StillOptions &options)
{
    gtx_camera camera = {};
    camera.radius = float(scene.radius);
    camera.azimuth = float(options.camera[0]);
    camera.elevation = float(options.camera[1]);
    camera.distance = float(options.camera[2]);
    gtx_view view = {};
    view.method = options.method;
    view.viewport_width = options.width;
    view.viewport_height = options.height;
    view.max_error = float(options.max_error);
    view.level = options.level;
    gtx_camera_matrices(&camera, float(options.width) / float(options.height), view.view,
                        view.projection);
    light_from_camera(view);
    return view;
}

static void draw_by_gl(const Scene &scene, const StillOptions &options, const gtx_view &view,
                       Still &out)
{
    Offscreen offscreen(options.gles);
    SceneRenderer renderer(gtx_offscreen_load);
    gtx_framebuffer target; /* dies with the context */
    gtx_error error;
    require_ok(gtx_framebuffer_create(&renderer.gl, int(options.width), int(options.height),
                                      &target, &error), error);
    renderer.show(scene);
    renderer.settle_worlds();
    renderer.draw(view);
    gtx_framebuffer_read_color(&renderer.gl, &target, out.color.data());
    gtx_framebuffer_read_depth(&renderer.gl, &target, out.depth.data());
}

static void draw_by_vulkan(const Scene &scene, const StillOptions &options, const gtx_view &view,
                           Still &out)
{
    if (!scene.meshes.empty() || !scene.worlds.empty())
        throw Error(GTX_ERROR_UNSUPPORTED, "by Vulkan only assets are drawn");
    VulkanDrawer drawer;
    Vector<gtx_instance> places;
    Vector<size_t> models;
    for (const PlacedAsset &placed : scene.assets) {
        drawer.add(placed.asset.get());
        models.push_back(places.size());
        places.push_back(place_in_scene(placed, scene.centre));
    }
    drawer.resize(options.width, options.height);
    drawer.draw(view, places, models, STILL_BACKGROUND);
    drawer.read(out.color, out.depth);
}

Still draw_still(const Scene &scene, const StillOptions &options)
{
    const gtx_view view = view_of(scene, options);
    const size_t pixels = size_t(options.width) * options.height;
    Still still;
    still.color.resize(4 * pixels);
    still.depth.resize(pixels);
    (options.vulkan ? draw_by_vulkan : draw_by_gl)(scene, options, view, still);
    for (float &d : still.depth)
        d = d < 1 ? gtx_camera_distance(view.projection, 0, d)
                  : std::numeric_limits<float>::infinity();
    return still;
}

} // namespace gtx
