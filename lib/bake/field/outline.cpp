/* Where the true surface ends: outline edges, distances to them, and the trim map. */
#include "bake/field/chart_field.hpp"

#include <algorithm>

namespace gtx::baking {

constexpr uint32_t NO_EDGE = 0xffffffffu;
/* Source surface beyond a chart's border counts as true up to this many texels from it. Truck:
 * RMS +8 % at half; Spot's control mesh: RMS +17 %, 5 % more texels at double. */
constexpr double OVERLAP = 1;
/* Where the model itself ends, up to this many texels beyond its border: nobody else's height field
 * starts there. Bunny's holes: 0.4 % RMS either way. */
constexpr double BORDER_SHOWN = 0.1;
/* Texels from a cut: a strip of surface as narrow as that is the next piece's to show, where texels
 * are fine. At 0.15 Spot's control mesh has a hole at half size. */
constexpr double STRIP = 0.06;
/* A limit on time: texels of all edges' boxes for a texel of the chart, and in all beyond that. An
 * engine of 82 nodes has up to 45 in a chart, a chair 24. */
constexpr double SPLATS = 64, SPLATS_OF_ALL = 1 << 28;

double nearest_parameter(const OutlineEdge &edge, double u, double v)
{
    double ex = edge.to.x - edge.from.x, ey = edge.to.y - edge.from.y;
    double square = ex * ex + ey * ey;
    if (square <= 0)
        return 0;
    return std::clamp(((u - edge.from.x) * ex + (v - edge.from.y) * ey) / square, 0., 1.);
}

/* An edge as distances to it are computed from. */
struct Line {
    double u, v, along_u, along_v, inverse; /* of its square; 0 without a length */

    explicit Line(const OutlineEdge &edge)
        : u(edge.from.x), v(edge.from.y), along_u(edge.to.x - u), along_v(edge.to.y - v)
    {
        const double square = along_u * along_u + along_v * along_v;
        inverse = square > 0 ? 1 / square : 0;
    }
    double distance_square(double to_u, double to_v) const
    {
        const double along = (to_u - u) * along_u + (to_v - v) * along_v;
        const double at = std::clamp(along * inverse, 0., 1.);
        const double off_u = u + at * along_u - to_u, off_v = v + at * along_v - to_v;
        return off_u * off_u + off_v * off_v;
    }
};

/* Distances while they are being found, squared. */
struct DistanceField {
    const Grid &grid;
    Outline &outline;
    Budget budget;
    Vector<Line> lines;

    void offer(int i, int j, uint32_t edge)
    {
        size_t texel = size_t(j) * grid.w + i;
        if (outline.nearest[texel] == edge)
            return;
        float square = float(lines[edge].distance_square(i, j));
        if (square < outline.distance[texel]) {
            outline.distance[texel] = square;
            outline.nearest[texel] = edge;
        }
    }

    /* The texels along the edge alone. */
    void splat_line(uint32_t edge)
    {
        const Vec3d &p = outline.edges[edge].from, along = outline.edges[edge].to - p;
        const int steps = 1 + int(std::min(length(along.x, along.y), double(grid.w + grid.h)));
        for (int s = 0; s <= steps; ++s) {
            const double u = p.x + along.x * s / steps, v = p.y + along.y * s / steps;
            offer(int(std::clamp(u + 0.5, 0., grid.w - 1.)),
                  int(std::clamp(v + 0.5, 0., grid.h - 1.)), edge);
        }
    }

    /* Every texel within two of the edge; the nearest on the grid's side where that is none, as for
     * the outline of a larger chart around the part that is baked. */
    void splat(uint32_t edge)
    {
        constexpr double REACH = 2; /* hardly a byte at half or double: sweeps find the rest */
        const Vec3d &p = outline.edges[edge].from, &q = outline.edges[edge].to;
        auto low = [](double a, double b, int size) {
            return int(std::ceil(std::clamp(std::min(a, b) - REACH, 0., size - 1.)));
        };
        auto high = [](double a, double b, int size) {
            return int(std::floor(std::clamp(std::max(a, b) + REACH, 0., size - 1.)));
        };
        int x0 = low(p.x, q.x, grid.w), x1 = high(p.x, q.x, grid.w);
        int y0 = low(p.y, q.y, grid.h), y1 = high(p.y, q.y, grid.h);
        budget.spend((x1 - x0 + 1.) * (y1 - y0 + 1.));
        if (budget.spent()) {
            splat_line(edge);
            return;
        }
        for (int j = y0; j <= y1; ++j)
            for (int i = x0; i <= x1; ++i)
                offer(i, j, edge);
    }

