/* Lets the sheets of patches cross where their chart was cut straight.
 *
 * Two sheets that overlap leave no way between them where each lies above the other at its own end:
 * a ray that passes over the end of one meets the front of the other. Fitted apart, on texels that
 * are not the same where a chart ends, and rounded to codes, they may miss that by as much as the
 * relief between two texels. So the texels beyond a cut are raised to the neighbour's sheet, as a
 * reader decodes it. Pieces of a chart share its axis of projection, along which that is exact. */
#include "bake/decoded.hpp"

#include <algorithm>
#include <tuple>

namespace gtx::baking {

/* Texels of depth that a texel is raised at most: more is another sheet, or would be a fin that a
 * third patch does not meet. */
constexpr double MOST_RAISED = 0.2;
/* and that it may miss: a ray that finds the way then is within a tenth of a degree of the
 * surface. */
constexpr double MISSED = 0.002;
/* Texels from its outline to which a sheet counts, the first ones beyond a cut included. */
constexpr double REACHED = SHOWN + 0.1;
/* A neighbour's texels beyond the same cut follow what is raised here. */
constexpr int ROUNDS = 2;
/* Of (1, 1, 1), along which pieces are sorted. */
const double DIAGONAL = std::sqrt(3.);

namespace {

/* A patch, and where its chart is cut. */
struct Piece : Decoded {
    double cut_low[2], cut_high[2];

    Piece(const PatchMaps &patch, const Chart &chart, const Vec3d &anchor, unsigned height_bits)
        : Decoded(patch, height_bits)
    {
        const Vec3d corner = chart.frame.local(origin + anchor);
        for (int k = 0; k < 2; ++k) {
            cut_low[k] = (chart.clip_low[k] - corner[k]) / pitch[k] - 0.5;
            cut_high[k] = (chart.clip_high[k] - corner[k]) / pitch[k] - 0.5;
        }
    }
};

class Cuts {
public:
    Cuts(const std::vector<const Piece *> &others, const Piece &piece, unsigned most_code)
        : others_(others), piece_(piece), most_code_(most_code),
          most_(MOST_RAISED * piece.texel()), missed_(MISSED * piece.texel()),
          codes_(piece.maps->height)
    {
    }
    std::vector<uint16_t> close()
    {
        for (int axis = 0; axis < 2; ++axis) {
            close_line(axis, int(std::ceil(std::max(piece_.cut_low[axis], 0.))) - 1, 1);
            close_line(axis, int(std::floor(std::min(piece_.cut_high[axis], 1e5))) + 1, -1);
        }
        return std::move(codes_);
    }

private:
    void close_line(int axis, int line, int inward);
    double missing(int axis, int line, double along) const;
    void raise(size_t texel, double by);

