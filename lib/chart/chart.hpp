/* Charts: sets of triangles, each with the frame in which it is a height map.
 *
 * What this room's constants do at half and at double was measured on the bunny, Spot's control
 * mesh, Duck and CesiumMilkTruck, cooked by default; VSA and PGP on the bunny, Spot and the truck.
 * Comments tell the largest change and the model that had it; a limit or a guard is not tuned. */
#pragma once

#include "mesh/mesh.hpp"

namespace gtx {

/* A right-handed parallelepiped. z is the direction of projection; x and y may tilt against it
 * (paper, section 4.2: "parallel hexahedron"). A point is origin + a x + b y + c z. */
struct Frame {
    Vec3d origin;                /* corner of the core's rectangle at its lowest depth */
    Vec3d x, y, z;               /* unit length, det(x, y, z) >= 0.1 */
    double extent[3] = {0, 0, 0}; /* of the core along x, y, z; extent[2] may be zero */

    /* (a, b, c) of a point. */
    Vec3d local(const Vec3d &point) const;
    Vec3d point(const Vec3d &local) const
    {
        return origin + x * local.x + y * local.y + z * local.z;
    }
};

struct Chart {
    /* The triangles whose surface is the core, ascending. */
    Vector<uint32_t> triangles;
    Frame frame;
    bool two_sided = false;
    /* Straight cuts along the frame's x and y, object units: the core is the part of the triangles
     * inside. Charts cut from a larger one share its axis, and the triangles that the cuts cross;
     * the height field continues across the cut. */
    double clip_low[2] = {-INFINITY, -INFINITY}, clip_high[2] = {INFINITY, INFINITY};
    /* Texels of the grid along the frame's sides; 0 = as many as the pitch gives. */
    unsigned cells[2] = {0, 0};
    double finer = 1;            /* as many times finer texels, for what its textures show */
    /* Source triangles with their centre in the core; one that PGP cut counts with its first
     * piece. */
    uint64_t source_triangles = 0;
};

enum class PartitionMethod {
    CUTS, /* few large charts that fold nowhere, cut straight */
    VSA,  /* variational shape approximation (paper, section 5.2) */
    PGP,  /* periodic global parameterization (paper, section 5.1) */
    LAYERS, /* peeled along three axes (Santos, de Toledo, Gattass, SPM 2008) */
    RELIEF, /* seen from six sides (Oliveira, Bishop, McAllister, SIGGRAPH 2000) */
    AUTO, /* CUTS or LAYERS, whichever takes fewer texels; LAYERS of finer ones where outlines
             need them */
    DEFAULT /* CUTS, but LAYERS of finer texels where outlines need them */
};

/* Whether it is one of two others, which its partition tells. */
inline bool chooses(PartitionMethod method) { return method >= PartitionMethod::AUTO; }

struct ChartOptions {
    PartitionMethod method = PartitionMethod::CUTS;
    unsigned charts = 0;         /* wanted number; 0 = round(10 T^0.28) for T triangles */
    bool adaptive = false;       /* PGP: smaller cells where the surface is more curved */
    unsigned resolution = 128;   /* most texels along a patch side */
    bool free_resolution = false; /* AUTO, DEFAULT: where outlines need it, up to twice as many */
    double pitch = 0;            /* texel pitch for CUTS, object units; 0 = what gives patches
                                    their texels at this resolution */
    unsigned grain = 8;          /* sides will be multiples of as many texels */
    double height_steps = 254;   /* that a patch's heights will have from lowest to highest */
    bool one_density = false;    /* CUTS: texels alike in all patches, as the paper has them */
    double texel_density = 0;    /* texels for a pixel of the source's textures, along a side, at
                                    least; 0 = as many as show what they show; < 0: none for
                                    them */
    /* Texels that a patch needs beyond its core: at a straight cut, and where its chart ends. */
    unsigned overlap[2] = {1, 2};
};

/* What partitioning found, for the cook report. */
struct ChartReport {
    /* Of the partition before folding charts were split (paper, Table 3). */
    uint64_t initial_charts = 0, initial_inverted = 0, initial_folding = 0;
    /* Of the final charts: core triangles with n.z <= 0 and more than a texel of projected area,
     * without junk; charts that hold one. */
    uint64_t inverted_triangles = 0, folding_charts = 0;
    double second_layer_fraction = 0; /* share of core texels with a second layer */
    uint64_t junk_triangles = 0;      /* scan noise: small and twisted against its neighbours */
    double junk_area_fraction = 0;
    uint64_t unseen_triangles = 0;    /* RELIEF: what no chart has */
    double unseen_area_fraction = 0;
    double area = 0, edge_length = 0; /* object units; of borders and edges sharper than 60
                                         degrees, each a third of its triangle's outline */
};

/* Triangles here are those of charted(). */
struct Partition {
    Vector<Chart> charts;
    /* PGP cuts triangles where charts end; empty where the charts are of the source's own. */
    Mesh mesh;
    Vector<uint32_t> source;             /* per triangle of `mesh`: that of the source, ascending */
    PartitionMethod method = PartitionMethod::CUTS; /* never AUTO or DEFAULT */
    unsigned resolution = 0;             /* most texels along a patch side */
    bool for_outlines = false;           /* layers and finer texels were taken for them */
    bool complete = true;                /* false: what no chart has is not to be shown */
    double pitch = 0;                    /* texel pitch of the model, object units */
    double more_texels = 1;              /* with what textures ask for, about; of relief's */
    Vector<uint32_t> initial_chart;      /* per triangle, before splitting */
    Vector<uint8_t> junk;                /* per triangle: 1 = junk */
    /* triangle_neighbours() of charted(), or empty: not known. */
    Vector<std::array<uint32_t, 3>> neighbours;
    ChartReport report;

    const Mesh &charted(const Mesh &source_mesh) const;
    /* Share of a silhouette that may miss the source's, 0..1: along borders and sharp edges an
     * outline is as sharp as texels are small. */
    double outline_loss() const;
    uint32_t source_of(uint32_t triangle) const
    {
        return source.empty() ? triangle : source[triangle];
    }
};

/* Clusters the triangles (on OpenMesh connectivity), splits clusters until none folds, and gives
 * each a frame (paper, section 5); CUTS then cuts them to the wanted number. Deterministic for any
 * thread count. Stages of `task`: "partition", "frame". Throws Error: EMPTY, LIMIT, CANCELLED. */
Partition make_partition(const Mesh &mesh, const ChartOptions &options, Task &task);

/* The surface that a chart's maps may show: its core and the source surface reached across its
 * border within `reach` object units (measured in the frame's (x, y) plane from the core's
 * outline) through edges, that faces the frame (n.z >= 0.2). Returns triangles beyond the core,
 * ascending. `neighbours` is triangle_neighbours(mesh). Const and reentrant. */
Vector<uint32_t> overlap_triangles(const Mesh &mesh,
                                   const Vector<std::array<uint32_t, 3>> &neighbours,
                                   const Chart &chart, double reach);

/* Writes the charted mesh with a colour a chart of the partition before splitting, inverted
 * triangles green (paper, Figure 5): binary PLY, through a temporary name beside it. Throws Error:
 * WRITE. */
void write_charts_ply(const std::string &path, const Mesh &mesh, const Partition &partition);

} // namespace gtx
