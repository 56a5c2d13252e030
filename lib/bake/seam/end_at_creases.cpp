/* Lets height fields end where the surface turns away, if another one is right there.
 *
 * What is shown past an outline closes the way between two height fields that miss each other by a
 * part of a texel. Past a convex crease it stands out of the surface: along the edges of a box of
 * few texels, a rim. How much of it is needed is known once heights are final: as much as the
 * neighbour lies outside the crease. */
#include "bake/height_field.hpp"
#include "bake/seam/seam.hpp"

#include "asset/fill.h"

#include <algorithm>

namespace gtx::baking {

/* Texels of the model that the neighbour may lie inside, and how much it faces what is beyond the
 * crease: bounds, as what of the source is shown has them (uncovered.cpp). */
constexpr double MAX_INSIDE = 0.5, MIN_FACING = 0.15;
/* Points for a texel of an outline's length: the trim is bilinear between texels. */
constexpr double POINTS = 2;
/* Codes up to the limit of what is shown: a point of the core has no higher trim. What is left past
 * a crease is less than one, a twentieth of a texel. */
constexpr int SHOWN = int(GTX_TRIM_SHOWN * GTX_TRIM_TEXEL);

namespace {

/* A point of an outline, and where it is in the map. */
struct EndPoint {
    const EndEdge &edge;
    double at;                   /* along the edge, 0..1 */
    int i, j;
    CellPoint place;
};

/* By how many codes the trim around a point of an outline may rise; `along` and `across` are the
 * normals beside the crease there. */
int rise_at(const HeightFields &fields, const HeightField &own, const Vec3d &point,
            const Vec3d &along, const Vec3d &across, double pitch)
{
    const double cosine = dot(along, across), sine = length(cross(along, across));
    double above, trim;
    if (!own.field_above(point, above, trim) || !(sine > 0))
        return 0;
    const double own_off = above * dot(along, own.axis[2]);
    int most = 0;
    fields.any_near(point, pitch, [&](const HeightField &other) {
        cancel_point();
        const double facing = dot(across, other.axis[2]);
        if (&other == &own || facing < MIN_FACING || !other.field_above(point, above, trim) ||
            trim > GTX_TRIM_SHOWN)
            return false;
        const double off = above * facing;
        if (off < -MAX_INSIDE * pitch)
            return false;
        /* Two lines, each so far off, cross as far beyond the point. */
        const double beyond = std::max(0., off - own_off * cosine) / sine;
        const double codes = std::ceil(beyond / own.texel() * GTX_TRIM_TEXEL);
        most = std::max(most, SHOWN - int(std::min(codes, double(SHOWN))));
        return most == SHOWN;
    });
    return most;
}

class Ends {
public:
    Ends(const Job &job, const HeightFields &fields, const HeightField &own, const PatchMaps &maps)
        : job_(job), fields_(fields), own_(own), maps_(maps)
    {
    }
    /* The new trim. */
    Vector<uint8_t> trim() const;

private:
    template <class Visit> void each_point(Visit visit) const;
    int rise_at_edge(const EndPoint &end) const;
    void show(const CellPoint &place, Vector<uint8_t> &trim) const;

    const Job &job_;
    const HeightFields &fields_;
    const HeightField &own_;
    const PatchMaps &maps_;
};

/* Calls visit(EndPoint) for points along outlines, their ends included, that are in the map. */
template <class Visit> void Ends::each_point(Visit visit) const
{
    constexpr double LONGEST = 1024;
    for (const EndEdge &edge : maps_.ends) {
        const double texels = std::min(length(edge.along_u, edge.along_v), LONGEST);
        const int steps = 1 + int(POINTS * texels);
        for (int s = 0; s <= steps; ++s) {
            cancel_point();
            const double at = double(s) / steps;
            const double u = edge.u + edge.along_u * at, v = edge.v + edge.along_v * at;
            if (!(u >= 0 && v >= 0 && u < own_.w - 1 && v < own_.h - 1))
                continue;
            const int i = int(u), j = int(v);
            visit(EndPoint{edge, at, i, j, {own_.at(i, j), u - i, v - j}});
        }
    }
}

int Ends::rise_at_edge(const EndPoint &end) const
{
    const Mesh &mesh = job_.mesh;
    const uint32_t t = end.edge.triangle;
    const int side = end.edge.side;
    if (!end.edge.crease)
        return 0;
    const Vec3d from = mesh.position(t, side) - job_.anchor;
    const Vec3d to = mesh.position(t, (side + 1) % 3) - job_.anchor;
    return rise_at(fields_, own_, from + (to - from) * end.at, normalize(mesh.area_vector(t)),
                   normalize(mesh.area_vector(job_.neighbours[t][size_t(side)])), job_.pitch);
}

Vector<uint8_t> Ends::trim() const
{
    constexpr uint8_t FREE = 255;
    Vector<uint8_t> rise(maps_.trim.size(), FREE), out = maps_.trim;
    each_point([&](const EndPoint &end) {
        const auto by = uint8_t(rise_at_edge(end));
        for (int y = std::max(end.j - 1, 0); y <= std::min(end.j + 2, own_.h - 1); ++y)
            for (int x = std::max(end.i - 1, 0); x <= std::min(end.i + 2, own_.w - 1); ++x)
                rise[own_.at(x, y)] = std::min(rise[own_.at(x, y)], by);
    });
    for (size_t k = 0; k < out.size(); ++k) {
        const int room = maps_.border[k] & MAX_ROOM;
        if (rise[k] != FREE && room < rise[k])
            out[k] = uint8_t(std::min(out[k] + rise[k] - room, int(GTX_FAR_TRIM)));
    }
    each_point([&](const EndPoint &end) {
        if (end.edge.core)
            show(end.place, out);
    });
    return out;
}

/* What was shown stays so. */
void Ends::show(const CellPoint &place, Vector<uint8_t> &trim) const
{
    double before = 0, after = 0;
    for (size_t k = 0; k < 4; ++k) {
        const size_t at = own_.corner(place, k);
        before += place.weight(k) * maps_.trim[at];
        after += place.weight(k) * trim[at];
    }
    constexpr double MOST = GTX_TRIM_OUTLINE + SHOWN;
    if (before > GTX_TRIM_OUTLINE + SHOWN || after <= MOST)
        return;
    const int less = int(std::ceil(after - MOST));
    for (size_t k = 0; k < 4; ++k) {
        const size_t at = own_.corner(place, k);
        trim[at] = uint8_t(std::max(int(maps_.trim[at]), trim[at] - less));
    }
}

} // namespace

void end_at_creases(const Job &job, Vector<PatchMaps> &patches, Task &task)
{
    const HeightFields fields(patches, job.options.height_bits);
    Vector<Vector<uint8_t>> trims(fields.size());
    task.parallel(fields.size(), [&](size_t i) {
        const PatchMaps &maps = patches[fields.patch(i)];
        if (!maps.ends.empty())
            trims[i] = Ends(job, fields, fields[i], maps).trim();
    });
    for (size_t i = 0; i < fields.size(); ++i) {
        PatchMaps &maps = patches[fields.patch(i)];
        if (trims[i].empty())
            continue;
        maps.trim = std::move(trims[i]);
        fill_trim(maps);
    }
}

} // namespace gtx::baking
