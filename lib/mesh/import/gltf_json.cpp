/* Checks the JSON of a glTF document before a library that trusts it sees it. */
#include "mesh/import/gltf_json.hpp"

#include <climits>
#include <cstring>
#include <nlohmann/json.hpp>

namespace gtx {

using nlohmann::json;

/* tinygltf walks extras and extensions recursively. */
static const int max_json_depth = 100;

static const char *const known_extensions[] = {
    "KHR_draco_mesh_compression", "KHR_mesh_quantization", "KHR_texture_transform",
    "KHR_texture_basisu",         "EXT_texture_webp",      "EXT_texture_avif",
    "EXT_meshopt_compression",    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",        "EXT_mesh_features",     "EXT_structural_metadata",
    "GTX_geometry_texture",       "MSFT_lod", /* the mesh is read, at its finest */
};

/* What a document may hold that has no place in a mesh, and is not read. */
static const struct {
    const char *key, *warning;
    gtx_warning kind = GTX_WARNING_IGNORED_SCENE;
} unread[] = {
    {"images", nullptr}, /* these four are read apart */
    {"textures", nullptr},
    {"materials", nullptr},
    {"samplers", nullptr},
    {"animations", "animations were ignored"},
    {"skins", "skins were ignored"},
    {"cameras", "cameras were ignored", GTX_WARNING_IGNORED_VIEW},
    {"extensions", nullptr},
    {"extras", nullptr},
    {"buffers", nullptr},
};

enum class Kind { index, size, number, boolean, string };
static const char *const kind_names[] = {"an index", "a size", "a number", "a boolean", "a string"};

/* The members that are read: [] is each item of an array, {} each member of an object. */
static const struct {
    const char *path;
    Kind kind;
} members[] = {
    {"asset.version", Kind::string},
    {"extensionsRequired[]", Kind::string},
    {"extensionsUsed[]", Kind::string},
    {"scene", Kind::index},
    {"scenes[].nodes[]", Kind::index},
    {"nodes[].mesh", Kind::index},
    {"nodes[].children[]", Kind::index},
    {"nodes[].matrix[]", Kind::number},
    {"nodes[].translation[]", Kind::number},
    {"nodes[].rotation[]", Kind::number},
    {"nodes[].scale[]", Kind::number},
    {"meshes[].primitives[].attributes{}", Kind::index},
    {"meshes[].primitives[].indices", Kind::index},
    {"meshes[].primitives[].material", Kind::index},
    {"meshes[].primitives[].mode", Kind::index},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.bufferView", Kind::index},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.attributes{}", Kind::index},
    {"nodes[].extensions.EXT_mesh_gpu_instancing.attributes{}", Kind::index},
    {"images[].uri", Kind::string},
    {"images[].bufferView", Kind::index},
    {"accessors[].bufferView", Kind::index},
    {"accessors[].byteOffset", Kind::size},
    {"accessors[].componentType", Kind::index},
    {"accessors[].normalized", Kind::boolean},
    {"accessors[].count", Kind::size},
    {"accessors[].type", Kind::string},
    {"accessors[].sparse.count", Kind::index},
    {"accessors[].sparse.indices.bufferView", Kind::index},
    {"accessors[].sparse.indices.byteOffset", Kind::index},
    {"accessors[].sparse.indices.componentType", Kind::index},
    {"accessors[].sparse.values.bufferView", Kind::index},
    {"accessors[].sparse.values.byteOffset", Kind::index},
    {"bufferViews[].buffer", Kind::index},
    {"bufferViews[].byteOffset", Kind::size},
    {"bufferViews[].byteLength", Kind::size},
    {"bufferViews[].byteStride", Kind::index},
    {"bufferViews[].extensions.EXT_meshopt_compression.buffer", Kind::index},
    {"bufferViews[].extensions.EXT_meshopt_compression.byteOffset", Kind::index},
    {"bufferViews[].extensions.EXT_meshopt_compression.byteLength", Kind::index},
    {"bufferViews[].extensions.EXT_meshopt_compression.byteStride", Kind::index},
    {"bufferViews[].extensions.EXT_meshopt_compression.count", Kind::index},
    {"bufferViews[].extensions.EXT_meshopt_compression.mode", Kind::string},
    {"bufferViews[].extensions.EXT_meshopt_compression.filter", Kind::string},
    {"buffers[].extensions.EXT_meshopt_compression.fallback", Kind::boolean},
    {"buffers[].byteLength", Kind::size},
    {"buffers[].uri", Kind::string},
};

static bool is_kind(const json &value, Kind kind)
{
    switch (kind) {
    case Kind::index: return value.is_number_unsigned() && value.get<uint64_t>() <= INT_MAX;
    case Kind::size: return value.is_number_unsigned();
    case Kind::number: return value.is_number();
    case Kind::boolean: return value.is_boolean();
    case Kind::string: return value.is_string();
    }
    return false;
}

