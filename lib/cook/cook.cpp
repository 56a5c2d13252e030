/* The line from a model file to an asset file (paper, section 5), behind the C API. */
#include "cook/guard.hpp"
#include "cook/models.hpp"
#include "cook/options.hpp"
#include "cook/report.hpp"

#include "bake/shell.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
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
                            {"bake", 22},  {"pack", 2},   {"shell", 8},      {"measure", 0},
                            {"write", 6}};
constexpr float MEASURE_WEIGHT = 60;

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

using Asset = std::unique_ptr<gtx_asset, decltype(&gtx_close)>;

static std::vector<const uint8_t *> level_pointers(const std::vector<std::vector<uint8_t>> &levels)
{
    std::vector<const uint8_t *> pointers;
    for (const auto &level : levels)
        pointers.push_back(level.data());
    return pointers;
}

static std::vector<gtx_shell> shell_levels(const std::vector<ShellLevel> &shell)
{
    std::vector<gtx_shell> levels;
    for (const ShellLevel &level : shell) {
        gtx_shell out = {};
        std::copy_n(level.origin, 3, out.origin);
        out.step = level.step;
        out.error = level.error;
        out.vertex_count = uint32_t(level.positions.size() / 3);
        out.triangle_count = uint32_t(level.triangle_count());
        out.first = level.first.data();
        out.indices = level.indices.data();
        out.positions = level.positions.data();
        levels.push_back(out);
    }
    return levels;
}

