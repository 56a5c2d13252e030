/* Importers: what each reads is cleaned, and small meshes are cooked. */
#include "fuzz/fuzz.hpp"

#include "mesh/import/import.hpp"
#include "mesh/stream.hpp"

#include <geotex/cook.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fuzz {

/* Triangles; of many that cross each other a cook takes seconds, with sanitizers. */
constexpr size_t MAX_COOKED = 64;

using gtx::Mesh;

static void check_imported(const Mesh &mesh)
{
    const size_t count = mesh.triangles.size(), corners = 3 * count;
    for (const auto &t : mesh.triangles)
        for (uint32_t v : t)
            REQUIRE(v < mesh.positions.size(), "vertex %u of %zu", v, mesh.positions.size());
    REQUIRE(mesh.normals.empty() || mesh.normals.size() == corners, "normals are missing");
    REQUIRE(mesh.colors.empty() || mesh.colors.size() == corners, "colours are missing");
    REQUIRE(mesh.flags.empty() || mesh.flags.size() == count, "flags are missing");
    const gtx::Appearance &a = mesh.appearance;
    REQUIRE(a.material.empty() || a.material.size() == count, "materials are missing");
    for (uint32_t m : a.material)
        REQUIRE(m < a.materials.size(), "material %u of %zu", m, a.materials.size());
    for (const auto &uv : a.uv)
        REQUIRE(uv.empty() || uv.size() == corners, "texture coordinates are missing");
}

static void check_cleaned(const Mesh &mesh)
{
    check_imported(mesh);
    for (const gtx::Vec3d &p : mesh.positions)
        REQUIRE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "a wild vertex");
    for (const auto &t : mesh.triangles)
        REQUIRE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "a triangle of two corners");
    REQUIRE(mesh.normals.size() == 3 * mesh.triangles.size(), "corners without normals");
    for (const gtx::Vec3f &n : mesh.normals)
        REQUIRE(std::fabs(std::hypot(n.x, n.y, n.z) - 1) < 1e-3, "a normal of length %g",
                double(std::hypot(n.x, n.y, n.z)));
}

static bool expected(gtx_result result)
{
    return result == GTX_ERROR_INPUT || result == GTX_ERROR_EMPTY || result == GTX_ERROR_LIMIT ||
           result == GTX_ERROR_UNSUPPORTED || result == GTX_ERROR_READ ||
           result == GTX_ERROR_MEMORY;
}

/* Triangles once cleaned; 0 where the bytes are no model. */
static size_t import(const std::string &bytes, const std::string &path)
{
    gtx::Task task(1, nullptr, nullptr, {}, {}, small_limits());
    try {
        gtx::ModelFile file = gtx::model_in_memory(bytes, path, task);
        gtx::referenced_files(file, task);
        Mesh mesh = gtx::import_model(file, task);
        check_imported(mesh);
        gtx::CleanReport report;
        mesh = gtx::clean_mesh(std::move(mesh), task, report);
        check_cleaned(mesh);
        return mesh.triangles.size();
    } catch (const gtx::Error &e) {
        REQUIRE(expected(e.result) && e.message.size() > 8, "import: %d %s", e.result,
                e.message.c_str());
        return 0;
    }
}

/* A model that is read in pieces has the triangles that importing it whole gives. */
static void stream(const std::string &bytes, const std::string &path)
{
    static const char *const kinds[] = {"ply", "solid", "glTF"};
    const bool may = std::any_of(kinds, kinds + 3, [&](const char *kind) {
        return bytes.compare(0, strlen(kind), kind) == 0;
    });
    if (!may && path.substr(path.size() - 3) != "stl")
        return;
    write_scratch(path.substr(path.rfind('/') + 1).c_str(), bytes.data(), bytes.size());
    gtx::Task task(1, nullptr, nullptr, {}, {}, small_limits());
    size_t imported = 0, streamed = 0;
    bool whole = false;
    try {
        imported = gtx::import_mesh(path, task).triangles.size();
        whole = true;
    } catch (const gtx::Error &) {
    }
    try {
        gtx::open_triangles(path, task)->read([&](const gtx::Corners3 &) { ++streamed; });
        REQUIRE(!whole || imported == streamed, "%zu triangles, in pieces %zu", imported, streamed);
    } catch (const gtx::Error &e) {
        REQUIRE(expected(e.result) && e.message.size() > 8, "stream: %d %s", e.result,
                e.message.c_str());
        REQUIRE(!whole || e.result == GTX_ERROR_LIMIT, "in pieces: %s", e.message.c_str());
    }
}

