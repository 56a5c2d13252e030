/* Loads an asset and its mesh onto the GPU and draws them for `gtx bench`. */
#include "cli/bench/scene.hpp"

#include "cli/bench/shading.hpp"
#include "cli/cli.h"
#include "cli/view/scene_renderer.hpp"
#include "host/camera.h"
#include "host/jobs.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace gtx {

/* Error of the coarsest simplification along a path, in radii: more than half a pixel anywhere
 * nearer than six radii in a window of 1000 pixels. */
constexpr double MAX_LEVEL_ERROR = 0.003;
constexpr GLenum INVOCATIONS = 0x82F4; /* GL_FRAGMENT_SHADER_INVOCATIONS: OpenGL 4.6 */

double milliseconds()
{
    using clock = std::chrono::steady_clock;
    return std::chrono::duration<double, std::milli>(clock::now().time_since_epoch()).count();
}

Target::Target(const gtx_host_gl &functions, uint32_t width, uint32_t height) : gl(functions)
{
    gtx_error error;
    require_ok(gtx_framebuffer_create(&gl, int(width), int(height), &framebuffer, &error), error);
}

BenchContext::BenchContext()
{
    gtx_error error;
    require_ok(gtx_offscreen_create(&offscreen, &error), error);
}

BenchScene::BenchScene(const std::string &asset_path, const Mesh &mesh, const BenchOptions &options)
    : max_error(options.max_error), options_(options)
{
    gtx_error error;
    gtx_renderer_desc desc = {};
    desc.load = options.load;
    require_ok(gtx_host_gl_init(&gl, gtx_offscreen_load, nullptr, &error), error);
    require_ok(gtx_renderer_create(&desc, &renderer_, &error), error);
    setup.renderer = reinterpret_cast<const char *>(gl.GetString(GL_RENDERER));
    GLuint query;
    gl.GenQueries(1, &query);
    gl.BeginQuery(INVOCATIONS, query);
    counts_ = gl.GetError() == GL_NO_ERROR;
    if (counts_)
        gl.EndQuery(INVOCATIONS);
    gl.DeleteQueries(1, &query);
    load_asset(asset_path);
    program_ = make_bench_program(gl, info.has_material || info.has_emission);
    if (!mesh.triangles.empty())
        load_mesh(mesh);
}

BenchScene::~BenchScene()
{
    for (gtx_polygons &p : polygons_)
        gtx_polygons_destroy(&gl, &p);
    gtx_shading_destroy(renderer_, own_);
    gtx_model_destroy(renderer_, model_);
    gtx_renderer_destroy(renderer_);
    gtx_polygon_program_destroy(&gl, &program_);
}

void BenchScene::load_asset(const std::string &path)
{
    gtx_error error;
    gtx_asset *asset;
    const gtx_jobs jobs = gtx_host_jobs(0);
    gtx_open_desc open = {};
    gtx_model_desc model = {};
    open.jobs = model.jobs = &jobs;
    open.limits = model.limits = cli_limits;
    model.borrow = 1;
    model.compress = options_.compress;
    model.compress_normals = options_.compress_normals;
    const double start = milliseconds();
    require_ok(gtx_open_file(path.c_str(), &open, &asset, &error), error);
    AssetPointer owner(asset);
    const double opened = milliseconds();
    require_ok(gtx_model_prepare(asset, &model, &model_, &error), error);
    const double prepared = milliseconds();
    require_ok(gtx_model_upload(renderer_, model_, 0, nullptr, &error), error);
    gl.Finish();
    setup.open = opened - start;
    setup.prepare = prepared - opened;
    setup.upload = milliseconds() - prepared;
    gtx_get_info(asset, &info);
    setup.geometry_bytes = gtx_model_gpu_size(model_).geometry;
    open_vulkan(asset);
    float square = 0;
    for (int i = 0; i < 3; ++i) {
        centre_[i] = (info.bounds_min[i] + info.bounds_max[i]) / 2;
        square += std::pow(info.bounds_max[i] - info.bounds_min[i], 2.f);
    }
    radius_ = std::sqrt(square) / 2;
}

