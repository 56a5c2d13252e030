/* The grid module: the only file that sees GDAL. Of its drivers those of grids alone are asked,
 * one for a file, and they get bytes: no file beside, no path told in a file, no network. */
#include "grid/module.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <tiffio.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <string>
#include <vector>

namespace {

constexpr double MAX_BLOCK = 1 << 26;  /* bytes; strips and tiles have 10^4 to 10^6 */
constexpr double MAX_BLOCKS = 1 << 30; /* bytes of all, where they reach beyond the image */
constexpr double MAX_WASTE = 8;        /* or so many times the image */

struct Failure {
    std::string sentence;
};

/* What GDAL last complained of, without the name that its file has in memory. */
[[noreturn]] void fail(const std::string &sentence, const std::string &folder)
{
    std::string reason = CPLGetLastErrorMsg();
    for (size_t at; (at = reason.find(folder)) != std::string::npos;)
        reason.erase(at, folder.size());
    reason = reason.substr(0, reason.find('\n'));
    throw Failure{sentence + (reason.empty() ? "" : ": " + reason)};
}

void say_nothing(CPLErr, CPLErrorNum, const char *) {}

/* GDAL makes what libtiff complains of its own, for the whole process: OpenImageIO's too, which it
 * then prints. So it gets what comes from its own reading alone. */
thread_local bool is_reading = false;
TIFFErrorHandler theirs[2], gdals[2]; /* of errors, of warnings */
template <int which> void pass_on(const char *module, const char *format, va_list arguments)
{
    const TIFFErrorHandler to = is_reading ? gdals[which] : theirs[which];
    if (to)
        to(module, format, arguments);
}

/* For as long as it lives, GDAL is quiet on this thread and keeps to the file. */
class Tamed {
public:
    Tamed()
    {
        CPLPushErrorHandler(say_nothing);
        CPLErrorReset();
        is_reading = true;
        for (size_t i = 0; i < COUNT; ++i) {
            const char *was = CPLGetThreadLocalConfigOption(OPTIONS[i][0], nullptr);
            had_[i] = was != nullptr;
            was_[i] = was ? was : "";
            CPLSetThreadLocalConfigOption(OPTIONS[i][0], OPTIONS[i][1]);
        }
    }
    ~Tamed()
    {
        for (size_t i = 0; i < COUNT; ++i)
            CPLSetThreadLocalConfigOption(OPTIONS[i][0], had_[i] ? was_[i].c_str() : nullptr);
        is_reading = false;
        CPLPopErrorHandler();
    }
    Tamed(const Tamed &) = delete;
    Tamed &operator=(const Tamed &) = delete;

private:
    static constexpr size_t COUNT = 7;
    static constexpr const char *OPTIONS[COUNT][2] = {
        {"GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR"}, {"GDAL_PAM_ENABLED", "NO"},
        {"GDAL_GEOREF_SOURCES", "INTERNAL"},           {"GDAL_NUM_THREADS", "1"},
        {"GTIFF_IGNORE_READ_ERRORS", "NO"},            {"OSR_USE_CT_GRIDS", "NO"},
        {"CPL_DEBUG", "OFF"}};
    bool had_[COUNT];
    std::string was_[COUNT];
};

/* Drivers that are built in, and no plugin that a variable of the environment names. */
void register_drivers()
{
    for (auto add : {GDALRegister_GTiff, GDALRegister_AAIGrid, GDALRegister_GSAG,
                     GDALRegister_GSBG, GDALRegister_GS7BG, GDALRegister_SRTMHGT,
                     GDALRegister_XYZ})
        add();
    theirs[0] = TIFFSetErrorHandler(nullptr);
    theirs[1] = TIFFSetWarningHandler(nullptr);
    GByte empty[] = {'I', 'I', 42, 0, 0, 0, 0, 0}; /* the first TIFF has GDAL set its handlers */
    const char path[] = "/vsimem/geotex-first", *const drivers[] = {"GTiff", nullptr};
    VSIFCloseL(VSIFileFromMemBuffer(path, empty, sizeof empty, FALSE));
    GDALClose(GDALOpenEx(path, GDAL_OF_RASTER, drivers, nullptr, nullptr));
    VSIUnlink(path);
    gdals[0] = TIFFSetErrorHandler(pass_on<0>);
    gdals[1] = TIFFSetWarningHandler(pass_on<1>);
}

/* A file in GDAL's memory, opened. */
class Raster {
public:
    explicit Raster(const gtx_grid_bytes &file)
    {
        static std::atomic<uint64_t> number{0};
        static std::once_flag once;
        std::call_once(once, register_drivers);
        folder_ = "/vsimem/geotex-" + std::to_string(number++) + "/";
        path_ = folder_ + file.name;
        /* GDAL only reads. */
        VSILFILE *memory = VSIFileFromMemBuffer(
            path_.c_str(), static_cast<GByte *>(const_cast<void *>(file.data)), file.size, FALSE);
        if (!memory)
            throw std::bad_alloc();
        VSIFCloseL(memory);
        const char *const drivers[] = {file.driver, nullptr}, *const beside[] = {nullptr};
        data_ = GDALOpenEx(path_.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                           drivers, nullptr, beside);
        if (!data_) {
            VSIUnlink(path_.c_str());
            fail("GDAL (" + std::string(file.driver) + ") does not read it", folder_);
        }
    }
    ~Raster()
    {
        GDALClose(data_);
        VSIUnlink(path_.c_str());
    }
    Raster(const Raster &) = delete;
    Raster &operator=(const Raster &) = delete;

