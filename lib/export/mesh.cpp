/* An LOD mesh -> vertices as glTF has them: smooth normals, tangents, places in the page. */
#include "export/export.hpp"

#include "asset/patch.h"

#include <algorithm>

namespace gtx {

static Vec3d lod_point(const gtx_lod_mesh &lod, uint32_t vertex)
{
    Vec3d p;
    const uint16_t *q = lod.positions + 3 * size_t(vertex);
    for (int k = 0; k < 3; ++k)
        p[k] = double(lod.origin[k]) + double(lod.step) * q[k];
    return p;
}

/* Of the whole mesh, across its patches, weighted by area: those of neighbours agree. */
static Vector<Vec3d> smooth_normals(const gtx_lod_mesh &lod)
{
    Vector<Vec3d> normals(lod.vertex_count);
    for (uint32_t t = 0; t < lod.triangle_count; ++t) {
        const uint32_t *corner = lod.indices + 3 * size_t(t);
        const Vec3d a = lod_point(lod, corner[0]);
        const Vec3d area = cross(lod_point(lod, corner[1]) - a, lod_point(lod, corner[2]) - a);
        for (int k = 0; k < 3; ++k)
            normals[corner[k]] += area;
    }
    for (Vec3d &n : normals)
        n = normalize(n);
    return normals;
}

/* The arc cosine within 7e-5, by arithmetic that is the same on every machine (Abramowitz and
 * Stegun, 4.4.45). */
static double angle_of(double cosine)
{
    const double x = std::min(std::abs(cosine), 1.);
    const double angle = std::sqrt(1 - x) *
                         (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
    return cosine < 0 ? 3.14159265358979 - angle : angle;
}

static Vec3d flattened(const Vec3d &v, const Vec3d &normal)
{
    return normalize(v - normal * dot(v, normal));
}

namespace {

struct PartMaker {
    const gtx_info &info;
    const gtx_lod_mesh &lod;
    const Vector<Vec3d> &normals;
    double inset;
    ExportMesh &out;
    Vector<uint32_t> known;          /* of a vertex of the LOD mesh: its number in the part */
    Vector<uint32_t> vertices;       /* of the LOD mesh, of the part */

    static constexpr uint32_t NONE = 0xffffffffu;

    void add_vertex(const gtx_patch &patch, const gtx_patch_frame &frame, uint32_t vertex)
    {
        ExportVertex v = {};
        const Vec3d p = lod_point(lod, vertex);
        v.position = Vec3f(p);
        Vec3d normal = normals[vertex];
        if (normal == Vec3d())
            normal = normalize(Vec3d(patch.axis_z[0], patch.axis_z[1], patch.axis_z[2]));
        v.normal = normalize(Vec3f(normal));
        for (int k = 0; k < 2; ++k) {
            const double *row = frame.to_grid[k];
            const double at = row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3] + 0.5;
            const double size = patch.rect[2 + k];
            v.texel[k] = float(patch.rect[k] + std::clamp(at, inset, size - inset));
        }
        out.vertices.push_back(v);
    }

    /* As MikkTSpace has them, which readers use that make their own: of each triangle the direction
     * in which u grows, laid flat on the vertex normal, weighted by the angle at the vertex. */
    void add_tangents(const ExportPart &part, const gtx_patch &patch)
    {
        Vector<Vec3d> sums(part.vertices);
        for (uint32_t t = 0; t < part.triangles; ++t) {
            const auto &corner = out.triangles[part.first_triangle + t];
            const ExportVertex *v[3];
            for (size_t k = 0; k < 3; ++k)
                v[k] = &out.vertices[corner[k]];
            double to[2][2];
            for (size_t k = 0; k < 2; ++k)
                for (size_t i = 0; i < 2; ++i)
                    to[k][i] = double(v[k + 1]->texel[i]) - double(v[0]->texel[i]);
            if (!(to[0][0] * to[1][1] - to[1][0] * to[0][1] > 0)) /* seen from behind, or thin */
                continue;
            const Vec3d origin(v[0]->position);
            const Vec3d along = (Vec3d(v[1]->position) - origin) * to[1][1] -
                                (Vec3d(v[2]->position) - origin) * to[0][1];
            for (size_t k = 0; k < 3; ++k) {
                const Vec3d normal(v[k]->normal), at(v[k]->position);
                const Vec3d a = flattened(Vec3d(v[(k + 1) % 3]->position) - at, normal);
                const Vec3d b = flattened(Vec3d(v[(k + 2) % 3]->position) - at, normal);
                sums[corner[k] - part.first_vertex] +=
                    flattened(along, normal) * angle_of(dot(a, b));
            }
        }
        const Vec3d axis(patch.axis_x[0], patch.axis_x[1], patch.axis_x[2]);
        for (uint32_t i = 0; i < part.vertices; ++i) {
            ExportVertex &v = out.vertices[part.first_vertex + i];
            const Vec3d normal(v.normal);
            Vec3d tangent = flattened(sums[i], normal);
            for (const Vec3d &other : {axis, Vec3d(1, 0, 0), Vec3d(0, 1, 0)})
                if (tangent == Vec3d())
                    tangent = flattened(other, normal);
            v.tangent = normalize(Vec3f(tangent));
        }
    }

    void add(uint32_t number, const gtx_patch &patch)
    {
        const gtx_patch_frame frame = gtx_patch_frame_of(&patch, info.height_bits);
        ExportPart part = {number, uint32_t(out.vertices.size()), 0,
                           uint32_t(out.triangles.size()), 0};
        for (uint32_t t = lod.first[number]; t < lod.first[number + 1]; ++t) {
            std::array<uint32_t, 3> corners;
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t vertex = lod.indices[3 * size_t(t) + k];
                if (known[vertex] == NONE) {
                    known[vertex] = uint32_t(out.vertices.size());
                    vertices.push_back(vertex);
                    add_vertex(patch, frame, vertex);
                }
                corners[k] = known[vertex];
            }
            out.triangles.push_back(corners);
        }
        for (uint32_t vertex : vertices)
            known[vertex] = NONE;
        vertices.clear();
        part.vertices = uint32_t(out.vertices.size()) - part.first_vertex;
        part.triangles = uint32_t(out.triangles.size()) - part.first_triangle;
        add_tangents(part, patch);
        out.parts.push_back(part);
    }
};

} // namespace

ExportMesh export_mesh(const gtx_asset *asset, const gtx_lod_mesh &lod, unsigned coarser,
                       Task &task)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    const gtx_patch *patches = gtx_patches(asset);
    Vector<uint32_t> order;
    for (uint32_t p = 0; p < info.patch_count; ++p)
        if (lod.first[p] < lod.first[p + 1])
            order.push_back(p);
    auto kind = [&](uint32_t p) {
        return 2 * uint64_t(patches[p].page) + (patches[p].flags & GTX_PATCH_TWO_SIDED ? 1 : 0);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return kind(a) < kind(b); });

    const Vector<Vec3d> normals = smooth_normals(lod);
    ExportMesh out;
    out.from = lod;
    out.triangles.reserve(lod.triangle_count);
    const double inset = 0.5 * double(1u << coarser);
    PartMaker maker = {info, lod, normals, inset, out,
                       Vector<uint32_t>(lod.vertex_count, PartMaker::NONE), {}};
    for (uint32_t p : order) {
        maker.add(p, patches[p]);
        task.advance(double(out.triangles.size()) / double(lod.triangle_count));
    }
    return out;
}

} // namespace gtx
