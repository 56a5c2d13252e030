/* Patch view set-up: the records of patches and slabs that geotex_tiles.glsl reads. */
#include "frame/patch_view.h"

#include "asset/patch.h"

#include <math.h>

static double dot4(const double row[4], const double p[3], double w)
{
    return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3] * w;
}

/* The rays are columns of the rows' inverse. */
static void set_rays(gtx_camera_rows *c)
{
    static const int column[RAY_PARTS] = {
        [RAY_ORIGIN] = 3, [RAY_DIRECTION] = 2, [RAY_X] = 0, [RAY_Y] = 1};
    double inverse[3][4];
    gtx_invert_affine(c->row, inverse);
    for (int i = 0; i < RAY_PARTS; ++i)
        for (int k = 0; k < 3; ++k)
            c->rays[i][k] = inverse[k][column[i]];
}

/* gtx_place, but for where the heads are. `clip_z` and `w` are of the clip position. */
static void fill_place(const gtx_camera_rows *c, const gtx_instance_data *placed,
                       const double clip_z[4], double w, float place[GTX_PLACE_ROWS][4])
{
    static const int rows[RAY_PARTS] = {
        [RAY_ORIGIN] = GTX_PLACE_ORIGIN, [RAY_DIRECTION] = GTX_PLACE_DIRECTION,
        [RAY_X] = GTX_PLACE_X, [RAY_Y] = GTX_PLACE_Y};
    float *z = place[GTX_PLACE_CLIP_Z], *viewport = place[GTX_PLACE_VIEWPORT];
    for (int i = 0; i < RAY_PARTS; ++i)
        for (int k = 0; k < 3; ++k)
            place[rows[i]][k] = (float)c->rays[i][k];
    z[0] = (float)dot4(clip_z, c->rays[RAY_ORIGIN], 1);
    z[1] = (float)dot4(clip_z, c->rays[RAY_X], 0);
    z[2] = (float)dot4(clip_z, c->rays[RAY_Y], 0);
    z[3] = (float)dot4(clip_z, c->rays[RAY_DIRECTION], 0);
    place[GTX_PLACE_CLIP_W][0] = c->perspective ? 0.0f : (float)w;
    place[GTX_PLACE_CLIP_W][1] = c->perspective ? 1.0f : 0.0f;
    viewport[2] = (float)c->width;
    viewport[3] = (float)c->height;
    memcpy(place[GTX_PLACE_WORLD], placed->world, sizeof placed->world);
}

gtx_camera_rows gtx_camera_rows_of(const gtx_draw_call *draw, const gtx_instance_data *placed,
                                   float place[GTX_PLACE_ROWS][4])
{
    const gtx_sight *sight = &draw->sight;
    gtx_camera_rows c = {.perspective = sight->depth[3] > 0,
                         .width = draw->view->viewport_width,
                         .height = draw->view->viewport_height};
    const double half[2] = {c.width / 2.0, c.height / 2.0};
    double clip[4][4] = {{0}};
    for (int r = 0; r < 4; ++r) {
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i)
                clip[r][k] += (double)sight->clip_from_world[4 * i + r] * placed->world[i][k];
        clip[r][3] += sight->clip_from_world[12 + r];
    }
    const double w = c.perspective ? 1 : clip[3][3], sign = sight->reversed ? -1 : 1;
    for (int k = 0; k < 4; ++k) {
        c.row[0][k] = (clip[0][k] + clip[3][k]) * half[0] / w;
        c.row[1][k] = (clip[1][k] + clip[3][k]) * half[1] / w;
        c.row[2][k] = c.perspective ? clip[3][k] : sign * clip[2][k] / w;
        c.near[k] = sight->reversed ? clip[3][k] - clip[2][k]
                                    : clip[2][k] + (double)sight->depth[0] * clip[3][k];
    }
    set_rays(&c);
    fill_place(&c, placed, clip[2], w, place);
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
                        const uint32_t field[3], uint32_t out[3][4])
{
    double axes[3][3], along = 0;
    for (int k = 0; k < 3; ++k) {
        axes[0][k] = record[GTX_RECORD_AXIS_X][k];
        axes[2][k] = record[GTX_RECORD_AXIS_Z][k];
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
        put(out[a], world, field[a]);
    }
}

