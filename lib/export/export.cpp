/* Exporting behind the C API: which levels, limits, files. */
#include "export/document.hpp"

#include "cook/embedded.hpp"
#include "cook/guard.hpp"

#include "base/alloc.h"
#include "base/output.h"

#include <geotex/export.h>

#include <algorithm>
#include <chrono>
#include <cstring>

namespace gtx {

static gtx_lod_mesh lod_mesh(const gtx_asset *asset, uint32_t level)
{
    gtx_lod_mesh mesh = {};
    gtx_get_lod_mesh(asset, level, &mesh);
    return mesh;
}

/* ---- the asset's levels ---- */

/* Levels before the far ones, whose triangles are larger than the patches that texture them. */
static uint32_t near_levels(const gtx_asset *asset)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    uint32_t count = 0;
    while (count < info.lod_levels && !(lod_mesh(asset, count).flags & GTX_LOD_FAR))
        ++count;
    if (!count)
        throw Error(GTX_ERROR_EMPTY, "the asset has no LOD mesh to export; gtx pack --lod-levels "
                                     "makes some");
    return count;
}

static double diagonal_of(const gtx_asset *asset)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    Vec3d size;
    for (int k = 0; k < 3; ++k)
        size[k] = double(info.bounds_max[k]) - double(info.bounds_min[k]);
    return length(size);
}

static uint32_t chosen_level(const gtx_asset *asset, const gtx_export_desc &desc)
{
    const uint32_t count = near_levels(asset);
    if (desc.level >= count)
        throw Error(GTX_ERROR_ARGUMENT,
                    "there is no LOD mesh " + std::to_string(desc.level) + " to export: they are "
                    "0 to " + std::to_string(count - 1) + ", far ones apart");
    uint32_t level = desc.level;
    if (desc.max_error > 0) {
        const double allowed = desc.max_error * diagonal_of(asset);
        if (double(lod_mesh(asset, 0).error) > allowed)
            throw Error(GTX_ERROR_LIMIT, "the finest LOD mesh is farther from the source than "
                                         "max_error allows");
        while (level + 1 < count && double(lod_mesh(asset, level + 1).error) <= allowed)
            ++level;
    }
    return level;
}

/* Halvings of the sides of a normal map; those of KTX2 stay multiples of 4. */
static unsigned normals_coarser_by(unsigned wanted, const gtx_info &info,
                                   const ExportOptions &options)
{
    const auto is_fit = [&](unsigned level) {
        return (info.page_width >> level) % 4 == 0 && (info.page_height >> level) % 4 == 0;
    };
    unsigned level = std::min(wanted, info.mip_count - 1);
    if (options.ktx2 && !is_fit(0))
        throw Error(GTX_ERROR_UNSUPPORTED, "KTX2 textures need pages whose sides are multiples of "
                                           "4");
    while (options.ktx2 && !is_fit(level))
        --level;
    return level;
}

Exported export_glb(const gtx_asset *asset, std::string_view bytes, const ExportOptions &options,
                    Task &task)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    Exported out;
    Document document(asset, options, task);
    const uint32_t after = options.lods ? near_levels(asset) : options.level + 1;
    for (uint32_t level = options.level; level < after; ++level) {
        const gtx_lod_mesh lod = lod_mesh(asset, level);
        size_t vertices = lod.vertex_count;
        task.begin("mesh");
        if (options.collision) {
            document.add_collision(level, lod);
        } else {
            const unsigned coarser = normals_coarser_by(level - options.level, info, options);
            const ExportMesh mesh = export_mesh(asset, lod, coarser, task);
            vertices = mesh.vertices.size();
            document.add_level(level, mesh, coarser);
        }
        out.levels.push_back({level, lod.triangle_count, vertices, double(lod.error)});
    }
    task.begin("maps");
    if (!options.collision)
        document.add_maps();
    if (options.with_asset && !options.collision)
        document.set_asset(bytes);
    task.begin("write");
    out.images = document.images();
    out.file = document.file();
    return out;
}

/* ---- behind the C API ---- */

static void check(const gtx_export_desc &desc)
{
    require_zeroed(desc.reserved);
    require_limits(desc.limits);
    require_argument(desc.lods <= 1 && desc.collision <= 1 && desc.without_asset <= 1,
                     "lods, collision and without_asset are 0 or 1");
    require_argument(number_of(desc.compress) <= GTX_EXPORT_DRACO, "unknown compression");
    require_argument(number_of(desc.textures) <= GTX_EXPORT_KTX2, "unknown kind of textures");
    require_argument(desc.threads <= 1024, "threads is at most 1024");
    require_argument(desc.max_error >= 0 && std::isfinite(desc.max_error),
                     "max_error is finite and not negative");
    require_argument(!(desc.max_error > 0) || !desc.level,
                     "level and max_error exclude each other");
    require_argument(!desc.collision || !desc.lods, "lods and collision exclude each other");
}

