/* The pipeline from a model file to an asset file (paper, section 5), behind the C API. */
#include "cook/attempt.hpp"
#include "cook/cache.hpp"
#include "cook/encoded.hpp"
#include "cook/guard.hpp"
#include "cook/meta.hpp"
#include "cook/models.hpp"

#include "asset/asset.h"
#include "mesh/glb.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

namespace gtx {

/* The stages and their shares of the time, measured on scans of 10^5 triangles and more: they pace
 * the progress and nothing else. The file is written last, so that a cook that is cancelled or
 * fails leaves nothing. */
static Task make_task(const gtx_cook_desc &desc, const Options &options)
{
    const float lod = options.lod_levels ? 18 : 0, measure = options.measure ? 60 : 0;
    return Task(desc.threads, desc.progress, desc.progress_user,
                {"import", "clean", "partition", "frame", "bake", "pack", "lod", "measure",
                 "write"},
                {6, 14, 40, 10, 22, 2, lod, measure, 6}, desc.limits);
}

/* Of the progress that is left, an attempt to reach an error takes this share: the cook needs 6 to
 * 10 (spot and the duck at 1e-3 and 1e-4), which end at 74 to 89 %. At half they end at 47 %, at
 * double the last ones hardly move it. */
constexpr double ATTEMPT_SHARE = 0.2;

/* The files that a call writes, and who else wants to know what it reads. */
struct Outputs {
    const char *asset, *charts_ply;
    gtx_sources_fn sources_fn;
    void *user;

    void refuse_one_file() const
    {
        require_argument(!asset || !charts_ply || !gtx_same_file(asset, charts_ply),
                         "the asset and charts_ply are one file");
    }
    void refuse(const char *source) const
    {
        require_argument(!asset || !gtx_same_file(source, asset),
                         "the output is one of the files that the model is read from");
        require_argument(!charts_ply || !gtx_same_file(source, charts_ply),
                         "charts_ply is one of the files that the model is read from");
    }
    void refuse_sources(const Vector<std::string> &sources) const
    {
        Vector<const char *> paths;
        for (const std::string &source : sources) {
            refuse(source.c_str());
            paths.push_back(source.c_str());
        }
        gtx_error error;
        gtx_fail(&error, GTX_OK, "a file that the model is read from was refused");
        if (sources_fn)
            error.result = sources_fn(paths.data(), paths.size(), user, &error);
        require_ok(error.result, error);
    }
};

/* Everything from the clean mesh on; fills the rest of `facts`. */
static Attempt cook_mesh(const Mesh &mesh, const Options &options, Task &task, CookFacts &facts)
{
    auto cook_again = [&](const Options &tried) {
        task.begin_pass("partition", "write", ATTEMPT_SHARE);
        return attempt(mesh, tried, task, facts);
    };
    Attempt made = options.error > 0 ? cook_to_error(options, cook_again)
                                     : attempt(mesh, options, task, facts);
    task.warnings.insert(task.warnings.end(), made.warnings.begin(), made.warnings.end());
    facts.charts = made.partition.report;
    facts.bake = made.bake;
    facts.method = made.partition.method;
    facts.suitability = made.suitability;
    facts.error = made.error;
    facts.lod_rms = made.lod_rms;
    return made;
}

/* An asset, and its bytes where they are wanted. */
struct Cooked {
    Asset asset = Asset(nullptr, gtx_close);
    std::unique_ptr<Encoded> file;
};

/* The asset that the only model holds, a GLB of gtx_export_file; empty where it holds none. */
static std::string_view held_asset(const Models &models, const Options &options)
{
    std::string_view held;
    for (const ModelFile &file : models.files)
        if (held.empty())
            held = embedded_asset(file.bytes);
    const bool as_it_is = models.files.size() == 1 && !options.charts_ply &&
                          content_key(options, 0) == content_key(checked_options({}), 0);
    require_argument(held.empty() || as_it_is,
                     "the GLB holds its asset, which is taken as it is: no option that would "
                     "change it, and no other model, goes with it");
    return held;
}

static bool is_content(const char *path, std::string_view bytes, const gtx_allocator &allocator)
{
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored) &&
           FileBytes(path, allocator, {}).view() == bytes;
}

