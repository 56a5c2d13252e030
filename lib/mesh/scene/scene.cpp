/* A glTF scene taken apart, and put together with assets in the place of meshes. */
#include "mesh/scene/scene.hpp"

#include "mesh/glb.hpp"
#include "mesh/import/gltf.hpp"
#include "mesh/import/gltf_json.hpp"
#include "mesh/scene/prune.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace gtx {

using nlohmann::json;

static const char asset_extension[] = "GTX_geometry_texture";

struct GltfScene::Inside {
    json root;
    Vector<GltfDocument::Buffer> buffers;

    void take_image(json &image, const ModelFile &file, Vector<std::string> &sources, Task &task);
    Bytes file(json document, Task &task) const;
};

/* ---- reading ---- */

static const char *mime_type(std::string_view bytes)
{
    return bytes.substr(0, 4) == "\x89PNG"   ? "image/png"
           : bytes.substr(0, 2) == "\xff\xd8" ? "image/jpeg"
           : bytes.substr(0, 4) == "RIFF"     ? "image/webp"
                                              : nullptr;
}

/* An image in a file of its own becomes a buffer; one that cannot be read stays where it is. */
void GltfScene::Inside::take_image(json &image, const ModelFile &file,
                                   Vector<std::string> &sources, Task &task)
{
    const std::string uri = image.value("uri", "");
    if (uri.empty() || uri.rfind("data:", 0) == 0)
        return;
    const std::string path = texture_path(file, percent_decoded(uri));
    std::shared_ptr<const Bytes> bytes;
    try {
        if (!path.empty())
            bytes = std::make_shared<const Bytes>(read_file_beside(path, task));
    } catch (const Error &e) {
        if (e.result != GTX_ERROR_READ)
            throw;
    }
    const char *type = bytes ? mime_type(*bytes) : nullptr;
    if (!type) {
        task.warn(GTX_WARNING_UNREAD_IMAGE, "the image '" + printable(uri) + "' stays a file: it "
                                            "is not one in the scene's folder, or of no kind "
                                            "that glTF has");
        return;
    }
    sources.push_back(path);
    image.erase("uri");
    image["mimeType"] = type;
    image["bufferView"] = root["bufferViews"].size();
    root["bufferViews"].push_back({{"buffer", buffers.size()}, {"byteLength", bytes->size()}});
    const size_t size = bytes->size();
    buffers.push_back({std::move(bytes), size});
}

/* Why a primitive cannot be part of an asset. */
static const char *why_not(const json &root, const json &primitive)
{
    if (primitive.contains("targets"))
        return "it has morph targets";
    if (primitive.value("mode", 4) < 4)
        return "it has points or lines";
    const auto material = primitive.find("material");
    const auto materials = root.find("materials");
    if (material != primitive.end() && materials != root.end() && materials->is_array() &&
        material->get<size_t>() < materials->size() &&
        (*materials)[material->get<size_t>()].is_object() &&
        (*materials)[material->get<size_t>()].value("alphaMode", "") == "BLEND")
        return "it is blended";
    return nullptr;
}

static uint64_t triangle_count(const json &root, const json &primitive)
{
    const json attributes = primitive.value("attributes", json::object());
    const size_t accessor = primitive.value("indices", attributes.value("POSITION", SIZE_MAX));
    const auto accessors = root.find("accessors");
    if (accessors == root.end() || accessor >= accessors->size())
        return 0;
    const uint64_t corners = (*accessors)[accessor].value("count", uint64_t(0));
    return primitive.value("mode", 4) == 4 ? corners / 3 : corners < 3 ? 0 : corners - 2;
}

static Vector<SceneMesh> meshes_of(const json &root)
{
    Vector<SceneMesh> out;
    for (const json &mesh : root.value("meshes", json::array())) {
        SceneMesh made;
        made.name = mesh.value("name", "");
        for (const json &primitive : mesh.value("primitives", json::array())) {
            made.triangles += triangle_count(root, primitive);
            if (const char *why = why_not(root, primitive))
                made.unsuitable = why;
        }
        out.push_back(made);
    }
    for (const json &node : root.value("nodes", json::array())) {
        const size_t mesh = node.value("mesh", SIZE_MAX);
        if (mesh >= out.size())
            continue;
        ++out[mesh].nodes;
        const json extensions = node.value("extensions", json::object());
        if (node.contains("skin"))
            out[mesh].unsuitable = "it is skinned";
        else if (extensions.contains("EXT_mesh_gpu_instancing"))
            out[mesh].unsuitable = "EXT_mesh_gpu_instancing repeats it";
        else if (extensions.contains(asset_extension))
            out[mesh].unsuitable = "an asset stands for it already";
    }
    for (SceneMesh &mesh : out)
        if (!mesh.nodes)
            mesh.unsuitable = "no node shows it";
    return out;
}

/* What has another type than the checked members should is no scene to rewrite. */
template <class Body> static auto well_formed(Body body)
{
    try {
        return body();
    } catch (const json::exception &e) {
        fail(GTX_ERROR_INPUT, "the glTF is malformed: %s", printable(e.what(), 150).c_str());
    }
}

