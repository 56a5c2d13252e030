/* The rules of LOD meshes (format/gtx.md, section 6). */
#include "asset/check.h"

#include "asset/lod.h"
#include "base/bytes.h"

#include <inttypes.h>
#include <math.h>

/* A level and where its bytes are. */
typedef struct walk {
    gtx_check *check;
    const gtx_asset *asset;
    gtx_lod_mesh lod;
    uint32_t level;
    uint64_t offset;
} walk;

static void check_header(const walk *w)
{
    const gtx_lod_mesh *s = &w->lod;
    for (uint32_t k = 0; k < 3; ++k)
        if (!isfinite(s->origin[k]))
            gtx_break(w->check, GTX_RULE_LOD_HEADER, w->offset + 4 * k,
                      "component %u of its origin is %g", k, (double)s->origin[k]);
    if (!(s->step > 0) || !isfinite(s->step))
        gtx_break(w->check, GTX_RULE_LOD_HEADER, w->offset + 12, "its step is %g",
                  (double)s->step);
    if (!(s->error >= 0) || !isfinite(s->error))
        gtx_break(w->check, GTX_RULE_LOD_HEADER, w->offset + 16, "its error is %g",
                  (double)s->error);
    if (s->flags & ~(uint32_t)(GTX_LOD_FAR | GTX_LOD_NORMALS))
        gtx_break(w->check, GTX_RULE_LOD_HEADER, w->offset + 28, "its flags are 0x%08x",
                  s->flags);
    if (!(s->normal_error >= 0 && s->normal_error <= 2))
        gtx_break(w->check, GTX_RULE_LOD_NORMALS,
                  w->offset + w->asset->lod_size[w->level] - 4, "their error is %g",
                  (double)s->normal_error);
    if (s->normals && !gtx_lod_may_have_normals(s->vertex_count, s->triangle_count))
        gtx_break(w->check, GTX_RULE_LOD_NORMALS, w->offset + 20, "%u vertices have them, of %u "
                  "triangles", s->vertex_count, s->triangle_count);
}

static void check_first(const walk *w)
{
    const uint32_t *first = w->lod.first, patches = w->asset->info.patch_count;
    for (uint32_t p = 0; p <= patches; ++p) {
        bool right = p ? first[p] >= first[p - 1] : first[p] == 0;
        if (p == patches)
            right = right && first[p] == w->lod.triangle_count;
        if (right)
            continue;
        gtx_break(w->check, GTX_RULE_LOD_FIRST, w->offset + GTX_LOD_HEADER + 4 * (uint64_t)p,
                  "number %u of %u is %u", p, patches, first[p]);
        return;
    }
}

static uint64_t offset_of_indices(const walk *w)
{
    return w->offset + GTX_LOD_HEADER + 4 * ((uint64_t)w->asset->info.patch_count + 1);
}

static void check_indices(const walk *w)
{
    const uint64_t at = offset_of_indices(w);
    uint32_t met = 0;
    for (uint32_t t = 0; t < w->lod.triangle_count; ++t) {
        const uint32_t *index = w->lod.indices + 3 * (size_t)t;
        bool right = index[0] != index[1] && index[1] != index[2] && index[2] != index[0];
        for (int k = 0; k < 3; ++k) {
            right = right && index[k] <= met && index[k] < w->lod.vertex_count;
            met += index[k] == met;
        }
        if (right)
            continue;
        gtx_break(w->check, GTX_RULE_LOD_INDEX, at + 12 * (uint64_t)t,
                  "triangle %u has %u, %u and %u after %u vertices", t, index[0], index[1],
                  index[2], met);
        return;
    }
    if (met != w->lod.vertex_count)
        gtx_break(w->check, GTX_RULE_LOD_INDEX, w->offset + 20, "%u of %u vertices are in use",
                  met, w->lod.vertex_count);
}

/* What gives a point's texel coordinate along an axis of a patch: dot(row, point) + shift. */
typedef struct coordinate {
    double row[3], shift, most;
} coordinate;

static coordinate coordinate_of(const gtx_patch *patch, int axis)
{
    const float *across = axis ? patch->axis_x : patch->axis_y, *z = patch->axis_z;
    const float *along = axis ? patch->axis_y : patch->axis_x;
    double row[3], size = axis ? (double)patch->extent_y : (double)patch->extent_x, det = 0;
    for (int k = 0; k < 3; ++k) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        row[k] = (double)across[i] * (double)z[j] - (double)across[j] * (double)z[i];
        det += row[k] * (double)along[k];
    }
    coordinate out = {.most = patch->rect[2 + axis]};
    for (int k = 0; k < 3; ++k) {
        out.row[k] = row[k] * out.most / (det * size);
        out.shift -= out.row[k] * (double)patch->origin[k];
    }
    return out;
}

static bool is_beside(const walk *w, const coordinate along[2], uint32_t vertex)
{
    const uint16_t *q = w->lod.positions + 3 * (size_t)vertex;
    for (int axis = 0; axis < 2; ++axis) {
        double at = along[axis].shift;
        for (int k = 0; k < 3; ++k)
            at += along[axis].row[k] *
                  ((double)w->lod.origin[k] + (double)w->lod.step * q[k]);
        if (!(at >= -1 && at <= along[axis].most + 1))
            return false;
    }
    return true;
}

static void check_places(const walk *w)
{
    const uint64_t at = offset_of_indices(w);
    for (uint32_t p = 0; p < w->asset->info.patch_count; ++p) {
        const gtx_patch *patch = &w->asset->patches[p];
        const coordinate along[2] = {coordinate_of(patch, 0), coordinate_of(patch, 1)};
        for (uint64_t i = 3 * (uint64_t)w->lod.first[p]; i < 3 * (uint64_t)w->lod.first[p + 1];
             ++i) {
            if (is_beside(w, along, w->lod.indices[i]))
                continue;
            gtx_break(w->check, GTX_RULE_LOD_PLACE, at + 4 * i,
                      "triangle %" PRIu64 " is not on patch %u", i / 3, p);
            return;
        }
    }
}

void gtx_check_lod(gtx_check *check, const gtx_asset *asset, uint32_t level, uint64_t offset)
{
    const uint32_t patches = asset->info.patch_count;
    const uint8_t *bytes = asset->lod[level];
    walk w = {.check = check, .asset = asset, .level = level, .offset = offset};
    bool sized = gtx_lod_load(bytes, asset->lod_size[level], patches, &w.lod);
    if (!sized || !w.lod.triangle_count || w.lod.vertex_count > GTX_MAX_LOD_VERTICES) {
        gtx_break(check, GTX_RULE_LOD_SIZE, offset + 20, "level %u has %zu bytes for %u and %u",
                  level, asset->lod_size[level], w.lod.vertex_count, w.lod.triangle_count);
        return;
    }
    uint64_t before = check->broken;
    check_header(&w);
    gtx_lod_mesh finer;
    if (level > 0 &&
        gtx_lod_load(asset->lod[level - 1], asset->lod_size[level - 1], patches, &finer) &&
        finer.error > w.lod.error)
        gtx_break(check, GTX_RULE_LOD_ORDER, offset + 16, "level %u has %g after %g", level,
                  (double)w.lod.error, (double)finer.error);
    check_first(&w);
    check_indices(&w);
    if (check->broken == before && asset->patches && !(w.lod.flags & GTX_LOD_FAR))
        check_places(&w);
}