void BenchScene::load_mesh(const Mesh &mesh)
{
    const Vector<BenchMethod> &m = options_.methods;
    const Vec3d anchor(info.anchor[0], info.anchor[1], info.anchor[2]);
    const bool simplified = std::count(m.begin(), m.end(), BenchMethod::MESH_LOD) > 0;
    if (options_.along_path) {
        parts = make_part_levels(mesh, anchor, simplified, MAX_LEVEL_ERROR * double(radius_));
        part_drawer_ = std::make_unique<PartDrawer>(gl);
        floor_ = std::make_unique<Floor>(gl, info);
    } else {
        levels = make_mesh_levels(mesh, anchor, simplified);
    }
    const MeshLevels &drawn = options_.along_path ? parts.mesh : levels;
    setup.triangles = uint32_t(drawn.indices[0].size() / 3);
    for (const Vector<uint32_t> &indices : drawn.indices) {
        gtx_error error;
        polygons_.emplace_back();
        const gtx_polygon_data data = {drawn.vertices.data(), indices.data(),
                                       uint32_t(drawn.vertices.size()), uint32_t(indices.size())};
        require_ok(gtx_polygons_create(&gl, &data, &polygons_.back(), &error), error);
    }
}

/* The camera stands in front of the wall and keeps its light on the head. */
gtx_view BenchScene::view_of(const Shot &shot, Vector<gtx_instance> &placed) const
{
    const uint32_t columns = uint32_t(std::ceil(std::sqrt(shot.instances)));
    const uint32_t rows = (shot.instances + columns - 1) / columns;
    const float azimuth = 20 + 360.f / BENCH_TURNS * float(shot.turn);
    placed.assign(shot.instances, {});
    for (uint32_t i = 0; i < shot.instances; ++i) {
        gtx_instance &instance = placed[i];
        instance.model = model_;
        const float at[2] = {float(2 * (i % columns)) - float(columns - 1),
                             float(rows - 1) - float(2 * (i / columns))};
        float turned[16], moved[16];
        gtx_matrix_place(at[0] * radius_, at[1] * radius_, 0, -azimuth, 1, turned);
        gtx_matrix_place(-centre_[0], -centre_[1], -centre_[2], 0, 1, moved);
        gtx_matrix_multiply(turned, moved, instance.transform);
    }
    gtx_camera camera = {};
    camera.radius = float(columns) * radius_;
    camera.elevation = 15;
    camera.distance = 2.65f;
    gtx_view view = {};
    gtx_camera_matrices(&camera, float(shot.width) / float(shot.height), view.view,
                        view.projection);
    for (int i = 0; i < 3; ++i)
        view.light_direction[i] = view.view[4 * i + 2];
    view.ambient = 0.2f;
    view.viewport_width = shot.width;
    view.viewport_height = shot.height;
    view.max_error = float(max_error);
    return view;
}

void BenchScene::draw_mesh(BenchMethod method, const gtx_view &view,
                      const Vector<gtx_instance> &placed)
{
    gtx_polygons drawn = polygons_[method == BenchMethod::MESH_LOD ? level : 0];
    if (method == BenchMethod::MESH_STREAM) { /* drivers may keep buffers, but not contents */
        gl.BindBuffer(GL_ARRAY_BUFFER, drawn.vertices);
        gl.BufferData(GL_ARRAY_BUFFER,
                       GLsizeiptr(levels.vertices.size() * sizeof(gtx_polygon_vertex)),
                       levels.vertices.data(), GL_STREAM_DRAW);
        gl.BindVertexArray(drawn.vertex_array);
        gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(levels.indices[0].size() * 4),
                       levels.indices[0].data(), GL_STREAM_DRAW);
    }
    gl.Enable(GL_CULL_FACE);
    gl.CullFace(GL_BACK);
    set_bench_eye(gl, program_, view.view);
    for (const gtx_instance &instance : placed)
        gtx_polygons_draw(&gl, &program_, &drawn, instance.transform, &view);
    gl.Disable(GL_CULL_FACE);
}

void BenchScene::draw(BenchMethod method, const Shot &shot)
{
    Vector<gtx_instance> placed;
    const gtx_view view = view_of(shot, placed);
    draw(method, view, placed);
}

void BenchScene::draw(BenchMethod method, const gtx_view &view)
{
    Vector<gtx_instance> placed(1);
    placed[0].model = model_;
    for (int k = 0; k < 4; ++k)
        placed[0].transform[5 * k] = 1;
    draw(method, view, placed);
}

static void move_window(gtx_view &view, const double shift[2])
{
    const double step[2] = {2. / view.viewport_width, 2. / view.viewport_height};
    for (int column = 0; column < 4; ++column)
        for (int k = 0; k < 2; ++k)
            view.projection[4 * column + k] +=
                float(shift[k] * step[k] * double(view.projection[4 * column + 3]));
}

