/* GLB files: what lies in the buffer, and the two chunks. */
#include "export/glb.hpp"

#include "mesh/glb.hpp"

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

Bytes GlbBuffer::file(const Json &json)
{
    check_written(json);
    const Bytes out = glb_file({json.text, json.size}, bytes_);
    Bytes().swap(bytes_);
    return out;
}

} // namespace gtx
