/* GLB files: what lies in the buffer, and the two chunks. */
#include "export/glb.hpp"

#include "base/bytes.h"

namespace gtx {

unsigned GlbBuffer::add_view(std::string_view bytes, GltfTarget target, size_t stride,
                             size_t alignment)
{
    bytes_.resize((bytes_.size() + alignment - 1) / alignment * alignment, '\0');
    views_.push_back({bytes_.size(), bytes.size(), stride, target});
    bytes_ += bytes;
    return unsigned(views_.size() - 1);
}

unsigned GlbBuffer::add_accessor(const Accessor &accessor)
{
    accessors_.push_back(accessor);
    return unsigned(accessors_.size() - 1);
}

static void write_bound(Json &out, const char *name, const Vec3f &bound)
{
    gtx_json_begin_array(&out, name);
    for (int k = 0; k < 3; ++k)
        gtx_json_number(&out, nullptr, double(bound[k]));
    gtx_json_end_array(&out);
}

void GlbBuffer::describe(Json &out) const
{
    gtx_json_begin_array(&out, "accessors");
    for (const Accessor &a : accessors_) {
        gtx_json_begin_object(&out, nullptr);
        gtx_json_integer(&out, "bufferView", a.view);
        gtx_json_integer(&out, "byteOffset", a.offset);
        gtx_json_integer(&out, "componentType", a.type);
        gtx_json_integer(&out, "count", a.count);
        gtx_json_string(&out, "type", a.shape);
        if (a.bounded) {
            write_bound(out, "min", a.low);
            write_bound(out, "max", a.high);
        }
        gtx_json_end_object(&out);
    }
    gtx_json_end_array(&out);
    gtx_json_begin_array(&out, "bufferViews");
    for (const View &v : views_) {
        gtx_json_begin_object(&out, nullptr);
        gtx_json_integer(&out, "buffer", 0);
        gtx_json_integer(&out, "byteOffset", v.offset);
        gtx_json_integer(&out, "byteLength", v.length);
        if (v.stride)
            gtx_json_integer(&out, "byteStride", v.stride);
        if (v.target != GLTF_NO_TARGET)
            gtx_json_integer(&out, "target", v.target);
        gtx_json_end_object(&out);
    }
    gtx_json_end_array(&out);
    gtx_json_begin_array(&out, "buffers");
    gtx_json_begin_object(&out, nullptr);
    gtx_json_integer(&out, "byteLength", bytes_.size());
    gtx_json_end_object(&out);
    gtx_json_end_array(&out);
}

static void store_word(Bytes &out, size_t word)
{
    uint8_t bytes[4];
    gtx_store_u32(bytes, uint32_t(word));
    out.append(reinterpret_cast<char *>(bytes), sizeof bytes);
}

Bytes GlbBuffer::file(const Json &json)
{
    constexpr size_t HEAD = 12, CHUNK = 8, JSON_CHUNK = 0x4e4f534a, BINARY_CHUNK = 0x004e4942;
    check_written(json);
    const size_t text = (json.size + 3) / 4 * 4, binary = (bytes_.size() + 3) / 4 * 4;
    const size_t all = HEAD + CHUNK + text + CHUNK + binary;
    if (all > UINT32_MAX)
        throw Error(GTX_ERROR_LIMIT, "the GLB would have " + std::to_string(all) +
                                         " bytes, more than its header can count");
    Bytes out;
    out.reserve(all);
    out += "glTF";
    for (size_t word : {size_t(2), all, text, JSON_CHUNK})
        store_word(out, word);
    out.append(json.text, json.size);
    out.append(text - json.size, ' ');
    store_word(out, binary);
    store_word(out, BINARY_CHUNK);
    out += bytes_;
    out.append(binary - bytes_.size(), '\0');
    Bytes().swap(bytes_);
    return out;
}

} // namespace gtx
