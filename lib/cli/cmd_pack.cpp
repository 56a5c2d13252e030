/* gtx pack: what gtx unpack wrote, edited or not, or an asset -> an asset. */
#include "cli/guard.hpp"
#include "cli/unpack/rebuild.hpp"

#include <geotex/export.h>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace fs = std::filesystem;

static const char *rebuild_text;
static made_file making = {};
static unsigned rebuilt;
static int32_t zstd_level = -1;
static uint32_t lod_levels;

static const option options[] = {
    {"output", 'o', OPTION_STRING, &making.output, "OUT.gtx",
     "file to write (required)", 0, 0},
    {"zstd", 0, OPTION_INT, &zstd_level, "L", "compression level, 0 = stored [as before]", 0, 19},
    {"lod-levels", 0, OPTION_UINT, &lod_levels, "N",
     "make N new LOD meshes from the maps [keep the old ones]", 1, 5},
    {"rebuild", 0, OPTION_STRING, &rebuild_text, "mips,normals,trim",
     "derive anew, in edited patches: mip levels and dilation, normals, outlines",
     0, 0},
    MADE_OPTIONS(making),
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const verb pack = {
    "pack", "DIR|ASSET -o OUT.gtx",
    "Packs a folder that gtx unpack wrote: the same bytes again, or the edited asset. Every mip\n"
    "level is read from its own image; a warning tells if only some were edited, and --rebuild\n"
    "derives the others from the edited ones. Given an asset, writes it again with other LOD\n"
    "meshes or another compression level.",
    1, 1, options, MAKING_LIMITS};

/* Rules that only tell of heights that have changed: coverage, sphere, bounds. */
static bool follows_from_heights(uint32_t rule)
{
    return rule == 304 || rule == 308 || rule == 311;
}

/* An exit code, whose reason has been told. */
struct Told {
    int code;
};

using Asset = std::unique_ptr<gtx_asset, void (*)(gtx_asset *)>;

static Asset open_folder(const char *folder, std::string &about)
{
    gtx::Unpacked unpacked;
    gtx::Limits limits(cli_limits);
    gtx::MemoryScope scope(limits);
    gtx::read_unpacked(folder, limits, unpacked, about);
    about = folder;
    gtx::rebuild(unpacked, rebuilt);
    bool refit = unpacked.has_old_normals && gtx::drop_lod_normals(unpacked);
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    gtx_result result = gtx_create(&unpacked.desc, &asset, &error);
    if (result == GTX_ERROR_CORRUPT && follows_from_heights(error.rule)) {
        gtx::derive_again(unpacked);
        refit = false;
        result = gtx_create(&unpacked.desc, &asset, &error);
    }
    gtx::require_ok(result, error);
    if (refit) {
        gtx_close(asset);
        gtx::fit_lod_normals(unpacked);
        gtx::require_ok(gtx_create(&unpacked.desc, &asset, &error), error);
    }
    for (const gtx::Warning &warning : unpacked.warnings) {
        if (warning.kind == GTX_WARNING_LOD_DROPPED && lod_levels)
            continue; /* another one is about to be made */
        if (int code = made_warn(&making, folder, warning.kind, warning.sentence.c_str()))
            throw Told{code};
    }
    if (zstd_level < 0)
        zstd_level = unpacked.zstd;
    return Asset(asset, gtx_close);
}

static Asset open_asset(const char *path)
{
    gtx_open_desc open = {};
    open.limits = cli_limits;
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    gtx::require_ok(gtx_open_exported(path, &open, &asset, &error), error);
    return Asset(asset, gtx_close);
}

/* "mips,normals". */
static bool parse_rebuild()
{
    static const struct {
        const char *name;
        unsigned bit;
    } parts[] = {{"mips", gtx::REBUILD_MIPS}, {"normals", gtx::REBUILD_NORMALS},
                 {"trim", gtx::REBUILD_TRIM}};
    std::string rest = rebuild_text ? std::string(rebuild_text) + "," : "";
    while (!rest.empty()) {
        const std::string name = rest.substr(0, rest.find(','));
        rest.erase(0, name.size() + 1);
        const auto found = std::find_if(std::begin(parts), std::end(parts),
                                        [&](const auto &part) { return name == part.name; });
        if (found == std::end(parts))
            return false;
        rebuilt |= found->bit;
    }
    return true;
}

static Asset with_lod(const Asset &asset)
{
    gtx_lod_desc desc = {};
    desc.limits = cli_limits;
    desc.levels = lod_levels;
    desc.progress = show_progress;
    gtx_asset *out = nullptr;
    gtx_error error = {};
    catch_interrupt();
    gtx_result result = gtx_cook_lod_meshes(asset.get(), &desc, &out, &error);
    end_progress();
    gtx::require_ok(result, error);
    return Asset(out, gtx_close);
}

/* The asset, or all that lies in the folder. */
static int check_inputs(const char *input)
{
    std::error_code ignored;
    const bool is_file = !fs::is_directory(input, ignored);
    int code = is_file ? made_from(&making, input) : EXIT_CODE_OK;
    for (const std::string &name : gtx::names_in(input))
        code = code ? code : made_from(&making, gtx::in_folder(input, name).c_str());
    return code ? code : made_check(&making);
}

static int run(const char *input, std::string &about)
{
    if (!parse_rebuild())
        throw gtx::Error(GTX_ERROR_ARGUMENT, "--rebuild takes some of mips, normals and trim");
    if (int code = check_inputs(input))
        return code;
    std::error_code ignored;
    const bool is_file = fs::is_regular_file(input, ignored);
    Asset asset = is_file ? open_asset(input) : open_folder(input, about);
    if (lod_levels)
        asset = with_lod(asset);
    gtx_encode_desc desc = {};
    desc.zstd_level = encode_level(zstd_level >= 0 ? zstd_level : 6);
    return made_save(&making, asset.get(), &desc);
}

int cmd_pack(int argc, char **argv)
{
    const char *input;
    int count;
    making.verb = "pack";
    int code = parse_options(&pack, argc, argv, &input, &count);
    if (code >= 0)
        return code;
    if (!making.output) {
        print_message("gtx pack: error[usage]: -o OUT.gtx is missing");
        return EXIT_CODE_USAGE;
    }
    code = gtx::guarded(input, [&](std::string &about) {
        try {
            return run(input, about);
        } catch (const Told &told) {
            return told.code;
        }
    });
    made_free(&making);
    return code;
}
