/* The order of an LOD mesh's triangles. */
#pragma once

#include "bake/lod/parts.hpp"

#include <algorithm>
#include <deque>

namespace gtx::baking {

/* Edges among which the next triangle is looked for, as the asset's coding does: 0.2 % bytes. */
constexpr size_t RECENT_EDGES = 16;

using Triangle = std::array<uint32_t, 3>;

/* Triangles in an order where most share an edge with one just before: few bytes, and vertices that
 * a processor still remembers. */
class Strip {
public:
    Strip(const Vector<Triangle> &triangles, const Vector<uint32_t> &patch,
          size_t vertices)
        : triangles_(triangles), patch_(patch), start_(vertices + 1, 0), left_(triangles.size(), 0),
          passed_(3 * triangles.size(), 0)
    {
        for (const Triangle &t : triangles)
            for (uint32_t v : t)
                ++start_[v + 1];
        for (size_t v = 0; v < vertices; ++v)
            start_[v + 1] += start_[v];
        around_.resize(3 * triangles.size());
        Vector<uint32_t> next(start_.begin(), start_.end() - 1);
        for (size_t t = 0; t < triangles.size(); ++t)
            for (uint32_t v : triangles[t])
                around_[next[v]++] = uint32_t(t);
        for (uint32_t v = 0; v < vertices; ++v) {
            cancel_point();
            std::sort(around_.begin() + start_[v], around_.begin() + start_[v + 1],
                      [&](uint32_t a, uint32_t b) {
                          return std::pair(key(a, v), a) < std::pair(key(b, v), b);
                      });
        }
    }
    /* Adds the triangles `members` of a patch, corners turned so that a shared edge comes first. */
    void follow(uint32_t patch, const Vector<uint32_t> &members, Vector<Triangle> &out)
    {
        for (uint32_t t : members)
            left_[t] = 1;
        Triangle next;
        auto go_on = [&] {
            while (find_beside(patch, next))
                take(next, out);
        };
        go_on();
        for (uint32_t seed : members) {
            if (!left_[seed])
                continue;
            left_[seed] = 0;
            take(triangles_[seed], out);
            go_on();
        }
    }

private:
    using Edge = std::array<uint32_t, 2>;

    void take(const Triangle &t, Vector<Triangle> &out)
    {
        out.push_back(t);
        for (int k = 0; k < 3; ++k)
            recent_.push_front({t[(k + 1) % 3], t[k]});
        while (recent_.size() > RECENT_EDGES)
            recent_.pop_back();
    }
    bool find_beside(uint32_t patch, Triangle &found)
    {
        for (const Edge &edge : recent_) {
            const Key wanted = {patch, edge[1]};
            const auto of = [&](uint32_t t) { return key(t, edge[0]); };
            const auto end = around_.begin() + start_[edge[0] + 1];
            auto at = std::lower_bound(around_.begin() + start_[edge[0]], end, wanted,
                                       [&](uint32_t t, const Key &k) { return of(t) < k; });
            if (at == end || of(*at) != wanted)
                continue;
            uint32_t &passed = passed_[size_t(at - around_.begin())];
            for (at += passed; at != end && of(*at) == wanted; ++at, ++passed) {
                if (!left_[*at])
                    continue;
                const Triangle &t = triangles_[*at];
                const int k = corner_of(t, edge[0]);
                found = {t[k], t[(k + 1) % 3], t[(k + 2) % 3]};
                left_[*at] = 0;
                return true;
            }
        }
        return false;
    }
    static int corner_of(const Triangle &t, uint32_t v)
    {
        return t[0] == v ? 0 : t[1] == v ? 1 : 2;
    }
    /* What a triangle is sought by at one of its vertices: its patch, and the vertex after it. */
    using Key = std::pair<uint32_t, uint32_t>;
    Key key(uint32_t triangle, uint32_t v) const
    {
        const Triangle &t = triangles_[triangle];
        return {patch_[triangle], t[(corner_of(t, v) + 1) % 3]};
    }

    const Vector<Triangle> &triangles_;
    const Vector<uint32_t> &patch_;
    Vector<uint32_t> start_, around_;      /* those around each vertex, by key */
    Vector<uint8_t> left_;                 /* to be followed */
    Vector<uint32_t> passed_;              /* of a key, at its first: how many are not left */
    std::deque<Edge> recent_;
};

} // namespace gtx::baking
