/* Grids that GDAL reads: recognising them, and the positions of their nodes. */
#include "grid/module.h"
#include "base/exact.h"
#include "grid/text.hpp"
#include "image/open.h"
#include "mesh/mesh.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>

namespace gtx {

/* ---- which files ---- */

/* Numbers of a TIFF, of either order of bytes; 0 where it ends before. */
class TiffNumbers {
public:
    TiffNumbers(const std::string &path, bool is_big_endian)
        : file_(path, std::ios::binary), is_big_endian_(is_big_endian)
    {
    }
    uint64_t at(uint64_t place, size_t bytes)
    {
        char raw[8] = {};
        file_.clear();
        if (place > uint64_t(INT64_MAX) || !file_.seekg(std::streamoff(place)) ||
            !file_.read(raw, std::streamsize(bytes)))
            return 0;
        uint64_t value = 0;
        for (size_t k = 0; k < bytes; ++k)
            value = value << 8 | uint8_t(raw[is_big_endian_ ? k : bytes - 1 - k]);
        return value;
    }

    uint64_t size()
    {
        file_.clear();
        file_.seekg(0, std::ios::end);
        return uint64_t(std::max(std::streamoff(file_.tellg()), std::streamoff(0)));
    }

private:
    std::ifstream file_;
    bool is_big_endian_;
};

/* What the first directory of a TIFF tells of its grid: its place, or values that are missing. */
struct TiffTags {
    bool any = false, whole = true; /* whole: they lie inside the file */
    bool in_degrees = false;
    double across = 0, up = 0;      /* metres in its units of length; 0: it does not say */
};

/* Metres in a unit of EPSG's; 0 for others. */
static double metres_in(uint64_t unit)
{
    static const struct {
        uint64_t unit;
        double metres;
    } units[] = {{9001, 1}, {9002, 0.3048}, {9003, 1200.0 / 3937}, {9036, 1000}};
    for (const auto &known : units)
        if (known.unit == unit)
            return known.metres;
    return 0;
}

/* The GeoKeys (GeoTIFF 1.1, 7.4) of the model, of its unit and of that of heights: GDAL would look
 * a lot up, and print, to tell as much. Zones of UTM are in metres. */
static void read_keys(TiffNumbers &numbers, uint64_t at, uint64_t items, TiffTags &out)
{
    constexpr uint64_t MODEL = 1024, GEOGRAPHIC = 2, PROJECTION = 3072, UNIT = 3076, UP = 4099;
    constexpr uint64_t FIRST_UTM = 32601, LAST_UTM = 32760;
    for (uint64_t k = 4; k + 4 <= std::min<uint64_t>(items, 1024); k += 4) {
        const uint64_t key = numbers.at(at + 2 * k, 2), value = numbers.at(at + 2 * k + 6, 2);
        if (numbers.at(at + 2 * k + 2, 2) != 0) /* it lies elsewhere */
            continue;
        if (key == MODEL)
            out.in_degrees = value == GEOGRAPHIC;
        else if (key == UNIT)
            out.across = metres_in(value);
        else if (key == UP)
            out.up = metres_in(value);
        else if (key == PROJECTION && value >= FIRST_UTM && value <= LAST_UTM && out.across == 0)
            out.across = 1;
    }
}

static TiffTags tags_of(std::string_view head, const std::string &path)
{
    constexpr uint64_t MAX_TAGS = 4096, CLASSIC = 42, BIG = 43;
    constexpr uint64_t GEO_KEYS = 34735;
    constexpr uint64_t OF_GRIDS[] = {33550, 33922, 34264, GEO_KEYS, 34736, 34737, 42112, 42113};
    constexpr uint64_t SIZES[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
    TiffTags out;
    if (head.substr(0, 2) != "II" && head.substr(0, 2) != "MM")
        return out;
    TiffNumbers numbers(path, head[0] == 'M');
    const uint64_t version = numbers.at(2, 2);
    if (version != CLASSIC && version != BIG)
        return out;
    const uint64_t word = version == BIG ? 8 : 4;
    const uint64_t directory = numbers.at(word, word), count_size = version == BIG ? 8 : 2;
    const uint64_t count = std::min(numbers.at(directory, count_size), MAX_TAGS);
    for (uint64_t k = 0; k < count; ++k) {
        const uint64_t entry = directory + count_size + (4 + 2 * word) * k;
        const uint64_t tag = numbers.at(entry, 2), type = numbers.at(entry + 2, 2);
        if (std::find(std::begin(OF_GRIDS), std::end(OF_GRIDS), tag) == std::end(OF_GRIDS))
            continue;
        const uint64_t items = numbers.at(entry + 4, word);
        const uint64_t size = type < std::size(SIZES) ? SIZES[type] : 0;
        const uint64_t at = numbers.at(entry + 4 + word, word);
        out.any = true;
        if (items > numbers.size() || (size * items > word && (at > numbers.size() ||
                                                               size * items > numbers.size() - at)))
            out.whole = false;
        else if (tag == GEO_KEYS)
            read_keys(numbers, at, items, out);
    }
    return out;
}
/* Other TIFFs are images. */
static bool is_geotiff(std::string_view head, const std::string &path)
{
    return tags_of(head, path).any;
}

static std::string lower(std::string_view word)
{
    std::string out(word);
    for (char &letter : out)
        letter = char(std::tolower(static_cast<unsigned char>(letter)));
    return out;
}
/* The words that rows of its header start with. */
static bool is_esri_key(const std::string &word)
{
    static const char *const keys[] = {"ncols", "nrows", "xllcorner", "xllcenter", "yllcorner",
                                       "yllcenter", "cellsize", "dx", "dy", "nodata_value"};
    return std::find(std::begin(keys), std::end(keys), word) != std::end(keys);
}
static bool is_esri_ascii(std::string_view head, const std::string &)
{
    return is_esri_key(lower(Words(head.substr(0, 64)).next()));
}
template <char third, char fourth> static bool is_surfer(std::string_view head, const std::string &)
{
    return head.substr(0, 2) == "DS" && head.size() > 4 && head[2] == third && head[3] == fourth;
}
static bool is_hgt(std::string_view, const std::string &path)
{
    return model_extension(path) == ".hgt";
}
static bool is_xyz(std::string_view, const std::string &path)
{
    return model_extension(path) == ".xyz";
}

static const struct {
    bool (*is)(std::string_view head, const std::string &path);
    const char *driver;
} drivers[] = {{is_geotiff, "GTiff"},          {is_esri_ascii, "AAIGrid"},
               {is_surfer<'A', 'A'>, "GSAG"},  {is_surfer<'B', 'B'>, "GSBG"},
               {is_surfer<'R', 'B'>, "GS7BG"}, {is_hgt, "SRTMHGT"},
               {is_xyz, "XYZ"}};

const char *gdal_driver(std::string_view head, const std::string &path)
{
    for (const auto &known : drivers)
        if (known.is(head, path))
            return known.driver;
    return nullptr;
}

/* What GDAL is told of the name: no more than the corner that an HGT is named by. */
static std::string plain_name(const std::string &driver, const std::string &path)
{
    if (driver != "SRTMHGT")
        return "grid";
    const std::string name = path.substr(path.rfind('/') + 1).substr(0, 7);
    bool fits = name.size() == 7 && std::strchr("NSns", name[0]) && std::strchr("EWew", name[3]);
    for (size_t k : {1, 2, 4, 5, 6})
        fits = fits && name[k] >= '0' && name[k] <= '9';
    if (!fits)
        malformed("an HGT is named by its corner, as N46E008.hgt is");
    return name + ".hgt";
}

/* ---- their nodes ---- */

static const gtx_grid_functions &functions()
{
    gtx_error error;
    const auto *found = static_cast<const gtx_grid_functions *>(gtx_open_module(
        "geotex-grid.so", GTX_GRID_MODULE_SYMBOL,
        "GDAL (Debian: libgdal32) reads such grids, through geotex-grid.so", &error));
    if (!found)
        throw Error(error);
    if (found->version != GTX_GRID_MODULE_VERSION)
        throw Error(GTX_ERROR_UNSUPPORTED, "geotex-grid.so is of another version");
    return *found;
}

static void require_read(int failed, const char *message)
{
    if (failed)
        throw Error(failed == GTX_GRID_NO_MEMORY ? GTX_ERROR_MEMORY : GTX_ERROR_INPUT, message);
}

/* Columns and rows at right angles become a lattice from the lower left pixel's centre. */
static void lay(HeightGrid &grid, const double affine[6])
{
    constexpr double SQUARE = 1e-6;
    for (int k = 0; k < 6; ++k)
        if (!(std::fabs(affine[k]) < 1e15))
            malformed("a number of its place is not finite");
    const double east[2] = {affine[1], affine[4]}, north[2] = {-affine[2], -affine[5]};
    const double i = 0.5, j = double(grid.ny) - 0.5;
    for (int k = 0; k < 2; ++k)
        grid.origin[k] = affine[3 * k] + i * affine[3 * k + 1] + j * affine[3 * k + 2];
    grid.step[0] = east[0];
    grid.step[1] = north[1];
    if (east[1] == 0 && north[0] == 0)
        return;
    const double width = length(east[0], east[1]), height = length(north[0], north[1]);
    if (std::fabs(east[0] * north[0] + east[1] * north[1]) > SQUARE * width * height ||
        width == 0)
        malformed("its rows and columns are not at right angles");
    grid.rotation = gtx_atan2(east[1], east[0]) * 180 / std::acos(-1.0);
    grid.step[0] = width;
    grid.step[1] = (east[0] * north[1] - east[1] * north[0]) / width;
}

/* Text tells of no unit: a lattice that fits on a globe in degrees, and is far less wide than its
 * heights differ, is in degrees. A tile of one degree differs by 10 at sea and 5000 in the Alps. */
static bool seems_in_degrees(const HeightGrid &grid)
{
    constexpr double MUCH = 10, GLOBE[2] = {360, 90};
    const auto far = grid.place(grid.nx - 1, grid.ny - 1);
    float low = INFINITY, high = -INFINITY;
    for (float value : grid.values)
        if (!std::isnan(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    for (int k = 0; k < 2; ++k)
        if (std::fabs(grid.origin[k]) > GLOBE[k] || std::fabs(far[k]) > GLOBE[k])
            return false;
    const double width = std::max(std::fabs(far[0] - grid.origin[0]),
                                  std::fabs(far[1] - grid.origin[1]));
    return double(high) - double(low) > MUCH * width;
}

/* GDAL takes what its header claims for true, and 0 for numbers that are not there. */
static void check_esri_ascii(std::string_view bytes)
{
    Words words(bytes);
    double columns = 0, rows = 0;
    std::string key = lower(words.next());
    for (; is_esri_key(key); key = lower(words.next())) {
        const double number = words.number("a number of the header");
        columns = key == "ncols" ? number : columns;
        rows = key == "nrows" ? number : rows;
    }
    uint64_t count = !key.empty();
    while (!words.next().empty())
        ++count;
    if (count < uint64_t(node_count(columns, "the number of columns")) *
                    node_count(rows, "the number of rows"))
        malformed("the grid ends before its nodes do");
}

HeightGrid read_gdal(const char *driver, std::string_view bytes, const std::string &path,
                     const GridReading &reading, Task &task)
{
    char message[GTX_GRID_MAX_MESSAGE] = "";
    gtx_grid_raster raster;
    const std::string name = plain_name(driver, path);
    const gtx_grid_bytes file = {driver, name.c_str(), bytes.data(), bytes.size()};
    const gtx_grid_functions &gdal = functions();
    if (is_esri_ascii(bytes, path))
        check_esri_ascii(bytes);
    const TiffTags tags = tags_of(bytes, path);
    if (!tags.whole)
        malformed("tags of its grid lie behind its end");
    require_read(gdal.measure(&file, &raster, message), message);
    HeightGrid grid;
    grid.nx = node_count(raster.nx, "the number of columns");
    grid.ny = node_count(raster.ny, "the number of rows");
    task.limits.require(GTX_LIMITED_TEXELS, "the grid", grid.count());
    cancel_point(4 * grid.count()); /* as for images */
    TakenMemory taken(2 * sizeof(float) * grid.count());
    require_read(gdal.read(&file, &raster, message), message);
    std::unique_ptr<float, void (*)(void *)> guard(raster.codes, std::free);
    if (raster.nx != grid.nx || raster.ny != grid.ny)
        malformed("it has two sizes");
    grid = grid_of_codes({raster.nx, raster.ny, raster.least, raster.greatest, raster.scale,
                          raster.offset, raster.codes}, reading);
    if (tags.across > 0 && tags.up > 0 && tags.up != tags.across) {
        const double scale = tags.up / tags.across; /* heights in the units of the lattice */
        for (float &value : grid.values)
            value = float(value * scale);
    }
    if (!raster.has_place)
        return grid;
    grid.is_unplaced = false;
    lay(grid, raster.affine);
    settle(grid);
    grid.in_degrees = tags.in_degrees || is_hgt(bytes, path) || seems_in_degrees(grid);
    return grid;
}

} // namespace gtx
