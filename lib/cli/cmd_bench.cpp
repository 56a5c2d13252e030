/* gtx bench: frame times of an asset, its source mesh and what stands between them. */
#include "base/json.h"
#include "cli/bench/bench.hpp"
#include "cli/guard.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace {

const char *sizes = "100x100,200x200,400x400,640x480,800x600,1024x768,1280x1024";
const char *instances = "1";
const char *methods = "mesh,simplified,paper,cast,lod,auto";
uint32_t frames = 12;
double max_error = 0.5, min_iou, budget = 600;
bool as_json;

const option options[] = {
    {"sizes", 0, OPTION_STRING, &sizes, "WxH,...",
     "windows [100x100,200x200,400x400,640x480,800x600,1024x768,1280x1024]", 0, 0},
    {"instances", 0, OPTION_STRING, &instances, "N,...",
     "instances in view, in one draw call [1]", 0, 0},
    {"methods", 0, OPTION_STRING, &methods, "NAME,...",
     "mesh mesh_stream simplified paper cast lod auto cast_depth auto_depth cast_fragment "
     "[mesh,simplified,paper,cast,lod,auto]", 0, 0},
    {"frames", 0, OPTION_UINT, &frames, "N", "frames per method [12]", 1, 10000},
    {"max-error", 0, OPTION_NUMBER, &max_error, "PIXELS",
     "largest error of a level of detail on screen [0.5]", 1e-6, 1e6},
    {"min-iou", 0, OPTION_NUMBER, &min_iou, "SHARE",
     "per window, the largest --max-error of 0.25 to 2 pixels whose silhouette IoU with the mesh "
     "is at least SHARE [0: --max-error as given]", 0,
     1},
    {"budget", 0, OPTION_NUMBER, &budget, "SECONDS", "skip what would exceed this time [600]", 0,
     1e9},
    {"json", 0, OPTION_FLAG, &as_json, nullptr, "the whole report as JSON", 0, 0},
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

const verb bench = {"bench", "ASSET MODEL",
                    "Times an asset against the mesh it was cooked from. The mesh is drawn culled, "
                    "sent again\neach frame, or simplified until it looks as good as auto; the "
                    "asset by each method.", 2, 2, options};

bool usage(const char *what, const std::string &word)
{
    print_message("gtx bench: error[usage]: --%s: '%s' is none", what, word.c_str());
    return false;
}

gtx::Vector<std::string> split(const std::string &list)
{
    gtx::Vector<std::string> out(1);
    for (char c : list)
        if (c == ',')
            out.emplace_back();
        else
            out.back() += c;
    return out;
}

/* A whole number in a range. */
bool parse_number(const std::string &word, uint32_t least, uint32_t most, uint32_t &out)
{
    char *end;
    const unsigned long value = std::strtoul(word.c_str(), &end, 10);
    out = uint32_t(value);
    return !word.empty() && word[0] >= '0' && word[0] <= '9' && !*end && value >= least &&
           value <= most;
}

bool parse_lists(gtx::BenchOptions &out)
{
    for (const std::string &word : split(sizes)) {
        std::array<uint32_t, 2> size;
        const size_t x = word.find('x');
        if (x == std::string::npos || !parse_number(word.substr(0, x), 1, 8192, size[0]) ||
            !parse_number(word.substr(x + 1), 1, 8192, size[1]))
            return usage("sizes", word);
        out.sizes.push_back(size);
    }
    for (const std::string &word : split(instances)) {
        uint32_t count;
        if (!parse_number(word, 1, 100000, count))
            return usage("instances", word);
        out.instances.push_back(count);
    }
    std::sort(out.instances.begin(), out.instances.end());
    for (const std::string &word : split(methods)) {
        const char *const *names = gtx::bench_method_names;
        const char *const *name = std::find(names, names + gtx::BENCH_METHODS, word);
        if (name == names + gtx::BENCH_METHODS)
            return usage("methods", word);
        out.methods.push_back(gtx::BenchMethod(name - names));
    }
    return true;
}

/* A line of the table. The ratios are against the mesh's row of the same window. */
void print_row(const gtx::BenchRow &row, double mesh)
{
    char window[32], ratio[32] = "", error[32] = "";
    std::snprintf(window, sizeof window, "%ux%u", row.size[0], row.size[1]);
    if (mesh > 0 && row.frames)
        std::snprintf(ratio, sizeof ratio, "%.2f", mesh / row.median);
    if (row.max_error > 0)
        std::snprintf(error, sizeof error, "%g", row.max_error);
    std::printf("| %-9s | %5u | %-11s ", window, row.instances,
                gtx::bench_method_names[uint32_t(row.method)]);
    if (row.frames)
        std::printf("| %5s | %9.2f | %9.2f | %7s | %9.2f | %6.4f | %5.1f | %5llu | %8llu | %7u |\n",
                    error, row.median, row.least, ratio, row.work, row.iou, row.psnr,
                    (unsigned long long)row.holes, (unsigned long long)row.rays, row.triangles);
    else
        std::printf("| skipped: %s |\n", row.skipped);
    std::fflush(stdout);
}

void write_row(gtx_json &json, const gtx::BenchSetup &setup, const gtx::BenchRow &row)
{
    char zoom[32];
    std::snprintf(zoom, sizeof zoom, "%ux%u", row.size[0], row.size[1]);
    gtx_json_begin_object(&json, nullptr);
    gtx_json_integer(&json, "instances", row.instances);
    gtx_json_string(&json, "zoom", zoom);
    gtx_json_string(&json, "method", gtx::bench_method_names[uint32_t(row.method)]);
    if (row.skipped) {
        gtx_json_string(&json, "reason", row.skipped);
    } else {
        gtx_json_string(&json, "platform", setup.renderer.c_str());
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
    }
    gtx_json_end_object(&json);
}

int tell_json(const char *scene, const gtx::BenchSetup &setup,
               const gtx::Vector<gtx::BenchRow> &rows)
{
    gtx_json json = {};
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "scene", scene);
    gtx_json_integer(&json, "triangles", setup.triangles);
    gtx_json_integer(&json, "gpu_geometry_bytes", setup.geometry_bytes);
    gtx_json_number(&json, "open_ms", setup.open);
    gtx_json_number(&json, "prepare_ms", setup.prepare);
    gtx_json_number(&json, "upload_ms", setup.upload);
    for (bool skipped : {false, true}) {
        gtx_json_begin_array(&json, skipped ? "skipped" : "rows");
        for (const gtx::BenchRow &row : rows)
            if (skipped == (row.skipped != nullptr))
                write_row(json, setup, row);
        gtx_json_end_array(&json);
    }
    gtx_json_end_object(&json);
    return print_json(scene, &json);
}

