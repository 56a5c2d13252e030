/* The plan of a world: its tiles, the paths of their files, and the lattice of cells that they
 * consist of. */
#pragma once

#include "mesh/stream.hpp"
#include "world/world.hpp"

namespace gtx {

/* A lattice of cubes of side 2^exponent. A place is the Morton code of a cube (Morton 1966), so
 * that the cubes in a node of an octree are a range of places. */
struct Lattice {
    int exponent = 0;
    int64_t low[3] = {0, 0, 0};      /* the first cell, along each axis */

    uint64_t place(const Vec3d &p) const;
};

/* Interleaves three numbers of 21 bits. */
uint64_t morton(uint64_t x, uint64_t y, uint64_t z);

/* Tiles come in the order of their depth, the root first. */
struct Tile {
    std::string name;                /* "r", and a digit for each octant on the way */
    uint32_t depth = 0, parent = 0;
    Vector<uint32_t> children;
    uint64_t first = 0, end = 0;     /* places of the lattice */
    uint64_t triangles = 0;          /* of a leaf; of other tiles, the expected number */
    /* Around all of its triangles, at most some cells too large. */
    Vec3d low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

    bool is_leaf() const { return children.empty(); }
    bool touches(const Vec3d &from, const Vec3d &to) const;
};

/* A file that triangles come from. */
struct WorldInput {
    std::string path;
    bool raw = false, grid = false;
};

struct Plan {
    std::string folder;
    uint64_t key = 0;                /* of the triangles and of the options */
    uint32_t triangles = 0;
    uint64_t memory = 0, work = 0, total = 0, dropped = 0;
    bool glb = false, z_up = false;
    bool closed = false;             /* back faces are never seen */
    double unit = 1;
    double latitude = NAN;           /* where metres are true that grids in degrees become */
    bool of_depths = false;          /* values of grids are depths, positive downwards */
    CornerTraits traits;
    Lattice lattice;
    Vector<WorldInput> inputs;
    Vector<Tile> tiles;

    const Tile &tile(const std::string &name) const;
    /* Tiles that may have triangles at the border of one that is no leaf: those whose simplified
     * surfaces, at its children's level or leaves above it, may touch it. */
    Vector<const Tile *> low_neighbours(const Tile &tile) const;
    uint32_t depths() const { return tiles.back().depth + 1; }
    /* The share of a tile's triangles that its simplified surface has. */
    double low_share(const Tile &tile) const;
};

void write_plan(const Plan &plan);
Plan read_plan(const std::string &folder, Task &task);

/* Scripts that run the steps, in the plan's folder. */
void write_engine(const Plan &plan, Engine engine, const std::string &command);

/* ---- files below the folder ---- */

std::string plan_path(const std::string &folder);
/* Intermediate and final files of a tile. */
std::string cell_path(const Plan &plan, const Tile &tile);
std::string low_path(const Plan &plan, const Tile &tile);
std::string facts_path(const Plan &plan, const Tile &tile);
std::string asset_path(const Plan &plan, const Tile &tile);
std::string glb_path(const Plan &plan, const Tile &tile);
/* Creates the folder of a file. Throws Error: WRITE. */
void make_folder_of(const std::string &path);
/* gtx_write_file, creating the folder; does nothing if the file has that content already. */
void write_whole(const std::string &path, const std::string &text);

/* ---- what plan and split read ---- */

/* Reads every triangle of all inputs, in their order, rotated if +Z is up; drops those with corners
 * that are not are_near, and returns their number. Materials are numbered in the order in which
 * `on_look` gets them. */
uint64_t read_inputs(const Plan &plan, Task &task, const TriangleSink &sink,
                     const LookSink &on_look = nullptr);
CornerTraits input_traits(const Plan &plan, Task &task);
/* That of the middle of the first grid in degrees; NaN if there is none. */
double input_latitude(const Plan &plan, Task &task);
/* The input files, those of folders sorted by name. Throws Error: READ; ARGUMENT if the world's
 * folder is among them. */
Vector<WorldInput> find_inputs(const PlanOptions &options);

/* The octree over counted cells; throws Error(LIMIT) if one cell has more than `most`. */
struct CountedCell {
    uint64_t place, count;
};
Vector<Tile> make_tiles(Vector<CountedCell> cells, uint64_t most);

/* Gives tiles their boxes: cells, and as far around as corners are from a triangle's middle. */
void make_boxes(const Lattice &lattice, const Vector<CountedCell> &cells, double reach,
                Vector<Tile> &tiles);

/* Counts triangles by place, in a bounded number of cells that are as small as possible. */
class CellCounts {
public:
    CellCounts();
    void add(const Vec3d &centroid);
    /* The lattice of what was counted, and its cells. */
    Vector<CountedCell> finish(Lattice &lattice) const;

private:
    struct Slot {
        uint64_t cell = UINT64_MAX, count = 0;
    };
    void coarsen(int by);
    void insert(uint64_t cell, uint64_t count);
    void fit(const Vec3d &p);

    Vector<Slot> slots_;
    size_t used_ = 0, last_ = 0;     /* slots with a cell; the one that was counted last */
    int exponent_;
};

/* Whether triangles make a closed surface that faces outwards. In a sum of hashes of edges, an edge
 * from a to b and one from b to a cancel each other, whatever the order and number of triangles;
 * that other edges do has a probability of 2^-64. Corners at equal positions are the same. */
class Boundary {
public:
    void add(const Corners3 &corners);
    /* And counter-clockwise seen from outside, by the volume of all components together. */
    bool closed() const { return !sum_ && volume_ > 0; }

private:
    uint64_t sum_ = 0;
    double volume_ = 0;              /* six times */
    Vec3d origin_;
    bool any_ = false;
};

} // namespace gtx
