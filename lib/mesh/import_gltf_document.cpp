/* glTF and GLB containers: the JSON, made safe for tinygltf, and the buffers behind it. */
#define TINYGLTF_IMPLEMENTATION
#include "mesh/import_gltf.hpp"

#include "base/bytes.h"

#include <filesystem>
#include <nlohmann/json.hpp>

namespace gtx {

using nlohmann::json;

/* tinygltf walks extras and extensions recursively. */
static const int max_json_depth = 100;

static const char *const known_extensions[] = {
    "KHR_draco_mesh_compression", "KHR_mesh_quantization", "KHR_texture_transform",
    "KHR_texture_basisu",         "EXT_texture_webp",      "EXT_texture_avif",
    "KHR_lights_punctual",        "EXT_mesh_features",     "EXT_structural_metadata",
};

/* What a document may hold that has no place in a mesh, and is not read. */
static const struct {
    const char *key, *warning;
} unread[] = {
    {"images", "textures were ignored"},    {"textures", nullptr},
    {"samplers", nullptr},                  {"animations", "animations were ignored"},
    {"skins", "skins were ignored"},        {"cameras", "cameras were ignored"},
    {"extensions", nullptr},                {"extras", nullptr},
    {"buffers", nullptr},
};

static bool is_known(const std::string &extension)
{
    for (const char *known : known_extensions)
        if (extension == known)
            return true;
    return extension.rfind("KHR_materials_", 0) == 0; /* appearance alone */
}

/* ---- the container ---- */

namespace {
struct Container {
    std::string_view json, binary;
    bool has_binary = false;
};
} // namespace

static Container split_glb(std::string_view bytes)
{
    auto word = [&](size_t at) {
        return gtx_load_u32(reinterpret_cast<const uint8_t *>(bytes.data()) + at);
    };
    if (bytes.size() < 20)
        fail(GTX_ERROR_INPUT, "a GLB file of %zu bytes ends in its header", bytes.size());
    if (word(4) != 2)
        fail(GTX_ERROR_UNSUPPORTED, "GLB version %u is not 2", word(4));
    size_t size = word(8);
    if (size > bytes.size())
        fail(GTX_ERROR_INPUT, "the GLB header promises %zu bytes, the file has %zu", size,
             bytes.size());
    Container out;
    bool has_json = false;
    for (size_t at = 12; at + 8 <= size;) {
        size_t length = word(at), type = word(at + 4);
        if (length > size - at - 8)
            fail(GTX_ERROR_INPUT, "the GLB chunk at byte %zu does not fit the file", at);
        std::string_view chunk = bytes.substr(at + 8, length);
        if (!has_json && type != 0x4e4f534a)
            fail(GTX_ERROR_INPUT, "the first GLB chunk is not JSON");
        if (!has_json) {
            out.json = chunk;
            has_json = true;
        } else if (!out.has_binary && type == 0x004e4942) {
            out.binary = chunk;
            out.has_binary = true;
        }
        at += 8 + length;
    }
    if (!has_json)
        fail(GTX_ERROR_INPUT, "the GLB file has no JSON chunk");
    return out;
}

/* ---- the JSON ---- */

static json parse_json(std::string_view text)
{
    auto check_depth = [](int depth, json::parse_event_t, json &) {
        if (depth > max_json_depth)
            fail(GTX_ERROR_LIMIT, "the JSON is nested more than %d levels deep", max_json_depth);
        return true;
    };
    if (text.size() > size_t(1) << 31)
        fail(GTX_ERROR_LIMIT, "the JSON is larger than 2 GiB");
    try {
        json root = json::parse(text.begin(), text.end(), check_depth);
        if (!root.is_object())
            fail(GTX_ERROR_INPUT, "the JSON is not an object");
        return root;
    } catch (const json::exception &e) { /* "[json.exception.parse_error.101] parse error at ..." */
        std::string what = e.what();
        size_t tag = what.find("] ");
        fail(GTX_ERROR_INPUT, "the JSON is malformed: %.150s",
             what.c_str() + (tag == std::string::npos ? 0 : tag + 2));
    }
}

/* An array of objects, or nothing. */
static json *objects(json &root, const char *key)
{
    auto found = root.find(key);
    if (found == root.end())
        return nullptr;
    if (!found->is_array())
        fail(GTX_ERROR_INPUT, "'%s' is not an array", key);
    for (const json &item : *found)
        if (!item.is_object())
            fail(GTX_ERROR_INPUT, "'%s' holds something that is not an object", key);
    return &*found;
}

static void check_version_and_extensions(json &root, Task &task)
{
    json asset = root.value("asset", json::object());
    std::string version =
        asset.is_object() && asset.contains("version") && asset["version"].is_string()
            ? asset["version"].get<std::string>()
            : "";
    if (version.empty())
        fail(GTX_ERROR_INPUT, "the glTF has no asset version");
    if (version.rfind("2.", 0) != 0)
        fail(GTX_ERROR_UNSUPPORTED, "glTF version %s is not 2", printable(version).c_str());
    std::string ignored;
    for (const char *key : {"extensionsRequired", "extensionsUsed"}) {
        json names = root.value(key, json::array());
        if (!names.is_array())
            fail(GTX_ERROR_INPUT, "'%s' is not an array", key);
        for (const json &name : names) {
            if (!name.is_string())
                fail(GTX_ERROR_INPUT, "'%s' holds something that is not a string", key);
            if (is_known(name))
                continue;
            std::string text = printable(name.get<std::string>());
            if (!std::strcmp(key, "extensionsRequired"))
                fail(GTX_ERROR_UNSUPPORTED, "the model requires the glTF extension %s",
                     text.c_str());
            if (ignored.size() < 200)
                ignored += (ignored.empty() ? "" : ", ") + text;
        }
    }
    if (!ignored.empty())
        task.warnings.push_back("glTF extensions were ignored: " + ignored);
}

/* Takes off what tinygltf 2.7 would read without need or without care: it opens every URI of the
 * document, and it decodes Draco without checking a single number. */
static void strip(json &root, Task &task)
{
    for (const auto &item : unread) {
        auto found = root.find(item.key);
        if (found == root.end())
            continue;
        if (item.warning && found->is_array() && !found->empty())
            task.warnings.push_back(item.warning);
        root.erase(found);
    }
    bool has_targets = false;
    for (const char *key : {"bufferViews", "accessors", "nodes", "scenes", "materials"})
        objects(root, key);
    json *meshes = objects(root, "meshes");
    for (size_t i = 0; meshes && i < meshes->size(); ++i) {
        json *primitives = objects((*meshes)[i], "primitives");
        for (size_t k = 0; primitives && k < primitives->size(); ++k) {
            json &primitive = (*primitives)[k];
            has_targets |= primitive.erase("targets") > 0;
            /* Indices inside the Draco data have no buffer view, which tinygltf insists on. */
            auto extensions = primitive.find("extensions");
            if (extensions != primitive.end() && extensions->is_object() &&
                extensions->contains("KHR_draco_mesh_compression"))
                primitive.erase("indices");
        }
    }
    if (has_targets)
        task.warnings.push_back("morph targets were ignored");
}

static bool keep_no_image(tinygltf::Image *, const int, std::string *, std::string *, int, int,
                          const unsigned char *, int, void *)
{
    return true;
}

static tinygltf::Model load_model(const json &root)
{
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning, text = root.dump();
    loader.SetImageLoader(keep_no_image, nullptr);
    bool good;
    try {
        good = loader.LoadASCIIFromString(&model, &error, &warning, text.c_str(),
                                          unsigned(text.size()), "");
    } catch (const std::bad_alloc &) {
        throw;
    } catch (const std::exception &e) {
        good = false;
        error = e.what();
    }
    if (!good)
        fail(GTX_ERROR_INPUT, "the glTF is malformed: %.150s",
             error.substr(0, error.find('\n')).c_str());
    return model;
}

/* ---- buffers ---- */

static int hex(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

static std::string percent_decoded(std::string_view uri)
{
    std::string out;
    for (size_t i = 0; i < uri.size(); ++i) {
        bool escaped = uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 &&
                       hex(uri[i + 2]) >= 0;
        out += escaped ? char(hex(uri[i + 1]) * 16 + hex(uri[i + 2])) : uri[i];
        i += escaped ? 2 : 0;
    }
    return out;
}

static std::string base64_decoded(std::string_view text, size_t buffer)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    int8_t value[256];
    std::fill(value, value + 256, int8_t(-1));
    for (int i = 0; i < 64; ++i)
        value[(unsigned char)digits[i]] = int8_t(i);
    while (!text.empty() && text.back() == '=')
        text.remove_suffix(1);
    std::string out;
    out.reserve(text.size() / 4 * 3 + 3);
    uint32_t bits = 0;
    int count = 0;
    for (unsigned char c : text) {
        if (value[c] < 0)
            fail(GTX_ERROR_INPUT, "buffer %zu: its data URI is not base64", buffer);
        bits = bits << 6 | uint32_t(value[c]);
        count += 6;
        if (count >= 8) {
            count -= 8;
            out += char(bits >> count & 255);
        }
    }
    return out;
}

/* A file beside the model or in a folder below it, nothing else: a model from elsewhere must not
 * make the cooker read the machine's other files. */
static std::string file_beside(const ModelFile &file, const std::string &uri, size_t buffer)
{
    std::string path = percent_decoded(uri);
    bool outside = path.empty() || path.find_first_of(std::string(":\\\0", 3)) != std::string::npos;
    std::filesystem::path relative(outside ? std::string() : path);
    outside |= relative.is_absolute();
    for (const auto &part : relative)
        outside |= part == "..";
    if (outside)
        fail(GTX_ERROR_INPUT, "buffer %zu: '%s' is not a file in the model's folder", buffer,
             printable(uri).c_str());
    return (std::filesystem::path(file.path).parent_path() / relative).string();
}

static std::string read_buffer(const ModelFile &file, const json &buffer, size_t number,
                               const Container &container)
{
    auto length = buffer.find("byteLength");
    if (length == buffer.end() || !length->is_number_unsigned())
        fail(GTX_ERROR_INPUT, "buffer %zu has no byteLength", number);
    auto uri = buffer.find("uri");
    std::string bytes;
    if (uri == buffer.end()) {
        if (number == 0 && container.has_binary)
            bytes = container.binary;
        else /* legal when only an extension fills it; who reads it finds it too short */
            return {};
    } else if (!uri->is_string()) {
        fail(GTX_ERROR_INPUT, "buffer %zu: its uri is not a string", number);
    } else {
        const std::string &text = uri->get_ref<const std::string &>();
        size_t comma = text.find(',');
        if (text.rfind("data:", 0) != 0) {
            std::string path = file_beside(file, text, number);
            try {
                bytes = read_whole_file(path);
            } catch (const Error &e) {
                fail(e.result, "buffer %zu: '%s': %s", number, printable(text).c_str(), e.what());
            }
            if (file.sources)
                file.sources->push_back(path);
        } else if (comma == std::string::npos || comma < 7 ||
                   text.compare(comma - 7, 7, ";base64") != 0) {
            fail(GTX_ERROR_INPUT, "buffer %zu: its data URI is not base64", number);
        } else {
            bytes = base64_decoded(std::string_view(text).substr(comma + 1), number);
        }
    }
    uint64_t wanted = length->get<uint64_t>();
    if (wanted > bytes.size())
        fail(GTX_ERROR_INPUT, "buffer %zu has %zu of its %llu bytes", number, bytes.size(),
             (unsigned long long)wanted);
    bytes.resize(size_t(wanted));
    return bytes;
}

GltfDocument read_gltf_document(const ModelFile &file, Task &task)
{
    Container container;
    container.json = file.bytes;
    if (container.json.substr(0, 4) == "glTF")
        container = split_glb(file.bytes);
    json root = parse_json(container.json);
    check_version_and_extensions(root, task);

    GltfDocument doc;
    uint64_t total = file.bytes.size();
    json *buffers = objects(root, "buffers");
    for (size_t i = 0; buffers && i < buffers->size(); ++i) {
        doc.buffers.push_back(read_buffer(file, (*buffers)[i], i, container));
        total += doc.buffers.back().size();
        task.advance(0.1 + 0.1 * double(i) / double(buffers->size()));
    }
    doc.triangle_limit = (uint64_t(1) << 24) + 64 * total;
    strip(root, task);
    doc.model = load_model(root);
    return doc;
}

} // namespace gtx
