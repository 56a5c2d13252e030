/* Assets of a file's beginning: the patches and LOD meshes get maps of few texels. A texel's normal
 * is the mean of the normals of the LOD mesh's corners in it; texels without one are filled from
 * around. */
#include "asset/preview.h"

#include "asset/fill.h"
#include "asset/lod.h"
#include "asset/patch.h"
#include "base/alloc.h"

#include <string.h>

/* Sums of more normals would not fit 32 bits when their mean is taken. */
enum { MAX_SUM = 1 << 22 };

static uint64_t texels_of(const gtx_info *info)
{
    return (uint64_t)info->page_width * info->page_height * info->page_count;
}

/* Rectangles start and end on multiples of 2^(mip_count - 1): halved once less, all have 2 texels a
 * side; pages must have 8. */
uint32_t gtx_preview_shift(const gtx_info *info, uint64_t triangles)
{
    const uint32_t side = info->page_width < info->page_height ? info->page_width
                                                               : info->page_height;
    uint32_t shift = 0;
    while (shift + 2 < info->mip_count && side >> (shift + 1) >= 8 &&
           texels_of(info) >> 2 * shift > triangles)
        ++shift;
    return shift;
}

gtx_info gtx_preview_info(const gtx_info *info, uint32_t shift, bool mips)
{
    gtx_info out = *info;
    out.page_width >>= shift;
    out.page_height >>= shift;
    out.mip_count = mips ? info->mip_count - shift : 1;
    out.height_bits = 8;
    return out;
}

uint64_t gtx_preview_scratch(const gtx_info *preview, uint32_t vertices)
{
    return texels_of(preview) * (sizeof(gtx_normal_sum) + 1) +
           3 * sizeof(float) * (uint64_t)vertices;
}

/* ---- normals ---- */

typedef struct shaping {
    gtx_asset *asset;
    gtx_lod_mesh mesh;
    float *normals;               /* 3 per vertex, of any length */
    gtx_normal_sum *sums;         /* a texel each */
    uint8_t *ring;
} shaping;

/* Of triangles, each as much as its area. */
static void sum_normals(const shaping *s)
{
    for (uint32_t t = 0; t < s->mesh.triangle_count; ++t) {
        const uint32_t *v = s->mesh.indices + 3 * (size_t)t;
        float side[2][3];
        for (int k = 0; k < 3; ++k)
            for (int e = 0; e < 2; ++e)
                side[e][k] = (float)s->mesh.positions[3 * (size_t)v[e + 1] + (size_t)k] -
                             (float)s->mesh.positions[3 * (size_t)v[0] + (size_t)k];
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            const float part = side[0][i] * side[1][j] - side[0][j] * side[1][i];
            for (int c = 0; c < 3; ++c)
                s->normals[3 * (size_t)v[c] + (size_t)k] += part;
        }
    }
}

/* Adds a vertex's normal to the texel of the patch that it is in, or nearest to. */
static void put_vertex(const shaping *s, const gtx_patch *patch, const gtx_patch_frame *frame,
                       float (*rows)[3], uint32_t vertex)
{
    const uint16_t *q = s->mesh.positions + 3 * (size_t)vertex;
    const float *n = s->normals + 3 * (size_t)vertex;
    uint32_t at[2];
    for (int a = 0; a < 2; ++a) {
        double texel = frame->to_grid[a][3];
        for (int k = 0; k < 3; ++k)
            texel += frame->to_grid[a][k] * ((double)s->mesh.origin[k] +
                                             (double)s->mesh.step * q[k]);
        const double last = patch->rect[2 + a] - 1;
        texel = texel > 0 ? texel < last ? texel + 0.5 : last : 0; /* NaN ends at 0 */
        at[a] = patch->rect[a] + (uint32_t)texel;
    }
    float local[3] = {0, 0, 0};
    uint8_t code[2];
    for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k)
            local[r] += rows[r][k] * n[k];
    gtx_encode_normal(local, code);
    const gtx_info *info = &s->asset->info;
    const size_t texel = ((size_t)patch->page * info->page_height + at[1]) * info->page_width +
                         at[0];
    gtx_normal_sum *sum = &s->sums[texel];
    if (sum->a < MAX_SUM / 2 && sum->a > -MAX_SUM / 2 && sum->b < MAX_SUM / 2 &&
        sum->b > -MAX_SUM / 2 && sum->z < MAX_SUM / 2)
        gtx_normal_add(sum, code);
    s->ring[texel] = 1;
}

static void shape_patch(const shaping *s, uint32_t index)
{
    const gtx_info *info = &s->asset->info;
    const gtx_patch *patch = &s->asset->patches[index];
    const gtx_patch_frame frame = gtx_patch_frame_of(patch, info->height_bits);
    float rows[3][3];
    gtx_normal_frame(patch, rows);
    for (uint32_t t = s->mesh.first[index]; t < s->mesh.first[index + 1]; ++t)
        for (int c = 0; c < 3; ++c)
            put_vertex(s, patch, &frame, rows, s->mesh.indices[3 * (size_t)t + (size_t)c]);
    const size_t row = (size_t)patch->page * info->page_height + patch->rect[1];
    const size_t first = row * info->page_width + patch->rect[0];
    for (uint32_t y = 0; y < patch->rect[3]; ++y)
        for (uint32_t x = 0; x < patch->rect[2]; ++x) {
            const size_t texel = first + y * (size_t)info->page_width + x;
            if (s->ring[texel])
                gtx_normal_mean(&s->sums[texel], s->asset->normal[0] + 2 * texel);
        }
    const gtx_fill area = {s->asset->normal[0] + 2 * first, s->ring + first, info->page_width,
                           patch->rect[2], patch->rect[3]};
    gtx_patch wide = *patch;
    wide.dilation = UINT16_MAX;
    gtx_fill_normals(&area, gtx_fill_rings(&wide, 0));
}

