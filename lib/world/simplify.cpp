/* A tile's surface with fewer triangles, for its parent; its border stays. */
#include "world/surface.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <cfloat>

namespace gtx {

namespace {

/* The own triangles by place, and what a place has. */
struct Places {
    Vector<uint32_t> indices;        /* three a triangle; of vertices, the first at each */
    Vector<Vec3f> positions;         /* relative to the middle */
    Vector<Vec3f> normals;
    Vector<Rgba8> colors;
};

Places places_of(const TileSurface &s)
{
    Places out;
    const Vec3d middle = (s.header.low + s.header.high) / 2;
    Vector<std::array<double, 5>> sums(s.positions.size());
    Vector<Vec3d> normals(s.positions.size());
    for (size_t v = 0; v < s.positions.size(); ++v) {
        const Rgba8 &c = s.colors[v];
        const double values[5] = {double(c.r), double(c.g), double(c.b), double(c.a), 1};
        for (size_t k = 0; k < 5; ++k)
            sums[s.place[v]][k] += values[k];
        normals[s.place[v]] += Vec3d(s.normals[v]);
    }
    for (size_t v = 0; v < s.positions.size(); ++v) {
        const auto &sum = sums[s.place[v]];
        auto mean = [&](size_t k) { return uint8_t(sum[k] / sum[4] + 0.5); };
        out.positions.push_back(Vec3f(s.positions[v] - middle));
        out.normals.push_back(Vec3f(normalize(normals[s.place[v]])));
        out.colors.push_back({mean(0), mean(1), mean(2), mean(3)});
    }
    for (size_t t = 0; t < s.own; ++t) {
        const auto &[a, b, c] = s.triangles[t];
        const uint32_t at[3] = {s.place[a], s.place[b], s.place[c]};
        if (at[0] != at[1] && at[1] != at[2] && at[2] != at[0])
            out.indices.insert(out.indices.end(), at, at + 3);
    }
    return out;
}

} // namespace

/* Garland and Heckbert's quadrics (1997) with a locked border. */
static Vector<uint32_t> simplified(const Places &places, size_t wanted)
{
    const Vector<uint32_t> &from = places.indices;
    Vector<uint32_t> out(from.size());
    if (from.size() <= 3 * wanted)
        return from;
    cancel_point();
    const TakenMemory taken(from.size() * 4 * 8 + places.positions.size() * 100);
    out.resize(meshopt_simplify(out.data(), from.data(), from.size(), &places.positions[0].x,
                                places.positions.size(), sizeof(Vec3f), 3 * wanted, FLT_MAX,
                                meshopt_SimplifyLockBorder, nullptr));
    return out;
}

LowSurface simplify_surface(const TileSurface &surface, size_t wanted, Task &task)
{
    const Places places = places_of(surface);
    const Vector<uint32_t> indices = simplified(places, wanted);
    LowSurface out = {CellWriter({surface.traits.doubles, true, surface.traits.colors}), 0};
    Sheet sheet = {surface.positions, {}};
    for (size_t i = 0; i < indices.size(); i += 3) {
        Corners3 corners;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t v = indices[i + k];
            corners[k] = {surface.positions[v], places.normals[v], places.colors[v]};
        }
        out.cell.add(corners);
        sheet.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    }
    if (indices.size() < places.indices.size())
        out.deviation = distance_between(sheet_of(surface, surface.own), surface.own, sheet, task);
    out.cell.header.deviation = surface.header.deviation + out.deviation;
    return out;
}

} // namespace gtx
