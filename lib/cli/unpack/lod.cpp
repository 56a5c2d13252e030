/* Levels of the LOD mesh in an unpacked folder: a file each of first, indices and positions, as
 * format/gtx.md lays them out; the rest is in the JSON. */
#include "cli/unpack/unpacked.hpp"

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
    gtx_error error;
    require_ok(gtx_write_file(path.c_str(), file.data(), file.size(), &error), error);
}

void read_unpacked_lod(const std::string &path, uint32_t patches, gtx_lod_mesh &level,
                       UnpackedLod &out)
{
    const uint64_t numbers = uint64_t(patches) + 1 + 3 * uint64_t(level.triangle_count);
    const uint64_t places = 3 * uint64_t(level.vertex_count);
    std::error_code error;
    const uintmax_t size = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file)
        throw Error(GTX_ERROR_READ, "cannot be read");
    if (size != 4 * numbers + 2 * places)
        throw Error(GTX_ERROR_INPUT, "has not the size that asset.json tells");
    out.numbers.resize(numbers);
    out.positions.resize(places);
    file.read(reinterpret_cast<char *>(out.numbers.data()), std::streamsize(4 * numbers));
    file.read(reinterpret_cast<char *>(out.positions.data()), std::streamsize(2 * places));
    if (!file)
        throw Error(GTX_ERROR_READ, "cannot be read");
    level.first = out.numbers.data();
    level.indices = out.numbers.data() + patches + 1;
    level.positions = out.positions.data();
}

} // namespace gtx
