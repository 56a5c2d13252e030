/* The report of a cook, as JSON and as a line, and the block that holds a report. */
#include "cook/report.hpp"

#include "base/alloc.h"

#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace gtx {

void write_deviation(Json &json, const char *key, const Deviation &deviation)
{
    gtx_json_begin_object(&json, key);
    gtx_json_number(&json, "rms", deviation.rms);
    gtx_json_number(&json, "max", deviation.max);
    gtx_json_end_object(&json);
}

/* Those that are notes, or those that are none. */
static Vector<Warning> chosen(const Vector<Warning> &warnings, bool notes)
{
    Vector<Warning> out;
    for (const Warning &w : warnings)
        if (gtx_warning_is_note(w.kind) == notes)
            out.push_back(w);
    return out;
}

void write_warnings(Json &json, const Vector<Warning> &warnings)
{
    for (const bool notes : {false, true}) {
        const Vector<Warning> list = chosen(warnings, notes);
        gtx_json_begin_array(&json, notes ? "notes" : "warnings");
        for (const Warning &w : list)
            gtx_json_string(&json, nullptr, w.sentence.c_str());
        gtx_json_end_array(&json);
        gtx_json_begin_array(&json, notes ? "note_names" : "warning_names");
        for (const Warning &w : list)
            gtx_json_string(&json, nullptr, gtx_warning_name(w.kind));
        gtx_json_end_array(&json);
    }
}

static void write_charts(Json &json, const ChartReport &charts)
{
    gtx_json_begin_object(&json, "source_folds");
    gtx_json_integer(&json, "triangles", charts.initial_inverted);
    gtx_json_integer(&json, "charts", charts.initial_folding);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "inverted_triangles", charts.inverted_triangles);
    gtx_json_integer(&json, "folding_charts", charts.folding_charts);
    gtx_json_number(&json, "second_layer_fraction", charts.second_layer_fraction);
    gtx_json_begin_object(&json, "junk");
    gtx_json_integer(&json, "triangles", charts.junk_triangles);
    gtx_json_number(&json, "area_fraction", charts.junk_area_fraction);
    gtx_json_end_object(&json);
}

static void write_extract(Json &json, const Extractor *gpu)
{
    gtx_json_begin_object(&json, "extract");
    gtx_json_string(&json, "by", gpu ? "gpu" : "cpu");
    if (gpu) {
        gtx_json_string(&json, "renderer", gpu->renderer().c_str());
        gtx_json_string(&json, "version", gpu->version().c_str());
    }
    gtx_json_end_object(&json);
}

static void write_error(Json &json, const Options &options, const SurfaceError &error)
{
    gtx_json_begin_object(&json, "error");
    if (options.error > 0)
        gtx_json_number(&json, "requested", options.error);
    else
        gtx_json_null(&json, "requested");
    if (options.measure) {
        write_deviation(json, "forward", error.forward);
        write_deviation(json, "reverse", error.reverse);
    } else {
        gtx_json_null(&json, "forward");
        gtx_json_null(&json, "reverse");
    }
    gtx_json_end_object(&json);
}

static void write_lod(Json &json, const Vector<gtx_lod_mesh> &levels, const Vector<double> &rms)
{
    gtx_json_begin_array(&json, "lod_meshes");
    for (size_t k = 0; k < levels.size(); ++k) {
        const gtx_lod_mesh &level = levels[k];
        gtx_json_begin_object(&json, nullptr);
        gtx_json_integer(&json, "triangles", level.triangle_count);
        gtx_json_integer(&json, "vertices", level.vertex_count);
        gtx_json_number(&json, "error", level.error);
        if (k < rms.size())
            gtx_json_number(&json, "rms", rms[k]);
        gtx_json_end_object(&json);
    }
    gtx_json_end_array(&json);
}

static double per_triangle(const CookFacts &facts)
{
    return double(facts.bytes) / double(facts.source_triangles);
}

static double empty_fraction(const BakeReport &bake)
{
    return double(bake.texels_empty) / double(bake.texels_total);
}

static std::string cook_summary(const CookFacts &facts)
{
    char line[200];
    snprintf(line, sizeof line,
             "%llu triangles, %llu patches, %llu texels (%.1f %% empty), %llu bytes (%.2f a "
             "triangle), %.2f s",
             (unsigned long long)facts.source_triangles, (unsigned long long)facts.chart_count,
             (unsigned long long)facts.bake.texels_total, 100 * empty_fraction(facts.bake),
             (unsigned long long)facts.bytes, per_triangle(facts), facts.total_seconds);
    return line;
}

void check_written(const Json &json)
{
    if (json.failed)
        throw std::bad_alloc();
}

/* The most memory this process has held so far. */
static uint64_t peak_rss_bytes()
{
    /* Of this program alone, where the system tells: the other figure starts with what the process
     * held before it became this program, which is its parent's memory. */
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0)
            return std::strtoull(line.c_str() + 6, nullptr, 10) * 1024;
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) ? 0 : uint64_t(usage.ru_maxrss) * 1024;
}