void print_head(const char *scene, const gtx::BenchSetup &setup)
{
    std::string line = scene; /* of a table, whatever the path holds */
    gtx_make_printable(line.data());
    std::printf("%s: %u triangles, %.2f bytes each on the GPU (colour apart)\n"
                "open %.1f ms, prepare %.1f ms, upload %.1f ms, together %.1f ms\n"
                "%s, milliseconds; error: pixels, of a level\n", line.c_str(),
                setup.triangles, double(setup.geometry_bytes) / std::max(1u, setup.triangles),
                setup.open, setup.prepare, setup.upload,
                setup.open + setup.prepare + setup.upload, setup.renderer.c_str());
    std::printf("| window    | count | method      | error | median    | least     | mesh/   "
                "| work      "
                "| IoU    | PSNR  | holes | rays     | triang. |\n"
                "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

} // namespace

int cmd_bench(int argc, char **argv)
{
    const char *files[2];
    int count;
    int code = parse_options(&bench, argc, argv, files, &count);
    if (code >= 0)
        return code;
    return gtx::guarded(files[1], [&](std::string &current) {
        gtx::BenchOptions wanted;
        wanted.frames = frames;
        wanted.max_error = max_error;
        wanted.min_iou = min_iou;
        wanted.budget = budget;
        if (!parse_lists(wanted))
            return int(EXIT_CODE_USAGE);
        gtx::Task task(0, nullptr, nullptr, {}, {}, cli_limits);
        gtx::CleanReport report;
        const gtx::Mesh mesh = gtx::clean_mesh(gtx::import_mesh(files[1], task), task, report);
        gtx::report_warnings(files[1], task.warnings);
        current = files[0];
        gtx::BenchSetup setup;
        gtx::Vector<gtx::BenchRow> rows;
        double of_mesh = 0;
        gtx::run_bench(
            files[0], mesh, wanted,
            [&](const gtx::BenchSetup &s) {
                setup = s;
                if (!as_json)
                    print_head(files[1], setup);
            },
            [&](const gtx::BenchRow &row) {
                if (rows.empty() || rows.back().size != row.size ||
                    rows.back().instances != row.instances)
                    of_mesh = 0;
                rows.push_back(row);
                if (row.method == gtx::BenchMethod::MESH)
                    of_mesh = row.median;
                if (!as_json)
                    print_row(row, of_mesh);
            });
        return as_json ? tell_json(files[1], setup, rows) : int(EXIT_CODE_OK);
    });
}
