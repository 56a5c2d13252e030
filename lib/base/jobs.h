/* Jobs that may run at the same time, on the host's threads or one after the other. */
#ifndef GTX_BASE_JOBS_H
#define GTX_BASE_JOBS_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Runs job(i, data) for every i below `count`, as the host has it or, without, one by one. */
static inline void gtx_run_jobs(const gtx_jobs *jobs, uint32_t count,
                                void (*job)(uint32_t index, void *data), void *data)
{
    if (jobs && jobs->run && count > 1)
        jobs->run(count, job, data, jobs->user);
    else
        for (uint32_t i = 0; i < count; ++i)
            job(i, data);
}

/* The order in which jobs that take `work` begin: the longest first, for the others to fill up the
 * time. */
static inline void gtx_longest_first(const uint64_t *work, uint32_t count, uint32_t *order)
{
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t at = i;
        for (; at > 0 && work[order[at - 1]] < work[i]; --at)
            order[at] = order[at - 1];
        order[at] = i;
    }
}

#ifdef __cplusplus
}
#endif
#endif
