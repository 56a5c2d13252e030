/* How far two surfaces are from each other. */
#include "world/surface.hpp"

#include "mesh/nearest.hpp"

#include <algorithm>

namespace gtx {

/* Points that are asked, spread over all there are: a limit of time. */
constexpr size_t MAX_POINTS = size_t(1) << 16;

namespace {

/* Shapes for NearestTree, relative to a point of theirs: boxes are floats. */
struct SheetShapes {
    const Sheet &sheet;
    Vec3d origin;

    explicit SheetShapes(const Sheet &s)
        : sheet(s), origin(s.positions.empty() ? Vec3d() : s.positions[0])
    {
    }
    size_t size() const { return sheet.triangles.size(); }
    size_t looks(size_t) const { return 1; }
    Vec3d corner(size_t t, size_t k) const
    {
        return sheet.positions[sheet.triangles[t][k]] - origin;
    }
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

/* How far the farthest point is. */
double farthest_of(const Vector<Vec3d> &points, const Sheet &sheet, Task &task)
{
    const SheetShapes shapes(sheet);
    const NearestTree<SheetShapes> tree(shapes, task, 0);
    Vector<double> farthest((points.size() + CHUNK - 1) / CHUNK, 0);
    task.parallel(farthest.size(), [&](size_t chunk) {
        uint32_t near = UINT32_MAX;
        for (size_t i = chunk * CHUNK; i < std::min(points.size(), (chunk + 1) * CHUNK); ++i)
            farthest[chunk] = std::max(
                farthest[chunk], tree.distance2(points[i] - shapes.origin, &near,
                                                [](uint32_t) { return true; }, nullptr,
                                                farthest[chunk]));
    }, 0, 0);
    double most = 0;
    for (double square : farthest)
        most = std::max(most, square);
    return std::sqrt(most);
}

/* Corners and centres of triangles, each so many-th. */
Vector<Vec3d> points_of(const Sheet &sheet, size_t own)
{
    Vector<Vec3d> out;
    const size_t step = (2 * own + MAX_POINTS - 1) / MAX_POINTS;
    for (size_t i = 0; i < 2 * own; i += std::max(step, size_t(1))) {
        const auto &t = sheet.triangles[i / 2];
        const Vec3d &a = sheet.positions[t[0]], &b = sheet.positions[t[1]];
        out.push_back(i % 2 ? (a + b + sheet.positions[t[2]]) / 3 : a);
    }
    return out;
}

} // namespace

Sheet sheet_of(const TileSurface &surface, size_t triangles)
{
    return {surface.positions, {surface.triangles.begin(),
                                surface.triangles.begin() + std::ptrdiff_t(triangles)}};
}

double distance_between(const Sheet &from, size_t own, const Sheet &to, Task &task)
{
    if (from.triangles.empty() || to.triangles.empty())
        return 0;
    return std::max(farthest_of(points_of(from, own), to, task),
                    farthest_of(points_of(to, to.triangles.size()), from, task));
}

Vector<uint32_t> nearest_triangles(const Vector<Vec3d> &points, const Sheet &sheet, Task &task)
{
    const SheetShapes shapes(sheet);
    const NearestTree<SheetShapes> tree(shapes, task, 0);
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

} // namespace gtx
