/* glTF: one primitive's triangles and attributes, from accessors or from Draco. */
#include "mesh/import/draco.hpp"
#include "mesh/import/gltf.hpp"
#include "mesh/material/srgb.hpp"

namespace gtx {

namespace {
enum Slot { POSITION, NORMAL, COLOR, UV0, UV1, TANGENT, SLOTS };

/* What is wanted of a primitive, and what was there. */
struct Attributes {
    std::string names[SLOTS]; /* "" is not wanted */
    GltfValues values[SLOTS];
};

struct Components {
    int least, most;
};
constexpr Components COMPONENTS[SLOTS] = {{3, 3}, {3, 3}, {3, 4}, {2, 2}, {2, 2}, {4, 4}};
} // namespace

static int attribute(const tinygltf::Primitive &primitive, const std::string &name)
{
    auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

static Attributes wanted_attributes(const GltfMaterial *material)
{
    Attributes out;
    out.names[POSITION] = "POSITION";
    out.names[NORMAL] = "NORMAL";
    out.names[COLOR] = "COLOR_0";
    if (!material)
        return out;
    for (size_t i = 0; i < material->sets.size(); ++i)
        out.names[UV0 + i] = "TEXCOORD_" + std::to_string(material->sets[i]);
    if (material->look.normal_map.used())
        out.names[TANGENT] = "TANGENT";
    return out;
}

/* ---- Draco ---- */

/* One attribute of the Draco data; the accessor says whether integers are normalised. */
static GltfValues draco_values(const GltfDocument &doc, int accessor, const tinygltf::Value &ids,
                               const DracoMesh &draco, const std::string &name)
{
    if (!ids.Has(name))
        return gltf_values(doc, accessor);
    if (size_t(accessor) >= doc.model.accessors.size())
        fail(GTX_ERROR_INPUT, "there is no accessor %d", accessor);
    const tinygltf::Accessor &a = doc.model.accessors[size_t(accessor)];
    int id = ids.Get(name).GetNumberAsInt();
    for (const DracoAttribute &from : draco.attributes)
        if (from.id == uint32_t(id)) {
            GltfValues out = {from.components, draco.points, from.values};
            double full = gltf_full_value(a.componentType, a.normalized);
            for (double &v : out.values)
                v /= full;
            return out;
        }
    fail(GTX_ERROR_INPUT, "the Draco data has no attribute %d for %s", id, name.c_str());
}

static void read_draco(const GltfDocument &doc, const tinygltf::Primitive &primitive,
                       const std::string &where, Task &task, Attributes &a, GltfPrimitive &out)
{
    const tinygltf::Value &extension = primitive.extensions.at("KHR_draco_mesh_compression");
    if (!extension.Has("bufferView") || !extension.Has("attributes"))
        fail(GTX_ERROR_INPUT, "%s: KHR_draco_mesh_compression lacks its view or its attributes",
             where.c_str());
    int view = extension.Get("bufferView").GetNumberAsInt();
    const tinygltf::Value &ids = extension.Get("attributes");
    DracoMesh draco = decode_draco(gltf_view(doc, view, where), !a.names[UV0].empty(), task);
    for (int slot = 0; slot < SLOTS; ++slot)
        if (int accessor = attribute(primitive, a.names[slot]); accessor >= 0)
            a.values[slot] = draco_values(doc, accessor, ids, draco, a.names[slot]);
    size_t count = a.values[POSITION].count; /* which may come from an accessor */
    if (count != draco.points)
        fail(GTX_ERROR_INPUT, "%s: %zu positions for %zu Draco points", where.c_str(), count,
             draco.points);
    out.triangles = std::move(draco.triangles);
}

/* ---- accessors ---- */

static Vector<std::array<uint32_t, 3>> assemble(const Vector<uint32_t> &v, int mode)
{
    Vector<std::array<uint32_t, 3>> out;
    bool list = mode == TINYGLTF_MODE_TRIANGLES;
    for (size_t i = 2; i < v.size(); i += list ? 3 : 1) {
        bool odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2;
        uint32_t a = mode == TINYGLTF_MODE_TRIANGLE_FAN ? v[0] : v[i - 2], b = v[i - 1];
        out.push_back({odd ? b : a, odd ? a : b, v[i]});
    }
    return out;
}

static void read_accessors(const GltfDocument &doc, const tinygltf::Primitive &primitive,
                           Attributes &a, GltfPrimitive &out)
{
    for (int slot = 0; slot < SLOTS; ++slot)
        if (int accessor = attribute(primitive, a.names[slot]); accessor >= 0)
            a.values[slot] = gltf_values(doc, accessor);
    Vector<uint32_t> indices;
    size_t count = a.values[POSITION].count;
    if (primitive.indices >= 0) {
        indices = gltf_indices(doc, primitive.indices, count);
    } else {
        indices.resize(count);
        for (size_t i = 0; i < count; ++i)
            indices[i] = uint32_t(i);
    }
    out.triangles = assemble(indices, primitive.mode);
}

/* ---- to vertices ---- */

static void set_positions(const GltfValues &from, GltfPrimitive &out)
{
    out.positions.reserve(from.count);
    for (const double *p = from.values.data(), *end = p + 3 * from.count; p != end; p += 3)
        out.positions.push_back({p[0], p[1], p[2]});
}

static void set_normals(const GltfValues &from, GltfPrimitive &out)
{
    out.normals.reserve(from.count);
    for (const double *n = from.values.data(), *end = n + 3 * from.count; n != end; n += 3)
        out.normals.push_back(Vec3f(Vec3d(n[0], n[1], n[2])));
}

/* COLOR_0 is linear. */
static void set_colors(const GltfValues &from, GltfPrimitive &out)
{
    size_t step = size_t(from.components);
    out.colors.reserve(from.count);
    for (size_t i = 0; i < from.count; ++i) {
        const double *c = &from.values[i * step];
        out.colors.push_back({linear_to_srgb(float(c[0])), linear_to_srgb(float(c[1])),
                              linear_to_srgb(float(c[2])),
                              step == 4 ? to_byte(c[3]) : uint8_t(255)});
    }
}

/* Any number of floats a vertex. */
template <size_t N>
static void set_floats(const GltfValues &from, Vector<std::array<float, N>> &out)
{
    out.resize(from.count);
    for (size_t i = 0; i < from.count; ++i)
        for (size_t k = 0; k < N; ++k)
            out[i][k] = float(from.values[i * N + k]);
}

GltfPrimitive read_gltf_primitive(const GltfDocument &doc, const tinygltf::Primitive &from,
                                  const GltfMaterial *material, const std::string &where,
                                  Task &task)
{
    GltfPrimitive out;
    Attributes a = wanted_attributes(material);
    if (attribute(from, "POSITION") < 0)
        fail(GTX_ERROR_INPUT, "%s has no POSITION", where.c_str());
    if (from.extensions.count("KHR_draco_mesh_compression"))
        read_draco(doc, from, where, task, a, out);
    else
        read_accessors(doc, from, a, out);
    const size_t count = a.values[POSITION].count;
    for (int slot = 0; slot < SLOTS; ++slot) {
        const GltfValues &v = a.values[slot];
        if (!v.values.empty() &&
            (v.components < COMPONENTS[slot].least || v.components > COMPONENTS[slot].most ||
             v.count != count))
            fail(GTX_ERROR_INPUT, "%s: POSITION and %s do not fit together", where.c_str(),
                 a.names[slot].c_str());
        switch (v.values.empty() ? SLOTS : slot) {
        case POSITION: set_positions(v, out); break;
        case NORMAL: set_normals(v, out); break;
        case COLOR: set_colors(v, out); break;
        case UV0: set_floats(v, out.uv[0]); break;
        case UV1: set_floats(v, out.uv[1]); break;
        case TANGENT: set_floats(v, out.tangents); break;
        }
        a.values[slot] = {};
    }
    return out;
}

} // namespace gtx
