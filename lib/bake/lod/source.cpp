/* Which surface the LOD mesh is made of: the triangles that the maps show, each with its patch. */
#include "bake/lod/fields.hpp"
#include "mesh/clean/clean.hpp"

#include <algorithm>
#include <memory>

namespace gtx {

using namespace baking;

/* The patch of each triangle of the mesh. */
static Vector<uint32_t> patches_of(const Partition &partition, const Maps &maps,
                                   const Vector<ChartCuts> &cuts,
                                   const LodSource &source, Task &task)
{
    Vector<Vector<double>> outside(cuts.size());           /* of the triangles of a chart */
    task.parallel(cuts.size(), [&](size_t p) {
        if (!cuts[p].any())
            return;
        for (uint32_t t : partition.charts[maps.charts[p]].triangles)
            outside[p].push_back(cuts[p].outside(cuts[p].place(source.centre(t))));
    }, 0, 0);

    Vector<uint32_t> patch(source.triangles.size(), NO_PATCH);
    Vector<double> least(source.triangles.size(), INFINITY);
    for (size_t p = 0; p < cuts.size(); ++p) {
        const Vector<uint32_t> &triangles = partition.charts[maps.charts[p]].triangles;
        for (size_t i = 0; i < triangles.size(); ++i) {
            const uint32_t t = triangles[i];
            if (cuts[p].any() && outside[p][i] >= least[t])
                continue;
            patch[t] = uint32_t(p);
            if (cuts[p].any())
                least[t] = outside[p][i];
        }
    }
    return patch;
}

/* A patch without a normal under any part of a triangle does not show it: its material cuts it
 * away. */
static bool shown(const PatchRegion &region, const LodSource &source, size_t triangle)
{
    bool held = region.holds(region.place(source.centre(triangle)));
    for (uint32_t v : source.triangles[triangle])
        held = held || region.holds(region.place(source.positions[v]));
    return held;
}

static void drop_hidden(const Vector<PatchRegion> &regions, LodSource &source, Task &task)
{
    const size_t count = source.triangles.size(), chunk = 4096;
    Vector<uint8_t> kept(count, 0);
    task.parallel((count + chunk - 1) / chunk, [&](size_t n) {
        for (size_t t = n * chunk; t < std::min(count, (n + 1) * chunk); ++t)
            kept[t] = source.patch[t] != NO_PATCH && shown(regions[source.patch[t]], source, t);
    }, 0, 0);
    size_t left = 0;
    for (size_t t = 0; t < count; ++t) {
        if (!kept[t])
            continue;
        source.triangles[left] = source.triangles[t];
        source.patch[left++] = source.patch[t];
    }
    source.triangles.resize(left);
    source.patch.resize(left);
}

/* Height fields that meet have vertices of their own in a mesh. Here they have the same: they must
 * not part when they get fewer triangles. */
static LodSource joined(const Mesh &mesh, const Vec3d &anchor, Task &task)
{
    Mesh places;
    places.positions = mesh.positions;
    places.triangles = mesh.triangles;
    weld(places, &task);
    for (Vec3d &p : places.positions)
        p = p - anchor;
    LodSource source;
    source.positions = std::move(places.positions);
    source.triangles = std::move(places.triangles);
    return source;
}

LodSource lod_source(const Mesh &mesh, const Partition &partition, const Maps &maps,
                     Task &task)
{
    task.begin("lod");
    const Vec3d anchor(maps.anchor[0], maps.anchor[1], maps.anchor[2]);
    LodSource source = joined(mesh, anchor, task);
    Vector<ChartCuts> cuts;
    for (uint32_t chart : maps.charts)
        cuts.emplace_back(partition.charts[chart], anchor);
    source.patch = patches_of(partition, maps, cuts, source, task);
    Vector<PatchRegion> regions = patch_regions(maps, task);
    split_at_cuts(partition, maps, cuts, regions, source, task);
    drop_hidden(regions, source, task);
    source.regions = std::make_shared<const Vector<PatchRegion>>(std::move(regions));
    return source;
}

LodSource lod_source(const Maps &maps, Task &task)
{
    task.begin("lod");
    const Vector<MapField> fields = map_fields(maps);
    const Vector<Vector<uint32_t>> others = touching(fields);
    Vector<FieldPiece> pieces(fields.size());
    task.parallel(fields.size(), [&](size_t p) {
        pieces[p] = cut_field(fields, uint32_t(p), others[p]);
    }, 0, 0.3);
    return weld(fields, std::move(pieces), others);
}

} // namespace gtx
