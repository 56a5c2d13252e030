/* The shell: the whole source surface as a few meshes of ever fewer triangles, for what is far away. */
#pragma once

#include "bake/bake.hpp"

namespace gtx {

/* Surface with a patch a triangle, and vertices that patches share, relative to the anchor. */
struct ShellSource {
    std::vector<Vec3d> positions;
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<uint32_t> patch; /* a triangle each */
};

/* One level as the asset keeps it (format/gtx.md, "Shell"). */
struct ShellLevel {
    float origin[3] = {0, 0, 0}, step = 0, error = 0;
    std::vector<uint32_t> first;     /* of each patch, and the end */
    std::vector<uint32_t> indices;   /* 3 a triangle */
    std::vector<uint16_t> positions; /* 3 a vertex */

    size_t triangle_count() const { return indices.size() / 3; }
};

/* What the charts show, each triangle with the patch of its chart; `maps` is what bake made of them. */
ShellSource shell_source(const Mesh &mesh, const Partition &partition, const Maps &maps);

/* Simplifies the surface across all patches at once, down to at most `levels` levels, the finest
 * first. Deterministic for any thread count. Stage of `task`: "shell". */
std::vector<ShellLevel> make_shell(const ShellSource &source, const Maps &maps, unsigned levels,
                                   Task &task);

} // namespace gtx
