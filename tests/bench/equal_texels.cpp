/* Assets of equal texels: resolutions are searched, then the assets measured. */
#include "equal_texels.hpp"

#include <geotex/geotex.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include <nlohmann/json.hpp>

namespace {

/* What a density may be searched in, and when it is found. */
constexpr uint32_t MIN_RESOLUTION = 64, MAX_RESOLUTION = 512;
constexpr double CLOSE = 0.01;
constexpr int ROUNDS = 5;

/* By gtx_partition. */
constexpr const char *NAMES[] = {nullptr, "cuts", "vsa", "pgp", "layers", "relief"};

/* A file's name, up to its first dot. */
std::string stem(const std::string &path)
{
    const std::string name = path.substr(path.find_last_of('/') + 1);
    return name.substr(0, name.find('.'));
}

void require(gtx_result result, const gtx_error &error)
{
    if (!result)
        return;
    std::fprintf(stderr, "paper_tables: %s\n", error.message);
    std::exit(3);
}

AssetFigures figures_of(const std::string &path)
{
    gtx_asset *asset = nullptr;
    gtx_error error;
    require(gtx_open_file(path.c_str(), nullptr, &asset, &error), error);
    gtx_info info;
    gtx_get_info(asset, &info);
    AssetFigures out;
    out.patches = info.patch_count;
    double diagonal = 0, used = 0;
    for (int i = 0; i < 3; ++i)
        diagonal += std::pow(double(info.bounds_max[i]) - double(info.bounds_min[i]), 2);
    for (uint32_t i = 0; i < info.patch_count; ++i) {
        const gtx_patch &patch = gtx_patches(asset)[i];
        const double texels = double(patch.rect[2]) * patch.rect[3];
        out.texels += uint64_t(texels);
        used += texels * double(patch.coverage);
        out.grid_triangles += 2 * uint64_t(patch.rect[2] - 1) * uint64_t(patch.rect[3] - 1);
        out.range += texels * double(patch.coverage) * double(patch.extent_z);
    }
    out.range /= used * std::sqrt(diagonal);
    out.empty = out.texels - std::min(out.texels, uint64_t(std::llround(used)));
    gtx_close(asset);
    return out;
}

AssetFigures cook(const std::string &model, gtx_partition partition, unsigned charts,
                  uint32_t resolution, const std::string &path)
{
    gtx_cook_desc desc = {};
    desc.partition = partition;
    desc.charts = charts;
    desc.resolution = resolution;
    desc.measure = partition == GTX_PARTITION_RELIEF;
    gtx_error error;
    gtx_report report = {};
    const std::clock_t start = std::clock();
    require(gtx_cook_file(model.c_str(), path.c_str(), &desc, &report, &error), error);
    AssetFigures out = figures_of(path);
    out.seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    const nlohmann::json said = nlohmann::json::parse(report.json);
    gtx_report_free(&report);
    out.bytes = said["bytes"];
    out.lost = said["suitability"]["unseen_fraction"];
    if (desc.measure)
        out.rms = said["error"]["forward"]["rms"];
    return out;
}

/* Leaves the asset that comes nearest to `texels`. */
AssetFigures cook_to_texels(const std::string &model, gtx_partition partition, unsigned charts,
                            double texels, const std::string &path)
{
    uint32_t resolution = 128, best = 0, last = 0;
    double nearest = INFINITY;
    AssetFigures out;
    for (int round = 0; round < ROUNDS && resolution != last && nearest > CLOSE; ++round) {
        last = resolution;
        out = cook(model, partition, charts, resolution, path);
        const double off = std::fabs(std::log(double(out.texels) / texels));
        if (off < nearest) {
            nearest = off;
            best = resolution;
        }
        const double next = resolution * std::sqrt(texels / double(out.texels));
        resolution = std::clamp(uint32_t(std::lround(next)), MIN_RESOLUTION, MAX_RESOLUTION);
    }
    return best == last ? out : cook(model, partition, charts, best, path);
}

} // namespace

std::vector<AssetFigures> equal_texels(const std::string &model, unsigned charts,
                                       const std::vector<gtx_partition> &partitions,
                                       const std::string &folder)
{
    std::vector<AssetFigures> out;
    for (gtx_partition partition : partitions) {
        const std::string path = folder + "/" + stem(model) + "_" + NAMES[partition] + ".gtx";
        AssetFigures figures = out.empty() ? cook(model, partition, charts, 128, path)
                                           : cook_to_texels(model, partition, charts,
                                                            double(out[0].texels), path);
        if (partition == GTX_PARTITION_RELIEF) { /* full of holes, each of which takes long */
            out.push_back(figures);
            continue;
        }
        gtx_compare_desc desc = {};
        desc.levels = 1;
        gtx_compare_result result = {};
        gtx_error error;
        require(gtx_compare_files(path.c_str(), model.c_str(), &desc, &result, nullptr, &error),
                error);
        figures.rms = result.forward_rms;
        figures.holes = result.hole_pixels;
        figures.pixels = result.surface_pixels;
        out.push_back(figures);
    }
    return out;
}
