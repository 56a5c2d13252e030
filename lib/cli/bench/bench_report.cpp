/* The measurements in an orbit, as a table and as JSON. */
#include "cli/bench/bench.hpp"

#include "base/json.h"

#include <cstdio>

namespace gtx {

void print_bench_head(bool truth)
{
    std::printf("| window    | count | method        | error | median    | least     | mesh/   "
                "| work      | IoU    | PSNR  | holes | rays     | triang. |%s\n"
                "|---|---|---|---|---|---|---|---|---|---|---|---|---|%s\n",
                truth ? TRUTH_COLUMNS : "", truth ? TRUTH_RULES : "");
}

void print_bench_row(const BenchRow &row, double mesh)
{
    char window[32], ratio[32] = "", error[32] = "";
    std::snprintf(window, sizeof window, "%ux%u", row.size[0], row.size[1]);
    if (mesh > 0 && row.frames)
        std::snprintf(ratio, sizeof ratio, "%.2f", mesh / row.median);
    if (row.max_error > 0)
        std::snprintf(error, sizeof error, "%g", row.max_error);
    std::printf("| %-9s | %5u | %-13s ", window, row.instances,
                bench_method_names[uint32_t(row.method)]);
    if (row.frames)
        std::printf("| %5s | %9.2f | %9.2f | %7s | %9.2f | %6.4f | %5.1f | %5llu | %8llu | %7u "
                    "|%s\n",
                    error, row.median, row.least, ratio, row.work, row.iou, row.psnr,
                    (unsigned long long)row.holes, (unsigned long long)row.rays, row.triangles,
                    truth_cells(row.truth).c_str());
    else
        std::printf("| skipped: %s |\n", row.skipped);
    std::fflush(stdout);
}

void write_bench_row(gtx_json &json, const BenchSetup &setup, const BenchRow &row)
{
    char zoom[32];
    std::snprintf(zoom, sizeof zoom, "%ux%u", row.size[0], row.size[1]);
    gtx_json_begin_object(&json, nullptr);
    gtx_json_integer(&json, "instances", row.instances);
    gtx_json_string(&json, "zoom", zoom);
    gtx_json_string(&json, "method", bench_method_names[uint32_t(row.method)]);
    if (row.skipped) {
        gtx_json_string(&json, "reason", row.skipped);
    } else {
        gtx_json_string(&json, "platform", without_vulkan(row.method) != row.method
                                               ? setup.device.c_str()
                                               : setup.renderer.c_str());
        gtx_json_integer(&json, "pixels", row.pixels);
        gtx_json_integer(&json, "frames", row.frames);
        gtx_json_number(&json, "ms_median", row.median);
        gtx_json_number(&json, "ms_min", row.least);
        gtx_json_number(&json, "ms_work", row.work);
        gtx_json_number(&json, "silhouette_iou", row.iou);
        gtx_json_number(&json, "psnr_db", row.psnr);
        gtx_json_integer(&json, "hole_pixels", row.holes);
        gtx_json_integer(&json, "rays", row.rays);
        gtx_json_integer(&json, "hits", row.hits);
        if (row.max_error > 0)
            gtx_json_number(&json, "max_error_px", row.max_error);
        if (row.triangles)
            gtx_json_integer(&json, "triangles", row.triangles);
        write_truth(json, row.truth);
    }
    gtx_json_end_object(&json);
}

} // namespace gtx
