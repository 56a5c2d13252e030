/* Worlds: models of any size as a tree of tiles, cooked in parts by plain processes over files.
 *
 *   plan    counts the triangles in the cells of a fine lattice, one pass in bounded memory, and
 *           cuts the lattice into an octree whose leaves have at most so many; writes plan.json and
 *           what runs the other steps (Ninja, a shell script, Slurm).
 *   split   a second pass: each triangle goes to the cell file of the leaf that its centroid is in;
 *           materials and decoded images of textured models to files beside them.
 *   cook    one tile: its own triangles, and a ring of those of its neighbours that share a vertex
 *           with them. LOD meshes keep the ring's vertices, so that the surfaces of two tiles meet
 *           along their border, and overlap: no sight passes between. Makes the asset, the GLB if
 *           wanted, and a *low* surface of a quarter of the triangles for the parent, whose border
 *           vertices stay where they are: the source's own, the same on both sides, at every
 *           level. What textures show of a leaf is in its maps; in low surfaces it becomes
 *           vertex colours, the mean of what lies around, the same on both sides.
 *   merge   the low surfaces of a tile's children become the cell file of a tile of its own.
 *   index   writes tileset.json (OGC 3D Tiles 1.1) once all tiles are there.
 *
 * Every step writes files whole (base/output.h) and keeps the key of what it made them from: where
 * that is what it would make, it does nothing. Bytes do not depend on the workers, on the order of
 * steps that do not need each other, or on what was killed and begun again. */
#pragma once

#include "mesh/task.hpp"

#include <string>

namespace gtx {

/* Promised: a tile's own triangles, and the memory of whoever cooks it. */
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
    uint64_t work = 0;               /* of a step, at most; 0: as files of its size may take */
    Engine engine = Engine::NINJA;
    bool glb = false, z_up = false;
    Sides sides = Sides::AUTO;       /* that show */
    double unit = 1;
    std::string command = "gtx";     /* that runs the steps */
};

/* What a step says of itself. */
struct StepReport {
    std::string summary;
    bool unchanged = false;          /* all was there */
};

/* Throw Error: READ, WRITE, INPUT, EMPTY, LIMIT, ARGUMENT, MEMORY, UNSUPPORTED, CANCELLED.
 * `tile` is the name of one. */
StepReport plan_world(const PlanOptions &options, Task &task);
StepReport split_world(const std::string &folder, Task &task);
StepReport cook_tile(const std::string &folder, const std::string &tile, Task &task);
StepReport merge_tile(const std::string &folder, const std::string &tile, Task &task);
StepReport index_world(const std::string &folder, Task &task);

} // namespace gtx
