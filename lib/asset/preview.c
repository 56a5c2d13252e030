/* Assets of a file's beginning: the patches and LOD meshes get maps of few texels. A texel's normal
 * lies between those of the corners of the LOD mesh's triangle that it is in: its own, or what its
 * triangles tell; texels without one are filled from around. */
#include "asset/preview.h"

#include "asset/fill.h"
#include "asset/lod.h"
#include "asset/patch.h"
#include "base/alloc.h"

#include <math.h>
#include <string.h>

/* Looks at texels for each of them and each triangle. Five models take at most 2; of hostile files,
 * in which all triangles may lie over all texels, most triangles are left out. */
enum { MAX_LOOKS = 16 };

static uint64_t texels_of(const gtx_info *info)
{
    return (uint64_t)info->page_width * info->page_height * info->page_count;
}

/* Rectangles start and end on multiples of 2^(mip_count - 1): halved once less, all have 2 texels a
 * side; pages must have 8. */
uint32_t gtx_preview_shift(const gtx_info *info, uint64_t texels)
{
    const uint32_t side = info->page_width < info->page_height ? info->page_width
                                                               : info->page_height;
    uint32_t shift = 0;
    while (shift + 2 < info->mip_count && side >> (shift + 1) >= 8 &&
           texels_of(info) >> 2 * shift > texels)
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
    return texels_of(preview) + 3 * sizeof(float) * (uint64_t)vertices;
}

/* ---- normals ---- */

typedef struct shaping {
    gtx_asset *asset;
    gtx_lod_mesh mesh;
    float *normals;               /* 3 per vertex, of any length */
    uint8_t *ring;
    double looks;                 /* at texels that triangles may still take */
    uint32_t rings;               /* of texels around what triangles cover */
} shaping;

/* As many as there are; or, where the forward pass has one level to draw, which it lights at
 * vertices, what lookups between texels of its triangles may meet. */
enum { ALL_RINGS = 128, LIT_RINGS = 2 };

void gtx_mesh_normals(const gtx_lod_mesh *mesh, float *normals)
{
    for (size_t v = 0; v < mesh->vertex_count && mesh->normals; ++v)
        gtx_decode_octahedral(mesh->normals + 2 * v, normals + 3 * v);
    if (mesh->normals)
        return;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const uint32_t *v = mesh->indices + 3 * (size_t)t;
        float side[2][3];
        for (int k = 0; k < 3; ++k)
            for (int e = 0; e < 2; ++e)
                side[e][k] = (float)mesh->positions[3 * (size_t)v[e + 1] + (size_t)k] -
                             (float)mesh->positions[3 * (size_t)v[0] + (size_t)k];
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            const float part = side[0][i] * side[1][j] - side[0][j] * side[1][i];
            for (int c = 0; c < 3; ++c)
                normals[3 * (size_t)v[c] + (size_t)k] += part;
        }
    }
}

/* A corner of a triangle: where it is among the patch's texels. */
typedef struct corner {
    double at[2];
    uint32_t vertex;
} corner;

static corner corner_of(const shaping *s, const gtx_patch_frame *frame, uint32_t vertex)
{
    const uint16_t *q = s->mesh.positions + 3 * (size_t)vertex;
    corner out = {.vertex = vertex};
    for (int a = 0; a < 2; ++a) {
        out.at[a] = frame->to_grid[a][3];
        for (int k = 0; k < 3; ++k)
            out.at[a] += frame->to_grid[a][k] * ((double)s->mesh.origin[k] +
                                                 (double)s->mesh.step * q[k]);
    }
    return out;
}

/* Its normal in the patch's own frame. */
static void normal_at(const shaping *s, float (*rows)[3], const corner *c, float out[3])
{
    const float *n = s->normals + 3 * (size_t)c->vertex;
    const float size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int r = 0; r < 3; ++r) {
        out[r] = 0;
        for (int k = 0; k < 3 && size > 0; ++k)
            out[r] += rows[r][k] * n[k] / size;
    }
}

static double within(double at, double most)
{
    return at > 0 ? at < most ? at : most : 0; /* NaN ends at 0 */
}

static void put_normal(const shaping *s, const gtx_patch *patch, uint32_t x, uint32_t y,
                       const float n[3])
{
    const gtx_info *info = &s->asset->info;
    const size_t row = (size_t)patch->page * info->page_height + patch->rect[1] + y;
    const size_t texel = row * info->page_width + patch->rect[0] + x;
    gtx_encode_normal(n, s->asset->normal[0] + 2 * texel);
    s->ring[texel] = 1;
}

