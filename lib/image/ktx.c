/* KTX 2.0: the container, and what it may hold. Sections are those of the specification. */
#include "image/ktx.h"

#include "base/error.h"
#include "image/basis.h"

#include <stdlib.h>
#include <string.h>
#ifdef GTX_ZSTD
#include <zstd.h>
#endif

enum { HEADER = 80, LEVEL = 24, DFD_HEADER = 28, DFD_SAMPLE = 16 };
enum { PACKED_NOT, PACKED_BASIS_LZ, PACKED_ZSTD };
enum { MODEL_ETC1S = 163, MODEL_UASTC = 166 };

static const uint8_t identifier[12] = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb,
                                       '\r', '\n', 0x1a, '\n'};

/* Where channels are in a texel of 8 bits each; -1 where alpha is full. */
typedef struct plain {
    uint8_t format, srgb_format; /* VkFormat */
    uint8_t size;
    int8_t place[4];
} plain;

static const plain plains[] = {{9, 15, 1, {0, 0, 0, -1}},  {23, 29, 3, {0, 1, 2, -1}},
                               {30, 36, 3, {2, 1, 0, -1}}, {37, 43, 4, {0, 1, 2, 3}},
                               {44, 50, 4, {2, 1, 0, 3}}};

/* What the header says of the finest level. */
typedef struct header {
    const plain *plain;         /* or NULL: Basis Universal */
    uint32_t width, height, levels, packing, model, format;
    int has_alpha, is_upside_down;
    const uint8_t *level, *global;
    uint64_t level_size, unpacked_size, global_size;
} header;

static uint32_t u32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static uint64_t u64(const uint8_t *p)
{
    return u32(p) | (uint64_t)u32(p + 4) << 32;
}

int gtx_is_ktx(const void *data, size_t size)
{
    return size >= sizeof identifier && !memcmp(data, identifier, sizeof identifier);
}

static gtx_result ends(gtx_error *error)
{
    return gtx_fail(error, GTX_ERROR_READ, "the KTX2 image ends too early, or says what cannot be");
}

/* Whether a part of the file is inside of it. */
static int is_inside(uint64_t offset, uint64_t part, size_t size)
{
    return offset <= size && part <= size - offset;
}

/* KTXorientation "ru": the first row is the lowest. */
static int has_low_start(const uint8_t *p, size_t size)
{
    static const char key[] = "KTXorientation";
    while (size >= 4) {
        const uint64_t length = u32(p), all = (length + 3) / 4 * 4 + 4;
        if (length > size - 4)
            return 0;
        if (length >= sizeof key + 2 && !memcmp(p + 4, key, sizeof key))
            return p[4 + sizeof key + 1] == 'u';
        if (all > size)
            return 0;
        p += all;
        size -= (size_t)all;
    }
    return 0;
}

/* The data format descriptor: which codec, and how many channels. */
static int read_descriptor(const uint8_t *p, uint32_t size, header *h)
{
    if (size < DFD_HEADER || u32(p) > size)
        return 0;
    h->model = p[12];
    h->has_alpha = size >= DFD_HEADER + 2 * DFD_SAMPLE; /* of ETC1S: a second slice */
    return 1;
}

static gtx_result read_header(const uint8_t *p, size_t size, header *h, gtx_error *error)
{
    if (size < HEADER + LEVEL)
        return ends(error);
    *h = (header){.format = u32(p + 12), .width = u32(p + 20), .height = u32(p + 24),
                  .levels = u32(p + 40) ? u32(p + 40) : 1, .packing = u32(p + 44)};
    if (!h->width || !h->height || h->levels > 32)
        return ends(error);
    if (u32(p + 28) > 1 || u32(p + 32) > 1 || u32(p + 36) != 1)
        return gtx_fail(error, GTX_ERROR_UNSUPPORTED,
                        "a KTX2 file of several images is no texture: an array, a cube, a volume");
    const uint64_t dfd = u32(p + 48), kvd = u32(p + 56), level = u64(p + HEADER);
    h->global_size = u64(p + 72);
    h->level_size = u64(p + HEADER + 8);
    h->unpacked_size = u64(p + HEADER + 16);
    if (!is_inside(HEADER, (uint64_t)LEVEL * h->levels, size) ||
        !is_inside(dfd, u32(p + 52), size) || !is_inside(kvd, u32(p + 60), size) ||
        !is_inside(u64(p + 64), h->global_size, size) || !is_inside(level, h->level_size, size) ||
        !read_descriptor(p + dfd, u32(p + 52), h))
        return ends(error);
    h->level = p + level;
    h->global = p + u64(p + 64);
    h->is_upside_down = has_low_start(p + kvd, u32(p + 60));
    for (size_t i = 0; i < sizeof plains / sizeof *plains; ++i)
        if (h->format && (h->format == plains[i].format || h->format == plains[i].srgb_format))
            h->plain = &plains[i];
    return GTX_OK;
}

gtx_result gtx_ktx_measure(const void *data, size_t size, uint32_t *width, uint32_t *height,
                           gtx_error *error)
{
    header h;
    const gtx_result result = read_header(data, size, &h, error);
    *width = result ? 0 : h.width;
    *height = result ? 0 : h.height;
    return result;
}

/* ---- the finest level ---- */

