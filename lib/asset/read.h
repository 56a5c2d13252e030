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

/* The same of the first bytes of a file; *out stays as it is where they show nothing yet. */
gtx_result gtx_read_prefix(gtx_error *error, const gtx_read_options *options, const void *data,
                           size_t size, gtx_prefix *prefix, gtx_asset **out);

#endif
