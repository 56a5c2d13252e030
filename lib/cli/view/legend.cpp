/* Legends: of debug views, and of the colour map of height grids. */
#include "cli/view/legend.hpp"

#include "grid/grid.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace gtx {

constexpr size_t RAMP = 64, MAX_TITLE = 40, MAX_ENTRIES = 24;

static std::string text_of(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

/* As gtx_horizons writes it. Untrusted: any other META has no legend. */
static Legend color_map_of(const gtx_asset *asset)
{
    Legend out;
    size_t size = 0;
    const char *text = gtx_meta(asset, &size);
    const auto meta = nlohmann::json::parse(text, text + size, nullptr, false);
    if (!meta.is_object() || !meta.contains("colors") || !meta["colors"].is_string() ||
        !meta.contains("color_low") || !meta["color_low"].is_number() ||
        !meta.contains("color_high") || !meta["color_high"].is_number())
        return out;
    const std::string name = meta["colors"].get<std::string>();
    if (name != "viridis" && name != "rainbow")
        return out;
    const ColorMap map = name == "rainbow" ? ColorMap::RAINBOW : ColorMap::VIRIDIS;
    const double low = meta["color_low"].get<double>(), high = meta["color_high"].get<double>();
    if (meta.contains("categories") && meta["categories"].is_array())
        for (const auto &value : meta["categories"])
            if (value.is_number() && out.entries.size() < MAX_ENTRIES)
                out.entries.push_back({color_of(map, high > low ? (value.get<double>() - low) /
                                                                      (high - low) : 0.5),
                                       text_of(value.get<double>())});
    for (size_t i = 0; out.entries.empty() && i < RAMP; ++i)
        out.ramp.push_back(color_of(map, double(i) / (RAMP - 1)));
    out.low = text_of(low);
    out.high = text_of(high);
    if (meta.contains("property") && meta["property"].is_string())
        for (char letter : meta["property"].get<std::string>().substr(0, MAX_TITLE))
            out.title += letter >= ' ' && letter <= '~' ? letter : '?';
    return out;
}

static Legend normals_legend()
{
    static const char *const names[] = {"+x", "-x", "+y", "-y", "+z", "-z"};
    Legend out;
    for (size_t i = 0; i < 6; ++i) {
        std::array<uint8_t, 3> color = {128, 128, 128};
        color[i / 2] = i % 2 ? 0 : 255;
        out.entries.push_back({color, names[i]});
    }
    return out;
}

static Legend patches_legend(const Scene &scene)
{
    constexpr uint32_t SHOWN = 4;
    Legend out;
    uint64_t patches = 0;
    for (const PlacedAsset &placed : scene.assets) {
        gtx_info info;
        gtx_get_info(placed.asset.get(), &info);
        patches += info.patch_count;
    }
    for (uint32_t i = 0; i < std::min<uint64_t>(patches, SHOWN); ++i)
        out.entries.push_back({patch_color(i), "patch " + std::to_string(i)});
    out.entries.push_back({{128, 128, 128}, "... a colour a patch, " + std::to_string(patches)});
    return out;
}

Legend legend_of(const Scene &scene, DebugView debug)
{
    if (debug == DebugView::NORMALS)
        return normals_legend();
    if (debug == DebugView::PATCHES)
        return patches_legend(scene);
    for (const PlacedAsset &placed : scene.assets)
        if (Legend legend = color_map_of(placed.asset.get()); !legend.empty())
            return legend;
    return Legend();
}

Legend::Entry contours_legend(double step)
{
    return {{48, 48, 48}, "a line every " + text_of(step)};
}

static float dot_of(uint32_t width, uint32_t height)
{
    return float(std::max(1u, std::min(height / 300, width / 400)));
}

static gtx_text_style style_of(float dot)
{
    return {dot, {32, 36, 44}, {244, 245, 247}};
}

void add_label(gtx_shapes &shapes, uint32_t width, uint32_t height, const std::string &label)
{
    const float dot = dot_of(width, height);
    const gtx_text_style style = style_of(dot);
    if (!label.empty())
        gtx_text_add(&shapes, 4 * dot, 4 * dot, &style, label.c_str());
}

static gtx_rgb rgb_of(const std::array<uint8_t, 3> &c)
{
    return {c[0], c[1], c[2]};
}

void add_legend(gtx_shapes &shapes, uint32_t width, uint32_t height, const Legend &legend)
{
    const float dot = dot_of(width, height), line = GTX_TEXT_LINE * dot, left = 4 * dot;
    const gtx_text_style style = style_of(dot);
    float y = float(height) - 4 * dot;
    for (size_t i = legend.entries.size(); i-- > 0;) {
        y -= line;
        gtx_text_rectangle(&shapes, left, y, 8 * dot, 8 * dot, rgb_of(legend.entries[i].color));
        gtx_text_add(&shapes, left + 11 * dot, y, &style, legend.entries[i].text.c_str());
    }
    if (legend.ramp.empty() && !legend.title.empty())
        gtx_text_add(&shapes, left, y - line, &style, legend.title.c_str());
    if (legend.ramp.empty())
        return;
    const float full = std::min(float(width) / 2, 160 * dot);
    const float step = full / float(legend.ramp.size());
    for (size_t i = 0; i < legend.ramp.size(); ++i)
        gtx_text_rectangle(&shapes, left + float(i) * step, y - 8 * dot, step, 8 * dot,
                           rgb_of(legend.ramp[i]));
    int w, h;
    gtx_text_measure(legend.high.c_str(), &w, &h);
    y -= 8 * dot + line;
    gtx_text_add(&shapes, left, y, &style, legend.low.c_str());
    gtx_text_add(&shapes, left + full - float(w) * dot, y, &style, legend.high.c_str());
    if (!legend.title.empty())
        gtx_text_add(&shapes, left, y - line, &style, legend.title.c_str());
}

} // namespace gtx
