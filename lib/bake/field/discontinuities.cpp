/* Depth discontinuities: two height fields side by side in the map, which no cell may bridge. */
#include "bake/field/chart_field.hpp"

#include <algorithm>
#include <tuple>

namespace gtx::baking {

/* Knuth 6.4: where in a table of a power of two to look for a triangle first. */
static size_t hashed(uint32_t triangle, size_t size)
{
    return size_t(triangle * 0x9e3779b97f4a7c15u >> 32) & (size - 1);
}

void Paths::grow_table()
{
    table_.assign(std::max<size_t>(64, 2 * table_.size()), NO_TRIANGLE);
    for (uint32_t place = 0; place < places_.size(); ++place) {
        size_t at = hashed(places_[place].triangle, table_.size());
        while (table_[at] != NO_TRIANGLE)
            at = (at + 1) & (table_.size() - 1);
        table_[at] = place;
    }
}

/* Searches come to the same triangles again and again: each is laid flat once. */
uint32_t Paths::place_of(uint32_t triangle)
{
    if (2 * places_.size() >= table_.size())
        grow_table();
    size_t at = hashed(triangle, table_.size());
    while (table_[at] != NO_TRIANGLE && places_[table_[at]].triangle != triangle)
        at = (at + 1) & (table_.size() - 1);
    if (table_[at] != NO_TRIANGLE)
        return table_[at];
    table_[at] = uint32_t(places_.size());
    Vec3d p[3];
    Place place;
    for (int k = 0; k < 3; ++k) {
        p[k] = chart_.grid.texel(mesh_.position(triangle, k));
        place.corner[k][0] = p[k].x;
        place.corner[k][1] = p[k].y;
    }
    for (int k = 0; k < 2; ++k) {
        place.low[k] = std::min({p[0][k], p[1][k], p[2][k]});
        place.high[k] = std::max({p[0][k], p[1][k], p[2][k]});
    }
    place.triangle = triangle;
    std::fill_n(place.near, 3, UNKNOWN);
    place.seen = 0;
    places_.push_back(place);
    return table_[at];
}

/* The place across a side, NO_TRIANGLE where the model ends. */
uint32_t Paths::near(uint32_t place, size_t side)
{
    uint32_t found = places_[place].near[side];
    if (found != UNKNOWN)
        return found;
    const uint32_t beyond = neighbours_[places_[place].triangle][side];
    found = beyond == NO_TRIANGLE ? NO_TRIANGLE : place_of(beyond);
    places_[place].near[side] = found;
    return found;
}

bool Paths::Window::meets(const double begin[2], const double end[2]) const
{
    const double a[2] = {begin[0] - u, begin[1] - v}, b[2] = {end[0] - u, end[1] - v};
    for (int k = 0; k < 2; ++k)
        if (std::min(a[k], b[k]) > reach || std::max(a[k], b[k]) < -reach)
            return false;
    /* neither axis parts them, nor the line's own normal */
    return std::fabs(a[0] * b[1] - a[1] * b[0]) <=
           reach * (std::fabs(b[0] - a[0]) + std::fabs(b[1] - a[1]));
}

void Paths::begin(End &end, uint32_t place)
{
    end.search = ++searches_;
    end.next = 0;
    end.queue.assign(1, place);
    places_[place].seen = end.search;
}

/* From both ends, a triangle of each in turn: where no way leads, the smaller part is soon at its
 * end. Many ask for ways from one place to all around it: what that end has found stays. */
bool Paths::joined(uint32_t from, uint32_t to, double u, double v, double reach, Ways ways)
{
    const uint32_t source = chart_.triangles[from].source, goal = chart_.triangles[to].source;
    if (source == goal)
        return true;
    const Window window = {source, u, v, reach, ways};
    if (!(window == window_)) {
        window_ = window;
        begin(ends_[0], place_of(source));
    }
    const uint32_t last = place_of(goal);
    if (places_[last].seen == ends_[0].search)
        return true;
    if (window.misses(places_[last]))
        return false;
    begin(ends_[1], last);
    for (size_t turn = 0; !budget_.spent(); turn = !turn) {
        End &end = ends_[turn];
        if (end.next == end.queue.size())
            return false;
        budget_.spend(1);
        cancel_point(); /* three places all over memory take as long as two steps */
        cancel_point();
        const uint32_t here = end.queue[end.next];
        for (size_t side = 0; side < 3; ++side) {
            const uint32_t beyond = near(here, side);
            if (beyond == NO_TRIANGLE || !window.lets_cross(places_[here], side))
                continue;
            Place &place = places_[beyond];
            if (place.seen == ends_[!turn].search)
                return true;
            if (place.seen == end.search || window.misses(place))
                continue;
            place.seen = end.search;
            end.queue.push_back(beyond);
        }
        ++end.next;
    }
    return false;
}

namespace {

/* Which cells show, and which of them bridge. */
class Bridges {
public:
    Bridges(ChartField &field, Paths &paths)
        : field_(field), grid_(field.flat.grid), cover_(field.cover), paths_(paths),
          jump_(JUMP * grid_.coarse_pitch())
    {
    }