/* Everything from the models on; fills `facts`. */
static Cooked cook_models(Models &models, const Options &options, const Outputs &outputs,
                          bool encoded, Task &task, CookFacts &facts)
{
    Mesh mesh = import_models(models, options.z_up, task);
    facts.source_triangles = mesh.triangle_count();
    facts.source_vertices = mesh.positions.size();
    if (!models.foreseen) {
        outputs.refuse_sources(models.sources);
        facts.key = 0; /* nobody's: it would not cover all, so this asset is always cooked again */
    }
    task.begin("clean");
    mesh = clean_mesh(std::move(mesh), task, facts.clean, options.closed);
    refuse_warnings(options, task);
    Attempt made = cook_mesh(mesh, options, task, facts);

    task.begin("write");
    if (!options.charts_ply) { /* encoding takes its memory */
        mesh = {};
        made.partition = {};
    }
    add_textures(made.asset.get(), options, task);
    Cooked out;
    if (encoded)
        out.file = std::make_unique<Encoded>(made.asset.get(), options, task);
    if (options.charts_ply)
        write_charts_ply(options.charts_ply, made.partition.charted(mesh), made.partition);
    out.asset = std::move(made.asset);
    return out;
}

static std::unique_ptr<Report> report_on(const gtx_asset *asset, const Options &options,
                                         CookFacts &facts, const Vector<std::string> &sources,
                                         const Task &task)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    facts.source_triangles = info.source_triangles;
    facts.chart_count = info.patch_count;
    facts.content_hash = info.content_hash;
    facts.lod.resize(info.lod_levels);
    for (uint32_t k = 0; k < info.lod_levels; ++k)
        gtx_get_lod_mesh(asset, k, &facts.lod[k]);
    Json json(options.allocator);
    std::string summary = write_cook_report(options, facts, task, json);
    auto report = std::make_unique<Report>(json, summary, sources, task.warnings);
    report->unchanged = facts.unchanged && !facts.held && !facts.cached;
    report->cached = facts.cached;
    return report;
}

/* The whole line. Without an output the asset is only returned. */
static Cooked cook(const ModelInput &input, const char *output, const gtx_cook_desc &desc,
                   gtx_report *report)
{
    const Options options = checked_options(desc);
    auto start = std::chrono::steady_clock::now();
    Task task = make_task(desc, options);
    task.limits.allow_work(work_of(options));
    CookFacts facts;

    const Outputs outputs = {output, desc.charts_ply, desc.sources_fn, desc.sources_user};
    outputs.refuse_one_file();
    if (!input.data && !input.make)
        outputs.refuse(input.path);
    for (uint32_t i = 0; i < desc.more_count; ++i)
        outputs.refuse(desc.more[i]);
    task.begin("import");
    Models models = read_models(input, desc.more, desc.more_count,
                                {text_of(desc.texture_dir), text_of(desc.base_color)}, task);
    outputs.refuse_sources(models.sources);
    facts.source_hash = models.hash;
    facts.key = content_key(options, models.hash);
    Cooked cooked;
    const std::string_view held = held_asset(models, options);
    facts.held = !held.empty() && !(output && options.if_changed &&
                                    is_content(output, held, options.allocator));
    if (!held.empty())
        cooked.asset = open_asset(held, options.allocator, desc.limits);
    else if (output)
        cooked.asset = find_cooked(output, options, facts.key, desc.limits);
    Cached found;
    if (!cooked.asset)
        found = find_in_cache(options, facts.key, desc.limits, task);
    facts.cached = found.asset != nullptr;
    if (facts.cached)
        cooked.asset = std::move(found.asset);
    facts.unchanged = cooked.asset != nullptr;
    if (!facts.unchanged) {
        cooked = cook_models(models, options, outputs, output || report || options.cache, task,
                             facts);
        if (cooked.file)
            keep_in_cache(options, facts.key, cooked.file->view(), task);
    }
    task.end();

    /* The file comes last: a report that finds no memory must not leave one behind. */
    std::unique_ptr<Report> made;
    if (report) {
        facts.bytes = cooked.file     ? cooked.file->size
                      : facts.cached ? found.file->size
                      : held.empty() ? std::filesystem::file_size(output)
                                     : held.size();
        facts.total_seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        made = report_on(cooked.asset.get(), options, facts, models.sources, task);
    }
    gtx_error error;
    if (cooked.file && output)
        cooked.file->save(output);
    if (facts.held && output)
        require_ok(gtx_write_file(output, held.data(), held.size(), &error), error);
    if (facts.cached && output)
        require_ok(gtx_write_file(output, found.file->data, found.file->size, &error), error);
    if (report)
        made->hand_over(report);
    return cooked;
}

gtx_result cook_made_mesh(const std::function<Mesh()> &make, uint64_t hash,
                          const gtx_cook_desc &desc, gtx_asset **out, std::string *file,
                          gtx_report *report, gtx_error *error)
{
    return guard(error, [&] {
        const ModelInput input = {"mesh", nullptr, 0, make, hash};
        Cooked cooked = cook(input, nullptr, desc, report);
        *file = cooked.file->view();
        *out = cooked.asset.release();
    });
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
                   .asset.release();
    });
}
