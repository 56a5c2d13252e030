/* Writes height grids as a triangle mesh, as `gtx horizons` places them: east +X, up +Y, north -Z,
 * two triangles a cell that has its four nodes.
 *
 *   grid_mesh OUT.ply [--depths] [--vertical X] [--spacing DX,DY] [--range LOW,HIGH] GRID...
 */
#include <geotex/cook.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

struct Surface {
    std::vector<double> points;
    std::vector<uint32_t> corners;
};

static void add_grid(Surface &surface, const gtx_height_grid &grid, double scale)
{
    constexpr uint32_t NONE = 0xffffffffu;
    std::vector<uint32_t> name(size_t(grid.nx) * grid.ny, NONE);
    const double turn = grid.rotation * std::acos(-1) / 180;
    for (uint32_t j = 0; j < grid.ny; ++j)
        for (uint32_t i = 0; i < grid.nx; ++i) {
            const size_t at = size_t(j) * grid.nx + i;
            if (std::isnan(grid.values[at]))
                continue;
            const double x = i * grid.spacing[0], y = j * grid.spacing[1];
            name[at] = uint32_t(surface.points.size() / 3);
            surface.points.insert(surface.points.end(),
                                  {grid.origin[0] + std::cos(turn) * x - std::sin(turn) * y,
                                   scale * double(grid.values[at]),
                                   -grid.origin[1] - std::sin(turn) * x - std::cos(turn) * y});
        }
    for (uint32_t j = 0; j + 1 < grid.ny; ++j)
        for (uint32_t i = 0; i + 1 < grid.nx; ++i) {
            const size_t at = size_t(j) * grid.nx + i;
            const uint32_t a = name[at], b = name[at + 1], c = name[at + grid.nx],
                           d = name[at + grid.nx + 1];
            if (std::max(std::max(a, b), std::max(c, d)) != NONE)
                surface.corners.insert(surface.corners.end(), {a, b, d, a, d, c});
        }
}

static bool write_ply(const char *path, const Surface &surface)
{
    FILE *file = std::fopen(path, "wb");
    if (!file)
        return false;
    std::fprintf(file, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n"
                       "property double x\nproperty double y\nproperty double z\n"
                       "element face %zu\nproperty list uchar uint vertex_indices\nend_header\n",
                 surface.points.size() / 3, surface.corners.size() / 3);
    std::fwrite(surface.points.data(), sizeof(double), surface.points.size(), file);
    for (size_t i = 0; i < surface.corners.size(); i += 3) {
        std::fputc(3, file);
        std::fwrite(&surface.corners[i], sizeof(uint32_t), 3, file);
    }
    return std::fclose(file) == 0;
}

int main(int argc, char **argv)
{
    Surface surface;
    double sign = 1, vertical = 1, spacing[2] = {};
    gtx_height_grid_desc desc = {};
    for (int i = 2; i < argc; ++i) {
        gtx_height_grid grid;
        gtx_error error;
        if (!std::strcmp(argv[i], "--depths")) {
            sign = -1;
        } else if (!std::strcmp(argv[i], "--vertical") && i + 1 < argc) {
            vertical = std::atof(argv[++i]);
        } else if (!std::strcmp(argv[i], "--spacing") && i + 1 < argc) {
            std::sscanf(argv[++i], "%lf,%lf", spacing, spacing + 1);
        } else if (!std::strcmp(argv[i], "--range") && i + 1 < argc) {
            /* of images: black is no data */
            std::sscanf(argv[++i], "%lf,%lf", desc.range, desc.range + 1);
            desc.has_missing = 1;
        } else if (gtx_height_grid_read(argv[i], &desc, &grid, &error)) {
            std::fprintf(stderr, "grid_mesh: error: %s\n", error.message);
            return 1;
        } else {
            for (int k = 0; k < 2; ++k)
                grid.spacing[k] = spacing[k] > 0 ? spacing[k] : grid.spacing[k];
            add_grid(surface, grid, sign * vertical);
            gtx_height_grid_free(&grid);
        }
    }
    if (surface.corners.empty() || !write_ply(argv[1], surface)) {
        std::fprintf(stderr, "usage: grid_mesh OUT.ply [--depths] [--vertical X] "
                             "[--spacing DX,DY] [--range LOW,HIGH] GRID...\n");
        return 1;
    }
    return 0;
}
