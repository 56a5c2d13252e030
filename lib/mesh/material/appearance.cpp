/* What the materials and textures of a mesh make of a point of its surface (glTF 2.0, 3.9). */
#include "mesh/mesh.hpp"
#include "mesh/material/srgb.hpp"
#include "mesh/material/texture.hpp"

#include <algorithm>

namespace gtx {

/* ---- what is needed ---- */

static bool has_color(const Material &m)
{
    return m.color_map.used() || m.color[0] != 1 || m.color[1] != 1 || m.color[2] != 1;
}

static bool has_material(const Material &m)
{
    const Material plain;
    return m.metallic != plain.metallic || m.roughness != plain.roughness || m.unlit ||
           m.metal_rough_map.used() || m.occlusion_map.used() || m.rough_map.used() ||
           m.metal_map.used();
}

AppearanceNeeds appearance_needs(const Mesh &mesh)
{
    const Appearance &look = mesh.appearance;
    AppearanceNeeds needs;
    needs.color = !mesh.colors.empty();
    Vector<bool> used(look.materials.size(), false);
    for (uint32_t m : look.material)
        used[m] = true;
    for (size_t i = 0; i < used.size(); ++i) {
        const Material &m = look.materials[i];
        if (!used[i])
            continue;
        needs.color |= has_color(m);
        needs.material |= has_material(m);
        needs.mask |= m.alpha_cutoff > 0;
        needs.emission_scale =
            std::max({needs.emission_scale, m.emission[0], m.emission[1], m.emission[2]});
    }
    needs.emission = needs.emission_scale > 0;
    return needs;
}

/* ---- a point of a triangle ---- */

namespace {
struct Point {
    const Mesh &mesh;
    size_t triangle;
    const float *weights;
    double footprint;

    /* Coordinates in a texture: at the point and, as rows, along two edges of the triangle. */
    struct Uv {
        double at[2] = {0, 0}, edge[2][2] = {{0, 0}, {0, 0}};
        double determinant() const { return edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0]; }
    };
    Uv uv(const Texture &texture) const;
    double covered(const Texture &texture, const Uv &place) const;
    std::array<float, 4> sample(const Texture &texture, Texels kind) const;
    float number(const Texture &texture) const
    {
        return sample(texture, Texels::DATA)[texture.channel];
    }
    Vec3f normal() const;
};
} // namespace

Point::Uv Point::uv(const Texture &texture) const
{
    const float *m = texture.transform;
    const auto *corner = &mesh.appearance.uv[texture.set][3 * triangle];
    double p[3][2];
    Uv out;
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 2; ++i) {
            const float *row = m + 3 * i;
            p[k][i] = double(row[0]) * corner[k][0] + double(row[1]) * corner[k][1] + row[2];
            out.at[i] += double(weights[k]) * p[k][i];
        }
    for (int i = 0; i < 2; ++i) {
        out.edge[0][i] = p[1][i] - p[0][i];
        out.edge[1][i] = p[2][i] - p[0][i];
    }
    return out;
}

/* Twice the texels of the texture that the triangle covers. */
double Point::covered(const Texture &texture, const Uv &place) const
{
    const Image::Level &finest = mesh.appearance.images[texture.image].levels[0];
    return std::fabs(place.determinant()) * (double(finest.width) * finest.height);
}

double texture_pixels(const Mesh &mesh, size_t triangle, const Texture &texture)
{
    constexpr float middle[3] = {0, 0, 0};
    const Point point = {mesh, triangle, middle, 0};
    const double twice = point.covered(texture, point.uv(texture));
    return std::isfinite(twice) ? twice / 2 : 0;
}

/* A triangle of area A that covers B texels shows sqrt(B / A) texels along a unit. */
std::array<float, 4> Point::sample(const Texture &texture, Texels kind) const
{
    const Image &image = mesh.appearance.images[texture.image];
    const Uv place = uv(texture);
    const double covered = this->covered(texture, place);
    const double side = footprint * std::sqrt(covered / length(mesh.area_vector(triangle)));
    return sample_image(image, texture.wrap, place.at[0], place.at[1], side, kind);
}

Vec3f Point::normal() const
{
    Vec3f sum;
    for (size_t k = 0; k < 3 && !mesh.normals.empty(); ++k)
        sum += mesh.normals[3 * triangle + k] * weights[k];
    const float size = length(sum);
    if (size > 1e-3f)
        return sum * (1 / size);
    return Vec3f(normalize(mesh.area_vector(triangle))); /* normals that cancel out */
}

static std::array<float, 4> vertex_color(const Mesh &mesh, size_t triangle, const float weights[3])
{
    if (mesh.colors.empty())
        return {1, 1, 1, 1};
    std::array<float, 4> sum = {0, 0, 0, 0};
    for (size_t k = 0; k < 3; ++k) {
        const Rgba8 &c = mesh.colors[3 * triangle + k];
        sum[0] += weights[k] * srgb_to_linear(c.r);
        sum[1] += weights[k] * srgb_to_linear(c.g);
        sum[2] += weights[k] * srgb_to_linear(c.b);
        sum[3] += weights[k] * float(c.a) / 255;
    }
    return sum;
}

Interpolated interpolate(const Mesh &mesh, size_t triangle, const float weights[3])
{
    const Point point = {mesh, triangle, weights, 0};
    return {point.normal(), vertex_color(mesh, triangle, weights)};
}