/* False when memory is out. */
static bool shape(gtx_asset *asset)
{
    const size_t texels = (size_t)texels_of(&asset->info);
    shaping s = {.asset = asset};
    gtx_get_lod_mesh(asset, 0, &s.mesh);
    const gtx_allocator *hooks = &asset->allocator;
    s.normals = gtx_alloc_array(hooks, s.mesh.vertex_count, 3 * sizeof *s.normals);
    s.sums = gtx_alloc_array(hooks, texels, sizeof *s.sums);
    s.ring = gtx_alloc_array(hooks, texels, 1);
    const bool whole = s.normals && s.sums && s.ring;
    if (whole) {
        memset(asset->normal[0], GTX_FAR_NORMAL, 2 * texels);
        memset(asset->trim, GTX_FAR_TRIM, texels);
        sum_normals(&s);
        for (uint32_t i = 0; i < asset->info.patch_count; ++i)
            shape_patch(&s, i);
    }
    gtx_free_array(hooks, s.normals, s.mesh.vertex_count, 3 * sizeof *s.normals);
    gtx_free_array(hooks, s.sums, texels, sizeof *s.sums);
    gtx_free_array(hooks, s.ring, texels, 1);
    return whole;
}

/* ---- all of it ---- */

/* A level of the preview, from one that has as many texels, or fewer. */
static void copy_image(const gtx_asset *source, gtx_asset *out, gtx_section_kind kind,
                       uint32_t level, uint32_t finest, uint32_t shift)
{
    const uint32_t found = shift + level > finest ? shift + level : finest;
    const uint32_t by = found - shift - level;
    const gtx_map_shape from = gtx_section_shape(&source->info, kind, found);
    const gtx_map_shape to = gtx_section_shape(&out->info, kind, level);
    const uint8_t *texels = gtx_asset_data(source, kind, found);
    uint8_t *at = gtx_asset_data(out, kind, level);
    for (size_t page = 0; page < to.pages; ++page)
        for (size_t y = 0; y < to.height; ++y)
            for (size_t x = 0; x < to.width; ++x, at += to.texel) {
                const size_t row = page * from.height + (y >> by);
                memcpy(at, texels + (row * from.width + (x >> by)) * to.texel, to.texel);
            }
}

/* False when memory is out. */
static bool mark(const gtx_asset *source, gtx_asset *out)
{
    const size_t texels = (size_t)texels_of(&out->info), bytes = source->info.height_bits / 8;
    out->marks = gtx_alloc_raw(&out->allocator, texels, 1);
    if (!out->marks)
        return false;
    for (size_t i = 0; i < texels; ++i)
        out->marks[i] = source->height[bytes * i] || source->height[bytes * (i + 1) - 1];
    memset(out->trim, GTX_FAR_TRIM, texels);
    return true;
}

gtx_asset *gtx_preview_new(const gtx_asset *source, const gtx_info *preview, uint32_t shift,
                           const int levels[GTX_SECTION_META + 1])
{
    gtx_sizes sizes = {0};
    for (uint32_t k = 0; k < preview->lod_levels; ++k)
        sizes.lod[k] = source->lod_size[k];
    gtx_asset *out = gtx_asset_new(&source->allocator, preview, &sizes, true);
    if (!out)
        return NULL;
    for (uint32_t i = 0; i < preview->patch_count; ++i) {
        gtx_patch *patch = &out->patches[i];
        *patch = source->patches[i];
        patch->coverage = 0;
        patch->dilation = (uint16_t)(patch->dilation >> shift);
        for (int k = 0; k < 4; ++k)
            patch->rect[k] = (uint16_t)(patch->rect[k] >> shift);
    }
    for (uint32_t k = 0; k < preview->lod_levels; ++k)
        memcpy(out->lod[k], source->lod[k], out->lod_size[k]);
    const bool has_normals = levels[GTX_SECTION_NORMAL] >= 0;
    for (int kind = GTX_SECTION_FIRST_IMAGE; kind <= GTX_SECTION_LAST_IMAGE; ++kind)
        for (uint32_t k = 0; k < preview->mip_count && levels[kind] >= 0 &&
                             kind != GTX_SECTION_HEIGHT; ++k)
            copy_image(source, out, (gtx_section_kind)kind, k, (uint32_t)levels[kind], shift);
    out->bare = true;
    if (!(has_normals ? mark(source, out) : shape(out))) {
        gtx_close(out);
        return NULL;
    }
    gtx_section sections[GTX_MAX_KNOWN_SECTIONS];
    out->info.content_hash = gtx_content_hash(sections, gtx_asset_sections(out, sections));
    return out;
}
