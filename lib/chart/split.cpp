/* Judges whether a region is too long, too steep or folded, or can be a chart. */
#include "chart/split.hpp"

#include "chart/layers/peel.hpp"
#include "chart/vsa.hpp"

#include <algorithm>
#include <queue>

namespace gtx {

namespace {

/* Least cosine of smoothed normals with the axis, but for STEEP_SHARE of the area: a steep texel
 * stands for much surface, and its height error shows. Half: RMS +5 %; double: patches +5 %
 * (truck). */
constexpr double MIN_FACING = 0.25;
/* Raw normals this upright are a wall's, in scans and where triangles are so large on average that
 * they were designed. Half: RMS +2 %, patches +2 %; double: RMS +2 %, patches -4 % (truck,
 * Spot). */
constexpr double WALL_COSINE = 0.05, DESIGNED_WALL_COSINE = 0.15;
/* Texels of the mean triangle. Half: RMS +13 % (truck); double: the same but for a few bytes. */
constexpr double DESIGNED_TEXELS = 64;
/* How much of a wall matters. Half: RMS +1 %, double: patches -2 % (Duck, truck). */
constexpr double WALL_TEXELS = 1;
/* How much longer a step of the watershed is across a bend of 90 degrees. Half: RMS -1 %, empty
 * -2 points (Spot); double: RMS +4 % (Duck). */
constexpr float CREASE = 8;

struct Candidate {
    Frame frame;
    bool steep = false, inverted = false;
    Layers layers;

