/* The frustum of a view: which boxes are in it, and how large an error is on its screen. */
#ifndef GTX_STREAM_FRUSTUM_H
#define GTX_STREAM_FRUSTUM_H

#include <geotex/stream.h>

#include <stdbool.h>

/* Linear functions of the tiles' coordinates. */
typedef struct gtx_stream_frustum {
    double side[4][4];        /* side planes, above 0 inside */
    double w[4];              /* clip w */
    double at[3];             /* position of the eye, if the view is a perspective */
    bool perspective;
    double least;             /* least w in the picture at distance 1 from the eye */
    double pixels;            /* size on screen of a length of 1 at w = 1 */
} gtx_stream_frustum;

/* Errors: ARGUMENT, NOT_ZEROED. */
gtx_result gtx_stream_frustum_of(const gtx_stream_view *view, gtx_stream_frustum *out,
                                 gtx_error *error);

bool gtx_stream_frustum_sees(const gtx_stream_frustum *frustum, const double low[3],
                             const double high[3]);

/* An upper bound, in pixels, of the size on screen of a length anywhere in the box. Infinite if the
 * eye is in the box, unless the length is 0. */
double gtx_stream_frustum_pixels(const gtx_stream_frustum *frustum, const double low[3],
                                 const double high[3], double length);

#endif
