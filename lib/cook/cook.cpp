/* The line from a model file to an asset file (paper, section 5), behind the C API. */
#include "cook/assemble.hpp"
#include "cook/guard.hpp"
#include "cook/models.hpp"
#include "cook/options.hpp"
#include "cook/report.hpp"
#include "cook/target.hpp"

#include "asset/asset.h"
#include "bake/lod/lod.hpp"
#include "base/alloc.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <memory>

namespace gtx {

/* Steps in their order, and their shares of the time as measured on scans of 10^5 triangles and
 * more. The file is written last, so that a cook that is cancelled or fails leaves nothing. */
struct Stage {
    const char *name;
    float weight;
};
constexpr Stage STAGES[] = {{"import", 6}, {"clean", 14}, {"partition", 40}, {"frame", 10},
                            {"bake", 22},  {"pack", 2},   {"lod", 0},      {"measure", 0},
                            {"write", 6}};
constexpr float LOD_WEIGHT = 18, MEASURE_WEIGHT = 60;

static Task make_task(const gtx_cook_desc &desc)
{
    std::vector<const char *> names;
    std::vector<float> weights;
    for (const Stage &stage : STAGES) {
        names.push_back(stage.name);
        weights.push_back(stage.weight);
        if (!std::strcmp(stage.name, "measure") && (desc.measure || desc.error > 0))
            weights.back() = MEASURE_WEIGHT;
        if (!std::strcmp(stage.name, "lod") && desc.lod_levels)
            weights.back() = LOD_WEIGHT;
    }
    return Task(desc.threads, desc.progress, desc.progress_user, names, weights);
}

static Asset make_asset(const Maps &maps, const std::vector<LodLevel> &lod,
                        const Options &options, const CookFacts &facts)
{
    Json meta(options.allocator);
    write_meta({partition_name(options), facts.chart_count, options.chart.resolution,
                maps.height_bits, maps.mip_count, options.bake.dilation, options.lod_levels,
                options.z_up, options.bake.extractor != nullptr, options.chart.adaptive,
                facts.source_triangles, facts.source_hash, facts.key, facts.warnings},
               meta);
    return assemble(maps, lod, {std::string(meta.text, meta.size), options.unit,
                                facts.source_triangles, options.allocator});
}

/* Jobs of the C rooms on a task's threads. What ends them early must not pass through C: it is kept
 * for whoever made the call. */
struct TaskJobs {
    Task &task;
    std::exception_ptr thrown = nullptr;

    static void run(uint32_t count, void (*job)(uint32_t, void *), void *data, void *user)
    {
        auto *self = static_cast<TaskJobs *>(user);
        try {
            self->task.parallel(count, [&](size_t i) { job(uint32_t(i), data); });
        } catch (...) {
            self->thrown = std::current_exception();
        }
    }
};

/* The bytes of a file. */
struct Encoded {
    gtx_allocator allocator;
    void *data = nullptr;
    size_t size = 0;

    Encoded(const gtx_asset *asset, const Options &options, Task &task)
        : allocator(options.allocator)
    {
        TaskJobs on_task = {task};
        const gtx_jobs jobs = {TaskJobs::run, &on_task};
        gtx_encode_desc desc = {};
        desc.allocator = &allocator;
        desc.jobs = &jobs;
        desc.zstd_level = options.zstd;
        gtx_error error;
        const gtx_result result = gtx_encode(asset, &desc, &data, &size, &error);
        if (on_task.thrown) {
            gtx_free_array(&allocator, data, size, 1);
            std::rethrow_exception(on_task.thrown);
        }
        require_ok(result, error);
    }
    ~Encoded() { gtx_free_array(&allocator, data, size, 1); }
    Encoded(const Encoded &) = delete;
    Encoded &operator=(const Encoded &) = delete;

    void save(const char *path) const
    {
        gtx_error error;
        require_ok(gtx_save_bytes(path, &allocator, data, size, &error), error);
    }
};

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
    if (!desc.if_changed || desc.charts_ply)
        return Asset(nullptr, gtx_close);
    gtx_asset *asset = nullptr;
    gtx_open_desc open = {};
    open.allocator = desc.allocator;
    gtx_error error;
    gtx_result opened = gtx_open_file(path, &open, &asset, &error);
    if (opened == GTX_ERROR_MEMORY)
        throw Error(opened, error.message);
    if (opened)
        return Asset(nullptr, gtx_close);
    Asset owner(asset, gtx_close);
    uint64_t old_key, warnings;
    bool same = read_meta(asset, old_key, warnings) && old_key == key;
    if (!same || (desc.strict && warnings))
        owner.reset();
    return owner;
}

