/* An orthographic z-buffer of the mesh, sampled at pixel centres, or finer around some of them. */
#include "measure/view.hpp"

#include <algorithm>

namespace gtx {

/* Square pixels by which an edge reaches outwards: neighbours overlap instead of leaving pinholes
 * where rounding puts a pixel centre outside both. */
static const double EDGE_SLACK = 1e-9;

/* Barycentric weights at a point of the image, from pixel coordinates; false outside the triangle
 * or when it is seen edge-on. */
static bool weights_at(const Vec3d v[3], double x, double y, double weight[3])
{
    double area = (v[1].x - v[0].x) * (v[2].y - v[0].y) - (v[1].y - v[0].y) * (v[2].x - v[0].x);
    double sign = area < 0 ? -1 : 1;
    if (area == 0)
        return false;
    for (int k = 0; k < 3; ++k) {
        const Vec3d &a = v[(k + 1) % 3], &b = v[(k + 2) % 3];
        double edge = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
        if (edge * sign < -EDGE_SLACK)
            return false;
        weight[k] = std::clamp(edge / area, 0., 1.);
    }
    return true;
}

static uint32_t first_pixel(double low)
{
    return uint32_t(std::max(0., std::ceil(low - 0.5 - EDGE_SLACK)));
}

/* One past the last pixel whose centre is not beyond `high`. */
static uint32_t end_pixel(double high, uint32_t size)
{
    return uint32_t(std::clamp(std::floor(high - 0.5 + EDGE_SLACK) + 1, 0., double(size)));
}

bool is_cut(const Mesh &mesh, size_t triangle, const double weight[3], double footprint)
{
    const Appearance &look = mesh.appearance;
    if (look.material.empty() || !(look.materials[look.material[triangle]].alpha_cutoff > 0))
        return false;
    const float w[3] = {float(weight[0]), float(weight[1]), float(weight[2])};
    return sample_surface(mesh, triangle, w, footprint).cut < 0;
}

static bool is_two_sided(const Mesh &mesh, uint32_t triangle)
{
    return !mesh.flags.empty() && (mesh.flags[triangle] & TRIANGLE_TWO_SIDED);
}

static bool is_front(const Mesh &mesh, const View &view, uint32_t triangle)
{
    return is_two_sided(mesh, triangle) || dot(mesh.area_vector(triangle), view.toward) > 0;
}

static void draw(const Mesh &mesh, const View &view, const Vec3d v[3], uint32_t triangle,
                 MeshImage &image)
{
    if (view.culls && !is_front(mesh, view, triangle))
        return;
    const uint32_t size = view.size;
    auto x = std::minmax({v[0].x, v[1].x, v[2].x}), y = std::minmax({v[0].y, v[1].y, v[2].y});
    auto z = std::minmax({v[0].z, v[1].z, v[2].z});
    uint32_t end_x = end_pixel(x.second, size), end_y = end_pixel(y.second, size);
    for (uint32_t j = first_pixel(y.first); j < end_y; ++j) {
        cancel_point(end_x);
        for (uint32_t i = first_pixel(x.first); i < end_x; ++i) {
            double w[3];
            if (!weights_at(v, i + 0.5, j + 0.5, w))
                continue;
            double depth = w[0] * v[0].z + w[1] * v[1].z + w[2] * v[2].z;
            float nearest = float(std::clamp(depth, z.first, z.second));
            size_t at = size_t(j) * size + i;
            if (nearest < image.depth[at] && !is_cut(mesh, triangle, w, view.pixel)) {
                image.depth[at] = nearest;
                image.triangle[at] = triangle;
            }
        }
    }
}

static MeshImage blank_image(uint32_t size)
{
    const size_t pixels = size_t(size) * size;
    MeshImage image;
    image.depth.assign(pixels, std::numeric_limits<float>::infinity());
    image.triangle.assign(pixels, NO_HIT);
    image.front.assign(pixels, 0);
    return image;
}

static void find_fronts(const Mesh &mesh, const View &view, MeshImage &image)
{
    for (size_t at = 0; at < image.triangle.size(); ++at) {
        uint32_t t = image.triangle[at];
        if (t != NO_HIT)
            image.front[at] = is_front(mesh, view, t);
    }
}

static Vector<Vec3d> project(const Mesh &mesh, const View &view)
{
    Vector<Vec3d> projected(mesh.positions.size());
    for (size_t i = 0; i < projected.size(); ++i)
        projected[i] = view.project(mesh.positions[i]);
    return projected;
}

MeshImage rasterise(const Mesh &mesh, const View &view)
{
    MeshImage image = blank_image(view.size);
    const Vector<Vec3d> projected = project(mesh, view);
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        Vec3d v[3];
        for (int k = 0; k < 3; ++k)
            v[k] = projected[mesh.triangles[t][k]];
        draw(mesh, view, v, uint32_t(t), image);
    }
    find_fronts(mesh, view, image);
    return image;
}

