/* Measures block compression: the driver decodes the textures, and draws with them. */
#include "cli/bench/memory.hpp"

#include "cli/bench/scene.hpp"
#include "cli/cli.h"
#include "host/jobs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace gtx {

namespace {

constexpr GLenum RGTC2 = 0x8DBD, BPTC = 0x8E8C, SRGB_BPTC = 0x8E8D, RG11 = 0x9272;
constexpr GLenum SRGB_BC1 = 0x8C4C, SRGB_ETC2 = 0x9275, ETC2_EAC = 0x9278, SRGB_ETC2_EAC = 0x9279;

/* Decibels: beyond it floats alone differ. */
constexpr double EXACT = 120;

/* Of formats that are blocks, from GTX_FORMAT_BC5 on. */
constexpr GLenum block_formats[] = {RGTC2, BPTC, SRGB_BPTC, SRGB_BC1, RG11, ETC2_EAC,
                                    SRGB_ETC2_EAC, SRGB_ETC2};

template <class Function> Function look_up(const char *name)
{
    return reinterpret_cast<Function>(gtx_offscreen_load(name, nullptr));
}

/* Level 0 as the driver decodes it: floats, a texel each `channels`. */
Vector<float> decode(const gtx_host_gl &gl, const gtx_texture &t, uint32_t channels)
{
    const auto compressed =
        look_up<PFNGLCOMPRESSEDTEXIMAGE3DPROC>("glCompressedTexImage3D");
    const auto get = look_up<PFNGLGETTEXIMAGEPROC>("glGetTexImage");
    const GLsizei wide = GLsizei(t.width), high = GLsizei(t.height), deep = GLsizei(t.layers);
    const GLenum words[] = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
    Vector<float> out(size_t(t.width) * t.height * t.layers * channels);
    if (!t.block_size) {
        const auto *bytes = static_cast<const uint8_t *>(t.texels[0]);
        for (size_t i = 0; i < out.size(); ++i)
            out[i] = float(bytes[i]) / 255;
        return out;
    }
    GLuint texture;
    gl.GenTextures(1, &texture);
    gl.BindTexture(GL_TEXTURE_2D_ARRAY, texture);
    const uint64_t blocks = uint64_t(t.width + 3) / 4 * ((t.height + 3) / 4) * t.layers;
    compressed(GL_TEXTURE_2D_ARRAY, 0, block_formats[t.format - GTX_FORMAT_BC5], wide, high, deep,
               0, GLsizei(blocks * t.block_size), t.texels[0]);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    get(GL_TEXTURE_2D_ARRAY, 0, words[channels - 1], GL_FLOAT, out.data());
    gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl.BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    gl.DeleteTextures(1, &texture);
    if (gl.GetError() != GL_NO_ERROR)
        throw Error(GTX_ERROR_GL, "the driver decodes no blocks");
    return out;
}

/* A normal of the patch's frame, as gtx.md has it: hemi-octahedral. */
void normal_of(const float *texel, double out[3])
{
    const double a = 2. * double(texel[0]) - 1, b = 2. * double(texel[1]) - 1;
    out[0] = (a + b) / 2;
    out[1] = (a - b) / 2;
    out[2] = 1 - std::max(std::fabs(a), std::fabs(b));
    const double length = std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    for (int k = 0; k < 3; ++k)
        out[k] /= length;
}

/* What is compared: an asset's map and the texture made of it, where it has heights. */
struct Compared {
    const gtx_asset *asset;
    const gtx_info &info;

