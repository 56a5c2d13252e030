/* glTF materials: factors, textures, coordinates and tangents. */
#include "test_import_material.hpp"

/* One texture of the file a.png for the material. */
static Imported import_one(const Folder &folder, const std::string &material)
{
    return import_textured(folder, material,
                           "'textures':[{'source':0}],'images':[{'uri':'a.png'}]");
}

static void test_texture_info(void **)
{
    Folder folder;
    folder.write("a.png", png(folder, 1, 1, {255, 255, 255, 255}));
    std::string rest = "'textures':[{'source':0,'sampler':0}],'images':[{'uri':'a.png'}],"
                       "'samplers':[{'wrapS':33071,'wrapT':33648}]";
    Imported i = import_textured(folder, base_color, rest);
    assert_true(material(i).color_map.wrap[0] == Wrap::CLAMP);
    assert_true(material(i).color_map.wrap[1] == Wrap::MIRROR);
    assert_true(i.warnings.empty());
    assert_fails(import_textured(folder, base_color, edited(rest, "'sampler':0", "'sampler':1")),
                 GTX_ERROR_INPUT, "textures[0]: there is no samplers[1]");
    assert_fails(import_textured(folder, base_color, edited(rest, "'source':0", "'source':1")),
                 GTX_ERROR_INPUT, "textures[0]: there is no images[1]");
    i = import_textured(folder, base_color, edited(rest, "'source':0,", ""));
    assert_true(i.warns("textures[0] has no image: ignored"));
    i = import_textured(folder, base_color,
                        edited(rest, "'source':0",
                               "'extensions':{'EXT_texture_webp':{'source':0}}"));
    assert_true(i.warnings.empty() && material(i).color_map.used());

    std::ifstream ktx("tests/image/ktx/etc1s_alpha.ktx2", std::ios::binary);
    folder.write("a.ktx2", std::string(std::istreambuf_iterator<char>(ktx), {}));
    rest = "'textures':[{'extensions':{'KHR_texture_basisu':{'source':0}}}],"
           "'images':[{'uri':'a.ktx2','mimeType':'image/ktx2'}]";
    i = import_textured(folder, base_color, rest);
    assert_true(i.warnings.empty() && material(i).color_map.used());
    assert_int_equal(i.mesh.appearance.images[0].levels[0].width, 45);

    /* KHR_texture_transform: half the size, turned a quarter, moved, and of another set */
    const std::string transform =
        "{'pbrMetallicRoughness':{'baseColorTexture':{'index':0,'texCoord':5,'extensions':"
        "{'KHR_texture_transform':{'offset':[0.25,0.5],'rotation':1.5707963,'scale':[0.5,2],"
        "'texCoord':0}}}}}";
    i = import_one(folder, transform);
    assert_works(i, 4, 2);
    const float expected[6] = {0, 2, 0.25f, -0.5f, 0, 0.5f};
    for (int k = 0; k < 6; ++k)
        assert_float_equal(material(i).color_map.transform[k], expected[k], 1e-6);
    i = import_one(folder, edited(transform, ",'texCoord':0", ""));
    assert_true(i.warns("mesh 0 primitive 0 has no TEXCOORD_5"));
    assert_works(i, 4, 2);
    assert_true(i.mesh.appearance.images.empty());
    i = import_one(folder,
                   "{'normalTexture':{'index':0,'texCoord':1},'occlusionTexture':{'index':0},"
                   "'pbrMetallicRoughness':{'baseColorTexture':{'index':0,'texCoord':2}}}");
    assert_true(i.warns("occlusionTexture needs a third set of coordinates"));
    static const char *const bad[][2] = {
        {"'index':0", "'index':1"},           {"'index':0,", ""},
        {"'index':0", "'index':-1"},          {"[0.25,0.5]", "[0.25]"},
        {"[0.25,0.5]", "[0.25,'x']"},         {"'rotation':1.5707963", "'rotation':[]"},
        {"'texCoord':0", "'texCoord':0.5"},   {"{'offset'", "[{'offset'"},
    };
    for (const auto &b : bad)
        assert_fails(import_one(folder, edited(transform, b[0], b[1])), GTX_ERROR_INPUT, "");
}

/* The same image for colour and for numbers: averaged in two ways, read once. */
static void test_shared_image(void **)
{
    Folder folder;
    folder.write("a.png", png(folder, 2, 1, {51, 102, 204, 255}));
    Imported i = import_one(folder, "{'occlusionTexture':{'index':0,'strength':0.5},"
                                    "'pbrMetallicRoughness':{'baseColorTexture':{'index':0},"
                                    "'metallicRoughnessTexture':{'index':0},"
                                    "'metallicFactor':0.5}}");
    assert_int_equal(i.mesh.appearance.images.size(), 2);
    assert_int_equal(i.sources.size(), 2);
    assert_float_equal(look(i).roughness, 0.4, 1e-3);
    assert_float_equal(look(i).metallic, 0.4, 1e-3);
    assert_float_equal(look(i).occlusion, 0.6, 1e-3);
    assert_float_equal(look(i).color[0], gtx::srgb_to_linear(51), 1e-3);
}

