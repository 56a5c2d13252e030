/* glTF documents written by hand: a square, to be changed here and there. */
#pragma once

#include "test_import.hpp"

#include "image/image.h"

template <class T> inline std::string packed(std::initializer_list<T> values)
{
    return std::string(reinterpret_cast<const char *>(values.begin()), values.size() * sizeof(T));
}

/* JSON with its quotes written '. */
inline std::string quoted(std::string text)
{
    std::replace(text.begin(), text.end(), '\'', '"');
    return text;
}

inline std::string change(const std::string &json, const std::string &from, const std::string &to)
{
    return edited(json, quoted(from), quoted(to));
}

/* The unit square as four vertices and six indices: 48 + 12 bytes. */
inline std::string square()
{
    return packed<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) +
           packed<uint16_t>({0, 1, 2, 0, 2, 3});
}

inline const std::string square_json =
    quoted(R"({'asset':{'version':'2.0'},'scene':0,'scenes':[{'nodes':[0]}],
'nodes':[{'mesh':0}],
'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],
'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},
{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'}],
'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12}],
'buffers':[{'byteLength':60,'uri':'URI'}]})");

inline std::string with_data(const std::string &json, const std::string &bytes)
{
    return change(json, "'URI'", "'data:application/octet-stream;base64," + base64(bytes) + "'");
}

inline Imported import_data(const std::string &json, const std::string &bytes)
{
    return import_text("a.gltf", with_data(json, bytes));
}

/* The square with one change. */
inline Imported import_changed(const char *from, const std::string &to)
{
    return import_data(change(square_json, from, to), square());
}

/* The colour at the first corner of triangle t. */
inline void assert_sample(const Mesh &mesh, size_t t, std::array<double, 4> color)
{
    const float weights[3] = {1, 0, 0};
    gtx::SurfaceSample s = gtx::sample_surface(mesh, t, weights, 0);
    for (size_t k = 0; k < 4; ++k)
        assert_float_equal(s.color[k], color[k], 0.005);
}

/* A PNG of width x height texels, each `color`. */
inline std::string png(const Folder &folder, uint32_t width, uint32_t height, Rgba8 color)
{
    gtx::Vector<Rgba8> pixels(size_t(width) * height, color);
    const std::string path = folder.write("made.png", "");
    gtx_error error = {};
    if (gtx_image_write_png(path.c_str(), width, height, 4, &pixels[0].r, &error))
        fail_msg("%s", error.message);
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
}
