/* An asset as a folder of images and one JSON file. */
#include "cli/unpack/unpacked.hpp"

#include "asset/asset.h"
#include "image/image.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

namespace gtx {

using Json = nlohmann::ordered_json;

static constexpr char FORMAT[] = "geotex unpacked asset 1";

std::string unpacked_name(const UnpackedMap &map, uint32_t page, uint32_t level)
{
    std::string name = map.name + ("-" + std::to_string(page));
    return name + (map.has_levels ? "-" + std::to_string(level) : "") + ".png";
}

static std::string in_folder(const std::string &folder, const std::string &name)
{
    return (std::filesystem::path(folder) / name).string();
}

/* ---- writing ---- */

template <class T> static Json list(const T *values, size_t count)
{
    Json out = Json::array();
    for (size_t i = 0; i < count; ++i)
        out.push_back(values[i]); /* floats become doubles, whose shortest text gives them again */
    return out;
}

static Json patch_json(const gtx_patch &p)
{
    return {{"origin", list(p.origin, 3)}, {"axis_x", list(p.axis_x, 3)},
            {"axis_y", list(p.axis_y, 3)}, {"axis_z", list(p.axis_z, 3)},
            {"extent", {p.extent_x, p.extent_y, p.extent_z}}, {"coverage", p.coverage},
            {"page", p.page}, {"rect", list(p.rect, 4)}, {"dilation", p.dilation},
            {"flags", p.flags}, {"sphere", list(p.sphere, 4)},
            {"source_triangles", p.source_triangles}};
}

static void write_image(const std::string &path, const UnpackedMap &map, uint32_t width,
                        uint32_t height, uint32_t bits, const uint8_t *texels)
{
    gtx_error error;
    gtx_result result;
    const size_t count = size_t(width) * height;
    if (map.map == GTX_MAP_HEIGHT && bits == 16) {
        std::vector<uint16_t> codes(count);
        for (size_t i = 0; i < count; ++i)
            codes[i] = uint16_t(texels[2 * i] | texels[2 * i + 1] << 8);
        result = gtx_image_write_png16(path.c_str(), width, height, codes.data(), &error);
    } else if (map.map == GTX_MAP_NORMAL) { /* two channels would be grey and alpha */
        std::vector<uint8_t> rgb(count * 3);
        for (size_t i = 0; i < count; ++i)
            std::copy_n(texels + 2 * i, 2, &rgb[3 * i]);
        result = gtx_image_write_png(path.c_str(), width, height, 3, rgb.data(), &error);
    } else {
        result = gtx_image_write_png(path.c_str(), width, height, map.channels, texels, &error);
    }
    if (result)
        throw Error(result, error.message);
}

static void write_images(const gtx_asset *asset, const gtx_info &info, const std::string &folder,
                         std::string &about)
{
    for (const UnpackedMap &map : UNPACKED_MAPS) {
        for (uint32_t level = 0; level < (map.has_levels ? info.mip_count : 1); ++level) {
            size_t size;
            const void *data = gtx_map_data(asset, map.map, level, &size);
            for (uint32_t page = 0; data && page < info.page_count; ++page) {
                about = in_folder(folder, unpacked_name(map, page, level));
                write_image(about, map, info.page_width >> level, info.page_height >> level,
                            info.height_bits,
                            static_cast<const uint8_t *>(data) + page * (size / info.page_count));
            }
        }
    }
}

static void write_lod(const gtx_asset *asset, const gtx_info &info, const std::string &folder,
                      Json &json, std::string &about)
{
    json["lod_meshes"] = Json::array();
    for (uint32_t k = 0; k < info.lod_levels; ++k) {
        gtx_lod_mesh level;
        gtx_get_lod_mesh(asset, k, &level);
        about = in_folder(folder, unpacked_lod_name(k));
        write_unpacked_lod(level, info.patch_count, about);
        json["lod_meshes"].push_back({{"origin", list(level.origin, 3)},
                               {"step", level.step},
                               {"error", level.error},
                               {"triangles", level.triangle_count},
                               {"vertices", level.vertex_count},
                               {"flags", level.flags}});
    }
}

void write_unpacked(const gtx_asset *asset, int zstd, const std::string &folder,
                    std::string &about)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    size_t meta_size;
    const char *meta = gtx_meta(asset, &meta_size);
    Json json = {{"format", FORMAT}, {"page_count", info.page_count},
                 {"page_size", {info.page_width, info.page_height}}, {"mip_count", info.mip_count},
                 {"height_bits", info.height_bits}, {"unit", info.unit},
                 {"anchor", list(info.anchor, 3)}, {"bounds_min", list(info.bounds_min, 3)},
                 {"bounds_max", list(info.bounds_max, 3)},
                 {"emission_scale", info.emission_scale},
                 {"has_color", info.has_color != 0}, {"has_material", info.has_material != 0},
                 {"has_emission", info.has_emission != 0},
                 {"source_triangles", info.source_triangles}, {"zstd", zstd}};
    if (meta)
        json["meta"] = std::string(meta, meta_size);
    json["patches"] = Json::array();
    for (uint32_t i = 0; i < info.patch_count; ++i)
        json["patches"].push_back(patch_json(gtx_patches(asset)[i]));
    write_images(asset, info, folder, about);
    write_lod(asset, info, folder, json, about);
    about = in_folder(folder, UNPACKED_JSON);
    std::ofstream file(about, std::ios::binary);
    file << json.dump(1) << '\n';
    file.close();
    if (!file)
        throw Error(GTX_ERROR_WRITE, "cannot be written");
}

