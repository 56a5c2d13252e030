/* Small charts of one layer, gathered into one.
 *
 * A patch has a rim of empty texels, and sides that are multiples of a grain: of a leaf or a link
 * they are most of it. Charts that see the same way can share a patch where none lies above
 * another, with room between them for the overlap of both; each keeps its own outline. */
#include "chart/layers/peel.hpp"

#include <algorithm>
#include <array>

namespace gtx {

namespace {

/* What follows was chosen on an engine of 82 nodes (786 charts become 626), and not tuned.
 * Largest chart that is gathered, in parts of a patch's surface. */
constexpr double GATHERED_TEXELS = 0.5 * PATCH_TEXELS;
/* Texels between two charts: the maps of each show a little more than its core. */
constexpr int GAP = 5;
/* Texels from the highest to the lowest of what is gathered: heights have 254 steps. */
constexpr double MAX_DEPTH = 64;
/* What a patch costs for being one, in texels. */
constexpr double PATCH_COST = 256;
/* A limit on time: as many groups of a tile are open to further charts. */
constexpr size_t MAX_OPEN = 16;

struct Box {
    int low[2] = {INT32_MAX, INT32_MAX}, high[2] = {INT32_MIN, INT32_MIN};

    void add(const Box &b)
    {
        for (int a = 0; a < 2; ++a) {
            low[a] = std::min(low[a], b.low[a]);
            high[a] = std::max(high[a], b.high[a]);
        }
    }
    int side(int axis) const { return high[axis] - low[axis]; }
};

/* The texels of a row from `from` to before `to`. */
struct Run {
    int row, from, to;
};

/* A chart on the grid of its direction. */
struct Piece {
    size_t direction, region;
    Box box;
    double near = INFINITY, far = -INFINITY; /* depths along the direction */
    Vector<Run> runs;                        /* one a triangle and row that it touches */
    int tile[2];
};

/* Charts that will be one. */
struct Group {
    Box box;
    double near, far;
    int corner[2], side;      /* of the window on the grid that is remembered */
    Vector<bool> taken;
    Vector<size_t> regions;
};

class Gatherer {
public:
    Gatherer(const Surface &surface, const Bounds &bounds, unsigned grain, unsigned side)
        : surface_(surface), bounds_(bounds), grain_(int(grain)), side_(int(side))
    {
    }

    Vector<Group> run(const Vector<Region> &regions, const Vector<Frame> &frames);

private:
    bool measure(const Region &region, const Frame &frame, Piece &piece) const;
    double cost(const Box &box) const;
    bool fits(const Group &group, const Piece &piece) const;
    void put(const Piece &piece, Group &group) const;
    template <class Visit> void each_texel(const Group &group, const Piece &piece, int gap,
                                           Visit visit) const;

