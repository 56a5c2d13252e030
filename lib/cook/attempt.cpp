/* From the clean mesh to an asset in memory, by options that are settled. */
#include "cook/attempt.hpp"

#include "cook/encoded.hpp"
#include "cook/meta.hpp"

#include "bake/lod/lod.hpp"

#include <algorithm>

namespace gtx {

/* Bounds of LOD meshes may take so many times the work of another stage: thousands of triangles on
 * one edge are all as near, and take more than one. */
constexpr double BOUND_WORK = 4;

void refuse_warnings(const Options &options, const Task &task)
{
    const Warning *first = nullptr;
    size_t count = 0;
    for (const Warning &warning : task.warnings)
        if (options.strict && !options.allowed[warning.kind]) {
            first = first ? first : &warning;
            ++count;
        }
    if (first)
        throw Error(GTX_ERROR_INPUT, first->sentence + " (" + gtx_warning_name(first->kind) +
                                         (count > 1 ? ", and " + std::to_string(count - 1) +
                                                          " more warnings)"
                                                    : ")"));
}

/* Which vertices of the LOD meshes' source are to stay. */
static void mark_kept(const Options &options, const Maps &maps, LodSource &source)
{
    if (!options.kept_count)
        return;
    auto before = [](const Vec3d &a, const Vec3d &b) {
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    };
    Vector<Vec3d> kept;
    const Vec3d anchor(maps.anchor[0], maps.anchor[1], maps.anchor[2]);
    for (const double *p = options.kept, *end = p + 3 * options.kept_count; p != end; p += 3)
        kept.push_back(Vec3d(p[0], p[1], p[2]) - anchor);
    std::sort(kept.begin(), kept.end(), before);
    for (const Vec3d &p : source.positions)
        source.kept.push_back(std::binary_search(kept.begin(), kept.end(), p, before));
}

/* Where nobody asked for finer layers, twice the texels along a side may do four times the work. */
static double work_of(const Options &options, const Partition &partition)
{
    const double times = work_of(options);
    const bool unasked = options.chart.method == PartitionMethod::DEFAULT;
    return unasked && partition.for_outlines ? 4 * times : times;
}

/* Maps and asset of the partition, measured where that is wanted. */
static Attempt finish(const Mesh &mesh, Partition partition, const Options &options, Task &task,
                      const CookFacts &facts)
{
    const size_t before = task.warnings.size();
    Attempt out;
    out.partition = std::move(partition);
    const double work = work_of(options, out.partition);
    task.limits.allow_work(work * out.partition.more_texels);
    const Mesh &charted = out.partition.charted(mesh);
    {
        Maps maps = bake(charted, out.partition, options.bake, task);
        out.suitability = judge_suitability(out.partition, maps.report, facts.source_triangles,
                                            task);
        Vector<LodLevel> lod;
        if (options.lod_levels) {
            LodSource source = lod_source(charted, out.partition, maps, task);
            mark_kept(options, maps, source);
            task.limits.allow_work(BOUND_WORK * work);
            lod = make_lod(source, maps, options.lod_levels, task);
            task.limits.allow_work(work);
        }
        for (const LodLevel &level : lod)
            out.lod_rms.push_back(double(level.rms));
        refuse_warnings(options, task);
        CookFacts of_asset = facts;
        of_asset.chart_count = out.partition.charts.size();
        of_asset.method = out.partition.method;
        of_asset.suitability = out.suitability;
        for (const Warning &warning : task.warnings)
            if (warning.kind != GTX_WARNING_CACHE) /* of this call, not of the asset */
                of_asset.warnings.set(warning.kind);
        out.bake = maps.report;
        out.asset = assemble(maps, lod, {write_meta(options, of_asset), options.unit,
                                         facts.source_triangles, options.allocator});
    }
    if (options.measure) {
        task.begin("measure");
        task.limits.work_again();
        out.error = surface_error({out.asset.get()}, charted, out.partition.junk, task);
    }
    if (options.error > 0)
        out.bytes = Encoded(out.asset.get(), options, task).size;
    out.warnings.assign(task.warnings.begin() + ptrdiff_t(before), task.warnings.end());
    task.warnings.resize(before);
    return out;
}

Attempt attempt(const Mesh &mesh, const Options &options, Task &task, const CookFacts &facts)
{
    const size_t before = task.warnings.size();
    task.limits.allow_work(work_of(options));
    Partition partition = make_partition(mesh, options.chart, task);
    if (options.chart.method != PartitionMethod::DEFAULT || !partition.for_outlines)
        return finish(mesh, std::move(partition), options, task, facts);
    try {
        return finish(mesh, std::move(partition), options, task, facts);
    } catch (const Error &error) {
        if (error.result != GTX_ERROR_LIMIT)
            throw;
    }
    /* What nobody asked for must not be what passes a limit. */
    task.warnings.resize(before);
    Options cuts = options;
    cuts.chart.method = PartitionMethod::CUTS;
    task.begin_pass("partition", "write", 1);
    return finish(mesh, make_partition(mesh, cuts.chart, task), cuts, task, facts);
}

} // namespace gtx
