/* The views of a comparison, and images of the source in them. */
#pragma once

#include "mesh/mesh.hpp"

#include <limits>

namespace gtx {

constexpr uint32_t NO_HIT = 0xffffffffu;

/* The box and sphere of a mesh that fix the scale of its measures. */
struct Extent {
    Vec3d centre;                /* of the bounding box */
    double radius = 0;           /* from there to the farthest vertex */
    double diagonal = 0;         /* of the bounding box */
};
Extent extent_of(const Mesh &mesh);

/* An orthographic camera. Depth is the distance from the image plane, which lies two radii from
 * the centre, so that all of an asset is in front of it. */
struct View {
    Vec3d toward, right, up;     /* unit vectors; `toward` points to the eye */
    Vec3d middle;                /* of the image plane */
    double pixel = 1;            /* its side */
    uint32_t size = 0;           /* pixels along a side of the image */
    bool culls = false;          /* backs of triangles, but two-sided ones: sight passes them */

    /* The centre of a pixel on the image plane; rows go down. */
    Vec3d at(uint32_t i, uint32_t j) const
    {
        return middle + right * ((i + 0.5 - 0.5 * size) * pixel) +
               up * ((0.5 * size - j - 0.5) * pixel);
    }
    /* Pixel coordinates and depth of a point. */
    Vec3d project(const Vec3d &p) const
    {
        Vec3d d = p - middle;
        return {0.5 * size + dot(d, right) / pixel, 0.5 * size - dot(d, up) / pixel,
                -dot(d, toward)};
    }
};

/* The 26 directions (normalised non-zero {-1, 0, 1}^3, x fastest), up +Y, or +Z when parallel; the
 * sphere of the extent is inscribed in 96 % of size x size pixels. Then `random` more, spread
 * evenly over the sphere, the same ones for a seed. */
Vector<View> comparison_views(const Extent &extent, uint32_t size, uint32_t random = 0,
                              uint32_t seed = 0);

/* Whether a triangle's material cuts it away at a point; `footprint` as in sample_surface. */
bool is_cut(const Mesh &mesh, size_t triangle, const double weight[3], double footprint);

/* The nearest fragment at every pixel centre. What a mask cuts away is no surface. */
struct MeshImage {
    Vector<float> depth;            /* infinity where nothing is */
    Vector<uint32_t> triangle;      /* NO_HIT where nothing is */
    Vector<uint8_t> front;          /* 1: seen from the front, or two-sided */
};
MeshImage rasterise(const Mesh &mesh, const View &view);

/* The square that a pixel's centre and those of its neighbours span, so many times finer:
 * CLOSE_SIDE x CLOSE_SIDE fragments for each of these pixels, without triangles that lie all
 * deeper than a pixel asks for. */
constexpr uint32_t CLOSER = 8, CLOSE_SIDE = 2 * CLOSER + 1;
struct ClosePixel {
    uint32_t i, j;
    double deepest;
};
/* The view that such an image of a pixel is. */
View close_view(const View &view, uint32_t i, uint32_t j);
Vector<MeshImage> rasterise_close(const Mesh &mesh, const View &view,
                                  const Vector<ClosePixel> &pixels);

/* Normal (unit, towards the eye's side) and colour of the source where pixel (i, j) shows it: those
 * of its materials, textures included, else those of its corners. */
struct Fragment {
    Vec3d normal;
    double color[3];             /* sRGB, 0..255 */
};
Fragment fragment_at(const Mesh &mesh, const View &view, const MeshImage &image, uint32_t i,
                     uint32_t j);

} // namespace gtx
