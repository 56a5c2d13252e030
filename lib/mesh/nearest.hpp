/* Nearest point on many small shapes: a balanced tree of boxes, split at medians. */
#pragma once

#include "mesh/near_shapes.hpp"
#include "mesh/task.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace gtx {

/* `Shapes` has size(), box(i) and distance2(i, p, bound), which may answer anything >= bound for
 * what is not nearer than that, `bound` itself where it is told by little work; otherwise shape i
 * takes as much time as looks(i) nodes of the tree. It outlives the tree. */
template <class Shapes> class NearestTree {
public:
    /* On the task's threads, with so much of its stage `done`. `in_order`: the shapes are that of
     * a tree already, but for a few, and stay so. */
    NearestTree(const Shapes &shapes, Task &task, double done, bool in_order = false)
        : shapes_(shapes)
    {
        leaves_ = 1;
        while (leaves_ * LEAF < shapes.size())
            leaves_ *= 2;
        const auto parallel = [&](size_t count, const std::function<void(size_t)> &body) {
            task.parallel(count, body, done, done);
        };
        order_.resize(shapes.size());
        if (in_order)
            std::iota(order_.begin(), order_.end(), 0u);
        else
            find_order(parallel);
        boxes_.resize(2 * leaves_);
        parallel(parts(), [&](size_t part) {
            for (uint32_t i = first(part); i < first(part + 1); ++i)
                boxes_[leaves_ + i / LEAF].add(shapes_.box(order_[i]));
        });
        for (size_t n = leaves_ - 1; n > 0; --n) {
            boxes_[n].add(boxes_[2 * n]);
            boxes_[n].add(boxes_[2 * n + 1]);
        }
    }

    /* Parts of the tree that may be visited by themselves, whatever the number of threads. */
    size_t parts() const { return (leaves_ + PART - 1) / PART; }

    /* Of all shapes of a part. */
    const Box &box(size_t part) const { return boxes_[root(part)]; }

    /* Visits the shapes of a part, close ones one after another, but those in a box that `skips` is
     * true of. */
    template <class Skips, class Visit>
    void visit(size_t part, const Skips &skips, const Visit &visit) const
    {
        visit_below(root(part), skips, visit);
    }
    /* Of all parts, in a tree of renumbered shapes, from one close by up the tree; from the root
     * down where that is none. */
    template <class Skips, class Visit>
    void visit_around(uint32_t near, const Skips &skips, const Visit &visit) const
    {
        size_t node = near < shapes_.size() ? leaves_ + near / LEAF : 1;
        visit_below(node, skips, visit);
        for (; node > 1; node /= 2)
            if (!skips(boxes_[node ^ 1]))
                visit_below(node ^ 1, skips, visit);
    }

    /* The squared distance to the nearest shape; infinity when there is none. `*near` is a shape to
     * try first, such as the nearest of a point close by (any number from size() on: none), and
     * becomes the nearest: a short distance known early spares most of the search. Only shapes that
     * `counts(shape)` is true of are sought. `*looks` are the nodes that may be looked at, which
     * become fewer: where they are spent, the shape found by so few may not be the nearest. The
     * search ends at a shape that is as near as `enough`, a squared distance. */
    template <class Counts>
    double distance2(const Vec3d &p, uint32_t *near, const Counts &counts,
                     size_t *looks = nullptr, double enough = 0) const
    {
        double known = std::numeric_limits<double>::infinity();
        if (*near < shapes_.size() && counts(*near))
            known = shapes_.distance2(*near, p, known);
        return nearer(known, p, near, counts, looks, enough);
    }
    /* The same where the squared distance to `*near` is known, or infinity. */
    template <class Counts>
    double nearer(double best, const Vec3d &p, uint32_t *near, const Counts &counts,
                  size_t *looks = nullptr, double enough = 0) const
    {
        constexpr size_t FEW = 32; /* they lead down one way */
        const size_t most = looks ? std::max(*looks, FEW) : SIZE_MAX;
        size_t left = most;
        best = nearer_below(1, boxes_[1].distance2(p), best, p, near, counts, left, enough);
        cancel_point(LOOK_TURNS * (most - left));
        if (looks)
            *looks -= std::min(*looks, most - left);
        return best;
    }
    /* Gives each shape its place in the tree as number, and returns which it was: shapes that are
     * close are then close in memory, if the caller orders them so before any other call. */
    Vector<uint32_t> renumber()
    {
        Vector<uint32_t> were = order_;
        std::iota(order_.begin(), order_.end(), 0u);
        return were;
    }
    /* As nearer(), in a tree of renumbered shapes, of which `*near` is one close by: from there up
     * the tree, which takes less than from the root down. */
    double nearer_around(double best, const Vec3d &p, uint32_t *near, double enough) const
    {
        const auto any = [](uint32_t) { return true; };
        size_t left = SIZE_MAX, node = leaves_ + *near / LEAF;
        best = nearer_below(node, 0, best, p, near, any, left, enough);
        for (; node > 1 && best > enough; node /= 2) {
            const double distance = boxes_[node ^ 1].distance2(p);
            --left;
            if (distance < best)
                best = nearer_below(node ^ 1, distance, best, p, near, any, left, enough);
        }
        cancel_point(LOOK_TURNS * (SIZE_MAX - left));
        return best;
    }
    double distance2(const Vec3d &p, uint32_t *near, size_t *looks = nullptr) const
    {
        return distance2(p, near, [](uint32_t) { return true; }, looks);
    }

private:
    static constexpr size_t LEAF = 4;
    static constexpr size_t LOOK_TURNS = 8; /* of a short loop, that take as long as a look */

    static constexpr size_t PART = 1024;    /* leaves of a part */
    static constexpr size_t FORKS = 16;     /* nodes that are ordered at once */

    struct Way {
        size_t node;
        double distance;         /* squared, of its box */
    };
    struct Centre {
        Vec3f at;
        uint32_t shape;
    };

    template <class Skips, class Visit>
    void visit_below(size_t root, const Skips &skips, const Visit &visit) const
    {
        constexpr size_t MANY = 64; /* nodes for a cancellation point */
        size_t stack[64], size = 0, nodes = 0;
        stack[size++] = root;
        while (size) {
            const size_t node = stack[--size];
            if (++nodes % MANY == 0)
                cancel_point(LOOK_TURNS * MANY);
            if (skips(boxes_[node]))
                continue;
            if (node < leaves_) {
                stack[size++] = 2 * node + 1;
                stack[size++] = 2 * node;
                continue;
            }
            const size_t from = (node - leaves_) * LEAF;
            for (size_t i = from; i < std::min(from + LEAF, order_.size()); ++i)
                visit(order_[i]);
        }
        cancel_point(LOOK_TURNS * (nodes % MANY));
    }

    template <class Counts>
    double nearer_below(size_t node, double distance, double best, const Vec3d &p, uint32_t *near,
                        const Counts &counts, size_t &left, double enough) const
    {
        Way stack[64], at = {node, distance};
        size_t size = 0;
        while (best > enough && left) {
            if (!(at.distance < best)) {
                if (!size)
                    break;
                at = stack[--size];
                continue;
            }
            --left;
            if (at.node >= leaves_) {
                const size_t first = (at.node - leaves_) * LEAF;
                for (size_t i = first; i < std::min(first + LEAF, order_.size()); ++i) {
                    if (!counts(order_[i]))
                        continue;
                    const double distance2 = shapes_.distance2(order_[i], p, best);
                    left -= std::min(left, distance2 == best ? 1 : shapes_.looks(order_[i]));
                    if (distance2 < best) {
                        best = distance2;
                        *near = order_[i];
                    }
                }
                at.distance = best;
                continue;
            }
            const size_t child = 2 * at.node;
            const double low = boxes_[child].distance2(p), high = boxes_[child + 1].distance2(p);
            const bool low_first = low <= high;
            const double farther = low_first ? high : low;
            stack[size] = {child + low_first, farther};
            size += farther < best;
            at = {child + !low_first, low_first ? low : high};
        }
        return best;
    }

    size_t root(size_t part) const { return leaves_ / std::min(leaves_, PART) + part; }
    uint32_t first(size_t part) const
    {
        return uint32_t(std::min(part * PART * LEAF, shapes_.size()));
    }

    template <class Parallel> void find_order(const Parallel &parallel)
    {
        Vector<Centre> centres(shapes_.size());
        parallel(parts(), [&](size_t part) {
            for (uint32_t i = first(part); i < first(part + 1); ++i)
                centres[i] = {Vec3f(shapes_.box(i).centre()), i};
        });
        size_t nodes = 1;
        for (; nodes < std::min(parts(), FORKS); nodes *= 2)
            parallel(nodes, [&](size_t n) { halve(centres, leaves_ / nodes, n); });
        parallel(nodes, [&](size_t n) { split(centres, leaves_ / nodes, n); });
        parallel(parts(), [&](size_t part) {
            for (uint32_t i = first(part); i < first(part + 1); ++i)
                order_[i] = centres[i].shape;
            /* In which order halving leaves them is the library's choice. */
            for (size_t i = first(part), end = first(part + 1); i < end; i += LEAF)
                std::sort(&order_[i], &order_[i] + std::min(LEAF, end - i));
        });
    }
    /* Orders the shapes of the `n`th node of so many leaves: those of its first child have the
     * lower centres along the longest side of all, and fill it. */
    void halve(Vector<Centre> &centres, size_t leaves, size_t n) const
    {
        const auto place = [&](size_t leaf) {
            return centres.begin() + std::ptrdiff_t(std::min(leaf * LEAF, centres.size()));
        };
        const auto from = place(n * leaves), to = place((n + 1) * leaves);
        const auto middle = place(n * leaves + leaves / 2);
        if (middle == to)
            return;
        cancel_point(size_t(to - from));
        Box all;
        for (auto i = from; i != to; ++i)
            all.add({i->at, i->at});
        const Vec3f side = all.high - all.low;
        const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
        select(&*from, &*from + (middle - from), &*from + (to - from), axis);
    }
    /* What std::nth_element does, with pivots of samples, so that few rounds are needed, and no
     * branch on a comparison, which nobody could foresee. */
    static void select(Centre *from, Centre *middle, Centre *to, int axis)
    {
        constexpr std::ptrdiff_t FEW = 16, MANY = 1024, SAMPLES = FEW;
        constexpr int ROUNDS = 64; /* of five that are to be expected */
        const auto before = [axis](const Centre &a, const Centre &b) {
            const float x = a.at[axis], y = b.at[axis];
            return bool(int(x < y) | (int(x == y) & int(a.shape < b.shape)));
        };
        for (int round = 0; to - from > FEW && round < ROUNDS; ++round) {
            const std::ptrdiff_t size = to - from, samples = size > MANY ? SAMPLES : SAMPLES / 4;
            Centre sample[SAMPLES];
            for (std::ptrdiff_t i = 0; i < samples; ++i)
                sample[i] = from[(2 * i + 1) * size / (2 * samples)];
            order_few(sample, samples, before);
            const Centre pivot = sample[(middle - from) * samples / size];
            Centre *end = from; /* of what comes before the pivot */
            for (Centre *i = from; i != to; ++i) {
                const Centre moved = *i;
                *i = *end;
                *end = moved;
                end += before(moved, pivot);
            }
            if (end == from) /* the pivot is the first of all */
                break;
            (middle < end ? to : from) = end;
        }
        if (to - from <= FEW)
            order_few(from, to - from, before);
        else
            std::nth_element(from, middle, to, before);
    }
    /* Each goes where as many are before it. */
    template <class Before>
    static void order_few(Centre *from, std::ptrdiff_t count, const Before &before)
    {
        Centre few[16];
        std::ptrdiff_t rank[16] = {};
        std::copy_n(from, count, few);
        for (std::ptrdiff_t i = 1; i < count; ++i)
            for (std::ptrdiff_t k = 0; k < i; ++k) {
                const bool later = before(few[k], few[i]);
                rank[i] += later;
                rank[k] += !later;
            }
        for (std::ptrdiff_t i = 0; i < count; ++i)
            from[rank[i]] = few[i];
    }
    void split(Vector<Centre> &centres, size_t leaves, size_t n) const
    {
        if (leaves == 1 || n * leaves * LEAF >= centres.size())
            return;
        halve(centres, leaves, n);
        split(centres, leaves / 2, 2 * n + 1);
        split(centres, leaves / 2, 2 * n);
    }

    const Shapes &shapes_;
    Vector<uint32_t> order_;
    Vector<Box> boxes_;      /* heap order: children of n at 2n and 2n + 1, leaves last */
    size_t leaves_;
};

} // namespace gtx