static Asset make_asset(const Maps &maps, const std::vector<ShellLevel> &shell,
                        const Options &options, const CookFacts &facts)
{
    Json meta;
    write_meta({"vsa", facts.chart_count, options.chart.resolution, maps.height_bits,
                maps.mip_count, options.bake.dilation, options.shell_levels, options.z_up,
                facts.source_triangles, facts.source_hash, facts.key, facts.warnings},
               meta);
    const std::vector<const uint8_t *> normal = level_pointers(maps.normal),
                                       color = level_pointers(maps.color),
                                       material = level_pointers(maps.material),
                                       emission = level_pointers(maps.emission);
    const std::vector<gtx_shell> levels = shell_levels(shell);

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
    desc.material = material.empty() ? nullptr : material.data();
    desc.emission = emission.empty() ? nullptr : emission.data();
    desc.emission_scale = maps.emission_scale;
    desc.shell = levels.data();
    desc.shell_levels = uint32_t(levels.size());
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

static void refuse_warnings(const gtx_cook_desc &desc, const Task &task)
{
    size_t count = task.warnings.size();
    if (desc.strict && count)
        throw Error(GTX_ERROR_INPUT, task.warnings.front() +
                                         (count > 1 ? " (and " + std::to_string(count - 1) +
                                                          " more warnings)"
                                                    : ""));
}

/* The asset at `path` when cooking would only make it again. */
static Asset find_cooked(const char *path, const gtx_cook_desc &desc, uint64_t key)
{
    gtx_asset *asset = nullptr;
    if (!desc.if_changed || desc.charts_ply || gtx_open_file(path, nullptr, &asset, nullptr))
        return Asset(nullptr, gtx_close);
    Asset owner(asset, gtx_close);
    uint64_t old_key, warnings;
    bool same = read_meta(asset, old_key, warnings) && old_key == key;
    if (!same || (desc.strict && warnings))
        owner.reset();
    return owner;
}

/* Everything from the clean mesh on; fills the rest of `facts`. */
static Asset cook_mesh(const Mesh &mesh, const gtx_cook_desc &desc, const Options &options,
                       Task &task, CookFacts &facts)
{
    Partition partition = partition_vsa(mesh, options.chart, task);
    facts.charts = partition.report;
    facts.chart_count = partition.charts.size();
    Asset asset(nullptr, gtx_close);
    {
        Maps maps = bake(mesh, partition, options.bake, task);
        std::vector<ShellLevel> shell =
            make_shell(shell_source(mesh, partition, maps), maps, options.shell_levels, task);
        refuse_warnings(desc, task);
        facts.bake = maps.report;
        facts.warnings = task.warnings.size();
        asset = make_asset(maps, shell, options, facts);
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

static uint64_t encoded_size(const gtx_asset *asset, const Options &options)
{
    gtx_encode_desc desc = {};
    desc.zstd_level = options.zstd;
    gtx_error error;
    void *data;
    size_t size;
    require_ok(gtx_encode(asset, &desc, &data, &size, &error), error);
    free(data);
    return size;
}

/* Everything from the models on; fills `facts`. */
static Asset cook_models(Models &models, const gtx_cook_desc &desc, const Options &options,
                         Task &task, CookFacts &facts)
{
    Mesh mesh = import_models(models, options.z_up, task);
    facts.source_triangles = mesh.triangle_count();
    facts.source_vertices = mesh.positions.size();
    if (!models.foreseen)
        facts.key = 0; /* nobody's: it would not cover all, so this asset is always cooked again */
    task.begin("clean");
    mesh = clean_mesh(std::move(mesh), task, facts.clean);
    refuse_warnings(desc, task);
    return cook_mesh(mesh, desc, options, task, facts);
}

static void report_on(const gtx_asset *asset, CookFacts &facts, bool unchanged,
                      const std::vector<std::string> &sources, const Task &task, gtx_report *report)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    facts.source_triangles = info.source_triangles;
    facts.chart_count = info.patch_count;
    facts.content_hash = info.content_hash;
    facts.gpu_bytes = gpu_bytes(info);
    facts.shell.resize(info.shell_levels);
    for (uint32_t k = 0; k < info.shell_levels; ++k)
        gtx_get_shell(asset, k, &facts.shell[k]);
    facts.stages = task.stages();
    facts.seconds = task.seconds();
    Json json;
    std::string summary = unchanged ? write_unchanged_report(facts, json)
                                    : write_cook_report(facts, task.warnings, json);
    fill_report(report, json, summary, sources, task.warnings);
    report->unchanged = unchanged;
}

/* The whole line. Without an output the asset is only returned. */
static Asset cook(const ModelInput &input, const char *output, const gtx_cook_desc &desc,
                  gtx_report *report)
{
    check(desc);
    auto start = std::chrono::steady_clock::now();
    Options options = options_of(desc);
    Task task = make_task(desc);
    CookFacts facts;

    task.begin("import");
    Models models = read_models(input, desc.more, desc.more_count, task);
    facts.source_hash = models.hash;
    facts.key = content_key(options, models.hash);
    Asset asset(nullptr, gtx_close);
    if (output) {
        refuse_overwriting_source(models.sources, output);
        asset = find_cooked(output, desc, facts.key);
    }
    const bool unchanged = asset != nullptr;
    if (!unchanged)
        asset = cook_models(models, desc, options, task, facts);
    if (!unchanged && output)
        save(asset.get(), output, options);
    task.end();
    if (report) {
        facts.bytes = output ? std::filesystem::file_size(output)
                             : encoded_size(asset.get(), options);
        facts.total_seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        report_on(asset.get(), facts, unchanged, models.sources, task, report);
    }
    return asset;
}

} // namespace gtx

gtx_result gtx_cook_file(const char *input, const char *output, const gtx_cook_desc *desc,
                         gtx_report *report, gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(input && output, "gtx_cook_file needs an input and an output path");
        gtx::cook({input}, output, desc ? *desc : gtx_cook_desc{}, report);
    });
}

gtx_result gtx_cook_memory(const void *data, size_t size, const char *name,
                           const gtx_cook_desc *desc, gtx_asset **out, gtx_report *report,
                           gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(data && name && out,
                              "gtx_cook_memory needs bytes, a name and a result");
        *out = gtx::cook({name, data, size}, nullptr, desc ? *desc : gtx_cook_desc{}, report)
                   .release();
    });
}
