/* All charts baked, and their maps put on the pages of one asset. */
#include "bake/pages.hpp"
#include "base/bytes.h"
#include "base/exact.h"
#include "bake/seam/seam.hpp"

#include <algorithm>
#include <numeric>

namespace gtx::baking {

/* Limits of the format. */
constexpr uint64_t MAX_PATCHES = 1u << 20, MAX_PAGES = 2048;

Vec3d find_anchor(const Vec3d &low, const Vec3d &high, const char *what)
{
    /* Lengths of a record are floats, and readers square them. */
    constexpr double MIN_DIAGONAL = 1e-15, MAX_DIAGONAL = 1e15;
    double diagonal = length(high - low);
    if (!(diagonal >= MIN_DIAGONAL && diagonal <= MAX_DIAGONAL))
        throw Error(GTX_ERROR_INPUT, std::string(what) + " smaller than 1e-15 or larger than 1e15");
    double step = gtx_exp2(std::floor(gtx_log2(diagonal)));
    Vec3d anchor;
    for (int k = 0; k < 3; ++k)
        anchor[k] = std::floor((low[k] / 2 + high[k] / 2) / step + 0.5) * step;
    return anchor;
}

/* The maps with mip levels: where a patch has them, where the pages do, and what an empty texel of
 * those holds. */
struct Pyramid {
    Levels PatchMaps::*from;
    Levels Maps::*to;
    size_t texel;                /* bytes */
    uint8_t blank;
};
constexpr Pyramid PYRAMIDS[] = {{&PatchMaps::normal, &Maps::normal, 2, 128},
                                {&PatchMaps::color, &Maps::color, 4, 0},
                                {&PatchMaps::material, &Maps::material, 4, 0},
                                {&PatchMaps::emission, &Maps::emission, 3, 0}};

/* Copies a tight rectangle of `texel` bytes a texel to its place at a level of the pages. */
static void blit(const Vector<uint8_t> &from, const gtx_patch &r, const Maps &maps,
                 unsigned level, size_t texel, Vector<uint8_t> &to)
{
    size_t row = (r.rect[2] >> level) * texel, page_w = maps.page_width >> level;
    size_t page = size_t(r.page) * (maps.page_height >> level);
    for (size_t j = 0; j < size_t(r.rect[3]) >> level; ++j) {
        size_t at = ((page + (r.rect[1] >> level) + j) * page_w + (r.rect[0] >> level)) * texel;
        std::copy_n(&from[j * row], row, &to[at]);
    }
}

static Vector<uint8_t> height_bytes(const PatchMaps &patch, unsigned bits)
{
    Vector<uint8_t> bytes(patch.height.size() * bits / 8);
    for (size_t i = 0; i < patch.height.size(); ++i) {
        if (bits == 8)
            bytes[i] = uint8_t(patch.height[i]);
        else
            gtx_store_own_u16(&bytes[2 * i], patch.height[i]);
    }
    return bytes;
}

/* Pages of the right size, with what lies outside every rectangle, for maps such as a patch has. */
static void allocate_pages(const Packing &packing, const BakeOptions &options,
                           const PatchMaps &patch, Maps &maps)
{
    maps.page_count = packing.page_count;
    maps.page_width = packing.width;
    maps.page_height = packing.height;
    maps.mip_count = options.mips;
    maps.height_bits = options.height_bits;
    size_t texels = size_t(packing.page_count) * packing.width * packing.height;
    maps.height.assign(texels * (options.height_bits / 8), 0);
    maps.trim.assign(texels, 255);
    for (unsigned k = 0; k < options.mips; ++k) {
        size_t of_level =
            size_t(packing.page_count) * (packing.width >> k) * (packing.height >> k);
        for (const Pyramid &p : PYRAMIDS)
            if (!(patch.*p.from).empty())
                (maps.*p.to).emplace_back(p.texel * of_level, p.blank);
    }
}

static void place_patch(PatchMaps &patch, const Packing::Place &place, Maps &maps)
{
    gtx_patch &r = patch.record;
    r.page = place.page;
    r.rect[0] = uint16_t(place.x);
    r.rect[1] = uint16_t(place.y);
    blit(height_bytes(patch, maps.height_bits), r, maps, 0, maps.height_bits / 8, maps.height);
    blit(patch.trim, r, maps, 0, 1, maps.trim);
    for (const Pyramid &p : PYRAMIDS)
        for (unsigned k = 0; k < (maps.*p.to).size(); ++k)
            blit((patch.*p.from)[k], r, maps, k, p.texel, (maps.*p.to)[k]);
}

static void summarise(const Vector<PatchMaps> &patches, Maps &maps)
{
    Vec3d low = patches[0].low, high = patches[0].high;
    for (const PatchMaps &p : patches) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p.low[k]);
            high[k] = std::max(high[k], p.high[k]);
        }
        maps.patches.push_back(p.record);
        uint64_t texels = uint64_t(p.record.rect[2]) * p.record.rect[3];
        maps.report.texels_total += texels;
        maps.report.texels_empty += texels - p.coded;
    }
    store(maps.bounds_min, low);
    store(maps.bounds_max, high);
    maps.report.page_fill = double(maps.report.texels_total) /
                            (double(maps.page_count) * maps.page_width * maps.page_height);
}

