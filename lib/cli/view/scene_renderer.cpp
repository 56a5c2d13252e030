/* A scene on the GPU: models and polygons, in one z-buffer. */
#include "cli/view/scene_renderer.hpp"

#include "cli/cli.h"
#include "cli/view/mesh_program.hpp"
#include "host/jobs.h"

#include <algorithm>
#include <cmath>

namespace gtx {

SceneRenderer::SceneRenderer(gtx_host_load load)
{
    gtx_error error;
    const gtx_jobs jobs = gtx_host_jobs(0);
    gtx_renderer_desc desc = {};
    desc.load = load;
    desc.jobs = &jobs;
    require_ok(gtx_host_gl_init(&gl, load, nullptr, &error), error);
    require_ok(gtx_polygon_program_create(&gl, &program, &error), error);
    try {
        mesh_program = make_mesh_program(gl);
        require_ok(gtx_renderer_create(&desc, &renderer, &error), error);
    } catch (const Error &) {
        gtx_polygon_program_destroy(&gl, &mesh_program);
        gtx_polygon_program_destroy(&gl, &program);
        throw;
    }
}

SceneRenderer::~SceneRenderer()
{
    clear();
    gtx_renderer_destroy(renderer);
    gtx_polygon_program_destroy(&gl, &mesh_program);
    gtx_polygon_program_destroy(&gl, &program);
}

void SceneRenderer::clear()
{
    streams.clear();
    for (Uploaded &p : views) {
        for (gtx_model *model : p.models)
            gtx_model_destroy(renderer, model);
        for (MeshOnGpu &mesh : p.meshes) {
            gtx_polygons_destroy(&gl, &mesh.polygons);
            gl.DeleteBuffers(1, &mesh.emissions);
        }
        p = Uploaded();
    }
    for (gtx_polygons &lines : boxes)
        gtx_polygons_destroy(&gl, &lines);
    boxes.clear();
    places.clear();
}

gtx_instance place_in_scene(const PlacedAsset &placed, const Vec3d &centre)
{
    gtx_info info;
    gtx_get_info(placed.asset.get(), &info);
    gtx_instance instance = {};
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

void SceneRenderer::show(const Scene &shown, Vector<gtx_model *> models)
{
    clear();
    scene = &shown;
    views[size_t(DebugView::NONE)].models = std::move(models);
    for (const PlacedAsset &placed : shown.assets)
        places.push_back(place_in_scene(placed, shown.centre));
    uploaded(DebugView::NONE);
}

static gtx_polygons upload(const gtx_host_gl &gl, const Polygons &shape)
{
    gtx_polygons polygons;
    gtx_error error;
    const gtx_polygon_data data = {shape.vertices.data(), shape.indices.data(),
                                   uint32_t(shape.vertices.size()), uint32_t(shape.indices.size())};
    require_ok(gtx_polygons_create(&gl, &data, &polygons, &error), error);
    return polygons;
}

gtx_model *SceneRenderer::make_model(const gtx_asset *asset)
{
    const gtx_jobs jobs = gtx_host_jobs(0);
    gtx_model_desc desc = {};
    desc.jobs = &jobs;
    desc.borrow = 1;
    desc.limits = cli_limits;
    gtx_model *model;
    gtx_error error;
    require_ok(gtx_model_prepare(asset, &desc, &model, &error), error);
    if (gtx_model_upload(renderer, model, 0, nullptr, &error) != GTX_OK) {
        gtx_model_destroy(renderer, model);
        throw Error(error);
    }
    return model;
}

SceneRenderer::Uploaded &SceneRenderer::uploaded(DebugView debug)
{
    Uploaded &p = views[size_t(debug)];
    if (p.ready)
        return p;
    for (size_t i = p.models.size(); i < scene->assets.size(); ++i) {
        const gtx_asset *asset = scene->assets[i].asset.get();
        AssetPointer copy;
        if (debug != DebugView::NONE)
            copy = recolor(asset, debug);
        p.models.push_back(make_model(copy ? copy.get() : asset));
    }
    for (size_t i = p.meshes.size(); i < scene->meshes.size(); ++i) {
        Polygons shape = make_polygons(scene->meshes[i], scene->centre);
        recolor(shape, debug);
        p.meshes.push_back({upload(gl, shape), 0, shape.has_materials});
        p.meshes.back().emissions = add_emissions(gl, p.meshes.back().polygons, shape.emissions);
        p.polygon_bytes += shape.vertices.size() * sizeof shape.vertices[0] +
                           shape.indices.size() * sizeof shape.indices[0] +
                           shape.emissions.size() * sizeof shape.emissions[0];
    }
    p.ready = true;
    return p;
}

void SceneRenderer::draw(const gtx_view &view, DebugView debug)
{
    const Uploaded &p = uploaded(debug);
    gl.ClearColor(background[0], background[1], background[2], background[3]);
    gl.ClearDepthf(1);
    gl.DepthMask(GL_TRUE);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_LESS);
    for (const MeshOnGpu &mesh : p.meshes) {
        set_mesh_shading(gl, mesh_program, mesh.has_materials, view.view);
        gtx_polygons_draw(&gl, &mesh_program, &mesh.polygons, nullptr, &view);
    }
    Vector<gtx_instance> instances = places;
    for (size_t i = 0; i < instances.size(); ++i)
        instances[i].model = p.models[i];
    gtx_error error;
    add_worlds(view, instances);
    if (!instances.empty())
        require_ok(gtx_draw(renderer, &view, instances.data(), uint32_t(instances.size()), &error),
                   error);
}

void SceneRenderer::add_worlds(const gtx_view &view, Vector<gtx_instance> &instances)
{
    for (size_t i = streams.size(); i < scene->worlds.size(); ++i)
        streams.push_back(std::make_unique<WorldStream>(scene->worlds[i], renderer, scene->centre,
                                                        view.max_error));
    for (auto &stream : streams)
        if (settles)
            stream->settle(view, instances);
        else
            stream->frame(view, instances);
}

bool SceneRenderer::is_settled() const
{
    for (const auto &stream : streams)
        if (!stream->is_settled())
            return false;
    return streams.size() == scene->worlds.size();
}

std::string SceneRenderer::world_status() const
{
    std::string lines;
    for (const auto &stream : streams) {
        lines += stream->status() + "\n";
        if (stream->failure().result)
            lines += stream->failure().message + std::string("\n");
    }
    return lines;
}

float SceneRenderer::distance_to_worlds(const float origin[3], const float direction[3])
{
    float nearest = INFINITY;
    for (auto &stream : streams)
        nearest = std::min(nearest, stream->distance(origin, direction));
    return nearest;
}

void SceneRenderer::draw_boxes(const gtx_view &view)
{
    for (size_t i = boxes.size(); i < scene->assets.size(); ++i) {
        boxes.push_back(upload(gl, patch_boxes(scene->assets[i].asset.get())));
        boxes.back().mode = GL_LINES;
    }
    gtx_view unlit = view;
    unlit.ambient = 1;
    for (size_t i = 0; i < boxes.size(); ++i)
        gtx_polygons_draw(&gl, &program, &boxes[i], places[i].transform, &unlit);
}

uint64_t SceneRenderer::gpu_bytes() const
{
    const Uploaded &p = views[size_t(DebugView::NONE)];
    uint64_t bytes = 0;
    for (const gtx_model *model : p.models) {
        gtx_model_size size = gtx_model_gpu_size(model);
        bytes += size.geometry + size.color;
    }
    return bytes + p.polygon_bytes;
}

void light_from_camera(gtx_view &view)
{
    const float eye[3] = {-0.40f, 0.55f, 0.73f};
    for (int i = 0; i < 3; ++i)
        view.light_direction[i] = view.view[4 * i] * eye[0] + view.view[4 * i + 1] * eye[1] +
                                  view.view[4 * i + 2] * eye[2];
    view.ambient = 0.2f;
}

} // namespace gtx
