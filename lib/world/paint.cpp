/* A tile's surface with its textures, and their colours averaged at its vertices. */
#include "world/materials.hpp"

#include "mesh/material/srgb.hpp"

#include <cmath>

namespace gtx {

Mesh textured_mesh(const Plan &plan, const TileSurface &s, Task &task)
{
    Mesh mesh = mesh_of(s);
    Appearance &look = mesh.appearance = read_appearance(plan, s, task);
    const uint32_t plain = uint32_t(look.materials.size() - 1);
    bool bent = false, set[2] = {false, false};
    for (const Material &m : look.materials)
        for (Texture Material::*map : MATERIAL_TEXTURES)
            if ((m.*map).used()) {
                set[(m.*map).set] = true;
                bent |= map == &Material::normal_map;
            }
    for (const auto &t : s.triangles) {
        const uint32_t material = s.looks[t[0]].material;
        look.material.push_back(material == CornerLook::NO_MATERIAL ? plain : material);
        for (uint32_t v : t) {
            const CornerLook &corner = s.looks[v];
            for (size_t k = 0; k < 2; ++k)
                if (set[k])
                    look.uv[k].push_back({corner.uv[k][0], corner.uv[k][1]});
            if (bent)
                look.tangents.push_back({corner.tangent[0], corner.tangent[1], corner.tangent[2],
                                         corner.tangent[3]});
        }
    }
    return mesh;
}

static Rgba8 color_at(const Mesh &mesh, size_t triangle, const float weights[3], double footprint)
{
    const SurfaceSample seen = sample_surface(mesh, triangle, weights, footprint);
    auto alpha = [](float x) { return uint8_t(x > 0 ? x < 1 ? x * 255 + 0.5f : 255 : 0); };
    return {linear_to_srgb(seen.color[0]), linear_to_srgb(seen.color[1]),
            linear_to_srgb(seen.color[2]), alpha(seen.color[3])};
}

void paint_surface(const Mesh &mesh, TileSurface &s, Task &task)
{
    s.seen.assign(s.triangles.size(), {});
    Vector<Rgba8> colors = s.colors;
    for (size_t t = 0; t < s.triangles.size(); ++t) {
        const double area = length(mesh.area_vector(t)) / 2;
        if (t % 0x1000 == 0)
            task.advance(double(t) / double(s.triangles.size()));
        if (!(area > 0) || !std::isfinite(area))
            continue;
        constexpr float middle[3] = {1 / 3.f, 1 / 3.f, 1 / 3.f};
        s.seen[t] = color_at(mesh, t, middle, std::sqrt(area));
        for (size_t k = 0; k < 3; ++k) { /* a little inside: other things lie beside */
            float weights[3] = {0.1f, 0.1f, 0.1f};
            weights[k] = 0.8f;
            colors[s.triangles[t][k]] = color_at(mesh, t, weights, std::sqrt(area) / 2);
        }
    }
    s.colors.swap(colors);
}

} // namespace gtx
