/* Header and table entries as bytes: where each field lies, in both directions. */
#ifndef GTX_ASSET_HEADER_H
#define GTX_ASSET_HEADER_H

#include "asset/section.h"

/* The fields that say how the file itself is laid out; the others go to a gtx_info. */
typedef struct gtx_header {
    uint32_t header_size, must_flags, section_count, section_stride;
    uint64_t file_size, section_table, header_hash;
} gtx_header;

extern const uint8_t gtx_identifier[12];

/* Reads GTX_HEADER_SIZE bytes. height_bits and which maps there are come from the table. */
void gtx_header_load(const uint8_t *bytes, gtx_header *header, gtx_info *info);

/* Writes header and table in front of a file; offsets, hashes and sizes are in place already. */
void gtx_header_store(uint8_t *bytes, const gtx_info *info, const gtx_section *sections,
                      uint32_t count, uint64_t file_size);

/* Reads GTX_ENTRY_SIZE bytes; the reserved word is left to the caller. */
gtx_section gtx_entry_load(const uint8_t *bytes);

/* What header_hash must be: over the header but for its last field, and the table. */
uint64_t gtx_header_hash(const uint8_t *bytes, uint32_t section_count);

#endif
