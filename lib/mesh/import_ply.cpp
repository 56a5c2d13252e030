/* PLY, the Stanford polygon format: ascii and binary, faces and triangle strips. */
#include "mesh/import.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

namespace gtx {

namespace {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

struct TypeName {
    const char *name, *alias;
    Type type;
    unsigned size;
    double full; /* what a colour channel of full strength is */
};

constexpr TypeName types[] = {
    {"char", "int8", Type::i8, 1, 127},        {"uchar", "uint8", Type::u8, 1, 255},
    {"short", "int16", Type::i16, 2, 32767},   {"ushort", "uint16", Type::u16, 2, 65535},
    {"int", "int32", Type::i32, 4, 2147483647}, {"uint", "uint32", Type::u32, 4, 4294967295.0},
    {"float", "float32", Type::f32, 4, 1},     {"double", "float64", Type::f64, 8, 1},
};

unsigned size_of(Type type)
{
    return types[int(type)].size;
}

struct Property {
    std::string name;
    Type type;       /* of the value, or of a list's items */
    bool is_list;
    Type count_type; /* of a list's length */
};

struct Element {
    std::string name;
    uint64_t count;
    std::vector<Property> properties;
};

/* What a vertex property means: its place in a row of values. */
enum { X, Y, Z, NX, NY, NZ, RED, GREEN, BLUE, ALPHA, ROLE_COUNT };
constexpr const char *role_names[ROLE_COUNT][2] = {
    {"x", "x"},           {"y", "y"},   {"z", "z"},
    {"nx", "normal_x"},   {"ny", "normal_y"}, {"nz", "normal_z"},
    {"red", "diffuse_red"}, {"green", "diffuse_green"}, {"blue", "diffuse_blue"},
    {"alpha", "diffuse_alpha"},
};

class PlyReader {
public:
    PlyReader(const std::string &bytes, Task &task)
        : begin_(bytes.data()), at_(begin_), end_(begin_ + bytes.size()), task_(task)
    {
    }
    Mesh read();

private:
    std::vector<std::string_view> header_line();
    void header();
    void header_element(const std::vector<std::string_view> &words);
    void header_property(const std::vector<std::string_view> &words);
    Type type_named(std::string_view name);

    size_t left() const { return size_t(end_ - at_); }
    double ascii_value();
    double value(Type type);
    uint64_t list_length(const Property &property);
    void skip(const Property &property);
    void check_count(const Element &element);
    void progress(uint64_t row);

    void read_vertices(const Element &element);
    void read_lists(const Element &element, size_t list, std::vector<double> &lists);
    void skip_rows(const Element &element);

    uint32_t vertex_index(double value, const char *what, size_t row);
    void cut_faces(VertexMesh &mesh);
    void cut_strips(VertexMesh &mesh);
    void ignored(const Element &element, const Property &property);

