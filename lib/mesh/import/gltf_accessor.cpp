/* glTF accessors: every one checked against its view and its buffer before a byte is read. */
#include "mesh/import/gltf.hpp"

#include "base/bytes.h"

namespace gtx {

/* `count` items of `size` bytes, `stride` apart from `offset` on, lie within `total` bytes. */
static bool fits(uint64_t offset, uint64_t count, uint64_t stride, uint64_t size, uint64_t total)
{
    uint64_t last;
    if (count == 0)
        return true;
    return gtx_mul_u64(count - 1, stride, &last) && gtx_add_u64(last, offset, &last) &&
           gtx_add_u64(last, size, &last) && last <= total;
}

std::string_view gltf_view(const GltfDocument &doc, int view, const std::string &user)
{
    if (view < 0 || size_t(view) >= doc.model.bufferViews.size())
        fail(GTX_ERROR_INPUT, "%s: there is no buffer view %d", user.c_str(), view);
    const tinygltf::BufferView &v = doc.model.bufferViews[size_t(view)];
    if (v.extensions.count("EXT_meshopt_compression"))
        return doc.views[size_t(view)];
    if (v.buffer < 0 || size_t(v.buffer) >= doc.buffers.size())
        fail(GTX_ERROR_INPUT, "buffer view %d: there is no buffer %d", view, v.buffer);
    const std::string_view buffer = doc.buffers[size_t(v.buffer)].view();
    if (!fits(v.byteOffset, 1, 0, v.byteLength, buffer.size()))
        fail(GTX_ERROR_INPUT, "buffer view %d lies outside buffer %d of %zu bytes", view, v.buffer,
             buffer.size());
    return buffer.substr(v.byteOffset, v.byteLength);
}

double gltf_component(const uint8_t *p, int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return int8_t(p[0]);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return p[0];
    case TINYGLTF_COMPONENT_TYPE_SHORT: return int16_t(gtx_load_u16(p));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return gtx_load_u16(p);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return gtx_load_u32(p);
    default: return double(gtx_load_f32(p));
    }
}

unsigned gltf_component_size(int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
    default: return 0;
    }
}

double gltf_full_value(int type, bool normalized)
{
    if (!normalized)
        return 1;
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return 127;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 255;
    case TINYGLTF_COMPONENT_TYPE_SHORT: return 32767;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 65535;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return 4294967295.0;
    default: return 1;
    }
}

static const tinygltf::Accessor &find_accessor(const GltfDocument &doc, int number)
{
    if (number < 0 || size_t(number) >= doc.model.accessors.size())
        fail(GTX_ERROR_INPUT, "there is no accessor %d", number);
    const tinygltf::Accessor &a = doc.model.accessors[size_t(number)];
    if (!gltf_component_size(a.componentType))
        fail(GTX_ERROR_INPUT, "accessor %d: %d is not a component type", number, a.componentType);
    if (a.type != TINYGLTF_TYPE_SCALAR &&
        (a.type < TINYGLTF_TYPE_VEC2 || a.type > TINYGLTF_TYPE_VEC4))
        fail(GTX_ERROR_INPUT, "accessor %d is neither a scalar nor a vector", number);
    return a;
}

static int components_of(const tinygltf::Accessor &a)
{
    return a.type == TINYGLTF_TYPE_SCALAR ? 1 : a.type - TINYGLTF_TYPE_VEC2 + 2;
}

/* Integers of a sparse accessor's list of places, increasing and below `limit`. */
static Vector<uint32_t> sparse_places(const GltfDocument &doc, const tinygltf::Accessor &a,
                                      const std::string &user)
{
    int type = a.sparse.indices.componentType;
    size_t size = gltf_component_size(type);
    std::string_view bytes = gltf_view(doc, a.sparse.indices.bufferView, user);
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        fail(GTX_ERROR_INPUT, "%s: its sparse indices are not unsigned integers", user.c_str());
    if (a.sparse.count < 0 || a.sparse.indices.byteOffset < 0 ||
        !fits(uint64_t(a.sparse.indices.byteOffset), uint64_t(a.sparse.count), size, size,
              bytes.size()))
        fail(GTX_ERROR_INPUT, "%s: its sparse indices lie outside their buffer view", user.c_str());
    Vector<uint32_t> places;
    auto data = reinterpret_cast<const uint8_t *>(bytes.data()) + a.sparse.indices.byteOffset;
    for (size_t i = 0; i < size_t(a.sparse.count); ++i) {
        double place = gltf_component(data + i * size, type);
        if (place >= double(a.count))
            fail(GTX_ERROR_INPUT, "%s: sparse index %.0f of %zu values", user.c_str(), place,
                 a.count);
        places.push_back(uint32_t(place));
    }
    return places;
}

