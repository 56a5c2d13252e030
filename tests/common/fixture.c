/* Small assets made in memory: height fields are sampled, packed one under another and created. */
#include "common/fixture.h"

#include "asset/asset.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *zeroed(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);
    if (!memory)
        abort();
    return memory;
}

static void put_normal(const gtx_patch *patch, const double normal[3], uint8_t *out)
{
    float rows[3][3], n[3];
    gtx_normal_frame(patch, rows);
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int r = 0; r < 3; ++r) {
        n[r] = 0;
        for (int k = 0; k < 3; ++k)
            n[r] += (float)(rows[r][k] * normal[k] / length);
    }
    n[2] = n[2] > 0 ? n[2] : 0;
    length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int r = 0; r < 3; ++r)
        n[r] = (float)(n[r] / length);
    gtx_encode_normal(n, out);
}

/* The maps of one asset while it is made. */
typedef struct maps {
    gtx_asset_desc desc;
    uint8_t *height, *trim, *normal[GTX_MAX_MIPS], *color[GTX_MAX_MIPS];
} maps;

static void sample_level(maps *m, const fixture_patch *from, const gtx_patch *patch, uint32_t level)
{
    uint32_t page_width = m->desc.page_width >> level, step = 1u << level;
    for (uint32_t j = 0; j < patch->rect[3] / step; ++j)
        for (uint32_t i = 0; i < patch->rect[2] / step; ++i) {
            fixture_texel texel = {.normal = {0, 0, 1}, .color = {200, 200, 200, 255}};
            double x = (i + 0.5) * step - 0.5, y = (j + 0.5) * step - 0.5;
            from->field(patch, x, y, from->user, &texel);
            size_t at = (size_t)(patch->rect[1] / step + j) * page_width +
                        patch->rect[0] / step + i;
            put_normal(patch, texel.normal, m->normal[level] + 2 * at);
            memcpy(m->color[level] + 4 * at, texel.color, 4);
            if (level)
                continue;
            m->trim[at] = gtx_nearest_trim((float)texel.trim);
            double steps = texel.height * gtx_height_steps(m->desc.height_bits);
            uint32_t code = texel.height < 0 ? 0 : gtx_nearest_code(steps, m->desc.height_bits);
            if (m->desc.height_bits == 8)
                m->height[at] = (uint8_t)code;
            else
                gtx_store_own_u16(m->height + 2 * at, code);
        }
}

/* Coverage and sphere of the patch, and its part of the asset's bounds. */
static void finish_patch(maps *m, gtx_patch *patch)
{
    const size_t first = (size_t)patch->rect[1] * m->desc.page_width;
    const size_t bytes = m->desc.height_bits / 8;
    const gtx_code_map codes = {m->height + first * bytes, m->desc.page_width, (uint32_t)bytes,
                                m->desc.height_bits};
    const gtx_patch_span span = gtx_measure_patch(patch, &codes);
    patch->sphere[3] = fmaxf(patch->sphere[3], 1e-3f);
    for (int k = 0; k < 3; ++k) {
        m->desc.bounds_min[k] = fminf(m->desc.bounds_min[k], (float)span.low[k]);
        m->desc.bounds_max[k] = fmaxf(m->desc.bounds_max[k], (float)span.high[k]);
    }
}

/* One under another on a page as wide as the widest. */
static gtx_patch *pack(const fixture_patch *from, uint32_t count, maps *m)
{
    gtx_patch *patches = zeroed(count, sizeof *patches);
    for (uint32_t i = 0; i < count; ++i) {
        patches[i] = from[i].frame;
        patches[i].page = 0;
        patches[i].rect[0] = 0;
        patches[i].rect[1] = (uint16_t)m->desc.page_height;
        m->desc.page_height += patches[i].rect[3];
        if (patches[i].rect[2] > m->desc.page_width)
            m->desc.page_width = patches[i].rect[2];
    }
    uint32_t step = m->desc.mip_count > 4 ? 1u << (m->desc.mip_count - 1) : 8;
    m->desc.page_width = (m->desc.page_width + step - 1) / step * step;
    m->desc.page_height = (m->desc.page_height + step - 1) / step * step;
    return patches;
}

