/* Textures as KTX2: blocks of UASTC, the container, and exports that hold them. */
#include "exported.hpp"

#include "export/ktx2.hpp"
#include "export/uastc_encode.hpp"
#include "image/image.h"
extern "C" {
#include "image/basis.h"
#include "image/ktx.h"
}

#include <algorithm>
#include <functional>

using namespace gtx;

static uint64_t state = 1;

static double random_share()
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return double(state >> 40) / double(1 << 24);
}

static double psnr(double squares, double numbers)
{
    return squares > 0 ? 10 * std::log10(255.0 * 255.0 * numbers / squares) : 99;
}

/* ---- blocks ---- */

/* What a block shows at column x, row y, channel c; numbers of its own are drawn anew for each. */
struct Kind {
    const char *name;
    double least; /* dB */
    double (*value)(const double n[8], int x, int y, int c);
};

static const Kind kinds[] = {
    {"solid", 99, [](const double n[8], int, int, int c) { return n[c]; }},
    {"gradient", 50, [](const double n[8], int x, int y, int c) {
         return n[c] + (n[c + 3] - n[c]) * 0.2 * (x + y) / 6;
     }},
    {"bump", 42, [](const double n[8], int x, int y, int c) {
         const double nx = (n[0] - 128) / 256 + (n[1] - 128) * x / 2000 + (n[2] - 128) * y / 2000;
         const double ny = (n[3] - 128) / 256 + (n[4] - 128) * x / 2000 + (n[5] - 128) * y / 2000;
         const double nz = std::sqrt(std::max(0., 1 - nx * nx - ny * ny));
         return 127.5 + 127.5 * (c == 0 ? nx : c == 1 ? ny : nz);
     }},
    {"edge", 40, [](const double n[8], int x, int y, int c) {
         return x + (n[6] > 128) > 1 + (y > 1 && n[7] > 128) ? n[c] : n[c + 3];
     }},
    {"noise", 15, [](const double[8], int, int, int) { return 255 * random_share(); }}};

static void blocks_show_what_they_are_of(void **)
{
    constexpr int BLOCKS = 400;
    for (const Kind &kind : kinds) {
        double squares = 0;
        for (int b = 0; b < BLOCKS; ++b) {
            double numbers[8];
            UastcTexels texels;
            uint8_t shown[64];
            for (double &n : numbers)
                n = 255 * random_share();
            for (int i = 0; i < 16; ++i)
                for (int c = 0; c < 3; ++c)
                    texels[size_t(i)][size_t(c)] = uint8_t(std::clamp(
                        kind.value(numbers, i % 4, i / 4, c) + 0.5, 0., 255.));
            gtx_uastc_decode(encode_uastc(texels).data(), shown);
            for (size_t i = 0; i < 16; ++i) {
                assert_int_equal(shown[4 * i + 3], 255);
                for (size_t c = 0; c < 3; ++c)
                    squares += std::pow(double(shown[4 * i + c]) - double(texels[i][c]), 2);
            }
        }
        if (psnr(squares, 48.0 * BLOCKS) < kind.least)
            fail_msg("%s: %.1f dB", kind.name, psnr(squares, 48.0 * BLOCKS));
    }
}

/* ---- the container ---- */

static uint32_t word(const Bytes &file, size_t at)
{
    uint32_t out;
    std::memcpy(&out, &file[at], 4);
    return out;
}

static Bytes waves(uint32_t width, uint32_t height, TexelKind kind, unsigned threads,
                   std::vector<uint8_t> &texels)
{
    texels.resize(3 * size_t(width) * height);
    for (size_t i = 0; i < texels.size(); ++i) {
        const double x = double(i / 3 % width), y = double(i / 3 / width);
        texels[i] = uint8_t(127.5 + 90 * std::sin(x / 9 + double(i % 3)) * std::cos(y / 7));
    }
    Task task(threads, nullptr, nullptr);
    return encode_ktx2(width, height, texels.data(), kind, task);
}

