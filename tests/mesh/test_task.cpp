/* Cancellation points: a job that is in the middle of something asks, and stops. */
#include "mesh/task.hpp"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <unistd.h>

#include <cstring>

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

/* ---- work ---- */

/* Steps until a task says that they are more than it allows. */
static uint64_t steps_done(Task &task, uint64_t most, size_t plain = 0)
{
    uint64_t steps = 0;
    try {
        for (; steps < most; ++steps)
            cancel_point(plain);
    } catch (const Error &error) {
        assert_int_equal(error.result, GTX_ERROR_LIMIT);
        assert_string_equal(error.limit, "work");
        assert_non_null(strstr(error.message.c_str(), task.stages()[0]));
    }
    return steps;
}

static gtx_limits work(uint64_t steps)
{
    gtx_limits limits = {};
    limits.work = steps;
    return limits;
}

constexpr uint64_t ALLOWED = 100000, UNTOLD = 5000; /* a limit is that coarse */

static void more_work_than_allowed_ends(void **)
{
    Task task(1, nullptr, nullptr, {"import"}, {1}, work(ALLOWED));
    task.begin("import");
    const uint64_t steps = steps_done(task, 2 * ALLOWED);
    assert_true(steps >= ALLOWED - UNTOLD && steps <= ALLOWED + UNTOLD);
    task.limits.work_again();
    assert_int_equal(steps_done(task, ALLOWED - UNTOLD), ALLOWED - UNTOLD);
}

static void turns_of_short_loops_are_work(void **)
{
    Task task(1, nullptr, nullptr, {"import"}, {1}, work(ALLOWED));
    task.begin("import");
    assert_true(steps_done(task, ALLOWED, 1600) < ALLOWED / 50);
}

static void all_threads_work(void **)
{
    Task task(2, nullptr, nullptr, {"import"}, {1}, work(ALLOWED));
    bool ended = false;
    try {
        task.parallel(4, [](size_t) {
            for (uint64_t i = 0; i < ALLOWED / 2; ++i)
                cancel_point();
        });
    } catch (const Error &error) {
        ended = error.limit && !strcmp(error.limit, "work");
    }
    assert_true(ended);
}

/* What is given holds; a default grows. */
static void options_allow_more_work(void **)
{
    Task given(1, nullptr, nullptr, {"import"}, {1}, work(ALLOWED));
    given.begin("import");
    given.limits.allow_work(8);
    assert_true(steps_done(given, 2 * ALLOWED) < 2 * ALLOWED);
    Task plain(1, nullptr, nullptr, {"import"}, {1}), more(1, nullptr, nullptr, {"import"}, {1});
    more.limits.allow_work(8);
    const uint64_t allowed = plain.limits.of(GTX_LIMITED_WORK);
    plain.limits.work(allowed);
    more.limits.work(8 * allowed);
    for (Task *task : {&plain, &more}) {
        bool ended = false;
        try {
            task->limits.work(1);
        } catch (const Error &) {
            ended = true;
        }
        assert_true(ended);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_loop_stops),
        cmocka_unit_test(taking_memory_stops),
        cmocka_unit_test(a_helper_stops),
        cmocka_unit_test(without_a_job_nothing_is_asked),
        cmocka_unit_test(more_work_than_allowed_ends),
        cmocka_unit_test(turns_of_short_loops_are_work),
        cmocka_unit_test(all_threads_work),
        cmocka_unit_test(options_allow_more_work),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
