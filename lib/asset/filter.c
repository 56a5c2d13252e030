/* Image filters before compression: their numbers, byte planes, and Paeth's predictor (PNG
 * specification, 9.4). */
#include "asset/codec.h"

#include "base/bytes.h"

#include <stdlib.h>
#include <string.h>

bool gtx_filter_fits(gtx_section_kind kind, uint32_t filter)
{
    if (filter == GTX_FILTER_SURFACE)
        return kind == GTX_SECTION_TRIM || kind == GTX_SECTION_NORMAL;
    if (filter == GTX_FILTER_HEIGHTS)
        return kind == GTX_SECTION_HEIGHT;
    if (filter == GTX_FILTER_STEPS)
        return kind == GTX_SECTION_LOD;
    return filter == GTX_FILTER_NONE ||
           (filter <= GTX_FILTER_PLANES_PAETH && gtx_section_is_image(kind));
}

uint64_t gtx_coded_size(const gtx_section *section)
{
    return section->filter > GTX_FILTER_PAETH ? section->size : 0;
}

uint64_t gtx_apply_size(const gtx_section *section, gtx_map_shape image)
{
    if (section->filter == GTX_FILTER_STEPS)
        return 2 * section->size; /* links of the boundary */
    if (section->filter != GTX_FILTER_SURFACE)
        return section->filter || GTX_BIG_ENDIAN ? section->size : 0; /* gtx_bytes_in_file */
    /* The image with empty texels as the rules have them, marks of the level and of level 0. */
    const uint64_t texels = section->size / image.texel;
    return 2 * section->size + texels + (section->level ? texels << 2 * section->level : 0);
}

/* Images of bytes that are predicted on their own: pages, or planes of pages. */
typedef struct blocks {
    size_t count, rows, row_bytes, stride; /* stride: from a byte to the one left of it */
} blocks;

static blocks blocks_of(gtx_map_shape image, uint32_t filter)
{
    if (filter & GTX_FILTER_PLANES)
        return (blocks){(size_t)image.pages * image.texel, image.height, image.width, 1};
    return (blocks){image.pages, image.height, (size_t)image.width * image.texel, image.texel};
}

static uint8_t predict(int a, int b, int c)
{
    const int pa = abs(b - c), pb = abs(a - c), pc = abs(a + b - 2 * c);
    const int other = pb <= pc ? b : c; /* without a branch, which noise would mislead */
    return (uint8_t)(((pa <= pb) & (pa <= pc)) ? a : other);
}

/* From the last byte to the first: a predictor needs what is not yet replaced. */
static void paeth_apply(blocks shape, uint8_t *data)
{
    size_t row_bytes = shape.row_bytes, stride = shape.stride;
    for (size_t line = shape.count * shape.rows; line-- > 0;) {
        uint8_t *row = data + line * row_bytes;
        bool top = line % shape.rows == 0;
        for (size_t i = row_bytes; i-- > 0;) {
            int a = i >= stride ? row[i - stride] : 0;
            int b = top ? 0 : *(row + i - row_bytes);
            int c = top || i < stride ? 0 : *(row + i - row_bytes - stride);
            row[i] = (uint8_t)(row[i] - predict(a, b, c));
        }
    }
}

static void paeth_undo(gtx_map_shape image, uint8_t *data)
{
    const size_t row_bytes = (size_t)image.width * image.texel, stride = image.texel;
    for (size_t line = 0; line < (size_t)image.pages * image.height; ++line) {
        uint8_t *row = data + line * row_bytes;
        bool top = line % image.height == 0;
        for (size_t i = 0; i < row_bytes; ++i) {
            int a = i >= stride ? row[i - stride] : 0;
            int b = top ? 0 : *(row + i - row_bytes);
            int c = top || i < stride ? 0 : *(row + i - row_bytes - stride);
            row[i] = (uint8_t)(row[i] + predict(a, b, c));
        }
    }
}

void gtx_filter_apply(gtx_map_shape image, uint32_t filter, const uint8_t *in, uint8_t *out)
{
    size_t size = (size_t)gtx_shape_size(image), texels = size / image.texel;
    if (filter & GTX_FILTER_PLANES) {
        for (size_t plane = 0; plane < image.texel; ++plane)
            for (size_t i = 0; i < texels; ++i)
                out[plane * texels + i] = in[i * image.texel + plane];
    } else {
        memcpy(out, in, size);
    }
    if (filter & GTX_FILTER_PAETH)
        paeth_apply(blocks_of(image, filter), out);
}

/* A texel's bytes as numbers, for vectors of the compiler: those of a texel do not wait for one
 * another. */
typedef int16_t lanes __attribute__((vector_size(16)));
typedef uint8_t lane_bytes __attribute__((vector_size(8)));

static inline lanes load_lanes(const uint8_t *texel, size_t size)
{
    lane_bytes bytes = {0};
    memcpy(&bytes, texel, size);
    return __builtin_convertvector(bytes, lanes);
}

static inline lanes absolute(lanes v)
{
    const lanes sign = v >> 15;
    return (v ^ sign) - sign;
}

/* As predict, lane by lane. */
static inline lanes predict_lanes(lanes a, lanes b, lanes c)
{
    const lanes pa = absolute(b - c), pb = absolute(a - c), pc = absolute(a + (b - 2 * c));
    const lanes not_b = pb > pc, not_a = (pa > pb) | (pa > pc);
    const lanes other = (b & ~not_b) | (c & not_b);
    return (a & ~not_a) | (other & not_a);
}

/* Planes and Paeth's predictor at once, of texels of `size` bytes. */
static inline void undo_texels(gtx_map_shape image, size_t size, const uint8_t *restrict coded,
                               uint8_t *restrict out)
{
    const size_t width = image.width, row_bytes = width * size;
    const size_t texels = (size_t)image.pages * image.height * width;
    for (size_t first = 0; first < texels; first += width, out += row_bytes) {
        const bool top = first / width % image.height == 0;
        lanes left = {0}, corner = {0};
        for (size_t x = 0; x < width; ++x)
            for (size_t k = 0; k < size; ++k)
                out[x * size + k] = coded[k * texels + first + x];
        for (uint8_t *at = out; at < out + row_bytes; at += size) {
            const lanes above = top ? (lanes){0} : load_lanes(at - row_bytes, size);
            left = (load_lanes(at, size) + predict_lanes(left, above, corner)) & 255;
            corner = above;
            const lane_bytes bytes = __builtin_convertvector(left, lane_bytes);
            memcpy(at, &bytes, size);
        }
    }
}

void gtx_filter_undo(gtx_map_shape image, uint32_t filter, uint8_t *coded, uint8_t *out)
{
    size_t size = (size_t)gtx_shape_size(image), texels = size / image.texel;
    if (filter == GTX_FILTER_PLANES_PAETH) {
        switch (image.texel) {
        case 1: undo_texels(image, 1, coded, out); break;
        case 2: undo_texels(image, 2, coded, out); break;
        case 3: undo_texels(image, 3, coded, out); break;
        default: undo_texels(image, 4, coded, out);
        }
    } else if (filter == GTX_FILTER_PLANES) {
        for (size_t plane = 0; plane < image.texel; ++plane)
            for (size_t i = 0; i < texels; ++i)
                out[i * image.texel + plane] = coded[plane * texels + i];
    } else {
        if (filter == GTX_FILTER_PAETH)
            paeth_undo(image, coded);
        if (out != coded)
            memcpy(out, coded, size);
    }
}
