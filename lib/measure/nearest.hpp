/* Nearest point on many small shapes: a balanced tree of boxes over the shapes in Morton order. */
#pragma once

#include "mesh/vec.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace gtx {

struct Box {
    static constexpr float HUGE_F = std::numeric_limits<float>::infinity();
    Vec3f low{HUGE_F, HUGE_F, HUGE_F}, high{-HUGE_F, -HUGE_F, -HUGE_F};

    /* Rounded outwards. */
    void add(const Vec3d &p)
    {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], std::nextafter(float(p[k]), -HUGE_F));
            high[k] = std::max(high[k], std::nextafter(float(p[k]), HUGE_F));
        }
    }
    void add(const Box &b)
    {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], b.low[k]);
            high[k] = std::max(high[k], b.high[k]);
        }
    }
    Vec3d centre() const { return (Vec3d(low) + Vec3d(high)) * 0.5; }
    double distance2(const Vec3d &p) const
    {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            double d = std::max({low[k] - p[k], p[k] - high[k], 0.});
            sum += d * d;
        }
        return sum;
    }
};

/* The squared distance from p to the triangle abc. */
double triangle_distance2(const Vec3d &p, const Vec3d &a, const Vec3d &b, const Vec3d &c);

/* `Shapes` has size(), box(i) and distance2(i, p, bound), which may answer anything >= bound for
 * what is not nearer than that. It outlives the tree. */
template <class Shapes> class NearestTree {
public:
    explicit NearestTree(const Shapes &shapes) : shapes_(shapes)
    {
        sort();
        leaves_ = 1;
        while (leaves_ * LEAF < order_.size())
            leaves_ *= 2;
        boxes_.resize(2 * leaves_);
        for (size_t i = 0; i < order_.size(); ++i)
            boxes_[leaves_ + i / LEAF].add(shapes_.box(order_[i]));
        for (size_t n = leaves_ - 1; n > 0; --n) {
            boxes_[n].add(boxes_[2 * n]);
            boxes_[n].add(boxes_[2 * n + 1]);
        }
    }

    /* The squared distance to the nearest shape; infinity when there is none. */
    double distance2(const Vec3d &p) const
    {
        double best = std::numeric_limits<double>::infinity();
        std::pair<size_t, double> stack[64];
        int size = 0;
        stack[size++] = {1, boxes_[1].distance2(p)};
        while (size) {
            auto [node, distance] = stack[--size];
            if (distance >= best)
                continue;
            if (node >= leaves_) {
                size_t first = (node - leaves_) * LEAF;
                for (size_t i = first; i < std::min(first + LEAF, order_.size()); ++i)
                    best = std::min(best, shapes_.distance2(order_[i], p, best));
                continue;
            }
            std::pair<size_t, double> child[2];
            for (size_t k = 0; k < 2; ++k)
                child[k] = {2 * node + k, boxes_[2 * node + k].distance2(p)};
            bool first_nearer = child[0].second <= child[1].second;
            stack[size++] = child[first_nearer ? 1 : 0];
            stack[size++] = child[first_nearer ? 0 : 1];
        }
        return best;
    }

private:
    static constexpr size_t LEAF = 4;

    /* Every third bit of the result is a bit of v, 21 of them. */
    static uint64_t spread(uint64_t v)
    {
        uint64_t out = 0;
        for (int bit = 0; bit < 21; ++bit)
            out |= (v >> bit & 1) << (3 * bit);
        return out;
    }

    void sort()
    {
        Box whole;
        for (size_t i = 0; i < shapes_.size(); ++i)
            whole.add(shapes_.box(i));
        Vec3d low(whole.low), size = Vec3d(whole.high) - low;
        std::vector<std::pair<uint64_t, uint32_t>> keys(shapes_.size());
        for (size_t i = 0; i < keys.size(); ++i) {
            Vec3d c = shapes_.box(i).centre() - low;
            uint64_t code = 0;
            for (int k = 0; k < 3; ++k)
                code |= spread(uint64_t(std::clamp(c[k] / size[k], 0., 1.) * 0x1fffff)) << k;
            keys[i] = {code, uint32_t(i)};
        }
        std::sort(keys.begin(), keys.end());
        for (auto &key : keys)
            order_.push_back(key.second);
    }

    const Shapes &shapes_;
    std::vector<uint32_t> order_;
    std::vector<Box> boxes_; /* heap order: children of n at 2n and 2n + 1, leaves last */
    size_t leaves_;
};

} // namespace gtx
