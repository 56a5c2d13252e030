/* A textured square, and what is shown at a point of it. */
#pragma once

#include "test_import.hpp"

#include "mesh/material/srgb.hpp"
#include "mesh/material/texture.hpp"

using gtx::Image;
using gtx::Material;
using gtx::SurfaceSample;
using gtx::Texels;
using gtx::Texture;
using gtx::Wrap;

/* The square from 0 to `side` in the xy plane, facing +z, as two triangles. Both sets of texture
 * coordinates run from 0 to 1 along x and, downwards, along y. */
inline Mesh square(double side = 1)
{
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const float uv[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    for (const auto &t : mesh.triangles)
        for (uint32_t v : t) {
            mesh.normals.push_back({0, 0, 1});
            for (auto &set : mesh.appearance.uv)
                set.push_back({uv[v][0], uv[v][1]});
        }
    mesh.appearance.materials.resize(1);
    mesh.appearance.material = {0, 0};
    return mesh;
}

inline Material &material(Mesh &mesh)
{
    return mesh.appearance.materials[0];
}

inline Texture add_image(Mesh &mesh, Image image)
{
    Texture texture;
    texture.image = uint32_t(mesh.appearance.images.size());
    mesh.appearance.images.push_back(std::move(image));
    return texture;
}

/* Of one colour. */
inline Texture add_plain(Mesh &mesh, const Rgba8 &c, Texels kind = Texels::DATA)
{
    return add_image(mesh, gtx::make_image(1, 1, {c}, kind));
}

/* Where texture coordinates are (u, v), in the lower right triangle for u + v > 1. */
inline SurfaceSample look(const Mesh &mesh, double u, double v, double footprint = 0)
{
    const bool lower = u + v >= 1; /* its corners: (0,1) (1,1) (1,0); else (0,1) (1,0) (0,0) */
    const float lower_weights[3] = {float(1 - u), float(u + v - 1), float(1 - v)};
    const float upper_weights[3] = {float(v), float(u), float(1 - u - v)};
    return gtx::sample_surface(mesh, lower ? 0 : 1, lower ? lower_weights : upper_weights,
                               footprint);
}

inline void assert_values(const float *found, std::initializer_list<double> expected)
{
    size_t k = 0;
    for (double e : expected) {
        if (!(std::abs(found[k] - e) < 2e-3))
            fail_msg("value %zu is %g, not %g", k, found[k], e);
        ++k;
    }
}

/* 4 x 4 texels whose three levels are 0, 100 and 200. */
inline Image leveled()
{
    Image image;
    for (uint32_t k = 0; k < 3; ++k) {
        uint8_t c = uint8_t(100 * k);
        gtx::Vector<Rgba8> texels(16u >> 2 * k, Rgba8{c, c, c, c});
        image.levels.push_back({4u >> k, 4u >> k, texels});
    }
    return image;
}
