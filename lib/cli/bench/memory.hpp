/* GPU memory and loss of quality with each block compression. */
#pragma once

#include "cli/bench/bench.hpp"

namespace gtx {

/* Heights, outlines, normals, colours with material and emission, records, hulls, LOD meshes. */
constexpr const char *MEMORY_PARTS[] = {"heights", "outlines", "normals", "colours",
                                        "records", "hulls",    "LOD"};

/* A kind of blocks, for all maps but normals or for these too. */
struct MemoryRow {
    const char *name;
    gtx_compression compress;
    bool normals;
    uint64_t bytes = 0;             /* of all, and of each part by MEMORY_PARTS */
    std::array<uint64_t, 7> parts = {};
    double prepare = 0;             /* milliseconds of all processors */
    /* Of occupied texels of level 0, decibels; 0: there are none. */
    double color = 0, material = 0, emission = 0;
    double mean = 0, p99 = 0;       /* of normals, degrees */
    Vector<double> pictures = {};   /* decibels of cast pictures, a window each; of what is covered,
                                       to those by texels */
};

/* Tells texels first. Kinds that the context does not read are left out. Throws as run_bench. */
void run_memory(const std::string &asset_path, BenchOptions options,
                const std::function<void(const MemoryRow &)> &tell);

void print_memory_head(const char *scene, const BenchOptions &options);
void print_memory(const MemoryRow &row);

} // namespace gtx
