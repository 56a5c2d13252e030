/* The triangles around a vertex. */
#pragma once

#include "mesh/memory.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace gtx::baking {

using Triangle = std::array<uint32_t, 3>;

/* Triangles around a vertex beyond which it stays. */
constexpr int MAX_FAN = 40;

/* A triangle of which a vertex is merged or moved may turn by as much as has this cosine. At half
 * and at double a few bytes change of what is merged; of what is moved at double 15 % more of one
 * level's error (bunny). */
constexpr double MIN_TURN_COSINE = 0.25;

/* Where a value is among a few; their count where it is not. */
inline int index_of(const uint32_t *values, int count, uint32_t value)
{
    int i = 0;
    while (i < count && values[i] != value)
        ++i;
    return i;
}

/* The triangles around a vertex in order: `ring` holds their other vertices, one more than there
 * are triangles where the fan is open. Where height fields meet there is no order, and each other
 * vertex is in the ring once. */
struct Fan {
    int count = 0, ring_count = 0;
    bool open = false, meeting = false;
    uint32_t triangle[MAX_FAN], ring[2 * MAX_FAN];

    bool has(uint32_t vertex) const
    {
        bool any = false;
        for (int i = 0; i < ring_count; ++i)
            any |= ring[i] == vertex;
        return any;
    }
};

inline int corner_of(const Triangle &triangle, uint32_t vertex)
{
    return triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : triangle[2] == vertex ? 2 : -1;
}

/* Puts those `around` a vertex in order. False when there are none or too many. */
bool find_fan(const Vector<Triangle> &triangles, const uint32_t *around, size_t triangle_count,
              uint32_t vertex, Fan &fan);

} // namespace gtx::baking
