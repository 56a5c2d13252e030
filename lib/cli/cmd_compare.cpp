/* gtx compare: an asset, or a world, against its source mesh. */
#include "cli/guard.hpp"
#include "cli/view/world.hpp"
#include "world/compare.hpp"

#include <geotex/cook.h>

#include <cinttypes>

enum { MAX_FILES = 4097 };

static gtx_compare_desc desc;
static bool as_json, any_model, depths, local_metres;
static double tile_error, max_holes = -1, max_walls = -1, max_turned = -1;
static double min_iou = -1, max_rms = -1;

static const option options[] = {
    {"json", 0, OPTION_FLAG, &as_json, nullptr, "print the whole report as JSON", 0, 0},
    {"size", 0, OPTION_UINT, &desc.size, "N", "pixels along a side of a view [1024]", 64, 4096},
    {"views", 0, OPTION_UINT, &desc.random_views, "N",
     "random views in addition to the 26 fixed ones [0]", 0, 4096},
    {"seed", 0, OPTION_UINT, &desc.seed, "S", "seed of the random views [0]", 0, UINT32_MAX},
    {"levels", 0, OPTION_UINT, &desc.levels, "N",
     "levels of detail in the report, with --json [all]", 1, 8},
    {"tile-error", 0, OPTION_NUMBER, &tile_error, "X",
     "of a world: the coarsest tiles within X of the source, in its units, not the leaves [0]", 0,
     1e30},
    {"up", 0, OPTION_CHOICE, &desc.z_up, "y|z",
     "the up axis that the asset was cooked with [y]", 0, 0},
    {"depths", 0, OPTION_FLAG, &depths, nullptr,
     "values of grids are depths: positive is down, as horizons and world plan have it", 0, 0},
    {"local-metres", 0, OPTION_FLAG, &local_metres, nullptr,
     "convert grids in degrees to metres, as horizons and world plan do", 0, 0},
    {"any-model", 0, OPTION_FLAG, &any_model, nullptr,
     "also measure against a model that the asset was not cooked from, or that has changed", 0, 0},
    {"base-color", 0, OPTION_STRING, &desc.base_color, "FILE",
     "image for materials of OBJ and glTF that have texture coordinates but no readable image",
     0, 0},
    {"texture-dir", 0, OPTION_STRING, &desc.texture_dir, "DIR",
     "folder in which to look, by file name, for textures that are not beside the model", 0, 0},
    THREADS_OPTION(&desc.threads),
    PROGRESS_OPTION,
    {"max-holes", 0, OPTION_NUMBER, &max_holes, "N", "exit 7 above N hole pixels", 0, 1e18},
    {"max-walls", 0, OPTION_NUMBER, &max_walls, "N", "exit 7 above N wall pixels", 0, 1e18},
    {"max-turned", 0, OPTION_NUMBER, &max_turned, "N", "exit 7 above N turned pixels", 0, 1e18},
    {"min-iou", 0, OPTION_NUMBER, &min_iou, "X", "exit 7 below this silhouette IoU", 0, 1},
    {"max-rms", 0, OPTION_NUMBER, &max_rms, "X",
     "exit 7 above this RMS distance of the source from the asset, in bounding-box diagonals",
     0, 1},
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const verb compare_verb = {
    "compare", "ASSET MODEL...",
    "Measures an asset against the models it was cooked from, on the CPU. format/measures.md,\n"
    "installed as share/doc/geotex/measures.md, defines every figure. An asset that names its\n"
    "source is not compared with any other model (exit 3), unless --any-model is given.\n"
    "MODEL may be a height grid, as for horizons and world plan.\n"
    "ASSET may be a world, DIR of gtx world: its tiles are measured together, seams between them\n"
    "included. They and the models, in whole, are in memory at once.",
    2, MAX_FILES, options, MODEL_LIMITS};

static int differs(const char *asset, const char *what, double value, const char *how, double limit)
{
    print_message("%s: error[differs]: %s %.9g: %s %.9g", asset, what, value, how, limit);
    return EXIT_CODE_DIFFERS;
}

/* Says of every limit that is passed by how much. Returns the exit code. */
static int judge(const char *asset, const gtx_compare_result *result)
{
    int code = EXIT_CODE_OK;
    if (max_holes >= 0 && double(result->hole_pixels) > max_holes)
        code = differs(asset, "hole pixels", double(result->hole_pixels), "above --max-holes",
                       max_holes);
    if (max_walls >= 0 && double(result->wall_pixels) > max_walls)
        code = differs(asset, "wall pixels", double(result->wall_pixels), "above --max-walls",
                       max_walls);
    if (max_turned >= 0 && double(result->turned_pixels) > max_turned)
        code = differs(asset, "turned pixels", double(result->turned_pixels),
                       "above --max-turned", max_turned);
    if (min_iou >= 0 && result->silhouette_iou < min_iou)
        code = differs(asset, "silhouette IoU", result->silhouette_iou, "below --min-iou",
                       min_iou);
    if (max_rms >= 0 && result->forward_rms > max_rms)
        code = differs(asset, "forward RMS", result->forward_rms,
                       "above --max-rms", max_rms);
    return code;
}

static void print_figures(const gtx_compare_result &result)
{
    printf("hole pixels     %" PRIu64 " of %" PRIu64 "\n", result.hole_pixels,
           result.surface_pixels);
    printf("wall pixels     %" PRIu64 "\n", result.wall_pixels);
    printf("turned pixels   %" PRIu64 "\n", result.turned_pixels);
    printf("silhouette IoU  %.5f (worst view %.5f)\n", result.silhouette_iou,
           result.silhouette_iou_min);
    printf("forward RMS     %.5f %% of the diagonal\n", 100 * result.forward_rms);
    printf("reverse maximum %.5f %% of the diagonal\n", 100 * result.reverse_max);
    printf("seams           99 %% within %.2f height steps, all within %.2f\n",
           result.seam_p99_steps, result.seam_max_steps);
}

/* Fills both, or says why not; returns an exit code. `files` ends with the models. */
static int measure(const char *const *files, int count, gtx_compare_result *result,
                   gtx_report *report)
{
    return gtx::guarded(files[0], [&](std::string &about) {
        const std::string world = gtx::world_at(files[0]);
        if (!world.empty()) {
            gtx::compare_world(world, files[1], tile_error, desc, result, report, about);
            return int(EXIT_CODE_OK);
        }
        gtx_error error;
        if (gtx_compare_files(files[0], files[1], &desc, result, report, &error)) {
            about = error.rule ? files[0] : count > 2 ? "gtx compare" : files[1];
            throw gtx::Error(error);
        }
        return int(EXIT_CODE_OK);
    });
}

int cmd_compare(int argc, char **argv)
{
    static const char *files[MAX_FILES];
    int count;
    int code = parse_options(&compare_verb, argc, argv, files, &count);
    if (code >= 0)
        return code;
    desc.more = files + 2;
    desc.more_count = uint32_t(count - 2);
    desc.any_model = any_model;
    desc.depths = depths;
    desc.local_metres = local_metres;
    desc.figures_only = !as_json;
    desc.progress = show_progress;
    desc.limits = cli_limits;
    catch_interrupt();

    gtx_report report = {};
    gtx_compare_result result;
    code = measure(files, count, &result, &report);
    end_progress();
    if (code)
        return code;
    if (as_json) {
        code = print_result(report.json, report.size);
    } else {
        print_figures(result);
        code = print_result("", 0);
    }
    for (size_t i = 0; i < report.warning_count; ++i)
        report_warning(count > 2 ? "gtx compare" : files[1], report.warning_names[i],
                       report.warnings[i]);
    gtx_report_free(&report);
    return code ? code : judge(files[0], &result);
}
