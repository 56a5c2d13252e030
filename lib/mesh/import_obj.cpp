/* Wavefront OBJ: positions with colours, normals and polygons. */
#include "mesh/import.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace gtx {

namespace {

constexpr uint32_t no_normal = 0xffffffff;

class ObjReader {
public:
    ObjReader(const std::string &text, Task &task)
        : begin_(text.data()), at_(begin_), end_(begin_ + text.size()), task_(task)
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
    void triangle(uint32_t a, uint32_t b, uint32_t c);
    void ignore(std::string_view word);
    void finish();

    const char *begin_, *at_, *end_;
    size_t line_ = 1;
    Task &task_;
    Mesh mesh_;
    std::vector<Vec3f> normals_;
    std::vector<Rgba8> colors_;                      /* by vertex, or empty */
    std::vector<uint32_t> corners_, corner_normals_; /* of the face at hand */
    std::vector<Vec3d> polygon_;
    std::vector<std::array<uint32_t, 3>> cut_;
    std::vector<std::string> ignored_; /* statements, in the order found */
    size_t short_faces_ = 0;
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
    uint32_t v = 0, normal = no_normal;
    bool good = index(mesh_.positions.size(), "vertex", v);
    if (good && at_ < end_ && *at_ == '/') {
        int64_t coordinate;
        at_ = std::from_chars(at_ + 1, end_, coordinate).ptr;
        if (at_ < end_ && *at_ == '/') {
            ++at_;
            index(normals_.size(), "normal", normal); /* "v/vt/" is met in the wild */
        }
    }
    const char *stop = at_;
    if (!good || !(at_line_end() || at_ != stop))
        fail(GTX_ERROR_INPUT, "line %zu: a corner of a face is not v, v/vt, v//vn or v/vt/vn",
             line_);
    corners_.push_back(v);
    corner_normals_.push_back(normal);
    return true;
}

void ObjReader::triangle(uint32_t a, uint32_t b, uint32_t c)
{
    bool has_normals = corner_normals_[a] != no_normal || corner_normals_[b] != no_normal ||
                       corner_normals_[c] != no_normal;
    if (has_normals)
        mesh_.normals.resize(mesh_.triangles.size() * 3);
    mesh_.triangles.push_back({corners_[a], corners_[b], corners_[c]});
    if (!mesh_.normals.empty() || has_normals)
        for (uint32_t k : {a, b, c}) {
            uint32_t n = corner_normals_[k];
            mesh_.normals.push_back(n == no_normal ? Vec3f() : normals_[n]);
        }
}

void ObjReader::face()
{
    corners_.clear();
    corner_normals_.clear();
    while (corner())
        ;
    if (corners_.size() < 3) {
        ++short_faces_;
    } else if (corners_.size() == 3) {
        triangle(0, 1, 2);
    } else {
        polygon_.clear();
        cut_.clear();
        for (uint32_t v : corners_)
            polygon_.push_back(mesh_.positions[v]);
        triangulate(polygon_, cut_);
        for (const auto &t : cut_)
            triangle(t[0], t[1], t[2]);
    }
    if (mesh_.triangles.size() > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "line %zu: more than %llu triangles", line_,
             (unsigned long long)MAX_VERTICES);
}

void ObjReader::ignore(std::string_view word)
{
    static const char *const silent[] = {"vt", "o", "g", "s", "vp"};
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
    } else if (word == "f") {
        face();
    } else {
        ignore(word);
    }
}

void ObjReader::finish()
{
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
    return ObjReader(file.bytes, task).read();
}

} // namespace gtx
