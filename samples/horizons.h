/* The grids of samples/horizons.c: four made here, or the files of a folder. */
#include <geotex/cook.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LAYERS = 4, OWN = 220 };
static const struct {
    const char *name;
    double thickness[2]; /* metres: what the codes of the property stand for */
} files[LAYERS] = {{"0_topreek_rota", {17.80, 23.29}}, {"1_midreek_rota", {10.89, 17.43}},
                   {"2_lowreek_rota", {5.37, 10.17}}, {"3_basereek_rota", {5.37, 10.17}}};
static const double depth[2] = {1547.196, 1976.013}, spacing[2] = {6.969, 7.582};
static const double apart = 190; /* metres between layers besides their own, so that all are seen */

static gtx_result read_layer(const char *folder, int k, gtx_height_grid *grid, gtx_error *error)
{
    char path[4096];
    gtx_height_grid property;
    gtx_height_grid_desc desc;
    memset(&desc, 0, sizeof desc); /* read as C++ too */
    desc.has_missing = 1;
    memcpy(desc.range, depth, sizeof desc.range);
    snprintf(path, sizeof path, "%s/%s_z16.png", folder, files[k].name);
    gtx_result result = gtx_height_grid_read(path, &desc, grid, error);
    memcpy(desc.range, files[k].thickness, sizeof desc.range);
    snprintf(path, sizeof path, "%s/%s_thickness8.png", folder, files[k].name);
    if (result || (result = gtx_height_grid_read(path, &desc, &property, error)))
        return result;
    grid->property = property.values;
    memcpy(grid->spacing, spacing, sizeof spacing);
    for (size_t i = 0; i < (size_t)grid->nx * grid->ny; ++i)
        ((float *)grid->values)[i] += (float)(k * apart);
    return GTX_OK;
}

/* A dome with a fault and a ragged outline; at its crest layers are thin and thick in turn. */
static gtx_result make_layer(int k, gtx_height_grid *grid)
{
    static float values[LAYERS][OWN * OWN], property[LAYERS][OWN * OWN];
    for (int i = 0; i < OWN * OWN; ++i) {
        const float x = (float)(i % OWN) / OWN - 0.5f, y = (float)(i / OWN) / OWN - 0.5f;
        const float bump = expf(-9 * (x * x + y * y)) + 0.12f * sinf(11 * x + 2) * cosf(9 * y);
        const float fault = 30 * tanhf(60 * (x + 0.3f * y - 0.12f - 0.02f * (float)k));
        const int outside = x * x + y * y > 0.22f + 0.02f * sinf(7 * atan2f(y, x));
        values[k][i] = outside ? NAN : 1900 - 190 * bump + fault + (float)(k * apart);
        property[k][i] = 18 - 3 * (float)k + (k % 2 ? 5 : -5) * bump;
    }
    memset(grid, 0, sizeof *grid);
    grid->nx = grid->ny = OWN;
    grid->values = values[k];
    grid->property = property[k];
    grid->spacing[0] = grid->spacing[1] = 45;
    return GTX_OK;
}
