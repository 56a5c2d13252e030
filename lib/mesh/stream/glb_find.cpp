/* Whether a GLB can be read in pieces, and where its arrays and images lie. */
#include "mesh/stream/glb.hpp"

#include "base/bytes.h"

#include <algorithm>

namespace gtx {

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
        !gltf_component_size(a.componentType) ||
        (a.type != TINYGLTF_TYPE_SCALAR &&
         (a.type < TINYGLTF_TYPE_VEC2 || a.type > TINYGLTF_TYPE_VEC4)))
        return false;
    const tinygltf::BufferView &v = model.bufferViews[size_t(a.bufferView)];
    out.components = a.type == TINYGLTF_TYPE_SCALAR ? 1 : unsigned(a.type);
    out.type = a.componentType;
    out.full = gltf_full_value(a.componentType, a.normalized);
    out.count = a.count;
    const uint64_t item = gltf_component_size(out.type) * out.components;
    out.stride = v.byteStride ? v.byteStride : item;
    out.first = binary_ + v.byteOffset + a.byteOffset;
    uint64_t last;
    return v.buffer == 0 && v.extensions.empty() && out.stride >= item &&
           v.byteOffset <= binary_size_ && v.byteLength <= binary_size_ - v.byteOffset &&
           (!out.count || (gtx_mul_u64(out.count - 1, out.stride, &last) &&
                           gtx_add_u64(last, a.byteOffset, &last) && item <= v.byteLength &&
                           last <= v.byteLength - item));
}

/* What the primitive's material looks at. */
bool GlbStream::find_look(const GltfDocument &doc, const tinygltf::Primitive &from, Part &out)
{
    auto find = [&](const std::string &name, unsigned components, Values &to) {
        auto at = from.attributes.find(name);
        return at == from.attributes.end() ||
               (find_values(doc.model, at->second, to) && to.components == components &&
                to.count == out.position.count);
    };
    if (from.material < 0)
        return true;
    if (size_t(from.material) >= doc.look.materials.size())
        return false;
    const GltfMaterial &material = doc.look.materials[size_t(from.material)];
    std::copy_n(material.look.color, 4, out.factor);
    for (size_t k = 0; k < material.sets.size(); ++k)
        if (!find("TEXCOORD_" + std::to_string(material.sets[k]), 2, out.uv[k]))
            return false;
    return !material.look.normal_map.used() || find("TANGENT", 4, out.tangent);
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
    return find_look(doc, from, out);
}

/* Data URIs take their room as the JSON does: whole. */
bool GlbStream::find_pictures(const GltfDocument &doc)
{
    for (const GltfImage &image : doc.look.images) {
        const GltfDocument::ImageSource &source = doc.images[size_t(image.number)];
        Picture out = {image};
        if (source.uri.rfind("data:", 0) == 0)
            return false;
        if (source.uri.empty()) {
            if (source.view < 0 || size_t(source.view) >= doc.model.bufferViews.size())
                return false;
            const tinygltf::BufferView &v = doc.model.bufferViews[size_t(source.view)];
            if (v.buffer != 0 || !v.extensions.empty() || v.byteOffset > binary_size_ ||
                v.byteLength > binary_size_ - v.byteOffset || !v.byteLength)
                return false;
            out.first = binary_ + v.byteOffset;
            out.size = v.byteLength;
        }
        pictures_.push_back(out);
    }
    images_.images = doc.images;
    return true;
}

static bool is_still(const Affine &t)
{
    return t.offset == Vec3d() && t.column[0] == Vec3d(1, 0, 0) &&
           t.column[1] == Vec3d(0, 1, 0) && t.column[2] == Vec3d(0, 0, 1);
}

bool GlbStream::find_parts(const GltfDocument &doc)
{
    const Vector<Vector<Affine>> instances = gltf_instances(doc);
    GltfPalette palette(doc.look, look_);
    uint64_t triangles = 0;
    for (size_t m = 0; m < instances.size(); ++m) {
        const auto &primitives = doc.model.meshes[m].primitives;
        for (size_t i = 0; i < primitives.size(); ++i)
            for (const Affine &place : instances[m]) {
                Part part;
                if (!find_part(doc, primitives[i], part))
                    return false;
                part.turn = Turn(place);
                part.material = palette.number(
                    primitives[i].material,
                    (part.uv[0].components ? 0 : 1) | (part.uv[1].components ? 0 : 2),
                    "mesh " + std::to_string(m) + " primitive " + std::to_string(i));
                traits_.doubles |= !is_still(place);
                task_.limits.require(GTX_LIMITED_TRIANGLES, "the model",
                                     triangles += part.triangles());
                parts_.push_back(part);
            }
    }
    task_.warnings.insert(task_.warnings.end(), palette.warnings.begin(), palette.warnings.end());
    return true;
}

bool GlbStream::suits()
{
    Bytes json;
    if (!find_chunks(json))
        return false;
    const GltfDocument doc = read_gltf_outline(json, task_);
    for (const tinygltf::Node &node : doc.model.nodes)
        if (node.extensions.count("EXT_mesh_gpu_instancing"))
            return false;
    if (!find_parts(doc) || !find_pictures(doc))
        return false;
    for (const Material &m : look_.materials)
        for (Texture Material::*map : MATERIAL_TEXTURES)
            traits_.textured |= (m.*map).used();
    for (Part &part : parts_) {
        const bool tinted = !traits_.textured && std::any_of(part.factor, part.factor + 4,
                                                             [](float f) { return f != 1; });
        traits_.add({false, part.normal.components != 0, tinted || part.color.components != 0,
                     false});
        if (!tinted)
            std::fill_n(part.factor, 4, 1.f);
    }
    return true;
}

} // namespace gtx
