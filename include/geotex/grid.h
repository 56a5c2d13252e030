/* Height grids: reading them, fitting them to each other, and making assets of them (paper, section
 * 6.2). Links libgeotex-cook; what cook.h says of memory, limits and threads holds here too. */
#ifndef GEOTEX_GRID_H
#define GEOTEX_GRID_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Values at the nodes of a lattice: a horizon, or terrain. Node (i, j) lies at
 *   origin + R(rotation) (i * spacing[0], j * spacing[1])
 * seen from above: x to the east, y to the north. */
typedef struct gtx_height_grid {
    uint32_t nx, ny;              /* nodes along x and y */
    const float *values;          /* nx * ny, row by row from the origin; NaN where there is none */
    const float *property;        /* likewise, the values to colour by; NULL: `values` */
    double origin[2], spacing[2]; /* object units; spacing > 0 */
    double rotation;              /* degrees, counter-clockwise */
    gtx_allocator allocator;      /* gave `values`, where gtx_height_grid_read did */
    uint32_t in_degrees;          /* 1: origin and spacing are longitudes and latitudes, and of no
                                     use beside heights until the caller has changed both */
    uint32_t unplaced;            /* 1: its file tells neither origin nor spacing */
    uint32_t categories;          /* 1: the values to colour by are kinds of something, as of rock,
                                     and nothing lies between two; for the caller to say */
    uint32_t reserved[1];
} gtx_height_grid;

typedef struct gtx_height_grid_desc {
    double missing;               /* with has_missing: the value that marks a node without one */
    uint32_t has_missing;
    uint32_t reserved[5];
    double range[2];              /* values of an image's lowest and highest codes, `missing` left
                                     out; both 0: codes are the values */
    const gtx_allocator *allocator;
    gtx_limits limits;            /* memory, texels: the grid's nodes, and pixels */
} gtx_height_grid_desc;

/* Reads a grid: IRAP classic and binary (".irap", ".gri"), ZMAP+ and CPS-3 text, NetCDF (one
 * variable of two dimensions, placed by the variables called as these: CF, COARDS; coordinates of
 * other units of length than the values are converted; NetCDF-4, which is HDF5, by geotex-netcdf,
 * a process that is started for it and waited for); through geotex-grid.so, which holds GDAL, ESRI
 * ASCII, Surfer (text, binary and 7), HGT, XYZ (".xyz") and GeoTIFF, cloud optimised ones too. All
 * of them hold their position, and may be gzipped but for GeoTIFF. Or any image of 8 or 16 bits or
 * of floats, whose top row is the northernmost, with origin 0 and spacing 1, for the caller to
 * change. Each format's own marker of missing values is known (9999900, 1e30; -32767 and below in
 * signed 16 bits), and what a file tells itself. Only the file is read: none beside it. Where GDAL
 * runs out of memory the process may end. The values come from the descriptor's allocator, and are
 * freed by gtx_height_grid_free. `desc` may be NULL.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, READ, INPUT, UNSUPPORTED. */
GTX_API gtx_result gtx_height_grid_read(const char *path, const gtx_height_grid_desc *desc,
                                        gtx_height_grid *out, gtx_error *error);
/* Frees the values of a grid that was read, and zeroes it. NULL and zeros are fine. */
GTX_API void gtx_height_grid_free(gtx_height_grid *grid);

/* The values of `from` at the nodes of `to`, such as a property that has other nodes than its grid:
 * bilinear between the nodes of `from`, the mean over what a node of `to` stands for where those
 * are further apart; of categories the nearest node's, or the most frequent, of which the lowest.
 * NaN where the nearest node has no value, or lies more than half a step away.
 * Where either is unplaced, `from` reaches over all of `to`. `out` has the lattice of `to`, and
 * values from the allocator (NULL: the default one), which gtx_height_grid_free frees; `categories`
 * is that of `from`. Any thread.
 * Errors: ARGUMENT, MEMORY, INPUT (no place in common, or one alone lies in degrees). */
