/* SPDX-License-Identifier: MIT */
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "checkx.h"
#include "common/pool.h"
#include "memory_fixture.h"

enum { MAX_PARTS = 500 };

static void count(void *context, int index)
{
    atomic_int *counts = context;
    atomic_fetch_add(&counts[index], 1);
}

START_TEST(every_part_runs_exactly_once_whatever_the_threads)
{
    static const int numbers[] = {0, 1, 2, 3, 7, 64, MAX_PARTS};
    L1L2Pool *pool = l1l2_pool_create(_i + 1);
    ck_assert_ptr_nonnull(pool);
    for (int round = 0; round < 50; round++)
        for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
            atomic_int counts[MAX_PARTS] = {0};
            l1l2_pool_run(pool, numbers[k], count, counts);
            for (int i = 0; i < MAX_PARTS; i++)
                if (atomic_load(&counts[i]) != (i < numbers[k]))
                    ck_abort_msg("part %d of %d ran %d times", i, numbers[k], atomic_load(&counts[i]));
        }
    l1l2_pool_free(pool);
}
END_TEST

/* No atomics: the pool itself must make what the parts wrote visible to the caller. */
static void write_square(void *context, int index)
{
    int *squares = context;
    squares[index] = index * index;
}

START_TEST(what_the_parts_wrote_is_there_when_run_returns)
{
    L1L2Pool *pool = l1l2_pool_create(4);
    for (int round = 0; round < 200; round++) {
        int squares[40] = {0};
        l1l2_pool_run(pool, 40, write_square, squares);
        for (int i = 0; i < 40; i++)
            if (squares[i] != i * i)
                ck_abort_msg("part %d wrote %d", i, squares[i]);
    }
    l1l2_pool_free(pool);
}
END_TEST

typedef struct Where {
    pthread_t caller;
    atomic_int elsewhere;
} Where;

static void note_thread(void *context, int index)
{
    Where *where = context;
    if (!pthread_equal(pthread_self(), where->caller))
        atomic_fetch_add(&where->elsewhere, 1);
}

START_TEST(a_pool_of_one_runs_on_the_callers_thread)
{
    Where where = {.caller = pthread_self()};
    L1L2Pool *pool = l1l2_pool_create(1);
    ck_assert_int_eq(l1l2_pool_threads(pool), 1);
    l1l2_pool_run(pool, 100, note_thread, &where);
    ck_assert_int_eq(atomic_load(&where.elsewhere), 0);
    l1l2_pool_free(pool);
}
END_TEST

static void wait_for_the_others(void *context, int index)
{
    pthread_barrier_wait(context);
}

/* Each part waits for the others: this ends only if three threads work at the same time, the caller among them. */
START_TEST(as_many_parts_run_at_once_as_there_are_threads)
{
    pthread_barrier_t barrier;
    ck_assert_int_eq(pthread_barrier_init(&barrier, NULL, 3), 0);
    L1L2Pool *pool = l1l2_pool_create(3);
    ck_assert_int_eq(l1l2_pool_threads(pool), 3);
    for (int round = 0; round < 20; round++)
        l1l2_pool_run(pool, 3, wait_for_the_others, &barrier);
    l1l2_pool_free(pool);
    pthread_barrier_destroy(&barrier);
}
END_TEST

typedef struct Mask {
    pthread_barrier_t barrier;
    pthread_t caller;
    atomic_int blocked;
} Mask;

static void note_mask(void *context, int index)
{
    Mask *mask = context;
    sigset_t set;
    pthread_sigmask(SIG_SETMASK, NULL, &set);
    if (!pthread_equal(pthread_self(), mask->caller) && sigismember(&set, SIGTERM) == 1)
        atomic_fetch_add(&mask->blocked, 1);
    pthread_barrier_wait(&mask->barrier);
}

START_TEST(signals_are_left_to_the_programs_own_threads)
{
    Mask mask = {.caller = pthread_self()};
    pthread_barrier_init(&mask.barrier, NULL, 2);
    L1L2Pool *pool = l1l2_pool_create(2);
    l1l2_pool_run(pool, 2, note_mask, &mask);
    ck_assert_int_eq(atomic_load(&mask.blocked), 1);
    sigset_t set;
    pthread_sigmask(SIG_SETMASK, NULL, &set);
    ck_assert_int_eq(sigismember(&set, SIGTERM), 0);
    l1l2_pool_free(pool);
    pthread_barrier_destroy(&mask.barrier);
}
END_TEST

