/* Sums up columns and rows of a chart's texels. */
#include "chart/cuts/slices.hpp"

namespace gtx {

namespace {

/* Sums along one column or row, where the other coordinate stays. */
struct Line {
    int low = INT32_MAX, high = INT32_MIN; /* of what is touched */
    double n = 0, x = 0, h = 0, xx = 0, xh = 0, hh = 0;

    void touch(int at)
    {
        low = std::min(low, at);
        high = at + 1;
    }
    void add(double at, double height)
    {
        n += 1, x += at, h += height;
        xx += at * at, xh += at * height, hh += height * height;
    }
    Slice slice(int axis, int at) const
    {
        Slice out;
        if (high > low) {
            out.box.low[axis] = at;
            out.box.high[axis] = at + 1;
            out.box.low[!axis] = low;
            out.box.high[!axis] = high;
        }
        double a = at;
        if (axis == 0)
            out.moments = {n, n * a, x, h, n * a * a, a * x, xx, a * h, xh, hh};
        else
            out.moments = {n, x, n * a, h, xx, a * x, n * a * a, xh, a * h, hh};
        return out;
    }
};

} // namespace

Vector<Lines> line_parts(const Relief &relief, const Rect &box, int axis,
                         const Vector<int> &across)
{
    const size_t count = size_t(box.side(axis));
    Vector<Line> sums(across.size() * count);
    auto add = [&relief](size_t texel, int at, Line &sum) {
        if (!relief.touched[texel])
            return;
        sum.touch(at);
        const double height = double(relief.height[texel]);
        if (!std::isnan(height))
            sum.add(at, height);
    };
    int from = box.low[!axis];
    Line *lines = sums.data();   /* of the part */
    for (const int to : across) {
        for (int j = box.low[1]; axis && j < box.high[1]; ++j) {
            Line sum;            /* a row's, in registers */
            for (int i = from; i < to; ++i)
                add(relief.at(i, j), i, sum);
            lines[j - box.low[1]] = sum;
        }
        for (int j = from; !axis && j < to; ++j)
            for (int i = box.low[0]; i < box.high[0]; ++i)
                add(relief.at(i, j), j, lines[i - box.low[0]]);
        from = to;
        lines += count;
    }
    Vector<Lines> out;
    out.reserve(across.size());
    for (size_t part = 0; part < across.size(); ++part) {
        out.push_back({box.low[axis], {}});
        out[part].slices.reserve(count);
        for (size_t i = 0; i < count; ++i)
            out[part].slices.push_back(sums[part * count + i].slice(axis, box.low[axis] + int(i)));
    }
    return out;
}

void add_lines(const Relief &relief, const Rect &box, int axis, Lines &lines)
{
    if (lines.slices.empty())
        lines = std::move(line_parts(relief, box, axis, {box.high[!axis]})[0]);
}

} // namespace gtx
