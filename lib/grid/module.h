/* The functions of the grid module, as gdal.cpp finds them with dlsym. */
#ifndef GTX_GRID_MODULE_H
#define GTX_GRID_MODULE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GTX_GRID_MODULE_SYMBOL "gtx_grid_module"
#define GTX_GRID_MODULE_VERSION 1

enum { GTX_GRID_MAX_MESSAGE = 160 };
enum { GTX_GRID_FAILED = 1, GTX_GRID_NO_MEMORY = 2 };

/* The bytes of a file; `driver` is the one of GDAL's that may look at them, `name` what the file is
 * called without its folder, for a driver that goes by it. */
typedef struct gtx_grid_bytes {
    const char *driver, *name;
    const void *data;
    size_t size;
} gtx_grid_bytes;

typedef struct gtx_grid_raster {
    uint32_t nx, ny;
    int has_place;            /* 1: `affine` holds */
    double affine[6];         /* x = a[0] + a[1] column + a[2] row, y = a[3] + a[4] column + a[5]
                                 row; pixel (0, 0), at the top, has its centre at (0.5, 0.5) */
    double least, greatest;   /* codes of 8 or 16 bits; both 0 for other numbers */
    double scale, offset;     /* of codes to values */
    float *codes;             /* from malloc; rows from the top, NaN where there is none */
} gtx_grid_raster;

/* Return 0 for success, and otherwise fill `message`. No other file is looked at, and nothing is
 * printed. Any thread. */
typedef struct gtx_grid_functions {
    uint32_t version;
    /* All but `codes`. */
    int (*measure)(const gtx_grid_bytes *file, gtx_grid_raster *out,
                   char message[GTX_GRID_MAX_MESSAGE]);
    int (*read)(const gtx_grid_bytes *file, gtx_grid_raster *out,
                char message[GTX_GRID_MAX_MESSAGE]);
} gtx_grid_functions;

#ifdef __cplusplus
}
#endif
#endif
