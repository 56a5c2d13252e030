/* Few triangles that lie over each other anyhow: they cook in time, to valid assets, and a caller
 * is asked often whether to go on. */
#include "../common/hostile.hpp"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <geotex/cook.h>

#include <algorithm>
#include <chrono>
#include <unistd.h>

extern "C" {
#include <cmocka.h> /* last: its fail() is a macro */
}

/* Ends the program where something takes forever: what is here takes seconds. */
constexpr unsigned FOREVER = 240;
/* Seconds between two calls: generous, for an answer is wanted in a fifth of one. */
constexpr double LONGEST_GAP = 5;

struct Watch {
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
    double longest = 0;

    static int called(const gtx_progress *, void *user)
    {
        auto *self = static_cast<Watch *>(user);
        const auto now = std::chrono::steady_clock::now();
        const std::chrono::duration<double> gap = now - self->last;
        self->longest = std::max(self->longest, gap.count());
        self->last = now;
        return 0;
    }
};

static void assert_cooks(const std::string &text)
{
    Watch watch;
    gtx_cook_desc desc = {};
    desc.threads = 1;
    desc.progress = Watch::called;
    desc.progress_user = &watch;
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    alarm(FOREVER);
    gtx_cook_memory(text.data(), text.size(), "a.obj", &desc, &asset, nullptr, &error);
    alarm(0);
    assert_string_equal(error.message, "");
    assert_non_null(asset);
    assert_true(watch.longest < LONGEST_GAP);
    gtx_close(asset);
}

static void many_on_one_edge(void **)
{
    assert_cooks(hostile::one_edge(3000));
}

static void a_soup(void **)
{
    assert_cooks(hostile::soup(3000));
}

static void a_fan_of_needles(void **)
{
    assert_cooks(hostile::fan(2000));
}

static void a_stack_of_squares(void **)
{
    assert_cooks(hostile::stack(5000));
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_on_one_edge),
        cmocka_unit_test(a_soup),
        cmocka_unit_test(a_fan_of_needles),
        cmocka_unit_test(a_stack_of_squares),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
