/* EXT_meshopt_compression: every mode and filter, encoded here; and sizes that lie. */
#include "test_import_gltf.hpp"

#include <meshoptimizer.h>

static std::string text_of(const gtx::Vector<unsigned char> &bytes, size_t size)
{
    return std::string(reinterpret_cast<const char *>(bytes.data()), size);
}

static std::string vertices(const std::string &raw, size_t stride)
{
    const size_t count = raw.size() / stride;
    gtx::Vector<unsigned char> out(meshopt_encodeVertexBufferBound(count, stride));
    size_t size = meshopt_encodeVertexBuffer(out.data(), out.size(), raw.data(), count, stride);
    assert_true(size > 0);
    return text_of(out, size);
}

static const gtx::Vector<unsigned> quad = {0, 1, 2, 0, 2, 3};

static std::string triangles()
{
    gtx::Vector<unsigned char> out(meshopt_encodeIndexBufferBound(6, 4));
    meshopt_encodeIndexVersion(1);
    return text_of(out, meshopt_encodeIndexBuffer(out.data(), out.size(), quad.data(), 6));
}

static std::string sequence()
{
    gtx::Vector<unsigned char> out(meshopt_encodeIndexSequenceBound(6, 4));
    meshopt_encodeIndexVersion(1);
    return text_of(out, meshopt_encodeIndexSequence(out.data(), out.size(), quad.data(), 6));
}

/* A document whose two views are packed in buffer 1; buffer 0 is a fallback without bytes. */
struct Packed {
    std::string positions = vertices(square().substr(0, 48), 12), indices = triangles();
    std::string json = quoted(R"({'asset':{'version':'2.0'},
'extensionsRequired':['EXT_meshopt_compression'],'extensionsUsed':['EXT_meshopt_compression'],
'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],
'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},
{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'}],
'bufferViews':[{'buffer':0,'byteLength':48,'byteStride':12,'extensions':{'EXT_meshopt_compression':
{'buffer':1,'byteOffset':0,'byteLength':SIZE0,'byteStride':12,'count':4,'mode':'ATTRIBUTES'}}},
{'buffer':0,'byteOffset':48,'byteLength':12,'extensions':{'EXT_meshopt_compression':
{'buffer':1,'byteOffset':SIZE0,'byteLength':SIZE1,'byteStride':2,'count':6,'mode':'TRIANGLES'}}}],
'buffers':[{'byteLength':60,'extensions':{'EXT_meshopt_compression':{'fallback':true}}},
{'byteLength':SIZE2,'uri':'URI'}]})");

    void set(const std::string &from, const std::string &to) { json = change(json, from, to); }
    Imported import() const
    {
        std::string text = json, sizes[3] = {std::to_string(positions.size()),
                                             std::to_string(indices.size()),
                                             std::to_string(positions.size() + indices.size())};
        for (int k = 0; k < 3; ++k)
            for (size_t at; (at = text.find("SIZE" + std::to_string(k))) != text.npos;)
                text.replace(at, 5, sizes[k]);
        return import_data(text, positions + indices);
    }
};

static void assert_square(const Imported &i)
{
    assert_works(i, 4, 2);
    assert_position(i.mesh, 2, 1, 1, 0);
    assert_position(i.mesh, 3, 0, 1, 0);
    assert_true(std::abs(area_vector(i.mesh).z - 1) < 1e-6);
    assert_true(i.warnings.empty());
}

static void test_modes(void **)
{
    Packed p;
    assert_square(p.import());
    p.set("'byteStride':2,", "'byteStride':4,");
    p.set("'byteLength':12,'ext", "'byteLength':24,'ext");
    p.set("5123", "5125");
    assert_square(p.import());
    p.indices = sequence();
    p.set("TRIANGLES", "INDICES");
    assert_square(p.import());
    /* a fallback that names a file is not missed */
    p.set("'byteLength':60,", "'byteLength':60,'uri':'none.bin',");
    assert_square(p.import());
}

