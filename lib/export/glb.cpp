/* GLB files: what lies in the buffer, and the two chunks. */
#include "export/glb.hpp"

#include "mesh/glb.hpp"

#include <cstring>
#include <meshoptimizer.h>

namespace gtx {

/* As EXT_meshopt_compression has it: vertices in its mode ATTRIBUTES, indices as TRIANGLES. */
void GlbBuffer::pack(View &view, std::string_view bytes)
{
    constexpr size_t INDEX = sizeof(uint32_t), POSITION = 3 * sizeof(float);
    const bool is_indices = view.target == GLTF_INDICES;
    const size_t stride = is_indices ? INDEX : view.stride ? view.stride : POSITION;
    const size_t count = bytes.size() / stride;
    view.unpacked = bytes.size();
    view.count = count;
    view.stride = stride;
    Vector<uint8_t> out;
    if (is_indices) {
        /* The extension's version; the library has one for the whole process, and 0 at first. */
        static const bool set = (meshopt_encodeIndexVersion(1), true);
        (void)set;
        Vector<uint32_t> corners(count);
        std::memcpy(corners.data(), bytes.data(), bytes.size());
        out.resize(meshopt_encodeIndexBufferBound(count, UINT32_MAX));
        out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), corners.data(), count));
    } else {
        out.resize(meshopt_encodeVertexBufferBound(count, stride));
        out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), bytes.data(), count, stride));
    }
    if (out.empty())
        throw Error(GTX_ERROR_INTERNAL, "meshoptimizer did not encode a buffer view");
    view.length = out.size();
    bytes_.append(reinterpret_cast<const char *>(out.data()), out.size());
}

unsigned GlbBuffer::add_view(std::string_view bytes, GltfTarget target, size_t stride,
                             size_t alignment)
{
    bytes_.resize((bytes_.size() + alignment - 1) / alignment * alignment, '\0');
    views_.push_back({bytes_.size(), bytes.size(), stride, target});
    if (meshopt_ && target != GLTF_NO_TARGET && !bytes.empty())
        pack(views_.back(), bytes);
    else
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
        if (a.view != NO_VIEW) {
            gtx_json_integer(&out, "bufferView", a.view);
            gtx_json_integer(&out, "byteOffset", a.offset);
        }
        gtx_json_integer(&out, "componentType", a.type);
        gtx_json_integer(&out, "count", a.count);
        gtx_json_string(&out, "type", a.shape);
        if (a.normalized)
            gtx_json_bool(&out, "normalized", true);
        if (a.bounded) {
            write_bound(out, "min", a.low);
            write_bound(out, "max", a.high);
        }
        gtx_json_end_object(&out);
    }
    gtx_json_end_array(&out);
    describe_views(out);
    describe_buffers(out);
}

/* A compressed view lies in a buffer of its own size that is not there, and says where its bytes
 * are. */
void GlbBuffer::describe_views(Json &out) const
{
    size_t unpacked = 0;
    gtx_json_begin_array(&out, "bufferViews");
    for (const View &v : views_) {
        const bool is_packed = v.unpacked > 0;
        gtx_json_begin_object(&out, nullptr);
        gtx_json_integer(&out, "buffer", is_packed);
        gtx_json_integer(&out, "byteOffset", is_packed ? unpacked : v.offset);
        gtx_json_integer(&out, "byteLength", is_packed ? v.unpacked : v.length);
        if (v.stride && v.target != GLTF_INDICES)
            gtx_json_integer(&out, "byteStride", v.stride);
        if (v.target != GLTF_NO_TARGET)
            gtx_json_integer(&out, "target", v.target);
        if (is_packed) {
            gtx_json_begin_object(&out, "extensions");
            gtx_json_begin_object(&out, "EXT_meshopt_compression");
            gtx_json_integer(&out, "buffer", 0);
            gtx_json_integer(&out, "byteOffset", v.offset);
            gtx_json_integer(&out, "byteLength", v.length);
            gtx_json_integer(&out, "byteStride", v.stride);
            gtx_json_integer(&out, "count", v.count);
            gtx_json_string(&out, "mode", v.target == GLTF_INDICES ? "TRIANGLES" : "ATTRIBUTES");
            gtx_json_end_object(&out);
            gtx_json_end_object(&out);
        }
        gtx_json_end_object(&out);
        unpacked += v.unpacked; /* of whole words */
    }
    gtx_json_end_array(&out);
}

void GlbBuffer::describe_buffers(Json &out) const
{
    size_t unpacked = 0;
    for (const View &v : views_)
        unpacked += v.unpacked;
    gtx_json_begin_array(&out, "buffers");
    gtx_json_begin_object(&out, nullptr);
    gtx_json_integer(&out, "byteLength", bytes_.size());
    gtx_json_end_object(&out);
    if (unpacked) {
        gtx_json_begin_object(&out, nullptr);
        gtx_json_integer(&out, "byteLength", unpacked);
        gtx_json_begin_object(&out, "extensions");
        gtx_json_begin_object(&out, "EXT_meshopt_compression");
        gtx_json_bool(&out, "fallback", true);
        gtx_json_end_object(&out);
        gtx_json_end_object(&out);
        gtx_json_end_object(&out);
    }
    gtx_json_end_array(&out);
}

Bytes GlbBuffer::file(const Json &json)
{
    check_written(json);
    const Bytes out = glb_file({json.text, json.size}, bytes_);
    Bytes().swap(bytes_);
    return out;
}

} // namespace gtx
