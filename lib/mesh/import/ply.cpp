/* PLY, the Stanford polygon format: ascii and binary, faces and triangle strips. */
#include "mesh/import/ply.hpp"

#include <algorithm>
#include <cmath>

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
    Vector<int> of;                   /* a property; ROLE_COUNT: nobody asks for it */
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
    Vector<double> values;      /* each list behind its length */
    Vector<Rgba8> colors;       /* a list each */
};

class PlyReader {
public:
    PlyReader(std::string_view bytes, Task &task)
        : header_(read_ply_header(bytes)), values_(bytes, header_, task), task_(task)
    {
    }
    Mesh read();

private:
    void read_vertices(const PlyElement &element);
    void read_lists(const PlyElement &element, size_t list, Lists &lists);
    void skip_rows(const PlyElement &element);

    uint32_t vertex_index(double value, const char *what, size_t row);
    void cut_faces();
    void cut_strips();
    Mesh colored();
    void ignored(const PlyElement &element, const PlyProperty &property);

    const PlyHeader header_;
    PlyValues values_;
    Task &task_;
    VertexMesh mesh_;
    Lists faces_, strips_;
    bool faces_colored_ = false;
    Vector<Rgba8> colors_;      /* a triangle each */
    std::string ignored_;
};

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
        values_.begin_row(row);
        for (size_t i = 0; i < roles.of.size(); ++i) {
            const PlyProperty &p = element.properties[i];
            if (p.is_list)
                values_.skip(p);
            else
                v[roles.of[i]] = values_.value(p.type);
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
        values_.begin_row(row);
        for (size_t i = 0; i < element.properties.size(); ++i) {
            const PlyProperty &p = element.properties[i];
            if (i != list && !p.is_list) {
                v[roles.of[i]] = values_.value(p.type);
                continue;
            }
            if (i != list) {
                values_.skip(p);
                continue;
            }
            uint64_t length = values_.list_length(p);
            lists.values.push_back(double(length));
            for (; length > 0; --length)
                lists.values.push_back(values_.value(p.type));
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
        values_.begin_row(row);
        for (const PlyProperty &p : element.properties)
            values_.skip(p);
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
    Vector<uint32_t> corners;
    Vector<Vec3d> polygon;
    Vector<std::array<uint32_t, 3>> cut;
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
        require_triangles(mesh_.triangles.size(), task_);
        if (faces_colored_)
            colors_.resize(mesh_.triangles.size(), faces_.colors[row]);
        if (row % 0x8000 == 0)
            task_.advance(1); /* for the chance to stop */
    }
    if (dropped)
        task_.warn(GTX_WARNING_DEGENERATE, std::to_string(dropped) +
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
        require_triangles(mesh_.triangles.size(), task_);
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
        task_.warn(GTX_WARNING_IGNORED_COLORS,
                   "the colours of faces were ignored, for the vertices have some");
    else if (faces_colored_)
        for (const Rgba8 &color : colors_)
            out.colors.insert(out.colors.end(), 3, color);
    return out;
}

Mesh PlyReader::read()
{
    for (const PlyElement &element : header_.elements) {
        values_.begin(element);
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
    if (!ignored_.empty())
        task_.warn(GTX_WARNING_IGNORED_DATA, "PLY properties were ignored: " + ignored_);
    return colored();
}

} // namespace

Mesh import_ply(const ModelFile &file, Task &task)
{
    return PlyReader(file.bytes, task).read();
}

} // namespace gtx
