/* What a cook is asked for, defaults filled in, and the key of what comes out. */
#pragma once

#include "bake/bake.hpp"
#include "cook/driver.hpp"

#include <geotex/cook.h>

namespace gtx {

constexpr uint32_t MAX_LOD_LEVELS = 5;

struct Options {
    ChartOptions chart;
    BakeOptions bake;
    std::shared_ptr<const Driver> driver; /* null: the CPU extracts the maps */
    unsigned lod_levels = 0;
    int zstd = 0;
    float unit = 1;
    double error = 0;            /* asked for; 0: none */
    bool free_bits = false;      /* the error decides on the bits of a height */
    bool z_up = false;
    gtx_allocator allocator = {}; /* never empty hooks */
};

/* Throws Error: ARGUMENT, NOT_ZEROED. */
void check(const gtx_cook_desc &desc);
/* Of a checked descriptor. Throws Error: GL, SHADER. */
Options options_of(const gtx_cook_desc &desc);

/* The partition as an asset names it. */
const char *partition_name(const Options &options);

/* Of the sources' content, the options that matter and the cooker's revision: equal keys promise
 * equal assets. */
uint64_t content_key(const Options &options, uint64_t source_hash);

} // namespace gtx
