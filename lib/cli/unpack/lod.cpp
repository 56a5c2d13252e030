/* Levels of the LOD mesh in an unpacked folder: a file each of first, indices, positions and
 * normals, as format/gtx.md lays them out; the rest is in the JSON. */
#include "cli/unpack/unpacked.hpp"

#include "bake/lod_normals.hpp"
#include "base/output.h"

#include <filesystem>
#include <fstream>

namespace gtx {

std::string unpacked_lod_name(uint32_t level)
{
    return "lod-" + std::to_string(level) + ".bin";
}

void write_unpacked_lod(const gtx_lod_mesh &level, uint32_t patches, const std::string &path)
{
    Vector<char> file;
    auto put = [&](const void *data, size_t size) {
        const char *bytes = static_cast<const char *>(data);
        file.insert(file.end(), bytes, bytes + size);
    };
    put(level.first, 4 * (size_t(patches) + 1));
    put(level.indices, 12 * size_t(level.triangle_count));
    put(level.positions, 6 * size_t(level.vertex_count));
    if (level.normals)
        put(level.normals, 2 * size_t(level.vertex_count));
    gtx_error error;
    require_ok(gtx_write_file(path.c_str(), file.data(), file.size(), &error), error);
}

void read_unpacked_lod(const std::string &path, uint32_t patches, gtx_lod_mesh &level,
                       UnpackedLod &out)
{
    const uint64_t numbers = uint64_t(patches) + 1 + 3 * uint64_t(level.triangle_count);
    const uint64_t places = 3 * uint64_t(level.vertex_count);
    const uint64_t codes = level.flags & GTX_LOD_NORMALS ? 2 * uint64_t(level.vertex_count) : 0;
    std::error_code error;
    const uintmax_t size = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file)
        throw Error(GTX_ERROR_READ, "cannot be read");
    if (size != 4 * numbers + 2 * places + codes)
        throw Error(GTX_ERROR_INPUT, "has not the size that asset.json tells");
    out.numbers.resize(numbers);
    out.positions.resize(places);
    out.normals.resize(codes);
    file.read(reinterpret_cast<char *>(out.numbers.data()), std::streamsize(4 * numbers));
    file.read(reinterpret_cast<char *>(out.positions.data()), std::streamsize(2 * places));
    file.read(reinterpret_cast<char *>(out.normals.data()), std::streamsize(codes));
    if (!file)
        throw Error(GTX_ERROR_READ, "cannot be read");
    level.first = out.numbers.data();
    level.indices = out.numbers.data() + patches + 1;
    level.positions = out.positions.data();
    level.normals = codes ? out.normals.data() : nullptr;
}

bool drop_lod_normals(Unpacked &unpacked)
{
    bool any = false;
    for (gtx_lod_mesh &level : unpacked.lod) {
        any = any || level.normals;
        level.flags &= ~GTX_LOD_NORMALS;
        level.normals = nullptr;
        level.normal_error = 0;
    }
    return any;
}

void fit_lod_normals(Unpacked &unpacked)
{
    const gtx_asset_desc &d = unpacked.desc;
    const NormalMaps maps = {d.patches, d.patch_count, d.page_width, d.page_height, d.height_bits,
                             static_cast<const uint8_t *>(d.height), d.normal[0]};
    Vector<LodNormals> made;
    Task task(0, nullptr, nullptr);
    add_lod_normals(unpacked.lod, maps, made, task);
    for (size_t k = 0; k < made.size() && !made[k].codes.empty(); ++k) {
        unpacked.lod_arrays[k].normals = std::move(made[k].codes);
        unpacked.lod[k].normals = unpacked.lod_arrays[k].normals.data();
    }
}

} // namespace gtx