    bool is_occupied(size_t texel) const
    {
        const auto *heights =
            static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_HEIGHT, 0, nullptr));
        const size_t size = info.height_bits / 8;
        return heights[size * texel] || (size == 2 && heights[2 * texel + 1]);
    }

    double psnr(gtx_map map, const Vector<float> &found, uint32_t channels) const
    {
        const auto *wanted = static_cast<const uint8_t *>(gtx_map_data(asset, map, 0, nullptr));
        double sum = 0, count = 0;
        for (size_t i = 0; i < found.size(); ++i) {
            if (!is_occupied(i / channels))
                continue;
            const double off = double(found[i]) - wanted[i] / 255.;
            sum += off * off;
            count += 1;
        }
        return sum > 0 ? 10 * std::log10(count / sum) : INFINITY;
    }

    void angles(const Vector<float> &found, MemoryRow &row) const
    {
        const auto *wanted =
            static_cast<const uint8_t *>(gtx_map_data(asset, GTX_MAP_NORMAL, 0, nullptr));
        Vector<double> all;
        double sum = 0;
        for (size_t i = 0; i < found.size() / 2; ++i) {
            const float texel[2] = {float(wanted[2 * i]) / 255, float(wanted[2 * i + 1]) / 255};
            double a[3], b[3];
            if (!is_occupied(i))
                continue;
            normal_of(texel, a);
            normal_of(&found[2 * i], b);
            const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            all.push_back(std::acos(std::min(1., dot)) * 57.29577951308232);
            sum += all.back();
        }
        if (all.empty())
            return;
        const size_t at = all.size() * 99 / 100;
        std::nth_element(all.begin(), all.begin() + ptrdiff_t(at), all.end());
        row.mean = sum / double(all.size());
        row.p99 = all[at];
    }
};

double processor_milliseconds()
{
    return double(std::clock()) * 1e3 / CLOCKS_PER_SEC;
}

void measure_parts(const gtx_model *model, MemoryRow &row)
{
    const size_t part_of[] = {0, 1, 2, 3, 4, 3, 3}; /* a slot */
    gtx_texture t;
    for (int slot = 0; slot < GTX_SLOT_COUNT; ++slot) {
        (void)gtx_model_texture(model, gtx_slot(slot), &t);
        for (uint32_t k = 0; k < t.levels; ++k) {
            const uint64_t wide = t.width >> k, high = t.height >> k;
            row.parts[part_of[slot]] +=
                t.layers * (t.block_size ? (wide + 3) / 4 * ((high + 3) / 4) * t.block_size
                                         : wide * high * t.texel_size);
        }
    }
    for (int buffer = 0; buffer < GTX_BUFFER_GRID_VERTICES; ++buffer) {
        uint64_t size;
        (void)gtx_model_buffer(model, gtx_buffer(buffer), &size);
        row.parts[buffer < GTX_BUFFER_LOD_VERTICES ? 5 : 6] += size;
    }
}

void measure_maps(BenchScene &scene, const std::string &path, MemoryRow &row)
{
    gtx_error error;
    gtx_asset *asset;
    gtx_model *model;
    const gtx_jobs jobs = gtx_host_jobs(0);
    gtx_model_desc desc = {};
    desc.jobs = &jobs;
    desc.limits = cli_limits;
    desc.compress = row.compress;
    desc.compress_normals = row.normals;
    gtx_open_desc open = {};
    open.limits = cli_limits;
    require_ok(gtx_open_file(path.c_str(), &open, &asset, &error), error);
    AssetPointer owner(asset);
    const double start = processor_milliseconds();
    require_ok(gtx_model_prepare(asset, &desc, &model, &error), error);
    row.prepare = processor_milliseconds() - start;
    std::unique_ptr<gtx_model, void (*)(gtx_model *)> freed(model, gtx_model_free);
    row.bytes = gtx_model_gpu_size(model).geometry + gtx_model_gpu_size(model).color;
    measure_parts(model, row);
    const Compared compared = {asset, scene.info};
    const struct {
        gtx_slot slot;
        gtx_map map;
        uint32_t channels;
        double *out;
    } maps[] = {{GTX_SLOT_COLORS, GTX_MAP_COLOR, 4, &row.color},
                {GTX_SLOT_MATERIALS, GTX_MAP_MATERIAL, 4, &row.material},
                {GTX_SLOT_EMISSIONS, GTX_MAP_EMISSION, 3, &row.emission}};
    gtx_texture t;
    for (const auto &m : maps)
        if (gtx_model_texture(model, m.slot, &t))
            *m.out = t.width == 1 ? double(INFINITY)
                                  : compared.psnr(m.map, decode(scene.gl, t, m.channels),
                                                  m.channels);
    if (gtx_model_texture(model, GTX_SLOT_NORMALS, &t))
        compared.angles(decode(scene.gl, t, 2), row);
}

