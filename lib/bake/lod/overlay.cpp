/* The edges of the fine surface are followed over the coarse one, and cut where they go over its
 * edges. Cuts are joined across a fine triangle; where what they enclose are pieces over one coarse
 * triangle each, all of a piece is within what its corners are of that, for both are convex. Which
 * point of an edge is taken for a cut matters to how tight a bound is, not to its truth. */
#include "bake/lod/overlay.hpp"
#include "bake/lod/coarse_edges.hpp"

#include <algorithm>
#include <cmath>

namespace gtx::baking {

namespace {

/* Vertices or triangles that are looked at one after another. */
constexpr size_t CHUNK = 2048;
/* The cuts of a fine edge. */
struct Way {
    bool known = false;
    uint32_t first = 0, count = 0;
};

/* The border of a fine triangle as cuts, and what was found out while it came apart. */
struct Border {
    struct End {
        Cut cut;
        int32_t to;
    };
    static constexpr int MOST = 3 * (MAX_CUTS + MAX_AROUND);
    Cut cuts[MOST];
    int count = 0;
    End ends[2 * MOST];          /* of pieces, at coarse edges, from a cut on to another place */
    int end_count = 0;

    /* A cut that goes back over the edge that the one before it went over ends a piece. */
    void add(const Cut &cut)
    {
        if (count && cut.is_back(cuts[count - 1]))
            ends[end_count++] = {cuts[--count], cut.at};
        else
            cuts[count++] = cut;
    }
    /* The last may be before the first, too. */
    void close()
    {
        int first = 0;
        for (; count - first > 1 && cuts[first].is_back(cuts[count - 1]); ++first, --count)
            ends[end_count++] = {cuts[count - 1], cuts[first].at};
        std::copy(cuts + first, cuts + count, cuts);
        count -= first;
    }
};

class Laying {
public:
    Laying(const SortedSurface &fine, const SortedSurface &coarse, const Reached *before,
           const Reached *beyond, Overlay &out, Task &task)
        : fine_(fine), coarse_(coarse), before_(before), beyond_(beyond), out_(out),
          edges_(coarse, task), covered_(coarse.size()), open_(coarse.size())
    {
    }
    void run(Task &task);

private:
    /* Of a fine triangle, and what is added to the distances that are told of it. */
    struct Told {
        uint32_t triangle;
        double before, beyond;
    };

    void lay_all(size_t from, size_t to);
    bool lay(uint32_t triangle, const Way *ways, const Cut *cuts);
    bool take_vertex(const Told &told, Border &border, float &most);
    bool take_run(const Told &told, uint32_t vertex, int count, Border &border, float &most);
    void tell(const Told &told, uint32_t coarse, float away)
    {
        out_.of_coarse.tell(coarse, double(away) + told.beyond);
        if (before_) /* else it is the same */
            out_.to_coarse.tell(coarse, double(away) + told.before);
    }
    void cover(const Cut &from, int32_t to);
    void leave_open(uint32_t from, uint32_t to, const Way &way, const Cut *cuts);

