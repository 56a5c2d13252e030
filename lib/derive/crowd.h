/* Limits for preparing an asset for rays or drawing: the cells on a ray, and memory. */
#ifndef GTX_DERIVE_CROWD_H
#define GTX_DERIVE_CROWD_H

#include "asset/asset.h"
#include "base/limits.h"

/* LIMIT when gtx_ray_cells is more than limits->cells. */
gtx_result gtx_check_crowd(const gtx_asset *asset, const gtx_limits *limits, gtx_error *error);
/* LIMIT when `bytes` are more than limits->memory, by default what as many bytes read as there are
 * texels allow. */
gtx_result gtx_check_derived(uint64_t texels, const gtx_limits *limits, const char *what,
                             uint64_t bytes, gtx_error *error);

#endif
