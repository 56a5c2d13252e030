/* The reports of cooking and comparing. */
#pragma once

#include "cook/options.hpp"
#include "cook/suitability.hpp"
#include "measure/measure.hpp"

#include <geotex/cook.h>

#include "base/json.h"

#include <memory>

namespace gtx {

/* What the cook report tells besides the options. */
struct CookFacts {
    bool unchanged = false; /* there was nothing to cook: what only a cook finds out is not known */
    bool held = false;      /* for the model held the asset, which is written */
    bool cached = false;    /* for a cache had it */
    uint64_t source_triangles = 0, source_vertices = 0;
    CleanReport clean;
    ChartReport charts;
    uint64_t chart_count = 0;
    BakeReport bake;
    PartitionMethod method = PartitionMethod::CUTS; /* what AUTO came to */
    Suitability suitability;
    SurfaceError error;
    uint64_t source_hash = 0, key = 0;
    std::bitset<GTX_WARNING_COUNT> warnings;
    Vector<gtx_lod_mesh> lod;      /* the levels of the asset */
    Vector<double> lod_rms;        /* of each, where it was cooked */
    uint64_t bytes = 0, content_hash = 0;
    double total_seconds = 0;
};

/* A JSON text that frees itself. */
struct Json : gtx_json {
    explicit Json(const gtx_allocator &hooks) : gtx_json{} { allocator = hooks; }
    ~Json() { gtx_json_free(this); }
    Json(const Json &) = delete;
    Json &operator=(const Json &) = delete;
};

void write_deviation(Json &json, const char *key, const Deviation &deviation);
/* Sentences and names, of warnings and of notes apart. */
void write_warnings(Json &json, const Vector<Warning> &warnings);
/* Throws bad_alloc where memory ran out on the way. */
void check_written(const Json &json);

/* Fills `json` and returns the line of gtx_report.summary. */
std::string write_cook_report(const Options &options, const CookFacts &facts, const Task &task,
                              Json &json);

/* A report that frees itself until the caller takes it. */
struct Report : gtx_report {
    /* Copies all of it, in memory of the text's allocator. */
    Report(const Json &json, const std::string &summary, const Vector<std::string> &sources,
           const Vector<Warning> &warnings);
    ~Report() { gtx_report_free(this); }
    Report(const Report &) = delete;
    Report &operator=(const Report &) = delete;

    void hand_over(gtx_report *to)
    {
        *to = *this;
        block = nullptr;
    }
};

} // namespace gtx
