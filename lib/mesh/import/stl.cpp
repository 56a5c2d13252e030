/* Stereolithography, text and binary: loose triangles. */
#include "mesh/import/text.hpp"

#include "base/bytes.h"

namespace gtx {

/* A header that means nothing, a count, and for each facet its normal, three corners, two bytes. */
static constexpr size_t HEADER = 80, PROLOGUE = HEADER + 4, FACET = 50;

static const uint8_t *bytes_at(std::string_view bytes, size_t at)
{
    return reinterpret_cast<const uint8_t *>(bytes.data()) + at;
}

/* Binary files may start with "solid" too. No text has a zero in it, and where a text has its 80th
 * character a binary file would count 150 million facets. */
static bool is_text(std::string_view bytes)
{
    size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
    if (bytes.substr(start, 5) != "solid" || bytes.substr(0, PROLOGUE).find('\0') != bytes.npos)
        return false;
    return bytes.size() < PROLOGUE ||
           bytes.size() != PROLOGUE + FACET * uint64_t(gtx_load_u32(bytes_at(bytes, HEADER)));
}

static Mesh read_binary(std::string_view bytes, Task &task)
{
    if (bytes.size() < PROLOGUE)
        fail(GTX_ERROR_INPUT, "an STL file of %zu bytes ends in its header", bytes.size());
    uint64_t count = gtx_load_u32(bytes_at(bytes, HEADER)), size = PROLOGUE + FACET * count;
    if (size > bytes.size())
        fail(GTX_ERROR_INPUT, "%llu STL facets take %llu bytes, the file has %zu",
             (unsigned long long)count, (unsigned long long)size, bytes.size());
    if (3 * count > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "more than %llu vertices", (unsigned long long)MAX_VERTICES);
    require_triangles(count, task);
    Mesh mesh;
    bool has_colors = false;
    mesh.positions.reserve(size_t(3 * count));
    mesh.triangles.reserve(size_t(count));
    for (uint32_t t = 0; t < count; ++t) {
        const uint8_t *facet = bytes_at(bytes, PROLOGUE + FACET * t);
        for (const uint8_t *p = facet + 12; p < facet + 48; p += 12)
            mesh.positions.push_back(
                {gtx_load_f32(p), gtx_load_f32(p + 4), gtx_load_f32(p + 8)});
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
        has_colors |= gtx_load_u16(facet + 48) != 0;
        if (t % 0x8000 == 0)
            task.advance(double(t) / double(count));
    }
    if (has_colors)
        task.warn(GTX_WARNING_IGNORED_COLORS, "colours of STL facets were ignored");
    if (size < bytes.size())
        task.warn(GTX_WARNING_IGNORED_DATA, "bytes behind the last facet were ignored");
    return mesh;
}

/* ---- text ---- */

/* The next word in lower case, which some programs do not write; empty at the end of the text. */
static std::string keyword(TextReader &text)
{
    if (!text.find_word())
        return "";
    std::string word(text.word());
    for (char &c : word)
        c = c >= 'A' && c <= 'Z' ? char(c + 'a' - 'A') : c;
    return word;
}

static void expect(TextReader &text, const char *wanted)
{
    std::string word = keyword(text);
    if (word.empty())
        fail(GTX_ERROR_INPUT, "the STL file ends where '%s' is to follow", wanted);
    if (word != wanted)
        fail(GTX_ERROR_INPUT, "line %zu: '%s' where '%s' is to follow", text.line(),
             printable(word, 12).c_str(), wanted);
}

/* From behind "facet"; its normal, which the corners say better, is on the same line. */
static void read_facet(TextReader &text, Vector<Vec3d> &polygon)
{
    polygon.clear();
    text.next_line();
    expect(text, "outer");
    expect(text, "loop");
    for (;;) {
        std::string word = keyword(text);
        if (word == "endloop" && polygon.size() >= 3)
            break;
        if (word != "vertex")
            fail(GTX_ERROR_INPUT, "line %zu: corner %zu of a facet is missing", text.line(),
                 polygon.size() + 1);
        Vec3d p;
        for (int k = 0; k < 3; ++k)
            p[k] = text.number("a coordinate");
        polygon.push_back(p);
    }
    expect(text, "endfacet");
}

static Mesh read_text(std::string_view bytes, Task &task)
{
    Mesh mesh;
    TextReader text(bytes, task);
    Vector<Vec3d> polygon;
    Vector<std::array<uint32_t, 3>> cut;
    bool inside = false;
    for (;;) {
        std::string word = keyword(text);
        if (word.empty())
            break;
        if (word == (inside ? "endsolid" : "solid")) {
            inside = !inside;
            text.next_line(); /* a name follows */
            continue;
        }
        if (!inside || word != "facet")
            fail(GTX_ERROR_INPUT, "line %zu: '%s' where '%s' is to follow", text.line(),
                 printable(word, 12).c_str(), inside ? "facet" : "solid");
        read_facet(text, polygon);
        if (mesh.positions.size() + polygon.size() > MAX_VERTICES)
            fail(GTX_ERROR_LIMIT, "more than %llu vertices", (unsigned long long)MAX_VERTICES);
        uint32_t first = uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), polygon.begin(), polygon.end());
        cut.clear();
        triangulate(polygon, cut);
        for (const auto &t : cut)
            mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        require_triangles(mesh.triangles.size(), task);
    }
    if (inside)
        fail(GTX_ERROR_INPUT, "the STL file ends where 'endsolid' is to follow");
    return mesh;
}

void require_facets(std::string_view head)
{
    if (head.size() >= PROLOGUE && !is_text(head) && !gtx_load_u32(bytes_at(head, HEADER)))
        fail(GTX_ERROR_EMPTY, "the STL file has no facet");
}

Mesh import_stl(const ModelFile &file, Task &task)
{
    return is_text(file.bytes) ? read_text(file.bytes, task) : read_binary(file.bytes, task);
}

} // namespace gtx
