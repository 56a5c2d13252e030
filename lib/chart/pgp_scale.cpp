/* The curl correction: cells grow and shrink so that they can follow the field. */
#include "chart/pgp.hpp"

#include <Eigen/SparseCholesky>

namespace gtx {

namespace {

/* Cells are at most as much longer or shorter than the mean. */
constexpr double MOST_SCALE = 4;

} // namespace

/* With directions at an angle a and cells of length s, the gradients of u and v have no curl where
 * grad ln s is grad a turned by a quarter. Across an edge a differs by the field's bend; the least
 * squares over all edges are Laplace's equation with cotangent weights. */
std::vector<double> make_scale(const HalfEdges &edges, const CrossField &field)
{
    int count = int(edges.first.size());
    Eigen::VectorXd side = Eigen::VectorXd::Zero(count);
    Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(count, 1e-8); /* keeps the mean at 0 */
    std::vector<Eigen::Triplet<double>> entries;                       /* the lower triangle */
    for (uint32_t h = 0; h < edges.opposite.size(); ++h) {
        uint32_t o = edges.opposite[h];
        int i = int(edges.vertex[h]), j = int(edges.vertex[next_edge(h)]);
        if (i == j || (o != NO_EDGE && o < h))
            continue;
        double weight = edges.weight(h);
        entries.emplace_back(std::max(i, j), std::min(i, j), -weight);
        diagonal[i] += weight;
        diagonal[j] += weight;
        side[i] += field.bend[h];
        side[j] -= field.bend[h];
    }
    for (int i = 0; i < count; ++i)
        entries.emplace_back(i, i, diagonal[i]);
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);

    std::vector<double> out(edges.first.size(), 1);
    if (solver.info() != Eigen::Success)
        return out;
    Eigen::VectorXd logarithm = solver.solve(side);
    const double most = std::log(MOST_SCALE);
    for (int i = 0; i < count; ++i)
        if (std::isfinite(logarithm[i]))
            out[size_t(i)] = std::exp(std::clamp(logarithm[i], -most, most));
    return out;
}

} // namespace gtx
