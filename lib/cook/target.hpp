/* Cooking with a bound on the error: the smallest asset that keeps it. */
#pragma once

#include "cook/assemble.hpp"
#include "cook/options.hpp"
#include "cook/suitability.hpp"
#include "measure/measure.hpp"

#include <functional>
#include <memory>

namespace gtx {

/* What came of cooking with some options. */
struct Attempt {
    Asset asset{nullptr, gtx_close};
    Partition partition;
    BakeReport bake;
    Suitability suitability;
    SurfaceError error;
    Vector<double> lod_rms;             /* of the LOD meshes, the finest first */
    uint64_t bytes = 0;                 /* of the file */
    Vector<Warning> warnings;           /* of this attempt */
};
using Cook = std::function<Attempt(const Options &)>;

/* Looks for the fewest bytes at a forward RMS of at most options.error: texel pitch, and where they
 * are free, bits of a height and number of patches are tried in turn, each measured. Deterministic.
 * Throws Error: LIMIT where no density reaches the error. */
Attempt cook_to_error(const Options &options, const Cook &cook);

} // namespace gtx
