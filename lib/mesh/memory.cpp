/* Counting: each thread gathers small amounts before it tells the job's limits. */
#include "mesh/memory.hpp"

#include "mesh/task.hpp"

#include <algorithm>
#include <filesystem>

namespace gtx {

/* Bytes that a thread may hold, or have given back, untold: a limit is that coarse. */
constexpr int64_t UNTOLD = 1 << 16;

namespace {

struct Account {
    Limits *limits = nullptr;
    int64_t untold = 0;
};

} // namespace

static thread_local Account account;

void Limits::require(gtx_limited which, const char *what, uint64_t wanted) const
{
    const uint64_t allowed = of(which);
    if (wanted <= allowed)
        return;
    gtx_error error;
    gtx_fail_limit(&error, which, what, wanted, allowed);
    throw Error(error);
}

void Limits::read(const std::string &path, uint64_t bytes)
{
    std::error_code ignored; /* what has no canonical name is no file: what it is called counts */
    const std::string name = std::filesystem::weakly_canonical(path, ignored).string();
    if (ignored == std::errc::not_enough_memory)
        throw std::bad_alloc();
    if (files_.insert(ignored ? path : name).second)
        grow(read_ += bytes);
}

void Limits::take(int64_t bytes)
{
    const int64_t now = taken_ += bytes;
    if (now <= 0 || uint64_t(now) <= most_)
        return;
    taken_ -= bytes;
    gtx_error error;
    gtx_fail_limit(&error, GTX_LIMITED_MEMORY, stage, uint64_t(now), most_);
    throw Error(error);
}

thread_local unsigned Limits::lane = 0;

void Limits::work(uint64_t steps)
{
    const uint64_t done = worked_[lane] += steps, allowed = work_allowed();
    if (done <= allowed)
        return;
    gtx_error error;
    gtx_fail_limit(&error, GTX_LIMITED_WORK, stage, done, allowed);
    throw Error(error);
}

uint64_t Limits::work_allowed() const
{
    const uint64_t allowed = of(GTX_LIMITED_WORK);
    return given_.work ? allowed : uint64_t(std::min(more_work_ * double(allowed), 1e18));
}

MemoryScope::MemoryScope(Limits &limits) : outer_(account.limits)
{
    if (outer_)
        outer_->tell(account.untold);
    account = {&limits, 0};
}

MemoryScope::~MemoryScope()
{
    account.limits->tell(account.untold);
    account = {outer_, 0};
}

void take_memory(size_t bytes)
{
    cancel_point();
    if (!account.limits)
        return;
    account.untold += int64_t(bytes);
    if (account.untold < UNTOLD)
        return;
    const int64_t told = account.untold;
    account.untold = 0;
    try {
        account.limits->take(told);
    } catch (...) {
        account.untold = told - int64_t(bytes);
        throw;
    }
}

void give_memory(size_t bytes) noexcept
{
    if (!account.limits)
        return;
    account.untold -= int64_t(bytes);
    if (account.untold > -UNTOLD)
        return;
    const int64_t told = account.untold;
    account.untold = 0;
    account.limits->tell(told);
}

} // namespace gtx