/* ---- reading ---- */

/* Reads values out of the JSON; every fault names its field. */
struct Reader {
    [[noreturn]] void fail(const std::string &what) const { throw Error(GTX_ERROR_INPUT, what); }
    const Json &at(const Json &object, const char *name) const
    {
        auto found = object.find(name);
        if (found == object.end())
            fail(std::string(name) + " is missing");
        return *found;
    }
    double number(const Json &value, const char *name) const
    {
        if (!value.is_number())
            fail(std::string(name) + " is not a number");
        return value.get<double>();
    }
    uint64_t whole(const Json &object, const char *name, uint64_t most) const
    {
        const Json &value = at(object, name);
        if (!value.is_number_unsigned() || value.get<uint64_t>() > most)
            fail(std::string(name) + " is not a whole number up to " + std::to_string(most));
        return value.get<uint64_t>();
    }
    bool flag(const Json &object, const char *name) const
    {
        const Json &value = at(object, name);
        if (!value.is_boolean())
            fail(std::string(name) + " is neither true nor false");
        return value.get<bool>();
    }
    template <class T>
    void numbers(const Json &object, const char *name, T *out, size_t count) const
    {
        const Json &value = at(object, name);
        if (!value.is_array() || value.size() != count)
            fail(std::string(name) + " is not a list of " + std::to_string(count));
        for (size_t i = 0; i < count; ++i)
            out[i] = T(std::clamp(number(value[i], name), double(std::numeric_limits<T>::lowest()),
                                  double(std::numeric_limits<T>::max())));
    }
};

static gtx_patch read_patch(const Reader &reader, const Json &json)
{
    if (!json.is_object())
        reader.fail("a patch is not an object");
    gtx_patch p = {};
    float extent[3];
    reader.numbers(json, "origin", p.origin, 3);
    reader.numbers(json, "axis_x", p.axis_x, 3);
    reader.numbers(json, "axis_y", p.axis_y, 3);
    reader.numbers(json, "axis_z", p.axis_z, 3);
    reader.numbers(json, "extent", extent, 3);
    reader.numbers(json, "sphere", p.sphere, 4);
    reader.numbers(json, "rect", p.rect, 4);
    p.extent_x = extent[0];
    p.extent_y = extent[1];
    p.extent_z = extent[2];
    p.coverage = float(reader.number(reader.at(json, "coverage"), "coverage"));
    p.page = uint32_t(reader.whole(json, "page", UINT32_MAX));
    p.dilation = uint16_t(reader.whole(json, "dilation", UINT16_MAX));
    p.flags = uint16_t(reader.whole(json, "flags", UINT16_MAX));
    p.source_triangles = uint32_t(reader.whole(json, "source_triangles", UINT32_MAX));
    return p;
}

