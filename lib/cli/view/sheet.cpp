/* Scenes one after the other, each seen from several sides in every frame. */
#include "cli/view/sheet.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

constexpr uint32_t MIN_CELL = 16;             /* pixels along a side */
constexpr uint64_t MAX_PIXELS = 1 << 28;       /* of all frames together: a gigabyte */

struct Group {
    std::string label;
    Vector<std::string> files;
};

static std::string last_part(const std::string &path)
{
    return path.substr(path.rfind('/') + 1);
}

static Vector<Group> groups_of(const SheetOptions &sheet)
{
    Vector<Group> out;
    if (sheet.is_sheet && sheet.beside.empty() && sheet.files.size() > 1) {
        for (const std::string &file : sheet.files)
            out.push_back({last_part(file), {file}});
        return out;
    }
    const bool labelled = sheet.is_sheet || !sheet.beside.empty();
    out.push_back({labelled ? last_part(sheet.files[0]) : std::string(), sheet.files});
    if (!sheet.beside.empty())
        out.push_back({last_part(sheet.beside), {sheet.beside}});
    return out;
}

/* Around at one height; of more than four, the last two from above and from below. */
static Shot shot_of(const StillOptions &still, const SheetOptions &sheet, uint32_t view,
                    double turn)
{
    constexpr uint32_t AROUND = 4;
    constexpr double ABOVE = 80, BELOW = -60;
    const uint32_t around = sheet.views > AROUND ? sheet.views - 2 : sheet.views;
    Shot shot = {{still.camera[0] + turn, still.camera[1], still.camera[2]}, {}};
    if (view < around)
        shot.camera[0] += 360.0 * view / around;
    else
        shot.camera[1] = view == around ? ABOVE : BELOW;
    return shot;
}

static std::string label_of(const Group &group, const Shot &shot, const SheetOptions &sheet)
{
    if (sheet.views == 1)
        return group.label;
    char angles[64];
    std::snprintf(angles, sizeof angles, "%s%g, %g", group.label.empty() ? "" : "\n",
                  std::fmod(shot.camera[0], 360), shot.camera[1]);
    return group.label + (sheet.frames == 1 ? angles : "");
}

/* How the cells lie. */
struct Layout {
    uint32_t columns, rows;
};

static Layout layout_of(uint32_t groups, const SheetOptions &sheet)
{
    const uint32_t cells = groups * sheet.views;
    if (groups > 1 && sheet.views > 1)
        return {sheet.views, groups};
    if (!sheet.beside.empty())
        return {2, 1};
    const uint32_t columns = uint32_t(std::ceil(std::sqrt(double(cells))));
    return {columns, (cells + columns - 1) / columns};
}

static void copy_cell(const Still &from, const StillOptions &cell, uint32_t x, uint32_t y,
                      uint32_t width, Still &to)
{
    const size_t row = size_t(4) * cell.width;
    for (uint32_t j = 0; j < cell.height; ++j)
        std::copy_n(&from.color[j * row], row, &to.color[4 * (size_t(y + j) * width + x)]);
}

static Still empty_frame(const StillOptions &still)
{
    Still out;
    out.color.resize(size_t(4) * still.width * still.height);
    for (size_t i = 0; i < out.color.size(); ++i)
        out.color[i] = still.background[i % 4];
    return out;
}

Vector<Still> draw_sheet(const SheetOptions &sheet, const StillOptions &still,
                         const OpenScene &open)
{
    const Vector<Group> groups = groups_of(sheet);
    const Layout layout = layout_of(uint32_t(groups.size()), sheet);
    StillOptions cell = still;
    cell.width = still.width / layout.columns;
    cell.height = still.height / layout.rows;
    const bool single = layout.columns * layout.rows == 1;
    if (!single && std::min(cell.width, cell.height) < MIN_CELL)
        throw Error(GTX_ERROR_ARGUMENT, std::to_string(layout.columns) + " x " +
                                            std::to_string(layout.rows) +
                                            " pictures need a larger --size");
    if (uint64_t(still.width) * still.height * sheet.frames > MAX_PIXELS)
        throw Error(GTX_ERROR_LIMIT, std::to_string(sheet.frames) +
                                         " frames are too many of this --size");
    Vector<Still> out;
    for (uint32_t f = 0; f < sheet.frames; ++f)
        out.push_back(single ? Still() : empty_frame(still));
    const Scene none;
    Scene first, scene; /* what is beside is seen from where the first is */
    Studio studio(cell);
    for (uint32_t g = 0; g < groups.size(); ++g) {
        studio.show(none); /* nothing of what is closed now */
        scene = open(groups[g].files);
        if (g && !sheet.beside.empty()) {
            scene.centre = first.centre;
            scene.radius = first.radius;
        }
        first.centre = scene.centre;
        first.radius = scene.radius;
        studio.show(scene);
        for (uint32_t f = 0; f < sheet.frames; ++f)
            for (uint32_t v = 0; v < sheet.views; ++v) {
                Shot shot = shot_of(still, sheet, v, 360.0 * f / sheet.frames);
                shot.label = label_of(groups[g], shot, sheet);
                Still drawn = studio.draw(shot);
                const uint32_t at = g * sheet.views + v;
                if (single)
                    out[f] = std::move(drawn);
                else
                    copy_cell(drawn, cell, at % layout.columns * cell.width,
                              at / layout.columns * cell.height, still.width, out[f]);
            }
    }
    return out;
}

} // namespace gtx
