/* The inside of a gtx_solid: weighted triangles, in groups that are the leaves of a hierarchy. */
#ifndef GTX_TRACE_SOLID_H
#define GTX_TRACE_SOLID_H

#include <geotex/solid.h>

#include "base/jobs.h"
#include "trace/caster.h"

/* A triangle of a cell, counter-clockwise seen from outside. Where patches overlap, the weights of
 * what lies above each other are 1 together. */
typedef struct gtx_element {
    float corner[3][3];
    float depth[3];             /* texels inside the outline */
    float weight;
} gtx_element;

/* The elements of up to GTX_GROUP x GTX_GROUP cells of a patch. */
enum { GTX_GROUP = 4 };
typedef struct gtx_group {
    uint32_t first, count, patch;
} gtx_group;

/* What all elements of a node look like from afar: to the second order around `centre`. */
typedef struct gtx_solid_moments {
    double centre[3], radius;
    double area, normal[3];     /* sums of weighted areas, and of these times the unit normals */
    double spread[3][3];        /* sums of normal i times the offset j from the centre */
} gtx_solid_moments;

struct gtx_solid {
    gtx_allocator allocator;
    gtx_caster *caster;
    gtx_element *elements;
    gtx_group *groups;
    size_t element_room;
    uint32_t element_count, group_count;
    gtx_hierarchy tree;         /* over groups */
    gtx_solid_moments *moments;       /* of each node */
    gtx_solid_facts facts;
};

/* solid.c: what preparing or combining assets of so many texels may take. */
gtx_budget gtx_solid_budget(const gtx_limits *limits, uint64_t texels);
uint64_t gtx_solid_texels(const gtx_asset *asset);

/* elements.c: the elements of an asset in groups, their boxes, and their weights.
 * Errors: MEMORY, LIMIT. */
gtx_result gtx_elements_build(gtx_solid *solid, const gtx_asset *asset, const gtx_jobs *jobs,
                              const gtx_limits *limits, gtx_budget *budget, gtx_error *error);

/* winding.c: adds the nodes and triangles that were looked at to *steps. */
gtx_result gtx_winding_build(gtx_solid *solid, gtx_error *error);
double gtx_winding_at(const gtx_solid *solid, const double point[3], uint64_t *steps);
/* Whether any of the surface may be in a box. */
bool gtx_solid_meets(const gtx_solid *solid, const gtx_box *box);

#endif
