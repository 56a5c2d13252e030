/* Checking descriptors, filling in defaults, and the key over them. */
#include "cook/options.hpp"

#include "cook/guard.hpp"

#include "asset/patch.h"
#include "base/alloc.h"
#include "base/hash.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace gtx {

/* As in asset/write.c. */
#ifdef GTX_ZSTD
constexpr int DEFAULT_ZSTD = 6;
#else
constexpr int DEFAULT_ZSTD = 0;
#endif

/* In the order of gtx_partition. */
constexpr PartitionMethod METHODS[] = {PartitionMethod::DEFAULT, PartitionMethod::CUTS,
                                       PartitionMethod::VSA, PartitionMethod::PGP,
                                       PartitionMethod::LAYERS, PartitionMethod::RELIEF,
                                       PartitionMethod::AUTO};

static void check(const gtx_cook_desc &desc)
{
    require_zeroed(desc.reserved);
    require_limits(desc.limits);
    require_argument(number_of(desc.partition) <= GTX_PARTITION_AUTO, "unknown partition");
    require_argument(number_of(desc.extract) <= GTX_EXTRACT_GPU, "unknown extraction");
    require_argument(desc.charts <= 1u << 20, "charts is at most 2^20");
    require_argument(!desc.resolution || (desc.resolution >= 64 && desc.resolution <= 512),
                     "resolution is 64 to 512");
    require_argument(!desc.height_bits || desc.height_bits == 8 || desc.height_bits == 16,
                     "height_bits is 8 or 16");
    require_argument(desc.dilation <= 128, "dilation is at most 128");
    require_argument(desc.mips <= 8, "mips is 1 to 8");
    require_argument(is_lod_levels(desc.lod_levels),
                     "lod_levels is 0 to 5, or GTX_LOD_LEVELS_NONE");
    require_argument(desc.zstd_level >= -1 && desc.zstd_level <= 19, "zstd_level is -1 to 19");
    require_argument(desc.threads <= 1024, "threads is at most 1024");
    require_argument(desc.unit >= 0 && std::isfinite(desc.unit), "unit is a positive number");
    require_argument(desc.error >= 0 && desc.error < 1, "error is a fraction of the diagonal");
    const bool any_density = number_of(desc.partition) <= GTX_PARTITION_CUTS ||
                             number_of(desc.partition) == GTX_PARTITION_LAYERS ||
                             number_of(desc.partition) == GTX_PARTITION_AUTO;
    require_argument(desc.error == 0 || any_density,
                     "an error can be asked for with the partitions cuts, layers and auto only");
    require_argument(desc.texel_density == GTX_TEXEL_DENSITY_RELIEF ||
                         (desc.texel_density >= 0 && desc.texel_density <= 4),
                     "texel_density is 0 to 4, or GTX_TEXEL_DENSITY_RELIEF");
    require_argument(desc.adaptive <= 1, "adaptive is 0 or 1");
    require_argument(!desc.adaptive || number_of(desc.partition) == GTX_PARTITION_PGP,
                     "only the partition pgp can be adaptive");
    require_argument(desc.measure <= 1, "measure is 0 or 1");
    require_argument(desc.z_up <= 1, "z_up is 0 or 1");
    require_argument(desc.strict <= 1, "strict is 0 or 1");
    require_argument(desc.if_changed <= 1, "if_changed is 0 or 1");
    require_argument(desc.kept || !desc.kept_count, "kept is NULL, and kept_count is not 0");
    require_argument(desc.kept_count <= UINT32_MAX, "kept_count is at most 2^32 - 1");
    require_argument(desc.closed <= 1, "closed is 0 or 1");
    require_argument(desc.texture_formats < 16 && desc.texture_formats != GTX_TEXTURES_NORMALS,
                     "texture_formats has a kind of blocks, and no bit that is unknown");
    require_models(desc.more, desc.more_count);
    require_argument(desc.allow_count <= 64, "allow_count is at most 64");
    require_argument(desc.allow || !desc.allow_count, "allow is NULL, and allow_count is not 0");
}

static std::bitset<GTX_WARNING_COUNT> allowed_by(const gtx_cook_desc &desc)
{
    std::bitset<GTX_WARNING_COUNT> out;
    for (int kind = 0; kind < GTX_WARNING_COUNT; ++kind)
        out[size_t(kind)] = gtx_warning_is_note(gtx_warning(kind));
    for (uint32_t i = 0; i < desc.allow_count; ++i) {
        require_argument(desc.allow[i], "one of the allowed names is NULL");
        const gtx_warning kind = gtx_warning_named(desc.allow[i]);
        if (kind == GTX_WARNING_COUNT)
            throw Error(GTX_ERROR_ARGUMENT,
                        "there is no warning '" + std::string(desc.allow[i]) + "' to allow");
        out.set(kind);
    }
    return out;
}

