/* The measurements along a path, as a table and as JSON. */
#include "cli/bench/along.hpp"

#include "base/json.h"

#include <algorithm>
#include <cstdio>

namespace gtx {

constexpr size_t WORST_VIEWS = 10;

static const char *name_of(BenchMethod method)
{
    return bench_method_names[uint32_t(method)];
}

static bool is_of_asset(BenchMethod method)
{
    return method > BenchMethod::MESH_LOD && method != BenchMethod::FLOOR;
}

static void print_worst(const PathReport &report, size_t m)
{
    const PathRow &row = report.rows[m];
    std::printf("# %s against the mesh, worst first\n", name_of(row.method));
    for (size_t i = 0; i < std::min(row.order.size(), WORST_VIEWS); ++i) {
        const size_t v = row.order[i];
        std::printf("%s # view %zu: %.2f ms", path_key(report.path->views[v]).c_str(), v,
                    report.cells[m][v].ms);
        for (size_t k = 0; k < report.rows.size(); ++k)
            if (report.rows[k].method == BenchMethod::MESH)
                std::printf(", %.2f times %.2f", report.cells[m][v].ms / report.cells[k][v].ms,
                            report.cells[k][v].ms);
        std::printf("\n");
    }
}

/* The table's cells that say how a method stands to the mesh; empty where that was not drawn. */
static void print_ratios(const PathRow &row)
{
    if (row.worst > 0)
        std::printf("| %7.3f | %7.3f | %4zu | %7.3f | %7.3f ", row.ratio, row.worst, row.order[0],
                    row.work_ratio, row.work_worst);
    else
        std::printf("| %7s | %7s | %4s | %7s | %7s ", "", "", "", "", "");
}

void print_path_report(const PathReport &report)
{
    const bool truth = !report.rows.empty() && report.rows[0].truth.values;
    std::printf("%ux%u, %zu of %zu views; /mesh, worst: ratio to the mesh's time, median and of "
                "any view; w/mesh: of work;\nholes to IoU: the worst of any view\n"
                "| method        | median  | mean    | work    | /mesh   | worst   | view "
                "| w/mesh  | worst   | holes  | enclosed | outline | IoU    |%s\n"
                "|---|---|---|---|---|---|---|---|---|---|---|---|---|%s\n",
                report.size[0], report.size[1], report.measured, report.path->views.size(),
                truth ? TRUTH_COLUMNS : "", truth ? TRUTH_RULES : "");
    for (const PathRow &row : report.rows) {
        std::printf("| %-13s | %7.2f | %7.2f | %7.2f ", name_of(row.method), row.median, row.mean,
                    row.work);
        print_ratios(row);
        std::printf("| %6llu | %8llu | %7u | %6.4f |%s\n",
                    static_cast<unsigned long long>(row.holes),
                    static_cast<unsigned long long>(row.enclosed), row.outline, row.iou,
                    truth_cells(row.truth).c_str());
    }
    std::printf("\n%s\n", path_head(*report.path).c_str());
    for (size_t m = 0; m < report.rows.size(); ++m)
        if (is_of_asset(report.rows[m].method) && report.rows[m].worst > 0)
            print_worst(report, m);
    std::fflush(stdout);
}

/* ---- JSON ---- */

static void write_vector(gtx_json &json, const char *name, const Vec3d &value)
{
    gtx_json_begin_array(&json, name);
    for (int k = 0; k < 3; ++k)
        gtx_json_number(&json, nullptr, value[k]);
    gtx_json_end_array(&json);
}

static void write_row(gtx_json &json, const PathRow &row)
{
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "method", name_of(row.method));
    gtx_json_number(&json, "ms_median", row.median);
    gtx_json_number(&json, "ms_mean", row.mean);
    gtx_json_number(&json, "ms_work", row.work);
    if (row.worst > 0) {
        gtx_json_number(&json, "ratio_median", row.ratio);
        gtx_json_number(&json, "ratio_worst", row.worst);
        gtx_json_number(&json, "work_ratio_median", row.work_ratio);
        gtx_json_number(&json, "work_ratio_worst", row.work_worst);
        gtx_json_integer(&json, "worst_view", uint64_t(row.order[0]));
    }
    write_truth(json, row.truth);
    gtx_json_end_object(&json);
}

static void write_cell(gtx_json &json, BenchMethod method, const PathCell &cell)
{
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "method", name_of(method));
    gtx_json_number(&json, "ms_min", cell.ms);
    gtx_json_number(&json, "ms_work", cell.work);
    gtx_json_integer(&json, "pixels", cell.pixels);
    gtx_json_number(&json, "silhouette_iou", cell.iou);
    gtx_json_integer(&json, "hole_pixels", cell.holes);
    gtx_json_integer(&json, "enclosed_hole_pixels", cell.enclosed);
    gtx_json_integer(&json, "outline_px", cell.outline);
    if (cell.triangles)
        gtx_json_integer(&json, "triangles", cell.triangles);
    write_truth(json, cell.truth);
    gtx_json_end_object(&json);
}

void write_path_report(gtx_json &json, const PathReport &report)
{
    char zoom[32];
    std::snprintf(zoom, sizeof zoom, "%ux%u", report.size[0], report.size[1]);
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "zoom", zoom);
    write_vector(json, "up", report.path->up);
    gtx_json_number(&json, "fov_degrees", report.path->field);
    gtx_json_integer(&json, "views_wanted", uint64_t(report.path->views.size()));
    gtx_json_begin_array(&json, "rows");
    for (const PathRow &row : report.rows)
        write_row(json, row);
    gtx_json_end_array(&json);
    gtx_json_begin_array(&json, "views");
    for (size_t v = 0; v < report.measured; ++v) {
        gtx_json_begin_object(&json, nullptr);
        write_vector(json, "eye", report.path->views[v].eye);
        write_vector(json, "target", report.path->views[v].target);
        gtx_json_begin_array(&json, "methods");
        for (size_t m = 0; m < report.rows.size(); ++m)
            write_cell(json, report.rows[m].method, report.cells[m][v]);
        gtx_json_end_array(&json);
        gtx_json_end_object(&json);
    }
    gtx_json_end_array(&json);
    gtx_json_end_object(&json);
}

} // namespace gtx
