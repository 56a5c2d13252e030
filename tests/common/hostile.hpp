/* Models of few bytes that ask for much time, as OBJ text of about `n` triangles. */
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

namespace hostile {

/* The upper bits of Knuth's MMIX generator, 0..1. */
class Random {
public:
    double next()
    {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return double(state_ >> 11) / 9007199254740992.0;
    }
    unsigned below(unsigned count) { return unsigned(next() * count); }

private:
    uint64_t state_ = 1;
};

inline std::string vertex(double x, double y, double z)
{
    char text[96];
    std::snprintf(text, sizeof text, "v %g %g %g\n", x, y, z);
    return text;
}

inline std::string face(unsigned a, unsigned b, unsigned c)
{
    return "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
}

/* All on one edge. */
inline std::string one_edge(unsigned n)
{
    std::string out = "v 0 0 0\nv 0 0 1\n";
    for (unsigned i = 0; i < n; ++i)
        out += vertex(std::cos(i), std::sin(i), 0) + face(1, 2, i + 3);
    return out;
}

/* Anywhere, each as large as the whole, and none joined to another. */
inline std::string soup(unsigned n)
{
    Random random;
    std::string out;
    for (unsigned i = 0; i < n; ++i) {
        for (int k = 0; k < 3; ++k) {
            const double x = random.next(), y = random.next(), z = random.next();
            out += vertex(x, y, z);
        }
        out += face(3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    return out;
}

/* A wavy disc: needles around one vertex. */
inline std::string fan(unsigned n)
{
    std::string out = "v 0 0 0\n";
    for (unsigned i = 0; i < n; ++i) {
        const double turn = 2 * M_PI * i / n;
        out += vertex(std::cos(turn), std::sin(turn), 0.1 * std::sin(i));
    }
    for (unsigned i = 0; i < n; ++i)
        out += face(1, i + 2, (i + 1) % n + 2);
    return out;
}

/* Squares closely above each other. */
inline std::string stack(unsigned n)
{
    std::string out;
    for (unsigned i = 0; i < n / 2; ++i) {
        const double z = 1e-4 * i;
        out += vertex(0, 0, z) + vertex(1, 0, z) + vertex(0, 1, z) + vertex(1, 1, z);
        out += face(4 * i + 1, 4 * i + 2, 4 * i + 3) + face(4 * i + 2, 4 * i + 4, 4 * i + 3);
    }
    return out;
}

/* Octahedra inside each other, closely. */
inline std::string shells(unsigned n)
{
    static const char *const FACES[8] = {"024", "214", "134", "304", "205", "125", "315", "035"};
    std::string out;
    for (unsigned i = 0; i < n / 8; ++i) {
        const double r = 1 + 0.8 * i / n;
        for (int k = 0; k < 6; ++k) {
            const double at = k % 2 ? -r : r;
            out += vertex(k / 2 == 0 ? at : 0, k / 2 == 1 ? at : 0, k / 2 == 2 ? at : 0);
        }
        for (const char *f : FACES)
            out += face(6 * i + 1 + unsigned(f[0] - '0'), 6 * i + 1 + unsigned(f[1] - '0'),
                        6 * i + 1 + unsigned(f[2] - '0'));
    }
    return out;
}

/* A grid of heights that have nothing to do with each other: it folds along every axis. */
inline std::string noise(unsigned n)
{
    const unsigned side = unsigned(std::sqrt(n / 2.)) + 1;
    Random random;
    std::string out;
    for (unsigned j = 0; j < side; ++j)
        for (unsigned i = 0; i < side; ++i)
            out += vertex(double(i) / side, double(j) / side, random.next());
    for (unsigned j = 0; j + 1 < side; ++j)
        for (unsigned i = 0; i + 1 < side; ++i) {
            const unsigned at = 1 + j * side + i;
            out += face(at, at + 1, at + side) + face(at + 1, at + side + 1, at + side);
        }
    return out;
}

/* Polygons of `corners` random ones of 512 vertices. */
inline std::string polygons(unsigned count, unsigned corners)
{
    Random random;
    std::string out;
    for (int i = 0; i < 512; ++i) {
        const double x = random.next(), y = random.next(), z = random.next();
        out += vertex(x, y, z);
    }
    for (unsigned p = 0; p < count; ++p) {
        out += "f";
        for (unsigned i = 0; i < corners; ++i)
            out += " " + std::to_string(1 + random.below(512));
        out += "\n";
    }
    return out;
}

} // namespace hostile
