/* The inside of LOD meshes from maps: the height fields of an asset, each cut back to what is its
 * own. */
#pragma once

#include "bake/height_field.hpp"
#include "bake/lod/fan.hpp"
#include "bake/lod/parts.hpp"

namespace gtx::baking {

/* A height field with the normals of its pages, by which it claims what lies near it. */
class MapField : public HeightField {
public:
    MapField(const Maps &maps, uint32_t patch);

    /* Least distance between texels, object units. */
    double fine_texel() const { return fine_texel_; }
    Vec3d texel_point(int i, int j) const { return place(i, j, share(code(at(i, j)))); }
    Vec3d normal(size_t texel) const;
    /* Texels outside the outline at a point with this normal that the height field passes; infinity
     * where it does not. */
    double trim_at(const Vec3d &point, const Vec3d &facing) const;
    /* What a height field loses of its claim, in texels, where it is steep. */
    double steepness(const Vec3d &facing) const;

    Vec3d low, high; /* box around the patch */

private:
    /* Points by whole texels, and heights as shares of the extent: regular grids have many equal
     * costs, and another order of roundings would break the ties of their LOD meshes elsewhere. */
    Vec3d place(int i, int j, double height) const
    {
        return first_ + texel_[0] * i + texel_[1] * j + z_ * height;
    }
    double share(double code) const { return gtx_code_height(code, height_bits_); }
    double trim_in_cell(int i, int j, const Vec3d &at, const Vec3d &facing) const;

    unsigned height_bits_;
    Vec3d first_, texel_[2], z_; /* texel (0, 0), one to the side, and the greatest height */
    Vec3d row_[3];               /* the way back */
    Vec3d frame_[3];             /* of normals */
    double fine_texel_, reach_;  /* object units that a height field may pass a point by */
    const uint8_t *normals_;
};

Vector<MapField> map_fields(const Maps &maps);

/* For each patch those, in ascending order, whose boxes touch its own. */
Vector<Vector<uint32_t>> touching(const Vector<MapField> &fields);

/* What of a height field lies deeper inside its own outline than inside any other patch's. */
struct FieldPiece {
    Vector<Vec3d> positions, normals;
    Vector<Triangle> triangles;
    Vector<uint8_t> at_border;      /* of a vertex: the piece ends there */
};
FieldPiece cut_field(const Vector<MapField> &fields, uint32_t patch,
                     const Vector<uint32_t> &others);

/* Joins pieces, one a patch, where they meet. */
LodSource weld(const Vector<MapField> &fields, Vector<FieldPiece> pieces,
               const Vector<Vector<uint32_t>> &others);

} // namespace gtx::baking
