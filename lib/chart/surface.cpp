/* Connectivity, through OpenMesh where it is no manifold; areas, raw and smoothed normals, junk. */
#include "chart/surface.hpp"

#include "mesh/edges.hpp"

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include <algorithm>
#include <numeric>

namespace gtx {

namespace {

/* Texels: larger triangles are designed, not scanned, and their normals to be trusted. Half: RMS
 * +11 % (Duck); double: texels +15 % (Spot). */
constexpr double LARGE_TRIANGLE = 32;
/* cos 84 degrees: a scan's surface does not turn so far within a triangle. Half: patches +4 %,
 * double: RMS +8 % (truck). */
constexpr float JUNK_COSINE = 0.1f;
/* Of normals. Half: 1 hole, texels +5 % (truck, Duck); double: RMS +20 % (truck). */
constexpr int SMOOTHING_PASSES = 3;
/* A guard: sizes divide. */
constexpr float SMALLEST_SIZE = 1e-30f;

using Connectivity = OpenMesh::TriConnectivity;

/* A refusal of OpenMesh is an answer here, not an event. Its stream is global: silenced once. */
void silence_openmesh()
{
    static const bool silent = (omerr().disable(), true);
    (void)silent;
}

Connectivity connect(const Mesh &mesh)
{
    silence_openmesh();
    size_t count = mesh.triangle_count();
    Connectivity out;
    out.reserve(mesh.positions.size(), count * 3 / 2 + 16, count);
    for (size_t v = 0; v < mesh.positions.size(); ++v)
        out.new_vertex();
    for (size_t t = 0; t < count; ++t) {
        OpenMesh::VertexHandle v[3];
        for (int k = 0; k < 3; ++k)
            v[k] = OpenMesh::VertexHandle(int(mesh.triangles[t][k]));
        cancel_point();
        if (out.add_face(v[0], v[1], v[2]).is_valid())
            continue;
        for (OpenMesh::VertexHandle &handle : v) /* no manifold neighbour: it stands alone */
            handle = out.new_vertex();
        out.add_face(v[0], v[1], v[2]);
    }
    return out;
}

/* Which triangles share an edge. False where the mesh is no oriented manifold, of whose triangles
 * OpenMesh would refuse some: an edge of three triangles or of two alike, a vertex of two fans. */
bool find_neighbours(const Mesh &mesh, Vector<std::array<uint32_t, 3>> &out)
{
    Vector<uint32_t> across(3 * mesh.triangle_count(), NO_EDGE); /* of each half-edge */
    bool manifold = true;
    for_each_edge(mesh, [&](const EdgeEntry *edge, size_t count) {
        if (count == 1)
            return;
        const uint32_t a = edge[0].half_edge, b = edge[1].half_edge;
        manifold = manifold && count == 2 && start_of(mesh, a) != start_of(mesh, b);
        across[a] = b;
        across[b] = a;
    });
    Vector<uint8_t> has_fan(mesh.positions.size(), 0), seen(across.size(), 0);
    for (uint32_t h = 0; manifold && h < across.size(); ++h) {
        if (seen[h])
            continue;
        cancel_point();
        uint8_t &fan = has_fan[start_of(mesh, h)];
        manifold = !fan && start_of(mesh, h) != start_of(mesh, next_edge(h));
        fan = 1;
        uint32_t at = h; /* round the vertex one way, and from an end of an open fan the other */
        for (; at != NO_EDGE && !seen[at]; at = across[previous_edge(at)])
            seen[at] = 1;
        for (at = at == NO_EDGE ? across[h] : NO_EDGE; at != NO_EDGE; at = across[at]) {
            at = next_edge(at);
            seen[at] = 1;
        }
    }
    out.resize(manifold ? mesh.triangle_count() : 0);
    for (uint32_t h = 0; h < 3 * out.size(); ++h) /* from the last edge on, as OpenMesh has them */
        out[h / 3][next_edge(h) % 3] = across[h] == NO_EDGE ? NO_TRIANGLE : across[h] / 3;
    return manifold;
}

Vector<std::array<uint32_t, 3>> neighbours_of(const Mesh &mesh, bool &manifold)
{
    Vector<std::array<uint32_t, 3>> neighbours;
    manifold = find_neighbours(mesh, neighbours);
    if (manifold)
        return neighbours;
    Connectivity connectivity = connect(mesh);
    Vector<std::array<uint32_t, 3>> out(mesh.triangle_count());
    for (size_t t = 0; t < out.size(); ++t) {
        auto edge = connectivity.halfedge_handle(OpenMesh::FaceHandle(int(t)));
        for (int k = 0; k < 3; ++k) {
            auto face = connectivity.opposite_face_handle(edge);
            out[t][k] = face.is_valid() ? uint32_t(face.idx()) : NO_TRIANGLE;
            edge = connectivity.next_halfedge_handle(edge);
        }
    }
    return out;
}

void smooth_normals(Surface &surface, float large)
{
    const Mesh &mesh = surface.mesh;
    Vector<Vec3f> at_vertex(mesh.positions.size());
    for (int pass = 0; pass < SMOOTHING_PASSES; ++pass) {
        std::fill(at_vertex.begin(), at_vertex.end(), Vec3f());
        for (size_t t = 0; t < mesh.triangle_count(); ++t)
            for (uint32_t v : mesh.triangles[t])
                at_vertex[v] += surface.facets[t].normal * surface.facets[t].size;
        for (Vec3f &normal : at_vertex)
            normal = normalize(normal);
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            if (surface.facets[t].size > large)
                continue;
            Vec3f sum;
            for (uint32_t v : mesh.triangles[t])
                sum += at_vertex[v];
            sum = normalize(sum);
            surface.facets[t].normal = sum == Vec3f() ? surface.normal[t] : sum;
        }
    }
}

double area_of(const Mesh &mesh)
{
    double area = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        area += length(mesh.area_vector(t)) / 2;
    return area;
}

void connect_whole(Surface &surface)
{
    surface.whole.triangles.resize(surface.mesh.triangle_count());
    std::iota(surface.whole.triangles.begin(), surface.whole.triangles.end(), 0u);
    surface.whole.neighbours = neighbours_of(surface.mesh, surface.manifold);
}

/* Raw normals, and facets that have these. */
void measure_facets(Surface &surface, Task &task)
{
    const Mesh &mesh = surface.mesh;
    const size_t count = mesh.triangle_count();
    Vec3d low = mesh.positions[0], high = low;
    for (const Vec3d &p : mesh.positions)
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], p[i]);
            high[i] = std::max(high[i], p[i]);
        }
    surface.diagonal = length(high - low);
    Vec3d middle = low + (high - low) * 0.5;

    constexpr size_t LEAST = 1 << 12;
    double mean = surface.area / double(count);
    surface.normal.resize(count);
    surface.facets.resize(count);
    task.in_parts(count, task.parts(count, LEAST), [&](size_t, size_t from, size_t to) {
        for (size_t t = from; t < to; ++t) {
            Vec3d vector = mesh.area_vector(t);
            Vec3d sum;
            for (int k = 0; k < 3; ++k)
                sum += mesh.position(t, k) - middle;
            Vec3f normal = Vec3f(normalize(vector)), centre = Vec3f(sum / (3 * std::sqrt(mean)));
            float size = std::max(float(length(vector) / 2 / mean), SMALLEST_SIZE);
            surface.normal[t] = normal;
            surface.facets[t] = {normal, centre, size};
        }
    });
}