    const Surface &surface_;
    const Bounds &bounds_;
    const int grain_, side_;
};

/* Where a triangle's rows begin and end: conservative, for a needle between texel centres takes
 * room too. */
void add_runs(const Vec3d corner[3], Vector<Run> &runs)
{
    double low = std::min({corner[0].y, corner[1].y, corner[2].y});
    double high = std::max({corner[0].y, corner[1].y, corner[2].y});
    for (int row = int(std::floor(low)); row <= int(std::floor(high)); ++row) {
        double from = INFINITY, to = -INFINITY;
        for (int k = 0; k < 3; ++k) {
            const Vec3d &a = corner[k], &b = corner[(k + 1) % 3];
            for (double y : {double(row), double(row + 1), a.y}) {
                if (y < std::min(a.y, b.y) || y > std::max(a.y, b.y) || y < row || y > row + 1)
                    continue;
                const double x = a.y == b.y ? a.x : a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
                from = std::min(from, x);
                to = std::max(to, x);
            }
        }
        if (from <= to)
            runs.push_back({row, int(std::floor(from)), int(std::floor(to)) + 1});
    }
}

/* Whether a chart is along one of the directions, and small. */
bool Gatherer::measure(const Region &region, const Frame &frame, Piece &piece) const
{
    const Vector<Vec3d> &directions = bounds_.directions;
    piece.direction = size_t(std::find(directions.begin(), directions.end(), frame.z) -
                             directions.begin());
    if (piece.direction == directions.size() ||
        texels_of(surface_, region, bounds_.pitch) > GATHERED_TEXELS)
        return false;
    const Vec3d x = directions[(piece.direction + 2) % 6], y = cross(frame.z, x);
    for (uint32_t t : region.triangles) {
        cancel_point();
        Vec3d corner[3];
        for (int k = 0; k < 3; ++k) {
            const Vec3d p = surface_.mesh.position(t, k) - surface_.mesh.positions[0];
            corner[k] = {dot(p, x) / bounds_.pitch, dot(p, y) / bounds_.pitch,
                         dot(p, frame.z) / bounds_.pitch};
            piece.near = std::min(piece.near, corner[k].z);
            piece.far = std::max(piece.far, corner[k].z);
            for (int a = 0; a < 2; ++a) {
                if (!(std::fabs(corner[k][a]) < 1e8))
                    return false;
                piece.box.low[a] = std::min(piece.box.low[a], int(std::floor(corner[k][a])));
                piece.box.high[a] = std::max(piece.box.high[a], int(std::floor(corner[k][a])) + 1);
            }
        }
        if (std::max(piece.box.side(0), piece.box.side(1)) > side_ / 2)
            return false;
        add_runs(corner, piece.runs);
    }
    for (int a = 0; a < 2; ++a)
        piece.tile[a] = int(std::floor(double(piece.box.low[a]) / side_));
    return piece.far - piece.near <= MAX_DEPTH;
}

/* Texels of a patch of such a core. */
double Gatherer::cost(const Box &box) const
{
    double texels = 1;
    for (int a = 0; a < 2; ++a)
        texels *= std::ceil((box.side(a) + RIM) / grain_) * grain_;
    return PATCH_COST + texels;
}

template <class Visit> void Gatherer::each_texel(const Group &group, const Piece &piece, int gap,
                                                 Visit visit) const
{
    for (const Run &run : piece.runs)
        for (int row = run.row - gap; row <= run.row + gap; ++row)
            for (int i = run.from - gap; i < run.to + gap; ++i) {
                const int x = i - group.corner[0], y = row - group.corner[1];
                if (x >= 0 && y >= 0 && x < group.side && y < group.side)
                    visit(size_t(y) * size_t(group.side) + size_t(x));
            }
}

bool Gatherer::fits(const Group &group, const Piece &piece) const
{
    if (std::max(group.far, piece.far) - std::min(group.near, piece.near) > MAX_DEPTH)
        return false;
    Box both = group.box;
    both.add(piece.box);
    if (std::max(both.side(0), both.side(1)) > side_ ||
        cost(both) > cost(group.box) + cost(piece.box))
        return false;
    bool room = true;
    each_texel(group, piece, GAP, [&](size_t at) { room = room && !group.taken[at]; });
    return room;
}

void Gatherer::put(const Piece &piece, Group &group) const
{
    group.box.add(piece.box);
    group.near = std::min(group.near, piece.near);
    group.far = std::max(group.far, piece.far);
    group.regions.push_back(piece.region);
    each_texel(group, piece, 0, [&](size_t at) { group.taken[at] = true; });
}

/* Tile by tile, from the front to the back: so that layers are near each other in depth. */
Vector<Group> Gatherer::run(const Vector<Region> &regions, const Vector<Frame> &frames)
{
    Vector<Piece> pieces;
    for (size_t i = 0; i < regions.size(); ++i) {
        Piece piece = {};
        piece.region = i;
        if (measure(regions[i], frames[i], piece))
            pieces.push_back(std::move(piece));
    }
    auto place = [](const Piece &p) { return std::array<int, 3>{int(p.direction), p.tile[1],
                                                                p.tile[0]}; };
    std::stable_sort(pieces.begin(), pieces.end(), [&](const Piece &a, const Piece &b) {
        cancel_point();
        return place(a) != place(b) ? place(a) < place(b) : a.far > b.far;
    });
    Vector<Group> done, open;
    const Piece *last = nullptr;
    auto close = [&](size_t count) {
        for (size_t i = 0; i < count; ++i) {
            open[i].taken = {};
            done.push_back(std::move(open[i]));
        }
        open.erase(open.begin(), open.begin() + ptrdiff_t(count));
    };
    for (const Piece &piece : pieces) {
        cancel_point();
        if (last && place(*last) != place(piece))
            close(open.size());
        last = &piece;
        auto group = std::find_if(open.begin(), open.end(),
                                  [&](const Group &g) { return fits(g, piece); });
        if (group == open.end()) {
            close(open.size() == MAX_OPEN ? 1 : 0);
            Group fresh = {{}, INFINITY, -INFINITY, {}, 3 * side_ / 2 + 1, {}, {}};
            for (int a = 0; a < 2; ++a)
                fresh.corner[a] = piece.tile[a] * side_;
            fresh.taken.resize(size_t(fresh.side) * size_t(fresh.side));
            open.push_back(std::move(fresh));
            group = open.end() - 1;
        }
        put(piece, *group);
    }
    close(open.size());
    return done;
}

void append(const Region &from, Region &to)
{
    const auto offset = uint32_t(to.size());
    to.triangles.insert(to.triangles.end(), from.triangles.begin(), from.triangles.end());
    for (std::array<uint32_t, 3> n : from.neighbours) {
        for (uint32_t &i : n)
            i += i == NO_TRIANGLE ? 0 : offset;
        to.neighbours.push_back(n);
    }
}

} // namespace

void gather_charts(const Surface &surface, const Bounds &bounds, unsigned grain, unsigned side,
                   Vector<Region> &regions, Vector<Frame> &frames)
{
    for (Group &group : Gatherer(surface, bounds, grain, side).run(regions, frames)) {
        const size_t first = *std::min_element(group.regions.begin(), group.regions.end());
        if (group.regions.size() == 1)
            continue;
        std::sort(group.regions.begin(), group.regions.end());
        for (size_t region : group.regions)
            if (region != first) {
                append(regions[region], regions[first]);
                regions[region] = {};
            }
        frames[first] = make_frame(surface.mesh, regions[first].triangles, frames[first].z);
    }
    drop_empty(regions, frames);
}

} // namespace gtx
