/* Rays in shaders, by OpenGL. */
#ifndef GTX_RENDER_RAYS_H
#define GTX_RENDER_RAYS_H

#include "frame/rays.h"
#include "render/gl.h"

/* rays_textures.c: makes the textures. Errors: LIMIT, GL. */
gtx_result gtx_rays_upload(const gtx_gl *gl, gtx_rays *rays, const gtx_ray_maps *maps,
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
