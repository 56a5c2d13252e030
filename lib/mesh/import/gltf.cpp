/* glTF: the nodes of the scene, each with its transform, to one mesh. */
#include "mesh/import/gltf.hpp"

#include <algorithm>
#include <map>

namespace gtx {

/* ---- materials ---- */

/* As nothing was said of it. */
static bool is_plain(const Material &m)
{
    bool plain = m.metallic == 0 && m.roughness == 1 && m.alpha_cutoff < 0 && !m.unlit;
    for (int k = 0; k < 3; ++k)
        plain = plain && m.color[k] == 1 && m.emission[k] == 0;
    for (Texture Material::*map : MATERIAL_TEXTURES)
        plain = plain && !(m.*map).used();
    return plain;
}

uint32_t GltfPalette::number(int material, unsigned lacking, const std::string &where)
{
    const GltfMaterial none, &from = material < 0 ? none : from_.materials[size_t(material)];
    for (unsigned k = 0; k < from.sets.size(); ++k)
        if ((lacking >> k & 1) && warned_.insert({material, k}).second)
            warnings.insert({GTX_WARNING_IGNORED_TEXTURE,
                             where + " has no TEXCOORD_" + std::to_string(from.sets[k]) +
                                 ": the textures that need it were ignored"});
    warnings.insert(from.warnings.begin(), from.warnings.end());
    Material m = from.look;
    for (Texture Material::*map : MATERIAL_TEXTURES)
        if ((m.*map).used() && (lacking >> (m.*map).set & 1))
            (m.*map).image = Texture::NONE;
    if (is_plain(m))
        material = -1;
    auto [entry, fresh] = numbers_.try_emplace({material, material < 0 ? 0 : lacking},
                                               uint32_t(look_.materials.size()));
    if (fresh)
        look_.materials.push_back(material < 0 ? Material() : m);
    return entry->second;
}

static EncodedImage image_beside(const ModelFile &file, std::string name, const std::string &uri,
                                 Task &task)
{
    name += " ('" + printable(uri) + "')";
    const std::string path = texture_path(file, percent_decoded(uri));
    if (!path.empty())
        return read_image_file(file, name, path, task);
    EncodedImage out;
    out.name = name;
    out.problem = "it is not a file in the model's folder";
    return out;
}

static EncodedImage image_inside(const GltfDocument &doc, std::string name,
                                 const GltfDocument::ImageSource &source)
{
    EncodedImage out;
    out.name = name;
    try {
        out.bytes = source.uri.empty() ? Bytes(gltf_view(doc, source.view, name))
                                       : data_uri_bytes(source.uri, name);
    } catch (const Error &e) {
        if (e.result == GTX_ERROR_LIMIT)
            throw;
        out.problem = e.message;
    }
    return out;
}

EncodedImage gltf_image(const GltfDocument &doc, const GltfImage &image, const ModelFile &file,
                        Task &task)
{
    const GltfDocument::ImageSource &source = doc.images[size_t(image.number)];
    const std::string name = "image " + std::to_string(image.number);
    const bool is_inside = source.uri.empty() || source.uri.rfind("data:", 0) == 0;
    EncodedImage out =
        is_inside ? image_inside(doc, name, source) : image_beside(file, name, source.uri, task);
    out.glossiness = image.glossiness;
    return out;
}

/* Reads the images that the materials in use look at. */
static void fetch_images(const GltfDocument &doc, const ModelFile &file, Appearance &look,
                         Task &task)
{
    Vector<EncodedImage> encoded(doc.look.images.size());
    for (const Material &m : look.materials)
        for (Texture Material::*map : MATERIAL_TEXTURES)
            if ((m.*map).used() && encoded[(m.*map).image].name.empty())
                encoded[(m.*map).image] =
                    gltf_image(doc, doc.look.images[(m.*map).image], file, task);
    add_base_color(file, look, encoded, task);
    load_images(encoded, look, task);
}

/* ---- the mesh ---- */

/* Adds `count` attributes of a primitive that has them or not to a mesh that has them or not. */
template <class T>
static void extend(Vector<T> &to, size_t before, size_t count, bool has, T fill = T())
{
    if (!has && to.empty())
        return;
    to.resize(before, fill);
    to.resize(before + count, fill);
}

static void set_corner(const GltfPrimitive &from, uint32_t vertex, const Turn &turn, size_t corner,
                       Mesh &mesh)
{
    if (!from.normals.empty())
        mesh.normals[corner] = turn.normal(from.normals[vertex]);
    if (!from.colors.empty())
        mesh.colors[corner] = from.colors[vertex];
    for (int k = 0; k < 2; ++k)
        if (!from.uv[k].empty())
            mesh.appearance.uv[k][corner] = from.uv[k][vertex];
    if (!from.tangents.empty())
        mesh.appearance.tangents[corner] = turn.tangent(from.tangents[vertex]);
}

static void append(const GltfPrimitive &from, bool two_sided, const Turn &turn, Mesh &mesh)
{
    uint32_t first = uint32_t(mesh.positions.size());
    size_t before = mesh.triangles.size(), count = from.triangles.size();
    Appearance &look = mesh.appearance;
    extend(mesh.normals, before * 3, count * 3, !from.normals.empty());
    extend(mesh.colors, before * 3, count * 3, !from.colors.empty());
    extend(mesh.flags, before, count, two_sided);
    for (int k = 0; k < 2; ++k)
        extend(look.uv[k], before * 3, count * 3, !from.uv[k].empty());
    extend(look.tangents, before * 3, count * 3, !from.tangents.empty());
    for (const Vec3d &p : from.positions)
        mesh.positions.push_back(turn.transform.point(p));
    for (size_t t = 0; t < count; ++t) {
        std::array<uint32_t, 3> corners = from.triangles[t];
        if (turn.mirrors)
            std::swap(corners[1], corners[2]);
        for (size_t k = 0; k < 3; ++k)
            set_corner(from, corners[k], turn, 3 * (before + t) + k, mesh);
        if (two_sided)
            mesh.flags[before + t] = TRIANGLE_TWO_SIDED;
        mesh.triangles.push_back({corners[0] + first, corners[1] + first, corners[2] + first});
    }
}

namespace {
/* A primitive and what the model says of all its triangles. */
struct Part {
    GltfPrimitive primitive;
    bool two_sided;
    uint32_t material;
    std::string where; /* for messages */
};
} // namespace

/* Adds the part wherever its mesh stands. */
static void append_instances(const Part &part, const Vector<Affine> &instances, Task &task,
                             Mesh &mesh)
{
    const double limit = double(task.limits.of(GTX_LIMITED_TRIANGLES));
    for (const Affine &transform : instances) {
        uint64_t triangles = mesh.triangles.size() + part.primitive.triangles.size();
        uint64_t vertices = mesh.positions.size() + part.primitive.positions.size();
        task.limits.require(GTX_LIMITED_TRIANGLES, part.where.c_str(),
                            std::max(triangles, vertices / 3));
        if (vertices > MAX_VERTICES)
            fail(GTX_ERROR_LIMIT, "%s: more than %llu vertices", part.where.c_str(),
                 (unsigned long long)MAX_VERTICES);
        append(part.primitive, part.two_sided, Turn(transform), mesh);
        mesh.appearance.material.resize(mesh.triangles.size(), part.material);
        task.advance(0.2 + 0.7 * std::min(double(triangles) / limit, 1.));
    }
}

Mesh import_gltf(const ModelFile &file, Task &task)
{
    GltfDocument doc = read_gltf_document(file, task);
    Vector<Vector<Affine>> instances = gltf_instances(doc);
    Mesh mesh;
    GltfPalette palette(doc.look, mesh.appearance);
    bool has_lines = false;
    for (size_t m = 0; m < instances.size(); ++m) {
        const std::vector<tinygltf::Primitive> &primitives = doc.model.meshes[m].primitives;
        task.advance(0.2 + 0.7 * double(m) / double(instances.size()));
        for (size_t i = 0; i < primitives.size() && !instances[m].empty(); ++i) {
            const int mode = primitives[i].mode, number = primitives[i].material;
            std::string where = "mesh " + std::to_string(m) + " primitive " + std::to_string(i);
            if (mode < 0 || mode > TINYGLTF_MODE_TRIANGLE_FAN)
                fail(GTX_ERROR_INPUT, "%s: %d is not a mode", where.c_str(), mode);
            if (mode < TINYGLTF_MODE_TRIANGLES) {
                has_lines = true;
                continue;
            }
            if (number >= 0 && size_t(number) >= doc.look.materials.size())
                fail(GTX_ERROR_INPUT, "%s: there is no material %d", where.c_str(), number);
            const GltfMaterial *material =
                number < 0 ? nullptr : &doc.look.materials[size_t(number)];
            GltfPrimitive primitive =
                read_gltf_primitive(doc, primitives[i], material, where, task);
            const unsigned lacking = (primitive.uv[0].empty() ? 1 : 0) |
                                     (primitive.uv[1].empty() ? 2 : 0);
            const uint32_t shown = palette.number(number, lacking, where);
            const Part part = {std::move(primitive), material && material->two_sided, shown, where};
            append_instances(part, instances[m], task, mesh);
        }
    }
    if (has_lines)
        task.warn(GTX_WARNING_IGNORED_LINES, "points and lines were ignored");
    task.warnings.insert(task.warnings.end(), palette.warnings.begin(), palette.warnings.end());
    fetch_images(doc, file, mesh.appearance, task);
    if (std::all_of(mesh.appearance.materials.begin(), mesh.appearance.materials.end(), is_plain))
        mesh.appearance = {};
    return mesh;
}

} // namespace gtx
