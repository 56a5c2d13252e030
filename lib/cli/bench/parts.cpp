/* Cuts a mesh into parts, simplifies it, and draws the parts that are in view. */
#include "cli/bench/parts.hpp"

#include "host/camera.h"
#include "host/offscreen.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

namespace gtx {

/* Triangles of a part, at most. On a terrain of 2.88 million, 256 to 2048 took the same processor
 * time in all views, on llvmpipe. */
constexpr uint32_t PART_TRIANGLES = 512;
constexpr size_t MIN_TRIANGLES = 64;

namespace {

struct Cutter {
    const MeshLevels &mesh;
    const Vector<uint32_t> &indices;
    Vector<uint32_t> order;           /* of triangles */
    Vector<Vec3f> centres;
    Vector<MeshPart> parts;

    const float *corner(uint32_t t, int k) const
    {
        return mesh.vertices[indices[3 * size_t(t) + size_t(k)]].position;
    }
    bool is_two_sided(uint32_t t) const
    {
        return mesh.vertices[indices[3 * size_t(t)]].material[3] != 0;
    }
    void add_part(uint32_t begin, uint32_t end)
    {
        /* as they followed one another, for the vertex cache */
        std::sort(order.begin() + begin, order.begin() + end);
        MeshPart part = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY},
                         3 * begin, 3 * (end - begin), is_two_sided(order[begin])};
        for (uint32_t i = begin; i < end; ++i)
            for (int k = 0; k < 9; ++k) {
                const float x = corner(order[i], k / 3)[k % 3];
                part.low[k % 3] = std::min(part.low[k % 3], x);
                part.high[k % 3] = std::max(part.high[k % 3], x);
            }
        parts.push_back(part);
    }
    /* Halves, along the longest side of the box of centres. */
    void cut(uint32_t begin, uint32_t end)
    {
        if (end - begin <= PART_TRIANGLES) {
            if (begin < end)
                add_part(begin, end);
            return;
        }
        Vec3f low(INFINITY, INFINITY, INFINITY), high = -low;
        for (uint32_t i = begin; i < end; ++i)
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], centres[order[i]][k]);
                high[k] = std::max(high[k], centres[order[i]][k]);
            }
        const Vec3f side = high - low;
        const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
        const uint32_t middle = begin + (end - begin) / 2;
        std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                         [&](uint32_t a, uint32_t b) {
                             const float x = centres[a][axis], y = centres[b][axis];
                             return x != y ? x < y : a < b;
                         });
        cut(begin, middle);
        cut(middle, end);
    }
};

/* Puts the triangles into the order of their parts. */
Vector<MeshPart> cut_into_parts(const MeshLevels &mesh, Vector<uint32_t> &indices)
{
    const uint32_t count = uint32_t(indices.size() / 3);
    Cutter cutter = {mesh, indices, Vector<uint32_t>(count), Vector<Vec3f>(count), {}};
    for (uint32_t t = 0; t < count; ++t) {
        cutter.order[t] = t;
        for (int k = 0; k < 9; ++k)
            cutter.centres[t][k % 3] += cutter.corner(t, k / 3)[k % 3] / 3;
    }
    const auto middle = std::partition(cutter.order.begin(), cutter.order.end(),
                                       [&](uint32_t t) { return !cutter.is_two_sided(t); });
    cutter.cut(0, uint32_t(middle - cutter.order.begin()));
    cutter.cut(uint32_t(middle - cutter.order.begin()), count);
    Vector<uint32_t> sorted;
    sorted.reserve(indices.size());
    for (uint32_t t : cutter.order)
        for (size_t k = 0; k < 3; ++k)
            sorted.push_back(indices[3 * size_t(t) + k]);
    indices = std::move(sorted);
    return std::move(cutter.parts);
}

} // namespace

PartLevels make_part_levels(const Mesh &mesh, const Vec3d &centre, bool simplified,
                            double max_error)
{
    PartLevels out;
    out.mesh = make_mesh_levels(mesh, centre, false);
    out.errors.push_back(0);
    Vector<Vector<uint32_t>> &levels = out.mesh.indices;
    const Vector<gtx_polygon_vertex> &vertices = out.mesh.vertices;
    const size_t size = sizeof vertices[0], source = levels[0].size();
    while (simplified && out.errors.back() < max_error) {
        const size_t wanted = (source / 3 >> levels.size()) * 3;
        Vector<uint32_t> next(source);
        float error = 0;
        next.resize(meshopt_simplify(next.data(), levels[0].data(), source, vertices[0].position,
                                     vertices.size(), size, wanted, 1.f, 0, &error));
        if (next.size() < 3 * MIN_TRIANGLES || next.size() >= levels.back().size())
            break;
        meshopt_optimizeVertexCache(next.data(), next.data(), next.size(), vertices.size());
        levels.push_back(std::move(next));
        out.errors.push_back(std::max(
            out.errors.back(),
            double(error) * meshopt_simplifyScale(vertices[0].position, vertices.size(), size)));
    }
    for (Vector<uint32_t> &level : levels)
        out.parts.push_back(cut_into_parts(out.mesh, level));
    return out;
}

