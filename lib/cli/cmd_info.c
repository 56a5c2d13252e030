/* gtx info: what is in an asset. */
#include "cli/cli.h"

#include <geotex/export.h>

#include <inttypes.h>
#include <string.h>

static bool as_json;

static const option options[] = {
    {"json", 0, OPTION_FLAG, &as_json, NULL, "one JSON object instead of text", 0, 0}, {0}};

static const verb info_verb = {
    "info", "ASSET", "Prints what is in a .gtx asset.", 1, 1, options, ASSET_LIMITS};

static uint64_t texels(const gtx_asset *asset, const gtx_info *info)
{
    const gtx_patch *patches = gtx_patches(asset);
    uint64_t sum = 0;
    for (uint32_t i = 0; i < info->patch_count; ++i)
        sum += (uint64_t)patches[i].rect[2] * patches[i].rect[3];
    return sum;
}

static uint32_t two_sided(const gtx_asset *asset, const gtx_info *info)
{
    const gtx_patch *patches = gtx_patches(asset);
    uint32_t sum = 0;
    for (uint32_t i = 0; i < info->patch_count; ++i)
        sum += (patches[i].flags & GTX_PATCH_TWO_SIDED) != 0;
    return sum;
}

static void vector(gtx_json *json, const char *key, const float *f, const double *d)
{
    gtx_json_begin_array(json, key);
    for (int i = 0; i < 3; ++i)
        gtx_json_number(json, NULL, f ? (double)f[i] : d[i]);
    gtx_json_end_array(json);
}

static void lod(gtx_json *json, const gtx_asset *asset, const gtx_info *info)
{
    gtx_json_begin_array(json, "lod_meshes");
    for (uint32_t k = 0; k < info->lod_levels; ++k) {
        gtx_lod_mesh level;
        gtx_get_lod_mesh(asset, k, &level);
        gtx_json_begin_object(json, NULL);
        gtx_json_integer(json, "triangles", level.triangle_count);
        gtx_json_integer(json, "vertices", level.vertex_count);
        gtx_json_number(json, "error", (double)level.error);
        gtx_json_bool(json, "far", level.flags & GTX_LOD_FAR);
        if (level.normals)
            gtx_json_number(json, "normal_error", (double)level.normal_error);
        gtx_json_end_object(json);
    }
    gtx_json_end_array(json);
}

static int tell_json(const char *path, const gtx_asset *asset, const gtx_info *info)
{
    gtx_json json = {0};
    char version[32];
    snprintf(version, sizeof version, "%u.%u", info->version_major, info->version_minor);
    gtx_json_begin_object(&json, NULL);
    gtx_json_string(&json, "version", version);
    gtx_json_integer(&json, "patches", info->patch_count);
    gtx_json_integer(&json, "two_sided_patches", two_sided(asset, info));
    gtx_json_integer(&json, "texels", texels(asset, info));
    gtx_json_integer(&json, "ray_cells", gtx_ray_cells(asset));
    gtx_json_integer(&json, "pages", info->page_count);
    gtx_json_integer(&json, "page_width", info->page_width);
    gtx_json_integer(&json, "page_height", info->page_height);
    gtx_json_integer(&json, "mips", info->mip_count);
    gtx_json_integer(&json, "height_bits", info->height_bits);
    gtx_json_bool(&json, "color", info->has_color);
    gtx_json_bool(&json, "material", info->has_material);
    gtx_json_bool(&json, "emission", info->has_emission);
    gtx_json_number(&json, "emission_scale", (double)info->emission_scale);
    lod(&json, asset, info);
    vector(&json, "anchor", NULL, info->anchor);
    vector(&json, "bounds_min", info->bounds_min, NULL);
    vector(&json, "bounds_max", info->bounds_max, NULL);
    gtx_json_number(&json, "unit", (double)info->unit);
    gtx_json_integer(&json, "source_triangles", info->source_triangles);
    gtx_json_integer(&json, "bytes", info->file_size);
    gtx_json_hash(&json, "content_hash", info->content_hash);
    gtx_json_end_object(&json);
    return print_json(path, &json);
}

static int tell_text(const gtx_asset *asset, const gtx_info *info)
{
    printf("version         %u.%u\n", info->version_major, info->version_minor);
    printf("patches         %u (%u two-sided)\n", info->patch_count, two_sided(asset, info));
    printf("texels          %" PRIu64 " in %u page%s of %u x %u\n", texels(asset, info),
           info->page_count, info->page_count == 1 ? "" : "s", info->page_width, info->page_height);
    printf("heights         %u bits\n", info->height_bits);
    printf("a ray           %" PRIu64 " cells at most\n", gtx_ray_cells(asset));
    printf("maps            normal%s%s%s, %u mip level%s\n", info->has_color ? ", colour" : "",
           info->has_material ? ", material" : "", info->has_emission ? ", emission" : "",
           info->mip_count, info->mip_count == 1 ? "" : "s");
    if (info->has_emission)
        printf("emission        times %g\n", (double)info->emission_scale);
    for (uint32_t k = 0; k < info->lod_levels; ++k) {
        gtx_lod_mesh level;
        gtx_get_lod_mesh(asset, k, &level);
        printf("%s%u triangles, error %g%s", k ? "                " : "LOD meshes      ",
               level.triangle_count, (double)level.error,
               level.flags & GTX_LOD_FAR ? ", across patches" : "");
        if (level.normals)
            printf(", normals off by %.2g degrees", (double)level.normal_error * 57.29578);
        printf("\n");
    }
    printf("bounds          %g %g %g .. %g %g %g\n", (double)info->bounds_min[0],
           (double)info->bounds_min[1], (double)info->bounds_min[2], (double)info->bounds_max[0],
           (double)info->bounds_max[1], (double)info->bounds_max[2]);
    printf("anchor          %.9g %.9g %.9g\n", info->anchor[0], info->anchor[1], info->anchor[2]);
    printf("unit            %g m\n", (double)info->unit);
    printf("source          %" PRIu64 " triangles\n", info->source_triangles);
    printf("file            %" PRIu64 " bytes", info->file_size);
    if (info->source_triangles)
        printf(", %.2f a triangle", (double)info->file_size / (double)info->source_triangles);
    printf("\ncontent hash    0x%016" PRIx64 "\n", info->content_hash);
    return print_result("", 0);
}

int cmd_info(int argc, char **argv)
{
    const char *path;
    int count;
    int code = parse_options(&info_verb, argc, argv, &path, &count);
    if (code >= 0)
        return code;
    gtx_asset *asset;
    gtx_error error;
    const gtx_open_desc desc = {.limits = cli_limits};
    if (gtx_open_exported(path, &desc, &asset, &error) != GTX_OK)
        return report_error(path, &error);
    gtx_info info;
    gtx_get_info(asset, &info);
    code = as_json ? tell_json(path, asset, &info) : tell_text(asset, &info);
    gtx_close(asset);
    return code;
}
