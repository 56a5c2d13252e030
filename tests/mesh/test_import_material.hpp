/* A glTF square with a material and textures. */
#pragma once

#include "test_import_gltf.hpp"

#include "mesh/material/srgb.hpp"

using gtx::Material;
using gtx::SurfaceSample;
using gtx::Wrap;

/* The square with a material, textures, images and a set of coordinates (u = x, v = y). */
inline std::string textured(const std::string &material, const std::string &rest)
{
    std::string json = change(square_json, "'POSITION':0},'indices':1}",
                              "'POSITION':0,'TEXCOORD_0':2},'indices':1,'material':0}");
    json = change(json, "'SCALAR'}",
                  "'SCALAR'},{'bufferView':2,'componentType':5126,'count':4,'type':'VEC2'}");
    json = change(json, "'byteLength':12}",
                  "'byteLength':12},{'buffer':0,'byteOffset':60,'byteLength':32}");
    json = change(json, "'byteLength':60", "'byteLength':92");
    return change(json, "'asset'", "'materials':[" + material + "]," + rest + ",'asset'");
}

inline std::string coordinates()
{
    return packed<float>({0, 0, 1, 0, 1, 1, 0, 1});
}

inline Imported import_textured(const Folder &folder, const std::string &material,
                                const std::string &rest)
{
    std::string json = with_data(textured(material, rest), square() + coordinates());
    return import_path(folder.write("a.gltf", json));
}

inline constexpr char base_color[] = "{'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}}";

inline const Material &material(const Imported &i)
{
    assert_int_equal(i.mesh.appearance.materials.size(), 1);
    return i.mesh.appearance.materials[0];
}

inline SurfaceSample look(const Imported &i)
{
    const float weights[3] = {0.2f, 0.3f, 0.5f};
    return gtx::sample_surface(i.mesh, 0, weights, 0);
}