    /* Which jumps are bridged when a cell spans them. */
    enum Jumps { UNJOINED, BESIDE_CORE };
    void find(Jumps jumps);
    void give_to_core(const Outline &core);
    void cut();

private:
    std::array<size_t, 4> corners(size_t cell) const
    {
        size_t w = size_t(grid_.w);
        return {cell, cell + 1, cell + w, cell + w + 1};
    }
    /* The cells with this corner, which is not on the grid's first row or column. */
    std::array<size_t, 4> around(size_t texel) const
    {
        size_t w = size_t(grid_.w);
        return {texel - w - 1, texel - w, texel - 1, texel};
    }
    bool bridges(Jumps jumps, size_t cell);
    /* What is lost with a texel: the share of the surface, not of what continues it, in the good
     * cells around it; for each of the bad ones that go too. */
    double loss(size_t texel) const;

    bool is_core(size_t texel) const { return cover_.triangle[texel] < field_.flat.core; }
    bool continue_core(size_t texel, double &height) const;

    ChartField &field_;
    const Grid &grid_;
    Cover &cover_;
    Paths &paths_;
    const double jump_;
    enum : uint8_t { NONE, GOOD, BAD };
    Vector<uint8_t> cells_;
};

/* Whether a step between corners of a cell is more than a slope, with no surface along it: or even
 * with that where it leaves the core, for a wall that begins there is another chart's. */
bool Bridges::bridges(Jumps jumps, size_t cell)
{
    /* From the middle of the cell. Spot's control mesh: 2 % more patches at half, 0.2 % RMS at
     * double (Duck). chart/layers.cpp looks a texel farther, for what it splits is a patch more. */
    constexpr double REACH = 1.5;
    const Outline &outline = field_.outline;
    std::array<size_t, 4> corner = corners(cell);
    double low = INFINITY, high = -INFINITY;
    for (size_t texel : corner) {
        low = std::min(low, cover_.height[texel]);
        high = std::max(high, cover_.height[texel]);
    }
    if (high - low <= jump_)
        return false;
    auto triangle = [&](size_t texel) {
        uint32_t t = cover_.triangle[texel];
        return t != NO_TRIANGLE ? t : outline.edges[outline.nearest[texel]].triangle;
    };
    /* Beyond the outline nothing is lost with a cell, and between two far heights it is a sheet in
     * the air, unless a wall is there. Spot's control mesh: 746 wall pixels without. Where an
     * outline crosses the cell it may be all that shows a wall: an engine, a slit of 50 pixels. FAR
     * at half and at double: Spot's control mesh 17 and 25 wall pixels for 19, gargoyle 74 and 75
     * for 74. */
    constexpr double FAR = 2; /* jumps */
    const bool beyond = std::all_of(corner.begin(), corner.end(),
                                    [&](size_t texel) { return field_.trim[texel] > 0; });
    double u = double(cell % grid_.w) + 0.5, v = double(cell / grid_.w) + 0.5;
    for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b) {
            double step = std::fabs(cover_.height[corner[a]] - cover_.height[corner[b]]);
            if (step <= jump_)
                continue;
            if (jumps == BESIDE_CORE && is_core(corner[a]) != is_core(corner[b]))
                return true;
            if (!paths_.joined(triangle(corner[a]), triangle(corner[b]), u, v, REACH,
                               beyond && step > FAR * jump_ ? Paths::OVER_EDGES
                                                            : Paths::OVER_TRIANGLES))
                return true;
        }
    }
    return false;
}

