/* SPDX-License-Identifier: MIT */
/*
 * Every allocation of a whole run fails in turn: the library's own, OSQP's, OpenCV's and those of the C++ and thread
 * libraries. This program defines malloc() and its relatives, and the dynamic linker prefers them to the C library's.
 *
 * Each case is a child process that creates an instance, pushes and pulls a short clip with a cut, finishes and frees.
 * Allocation number k fails, either alone or with all that follow it. A child must not crash or hang; it reports lost
 * frames, frames that are released more or less than once, wrong error codes and leaks.
 */
#include <errno.h>
#include <malloc.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <l1l2stab/l1l2stab.h>

#include "checkx.h"
#include "synth.h"

enum { WIDTH = 96, HEIGHT = 64, FRAMES = 8, CUT = 5, TIMEOUT_S = 60, SKIPPED = 77 };

/* The sanitizers replace the allocator themselves. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define SANITIZED 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#endif

#if defined(__GLIBC__) && !defined(SANITIZED)

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *p, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *p);

static atomic_bool counting; /* the calls below are those of the run */
static atomic_long calls, alive;
static long first_failing = -1; /* < 0: none */
static bool all_following_fail;

static bool fails(void)
{
    if (!counting)
        return false;
    const long call = calls++;
    const bool failing = first_failing >= 0 && (all_following_fail ? call >= first_failing : call == first_failing);
    if (failing)
        errno = ENOMEM;
    return failing;
}

static void *counted(void *p)
{
    alive += p != NULL && counting;
    return p;
}

void *malloc(size_t size)
{
    return fails() ? NULL : counted(__libc_malloc(size));
}

void *calloc(size_t count, size_t size)
{
    return fails() ? NULL : counted(__libc_calloc(count, size));
}

void *realloc(void *p, size_t size)
{
    if (fails())
        return NULL;
    return p ? __libc_realloc(p, size) : counted(__libc_realloc(p, size));
}

void *memalign(size_t alignment, size_t size)
{
    return fails() ? NULL : counted(__libc_memalign(alignment, size));
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return memalign(alignment, size);
}

int posix_memalign(void **p, size_t alignment, size_t size)
{
    *p = memalign(alignment, size);
    return *p ? 0 : ENOMEM;
}

void free(void *p)
{
    alive -= p != NULL && counting;
    __libc_free(p);
}

typedef enum Fault {
    GOOD,
    WRONG_CODE,       /* an error that is not ERR_NOMEM */
    NOT_RECOVERED,    /* one allocation failed, and a call failed more than twice */
    OUT_OF_ORDER,     /* a frame was pulled before an older one, or twice */
    LOST,             /* a frame was pushed and never pulled, though one allocation alone failed */
    NOT_RELEASED_ONCE /* a frame that was pushed was released more or less than once, or another was released */
} Fault;

static const char *const fault_names[] = {"good", "wrong error code", "no recovery", "frames out of order",
                                          "frame lost", "frame not released exactly once"};

/* What a child reports. */
typedef struct Outcome {
    Fault fault;
    long calls, alive;
} Outcome;

static SynthPicture clip[FRAMES], picture;
static int releases[FRAMES];
static Outcome *outcome; /* shared with the children */

static void count_release(void *opaque)
{
    ++*(int *)opaque;
}

static L1L2StabFrame frame_of(const SynthPicture *planes, int t)
{
    L1L2StabFrame frame = {.pts = t};
    memcpy(frame.data, planes->data, sizeof frame.data);
    memcpy(frame.stride, planes->stride, sizeof frame.stride);
    return frame;
}

/* True if a call that failed is to be made again. *tries counts down. */
static bool again(L1L2StabResult result, int *tries, Fault *fault)
{
    if (result >= L1L2STAB_OK)
        return false;
    if (result != L1L2STAB_ERR_NOMEM)
        *fault = WRONG_CODE;
    return --*tries > 0;
}

static L1L2StabResult push(L1L2Stab *s, int t, Fault *fault)
{
    L1L2StabFrame frame = frame_of(&clip[t], t);
    L1L2StabResult result;
    int tries = 3;
    frame.opaque = &releases[t];
    frame.release = count_release;
    while (again(result = l1l2stab_push(s, &frame), &tries, fault))
        ;
    return result;
}

/* Pulls what is ready. The number of the next frame is *next. */
static L1L2StabResult pull_all(L1L2Stab *s, int *next, int *pulled, Fault *fault)
{
    L1L2StabFrame out = frame_of(&picture, 0);
    L1L2StabResult result;
    int tries = 3;
    while ((result = l1l2stab_pull(s, &out, NULL)) == L1L2STAB_OK || again(result, &tries, fault))
        if (result == L1L2STAB_OK) {
            if (out.pts < *next)
                *fault = OUT_OF_ORDER;
            *next = (int)out.pts + 1;
            ++*pulled;
        }
    return result;
}