/* The volume that direction, x and y span. */
static double volume_of(const double rays[RAY_PARTS][3])
{
    const double *d = rays[RAY_DIRECTION], *x = rays[RAY_X], *y = rays[RAY_Y];
    double volume = 0;
    for (int k = 0; k < 3; ++k)
        volume += d[k] * (x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3]);
    return fabs(volume);
}

/* A byte a mip level from 1 on; 255 is 0.5. */
static void put_deviation(const float (*deviation)[4], uint32_t out[2])
{
    out[0] = out[1] = 0;
    for (uint32_t k = 1; k < 8; ++k) {
        const float value = deviation[k / 4][k % 4];
        out[(k - 1) / 4] |= (uint32_t)(510 * value + 0.5f) << 8 * ((k - 1) % 4);
    }
}

static void put_patch(const gtx_patch_view *v, const float (*record)[4],
                      const gtx_instance_data *placed, gtx_tile_patch out)
{
    const float *rect = record[GTX_RECORD_RECT];
    const uint32_t page = (uint32_t)record[GTX_RECORD_PAGE][3];
    const uint32_t field[RAY_PARTS] = {
        [GTX_TILE_FIELD_CORNER] = (uint32_t)rect[0] | (uint32_t)rect[1] << 16,
        [GTX_TILE_FIELD_SIZE] = (uint32_t)rect[2] | (uint32_t)rect[3] << 16,
        [GTX_TILE_FIELD_PAGE] = page | v->level << GTX_TILE_LEVEL_SHIFT |
                                (uint32_t)v->two_sided << GTX_TILE_TWO_SIDED_SHIFT};
    for (int i = 0; i < RAY_PARTS; ++i)
        put(out[GTX_TILE_PATCH_RAYS + i], v->rays[i], field[i]);
    put_normals(placed, record, field, out + GTX_TILE_PATCH_NORMALS);
    out[GTX_TILE_PATCH_INDEX][0] = v->patch;
    out[GTX_TILE_PATCH_VOLUME][1] = gtx_bits_of(volume_of(v->rays));
    put_deviation(record + GTX_RECORD_DEVIATION, out[GTX_TILE_PATCH_DEVIATION] + 2);
}

void gtx_camera_over_patch(const gtx_camera_rows *c, const float (*record)[4], gtx_patch_view *v)
{
    for (int a = 0; a < 4; ++a) { /* the origin, then the axes */
        const float *from = record[GTX_RECORD_ORIGIN + a];
        const double p[3] = {from[0], from[1], from[2]};
        for (int k = 0; k < 3; ++k)
            v->row[k][(a + 3) % 4] = (float)dot4(c->row[k], p, a == 0);
        v->near[(a + 3) % 4] = (float)dot4(c->near, p, a == 0);
    }
}

gtx_patch_view gtx_patch_view_of(const gtx_camera_rows *c, const gtx_model *model,
                                 const gtx_instance_data *placed, const gtx_plan_entry *entry,
                                 gtx_tile_patch out)
{
    const float (*record)[4] = (const float (*)[4])model->records[entry->patch];
    const uint32_t slot = entry->level * model->patch_count + entry->patch;
    gtx_patch_view v = {.slabs = model->slabs + model->first_slab[slot],
                        .count = model->first_slab[slot + 1] - model->first_slab[slot],
                        .patch = entry->patch, .level = entry->level,
                        .two_sided = record[GTX_RECORD_TWO_SIDED][3] > 0,
                        .perspective = c->perspective};
    gtx_camera_over_patch(c, record, &v);
    for (int k = 0; k < 3; ++k) {
        const float *to_grid = record[GTX_RECORD_TO_GRID + k];
        const double row[4] = {to_grid[0], to_grid[1], to_grid[2], to_grid[3]};
        for (int i = 0; i < RAY_PARTS; ++i)
            v.rays[i][k] = dot4(row, c->rays[i], i == RAY_ORIGIN);
    }
    put_patch(&v, record, placed, out);
    return v;
}

