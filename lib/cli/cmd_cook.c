/* gtx cook: triangle meshes -> an asset. */
#include "cli/folder/folder.h"

#include "host/jobs.h"

#include <geotex/export.h>

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MAX_MODELS = 4096 };

static gtx_cook_desc desc;
static const char *output, *name, *report_path, *depfile_path, *allow, *shard_text, *textures;
static uint32_t partition, extract, lod_levels = 5, job_count, shard = 1, shards = 1;
static double unit = 1, texel_density = -1; /* by their detail */
static int32_t zstd_level = 6;
static bool adaptive, strict, if_changed, per_mesh;

static const option options[] = {
    {"output", 'o', OPTION_STRING, &output, "OUT.gtx",
     "file (or folder) to write, - for stdout", 0, 0},
    {"charts", 0, OPTION_UINT, &desc.charts, "N",
     "number of patches to aim at [10 T^0.28, T triangles]", 1, 1e6},
    {"resolution", 0, OPTION_UINT, &desc.resolution, "N",
     "a patch's largest side in texels [128]", 64, 512},
    {"texel-density", 0, OPTION_NUMBER, &texel_density, "D",
     "least texels per pixel of the textures, along a side; 0 = ignore them [by their detail]",
     0, 4},
    {"partition", 0, OPTION_CHOICE, &partition, "default|cuts|vsa|pgp|layers|relief|auto",
     "how to partition into charts; default: cuts, or finer layers where outlines need them", 0, 0},
    {"adaptive", 0, OPTION_FLAG, &adaptive, NULL,
     "with --partition pgp: smaller patches where the surface is more curved", 0, 0},
    {"extract", 0, OPTION_CHOICE, &extract, "cpu|gpu",
     "gpu: render the maps through EGL instead of sampling them [cpu]", 0, 0},
    {"error", 0, OPTION_NUMBER, &desc.error, "E",
     "fewest bytes for an RMS error of at most E bounding-box diagonals", 1e-9, 0.5},
    {"height-bits", 0, OPTION_ONE_OF, &desc.height_bits, "8|16", "bits per height [8]", 0, 0},
    {"mips", 0, OPTION_UINT, &desc.mips, "N", "mip levels of normals and colours [4]", 1, 8},
    {"dilation", 0, OPTION_UINT, &desc.dilation, "N",
     "rings of texels to dilate by [2^(mips-1)]", 1, 128},
    {"lod-levels", 0, OPTION_UINT, &lod_levels, "N",
     "most LOD meshes, besides far ones; 0 = none at all [5]", 0, 5},
    {"zstd", 0, OPTION_INT, &zstd_level, "L", "compression level, 0 = stored [6]", 0, 19},
    {"texture-format", 0, OPTION_STRING, &textures, "KIND,...",
     "also store block-compressed maps: bc, bc-small, etc2; normals: of normals too", 0, 0},
    {"up", 0, OPTION_CHOICE, &desc.z_up, "y|z",
     "the model's up axis; z: +Z becomes +Y [y]", 0, 0},
    {"unit", 0, OPTION_NUMBER, &unit, "M", "metres per unit of the model [1]", 1e-30, 1e30},
    {"base-color", 0, OPTION_STRING, &desc.base_color, "FILE",
     "image for materials of OBJ and glTF that have texture coordinates but no readable image",
     0, 0},
    {"texture-dir", 0, OPTION_STRING, &desc.texture_dir, "DIR",
     "folder in which to look, by file name, for textures that are not beside the model", 0, 0},
    {"name", 0, OPTION_STRING, &name, "PATH",
     "file name of stdin: gives its type and the place of its textures", 0, 0},
    {"per-mesh", 0, OPTION_FLAG, &per_mesh, NULL,
     "of a glTF scene: write an asset per suitable mesh, and the scene, to the folder -o", 0, 0},
    {"if-changed", 0, OPTION_FLAG, &if_changed, NULL,
     "do not touch OUT.gtx if its key is the same", 0, 0},
    {"cache", 0, OPTION_STRING, &desc.cache, "DIR",
     "folder of cooked assets by key, to reuse and to add to; machines may share it", 0, 0},
    {"jobs", 0, OPTION_UINT, &job_count, "N",
     "of folders: models cooked at once, which share --max-memory; 0 = one per processor [0]", 0,
     1024},
    {"shard", 0, OPTION_STRING, &shard_text, "I/N",
     "of folders: cook only the I-th of N parts, for N machines [1/1]", 0, 0},
    {"strict", 0, OPTION_FLAG, &strict, NULL, "warnings are errors (exit 3), notes are not", 0,
     0},
    {"allow", 0, OPTION_STRING, &allow, "NAME,...",
     "with --strict: warnings that are not errors", 0, 0},
    THREADS_OPTION(&desc.threads),
    PROGRESS_OPTION,
    {"report", 0, OPTION_STRING, &report_path, "R.json",
     "write the report, with the measured error; of folders: those of all models, without errors",
     0, 0},
    {"depfile", 0, OPTION_STRING, &depfile_path, "D", "write a dependency file for Make or Ninja",
     0, 0},
    {"charts-ply", 0, OPTION_STRING, &desc.charts_ply, "F.ply",
     "write the charts before splitting: a colour per chart, inverted triangles green", 0, 0},
    {0}};

