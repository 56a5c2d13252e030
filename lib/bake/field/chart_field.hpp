/* The height field of a chart over its working grid, and the steps that make it. */
#pragma once

#include "bake/budget.hpp"
#include "bake/field/patch.hpp"

namespace gtx::baking {

/* Whether a cell with this signed distance at a corner can show: bilinear trim is nowhere in a cell
 * below its least corner, and codes round to 1/32. */
inline bool shown(float trim)
{
    return trim <= float(GTX_TRIM_SHOWN + 0.5 / GTX_TRIM_TEXEL);
}

/* Texels of depth between neighbouring texels that are a depth discontinuity, unless the surface is
 * seen to lead from one to the other: they may lie on two height fields, side by side only in
 * projection. Charts are cut where a step of 6 texels parts them (chart/layers.cpp): there a wall
 * taken for a discontinuity costs a patch, here one cell. Measured on Spot's control mesh: at half
 * 9 % more patches, and 4 holes in the truck; at double 12 % more texels. */
constexpr double JUMP = 4;

/* Whether the source leads from one place of a chart to another without a detour, be it over
 * triangles that the chart does not have: a steep wall is no discontinuity. */
class Paths {
public:
    Paths(const Mesh &mesh, const Neighbours &neighbours, const FlatChart &chart)
        : mesh_(mesh), neighbours_(neighbours), chart_(chart),
          budget_(STEPS * double(chart.grid.texels()) + STEPS_OF_ALL / double(chart.of))
    {
    }

    /* Whether edges lead from triangle `from` of the chart to `to` over triangles whose boxes come
     * into the square of `reach` texels around (u, v); or over edges that do, for the box around a
     * large triangle reaches far. */
    enum Ways { OVER_TRIANGLES, OVER_EDGES };
    bool joined(uint32_t from, uint32_t to, double u, double v, double reach,
                Ways ways = OVER_TRIANGLES);

private:
    /* A limit on time: triangles that all searches look at for a texel, and in all beyond that. An
     * engine of 82 nodes takes up to 352 for a texel of a chart, others 59. */
    static constexpr double STEPS = 512, STEPS_OF_ALL = 1 << 26;
    const Mesh &mesh_;
    const Neighbours &neighbours_;
    const FlatChart &chart_;
    /* A triangle of the source that a search has come to, in texels, and the box around it. */
    struct Place {
        double corner[3][2], low[2], high[2];
        uint32_t triangle;
        uint32_t near[3];        /* places across its edges; UNKNOWN until a search needs them */
        uint32_t seen;           /* by the search of this number, last */
    };
    static constexpr uint32_t UNKNOWN = 0xfffffffeu;
    /* Where to look, from where. */
    struct Window {
        uint32_t from = NO_TRIANGLE;
        double u = 0, v = 0, reach = 0;
        Ways ways = OVER_TRIANGLES;

        bool operator==(const Window &other) const
        {
            return from == other.from && u == other.u && v == other.v && reach == other.reach &&
                   ways == other.ways;
        }
        bool misses(const Place &place) const
        {
            return !(place.low[0] <= u + reach) || !(place.high[0] >= u - reach) ||
                   !(place.low[1] <= v + reach) || !(place.high[1] >= v - reach);
        }
        /* Whether a way may lead across a side. */
        bool lets_cross(const Place &place, size_t side) const
        {
            return ways == OVER_TRIANGLES ||
                   meets(place.corner[side], place.corner[(side + 1) % 3]);
        }
        /* Whether the line from one point to another comes into the square. */
        bool meets(const double begin[2], const double end[2]) const;
    };
    /* What is found from one end of a way, those before `next` with all around them. */
    struct End {
        uint32_t search = 0;
        size_t next = 0;
        Vector<uint32_t> queue;
    };
    uint32_t place_of(uint32_t triangle);
    uint32_t near(uint32_t place, size_t side);
    void grow_table();
    void begin(End &end, uint32_t place);
    Vector<Place> places_;
    Vector<uint32_t> table_;    /* places, hashed by the triangle; a power of two */
    Window window_;             /* of what the first end has found */
    End ends_[2];
    uint32_t searches_ = 0;
    Budget budget_;
};

/* What lies at each texel centre of the grid. */
struct Cover {
    Vector<double> height;          /* c, where covered */
    Vector<uint32_t> triangle;      /* index in FlatChart::triangles, NO_TRIANGLE where empty */
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
    Vector<OutlineEdge> edges;
    Vector<uint32_t> nearest;       /* edge, per texel */
    Vector<float> distance;         /* to it, in texels, unsigned; exact up to two texels */
};

/* The core as a GPU has drawn it, and what it has made there of the triangles' corners. */
struct Rendering {
    Vector<uint32_t> triangle;      /* index in FlatChart::triangles, NO_TRIANGLE where empty */
    Vector<Vec3f> normal;           /* object space, unit; zero where the corners' cancel out */
    Vector<std::array<float, 4>> color;      /* linear */
};

struct ChartField {
    FlatChart flat;
    Rendering rendering;            /* empty without a GPU */
    Outline outline;
    Cover cover;
    Vector<float> trim;             /* signed distance to the outline, in texels */
    Vector<uint8_t> support;        /* texels that need a code */
    Vector<double> ceiling;         /* how high each height may rise, whatever raises it */
};

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

/* Centre samples of the core, topmost first. */
Cover raster_core(const FlatChart &chart);
/* The same of a rendering: a GPU tells which triangle is topmost; how high it is there follows
 * exactly. */
Cover core_of(const FlatChart &chart, const Rendering &rendering);
/* Adds the overlap at texels the core left empty, where it continues the core's border. */
void raster_overlap(const FlatChart &chart, const Outline &core, Paths &paths, Cover &cover);

/* The outline of the first `count` triangles */
Outline find_outline(const Neighbours &neighbours, const FlatChart &chart, size_t count);
/* The nearest point of an edge to (u, v): its parameter, 0 at `from` and 1 at `to`. */
double nearest_parameter(const OutlineEdge &edge, double u, double v);
/* Finds what of `outline` follows from its edges. */
void measure_distances(const Grid &grid, size_t charts, Outline &outline);
/* Signed distances to the outline of the true surface, per texel, in texels; `sharp` as of a job.
 */
Vector<float> trim_distances(const FlatChart &chart, const Cover &core, const Cover &all,
                             const Outline &core_outline, const Outline &all_outline, bool sharp);
/* Lets the trim end where the surface's material is cut away, too. */
void trim_mask(const Mesh &mesh, const Neighbours &neighbours, const FlatChart &chart,
               Vector<float> &trim);

/* What ends at each edge of the outline; adds what is known of creases among those that are nearest
 * to a texel. */
Vector<Ending> find_endings(const Job &job, const ChartField &field, Vector<Crease> &creases);

/* Which texels need a code: the corners of every cell where a hit may be shown. */
Vector<uint8_t> find_support(const Grid &grid, const Vector<float> &trim);
/* Gives every supported texel that nothing covers the height of the surface continued there. */
void extrapolate(Paths &paths, ChartField &field);
/* Lets texels beyond the core continue it, then takes texels out of the support, until no cell that
 * shows bridges a depth discontinuity. */
void cut_discontinuities(const Outline &core, Paths &paths, ChartField &field);
/* Moves the heights of the supported texels so that the height field between them follows the
 * source, and finds their ceilings. Returns the share of the core's samples that it still passes
 * below by a visible part of a texel. */
double fit_heights(const Job &job, ChartField &field);

} // namespace gtx::baking