    const SortedSurface &fine_, &coarse_;
    const Reached *before_, *beyond_;
    Overlay &out_;
    const CoarseEdges edges_;
    Vector<OverPlace> places_;               /* of fine vertices */
    Vector<std::atomic<int32_t>> covered_;   /* of the three edges of coarse triangles */
    Vector<std::atomic<uint8_t>> open_;      /* whether pieces over those may end anywhere */
};

/* As seen by what lies before the cut: a piece goes on at the coarse edge to another place. */
void Laying::cover(const Cut &from, int32_t to)
{
    const std::array<uint32_t, 3> &v = coarse_.vertices(from.from);
    const bool up = v[0] == from.low ? v[1] == from.high
                                     : v[1] == from.low ? v[2] == from.high : v[0] == from.high;
    const int32_t more = up ? to - from.at : from.at - to;
    covered_[from.from].fetch_add(more, std::memory_order_relaxed);
    covered_[from.to].fetch_add(more, std::memory_order_relaxed);
}

void Laying::leave_open(uint32_t from, uint32_t to, const Way &way, const Cut *cuts)
{
    if (!way.known)
        return;
    for (uint32_t v : {from, to})
        open_[places_[v].over].store(1, std::memory_order_relaxed);
    for (uint32_t i = 0; i < way.count; ++i)
        open_[cuts[way.first + i].to].store(1, std::memory_order_relaxed);
}

/* The first cuts of the border go around a coarse vertex, which is over the fine triangle: pieces
 * meet there. The border then goes the other way around it. */
bool Laying::take_run(const Told &told, uint32_t vertex, int count, Border &border, float &most)
{
    const Cut &first = border.cuts[0];
    const uint32_t end = border.cuts[count - 1].to, start = first.from;
    const std::array<uint32_t, 3> &v = coarse_.vertices(start);
    const int at = corner_of(v, vertex);
    const bool left = first.has(v[at == 0 ? 2 : at - 1]);
    const auto [x, y, z] = fine_.corners(told.triangle);
    const Vec3d &point = coarse_.corner(start, at);
    const float away = Reached::rounded_up(std::sqrt(triangle_distance2(point, x, y, z)));
    Cut other[Border::MOST];
    int others = 0;
    const bool all = count == border.count && end == start;
    for (uint32_t here = start; !all && here != end; here = other[others - 1].to) {
        const int side = edges_.side_around(here, vertex, left);
        if (others + 1 >= count || coarse_.beside(here)[side] >= coarse_.size())
            return false;
        other[others] = edges_.cut(here, side, point);
        other[others++].away = away;
    }
    most = std::max(most, away);
    for (int i = 0; i < count; ++i) {
        const Cut &cut = border.cuts[i];
        border.ends[border.end_count++] = {cut, cut.low == vertex ? 0 : WHOLE};
        tell(told, cut.from, away);
        tell(told, cut.to, away);
    }
    Cut rest[Border::MOST];
    const int still = border.count - count;
    std::copy_n(border.cuts + count, still, rest);
    border.count = 0;
    for (int i = 0; i < others; ++i) {
        tell(told, other[i].to, away);
        border.add(other[i]);
    }
    for (int i = 0; i < still; ++i)
        border.add(rest[i]);
    border.close();
    return true;
}

/* That which most of the border goes around at once. */
bool Laying::take_vertex(const Told &told, Border &border, float &most)
{
    int best = 0, longest = 1;
    uint32_t vertex = NO_VERTEX;
    for (int i = 0; i < border.count; ++i)
        for (uint32_t v : {border.cuts[i].low, border.cuts[i].high}) {
            int run = 1;
            while (run < border.count && border.cuts[(i + run) % border.count].has(v))
                ++run;
            if (run > longest) {
                longest = run;
                best = i;
                vertex = v;
            }
        }
    if (vertex == NO_VERTEX || border.end_count + longest + Border::MOST > 2 * Border::MOST)
        return false;
    std::rotate(border.cuts, border.cuts + best, border.cuts + border.count);
    return take_run(told, vertex, longest, border, most);
}

/* Whether it comes apart into pieces. */
bool Laying::lay(uint32_t triangle, const Way *ways, const Cut *cuts)
{
    const std::array<uint32_t, 3> &v = fine_.vertices(triangle);
    const Told told = {triangle, before_ ? before_->at(triangle) : 0,
                       beyond_ ? beyond_->at(triangle) : 0};
    float most = 0;
    Border border;
    for (int side = 0; side < 3; ++side) {
        const Way &way = ways[side];
        if (!way.known)
            return false;
        const bool up = v[side] < v[side == 2 ? 0 : side + 1];
        for (uint32_t n = 0; n < way.count; ++n) {
            border.add(up ? cuts[way.first + n] : cuts[way.first + way.count - 1 - n].turned());
            most = std::max(most, cuts[way.first + n].away);
        }
    }
    border.close();
    while (border.count)
        if (!take_vertex(told, border, most))
            return false;
    for (int i = 0; i < border.end_count; ++i)
        cover(border.ends[i].cut, border.ends[i].to);
    for (int side = 0; side < 3; ++side) {
        for (uint32_t n = 0; n < ways[side].count; ++n) {
            const Cut &cut = cuts[ways[side].first + n];
            tell(told, cut.from, cut.away);
            tell(told, cut.to, cut.away);
        }
        const OverPlace &place = places_[v[side]];
        tell(told, place.over, place.away);
        most = std::max(most, place.away);
    }
    out_.of_fine[triangle] = most;
    return true;
}

/* An edge between two of them is followed once. */
void Laying::lay_all(size_t from, size_t to)
{
    Vector<Way> ways(3 * (to - from));
    Vector<Cut> cuts;
    for (size_t t = from; t < to; ++t) {
        const std::array<uint32_t, 3> &v = fine_.vertices(t);
        Way *own = &ways[3 * (t - from)];
        for (int side = 0; side < 3; ++side) {
            const uint32_t a = v[side], b = v[side == 2 ? 0 : side + 1];
            const uint32_t beside = fine_.beside(t)[side];
            if (beside >= from && beside < t) {
                const int start = corner_of(fine_.vertices(beside), b);
                own[side] = ways[3 * (beside - from) + size_t(start)];
            } else {
                const uint32_t low = std::min(a, b), high = std::max(a, b);
                own[side].first = uint32_t(cuts.size());
                own[side].known = edges_.follow(fine_.position(low), places_[low],
                                                fine_.position(high), places_[high], cuts);
                own[side].count = uint32_t(cuts.size()) - own[side].first;
            }
        }
        const bool whole = lay(uint32_t(t), own, cuts.data());
        for (int side = 0; side < 3; ++side)
            if (!whole || fine_.beside(t)[side] >= fine_.size())
                leave_open(v[side], v[side == 2 ? 0 : side + 1], own[side], cuts.data());
    }
}

void Laying::run(Task &task)
{
    const auto in_chunks = [&](size_t count, const auto &look) {
        task.parallel((count + CHUNK - 1) / CHUNK, [&](size_t n) {
            cancel_point(CHUNK);
            look(n * CHUNK, std::min(count, (n + 1) * CHUNK));
        }, 1, 1);
    };
    places_.resize(fine_.vertex_count());
    in_chunks(places_.size(), [&](size_t from, size_t to) {
        uint32_t near = NO_PATCH;
        for (size_t v = from; v < to; ++v) {
            places_[v] = edges_.place(fine_.position(v), near);
            near = places_[v].over == NO_PATCH ? near : places_[v].over;
        }
    });
    in_chunks(fine_.size(), [&](size_t from, size_t to) { lay_all(from, to); });
    /* Where pieces end at edges of a coarse triangle alone, they cover all of it as often as any of
     * its edges. */
    for (size_t t = 0; t < coarse_.size(); ++t) {
        if (!before_)
            out_.to_coarse.set(t, out_.of_coarse.at(t));
        if (open_[t] || covered_[t] != 3 * WHOLE)
            out_.of_coarse.set(t, INFINITY);
    }
}

} // namespace

Overlay lay_over(const SortedSurface &fine, const SortedSurface &coarse, const Reached *before,
                 const Reached *beyond, Task &task)
{
    Overlay out(fine.size(), coarse.size());
    if (fine.size() && coarse.size())
        Laying(fine, coarse, before, beyond, out, task).run(task);
    return out;
}

} // namespace gtx::baking