    const char *begin_, *at_, *end_;
    size_t line_ = 0;
    bool ascii_ = false, swap_ = false;
    const Element *element_ = nullptr; /* at hand, for messages */
    uint64_t row_ = 0;
    Task &task_;
    std::vector<Element> elements_;
    VertexMesh mesh_;
    std::vector<double> faces_, strips_; /* each list behind its length */
    std::string ignored_;
};

/* ---- header ---- */

std::vector<std::string_view> PlyReader::header_line()
{
    const char *stop = std::find_if(at_, end_, [](char c) { return c == '\n' || c == '\r'; });
    ++line_;
    if (stop == end_)
        fail(GTX_ERROR_INPUT, "line %zu: the header has no end_header", line_);
    std::vector<std::string_view> words;
    for (const char *p = at_; p < stop;) {
        const char *word = p;
        while (p < stop && *p != ' ' && *p != '\t')
            ++p;
        if (p > word)
            words.push_back({word, size_t(p - word)});
        while (p < stop && (*p == ' ' || *p == '\t'))
            ++p;
    }
    at_ = stop + (*stop == '\r' && stop + 1 < end_ && stop[1] == '\n' ? 2 : 1);
    return words;
}

Type PlyReader::type_named(std::string_view name)
{
    for (const TypeName &t : types)
        if (name == t.name || name == t.alias)
            return t.type;
    fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a PLY type", line_, printable(name).c_str());
}

void PlyReader::header_element(const std::vector<std::string_view> &words)
{
    Element element = {};
    bool good = words.size() == 3;
    if (good) {
        element.name = words[1];
        const char *end = words[2].data() + words[2].size();
        auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
        good = error == std::errc() && stop == end;
    }
    if (!good)
        fail(GTX_ERROR_INPUT, "line %zu: an element needs a name and a count", line_);
    elements_.push_back(std::move(element));
}

void PlyReader::header_property(const std::vector<std::string_view> &words)
{
    bool is_list = words.size() == 5 && words[1] == "list";
    if (elements_.empty() || (words.size() != 3 && !is_list))
        fail(GTX_ERROR_INPUT, "line %zu: this is not a property of an element", line_);
    Property property;
    property.name = words.back();
    property.is_list = is_list;
    property.type = type_named(words[words.size() - 2]);
    property.count_type = is_list ? type_named(words[2]) : Type::u8;
    if (property.count_type == Type::f32 || property.count_type == Type::f64)
        fail(GTX_ERROR_INPUT, "line %zu: the length of a list is not an integer", line_);
    elements_.back().properties.push_back(std::move(property));
}

void PlyReader::header()
{
    auto first = header_line();
    if (first.size() != 1 || first[0] != "ply")
        fail(GTX_ERROR_INPUT, "the file does not start with 'ply'");
    bool has_format = false;
    for (;;) {
        auto words = header_line();
        std::string_view word = words.empty() ? "comment" : words[0];
        if (word == "end_header")
            break;
        if (word == "format" && words.size() == 3) {
            has_format = true;
            ascii_ = words[1] == "ascii";
            swap_ = words[1] == "binary_big_endian";
            if (!ascii_ && !swap_ && words[1] != "binary_little_endian")
                fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a PLY format", line_,
                     printable(words[1]).c_str());
        } else if (word == "element") {
            header_element(words);
        } else if (word == "property") {
            header_property(words);
        } else if (word != "comment" && word != "obj_info") {
            fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a PLY header line", line_,
                 printable(word).c_str());
        }
    }
    if (!has_format)
        fail(GTX_ERROR_INPUT, "the header has no format line");
}

/* ---- values ---- */

double PlyReader::ascii_value()
{
    for (; at_ < end_ && (*at_ == ' ' || (*at_ >= '\t' && *at_ <= '\r')); ++at_)
        line_ += *at_ == '\n';
    const char *start = at_ + (at_ < end_ && *at_ == '+');
    double value = 0;
    auto [stop, error] = std::from_chars(start, end_, value);
    if (at_ == end_)
        fail(GTX_ERROR_INPUT, "the file ends in %s %llu of %llu", printable(element_->name).c_str(),
             (unsigned long long)row_, (unsigned long long)element_->count);
    if (error == std::errc::result_out_of_range) /* too large or too small */
        value = std::memchr(start, '-', size_t(stop - start)) == nullptr ? HUGE_VAL : 0;
    else if (error != std::errc())
        fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a number", line_ + 1,
             printable({at_, std::min<size_t>(left(), 12)}).c_str());
    at_ = stop;
    return value;
}

template <class T> double as(const unsigned char *bytes)
{
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return double(value);
}

bool host_is_big_endian()
{
    const uint16_t one = 1;
    unsigned char first;
    std::memcpy(&first, &one, 1);
    return first == 0;
}

double PlyReader::value(Type type)
{
    if (ascii_)
        return ascii_value();
    unsigned size = size_of(type);
    if (left() < size)
        fail(GTX_ERROR_INPUT, "the file ends in %s %llu of %llu", printable(element_->name).c_str(),
             (unsigned long long)row_, (unsigned long long)element_->count);
    unsigned char bytes[8];
    std::memcpy(bytes, at_, size);
    at_ += size;
    if (swap_ != host_is_big_endian())
        std::reverse(bytes, bytes + size);
    switch (type) {
    case Type::i8: return as<int8_t>(bytes);
    case Type::u8: return as<uint8_t>(bytes);
    case Type::i16: return as<int16_t>(bytes);
    case Type::u16: return as<uint16_t>(bytes);
    case Type::i32: return as<int32_t>(bytes);
    case Type::u32: return as<uint32_t>(bytes);
    case Type::f32: return as<float>(bytes);
    case Type::f64: return as<double>(bytes);
    }
    return 0;
}

