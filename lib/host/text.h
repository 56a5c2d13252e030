/* Text on top of a picture: a bitmap font of our own whose dots are quads. */
#ifndef GTX_HOST_TEXT_H
#define GTX_HOST_TEXT_H

#include "host/shapes.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { /* dots from a glyph to the next, and from a line to the next */
    GTX_TEXT_ADVANCE = 6,
    GTX_TEXT_LINE = 10
};

/* A dot of the font is `dot` pixels wide; pixels count from the top left corner, y downwards. */
typedef struct gtx_text_style {
    float dot;
    gtx_rgb color, halo;      /* a rim around the dots, so that text is read on any picture */
} gtx_text_style;

/* Adds a text whose first glyph has its top left corner at (x, y). A newline starts a new line;
 * what is not printable ASCII is a hollow box, one for each character of UTF-8. */
void gtx_text_add(gtx_shapes *shapes, float x, float y, const gtx_text_style *style,
                  const char *text);

/* Dots of the longest line, and of all lines, as gtx_text_add lays them out. */
void gtx_text_measure(const char *text, int *width, int *height);

/* Adds a filled rectangle. */
void gtx_text_rectangle(gtx_shapes *shapes, float x, float y, float width, float height,
                        gtx_rgb color);

/* Draws what was added, in order, over a framebuffer of width x height pixels, and frees it. Turns
 * the depth test off. Errors: MEMORY, GL. */
gtx_result gtx_text_draw(const gtx_host_gl *gl, const gtx_polygon_program *program,
                         gtx_shapes *shapes, int width, int height, gtx_error *error);

#ifdef __cplusplus
}
#endif
#endif
