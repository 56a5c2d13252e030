/* The field of directions: fitted to the curvature, smooth across edges, and its singularities. */
#include "chart/pgp/pgp.hpp"
#include "base/exact.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <complex>

namespace gtx {

static Eigen::Vector3d eigen(const Vec3d &v)
{
    return {v.x, v.y, v.z};
}

static Eigen::Map<const Eigen::Matrix3d> matrix(const Tensor &tensor)
{
    return Eigen::Map<const Eigen::Matrix3d>(tensor.data());
}

namespace {

using Complex = std::complex<double>;

/* As std::polar, abs and arg have them, with the same bits on every processor. */
Complex turned(double angle)
{
    return {gtx_cos(angle), gtx_sin(angle)};
}
double size_of(Complex z)
{
    return gtx_hypot(z.real(), z.imag());
}
double angle_of(Complex z)
{
    return gtx_atan2(z.imag(), z.real());
}

/* What curvature counts for, against what the neighbours' directions do. Half: texels +12 % (Spot);
 * double: RMS +14 % (bunny). */
constexpr double FIT = 0.01;
/* A guard: without any curvature something must still hold the field. Where it does, as on Spot's
 * flat parts, directions turn with it: texels -1 % at half, +14 % at double. */
constexpr double MIN_FIT = 1e-9;
/* Solves, each fitted to the last at unit length. Half: texels +21 %; double: RMS +9 % (Spot). */
constexpr int PASSES = 20;

/* Directions to keep to, four at once: cos 4a + i sin 4a for an angle a. */
struct Guide {
    Vector<Complex> value;
    Vector<double> weight;
};

/* Angles around vertices, stretched so that a full turn is one (Knoeppel et al. 2013). */
struct Polar {
    Vector<double> start;        /* a corner: of the half-edge that leaves it */
    Vector<double> stretch;      /* a vertex */
};

Polar make_polar(const HalfEdges &edges)
{
    Polar out;
    out.start.resize(edges.vertex.size());
    for (uint32_t first : edges.first) {
        double sum = 0;
        uint32_t c = first;
        do {
            out.start[c] = sum;
            sum += edges.angle(c);
            c = edges.left_of(c);
        } while (c != NO_EDGE && c != first);
        const double stretch = c != NO_EDGE && sum > 0 ? 2 * M_PI / sum : 1;
        out.stretch.push_back(stretch);
        for (c = first; c != NO_EDGE;) {
            out.start[c] *= stretch;
            c = edges.left_of(c);
            if (c == first)
                break;
        }
    }
    return out;
}

/* What an angle at a corner's vertex has to be turned by to be one in the corner's triangle: the
 * middle of the corner is the same in both. */
double into_triangle(const HalfEdges &edges, const Polar &polar, uint32_t c)
{
    double half = edges.angle(c) / 2;
    return edges.direction[c] + half - polar.start[c] - polar.stretch[edges.vertex[c]] * half;
}

/* An angle at the start of a half-edge plus this is the same direction at its end. */
double along_edge(const HalfEdges &edges, const Polar &polar, uint32_t h)
{
    uint32_t next = next_edge(h);
    return polar.start[next] + polar.stretch[edges.vertex[next]] * edges.angle(next) + M_PI -
           polar.start[h];
}

/* The principal directions in a triangle's plane: of a symmetric tensor there, (xx - yy + 2i xy)
 * turns twice as fast as they do, and they count by how much the two curvatures differ. A border
 * counts as the sharpest bend does. */
Guide curvature_guide(const Surface &surface, const HalfEdges &edges)
{
    const Mesh &mesh = surface.mesh;
    Vector<Tensor> at_vertex = vertex_curvatures(surface, edges);
    Guide out;
    double largest = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        Vec3d x = normalize(mesh.position(t, 1) - mesh.position(t, 0));
        Vec3d y = cross(normalize(mesh.area_vector(t)), x);
        Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
        for (uint32_t c = 3 * t; c < 3 * t + 3; ++c)
            tensor += matrix(at_vertex[edges.vertex[c]]);
        Eigen::Vector3d tx = tensor * eigen(x), ty = tensor * eigen(y);
        Complex twice(eigen(x).dot(tx) - eigen(y).dot(ty), 2 * eigen(x).dot(ty));
        double size = size_of(twice);
        largest = std::max(largest, size);
        out.weight.push_back(size);
        out.value.push_back(size > 0 ? twice * twice / (size * size) : Complex(1));
    }
    for (double &w : out.weight)
        w = largest > 0 ? FIT * (w / largest) * (w / largest) : 0;
    for (uint32_t h = 0; h < edges.opposite.size(); ++h)
        if (edges.opposite[h] == NO_EDGE) {
            out.value[h / 3] = turned(4 * edges.direction[h]);
            out.weight[h / 3] = FIT;
        }
    return out;
}

/* What the triangles around a vertex want there together. */
Guide gather(const HalfEdges &edges, const Polar &polar, const Guide &triangles)
{
    Guide out;
    out.value.resize(edges.first.size());
    for (uint32_t c = 0; c < edges.vertex.size(); ++c)
        out.value[edges.vertex[c]] += triangles.weight[c / 3] * triangles.value[c / 3] *
                                      turned(-4 * into_triangle(edges, polar, c));
    for (Complex &value : out.value) {
        double size = size_of(value);
        out.weight.push_back(MIN_FIT + size / 3);
        value = size > 0 ? value / size : Complex(1);
    }
    return out;
}

/* Minimises the Dirichlet energy of z over the surface, and weight |z - guide|^2, where the guide
 * becomes the last solution at unit length: without that, z fades away from what is sure. */
Vector<Complex> smooth(const HalfEdges &edges, const Polar &polar, const Guide &guide)
{
    using Eigen::VectorXcd;
    int count = int(guide.value.size());
    Eigen::VectorXd diagonal = Eigen::Map<const Eigen::VectorXd>(guide.weight.data(), count);
    Vector<Eigen::Triplet<Complex>> entries;      /* the lower triangle */
    for (uint32_t h = 0; h < edges.opposite.size(); ++h) {
        uint32_t o = edges.opposite[h];
        int i = int(edges.vertex[h]), j = int(edges.vertex[next_edge(h)]);
        if (i == j || (o != NO_EDGE && o < h))
            continue;
        double weight = edges.weight(h);
        diagonal[i] += weight;
        diagonal[j] += weight;
        Complex turn = weight * turned(4 * along_edge(edges, polar, h));
        entries.emplace_back(std::max(i, j), std::min(i, j), j > i ? -turn : -std::conj(turn));
    }
    for (int v = 0; v < count; ++v)
        entries.emplace_back(v, v, diagonal[v]);
    Eigen::SparseMatrix<Complex> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    entries = {};
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<Complex>> solver(matrix);

    Vector<Complex> out = guide.value;
    for (int pass = 0; pass < PASSES && solver.info() == Eigen::Success; ++pass) {
        cancel_point();
        VectorXcd side(count);
        for (int v = 0; v < count; ++v)
            side[v] = guide.weight[size_t(v)] * out[size_t(v)];
        /* By hand: the solver's own step would divide by complex numbers, as the C library does. */
        VectorXcd z = solver.permutationP() * side;
        solver.matrixL().solveInPlace(z);
        z.array() /= solver.vectorD().real().array();
        solver.matrixU().solveInPlace(z);
        z = (solver.permutationPinv() * z).eval();
        for (size_t v = 0; v < out.size(); ++v) {
            double size = size_of(z[int(v)]);
            if (size > 0 && std::isfinite(size))
                out[v] = z[int(v)] / size;
        }
    }
    return out;
}

/* The mean of what a triangle's corners have. */
Vector<double> angles_in_triangles(const HalfEdges &edges, const Polar &polar,
                                   const Vector<Complex> &at_vertex)
{
    Vector<double> out;
    for (uint32_t t = 0; 3 * t < edges.vertex.size(); ++t) {
        Complex sum = 0;
        for (uint32_t c = 3 * t; c < 3 * t + 3; ++c)
            sum += at_vertex[edges.vertex[c]] * turned(4 * into_triangle(edges, polar, c));
        out.push_back(angle_of(sum) / 4);
    }
    return out;
}

/* How the field turns across each edge; once an edge, so that both sides agree. */
void match(const HalfEdges &edges, CrossField &field)
{
    field.turn.assign(edges.opposite.size(), 0);
    field.bend.assign(edges.opposite.size(), 0);
    for (uint32_t h = 0; h < edges.opposite.size(); ++h) {
        uint32_t o = edges.opposite[h];
        if (o == NO_EDGE || o < h)
            continue;
        double between = field.angle[o / 3] - field.angle[h / 3] - edges.transport(h);
        int quarters = int(std::lround(between / (M_PI / 2)));
        field.turn[h] = uint8_t(quarters & 3);
        field.turn[o] = uint8_t(-quarters & 3);
        field.bend[h] = between - quarters * (M_PI / 2);
        field.bend[o] = -field.bend[h];
    }
}

/* A vertex' defect of angle and the field's turning around it together are quarter turns. */
void find_indices(const HalfEdges &edges, CrossField &field)
{
    field.index.assign(edges.first.size(), 0);
    for (size_t v = 0; v < edges.first.size(); ++v) {
        double sum = 2 * M_PI;
        uint32_t c = edges.first[v];
        do {
            sum += field.bend[previous_edge(c)] - edges.angle(c);
            c = edges.left_of(c);
        } while (c != NO_EDGE && c != edges.first[v]);
        if (c != NO_EDGE)
            field.index[v] = int(std::lround(sum / (M_PI / 2)));
    }
}

} // namespace

