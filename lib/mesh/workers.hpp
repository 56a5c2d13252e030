/* Threads that wait between the parallel parts of a job: many a part takes less than to start one
 * does. */
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace gtx {

class Workers {
public:
    /* What threads are called for. It may not throw. */
    struct Call {
        std::function<void()> run;
        size_t running = 0;      /* threads */
    };

    Workers() = default;
    /* When no call is out. */
    ~Workers();
    Workers(const Workers &) = delete;
    Workers &operator=(const Workers &) = delete;

    /* Has so many threads run it, each once; fewer where the system has no more. The call stays
     * where it is until it is over. */
    void call(Call &call, size_t threads);
    /* Takes it back from those that have not begun, waits for the others, and says whether they
     * have come to their end in that time. */
    bool is_over(Call &call, std::chrono::duration<double> wait);

private:
    void run();

    std::mutex mutex_;
    std::condition_variable called_, ended_;
    std::deque<Call *> calls_;   /* one for each thread that is to begin */
    size_t idle_ = 0;            /* threads that wait, or are about to look for a call */
    bool leave_ = false;
    std::vector<std::thread> threads_;
};

} // namespace gtx
