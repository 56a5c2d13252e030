/* Moves the borders of clusters by switching labels. */
#include "chart/cuts/borders.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* Times that clusters' normals are fitted anew, and sweeps along the borders each time. Half: RMS
 * +5 % (Duck), +4 % (bunny); double: RMS +20 %, +13 % (Duck). */
constexpr int REFITS = 10, SWEEPS = 3;
/* The last refits straighten borders: what a neighbour of the same cluster weighs beside the cosine
 * between a triangle's normal and the cluster's. Half: patches +2 % (bunny), RMS +10 % (Duck);
 * double: RMS +2 %, +12 % (Duck, truck). */
constexpr int STRAIGHT_REFITS = 3;
constexpr float STRAIGHTNESS = 0.3f;

/* Triangles that a thread looks at, at least; changes no byte. */
constexpr size_t CHUNK = 1 << 14;

/* The triangles with a neighbour of another label. */
Vector<uint32_t> border_of(const Surface &surface, const Vector<uint32_t> &labels, Task &task)
{
    Vector<Vector<uint32_t>> parts(task.parts(labels.size(), CHUNK));
    task.in_parts(labels.size(), parts.size(), [&](size_t part, size_t from, size_t to) {
        for (size_t t = from; t < to; ++t) {
            const auto &around = surface.whole.neighbours[t];
            if (std::any_of(around.begin(), around.end(), [&](uint32_t n) {
                    return n != NO_TRIANGLE && labels[n] != labels[t];
                }))
                parts[part].push_back(uint32_t(t));
        }
    });
    for (size_t part = 1; part < parts.size(); ++part)
        parts[0].insert(parts[0].end(), parts[part].begin(), parts[part].end());
    return std::move(parts[0]);
}

/* The normal of each cluster: each is summed up by one thread, in the order of its triangles. */
Vector<Vec3f> fit_normals(const Surface &surface, const Vector<uint32_t> &labels, size_t count,
                          Task &task)
{
    Vector<Vec3f> proxies(count);
    const size_t parts = std::min(task.parts(labels.size(), CHUNK), count);
    task.in_parts(count, parts, [&](size_t, size_t from, size_t to) {
        Vector<Vec3d> sums(to - from);
        for (size_t t = 0; t < labels.size(); ++t)
            if (labels[t] - from < to - from)
                sums[labels[t] - from] +=
                    Vec3d(surface.facets[t].normal) * double(surface.facets[t].size);
        for (size_t c = from; c < to; ++c)
            proxies[c] = Vec3f(normalize(sums[c - from]));
    });
    return proxies;
}

} // namespace

void move_borders(const Surface &surface, size_t count, Vector<uint32_t> &labels, Task &task)
{
    const auto &neighbours = surface.whole.neighbours;
    for (int refit = 0; refit < REFITS; ++refit) {
        Vector<uint32_t> border = border_of(surface, labels, task);
        if (border.empty())
            break;
        const Vector<Vec3f> proxies = fit_normals(surface, labels, count, task);
        const float straightness = refit < REFITS - STRAIGHT_REFITS ? 0 : STRAIGHTNESS;
        auto liking = [&](uint32_t t, uint32_t label) {
            int alike = 0;
            for (size_t k = 0; k < 3 && straightness > 0; ++k)
                alike += neighbours[t][k] != NO_TRIANGLE && labels[neighbours[t][k]] == label;
            return dot(surface.facets[t].normal, proxies[label]) + straightness * float(alike);
        };
        for (int sweep = 0; sweep < SWEEPS; ++sweep) {
            Vector<uint32_t> moved;
            for (uint32_t t : border) {
                uint32_t best = labels[t];
                float most = liking(t, best);
                for (uint32_t n : neighbours[t]) {
                    if (n == NO_TRIANGLE || labels[n] == best)
                        continue;
                    const float like = liking(t, labels[n]);
                    if (like > most) {
                        most = like;
                        best = labels[n];
                    }
                }
                if (best == labels[t])
                    continue;
                labels[t] = best;
                for (uint32_t n : neighbours[t])
                    if (n != NO_TRIANGLE)
                        moved.push_back(n);
            }
            border = std::move(moved);
        }
        task.advance(0.5 + 0.2 * refit / REFITS);
    }
}

void absorb_islands(const Surface &surface, size_t count, Vector<uint32_t> &labels)
{
    Vector<uint32_t> piece = labels;
    uint32_t pieces = connected_pieces(surface.whole, piece);
    Vector<double> size(pieces);
    Vector<uint32_t> of(pieces), main(count, NO_TRIANGLE);
    Vector<Vector<uint32_t>> across(pieces);           /* labels, an entry an edge */
    for (uint32_t t = 0; t < labels.size(); ++t) {
        size[piece[t]] += double(surface.facets[t].size);
        of[piece[t]] = labels[t];
    }
    for (uint32_t p = 0; p < pieces; ++p)
        if (main[of[p]] == NO_TRIANGLE || size[p] > size[main[of[p]]])
            main[of[p]] = p;
    for (uint32_t t = 0; t < labels.size(); ++t)
        for (uint32_t n : surface.whole.neighbours[t])
            if (main[labels[t]] != piece[t] && n != NO_TRIANGLE && main[labels[n]] == piece[n] &&
                labels[n] != labels[t])
                across[piece[t]].push_back(labels[n]);
    for (uint32_t p = 0; p < pieces; ++p) {
        std::sort(across[p].begin(), across[p].end());
        size_t most = 0;
        for (size_t i = 0, run = 0; i < across[p].size(); ++i) {
            run = i && across[p][i] == across[p][i - 1] ? run + 1 : 1;
            if (run > most) {
                most = run;
                of[p] = across[p][i];
            }
        }
    }
    for (uint32_t t = 0; t < labels.size(); ++t)
        labels[t] = of[piece[t]];
}

} // namespace gtx
