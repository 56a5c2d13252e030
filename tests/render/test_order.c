/* Order by floats: least first, and equal ones as they were. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "frame/order.h"

#include <math.h>

enum { MAX_COUNT = 1000 };

static void least_first(void **state)
{
    (void)state;
    static const float some[] = {3, -INFINITY, 1e-30f, -2, INFINITY, 0.5f, -1e30f, 3, -2, 256};
    for (size_t count = 0; count <= MAX_COUNT; count = 2 * count + 1) {
        gtx_rank ranks[MAX_COUNT], room[MAX_COUNT];
        float values[MAX_COUNT];
        for (uint32_t i = 0; i < count; ++i) {
            values[i] = some[i * i % 10] * (float)(1 + i % 7);
            ranks[i] = gtx_rank_of(values[i], i);
        }
        gtx_order(ranks, room, count);
        for (size_t i = 1; i < count; ++i) {
            const uint32_t a = ranks[i - 1].place, b = ranks[i].place;
            assert_true(values[a] < values[b] || (values[a] == values[b] && a < b));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(least_first)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
