/* Codes of the trim, and layouts of the records that shaders read from textures, as offsets in
 * texels. C includes this file, too. Comes after geotex_dialect.glsl. */

/* As in lib/asset/patch.h: where C sees both, the compiler tells whether they differ. */
#define GTX_TRIM_OUTLINE 128             /* the outline's code */
#define GTX_TRIM_TEXEL 16                /* codes a texel */
#define GTX_TRIM_SHOWN 0.3               /* texels outside the outline that show, at level 0 */

#define GTX_BLOCK_CELLS 8                /* along the side of a block */

/* In gtx_cells level 1 lies below level 0, or beside it where the page has more rows than so many,
 * and the coarser ones below both, side by side: no texture of a page of 4096 x 4096 texels is
 * larger than 8192 a side. */
#define GTX_HIGH_PAGE 3276

/* A patch, in gtx_patches. A texel's w has a name of its own where it says something else. */
#define GTX_RECORD_TO_GRID 0             /* 3: rows of object space -> grid space */
#define GTX_RECORD_ORIGIN 3              /* of grid space in object space */
#define GTX_RECORD_LOW_Z 3               /* w: of the box, in grid space */
#define GTX_RECORD_AXIS_X 4              /* axes of grid space in object space */
#define GTX_RECORD_HIGH_Z 4              /* w */
#define GTX_RECORD_AXIS_Y 5
#define GTX_RECORD_PAGE 5                /* w */
#define GTX_RECORD_AXIS_Z 6
#define GTX_RECORD_TWO_SIDED 6           /* w: 1, or 0 */
#define GTX_RECORD_RECT 7                /* x, y, width, height in the page */
#define GTX_RECORD_REACH 8               /* 2: of the hulls' rays, a component a level */
#define GTX_RECORD_SOLID 10              /* the solid cells: least x, y, greatest x, y */
#define GTX_RECORD_SLABS 11              /* 2: where the slabs of a level begin, a component each */
#define GTX_RECORD_DEVIATION 13          /* 2: how far normals stray, a component a mip level */
#define GTX_RECORD_TEXELS 16             /* one is left over */
#define GTX_PATCHES_ROW_BITS 11          /* texels of gtx_patches are counted through its rows */

/* A slab, in gtx_patches behind the records, one for each block of a patch's level, in rows: how it
 * rises along x and y, and its least and greatest height over (0, 0). */

/* gtx_place: an instance and the camera, for casting by tiles. The first four are rays in object
 * space: X and Y are what a pixel adds, to the direction of a perspective camera's rays, to the
 * origin of an orthographic one's. */
#define GTX_PLACE_ORIGIN 0
#define GTX_PLACE_COLUMNS 0              /* w: tiles a row of the rectangle of tiles */
#define GTX_PLACE_X 1
#define GTX_PLACE_HEADS 1                /* w: texels before the heads */
#define GTX_PLACE_Y 2
#define GTX_PLACE_FIRST_COLUMN 2         /* w: of the rectangle */
#define GTX_PLACE_DIRECTION 3
#define GTX_PLACE_FIRST_ROW 3            /* w */
#define GTX_PLACE_CLIP_Z 4               /* the same four of clip z: origin, x, y, direction */
#define GTX_PLACE_CLIP_W 5               /* x, y: of clip w, origin and direction */
#define GTX_PLACE_VIEWPORT 5             /* z, w: its size, in pixels */
#define GTX_PLACE_WORLD 6                /* 3: rows of object -> world */
#define GTX_PLACE_ROWS 9

/* A patch in gtx_stream: the rays' origin, direction, x and y of gtx_place, taken to grid space,
 * and the columns that take its normals to the world. */
#define GTX_TILE_PATCH_RAYS 0            /* 4 */
#define GTX_TILE_PATCH_NORMALS 4         /* 3 */
#define GTX_TILE_PATCH_FIELD 0           /* 3, w: what follows, here and beside the normals */
#define GTX_TILE_FIELD_CORNER 0          /* x + 2^16 y */
#define GTX_TILE_FIELD_SIZE 1            /* width + 2^16 height */
#define GTX_TILE_FIELD_PAGE 2            /* page + 2^24 level + 2^31 two-sided */
#define GTX_TILE_LEVEL_SHIFT 24
#define GTX_TILE_TWO_SIDED_SHIFT 31
#define GTX_TILE_PATCH_INDEX 7           /* x */
#define GTX_TILE_PATCH_VOLUME 7          /* y: that direction, x and y of the rays span */
#define GTX_TILE_PATCH_DEVIATION 7       /* z: of mip levels 1 to 4, w: from 5 on, bytes */
#define GTX_TILE_PATCH_TEXELS 8

/* A slab in gtx_stream: for each pair of its planes a linear function of the pixel, and how the
 * second plane follows from the first (gtx_meets). */
#define GTX_TILE_SLAB_PLANES 0           /* 3 */
#define GTX_TILE_SLAB_CELLS 3            /* x: first, y: last, as x + 2^16 y; z: its patch */
#define GTX_TILE_SLAB_TEXELS 4

/* gtx_ray_nodes: a head, nodes and instances; for each asset its nodes and height fields. */
#define GTX_RAY_HEAD_TEXELS 1            /* x: end of the nodes over instances; y: offset */
#define GTX_RAY_NODE_LOW 0               /* w: texel behind the subtree; of a leaf, the block */
#define GTX_RAY_NODE_HIGH 1              /* w: -1; of a leaf, the instance or height field */
#define GTX_RAY_NODE_TEXELS 2
#define GTX_RAY_INSTANCE_TO_OBJECT 0     /* 3: rows of world -> object */
#define GTX_RAY_INSTANCE_NODES 3         /* x, y: first texel and end of its asset's nodes */
#define GTX_RAY_INSTANCE_TEXELS 4
#define GTX_RAY_FIELD_TO_GRID 0          /* 3: rows of object space -> grid space */
#define GTX_RAY_FIELD_CELLS 3            /* width, height, first texel / 256, two-sided */
#define GTX_RAY_FIELD_TEXELS 4
#define GTX_RAY_FIELD_ALIGN 256
#define GTX_RAY_BLOCK_BITS 11            /* a block: x + 2^11 y */
#define GTX_RAY_ROW_BITS 10              /* 1024 texels a row of any of the textures */
#define GTX_RAY_LAYER_BITS 10            /* 1024 rows a layer */
