/* Threads that wait for calls. */
#include "mesh/workers.hpp"

#include <algorithm>
#include <system_error>

namespace gtx {

Workers::~Workers()
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        leave_ = true;
    }
    called_.notify_all();
    for (std::thread &thread : threads_)
        thread.join();
}

void Workers::call(Call &call, size_t threads)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    calls_.insert(calls_.end(), threads, &call);
    try {
        for (; idle_ < calls_.size(); ++idle_)
            threads_.emplace_back([this] { run(); });
    } catch (const std::system_error &) { /* no more threads: fewer do the same */
    }
    for (size_t i = 0; i < threads; ++i)
        called_.notify_one();
}

bool Workers::is_over(Call &call, std::chrono::duration<double> wait)
{
    std::unique_lock<std::mutex> lock(mutex_);
    calls_.erase(std::remove(calls_.begin(), calls_.end(), &call), calls_.end());
    return ended_.wait_for(lock, wait, [&] { return call.running == 0; });
}

void Workers::run()
{
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
        called_.wait(lock, [this] { return leave_ || !calls_.empty(); });
        if (calls_.empty())
            return;
        Call &call = *calls_.front();
        calls_.pop_front();
        --idle_;
        ++call.running;
        lock.unlock();
        call.run();
        lock.lock();
        ++idle_;
        if (--call.running == 0)
            ended_.notify_all();
    }
}

} // namespace gtx
