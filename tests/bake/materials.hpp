/* Meshes with materials and textures. */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "asset/asset.h"
#include "bake/shapes.hpp"
#include "mesh/material/texture.hpp"

#include <cstring>
#include <memory>

using namespace gtx;

inline Maps bake_with(const Mesh &mesh, Partition partition, BakeOptions options = {},
                      unsigned threads = 1)
{
    Task task(threads, nullptr, nullptr, {"bake", "pack"});
    return bake(mesh, partition, options, task);
}

/* A flat height field over the unit square, seen from above in `resolution` texels; texture
 * coordinates are the square's. */
struct HeightField {
    Mesh mesh;
    Partition partition;

    HeightField(unsigned squares, unsigned resolution, size_t materials = 1)
    {
        mesh = shapes::field(squares, [](double u, double v) { return Vec3d(u, v, 0); });
        Appearance &look = mesh.appearance;
        look.materials.resize(materials);
        look.material.assign(mesh.triangle_count(), 0);
        for (const auto &triangle : mesh.triangles)
            for (uint32_t v : triangle)
                look.uv[0].push_back({float(mesh.positions[v].x), float(mesh.positions[v].y)});
        divide(resolution, shapes::all_in_one());
    }
    void divide(unsigned resolution, const std::function<int(size_t)> &key)
    {
        partition = shapes::split(mesh, key, resolution);
        for (Chart &chart : partition.charts)
            chart.frame = shapes::frame_along(mesh, chart.triangles, {0, 0, 1});
        partition.pitch = 1. / resolution;
    }
    Vec3d middle(size_t t) const
    {
        return (mesh.position(t, 0) + mesh.position(t, 1) + mesh.position(t, 2)) / 3;
    }
    /* A texture of size x size texels; texel(x, y) for x and y in 0..1. */
    Texture paint(uint32_t size, Texels kind, const std::function<Rgba8(double, double)> &texel)
    {
        Vector<Rgba8> texels;
        for (uint32_t j = 0; j < size; ++j)
            for (uint32_t i = 0; i < size; ++i)
                texels.push_back(texel((i + 0.5) / size, (j + 0.5) / size));
        mesh.appearance.images.push_back(make_image(size, size, std::move(texels), kind));
        Texture texture;
        texture.image = uint32_t(mesh.appearance.images.size() - 1);
        texture.wrap[0] = texture.wrap[1] = Wrap::CLAMP;
        return texture;
    }
    /* Cuts away where there(x, y) is false, with colours to tell the two apart. */
    void mask(uint32_t size, const std::function<bool(double, double)> &there)
    {
        Material &m = mesh.appearance.materials[0];
        m.alpha_cutoff = 0.5f;
        m.color_map = paint(size, Texels::COLOR, [&](double x, double y) {
            return there(x, y) ? Rgba8{255, 0, 0, 255} : Rgba8{0, 255, 0, 0};
        });
    }
};

/* Calls visit(x, y, index of the texel in the maps, whether it has a code) for the texels of all
 * rectangles, at their places on the height field. */
template <class Visit> static void each_texel(const Maps &maps, Visit visit)
{
    for (const gtx_patch &p : maps.patches) {
        for (unsigned j = 0; j < p.rect[3]; ++j) {
            for (unsigned i = 0; i < p.rect[2]; ++i) {
                size_t at = (size_t(p.page) * maps.page_height + p.rect[1] + j) * maps.page_width +
                            p.rect[0] + i;
                double a = (i + 0.5) / p.rect[2] * p.extent_x;
                double b = (j + 0.5) / p.rect[3] * p.extent_y;
                double x = maps.anchor[0] + p.origin[0] + a * p.axis_x[0] + b * p.axis_y[0];
                double y = maps.anchor[1] + p.origin[1] + a * p.axis_x[1] + b * p.axis_y[1];
                visit(x, y, at, maps.height[at] != 0);
            }
        }
    }
}
