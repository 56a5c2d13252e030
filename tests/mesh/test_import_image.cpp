/* Images of glTF materials, wherever they lie, and images that are none. */
#include "test_import_material.hpp"

#include <zlib.h>

/* A PNG that claims that size and has no texel. */
static std::string claiming_png(uint32_t width, uint32_t height)
{
    auto big = [](uint32_t v) {
        return packed<uint8_t>({uint8_t(v >> 24), uint8_t(v >> 16), uint8_t(v >> 8), uint8_t(v)});
    };
    auto chunk = [&](const std::string &text) {
        uLong crc = crc32(0, reinterpret_cast<const Bytef *>(text.data()), uInt(text.size()));
        return big(uint32_t(text.size() - 4)) + text + big(uint32_t(crc));
    };
    return "\x89PNG\r\n\x1a\n" +
           chunk("IHDR" + big(width) + big(height) + packed<uint8_t>({8, 6, 0, 0, 0})) +
           chunk("IDAT") + chunk("IEND");
}

static void test_image_files(void **)
{
    Folder folder;
    folder.write("my a.png", png(folder, 2, 2, {255, 0, 188, 255}));
    folder.write("b.png", "never looked at");
    Imported i = import_textured(folder, base_color,
                                 "'textures':[{'source':1}],"
                                 "'images':[{'uri':'b.png'},{'uri':'my%20a.png'}]");
    assert_works(i, 4, 2);
    assert_true(i.warnings.empty());
    assert_int_equal(i.sources.size(), 2);
    assert_true(std::filesystem::equivalent(i.sources[1], folder.path / "my a.png"));
    assert_int_equal(i.mesh.appearance.images.size(), 1);
    assert_int_equal(i.mesh.appearance.images[0].levels.size(), 2);
    assert_sample(i.mesh, 0, {1, 0, gtx::srgb_to_linear(188), 1});
    assert_int_equal(i.mesh.appearance.uv[0].size(), 6);
    assert_true(i.mesh.appearance.uv[1].empty() && i.mesh.appearance.tangents.empty());
    assert_true(i.mesh.appearance.uv[0][2][1] == 1);
}

static void test_embedded_images(void **)
{
    Folder folder;
    const std::string image = png(folder, 3, 1, {0, 255, 0, 255});
    Imported i = import_textured(folder, base_color,
                                 "'textures':[{'source':0}],"
                                 "'images':[{'uri':'data:image/png;base64," +
                                     base64(image) + "'}]");
    assert_true(i.warnings.empty());
    assert_sample(i.mesh, 0, {0, 1, 0, 1});
    assert_int_equal(i.sources.size(), 1);

    std::string json = textured(base_color, "'textures':[{'source':0}],"
                                            "'images':[{'bufferView':3,'mimeType':'image/png'}]");
    const std::string size = std::to_string(image.size());
    json = change(json, "'byteOffset':60,'byteLength':32}",
                  "'byteOffset':60,'byteLength':32},{'buffer':0,'byteOffset':92,'byteLength':" +
                      size + "}");
    json = change(json, "'byteLength':92", "'byteLength':" + std::to_string(92 + image.size()));
    i = import_data(json, square() + coordinates() + image);
    assert_true(i.warnings.empty());
    assert_sample(i.mesh, 0, {0, 1, 0, 1});
}