static std::string write_report(const Exported &made, const Task &task, double seconds, Json &json)
{
    gtx_json_begin_object(&json, nullptr);
    gtx_json_begin_array(&json, "levels");
    for (const ExportedLevel &level : made.levels) {
        gtx_json_begin_object(&json, nullptr);
        gtx_json_integer(&json, "level", level.level);
        gtx_json_integer(&json, "triangles", level.triangles);
        gtx_json_integer(&json, "vertices", level.vertices);
        gtx_json_number(&json, "error", level.error);
        gtx_json_end_object(&json);
    }
    gtx_json_end_array(&json);
    gtx_json_integer(&json, "images", made.images);
    gtx_json_integer(&json, "bytes", made.file.size());
    gtx_json_number(&json, "seconds", seconds);
    write_warnings(json, task.warnings);
    gtx_json_end_object(&json);
    check_written(json);
    char line[160];
    snprintf(line, sizeof line,
             "LOD mesh %u, %zu triangles, %zu vertices%s, %zu images, %zu bytes, %.2f s",
             made.levels[0].level, made.levels[0].triangles, made.levels[0].vertices,
             made.levels.size() > 1 ? ", and coarser ones" : "", made.images, made.file.size(),
             seconds);
    return line;
}

/* The file, and a report where one is wanted. */
static Bytes exported(std::string_view data, const gtx_export_desc &desc,
                      std::unique_ptr<Report> *report)
{
    const auto start = std::chrono::steady_clock::now();
    const gtx_allocator allocator = gtx_allocator_or_default(desc.allocator);
    Task task(desc.threads, desc.progress, desc.progress_user, {"open", "mesh", "maps", "write"},
              {20, 50, 28, 2}, desc.limits);
    task.begin("open");
    task.limits.read("", data.size());
    const std::string_view bytes = asset_in(data);
    const Asset asset = open_asset(bytes, allocator, desc.limits);
    ExportOptions options;
    options.level = chosen_level(asset.get(), desc);
    options.lods = desc.lods;
    options.collision = desc.collision;
    options.with_asset = !desc.without_asset;
    options.meshopt = number_of(desc.compress) == GTX_EXPORT_MESHOPT;
    options.draco = number_of(desc.compress) == GTX_EXPORT_DRACO;
    options.ktx2 = number_of(desc.textures) == GTX_EXPORT_KTX2;
    Exported made = export_glb(asset.get(), bytes, options, task);
    task.end();
    if (report) {
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        Json json(allocator);
        const std::string line = write_report(made, task, seconds, json);
        *report = std::make_unique<Report>(json, line, Vector<std::string>(), task.warnings);
    }
    return std::move(made.file);
}

static void export_memory(std::string_view data, const gtx_export_desc &desc, void **out,
                          size_t *out_size, gtx_report *report)
{
    check(desc);
    std::unique_ptr<Report> made;
    const Bytes file = exported(data, desc, report ? &made : nullptr);
    const gtx_allocator allocator = gtx_allocator_or_default(desc.allocator);
    void *copy = gtx_alloc_array(&allocator, file.size(), 1);
    if (!copy)
        throw std::bad_alloc();
    std::memcpy(copy, file.data(), file.size());
    *out = copy;
    *out_size = file.size();
    if (report)
        made->hand_over(report);
}

static void export_file(const char *input, const char *output, const gtx_export_desc &desc,
                        gtx_report *report)
{
    check(desc);
    require_argument(!gtx_same_file(input, output), "the asset and the output are one file");
    const FileBytes file(input, gtx_allocator_or_default(desc.allocator), desc.limits);
    std::unique_ptr<Report> made;
    const Bytes glb = exported(file.view(), desc, report ? &made : nullptr);
    gtx_error error;
    require_ok(gtx_write_file(output, glb.data(), glb.size(), &error), error);
    if (report)
        made->hand_over(report);
}

} // namespace gtx

gtx_result gtx_export_memory(const void *data, size_t size, const gtx_export_desc *desc, void **out,
                             size_t *out_size, gtx_report *report, gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(data && out && out_size,
                              "gtx_export_memory needs bytes and places for the result");
        const std::string_view bytes(static_cast<const char *>(data), size);
        gtx::export_memory(bytes, desc ? *desc : gtx_export_desc{}, out, out_size, report);
    });
}

gtx_result gtx_export_file(const char *input, const char *output, const gtx_export_desc *desc,
                           gtx_report *report, gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(input && output,
                              "gtx_export_file needs an input and an output path");
        gtx::export_file(input, output, desc ? *desc : gtx_export_desc{}, report);
    });
}
