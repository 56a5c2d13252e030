/* Charts of simple shapes, baked. */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "asset/asset.h"
#include "asset/patch.h"
#include "bake/shapes.hpp"

#include <cstring>

using namespace gtx;
using shapes::describe;

inline Maps bake_with(const Mesh &mesh, Partition partition, BakeOptions options = {},
                      unsigned threads = 1)
{
    Task task(threads, nullptr, nullptr, {"bake", "pack"});
    return bake(mesh, partition, options, task);
}

/* gtx_create checks every rule of the format. */
inline gtx_asset *create(const Maps &maps)
{
    Vector<const uint8_t *> levels;
    gtx_asset_desc desc = describe(maps, levels);
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    if (gtx_create(&desc, &asset, &error))
        fail_msg("%s (rule %u)", error.message, error.rule);
    return asset;
}

inline Maps bake_valid(const Mesh &mesh, Partition partition, BakeOptions options = {})
{
    Maps maps = bake_with(mesh, partition, options);
    gtx_close(create(maps));
    return maps;
}

inline Vec3d point_of(const Maps &maps, const gtx_patch &p, unsigned i, unsigned j, unsigned code)
{
    double a = (i + 0.5) / p.rect[2] * p.extent_x, b = (j + 0.5) / p.rect[3] * p.extent_y;
    double c = gtx_code_height(code, maps.height_bits) * p.extent_z;
    Vec3d point;
    for (int k = 0; k < 3; ++k)
        point[k] = maps.anchor[k] + p.origin[k] + a * p.axis_x[k] + b * p.axis_y[k] +
                   c * p.axis_z[k];
    return point;
}

/* Calls visit(patch, point, trim in texels) for each coded texel. */
template <class Visit> static void each_texel(const Maps &maps, Visit visit)
{
    for (const gtx_patch &p : maps.patches) {
        for (unsigned j = 0; j < p.rect[3]; ++j) {
            for (unsigned i = 0; i < p.rect[2]; ++i) {
                size_t at = (size_t(p.page) * maps.page_height + p.rect[1] + j) * maps.page_width +
                            p.rect[0] + i;
                unsigned code = maps.height_bits == 8
                                    ? maps.height[at]
                                    : maps.height[2 * at] | maps.height[2 * at + 1] << 8;
                if (code)
                    visit(p, point_of(maps, p, i, j, code), (maps.trim[at] - 128) / 16., at);
            }
        }
    }
}
