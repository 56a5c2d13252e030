/* Rays in shaders, by OpenGL. */
#ifndef GTX_RENDER_RAYS_H
#define GTX_RENDER_RAYS_H

#include "frame/rays.h"
#include "render/gl.h"

/* Tells the program in use where gtx_rays_bind binds. */
void gtx_rays_locate(const gtx_gl *gl, gl_uint program);

#endif
