/* What a camera sees of patches and slabs: the records that geotex_tiles.glsl reads. */
#include "render/patch_view.h"

#include "asset/patch.h"

#include <math.h>

static double dot4(const double row[4], const double p[3], double w)
{
    return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3] * w;
}

/* Inverts the rows: origin and columns. */
static void invert(gtx_camera_rows *c)
{
    double inverse[3][4];
    gtx_invert_affine(c->row, inverse);
    for (int k = 0; k < 3; ++k) {
        c->origin[k] = inverse[k][3];
        for (int r = 0; r < 3; ++r)
            c->column[r][k] = inverse[k][r];
    }
}

gtx_camera_rows gtx_sight_camera_of(const gtx_view *view, const gtx_frame *frame,
                                    const gtx_instance_data *placed, float place[PLACE_ROWS][4])
{
    gtx_camera_rows c = {.perspective = frame->depth[3] > 0, .width = view->viewport_width,
                         .height = view->viewport_height};
    const double half[2] = {c.width / 2.0, c.height / 2.0};
    double clip[4][4] = {{0}};
    for (int r = 0; r < 4; ++r) {
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i)
                clip[r][k] += (double)frame->clip_from_world[4 * i + r] * placed->world[i][k];
        clip[r][3] += frame->clip_from_world[12 + r];
    }
    const double w = c.perspective ? 1 : clip[3][3], sign = frame->reversed ? -1 : 1;
    for (int k = 0; k < 4; ++k) {
        c.row[0][k] = (clip[0][k] + clip[3][k]) * half[0] / w;
        c.row[1][k] = (clip[1][k] + clip[3][k]) * half[1] / w;
        c.row[2][k] = c.perspective ? clip[3][k] : sign * clip[2][k] / w;
    }
    invert(&c);
    for (int k = 0; k < 3; ++k) {
        place[PLACE_ORIGIN][k] = (float)c.origin[k];
        for (int r = 0; r < 3; ++r)
            place[PLACE_X + r][k] = (float)c.column[r][k];
        place[PLACE_CLIP_Z][1 + k] = (float)dot4(clip[2], c.column[k], 0);
        memcpy(place[PLACE_WORLD + k], placed->world[k], sizeof place[0]);
    }
    place[PLACE_CLIP_Z][0] = (float)dot4(clip[2], c.origin, 1);
    place[PLACE_CLIP_W][0] = c.perspective ? 0.0f : (float)w;
    place[PLACE_CLIP_W][1] = c.perspective ? 1.0f : 0.0f;
    place[PLACE_CLIP_W][2] = (float)c.width;
    place[PLACE_CLIP_W][3] = (float)c.height;
    return c;
}

static void put(uint32_t out[4], const double xyz[3], uint32_t w)
{
    const float f[3] = {(float)xyz[0], (float)xyz[1], (float)xyz[2]};
    memcpy(out, f, sizeof f);
    out[3] = w;
}

static void normalize(double v[3])
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; ++k)
        v[k] /= length;
}

/* What takes the patch's normals to the world: the columns of gtx_normal_frame, by the transposed
 * inverse of object -> world. */
static void put_normals(const gtx_instance_data *placed, const float (*record)[4],
                        const uint32_t rest[3], uint32_t out[3][4])
{
    double axes[3][3], along = 0;
    for (int k = 0; k < 3; ++k) {
        axes[0][k] = record[4][k];
        axes[2][k] = record[6][k];
    }
    normalize(axes[2]);
    for (int k = 0; k < 3; ++k)
        along += axes[0][k] * axes[2][k];
    for (int k = 0; k < 3; ++k)
        axes[0][k] -= along * axes[2][k];
    normalize(axes[0]);
    for (int k = 0; k < 3; ++k)
        axes[1][k] = axes[2][(k + 1) % 3] * axes[0][(k + 2) % 3] -
                     axes[2][(k + 2) % 3] * axes[0][(k + 1) % 3];
    for (int a = 0; a < 3; ++a) {
        double world[3] = {0};
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i)
                world[k] += (double)placed->object[i][k] * axes[a][i];
        put(out[a], world, rest[a]);
    }
}

