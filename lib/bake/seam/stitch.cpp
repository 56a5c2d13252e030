/* Draws the height fields of neighbouring patches together where they meet.
 *
 * Each is fitted to the source alone, and between its texels it misses that by as much as there is
 * relief. Where one ends on another, what the two miss adds up to a step. So heights around
 * outlines move, as little as they can, until the end of each height field lies on the other: a
 * system of one equation for every point of an outline, solved by projections (Kaczmarz 1937) and
 * set up again where the height fields then are. Texels beyond an outline move first, for nobody
 * sees what they lie on, and those deep inside one last. */
#include "bake/seam/decoded.hpp"
#include "bake/seam/seam.hpp"

namespace gtx::baking {

/* Texels of the model along the normal between two height fields of one surface, and texels outside
 * its outline to which a height field counts. */
constexpr double MAX_APART = 0.6, REACHED = SHOWN + 0.2;
/* What may stay between them, in codes of eight bits: rounding moves either by half of one. */
constexpr double SLACK = 1;
/* How readily texels move that are not beyond an outline, from the first pass to the last. */
constexpr double EASE[] = {0.1, 0.3, 1};
constexpr int ROUNDS = 9; /* in a pass */
/* A coarser texel, as a share of the diagonal, lets heights move no farther: they would be seen as
 * dents. */
constexpr double COARSE = 0.002;
/* Points for a texel of an outline's length, and texels of it that count in a cell. */
constexpr int POINTS = 4, LONGEST = 8;

namespace {

/* How readily a texel moves, and how many of the model's texels up and down its axis at most. What
 * shows goes down less far: over a crest that lies too low a grazing ray passes. */
struct Mobility {
    double ease, up, down;
};
enum Ground : uint8_t { BEYOND, AT_OUTLINE, INSIDE }; /* where a texel is */
using Mobilities = std::array<Mobility, 3>;

Ground ground_of(uint8_t trim)
{
    constexpr uint8_t OUTLINE = 128, TEXEL = 16;
    return trim > OUTLINE ? BEYOND : trim > OUTLINE - TEXEL ? AT_OUTLINE : INSIDE;
}

Mobilities mobilities(double ease)
{
    return {{{1, 1.5, 1.5}, {ease, 1, 0.4}, {0.1 * ease, 0.75, 0.4}}};
}

/* A point where a height field ends, and the place of the other that it should lie on. */
struct End {
    const Decoded *field = nullptr;
    Place place = {};
    double lever = 0;            /* how far the gap opens as it rises */
};
struct Tie {
    End end[2];
    double gap = 0, slack = 0;   /* along the normal of the other */
    bool moves = true;           /* what is around its ends, in this pass */

