/* Rectangles on pages: nothing overlaps, little is wasted, and the order of the input decides. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

extern "C" {
#include <cmocka.h>
}

#include "bake/pages.hpp"

#include <algorithm>
#include <random>

using Sizes = gtx::Vector<std::array<uint32_t, 2>>;

static Sizes random_sizes(size_t count, uint32_t most, uint32_t grain)
{
    std::mt19937 random(7);
    auto side = [&] { return uint32_t(grain * (1 + random() % (most / grain))); };
    Sizes sizes(count);
    for (auto &size : sizes)
        for (uint32_t &s : size)
            s = side();
    return sizes;
}

/* Share of the pages that is filled; fails the test on an overlap or a place outside. */
static double checked_fill(const Sizes &sizes, const gtx::baking::Packing &packing, uint32_t grain)
{
    assert_true(packing.width >= 8 && packing.height >= 8);
    assert_true(packing.width <= 4096 && packing.height <= 4096);
    assert_int_equal(packing.width % grain, 0);
    assert_int_equal(packing.height % grain, 0);
    size_t across = packing.width / grain, down = packing.height / grain;
    gtx::Vector<uint8_t> taken(packing.page_count * across * down);
    double area = 0;
    for (size_t r = 0; r < sizes.size(); ++r) {
        const gtx::baking::Packing::Place &at = packing.places[r];
        assert_true(at.page < packing.page_count);
        assert_true(at.x + sizes[r][0] <= packing.width && at.y + sizes[r][1] <= packing.height);
        assert_true(at.x % grain == 0 && at.y % grain == 0);
        for (uint32_t y = at.y / grain; y < (at.y + sizes[r][1]) / grain; ++y) {
            for (uint32_t x = at.x / grain; x < (at.x + sizes[r][0]) / grain; ++x) {
                uint8_t &texel = taken[(at.page * down + y) * across + x];
                assert_int_equal(texel, 0);
                texel = 1;
            }
        }
        area += double(sizes[r][0]) * sizes[r][1];
    }
    return area / (double(packing.page_count) * packing.width * packing.height);
}

static void one_rectangle_is_its_page(void **)
{
    gtx::baking::Packing packing = gtx::baking::pack({{128, 64}}, 8);
    assert_int_equal(packing.page_count, 1);
    assert_int_equal(packing.width, 128);
    assert_int_equal(packing.height, 64);
}

static void a_tiny_rectangle_gets_the_least_page(void **)
{
    assert_true(checked_fill({{2, 2}}, gtx::baking::pack({{2, 2}}, 1), 1) > 0);
    assert_true(checked_fill({{128, 128}}, gtx::baking::pack({{128, 128}}, 128), 128) == 1);
}

static void hundreds_fill_one_page(void **)
{
    for (size_t count : {50, 222, 453, 2000}) {
        Sizes sizes = random_sizes(count, 136, 8);
        gtx::baking::Packing packing = gtx::baking::pack(sizes, 8);
        assert_int_equal(packing.page_count, 1);
        double fill = checked_fill(sizes, packing, 8);
        print_message("# %zu rectangles: %u x %u, %.1f %% filled\n", count, packing.width,
                      packing.height, 100 * fill);
        assert_true(fill > (count < 100 ? 0.85 : 0.9));
        assert_true(packing.width < 2 * packing.height && packing.height < 2 * packing.width);
    }
}

static void many_pages_are_filled_evenly(void **)
{
    Sizes sizes = random_sizes(400, 640, 32);
    gtx::baking::Packing packing = gtx::baking::pack(sizes, 32);
    assert_true(packing.page_count > 1);
    double fill = checked_fill(sizes, packing, 32);
    print_message("# %u pages of %u x %u, %.1f %% filled\n", packing.page_count, packing.width,
                  packing.height, 100 * fill);
    assert_true(fill > 0.85);
}

static void the_same_input_gives_the_same_places(void **)
{
    Sizes sizes = random_sizes(300, 96, 4);
    gtx::baking::Packing a = gtx::baking::pack(sizes, 4), b = gtx::baking::pack(sizes, 4);
    for (size_t i = 0; i < sizes.size(); ++i)
        assert_true(a.places[i].x == b.places[i].x && a.places[i].y == b.places[i].y);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(one_rectangle_is_its_page),
        cmocka_unit_test(a_tiny_rectangle_gets_the_least_page),
        cmocka_unit_test(hundreds_fill_one_page),
        cmocka_unit_test(many_pages_are_filled_evenly),
        cmocka_unit_test(the_same_input_gives_the_same_places),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
