/* The inside of welding: all pieces of a surface as one, and what is done to their borders. */
#pragma once

#include "bake/lod/fields.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace gtx::baking {

using Edge = std::array<uint32_t, 2>;
using OpenEdge = std::pair<Edge, uint32_t>; /* and the triangle that has it */

/* Points to be found by place. */
class Places {
public:
    explicit Places(double size) : size_(size) {}
    void add(const Vec3d &at, uint32_t value) { cells_[key(at, 0, 0, 0)].push_back(value); }
    double size() const { return size_; }
    /* Calls with all values no farther than a cell's size, and some beyond. */
    template <class Body> void around(const Vec3d &at, Body body) const
    {
        for (int k = 0; k < 27; ++k) {
            const auto found = cells_.find(key(at, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            if (found != cells_.end())
                for (uint32_t value : found->second)
                    body(value);
        }
    }

private:
    using Key = std::array<int64_t, 3>;
    struct Hash {
        size_t operator()(const Key &k) const
        {
            return size_t(k[0]) * 73856093u ^ size_t(k[1]) * 19349663u ^ size_t(k[2]) * 83492791u;
        }
    };
    Key key(const Vec3d &at, int x, int y, int z) const
    {
        auto cell = [&](double v) { return int64_t(std::clamp(v / size_, -1e15, 1e15) + 2e15); };
        return {cell(at.x) + x, cell(at.y) + y, cell(at.z) + z};
    }
    double size_;
    std::unordered_map<Key, Vector<uint32_t>, Hash> cells_;
};

/* All pieces as one, and their common border vertices. */
class Welder {
public:
    Welder(const Vector<MapField> &fields, Vector<FieldPiece> pieces,
           const Vector<Vector<uint32_t>> &others);

    void join_vertices();
    void split_edges();
    void drop_folds();
    void close_gaps();

    LodSource source;

private:
    double reach(uint32_t vertex) const;
    bool facing(uint32_t a, uint32_t b) const;
    uint32_t find_common(uint32_t vertex) const;
    void drop_collapsed();
    void drop(const Vector<uint8_t> &dropped);
    Vector<uint32_t> stops_on(const OpenEdge &open, const Places &ends,
                              const Vector<Vector<uint32_t>> &beside) const;
    void divide(const OpenEdge &open, Vector<uint32_t> stops);
    Vector<OpenEdge> open_edges() const;
    bool goes_on(const OpenEdge &open) const;
    bool is_gap(const Vector<OpenEdge> &edges) const;
    void close(const Vector<OpenEdge> &edges);
    void close_around_middle(const Vector<uint32_t> &ring,
                             const Vector<uint32_t> &patch);
    void add(const Triangle &t, uint32_t patch);
    static uint64_t pair_of(uint32_t from, uint32_t to) { return uint64_t(from) << 32 | to; }

    const Vector<MapField> &fields_;
    const Vector<Vector<uint32_t>> &others_;
    Vector<Vec3d> normals_;
    Vector<uint32_t> piece_;        /* of a vertex: the first that had it */
    Vector<uint8_t> at_border_;
    Places places_;                 /* of the common vertices */
    std::unordered_set<uint64_t> used_; /* edges of triangles, while gaps are closed */
};

} // namespace gtx::baking