    bool is_open() const { return std::abs(gap) > slack; }
};

/* Where an outline that is not the model's own border crosses a cell with codes: from one of its
 * sides to another. */
bool find_crossing(const Decoded &field, int i, int j, double from[2], double to[2])
{
    static const int RING[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    double trim[5];
    for (int k = 0; k < 5; ++k) {
        const size_t texel = field.at(i + RING[k][0], j + RING[k][1]);
        if (!field.maps->height[texel] || field.maps->border[texel])
            return false;
        trim[k] = field.maps->trim[texel] - 128.;
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

/* How far apart the ends of a tie are now; false where the other height field has no cell there. */
bool measure(Tie &tie)
{
    End &end = tie.end[0], &on = tie.end[1];
    const Vec3d point = end.field->point(end.place);
    double above, trim;
    if (!on.field || !on.field->field_above(point, above, trim) || trim > REACHED)
        return false;
    on.place = on.field->place_of(point);
    const Vec3d facing = on.field->normal(on.place);
    on.lever = dot(facing, on.field->axis[2]);
    end.lever = -dot(facing, end.field->axis[2]);
    tie.gap = above * on.lever;
    return true;
}

/* What ties go by. */
struct Limits {
    double apart;                /* object units between two height fields that are tied */
    double slack;                /* codes */
};

/* The end of a tie on the nearest height field; none where all are too far. */
void find_end(const std::vector<const Decoded *> &others, const Limits &limits, Tie &tie)
{
    const Decoded &own = *tie.end[0].field;
    double nearest = limits.apart;
    Tie found = {{tie.end[0], {}}};
    for (const Decoded *other : others) {
        Tie trial = {{tie.end[0], {other}}};
        if (!measure(trial) || std::abs(trial.gap) >= nearest)
            continue;
        nearest = std::abs(trial.gap);
        found = trial;
        found.slack = limits.slack * std::max(own.step, other->step);
    }
    tie = found;
}

/* Points along the outline of a height field, tied to nothing yet. */
std::vector<Tie> sample_outline(const Decoded &own)
{
    std::vector<Tie> ties;
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
                const Place place = {own.at(i, j), from[0] + (to[0] - from[0]) * along,
                                     from[1] + (to[1] - from[1]) * along};
                ties.push_back({{{&own, place}, {}}});
            }
        }
    }
    return ties;
}

/* Those whose maps reach to the part of an outline between two ties. */
std::vector<const Decoded *> reaching(const std::vector<const Decoded *> &others, const Tie &first,
                                      const Tie &last)
{
    const Decoded &own = *first.end[0].field;
    const Vec3d from = own.point(first.end[0].place), to = own.point(last.end[0].place);
    std::vector<const Decoded *> out;
    std::copy_if(others.begin(), others.end(), std::back_inserter(out),
                 [&](const Decoded *other) { return other->reaches(from, to); });
    return out;
}

/* Ties what is tied to nothing, or to what it does not lie on; measures the others that moved.
 * Returns those that are open. */
std::vector<const Tie *> update_ties(const std::vector<const Decoded *> &others,
                                     const Limits &limits, std::vector<Tie> &ties)
{
    std::vector<const Tie *> open;
    std::vector<Tie *> loose;
    for (auto from = ties.begin(), to = from; from != ties.end(); from = to) {
        loose.clear();
        for (; to != ties.end() && to->end[0].place.cell == from->end[0].place.cell; ++to)
            if (to->moves && (!measure(*to) || to->is_open()))
                loose.push_back(&*to);
        if (loose.empty())
            continue;
        const std::vector<const Decoded *> near = reaching(others, *from, *(to - 1));
        for (Tie *tie : loose) {
            find_end(near, limits, *tie);
            if (tie->is_open())
                open.push_back(tie);
        }
    }
    return open;
}

/* How far the texels of every height field have moved along its axis, object units. */
class Moves {
public:
    Moves(const HeightFields &fields, std::vector<PatchMaps> &patches, unsigned height_bits,
          double texel, Task &task)
        : fields_(fields), patches_(patches), top_(height_bits == 8 ? 255 : 65535),
          texel_(texel), texels_(patches.size()), equations_(patches.size())
    {
        task.parallel(patches.size(), [&](size_t i) {
            texels_[i].reserve(patches[i].trim.size());
            for (uint8_t trim : patches[i].trim)
                texels_[i].push_back({0, 0, false, ground_of(trim)});
        });
    }
    /* `open` are those of the ties that are. */
    void solve(const std::vector<std::vector<const Tie *>> &open,
               std::vector<std::vector<Tie>> &ties, double ease, Task &task);
    /* Rounds a height field to codes. */
    void apply(size_t field);

private:
    struct Texel {
        float moved = 0, applied = 0; /* all, and what of it is in the maps */
        bool eased = false;           /* by the end of a tie that is open, in this pass */
        Ground ground = BEYOND;
    };
    /* A tie, and where the texels around its ends are: the first of two rows of two. */
    struct Equation {
        const Tie *tie;
        Texel *first[2];
        uint32_t width[2];
        double give;                  /* how far the gap opens as all move as they like to */

        Texel &texel(size_t n) const { return first[n / 4][(n & 1) + (n >> 1 & 1) * width[n / 4]]; }
        /* How far the gap opens as a texel rises. */
        double lever(size_t n) const
        {
            return tie->end[n / 4].lever * tie->end[n / 4].place.weight(n % 4);
        }
    };
    Texel &texel(const Tie &tie, size_t n)
    {
        const End &end = tie.end[n / 4];
        return texels_[fields_.index(*end.field)][end.field->corner(end.place, n % 4)];
    }
    Equation equation_of(const Tie &tie, const Mobilities &mobility);
    void project(const Equation &equation, const Mobilities &mobility) const;