gtx_asset *fixture_build_with(const fixture_patch *from, uint32_t count, uint32_t height_bits,
                              uint32_t mips, const gtx_allocator *allocator)
{
    maps m = {.desc = {.patch_count = count, .page_count = 1, .mip_count = mips,
                       .height_bits = height_bits, .allocator = allocator,
                       .bounds_min = {INFINITY, INFINITY, INFINITY},
                       .bounds_max = {-INFINITY, -INFINITY, -INFINITY}}};
    gtx_patch *patches = pack(from, count, &m);
    size_t texels = (size_t)m.desc.page_width * m.desc.page_height;
    m.height = zeroed(texels, height_bits / 8);
    m.trim = zeroed(texels, 1);
    for (uint32_t level = 0; level < mips; ++level) {
        m.normal[level] = zeroed(texels >> 2 * level, 2);
        m.color[level] = zeroed(texels >> 2 * level, 4);
        for (uint32_t i = 0; i < count; ++i)
            sample_level(&m, &from[i], &patches[i], level);
    }
    for (uint32_t i = 0; i < count; ++i)
        finish_patch(&m, &patches[i]);
    if (m.desc.bounds_min[0] > m.desc.bounds_max[0]) /* no coded texel at all */
        for (int k = 0; k < 3; ++k)
            m.desc.bounds_min[k] = m.desc.bounds_max[k] = 0;

    m.desc.patches = patches;
    m.desc.height = m.height;
    m.desc.trim = m.trim;
    m.desc.normal = (const uint8_t *const *)m.normal;
    m.desc.color = (const uint8_t *const *)m.color;
    gtx_asset *asset = NULL;
    gtx_error error = {0};
    if (gtx_create(&m.desc, &asset, &error)) {
        fprintf(stderr, "fixture: %s (rule %u)\n", error.message, error.rule);
        abort();
    }
    free(patches);
    free(m.height);
    free(m.trim);
    for (uint32_t level = 0; level < mips; ++level) {
        free(m.normal[level]);
        free(m.color[level]);
    }
    return asset;
}

gtx_asset *fixture_build(const fixture_patch *patches, uint32_t count, uint32_t height_bits,
                         uint32_t mips)
{
    return fixture_build_with(patches, count, height_bits, mips, NULL);
}

gtx_patch fixture_frame(const double corner[3], uint32_t width, uint32_t height, double pitch,
                        double depth)
{
    return (gtx_patch){
        .origin = {(float)(corner[0] - pitch / 2), (float)(corner[1] - pitch / 2),
                   (float)corner[2]},
        .extent_x = (float)(width * pitch), .axis_x = {1, 0, 0},
        .extent_y = (float)(height * pitch), .axis_y = {0, 1, 0},
        .extent_z = (float)depth, .axis_z = {0, 0, 1},
        .rect = {0, 0, (uint16_t)width, (uint16_t)height}};
}

static void flat_field(const gtx_patch *patch, double x, double y, const void *user,
                       fixture_texel *out)
{
    (void)patch;
    (void)x;
    (void)y;
    out->height = *(const double *)user;
    out->trim = -7;
}

gtx_asset *fixture_flat(double z, uint32_t height_bits)
{
    const double corner[3] = {0, 0, 0};
    fixture_patch patch = {fixture_frame(corner, 32, 24, 0.125, 1), flat_field, &z};
    return fixture_build(&patch, 1, height_bits, 4);
}

/* Distance in texels to an outline that wobbles around an ellipse and to two holes in it. */
static void bumpy_field(const gtx_patch *patch, double x, double y, const void *user,
                        fixture_texel *out)
{
    (void)user;
    double cx = x - 0.5 * (patch->rect[2] - 1), cy = y - 0.5 * (patch->rect[3] - 1);
    double angle = atan2(cy, cx), reach = 0.46 + 0.05 * sin(5 * angle) - 0.02 * cos(11 * angle);
    double outline = hypot(cx, cy * 4 / 3) - reach * patch->rect[2];
    double holes = fmax(5 - hypot(cx - 12, cy - 3), 3.2 - hypot(cx + 15, cy + 6));
    out->trim = fmax(outline, holes);
    double bumps = 0.5 + 0.22 * sin(0.31 * x + 0.1 * y) * cos(0.27 * y) + 0.2 * sin(0.9 * x) *
                   sin(0.7 * y + 1) + 0.004 * x * sin(0.05 * y);
    out->height = out->trim > 1.6 ? -1 : fmin(fmax(bumps, 0), 1);
    for (int k = 0; k < 3; ++k)
        out->normal[k] = patch->axis_z[k] + 0.2 * sin(x * 0.4) * patch->axis_x[k];
    out->color[0] = (uint8_t)(128 + 100 * sin(0.5 * x));
    out->color[1] = (uint8_t)(128 + 100 * sin(0.5 * y));
}

