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

void drop_invalid(Mesh &mesh, CleanReport &report)
{
    Vector<uint8_t> fates(mesh.triangles.size());
    bool all_kept = true;
    for (size_t t = 0; t < fates.size(); ++t) {
        fates[t] = fate_of(mesh, t);
        all_kept = all_kept && fates[t] == KEEP;
    }
    if (!all_kept)
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

/* An open-addressed table of vertex numbers, at most half full. */
void weld(Mesh &mesh)
{
    size_t bound = std::min(mesh.positions.size(), 3 * mesh.triangles.size());
    size_t capacity = 16;
    while (capacity < 2 * bound)
        capacity *= 2;
    Vector<uint32_t> table(capacity, NO_EDGE), number(mesh.positions.size(), NO_EDGE);
    Vector<Vec3d> welded;
    for (auto &triangle : mesh.triangles) {
        cancel_point();
        for (uint32_t &v : triangle) {
            if (number[v] == NO_EDGE) {
                /* adding zero makes -0 and 0 the same bits */
                const Vec3d p = mesh.positions[v] + Vec3d(0, 0, 0);
                size_t slot = hash_position(p) & (capacity - 1);
                while (table[slot] != NO_EDGE && welded[table[slot]] != p)
                    slot = (slot + 1) & (capacity - 1);
                if (table[slot] == NO_EDGE) {
                    table[slot] = uint32_t(welded.size());
                    welded.push_back(p);
                }
                number[v] = table[slot];
            }
            v = number[v];
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

/* A counting sort by the lowest vertex leaves short lists; end[v] is where that of v ends. */
static Vector<TriangleEntry> list_triangles(const Mesh &mesh, Vector<uint32_t> &end)
{
    end.assign(mesh.positions.size() + 1, 0);
    for (const auto &v : mesh.triangles)
        ++end[std::min({v[0], v[1], v[2]}) + 1];
    for (size_t v = 1; v < end.size(); ++v)
        end[v] += end[v - 1];
    Vector<TriangleEntry> entries(mesh.triangles.size());
    for (size_t t = 0; t < entries.size(); ++t) {
        auto v = mesh.triangles[t];
        bool odd = (v[0] > v[1]) ^ (v[1] > v[2]) ^ (v[0] > v[2]);
        std::sort(v.begin(), v.end());
        entries[end[v[0]]++] = {v[1], v[2], uint32_t(t), odd};
    }
    return entries;
}

Vector<uint8_t> drop_duplicates(Mesh &mesh, CleanReport &report)
{
    Vector<uint32_t> end;
    Vector<TriangleEntry> entries = list_triangles(mesh, end);
    Vector<uint8_t> fates(entries.size(), KEEP), thin(entries.size(), 0);
    bool all_kept = true;
    TriangleEntry *from = entries.data();
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
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
            all_kept = all_kept && count == 1;
        }
    }
    if (all_kept)
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
