/* Judges from its charts and maps how well a model suits geometry textures. */
#include "cook/suitability.hpp"

#include <algorithm>
#include <cstdio>

namespace gtx {

namespace {

/* Triangles of the source that a patch stands for: below, the asset is larger than the mesh, and
 * drawing triangles is faster than casting. */
constexpr double FEW_TRIANGLES = 8;
/* Of the texels. Scans have 0.1 to 0.3, an engine 0.5. */
constexpr double MUCH_EMPTY = 0.45;
constexpr double MUCH_LOST = 0.01;

template <class... Args>
void warn(Task &task, gtx_warning kind, const char *format, Args... args)
{
    char text[200];
    snprintf(text, sizeof text, format, args...);
    task.warn(kind, text);
}

} // namespace

Suitability judge_suitability(const Partition &partition, const BakeReport &bake,
                              uint64_t triangles, Task &task)
{
    const ChartReport &charts = partition.report;
    Suitability out;
    const size_t patches = std::max<size_t>(partition.charts.size(), 1);
    out.triangles_per_patch = double(triangles) / double(patches);
    out.empty_fraction = double(bake.texels_empty) / double(bake.texels_total);
    out.outline_loss = partition.outline_loss();
    out.for_outlines = partition.for_outlines;
    out.resolution = partition.resolution;
    out.unseen_fraction = charts.unseen_area_fraction;
    if (out.outline_loss > MUCH_LOST) {
        const bool cuts = partition.method == PartitionMethod::CUTS;
        warn(task, GTX_WARNING_OUTLINE_LOSS,
             "edges are sharper than texels: about %.1f %% of an outline may be off: %s",
             100 * out.outline_loss,
             cuts ? "--partition auto takes finer ones" : "more texels (--resolution)");
        out.better = cuts ? "auto" : "texels";
    }
    if (out.empty_fraction > MUCH_EMPTY) {
        const bool cuts = partition.method == PartitionMethod::CUTS;
        warn(task, GTX_WARNING_EMPTY_TEXELS,
             "%.0f %% of the texels are empty: the parts are thin or scattered%s",
             100 * out.empty_fraction, cuts ? "; --partition auto may find better" : "");
        if (cuts)
            out.better = "auto";
    }
    if (charts.unseen_triangles) {
        warn(task, GTX_WARNING_UNSEEN,
             "%.1f %% of the surface, %llu triangles, is seen from no side and lost: other "
             "partitions show it",
             100 * out.unseen_fraction, static_cast<unsigned long long>(charts.unseen_triangles));
        out.better = "cuts";
    }
    if (out.triangles_per_patch < FEW_TRIANGLES) {
        warn(task, GTX_WARNING_FEW_TRIANGLES, "%.1f triangles a patch: draw the mesh",
             out.triangles_per_patch);
        out.better = "mesh";
    }
    return out;
}

} // namespace gtx
