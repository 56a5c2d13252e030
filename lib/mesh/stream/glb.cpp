/* GLB in pieces, where its accessors are plain: arrays in the file's own binary chunk. */
#include "mesh/import/gltf.hpp"
#include "mesh/material/srgb.hpp"
#include "mesh/stream/paged.hpp"

#include "base/bytes.h"

#include <algorithm>
#include <filesystem>

namespace gtx {

namespace {

/* An accessor whose values lie in the file, checked to lie inside the chunk. */
struct Values {
    uint64_t first = 0, count = 0, stride = 0;
    unsigned components = 0;     /* 0: there is none */
    int type = 0;
    double full = 1;
};

/* A primitive in one of the places where its mesh stands. */
struct Part {
    Values position, normal, color, index;
    bool indexed = false;
    float factor[4] = {1, 1, 1, 1};
    Turn turn{Affine()};

    uint64_t triangles() const { return (indexed ? index.count : position.count) / 3; }
};

unsigned size_of(int type)
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

double component(const uint8_t *p, int type)
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

class GlbStream : public TriangleStream {
public:
    GlbStream(const std::string &path, Task &task) : file_(path, task), task_(task) {}
    /* Whether all of it can be read in pieces. */
    bool suits();
    CornerTraits traits() const override { return traits_; }
    void read(const TriangleSink &sink) override
    {
        for (const Part &part : parts_)
            read_part(part, sink);
    }

private:
    bool find_chunks(Bytes &json);
    bool find_values(const tinygltf::Model &model, int accessor, Values &out);
    bool find_part(const GltfDocument &doc, const tinygltf::Primitive &from, Part &out);
    void values(const Values &from, uint64_t item, double *out);
    Corner corner(const Part &part, uint64_t vertex);
    void read_part(const Part &part, const TriangleSink &sink);

