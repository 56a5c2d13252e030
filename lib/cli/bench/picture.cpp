/* Compares the coverage of two pictures. */
#include "cli/bench/picture.hpp"

#include <algorithm>

namespace gtx {

bool is_inside(const Picture &picture, size_t pixel, size_t width)
{
    const size_t x = pixel % width, y = pixel / width;
    if (x == 0 || y == 0 || x + 1 == width || (y + 1) * width == picture.depth.size())
        return false;
    for (size_t k = 0; k < 9; ++k)
        if (!picture.covers((y + k / 3 - 1) * width + x + k % 3 - 1))
            return false;
    return true;
}

uint64_t enclosed_holes(const Picture &truth, const Picture &picture, size_t width)
{
    const size_t count = truth.depth.size(), height = count / width;
    Vector<bool> reached(count);
    Vector<size_t> next;
    auto reach = [&](size_t pixel) {
        if (!picture.covers(pixel) && !reached[pixel]) {
            reached[pixel] = true;
            next.push_back(pixel);
        }
    };
    for (size_t p = 0; p < count; ++p)
        if (!truth.covers(p))
            reach(p);
    while (!next.empty()) {
        const size_t x = next.back() % width, y = next.back() / width;
        next.pop_back();
        for (size_t v = y - (y > 0); v <= std::min(y + 1, height - 1); ++v)
            for (size_t u = x - (x > 0); u <= std::min(x + 1, width - 1); ++u)
                reach(v * width + u);
    }
    uint64_t holes = 0;
    for (size_t p = 0; p < count; ++p)
        holes += !picture.covers(p) && !reached[p];
    return holes;
}

/* From each pixel to the nearest covered one, at most `most`: one pass down and one up, each taking
 * what four neighbours have (Rosenfeld and Pfaltz 1968). */
static Vector<uint32_t> distances(const Picture &picture, size_t width, uint32_t most)
{
    const size_t height = picture.depth.size() / width;
    Vector<uint32_t> out(picture.depth.size(), most);
    auto take = [&](size_t pixel, size_t from) {
        out[pixel] = std::min(out[pixel], out[from] + 1);
    };
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0, p = y * width; x < width; ++x, ++p) {
            if (picture.covers(p))
                out[p] = 0;
            if (x)
                take(p, p - 1);
            for (size_t k = 0; k < 3 && y; ++k)
                if (x + k >= 1 && x + k <= width)
                    take(p, p - width + k - 1);
        }
    for (size_t y = height; y-- > 0;)
        for (size_t x = width, p = (y + 1) * width - 1; x-- > 0; --p) {
            if (x + 1 < width)
                take(p, p + 1);
            for (size_t k = 0; k < 3 && y + 1 < height; ++k)
                if (x + k >= 1 && x + k <= width)
                    take(p, p + width + k - 1);
        }
    return out;
}

uint32_t outline_error(const Picture &a, const Picture &b, size_t width)
{
    const uint32_t most = uint32_t(std::max(width, a.depth.size() / width));
    const Vector<uint32_t> to_a = distances(a, width, most), to_b = distances(b, width, most);
    uint32_t error = 0;
    for (size_t p = 0; p < a.depth.size(); ++p)
        if (a.covers(p) != b.covers(p))
            error = std::max(error, std::min(most, a.covers(p) ? to_b[p] : to_a[p]));
    return error;
}

} // namespace gtx
