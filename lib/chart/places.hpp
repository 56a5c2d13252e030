/* Where triangles are in a list: a hash by their number. */
#pragma once

#include "mesh/mesh.hpp"

namespace gtx {

class Places {
public:
    explicit Places(size_t expected) { resize(expected); }

    /* False where the triangle has a place already, which it keeps. */
    bool add(uint32_t triangle, uint32_t place)
    {
        if (2 * ++count_ > slots_.size())
            resize(count_);
        Slot &slot = slots_[slot_of(triangle)];
        if (slot.triangle == triangle) {
            --count_;
            return false;
        }
        slot = {triangle, place};
        return true;
    }
    bool has(uint32_t triangle) const { return find(triangle) != NO_TRIANGLE; }
    /* NO_TRIANGLE where it has none. */
    uint32_t find(uint32_t triangle) const { return slots_[slot_of(triangle)].place; }

private:
    struct Slot {
        uint32_t triangle = NO_TRIANGLE, place = NO_TRIANGLE;
    };

    size_t slot_of(uint32_t triangle) const
    {
        size_t at = triangle * 0x9e3779b1u >> shift_; /* numbers close together spread evenly */
        while (slots_[at].triangle != triangle && slots_[at].triangle != NO_TRIANGLE)
            at = (at + 1) & (slots_.size() - 1);
        return at;
    }
    void resize(size_t expected)
    {
        while (shift_ > 1 && (size_t(1) << (32 - shift_)) < 4 * expected)
            --shift_;
        Vector<Slot> old(size_t(1) << (32 - shift_));
        old.swap(slots_);
        for (const Slot &slot : old)
            if (slot.triangle != NO_TRIANGLE)
                slots_[slot_of(slot.triangle)] = slot;
    }

    Vector<Slot> slots_;         /* a power of two, at most half of them taken */
    unsigned shift_ = 28;
    size_t count_ = 0;
};

} // namespace gtx
