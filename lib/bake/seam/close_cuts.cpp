/* Lets the height fields of patches cross where their chart was cut straight.
 *
 * Two height fields that overlap leave no way between them where each lies above the other at its
 * own end: a ray that passes over the end of one meets the front of the other. Fitted apart, on
 * texels that are not the same where a chart ends, and rounded to codes, they may miss that by as
 * much as the relief between two texels. So the texels beyond a cut are raised to the neighbour's
 * height field, as a reader decodes it. Pieces of a chart share its axis of projection, along which
 * that is exact. */
#include "bake/height_field.hpp"
#include "bake/seam/seam.hpp"

#include <algorithm>

namespace gtx::baking {

/* Texels of depth that a texel is raised at most: more is another height field, or would be a fin
 * that a third patch does not meet. At half and at double a few bytes change, here and below; more
 * rounds change no more, one is RMS -0.7 % (bunny). */
constexpr double MAX_RAISED = 0.3;
/* and that it may miss: a ray that finds the way then is within a tenth of a degree of the
 * surface. */
constexpr double MISSED = 0.002;
/* Texels from its outline to which a height field counts, the first ones beyond a cut included. */
constexpr double REACHED = GTX_TRIM_SHOWN + 0.1;
/* A neighbour's texels beyond the same cut follow what is raised here. */
constexpr int ROUNDS = 2;

namespace {

/* Where the chart of a patch is cut, in texels. */
struct Clip {
    double low[2], high[2];

    Clip(const HeightField &field, const Chart &chart, const Vec3d &anchor)
    {
        const Vec3d corner = chart.frame.local(field.origin + anchor);
        for (int k = 0; k < 2; ++k) {
            low[k] = (chart.clip_low[k] - corner[k]) / field.pitch[k] - 0.5;
            high[k] = (chart.clip_high[k] - corner[k]) / field.pitch[k] - 0.5;
        }
    }
};

class Cuts {
public:
    Cuts(const Vector<const HeightField *> &others, const HeightField &piece, const Clip &clip,
         double most_code, const Vector<uint16_t> &codes)
        : others_(others), piece_(piece), clip_(clip), most_code_(most_code),
          most_(MAX_RAISED * piece.texel()), missed_(MISSED * piece.texel()), codes_(codes)
    {
    }
    Vector<uint16_t> close()
    {
        for (int axis = 0; axis < 2; ++axis) {
            close_line(axis, int(std::ceil(std::max(clip_.low[axis], 0.))) - 1, 1);
            close_line(axis, int(std::floor(std::min(clip_.high[axis], 1e5))) + 1, -1);
        }
        return std::move(codes_);
    }

private:
    void close_line(int axis, int line, int inward);
    double missing(int axis, int line, double along) const;
    void raise(size_t texel, double by);

    const Vector<const HeightField *> &others_;
    const HeightField &piece_;
    const Clip clip_;
    const double most_code_, most_, missed_;
    Vector<uint16_t> codes_;
};

void Cuts::raise(size_t texel, double by)
{
    const double code = codes_[texel] + std::ceil(by / piece_.step);
    codes_[texel] = uint16_t(std::min(code, most_code_));
}

/* How far the height field is below the highest of the others at a place of a line across `axis`;
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
    for (const HeightField *other : others_)
        if (other->field_above(point, above, trim) && trim <= REACHED && above <= most_)
            missing = std::max(missing, above);
    return missing;
}

/* The row or column of texels beyond a cut across `axis`. Where the height field is above the
 * neighbour's at the texels before it, they cross already. */
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

/* The others of the same axis within a texel. */
Vector<const HeightField *> find_others(const HeightFields &fields, const HeightField &piece)
{
    Vector<const HeightField *> others;
    for (const HeightField *other : fields.around(piece, piece.texel()))
        if (other->axis[2] == piece.axis[2])
            others.push_back(other);
    return others;
}

} // namespace

void close_cuts(const Partition &partition, const Vector<uint32_t> &charts,
                const Vec3d &anchor, unsigned height_bits, Vector<PatchMaps> &patches,
                Task &task)
{
    const HeightFields pieces(patches, height_bits);
    Vector<Vector<const HeightField *>> others(patches.size());
    task.parallel(patches.size(), [&](size_t i) { others[i] = find_others(pieces, pieces[i]); });
    Vector<Vector<uint16_t>> closed(patches.size());
    for (int round = 0; round < ROUNDS; ++round) {
        task.parallel(patches.size(), [&](size_t i) {
            if (!others[i].empty())
                closed[i] = Cuts(others[i], pieces[i],
                                 Clip(pieces[i], partition.charts[charts[i]], anchor),
                                 gtx_height_steps(height_bits) + 1, patches[i].height)
                                .close();
        });
        for (size_t i = 0; i < patches.size(); ++i)
            if (!others[i].empty())
                std::copy(closed[i].begin(), closed[i].end(), patches[i].height.begin());
    }
}

} // namespace gtx::baking
