/* Baking: charts with frames -> the maps of one asset. */
#pragma once

#include "bake/field/extract.hpp"
#include "chart/chart.hpp"

#include <geotex/geotex.h>

namespace gtx {

struct BakeOptions {
    unsigned height_bits = 8;    /* 8 or 16 */
    unsigned mips = 4;           /* levels of normal and colour, 1..8 */
    unsigned dilation = 0;       /* texels; 0 = 2^(mips - 1) */
    Extractor *extractor = nullptr; /* draws the charts; null: the CPU samples them */
};

struct BakeReport {
    uint64_t texels_total = 0;   /* sum of the rectangles */
    uint64_t texels_empty = 0;   /* of those, without a height code */
    double page_fill = 0;        /* texels_total over the pages' texels */
};

/* Everything gtx_create takes, owned. */
struct Maps {
    Vector<gtx_patch> patches;
    Vector<uint32_t> charts;                  /* of each patch */
    uint32_t page_count = 0, page_width = 0, page_height = 0, mip_count = 0, height_bits = 8;
    Vector<uint8_t> height;                   /* 1 or 2 bytes a texel */
    Vector<uint8_t> trim;
    Vector<Vector<uint8_t>> normal;           /* a level each */
    Vector<Vector<uint8_t>> color;            /* a level each, or empty; likewise the next two */
    Vector<Vector<uint8_t>> material, emission;
    float emission_scale = 0;                 /* 0 without emission */
    double anchor[3] = {0, 0, 0};
    float bounds_min[3] = {0, 0, 0}, bounds_max[3] = {0, 0, 0};
    BakeReport report;
};

/* Overlap, rasterise, trim, extrapolate, dilate, mip, stitch, pack. What no patch shows becomes
 * charts of its own, appended to the partition. Patches come in the order of the charts; one that
 * its material cuts away whole has none. The anchor is the centre of the mesh's bounding box,
 * rounded to a multiple of a power of two. Deterministic for any thread count. Stages of `task`:
 * "bake", "pack". Throws Error: EMPTY, LIMIT, INPUT, ARGUMENT, CANCELLED, and what the extractor
 * throws. */
Maps bake(const Mesh &mesh, Partition &partition, const BakeOptions &options, Task &task);

} // namespace gtx