gtx_sight gtx_sight_of(const gtx_camera_rows *c, const gtx_model *model,
                       const gtx_instance_data *placed, const gtx_plan_entry *entry,
                       uint32_t out[GTX_TILE_RECORD_TEXELS][4])
{
    const float (*record)[4] = (const float (*)[4])model->records[entry->patch];
    const uint32_t slot = entry->level * model->patch_count + entry->patch;
    gtx_sight s = {.slabs = model->slabs + model->first_slab[slot],
                   .count = model->first_slab[slot + 1] - model->first_slab[slot],
                   .patch = entry->patch, .level = entry->level,
                   .two_sided = record[6][3] > 0, .perspective = c->perspective};
    double volume = 0;
    for (int k = 0; k < 3; ++k) {
        const double row[4] = {record[k][0], record[k][1], record[k][2], record[k][3]};
        s.rays[0][k] = dot4(row, c->origin, 1);
        s.rays[1][k] = dot4(row, c->column[2], 0);
        s.rays[2][k] = dot4(row, c->column[0], 0);
        s.rays[3][k] = dot4(row, c->column[1], 0);
        for (int a = 0; a < 4; ++a) { /* record[3] is the origin, then the axes */
            const double p[3] = {record[3 + a][0], record[3 + a][1], record[3 + a][2]};
            s.row[k][(a + 3) % 4] = (float)dot4(c->row[k], p, a == 0);
        }
    }
    for (int k = 0; k < 3; ++k)
        volume += s.rays[1][k] * (s.rays[2][(k + 1) % 3] * s.rays[3][(k + 2) % 3] -
                                  s.rays[2][(k + 2) % 3] * s.rays[3][(k + 1) % 3]);
    const uint32_t rest[4] = {
        (uint32_t)record[7][0] | (uint32_t)record[7][1] << 16,
        (uint32_t)record[7][2] | (uint32_t)record[7][3] << 16,
        (uint32_t)record[5][3] | entry->level << 24 | (uint32_t)s.two_sided << 31, 0};
    for (int i = 0; i < 4; ++i)
        put(out[i], s.rays[i], rest[i]);
    put_normals(placed, record, rest, out + 4);
    out[7][0] = entry->patch;
    out[7][1] = gtx_bits_of(fabs(volume));
    return s;
}

/* One pair of a slab's planes, which bound a linear function over grid space: its values along the
 * columns of rays, and the bounds. See gtx_meets in geotex_tiles.glsl. */
static void put_planes(const double value[4], double low, double high, bool perspective,
                       uint32_t out[4])
{
    const double a = low - value[0], b = high - value[0];
    if (perspective) {
        const double far = fabs(a) > fabs(b) ? a : b, near = fabs(a) > fabs(b) ? b : a;
        const double per = 1 / far, most = 1e30, other = far / near;
        const double linear[3] = {value[2] * per, value[3] * per, value[1] * per};
        put(out, linear, gtx_bits_of(!(other < most) ? most : other < -most ? -most : other));
    } else {
        const double along = copysign(fmax(fabs(value[1]), 1e-20), value[1]);
        const double linear[3] = {-value[2] / along, -value[3] / along,
                                  (along > 0 ? a : b) / along};
        put(out, linear, gtx_bits_of((high - low) / fabs(along)));
    }
}

void gtx_sight_put_slab(const gtx_sight *s, const gtx_slab *slab, uint32_t record_at,
                        uint32_t out[GTX_TILE_SLAB_TEXELS][4])
{
    double value[4];
    memset(out, 0, GTX_TILE_SLAB_TEXELS * sizeof *out);
    for (int k = 0; k < 2; ++k) {
        for (int i = 0; i < 4; ++i)
            value[i] = s->rays[i][k];
        put_planes(value, (double)slab->low[k], (double)slab->high[k], s->perspective, out[k]);
        out[3][0] |= (uint32_t)(slab->low[k] + 0.5f) >> s->level << 16 * k;
        out[3][1] |= ((uint32_t)(slab->high[k] + 0.5f) - 1) >> s->level << 16 * k;
    }
    for (int i = 0; i < 4; ++i)
        value[i] = s->rays[i][2] - (double)slab->slope[0] * s->rays[i][0] -
                   (double)slab->slope[1] * s->rays[i][1];
    put_planes(value, (double)slab->height[0], (double)slab->height[1], s->perspective, out[2]);
    out[3][2] = record_at;
}

static float greatest(const float a[2], const float b[2])
{
    float most = a[0] * b[0];
    for (int i = 1; i < 4; ++i) {
        const float value = a[i >> 1] * b[i & 1];
        most = value > most ? value : most;
    }
    return most;
}

bool gtx_sight_faces_away(const gtx_sight *s, const gtx_slab *slab)
{
    const float o[3] = {(float)s->rays[0][0], (float)s->rays[0][1], (float)s->rays[0][2]};
    const float d[3] = {(float)s->rays[1][0], (float)s->rays[1][1], (float)s->rays[1][2]};
    if (s->two_sided)
        return false;
    if (!s->perspective)
        return d[2] - slab->slope[0] * d[0] - slab->slope[1] * d[1] >
               greatest(slab->rise_x, (float[2]){d[0], d[0]}) +
                   greatest(slab->rise_y, (float[2]){d[1], d[1]});
    const float x[2] = {slab->low[0] - o[0], slab->high[0] - o[0]};
    const float y[2] = {slab->low[1] - o[1], slab->high[1] - o[1]};
    const float z = slab->height[0] - (o[2] - slab->slope[0] * o[0] - slab->slope[1] * o[1]);
    return z > greatest(slab->rise_x, x) + greatest(slab->rise_y, y);
}
