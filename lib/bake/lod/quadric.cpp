/* What vertices of a surface cost to move, before any was merged. */
#include "bake/lod/quadric.hpp"

namespace gtx::baking {

/* Weight of staying on an open border against staying on the surface. Bunny: error +1 % at
 * half, +8 % at double. */
constexpr double BORDER = 10;

static Vec3d area_of(const Vector<Vec3d> &positions, const Triangle &t)
{
    const Vec3d a = positions[t[0]];
    return cross(positions[t[1]] - a, positions[t[2]] - a);
}

/* Whether each vertex around comes after this one in one triangle and before it in another. */
static bool is_closed(const Vector<Triangle> &triangles, const uint32_t *first,
                      const uint32_t *end, uint32_t vertex)
{
    uint64_t after = 0, before = 0;
    for (const uint32_t *at = first; at < end; ++at) {
        const Triangle &t = triangles[*at];
        const int k = corner_of(t, vertex);
        after += t[(k + 1) % 3];
        before += t[(k + 2) % 3];
    }
    return after == before;
}

/* Planes that stand on the edges of a vertex that only one triangle has, of those from `first` to
 * `end`. A vertex of very many stays anyway. */
static void add_borders(const Vector<Vec3d> &positions, const Vector<Triangle> &triangles,
                        const uint32_t *first, const uint32_t *end, uint32_t vertex, Quadric &q)
{
    for (const uint32_t *at = first; at < end && end - first <= MAX_FAN; ++at) {
        const Triangle &t = triangles[*at];
        const int k = corner_of(t, vertex);
        for (int other = 1; other < 3; ++other) {
            const uint32_t to = t[(k + other) % 3];
            if (std::count_if(first, end, [&](uint32_t n) {
                    return corner_of(triangles[n], to) >= 0;
                }) > 1)
                continue;
            const Vec3d edge = positions[to] - positions[vertex];
            const Vec3d across = normalize(cross(edge, area_of(positions, t)));
            q.add_plane(across, -dot(across, positions[vertex]), BORDER * dot(edge, edge));
        }
    }
}

Vector<Quadric> vertex_quadrics(const Vector<Vec3d> &positions,
                                const Vector<Triangle> &triangles,
                                const Vector<uint32_t> &start,
                                const Vector<uint32_t> &around, Task &task)
{
    Vector<Quadric> quadrics(positions.size());
    const size_t chunk = 4096, chunks = (positions.size() + chunk - 1) / chunk;
    task.parallel(chunks, [&](size_t n) {
        for (size_t v = n * chunk; v < std::min(positions.size(), (n + 1) * chunk); ++v) {
            Quadric &q = quadrics[v];
            for (uint32_t i = start[v]; i < start[v + 1]; ++i) {
                const Triangle &t = triangles[around[i]];
                const Vec3d area = area_of(positions, t), normal = normalize(area);
                q.add_plane(normal, -dot(normal, positions[t[0]]), length(area));
                q.weight += length(area);
            }
            const uint32_t *first = around.data() + start[v], *end = around.data() + start[v + 1];
            if (!is_closed(triangles, first, end, uint32_t(v)))
                add_borders(positions, triangles, first, end, uint32_t(v), q);
        }
    }, 0, 0);
    return quadrics;
}

} // namespace gtx::baking
