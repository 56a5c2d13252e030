/* Sections of a file of which first bytes are there, and pieces of the rest. */
#include "asset/arrival.h"

static uint64_t end_of(const gtx_section *section)
{
    return section->offset + section->stored_size;
}

uint64_t gtx_arrival_needed(const gtx_layout *layout, uint64_t size)
{
    for (uint32_t i = 0; i < layout->section_count; ++i) {
        const gtx_section *section = &layout->sections[i];
        if (section->kind >= GTX_SECTION_HEIGHT || layout->info.lod_levels == 0)
            break;
        if (end_of(section) > size && section->kind != GTX_SECTION_PATCHES)
            return end_of(section);
    }
    return layout->info.file_size;
}

const uint8_t *gtx_arrived_bytes(const gtx_arrival *a, const gtx_section *section)
{
    if (end_of(section) <= a->size)
        return a->data + section->offset;
    for (uint32_t i = 0; i < a->piece_count; ++i) {
        const gtx_file_part *p = &a->pieces[i];
        if (section->offset >= p->first && section->offset - p->first <= p->size &&
            section->stored_size <= p->size - (section->offset - p->first))
            return p->bytes + (section->offset - p->first);
    }
    return NULL;
}

static bool is_for_normals(const gtx_section *section)
{
    return section->kind == GTX_SECTION_HEIGHT || section->kind == GTX_SECTION_NORMAL;
}

/* Normals are coded against patches and heights, and coarse ones against finer ones: all of them,
 * or none. */
static bool has_normals(const gtx_arrival *a, const gtx_layout *layout)
{
    bool all = a->patches;
    for (uint32_t i = 0; i < layout->section_count; ++i)
        all = all && (!is_for_normals(&layout->sections[i]) ||
                      gtx_arrived_bytes(a, &layout->sections[i]));
    return all;
}

void gtx_arrival_find(gtx_arrival *a, const gtx_layout *layout)
{
    for (int kind = 0; kind <= GTX_SECTION_META; ++kind)
        a->images[kind] = -1;
    for (uint32_t i = 0; i < layout->section_count; ++i) {
        const gtx_section *section = &layout->sections[i];
        const bool there = end_of(section) <= a->size;
        a->lods += section->kind == GTX_SECTION_LOD && there;
        a->patches = a->patches || (section->kind == GTX_SECTION_PATCHES && there);
    }
    a->normals = has_normals(a, layout);
    for (uint32_t i = 0; i < layout->section_count; ++i) {
        const gtx_section *section = &layout->sections[i];
        const bool there = section->kind < GTX_SECTION_HEIGHT
                               ? end_of(section) <= a->size
                               : a->normals && is_for_normals(section);
        if (!there)
            continue;
        gtx_section *part = &a->parts[a->part_count++];
        *part = *section;
        if (section->kind == GTX_SECTION_LOD)
            part->level -= layout->info.lod_levels - a->lods;
        else if (gtx_section_is_image(section->kind))
            a->images[section->kind] = (int)section->level;
    }
}

void gtx_arrival_choose(gtx_arrival *a, uint32_t shift)
{
    uint32_t count = 0;
    for (int kind = 0; kind <= GTX_SECTION_META; ++kind)
        if (a->images[kind] >= 0 && a->images[kind] < (int)shift)
            a->images[kind] = (int)shift;
    for (uint32_t i = 0; i < a->part_count; ++i) {
        const int level = (int)a->parts[i].level, finest = a->images[a->parts[i].kind];
        if (!gtx_section_is_image(a->parts[i].kind) || level == finest ||
            (level > finest && a->normals))
            a->parts[count++] = a->parts[i];
    }
    a->part_count = count;
}
