/* What the two calls of cook.h tell about their work. */
#pragma once

#include "bake/bake.hpp"
#include "measure/measure.hpp"

#include <geotex/cook.h>

#include "base/json.h"

#include <memory>

namespace gtx {

/* Everything the cook report is written from. */
struct CookFacts {
    uint64_t source_triangles = 0, source_vertices = 0;
    CleanReport clean;
    ChartReport charts;
    uint64_t chart_count = 0;
    BakeReport bake;
    std::string renderer, version; /* of the driver that extracted the maps; empty: the CPU did */
    double requested = 0;        /* 0: none */
    bool measured = false;
    SurfaceError error;
    uint64_t source_hash = 0, key = 0, warnings = 0;
    std::vector<gtx_lod_mesh> lod; /* the levels of the asset */
    uint64_t bytes = 0, gpu_bytes = 0, content_hash = 0;
    std::vector<const char *> stages;
    std::vector<double> seconds; /* a stage each */
    double total_seconds = 0;
};

/* A JSON text that frees itself. */
struct Json : gtx_json {
    explicit Json(const gtx_allocator &hooks) : gtx_json{} { allocator = hooks; }
    ~Json() { gtx_json_free(this); }
    Json(const Json &) = delete;
    Json &operator=(const Json &) = delete;
};

/* Fill `json` and return the line of gtx_report.summary. */
std::string write_cook_report(const CookFacts &facts, const std::vector<std::string> &warnings,
                              Json &json);
std::string write_unchanged_report(const CookFacts &facts, Json &json);
std::string write_compare_report(const CompareReport &report,
                                 const std::vector<std::string> &warnings, Json &json);

/* A report that frees itself until the caller takes it. */
struct Report : gtx_report {
    /* Copies all of it, in memory of the text's allocator. */
    Report(const Json &json, const std::string &summary, const std::vector<std::string> &sources,
           const std::vector<std::string> &warnings);
    ~Report() { gtx_report_free(this); }
    Report(const Report &) = delete;
    Report &operator=(const Report &) = delete;

    void hand_over(gtx_report *to)
    {
        *to = *this;
        block = nullptr;
    }
};

/* The META section: what made the asset, from what. Nothing of when, where or by how many. */
struct MetaFacts {
    const char *partition;
    uint64_t charts, resolution, height_bits, mips, dilation, lod_levels;
    bool z_up, by_gpu, adaptive;
    uint64_t source_triangles, source_hash, key, warnings;
};
void write_meta(const MetaFacts &facts, Json &json);

/* The key of an asset, and how many warnings it was cooked with; false when META does not tell. */
bool read_meta(const gtx_asset *asset, uint64_t &key, uint64_t &warnings);

/* Bytes of the asset's geometry on the GPU as lib/render lays it out; colour, material
 * and emission left out. */
uint64_t gpu_bytes(const gtx_info &info);

/* The most memory this process has held so far. */
uint64_t peak_rss_bytes();

} // namespace gtx
