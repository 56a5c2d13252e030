/* Assets combined as solids beside the same operations on their meshes.
 *
 *   solids OUT_FOLDER MODEL
 *
 * The holes of MODEL are closed by fans, a sphere is laid through it, both are cooked by default
 * and combined. CGAL, where it was there to build with, does the same to the two meshes, with exact
 * decisions (corefinement): the table has the volumes of both, and how far they are apart. */
#include "mesh/mesh.hpp"

#include <geotex/cook.h>
#include <geotex/solid.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>

#if __has_include(<CGAL/Surface_mesh.h>)
#define HAVE_CGAL 1
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/helpers.h>
#endif

using namespace gtx;

namespace {

constexpr const char *OPS[] = {"union", "intersect", "subtract"};

void require(gtx_result result, const gtx_error &error)
{
    if (!result)
        return;
    std::fprintf(stderr, "solids: %s\n", error.message);
    std::exit(3);
}

/* Of a processor. */
double seconds()
{
    return double(std::clock()) / CLOCKS_PER_SEC;
}

/* Closes every border by a fan around the mean of its corners. */
void close_holes(Mesh &mesh)
{
    std::map<uint32_t, uint32_t> next; /* along a border, seen from the hole */
    const auto neighbours = triangle_neighbours(mesh);
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t k = 0; k < 3; ++k)
            if (neighbours[t][k] == NO_TRIANGLE)
                next[mesh.triangles[t][(k + 1) % 3]] = mesh.triangles[t][k];
    while (!next.empty()) {
        Vector<uint32_t> loop;
        for (auto at = next.begin(); at != next.end(); at = next.find(loop.back())) {
            loop.push_back(at->second);
            next.erase(at);
        }
        Vec3d middle;
        for (uint32_t v : loop)
            middle += mesh.positions[v] / double(loop.size());
        const auto apex = uint32_t(mesh.positions.size());
        mesh.positions.push_back(middle);
        for (size_t i = 0; i < loop.size(); ++i)
            mesh.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], apex});
    }
}

/* A cube of 6 x n x n squares blown up. Faces share the vertices of their edges. */
Mesh make_sphere(const Vec3d &centre, double radius, int n)
{
    Mesh out;
    std::map<std::array<int, 3>, uint32_t> names; /* of the cube's lattice */
    auto vertex = [&](int face, int i, int j) {
        std::array<int, 3> at;
        at[size_t(face / 2)] = face % 2 ? 0 : n;
        at[size_t(face / 2 + 1) % 3] = face % 2 ? j : i;
        at[size_t(face / 2 + 2) % 3] = face % 2 ? i : j;
        const auto [name, fresh] = names.insert({at, uint32_t(out.positions.size())});
        if (fresh) {
            Vec3d p;
            for (int k = 0; k < 3; ++k)
                p[k] = std::tan((2. * at[size_t(k)] / n - 1) * M_PI / 4);
            out.positions.push_back(centre + normalize(p) * radius);
        }
        return name->second;
    };
    for (int face = 0; face < 6; ++face)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const uint32_t a = vertex(face, i, j), b = vertex(face, i + 1, j),
                               c = vertex(face, i, j + 1), d = vertex(face, i + 1, j + 1);
                out.triangles.push_back({a, b, d});
                out.triangles.push_back({a, d, c});
            }
    return out;
}

void write_ply(const std::string &path, const Mesh &mesh)
{
    FILE *file = std::fopen(path.c_str(), "wb");
    if (!file) {
        std::fprintf(stderr, "solids: %s cannot be written\n", path.c_str());
        std::exit(2);
    }
    std::fprintf(file, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n"
                       "property double x\nproperty double y\nproperty double z\n"
                       "element face %zu\nproperty list uchar uint vertex_indices\nend_header\n",
                 mesh.positions.size(), mesh.triangle_count());
    std::fwrite(mesh.positions.data(), sizeof(Vec3d), mesh.positions.size(), file);
    for (const auto &t : mesh.triangles) {
        std::fputc(3, file);
        std::fwrite(t.data(), sizeof t[0], 3, file);
    }
    std::fclose(file);
}

double volume_of(const Mesh &mesh)
{
    double sum = 0;
    const Vec3d o = mesh.positions[0];
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        sum += dot(mesh.position(t, 0) - o,
                   cross(mesh.position(t, 1) - o, mesh.position(t, 2) - o));
    return sum / 6;
}

/* Volumes of the three operations on the meshes, NAN where nobody can tell, and the time. */
struct Peer {
    double volume[3] = {NAN, NAN, NAN}, seconds[3] = {NAN, NAN, NAN};
};

#ifdef HAVE_CGAL
namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polygons = CGAL::Surface_mesh<Kernel::Point_3>;

