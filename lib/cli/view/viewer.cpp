/* The window of `gtx view`. Everything is drawn into a framebuffer of our own, which is what
 * pictures are read from: a window that is covered or hidden has no pixels to read. */
#include "cli/view/viewer.hpp"

#include "cli/cli.h"
#include "image/image.h"

#include <chrono>
#include <cmath>
#include <cstring>
#include <unistd.h>

namespace gtx {

static const struct {
    gtx_method method;
    const char *name;
} methods[] = {{GTX_METHOD_AUTO, "auto"}, {GTX_METHOD_CAST, "cast"}, {GTX_METHOD_LOD, "lod"},
             {GTX_METHOD_PAPER, "paper"}};

const Viewer::Key Viewer::keys[] = {
    {'F', "frame everything", [](Viewer &v) { v.frame_all(); }},
    {'M', "method: auto, cast, lod, paper", [](Viewer &v) { v.method = (v.method + 1) % 4; }},
    {'L', "level of detail: auto, 0, 1, 2, 3",
     [](Viewer &v) { v.view.level = (v.view.level + 1) % 5; }},
    {'P', "a colour a patch",
     [](Viewer &v) { v.look = v.look == Look::PATCHES ? Look::PLAIN : Look::PATCHES; }},
    {'N', "normals as colours",
     [](Viewer &v) { v.look = v.look == Look::NORMALS ? Look::PLAIN : Look::NORMALS; }},
    {'B', "boxes of the patches", [](Viewer &v) { v.boxes = !v.boxes; }},
    {'O', "light fixed, or with the camera", [](Viewer &v) { v.fixed_light = !v.fixed_light; }},
    {'S', "save a picture", [](Viewer &v) { v.wants_picture = true; }},
    {'T', "this text on and off", [](Viewer &v) { v.text = !v.text; }},
    {'H', "help", [](Viewer &v) { v.help = !v.help; }},
    {GTX_KEY_ESCAPE, "cancel cooking, then close", [](Viewer &v) { v.escape(); }},
};

/* All that the scene has must have an LOD mesh for that to be forced. */
static bool has_lods(const Scene &scene)
{
    bool all = true;
    for (const PlacedAsset &placed : scene.assets) {
        gtx_info info;
        gtx_get_info(placed.asset.get(), &info);
        all = all && info.lod_levels > 0;
    }
    return all;
}

static std::string format_bytes(uint64_t bytes)
{
    static const char *const units[] = {"B", "kB", "MB", "GB"};
    double number = double(bytes);
    size_t unit = 0;
    for (; number >= 1000 && unit < 3; ++unit)
        number /= 1000;
    char text[32];
    std::snprintf(text, sizeof text, unit ? "%.1f %s" : "%.0f %s", number, units[unit]);
    return text;
}

std::string file_name(const std::string &path)
{
    return path.substr(path.rfind('/') + 1);
}

Viewer::Viewer(Scene scene_, std::string name_, const uint32_t size[2], const double at[3],
               size_t method_)
    : name(std::move(name_)), home{float(at[0]), float(at[1]), float(at[2])}, method(method_)
{
    gtx_error error;
    check(gtx_window_create("gtx view", int(size[0]), int(size[1]), &camera, &window, &error),
          error);
    try {
        stage = std::make_unique<Stage>(gtx_window_load);
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
        gtx_model_destroy(stage->renderer, model);
    if (target.object)
        gtx_framebuffer_destroy(&stage->gl, &target);
    stage.reset();
    gtx_window_destroy(window);
}

void Viewer::show(Scene shown, std::vector<gtx_model *> models)
{
    uint64_t triangles = 0, patches = 0, bytes = 0;
    scene = std::move(shown);
    stage->show(scene, std::move(models));
    for (const PlacedAsset &placed : scene.assets) {
        gtx_info info;
        gtx_get_info(placed.asset.get(), &info);
        triangles += info.source_triangles;
        patches += info.patch_count;
        bytes += info.file_size;
    }
    for (const Mesh &mesh : scene.meshes)
        triangles += mesh.triangle_count();
    facts = std::to_string(triangles) + " triangles  " + std::to_string(patches) + " patches  " +
            format_bytes(bytes) + " asset  ";
    camera.radius = float(scene.radius);
    gtx_window_title(window, (name + " - gtx view").c_str());
}

void Viewer::frame_all()
{
    camera.azimuth = home[0];
    camera.elevation = home[1];
    camera.distance = home[2];
    std::fill(camera.pan, camera.pan + 3, 0.f);
}

void Viewer::press(char key)
{
    for (const Key &k : keys)
        if (k.key == key)
            k.act(*this);
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
    else
        press(key >= 'a' && key <= 'z' ? char(key - 'a' + 'A') : key);
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
    std::vector<std::string> paths;
    while (char *path = gtx_window_dropped(window)) {
        paths.push_back(path);
        std::free(path);
    }
    if (!paths.empty())
        loader.start(std::move(paths));
}

void Viewer::receive(Loader::Result result)
{
    for (const std::string &warning : result.warnings)
        report_warning(result.path.c_str(), warning.c_str());
    for (gtx_model *model : incoming.models) /* of a drop before, not yet uploaded */
        gtx_model_destroy(stage->renderer, model);
    incoming = Loader::Result();
    if (result.error.result == GTX_OK) {
        incoming = std::move(result);
        return;
    }
    for (gtx_model *model : result.models)
        gtx_model_destroy(stage->renderer, model);
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
        check(gtx_model_upload(stage->renderer, model, slice, &done, &error), error);
        if (!done)
            return;
    }
    if (incoming.models.empty())
        return;
    size_t others = incoming.models.size() - 1;
    name = file_name(incoming.path) + (others ? " and " + std::to_string(others) + " more" : "");
    note.clear();
    std::vector<gtx_model *> models;
    models.swap(incoming.models);
    show(std::move(incoming.scene), std::move(models));
    frame_all();
}

void Viewer::write_picture(const std::string &path)
{
    std::vector<uint8_t> pixels(size_t(width) * size_t(height) * 4);
    gtx_error error;
    gtx_framebuffer_read_color(&stage->gl, &target, pixels.data());
    check(gtx_image_write_png(path.c_str(), uint32_t(width), uint32_t(height), 4, pixels.data(),
                              &error), error);
}

/* The picture without the text. */
void Viewer::save_screenshot()
{
    std::string path;
    for (int i = 1; path.empty() || access(path.c_str(), F_OK) == 0; ++i)
        path = "gtx-view-" + std::to_string(i) + ".png";
    wants_picture = false;
    try {
        write_picture(path);
        note = "saved " + path;
    } catch (const Error &e) {
        note = path + ": " + e.message;
    }
}

void Viewer::add_status(gtx_shapes &shapes, float dot)
{
    const gtx_text_style plain = {dot, {32, 36, 44}, {244, 245, 247}};
    const gtx_text_style loud = {dot, {176, 24, 16}, {255, 255, 255}};
    static const char *const looks_text[] = {"", "  patches", "  normals"};
    static const char *const levels_text[] = {"auto", "0", "1", "2", "3"};
    char line[160];
    const bool no_lod = view.method != methods[method].method;
    std::snprintf(line, sizeof line, "%s  level %s%s%s%s  %.1f ms  %dx%d",
                  no_lod ? "no LOD mesh: auto" : methods[method].name, levels_text[view.level],
                  looks_text[size_t(look)], boxes ? "  boxes" : "",
                  fixed_light ? "  light fixed" : "", milliseconds, width, height);
    std::string lines = name + "\n" + facts + format_bytes(stage->gpu_bytes()) + " GPU\n" + line;
    if (scene.assets.empty() && scene.meshes.empty())
        lines = "drop a model or an asset here";
    gtx_text_add(&shapes, 4 * dot, 4 * dot, &plain, (lines + "\nH: help").c_str());
    gtx_text_add(&shapes, 4 * dot, (8 + 4 * GTX_TEXT_LINE) * dot, &loud, note.c_str());
}

void Viewer::add_progress(gtx_shapes &shapes, float dot)
{
    const gtx_text_style style = {dot, {32, 36, 44}, {244, 245, 247}};
    const float w = float(width) * 0.6f, x = float(width) * 0.2f, h = 8 * dot;
    const float y = float(height) - 3 * h;
    char line[96];
    std::snprintf(line, sizeof line, "%s %.0f%%   Esc: %s",
                  loader.cancelling() ? "cancelling" : loader.stage(),
                  double(100 * loader.fraction()), loader.cancelling() ? "close" : "cancel");
    gtx_text_rectangle(&shapes, x - dot, y - dot, w + 2 * dot, h + 2 * dot, {32, 36, 44});
    gtx_text_rectangle(&shapes, x, y, w, h, {244, 245, 247});
    gtx_text_rectangle(&shapes, x, y, w * loader.fraction(), h, {52, 120, 200});
    gtx_text_add(&shapes, x, y - (GTX_TEXT_LINE + 2) * dot, &style, line);
}

void Viewer::add_help(gtx_shapes &shapes, float dot)
{
    const gtx_text_style style = {dot, {236, 238, 242}, {32, 36, 44}};
    std::string lines = "left drag   turn\nright drag  move\nwheel       nearer, farther\n"
                        "drop        a model is cooked, an asset opened\n";
    for (const Key &k : keys) {
        std::string label = k.key == GTX_KEY_ESCAPE ? "Esc" : std::string(1, k.key);
        lines += label + std::string(12 - label.size(), ' ') + k.help + "\n";
    }
    lines.pop_back();
    int w, h;
    gtx_text_measure(lines.c_str(), &w, &h);
    const float x = std::max(8 * dot, (float(width) - float(w) * dot) / 2);
    const float y = std::max(8 * dot, (float(height) - float(h) * dot) / 2);
    gtx_text_rectangle(&shapes, x - 6 * dot, y - 6 * dot, (float(w) + 12) * dot,
                       (float(h) + 12) * dot, {32, 36, 44});
    gtx_text_add(&shapes, x, y, &style, lines.c_str());
}

void Viewer::draw_overlay()
{
    const float dot = float(std::max(1, std::min(height / 300, width / 400)));
    gtx_shapes shapes = {};
    gtx_error error;
    if (text)
        add_status(shapes, dot);
    if (loader.busy())
        add_progress(shapes, dot);
    if (help)
        add_help(shapes, dot);
    if (shapes.index_count || shapes.failed)
        check(gtx_text_draw(&stage->gl, &stage->program, &shapes, width, height, &error), error);
}

void Viewer::draw_frame()
{
    using Clock = std::chrono::steady_clock;
    gtx_error error;
    const gtx_host_gl &gl = stage->gl;
    if (target.width != width || target.height != height) {
        if (target.object)
            gtx_framebuffer_destroy(&gl, &target);
        check(gtx_framebuffer_create(&gl, width, height, &target, &error), error);
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
    stage->draw(view, look);
    if (boxes)
        stage->draw_boxes(view);
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
        take_drops();
        if (!dropped)
            loader.start({script.drop});
        dropped = true;
        take_loaded();
        if (*next)
            press_script(*next++);
        if (width > 0 && height > 0) {
            draw_frame();
            ++drawn;
        }
        if (script.frames && drawn >= script.frames && !*next && !loader.busy() &&
            incoming.models.empty())
            gtx_window_close(window);
    }
    if (script.picture && target.object) {
        gtx_framebuffer_bind(&stage->gl, &target);
        width = target.width;
        height = target.height;
        write_picture(script.picture);
    }
    return script.frames ? code : 0;
}

} // namespace gtx
