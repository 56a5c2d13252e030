/* From the bytes of a model file to the importer of its format. */
#include "mesh/import/import.hpp"

#include "mesh/number.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <set>

namespace gtx {

struct Format {
    const char *extension;
    const char *magic; /* the first bytes of such a file; null when there are none */
    bool always;       /* of every one */
    Mesh (*import)(const ModelFile &, Task &);
    void (*references)(const ModelFile &, Task &, Vector<std::string> &); /* null: it is alone */
};

static const Format formats[] = {
    {".glb", "glTF", true, import_gltf, gltf_references},
    {".gltf", "{", true, import_gltf, gltf_references},
    {".drc", "DRACO", true, import_draco, nullptr},
    {".ply", "ply\n", true, import_ply, nullptr},
    {".ply", "ply\r", true, import_ply, nullptr},
    {".off", "OFF", false, import_off, nullptr},
    {".off", "COFF", false, import_off, nullptr},
    {".off", "NOFF", false, import_off, nullptr},
    {".off", "STOFF", false, import_off, nullptr},
    {".stl", "solid", false, import_stl, nullptr},
    {".obj", nullptr, false, import_obj, obj_references},
};

void fail(gtx_result result, const char *format, ...)
{
    char message[240];
    va_list args;
    va_start(args, format);
    std::vsnprintf(message, sizeof message, format, args);
    va_end(args);
    throw Error(result, message);
}

void require_triangles(uint64_t count, const Task &task)
{
    task.limits.require(GTX_LIMITED_TRIANGLES, "the model", count);
    if (count > MAX_VERTICES)
        fail(GTX_ERROR_LIMIT, "more than %llu triangles", (unsigned long long)MAX_VERTICES);
}

std::string printable(std::string_view text, size_t longest)
{
    std::string out;
    for (char c : text.substr(0, longest))
        out += c >= ' ' && c <= '~' ? c : '?';
    return text.size() > longest ? out + "..." : out;
}

/* A number of few digits and no exponent, as nearly all are: both its digits and the power of ten
 * that divides them are doubles, so that it is rounded once (Clinger 1990). */
static bool parse_short(const char *&at, const char *end, double &value)
{
    constexpr int MAX_DIGITS = 15;
    static const double POWERS[MAX_DIGITS + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    const char *p = at + (at < end && *at == '-'), *const first = p;
    uint64_t digits = 0;
    auto read_digits = [&] {
        const char *from = p;
        for (; p < end && *p >= '0' && *p <= '9'; ++p)
            digits = 10 * digits + uint64_t(*p - '0');
        return p - from;
    };
    const ptrdiff_t whole = read_digits();
    const bool has_point = whole && p < end && *p == '.';
    p += has_point;
    const ptrdiff_t part = has_point ? read_digits() : 0;
    if (!whole || (has_point && !part) || whole + part > MAX_DIGITS ||
        (p < end && (*p == 'e' || *p == 'E')))
        return false;
    value = double(digits) / POWERS[part];
    value = first > at ? -value : value;
    at = p;
    return true;
}

bool parse_number(const char *&at, const char *end, double &value)
{
    if (parse_short(at, end, value))
        return true;
    const char *start = at + (at < end && *at == '+');
    auto [stop, error] = number_from(start, end, value);
    if (error == std::errc::result_out_of_range) { /* too large or too small? */
        std::string_view text(start, size_t(stop - start));
        bool negative = text[0] == '-';
        size_t exponent = text.find_first_of("eE");
        bool small = exponent != text.npos ? text[exponent + 1] == '-' : text[negative] == '0';
        value = small ? 0 : negative ? -HUGE_VAL : HUGE_VAL;
    } else if (error != std::errc()) {
        return false;
    }
    at = stop;
    return true;
}

static bool starts_with(std::string_view bytes, const char *magic)
{
    return magic && bytes.substr(0, std::char_traits<char>::length(magic)) == magic;
}

std::string model_extension(const std::string &path)
{
    std::filesystem::path name = path;
    if (name.extension() == ".gz")
        name = name.stem();
    std::string extension = name.extension().string();
    for (char &c : extension)
        c = c >= 'A' && c <= 'Z' ? char(c + 'a' - 'A') : c;
    return extension;
}

static const Format *find_by_content(std::string_view text)
{
    if (starts_with(text, "\xef\xbb\xbf"))
        text.remove_prefix(3);
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    for (const Format &format : formats)
        if (starts_with(text, format.magic))
            return &format;
    return nullptr;
}

static const Format *find_by_name(const std::string &path)
{
    const std::string extension = model_extension(path);
    for (const Format &format : formats)
        if (extension == format.extension)
            return &format;
    return nullptr;
}

bool is_model_name(const std::string &path)
{
    return find_by_name(path) != nullptr;
}

/* By content; then by the name, so that a damaged file is called that and not unknown. */
static const Format *find_format(const ModelFile &file)
{
    const Format *format = find_by_content(file.bytes);
    return format ? format : find_by_name(file.path);
}

[[noreturn]] static void fail_unknown(const std::string &path)
{
    fail(GTX_ERROR_UNSUPPORTED, "'%s' is none of OBJ, PLY, OFF, STL, Draco, glTF and GLB",
         printable(std::filesystem::path(path).filename().string()).c_str());
}

/* A file whose first bytes cannot be a model's need not be read, or inflated, to its end. */
static void require_model(const std::string &path, std::string_view head)
{
    if (find_by_content(head))
        return;
    const Format *format = find_by_name(path);
    if (!format)
        fail_unknown(path);
    if (format->always)
        fail(GTX_ERROR_INPUT, "the file does not start as a %s file does", format->extension + 1);
    if (format->import == import_stl)
        require_facets(head);
    else if (head.find('\0') != head.npos)
        fail(GTX_ERROR_INPUT, "the file has a zero byte, which no text has");
}

/* A gtx_file_look; `user` is the path. */
static gtx_result look_for_model(const uint8_t *head, size_t size, uint64_t, void *user,
                                 gtx_error *error)
{
    const std::string_view text(reinterpret_cast<const char *>(head), size);
    if (size < GTX_FILE_HEAD)
        return GTX_OK; /* what is small is left to its importer, which says more */
    try {
        require_model(*static_cast<std::string *>(user), text);
        return GTX_OK;
    } catch (...) {
        *error = caught_error();
        return error->result;
    }
}

Mesh by_corner(VertexMesh &&from)
{
    Mesh to;
    to.positions = std::move(from.positions);
    to.triangles = std::move(from.triangles);
    if (!from.normals.empty()) {
        to.normals.reserve(to.triangles.size() * 3);
        for (const auto &t : to.triangles)
            for (uint32_t v : t)
                to.normals.push_back(from.normals[v]);
    }
    if (!from.colors.empty()) {
        to.colors.reserve(to.triangles.size() * 3);
        for (const auto &t : to.triangles)
            for (uint32_t v : t)
                to.colors.push_back(from.colors[v]);
    }
    return to;
}

ModelFile model_in_memory(std::string_view bytes, const std::string &path, Task &task)
{
    return within_memory([&] {
        task.limits.read("", bytes.size());
        return unpacked_file(Bytes(bytes), path, task, look_for_model);
    });
}

ModelFile read_model(const std::string &path, Task &task)
{
    return read_packed_file(path, task, look_for_model);
}

Vector<std::string> referenced_files(const ModelFile &file, Task &task)
{
    return within_memory([&] {
        Vector<std::string> paths, once;
        const Format *format = find_format(file);
        if (format && format->references)
            format->references(file, task, paths);
        std::set<std::string> seen = {""};
        for (std::string &path : paths)
            if (seen.insert(path).second)
                once.push_back(std::move(path));
        return once;
    });
}

Mesh import_model(const ModelFile &file, Task &task)
{
    const Format *format = find_format(file);
    if (!format)
        fail_unknown(file.path);
    Mesh mesh = within_memory([&] { return format->import(file, task); });
    if (mesh.triangles.empty())
        fail(GTX_ERROR_EMPTY, "the model has no triangle");
    require_triangles(mesh.triangles.size(), task);
    if (!file.textures.base_color.empty() &&
        ((format->import != import_obj && format->import != import_gltf) ||
         mesh.appearance.uv[0].empty()))
        task.warn(GTX_WARNING_IGNORED_TEXTURE,
                  "the base colour was ignored: it is for OBJ and glTF models with texture "
                  "coordinates");
    task.advance(1);
    return mesh;
}

Mesh import_mesh(const std::string &path, Task &task, Vector<std::string> *sources)
{
    ModelFile file = read_model(path, task);
    file.sources = sources;
    if (sources)
        sources->push_back(path);
    return import_model(file, task);
}

} // namespace gtx
