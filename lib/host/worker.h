/* A thread that does one job after another, for what must not stop a frame: reading, preparing. */
#ifndef GTX_HOST_WORKER_H
#define GTX_HOST_WORKER_H

#include <geotex/geotex.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_worker gtx_worker;

/* `job` is called on the thread, for each item in turn. Errors: MEMORY (or no thread is to be
 * had). */
gtx_result gtx_worker_create(void (*job)(void *item, void *user), void *user, gtx_worker **out,
                             gtx_error *error);
/* Ends the thread after the job that it is at. Items that are left, done or not, go to `drop`. NULL
 * is fine. */
void gtx_worker_destroy(gtx_worker *worker, void (*drop)(void *item));

/* Hands an item over. False when as many as it can hold are under way. */
int gtx_worker_push(gtx_worker *worker, void *item);
/* An item that is done, in the order of their jobs, or NULL. With `wait` waits for one while any is
 * under way. */
void *gtx_worker_pop(gtx_worker *worker, int wait);

#ifdef __cplusplus
}
#endif
#endif
