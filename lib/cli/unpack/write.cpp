/* Writing an asset as a folder of images and one JSON file. */
#include "cli/guard.hpp"
#include "cli/unpack/json.hpp"
#include "cli/unpack/rebuild.hpp"

#include "base/output.h"
#include "image/image.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <filesystem>

namespace gtx {

std::string unpacked_name(const UnpackedMap &map, uint32_t page, uint32_t level)
{
    std::string name = map.name + ("-" + std::to_string(page));
    return name + (map.has_levels ? "-" + std::to_string(level) : "") + ".png";
}

std::string in_folder(const std::string &folder, const std::string &name)
{
    return (std::filesystem::path(folder) / name).string();
}

template <class T> static Json list(const T *values, size_t count)
{
    Json out = Json::array();
    for (size_t i = 0; i < count; ++i)
        out.push_back(values[i]); /* floats become doubles, whose shortest text gives them again */
    return out;
}

/* Member by member: lists of initial values are copied, and destroyed as trees are. */
static Json patch_json(const gtx_patch &p)
{
    const float extent[] = {p.extent_x, p.extent_y, p.extent_z};
    Json out = Json::object();
    out["origin"] = list(p.origin, 3);
    out["axis_x"] = list(p.axis_x, 3);
    out["axis_y"] = list(p.axis_y, 3);
    out["axis_z"] = list(p.axis_z, 3);
    out["extent"] = list(extent, 3);
    out["coverage"] = p.coverage;
    out["page"] = p.page;
    out["rect"] = list(p.rect, 4);
    out["dilation"] = p.dilation;
    out["flags"] = p.flags;
    out["sphere"] = list(p.sphere, 4);
    out["source_triangles"] = p.source_triangles;
    return out;
}

/* To read, not to write. */
static PageMaps levels_of(const gtx_asset *asset, const gtx_info &info)
{
    PageMaps out;
    out.width = info.page_width;
    out.height = info.page_height;
    out.mip_count = info.mip_count;
    out.bits = info.height_bits;
    for (size_t map = 0; map < 6; ++map)
        for (uint32_t k = 0; k < (UNPACKED_MAPS[map].has_levels ? info.mip_count : 1); ++k) {
            size_t size;
            const void *texels = gtx_map_data(asset, UNPACKED_MAPS[map].map, k, &size);
            out.levels[map][k] = static_cast<uint8_t *>(const_cast<void *>(texels));
        }
    return out;
}

static void write_image(const std::string &path, const UnpackedMap &map, uint32_t width,
                        uint32_t height, uint32_t bits, const uint8_t *texels)
{
    gtx_error error;
    gtx_result result;
    const size_t count = size_t(width) * height;
    if (map.map == GTX_MAP_HEIGHT && bits == 16) {
        Vector<uint16_t> codes(count);
        for (size_t i = 0; i < count; ++i)
            codes[i] = uint16_t(gtx_load_own_u16(texels + 2 * i));
        result = gtx_image_write_png16(path.c_str(), width, height, codes.data(), &error);
    } else if (map.map == GTX_MAP_NORMAL) { /* two channels would be grey and alpha */
        Vector<uint8_t> rgb(count * 3);
        for (size_t i = 0; i < count; ++i)
            std::copy_n(texels + 2 * i, 2, &rgb[3 * i]);
        result = gtx_image_write_png(path.c_str(), width, height, 3, rgb.data(), &error);
    } else {
        result = gtx_image_write_png(path.c_str(), width, height, map.channels, texels, &error);
    }
    require_ok(result, error);
}

static void write_images(const gtx_asset *asset, const gtx_info &info, const std::string &folder,
                         std::string &about)
{
    for (const UnpackedMap &map : UNPACKED_MAPS) {
        for (uint32_t level = 0; level < (map.has_levels ? info.mip_count : 1); ++level) {
            size_t size;
            const void *data = gtx_map_data(asset, map.map, level, &size);
            for (uint32_t page = 0; data && page < info.page_count; ++page) {
                stop_if_interrupted();
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
        Json member = Json::object();
        member["origin"] = list(level.origin, 3);
        member["step"] = level.step;
        member["error"] = level.error;
        member["triangles"] = level.triangle_count;
        member["vertices"] = level.vertex_count;
        member["flags"] = level.flags;
        if (level.normals)
            member["normal_error"] = level.normal_error;
        json["lod_meshes"].push_back(std::move(member));
    }
}

void write_unpacked(const gtx_asset *asset, int zstd, const std::string &folder,
                    std::string &about)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    size_t meta_size;
    const char *meta = gtx_meta(asset, &meta_size);
    const uint32_t size[] = {info.page_width, info.page_height};
    JsonTree tree{Json::object()}; /* made at once: what cannot be is no half of one */
    Json &json = tree.root;
    json["format"] = UNPACKED_FORMAT;
    json["page_count"] = info.page_count;
    json["page_size"] = list(size, 2);
    json["mip_count"] = info.mip_count;
    json["height_bits"] = info.height_bits;
    json["unit"] = info.unit;
    json["anchor"] = list(info.anchor, 3);
    json["bounds_min"] = list(info.bounds_min, 3);
    json["bounds_max"] = list(info.bounds_max, 3);
    json["emission_scale"] = info.emission_scale;
    json["has_color"] = info.has_color != 0;
    json["has_material"] = info.has_material != 0;
    json["has_emission"] = info.has_emission != 0;
    json["source_triangles"] = info.source_triangles;
    json["zstd"] = zstd;
    if (meta)
        json["meta"] = std::string(meta, meta_size);
    json["patches"] = Json::array();
    const PageMaps maps = levels_of(asset, info);
    for (uint32_t i = 0; i < info.patch_count; ++i) {
        const gtx_patch &patch = gtx_patches(asset)[i];
        Json member = patch_json(patch);
        member["hashes"] = Json::array(); /* by which packing knows what was edited */
        for (const uint64_t hash : hash_patch(maps, patch)) {
            char text[24];
            snprintf(text, sizeof text, "0x%016" PRIx64, hash);
            member["hashes"].push_back(text);
        }
        json["patches"].push_back(std::move(member));
    }
    write_images(asset, info, folder, about);
    write_lod(asset, info, folder, json, about);
    about = in_folder(folder, UNPACKED_JSON);
    const std::string text = json.dump(1) + '\n';
    gtx_error error;
    require_ok(gtx_write_file(about.c_str(), text.data(), text.size(), &error), error);
}

} // namespace gtx