GTX_API gtx_result gtx_height_grid_resample(const gtx_height_grid *from, const gtx_height_grid *to,
                                            const gtx_allocator *allocator, gtx_height_grid *out,
                                            gtx_error *error);

/* Makes metres of degrees, with the length that one has at a latitude, -90 to 90 (WGS 84): for a
 * tile or two. Further away it is no projection. Does nothing to a grid in metres.
 * Errors: ARGUMENT, INPUT (rotated, or a latitude of a pole). */
GTX_API gtx_result gtx_height_grid_to_metres(gtx_height_grid *grid, double latitude,
                                             gtx_error *error);

typedef enum gtx_colors {
    GTX_COLORS_VIRIDIS = 0,
    GTX_COLORS_RAINBOW = 1,       /* blue, cyan, green, yellow, red */
    GTX_COLORS_NONE = 2           /* an asset without colour; not for gtx_color */
} gtx_colors;

/* The sRGB colour of a value, clamped to 0..1, as the maps have it: for a legend. */
GTX_API void gtx_color(gtx_colors colors, double value, uint8_t rgb[3]);

typedef struct gtx_horizons_desc {
    gtx_colors colors;
    uint32_t depths;              /* 1: values count downwards */
    double vertical;              /* exaggeration, > 0; 0 = 1 */
    double color_range[2];        /* values at the ends of the colours; both 0 = the lowest and the
                                     highest value */
    uint32_t one_surface;         /* 1: the grids are parts of one lattice, such as neighbouring
                                     tiles of terrain, and become one surface without seams */
    uint32_t tile;                /* most texels along a patch, 16..512; 0 = 128 */
    uint32_t height_bits;         /* 8 or 16; 0 = 8 */
    uint32_t mips;                /* 1..8; 0 = 4 */
    uint32_t lod_levels;          /* LOD meshes, 1..5, made from the maps; 0 = 5; up to 3 far ones
                                     follow. Or GTX_LOD_LEVELS_NONE */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    float unit;                   /* metres per object unit; 0 = 1 */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    const gtx_allocator *allocator;   /* for the asset */
    gtx_limits limits;            /* memory, for which the grids' values count as read; texels:
                                     nodes of all grids, and of the surface that they become,
                                     2^28 by default; patches */
    const char *property_name;    /* what colours tell, for META and legends; NULL: nothing */
    uint32_t reserved[4];
} gtx_horizons_desc;

typedef struct gtx_horizons_result {
    uint64_t nodes, triangles;    /* nodes with a value; two triangles where four make a square */
    uint32_t patches;
    double height_rms, height_max;    /* distance of heights from the values, object units */
    double color_range[2];        /* values at the ends of the colours */
    /* What may be a mistake. Of one_surface: nodes that several parts have, those of other values
     * (the first part's count), and by how much. */
    uint64_t shared, differing;
    double difference;
    uint32_t alike[2];            /* two grids with the same heights where both are: tiles or copies
                                     rather than layers; both 0: there are none */
    uint64_t crossings;           /* nodes at which a grid lies on the other side of the next one */
} gtx_horizons_result;

/* Makes one asset of height grids, tile by tile, with no mesh in between (paper, section 6.2). East
 * is +X, up +Y, north -Z; the asset's anchor is in the middle of the grids. Every tile has its own
 * height step, but neighbours have the same heights where they meet, so that no border shows. Nodes
 * without a value are empty texels; patches are two-sided. All grids have the same numbers of
 * nodes, unless they are parts of one surface. Where a property is NaN the surface is grey. The
 * values of categories, up to 64, are in META, for legends, as the ends of colours are. The
 * same grids and options give the same bytes. `desc`, `result` and `error` may be NULL; gtx_close
 * frees the asset.
 * Errors: CANCELLED, ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, INPUT (of other sizes; in degrees), EMPTY
 * (a grid without four neighbouring values). Any thread. */
GTX_API gtx_result gtx_horizons(const gtx_height_grid *grids, uint32_t count,
                                const gtx_horizons_desc *desc, gtx_asset **out,
                                gtx_horizons_result *result, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
