/* Where the triangles of a patch may lie: the texels that have a normal. */
#include "bake/height_field.hpp"
#include "bake/lod/parts.hpp"

#include <algorithm>

namespace gtx::baking {

/* Dilated texels repeat the normals of the border: few of them look right. Spot's control mesh:
 * error +13 % at half, 0.5 % fewer triangles at double. */
constexpr unsigned MAX_REACH = 3;

/* Chessboard distances to the nearest texel with a zero, from values that are 0 or 255; beyond the
 * image is 0 where `bounded` (Rosenfeld and Pfaltz 1966: two passes). */
static void spread(Vector<uint8_t> &distance, int w, int h, bool bounded)
{
    const int outside = bounded ? 0 : 255;
    auto at = [&](int x, int y) {
        return x < 0 || y < 0 || x >= w || y >= h ? outside : distance[size_t(y) * w + x];
    };
    auto lower = [&](int x, int y, int dy) {
        int least = std::min({at(x - 1, y + dy), at(x, y + dy), at(x + 1, y + dy), at(x + dy, y)});
        uint8_t &d = distance[size_t(y) * w + x];
        d = uint8_t(std::min<int>(d, least + 1));
    };
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            lower(x, y, -1);
    for (int y = h; y-- > 0;)
        for (int x = w; x-- > 0;)
            lower(x, y, 1);
}

PatchRegion::PatchRegion(const Maps &maps, uint32_t patch)
    : w_(maps.patches[patch].rect[2]), h_(maps.patches[patch].rect[3])
{
    const gtx_patch &record = maps.patches[patch];
    const HeightField field(maps, patch);
    const Vec3d &x = field.axis[0], &y = field.axis[1], &z = field.axis[2];
    const double det = dot(cross(x, y), z);
    row_[0] = cross(y, z) * (w_ / (det * record.extent_x)); /* rounded once: see MapField */
    row_[1] = cross(z, x) * (h_ / (det * record.extent_y));
    for (int k = 0; k < 2; ++k)
        shift_[k] = -dot(row_[k], field.origin);

    /* Texels of distance to a code, then to one too far from any. Vertices are rounded by parts of
     * a texel later: the last ring of dilation is left alone. */
    const unsigned rings = std::max<unsigned>(record.dilation, 1) - 1;
    const unsigned reach = std::min(MAX_REACH, rings);
    clear_.resize(size_t(w_) * h_);
    for (int j = 0; j < h_; ++j)
        for (int i = 0; i < w_; ++i)
            clear_[size_t(j) * w_ + i] = field.code(field.at(i, j)) ? 0 : 255;
    spread(clear_, w_, h_, false);
    for (uint8_t &texel : clear_)
        texel = texel <= reach ? 255 : 0;
    spread(clear_, w_, h_, true);
}

bool PatchRegion::holds(const std::array<double, 2> &place) const
{
    return place[0] >= 0 && place[1] >= 0 && place[0] < w_ && place[1] < h_ &&
           clear_[size_t(place[1]) * w_ + size_t(place[0])];
}

bool PatchRegion::keeps(const Corners &before, const Corners &after, bool same_area) const
{
    std::array<double, 2> was[3], is[3];
    for (int k = 0; k < 3; ++k)
        is[k] = place(after[k]);
    const bool turned = winding(is) <= 0;
    if (!turned && (same_area || holds(is)))
        return true;
    for (int k = 0; k < 3; ++k)
        was[k] = place(before[k]);
    return (!turned || winding(was) <= 0) && (holds(is) || !holds(was));
}

bool PatchRegion::holds(const std::array<double, 2> (&corner)[3]) const
{
    const auto [x0, x1] = std::minmax({corner[0][0], corner[1][0], corner[2][0]});
    const auto [y0, y1] = std::minmax({corner[0][1], corner[1][1], corner[2][1]});
    if (!(x0 >= 0 && y0 >= 0 && x1 < w_ && y1 < h_))
        return false;
    const int x = int((x0 + x1) / 2), y = int((y0 + y1) / 2);
    const int far = std::max({int(x1) - x, x - int(x0), int(y1) - y, y - int(y0)});
    if (clear_[size_t(y) * w_ + x] > far) /* the whole box around it */
        return true;
    for (const auto &c : corner)
        if (!holds(c))
            return false;
    const int half = std::max(int(x1) - x, x - int(x0));
    for (int j = int(y0); j <= int(y1); ++j) { /* what of the triangle lies in this row of texels */
        const uint8_t *row = &clear_[size_t(j) * w_];
        if (row[x] > half) { /* all of it, and of as many rows */
            j += row[x] - 1;
            continue;
        }
        double low = w_, high = 0;
        auto reach = [&](double at) {
            low = std::min(low, at);
            high = std::max(high, at);
        };
        for (int k = 0; k < 3; ++k) {
            const auto &a = corner[k], &b = corner[(k + 1) % 3];
            if (a[1] >= j && a[1] <= j + 1)
                reach(a[0]);
            for (int line = j; line <= j + 1; ++line)
                if ((a[1] < line) != (b[1] < line))
                    reach(a[0] + (b[0] - a[0]) * (line - a[1]) / (b[1] - a[1]));
        }
        low = std::max(low, x0);
        high = std::min(high, x1);
        for (int i = int(low); i <= int(high); i += row[i]) /* what is as near is clear too */
            if (!row[i])
                return false;
    }
    return true;
}

} // namespace gtx::baking
