/* Corner cells: the four codes of a cell in one texel. */
#include "derive/derive.h"

#include <string.h>

/* One row of cells of a patch; `out` is its first texel. */
static void fill_row(const gtx_asset *asset, const gtx_patch *patch, uint32_t y, uint8_t *out)
{
    size_t code_size = asset->info.height_bits / 8;
    for (uint32_t x = 0; x + 1 < patch->rect[2]; ++x, out += 4 * code_size) {
        uint16_t corner[4] = {(uint16_t)gtx_height_code(asset, patch, x, y),
                              (uint16_t)gtx_height_code(asset, patch, x + 1, y),
                              (uint16_t)gtx_height_code(asset, patch, x, y + 1),
                              (uint16_t)gtx_height_code(asset, patch, x + 1, y + 1)};
        if (!corner[0] || !corner[1] || !corner[2] || !corner[3])
            continue;
        if (code_size == 2)
            memcpy(out, corner, sizeof corner);
        else
            for (int k = 0; k < 4; ++k)
                out[k] = (uint8_t)corner[k];
    }
}

void gtx_derive_patch_cells(const gtx_asset *asset, uint32_t patch, void *out)
{
    const gtx_patch *p = &asset->patches[patch];
    const size_t row_size = 4 * (size_t)asset->info.height_bits / 8 * p->rect[2];
    memset(out, 0, row_size * p->rect[3]);
    for (uint32_t y = 0; y + 1 < p->rect[3]; ++y)
        fill_row(asset, p, y, (uint8_t *)out + y * row_size);
}

void gtx_derive_cells(const gtx_asset *asset, uint32_t page, void *out)
{
    size_t cell_size = 4 * (size_t)asset->info.height_bits / 8;
    memset(out, 0, cell_size * gtx_page_texels(asset, 0));
    for (uint32_t i = 0; i < asset->info.patch_count; ++i) {
        const gtx_patch *patch = &asset->patches[i];
        if (patch->page != page)
            continue;
        for (uint32_t y = 0; y + 1 < patch->rect[3]; ++y) {
            size_t texel = (size_t)(patch->rect[1] + y) * asset->info.page_width + patch->rect[0];
            fill_row(asset, patch, y, (uint8_t *)out + texel * cell_size);
        }
    }
}
