/* Cell files -> the surface of one tile, with the ring of triangles that it shares with its
 * neighbours. */
#include "world/surface.hpp"

#include <algorithm>
#include <cstring>

namespace gtx {

constexpr uint32_t NONE = UINT32_MAX;

namespace {

/* Gives equal corners one vertex: a table of places, and at each a list of its vertices. */
class Welder {
public:
    explicit Welder(TileSurface &surface) : surface_(surface), slots_(1 << 16, NONE) {}
    /* The first vertex at the position, or NONE. */
    uint32_t find(const Vec3d &p) const { return slots_[slot_of(p)]; }
    uint32_t add(const Corner &corner);

private:
    size_t slot_of(const Vec3d &p) const;
    void grow();

    TileSurface &surface_;
    Vector<uint32_t> slots_;
    Vector<uint32_t> next_;          /* vertex at the same place */
    size_t used_ = 0;
};

/* Not-a-numbers are like themselves here. */
static bool same_bits(const CornerLook &a, const CornerLook &b)
{
    static_assert(sizeof a == CornerLook::BYTES, "no bytes between its numbers");
    return std::memcmp(&a, &b, sizeof a) == 0;
}

size_t Welder::slot_of(const Vec3d &p) const
{
    uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
        uint64_t bits;
        const double x = p[k];
        std::memcpy(&bits, &x, sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    size_t at = size_t(hash) & (slots_.size() - 1);
    while (slots_[at] != NONE && surface_.positions[slots_[at]] != p)
        at = (at + 1) & (slots_.size() - 1);
    return at;
}

void Welder::grow()
{
    Vector<uint32_t> old(2 * slots_.size(), NONE);
    old.swap(slots_);
    for (uint32_t first : old)
        if (first != NONE)
            slots_[slot_of(surface_.positions[first])] = first;
}

uint32_t Welder::add(const Corner &c)
{
    TileSurface &s = surface_;
    const Vec3d p = c.position + Vec3d(); /* -0 is 0 */
    const size_t at = slot_of(p);
    uint32_t last = NONE;
    for (uint32_t v = slots_[at]; v != NONE; last = v, v = next_[v])
        if ((!s.traits.normals || s.normals[v] == c.normal) &&
            (!s.traits.colors || s.colors[v] == c.color) &&
            (!s.traits.textured || same_bits(s.looks[v], c.look)))
            return v;
    const uint32_t made = uint32_t(s.positions.size());
    if (made == NONE)
        throw Error(GTX_ERROR_LIMIT, "more vertices than 32 bits can count");
    s.positions.push_back(p);
    s.normals.push_back(c.normal);
    s.colors.push_back(c.color);
    if (s.traits.textured)
        s.looks.push_back(c.look);
    s.place.push_back(last == NONE ? made : slots_[at]);
    next_.push_back(NONE);
    if (last != NONE) {
        next_[last] = made;
        return made;
    }
    slots_[at] = made;
    if (2 * ++used_ > slots_.size())
        grow();
    return made;
}

} // namespace

static void add_own(const std::string &path, Welder &welder, TileSurface &out)
{
    CellReader cell(path);
    out.header = cell.header();
    out.traits = cell.header().traits;
    Corners3 c;
    while (cell.next(c))
        out.triangles.push_back({welder.add(c[0]), welder.add(c[1]), welder.add(c[2])});
    out.own = out.triangles.size();
}

/* `own` is the box of the tile's own vertices: outside of it none is shared. */
static void add_ring(const std::string &path, size_t own_vertices, const CellHeader &own,
                     Welder &welder, TileSurface &out)
{
    CellReader cell(path);
    if (!cell.header().touches(out.header))
        return;
    Corners3 c;
    while (cell.next(c)) {
        bool shares = false;
        for (const Corner &corner : c)
            shares = shares || (own.has(corner.position) &&
                                welder.find(corner.position + Vec3d()) < own_vertices);
        if (shares)
            out.triangles.push_back({welder.add(c[0]), welder.add(c[1]), welder.add(c[2])});
    }
}

/* Of the triangles beyond the ring, those that share a position with it: their areas. */
static void add_beyond(const std::string &path, size_t own_vertices, const CellHeader &bounds,
                       const Welder &welder, Vector<Vec3d> &areas)
{
    CellReader cell(path);
    if (!cell.header().touches(bounds))
        return;
    Corners3 c;
    while (cell.next(c)) {
        CellHeader box;
        box.add(c);
        if (!box.touches(bounds))
            continue;
        uint32_t at[3];
        for (size_t k = 0; k < 3; ++k)
            at[k] = welder.find(c[k].position + Vec3d());
        if (std::any_of(at, at + 3, [&](uint32_t v) { return v < own_vertices; }))
            continue;                /* it is in the ring */
        const Vec3d area = cross(c[1].position - c[0].position, c[2].position - c[0].position);
        for (uint32_t v : at)
            if (v != NONE)
                areas[v] += area;
    }
}

/* Where the files have no normals: the means of the triangles around each place, those of a tile
 * and of its neighbours alike. */
static void find_normals(const Plan &plan, const Tile &tile, size_t own_vertices,
                         const Welder &welder, TileSurface &s)
{
    Vector<Vec3d> areas(s.positions.size());
    CellHeader bounds;
    for (const auto &t : s.triangles) {
        const Corners3 c = {s.corner(t[0]), s.corner(t[1]), s.corner(t[2])};
        bounds.add(c);
        const Vec3d area = cross(c[1].position - c[0].position, c[2].position - c[0].position);
        for (uint32_t v : t)
            areas[s.place[v]] += area;
    }
    for (const Tile &other : plan.tiles)
        if (&other != &tile && other.is_leaf() && other.touches(bounds.low, bounds.high))
            add_beyond(cell_path(plan, other), own_vertices, bounds, welder, areas);
    for (size_t v = 0; v < areas.size(); ++v)
        s.normals[v] = Vec3f(normalize(areas[s.place[v]]));
    s.traits.normals = true;
}

TileSurface load_cell(const std::string &path)
{
    TileSurface out;
    Welder welder(out);
    add_own(path, welder, out);
    return out;
}

TileSurface load_surface(const Plan &plan, const Tile &tile, Task &task)
{
    TileSurface out;
    Welder welder(out);
    add_own(cell_path(plan, tile), welder, out);
    const size_t own = out.positions.size();
    CellHeader box;
    for (const Vec3d &p : out.positions)
        box.add(p);
    if (!tile.is_leaf())
        for (const Tile *other : plan.low_neighbours(tile))
            add_ring(low_path(plan, *other), own, box, welder, out);
    for (const Tile &other : plan.tiles) {
        task.advance(double(&other - &plan.tiles[0]) / double(plan.tiles.size()));
        if (tile.is_leaf() && other.is_leaf() && &other != &tile &&
            other.touches(box.low, box.high))
            add_ring(cell_path(plan, other), own, box, welder, out);
    }
    if (!out.traits.normals)
        find_normals(plan, tile, own, welder, out);
    return out;
}

Mesh mesh_of(const TileSurface &s)
{
    Mesh mesh;
    mesh.positions = s.positions;
    mesh.triangles = s.triangles;
    for (const auto &t : s.triangles)
        for (uint32_t v : t) {
            if (s.traits.normals)
                mesh.normals.push_back(s.normals[v]);
            if (s.traits.colors)
                mesh.colors.push_back(s.colors[v]);
        }
    return mesh;
}

} // namespace gtx
