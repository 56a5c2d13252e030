/* The periodic solve: phases at the vertices, and the coordinates that they unwrap to.
 *
 * A vertex has two phases, as unit complex numbers p and q: its u and v times a full turn, in the
 * directions of its first corner. To directions turned by quarters (p, q) is (q, p'), (p', q'),
 * (q', p), where ' conjugates. An edge wants the phases at its ends to differ by its length along
 * the directions; that is linear in their real and imaginary parts (Ray et al. 2006). */
#include "chart/pgp/pgp.hpp"
#include "base/exact.h"

#include <Eigen/Dense>
#include <Eigen/IterativeLinearSolvers>

namespace gtx {

namespace {

/* The least squares alone are minimal where all phases vanish. Each solve is held to the last
 * solution at unit length by ANCHOR, an edge's weight being 1; soon the phases stay at unit
 * length. A rough solve will do, since the next goes on from it. The solution is a local one:
 * whatever changes by half, texels change by 10 to 30 % either way (Spot); more iterations
 * change nothing. */
constexpr double ANCHOR = 0.1;
constexpr int PASSES = 10, MAX_ITERATIONS = 300;
constexpr double TOLERANCE = 1e-2;
/* Lines that pass a vertex closer than this share of a cell go through it: no slivers there. Half:
 * RMS +3 %; double: texels +13 % (bunny). */
constexpr double SNAP = 0.002;

using Matrix4 = Eigen::Matrix4d;
using Eigen::VectorXd;                                             /* re p, im p, re q, im q, ... */
using Energy = Eigen::SparseMatrix<double, Eigen::RowMajor>;     /* all of it: fastest to apply */

struct Edge {
    uint32_t half_edge, vertex[2]; /* of its start and its end */
    Uv step;                       /* in cells, along the half-edge, in its triangle's directions */
};

class Solve {
public:
    Solve(const HalfEdges &edges, const CrossField &field, const Vector<double> &scale,
          double cell);
    void run();
    Periodic unwrap() const;

private:
    void find_turns();
    Matrix4 carry(const Edge &edge) const;
    Energy energy() const;
    void start();
    void start_at(uint32_t vertex, Vector<uint8_t> &known, Vector<uint32_t> &queue);
    void to_unit_length();
    Uv phase(uint32_t corner) const;
    Uv whole(uint32_t half_edge) const;

