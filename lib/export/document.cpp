/* The buffer of an export: vertices, triangles, images, the asset. */
#include "export/document.hpp"

#include "base/bytes.h"
#include "image/image.h"

#include <algorithm>
#include <cstdlib>

namespace gtx {

/* ---- buffers ---- */

static std::string_view view_of(const Vector<uint8_t> &bytes)
{
    return {reinterpret_cast<const char *>(bytes.data()), bytes.size()};
}

static void bound(GlbBuffer::Accessor &accessor, const Vec3f &p)
{
    for (int k = 0; k < 3; ++k) {
        accessor.low[k] = std::min(accessor.low[k], p[k]);
        accessor.high[k] = std::max(accessor.high[k], p[k]);
    }
}

static GlbBuffer::Accessor positions(unsigned view, size_t offset, size_t count)
{
    const Vec3f inf(INFINITY, INFINITY, INFINITY);
    return {view, offset, GLTF_FLOAT, count, "VEC3", true, inf, -inf};
}

/* The view of one page's image. */
unsigned Document::add_image(const PageImages &pages, const uint8_t *texels, TexelKind kind)
{
    if (ktx2_)
        return buffer_.add_view(encode_ktx2(pages.width, pages.height, texels, kind, task_),
                                GLTF_NO_TARGET);
    void *data = nullptr;
    size_t bytes = 0;
    gtx_error error;
    require_ok(gtx_image_encode_png(pages.width, pages.height, 3, texels, &data, &bytes, &error),
               error);
    const std::unique_ptr<void, void (*)(void *)> owner(data, std::free);
    return buffer_.add_view({static_cast<const char *>(data), bytes}, GLTF_NO_TARGET);
}

/* Images of all pages, the first one's number; the pages' memory is given back. */
unsigned Document::add_images(PageImages &pages, TexelKind kind)
{
    const unsigned first = unsigned(image_views_.size());
    const size_t size = 3 * size_t(pages.width) * pages.height;
    for (uint32_t p = 0; p < pages.pages; ++p) {
        image_views_.push_back(add_image(pages, &pages.texels[p * size], kind));
        task_.advance(double(p + 1) / pages.pages);
    }
    pages.texels = {};
    return first;
}

ExportPrimitive Document::add_primitive(const ExportMesh &mesh, size_t first, size_t last,
                                        unsigned view)
{
    const gtx_patch &patch = gtx_patches(asset_)[mesh.parts[first].patch];
    const uint32_t start = mesh.parts[first].first_vertex;
    const size_t offset = start * (meshopt_ ? EXPORT_SHORT_VERTEX : EXPORT_VERTEX);
    const GltfType unit = meshopt_ ? GLTF_SHORT : GLTF_FLOAT;
    const GltfType share = meshopt_ ? GLTF_USHORT : GLTF_FLOAT;
    size_t vertices = 0, triangles = 0;
    for (size_t i = first; i < last; ++i) {
        vertices += mesh.parts[i].vertices;
        triangles += mesh.parts[i].triangles;
    }
    GlbBuffer::Accessor place = positions(view, offset, vertices);
    for (size_t v = start; v < start + vertices; ++v)
        bound(place, mesh.vertices[v].position);
    Vector<uint8_t> bytes(12 * triangles);
    uint8_t *to = bytes.data();
    for (size_t t = 0; t < triangles; ++t)
        for (uint32_t v : mesh.triangles[mesh.parts[first].first_triangle + t]) {
            gtx_store_u32(to, v - start);
            to += 4;
        }
    ExportPrimitive out = {patch.page, (patch.flags & GTX_PATCH_TWO_SIDED) != 0, {}, 0};
    out.attributes[0] = buffer_.add_accessor(place);
    const struct {
        size_t offset;
        GltfType type;
        const char *shape;
    } others[] = {{12, unit, "VEC3"},
                  {meshopt_ ? 20u : 24u, unit, "VEC4"},
                  {meshopt_ ? 28u : 40u, share, "VEC2"}};
    for (size_t i = 0; i < 3; ++i)
        out.attributes[i + 1] =
            buffer_.add_accessor({view, offset + others[i].offset, others[i].type, vertices,
                                  others[i].shape, false, {}, {}, meshopt_});
    const unsigned indices = buffer_.add_view(view_of(bytes), GLTF_INDICES);
    out.indices = buffer_.add_accessor({indices, 0, GLTF_UINT, 3 * triangles, "SCALAR"});
    return out;
}

/* ---- Draco ---- */

/* Accessors whose values the stream has. */
void Document::add_stream(ExportPrimitive &to, const gtx_lod_mesh &lod,
                          Vector<DracoValues> &attributes, size_t vertices,
                          const Vector<std::array<uint32_t, 3>> &triangles)
{
    static const char *const shapes[] = {"", "", "VEC2", "VEC3", "VEC4"};
    constexpr float STEPS = 65535; /* of positions in an LOD mesh */
    attributes[0].low = Vec3f(lod.origin[0], lod.origin[1], lod.origin[2]);
    attributes[0].range = lod.step > 0 ? lod.step * STEPS : 1;
    const DracoStream stream = encode_draco(attributes, vertices, triangles);
    for (const DracoValues &a : attributes) {
        GlbBuffer::Accessor accessor = positions(GlbBuffer::NO_VIEW, 0, stream.vertices);
        accessor.shape = shapes[a.components];
        accessor.bounded = a.kind == DracoValues::POSITION;
        for (size_t v = 0; accessor.bounded && v < vertices; ++v)
            bound(accessor, Vec3f(a.values[3 * v], a.values[3 * v + 1], a.values[3 * v + 2]));
        to.attributes[a.kind] = buffer_.add_accessor(accessor);
    }
    to.indices = buffer_.add_accessor(
        {GlbBuffer::NO_VIEW, 0, GLTF_UINT, 3 * stream.triangles, "SCALAR"});
    to.stream = buffer_.add_view(stream.bytes, GLTF_NO_TARGET);
}

ExportPrimitive Document::add_draco(const ExportMesh &mesh, size_t first, size_t last)
{
    constexpr int POSITION_BITS = 16, FRAME_BITS = 12, SUB_TEXEL_BITS = 4;
    int texel_bits = SUB_TEXEL_BITS;
    while (texel_bits < 16 && (1u << (texel_bits - SUB_TEXEL_BITS)) <
                                  std::max(info_.page_width, info_.page_height))
        ++texel_bits;
    const gtx_patch &patch = gtx_patches(asset_)[mesh.parts[first].patch];
    const uint32_t start = mesh.parts[first].first_vertex;
    const ExportPart &end = mesh.parts[last - 1];
    const size_t vertices = end.first_vertex + end.vertices - start;
    Vector<DracoValues> attributes;
    attributes.push_back({DracoValues::POSITION, 3, {}, POSITION_BITS, {}, 0});
    attributes.push_back({DracoValues::NORMAL, 3, {}, FRAME_BITS, {}, 0});
    attributes.push_back({DracoValues::TANGENT, 4, {}, FRAME_BITS, Vec3f(-1, -1, -1), 2});
    attributes.push_back({DracoValues::TEXCOORD, 2, {}, texel_bits, {}, 1});
    for (size_t i = start; i < start + vertices; ++i) {
        const ExportVertex &v = mesh.vertices[i];
        const float numbers[][4] = {
            {v.position.x, v.position.y, v.position.z, 0},
            {v.normal.x, v.normal.y, v.normal.z, 0},
            {v.tangent.x, v.tangent.y, v.tangent.z, BITANGENT_SIGN},
            {v.texel[0] / float(info_.page_width), v.texel[1] / float(info_.page_height), 0, 0}};
        for (size_t a = 0; a < attributes.size(); ++a)
            attributes[a].values.insert(attributes[a].values.end(), numbers[a],
                                        numbers[a] + attributes[a].components);
    }
    Vector<std::array<uint32_t, 3>> triangles;
    const uint32_t after = end.first_triangle + end.triangles;
    for (uint32_t t = mesh.parts[first].first_triangle; t < after; ++t) {
        const auto &c = mesh.triangles[t];
        triangles.push_back({c[0] - start, c[1] - start, c[2] - start});
    }
    ExportPrimitive out = {patch.page, (patch.flags & GTX_PATCH_TWO_SIDED) != 0, {}, 0};
    add_stream(out, mesh.from, attributes, vertices, triangles);
    return out;
}

/* ---- levels ---- */

/* -1 to 1, or 0 to 1, as glTF's normalised whole numbers have them. */
static uint8_t *store_share(uint8_t *to, float value, float most)
{
    gtx_store_u16(to, uint16_t(int(std::lround(value * most))));
    return to + 2;
}

Vector<uint8_t> Document::vertex_bytes(const ExportMesh &mesh) const
{
    constexpr float SIGNED = 32767, UNSIGNED = 65535;
    Vector<uint8_t> bytes((meshopt_ ? EXPORT_SHORT_VERTEX : EXPORT_VERTEX) * mesh.vertices.size());
    uint8_t *to = bytes.data();
    for (const ExportVertex &v : mesh.vertices) {
        const float numbers[] = {
            v.position.x, v.position.y, v.position.z, v.normal.x, v.normal.y, v.normal.z,
            v.tangent.x, v.tangent.y, v.tangent.z, BITANGENT_SIGN,
            v.texel[0] / float(info_.page_width), v.texel[1] / float(info_.page_height)};
        constexpr size_t POSITION = 3, NORMAL = 6, TANGENT = 10, ALL = 12;
        for (size_t i = 0; i < (meshopt_ ? POSITION : ALL); ++i, to += 4)
            gtx_store_f32(to, numbers[i]);
        for (size_t i = POSITION; meshopt_ && i < ALL; ++i) {
            to = store_share(to, numbers[i], i < TANGENT ? SIGNED : UNSIGNED);
            to += i + 1 == NORMAL ? 2 : 0; /* attributes start at words */
        }
    }
    return bytes;
}

void Document::add_level(uint32_t number, const ExportMesh &mesh, unsigned coarser)
{
    const gtx_patch *patches = gtx_patches(asset_);
    DocumentLevel level = {number, double(mesh.from.error), {}, 0};
    unsigned view = GlbBuffer::NO_VIEW;
    if (!draco_)
        view = buffer_.add_view(view_of(vertex_bytes(mesh)), GLTF_VERTICES,
                                meshopt_ ? EXPORT_SHORT_VERTEX : EXPORT_VERTEX);
    auto kind = [&](size_t part) {
        const gtx_patch &p = patches[mesh.parts[part].patch];
        return std::make_pair(p.page, p.flags & GTX_PATCH_TWO_SIDED);
    };
    for (size_t first = 0, last; first < mesh.parts.size(); first = last) {
        for (last = first + 1; last < mesh.parts.size() && kind(last) == kind(first);)
            ++last;
        level.primitives.push_back(draco_ ? add_draco(mesh, first, last)
                                          : add_primitive(mesh, first, last, view));
    }
    PageImages normals = tangent_normals(asset_, mesh, coarser, task_);
    level.first_normal_image = add_images(normals, TexelKind::NORMALS);
    levels_.push_back(level);
}

/* Vertices stay shared across patches. */
void Document::add_collision(uint32_t number, const gtx_lod_mesh &lod)
{
    Vector<float> places;
    Vector<std::array<uint32_t, 3>> triangles(lod.triangle_count);
    for (size_t i = 0; i < 3 * size_t(lod.vertex_count); ++i)
        places.push_back(float(double(lod.origin[i % 3]) +
                               double(lod.step) * lod.positions[i]));
    for (size_t i = 0; i < 3 * triangles.size(); ++i)
        triangles[i / 3][i % 3] = lod.indices[i];
    ExportPrimitive p = {};
    p.stream = GlbBuffer::NO_VIEW;
    is_collision_ = true;
    if (draco_) {
        Vector<DracoValues> attributes;
        attributes.push_back({DracoValues::POSITION, 3, std::move(places), 16, {}, 0});
        add_stream(p, lod, attributes, lod.vertex_count, triangles);
    } else {
        Vector<uint8_t> bytes(4 * places.size()), corners(12 * triangles.size());
        for (size_t i = 0; i < places.size(); ++i)
            gtx_store_f32(&bytes[4 * i], places[i]);
        for (size_t i = 0; i < 3 * triangles.size(); ++i)
            gtx_store_u32(&corners[4 * i], lod.indices[i]);
        GlbBuffer::Accessor place =
            positions(buffer_.add_view(view_of(bytes), GLTF_VERTICES), 0, lod.vertex_count);
        for (size_t i = 0; i < places.size(); i += 3)
            bound(place, Vec3f(places[i], places[i + 1], places[i + 2]));
        p.attributes[0] = buffer_.add_accessor(place);
        p.indices = buffer_.add_accessor({buffer_.add_view(view_of(corners), GLTF_INDICES), 0,
                                          GLTF_UINT, 3 * triangles.size(), "SCALAR"});
    }
    levels_.push_back({number, double(lod.error), {p}, 0});
}

void Document::add_maps()
{
    maps_ = surface_images(asset_, task_);
    const struct {
        PageImages &pages;
        unsigned &image;
        TexelKind kind;
    } all[] = {{maps_.color, color_image_, TexelKind::COLOR},
               {maps_.material, material_image_, TexelKind::NUMBERS},
               {maps_.emission, emission_image_, TexelKind::COLOR}};
    for (const auto &map : all)
        if (map.pages.pages && !map.pages.constant)
            map.image = add_images(map.pages, map.kind);
    if (maps_.partly_unlit)
        task_.warn(GTX_WARNING_APPROXIMATED, "parts of the surface are unlit, which one glTF "
                                             "material cannot say: they are lit");
}

void Document::set_asset(std::string_view bytes)
{
    constexpr size_t ALIGNMENT = 64; /* as its sections are */
    asset_view_ = buffer_.add_view(bytes, GLTF_NO_TARGET, 0, ALIGNMENT);
    has_asset_ = true;
}

} // namespace gtx
