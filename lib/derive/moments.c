/* Sums over a block of cells, column by column and then over the columns. */
#include "derive/moments.h"

/* Sums of a column's cells; j counts rows. Below 2^24 all of them are exact: the largest is that of
 * 16 codes times 0 to 15. */
typedef struct columns {
    float n[GTX_MOST_MOMENTS], z[GTX_MOST_MOMENTS], jn[GTX_MOST_MOMENTS], jz[GTX_MOST_MOMENTS],
        jjn[GTX_MOST_MOMENTS];
} columns;

gtx_moments gtx_moments_of(const gtx_grid *grid, const uint32_t low[2], const uint32_t high[2])
{
    columns c = {{0}, {0}, {0}, {0}, {0}};
    float n[GTX_MOST_MOMENTS] = {0}, z[GTX_MOST_MOMENTS] = {0};
    const uint32_t width = high[0] - low[0];
    for (uint32_t j = low[1]; j < high[1]; ++j) {
        const uint8_t *solid = grid->solid + (size_t)j * (grid->nodes_x - 1) + low[0];
        const uint16_t *code = grid->code + (size_t)j * grid->nodes_x + low[0];
        const float y = (float)(j - low[1]);
        for (uint32_t i = 0; i < width; ++i) {
            n[i] = solid[i];
            z[i] = solid[i] ? code[i] : 0;
        }
        for (uint32_t i = 0; i < GTX_MOST_MOMENTS; ++i) {
            c.n[i] += n[i];
            c.z[i] += z[i];
            c.jn[i] += y * n[i];
            c.jz[i] += y * z[i];
            c.jjn[i] += y * y * n[i];
        }
    }
    gtx_moments m = {0};
    for (uint32_t i = 0; i < width; ++i) {
        const double x = i;
        m.n += c.n[i], m.z += c.z[i], m.y += c.jn[i], m.yz += c.jz[i], m.yy += c.jjn[i];
        m.x += x * c.n[i], m.xz += x * c.z[i], m.xy += x * c.jn[i], m.xx += x * x * c.n[i];
    }
    return m;
}
