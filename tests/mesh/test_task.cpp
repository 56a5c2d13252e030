/* Cancellation points: a job that is in the middle of something asks, and stops. */
#include "mesh/task.hpp"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <unistd.h>

extern "C" {
#include <cmocka.h> /* last: its fail() is a macro */
}

using namespace gtx;

/* Ends the program where nothing stops. */
constexpr unsigned FOREVER = 100;

/* Says yes a few times, and then no. */
static int soon(const gtx_progress *, void *user)
{
    return --*static_cast<int *>(user) < 0;
}

template <class Body> static void assert_cancelled(unsigned threads, Body body)
{
    int left = 3;
    Task task(threads, soon, &left);
    gtx_result result = GTX_OK;
    alarm(FOREVER);
    try {
        body(task);
    } catch (const Error &error) {
        result = error.result;
    }
    alarm(0);
    assert_int_equal(result, GTX_CANCELLED);
    assert_int_equal(left, -1); /* and is not asked again */
}

static void a_loop_stops(void **)
{
    assert_cancelled(1, [](Task &) {
        for (;;)
            cancel_point();
    });
}

static void taking_memory_stops(void **)
{
    assert_cancelled(1, [](Task &) {
        for (;;)
            Vector<char> some(1);
    });
}

/* Whoever is asked has nothing to do then but to wait. */
static void a_helper_stops(void **)
{
    assert_cancelled(2, [](Task &task) {
        const std::thread::id caller = std::this_thread::get_id();
        std::atomic<bool> helped{false};
        task.parallel(2, [&](size_t) {
            while (std::this_thread::get_id() != caller) {
                helped = true;
                cancel_point();
            }
            while (!helped)
                std::this_thread::yield();
        });
    });
}

static void without_a_job_nothing_is_asked(void **)
{
    {
        int left = 1;
        Task ended(1, soon, &left);
    }
    for (int i = 0; i < 1000; ++i)
        cancel_point();
    Task silent(1, nullptr, nullptr);
    for (int i = 0; i < 1000; ++i)
        cancel_point();
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_loop_stops),
        cmocka_unit_test(taking_memory_stops),
        cmocka_unit_test(a_helper_stops),
        cmocka_unit_test(without_a_job_nothing_is_asked),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
