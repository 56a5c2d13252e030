/* The plan of a world: its tiles, where their files lie, and the lattice that tells them apart. */
#pragma once

#include "mesh/stream.hpp"
#include "world/world.hpp"

namespace gtx {

/* Cubes of side 2^exponent. A place is a number of three interleaved coordinates (Morton 1966), so
 * that the cells of an octree's node are a range of them. */
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
    uint64_t triangles = 0;          /* of a leaf; of others as many as are to be expected */

    bool is_leaf() const { return children.empty(); }
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
    bool closed = false;             /* or as good as that: nothing shows from behind */
    double unit = 1;
    CornerTraits traits;
    Lattice lattice;
    Vector<WorldInput> inputs;
    Vector<Tile> tiles;

    const Tile &tile(const std::string &name) const;
    uint32_t depths() const { return tiles.back().depth + 1; }
    /* Of a tile's surface as many triangles go into its parent's. */
    double low_share(const Tile &tile) const;
};

void write_plan(const Plan &plan);
Plan read_plan(const std::string &folder, Task &task);

/* Scripts that run the steps, in the plan's folder. */
void write_engine(const Plan &plan, Engine engine, const std::string &command);

/* ---- files below the folder ---- */

std::string plan_path(const std::string &folder);
/* Files of the plan's folder that tiles are made of, and of what they are made. */
std::string cell_path(const Plan &plan, const Tile &tile);
std::string low_path(const Plan &plan, const Tile &tile);
std::string facts_path(const Plan &plan, const Tile &tile);
std::string asset_path(const Plan &plan, const Tile &tile);
std::string glb_path(const Plan &plan, const Tile &tile);
/* Makes the folder that a file is to lie in. Throws Error: WRITE. */
void make_folder_of(const std::string &path);
/* As gtx_write_file, in a folder that need not be there. Nothing where that is the content. */
void write_whole(const std::string &path, const std::string &text);

/* ---- what plan and split read ---- */

/* Every triangle of all inputs whose corners are near enough, turned where +Z is up, in the order
 * of the inputs. Materials are numbered in the order in which `on_look` gets them. Returns how many
 * were dropped. */
uint64_t read_inputs(const Plan &plan, Task &task, const TriangleSink &sink,
                     const LookSink &on_look = nullptr);
CornerTraits input_traits(const Plan &plan, Task &task);
/* Files, those of folders in the order of their names. Throws Error: READ, ARGUMENT where the
 * world's folder is among them. */
Vector<WorldInput> find_inputs(const PlanOptions &options);

/* Leaves of an octree over counted cells; throws Error(LIMIT) where one cell has too many. */
struct CountedCell {
    uint64_t place, count;
};
Vector<Tile> make_tiles(Vector<CountedCell> cells, uint64_t most);

/* Counts triangles by place, in cells as fine as a bounded number of them can be. */
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
    size_t used_ = 0;
    int exponent_;
};

/* Whether triangles make a closed surface, of which nobody sees the inside. Edges from a to b and
 * from b to a cancel out in a sum of their hashes, whatever the order and the number of triangles;
 * 2^-64 is how likely others do. Corners are the same where their positions are. */
class Boundary {
public:
    void add(const Corners3 &corners);
    /* And counterclockwise seen from outside: the volume tells, of all components together. */
    bool closed() const { return !sum_ && volume_ > 0; }

private:
    uint64_t sum_ = 0;
    double volume_ = 0;              /* six times */
    Vec3d origin_;
    bool any_ = false;
};

} // namespace gtx
