/* Few triangles that lie over each other anyhow: they cook in time, to valid assets, and a caller
 * is asked often whether to go on. */
#include "../common/hostile.hpp"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>

#include <geotex/cook.h>

#include <algorithm>
#include <cstring>
#include <time.h>
#include <unistd.h>

extern "C" {
#include <cmocka.h> /* last: its fail() is a macro */
}

/* Ends the program where something takes forever: what is here takes seconds. */
constexpr unsigned FOREVER = 240;
/* Seconds of the thread's own between two calls: generous, for an answer is wanted in a fifth of
 * one. Sanitizers take several times as long. */
constexpr double LONGEST_GAP = 1, SANITIZED = 5;

struct Watch {
    double last = now(), longest = 0;

    static double now()
    {
        timespec time;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
    }
    static int called(const gtx_progress *, void *user)
    {
        auto *self = static_cast<Watch *>(user);
        self->longest = std::max(self->longest, now() - self->last);
        self->last = now();
        return 0;
    }
    bool was_asked() const
    {
        const char *config = getenv("GTX_CONFIG");
        const bool plain = !config || !strcmp(config, "release");
        return longest < LONGEST_GAP * (plain ? 1 : SANITIZED);
    }
};

/* Distances out of searches that were given up would be a hundredth and more. */
static void assert_measured_right(const char *json)
{
    constexpr double MAX_ERROR = 3e-3; /* of the diagonal */
    for (const char *direction : {"\"forward\":", "\"reverse\":"}) {
        const char *rms = strstr(strstr(json, direction), "\"rms\":");
        const double error = strtod(rms + strlen("\"rms\":"), nullptr);
        if (!(error < MAX_ERROR))
            fail_msg("%s %g", direction, error);
    }
}

static void assert_cooks(const std::string &text)
{
    Watch watch;
    gtx_cook_desc desc = {};
    desc.threads = 1;
    desc.measure = 1;
    desc.lod_levels = 3;
    desc.progress = Watch::called;
    desc.progress_user = &watch;
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    alarm(FOREVER);
    gtx_report report = {};
    gtx_cook_memory(text.data(), text.size(), "a.obj", &desc, &asset, &report, &error);
    alarm(0);
    assert_string_equal(error.message, "");
    assert_non_null(asset);
    if (!watch.was_asked())
        fail_msg("nothing was asked for %.1f s", watch.longest);
    assert_measured_right(report.json);
    gtx_report_free(&report);
    gtx_close(asset);
}

static void many_on_one_edge(void **)
{
    assert_cooks(hostile::one_edge(9000));
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

static void shells_inside_each_other(void **)
{
    assert_cooks(hostile::shells(1800));
}

/* It takes work that nobody can foresee: what is allowed ends it, on however many threads. */
static void noise_ends(void **)
{
    const std::string text = hostile::noise(3000);
    for (unsigned threads : {1, 2}) {
        gtx_cook_desc desc = {};
        desc.threads = threads;
        desc.limits.work = 1 << 20;
        gtx_asset *asset = nullptr;
        gtx_error error = {};
        assert_int_equal(gtx_cook_memory(text.data(), text.size(), "a.obj", &desc, &asset, nullptr,
                                         &error), GTX_ERROR_LIMIT);
        assert_string_equal(error.limit, "work");
        assert_null(asset);
    }
}

static bool cooks_within(const std::string &text, double work)
{
    gtx_cook_desc desc = {};
    desc.threads = 1;
    desc.lod_levels = 3;
    desc.limits.work = uint64_t(work);
    gtx_asset *asset = nullptr;
    gtx_error error = {};
    if (gtx_cook_memory(text.data(), text.size(), "a.obj", &desc, &asset, nullptr, &error))
        assert_string_equal(error.limit, "work");
    const bool cooked = asset != nullptr;
    gtx_close(asset);
    return cooked;
}

/* Counted, not timed: eight times the triangles take some eight times the work, where all pairs
 * would take 64 times. The least work that lets few cook is found by limits half as large again
 * each; one cook tells whether a multiple of it is enough for many, which take 3 to 8 times. */
static void work_grows_as_triangles_do(void **)
{
    constexpr unsigned FEW = 100, MANY = 8 * FEW;
    constexpr double FIRST = 1 << 20, MAX_RATIO = 16;
    const struct {
        const char *name;
        std::string (*make)(unsigned);
    } families[] = {{"edge", hostile::one_edge}, {"soup", hostile::soup}, {"fan", hostile::fan},
                    {"stack", hostile::stack}, {"shells", hostile::shells}};
    for (const auto &family : families) {
        double work = FIRST;
        assert_false(cooks_within(family.make(FEW), work)); /* else it is no measure */
        while (!cooks_within(family.make(FEW), work))
            work *= 1.5;
        print_message("%s: %.0f steps a triangle\n", family.name, work / FEW);
        if (!cooks_within(family.make(MANY), MAX_RATIO * work))
            fail_msg("%s: more than %.0f times the work", family.name, MAX_RATIO);
    }
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_on_one_edge),
        cmocka_unit_test(a_soup),
        cmocka_unit_test(a_fan_of_needles),
        cmocka_unit_test(a_stack_of_squares),
        cmocka_unit_test(shells_inside_each_other),
        cmocka_unit_test(noise_ends),
        cmocka_unit_test(work_grows_as_triangles_do),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
