/* A terrain of as many triangles as wanted: the heights of a grid, and between its nodes relief
 * that goes on as the grid's own does (midpoint displacement: Fournier, Fussell, Carpenter 1982,
 * here by noise, so that no more than two rows are held). */
#pragma once

#include "raw.hpp"

#include <geotex/grid.h>

class Terrain {
public:
    /* Nodes without data lie as low as the lowest. */
    explicit Terrain(const gtx_height_grid &grid)
        : nx(grid.nx), ny(grid.ny), heights(grid.values, grid.values + size_t(nx) * ny),
          spacing{grid.spacing[0], grid.spacing[1]}
    {
        float lowest = INFINITY;
        for (float h : heights)
            lowest = std::fmin(lowest, h);
        for (float &h : heights)
            h = std::isnan(h) ? lowest : h;
        find_roughness();
    }

    /* `triangles` from west to east, row by row to the north. */
    template <class Give> void stream(double triangles, Give give) const
    {
        const double finer = std::sqrt(triangles / 2 / (double(nx - 1) * (ny - 1)));
        const size_t columns = size_t((nx - 1) * finer), rows = size_t((ny - 1) * finer);
        std::vector<Vec> near_row(columns + 1), far_row = near_row;
        for (size_t r = 0; r <= rows; ++r, near_row.swap(far_row)) {
            for (size_t c = 0; c <= columns; ++c) {
                const double x = double(nx - 1) * double(c) / double(columns);
                const double y = double(ny - 1) * double(r) / double(rows);
                far_row[c] = {spacing[0] * x, height(x, y, finer), -spacing[1] * y};
            }
            for (size_t c = 0; r > 0 && c < columns; ++c) {
                give(near_row[c], near_row[c + 1], far_row[c]);
                give(far_row[c], near_row[c + 1], far_row[c + 1]);
            }
        }
    }

private:
    uint32_t nx, ny;
    std::vector<float> heights, rough; /* rough: how far a node lies from between its neighbours */
    double spacing[2];                 /* metres */
    double gain = 0.5;                 /* of roughness from an octave to the next */

    float at(const std::vector<float> &values, int64_t i, int64_t j) const
    {
        i = std::clamp<int64_t>(i, 0, nx - 1);
        j = std::clamp<int64_t>(j, 0, ny - 1);
        return values[size_t(j) * nx + size_t(i)];
    }

    /* Mean over 9 x 9 nodes of their distances from the means of their four neighbours, `step`
     * nodes away. */
    std::vector<float> roughness(int step) const
    {
        constexpr int REACH = 4;
        std::vector<float> own(heights.size()), across = own, mean = own;
        auto for_each_node = [&](auto value_at, std::vector<float> &out) {
            for (uint32_t j = 0; j < ny; ++j)
                for (uint32_t i = 0; i < nx; ++i)
                    out[size_t(j) * nx + i] = value_at(int64_t(i), int64_t(j));
        };
        for_each_node([&](int64_t i, int64_t j) {
            const float around = at(heights, i - step, j) + at(heights, i + step, j) +
                                 at(heights, i, j - step) + at(heights, i, j + step);
            return std::fabs(at(heights, i, j) - around / 4);
        }, own);
        for (int along_y = 0; along_y < 2; ++along_y)
            for_each_node([&](int64_t i, int64_t j) {
                float sum = 0;
                for (int k = -REACH; k <= REACH; ++k)
                    sum += along_y ? at(across, i, j + k) : at(own, i + k, j);
                return sum / (2 * REACH + 1);
            }, along_y ? mean : across);
        return mean;
    }

    /* The gain is that from two nodes' spacing to one: 2 to the minus Hurst exponent. */
    void find_roughness()
    {
        double wide = 0, fine = 0;
        for (float r : roughness(2))
            wide += double(r);
        rough = roughness(1);
        for (float r : rough)
            fine += double(r);
        if (wide > fine)
            gain = fine / wide;
    }

    /* Catmull-Rom's weights of the four nodes around t in 0..1. */
    static std::array<double, 4> weights(double t)
    {
        const double u = 1 - t;
        return {-t * u * u / 2, (2 - t * t * (5 - 3 * t)) / 2, (2 - u * u * (5 - 3 * u)) / 2,
                -u * t * t / 2};
    }

    double height(double x, double y, double finer) const
    {
        const int64_t i = int64_t(x), j = int64_t(y);
        const double tx = x - double(i), ty = y - double(j);
        const auto wx = weights(tx), wy = weights(ty);
        double sum = 0;
        for (int b = 0; b < 4; ++b)
            for (int a = 0; a < 4; ++a)
                sum += wx[size_t(a)] * wy[size_t(b)] * double(at(heights, i + a - 1, j + b - 1));
        const auto rough_at = [&](int a, int b) { return double(at(rough, i + a, j + b)); };
        const double near_row = mix(rough_at(0, 0), rough_at(1, 0), tx);
        const double far_row = mix(rough_at(0, 1), rough_at(1, 1), tx);
        /* values in -1..1 lie 0.56 from between their neighbours on average */
        double amplitude = mix(near_row, far_row, ty) / 0.56;
        for (double scale = 2; scale < 2 * finer; scale *= 2)
            sum += (amplitude *= gain) * noise(scale * x, scale * y, scale);
        return sum;
    }
};
