/* The META section of an asset: what made it, from what. */
#include "cook/meta.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstdlib>

namespace gtx {

std::string write_meta(const Options &options, const CookFacts &facts)
{
    char generator[32];
    snprintf(generator, sizeof generator, "geotex %d.%d.%d", GTX_VERSION_MAJOR, GTX_VERSION_MINOR,
             GTX_VERSION_PATCH);
    Json json(options.allocator);
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "generator", generator);
    gtx_json_begin_object(&json, "options");
    gtx_json_string(&json, "partition", partition_name(facts.method));
    if (options.chart.adaptive)
        gtx_json_bool(&json, "adaptive", true);
    if (options.chart.texel_density != 0)
        gtx_json_number(&json, "texel_density", options.chart.texel_density);
    gtx_json_integer(&json, "charts", facts.chart_count);
    gtx_json_integer(&json, "resolution", facts.suitability.resolution);
    gtx_json_integer(&json, "height_bits", options.bake.height_bits);
    gtx_json_integer(&json, "mips", options.bake.mips);
    gtx_json_integer(&json, "dilation", options.bake.dilation);
    gtx_json_integer(&json, "lod_levels", options.lod_levels);
    gtx_json_string(&json, "up", options.z_up ? "z" : "y");
    if (options.kept_count)
        gtx_json_integer(&json, "kept", options.kept_count);
    if (options.closed)
        gtx_json_bool(&json, "closed", true);
    if (options.texture_formats)
        gtx_json_integer(&json, "texture_formats", options.texture_formats);
    if (options.bake.extractor)
        gtx_json_string(&json, "extract", "gpu");
    gtx_json_end_object(&json);
    gtx_json_begin_object(&json, "source");
    gtx_json_integer(&json, "triangles", facts.source_triangles);
    gtx_json_hash(&json, "xxh64", facts.source_hash);
    gtx_json_end_object(&json);
    gtx_json_hash(&json, "key", facts.key);
    gtx_json_begin_array(&json, "warnings");
    for (size_t kind = 0; kind < facts.warnings.size(); ++kind)
        if (facts.warnings[kind])
            gtx_json_string(&json, nullptr, gtx_warning_name(gtx_warning(kind)));
    gtx_json_end_array(&json);
    gtx_json_end_object(&json);
    check_written(json);
    return std::string(json.text, json.size);
}

static nlohmann::json parse_meta(const gtx_asset *asset)
{
    size_t size = 0;
    const char *text = gtx_meta(asset, &size);
    return text ? nlohmann::json::parse(text, text + size, nullptr, false) : nlohmann::json();
}

bool read_source_hash(const gtx_asset *asset, uint64_t &hash)
{
    const auto meta = parse_meta(asset);
    if (!meta.is_object() || !meta.contains("source") || !meta["source"].is_object() ||
        !meta["source"].contains("xxh64") || !meta["source"]["xxh64"].is_string())
        return false;
    hash = std::strtoull(meta["source"]["xxh64"].get_ref<const std::string &>().c_str(), nullptr,
                         16);
    return true;
}

bool was_closed(const gtx_asset *asset)
{
    const auto meta = parse_meta(asset);
    return meta.is_object() && meta.contains("options") && meta["options"].is_object() &&
           meta["options"].contains("closed") && meta["options"]["closed"] == true;
}

bool read_meta(const gtx_asset *asset, uint64_t &key, std::bitset<GTX_WARNING_COUNT> &warnings)
{
    const auto meta = parse_meta(asset);
    if (!meta.is_object() || !meta.contains("key") || !meta["key"].is_string() ||
        !meta.contains("warnings") || !meta["warnings"].is_array())
        return false;
    key = std::strtoull(meta["key"].get_ref<const std::string &>().c_str(), nullptr, 16);
    for (const auto &name : meta["warnings"]) {
        const std::string known = name.is_string() ? name.get<std::string>() : "";
        const gtx_warning kind = gtx_warning_named(known.c_str());
        if (kind == GTX_WARNING_COUNT)
            return false;
        warnings.set(kind);
    }
    return true;
}

} // namespace gtx
