/* The cells of assets as shapes for nearest-point queries. */
#include "measure/cells.hpp"

#include "asset/asset.h"

namespace gtx {

static Vec3d vector(const double from[3])
{
    return {from[0], from[1], from[2]};
}

template <class T> static double mix(const T corner[4], double u, double v)
{
    double near = corner[0] * (1 - u) + corner[1] * u, far = corner[2] * (1 - u) + corner[3] * u;
    return near * (1 - v) + far * v;
}

Cells::Cells(const Vector<const gtx_asset *> &assets)
{
    for (const gtx_asset *asset : assets) {
        const Vec3d offset = vector(asset->info.anchor) - vector(assets[0]->info.anchor);
        for (uint32_t i = 0; i < asset->info.patch_count; ++i)
            add_patch(asset, i, offset);
    }
}

void Cells::add_patch(const gtx_asset *asset, uint32_t index, const Vec3d &offset)
{
    const uint32_t number = uint32_t(frames_.size());
    const gtx_patch &patch = asset->patches[index];
    const gtx_patch_frame frame = gtx_patch_frame_of(&patch, asset->info.height_bits);
    const double(&axis)[3][3] = frame.axis;
    frames_.push_back({vector(frame.origin) + offset, vector(axis[0]), vector(axis[1]),
                       vector(axis[2])});
    for (uint32_t y = 0; y + 1 < patch.rect[3]; ++y) {
        cancel_point(8 * patch.rect[2]);
        for (uint32_t x = 0; x + 1 < patch.rect[2]; ++x) {
            Cell cell = {number, uint16_t(x), uint16_t(y), {}, {}, false};
            bool solid = true, shown = false;
            for (uint32_t k = 0; k < 4; ++k) {
                cell.code[k] = uint16_t(gtx_height_code(asset, &patch, x + (k & 1), y + (k >> 1)));
                cell.trim[k] = uint8_t(gtx_trim_code(asset, &patch, x + (k & 1), y + (k >> 1)));
                bool outside = gtx_trim_distance(cell.trim[k]) > GTX_TRIM_SHOWN;
                solid &= cell.code[k] != 0;
                shown |= !outside;
                cell.crossed |= outside;
            }
            if (solid && shown)
                cells_.push_back(cell);
        }
    }
}

Vec3d Cells::point(size_t i, double u, double v) const
{
    const Cell &cell = cells_[i];
    const Frame &f = frames_[cell.patch];
    return f.origin + f.x * (cell.x + u) + f.y * (cell.y + v) + f.z * mix(cell.code, u, v);
}

Vec3d Cells::corner(size_t i, int k) const
{
    const Cell &cell = cells_[i];
    const Frame &f = frames_[cell.patch];
    return f.origin + f.x * (cell.x + (k & 1)) + f.y * (cell.y + (k >> 1)) + f.z * cell.code[k];
}

double Cells::trim(size_t i, double u, double v) const
{
    return gtx_trim_distance(mix(cells_[i].trim, u, v));
}

Box Cells::box(size_t i) const
{
    Vec3d low = corner(i, 0), high = low;
    for (int k = 1; k < 4; ++k) {
        const Vec3d at = corner(i, k);
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], at[a]);
            high[a] = std::max(high[a], at[a]);
        }
    }
    Box box; /* rounding takes most of the time of a tree: two points, not four */
    box.add(low);
    box.add(high);
    return box;
}

/* The part of a triangle where the trim, linear over it, is at most the limit: nothing, one
 * triangle or two. */
static double clipped_distance2(const Vec3d &p, const Vec3d v[3], const double trim[3])
{
    Vec3d kept[4];
    int count = 0;
    for (int k = 0; k < 3; ++k) {
        int n = (k + 1) % 3;
        bool in = trim[k] <= GTX_TRIM_SHOWN, next_in = trim[n] <= GTX_TRIM_SHOWN;
        if (in)
            kept[count++] = v[k];
        if (in != next_in) {
            const double part = (GTX_TRIM_SHOWN - trim[k]) / (trim[n] - trim[k]);
            kept[count++] = v[k] + (v[n] - v[k]) * part;
        }
    }
    double best = std::numeric_limits<double>::infinity();
    for (int k = 2; k < count; ++k)
        best = std::min(best, triangle_distance2(p, kept[0], kept[k - 1], kept[k]));
    return best;
}

/* Whether p is at least sqrt(bound) away from the box of four points. */
static bool beyond(const Vec3d at[4], const Vec3d &p, double bound)
{
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
        double low = std::min(std::min(at[0][a], at[1][a]), std::min(at[2][a], at[3][a]));
        double high = std::max(std::max(at[0][a], at[1][a]), std::max(at[2][a], at[3][a]));
        double d = std::max(std::max(low - p[a], p[a] - high), 0.);
        sum += d * d;
    }
    return sum >= bound;
}

double Cells::distance2(size_t i, const Vec3d &p, double bound) const
{
    Vec3d at[4];
    for (int k = 0; k < 4; ++k)
        at[k] = corner(i, k);
    if (beyond(at, p, bound))
        return bound;
    if (cells_[i].crossed)
        return crossed_distance2(i, p, bound);
    static const int ring[5] = {0, 1, 3, 2, 0};
    Vec3d centre = (at[0] + at[1] + at[2] + at[3]) * 0.25; /* on the bilinear patch */
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 4; ++k)
        best = std::min(best, triangle_distance2(p, centre, at[ring[k]], at[ring[k + 1]]));
    return best;
}

double Cells::crossed_distance2(size_t i, const Vec3d &p, double bound) const
{
    double best = std::numeric_limits<double>::infinity();
    for (int quarter = 0; quarter < 4; ++quarter) {
        Vec3d at[4];
        double trims[4];
        bool shown = false;
        for (int k = 0; k < 4; ++k) {
            double u = 0.5 * ((quarter & 1) + (k & 1)), v = 0.5 * ((quarter >> 1) + (k >> 1));
            at[k] = point(i, u, v);
            trims[k] = trim(i, u, v);
            shown |= trims[k] <= GTX_TRIM_SHOWN;
        }
        if (!shown || beyond(at, p, std::min(best, bound)))
            continue;
        for (int k = 1; k < 3; ++k) { /* both hold corners 0 and 3 */
            const Vec3d v[3] = {at[0], at[k], at[3]};
            const double t[3] = {trims[0], trims[k], trims[3]};
            best = std::min(best, clipped_distance2(p, v, t));
        }
    }
    return best;
}

double Cells::shown_area(size_t i) const
{
    int inside = 0;
    for (int k = 0; k < 16; ++k)
        inside += trim(i, 0.125 + 0.25 * (k & 3), 0.125 + 0.25 * (k >> 2)) <= GTX_TRIM_SHOWN;
    Vec3d across = corner(i, 3) - corner(i, 0), back = corner(i, 2) - corner(i, 1);
    return length(cross(across, back)) / 2 * inside / 16;
}

} // namespace gtx
