/* The overlay of `gtx view`: contours, and text for status, legend, progress and help. */
#include "cli/view/contours.hpp"
#include "cli/view/viewer.hpp"

#include <algorithm>
#include <limits>

namespace gtx {

/* Blended on the CPU, as those of pictures are. */
void Viewer::draw_lines()
{
    const size_t count = size_t(width) * size_t(height);
    Vector<uint8_t> color(4 * count);
    Vector<float> depth(count);
    gtx_framebuffer_read_color(&scene_renderer->gl, &target, color.data());
    gtx_framebuffer_read_depth(&scene_renderer->gl, &target, depth.data());
    for (float &d : depth)
        d = d < 1 ? gtx_camera_distance(view.projection, 0, d)
                  : std::numeric_limits<float>::infinity();
    draw_contours(contours_of(scene, 0), scene, view, depth, color);
    gtx_error error;
    require_ok(gtx_framebuffer_write_color(&scene_renderer->gl, &target, color.data(), &error),
               error);
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

void Viewer::add_status(gtx_shapes &shapes, float dot)
{
    const gtx_text_style plain = {dot, {32, 36, 44}, {244, 245, 247}};
    const gtx_text_style loud = {dot, {176, 24, 16}, {255, 255, 255}};
    static const char *const debug_view_text[] = {"", "  patches", "  normals"};
    static const char *const levels_text[] = {"auto", "0", "1", "2", "3"};
    char line[160];
    const bool no_lod = view.method != methods[method].method;
    static const char *const motions[] = {"", "  walking", "  flying"};
    std::snprintf(line, sizeof line, "%s  level %s%s%s%s%s%s  %.1f ms  %dx%d",
                  no_lod ? "no LOD mesh: auto" : methods[method].name, levels_text[view.level],
                  debug_view_text[size_t(debug)], boxes ? "  boxes" : "",
                  shows_source ? "  source" : "",
                  fixed_light ? "  light fixed" : "",
                  motions[size_t(walker.motion())],
                  milliseconds, width, height);
    std::string lines = name + "\n";
    if (!scene.assets.empty() || !scene.meshes.empty())
        lines += std::to_string(facts.triangles) + " triangles  " + std::to_string(facts.patches) +
                 " patches  " + format_bytes(facts.bytes) + " asset  " +
                 format_bytes(scene_renderer->gpu_bytes()) + " GPU\n";
    lines += scene_renderer->world_status() + line;
    if (scene.assets.empty() && scene.meshes.empty() && scene.worlds.empty())
        lines = "drop a model or an asset here";
    gtx_text_add(&shapes, 4 * dot, 4 * dot, &plain, (lines + "\nH: help").c_str());
    const float below = float(std::count(lines.begin(), lines.end(), '\n') + 2) * GTX_TEXT_LINE;
    gtx_text_add(&shapes, 4 * dot, (8 + below) * dot, &loud, note.c_str());
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
    if (walker.motion() != Motion::ORBIT)
        lines = "W A S D     go\nE Q         up, down\nShift       faster\n"
                "left drag   look around\nwheel       faster, slower\n";
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

Legend Viewer::legend() const
{
    Legend out = legend_of(scene, debug);
    if (contours)
        out.entries.push_back(contours_legend(contours_of(scene, 0).step));
    return out;
}

void Viewer::draw_overlay()
{
    const float dot = float(std::max(1, std::min(height / 300, width / 400)));
    gtx_shapes shapes = {};
    gtx_error error;
    if (text)
        add_status(shapes, dot);
    if (text && !loader.busy())
        add_legend(shapes, uint32_t(width), uint32_t(height), legend());
    if (loader.busy())
        add_progress(shapes, dot);
    if (help)
        add_help(shapes, dot);
    if (shapes.index_count || shapes.failed)
        require_ok(gtx_text_draw(&scene_renderer->gl, &scene_renderer->program, &shapes, width,
                                 height, &error), error);
}

} // namespace gtx
