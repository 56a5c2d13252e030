/* Attaches crumbs: components of a few triangles, which scans with non-manifold edges have by the
 * thousand, and what is left over from splitting. Each would cost a patch of its own. */
#include "chart/attach.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gtx {

namespace {

constexpr double CRUMB_TEXELS = 64;     /* most area of a crumb */
constexpr double GUEST_TEXELS = 4200;   /* of what joins a chart that will be cut anyway */
constexpr double TRIFLE_TEXELS = 8;     /* of one that may face anywhere: it is junk then */
constexpr double NEAR_TEXELS = 3;       /* up to here a region may be host without touching */
constexpr double RIM = 4;               /* texels that a patch needs beyond its chart's sides */
constexpr double PATCH = 256;           /* what a patch costs for being one, in texels */
constexpr double STEEP_COSINE = 0.1;    /* of raw normals, on at most a small share of the area */
constexpr double GUEST_COSINE = 0.3;
constexpr double STEEP_AREA = 0.05;
constexpr double WALL_TEXELS = 16;      /* of a wall that a host may get: scans have small ones */
constexpr int PASSES = 4;               /* crumbs may lead to crumbs; trifles wait for the last */

class Attachment {
public:
    Attachment(Surface &surface, const Bounds &bounds, std::vector<Region> &regions,
               std::vector<Frame> &frames)
        : surface_(surface), bounds_(bounds), regions_(regions), frames_(frames), grid_of_(frames),
          grids_(regions.size())
    {
    }

    void run();

private:
    void find_crumbs();
    void find_near();
    double texels(const Region &region) const;
    void place(uint32_t crumb, bool trifle);
    bool try_host(uint32_t crumb, uint32_t host, bool trifle);
    void mark_junk(const Region &crumb, const Vec3d &z);
    bool faces(const Region &crumb, const Vec3d &z) const;
    Frame widened(const Frame &frame, const Region &crumb) const;
    double cost(const Frame &frame) const
    {
        double w = frame.extent[0] / bounds_.pitch + RIM, h = frame.extent[1] / bounds_.pitch + RIM;
        return PATCH + w * h;
    }

    Surface &surface_;
    const Bounds &bounds_;
    std::vector<Region> &regions_;
    std::vector<Frame> &frames_;
    std::vector<uint32_t> crumbs_;                        /* largest first */
    std::vector<std::pair<uint32_t, uint32_t>> near_;     /* crumb, region; ascending */
    std::vector<uint32_t> host_;                          /* of a region; itself when it stays */
    /* Depths of regions that were asked to be hosts, in the frames that these had at first. */
    std::vector<Frame> grid_of_;
    std::vector<LayerGrid> grids_;
};

double Attachment::texels(const Region &region) const
{
    double size = 0, mean = surface_.area / double(surface_.facets.size());
    for (uint32_t t : region.triangles)
        size += surface_.facets[t].size;
    return size * mean / (bounds_.pitch * bounds_.pitch);
}

void Attachment::find_crumbs()
{
    std::vector<std::pair<double, uint32_t>> order;
    for (uint32_t i = 0; i < regions_.size(); ++i)
        order.emplace_back(-texels(regions_[i]), i);
    std::sort(order.begin(), order.end());
    for (const auto &[less, region] : order)
        if (-less < (bounds_.cone ? GUEST_TEXELS : CRUMB_TEXELS))
            crumbs_.push_back(region);
}

/* Regions with a vertex in the same cell of a grid as one of a crumb, or in a cell beside it. */
void Attachment::find_near()
{
    using Cell = std::array<int64_t, 3>;
    const double step = NEAR_TEXELS * bounds_.pitch;
    const Mesh &mesh = surface_.mesh;
    auto cell_of = [&](uint32_t v) {
        const Vec3d &p = mesh.positions[v];
        return Cell{int64_t(std::floor(p.x / step)), int64_t(std::floor(p.y / step)),
                    int64_t(std::floor(p.z / step))};
    };
    auto each_vertex = [&](uint32_t region, auto &&visit) {
        for (uint32_t t : regions_[region].triangles)
            for (uint32_t v : mesh.triangles[t])
                visit(v);
    };
    std::vector<std::pair<Cell, uint32_t>> wanted; /* cell, crumb */
    for (uint32_t crumb : crumbs_)
        each_vertex(crumb, [&](uint32_t v) { wanted.emplace_back(cell_of(v), crumb); });
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    for (size_t i = wanted.size(); i-- > 0;)
        for (int n = 0; n < 27; ++n) {
            auto [cell, crumb] = wanted[i];
            wanted.push_back({{cell[0] + n / 9 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n % 3 - 1},
                              crumb});
        }
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());

