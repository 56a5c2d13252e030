/* What a view sees of boxes: whether, and how large an error is on its screen. */
#ifndef GTX_STREAM_EYE_H
#define GTX_STREAM_EYE_H

#include <geotex/stream.h>

#include <stdbool.h>

/* Linear functions over the tiles' coordinates. */
typedef struct gtx_stream_eye {
    double side[4][4];        /* inside is above 0 */
    double w[4];              /* of clip space */
    double at[3];             /* the eye, of a perspective view */
    bool perspective;
    double least;             /* of w, at distance 1 from the eye and within the picture */
    double pixels;            /* a length of 1 at w = 1 */
} gtx_stream_eye;

/* Errors: ARGUMENT, NOT_ZEROED. */
gtx_result gtx_eye_of(const gtx_stream_view *view, gtx_stream_eye *out, gtx_error *error);

bool gtx_eye_sees(const gtx_stream_eye *eye, const double low[3], const double high[3]);

/* An upper bound, in pixels, of what a length is on screen wherever in the box it is seen. Infinite
 * where the eye is in the box, unless the length is 0. */
double gtx_eye_pixels(const gtx_stream_eye *eye, const double low[3], const double high[3],
                      double length);

#endif
