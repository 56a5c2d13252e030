/* The height field of a patch as readers decode it, from its own maps or from an asset's pages. */
#pragma once

#include "asset/patch.h"
#include "bake/field/patch.hpp"
#include "base/bytes.h"

#include <algorithm>

namespace gtx::baking {

/* A place in the map of a patch: the first corner of a cell, and how far beyond it, 0..1. */
struct CellPoint {
    size_t cell;
    double x, y;

    /* Of texel k of 0..3 around it, by rows. */
    double weight(size_t k) const { return (k & 1 ? x : 1 - x) * (k & 2 ? y : 1 - y); }
};

/* Sides along the axes of object space. */
struct Box {
    Vec3d low = Vec3d(INFINITY, INFINITY, INFINITY), high = -low;

    void add(const Vec3d &p)
    {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    /* Whether it comes as near to another, or to a point, as `reach`, along each axis. */
    bool is_near(const Box &other, double reach) const
    {
        return low.x <= other.high.x + reach && high.x >= other.low.x - reach &&
               low.y <= other.high.y + reach && high.y >= other.low.y - reach &&
               low.z <= other.high.z + reach && high.z >= other.low.z - reach;
    }
};

/* Texel (i, j) lies at u = i, v = j, heights along the axis. Points are relative to the anchor. */
class HeightField {
public:
    Vec3d origin, axis[3], dual[3];
    double pitch[2], step;       /* of a texel, and of a code */
    Box box;                     /* around all that its codes can reach */
    int w, h;
    bool two_sided;

    /* The maps stay where they are, but may change. */
    HeightField(const PatchMaps &patch, unsigned height_bits);
    HeightField(const Maps &maps, uint32_t patch);

    /* The first texel of a patch on an asset's pages. */
    static size_t first_texel(const Maps &maps, const gtx_patch &r)
    {
        return (size_t(r.page) * maps.page_height + r.rect[1]) * maps.page_width + r.rect[0];
    }
    size_t at(int i, int j) const { return size_t(j) * row_ + size_t(i); }
    uint32_t code(size_t texel) const
    {
        const uint8_t *at = codes_ + texel * code_bytes_;
        return code_bytes_ == 1 ? *at : gtx_load_own_u16(at);
    }
    uint8_t trim(size_t texel) const { return trim_[texel]; }
    /* Whether the outline nearest to a texel is the model's own border; pages do not tell. */
    bool at_border(size_t texel) const { return ending_ && ending_[texel] == AT_BORDER; }

    Vec3d point(double u, double v, double height) const
    {
        return origin + axis[0] * ((u + 0.5) * pitch[0]) + axis[1] * ((v + 0.5) * pitch[1]) +
               axis[2] * height;
    }
    double height(double code) const { return (code - 1) * step; }
    double texel() const { return std::max(pitch[0], pitch[1]); }
    /* How much a surface of this normal faces the axis: either way, of one that shows on both
     * sides. */
    double facing(const Vec3d &normal) const
    {
        const double cosine = dot(normal, axis[2]);
        return two_sided ? std::abs(cosine) : cosine;
    }
    /* Texels along an axis to a point. */
    double across(int k, const Vec3d &from_origin) const
    {
        return dot(row(k), from_origin) - 0.5;
    }
    const Vec3d &row(int k) const { return per_texel_[k]; }

