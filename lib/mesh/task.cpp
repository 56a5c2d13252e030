/* Progress, cancelling and threads of a long job. */
#include "mesh/task.hpp"

#include "base/error.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <mutex>
#include <new>
#include <system_error>

namespace gtx {

gtx_error caught_error()
{
    gtx_error out;
    try {
        throw;
    } catch (const Error &e) {
        gtx_fail(&out, e.result, "%s", e.what());
        out.rule = e.rule.number;
        out.rule_name = e.rule.name;
        out.offset = e.rule.offset;
        out.limit = e.limit;
    } catch (const std::bad_alloc &) {
        gtx_fail(&out, GTX_ERROR_MEMORY, "out of memory");
    } catch (const std::exception &e) {
        gtx_fail(&out, GTX_ERROR_INTERNAL, "%s", e.what());
    } catch (...) {
        gtx_fail(&out, GTX_ERROR_INTERNAL, "an unknown exception");
    }
    return out;
}

static double now()
{
    using clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(clock::now().time_since_epoch()).count();
}

Task::Task(unsigned threads, gtx_progress_fn progress, void *user,
           std::vector<const char *> stages, std::vector<float> weights,
           const gtx_limits &limits)
    : limits(limits),
      threads_(threads ? threads : std::max(1u, std::thread::hardware_concurrency())),
      progress_(progress), user_(user), stages_(std::move(stages)),
      caller_(std::this_thread::get_id())
{
    if (stages_.empty())
        stages_.push_back("work");
    weights.resize(stages_.size(), 1.f);
    double total = 0;
    for (float w : weights)
        total += w;
    double before = 0;
    for (float w : weights) {
        before_.push_back(before / total);
        before += w;
    }
    before_.push_back(1);
    seconds_.assign(stages_.size(), 0);
    stage_start_ = now();
}

/* The current one where a job has no such stage. */
size_t Task::index_of(const char *stage) const
{
    for (size_t i = 0; i < stages_.size(); ++i)
        if (!std::strcmp(stages_[i], stage))
            return i;
    return stage_;
}

void Task::begin(const char *stage)
{
    end();
    stage_ = index_of(stage);
    limits.stage = stages_[stage_];
    report(0);
}

void Task::begin_pass(const char *first, const char *after, double share)
{
    pass_.first = index_of(first);
    pass_.after = index_of(after);
    pass_.from = std::max(double(reported_), before_[pass_.first]);
    pass_.to = pass_.from + share * (before_[pass_.after] - pass_.from);
}

void Task::advance(double fraction)
{
    report(std::clamp(fraction, 0., 1.));
}

void Task::check()
{
    if (std::this_thread::get_id() == caller_)
        report(0); /* which never falls */
    else if (cancelled_)
        throw Error(GTX_CANCELLED, "cancelled");
}

void Task::end()
{
    double time = now();
    seconds_[stage_] += time - stage_start_;
    stage_start_ = time;
}

void Task::report(double fraction)
{
    if (!progress_)
        return;
    double whole = before_[stage_] + fraction * (before_[stage_ + 1] - before_[stage_]);
    if (stage_ >= pass_.first && stage_ < pass_.after) {
        const double first = before_[pass_.first], after = before_[pass_.after];
        whole = pass_.from + (whole - first) / (after - first) * (pass_.to - pass_.from);
    }
    reported_ = std::max(reported_, float(whole));
    gtx_progress progress = {stages_[stage_], uint32_t(stage_), uint32_t(stages_.size()),
                             reported_};
    if (progress_(&progress, user_)) {
        cancelled_ = true;
        throw Error(GTX_CANCELLED, "cancelled");
    }
}

void Task::parallel(size_t count, const std::function<void(size_t)> &body, double from, double to)
{
    std::atomic<size_t> next{0}, done{0};
    std::atomic<bool> stop{false};
    std::mutex mutex;
    std::exception_ptr failure;
    size_t failed_at = count;

    auto run_one = [&]() {
        size_t i = next++;
        if (i >= count || stop)
            return false;
        try {
            body(i);
        } catch (...) {
            std::lock_guard<std::mutex> lock(mutex);
            if (i < failed_at) {
                failed_at = i;
                failure = std::current_exception();
            }
            stop = true;
        }
        ++done;
        return true;
    };

    size_t helpers = std::min<size_t>(threads_, std::max<size_t>(count, 1)) - 1;
    std::vector<std::thread> pool;
    pool.reserve(helpers);
    for (size_t i = 0; i < helpers; ++i) {
        try {
            pool.emplace_back([&] {
                MemoryScope scope(limits);
                while (run_one()) {}
            });
        } catch (const std::system_error &) { /* no more threads: fewer do the same */
            break;
        }
    }
    try {
        while (run_one() && !stop)
            advance(from + (to - from) * double(done) / double(count));
    } catch (...) { /* cancelled from the callback */
        stop = true;
        for (std::thread &t : pool)
            t.join();
        throw;
    }
    for (std::thread &t : pool)
        t.join();
    if (failure)
        std::rethrow_exception(failure);
    advance(to);
}

} // namespace gtx