Maps place_on_pages(Vector<PatchMaps> &patches, const Vec3d &anchor,
                    const BakeOptions &options, const Limits &limits)
{
    limits.require(GTX_LIMITED_PATCHES, "the asset", patches.size());
    Vector<std::array<uint32_t, 2>> sizes;
    for (const PatchMaps &p : patches)
        sizes.push_back({p.record.rect[2], p.record.rect[3]});
    Packing packing = pack(sizes, 1u << (options.mips - 1));
    if (packing.page_count > MAX_PAGES)
        throw Error(GTX_ERROR_LIMIT, "the maps fill more than 2048 pages");
    limits.require(GTX_LIMITED_TEXELS, "the asset",
                   uint64_t(packing.page_count) * packing.width * packing.height);
    Maps maps;
    allocate_pages(packing, options, patches[0], maps);
    for (size_t i = 0; i < patches.size(); ++i)
        place_patch(patches[i], packing.places[i], maps);
    summarise(patches, maps);
    for (int k = 0; k < 3; ++k)
        maps.anchor[k] = anchor[k];
    return maps;
}

static Vec3d anchor_of(const Mesh &mesh)
{
    Vec3d low = mesh.positions[0], high = low;
    for (const Vec3d &p : mesh.positions) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    return find_anchor(low, high, "the model is");
}

static void check(const Mesh &mesh, const Partition &partition, const BakeOptions &options)
{
    if (partition.charts.empty())
        throw Error(GTX_ERROR_EMPTY, "there is no chart to bake");
    if (partition.charts.size() > MAX_PATCHES)
        throw Error(GTX_ERROR_LIMIT, "more than 2^20 charts");
    if (mesh.normals.size() != 3 * mesh.triangle_count())
        throw Error(GTX_ERROR_INTERNAL, "the mesh to bake has no corner normals");
    if (!(partition.pitch > 0) || !std::isfinite(partition.pitch))
        throw Error(GTX_ERROR_INTERNAL, "the texel pitch is not a positive number");
    if ((options.height_bits != 8 && options.height_bits != 16) || options.mips < 1 ||
        options.mips > 8 || options.dilation > 0xffff)
        throw Error(GTX_ERROR_ARGUMENT, "height bits, mips or dilation out of range");
}

/* The charts from one on: a large one that begins last is waited for. */
static Vector<size_t> largest_first(const Vector<Chart> &charts, size_t first)
{
    Vector<size_t> order(charts.size() - first);
    std::iota(order.begin(), order.end(), first);
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return charts[a].triangles.size() > charts[b].triangles.size();
    });
    return order;
}

} // namespace gtx::baking

namespace gtx {

using namespace baking;

Maps bake(const Mesh &mesh, Partition &partition, const BakeOptions &options, Task &task)
{
    check(mesh, partition, options);
    task.begin("bake");
    const bool known = !partition.neighbours.empty();
    Neighbours neighbours = known ? std::move(partition.neighbours) : triangle_neighbours(mesh);
    Job job = {mesh,            neighbours,      options, appearance_needs(mesh),
               partition.pitch, anchor_of(mesh), partition.charts.size(), partition.for_outlines};
    Vector<PatchMaps> patches;
    auto bake_rest = [&](double from, double to) {
        const size_t done = patches.size();
        patches.resize(partition.charts.size());
        const Vector<size_t> order = largest_first(partition.charts, done);
        task.parallel(order.size(), [&](size_t n) {
            patches[order[n]] = bake_chart(job, partition.charts[order[n]]);
        }, from, to);
    };
    bake_rest(0, 0.9);
    Vector<Chart> uncovered;
    if (partition.complete)
        uncovered = cover_uncovered(job, partition, patches, task);
    std::move(uncovered.begin(), uncovered.end(), std::back_inserter(partition.charts));
    bake_rest(0.9, 1);
    Vector<uint32_t> charts;
    for (size_t i = 0; i < patches.size(); ++i)
        if (patches[i].coded)
            charts.push_back(uint32_t(i));
    patches.erase(std::remove_if(patches.begin(), patches.end(),
                                 [](const PatchMaps &p) { return !p.coded; }),
                  patches.end());
    if (patches.empty())
        throw Error(GTX_ERROR_EMPTY, "the materials cut all of the model away");

    stitch(options.height_bits, patches, task);
    close_cuts(partition, charts, job.anchor, options.height_bits, patches, task);
    if (job.sharp)
        end_at_creases(options.height_bits, patches, task);
    take_back_fins(job, patches, task);
    task.parallel(patches.size(),
                  [&](size_t i) { measure_patch(options.height_bits, patches[i]); });

    task.begin("pack");
    Maps maps = place_on_pages(patches, job.anchor, options, task.limits);
    maps.charts = std::move(charts);
    maps.emission_scale = job.needs.emission_scale;
    return maps;
}

} // namespace gtx
