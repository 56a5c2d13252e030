/* Text on top of a picture: the font, and the quads of its dots. */
#include "host/text.h"

#include <string.h>

enum { FIRST = ' ', LAST = 127, GLYPH_WIDTH = 5, GLYPH_ROWS = 8, GLYPHS_A_BLOCK = 8 };

/* Eight glyphs side by side from each eighth character on, one column apart; the last row is below
 * the base line. The last glyph of all stands for what there is none of. */
static const char *const font[(LAST + 1 - FIRST) / GLYPHS_A_BLOCK][GLYPH_ROWS] = {
    {"      ..#.. .#.#. .#.#. ..#.. ##..# .##.. ..#..",
     "      ..#.. .#.#. .#.#. .#### ##..# #..#. ..#..",
     "      ..#..       ##### #.#.. ...#. #..#. .....",
     "      ..#..       .#.#. .###. ..#.. .##..      ",
     "      ..#..       ##### ..#.# .#... #.#.#      ",
     "      .....       .#.#. ####. #..## #..#.      ",
     "      ..#..       .#.#. ..#.. #..## .##.#      ",
     "                                               "},
    {"...#. .#...                               ....#",
     "..#.. ..#.. ..#.. ..#..                   ....#",
     ".#... ...#. #.#.# ..#..                   ...#.",
     ".#... ...#. .###. #####       #####       ..#..",
     ".#... ...#. #.#.# ..#.. .##..             .#...",
     "..#.. ..#.. ..#.. ..#.. .##..       .##.. #....",
     "...#. .#...             ..#..       .##.. #....",
     "                        .#...                  "},
    {".###. ..#.. .###. .###. ...#. ##### ..##. #####",
     "#...# .##.. #...# #...# ..##. #.... .#... ....#",
     "#..## ..#.. ....# ....# .#.#. ####. #.... ...#.",
     "#.#.# ..#.. ...#. ..##. #..#. ....# ####. ..#..",
     "##..# ..#.. ..#.. ....# ##### ....# #...# .#...",
     "#...# ..#.. .#... #...# ...#. #...# #...# .#...",
     ".###. .###. ##### .###. ...#. .###. .###. .#...",
     "                                               "},
    {".###. .###.             ...#.       .#... .###.",
     "#...# #...# .##.. .##.. ..#..       ..#.. #...#",
     "#...# #...# .##.. .##.. .#... ##### ...#. ....#",
     ".###. .####             #....       ....# ...#.",
     "#...# ....# .##.. .##.. .#... ##### ...#. ..#..",
     "#...# ...#. .##.. .##.. ..#..       ..#.. .....",
     ".###. .##..       ..#.. ...#.       .#... ..#..",
     "                  .#...                        "},
    {".###. .###. ####. .###. ###.. ##### ##### .###.",
     "#...# #...# #...# #...# #..#. #.... #.... #...#",
     "#.### #...# #...# #.... #...# #.... #.... #....",
     "#.#.# ##### ####. #.... #...# ####. ####. #.###",
     "#.### #...# #...# #.... #...# #.... #.... #...#",
     "#.... #...# #...# #...# #..#. #.... #.... #...#",
     ".###. #...# ####. .###. ###.. ##### #.... .####",
     "                                               "},
    {"#...# .###. ..### #...# #.... #...# #...# .###.",
     "#...# ..#.. ...#. #..#. #.... ##.## ##..# #...#",
     "#...# ..#.. ...#. #.#.. #.... #.#.# ##..# #...#",
     "##### ..#.. ...#. ##... #.... #.#.# #.#.# #...#",
     "#...# ..#.. ...#. #.#.. #.... #...# #..## #...#",
     "#...# ..#.. #..#. #..#. #.... #...# #..## #...#",
     "#...# .###. .##.. #...# ##### #...# #...# .###.",
     "                                               "},
    {"####. .###. ####. .#### ##### #...# #...# #...#",
     "#...# #...# #...# #.... ..#.. #...# #...# #...#",
     "#...# #...# #...# #.... ..#.. #...# #...# #...#",
     "####. #...# ####. .###. ..#.. #...# #...# #.#.#",
     "#.... #.#.# #.#.. ....# ..#.. #...# .#.#. #.#.#",
     "#.... #..#. #..#. ....# ..#.. #...# .#.#. ##.##",
     "#.... .##.# #...# ####. ..#.. .###. ..#.. #...#",
     "                                               "},
    {"#...# #...# ##### .###. #.... .###. ..#..      ",
     "#...# #...# ....# .#... #.... ...#. .#.#.      ",
     ".#.#. .#.#. ...#. .#... .#... ...#. #...#      ",
     "..#.. ..#.. ..#.. .#... ..#.. ...#.            ",
     ".#.#. ..#.. .#... .#... ...#. ...#.            ",
     "#...# ..#.. #.... .#... ....# ...#.            ",
     "#...# ..#.. ##### .###. ....# .###.            ",
     "                                          #####"},
    {".#...       #....       ....#       ..##.      ",
     "..#..       #....       ....#       .#...      ",
     "      .###. ####. .###. .#### .###. ####. .####",
     "      ....# #...# #...# #...# #...# .#... #...#",
     "      .#### #...# #.... #...# ##### .#... #...#",
     "      #...# #...# #...# #...# #.... .#... #...#",
     "      .#### ####. .###. .#### .###. .#... .####",
     "                                          .###."},
    {"#.... ..#.. ...#. .#... .##..                  ",
     "#....             .#... ..#..                  ",
     "####. .##.. ..##. .#..# ..#.. ##.#. ####. .###.",
     "#...# ..#.. ...#. .#.#. ..#.. #.#.# #...# #...#",
     "#...# ..#.. ...#. .##.. ..#.. #.#.# #...# #...#",
     "#...# ..#.. ...#. .#.#. ..#.. #.#.# #...# #...#",
     "#...# .###. ...#. .#..# .###. #.#.# #...# .###.",
     "            .##..                              "},
    {"                        .#...                  ",
     "                        .#...                  ",
     "####. .#### #.##. .#### ####. #...# #...# #...#",
     "#...# #...# ##..# #.... .#... #...# #...# #.#.#",
     "#...# #...# #.... .###. .#... #...# #...# #.#.#",
     "####. .#### #.... ....# .#..# #..## .#.#. #.#.#",
     "#.... ....# #.... ####. ..##. .##.# ..#.. .#.#.",
     "#.... ....#                                    "},
    {"                  ...## ..#.. ##...       #####",
     "                  ..#.. ..#.. ..#..       #...#",
     "#...# #...# ##### ..#.. ..#.. ..#..       #...#",
     ".#.#. #...# ...#. .#... ..#.. ...#. .##.# #...#",
     "..#.. #...# ..#.. ..#.. ..#.. ..#.. #.##. #...#",
     ".#.#. .#### .#... ..#.. ..#.. ..#..       #...#",
     "#...# ....# ##### ...## ..#.. ##...       #####",
     "      .###.                                    "}};

