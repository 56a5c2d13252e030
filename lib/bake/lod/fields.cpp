/* Whose surface is whose: height fields overlap, and each is cut where the next one is as deep
 * inside its own outline. Both find that line, for it is where their trims are equal. */
#include "bake/lod/fields.hpp"

#include <algorithm>
#include <map>

namespace gtx::baking {

/* Tiles of a height grid have the same nodes where they meet: no number here changes any
 * of theirs (Reek's base in tiles of 64, at half and at double). They serve patches whose texels
 * differ. Measured on LOD meshes that `gtx pack` makes of the bunny's and Duck's maps: where no
 * more is said, the finest mesh errs by up to 6 % more or less, either way. */

/* A height field passes a point when it is no farther away than this, and as steep. Duck's coarsest
 * mesh: REACH_TEXELS at half, error +35 %. */
constexpr double REACH_TEXELS = 0.75, REACH_STEPS = 3, MIN_COSINE = 0.3;
/* So far inside its outline a height field that is not steep need not look for others. Trim may not
 * be told any deeper, so two that are would be equals. At half: error +9 %, a mesh more (bunny). */
constexpr double DEEP = DEEPEST_TRIM;
/* Where another height field goes on, one may end this many texels beyond its outline, so that both
 * reach the line between their outlines. */
constexpr double MAX_OUTSIDE = 1;
/* A height field steeper than this against a surface shows it with few texels, and gives it up to
 * others by so many texels. Half of either leaves slits that are bridged: 70 times the error
 * (bunny); STEEP at double: 50 times. */
constexpr double STEEP_COSINE = 0.5, STEEP = 8;
/* Texels whose trims differ by no more than this lie on the cut. At double: error +17 % (bunny). */
constexpr double ON_CUT = 0.4;

MapField::MapField(const Maps &maps, uint32_t patch)
    : HeightField(maps, patch), height_bits_(maps.height_bits),
      normals_(maps.normal[0].data() + 2 * first_texel(maps, maps.patches[patch]))
{
    const gtx_patch &p = maps.patches[patch];
    for (int k = 0; k < 2; ++k)
        texel_[k] = axis[k] * pitch[k];
    z_ = axis[2] * double(p.extent_z);
    first_ = origin + (texel_[0] + texel_[1]) * 0.5;
    const double det = dot(cross(texel_[0], texel_[1]), z_);
    row_[0] = cross(texel_[1], z_) / det;
    row_[1] = cross(z_, texel_[0]) / det;
    row_[2] = cross(texel_[0], texel_[1]) / det;
    fine_texel_ = std::min(length(texel_[0]), length(texel_[1]));
    reach_ = REACH_TEXELS * fine_texel_ + REACH_STEPS * p.extent_z / gtx_height_steps(height_bits_);
    float rows[3][3];
    gtx_normal_frame(&p, rows);
    for (int k = 0; k < 3; ++k)
        frame_[k] = loaded(rows[k]);
    low = high = first_;
    for (int k = 0; k < 8; ++k) {
        const Vec3d corner = place(k & 1 ? w - 1 : 0, k & 2 ? h - 1 : 0, k & 4 ? 1 : 0);
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], corner[a] - reach_);
            high[a] = std::max(high[a], corner[a] + reach_);
        }
    }
}

Vec3d MapField::normal(size_t texel) const
{
    float n[3];
    gtx_decode_normal(normals_ + 2 * texel, n);
    Vec3d out;
    for (int k = 0; k < 3; ++k)
        out += frame_[k] * n[k];
    return out;
}

double MapField::steepness(const Vec3d &facing) const
{
    return STEEP * std::max(0.0, STEEP_COSINE - std::fabs(dot(z_, facing)) / length(z_));
}