static Fault run_instance(L1L2Stab *s)
{
    Fault fault = GOOD;
    bool pushed[FRAMES], gave_up = false;
    int next = 0, pulled = 0, tries = 3, held = 0;
    for (int t = 0; t < FRAMES; t++) {
        pushed[t] = push(s, t, &fault) == L1L2STAB_OK;
        held += pushed[t];
        gave_up = pull_all(s, &next, &pulled, &fault) < L1L2STAB_OK || !pushed[t] || gave_up;
    }
    L1L2StabResult result;
    while (again(result = l1l2stab_finish(s), &tries, &fault))
        ;
    gave_up = result != L1L2STAB_OK || pull_all(s, &next, &pulled, &fault) != L1L2STAB_EOS || gave_up;
    result = l1l2stab_take_error(s);
    if (result != L1L2STAB_OK && result != L1L2STAB_ERR_NOMEM)
        fault = WRONG_CODE;
    l1l2stab_free(&s);
    for (int t = 0; t < FRAMES && fault == GOOD; t++)
        if (releases[t] != pushed[t])
            fault = NOT_RELEASED_ONCE;
    if (fault == GOOD && !all_following_fail)
        fault = gave_up ? NOT_RECOVERED : pulled != held ? LOST : GOOD;
    return fault;
}

static Fault run(int threads)
{
    L1L2StabConfig cfg;
    L1L2Stab *s = NULL;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.window = 6, cfg.overlap = 3;
    cfg.solver = L1L2STAB_SOLVER_CHECKED; /* OSQP works on every window */
    cfg.threads = threads;
    cfg.region[2] = 0.75; /* it takes memory, as the border does */
    cfg.border = L1L2STAB_BORDER_FILL;
    cfg.fill_frames = 4;
    const L1L2StabResult result = l1l2stab_create(&s, &cfg);
    if (result != L1L2STAB_OK)
        return result == L1L2STAB_ERR_NOMEM && !s ? GOOD : WRONG_CODE;
    return run_instance(s);
}

/* A run in a child. Returns NULL, or how it ended if it did not exit. */
static const char *run_child(int threads, long failing, bool following)
{
    static char ending[64];
    *outcome = (Outcome){0};
    const pid_t pid = fork();
    ck_assert_int_ge(pid, 0);
    if (pid == 0) {
        signal(SIGALRM, SIG_DFL); /* the test framework has a handler that ends the test */
        alarm(TIMEOUT_S);
        first_failing = failing;
        all_following_fail = following;
        counting = true;
        const Fault fault = run(threads);
        counting = false;
        *outcome = (Outcome){fault, calls, alive};
        _exit(EXIT_SUCCESS);
    }
    int status;
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    if (WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS)
        return NULL;
    if (WIFSIGNALED(status))
        snprintf(ending, sizeof ending, WTERMSIG(status) == SIGALRM ? "hangs" : "dies of signal %d", WTERMSIG(status));
    else
        snprintf(ending, sizeof ending, "exits with %d", WEXITSTATUS(status));
    return ending;
}

static void make_clip(void)
{
    SynthConfig scene = synth_defaults();
    scene.width = WIDTH, scene.height = HEIGHT;
    scene.shake = 1.0, scene.pan_x = 0.4;
    Synth *shots[2] = {synth_new(&scene), NULL};
    scene.seed++;
    shots[1] = synth_new(&scene);
    for (int t = 0; t < FRAMES; t++) {
        clip[t] = synth_picture_new(L1L2STAB_FORMAT_I420, WIDTH, HEIGHT);
        synth_render(shots[t >= CUT], t, L1L2STAB_FORMAT_I420, clip[t].data, clip[t].stride);
    }
    picture = synth_picture_new(L1L2STAB_FORMAT_I420, WIDTH, HEIGHT);
    synth_free(shots[0]);
    synth_free(shots[1]);
}

/* Caches that OpenCV and the C++ library keep for the life of the process. */
static const long caches = 2;

static void fail_each_in_turn(int threads, bool following)
{
    int faults = 0;
    outcome = mmap(NULL, sizeof *outcome, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ck_assert_ptr_ne(outcome, MAP_FAILED);
    ck_assert_ptr_null(run_child(threads, -1, false));
    ck_assert_int_eq(outcome->fault, GOOD);
    const Outcome whole = *outcome;
    ck_assert_int_gt(whole.calls, 300);
    for (long k = 0; k < whole.calls; k++) {
        const char *ending = run_child(threads, k, following);
        const char *fault = ending                                ? ending
                            : outcome->fault != GOOD              ? fault_names[outcome->fault]
                            : outcome->alive > whole.alive + caches ? "leak"
                                                                  : NULL;
        if (fault && faults++ < 20)
            printf("%d threads, allocation %ld%s: %s\n", threads, k, following ? " and all that follow" : "", fault);
    }
    printf("%d threads: %ld allocations failed%s, %d faults\n", threads, whole.calls,
           following ? " with all that follow" : " one by one", faults);
    ck_assert_int_eq(faults, 0);
    munmap(outcome, sizeof *outcome);
}

START_TEST(one_failed_allocation_loses_no_frame_and_leaks_nothing)
{
    make_clip();
    fail_each_in_turn(_i ? 3 : 1, false);
}
END_TEST

START_TEST(memory_that_stays_exhausted_is_reported_and_survived)
{
    make_clip();
    fail_each_in_turn(_i ? 3 : 1, true);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("every_allocation");
    TCase *tcase = tcase_create("every_allocation");
    tcase_set_timeout(tcase, 240);
    tcase_add_loop_test(tcase, one_failed_allocation_loses_no_frame_and_leaks_nothing, 0, 2);
    tcase_add_loop_test(tcase, memory_that_stays_exhausted_is_reported_and_survived, 0, 2);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}

#else

int main(void)
{
    fputs("skipped: the allocator cannot be replaced in this build\n", stderr);
    return SKIPPED;
}

#endif
