/* Charts with frames -> the maps of an asset (paper, section 5.3). */
#include "bake/patch_maps.hpp"

#include <algorithm>

namespace gtx::baking {

constexpr uint64_t MOST_PATCHES = 1u << 20, MOST_PAGES = 2048;

/* What every chart's bake reads. */
struct Job {
    const Mesh &mesh;
    const Neighbours &neighbours;
    const BakeOptions &options;
    double pitch;
    Vec3d anchor;
};

/* The part of a working grid that becomes the rectangle: its first texel may lie outside. */
struct Crop {
    int x = 0, y = 0, w = 0, h = 0;
};

static Crop crop_support(const Grid &grid, const std::vector<uint8_t> &support, int grain)
{
    int low[2] = {grid.w, grid.h}, high[2] = {0, 0};
    for (int j = 0; j < grid.h; ++j) {
        for (int i = 0; i < grid.w; ++i) {
            if (!support[size_t(j) * grid.w + i])
                continue;
            low[0] = std::min(low[0], i);
            high[0] = std::max(high[0], i + 1);
            low[1] = std::min(low[1], j);
            high[1] = std::max(high[1], j + 1);
        }
    }
    auto round_up = [&](int size) { return (std::max(size, 2) + grain - 1) / grain * grain; };
    Crop crop;
    crop.w = round_up(high[0] - low[0]);
    crop.h = round_up(high[1] - low[1]);
    crop.x = low[0] - (crop.w - (high[0] - low[0])) / 2;
    crop.y = low[1] - (crop.h - (high[1] - low[1])) / 2;
    return crop;
}

static void store(float out[3], const Vec3d &v)
{
    for (int k = 0; k < 3; ++k)
        out[k] = float(v[k]);
}

static gtx_patch make_record(const Job &job, const Chart &chart, const Grid &grid, const Crop &crop,
                             double low, double high)
{
    gtx_patch record = {};
    const Frame &f = chart.frame;
    double a = grid.corner[0] + crop.x * grid.pitch[0], b = grid.corner[1] + crop.y * grid.pitch[1];
    store(record.origin, (grid.origin - job.anchor) + f.x * a + f.y * b + f.z * low);
    store(record.axis_x, f.x);
    store(record.axis_y, f.y);
    store(record.axis_z, f.z);
    double extent_x = crop.w * grid.pitch[0], extent_y = crop.h * grid.pitch[1];
    record.extent_x = float(extent_x);
    record.extent_y = float(extent_y);
    record.extent_z = float(std::max(high - low, std::max(extent_x, extent_y) / 4096));
    record.rect[2] = uint16_t(crop.w);
    record.rect[3] = uint16_t(crop.h);
    unsigned dilation = job.options.dilation;
    record.dilation = uint16_t(dilation ? dilation : 1u << (job.options.mips - 1));
    record.flags = chart.two_sided ? GTX_PATCH_TWO_SIDED : 0;
    record.source_triangles = uint32_t(chart.triangles.size());
    return record;
}

/* The point of a texel as a reader computes it from the record. */
static Vec3d texel_point(const gtx_patch &r, int i, int j, double height)
{
    double a = (i + 0.5) / r.rect[2] * r.extent_x, b = (j + 0.5) / r.rect[3] * r.extent_y;
    double c = height * r.extent_z;
    Vec3d p;
    for (int k = 0; k < 3; ++k)
        p[k] = r.origin[k] + a * r.axis_x[k] + b * r.axis_y[k] + c * r.axis_z[k];
    return p;
}

/* Coverage, sphere and the box of the coded texels. */
static void measure_patch(unsigned height_bits, PatchMaps &maps)
{
    gtx_patch &r = maps.record;
    double steps = height_bits == 8 ? 254 : 65534;
    int w = r.rect[2], h = r.rect[3];
    maps.low = {INFINITY, INFINITY, INFINITY};
    maps.high = -maps.low;
    std::vector<Vec3d> points;
    for (int j = 0; j < h; ++j) {
        for (int i = 0; i < w; ++i) {
            unsigned code = maps.height[size_t(j) * w + i];
            if (!code)
                continue;
            Vec3d p = texel_point(r, i, j, (code - 1) / steps);
            for (int k = 0; k < 3; ++k) {
                maps.low[k] = std::min(maps.low[k], p[k]);
                maps.high[k] = std::max(maps.high[k], p[k]);
            }
            points.push_back(p);
        }
    }
    maps.coded = points.size();
    r.coverage = float(double(points.size()) / (double(w) * h));
    store(r.sphere, (maps.low + maps.high) * 0.5);
    Vec3d centre(r.sphere[0], r.sphere[1], r.sphere[2]);
    double radius = 0;
    for (const Vec3d &p : points)
        radius = std::max(radius, length(p - centre));
    r.sphere[3] = float(radius * (1 + 1e-6));
}

static void quantise(const Grid &grid, const Crop &crop, const Cover &cover,
                     const std::vector<uint8_t> &support, const std::vector<float> &trim,
                     double low, unsigned height_bits, PatchMaps &maps)
{
    double steps = (height_bits == 8 ? 254 : 65534) / double(maps.record.extent_z);
    double top = height_bits == 8 ? 254 : 65534;
    maps.height.assign(size_t(crop.w) * crop.h, 0);
    maps.trim.resize(maps.height.size());
    for (int j = 0; j < crop.h; ++j) {
        for (int i = 0; i < crop.w; ++i) {
            int x = crop.x + i, y = crop.y + j;
            int near_x = std::clamp(x, 0, grid.w - 1), near_y = std::clamp(y, 0, grid.h - 1);
            size_t from = size_t(near_y) * grid.w + near_x, to = size_t(j) * crop.w + i;
            maps.trim[to] = uint8_t(std::clamp(128 + 16 * trim[from], 0.f, 255.f) + 0.5f);
            if (x == near_x && y == near_y && support[from]) {
                double code = std::floor((cover.height[from] - low) * steps + 0.5);
                maps.height[to] = uint16_t(1 + std::clamp(code, 0., top));
            }
        }
    }
}

static void shade(const Job &job, const FlatChart &flat, const Outline &outline, const Crop &crop,
                  const Cover &cover, PatchMaps &maps)
{
    std::vector<Shade> shades(maps.height.size());
    std::vector<uint8_t> occupied(maps.height.size());
    for (size_t i = 0; i < shades.size(); ++i) {
        occupied[i] = maps.height[i] != 0;
        if (occupied[i])
            shades[i] = shade_texel(job.mesh, flat, outline, cover, crop.x + int(i) % crop.w,
                                    crop.y + int(i) / crop.w);
    }
    build_mips(std::move(shades), std::move(occupied), job.options.mips,
               !job.mesh.colors.empty(), maps);
}

static PatchMaps bake_chart(const Job &job, const Chart &chart)
{
    FlatChart flat = flatten(job.mesh, job.neighbours, chart, job.pitch);
    Cover core = raster_core(flat);
    Outline core_outline = find_outline(flat, flat.core);
    Cover all = core;
    raster_overlap(flat, core_outline, all);
    Outline outline = find_outline(flat, flat.triangles.size());
    std::vector<float> trim = trim_distances(flat, core, all, core_outline, outline);
    std::vector<uint8_t> support = find_support(flat.grid, trim);
    extrapolate(flat, outline, support, all);

    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < support.size(); ++i) {
        if (support[i]) {
            low = std::min(low, all.height[i]);
            high = std::max(high, all.height[i]);
        }
    }
    Crop crop = crop_support(flat.grid, support, 1 << (job.options.mips - 1));
    PatchMaps maps;
    maps.record = make_record(job, chart, flat.grid, crop, low, high);
    quantise(flat.grid, crop, all, support, trim, low, job.options.height_bits, maps);
    measure_patch(job.options.height_bits, maps);
    shade(job, flat, outline, crop, all, maps);
    return maps;
}

