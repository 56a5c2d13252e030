/* gtx unpack: an asset -> a folder of images and one JSON file. */
#include "cli/guard.hpp"
#include "cli/unpack/unpacked.hpp"

#include <geotex/export.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <unistd.h>

static const option options[] = {{nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const verb unpack = {
    "unpack", "ASSET DIR",
    "Writes an asset to a new folder: its maps as PNG images, its LOD meshes as lod-N.bin, the\n"
    "rest as asset.json. gtx pack makes an asset of the folder, edited or not.",
    2, 2, options, ASSET_LIMITS};

namespace fs = std::filesystem;

/* The compression level that gives the file again, the likely ones first; -1 when none does. */
static int find_zstd(const gtx_asset *asset, const void *data, size_t size)
{
    static const int levels[] = {3,  0,  1,  2,  4,  5,  6,  7,  8,  9,
                                 10, 11, 12, 13, 14, 15, 16, 17, 18, 19};
    for (int level : levels) {
        gtx_encode_desc desc = {};
        desc.zstd_level = encode_level(level);
        void *again = nullptr;
        size_t again_size = 0;
        gtx_error error;
        const gtx_result result = gtx_encode(asset, &desc, &again, &again_size, &error);
        if (result == GTX_ERROR_UNSUPPORTED)
            continue;
        gtx::require_ok(result, error);
        const bool same = again_size == size && !std::memcmp(again, data, size);
        std::free(again);
        if (same)
            return level;
    }
    return -1;
}

/* A new folder in another one, with a short name that nobody has. */
static fs::path make_folder(const fs::path &parent)
{
    std::error_code error;
    for (int i = 0; i < 100 && !error; ++i) {
        const fs::path made =
            parent / (".gtx-" + std::to_string(getpid()) + "-" + std::to_string(i));
        if (fs::create_directory(made, error))
            return made;
    }
    throw gtx::Error(GTX_ERROR_WRITE, "cannot be made: " + error.message());
}

static void move(const fs::path &from, const fs::path &to)
{
    std::error_code error;
    fs::rename(from, to, error);
    if (error)
        throw gtx::Error(GTX_ERROR_WRITE, "cannot be written: " + error.message());
}

/* asset.json comes last: a folder without it is none. */
static void move_files(const fs::path &from, const fs::path &to)
{
    gtx::Vector<fs::path> names, moved;
    for (const std::string &name : gtx::names_in(from.string()))
        if (name != gtx::UNPACKED_JSON)
            names.push_back(name);
    names.push_back(gtx::UNPACKED_JSON);
    try {
        for (const fs::path &name : names) {
            move(from / name, to / name);
            moved.push_back(to / name);
        }
    } catch (...) {
        std::error_code ignored;
        for (const fs::path &file : moved)
            fs::remove(file, ignored);
        throw;
    }
}

/* The folder appears whole: it is filled under a temporary name, inside the one that is there
 * already, which then keeps its permissions and the links to it. */
static void write_folder(const gtx_asset *asset, int zstd, const std::string &folder,
                         std::string &about)
{
    std::error_code error;
    const bool exists = fs::exists(folder, error);
    if (exists && !(fs::is_directory(folder, error) && fs::is_empty(folder, error)))
        throw gtx::Error(GTX_ERROR_WRITE, "is there and not an empty folder");
    const fs::path target = (fs::path(folder) / "").parent_path();
    const fs::path home = exists ? fs::path(folder) : target.parent_path();
    catch_interrupt();
    const fs::path temporary = make_folder(home);
    try {
        gtx::write_unpacked(asset, zstd, temporary.string(), about);
        about = folder;
        gtx::stop_if_interrupted();
        if (exists)
            move_files(temporary, folder);
        else
            move(temporary, target);
        fs::remove(temporary, error);
    } catch (...) {
        gtx::remove_folder(temporary.native());
        throw;
    }
}

int cmd_unpack(int argc, char **argv)
{
    const char *files[2];
    int count;
    int code = parse_options(&unpack, argc, argv, files, &count);
    if (code >= 0)
        return code;
    void *data;
    size_t size;
    code = read_whole(files[0], &data, &size);
    if (code)
        return code;
    std::unique_ptr<void, void (*)(void *)> bytes(data, std::free);
    gtx_open_desc open = {};
    open.limits = cli_limits;
    gtx_asset *asset = nullptr;
    const void *file = data;
    gtx_error error = {};
    if (gtx_find_asset(data, size, &file, &size, &error) && error.result != GTX_ERROR_NOT_GTX)
        return report_error(files[0], &error);
    if (gtx_open_memory(file, size, &open, &asset, &error))
        return report_error(files[0], &error);
    std::unique_ptr<gtx_asset, void (*)(gtx_asset *)> guard(asset, gtx_close);
    return gtx::guarded(files[1], [&](std::string &about) {
        const int zstd = find_zstd(asset, file, size);
        if (zstd < 0)
            report_warning(files[0], gtx_warning_name(GTX_WARNING_OTHER_BYTES),
                           "packed again it will have other bytes: it holds unknown sections, or "
                           "another zstd wrote it");
        write_folder(asset, zstd, files[1], about);
        return int(EXIT_CODE_OK);
    });
}
