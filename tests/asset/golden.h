/* The golden assets: small, made of integer formulas, the same on every machine. */
#ifndef GTX_TESTS_GOLDEN_H
#define GTX_TESTS_GOLDEN_H

#include "asset/golden_lod.h"
#include "asset/header.h"
#include "base/bytes.h"
#include "base/hash.h"

#include <geotex/geotex.h>

#include <stdio.h>
#include <stdlib.h>

#define GOOD "tests/golden/good/"
#define BAD "tests/golden/bad/"

enum { NO_MAP = 0, COLOR = 1, MATERIAL = 2, EMISSION = 4, EVERY_MAP = 7 };

typedef struct golden {
    const char *name;
    uint32_t side, pages, mips, bits;
    unsigned maps;                /* of those that may be absent */
    bool two_sided;
    const char *meta;
    int zstd_level;
    bool unknown;                 /* a section that readers skip is put in */
    uint64_t content_hash, file_hash;
    uint32_t lods;
    bool normals;                 /* of the LOD meshes' vertices */
} golden;

/* As gtx_encode_desc has it. */
static inline int golden_level(const golden *g)
{
    return g->zstd_level ? g->zstd_level : -1;
}

/* Hashes are literals: a change of the format must be made knowingly. */
static const golden goldens[] = {
    {"minimal", 8, 1, 1, 8, NO_MAP, false, NULL, 0, false,
     0xa1ada67a311afbb8, 0x67d9017bbd4e95db, 0, false},
    {"two-sided", 8, 1, 1, 8, NO_MAP, true, NULL, 0, false,
     0x2a060121eecc877a, 0x932f151898433d09, 0, false},
    {"height16", 16, 1, 1, 16, NO_MAP, false, NULL, 0, false,
     0x203462dc802c36e8, 0x93e8a893a8008702, 0, false},
    {"color", 16, 1, 3, 8, COLOR, false, "{\"generator\":\"golden\"}", 0, false,
     0xc17d8818b7b4faff, 0x3ae40c7f829b22b7, 0, false},
    {"two-pages", 16, 2, 1, 8, NO_MAP, false, NULL, 0, false,
     0x3c7934d87b3b52d9, 0x88020928072026b8, 0, false},
    {"unknown", 8, 1, 1, 8, NO_MAP, false, NULL, 0, true,
     0x99111e7725385c91, 0xf2b3070b081512e5, 0, false},
    {"zstd", 64, 1, 4, 8, COLOR, false, "{\"generator\":\"golden\"}", 3, false,
     0xe81392a3b3417493, 0xdd46e4f7f7507f7a, 0, false},
    {"zstd16", 64, 2, 2, 16, NO_MAP, false, NULL, 19, false,
     0x725a3d49f50dad05, 0x0bbb08e457ef74a7, 0, false},
    {"material", 8, 1, 2, 8, MATERIAL, false, NULL, 0, false,
     0xd30176fb5abe8750, 0x4d608c9ba3cd6fb2, 0, false},
    {"emission", 8, 1, 2, 8, EMISSION, false, NULL, 0, false,
     0x1bfebc5da0431036, 0x4795ab9f7bc7e6bc, 0, false},
    {"zstd-material", 64, 2, 4, 8, EVERY_MAP, false, NULL, 3, false,
     0xa0cdc932cd093aea, 0x6b762b6015caba86, 0, false},
    {"lod", 8, 1, 1, 8, NO_MAP, false, NULL, 0, false,
     0xf0026a8c54e6f56a, 0x12e040cdc1995799, 2, false},
    {"zstd-lod", 64, 2, 1, 8, NO_MAP, false, NULL, 3, false,
     0xbc6249f92a73a950, 0x20dab1e4b75d48fb, 3, false},
    {"normals", 8, 1, 1, 8, NO_MAP, false, NULL, 0, false,
     0xb3dda899deda6a03, 0x9bdbef0a50a64622, 2, true},
    {"zstd-normals", 64, 2, 1, 8, NO_MAP, false, NULL, 3, false,
     0xda8494e5011109af, 0xe027ff90ab47a6f3, 3, true},
};
enum { GOLDEN_COUNT = sizeof goldens / sizeof goldens[0] };

typedef struct bytes {
    uint8_t *data;
    size_t size;
} bytes;

/* Code of a texel of a patch; every eighth column and a few more texels are empty. */
static inline uint32_t golden_code(uint32_t x, uint32_t y, uint32_t bits)
{
    if (x % 8 == 7 || (x * 5 + y * 3) % 11 == 0)
        return 0;
    uint32_t code = 1 + (x * x + 3 * y * y + x * y) / 4 % 200;
    return bits == 8 ? code : code * 257 + (x * 31 + y * 17) % 255;
}

/* Every patch but the last page's fills half a page, side by side; the last page keeps its lower
 * half free. */