    const std::vector<const Piece *> &others_;
    const Piece &piece_;
    const double most_code_, most_, missed_;
    std::vector<uint16_t> codes_;
};

void Cuts::raise(size_t texel, double by)
{
    const double code = codes_[texel] + std::ceil(by / piece_.step);
    codes_[texel] = uint16_t(std::min(code, most_code_));
}

/* How far the sheet is below the highest of the others at a place of a line across `axis`;
 * -infinity where either has none. */
double Cuts::missing(int axis, int line, double along) const
{
    const int k = int(along);
    const double part = along - k;
    auto code = [&](int at) { return codes_[axis ? piece_.at(at, line) : piece_.at(line, at)]; };
    if (!code(k) || (part > 0 && !code(k + 1)))
        return -INFINITY;
    const double height = piece_.height(part > 0 ? code(k) * (1 - part) + code(k + 1) * part
                                                 : code(k));
    const Vec3d point = axis ? piece_.point(along, line, height)
                             : piece_.point(line, along, height);
    double missing = -INFINITY, above, trim;
    for (const Piece *other : others_)
        if (other->sheet_above(point, above, trim) && trim <= REACHED && above <= most_)
            missing = std::max(missing, above);
    return missing;
}

/* The row or column of texels beyond a cut across `axis`. Where the sheet is above the neighbour's
 * at the texels before it, they cross already. */
void Cuts::close_line(int axis, int line, int inward)
{
    const int lines = axis ? piece_.h : piece_.w, length = axis ? piece_.w : piece_.h;
    if (line < 0 || line >= lines || line + inward < 0 || line + inward >= lines)
        return;
    for (double part : {0., 0.5, 0.25, 0.75}) {
        for (int k = 0; k + (part > 0) < length; ++k) {
            const double by = missing(axis, line, k + part);
            const double before = by > missed_ ? missing(axis, line + inward, k + part) : 0;
            if (by <= missed_ || (before <= missed_ && before > -INFINITY))
                continue;
            /* The least change of both ends that lifts the line between them by as much. */
            const double share = (by - missed_) / (part * part + (1 - part) * (1 - part));
            for (int end = 0; end <= (part > 0); ++end)
                raise(axis ? piece_.at(k + end, line) : piece_.at(line, k + end),
                      share * (end ? part : 1 - part));
        }
    }
}

/* Of each piece those of the same axis that its sphere meets. */
std::vector<std::vector<const Piece *>> find_others(const std::vector<Piece> &pieces)
{
    auto key = [](const Piece &p) {
        return std::make_tuple(p.axis[2].x, p.axis[2].y, p.axis[2].z, p.place);
    };
    auto same_axis = [](const Piece &a, const Piece &b) { return a.axis[2] == b.axis[2]; };
    std::vector<const Piece *> order;
    double farthest = 0;
    for (const Piece &p : pieces) {
        order.push_back(&p);
        farthest = std::max(farthest, double(p.maps->record.sphere[3]));
    }
    std::sort(order.begin(), order.end(),
              [&](const Piece *a, const Piece *b) { return key(*a) < key(*b); });
    std::vector<std::vector<const Piece *>> others(pieces.size());
    for (size_t i = 0; i < order.size(); ++i) {
        const Piece &p = *order[i];
        const gtx_patch &r = p.maps->record;
        for (size_t k = i + 1; k < order.size(); ++k) {
            const Piece &q = *order[k];
            const gtx_patch &s = q.maps->record;
            if (!same_axis(p, q) || q.place - p.place > DIAGONAL * (r.sphere[3] + farthest))
                break;
            const Vec3d apart(double(r.sphere[0]) - s.sphere[0], double(r.sphere[1]) - s.sphere[1],
                              double(r.sphere[2]) - s.sphere[2]);
            if (length(apart) > r.sphere[3] + s.sphere[3])
                continue;
            others[size_t(&p - pieces.data())].push_back(&q);
            others[size_t(&q - pieces.data())].push_back(&p);
        }
    }
    return others;
}

} // namespace

void close_cuts(const Partition &partition, const std::vector<uint32_t> &charts,
                const Vec3d &anchor, unsigned height_bits, std::vector<PatchMaps> &patches,
                Task &task)
{
    std::vector<Piece> pieces;
    for (size_t i = 0; i < patches.size(); ++i)
        pieces.emplace_back(patches[i], partition.charts[charts[i]], anchor, height_bits);
    const std::vector<std::vector<const Piece *>> others = find_others(pieces);
    std::vector<std::vector<uint16_t>> closed(patches.size());
    for (int round = 0; round < ROUNDS; ++round) {
        task.parallel(patches.size(), [&](size_t i) {
            if (!others[i].empty())
                closed[i] = Cuts(others[i], pieces[i], height_bits == 8 ? 255 : 65535).close();
        });
        for (size_t i = 0; i < patches.size(); ++i)
            if (!others[i].empty())
                patches[i].height.swap(closed[i]);
    }
    task.parallel(patches.size(), [&](size_t i) {
        if (!others[i].empty())
            measure_patch(height_bits, patches[i]);
    });
}

} // namespace gtx::baking
