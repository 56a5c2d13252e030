/* Updates texels that are not the patch's own: borrowed ones from their owners, loose ones from
 * those beside them. */
#include "edit/edit.h"

/* The neighbour k of 8 of a texel; false past the height field's end. */
static bool neighbour(const gtx_field_span *field, uint32_t texel, int k, uint32_t *out)
{
    static const int8_t step[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0},
                                      {1, 0},   {-1, 1}, {0, 1},  {1, 1}};
    const int64_t x = (int64_t)(texel % field->width) + step[k][0];
    const int64_t y = (int64_t)(texel / field->width) + step[k][1];
    if (x < 0 || y < 0 || x >= field->width || y >= field->height)
        return false;
    *out = (uint32_t)y * field->width + (uint32_t)x;
    return true;
}

/* Steps from own and borrowed texels, and the loose ones in their order. */
void gtx_edit_order_loose(gtx_edit *edit, gtx_field_span *field)
{
    const uint32_t count = field->width * field->height;
    const uint8_t *kind = edit->kind + field->first;
    uint8_t *ring = edit->ring + field->first;
    uint32_t *loose = edit->loose + field->first_loose, other;
    size_t end = 0;
    for (uint32_t t = 0; t < count; ++t)
        ring[t] = kind[t] == GTX_TEXEL_OWN || kind[t] == GTX_TEXEL_BORROWED ? 0 : UINT8_MAX;
    for (uint32_t t = 0; t < count; ++t)
        for (int k = 0; k < 8 && kind[t] == GTX_TEXEL_LOOSE && ring[t] == UINT8_MAX; ++k)
            if (neighbour(field, t, k, &other) && ring[other] == 0) {
                ring[t] = 1;
                loose[end++] = t;
            }
    for (size_t n = 0; n < end; ++n)
        for (int k = 0; k < 8 && ring[loose[n]] < UINT8_MAX - 1; ++k)
            if (neighbour(field, loose[n], k, &other) && kind[other] == GTX_TEXEL_LOOSE &&
                ring[other] == UINT8_MAX) {
                ring[other] = (uint8_t)(ring[loose[n]] + 1);
                loose[end++] = other;
            }
    field->loose_count = end;
}

/* The mean of the changes beside a loose texel that are nearer to the surface. */
static void follow_beside(const gtx_edit *edit, const gtx_field_span *field, uint32_t texel,
                          gtx_change *changes)
{
    const uint8_t *ring = edit->ring + field->first;
    gtx_change sum = {0};
    float count = 0;
    for (int k = 0; k < 8; ++k) {
        uint32_t other;
        if (!neighbour(field, texel, k, &other) || ring[other] >= ring[texel])
            continue;
        for (int c = 0; c < 8; ++c)
            sum[c] += changes[other][c];
        count += 1;
    }
    for (int c = 0; c < 8; ++c)
        changes[texel][c] = sum[c] / count;
}

void gtx_edit_follow(const gtx_edit *edit, gtx_change *changes)
{
    for (uint32_t p = 0; p < edit->count; ++p) {
        const gtx_field_span *field = &edit->fields[p];
        gtx_change *own = changes + field->first;
        if (!field->touched)
            continue;
        for (size_t i = 0; i < field->correspondence_count; ++i) {
            const gtx_correspondence *owner =
                &edit->correspondences[field->first_correspondence + i];
            const gtx_field_span *other = &edit->fields[owner->patch];
            gtx_change *a = changes + other->first + owner->source, *b = a + other->width;
            const float u = owner->u, v = owner->v;
            const float weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
            for (int c = 0; c < 8; ++c)
                own[owner->texel][c] = weight[0] * a[0][c] + weight[1] * a[1][c] +
                                      weight[2] * b[0][c] + weight[3] * b[1][c];
        }
        for (size_t i = 0; i < field->loose_count; ++i)
            follow_beside(edit, field, edit->loose[field->first_loose + i], own);
    }
}
