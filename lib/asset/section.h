/* Sections of a file: their types, order, formats and sizes; and the version of the format. */
#ifndef GTX_ASSET_SECTION_H
#define GTX_ASSET_SECTION_H

#include "asset/asset.h"

#include <stdbool.h>

#define GTX_FORMAT_MAJOR 0u
#define GTX_FORMAT_MINOR 7u
#define GTX_HEADER_SIZE 192u
#define GTX_ENTRY_SIZE 64u
#define GTX_META_LIMIT (1u << 20)

/* In file order, but that the coarsest LOD mesh comes before the patches. */
typedef enum gtx_section_kind {
    GTX_SECTION_PATCHES,
    GTX_SECTION_LOD,
    GTX_SECTION_COLOR,
    GTX_SECTION_MATERIAL,
    GTX_SECTION_EMISSION,
    GTX_SECTION_HEIGHT,
    GTX_SECTION_TRIM,
    GTX_SECTION_NORMAL,
    GTX_SECTION_UNKNOWN,
    GTX_SECTION_META,
    GTX_SECTION_FIRST_IMAGE = GTX_SECTION_COLOR,
    GTX_SECTION_LAST_IMAGE = GTX_SECTION_NORMAL
} gtx_section_kind;

enum { GTX_SCHEME_STORED = 0, GTX_SCHEME_ZSTD = 2 };
enum {
    GTX_FILTER_NONE = 0,
    GTX_FILTER_PAETH = 1,
    GTX_FILTER_PLANES = 2,
    GTX_FILTER_PLANES_PAETH = 3,
    GTX_FILTER_SURFACE = 4,
    GTX_FILTER_HEIGHTS = 5,
    GTX_FILTER_STEPS = 6
};

/* A table entry. */
typedef struct gtx_section {
    gtx_section_kind kind;
    uint8_t type[4];
    char name[5];                 /* the type, fit for printing */
    uint32_t flags, level, format;
    uint64_t offset, stored_size, size;
    uint32_t scheme, filter;
    uint64_t hash;
} gtx_section;

/* The dimensions of an image section; `texel` is bytes a texel. */
typedef struct gtx_map_shape {
    uint32_t pages, width, height, texel;
} gtx_map_shape;

static inline uint64_t gtx_align64(uint64_t n)
{
    return (n + 63) & ~(uint64_t)63;
}

gtx_section_kind gtx_section_kind_of(const uint8_t type[4]);

static inline bool gtx_section_is_image(gtx_section_kind kind)
{
    return kind >= GTX_SECTION_FIRST_IMAGE && kind <= GTX_SECTION_LAST_IMAGE;
}

/* Levels of an image kind that such an asset has; 0 for what it lacks and for other kinds. */
uint32_t gtx_map_levels(const gtx_info *info, gtx_section_kind kind);

/* The image of a kind at a level; all zero when the kind is no image. */
gtx_map_shape gtx_section_shape(const gtx_info *info, gtx_section_kind kind, uint32_t level);

static inline uint64_t gtx_shape_size(gtx_map_shape image)
{
    return (uint64_t)image.pages * image.width * image.height * image.texel;
}

/* The one entry that is right for a known kind: type, flags, level, format and size (0 for LODM and
 * META); the other fields are 0. */
gtx_section gtx_section_describe(const gtx_info *info, gtx_section_kind kind, uint32_t level);

/* Entries of all sections of an asset in file order, with their hashes. Returns how many. */
#define GTX_MAX_KNOWN_SECTIONS (5 + 4 * GTX_MAX_MIPS + GTX_MAX_LODS)
uint32_t gtx_asset_sections(const gtx_asset *asset, gtx_section out[GTX_MAX_KNOWN_SECTIONS]);

/* Where the asset keeps the image of a level; NULL when the kind is no image. */
uint8_t **gtx_asset_map(gtx_asset *asset, gtx_section_kind kind, uint32_t level);

/* The decoded bytes of a section inside the asset; NULL when it has none. */
void *gtx_asset_data(const gtx_asset *asset, gtx_section_kind kind, uint32_t level);

/* XXH64 over the section hashes, META left out. */
uint64_t gtx_content_hash(const gtx_section *sections, uint32_t count);

/* Levels that a section of the kind may be of, where the asset has as many mips. */
uint32_t gtx_section_levels(gtx_section_kind kind, uint32_t mip_count);

/* Sizes that do not follow from a gtx_info; 0 for what is not there. */
typedef struct gtx_sizes {
    uint64_t lod[GTX_MAX_LODS];
    uint64_t meta;
} gtx_sizes;

/* An asset with all its arrays; those of maps and LOD meshes are zeroed if `clear`, or else still
 * to be written. Freed with gtx_close. NULL when memory is out. */
gtx_asset *gtx_asset_new(const gtx_allocator *allocator, const gtx_info *info,
                         const gtx_sizes *sizes, bool clear);

/* Bytes that gtx_asset_new takes. */
uint64_t gtx_asset_bytes(const gtx_info *info, const gtx_sizes *sizes);

#endif
