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

#ifdef __cplusplus
}
#endif
#endif
