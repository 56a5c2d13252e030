/* One thread and a ring of items: handed over, taken, done. */
#define _POSIX_C_SOURCE 200809L
#include "host/worker.h"

#include "base/error.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

enum { ROOM = 1024 };

struct gtx_worker {
    void (*job)(void *item, void *user);
    void *user;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    void *items[ROOM];
    size_t first, done, end; /* of all that ever came: not yet taken back, worked on, the next */
    bool ending;
};

static void *work(void *data)
{
    gtx_worker *w = data;
    pthread_mutex_lock(&w->lock);
    for (;;) {
        while (!w->ending && w->done == w->end)
            pthread_cond_wait(&w->changed, &w->lock);
        if (w->ending)
            break;
        void *item = w->items[w->done % ROOM];
        pthread_mutex_unlock(&w->lock);
        w->job(item, w->user);
        pthread_mutex_lock(&w->lock);
        ++w->done;
        pthread_cond_broadcast(&w->changed);
    }
    pthread_mutex_unlock(&w->lock);
    return NULL;
}

gtx_result gtx_worker_create(void (*job)(void *item, void *user), void *user, gtx_worker **out,
                             gtx_error *error)
{
    gtx_worker *w = calloc(1, sizeof *w);
    *out = NULL;
    if (!w)
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory for a worker");
    w->job = job;
    w->user = user;
    pthread_mutex_init(&w->lock, NULL);
    pthread_cond_init(&w->changed, NULL);
    if (pthread_create(&w->thread, NULL, work, w)) {
        free(w);
        return gtx_fail(error, GTX_ERROR_MEMORY, "there is no thread for a worker");
    }
    *out = w;
    return GTX_OK;
}

void gtx_worker_destroy(gtx_worker *w, void (*drop)(void *item))
{
    if (!w)
        return;
    pthread_mutex_lock(&w->lock);
    w->ending = true;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
    pthread_join(w->thread, NULL);
    for (; w->first < w->end; ++w->first)
        drop(w->items[w->first % ROOM]);
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->lock);
    free(w);
}

int gtx_worker_push(gtx_worker *w, void *item)
{
    pthread_mutex_lock(&w->lock);
    const bool room = w->end - w->first < ROOM;
    if (room)
        w->items[w->end++ % ROOM] = item;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
    return room;
}

void *gtx_worker_pop(gtx_worker *w, int wait)
{
    void *item = NULL;
    pthread_mutex_lock(&w->lock);
    while (wait && w->first == w->done && w->first < w->end)
        pthread_cond_wait(&w->changed, &w->lock);
    if (w->first < w->done)
        item = w->items[w->first++ % ROOM];
    pthread_mutex_unlock(&w->lock);
    return item;
}
