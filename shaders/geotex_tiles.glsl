/* Instances cast by tiles: what the kernel and the resolving stages know of one.
 *
 * t is the same along the rays of all patches: w of clip space, or for an orthographic camera how far
 * behind the plane that rays begin on. Pixels count from the viewport's corner. Needs
 * geotex_dialect.glsl, geotex_sheet.glsl and geotex_view.glsl before it. */
uniform vec4 gtx_place[12];  /* 0..2: rows of the linear part of world -> object;
                                3: the rays' origin in object space, 4, 5: what a pixel in x and in y
                                adds, to the direction of a perspective camera's rays, to the origin of
                                an orthographic one's; 6: direction;
                                7: the same four of clip z; x, y of 8: of clip w, origin and direction;
                                z, w of 8: size of the viewport, in pixels;
                                9..11: rows of object -> world */

struct gtx_line {
    vec3 origin, direction;
};

/* The ray through a point of the viewport, from the columns of gtx_place[3..6] taken to some space. */
gtx_line gtx_line_of(vec2 pixel, vec3 origin, vec3 x, vec3 y, vec3 direction)
{
    vec3 aside = x * pixel.x + y * pixel.y;
    return gtx_line(origin + (1.0 - gtx_depth.w) * aside, direction + gtx_depth.w * aside);
}

/* z and w of the clip position at t = 0, and what t adds. */
void gtx_clip_along(vec2 pixel, out vec2 zw, out vec2 zw_step)
{
    vec4 z = gtx_place[7];
    float aside = dot(z.yz, pixel);
    zw = vec2(z.x + (1.0 - gtx_depth.w) * aside, gtx_place[8].x);
    zw_step = vec2(z.w + gtx_depth.w * aside, gtx_place[8].y);
}
