/* Patches for the coarsest LOD mesh of a file, as long as the file's own have not come: triangles
 * of one patch get a frame around them, and a few texels. */
#include "asset/preview.h"

#include "base/alloc.h"

#include <math.h>

enum { SIDE = 4 };                /* texels: corners of few triangles differ no finer */

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = a[i] * b[j] - a[j] * b[i];
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool to_unit(double v[3])
{
    const double size = sqrt(dot(v, v));
    for (int k = 0; k < 3 && size > 0; ++k)
        v[k] /= size;
    return size > 0;
}

static void corner_at(const gtx_lod_mesh *mesh, uint64_t corner, double out[3])
{
    const uint16_t *q = mesh->positions + 3 * (size_t)mesh->indices[corner];
    for (int k = 0; k < 3; ++k)
        out[k] = (double)mesh->origin[k] + (double)mesh->step * q[k];
}

/* Right-handed, with the triangles' mean normal last; any where they have none. */
static void find_axes(const gtx_lod_mesh *mesh, uint32_t first, uint32_t end, double axis[3][3])
{
    double normal[3] = {0};
    for (uint64_t t = first; t < end; ++t) {
        double at[3][3], n[3];
        for (uint32_t c = 0; c < 3; ++c)
            corner_at(mesh, 3 * t + c, at[c]);
        for (int k = 0; k < 3; ++k) {
            at[1][k] -= at[0][k];
            at[2][k] -= at[0][k];
        }
        cross(at[1], at[2], n);
        for (int k = 0; k < 3; ++k)
            normal[k] += n[k];
    }
    if (!to_unit(normal))
        normal[2] = 1;
    double aside[3] = {0};
    aside[fabs(normal[0]) < 0.6 ? 0 : 1] = 1; /* of three components one of the first two is less */
    cross(aside, normal, axis[0]);
    to_unit(axis[0]);
    cross(normal, axis[0], axis[1]);
    for (int k = 0; k < 3; ++k)
        axis[2][k] = normal[k];
}

/* The box around the triangles; a point's where there are none. Flat ones get the depth that a box
 * must have. */
static void lay_frame(gtx_patch *patch, const gtx_lod_mesh *mesh, uint32_t first, uint32_t end)
{
    double axis[3][3], low[3], high[3], longest = mesh->step, origin[3] = {0}, middle[3] = {0};
    find_axes(mesh, first, end, axis);
    for (int a = 0; a < 3; ++a)
        low[a] = high[a] = first < end ? HUGE_VAL : 0;
    for (uint64_t c = 3 * (uint64_t)first; c < 3 * (uint64_t)end; ++c) {
        double at[3];
        corner_at(mesh, c, at);
        for (int a = 0; a < 3; ++a) {
            const double along = dot(axis[a], at);
            low[a] = fmin(low[a], along);
            high[a] = isinf(high[a]) ? along : fmax(high[a], along);
        }
    }
    for (int a = 0; a < 3; ++a)
        longest = fmax(longest, high[a] - low[a]);
    double extent[3], radius = 0;
    for (int a = 0; a < 3; ++a) {
        extent[a] = fmax(high[a] - low[a], longest / 1024);
        radius += extent[a] * extent[a] / 4;
        for (int k = 0; k < 3; ++k) {
            origin[k] += low[a] * axis[a][k];
            middle[k] += (low[a] + extent[a] / 2) * axis[a][k];
        }
    }
    for (int k = 0; k < 3; ++k) {
        patch->origin[k] = (float)origin[k];
        patch->axis_x[k] = (float)axis[0][k];
        patch->axis_y[k] = (float)axis[1][k];
        patch->axis_z[k] = (float)axis[2][k];
        patch->sphere[k] = (float)middle[k];
    }
    patch->extent_x = (float)extent[0];
    patch->extent_y = (float)extent[1];
    patch->extent_z = (float)extent[2];
    patch->sphere[3] = (float)sqrt(radius);
}

static uint32_t columns_of(uint32_t patches)
{
    return (uint32_t)fmax(2, ceil(sqrt(patches))); /* pages have at least 8 texels a side */
}

gtx_info gtx_sketch_info(const gtx_info *info)
{
    gtx_info out = *info;
    const uint32_t columns = columns_of(info->patch_count);
    const uint32_t rows = (info->patch_count + columns - 1) / columns;
    out.page_count = out.mip_count = 1;
    out.page_width = SIDE * columns;
    out.page_height = SIDE * (rows < 2 ? 2 : rows);
    return out;
}

bool gtx_sketch_patches(gtx_asset *asset)
{
    const uint32_t count = asset->info.patch_count, columns = columns_of(count);
    gtx_lod_mesh mesh;
    gtx_get_lod_mesh(asset, 0, &mesh);
    asset->patches = gtx_alloc_array(&asset->allocator, count, sizeof *asset->patches);
    for (uint32_t i = 0; i < count && asset->patches; ++i) {
        gtx_patch *patch = &asset->patches[i];
        *patch = (gtx_patch){.rect = {0, 0, SIDE, SIDE},
                             .flags = GTX_PATCH_TWO_SIDED}; /* as any of the file's may be */
        patch->rect[0] = (uint16_t)(i % columns * SIDE);
        patch->rect[1] = (uint16_t)(i / columns * SIDE);
        lay_frame(patch, &mesh, mesh.first[i], mesh.first[i + 1]);
    }
    return asset->patches != NULL;
}
