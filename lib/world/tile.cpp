/* The step that cooks one tile: asset, GLB, and the simplified surface for the parent. */
#include "world/facts.hpp"
#include "world/materials.hpp"

#include "cook/models.hpp"
#include "cook/options.hpp"

#include <geotex/cook.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

namespace gtx {

namespace {

using AssetOwner = std::unique_ptr<gtx_asset, void (*)(gtx_asset *)>;

/* One tile on its way. */
struct TileCook {
    const Plan &plan;
    const Tile &tile;
    Task &task;
    gtx_cook_desc desc;
    TileFacts facts;
    Mesh textured;                   /* what is cooked where the surface has textures */

    uint64_t key_of(const TileSurface &surface, size_t wanted) const;
    AssetOwner cook(const TileSurface &surface, std::string &bytes);
    void cook_all(const TileSurface &surface, NearSurface &near);
    void make_low(const TileSurface &surface, NearSurface &near, size_t wanted);
};

} // namespace

template <class T> static uint64_t hash_of(const Vector<T> &items)
{
    return gtx_hash_bytes(items.data(), items.size() * sizeof(T));
}

/* Of the surface, of the tile's share of it, and of all options. */
uint64_t TileCook::key_of(const TileSurface &surface, size_t wanted) const
{
    const uint64_t numbers[] = {
        content_key(checked_options(desc), hash_of(surface.positions)),
        hash_of(surface.triangles), hash_of(surface.normals), hash_of(surface.colors),
        surface.header.hash, surface.own, wanted, plan.glb};
    gtx_hash hash;
    gtx_hash_begin(&hash);
    gtx_hash_add(&hash, numbers, sizeof numbers);
    if (surface.traits.textured) { /* the ring's, and of all images */
        gtx_hash_add(&hash, surface.looks.data(), CornerLook::BYTES * surface.looks.size());
        gtx_hash_add(&hash, &plan.key, sizeof plan.key);
    }
    gtx_hash_add(&hash, &surface.header.deviation, sizeof surface.header.deviation);
    return gtx_hash_end(&hash);
}

/* Null where no triangle has an area. */
AssetOwner TileCook::cook(const TileSurface &surface, std::string &bytes)
{
    gtx_asset *asset = nullptr;
    gtx_report report = {};
    const std::unique_ptr<gtx_report, void (*)(gtx_report *)> report_owner(&report,
                                                                           gtx_report_free);
    gtx_error error;
    const auto make = [&] {
        return surface.traits.textured ? std::move(textured) : mesh_of(surface);
    };
    const gtx_result result =
        cook_made_mesh(make, facts.key, desc, &asset, &bytes, &report, &error);
    AssetOwner owner(asset, gtx_close);
    if (result == GTX_ERROR_EMPTY)
        return owner;
    require_ok(result, error);
    for (size_t i = 0; i < report.warning_count; ++i) { /* a tile has a border: no news */
        const std::string name = report.warning_names[i];
        for (gtx_warning kind : {GTX_WARNING_NONMANIFOLD, GTX_WARNING_DEGENERATE,
                                 GTX_WARNING_DUPLICATE, GTX_WARNING_WINDING})
            if (name == gtx_warning_name(kind))
                task.warn(kind, report.warnings[i]);
    }
    return owner;
}

/* The finest LOD mesh, where the asset has any. */
static PlainMesh finest_mesh(const gtx_asset *asset)
{
    gtx_info info;
    gtx_lod_mesh mesh;
    PlainMesh out;
    gtx_get_info(asset, &info);
    if (!info.lod_levels || gtx_get_lod_mesh(asset, 0, &mesh))
        return out;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        Vec3d p;
        for (int k = 0; k < 3; ++k)
            p[k] = info.anchor[k] + double(mesh.origin[k]) +
                   double(mesh.step) * mesh.positions[3 * v + uint32_t(k)];
        out.positions.push_back(p);
    }
    for (uint32_t t = 0; t < mesh.triangle_count; ++t)
        out.triangles.push_back({mesh.indices[3 * t], mesh.indices[3 * t + 1],
                                 mesh.indices[3 * t + 2]});
    return out;
}

