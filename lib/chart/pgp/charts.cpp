/* Charts out of a parameterization: its squares, searched for the wanted number of them. */
#include "chart/pgp/pgp.hpp"
#include "base/exact.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace gtx {

namespace {

/* A limit: entries of the matrix are counted in ints. */
constexpr size_t MAX_TRIANGLES = 30000000;
/* Charts below so many cells, of what lies about singularities and of what lines cut off, are
 * joined to a neighbour. Half: texels +11 %; double: RMS +6 % (Spot). */
constexpr double MIN_CELLS = 0.1;
/* Charts that come out of a cell's area, where the search for the cell begins. Half: RMS +3 %
 * (bunny); double: texels +13 % (Spot). */
constexpr double CHARTS_PER_CELL = 0.97;
/* Shares of the wanted number that end the search: a few too many are joined. Half and double:
 * texels +9 to +12 % (Spot). Rounds are a limit: two do for the bunny and Spot. */
constexpr double MIN_RATIO = 0.98, MAX_RATIO = 1.06, BEST_RATIO = (MIN_RATIO + MAX_RATIO) / 2;
constexpr int SEARCH_ROUNDS = 4;

class UnionFind {
public:
    explicit UnionFind(size_t count) : parent_(count)
    {
        std::iota(parent_.begin(), parent_.end(), 0u);
    }
    uint32_t find(uint32_t a)
    {
        while (parent_[a] != a)
            a = parent_[a] = parent_[parent_[a]];
        return a;
    }
    void join(uint32_t a, uint32_t b) { parent_[find(b)] = find(a); }
    /* The sets' numbers, in order of their first members. */
    Vector<uint32_t> labels(uint32_t &count)
    {
        Vector<uint32_t> number(parent_.size(), NO_TRIANGLE), out;
        count = 0;
        for (uint32_t i = 0; i < parent_.size(); ++i) {
            uint32_t root = find(i);
            if (number[root] == NO_TRIANGLE)
                number[root] = count++;
            out.push_back(number[root]);
        }
        return out;
    }

private:
    Vector<uint32_t> parent_;
};

/* Joins charts to neighbours, the smallest first. */
class Joining {
public:
    /* Sizes are of pieces, as are labels. */
    Joining(const Pieces &pieces, const Vector<double> &size,
            const Vector<uint32_t> &labels, size_t count);
    /* Those below `least`; what has no neighbour stays as it is and does not count. */
    void join_smaller(double least);
    void join_until(size_t count);
    size_t count() const { return order_.size(); }
    /* Of what `old` labels. */
    Vector<uint32_t> labels(Vector<uint32_t> old, uint32_t &count);

private:
    void join_smallest();

