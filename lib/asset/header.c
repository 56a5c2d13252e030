/* Where the fields of header and table entries lie (format/gtx.md, 1.1 and 1.2). */
#include "asset/header.h"

#include "base/bytes.h"
#include "base/hash.h"

const uint8_t gtx_identifier[12] = {0xAB, 'G', 'T', 'X', ' ', '0',
                                    '1', 0xBB, '\r', '\n', 0x1A, '\n'};

void gtx_header_load(const uint8_t *bytes, gtx_header *header, gtx_info *info)
{
    header->header_size = gtx_load_u32(bytes + 16);
    header->must_flags = gtx_load_u32(bytes + 20);
    header->section_count = gtx_load_u32(bytes + 28);
    header->file_size = gtx_load_u64(bytes + 32);
    header->section_table = gtx_load_u64(bytes + 40);
    header->section_stride = gtx_load_u32(bytes + 48);
    header->header_hash = gtx_load_u64(bytes + 184);

    *info = (gtx_info){0};
    info->version_major = gtx_load_u16(bytes + 12);
    info->version_minor = gtx_load_u16(bytes + 14);
    info->patch_count = gtx_load_u32(bytes + 52);
    info->page_count = gtx_load_u32(bytes + 56);
    info->page_width = gtx_load_u32(bytes + 60);
    info->page_height = gtx_load_u32(bytes + 64);
    info->mip_count = gtx_load_u32(bytes + 68);
    for (int i = 0; i < 3; ++i) {
        info->bounds_min[i] = gtx_load_f32(bytes + 72 + 4 * i);
        info->bounds_max[i] = gtx_load_f32(bytes + 84 + 4 * i);
        info->anchor[i] = gtx_load_f64(bytes + 104 + 8 * i);
    }
    info->unit = gtx_load_f32(bytes + 96);
    info->content_hash = gtx_load_u64(bytes + 128);
    info->source_triangles = gtx_load_u64(bytes + 136);
    info->emission_scale = gtx_load_f32(bytes + 144);
    info->file_size = header->file_size;
}

static void entry_store(uint8_t *bytes, const gtx_section *section)
{
    memcpy(bytes, section->type, 4);
    gtx_store_u32(bytes + 4, section->flags);
    gtx_store_u32(bytes + 8, section->level);
    gtx_store_u32(bytes + 12, section->format);
    gtx_store_u64(bytes + 16, section->offset);
    gtx_store_u64(bytes + 24, section->stored_size);
    gtx_store_u64(bytes + 32, section->size);
    gtx_store_u32(bytes + 40, section->scheme);
    gtx_store_u32(bytes + 44, section->filter);
    gtx_store_u64(bytes + 48, section->hash);
    gtx_store_u64(bytes + 56, 0);
}

gtx_section gtx_entry_load(const uint8_t *bytes)
{
    gtx_section section = {
        .kind = gtx_section_kind_of(bytes),
        .flags = gtx_load_u32(bytes + 4),
        .level = gtx_load_u32(bytes + 8),
        .format = gtx_load_u32(bytes + 12),
        .offset = gtx_load_u64(bytes + 16),
        .stored_size = gtx_load_u64(bytes + 24),
        .size = gtx_load_u64(bytes + 32),
        .scheme = gtx_load_u32(bytes + 40),
        .filter = gtx_load_u32(bytes + 44),
        .hash = gtx_load_u64(bytes + 48),
    };
    memcpy(section.type, bytes, 4);
    for (int i = 0; i < 4; ++i)
        section.name[i] = bytes[i] > ' ' && bytes[i] < 0x7F ? (char)bytes[i] : '?';
    return section;
}

uint64_t gtx_header_hash(const uint8_t *bytes, uint32_t section_count)
{
    gtx_hash hash;
    gtx_hash_begin(&hash);
    gtx_hash_add(&hash, bytes, 184);
    gtx_hash_add(&hash, bytes + GTX_HEADER_SIZE, (size_t)section_count * GTX_ENTRY_SIZE);
    return gtx_hash_end(&hash);
}

void gtx_header_store(uint8_t *bytes, const gtx_info *info, const gtx_section *sections,
                      uint32_t count, uint64_t file_size)
{
    memset(bytes, 0, GTX_HEADER_SIZE);
    memcpy(bytes, gtx_identifier, sizeof gtx_identifier);
    gtx_store_u16(bytes + 12, GTX_FORMAT_MAJOR);
    gtx_store_u16(bytes + 14, GTX_FORMAT_MINOR);
    gtx_store_u32(bytes + 16, GTX_HEADER_SIZE);
    gtx_store_u32(bytes + 28, count);
    gtx_store_u64(bytes + 32, file_size);
    gtx_store_u64(bytes + 40, GTX_HEADER_SIZE);
    gtx_store_u32(bytes + 48, GTX_ENTRY_SIZE);
    gtx_store_u32(bytes + 52, info->patch_count);
    gtx_store_u32(bytes + 56, info->page_count);
    gtx_store_u32(bytes + 60, info->page_width);
    gtx_store_u32(bytes + 64, info->page_height);
    gtx_store_u32(bytes + 68, info->mip_count);
    for (int i = 0; i < 3; ++i) {
        gtx_store_f32(bytes + 72 + 4 * i, info->bounds_min[i]);
        gtx_store_f32(bytes + 84 + 4 * i, info->bounds_max[i]);
        gtx_store_f64(bytes + 104 + 8 * i, info->anchor[i]);
    }
    gtx_store_f32(bytes + 96, info->unit);
    gtx_store_u64(bytes + 128, gtx_content_hash(sections, count));
    gtx_store_u64(bytes + 136, info->source_triangles);
    gtx_store_f32(bytes + 144, info->emission_scale);
    for (uint32_t i = 0; i < count; ++i)
        entry_store(bytes + GTX_HEADER_SIZE + GTX_ENTRY_SIZE * i, &sections[i]);
    gtx_store_u64(bytes + 184, gtx_header_hash(bytes, count));
}