void gtx_text_rectangle(gtx_shapes *shapes, float x, float y, float width, float height,
                        gtx_rgb color)
{
    const float corners[4][3] = {
        {x, y + height, 0}, {x + width, y + height, 0}, {x + width, y, 0}, {x, y, 0}};
    gtx_shapes_quad(shapes, corners, color);
}

/* Where and how glyphs are added; the rim makes them larger on every side. */
typedef struct pen {
    float x, y, dot, rim;     /* pixels */
    gtx_rgb color;
} pen;

/* A rectangle for each horizontal run of dots. */
static void add_glyph(gtx_shapes *shapes, unsigned char c, const pen *p)
{
    const int index = (c < FIRST || c > LAST ? LAST : c) - FIRST;
    for (int row = 0; row < GLYPH_ROWS; ++row) {
        const char *dots = font[index / GLYPHS_A_BLOCK][row] +
                           index % GLYPHS_A_BLOCK * GTX_TEXT_ADVANCE;
        for (int i = 0, run; i < GLYPH_WIDTH; i += run + 1) {
            for (run = 0; i + run < GLYPH_WIDTH && dots[i + run] == '#'; ++run) {}
            if (run)
                gtx_text_rectangle(shapes, p->x + (float)i * p->dot - p->rim,
                                   p->y + (float)row * p->dot - p->rim,
                                   (float)run * p->dot + 2 * p->rim, p->dot + 2 * p->rim, p->color);
        }
    }
}

static void add_text(gtx_shapes *shapes, pen p, const char *text)
{
    for (const float left = p.x; *text; ++text)
        if (*text == '\n') {
            p.x = left;
            p.y += GTX_TEXT_LINE * p.dot;
        } else if (((unsigned char)*text & 0xc0) != 0x80) { /* no continuation byte of UTF-8 */
            add_glyph(shapes, (unsigned char)*text, &p);
            p.x += GTX_TEXT_ADVANCE * p.dot;
        }
}

void gtx_text_add(gtx_shapes *shapes, float x, float y, const gtx_text_style *style,
                  const char *text)
{
    add_text(shapes, (pen){x, y, style->dot, style->dot, style->halo}, text);
    add_text(shapes, (pen){x, y, style->dot, 0, style->color}, text);
}

void gtx_text_measure(const char *text, int *width, int *height)
{
    int line = 0;
    *width = 0;
    *height = *text ? GTX_TEXT_LINE : 0;
    for (; *text; ++text)
        if (*text == '\n') {
            line = 0;
            *height += GTX_TEXT_LINE;
        } else if (((unsigned char)*text & 0xc0) != 0x80) {
            line += GTX_TEXT_ADVANCE;
            *width = line > *width ? line : *width;
        }
}

gtx_result gtx_text_draw(const gtx_host_gl *gl, const gtx_polygon_program *program,
                         gtx_shapes *shapes, int width, int height, gtx_error *error)
{
    const gtx_view pixels = {.view = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                             .projection = {2 / (float)width, 0, 0, 0, 0, -2 / (float)height, 0, 0,
                                            0, 0, 1, 0, -1, 1, 0, 1},
                             .ambient = 1};
    gtx_polygons polygons;
    gtx_result result = gtx_shapes_finish(shapes, gl, &polygons, error);
    if (result)
        return result;
    gl->Disable(GL_DEPTH_TEST);
    gtx_polygons_draw(gl, program, &polygons, NULL, &pixels);
    gtx_polygons_destroy(gl, &polygons);
    return GTX_OK;
}
