/* Height grids: reading, resampling, and making assets of them (paper, section 6.2). Links
 * libgeotex-cook; what cook.h says about memory, limits and threads applies here too. */
#ifndef GEOTEX_GRID_H
#define GEOTEX_GRID_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Heights at the nodes of a regular grid: a horizon, or terrain. Node (i, j) lies at
 *   origin + R(rotation) (i * spacing[0], j * spacing[1])
 * seen from above: x to the east, y to the north. */
typedef struct gtx_height_grid {
    uint32_t nx, ny;              /* nodes along x and y */
    const float *values;          /* nx * ny, row by row from the origin; NaN where there is none */
    const float *property;        /* nx * ny values to colour the surface by; NULL: `values` */
    double origin[2], spacing[2]; /* object units; spacing > 0 */
    double rotation;              /* degrees, counter-clockwise */
    gtx_allocator allocator;      /* what gtx_height_grid_read allocated `values` from */
    uint32_t in_degrees;          /* 1: origin and spacing are longitude and latitude in degrees,
                                     and must be converted before use */
    uint32_t unplaced;            /* 1: the file gives neither origin nor spacing */
    uint32_t categories;          /* 1: the values to colour by are categories, such as kinds of
                                     rock, and are not interpolated; set by the caller */
    uint32_t reserved[1];
} gtx_height_grid;

typedef struct gtx_height_grid_desc {
    double missing;               /* with has_missing: the value of nodes without data */
    uint32_t has_missing;         /* 1: `missing` is given */
    uint32_t reserved[5];
    double range[2];              /* heights of an image's lowest and highest pixel values, other
                                     than `missing`; both 0: pixel values are the heights */
    const gtx_allocator *allocator;
    gtx_limits limits;            /* of memory, texels (the grid's nodes) and pixels */
} gtx_height_grid_desc;

/* Reads a grid from a file:
 *   - IRAP classic and binary (".irap", ".gri"), ZMAP+ and CPS-3 text;
 *   - NetCDF: its one two-dimensional variable, placed by its coordinate variables (CF, COARDS),
 *     which are converted to the values' unit of length. NetCDF-4, which is HDF5, is read by
 *     geotex-netcdf, a process that the call starts and waits for;
 *   - through GDAL, in the module geotex-grid.so: ESRI ASCII, Surfer (text, 6 and 7), HGT, XYZ
 *     (".xyz") and GeoTIFF, COG too. If GDAL runs out of memory the process may end;
 *   - any other image of 8 or 16 bits or of floats. Its top row is the northernmost; it is
 *     `unplaced`, with origin 0 and spacing 1.
 * All but GeoTIFF may be gzipped. No other file is read, such as a sidecar. Nodes without data are
 * recognised by each format's own marker (9999900, 1e30; -32767 and below in signed 16 bits) and by
 * what the file declares. The values are allocated from the descriptor's allocator; free them with
 * gtx_height_grid_free. `desc` may be NULL.
 * Errors: ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, READ, INPUT, UNSUPPORTED. */
GTX_API gtx_result gtx_height_grid_read(const char *path, const gtx_height_grid_desc *desc,
                                        gtx_height_grid *out, gtx_error *error);
/* Frees the values of a grid that was read or resampled, and zeroes it. NULL and a zeroed grid are
 * fine. */
GTX_API void gtx_height_grid_free(gtx_height_grid *grid);

/* Resamples `from` at the nodes of `to`, for example a property whose nodes differ from its grid's.
 * Interpolates bilinearly; where the nodes of `to` are farther apart than those of `from`, averages
 * over the area of a node. Categories take the nearest node's value, or the most frequent one in
 * that area (the lowest of several). NaN where the nearest node of `from` has no value or is more
 * than half its spacing away. If either grid is unplaced, `from` is stretched over all of `to`.
 * `out` gets the nodes of `to`, the `categories` of `from`, and values from `allocator` (NULL =
 * malloc); free it with gtx_height_grid_free. Any thread.
 * Errors: ARGUMENT, MEMORY, INPUT (the grids do not overlap, or only one is in degrees). */
GTX_API gtx_result gtx_height_grid_resample(const gtx_height_grid *from, const gtx_height_grid *to,
                                            const gtx_allocator *allocator, gtx_height_grid *out,
                                            gtx_error *error);

