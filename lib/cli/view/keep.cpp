/* Saving from `gtx view`, and switching between an asset and its source. */
#include "cli/view/viewer.hpp"

#include "image/image.h"

#include <unistd.h>

namespace gtx {

/* "stem.ext", or the first of stem-2.ext ... that is no file yet. */
static std::string free_name(const std::string &stem, const std::string &extension, int first)
{
    std::string path;
    for (int i = first; path.empty() || access(path.c_str(), F_OK) == 0; ++i)
        path = stem + (i ? "-" + std::to_string(i) : "") + extension;
    return path;
}

void Viewer::write_picture(const std::string &path)
{
    Vector<uint8_t> pixels(size_t(width) * size_t(height) * 4);
    gtx_error error;
    gtx_framebuffer_read_color(&scene_renderer->gl, &target, pixels.data());
    require_ok(gtx_image_write_png(path.c_str(), uint32_t(width), uint32_t(height), 4,
                                   pixels.data(), &error), error);
}

/* The picture without the text. */
void Viewer::save_screenshot()
{
    const std::string path = free_name("gtx-view", ".png", 1);
    wants_picture = false;
    try {
        write_picture(path);
        note = "saved " + path;
    } catch (const Error &e) {
        note = path + ": " + e.message;
    }
}

/* In the folder that the command runs in, with the bytes that gtx cook writes. */
void Viewer::save_cooked()
{
    note.clear();
    for (const PlacedAsset &placed : scene.assets) {
        if (placed.model.empty())
            continue;
        const std::string file = file_name(placed.model);
        const std::string path = free_name(file.substr(0, file.rfind('.')), ".gtx", 0);
        gtx_error error;
        const bool failed = gtx_save_file(placed.asset.get(), path.c_str(), nullptr, &error) != 0;
        note += (note.empty() ? "" : "\n") +
                (failed ? path + ": " + error.message : "saved " + path);
    }
    if (note.empty())
        note = "nothing was dropped and cooked";
}

void Viewer::open_source()
{
    Task task(0, nullptr, nullptr, {}, {}, cli_limits);
    Scene models;
    if (!given_source.empty())
        add_file(models, given_source, task);
    for (const PlacedAsset &placed : scene.assets)
        if (given_source.empty() && !placed.model.empty())
            add_file(models, placed.model, task);
    if (models.meshes.empty() && models.assets.empty())
        throw Error(GTX_ERROR_ARGUMENT, "no source is known: drop a model, or give --source");
    models.centre = scene.centre;
    models.radius = scene.radius;
    source = std::move(models);
    auto made = std::make_unique<SceneRenderer>(gtx_window_load);
    made->show(source);
    source_renderer = std::move(made);
}

void Viewer::toggle_source()
{
    try {
        if (!source_renderer)
            open_source();
        shows_source = !shows_source;
        note.clear();
    } catch (const Error &e) {
        note = e.message;
    }
}

} // namespace gtx