static uint64_t size_of_level(const header *h)
{
    const uint64_t blocks = ((uint64_t)h->width + 3) / 4 * (((uint64_t)h->height + 3) / 4);
    return h->plain ? (uint64_t)h->width * h->height * h->plain->size : GTX_UASTC_BLOCK * blocks;
}

static void place_plain(const header *h, const uint8_t *level, uint8_t *pixels)
{
    const size_t count = (size_t)h->width * h->height;
    for (size_t i = 0; i < count; ++i, level += h->plain->size)
        for (int c = 0; c < 4; ++c)
            pixels[4 * i + c] = h->plain->place[c] < 0 ? 255 : level[h->plain->place[c]];
}

static void place_blocks(const header *h, const uint8_t *level, uint8_t *pixels)
{
    uint8_t texels[64];
    for (uint32_t y = 0; y < h->height; y += 4)
        for (uint32_t x = 0; x < h->width; x += 4, level += GTX_UASTC_BLOCK) {
            const uint32_t rows = h->height - y < 4 ? h->height - y : 4;
            const uint32_t columns = h->width - x < 4 ? h->width - x : 4;
            gtx_uastc_decode(level, texels);
            for (uint32_t row = 0; row < rows; ++row)
                memcpy(pixels + 4 * ((size_t)(y + row) * h->width + x), texels + 16 * row,
                       4 * columns);
        }
}

/* Of a level that has to be unpacked first; *unpacked is freed by the caller. */
static gtx_result unpack(const header *h, uint8_t **unpacked, gtx_error *error)
{
#ifdef GTX_ZSTD
    *unpacked = malloc((size_t)h->unpacked_size);
    if (!*unpacked)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the image");
    const size_t got = ZSTD_decompress(*unpacked, (size_t)h->unpacked_size, h->level,
                                       (size_t)h->level_size);
    return got == h->unpacked_size ? GTX_OK
                                   : gtx_fail(error, GTX_ERROR_READ,
                                              "the zstd data of the KTX2 image is broken");
#else
    (void)h;
    *unpacked = NULL;
    return gtx_fail(error, GTX_ERROR_UNSUPPORTED, "this build has no zstd, which the image needs");
#endif
}

static gtx_result read_level(const header *h, uint8_t *pixels, gtx_error *error)
{
    uint8_t *unpacked = NULL;
    gtx_result result = GTX_OK;
    const uint64_t size = h->packing == PACKED_ZSTD ? h->unpacked_size : h->level_size;
    if (size != size_of_level(h))
        return ends(error);
    if (h->packing == PACKED_ZSTD)
        result = unpack(h, &unpacked, error);
    if (!result)
        (h->plain ? place_plain : place_blocks)(h, unpacked ? unpacked : h->level, pixels);
    free(unpacked);
    return result;
}

static gtx_result read_basis_lz(const header *h, uint8_t *pixels, gtx_error *error)
{
    const gtx_basis_image image = {.level = h->level, .level_size = (size_t)h->level_size,
                                   .global = h->global, .global_size = (size_t)h->global_size,
                                   .image_count = h->levels, .width = h->width,
                                   .height = h->height, .has_alpha = h->has_alpha};
    return gtx_etc1s_decode(&image, pixels, error);
}

static void turn(gtx_image *image)
{
    const size_t row = 4 * (size_t)image->width;
    for (uint32_t y = 0; y < image->height / 2; ++y)
        for (size_t i = 0; i < row; ++i) {
            uint8_t *a = image->pixels + y * row + i;
            uint8_t *b = image->pixels + (image->height - 1 - y) * row + i, kept = *a;
            *a = *b;
            *b = kept;
        }
}

gtx_result gtx_ktx_decode(const void *data, size_t size, uint64_t max_pixels, gtx_image *out,
                          gtx_error *error)
{
    header h;
    gtx_result result = read_header(data, size, &h, error);
    if (result)
        return result;
    const int is_etc1s = !h.format && h.model == MODEL_ETC1S && h.packing == PACKED_BASIS_LZ;
    const int is_blocks = !h.format && h.model == MODEL_UASTC;
    if (!is_etc1s && ((!is_blocks && !h.plain) ||
                      (h.packing != PACKED_NOT && h.packing != PACKED_ZSTD)))
        return gtx_fail(error, GTX_ERROR_UNSUPPORTED,
                        "of KTX2 images those of Basis Universal are read, and plain ones of 8 "
                        "bits, stored or by zstd: this one has Vulkan's format %u, model %u, "
                        "scheme %u", h.format, h.model, h.packing);
    if ((uint64_t)h.width * h.height > max_pixels)
        return gtx_fail(error, GTX_ERROR_LIMIT, "the image has more than %llu pixels",
                        (unsigned long long)max_pixels);
    gtx_image image = {h.width, h.height, malloc(4 * (size_t)h.width * h.height)};
    if (!image.pixels)
        return gtx_fail(error, GTX_ERROR_MEMORY, "no memory for the image");
    result = is_etc1s ? read_basis_lz(&h, image.pixels, error)
                      : read_level(&h, image.pixels, error);
    if (result) {
        free(image.pixels);
        return result;
    }
    if (h.is_upside_down)
        turn(&image);
    *out = image;
    return GTX_OK;
}
