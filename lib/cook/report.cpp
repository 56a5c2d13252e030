/* The reports of cooking and comparing, as JSON and as a line. */
#include "cook/report.hpp"

#include "mesh/task.hpp"

#include "base/alloc.h"

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace gtx {

static void write_deviation(Json &json, const char *key, const Deviation &deviation)
{
    gtx_json_begin_object(&json, key);
    gtx_json_number(&json, "rms", deviation.rms);
    gtx_json_number(&json, "max", deviation.max);
    gtx_json_end_object(&json);
}

static void write_strings(Json &json, const char *key, const std::vector<std::string> &strings)
{
    gtx_json_begin_array(&json, key);
    for (const std::string &s : strings)
        gtx_json_string(&json, nullptr, s.c_str());
    gtx_json_end_array(&json);
}

static void write_charts(Json &json, const CookFacts &facts)
{
    const ChartReport &charts = facts.charts;
    gtx_json_begin_object(&json, "source_folds");
    gtx_json_integer(&json, "triangles", charts.initial_inverted);
    gtx_json_integer(&json, "charts", charts.initial_folding);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "charts", facts.chart_count);
    gtx_json_integer(&json, "inverted_triangles", charts.inverted_triangles);
    gtx_json_integer(&json, "folding_charts", charts.folding_charts);
    gtx_json_number(&json, "second_layer_fraction", charts.second_layer_fraction);
    gtx_json_begin_object(&json, "junk");
    gtx_json_integer(&json, "triangles", charts.junk_triangles);
    gtx_json_number(&json, "area_fraction", charts.junk_area_fraction);
    gtx_json_end_object(&json);
}

static void write_extract(Json &json, const CookFacts &facts)
{
    gtx_json_begin_object(&json, "extract");
    gtx_json_string(&json, "by", facts.renderer.empty() ? "cpu" : "gpu");
    if (!facts.renderer.empty()) {
        gtx_json_string(&json, "renderer", facts.renderer.c_str());
        gtx_json_string(&json, "version", facts.version.c_str());
    }
    gtx_json_end_object(&json);
}

static void write_error(Json &json, const CookFacts &facts)
{
    gtx_json_begin_object(&json, "error");
    if (facts.requested > 0)
        gtx_json_number(&json, "requested", facts.requested);
    else
        gtx_json_null(&json, "requested");
    if (facts.measured) {
        write_deviation(json, "forward", facts.error.forward);
        write_deviation(json, "reverse", facts.error.reverse);
    } else {
        gtx_json_null(&json, "forward");
        gtx_json_null(&json, "reverse");
    }
    gtx_json_end_object(&json);
}

static void write_lod(Json &json, const CookFacts &facts)
{
    gtx_json_begin_array(&json, "lod_meshes");
    for (const gtx_lod_mesh &level : facts.lod) {
        gtx_json_begin_object(&json, nullptr);
        gtx_json_integer(&json, "triangles", level.triangle_count);
        gtx_json_integer(&json, "vertices", level.vertex_count);
        gtx_json_number(&json, "error", level.error);
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

static void check_written(const Json &json)
{
    if (json.failed)
        throw std::bad_alloc();
}

std::string write_cook_report(const CookFacts &facts, const std::vector<std::string> &warnings,
                              Json &json)
{
    gtx_json_begin_object(&json, nullptr);
    gtx_json_bool(&json, "unchanged", false);
    gtx_json_begin_object(&json, "source");
    gtx_json_integer(&json, "triangles", facts.source_triangles);
    gtx_json_integer(&json, "vertices", facts.source_vertices);
    gtx_json_end_object(&json);
    write_charts(json, facts);
    write_extract(json, facts);
    gtx_json_begin_object(&json, "dropped_triangles");
    for (const auto &[reason, count] : facts.clean.dropped)
        gtx_json_integer(&json, reason.c_str(), count);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "texels_total", facts.bake.texels_total);
    gtx_json_integer(&json, "texels_empty", facts.bake.texels_empty);
    gtx_json_number(&json, "empty_fraction", empty_fraction(facts.bake));
    gtx_json_number(&json, "page_fill", facts.bake.page_fill);
    write_error(json, facts);
    gtx_json_integer(&json, "bytes", facts.bytes);
    gtx_json_number(&json, "bytes_per_triangle", per_triangle(facts));
    gtx_json_integer(&json, "gpu_bytes", facts.gpu_bytes);
    write_lod(json, facts);
    gtx_json_begin_object(&json, "seconds");
    for (size_t i = 0; i < facts.stages.size(); ++i)
        gtx_json_number(&json, facts.stages[i], facts.seconds[i]);
    gtx_json_number(&json, "total", facts.total_seconds);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "peak_rss_bytes", peak_rss_bytes());
    gtx_json_hash(&json, "content_hash", facts.content_hash);
    gtx_json_hash(&json, "key", facts.key);
    write_strings(json, "warnings", warnings);
    gtx_json_end_object(&json);
    check_written(json);
    return cook_summary(facts);
}