/* Converts origin and spacing from degrees to metres by the lengths of a degree at one `latitude`
 * (WGS 84; degrees, -90..90). Not a map projection: good for a tile or two around that latitude.
 * Does nothing to a grid that is not in degrees. Errors: ARGUMENT, INPUT (a rotated grid, or the
 * latitude of a pole). */
GTX_API gtx_result gtx_height_grid_to_metres(gtx_height_grid *grid, double latitude,
                                             gtx_error *error);

typedef enum gtx_colors {
    GTX_COLORS_VIRIDIS = 0,
    GTX_COLORS_RAINBOW = 1,       /* blue, cyan, green, yellow, red */
    GTX_COLORS_NONE = 2           /* an asset without colours; not for gtx_color */
} gtx_colors;

/* The sRGB colour of a value in 0..1, which is clamped, as in the maps: for a legend. */
GTX_API void gtx_color(gtx_colors colors, double value, uint8_t rgb[3]);

typedef struct gtx_horizons_desc {
    gtx_colors colors;
    uint32_t depths;              /* 1: values are depths, positive downwards */
    double vertical;              /* vertical exaggeration, > 0; 0 = 1 */
    double color_range[2];        /* values at the ends of the colour map; both 0 = the lowest and
                                     the highest value */
    uint32_t one_surface;         /* 1: the grids are parts of one larger grid, such as neighbouring
                                     tiles of terrain, and become one surface without seams */
    uint32_t tile;                /* most texels along a patch, 16..512; 0 = 128 */
    uint32_t height_bits;         /* 8 or 16; 0 = 8 */
    uint32_t mips;                /* 1..8; 0 = 4 */
    uint32_t lod_levels;          /* most LOD meshes, 1..5, made from the maps; 0 = 5; up to 3 far
                                     ones follow. Or GTX_LOD_LEVELS_NONE */
    uint32_t threads;             /* up to 1024; 0 = all processors */
    float unit;                   /* metres per object unit; 0 = 1 */
    gtx_progress_fn progress;     /* may be NULL */
    void *progress_user;
    const gtx_allocator *allocator;   /* for the asset */
    gtx_limits limits;            /* of memory, with the grids' values as bytes read; of texels: the
                                     nodes of all grids, and of the one surface, 2^28 by default; of
                                     patches */
    const char *property_name;    /* of the values that colours show, for META and legends; or
                                     NULL */
    uint32_t reserved[4];
} gtx_horizons_desc;

typedef struct gtx_horizons_result {
    uint64_t nodes, triangles;    /* nodes with a value; two triangles per cell of four of them */
    uint32_t patches;
    double height_rms, height_max;    /* error of the quantised heights, object units */
    double color_range[2];        /* values at the ends of the colour map */
    /* Possible mistakes in the input. With one_surface: the number of nodes that several grids
     * share, how many of these differ (the first grid's value is used), and the largest
     * difference. */
    uint64_t shared, differing;
    double difference;
    uint32_t alike[2];            /* indices of two grids with equal heights where both have some:
                                     tiles or copies, not layers; both 0: there are none */
    uint64_t crossings;           /* nodes at which one grid crosses the next */
} gtx_horizons_result;

/* Makes one asset of height grids, a patch per tile, without a mesh (paper, section 6.2). East is
 * +X, up +Y, north -Z; the asset's anchor is in the middle of the grids. Every tile has its own
 * height step, but neighbouring tiles agree in the heights along their border, so that no seam
 * shows. Nodes without a value are empty texels; patches are two-sided. All grids must have the
 * same nx and ny, unless one_surface is set. The surface is grey where `property` is NaN. META
 * holds the ends of the colour map and up to 64 categories, for legends. The same grids and options
 * give the same bytes. `desc`, `result` and `error` may be NULL; free the asset with gtx_close. Any
 * thread.
 * Errors: CANCELLED, ARGUMENT, NOT_ZEROED, MEMORY, LIMIT, INPUT (grids of different sizes, or in
 * degrees), EMPTY (a grid without a cell of four values). */
GTX_API gtx_result gtx_horizons(const gtx_height_grid *grids, uint32_t count,
                                const gtx_horizons_desc *desc, gtx_asset **out,
                                gtx_horizons_result *result, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
