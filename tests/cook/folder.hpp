/* A folder of its own for each test program, with two bumpy balls in it. */
#pragma once

#include "bake/shapes.hpp"
#include "common/folder.hpp"

#include <geotex/cook.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <set>
#include <string>

/* Last, for its macros take names that the standard library uses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

inline void write_file(const std::string &path, const std::string &text)
{
    std::ofstream(path, std::ios::binary) << text;
}

inline std::string read_file(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline std::string obj_text(const gtx::Mesh &mesh)
{
    std::string text;
    char line[120];
    for (const gtx::Vec3d &p : mesh.positions)
        text.append(line, size_t(snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", p.x, p.y, p.z)));
    for (const auto &t : mesh.triangles)
        text.append(line, size_t(snprintf(line, sizeof line, "f %u %u %u\n", t[0] + 1, t[1] + 1,
                                          t[2] + 1)));
    return text;
}

inline std::string ball_file()
{
    std::string path = in_folder("ball.obj");
    if (!fs::exists(path))
        write_file(path, obj_text(shapes::ball(24, shapes::bumps)));
    return path;
}

/* Cooks in a moment, for what is done many times. */
inline std::string small_ball_file()
{
    std::string path = in_folder("small.obj");
    if (!fs::exists(path))
        write_file(path, obj_text(shapes::ball(8, shapes::bumps)));
    return path;
}

inline size_t files_in_folder()
{
    return size_t(std::distance(fs::directory_iterator(folder), {}));
}

inline int make_ball_folder(void **state)
{
    if (make_folder(state))
        return -1;
    ball_file();
    small_ball_file();
    return 0;
}

/* Cooks the ball, or fails the test. */
inline void cook_ball(const std::string &output, const gtx_cook_desc &desc,
                      gtx_report *report = nullptr)
{
    gtx_error error = {};
    if (gtx_cook_file(ball_file().c_str(), output.c_str(), &desc, report, &error))
        fail_msg("%d: %s", error.result, error.message);
}
