/* gtx unpack: an asset -> a folder of images and one JSON file. */
#include "cli/guard.hpp"
#include "cli/unpack/unpacked.hpp"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

static const option options[] = {{nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const verb unpack = {
    "unpack", "ASSET DIR",
    "Writes an asset into a new folder: the maps as PNG images, the LOD mesh as lod-N.bin, the\n"
    "rest as asset.json. gtx pack makes the asset again, edited or not.",
    2, 2, options};

namespace fs = std::filesystem;

/* The compression level that gives the file again, the likely ones first; -1 when none does. */
static int find_zstd(const gtx_asset *asset, const void *data, size_t size)
{
    static const int levels[] = {3,  0,  1,  2,  4,  5,  6,  7,  8,  9,
                                 10, 11, 12, 13, 14, 15, 16, 17, 18, 19};
    for (int level : levels) {
        gtx_encode_desc desc = {};
        desc.zstd_level = level;
        void *again = nullptr;
        size_t again_size = 0;
        if (gtx_encode(asset, &desc, &again, &again_size, nullptr))
            continue;
        const bool same = again_size == size && !std::memcmp(again, data, size);
        std::free(again);
        if (same)
            return level;
    }
    return -1;
}

/* The folder appears whole: it is filled under a temporary name. */
static void write_folder(const gtx_asset *asset, int zstd, const std::string &folder,
                         std::string &about)
{
    std::error_code error;
    if (fs::exists(folder, error) &&
        !(fs::is_directory(folder, error) && fs::is_empty(folder, error)))
        throw gtx::Error(GTX_ERROR_WRITE, "is there and not an empty folder");
    const std::string temporary = (fs::path(folder) / "").parent_path().string() + ".tmp";
    about = temporary;
    if (!fs::create_directory(temporary, error))
        throw gtx::Error(GTX_ERROR_WRITE,
                         error ? "cannot be made" : "is left from before: remove it");
    try {
        gtx::write_unpacked(asset, zstd, temporary, about);
        about = folder;
        fs::rename(temporary, folder, error);
        if (error)
            throw gtx::Error(GTX_ERROR_WRITE, "cannot be written");
    } catch (...) {
        fs::remove_all(temporary, error);
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
    gtx_error error = {};
    if (gtx_open_memory(data, size, &open, &asset, &error))
        return report_error(files[0], &error);
    std::unique_ptr<gtx_asset, void (*)(gtx_asset *)> guard(asset, gtx_close);
    std::string about = files[1];
    return gtx::guarded(about, [&] {
        const int zstd = find_zstd(asset, data, size);
        if (zstd < 0)
            report_warning(files[0], "packed again it will have other bytes: it holds unknown "
                                     "sections, or another zstd wrote it");
        write_folder(asset, zstd, files[1], about);
        return int(EXIT_CODE_OK);
    });
}
