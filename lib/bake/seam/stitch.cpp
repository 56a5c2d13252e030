/* Pulls the height fields of neighbouring patches together where they meet.
 *
 * Each is fitted to the source alone, and between its texels it misses that by as much as there is
 * relief. Where one ends on another, what the two miss adds up to a step. So heights around
 * outlines move, as little as they can, until the end of each height field lies on the other: a
 * system of one equation for every point of an outline, solved by projections (Kaczmarz 1937) and
 * set up again where the height fields then are. Texels beyond an outline move first, for nobody
 * sees what they lie on, and those deep inside one last. */
#include "bake/seam/seam.hpp"
#include "bake/seam/ties.hpp"

namespace gtx::baking {

/* What these trade is RMS for steps between patches. Measured on Spot's control mesh and the truck,
 * RMS at half and at double: MAX_APART -1.3 | +1.7 %, SLACK +3.6 | -4.2 %, ROUNDS -1.3 | +1.9 %,
 * COARSE -2.6 | +1.7 %. */

/* Texels of the model along the normal between two height fields of one surface. */
constexpr double MAX_APART = 0.6;
/* What may stay between them, in codes of eight bits: rounding moves either by half of one. */
constexpr double SLACK = 1;
/* How readily texels at an outline move in each pass; those beyond it always do. */
constexpr double PASSES[] = {0.1, 0.3, 1};
constexpr int ROUNDS = 9; /* in a pass */
/* Equations from one cancellation point to the next, and turns of a short loop that take as long as
 * one. */
constexpr size_t CANCEL_EACH = 64, EQUATION_TURNS = 16;
/* A coarser texel, as a share of the diagonal, lets heights move no farther: they would be seen as
 * dents. */
constexpr double COARSE = 0.002;
/* Limits on time: looks that ties are granted in a pass. An engine of 82 nodes takes 39 million,
 * 59 for each; others take 12. */
constexpr double LOOKS = 3 << 24, LOOKS_EACH = 16;

namespace {

/* Where a texel is. */
enum Ground : uint8_t { BEYOND, AT_OUTLINE, INSIDE };

/* How readily a texel moves, and how many of the model's texels up and down its axis at most. */
struct Mobility {
    double readiness, up, down;
};
using Mobilities = std::array<Mobility, 3>; /* by ground */

Ground ground_of(uint8_t trim)
{
    return trim > GTX_TRIM_OUTLINE                    ? BEYOND
           : trim > GTX_TRIM_OUTLINE - GTX_TRIM_TEXEL ? AT_OUTLINE
                                                      : INSIDE;
}

/* What shows goes down less far: over a crest that lies too low a grazing ray passes. */
Mobilities mobilities(double at_outline)
{
    Mobilities of;
    of[BEYOND] = {1, 1.5, 1.5};
    of[AT_OUTLINE] = {at_outline, 1, 0.4};
    of[INSIDE] = {0.1 * at_outline, 0.75, 0.4};
    return of;
}

/* How far the texels of every height field have moved along its axis, object units. */
class Moves {
public:
    Moves(const HeightFields &fields, Vector<PatchMaps> &patches, unsigned height_bits,
          double texel, Task &task)
        : fields_(fields), patches_(patches), top_(gtx_height_steps(height_bits) + 1),
          texel_(texel), texels_(patches.size()), equations_(patches.size())
    {
        task.parallel(patches.size(), [&](size_t i) {
            texels_[i].reserve(patches[i].trim.size());
            for (size_t k = 0; k < patches[i].trim.size(); ++k)
                texels_[i].push_back(
                    {0, 0, patches[i].room[k], false, ground_of(patches[i].trim[k])});
            patches[i].room = {};
        });
    }
    /* `open` are those of the ties that are. */
    void solve(const Vector<Vector<const Tie *>> &open,
               Vector<Vector<Tie>> &ties, double readiness, Task &task);
    /* Rounds a height field to codes. */
    void apply(size_t field);

private:
    struct Texel {
        float moved = 0, applied = 0; /* all, and what of it is in the maps */
        float room = 0;               /* how far it may move up */
        bool at_open = false;         /* around the end of a tie that is open, in this pass */
        Ground ground = BEYOND;
    };
    /* A tie, and where the texels around its ends are: the first of two rows of two. */
    struct Equation {
        double gap, slack;
        double give;                  /* how far the gap opens as all move as they like to */
        double lever[8];              /* and as a texel rises */
        Texel *first[2];
        uint32_t width[2];

        Texel &texel(size_t n) const { return first[n / 4][(n & 1) + (n >> 1 & 1) * width[n / 4]]; }
    };
    Texel &texel(const Tie &tie, size_t n)
    {
        const End &end = tie.end[n / 4];
        return texels_[fields_.index(*end.field)][end.field->corner(end.place, n % 4)];
    }
    Equation equation_of(const Tie &tie, const Mobilities &mobility);
    void project(const Equation &equation, const Mobilities &mobility) const;