double MapField::trim_at(const Vec3d &point, const Vec3d &facing) const
{
    constexpr double SLACK = 1e-3; /* texels: a point on the side of a cell is in both */
    const Vec3d from = point - first_;
    const double u = dot(row_[0], from), v = dot(row_[1], from);
    if (!(u > -SLACK && v > -SLACK && u < w - 1 + SLACK && v < h - 1 + SLACK))
        return INFINITY;
    for (int n = 0; n < 4; ++n) {
        const int i = std::clamp(int(std::floor(u + (n & 1 ? -SLACK : SLACK))), 0, w - 2);
        const int j = std::clamp(int(std::floor(v + (n & 2 ? -SLACK : SLACK))), 0, h - 2);
        if (code(at(i, j)) && code(at(i + 1, j)) && code(at(i, j + 1)) && code(at(i + 1, j + 1)))
            return trim_in_cell(i, j, {u - i, v - j, dot(row_[2], from)}, facing);
    }
    return INFINITY;
}

double MapField::trim_in_cell(int i, int j, const Vec3d &in, const Vec3d &facing) const
{
    const CellPoint place = {at(i, j), in.x, in.y};
    double height = 0, trimmed = 0;
    for (size_t k = 0; k < 4; ++k) {
        const size_t texel = corner(place, k);
        height += place.weight(k) * (code(texel) - 1.0) / gtx_height_steps(height_bits_);
        trimmed += place.weight(k) * gtx_trim_distance(trim(texel));
    }
    const double apart = std::fabs(in.z - height) * std::fabs(dot(z_, facing));
    const Vec3d here = normal(at(i + (in.x > 0.5), j + (in.y > 0.5)));
    return apart <= reach_ && dot(here, facing) >= MIN_COSINE ? trimmed : INFINITY;
}

Vector<MapField> map_fields(const Maps &maps)
{
    Vector<MapField> fields;
    for (uint32_t p = 0; p < maps.patches.size(); ++p)
        fields.emplace_back(maps, p);
    return fields;
}

Vector<Vector<uint32_t>> touching(const Vector<MapField> &fields)
{
    Vector<uint32_t> order(fields.size()), open;
    for (uint32_t p = 0; p < order.size(); ++p)
        order[p] = p;
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return fields[a].low.x < fields[b].low.x;
    });
    Vector<Vector<uint32_t>> out(fields.size());
    for (uint32_t p : order) {
        const MapField &s = fields[p];
        open.erase(std::remove_if(open.begin(), open.end(),
                                  [&](uint32_t q) { return fields[q].high.x < s.low.x; }),
                   open.end());
        for (uint32_t q : open) {
            const MapField &t = fields[q];
            if (t.low.y <= s.high.y && s.low.y <= t.high.y && t.low.z <= s.high.z &&
                s.low.z <= t.high.z) {
                out[p].push_back(q);
                out[q].push_back(p);
            }
        }
        open.push_back(p);
    }
    for (auto &list : out)
        std::sort(list.begin(), list.end());
    return out;
}

/* How far a texel of a patch is from being its own: negative inside, 0 on the cut. */
static double distance_to_own(const Vector<MapField> &fields, uint32_t patch,
                              const Vector<uint32_t> &others, int i, int j)
{
    const MapField &field = fields[patch];
    const size_t texel = field.at(i, j);
    const Vec3d point = field.texel_point(i, j), normal = field.normal(texel);
    const double trim = gtx_trim_distance(field.trim(texel)), mine = trim + field.steepness(normal);
    if (trim <= DEEP && mine == trim)
        return trim;
    double own = -INFINITY;
    for (uint32_t other : others) {
        const double theirs = fields[other].trim_at(point, normal);
        if (theirs <= MAX_OUTSIDE)
            own = std::max(own, mine - theirs - fields[other].steepness(normal));
    }
    own = std::max(own, trim - (own == -INFINITY ? GTX_TRIM_SHOWN : MAX_OUTSIDE));
    return std::fabs(own) < ON_CUT ? 0 : own;
}

namespace {

/* Cuts the triangles of a height field where a value at its texels is 0. */
class Cutter {
public:
    Cutter(const MapField &field, const Vector<double> &value)
        : field_(field), value_(value), name_(value.size(), NO_VERTEX)
    {
    }

