/* The asset that a GLB file holds beside its mesh (GTX_geometry_texture); writing GLB files. */
#include "mesh/glb.hpp"
#include "mesh/import/gltf_json.hpp"

#include "base/bytes.h"

#include <nlohmann/json.hpp>

namespace gtx {

using nlohmann::json;

static const char extension_name[] = "GTX_geometry_texture";

/* Null where there is none, or no object to have it. */
static const json *member(const json *object, const char *name)
{
    if (!object || !object->is_object())
        return nullptr;
    const auto found = object->find(name);
    return found == object->end() ? nullptr : &*found;
}

static uint64_t whole(const json *object, const char *name, uint64_t otherwise)
{
    const json *found = member(object, name);
    if (found && !found->is_number_unsigned())
        fail(GTX_ERROR_INPUT, "the %s of an asset in the file is not a whole number", name);
    return found ? found->get<uint64_t>() : otherwise;
}

static const json *item(const json *array, uint64_t number)
{
    return array && array->is_array() && number < array->size() ? &(*array)[number] : nullptr;
}

/* The bytes of a buffer view, which must lie in the file itself. */
static std::string_view view_bytes(const json &root, const GlbChunks &chunks, uint64_t number)
{
    const json *view = item(member(&root, "bufferViews"), number);
    const json *buffer = item(member(&root, "buffers"), 0);
    const uint64_t offset = whole(view, "byteOffset", 0), length = whole(view, "byteLength", 0);
    const bool inside = length > 0 && whole(view, "buffer", 1) == 0 && chunks.has_binary &&
                        buffer && buffer->is_object() && !member(buffer, "uri");
    if (!inside || offset > chunks.binary.size() || length > chunks.binary.size() - offset)
        fail(GTX_ERROR_INPUT, "the file's asset is not where its buffer view says");
    return chunks.binary.substr(size_t(offset), size_t(length));
}

std::string_view embedded_asset(std::string_view bytes)
{
    constexpr size_t LENGTH = 12, TEXT = 20; /* of the first chunk */
    if (bytes.substr(0, 4) != "glTF" || bytes.size() < TEXT)
        return {};
    const auto *length = reinterpret_cast<const uint8_t *>(bytes.data() + LENGTH);
    const std::string_view text = bytes.substr(TEXT, gtx_load_u32(length));
    if (text.find(extension_name) == text.npos) /* what is wrong with others is not for here */
        return {};
    const GlbChunks chunks = split_glb(bytes);
    const json root = parse_gltf_json(chunks.json);
    const json *extension = member(member(&root, "extensions"), extension_name);
    if (!extension)
        return {};
    const json *assets = member(extension, "assets");
    if (!assets || !assets->is_array())
        fail(GTX_ERROR_INPUT, "%s has no array of assets", extension_name);
    std::string_view found;
    for (const json &asset : *assets) {
        if (!member(&asset, "bufferView"))
            continue; /* a file of its own */
        if (!found.empty())
            fail(GTX_ERROR_UNSUPPORTED, "the file holds several assets");
        found = view_bytes(root, chunks, whole(&asset, "bufferView", 0));
    }
    return found;
}

static void store_word(Bytes &out, size_t word)
{
    uint8_t bytes[4];
    gtx_store_u32(bytes, uint32_t(word));
    out.append(reinterpret_cast<char *>(bytes), sizeof bytes);
}

Bytes glb_file(std::string_view json, std::string_view binary)
{
    constexpr size_t HEAD = 12, CHUNK = 8, JSON_CHUNK = 0x4e4f534a, BINARY_CHUNK = 0x004e4942;
    const size_t text = (json.size() + 3) / 4 * 4, bytes = (binary.size() + 3) / 4 * 4;
    const size_t all = HEAD + CHUNK + text + CHUNK + bytes;
    if (all > UINT32_MAX)
        fail(GTX_ERROR_LIMIT, "the GLB would have %zu bytes, more than its header can count", all);
    Bytes out;
    out.reserve(all);
    out += "glTF";
    for (size_t word : {size_t(2), all, text, JSON_CHUNK})
        store_word(out, word);
    out += json;
    out.append(text - json.size(), ' ');
    store_word(out, bytes);
    store_word(out, BINARY_CHUNK);
    out += binary;
    out.append(bytes - binary.size(), '\0');
    return out;
}

} // namespace gtx
