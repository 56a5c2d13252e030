/* Looks the source up in the height fields as readers decode them. */
#include "bake/seam/uncovered.hpp"

#include "bake/budget.hpp"
#include "bake/height_field.hpp"
#include "bake/seam/core.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

namespace gtx::baking {

/* Measured on Spot's control mesh, the truck, Duck and bunny, at half and at double:
 * MAX_BELOW   2 % more texels | 2 % fewer patches       MAX_ABOVE  a few bytes | RMS +8 %
 * MIN_FACING  2 % fewer patches | 2 % more              INSIDE     2 % fewer patches | RMS +1 %
 * SAMPLES     2 % fewer patches | 2 % more
 * SEEN, MAX_OFF, MAX_RELAXED, STEEP and NEEDLE: below 1 % both ways. */

/* A height field shows what it lies no deeper below than this, nor, when it is another chart's,
 * higher above, in texels along the source's normal. */
constexpr double MAX_BELOW = 0.5, MAX_ABOVE = 1;
/* Texels outside its outline to which a height field shows what faces its axis as much, from the
 * side too; a wall shows well inside the outline only. */
constexpr double SEEN = GTX_TRIM_SHOWN / 2, MIN_FACING = 0.15, INSIDE = 0.1;
/* A triangle of fewer square texels that faces away from its own chart by more is twisted inside
 * out: seen from nowhere. Larger ones are seen: without a limit a snapper has 48 hole pixels. With
 * patches for all of them a dirty scan of 810,080 triangles has 901 patches for 654. */
constexpr double TWISTED = -0.4, MAX_TWISTED = 1;
/* Another height field that itself faces a place of the source less only crosses the surface there:
 * the side of a crest ends in its top. At half a terrain (gain .9) has a hole that it has not at
 * this; at double the gargoyle has 2 % more patches. */
constexpr double MIN_ALONG = 0.25;
/* The trim of a height field that is as near as this along the normal is relaxed by so many texels
 * at most. */
constexpr double MAX_OFF = MAX_BELOW / 2, MAX_RELAXED = 1;
constexpr int SPARE = 1; /* trim codes, for rounding */
/* Such a cell that rises farther, in texels of depth from its lowest corner to its highest, has to
 * face as the source does there, by this cosine: else it is a sheet in the air that meets a wall in
 * one place. Without, the gargoyle has 72 wall pixels for 40; 46 at twice the rise or a cosine of
 * 0.7, at half the rise 2 % more patches. */
constexpr double EVEN_RISE = 6, MIN_ALIKE = 0.8;
/* The same of one that a place faces which is steep to its own chart. At half rough terrain has a
 * slit (tests/world/test_rough), at double the gargoyle has 106 wall pixels for 80. */
constexpr double MAX_RELAXED_STEEP = 0.5;
/* What faces its axis less is steep: cells miss it. Another height field that is right there shows
 * it too; and is made for triangles of so many samples along a side, 6 texels. At 8 the gargoyle
 * has 39 % more patches, at 16 a bottle of 960 triangles 6 hole pixels. */
constexpr double STEEP = 0.35;
constexpr int LONG = 12;
/* Samples along a texel. A needle may be as long as its chart: it gets as many as a triangle whose
 * sides are so many texels longer than those of a square of its area. */
constexpr double SAMPLES = 2, NEEDLE = 8;
/* Nodes of its own height field around a triangle that are looked at for each of its samples,
 * before these are: a node takes so much less time. The dragon: 88 % of triangles need no samples,
 * 31 % at a quarter. */
constexpr int NODES = 4;
/* Height fields over a place that are counted: a limit on time. */
constexpr double MAX_OVER = 1024;
/* Likewise, looks that samples are granted. An engine of 82 nodes asks for 489 million, 69 for
 * each, and takes 46; others ask for 10. */
constexpr double LOOKS = 1 << 28, LOOKS_EACH = 64;

namespace {

/* A point of the source, relative to the anchor, and the normal there. */
struct Sample {
    Vec3d point, normal;
};

class Search {
public:
    Search(const Job &job, const Partition &partition, const Vector<PatchMaps> &patches)
        : job_(job), partition_(partition), fields_(patches, job.options.height_bits)
    {
    }

