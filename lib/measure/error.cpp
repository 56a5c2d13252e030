/* Distances between source and assets: points of one, and the nearest points of the other. */
#include "measure/cells.hpp"
#include "measure/measure.hpp"
#include "measure/sample.hpp"
#include "measure/view.hpp"

#include "asset/patch.h"

namespace gtx {

static const size_t SAMPLES = size_t(1) << 18, CHUNK = 1 << 14;
/* A limit on time: nodes of the tree that a point of a chunk looks at in the mean. Scans take 50,
 * an engine of 82 nodes 128 at most; where more surfaces lie over each other fewer points are
 * measured. */
static const size_t MAX_LOOKS = 192;

namespace {

/* Shapes for NearestTree. All is relative to the first asset's anchor: boxes are floats. */
struct MeshTriangles {
    const Mesh &mesh;
    Vec3d anchor;

    size_t size() const { return mesh.triangle_count(); }
    size_t looks(size_t) const { return 1; }
    Vec3d position(size_t t, int k) const { return mesh.position(t, k) - anchor; }
    Box box(size_t t) const
    {
        Box box;
        for (int k = 0; k < 3; ++k)
            box.add(position(t, k));
        return box;
    }
    double distance2(size_t t, const Vec3d &p, double) const
    {
        return triangle_distance2(p, position(t, 0), position(t, 1), position(t, 2));
    }
};

} // namespace

static Vector<Vec3d> sample_mesh(const MeshTriangles &source,
                                 const Vector<uint8_t> &junk)
{
    Vector<double> area(source.size());
    for (size_t t = 0; t < area.size(); ++t) {
        cancel_point();
        area[t] = !junk.empty() && junk[t] ? 0 : length(source.mesh.area_vector(t)) / 2;
    }
    Vector<Vec3d> points;
    Random random;
    stratify(area, SAMPLES, random, [&](size_t t) {
        double u = std::sqrt(random.next()), v = random.next();
        const double weight[3] = {1 - u, u * (1 - v), u * v};
        if (!is_cut(source.mesh, t, weight, 0))
            points.push_back(source.position(t, 0) * weight[0] + source.position(t, 1) * weight[1] +
                             source.position(t, 2) * weight[2]);
    });
    return points;
}

static Vector<Vec3d> sample_cells(const Cells &cells)
{
    Vector<double> area(cells.size());
    for (size_t i = 0; i < area.size(); ++i) {
        cancel_point();
        area[i] = cells.shown_area(i);
    }
    Vector<Vec3d> points;
    Random random;
    stratify(area, SAMPLES, random, [&](size_t i) {
        for (int attempt = 0; attempt < 64; ++attempt) {
            double u = random.next(), v = random.next();
            if (cells.trim(i, u, v) <= GTX_TRIM_SHOWN) {
                points.push_back(cells.point(i, u, v));
                return;
            }
        }
    });
    return points;
}

/* Squared distances of the points of a chunk, negative where none was sought: every 8th point
 * first. Each such round adds its share of the looks: the first is where a search for all would
 * end. */
template <class Shapes>
static void seek(const NearestTree<Shapes> &tree, const Vec3d *points, double *square, size_t count)
{
    static const size_t FIRST[] = {0, 4, 2, 6, 1, 5, 3, 7}, STEP = std::size(FIRST);
    const size_t share = MAX_LOOKS / STEP * count;
    uint32_t near = NO_HIT; /* consecutive points lie on one shape or on the next */
    size_t looks = share;
    std::fill_n(square, count, -1);
    for (size_t first : FIRST) {
        looks += share;
        for (size_t i = first; i < count && looks; i += STEP) {
            cancel_point();
            const double found = tree.distance2(points[i], &near, &looks);
            if (looks || i == 0) /* else there may be a nearer one */
                square[i] = found;
        }
        if (!looks)
            return;
    }
}

template <class Shapes>
static Deviation deviation(const Vector<Vec3d> &points, const Shapes &shapes, double diagonal,
                           Task &task, double from, double to)
{
    NearestTree<Shapes> tree(shapes, task, from);
    Vector<double> square(points.size());
    task.parallel((points.size() + CHUNK - 1) / CHUNK, [&](size_t chunk) {
        const size_t first = chunk * CHUNK, count = std::min(CHUNK, points.size() - first);
        seek(tree, &points[first], &square[first], count);
    }, from, to);
    Deviation result;
    double sum = 0, most = 0, sought = 0;
    for (double s : square) {
        if (s < 0)
            continue;
        sum += s;
        most = std::max(most, s);
        ++sought;
    }
    if (sought)
        result.rms = std::sqrt(sum / sought) / diagonal;
    result.max = std::sqrt(most) / diagonal;
    return result;
}

SurfaceError surface_error(const Assets &assets, const Mesh &mesh,
                           const Vector<uint8_t> &junk, Task &task)
{
    const double diagonal = extent_of(mesh).diagonal;
    gtx_info info;
    gtx_get_info(assets[0], &info);
    const MeshTriangles source = {mesh, Vec3d(info.anchor[0], info.anchor[1], info.anchor[2])};
    const Cells cells(assets);
    SurfaceError error;
    error.forward = deviation(sample_mesh(source, junk), cells, diagonal, task, 0, 0.5);
    error.reverse = deviation(sample_cells(cells), source, diagonal, task, 0.5, 1);
    return error;
}

} // namespace gtx
