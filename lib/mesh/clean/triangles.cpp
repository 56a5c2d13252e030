/* Cleaning, triangle by triangle: what cannot be drawn goes, equal positions become one vertex. */
#include "mesh/clean/clean.hpp"

#include <cfloat>
#include <cstring>

namespace gtx {

enum Fate : uint8_t { KEEP, BAD_INDEX, NON_FINITE, DEGENERATE, DUPLICATE };
static const char *const fate_names[] = {"", "index", "non-finite", "degenerate", "duplicate"};

/* Removes the items of the triangles that are not kept; each has `per` in a row, or all none. */
template <class T>
static void compact(Vector<T> &items, size_t per, const Vector<uint8_t> &fates)
{
    size_t kept = 0;
    for (size_t t = 0; t < fates.size() && !items.empty(); ++t)
        for (size_t k = 0; k < per && fates[t] == KEEP; ++k)
            items[kept++] = items[per * t + k];
    items.resize(kept);
}

/* Removes the triangles whose fate is not to be kept and counts them by reason. */
static void drop(Mesh &mesh, const Vector<uint8_t> &fates, CleanReport &report)
{
    uint64_t counts[sizeof(fate_names) / sizeof(*fate_names)] = {0};
    for (uint8_t fate : fates)
        ++counts[fate];
    compact(mesh.triangles, 1, fates);
    compact(mesh.flags, 1, fates);
    compact(mesh.appearance.material, 1, fates);
    for_each_corner_attribute(mesh, [&](auto &items) { compact(items, 3, fates); });
    for (size_t f = BAD_INDEX; f <= DUPLICATE; ++f)
        if (counts[f])
            report.dropped[fate_names[f]] += counts[f];
}

/* The largest magnitude of a coordinate; NaN counts as infinite. */
static double magnitude(const Vec3d &p)
{
    double m = 0;
    for (int i = 0; i < 3; ++i)
        m = std::fabs(p[i]) <= m ? m : std::isnan(p[i]) ? HUGE_VAL : std::fabs(p[i]);
    return m;
}

/* Squared areas are fourth powers of lengths: coordinates beyond 1e75 overflow them, and below
 * DBL_MIN they have lost their digits. Otherwise a triangle is degenerate when its height over the
 * longest edge is within 2^-48 of its largest coordinate: 16 units in the last place, about what
 * a transformation and the cross product themselves round away. */
static Fate fate_of(const Mesh &mesh, size_t t)
{
    const auto &triangle = mesh.triangles[t];
    double size = 0;
    for (uint32_t v : triangle) {
        if (v >= mesh.positions.size())
            return BAD_INDEX;
        size = std::max(size, magnitude(mesh.positions[v]));
    }
    if (size > 1e75)
        return NON_FINITE;
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
        Vec3d edge = mesh.position(t, (k + 1) % 3) - mesh.position(t, k);
        longest = std::max(longest, dot(edge, edge));
    }
    Vec3d area = mesh.area_vector(t);
    double height = size * 0x1p-48;
    return dot(area, area) > std::max(DBL_MIN, longest * height * height) ? KEEP : DEGENERATE;
}

static bool all_kept(const Vector<uint8_t> &fates)
{
    return std::all_of(fates.begin(), fates.end(), [](uint8_t fate) { return fate == KEEP; });
}

void drop_invalid(Mesh &mesh, Task &task, CleanReport &report)
{
    constexpr size_t LEAST = 1 << 12;
    Vector<uint8_t> fates(mesh.triangles.size());
    const size_t parts = task.parts(fates.size(), LEAST);
    task.in_parts(fates.size(), parts, [&](size_t, size_t from, size_t to) {
        for (size_t t = from; t < to; ++t)
            fates[t] = fate_of(mesh, t);
    });
    if (!all_kept(fates))
        drop(mesh, fates, report);
}

static uint64_t hash_position(const Vec3d &p)
{
    uint64_t words[3], h = 0x9e3779b97f4a7c15u;
    std::memcpy(words, &p, sizeof words);
    for (uint64_t w : words) {
        h = (h ^ w) * 0xff51afd7ed558ccdu;
        h ^= h >> 32;
    }
    return h * 0xc4ceb9fe1a85ec53u >> 20;
}

/* For each position one that is equal, the same for all of these: which one is chance. An
 * open-addressed table, at most half full. Only finite positions: what equals nothing fills it. */
