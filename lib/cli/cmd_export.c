/* gtx export: an asset -> a GLB for other tools. */
#include "cli/cli.h"

#include <geotex/export.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static gtx_export_desc desc;
static const char *output, *report_path;
static uint32_t compress, textures;
static bool lods, collision, without_asset;

static const option options[] = {
    {"output", 'o', OPTION_STRING, &output, "OUT.glb", "file to write, - for stdout", 0, 0},
    {"level", 0, OPTION_UINT, &desc.level, "N", "LOD mesh to export, 0 = the finest [0]", 0, 7},
    {"max-error", 0, OPTION_NUMBER, &desc.max_error, "E",
     "export the coarsest LOD mesh within E bounding-box diagonals of the source", 1e-9, 1},
    {"lods", 0, OPTION_FLAG, &lods, NULL, "export coarser LOD meshes too, as MSFT_lod", 0, 0},
    {"collision", 0, OPTION_FLAG, &collision, NULL,
     "for physics: export triangles only, without maps and asset", 0, 0},
    {"without-asset", 0, OPTION_FLAG, &without_asset, NULL, "do not embed the asset itself", 0, 0},
    {"compress", 0, OPTION_CHOICE, &compress, "none|meshopt|draco",
     "compress vertices and triangles: EXT_meshopt_compression, KHR_draco_mesh_compression [none]",
     0, 0},
    {"textures", 0, OPTION_CHOICE, &textures, "png|ktx2",
     "ktx2: KHR_texture_basisu, one byte per texel on the GPU, with mip levels [png]", 0, 0},
    THREADS_OPTION(&desc.threads),
    PROGRESS_OPTION,
    {"report", 0, OPTION_STRING, &report_path, "R.json", "write what was exported, as JSON", 0, 0},
    {0}};

static const verb export_verb = {
    "export", "ASSET -o OUT.glb",
    "Writes an asset as glTF 2.0: an LOD mesh textured with the asset's maps, and the asset\n"
    "itself as the extension GTX_geometry_texture. gtx cook and the verbs that open assets read\n"
    "it back; gtx render and gtx view draw the mesh. Units are metres.",
    1, 1, options, MAKING_LIMITS};

static int usage(const char *sentence)
{
    print_message("gtx export: error[usage]: %s (see gtx export --help)", sentence);
    return EXIT_CODE_USAGE;
}

static int check(const char *input)
{
    const output_file outputs[] = {{"-o", output}, {"--report", report_path}, {NULL, NULL}};
    if (!output)
        return usage("-o OUT.glb is missing");
    if (desc.level && desc.max_error > 0)
        return usage("--level and --max-error exclude each other");
    if (collision && lods)
        return usage("--collision and --lods exclude each other");
    if (!strcmp(output, "-") && isatty(STDOUT_FILENO))
        return usage("a GLB is not written to a terminal");
    return check_outputs("gtx export", outputs, &input, 1);
}

static int export_bytes(const char *input, const void *data, size_t size)
{
    void *glb;
    size_t glb_size;
    gtx_report report;
    gtx_error error;
    catch_interrupt();
    const gtx_result result =
        gtx_export_memory(data, size, &desc, &glb, &glb_size, &report, &error);
    end_progress();
    if (result)
        return report_error(input, &error);
    const bool to_stdout = !strcmp(output, "-");
    int code = to_stdout ? print_result(glb, glb_size) : write_text_file(output, glb, glb_size);
    for (size_t i = 0; i < report.warning_count; ++i)
        report_warning(input, report.warning_names[i], report.warnings[i]);
    if (!code && !cli_quiet)
        print_message("%s: %s", to_stdout ? "stdout" : output, report.summary);
    if (!code && report_path)
        code = write_text_file(report_path, report.json, report.size);
    gtx_report_free(&report);
    free(glb);
    return code;
}

int cmd_export(int argc, char **argv)
{
    const char *input;
    int count;
    int code = parse_options(&export_verb, argc, argv, &input, &count);
    if (code >= 0)
        return code;
    code = check(input);
    if (code)
        return code;
    desc.compress = (gtx_export_compression)compress;
    desc.textures = (gtx_export_textures)textures;
    desc.lods = lods;
    desc.collision = collision;
    desc.without_asset = without_asset;
    desc.progress = show_progress;
    desc.limits = cli_limits;
    void *data;
    size_t size;
    code = read_whole(input, &data, &size);
    if (code)
        return code;
    code = export_bytes(input, data, size);
    free(data);
    return code;
}
