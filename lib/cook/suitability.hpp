/* Whether a model suits geometry textures, and warnings with advice. */
#pragma once

#include "bake/bake.hpp"

namespace gtx {

/* Estimates, before anything is measured. */
struct Suitability {
    double triangles_per_patch = 0; /* of the source; a patch of few is slower than they are */
    double empty_fraction = 0;      /* of the texels */
    double outline_loss = 0;        /* share of a silhouette that may miss the source's: outlines
                                       are as sharp as texels are small */
    bool for_outlines = false;      /* layers of finer texels were taken */
    unsigned resolution = 0;        /* what it came to */
    double unseen_fraction = 0;     /* of the surface, lost to six views */
    const char *better = nullptr;   /* "mesh", "auto", "texels", "cuts"; null: nothing known */
};

/* Warns of what weighs most. `triangles` are the source's. */
Suitability judge_suitability(const Partition &partition, const BakeReport &bake,
                              uint64_t triangles, Task &task);

} // namespace gtx