static const verb cook = {
    "cook", "MODEL... -o OUT.gtx, or FOLDER|MODEL... -o FOLDER",
    "Cooks models (glTF, GLB, Draco, OBJ, PLY, OFF, STL, each also gzipped; - reads stdin) into\n"
    "one .gtx asset. If the output is a folder, each model becomes an asset of its own, those of\n"
    "an input folder under the same relative paths, with the extension .gtx. All models are\n"
    "tried; the highest exit code is returned. An asset stores a key for --if-changed and\n"
    "--cache: a hash of the models, of every file that they refer to, of the options from\n"
    "--charts to --unit and of the cooker's revision; not of paths, times, threads or reports.",
    1, MAX_MODELS, options, MODEL_LIMITS};

static output_file outputs[] = {{"-o", NULL}, {"--report", NULL}, {"--depfile", NULL},
                                {"--charts-ply", NULL}, {NULL, NULL}};

static int usage(const char *sentence)
{
    print_message("gtx cook: error[usage]: %s (see gtx cook --help)", sentence);
    return EXIT_CODE_USAGE;
}

static bool is_stream(const char *path)
{
    return !strcmp(path, "-");
}

static int check(const char *const *models, int count, bool folders)
{
    outputs[0].path = folders ? NULL : output; /* assets may lie beside their models */
    outputs[1].path = report_path;
    outputs[2].path = depfile_path;
    outputs[3].path = desc.charts_ply;
    if (!output)
        return usage("-o OUT.gtx is missing");
    for (int i = 1; i < count; ++i)
        if (is_stream(models[i]))
            return usage("only the first model may be read from stdin");
    if (is_stream(output) && (depfile_path || if_changed))
        return usage("--depfile and --if-changed need an output that is a file");
    if (is_stream(models[0]) && if_changed)
        return usage("--if-changed needs models that are files");
    if (is_stream(output) && isatty(STDOUT_FILENO))
        return usage("an asset is not written to a terminal");
    if (depfile_path && !fits_depfile(output))
        return usage("a dependency file cannot name a path with a line break");
    if (adaptive && partition != GTX_PARTITION_PGP)
        return usage("--adaptive needs --partition pgp");
    if (per_mesh && (count > 1 || is_stream(models[0]) || is_stream(output) || depfile_path ||
                     desc.charts_ply || desc.z_up || unit != 1 || strict || if_changed || allow ||
                     desc.cache))
        return usage("--per-mesh takes one scene file and a folder, and no --depfile, "
                     "--charts-ply, --up, --unit, --strict, --if-changed, --cache");
    return check_outputs("gtx cook", outputs, models, (size_t)count);
}

