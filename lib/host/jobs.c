/* Jobs on threads that take the next one as long as there is one. */
#define _POSIX_C_SOURCE 200809L
#include "host/jobs.h"

#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

enum { MAX_THREADS = 64 };

typedef struct run {
    void (*job)(uint32_t index, void *data);
    void *data;
    uint32_t count;
    _Atomic uint32_t next;
} run;

static void *work(void *data)
{
    run *r = data;
    for (uint32_t i; (i = atomic_fetch_add(&r->next, 1)) < r->count;)
        r->job(i, r->data);
    return NULL;
}

static void run_jobs(uint32_t count, void (*job)(uint32_t index, void *data), void *data,
                     void *user)
{
    run r = {job, data, count, 0};
    pthread_t helpers[MAX_THREADS];
    const uintptr_t threads = (uintptr_t)user;
    uint32_t started = 0;
    while (started + 1 < threads && started + 1 < count &&
           !pthread_create(&helpers[started], NULL, work, &r))
        ++started;
    work(&r);
    while (started > 0)
        pthread_join(helpers[--started], NULL);
}

gtx_jobs gtx_host_jobs(uint32_t threads)
{
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (!threads)
        threads = processors > 0 ? (uint32_t)processors : 1;
    threads = threads < MAX_THREADS ? threads : MAX_THREADS;
    return (gtx_jobs){run_jobs, (void *)(uintptr_t)threads};
}
