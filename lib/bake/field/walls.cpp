/* Normals of texels beside walls.
 *
 * A cell that spans a step is a wall, and shaded as its corners are: from what is above it to what
 * is below, while the wall itself faces neither way. So texels beside walls have the mean normal of
 * the surface around them, as much of the wall's as there is of it, as those of coarser levels. */
#include "bake/field/shade.hpp"

#include <algorithm>

namespace gtx::baking {

/* Texels of depth along a cell that is a wall, and the cosine below which its normal is not what
 * its corners show. Turned pixels (format/measures.md) of an engine 22,053 without any, with
 * cosines of 0.7 and 0.85 4,117 and 3,879; of a gargoyle 407, and 196 and 88, for 86 at 0.8, but
 * edges of walls are rounded over a texel: its PSNR is 0.03 dB lower at 0.8, 0.07 at 0.85. Half
 * the depth: the truck 16 % more; double: the engine three times as many. */
constexpr double RISE = 4, ALIKE = 0.8;
/* How much of a wall a texel has at most, for what else is around it: the edge of a wall is shaded
 * as a chamfer, that the even cells beside it be bent no more than they must. Turned pixels at
 * half, at this and without a limit: of a truck 14,345, 8,994 and 11,271, of an engine 13,942,
 * 4,117 and 4,162, of a helmet at 1.5 11,442, 8,663 and 8,591 (all at a cosine of 0.7). */
constexpr double WALL = 2.2;

namespace {

/* The height field of a patch, with the axes of its texels as long as they are. */
struct Slopes {
    Vec3d x, y, z;               /* along a texel, and up a code */

    explicit Slopes(const gtx_patch &r, unsigned height_bits)
        : x(loaded(r.axis_x) * (double(r.extent_x) / r.rect[2])),
          y(loaded(r.axis_y) * (double(r.extent_y) / r.rect[3])),
          z(loaded(r.axis_z) * gtx_height_step(&r, height_bits))
    {
    }
    /* As long as the cell is large. */
    Vec3d normal(const std::array<double, 4> &code) const
    {
        const double along_x = code[1] - code[0] + code[3] - code[2];
        const double along_y = code[2] - code[0] + code[3] - code[1];
        return cross(x + z * (along_x / 2), y + z * (along_y / 2));
    }
};

} // namespace

void shade_walls(const PatchMaps &maps, unsigned height_bits, Shades &shades)
{
    const Slopes slopes(maps.record, height_bits);
    const double rise =
        RISE * std::max(length(slopes.x), length(slopes.y)) / length(slopes.z);
    const size_t w = size_t(shades.w);
    Vector<Vec3d> wall(shades.normal.size());    /* the sum of the walls around a texel */
    Vector<double> even(shades.normal.size());   /* how much else there is */
    bool any = false;
    for (size_t j = 0; j + 1 < size_t(shades.h); ++j)
        for (size_t i = 0; i + 1 < w; ++i) {
            const size_t cell = j * w + i;
            const std::array<size_t, 4> at = {cell, cell + 1, cell + w, cell + w + 1};
            std::array<double, 4> code;
            bool coded = true, shows = false;
            Vec3f mean;
            for (size_t k = 0; k < 4; ++k) {
                code[k] = maps.height[at[k]];
                coded &= code[k] > 0;
                shows |= gtx_trim_distance(maps.trim[at[k]]) <= GTX_TRIM_SHOWN;
                mean += shades.normal[at[k]];
            }
            if (!coded || !shows)
                continue;
            const Vec3d normal = slopes.normal(code);
            const double area = length(normal);
            const auto [low, high] = std::minmax_element(code.begin(), code.end());
            const bool is_wall = *high - *low > rise &&
                                 dot(Vec3d(mean), normal) < ALIKE * double(length(mean)) * area;
            any |= is_wall;
            for (size_t t : at) {
                wall[t] += is_wall ? normal : Vec3d();
                even[t] += is_wall ? 0 : area;
            }
        }
    for (size_t t = 0; any && t < wall.size(); ++t) {
        const double most = WALL * even[t], all = length(wall[t]);
        const double share = even[t] > 0 && all > most ? most / all : 1;
        const Vec3d sum = wall[t] * share + Vec3d(shades.normal[t]) * even[t];
        if (dot(wall[t], wall[t]) > 0 && dot(sum, sum) > 0)
            shades.normal[t] = Vec3f(normalize(sum));
    }
}

} // namespace gtx::baking