/* The length, after checking that the file is long enough to hold the items. */
uint64_t PlyReader::list_length(const Property &property)
{
    double length = value(property.count_type);
    size_t item = ascii_ ? 1 : size_of(property.type);
    if (!(length >= 0) || length > double(left() / item))
        fail(GTX_ERROR_INPUT, "%s %llu: a list of %.0f items does not fit the file",
             printable(element_->name).c_str(), (unsigned long long)row_, length);
    return uint64_t(length);
}

void PlyReader::skip(const Property &property)
{
    for (uint64_t n = property.is_list ? list_length(property) : 1; n > 0; --n)
        value(property.type);
}

/* Before anything is allocated: does the file have room for that many rows? */
void PlyReader::check_count(const Element &element)
{
    uint64_t row = 0;
    for (const Property &p : element.properties)
        row += ascii_ ? 2 : size_of(p.is_list ? p.count_type : p.type);
    /* The last value of an ascii file needs no blank behind it. */
    if (row && element.count > (left() + (ascii_ ? 1 : 0)) / row)
        fail(GTX_ERROR_INPUT, "%llu rows of element '%s' do not fit the file",
             (unsigned long long)element.count, printable(element.name).c_str());
}

void PlyReader::progress(uint64_t row)
{
    row_ = row;
    if (row % 0x8000 == 0)
        task_.advance(double(at_ - begin_) / double(end_ - begin_));
}

/* ---- elements ---- */

void PlyReader::ignored(const Element &element, const Property &property)
{
    if (ignored_.size() < 200)
        ignored_ += (ignored_.empty() ? "" : ", ") + printable(element.name) + "." +
                    printable(property.name);
}

void PlyReader::read_vertices(const Element &element)
{
    std::vector<int> roles;
    bool has[ROLE_COUNT] = {};
    double full[ROLE_COUNT] = {};
    for (const Property &p : element.properties) {
        int role = ROLE_COUNT; /* a place of its own that nobody reads */
        for (int r = 0; r < ROLE_COUNT && !p.is_list; ++r)
            if (p.name == role_names[r][0] || p.name == role_names[r][1])
                role = r;
        if (role == ROLE_COUNT) {
            ignored(element, p);
        } else {
            has[role] = true;
            full[role] = types[int(p.type)].full;
        }
        roles.push_back(role);
    }
    if (!has[X] || !has[Y] || !has[Z])
        fail(GTX_ERROR_INPUT, "the vertices have no x, y and z");
    bool normals = has[NX] && has[NY] && has[NZ], colors = has[RED] && has[GREEN] && has[BLUE];
    if (element.count > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "more than %llu vertices", (unsigned long long)MAX_VERTICES);
    mesh_.positions.reserve(element.count);

    double v[ROLE_COUNT + 1] = {};
    for (uint64_t row = 0; row < element.count; ++row) {
        progress(row);
        for (size_t i = 0; i < roles.size(); ++i) {
            const Property &p = element.properties[i];
            if (p.is_list)
                skip(p);
            else
                v[roles[i]] = value(p.type);
        }
        mesh_.positions.push_back({v[X], v[Y], v[Z]});
        if (normals)
            mesh_.normals.push_back({float(v[NX]), float(v[NY]), float(v[NZ])});
        if (colors)
            mesh_.colors.push_back(
                {to_byte(v[RED] / full[RED]), to_byte(v[GREEN] / full[GREEN]),
                 to_byte(v[BLUE] / full[BLUE]),
                 has[ALPHA] ? to_byte(v[ALPHA] / full[ALPHA]) : uint8_t(255)});
    }
}

