/* A picture, compared with another. */
#pragma once

#include "mesh/memory.hpp"

#include <cstdint>

namespace gtx {

/* Rows from the top. */
struct Picture {
    Vector<uint8_t> color;    /* RGBA */
    Vector<float> depth;

    bool covers(size_t pixel) const { return depth[pixel] < 1; }
};

/* Whether a pixel and its eight neighbours are covered. */
bool is_inside(const Picture &picture, size_t pixel, size_t width);

/* Pixels that the picture does not cover and that no way over such pixels joins with one that the
 * truth does not cover either: gaps in the surface, but not where its outline has moved. */
uint64_t enclosed_holes(const Picture &truth, const Picture &picture, size_t width);

/* How far the outlines are apart, in pixels: the most that a pixel covered by one picture alone is
 * away from the nearest one covered by the other, diagonal steps counting as one; the window's
 * longest side if the other covers none. */
uint32_t outline_error(const Picture &a, const Picture &b, size_t width);

} // namespace gtx