static void substitute_sparse(const GltfDocument &doc, const tinygltf::Accessor &a, double full,
                              const std::string &user, GltfValues &out)
{
    Vector<uint32_t> places = sparse_places(doc, a, user);
    std::string_view bytes = gltf_view(doc, a.sparse.values.bufferView, user);
    size_t size = gltf_component_size(a.componentType), item = size * size_t(out.components);
    if (a.sparse.values.byteOffset < 0 ||
        !fits(uint64_t(a.sparse.values.byteOffset), places.size(), item, item, bytes.size()))
        fail(GTX_ERROR_INPUT, "%s: its sparse values lie outside their buffer view", user.c_str());
    auto data = reinterpret_cast<const uint8_t *>(bytes.data()) + a.sparse.values.byteOffset;
    for (size_t i = 0; i < places.size(); ++i)
        for (size_t k = 0; k < size_t(out.components); ++k)
            out.values[places[i] * size_t(out.components) + k] =
                gltf_component(data + i * item + k * size, a.componentType) / full;
}

GltfValues gltf_values(const GltfDocument &doc, int accessor)
{
    const tinygltf::Accessor &a = find_accessor(doc, accessor);
    std::string user = "accessor " + std::to_string(accessor);
    GltfValues out;
    out.components = components_of(a);
    out.count = a.count;
    size_t components = size_t(out.components), size = gltf_component_size(a.componentType);
    double full = gltf_full_value(a.componentType, a.normalized);
    if (a.bufferView >= 0) {
        std::string_view bytes = gltf_view(doc, a.bufferView, user);
        size_t stride = doc.model.bufferViews[size_t(a.bufferView)].byteStride;
        stride = stride ? stride : size * components;
        if (stride < size * components ||
            !fits(a.byteOffset, a.count, stride, size * components, bytes.size()))
            fail(GTX_ERROR_INPUT, "%s: %zu values lie outside buffer view %d of %zu bytes",
                 user.c_str(), a.count, a.bufferView, bytes.size());
        auto data = reinterpret_cast<const uint8_t *>(bytes.data()) + a.byteOffset;
        out.values.reserve(a.count * components);
        for (size_t i = 0; i < a.count; ++i)
            for (size_t k = 0; k < components; ++k)
                out.values.push_back(gltf_component(data + i * stride + k * size, a.componentType) /
                                     full);
    } else {
        if (a.count > MAX_VERTICES)
            fail(GTX_ERROR_INPUT, "%s: %zu zeros are more than 32 bits can count", user.c_str(),
                 a.count);
        out.values.assign(a.count * components, 0);
    }
    if (a.sparse.isSparse)
        substitute_sparse(doc, a, full, user, out);
    return out;
}

Vector<uint32_t> gltf_indices(const GltfDocument &doc, int accessor, size_t vertices)
{
    const tinygltf::Accessor &a = find_accessor(doc, accessor);
    bool integers = a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                    a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                    a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!integers || a.type != TINYGLTF_TYPE_SCALAR || a.normalized)
        fail(GTX_ERROR_INPUT, "accessor %d: indices must be unsigned integers", accessor);
    GltfValues from = gltf_values(doc, accessor);
    Vector<uint32_t> out;
    out.reserve(from.count);
    for (size_t i = 0; i < from.count; ++i) {
        if (from.values[i] >= double(vertices))
            fail(GTX_ERROR_INPUT, "accessor %d: index %zu is vertex %.0f of %zu", accessor, i,
                 from.values[i], vertices);
        out.push_back(uint32_t(from.values[i]));
    }
    return out;
}

} // namespace gtx
