/* The context of a long job, passed through the rooms of the cooker: errors, progress, cancelling,
 * threads. */
#pragma once

#include "base/warnings.h"
#include "mesh/memory.hpp"

#include <geotex/geotex.h>

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <initializer_list>
#include <string>
#include <thread>
#include <vector>

namespace gtx {

/* The rule of the format that a file breaks, and where; 0 and null when none applies. */
struct BrokenRule {
    uint32_t number = 0;
    const char *name = nullptr;
    uint64_t offset = 0;
};

/* Thrown inside the C++ rooms; turned into a gtx_error where C++ ends. */
struct Error : std::exception {
    gtx_result result;
    std::string message;
    BrokenRule rule;
    const char *limit = nullptr; /* as gtx_error.limit */
    Error(gtx_result result, std::string message) : result(result), message(std::move(message)) {}
    explicit Error(const gtx_error &error)
        : result(error.result), message(error.message),
          rule{error.rule, error.rule_name, error.offset}, limit(error.limit)
    {
    }
    const char *what() const noexcept override { return message.c_str(); }
};

/* Throws what a C function reported. */
inline void require_ok(gtx_result result, const gtx_error &error)
{
    if (result != GTX_OK)
        throw Error(error);
}

/* The exception in flight as a C caller gets it, written whole. For catch (...) alone. */
gtx_error caught_error();

struct Warning {
    gtx_warning kind;
    std::string sentence;
    bool operator<(const Warning &other) const { return sentence < other.sentence; }
};

/* A cancellation point, at any depth and on any thread of a job: has the callback asked now and
 * then, and throws Error(GTX_CANCELLED) once it has said so. It costs a count, for it looks at the
 * clock one time in a few: where steps take up to a millisecond each has one. Taking memory is one
 * too; without a job it does nothing. `plain` are the turns of a short loop that follows without
 * any. Each is a step of the job's work, and so are some turns: throws Error(LIMIT) where those are
 * more than is allowed. */
void cancel_point(size_t plain = 0);

/* One job. Used from the thread that runs it, except where stated. */
class Task {
public:
    /* `threads` 0 means all processors. `stages` names the steps in order; `weights` their shares
     * of the time (any scale, same length). */
    Task(unsigned threads, gtx_progress_fn progress, void *user,
         std::vector<const char *> stages = {}, std::vector<float> weights = {},
         const gtx_limits &limits = {});

    /* Enters the named stage. Throws Error(GTX_CANCELLED) when the callback says so. */
    void begin(const char *stage);
    /* Reports the share of the current stage that is done, 0..1; throws as begin(). Cheap enough
     * to call every few thousand steps. */
    void advance(double fraction);

    /* The stages from `first` to before `after` are about to run, once more where they have run
     * already: progress moves by `share` of what is left of theirs. */
    void begin_pass(const char *first, const char *after, double share);

    /* Runs body(i) for i in [0, count) on the task's threads, in no particular order, and returns
     * when all are done; reports progress from `from` to `to` of the stage and throws when
     * cancelled: long bodies have cancellation points. The first exception of a body (lowest i) is
     * rethrown. Bodies must write only to places of their own, so that results do not depend on the
     * thread count. */
    void parallel(size_t count, const std::function<void(size_t)> &body, double from = 0,
                  double to = 1);

    /* In how many parts so many steps are best done, of which fewer than `least` are not worth a
     * thread: what is done must not depend on it. */
    size_t parts(size_t count, size_t least) const;
    /* Runs body(part, from, to) for so many parts of [0, count), as parallel() does. */
    void in_parts(size_t count, size_t parts,
                  const std::function<void(size_t, size_t, size_t)> &body);

    /* All at once where there are threads for it, or one after the other; each may use parallel(),
     * and counts its own work. At most Limits::LANES, and not for use inside of any. */
    void at_once(std::initializer_list<std::function<void()>> steps);

    unsigned threads() const { return threads_; }
    /* Seconds spent in each stage so far, in the order of the constructor. */
    const std::vector<double> &seconds() const { return seconds_; }
    const std::vector<const char *> &stages() const { return stages_; }
    /* Closes the clock of the last stage. */
    void end();

    /* What the job may take: the memory of all its threads' containers counts against it. */
    Limits limits;

    /* In the order found: what was dropped, ignored or repaired. */
    Vector<Warning> warnings;
    void warn(gtx_warning kind, std::string sentence) { warnings.push_back({kind, sentence}); }

private:
    /* One of several runs of some stages, and the part of all progress that it moves over. */
    struct Pass {
        size_t first = 0, after = 0;
        double from = 0, to = 0;
    };
    /* For as long as it lives, the thread works for the task. */
    class Scope {
    public:
        explicit Scope(Task &task);
        ~Scope();
        Scope(const Scope &) = delete;
        Scope &operator=(const Scope &) = delete;

    private:
        MemoryScope memory_;
        Task *outer_;
    };
    class Crew;
    friend void cancel_point(size_t plain);

    size_t index_of(const char *stage) const;
    void report(double fraction);
    void report_now_and_then();
    Scope scope_{*this};
    unsigned threads_;
    gtx_progress_fn progress_;
    void *user_;
    std::vector<const char *> stages_;
    std::vector<double> before_, seconds_; /* share done before a stage; seconds in it */
    size_t stage_ = 0;
    Pass pass_;
    double stage_start_ = 0, asked_ = 0; /* when */
    float reported_ = 0;
    std::thread::id caller_;
    std::atomic<bool> cancelled_{false};
};

} // namespace gtx