void TileCook::cook_all(const TileSurface &surface, NearSurface &near)
{
    std::string bytes;
    const AssetOwner asset = cook(surface, bytes);
    facts.empty = !asset;
    facts.triangles = surface.own;
    if (!asset) {
        facts.low = surface.header.low;
        facts.high = surface.header.high;
        return;
    }
    gtx_info info;
    gtx_get_info(asset.get(), &info);
    for (const float *corner : {info.bounds_min, info.bounds_max})
        facts.add({info.anchor[0] + double(corner[0]), info.anchor[1] + double(corner[1]),
                   info.anchor[2] + double(corner[2])});
    const PlainMesh finest = finest_mesh(asset.get());
    for (const Vec3d &p : finest.positions)
        facts.add(p);
    facts.lod_triangles = finest.triangles.size();
    facts.error = surface.header.deviation + near.distance_to(finest, true);
    facts.asset = made_of(bytes);
    facts.memory = memory_to_open(bytes);
    facts.beginning = beginning_of(bytes, facts.error, surface.header.deviation);
    write_whole(asset_path(plan, tile), bytes);
    if (plan.glb) {
        const std::string glb = glb_of(finest, near, plan.closed);
        facts.glb = made_of(glb);
        write_whole(glb_path(plan, tile), glb);
    }
}

void TileCook::make_low(const TileSurface &surface, NearSurface &near, size_t wanted)
{
    LowSurface low = simplify_surface(surface, near, wanted, task);
    facts.low_surface = made_of(low.cell.finish());
    write_whole(low_path(plan, tile), low.cell.finish());
}

/* The vertices of the ring. Those that it shares with the tile's own triangles are where the
 * surfaces of neighbours meet, whatever their levels; the others make both overlap. */
static Vector<double> ring_of(const TileSurface &surface)
{
    Vector<uint8_t> is_ring(surface.positions.size(), 0);
    for (size_t t = surface.own; t < surface.triangles.size(); ++t)
        for (uint32_t v : surface.triangles[t])
            is_ring[surface.place[v]] = 1;
    Vector<double> out;
    for (size_t v = 0; v < is_ring.size(); ++v)
        for (int k = 0; k < 3 && is_ring[v]; ++k)
            out.push_back(surface.positions[v][k]);
    return out;
}

StepReport cook_tile(const std::string &folder, const std::string &name, Task &task)
{
    task.begin("read");
    const Plan plan = read_plan(folder, task);
    const Tile &tile = plan.tile(name);
    TileCook job = {plan, tile, task, {}, {}, {}};
    job.desc.unit = float(plan.unit);
    job.desc.closed = plan.closed;
    job.desc.threads = task.threads();
    job.desc.limits = task.limits.given();
    TileSurface surface = load_surface(plan, tile, task);
    const Vector<double> ring = ring_of(surface);
    job.desc.kept = ring.data();
    job.desc.kept_count = ring.size() / 3;
    const size_t wanted = tile.depth ? size_t(plan.low_share(tile) * double(surface.own)) : 0;
    const uint64_t key = job.key_of(surface, wanted);
    try {
        job.facts = read_facts(plan, tile);
    } catch (const Error &) {
        job.facts.key = 0;
    }
    const std::string summary = std::to_string(surface.own) + " triangles, and " +
                                std::to_string(surface.triangles.size() - surface.own) +
                                " around them";
    if (job.facts.key == key && are_there(plan, tile, job.facts, true))
        return {summary, true};
    job.facts = {};
    job.facts.key = key;
    if (surface.traits.textured) {
        job.textured = textured_mesh(plan, surface, task);
        paint_surface(job.textured, surface, task);
    }
    NearSurface near(surface, task);
    task.begin("cook");
    job.cook_all(surface, near);
    task.begin("simplify");
    if (tile.depth)
        job.make_low(surface, near, wanted);
    write_facts(plan, tile, job.facts);
    task.end();
    return {summary, false};
}

} // namespace gtx