/* Positions as 24-bit mantissas with an exponent. */
static void test_exponential(void **)
{
    Packed p;
    std::string raw(48, 0);
    meshopt_encodeFilterExp(&raw[0], 4, 12, 16,
                            reinterpret_cast<const float *>(square().data()));
    p.positions = vertices(raw, 12);
    p.set("'mode':'ATTRIBUTES'", "'mode':'ATTRIBUTES','filter':'EXPONENTIAL'");
    assert_square(p.import());
}

/* Normals and colours beside the positions, in a third view of `stride`. */
static Imported with_third(const std::string &attribute, const std::string &accessor,
                           const std::string &raw, size_t stride, const char *filter)
{
    Packed p;
    const std::string third = vertices(raw, stride), size = std::to_string(third.size());
    p.set("'POSITION':0}", "'POSITION':0,'" + attribute + "':2}");
    p.set("'SCALAR'}", "'SCALAR'},{'bufferView':2," + accessor + ",'count':4}");
    p.set("'mode':'TRIANGLES'}}}",
          "'mode':'TRIANGLES'}}},{'buffer':0,'byteLength':" + std::to_string(4 * stride) +
              ",'byteStride':" + std::to_string(stride) +
              ",'extensions':{'EXT_meshopt_compression':{'buffer':1,'byteOffset':0,"
              "'byteLength':" + size + ",'byteStride':" +
              std::to_string(stride) + ",'count':4,'mode':'ATTRIBUTES','filter':'" + filter +
              "'}}}");
    p.set("'byteOffset':0,'byteLength':SIZE0", "'byteOffset':" + size + ",'byteLength':SIZE0");
    const std::string second = std::to_string(third.size() + p.positions.size());
    p.set("'byteOffset':SIZE0", "'byteOffset':" + second);
    p.set("'byteLength':SIZE1", "'byteLength':" + std::to_string(p.indices.size()));
    p.set("'byteLength':SIZE0", "'byteLength':" + std::to_string(p.positions.size()));
    p.positions = third + p.positions;
    return p.import();
}

static void test_octahedral(void **)
{
    const float n[16] = {0, 0, 1, 0, 1, 0, 0, 0, 0, -0.6f, -0.8f, 0, -0.6f, 0.8f, 0, 0};
    for (size_t stride : {size_t(4), size_t(8)}) {
        std::string raw(4 * stride, 0);
        meshopt_encodeFilterOct(&raw[0], 4, stride, stride == 4 ? 8 : 12, n);
        Imported i = with_third("NORMAL",
                                std::string(stride == 4 ? "'componentType':5120"
                                                        : "'componentType':5122") +
                                    ",'normalized':true,'type':'VEC3'",
                                raw, stride, "OCTAHEDRAL");
        assert_works(i, 4, 2);
        for (size_t c = 0; c < 6; ++c) {
            const float *expected = n + 4 * i.mesh.triangles[c / 3][c % 3];
            for (int k = 0; k < 3; ++k)
                assert_float_equal(i.mesh.normals[c][k], expected[k], 0.02);
        }
    }
}

static void test_quaternion(void **)
{
    const float q[16] = {0, 0, 0, 1, 1, 0, 0, 0, 0, 0.6f, 0, 0.8f, 0.5f, 0.5f, 0.5f, 0.5f};
    std::string raw(32, 0);
    meshopt_encodeFilterQuat(&raw[0], 4, 8, 12, q);
    Imported i = with_third("COLOR_0", "'componentType':5122,'normalized':true,'type':'VEC4'", raw,
                            8, "QUATERNION");
    assert_works(i, 4, 2);
    assert_color(i.mesh, 2, 0, 203, 0, 204); /* 0.6 of light, 0.8 */
    assert_fails(with_third("COLOR_0", "'componentType':5121,'normalized':true,'type':'VEC4'",
                            std::string(16, 0), 4, "QUATERNION"),
                 GTX_ERROR_INPUT, "buffer view 2: its meshopt filter does not suit its stride");
    assert_fails(with_third("COLOR_0", "'componentType':5121,'normalized':true,'type':'VEC4'",
                            std::string(48, 0), 12, "OCTAHEDRAL"),
                 GTX_ERROR_INPUT, "buffer view 2: its meshopt filter does not suit its stride");
}

