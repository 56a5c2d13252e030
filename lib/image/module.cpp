/* The image module: the only file that sees OpenImageIO. */
#include "image/module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <tuple>
#include <vector>

namespace {

/* One line; without a name for bytes in memory. */
int fail(char *message, const char *name, const std::string &detail)
{
    const std::string line = detail.substr(0, detail.find('\n'));
    std::snprintf(message, GTX_IMAGE_MAX_MESSAGE, "%s%s%s", name, *name ? ": " : "", line.c_str());
    return GTX_IMAGE_FAILED;
}

int fail_memory(char *message, const char *name)
{
    fail(message, name, "out of memory");
    return GTX_IMAGE_NO_MEMORY;
}

int encode(const gtx_image_rows *rows, void **data, size_t *size, char *message)
{
    const std::string format = rows->format;
    const bool is_depth = format == "exr", is_deep = format == "png16";
    const OIIO::TypeDesc type = is_depth  ? OIIO::TypeDesc::FLOAT
                                : is_deep ? OIIO::TypeDesc::UINT16
                                          : OIIO::TypeDesc::UINT8;
    const std::string name = is_depth ? "exr" : format == "gif" ? "gif" : "png";
    std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(name);
    if (!output)
        return fail(message, "", OIIO::geterror());
    OIIO::ImageSpec spec(int(rows->width), int(rows->height), int(rows->channels), type);
    if (is_depth) {
        spec.channelnames = {"Z"};
        spec.z_channel = 0;
    } else {
        spec.attribute("oiio:ColorSpace", "sRGB");
        spec.attribute("oiio:UnassociatedAlpha", 1);
    }
    OIIO::Filesystem::IOVecOutput memory;
    OIIO::Filesystem::IOProxy *proxy = &memory;
    spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    if (rows->frames_per_second > 0)
        spec.attribute("FramesPerSecond", rows->frames_per_second);
    auto pixels = static_cast<const char *>(rows->pixels);
    for (uint32_t i = 0; i < std::max(rows->frames, 1u); ++i, pixels += spec.image_bytes())
        if (!output->open("memory." + name, spec, i ? OIIO::ImageOutput::AppendSubimage
                                                    : OIIO::ImageOutput::Create) ||
            !output->write_image(type, pixels))
            return fail(message, "", output->geterror());
    if (!output->close())
        return fail(message, "", output->geterror());
    *size = memory.buffer().size();
    *data = std::malloc(*size);
    if (!*data)
        return fail_memory(message, "");
    std::memcpy(*data, memory.buffer().data(), *size);
    return 0;
}

constexpr double MAX_PIECE = 1 << 26; /* bytes; strips and tiles of images have 10^4 to 10^6 */
constexpr int MAX_CHANNELS = 8;       /* memory is counted for four */

/* RGBA from any number of channels: grey, grey and alpha, RGB, RGBA and more. */
void spread(const std::vector<uint8_t> &in, int channels, int alpha, uint8_t *out)
{
    const size_t count = in.size() / size_t(channels);
    const bool is_grey = channels - (alpha >= 0) < 3;
    for (size_t i = 0; i < count; ++i) {
        const uint8_t *texel = &in[i * size_t(channels)];
        for (int c = 0; c < 3; ++c)
            out[4 * i + size_t(c)] = texel[is_grey ? 0 : c];
        out[4 * i + 3] = alpha >= 0 ? texel[alpha] : 255;
    }
}

/* The formats that are read, by their first bytes alone: OpenImageIO would try all that it knows,
 * films and medical archives among them. */
const char *format_of(const char *head, size_t size)
{
    static const struct {
        const char *start, *format;
        size_t length;
    } formats[] = {{"\x89PNG", "png", 4},     {"\xff\xd8\xff", "jpeg", 3}, {"RIFF", "webp", 4},
                   {"BM", "bmp", 2},          {"GIF8", "gif", 4},          {"II*\0", "tiff", 4},
                   {"MM\0*", "tiff", 4},      {"II+\0", "tiff", 4},        {"MM\0+", "tiff", 4},
                   {"\x76\x2f\x31\x01", "openexr", 4}, {"#?", "hdr", 2}, {"P", "pnm", 1}};
    for (const auto &format : formats)
        if (size >= format.length && std::memcmp(head, format.start, format.length) == 0)
            return format.format;
    return nullptr;
}

/* Whether a BMP is packed as runs: OpenImageIO 2.4 writes past the rows of a grey one, and looks
 * for colours where there is no palette. The oldest header tells of no packing. */
bool is_bmp_of_runs(const char *head, size_t size)
{
    constexpr size_t HEADER = 14, PACKING = 30;
    constexpr char OLDEST = 12, RUNS_OF_8 = 1, RUNS_OF_4 = 2;
    return size > PACKING && head[HEADER] != OLDEST &&
           (head[PACKING] == RUNS_OF_8 || head[PACKING] == RUNS_OF_4);
}

/* Bytes of the largest piece that is decoded at once: a file may tell of strips and tiles that are
 * larger than its image, and OpenImageIO takes 64 rows, however few there are. */
double piece_size(const OIIO::ImageSpec &spec)
{
    constexpr int ROWS_AT_ONCE = 64;
    const double pixel = double(spec.pixel_bytes(true));
    const double strip = std::max(ROWS_AT_ONCE,
                                  spec.get_int_attribute("tiff:RowsPerStrip", ROWS_AT_ONCE));
    const double tile = double(spec.tile_width) * spec.tile_height * std::max(1, spec.tile_depth);
    return pixel * std::max(tile, strip * spec.width);
}

/* An open file or piece of memory. Neither copied nor moved: the reader points into it. */
struct Source {
    const char *name;
    OIIO::Filesystem::IOMemReader memory;
    OIIO::Filesystem::IOProxy *proxy = &memory;
    std::unique_ptr<OIIO::ImageInput> input;

