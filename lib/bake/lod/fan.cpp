/* The triangles around a vertex, put in order. */
#include "bake/lod/fan.hpp"

namespace gtx::baking {

/* All triangles and vertices as they come. */
static void gather(const Vector<Triangle> &triangles, const uint32_t *around, int count,
                   uint32_t vertex, Fan &fan)
{
    fan.count = count;
    fan.ring_count = 0;
    fan.open = false;
    fan.meeting = true;
    std::copy_n(around, count, fan.triangle);
    for (int i = 0; i < count; ++i)
        for (uint32_t v : triangles[around[i]])
            if (v != vertex && !fan.has(v))
                fan.ring[fan.ring_count++] = v;
}

bool find_fan(const Vector<Triangle> &triangles, const uint32_t *around, size_t triangle_count,
              uint32_t vertex, Fan &fan)
{
    if (triangle_count == 0 || triangle_count > MAX_FAN)
        return false;
    const int count = int(triangle_count);
    uint32_t of[MAX_FAN], after[MAX_FAN], before[MAX_FAN];
    for (int i = 0; i < count; ++i) {
        of[i] = around[i];
        const Triangle &t = triangles[of[i]];
        const int k = corner_of(t, vertex);
        after[i] = t[(k + 1) % 3];
        before[i] = t[(k + 2) % 3];
    }
    int first = 0; /* the one that none leads to, in an open fan */
    for (int i = 0; i < count; ++i)
        if (index_of(before, count, after[i]) == count)
            first = i;
    fan.count = 0;
    fan.ring_count = 0;
    fan.meeting = false;
    for (int i = first; i < count && fan.count < count;) {
        fan.triangle[fan.count++] = of[i];
        fan.ring[fan.ring_count++] = after[i];
        const uint32_t end = before[i];
        fan.open = end != after[first];
        i = index_of(after, count, end);
        if (i == count)
            fan.ring[fan.ring_count++] = end;
        else if (i == first)
            break;
    }
    if (fan.count != count || fan.open != (fan.ring_count == count + 1))
        gather(triangles, around, count, vertex, fan);
    return true;
}

} // namespace gtx::baking