static Json parse(const std::string &path)
{
    constexpr uintmax_t MOST = uintmax_t(1) << 30;
    std::error_code error;
    const uintmax_t size = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file)
        throw Error(GTX_ERROR_READ, "cannot be read");
    if (size > MOST)
        throw Error(GTX_ERROR_LIMIT, "is larger than 1 GiB");
    Json json = Json::parse(file, nullptr, false);
    if (!json.is_object())
        throw Error(GTX_ERROR_INPUT, "is not a JSON object");
    return json;
}

static std::string describe(uint32_t width, uint32_t height, uint32_t channels, uint32_t depth)
{
    return std::to_string(width) + " x " + std::to_string(height) + " of " +
           std::to_string(channels) + " x " + std::to_string(8 * depth) + " bits";
}

/* Appends a page of a level as the asset holds it. */
static void read_image(const std::string &path, const UnpackedMap &map, uint32_t width,
                       uint32_t height, uint32_t bits, std::vector<uint8_t> &out)
{
    gtx_raw_image image;
    gtx_error error;
    if (gtx_result result = gtx_image_read_raw(path.c_str(), &image, &error))
        throw Error(result, error.message);
    std::unique_ptr<void, void (*)(void *)> guard(image.pixels, std::free);
    const uint32_t depth = map.map == GTX_MAP_HEIGHT ? bits / 8 : 1;
    if (image.width != width || image.height != height || image.channels != map.channels ||
        image.depth != depth)
        throw Error(GTX_ERROR_INPUT, "is " + describe(image.width, image.height, image.channels,
                                                      image.depth) +
                                         ", not " + describe(width, height, map.channels, depth));
    const size_t count = size_t(width) * height;
    const uint8_t *texels = static_cast<const uint8_t *>(image.pixels);
    if (depth == 2) {
        const uint16_t *codes = static_cast<const uint16_t *>(image.pixels);
        for (size_t i = 0; i < count; ++i)
            out.insert(out.end(), {uint8_t(codes[i]), uint8_t(codes[i] >> 8)});
    } else if (map.map == GTX_MAP_NORMAL) {
        for (size_t i = 0; i < count; ++i)
            out.insert(out.end(), texels + 3 * i, texels + 3 * i + 2);
    } else {
        out.insert(out.end(), texels, texels + count * map.channels);
    }
}

static void read_maps(const std::string &folder, const bool has[6], Unpacked &out,
                      std::string &about)
{
    const gtx_asset_desc &d = out.desc;
    for (size_t m = 0; m < 6; ++m) {
        const UnpackedMap &map = UNPACKED_MAPS[m];
        if (!has[m])
            continue;
        out.levels[m].resize(map.has_levels ? d.mip_count : 1);
        for (uint32_t level = 0; level < out.levels[m].size(); ++level)
            for (uint32_t page = 0; page < d.page_count; ++page) {
                about = in_folder(folder, unpacked_name(map, page, level));
                read_image(about, map, d.page_width >> level, d.page_height >> level,
                           d.height_bits, out.levels[m][level]);
            }
        for (const auto &level : out.levels[m])
            out.pointers[m].push_back(level.data());
    }
}

static void read_lod(const Reader &reader, const Json &levels, const std::string &folder,
                     Unpacked &out, std::string &about)
{
    if (!levels.is_array() || levels.size() > GTX_MAX_LODS)
        reader.fail("lod_meshes is not a list of up to 8 levels");
    out.lod_arrays.resize(levels.size());
    for (const Json &json : levels) {
        if (!json.is_object())
            reader.fail("one of lod_meshes is not an object");
        gtx_lod_mesh level = {};
        reader.numbers(json, "origin", level.origin, 3);
        level.step = float(reader.number(reader.at(json, "step"), "step"));
        level.error = float(reader.number(reader.at(json, "error"), "error"));
        level.triangle_count = uint32_t(reader.whole(json, "triangles", UINT32_MAX));
        level.vertex_count = uint32_t(reader.whole(json, "vertices", UINT32_MAX));
        level.flags = uint32_t(reader.whole(json, "flags", UINT32_MAX));
        const uint32_t k = uint32_t(out.lod.size());
        about = in_folder(folder, unpacked_lod_name(k));
        read_unpacked_lod(about, uint32_t(out.patches.size()), level, out.lod_arrays[k]);
        out.lod.push_back(level);
    }
    out.desc.lod = out.lod.data();
    out.desc.lod_levels = uint32_t(out.lod.size());
}