/* Keeps the lists of one property. Faces may come before the vertices, so they are cut later. */
void PlyReader::read_lists(const Element &element, size_t list, std::vector<double> &lists)
{
    for (size_t i = 0; i < element.properties.size(); ++i)
        if (i != list)
            ignored(element, element.properties[i]);
    for (uint64_t row = 0; row < element.count; ++row) {
        progress(row);
        for (size_t i = 0; i < element.properties.size(); ++i) {
            const Property &p = element.properties[i];
            if (i != list) {
                skip(p);
                continue;
            }
            uint64_t length = list_length(p);
            lists.push_back(double(length));
            for (; length > 0; --length)
                lists.push_back(value(p.type));
        }
    }
}

void PlyReader::skip_rows(const Element &element)
{
    if (element.properties.empty())
        return;
    for (uint64_t row = 0; row < element.count; ++row) {
        progress(row);
        for (const Property &p : element.properties)
            skip(p);
    }
}

uint32_t PlyReader::vertex_index(double value, const char *what, size_t row)
{
    if (!(value >= 0 && value < double(mesh_.positions.size()) && value == std::floor(value)))
        fail(GTX_ERROR_INPUT, "%s %zu: index %.17g of %zu vertices", what, row, value,
             mesh_.positions.size());
    return uint32_t(value);
}

void PlyReader::cut_faces(VertexMesh &mesh)
{
    std::vector<uint32_t> corners;
    std::vector<Vec3d> polygon;
    std::vector<std::array<uint32_t, 3>> cut;
    size_t row = 0, dropped = 0;
    for (size_t i = 0; i < faces_.size(); ++row) {
        size_t n = size_t(faces_[i++]);
        corners.clear();
        for (size_t stop = i + n; i < stop; ++i)
            corners.push_back(vertex_index(faces_[i], "face", row));
        if (n == 3) {
            mesh.triangles.push_back({corners[0], corners[1], corners[2]});
        } else if (n > 3) {
            polygon.clear();
            cut.clear();
            for (uint32_t v : corners)
                polygon.push_back(mesh.positions[v]);
            triangulate(polygon, cut);
            for (const auto &t : cut)
                mesh.triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
        } else {
            ++dropped;
        }
        if (row % 0x8000 == 0)
            task_.advance(1);
    }
    if (dropped)
        task_.warnings.push_back(std::to_string(dropped) +
                                 " faces with fewer than three corners were dropped");
}

/* Every other triangle of a strip is turned; -1 starts a new strip. */
void PlyReader::cut_strips(VertexMesh &mesh)
{
    size_t row = 0;
    for (size_t i = 0; i < strips_.size(); ++row) {
        size_t stop = i + 1 + size_t(strips_[i]), count = 0;
        uint32_t a = 0, b = 0;
        for (++i; i < stop; ++i) {
            if (strips_[i] == -1) {
                count = 0;
                continue;
            }
            uint32_t c = vertex_index(strips_[i], "strip", row);
            if (++count >= 3 && count % 2)
                mesh.triangles.push_back({a, b, c});
            else if (count >= 3)
                mesh.triangles.push_back({b, a, c});
            a = b;
            b = c;
        }
    }
}

Mesh PlyReader::read()
{
    header();
    for (const Element &element : elements_) {
        element_ = &element;
        check_count(element);
        size_t list = 0, properties = element.properties.size();
        while (list < properties && !(element.properties[list].is_list &&
                                      (element.properties[list].name == "vertex_indices" ||
                                       element.properties[list].name == "vertex_index")))
            ++list;
        if (element.name == "vertex" && mesh_.positions.empty())
            read_vertices(element);
        else if (element.name == "face" && list < properties)
            read_lists(element, list, faces_);
        else if (element.name == "tristrips" && list < properties)
            read_lists(element, list, strips_);
        else
            skip_rows(element);
    }
    if (!mesh_.positions.empty() && faces_.empty() && strips_.empty())
        fail(GTX_ERROR_UNSUPPORTED, "the file is a point cloud: it has no faces");
    cut_faces(mesh_);
    cut_strips(mesh_);
    if (mesh_.triangles.size() > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "more than %llu triangles", (unsigned long long)MAX_VERTICES);
    if (!ignored_.empty())
        task_.warnings.push_back("PLY properties were ignored: " + ignored_);
    return by_corner(std::move(mesh_));
}

} // namespace

Mesh import_ply(const ModelFile &file, Task &task)
{
    return PlyReader(file.bytes, task).read();
}

} // namespace gtx
