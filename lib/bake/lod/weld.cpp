/* Joins the pieces of a surface that end along the same lines: their border vertices become common,
 * and borders are split at each other's vertices. */
#include "bake/lod/weld.hpp"

namespace gtx::baking {

/* Vertices of borders this near to each other become one. Texels of the finer height field. LOD
 * meshes of the bunny's maps: at double 120 times the error; at half 1 %. */
constexpr double NEAR = 0.5;
/* Those of one surface do not face away from each other. Half or double: error +3 % (Duck). */
constexpr double MIN_COSINE = 0.2;
/* An edge is followed no farther than this for vertices beside it, in cells of `Places`: a limit,
 * the same at half and at double. */
constexpr double MAX_STEPS = 64;
/* What closes a gap may fold in its turn. A limit: the same after two rounds and after six. */
constexpr int ROUNDS = 3;

static double widest(const Vector<MapField> &fields)
{
    double most = 0;
    for (const MapField &field : fields)
        most = std::max(most, field.fine_texel());
    return most;
}

Welder::Welder(const Vector<MapField> &fields, Vector<FieldPiece> pieces,
               const Vector<Vector<uint32_t>> &others)
    : fields_(fields), others_(others), places_(NEAR * widest(fields))
{
    for (uint32_t p = 0; p < pieces.size(); ++p) {
        FieldPiece piece = std::move(pieces[p]);
        const uint32_t first = uint32_t(source.positions.size());
        source.positions.insert(source.positions.end(), piece.positions.begin(),
                                piece.positions.end());
        normals_.insert(normals_.end(), piece.normals.begin(), piece.normals.end());
        at_border_.insert(at_border_.end(), piece.at_border.begin(), piece.at_border.end());
        piece_.resize(source.positions.size(), p);
        for (Triangle t : piece.triangles) {
            for (uint32_t &v : t)
                v += first;
            source.triangles.push_back(t);
            source.patch.push_back(p);
        }
    }
}

double Welder::reach(uint32_t vertex) const
{
    return NEAR * fields_[piece_[vertex]].fine_texel();
}

bool Welder::facing(uint32_t a, uint32_t b) const
{
    return dot(normals_[a], normals_[b]) >= MIN_COSINE;
}

/* The nearest common vertex that this one may become. */
uint32_t Welder::find_common(uint32_t vertex) const
{
    uint32_t best = NO_VERTEX;
    double least = INFINITY;
    places_.around(source.positions[vertex], [&](uint32_t other) {
        const double apart = length(source.positions[other] - source.positions[vertex]);
        if (apart <= std::min(reach(vertex), reach(other)) && facing(vertex, other) &&
            (apart < least || (apart == least && other < best))) {
            least = apart;
            best = other;
        }
    });
    return best;
}

/* A vertex without a common one near becomes one itself, so that they keep a distance; then each
 * becomes the nearest. */
void Welder::join_vertices()
{
    const uint32_t count = uint32_t(source.positions.size());
    for (uint32_t v = 0; v < count; ++v) {
        cancel_point();
        if (at_border_[v] && find_common(v) == NO_VERTEX)
            places_.add(source.positions[v], v);
    }
    Vector<uint32_t> name(count);
    for (uint32_t v = 0; v < count; ++v) {
        cancel_point();
        name[v] = at_border_[v] ? find_common(v) : v;
    }
    for (Triangle &t : source.triangles)
        for (uint32_t &v : t)
            v = name[v];
    drop_collapsed();
}

void Welder::drop_collapsed()
{
    Vector<uint8_t> collapsed;
    for (const Triangle &v : source.triangles)
        collapsed.push_back(v[0] == v[1] || v[1] == v[2] || v[2] == v[0]);
    drop(collapsed);
}

void Welder::drop(const Vector<uint8_t> &dropped)
{
    size_t left = 0;
    for (size_t t = 0; t < dropped.size(); ++t) {
        if (dropped[t])
            continue;
        source.triangles[left] = source.triangles[t];
        source.patch[left++] = source.patch[t];
    }
    source.triangles.resize(left);
    source.patch.resize(left);
}

/* Edges with a triangle on one side alone, and that triangle. */
Vector<OpenEdge> Welder::open_edges() const
{
    Vector<OpenEdge> edges;
    for (uint32_t t = 0; t < source.triangles.size(); ++t) {
        const Triangle &v = source.triangles[t];
        for (int k = 0; k < 3; ++k)
            if (at_border_[v[k]] && at_border_[v[(k + 1) % 3]])
                edges.push_back({{v[k], v[(k + 1) % 3]}, t});
    }
    std::sort(edges.begin(), edges.end());
    auto has = [&](const Edge &e) {
        const auto at = std::lower_bound(edges.begin(), edges.end(), std::make_pair(e, 0u));
        return at != edges.end() && at->first == e;
    };
    Vector<OpenEdge> open;
    for (const auto &edge : edges)
        if (!has({edge.first[1], edge.first[0]}))
            open.push_back(edge);
    return open;
}

/* The common vertices that an open edge passes by, in its order; none that are its neighbours on
 * both sides (`beside`: those that a vertex shares an open edge with). */
Vector<uint32_t> Welder::stops_on(const OpenEdge &open, const Places &ends,
                                  const Vector<Vector<uint32_t>> &beside) const
{
    const auto [a, b] = open.first;
    const Vec3d from = source.positions[a], way = source.positions[b] - from;
    const double size = std::min(reach(a), reach(b)), far = length(way);
    const int steps = int(std::min(far / ends.size(), MAX_STEPS)) + 1;
    Vector<uint32_t> near;
    for (int s = 0; s <= steps; ++s)
        ends.around(from + way * (double(s) / steps), [&](uint32_t v) { near.push_back(v); });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    Vector<std::pair<double, uint32_t>> stops;
    for (uint32_t v : near) {
        auto is_beside = [&](uint32_t end) {
            return std::find(beside[end].begin(), beside[end].end(), v) != beside[end].end();
        };
        const Vec3d to = source.positions[v] - from;
        const double at = dot(to, way) / (far * far);
        if (!(at > 0 && at < 1) || corner_of(source.triangles[open.second], v) >= 0 ||
            (is_beside(a) && is_beside(b)))
            continue;
        if (length(to - way * at) <= std::min(reach(v), size) && facing(v, a))
            stops.push_back({at, v});
    }
    std::sort(stops.begin(), stops.end());
    Vector<uint32_t> out;
    for (const auto &stop : stops)
        out.push_back(stop.second);
    return out;
}

/* Leads an edge through the stops: its triangle becomes a fan. */
void Welder::divide(const OpenEdge &open, Vector<uint32_t> stops)
{
    const Triangle whole = source.triangles[open.second];
    const uint32_t patch = source.patch[open.second];
    const uint32_t apex = whole[(corner_of(whole, open.first[1]) + 1) % 3];
    source.triangles[open.second] = {open.first[0], stops[0], apex};
    stops.push_back(open.first[1]);
    for (size_t i = 1; i < stops.size(); ++i) {
        source.triangles.push_back({stops[i - 1], stops[i], apex});
        source.patch.push_back(patch);
    }
}

/* Where one piece has a vertex the other has it too, so that their borders are the same edges. */
void Welder::split_edges()
{
    const Vector<OpenEdge> open = open_edges();
    Places ends(places_.size());
    Vector<Vector<uint32_t>> beside(source.positions.size());
    for (const auto &[edge, t] : open)
        for (int k = 0; k < 2; ++k) {
            if (beside[edge[k]].empty())
                ends.add(source.positions[edge[k]], edge[k]);
            beside[edge[k]].push_back(edge[1 - k]);
        }
    Vector<uint8_t> divided(source.triangles.size(), 0);
    for (const OpenEdge &edge : open) {
        const uint32_t t = edge.second;
        if (divided[t])
            continue;
        const Vector<uint32_t> stops = stops_on(edge, ends, beside);
        if (stops.empty())
            continue;
        divided[t] = 1;
        divide(edge, stops);
    }
}

LodSource weld(const Vector<MapField> &fields, Vector<FieldPiece> pieces,
               const Vector<Vector<uint32_t>> &others)
{
    Welder welder(fields, std::move(pieces), others);
    welder.join_vertices();
    welder.split_edges();
    for (int n = 0; n < ROUNDS; ++n) {
        welder.drop_folds();
        welder.close_gaps();
    }
    return std::move(welder.source);
}

} // namespace gtx::baking