    Source(const char *path, const void *data, size_t size)
        : name(path ? path : ""), memory(data, size) {}

    /* Returns 0 when an image of a sound size is open. */
    int open(const char *path, const void *data, size_t size, char *message)
    {
        char head[64];
        if (path) {
            std::unique_ptr<FILE, int (*)(FILE *)> file(std::fopen(path, "rb"), std::fclose);
            size = file ? std::fread(head, 1, sizeof head, file.get()) : 0;
            data = head;
        }
        const char *start = static_cast<const char *>(data), *format = format_of(start, size);
        if (!format)
            return fail(message, name, "neither PNG, JPEG, WebP, BMP, GIF, TIFF, OpenEXR, HDR "
                                       "nor PNM");
        if (!std::strcmp(format, "bmp") && is_bmp_of_runs(start, size))
            return fail(message, name, "a BMP that is packed as runs is not supported");
        OIIO::ImageSpec hint, found;
        hint.attribute("oiio:UnassociatedAlpha", 1);
        if (!path)
            hint.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
        input = OIIO::ImageInput::create(format);
        if (!input)
            return fail(message, name, OIIO::geterror());
        if (!input->open(path ? path : std::string("embedded.") + format, found, hint))
            return fail(message, name, input->geterror());
        const OIIO::ImageSpec &spec = input->spec();
        if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 ||
            spec.nchannels > MAX_CHANNELS ||
            piece_size(spec) > std::max(MAX_PIECE, double(spec.image_bytes(true))))
            return fail(message, name, "not an image of a supported size");
        return 0;
    }
};

int measure(const char *path, const void *data, size_t size, uint32_t *width, uint32_t *height,
            char *message)
{
    Source source(path, data, size);
    if (source.open(path, data, size, message))
        return 1;
    *width = uint32_t(source.input->spec().width);
    *height = uint32_t(source.input->spec().height);
    return 0;
}

int read_rgba(const char *path, const void *data, size_t size, uint64_t max_pixels, gtx_image *out,
              char *message)
{
    Source source(path, data, size);
    if (source.open(path, data, size, message))
        return 1;
    const OIIO::ImageSpec &spec = source.input->spec();
    const uint64_t count = uint64_t(spec.width) * uint64_t(spec.height);
    if (count > max_pixels)
        return fail(message, source.name, "not an image of a supported size");
    std::vector<uint8_t> texels(size_t(count) * size_t(spec.nchannels));
    if (!source.input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, texels.data()))
        return fail(message, source.name, source.input->geterror());
    out->pixels = static_cast<uint8_t *>(std::malloc(size_t(count) * 4));
    if (!out->pixels)
        return fail_memory(message, source.name);
    const int alpha = spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels
                          ? spec.alpha_channel : -1;
    spread(texels, spec.nchannels, alpha, out->pixels);
    out->width = uint32_t(spec.width);
    out->height = uint32_t(spec.height);
    return 0;
}

