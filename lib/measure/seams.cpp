/* Gaps between the height fields of neighbouring patches along their borders. */
#include "measure/cells.hpp"
#include "measure/measure.hpp"
#include "measure/sample.hpp"
#include "measure/view.hpp"

namespace gtx {

static const size_t SEAM_POINTS = 100000, CHUNK = 1024;
static const double BORDER_TEXELS = 2;

namespace {

/* The outline of a core where it crosses a cell: a line between two of its sides. */
struct Crossing {
    uint32_t cell;
    double from[2], to[2];       /* u and v in 0..1 */
};

/* A point of an outline, relative to the anchor. */
struct SeamPoint {
    Vec3d at;
    uint32_t patch;
};

/* Shapes for NearestTree: the edges where the source ends, relative to the anchor. */
struct BorderEdges {
    Vector<std::array<Vec3d, 2>> edges;

    BorderEdges(const Mesh &mesh, const Vec3d &anchor)
    {
        Vector<std::array<uint32_t, 3>> neighbours = triangle_neighbours(mesh);
        for (size_t t = 0; t < neighbours.size(); ++t)
            for (int k = 0; k < 3; ++k)
                if (neighbours[t][k] == NO_TRIANGLE)
                    edges.push_back({mesh.position(t, k) - anchor,
                                     mesh.position(t, (k + 1) % 3) - anchor});
    }
    size_t size() const { return edges.size(); }
    size_t looks(size_t) const { return 1; }
    Box box(size_t i) const
    {
        Box box;
        box.add(edges[i][0]);
        box.add(edges[i][1]);
        return box;
    }
    double distance2(size_t i, const Vec3d &p, double) const
    {
        return triangle_distance2(p, edges[i][0], edges[i][1], edges[i][1]);
    }
};

} // namespace

/* Marching squares over the trim of a cell; the rare saddle counts as two of its four crossings. */
static Vector<Crossing> find_crossings(const Cells &cells)
{
    static const double RING[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    Vector<Crossing> out;
    for (size_t i = 0; i < cells.size(); ++i) {
        cancel_point();
        double found[4][2];
        int count = 0;
        for (int k = 0; k < 4; ++k) {
            const double *a = RING[k], *b = RING[k + 1];
            double here = cells.trim(i, a[0], a[1]), next = cells.trim(i, b[0], b[1]);
            if ((here <= 0) == (next <= 0))
                continue;
            for (int axis = 0; axis < 2; ++axis)
                found[count][axis] = a[axis] + (b[axis] - a[axis]) * here / (here - next);
            ++count;
        }
        if (count)
            out.push_back({uint32_t(i), {found[0][0], found[0][1]}, {found[1][0], found[1][1]}});
    }
    return out;
}

static Vector<SeamPoint> sample_outlines(const Cells &cells)
{
    const Vector<Crossing> crossings = find_crossings(cells);
    Vector<double> size;
    for (const Crossing &c : crossings)
        size.push_back(length(cells.point(c.cell, c.to[0], c.to[1]) -
                              cells.point(c.cell, c.from[0], c.from[1])));
    Vector<SeamPoint> points;
    if (crossings.empty())
        return points;
    Random random;
    stratify(size, SEAM_POINTS, random, [&](size_t i) {
        const Crossing &c = crossings[i];
        double at = random.next();
        points.push_back({cells.point(c.cell, c.from[0] + (c.to[0] - c.from[0]) * at,
                                      c.from[1] + (c.to[1] - c.from[1]) * at),
                          cells.patch(c.cell)});
    });
    return points;
}

SeamReport measure_seams(const Assets &assets, const Mesh &mesh, Task &task)
{
    gtx_info info;
    gtx_get_info(assets[0], &info);
    const Vec3d anchor(info.anchor[0], info.anchor[1], info.anchor[2]);
    const Cells cells(assets);
    const BorderEdges border(mesh, anchor);
    const NearestTree<Cells> fields(cells, task, 0);
    const NearestTree<BorderEdges> ends(border, task, 0);
    const Vector<SeamPoint> points = sample_outlines(cells);

    struct Gap {
        double distance = -1, steps = 0; /* negative: none is to be expected */
    };
    Vector<Gap> gaps(points.size());
    task.parallel((points.size() + CHUNK - 1) / CHUNK, [&](size_t chunk) {
        uint32_t near = NO_HIT, near_end = NO_HIT;
        for (size_t i = chunk * CHUNK; i < std::min(points.size(), (chunk + 1) * CHUNK); ++i) {
            cancel_point();
            const SeamPoint &p = points[i];
            double reach = BORDER_TEXELS * cells.texel(p.patch);
            if (ends.distance2(p.at, &near_end) <= reach * reach)
                continue;
            double square = fields.distance2(
                p.at, &near, [&](uint32_t cell) { return cells.patch(cell) != p.patch; });
            if (!std::isfinite(square)) /* one patch alone */
                continue;
            double step =
                std::max(cells.height_step(p.patch), cells.height_step(cells.patch(near)));
            gaps[i] = {std::sqrt(square), std::sqrt(square) / step};
        }
    });
    SeamReport report;
    Vector<float> steps;
    const double diagonal = extent_of(mesh).diagonal;
    for (const Gap &gap : gaps) {
        if (gap.distance < 0)
            continue;
        steps.push_back(float(gap.steps));
        report.within_two_steps += gap.steps <= 2;
        report.max_steps = std::max(report.max_steps, gap.steps);
        report.max = std::max(report.max, gap.distance / diagonal);
    }
    report.points = steps.size();
    report.p99_steps = percentile_99(steps);
    return report;
}

} // namespace gtx
