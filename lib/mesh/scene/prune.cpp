/* Dropping from a glTF document what nothing refers to. */
#include "mesh/scene/prune.hpp"

#include "mesh/import/import.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

namespace gtx {

using nlohmann::json;

/* Arrays in an order in which nothing refers to a later one from an earlier. */
static const char *const arrays[] = {"meshes", "materials", "textures",
                                     "images", "accessors", "bufferViews"};

/* Where indices of each array stand: [] is each item of an array, {} each member of an object. */
static const struct {
    const char *array, *path;
} references[] = {
    {"meshes", "nodes[].mesh"},
    {"materials", "meshes[].primitives[].material"},
    {"materials", "meshes[].primitives[].extensions.KHR_materials_variants.mappings[].material"},
    {"textures", "materials[].pbrMetallicRoughness{}.index"},
    {"textures", "materials[].normalTexture.index"},
    {"textures", "materials[].occlusionTexture.index"},
    {"textures", "materials[].emissiveTexture.index"},
    {"textures", "materials[].extensions{}{}.index"},
    {"images", "textures[].source"},
    {"images", "textures[].extensions{}.source"},
    {"accessors", "meshes[].primitives[].attributes{}"},
    {"accessors", "meshes[].primitives[].indices"},
    {"accessors", "meshes[].primitives[].targets[]{}"},
    {"accessors", "animations[].samplers[].input"},
    {"accessors", "animations[].samplers[].output"},
    {"accessors", "skins[].inverseBindMatrices"},
    {"accessors", "nodes[].extensions.EXT_mesh_gpu_instancing.attributes{}"},
    {"bufferViews", "accessors[].bufferView"},
    {"bufferViews", "accessors[].sparse.indices.bufferView"},
    {"bufferViews", "accessors[].sparse.values.bufferView"},
    {"bufferViews", "images[].bufferView"},
    {"bufferViews", "meshes[].primitives[].extensions.KHR_draco_mesh_compression.bufferView"},
    {"bufferViews", "extensions.GTX_geometry_texture.assets[].bufferView"},
};

/* Beside all of materials and textures. */
static const char *const known_extensions[] = {
    "KHR_draco_mesh_compression", "KHR_mesh_quantization", "EXT_meshopt_compression",
    "EXT_mesh_gpu_instancing",    "KHR_lights_punctual",   "GTX_geometry_texture",
    "MSFT_lod",
};

bool can_prune(const json &root)
{
    for (const json &used : root.value("extensionsUsed", json::array())) {
        const std::string name = used.is_string() ? used.get<std::string>() : std::string();
        bool known = name.rfind("KHR_materials_", 0) == 0 || name.rfind("KHR_texture_", 0) == 0 ||
                     name.rfind("EXT_texture_", 0) == 0;
        for (const char *other : known_extensions)
            known = known || name == other;
        if (!known)
            return false;
    }
    return true;
}

/* Calls use(index) for every number at the path. */
template <class Use> static void visit(json &value, const char *path, Use use)
{
    if (!*path) {
        if (value.is_number_unsigned())
            use(value);
    } else if (*path == '[' || *path == '{') {
        if (*path == '[' ? value.is_array() : value.is_object())
            for (json &item : value)
                visit(item, path + 2, use);
    } else if (value.is_object()) {
        path += *path == '.';
        const std::string name(path, std::strcspn(path, ".[{"));
        const auto found = value.find(name);
        if (found != value.end())
            visit(*found, path + name.size(), use);
    }
}

template <class Use> static void visit_all(json &root, const char *array, Use use)
{
    for (const auto &reference : references)
        if (!std::strcmp(reference.array, array))
            visit(root, reference.path, use);
}

static void prune_array(json &root, const char *name)
{
    const auto found = root.find(name);
    const size_t count = found != root.end() && found->is_array() ? found->size() : 0;
    Vector<uint8_t> used(count);
    visit_all(root, name, [&](json &index) {
        const uint64_t i = index.get<uint64_t>();
        if (i >= count)
            fail(GTX_ERROR_INPUT, "the document refers to %s[%llu], which does not exist", name,
                 (unsigned long long)i);
        used[i] = 1;
    });
    if (!count)
        return;
    Vector<size_t> number(count);
    json kept = json::array();
    for (size_t i = 0; i < count; ++i) {
        number[i] = kept.size();
        if (used[i])
            kept.push_back(std::move((*found)[i]));
    }
    if (kept.empty()) /* glTF has no empty arrays */
        root.erase(found);
    else
        *found = std::move(kept);
    visit_all(root, name, [&](json &index) { index = number[index.get<uint64_t>()]; });
}

/* ---- views that many accessors share ---- */

/* Bytes of an element; 0 for matrices, which have their own alignment, and for unknown types. */
static uint64_t element_size(const json &accessor)
{
    const std::string type = accessor.value("type", "");
    const int component = accessor.value("componentType", 0);
    const uint64_t bytes = component == 5120 || component == 5121   ? 1
                           : component == 5122 || component == 5123 ? 2
                           : component == 5125 || component == 5126 ? 4
                                                                    : 0;
    return bytes * (type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3
                    : type == "VEC4" ? 4 : 0);
}

/* Gives each accessor a view of its own bytes; those of interleaved arrays share one. What reaches
 * past its view stays as it is. */
static void split_views(json &root)
{
    const auto accessors = root.find("accessors"), views = root.find("bufferViews");
    if (accessors == root.end() || views == root.end() || !views->is_array())
        return;
    const size_t count = views->size();
    std::map<std::array<uint64_t, 3>, size_t> made; /* by view, start and elements */
    for (json &accessor : *accessors) {
        const uint64_t number = accessor.value("bufferView", uint64_t(count));
        const uint64_t size = element_size(accessor);
        const uint64_t elements = accessor.value("count", uint64_t(0));
        if (number >= count || !size || (*views)[number].contains("extensions"))
            continue;
        const json view = (*views)[number];
        const uint64_t length = view.value("byteLength", uint64_t(0));
        const uint64_t stride = std::max(view.value("byteStride", size), size);
        const uint64_t offset = accessor.value("byteOffset", uint64_t(0));
        const uint64_t start = offset - offset % stride;
        if (start >= length || elements > (length - start + stride - 1) / stride)
            continue;
        const auto [entry, fresh] = made.try_emplace({number, start, elements}, views->size());
        if (fresh) {
            json part = view;
            part["byteOffset"] = view.value("byteOffset", uint64_t(0)) + start;
            part["byteLength"] = std::min(length - start, elements * stride);
            views->push_back(std::move(part));
        }
        accessor["bufferView"] = entry->second;
        accessor["byteOffset"] = offset - start;
    }
}

void prune_gltf(json &root)
{
    split_views(root);
    for (const char *array : arrays)
        prune_array(root, array);
}

} // namespace gtx
