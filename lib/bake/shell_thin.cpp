/* The first and largest step to fewer triangles: inside each patch on its own, its border untouched. */
#include "bake/shell_parts.hpp"

#include <meshoptimizer.h>

#include <algorithm>

namespace gtx::baking {

using Triangles = std::vector<std::array<uint32_t, 3>>;

/* Steeper triangles are left alone: it takes little for them to turn away from their patch. */
constexpr double LEAST_FACING = 0.4;
/* Errors to try, each half as large, before a patch is left as it is. */
constexpr int ATTEMPTS = 3;

/* Triangles of a patch: those to be thinned, with vertices of their own, and others. */
struct Piece {
    std::vector<uint32_t> vertices; /* of the source, as they come */
    std::vector<unsigned> indices;
    Triangles steep;                /* of the source's vertices */
};

static std::vector<Piece> make_pieces(const ShellSource &source, const Maps &maps)
{
    const size_t patches = maps.patches.size();
    std::vector<Piece> pieces(patches);
    std::vector<uint32_t> start(patches + 1, 0), order(source.triangles.size());
    for (uint32_t p : source.patch)
        ++start[p + 1];
    for (size_t p = 0; p < patches; ++p)
        start[p + 1] += start[p];
    std::vector<uint32_t> next(start.begin(), start.end() - 1);
    for (size_t t = 0; t < source.triangles.size(); ++t)
        order[next[source.patch[t]]++] = uint32_t(t);

    /* Where a vertex is in the piece that had it last. */
    std::vector<unsigned> place(source.positions.size(), 0);
    for (size_t p = 0; p < patches; ++p) {
        Piece &piece = pieces[p];
        const float *z = maps.patches[p].axis_z;
        piece.indices.reserve(3 * (start[p + 1] - start[p]));
        for (uint32_t i = start[p]; i < start[p + 1]; ++i) {
            const auto &t = source.triangles[order[i]];
            const Vec3d a = source.positions[t[0]];
            const Vec3d area = cross(source.positions[t[1]] - a, source.positions[t[2]] - a);
            if (dot(area, Vec3d(z[0], z[1], z[2])) < LEAST_FACING * length(area)) {
                piece.steep.push_back(t);
                continue;
            }
            for (uint32_t v : t) {
                if (place[v] >= piece.vertices.size() || piece.vertices[place[v]] != v) {
                    place[v] = unsigned(piece.vertices.size());
                    piece.vertices.push_back(v);
                }
                piece.indices.push_back(place[v]);
            }
        }
    }
    return pieces;
}

/* From the first vertex on, so that floats are fine enough. */
static std::vector<float> positions_of(const ShellSource &source, const Piece &piece)
{
    std::vector<float> positions;
    positions.reserve(3 * piece.vertices.size());
    for (uint32_t v : piece.vertices) {
        const Vec3d from = source.positions[v] - source.positions[piece.vertices[0]];
        positions.insert(positions.end(), {float(from.x), float(from.y), float(from.z)});
    }
    return positions;
}

/* Simplifies at an error of at most `most`, which becomes what it came to. */
static Triangles simplify(const Piece &piece, const std::vector<float> &positions, double &most)
{
    std::vector<unsigned> out(piece.indices.size());
    const size_t vertices = piece.vertices.size(), stride = 3 * sizeof(float);
    const float scale = meshopt_simplifyScale(positions.data(), vertices, stride);
    float came_to = 0; /* as a share of the scale, like what is asked for */
    out.resize(meshopt_simplify(out.data(), piece.indices.data(), piece.indices.size(),
                                positions.data(), vertices, stride, 0,
                                float(most / std::max(double(scale), most)),
                                meshopt_SimplifyLockBorder, &came_to));
    most = double(came_to) * scale;
    Triangles left;
    for (size_t i = 0; i < out.size(); i += 3)
        left.push_back({piece.vertices[out[i]], piece.vertices[out[i + 1]],
                        piece.vertices[out[i + 2]]});
    return left;
}

/* Whether all face the patch: simplifying looks at them in space alone. */
static bool all_face(const ShellSource &source, const PatchRegion &region,
                     const Triangles &triangles)
{
    return std::all_of(triangles.begin(), triangles.end(), [&](const auto &t) {
        const std::array<double, 2> corner[] = {region.place(source.positions[t[0]]),
                                                region.place(source.positions[t[1]]),
                                                region.place(source.positions[t[2]])};
        return winding(corner) > 0;
    });
}

static Triangles thin_piece(const ShellSource &source, const PatchRegion &region,
                            const Piece &piece, double most, double &error)
{
    Triangles out = piece.steep;
    if (piece.indices.empty())
        return out;
    const std::vector<float> positions = positions_of(source, piece);
    Triangles left;
    for (int n = 0; n <= ATTEMPTS; ++n) {
        error = n < ATTEMPTS ? std::ldexp(most, -n) : 0;
        left = simplify(piece, positions, error);
        if (all_face(source, region, left))
            break;
    }
    out.insert(out.end(), left.begin(), left.end());
    return out;
}

ShellSource thin(const ShellSource &source, const Maps &maps,
                 const std::vector<PatchRegion> &regions, double most, double &error, Task &task)
{
    const size_t patches = regions.size();
    const std::vector<Piece> pieces = make_pieces(source, maps);
    std::vector<Triangles> left(patches);
    std::vector<double> errors(patches, 0);
    task.parallel(patches, [&](size_t p) {
        left[p] = thin_piece(source, regions[p], pieces[p], most, errors[p]);
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