/* "2/8". */
static bool parse_shard(void)
{
    char *end;
    if (!isdigit((unsigned char)*shard_text))
        return false;
    const unsigned long part = strtoul(shard_text, &end, 10);
    if (*end != '/' || !isdigit((unsigned char)end[1]))
        return false;
    const unsigned long parts = strtoul(end + 1, &end, 10);
    shard = (uint32_t)part;
    shards = (uint32_t)parts;
    return !*end && part >= 1 && part <= parts && parts <= 1000000;
}

static int check_folders(const char *const *operands, int count)
{
    const output_file report[] = {{"--report", report_path}, {NULL, NULL}};
    if (depfile_path || desc.charts_ply || name)
        return usage("--depfile, --charts-ply and --name are for one asset");
    for (int i = 0; i < count; ++i)
        if (is_stream(operands[i]))
            return usage("stdin has no name for an asset in a folder");
    if (shard_text && !parse_shard())
        return usage("--shard takes I/N, I from 1 to N");
    return check_outputs("gtx cook", report, operands, (size_t)count);
}

/* What the models refer to. */
static gtx_result check_sources(const char *const *paths, size_t count, void *user,
                                gtx_error *error)
{
    (void)user;
    for (size_t i = 0; i < count && depfile_path; ++i)
        if (!fits_depfile(paths[i]))
            return gtx_fail(error, GTX_ERROR_ARGUMENT, "a dependency file cannot name a path with "
                                                       "a line break: %s", paths[i]);
    return refuse_inputs(outputs, paths, count, error);
}

/* To stdout once it is whole, or to a file as gtx_cook_file would. */
static int write_asset(const gtx_asset *asset)
{
    const gtx_jobs jobs = gtx_host_jobs(desc.threads);
    const gtx_encode_desc encode = {.jobs = &jobs, .zstd_level = encode_level(zstd_level)};
    gtx_error error;
    void *data;
    size_t size;
    if (!is_stream(output))
        return gtx_save_file(asset, output, &encode, &error) ? report_error(output, &error)
                                                             : EXIT_CODE_OK;
    if (gtx_encode(asset, &encode, &data, &size, &error))
        return report_error("stdout", &error);
    int code = print_result(data, size);
    free(data);
    return code;
}

/* Where stdin or stdout takes part. */
static int cook_stream(const char *model, const char *label, gtx_report *report)
{
    void *data;
    size_t size;
    gtx_asset *asset = NULL;
    gtx_error error;
    int code = read_whole(model, &data, &size);
    if (code)
        return code;
    catch_interrupt();
    gtx_result result = gtx_cook_memory(data, size, is_stream(model) && name ? name : model, &desc,
                                        &asset, report, &error);
    end_progress();
    const void *held = NULL; /* by a GLB, which keeps its bytes */
    if (!result && gtx_find_asset(data, size, &held, &size, NULL))
        held = NULL;
    if (result)
        code = report_error(label, &error);
    else
        code = !held              ? write_asset(asset)
               : is_stream(output) ? print_result(held, size)
                                   : write_text_file(output, held, size);
    gtx_close(asset);
    free(data);
    return code;
}

static int cook_meshes(const char *scene, const char *label, gtx_report *report)
{
    gtx_error error;
    desc.unit = 0;
    desc.measure = 0;
    catch_interrupt();
    gtx_result result = gtx_cook_scene(scene, output, &desc, report, &error);
    end_progress();
    return result ? report_error(label, &error) : EXIT_CODE_OK;
}

static int cook_files(const char *model, const char *label, gtx_report *report)
{
    gtx_error error;
    catch_interrupt();
    gtx_result result = gtx_cook_file(model, output, &desc, report, &error);
    end_progress();
    return result ? report_error(label, &error) : EXIT_CODE_OK;
}