int read_raw(const char *path, uint64_t max_pixels, gtx_raw_image *out, char *message)
{
    Source source(path, nullptr, 0);
    if (source.open(path, nullptr, 0, message))
        return 1;
    const OIIO::ImageSpec &spec = source.input->spec();
    const uint64_t count = uint64_t(spec.width) * uint64_t(spec.height);
    const bool is_deep = spec.format == OIIO::TypeDesc::UINT16;
    if (count > max_pixels || spec.nchannels > 4 ||
        (!is_deep && spec.format != OIIO::TypeDesc::UINT8))
        return fail(message, source.name, "not an image of 8 or 16 bits and of a supported size");
    out->depth = is_deep ? 2 : 1;
    out->pixels = std::malloc(size_t(count) * size_t(spec.nchannels) * out->depth);
    if (!out->pixels)
        return fail_memory(message, source.name);
    if (!source.input->read_image(0, 0, 0, spec.nchannels, spec.format, out->pixels)) {
        std::free(out->pixels);
        return fail(message, source.name, source.input->geterror());
    }
    out->width = uint32_t(spec.width);
    out->height = uint32_t(spec.height);
    out->channels = uint32_t(spec.nchannels);
    return 0;
}

/* The types that numbers are read from. OpenImageIO scales whole ones when it converts them
 * itself. */
template <class T> void widen(const std::vector<char> &bytes, float *out, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        T value;
        std::memcpy(&value, bytes.data() + i * sizeof value, sizeof value);
        out[i] = float(value);
    }
}
const struct {
    OIIO::TypeDesc::BASETYPE type;
    double least, greatest;
    void (*widen)(const std::vector<char> &, float *, size_t);
} value_types[] = {{OIIO::TypeDesc::UINT8, 0, 255, widen<uint8_t>},
                   {OIIO::TypeDesc::UINT16, 0, 65535, widen<uint16_t>},
                   {OIIO::TypeDesc::INT16, -32768, 32767, widen<int16_t>},
                   {OIIO::TypeDesc::HALF, 0, 0, widen<float>},
                   {OIIO::TypeDesc::FLOAT, 0, 0, widen<float>}};

int read_values(const char *path, uint64_t max_pixels, gtx_value_image *out, char *message)
{
    Source source(path, nullptr, 0);
    if (source.open(path, nullptr, 0, message))
        return 1;
    const OIIO::ImageSpec &spec = source.input->spec();
    const uint64_t count = uint64_t(spec.width) * uint64_t(spec.height);
    for (const auto &known : value_types) {
        if (spec.format.basetype != known.type || count > max_pixels)
            continue;
        const OIIO::TypeDesc type = known.greatest > 0 ? spec.format : OIIO::TypeDesc::FLOAT;
        std::vector<char> bytes(size_t(count) * type.size());
        if (!source.input->read_image(0, 0, 0, 1, type, bytes.data()))
            return fail(message, source.name, source.input->geterror());
        out->values = static_cast<float *>(std::malloc(size_t(count) * sizeof(float)));
        if (!out->values)
            return fail_memory(message, source.name);
        known.widen(bytes, out->values, size_t(count));
        out->width = uint32_t(spec.width);
        out->height = uint32_t(spec.height);
        out->least = known.least;
        out->greatest = known.greatest;
        return 0;
    }
    return fail(message, source.name, "not an image of 8 or 16 bits or of floats, or too large");
}

/* Nothing may be thrown across the C boundary. The message is the last argument. */
template <auto call, class... Arguments> int guarded(Arguments... arguments)
{
    try {
        return call(arguments...);
    } catch (const std::bad_alloc &) {
        return fail_memory(std::get<sizeof...(arguments) - 1>(std::tie(arguments...)), "image");
    } catch (const std::exception &e) {
        return fail(std::get<sizeof...(arguments) - 1>(std::tie(arguments...)), "image", e.what());
    }
}

} // namespace

extern "C" __attribute__((visibility("default"))) const gtx_image_functions gtx_image_module = {
    GTX_IMAGE_MODULE_VERSION, guarded<encode>, guarded<read_rgba>, guarded<read_raw>,
    guarded<read_values>, guarded<measure>};
