/* Counts triangles by place, in a bounded number of cells. */
#include "world/plan.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

/* Cells that are told apart: their table takes 32 MB. A world of 10^9 triangles has a thousand in
 * each. The cells that are left do not depend on the order of what is counted: they are the finest
 * that are few enough. */
constexpr size_t MAX_CELLS = size_t(1) << 20, SLOTS = 2 * MAX_CELLS;
constexpr int BITS = 21;             /* of a coordinate */
constexpr int64_t HALF = int64_t(1) << (BITS - 1), MASK = 2 * HALF - 1;
/* Before anything is counted: finer than any float. */
constexpr int FINEST = -1000;

static uint64_t spread(uint64_t x)
{
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

uint64_t morton(uint64_t x, uint64_t y, uint64_t z)
{
    return spread(x) | spread(y) << 1 | spread(z) << 2;
}

/* Of what lies outside of all cells, which a plan of other triangles may ask, a cell outside. */
static int64_t cell_of(double x, int exponent)
{
    const double out = double(4 * HALF);
    return int64_t(std::clamp(std::floor(std::ldexp(x, -exponent)), -out, out));
}

uint64_t Lattice::place(const Vec3d &p) const
{
    uint64_t at[3];
    for (int k = 0; k < 3; ++k)
        at[k] = uint64_t(std::clamp(cell_of(p[k], exponent) - low[k], int64_t(0), MASK));
    return morton(at[0], at[1], at[2]);
}

static uint64_t pack(const int64_t (&at)[3])
{
    return uint64_t(at[0]) << 2 * BITS | uint64_t(at[1]) << BITS | uint64_t(at[2]);
}

static void unpack(uint64_t cell, int64_t (&at)[3])
{
    for (int k = 0; k < 3; ++k)
        at[k] = int64_t(cell >> (2 - k) * BITS) & MASK;
}

CellCounts::CellCounts() : slots_(SLOTS), exponent_(FINEST) {}

void CellCounts::insert(uint64_t cell, uint64_t count)
{
    if (slots_[last_].cell == cell) { /* most follow one of the same cell: nothing to look for */
        slots_[last_].count += count;
        return;
    }
    size_t at = size_t(cell * 0x9e3779b97f4a7c15u >> (64 - BITS));
    while (slots_[at].cell != cell && slots_[at].cell != UINT64_MAX)
        at = (at + 1) % SLOTS;
    used_ += slots_[at].cell == UINT64_MAX;
    slots_[at].cell = cell;
    slots_[at].count += count;
    last_ = at;
}

void CellCounts::coarsen(int by)
{
    exponent_ += by;
    if (!used_)
        return;
    Vector<Slot> old(SLOTS);
    old.swap(slots_);
    used_ = 0;
    for (const Slot &slot : old) {
        if (slot.cell == UINT64_MAX)
            continue;
        int64_t at[3];
        unpack(slot.cell, at);
        for (int64_t &x : at) /* rounds down, as the cells do */
            x = ((x - HALF) >> std::min(by, 62)) + HALF;
        insert(pack(at), slot.count);
    }
}

/* Makes the cells so large that the numbers of the one at p fit. */
void CellCounts::fit(const Vec3d &p)
{
    const double far = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    if (far == 0)
        return;
    const int wanted = std::ilogb(far) + 2 - BITS;
    if (wanted > exponent_)
        coarsen(wanted - exponent_);
}

void CellCounts::add(const Vec3d &centroid)
{
    fit(centroid);
    int64_t at[3];
    for (int k = 0; k < 3; ++k)
        at[k] = cell_of(centroid[k], exponent_) + HALF;
    insert(pack(at), 1);
    while (used_ > MAX_CELLS)
        coarsen(1);
}

Vector<CountedCell> CellCounts::finish(Lattice &lattice) const
{
    int64_t low[3] = {MASK, MASK, MASK}, at[3];
    for (const Slot &slot : slots_)
        if (slot.cell != UINT64_MAX) {
            unpack(slot.cell, at);
            for (int k = 0; k < 3; ++k)
                low[k] = std::min(low[k], at[k]);
        }
    Vector<CountedCell> cells;
    for (const Slot &slot : slots_)
        if (slot.cell != UINT64_MAX) {
            unpack(slot.cell, at);
            cells.push_back({morton(uint64_t(at[0] - low[0]), uint64_t(at[1] - low[1]),
                                    uint64_t(at[2] - low[2])), slot.count});
        }
    std::sort(cells.begin(), cells.end(), [](const CountedCell &a, const CountedCell &b) {
        return a.place < b.place;
    });
    lattice.exponent = exponent_;
    for (int k = 0; k < 3; ++k)
        lattice.low[k] = low[k] - HALF;
    return cells;
}

} // namespace gtx
