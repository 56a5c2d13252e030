/* Sums over a block of cells, column by column and then over the columns. */
#include "derive/moments.h"

#include <string.h>

enum { LANES = GTX_MAX_MOMENTS };

/* Sums of a column's cells; j counts rows. All of them are exact: of codes the largest is that of
 * 16 times 0 to 15, which is below 2^24. */
typedef struct columns {
    uint16_t n[LANES], jn[LANES], jjn[LANES];
    float z[LANES], jz[LANES];
} columns;

/* A row of the block, which may have more after it: cells count where `inside` is 1. */
static void add_row(columns *restrict c, const uint8_t *restrict solid,
                    const uint16_t *restrict code, const uint8_t *restrict inside, uint16_t j)
{
    for (int i = 0; i < LANES; ++i) {
        const uint16_t n = solid[i] & inside[i];
        const float z = (float)code[i] * n;
        c->n[i] = (uint16_t)(c->n[i] + n);
        c->jn[i] = (uint16_t)(c->jn[i] + j * n);
        c->jjn[i] = (uint16_t)(c->jjn[i] + j * j * n);
        c->z[i] += z;
        c->jz[i] += (float)j * z;
    }
}

gtx_moments gtx_moments_of(const gtx_grid *grid, const uint32_t low[2], const uint32_t high[2])
{
    columns c = {{0}, {0}, {0}, {0}, {0}};
    const uint32_t width = high[0] - low[0], cells_x = grid->nodes_x - 1;
    const size_t cells = (size_t)cells_x * (grid->nodes_y - 1);
    uint8_t inside[LANES], end_solid[LANES] = {0};
    uint16_t end_code[LANES] = {0};
    for (uint32_t i = 0; i < LANES; ++i)
        inside[i] = i < width;
    for (uint32_t j = low[1]; j < high[1]; ++j) {
        const size_t first = (size_t)j * cells_x + low[0];
        const uint8_t *solid = grid->solid + first;
        const uint16_t *code = grid->code + (size_t)j * grid->nodes_x + low[0];
        if (first + LANES > cells) { /* the grid ends with the row */
            memcpy(end_solid, solid, width * sizeof *solid);
            memcpy(end_code, code, width * sizeof *code);
            solid = end_solid;
            code = end_code;
        }
        add_row(&c, solid, code, inside, (uint16_t)(j - low[1]));
    }
    gtx_moments m = {0};
    for (uint32_t i = 0; i < width; ++i) {
        const double x = i;
        m.n += c.n[i], m.z += c.z[i], m.y += c.jn[i], m.yz += c.jz[i], m.yy += c.jjn[i];
        m.x += x * c.n[i], m.xz += x * c.z[i], m.xy += x * c.jn[i], m.xx += x * x * c.n[i];
    }
    return m;
}
