/* Triangles -> vertices with colours, cut up where a texture lies on them. */
#include "cli/view/polygons.hpp"

#include "mesh/material/srgb.hpp"

#include <algorithm>
#include <utility>

namespace gtx {

/* Small triangles of all textured ones together, about, and along a side of one, at most. */
constexpr double WANTED = 1 << 20, MAX_PIECES = 512;

static double longest_side(const Mesh &mesh, size_t t)
{
    double longest = 0;
    for (int k = 0; k < 3; ++k)
        longest = std::max(longest, length(mesh.position(t, (k + 1) % 3) - mesh.position(t, k)));
    return longest;
}

/* The side of a small triangle. */
static double find_side(const Mesh &mesh)
{
    if (mesh.appearance.images.empty())
        return INFINITY;
    double square = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        square += std::pow(longest_side(mesh, t), 2);
    return std::sqrt(square / WANTED);
}

static uint8_t to_byte(float share)
{
    return uint8_t(std::clamp(share, 0.f, 1.f) * 255 + 0.5f);
}

namespace {

struct TriangleCutter {
    const Mesh &mesh;
    const Vec3d &centre;
    double side;                 /* of the small triangles */
    bool emits;
    Polygons out = {};
    Vector<float> cut = {};      /* of one triangle's vertices */

    /* `pieces` x `pieces` small triangles in place of one. */
    void add_triangle(size_t t, uint32_t pieces)
    {
        const uint32_t first = uint32_t(out.vertices.size());
        const uint8_t sides = !mesh.flags.empty() && (mesh.flags[t] & TRIANGLE_TWO_SIDED) ? 255 : 0;
        cut.clear();
        for (uint32_t j = 0; j <= pieces; ++j) {
            for (uint32_t i = 0; i + j <= pieces; ++i) {
                float b = float(i) / float(pieces), c = float(j) / float(pieces);
                const float weight[3] = {1 - b - c, b, c};
                SurfaceSample s = sample_surface(mesh, t, weight, side);
                Vec3f p(mesh.position(t, 0) * double(weight[0]) + mesh.position(t, 1) * double(b) +
                        mesh.position(t, 2) * double(c) - centre);
                out.vertices.push_back({{p.x, p.y, p.z}, {s.normal.x, s.normal.y, s.normal.z},
                                        {linear_to_srgb(s.color[0]), linear_to_srgb(s.color[1]),
                                         linear_to_srgb(s.color[2]), uint8_t(s.lit > 0 ? 255 : 0)},
                                        {to_byte(s.occlusion), to_byte(s.roughness),
                                         to_byte(s.metallic), sides}});
                if (emits)
                    out.emissions.push_back({linear_to_srgb(s.emission[0]),
                                             linear_to_srgb(s.emission[1]),
                                             linear_to_srgb(s.emission[2]), 255});
                cut.push_back(s.cut);
            }
        }
        auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
            if (!(cut[a] + cut[b] + cut[c] < 0))
                out.indices.insert(out.indices.end(), {first + a, first + b, first + c});
        };
        uint32_t row = 0; /* its first vertex */
        for (uint32_t j = 0; j < pieces; ++j) {
            uint32_t in_row = pieces - j, next = row + in_row + 1;
            for (uint32_t i = 0; i < in_row; ++i) {
                add(row + i, row + i + 1, next + i);
                if (i + 1 < in_row)
                    add(row + i + 1, next + i + 1, next + i);
            }
            row = next;
        }
    }
};

} // namespace

Polygons make_polygons(const Mesh &mesh, const Vec3d &centre)
{
    const AppearanceNeeds needs = appearance_needs(mesh);
    TriangleCutter cutter = {mesh, centre, find_side(mesh), needs.emission};
    Polygons &out = cutter.out;
    out.has_materials = needs.material || needs.emission;
    out.vertices.reserve(3 * mesh.triangle_count());
    out.indices.reserve(3 * mesh.triangle_count());
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        double pieces = std::ceil(longest_side(mesh, t) / cutter.side);
        cutter.add_triangle(t, uint32_t(std::clamp(pieces, 1., MAX_PIECES)));
        if (std::max(out.vertices.size(), out.indices.size()) > 0x7fffffff)
            throw Error(GTX_ERROR_LIMIT, "a mesh of too many triangles to draw");
    }
    return std::move(cutter.out);
}

} // namespace gtx
