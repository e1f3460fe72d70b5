/* SPDX-License-Identifier: MIT */
/* A small persistent pool of threads: for work that falls into independent parts, such as the rows of a picture, and
 * for one task beside the caller. */
#ifndef L1L2_COMMON_POOL_H
#define L1L2_COMMON_POOL_H

typedef struct L1L2Pool L1L2Pool;

/* threads >= 1 counts the caller's own; 0: as many as there are cores this process may use. There are fewer if the
 * system refuses to start so many. NULL when out of memory. */
L1L2Pool *l1l2_pool_create(int threads);
void l1l2_pool_free(L1L2Pool *pool);

/* How many threads work, the caller's included. */
int l1l2_pool_threads(const L1L2Pool *pool);

/* Calls part(context, 0) ... part(context, parts - 1), each once, in any order and on any thread; returns when all
 * are done. One run at a time. pool NULL: on the caller's thread alone. */
void l1l2_pool_run(L1L2Pool *pool, int parts, void (*part)(void *context, int index), void *context);

/* Calls task(context) on another thread while the caller goes on. A pool of one thread calls it at once. Runs that
 * happen meanwhile use the other threads, and the task's thread too once the task is done. One task at a time: join
 * before the next. */
void l1l2_pool_start(L1L2Pool *pool, void (*task)(void *context), void *context);

/* Waits until the task is done, if there is one. If no thread has begun it yet, the caller's thread does it. */
void l1l2_pool_join(L1L2Pool *pool);

#endif
