/* SPDX-License-Identifier: MIT */
/* Each of the library's own allocations fails in turn: create reports it and leaks nothing. A running instance
 * allocates nothing. OpenCV's allocations fail on the thread that tracks a frame: no frame is lost. */
#include <errno.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#include <l1l2stab/l1l2stab.h>

#include "checkx.h"
#include "memory_fixture.h"
#include "synth.h"

enum { FRAMES = 40 };

/* OpenCV allocates its pictures with posix_memalign(). The function below replaces the C library's, because the
 * program's symbols have precedence. */
static atomic_bool failing;
static atomic_int refused;

int posix_memalign(void **p, size_t alignment, size_t size)
{
    *p = NULL;
    if (failing) {
        refused++;
        return ENOMEM;
    }
    *p = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    return *p ? 0 : ENOMEM;
}

static L1L2StabConfig small_config(void)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = 160, cfg.height = 96;
    cfg.window = 8;
    cfg.threads = 2;
    cfg.region[2] = 0.75; /* it takes memory */
    return cfg;
}

START_TEST(create_survives_the_failure_of_any_allocation)
{
    const L1L2StabConfig cfg = small_config();
    L1L2StabResult result = L1L2STAB_ERR_NOMEM;
    int failures = 0;
    memory_fixture_begin();
    for (; result != L1L2STAB_OK; failures++) {
        L1L2Stab *s = NULL;
        ck_assert_int_lt(failures, 1000);
        memory_countdown = failures;
        result = l1l2stab_create(&s, &cfg);
        memory_countdown = -1;
        if (result != L1L2STAB_OK) {
            ck_assert_int_eq(result, L1L2STAB_ERR_NOMEM);
            ck_assert_ptr_null(s);
        }
        l1l2stab_free(&s);
        ck_assert_int_eq(memory_alive, 0);
    }
    ck_assert_int_gt(failures, 20);
    memory_fixture_end();
}
END_TEST

START_TEST(a_running_instance_allocates_nothing)
{
    const L1L2StabConfig cfg = small_config();
    SynthConfig scene = synth_defaults();
    scene.width = cfg.width, scene.height = cfg.height;
    Synth *synth = synth_new(&scene);
    SynthPicture in[FRAMES];
    SynthPicture out = synth_picture_new(cfg.format, cfg.width, cfg.height);
    L1L2StabFrame frame = {0}, picture = {0};
    memcpy(picture.data, out.data, sizeof picture.data);
    memcpy(picture.stride, out.stride, sizeof picture.stride);
    L1L2Stab *s;
    memory_fixture_begin();
    ck_assert_int_eq(l1l2stab_create(&s, &cfg), L1L2STAB_OK);
    const int after_create = memory_alive;
    for (int t = 0; t < FRAMES; t++) {
        in[t] = synth_picture_new(cfg.format, cfg.width, cfg.height);
        synth_render(synth, t, cfg.format, in[t].data, in[t].stride);
        memcpy(frame.data, in[t].data, sizeof frame.data);
        memcpy(frame.stride, in[t].stride, sizeof frame.stride);
        ck_assert_int_eq(l1l2stab_push(s, &frame), L1L2STAB_OK);
        ck_assert_int_ge(l1l2stab_pull(s, &picture, NULL), L1L2STAB_OK);
        ck_assert_int_eq(memory_alive, after_create);
    }
    l1l2stab_free(&s);
    ck_assert_int_eq(memory_alive, 0);
    memory_fixture_end();
    for (int t = 0; t < FRAMES; t++)
        synth_picture_free(&in[t]);
    synth_picture_free(&out);
    synth_free(synth);
}
END_TEST

/* Frames 0 to FRAMES - 1 of a clip, by the loop of the public header: no call is made twice. */
typedef struct Run {
    L1L2Stab *s;
    SynthPicture in[FRAMES], out;
    int errors, pulled, released;
    unsigned flags[FRAMES];
} Run;

static void count_release(void *run)
{
    ((Run *)run)->released++;
}

/* Counts the error of measuring a frame. It is returned once, by this call alone. Memory is available again after an
 * allocation has failed. With two threads the next frame may already be measured by then, and fail too. */
static void take_error(Run *run)
{
    if (refused > 0)
        failing = false;
    const L1L2StabResult error = l1l2stab_take_error(run->s);
    if (error == L1L2STAB_OK)
        return;
    ck_assert_int_eq(error, L1L2STAB_ERR_NOMEM);
    ck_assert_int_gt(refused, 0);
    run->errors++;
    ck_assert_int_eq(l1l2stab_take_error(run->s), L1L2STAB_OK);
}