Options checked_options(const gtx_cook_desc &desc)
{
    check(desc);
    Options options;
    options.chart.charts = desc.charts;
    options.chart.method = METHODS[number_of(desc.partition)];
    options.chart.adaptive = desc.adaptive;
    options.chart.texel_density = double(desc.texel_density);
    if (desc.resolution)
        options.chart.resolution = desc.resolution;
    options.chart.free_resolution = !desc.resolution && desc.error == 0;
    /* Who says how dense it is to be has said it; borders that are kept are no outlines. */
    if (number_of(desc.partition) == GTX_PARTITION_DEFAULT &&
        (!options.chart.free_resolution || desc.charts || desc.kept_count))
        options.chart.method = PartitionMethod::CUTS;
    if (desc.height_bits)
        options.bake.height_bits = desc.height_bits;
    if (desc.mips)
        options.bake.mips = desc.mips;
    options.chart.height_steps = gtx_height_steps(options.bake.height_bits);
    options.chart.grain = 1u << (options.bake.mips - 1);
    options.bake.dilation = desc.dilation ? desc.dilation : 1u << (options.bake.mips - 1);
    if (number_of(desc.extract) == GTX_EXTRACT_GPU) {
        options.driver = std::make_shared<const Driver>();
        options.bake.extractor = &options.driver->extractor();
    }
    options.lod_levels = lod_levels_of(desc.lod_levels);
    options.zstd = desc.zstd_level == 0 ? DEFAULT_ZSTD : std::max(desc.zstd_level, 0);
    options.unit = desc.unit > 0 ? desc.unit : 1;
    options.error = desc.error;
    options.free_bits = desc.error > 0 && !desc.height_bits;
    options.free_charts = desc.error > 0 && !desc.charts;
    options.measure = desc.measure || desc.error > 0;
    options.z_up = desc.z_up;
    options.strict = desc.strict;
    options.allowed = allowed_by(desc);
    options.if_changed = desc.if_changed;
    options.closed = desc.closed;
    options.kept = desc.kept;
    options.kept_count = desc.kept_count;
    options.texture_formats = desc.texture_formats;
    options.charts_ply = desc.charts_ply;
    options.cache = desc.cache;
    options.allocator = gtx_allocator_or_default(desc.allocator);
    return options;
}

double work_of(const Options &options)
{
    constexpr double OTHER_PARTITION = 8, PATCHES = 1000;
    double finer = options.chart.resolution / 128.;
    if (options.chart.method == PartitionMethod::AUTO && options.chart.free_resolution)
        finer *= 2;
    double times = std::max({1., finer * finer, options.chart.charts / PATCHES});
    if (options.chart.method != PartitionMethod::CUTS &&
        options.chart.method != PartitionMethod::DEFAULT)
        times *= OTHER_PARTITION;
    return times;
}

const char *partition_name(PartitionMethod method)
{
    switch (method) {
    case PartitionMethod::VSA: return "vsa";
    case PartitionMethod::PGP: return "pgp";
    case PartitionMethod::LAYERS: return "layers";
    case PartitionMethod::RELIEF: return "relief";
    case PartitionMethod::AUTO: return "auto";
    case PartitionMethod::DEFAULT: return "default";
    default: return "cuts";
    }
}

uint64_t content_key(const Options &options, uint64_t source_hash)
{
    uint32_t unit_bits;
    std::memcpy(&unit_bits, &options.unit, sizeof unit_bits);
    uint64_t error_bits;
    std::memcpy(&error_bits, &options.error, sizeof error_bits);
    char numbers[512]; /* more than the longest take */
    int size = snprintf(numbers, sizeof numbers,
                        "geotex %d revision %d source %016" PRIx64 " partition %s charts %u "
                        "resolution %u bits %u mips %u dilation %u LOD mesh %u zstd %d unit %08"
                        PRIx32 " error %016" PRIx64 " up %c",
                        GTX_VERSION, COOKER_REVISION, source_hash,
                        partition_name(options.chart.method),
                        options.chart.charts, options.chart.resolution,
                        options.free_bits ? 0 : options.bake.height_bits, options.bake.mips,
                        options.bake.dilation, options.lod_levels, options.zstd, unit_bits,
                        error_bits,
                        options.z_up ? 'z' : 'y');
    std::string text(numbers, size_t(size));
    if (options.chart.adaptive)
        text += " adaptive";
    if (options.chart.method == PartitionMethod::AUTO && options.chart.free_resolution)
        text += " free resolution";
    if (options.kept_count)
        text += " kept " + std::to_string(gtx_hash_bytes(options.kept, options.kept_count *
                                                                           3 * sizeof(double)));
    if (options.closed)
        text += " closed";
    if (options.texture_formats)
        text += " textures " + std::to_string(options.texture_formats);
    if (options.chart.texel_density != 0)
        text += " density " + std::to_string(gtx_hash_bytes(&options.chart.texel_density,
                                                            sizeof(double)));
    if (const Extractor *gpu = options.bake.extractor)
        text += " extract gpu " + gpu->renderer() + " " + gpu->version();
    return gtx_hash_bytes(text.data(), text.size());
}

} // namespace gtx