static inline void golden_rect(const golden *g, uint32_t index, gtx_patch *patch)
{
    uint32_t half = g->side > 8 ? g->side / 2 : g->side;
    patch->page = g->side > 8 ? index / 2 : 0;
    patch->rect[0] = (uint16_t)(g->side > 8 && index % 2 ? half : 0);
    patch->rect[2] = (uint16_t)half;
    patch->rect[3] = (uint16_t)(patch->page == 1 ? half : g->side);
}

static inline gtx_patch golden_patch(const golden *g, uint32_t index)
{
    gtx_patch patch = {
        .origin = {0, 0, 0.25f * (float)(index % 2)}, .extent_x = 1,
        .axis_x = {1, 0, 0}, .extent_y = 1,
        .axis_y = {0, 1, 0}, .extent_z = 0.5f,
        .axis_z = {0, 0, 1},
        .dilation = (uint16_t)(1u << (g->mips - 1)),
        .flags = g->two_sided ? GTX_PATCH_TWO_SIDED : 0,
        .sphere = {0.5f, 0.5f, 0.25f, 2},
        .source_triangles = 10 + index,
    };
    golden_rect(g, index, &patch);
    return patch;
}

static inline void golden_fill(const golden *g, gtx_patch *patch, uint8_t *height, uint8_t *trim)
{
    uint32_t coded = 0;
    for (uint32_t y = 0; y < patch->rect[3]; ++y) {
        for (uint32_t x = 0; x < patch->rect[2]; ++x) {
            size_t at = ((size_t)patch->page * g->side + patch->rect[1] + y) * g->side +
                        patch->rect[0] + x;
            uint32_t code = golden_code(x, y, g->bits);
            coded += code != 0;
            if (g->bits == 8)
                height[at] = (uint8_t)code;
            else
                gtx_store_own_u16(height + 2 * at, code);
            trim[at] = (uint8_t)(100 + (x + 2 * y) % 40);
        }
    }
    patch->coverage = (float)coded / (float)(patch->rect[2] * patch->rect[3]);
}

static inline gtx_result golden_create(const golden *g, const gtx_allocator *allocator,
                                       gtx_asset **out, gtx_error *error)
{
    size_t texels = (size_t)g->pages * g->side * g->side;
    uint32_t patch_count = g->side > 8 ? 2 * g->pages : 1;
    gtx_patch patches[4];
    uint8_t *height = need(calloc(texels, g->bits / 8)), *trim = need(calloc(texels, 1));
    uint8_t *normal[8] = {0}, *color[8] = {0}, *material[8] = {0}, *emission[8] = {0};
    for (uint32_t i = 0; i < patch_count; ++i) {
        patches[i] = golden_patch(g, i);
        golden_fill(g, &patches[i], height, trim);
    }
    for (uint32_t k = 0; k < g->mips; ++k) {
        size_t count = texels >> 2 * k;
        normal[k] = need(calloc(count, 2));
        color[k] = need(calloc(count, 4));
        material[k] = need(calloc(count, 4));
        emission[k] = need(calloc(count, 3));
        for (size_t i = 0; i < 2 * count; ++i)
            normal[k][i] = (uint8_t)(120 + (i * 7 + k) % 16);
        for (size_t i = 0; i < 4 * count; ++i)
            color[k][i] = (uint8_t)(i % 4 == 3 ? 255 : i / 4 % 64 + 50 * (i % 4));
        for (size_t i = 0; i < 4 * count; ++i)
            material[k][i] = (uint8_t)(i / 16 % 32 + 70 * (i % 4));
        for (size_t i = 0; i < 3 * count; ++i)
            emission[k][i] = (uint8_t)(i / 3 % 48 + 60 * (i % 3) + k);
    }
    gtx_lod_mesh lod[4];
    for (uint32_t k = 0; k < g->lods; ++k)
        lod[k] = golden_lod(patch_count, k, g->lods);
    for (uint32_t k = 0; k < g->lods && g->normals; ++k)
        golden_normals(&lod[k]);
    gtx_asset_desc desc = {
        .patches = patches, .patch_count = patch_count, .page_count = g->pages,
        .page_width = g->side, .page_height = g->side, .mip_count = g->mips,
        .height_bits = g->bits, .height = height, .trim = trim,
        .normal = (const uint8_t *const *)normal,
        .color = g->maps & COLOR ? (const uint8_t *const *)color : NULL,
        .material = g->maps & MATERIAL ? (const uint8_t *const *)material : NULL,
        .emission = g->maps & EMISSION ? (const uint8_t *const *)emission : NULL,
        .emission_scale = g->maps & EMISSION ? 2.5f : 0,
        .lod = lod, .lod_levels = g->lods,
        .meta = g->meta, .meta_size = g->meta ? strlen(g->meta) : 0,
        .bounds_min = {-1, -1, -1}, .bounds_max = {2, 2, 2}, .unit = 0.5f,
        .anchor = {1e7, -2, 0.25}, .source_triangles = 1234, .allocator = allocator};
    gtx_result result = gtx_create(&desc, out, error);
    for (uint32_t k = 0; k < g->lods; ++k)
        golden_free_lod(&lod[k]);
    for (uint32_t k = 0; k < g->mips; ++k) {
        free(normal[k]);
        free(color[k]);
        free(material[k]);
        free(emission[k]);
    }
    free(height);
    free(trim);
    return result;
}