/* One pair of a slab's planes, which bound a linear function over grid space: its values along the
 * columns of rays, and the bounds. See gtx_meets in geotex_tiles.glsl. */
static void put_planes(const double value[RAY_PARTS], double low, double high, bool perspective,
                       uint32_t out[4])
{
    const double a = low - value[RAY_ORIGIN], b = high - value[RAY_ORIGIN];
    if (perspective) {
        const double far = fabs(a) > fabs(b) ? a : b, near = fabs(a) > fabs(b) ? b : a;
        const double per = 1 / far, most = 1e30, other = far / near;
        const double linear[3] = {value[RAY_X] * per, value[RAY_Y] * per,
                                  value[RAY_DIRECTION] * per};
        put(out, linear, gtx_bits_of(!(other < most) ? most : other < -most ? -most : other));
    } else {
        const double d = value[RAY_DIRECTION], along = copysign(fmax(fabs(d), 1e-20), d);
        const double linear[3] = {-value[RAY_X] / along, -value[RAY_Y] / along,
                                  (along > 0 ? a : b) / along};
        put(out, linear, gtx_bits_of((high - low) / fabs(along)));
    }
}

void gtx_patch_view_put_slab(const gtx_patch_view *v, const gtx_slab *slab, uint32_t patch_at,
                             gtx_tile_slab out)
{
    uint32_t *cells = out[GTX_TILE_SLAB_CELLS];
    double value[RAY_PARTS];
    memset(out, 0, sizeof(gtx_tile_slab));
    for (int k = 0; k < 2; ++k) {
        for (int i = 0; i < RAY_PARTS; ++i)
            value[i] = v->rays[i][k];
        put_planes(value, (double)slab->low[k], (double)slab->high[k], v->perspective,
                   out[GTX_TILE_SLAB_PLANES + k]);
        cells[0] |= (uint32_t)(slab->low[k] + 0.5f) >> v->level << 16 * k;
        cells[1] |= ((uint32_t)(slab->high[k] + 0.5f) - 1) >> v->level << 16 * k;
    }
    for (int i = 0; i < RAY_PARTS; ++i)
        value[i] = v->rays[i][2] - (double)slab->slope[0] * v->rays[i][0] -
                   (double)slab->slope[1] * v->rays[i][1];
    put_planes(value, (double)slab->height[0], (double)slab->height[1], v->perspective,
               out[GTX_TILE_SLAB_PLANES + 2]);
    cells[2] = patch_at;
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

bool gtx_patch_view_faces_away(const gtx_patch_view *v, const gtx_slab *slab)
{
    float o[3], d[3];
    for (int k = 0; k < 3; ++k) {
        o[k] = (float)v->rays[RAY_ORIGIN][k];
        d[k] = (float)v->rays[RAY_DIRECTION][k];
    }
    if (v->two_sided)
        return false;
    if (!v->perspective)
        return d[2] - slab->slope[0] * d[0] - slab->slope[1] * d[1] >
               greatest(slab->rise_x, (float[2]){d[0], d[0]}) +
                   greatest(slab->rise_y, (float[2]){d[1], d[1]});
    const float x[2] = {slab->low[0] - o[0], slab->high[0] - o[0]};
    const float y[2] = {slab->low[1] - o[1], slab->high[1] - o[1]};
    const float z = slab->height[0] - (o[2] - slab->slope[0] * o[0] - slab->slope[1] * o[1]);
    return z > greatest(slab->rise_x, x) + greatest(slab->rise_y, y);
}
