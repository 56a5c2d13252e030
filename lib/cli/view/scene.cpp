/* Files -> a scene: assets, polygon models, and glTF scenes that place assets. */
#include "cli/view/scene.hpp"

#include "base/bytes.h"
#include "cli/cli.h"
#include "grid/grid.hpp"
#include "host/jobs.h"
#include "stream/index.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>

namespace gtx {

using nlohmann::json;

static Transform multiply(const Transform &a, const Transform &b)
{
    Transform r;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            double sum = 0;
            for (int k = 0; k < 4; ++k)
                sum += a[4 * k + row] * b[4 * column + k];
            r[4 * column + row] = sum;
        }
    return r;
}

/* The local transform of a glTF node: a matrix, or translation, rotation (x y z w) and scale. */
static Transform node_transform(const json &node)
{
    if (node.contains("matrix"))
        return node["matrix"].get<Transform>();
    auto t = node.value("translation", std::array<double, 3>{0, 0, 0});
    auto q = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
    auto s = node.value("scale", std::array<double, 3>{1, 1, 1});
    double x = q[0], y = q[1], z = q[2], w = q[3];
    return {s[0] * (1 - 2 * (y * y + z * z)), s[0] * 2 * (x * y + z * w),
            s[0] * 2 * (x * z - y * w), 0,
            s[1] * 2 * (x * y - z * w), s[1] * (1 - 2 * (x * x + z * z)),
            s[1] * 2 * (y * z + x * w), 0,
            s[2] * 2 * (x * z + y * w), s[2] * 2 * (y * z - x * w),
            s[2] * (1 - 2 * (x * x + y * y)), 0,
            t[0], t[1], t[2], 1};
}

AssetPointer open_asset(const std::string &path)
{
    const gtx_jobs jobs = gtx_host_jobs(0);
    gtx_open_desc desc = {};
    desc.jobs = &jobs;
    desc.limits = cli_limits;
    gtx_asset *asset;
    gtx_error error;
    require_ok(gtx_open_file(path.c_str(), &desc, &asset, &error), error);
    return AssetPointer(asset);
}

static void add_asset(Scene &scene, const std::string &path, const Transform &transform)
{
    scene.assets.push_back({open_asset(path), transform, {}});
    scene.sources.push_back(path);
}

/* Of the extension GTX_geometry_texture: the file that a node's asset lies in; empty where it has
 * none, or one inside the GLB, which the node's mesh stands for. */
static std::string extension_uri(const json &gltf, const json &node)
{
    static const char name[] = "GTX_geometry_texture";
    const json at_node = node.value("extensions", json::object());
    if (!at_node.contains(name))
        return {};
    const json assets = gltf.at("extensions").at(name).at("assets");
    return assets.at(at_node[name].at("asset").get<size_t>()).value("uri", "");
}

/* Such an asset stands with its anchor at the node's origin. */
static void add_anchored(Scene &scene, const std::string &path, const Transform &transform)
{
    add_asset(scene, path, transform);
    gtx_info info;
    gtx_get_info(scene.assets.back().asset.get(), &info);
    Transform back = identity_transform;
    for (size_t k = 0; k < 3; ++k)
        back[12 + k] = -info.anchor[k];
    scene.assets.back().transform = multiply(transform, back);
}

/* Places the assets that the nodes of a glTF scene name; false when no node names one. */
static bool add_placed_assets(Scene &scene, const json &gltf, const std::string &folder)
{
    struct Visit {
        size_t node;
        Transform parent;
    };
    const json nodes = gltf.value("nodes", json::array());
    Vector<Visit> stack;
    for (const json &s : gltf.value("scenes", json::array()))
        for (size_t node : s.value("nodes", Vector<size_t>()))
            stack.push_back({node, identity_transform});

    bool found = false;
    for (size_t visited = 0; !stack.empty(); ++visited) {
        Visit visit = stack.back();
        stack.pop_back();
        if (visit.node >= nodes.size() || visited > nodes.size())
            throw Error(GTX_ERROR_INPUT, "the scene's nodes do not form a forest");
        const json &node = nodes[visit.node];
        Transform world = multiply(visit.parent, node_transform(node));
        if (node.contains("extras") && node["extras"].contains("geotex")) {
            add_asset(scene, folder + node["extras"]["geotex"].get<std::string>(), world);
            found = true;
        }
        if (const std::string uri = extension_uri(gltf, node); !uri.empty()) {
            add_anchored(scene, folder + uri, world);
            found = true;
        }
        for (size_t child : node.value("children", Vector<size_t>()))
            stack.push_back({child, world});
    }
    return found;
}

