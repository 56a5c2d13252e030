/* The inside of this room: a chart laid out in texels, what is found there, the maps of it. */
#pragma once

#include "bake/bake.hpp"

#include <algorithm>
#include <unordered_set>

namespace gtx::baking {

/* A hit up to this many texels outside the outline belongs to the surface (format/gtx.md, Trim). */
constexpr double SHOWN = 0.3;
/* Whether a cell with this signed distance at a corner can show: bilinear trim is nowhere in a cell
 * below its least corner, and codes round to 1/32. */
inline bool shown(float trim)
{
    return trim <= float(SHOWN + 1.0 / 32);
}
/* Source surface beyond a chart's border counts as true up to this many texels from it. */
constexpr double OVERLAP = 1;
/* Where the model itself ends, up to this many texels beyond its border: nobody else's height field
 * starts there. */
constexpr double BORDER_SHOWN = 0.1;
/* Beyond a straight cut this is enough: the neighbour's height field is along the same axis, and
 * crosses it. */
constexpr double CUT_OVERLAP = 0.15;

/* Lengths of a record are floats, and readers square them. */
constexpr double MIN_DIAGONAL = 1e-15, MAX_DIAGONAL = 1e15;

using Neighbours = std::vector<std::array<uint32_t, 3>>;

/* The working grid of a chart: texel space (u, v, c), where texel (i, j) lies at u = i, v = j, and
 * c stays in object units along the frame's z. */
struct Grid {
    Vec3d origin;          /* of the frame */
    Vec3d dual[3];         /* reciprocal axes: local coordinate k is dot(dual[k], p - origin) */
    double pitch[2] = {};  /* object units a texel */
    double corner[2] = {}; /* local (a, b) of the outer corner of texel (0, 0) */
    int w = 0, h = 0;
    double clip_low[2] = {}, clip_high[2] = {}; /* of the core, texel space; infinite: none */

    /* How far (u, v) lies outside the straight cuts; negative inside. */
    double outside(double u, double v) const
    {
        return std::max(std::max(clip_low[0] - u, u - clip_high[0]),
                        std::max(clip_low[1] - v, v - clip_high[1]));
    }
    Vec3d texel(const Vec3d &point) const
    {
        Vec3d p = point - origin;
        return {(dot(dual[0], p) - corner[0]) / pitch[0] - 0.5,
                (dot(dual[1], p) - corner[1]) / pitch[1] - 0.5, dot(dual[2], p)};
    }
    double coarse_pitch() const { return pitch[0] > pitch[1] ? pitch[0] : pitch[1]; }
    size_t texels() const { return size_t(w) * h; }
};

/* A triangle of the chart (or of its overlap) in texel space. */
struct FlatTriangle {
    Vec3d corner[3];
    uint32_t source;       /* its index in the mesh */
    bool front;            /* faces the frame, so that it can be seen in the map */

    /* Twice its area in texels; negative where it faces away. */
    double signed_area() const
    {
        Vec3d e = corner[1] - corner[0], f = corner[2] - corner[0];
        return e.x * f.y - e.y * f.x;
    }
};

/* The true surface of a chart: first `core` triangles of its own, then those of its overlap. */
struct FlatChart {
    Grid grid;
    std::vector<FlatTriangle> triangles;
    size_t core = 0;
    /* mate[t][k] is the index here of the front-facing triangle across edge k, or NO_TRIANGLE. */
    Neighbours mate;
};

/* Lays a chart out at the model's pitch, or `finer` times as fine. */
FlatChart flatten(const Mesh &mesh, const Neighbours &neighbours, const Chart &chart, double pitch,
                  double finer);
/* The same triangles in another number of cells, those that the chart has now. */
void flatten_again(const Mesh &mesh, const Chart &chart, FlatChart &flat);

/* Texels of depth between neighbouring texels beyond which the surface must be seen to lead from
 * one to the other: they may lie on two height fields, side by side only in projection. */
constexpr double CLIFF = 4;

/* Whether the source leads from one place of a chart to another without a detour, be it over
 * triangles that the chart does not have: a steep wall is no cliff. */
class Paths {
public:
    Paths(const Mesh &mesh, const Neighbours &neighbours, const FlatChart &chart)
        : mesh_(mesh), neighbours_(neighbours), chart_(chart)
    {
    }