static void a_file_has_all_levels(void **)
{
    std::vector<uint8_t> texels;
    const Bytes file = waves(72, 40, TexelKind::COLOR, 1, texels);
    assert_true(file == waves(72, 40, TexelKind::COLOR, 3, texels));
    assert_true(file != waves(72, 40, TexelKind::NUMBERS, 1, texels));
    assert_true(gtx_is_ktx(file.data(), file.size()));
    assert_int_equal(word(file, 40), 7); /* 72, 36, 18, 9, 4, 2, 1 */
    gtx_image image;
    gtx_error error;
    assert_int_equal(gtx_ktx_decode(file.data(), file.size(), 1 << 20, &image, &error), GTX_OK);
    assert_true(image.width == 72 && image.height == 40);
    double squares = 0;
    for (size_t i = 0; i < texels.size(); ++i)
        squares += std::pow(double(image.pixels[4 * (i / 3) + i % 3]) - double(texels[i]), 2);
    gtx_image_free(&image);
    if (psnr(squares, double(texels.size())) < 36)
        fail_msg("%.1f dB", psnr(squares, double(texels.size())));
    /* Coarser levels lie before finer ones, end to end, and have their blocks. */
    for (uint32_t k = 0; k < 7; ++k) {
        const size_t entry = 80 + 24 * k;
        const uint32_t w = (std::max(72u >> k, 1u) + 3) / 4, h = (std::max(40u >> k, 1u) + 3) / 4;
        assert_int_equal(word(file, entry + 16), 16 * w * h);
        assert_true(word(file, entry) + word(file, entry + 8) <=
                    (k ? word(file, entry - 24) : file.size()));
    }
    /* The first level alone as a file: the mean of a level is that of the one before. */
    const Bytes numbers = waves(64, 64, TexelKind::NUMBERS, 1, texels);
    double means[2] = {0, 0};
    for (uint32_t k = 0; k < 2; ++k) {
        Bytes alone = numbers;
        std::memcpy(&alone[80], &numbers[80 + 24 * (k ? 2 : 0)], 24);
        const uint32_t side = k ? 16 : 64;
        std::memcpy(&alone[20], &side, 4);
        std::memcpy(&alone[24], &side, 4);
        assert_int_equal(gtx_ktx_decode(alone.data(), alone.size(), 1 << 20, &image, &error),
                         GTX_OK);
        for (size_t i = 0; i < size_t(side) * side; ++i)
            means[k] += double(image.pixels[4 * i + 1]) / side / side;
        gtx_image_free(&image);
    }
    assert_true(std::fabs(means[0] - means[1]) < 1);
}

/* ---- exports ---- */

static void exports_hold_the_same_maps(void **)
{
    const std::string asset = cooked(sphere_obj(40, true), "a.obj");
    gtx_export_desc desc = {};
    const Glb png(exported(asset, desc));
    desc.textures = GTX_EXPORT_KTX2;
    const Glb ktx(exported(asset, desc));
    const auto &required = ktx.root["extensionsRequired"];
    assert_true(std::find(required.begin(), required.end(), "KHR_texture_basisu") !=
                required.end());
    assert_int_equal(png.root["images"].size(), ktx.root["images"].size());
    for (size_t i = 0; i < ktx.root["images"].size(); ++i) {
        assert_true(ktx.root["images"][i]["mimeType"] == "image/ktx2");
        assert_int_equal(ktx.root["textures"][i]["extensions"]["KHR_texture_basisu"]["source"]
                             .get<size_t>(), i);
        assert_false(ktx.root["textures"][i].contains("source"));
        gtx_image images[2];
        gtx_error error = {};
        const Glb *const files[] = {&png, &ktx};
        for (size_t k = 0; k < 2; ++k) {
            const std::string bytes =
                files[k]->view(files[k]->root["images"][i]["bufferView"]);
            if (gtx_image_decode(bytes.data(), bytes.size(), &images[k], &error))
                fail_msg("image %zu: %s", i, error.message);
        }
        assert_true(images[0].width == images[1].width && images[0].height == images[1].height);
        double squares = 0;
        const size_t texels = size_t(images[0].width) * images[0].height;
        for (size_t t = 0; t < 4 * texels; ++t)
            squares += std::pow(double(images[0].pixels[t]) - double(images[1].pixels[t]), 2);
        print_message("# image %zu: %.1f dB\n", i, psnr(squares, 4.0 * double(texels)));
        assert_true(psnr(squares, 4.0 * double(texels)) > 38);
        for (gtx_image &image : images)
            gtx_image_free(&image);
    }
    /* The asset is there as it was, and coarser levels have normals of fit sides. */
    desc.lods = 1;
    desc.compress = GTX_EXPORT_DRACO;
    const std::string file = exported(asset, desc);
    const Glb all(file);
    const void *found = nullptr;
    size_t size = 0;
    assert_int_equal(gtx_find_asset(file.data(), file.size(), &found, &size, nullptr),
                     GTX_OK);
    assert_true(std::string_view(static_cast<const char *>(found), size) == asset);
    for (size_t i = 0; i < all.root["images"].size(); ++i) {
        const std::string bytes = all.view(all.root["images"][i]["bufferView"]);
        assert_true(word(Bytes(bytes.begin(), bytes.end()), 20) % 4 == 0);
        assert_true(word(Bytes(bytes.begin(), bytes.end()), 24) % 4 == 0);
    }
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_show_what_they_are_of),
        cmocka_unit_test(a_file_has_all_levels),
        cmocka_unit_test(exports_hold_the_same_maps),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
