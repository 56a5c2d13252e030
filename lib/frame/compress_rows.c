/* Maps in blocks: which of a block's texels are looked up, and what encodes them. */
#include "frame/compress.h"

#include "frame/bc.h"
#include "frame/etc.h"

#include <string.h>

static void encode_channels(const gtx_texels *texels, const uint8_t *weights, uint8_t *out,
                            void (*encode)(const uint8_t *, const uint8_t *, uint8_t *))
{
    for (int c = 0; c < 2; ++c) {
        uint8_t channel[GTX_BLOCK_TEXELS];
        for (int i = 0; i < GTX_BLOCK_TEXELS; ++i)
            channel[i] = texels->at[i][c];
        encode(channel, weights, out + 8 * c);
    }
}

static void encode_bc5(const gtx_texels *texels, const uint8_t *weights, uint8_t *out)
{
    encode_channels(texels, weights, out, gtx_bc4_encode);
}

static void encode_eac_rg(const gtx_texels *texels, const uint8_t *weights, uint8_t *out)
{
    encode_channels(texels, weights, out, gtx_eac_r11_encode);
}

static void encode_etc2_rgba(const gtx_texels *texels, const uint8_t *weights, uint8_t *out)
{
    uint8_t alpha[GTX_BLOCK_TEXELS];
    for (int i = 0; i < GTX_BLOCK_TEXELS; ++i)
        alpha[i] = texels->at[i][3];
    gtx_eac_alpha_encode(alpha, weights, out);
    gtx_etc2_encode(texels, weights, out + 8);
}

typedef void encoder(const gtx_texels *texels, const uint8_t *weights, uint8_t *out);

static encoder *const encoders[] = {[GTX_FORMAT_BC1_SRGB] = gtx_bc1_encode,
                                    [GTX_FORMAT_BC5] = encode_bc5,
                                    [GTX_FORMAT_BC7] = gtx_bc7_encode,
                                    [GTX_FORMAT_BC7_SRGB] = gtx_bc7_encode,
                                    [GTX_FORMAT_EAC_RG11] = encode_eac_rg,
                                    [GTX_FORMAT_ETC2_RGBA8] = encode_etc2_rgba,
                                    [GTX_FORMAT_ETC2_RGBA8_SRGB] = encode_etc2_rgba,
                                    [GTX_FORMAT_ETC2_RGB8_SRGB] = gtx_etc2_encode};

/* Whether a texel of level 0 among those under (x, y) of a level, and those around it, has a
 * height: filters look at the neighbours. */
static bool is_needed(const gtx_asset *asset, const gtx_block_rows *r, uint32_t x, uint32_t y)
{
    static const uint8_t none[2] = {0};
    const gtx_info *info = &asset->info;
    const size_t size = info->height_bits / 8, page = (size_t)info->page_width * info->page_height;
    const uint8_t *heights = gtx_map_data(asset, GTX_MAP_HEIGHT, 0, NULL);
    const uint32_t x0 = x ? (x - 1) << r->level : 0, y0 = y ? (y - 1) << r->level : 0;
    const uint32_t x1 = (x + 2) << r->level, y1 = (y + 2) << r->level;
    for (uint32_t j = y0; j < y1 && j < info->page_height; ++j) {
        const uint8_t *row = heights + (r->page * page + (size_t)j * info->page_width) * size;
        for (uint32_t i = x0; i < x1 && i < info->page_width; ++i)
            if (memcmp(row + i * size, none, size) != 0)
                return true;
    }
    return false;
}

/* What is beyond the page is as its last texels. Where no texel is needed all weigh the same. */
static void load(const gtx_asset *asset, const gtx_block_rows *r, uint32_t bx, uint32_t by,
                 gtx_texels *texels, uint8_t weights[GTX_BLOCK_TEXELS])
{
    bool any = false;
    for (uint32_t i = 0; i < GTX_BLOCK_TEXELS; ++i) {
        const uint32_t x = GTX_BLOCK_SIDE * bx + i % GTX_BLOCK_SIDE;
        const uint32_t y = GTX_BLOCK_SIDE * by + i / GTX_BLOCK_SIDE;
        const bool within = x < r->width && y < r->height;
        const size_t row = (size_t)r->page * r->height + (y < r->height ? y : r->height - 1);
        const size_t at = row * r->width + (x < r->width ? x : r->width - 1);
        texels->at[i][2] = texels->at[i][3] = 255;
        memcpy(texels->at[i], r->texels + at * r->channels, r->channels);
        weights[i] = within && is_needed(asset, r, x, y);
        any = any || weights[i];
    }
    if (!any)
        memset(weights, 1, GTX_BLOCK_TEXELS);
}

void gtx_compress_rows(const gtx_asset *asset, const gtx_block_rows *r)
{
    const uint32_t size = gtx_block_size(r->format);
    uint8_t *out = r->out;
    for (uint32_t by = r->first; by < r->end; ++by)
        for (uint32_t bx = r->left; bx < r->right; ++bx, out += size) {
            gtx_texels texels;
            uint8_t weights[GTX_BLOCK_TEXELS];
            load(asset, r, bx, by, &texels, weights);
            encoders[r->format](&texels, weights, out);
        }
}
