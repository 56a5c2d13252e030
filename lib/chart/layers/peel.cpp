/* The directions that a surface is peeled along, and which part of it faces which. */
#include "chart/layers/peel.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace gtx {

namespace {

/* Of the area that faces away from the nearest axis of the object, what other axes must spare to
 * be taken: those of a ball are any, and a box that lies straight must stay so. Half and double
 * change nothing but a ball's (bunny, armadillo, engine). */
constexpr double WORTH_TURNING = 0.75;

/* The share of the area that is lost to slant where everything is seen along the nearest axis. */
double slant(const Surface &surface, const Vector<Vec3d> &directions)
{
    double lost = 0, size = 0;
    for (const Facet &facet : surface.facets) {
        const Vec3d normal(facet.normal);
        lost += double(facet.size) *
                (1 - dot(normal, directions[nearest_direction(directions, normal)]));
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

} // namespace

size_t nearest_direction(const Vector<Vec3d> &directions, const Vec3d &vector)
{
    size_t best = 0;
    for (size_t i = 1; i < directions.size(); ++i)
        if (dot(vector, directions[i]) > dot(vector, directions[best]))
            best = i;
    return best;
}

Vector<Vec3d> peel_directions(const Surface &surface)
{
    Vector<Vec3d> own = with_opposites({1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    Vector<Vec3d> other = principal_directions(surface);
    return slant(surface, other) < WORTH_TURNING * slant(surface, own) ? other : own;
}

Vector<uint32_t> peel(const Surface &surface, const Vector<Vec3d> &directions, uint32_t &count)
{
    Vector<uint32_t> label(surface.facets.size());
    for (size_t t = 0; t < label.size(); ++t)
        label[t] = uint32_t(nearest_direction(directions, Vec3d(surface.facets[t].normal)));
    count = connected_pieces(surface.whole, label);
    return label;
}

} // namespace gtx