/* The centre of the bounding box, to a multiple of the largest power of two that is not above its
 * diagonal: a model near the origin keeps its coordinates. */
static Vec3d find_anchor(const Mesh &mesh)
{
    Vec3d low = mesh.positions[0], high = low;
    for (const Vec3d &p : mesh.positions) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    double diagonal = length(high - low);
    double step = diagonal > 0 ? std::exp2(std::floor(std::log2(diagonal))) : 1;
    Vec3d anchor;
    for (int k = 0; k < 3; ++k)
        anchor[k] = std::floor((low[k] / 2 + high[k] / 2) / step + 0.5) * step;
    return anchor;
}

/* Copies a tight rectangle of `texel` bytes a texel to its place at a level of the pages. */
static void blit(const std::vector<uint8_t> &from, const gtx_patch &r, const Maps &maps,
                 unsigned level, size_t texel, std::vector<uint8_t> &to)
{
    size_t row = (r.rect[2] >> level) * texel, page_w = maps.page_width >> level;
    size_t page = size_t(r.page) * (maps.page_height >> level);
    for (size_t j = 0; j < size_t(r.rect[3]) >> level; ++j) {
        size_t at = ((page + (r.rect[1] >> level) + j) * page_w + (r.rect[0] >> level)) * texel;
        std::copy_n(&from[j * row], row, &to[at]);
    }
}

