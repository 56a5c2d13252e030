/* Partitions against each other as a user has them: assets of equal texels. */
#pragma once

#include <geotex/cook.h>

#include <string>
#include <vector>

struct AssetFigures {
    uint64_t patches = 0, texels = 0, empty = 0;
    double range = 0;               /* of heights in a patch, mean over texels; of the diagonal */
    double rms = 0;                 /* from the source, of the diagonal */
    uint64_t holes = 0, pixels = 0; /* in 26 views; of relief neither is counted */
    uint64_t bytes = 0;
    uint64_t grid_triangles = 0;    /* of a displaced mesh over all texels */
    double seconds = 0;             /* of a processor, to cook it */
    double lost = 0;                /* of the surface, seen from no side */
};

/* Cooks the model with each partition, at the resolution at which it has about as many texels as
 * the first has at 128. Leaves the assets in `folder`, as MODEL_PARTITION.gtx.
 * Exits on an error. */
std::vector<AssetFigures> equal_texels(const std::string &model, unsigned charts,
                                       const std::vector<gtx_partition> &partitions,
                                       const std::string &folder);
