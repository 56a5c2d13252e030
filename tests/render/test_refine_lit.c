/* Those triangles of displaced grids that are lit at their corners are even. No OpenGL. */
#include "refined.h"

/* A byte at a node: of the normal, then of the colour. */
static double byte_of(const subject *s, uint32_t x, uint32_t y, int k)
{
    const gtx_patch *p = s->asset->patches;
    const size_t row = p->rect[1] + y, column = p->rect[0] + x;
    const size_t at = row * s->asset->info.page_width + column;
    return k < 2 ? s->asset->normal[0][2 * at + (size_t)k]
                 : s->asset->color[0][4 * at + (size_t)k - 2];
}

/* The same at a place, as maps are looked up. */
static double byte_at(const subject *s, double x, double y, int k)
{
    const uint32_t i = (uint32_t)x, j = (uint32_t)y;
    const double u = x - i, v = y - j;
    double sum = 0;
    for (uint32_t c = 0; c < 4; ++c) {
        const double share = (c % 2 ? u : 1 - u) * (c / 2 ? v : 1 - v);
        sum += share > 0 ? share * byte_of(s, i + c % 2, j + c / 2, k) : 0;
    }
    return sum;
}

/* How far what the corners make is from what is at a node that their triangle lies over, in
 * bytes. */
static double stray_at(const subject *s, uint32_t triangle, uint32_t x, uint32_t y)
{
    double c[3][3], area[3], most = 0;
    for (uint32_t i = 0; i < 3; ++i)
        gtx_grid_place(corner_of(s, 3 * triangle + i), c[i]);
    for (int i = 0; i < 3; ++i) {
        const double *a = c[(i + 1) % 3], *b = c[(i + 2) % 3];
        area[i] = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
        if (area[i] < 0)
            return 0;
    }
    for (int k = 0; k < (s->asset->info.has_color ? 6 : 2); ++k) {
        double mean = 0;
        for (int i = 0; i < 3; ++i)
            mean += area[i] * byte_at(s, c[i][0], c[i][1], k) / (area[0] + area[1] + area[2]);
        most = fmax(most, fabs(mean - byte_at(s, x, y, k)));
    }
    return most;
}

/* Those lit at their corners have the normals and colours that these make; and near they all
 * are. */
static void expect_to_be_even(bool colored)
{
    subject s;
    uint32_t large = 0, mapped = 0, near = 0;
    open_subject(&s, 8, colored);
    for (uint32_t n = 0; n < 40; ++n) {
        const uint32_t count = refine(&s, n), lit = lit_of(&s);
        const double least_w = s.w[3] + fmin(0, 48 * s.w[0]) + fmin(0, 40 * s.w[1]) - 255 * 0.01;
        const double most_w = least_w + 48 * fabs(s.w[0]) + 40 * fabs(s.w[1]) + 255 * 0.02;
        bool larger = false;
        for (uint32_t i = 0; i < lit; ++i) {
            uint32_t low[2], high[2];
            place_of(&s, i, low, high);
            larger = larger || high[0] - low[0] > PARTS || high[1] - low[1] > PARTS;
            for (uint32_t y = (low[1] + PARTS - 1) / PARTS; y <= high[1] / PARTS; ++y)
                for (uint32_t x = (low[0] + PARTS - 1) / PARTS; x <= high[0] / PARTS; ++x) {
                    const double stray = stray_at(&s, i, x, y);
                    large += stray > 0.4;
                    if (stray > 3.01)
                        fail_msg("view %u: they stray by %g", n, stray);
                }
        }
        mapped += count - lit;
        if (most_w < 0.5 * s.view.pixels / 8) { /* the side of a texel */
            assert_int_equal(lit, count);
            near += larger;
        }
    }
    assert_true(large > 100 && mapped > 1000 && near > 3);
    close_subject(&s);
}

static void lit_ones_are_even(void **state)
{
    (void)state;
    expect_to_be_even(false);
    expect_to_be_even(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lit_ones_are_even),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
