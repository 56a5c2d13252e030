/* Reading untrusted bytes: the one pass behind opening and validating. */
#ifndef GTX_ASSET_READ_H
#define GTX_ASSET_READ_H

#include "asset/check.h"

typedef struct gtx_read_options {
    gtx_allocator allocator;
    const gtx_jobs *jobs;         /* or NULL */
    const gtx_limits *limits;     /* or NULL */
    uint64_t bytes_held;          /* that the caller has taken from the same memory */
    bool skip_hash;               /* trust the section hashes */
} gtx_read_options;

/* Checks `size` bytes of a file and makes an asset of them; *out is NULL when a rule was broken or
 * something failed. What it allocates is known, and held against the limits, before the first
 * allocation. */
gtx_result gtx_read_asset(gtx_check *check, const gtx_read_options *options, const void *data,
                          size_t size, gtx_asset **out);

/* Bytes of a file behind its beginning, from the one numbered `first` on. */
typedef struct gtx_file_part {
    const uint8_t *bytes;
    uint64_t first, size;
} gtx_file_part;

/* The same of the first bytes of a file, and of pieces that hold sections behind them; *out stays
 * as it is where they show nothing yet. Where heights and all normals are among them, the latter
 * take the place of those that follow from the LOD mesh. */
gtx_result gtx_read_prefix(gtx_error *error, const gtx_read_options *options, const void *data,
                           size_t size, const gtx_file_part *pieces, uint32_t piece_count,
                           gtx_prefix *prefix, gtx_asset **out);

#endif
