/* gtx combine: union, intersection and difference of two assets. */
#include "cli/cli.h"

#include "base/warnings.h"
#include "host/jobs.h"

#include <geotex/solid.h>
#include <geotex/export.h>

#include <inttypes.h>
#include <string.h>

static const char *output, *report_path;
static int32_t zstd_level = 6;
static uint32_t op = UINT32_MAX, lod_levels = 5, threads;
static double openness;
static bool strict;

static const option options[] = {
    {"op", 0, OPTION_CHOICE, &op, "union|intersect|subtract",
     "what is inside A or B, both, or A and not B (required)", 0, 0},
    {"output", 'o', OPTION_STRING, &output, "OUT.gtx", "file to write (required)", 0, 0},
    {"openness", 0, OPTION_NUMBER, &openness, "X",
     "accept assets whose inside is in doubt at up to this share of points [0.01]", 1e-9, 1},
    {"lod-levels", 0, OPTION_UINT, &lod_levels, "N",
     "most LOD meshes, made from the combined maps; 0 = none at all [5]", 0, 5},
    {"zstd", 0, OPTION_INT, &zstd_level, "L", "compression level, 0 = stored [6]", 0, 19},
    {"strict", 0, OPTION_FLAG, &strict, NULL, "warnings are errors (exit 3)", 0, 0},
    THREADS_OPTION(&threads),
    PROGRESS_OPTION,
    {"report", 0, OPTION_STRING, &report_path, "R.json",
     "write a report, with the volumes of both assets and of the result", 0, 0},
    {0}};

static const verb combine = {
    "combine", "A.gtx B.gtx --op OP -o OUT.gtx",
    "Combines two closed assets, placed in the same coordinates, as solids. Patches are trimmed\n"
    "where the surfaces cross, and keep their heights, normals, colours and materials. Patches of\n"
    "B that become the wall of a cavity are reversed.",
    2, 2, options, MAKING_LIMITS | 1 << GTX_LIMITED_CELLS};

/* What the default allows; beyond it there is a warning. */
static const double CLOSED = 0.01;
static const char *const ops[] = {"union", "intersect", "subtract"};

/* All that is told of a call. */
typedef struct outcome {
    gtx_combine_result parts;
    gtx_solid_facts facts;        /* of the result */
    gtx_info info;
    bool open[2];
} outcome;

static void write_facts(gtx_json *json, const gtx_solid_facts *facts)
{
    gtx_json_number(json, "volume", facts->volume);
    gtx_json_number(json, "area", facts->area);
    gtx_json_number(json, "openness", facts->openness);
}

static const char *const open_sentences[2] = {
    "the first asset is open: what is inside it is in doubt",
    "the second asset is open: what is inside it is in doubt"};

static void write_report(gtx_json *json, const outcome *o)
{
    const gtx_combine_result *parts = &o->parts;
    gtx_json_begin_object(json, NULL);
    gtx_json_string(json, "op", ops[op]);
    gtx_json_begin_array(json, "assets");
    for (int side = 0; side < 2; ++side) {
        gtx_json_begin_object(json, NULL);
        write_facts(json, &parts->facts[side]);
        gtx_json_integer(json, "whole_patches", parts->whole[side]);
        gtx_json_integer(json, "cut_patches", parts->cut[side]);
        gtx_json_integer(json, "dropped_patches", parts->dropped[side]);
        gtx_json_end_object(json);
    }
    gtx_json_end_array(json);
    gtx_json_begin_object(json, "result");
    write_facts(json, &o->facts);
    gtx_json_integer(json, "patches", o->info.patch_count);
    gtx_json_integer(json, "lod_meshes", o->info.lod_levels);
    gtx_json_end_object(json);
    gtx_json_number(json, "error", parts->error);
    for (int names = 0; names < 2; ++names) {
        gtx_json_begin_array(json, names ? "warning_names" : "warnings");
        for (int side = 0; side < 2; ++side)
            if (o->open[side])
                gtx_json_string(json, NULL, names ? gtx_warning_name(GTX_WARNING_OPEN_SOLID)
                                                  : open_sentences[side]);
        gtx_json_end_array(json);
    }
    gtx_json_end_object(json);
}

