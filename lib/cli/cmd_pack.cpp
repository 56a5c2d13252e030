/* gtx pack: what gtx unpack wrote, edited or not -> an asset. */
#include "cli/guard.hpp"
#include "cli/unpacked.hpp"

#include <memory>

static const char *output;
static int32_t zstd_level = -1;

static const option options[] = {
    {"output", 'o', OPTION_STRING, &output, "OUT.gtx", "where the asset goes (required)", 0, 0},
    {"zstd", 0, OPTION_INT, &zstd_level, "L", "compression level, 0 = stored [as it was]", 0, 19},
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const verb pack = {
    "pack", "DIR -o OUT.gtx",
    "Makes an asset of a folder that gtx unpack wrote: the same bytes, or an edited asset. Levels\n"
    "of normal, colour, material and emission are taken as their images are.",
    1, 1, options};

/* Rules that only tell of heights that have changed: coverage, sphere, bounds. */
static bool follows_from_heights(uint32_t rule)
{
    return rule == 304 || rule == 308 || rule == 311;
}

static gtx_asset *create(gtx::Unpacked &unpacked)
{
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    gtx_result result = gtx_create(&unpacked.desc, &asset, &error);
    if (result == GTX_ERROR_CORRUPT && follows_from_heights(error.rule)) {
        gtx::derive_again(unpacked);
        result = gtx_create(&unpacked.desc, &asset, &error);
    }
    if (result)
        throw gtx::Error(result, error.message);
    return asset;
}

int cmd_pack(int argc, char **argv)
{
    const char *folder;
    int count;
    int code = parse_options(&pack, argc, argv, &folder, &count);
    if (code >= 0)
        return code;
    if (!output) {
        std::fputs("gtx pack: error[usage]: -o OUT.gtx is missing\n", stderr);
        return EXIT_CODE_USAGE;
    }
    std::string about = folder;
    return gtx::guarded(about, [&] {
        gtx::Unpacked unpacked;
        gtx::read_unpacked(folder, unpacked, about);
        about = folder;
        std::unique_ptr<gtx_asset, void (*)(gtx_asset *)> asset(create(unpacked), gtx_close);
        for (const std::string &warning : unpacked.warnings)
            report_warning(folder, warning.c_str());
        gtx_encode_desc desc = {};
        desc.zstd_level = zstd_level >= 0 ? zstd_level : unpacked.zstd >= 0 ? unpacked.zstd : 3;
        gtx_error error = {};
        about = output;
        if (gtx_result result = gtx_save_file(asset.get(), output, &desc, &error))
            throw gtx::Error(result, error.message);
        return int(EXIT_CODE_OK);
    });
}
