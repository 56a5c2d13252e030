/* Wavefront OBJ: positions with colours, normals, texture coordinates, materials and polygons. */
#include "mesh/import/mtl.hpp"
#include "mesh/import/obj_text.hpp"

#include <algorithm>

namespace gtx {

namespace {

constexpr uint32_t NOTHING = 0xffffffff;

/* A corner of a face: numbers of what it names. */
struct Corner {
    uint32_t vertex = 0, coordinate = NOTHING, normal = NOTHING;
};

class ObjReader {
public:
    ObjReader(const ModelFile &file, Task &task)
        : text_(file.bytes), file_(file), task_(task)
    {
    }
    Mesh read();

private:
    bool corner();
    void statement(std::string_view word);
    void vertex();
    void face();
    void triangle(const Corner &a, const Corner &b, const Corner &c);
    void use_material();
    void ignore(std::string_view word);
    void finish_materials();
    void finish();

    ObjText text_;
    const ModelFile &file_;
    Task &task_;
    Mesh mesh_;
    Vector<Vec3f> normals_;
    Vector<std::array<float, 2>> coordinates_;
    Vector<Rgba8> colors_;                       /* by vertex, or empty */
    Vector<std::string> libraries_;              /* each once */
    Names library_names_, names_;                /* of mtllib and usemtl */
    uint32_t name_ = NOTHING;                    /* of the material in use, in names_ */
    Vector<Corner> corners_;                     /* of the face at hand */
    Vector<Vec3d> polygon_;
    Vector<std::array<uint32_t, 3>> cut_;
    Vector<std::string> ignored_;      /* statements, in the order found */
    size_t short_faces_ = 0, lost_coordinates_ = 0;
};

/* x y z, then w, or r g b, or r g b a. */
void ObjReader::vertex()
{
    double v[3], more[4] = {};
    int extra = 0;
    text_.numbers(v, 3, "vertex");
    while (extra < 4 && text_.number(more[extra]))
        ++extra;
    if (mesh_.positions.size() == MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "line %zu: more than %llu vertices", text_.line(),
             (unsigned long long)MAX_VERTICES);
    if (extra >= 3) {
        colors_.resize(mesh_.positions.size());
        colors_.push_back({to_byte(more[0]), to_byte(more[1]), to_byte(more[2]), 255});
    }
    mesh_.positions.push_back({v[0], v[1], v[2]});
}

/* v, v/vt, v//vn or v/vt/vn. */
bool ObjReader::corner()
{
    if (text_.at_line_end())
        return false;
    Corner corner;
    bool good = text_.index(mesh_.positions.size(), "vertex", corner.vertex);
    if (good && text_.take('/')) {
        lost_coordinates_ += !text_.optional_index(coordinates_.size(), corner.coordinate);
        if (text_.take('/')) /* "v/vt/" is met in the wild */
            text_.index(normals_.size(), "normal", corner.normal);
    }
    if (!good || !text_.at_word_end())
        fail(GTX_ERROR_INPUT, "line %zu: a corner of a face is not v, v/vt, v//vn or v/vt/vn",
             text_.line());
    corners_.push_back(corner);
    return true;
}

/* Attributes begin with the first triangle that has them. */
void ObjReader::triangle(const Corner &a, const Corner &b, const Corner &c)
{
    auto &normals = mesh_.normals;
    auto &coordinates = mesh_.appearance.uv[0];
    auto &materials = mesh_.appearance.material;
    const size_t before = mesh_.triangles.size();
    bool has_normal = !normals.empty(), has_coordinate = !coordinates.empty();
    for (const Corner *k : {&a, &b, &c}) {
        has_normal |= k->normal != NOTHING;
        has_coordinate |= k->coordinate != NOTHING;
    }
    mesh_.triangles.push_back({a.vertex, b.vertex, c.vertex});
    normals.resize(has_normal ? before * 3 : 0);
    coordinates.resize(has_coordinate ? before * 3 : 0);
    for (const Corner *k : {&a, &b, &c}) {
        if (has_normal)
            normals.push_back(k->normal == NOTHING ? Vec3f() : normals_[k->normal]);
        if (has_coordinate)
            coordinates.push_back(k->coordinate == NOTHING ? std::array<float, 2>{0, 0}
                                                           : coordinates_[k->coordinate]);
    }
    if (name_ != NOTHING || !materials.empty()) {
        materials.resize(before, NOTHING);
        materials.push_back(name_);
    }
}

void ObjReader::face()
{
    corners_.clear();
    while (corner())
        ;
    if (corners_.size() < 3) {
        ++short_faces_;
    } else if (corners_.size() == 3) {
        triangle(corners_[0], corners_[1], corners_[2]);
    } else {
        polygon_.clear();
        cut_.clear();
        for (const Corner &c : corners_)
            polygon_.push_back(mesh_.positions[c.vertex]);
        triangulate(polygon_, cut_);
        for (const auto &t : cut_)
            triangle(corners_[t[0]], corners_[t[1]], corners_[t[2]]);
    }
    require_triangles(mesh_.triangles.size(), task_);
}

void ObjReader::use_material()
{
    name_ = names_.add(std::string(text_.rest_of_line())).first;
}

void ObjReader::ignore(std::string_view word)
{
    static const char *const silent[] = {"o", "g", "s", "vp"};
    for (const char *name : silent)
        if (word == name)
            return;
    auto strange = [](unsigned char c) { return c <= ' ' || c > '~'; };
    if (word.empty() || std::any_of(word.begin(), word.end(), strange))
        fail(GTX_ERROR_INPUT, "line %zu: '%s' is not an OBJ statement", text_.line(),
             printable(word).c_str());
    for (const std::string &known : ignored_)
        if (word == known)
            return;
    if (ignored_.size() < 8)
        ignored_.push_back(printable(word));
}

void ObjReader::statement(std::string_view word)
{
    if (word == "v") {
        vertex();
    } else if (word == "vn") {
        double n[3];
        text_.numbers(n, 3, "normal");
        if (normals_.size() < MAX_VERTICES)
            normals_.push_back({float(n[0]), float(n[1]), float(n[2])});
    } else if (word == "vt") {
        double u = 0, v = 0;
        text_.number(u);
        text_.number(v);
        if (coordinates_.size() < MAX_VERTICES) /* images have their origin at the top */
            coordinates_.push_back({float(u), float(1 - v)});
    } else if (word == "f") {
        face();
    } else if (word == "usemtl") {
        use_material();
    } else if (word == "mtllib") {
        std::string name(text_.rest_of_line());
        const std::string path = path_beside(file_, name);
        if (library_names_.add(path.empty() ? name : normal_path(path)).second)
            libraries_.push_back(std::move(name));
    } else {
        ignore(word);
    }
}

/* Materials take the numbers of the names that are used; what no library defines is plain. */
void ObjReader::finish_materials()
{
    Appearance &look = mesh_.appearance;
    MtlLibrary library;
    if (names_.size())
        for (const std::string &name : libraries_)
            read_mtl(file_, name, library, task_);
    look.materials.resize(names_.size());
    for (const auto &[name, number] : names_)
        if (const uint32_t defined = library.names.find(name, NOTHING); defined != NOTHING)
            look.materials[number] = library.materials[defined];
    if (!look.material.empty() &&
        std::find(look.material.begin(), look.material.end(), NOTHING) != look.material.end()) {
        std::replace(look.material.begin(), look.material.end(), NOTHING,
                     uint32_t(look.materials.size()));
        look.materials.emplace_back();
    }
    add_base_color(file_, look, library.images, task_);
    const bool textured = std::any_of(
        look.materials.begin(), look.materials.end(), [](const Material &m) {
            return std::any_of(std::begin(MATERIAL_TEXTURES), std::end(MATERIAL_TEXTURES),
                               [&](Texture Material::*map) { return (m.*map).used(); });
        });
    if (!textured && !look.uv[0].empty())
        task_.warn(GTX_WARNING_NO_TEXTURE,
                   "the model has texture coordinates, but names no texture");
    load_images(library.images, look, task_);
    std::string ignored;
    for (const std::string &name : library.ignored)
        ignored += (ignored.empty() ? "" : ", ") + name;
    if (!ignored.empty())
        task_.warn(GTX_WARNING_IGNORED_MATERIAL, "MTL statements were ignored: " + ignored);
    if (lost_coordinates_ && !look.uv[0].empty())
        task_.warn(GTX_WARNING_IGNORED_TEXTURE,
                   std::to_string(lost_coordinates_) +
                       " corners name texture coordinates that are not there");
}

void ObjReader::finish()
{
    finish_materials();
    if (!colors_.empty()) {
        colors_.resize(mesh_.positions.size());
        for (const auto &t : mesh_.triangles)
            for (uint32_t v : t)
                mesh_.colors.push_back(colors_[v]);
    }
    mesh_.normals.resize(mesh_.normals.empty() ? 0 : mesh_.triangles.size() * 3);
    if (short_faces_)
        task_.warn(GTX_WARNING_DEGENERATE, std::to_string(short_faces_) +
                                               " faces with fewer than three corners were dropped");
    std::string names;
    for (const std::string &name : ignored_)
        names += (names.empty() ? "" : ", ") + name;
    if (!names.empty())
        task_.warn(GTX_WARNING_IGNORED_DATA, "OBJ statements were ignored: " + names);
}

Mesh ObjReader::read()
{
    while (!text_.at_end()) {
        if (text_.line() % 0x8000 == 0)
            task_.advance(text_.share_read());
        const bool blank = text_.at_line_end();
        if (!blank)
            statement(text_.word());
        text_.next_line(!blank && !text_.at_comment());
    }
    finish();
    return std::move(mesh_);
}

} // namespace

Mesh import_obj(const ModelFile &file, Task &task)
{
    return ObjReader(file, task).read();
}

} // namespace gtx
