/* A tile's LOD mesh as plain GLB, for any viewer of 3D Tiles. */
#include "world/surface.hpp"

#include "base/bytes.h"
#include "cook/report.hpp"
#include "mesh/material/srgb.hpp"

#include <algorithm>

namespace gtx {

/* Light, as glTF wants it, in 16 bits a channel. */
static constexpr size_t VERTEX = 12 + 12 + 8;

static uint16_t light_of(double srgb)
{
    const double low = std::floor(srgb), part = srgb - low;
    const double light = srgb_to_linear(uint8_t(low)) * (1 - part) +
                         srgb_to_linear(uint8_t(std::min(low + 1, 255.))) * part;
    return uint16_t(light * 65535 + 0.5);
}

Vec3d weights_at(const Vec3d &p, const Vec3d &a, const Vec3d &b, const Vec3d &c)
{
    const Vec3d n = cross(b - a, c - a);
    const double area = dot(n, n);
    if (!(area > 0))
        return {1, 0, 0};
    Vec3d w(dot(cross(b - p, c - p), n) / area, dot(cross(c - p, a - p), n) / area, 0);
    w.x = std::clamp(w.x, 0., 1.);
    w.y = std::clamp(w.y, 0., 1 - w.x);
    w.z = 1 - w.x - w.y;
    return w;
}

static void put_vertex(const Vec3d &p, const Vec3d &middle, const TileSurface &s, uint32_t triangle,
                       uint8_t *to)
{
    const auto &t = s.triangles[triangle];
    const Vec3d w = weights_at(p, s.positions[t[0]], s.positions[t[1]], s.positions[t[2]]);
    Vec3d normal;
    double color[4] = {};
    for (int k = 0; k < 3; ++k) {
        const Rgba8 &c = s.colors[t[size_t(k)]];
        const double channels[4] = {double(c.r), double(c.g), double(c.b), double(c.a)};
        normal += Vec3d(s.normals[t[size_t(k)]]) * w[k];
        for (int i = 0; i < 4; ++i)
            color[i] += w[k] * channels[i];
    }
    normal = normalize(normal);
    if (normal == Vec3d())
        normal = {0, 1, 0};
    for (int k = 0; k < 3; ++k) {
        gtx_store_f32(to + 4 * k, float(p[k] - middle[k]));
        gtx_store_f32(to + 12 + 4 * k, float(normal[k]));
        gtx_store_u16(to + 24 + 2 * k, light_of(color[k]));
    }
    gtx_store_u16(to + 30, uint16_t(color[3] * 257 + 0.5));
}

namespace {

/* What the JSON says of the arrays. */
struct Arrays {
    size_t vertices, indices;
    Vec3d middle;
    float low[3], high[3];
};

} // namespace

static void write_accessor(Json &out, unsigned view, size_t offset, unsigned type, size_t count,
                           const char *shape, bool normalized, const Arrays *bounds)
{
    gtx_json_begin_object(&out, nullptr);
    gtx_json_integer(&out, "bufferView", view);
    gtx_json_integer(&out, "byteOffset", offset);
    gtx_json_integer(&out, "componentType", type);
    gtx_json_integer(&out, "count", count);
    gtx_json_string(&out, "type", shape);
    if (normalized)
        gtx_json_bool(&out, "normalized", true);
    for (const char *name : {"min", "max"}) {
        if (!bounds)
            break;
        gtx_json_begin_array(&out, name);
        for (int k = 0; k < 3; ++k)
            gtx_json_number(&out, nullptr, double(name[1] == 'i' ? bounds->low[k]
                                                                 : bounds->high[k]));
        gtx_json_end_array(&out);
    }
    gtx_json_end_object(&out);
}

static void write_view(Json &out, size_t offset, size_t length, size_t stride, unsigned target)
{
    gtx_json_begin_object(&out, nullptr);
    gtx_json_integer(&out, "buffer", 0);
    gtx_json_integer(&out, "byteOffset", offset);
    gtx_json_integer(&out, "byteLength", length);
    if (stride)
        gtx_json_integer(&out, "byteStride", stride);
    gtx_json_integer(&out, "target", target);
    gtx_json_end_object(&out);
}

static void write_arrays(Json &out, const Arrays &a)
{
    constexpr unsigned FLOAT = 5126, UINT = 5125, USHORT = 5123, VERTICES = 34962, INDICES = 34963;
    gtx_json_begin_array(&out, "accessors");
    write_accessor(out, 0, 0, FLOAT, a.vertices, "VEC3", false, &a);
    write_accessor(out, 0, 12, FLOAT, a.vertices, "VEC3", false, nullptr);
    write_accessor(out, 0, 24, USHORT, a.vertices, "VEC4", true, nullptr);
    write_accessor(out, 1, 0, UINT, a.indices, "SCALAR", false, nullptr);
    gtx_json_end_array(&out);
    gtx_json_begin_array(&out, "bufferViews");
    write_view(out, 0, a.vertices * VERTEX, VERTEX, VERTICES);
    write_view(out, a.vertices * VERTEX, a.indices * 4, 0, INDICES);
    gtx_json_end_array(&out);
    gtx_json_begin_array(&out, "buffers");
    gtx_json_begin_object(&out, nullptr);
    gtx_json_integer(&out, "byteLength", a.vertices * VERTEX + a.indices * 4);
    gtx_json_end_object(&out);
    gtx_json_end_array(&out);
}

static void write_mesh(Json &out, bool closed)
{
    gtx_json_begin_array(&out, "materials");
    gtx_json_begin_object(&out, nullptr);
    gtx_json_bool(&out, "doubleSided", !closed);
    gtx_json_begin_object(&out, "pbrMetallicRoughness");
    gtx_json_number(&out, "metallicFactor", 0);
    gtx_json_end_object(&out);
    gtx_json_end_object(&out);
    gtx_json_end_array(&out);
    gtx_json_begin_array(&out, "meshes");
    gtx_json_begin_object(&out, nullptr);
    gtx_json_begin_array(&out, "primitives");
    gtx_json_begin_object(&out, nullptr);
    gtx_json_begin_object(&out, "attributes");
    gtx_json_integer(&out, "POSITION", 0);
    gtx_json_integer(&out, "NORMAL", 1);
    gtx_json_integer(&out, "COLOR_0", 2);
    gtx_json_end_object(&out);
    gtx_json_integer(&out, "indices", 3);
    gtx_json_integer(&out, "material", 0);
    gtx_json_end_object(&out);
    gtx_json_end_array(&out);
    gtx_json_end_object(&out);
    gtx_json_end_array(&out);
}

static std::string json_of(const Arrays &a, bool closed)
{
    Json out(gtx_allocator{});
    gtx_json_begin_object(&out, nullptr);
    gtx_json_begin_object(&out, "asset");
    gtx_json_string(&out, "version", "2.0");
    gtx_json_string(&out, "generator", "geotex");
    gtx_json_end_object(&out);
    gtx_json_integer(&out, "scene", 0);
    gtx_json_begin_array(&out, "scenes");
    gtx_json_begin_object(&out, nullptr);
    gtx_json_begin_array(&out, "nodes");
    gtx_json_integer(&out, nullptr, 0);
    gtx_json_end_array(&out);
    gtx_json_end_object(&out);
    gtx_json_end_array(&out);
    gtx_json_begin_array(&out, "nodes");
    gtx_json_begin_object(&out, nullptr);
    gtx_json_integer(&out, "mesh", 0);
    gtx_json_begin_array(&out, "translation");
    for (int k = 0; k < 3; ++k)
        gtx_json_number(&out, nullptr, a.middle[k]);
    gtx_json_end_array(&out);
    gtx_json_end_object(&out);
    gtx_json_end_array(&out);
    write_mesh(out, closed);
    write_arrays(out, a);
    gtx_json_end_object(&out);
    check_written(out);
    return std::string(out.text, out.size);
}

static std::string chunk(uint32_t type, std::string bytes, char padding)
{
    uint8_t head[8];
    bytes.resize((bytes.size() + 3) / 4 * 4, padding);
    gtx_store_u32(head, uint32_t(bytes.size()));
    gtx_store_u32(head + 4, type);
    return std::string(reinterpret_cast<char *>(head), sizeof head) + bytes;
}

std::string glb_of(const PlainMesh &mesh, NearSurface &near, bool closed)
{
    const TileSurface &surface = near.surface();
    const size_t vertices = mesh.positions.size(), indices = 3 * mesh.triangles.size();
    Arrays arrays = {vertices, indices, (surface.header.low + surface.header.high) / 2,
                     {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    const Vector<uint32_t> nearest = near.nearest_to(mesh.positions);
    std::string bytes(vertices * VERTEX + 4 * indices, 0);
    auto *to = reinterpret_cast<uint8_t *>(&bytes[0]);
    for (size_t v = 0; v < vertices; ++v, to += VERTEX) {
        put_vertex(mesh.positions[v], arrays.middle, surface, nearest[v], to);
        for (int k = 0; k < 3; ++k) {
            arrays.low[k] = std::min(arrays.low[k], gtx_load_f32(to + 4 * k));
            arrays.high[k] = std::max(arrays.high[k], gtx_load_f32(to + 4 * k));
        }
    }
    for (const auto &t : mesh.triangles)
        for (uint32_t v : t) {
            gtx_store_u32(to, v);
            to += 4;
        }
    const std::string chunks = chunk(0x4e4f534a, json_of(arrays, closed), ' ') +
                               chunk(0x004e4942, std::move(bytes), '\0');
    uint8_t head[12] = {'g', 'l', 'T', 'F', 2};
    gtx_store_u32(head + 8, uint32_t(sizeof head + chunks.size()));
    return std::string(reinterpret_cast<char *>(head), sizeof head) + chunks;
}

} // namespace gtx
