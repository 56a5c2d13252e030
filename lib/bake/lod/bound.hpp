/* How far an LOD mesh strays from the surface that it was made of. */
#pragma once

#include "bake/lod/looks.hpp"
#include "bake/lod/overlay.hpp"

#include <memory>

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

/* The source, which outlives it. */
class BoundSource {
public:
    BoundSource(const LodSource &source, Task &task);

    /* Parts that are no longer than `speck` need not be in a level. */
    bool is_shown(uint32_t triangle, double speck) const;
    /* Whether none of it is longer. */
    bool is_speck(double speck) const { return largest_part_ <= speck; }
    uint32_t patch_of(uint32_t triangle) const { return patch_[surface_.given(triangle)]; }
    const SortedSurface &surface() const { return surface_; }

private:
    const Vector<uint32_t> &patch_;
    SortedSurface surface_;
    Vector<double> parts_;       /* how long the connected part of each triangle given is */
    double largest_part_;
};

/* What of a mesh becomes a level, and which triangles of it that is. */
struct LevelSurface {
    Vector<uint32_t> number;
    SortedSurface surface;

    /* `before`, or null, is what it was until a few of its triangles changed. */
    LevelSurface(const LevelMesh &mesh, const Lattice &lattice, const LevelSurface *before,
                 Task &task);
    uint32_t of_mesh(uint32_t triangle) const { return number[surface.given(triangle)]; }
};

/* A level, and how far its triangles and the source are from each other. Every point of the source
 * is within `from_source` of some triangle that says so; all of a triangle is within `to_source` of
 * the source. */
struct BoundedLevel {
    std::unique_ptr<const LevelSurface> level;
    std::unique_ptr<Reached> from_source, to_source;
};

/* Bounds a level while it is mended. */
class LevelBound {
public:
    /* `finer` is that before it, or null. All outlive it. */
    LevelBound(const BoundSource &source, const LevelMesh &mesh, const Lattice &lattice,
               double speck, const BoundedLevel *finer, Task &task);

    /* Of all. */
    Strayed whole();
    /* What of the source is farther from it than `least`, and much farther than the rest. */
    Spots spots(double least);
    /* What of it is farther from the source than `least`. */
    Spots spots_of(double least);
    /* A bound, after what lay there was changed: of the source, and of the level where they were
     * of that, if it was bounded elsewhere by as much as theirs. */
    double after(const Spots &spots, const Vector<Corners> &changed);
    /* At last, with what was found. */
    BoundedLevel bounded(double away) &&;

private:
    bool is_shown(uint32_t t) const { return source_.is_shown(t, speck_); }
    void change();
    Few few_of_source(double within);
    Few few_of_level(double within);

    const BoundSource &source_;
    const LevelMesh &mesh_;
    const Lattice &lattice_;
    const double speck_;
    const BoundedLevel *finer_;
    Task &task_;
    std::unique_ptr<const LevelSurface> level_;
    std::unique_ptr<Reached> from_source_;
    std::unique_ptr<Reached> to_source_; /* infinite where it is not known yet */
    Vector<float> of_finer_;     /* as in Overlay, of the finer level or of the source */
};

} // namespace gtx::baking
