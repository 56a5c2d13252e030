/* Progress, cancelling and threads of a long job. */
#include "mesh/task.hpp"

#include "base/error.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
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

/* Steps of a thread between two looks at the clock, and seconds between two calls of the callback:
 * an answer is wanted in a fifth of one, most of which one long step may take. */
constexpr size_t LOOK = 64;
/* Turns of a short loop that count as a step. */
constexpr size_t PLAIN = 1 << 14;
constexpr double ASK = 0.02;
/* Turns that are a step of work, and steps that a thread does before it tells of them: a limit is
 * that coarse. */
constexpr size_t PLAIN_WORK = 16, UNTOLD_WORK = 1 << 12;

/* Which task the thread works for. */
static thread_local Task *current = nullptr;
static thread_local size_t passed = 0, worked = 0;

Task::Scope::Scope(Task &task) : memory_(task.limits), outer_(current)
{
    current = &task;
}

Task::Scope::~Scope()
{
    current = outer_;
}

void cancel_point(size_t plain)
{
    passed += 1 + plain / PLAIN;
    worked += 1 + plain / PLAIN_WORK;
    if (passed < LOOK || !current)
        return;
    passed = 0;
    if (worked >= UNTOLD_WORK) {
        const size_t told = worked;
        worked = 0;
        current->limits.work(told);
    }
    current->report_now_and_then();
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
    limits.work_again();
}

void Task::advance(double fraction)
{
    report(std::clamp(fraction, 0., 1.));
}

void Task::report_now_and_then()
{
    if (cancelled_)
        throw Error(GTX_CANCELLED, "cancelled");
    if (progress_ && std::this_thread::get_id() == caller_ && now() - asked_ > ASK)
        report(0); /* which never falls */
}

void Task::end()
{
    double time = now();
    seconds_[stage_] += time - stage_start_;
    stage_start_ = time;
}

void Task::report(double fraction)
{
    if (std::this_thread::get_id() != caller_ && cancelled_)
        throw Error(GTX_CANCELLED, "cancelled");
    if (!progress_ || std::this_thread::get_id() != caller_)
        return;
    double whole = before_[stage_] + fraction * (before_[stage_ + 1] - before_[stage_]);
    if (stage_ >= pass_.first && stage_ < pass_.after) {
        const double first = before_[pass_.first], after = before_[pass_.after];
        whole = pass_.from + (whole - first) / (after - first) * (pass_.to - pass_.from);
    }
    reported_ = std::max(reported_, float(whole));
    gtx_progress progress = {stages_[stage_], uint32_t(stage_), uint32_t(stages_.size()),
                             reported_};
    cancelled_ = cancelled_ || progress_(&progress, user_);
    if (cancelled_)
        throw Error(GTX_CANCELLED, "cancelled");
    asked_ = now();
}

/* The threads of one parallel(), the caller's among them. */
class Task::Crew {
public:
    Crew(Task &task, size_t count, const std::function<void(size_t)> &body)
        : task_(task), count_(count), failed_at_(count), body_(body)
    {
    }
    ~Crew() { join(); }
    void hire(size_t helpers);
    /* What the caller does; report(done) is its chance to stop. */
    void work(const std::function<void(size_t)> &report);
    void rethrow();

private:
    bool run_one();
    void join();

    Task &task_;
    const size_t count_;
    size_t failed_at_, gone_ = 0; /* helpers that have nothing left to do */
    const std::function<void(size_t)> &body_;
    std::atomic<size_t> next_{0}, done_{0};
    std::atomic<bool> stop_{false};
    std::mutex mutex_;
    std::condition_variable one_went_;
    std::exception_ptr failure_;
    std::vector<std::thread> helpers_;
};

bool Task::Crew::run_one()
{
    size_t i = next_++;
    if (i >= count_ || stop_)
        return false;
    try {
        body_(i);
    } catch (...) {
        std::lock_guard<std::mutex> lock(mutex_);
        if (i < failed_at_) {
            failed_at_ = i;
            failure_ = std::current_exception();
        }
        stop_ = true;
    }
    ++done_;
    return true;
}

void Task::Crew::hire(size_t helpers)
{
    helpers_.reserve(helpers);
    for (size_t i = 0; i < helpers; ++i) {
        try {
            helpers_.emplace_back([this, lane = Limits::lane] {
                Scope scope(task_);
                Limits::lane = lane;
                while (run_one()) {}
                std::lock_guard<std::mutex> lock(mutex_);
                ++gone_;
                one_went_.notify_one();
            });
        } catch (const std::system_error &) { /* no more threads: fewer do the same */
            break;
        }
    }
}

void Task::Crew::work(const std::function<void(size_t)> &report)
{
    while (run_one() && !stop_)
        report(done_);
    const std::chrono::duration<double> wait(ASK);
    std::unique_lock<std::mutex> lock(mutex_);
    while (!one_went_.wait_for(lock, wait, [this] { return gone_ == helpers_.size(); })) {
        lock.unlock();
        report(done_);
        lock.lock();
    }
}

/* Early where work() has thrown. */
void Task::Crew::join()
{
    stop_ = true;
    for (std::thread &helper : helpers_)
        helper.join();
    helpers_.clear();
}

void Task::Crew::rethrow()
{
    join();
    if (failure_)
        std::rethrow_exception(failure_);
}

void Task::parallel(size_t count, const std::function<void(size_t)> &body, double from, double to)
{
    Crew crew(*this, count, body);
    crew.hire(std::min<size_t>(threads_, std::max<size_t>(count, 1)) - 1);
    crew.work([&](size_t done) { advance(from + (to - from) * double(done) / double(count)); });
    crew.rethrow();
    advance(to);
}

size_t Task::parts(size_t count, size_t least) const
{
    constexpr size_t MOST = 8; /* each may have memory of its own */
    const size_t most = threads_ < 2 ? 1 : std::min<size_t>(2 * threads_, MOST);
    return std::clamp<size_t>(count / least, 1, most);
}

void Task::in_parts(size_t count, size_t parts,
                    const std::function<void(size_t, size_t, size_t)> &body)
{
    if (parts == 1)
        return body(0, 0, count);
    parallel(parts, [&](size_t part) {
        body(part, part * count / parts, (part + 1) * count / parts);
    }, 0, 0);
}

void Task::at_once(std::initializer_list<std::function<void()>> steps)
{
    const unsigned outer = Limits::lane;
    const std::function<void(size_t)> body = [&](size_t which) {
        struct Lane {
            unsigned before = Limits::lane;
            ~Lane() { Limits::lane = before; }
        } lane;
        Limits::lane = unsigned(outer + which) % Limits::LANES;
        steps.begin()[which]();
    };
    Crew crew(*this, steps.size(), body);
    crew.hire(threads_ > 1 ? steps.size() - 1 : 0);
    crew.work([this](size_t) { advance(0); });
    crew.rethrow();
}

} // namespace gtx
