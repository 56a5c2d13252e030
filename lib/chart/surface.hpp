/* The mesh as partitioning uses it: flat arrays with an entry per triangle. */
#pragma once

#include "mesh/mesh.hpp"
#include "mesh/task.hpp"

namespace gtx {

/* A set of triangles and its connectivity. Indices into a region are called local. */
struct Region {
    Vector<uint32_t> triangles;                       /* of the mesh */
    Vector<std::array<uint32_t, 3>> neighbours;       /* local; NO_TRIANGLE outside */

    size_t size() const { return triangles.size(); }
};

/* What clustering knows of a triangle. */
struct Facet {
    Vec3f normal; /* unit, smoothed */
    Vec3f centre; /* from the middle of the bounding box, over the root of the mean area */
    float size;   /* area over the mean area */
};

struct Surface {
    const Mesh &mesh;
    Region whole;              /* every triangle: local indices are the mesh's */
    double area = 0;           /* object units, as is the diagonal of the bounding box */
    double diagonal = 0;
    Vector<Facet> facets;
    Vector<Vec3f> normal;      /* unit, raw */
    Vector<uint8_t> junk;      /* 1: scan noise, small and twisted against its neighbours */
    bool manifold = false;     /* all that share an edge are neighbours */
};

/* Texels: what is smaller may be a scan's junk, a triangle that turns far from those around it or a
 * tiny island that faces away. Half: patches +6 %, double: RMS +14 % (truck). */
constexpr double JUNK_TEXELS = 8;

/* `pitch` is the expected size of a texel. */
Surface make_surface(const Mesh &mesh, double pitch, Task &task);

/* The expected size of a texel when `charts` of them cover the mesh. */
double expected_pitch(const Mesh &mesh, size_t charts);

/* Texels of a region's area. */
double texels_of(const Surface &surface, const Region &region, double pitch);

/* Runs body(i) for every region on the task's threads, as Task::parallel does, but the largest
 * first: one that begins last is waited for. With several `times` a region, i / times is its. */
void for_each_region(const Vector<Region> &regions, Task &task,
                     const std::function<void(size_t)> &body, double from = 0, double to = 1,
                     size_t times = 1);

/* The triangles of `parent` whose label is below `count`, a region a label. Labels are local. */
Vector<Region> split_region(const Region &parent, const Vector<uint32_t> &labels,
                            uint32_t count);

/* Numbers the connected pieces of equal `labels` in order of their first triangle; returns how
 * many there are. */
uint32_t connected_pieces(const Region &region, Vector<uint32_t> &labels);

} // namespace gtx