/* `where` is the place of `value` in the document, for the message. */
static void check_member(const json &value, const char *path, Kind kind, std::string &where)
{
    size_t length = where.size();
    if (!*path) {
        if (!is_kind(value, kind))
            fail(GTX_ERROR_INPUT, "%.150s is not %s", where.c_str(), kind_names[int(kind)]);
    } else if (*path == '[') {
        if (!value.is_array())
            fail(GTX_ERROR_INPUT, "%.150s is not an array", where.c_str());
        for (size_t i = 0; i < value.size(); ++i) {
            where += '[' + std::to_string(i) + ']';
            check_member(value[i], path + 2, kind, where);
            where.resize(length);
        }
    } else if (!value.is_object()) {
        fail(GTX_ERROR_INPUT, "%.150s is not an object", where.c_str());
    } else if (*path == '{') {
        for (const auto &item : value.items()) {
            where += '.' + printable(item.key());
            check_member(item.value(), path + 2, kind, where);
            where.resize(length);
        }
    } else {
        path += *path == '.';
        std::string name(path, std::strcspn(path, ".[{"));
        auto found = value.find(name);
        if (found == value.end())
            return;
        where += (length ? "." : "") + name;
        check_member(*found, path + name.size(), kind, where);
        where.resize(length);
    }
}

static void check_depth(std::string_view text)
{
    int depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '"')
            in_string = !in_string;
        else if (in_string)
            i += c == '\\';
        else if (c == '[' || c == '{')
            ++depth;
        else if (c == ']' || c == '}')
            --depth;
        if (depth > max_json_depth)
            fail(GTX_ERROR_LIMIT, "the JSON is nested more than %d levels deep", max_json_depth);
    }
}

json parse_gltf_json(std::string_view text)
{
    if (text.size() > size_t(1) << 31)
        fail(GTX_ERROR_LIMIT, "the JSON is larger than 2 GiB");
    check_depth(text);
    try {
        return json::parse(text.begin(), text.end());
    } catch (const json::exception &e) { /* "[json.exception.parse_error.101] parse error at ..." */
        const char *what = e.what(), *tag = std::strstr(what, "] ");
        fail(GTX_ERROR_INPUT, "the JSON is malformed: %s",
             printable(tag ? tag + 2 : what, 150).c_str());
    }
}

static bool is_known(const std::string &extension)
{
    for (const char *known : known_extensions)
        if (extension == known)
            return true;
    return extension.rfind("KHR_materials_", 0) == 0; /* each material says what it lacks */
}

static void check_extensions(const json &root, Task &task)
{
    if (auto required = root.find("extensionsRequired"); required != root.end())
        for (const json &name : *required)
            if (!is_known(name))
                fail(GTX_ERROR_UNSUPPORTED, "the model requires the glTF extension %s",
                     printable(name.get_ref<const std::string &>()).c_str());
    std::string ignored;
    if (auto used = root.find("extensionsUsed"); used != root.end())
        for (const json &name : *used)
            if (!is_known(name) && ignored.size() < 200)
                ignored +=
                    (ignored.empty() ? "" : ", ") + printable(name.get_ref<const std::string &>());
    if (!ignored.empty())
        task.warn(GTX_WARNING_IGNORED_EXTENSION, "glTF extensions were ignored: " + ignored);
}

json read_gltf_json(std::string_view text, Task &task)
{
    json root = parse_gltf_json(text);
    std::string where;
    for (const auto &member : members)
        check_member(root, member.path, member.kind, where);
    if (!root.contains("asset") || !root["asset"].contains("version"))
        fail(GTX_ERROR_INPUT, "the glTF has no asset.version");
    const std::string &version = root["asset"]["version"].get_ref<const std::string &>();
    if (version.rfind("2.", 0) != 0)
        fail(GTX_ERROR_UNSUPPORTED, "glTF version %s is not 2", printable(version).c_str());
    check_extensions(root, task);
    return root;
}

/* tinygltf opens every URI of the document, insists on a buffer view of indices that lie inside
 * Draco data, and decodes Draco without checking a number. */
void strip_gltf_json(json &root, Task &task)
{
    if (root.contains("extensions") && root["extensions"].contains("KHR_lights_punctual"))
        task.warn(GTX_WARNING_IGNORED_VIEW, "lights were ignored");
    for (const auto &item : unread) {
        auto found = root.find(item.key);
        if (found == root.end())
            continue;
        if (item.warning && !found->empty())
            task.warn(item.kind, item.warning);
        root.erase(found);
    }
    bool has_targets = false;
    auto meshes = root.find("meshes");
    for (size_t m = 0; meshes != root.end() && m < meshes->size(); ++m) {
        auto primitives = (*meshes)[m].find("primitives");
        for (size_t i = 0; primitives != (*meshes)[m].end() && i < primitives->size(); ++i) {
            json &primitive = (*primitives)[i];
            if (!primitive.contains("attributes")) /* tinygltf would leave the primitive out */
                fail(GTX_ERROR_INPUT, "mesh %zu primitive %zu has no attributes", m, i);
            has_targets |= primitive.erase("targets") > 0;
            if (primitive.contains("extensions") &&
                primitive["extensions"].contains("KHR_draco_mesh_compression"))
                primitive.erase("indices");
        }
    }
    if (has_targets)
        task.warn(GTX_WARNING_IGNORED_SCENE, "morph targets were ignored");
}

} // namespace gtx
