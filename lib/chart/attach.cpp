/* Attaches crumbs: components of a few triangles, which scans with non-manifold edges have by the
 * thousand, and what is left over from splitting. Each would cost a patch of its own. */
#include "chart/attach.hpp"

#include <algorithm>
#include <numeric>

namespace gtx {

namespace {

constexpr double CRUMB_TEXELS = 64;     /* most area of a crumb */
constexpr double TRIFLE_TEXELS = 2;     /* of one that may face anywhere: it is junk then */
constexpr double RIM = 4;               /* texels that a patch needs beyond its chart's sides */
constexpr double PATCH = 256;           /* what a patch costs for being one, in texels */
constexpr double STEEP_COSINE = 0.1;    /* of raw normals, on at most a small share of the area */
constexpr double STEEP_AREA = 0.05;
constexpr int PASSES = 4;               /* crumbs may lead to crumbs; trifles wait for the last */

/* Numbers vertices so that those at one position share a number. */
std::vector<uint32_t> position_numbers(const Mesh &mesh)
{
    std::vector<uint32_t> order(mesh.positions.size()), number(order.size());
    std::iota(order.begin(), order.end(), 0u);
    auto key = [&mesh](uint32_t v) {
        const Vec3d &p = mesh.positions[v];
        return std::array<double, 3>{p.x, p.y, p.z};
    };
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    for (size_t i = 1; i < order.size(); ++i)
        number[order[i]] = number[order[i - 1]] + (key(order[i]) != key(order[i - 1]));
    return number;
}

class Attachment {
public:
    Attachment(Surface &surface, const Bounds &bounds, std::vector<Region> &regions,
               std::vector<Frame> &frames)
        : surface_(surface), bounds_(bounds), regions_(regions), frames_(frames)
    {
    }

    void run();

private:
    void find_crumbs();
    void find_touching();
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
    std::vector<std::pair<uint32_t, uint32_t>> touching_; /* crumb, region; ascending */
    std::vector<uint32_t> host_;                          /* of a region; itself when it stays */
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
        if (-less < CRUMB_TEXELS)
            crumbs_.push_back(region);
}

void Attachment::find_touching()
{
    std::vector<uint32_t> number = position_numbers(surface_.mesh);
    std::vector<bool> wanted(number.size());
    auto each_vertex = [&](uint32_t region, auto &&visit) {
        for (uint32_t t : regions_[region].triangles)
            for (uint32_t v : surface_.mesh.triangles[t])
                visit(number[v]);
    };
    for (uint32_t crumb : crumbs_)
        each_vertex(crumb, [&](uint32_t v) { wanted[v] = true; });
    std::vector<std::pair<uint32_t, uint32_t>> at; /* position, region */
    for (uint32_t i = 0; i < regions_.size(); ++i)
        each_vertex(i, [&](uint32_t v) {
            if (wanted[v])
                at.emplace_back(v, i);
        });
    std::sort(at.begin(), at.end());
    at.erase(std::unique(at.begin(), at.end()), at.end());
    for (uint32_t crumb : crumbs_)
        each_vertex(crumb, [&](uint32_t v) {
            auto near = std::lower_bound(at.begin(), at.end(), std::make_pair(v, 0u));
            for (; near != at.end() && near->first == v; ++near)
                if (near->second != crumb)
                    touching_.emplace_back(crumb, near->second);
        });
    std::sort(touching_.begin(), touching_.end());
    touching_.erase(std::unique(touching_.begin(), touching_.end()), touching_.end());
}

bool Attachment::faces(const Region &crumb, const Vec3d &z) const
{
    double steep = 0, size = 0;
    for (uint32_t t : crumb.triangles) {
        if (is_inverted(surface_, t, z, bounds_.pitch))
            return false;
        size += surface_.facets[t].size;
        if (dot(Vec3d(surface_.normal[t]), z) < STEEP_COSINE)
            steep += surface_.facets[t].size;
    }
    return steep <= STEEP_AREA * size;
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
    if (std::max(frame.extent[0], frame.extent[1]) > bounds_.side ||
        cost(frame) > cost(frames_[host]) + cost(frames_[crumb]))
        return false;
    Region both = regions_[host];
    auto offset = uint32_t(both.size());
    both.triangles.insert(both.triangles.end(), guest.triangles.begin(), guest.triangles.end());
    for (std::array<uint32_t, 3> n : guest.neighbours) {
        for (uint32_t &i : n)
            i += i == NO_TRIANGLE ? 0 : offset;
        both.neighbours.push_back(n);
    }
    Layers before = find_layers(surface_, regions_[host], frames_[host], bounds_.pitch);
    Layers after = find_layers(surface_, both, frame, bounds_.pitch);
    if ((after.doubled > before.doubled && !trifle) || !after.folds.empty())
        return false;
    if (trifle)
        mark_junk(guest, frame.z);
    regions_[host] = std::move(both);
    frames_[host] = frame;
    regions_[crumb] = {};
    host_[crumb] = host;
    return true;
}

void Attachment::place(uint32_t crumb, bool trifle)
{
    auto near = std::lower_bound(touching_.begin(), touching_.end(), std::make_pair(crumb, 0u));
    for (; near != touching_.end() && near->first == crumb; ++near) {
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
    find_touching();
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