double Bridges::loss(size_t texel) const
{
    /* Against 1 for the overlap, where another chart's core lies. 0.4 % texels at half or double
     * (truck). */
    constexpr double CORE = 4;
    double lost = 0;
    int bad = 0;
    for (size_t cell : around(texel)) {
        bad += cells_[cell] == BAD;
        if (cells_[cell] != GOOD)
            continue;
        for (size_t c : corners(cell)) {
            uint32_t t = cover_.triangle[c];
            if (t != NO_TRIANGLE)
                lost += t < field_.flat.core ? CORE : 1;
        }
    }
    return lost / bad;
}

/* The height of the core continued by a texel: the mean over its neighbours in the core of a line
 * through each and the one behind it. False where there is none, or where they do not agree. */
bool Bridges::continue_core(size_t texel, double &height) const
{
    const int w = grid_.w, h = grid_.h, x = int(texel) % w, y = int(texel) / w;
    double sum = 0, low = INFINITY, high = -INFINITY;
    int count = 0;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            int nx = x + dx, ny = y + dy, bx = nx + dx, by = ny + dy;
            if (nx < 0 || ny < 0 || nx >= w || ny >= h || !is_core(size_t(ny) * w + nx))
                continue;
            double near = cover_.height[size_t(ny) * w + nx], slope = 0;
            if (bx >= 0 && by >= 0 && bx < w && by < h && is_core(size_t(by) * w + bx))
                slope = near - cover_.height[size_t(by) * w + bx];
            sum += near + (std::fabs(slope) <= jump_ ? slope : 0);
            low = std::min(low, near);
            high = std::max(high, near);
            ++count;
        }
    }
    height = sum / std::max(count, 1);
    return count > 0 && high - low <= jump_;
}

/* A texel beyond the core that makes a bridge with it may as well continue the core: what lies
 * there is shown by another chart. So the core keeps its last cell. But where the core itself rises
 * as steeply, the surface beyond is its best continuation. */
void Bridges::give_to_core(const Outline &core)
{
    /* Texels of depth above the continued core: a wall begins. Spot's control mesh: 1 % RMS. */
    constexpr double RISE = 3;
    const double rise = RISE * grid_.coarse_pitch();
    auto leaves_core = [&](double beyond, double continued) {
        return beyond < continued || beyond >= continued + rise;
    };
    Vector<std::pair<size_t, double>> given;
    for (size_t cell = 0; cell < cells_.size(); ++cell) {
        double height;
        if (cells_[cell] == BAD)
            for (size_t texel : corners(cell))
                if (!is_core(texel) && continue_core(texel, height) &&
                    leaves_core(cover_.height[texel], height))
                    given.emplace_back(texel, height);
    }
    for (auto [texel, height] : given) {
        cover_.height[texel] = height;
        cover_.triangle[texel] = NO_TRIANGLE;
        field_.trim[texel] = std::max(field_.trim[texel], core.distance[texel]);
    }
}

void Bridges::find(Jumps jumps)
{
    auto shows = [&](size_t texel) { return shown(field_.trim[texel]); };
    auto has_code = [&](size_t texel) { return field_.support[texel]; };
    cells_.assign(grid_.texels(), NONE);
    for (int j = 1; j + 1 < grid_.h; ++j) { /* the margin keeps cells that show off the sides */
        for (int i = 1; i + 1 < grid_.w; ++i) {
            size_t cell = size_t(j) * size_t(grid_.w) + size_t(i);
            std::array<size_t, 4> c = corners(cell);
            if (std::any_of(c.begin(), c.end(), shows) && std::all_of(c.begin(), c.end(), has_code))
                cells_[cell] = bridges(jumps, cell) ? BAD : GOOD;
        }
    }
}

void Bridges::cut()
{
    for (size_t cell = 0; cell < cells_.size(); ++cell) {
        if (cells_[cell] != BAD)
            continue;
        std::pair<double, double> least = {INFINITY, INFINITY};
        size_t taken = cell;
        for (size_t texel : corners(cell)) { /* of equals, the lower */
            std::pair<double, double> rank = {loss(texel), cover_.height[texel]};
            if (rank < least) {
                least = rank;
                taken = texel;
            }
        }
        field_.support[taken] = 0;
        for (size_t gone : around(taken))
            cells_[gone] = NONE;
    }
}

} // namespace

void cut_discontinuities(const Outline &core, Paths &paths, ChartField &field)
{
    Bridges bridges(field, paths);
    bridges.find(Bridges::BESIDE_CORE);
    bridges.give_to_core(core);
    bridges.find(Bridges::UNJOINED);
    bridges.cut();
}

} // namespace gtx::baking
