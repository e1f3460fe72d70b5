/* SPDX-License-Identifier: MIT */
/*
 * A persistent pool of threads. The caller of l1l2_pool_run() works too, so a pool of one thread has no helper. One
 * mutex guards everything. A part is dozens of rows of a picture, so locking the mutex to take one costs little in
 * comparison.
 */
#include "common/pool.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdbool.h>
#include <unistd.h>

#include "common/mem.h"

enum { MAX_THREADS = 64 };

struct L1L2Pool {
    pthread_mutex_t mutex;
    pthread_cond_t work; /* parts or the task can be taken, or the pool closes */
    pthread_cond_t done; /* the last part or the task is finished */
    bool has_mutex, has_work, has_done;

    int helpers; /* threads beside the caller's */
    pthread_t helper[MAX_THREADS];

    /* Guarded by the mutex. Between runs next == parts. */
    bool closing;
    int parts, next, unfinished;
    void (*part)(void *context, int index);
    void *context;
    void (*task)(void *context); /* that no thread has begun; NULL: none */
    void *task_context;
    bool task_runs;
};

static int count_cores(void)
{
#ifdef CPU_COUNT /* Linux: a process may be kept to some of the cores */
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0)
        return CPU_COUNT(&allowed);
#endif
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > MAX_THREADS ? MAX_THREADS : online > 0 ? (int)online : 1;
}

/* Takes parts until none is left. The mutex is held on entry and on return. */
static void work(L1L2Pool *pool)
{
    while (pool->next < pool->parts) {
        const int index = pool->next++;
        pthread_mutex_unlock(&pool->mutex);
        pool->part(pool->context, index);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->unfinished == 0)
            pthread_cond_signal(&pool->done);
    }
}

/* Does the task, if it has not been begun. The mutex is held on entry and on return. */
static void do_task(L1L2Pool *pool)
{
    if (!pool->task)
        return;
    void (*const task)(void *context) = pool->task;
    pool->task = NULL;
    pool->task_runs = true;
    pthread_mutex_unlock(&pool->mutex);
    task(pool->task_context);
    pthread_mutex_lock(&pool->mutex);
    pool->task_runs = false;
    pthread_cond_signal(&pool->done);
}

static void *help(void *arg)
{
    L1L2Pool *pool = arg;
    pthread_mutex_lock(&pool->mutex);
    while (!pool->closing) {
        do_task(pool);
        work(pool);
        if (!pool->closing && !pool->task)
            pthread_cond_wait(&pool->work, &pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

/* The helpers block all signals, so that the program's own threads handle them. */
static void start_helpers(L1L2Pool *pool, int helpers)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (pool->helpers < helpers && pthread_create(&pool->helper[pool->helpers], NULL, help, pool) == 0)
        pool->helpers++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

L1L2Pool *l1l2_pool_create(int threads)
{
    L1L2Pool *pool = l1l2_mem_new(1, sizeof *pool);
    if (!pool)
        return NULL;
    pool->has_mutex = pthread_mutex_init(&pool->mutex, NULL) == 0;
    pool->has_work = pthread_cond_init(&pool->work, NULL) == 0;
    pool->has_done = pthread_cond_init(&pool->done, NULL) == 0;
    if (!pool->has_mutex || !pool->has_work || !pool->has_done) {
        l1l2_pool_free(pool);
        return NULL;
    }
    if (threads <= 0)
        threads = count_cores();
    start_helpers(pool, (threads < MAX_THREADS ? threads : MAX_THREADS) - 1);
    return pool;
}

void l1l2_pool_free(L1L2Pool *pool)
{
    if (!pool)
        return;
    if (pool->helpers > 0) {
        pthread_mutex_lock(&pool->mutex);
        pool->closing = true;
        pthread_cond_broadcast(&pool->work);
        pthread_mutex_unlock(&pool->mutex);
        for (int i = 0; i < pool->helpers; i++)
            pthread_join(pool->helper[i], NULL);
    }
    if (pool->has_done)
        pthread_cond_destroy(&pool->done);
    if (pool->has_work)
        pthread_cond_destroy(&pool->work);
    if (pool->has_mutex)
        pthread_mutex_destroy(&pool->mutex);
    l1l2_mem_free(pool);
}

int l1l2_pool_threads(const L1L2Pool *pool)
{
    return pool->helpers + 1;
}

void l1l2_pool_run(L1L2Pool *pool, int parts, void (*part)(void *context, int index), void *context)
{
    if (!pool || pool->helpers == 0 || parts <= 1) {
        for (int i = 0; i < parts; i++)
            part(context, i);
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->part = part;
    pool->context = context;
    pool->parts = parts;
    pool->next = 0;
    pool->unfinished = parts;
    pthread_cond_broadcast(&pool->work);
    work(pool);
    while (pool->unfinished > 0)
        pthread_cond_wait(&pool->done, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}

void l1l2_pool_start(L1L2Pool *pool, void (*task)(void *context), void *context)
{
    if (pool->helpers == 0) {
        task(context);
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->task = task;
    pool->task_context = context;
    pthread_cond_signal(&pool->work);
    pthread_mutex_unlock(&pool->mutex);
}

void l1l2_pool_join(L1L2Pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    do_task(pool);
    while (pool->task_runs)
        pthread_cond_wait(&pool->done, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}