    const HalfEdges &edges_;
    const CrossField &field_;
    Vector<uint8_t> turn_;        /* a corner: quarters from its vertex' directions to its own */
    Vector<Edge> list_;
    Vector<uint32_t> place_;      /* a half-edge: its edge in the list */
    VectorXd x_;
};

/* What phases are to directions turned by quarters. */
Matrix4 turn_matrix(unsigned quarters)
{
    Matrix4 once, out = Matrix4::Identity();
    once << 0, 0, 1, 0, /**/ 0, 0, 0, 1, /**/ 1, 0, 0, 0, /**/ 0, -1, 0, 0;
    for (unsigned i = 0; i < quarters; ++i)
        out = once * out;
    return out;
}

Matrix4 step_matrix(const Uv &step)
{
    Matrix4 out = Matrix4::Zero();
    for (int i = 0; i < 2; ++i) {
        double c = gtx_cos(2 * M_PI * step[size_t(i)]), s = gtx_sin(2 * M_PI * step[size_t(i)]);
        out.block<2, 2>(2 * i, 2 * i) << c, -s, s, c;
    }
    return out;
}

/* Both triangles' directions, half way between, say how an edge lies in the field: seen from either
 * side its step is the same, and so is how many whole cells are in it. */
Solve::Solve(const HalfEdges &edges, const CrossField &field, const Vector<double> &scale,
             double cell)
    : edges_(edges), field_(field), place_(edges.opposite.size())
{
    find_turns();
    for (uint32_t h = 0; h < edges.opposite.size(); ++h) {
        uint32_t o = edges.opposite[h], next = next_edge(h);
        if (o != NO_EDGE && o < h) {
            place_[h] = place_[o];
            continue;
        }
        double angle = field.angle[h / 3] + field.bend[h] / 2 - edges.direction[h];
        uint32_t i = edges.vertex[h], j = edges.vertex[next];
        double size = 2 * edges.length[h] / (cell * (scale[i] + scale[j]));
        place_[h] = uint32_t(list_.size());
        list_.push_back({h, {i, j}, {size * gtx_cos(angle), -size * gtx_sin(angle)}});
    }
}

void Solve::find_turns()
{
    turn_.assign(edges_.vertex.size(), 0);
    for (uint32_t first : edges_.first)
        for (uint32_t c = first;;) {
            uint32_t next = edges_.left_of(c);
            if (next == NO_EDGE || next == first)
                break;
            turn_[next] = uint8_t((turn_[c] + field_.turn[previous_edge(c)]) & 3);
            c = next;
        }
}

/* Makes the phases at the edge's end from those at its start. */
Matrix4 Solve::carry(const Edge &edge) const
{
    return turn_matrix(turn_[next_edge(edge.half_edge)]).transpose() * step_matrix(edge.step) *
           turn_matrix(turn_[edge.half_edge]);
}

/* The sum over the edges of |x_end - carry x_start|^2, and ANCHOR |x|^2. */
Energy Solve::energy() const
{
    Vector<int> degree(edges_.first.size(), 0);
    for (const Edge &edge : list_)
        for (uint32_t v : edge.vertex)
            ++degree[v];
    Eigen::VectorXi sizes(x_.size());
    for (int r = 0; r < sizes.size(); ++r)
        sizes[r] = 1 + 2 * degree[size_t(r / 4)]; /* a carry has two entries a row */
    Energy out(x_.size(), x_.size());
    out.reserve(sizes);
    for (int r = 0; r < sizes.size(); ++r)
        out.insert(r, r) = ANCHOR + degree[size_t(r / 4)];
    for (const Edge &edge : list_) {
        int i = 4 * int(edge.vertex[0]), j = 4 * int(edge.vertex[1]);
        Matrix4 block = carry(edge);
        for (int r = 0; r < 4 && i != j; ++r)
            for (int c = 0; c < 4; ++c)
                if (double entry = block(r, c); entry != 0) {
                    out.coeffRef(j + r, i + c) -= entry;
                    out.coeffRef(i + c, j + r) -= entry;
                }
    }
    out.makeCompressed();
    return out;
}

/* Along a tree of edges from `vertex`, breadth first. */
void Solve::start_at(uint32_t vertex, Vector<uint8_t> &known, Vector<uint32_t> &queue)
{
    auto reach = [&](uint32_t from, uint32_t half_edge) {
        const Edge &edge = list_[place_[half_edge]];
        bool back = edge.vertex[1] == from;
        uint32_t to = edge.vertex[back ? 0 : 1];
        if (known[to])
            return;
        known[to] = 1;
        queue.push_back(to);
        Matrix4 matrix = carry(edge);
        if (back)
            matrix.transposeInPlace();
        x_.segment<4>(4 * int(to)) = matrix * x_.segment<4>(4 * int(from));
    };
    x_.segment<4>(4 * int(vertex)) << 1, 0, 1, 0;
    known[vertex] = 1;
    queue.assign(1, vertex);
    for (size_t q = 0; q < queue.size(); ++q) {
        uint32_t from = queue[q], c = edges_.first[from];
        do {
            reach(from, c);
            reach(from, previous_edge(c)); /* new where the fan ends */
            c = edges_.left_of(c);
        } while (c != NO_EDGE && c != edges_.first[from]);
    }
}

void Solve::start()
{
    x_ = VectorXd::Zero(4 * int(edges_.first.size()));
    Vector<uint8_t> known(edges_.first.size(), 0);
    Vector<uint32_t> queue;
    for (uint32_t v = 0; v < known.size(); ++v)
        if (!known[v])
            start_at(v, known, queue);
}

void Solve::to_unit_length()
{
    for (int i = 0; i < x_.size(); i += 2) {
        double size = length(x_[i], x_[i + 1]);
        if (!std::isfinite(size))
            throw Error(GTX_ERROR_INPUT, "the surface cannot be parameterized");
        if (size > 0)
            x_.segment<2>(i) /= size;
        else
            x_[i] = 1;
    }
}

/* The usual preconditioner, asked once each step. */
struct Cancellable : Eigen::DiagonalPreconditioner<double> {
    using Eigen::DiagonalPreconditioner<double>::DiagonalPreconditioner;

