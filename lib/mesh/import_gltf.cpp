/* glTF: the nodes of the scene, each with its transform, to one mesh. */
#include "mesh/import_draco.hpp"
#include "mesh/import_gltf.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

/* ---- transforms ---- */

namespace {
struct Affine {
    Vec3d column[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, offset;

    Vec3d direction(const Vec3d &v) const
    {
        return column[0] * v.x + column[1] * v.y + column[2] * v.z;
    }
    Vec3d point(const Vec3d &v) const { return direction(v) + offset; }
    double determinant() const { return dot(column[0], cross(column[1], column[2])); }
};
} // namespace

static Affine operator*(const Affine &a, const Affine &b)
{
    Affine out;
    for (int i = 0; i < 3; ++i)
        out.column[i] = a.direction(b.column[i]);
    out.offset = a.point(b.offset);
    return out;
}

static Affine local_transform(const tinygltf::Node &node, int number)
{
    auto check = [&](const std::vector<double> &values, size_t size, const char *what) {
        if (!values.empty() && values.size() != size)
            fail(GTX_ERROR_INPUT, "node %d: its %s has %zu numbers", number, what, values.size());
        return !values.empty();
    };
    Affine out;
    if (check(node.matrix, 16, "matrix")) {
        const std::vector<double> &m = node.matrix;
        for (size_t i = 0; i < 3; ++i)
            out.column[i] = {m[4 * i], m[4 * i + 1], m[4 * i + 2]};
        out.offset = {m[12], m[13], m[14]};
        return out;
    }
    if (check(node.rotation, 4, "rotation")) {
        Vec3d u(node.rotation[0], node.rotation[1], node.rotation[2]);
        double w = node.rotation[3], norm = dot(u, u) + w * w;
        /* v + 2w (u x v) + 2u x (u x v), for a quaternion (u, w) of any length */
        for (Vec3d &c : out.column)
            c = norm > 0 ? c + (cross(u, c) * w + cross(u, cross(u, c))) * (2 / norm) : c;
    }
    if (check(node.scale, 3, "scale"))
        for (int i = 0; i < 3; ++i)
            out.column[i] *= node.scale[size_t(i)];
    if (check(node.translation, 3, "translation"))
        out.offset = {node.translation[0], node.translation[1], node.translation[2]};
    return out;
}

/* ---- the scene ---- */

/* The nodes to start from: those of the default scene, else of the first, else every root. */
static std::vector<int> scene_roots(const tinygltf::Model &model)
{
    int scene = model.defaultScene >= 0 ? model.defaultScene : 0;
    if (size_t(scene) < model.scenes.size())
        return model.scenes[size_t(scene)].nodes;
    if (model.defaultScene >= 0)
        fail(GTX_ERROR_INPUT, "there is no scene %d", scene);
    std::vector<bool> is_child(model.nodes.size());
    for (const tinygltf::Node &node : model.nodes)
        for (int child : node.children)
            if (child >= 0 && size_t(child) < is_child.size())
                is_child[size_t(child)] = true;
    std::vector<int> roots;
    for (size_t i = 0; i < is_child.size(); ++i)
        if (!is_child[i])
            roots.push_back(int(i));
    return roots;
}

/* Where each mesh stands, in the order of the tree. With a stack of our own, since a file may nest
 * its nodes as deep as it likes. */
static std::vector<std::vector<Affine>> find_instances(const tinygltf::Model &model)
{
    std::vector<std::vector<Affine>> instances(model.meshes.size());
    if (model.nodes.empty()) { /* a library of meshes */
        for (auto &list : instances)
            list.emplace_back();
        return instances;
    }
    struct Visit {
        int node;
        Affine parent;
    };
    std::vector<Visit> stack;
    std::vector<bool> seen(model.nodes.size());
    std::vector<int> roots = scene_roots(model);
    for (size_t i = roots.size(); i-- > 0;)
        stack.push_back({roots[i], {}});
    while (!stack.empty()) {
        auto [number, parent] = stack.back();
        stack.pop_back();
        if (number < 0 || size_t(number) >= model.nodes.size())
            fail(GTX_ERROR_INPUT, "there is no node %d", number);
        if (seen[size_t(number)])
            fail(GTX_ERROR_INPUT, "node %d is reached twice: the nodes are not a tree", number);
        seen[size_t(number)] = true;
        const tinygltf::Node &node = model.nodes[size_t(number)];
        Affine transform = parent * local_transform(node, number);
        if (node.mesh >= 0) {
            if (size_t(node.mesh) >= model.meshes.size())
                fail(GTX_ERROR_INPUT, "node %d: there is no mesh %d", number, node.mesh);
            instances[size_t(node.mesh)].push_back(transform);
        }
        for (size_t i = node.children.size(); i-- > 0;)
            stack.push_back({node.children[i], transform});
    }
    return instances;
}

/* ---- primitives ---- */

namespace {
struct Primitive {
    VertexMesh mesh;
    bool two_sided = false;
};

/* As stored, from accessors or from Draco; normal and color may be empty. */
struct Attributes {
    GltfValues position, normal, color;
};
} // namespace

/* The transfer function of sRGB (IEC 61966-2-1). */
static double srgb_from_linear(double v)
{
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

static std::vector<std::array<uint32_t, 3>> assemble(const std::vector<uint32_t> &v, int mode)
{
    std::vector<std::array<uint32_t, 3>> out;
    bool list = mode == TINYGLTF_MODE_TRIANGLES;
    for (size_t i = 2; i < v.size(); i += list ? 3 : 1) {
        bool odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2;
        uint32_t a = mode == TINYGLTF_MODE_TRIANGLE_FAN ? v[0] : v[i - 2], b = v[i - 1];
        out.push_back({odd ? b : a, odd ? a : b, v[i]});
    }
    return out;
}

static int attribute(const tinygltf::Primitive &primitive, const char *name)
{
    auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

/* One attribute of the Draco data; the accessor says whether integers are normalised. */
static GltfValues draco_values(const GltfDocument &doc, const tinygltf::Primitive &primitive,
                               const tinygltf::Value &ids, const DracoMesh &draco, const char *name)
{
    int accessor = attribute(primitive, name);
    if (accessor < 0)
        return {};
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
    fail(GTX_ERROR_INPUT, "the Draco data has no attribute %d for %s", id, name);
}

static Attributes read_draco(const GltfDocument &doc, const tinygltf::Primitive &primitive,
                             const std::string &where, Task &task, VertexMesh &out)
{
    const tinygltf::Value &extension = primitive.extensions.at("KHR_draco_mesh_compression");
    if (!extension.Has("bufferView") || !extension.Has("attributes"))
        fail(GTX_ERROR_INPUT, "%s: KHR_draco_mesh_compression lacks its view or its attributes",
             where.c_str());
    int view = extension.Get("bufferView").GetNumberAsInt();
    const tinygltf::Value &ids = extension.Get("attributes");
    DracoMesh draco = decode_draco(gltf_view(doc, view, where), task);
    Attributes a = {draco_values(doc, primitive, ids, draco, "POSITION"),
                    draco_values(doc, primitive, ids, draco, "NORMAL"),
                    draco_values(doc, primitive, ids, draco, "COLOR_0")};
    if (a.position.count != draco.points) /* positions from an accessor, triangles from Draco */
        fail(GTX_ERROR_INPUT, "%s: %zu positions for %zu Draco points", where.c_str(),
             a.position.count, draco.points);
    out.triangles = std::move(draco.triangles);
    return a;
}

static Attributes read_accessors(const GltfDocument &doc, const tinygltf::Primitive &primitive,
                                 VertexMesh &out)
{
    Attributes a;
    a.position = gltf_values(doc, attribute(primitive, "POSITION"));
    if (attribute(primitive, "NORMAL") >= 0)
        a.normal = gltf_values(doc, attribute(primitive, "NORMAL"));
    if (attribute(primitive, "COLOR_0") >= 0)
        a.color = gltf_values(doc, attribute(primitive, "COLOR_0"));
    std::vector<uint32_t> indices;
    if (primitive.indices >= 0) {
        indices = gltf_indices(doc, primitive.indices, a.position.count);
    } else {
        indices.resize(a.position.count);
        for (size_t i = 0; i < indices.size(); ++i)
            indices[i] = uint32_t(i);
    }
    out.triangles = assemble(indices, primitive.mode);
    return a;
}

/* The base colour factor times COLOR_0, both linear, as sRGB; nothing when all is white. */
static void set_colors(const tinygltf::Material *material, const GltfValues &color, VertexMesh &out)
{
    double factor[4] = {1, 1, 1, 1};
    bool opaque = !material || material->alphaMode == "OPAQUE", white = true;
    for (size_t k = 0; material && k < 4; ++k) {
        factor[k] = material->pbrMetallicRoughness.baseColorFactor[k];
        white &= factor[k] == 1 || (k == 3 && opaque);
    }
    if (white && color.values.empty())
        return;
    for (size_t i = 0; i < out.positions.size(); ++i) {
        double c[4];
        size_t components = size_t(color.components);
        for (size_t k = 0; k < 4; ++k)
            c[k] = factor[k] * (k < components ? color.values[i * components + k] : 1);
        for (int k = 0; k < 3; ++k)
            c[k] = srgb_from_linear(std::clamp(c[k], 0., 1.));
        out.colors.push_back(
            {to_byte(c[0]), to_byte(c[1]), to_byte(c[2]), opaque ? uint8_t(255) : to_byte(c[3])});
    }
}

static Primitive read_primitive(const GltfDocument &doc, const tinygltf::Primitive &from,
                                const std::string &where, Task &task)
{
    Primitive out;
    if (attribute(from, "POSITION") < 0)
        fail(GTX_ERROR_INPUT, "%s has no POSITION", where.c_str());
    Attributes a = from.extensions.count("KHR_draco_mesh_compression")
                       ? read_draco(doc, from, where, task, out.mesh)
                       : read_accessors(doc, from, out.mesh);
    size_t count = a.position.count;
    auto suits = [&](const GltfValues &v, int least, int most) {
        return v.values.empty() ||
               (v.components >= least && v.components <= most && v.count == count);
    };
    if (!suits(a.position, 3, 3) || !suits(a.normal, 3, 3) || !suits(a.color, 3, 4))
        fail(GTX_ERROR_INPUT, "%s: POSITION, NORMAL and COLOR_0 do not fit together",
             where.c_str());
    out.mesh.positions.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        const double *p = &a.position.values[3 * i];
        out.mesh.positions.push_back({p[0], p[1], p[2]});
    }
    for (size_t i = 0; i < a.normal.values.size(); i += 3) {
        const double *n = &a.normal.values[i];
        out.mesh.normals.push_back(Vec3f(Vec3d(n[0], n[1], n[2])));
    }
    const tinygltf::Material *material = nullptr;
    if (from.material >= 0) {
        if (size_t(from.material) >= doc.model.materials.size())
            fail(GTX_ERROR_INPUT, "%s: there is no material %d", where.c_str(), from.material);
        material = &doc.model.materials[size_t(from.material)];
    }
    out.two_sided = material && material->doubleSided;
    set_colors(material, a.color, out.mesh);
    return out;
}

/* ---- the mesh ---- */

/* Adds `count` attributes of a primitive that has them or not to a mesh that has them or not. */
template <class T> static void extend(std::vector<T> &to, size_t before, size_t count, bool has)
{
    if (has || !to.empty())
        to.resize(before + count);
}

static void append(const Primitive &primitive, const Affine &transform, Mesh &mesh)
{
    const VertexMesh &from = primitive.mesh;
    uint32_t first = uint32_t(mesh.positions.size());
    size_t before = mesh.triangles.size(), count = from.triangles.size();
    /* Normals turn with the inverse transpose; its multiple by the determinant's size exists even
     * where the transform flattens. */
    double det = transform.determinant(), sign = det < 0 ? -1 : 1;
    const Vec3d *c = transform.column;
    Affine cofactor;
    cofactor.column[0] = cross(c[1], c[2]) * sign;
    cofactor.column[1] = cross(c[2], c[0]) * sign;
    cofactor.column[2] = cross(c[0], c[1]) * sign;

    extend(mesh.normals, before * 3, count * 3, !from.normals.empty());
    extend(mesh.colors, before * 3, count * 3, !from.colors.empty());
    extend(mesh.flags, before, count, primitive.two_sided);
    for (const Vec3d &p : from.positions)
        mesh.positions.push_back(transform.point(p));
    for (size_t t = 0; t < count; ++t) {
        std::array<uint32_t, 3> corners = from.triangles[t];
        if (det < 0)
            std::swap(corners[1], corners[2]);
        for (size_t k = 0; k < 3; ++k) {
            size_t corner = 3 * (before + t) + k;
            if (!from.normals.empty())
                mesh.normals[corner] =
                    Vec3f(normalize(cofactor.direction(Vec3d(from.normals[corners[k]]))));
            if (!from.colors.empty())
                mesh.colors[corner] = from.colors[corners[k]];
        }
        if (primitive.two_sided)
            mesh.flags[before + t] = TRIANGLE_TWO_SIDED;
        mesh.triangles.push_back({corners[0] + first, corners[1] + first, corners[2] + first});
    }
}

static void append_instances(const Primitive &primitive, const std::vector<Affine> &instances,
                             const std::string &where, uint64_t limit, Task &task, Mesh &mesh)
{
    for (const Affine &transform : instances) {
        uint64_t triangles = mesh.triangles.size() + primitive.mesh.triangles.size();
        uint64_t vertices = mesh.positions.size() + primitive.mesh.positions.size();
        if (std::max(triangles, vertices / 3) > limit || vertices > MAX_VERTICES)
            fail(GTX_ERROR_LIMIT, "%s: the instances come to more than %llu triangles",
                 where.c_str(), (unsigned long long)limit);
        append(primitive, transform, mesh);
        task.advance(0.2 + 0.8 * double(triangles) / double(limit));
    }
}

static void warn_of_materials(const tinygltf::Model &model, Task &task)
{
    for (const tinygltf::Material &material : model.materials)
        if (material.alphaMode == "BLEND") {
            task.warnings.push_back("blended materials are drawn opaque");
            return;
        }
}

Mesh import_gltf(const ModelFile &file, Task &task)
{
    GltfDocument doc = read_gltf_document(file, task);
    std::vector<std::vector<Affine>> instances = find_instances(doc.model);
    warn_of_materials(doc.model, task);
    Mesh mesh;
    bool has_lines = false;
    for (size_t m = 0; m < instances.size(); ++m) {
        const std::vector<tinygltf::Primitive> &primitives = doc.model.meshes[m].primitives;
        task.advance(0.2 + 0.8 * double(m) / double(instances.size()));
        for (size_t i = 0; i < primitives.size() && !instances[m].empty(); ++i) {
            int mode = primitives[i].mode;
            std::string where = "mesh " + std::to_string(m) + " primitive " + std::to_string(i);
            if (mode < 0 || mode > TINYGLTF_MODE_TRIANGLE_FAN)
                fail(GTX_ERROR_INPUT, "%s: %d is not a mode", where.c_str(), mode);
            if (mode < TINYGLTF_MODE_TRIANGLES) {
                has_lines = true;
                continue;
            }
            Primitive primitive = read_primitive(doc, primitives[i], where, task);
            append_instances(primitive, instances[m], where, doc.triangle_limit, task, mesh);
        }
    }
    if (has_lines)
        task.warnings.push_back("points and lines were ignored");
    return mesh;
}

} // namespace gtx