void BenchScene::draw(BenchMethod method, gtx_view view, const Vector<gtx_instance> &placed)
{
    move_window(view, shift_);
    if (without_vulkan(method) != method) {
        view.method = technique_of(method).method;
        draw_by_vulkan(method, view, placed);
        return;
    }
    gl.DepthMask(GL_TRUE);
    gl.ClearDepthf(1);
    gl.Clear(GL_DEPTH_BUFFER_BIT | (is_depth_pass(method) ? 0 : GL_COLOR_BUFFER_BIT));
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_LESS);
    const size_t drawn = method == BenchMethod::MESH_LOD ? level : 0;
    if (method == BenchMethod::FLOOR) {
        floor_->draw(view);
    } else if (is_mesh(method) && part_drawer_) {
        set_bench_eye(gl, program_, view.view);
        part_drawer_->draw(program_, polygons_[drawn], parts.parts[drawn], view);
    } else if (is_mesh(method)) {
        draw_mesh(method, view, placed);
    } else {
        const Technique technique = technique_of(method);
        view.method = technique.method;
        view.pass = technique.pass;
        if (method == BenchMethod::CAST_FRAGMENT)
            view.viewport_width = 0;
        if (is_own(method))
            shade_own(view);
        gtx_error error;
        require_ok(gtx_draw(renderer_, &view, placed.data(), uint32_t(placed.size()), &error),
                   error);
    }
    gl.Finish();
}

Picture BenchScene::read(BenchMethod method, const gtx_view &view, const Target &target)
{
    Picture out;
    if (without_vulkan(method) != method) {
        vulkan_->read(out.color, out.depth);
        return out;
    }
    out.color.resize(size_t(4) * view.viewport_width * view.viewport_height);
    out.depth.resize(size_t(view.viewport_width) * view.viewport_height);
    gtx_framebuffer_read_color(&gl, &target.framebuffer, out.color.data());
    gtx_framebuffer_read_depth(&gl, &target.framebuffer, out.depth.data());
    return out;
}

Picture BenchScene::picture(BenchMethod method, const Shot &shot, const Target &target)
{
    draw(method, shot);
    Vector<gtx_instance> placed;
    return read(method, view_of(shot, placed), target);
}

Picture BenchScene::picture(BenchMethod method, const gtx_view &view, const Target &target)
{
    draw(method, view);
    return read(method, view, target);
}

template <class What> Truth BenchScene::truth_of(const What &what, const Target &target)
{
    Truth out = make_truth([&](double x, double y) {
        shift_[0] = x;
        shift_[1] = y;
        return picture(BenchMethod::MESH, what, target);
    });
    shift_[0] = shift_[1] = 0;
    return out;
}

Truth BenchScene::truth(const Shot &shot, const Target &target)
{
    return truth_of(shot, target);
}

Truth BenchScene::truth(const gtx_view &view, const Target &target)
{
    return truth_of(view, target);
}

void BenchScene::set_floor(const Picture &covered, const gtx_view &view)
{
    floor_->cover(covered, view.viewport_width, view.viewport_height);
}

void BenchScene::count(BenchMethod method, Shot shot, uint64_t &rays, uint64_t &hits)
{
    rays = hits = 0;
    if (!counts_ || without_vulkan(method) != method)
        return;
    const GLenum what[2] = {INVOCATIONS, GL_SAMPLES_PASSED};
    GLuint queries[2];
    GLuint counted[2];
    gl.GenQueries(2, queries);
    for (int k = 0; k < 2; ++k)
        gl.BeginQuery(what[k], queries[k]);
    for (shot.turn = 0; shot.turn < BENCH_TURNS; ++shot.turn)
        draw(method, shot);
    for (int k = 0; k < 2; ++k) {
        gl.EndQuery(what[k]);
        gl.GetQueryObjectuiv(queries[k], GL_QUERY_RESULT, &counted[k]);
    }
    gl.DeleteQueries(2, queries);
    rays = counted[0];
    hits = counted[1];
}

uint32_t BenchScene::triangles(BenchMethod method) const
{
    if (!is_mesh(method))
        return 0;
    const MeshLevels &drawn = part_drawer_ ? parts.mesh : levels;
    return uint32_t(drawn.indices[method == BenchMethod::MESH_LOD ? level : 0].size() / 3);
}

} // namespace gtx
