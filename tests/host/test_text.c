/* Text: where its quads lie, and that every character has a shape of its own. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <cmocka.h>

#include "host/text.h"

#include <stdlib.h>
#include <string.h>

static const gtx_text_style style = {1, {0, 0, 0}, {255, 255, 255}};

/* The dots of a glyph, one bit each, from the quads that draw them (not their rims). */
static uint64_t dots_of(const char *text)
{
    gtx_shapes shapes = {0};
    uint64_t bits = 0;
    gtx_text_add(&shapes, 0, 0, &style, text);
    for (uint32_t v = 0; v < shapes.vertex_count; v += 4) {
        const gtx_polygon_vertex *corner = shapes.vertices + v; /* lower left .. upper left */
        if (corner->color[0])
            continue;
        const int row = (int)corner[3].position[1];
        for (int x = (int)corner[3].position[0]; x < (int)corner[1].position[0]; ++x) {
            assert_in_range(x, 0, 4);
            assert_in_range(row, 0, 7);
            bits |= UINT64_C(1) << (5 * row + x);
        }
    }
    free(shapes.vertices);
    free(shapes.indices);
    return bits;
}

static void every_character_has_its_own_shape(void **state)
{
    (void)state;
    uint64_t shapes[128];
    assert_int_equal(dots_of(" "), 0);
    for (int c = '!'; c < 128; ++c) {
        const char text[2] = {(char)c, 0};
        shapes[c] = dots_of(text);
        assert_true(shapes[c] != 0);
        for (int other = '!'; other < c; ++other)
            if (shapes[c] == shapes[other])
                fail_msg("'%c' looks like '%c'", c, other);
    }
}

static void foreign_characters_are_boxes(void **state)
{
    (void)state;
    int width, height;
    assert_int_equal(dots_of("\xc3\xa9"), dots_of("\x7f"));
    assert_int_equal(dots_of("\x01"), dots_of("\x7f"));
    gtx_text_measure("na\xc3\xafve", &width, &height);
    assert_int_equal(width, 5 * GTX_TEXT_ADVANCE);
}

static void lines_are_measured(void **state)
{
    (void)state;
    int width, height;
    gtx_text_measure("ab\nabcd\na", &width, &height);
    assert_int_equal(width, 4 * GTX_TEXT_ADVANCE);
    assert_int_equal(height, 3 * GTX_TEXT_LINE);
    gtx_text_measure("", &width, &height);
    assert_int_equal(width + height, 0);
}

static void text_starts_where_it_is_put(void **state)
{
    (void)state;
    gtx_shapes shapes = {0};
    float low[2] = {1e9f, 1e9f}, high[2] = {0, 0};
    gtx_text_style wide = style;
    wide.dot = 3;
    gtx_text_add(&shapes, 10, 20, &wide, "I\nI");
    for (uint32_t v = 0; v < shapes.vertex_count; ++v)
        for (int k = 0; k < 2; ++k) {
            const float p = shapes.vertices[v].position[k];
            low[k] = p < low[k] ? p : low[k];
            high[k] = p > high[k] ? p : high[k];
        }
    assert_true(low[0] == 10 + 3 * 1 - 3 && low[1] == 20 - 3); /* its rim is a dot wide */
    assert_true(high[1] == 20 + 3 * (GTX_TEXT_LINE + 7) + 3);
    free(shapes.vertices);
    free(shapes.indices);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_character_has_its_own_shape),
        cmocka_unit_test(foreign_characters_are_boxes),
        cmocka_unit_test(lines_are_measured),
        cmocka_unit_test(text_starts_where_it_is_put),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