static int stop_after(const gtx_progress *progress, void *user)
{
    REQUIRE(progress->fraction >= 0 && progress->fraction <= 1, "progress of %g",
            progress->fraction);
    int *left = static_cast<int *>(user);
    return *left == 0 || --*left == 0;
}

static void cook(const std::string &bytes, const std::string &path, uint64_t how)
{
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    int left = how % 8 ? 1 << 30 : 1 + int(how >> 8 & 63);
    gtx_cook_desc desc = {};
    desc.allocator = &hooks;
    desc.threads = 1;
    desc.resolution = 64;
    desc.charts = uint32_t(how >> 16 & 7);
    desc.partition = gtx_partition(how >> 20 & 3);
    desc.height_bits = how >> 22 & 1 ? 16 : 8;
    desc.mips = 1 + uint32_t(how >> 24 & 3);
    desc.lod_levels = how >> 26 & 1 ? 2 : GTX_LOD_LEVELS_NONE;
    desc.z_up = uint32_t(how >> 27 & 1);
    desc.progress = stop_after;
    desc.progress_user = &left;
    gtx_asset *asset = nullptr;
    gtx_report report = {};
    gtx_error error = {};
    gtx_cook_memory(bytes.data(), bytes.size(), path.c_str(), &desc, &asset, &report, &error);
    REQUIRE(asset || expected(error.result) || (error.result == GTX_CANCELLED && !left),
            "cook: %d, rule %u: %s", error.result, error.rule, error.message);
    if (asset)
        round_trip(asset, true, "what was cooked");
    gtx_report_free(&report);
    gtx_close(asset);
}

static void run(const uint8_t *data, size_t size, const char *name)
{
    const std::string bytes(reinterpret_cast<const char *>(data), size), path = scratch(name);
    const uint64_t how = choices(data, size);
    const size_t triangles = import(bytes, path);
    if (how >> 40 & 1)
        stream(bytes, path);
    if (triangles && triangles <= MAX_COOKED && how % 32 == 0)
        cook(bytes, path, how >> 5);
}

void run_ply(const uint8_t *data, size_t size) { run(data, size, "a.ply"); }
void run_off(const uint8_t *data, size_t size) { run(data, size, "a.off"); }
void run_stl(const uint8_t *data, size_t size) { run(data, size, "a.stl"); }
void run_gltf(const uint8_t *data, size_t size)
{
    run(data, size, "a.gltf");
    find_embedded(data, size);
}
void run_draco(const uint8_t *data, size_t size) { run(data, size, "a.drc"); }
void run_gzip(const uint8_t *data, size_t size) { run(data, size, "a.obj.gz"); }

/* A grey pixel, for a library to refer to. */
static const uint8_t PICTURE[] = "P5\n1 1\n255\n\x80";

/* What follows a line "# a.mtl" is the material library beside the model. */
void run_obj(const uint8_t *data, size_t size)
{
    static const std::string mark = "# a.mtl\n";
    const uint8_t *at = std::search(data, data + size, mark.begin(), mark.end());
    const uint8_t *library = std::min(at + mark.size(), data + size);
    write_scratch("a.mtl", library, size_t(data + size - library));
    write_scratch("a.png", PICTURE, sizeof PICTURE - 1);
    run(data, size_t(at - data), "a.obj");
}

} // namespace fuzz
