/* Models written to a folder of their own, and how importing them ends. */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include "mesh/mesh.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

extern "C" {
#include <cmocka.h> /* last: its fail() is a macro */
}

using gtx::Mesh;
using gtx::Rgba8;
using gtx::Task;
using gtx::Vec3d;
using gtx::Vec3f;

/* A temporary folder, removed with all it holds. */
struct Folder {
    std::filesystem::path path;
    Folder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "geotex-XXXXXX").string();
        if (!mkdtemp(name.data()))
            abort();
        path = name;
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::string write(const std::string &name, const std::string &bytes) const
    {
        std::filesystem::create_directories((path / name).parent_path());
        std::ofstream(path / name, std::ios::binary) << bytes;
        return (path / name).string();
    }
};

/* How an import ended. */
struct Imported {
    gtx_result result = GTX_OK;
    std::string message;
    Mesh mesh;
    gtx::Vector<std::string> warnings, sources;

    bool warns(const char *text) const
    {
        for (const std::string &w : warnings)
            if (w.find(text) != std::string::npos)
                return true;
        return false;
    }
};

inline Imported import_path(const std::string &path)
{
    Imported out;
    Task task(1, nullptr, nullptr);
    try {
        out.mesh = gtx::import_mesh(path, task, &out.sources);
    } catch (const gtx::Error &e) {
        out.result = e.result;
        out.message = e.message;
    }
    for (const gtx::Warning &warning : task.warnings)
        out.warnings.push_back(warning.sentence);
    return out;
}

inline Imported import_text(const char *name, const std::string &bytes)
{
    Folder folder;
    return import_path(folder.write(name, bytes));
}

/* The import fails with `result` and a message that holds `part`. */
inline void assert_fails(const Imported &imported, gtx_result result, const char *part)
{
    if (imported.result != result || imported.message.find(part) == std::string::npos)
        fail_msg("result %d: '%s', not %d: '...%s...'", imported.result, imported.message.c_str(),
                 result, part);
}

inline void assert_works(const Imported &imported, size_t vertices, size_t triangles)
{
    if (imported.result != GTX_OK)
        fail_msg("result %d: %s", imported.result, imported.message.c_str());
    const Mesh &m = imported.mesh;
    assert_int_equal(m.positions.size(), vertices);
    assert_int_equal(m.triangles.size(), triangles);
    assert_true(m.normals.empty() || m.normals.size() == 3 * triangles);
    assert_true(m.colors.empty() || m.colors.size() == 3 * triangles);
    assert_true(m.flags.empty() || m.flags.size() == triangles);
    for (const auto &t : m.triangles)
        for (uint32_t v : t)
            assert_true(v < vertices);
}

inline void assert_triangle(const Mesh &mesh, size_t t, uint32_t a, uint32_t b, uint32_t c)
{
    const auto &found = mesh.triangles[t];
    if (found != std::array<uint32_t, 3>{a, b, c})
        fail_msg("triangle %zu is %u %u %u, not %u %u %u", t, found[0], found[1], found[2], a, b,
                 c);
}

inline void assert_position(const Mesh &mesh, size_t i, double x, double y, double z)
{
    const Vec3d &p = mesh.positions[i];
    if (gtx::length(p - Vec3d(x, y, z)) > 1e-6 * (1 + std::abs(x) + std::abs(y) + std::abs(z)))
        fail_msg("position %zu is %g %g %g, not %g %g %g", i, p.x, p.y, p.z, x, y, z);
}

inline void assert_color(const Mesh &mesh, size_t corner, int r, int g, int b, int a)
{
    Rgba8 c = mesh.colors[corner];
    if (!(c == Rgba8{uint8_t(r), uint8_t(g), uint8_t(b), uint8_t(a)}))
        fail_msg("corner %zu is %d %d %d %d, not %d %d %d %d", corner, c.r, c.g, c.b, c.a, r, g, b,
                 a);
}

/* The text with its one `from` replaced. */
inline std::string edited(std::string text, const std::string &from, const std::string &to)
{
    size_t at = text.find(from);
    if (at == std::string::npos || text.find(from, at + 1) != std::string::npos)
        fail_msg("'%s' is not in the text just once", from.c_str());
    return text.replace(at, from.size(), to);
}

inline std::string base64(const std::string &bytes)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0);
        for (size_t k = 0; k < 4; ++k)
            out += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return out;
}

/* The sum of the triangles' areas and of their normals: what any cut of a polygon keeps. */
inline double area(const Mesh &mesh)
{
    double sum = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        sum += gtx::length(mesh.area_vector(t)) / 2;
    return sum;
}

inline Vec3d area_vector(const Mesh &mesh)
{
    Vec3d sum;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        sum += mesh.area_vector(t) / 2;
    return sum;
}

inline std::string models()
{
    const char *folder = std::getenv("GEOTEX_MODELS");
    return folder ? folder : "";
}