/* Partition, maps and asset of the clean mesh, measured where an error is wanted. */
static Attempt attempt(const Mesh &mesh, const gtx_cook_desc &desc, const Options &options,
                       Task &task, const CookFacts &facts)
{
    const size_t before = task.warnings.size();
    Attempt out;
    out.partition = make_partition(mesh, options.chart, task);
    const Mesh &charted = out.partition.charted(mesh);
    {
        Maps maps = bake(charted, out.partition, options.bake, task);
        std::vector<LodLevel> lod;
        if (options.lod_levels)
            lod = make_lod(lod_source(charted, out.partition, maps, task), maps,
                           options.lod_levels, task);
        refuse_warnings(desc, task);
        CookFacts of_asset = facts;
        of_asset.chart_count = out.partition.charts.size();
        of_asset.warnings = task.warnings.size();
        out.bake = maps.report;
        out.asset = make_asset(maps, lod, options, of_asset);
    }
    if (desc.measure || desc.error > 0) {
        task.begin("measure");
        out.error = surface_error(out.asset.get(), charted, out.partition.junk, task);
    }
    if (desc.error > 0)
        out.bytes = Encoded(out.asset.get(), options, task).size;
    out.warnings.assign(task.warnings.begin() + ptrdiff_t(before), task.warnings.end());
    task.warnings.resize(before);
    return out;
}

/* Everything from the clean mesh on; fills the rest of `facts`. */
static Attempt cook_mesh(const Mesh &mesh, const gtx_cook_desc &desc, const Options &options,
                         Task &task, CookFacts &facts)
{
    auto cook_with = [&](const Options &o) { return attempt(mesh, desc, o, task, facts); };
    Attempt made = desc.error > 0
                       ? cook_to_error(options, desc.error, {!desc.charts, options.free_bits},
                                       cook_with)
                       : cook_with(options);
    task.warnings.insert(task.warnings.end(), made.warnings.begin(), made.warnings.end());
    facts.charts = made.partition.report;
    facts.chart_count = made.partition.charts.size();
    facts.bake = made.bake;
    facts.warnings = task.warnings.size();
    facts.requested = desc.error;
    facts.measured = desc.measure || desc.error > 0;
    facts.error = made.error;
    return made;
}

/* An asset, and its bytes where they are wanted. */
struct Cooked {
    Asset asset = Asset(nullptr, gtx_close);
    std::unique_ptr<Encoded> file;
};

/* Everything from the models on; fills `facts`. */
static Cooked cook_models(Models &models, const gtx_cook_desc &desc, const Options &options,
                          bool encoded, Task &task, CookFacts &facts)
{
    Mesh mesh = import_models(models, options.z_up, task);
    facts.source_triangles = mesh.triangle_count();
    facts.source_vertices = mesh.positions.size();
    if (!models.foreseen)
        facts.key = 0; /* nobody's: it would not cover all, so this asset is always cooked again */
    task.begin("clean");
    mesh = clean_mesh(std::move(mesh), task, facts.clean);
    refuse_warnings(desc, task);
    Attempt made = cook_mesh(mesh, desc, options, task, facts);

    task.begin("write");
    if (!desc.charts_ply) { /* encoding takes its memory */
        mesh = {};
        made.partition = {};
    }
    Cooked out;
    if (encoded)
        out.file = std::make_unique<Encoded>(made.asset.get(), options, task);
    if (desc.charts_ply)
        write_charts_ply(desc.charts_ply, made.partition.charted(mesh), made.partition);
    out.asset = std::move(made.asset);
    return out;
}

static std::unique_ptr<Report> report_on(const gtx_asset *asset, const Options &options,
                                         CookFacts &facts, bool unchanged,
                                         const std::vector<std::string> &sources, const Task &task)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    facts.source_triangles = info.source_triangles;
    facts.chart_count = info.patch_count;
    facts.content_hash = info.content_hash;
    facts.gpu_bytes = gpu_bytes(info);
    facts.lod.resize(info.lod_levels);
    for (uint32_t k = 0; k < info.lod_levels; ++k)
        gtx_get_lod_mesh(asset, k, &facts.lod[k]);
    facts.stages = task.stages();
    facts.seconds = task.seconds();
    Json json(options.allocator);
    std::string summary = unchanged ? write_unchanged_report(facts, json)
                                    : write_cook_report(facts, task.warnings, json);
    auto report = std::make_unique<Report>(json, summary, sources, task.warnings);
    report->unchanged = unchanged;
    return report;
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
    if (const Extractor *gpu = options.bake.extractor) {
        facts.renderer = gpu->renderer();
        facts.version = gpu->version();
    }
    facts.key = content_key(options, models.hash);
    Cooked cooked;
    if (output) {
        refuse_overwriting_source(models.sources, output);
        cooked.asset = find_cooked(output, desc, facts.key);
    }
    const bool unchanged = cooked.asset != nullptr;
    if (!unchanged)
        cooked = cook_models(models, desc, options, output || report, task, facts);
    task.end();

    /* The file comes last: a report that finds no memory must not leave one behind. */
    std::unique_ptr<Report> made;
    if (report) {
        facts.bytes = cooked.file ? cooked.file->size : std::filesystem::file_size(output);
        facts.total_seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        made = report_on(cooked.asset.get(), options, facts, unchanged, models.sources, task);
    }
    if (cooked.file && output)
        cooked.file->save(output);
    if (report)
        made->hand_over(report);
    return std::move(cooked.asset);
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
