/* A scene -> an image: an offscreen context, polygons and patches in one z-buffer. */
#include "cli/still.hpp"

#include "cli/polygons.hpp"
#include "host/camera.h"
#include "host/framebuffer.h"
#include "host/offscreen.h"

#include <cstring>
#include <limits>

namespace gtx {

static void check(gtx_result result, const gtx_error &error)
{
    if (result != GTX_OK)
        throw Error(result, error.message);
}

/* GL objects of one picture; they die with the context, which dies last. */
struct Studio {
    gtx_offscreen *context = nullptr;
    gtx_host_gl gl = {};
    gtx_framebuffer target = {};
    gtx_polygon_program program = {};
    gtx_renderer *renderer = nullptr;
    std::vector<gtx_model *> models;

    Studio(uint32_t width, uint32_t height)
    {
        gtx_error error;
        gtx_renderer_desc desc = {};
        desc.load = gtx_offscreen_load;
        check(gtx_offscreen_create(&context, &error), error);
        check(gtx_host_gl_init(&gl, gtx_offscreen_load, nullptr, &error), error);
        check(gtx_framebuffer_create(&gl, int(width), int(height), &target, &error), error);
        check(gtx_polygon_program_create(&gl, &program, &error), error);
        check(gtx_renderer_create(&desc, &renderer, &error), error);
    }
    Studio(const Studio &) = delete;
    ~Studio()
    {
        for (gtx_model *model : models)
            gtx_model_destroy(renderer, model);
        gtx_renderer_destroy(renderer);
        gtx_offscreen_destroy(context);
    }
};

static void draw_mesh(Studio &studio, const Mesh &mesh, const Vec3d &centre, const gtx_view &view)
{
    const Polygons shape = make_polygons(mesh, centre);
    gtx_polygons polygons;
    gtx_error error;
    check(gtx_polygons_create(&studio.gl, shape.vertices.data(), uint32_t(shape.vertices.size()),
                              shape.indices.data(), uint32_t(shape.indices.size()), &polygons,
                              &error), error);
    gtx_polygons_draw(&studio.gl, &studio.program, &polygons, nullptr, view.view, view.projection,
                      view.light_direction, view.ambient);
    gtx_polygons_destroy(&studio.gl, &polygons);
}

/* The transform of an asset's own coordinates, with the scene's centre at the origin. */
static gtx_instance place(const PlacedAsset &placed, const gtx_model *model, const Vec3d &centre)
{
    gtx_info info;
    gtx_get_info(placed.asset.get(), &info);
    gtx_instance instance = {};
    instance.model = model;
    const Transform &m = placed.transform;
    for (int i = 0; i < 16; ++i)
        instance.transform[i] = float(m[size_t(i)]);
    for (int row = 0; row < 3; ++row) {
        double sum = m[size_t(12 + row)] - centre[row];
        for (int k = 0; k < 3; ++k)
            sum += m[size_t(4 * k + row)] * info.anchor[k];
        instance.transform[12 + row] = float(sum);
    }
    return instance;
}

/* A key light over the camera's left shoulder. */
static void light_from_camera(gtx_view &view)
{
    const float eye[3] = {-0.40f, 0.55f, 0.73f};
    for (int i = 0; i < 3; ++i)
        view.light_direction[i] = view.view[4 * i] * eye[0] + view.view[4 * i + 1] * eye[1] +
                                  view.view[4 * i + 2] * eye[2];
    view.ambient = 0.2f;
}

Still draw_still(const Scene &scene, const StillOptions &options)
{
    Studio studio(options.width, options.height);
    gtx_camera camera = {};
    camera.radius = float(scene.radius);
    camera.azimuth = float(options.camera[0]);
    camera.elevation = float(options.camera[1]);
    camera.distance = float(options.camera[2]);
    gtx_view view = {};
    view.method = options.method;
    gtx_camera_matrices(&camera, float(options.width) / float(options.height), view.view,
                        view.projection);
    light_from_camera(view);

    gtx_error error;
    std::vector<gtx_instance> instances;
    for (const PlacedAsset &placed : scene.assets) {
        gtx_model *model;
        check(gtx_model_create(studio.renderer, placed.asset.get(), &model, &error), error);
        studio.models.push_back(model);
        instances.push_back(place(placed, model, scene.centre));
    }

    const gtx_host_gl &gl = studio.gl;
    gl.ClearColor(0.92f, 0.93f, 0.95f, 1);
    gl.ClearDepth(1);
    gl.DepthMask(GL_TRUE);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_LESS);
    for (const Mesh &mesh : scene.meshes)
        draw_mesh(studio, mesh, scene.centre, view);
    if (!instances.empty())
        check(gtx_draw(studio.renderer, &view, instances.data(), uint32_t(instances.size()), &error),
              error);

    Still still;
    size_t pixels = size_t(options.width) * options.height;
    still.color.resize(4 * pixels);
    still.depth.resize(pixels);
    gtx_framebuffer_read_color(&gl, &studio.target, still.color.data());
    gtx_framebuffer_read_depth(&gl, &studio.target, still.depth.data());
    for (float &d : still.depth)
        d = d < 1 ? gtx_camera_distance(view.projection, 0, d)
                  : std::numeric_limits<float>::infinity();
    return still;
}

} // namespace gtx
