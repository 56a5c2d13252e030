/* Cleaning, component by component: which side is out, and whether there are two. */
#include "mesh/clean/clean.hpp"

namespace gtx {

/* A component whose borders could be closed with this share of its area is as good as closed, as
 * scans are: hardly anything shows of its inside, and twice as much would have to be drawn. */
constexpr double SMALL_GAPS = 0.01;

/* Six times the enclosed volume; positive when the triangles wind counter-clockwise seen from
 * outside. */
static double volume_of(const Mesh &mesh, const uint32_t *triangles, size_t count)
{
    Vec3d origin = mesh.position(triangles[0], 0);
    double volume = 0;
    for (size_t i = 0; i < count; ++i) {
        uint32_t t = triangles[i];
        volume += dot(mesh.position(t, 0) - origin,
                      cross(mesh.position(t, 1) - origin, mesh.position(t, 2) - origin));
    }
    return volume;
}

/* Whether the ray from p along +x meets triangle t. Both triangles of an edge decide alike on which
 * side of it p is, as they compute with its ends in the same order: no ray slips through. */
static bool ray_meets(const Mesh &mesh, size_t t, const Vec3d &p)
{
    bool inside = false;
    for (int k = 0; k < 3; ++k) {
        uint32_t va = mesh.triangles[t][k], vb = mesh.triangles[t][(k + 1) % 3];
        const Vec3d &a = mesh.positions[std::min(va, vb)], &b = mesh.positions[std::max(va, vb)];
        if ((a.y <= p.y) != (b.y <= p.y))
            inside ^= a.z + (b.z - a.z) * ((p.y - a.y) / (b.y - a.y)) > p.z;
    }
    if (!inside)
        return false;
    Vec3d normal = mesh.area_vector(t), to = mesh.position(t, 0) - p;
    return dot(normal, to) * normal.x > 0;
}

/* One point of a component and the components its ray met. */
struct Probe {
    Vec3d point;
    uint32_t component;
    Vector<uint32_t> met;
};

/* An odd number of crossings with one closed component means that it encloses the point. */
static bool is_enclosed(Probe &probe)
{
    std::sort(probe.met.begin(), probe.met.end());
    for (size_t i = 0, j; i < probe.met.size(); i = j) {
        for (j = i; j < probe.met.size() && probe.met[j] == probe.met[i];)
            ++j;
        if ((j - i) % 2)
            return true;
    }
    return false;
}

/* Shoots all probes at once: each triangle of a closed component looks up those at its height. */
static void shoot(const Mesh &mesh, const Components &components, const Vector<bool> &closed,
                  Vector<Probe> &probes, Task &task)
{
    auto lower = [](const Probe &probe, double y) { return probe.point.y < y; };
    for (size_t c = 0; c < components.count(); ++c) {
        task.advance(0.6 + 0.1 * double(c) / double(components.count()));
        for (size_t i = components.first[c]; closed[c] && i < components.first[c + 1]; ++i) {
            uint32_t t = components.order[i];
            double y[] = {mesh.position(t, 0).y, mesh.position(t, 1).y, mesh.position(t, 2).y};
            double top = std::max({y[0], y[1], y[2]});
            auto probe = std::lower_bound(probes.begin(), probes.end(),
                                          std::min({y[0], y[1], y[2]}), lower);
            for (; probe != probes.end() && probe->point.y <= top; ++probe)
                if (probe->component != c && ray_meets(mesh, t, probe->point))
                    probe->met.push_back(uint32_t(c));
        }
    }
}

/* A closed component of negative volume is the wall of a cavity if another encloses it, and inside
 * out if none does. */
static void turn_inside_out(Draft &surface, const Components &components,
                            const Vector<bool> &closed, Task &task)
{
    const Mesh &mesh = surface.mesh;
    Vector<Probe> probes;
    for (size_t c = 0; c < components.count(); ++c) {
        const uint32_t *first = &components.order[components.first[c]];
        if (closed[c] && volume_of(mesh, first, components.first[c + 1] - components.first[c]) < 0)
            probes.push_back({mesh.position(*first, 0), uint32_t(c), {}});
    }
    if (probes.empty())
        return;
    std::stable_sort(probes.begin(), probes.end(), [](const Probe &a, const Probe &b) {
        return a.point.y < b.point.y;
    });
    shoot(mesh, components, closed, probes, task);

    Vector<uint8_t> turn(mesh.triangles.size(), 0);
    for (Probe &probe : probes) {
        if (is_enclosed(probe))
            continue;
        ++surface.inside_out;
        size_t c = probe.component;
        for (size_t i = components.first[c]; i < components.first[c + 1]; ++i)
            turn[components.order[i]] = 1;
    }
    turn_triangles(surface, turn);
}

/* The half-edge after h along a border. */
static uint32_t next_border(const Vector<uint32_t> &twin, uint32_t h)
{
    for (h = next_edge(h); twin[h] != NO_EDGE;)
        h = next_edge(twin[h]);
    return h;
}

/* The area of a surface that would close the border along half-edge h: triangles around its centre.
 * Marks the border as seen. */
static double gap_at(const Draft &surface, uint32_t h, Vector<bool> &seen)
{
    const Mesh &mesh = surface.mesh;
    Vector<Vec3d> loop;
    Vec3d centre;
    for (; !seen[h]; h = next_border(surface.twin, h)) {
        seen[h] = true;
        loop.push_back(mesh.positions[start_of(mesh, h)]);
        centre += loop.back() - loop[0];
    }
    centre = loop[0] + centre / double(loop.size());
    double area = 0;
    for (size_t i = 0; i < loop.size(); ++i)
        area += length(cross(loop[i] - centre, loop[(i + 1) % loop.size()] - centre)) / 2;
    return area;
}

void choose_sides(Draft &surface, bool cut, Task &task, CleanReport &report)
{
    Components components = flood(surface.twin, [](uint32_t, uint32_t, bool) {});
    Vector<bool> closed(components.count()), seen(surface.twin.size());
    for (size_t c = 0; c < components.count(); ++c) {
        size_t from = components.first[c], to = components.first[c + 1];
        double area = 0, gaps = 0;
        for (size_t i = components.first_border[c]; i < components.first_border[c + 1]; ++i) {
            const uint32_t h = components.borders[i];
            gaps += seen[h] ? 0 : gap_at(surface, h, seen);
        }
        for (size_t i = from; i < to && gaps > SMALL_GAPS * area; ++i)
            area += length(surface.mesh.area_vector(components.order[i])) / 2;
        closed[c] = gaps <= SMALL_GAPS * area;
        surface.open_components += !closed[c] && !cut;
        for (size_t i = from; i < to && !closed[c] && !cut; ++i)
            surface.mesh.flags[components.order[i]] |= TRIANGLE_TWO_SIDED;
    }
    report.components = components.count();
    report.boundary_edges = components.borders.size();
    report.closed = report.boundary_edges == 0;
    turn_inside_out(surface, components, closed, task);
}

} // namespace gtx