    Vector<double> size_;
    Vector<std::map<uint32_t, double>> borders_;      /* chart: neighbour, length of border */
    std::set<std::pair<double, uint32_t>> order_;     /* size, chart */
    UnionFind charts_;
};

Joining::Joining(const Pieces &pieces, const Vector<double> &size,
                 const Vector<uint32_t> &labels, size_t count)
    : size_(count), borders_(count), charts_(count)
{
    for (size_t i = 0; i < size.size(); ++i)
        size_[labels[i]] += size[i];
    for (const Seam &seam : pieces.seams) {
        if (seam.piece[1] == NO_PIECE)
            continue;
        uint32_t a = labels[seam.piece[0]], b = labels[seam.piece[1]];
        if (a == b)
            continue;
        borders_[a][b] += double(seam.length);
        borders_[b][a] += double(seam.length);
    }
    for (uint32_t i = 0; i < count; ++i)
        order_.insert({size_[i], i});
}

void Joining::join_smaller(double least)
{
    while (!order_.empty() && order_.begin()->first < least)
        join_smallest();
}

void Joining::join_until(size_t count)
{
    while (order_.size() > count)
        join_smallest();
}

/* To the neighbour with which it has the longest border. */
void Joining::join_smallest()
{
    uint32_t chart = order_.begin()->second, target = chart;
    order_.erase(order_.begin());
    double longest = -1;
    for (const auto &[neighbour, border] : borders_[chart])
        if (border > longest) {
            longest = border;
            target = neighbour;
        }
    if (target == chart)
        return;
    if (order_.erase({size_[target], target})) /* one that counts */
        order_.insert({size_[target] + size_[chart], target});
    size_[target] += size_[chart];
    for (const auto &[neighbour, border] : borders_[chart]) {
        borders_[neighbour].erase(chart);
        if (neighbour == target)
            continue;
        borders_[neighbour][target] += border;
        borders_[target][neighbour] += border;
    }
    charts_.join(target, chart);
}

Vector<uint32_t> Joining::labels(Vector<uint32_t> old, uint32_t &count)
{
    Vector<uint32_t> joined = charts_.labels(count);
    for (uint32_t &label : old)
        label = joined[label];
    return old;
}

/* Numbers the squares, and the pieces of what is singular, in order of their first piece. */
Vector<uint32_t> label_cells(const Pieces &pieces, uint32_t &count)
{
    UnionFind sets(pieces.triangle.size());
    for (const Seam &seam : pieces.seams)
        if (!seam.line && seam.piece[1] != NO_PIECE)
            sets.join(seam.piece[0], seam.piece[1]);
    return sets.labels(count);
}

/* A triangle's area, where a cell of mean length 1 has that of 1. */
Vector<double> cell_areas(const Surface &surface, const HalfEdges &edges,
                          const Vector<double> &scale)
{
    Vector<double> out;
    for (uint32_t t = 0; t < surface.mesh.triangle_count(); ++t) {
        double s = 0;
        for (uint32_t c = 3 * t; c < 3 * t + 3; ++c)
            s += scale[edges.vertex[c]] / 3;
        out.push_back(length(surface.mesh.area_vector(t)) / 2 / (s * s));
    }
    return out;
}

/* The same of pieces. */
Vector<double> piece_areas(const Pieces &pieces, const Vector<double> &of_triangle)
{
    Vector<double> out;
    for (size_t i = 0; i < pieces.triangle.size(); ++i) {
        double twice = 0; /* of the triangle's area, in its weights */
        const PieceCorner *first = &pieces.corners[pieces.first[i]];
        for (const PieceCorner *c = first; c + 1 < &pieces.corners[0] + pieces.first[i + 1]; ++c)
            twice +=
                double((c[0].weight[1] - first->weight[1]) * (c[1].weight[2] - first->weight[2]) -
                       (c[0].weight[2] - first->weight[2]) * (c[1].weight[1] - first->weight[1]));
        out.push_back(of_triangle[pieces.triangle[i]] * twice);
    }
    return out;
}

/* A length of cells and how many charts it made of one that is wanted. */
struct Try {
    double cell = 0, ratio = 0;
};

/* Between the nearest tries that made too few and too many, where there are both. */
double next_cell(const Try &last, const Try &few, const Try &many)
{
    if (few.cell == 0 || many.cell == 0)
        return last.cell * std::sqrt(std::clamp(last.ratio / BEST_RATIO, 0.25, 4.));
    double share = gtx_log(BEST_RATIO / few.ratio) / gtx_log(many.ratio / few.ratio);
    return few.cell * gtx_pow(many.cell / few.cell, std::clamp(share, 0.1, 0.9));
}

} // namespace

CutMesh square_cells(const Surface &surface, uint32_t &count, bool adaptive, Task &task)
{
    if (surface.mesh.triangle_count() > MAX_TRIANGLES)
        throw Error(GTX_ERROR_LIMIT, "the partition pgp takes up to 30 million triangles");
    HalfEdges edges = make_half_edges(surface);
    CrossField field = make_cross_field(surface, edges);
    Vector<double> scale = make_scale(edges, field);
    if (adaptive)
        adapt_scale(surface, edges, std::sqrt(surface.area / count), scale);
    Vector<double> size = cell_areas(surface, edges, scale);

    const uint32_t wanted = count;
    double area = std::accumulate(size.begin(), size.end(), 0.);
    if (!(area > 0) || !std::isfinite(area))
        throw Error(GTX_ERROR_INPUT, "the surface has no area to parameterize");
    double cell = std::sqrt(CHARTS_PER_CELL * area / wanted), nearest = INFINITY;
    Try few, many;
    Pieces best;
    Vector<uint32_t> label;
    for (int round = 0; round < SEARCH_ROUNDS; ++round) {
        task.advance(0.1 + 0.6 * round / SEARCH_ROUNDS);
        Pieces pieces = cut_along_lines(surface.mesh, edges, field,
                                        parameterize(edges, field, scale, cell));
        uint32_t squares;
        Vector<uint32_t> cells = label_cells(pieces, squares);
        Joining joining(pieces, piece_areas(pieces, size), cells, squares);
        joining.join_smaller(MIN_CELLS * cell * cell);
        double ratio = double(std::max<size_t>(joining.count(), 1)) / wanted;
        if (label.empty() || std::abs(gtx_log(ratio)) < nearest) {
            nearest = std::abs(gtx_log(ratio));
            joining.join_until(wanted);
            label = joining.labels(cells, count);
            best = std::move(pieces);
        }
        if (ratio >= MIN_RATIO && ratio <= MAX_RATIO)
            break;
        (ratio < BEST_RATIO ? few : many) = {cell, ratio};
        cell = next_cell({cell, ratio}, few, many);
    }
    return cut_mesh(surface.mesh, best, label);
}

} // namespace gtx