    /* Passes nearest edges on across the grid (Danielsson 1980, with edges in place of points).
     * Most neighbours have the same one. */
    void sweep(bool down)
    {
        const int w = grid.w;
        const Vector<uint32_t> none(size_t(w), NO_EDGE);
        for (int row = 0; row < grid.h; ++row) {
            const int j = down ? row : grid.h - 1 - row;
            uint32_t *here = &outline.nearest[size_t(j) * w];
            float *squares = &outline.distance[size_t(j) * w];
            const uint32_t *back = !row ? none.data() : down ? here - w : here + w;
            cancel_point();
            uint32_t beside = NO_EDGE, edges[3] = {NO_EDGE, NO_EDGE, back[0]};
            auto take = [&](int i, uint32_t edge) {
                if (edge == beside || edge == NO_EDGE)
                    return;
                const float square = float(lines[edge].distance_square(i, j));
                if (square < squares[i]) {
                    squares[i] = square;
                    beside = edge;
                }
            };
            for (int i = 0; i < w; ++i) {
                const uint32_t before = beside;
                edges[0] = edges[1];
                edges[1] = edges[2];
                edges[2] = i + 1 < w ? back[i + 1] : NO_EDGE;
                beside = here[i];
                take(i, before);
                for (size_t k = 0; k < 3; ++k)
                    if (edges[k] != before)
                        take(i, edges[k]);
                here[i] = beside;
            }
            for (int i = w - 1; i-- > 0;) {
                const uint32_t before = here[i + 1];
                beside = here[i];
                take(i, before);
                here[i] = beside;
            }
        }
    }
};

void measure_distances(const Grid &grid, size_t charts, Outline &outline)
{
    outline.nearest.assign(grid.texels(), NO_EDGE);
    outline.distance.assign(grid.texels(), INFINITY);
    const Budget budget(SPLATS * double(grid.texels()) + SPLATS_OF_ALL / double(charts));
    DistanceField field{grid, outline, budget, {outline.edges.begin(), outline.edges.end()}};
    for (size_t e = 0; e < outline.edges.size(); ++e) {
        cancel_point();
        field.splat(uint32_t(e));
    }
    field.sweep(true);
    field.sweep(false);
    for (float &d : outline.distance)
        d = std::sqrt(d);
}

Outline find_outline(const Neighbours &neighbours, const FlatChart &chart, size_t count)
{
    Outline outline;
    auto collect = [&](bool inner) {
        for (size_t t = 0; t < count; ++t) {
            const FlatTriangle &triangle = chart.triangles[t];
            for (int k = 0; triangle.front && k < 3; ++k)
                if (inner || chart.mate[t][k] >= count) /* NO_TRIANGLE is the largest of all */
                    outline.edges.push_back({triangle.corner[k], triangle.corner[(k + 1) % 3],
                                             uint32_t(t), k,
                                             neighbours[triangle.source][k] == NO_TRIANGLE});
        }
    };
    collect(false);
    if (outline.edges.empty()) /* a closed shred seen edge-on has no outline but its edges */
        collect(true);
    measure_distances(chart.grid, chart.of, outline);
    return outline;
}

/* Lowers the distances around a point of the core that bilinear lookup would cut away: the tip of a
 * corner, or a sliver that passes between texel centres. */
static void show_point(const Grid &grid, double u, double v, Vector<float> &trim)
{
    constexpr double AIM = GTX_TRIM_SHOWN - 1.0 / GTX_TRIM_TEXEL; /* a code below the limit */
    int i = std::clamp(int(u), 0, grid.w - 2), j = std::clamp(int(v), 0, grid.h - 2);
    float *a = &trim[size_t(j) * grid.w + i], *b = a + grid.w;
    double x = u - i, y = v - j;
    double d = (a[0] * (1 - x) + a[1] * x) * (1 - y) + (b[0] * (1 - x) + b[1] * x) * y;
    if (d <= AIM)
        return;
    for (float *corner : {a, a + 1, b, b + 1})
        *corner -= float(d - AIM);
}

Vector<float> trim_distances(const FlatChart &chart, const Cover &core, const Cover &all,
                             const Outline &core_outline, const Outline &all_outline, bool sharp)
{
    const Grid &grid = chart.grid;
    Vector<float> trim(grid.texels());
    for (size_t i = 0, column = 0, row = 0; i < trim.size(); ++i) {
        bool in_core = core.triangle[i] != NO_TRIANGLE && core.triangle[i] < chart.core;
        bool in_all = all.triangle[i] != NO_TRIANGLE;
        float to_core = in_core ? -core_outline.distance[i] : core_outline.distance[i];
        float to_all = in_all ? -all_outline.distance[i] : all_outline.distance[i];
        if (all_outline.edges[all_outline.nearest[i]].border)
            to_all += float(GTX_TRIM_SHOWN - BORDER_SHOWN);
        double cut = grid.outside(double(column), double(row));
        trim[i] = std::max({to_all, to_core - float(OVERLAP), float(cut - CUT_OVERLAP)});
        if (++column == size_t(grid.w)) {
            column = 0;
            ++row;
        }
    }
    for (const OutlineEdge &edge : core_outline.edges) {
        cancel_point();
        Vec3d along = edge.to - edge.from;
        int steps = 1 + whole_length(2, along.x, along.y);
        for (int s = 0; s < steps; ++s) {
            Vec3d p = edge.from + along * (double(s) / steps);
            if (grid.outside(p.x, p.y) <= (sharp ? -STRIP : 0))
                show_point(grid, p.x, p.y, trim);
        }
    }
    return trim;
}

} // namespace gtx::baking