static void test_values(void **)
{
    Folder folder;
    Imported i = import_one(folder, "{}");
    assert_true(material(i).metallic == 1 && material(i).roughness == 1);
    assert_true(i.mesh.flags.empty() && i.mesh.appearance.uv[0].empty());
    i = import_one(folder,
                   "{'doubleSided':true,'alphaMode':'MASK','emissiveFactor':[0.5,0,1],"
                   "'extensions':{'KHR_materials_emissive_strength':{'emissiveStrength':4},"
                   "'KHR_materials_unlit':{},'KHR_materials_clearcoat':{}},"
                   "'pbrMetallicRoughness':{'baseColorFactor':[1,0.5,0,0.75],'metallicFactor':0.25,"
                   "'roughnessFactor':0.5}}");
    const SurfaceSample s = look(i);
    assert_sample(i.mesh, 0, {1, 0.5, 0, 1});
    assert_true(s.metallic == 0.25f && s.roughness == 0.5f && s.lit == 0 && s.cut == 0.25f);
    assert_true(s.emission[0] == 2 && s.emission[1] == 0 && s.emission[2] == 4);
    assert_int_equal(i.mesh.flags.size(), 2);
    assert_true(i.warns("KHR_materials_clearcoat was ignored"));
    assert_int_equal(i.warnings.size(), 1);
    i = import_one(folder, "{'alphaMode':'MASK','alphaCutoff':0.9,'pbrMetallicRoughness':"
                           "{'baseColorFactor':[1,1,1,0.75]}}");
    assert_float_equal(look(i).cut, -0.15, 1e-6);
    i = import_one(folder, "{'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorFactor':"
                           "[1,1,1,0.25]}}");
    assert_true(i.warns("blended materials are drawn opaque") && look(i).cut >= 0);
    assert_true(look(i).color[3] == 1);
    /* what says nothing costs nothing */
    i = import_one(folder, "{'pbrMetallicRoughness':{'metallicFactor':0}}");
    assert_true(i.mesh.appearance.materials.empty() && i.mesh.appearance.material.empty());
    static const char *const bad[] = {
        "7", "{'pbrMetallicRoughness':[]}", "{'emissiveFactor':[1,1]}", "{'alphaMode':1}",
        "{'doubleSided':1}", "{'pbrMetallicRoughness':{'metallicFactor':'x'}}",
        "{'pbrMetallicRoughness':{'baseColorFactor':[1,1,1]}}", "{'extensions':3}",
        "{'normalTexture':{'index':0,'scale':null}}",
        "{'extensions':{'KHR_materials_emissive_strength':{'emissiveStrength':[]}}}",
    };
    for (const char *material : bad)
        assert_fails(import_one(folder, material), GTX_ERROR_INPUT, "material");
}

static void test_specular_glossiness(void **)
{
    Folder folder;
    const std::string both =
        "{'extensions':{'KHR_materials_pbrSpecularGlossiness':{'diffuseFactor':[0.5,1,1,1],"
        "'diffuseTexture':{'index':0},'glossinessFactor':0.5,"
        "'specularGlossinessTexture':{'index':0}}}}";
    folder.write("a.png", png(folder, 1, 1, {255, 188, 9, 204}));
    Imported i = import_one(folder, both);
    assert_true(i.warns("specular-glossiness"));
    assert_sample(i.mesh, 0, {0.5, 0.5, gtx::srgb_to_linear(9), 1});
    assert_float_equal(look(i).roughness, 1 - 0.5 * 0.8, 3e-3);
    assert_float_equal(look(i).metallic, 0, 0);
    i = import_one(folder, edited(both, ",'specularGlossinessTexture':{'index':0}", ""));
    assert_float_equal(look(i).roughness, 0.5, 1e-6);
}

