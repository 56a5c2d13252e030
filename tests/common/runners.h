/* Ways to run jobs that a host may have: the last first, or all at once, each on a thread. */
#ifndef GTX_TESTS_RUNNERS_H
#define GTX_TESTS_RUNNERS_H

#include <geotex/geotex.h>

#include <pthread.h>
#include <stdlib.h>

enum { RUNNERS = 2, RUNNER_THREADS = 128 };

/* Counts runs, to be looked at afterwards; a run within a run ends the program. */
typedef struct runner_log {
    unsigned runs, running;
} runner_log;

static void runner_enter(runner_log *log)
{
    ++log->runs;
    if (log->running++)
        abort();
}

static void run_backwards(uint32_t count, void (*job)(uint32_t, void *), void *data, void *user)
{
    runner_log *log = user;
    runner_enter(log);
    while (count-- > 0)
        job(count, data);
    --log->running;
}

typedef struct runner_thread {
    void (*job)(uint32_t, void *);
    void *data;
    uint32_t index;
    pthread_t thread;
} runner_thread;

static void *runner_work(void *data)
{
    const runner_thread *t = data;
    t->job(t->index, t->data);
    return NULL;
}

static void run_at_once(uint32_t count, void (*job)(uint32_t, void *), void *data, void *user)
{
    runner_thread threads[RUNNER_THREADS];
    runner_log *log = user;
    runner_enter(log);
    if (count > RUNNER_THREADS)
        abort();
    for (uint32_t i = 0; i < count; ++i) {
        threads[i] = (runner_thread){.job = job, .data = data, .index = i};
        if (pthread_create(&threads[i].thread, NULL, runner_work, &threads[i]))
            abort();
    }
    for (uint32_t i = 0; i < count; ++i)
        pthread_join(threads[i].thread, NULL);
    --log->running;
}

static gtx_jobs runner_of(int i, runner_log *log)
{
    *log = (runner_log){0, 0};
    return (gtx_jobs){i ? run_at_once : run_backwards, log};
}

#endif
