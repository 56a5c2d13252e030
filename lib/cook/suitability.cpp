/* Judges from its charts and maps how well a model suits geometry textures. */
#include "cook/suitability.hpp"

#include <algorithm>
#include <cstdio>

namespace gtx {

namespace {

/* What is warned of, by --partition cuts of a box, Spot's control mesh, a truck, a chair, a helmet,
 * a bird, an engine and scans. */
/* Triangles of the source that a patch stands for: below, the asset is larger than the mesh, and
 * drawing triangles is faster than casting. A box has 2 and Spot 7, a bird 17. At half Spot is not
 * warned of; at double still no other. */
constexpr double FEW_TRIANGLES = 8;
/* Of the texels. Scans have 0.1 to 0.3, a chair 0.44, helmet, truck, engine and bird 0.45 to 0.50.
 * At half most scans are warned of, at double nothing is. */
constexpr double MUCH_EMPTY = 0.45;
/* Of a silhouette. An engine loses 0.018, trucks 0.004 and 0.006, scans at most 0.002. At half a
 * truck is warned of, too, at double nothing is. (The default takes finer texels from less on.) */
constexpr double WARNED_LOSS = 0.01;

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
    if (out.outline_loss > WARNED_LOSS) {
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