std::string write_unchanged_report(const CookFacts &facts, Json &json)
{
    gtx_json_begin_object(&json, nullptr);
    gtx_json_bool(&json, "unchanged", true);
    gtx_json_begin_object(&json, "source");
    gtx_json_integer(&json, "triangles", facts.source_triangles);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "charts", facts.chart_count);
    gtx_json_integer(&json, "bytes", facts.bytes);
    gtx_json_number(&json, "bytes_per_triangle", per_triangle(facts));
    gtx_json_integer(&json, "gpu_bytes", facts.gpu_bytes);
    write_lod(json, facts);
    gtx_json_begin_object(&json, "seconds");
    gtx_json_number(&json, "total", facts.total_seconds);
    gtx_json_end_object(&json);
    gtx_json_integer(&json, "peak_rss_bytes", peak_rss_bytes());
    gtx_json_hash(&json, "content_hash", facts.content_hash);
    gtx_json_hash(&json, "key", facts.key);
    write_strings(json, "warnings", {});
    gtx_json_end_object(&json);
    check_written(json);
    return "unchanged";
}

std::string write_compare_report(const CompareReport &report,
                                 const std::vector<std::string> &warnings, Json &json)
{
    gtx_json_begin_object(&json, nullptr);
    gtx_json_integer(&json, "views", report.views);
    gtx_json_integer(&json, "surface_pixels", report.surface_pixels);
    gtx_json_integer(&json, "hole_pixels", report.hole_pixels);
    gtx_json_integer(&json, "leak_pixels", report.leak_pixels);
    gtx_json_begin_array(&json, "levels");
    for (const LevelReport &level : report.levels) {
        gtx_json_begin_object(&json, nullptr);
        gtx_json_integer(&json, "level", level.level);
        gtx_json_integer(&json, "hole_pixels", level.hole_pixels);
        gtx_json_integer(&json, "leak_pixels", level.leak_pixels);
        gtx_json_number(&json, "silhouette_iou", level.silhouette_iou);
        gtx_json_end_object(&json);
    }
    gtx_json_end_array(&json);
    gtx_json_begin_array(&json, "details");
    for (const DetailReport &detail : report.details) {
        gtx_json_begin_object(&json, nullptr);
        gtx_json_integer(&json, "size", detail.size);
        gtx_json_integer(&json, "surface_pixels", detail.surface_pixels);
        gtx_json_integer(&json, "hole_pixels", detail.hole_pixels);
        gtx_json_integer(&json, "leak_pixels", detail.leak_pixels);
        gtx_json_number(&json, "silhouette_iou", detail.silhouette_iou);
        gtx_json_end_object(&json);
    }
    gtx_json_end_array(&json);
    gtx_json_number(&json, "silhouette_iou", report.silhouette_iou);
    gtx_json_number(&json, "silhouette_iou_min", report.silhouette_iou_min);
    gtx_json_begin_object(&json, "depth_error");
    gtx_json_number(&json, "rms", report.depth_rms);
    gtx_json_number(&json, "p99", report.depth_p99);
    gtx_json_number(&json, "max", report.depth_max);
    gtx_json_end_object(&json);
    gtx_json_begin_object(&json, "normal_error_deg");
    gtx_json_number(&json, "mean", report.normal_mean_deg);
    gtx_json_number(&json, "p99", report.normal_p99_deg);
    gtx_json_end_object(&json);
    gtx_json_number(&json, "psnr_db", report.psnr_db);
    gtx_json_begin_object(&json, "error");
    write_deviation(json, "forward", report.error.forward);
    write_deviation(json, "reverse", report.error.reverse);
    gtx_json_end_object(&json);
    gtx_json_begin_object(&json, "seams");
    gtx_json_integer(&json, "points", report.seams.points);
    gtx_json_integer(&json, "within_two_steps", report.seams.within_two_steps);
    gtx_json_number(&json, "p99_steps", report.seams.p99_steps);
    gtx_json_number(&json, "max_steps", report.seams.max_steps);
    gtx_json_number(&json, "max", report.seams.max);
    gtx_json_end_object(&json);
    write_strings(json, "warnings", warnings);
    gtx_json_end_object(&json);
    check_written(json);

    char line[160];
    snprintf(line, sizeof line, "%llu hole pixels of %llu, silhouette IoU %.5f, forward RMS %.3g",
             (unsigned long long)report.hole_pixels, (unsigned long long)report.surface_pixels,
             report.silhouette_iou, report.error.forward.rms);
    return line;
}