    template <class Right> auto solve(const Eigen::MatrixBase<Right> &right) const
    {
        cancel_point(size_t(right.size()));
        return Eigen::DiagonalPreconditioner<double>::solve(right);
    }
};

void Solve::run()
{
    start();
    Energy matrix = energy();
    Eigen::ConjugateGradient<Energy, Eigen::Lower | Eigen::Upper, Cancellable> solver(matrix);
    solver.setTolerance(TOLERANCE);
    solver.setMaxIterations(MAX_ITERATIONS);
    for (int pass = 0; pass < PASSES; ++pass) {
        cancel_point();
        VectorXd side = ANCHOR * x_;
        x_ = solver.solveWithGuess(side, x_).eval();
        to_unit_length();
    }
}

double cells_of(double im, double re)
{
    double cells = gtx_atan2(im, re) / (2 * M_PI);
    return std::abs(cells) < SNAP ? 0 : on_grid(cells);
}

/* As the corner's triangle sees it, in cells. */
Uv Solve::phase(uint32_t corner) const
{
    int i = 4 * int(edges_.vertex[corner]);
    return turned({cells_of(x_[i + 1], x_[i]), cells_of(x_[i + 3], x_[i + 2])}, turn_[corner]);
}

/* How many cells more than its phases tell lie along an edge; the same from both sides. */
Uv Solve::whole(uint32_t h) const
{
    const Edge &edge = list_[place_[h]];
    Uv here = phase(edge.half_edge), there = phase(next_edge(edge.half_edge)), out;
    for (size_t i = 0; i < 2; ++i)
        out[i] = std::round(here[i] + edge.step[i] - there[i]);
    if (edge.half_edge == h)
        return out;
    out = turned(out, field_.turn[edge.half_edge]);
    return {-out[0], -out[1]};
}

/* Around a regular triangle the whole cells add up to none; at a vertex where the field is singular
 * its directions do not come back to themselves. */
Periodic Solve::unwrap() const
{
    Periodic out;
    out.uv.resize(edges_.vertex.size());
    out.singular.assign(edges_.vertex.size() / 3, 0);
    for (uint32_t t = 0; t < out.singular.size(); ++t) {
        Uv sum = {};
        bool singular = false;
        for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
            Uv here = phase(h), more = whole(h);
            for (size_t i = 0; i < 2; ++i) {
                out.uv[h][i] = here[i] + sum[i];
                sum[i] += more[i];
            }
            singular = singular || field_.index[edges_.vertex[h]] != 0;
        }
        out.singular[t] = singular || sum[0] != 0 || sum[1] != 0;
    }
    return out;
}

} // namespace

Uv turned(const Uv &uv, unsigned quarters)
{
    switch (quarters & 3) {
    case 1: return {uv[1], -uv[0]};
    case 2: return {-uv[0], -uv[1]};
    case 3: return {-uv[1], uv[0]};
    default: return uv;
    }
}

Periodic parameterize(const HalfEdges &edges, const CrossField &field,
                      const Vector<double> &scale, double cell)
{
    Solve solve(edges, field, scale, cell);
    solve.run();
    return solve.unwrap();
}

} // namespace gtx