/* ---- what is in view ---- */

Frustum::Frustum(const float m[16])
{
    for (int plane = 0; plane < 6; ++plane)
        for (int k = 0; k < 4; ++k)
            planes_[plane][k] = m[4 * k + 3] + (plane % 2 ? -1.f : 1.f) * m[4 * k + plane / 2];
}

bool Frustum::sees(const MeshPart &part) const
{
    for (const float *p : planes_) {
        float most = p[3];
        for (int k = 0; k < 3; ++k)
            most += std::max(p[k] * part.low[k], p[k] * part.high[k]);
        if (most < 0)
            return false;
    }
    return true;
}

static Frustum frustum_of(const gtx_view &view)
{
    float both[16];
    gtx_matrix_multiply(view.projection, view.view, both);
    return Frustum(both);
}

static Vec3f eye_of(const gtx_view &view)
{
    Vec3f eye;
    for (int k = 0; k < 3; ++k)
        for (int r = 0; r < 3; ++r)
            eye[k] -= view.view[4 * k + r] * view.view[12 + r];
    return eye;
}

/* From the eye to the nearest vertex of the source among the parts in view; infinity if there is
 * none. */
static double nearest_distance(const PartLevels &levels, const gtx_view &view)
{
    const Frustum frustum = frustum_of(view);
    const Vec3f eye = eye_of(view);
    float nearest = INFINITY;
    for (const MeshPart &part : levels.parts[0]) {
        Vec3f off;
        for (int k = 0; k < 3; ++k)
            off[k] = std::max({part.low[k] - eye[k], eye[k] - part.high[k], 0.f});
        if (!frustum.sees(part) || length(off) >= nearest)
            continue;
        for (uint32_t i = 0; i < part.count; ++i) {
            const uint32_t v = levels.mesh.indices[0][part.first + i];
            const float *p = levels.mesh.vertices[v].position;
            nearest = std::min(nearest, length(Vec3f(p[0], p[1], p[2]) - eye));
        }
    }
    return double(nearest);
}

size_t coarsest_level(const PartLevels &levels, const gtx_view &view, double max_error)
{
    const double pixels = double(view.projection[5]) * view.viewport_height / 2;
    const double allowed = max_error * nearest_distance(levels, view) / pixels;
    size_t level = levels.errors.size() - 1;
    while (level > 0 && !(levels.errors[level] <= allowed))
        --level;
    return level;
}

/* ---- drawing ---- */

PartDrawer::PartDrawer(const gtx_host_gl &gl)
    : gl_(gl), multi_draw_(reinterpret_cast<PFNGLMULTIDRAWELEMENTSPROC>(
                   gtx_offscreen_load("glMultiDrawElements", nullptr)))
{
    if (!multi_draw_)
        throw Error(GTX_ERROR_GL, "the context has no glMultiDrawElements");
}

void PartDrawer::draw_side(const Vector<MeshPart> &parts, const Frustum &frustum, bool two_sided)
{
    counts_.clear();
    offsets_.clear();
    uint32_t end = 0;
    for (const MeshPart &part : parts) {
        if (part.two_sided != two_sided || !frustum.sees(part))
            continue;
        if (!counts_.empty() && part.first == end) {
            counts_.back() += GLsizei(part.count);
        } else {
            counts_.push_back(GLsizei(part.count));
            offsets_.push_back(reinterpret_cast<const void *>(uintptr_t(part.first) * 4));
        }
        end = part.first + part.count;
    }
    if (!counts_.empty())
        multi_draw_(GL_TRIANGLES, counts_.data(), GL_UNSIGNED_INT, offsets_.data(),
                    GLsizei(counts_.size()));
}

void PartDrawer::draw(const gtx_polygon_program &program, const gtx_polygons &polygons,
                      const Vector<MeshPart> &parts, const gtx_view &view)
{
    const Frustum frustum = frustum_of(view);
    gtx_polygons nothing = polygons; /* sets the uniforms */
    nothing.index_count = 0;
    gtx_polygons_draw(&gl_, &program, &nothing, nullptr, &view);
    gl_.UseProgram(program.program);
    gl_.BindVertexArray(polygons.vertex_array);
    gl_.Enable(GL_CULL_FACE);
    gl_.CullFace(GL_BACK);
    draw_side(parts, frustum, false);
    gl_.Disable(GL_CULL_FACE);
    draw_side(parts, frustum, true);
    gl_.BindVertexArray(0);
    gl_.UseProgram(0);
}

} // namespace gtx
