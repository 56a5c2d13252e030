/* The first and largest step to fewer triangles: inside each patch, its border untouched. */
#include "bake/lod/parts.hpp"

#include <meshoptimizer.h>

#include <algorithm>

namespace gtx::baking {

using Triangles = Vector<std::array<uint32_t, 3>>;

/* Steeper triangles are left alone: it takes little for them to turn away from their patch. Spot's
 * control mesh: a few bytes at half, 0.5 % fewer triangles at double. */
constexpr double MIN_FACING = 0.4;
/* So often a patch is thinned anew around what turned away, before it is left as it is: a
 * limit, half changes nothing. */
constexpr int ATTEMPTS = 4;

/* Triangles of a patch: those to be thinned, with vertices of their own, and others. */
struct Piece {
    Vector<uint32_t> vertices;      /* of the source, as they come */
    Vector<unsigned> indices;
    Triangles kept;                 /* as they are, of the source's vertices */
};

static Vector<Piece> make_pieces(const LodSource &source, const Maps &maps)
{
    const size_t patches = maps.patches.size();
    Vector<Piece> pieces(patches);
    Vector<uint32_t> start(patches + 1, 0), order(source.triangles.size());
    for (uint32_t p : source.patch)
        ++start[p + 1];
    for (size_t p = 0; p < patches; ++p)
        start[p + 1] += start[p];
    Vector<uint32_t> next(start.begin(), start.end() - 1);
    for (size_t t = 0; t < source.triangles.size(); ++t)
        order[next[source.patch[t]]++] = uint32_t(t);

    /* Where a vertex is in the piece that had it last. */
    Vector<unsigned> place(source.positions.size(), 0);
    for (size_t p = 0; p < patches; ++p) {
        Piece &piece = pieces[p];
        const float *z = maps.patches[p].axis_z;
        piece.indices.reserve(3 * (start[p + 1] - start[p]));
        for (uint32_t i = start[p]; i < start[p + 1]; ++i) {
            const auto &t = source.triangles[order[i]];
            const Vec3d a = source.positions[t[0]];
            const Vec3d area = cross(source.positions[t[1]] - a, source.positions[t[2]] - a);
            if (dot(area, Vec3d(z[0], z[1], z[2])) < MIN_FACING * length(area)) {
                piece.kept.push_back(t);
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
static Vector<float> positions_of(const LodSource &source, const Piece &piece)
{
    Vector<float> positions;
    positions.reserve(3 * piece.vertices.size());
    for (uint32_t v : piece.vertices) {
        const Vec3d from = source.positions[v] - source.positions[piece.vertices[0]];
        positions.insert(positions.end(), {float(from.x), float(from.y), float(from.z)});
    }
    return positions;
}

/* The triangles left at an error of at most `most`, which becomes what it came to. */
static Vector<unsigned> simplify(const Piece &piece, const Vector<float> &positions,
                                 double &most)
{
    Vector<unsigned> left(piece.indices.size());
    const size_t vertices = piece.vertices.size(), stride = 3 * sizeof(float);
    const float scale = meshopt_simplifyScale(positions.data(), vertices, stride);
    float came_to = 0; /* as a share of the scale, like what is asked for */
    left.resize(meshopt_simplify(left.data(), piece.indices.data(), piece.indices.size(),
                                 positions.data(), vertices, stride, 0,
                                 float(most / std::max(double(scale), most)),
                                 meshopt_SimplifyLockBorder, &came_to));
    most = double(came_to) * scale;
    return left;
}

static void keep(const Piece &piece, const Vector<unsigned> &indices, Triangles &out)
{
    for (size_t i = 0; i < indices.size(); i += 3)
        out.push_back({piece.vertices[indices[i]], piece.vertices[indices[i + 1]],
                       piece.vertices[indices[i + 2]]});
}

/* Simplifying looks at triangles in space alone. Where some have turned away from the patch, all
 * around their corners is kept as it was. False when there is nothing of that. */
static bool keep_turned(const LodSource &source, const PatchRegion &region,
                        const Vector<unsigned> &left, Piece &piece)
{
    Vector<uint8_t> stays(piece.vertices.size(), 0);
    bool any = false;
    for (size_t i = 0; i < left.size(); i += 3) {
        std::array<double, 2> corner[3];
        for (int k = 0; k < 3; ++k)
            corner[k] = region.place(source.positions[piece.vertices[left[i + k]]]);
        if (winding(corner) > 0)
            continue;
        any = true;
        for (int k = 0; k < 3; ++k)
            stays[left[i + k]] = 1;
    }
    Vector<unsigned> kept, rest;
    for (size_t i = 0; any && i < piece.indices.size(); i += 3) {
        const unsigned *t = &piece.indices[i];
        Vector<unsigned> &to = stays[t[0]] || stays[t[1]] || stays[t[2]] ? kept : rest;
        to.insert(to.end(), t, t + 3);
    }
    if (any) {
        keep(piece, kept, piece.kept);
        piece.indices = std::move(rest);
    }
    return any;
}

static Triangles thin_piece(const LodSource &source, const PatchRegion &region, Piece piece,
                            double most, double &error)
{
    Vector<unsigned> left;
    const Vector<float> positions = positions_of(source, piece);
    for (int n = 0; n < ATTEMPTS && !piece.indices.empty(); ++n) {
        error = most;
        left = simplify(piece, positions, error);
        if (!keep_turned(source, region, left, piece)) {
            keep(piece, left, piece.kept);
            return std::move(piece.kept);
        }
    }
    error = 0;
    keep(piece, piece.indices, piece.kept);
    return std::move(piece.kept);
}

LodSource thin(const LodSource &source, const Maps &maps,
               const Vector<PatchRegion> &regions, double most, double &error, Task &task)
{
    const size_t patches = regions.size();
    Vector<Piece> pieces = make_pieces(source, maps);
    Vector<Triangles> left(patches);
    Vector<double> errors(patches, 0);
    task.parallel(patches, [&](size_t p) {
        left[p] = thin_piece(source, regions[p], std::move(pieces[p]), most, errors[p]);
    }, 0, 0.3);
    error = patches ? *std::max_element(errors.begin(), errors.end()) : 0;

    constexpr uint32_t UNUSED = 0xffffffffu;
    LodSource out;
    Vector<uint32_t> name(source.positions.size(), UNUSED);
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