/* The image that a caller gives takes the place of one that cannot be read, and of no other. */
static void test_given_base_color(void **)
{
    Folder folder;
    const std::string given = folder.write("given.png", png(folder, 1, 1, {0, 255, 0, 255}));
    const std::string json = textured(base_color, "'textures':[{'source':0}],"
                                                  "'images':[{'uri':'a.png'}]");
    const std::string path = folder.write("a.gltf", with_data(json, square() + coordinates()));
    const std::string images[] = {"", "no image", png(folder, 1, 1, {255, 0, 0, 255})};
    for (const std::string &image : images) {
        Task task(1, nullptr, nullptr);
        if (!image.empty())
            folder.write("a.png", image);
        gtx::ModelFile file = gtx::read_model(path, task);
        file.textures.base_color = given;
        const Mesh mesh = gtx::import_model(file, task);
        const bool reads = &image == images + 2;
        assert_sample(mesh, 0, {reads ? 1.f : 0.f, reads ? 0.f : 1.f, 0, 1});
        assert_true(task.warnings.empty());
    }
}

/* Primitives with a material and without, with coordinates and without. */
static void test_mixture(void **)
{
    Folder folder;
    folder.write("a.png", png(folder, 1, 1, {255, 0, 0, 255}));
    std::string json = textured(base_color, "'textures':[{'source':0}],'images':[{'uri':'a.png'}]");
    const char first[] = "{'attributes':{'POSITION':0,'TEXCOORD_0':2},'indices':1,'material':0}";
    json = change(json, first, std::string("{'attributes':{'POSITION':0},'indices':1},") + first +
                                   ",{'attributes':{'POSITION':0},'indices':1,'material':0}");
    Imported i =
        import_path(folder.write("a.gltf", with_data(json, square() + coordinates())));
    assert_works(i, 12, 6);
    assert_sample(i.mesh, 0, {1, 1, 1, 1});
    assert_sample(i.mesh, 2, {1, 0, 0, 1});
    assert_sample(i.mesh, 4, {1, 1, 1, 1});
    assert_int_equal(i.mesh.appearance.material.size(), 6);
    assert_int_equal(i.mesh.appearance.uv[0].size(), 18);
    assert_int_equal(i.mesh.appearance.materials.size(), 3);
    assert_true(i.warns("mesh 0 primitive 2 has no TEXCOORD_0"));
    assert_true(i.mesh.appearance.materials[0].metallic == 0); /* no material is no metal */
}

/* Quantised coordinates and tangents, the tangents turned with a mirrored node. */
static void test_quantised(void **)
{
    Folder folder;
    folder.write("a.png", png(folder, 1, 1, {218, 128, 218, 255}));
    std::string json = textured("{'normalTexture':{'index':0}}",
                                "'textures':[{'source':0}],'images':[{'uri':'a.png'}]");
    json = change(json, "'TEXCOORD_0':2", "'TEXCOORD_0':2,'TANGENT':3,'NORMAL':4");
    json = change(json, "'componentType':5126,'count':4,'type':'VEC2'}",
                  "'componentType':5123,'normalized':true,'count':4,'type':'VEC2'},"
                  "{'bufferView':3,'componentType':5120,'normalized':true,'count':4,'type':'VEC4'},"
                  "{'bufferView':4,'componentType':5120,'normalized':true,'count':4,"
                  "'type':'VEC3'}");
    json = change(json, "'byteOffset':60,'byteLength':32}",
                  "'byteOffset':60,'byteLength':16},{'buffer':0,'byteOffset':76,'byteLength':16},"
                  "{'buffer':0,'byteOffset':92,'byteLength':16,'byteStride':4}");
    json = change(json, "'byteLength':92", "'byteLength':108");
    json = change(json, "{'mesh':0}", "{'mesh':0,'scale':[-1,1,1]}");
    json = change(json, "'asset'", "'extensionsRequired':['KHR_mesh_quantization'],'asset'");
    std::string bytes = square() + packed<uint16_t>({0, 0, 65535, 0, 65535, 65535, 0, 65535});
    for (int k = 0; k < 4; ++k)
        bytes += packed<int8_t>({127, 0, 0, 127});
    for (int k = 0; k < 4; ++k)
        bytes += packed<int8_t>({0, 0, 127, 0});
    Imported i = import_path(folder.write("a.gltf", with_data(json, bytes)));
    assert_works(i, 4, 2);
    assert_true(i.mesh.appearance.uv[0][1][1] == 1); /* the corners 1 and 2 changed places */
    const auto &t = i.mesh.appearance.tangents[0];
    assert_true(t[0] == -1 && t[3] == -1 && i.mesh.normals[0].z == 1);
    assert_float_equal(look(i).normal.x, -0.707, 0.01); /* u grows towards -x now */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_texture_info), cmocka_unit_test(test_shared_image),
        cmocka_unit_test(test_values), cmocka_unit_test(test_specular_glossiness),
        cmocka_unit_test(test_given_base_color),
        cmocka_unit_test(test_mixture), cmocka_unit_test(test_quantised),
    };
    return cmocka_run_group_tests_name("import_material", tests, nullptr, nullptr);
}