static int tell(const char *label, const gtx_report *report)
{
    for (size_t i = 0; i < report->warning_count; ++i)
        report_warning(label, report->warning_names[i], report->warnings[i]);
    if (!cli_quiet)
        print_message("%s: %s", is_stream(output) ? "stdout" : output, report->summary);
    int code = EXIT_CODE_OK;
    if (depfile_path)
        code = write_depfile(depfile_path, output, report->sources, report->source_count);
    if (!code && report_path)
        code = write_text_file(report_path, report->json, report->size);
    return code;
}

/* Cuts the names apart; more than the library takes it refuses. */
static void set_allowed(void)
{
    static char text[1024];
    static const char *names[65];
    snprintf(text, sizeof text, "%s", allow ? allow : "");
    for (char *at = strtok(text, ","); at && desc.allow_count < 65; at = strtok(NULL, ","))
        names[desc.allow_count++] = at;
    desc.allow = names;
}

/* False where there is no kind of that name. */
static bool set_textures(void)
{
    static const struct {
        const char *name;
        uint32_t bit;
    } kinds[] = {{"normals", GTX_TEXTURES_NORMALS}, {"bc", GTX_TEXTURES_BC},
                 {"bc-small", GTX_TEXTURES_BC_SMALL}, {"etc2", GTX_TEXTURES_ETC2}};
    for (const char *at = textures; at;) {
        const size_t size = strcspn(at, ",");
        const uint32_t before = desc.texture_formats;
        for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i)
            if (strlen(kinds[i].name) == size && !memcmp(kinds[i].name, at, size))
                desc.texture_formats |= kinds[i].bit;
        if (desc.texture_formats == before)
            return false;
        at = at[size] ? at + size + 1 : NULL;
    }
    return desc.texture_formats != GTX_TEXTURES_NORMALS;
}

int cmd_cook(int argc, char **argv)
{
    static const char *models[MAX_MODELS];
    int count;
    int code = parse_options(&cook, argc, argv, models, &count);
    if (code >= 0)
        return code;
    const bool folders = output && !per_mesh && !is_stream(output) &&
                         is_folder_cook(models, count, output);
    code = check(models, count, folders);
    if (!code && folders)
        code = check_folders(models, count);
    if (!code && !folders && (job_count || shard_text))
        code = usage("--jobs and --shard are for folders");
    if (!code && !set_textures())
        code = usage("--texture-format takes bc, bc-small, etc2, once each, and normals with one");
    if (code)
        return code;
    desc.partition = (gtx_partition)partition;
    desc.extract = (gtx_extract)(GTX_EXTRACT_CPU + extract);
    desc.zstd_level = encode_level(zstd_level);
    desc.lod_levels = lod_levels ? lod_levels : GTX_LOD_LEVELS_NONE;
    desc.unit = (float)unit;
    desc.measure = report_path != NULL;
    desc.adaptive = adaptive;
    desc.texel_density = texel_density < 0    ? 0
                         : texel_density == 0 ? GTX_TEXEL_DENSITY_RELIEF
                                              : (float)texel_density;
    desc.strict = strict;
    set_allowed();
    desc.if_changed = if_changed;
    desc.limits = cli_limits;
    if (folders) {
        desc.measure = 0; /* that would take longer than cooking */
        return cook_folders(&(folder_cook){models, count, output, &desc, report_path, job_count,
                                           shard, shards});
    }
    desc.more = models + 1;
    desc.more_count = (uint32_t)(count - 1);
    desc.progress = show_progress;
    desc.sources_fn = check_sources;

    const char *label = count > 1 ? "gtx cook" : is_stream(models[0]) ? "stdin" : models[0];
    bool streams = is_stream(models[0]) || is_stream(output);
    gtx_report report;
    memset(&report, 0, sizeof report);
    code = (per_mesh ? cook_meshes : streams ? cook_stream : cook_files)(models[0], label, &report);
    if (!code)
        code = tell(label, &report);
    gtx_report_free(&report);
    return code;
}