/* The texels whose middles are in the triangle. */
static void put_triangle(shaping *s, const gtx_patch *patch, float (*rows)[3], const corner c[3])
{
    double low[2], high[2], side[2][2];
    float normal[3][3];
    for (int a = 0; a < 2; ++a) {
        const double most = patch->rect[2 + a] - 1;
        low[a] = ceil(within(fmin(fmin(c[0].at[a], c[1].at[a]), c[2].at[a]), most));
        high[a] = floor(within(fmax(fmax(c[0].at[a], c[1].at[a]), c[2].at[a]), most));
        for (int e = 0; e < 2; ++e)
            side[e][a] = c[e + 1].at[a] - c[0].at[a];
    }
    const double area = side[0][0] * side[1][1] - side[0][1] * side[1][0];
    const double looks = fmax(high[0] - low[0] + 1, 0) * fmax(high[1] - low[1] + 1, 0);
    if (looks > s->looks || looks < 1)
        return;
    s->looks -= looks;
    for (int k = 0; k < 3; ++k)
        normal_at(s, rows, &c[k], normal[k]);
    for (double y = low[1]; y <= high[1]; ++y)
        for (double x = low[0]; x <= high[0]; ++x) {
            const double u = x - c[0].at[0], v = y - c[0].at[1];
            const double p = (u * side[1][1] - v * side[1][0]) / area;
            const double q = (side[0][0] * v - side[0][1] * u) / area;
            if (!(p >= 0 && q >= 0 && p + q <= 1))
                continue;
            float n[3];
            for (int k = 0; k < 3; ++k)
                n[k] = (float)(1 - p - q) * normal[0][k] + (float)p * normal[1][k] +
                       (float)q * normal[2][k];
            put_normal(s, patch, (uint32_t)x, (uint32_t)y, n);
        }
}

/* Where no triangle lies on a corner's texel, as one that comes later may. */
static void put_corner(const shaping *s, const gtx_patch *patch, float (*rows)[3],
                       const corner *c)
{
    const gtx_info *info = &s->asset->info;
    uint32_t at[2];
    float n[3];
    for (int a = 0; a < 2; ++a)
        at[a] = (uint32_t)(within(c->at[a], patch->rect[2 + a] - 1) + 0.5);
    const size_t row = (size_t)patch->page * info->page_height + patch->rect[1] + at[1];
    if (s->ring[row * info->page_width + patch->rect[0] + at[0]])
        return;
    normal_at(s, rows, c, n);
    put_normal(s, patch, at[0], at[1], n);
}

static void shape_patch(shaping *s, uint32_t index)
{
    const gtx_info *info = &s->asset->info;
    const gtx_patch *patch = &s->asset->patches[index];
    const gtx_patch_frame frame = gtx_patch_frame_of(patch, info->height_bits);
    float rows[3][3];
    gtx_normal_frame(patch, rows);
    for (uint32_t t = s->mesh.first[index]; t < s->mesh.first[index + 1]; ++t) {
        corner c[3];
        for (size_t k = 0; k < 3; ++k)
            c[k] = corner_of(s, &frame, s->mesh.indices[3 * (size_t)t + k]);
        for (int k = 0; k < 3; ++k)
            put_corner(s, patch, rows, &c[k]);
        put_triangle(s, patch, rows, c);
    }
    const size_t row = (size_t)patch->page * info->page_height + patch->rect[1];
    const size_t first = row * info->page_width + patch->rect[0];
    const gtx_fill area = {s->asset->normal[0] + 2 * first, s->ring + first, info->page_width,
                           patch->rect[2], patch->rect[3]};
    gtx_fill_normals(&area, s->rings);
}

/* False when memory is out. */
static bool shape(gtx_asset *asset)
{
    const size_t texels = (size_t)texels_of(&asset->info);
    const gtx_info *info = &asset->info;
    const bool lit = info->lod_levels == 1 && !info->has_color && !info->has_material &&
                     !info->has_emission;
    shaping s = {.asset = asset, .rings = lit ? LIT_RINGS : ALL_RINGS};
    gtx_get_lod_mesh(asset, 0, &s.mesh);
    const gtx_allocator *hooks = &asset->allocator;
    s.normals = gtx_alloc_array(hooks, s.mesh.vertex_count, 3 * sizeof *s.normals);
    s.ring = gtx_alloc_array(hooks, texels, 1);
    s.looks = MAX_LOOKS * ((double)texels + (double)s.mesh.triangle_count);
    const bool whole = s.normals && s.ring;
    if (whole) {
        memset(asset->normal[0], GTX_FAR_NORMAL, 2 * texels);
        memset(asset->trim, GTX_FAR_TRIM, texels);
        gtx_mesh_normals(&s.mesh, s.normals);
        for (uint32_t i = 0; i < asset->info.patch_count; ++i)
            shape_patch(&s, i);
    }
    gtx_free_array(hooks, s.normals, s.mesh.vertex_count, 3 * sizeof *s.normals);
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