gtx_asset *fixture_bumpy(uint32_t height_bits, uint16_t flags)
{
    fixture_patch patch = {
        {.origin = {-3, 1, 2}, .extent_x = 4, .axis_x = {0.8f, 0.6f, 0},
         .extent_y = 3, .axis_y = {-0.48f, 0.64f, 0.6f},
         .extent_z = 1.2f, .axis_z = {0.6f, 0, 0.8f}, .rect = {0, 0, 64, 48}, .flags = flags},
        bumpy_field, NULL};
    return fixture_build(&patch, 1, height_bits, 4);
}

/* The side of a sphere where the frame's z is the longest coordinate is bounded by the ellipses
 * 2 x^2 + y^2 = r^2 and x^2 + 2 y^2 = r^2; distances to them are to first order. */
static void sphere_field(const gtx_patch *patch, double x, double y, const void *user,
                         fixture_texel *out)
{
    const double radius = *(const double *)user, pitch = patch->extent_x / patch->rect[2];
    double a = (x - 0.5 * (patch->rect[2] - 1)) * pitch;
    double b = (y - 0.5 * (patch->rect[3] - 1)) * pitch;
    double across = (2 * a * a + b * b - radius * radius) / (2 * hypot(2 * a, b) + 1e-9);
    double along = (a * a + 2 * b * b - radius * radius) / (2 * hypot(a, 2 * b) + 1e-9);
    double rim = 0.97 * radius, square = fmin(a * a + b * b, rim * rim);
    double z = sqrt(radius * radius - square), low = 0.2 * radius;
    out->trim = fmax(across, along) / pitch - 1.5;
    out->height = out->trim > 1.6 || square == rim * rim ? -1 : (z - low) / patch->extent_z;
    for (int k = 0; k < 3; ++k) {
        out->normal[k] = a * patch->axis_x[k] + b * patch->axis_y[k] + z * patch->axis_z[k];
        out->color[k] = (uint8_t)(128 + 120 * out->normal[k] / radius);
    }
}

gtx_asset *fixture_sphere_without(double radius, uint32_t texels, uint32_t height_bits,
                                  uint32_t faces)
{
    fixture_patch patches[6];
    uint32_t count = 0;
    double pitch = 1.4142135623730951 * radius / (texels - 8);
    for (int face = 0; face < 6; ++face) {
        if (faces >> face & 1)
            continue;
        fixture_patch *patch = &patches[count++];
        int z = face / 2, x = (z + 1) % 3, y = (z + 2) % 3;
        float side = face & 1 ? -1.f : 1.f;
        *patch = (fixture_patch){.field = sphere_field, .user = &radius};
        patch->frame.axis_x[x] = side;
        patch->frame.axis_y[y] = 1;
        patch->frame.axis_z[z] = side;
        patch->frame.extent_x = patch->frame.extent_y = (float)(pitch * texels);
        patch->frame.extent_z = (float)(0.8 * radius);
        patch->frame.rect[2] = patch->frame.rect[3] = (uint16_t)texels;
        patch->frame.origin[x] = -side * patch->frame.extent_x / 2;
        patch->frame.origin[y] = -patch->frame.extent_y / 2;
        patch->frame.origin[z] = (float)(side * 0.2 * radius);
    }
    return fixture_build(patches, count, height_bits, 4);
}

gtx_asset *fixture_sphere(double radius, uint32_t texels, uint32_t height_bits)
{
    return fixture_sphere_without(radius, texels, height_bits, 0);
}