    /* Whether edges lead from triangle `from` of the chart to `to` inside the square of `reach`
     * texels around (u, v). */
    bool joined(uint32_t from, uint32_t to, double u, double v, double reach);

private:
    const Mesh &mesh_;
    const Neighbours &neighbours_;
    const FlatChart &chart_;
    std::unordered_set<uint32_t> seen_; /* by one search */
    std::vector<uint32_t> queue_;
};

/* What lies at each texel centre of the grid. */
struct Cover {
    std::vector<double> height;     /* c, where covered */
    std::vector<uint32_t> triangle; /* index in FlatChart::triangles, NO_TRIANGLE where empty */
};

/* The outline of a set of triangles: the edges where its front-facing surface ends, and for each
 * texel of the grid the nearest of them. */
struct OutlineEdge {
    Vec3d from, to;                 /* texel space */
    uint32_t triangle;
    int side;                       /* the edge from its corner `side` to the next */
    bool border;                    /* the model ends here */
};
struct Outline {
    std::vector<OutlineEdge> edges;
    std::vector<uint32_t> nearest;  /* edge, per texel */
    std::vector<float> distance;    /* to it, in texels, unsigned; exact up to two texels */
};
/* The nearest point of an edge to (u, v): its parameter, 0 at `from` and 1 at `to`. */
double nearest_parameter(const OutlineEdge &edge, double u, double v);

/* Centre samples of the core, topmost first. */
Cover raster_core(const FlatChart &chart);

/* The same as a GPU has drawn it, and what it has made there of the triangles' corners. */
struct Rendering {
    std::vector<uint32_t> triangle; /* index in FlatChart::triangles, NO_TRIANGLE where empty */
    std::vector<Vec3f> normal;      /* object space, unit; zero where the corners' cancel out */
    std::vector<std::array<float, 4>> color; /* linear */
};
/* Which triangle is topmost a GPU tells; how high it is there follows exactly. */
Cover core_of(const FlatChart &chart, const Rendering &rendering);
/* Adds the overlap at texels the core left empty, where it continues the core's border. */
void raster_overlap(const FlatChart &chart, const Outline &core, Paths &paths, Cover &cover);

/* The outline of the first `count` triangles. */
Outline find_outline(const Neighbours &neighbours, const FlatChart &chart, size_t count);

/* Finds what of `outline` follows from its edges. */
void measure_distances(const Grid &grid, Outline &outline);

/* A point of the true surface. */
struct SurfacePoint {
    uint32_t triangle;              /* of the chart */
    float weight[3] = {0, 0, 0};    /* of its corners */
};
/* The weights of a triangle's corners at (u, v). Outside of it, as a GPU's rounding of corners to
 * parts of a texel has it, those of a point on its edge: a sliver's plane leads anywhere. */
Vec3d weights_at(const FlatTriangle &triangle, double u, double v);

/* What lies at a texel: the point that covers it, else the nearest of the outline. */
SurfacePoint surface_point(const FlatChart &chart, const Outline &outline, const Cover &cover,
                           size_t texel);

/* Signed distances to the outline of the true surface, per texel, in texels. */
std::vector<float> trim_distances(const FlatChart &chart, const Cover &core, const Cover &all,
                                  const Outline &core_outline, const Outline &all_outline);

/* Lets the trim end where the surface's material is cut away, too. */
void trim_mask(const Mesh &mesh, const Neighbours &neighbours, const FlatChart &chart,
               std::vector<float> &trim);

/* Which texels need a code: the corners of every cell where a hit may be shown. */
std::vector<uint8_t> find_support(const Grid &grid, const std::vector<float> &trim);
/* Gives every supported texel that nothing covers the height of the surface continued there. */
void extrapolate(const FlatChart &chart, const Outline &outline, Paths &paths,
                 const std::vector<uint8_t> &support, Cover &cover);
/* Lets texels beyond the core continue it, then takes texels out of the support, until no cell that
 * shows bridges two height fields. */
void cut_cliffs(const FlatChart &chart, const Outline &core_outline, const Outline &outline,
                Paths &paths, std::vector<float> &trim, Cover &cover,
                std::vector<uint8_t> &support);

/* Moves the heights of the supported texels so that the height field between them follows the
 * source. Returns the share of the core's samples that it still passes below by a visible part of a
 * texel, `pitch` being the model's. */
double fit_heights(const FlatChart &chart, const std::vector<uint8_t> &support, double pitch,
                   Cover &cover);

using Levels = std::vector<std::vector<uint8_t>>;

/* The maps of one patch, `rect` still without its place on a page. */
struct PatchMaps {
    gtx_patch record = {};
    std::vector<uint16_t> height;             /* codes */
    std::vector<uint8_t> trim;
    std::vector<uint8_t> border;              /* the nearest outline is the model's own border */
    Levels normal;                            /* a level each, 2 bytes a texel */
    Levels color, material, emission;         /* 4, 4 and 3 bytes a texel, or none */
    Vec3d low, high;                          /* of the coded texels' points */
    uint64_t coded = 0;                       /* 0: nothing of the chart is there */
};

/* A vector as a record keeps it. */
inline void store(float out[3], const Vec3d &v)
{
    for (int k = 0; k < 3; ++k)
        out[k] = float(v[k]);
}

/* The part of a working grid that becomes the rectangle: its first texel may lie outside. */
struct Crop {
    int x = 0, y = 0, w = 0, h = 0;
};

/* What is seen at each texel of a level, before it is stored. */
struct Shades {
    int w, h, channels;
    std::vector<Vec3f> normal;                /* object space, unit */
    std::vector<float> values;                /* `channels` a texel: those that follow, if needed */
    std::vector<uint8_t> occupied;            /* has a shade */

