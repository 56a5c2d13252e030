/* Finds where outlines lie and what they should lie on. */
#include "bake/seam/ties.hpp"

namespace gtx::baking {

/* Texels outside its outline to which a height field counts: 0.6 % RMS at most (truck). */
constexpr double REACHED = GTX_TRIM_SHOWN + 0.2;
/* Points for a texel of an outline's length, and texels of it that count in a cell. Spot's control
 * mesh: RMS -2 % at half, +1 % at double; LONGEST is a limit. */
constexpr int POINTS = 4, LONGEST = 8;
/* Of a short loop, that take as long as a look at a height field. */
constexpr size_t LOOK_TURNS = 8;

/* Where an outline that is not the model's own border crosses a cell with codes: from one of its
 * sides to another. */
static bool find_crossing(const HeightField &field, int i, int j, double from[2], double to[2])
{
    static const int RING[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    double trim[5];
    const bool inside = field.trim(field.at(i, j)) <= GTX_TRIM_OUTLINE;
    if (inside == (field.trim(field.at(i + 1, j)) <= GTX_TRIM_OUTLINE) &&
        inside == (field.trim(field.at(i + 1, j + 1)) <= GTX_TRIM_OUTLINE) &&
        inside == (field.trim(field.at(i, j + 1)) <= GTX_TRIM_OUTLINE))
        return false;
    for (int k = 0; k < 5; ++k) {
        const size_t texel = field.at(i + RING[k][0], j + RING[k][1]);
        if (!field.code(texel) || field.at_border(texel))
            return false;
        trim[k] = double(field.trim(texel)) - GTX_TRIM_OUTLINE;
    }
    int count = 0;
    for (int k = 0; k < 4; ++k) {
        if ((trim[k] <= 0) == (trim[k + 1] <= 0))
            continue;
        double *out = count++ ? to : from;
        for (int axis = 0; axis < 2; ++axis)
            out[axis] = RING[k][axis] +
                        (RING[k + 1][axis] - RING[k][axis]) * trim[k] / (trim[k] - trim[k + 1]);
    }
    return count > 0;
}

/* How far apart the ends of a tie are now, of which the first is at `point`; false where the other
 * height field has no cell there. */
static bool measure(const Vec3d &point, Tie &tie)
{
    End &end = tie.end[0], &on = tie.end[1];
    double above, trim;
    if (!on.field->field_above(point, above, trim) || trim > REACHED)
        return false;
    on.place = on.field->place_of(point);
    const Vec3d facing = on.field->normal(on.place);
    on.lever = dot(facing, on.field->axis[2]);
    end.lever = -dot(facing, end.field->axis[2]);
    tie.gap = above * on.lever;
    return true;
}

static Vec3d end_of(const Tie &tie)
{
    return tie.end[0].field->point(tie.end[0].place);
}

/* A tie that looks for its end: where it begins, and how near the nearest height field is. */
struct Loose {
    Tie *tie;
    Vec3d point;
    double nearest;
};

/* Ties what is near enough to the nearest height field, and the others to none. They are of one
 * cell, and look at each height field together: in its maps they look at the same place. */
static void find_ends(const Vector<const HeightField *> &others, const TieLimits &limits,
                      Vector<Loose> &loose)
{
    for (Loose &one : loose) {
        *one.tie = {{one.tie->end[0], {}}};
        one.point = end_of(*one.tie);
        one.nearest = limits.apart;
    }
    cancel_point(LOOK_TURNS * others.size() * loose.size());
    for (const HeightField *other : others)
        for (Loose &one : loose) {
            Tie trial = {{one.tie->end[0], {other}}};
            if (!measure(one.point, trial) || std::abs(trial.gap) >= one.nearest)
                continue;
            one.nearest = std::abs(trial.gap);
            trial.slack = limits.slack * std::max(trial.end[0].field->step, other->step);
            *one.tie = trial;
        }
}

Vector<Tie> sample_outline(const HeightField &own)
{
    Vector<Tie> ties;
    for (int j = 0; j + 1 < own.h; ++j) {
        for (int i = 0; i + 1 < own.w; ++i) {
            double from[2], to[2];
            if (!find_crossing(own, i, j, from, to))
                continue;
            const Vec3d span = own.point({own.at(i, j), to[0], to[1]}) -
                               own.point({own.at(i, j), from[0], from[1]});
            const double texels = length(span) / own.texel() + 0.5;
            const int points = POINTS * int(std::clamp(texels, 1., double(LONGEST)));
            for (int n = 0; n < points; ++n) {
                const double along = (n + 0.5) / points;
                const CellPoint place = {own.at(i, j), from[0] + (to[0] - from[0]) * along,
                                     from[1] + (to[1] - from[1]) * along};
                ties.push_back({{{&own, place}, {}}});
            }
        }
    }
    return ties;
}

/* Finds those whose maps reach to the part of an outline between two ties. */
static void find_reaching(const Vector<const HeightField *> &others, double apart,
                          const Tie &first, const Tie &last, Vector<const HeightField *> &out)
{
    cancel_point(4 * others.size());
    const HeightField &own = *first.end[0].field;
    const Vec3d from = own.point(first.end[0].place), to = own.point(last.end[0].place);
    Box box;
    box.add(from);
    box.add(to);
    out.clear();
    std::copy_if(others.begin(), others.end(), std::back_inserter(out),
                 [&](const HeightField *other) {
                     return other->box.is_near(box, apart) && other->reaches(from, to);
                 });
}

/* What it takes to tell of so many whether they reach somewhere: a look at a map takes longer. */
static double reach_looks(size_t others)
{
    return double(others) / 8;
}

double looks_of(const Vector<const HeightField *> &others, const TieLimits &limits,
                const Vector<Tie> &ties)
{
    constexpr size_t EVERY = 8; /* cell: time against accuracy */
    double looks = 0;
    size_t cells = 0;
    Vector<const HeightField *> near;
    for (auto from = ties.begin(), to = from; from != ties.end(); from = to) {
        while (to != ties.end() && to->end[0].place.cell == from->end[0].place.cell)
            ++to;
        if (cells++ % EVERY)
            continue;
        find_reaching(others, limits.apart, *from, *(to - 1), near);
        looks += EVERY * (reach_looks(others.size()) + double(near.size() * size_t(to - from)));
    }
    return looks;
}

Vector<const Tie *> update_ties(const Vector<const HeightField *> &others,
                                const TieLimits &limits, Budget budget, Vector<Tie> &ties)
{
    Vector<const Tie *> open;
    Vector<Loose> loose;
    Vector<const HeightField *> near;
    for (auto from = ties.begin(), to = from; from != ties.end(); from = to) {
        loose.clear();
        for (; to != ties.end() && to->end[0].place.cell == from->end[0].place.cell; ++to)
            if (to->moves && (!to->end[1].field || !measure(end_of(*to), *to) || to->is_open()))
                loose.push_back({&*to, {}, 0});
        if (loose.empty())
            continue;
        near.clear();
        const bool may_reach = !budget.spent() && budget.grants(reach_looks(others.size()));
        if (may_reach)
            find_reaching(others, limits.apart, *from, *(to - 1), near);
        if (!may_reach || !budget.grants(double(near.size() * loose.size())))
            near.clear(); /* they are tied to nothing */
        find_ends(near, limits, loose);
        for (const Loose &one : loose)
            if (one.tie->is_open())
                open.push_back(one.tie);
    }
    return open;
}

} // namespace gtx::baking