View close_view(const View &view, uint32_t i, uint32_t j)
{
    View close = view;
    close.middle = view.at(i, j);
    close.size = CLOSE_SIDE;
    close.pixel = view.pixel / CLOSER;
    return close;
}

Vector<MeshImage> rasterise_close(const Mesh &mesh, const View &view,
                                  const Vector<ClosePixel> &pixels)
{
    const View close = close_view(view, 0, 0); /* triangles are moved to each */
    /* Which of the pixels one is, NO_HIT for none. */
    Vector<uint32_t> which(size_t(view.size) * view.size, NO_HIT);
    uint32_t first_row = view.size, end_row = 0;
    for (size_t k = 0; k < pixels.size(); ++k) {
        which[size_t(pixels[k].j) * view.size + pixels[k].i] = uint32_t(k);
        first_row = std::min(first_row, pixels[k].j);
        end_row = std::max(end_row, pixels[k].j + 1);
    }

    Vector<MeshImage> images(pixels.size(), blank_image(CLOSE_SIDE));
    const Vector<Vec3d> projected = project(mesh, view);
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        Vec3d v[3], near[3];
        for (int k = 0; k < 3; ++k)
            v[k] = projected[mesh.triangles[t][k]];
        const auto x = std::minmax({v[0].x, v[1].x, v[2].x});
        const auto y = std::minmax({v[0].y, v[1].y, v[2].y});
        const double nearest = double(float(std::min({v[0].z, v[1].z, v[2].z})));
        const uint32_t end_x = end_pixel(x.second + 1, view.size);
        const uint32_t end_y = std::min(end_pixel(y.second + 1, view.size), end_row);
        for (uint32_t j = std::max(first_pixel(y.first - 1), first_row); j < end_y; ++j)
            for (uint32_t i = first_pixel(x.first - 1); i < end_x; ++i) {
                const uint32_t at = which[size_t(j) * view.size + i];
                if (at == NO_HIT || nearest > pixels[at].deepest)
                    continue;
                for (int k = 0; k < 3; ++k)
                    near[k] = {(v[k].x - i - 0.5) * CLOSER + 0.5 * CLOSE_SIDE,
                               (v[k].y - j - 0.5) * CLOSER + 0.5 * CLOSE_SIDE, v[k].z};
                draw(mesh, close, near, uint32_t(t), images[at]);
            }
    }
    for (MeshImage &image : images)
        find_fronts(mesh, close, image);
    return images;
}

/* Attributes of the corners, as they are. */
static Fragment corner_fragment(const Mesh &mesh, uint32_t t, const double w[3])
{
    Fragment fragment = {Vec3d(), {0, 0, 0}};
    for (int k = 0; k < 3; ++k) {
        Rgba8 c = mesh.colors.empty() ? Rgba8() : mesh.colors[3 * t + k];
        const double rgb[3] = {double(c.r), double(c.g), double(c.b)};
        for (int a = 0; a < 3; ++a)
            fragment.color[a] += w[k] * rgb[a];
        if (!mesh.normals.empty())
            fragment.normal += Vec3d(mesh.normals[3 * t + k]) * w[k];
    }
    fragment.normal = normalize(mesh.normals.empty() ? mesh.area_vector(t) : fragment.normal);
    return fragment;
}

/* IEC 61966-2-1, not rounded to a code. */
static double srgb(double light)
{
    light = std::clamp(light, 0., 1.);
    return 255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

static Fragment material_fragment(const Mesh &mesh, uint32_t t, const double w[3], double footprint)
{
    const float weights[3] = {float(w[0]), float(w[1]), float(w[2])};
    const SurfaceSample sample = sample_surface(mesh, t, weights, footprint);
    return {normalize(Vec3d(sample.normal)),
            {srgb(sample.color[0]), srgb(sample.color[1]), srgb(sample.color[2])}};
}

Fragment fragment_at(const Mesh &mesh, const View &view, const MeshImage &image, uint32_t i,
                     uint32_t j)
{
    uint32_t t = image.triangle[size_t(j) * view.size + i];
    Vec3d v[3];
    double w[3] = {1. / 3, 1. / 3, 1. / 3};
    for (int k = 0; k < 3; ++k)
        v[k] = view.project(mesh.position(t, k));
    weights_at(v, i + 0.5, j + 0.5, w);

    Fragment fragment = mesh.appearance.material.empty()
                            ? corner_fragment(mesh, t, w)
                            : material_fragment(mesh, t, w, view.pixel);
    if (is_two_sided(mesh, t) && dot(mesh.area_vector(t), view.toward) < 0)
        fragment.normal = -fragment.normal;
    return fragment;
}

} // namespace gtx
