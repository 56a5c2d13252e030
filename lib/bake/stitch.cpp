/* Draws the sheets of neighbouring patches together where they meet.
 *
 * Each is fitted to the source alone, and between its texels it misses that by as much as there is
 * relief. Where one ends on another, what the two miss adds up to a step. So heights around
 * outlines move, as little as they can, until the end of each sheet lies on the other: a system of
 * one equation for every point of an outline, solved by projections (Kaczmarz 1937). Texels beyond
 * an outline move first, for nobody sees what they lie on. */
#include "bake/decoded.hpp"

namespace gtx::baking {

/* Texels along the normal between two sheets of one surface, and outside its outline to which a
 * sheet counts. */
constexpr double MOST_APART = 0.5, REACHED = SHOWN + 0.2;
/* What faces alike as much is the same surface; what does not may be across an edge. */
constexpr double ALIKE = 0.2;
/* A sheet that moves along the seam less, as it rises, is of no use there. */
constexpr double LEAST_LEVER = 0.1;
/* What may stay between them, in codes of eight bits: rounding moves either by half of one. */
constexpr double SLACK = 1;
/* Texels of depth that a height moves at most, and how readily one inside an outline does. */
constexpr double FARTHEST = 0.5, STIFF = 0.02;
/* Points of an outline in a cell. */
constexpr double ALONG[] = {1 / 6., 1 / 2., 5 / 6.};
constexpr int ROUNDS = 8;

namespace {

/* A point where a sheet ends, and the place of the other that it should lie on. */
struct End {
    const Decoded *sheet;
    Place place;
    double lever;                /* how far the gap opens as it rises */
};
struct Tie {
    End end[2];
    double gap, slack;           /* along the normal of the other */
};

/* Where an outline that is not the model's own border crosses a cell with codes: from one of its
 * sides to another. */
bool find_crossing(const Decoded &sheet, int i, int j, double from[2], double to[2])
{
    static const int RING[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    double trim[5];
    for (int k = 0; k < 5; ++k) {
        const size_t texel = sheet.at(i + RING[k][0], j + RING[k][1]);
        if (!sheet.maps->height[texel] || sheet.maps->border[texel])
            return false;
        trim[k] = sheet.maps->trim[texel] - 128.;
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

/* The sheet that goes on where one ends: of those that face alike the nearest, else of all. */
bool find_tie(const std::vector<const Decoded *> &others, const Decoded &own, const Place &place,
              Tie &tie)
{
    const Vec3d end = own.point(place), normal = own.normal(place);
    std::pair<bool, double> best = {true, MOST_APART * own.texel()}; /* not alike, how far */
    bool found = false;
    for (const Decoded *other : others) {
        double above, trim;
        if (length(end - other->centre) > other->radius || !other->sheet_above(end, above, trim) ||
            trim > REACHED)
            continue;
        const Place there = other->place_of(end);
        const Vec3d facing = other->normal(there);
        const double rises = dot(facing, other->axis[2]), sinks = dot(facing, own.axis[2]);
        const double gap = above * rises, apart = std::abs(gap);
        const std::pair<bool, double> rank = {dot(facing, normal) < ALIKE, apart};
        if (apart >= MOST_APART * own.texel() || std::abs(sinks) < LEAST_LEVER || !(rank < best))
            continue;
        best = rank;
        found = true;
        tie = {{{&own, place, -sinks}, {other, there, rises}}, gap, 0};
    }
    return found;
}

std::vector<Tie> find_ties(const Sheets &sheets, const Decoded &own, double codes)
{
    const std::vector<const Decoded *> others = sheets.around(own);
    std::vector<Tie> ties;
    for (int j = 0; j + 1 < own.h; ++j) {
        for (int i = 0; i + 1 < own.w; ++i) {
            double from[2], to[2];
            if (!find_crossing(own, i, j, from, to))
                continue;
            for (double along : ALONG) {
                const Place place = {own.at(i, j), from[0] + (to[0] - from[0]) * along,
                                     from[1] + (to[1] - from[1]) * along};
                Tie tie;
                if (!find_tie(others, own, place, tie))
                    continue;
                tie.slack = SLACK * codes * std::max(own.step, tie.end[1].sheet->step);
                ties.push_back(tie);
            }
        }
    }
    return ties;
}

/* How far the texels of every sheet have moved along its axis, object units. */
class Moves {
public:
    explicit Moves(const Sheets &sheets) : sheets_(sheets)
    {
        for (size_t i = 0; i < sheets.size(); ++i)
            moved_.emplace_back(sheets[i].maps->height.size(), 0.f);
    }
    void project(const Tie &tie);
    const std::vector<float> &of(size_t sheet) const { return moved_[sheet]; }

private:
    const Sheets &sheets_;
    std::vector<std::vector<float>> moved_;
};

/* Moves the texels around both ends, by the least squares that close the gap but for its slack. */
void Moves::project(const Tie &tie)
{
    float *moved[8];
    double lever[8], gap = tie.gap;
    for (size_t n = 0; n < 8; ++n) {
        const End &end = tie.end[n / 4];
        moved[n] = &moved_[sheets_.index(*end.sheet)][end.sheet->corner(end.place, n % 4)];
        lever[n] = end.lever * end.place.weight(n % 4);
        gap += lever[n] * double(*moved[n]);
    }
    if (std::abs(gap) <= tie.slack)
        return;
    double eased[8], give = 0;
    for (size_t n = 0; n < 8; ++n) {
        const End &end = tie.end[n / 4];
        const bool outside = end.sheet->maps->trim[end.sheet->corner(end.place, n % 4)] > 128;
        eased[n] = outside ? lever[n] : STIFF * lever[n];
        give += lever[n] * eased[n];
    }
    const double share = (gap - std::copysign(tie.slack, gap)) / give;
    for (size_t n = 0; n < 8; ++n) {
        const double most = FARTHEST * tie.end[n / 4].sheet->texel();
        *moved[n] = float(std::clamp(*moved[n] - share * eased[n], -most, most));
    }
}

} // namespace

void stitch(unsigned height_bits, std::vector<PatchMaps> &patches, Task &task)
{
    const double top = height_bits == 8 ? 255 : 65535, codes = (top - 1) / 254;
    const Sheets sheets(patches, height_bits);
    std::vector<std::vector<Tie>> ties(sheets.size());
    task.parallel(sheets.size(),
                  [&](size_t i) { ties[i] = find_ties(sheets, sheets[i], codes); });
    Moves moves(sheets);
    for (int round = 0; round < ROUNDS; ++round)
        for (const std::vector<Tie> &some : ties)
            for (const Tie &tie : some)
                moves.project(tie);
    task.parallel(sheets.size(), [&](size_t i) {
        const std::vector<float> &moved = moves.of(i);
        for (size_t k = 0; k < moved.size(); ++k) {
            uint16_t &code = patches[i].height[k];
            if (code && moved[k] != 0)
                code = uint16_t(
                    std::clamp(std::floor(code + moved[k] / sheets[i].step + 0.5), 1., top));
        }
        measure_patch(height_bits, patches[i]);
    });
}

} // namespace gtx::baking