static void test_bad(void **)
{
    static const struct {
        const char *from, *to, *message;
    } bad[] = {
        {"'ATTRIBUTES'", "'POINTS'", "buffer view 0: its meshopt mode is unknown"},
        {"'ATTRIBUTES'", "'ATTRIBUTES','filter':'BLUR'", "its meshopt filter is unknown"},
        {"'ATTRIBUTES'", "7", "is not a string"},
        {"'buffer':1,'byteOffset':0", "'buffer':2,'byteOffset':0", "meshopt buffer is not there"},
        {"'buffer':1,'byteOffset':0", "'buffer':-1,'byteOffset':0", "is not an index"},
        {"'buffer':1,'byteOffset':0", "'buffer':0,'byteOffset':0", "lies outside its buffer"},
        {"'byteOffset':0", "'byteOffset':2147483647", "lies outside its buffer"},
        {"'byteLength':SIZE1", "'byteLength':2147483647", "lies outside its buffer"},
        {"'byteLength':SIZE0", "'byteLength':3", "meshopt data is"},
        {"'byteLength':SIZE0", "'byteLength':0", "too short for its count"},
        {"'count':4,'mode'", "'count':5,'mode'", "count and stride are not those of the view"},
        {"'count':6,'mode'", "'count':0,'mode'", "count and stride are not those of the view"},
        {"'byteStride':12,'count'", "'byteStride':8,'count'", "not those of the view"},
        {"'byteStride':12,'count'", "'byteStride':0,'count'", "not those of the view"},
        {"'TRIANGLES'", "'ATTRIBUTES'", "does not suit its mode"},
        {"'ATTRIBUTES'", "'INDICES'", "does not suit its mode"},
    };
    for (const auto &b : bad) {
        Packed p;
        p.set(b.from, b.to);
        assert_fails(p.import(), GTX_ERROR_INPUT, b.message);
    }
    Packed vast; /* a few bytes that promise two gigabytes */
    vast.set("'byteLength':48,'byteStride':12", "'byteLength':2040109464,'byteStride':12");
    vast.set("'count':4,'mode'", "'count':170009122,'mode'");
    assert_fails(vast.import(), GTX_ERROR_INPUT, "too short for its count");
    Packed raw; /* a view of the fallback that is not packed */
    raw.set(R"("extensions":{'EXT_meshopt_compression':
{'buffer':1,'byteOffset':0,'byteLength':SIZE0,'byteStride':12,'count':4,'mode':'ATTRIBUTES'}}},)",
            "'name':''},");
    assert_fails(raw.import(), GTX_ERROR_INPUT, "buffer view 0 lies outside buffer 0 of 0 bytes");
}

/* The decoder takes any bytes; the indices it makes of them are checked. */
static void test_damaged(void **)
{
    Packed good;
    size_t refused = 0;
    for (std::string Packed::*bytes : {&Packed::positions, &Packed::indices})
        for (size_t at = 0; at < (good.*bytes).size(); ++at)
            for (int bit = 0; bit < 8; ++bit) {
                Packed p;
                (p.*bytes)[at] = char((p.*bytes)[at] ^ 1 << bit);
                Imported i = p.import();
                if (i.result != GTX_OK)
                    ++refused;
                else
                    assert_works(i, 4, 2);
            }
    assert_true(refused > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_modes),      cmocka_unit_test(test_exponential),
        cmocka_unit_test(test_octahedral), cmocka_unit_test(test_quaternion),
        cmocka_unit_test(test_bad),        cmocka_unit_test(test_damaged),
    };
    return cmocka_run_group_tests_name("import_meshopt", tests, nullptr, nullptr);
}
