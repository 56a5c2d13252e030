/* Reading a model file: its bytes, inflated if need be, to the importer of its format. */
#include "mesh/import/import.hpp"

#include "base/alloc.h"
#include "base/file.h"

#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>

#define ZLIB_CONST
#include <zlib.h>

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

std::string printable(std::string_view text, size_t longest)
{
    std::string out;
    for (char c : text.substr(0, longest))
        out += c >= ' ' && c <= '~' ? c : '?';
    return text.size() > longest ? out + "..." : out;
}

/* A whole number of few digits, as indices are: it needs no rounding. */
static bool parse_whole(const char *&at, const char *end, double &value)
{
    constexpr int MAX_DIGITS = 15;
    const char *p = at;
    for (value = 0; p < end && *p >= '0' && *p <= '9'; ++p)
        value = 10 * value + (*p - '0');
    const bool whole = p > at && p - at <= MAX_DIGITS &&
                       (p == end || (*p != '.' && *p != 'e' && *p != 'E'));
    at = whole ? p : at;
    return whole;
}

bool parse_number(const char *&at, const char *end, double &value)
{
    if (parse_whole(at, end, value))
        return true;
    const char *start = at + (at < end && *at == '+');
    auto [stop, error] = std::from_chars(start, end, value);
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

Bytes read_whole_file(const std::string &path, Task &task, gtx_file_look look, void *user)
{
    gtx_file_bytes file = {};
    gtx_error error;
    file.allocator = gtx_allocator_or_default(nullptr);
    file.limit = task.limits.given().memory;
    file.look = look;
    file.user = user;
    require_ok(gtx_read_file(path.c_str(), "the file", &file, &error), error);
    std::unique_ptr<gtx_file_bytes, void (*)(gtx_file_bytes *)> owner(&file, gtx_free_file);
    task.limits.read(path, file.size);
    TakenMemory taken(file.capacity);
    return Bytes(reinterpret_cast<const char *>(file.data), file.size);
}

Bytes read_file_beside(const std::string &path, Task &task)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        fail(GTX_ERROR_READ, "cannot open the file: %s",
             error ? error.message().c_str() : "it is not a regular file");
    return read_whole_file(path, task);
}

static const char GZIP_MAGIC[] = "\x1f\x8b";

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

namespace {
/* Who looks at the first bytes of a file, and once more at those that gzip has packed. */
struct Look {
    gtx_file_look look;
    std::string path;

    static gtx_result at_packed(const uint8_t *head, size_t size, uint64_t file_size, void *self,
                                gtx_error *error)
    {
        const bool is_gzip = size >= 2 && !std::memcmp(head, GZIP_MAGIC, 2);
        return is_gzip ? GTX_OK : static_cast<Look *>(self)->at(head, size, file_size, error);
    }
    gtx_result at(const uint8_t *head, size_t size, uint64_t file_size, gtx_error *error)
    {
        return look(head, size, file_size, &path, error);
    }
};
} // namespace

/* All members of a gzip file, one after another; what follows the last is ignored as gzip does. */
static Bytes inflate_gzip(std::string_view packed, Look &look, Task &task)
{
    z_stream stream = {};
    if (inflateInit2(&stream, 15 + 16) != Z_OK)
        fail(GTX_ERROR_MEMORY, "not enough memory to inflate the file");
    std::unique_ptr<z_stream, int (*)(z_stream *)> guard(&stream, inflateEnd);
    Bytes out;
    bool looked = false;
    Vector<char> block(size_t(1) << 20);
    size_t at = 0;
    for (int status = Z_OK; status != Z_STREAM_END || packed.compare(at, 2, GZIP_MAGIC) == 0;) {
        if (status == Z_STREAM_END)
            inflateReset(&stream);
        size_t input = std::min(packed.size() - at, block.size());
        stream.next_in = reinterpret_cast<const Bytef *>(packed.data() + at);
        stream.avail_in = uInt(input);
        stream.next_out = reinterpret_cast<Bytef *>(block.data());
        stream.avail_out = uInt(block.size());
        status = inflate(&stream, Z_NO_FLUSH);
        if (status == Z_MEM_ERROR)
            throw std::bad_alloc();
        if (status == Z_BUF_ERROR)
            fail(GTX_ERROR_INPUT, "the gzip data ends too early");
        if (status != Z_OK && status != Z_STREAM_END)
            fail(GTX_ERROR_INPUT, "the gzip data is damaged at byte %zu", at);
        at += input - stream.avail_in;
        out.append(block.data(), block.size() - stream.avail_out);
        if (!looked && (out.size() >= GTX_FILE_HEAD || status == Z_STREAM_END)) {
            gtx_error error;
            const auto *head = reinterpret_cast<const uint8_t *>(out.data());
            const size_t size = std::min(out.size(), size_t(GTX_FILE_HEAD));
            require_ok(look.at(head, size, 0, &error), error);
            looked = true;
        }
        task.advance(0.1 * double(at) / double(packed.size()));
    }
    return out;
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

/* What runs out of memory, or of a container's longest length, says so. */
template <class Body> static auto within_memory(Body body)
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        fail(GTX_ERROR_MEMORY, "not enough memory to read the model");
    } catch (const std::length_error &) {
        fail(GTX_ERROR_MEMORY, "not enough memory to read the model");
    }
}

static ModelFile unpacked(Bytes bytes, Look &look, Task &task)
{
    if (starts_with(bytes, GZIP_MAGIC))
        bytes = inflate_gzip(bytes, look, task);
    return ModelFile{look.path, std::move(bytes), nullptr};
}

ModelFile model_in_memory(std::string_view bytes, const std::string &path, Task &task)
{
    return within_memory([&] {
        Look look = {look_for_model, path};
        task.limits.read("", bytes.size());
        return unpacked(Bytes(bytes), look, task);
    });
}

ModelFile read_packed_file(const std::string &path, Task &task, gtx_file_look first)
{
    return within_memory([&] {
        Look look = {first, path};
        return unpacked(read_whole_file(path, task, Look::at_packed, &look), look, task);
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
    task.limits.require(GTX_LIMITED_TRIANGLES, "the model", mesh.triangles.size());
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
