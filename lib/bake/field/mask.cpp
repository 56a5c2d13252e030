/* Material that is cut away: the outline of a mask becomes part of the trim. */
#include "bake/field/chart_field.hpp"

#include <algorithm>

namespace gtx::baking {

/* Samples of the mask along a texel: its outline is found between them. No measured model
 * has a mask. */
constexpr int FINER = 2;
/* Samples outside the surface where what lies at its border still counts. */
constexpr float BEYOND = 2 * FINER;

static bool has_mask(const Mesh &mesh, const FlatChart &chart)
{
    const Appearance &a = mesh.appearance;
    return !a.material.empty() &&
           std::any_of(chart.triangles.begin(), chart.triangles.end(), [&](const FlatTriangle &t) {
               return a.materials[a.material[t.source]].alpha_cutoff > 0;
           });
}

/* The chart in a finer grid, where sample (FINER i, FINER j) is texel (i, j). */
static FlatChart refine(const FlatChart &chart)
{
    FlatChart fine = chart;
    fine.grid.w = (chart.grid.w - 1) * FINER + 1;
    fine.grid.h = (chart.grid.h - 1) * FINER + 1;
    for (int axis = 0; axis < 2; ++axis) {
        fine.grid.pitch[axis] /= FINER;
        fine.grid.corner[axis] += (chart.grid.pitch[axis] - fine.grid.pitch[axis]) / 2;
    }
    for (FlatTriangle &t : fine.triangles) {
        for (Vec3d &p : t.corner) {
            p.x *= FINER;
            p.y *= FINER;
        }
    }
    return fine;
}

/* What sample_surface calls `cut`, at every sample of the grid; nothing where the core is nowhere
 * there: a chart does not stand for its overlap alone. */
static Vector<float> sample_cut(const Mesh &mesh, const Neighbours &neighbours,
                                const FlatChart &fine)
{
    Cover cover = raster_core(fine);
    Outline core_outline = find_outline(neighbours, fine, fine.core);
    Paths paths(mesh, neighbours, fine);
    raster_overlap(fine, core_outline, paths, cover);
    Outline outline = find_outline(neighbours, fine, fine.triangles.size());

    const double side = std::sqrt(fine.grid.pitch[0] * fine.grid.pitch[1]);
    Vector<float> cut(fine.grid.texels(), 1);
    bool core_is_there = false;
    for (size_t i = 0; i < cut.size(); ++i) {
        if (cover.triangle[i] == NO_TRIANGLE && outline.distance[i] > BEYOND)
            continue;
        SurfacePoint at = surface_point(fine, outline, cover, i);
        cut[i] = sample_surface(mesh, fine.triangles[at.triangle].source, at.weight, side).cut;
        core_is_there |= at.triangle < fine.core && !(cut[i] < 0);
    }
    if (!core_is_there)
        std::fill(cut.begin(), cut.end(), -1.f);
    return cut;
}

/* The zero contour in the square at sample (x, y), in texel space (marching squares). */
static void contour_square(const Vector<float> &cut, int w, int x, int y,
                           Vector<OutlineEdge> &edges)
{
    static const int DX[] = {0, 1, 1, 0}, DY[] = {0, 0, 1, 1};
    float value[4], sum = 0;
    for (int k = 0; k < 4; ++k)
        sum += value[k] = cut[size_t(y + DY[k]) * w + x + DX[k]];
    Vec3d crossing[4];
    int count = 0;
    for (int k = 0; k < 4; ++k) {
        int n = (k + 1) % 4;
        if ((value[k] < 0) == (value[n] < 0))
            continue;
        double at = value[k] / (double(value[k]) - value[n]);
        Vec3d from(x + DX[k], y + DY[k], 0), to(x + DX[n], y + DY[n], 0);
        crossing[count++] = (from + (to - from) * at) / FINER;
    }
    /* Of four crossings, two belong together beside a corner that the middle is not joined with. */
    int first = count == 4 && (value[0] < 0) != (sum < 0) ? 1 : 0;
    for (int k = 0; k < count; k += 2)
        edges.push_back({crossing[(first + k) % 4], crossing[(first + k + 1) % 4], NO_TRIANGLE, 0,
                         true});
}

void trim_mask(const Mesh &mesh, const Neighbours &neighbours, const FlatChart &chart,
               Vector<float> &trim)
{
    if (!has_mask(mesh, chart))
        return;
    const FlatChart fine = refine(chart);
    const Vector<float> cut = sample_cut(mesh, neighbours, fine);
    Outline outline;
    for (int y = 0; y + 1 < fine.grid.h; ++y)
        for (int x = 0; x + 1 < fine.grid.w; ++x)
            contour_square(cut, fine.grid.w, x, y, outline.edges);
    measure_distances(chart.grid, chart.of, outline);
    /* What is shown beyond an outline closes the seam between charts. A mask has no seam, and its
     * bars must not grow. */
    for (size_t i = 0; i < trim.size(); ++i) {
        size_t x = i % size_t(chart.grid.w), y = i / size_t(chart.grid.w);
        float distance = outline.distance[i];
        bool gone = cut[FINER * (y * size_t(fine.grid.w) + x)] < 0;
        trim[i] = std::max(trim[i], float(GTX_TRIM_SHOWN) + (gone ? distance : -distance));
    }
}

} // namespace gtx::baking
