/* Tangent-space normals for glTF: the asset's normals in the tangent frames of a mesh's vertices.
 * */
#include "export/export.hpp"

#include "asset/patch.h"

#include <algorithm>

namespace gtx {

/* Texels beside a triangle are looked up too, as neighbours of those under it. */
constexpr double REACH = 1;

static uint8_t unorm(double v)
{
    return uint8_t(std::clamp(std::floor((v * 0.5 + 0.5) * 255 + 0.5), 0., 255.));
}

/* The solution of a x + b y + c z = v, to scale. */
static Vec3d solved(const Vec3d &a, const Vec3d &b, const Vec3d &c, const Vec3d &v)
{
    const Vec3d bc = cross(b, c);
    const Vec3d x(dot(v, bc), dot(v, cross(c, a)), dot(v, cross(a, b)));
    return dot(a, bc) < 0 ? -x : x;
}

namespace {

/* The rectangle of one patch at a level. */
struct PatchNormals {
    const gtx_patch &patch;
    uint32_t width, height;
    Vector<Vec3d> normal;          /* of the texels, object space */
    Vector<double> outside;        /* of the triangle that a texel's normal is for, in texels */
    Vector<std::array<uint8_t, 3>> coded;

    PatchNormals(const gtx_asset *asset, uint32_t number, unsigned level);
    void draw(const ExportVertex *const corner[3], double scale);
    void put(PageImages &out, unsigned level);

private:
    std::array<uint8_t, 3> code(const ExportVertex *const corner[3], const double weights[3],
                                const Vec3d &n) const;
};

} // namespace

PatchNormals::PatchNormals(const gtx_asset *asset, uint32_t number, unsigned level)
    : patch(gtx_patches(asset)[number]), width(patch.rect[2] >> level),
      height(patch.rect[3] >> level)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    const auto *map = static_cast<const uint8_t *>(
        gtx_map_data(asset, GTX_MAP_NORMAL, level, nullptr));
    const size_t page_width = info.page_width >> level, page_height = info.page_height >> level;
    float rows[3][3];
    gtx_normal_frame(&patch, rows);
    const Vector<uint32_t> nearest = nearest_texels(asset, number, level);
    const Vec3d z(rows[2][0], rows[2][1], rows[2][2]);
    normal.assign(size_t(width) * height, z);
    for (size_t i = 0; i < nearest.size(); ++i) {
        const size_t x = (patch.rect[0] >> level) + nearest[i] % width;
        const size_t y = (patch.rect[1] >> level) + nearest[i] / width;
        float n[3];
        gtx_decode_normal(map + 2 * ((patch.page * page_height + y) * page_width + x), n);
        for (int k = 0; k < 3; ++k)
            normal[i][k] = double(n[0] * rows[0][k]) + double(n[1] * rows[1][k]) +
                           double(n[2] * rows[2][k]);
    }
    outside.assign(normal.size(), INFINITY);
    coded.resize(normal.size());
}

std::array<uint8_t, 3> PatchNormals::code(const ExportVertex *const corner[3],
                                          const double weights[3], const Vec3d &n) const
{
    Vec3d t, b, z;
    for (int k = 0; k < 3; ++k) {
        const Vec3d up(corner[k]->normal), along(corner[k]->tangent);
        z += up * weights[k];
        t += along * weights[k];
        b += cross(up, along) * (double(BITANGENT_SIGN) * weights[k]);
    }
    Vec3d m = solved(normalize(t), normalize(b), normalize(z), n);
    m.z = std::max(m.z, 0.); /* behind the vertex normals there are none */
    m = normalize(m);
    if (m == Vec3d())
        m = {0, 0, 1};
    return {unorm(m.x), unorm(m.y), std::max(unorm(m.z), uint8_t(128))};
}

void PatchNormals::draw(const ExportVertex *const corner[3], double scale)
{
    double at[3][2], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 2; ++i) {
            at[k][i] = (double(corner[k]->texel[i]) - patch.rect[i]) * scale - 0.5;
            low[i] = std::min(low[i], at[k][i]);
            high[i] = std::max(high[i], at[k][i]);
        }
    const double area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
                        (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
    if (area == 0)
        return;
    const int64_t sides[2] = {width, height};
    int64_t from[2], to[2];
    for (int i = 0; i < 2; ++i) {
        from[i] = std::max<int64_t>(0, int64_t(std::ceil(low[i] - REACH)));
        to[i] = std::min<int64_t>(sides[i] - 1, int64_t(std::floor(high[i] + REACH)));
    }
    for (int64_t y = from[1]; y <= to[1]; ++y)
        for (int64_t x = from[0]; x <= to[0]; ++x) {
            double weights[3], sum = 0, far = 0;
            for (int k = 0; k < 3; ++k) {
                const double *a = at[(k + 1) % 3], *b = at[(k + 2) % 3];
                const double ux = b[0] - a[0], uy = b[1] - a[1];
                const double twice = ux * (double(y) - a[1]) - uy * (double(x) - a[0]);
                weights[k] = twice / area;
                far = std::max(far, weights[k] < 0 ? std::abs(twice) / std::sqrt(ux * ux + uy * uy)
                                                   : 0.);
                weights[k] = std::max(weights[k], 0.);
                sum += weights[k];
            }
            const size_t i = size_t(y) * width + size_t(x);
            if (!(far <= REACH) || far >= outside[i])
                continue;
            for (double &w : weights)
                w /= sum;
            outside[i] = far;
            coded[i] = code(corner, weights, normal[i]);
        }
}

void PatchNormals::put(PageImages &out, unsigned level)
{
    Vector<uint8_t> drawn;
    for (double d : outside)
        drawn.push_back(d <= REACH);
    const Vector<uint32_t> nearest = nearest_of(drawn, width, height);
    for (size_t i = 0; i < nearest.size(); ++i)
        std::copy_n(coded[nearest[i]].data(), 3,
                    out.texel(patch.page, (patch.rect[0] >> level) + uint32_t(i % width),
                              (patch.rect[1] >> level) + uint32_t(i / width)));
}

PageImages tangent_normals(const gtx_asset *asset, const ExportMesh &mesh, unsigned level,
                           Task &task)
{
    gtx_info info;
    gtx_get_info(asset, &info);
    PageImages out(info, level, {128, 128, 255});
    task.parallel(mesh.parts.size(), [&](size_t i) {
        const ExportPart &part = mesh.parts[i];
        PatchNormals normals(asset, part.patch, level);
        for (uint32_t t = 0; t < part.triangles; ++t) {
            const ExportVertex *corner[3];
            for (size_t k = 0; k < 3; ++k)
                corner[k] = &mesh.vertices[mesh.triangles[part.first_triangle + t][k]];
            normals.draw(corner, 1. / double(1u << level));
            cancel_point();
        }
        normals.put(out, level);
    });
    return out;
}

} // namespace gtx