START_TEST(zero_threads_means_one_per_core)
{
    L1L2Pool *pool = l1l2_pool_create(0);
    ck_assert_int_ge(l1l2_pool_threads(pool), 1);
    ck_assert_int_le(l1l2_pool_threads(pool), 64);
    l1l2_pool_free(pool);
}
END_TEST

typedef struct Task {
    pthread_t caller;
    pthread_barrier_t *barrier; /* on which the task waits; NULL: it does not wait */
    int calls;
    bool elsewhere;
} Task;

static void do_task(void *context)
{
    Task *task = context;
    if (task->barrier)
        pthread_barrier_wait(task->barrier);
    task->calls++;
    task->elsewhere = !pthread_equal(pthread_self(), task->caller);
}

/* No atomics here either: join must make what the task wrote visible to the caller. */
START_TEST(a_task_is_done_once_when_it_is_joined_whatever_the_threads)
{
    L1L2Pool *pool = l1l2_pool_create(_i + 1);
    for (int round = 0; round < 500; round++) {
        Task task = {.caller = pthread_self()};
        atomic_int counts[MAX_PARTS] = {0};
        l1l2_pool_start(pool, do_task, &task);
        if (round % 2)
            l1l2_pool_run(pool, 20, count, counts);
        l1l2_pool_join(pool);
        ck_assert_int_eq(task.calls, 1);
        for (int i = 0; round % 2 && i < 20; i++)
            ck_assert_int_eq(atomic_load(&counts[i]), 1);
        l1l2_pool_join(pool); /* there is no task any more */
        ck_assert_int_eq(task.calls, 1);
    }
    l1l2_pool_free(pool);
}
END_TEST

START_TEST(a_pool_of_one_does_the_task_at_once)
{
    L1L2Pool *pool = l1l2_pool_create(1);
    Task task = {.caller = pthread_self()};
    l1l2_pool_start(pool, do_task, &task);
    ck_assert_int_eq(task.calls, 1);
    ck_assert(!task.elsewhere);
    l1l2_pool_join(pool);
    l1l2_pool_free(pool);
}
END_TEST

static void wait_once_for_the_task(void *context, int index)
{
    if (index == 0)
        pthread_barrier_wait(context);
}

/* Waits at the barrier for the task: this ends only if a run works while the task does. */
START_TEST(a_run_and_a_task_go_on_at_the_same_time)
{
    pthread_barrier_t barrier;
    pthread_barrier_init(&barrier, NULL, 2);
    L1L2Pool *pool = l1l2_pool_create(2);
    for (int round = 0; round < 20; round++) {
        Task task = {.caller = pthread_self(), .barrier = &barrier};
        l1l2_pool_start(pool, do_task, &task);
        l1l2_pool_run(pool, 5, wait_once_for_the_task, &barrier);
        l1l2_pool_join(pool);
        ck_assert(task.elsewhere);
    }
    l1l2_pool_free(pool);
    pthread_barrier_destroy(&barrier);
}
END_TEST

START_TEST(no_memory_gives_no_pool)
{
    memory_fixture_begin();
    memory_countdown = 0;
    L1L2Pool *pool = l1l2_pool_create(2);
    ck_assert_int_eq(memory_alive, 0);
    memory_fixture_end();
    ck_assert_ptr_null(pool);
    l1l2_pool_free(NULL);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pool");
    TCase *tc = tcase_create("pool");
    tcase_add_loop_test(tc, every_part_runs_exactly_once_whatever_the_threads, 0, 5);
    tcase_add_test(tc, what_the_parts_wrote_is_there_when_run_returns);
    tcase_add_test(tc, a_pool_of_one_runs_on_the_callers_thread);
    tcase_add_test(tc, as_many_parts_run_at_once_as_there_are_threads);
    tcase_add_test(tc, signals_are_left_to_the_programs_own_threads);
    tcase_add_test(tc, zero_threads_means_one_per_core);
    tcase_add_loop_test(tc, a_task_is_done_once_when_it_is_joined_whatever_the_threads, 0, 4);
    tcase_add_test(tc, a_pool_of_one_does_the_task_at_once);
    tcase_add_test(tc, a_run_and_a_task_go_on_at_the_same_time);
    tcase_add_test(tc, no_memory_gives_no_pool);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
