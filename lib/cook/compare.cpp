/* An asset measured against its source model, behind the C API. */
#include "cook/compare.hpp"
#include "cook/guard.hpp"
#include "cook/meta.hpp"
#include "cook/report.hpp"

#include "base/alloc.h"

#include <geotex/export.h>

namespace gtx {

static void check(const gtx_compare_desc &desc)
{
    require_zeroed(desc.reserved);
    require_argument(desc.size <= 4096, "size is at most 4096");
    require_argument(desc.random_views <= 4096, "random_views is at most 4096");
    require_argument(desc.levels <= 8, "levels is at most 8");
    require_argument(desc.threads <= 1024, "threads is at most 1024");
    require_argument(desc.z_up <= 1, "z_up is 0 or 1");
    require_argument(desc.any_model <= 1, "any_model is 0 or 1");
    require_argument(desc.local_metres <= 1, "local_metres is 0 or 1");
    require_argument(desc.depths <= 1, "depths is 0 or 1");
    require_argument(desc.figures_only <= 1, "figures_only is 0 or 1");
    require_models(desc.more, desc.more_count);
}

/* Of a LevelReport or a DetailReport. */
template <class Part> static void write_cover(Json &json, const Part &part)
{
    gtx_json_integer(&json, "hole_pixels", part.hole_pixels);
    gtx_json_integer(&json, "wall_pixels", part.wall_pixels);
    gtx_json_integer(&json, "leak_pixels", part.leak_pixels);
    gtx_json_number(&json, "silhouette_iou", part.silhouette_iou);
}

static void write_pixels(Json &json, const CompareReport &report)
{
    gtx_json_integer(&json, "views", report.views);
    gtx_json_integer(&json, "surface_pixels", report.surface_pixels);
    gtx_json_integer(&json, "hole_pixels", report.hole_pixels);
    gtx_json_integer(&json, "wall_pixels", report.wall_pixels);
    gtx_json_integer(&json, "leak_pixels", report.leak_pixels);
    gtx_json_integer(&json, "turned_pixels", report.turned_pixels);
    gtx_json_begin_array(&json, "levels");
    for (const LevelReport &level : report.levels) {
        gtx_json_begin_object(&json, nullptr);
        gtx_json_integer(&json, "level", level.level);
        write_cover(json, level);
        gtx_json_end_object(&json);
    }
    gtx_json_end_array(&json);
    gtx_json_begin_array(&json, "details");
    for (const DetailReport &detail : report.details) {
        gtx_json_begin_object(&json, nullptr);
        gtx_json_integer(&json, "size", detail.size);
        gtx_json_integer(&json, "surface_pixels", detail.surface_pixels);
        write_cover(json, detail);
        gtx_json_end_object(&json);
    }
    gtx_json_end_array(&json);
    gtx_json_number(&json, "silhouette_iou", report.silhouette_iou);
    gtx_json_number(&json, "silhouette_iou_min", report.silhouette_iou_min);
}

static void write_differences(Json &json, const CompareReport &report)
{
    gtx_json_begin_object(&json, "depth_error");
    gtx_json_number(&json, "rms", report.depth_rms);
    gtx_json_number(&json, "p99", report.depth_p99);
    gtx_json_number(&json, "max", report.depth_max);
    gtx_json_end_object(&json);
    gtx_json_begin_object(&json, "normal_error_deg");
    gtx_json_number(&json, "mean", report.normal_mean_deg);
    gtx_json_number(&json, "p99", report.normal_p99_deg);
    gtx_json_end_object(&json);
    gtx_json_number(&json, "psnr_db", report.psnr_db);
    gtx_json_begin_object(&json, "error");
    write_deviation(json, "forward", report.error.forward);
    write_deviation(json, "reverse", report.error.reverse);
    gtx_json_end_object(&json);
    gtx_json_begin_object(&json, "seams");
    gtx_json_integer(&json, "points", report.seams.points);
    gtx_json_integer(&json, "within_two_steps", report.seams.within_two_steps);
    gtx_json_number(&json, "p99_steps", report.seams.p99_steps);
    gtx_json_number(&json, "max_steps", report.seams.max_steps);
    gtx_json_number(&json, "max", report.seams.max);
    gtx_json_end_object(&json);
}

/* Fills `json` and returns the line of gtx_report.summary. */
static std::string write_report(const CompareReport &report, const Vector<Warning> &warnings,
                                Json &json)
{
    gtx_json_begin_object(&json, nullptr);
    write_pixels(json, report);
    write_differences(json, report);
    write_warnings(json, warnings);
    gtx_json_end_object(&json);
    check_written(json);
    char line[200];
    snprintf(line, sizeof line,
             "%llu hole, %llu wall and %llu turned pixels, of %llu, silhouette IoU %.5f, forward "
             "RMS %.3g",
             (unsigned long long)report.hole_pixels, (unsigned long long)report.wall_pixels,
             (unsigned long long)report.turned_pixels, (unsigned long long)report.surface_pixels,
             report.silhouette_iou, report.error.forward.rms);
    return line;
}

/* An asset that tells its source is compared with no other. */
static void require_source(const gtx_asset *asset, const Models &models)
{
    uint64_t hash;
    if (read_source_hash(asset, hash) && hash != models.hash)
        throw Error(GTX_ERROR_INPUT,
                    models.files.size() > 1
                        ? "the asset was cooked from other models, or these or their textures "
                          "have changed since (--any-model compares with them)"
                        : "the asset was cooked from another model, or this one or its textures "
                          "have changed since (--any-model compares with it)");
}

CompareTask::CompareTask(const gtx_compare_desc &desc)
    : Task(desc.threads, desc.progress, desc.progress_user, {"import", "clean", "measure"},
           {5, 10, 85}, desc.limits)
{
    constexpr double VIEWS = 32, FIXED_VIEWS = 26; /* their work is that of as many cooks */
    limits.allow_work(VIEWS * (1 + desc.random_views / FIXED_VIEWS));
}

Models read_compared(const char *model, const gtx_compare_desc &desc, Task &task)
{
    return read_sources(model, desc.more, desc.more_count,
                        {text_of(desc.texture_dir), text_of(desc.base_color)},
                        {bool(desc.local_metres), bool(desc.depths)}, task);
}

void compare_models(const ShownAt &shown, uint32_t levels, bool closed, Models &models,
                    const gtx_compare_desc &desc, Task &task, gtx_compare_result *result,
                    gtx_report *report)
{
    Mesh mesh = import_models(models, desc.z_up, task);
    CleanReport clean;
    task.begin("clean");
    mesh = clean_mesh(std::move(mesh), task, clean, closed);

    CompareOptions options;
    options.size = desc.size ? desc.size : 1024;
    options.levels = desc.figures_only ? 1 : desc.levels ? desc.levels : levels;
    options.details = !desc.figures_only;
    options.cut = closed;
    options.random_views = desc.random_views;
    options.seed = desc.seed;
    task.begin("measure");
    CompareReport measured = compare(shown, mesh, options, task);
    task.end();

    if (report) {
        Json json(gtx_allocator_or_default(desc.allocator));
        std::string summary = write_report(measured, task.warnings, json);
        Report(json, summary, models.sources, task.warnings).hand_over(report);
    }
    if (result)
        *result = {measured.hole_pixels, measured.wall_pixels, measured.turned_pixels,
                   measured.surface_pixels, measured.silhouette_iou, measured.silhouette_iou_min,
                   measured.error.forward.rms, measured.error.reverse.max,
                   measured.seams.p99_steps, measured.seams.max_steps};
}

static void compare_files(const gtx_asset *asset, const char *asset_path, const char *model,
                          const gtx_compare_desc &desc, gtx_compare_result *result,
                          gtx_report *report)
{
    CompareTask task(desc);
    gtx_info info;
    gtx_get_info(asset, &info);
    task.limits.read(asset_path, info.file_size);
    task.begin("import");
    Models models = read_compared(model, desc, task);
    if (!desc.any_model)
        require_source(asset, models);
    compare_models([asset](double) { return Assets{asset}; }, info.mip_count, was_closed(asset),
                   models, desc, task, result, report);
}

} // namespace gtx

gtx_result gtx_compare_files(const char *asset_path, const char *model,
                             const gtx_compare_desc *desc, gtx_compare_result *result,
                             gtx_report *report, gtx_error *error)
{
    gtx_compare_desc given = desc ? *desc : gtx_compare_desc{};
    gtx_result checked = gtx::guard(error, [&] {
        gtx::require_argument(asset_path && model, "gtx_compare_files needs an asset and a model");
        gtx::check(given);
    });
    if (checked)
        return checked;
    gtx_asset *asset = nullptr;
    gtx_open_desc open = {};
    open.allocator = given.allocator;
    open.limits = given.limits;
    gtx_result opened = gtx_open_exported(asset_path, &open, &asset, error);
    if (opened)
        return opened;
    gtx_result compared = gtx::guard(
        error, [&] { gtx::compare_files(asset, asset_path, model, given, result, report); });
    gtx_close(asset);
    return compared;
}