    Shades(int w, int h, int channels)
        : w(w), h(h), channels(channels), normal(size_t(w) * h), values(normal.size() * channels),
          occupied(normal.size(), 0)
    {
    }
};
/* Floats of each kind: light and alpha; occlusion, roughness, metallic and lit; light. */
constexpr int COLOR_CHANNELS = 4, MATERIAL_CHANNELS = 4, EMISSION_CHANNELS = 3, MAX_CHANNELS = 11;

/* What every chart's bake reads. */
struct Job {
    const Mesh &mesh;
    const Neighbours &neighbours;
    const BakeOptions &options;
    AppearanceNeeds needs;
    double pitch;
    Vec3d anchor;
};

/* The height field of a chart over its working grid. */
struct HeightField {
    FlatChart flat;
    Rendering rendering;         /* empty without a GPU */
    Outline outline;
    Cover cover;
    std::vector<float> trim;
    std::vector<uint8_t> support;
};

/* The shades of the texels with a code. */
Shades shade_texels(const Job &job, const HeightField &field, const Crop &crop,
                    const std::vector<uint16_t> &height);

/* Fills empty texels ring by ring with the mean of the neighbours that the ring before had. */
void dilate(Shades &shades, unsigned rings);

/* Encodes shades as all levels of the maps that are needed, dilated. `patch` gives the axes and
 * dilation. */
void build_mips(Shades shades, unsigned mips, const AppearanceNeeds &needs, PatchMaps &patch);

PatchMaps bake_chart(const Job &job, const Chart &chart);

/* Lowers the trim of patches, those of `partition` in their order, that hide what no other shows;
 * returns charts of the surface that none of them has. */
std::vector<Chart> chart_unseen(const Job &job, const Partition &partition,
                                std::vector<PatchMaps> &patches, Task &task);

/* Moves heights around outlines until height fields that meet lie on each other; all patches have
 * codes. They are to be measured again then. */
void stitch(unsigned height_bits, std::vector<PatchMaps> &patches, Task &task);

/* Raises texels beyond straight cuts until the height fields on both sides cross; likewise.
 * `charts` is that of each patch. */
void close_cuts(const Partition &partition, const std::vector<uint32_t> &charts,
                const Vec3d &anchor, unsigned height_bits, std::vector<PatchMaps> &patches,
                Task &task);

/* Coverage, sphere and the box of the coded texels. */
void measure_patch(unsigned height_bits, PatchMaps &maps);
/* Trim where there is no height, by the rule that readers know. */
void fill_trim(PatchMaps &maps);
/* Signed distances to the outline in texels, as codes. */
uint8_t trim_code(float distance);
/* Puts them on the pages of one asset; those of an asset have the same kinds of maps. Anchor and
 * emission scale are left to the caller. Throws Error: LIMIT. */
Maps place_on_pages(std::vector<PatchMaps> &patches, const BakeOptions &options);

/* Places rectangles whose sides are multiples of `grain` on pages of one size, as full as it
 * can. */
struct Packing {
    struct Place {
        uint32_t page, x, y;
    };
    std::vector<Place> places;
    uint32_t page_count = 0, width = 0, height = 0;
};
Packing pack(const std::vector<std::array<uint32_t, 2>> &sizes, uint32_t grain);

} // namespace gtx::baking