    /* How far above a point the height field is, along the axis, and the trim there; false where it
     * has no cell. */
    bool field_above(const Vec3d &point, double &above, double &trim) const;
    /* Whether it has cells all over a triangle, trims below `trim` there, and is nowhere deeper
     * below it than that, along the axis. False where the nodes around it do not say so, or are
     * more than `nodes`. */
    bool surely_shows(const Vec3d (&corner)[3], double deeper, double trim, int nodes) const;
    /* Whether the map comes within a texel of the box, along its sides, around two points. */
    bool reaches(const Vec3d &a, const Vec3d &b) const
    {
        const double u[2] = {across(0, a - origin), across(0, b - origin)};
        const double v[2] = {across(1, a - origin), across(1, b - origin)};
        return std::max(u[0], u[1]) > -1 && std::min(u[0], u[1]) < w &&
               std::max(v[0], v[1]) > -1 && std::min(v[0], v[1]) < h;
    }
    /* Where it is in the map, if it has a cell there. */
    CellPoint place_of(const Vec3d &point) const;
    /* Texel k of 0..3 around a place, by rows. */
    size_t corner(const CellPoint &place, size_t k) const
    {
        return place.cell + (k & 1) + (k >> 1) * row_;
    }
    /* The height field at a place of a cell with codes. */
    Vec3d point(const CellPoint &place) const;
    Vec3d normal(const CellPoint &place) const;
    /* From the lowest corner of a cell with codes to its highest. */
    double rise(size_t cell) const
    {
        const auto [low, high] = std::minmax({code(cell), code(cell + 1), code(cell + row_),
                                              code(cell + row_ + 1)});
        return (high - low) * step;
    }

private:
    void decode(const gtx_patch &record, unsigned height_bits);

    Vec3d per_texel_[2];         /* dual, in texels */
    const uint8_t *codes_, *trim_, *ending_ = nullptr;
    size_t code_bytes_, row_;    /* texels from one row to the next */
};

/* Height fields, found by their boxes. */
class HeightFields {
public:
    /* Those of the patches that have codes. */
    HeightFields(const Vector<PatchMaps> &patches, unsigned height_bits);
    HeightFields(const HeightFields &) = delete;
    HeightFields &operator=(const HeightFields &) = delete;

    size_t size() const { return fields_.size(); }
    const HeightField &operator[](size_t i) const { return fields_[i]; }
    size_t index(const HeightField &field) const { return size_t(&field - fields_.data()); }
    /* Whose it is. */
    uint32_t patch(size_t i) const { return patch_[i]; }
    uint32_t patch(const HeightField &field) const { return patch_[index(field)]; }

    /* An order of all: along (1, 1, 1). */
    static bool is_before(const HeightField &a, const HeightField &b)
    {
        auto along = [](const Vec3d &low, const Vec3d &high) {
            return low.x + low.y + low.z + high.x + high.y + high.z;
        };
        const double first = along(a.box.low, a.box.high), second = along(b.box.low, b.box.high);
        return first != second ? first < second : &a < &b;
    }
    /* Calls `visit` with the height fields whose boxes come as near to a box as `reach`, in no
     * particular order, until it returns true; whether it did. */
    template <class Visit> bool any_near(const Box &box, double reach, Visit visit) const;
    template <class Visit> bool any_near(const Vec3d &point, double reach, Visit visit) const
    {
        return any_near(Box{point, point}, reach, visit);
    }
    /* The others that come as near to a height field as `reach`, in order. Of very many some. */
    Vector<const HeightField *> around(const HeightField &field, double reach) const;

private:
    static constexpr size_t LEAF = 4;
    /* The box around those from order_[from] to order_[to - 1]; the first half of them is the next
     * node's, the others that of the one at `second`, 0 in a leaf. */
    struct Node {
        Box box;
        uint32_t from, to, second;
    };
    void build(uint32_t from, uint32_t to);

    Vector<HeightField> fields_;
    Vector<uint32_t> patch_;
    Vector<uint32_t> order_;
    Vector<uint32_t> ranked_, rank_; /* as is_before() orders them; the place of each there */
    Vector<Node> nodes_;
};

template <class Visit>
bool HeightFields::any_near(const Box &box, double reach, Visit visit) const
{
    uint32_t stack[64];
    size_t depth = 0;
    if (!nodes_.empty())
        stack[depth++] = 0;
    while (depth) {
        const uint32_t at = stack[--depth];
        const Node &node = nodes_[at];
        if (!node.box.is_near(box, reach))
            continue;
        if (node.second) {
            stack[depth++] = node.second;
            stack[depth++] = at + 1;
            continue;
        }
        for (uint32_t i = node.from; i < node.to; ++i) {
            const HeightField &field = fields_[order_[i]];
            if (field.box.is_near(box, reach) && visit(field))
                return true;
        }
    }
    return false;
}

} // namespace gtx::baking
