/* Geomview OFF: polygons, with colours and normals by vertex. */
#include "mesh/import/text.hpp"

namespace gtx {

namespace {

/* What the keyword says of the vertices. */
struct OffKind {
    bool texture = false, color = false, normal = false;
};

class OffReader {
public:
    OffReader(std::string_view text, Task &task) : text_(text, task), task_(task) {}
    Mesh read();

private:
    OffKind keyword();
    void counts();
    void vertex(const OffKind &kind);
    void face();
    void finish();

    TextReader text_;
    Task &task_;
    VertexMesh mesh_;
    Vector<std::array<float, 4>> colors_;
    float largest_color_ = 0;
    uint64_t vertices_ = 0, faces_ = 0, short_faces_ = 0;
    bool has_face_colors_ = false;
    Vector<uint32_t> corners_;
    Vector<Vec3d> polygon_;
    Vector<std::array<uint32_t, 3>> cut_;
};

/* [ST][C][N][4][n]OFF [BINARY]; a file may do without and start with its counts. */
OffKind OffReader::keyword()
{
    OffKind kind;
    if (!text_.find_word())
        fail(GTX_ERROR_INPUT, "the OFF file is empty");
    std::string_view word = text_.peek();
    const char *start = word.data();
    auto take = [&](std::string_view prefix) {
        bool has = word.substr(0, prefix.size()) == prefix;
        word.remove_prefix(has ? prefix.size() : 0);
        return has;
    };
    kind.texture = take("ST");
    kind.color = take("C");
    kind.normal = take("N");
    const bool four = take("4"), more_dimensions = take("n") || four;
    bool glued = word.size() > 3 && word[3] >= '0' && word[3] <= '9'; /* "OFF8 6 12" is met */
    if (word.substr(0, 3) != "OFF" || (word.size() > 3 && !glued))
        return {};
    text_.skip(size_t(word.data() - start) + 3);
    if (more_dimensions)
        fail(GTX_ERROR_UNSUPPORTED, "OFF vertices in more than three dimensions");
    if (!text_.at_line_end() && text_.peek() == "BINARY")
        fail(GTX_ERROR_UNSUPPORTED, "binary OFF");
    return kind;
}

/* Vertices, faces, and edges, which nobody needs. */
void OffReader::counts()
{
    vertices_ = text_.integer("the count of vertices");
    faces_ = text_.integer("the count of faces");
    if (!text_.at_line_end())
        text_.integer("the count of edges");
    if (vertices_ > MAX_VERTICES || faces_ > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "%llu vertices and %llu faces are more than %llu",
             (unsigned long long)vertices_, (unsigned long long)faces_,
             (unsigned long long)MAX_VERTICES);
    /* A vertex takes six characters and a face eight: a lying count is found before it costs. */
    mesh_.positions.reserve(size_t(std::min<uint64_t>(vertices_, text_.left() / 6)));
    mesh_.triangles.reserve(size_t(std::min<uint64_t>(faces_, text_.left() / 8)));
}

/* x y z, then nx ny nz, then r g b or r g b a, then s t. */
void OffReader::vertex(const OffKind &kind)
{
    double v[6] = {};
    for (int k = 0; k < (kind.normal ? 6 : 3); ++k)
        v[k] = text_.number(k < 3 ? "a coordinate" : "a normal");
    mesh_.positions.push_back({v[0], v[1], v[2]});
    if (kind.normal)
        mesh_.normals.push_back({float(v[3]), float(v[4]), float(v[5])});
    if (!kind.color) {
        for (int k = 0; k < 2 && kind.texture; ++k)
            text_.number("a texture coordinate");
        return;
    }
    float more[6];
    int count = 0, wanted = kind.texture ? 2 : 0;
    for (; count < 6 && !text_.at_line_end(); ++count)
        more[count] = float(text_.number("a colour"));
    if (!text_.at_line_end() || count < wanted + 3 || count > wanted + 4)
        fail(GTX_ERROR_INPUT, "line %zu: the colour of a vertex is not three or four numbers",
             text_.line());
    std::array<float, 4> color = {more[0], more[1], more[2], -1};
    if (count == wanted + 4)
        color[3] = more[3];
    for (float c : color)
        largest_color_ = std::max(largest_color_, c);
    colors_.push_back(color);
}

void OffReader::face()
{
    uint64_t size = text_.integer("the size of a face");
    corners_.clear();
    for (uint64_t i = 0; i < size; ++i) {
        uint64_t v = text_.integer("a corner");
        if (v >= vertices_)
            fail(GTX_ERROR_INPUT, "line %zu: vertex %llu of a face, but there are %llu",
                 text_.line(), (unsigned long long)v, (unsigned long long)vertices_);
        corners_.push_back(uint32_t(v));
    }
    has_face_colors_ |= !text_.at_line_end();
    text_.next_line();
    if (size < 3) {
        ++short_faces_;
        return;
    }
    polygon_.clear();
    cut_.clear();
    for (uint32_t v : corners_)
        polygon_.push_back(mesh_.positions[v]);
    triangulate(polygon_, cut_);
    for (const auto &t : cut_)
        mesh_.triangles.push_back({corners_[t[0]], corners_[t[1]], corners_[t[2]]});
    require_triangles(mesh_.triangles.size(), task_);
}

void OffReader::finish()
{
    /* Geomview writes 0..1 and most others 0..255, both with and without a point. */
    double full = largest_color_ > 1 ? 255 : 1;
    for (const auto &c : colors_)
        mesh_.colors.push_back({to_byte(c[0] / full), to_byte(c[1] / full), to_byte(c[2] / full),
                                c[3] < 0 ? uint8_t(255) : to_byte(c[3] / full)});
    if (short_faces_)
        task_.warn(GTX_WARNING_DEGENERATE, std::to_string(short_faces_) +
                                               " faces with fewer than three corners were dropped");
    if (has_face_colors_)
        task_.warn(GTX_WARNING_IGNORED_COLORS, "colours of faces were ignored");
    if (text_.find_word())
        task_.warn(GTX_WARNING_IGNORED_DATA, "text behind the last face was ignored");
}

Mesh OffReader::read()
{
    OffKind kind = keyword();
    counts();
    for (uint64_t i = 0; i < vertices_; ++i)
        vertex(kind);
    for (uint64_t i = 0; i < faces_; ++i)
        face();
    finish();
    return by_corner(std::move(mesh_));
}

} // namespace

Mesh import_off(const ModelFile &file, Task &task)
{
    return OffReader(file.bytes, task).read();
}

} // namespace gtx
