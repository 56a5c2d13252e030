/* Pipelines: one for each draw technique, pass and kind of material that needs its own. */
#ifndef GTX_FRAME_PIPELINES_H
#define GTX_FRAME_PIPELINES_H

#include <geotex/frame.h>
#include <stdbool.h>

/* How fragments come about: by casting in the proxy of a patch, exactly or by the paper's search;
 * by casting in a tile; or by polygons. */
typedef enum gtx_technique {
    TECHNIQUE_CAST,
    TECHNIQUE_BOX,            /* the same in boxes, skipping by slabs */
    TECHNIQUE_PAPER,
    TECHNIQUE_TILES,
    TECHNIQUE_LOD,
    TECHNIQUE_LOD_FRONT,      /* front faces alone, under transforms that keep angles */
    TECHNIQUE_LOD_SINGLE,     /* depth of one instance, whose transform is a uniform */
    TECHNIQUE_LOD_LIT,        /* lit at vertices, both sides in one pass */
    TECHNIQUE_GRID,           /* triangles of a displaced grid that do not show whole */
    TECHNIQUE_GRID_FRONT,
    TECHNIQUE_GRID_WHOLE,     /* those that do */
    TECHNIQUE_GRID_WHOLE_FRONT,
    TECHNIQUE_GRID_LIT,       /* those lit at their vertices */
    TECHNIQUE_GRID_WHOLE_LIT,
    TECHNIQUE_BLOCKS,         /* grids again, whose nodes fetch their heights */
    TECHNIQUE_BLOCKS_FRONT,
    TECHNIQUE_BLOCKS_WHOLE,
    TECHNIQUE_BLOCKS_WHOLE_FRONT,
    TECHNIQUE_OWN_CAST,       /* by an engine's own main */
    TECHNIQUE_OWN_LOD,
    TECHNIQUE_OWN_LOD_NORMALS,  /* with those of vertices; both sides in one pass */
    TECHNIQUE_OWN_LOD_LIT,    /* with colours of vertices: front faces alone of one instance */
    TECHNIQUE_OWN_GRID,
    TECHNIQUE_OWN_GRID_NORMALS, /* those that show whole, with normals of vertices */
    TECHNIQUE_OWN_GRID_LIT,     /* with colours of vertices */
    TECHNIQUE_OWN_GRID_WHOLE_LIT,
    TECHNIQUE_OWN_BLOCKS,
    TECHNIQUE_OWN_TILES,
    TECHNIQUE_COUNT
} gtx_technique;

/* What a model's surface is shaded by. */
typedef enum gtx_material_kind {
    MATERIAL_NONE,            /* Lambert, of the instance's tint */
    MATERIAL_COLORS,          /* Lambert, of the map of colours */
    MATERIAL_MAPS,            /* metallic-roughness, or emission */
    MATERIAL_CONSTANT,        /* metallic-roughness, the same all over, without emission */
    MATERIAL_COUNT
} gtx_material_kind;

enum { GTX_PASS_COUNT = GTX_PASS_GBUFFER + 1, GTX_MAX_LABEL = 64 };

/* The number of what draws a material by a technique in a pass; that of gtx_pipeline_get. */
uint32_t gtx_pipeline_of(gtx_technique technique, gtx_pass pass, gtx_material_kind material);
gtx_technique gtx_pipeline_technique(uint32_t pipeline);
/* Whether it displaces grids on the CPU, or blocks on the GPU. */
bool gtx_technique_is_grid(gtx_technique technique);
bool gtx_technique_is_blocks(gtx_technique technique);
/* Whether an engine's own text gives colours at vertices. */
bool gtx_technique_is_at_vertices(gtx_technique technique);
/* Whether a technique has a forward pass. */
bool gtx_technique_is_forward(gtx_technique technique);
void gtx_pipeline_label(uint32_t pipeline, char label[GTX_MAX_LABEL]);

#endif
