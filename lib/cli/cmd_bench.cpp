/* gtx bench: frame times of an asset, its source mesh and what stands between them. */
#include "base/json.h"
#include "cli/bench/along.hpp"
#include "cli/bench/cells.hpp"
#include "cli/bench/memory.hpp"
#include "cli/guard.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace {

const char *sizes, *instances, *methods; /* null: as of the orbit, or of the path */
constexpr const char *ORBIT_SIZES = "100x100,200x200,400x400,640x480,800x600,1024x768,1280x1024";
constexpr const char *ORBIT_METHODS = "mesh,simplified,paper,cast,lod,auto";
constexpr const char *PATH_SIZE = "1280x720", *PATH_METHODS = "mesh,simplified,floor,cast,auto";
constexpr const char *COMPRESS_SIZES = "100x100,640x480";
constexpr const char *CELL_METHODS = "paper,cast,cast_fragment";
const char *path_file;
uint32_t frames, random_count, seed = 1, repeats = 3;
double max_error = 0.5, min_iou, budget = 600;
bool truth, as_json, count_cells, compress, vulkan;

const option options[] = {
    {"sizes", 0, OPTION_STRING, &sizes, "WxH,...",
     "windows [100x100,200x200,400x400,640x480,800x600,1024x768,1280x1024; a path's: 1280x720]", 0,
     0},
    {"instances", 0, OPTION_STRING, &instances, "N,...",
     "instances in view, in one draw call [1]", 0, 0},
    {"methods", 0, OPTION_STRING, &methods, "NAME,...",
     "mesh mesh_stream simplified paper cast lod auto cast_depth auto_depth cast_fragment "
     "grid grid_depth floor cast_own lod_own auto_own grid_own "
     "[mesh,simplified,paper,cast,lod,auto; a path's: "
     "mesh,simplified,floor,cast,auto]", 0, 0},
    {"frames", 0, OPTION_UINT, &frames, "N",
     "frames per method [12]; views along a path [one per key]", 1, 10000},
    {"path", 0, OPTION_STRING, &path_file, "FILE",
     "move the camera along a path: per line a key, x y z x y z, eye and target in the model's "
     "coordinates; before them optionally 'up x y z' [0 1 0] and 'fov DEGREES' [45]", 0, 0},
    {"random", 0, OPTION_UINT, &random_count, "N",
     "a path of N random views: outside, just above the surface, in the bounding box", 1, 10000},
    {"seed", 0, OPTION_UINT, &seed, "S", "seed of the random views [1]", 0, 4294967295.},
    {"repeats", 0, OPTION_UINT, &repeats, "N",
     "frames per view of a path, of which the fastest counts [3]", 1, 1000},
    {"max-error", 0, OPTION_NUMBER, &max_error, "PIXELS",
     "largest error on screen of a level of detail [0.5]", 1e-6, 1e6},
    {"min-iou", 0, OPTION_NUMBER, &min_iou, "SHARE",
     "per window, the largest --max-error of 0.25 to 4 pixels whose silhouette IoU with the mesh "
     "is at least SHARE [0: --max-error as given]", 0, 1},
    {"truth", 0, OPTION_FLAG, &truth, nullptr,
     "also compare pictures with the mesh's at 8x8 samples per pixel", 0, 0},
    {"budget", 0, OPTION_NUMBER, &budget, "SECONDS", "skip what would exceed this time [600]", 0,
     1e9},
    {"cells", 0, OPTION_FLAG, &count_cells, nullptr,
     "instead of times: how many cells rays visit with paper, cast and cast_fragment", 0, 0},
    {"compress", 0, OPTION_FLAG, &compress, nullptr,
     "instead of times: the asset's GPU memory, uncompressed and with each block compression that "
     "the driver supports, and the loss of quality; sizes [100x100,640x480]", 0, 0},
    {"vulkan", 0, OPTION_FLAG, &vulkan, nullptr,
     "also draw with Vulkan, in the same run: paper, cast, lod, auto, cast_fragment, grid",
     0, 0},
    {"json", 0, OPTION_FLAG, &as_json, nullptr, "print the whole report as JSON", 0, 0},
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

const verb bench = {
    "bench", "ASSET MODEL",
    "Times an asset against the mesh it was cooked from. The mesh is drawn with back faces culled\n"
    "(mesh), uploaded anew each frame (mesh_stream), or simplified until it looks as good as auto\n"
    "(simplified); the asset by each method.\n"
    "Along a path, parts of the mesh that are out of view are not drawn, and an open mesh is\n"
    "drawn from both sides, as the asset is. simplified is then the coarsest mesh with an error\n"
    "of at most --max-error at the nearest vertex in view, chosen before the clock starts. floor\n"
    "is the cost of shading alone: flat rectangles over the pixels that auto covers, each shaded\n"
    "once as LOD meshes are. Displaced grids that are lit at their vertices may take less.\n"
    "The worst views are printed as a path. holes are pixels that the mesh covers and the asset\n"
    "does not; enclosed are those of them that are not a shift of the outline; outline is the\n"
    "distance of the outlines in pixels.\n"
    "With --truth, truth is the PSNR to the mesh at 8x8 samples per pixel, averaged in linear\n"
    "light, where either covers; inside is the same where all samples cover; outline is the share\n"
    "of the squared error elsewhere.",
    2, 2, options, DRAWING_LIMITS};

bool usage(const char *what, const std::string &word)
{
    print_message("gtx bench: error[usage]: --%s: invalid value '%s'", what, word.c_str());
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

bool clash(const char *one, const char *other)
{
    print_message("gtx bench: error[usage]: --%s is not for --%s", one, other);
    return false;
}

/* A path stands alone, and has one instance at the error asked for. */
bool choices_agree()
{
    const char *along = path_file ? "path" : "random";
    if (compress && (as_json || instances || vulkan || count_cells || path_file || random_count))
        return clash("compress", "others than --sizes and --max-error");
    if (count_cells && (as_json || instances || vulkan))
        return clash(as_json ? "json" : instances ? "instances" : "vulkan", "cells");
    if (path_file && random_count)
        return clash("random", "path");
    if (!path_file && !random_count)
        return true;
    return instances     ? clash("instances", along)
           : vulkan      ? clash("vulkan", along)
           : min_iou > 0 ? clash("min-iou", along)
                         : true;
}

bool parse_lists(gtx::BenchOptions &out)
{
    const bool along = path_file || random_count;
    for (const std::string &word : split(sizes      ? sizes
                                         : compress ? COMPRESS_SIZES
                                         : along    ? PATH_SIZE
                                                    : ORBIT_SIZES)) {
        std::array<uint32_t, 2> size;
        const size_t x = word.find('x');
        if (x == std::string::npos || !parse_number(word.substr(0, x), 1, 8192, size[0]) ||
            !parse_number(word.substr(x + 1), 1, 8192, size[1]))
            return usage("sizes", word);
        out.sizes.push_back(size);
    }
    for (const std::string &word : split(instances ? instances : "1")) {
        uint32_t count;
        if (!parse_number(word, 1, 100000, count))
            return usage("instances", word);
        out.instances.push_back(count);
    }
    std::sort(out.instances.begin(), out.instances.end());
    const char *usual = count_cells ? CELL_METHODS : along ? PATH_METHODS : ORBIT_METHODS;
    for (const std::string &word : split(methods ? methods : usual)) {
        const char *const *names = gtx::bench_method_names;
        const char *const *end = names + uint32_t(gtx::BenchMethod::PAPER_VULKAN);
        const char *const *name = std::find(names, end, word);
        if (name == end)
            return usage("methods", word);
        const bool orbits = word == "mesh_stream", follows = word == "floor";
        if (along ? orbits : follows)
            return usage(along ? "methods of a path" : "methods of the orbit", word);
        out.methods.push_back(gtx::BenchMethod(name - names));
        if (count_cells && !gtx::casts_alone(out.methods.back()))
            return usage("methods of cells", word);
        const gtx::BenchMethod other = gtx::with_vulkan(out.methods.back());
        if (vulkan && other != gtx::BenchMethod::MESH)
            out.methods.push_back(other);
    }
    return true;
}

/* What was measured: rows of the orbit, or paths. */
struct Report {
    gtx::BenchSetup setup;
    gtx::Vector<gtx::BenchRow> rows;
    gtx::Vector<gtx::PathReport> paths;
};

int tell_json(const char *scene, const Report &report)
{
    gtx_json json = {};
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "scene", scene);
    gtx_json_integer(&json, "triangles", report.setup.triangles);
    gtx_json_integer(&json, "gpu_geometry_bytes", report.setup.geometry_bytes);
    gtx_json_number(&json, "open_ms", report.setup.open);
    gtx_json_number(&json, "prepare_ms", report.setup.prepare);
    gtx_json_number(&json, "upload_ms", report.setup.upload);
    for (bool skipped : {false, true}) {
        gtx_json_begin_array(&json, skipped ? "skipped" : "rows");
        for (const gtx::BenchRow &row : report.rows)
            if (skipped == (row.skipped != nullptr))
                gtx::write_bench_row(json, report.setup, row);
        gtx_json_end_array(&json);
    }
    if (!report.paths.empty()) {
        gtx_json_string(&json, "platform", report.setup.renderer.c_str());
        gtx_json_begin_array(&json, "paths");
        for (const gtx::PathReport &path : report.paths)
            write_path_report(json, path);
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
                "%s%s%s, milliseconds; error: pixels, of a level\n", line.c_str(),
                setup.triangles, double(setup.geometry_bytes) / std::max(1u, setup.triangles),
                setup.open, setup.prepare, setup.upload,
                setup.open + setup.prepare + setup.upload, setup.renderer.c_str(),
                setup.device.empty() ? "" : "; Vulkan: ", setup.device.c_str());
}

void run_orbit(const char *scene, const char *asset, const gtx::Mesh &mesh,
               const gtx::BenchOptions &wanted, Report &report)
{
    double of_mesh = 0;
    gtx::Vector<gtx::BenchRow> &rows = report.rows;
    gtx::run_bench(
        asset, mesh, wanted,
        [&](const gtx::BenchSetup &setup) {
            report.setup = setup;
            if (!as_json) {
                print_head(scene, setup);
                gtx::print_bench_head(truth);
            }
        },
        [&](const gtx::BenchRow &row) {
            if (rows.empty() || rows.back().size != row.size ||
                rows.back().instances != row.instances)
                of_mesh = 0;
            rows.push_back(row);
            if (row.method == gtx::BenchMethod::MESH)
                of_mesh = row.median;
            if (!as_json)
                gtx::print_bench_row(row, of_mesh);
        });
}

void run_along(const char *scene, const char *asset, const gtx::Mesh &mesh,
               const gtx::ViewPath &path, const gtx::BenchOptions &wanted, Report &report)
{
    gtx::run_path(
        asset, mesh, path, wanted,
        [&](const gtx::BenchSetup &setup) {
            report.setup = setup;
            if (!as_json)
                print_head(scene, setup);
        },
        [&](const gtx::PathReport &measured) {
            report.paths.push_back(measured);
            if (!as_json)
                print_path_report(measured);
        });
}

} // namespace

