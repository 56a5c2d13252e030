/* How far an LOD mesh strays from the surface that it was made of. */
#pragma once

#include "bake/lod/far_search.hpp"
#include "bake/lod/spots.hpp"

namespace gtx::baking {

/* Object units. */
struct Strayed {
    double most = 0;             /* a bound, both ways */
    double rms = 0;              /* of the surface's vertices from the level */
};

/* What of the source is farther from a level than `most`, or of the level from the source: a point
 * of each triangle. */
struct Spots {
    Vector<FarPoint> points;
    bool of_level = false;
    double most = 0;
    double rms = 0;              /* as in Strayed; of the source */
};

class Bounds {
public:
    /* `source` outlives it. */
    Bounds(const LodSource &source, Task &task);

    /* Of a level. Parts of the source that are no longer than `speck` need not be in it. */
    Strayed of(const LevelMesh &mesh, const Lattice &lattice, double speck) const;
    /* What of the source is farther from it than `least`, and much farther than the rest. */
    Spots spots(const LevelMesh &mesh, const Lattice &lattice, double speck, double least) const;
    /* What of it is farther from the source than `least`. */
    Spots spots_of(const LevelMesh &mesh, const Lattice &lattice, double least) const;
    /* A bound, after what lay there was changed: of the source, and of the level where they were
     * of that, if it was bounded elsewhere by as much as theirs. */
    double after(const LevelMesh &mesh, const Lattice &lattice, double speck, const Spots &spots,
                 const Vector<Corners> &changed) const;

private:
    struct LevelSurface;

    bool is_shown(uint32_t triangle, double speck) const;

    Task &task_;
    const Vector<uint32_t> &patch_;
    SortedSurface source_;
    Vector<double> parts_;       /* how long the connected part of each triangle given is */
    double largest_part_;
};

} // namespace gtx::baking
