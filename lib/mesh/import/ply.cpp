/* PLY, the Stanford polygon format: ascii and binary, faces and triangle strips. */
#include "mesh/import/ply.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gtx {

namespace {

/* What a property of vertices, or a colour of faces, means: its place in a row of values. */
enum { X, Y, Z, NX, NY, NZ, RED, GREEN, BLUE, ALPHA, ROLE_COUNT };
constexpr const char *role_names[ROLE_COUNT][2] = {
    {"x", "x"},
    {"y", "y"},
    {"z", "z"},
    {"nx", "normal_x"},
    {"ny", "normal_y"},
    {"nz", "normal_z"},
    {"red", "diffuse_red"},
    {"green", "diffuse_green"},
    {"blue", "diffuse_blue"},
    {"alpha", "diffuse_alpha"},
};

/* What the properties of an element mean. */
struct Roles {
    std::vector<int> of;              /* a property; ROLE_COUNT: nobody asks for it */
    bool has[ROLE_COUNT] = {};
    double full[ROLE_COUNT] = {};

    /* Only roles from `first` on count. */
    Roles(const PlyElement &element, int first);
    bool all(int a, int b, int c) const { return has[a] && has[b] && has[c]; }
    Rgba8 color(const double *values) const;
};

Roles::Roles(const PlyElement &element, int first)
{
    for (const PlyProperty &p : element.properties) {
        int role = ROLE_COUNT;
        for (int r = first; r < ROLE_COUNT && !p.is_list; ++r)
            if (p.name == role_names[r][0] || p.name == role_names[r][1])
                role = r;
        if (role < ROLE_COUNT) {
            has[role] = true;
            full[role] = ply_full(p.type);
        }
        of.push_back(role);
    }
}

Rgba8 Roles::color(const double *v) const
{
    return {to_byte(v[RED] / full[RED]), to_byte(v[GREEN] / full[GREEN]),
            to_byte(v[BLUE] / full[BLUE]),
            has[ALPHA] ? to_byte(v[ALPHA] / full[ALPHA]) : uint8_t(255)};
}

/* The corners of faces or of strips. */
struct Lists {
    std::vector<double> values; /* each list behind its length */
    std::vector<Rgba8> colors;  /* a list each */
};

class PlyReader {
public:
    PlyReader(const std::string &bytes, Task &task)
        : begin_(bytes.data()), end_(begin_ + bytes.size()), header_(read_ply_header(bytes)),
          at_(begin_ + header_.size), task_(task)
    {
    }
    Mesh read();

private:
    size_t left() const { return size_t(end_ - at_); }
    double ascii_value();
    double value(PlyType type);
    uint64_t list_length(const PlyProperty &property);
    void skip(const PlyProperty &property);
    void check_count(const PlyElement &element);
    void progress(uint64_t row);

    void read_vertices(const PlyElement &element);
    void read_lists(const PlyElement &element, size_t list, Lists &lists);
    void skip_rows(const PlyElement &element);

    uint32_t vertex_index(double value, const char *what, size_t row);
    void cut_faces();
    void cut_strips();
    Mesh colored();
    void ignored(const PlyElement &element, const PlyProperty &property);

