/* Decodes the maps of patches again: what a reader sees at a point. */
#include "bake/seam/decoded.hpp"

namespace gtx::baking {

Decoded::Decoded(const PatchMaps &patch, unsigned height_bits)
    : maps(&patch), w(patch.record.rect[2]), h(patch.record.rect[3])
{
    const gtx_patch &r = patch.record;
    const float *from[3] = {r.axis_x, r.axis_y, r.axis_z};
    for (int k = 0; k < 3; ++k)
        axis[k] = {from[k][0], from[k][1], from[k][2]};
    origin = {r.origin[0], r.origin[1], r.origin[2]};
    const double det = dot(cross(axis[0], axis[1]), axis[2]);
    for (int k = 0; k < 3; ++k)
        dual[k] = cross(axis[(k + 1) % 3], axis[(k + 2) % 3]) / det;
    pitch[0] = double(r.extent_x) / w;
    pitch[1] = double(r.extent_y) / h;
    for (int k = 0; k < 2; ++k)
        per_texel_[k] = dual[k] / pitch[k];
    step = r.extent_z / (height_bits == 8 ? 254. : 65534.);
    centre = {r.sphere[0], r.sphere[1], r.sphere[2]};
    radius = r.sphere[3];
}

bool Decoded::field_above(const Vec3d &point, double &above, double &trim) const
{
    const Vec3d from = point - origin;
    const double u = across(0, from), v = across(1, from);
    if (!(u >= 0 && v >= 0 && u < w - 1 && v < h - 1))
        return false;
    const Place place = {at(int(u), int(v)), u - int(u), v - int(v)};
    double code = 0;
    trim = 0;
    for (size_t k = 0; k < 4; ++k) {
        const size_t texel = corner(place, k);
        if (!maps->height[texel])
            return false;
        code += place.weight(k) * maps->height[texel];
        trim += place.weight(k) * (maps->trim[texel] - 128.) / 16;
    }
    above = height(code) - dot(dual[2], from);
    return true;
}

Place Decoded::place_of(const Vec3d &point) const
{
    const Vec3d from = point - origin;
    const double u = across(0, from), v = across(1, from);
    const int i = int(u), j = int(v);
    return {at(i, j), u - i, v - j};
}

Vec3d Decoded::point(const Place &place) const
{
    double code = 0;
    for (size_t k = 0; k < 4; ++k)
        code += place.weight(k) * maps->height[corner(place, k)];
    return point(double(place.cell % size_t(w)) + place.x, double(place.cell / size_t(w)) + place.y,
                 height(code));
}

Vec3d Decoded::normal(const Place &place) const
{
    double code[4];
    for (size_t k = 0; k < 4; ++k)
        code[k] = maps->height[corner(place, k)];
    const double x = place.x, y = place.y;
    const double along_u = (code[1] - code[0]) * (1 - y) + (code[3] - code[2]) * y;
    const double along_v = (code[2] - code[0]) * (1 - x) + (code[3] - code[1]) * x;
    return normalize(cross(axis[0] * pitch[0] + axis[2] * (along_u * step),
                           axis[1] * pitch[1] + axis[2] * (along_v * step)));
}

HeightFields::HeightFields(const std::vector<PatchMaps> &patches, unsigned height_bits)
{
    for (const PatchMaps &patch : patches)
        if (patch.coded)
            fields_.emplace_back(patch, height_bits);
    for (const Decoded &field : fields_) {
        order_.push_back(&field);
        farthest_ = std::max(farthest_, field.radius);
    }
    std::sort(order_.begin(), order_.end(), [](const Decoded *a, const Decoded *b) {
        const double first = along(a->centre), second = along(b->centre);
        return first != second ? first < second : a < b;
    });
}

std::vector<const Decoded *> HeightFields::around(const Decoded &field) const
{
    std::vector<const Decoded *> out;
    any_near(field.centre, field.radius, [&](const Decoded &other) {
        if (&other != &field)
            out.push_back(&other);
        return false;
    });
    return out;
}

} // namespace gtx::baking
