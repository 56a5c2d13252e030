/* Maps in blocks: which formats. */
#include "frame/compress.h"

gtx_storage gtx_storage_of(uint32_t unit, gtx_compression compress, bool opaque)
{
    static const gtx_storage all[][UNIT_COUNT] = {
        [GTX_COMPRESS_NONE] = {[UNIT_CELLS] = {GTX_FORMAT_R8_UINT, 1, 0},
                               [UNIT_TRIM] = {GTX_FORMAT_R8, 1, 0},
                               [UNIT_NORMALS] = {GTX_FORMAT_RG8, 2, 0},
                               [UNIT_COLORS] = {GTX_FORMAT_RGBA8_SRGB, 4, 0},
                               [UNIT_PATCHES] = {GTX_FORMAT_RGBA32_FLOAT, 16, 0},
                               [UNIT_MATERIALS] = {GTX_FORMAT_RGBA8, 4, 0},
                               [UNIT_EMISSIONS] = {GTX_FORMAT_RGB8_SRGB, 3, 0}},
        [GTX_COMPRESS_BC] = {[UNIT_NORMALS] = {GTX_FORMAT_BC5, 0, 16},
                             [UNIT_COLORS] = {GTX_FORMAT_BC7_SRGB, 0, 16},
                             [UNIT_MATERIALS] = {GTX_FORMAT_BC7, 0, 16},
                             [UNIT_EMISSIONS] = {GTX_FORMAT_BC7_SRGB, 0, 16}},
        [GTX_COMPRESS_BC_SMALL] = {[UNIT_NORMALS] = {GTX_FORMAT_BC5, 0, 16},
                                   [UNIT_COLORS] = {GTX_FORMAT_BC7_SRGB, 0, 16},
                                   [UNIT_MATERIALS] = {GTX_FORMAT_BC7, 0, 16},
                                   [UNIT_EMISSIONS] = {GTX_FORMAT_BC1_SRGB, 0, 8}},
        [GTX_COMPRESS_ETC2] = {[UNIT_NORMALS] = {GTX_FORMAT_EAC_RG11, 0, 16},
                               [UNIT_COLORS] = {GTX_FORMAT_ETC2_RGBA8_SRGB, 0, 16},
                               [UNIT_MATERIALS] = {GTX_FORMAT_ETC2_RGBA8, 0, 16},
                               [UNIT_EMISSIONS] = {GTX_FORMAT_ETC2_RGB8_SRGB, 0, 8}}};
    gtx_storage s = all[compress][unit];
    if (unit == UNIT_COLORS && opaque && compress >= GTX_COMPRESS_ETC2)
        s = all[compress][UNIT_EMISSIONS]; /* of three channels, too */
    return s.format ? s : all[GTX_COMPRESS_NONE][unit];
}

uint32_t gtx_block_number(gtx_format format)
{
    static const uint32_t numbers[] = {
        [GTX_FORMAT_BC5] = 141,         [GTX_FORMAT_BC7] = 145,
        [GTX_FORMAT_BC7_SRGB] = 146,    [GTX_FORMAT_BC1_SRGB] = 132,
        [GTX_FORMAT_EAC_RG11] = 155,    [GTX_FORMAT_ETC2_RGBA8] = 151,
        [GTX_FORMAT_ETC2_RGBA8_SRGB] = 152, [GTX_FORMAT_ETC2_RGB8_SRGB] = 148};
    return numbers[format];
}

uint32_t gtx_block_size(gtx_format format)
{
    return format == GTX_FORMAT_ETC2_RGB8_SRGB || format == GTX_FORMAT_BC1_SRGB ? 8 : 16;
}
