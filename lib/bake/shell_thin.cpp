/* The first and largest step to fewer triangles: inside each patch on its own, its border untouched. */
#include "bake/shell_parts.hpp"

#include <meshoptimizer.h>

#include <algorithm>

namespace gtx::baking {

/* The triangles of a patch as vertices of its own. */
struct Piece {
    std::vector<uint32_t> vertices; /* of the source, ascending */
    std::vector<float> positions;   /* from the first vertex on, so that floats are fine enough */
    std::vector<unsigned> indices;
};

static Piece make_piece(const ShellSource &source, const std::vector<uint32_t> &triangles)
{
    Piece piece;
    for (uint32_t t : triangles)
        piece.vertices.insert(piece.vertices.end(), source.triangles[t].begin(),
                              source.triangles[t].end());
    std::sort(piece.vertices.begin(), piece.vertices.end());
    piece.vertices.erase(std::unique(piece.vertices.begin(), piece.vertices.end()),
                         piece.vertices.end());
    for (uint32_t v : piece.vertices) {
        const Vec3d from = source.positions[v] - source.positions[piece.vertices[0]];
        piece.positions.insert(piece.positions.end(), {float(from.x), float(from.y), float(from.z)});
    }
    for (uint32_t t : triangles)
        for (uint32_t v : source.triangles[t])
            piece.indices.push_back(unsigned(
                std::lower_bound(piece.vertices.begin(), piece.vertices.end(), v) -
                piece.vertices.begin()));
    return piece;
}

static std::vector<std::array<uint32_t, 3>> thin_piece(const Piece &piece, double most,
                                                       double &error)
{
    std::vector<std::array<uint32_t, 3>> left;
    if (piece.indices.empty())
        return left;
    std::vector<unsigned> out(piece.indices.size());
    const size_t vertices = piece.vertices.size(), stride = 3 * sizeof(float);
    const float scale = meshopt_simplifyScale(piece.positions.data(), vertices, stride);
    float came_to = 0; /* as a share of the scale, like what is asked for */
    out.resize(meshopt_simplify(out.data(), piece.indices.data(), piece.indices.size(),
                                piece.positions.data(), vertices, stride, 0,
                                float(most / std::max(double(scale), most)),
                                meshopt_SimplifyLockBorder, &came_to));
    error = double(came_to) * scale;
    for (size_t i = 0; i < out.size(); i += 3)
        left.push_back({piece.vertices[out[i]], piece.vertices[out[i + 1]],
                        piece.vertices[out[i + 2]]});
    return left;
}

ShellSource thin(const ShellSource &source, size_t patches, double most, double &error,
                 Task &task)
{
    std::vector<std::vector<uint32_t>> members(patches);
    for (size_t t = 0; t < source.triangles.size(); ++t)
        members[source.patch[t]].push_back(uint32_t(t));
    std::vector<std::vector<std::array<uint32_t, 3>>> left(patches);
    std::vector<double> errors(patches, 0);
    task.parallel(patches, [&](size_t p) {
        left[p] = thin_piece(make_piece(source, members[p]), most, errors[p]);
    }, 0, 0.3);
    error = patches ? *std::max_element(errors.begin(), errors.end()) : 0;

    constexpr uint32_t UNUSED = 0xffffffffu;
    ShellSource out;
    std::vector<uint32_t> name(source.positions.size(), UNUSED);
    for (size_t p = 0; p < patches; ++p) {
        for (std::array<uint32_t, 3> t : left[p]) {
            for (uint32_t &v : t) {
                if (name[v] == UNUSED) {
                    name[v] = uint32_t(out.positions.size());
                    out.positions.push_back(source.positions[v]);
                }
                v = name[v];
            }
            out.triangles.push_back(t);
            out.patch.push_back(uint32_t(p));
        }
    }
    return out;
}

} // namespace gtx::baking