/* Recomputes content_hash and header_hash after a change of the table. */
static inline void rehash_header(bytes file, bool content)
{
    uint32_t count = gtx_load_u32(file.data + 28);
    if (file.size < GTX_HEADER_SIZE + (size_t)count * GTX_ENTRY_SIZE)
        return;
    gtx_section sections[GTX_MAX_SECTIONS];
    for (uint32_t i = 0; i < count; ++i)
        sections[i] = gtx_entry_load(file.data + GTX_HEADER_SIZE + GTX_ENTRY_SIZE * i);
    if (content)
        gtx_store_u64(file.data + 128, gtx_content_hash(sections, count));
    gtx_store_u64(file.data + 184, gtx_header_hash(file.data, count));
}

/* The same after a change inside a stored section. */
static inline void rehash_sections(bytes file)
{
    uint32_t count = gtx_load_u32(file.data + 28);
    for (uint32_t i = 0; i < count; ++i) {
        uint8_t *entry = file.data + GTX_HEADER_SIZE + GTX_ENTRY_SIZE * i;
        gtx_section section = gtx_entry_load(entry);
        if (section.scheme == GTX_SCHEME_STORED)
            gtx_store_u64(entry + 48, gtx_hash_bytes(file.data + section.offset,
                                                     (size_t)section.size));
    }
    rehash_header(file, true);
}

/* Puts a section XTRA of 5 bytes behind the others: one more entry, one more block of 64. */
static inline bytes with_unknown(bytes file)
{
    uint32_t count = gtx_load_u32(file.data + 28);
    size_t table = GTX_HEADER_SIZE + (size_t)count * GTX_ENTRY_SIZE;
    bytes out = {need(calloc(file.size + 128, 1)), file.size + 128};
    memcpy(out.data, file.data, table);
    memcpy(out.data + table + 64, file.data + table, file.size - table);
    memcpy(out.data + file.size + 64, "extra", 5);
    for (uint32_t i = 0; i < count; ++i) {
        uint8_t *offset = out.data + GTX_HEADER_SIZE + GTX_ENTRY_SIZE * i + 16;
        gtx_store_u64(offset, gtx_load_u64(offset) + 64);
    }
    uint8_t *entry = out.data + table;
    memcpy(entry, "XTRA", 4);
    gtx_store_u64(entry + 16, file.size + 64);
    gtx_store_u64(entry + 24, 5);
    gtx_store_u64(entry + 32, 5);
    gtx_store_u32(out.data + 28, count + 1);
    gtx_store_u64(out.data + 32, out.size);
    rehash_sections(out);
    return out;
}

static inline bytes golden_encode(const golden *g)
{
    gtx_asset *asset;
    gtx_error error;
    if (golden_create(g, NULL, &asset, &error)) {
        fprintf(stderr, "%s: %s\n", g->name, error.message);
        abort();
    }
    gtx_encode_desc desc = {.zstd_level = golden_level(g)};
    void *data = NULL;
    bytes out = {0};
    if (gtx_encode(asset, &desc, &data, &out.size, &error))
        abort();
    out.data = data;
    gtx_close(asset);
    if (g->unknown) {
        bytes longer = with_unknown(out);
        free(out.data);
        out = longer;
    }
    return out;
}

/* The bytes of a file; data is NULL when there is none. */
static inline bytes read_file(const char *path)
{
    bytes out = {0};
    FILE *file = fopen(path, "rb");
    if (!file)
        return out;
    fseek(file, 0, SEEK_END);
    out.size = (size_t)ftell(file);
    rewind(file);
    out.data = need(malloc(out.size ? out.size : 1));
    if (fread(out.data, 1, out.size, file) != out.size)
        abort();
    fclose(file);
    return out;
}

static inline void write_file(const char *path, bytes file)
{
    FILE *out = need(fopen(path, "wb"));
    if (fwrite(file.data, 1, file.size, out) != file.size || fclose(out))
        abort();
}

static inline bytes read_golden(const char *name)
{
    char path[256];
    snprintf(path, sizeof path, GOOD "%s.gtx", name);
    bytes out = read_file(path);
    if (!out.data) {
        fprintf(stderr, "%s is missing\n", path);
        abort();
    }
    return out;
}

#endif