void find_junk(Surface &surface, double texel)
{
    surface.junk.resize(surface.facets.size());
    for (size_t t = 0; t < surface.junk.size(); ++t)
        surface.junk[t] = surface.facets[t].size < JUNK_TEXELS * texel &&
                          dot(surface.normal[t], surface.facets[t].normal) < JUNK_COSINE;
}

} // namespace

double expected_pitch(const Mesh &mesh, size_t charts)
{
    /* Of a chart. Half: 4 holes (truck), texels +15 % (Spot); double: RMS +11 % (Duck). */
    constexpr double USED_TEXELS = 1024;
    return std::sqrt(area_of(mesh) / (USED_TEXELS * double(charts)));
}

double texels_of(const Surface &surface, const Region &region, double pitch)
{
    double size = 0, mean = surface.area / double(surface.facets.size());
    for (uint32_t t : region.triangles)
        size += double(surface.facets[t].size);
    return size * mean / (pitch * pitch);
}

Surface make_surface(const Mesh &mesh, double pitch, Task &task)
{
    Surface surface = {mesh, {}, area_of(mesh), 0, {}, {}, {}, false};
    measure_facets(surface, task);
    const double texel = pitch * pitch / (surface.area / double(surface.facets.size()));
    task.parallel(2, [&](size_t half) {
        if (half == 0) {
            connect_whole(surface);
        } else {
            smooth_normals(surface, float(LARGE_TRIANGLE * texel));
            find_junk(surface, texel);
        }
    }, 0, 0);
    return surface;
}

void for_each_region(const Vector<Region> &regions, Task &task,
                     const std::function<void(size_t)> &body, double from, double to, size_t times)
{
    Vector<uint32_t> order(regions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return regions[a].size() > regions[b].size();
    });
    task.parallel(times * order.size(), [&](size_t n) {
        body(times * order[n / times] + n % times);
    }, from, to);
}

Vector<Region> split_region(const Region &parent, const Vector<uint32_t> &labels,
                            uint32_t count)
{
    Vector<Region> out(count);
    Vector<uint32_t> place(parent.size());
    for (size_t i = 0; i < parent.size(); ++i) {
        place[i] = uint32_t(out[labels[i]].size());
        out[labels[i]].triangles.push_back(parent.triangles[i]);
    }
    for (Region &region : out)
        region.neighbours.reserve(region.size());
    for (size_t i = 0; i < parent.size(); ++i) {
        std::array<uint32_t, 3> own = parent.neighbours[i];
        for (uint32_t &n : own)
            n = n != NO_TRIANGLE && labels[n] == labels[i] ? place[n] : NO_TRIANGLE;
        out[labels[i]].neighbours.push_back(own);
    }
    return out;
}

uint32_t connected_pieces(const Region &region, Vector<uint32_t> &labels)
{
    Vector<uint32_t> piece(region.size(), NO_TRIANGLE), stack;
    uint32_t count = 0;
    for (uint32_t first = 0; first < region.size(); ++first) {
        if (piece[first] != NO_TRIANGLE)
            continue;
        piece[first] = count;
        stack.push_back(first);
        while (!stack.empty()) {
            uint32_t t = stack.back();
            stack.pop_back();
            for (uint32_t n : region.neighbours[t])
                if (n != NO_TRIANGLE && piece[n] == NO_TRIANGLE && labels[n] == labels[t]) {
                    piece[n] = count;
                    stack.push_back(n);
                }
        }
        ++count;
    }
    labels = std::move(piece);
    return count;
}

} // namespace gtx
