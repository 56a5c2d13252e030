/* glTF and GLB containers: the model that the JSON describes, and the buffers behind it. */
#define TINYGLTF_IMPLEMENTATION
#include "mesh/import/gltf.hpp"
#include "mesh/import/gltf_json.hpp"

#include "base/bytes.h"

#include <map>
#include <nlohmann/json.hpp>

namespace gtx {

using nlohmann::json;

/* ---- the container ---- */

GlbChunks split_glb(std::string_view bytes)
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
    GlbChunks out;
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

/* ---- the model ---- */

static tinygltf::Model load_model(const json &root)
{
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning, text = root.dump();
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
    if (!good || !error.empty()) /* it goes on after some errors */
        fail(GTX_ERROR_INPUT, "the glTF is malformed: %s",
             printable(error.substr(0, error.find('\n')), 150).c_str());
    return model;
}

/* ---- buffers ---- */

static Bytes base64_decoded(std::string_view text, const std::string &user)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    int8_t value[256];
    std::fill(value, value + 256, int8_t(-1));
    for (int i = 0; i < 64; ++i)
        value[(unsigned char)digits[i]] = int8_t(i);
    while (!text.empty() && text.back() == '=')
        text.remove_suffix(1);
    Bytes out;
    out.reserve(text.size() / 4 * 3 + 3);
    uint32_t bits = 0;
    int count = 0;
    for (unsigned char c : text) {
        if (value[c] < 0)
            fail(GTX_ERROR_INPUT, "%s: its data URI is not base64", user.c_str());
        bits = bits << 6 | uint32_t(value[c]);
        count += 6;
        if (count >= 8) {
            count -= 8;
            out += char(bits >> count & 255);
        }
    }
    return out;
}

Bytes data_uri_bytes(const std::string &uri, const std::string &user)
{
    size_t comma = uri.find(',');
    if (comma == std::string::npos || comma < 7 || uri.compare(comma - 7, 7, ";base64") != 0)
        fail(GTX_ERROR_INPUT, "%s: its data URI is not base64", user.c_str());
    return base64_decoded(std::string_view(uri).substr(comma + 1), user);
}

static std::string file_beside(const ModelFile &file, const std::string &uri, size_t buffer)
{
    std::string path = path_beside(file, percent_decoded(uri));
    if (path.empty())
        fail(GTX_ERROR_INPUT, "buffer %zu: '%s' is not a file in the model's folder", buffer,
             printable(uri).c_str());
    return path;
}

/* What only a reader without EXT_meshopt_compression would want. */
static bool is_fallback(const json &buffer)
{
    auto extensions = buffer.find("extensions");
    if (extensions == buffer.end())
        return false;
    auto meshopt = extensions->find("EXT_meshopt_compression");
    return meshopt != extensions->end() && meshopt->value("fallback", false);
}

using SharedBytes = std::shared_ptr<const Bytes>;

/* Buffers of a document; those that name the same file share its bytes. */
class Buffers {
public:
    Buffers(const ModelFile &file, const GlbChunks &container, Task &task)
        : file_(file), container_(container), task_(task)
    {
    }
    GltfDocument::Buffer read(const json &buffer, size_t number);

private:
    SharedBytes read_file(const std::string &uri, size_t number);
    const ModelFile &file_;
    const GlbChunks &container_;
    Task &task_;
    std::map<std::string, SharedBytes> files_; /* by path */
};

SharedBytes Buffers::read_file(const std::string &uri, size_t number)
{
    const std::string path = file_beside(file_, uri, number);
    SharedBytes &bytes = files_[path];
    if (bytes)
        return bytes;
    try {
        bytes = std::make_shared<const Bytes>(read_file_beside(path, task_));
    } catch (Error &e) {
        e.message = "buffer " + std::to_string(number) + ": '" + printable(uri) + "': " + e.message;
        throw;
    }
    if (file_.sources)
        file_.sources->push_back(path);
    return bytes;
}

GltfDocument::Buffer Buffers::read(const json &buffer, size_t number)
{
    static const SharedBytes NONE = std::make_shared<const Bytes>();
    auto length = buffer.find("byteLength"), uri = buffer.find("uri");
    if (length == buffer.end())
        fail(GTX_ERROR_INPUT, "buffer %zu has no byteLength", number);
    SharedBytes bytes;
    if (is_fallback(buffer)) {
        return {NONE, 0};
    } else if (uri == buffer.end()) {
        if (number > 0 || !container_.has_binary)
            return {NONE, 0}; /* legal when an extension fills it; else who reads it says so */
        bytes = std::make_shared<const Bytes>(container_.binary);
    } else {
        const std::string &text = uri->get_ref<const std::string &>();
        bytes = text.rfind("data:", 0) != 0
                    ? read_file(text, number)
                    : std::make_shared<const Bytes>(
                          data_uri_bytes(text, "buffer " + std::to_string(number)));
    }
    const uint64_t wanted = length->get<uint64_t>();
    if (wanted > bytes->size())
        fail(GTX_ERROR_INPUT, "buffer %zu has %zu of its %llu bytes", number, bytes->size(),
             (unsigned long long)wanted);
    return {bytes, size_t(wanted)};
}

static Vector<GltfDocument::ImageSource> read_images(const json &root)
{
    Vector<GltfDocument::ImageSource> images;
    for (const json &image : root.value("images", json::array()))
        images.push_back({image.value("uri", ""), image.value("bufferView", -1)});
    return images;
}

Vector<GltfDocument::Buffer> read_gltf_buffers(const json &root, const ModelFile &file,
                                               const GlbChunks &chunks, Task &task)
{
    Buffers reader(file, chunks, task);
    Vector<GltfDocument::Buffer> out;
    const json buffers = root.value("buffers", json::array());
    for (size_t i = 0; i < buffers.size(); ++i) {
        out.push_back(reader.read(buffers[i], i));
        task.advance(0.1 + 0.1 * double(i) / double(buffers.size()));
    }
    return out;
}

GltfDocument read_gltf_outline(std::string_view text, Task &task)
{
    json root = read_gltf_json(text, task);
    GltfDocument doc;
    doc.look = read_gltf_materials(root);
    doc.images = read_images(root);
    strip_gltf_json(root, task);
    doc.model = load_model(root);
    return doc;
}

GltfDocument read_gltf_document(const ModelFile &file, Task &task)
{
    GlbChunks container;
    container.json = file.bytes;
    if (container.json.substr(0, 4) == "glTF")
        container = split_glb(file.bytes);
    json root = read_gltf_json(container.json, task);

    GltfDocument doc;
    doc.buffers = read_gltf_buffers(root, file, container, task);
    doc.look = read_gltf_materials(root);
    doc.images = read_images(root);
    strip_gltf_json(root, task);
    doc.model = load_model(root);
    unpack_gltf_views(doc, task);
    return doc;
}

} // namespace gtx
