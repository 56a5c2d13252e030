/* Worlds: models of any size as a tree of tiles, cooked in parts by plain processes over files.
 *
 *   plan    counts the triangles in the cells of a fine lattice, one pass in bounded memory, and
 *           cuts the lattice into an octree whose leaves have at most so many; writes plan.json and
 *           what runs the other steps (Ninja, a shell script, Slurm).
 *   split   a second pass: each triangle goes to the cell file of the leaf that its centroid is in;
 *           materials and decoded images of textured models to files beside them.
 *   cook    one tile: its own triangles, and a ring of those of its neighbours that share a vertex
 *           with them. LOD meshes keep the ring's vertices, so that the surfaces of two tiles meet
 *           along their border, and overlap: there is no gap to see through. Makes the asset, the
 *           GLB if asked for, and for the parent a *low* surface of a quarter of the triangles. Its
 *           border vertices are the source's own, the same on both sides of a border and at every
 *           level. A leaf's maps have its textures; low surfaces have vertex colours instead, the
 *           mean of the textures around a vertex, the same on both sides.
 *   merge   the low surfaces of a tile's children become the cell file of that tile.
 *   index   writes tileset.json (OGC 3D Tiles 1.1) once all tiles are there.
 *
 * Every step writes files atomically (base/output.h) and stores the key of their inputs: if that is
 * the same, it does nothing. The bytes do not depend on the workers, on the order of independent
 * steps, or on steps that were killed and run again. */
#pragma once

#include "mesh/task.hpp"

#include <string>

namespace gtx {

/* Limits on a tile's own triangles, and the default memory of the worker that cooks it. */
constexpr uint32_t MIN_TILE = 1000, MAX_TILE = 1000000;
constexpr uint64_t WORKER_MEMORY = 1000000000;

enum class Engine { NINJA, SHELL, SLURM };
/* AUTO: closed surfaces from the front, others from both. */
enum class Sides { AUTO, FRONT, BOTH };

struct PlanOptions {
    Vector<std::string> models;      /* files, folders, or "-": raw triangles from standard input */
    std::string folder;
    uint32_t triangles = MAX_TILE;   /* of a tile, at most */
    uint64_t memory = WORKER_MEMORY; /* of a worker */
    uint64_t work = 0;               /* limit of each step; 0: the default for files of its size */
    Engine engine = Engine::NINJA;
    bool glb = false, z_up = false;
    bool local_metres = false;       /* of grids in degrees; true at the first's middle */
    bool depths = false;             /* values of grids are depths, positive downwards */
    Sides sides = Sides::AUTO;       /* that are visible */
    double unit = 1;
    std::string command = "gtx";     /* that runs the steps */
};

/* The outcome of a step. */
struct StepReport {
    std::string summary;
    bool unchanged = false;          /* its results existed already */
};

/* The steps. Throw Error: READ, WRITE, INPUT, EMPTY, LIMIT, ARGUMENT, MEMORY, UNSUPPORTED,
 * CANCELLED. `tile` is a Tile::name. */
StepReport plan_world(const PlanOptions &options, Task &task);
StepReport split_world(const std::string &folder, Task &task);
StepReport cook_tile(const std::string &folder, const std::string &tile, Task &task);
StepReport merge_tile(const std::string &folder, const std::string &tile, Task &task);
StepReport index_world(const std::string &folder, Task &task);

} // namespace gtx
