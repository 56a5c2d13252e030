/* Rays in shaders: what the textures of gtx_rays hold, and the hierarchies over blocks and
 * instances. */
#ifndef GTX_FRAME_RAYS_H
#define GTX_FRAME_RAYS_H

#include "derive/placement.h"
#include "geotex_records.glsl"

#include <geotex/rays.h>
#include <stdbool.h>

/* Texels of a row of any of the textures, and rows of a layer. */
enum { GTX_RAY_ROW = 1 << GTX_RAY_ROW_BITS, GTX_RAY_LAYER_ROWS = 1 << GTX_RAY_LAYER_BITS };

/* A height field's record, as geotex_records.glsl lays it out. */
typedef float gtx_ray_field[GTX_RAY_FIELD_TEXELS][4];

typedef enum gtx_ray_texture {
    GTX_RAY_NODES, GTX_RAY_CELLS, GTX_RAY_TRIM, GTX_RAY_TEXTURES
} gtx_ray_texture;

/* An asset of the set. */
typedef struct gtx_ray_member {
    uint64_t layout;          /* gtx_model_layout of it */
    uint32_t height_bits, patch_count;
    double offset;            /* gtx_ray_offset */
    /* Blocks of its cells: their boxes, and what the leaves of its nodes say: block in the height
     * field, height field. */
    gtx_box *boxes;
    float (*blocks)[2];
    uint32_t block_count;
    gtx_ray_field *fields;
    gtx_box box;              /* around all */
    size_t nodes, end;        /* texels of its hierarchy; its height fields follow */
    /* Nodes and height fields, from when they are derived until they are sent. */
    float (*fresh)[4];
    bool edited;              /* its nodes are not those of its boxes */
} gtx_ray_member;

/* Cells and trim of patches, one after the other. */
typedef struct gtx_ray_maps {
    uint8_t *cells, *trim;
} gtx_ray_maps;

struct gtx_rays {
    gtx_allocator allocator;
    gtx_ray_member *members;
    uint32_t member_count, max_instances;
    uint32_t bits;            /* of all cells */
    size_t nodes, cells;      /* texels of the textures, whole rows and layers */
    gtx_ray_maps maps;        /* `cells` texels, until they are uploaded */
    uint32_t textures[GTX_RAY_TEXTURES]; /* names in OpenGL */
    /* The front of the nodes' texture, for instances, and scratch for it. */
    size_t front_texels;
    float (*front)[4];
    gtx_box *boxes;
    gtx_placement *places;
};

/* rays.c: frees the maps of all patches. */
void gtx_rays_free_maps(gtx_rays *rays);

/* A patch of an edited asset: where its texels begin, how many there are, and their maps, which
 * gtx_rays_free_patch gives back. */
typedef struct gtx_ray_patch {
    size_t first, texels;
    gtx_ray_maps maps;
} gtx_ray_patch;
/* Errors: ARGUMENT, MEMORY: then nothing has changed. */
gtx_result gtx_rays_derive_patch(gtx_rays *rays, uint32_t asset, const gtx_asset *edited,
                                 uint32_t patch, gtx_ray_patch *out, gtx_error *error);
void gtx_rays_free_patch(const gtx_rays *rays, gtx_ray_patch *patch);

/* rays_place.c: fills the front for these instances, and `fresh` of those members whose nodes are
 * not those of their boxes. *texels becomes how many texels of the front there are. Errors:
 * ARGUMENT, MEMORY. */
gtx_result gtx_rays_plan(gtx_rays *rays, const gtx_ray_instance *instances, uint32_t count,
                         size_t *texels, gtx_error *error);
size_t gtx_ray_fresh_texels(const gtx_ray_member *member);
/* Frees what is fresh; where it was sent, it is so no more. */
void gtx_rays_planned(gtx_rays *rays, bool sent);

#endif