/* ---- the normal texture ---- */

/* The direction in which u grows along the surface, and on which side of it v falls: 1 is that of
 * the bitangent n x t. Zero where neither the source nor the coordinates tell. */
static std::array<float, 4> tangent_at(const Point &point, const Texture &texture)
{
    const Mesh &mesh = point.mesh;
    const auto &given = mesh.appearance.tangents;
    Vec3f t;
    float side = 0;
    for (size_t k = 0; k < 3 && !given.empty(); ++k) {
        const auto &corner = given[3 * point.triangle + k];
        t += Vec3f(corner[0], corner[1], corner[2]) * point.weights[k];
        side += corner[3] * point.weights[k];
    }
    if (length(t) > 1e-3f && side != 0)
        return {t.x, t.y, t.z, side < 0 ? -1.f : 1.f};

    const Point::Uv uv = point.uv(texture);
    const double det = uv.determinant();
    if (!std::isfinite(det) || det == 0)
        return {0, 0, 0, 0};
    const Vec3d &origin = mesh.position(point.triangle, 0);
    const Vec3d e = mesh.position(point.triangle, 1) - origin;
    const Vec3d f = mesh.position(point.triangle, 2) - origin;
    const double sign = det < 0 ? -1 : 1;
    const Vec3d along_u = (e * uv.edge[1][1] - f * uv.edge[0][1]) * sign;
    const Vec3d along_v = (f * uv.edge[0][0] - e * uv.edge[1][0]) * sign;
    const Vec3d n(point.normal());
    const Vec3f unit(normalize(along_u));
    return {unit.x, unit.y, unit.z, dot(cross(n, along_u), along_v) > 0 ? -1.f : 1.f};
}

static Vec3f bent_normal(const Point &point, const Material &material, const Vec3f &n)
{
    const std::array<float, 4> tangent = tangent_at(point, material.normal_map);
    Vec3f t(tangent[0], tangent[1], tangent[2]);
    t = t - n * dot(n, t);
    if (!(length(t) > 1e-6f))
        return n;
    t = normalize(t);
    const Vec3f b = cross(n, t) * tangent[3];
    const std::array<float, 4> c = point.sample(material.normal_map, Texels::DATA);
    const float x = (2 * c[0] - 1) * material.normal_scale;
    const float y = (2 * c[1] - 1) * material.normal_scale, z = 2 * c[2] - 1;
    const Vec3f bent = t * x + b * y + n * z;
    return length(bent) > 1e-6f && is_finite(bent) ? normalize(bent) : n;
}

/* ---- the sample ---- */

static void set_color(const Point &point, const Material &m, SurfaceSample &s)
{
    for (int k = 0; k < 4; ++k)
        s.color[k] *= m.color[k];
    if (m.color_map.used()) {
        const std::array<float, 4> c = point.sample(m.color_map, Texels::COLOR);
        for (size_t k = 0; k < 4; ++k)
            s.color[k] *= c[k];
    }
    if (m.opacity_map.used())
        s.color[3] = point.number(m.opacity_map);
    if (m.alpha_cutoff >= 0)
        s.cut = s.color[3] - m.alpha_cutoff;
    s.color[3] = 1; /* what is not cut away is opaque */
}

static void set_material(const Point &point, const Material &m, SurfaceSample &s)
{
    s.metallic = m.metallic;
    s.roughness = m.roughness;
    s.lit = m.unlit ? 0.f : 1.f;
    if (m.metal_rough_map.used()) {
        const std::array<float, 4> c = point.sample(m.metal_rough_map, Texels::DATA);
        s.roughness *= c[1];
        s.metallic *= c[2];
    }
    if (m.rough_map.used())
        s.roughness *= point.number(m.rough_map);
    if (m.metal_map.used())
        s.metallic *= point.number(m.metal_map);
    if (m.occlusion_map.used())
        s.occlusion =
            1 + m.occlusion_strength * (point.sample(m.occlusion_map, Texels::DATA)[0] - 1);
}

static void set_emission(const Point &point, const Material &m, SurfaceSample &s)
{
    std::copy_n(m.emission, 3, s.emission);
    if (!m.emission_map.used())
        return;
    const std::array<float, 4> c = point.sample(m.emission_map, Texels::COLOR);
    for (size_t k = 0; k < 3; ++k)
        s.emission[k] *= c[k];
}

SurfaceSample sample_surface(const Mesh &mesh, size_t triangle, const float weights[3],
                             double footprint)
{
    return sample_surface(mesh, triangle, weights, footprint,
                          interpolate(mesh, triangle, weights));
}

SurfaceSample sample_surface(const Mesh &mesh, size_t triangle, const float weights[3],
                             double footprint, const Interpolated &corners)
{
    const Point point = {mesh, triangle, weights, footprint};
    SurfaceSample s;
    s.normal = corners.normal;
    std::copy(corners.color.begin(), corners.color.end(), s.color);
    if (mesh.appearance.material.empty())
        return s;
    const Material &m = mesh.appearance.materials[mesh.appearance.material[triangle]];
    set_color(point, m, s);
    set_material(point, m, s);
    set_emission(point, m, s);
    if (m.normal_map.used())
        s.normal = bent_normal(point, m, s.normal);
    return s;
}

} // namespace gtx
