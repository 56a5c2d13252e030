/* The height fields of patches as a reader decodes them. */
#pragma once

#include "bake/field/patch.hpp"

#include <algorithm>

namespace gtx::baking {

/* A place in the map of a patch: the first corner of a cell, and how far beyond it, 0..1. */
struct Place {
    size_t cell;
    double x, y;

    /* Of texel k of 0..3 around it, by rows. */
    double weight(size_t k) const { return (k & 1 ? x : 1 - x) * (k & 2 ? y : 1 - y); }
};

/* Texel (i, j) lies at u = i, v = j, heights along the axis. Points are relative to the anchor. */
struct Decoded {
    const PatchMaps *maps;
    Vec3d origin, axis[3], dual[3];
    double pitch[2], step;       /* of a texel, and of a code */
    Vec3d centre;                /* of its sphere */
    double radius;
    int w, h;

    Decoded(const PatchMaps &patch, unsigned height_bits);
    Vec3d point(double u, double v, double height) const
    {
        return origin + axis[0] * ((u + 0.5) * pitch[0]) + axis[1] * ((v + 0.5) * pitch[1]) +
               axis[2] * height;
    }
    size_t at(int i, int j) const { return size_t(j) * size_t(w) + size_t(i); }
    double height(double code) const { return (code - 1) * step; }
    double texel() const { return std::max(pitch[0], pitch[1]); }

    /* How far above a point the height field is, along the axis, and the trim there; false where it
     * has no cell. */
    bool field_above(const Vec3d &point, double &above, double &trim) const;
    /* Whether the map comes within a texel of the box, along its sides, around two points. */
    bool reaches(const Vec3d &a, const Vec3d &b) const
    {
        const double u[2] = {across(0, a - origin), across(0, b - origin)};
        const double v[2] = {across(1, a - origin), across(1, b - origin)};
        return std::max(u[0], u[1]) > -1 && std::min(u[0], u[1]) < w &&
               std::max(v[0], v[1]) > -1 && std::min(v[0], v[1]) < h;
    }
    /* Where it is in the map, if it has a cell there. */
    Place place_of(const Vec3d &point) const;
    /* Texel k of 0..3 around a place, by rows. */
    size_t corner(const Place &place, size_t k) const
    {
        return place.cell + (k & 1) + (k >> 1) * size_t(w);
    }
    /* The height field at a place of a cell with codes. */
    Vec3d point(const Place &place) const;
    Vec3d normal(const Place &place) const;

private:
    Vec3d per_texel_[2];         /* dual, in texels */

    /* Texels along an axis. */
    double across(int k, const Vec3d &from_origin) const
    {
        return dot(per_texel_[k], from_origin) - 0.5;
    }
};

/* Height fields, found by their spheres. */
class HeightFields {
public:
    /* Those of the patches that have codes. */
    HeightFields(const std::vector<PatchMaps> &patches, unsigned height_bits);
    HeightFields(const HeightFields &) = delete;
    HeightFields &operator=(const HeightFields &) = delete;

    size_t size() const { return fields_.size(); }
    const Decoded &operator[](size_t i) const { return fields_[i]; }
    size_t index(const Decoded &field) const { return size_t(&field - fields_.data()); }

    /* Calls `visit` with every height field whose sphere comes as near to a point as `reach`, until
     * it returns true; whether it did. */
    template <class Visit> bool any_near(const Vec3d &point, double reach, Visit visit) const
    {
        const double far = DIAGONAL * (farthest_ + reach), place = along(point);
        auto at = std::lower_bound(order_.begin(), order_.end(), place - far,
                                   [](const Decoded *a, double b) { return along(a->centre) < b; });
        for (; at != order_.end() && along((*at)->centre) <= place + far; ++at)
            if (length(point - (*at)->centre) <= (*at)->radius + reach && visit(**at))
                return true;
        return false;
    }
    /* The others whose spheres that of a height field meets. */
    std::vector<const Decoded *> around(const Decoded &field) const;

private:
    /* They are sorted along (1, 1, 1), whose length this is. */
    static constexpr double DIAGONAL = 1.7320508075688772;
    static double along(const Vec3d &point) { return point.x + point.y + point.z; }

    std::vector<Decoded> fields_;
    std::vector<const Decoded *> order_;
    double farthest_ = 0; /* the largest radius */
};

} // namespace gtx::baking
