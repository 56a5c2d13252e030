/* What the source looks like at the texels of a patch. */
#include "bake/field/shade.hpp"

#include <algorithm>

namespace gtx::baking {

Vec3d weights_at(const FlatTriangle &triangle, double u, double v)
{
    constexpr double INSIDE = -1e-6; /* numerical guard: the rounding of these very weights */
    const Vec3d *p = triangle.corner;
    Vec3d e = p[1] - p[0], f = p[2] - p[0];
    double area = triangle.signed_area(), du = u - p[0].x, dv = v - p[0].y;
    double b1 = (du * f.y - dv * f.x) / area, b2 = (e.x * dv - e.y * du) / area;
    Vec3d weight(1 - b1 - b2, b1, b2);
    if (std::min({weight.x, weight.y, weight.z}) >= INSIDE)
        return weight;
    for (int k = 0; k < 3; ++k)
        weight[k] = std::max(weight[k], 0.);
    return weight / (weight.x + weight.y + weight.z);
}

SurfacePoint surface_point(const FlatChart &chart, const Outline &outline, const Cover &cover,
                           size_t texel)
{
    double u = double(texel % chart.grid.w), v = double(texel / chart.grid.w);
    SurfacePoint point = {cover.triangle[texel]};
    if (point.triangle == NO_TRIANGLE) {
        const OutlineEdge &edge = outline.edges[outline.nearest[texel]];
        float at = float(nearest_parameter(edge, u, v));
        point.triangle = edge.triangle;
        point.weight[edge.side] = 1 - at;
        point.weight[(edge.side + 1) % 3] = at;
        return point;
    }
    const Vec3d weight = weights_at(chart.triangles[point.triangle], u, v);
    for (int k = 0; k < 3; ++k)
        point.weight[k] = float(weight[k]);
    return point;
}

/* What the GPU has interpolated where its triangle is still the one that covers the texel, else
 * what the corners give here. */
static Interpolated interpolated_at(const Job &job, const ChartField &field,
                                    const SurfacePoint &point, size_t texel)
{
    Interpolated corners =
        interpolate(job.mesh, field.flat.triangles[point.triangle].source, point.weight);
    const Rendering &drawn = field.rendering;
    if (drawn.triangle.empty() || drawn.triangle[texel] == NO_TRIANGLE ||
        drawn.triangle[texel] != field.cover.triangle[texel])
        return corners;
    if (dot(drawn.normal[texel], drawn.normal[texel]) > 0)
        corners.normal = drawn.normal[texel];
    corners.color = drawn.color[texel];
    return corners;
}

static void store(const SurfaceSample &sample, const AppearanceNeeds &needs, Shades &shades,
                  size_t at)
{
    const float material[] = {sample.occlusion, sample.roughness, sample.metallic, sample.lit};
    shades.normal[at] = sample.normal;
    float *out = shades.values.data() + at * shades.channels;
    if (needs.color)
        out = std::copy_n(sample.color, COLOR_CHANNELS, out);
    if (needs.material)
        out = std::copy_n(material, MATERIAL_CHANNELS, out);
    if (needs.emission)
        std::copy_n(sample.emission, EMISSION_CHANNELS, out);
}

Shades shade_texels(const Job &job, const ChartField &field, const Crop &crop,
                    const Vector<uint16_t> &height)
{
    /* A texel with a code is at most so far from what is shown: a fact of the support. */
    constexpr unsigned MARGIN = 2;
    const FlatChart &chart = field.flat;
    const AppearanceNeeds &needs = job.needs;
    const double side = std::sqrt(chart.grid.pitch[0] * chart.grid.pitch[1]);
    Shades shades(crop.w, crop.h, COLOR_CHANNELS * needs.color +
                                      MATERIAL_CHANNELS * needs.material +
                                      EMISSION_CHANNELS * needs.emission);
    bool masked = false;
    for (size_t at = 0; at < height.size(); ++at) {
        if (!height[at])
            continue;
        size_t row = size_t(crop.y + int(at) / crop.w);
        size_t texel = row * size_t(chart.grid.w) + size_t(crop.x + int(at) % crop.w);
        SurfacePoint point = surface_point(chart, field.outline, field.cover, texel);
        SurfaceSample sample = sample_surface(job.mesh, chart.triangles[point.triangle].source,
                                              point.weight, side,
                                              interpolated_at(job, field, point, texel));
        store(sample, needs, shades, at);
        shades.occupied[at] = !(sample.cut < 0);
        masked |= sample.cut < 0;
    }
    /* What is cut away often has a colour that nobody was to see: beyond the mask the surface
     * beside it goes on. */
    if (masked)
        dilate(shades, MARGIN);
    for (size_t at = 0; masked && at < height.size(); ++at)
        shades.occupied[at] = height[at] != 0;
    return shades;
}

} // namespace gtx::baking
