/* Leaves as a PLY: models of thin sheets, for the table of partitions.
 *
 * Each is a curved blade with a keel, veins and a serrated edge. One alone lies askew and is
 * closed, a hundredth as thick as it is long; many are open sheets, scattered around a crown. */
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using Point = std::array<double, 3>;

struct Sheet {
    std::vector<Point> points;
    std::vector<std::array<uint32_t, 3>> triangles;
};

double random_number(uint64_t &state)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return double(state >> 33) / 2147483648.0;
}

Point at(double u, double v, double thickness)
{
    const double width = 0.28 * std::sin(M_PI * std::pow(u, 0.8)) *
                         (1 + 0.08 * std::sin(40 * M_PI * u));
    const double y = v * width, bulge = (1 - v * v) * std::sin(M_PI * u) / 2;
    const double veins = 0.01 * std::sin(30 * (u - 0.3 * std::fabs(v))) * (1 - std::fabs(v));
    return {u, y, 0.15 * std::sin(2.2 * u) + 0.4 * std::fabs(y) + veins + thickness * bulge};
}

/* Closed where it is thick: its two sides meet at the edge. */
Sheet make_leaf(uint32_t n, double thickness)
{
    Sheet out;
    const uint32_t rows = n / 3, row = n + 1, side = row * (rows + 1);
    for (int back = 0; back < (thickness > 0 ? 2 : 1); ++back) {
        for (uint32_t j = 0; j <= rows; ++j)
            for (uint32_t i = 0; i <= n; ++i)
                out.points.push_back(at(double(i) / n, 2.0 * j / rows - 1,
                                        back ? -thickness : thickness));
        for (uint32_t j = 0; j < rows; ++j)
            for (uint32_t i = 0; i < n; ++i) {
                uint32_t a = uint32_t(back) * side + j * row + i, b = a + 1, c = a + row, d = c + 1;
                if (back)
                    std::swap(b, c);
                out.triangles.push_back({a, b, d});
                out.triangles.push_back({a, d, c});
            }
    }
    return out;
}

/* Turns by a quaternion, scales and moves. */
void place(const std::array<double, 4> &q, double size, const Point &to, Sheet &sheet)
{
    for (Point &p : sheet.points) {
        const Point from = {p[0] - 0.5, p[1], p[2]};
        Point cross, again;
        for (int k = 0; k < 3; ++k)
            cross[size_t(k)] = q[size_t(1 + (k + 1) % 3)] * from[size_t((k + 2) % 3)] -
                               q[size_t(1 + (k + 2) % 3)] * from[size_t((k + 1) % 3)] +
                               q[0] * from[size_t(k)];
        for (int k = 0; k < 3; ++k)
            again[size_t(k)] = q[size_t(1 + (k + 1) % 3)] * cross[size_t((k + 2) % 3)] -
                               q[size_t(1 + (k + 2) % 3)] * cross[size_t((k + 1) % 3)];
        for (size_t k = 0; k < 3; ++k)
            p[k] = to[k] + size * (from[k] + 2 * again[k]);
    }
}

std::array<double, 4> random_turn(uint64_t &state)
{
    std::array<double, 4> q;
    double square;
    do {
        square = 0;
        for (double &x : q) {
            x = 2 * random_number(state) - 1;
            square += x * x;
        }
    } while (square > 1 || square < 0.01);
    for (double &x : q)
        x /= std::sqrt(square);
    return q;
}

Sheet make_crown(uint32_t leaves)
{
    Sheet out;
    uint64_t state = 7;
    for (uint32_t n = 0; n < leaves; ++n) {
        Sheet leaf = make_leaf(24, 0);
        Point to;
        do
            for (double &x : to)
                x = 8 * random_number(state) - 4;
        while (std::hypot(to[0], to[1], to[2]) > 4 || std::hypot(to[0], to[1], to[2]) < 2);
        place(random_turn(state), 0.6 + 0.5 * random_number(state), to, leaf);
        const auto first = uint32_t(out.points.size());
        out.points.insert(out.points.end(), leaf.points.begin(), leaf.points.end());
        for (std::array<uint32_t, 3> t : leaf.triangles)
            out.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return out;
}

} // namespace

int main(int argc, char **argv)
{
    const int leaves = argc == 3 ? std::atoi(argv[2]) : 0;
    if (leaves < 1 || leaves > 100000) {
        std::fprintf(stderr, "usage: leaves OUT.ply COUNT\n");
        return 1;
    }
    Sheet sheet = leaves > 1 ? make_crown(uint32_t(leaves)) : make_leaf(300, 0.01);
    if (leaves == 1)
        place({0.905, 0.341, 0.222, 0.117}, 1, {0, 0, 0}, sheet);
    FILE *file = std::fopen(argv[1], "w");
    if (!file)
        return 2;
    std::fprintf(file, "ply\nformat ascii 1.0\nelement vertex %zu\nproperty float x\nproperty "
                       "float y\nproperty float z\nelement face %zu\nproperty list uchar int "
                       "vertex_indices\nend_header\n",
                 sheet.points.size(), sheet.triangles.size());
    for (const Point &p : sheet.points)
        std::fprintf(file, "%.9g %.9g %.9g\n", p[0], p[1], p[2]);
    for (const auto &t : sheet.triangles)
        std::fprintf(file, "3 %u %u %u\n", t[0], t[1], t[2]);
    return std::fclose(file) ? 2 : 0;
}
