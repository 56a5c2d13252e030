/* gtx filter: image operations on the surface of an asset. */
#include "cli/cli.h"

#include "base/warnings.h"

#include <geotex/edit.h>
#include <geotex/export.h>

#include "image/image.h"

#include <stdlib.h>
#include <string.h>

static made_file making = {.verb = "filter"};
static int32_t zstd_level = 6;
static uint32_t lod_levels = 5;
static steps chosen;
static bool naive;
static double boost_radius = 2, pattern_height, pattern_size;

static const option options[] = {
    {"output", 'o', OPTION_STRING, &making.output, "OUT.gtx",
     "file to write (required)", 0, 0},
    {"gaussian", 0, OPTION_STEP, &chosen, "TEXELS", "blur; standard deviation in texels", 0, 1e6},
    {"gaussian-world", 0, OPTION_STEP, &chosen, "UNITS",
     "blur; standard deviation in object units", 0, 1e30},
    {"high-boost", 0, OPTION_STEP, &chosen, "AMOUNT",
     "sharpen: add AMOUNT times what a blur removes", 0, 16},
    {"boost-radius", 0, OPTION_NUMBER, &boost_radius, "TEXELS",
     "standard deviation of that blur [2]", 0, 1e6},
    {"pattern", 0, OPTION_STEP, &chosen, "IMAGE", "add an image of heights to the surface", 0, 0},
    {"pattern-height", 0, OPTION_NUMBER, &pattern_height, "H",
     "height of white, object units [1 texel]", -1e30, 1e30},
    {"pattern-size", 0, OPTION_NUMBER, &pattern_size, "S",
     "width of the image, object units [64 texels]", 0, 1e30},
    {"naive", 0, OPTION_FLAG, &naive, NULL,
     "blur each patch by itself, as in the paper: seams open", 0, 0},
    {"lod-levels", 0, OPTION_UINT, &lod_levels, "N",
     "most LOD meshes, made from the filtered maps; 0 = none at all [5]", 0, 5},
    {"zstd", 0, OPTION_INT, &zstd_level, "L", "compression level, 0 = stored [6]", 0, 19},
    MADE_OPTIONS(making),
    {0}};

static const verb filter = {
    "filter", "ASSET -o OUT.gtx",
    "Filters the surface of an asset, heights and normals, across patch borders.\n"
    "Operations run in the order given, and may be repeated.",
    1, 1, options, MAKING_LIMITS};

/* Grey of the image, 0..1. *file names it when it is at fault. */
static gtx_result lay_pattern(gtx_edit *edit, const char *path, const char **file,
                              gtx_error *error)
{
    gtx_image image;
    const char *asset = *file;
    *file = path;
    gtx_result result = gtx_image_read(path, &image, error);
    if (result)
        return result;
    const size_t count = (size_t)image.width * image.height;
    float *values = malloc(count * sizeof *values);
    if (!values) {
        gtx_image_free(&image);
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the image");
    }
    for (size_t i = 0; i < count; ++i) {
        const uint8_t *p = image.pixels + 4 * i;
        values[i] = (float)(p[0] + p[1] + p[2]) / 765;
    }
    const gtx_edit_image heights = {values, image.width, image.height};
    const float texel = gtx_edit_texel_size(edit);
    result = gtx_edit_pattern(edit, &heights,
                              pattern_height != 0 ? (float)pattern_height : texel,
                              pattern_size > 0 ? (float)pattern_size : 64 * texel, error);
    gtx_image_free(&image);
    free(values);
    if (!result)
        *file = asset;
    return result;
}

static gtx_result take(gtx_edit *edit, const step *s, const char **file, gtx_error *error)
{
    gtx_edit_blur blur = {.radius = (float)s->number, .flags = naive ? GTX_EDIT_PER_PATCH : 0};
    if (!strcmp(s->name, "pattern"))
        return lay_pattern(edit, s->text, file, error);
    if (!strcmp(s->name, "high-boost")) {
        blur.radius = (float)boost_radius;
        return gtx_edit_high_boost(edit, &blur, (float)s->number, error);
    }
    if (!strcmp(s->name, "gaussian-world"))
        blur.flags |= GTX_EDIT_WORLD;
    return gtx_edit_gaussian(edit, &blur, error);
}

/* *file is what a failure is about. */
static gtx_result edit(const gtx_asset *asset, const char **file, gtx_asset **edited,
                       gtx_error *error)
{
    gtx_edit *edit = NULL;
    gtx_result result = gtx_edit_begin(asset, NULL, &edit, error);
    for (uint32_t i = 0; !result && i < chosen.count; ++i)
        result = take(edit, &chosen.list[i], file, error);
    if (!result)
        result = gtx_edit_finish(edit, edited, error);
    gtx_edit_end(edit);
    if (!result && lod_levels)
        result = add_lod_meshes(edited, lod_levels, 0, error);
    return result;
}

/* Everything that is read: the asset and the patterns. */
static int check_inputs(const char *asset)
{
    int code = made_from(&making, asset);
    for (uint32_t i = 0; i < chosen.count && !code; ++i)
        if (!strcmp(chosen.list[i].name, "pattern"))
            code = made_from(&making, chosen.list[i].text);
    return code ? code : made_check(&making);
}

static int run(const char *file)
{
    const gtx_open_desc open = {.limits = cli_limits};
    const gtx_encode_desc encode = {.zstd_level = encode_level(zstd_level)};
    gtx_asset *asset = NULL, *edited = NULL;
    gtx_error error = {0};
    gtx_info info;
    if (gtx_open_exported(file, &open, &asset, &error))
        return report_error(file, &error);
    gtx_get_info(asset, &info);
    int code = EXIT_CODE_OK;
    if (info.lod_levels && !lod_levels)
        code = made_warn(&making, file, GTX_WARNING_LOD_DROPPED,
                         "the LOD meshes are those of the surface as it was, and are left out");
    if (!code && edit(asset, &file, &edited, &error))
        code = report_error(file, &error);
    if (!code)
        code = made_save(&making, edited, &encode);
    gtx_close(edited);
    gtx_close(asset);
    return code;
}

int cmd_filter(int argc, char **argv)
{
    const char *file;
    int count;
    int code = parse_options(&filter, argc, argv, &file, &count);
    if (code >= 0)
        return code;
    if (!making.output || !chosen.count) {
        print_message("gtx filter: error[usage]: %s",
                      making.output ? "an operation is missing (see gtx filter --help)"
                                    : "-o OUT.gtx is missing");
        return EXIT_CODE_USAGE;
    }
    code = check_inputs(file);
    if (!code)
        code = run(file);
    made_free(&making);
    return code;
}
