/* What cooking a tile left: its bounds and error, and the key of what it was made from. */
#pragma once

#include "world/plan.hpp"

namespace gtx {

/* A file that a step made. */
struct MadeFile {
    uint64_t size = 0, hash = 0;
};

/* The first bytes of a tile's file, enough to show it coarsely; of size 0 where there are none. */
struct Beginning {
    MadeFile file;
    uint64_t memory = 0;             /* that opening them takes, at most */
    double error = 0;                /* from the source; no less than the side of its texels */
};

struct TileFacts {
    uint64_t key = 0;
    uint64_t triangles = 0, lod_triangles = 0;
    Vec3d low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    double error = 0;                /* from the source, of what the GLB has too */
    bool empty = false;              /* nothing but triangles without area: no asset */
    MadeFile asset, glb, low_surface;
    uint64_t memory = 0;             /* that opening the asset takes, at most */
    Beginning beginning;

    void add(const Vec3d &p);
};

void write_facts(const Plan &plan, const Tile &tile, const TileFacts &facts);
/* Throws Error: READ where there are none, INPUT where they are not such. */
TileFacts read_facts(const Plan &plan, const Tile &tile);

/* ---- opened.cpp ---- */

/* The most that a reader of a file takes, with jobs or without. */
uint64_t memory_to_open(const std::string &bytes);
/* Of the file of a tile whose finest LOD mesh has that error, made of a surface that deviates from
 * the source so much. */
Beginning beginning_of(const std::string &bytes, double error, double deviation);

MadeFile made_of(const std::string &bytes);
/* Whether the files that the facts tell of are there: all of it, where `content`; otherwise of that
 * size. */
bool are_there(const Plan &plan, const Tile &tile, const TileFacts &facts, bool content);

} // namespace gtx
