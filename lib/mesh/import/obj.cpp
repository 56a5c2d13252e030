/* Wavefront OBJ: positions with colours, normals, texture coordinates, materials and polygons. */
#include "mesh/import/mtl.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

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
        : begin_(file.bytes.data()), at_(begin_), end_(begin_ + file.bytes.size()), file_(file),
          task_(task)
    {
    }
    Mesh read();

private:
    bool at_line_end();
    void next_line(bool continued);
    bool number(double &value);
    void numbers(double *values, int count, const char *what);
    bool index(size_t count, const char *what, uint32_t &out);
    bool corner();
    void statement(std::string_view word);
    void vertex();
    void face();
    void triangle(const Corner &a, const Corner &b, const Corner &c);
    std::string_view rest_of_line();
    void use_material();
    void ignore(std::string_view word);
    void finish_materials();
    void finish();

    const char *begin_, *at_, *end_;
    size_t line_ = 1;
    const ModelFile &file_;
    Task &task_;
    Mesh mesh_;
    std::vector<Vec3f> normals_;
    std::vector<std::array<float, 2>> coordinates_;
    std::vector<Rgba8> colors_;                  /* by vertex, or empty */
    std::vector<std::string> libraries_, names_; /* of mtllib and usemtl */
    uint32_t name_ = NOTHING;                    /* of the material in use, in names_ */
    std::vector<Corner> corners_;                /* of the face at hand */
    std::vector<Vec3d> polygon_;
    std::vector<std::array<uint32_t, 3>> cut_;
    std::vector<std::string> ignored_; /* statements, in the order found */
    size_t short_faces_ = 0, lost_coordinates_ = 0;
};

/* Skips blanks, and line ends behind a backslash. */
bool ObjReader::at_line_end()
{
    for (; at_ < end_; ++at_) {
        if (*at_ == ' ' || *at_ == '\t')
            continue;
        if (*at_ != '\\' || at_ + 1 == end_ || (at_[1] != '\n' && at_[1] != '\r'))
            return *at_ == '\n' || *at_ == '\r' || *at_ == '#';
        at_ += at_[1] == '\r' && at_ + 2 < end_ && at_[2] == '\n' ? 2 : 1;
        ++line_;
    }
    return true;
}

void ObjReader::next_line(bool continued)
{
    while (at_ < end_ && *at_ != '\n' && *at_ != '\r') {
        if (continued && *at_ == '\\' && at_ + 1 < end_ && (at_[1] == '\n' || at_[1] == '\r'))
            at_line_end();
        else
            ++at_;
    }
    if (at_ < end_)
        at_ += *at_ == '\r' && at_ + 1 < end_ && at_[1] == '\n' ? 2 : 1;
    ++line_;
}

bool ObjReader::number(double &value)
{
    if (at_line_end())
        return false;
    if (!parse_number(at_, end_, value))
        fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a number", line_,
             printable({at_, std::min<size_t>(size_t(end_ - at_), 12)}).c_str());
    return true;
}

void ObjReader::numbers(double *values, int count, const char *what)
{
    for (int i = 0; i < count; ++i)
        if (!number(values[i]))
            fail(GTX_ERROR_INPUT, "line %zu: a %s needs %d numbers", line_, what, count);
}

/* x y z, then w, or r g b, or r g b a. */
void ObjReader::vertex()
{
    double v[3], more[4] = {};
    int extra = 0;
    numbers(v, 3, "vertex");
    while (extra < 4 && number(more[extra]))
        ++extra;
    if (mesh_.positions.size() == MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "line %zu: more than %llu vertices", line_,
             (unsigned long long)MAX_VERTICES);
    if (extra >= 3) {
        colors_.resize(mesh_.positions.size());
        colors_.push_back({to_byte(more[0]), to_byte(more[1]), to_byte(more[2]), 255});
    }
    mesh_.positions.push_back({v[0], v[1], v[2]});
}

/* A number from 1, or from -1 backwards; false when there is none. */
bool ObjReader::index(size_t count, const char *what, uint32_t &out)
{
    int64_t value = 0;
    auto [stop, error] = std::from_chars(at_, end_, value);
    if (error == std::errc::invalid_argument)
        return false;
    bool beyond =
        error != std::errc() || value == 0 || value > int64_t(count) || value < -int64_t(count);
    if (beyond)
        fail(GTX_ERROR_INPUT, "line %zu: %s %s, but %zu are defined before it", line_, what,
             printable({at_, size_t(stop - at_)}).c_str(), count);
    out = uint32_t(value > 0 ? value - 1 : int64_t(count) + value);
    at_ = stop;
    return true;
}