    const HeightFields &fields_;
    std::vector<PatchMaps> &patches_;
    const double top_, texel_; /* the largest code; a texel of the model, object units */
    std::vector<std::vector<Texel>> texels_;
    std::vector<std::vector<Equation>> equations_; /* of this pass, by the height fields that end */
};

Moves::Equation Moves::equation_of(const Tie &tie, const Mobilities &mobility)
{
    Equation out = {&tie, {&texel(tie, 0), &texel(tie, 4)}, {}, 0};
    for (size_t k = 0; k < 2; ++k)
        out.width[k] = uint32_t(tie.end[k].field->w);
    for (size_t n = 0; n < 8; ++n) {
        const double lever = out.lever(n);
        out.give += lever * (mobility[out.texel(n).ground].ease * lever);
    }
    return out;
}

/* Ties that are closed, and stay so whatever the open ones do, are no part of it. */
void Moves::solve(const std::vector<std::vector<const Tie *>> &open,
                  std::vector<std::vector<Tie>> &ties, double ease, Task &task)
{
    const Mobilities mobility = mobilities(ease);
    for (const std::vector<const Tie *> &some : open)
        for (const Tie *tie : some)
            for (size_t n = 0; n < 8; ++n)
                texel(*tie, n).eased = true;
    task.parallel(ties.size(), [&](size_t i) {
        equations_[i].clear();
        for (Tie &tie : ties[i]) {
            tie.moves = !tie.end[1].field;
            for (size_t n = 0; n < 8 && !tie.moves; ++n)
                tie.moves = texel(tie, n).eased;
            if (tie.moves && tie.end[1].field)
                equations_[i].push_back(equation_of(tie, mobility));
        }
    });
    for (int round = 0; round < ROUNDS; ++round)
        for (const std::vector<Equation> &some : equations_)
            for (const Equation &equation : some)
                project(equation, mobility);
}

/* Closes a gap, but for its slack, by the least squares of what the texels around both ends move.
 */
void Moves::project(const Equation &e, const Mobilities &mobility) const
{
    const double slack = e.tie->slack;
    double lever[8], gap = e.tie->gap;
    for (size_t n = 0; n < 8; ++n) {
        lever[n] = e.lever(n);
        gap += lever[n] * double(e.texel(n).moved - e.texel(n).applied);
    }
    if (std::abs(gap) <= slack)
        return;
    const double share = (gap - std::copysign(slack, gap)) / e.give;
    for (size_t n = 0; n < 8; ++n) {
        Texel &texel = e.texel(n);
        const Mobility &own = mobility[texel.ground];
        texel.moved = float(std::clamp(texel.moved - share * (own.ease * lever[n]),
                                       -own.down * texel_, own.up * texel_));
    }
}

void Moves::apply(size_t field)
{
    const double step = fields_[field].step;
    for (size_t k = 0; k < texels_[field].size(); ++k) {
        Texel &texel = texels_[field][k];
        uint16_t &code = patches_[field].height[k];
        if (code && texel.moved != texel.applied) {
            const double wanted = code + (texel.moved - texel.applied) / step;
            const double got = std::clamp(std::floor(wanted + 0.5), 1., top_);
            texel.applied += float((got - code) * step);
            texel.moved = texel.applied;
            code = uint16_t(got);
        }
        texel.eased = false;
    }
}

/* Of the box around them. */
double diagonal_of(const std::vector<PatchMaps> &patches)
{
    Vec3d low = patches[0].low, high = patches[0].high;
    for (const PatchMaps &patch : patches)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], patch.low[k]);
            high[k] = std::max(high[k], patch.high[k]);
        }
    return length(high - low);
}

/* The middle one of all height fields': patches differ by what their relief needs. */
double middle_texel(const HeightFields &fields)
{
    std::vector<double> texels;
    for (size_t i = 0; i < fields.size(); ++i)
        texels.push_back(fields[i].texel());
    const auto middle = texels.begin() + ptrdiff_t(texels.size() / 2);
    std::nth_element(texels.begin(), middle, texels.end());
    return *middle;
}

} // namespace

void stitch(unsigned height_bits, std::vector<PatchMaps> &patches, Task &task)
{
    const HeightFields fields(patches, height_bits);
    const double texel = middle_texel(fields);
    const Limits limits = {MAX_APART * texel, SLACK * (height_bits == 8 ? 1 : 65534 / 254.)};
    std::vector<std::vector<const Decoded *>> others(fields.size());
    std::vector<std::vector<Tie>> ties(fields.size());
    task.parallel(fields.size(), [&](size_t i) {
        others[i] = fields.around(fields[i]);
        ties[i] = sample_outline(fields[i]);
    });
    std::vector<std::vector<const Tie *>> open(fields.size());
    Moves moves(fields, patches, height_bits, std::min(texel, COARSE * diagonal_of(patches)),
                task);
    for (const double ease : EASE) {
        task.parallel(fields.size(),
                      [&](size_t i) { open[i] = update_ties(others[i], limits, ties[i]); });
        moves.solve(open, ties, ease, task);
        task.parallel(fields.size(), [&](size_t i) { moves.apply(i); });
    }
}

} // namespace gtx::baking