static void pull_all(Run *run)
{
    L1L2StabFrame picture = {0};
    L1L2StabInfo info;
    L1L2StabResult result;
    memcpy(picture.data, run->out.data, sizeof picture.data);
    memcpy(picture.stride, run->out.stride, sizeof picture.stride);
    while ((result = l1l2stab_pull(run->s, &picture, &info)) == L1L2STAB_OK) {
        ck_assert_int_eq(picture.pts, run->pulled);
        run->flags[run->pulled++] = info.flags;
        take_error(run);
    }
    ck_assert_int_ge(result, L1L2STAB_OK);
}

static void run_failing(Run *run, int threads, int first_failing)
{
    L1L2StabConfig cfg = small_config();
    cfg.threads = threads;
    *run = (Run){0};
    SynthConfig scene = synth_defaults();
    scene.width = cfg.width, scene.height = cfg.height;
    Synth *synth = synth_new(&scene);
    run->out = synth_picture_new(cfg.format, cfg.width, cfg.height);
    failing = false;
    refused = 0;
    ck_assert_int_eq(l1l2stab_create(&run->s, &cfg), L1L2STAB_OK);
    for (int t = 0; t < FRAMES; t++) {
        run->in[t] = synth_picture_new(cfg.format, cfg.width, cfg.height);
        synth_render(synth, t, cfg.format, run->in[t].data, run->in[t].stride);
        L1L2StabFrame frame = {.pts = t, .opaque = run, .release = count_release};
        memcpy(frame.data, run->in[t].data, sizeof frame.data);
        memcpy(frame.stride, run->in[t].stride, sizeof frame.stride);
        if (t == first_failing)
            failing = true;
        ck_assert_int_eq(l1l2stab_push(run->s, &frame), L1L2STAB_OK);
        take_error(run);
        pull_all(run);
    }
    ck_assert_int_eq(l1l2stab_finish(run->s), L1L2STAB_OK);
    take_error(run);
    pull_all(run);
    l1l2stab_free(&run->s);
    synth_picture_free(&run->out);
    for (int t = 0; t < FRAMES; t++)
        synth_picture_free(&run->in[t]);
    synth_free(synth);
}

START_TEST(an_error_of_measuring_is_returned_once_starts_a_path_and_loses_no_frame)
{
    static Run run;
    int path_starts = 0;
    for (int first_failing = 0; first_failing < FRAMES; first_failing += 3) {
        run_failing(&run, 1 + _i, first_failing);
        ck_assert_int_eq(run.errors > 0, refused > 0);
        ck_assert_int_le(run.errors, 1 + _i);
        ck_assert_int_eq(run.pulled, FRAMES);
        ck_assert_int_eq(run.released, FRAMES);
        int starts = 0, flagged = 0;
        for (int t = 0; t < FRAMES; t++)
            starts += t > 0 && (run.flags[t] & L1L2STAB_INFO_PATH_START) != 0;
        for (int t = 0; t < FRAMES; t++)
            if (run.flags[t] & L1L2STAB_INFO_MOTION_FAILED) {
                ck_assert((run.flags[t] & L1L2STAB_INFO_PATH_START) && (run.flags[t] & L1L2STAB_INFO_MOTION_LOST));
                flagged++;
            }
        ck_assert_int_le(starts, run.errors);
        ck_assert_int_eq(flagged, run.errors);
        /* The frame before may still be tracked, and a frame that needs no memory does not fail. */
        for (int t = 1; t < first_failing - 1; t++)
            ck_assert(!(run.flags[t] & L1L2STAB_INFO_PATH_START));
        path_starts += starts;
    }
    ck_assert_int_gt(path_starts, FRAMES / 3 / 2);
}
END_TEST

int main(int argc, char **argv)
{
    /* OpenCV decides when it is loaded how it allocates. */
    if (argc > 0 && !getenv("OPENCV_ENABLE_MEMALIGN")) {
        setenv("OPENCV_ENABLE_MEMALIGN", "1", 1);
        execvp(argv[0], argv);
    }
    Suite *suite = suite_create("oom");
    TCase *tcase = tcase_create("oom");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, create_survives_the_failure_of_any_allocation);
    tcase_add_test(tcase, a_running_instance_allocates_nothing);
    tcase_add_loop_test(tcase, an_error_of_measuring_is_returned_once_starts_a_path_and_loses_no_frame, 0, 2);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
