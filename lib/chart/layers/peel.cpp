/* The directions that a surface is peeled along, and which part of it faces which. */
#include "chart/layers/peel.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace gtx {

namespace {

/* Of what slant loses along the axes of the object, what other axes may lose at most to be taken:
 * those of a ball are any, and a box that lies straight must stay so. This and the next were chosen
 * on an engine, a truck and a leaf, and not tuned. */
constexpr double WORTH_TURNING = 0.75;

/* Least cosine of a triangle's own normal with the direction that smoothing gives it: where
 * designed parts meet at an edge smoothing rounds it. */
constexpr double MIN_FACING = 0.35;

/* Triangles of an island go over from its border inwards, so many deep. */
constexpr int PASSES = 4;

/* Calls body(t) for triangles 0 to count - 1, at once. */
template <class Body> void for_triangles(size_t count, Task &task, Body body)
{
    constexpr size_t LEAST = 1 << 14, TURNS = 16; /* of a short loop, that take as long as one */
    task.in_parts(count, task.parts(count, LEAST), [&](size_t, size_t from, size_t to) {
        cancel_point(TURNS * (to - from));
        for (size_t t = from; t < to; ++t)
            body(t);
    });
}

/* The share of the area that is lost to slant where everything is seen along the nearest axis. */
double slant(const Surface &surface, const Vector<Vec3d> &directions)
{
    constexpr size_t TURNS = 16; /* of a short loop, that take as long as a triangle */
    cancel_point(TURNS * surface.facets.size());
    const Vec3d &x = directions[0], &y = directions[2], &z = directions[4]; /* and opposites */
    double lost = 0, size = 0;
    for (const Facet &facet : surface.facets) {
        const Vec3d normal(facet.normal);
        const double facing = std::max({std::abs(dot(normal, x)), std::abs(dot(normal, y)),
                                        std::abs(dot(normal, z))});
        lost += double(facet.size) * (1 - facing);
        size += double(facet.size);
    }
    return lost / size;
}

Vector<Vec3d> with_opposites(const Vec3d &x, const Vec3d &y, const Vec3d &z)
{
    return {x, -x, y, -y, z, -z};
}

/* Those in which normals spread most and least: of a sheet or a board, across it and along it. */
Vector<Vec3d> principal_directions(const Surface &surface)
{
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Facet &facet : surface.facets)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                spread(i, j) += double(facet.size) * double(facet.normal[i]) *
                                double(facet.normal[j]);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    Vec3d axis[3];
    for (int k = 0; k < 2; ++k) {
        const auto column = solver.eigenvectors().col(2 - k);
        axis[k] = normalize(Vec3d(column(0), column(1), column(2)));
    }
    axis[1] = normalize(axis[1] - axis[0] * dot(axis[0], axis[1]));
    axis[2] = cross(axis[0], axis[1]);
    return with_opposites(axis[0], axis[1], axis[2]);
}

/* Lets triangles of small islands go over to a larger piece beside them that sees them well;
 * whether any does. */
bool give_up_islands(const Surface &surface, const Vector<Vec3d> &directions, double pitch,
                     Vector<uint32_t> &label, Task &task)
{
    Vector<uint32_t> piece = label;
    Vector<double> texels(connected_pieces(surface.whole, piece));
    const double mean = surface.area / double(label.size());
    for (size_t t = 0; t < label.size(); ++t)
        texels[piece[t]] += double(surface.facets[t].size) * mean / (pitch * pitch);
    const Vector<uint32_t> before = label;
    for_triangles(label.size(), task, [&](size_t t) {
        double best = MIN_FACING;
        if (texels[piece[t]] >= SMALL_ISLAND_TEXELS)
            return;
        for (uint32_t n : surface.whole.neighbours[t]) {
            if (n == NO_TRIANGLE || texels[piece[n]] <= texels[piece[t]])
                continue;
            const Vec3d &z = directions[before[n]];
            const double facing = std::min(dot(Vec3d(surface.facets[t].normal), z),
                                           dot(Vec3d(surface.normal[t]), z));
            if (facing > best) {
                best = facing;
                label[t] = before[n];
            }
        }
    });
    return label != before;
}

} // namespace

size_t nearest_direction(const Vector<Vec3d> &directions, const Vec3d &vector)
{
    size_t best = 0;
    for (size_t i = 1; i < directions.size(); ++i)
        if (dot(vector, directions[i]) > dot(vector, directions[best]))
            best = i;
    return best;
}

Vector<Vec3d> object_directions()
{
    return with_opposites({1, 0, 0}, {0, 1, 0}, {0, 0, 1});
}

Vector<Vec3d> peel_directions(const Surface &surface)
{
    Vector<Vec3d> own = object_directions();
    Vector<Vec3d> other = principal_directions(surface);
    return slant(surface, other) < WORTH_TURNING * slant(surface, own) ? other : own;
}

Vector<uint32_t> peel(Surface &surface, const Vector<Vec3d> &directions, double pitch,
                      uint32_t &count, Task &task)
{
    Vector<uint32_t> label(surface.facets.size());
    for_triangles(label.size(), task, [&](size_t t) {
        const Vec3d own(surface.normal[t]);
        size_t nearest = nearest_direction(directions, Vec3d(surface.facets[t].normal));
        if (!surface.junk[t] && dot(own, directions[nearest]) < MIN_FACING) {
            nearest = nearest_direction(directions, own);
            surface.facets[t].normal = surface.normal[t];
        }
        label[t] = uint32_t(nearest);
    });
    for (int pass = 0; pass < PASSES && give_up_islands(surface, directions, pitch, label, task);)
        ++pass;
    count = connected_pieces(surface.whole, label);
    return label;
}

} // namespace gtx