static bool ends_with(const std::string &text, const char *suffix)
{
    size_t n = std::strlen(suffix);
    return text.size() >= n && text.compare(text.size() - n, n, suffix) == 0;
}

static void add_model(Scene &scene, ModelFile file, Task &task)
{
    CleanReport report;
    scene.sources.push_back(file.path);
    for (std::string &source : referenced_files(file, task))
        scene.sources.push_back(std::move(source));
    file.sources = &scene.sources;
    scene.meshes.push_back(clean_mesh(import_model(file, task), task, report));
}

/* The text of a document, which is the first chunk of a GLB. */
static std::string_view json_of(std::string_view bytes)
{
    constexpr size_t LENGTH = 12, TEXT = 20;
    if (bytes.substr(0, 4) != "glTF" || bytes.size() < TEXT)
        return bytes;
    const auto *length = reinterpret_cast<const uint8_t *>(bytes.data() + LENGTH);
    return bytes.substr(TEXT, gtx_load_u32(length));
}

static void add_gltf(Scene &scene, const std::string &path, Task &task)
{
    bool placed = false;
    ModelFile file = read_model(path, task);
    try {
        json gltf = json::parse(json_of(file.bytes));
        size_t slash = path.rfind('/');
        placed =
            add_placed_assets(scene, gltf, slash == path.npos ? "" : path.substr(0, slash + 1));
    } catch (const json::exception &e) {
        throw Error(GTX_ERROR_INPUT, e.what());
    }
    try {
        add_model(scene, std::move(file), task);
    } catch (const Error &e) {
        if (!placed || e.result != GTX_ERROR_EMPTY) /* a scene of assets alone is fine */
            throw;
    }
}

bool is_asset(const std::string &path)
{
    char start[5] = {0};
    FILE *file = std::fopen(path.c_str(), "rb");
    if (!file)
        throw Error(GTX_ERROR_READ, std::strerror(errno));
    size_t got = std::fread(start, 1, 4, file);
    std::fclose(file);
    return ends_with(path, ".gtx") || (got == 4 && !std::memcmp(start, "\xabGTX", 4));
}

static void add_grid(Scene &scene, const std::string &path, Task &task)
{
    const auto warn = [&](gtx_warning kind, const char *text) { task.warn(kind, text); };
    scene.assets.push_back({asset_of_grid(path, nullptr, nullptr, warn), identity_transform, {}});
    scene.sources.push_back(path);
}

void add_file(Scene &scene, const std::string &path, Task &task)
{
    const std::string world = world_at(path);
    if (!world.empty()) {
        scene.worlds.push_back(open_world(world));
        scene.sources.push_back(world + "/" GTX_INDEX_FILE);
    } else if (is_asset(path))
        add_asset(scene, path, identity_transform);
    else if (ends_with(path, ".gltf") || ends_with(path, ".glb"))
        add_gltf(scene, path, task);
    else if (is_grid_file(path))
        add_grid(scene, path, task);
    else
        add_model(scene, read_model(path, task), task);
}

void refuse_sources(const Scene &scene, const output_file *outputs)
{
    gtx_error error;
    for (const std::string &source : scene.sources) {
        const char *path = source.c_str();
        require_ok(refuse_inputs(outputs, &path, 1, &error), error);
    }
}

void measure_bounds(Scene &scene)
{
    const double inf = std::numeric_limits<double>::infinity();
    Vec3d low(inf, inf, inf), high(-inf, -inf, -inf);
    auto add = [&](const Vec3d &p) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], p[i]);
            high[i] = std::max(high[i], p[i]);
        }
    };
    for (const Mesh &mesh : scene.meshes)
        for (const Vec3d &p : mesh.positions)
            add(p);
    for (const PlacedWorld &world : scene.worlds)
        for (const double *p : {world.info.low, world.info.high})
            add({p[0], p[1], p[2]});
    for (const PlacedAsset &placed : scene.assets) {
        gtx_info info;
        gtx_get_info(placed.asset.get(), &info);
        const Transform &m = placed.transform;
        for (int corner = 0; corner < 8; ++corner) {
            double p[3];
            for (int i = 0; i < 3; ++i)
                p[i] = info.anchor[i] +
                       double(corner >> i & 1 ? info.bounds_max[i] : info.bounds_min[i]);
            add({m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12],
                 m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13],
                 m[2] * p[0] + m[6] * p[1] + m[10] * p[2] + m[14]});
        }
    }
    if (!(low.x <= high.x)) /* nothing at all */
        low = high = Vec3d(0, 0, 0);
    scene.centre = (low + high) * 0.5;
    scene.radius = std::max(length(high - low) / 2, std::numeric_limits<double>::min());
}

} // namespace gtx
