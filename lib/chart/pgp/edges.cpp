/* Half-edges with fans for vertices, and angles in triangles. */
#include "chart/pgp/pgp.hpp"
#include "base/exact.h"

#include <algorithm>

namespace gtx {

namespace {

/* Guards: of obtuse triangles, whose cotangents would push their ends apart, and of slivers. The
 * first moves the bunny's texels by -3 % at half and +25 % at double, the second nothing. */
constexpr double MIN_WEIGHT = 0.02, MAX_WEIGHT = 1e4;

double corner_angle(const Mesh &mesh, uint32_t t, int k)
{
    Vec3d a = mesh.position(t, (k + 1) % 3) - mesh.position(t, k);
    Vec3d b = mesh.position(t, (k + 2) % 3) - mesh.position(t, k);
    return gtx_atan2(length(cross(a, b)), dot(a, b));
}

/* The neighbours of a region come in any order. */
uint32_t find_opposite(const Surface &surface, uint32_t h)
{
    const Mesh &mesh = surface.mesh;
    for (uint32_t across : surface.whole.neighbours[h / 3])
        for (uint32_t k = 0; k < 3 && across != NO_TRIANGLE; ++k) {
            uint32_t o = 3 * across + k;
            if (start_of(mesh, o) == start_of(mesh, next_edge(h)) &&
                start_of(mesh, next_edge(o)) == start_of(mesh, h))
                return o;
        }
    return NO_EDGE;
}

/* Turns begin at a border where there is one. */
void find_fans(HalfEdges &edges)
{
    size_t count = edges.opposite.size();
    edges.vertex.assign(count, NO_EDGE);
    auto walk = [&](uint32_t first) {
        for (uint32_t c = first; c != NO_EDGE && edges.vertex[c] == NO_EDGE; c = edges.left_of(c))
            edges.vertex[c] = uint32_t(edges.first.size());
        edges.first.push_back(first);
    };
    for (uint32_t c = 0; c < count; ++c)
        if (edges.opposite[c] == NO_EDGE)
            walk(c);
    for (uint32_t c = 0; c < count; ++c)
        if (edges.vertex[c] == NO_EDGE)
            walk(c);
}

} // namespace

double HalfEdges::angle(uint32_t c) const
{
    return M_PI - std::abs(std::remainder(direction[c] - direction[previous_edge(c)], 2 * M_PI));
}

static double cotangent(double angle)
{
    return gtx_cos(angle) / gtx_sin(angle);
}

double HalfEdges::weight(uint32_t h) const
{
    double sum = cotangent(angle(previous_edge(h)));
    if (uint32_t o = opposite[h]; o != NO_EDGE)
        sum += cotangent(angle(previous_edge(o)));
    return std::clamp(sum / 2, MIN_WEIGHT, MAX_WEIGHT);
}

double HalfEdges::transport(uint32_t h) const
{
    return std::remainder(direction[opposite[h]] + M_PI - direction[h], 2 * M_PI);
}

HalfEdges make_half_edges(const Surface &surface)
{
    const Mesh &mesh = surface.mesh;
    HalfEdges out;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        double angle = 0;
        for (int k = 0; k < 3; ++k) {
            out.opposite.push_back(find_opposite(surface, 3 * t + uint32_t(k)));
            out.direction.push_back(angle);
            out.length.push_back(length(mesh.position(t, (k + 1) % 3) - mesh.position(t, k)));
            angle += M_PI - corner_angle(mesh, t, (k + 1) % 3);
        }
    }
    find_fans(out);
    return out;
}

} // namespace gtx