    const HeightFields &fields_;
    Vector<PatchMaps> &patches_;
    const double top_, texel_; /* the largest code; a texel of the model, object units */
    Vector<Vector<Texel>> texels_;
    Vector<Vector<Equation>> equations_;           /* of this pass, by the height fields that end */
};

Moves::Equation Moves::equation_of(const Tie &tie, const Mobilities &mobility)
{
    Equation out = {tie.gap, tie.slack, 0, {}, {&texel(tie, 0), &texel(tie, 4)}, {}};
    for (size_t k = 0; k < 2; ++k)
        out.width[k] = uint32_t(tie.end[k].field->w);
    for (size_t n = 0; n < 8; ++n) {
        const End &end = tie.end[n / 4];
        const double lever = out.lever[n] = end.lever * end.place.weight(n % 4);
        out.give += lever * (mobility[out.texel(n).ground].readiness * lever);
    }
    return out;
}

/* Ties that are closed, and stay so whatever the open ones do, are no part of it. */
void Moves::solve(const Vector<Vector<const Tie *>> &open,
                  Vector<Vector<Tie>> &ties, double readiness, Task &task)
{
    const Mobilities mobility = mobilities(readiness);
    for (const Vector<const Tie *> &some : open)
        for (const Tie *tie : some)
            for (size_t n = 0; n < 8; ++n)
                texel(*tie, n).at_open = true;
    task.parallel(ties.size(), [&](size_t i) {
        equations_[i].clear();
        for (Tie &tie : ties[i]) {
            tie.moves = !tie.end[1].field;
            for (size_t n = 0; n < 8 && !tie.moves; ++n)
                tie.moves = texel(tie, n).at_open;
            if (tie.moves && tie.end[1].field)
                equations_[i].push_back(equation_of(tie, mobility));
        }
    });
    for (int round = 0; round < ROUNDS; ++round)
        for (const Vector<Equation> &some : equations_)
            for (size_t n = 0; n < some.size(); ++n) {
                if (n % CANCEL_EACH == 0)
                    cancel_point(EQUATION_TURNS * std::min(some.size() - n, CANCEL_EACH));
                project(some[n], mobility);
            }
}

/* Closes a gap, but for its slack, by the least squares of what the texels around both ends move.
 */
void Moves::project(const Equation &e, const Mobilities &mobility) const
{
    double gap = e.gap;
    for (size_t n = 0; n < 8; ++n)
        gap += e.lever[n] * double(e.texel(n).moved - e.texel(n).applied);
    if (std::abs(gap) <= e.slack)
        return;
    const double share = (gap - std::copysign(e.slack, gap)) / e.give;
    for (size_t n = 0; n < 8; ++n) {
        Texel &texel = e.texel(n);
        const Mobility &own = mobility[texel.ground];
        texel.moved = float(std::clamp(texel.moved - share * (own.readiness * e.lever[n]),
                                       -own.down * texel_,
                                       std::min(double(texel.room), own.up * texel_)));
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
        texel.at_open = false;
    }
}

/* Of the box around them. */
double diagonal_of(const Vector<PatchMaps> &patches)
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
    Vector<double> texels;
    for (size_t i = 0; i < fields.size(); ++i)
        texels.push_back(fields[i].texel());
    const auto middle = texels.begin() + ptrdiff_t(texels.size() / 2);
    std::nth_element(texels.begin(), middle, texels.end());
    return *middle;
}

} // namespace

void stitch(unsigned height_bits, Vector<PatchMaps> &patches, Task &task)
{
    const HeightFields fields(patches, height_bits);
    const double texel = middle_texel(fields);
    const TieLimits limits = {MAX_APART * texel,
                              SLACK * (gtx_height_steps(height_bits) / gtx_height_steps(8))};
    Vector<Vector<const HeightField *>> others(fields.size());
    Vector<Vector<Tie>> ties(fields.size());
    Vector<double> looks(fields.size());
    task.parallel(fields.size(), [&](size_t i) {
        others[i] = fields.around(fields[i], limits.apart);
        ties[i] = sample_outline(fields[i]);
        looks[i] = looks_of(others[i], limits, ties[i]);
    });
    double all = 0, wanted = 0;
    for (size_t i = 0; i < ties.size(); ++i) {
        all += double(ties[i].size());
        wanted += looks[i];
    }
    const double each = looks_each(all, wanted, LOOKS, LOOKS_EACH);
    Vector<Vector<const Tie *>> open(fields.size());
    Moves moves(fields, patches, height_bits, std::min(texel, COARSE * diagonal_of(patches)),
                task);
    for (const double readiness : PASSES) {
        task.parallel(fields.size(),
                      [&](size_t i) {
                          const Budget budget(each * double(1 + ties[i].size()));
                          open[i] = update_ties(others[i], limits, budget, ties[i]);
                      });
        moves.solve(open, ties, readiness, task);
        task.parallel(fields.size(), [&](size_t i) { moves.apply(i); });
    }
}

} // namespace gtx::baking
