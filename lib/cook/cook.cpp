/* The line from a model file to an asset file (paper, section 5), behind the C API. */
#include "cook/guard.hpp"
#include "cook/report.hpp"

#include "base/hash.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace gtx {

/* Steps in their order, and their shares of the time as measured on scans of 10^5 triangles and
 * more. The file is written last, so that a cook that is cancelled or fails leaves nothing. */
struct Stage {
    const char *name;
    float weight;
};
constexpr Stage STAGES[] = {{"import", 6}, {"clean", 14}, {"partition", 40}, {"frame", 10},
                            {"bake", 22},  {"pack", 2},   {"measure", 0},    {"write", 6}};
constexpr float MEASURE_WEIGHT = 60;

constexpr uint32_t MOST_CHARTS = 1u << 20, MOST_THREADS = 1024, MOST_DILATION = 128;
#ifdef GTX_ZSTD
constexpr int DEFAULT_ZSTD = 3;
#else
constexpr int DEFAULT_ZSTD = 0;
#endif

/* A descriptor with its defaults filled in. */
struct Options {
    ChartOptions chart;
    BakeOptions bake;
    int zstd = 0;
    float unit = 1;
};

/* A C caller can store any number in an enum, which C++ may not even read as one. */
static unsigned partition_number(const gtx_cook_desc &desc)
{
    std::underlying_type_t<gtx_partition> number;
    static_assert(sizeof number == sizeof desc.partition);
    std::memcpy(&number, &desc.partition, sizeof number);
    return unsigned(number);
}

static void check(const gtx_cook_desc &desc)
{
    require_zeroed(desc.reserved);
    require_argument(partition_number(desc) <= GTX_PARTITION_VSA, "unknown partition");
    require_argument(desc.charts <= MOST_CHARTS, "charts is at most 2^20");
    require_argument(!desc.resolution || (desc.resolution >= 64 && desc.resolution <= 512),
                     "resolution is 64 to 512");
    require_argument(!desc.height_bits || desc.height_bits == 8 || desc.height_bits == 16,
                     "height_bits is 8 or 16");
    require_argument(desc.dilation <= MOST_DILATION, "dilation is at most 128");
    require_argument(desc.mips <= 8, "mips is 1 to 8");
    require_argument(desc.zstd_level >= -1 && desc.zstd_level <= 19, "zstd_level is -1 to 19");
    require_argument(desc.threads <= MOST_THREADS, "threads is at most 1024");
    require_argument(desc.unit >= 0 && std::isfinite(desc.unit), "unit is a positive number");
    require_argument(desc.measure <= 1, "measure is 0 or 1");
}

static Options options_of(const gtx_cook_desc &desc)
{
    Options options;
    options.chart.charts = desc.charts;
    if (desc.resolution)
        options.chart.resolution = desc.resolution;
    if (desc.height_bits)
        options.bake.height_bits = desc.height_bits;
    if (desc.mips)
        options.bake.mips = desc.mips;
    options.bake.dilation = desc.dilation ? desc.dilation : 1u << (options.bake.mips - 1);
    options.zstd = desc.zstd_level == 0 ? DEFAULT_ZSTD : std::max(desc.zstd_level, 0);
    options.unit = desc.unit > 0 ? desc.unit : 1;
    return options;
}

static Task make_task(const gtx_cook_desc &desc)
{
    std::vector<const char *> names;
    std::vector<float> weights;
    for (const Stage &stage : STAGES) {
        names.push_back(stage.name);
        weights.push_back(stage.weight);
        if (!std::strcmp(stage.name, "measure") && desc.measure)
            weights.back() = MEASURE_WEIGHT;
    }
    return Task(desc.threads, desc.progress, desc.progress_user, names, weights);
}

/* One hash over all files that were read, in their order. */
static uint64_t hash_files(const std::vector<std::string> &paths)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    std::vector<char> block(1 << 18);
    for (const std::string &path : paths) {
        std::unique_ptr<FILE, int (*)(FILE *)> file(fopen(path.c_str(), "rb"), fclose);
        if (!file)
            throw Error(GTX_ERROR_READ, "cannot read " + path);
        while (size_t size = fread(block.data(), 1, block.size(), file.get()))
            gtx_hash_add(&hash, block.data(), size);
        if (ferror(file.get()))
            throw Error(GTX_ERROR_READ, "cannot read " + path);
    }
    return gtx_hash_end(&hash);
}

using Asset = std::unique_ptr<gtx_asset, decltype(&gtx_close)>;