    Gaps run(Task &task) const;

private:
    Vector<Budget> share_looks(Task &task) const;
    int parts_of(uint32_t triangle) const;
    double uncovered_share(size_t field, const FrameInverse &inverse, uint32_t triangle,
                           Budget &budget, Vector<RelaxedTrim> &relaxed) const;
    bool has_cell(const HeightField &field, const Sample &at, double &above) const;
    bool shown_by_another(const HeightField &field, const Sample &at) const;
    Vector<const HeightField *> facing_near(const Vec3d (&corner)[3], const Vec3d &normal,
                                            Budget &budget) const;
    bool shown_by_any(Vector<const HeightField *> &near, const Sample &at, double min_facing,
                      Budget &budget) const;
    std::optional<RelaxedTrim> find_hidden(const Vector<const HeightField *> &near,
                                           const Sample &at, double min_facing, double most,
                                           Budget &budget) const;

    const Job &job_;
    const Partition &partition_;
    const HeightFields fields_;
};

/* Whether a height field has a cell there that is not hidden, and how far that is above it, in
 * texels along its axis. */
bool Search::has_cell(const HeightField &field, const Sample &at, double &above) const
{
    const double cosine = dot(at.normal, field.axis[2]), facing = field.facing(at.normal);
    double trim;
    if (facing < 0 || !field.field_above(at.point, above, trim) ||
        trim > (facing < MIN_FACING ? -INSIDE : SEEN))
        return false;
    above *= (cosine < 0 ? -1 : 1) / job_.pitch;
    return above * facing >= -MAX_BELOW;
}

/* The way along the source's normal is as long as the source is even, or as the height field is:
 * neither is where they cross. */
bool Search::shown_by_another(const HeightField &field, const Sample &at) const
{
    double above;
    if (!has_cell(field, at, above) || above * field.facing(at.normal) > MAX_ABOVE)
        return false;
    const Vec3d normal = field.normal(field.place_of(at.point));
    const double cosine = dot(at.normal, field.axis[2]);
    const double along = dot(at.normal, normal) * (cosine < 0 ? -1 : 1);
    const double way = above * dot(normal, field.axis[2]) / along;
    return along >= MIN_ALONG && way >= -MAX_BELOW && way <= MAX_ABOVE;
}

/* The height fields that may show what of a triangle there is, as long as the budget lasts. */
Vector<const HeightField *> Search::facing_near(const Vec3d (&corner)[3], const Vec3d &normal,
                                                Budget &budget) const
{
    Box box;
    for (const Vec3d &p : corner)
        box.add(p);
    Vector<const HeightField *> near;
    fields_.any_near(box, MAX_ABOVE * job_.pitch, [&](const HeightField &field) {
        budget.spend(1);
        cancel_point();
        if (field.facing(normal) >= 0)
            near.push_back(&field);
        return budget.spent();
    });
    return near;
}

/* Also where the budget is spent before one is found, which is the first for the next sample. */
bool Search::shown_by_any(Vector<const HeightField *> &near, const Sample &at, double min_facing,
                          Budget &budget) const
{
    for (const HeightField *&field : near) {
        budget.spend(1);
        cancel_point();
        if (budget.spent())
            break;
        if (field->facing(at.normal) < min_facing || !shown_by_another(*field, at))
            continue;
        std::swap(field, near[0]);
        return true;
    }
    return budget.spent();
}

/* Whether a cell that has this place meets the source here and is away from it beside. */
bool is_sheet(const HeightField &field, const Sample &at)
{
    const CellPoint place = field.place_of(at.point);
    return field.rise(place.cell) > EVEN_RISE * field.texel() &&
           std::abs(dot(at.normal, field.normal(place))) < MIN_ALIKE;
}

/* The cell of a height field that is right there, and hidden by its trim alone, of less than `most`
 * texels: the one that is hidden least, of those that what is there faces as much. */
std::optional<RelaxedTrim> Search::find_hidden(const Vector<const HeightField *> &near,
                                               const Sample &at, double min_facing, double most,
                                               Budget &budget) const
{
    const HeightField *found = nullptr;
    double least = most;
    for (const HeightField *field : near) {
        const double facing = field->facing(at.normal);
        double above, trim;
        budget.spend(1);
        cancel_point();
        if (facing >= min_facing && field->field_above(at.point, above, trim) &&
            std::abs(above * facing) <= MAX_OFF * job_.pitch &&
            (trim < least ||
             (trim == least && (!found || fields_.is_before(*found, *field)))) &&
            !is_sheet(*field, at)) {
            least = trim;
            found = field;
        }
        if (budget.spent())
            break;
    }
    if (!found)
        return {};
    const int by = int(std::ceil((least - SEEN) * GTX_TRIM_TEXEL)) + SPARE;
    return RelaxedTrim{fields_.patch(*found), found->place_of(at.point).cell, by};
}

/* What a material cuts away is not missed. */
bool is_masked(const Mesh &mesh, uint32_t triangle)
{
    const Appearance &a = mesh.appearance;
    return !a.material.empty() && a.materials[a.material[triangle]].alpha_cutoff > 0;
}

/* Samples along a side of a triangle. */
int Search::parts_of(uint32_t triangle) const
{
    const Mesh &mesh = job_.mesh;
    const Vec3d first = mesh.position(triangle, 0) - job_.anchor;
    const Vec3d e = mesh.position(triangle, 1) - job_.anchor - first;
    const Vec3d f = mesh.position(triangle, 2) - job_.anchor - first;
    const double square = std::max({dot(e, e), dot(f, f), dot(f - e, f - e)});
    double longest = std::sqrt(square) / job_.pitch;
    if (longest > NEEDLE)
        longest = std::min(longest,
                           NEEDLE + std::sqrt(length(cross(e, f)) / 2) / job_.pitch);
    return std::max(1, int(std::ceil(SAMPLES * longest)));
}

/* How much of a triangle no height field shows, 0..1, once trims are `relaxed`. */
double Search::uncovered_share(size_t field, const FrameInverse &inverse, uint32_t triangle,
                               Budget &budget, Vector<RelaxedTrim> &relaxed) const
{
    const Mesh &mesh = job_.mesh;
    const HeightField &own = fields_[field];
    const Chart &chart = partition_.charts[fields_.patch(field)];
    if (beyond_cut(chart, inverse, mesh, triangle, job_.pitch))
        return 0;
    const Vec3d first = mesh.position(triangle, 0) - job_.anchor;
    const Vec3d e = mesh.position(triangle, 1) - job_.anchor - first;
    const Vec3d f = mesh.position(triangle, 2) - job_.anchor - first;
    const Vec3d normal = normalize(cross(e, f));
    const double facing = own.facing(normal), area = length(cross(e, f)) / 2;
    const bool twisted = dot(normal, own.axis[2]) < TWISTED;
    if (is_masked(mesh, triangle) || (twisted && area < MAX_TWISTED * job_.pitch * job_.pitch))
        return 0;
    const bool steep = facing < STEEP;
    const int parts = parts_of(triangle), samples = parts * (parts + 1) / 2;
    if (!steep && own.surely_shows({first, first + e, first + f},
                                   MAX_BELOW * job_.pitch / facing, SEEN, NODES * samples))
        return 0;
    std::optional<Vector<const HeightField *>> near;
    int uncovered = 0;
    for (int j = 0; j < parts; ++j) {
        cancel_point();
        const Vec3d across = f * ((j + 1 / 3.) / parts);
        for (int i = 0; i + j < parts; ++i) {
            const Sample at = {first + e * ((i + 1 / 3.) / parts) + across, normal};
            double above;
            if (!in_core(chart, inverse, at.point + job_.anchor))
                continue;
            const bool by_own = has_cell(own, at, above);
            if (by_own && !steep)
                continue;
            if (!near)
                near = facing_near({first, first + e, first + f}, normal, budget);
            if (shown_by_any(*near, at, steep ? STEEP : 0, budget))
                continue;
            std::optional<RelaxedTrim> hidden;
            if (steep) /* a steep one's own cells miss it, though its trim hides nothing */
                hidden = find_hidden(*near, at, STEEP, MAX_RELAXED_STEEP, budget);
            if (!hidden)
                hidden = find_hidden(*near, at, MIN_FACING, MAX_RELAXED, budget);
            /* one that is steep there, too, and hides nothing misses it as the own one does */
            if (hidden && (by_own || hidden->by > SPARE))
                relaxed.push_back(*hidden);
            else
                uncovered += !by_own || parts >= LONG;
        }
    }
    return uncovered / double(samples);
}

/* Looks at the others for the samples of each height field. */
Vector<Budget> Search::share_looks(Task &task) const
{
    Vector<double> samples(fields_.size()), over(fields_.size());
    task.parallel(fields_.size(), [&](size_t s) {
        for (uint32_t t : partition_.charts[fields_.patch(s)].triangles) {
            const int parts = parts_of(t);
            samples[s] += parts * (parts + 1.) / 2;
        }
        const Vec3d middle = (fields_[s].box.low + fields_[s].box.high) * 0.5;
        fields_.any_near(middle, 0, [&](const HeightField &) {
            cancel_point();
            return ++over[s] == MAX_OVER;
        });
    }, 0, 0);
    double all = 0, wanted = 0;
    for (size_t s = 0; s < samples.size(); ++s) {
        all += samples[s];
        wanted += samples[s] * over[s];
    }
    Vector<Budget> out;
    for (double of_field : samples)
        out.emplace_back(looks_each(all, wanted, LOOKS, LOOKS_EACH) * of_field);
    return out;
}

Gaps Search::run(Task &task) const
{
    Vector<Gaps> of_field(fields_.size());
    Vector<Budget> budgets = share_looks(task);
    task.parallel(fields_.size(), [&](size_t s) {
        Budget &budget = budgets[s];
        const FrameInverse inverse(partition_.charts[fields_.patch(s)].frame);
        for (uint32_t t : partition_.charts[fields_.patch(s)].triangles) {
            const double share = uncovered_share(s, inverse, t, budget, of_field[s].relaxed);
            if (!(share > 0))
                continue;
            const double area = length(job_.mesh.area_vector(t)) / (2 * job_.pitch * job_.pitch);
            of_field[s].uncovered.push_back({t, fields_.patch(s), share * area});
        }
    });
    Gaps all;
    for (const Gaps &some : of_field) {
        all.relaxed.insert(all.relaxed.end(), some.relaxed.begin(), some.relaxed.end());
        all.uncovered.insert(all.uncovered.end(), some.uncovered.begin(), some.uncovered.end());
    }
    std::sort(all.uncovered.begin(), all.uncovered.end(),
              [](const Uncovered &a, const Uncovered &b) {
                  return std::tie(a.triangle, a.chart) < std::tie(b.triangle, b.chart);
              });
    auto same = [](const Uncovered &a, const Uncovered &b) { return a.triangle == b.triangle; };
    all.uncovered.erase(std::unique(all.uncovered.begin(), all.uncovered.end(), same),
                        all.uncovered.end());
    return all;
}

} // namespace

Gaps find_gaps(const Job &job, const Partition &partition, const Vector<PatchMaps> &patches,
               Task &task)
{
    return Search(job, partition, patches).run(task);
}

} // namespace gtx::baking