    const char *begin_, *end_;
    PlyHeader header_; /* its lines go on counting */
    const char *at_;
    const PlyElement *element_ = nullptr; /* at hand, for messages */
    uint64_t row_ = 0;
    Task &task_;
    VertexMesh mesh_;
    Lists faces_, strips_;
    bool faces_colored_ = false;
    std::vector<Rgba8> colors_; /* a triangle each */
    std::string ignored_;
};

/* ---- values ---- */

double PlyReader::ascii_value()
{
    for (; at_ < end_ && (*at_ == ' ' || (*at_ >= '\t' && *at_ <= '\r')); ++at_)
        header_.lines += *at_ == '\n';
    if (at_ == end_)
        fail(GTX_ERROR_INPUT, "the file ends in %s %llu of %llu", printable(element_->name).c_str(),
             (unsigned long long)row_, (unsigned long long)element_->count);
    double value = 0;
    if (!parse_number(at_, end_, value))
        fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a number", header_.lines + 1,
             printable({at_, std::min<size_t>(left(), 12)}).c_str());
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

double PlyReader::value(PlyType type)
{
    if (header_.ascii)
        return ascii_value();
    unsigned size = ply_size(type);
    if (left() < size)
        fail(GTX_ERROR_INPUT, "the file ends in %s %llu of %llu", printable(element_->name).c_str(),
             (unsigned long long)row_, (unsigned long long)element_->count);
    unsigned char bytes[8];
    std::memcpy(bytes, at_, size);
    at_ += size;
    if (header_.big_endian != host_is_big_endian())
        std::reverse(bytes, bytes + size);
    switch (type) {
    case PlyType::i8: return as<int8_t>(bytes);
    case PlyType::u8: return as<uint8_t>(bytes);
    case PlyType::i16: return as<int16_t>(bytes);
    case PlyType::u16: return as<uint16_t>(bytes);
    case PlyType::i32: return as<int32_t>(bytes);
    case PlyType::u32: return as<uint32_t>(bytes);
    case PlyType::f32: return as<float>(bytes);
    case PlyType::f64: return as<double>(bytes);
    }
    return 0;
}

/* The length, after checking that the file is long enough to hold the items. */
uint64_t PlyReader::list_length(const PlyProperty &property)
{
    double length = value(property.count_type);
    size_t item = header_.ascii ? 1 : ply_size(property.type);
    if (!(length >= 0) || length > double(left() / item))
        fail(GTX_ERROR_INPUT, "%s %llu: a list of %.0f items does not fit the file",
             printable(element_->name).c_str(), (unsigned long long)row_, length);
    return uint64_t(length);
}

void PlyReader::skip(const PlyProperty &property)
{
    for (uint64_t n = property.is_list ? list_length(property) : 1; n > 0; --n)
        value(property.type);
}

/* Before anything is allocated: does the file have room for that many rows? */
void PlyReader::check_count(const PlyElement &element)
{
    uint64_t row = 0;
    for (const PlyProperty &p : element.properties)
        row += header_.ascii ? 2 : ply_size(p.is_list ? p.count_type : p.type);
    /* The last value of an ascii file needs no blank behind it. */
    if (row && element.count > (left() + (header_.ascii ? 1 : 0)) / row)
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

void PlyReader::ignored(const PlyElement &element, const PlyProperty &property)
{
    if (ignored_.size() < 200)
        ignored_ += (ignored_.empty() ? "" : ", ") + printable(element.name) + "." +
                    printable(property.name);
}

void PlyReader::read_vertices(const PlyElement &element)
{
    const Roles roles(element, X);
    for (size_t i = 0; i < roles.of.size(); ++i)
        if (roles.of[i] == ROLE_COUNT)
            ignored(element, element.properties[i]);
    if (!roles.all(X, Y, Z))
        fail(GTX_ERROR_INPUT, "the vertices have no x, y and z");
    bool normals = roles.all(NX, NY, NZ), colors = roles.all(RED, GREEN, BLUE);
    if (element.count > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "more than %llu vertices", (unsigned long long)MAX_VERTICES);
    mesh_.positions.reserve(element.count);

    double v[ROLE_COUNT + 1] = {};
    for (uint64_t row = 0; row < element.count; ++row) {
        progress(row);
        for (size_t i = 0; i < roles.of.size(); ++i) {
            const PlyProperty &p = element.properties[i];
            if (p.is_list)
                skip(p);
            else
                v[roles.of[i]] = value(p.type);
        }
        mesh_.positions.push_back({v[X], v[Y], v[Z]});
        if (normals)
            mesh_.normals.push_back({float(v[NX]), float(v[NY]), float(v[NZ])});
        if (colors)
            mesh_.colors.push_back(roles.color(v));
    }
}

/* Keeps the lists of one property, and their colours. Faces may come before the vertices, so they
 * are cut later. */
void PlyReader::read_lists(const PlyElement &element, size_t list, Lists &lists)
{
    const Roles roles(element, RED);
    const bool colored = roles.all(RED, GREEN, BLUE);
    for (size_t i = 0; i < element.properties.size(); ++i)
        if (i != list && !(colored && roles.of[i] < ROLE_COUNT))
            ignored(element, element.properties[i]);
    lists.values.reserve(lists.values.size() + 4 * element.count); /* of triangles */
    lists.colors.reserve(lists.colors.size() + element.count);
    double v[ROLE_COUNT + 1] = {};
    for (uint64_t row = 0; row < element.count; ++row) {
        progress(row);
        for (size_t i = 0; i < element.properties.size(); ++i) {
            const PlyProperty &p = element.properties[i];
            if (i != list && !p.is_list) {
                v[roles.of[i]] = value(p.type);
                continue;
            }
            if (i != list) {
                skip(p);
                continue;
            }
            uint64_t length = list_length(p);
            lists.values.push_back(double(length));
            for (; length > 0; --length)
                lists.values.push_back(value(p.type));
        }
        lists.colors.push_back(colored ? roles.color(v) : Rgba8());
    }
    faces_colored_ = faces_colored_ || colored;
}

void PlyReader::skip_rows(const PlyElement &element)
{
    if (element.properties.empty())
        return;
    for (uint64_t row = 0; row < element.count; ++row) {
        progress(row);
        for (const PlyProperty &p : element.properties)
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

void PlyReader::cut_faces()
{
    std::vector<uint32_t> corners;
    std::vector<Vec3d> polygon;
    std::vector<std::array<uint32_t, 3>> cut;
    size_t row = 0, dropped = 0;
    for (size_t i = 0; i < faces_.values.size(); ++row) {
        size_t n = size_t(faces_.values[i++]);
        corners.clear();
        for (size_t stop = i + n; i < stop; ++i)
            corners.push_back(vertex_index(faces_.values[i], "face", row));
        if (n == 3) {
            mesh_.triangles.push_back({corners[0], corners[1], corners[2]});
        } else if (n > 3) {
            polygon.clear();
            cut.clear();
            for (uint32_t v : corners)
                polygon.push_back(mesh_.positions[v]);
            triangulate(polygon, cut);
            for (const auto &t : cut)
                mesh_.triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
        } else {
            ++dropped;
        }
        if (faces_colored_)
            colors_.resize(mesh_.triangles.size(), faces_.colors[row]);
        if (row % 0x8000 == 0)
            task_.advance(1); /* for the chance to stop */
    }
    if (dropped)
        task_.warnings.push_back(std::to_string(dropped) +
                                 " faces with fewer than three corners were dropped");
}

/* Every other triangle of a strip is turned; -1 starts a new strip. */
void PlyReader::cut_strips()
{
    size_t row = 0;
    for (size_t i = 0; i < strips_.values.size(); ++row) {
        size_t stop = i + 1 + size_t(strips_.values[i]), count = 0;
        uint32_t a = 0, b = 0;
        for (++i; i < stop; ++i) {
            if (strips_.values[i] == -1) {
                count = 0;
                continue;
            }
            uint32_t c = vertex_index(strips_.values[i], "strip", row);
            if (++count >= 3 && count % 2)
                mesh_.triangles.push_back({a, b, c});
            else if (count >= 3)
                mesh_.triangles.push_back({b, a, c});
            a = b;
            b = c;
        }
        if (faces_colored_)
            colors_.resize(mesh_.triangles.size(), strips_.colors[row]);
    }
}

/* With the faces' colours where the vertices have none. */
Mesh PlyReader::colored()
{
    const bool by_vertex = !mesh_.colors.empty();
    Mesh out = by_corner(std::move(mesh_));
    if (faces_colored_ && by_vertex)
        task_.warnings.push_back("the colours of faces were ignored, for the vertices have some");
    else if (faces_colored_)
        for (const Rgba8 &color : colors_)
            out.colors.insert(out.colors.end(), 3, color);
    return out;
}

Mesh PlyReader::read()
{
    for (const PlyElement &element : header_.elements) {
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
    if (!mesh_.positions.empty() && faces_.values.empty() && strips_.values.empty())
        fail(GTX_ERROR_UNSUPPORTED, "the file is a point cloud: it has no faces");
    cut_faces();
    cut_strips();
    if (mesh_.triangles.size() > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "more than %llu triangles", (unsigned long long)MAX_VERTICES);
    if (!ignored_.empty())
        task_.warnings.push_back("PLY properties were ignored: " + ignored_);
    return colored();
}

} // namespace

Mesh import_ply(const ModelFile &file, Task &task)
{
    return PlyReader(file.bytes, task).read();
}

} // namespace gtx