static std::vector<uint8_t> height_bytes(const PatchMaps &patch, unsigned bits)
{
    std::vector<uint8_t> bytes(patch.height.size() * bits / 8);
    for (size_t i = 0; i < patch.height.size(); ++i) {
        if (bits == 8) {
            bytes[i] = uint8_t(patch.height[i]);
        } else {
            bytes[2 * i] = uint8_t(patch.height[i]);
            bytes[2 * i + 1] = uint8_t(patch.height[i] >> 8);
        }
    }
    return bytes;
}

/* Pages of the right size, with what lies outside every rectangle. */
static void allocate_pages(const Packing &packing, const BakeOptions &options, bool color,
                           Maps &maps)
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
        maps.normal.emplace_back(2 * of_level, uint8_t(128));
        if (color)
            maps.color.emplace_back(4 * of_level, uint8_t(0));
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
    for (unsigned k = 0; k < maps.mip_count; ++k) {
        blit(patch.normal[k], r, maps, k, 2, maps.normal[k]);
        if (!maps.color.empty())
            blit(patch.color[k], r, maps, k, 4, maps.color[k]);
    }
}

static void summarise(const std::vector<PatchMaps> &patches, Maps &maps)
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

static void check(const Mesh &mesh, const Partition &partition, const BakeOptions &options)
{
    if (partition.charts.empty())
        throw Error(GTX_ERROR_EMPTY, "there is no chart to bake");
    if (partition.charts.size() > MOST_PATCHES)
        throw Error(GTX_ERROR_LIMIT, "more than 2^20 charts");
    if (mesh.normals.size() != 3 * mesh.triangle_count())
        throw Error(GTX_ERROR_INTERNAL, "the mesh to bake has no corner normals");
    if (!(partition.pitch > 0) || !std::isfinite(partition.pitch))
        throw Error(GTX_ERROR_INTERNAL, "the texel pitch is not a positive number");
    if ((options.height_bits != 8 && options.height_bits != 16) || options.mips < 1 ||
        options.mips > 8 || options.dilation > 0xffff)
        throw Error(GTX_ERROR_ARGUMENT, "height bits, mips or dilation out of range");
}

} // namespace gtx::baking

namespace gtx {

using namespace baking;

Maps bake(const Mesh &mesh, const Partition &partition, const BakeOptions &options, Task &task)
{
    check(mesh, partition, options);
    task.begin("bake");
    Neighbours neighbours = triangle_neighbours(mesh);
    Job job = {mesh, neighbours, options, partition.pitch, find_anchor(mesh)};
    std::vector<PatchMaps> patches(partition.charts.size());
    task.parallel(patches.size(),
                  [&](size_t i) { patches[i] = bake_chart(job, partition.charts[i]); });

    task.begin("pack");
    std::vector<std::array<uint32_t, 2>> sizes;
    for (const PatchMaps &p : patches)
        sizes.push_back({p.record.rect[2], p.record.rect[3]});
    Packing packing = pack(sizes, 1u << (options.mips - 1));
    if (packing.page_count > MOST_PAGES)
        throw Error(GTX_ERROR_LIMIT, "the maps fill more than 2048 pages");
    Maps maps;
    allocate_pages(packing, options, !mesh.colors.empty(), maps);
    for (size_t i = 0; i < patches.size(); ++i)
        place_patch(patches[i], packing.places[i], maps);
    for (int k = 0; k < 3; ++k)
        maps.anchor[k] = job.anchor[k];
    summarise(patches, maps);
    return maps;
}

} // namespace gtx
