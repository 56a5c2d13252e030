/* What tests of cooking as a build step share: a cook with its report, and textured models. */
#pragma once

#include "common/schema.hpp"

#include "cook/folder.hpp"

/* Two pixels by two, red and blue. */
inline const unsigned char red_png[] = {
    0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 'I',  'H',  'D',
    'R',  0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd,
    0xd4, 0x9a, 0x73, 0x00, 0x00, 0x00, 0x10, 'I',  'D',  'A',  'T',  0x78, 0x9c, 0x63, 0xf8,
    0xcf, 0xc0, 0x00, 0x44, 0x0c, 0x10, 0x0a, 0x00, 0x1f, 0xee, 0x03, 0xfd, 0x8b, 0x5f, 0x14,
    0xd4, 0x00, 0x00, 0x00, 0x00, 'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};
inline const unsigned char blue_png[] = {
    0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 'I',  'H',  'D',
    'R',  0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd,
    0xd4, 0x9a, 0x73, 0x00, 0x00, 0x00, 0x0f, 'I',  'D',  'A',  'T',  0x78, 0x9c, 0x63, 0x60,
    0x60, 0xf8, 0x0f, 0x46, 0x60, 0x0a, 0x00, 0x17, 0xf6, 0x03, 0xfd, 0x7e, 0xeb, 0x37, 0xf3,
    0x00, 0x00, 0x00, 0x00, 'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};

inline std::string text_of(const unsigned char *bytes, size_t size)
{
    return {reinterpret_cast<const char *>(bytes), size};
}

struct Cooked {
    gtx_result result;
    std::string message, summary;
    schema::json json;
    std::vector<std::string> sources, warnings, names;
    bool unchanged = false;
};

inline Cooked try_cook(const std::string &input, const std::string &output,
                       const gtx_cook_desc &desc)
{
    Cooked out;
    gtx_report report = {};
    gtx_error error = {};
    out.result = gtx_cook_file(input.c_str(), output.c_str(), &desc, &report, &error);
    out.message = error.message;
    if (out.result)
        return out;
    out.json = schema::json::parse(report.json);
    out.summary = report.summary;
    out.sources.assign(report.sources, report.sources + report.source_count);
    out.warnings.assign(report.warnings, report.warnings + report.warning_count);
    out.names.assign(report.warning_names, report.warning_names + report.warning_count);
    out.unchanged = report.unchanged;
    gtx_report_free(&report);
    return out;
}

inline Cooked cook(const std::string &input, const std::string &output,
                   const gtx_cook_desc &desc = {})
{
    Cooked out = try_cook(input, output, desc);
    if (out.result)
        fail_msg("%s: %d: %s", input.c_str(), out.result, out.message.c_str());
    return out;
}

/* What META holds. */
inline schema::json meta_of(const std::string &path)
{
    gtx_asset *asset = nullptr;
    assert_int_equal(gtx_open_file(path.c_str(), nullptr, &asset, nullptr), GTX_OK);
    size_t size = 0;
    const char *text = gtx_meta(asset, &size);
    schema::json meta = schema::json::parse(std::string(text, size));
    gtx_close(asset);
    return meta;
}

/* A textured triangle of glTF, or of OBJ: files by their names in a folder. */
using Files = std::map<std::string, std::string>;

inline Files gltf_files()
{
    float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
    std::string buffer(reinterpret_cast<const char *>(numbers), sizeof numbers);
    return {{"it.gltf",
             R"({"asset": {"version": "2.0"},
                 "buffers": [{"byteLength": 60, "uri": "a%20buffer.bin"}],
                 "bufferViews": [{"buffer": 0, "byteLength": 36},
                                 {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
                 "accessors": [
                     {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                     {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
                 "images": [{"uri": "skin/color.png"}], "textures": [{"source": 0}],
                 "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
                 "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
                                             "material": 0}]}],
                 "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})"},
            {"a buffer.bin", buffer},
            {"skin/color.png", text_of(red_png, sizeof red_png)}};
}

inline Files obj_files()
{
    return {{"it.obj", "mtllib my library.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n"
                       "f 1/1 2/1 3/1\n"},
            {"my library.mtl", "newmtl m\nKd 1 1 1\nmap_Kd -s 1 1 1 color.png\n"},
            {"color.png", text_of(red_png, sizeof red_png)}};
}

inline void write_files(const std::string &name, const Files &files)
{
    fs::remove_all(in_folder(name.c_str()));
    for (const auto &[file, bytes] : files) {
        fs::path path = folder / name / file;
        fs::create_directories(path.parent_path());
        write_file(path.string(), bytes);
    }
}
