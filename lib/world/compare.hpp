/* Measuring a world, as gtx_compare_files does an asset. */
#pragma once

#include "mesh/task.hpp"

#include <geotex/cook.h>

#include <string>

namespace gtx {

/* Measures the world in `folder` against the models that it was made of. Figures are those of the
 * leaves, or of the coarsest tiles within `tile_error` object units of the source; those of smaller
 * images are of the tiles that a stream would choose there. The tiles and the models are held in
 * memory at once, and count against the limits; `about` becomes the path that is read. Throws
 * Error: as gtx_compare_files and gtx_stream_create; INPUT: a tile is not what the index says. */
void compare_world(const std::string &folder, const char *model, double tile_error,
                   const gtx_compare_desc &desc, gtx_compare_result *result, gtx_report *report,
                   std::string &about);

} // namespace gtx