    /* Most vertices are near no crumb, as few bits tell. */
    auto bit_of = [](const Cell &c) {
        return uint16_t(uint64_t(c[0]) * 73856093 ^ uint64_t(c[1]) * 19349663 ^
                        uint64_t(c[2]) * 83492791);
    };
    std::vector<bool> marked(1 << 16);
    for (const auto &[cell, crumb] : wanted)
        marked[bit_of(cell)] = true;
    std::vector<uint32_t> seen(mesh.positions.size(), NO_TRIANGLE); /* by which region, last */
    for (uint32_t i = 0; i < regions_.size(); ++i)
        each_vertex(i, [&](uint32_t v) {
            if (std::exchange(seen[v], i) == i)
                return;
            const Cell cell = cell_of(v);
            if (!marked[bit_of(cell)])
                return;
            auto at = std::lower_bound(wanted.begin(), wanted.end(), std::make_pair(cell, 0u));
            for (; at != wanted.end() && at->first == cell; ++at)
                if (at->second != i)
                    near_.emplace_back(at->second, i);
        });
    std::sort(near_.begin(), near_.end());
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
}

bool Attachment::faces(const Region &crumb, const Vec3d &z) const
{
    double steep = 0, size = 0;
    const double least = texels(crumb) < CRUMB_TEXELS ? STEEP_COSINE : GUEST_COSINE;
    for (uint32_t t : crumb.triangles) {
        if (leans_back(surface_, t, z, bounds_.pitch))
            return false;
        size += surface_.facets[t].size;
        if (dot(Vec3d(surface_.normal[t]), z) < least)
            steep += surface_.facets[t].size;
    }
    return steep <= STEEP_AREA * size && !has_wall(surface_, crumb, z, bounds_.pitch, WALL_TEXELS);
}

Frame Attachment::widened(const Frame &frame, const Region &crumb) const
{
    FrameInverse inverse(frame);
    Vec3d low, high(frame.extent[0], frame.extent[1], frame.extent[2]);
    for (uint32_t t : crumb.triangles)
        for (int k = 0; k < 3; ++k) {
            Vec3d p = inverse(surface_.mesh.position(t, k));
            for (int i = 0; i < 3; ++i) {
                low[i] = std::min(low[i], p[i]);
                high[i] = std::max(high[i], p[i]);
            }
        }
    Frame out = frame;
    out.origin = frame.point(low);
    for (int i = 0; i < 3; ++i)
        out.extent[i] = high[i] - low[i];
    return out;
}

void Attachment::mark_junk(const Region &crumb, const Vec3d &z)
{
    for (uint32_t t : crumb.triangles)
        if (dot(Vec3d(surface_.normal[t]), z) < STEEP_COSINE)
            surface_.junk[t] = 1;
}

bool Attachment::try_host(uint32_t crumb, uint32_t host, bool trifle)
{
    const Region &guest = regions_[crumb];
    if (!trifle && !faces(guest, frames_[host].z))
        return false;
    Frame frame = widened(frames_[host], guest);
    if (!bounds_.cone && (std::max(frame.extent[0], frame.extent[1]) > bounds_.side ||
                          cost(frame) > cost(frames_[host]) + cost(frames_[crumb])))
        return false;
    LayerGrid &grid = grids_[host];
    if (grid.samples.empty())
        grid = make_layer_grid(surface_, regions_[host], grid_of_[host], bounds_.pitch);
    LayerGrid own = make_layer_grid(surface_, guest, grid_of_[host], bounds_.pitch);
    size_t doubled;
    if (fold_together(grid, own, layer_rule(surface_, bounds_.pitch), doubled) ||
        (doubled && !trifle))
        return false;
    grid.add(own);
    if (trifle)
        mark_junk(guest, frame.z);
    Region &both = regions_[host];
    auto offset = uint32_t(both.size());
    both.triangles.insert(both.triangles.end(), guest.triangles.begin(), guest.triangles.end());
    for (std::array<uint32_t, 3> n : guest.neighbours) {
        for (uint32_t &i : n)
            i += i == NO_TRIANGLE ? 0 : offset;
        both.neighbours.push_back(n);
    }
    frames_[host] = frame;
    regions_[crumb] = {};
    host_[crumb] = host;
    return true;
}

void Attachment::place(uint32_t crumb, bool trifle)
{
    auto near = std::lower_bound(near_.begin(), near_.end(), std::make_pair(crumb, 0u));
    for (; near != near_.end() && near->first == crumb; ++near) {
        uint32_t host = near->second;
        while (host_[host] != host)
            host = host_[host];
        if (host != crumb && try_host(crumb, host, trifle))
            return;
    }
}

void Attachment::run()
{
    find_crumbs();
    find_near();
    host_.resize(regions_.size());
    std::iota(host_.begin(), host_.end(), 0u);
    for (int pass = 1; pass <= PASSES; ++pass)
        for (uint32_t crumb : crumbs_) {
            bool trifle = pass == PASSES && texels(regions_[crumb]) < TRIFLE_TEXELS;
            if (host_[crumb] == crumb)
                place(crumb, trifle);
        }
    size_t kept = 0;
    for (uint32_t i = 0; i < regions_.size(); ++i) {
        if (host_[i] != i)
            continue;
        std::swap(regions_[kept], regions_[i]);
        frames_[kept++] = frames_[i];
    }
    regions_.resize(kept);
    frames_.resize(kept);
}

} // namespace

void attach_crumbs(Surface &surface, const Bounds &bounds, std::vector<Region> &regions,
                   std::vector<Frame> &frames)
{
    Attachment(surface, bounds, regions, frames).run();
}

} // namespace gtx