    void cell(int i, int j)
    {
        const int a = j * field_.w + i, b = a + 1, c = a + field_.w, d = c + 1;
        for (int t : {a, b, c, d})
            if (std::isnan(value_[t]))
                return;
        if (std::abs(bend(a, d)) <= std::abs(bend(b, c))) {
            triangle({a, b, d});
            triangle({a, d, c});
        } else {
            triangle({a, b, c});
            triangle({b, d, c});
        }
    }

    FieldPiece piece;

private:
    int bend(int a, int b) const
    {
        return int(field_.code(place(a))) - int(field_.code(place(b)));
    }
    uint32_t add(const Vec3d &position, const Vec3d &normal)
    {
        piece.positions.push_back(position);
        piece.normals.push_back(normal);
        return uint32_t(piece.positions.size() - 1);
    }
    /* `texel` counts those of the patch alone. */
    size_t place(int texel) const { return field_.at(texel % field_.w, texel / field_.w); }
    Vec3d point(int texel) const
    {
        return field_.texel_point(texel % field_.w, texel / field_.w);
    }
    uint32_t at_texel(int texel)
    {
        if (name_[texel] == NO_VERTEX)
            name_[texel] = add(point(texel), field_.normal(place(texel)));
        return name_[texel];
    }
    uint32_t between(int a, int b) /* one of them inside, the other outside */
    {
        if (a > b)
            std::swap(a, b);
        const auto [found, is_new] = cuts_.try_emplace({a, b}, 0);
        if (is_new) {
            const double at = value_[a] / (value_[a] - value_[b]);
            const Vec3d from = point(a);
            found->second = add(from + (point(b) - from) * at, field_.normal(place(a)));
        }
        return found->second;
    }
    void triangle(const std::array<int, 3> &texel)
    {
        uint32_t corner[4];
        int count = 0;
        bool any = false;
        for (int k = 0; k < 3; ++k) {
            const int here = texel[k], next = texel[(k + 1) % 3];
            any = any || value_[here] < 0;
            if (value_[here] <= 0)
                corner[count++] = at_texel(here);
            if (value_[here] * value_[next] < 0)
                corner[count++] = between(here, next);
        }
        for (int k = 2; any && k < count; ++k)
            piece.triangles.push_back({corner[0], corner[k - 1], corner[k]});
    }

    const MapField &field_;
    const Vector<double> &value_;
    Vector<uint32_t> name_;
    std::map<std::array<int, 2>, uint32_t> cuts_;
};

} // namespace

static void find_border(FieldPiece &piece)
{
    Vector<std::array<uint32_t, 2>> edges;
    for (const Triangle &t : piece.triangles)
        for (int k = 0; k < 3; ++k)
            edges.push_back({t[k], t[(k + 1) % 3]});
    std::sort(edges.begin(), edges.end());
    piece.at_border.assign(piece.positions.size(), 0);
    for (const auto &[a, b] : edges)
        if (!std::binary_search(edges.begin(), edges.end(), std::array<uint32_t, 2>{b, a}))
            piece.at_border[a] = piece.at_border[b] = 1;
}

FieldPiece cut_field(const Vector<MapField> &fields, uint32_t patch,
                     const Vector<uint32_t> &others)
{
    const MapField &field = fields[patch];
    Vector<double> value(size_t(field.w) * field.h, NAN);
    for (int j = 0; j < field.h; ++j)
        for (int i = 0; i < field.w; ++i)
            if (field.code(field.at(i, j)))
                value[size_t(j) * field.w + i] = distance_to_own(fields, patch, others, i, j);
    Cutter cutter(field, value);
    for (int j = 0; j + 1 < field.h; ++j)
        for (int i = 0; i + 1 < field.w; ++i)
            cutter.cell(i, j);
    find_border(cutter.piece);
    return std::move(cutter.piece);
}

} // namespace gtx::baking
