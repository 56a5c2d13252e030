/* Threads for gtx_jobs, as an engine's job system would give them. */
#ifndef GTX_HOST_JOBS_H
#define GTX_HOST_JOBS_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Runs jobs on the calling thread and others that live as long as the run: `threads` in all, at
 * most 64; 0 = as many as there are processors. Any thread. */
gtx_jobs gtx_host_jobs(uint32_t threads);

#ifdef __cplusplus
}
#endif
#endif
