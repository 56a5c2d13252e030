/* Normals of the vertices of LOD meshes, where the file has none, and whether normals are enough to
 * be lit by. */
#include "frame/lod.h"

#include "asset/patch.h"
#include "asset/preview.h"
#include "base/alloc.h"
#include "base/vec.h"

#include <math.h>
#include <string.h>

/* The root of the mean square of the angle between normals as vertices give them and those of the
 * map, up to which a level is lit at its vertices. PSNR inside the outline to 8x8 samples, bunny at
 * 640x480: 40.1 dB instead of 43.5 at 2.8 degrees, 34.6 instead of 41.9 at 6; with the outline,
 * 28.0 instead of 28.1, as the mesh has, and 27.6 instead of 28.3. At 2 it is no scan but coarse
 * ones. */
static const double most_degrees = 4;

/* Levels of fewer triangles than such a share of the source's leave to the maps what is seen near
 * by. A ninth is what large models have. */
static const double least_share = 1.0 / 3;

/* A level whose bound is at most so many texels strays no farther than height fields do, and is
 * drawn however near: the farthest points found (gtx cook --report) of the bunny's, horse's and
 * armadillo's are .9 to 1.7 texels away, of their levels .3 to 1.6. At half the horse's is drawn no
 * more, whose near views then take twice as long. */
static const double exact_texels = 1.7;

static const double degrees = 57.29577951308232;

/* One triangle of so many is looked at. */
enum { EACH = 4 };

/* Of a patch: what takes points to its texels, and normals from there. */
typedef struct look_place {
    gtx_patch_frame frame;
    float rows[3][3];
    const gtx_patch *patch;
} look_place;

static look_place place_of(const gtx_asset *asset, uint32_t patch)
{
    const gtx_patch *p = &asset->patches[patch];
    look_place out = {.frame = gtx_patch_frame_of(p, asset->info.height_bits), .patch = p};
    gtx_normal_frame(p, out.rows);
    return out;
}

/* Bilinear, of codes, as shaders look it up; not of unit length. */
static gtx_vec3 look_up(const gtx_asset *asset, const look_place *at, const double point[3])
{
    const uint16_t *rect = at->patch->rect;
    uint32_t first[2], next[2];
    float share[2], code[2];
    for (int k = 0; k < 2; ++k) {
        const double *row = at->frame.to_grid[k];
        const double texel = row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3];
        const double within = fmin(fmax(texel, 0), rect[2 + k] - 1.0);
        first[k] = (uint32_t)within;
        next[k] = first[k] + 1 < rect[2 + k] ? first[k] + 1 : first[k];
        share[k] = (float)(within - first[k]);
    }
    const size_t width = asset->info.page_width;
    const size_t page = at->patch->page * (size_t)asset->info.page_height + rect[1];
    const uint8_t *low = asset->normal[0] + 2 * ((page + first[1]) * width + rect[0]);
    const uint8_t *high = asset->normal[0] + 2 * ((page + next[1]) * width + rect[0]);
    for (int k = 0; k < 2; ++k) {
        const size_t left = 2 * (size_t)first[0] + (size_t)k;
        const size_t right = 2 * (size_t)next[0] + (size_t)k;
        const float a = (float)low[left] + share[0] * ((float)low[right] - (float)low[left]);
        const float b = (float)high[left] + share[0] * ((float)high[right] - (float)high[left]);
        code[k] = (a + share[1] * (b - a)) / 127.5f - 1;
    }
    const float p = (code[0] + code[1]) / 2, q = (code[0] - code[1]) / 2;
    const float r = 1 - fabsf(p) - fabsf(q);
    float n[3];
    for (int k = 0; k < 3; ++k)
        n[k] = p * at->rows[0][k] + q * at->rows[1][k] + r * at->rows[2][k];
    return gtx_v3(n[0], n[1], n[2]);
}

/* Two bytes, as geotex_lod.vert reads them. */
static uint16_t encode(gtx_vec3 n)
{
    const float v[3] = {n.x, n.y, n.z};
    uint8_t code[2];
    gtx_encode_octahedral(v, code);
    return (uint16_t)(code[0] | code[1] << 8);
}

static gtx_vec3 decode(uint16_t code)
{
    const uint8_t bytes[2] = {(uint8_t)code, (uint8_t)(code >> 8)};
    float n[3];
    gtx_decode_octahedral(bytes, n);
    return gtx_v3_load(n);
}

static void point_of(const gtx_lod_level *level, const gtx_lod_vertex *v, double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = (double)level->place[k] + (double)level->place[3] * v->position[k];
}

static gtx_lod_vertex *vertices_of(const gtx_lod_meshes *lods, const gtx_lod_level *level)
{
    return (gtx_lod_vertex *)(void *)(lods->vertices + level->vertex_offset);
}

static const gtx_lod_vertex *corner_of(const gtx_lod_meshes *lods, const gtx_lod_level *level,
                                       const gtx_lod_run *run, uint32_t at)
{
    const uint8_t *index = lods->indices + level->index_offset + (size_t)at * level->index_size;
    uint16_t narrow;
    uint32_t wide;
    memcpy(&narrow, index, sizeof narrow);
    if (level->index_size == sizeof wide)
        memcpy(&wide, index, sizeof wide);
    else
        wide = narrow;
    return vertices_of(lods, level) + run->first_vertex + wide;
}

