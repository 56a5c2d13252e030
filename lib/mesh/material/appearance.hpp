/* Materials and textures of a mesh, and what they make of a point of it (glTF 2.0, 3.9). */
#pragma once

#include "mesh/memory.hpp"
#include "mesh/vec.hpp"

#include <array>
#include <cstdint>
#include <string>

namespace gtx {

struct Mesh;

struct Rgba8 {
    uint8_t r = 255, g = 255, b = 255, a = 255; /* sRGB colour, linear alpha */
    bool operator==(const Rgba8 &o) const { return r == o.r && g == o.g && b == o.b && a == o.a; }
};

/* A decoded image, rows from the top, with a smaller one for every halving. */
struct Image {
    struct Level {
        uint32_t width = 0, height = 0;
        Vector<Rgba8> texels;
    };
    Vector<Level> levels;
};

enum class Wrap : uint8_t { REPEAT, MIRROR, CLAMP };

/* How a material looks into an image. */
struct Texture {
    static constexpr uint32_t NONE = 0xffffffffu;
    uint32_t image = NONE;
    uint8_t set = 0;                           /* texture coordinates 0 or 1 */
    uint8_t channel = 0;                       /* of maps that hold one number */
    Wrap wrap[2] = {Wrap::REPEAT, Wrap::REPEAT};
    float transform[6] = {1, 0, 0, 0, 1, 0};   /* u' = t0 u + t1 v + t2, v' = t3 u + t4 v + t5 */
    bool used() const { return image != NONE; }
};

struct Material {
    float color[4] = {1, 1, 1, 1};             /* factors, linear */
    float emission[3] = {0, 0, 0};
    float metallic = 0, roughness = 1, normal_scale = 1, occlusion_strength = 1;
    float alpha_cutoff = -1;                   /* below it nothing is there; < 0: opaque */
    bool unlit = false;
    Texture color_map, normal_map, metal_rough_map, occlusion_map, emission_map;
    Texture rough_map, metal_map, opacity_map; /* one number each; as alpha the last one decides */
};

/* All textures of a material. */
constexpr Texture Material::*MATERIAL_TEXTURES[] = {
    &Material::color_map, &Material::normal_map, &Material::metal_rough_map,
    &Material::occlusion_map, &Material::emission_map, &Material::rough_map,
    &Material::metal_map, &Material::opacity_map};

/* Per corner like the other attributes of a mesh, or empty. */
struct Appearance {
    Vector<Material> materials;
    Vector<Image> images;
    Vector<uint32_t> material;                     /* per triangle; empty: none has any */
    Vector<std::array<float, 2>> uv[2];            /* per corner */
    Vector<std::array<float, 4>> tangents;         /* per corner: unit, and the bitangent's sign */
};

/* What the maps of a mesh have to hold. */
struct AppearanceNeeds {
    bool color = false, material = false, emission = false, mask = false;
    float emission_scale = 0;                      /* of the strongest emission; 0 without */
};
AppearanceNeeds appearance_needs(const Mesh &mesh);

/* What is seen at a point of a triangle; colours are linear. */
struct SurfaceSample {
    Vec3f normal;                                  /* unit, object space, normal texture applied */
    float color[4] = {1, 1, 1, 1};                 /* vertex colour x factor x texture; alpha */
    float emission[3] = {0, 0, 0};
    float occlusion = 1, roughness = 1, metallic = 0, lit = 1;
    float cut = 1;                                 /* alpha less its cutoff; < 0: nothing there */
};

/* Pixels of a texture's image that a triangle covers. */
double texture_pixels(const Mesh &mesh, size_t triangle, const Texture &texture);

/* What the corners of a triangle make of a point between them. */
struct Interpolated {
    Vec3f normal;                                  /* unit, object space */
    std::array<float, 4> color = {1, 1, 1, 1};     /* linear */
};
Interpolated interpolate(const Mesh &mesh, size_t triangle, const float weights[3]);

/* `weights` are barycentric; `footprint` is the side, in object units, of the square that the
 * sample stands for: it chooses the textures' mip level. */
SurfaceSample sample_surface(const Mesh &mesh, size_t triangle, const float weights[3],
                             double footprint);
/* The same where somebody else, a GPU say, has interpolated the corners. */
SurfaceSample sample_surface(const Mesh &mesh, size_t triangle, const float weights[3],
                             double footprint, const Interpolated &corners);

} // namespace gtx
