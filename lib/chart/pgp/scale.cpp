/* How long cells are: as the directions want it, and shorter where the surface is curved. */
#include "chart/pgp/pgp.hpp"
#include "base/exact.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <numeric>

namespace gtx {

namespace {

/* For the curl, cells are at most as much longer or shorter than the mean. Half: texels -8 %;
 * double: RMS +3 % (Spot, adaptive, as are the next). */
constexpr double MAX_SCALE = 4;
/* And for the curvature, at most as much again, against where it is the median. Half: bytes +3 %;
 * double: a few bytes. */
constexpr double MAX_ADAPTED = 2;
/* Curvature, and what it asks for, are smoothed over a radius of as many cells. Half: texels
 * +7 %, RMS -15 %; double: RMS +3 %. */
constexpr double REACH = 0.7;
/* A guard: what bends less than this, radians along a cell, is as good as flat. */
constexpr double MIN_BEND = 0.1;
/* A guard: keeps the mean of ln s at 0, where nothing else does. */
constexpr double MIN_DIAGONAL = 1e-8;

/* (L + diagonal) x = side, for Laplace's equation with cotangent weights L. */
using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

void factorize(const HalfEdges &edges, Eigen::VectorXd diagonal, Solver &solver)
{
    Vector<Eigen::Triplet<double>> entries;      /* the lower triangle */
    for (uint32_t h = 0; h < edges.opposite.size(); ++h) {
        uint32_t o = edges.opposite[h];
        int i = int(edges.vertex[h]), j = int(edges.vertex[next_edge(h)]);
        if (i == j || (o != NO_EDGE && o < h))
            continue;
        double weight = edges.weight(h);
        entries.emplace_back(std::max(i, j), std::min(i, j), -weight);
        diagonal[i] += weight;
        diagonal[j] += weight;
    }
    for (int i = 0; i < diagonal.size(); ++i)
        entries.emplace_back(i, i, diagonal[i]);
    Eigen::SparseMatrix<double> matrix(diagonal.size(), diagonal.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver.compute(matrix);
}

/* With directions at an angle a and cells of length s, the gradients of u and v have no curl where
 * grad ln s is grad a turned by a quarter. Across an edge a differs by the field's bend; the least
 * squares over all edges are Laplace's equation with this right side. */
Eigen::VectorXd curl_side(const HalfEdges &edges, const CrossField &field)
{
    Eigen::VectorXd side = Eigen::VectorXd::Zero(int(edges.first.size()));
    for (uint32_t h = 0; h < edges.opposite.size(); ++h) {
        uint32_t o = edges.opposite[h];
        if (o != NO_EDGE && o < h)
            continue;
        side[int(edges.vertex[h])] += field.bend[h];
        side[int(edges.vertex[next_edge(h)])] -= field.bend[h];
    }
    return side;
}

/* A third of the triangles around each vertex. */
Eigen::VectorXd vertex_areas(const Surface &surface, const HalfEdges &edges)
{
    Eigen::VectorXd out = Eigen::VectorXd::Zero(int(edges.first.size()));
    for (uint32_t c = 0; c < edges.vertex.size(); ++c)
        out[int(edges.vertex[c])] += length(surface.mesh.area_vector(c / 3)) / 6;
    return out;
}

/* Tensors of curvature, each by its norm, where every one is the mean of those about it: bumps and
 * noise much smaller than a cell cancel. `screen` is what a vertex' area counts for. */
Eigen::VectorXd smooth_curvatures(const Surface &surface, const HalfEdges &edges,
                                  const Solver &solver, double screen)
{
    Vector<Tensor> tensors = vertex_curvatures(surface, edges);
    Eigen::VectorXd out = Eigen::VectorXd::Zero(int(tensors.size()));
    for (size_t entry = 0; entry < 9; ++entry) {
        Eigen::VectorXd side(out.size());
        for (int i = 0; i < out.size(); ++i) /* an edge is in the tensors of both its ends */
            side[i] = screen / 2 * tensors[size_t(i)][entry];
        out += solver.solve(side).cwiseAbs2();
    }
    return out.cwiseSqrt();
}

/* The value below which half of the weight is. */
double weighted_median(const Eigen::VectorXd &values, const Eigen::VectorXd &weights)
{
    Vector<int> order(size_t(values.size()));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        return std::pair(values[a], a) < std::pair(values[b], b);
    });
    double half = weights.sum() / 2;
    for (int i : order)
        if ((half -= weights[i]) <= 0)
            return values[i];
    return values[order.back()];
}

/* ln s that gives every cell the same sag, curvature times s^2, as far as the bounds let it. */
Eigen::VectorXd wanted_logarithm(const Eigen::VectorXd &curvatures, const Eigen::VectorXd &areas,
                                 double cell)
{
    Eigen::VectorXd bend = curvatures * cell;
    for (double &b : bend)
        b = b > MIN_BEND ? b : MIN_BEND; /* also what is not a number */
    const double median = weighted_median(bend, areas), most = gtx_log(MAX_ADAPTED);
    for (double &b : bend)
        b = std::clamp(-gtx_log(b / median) / 2, -most, most);
    return bend;
}

} // namespace

Vector<double> make_scale(const HalfEdges &edges, const CrossField &field)
{
    const Eigen::VectorXd side = curl_side(edges, field);
    Vector<double> out(edges.first.size(), 1);
    Solver solver;
    factorize(edges, Eigen::VectorXd::Constant(side.size(), MIN_DIAGONAL), solver);
    if (solver.info() != Eigen::Success)
        return out;
    Eigen::VectorXd logarithm = solver.solve(side);
    const double most = gtx_log(MAX_SCALE);
    for (int i = 0; i < logarithm.size(); ++i)
        if (std::isfinite(logarithm[i]))
            out[size_t(i)] = gtx_exp(std::clamp(logarithm[i], -most, most));
    return out;
}

/* Screened equations smooth. The curl's own is not screened: where the curvature asks for nothing,
 * cells stay as long as the field wants them. */
void adapt_scale(const Surface &surface, const HalfEdges &edges, double cell,
                 Vector<double> &scale)
{
    const Eigen::VectorXd areas = vertex_areas(surface, edges);
    const double screen = 1 / (REACH * REACH * cell * cell);
    Solver solver;
    factorize(edges, (screen * areas).array() + MIN_DIAGONAL, solver);
    if (solver.info() != Eigen::Success)
        return;
    Eigen::VectorXd wish = wanted_logarithm(smooth_curvatures(surface, edges, solver, screen),
                                            areas, cell);
    Eigen::VectorXd smooth = solver.solve(screen * areas.cwiseProduct(wish));
    for (size_t i = 0; i < scale.size(); ++i)
        if (std::isfinite(smooth[int(i)]))
            scale[i] *= gtx_exp(smooth[int(i)]);
}

} // namespace gtx
