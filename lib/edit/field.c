/* Height fields: an asset's maps as points and normals, continued some texels past the coded
 * ones. */
#include "edit/edit.h"

#include "base/alloc.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

/* Steepest continuation, in texels of height a texel: the rim of a height field is noisy. */
static const float STEEPEST = 4;

static void place(const gtx_patch *patch, const gtx_spread *field, size_t texel, float height,
                  float out[3])
{
    const double x = (double)(texel % field->width) - GTX_EDIT_MARGIN;
    const double y = (double)(texel / field->width) - GTX_EDIT_MARGIN;
    double point[3];
    gtx_texel_point(patch, x, y, (double)height / patch->extent_z, point);
    for (int k = 0; k < 3; ++k)
        out[k] = (float)point[k];
}

static uint64_t read_patch(gtx_edit *edit, uint32_t index)
{
    const gtx_asset *asset = edit->source;
    const gtx_patch *patch = &asset->patches[index];
    const gtx_spread *field = &edit->fields[index];
    uint64_t coded = 0;
    float rows[3][3];
    gtx_normal_frame(patch, rows);
    for (uint32_t j = 0; j < patch->rect[3]; ++j)
        for (uint32_t i = 0; i < patch->rect[2]; ++i) {
            const uint32_t code = gtx_height_code(asset, patch, i, j);
            if (!code)
                continue;
            const size_t own = (size_t)(j + GTX_EDIT_MARGIN) * field->width + i + GTX_EDIT_MARGIN;
            const size_t texel = field->first + own;
            const size_t row = (size_t)patch->page * asset->info.page_height + patch->rect[1] + j;
            const size_t at = row * asset->info.page_width + patch->rect[0] + i;
            float n[3];
            gtx_decode_normal(asset->normal[0] + 2 * at, n);
            for (int k = 0; k < 3; ++k)
                edit->normal[texel][k] = n[0] * rows[0][k] + n[1] * rows[1][k] + n[2] * rows[2][k];
            edit->trim[texel] = (float)gtx_trim_distance(asset->trim[at]);
            edit->height[texel] =
                (float)(gtx_code_height(code, asset->info.height_bits) * patch->extent_z);
            edit->kind[texel] = edit->trim[texel] <= 0 ? GTX_TEXEL_OWN : GTX_TEXEL_LOOSE;
            edit->ring[texel] = 0;
            place(patch, field, own, edit->height[texel], edit->rest[texel]);
            ++coded;
        }
    return coded;
}

/* What the texels around one of a ring tell of it. */
typedef struct guess {
    float height, flat, normal[3], trim;
    int sloped, count;
} guess;

/* Adds the direction (dx, dy), along which one texel, and perhaps a second, is there. */
static void look(const gtx_edit *edit, const gtx_spread *field, uint32_t i, uint32_t j, int dx,
                 int dy, uint8_t ring, float steepest, guess *g)
{
    const int64_t x = (int64_t)i + dx, y = (int64_t)j + dy;
    if (x < 0 || y < 0 || x >= field->width || y >= field->height)
        return;
    const size_t a = field->first + (size_t)y * field->width + (size_t)x;
    if (edit->ring[a] >= ring)
        return;
    const float step = dx && dy ? 1.41421356f : 1;
    g->flat += edit->height[a];
    for (int k = 0; k < 3; ++k)
        g->normal[k] += edit->normal[a][k];
    g->trim = fminf(g->trim, edit->trim[a] + step);
    ++g->count;
    const int64_t u = x + dx, v = y + dy;
    if (u < 0 || v < 0 || u >= field->width || v >= field->height)
        return;
    const size_t b = field->first + (size_t)v * field->width + (size_t)u;
    if (edit->ring[b] >= ring)
        return;
    const float slope = fminf(fmaxf(edit->height[a] - edit->height[b], -steepest), steepest);
    g->height += edit->height[a] + slope;
    ++g->sloped;
}

/* Where a height field ends without having been trimmed, its last texels are its outline. */
static void end_at_border(gtx_edit *edit, const gtx_spread *field)
{
    const size_t last = field->first + (size_t)field->width * field->height;
    for (size_t t = field->first; t < last; ++t)
        if (edit->ring[t] == 0 && edit->trim[t] < (float)GTX_TRIM_SHOWN &&
            (edit->ring[t - 1] || edit->ring[t + 1] || edit->ring[t - field->width] ||
             edit->ring[t + field->width]))
            edit->trim[t] = (float)GTX_TRIM_SHOWN;
}

/* Rings of texels are continued straight on, each from those before it. */
static void continue_patch(gtx_edit *edit, uint32_t index)
{
    const gtx_patch *patch = &edit->source->patches[index];
    const gtx_spread *field = &edit->fields[index];
    const float steepest = STEEPEST * patch->extent_x / patch->rect[2];
    for (uint8_t ring = 1; ring <= GTX_EDIT_MARGIN; ++ring)
        for (uint32_t j = 0; j < field->height; ++j)
            for (uint32_t i = 0; i < field->width; ++i) {
                const size_t own = (size_t)j * field->width + i, texel = field->first + own;
                if (edit->ring[texel] <= ring)
                    continue;
                guess g = {.trim = INFINITY};
                for (int k = 0; k < 9; ++k)
                    if (k != 4)
                        look(edit, field, i, j, k % 3 - 1, k / 3 - 1, ring, steepest, &g);
                if (!g.count)
                    continue;
                const float *n = g.normal;
                const float size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
                for (int k = 0; k < 3; ++k)
                    edit->normal[texel][k] = size > 0 ? n[k] / size : patch->axis_z[k];
                edit->height[texel] = g.sloped ? g.height / (float)g.sloped
                                               : g.flat / (float)g.count;
                edit->trim[texel] = g.trim;
                edit->kind[texel] = GTX_TEXEL_LOOSE;
                edit->ring[texel] = ring;
                place(patch, field, own, edit->height[texel], edit->rest[texel]);
            }
}

gtx_result gtx_edit_spread(gtx_edit *edit, gtx_error *error)
{
    uint64_t coded = 0;
    memset(edit->ring, UINT8_MAX, edit->texels);
    for (uint32_t p = 0; p < edit->count; ++p) {
        coded += read_patch(edit, p);
        end_at_border(edit, &edit->fields[p]);
        continue_patch(edit, p);
    }
    if (!coded)
        return gtx_fail(error, GTX_ERROR_EMPTY, "no texel of the asset has a height");
    return GTX_OK;
}
