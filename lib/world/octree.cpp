/* Cells with their numbers of triangles -> the tree of tiles. */
#include "world/plan.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

namespace gtx {

/* A tile's surface loses so much on the way into its parent: half the triangles a side, which
 * doubles their error where a surface is smooth. */
constexpr double LOW_SHARE = 0.25;

namespace {

/* Part of the cells that is to become a tile and what is below it. */
struct Branch {
    size_t from, to;                 /* cells */
    uint64_t first, end;             /* places */
    uint32_t parent, depth;
    std::string name;
};

class Builder {
public:
    Builder(const Vector<CountedCell> &cells, uint64_t most) : cells_(cells), most_(most), sums_(1)
    {
        for (const CountedCell &c : cells)
            sums_.push_back(sums_.back() + c.count);
    }
    Vector<Tile> build();

private:
    uint64_t count(const Branch &b) const { return sums_[b.to] - sums_[b.from]; }
    Branch octant(const Branch &of, unsigned which) const;
    Vector<Branch> octants(const Branch &of) const;
    Vector<Branch> children(Branch &of) const;

    const Vector<CountedCell> &cells_;
    const uint64_t most_;
    Vector<uint64_t> sums_;          /* of all cells before each */
};

} // namespace

Branch Builder::octant(const Branch &of, unsigned which) const
{
    const uint64_t part = (of.end - of.first) / 8;
    Branch out = of;
    out.first = of.first + which * part;
    out.end = out.first + part;
    auto before = [](const CountedCell &c, uint64_t place) { return c.place < place; };
    const auto from = cells_.begin() + std::ptrdiff_t(of.from);
    const auto to = cells_.begin() + std::ptrdiff_t(of.to);
    out.from = size_t(std::lower_bound(from, to, out.first, before) - cells_.begin());
    out.to = size_t(std::lower_bound(from, to, out.end, before) - cells_.begin());
    out.name += char('0' + which);
    return out;
}

Vector<Branch> Builder::octants(const Branch &of) const
{
    Vector<Branch> out;
    for (unsigned k = 0; k < 8; ++k) {
        const Branch next = octant(of, k);
        if (next.to > next.from)
            out.push_back(next);
    }
    return out;
}

/* Goes down to where there are several; those next to each other that fit into one leaf become
 * one. */
Vector<Branch> Builder::children(Branch &of) const
{
    Vector<Branch> all = {of}, out;
    while (all.size() == 1) {
        of = all[0];
        if (of.end - of.first == 1)
            throw Error(GTX_ERROR_LIMIT, "one of 2^20 cells has " + std::to_string(count(of)) +
                                             " triangles: --triangles must allow as many");
        all = octants(of);
    }
    for (const Branch &next : all)
        if (!out.empty() && count(out.back()) + count(next) <= most_) {
            out.back().to = next.to;
            out.back().end = next.end;
        } else {
            out.push_back(next);
        }
    return out;
}

Vector<Tile> Builder::build()
{
    uint64_t places = 1;
    while (places <= cells_.back().place)
        places *= 8;
    std::deque<Branch> left = {{0, cells_.size(), 0, places, 0, 0, "r"}};
    Vector<Tile> tiles;
    for (; !left.empty(); left.pop_front()) {
        Branch branch = left.front();
        const uint32_t number = uint32_t(tiles.size());
        Vector<Branch> below;
        if (count(branch) > most_)
            below = children(branch);
        Tile tile;
        tile.name = branch.name;
        tile.depth = branch.depth;
        tile.parent = branch.parent;
        tile.first = branch.first;
        tile.end = branch.end;
        tile.triangles = count(branch);
        if (number)
            tiles[tile.parent].children.push_back(number);
        tiles.push_back(std::move(tile));
        for (Branch &next : below) {
            next.parent = number;
            next.depth = branch.depth + 1;
            left.push_back(next);
        }
    }
    return tiles;
}

double Plan::low_share(const Tile &of) const
{
    uint64_t sum = 0;
    for (uint32_t child : tiles[of.parent].children)
        sum += tiles[child].triangles;
    return std::min(LOW_SHARE, double(triangles) / double(sum));
}

Vector<Tile> make_tiles(Vector<CountedCell> cells, uint64_t most)
{
    Plan plan;
    plan.triangles = uint32_t(most);
    plan.tiles = Builder(cells, most).build();
    for (size_t n = plan.tiles.size(); n-- > 0;) {
        Tile &tile = plan.tiles[n];
        if (tile.is_leaf())
            continue;
        tile.triangles = 0;
        for (uint32_t child : tile.children)
            tile.triangles += uint64_t(plan.low_share(plan.tiles[child]) *
                                       double(plan.tiles[child].triangles));
    }
    return std::move(plan.tiles);
}

/* ---- boxes ---- */

static uint64_t gathered(uint64_t x)
{
    uint64_t out = 0;
    for (int bit = 0; bit < 21; ++bit)
        out |= (x >> 3 * bit & 1) << bit;
    return out;
}

static void add_box(Tile &to, const Vec3d &low, const Vec3d &high)
{
    for (int k = 0; k < 3; ++k) {
        to.low[k] = std::min(to.low[k], low[k]);
        to.high[k] = std::max(to.high[k], high[k]);
    }
}

/* A cell more on either side is for what rounding may have done. */
void make_boxes(const Lattice &lattice, const Vector<CountedCell> &cells, double reach,
                Vector<Tile> &tiles)
{
    const double side = std::ldexp(1, lattice.exponent);
    Vector<std::pair<uint64_t, size_t>> leaves;
    for (size_t n = 0; n < tiles.size(); ++n)
        if (tiles[n].is_leaf())
            leaves.push_back({tiles[n].first, n});
    std::sort(leaves.begin(), leaves.end());
    size_t at = 0;
    for (const CountedCell &cell : cells) {
        while (at + 1 < leaves.size() && leaves[at + 1].first <= cell.place)
            ++at;
        Vec3d low, high;
        for (int k = 0; k < 3; ++k) {
            const double first = double(lattice.low[k] + int64_t(gathered(cell.place >> k)));
            low[k] = (first - 1) * side - reach;
            high[k] = (first + 2) * side + reach;
        }
        add_box(tiles[leaves[at].second], low, high);
    }
    for (size_t n = tiles.size(); n-- > 1;)
        add_box(tiles[tiles[n].parent], tiles[n].low, tiles[n].high);
}

bool Tile::touches(const Vec3d &from, const Vec3d &to) const
{
    bool touch = true;
    for (int k = 0; k < 3; ++k)
        touch = touch && low[k] <= to[k] && from[k] <= high[k];
    return touch;
}

Vector<const Tile *> Plan::low_neighbours(const Tile &tile) const
{
    Vector<const Tile *> out;
    for (const Tile &other : tiles) {
        const bool is_child = other.depth > 0 && &tiles[other.parent] == &tile;
        const bool is_low = other.depth == tile.depth + 1 ||
                            (other.is_leaf() && other.depth <= tile.depth);
        if (is_low && !is_child && other.touches(tile.low, tile.high))
            out.push_back(&other);
    }
    return out;
}

} // namespace gtx