Vector<Tensor> vertex_curvatures(const Surface &surface, const HalfEdges &edges)
{
    const Mesh &mesh = surface.mesh;
    Vector<Tensor> out(edges.first.size(), Tensor{});
    for (uint32_t h = 0; h < edges.opposite.size(); ++h) {
        uint32_t o = edges.opposite[h];
        if (o == NO_EDGE || o < h || !(edges.length[h] > 0))
            continue;
        Vec3d e = (mesh.positions[start_of(mesh, o)] - mesh.positions[start_of(mesh, h)]) /
                  edges.length[h];
        Vec3d a = normalize(mesh.area_vector(h / 3)), b = normalize(mesh.area_vector(o / 3));
        double bend = gtx_atan2(dot(cross(a, b), e), dot(a, b)) * edges.length[h];
        Eigen::Matrix3d part = eigen(e) * eigen(e).transpose() * bend;
        for (uint32_t v : {edges.vertex[h], edges.vertex[o]})
            Eigen::Map<Eigen::Matrix3d>(out[v].data()) += part;
    }
    return out;
}

CrossField make_cross_field(const Surface &surface, const HalfEdges &edges)
{
    CrossField out;
    Polar polar = make_polar(edges);
    Guide guide = gather(edges, polar, curvature_guide(surface, edges));
    out.angle = angles_in_triangles(edges, polar, smooth(edges, polar, guide));
    match(edges, out);
    find_indices(edges, out);
    return out;
}

} // namespace gtx