GltfScene::GltfScene(const ModelFile &file, Task &task) : inside_(std::make_unique<Inside>())
{
    const std::string extension = model_extension(file.path);
    if (extension != ".glb" && extension != ".gltf")
        fail(GTX_ERROR_UNSUPPORTED, "only a glTF scene has meshes to take apart");
    GlbChunks chunks;
    chunks.json = file.bytes;
    if (chunks.json.substr(0, 4) == "glTF")
        chunks = split_glb(file.bytes);
    ModelFile model = {file.path, {}, &sources_};
    inside_->root = read_gltf_json(chunks.json, task);
    inside_->buffers = read_gltf_buffers(inside_->root, model, chunks, task);
    well_formed([&] {
        if (inside_->root.contains("images"))
            for (json &image : inside_->root["images"])
                inside_->take_image(image, file, sources_, task);
        meshes_ = meshes_of(inside_->root);
    });
}

GltfScene::~GltfScene() = default;

/* ---- writing ---- */

/* Moves the bytes of a view, or of what compresses it, to the end of the only buffer. */
static void move_bytes(json &view, const Vector<GltfDocument::Buffer> &buffers, Bytes &binary)
{
    constexpr size_t ALIGNMENT = 8;
    const size_t number = view.value("buffer", SIZE_MAX);
    const uint64_t offset = view.value("byteOffset", uint64_t(0));
    const uint64_t length = view.value("byteLength", uint64_t(0));
    const std::string_view from =
        number < buffers.size() ? buffers[number].view() : std::string_view();
    if (offset > from.size() || length > from.size() - offset)
        fail(GTX_ERROR_INPUT, "a buffer view reaches past its buffer");
    binary.resize((binary.size() + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT, '\0');
    view["buffer"] = 0;
    view["byteOffset"] = binary.size();
    binary += from.substr(size_t(offset), size_t(length));
}

/* The document with all its bytes in one buffer, and a second one without any where a reader of
 * EXT_meshopt_compression fills it. */
Bytes GltfScene::Inside::file(json document, Task &task) const
{
    if (can_prune(document))
        prune_gltf(document);
    Bytes binary;
    uint64_t filled = 0; /* of the second buffer */
    if (document.contains("bufferViews"))
        for (json &view : document["bufferViews"]) {
            json *packed = nullptr;
            if (view.contains("extensions") &&
                view["extensions"].contains("EXT_meshopt_compression"))
                packed = &view["extensions"]["EXT_meshopt_compression"];
            move_bytes(packed ? *packed : view, buffers, binary);
            if (packed) {
                view["buffer"] = 1;
                view["byteOffset"] = filled;
                filled += (view["byteLength"].get<uint64_t>() + 7) / 8 * 8;
            }
            task.advance(0);
        }
    document.erase("buffers");
    if (!binary.empty())
        document["buffers"].push_back({{"byteLength", binary.size()}});
    if (filled)
        document["buffers"].push_back(
            {{"byteLength", filled},
             {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    const std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
    return glb_file(text, binary);
}

Bytes GltfScene::single(size_t mesh, Task &task) const
{
    return well_formed([&] {
        json document = inside_->root;
        for (const char *name : {"animations", "skins", "cameras", "extensions", "extras"})
            document.erase(name);
        document["nodes"] = json::array({{{"mesh", mesh}}});
        document["scenes"] = json::array({{{"nodes", {0}}}});
        document["scene"] = 0;
        return inside_->file(std::move(document), task);
    });
}

static void place_asset(json &document, size_t node, size_t asset, const double anchor[3])
{
    const json extension = {{asset_extension, {{"asset", asset}}}};
    document["nodes"][node].erase("mesh");
    if (anchor[0] == 0 && anchor[1] == 0 && anchor[2] == 0) {
        document["nodes"][node]["extensions"].update(extension);
        return;
    }
    document["nodes"][node]["children"].push_back(document["nodes"].size());
    document["nodes"].push_back({{"translation", {anchor[0], anchor[1], anchor[2]}},
                                 {"extensions", extension}});
}

Bytes GltfScene::placed(const Vector<ScenePlacement> &placements, Task &task) const
{
    return well_formed([&] {
        json document = inside_->root;
        json &assets = document["extensions"][asset_extension]["assets"];
        Vector<size_t> number(meshes_.size(), SIZE_MAX); /* of the placement of a mesh */
        const size_t before = assets.size();
        for (size_t i = 0; i < placements.size(); ++i) {
            number[placements[i].mesh] = i;
            assets.push_back({{"uri", placements[i].uri}});
        }
        const size_t nodes = document.contains("nodes") ? document["nodes"].size() : 0;
        for (size_t i = 0; i < nodes; ++i) {
            const size_t mesh = document["nodes"][i].value("mesh", SIZE_MAX);
            if (mesh < number.size() && number[mesh] != SIZE_MAX)
                place_asset(document, i, before + number[mesh], placements[number[mesh]].anchor);
        }
        if (!before && placements.empty()) {
            document["extensions"].erase(asset_extension);
            if (document["extensions"].empty())
                document.erase("extensions");
        } else {
            json &used = document["extensionsUsed"];
            if (std::find(used.begin(), used.end(), asset_extension) == used.end())
                used.push_back(asset_extension);
        }
        return inside_->file(std::move(document), task);
    });
}

} // namespace gtx
