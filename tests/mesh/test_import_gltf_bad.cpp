/* glTF documents that lie, and what is told of those that ask for more than is read. */
#include "test_import_gltf.hpp"

static Imported import_json(const std::string &json)
{
    return import_text("a.gltf", quoted(json));
}

static void test_ignored(void **)
{
    Imported i = import_changed("'asset'", R"("images":[{"uri":"/etc/passwd"}],"skins":[{}],
        "cameras":[{}],"animations":[{}],"extensionsUsed":["ACME_glow","KHR_lights_punctual"],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},"extras":{"a":[1]},
        "asset")");
    assert_works(i, 4, 2);
    for (const char *what : {"skins", "cameras", "animations", "ACME_glow", "lights"})
        assert_true(i.warns(what));
    assert_int_equal(i.sources.size(), 1);
    assert_true(import_changed("'indices':1", R"("indices":1,"targets":[{"POSITION":0}])")
                    .warns("morph targets"));
}

static void test_bad(void **)
{
    static const struct {
        const char *from, *to;
        gtx_result result;
        const char *message;
    } bad[] = {
        {"'2.0'", "'1.0'", GTX_ERROR_UNSUPPORTED, "version 1.0"},
        {"{'version':'2.0'}", "{}", GTX_ERROR_INPUT, "asset.version"},
        {"'asset'", "'extensionsRequired':['ACME_x'],'asset'", GTX_ERROR_UNSUPPORTED, "ACME_x"},
        {"{'buffer':0,'byteLength':48}",
         "{'buffer':0,'byteLength':48,'extensions':{'EXT_meshopt_compression':{}}}",
         GTX_ERROR_INPUT, "buffer view 0: its meshopt mode is unknown"},
        {"'POSITION':0", "'NORMAL':0", GTX_ERROR_INPUT, "mesh 0 primitive 0 has no POSITION"},
        {"'POSITION':0", "'POSITION':5", GTX_ERROR_INPUT, "no accessor 5"},
        {"'POSITION':0", "'POSITION':-1", GTX_ERROR_INPUT, "attributes.POSITION is not an index"},
        {"'POSITION':0", "'POSITION':0,'NORMAL':1", GTX_ERROR_INPUT, "do not fit together"},
        {"'attributes':{'POSITION':0},", "", GTX_ERROR_INPUT, "no attributes"},
        {"'count':4", "'count':5", GTX_ERROR_INPUT,
         "accessor 0: 5 values lie outside buffer view 0"},
        {"'count':4", "'count':18446744073709551615", GTX_ERROR_INPUT, "lie outside"},
        {"'count':4", "'count':-1", GTX_ERROR_INPUT, "accessors[0].count is not a size"},
        {"'count':4", "'count':4,'byteOffset':18446744073709551615", GTX_ERROR_INPUT,
         "lie outside"},
        {"'count':4", "'count':4,'byteOffset':-12", GTX_ERROR_INPUT, "accessors[0].byteOffset"},
        {"5126", "5130", GTX_ERROR_INPUT, ""},
        {"5126", "1", GTX_ERROR_INPUT, ""},
        {"'VEC3'", "'VEC2'", GTX_ERROR_INPUT, "do not fit together"},
        {"'VEC3'", "'MAT4'", GTX_ERROR_INPUT, "accessor 0 is neither"},
        {"'VEC3'", "'VEC9'", GTX_ERROR_INPUT, "VEC9"},
        {"'byteLength':48}", "'byteLength':61}", GTX_ERROR_INPUT,
         "buffer view 0 lies outside buffer 0"},
        {"'byteOffset':48", "'byteOffset':18446744073709551610", GTX_ERROR_INPUT,
         "buffer view 1 lies"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':4,'byteLength':48}", GTX_ERROR_INPUT,
         "buffer view 0: there is no buffer 4"},
        {"'bufferView':0", "'bufferView':9", GTX_ERROR_INPUT,
         "accessor 0: there is no buffer view 9"},
        {"'byteLength':60", "'byteLength':99", GTX_ERROR_INPUT, "buffer 0 has 60 of its 99 bytes"},
        {"'byteLength':60,", "", GTX_ERROR_INPUT, "buffer 0 has no byteLength"},
        {"{'mesh':0}", "{'mesh':0,'scale':[1,1]}", GTX_ERROR_INPUT, "node 0: its scale has 2"},
        {"{'mesh':0}", "{'mesh':0,'matrix':['x']}", GTX_ERROR_INPUT, "nodes[0].matrix[0]"},
        {"{'mesh':0}", "7", GTX_ERROR_INPUT, "nodes[0] is not an object"},
        {"[{'mesh':0}]", "{}", GTX_ERROR_INPUT, "nodes is not an array"},
        {"'asset'", "asset", GTX_ERROR_INPUT, "the JSON is malformed"},
    };
    for (const auto &b : bad)
        assert_fails(import_changed(b.from, b.to), b.result, b.message);
    std::string deep(1000000, '[');
    assert_fails(import_json("{'a':" + deep), GTX_ERROR_LIMIT, "100 levels");
    assert_fails(import_json("{'a':'[{" + deep), GTX_ERROR_INPUT, "malformed"); /* in a string */
    assert_fails(import_json("{'asset':{'version':'\xff'}}"), GTX_ERROR_INPUT, "malformed");
    assert_fails(import_json("[]"), GTX_ERROR_INPUT, "");
    assert_fails(import_json("{}"), GTX_ERROR_INPUT, "asset.version");
    assert_fails(import_json("{'asset':{'version':'2.0'}}"), GTX_ERROR_EMPTY, "no triangle");
}

/* Draco inside glTF: every number that points into the stream. */
static void test_bad_draco(void **)
{
    auto with_extension = [](const std::string &extension) {
        return import_changed("'indices':1}",
                              "'extensions':{'KHR_draco_mesh_compression':" + extension + "}}");
    };
    assert_fails(with_extension("{}"), GTX_ERROR_INPUT, "lacks its view");
    assert_fails(with_extension("7"), GTX_ERROR_INPUT, "is not an object");
    assert_fails(with_extension("{'bufferView':-1,'attributes':{}}"), GTX_ERROR_INPUT,
                 "bufferView");
    assert_fails(with_extension("{'bufferView':77,'attributes':{'POSITION':0}}"), GTX_ERROR_INPUT,
                 "mesh 0 primitive 0: there is no buffer view 77");
    assert_fails(with_extension("{'bufferView':0,'attributes':{'POSITION':0}}"), GTX_ERROR_INPUT,
                 "Draco header");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ignored), cmocka_unit_test(test_bad),
        cmocka_unit_test(test_bad_draco),
    };
    return cmocka_run_group_tests_name("import_gltf_bad", tests, nullptr, nullptr);
}
