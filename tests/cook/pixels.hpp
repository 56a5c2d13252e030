/* What an asset shows of its model, pixel by pixel, without the distances that gtx_compare_files
 * measures too: they take longer. */
#pragma once

#include "common/schema.hpp"

#include "measure/measure.hpp"
#include "mesh/task.hpp"

#include "cook/folder.hpp"

inline gtx::CompareReport compare_pixels(const std::string &asset_path, const std::string &model,
                                         gtx::CompareOptions options)
{
    gtx_error error = {};
    gtx_asset *asset = nullptr;
    if (gtx_open_file(asset_path.c_str(), nullptr, &asset, &error))
        fail_msg("%s: %s", asset_path.c_str(), error.message);
    gtx::Task task(0, nullptr, nullptr, {"all"}, {1});
    gtx::CleanReport clean;
    task.limits.allow_work(32); /* as gtx_compare_files does */
    task.begin("all");
    options.surface = false;
    const gtx::CompareReport report = gtx::compare(
        asset, gtx::clean_mesh(gtx::import_mesh(model, task), task, clean), options, task);
    task.end();
    gtx_close(asset);
    return report;
}