/* Adds the square of the angle in a triangle's middle, by its area. */
static void add_angle(const gtx_asset *asset, const look_place *at, const gtx_lod_level *level,
                      const gtx_lod_vertex *const corner[3], double *sum, double *area)
{
    double p[3][3], middle[3], square = 0;
    gtx_vec3 mean = gtx_v3(0, 0, 0);
    for (int c = 0; c < 3; ++c) {
        point_of(level, corner[c], p[c]);
        mean = gtx_v3_add(mean, decode(corner[c]->normal));
    }
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        middle[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
        square += pow((p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) -
                          (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]), 2);
    }
    const gtx_vec3 there = look_up(asset, at, middle);
    const double cosine = (double)gtx_v3_dot(gtx_v3_normalize(mean), gtx_v3_normalize(there));
    const double angle = acos(fmax(-1, fmin(cosine, 1)));
    *sum += sqrt(square) * angle * angle;
    *area += sqrt(square);
}

/* Of a level's normals to those of the map, the root of the mean square, degrees. */
static double stray_of(const gtx_asset *asset, const gtx_lod_meshes *lods,
                       const gtx_lod_level *level)
{
    double sum = 0, area = 0;
    uint32_t from = 0, patch = lods->patch_count;
    look_place at = {.patch = NULL};
    for (const gtx_lod_run *run = level->runs; run < level->runs + level->run_count; ++run) {
        for (uint32_t t = from; t < run->end; t += EACH) {
            const gtx_lod_vertex *corner[3];
            for (uint32_t c = 0; c < 3; ++c)
                corner[c] = corner_of(lods, level, run, 3 * t + c);
            if (corner[0]->patch != patch)
                at = place_of(asset, corner[0]->patch);
            patch = corner[0]->patch;
            add_angle(asset, &at, level, corner, &sum, &area);
        }
        from = run->end;
    }
    return area > 0 ? sqrt(sum / area) * degrees : 180;
}

/* The side of a texel, in the mean of all patches. */
static double texel_of(const gtx_asset *asset)
{
    double area = 0, texels = 0;
    for (uint32_t p = 0; p < asset->info.patch_count; ++p) {
        const gtx_patch *patch = &asset->patches[p];
        area += (double)patch->extent_x * (double)patch->extent_y;
        texels += (double)patch->rect[2] * patch->rect[3];
    }
    return sqrt(area / texels);
}

static bool tells_all(const gtx_asset *asset, const gtx_lod_level *level)
{
    return level->triangle_count >= least_share * (double)asset->info.source_triangles;
}

/* What a file's beginning has for maps is made of its finest level, and says no more than this has
 * at its vertices, but more than triangles of coarser ones do: a bunny of 2 pixels' error, by those
 * of the level that is drawn, is 1.8 dB farther from its mesh. Of others coarser levels are seen
 * from so far that maps have to be averaged. */
bool gtx_lod_may_be_lit(const gtx_asset *asset, uint32_t k, const gtx_lod_meshes *lods)
{
    const gtx_info *info = &asset->info;
    const gtx_lod_level *level = &lods->levels[k];
    if (info->has_color || info->has_material || info->has_emission)
        return false;
    gtx_lod_mesh source;
    gtx_get_lod_mesh(asset, k, &source);
    if (asset->bare && !asset->marks)
        return k == 0 || source.normals;
    if (lods->light_vertices && source.normals && !level->far)
        return true;
    return k == 0 && !level->far &&
           (asset->bare ? source.normals != NULL : tells_all(asset, level));
}

uint8_t *gtx_lod_normals(const gtx_asset *asset, uint32_t k, const gtx_lod_mesh *source,
                         const gtx_allocator *allocator)
{
    if (!asset->bare || asset->marks || source->normals || k)
        return NULL;
    const size_t count = source->vertex_count;
    float *normals = gtx_alloc_array(allocator, count, 3 * sizeof *normals);
    uint8_t *codes = normals ? gtx_alloc_raw(allocator, count, 2) : NULL;
    if (codes)
        gtx_mesh_normals(source, normals);
    for (size_t v = 0; v < count && codes; ++v)
        gtx_encode_octahedral(normals + 3 * v, codes + 2 * v);
    gtx_free_array(allocator, normals, count, 3 * sizeof *normals);
    return codes;
}

void gtx_lod_light(const gtx_asset *asset, uint32_t k, const gtx_lod_mesh *source,
                   gtx_lod_meshes *lods)
{
    gtx_lod_level *level = &lods->levels[k];
    if (!gtx_lod_may_be_lit(asset, k, lods))
        return;
    gtx_lod_vertex *first = vertices_of(lods, level);
    gtx_lod_vertex *end = first + level->vertex_bytes / sizeof *first;
    uint32_t patch = lods->patch_count;
    look_place at = {.patch = NULL};
    for (gtx_lod_vertex *v = first; v < end && !source->normals; ++v) {
        double point[3];
        if (v->patch != patch)
            at = place_of(asset, v->patch);
        patch = v->patch;
        point_of(level, v, point);
        v->normal = encode(look_up(asset, &at, point));
    }
    const double stray = asset->bare ? 0
                         : source->normals ? degrees * (double)source->normal_error
                                          : stray_of(asset, lods, level);
    level->lit = stray <= most_degrees;
    if (level->lit && k == 0 && !asset->bare && tells_all(asset, level) &&
        (double)level->error <= exact_texels * texel_of(asset))
        level->error = 0;
}
