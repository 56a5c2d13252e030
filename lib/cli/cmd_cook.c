/* gtx cook: a triangle mesh -> an asset. */
#include "cli/cli.h"

#include <geotex/cook.h>

#include <string.h>

static gtx_cook_desc desc;
static const char *output, *report_path;
static uint32_t partition;
static double unit = 1;
static int32_t zstd_level = 3;

static const option options[] = {
    {"output", 'o', OPTION_STRING, &output, "OUT.gtx", "where the asset goes (required)", 0, 0},
    {"charts", 0, OPTION_UINT, &desc.charts, "N", "wanted number of patches [10 T^0.28]", 1, 1e6},
    {"resolution", 0, OPTION_UINT, &desc.resolution, "N", "texels along the longest patch [128]", 64,
     512},
    {"partition", 0, OPTION_CHOICE, &partition, "vsa", "how the surface is cut into charts [vsa]", 0,
     0},
    {"height-bits", 0, OPTION_UINT, &desc.height_bits, "8|16", "bits of a height [8]", 8, 16},
    {"mips", 0, OPTION_UINT, &desc.mips, "N", "levels of normal and colour [4]", 1, 8},
    {"dilation", 0, OPTION_UINT, &desc.dilation, "N", "texels of dilation [2^(mips-1)]", 1, 128},
    {"zstd", 0, OPTION_INT, &zstd_level, "L", "compression level, 0 = stored [3]", 0, 19},
    {"threads", 0, OPTION_UINT, &desc.threads, "N", "0 = all processors [0]", 0, 1024},
    {"unit", 0, OPTION_NUMBER, &unit, "M", "metres per unit of the model [1]", 1e-30, 1e30},
    {"report", 0, OPTION_STRING, &report_path, "R.json", "write the cook report, error measured", 0,
     0},
    {"charts-ply", 0, OPTION_STRING, &desc.charts_ply, "F.ply",
     "write the first partition, a colour a chart, inverted triangles green", 0, 0},
    {0}};

static const verb cook = {"cook", "MODEL -o OUT.gtx",
                          "Cooks OBJ, PLY, Draco, glTF and GLB models into a .gtx asset.", 1, 1,
                          options};

int cmd_cook(int argc, char **argv)
{
    const char *model;
    int count;
    int code = parse_options(&cook, argc, argv, &model, &count);
    if (code >= 0)
        return code;
    if (!output) {
        fputs("gtx cook: error[usage]: -o OUT.gtx is missing\n", stderr);
        return EXIT_CODE_USAGE;
    }
    desc.partition = (gtx_partition)(GTX_PARTITION_VSA + partition);
    desc.zstd_level = zstd_level ? zstd_level : -1;
    desc.unit = (float)unit;
    desc.measure = report_path != NULL;
    desc.progress = show_progress;
    catch_interrupt();

    gtx_report report;
    gtx_error error;
    memset(&report, 0, sizeof report);
    gtx_result result = gtx_cook_file(model, output, &desc, &report, &error);
    end_progress();
    if (result != GTX_OK)
        return report_error(model, &error);
    for (size_t i = 0; i < report.warning_count; ++i)
        report_warning(model, report.warnings[i]);
    if (!cli_quiet)
        fprintf(stderr, "%s: %s\n", output, report.summary);
    code = report_path ? write_text_file(report_path, report.json, report.size) : EXIT_CODE_OK;
    gtx_report_free(&report);
    return code;
}
