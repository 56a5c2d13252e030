/* Cleaning, corner by corner: a unit normal on the outer side of its triangle. */
#include "mesh/clean/clean.hpp"
#include "base/exact.h"

namespace gtx {

/* Makes a source normal a unit normal and tells whether it serves: it has a direction and does not
 * face away from its triangle. That of a turned triangle was either right or turned with it. */
static bool usable(Vec3f &normal, bool turned, const Vec3f &face)
{
    if (!is_finite(normal))
        return false;
    Vec3d n = normalize(Vec3d(normal));
    bool away = dot(n, Vec3d(face)) < 0;
    normal = Vec3f(turned && away ? -n : n);
    return dot(normal, face) > 0;
}

/* A normal that goes to the other side of its triangle takes its cross product with the tangent
 * along; the texture stays, so the sign turns. Without an old normal the winding tells. */
static void keep_bitangent(Mesh &mesh, uint32_t c, const Vec3f &before, bool turned)
{
    const float agreement = dot(before, mesh.normals[c]);
    if (!mesh.appearance.tangents.empty() && (agreement < 0 || (!(agreement > 0) && turned)))
        mesh.appearance.tangents[c][3] *= -1;
}

/* The angle of triangle t at corner c weighs its normal (Thuermer and Wuethrich 1998). */
static double angle_at(const Mesh &mesh, uint32_t c)
{
    const Vec3d &p = mesh.positions[start_of(mesh, c)];
    Vec3d a = mesh.positions[start_of(mesh, next_edge(c))] - p;
    Vec3d b = mesh.positions[start_of(mesh, previous_edge(c))] - p;
    return gtx_atan2(length(cross(a, b)), dot(a, b));
}

struct FanCorner {
    Vec3f face;  /* unit normal of the triangle */
    float angle; /* its weight */
};

/* The mean over the triangles of the fan within 60 degrees of corner i's: smooth across scans,
 * sharp at the edges of a cube. Of a very large fan only near triangles count. */
static Vec3f mean_normal(const Vector<FanCorner> &fan, size_t i)
{
    constexpr size_t reach = 64;
    size_t n = fan.size();
    Vec3d sum(fan[i].face * fan[i].angle);
    for (size_t step = 1; step < std::min(n, 2 * reach); ++step) {
        size_t j = i + (step % 2 ? (step + 1) / 2 : n - step / 2);
        j -= j >= n ? n : 0;
        if (dot(fan[i].face, fan[j].face) > 0.5f)
            sum += Vec3d(fan[j].face * fan[j].angle);
    }
    return Vec3f(normalize(sum));
}

/* The normals of the corners around one vertex; returns how many source normals it replaced. */
static uint64_t fan_normals(Mesh &mesh, const Draft &surface, const Vector<Vec3f> &faces,
                            bool from_source, const Vector<uint32_t> &corners,
                            Vector<FanCorner> &fan)
{
    uint64_t replaced = 0;
    fan.clear();
    for (size_t i = 0; i < corners.size(); ++i) {
        uint32_t c = corners[i], t = c / 3;
        const Vec3f before = mesh.normals[c];
        if (from_source && usable(mesh.normals[c], surface.turned[t], faces[t])) {
            keep_bitangent(mesh, c, before, surface.turned[t]);
            continue;
        }
        ++replaced;
        if (fan.empty())
            for (uint32_t d : corners)
                fan.push_back({faces[d / 3], float(angle_at(mesh, d))});
        mesh.normals[c] = mean_normal(fan, i);
        keep_bitangent(mesh, c, before, surface.turned[t]);
    }
    return replaced;
}

void make_normals(Draft &surface, Task &task)
{
    Mesh &mesh = surface.mesh;
    constexpr size_t LEAST = 1 << 12;
    bool from_source = !mesh.normals.empty();
    mesh.normals.resize(3 * mesh.triangles.size());
    Vector<Vec3f> faces(mesh.triangles.size());
    const size_t parts = task.parts(faces.size(), LEAST);
    task.in_parts(faces.size(), parts, [&](size_t, size_t from, size_t to) {
        for (size_t t = from; t < to; ++t)
            faces[t] = Vec3f(normalize(mesh.area_vector(t)));
    });
    Vector<uint32_t> corner_of(mesh.positions.size());
    for (uint32_t c = uint32_t(surface.twin.size()); c-- > 0;)
        corner_of[start_of(mesh, c)] = c;

    constexpr size_t block = 1 << 12;
    size_t blocks = (corner_of.size() + block - 1) / block;
    Vector<uint64_t> replaced(blocks, 0);
    task.parallel(blocks, [&](size_t b) {
        Vector<uint32_t> corners;
        Vector<FanCorner> fan;
        for (size_t v = b * block; v < std::min(corner_of.size(), (b + 1) * block); ++v) {
            fan_of(surface.twin, corner_of[v], corners);
            replaced[b] += fan_normals(mesh, surface, faces, from_source, corners, fan);
        }
    }, 0.7, 1);
    for (uint64_t n : replaced)
        surface.new_normals += from_source ? n : 0;
}

} // namespace gtx