void write_meta(const MetaFacts &facts, Json &json)
{
    char generator[32];
    snprintf(generator, sizeof generator, "geotex %d.%d.%d", GTX_VERSION_MAJOR, GTX_VERSION_MINOR,
             GTX_VERSION_PATCH);
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "generator", generator);
    gtx_json_begin_object(&json, "options");
    gtx_json_string(&json, "partition", facts.partition);
    if (facts.adaptive)
        gtx_json_bool(&json, "adaptive", true);
    gtx_json_integer(&json, "charts", facts.charts);
    gtx_json_integer(&json, "resolution", facts.resolution);
    gtx_json_integer(&json, "height_bits", facts.height_bits);
    gtx_json_integer(&json, "mips", facts.mips);
    gtx_json_integer(&json, "dilation", facts.dilation);
    gtx_json_integer(&json, "lod_levels", facts.lod_levels);
    gtx_json_string(&json, "up", facts.z_up ? "z" : "y");
    if (facts.by_gpu)
        gtx_json_string(&json, "extract", "gpu");
    gtx_json_end_object(&json);
    gtx_json_begin_object(&json, "source");
    gtx_json_integer(&json, "triangles", facts.source_triangles);
    gtx_json_hash(&json, "xxh64", facts.source_hash);
    gtx_json_end_object(&json);
    gtx_json_hash(&json, "key", facts.key);
    gtx_json_integer(&json, "warnings", facts.warnings);
    gtx_json_end_object(&json);
    check_written(json);
}

bool read_meta(const gtx_asset *asset, uint64_t &key, uint64_t &warnings)
{
    size_t size = 0;
    const char *text = gtx_meta(asset, &size);
    if (!text)
        return false;
    auto meta = nlohmann::json::parse(text, text + size, nullptr, false);
    if (!meta.is_object() || !meta.contains("key") || !meta["key"].is_string() ||
        !meta.contains("warnings") || !meta["warnings"].is_number_unsigned())
        return false;
    key = std::strtoull(meta["key"].get_ref<const std::string &>().c_str(), nullptr, 16);
    warnings = meta["warnings"];
    return true;
}

uint64_t gpu_bytes(const gtx_info &info)
{
    uint64_t pages = info.page_count, texels = pages * info.page_width * info.page_height;
    uint64_t bytes = texels; /* a byte of trim */
    /* Corner cells, the codes of a cell's four texels in one, and normals. */
    for (uint32_t k = 0; k < info.mip_count; ++k)
        bytes += (4 * info.height_bits / 8 + 2) * pages * (info.page_width >> k) *
                 (info.page_height >> k);
    /* Records in rows of 128, and a box of 8 vertices and 12 triangles a patch. */
    constexpr uint64_t RECORD = 192, ROW = 128, BOX = 8 * 16 + 36 * 4;
    return bytes + (info.patch_count + ROW - 1) / ROW * ROW * RECORD + info.patch_count * BOX;
}

uint64_t peak_rss_bytes()
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

/* Puts the strings behind each other at `at`, their addresses at `strings`. */
static char *copy_strings(const std::vector<std::string> &from, char **strings, char *at)
{
    for (const std::string &s : from) {
        *strings++ = at;
        memcpy(at, s.c_str(), s.size() + 1);
        at += s.size() + 1;
    }
    return at;
}

/* One block: the addresses of the strings, for they want alignment, the strings, and the JSON. */
Report::Report(const Json &text, const std::string &line, const std::vector<std::string> &source,
               const std::vector<std::string> &warning)
    : gtx_report{}
{
    allocator = text.allocator;
    block_size = (source.size() + warning.size()) * sizeof(char *) + text.size + 1;
    for (const auto *strings : {&source, &warning})
        for (const std::string &s : *strings)
            block_size += s.size() + 1;
    block = gtx_alloc_array(&allocator, block_size, 1);
    if (!block)
        throw std::bad_alloc();

    sources = static_cast<char **>(block);
    source_count = source.size();
    warnings = sources + source_count;
    warning_count = warning.size();
    char *at = reinterpret_cast<char *>(warnings + warning_count);
    at = copy_strings(source, sources, at);
    json = copy_strings(warning, warnings, at);
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