int cmd_bench(int argc, char **argv)
{
    const char *files[2];
    int count;
    int code = parse_options(&bench, argc, argv, files, &count);
    if (code >= 0)
        return code;
    return gtx::guarded(path_file ? path_file : files[1], [&](std::string &current) {
        gtx::BenchOptions wanted;
        wanted.frames = frames ? frames : wanted.frames;
        wanted.max_error = max_error;
        wanted.min_iou = min_iou;
        wanted.budget = budget;
        wanted.repeats = repeats;
        wanted.truth = truth;
        wanted.along_path = path_file || random_count;
        if (!choices_agree() || !parse_lists(wanted))
            return int(EXIT_CODE_USAGE);
        gtx::Task task(0, nullptr, nullptr, {}, {}, cli_limits);
        gtx::ViewPath path;
        if (path_file)
            path = gtx::read_path(path_file, frames, task);
        current = files[1];
        gtx::CleanReport cleaned;
        gtx::Mesh mesh;
        if (!compress && (!count_cells || random_count))
            mesh = gtx::clean_mesh(gtx::import_mesh(files[1], task), task, cleaned);
        gtx::report_warnings(files[1], task.warnings);
        if (random_count)
            path = gtx::random_path(mesh, random_count, seed);
        current = files[0];
        if (count_cells) {
            gtx::print_cells_head(files[0]);
            gtx::run_cells(files[0], wanted.along_path ? &path : nullptr, wanted,
                           gtx::print_cells);
            return int(EXIT_CODE_OK);
        }
        if (compress) {
            gtx::print_memory_head(files[0], wanted);
            gtx::run_memory(files[0], wanted, gtx::print_memory);
            return int(EXIT_CODE_OK);
        }
        Report report;
        if (wanted.along_path)
            run_along(files[1], files[0], mesh, path, wanted, report);
        else
            run_orbit(files[1], files[0], mesh, wanted, report);
        return as_json ? tell_json(files[1], report) : int(EXIT_CODE_OK);
    });
}
