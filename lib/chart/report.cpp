/* Counts folds, layers, junk and edges for the report. */
#include "chart/report.hpp"

#include <algorithm>

namespace gtx {

/* Cosine of the bend across a sharp edge. */
constexpr float SHARP = 0.5f;

/* A triangle in pieces counts once. */
void report_initial(const Surface &surface, const Vector<Region> &regions, Task &task,
                    Partition &out)
{
    Vector<Vector<uint32_t>> inverted(regions.size());
    for_each_region(regions, task, [&](size_t i) {
        Vec3d z = median_axis(surface.mesh, regions[i].triangles, &surface.normal);
        for (uint32_t t : regions[i].triangles)
            if (dot(surface.mesh.area_vector(t), z) <= 0)
                inverted[i].push_back(out.source_of(t));
    }, 0.7, 0.72);
    out.report.initial_charts = regions.size();
    Vector<uint32_t> all;
    for (const Vector<uint32_t> &some : inverted) {
        all.insert(all.end(), some.begin(), some.end());
        out.report.initial_folding += !some.empty();
    }
    std::sort(all.begin(), all.end());
    out.report.initial_inverted = uint64_t(std::unique(all.begin(), all.end()) - all.begin());
}

void report_final(const Surface &surface, const Vector<Region> &regions,
                  const Vector<Frame> &frames, Task &task, Partition &out)
{
    struct Count {
        uint64_t inverted, samples, doubled;
        bool folding;
    };
    Vector<Count> counts(regions.size());
    for_each_region(regions, task, [&](size_t i) {
        Layers layers = find_layers(surface, regions[i], frames[i], out.pitch, task, false);
        counts[i] = {0, layers.samples, layers.doubled, !layers.folds.empty()};
        for (uint32_t t : regions[i].triangles)
            counts[i].inverted += is_inverted(surface, t, frames[i].z, out.pitch);
    });
    uint64_t samples = 0, doubled = 0;
    for (const Count &c : counts) {
        out.report.inverted_triangles += c.inverted;
        out.report.folding_charts += c.inverted > 0 || c.folding;
        samples += c.samples;
        doubled += c.doubled;
    }
    out.report.second_layer_fraction = samples ? double(doubled) / double(samples) : 0;
    double area = 0;
    for (size_t t = 0; t < surface.junk.size(); ++t)
        if (surface.junk[t]) {
            ++out.report.junk_triangles;
            area += surface.facets[t].size;
        }
    out.report.junk_area_fraction = area / double(surface.junk.size());
}

void report_edges(const Surface &surface, Partition &out)
{
    double sharp = 0;
    for (uint32_t t = 0; t < surface.facets.size(); ++t) {
        Vec3d corner[3];
        double shares = 0;
        for (uint32_t n : surface.whole.neighbours[t])
            if (n == NO_TRIANGLE)
                shares += 1;
            else if (dot(surface.normal[t], surface.normal[n]) < SHARP)
                shares += 0.5;
        if (shares == 0 || surface.junk[t])
            continue;
        for (int k = 0; k < 3; ++k)
            corner[k] = surface.mesh.position(t, k);
        double round = 0;
        for (int k = 0; k < 3; ++k)
            round += length(corner[(k + 1) % 3] - corner[k]);
        sharp += shares * round / 3;
    }
    out.report.edge_length = sharp;
    out.report.area = surface.area;
}

void report_unseen(const Surface &surface, const Region &unseen, Partition &out)
{
    double size = 0;
    for (uint32_t t : unseen.triangles)
        size += double(surface.facets[t].size);
    out.report.unseen_triangles = unseen.size();
    out.report.unseen_area_fraction = size / double(surface.facets.size());
}

} // namespace gtx