    bool fits() const
    {
        return !steep && !inverted && layers.folds.empty() && layers.discontinuities.empty();
    }
};

Candidate try_axis(const Surface &surface, const Region &region, const Vec3d &z,
                   const Bounds &bounds, Task &task)
{
    constexpr size_t TURNS = 256; /* of a short loop, that take as long as a triangle */
    cancel_point(TURNS * region.size());
    Candidate out;
    float steep = 0, size = 0;
    for (uint32_t t : region.triangles) {
        size += surface.facets[t].size;
        if (dot(Vec3d(surface.facets[t].normal), z) < MIN_FACING)
            steep += surface.facets[t].size;
        const double facing = dot(Vec3d(surface.normal[t]), z);
        out.inverted = out.inverted || leans_back(surface, t, facing, z, bounds.pitch);
    }
    out.steep = region.size() > 1 && steep > STEEP_SHARE * size;
    if ((out.steep || out.inverted) && region.size() > 1 && bounds.side == INFINITY) {
        out.frame.z = z; /* all that is asked of it */
        return out;
    }
    out.frame = make_frame(surface.mesh, region.triangles, z);
    if (!out.steep && !out.inverted && out.frame.extent[0] <= bounds.side &&
        out.frame.extent[1] <= bounds.side)
        out.layers = find_layers(surface, region, out.frame, bounds.pitch, task);
    return out;
}

/* Labels as 1 what stands upright along `z`, or overhangs by less than a texel: a height field
 * cannot show it, which leaves a hole unless another chart takes it. Empty without a wall of more
 * than `most_texels`. */
Vector<uint32_t> find_walls(const Surface &surface, const Region &region, const Vec3d &z,
                            double pitch, double most_texels)
{
    const double texel = pitch * pitch, mean = surface.area / double(surface.facets.size());
    const double least = mean > DESIGNED_TEXELS * texel ? DESIGNED_WALL_COSINE : WALL_COSINE;
    Vector<uint32_t> wall(region.size());
    for (size_t i = 0; i < region.size(); ++i) {
        uint32_t t = region.triangles[i];
        wall[i] = !surface.junk[t] && dot(Vec3d(surface.normal[t]), z) < least;
    }
    if (std::find(wall.begin(), wall.end(), 1u) == wall.end())
        return {};
    Vector<uint32_t> group = wall;
    Vector<double> area(connected_pieces(region, group));
    for (size_t i = 0; i < region.size(); ++i)
        area[group[i]] += length(surface.mesh.area_vector(region.triangles[i])) / 2;
    bool any = false;
    for (size_t i = 0; i < region.size(); ++i) {
        wall[i] = wall[i] && area[group[i]] > most_texels * texel;
        any = any || wall[i];
    }
    return any ? wall : Vector<uint32_t>();
}

Vector<Region> pieces_of(const Region &region, Vector<uint32_t> labels)
{
    uint32_t count = connected_pieces(region, labels);
    return split_region(region, labels, count);
}

/* Cuts straight across the middle of the longer side. Pieces that the cut disconnects from the
 * largest piece of their side change sides. */
Vector<uint32_t> cut_across(const Surface &surface, const Region &region, const Frame &frame)
{
    FrameInverse inverse(frame);
    int axis = frame.extent[0] >= frame.extent[1] ? 0 : 1;
    Vector<uint32_t> side(region.size());
    Vector<std::pair<double, uint32_t>> order;
    for (uint32_t i = 0; i < region.size(); ++i) {
        Vec3d sum;
        for (int k = 0; k < 3; ++k)
            sum += inverse(surface.mesh.position(region.triangles[i], k));
        order.emplace_back(sum[axis] / 3, i);
        side[i] = sum[axis] / 3 > frame.extent[axis] / 2;
    }
    std::sort(order.begin(), order.end());
    side[order.front().second] = 0; /* neither side is empty */
    side[order.back().second] = 1;

    Vector<uint32_t> piece = side;
    uint32_t count = connected_pieces(region, piece);
    Vector<size_t> size(count);
    uint32_t main[2] = {NO_TRIANGLE, NO_TRIANGLE};
    for (uint32_t p : piece)
        ++size[p];
    for (uint32_t i = 0; i < region.size(); ++i) {
        uint32_t &best = main[side[i]];
        if (best == NO_TRIANGLE || size[piece[i]] > size[best])
            best = piece[i];
    }
    for (uint32_t i = 0; i < region.size(); ++i)
        if (piece[i] != main[side[i]])
            side[i] = !side[i];
    return side;
}

/* Two clusters of normals, grown from the triangle that turns farthest from the axis and the one
 * that turns farthest from that. */
Vector<uint32_t> split_normals(const Surface &surface, const Region &region, const Vec3d &z)
{
    auto farthest = [&](const Vec3f &from) {
        uint32_t best = 0;
        float least = INFINITY;
        for (uint32_t i = 0; i < region.size(); ++i) {
            float cosine = dot(surface.facets[region.triangles[i]].normal, from);
            if (cosine < least) {
                least = cosine;
                best = i;
            }
        }
        return best;
    };
    uint32_t a = farthest(Vec3f(z));
    uint32_t b = farthest(surface.facets[region.triangles[a]].normal);
    if (a == b)
        b = a ? 0 : 1;
    return cluster_pair(surface, region, a, b);
}

/* Accepts a region as a chart, less its walls. Where all of it is wall, as around a peg, no axis
 * serves the whole ring: it is split by normals. */
Verdict accept(const Surface &surface, const Region &region, const Frame &frame, double pitch)
{
    const Vector<uint32_t> wall = find_walls(surface, region, frame.z, pitch, WALL_TEXELS);
    if (wall.empty())
        return {frame, {}};
    Vector<Region> pieces = pieces_of(region, wall);
    if (pieces.size() == 1 && region.size() > 1)
        pieces = pieces_of(region, split_normals(surface, region, frame.z));
    return {frame, pieces.size() > 1 ? std::move(pieces) : Vector<Region>()};
}

/* Watershed between what lies in front and what lies behind: triangles vote by their doubled
 * samples, the deepest of which decides its own two. Crossing a crease costs most. */
Vector<uint32_t> split_layers(const Surface &surface, const Region &region,
                              const Vector<DoubleSample> &samples)
{
    Vector<int> votes(region.size());
    const DoubleSample *deepest = &samples[0];
    for (const DoubleSample &d : samples) {
        ++votes[d.front];
        --votes[d.back];
        if (d.depth > deepest->depth)
            deepest = &d;
    }
    votes[deepest->front] = 1;
    votes[deepest->back] = -1;

    using Step = std::pair<float, uint32_t>;
    std::priority_queue<Step, Vector<Step>, std::greater<Step>> queue;
    Vector<float> reached(region.size(), INFINITY);
    Vector<uint32_t> side(region.size());
    for (uint32_t i = 0; i < region.size(); ++i)
        if (votes[i]) {
            side[i] = votes[i] < 0;
            reached[i] = 0;
            queue.push({0.f, i});
        }
    while (!queue.empty()) {
        auto [distance, i] = queue.top();
        queue.pop();
        if (distance > reached[i])
            continue;
        uint32_t t = region.triangles[i];
        for (uint32_t n : region.neighbours[i]) {
            if (n == NO_TRIANGLE)
                continue;
            uint32_t o = region.triangles[n];
            float bend = 1 - dot(surface.facets[t].normal, surface.facets[o].normal);
            float step = length(surface.facets[t].centre - surface.facets[o].centre);
            float next = distance + step * (1 + CREASE * bend);
            if (next < reached[n]) {
                reached[n] = next;
                side[n] = side[i];
                queue.push({next, n});
            }
        }
    }
    return side;
}

/* Of a region that faces one of the directions; false where what is wrong is no matter of
 * layers. */
bool judge_along(const Surface &surface, const Region &region, const Bounds &bounds, Task &task,
                 Verdict &verdict)
{
    const Vec3d z = chart_axis(surface, region.triangles, bounds);
    if (fits_along(surface, region, z, bounds, task, verdict))
        return true;
    const Layers layers = try_axis(surface, region, z, bounds, task).layers;
    for (auto *samples : {&layers.folds, &layers.discontinuities})
        if (!samples->empty()) {
            verdict = {{}, pieces_of(region, split_layers(surface, region, *samples))};
            return true;
        }
    Vector<uint32_t> nearest(region.size());
    for (size_t i = 0; i < region.size(); ++i)
        nearest[i] = uint32_t(nearest_direction(
            bounds.directions, Vec3d(surface.normal[region.triangles[i]])));
    verdict = {{}, pieces_of(region, nearest)};
    return verdict.pieces.size() > 1;
}

} // namespace

Vec3d chart_axis(const Surface &surface, const Vector<uint32_t> &triangles, const Bounds &bounds)
{
    if (bounds.directions.empty())
        return cone_axis(surface, triangles);
    Vec3d sum;
    for (uint32_t t : triangles)
        sum += Vec3d(surface.normal[t]) * double(surface.facets[t].size);
    return bounds.directions[nearest_direction(bounds.directions, sum)];
}

bool is_inverted(const Surface &surface, uint32_t t, const Vec3d &z, double pitch)
{
    return dot(Vec3d(surface.normal[t]), z) <= 0 && !surface.junk[t] &&
           -dot(surface.mesh.area_vector(t), z) / 2 > pitch * pitch;
}

bool has_wall(const Surface &surface, const Region &region, const Vec3d &z, double pitch,
              double most_texels)
{
    return !find_walls(surface, region, z, pitch, most_texels).empty();
}

bool leans_back(const Surface &surface, uint32_t t, double facing, const Vec3d &z, double pitch)
{
    /* Texels: their sides are seen, if not their tops. Half: RMS +8 %, double: RMS +1 %
     * (Duck, bunny). */
    constexpr double WALL = 4;
    const double texel = pitch * pitch;
    if (!(facing <= 0) || surface.junk[t])
        return false;
    const Vec3d area = surface.mesh.area_vector(t);
    return -dot(area, z) / 2 > texel || length(area) / 2 > WALL * texel;
}

bool fits_along(const Surface &surface, const Region &region, const Vec3d &z, const Bounds &bounds,
                Task &task, Verdict &verdict)
{
    Candidate candidate = try_axis(surface, region, z, bounds, task);
    if (!candidate.fits())
        return false;
    verdict = accept(surface, region, candidate.frame, bounds.pitch);
    return true;
}

Verdict judge(const Surface &surface, const Region &region, const Bounds &bounds, Task &task)
{
    auto too_long = [&](const Frame &frame) {
        return region.size() > 1 && std::max(frame.extent[0], frame.extent[1]) > bounds.side;
    };
    auto try_kind = [&](bool cone) {
        const Vec3d z = cone ? cone_axis(surface, region.triangles)
                             : median_axis(surface.mesh, region.triangles, &surface.normal);
        return try_axis(surface, region, z, bounds, task);
    };
    Verdict along;
    if (!bounds.directions.empty() && judge_along(surface, region, bounds, task, along))
        return along;
    /* A triangle alone is a height map along its own normal, whatever its neighbours' are. */
    Candidate first = try_kind(bounds.cone && region.size() > 1);
    if (too_long(first.frame))
        return {{}, pieces_of(region, cut_across(surface, region, first.frame))};
    if (first.fits() || region.size() == 1)
        return accept(surface, region, first.frame, bounds.pitch);

    Candidate second = try_kind(!bounds.cone);
    if (second.fits() && !too_long(second.frame))
        return accept(surface, region, second.frame, bounds.pitch);
    for (const Candidate *c : {&first, &second})
        for (auto *samples : {&c->layers.folds, &c->layers.discontinuities})
            if (!samples->empty())
                return {{}, pieces_of(region, split_layers(surface, region, *samples))};
    const Frame &narrow = (bounds.cone ? first : second).frame;
    return {{}, pieces_of(region, split_normals(surface, region, narrow.z))};
}

void drop_empty(Vector<Region> &regions, Vector<Frame> &frames)
{
    size_t kept = 0;
    for (size_t i = 0; i < regions.size(); ++i) {
        if (!regions[i].size())
            continue;
        std::swap(regions[kept], regions[i]);
        frames[kept++] = frames[i];
    }
    regions.resize(kept);
    frames.resize(kept);
}

} // namespace gtx
