/* The sculptures as nothing but triangles, as many as wanted without holding them. */
#pragma once

#include "cave.hpp"

#include "base/bytes.h"

#include <cstdio>
#include <string>

/* The triangles of make_rings() one after another, with two rings in memory: `give` gets their
 * corners. */
template <class Point, class Give>
void stream_rings(double triangles, double slender, Point point_at, Give give)
{
    const uint64_t columns = uint64_t(std::sqrt(triangles / slender));
    const uint64_t rings = uint64_t(triangles / 2 / double(columns));
    std::vector<Vec> upper(columns, point_at(0, 0).position), lower = upper;
    for (uint64_t r = 0; r <= rings; ++r) {
        for (uint64_t c = 0; c < columns; ++c)
            lower[c] = r == rings ? point_at(1, 0).position
                                  : point_at(double(r + 1) / double(rings + 1),
                                             2 * PI * double(c) / double(columns)).position;
        for (uint64_t c = 0, next = 1 % columns; c < columns; ++c, next = (c + 1) % columns) {
            if (r > 0)
                give(upper[c], upper[next], lower[c]);
            if (r < rings)
                give(lower[c], upper[next], lower[next]);
        }
        upper.swap(lower);
    }
}

inline void write_triangle(const Vec &a, const Vec &b, const Vec &c)
{
    unsigned char bytes[36], *to = bytes;
    for (const Vec *corner : {&a, &b, &c})
        for (double x : *corner) {
            gtx_store_f32(to, float(x));
            to += 4;
        }
    std::fwrite(bytes, 1, sizeof bytes, stdout);
}

inline int write_stream(const std::string &shape, double wanted)
{
    auto inward = [](const Vec &a, const Vec &b, const Vec &c) { write_triangle(a, c, b); };
    if (shape == "shell")
        stream_rings(wanted, 14, shell_at, write_triangle);
    else if (shape == "hall")
        stream_rings(wanted, 1, hall_at, inward);
    else
        stream_rings(wanted, 8, cave_at, inward);
    if (shape != "shell")
        stream_rings(3000, 1, rock_at, write_triangle);
    return std::fflush(stdout) ? 2 : 0;
}