static void write_suitability(Json &json, const Suitability &suitability)
{
    gtx_json_begin_object(&json, "suitability");
    gtx_json_number(&json, "triangles_per_patch", suitability.triangles_per_patch);
    gtx_json_number(&json, "empty_fraction", suitability.empty_fraction);
    gtx_json_number(&json, "outline_loss", suitability.outline_loss);
    gtx_json_number(&json, "unseen_fraction", suitability.unseen_fraction);
    if (suitability.for_outlines)
        gtx_json_string(&json, "taken_for", "outlines");
    else
        gtx_json_null(&json, "taken_for");
    if (suitability.better)
        gtx_json_string(&json, "better", suitability.better);
    else
        gtx_json_null(&json, "better");
    gtx_json_end_object(&json);
}

/* What only a cook tells that has made something. */
static void write_made(Json &json, const Options &options, const CookFacts &facts)
{
    gtx_json_string(&json, "partition", partition_name(facts.method));
    gtx_json_integer(&json, "resolution", facts.suitability.resolution);
    write_charts(json, facts.charts);
    write_suitability(json, facts.suitability);
    write_extract(json, options.bake.extractor);
    gtx_json_begin_object(&json, "dropped_triangles");
    for (const auto &[reason, count] : facts.clean.dropped)
        gtx_json_integer(&json, reason.c_str(), count);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "texels_total", facts.bake.texels_total);
    gtx_json_integer(&json, "texels_empty", facts.bake.texels_empty);
    gtx_json_number(&json, "empty_fraction", empty_fraction(facts.bake));
    gtx_json_number(&json, "page_fill", facts.bake.page_fill);
    write_error(json, options, facts.error);
}

std::string write_cook_report(const Options &options, const CookFacts &facts, const Task &task,
                              Json &json)
{
    gtx_json_begin_object(&json, nullptr);
    gtx_json_bool(&json, "unchanged", facts.unchanged);
    gtx_json_bool(&json, "cached", facts.cached);
    gtx_json_begin_object(&json, "source");
    gtx_json_integer(&json, "triangles", facts.source_triangles);
    if (!facts.unchanged)
        gtx_json_integer(&json, "vertices", facts.source_vertices);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "charts", facts.chart_count);
    if (!facts.unchanged)
        write_made(json, options, facts);
    gtx_json_integer(&json, "bytes", facts.bytes);
    gtx_json_number(&json, "bytes_per_triangle", per_triangle(facts));
    write_lod(json, facts.lod, facts.lod_rms);
    gtx_json_begin_object(&json, "seconds");
    for (size_t i = 0; i < task.stages().size() && !facts.unchanged; ++i)
        gtx_json_number(&json, task.stages()[i], task.seconds()[i]);
    gtx_json_number(&json, "total", facts.total_seconds);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "peak_rss_bytes", peak_rss_bytes());
    gtx_json_hash(&json, "content_hash", facts.content_hash);
    gtx_json_hash(&json, "key", facts.key);
    write_warnings(json, task.warnings);
    gtx_json_end_object(&json);
    check_written(json);
    return facts.held        ? "the asset that the GLB holds"
           : facts.cached    ? "from the cache"
           : facts.unchanged ? "unchanged"
                             : cook_summary(facts);
}

/* Puts a string at `at`, which is moved behind it. */
static char *copy_string(const std::string &from, char *&at)
{
    char *copy = at;
    memcpy(copy, from.c_str(), from.size() + 1);
    at += from.size() + 1;
    return copy;
}

/* One block: the addresses of the strings, for they want alignment, the strings, and the JSON. */
Report::Report(const Json &text, const std::string &line, const Vector<std::string> &source,
               const Vector<Warning> &warning)
    : gtx_report{}
{
    allocator = text.allocator;
    block_size = (source.size() + 2 * warning.size()) * sizeof(char *) + text.size + 1;
    for (const std::string &s : source)
        block_size += s.size() + 1;
    for (const Warning &w : warning)
        block_size += w.sentence.size() + 1;
    block = gtx_alloc_array(&allocator, block_size, 1);
    if (!block)
        throw std::bad_alloc();

    sources = static_cast<char **>(block);
    warnings = sources + source.size();
    warning_names = const_cast<const char **>(warnings + warning.size());
    char *at = reinterpret_cast<char *>(warning_names + warning.size());
    for (const std::string &s : source)
        sources[source_count++] = copy_string(s, at);
    for (const bool notes : {false, true})
        for (const Warning &w : chosen(warning, notes)) {
            warning_names[warning_count] = gtx_warning_name(w.kind);
            warnings[warning_count++] = copy_string(w.sentence, at);
            note_count += notes;
        }
    json = at;
    size = text.size;
    memcpy(json, text.text, size + 1);
    snprintf(summary, sizeof summary, "%s", line.c_str());
}

} // namespace gtx

void gtx_report_free(gtx_report *report)
{
    if (!report)
        return;
    if (report->block)
        gtx_free_array(&report->allocator, report->block, report->block_size, 1);
    *report = {};
}
