/* Triangles of the pieces that a mesh is cut into, with all that its corners have. */
#include "chart/pgp/pgp.hpp"
#include "mesh/material/srgb.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* A part of a piece: places in its list of corners. */
using Part = Vector<uint32_t>;

/* Of the corner `at` of a part, which turns to the left everywhere: how much it turns, as a
 * sine. */
double turn_at(const Vector<Vec3d> &position, const Part &part, size_t at)
{
    size_t n = part.size();
    const Vec3d &p = position[part[at]];
    Vec3d in = p - position[part[(at + n - 1) % n]], out = position[part[(at + 1) % n]] - p;
    return length(cross(normalize(in), normalize(out)));
}

/* Divides a convex part from its flattest corner, which can be none of a triangle's, to the corner
 * that lies farthest from the line of its neighbours. */
void triangulate(const Vector<Vec3d> &position, const Part &part,
                 Vector<std::array<uint32_t, 3>> &out)
{
    size_t n = part.size(), flattest = 0, farthest = 2;
    if (n == 3) {
        out.push_back({part[0], part[1], part[2]});
        return;
    }
    double least = INFINITY, most = -1;
    for (size_t i = 0; i < n; ++i)
        if (double turn = turn_at(position, part, i); turn < least) {
            least = turn;
            flattest = i;
        }
    Part at = part;
    std::rotate(at.begin(), at.begin() + ptrdiff_t(flattest), at.end());
    const Vec3d &from = position[at[n - 1]];
    Vec3d along = normalize(position[at[1]] - from);
    for (size_t i = 2; i + 1 < n; ++i)
        if (double away = length(cross(position[at[i]] - from, along)); away > most) {
            most = away;
            farthest = i;
        }
    Part left(at.begin(), at.begin() + ptrdiff_t(farthest) + 1);
    Part right(at.begin() + ptrdiff_t(farthest), at.end());
    right.push_back(at[0]);
    triangulate(position, left, out);
    triangulate(position, right, out);
}

/* An attribute of the triangle's corners, between them. */
template <size_t N>
void add_between(Vector<std::array<float, N>> &to,
                 const Vector<std::array<float, N>> &from, uint32_t triangle,
                 const std::array<float, 3> &weight)
{
    if (from.empty())
        return;
    const std::array<float, N> *v = &from[3 * size_t(triangle)];
    std::array<float, N> sum;
    for (size_t i = 0; i < N; ++i)
        sum[i] = v[0][i] * weight[0] + v[1][i] * weight[1] + v[2][i] * weight[2];
    to.push_back(sum);
}

Rgba8 coded(const std::array<float, 4> &color)
{
    return {linear_to_srgb(color[0]), linear_to_srgb(color[1]), linear_to_srgb(color[2]),
            uint8_t(std::lround(255 * color[3]))};
}

/* The corner of the triangle that a piece's corner is; 3 for one between them. */
uint32_t own_corner(const std::array<float, 3> &weight)
{
    return uint32_t(std::find(weight.begin(), weight.end(), 1.f) - weight.begin());
}

void add_corner(Mesh &to, const Mesh &from, uint32_t source, const std::array<float, 3> &weight)
{
    if (uint32_t k = own_corner(weight); k < 3) {
        if (!from.normals.empty())
            to.normals.push_back(from.normals[3 * size_t(source) + k]);
        if (!from.colors.empty())
            to.colors.push_back(from.colors[3 * size_t(source) + k]);
    } else {
        Interpolated here = interpolate(from, source, weight.data());
        if (!from.normals.empty())
            to.normals.push_back(here.normal);
        if (!from.colors.empty())
            to.colors.push_back(coded(here.color));
    }
    for (size_t set = 0; set < 2; ++set)
        add_between(to.appearance.uv[set], from.appearance.uv[set], source, weight);
    add_between(to.appearance.tangents, from.appearance.tangents, source, weight);
}

} // namespace

CutMesh cut_mesh(const Mesh &mesh, const Pieces &pieces, const Vector<uint32_t> &label)
{
    CutMesh out;
    out.mesh.positions = mesh.positions;
    out.mesh.positions.insert(out.mesh.positions.end(), pieces.points.begin(), pieces.points.end());
    out.mesh.appearance.materials = mesh.appearance.materials;
    out.mesh.appearance.images = mesh.appearance.images;
    Vector<Vec3d> position;
    Vector<std::array<uint32_t, 3>> triangles;
    for (size_t i = 0; i < pieces.triangle.size(); ++i) {
        const PieceCorner *corners = &pieces.corners[pieces.first[i]];
        Part part(pieces.first[i + 1] - pieces.first[i]);
        position.clear();
        triangles.clear();
        for (uint32_t k = 0; k < part.size(); ++k) {
            part[k] = k;
            position.push_back(out.mesh.positions[corners[k].vertex]);
        }
        triangulate(position, part, triangles);
        for (const std::array<uint32_t, 3> &places : triangles) {
            out.mesh.triangles.emplace_back();
            for (size_t k = 0; k < 3; ++k) {
                const PieceCorner &corner = corners[places[k]];
                out.mesh.triangles.back()[k] = corner.vertex;
                add_corner(out.mesh, mesh, pieces.triangle[i], corner.weight);
            }
            out.source.push_back(pieces.triangle[i]);
            out.label.push_back(label[i]);
        }
    }
    for (uint32_t t : out.source) {
        if (!mesh.flags.empty())
            out.mesh.flags.push_back(mesh.flags[t]);
        if (!mesh.appearance.material.empty())
            out.mesh.appearance.material.push_back(mesh.appearance.material[t]);
    }
    return out;
}

} // namespace gtx
