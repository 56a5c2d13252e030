/* Height grids: files of geologists and of terrain -> rows of values and where they lie. */
#pragma once

#include "mesh/mesh.hpp"
#include "base/exact.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace gtx {

/* Values at the nodes of a lattice. Node (i, j) lies at
 *   origin + R(rotation) (i * step[0], j * step[1])
 * with the rotation in degrees, counter-clockwise seen from above. Steps are positive. */
struct HeightGrid {
    uint32_t nx = 0, ny = 0;
    double origin[2] = {0, 0}, step[2] = {1, 1}, rotation = 0;
    bool in_degrees = false;   /* origin and step, but not the values */
    bool is_unplaced = false;  /* no file told origin and step */
    bool has_categories = false; /* values are kinds: nothing lies between two */
    Vector<float> values;      /* nx * ny, row by row from the origin; NaN where there is none */

    size_t count() const { return size_t(nx) * ny; }
    float at(uint32_t i, uint32_t j) const { return values[size_t(j) * nx + i]; }
    std::array<double, 2> place(double i, double j) const
    {
        const double turn = rotation * std::acos(-1.0) / 180;
        const double c = gtx_cos(turn), s = gtx_sin(turn);
        const double x = i * step[0], y = j * step[1];
        return {origin[0] + c * x - s * y, origin[1] + s * x + c * y};
    }
};

/* Nodes along a side. */
constexpr uint32_t MAX_SIDE = 1 << 24;

/* What is wrong with a grid in degrees; its name goes before. */
constexpr const char *IN_DEGREES = " lies in degrees, and its heights do not: reproject it to "
                                   "metres (gdalwarp -t_srs EPSG:...), or take metres of one "
                                   "place (--local-metres)";

/* What a file may leave open. */
struct GridReading {
    const double *missing = nullptr; /* says that there is no value, as the format's does */
    const double *range = nullptr;   /* two: what an image's least and greatest code stand for, the
                                        missing one left out */
};

/* Reads a grid by its content: IRAP classic and IRAP binary, ZMAP+, CPS-3, NetCDF; through GDAL,
 * GeoTIFF, ESRI ASCII, Surfer, and by their names HGT and XYZ; else an image (PNG, TIFF, EXR ... of
 * 8 or 16 bits or of floats), whose top row is the last of the grid; each also gzipped but TIFF and
 * images.
 * Throws Error: READ, INPUT, UNSUPPORTED, LIMIT, MEMORY. */
HeightGrid read_grid(const std::string &path, const GridReading &reading, Task &task);

/* Whether read_grid would take a file that is no model by its name: by its content, or the name of
 * an image. Throws Error: READ. */
bool is_grid_file(const std::string &path);

/* ---- a grid as a surface ---- */

/* East becomes +X, up +Y, north -Z. */
Vec3d grid_node(const HeightGrid &grid, size_t node);
/* Calls for each triangle of a row of cells, with its nodes: two a cell, one where one corner has
 * no value. */
using OnNodes = std::function<void(const std::array<size_t, 3> &)>;
void for_each_triangle(const HeightGrid &grid, uint32_t row, const OnNodes &call);
/* Throws Error: INPUT where the grid lies in degrees. */
void require_lengths(const HeightGrid &grid);
/* The whole. Throws Error: INPUT, LIMIT. */
Mesh mesh_of(const HeightGrid &grid, Task &task);

/* The formats, from the bytes of a file. */
bool is_irap_classic(std::string_view bytes);
bool is_irap_binary(std::string_view bytes);
bool is_zmap(std::string_view bytes);
bool is_cps3(std::string_view bytes);
bool is_netcdf(std::string_view bytes);
bool is_netcdf4(std::string_view bytes); /* HDF5 */
HeightGrid read_irap_classic(std::string_view bytes, const Limits &limits = Limits());
HeightGrid read_irap_binary(std::string_view bytes, const Limits &limits = Limits());
HeightGrid read_zmap(std::string_view bytes, const Limits &limits = Limits());
HeightGrid read_cps3(std::string_view bytes, const Limits &limits = Limits());
HeightGrid read_netcdf(std::string_view bytes, const Limits &limits = Limits());

/* A classic NetCDF of one of NetCDF-4: its dimensions, and variables of up to two of them. Throws
 * Error: UNSUPPORTED where the program that reads HDF5 is not there, INPUT, LIMIT. */
Bytes classic_of_netcdf4(std::string_view bytes, Task &task);

/* Which of GDAL's drivers reads a file that starts so, or null. */
const char *gdal_driver(std::string_view head, const std::string &path);
HeightGrid read_gdal(const char *driver, std::string_view bytes, const std::string &path,
                     const GridReading &reading, Task &task);

/* Codes of an image, rows from the top, as values; `least` and `greatest` are those of its kind of
 * whole number. */
struct GridCodes {
    uint32_t nx, ny;
    double least, greatest, scale, offset;
    const float *codes;
};
HeightGrid grid_of_codes(const GridCodes &image, const GridReading &reading);

/* Of parts of one lattice: nodes that several have, those where their values differ, and by how
 * much at most. */
struct SharedNodes {
    uint64_t count = 0, differing = 0;
    double difference = 0;
};

/* One grid of several that are parts of one lattice, such as neighbouring tiles of terrain; of
 * nodes that several have, the first with a value counts. Throws Error: INPUT where the lattices
 * differ. */
HeightGrid mosaic(const Vector<HeightGrid> &parts, const Limits &limits = Limits(),
                  SharedNodes *shared = nullptr);

/* A grid in degrees becomes one in metres, which are true at a latitude (WGS 84). */
void use_local_metres(HeightGrid &grid, double latitude);
/* Likewise of several: the latitude, NaN at first, becomes that of the first one's middle. */
void use_common_metres(HeightGrid &grid, double &latitude);
/* Values that were depths, positive downwards, become heights. */
void use_depths(HeightGrid &grid);

/* Values of `from` at the nodes of `to`: between its nodes bilinear, the mean over what a node of
 * `to` stands for where those are further apart; of categories the nearest and most frequent; NaN
 * where the nearest node has none or there is none. Where either is unplaced, `from` reaches over
 * all of `to`. Throws Error: INPUT where the two have no place in common, or one alone lies in
 * degrees. */
Vector<float> resample(const HeightGrid &from, const HeightGrid &to);

/* Whether two surfaces have the same heights in most of the places that both cover: tiles or copies
 * that belong together, not layers. */
bool are_alike(const HeightGrid &a, const HeightGrid &b);
/* Nodes where `a` and `b`, layers of one lattice, lie the other way round than in most. */
uint64_t count_crossings(const HeightGrid &a, const HeightGrid &b);

/* Colours for a value of 0..1, sRGB. */
enum class ColorMap { VIRIDIS, RAINBOW };
std::array<uint8_t, 3> color_of(ColorMap map, double value);

} // namespace gtx