void read_unpacked(const std::string &folder, Unpacked &out, std::string &about)
{
    about = in_folder(folder, UNPACKED_JSON);
    const Json json = parse(about);
    const Reader reader;
    if (!(reader.at(json, "format") == FORMAT))
        reader.fail(std::string("format is not \"") + FORMAT + '"');
    gtx_asset_desc &d = out.desc;
    uint32_t size[2];
    reader.numbers(json, "page_size", size, 2);
    d.page_width = size[0];
    d.page_height = size[1];
    d.page_count = uint32_t(reader.whole(json, "page_count", GTX_MAX_PAGES));
    d.mip_count = uint32_t(reader.whole(json, "mip_count", GTX_MAX_MIPS));
    d.height_bits = uint32_t(reader.whole(json, "height_bits", 16));
    if (!d.page_count || !d.mip_count || (d.height_bits != 8 && d.height_bits != 16) ||
        std::max(size[0], size[1]) > GTX_MAX_PAGE_SIDE || std::min(size[0], size[1]) < 1)
        reader.fail("the pages, levels or bits are not those of an asset");
    d.unit = float(reader.number(reader.at(json, "unit"), "unit"));
    d.emission_scale = float(reader.number(reader.at(json, "emission_scale"), "emission_scale"));
    reader.numbers(json, "anchor", d.anchor, 3);
    reader.numbers(json, "bounds_min", d.bounds_min, 3);
    reader.numbers(json, "bounds_max", d.bounds_max, 3);
    d.source_triangles = reader.whole(json, "source_triangles", UINT64_MAX);
    const Json &zstd = reader.at(json, "zstd");
    out.zstd = zstd == -1 ? -1 : int(reader.whole(json, "zstd", 19));
    if (json.contains("meta")) {
        if (!json["meta"].is_string())
            reader.fail("meta is not a string");
        out.meta = json["meta"].get<std::string>();
    }
    const Json &patches = reader.at(json, "patches");
    if (!patches.is_array() || patches.empty() || patches.size() > GTX_MAX_PATCHES)
        reader.fail("patches is not a list of patches");
    for (const Json &patch : patches)
        out.patches.push_back(read_patch(reader, patch));

    const bool has[6] = {true, true, true, reader.flag(json, "has_color"),
                         reader.flag(json, "has_material"), reader.flag(json, "has_emission")};
    read_lod(reader, reader.at(json, "lod_meshes"), folder, out, about);
    read_maps(folder, has, out, about);
    auto levels = [&](size_t m) { return has[m] ? out.pointers[m].data() : nullptr; };
    d.patches = out.patches.data();
    d.patch_count = uint32_t(out.patches.size());
    d.height = out.pointers[0][0];
    d.trim = out.pointers[1][0];
    d.normal = levels(2);
    d.color = levels(3);
    d.material = levels(4);
    d.emission = levels(5);
    d.meta = out.meta.empty() ? nullptr : out.meta.data();
    d.meta_size = out.meta.size();
}

/* ---- what follows from edited heights ---- */

void derive_again(Unpacked &unpacked)
{
    gtx_asset_desc &d = unpacked.desc;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    const uint32_t bytes = d.height_bits / 8;
    for (gtx_patch &p : unpacked.patches) {
        if (p.page >= d.page_count || p.rect[0] + p.rect[2] > d.page_width ||
            p.rect[1] + p.rect[3] > d.page_height)
            continue; /* gtx_create will say so */
        const size_t row = size_t(p.page) * d.page_height + p.rect[1];
        const size_t first = (row * d.page_width + p.rect[0]) * bytes;
        const gtx_code_map codes = {static_cast<const uint8_t *>(d.height) + first, d.page_width,
                                    bytes, d.height_bits};
        const gtx_patch_span span = gtx_measure_patch(&p, &codes);
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], span.low[k]);
            high[k] = std::max(high[k], span.high[k]);
        }
    }
    for (int k = 0; k < 3 && low[0] <= high[0]; ++k) {
        d.bounds_min[k] = float(low[k]);
        d.bounds_max[k] = float(high[k]);
    }
    if (d.lod_levels)
        unpacked.warnings.push_back("the LOD mesh does not follow the heights and was left out");
    d.lod_levels = 0;
    unpacked.warnings.push_back("coverage, spheres and bounds were computed anew from the heights");
}

} // namespace gtx
