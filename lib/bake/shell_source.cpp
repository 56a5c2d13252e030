/* Which surface the shell is made of: the triangles that the maps show, each with its patch. */
#include "bake/shell_parts.hpp"

namespace gtx {

using namespace baking;

constexpr uint32_t NO_PATCH = 0xffffffffu;

/* The patch of each triangle. */
static std::vector<uint32_t> patches_of(const Mesh &mesh, const Partition &partition,
                                        const Maps &maps)
{
    std::vector<uint32_t> patch(mesh.triangle_count(), NO_PATCH);
    for (size_t i = 0; i < maps.charts.size(); ++i)
        for (uint32_t t : partition.charts[maps.charts[i]].triangles)
            patch[t] = uint32_t(i);
    return patch;
}

/* A patch without a normal under any part of a triangle does not show it: its material cuts it away. */
static bool shown(const PatchRegion &region, const std::array<Vec3d, 3> &corner)
{
    const Vec3d middle = (corner[0] + corner[1] + corner[2]) / 3;
    bool held = region.holds(region.place(middle));
    for (const Vec3d &c : corner)
        held = held || region.holds(region.place(c));
    return held;
}

ShellSource shell_source(const Mesh &mesh, const Partition &partition, const Maps &maps)
{
    const std::vector<uint32_t> patch = patches_of(mesh, partition, maps);
    const std::vector<PatchRegion> regions(patch_regions(maps));
    const Vec3d anchor(maps.anchor[0], maps.anchor[1], maps.anchor[2]);
    ShellSource source;
    for (const Vec3d &p : mesh.positions)
        source.positions.push_back(p - anchor);
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto &v = mesh.triangles[t];
        if (patch[t] == NO_PATCH || !shown(regions[patch[t]], {source.positions[v[0]],
                                                               source.positions[v[1]],
                                                               source.positions[v[2]]}))
            continue;
        source.triangles.push_back(v);
        source.patch.push_back(patch[t]);
    }
    return source;
}

} // namespace gtx