static Asset make_asset(const Maps &maps, const Options &options, const CookFacts &facts,
                        uint64_t source_hash)
{
    Json meta;
    write_meta({"vsa", facts.chart_count, options.chart.resolution, maps.height_bits,
                maps.mip_count, options.bake.dilation, facts.source_triangles, source_hash},
               meta);
    std::vector<const uint8_t *> normal, color;
    for (const auto &level : maps.normal)
        normal.push_back(level.data());
    for (const auto &level : maps.color)
        color.push_back(level.data());

    gtx_asset_desc desc = {};
    desc.patches = maps.patches.data();
    desc.patch_count = uint32_t(maps.patches.size());
    desc.page_count = maps.page_count;
    desc.page_width = maps.page_width;
    desc.page_height = maps.page_height;
    desc.mip_count = maps.mip_count;
    desc.height_bits = maps.height_bits;
    desc.height = maps.height.data();
    desc.trim = maps.trim.data();
    desc.normal = normal.data();
    desc.color = color.empty() ? nullptr : color.data();
    desc.meta = meta.text;
    desc.meta_size = meta.size;
    std::copy_n(maps.bounds_min, 3, desc.bounds_min);
    std::copy_n(maps.bounds_max, 3, desc.bounds_max);
    std::copy_n(maps.anchor, 3, desc.anchor);
    desc.unit = options.unit;
    desc.source_triangles = facts.source_triangles;

    gtx_asset *asset = nullptr;
    gtx_error error;
    gtx_result result = gtx_create(&desc, &asset, &error);
    if (result == GTX_ERROR_CORRUPT) /* what is baked must be valid, whatever the model */
        throw Error(GTX_ERROR_INTERNAL, error.message);
    require_ok(result, error);
    return Asset(asset, gtx_close);
}

static void save(const gtx_asset *asset, const char *output, const Options &options)
{
    gtx_encode_desc desc = {};
    desc.zstd_level = options.zstd;
    gtx_error error;
    require_ok(gtx_save_file(asset, output, &desc, &error), error);
}

static void refuse_overwriting_source(const std::vector<std::string> &sources, const char *output)
{
    for (const std::string &source : sources) {
        std::error_code ignored; /* an output that does not exist is no source */
        require_argument(!std::filesystem::equivalent(source, output, ignored),
                         "the output is one of the files that the model is read from");
    }
}

/* Everything from the clean mesh on; fills the rest of `facts`. */
static Asset cook_mesh(const Mesh &mesh, const gtx_cook_desc &desc, const Options &options,
                       uint64_t source_hash, Task &task, CookFacts &facts)
{
    Partition partition = partition_vsa(mesh, options.chart, task);
    facts.charts = partition.report;
    facts.chart_count = partition.charts.size();
    Asset asset(nullptr, gtx_close);
    {
        Maps maps = bake(mesh, partition, options.bake, task);
        facts.bake = maps.report;
        asset = make_asset(maps, options, facts, source_hash);
    }
    if (desc.measure) {
        task.begin("measure");
        facts.error = surface_error(asset.get(), mesh, partition.junk, task);
        facts.measured = true;
    }
    task.begin("write");
    if (desc.charts_ply)
        write_charts_ply(desc.charts_ply, mesh, partition);
    return asset;
}

static void cook_file(const char *input, const char *output, const gtx_cook_desc &desc,
                      gtx_report *report)
{
    require_argument(input && output, "gtx_cook_file needs an input and an output path");
    check(desc);
    auto start = std::chrono::steady_clock::now();
    Options options = options_of(desc);
    Task task = make_task(desc);
    CookFacts facts;

    std::vector<std::string> sources;
    task.begin("import");
    Mesh mesh = import_mesh(input, task, &sources);
    refuse_overwriting_source(sources, output);
    uint64_t source_hash = hash_files(sources);
    facts.source_triangles = mesh.triangle_count();
    facts.source_vertices = mesh.positions.size();
    task.begin("clean");
    mesh = clean_mesh(std::move(mesh), task, facts.clean);
    Asset asset = cook_mesh(mesh, desc, options, source_hash, task, facts);
    save(asset.get(), output, options);

    task.end();
    if (!report)
        return;
    gtx_info info;
    gtx_get_info(asset.get(), &info);
    facts.content_hash = info.content_hash;
    facts.gpu_bytes = gpu_bytes(info);
    facts.bytes = std::filesystem::file_size(output);
    facts.stages = task.stages();
    facts.seconds = task.seconds();
    facts.total_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    Json json;
    std::string summary = write_cook_report(facts, task.warnings, json);
    fill_report(report, json, summary, sources, task.warnings);
}

} // namespace gtx

gtx_result gtx_cook_file(const char *input, const char *output, const gtx_cook_desc *desc,
                         gtx_report *report, gtx_error *error)
{
    return gtx::guard(
        error, [&] { gtx::cook_file(input, output, desc ? *desc : gtx_cook_desc{}, report); });
}
