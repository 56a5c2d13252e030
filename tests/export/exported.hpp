/* What the tests of exports share: assets to export, and the GLB taken apart. */
#pragma once

#include <geotex/export.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

using nlohmann::json;

/* A closed bumpy sphere, its hue following the place where it is coloured. */
inline std::string sphere_obj(unsigned n, bool colored)
{
    const double pi = std::acos(-1);
    const unsigned columns = 2 * n;
    std::string out;
    auto vertex = [&](double x, double y, double z) {
        char line[160];
        if (colored)
            snprintf(line, sizeof line, "v %.9g %.9g %.9g %.4f %.4f %.4f\n", x, y, z,
                     0.5 + 0.4 * x, 0.5 + 0.4 * y, 0.5 + 0.4 * z);
        else
            snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", x, y, z);
        out += line;
    };
    vertex(0, 1, 0);
    vertex(0, -1, 0);
    for (unsigned i = 1; i < n; ++i)
        for (unsigned j = 0; j < columns; ++j) {
            const double a = pi * i / n, b = 2 * pi * j / columns;
            const double x = std::sin(a) * std::cos(b), z = std::sin(a) * std::sin(b);
            const double y = std::cos(a);
            const double r = 1 + 0.02 * std::sin(13 * x) * std::cos(11 * y);
            vertex(r * x, r * y, r * z);
        }
    auto face = [&](unsigned a, unsigned b, unsigned c) {
        out += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
    };
    for (unsigned j = 0; j < columns; ++j) {
        const unsigned k = (j + 1) % columns, last = 3 + (n - 2) * columns;
        face(1, 3 + k, 3 + j);
        face(2, last + j, last + k);
        for (unsigned i = 0; i + 2 < n; ++i) {
            const unsigned a = 3 + i * columns, b = a + columns;
            face(a + j, a + k, b + k);
            face(a + j, b + k, b + j);
        }
    }
    return out;
}

inline std::string encoded(const gtx_asset *asset)
{
    void *data = nullptr;
    size_t size = 0;
    assert_int_equal(gtx_encode(asset, nullptr, &data, &size, nullptr), GTX_OK);
    const std::string out(static_cast<char *>(data), size);
    std::free(data);
    return out;
}

/* The bytes of a .gtx file. */
inline std::string cooked(const std::string &model, const char *name, gtx_cook_desc desc = {})
{
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    if (gtx_cook_memory(model.data(), model.size(), name, &desc, &asset, nullptr, &error))
        fail_msg("%s: %s", name, error.message);
    const std::string out = encoded(asset);
    gtx_close(asset);
    return out;
}

inline std::string cooked_sphere(bool colored = true, gtx_cook_desc desc = {})
{
    return cooked(sphere_obj(60, colored), "sphere.obj", desc);
}

inline gtx_result try_export(const std::string &asset, const gtx_export_desc &desc,
                             std::string &out, gtx_error *error = nullptr)
{
    void *data = nullptr;
    size_t size = 0;
    gtx_report report = {};
    gtx_error ignored;
    const gtx_result result = gtx_export_memory(asset.data(), asset.size(), &desc, &data, &size,
                                                &report, error ? error : &ignored);
    if (result)
        return result;
    out.assign(static_cast<char *>(data), size);
    std::free(data);
    gtx_report_free(&report);
    return GTX_OK;
}

inline std::string exported(const std::string &asset, const gtx_export_desc &desc = {})
{
    std::string out;
    gtx_error error = {};
    if (try_export(asset, desc, out, &error))
        fail_msg("%s", error.message);
    return out;
}

/* A GLB as its own JSON and buffer say. */
struct Glb {
    json root;
    std::string binary;

    explicit Glb(const std::string &bytes)
    {
        assert_true(bytes.size() > 28 && bytes.compare(0, 4, "glTF") == 0);
        assert_int_equal(word(bytes, 8), bytes.size());
        const size_t length = word(bytes, 12);
        root = json::parse(bytes.substr(20, length));
        binary = bytes.substr(28 + length);
        assert_int_equal(word(bytes, 20 + length), binary.size());
    }
    static uint32_t word(const std::string &bytes, size_t at)
    {
        uint32_t out;
        std::memcpy(&out, &bytes[at], 4);
        return out;
    }
    std::string view(size_t number) const
    {
        const json &v = root["bufferViews"][number];
        return binary.substr(v.value("byteOffset", size_t(0)), v["byteLength"].get<size_t>());
    }
    /* Numbers of a float accessor. */
    std::vector<float> floats(size_t number) const
    {
        const json &a = root["accessors"][number], &v = root["bufferViews"][a["bufferView"]
                                                                                .get<size_t>()];
        assert_int_equal(a["componentType"].get<int>(), 5126);
        const size_t width = a["type"] == "VEC2" ? 2 : a["type"] == "VEC3" ? 3 : 4;
        const size_t stride = v.value("byteStride", 4 * width), count = a["count"];
        const std::string bytes = view(a["bufferView"]);
        std::vector<float> out(count * width);
        for (size_t i = 0; i < count; ++i) {
            const size_t at = a.value("byteOffset", size_t(0)) + i * stride;
            assert_true(at + 4 * width <= bytes.size());
            std::memcpy(&out[i * width], &bytes[at], 4 * width);
        }
        return out;
    }
    std::vector<uint32_t> indices(const json &primitive) const
    {
        const json &a = root["accessors"][primitive["indices"].get<size_t>()];
        assert_int_equal(a["componentType"].get<int>(), 5125);
        std::vector<uint32_t> out(a["count"].get<size_t>());
        const std::string bytes = view(a["bufferView"]);
        assert_int_equal(bytes.size(), 4 * out.size());
        std::memcpy(out.data(), bytes.data(), bytes.size());
        return out;
    }
    /* The bytes of the image that a texture shows. */
    std::string image(const json &texture) const
    {
        const size_t source = root["textures"][texture["index"].get<size_t>()]["source"];
        return view(root["images"][source]["bufferView"]);
    }
};