/* Of what the first covers; heights are the same in both. */
double picture_psnr(const Vector<Picture> &wanted, const Vector<Picture> &found)
{
    double sum = 0, count = 0;
    for (size_t v = 0; v < wanted.size(); ++v)
        for (size_t i = 0; i < wanted[v].depth.size(); ++i)
            for (size_t c = 0; c < 3 && wanted[v].covers(i); ++c) {
                const double off = double(wanted[v].color[4 * i + c]) - found[v].color[4 * i + c];
                sum += off * off;
                count += 1;
            }
    return sum > 0 ? 10 * std::log10(255 * 255 * count / sum) : double(INFINITY);
}

Vector<Picture> pictures_of(BenchScene &scene, const std::array<uint32_t, 2> &size)
{
    Vector<Picture> out;
    const Target target(scene.gl, size[0], size[1]);
    for (int turn = 0; turn < BENCH_TURNS; ++turn)
        out.push_back(scene.picture(BenchMethod::CAST, Shot{size[0], size[1], 1, turn}, target));
    return out;
}

std::string decibels(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, value > 0 ? "%.2f" : "-", value);
    return value > EXACT ? "exact" : text;
}

} // namespace

void run_memory(const std::string &asset_path, BenchOptions options,
                const std::function<void(const MemoryRow &)> &tell)
{
    MemoryRow rows[] = {{"texels", GTX_COMPRESS_NONE, false},
                        {"BC7", GTX_COMPRESS_BC, false},
                        {"BC7, BC5", GTX_COMPRESS_BC, true},
                        {"BC1", GTX_COMPRESS_BC_SMALL, false},
                        {"BC1, BC5", GTX_COMPRESS_BC_SMALL, true},
                        {"ETC2", GTX_COMPRESS_ETC2, false},
                        {"ETC2, EAC", GTX_COMPRESS_ETC2, true}};
    Vector<Vector<Picture>> exact;
    for (MemoryRow &row : rows) {
        options.compress = row.compress;
        options.compress_normals = row.normals;
        try {
            BenchScene scene(asset_path, {}, options);
            measure_maps(scene, asset_path, row);
            for (size_t k = 0; k < options.sizes.size(); ++k) {
                Vector<Picture> found = pictures_of(scene, options.sizes[k]);
                if (exact.size() <= k)
                    exact.push_back(found);
                row.pictures.push_back(picture_psnr(exact[k], found));
            }
        } catch (const Error &error) {
            if (error.result != GTX_ERROR_UNSUPPORTED)
                throw;
            continue;
        }
        tell(row);
    }
}

void print_memory_head(const char *scene, const BenchOptions &options)
{
    std::string line = scene; /* of a table, whatever the path holds */
    gtx_make_printable(line.data());
    std::printf("%s: MB on the GPU, and of its parts, colours with material and emission; dB of\n"
                "their texels; degrees that normals stray; dB of cast pictures; processor ms to\n"
                "prepare\n| maps      | MB     |",
                line.c_str());
    for (const char *part : MEMORY_PARTS)
        std::printf(" %-8s |", part);
    std::printf(" colour | material | emission | mean  | p99   |");
    for (const std::array<uint32_t, 2> &size : options.sizes)
        std::printf(" %ux%u |", size[0], size[1]);
    std::printf(" prepare |\n|---|---|---|---|---|---|---|---|");
    for (size_t k = 0; k < options.sizes.size() + std::size(MEMORY_PARTS); ++k)
        std::printf("---|");
    std::printf("\n");
}

void print_memory(const MemoryRow &row)
{
    std::printf("| %-9s | %6.3f |", row.name, double(row.bytes) / 1e6);
    for (uint64_t bytes : row.parts)
        std::printf(" %8.3f |", double(bytes) / 1e6);
    std::printf(" %6s | %8s | %8s | %5.2f | %5.2f |", decibels(row.color).c_str(),
                decibels(row.material).c_str(), decibels(row.emission).c_str(), row.mean, row.p99);
    for (double psnr : row.pictures)
        std::printf(" %s |", decibels(psnr).c_str());
    std::printf(" %.0f |\n", row.prepare);
    std::fflush(stdout);
}

} // namespace gtx
