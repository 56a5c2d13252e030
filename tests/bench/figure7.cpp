/* Figure 7: 453 patches of 128, 256 and 512 texels a side against the source mesh, in buffers and
 * sent anew each frame, over the ray-cast area. "paper" is the search of the paper on boxes.
 *
 *   figure7 OUT_FOLDER MODEL [BUDGET_SECONDS] */
#include "bench/figure.hpp"

#include "cli/bench/bench.hpp"

#include <geotex/cook.h>

#include <cstdio>
#include <cstdlib>

using namespace gtx;

constexpr uint32_t PATCHES = 453; /* of the paper's dragon */

/* The rows of one asset, its side beside what it draws; the mesh's come from the first alone. */
static void measure(const std::string &folder, const char *model, const Mesh &mesh,
                    uint32_t resolution, double budget, std::vector<FigureRow> &rows,
                    std::string &platform)
{
    const std::string side = std::to_string(resolution);
    const std::string path = folder + "/figure7_" + side + ".gtx";
    gtx_cook_desc desc = {};
    desc.charts = PATCHES;
    desc.resolution = resolution;
    gtx_error error;
    if (gtx_cook_file(model, path.c_str(), &desc, nullptr, &error) != GTX_OK)
        throw Error(error.result, error.message);
    BenchOptions options;
    options.sizes = {{100, 100}, {200, 200},  {400, 400},  {640, 480},
                     {800, 600}, {1024, 768}, {1280, 1024}};
    options.instances = {1};
    options.methods = {BenchMethod::PAPER, BenchMethod::CAST};
    if (rows.empty())
        options.methods = {BenchMethod::MESH, BenchMethod::MESH_STREAM, BenchMethod::PAPER,
                           BenchMethod::CAST};
    options.frames = 8;
    options.budget = budget;
    run_bench(path, mesh, options, [&](const BenchSetup &setup) { platform = setup.renderer; },
              [&](const BenchRow &row) {
                  std::string name = bench_method_names[uint32_t(row.method)];
                  if (row.method >= BenchMethod::PAPER)
                      name += " " + side;
                  if (row.skipped)
                      return;
                  rows.push_back({"model", name,
                                  std::to_string(row.size[0]) + "x" + std::to_string(row.size[1]),
                                  row.pixels, int(row.frames), row.median, row.least});
                  print_row(rows.back(), rows.size() == 1);
              });
    std::remove(path.c_str());
}

int main(int argc, char **argv)
{
    const double budget = argc == 4 ? std::atof(argv[3]) : 120;
    if (argc < 3 || argc > 4 || !(budget > 0)) {
        std::fprintf(stderr, "figure7 OUT_FOLDER MODEL [BUDGET_SECONDS]\n");
        return 1;
    }
    std::vector<FigureRow> rows;
    std::string platform;
    try {
        Task task(0, nullptr, nullptr);
        CleanReport report;
        const Mesh mesh = clean_mesh(import_mesh(argv[2], task), task, report);
        std::printf("Figure 7: %zu triangles, %u patches\n", mesh.triangle_count(), PATCHES);
        for (uint32_t resolution : {128, 256, 512})
            measure(argv[1], argv[2], mesh, resolution, budget, rows, platform);
    } catch (const Error &e) {
        std::fprintf(stderr, "figure7: error: %s\n", e.what());
        return 1;
    }
    if (!write_figure(argv[1], "figure7", "Figure 7: maps of three sizes against the mesh",
                      platform, rows)) {
        std::fprintf(stderr, "figure7: error: %s cannot be written\n", argv[1]);
        return 1;
    }
    return 0;
}
