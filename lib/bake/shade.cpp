/* Normal and colour of the source at a texel. */
#include "bake/patch_maps.hpp"
#include "bake/srgb.hpp"

namespace gtx::baking {

/* Weights of a triangle's corners at a point. */
struct Weights {
    float corner[3] = {0, 0, 0};
};

static Weights inside(const FlatTriangle &t, double u, double v)
{
    Vec3d e = t.corner[1] - t.corner[0], f = t.corner[2] - t.corner[0];
    double area = e.x * f.y - e.y * f.x, du = u - t.corner[0].x, dv = v - t.corner[0].y;
    double b1 = (du * f.y - dv * f.x) / area, b2 = (e.x * dv - e.y * du) / area;
    return {{float(1 - b1 - b2), float(b1), float(b2)}};
}

Shade shade_texel(const Mesh &mesh, const FlatChart &chart, const Outline &outline,
                  const Cover &cover, int i, int j)
{
    size_t texel = size_t(j) * chart.grid.w + i;
    uint32_t triangle = cover.triangle[texel];
    Weights weights;
    if (triangle != NO_TRIANGLE) {
        weights = inside(chart.triangles[triangle], i, j);
    } else {
        const OutlineEdge &edge = outline.edges[outline.nearest[texel]];
        float at = float(nearest_parameter(edge, i, j));
        triangle = edge.triangle;
        weights.corner[edge.side] = 1 - at;
        weights.corner[(edge.side + 1) % 3] = at;
    }

    size_t source = chart.triangles[triangle].source;
    Shade shade;
    for (int k = 0; k < 3; ++k) {
        shade.normal += mesh.normals[3 * source + k] * weights.corner[k];
        if (mesh.colors.empty())
            continue;
        const Rgba8 &c = mesh.colors[3 * source + k];
        shade.color[0] += weights.corner[k] * srgb_to_linear(c.r);
        shade.color[1] += weights.corner[k] * srgb_to_linear(c.g);
        shade.color[2] += weights.corner[k] * srgb_to_linear(c.b);
        shade.color[3] += weights.corner[k] * float(c.a) / 255;
    }
    float size = length(shade.normal);
    if (size > 1e-3f)
        shade.normal *= 1 / size;
    else /* corner normals that cancel out */
        shade.normal = Vec3f(normalize(mesh.area_vector(source)));
    return shade;
}

} // namespace gtx::baking
