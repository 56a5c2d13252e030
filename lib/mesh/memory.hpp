/* Memory that a job takes, counted and held to its limit where containers take it. */
#pragma once

#include "base/limits.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <set>
#include <string>
#include <vector>

namespace gtx {

/* The limits of one job, and the memory that it holds. Any of its threads may use it. */
class Limits {
public:
    explicit Limits(const gtx_limits &given = {}) : given_(given) { grow(0); }

    /* The job has read a file of so many bytes: defaults grow, once for each file. For the calling
     * thread alone. */
    void read(const std::string &path, uint64_t bytes);
    uint64_t bytes_read() const { return read_; }
    uint64_t of(gtx_limited which) const { return gtx_limit_of(&given_, which, read_); }
    /* Throws Error(LIMIT) if `what` would take more than is allowed. */
    void require(gtx_limited which, const char *what, uint64_t wanted) const;

    /* Throws Error(LIMIT), and takes nothing, where that would be more memory than is allowed. */
    void take(int64_t bytes);
    /* Bytes that are taken already, or given back where negative. */
    void tell(int64_t bytes) noexcept { taken_ += bytes; }
    const gtx_limits &given() const { return given_; }

    /* Throws Error(LIMIT) once more steps than are allowed have been done in the thread's lane. */
    void work(uint64_t steps);
    /* What follows in it may do as much once more. */
    void work_again() noexcept { worked_[lane] = 0; }
    /* Of things done at once, for each to count its own work alone. */
    static constexpr unsigned LANES = 3;
    static thread_local unsigned lane;
    /* Options that ask for more may do so many times as much as the default. */
    void allow_work(double times) noexcept { more_work_ = times; }

    /* What takes memory now, for the message; static. */
    std::atomic<const char *> stage{"reading"};

private:
    uint64_t work_allowed() const;
    void grow(uint64_t bytes_read)
    {
        most_ = gtx_limit_of(&given_, GTX_LIMITED_MEMORY, bytes_read);
    }
    gtx_limits given_;
    std::set<std::string> files_;
    std::atomic<uint64_t> read_{0}, most_{0};
    std::atomic<int64_t> taken_{0};
    std::atomic<uint64_t> worked_[LANES] = {};
    double more_work_ = 1;
};

/* For as long as it lives, what the thread's containers take counts against these limits. */
class MemoryScope {
public:
    explicit MemoryScope(Limits &limits);
    ~MemoryScope();
    MemoryScope(const MemoryScope &) = delete;
    MemoryScope &operator=(const MemoryScope &) = delete;

private:
    Limits *outer_;
};

/* On a thread without a scope they do nothing. */
void take_memory(size_t bytes);
void give_memory(size_t bytes) noexcept;

/* Memory that others take for the job: decoders. */
class TakenMemory {
public:
    explicit TakenMemory(size_t bytes) : bytes_(bytes) { take_memory(bytes); }
    ~TakenMemory() { give_memory(bytes_); }
    TakenMemory(const TakenMemory &) = delete;
    TakenMemory &operator=(const TakenMemory &) = delete;

private:
    size_t bytes_;
};

template <class T> struct CountingAllocator {
    using value_type = T;
    CountingAllocator() = default;
    template <class U> CountingAllocator(const CountingAllocator<U> &) {}

    T *allocate(size_t count)
    {
        if (count > SIZE_MAX / sizeof(T))
            throw std::bad_array_new_length();
        take_memory(count * sizeof(T));
        try {
            return static_cast<T *>(::operator new(count * sizeof(T)));
        } catch (...) {
            give_memory(count * sizeof(T));
            throw;
        }
    }
    void deallocate(T *memory, size_t count)
    {
        give_memory(count * sizeof(T));
        ::operator delete(memory);
    }
    friend bool operator==(const CountingAllocator &, const CountingAllocator &) { return true; }
    friend bool operator!=(const CountingAllocator &, const CountingAllocator &) { return false; }
};

/* What the cooker's rooms keep their data in. */
template <class T> using Vector = std::vector<T, CountingAllocator<T>>;
using Bytes = std::basic_string<char, std::char_traits<char>, CountingAllocator<char>>;

} // namespace gtx
