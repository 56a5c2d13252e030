/* The range of solid cells, and the codes of the nodes at their corners. */
#include "derive/codes.h"

#include <math.h>
#include <string.h>

void gtx_load_codes(const gtx_grid *grid, uint32_t x0, uint32_t count, uint32_t y, float *out)
{
    const uint32_t cells = grid->nodes_x - 1, last = grid->nodes_y - 2;
    const uint8_t *above = grid->solid + (size_t)(y ? y - 1 : 0) * cells;
    const uint8_t *below = grid->solid + (size_t)(y > last ? last : y) * cells;
    const uint16_t *code = grid->code + (size_t)y * grid->nodes_x + x0;
    uint8_t beside[GTX_CODES_RUN + 1]; /* whether cells left of each node are solid */
    beside[0] = beside[count] = 0;
    const size_t from = x0 ? 0 : 1, end = (size_t)x0 + count > cells ? count : count + 1;
    for (size_t i = from; i < end; ++i)
        beside[i] = above[x0 + i - 1] | below[x0 + i - 1];
    for (uint32_t i = 0; i < count; ++i) {
        const float height = code[i];
        out[i] = beside[i] | beside[i + 1] ? height : NAN;
    }
}

bool gtx_solid_extent(const gtx_grid *grid, uint32_t low[2], uint32_t high[2])
{
    const uint32_t width = grid->nodes_x - 1, height = grid->nodes_y - 1;
    low[0] = low[1] = UINT32_MAX;
    high[0] = high[1] = 0;
    for (uint32_t j = 0; j < height; ++j) {
        const uint8_t *row = grid->solid + (size_t)j * width, *first = memchr(row, 1, width);
        if (!first)
            continue;
        const uint32_t at = (uint32_t)(first - row);
        low[0] = at < low[0] ? at : low[0];
        low[1] = j < low[1] ? j : low[1];
        high[1] = j + 1;
        uint32_t end = width;
        while (end > high[0] && !row[end - 1])
            --end;
        high[0] = end;
    }
    return high[1] > 0;
}
