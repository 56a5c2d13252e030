/* The files that a model refers to, found in its text without decoding it. */
#include "mesh/import/import.hpp"

#include "base/bytes.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

namespace gtx {

using nlohmann::json;

/* ---- names ---- */

std::string path_beside(const ModelFile &file, const std::string &name)
{
    constexpr size_t LONGEST = 4096; /* as systems have it */
    bool outside = name.empty() || name.size() > LONGEST ||
                   name.find_first_of(std::string(":\\\0", 3)) != name.npos;
    std::filesystem::path relative(outside ? std::string() : name);
    outside |= relative.is_absolute();
    for (const auto &part : relative)
        outside |= part == "..";
    if (outside)
        return {};
    return (std::filesystem::path(file.path).parent_path() / relative).string();
}

Vector<std::string> texture_paths(const ModelFile &file, const std::string &name)
{
    std::string local = name;
    std::replace(local.begin(), local.end(), '\\', '/');
    const std::string last = local.substr(local.rfind('/') + 1);
    ModelFile folder;
    folder.path = file.textures.folder + "/";
    Vector<std::string> paths = {path_beside(file, local)};
    if (paths[0].empty())
        paths[0] = path_beside(file, last);
    if (!file.textures.folder.empty())
        paths.push_back(path_beside(folder, last));
    paths.erase(std::remove(paths.begin(), paths.end(), std::string()), paths.end());
    return paths;
}

std::string texture_path(const ModelFile &file, const std::string &name)
{
    std::string local = name;
    std::replace(local.begin(), local.end(), '\\', '/');
    std::error_code ignored;
    for (const std::string &path : texture_paths(file, name))
        if (std::filesystem::is_regular_file(path, ignored))
            return path;
    return path_beside(file, local);
}

std::string normal_path(const std::string &path)
{
    return std::filesystem::path(path).lexically_normal().string();
}

static int hex(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

std::string percent_decoded(std::string_view uri)
{
    std::string out;
    for (size_t i = 0; i < uri.size(); ++i) {
        bool escaped =
            uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0;
        out += escaped ? char(hex(uri[i + 1]) * 16 + hex(uri[i + 2])) : uri[i];
        i += escaped ? 2 : 0;
    }
    return out;
}

/* Each file once, however often and in whatever spelling it is named: a few bytes of text can stand
 * for many names, each of which is looked for. */
class Paths {
public:
    explicit Paths(Vector<std::string> &paths) : paths_(paths) {}

    void add(std::string path)
    {
        constexpr size_t MAX_FILES = 1 << 16;
        if (!seen_.insert(normal_path(path)).second)
            return;
        if (paths_.size() == MAX_FILES)
            fail(GTX_ERROR_LIMIT, "the model refers to more than %zu files", MAX_FILES);
        paths_.push_back(std::move(path));
    }

private:
    Vector<std::string> &paths_;
    std::set<std::string> seen_ = {""};
};

/* ---- glTF ---- */

static std::string_view gltf_text(std::string_view bytes)
{
    constexpr size_t TEXT = 20; /* behind the GLB header and that of its first chunk */
    if (bytes.substr(0, 4) != "glTF")
        return bytes;
    if (bytes.size() < TEXT)
        return {};
    return bytes.substr(TEXT, gtx_load_u32(reinterpret_cast<const uint8_t *>(bytes.data()) + 12));
}

void gltf_references(const ModelFile &file, Task &, Vector<std::string> &out)
{
    Paths paths(out);
    std::string_view text = gltf_text(file.bytes);
    /* With a callback that leaves out the rest, lists would take the square of their length. */
    const json root = json::parse(text.begin(), text.end(), nullptr, false);
    for (const char *list : {"buffers", "images"}) {
        if (!root.is_object() || !root.contains(list) || !root[list].is_array())
            continue;
        const bool is_image = !std::strcmp(list, "images");
        for (const json &item : root[list])
            if (item.is_object() && item.contains("uri") && item["uri"].is_string())
                if (std::string uri = item["uri"]; uri.rfind("data:", 0) != 0)
                    for (const auto &path : is_image ? texture_paths(file, percent_decoded(uri))
                                                     : Vector<std::string>{path_beside(
                                                           file, percent_decoded(uri))})
                        paths.add(path);
    }
}

/* ---- OBJ ---- */

/* What follows one of the keywords on its line, for each such line. */
template <class Use>
static void each_statement(std::string_view text, std::initializer_list<const char *> keywords,
                           Use use)
{
    for (size_t at = 0; at < text.size();) {
        size_t end = std::min(text.find_first_of("\r\n", at), text.size());
        std::string_view line = text.substr(at, end - at);
        at = end + 1;
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        for (const char *keyword : keywords)
            if (line.rfind(keyword, 0) == 0)
                use(line);
    }
}

/* A name may have blanks in it, and options or further names before it: every tail of the line and
 * every word may be one. */
static void add_names(std::initializer_list<const ModelFile *> beside, std::string_view line,
                      Paths &paths)
{
    constexpr int MAX_WORDS = 32;
    line = line.substr(0, line.find_last_not_of(" \t") + 1);
    for (int i = 0; i < MAX_WORDS; ++i) {
        size_t blank = line.find_first_of(" \t");
        for (const ModelFile *file : beside)
            for (std::string_view name : {line, line.substr(0, blank)})
                if (i > 0)
                    for (const std::string &path : texture_paths(*file, std::string(name)))
                        paths.add(path);
        size_t next = line.find_first_not_of(" \t", blank);
        if (blank == line.npos || next == line.npos)
            break;
        line.remove_prefix(next);
    }
}

void obj_references(const ModelFile &file, Task &task, Vector<std::string> &out)
{
    Paths paths(out);
    each_statement(file.bytes, {"mtllib"},
                   [&](std::string_view line) { add_names({&file}, line, paths); });
    for (size_t i = 0, libraries = out.size(); i < libraries; ++i) {
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(out[i], ignored))
            continue;
        ModelFile library = {out[i], read_file_beside(out[i], task), nullptr,
                             file.textures};
        each_statement(library.bytes, {"map_", "bump", "norm", "disp", "refl", "decal"},
                       [&](std::string_view line) { add_names({&file, &library}, line, paths); });
    }
}

} // namespace gtx
