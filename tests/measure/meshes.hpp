/* Meshes for the tests of the measures. */
#pragma once

#include "mesh/mesh.hpp"

namespace gtx {

/* A sphere around `centre`: a cube of n x n squares a face blown up, with normals, and the colours
 * of fixture_sphere. */
inline Mesh sphere_mesh(double radius, int n, Vec3d centre = Vec3d())
{
    Mesh mesh;
    for (int face = 0; face < 6; ++face) {
        int z = face / 2, x = (z + 1) % 3, y = (z + 2) % 3;
        double side = face & 1 ? -1 : 1;
        uint32_t first = uint32_t(mesh.positions.size()), row = uint32_t(n + 1);
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i) {
                Vec3d p; /* tangents spread the squares evenly */
                p[x] = side * std::tan((2. * i / n - 1) * std::atan(1.));
                p[y] = std::tan((2. * j / n - 1) * std::atan(1.));
                p[z] = side;
                mesh.positions.push_back(centre + normalize(p) * radius);
            }
        for (uint32_t j = 0; j < uint32_t(n); ++j)
            for (uint32_t i = 0; i < uint32_t(n); ++i) {
                uint32_t a = first + j * row + i;
                mesh.triangles.push_back({a, a + 1, a + row + 1});
                mesh.triangles.push_back({a, a + row + 1, a + row});
            }
    }
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k) {
            Vec3d unit = (mesh.position(t, k) - centre) / radius;
            mesh.normals.push_back(Vec3f(unit));
            Rgba8 c;
            c.r = uint8_t(128 + 120 * unit.x);
            c.g = uint8_t(128 + 120 * unit.y);
            c.b = uint8_t(128 + 120 * unit.z);
            mesh.colors.push_back(c);
        }
    return mesh;
}

/* n x n squares of the rectangle (0, 0) .. (width, height) at depth z, facing +z. */
inline Mesh plane_mesh(double width, double height, double z, int n)
{
    Mesh mesh;
    uint32_t row = uint32_t(n + 1);
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            mesh.positions.push_back({width * i / n, height * j / n, z});
    for (uint32_t j = 0; j < uint32_t(n); ++j)
        for (uint32_t i = 0; i < uint32_t(n); ++i) {
            uint32_t a = j * row + i;
            mesh.triangles.push_back({a, a + 1, a + row + 1});
            mesh.triangles.push_back({a, a + row + 1, a + row});
        }
    return mesh;
}

} // namespace gtx
