/* glTF: the nodes of the scene, and where they put each mesh. */
#include "mesh/import/gltf.hpp"

namespace gtx {

static Affine operator*(const Affine &a, const Affine &b)
{
    Affine out;
    for (int i = 0; i < 3; ++i)
        out.column[i] = a.direction(b.column[i]);
    out.offset = a.point(b.offset);
    return out;
}

/* Any of the three may be null. The quaternion may have any length. */
static Affine compose(const double *translation, const double *rotation, const double *scale)
{
    Affine out;
    if (rotation) {
        Vec3d u(rotation[0], rotation[1], rotation[2]);
        double w = rotation[3], norm = dot(u, u) + w * w;
        /* v + 2w (u x v) + 2u x (u x v) */
        for (Vec3d &c : out.column)
            c = norm > 0 ? c + (cross(u, c) * w + cross(u, cross(u, c))) * (2 / norm) : c;
    }
    for (int i = 0; i < 3 && scale; ++i)
        out.column[i] *= scale[i];
    if (translation)
        out.offset = {translation[0], translation[1], translation[2]};
    return out;
}

static Affine local_transform(const tinygltf::Node &node, int number)
{
    auto check = [&](const std::vector<double> &values, size_t size, const char *what) {
        if (!values.empty() && values.size() != size)
            fail(GTX_ERROR_INPUT, "node %d: its %s has %zu numbers", number, what, values.size());
        return values.empty() ? nullptr : values.data();
    };
    if (const double *m = check(node.matrix, 16, "matrix")) {
        Affine out;
        for (int i = 0; i < 3; ++i)
            out.column[i] = {m[4 * i], m[4 * i + 1], m[4 * i + 2]};
        out.offset = {m[12], m[13], m[14]};
        return out;
    }
    const double *rotation = check(node.rotation, 4, "rotation");
    const double *scale = check(node.scale, 3, "scale");
    return compose(check(node.translation, 3, "translation"), rotation, scale);
}

/* A node needs a few bytes to repeat a mesh as often as another said. */
static void check_repeats(size_t count, int number)
{
    constexpr size_t MAX_INSTANCES = 1 << 20;
    if (count > MAX_INSTANCES)
        fail(GTX_ERROR_LIMIT, "node %d: more than %zu repeated instances", number, MAX_INSTANCES);
}

/* EXT_mesh_gpu_instancing: where a node repeats its mesh, relative to itself. */
static Vector<Affine> repeated(const GltfDocument &doc, const tinygltf::Node &node, int number)
{
    auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
    if (extension == node.extensions.end())
        return {Affine()};
    static const struct {
        const char *name;
        int components;
    } attributes[3] = {{"TRANSLATION", 3}, {"ROTATION", 4}, {"SCALE", 3}};
    const tinygltf::Value &accessors = extension->second.Get("attributes");
    GltfValues values[3];
    size_t count = 0;
    for (int k = 0; k < 3; ++k)
        if (accessors.Has(attributes[k].name)) {
            values[k] = gltf_values(doc, accessors.Get(attributes[k].name).GetNumberAsInt());
            count = values[k].count;
        }
    check_repeats(count, number);
    Vector<Affine> out;
    const double *at[3] = {};
    for (int k = 0; k < 3; ++k)
        if (values[k].components && (values[k].components != attributes[k].components ||
                                     values[k].count != count))
            fail(GTX_ERROR_INPUT, "node %d: the %s of its instances do not fit", number,
                 attributes[k].name);
    for (size_t i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k)
            if (values[k].components)
                at[k] = &values[k].values[i * size_t(attributes[k].components)];
        out.push_back(compose(at[0], at[1], at[2]));
    }
    return out;
}

/* The nodes to start from: those of the default scene, else of the first, else every root. */
static std::vector<int> scene_roots(const tinygltf::Model &model)
{
    int scene = model.defaultScene >= 0 ? model.defaultScene : 0;
    if (size_t(scene) < model.scenes.size())
        return model.scenes[size_t(scene)].nodes;
    if (model.defaultScene >= 0)
        fail(GTX_ERROR_INPUT, "there is no scene %d", scene);
    Vector<bool> is_child(model.nodes.size());
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

/* With a stack of our own, since a file may nest its nodes as deep as it likes. */
Vector<Vector<Affine>> gltf_instances(const GltfDocument &doc)
{
    const tinygltf::Model &model = doc.model;
    Vector<Vector<Affine>> instances(model.meshes.size());
    if (model.nodes.empty()) { /* a library of meshes */
        for (auto &list : instances)
            list.emplace_back();
        return instances;
    }
    struct Visit {
        int node;
        Affine parent;
    };
    Vector<Visit> stack;
    size_t repeats = 0;
    Vector<bool> seen(model.nodes.size());
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
            Vector<Affine> list = repeated(doc, node, number);
            check_repeats(repeats += list.size() - (list.size() == 1), number);
            for (const Affine &instance : list)
                instances[size_t(node.mesh)].push_back(transform * instance);
        }
        for (size_t i = node.children.size(); i-- > 0;)
            stack.push_back({node.children[i], transform});
    }
    return instances;
}

} // namespace gtx
