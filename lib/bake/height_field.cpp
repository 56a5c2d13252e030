/* Decodes the maps of patches: what a reader sees at a point. */
#include "bake/height_field.hpp"

namespace gtx::baking {

HeightField::HeightField(const PatchMaps &patch, unsigned height_bits)
    : codes_(reinterpret_cast<const uint8_t *>(patch.height.data())), trim_(patch.trim.data()),
      ending_(patch.ending.data()), code_bytes_(2), row_(patch.record.rect[2])
{
    decode(patch.record, height_bits);
}

HeightField::HeightField(const Maps &maps, uint32_t patch)
    : code_bytes_(maps.height_bits / 8), row_(maps.page_width)
{
    const gtx_patch &r = maps.patches[patch];
    const size_t first = first_texel(maps, r);
    codes_ = maps.height.data() + first * code_bytes_;
    trim_ = maps.trim.data() + first;
    decode(r, maps.height_bits);
}

void HeightField::decode(const gtx_patch &r, unsigned height_bits)
{
    const float *from[3] = {r.axis_x, r.axis_y, r.axis_z};
    w = r.rect[2];
    h = r.rect[3];
    two_sided = r.flags & GTX_PATCH_TWO_SIDED;
    for (int k = 0; k < 3; ++k)
        axis[k] = loaded(from[k]);
    origin = loaded(r.origin);
    const double det = dot(cross(axis[0], axis[1]), axis[2]);
    for (int k = 0; k < 3; ++k)
        dual[k] = cross(axis[(k + 1) % 3], axis[(k + 2) % 3]) / det;
    pitch[0] = double(r.extent_x) / w;
    pitch[1] = double(r.extent_y) / h;
    for (int k = 0; k < 2; ++k)
        per_texel_[k] = dual[k] / pitch[k];
    step = gtx_height_step(&r, height_bits);
    const Vec3d across[2] = {axis[0] * double(r.extent_x), axis[1] * double(r.extent_y)};
    const Vec3d up = axis[2] * (gtx_height_steps(height_bits) * step);
    for (int corner = 0; corner < 8; ++corner)
        box.add(origin + across[0] * (corner & 1) + across[1] * (corner >> 1 & 1) +
                up * (corner >> 2));
}

bool HeightField::field_above(const Vec3d &point, double &above, double &trim) const
{
    const Vec3d from = point - origin;
    const double u = across(0, from), v = across(1, from);
    if (!(u >= 0 && v >= 0 && u < w - 1 && v < h - 1))
        return false;
    const size_t cell = at(int(u), int(v));
    const int codes[4] = {int(code(cell)), int(code(cell + 1)), int(code(cell + row_)),
                          int(code(cell + row_ + 1))};
    if (!(codes[0] && codes[1] && codes[2] && codes[3]))
        return false;
    const double x = u - int(u), y = v - int(v);
    const double weights[4] = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
    const uint8_t *first = trim_ + cell, *second = first + row_;
    const uint8_t trims[4] = {first[0], first[1], second[0], second[1]};
    double mean = 0;
    trim = 0;
    for (size_t k = 0; k < 4; ++k) {
        mean += weights[k] * codes[k];
        trim += weights[k] * gtx_trim_distance(trims[k]);
    }
    above = height(mean) - dot(dual[2], from);
    return true;
}

/* Between nodes the way down from the triangle's plane is bilinear, as the height field is: nowhere
 * is it longer than at all of them. */
bool HeightField::surely_shows(const Vec3d (&corner)[3], double deeper, double trim,
                               int nodes) const
{
    double u[3], v[3], z[3];
    for (int k = 0; k < 3; ++k) {
        const Vec3d from = corner[k] - origin;
        u[k] = across(0, from);
        v[k] = across(1, from);
        z[k] = dot(dual[2], from);
    }
    const double left = std::min({u[0], u[1], u[2]}), right = std::max({u[0], u[1], u[2]});
    const double low = std::min({v[0], v[1], v[2]}), high = std::max({v[0], v[1], v[2]});
    if (!(left >= 0 && low >= 0 && right < w - 1 && high < h - 1) ||
        (int(right) - int(left) + 2) * (int(high) - int(low) + 2) > nodes)
        return false;
    const double u1 = u[1] - u[0], v1 = v[1] - v[0], z1 = z[1] - z[0];
    const double u2 = u[2] - u[0], v2 = v[2] - v[0], z2 = z[2] - z[0];
    const double area = u1 * v2 - u2 * v1;
    const double along_u = (z1 * v2 - z2 * v1) / area, along_v = (u1 * z2 - u2 * z1) / area;
    for (int j = int(low); j <= int(high) + 1; ++j)
        for (int i = int(left); i <= int(right) + 1; ++i) {
            const double plane = z[0] + along_u * (i - u[0]) + along_v * (j - v[0]);
            const uint32_t of_texel = code(at(i, j));
            if (!of_texel || !(gtx_trim_distance(trim_[at(i, j)]) < trim) ||
                !(height(of_texel) - plane >= -deeper))
                return false;
        }
    return true;
}

CellPoint HeightField::place_of(const Vec3d &point) const
{
    const Vec3d from = point - origin;
    const double u = across(0, from), v = across(1, from);
    const int i = int(u), j = int(v);
    return {at(i, j), u - i, v - j};
}

Vec3d HeightField::point(const CellPoint &place) const
{
    double mean = 0;
    for (size_t k = 0; k < 4; ++k)
        mean += place.weight(k) * code(corner(place, k));
    return point(double(place.cell % row_) + place.x, double(place.cell / row_) + place.y,
                 height(mean));
}

Vec3d HeightField::normal(const CellPoint &place) const
{
    double c[4];
    for (size_t k = 0; k < 4; ++k)
        c[k] = code(corner(place, k));
    const double x = place.x, y = place.y;
    const double along_u = (c[1] - c[0]) * (1 - y) + (c[3] - c[2]) * y;
    const double along_v = (c[2] - c[0]) * (1 - x) + (c[3] - c[1]) * x;
    return normalize(cross(axis[0] * pitch[0] + axis[2] * (along_u * step),
                           axis[1] * pitch[1] + axis[2] * (along_v * step)));
}

HeightFields::HeightFields(const Vector<PatchMaps> &patches, unsigned height_bits)
{
    for (size_t i = 0; i < patches.size(); ++i)
        if (patches[i].coded) {
            fields_.emplace_back(patches[i], height_bits);
            patch_.push_back(uint32_t(i));
        }
    for (uint32_t i = 0; i < fields_.size(); ++i)
        order_.push_back(i);
    ranked_ = order_;
    std::sort(ranked_.begin(), ranked_.end(),
              [this](uint32_t a, uint32_t b) { return is_before(fields_[a], fields_[b]); });
    rank_.resize(ranked_.size());
    for (uint32_t i = 0; i < ranked_.size(); ++i)
        rank_[ranked_[i]] = i;
    if (!order_.empty())
        build(0, uint32_t(order_.size()));
}

/* A node and those below it: halves at medians along the longest side of the box of middles. */
void HeightFields::build(uint32_t from, uint32_t to)
{
    auto twice_middle = [this](uint32_t field) {
        return fields_[field].box.low + fields_[field].box.high;
    };
    const size_t at = nodes_.size();
    Node node = {{}, from, to, 0};
    Box middles;
    for (uint32_t i = from; i < to; ++i) {
        node.box.add(fields_[order_[i]].box.low);
        node.box.add(fields_[order_[i]].box.high);
        middles.add(twice_middle(order_[i]));
    }
    nodes_.push_back(node);
    if (to - from <= LEAF) { /* in which order halving leaves them is the library's choice */
        std::sort(order_.begin() + from, order_.begin() + to);
        return;
    }
    const Vec3d side = middles.high - middles.low;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const uint32_t middle = from + (to - from) / 2;
    std::nth_element(order_.begin() + from, order_.begin() + middle, order_.begin() + to,
                     [&](uint32_t a, uint32_t b) {
                         const double first = twice_middle(a)[axis];
                         const double second = twice_middle(b)[axis];
                         return first != second ? first < second : a < b;
                     });
    build(from, middle);
    nodes_[at].second = uint32_t(nodes_.size());
    build(middle, to);
}

Vector<const HeightField *> HeightFields::around(const HeightField &field, double reach) const
{
    /* A limit on time and memory: of one, and of all together. An engine of 82 nodes has 697 of
     * one and 0.2 million of all. */
    constexpr size_t MAX_AROUND = 2048, OF_ALL = size_t(1) << 24, MIN_AROUND = 64;
    const size_t most = std::max(MIN_AROUND, std::min(MAX_AROUND, OF_ALL / fields_.size()));
    Vector<uint32_t> ranks; /* many are sorted for each: numbers, not what they stand for */
    any_near(field.box, reach, [&](const HeightField &other) {
        cancel_point();
        if (&other != &field)
            ranks.push_back(rank_[index(other)]);
        return ranks.size() == most;
    });
    std::sort(ranks.begin(), ranks.end());
    Vector<const HeightField *> out;
    out.reserve(ranks.size());
    for (uint32_t rank : ranks)
        out.push_back(&fields_[ranked_[rank]]);
    return out;
}

} // namespace gtx::baking