/* v, v/vt, v//vn or v/vt/vn. */
bool ObjReader::corner()
{
    if (at_line_end())
        return false;
    Corner corner;
    bool good = index(mesh_.positions.size(), "vertex", corner.vertex);
    if (good && at_ < end_ && *at_ == '/') {
        int64_t named = 0, count = int64_t(coordinates_.size());
        at_ = std::from_chars(at_ + 1, end_, named).ptr;
        if (named && named <= count && named >= -count)
            corner.coordinate = uint32_t(named > 0 ? named - 1 : count + named);
        else
            lost_coordinates_ += named != 0;
        if (at_ < end_ && *at_ == '/') {
            ++at_;
            index(normals_.size(), "normal", corner.normal); /* "v/vt/" is met in the wild */
        }
    }
    const char *stop = at_;
    if (!good || !(at_line_end() || at_ != stop))
        fail(GTX_ERROR_INPUT, "line %zu: a corner of a face is not v, v/vt, v//vn or v/vt/vn",
             line_);
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
    if (mesh_.triangles.size() > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "line %zu: more than %llu triangles", line_,
             (unsigned long long)MAX_VERTICES);
}

/* Names may have blanks in them. */
std::string_view ObjReader::rest_of_line()
{
    at_line_end();
    const char *stop = at_;
    while (stop < end_ && *stop != '\n' && *stop != '\r')
        ++stop;
    std::string_view rest(at_, size_t(stop - at_));
    at_ = stop;
    return rest.substr(0, rest.find_last_not_of(" \t") + 1);
}

void ObjReader::use_material()
{
    std::string name(rest_of_line());
    auto known = std::find(names_.begin(), names_.end(), name);
    name_ = uint32_t(known - names_.begin());
    if (known == names_.end())
        names_.push_back(name);
}

void ObjReader::ignore(std::string_view word)
{
    static const char *const silent[] = {"o", "g", "s", "vp"};
    for (const char *name : silent)
        if (word == name)
            return;
    auto strange = [](unsigned char c) { return c <= ' ' || c > '~'; };
    if (word.empty() || std::any_of(word.begin(), word.end(), strange))
        fail(GTX_ERROR_INPUT, "line %zu: '%s' is not an OBJ statement", line_,
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
        numbers(n, 3, "normal");
        if (normals_.size() < MAX_VERTICES)
            normals_.push_back({float(n[0]), float(n[1]), float(n[2])});
    } else if (word == "vt") {
        double u = 0, v = 0;
        number(u);
        number(v);
        if (coordinates_.size() < MAX_VERTICES) /* images have their origin at the top */
            coordinates_.push_back({float(u), float(1 - v)});
    } else if (word == "f") {
        face();
    } else if (word == "usemtl") {
        use_material();
    } else if (word == "mtllib") {
        libraries_.emplace_back(rest_of_line());
    } else {
        ignore(word);
    }
}

/* Materials take the numbers of the names that are used; what no library defines is plain. */
void ObjReader::finish_materials()
{
    Appearance &look = mesh_.appearance;
    MtlLibrary library;
    if (!names_.empty())
        for (const std::string &name : libraries_)
            read_mtl(file_, name, library, task_);
    for (const std::string &name : names_) {
        auto found = std::find_if(library.materials.begin(), library.materials.end(),
                                  [&](const MtlMaterial &m) { return m.name == name; });
        look.materials.push_back(found == library.materials.end() ? Material() : found->look);
    }
    if (!look.material.empty() &&
        std::find(look.material.begin(), look.material.end(), NOTHING) != look.material.end()) {
        std::replace(look.material.begin(), look.material.end(), NOTHING,
                     uint32_t(look.materials.size()));
        look.materials.emplace_back();
    }
    load_images(library.images, look, task_);
    std::string ignored;
    for (const std::string &name : library.ignored)
        ignored += (ignored.empty() ? "" : ", ") + name;
    if (!ignored.empty())
        task_.warnings.push_back("MTL statements were ignored: " + ignored);
    if (lost_coordinates_ && !look.uv[0].empty())
        task_.warnings.push_back(std::to_string(lost_coordinates_) +
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
        task_.warnings.push_back(std::to_string(short_faces_) +
                                 " faces with fewer than three corners were dropped");
    std::string names;
    for (const std::string &name : ignored_)
        names += (names.empty() ? "" : ", ") + name;
    if (!names.empty())
        task_.warnings.push_back("OBJ statements were ignored: " + names);
}

Mesh ObjReader::read()
{
    if (std::string_view(at_, size_t(end_ - at_)).substr(0, 3) == "\xef\xbb\xbf")
        at_ += 3;
    while (at_ < end_) {
        if (line_ % 0x8000 == 0)
            task_.advance(double(at_ - begin_) / double(end_ - begin_));
        bool blank = at_line_end();
        if (!blank) {
            const char *word = at_;
            while (at_ < end_ && !std::strchr(" \t\r\n\\#", *at_))
                ++at_;
            statement({word, size_t(at_ - word)});
        }
        next_line(!blank && (at_ == end_ || *at_ != '#'));
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