Polygons polygons_of(const Mesh &mesh)
{
    Polygons out;
    for (const Vec3d &p : mesh.positions)
        out.add_vertex({p.x, p.y, p.z});
    for (const auto &t : mesh.triangles)
        out.add_face(Polygons::Vertex_index(t[0]), Polygons::Vertex_index(t[1]),
                     Polygons::Vertex_index(t[2]));
    return out;
}

Peer combine_meshes(const Mesh &a, const Mesh &b)
{
    Peer out;
    for (int op = 0; op < 3; ++op) {
        Polygons left = polygons_of(a), right = polygons_of(b), made;
        const double start = seconds();
        if (!CGAL::is_closed(left) || !CGAL::is_closed(right)) {
            std::fprintf(stderr, "solids: a mesh is open\n");
            std::exit(3);
        }
        const bool done =
            op == 0   ? PMP::corefine_and_compute_union(left, right, made)
            : op == 1 ? PMP::corefine_and_compute_intersection(left, right, made)
                      : PMP::corefine_and_compute_difference(left, right, made);
        out.seconds[op] = seconds() - start;
        if (done)
            out.volume[op] = CGAL::to_double(PMP::volume(made));
    }
    return out;
}
#else
Peer combine_meshes(const Mesh &, const Mesh &)
{
    std::printf("built without CGAL (libcgal-dev): there is nothing to compare with\n");
    return {};
}
#endif

gtx_asset *cook(const std::string &model, const std::string &asset)
{
    gtx_error error;
    require(gtx_cook_file(model.c_str(), asset.c_str(), nullptr, nullptr, &error), error);
    gtx_asset *out = nullptr;
    require(gtx_open_file(asset.c_str(), nullptr, &out, &error), error);
    return out;
}

double volume_of(const gtx_asset *asset)
{
    gtx_solid *solid = nullptr;
    gtx_error error;
    gtx_solid_desc desc = {};
    desc.max_openness = 1;
    require(gtx_solid_create(asset, &desc, &solid, &error), error);
    gtx_solid_facts facts;
    gtx_solid_measure(solid, &facts);
    gtx_solid_destroy(solid);
    return facts.volume;
}

void print_row(const char *what, double mesh, double asset, double mesh_seconds,
               double asset_seconds)
{
    std::printf("%-10s %13.7g %13.7g %+9.4f %% %8.2f s %8.2f s\n", what, mesh, asset,
                100 * (asset / mesh - 1), mesh_seconds, asset_seconds);
}

void run(const std::string &folder, const char *model)
{
    Task task(0, nullptr, nullptr);
    CleanReport clean;
    const Mesh read = clean_mesh(import_mesh(model, task), task, clean);
    Mesh body;
    body.positions = read.positions;
    body.triangles = read.triangles;
    close_holes(body);
    Vec3d low = body.positions[0], high = low;
    for (const Vec3d &p : body.positions)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    const Vec3d size = high - low;
    /* Off the middle, half in and half out. */
    const Mesh ball = make_sphere(low + Vec3d(size.x * 0.6, size.y * 0.55, size.z * 0.7),
                                  0.25 * length(size), 96);
    const Mesh *meshes[2] = {&body, &ball};
    gtx_asset *assets[2];
    for (int side = 0; side < 2; ++side) {
        const std::string name = folder + (side ? "/solid_ball" : "/solid_body");
        write_ply(name + ".ply", *meshes[side]);
        assets[side] = cook(name + ".ply", name + ".gtx");
    }
    const Peer peer = combine_meshes(body, ball);
    std::printf("%-10s %13s %13s %11s %10s %10s\n", "volume", "meshes", "assets", "apart",
                "meshes", "assets");
    for (int side = 0; side < 2; ++side)
        print_row(side ? "ball" : "body", volume_of(*meshes[side]), volume_of(assets[side]), NAN,
                  NAN);
    for (int op = 0; op < 3; ++op) {
        gtx_combine_desc desc = {};
        desc.op = gtx_combine_op(op);
        gtx_asset *made = nullptr;
        gtx_combine_result told;
        gtx_error error;
        const double start = seconds();
        require(gtx_combine(assets[0], assets[1], &desc, &made, &told, &error), error);
        const double took = seconds() - start;
        print_row(OPS[op], peer.volume[op], volume_of(made), peer.seconds[op], took);
        gtx_close(made);
    }
    for (gtx_asset *asset : assets)
        gtx_close(asset);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 3) {
        std::fprintf(stderr, "usage: solids OUT_FOLDER MODEL\n");
        return 1;
    }
    try {
        run(argv[1], argv[2]);
        return 0;
    } catch (const Error &e) {
        std::fprintf(stderr, "solids: %s\n", e.message.c_str());
        return 3;
    }
}
