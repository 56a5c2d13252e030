/* What a cook is asked for, defaults filled in, and the key of what comes out. */
#pragma once

#include "bake/bake.hpp"
#include "cook/driver.hpp"

#include <geotex/cook.h>

#include <bitset>

namespace gtx {

/* Raised with every change that makes other assets of the same models and options. */
constexpr int COOKER_REVISION = 36;

/* Promised by cook.h. */
constexpr uint32_t MAX_LOD_LEVELS = 5;

/* Of a descriptor's lod_levels. */
inline unsigned lod_levels_of(uint32_t wanted)
{
    return wanted == GTX_LOD_LEVELS_NONE ? 0 : wanted ? wanted : MAX_LOD_LEVELS;
}

inline bool is_lod_levels(uint32_t wanted)
{
    return wanted <= MAX_LOD_LEVELS || wanted == GTX_LOD_LEVELS_NONE;
}

/* gtx_cook_desc says what each means. */
struct Options {
    ChartOptions chart;
    BakeOptions bake;
    std::shared_ptr<const Driver> driver; /* null: the CPU extracts the maps */
    unsigned lod_levels = 0;
    int zstd = 0;
    float unit = 1;
    double error = 0;             /* asked for; 0: none */
    bool free_bits = false;       /* the error decides on the bits of a height */
    bool free_charts = false;     /* and on the number of patches */
    bool measure = false;         /* also where an error is asked for */
    std::bitset<GTX_WARNING_COUNT> allowed; /* warnings that `strict` lets pass; notes always */
    bool z_up = false, strict = false, if_changed = false, closed = false;
    const double *kept = nullptr;
    size_t kept_count = 0;
    uint32_t texture_formats = 0; /* GTX_TEXTURES_... */
    const char *charts_ply = nullptr, *cache = nullptr;
    gtx_allocator allocator = {}; /* never empty hooks */
};

/* Throws Error: ARGUMENT, NOT_ZEROED; GL, SHADER. */
Options checked_options(const gtx_cook_desc &desc);

/* How many times the work of the default options they may take: a limit is for what a file asks
 * for, not for what a caller does. */
double work_of(const Options &options);

/* A partition as options and assets name it. */
const char *partition_name(PartitionMethod method);

/* Of the sources' content, the options that matter and the cooker's revision: equal keys promise
 * equal assets. */
uint64_t content_key(const Options &options, uint64_t source_hash);

} // namespace gtx