    GDALDatasetH data() const { return data_; }
    const std::string &folder() const { return folder_; }

private:
    std::string folder_, path_;
    GDALDatasetH data_;
};

/* The types of values, and the range of those that are codes as a rule. */
const struct {
    GDALDataType type;
    double least, greatest;
} value_types[] = {{GDT_Byte, 0, 255},  {GDT_UInt16, 0, 65535},
                   {GDT_Int16, -32768, 32767},
                   {GDT_UInt32, 0, 0},  {GDT_Int32, 0, 0},
                   {GDT_Float32, 0, 0}, {GDT_Float64, 0, 0}};

void describe(const Raster &raster, gtx_grid_raster &out)
{
    if (GDALGetRasterCount(raster.data()) < 1)
        throw Failure{"it has no values"};
    const GDALRasterBandH band = GDALGetRasterBand(raster.data(), 1);
    const auto *known = std::find_if(std::begin(value_types), std::end(value_types), [&](auto &t) {
        return t.type == GDALGetRasterDataType(band);
    });
    if (known == std::end(value_types))
        throw Failure{"its values are neither whole numbers nor floats"};
    out.least = known->least;
    out.greatest = known->greatest;
    out.nx = uint32_t(std::max(GDALGetRasterXSize(raster.data()), 0));
    out.ny = uint32_t(std::max(GDALGetRasterYSize(raster.data()), 0));
    out.has_place = GDALGetGeoTransform(raster.data(), out.affine) == CE_None;
    if (!out.has_place && GDALGetGCPCount(raster.data()) > 0)
        throw Failure{"it is placed by control points: make a grid of it with gdalwarp"};
    int has_scale = 0, has_offset = 0;
    out.scale = GDALGetRasterScale(band, &has_scale);
    out.offset = GDALGetRasterOffset(band, &has_offset);
    out.scale = has_scale ? out.scale : 1;
    out.offset = has_offset ? out.offset : 0;
}

/* Calls visit(column, row, values, count) for the part of each row that a block holds; every block
 * is decoded once, whatever GDAL's cache holds. */
template <class Visit>
void for_blocks(const Raster &raster, GDALRasterBandH band, const char *what, Visit visit)
{
    int width, height;
    const int nx = GDALGetRasterBandXSize(band), ny = GDALGetRasterBandYSize(band);
    const GDALDataType type = GDALGetRasterDataType(band);
    const int size = GDALGetDataTypeSizeBytes(type);
    GDALGetBlockSize(band, &width, &height);
    if (width < 1 || height < 1)
        throw Failure{"its blocks have no size"};
    const int across = (nx - 1) / width + 1, down = (ny - 1) / height + 1;
    const double image = double(nx) * ny * size, block = double(width) * height * size;
    if (block > std::max(MAX_BLOCK, image) ||
        block * across * down > std::max(MAX_BLOCKS, MAX_WASTE * image))
        throw Failure{"its blocks are much larger than its image"};
    std::vector<char> bytes(size_t(width) * size_t(height) * size_t(size));
    std::vector<double> row(size_t(std::min(width, nx)));
    for (int y = 0; y < down; ++y)
        for (int x = 0; x < across; ++x) {
            if (GDALReadBlock(band, x, y, bytes.data()) != CE_None)
                fail(what, raster.folder());
            const int count = std::min(width, nx - x * width);
            for (int j = 0; j < std::min(height, ny - y * height); ++j) {
                GDALCopyWords(&bytes[size_t(j) * size_t(width) * size_t(size)], type, size,
                              row.data(), GDT_Float64, sizeof(double), count);
                visit(size_t(x) * size_t(width), size_t(y) * size_t(height) + size_t(j),
                      row.data(), size_t(count));
            }
        }
}

void read_codes(const Raster &raster, gtx_grid_raster &out)
{
    const GDALRasterBandH band = GDALGetRasterBand(raster.data(), 1);
    int has_missing = 0;
    const double missing = GDALGetRasterNoDataValue(band, &has_missing);
    const bool is_float = GDALGetRasterDataType(band) == GDT_Float32;
    for_blocks(raster, band, "its values end too early or are damaged",
               [&](size_t column, size_t row, const double *values, size_t count) {
        float *to = out.codes + row * out.nx + column;
        for (size_t i = 0; i < count; ++i) {
            const bool is_missing = has_missing && (values[i] == missing ||
                                    (is_float && float(values[i]) == float(missing)));
            to[i] = is_missing || !(std::fabs(values[i]) <= std::numeric_limits<float>::max())
                        ? NAN : float(values[i]);
        }
    });
    if (GDALGetMaskFlags(band) != GMF_PER_DATASET)
        return;
    for_blocks(raster, GDALGetMaskBand(band), "its mask ends too early or is damaged",
               [&](size_t column, size_t row, const double *values, size_t count) {
        for (size_t i = 0; i < count; ++i)
            if (values[i] == 0)
                out.codes[row * out.nx + column + i] = NAN;
    });
}

void measure_file(const gtx_grid_bytes &file, gtx_grid_raster &out)
{
    const Raster raster(file);
    describe(raster, out);
}

void read_file(const gtx_grid_bytes &file, gtx_grid_raster &out)
{
    const Raster raster(file);
    describe(raster, out);
    out.codes = static_cast<float *>(std::malloc(size_t(out.nx) * out.ny * sizeof(float)));
    if (!out.codes)
        throw std::bad_alloc();
    read_codes(raster, out);
}

/* Nothing may be thrown across the C boundary. */
template <auto call>
int guarded(const gtx_grid_bytes *file, gtx_grid_raster *out, char *message)
{
    const char *sentence = "out of memory";
    int code = GTX_GRID_NO_MEMORY;
    *out = {};
    try {
        const Tamed tamed;
        call(*file, *out);
        return 0;
    } catch (const Failure &e) {
        code = GTX_GRID_FAILED;
        std::snprintf(message, GTX_GRID_MAX_MESSAGE, "%s", e.sentence.c_str());
        sentence = nullptr;
    } catch (const std::bad_alloc &) {
    } catch (const std::exception &) {
        code = GTX_GRID_FAILED;
        sentence = "GDAL does not read it";
    }
    if (sentence)
        std::snprintf(message, GTX_GRID_MAX_MESSAGE, "%s", sentence);
    std::free(out->codes);
    *out = {};
    return code;
}

} // namespace

extern "C" __attribute__((visibility("default"))) const gtx_grid_functions gtx_grid_module = {
    GTX_GRID_MODULE_VERSION, guarded<measure_file>, guarded<read_file>};
