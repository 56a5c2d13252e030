/* Reading a model file: its bytes, inflated if need be, to the importer of its format. */
#include "mesh/import/import.hpp"

#include "base/alloc.h"
#include "base/file.h"

#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>

#define ZLIB_CONST
#include <zlib.h>

namespace gtx {

/* A gzip file of a few megabytes can claim any size. */
static const uint64_t max_inflated_bytes = uint64_t(1) << 32;

struct Format {
    const char *extension;
    const char *magic; /* the first bytes of every such file; null when there are none */
    Mesh (*import)(const ModelFile &, Task &);
    void (*references)(const ModelFile &, Vector<std::string> &);      /* null: it is alone */
};

static const Format formats[] = {
    {".glb", "glTF", import_gltf, gltf_references},
    {".gltf", "{", import_gltf, gltf_references},
    {".drc", "DRACO", import_draco, nullptr},
    {".ply", "ply\n", import_ply, nullptr},
    {".ply", "ply\r", import_ply, nullptr},
    {".off", "OFF", import_off, nullptr},
    {".off", "COFF", import_off, nullptr},
    {".off", "NOFF", import_off, nullptr},
    {".off", "STOFF", import_off, nullptr},
    {".stl", "solid", import_stl, nullptr},
    {".obj", nullptr, import_obj, obj_references},
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

std::string read_whole_file(const std::string &path, uint64_t limit)
{
    gtx_file_bytes file = {};
    gtx_error error;
    file.allocator = gtx_allocator_or_default(nullptr);
    file.limit = limit;
    require_ok(gtx_read_file(path.c_str(), "the file", &file, &error), error);
    std::unique_ptr<gtx_file_bytes, void (*)(gtx_file_bytes *)> owner(&file, gtx_free_file);
    return std::string(reinterpret_cast<const char *>(file.data), file.size);
}

/* All members of a gzip file, one after another; what follows the last is ignored as gzip does. */
static std::string inflate_gzip(const std::string &packed, Task &task)
{
    z_stream stream = {};
    if (inflateInit2(&stream, 15 + 16) != Z_OK)
        fail(GTX_ERROR_MEMORY, "not enough memory to inflate the file");
    std::unique_ptr<z_stream, int (*)(z_stream *)> guard(&stream, inflateEnd);
    std::string out;
    Vector<char> block(size_t(1) << 14);
    size_t at = 0;
    for (int status = Z_OK; status != Z_STREAM_END || packed.compare(at, 2, "\x1f\x8b") == 0;) {
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
        if (out.size() > max_inflated_bytes)
            fail(GTX_ERROR_LIMIT, "the gzip data inflates to more than 4 GiB");
        task.advance(0.1 * double(at) / double(packed.size()));
    }
    return out;
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

/* By content; then by the name, so that a damaged file is called that and not unknown. */
static const Format *find_format(const ModelFile &file)
{
    std::string_view text = file.bytes;
    if (starts_with(text, "\xef\xbb\xbf"))
        text.remove_prefix(3);
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    for (const Format &format : formats)
        if (starts_with(text, format.magic))
            return &format;

    std::string extension = model_extension(file.path);
    for (const Format &format : formats)
        if (extension == format.extension)
            return &format;
    return nullptr;
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

ModelFile model_in_memory(std::string bytes, const std::string &path, Task &task)
{
    return within_memory([&] {
        if (starts_with(bytes, "\x1f\x8b"))
            bytes = inflate_gzip(bytes, task);
        return ModelFile{path, std::move(bytes), nullptr};
    });
}

ModelFile read_model(const std::string &path, Task &task)
{
    return within_memory([&] { return model_in_memory(read_whole_file(path), path, task); });
}

Vector<std::string> referenced_files(const ModelFile &file)
{
    return within_memory([&] {
        Vector<std::string> paths, once;
        const Format *format = find_format(file);
        if (format && format->references)
            format->references(file, paths);
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
        fail(GTX_ERROR_UNSUPPORTED, "'%s' is none of OBJ, PLY, OFF, STL, Draco, glTF and GLB",
             printable(std::filesystem::path(file.path).filename().string()).c_str());
    Mesh mesh = within_memory([&] { return format->import(file, task); });
    if (mesh.triangles.empty())
        fail(GTX_ERROR_EMPTY, "the model has no triangle");
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
