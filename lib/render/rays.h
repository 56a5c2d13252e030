/* The inside of gtx_rays, for the files that fill it. */
#ifndef GTX_RENDER_RAYS_H
#define GTX_RENDER_RAYS_H

#include "derive/placement.h"
#include "geotex_records.glsl"
#include "render/gl.h"
#include "frame/units.h"

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

struct gtx_rays {
    gtx_allocator allocator;
    gtx_ray_member *members;
    uint32_t member_count, max_instances;
    uint32_t bits;            /* of all cells */
    size_t nodes, cells;      /* texels of the textures, whole rows and layers */
    gl_uint textures[GTX_RAY_TEXTURES];
    /* The front of the nodes' texture, for instances, and scratch for it. */
    size_t front_texels;
    float (*front)[4];
    gtx_box *boxes;
    gtx_placement *places;
};

/* rays_textures.c: makes the textures; `cells` and `trim` are all of theirs. Errors: LIMIT, GL. */
gtx_result gtx_rays_upload(const gtx_gl *gl, gtx_rays *rays, const void *cells, const void *trim,
                           gtx_error *error);
/* Sends `count` texels, from texel `first` of a texture on. Leaves unpacking and unit 0 as
 * gtx_rays_leave finds them. */
void gtx_rays_send(const gtx_gl *gl, const gtx_rays *rays, gtx_ray_texture texture, size_t first,
                   size_t count, const void *data);
/* Tells the program in use where gtx_rays_bind binds. */
void gtx_rays_locate(const gtx_gl *gl, gl_uint program);
/* Leaves units and unpacking as gtx_model_upload does. */
void gtx_rays_leave(const gtx_gl *gl);

#endif
