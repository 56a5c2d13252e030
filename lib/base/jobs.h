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

/* What jobs may take in all, in steps that they count. */
typedef struct gtx_budget {
    uint64_t most, done;
} gtx_budget;

typedef struct gtx_batch {
    void (*job)(uint32_t index, void *data);
    void *data;
    uint32_t first;
} gtx_batch;

static inline void gtx_run_in_batch(uint32_t index, void *data)
{
    const gtx_batch *batch = (const gtx_batch *)data;
    batch->job(batch->first + index, batch->data);
}

/* The same in batches, until the budget is spent: false then, the same whatever the order of jobs.
 * Each job writes the steps that it took to its place in `steps`, and gives up once they are more
 * than the budget has left, which stays as it is while a batch runs. */
static inline int gtx_run_within(gtx_budget *budget, const gtx_jobs *jobs, uint32_t count,
                                 void (*job)(uint32_t index, void *data), void *data,
                                 const uint64_t *steps)
{
    enum { BATCH = 16 };
    for (uint32_t first = 0; first < count; first += BATCH) {
        const uint32_t size = count - first < BATCH ? count - first : BATCH;
        gtx_batch batch = {job, data, first};
        gtx_run_jobs(jobs, size, gtx_run_in_batch, &batch);
        for (uint32_t i = first; i < first + size; ++i)
            budget->done += steps[i];
        if (budget->done > budget->most)
            return 0;
    }
    return 1;
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
