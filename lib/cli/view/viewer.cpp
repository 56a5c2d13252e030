/* The window of `gtx view`: keys, drops, frames. Everything is drawn into a framebuffer of our own,
 * which is what pictures are read from: a covered or hidden window has no pixels to read. */
#include "cli/view/viewer.hpp"

#include "cli/cli.h"

#include <chrono>
#include <cmath>
#include <cstring>

namespace gtx {

const Viewer::Method Viewer::methods[] = {{GTX_METHOD_AUTO, "auto"},
                                          {GTX_METHOD_CAST, "cast"},
                                          {GTX_METHOD_LOD, "lod"},
                                          {GTX_METHOD_GRID, "grid"},
                                          {GTX_METHOD_PAPER, "paper"}};

const Viewer::Key Viewer::keys[] = {
    {'F', "frame everything", [](Viewer &v) { v.frame_all(); }},
    {'M', "method: auto, cast, lod, grid, paper", [](Viewer &v) { v.method = (v.method + 1) % 5; }},
    {'L', "level of detail: auto, 0, 1, 2, 3",
     [](Viewer &v) { v.view.level = (v.view.level + 1) % 5; }},
    {'P', "a colour a patch", [](Viewer &v) { v.toggle(DebugView::PATCHES); }},
    {'N', "normals as colours", [](Viewer &v) { v.toggle(DebugView::NORMALS); }},
    {'B', "boxes of the patches", [](Viewer &v) { v.boxes = !v.boxes; }},
    {'C', "contours: lines of equal height", [](Viewer &v) { v.contours = !v.contours; }},
    {'O', "light fixed, or with the camera", [](Viewer &v) { v.fixed_light = !v.fixed_light; }},
    {'G', "walk, fly, or orbit", [](Viewer &v) { v.change_motion(); }},
    {'S', "save a picture, but on foot: back",
     [](Viewer &v) { v.wants_picture = v.walker.motion() == Motion::ORBIT; }},
    {'K', "keep: save what was dropped and cooked", [](Viewer &v) { v.save_cooked(); }},
    {'X', "the source, or the asset", [](Viewer &v) { v.toggle_source(); }},
    {'T', "this text on and off", [](Viewer &v) { v.text = !v.text; }},
    {'H', "help", [](Viewer &v) { v.help = !v.help; }},
    {GTX_KEY_ESCAPE, "cancel cooking, then close", [](Viewer &v) { v.escape(); }},
};

/* All that the scene has must have an LOD mesh for that to be forced. */
static bool has_lods(const Scene &scene)
{
    bool all = scene.worlds.empty();
    for (const PlacedAsset &placed : scene.assets) {
        gtx_info info;
        gtx_get_info(placed.asset.get(), &info);
        all = all && info.lod_levels > 0;
    }
    return all;
}

std::string file_name(const std::string &path)
{
    const std::string world = world_at(path); /* known by its folder */
    const std::string &named = world.empty() || world == "." ? path : world;
    const size_t end = named.find_last_not_of('/') + 1;
    const size_t slash = named.rfind('/', end ? end - 1 : 0);
    return named.substr(slash + 1, end - slash - 1);
}

Viewer::Viewer(Scene scene_, std::string name_, const uint32_t size[2], const double at[3],
               size_t method_)
    : name(std::move(name_)), home{float(at[0]), float(at[1]), float(at[2])}, method(method_)
{
    gtx_error error;
    require_ok(gtx_window_create("gtx view", int(size[0]), int(size[1]), &camera, &window, &error),
               error);
    try {
        scene_renderer = std::make_unique<SceneRenderer>(gtx_window_load);
        show(std::move(scene_), {});
        frame_all();
    } catch (...) {
        release();
        throw;
    }
}

Viewer::~Viewer()
{
    release();
}

void Viewer::release()
{
    for (gtx_model *model : incoming.models)
        gtx_model_destroy(scene_renderer->renderer, model);
    if (target.object)
        gtx_framebuffer_destroy(&scene_renderer->gl, &target);
    source_renderer.reset();
    scene_renderer.reset();
    gtx_window_destroy(window);
}

void Viewer::show(Scene shown, Vector<gtx_model *> models)
{
    facts = Facts();
    shows_source = false;
    source_renderer.reset();
    walker.forget(); /* the rays of what will be closed */
    scene = std::move(shown);
    scene_renderer->show(scene, std::move(models));
    for (const PlacedAsset &placed : scene.assets) {
        gtx_info info;
        gtx_get_info(placed.asset.get(), &info);
        facts.triangles += info.source_triangles;
        facts.patches += info.patch_count;
        facts.bytes += info.file_size;
    }
    for (const Mesh &mesh : scene.meshes)
        facts.triangles += mesh.triangle_count();
    camera.radius = float(scene.radius);
    gtx_window_title(window, (name + " - gtx view").c_str());
}

void Viewer::frame_all()
{
    while (walker.motion() != Motion::ORBIT)
        walker.change(camera, scene, *scene_renderer);
    camera.azimuth = home[0];
    camera.elevation = home[1];
    camera.distance = home[2];
    std::fill(camera.pan, camera.pan + 3, 0.f);
}

void Viewer::change_motion()
{
    try {
        walker.change(camera, scene, *scene_renderer);
    } catch (const Error &e) { /* the asset is seen, but has too much for rays */
        note = e.message;
    }
}

/* Where the keys go: right, up, forward. */
static const struct {
    char key;
    float toward[3];
} walk_keys[] = {{'W', {0, 0, 1}},  {'S', {0, 0, -1}}, {'A', {-1, 0, 0}},
                 {'D', {1, 0, 0}},  {'E', {0, 1, 0}},  {'Q', {0, -1, 0}}};

/* As if a key were held for some time; whether it is one of those. */
bool Viewer::walk(char key, double seconds)
{
    for (const auto &k : walk_keys)
        if (k.key == key && walker.motion() != Motion::ORBIT) {
            walker.move(camera, k.toward, false, seconds);
            return true;
        }
    return false;
}

void Viewer::walk_by_hand()
{
    using Clock = std::chrono::steady_clock;
    const double longest = 0.1; /* seconds: what took longer was no step */
    const double now = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
    const double seconds = std::min(stepped > 0 ? now - stepped : 0, longest);
    stepped = now;
    float toward[3] = {0, 0, 0};
    for (const auto &k : walk_keys)
        for (int i = 0; i < 3; ++i)
            toward[i] += gtx_window_held(window, k.key) ? k.toward[i] : 0;
    walker.hasten(gtx_window_scrolled(window));
    walker.move(camera, toward, gtx_window_held(window, GTX_KEY_SHIFT), seconds);
}

void Viewer::press(char key)
{
    for (const Key &k : keys)
        if (k.key == key)
            k.act(*this);
}

void Viewer::toggle(DebugView wanted)
{
    debug = debug == wanted ? DebugView::NONE : wanted;
}

/* Beside the keys: what else can happen to a window. */
void Viewer::press_script(char key)
{
    if (key == '!')
        escape();
    else if (key == '<')
        gtx_window_resize(window, width / 2, height / 2);
    else if (key == '>')
        gtx_window_resize(window, width * 2, height * 2);
    else if (key == '_')
        gtx_window_minimise(window, minimised = !minimised);
    else if (const char upper = key >= 'a' && key <= 'z' ? char(key - 'a' + 'A') : key;
             !walk(upper, 0.1))
        press(upper);
}

void Viewer::escape()
{
    if (loader.busy() && !loader.cancelling()) {
        loader.cancel();
        code = EXIT_CODE_CANCELLED; /* even where the window closes before the cook has ended */
    } else {
        gtx_window_close(window);
    }
}

void Viewer::take_drops()
{
    Vector<std::string> paths;
    while (char *path = gtx_window_dropped(window)) {
        paths.push_back(path);
        std::free(path);
    }
    if (!paths.empty())
        loader.start(std::move(paths));
}

void Viewer::receive(Loader::Result result)
{
    for (const auto &[kind, sentence] : result.warnings)
        report_warning(result.path.c_str(), kind, sentence.c_str());
    for (gtx_model *model : incoming.models) /* of a drop before, not yet uploaded */
        gtx_model_destroy(scene_renderer->renderer, model);
    incoming = Loader::Result();
    if (result.error.result == GTX_OK) {
        incoming = std::move(result);
        return;
    }
    for (gtx_model *model : result.models)
        gtx_model_destroy(scene_renderer->renderer, model);
    note = file_name(result.path) + ": " + result.error.message;
    code = report_error(result.path.c_str(), &result.error);
}

/* A slice of the upload a frame, then the new scene takes the place of the old one. */
void Viewer::take_loaded()
{
    const uint64_t slice = 32 << 20;
    if (loader.busy() && loader.finished())
        receive(loader.join());
    for (gtx_model *model : incoming.models) {
        uint32_t done = 0;
        gtx_error error;
        require_ok(gtx_model_upload(scene_renderer->renderer, model, slice, &done, &error), error);
        if (!done)
            return;
    }
    const size_t count = incoming.models.size() + incoming.scene.worlds.size();
    if (!count)
        return;
    const size_t others = count - 1;
    name = file_name(incoming.path) + (others ? " and " + std::to_string(others) + " more" : "");
    note.clear();
    Vector<gtx_model *> models;
    models.swap(incoming.models);
    show(std::move(incoming.scene), std::move(models));
    incoming = Loader::Result();
    frame_all();
}

void Viewer::draw_frame()
{
    using Clock = std::chrono::steady_clock;
    gtx_error error;
    const gtx_host_gl &gl = scene_renderer->gl;
    if (target.width != width || target.height != height) {
        if (target.object)
            gtx_framebuffer_destroy(&gl, &target);
        require_ok(gtx_framebuffer_create(&gl, width, height, &target, &error), error);
    }
    const Clock::time_point start = Clock::now();
    gtx_framebuffer_bind(&gl, &target);
    gtx_camera_matrices(&camera, float(width) / float(height), view.view, view.projection);
    if (!fixed_light)
        light_from_camera(view);
    view.method = methods[method].method;
    if (view.method == GTX_METHOD_LOD && !has_lods(scene))
        view.method = GTX_METHOD_AUTO;
    view.viewport_width = uint32_t(width);
    view.viewport_height = uint32_t(height);
    (shows_source ? *source_renderer : *scene_renderer).draw(view, debug);
    if (boxes)
        scene_renderer->draw_boxes(view);
    if (contours)
        draw_lines();
    gl.Finish(); /* or the time would be that of giving orders */
    const double took = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    milliseconds = milliseconds > 0 ? 0.8 * milliseconds + 0.2 * took : took;
    if (wants_picture)
        save_screenshot();
    draw_overlay();
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, target.object);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

int Viewer::run(const ViewScript &script)
{
    const char *next = script.keys;
    bool dropped = !script.drop;
    uint32_t drawn = 0;
    while (gtx_window_next(window, &width, &height)) {
        for (const Key &k : keys)
            for (int n = gtx_window_pressed(window, k.key); n > 0; --n)
                press(k.key);
        if (!*script.keys)
            walk_by_hand();
        take_drops();
        if (!dropped)
            loader.start({script.drop});
        dropped = true;
        take_loaded();
        const bool loads = loader.busy() || !incoming.models.empty();
        if (*next && scene_renderer->is_settled() && !(*next == '~' && loads))
            press_script(*next++);
        if (width > 0 && height > 0) {
            draw_frame();
            ++drawn;
        }
        if (script.frames && drawn >= script.frames && !*next && !loader.busy() &&
            incoming.models.empty() && scene_renderer->is_settled())
            gtx_window_close(window);
    }
    if (script.picture && target.object) {
        gtx_framebuffer_bind(&scene_renderer->gl, &target);
        width = target.width;
        height = target.height;
        write_picture(script.picture);
    }
    return script.frames ? code : 0;
}

} // namespace gtx