static Vector<uint32_t> equal_positions(const Vector<Vec3d> &positions, Task *task)
{
    size_t capacity = 16;
    while (capacity < 2 * positions.size())
        capacity *= 2;
    /* Vertices plus 1, so that a table of zeros is empty. */
    Vector<std::atomic<uint32_t>> table(capacity);
    Vector<uint32_t> equal(positions.size(), NO_EDGE);
    auto look_up = [&](size_t, size_t from, size_t to) {
        for (size_t v = from; v < to; ++v) {
            cancel_point();
            const Vec3d p = positions[v] + Vec3d(0, 0, 0); /* makes -0 and 0 the same bits */
            if (!is_finite(p))
                continue;
            for (size_t slot = hash_position(p); equal[v] == NO_EDGE; ++slot) {
                uint32_t other = 0; /* taken by whoever is first */
                table[slot & (capacity - 1)].compare_exchange_strong(
                    other, uint32_t(v + 1), std::memory_order_relaxed);
                other = other ? other - 1 : uint32_t(v);
                if (positions[other] == p)
                    equal[v] = other;
            }
        }
    };
    constexpr size_t LEAST = 1 << 12;
    if (task)
        task->in_parts(positions.size(), task->parts(positions.size(), LEAST), look_up);
    else
        look_up(0, 0, positions.size());
    return equal;
}

void weld(Mesh &mesh, Task *task)
{
    const Vector<uint32_t> equal = equal_positions(mesh.positions, task);
    Vector<uint32_t> number(mesh.positions.size(), NO_EDGE);
    Vector<Vec3d> welded;
    size_t most = 0;
    for (size_t v = 0; v < equal.size(); ++v)
        most += equal[v] == v;
    welded.reserve(most);
    for (auto &triangle : mesh.triangles) {
        cancel_point();
        for (uint32_t &v : triangle) {
            uint32_t &own = number[equal[v]];
            if (own == NO_EDGE) {
                own = uint32_t(welded.size());
                welded.push_back(mesh.positions[v] + Vec3d(0, 0, 0));
            }
            v = own;
        }
    }
    welded.shrink_to_fit();
    mesh.positions = std::move(welded);
}

/* A triangle in the list of those that share its lowest vertex. */
struct TriangleEntry {
    uint32_t middle, high, triangle;
    bool odd; /* its corners are an odd permutation of their order */
    bool operator<(const TriangleEntry &o) const
    {
        return middle != o.middle ? middle < o.middle
               : high != o.high   ? high < o.high
                                  : triangle < o.triangle;
    }
};

/* Those whose lowest vertex is in [begin, after). A counting sort by it leaves short lists; end[v]
 * is where that of begin + v ends. */
static Vector<TriangleEntry> list_triangles(const Mesh &mesh, size_t begin, size_t after,
                                            Vector<uint32_t> &end)
{
    end.assign(after - begin + 1, 0);
    for (const auto &v : mesh.triangles)
        if (const size_t low = std::min({v[0], v[1], v[2]}) - begin; low < after - begin)
            ++end[low + 1];
    for (size_t v = 1; v < end.size(); ++v)
        end[v] += end[v - 1];
    Vector<TriangleEntry> entries(end.back());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        auto v = mesh.triangles[t];
        if (const size_t low = std::min({v[0], v[1], v[2]}) - begin; low < after - begin) {
            bool odd = (v[0] > v[1]) ^ (v[1] > v[2]) ^ (v[0] > v[2]);
            std::sort(v.begin(), v.end());
            entries[end[low]++] = {v[1], v[2], uint32_t(t), odd};
        }
    }
    return entries;
}

/* Of the triangles whose lowest vertex is in [begin, after). */
static void find_duplicates(const Mesh &mesh, size_t begin, size_t after, Vector<uint8_t> &fates,
                            Vector<uint8_t> &thin)
{
    Vector<uint32_t> end;
    Vector<TriangleEntry> entries = list_triangles(mesh, begin, after, end);
    TriangleEntry *from = entries.data();
    for (size_t v = 0; v < after - begin; ++v) {
        TriangleEntry *to = entries.data() + end[v];
        std::sort(from, to);
        while (from != to) {
            TriangleEntry *first = from;
            long odd = 0;
            for (; from != to && from->middle == first->middle && from->high == first->high; ++from)
                odd += from->odd;
            long count = from - first;
            TriangleEntry *keeper = first; /* the first that winds as most do */
            while (2 * odd != count && keeper->odd != (2 * odd > count))
                ++keeper;
            for (TriangleEntry *e = first; e != from; ++e)
                fates[e->triangle] = e == keeper ? KEEP : DUPLICATE;
            thin[keeper->triangle] = 2 * odd == count;
        }
    }
}

Vector<uint8_t> drop_duplicates(Mesh &mesh, Task &task, CleanReport &report)
{
    Vector<uint8_t> fates(mesh.triangles.size(), KEEP), thin(fates.size(), 0);
    const size_t vertices = mesh.positions.size();
    task.in_parts(vertices, vertex_parts(mesh, task), [&](size_t, size_t from, size_t to) {
        find_duplicates(mesh, from, to, fates, thin);
    });
    if (all_kept(fates))
        return thin;
    size_t kept = 0;
    for (size_t t = 0; t < fates.size(); ++t)
        if (fates[t] == KEEP)
            thin[kept++] = thin[t];
    thin.resize(kept);
    drop(mesh, fates, report);
    return thin;
}

} // namespace gtx
