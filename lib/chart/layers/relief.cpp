/* One height map from each side of the model's box: what no side sees is lost.
 *
 * A triangle belongs to the side that sees most of it, and sees it least slanted, so the six maps
 * do not repeat each other as the originals do (Oliveira, Bishop, McAllister, SIGGRAPH 2000;
 * Baboud, Decoret, GI 2006); beyond their borders they overlap as other charts do. The views are
 * parallel: a patch is a parallelepiped, and no frustum has one frame for all of its rays. */
#include "chart/layers/peel.hpp"

namespace gtx {

namespace {

/* Least cosine between a triangle and the direction that it is seen along, and least share of it
 * that is seen. Not tuned. */
constexpr double MIN_FACING = 0.15, MIN_SEEN = 0.25;
/* Texels that surface may lie behind what is in front of it and yet be the same. */
constexpr double SAME_DEPTH = 1;
/* Where a triangle is looked at: its centre, and near its corners. */
constexpr double SAMPLES[4][3] = {
    {1. / 3, 1. / 3, 1. / 3}, {0.8, 0.1, 0.1}, {0.1, 0.8, 0.1}, {0.1, 0.1, 0.8}};

/* What is in front, along one direction. */
class View {
public:
    View(const Surface &surface, const Vec3d &z, double pitch, Task &task)
        : surface_(surface), pitch_(pitch), frame_(plain_frame(surface, z)), inverse_(frame_),
          grid_(make_layer_grid(surface, surface.whole, frame_, pitch, task))
    {
    }

    /* Which share of a triangle is seen, times its cosine; 0 where that is too little. */
    double sees(uint32_t t) const
    {
        const double facing = dot(Vec3d(surface_.normal[t]), frame_.z);
        if (facing < MIN_FACING)
            return 0;
        const double behind = pitch_ * (SAME_DEPTH + 1 / facing);
        double seen = 0;
        for (const double *weight : SAMPLES) {
            Vec3d p;
            for (int k = 0; k < 3; ++k)
                p += inverse_(surface_.mesh.position(t, k)) * weight[k];
            const LayerGrid::Sample *s =
                grid_.at(int(std::floor(p.x / pitch_)), int(std::floor(p.y / pitch_)));
            seen += !s || !(double(s->high) > p.z + behind) ? 0.25 : 0;
        }
        return seen >= MIN_SEEN ? seen * facing : 0;
    }

private:
    /* Its grid counts texels from the origin. */
    static Frame plain_frame(const Surface &surface, const Vec3d &z)
    {
        Frame frame;
        frame.origin = surface.mesh.positions[0];
        frame.x = any_perpendicular(z);
        frame.y = cross(z, frame.x);
        frame.z = z;
        return frame;
    }

    const Surface &surface_;
    const double pitch_;
    const Frame frame_;
    const FrameInverse inverse_;
    const LayerGrid grid_;
};

double longest_side(const Mesh &mesh)
{
    Vec3d low = mesh.positions[0], high = low;
    for (const Vec3d &p : mesh.positions)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

} // namespace

Vector<uint32_t> see_from_sides(const Surface &surface, unsigned resolution, Task &task)
{
    const Vector<Vec3d> sides = object_directions();
    const double pitch = longest_side(surface.mesh) / resolution;
    Vector<uint32_t> label(surface.facets.size(), uint32_t(sides.size()));
    Vector<double> best(label.size());
    for (uint32_t side = 0; side < sides.size(); ++side) {
        const View view(surface, sides[side], pitch, task);
        for (uint32_t t = 0; t < label.size(); ++t) {
            cancel_point();
            const double sees = view.sees(t);
            if (sees > best[t]) {
                best[t] = sees;
                label[t] = side;
            }
        }
        task.advance(0.7 * (side + 1) / double(sides.size()));
    }
    return label;
}

} // namespace gtx
