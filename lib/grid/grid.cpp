/* Reading a grid of any format, and the processing that all grids share. */
#include "grid/text.hpp"
#include "base/exact.h"

#include "image/image.h"
#include "mesh/mesh.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

namespace gtx {

void settle(HeightGrid &grid)
{
    const double sizes[] = {grid.origin[0], grid.origin[1], grid.step[0], grid.step[1],
                            grid.rotation};
    for (double size : sizes)
        if (!(std::fabs(size) < 1e15))
            malformed("a number of the header is not finite");
    if (grid.step[0] == 0 || grid.step[1] == 0)
        malformed("a step between nodes is 0");
    if (grid.step[0] < 0 || grid.step[1] < 0) {
        HeightGrid turned = grid;
        const bool x = grid.step[0] < 0, y = grid.step[1] < 0;
        const auto origin = grid.place(x ? grid.nx - 1 : 0, y ? grid.ny - 1 : 0);
        for (int k = 0; k < 2; ++k) {
            turned.origin[k] = origin[k];
            turned.step[k] = std::fabs(grid.step[k]);
        }
        for (uint32_t j = 0; j < grid.ny; ++j)
            for (uint32_t i = 0; i < grid.nx; ++i)
                turned.values[size_t(j) * grid.nx + i] =
                    grid.at(x ? grid.nx - 1 - i : i, y ? grid.ny - 1 - j : j);
        grid = std::move(turned);
    }
}

/* ---- images ---- */

/* 16 bits with a sign are terrain, whose voids are -32768 (SRTM) or -32767 (DTED). */
constexpr float SIGNED_VOID = -32767;

HeightGrid grid_of_codes(const GridCodes &image, const GridReading &reading)
{
    HeightGrid grid;
    grid.is_unplaced = true;
    grid.nx = image.nx;
    grid.ny = image.ny;
    grid.values.resize(grid.count());
    double least = image.least, scale = 1, low = least;
    if (reading.range) {
        if (!(image.greatest > image.least))
            malformed("a range is for images of whole numbers");
        if (reading.missing && *reading.missing == least)
            least += 1;
        low = reading.range[0];
        scale = (reading.range[1] - low) / (image.greatest - least);
    }
    for (uint32_t j = 0; j < grid.ny; ++j)
        for (uint32_t i = 0; i < grid.nx; ++i) {
            const float code = image.codes[size_t(grid.ny - 1 - j) * grid.nx + i];
            const bool is_void = (reading.missing && code == float(*reading.missing)) ||
                                 (image.least < 0 && code <= SIGNED_VOID);
            const double value = reading.range ? low + (code - least) * scale
                                               : code * image.scale + image.offset;
            grid.values[size_t(j) * grid.nx + i] = is_void ? NAN : float(value);
        }
    return grid;
}

static HeightGrid read_image(const std::string &path, const GridReading &reading, Task &task)
{
    gtx_value_image image;
    gtx_error error;
    uint32_t width, height;
    std::error_code unknown;
    const uint64_t size = std::filesystem::file_size(path, unknown);
    task.limits.read(path, unknown ? 0 : size);
    require_ok(gtx_image_measure_file(path.c_str(), &width, &height, &error), error);
    task.limits.require(GTX_LIMITED_PIXELS, "the image", uint64_t(width) * height);
    task.limits.require(GTX_LIMITED_TEXELS, "the image", uint64_t(width) * height);
    cancel_point(4 * size_t(width) * height); /* decoding a pixel takes four turns */
    TakenMemory taken(2 * sizeof(float) * width * height);
    require_ok(gtx_image_read_values(path.c_str(), &image, &error), error);
    std::unique_ptr<float, void (*)(void *)> guard(image.values, std::free);
    return grid_of_codes(
        {image.width, image.height, image.least, image.greatest, 1, 0, image.values}, reading);
}

/* ---- any file ---- */

static const struct {
    bool (*is)(std::string_view);
    HeightGrid (*read)(std::string_view, const Limits &);
} formats[] = {{is_irap_classic, read_irap_classic},
               {is_irap_binary, read_irap_binary},
               {is_zmap, read_zmap},
               {is_cps3, read_cps3},
               {is_netcdf, read_netcdf}};

/* What is none of them is left to those who know images. */
static gtx_result look_for_grid(const uint8_t *head, size_t size, uint64_t, void *path,
                                gtx_error *error)
{
    const std::string_view text(reinterpret_cast<const char *>(head), size);
    bool known = is_netcdf4(text) || gdal_driver(text, *static_cast<const std::string *>(path));
    for (const auto &format : formats)
        known = known || format.is(text);
    return known ? GTX_OK : gtx_fail(error, GTX_ERROR_UNSUPPORTED, "no grid");
}

/* Empty where it is none of the formats. */
static ModelFile read_grid_file(const std::string &path, Task &task)
{
    try {
        return read_packed_file(path, task, look_for_grid);
    } catch (const Error &e) {
        if (e.result != GTX_ERROR_UNSUPPORTED)
            throw;
        return {};
    }
}

bool is_grid_file(const std::string &path)
{
    static const char *const images[] = {".png", ".tif", ".tiff", ".exr"};
    if (is_model_name(path))
        return false;
    const std::string extension = model_extension(path);
    for (const char *image : images)
        if (extension == image)
            return true;
    char head[4096];
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw Error(GTX_ERROR_READ, std::strerror(errno));
    file.read(head, sizeof head);
    const std::string_view text(head, size_t(file.gcount()));
    for (const auto &format : formats)
        if (format.is(text))
            return true;
    return is_netcdf4(text) || gdal_driver(text, path);
}

HeightGrid read_grid(const std::string &path, const GridReading &reading, Task &task)
{
    const ModelFile file = read_grid_file(path, task);
    const Bytes classic = is_netcdf4(file.bytes) ? classic_of_netcdf4(file.bytes, task) : Bytes();
    const std::string_view bytes = classic.empty() ? std::string_view(file.bytes) : classic;
    for (const auto &format : formats) {
        if (!format.is(bytes))
            continue;
        if (reading.range)
            throw Error(GTX_ERROR_ARGUMENT, "a range is for images of whole numbers");
        HeightGrid grid = format.read(bytes, task.limits);
        for (float &value : grid.values)
            if (!std::isfinite(value) || (reading.missing && value == float(*reading.missing)))
                value = NAN;
        return grid;
    }
    const char *driver = gdal_driver(file.bytes, path);
    HeightGrid grid = driver ? read_gdal(driver, file.bytes, path, reading, task)
                             : read_image(path, reading, task);
    for (float &value : grid.values)
        if (!(std::fabs(value) < 1e30f))
            value = NAN;
    return grid;
}

/* ---- colours ---- */

using Rgb = std::array<uint8_t, 3>;

/* Nine colours of viridis (van der Walt and Smith 2015), and the way round the hues that maps of
 * geology have from of old. */
static const Vector<Rgb> VIRIDIS = {{68, 1, 84},   {71, 45, 123},  {59, 82, 139},
                                    {44, 114, 142}, {33, 145, 140}, {40, 174, 128},
                                    {94, 201, 98}, {173, 220, 48}, {253, 231, 37}};
static const Vector<Rgb> RAINBOW = {
    {0, 0, 255}, {0, 255, 255}, {0, 255, 0}, {255, 255, 0}, {255, 0, 0}};

Rgb color_of(ColorMap map, double value)
{
    const Vector<Rgb> &colors = map == ColorMap::VIRIDIS ? VIRIDIS : RAINBOW;
    const double last = double(colors.size() - 1);
    const double at = value > 0 ? std::min(value, 1.0) * last : 0; /* NaN is 0 */
    const size_t k = std::min(size_t(at), colors.size() - 2);
    Rgb out;
    for (int c = 0; c < 3; ++c)
        out[c] = uint8_t(colors[k][c] + (at - double(k)) * (colors[k + 1][c] - colors[k][c]) + 0.5);
    return out;
}

} // namespace gtx
