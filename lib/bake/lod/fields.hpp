/* The inside of LOD meshes from maps: the height fields of an asset, each cut back to what is its
 * own. */
#pragma once

#include "bake/lod/fan.hpp"
#include "bake/lod/parts.hpp"

namespace gtx::baking {

/* The height field of a patch, as its maps tell it. Texel (i, j) lies at u = i, v = j. */
class MapField {
public:
    MapField(const Maps &maps, uint32_t patch);

    int w() const { return w_; }
    int h() const { return h_; }
    /* Least distance between texels, object units. */
    double pitch() const { return pitch_; }
    uint32_t code(int i, int j) const;
    double trim(int i, int j) const; /* texels outside the outline */
    /* The same at a point with this normal that the height field passes; infinity where it does
     * not. */
    double trim(const Vec3d &point, const Vec3d &normal) const;
    Vec3d point(int i, int j) const;
    Vec3d normal(int i, int j) const;
    /* What a height field loses of its claim, in texels, where it is steep. */
    double steepness(const Vec3d &normal) const;

    Vec3d low, high; /* box around the patch */

private:
    double trim_in_cell(int i, int j, const Vec3d &at, const Vec3d &facing) const;

    const Maps &maps_;
    Vec3d origin_, texel_[2], z_; /* one texel to the side, and the greatest height */
    Vec3d row_[3];                /* the way back */
    double frame_[3][3];          /* of normals */
    double pitch_, reach_;        /* object units that a height field may pass a point by */
    size_t first_;                /* texel of the maps */
    int w_, h_;
};

std::vector<MapField> map_fields(const Maps &maps, Task &task);

/* For each patch those, in ascending order, whose boxes touch its own. */
std::vector<std::vector<uint32_t>> touching(const std::vector<MapField> &fields);

/* What of a height field lies deeper inside its own outline than inside any other patch's. */
struct FieldPiece {
    std::vector<Vec3d> positions, normals;
    std::vector<Triangle> triangles;
    std::vector<uint8_t> at_border; /* of a vertex: the piece ends there */
};
FieldPiece cut_field(const std::vector<MapField> &fields, uint32_t patch,
                     const std::vector<uint32_t> &others);

/* Joins pieces, one a patch, where they meet. */
LodSource weld(const std::vector<MapField> &fields, std::vector<FieldPiece> pieces,
               const std::vector<std::vector<uint32_t>> &others);

} // namespace gtx::baking
