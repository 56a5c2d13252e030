/* Reading the folder of images and the JSON file that an asset was written as. */
#include "cli/unpack/json.hpp"
#include "cli/unpack/unpacked.hpp"

#include "asset/asset.h"
#include "image/image.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

namespace gtx {

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

static std::array<uint64_t, 12> read_hashes(const Reader &reader, const Json &json)
{
    std::array<uint64_t, 12> out;
    if (!json.is_array() || json.size() != out.size())
        reader.fail("hashes is not a list of 12");
    for (size_t i = 0; i < out.size(); ++i) {
        if (!json[i].is_string())
            reader.fail("one of the hashes is not a string");
        out[i] = std::strtoull(json[i].get_ref<const std::string &>().c_str(), nullptr, 16);
    }
    return out;
}

static Json parse(const std::string &path)
{
    constexpr uintmax_t MAX_SIZE = uintmax_t(1) << 30;
    std::error_code error;
    const uintmax_t size = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file)
        throw Error(GTX_ERROR_READ, "cannot be read");
    if (size > MAX_SIZE)
        throw Error(GTX_ERROR_LIMIT, "is larger than 1 GiB");
    Json json = Json::parse(file, nullptr, false);
    if (!json.is_object())
        throw Error(GTX_ERROR_INPUT, "is not a JSON object");
    return json;
}

/* 0 of what is not there. */
static uint64_t size_of(const std::string &path)
{
    std::error_code error;
    const uintmax_t size = std::filesystem::file_size(path, error);
    return error ? 0 : size;
}

static std::string describe(uint32_t width, uint32_t height, uint32_t channels, uint32_t depth)
{
    return std::to_string(width) + " x " + std::to_string(height) + " of " +
           std::to_string(channels) + " x " + std::to_string(8 * depth) + " bits";
}

/* Appends a page of a level as the asset holds it. */
static void read_image(const std::string &path, const UnpackedMap &map, uint32_t width,
                       uint32_t height, uint32_t bits, Vector<uint8_t> &out)
{
    gtx_raw_image image;
    gtx_error error;
    require_ok(gtx_image_read_raw(path.c_str(), &image, &error), error);
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
        out.insert(out.end(), texels, texels + 2 * count);
    } else if (map.map == GTX_MAP_NORMAL) {
        for (size_t i = 0; i < count; ++i)
            out.insert(out.end(), texels + 3 * i, texels + 3 * i + 2);
    } else {
        out.insert(out.end(), texels, texels + count * map.channels);
    }
}

static void read_maps(const std::string &folder, const bool has[6], Limits &limits,
                      Unpacked &out, std::string &about)
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
                limits.read(about, size_of(about));
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
        if (level.flags & GTX_LOD_NORMALS)
            level.normal_error =
                float(reader.number(reader.at(json, "normal_error"), "normal_error"));
        const uint32_t k = uint32_t(out.lod.size());
        about = in_folder(folder, unpacked_lod_name(k));
        read_unpacked_lod(about, uint32_t(out.patches.size()), level, out.lod_arrays[k]);
        out.lod.push_back(level);
    }
    out.desc.lod = out.lod.data();
    out.desc.lod_levels = uint32_t(out.lod.size());
}

/* What the header of an asset has. */
static void read_header(const Reader &reader, const Json &json, Limits &limits, Unpacked &out)
{
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
    limits.require(GTX_LIMITED_TEXELS, "the asset",
                   uint64_t(d.page_count) * d.page_width * d.page_height);
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
}

static void read_patches(const Reader &reader, const Json &json, Limits &limits, Unpacked &out)
{
    const Json &patches = reader.at(json, "patches");
    if (!patches.is_array() || patches.empty() || patches.size() > GTX_MAX_PATCHES)
        reader.fail("patches is not a list of patches");
    limits.require(GTX_LIMITED_PATCHES, "the asset", patches.size());
    for (const Json &patch : patches) {
        out.patches.push_back(read_patch(reader, patch));
        if (patch.contains("hashes"))
            out.hashes.push_back(read_hashes(reader, patch["hashes"]));
    }
    if (out.hashes.size() != out.patches.size())
        out.hashes.clear();
}

void read_unpacked(const std::string &folder, Limits &limits, Unpacked &out, std::string &about)
{
    about = in_folder(folder, UNPACKED_JSON);
    const JsonTree tree{parse(about)};
    const Json &json = tree.root;
    const Reader reader;
    const Json &format = reader.at(json, "format");
    if (!format.is_string() || format.get_ref<const std::string &>() != UNPACKED_FORMAT)
        reader.fail(std::string("format is not \"") + UNPACKED_FORMAT + '"');
    read_header(reader, json, limits, out);
    read_patches(reader, json, limits, out);
    const bool has[6] = {true, true, true, reader.flag(json, "has_color"),
                         reader.flag(json, "has_material"), reader.flag(json, "has_emission")};
    read_lod(reader, reader.at(json, "lod_meshes"), folder, out, about);
    read_maps(folder, has, limits, out, about);
    gtx_asset_desc &d = out.desc;
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

} // namespace gtx
