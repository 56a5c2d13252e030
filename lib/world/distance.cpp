/* The distance between two surfaces. */
#include "world/surface.hpp"

#include "mesh/nearest.hpp"

#include <algorithm>

namespace gtx {

/* Points that are asked, spread over all there are: a limit of time. */
constexpr size_t MAX_POINTS = size_t(1) << 16;

namespace {

using Triangles = Vector<std::array<uint32_t, 3>>;

/* Shapes for NearestTree, relative to a point of theirs: boxes are floats. */
struct Shapes {
    const Vector<Vec3d> &positions;
    const Triangles &triangles;
    Vec3d origin;

    Shapes(const Vector<Vec3d> &at, const Triangles &of)
        : positions(at), triangles(of), origin(at.empty() ? Vec3d() : at[0])
    {
    }
    size_t size() const { return triangles.size(); }
    size_t looks(size_t) const { return 1; }
    Vec3d corner(size_t t, size_t k) const { return positions[triangles[t][k]] - origin; }
    Box box(size_t t) const
    {
        Box out;
        for (size_t k = 0; k < 3; ++k)
            out.add(corner(t, k));
        return out;
    }
    double distance2(size_t t, const Vec3d &p, double) const
    {
        return triangle_distance2(p, corner(t, 0), corner(t, 1), corner(t, 2));
    }
};

constexpr size_t CHUNK = 1024;

/* The square of how far the farthest point is from the first `count` shapes, or `least`: what is
 * nearer need not be known. */
double farthest_of(const Vector<Vec3d> &points, const Shapes &shapes,
                   const NearestTree<Shapes> &tree, size_t count, double least, Task &task)
{
    Vector<double> farthest((points.size() + CHUNK - 1) / CHUNK, least);
    task.parallel(farthest.size(), [&](size_t chunk) {
        uint32_t near = UINT32_MAX;
        double &most = farthest[chunk];
        for (size_t i = chunk * CHUNK; i < std::min(points.size(), (chunk + 1) * CHUNK); ++i)
            most = std::max(most, tree.distance2(points[i] - shapes.origin, &near,
                                                 [&](uint32_t t) { return t < count; }, nullptr,
                                                 most));
    }, 0, 0);
    for (double square : farthest)
        least = std::max(least, square);
    return least;
}

/* Corners and centres of the first `own` triangles, each so many-th. */
Vector<Vec3d> points_of(const Vector<Vec3d> &positions, const Triangles &triangles, size_t own)
{
    Vector<Vec3d> out;
    const size_t step = (2 * own + MAX_POINTS - 1) / MAX_POINTS;
    for (size_t i = 0; i < 2 * own; i += std::max(step, size_t(1))) {
        const auto &t = triangles[i / 2];
        const Vec3d &a = positions[t[0]], &b = positions[t[1]];
        out.push_back(i % 2 ? (a + b + positions[t[2]]) / 3 : a);
    }
    return out;
}

} // namespace

PlainMesh plain_mesh_of(const TileSurface &surface, size_t triangles)
{
    return {surface.positions, {surface.triangles.begin(),
                                surface.triangles.begin() + std::ptrdiff_t(triangles)}};
}

struct NearSurface::Tree {
    Shapes shapes;
    NearestTree<Shapes> tree;

    Tree(const TileSurface &surface, Task &task)
        : shapes(surface.positions, surface.triangles), tree(shapes, task, 0)
    {
    }
};

NearSurface::NearSurface(const TileSurface &surface, Task &task)
    : surface_(surface), task_(task)
{
}

NearSurface::~NearSurface() = default;

const NearSurface::Tree &NearSurface::tree()
{
    if (!tree_)
        tree_ = std::make_unique<Tree>(surface_, task_);
    return *tree_;
}

double NearSurface::distance_to(const PlainMesh &mesh, bool with_ring)
{
    const size_t count = with_ring ? surface_.triangles.size() : surface_.own;
    if (!count || mesh.triangles.empty())
        return 0;
    const Tree &own = this->tree();
    const Shapes shapes(mesh.positions, mesh.triangles);
    const NearestTree<Shapes> tree(shapes, task_, 0);
    const double there =
        farthest_of(points_of(surface_.positions, surface_.triangles, surface_.own), shapes, tree,
                    shapes.size(), 0, task_);
    return std::sqrt(farthest_of(points_of(mesh.positions, mesh.triangles, shapes.size()),
                                 own.shapes, own.tree, count, there, task_));
}

static Vector<uint32_t> nearest_of(const Vector<Vec3d> &points, const Shapes &shapes,
                                   const NearestTree<Shapes> &tree, Task &task)
{
    Vector<uint32_t> nearest(points.size(), UINT32_MAX);
    task.parallel((points.size() + CHUNK - 1) / CHUNK, [&](size_t chunk) {
        uint32_t near = UINT32_MAX;
        for (size_t i = chunk * CHUNK; i < std::min(points.size(), (chunk + 1) * CHUNK); ++i) {
            tree.distance2(points[i] - shapes.origin, &near);
            nearest[i] = near;
        }
    }, 0, 0);
    return nearest;
}

Vector<uint32_t> NearSurface::nearest_to(const Vector<Vec3d> &points)
{
    return nearest_of(points, tree().shapes, tree().tree, task_);
}

Vector<uint32_t> nearest_triangles(const Vector<Vec3d> &points, const PlainMesh &mesh, Task &task)
{
    const Shapes shapes(mesh.positions, mesh.triangles);
    return nearest_of(points, shapes, NearestTree<Shapes>(shapes, task, 0), task);
}

} // namespace gtx