static int tell(const outcome *o)
{
    const gtx_combine_result *parts = &o->parts;
    if (!cli_quiet)
        print_message("%s: volume %.6g of %.6g and %.6g, %u patches, %u of them cut, outlines "
                      "within %.3g", output, o->facts.volume, parts->facts[0].volume,
                      parts->facts[1].volume, o->info.patch_count, parts->cut[0] + parts->cut[1],
                      parts->error);
    if (!report_path)
        return EXIT_CODE_OK;
    gtx_json json = {0};
    write_report(&json, o);
    const int code = json.failed ? report_no_memory(report_path)
                                 : write_text_file(report_path, json.text, json.size);
    gtx_json_free(&json);
    return code;
}

static gtx_result check_warnings(const char *const files[2], outcome *o, gtx_error *error)
{
    for (int side = 0; side < 2; ++side) {
        o->open[side] = o->parts.facts[side].openness > CLOSED;
        if (o->open[side] && strict)
            return gtx_fail(error, GTX_ERROR_INPUT, "%s (--strict)", open_sentences[side]);
        if (o->open[side])
            report_warning(files[side], gtx_warning_name(GTX_WARNING_OPEN_SOLID),
                           open_sentences[side]);
    }
    return GTX_OK;
}

/* What the result is as a solid: how open it is says how well the parts meet. */
static gtx_result measure(const gtx_asset *asset, const gtx_jobs *jobs, outcome *o,
                          gtx_error *error)
{
    const gtx_solid_desc desc = {.jobs = jobs, .limits = cli_limits, .max_openness = 1};
    gtx_solid *solid = NULL;
    const gtx_result result = gtx_solid_create(asset, &desc, &solid, error);
    gtx_solid_measure(solid, &o->facts);
    gtx_solid_destroy(solid);
    return result;
}

/* *file is what a failure is about. */
static gtx_result run(gtx_asset *const assets[2], const char *const files[2], outcome *o,
                      const char **file, gtx_error *error)
{
    const gtx_jobs jobs = gtx_host_jobs(threads);
    const gtx_combine_desc desc = {.op = (gtx_combine_op)op, .max_openness = (float)openness,
                                   .jobs = &jobs, .limits = cli_limits};
    const gtx_encode_desc encode = {.jobs = &jobs, .zstd_level = encode_level(zstd_level)};
    gtx_asset *made = NULL;
    *file = "gtx combine";
    gtx_result result = gtx_combine(assets[0], assets[1], &desc, &made, &o->parts, error);
    if (!result)
        result = check_warnings(files, o, error);
    if (!result)
        result = measure(made, &jobs, o, error);
    if (!result && lod_levels)
        result = add_lod_meshes(&made, lod_levels, threads, error);
    if (!result) {
        gtx_get_info(made, &o->info);
        *file = output;
        catch_interrupt();
        result = gtx_save_file(made, output, &encode, error);
    }
    gtx_close(made);
    return result;
}

int cmd_combine(int argc, char **argv)
{
    const char *files[2], *file = NULL;
    int count;
    int code = parse_options(&combine, argc, argv, files, &count);
    if (code >= 0)
        return code;
    if (!output || op == UINT32_MAX) {
        print_message("gtx combine: error[usage]: %s (see gtx combine --help)",
                      output ? "--op is missing" : "-o OUT.gtx is missing");
        return EXIT_CODE_USAGE;
    }
    const output_file outputs[] = {{"-o", output}, {"--report", report_path}, {NULL, NULL}};
    code = check_outputs("gtx combine", outputs, files, 2);
    if (code)
        return code;
    const gtx_open_desc open = {.limits = cli_limits};
    gtx_asset *assets[2] = {NULL, NULL};
    gtx_error error = {0};
    outcome o = {.info = {0}};
    gtx_result result = GTX_OK;
    for (int side = 0; side < 2 && !result; ++side) {
        file = files[side];
        result = gtx_open_exported(file, &open, &assets[side], &error);
    }
    if (!result)
        result = run(assets, files, &o, &file, &error);
    gtx_close(assets[0]);
    gtx_close(assets[1]);
    return result ? report_error(file, &error) : tell(&o);
}