/* Whatever is wrong with an image, the model is there, in the factor's colour. */
static void test_bad_images(void **)
{
    Folder folder;
    const std::string good = png(folder, 64, 64, {9, 9, 9, 255});
    folder.write("sub/a.png", good);
    folder.write("text.png", "not an image");
    folder.write("empty.png", "");
    folder.write("half.png", good.substr(0, 40));
    folder.write("vast.png", claiming_png(65535, 65535));
    folder.write("claims.png", claiming_png(100, 100));
    static const struct {
        const char *image, *warning;
    } cases[] = {
        {"'uri':'none.png'", "image 0 ('none.png') was ignored: cannot open the file: No such "
         "file or directory"},
        {"'uri':'../a.png'", "image 0 ('../a.png') was ignored: it is not a file in the model's"},
        {"'uri':'https://example.com/a.png'", "it is not a file in the model's folder"},
        {"'uri':'/dev/zero'", "it is not a file in the model's folder"},
        {"'uri':'sub'",
         "image 0 ('sub') was ignored: cannot read the file: it is not a regular one"},
        {"'uri':'text.png'", "image 0 ('text.png') was ignored: neither PNG"},
        {"'uri':'empty.png'", "image 0 ('empty.png') was ignored"},
        {"'uri':'half.png'", "image 0 ('half.png') was ignored"},
        {"'uri':'claims.png'", "image 0 ('claims.png') was ignored"},
        {"'uri':'data:image/png;base64,!'", "image 0 was ignored: image 0: its data URI"},
        {"'bufferView':9", "image 0 was ignored: image 0: there is no buffer view 9"},
        {"'name':'x'", "image 0 was ignored: image 0: there is no buffer view -1"},
    };
    for (const auto &c : cases) {
        Imported i = import_textured(
            folder,
            "{'emissiveFactor':[1,1,1],'emissiveTexture':{'index':0},'normalTexture':{'index':0},"
            "'pbrMetallicRoughness':{'baseColorFactor':[0.5,1,0,1],"
            "'baseColorTexture':{'index':0}}}",
            std::string("'textures':[{'source':0}],'images':[{") + c.image + "}]");
        assert_works(i, 4, 2);
        if (i.warnings.size() != 1 || !i.warns(c.warning))
            fail_msg("%zu warnings: '%s', not '%s'", i.warnings.size(),
                     i.warnings.empty() ? "" : i.warnings[0].c_str(), c.warning);
        assert_sample(i.mesh, 0, {0.5, 1, 0, 1});
        assert_true(look(i).emission[0] == 0); /* not a model that glows all over */
        assert_true(i.mesh.appearance.images.empty() && i.mesh.appearance.uv[0].empty());
    }
    assert_fails(import_textured(folder,
                                 "{'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}}",
                                 "'textures':[{'source':0}],'images':[{'uri':'vast.png'}]"),
                 GTX_ERROR_LIMIT, "image 0 ('vast.png') takes 4294836225 pixels");
}

static void test_many_threads(void **)
{
    Folder folder;
    std::string materials, textures, images, sum;
    for (int k = 0; k < 6; ++k) {
        const std::string n = std::to_string(k);
        folder.write(n + ".png", png(folder, 8, 8, {uint8_t(40 * k), 0, 0, 255}));
        textures += std::string(k ? "," : "") + "{'source':" + n + "}";
        images += std::string(k ? "," : "") + "{'uri':'" + n + ".png'}";
        if (k < 5)
            materials += std::string(k ? "," : "") + "{'pbrMetallicRoughness':{'baseColorTexture':"
                                                     "{'index':" + n + "}}}";
    }
    std::string json =
        textured(materials, "'textures':[" + textures + "],'images':[" + images + "]");
    std::string primitives;
    for (int k = 0; k < 5; ++k)
        primitives += std::string(k ? "," : "") +
                      "{'attributes':{'POSITION':0,'TEXCOORD_0':2},'indices':1,'material':" +
                      std::to_string(4 - k) + "}";
    json = change(json, "{'attributes':{'POSITION':0,'TEXCOORD_0':2},'indices':1,'material':0}",
                  primitives);
    const std::string path =
        folder.write("a.gltf", with_data(json, square() + coordinates()));
    for (unsigned threads : {1u, 4u}) {
        Task task(threads, nullptr, nullptr);
        gtx::Vector<std::string> sources;
        Mesh mesh = gtx::import_mesh(path, task, &sources);
        assert_int_equal(sources.size(), 6); /* the model, and not the image that nobody uses */
        assert_int_equal(mesh.appearance.images.size(), 5);
        for (size_t t = 0; t < 10; ++t)
            assert_sample(mesh, t, {gtx::srgb_to_linear(uint8_t(40 * (4 - t / 2))), 0, 0, 1});
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_image_files), cmocka_unit_test(test_embedded_images),
        cmocka_unit_test(test_bad_images), cmocka_unit_test(test_many_threads),
    };
    return cmocka_run_group_tests_name("import_image", tests, nullptr, nullptr);
}
