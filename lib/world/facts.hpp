/* Results of cooking a tile: its bounds and error, and the key of its inputs. */
#pragma once

#include "world/plan.hpp"

namespace gtx {

/* A file that a step made. */
struct MadeFile {
    uint64_t size = 0, hash = 0;
};

/* The beginning of a tile's file, which can be drawn alone; of size 0 if there is none. */
struct Beginning {
    MadeFile file;
    uint64_t memory = 0;             /* most that opening it takes */
    double error = 0;                /* from the source; at least the side of its texels */
};

struct TileFacts {
    uint64_t key = 0;
    uint64_t triangles = 0, lod_triangles = 0;
    Vec3d low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    double error = 0;                /* of the finest LOD mesh, from the source */
    bool empty = false;              /* only triangles without area: there is no asset */
    MadeFile asset, glb, low_surface;
    uint64_t memory = 0;             /* most that opening the asset takes */
    Beginning beginning;

    void add(const Vec3d &p);
};

void write_facts(const Plan &plan, const Tile &tile, const TileFacts &facts);
/* Throws Error: READ if there are none, INPUT if they are invalid. */
TileFacts read_facts(const Plan &plan, const Tile &tile);

/* ---- opened.cpp ---- */

/* The most memory that opening a file takes, with or without jobs. */
uint64_t memory_to_open(const std::string &bytes);
/* The beginning of a tile's file: `error` is that of its finest LOD mesh, `deviation` the distance
 * of the tile's surface from the source. */
Beginning beginning_of(const std::string &bytes, double error, double deviation);

MadeFile made_of(const std::string &bytes);
/* Whether the files that the facts name exist: with the same content if `content`, otherwise with
 * the same size. */
bool are_there(const Plan &plan, const Tile &tile, const TileFacts &facts, bool content);

} // namespace gtx
