/* An asset measured against its source model, behind the C API. */
#include "cook/guard.hpp"
#include "cook/models.hpp"
#include "cook/report.hpp"

#include "base/alloc.h"

namespace gtx {

static void check(const gtx_compare_desc &desc)
{
    require_zeroed(desc.reserved);
    require_argument(desc.size <= 4096, "size is at most 4096");
    require_argument(desc.levels <= 8, "levels is at most 8");
    require_argument(desc.threads <= 1024, "threads is at most 1024");
    require_argument(desc.z_up <= 1, "z_up is 0 or 1");
    require_models(desc.more, desc.more_count);
}

static void compare_files(const gtx_asset *asset, const char *model, const gtx_compare_desc &desc,
                          gtx_compare_result *result, gtx_report *report)
{
    Task task(desc.threads, desc.progress, desc.progress_user, {"import", "clean", "measure"},
              {5, 10, 85});
    task.begin("import");
    Models models = read_models({model}, desc.more, desc.more_count, task);
    Mesh mesh = import_models(models, desc.z_up, task);
    CleanReport clean;
    task.begin("clean");
    mesh = clean_mesh(std::move(mesh), task, clean);

    gtx_info info;
    gtx_get_info(asset, &info);
    CompareOptions options;
    options.size = desc.size ? desc.size : 1024;
    options.levels = desc.levels ? desc.levels : info.mip_count;
    task.begin("measure");
    CompareReport measured = compare(asset, mesh, options, task);
    task.end();

    if (report) {
        Json json(gtx_allocator_or_default(desc.allocator));
        std::string summary = write_compare_report(measured, task.warnings, json);
        Report(json, summary, models.sources, task.warnings).hand_over(report);
    }
    if (result)
        *result = {measured.hole_pixels, measured.surface_pixels, measured.silhouette_iou,
                   measured.silhouette_iou_min, measured.error.forward.rms};
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
    gtx_result opened = gtx_open_file(asset_path, &open, &asset, error); /* keeps its rule */
    if (opened)
        return opened;
    gtx_result compared = gtx::guard(
        error, [&] { gtx::compare_files(asset, model, given, result, report); });
    gtx_close(asset);
    return compared;
}