    PagedFile file_;
    Task &task_;
    uint64_t binary_ = 0, binary_size_ = 0;
    CornerTraits traits_;
    Vector<Part> parts_;
};

/* Malformed containers are left to the importer, which says what is wrong. */
bool GlbStream::find_chunks(Bytes &json)
{
    uint8_t head[20];
    if (file_.size() < sizeof head)
        return false;
    file_.read(0, head, sizeof head);
    const uint64_t size = gtx_load_u32(head + 8), length = gtx_load_u32(head + 12);
    if (gtx_load_u32(head + 4) != 2 || gtx_load_u32(head + 16) != 0x4e4f534a ||
        size > file_.size() || 20 + length > size)
        return false;
    json.resize(size_t(length));
    file_.read(20, &json[0], json.size());
    const uint64_t next = 20 + length;
    if (next + 8 > size)
        return false;
    file_.read(next, head, 8);
    binary_ = next + 8;
    binary_size_ = gtx_load_u32(head);
    return gtx_load_u32(head + 4) == 0x004e4942 && binary_size_ <= size - binary_;
}

bool GlbStream::find_values(const tinygltf::Model &model, int accessor, Values &out)
{
    if (accessor < 0 || size_t(accessor) >= model.accessors.size())
        return false;
    const tinygltf::Accessor &a = model.accessors[size_t(accessor)];
    if (a.sparse.isSparse || a.bufferView < 0 || size_t(a.bufferView) >= model.bufferViews.size() ||
        !size_of(a.componentType) ||
        (a.type != TINYGLTF_TYPE_SCALAR &&
         (a.type < TINYGLTF_TYPE_VEC2 || a.type > TINYGLTF_TYPE_VEC4)))
        return false;
    const tinygltf::BufferView &v = model.bufferViews[size_t(a.bufferView)];
    out.components = a.type == TINYGLTF_TYPE_SCALAR ? 1 : unsigned(a.type);
    out.type = a.componentType;
    out.full = gltf_full_value(a.componentType, a.normalized);
    out.count = a.count;
    const uint64_t item = size_of(out.type) * out.components;
    out.stride = v.byteStride ? v.byteStride : item;
    out.first = binary_ + v.byteOffset + a.byteOffset;
    uint64_t last;
    return v.buffer == 0 && v.extensions.empty() && out.stride >= item &&
           v.byteOffset <= binary_size_ && v.byteLength <= binary_size_ - v.byteOffset &&
           (!out.count || (gtx_mul_u64(out.count - 1, out.stride, &last) &&
                           gtx_add_u64(last, a.byteOffset, &last) && item <= v.byteLength &&
                           last <= v.byteLength - item));
}

bool GlbStream::find_part(const GltfDocument &doc, const tinygltf::Primitive &from, Part &out)
{
    auto find = [&](const char *name, Values &to) {
        auto at = from.attributes.find(name);
        return at == from.attributes.end() ||
               (find_values(doc.model, at->second, to) && to.components >= 3);
    };
    if (from.mode != TINYGLTF_MODE_TRIANGLES || !from.extensions.empty() ||
        !find("POSITION", out.position) || !find("NORMAL", out.normal) ||
        !find("COLOR_0", out.color) || out.position.components != 3)
        return false;
    out.indexed = from.indices >= 0;
    if (out.indexed && (!find_values(doc.model, from.indices, out.index) ||
                        out.index.components != 1 ||
                        out.index.type == TINYGLTF_COMPONENT_TYPE_FLOAT))
        return false;
    for (const Values *v : {&out.normal, &out.color})
        if (v->components && v->count != out.position.count)
            return false;
    if (from.material >= 0 && size_t(from.material) >= doc.look.materials.size())
        return false;
    if (from.material >= 0)
        std::copy_n(doc.look.materials[size_t(from.material)].look.color, 4, out.factor);
    return true;
}

static bool is_still(const Affine &t)
{
    return t.offset == Vec3d() && t.column[0] == Vec3d(1, 0, 0) &&
           t.column[1] == Vec3d(0, 1, 0) && t.column[2] == Vec3d(0, 0, 1);
}

bool GlbStream::suits()
{
    Bytes json;
    if (!find_chunks(json))
        return false;
    const GltfDocument doc = read_gltf_outline(json, task_);
    bool textured = false;
    for (const GltfMaterial &m : doc.look.materials)
        for (Texture Material::*map : MATERIAL_TEXTURES)
            textured |= (m.look.*map).used();
    if (textured || !doc.model.extensionsRequired.empty())
        return false;
    for (const tinygltf::Node &node : doc.model.nodes)
        if (node.extensions.count("EXT_mesh_gpu_instancing"))
            return false;
    const Vector<Vector<Affine>> instances = gltf_instances(doc);
    uint64_t triangles = 0;
    for (size_t m = 0; m < instances.size(); ++m)
        for (const tinygltf::Primitive &primitive : doc.model.meshes[m].primitives)
            for (const Affine &place : instances[m]) {
                Part part;
                if (!find_part(doc, primitive, part))
                    return false;
                part.turn = Turn(place);
                traits_.add({!is_still(place), part.normal.components != 0,
                             part.color.components != 0 ||
                                 std::any_of(part.factor, part.factor + 4,
                                             [](float f) { return f != 1; }),
                             false});
                task_.limits.require(GTX_LIMITED_TRIANGLES, "the model",
                                     triangles += part.triangles());
                parts_.push_back(part);
            }
    return true;
}

void GlbStream::values(const Values &from, uint64_t item, double *out)
{
    uint8_t bytes[16];
    const unsigned size = size_of(from.type);
    file_.read(from.first + item * from.stride, bytes, size * from.components);
    for (unsigned k = 0; k < from.components; ++k)
        out[k] = component(bytes + k * size, from.type) / from.full;
}

Corner GlbStream::corner(const Part &part, uint64_t vertex)
{
    Corner out;
    double v[4];
    values(part.position, vertex, v);
    out.position = part.turn.transform.point({v[0], v[1], v[2]});
    if (part.normal.components) {
        values(part.normal, vertex, v);
        out.normal = part.turn.normal(Vec3f(float(v[0]), float(v[1]), float(v[2])));
    }
    double light[4] = {1, 1, 1, 1};
    if (part.color.components)
        values(part.color, vertex, light);
    if (traits_.colors)
        out.color = {linear_to_srgb(float(light[0] * part.factor[0])),
                     linear_to_srgb(float(light[1] * part.factor[1])),
                     linear_to_srgb(float(light[2] * part.factor[2])),
                     to_byte(light[3] * part.factor[3])};
    return out;
}

void GlbStream::read_part(const Part &part, const TriangleSink &sink)
{
    for (uint64_t t = 0; t < part.triangles(); ++t) {
        uint64_t vertex[3] = {3 * t, 3 * t + 1, 3 * t + 2};
        for (uint64_t &v : vertex) {
            double index = 0;
            if (part.indexed)
                values(part.index, v, &index);
            v = part.indexed ? uint64_t(index) : v;
            if (v >= part.position.count)
                fail(GTX_ERROR_INPUT, "triangle %llu: vertex %llu of %llu", (unsigned long long)t,
                     (unsigned long long)v, (unsigned long long)part.position.count);
        }
        if (part.turn.mirrors)
            std::swap(vertex[1], vertex[2]);
        sink({corner(part, vertex[0]), corner(part, vertex[1]), corner(part, vertex[2])});
        if (t % 0x8000 == 0)
            task_.advance(double(t) / double(part.triangles()));
    }
}

} // namespace

std::unique_ptr<TriangleStream> open_glb_stream(const std::string &path, Task &task)
{
    std::ifstream file(path, std::ios::binary);
    char magic[4] = {};
    file.read(magic, sizeof magic);
    if (std::string_view(magic, sizeof magic) != "glTF")
        return nullptr;
    const size_t before = task.warnings.size();
    auto stream = std::make_unique<GlbStream>(path, task);
    if (stream->suits())
        return stream;
    task.warnings.resize(before); /* the importer says them again */
    return nullptr;
}

} // namespace gtx
