/* SPDX-License-Identifier: MIT */
/* Every allocation of the library's own fails once: create says so and leaves nothing behind; a running instance makes
 * none at all. */
#include <string.h>

#include <l1l2stab/l1l2stab.h>

#include "checkx.h"
#include "mem.h"
#include "synth.h"

static int countdown, alive;

static void *counting_alloc(size_t count, size_t size)
{
    if (countdown >= 0 && countdown-- == 0)
        return NULL;
    void *p = calloc(count, size);
    alive += p != NULL;
    return p;
}

static void counting_free(void *p)
{
    alive -= p != NULL;
    free(p);
}

static const L1L2MemHook hook = {counting_alloc, counting_free};

static L1L2StabConfig small_config(void)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = 160, cfg.height = 96;
    cfg.window = 8;
    cfg.threads = 2;
    return cfg;
}

START_TEST(create_survives_the_failure_of_any_allocation)
{
    const L1L2StabConfig cfg = small_config();
    L1L2StabResult result = L1L2STAB_ERR_NOMEM;
    int failures = 0;
    l1l2_mem_set_hook(&hook);
    for (; result != L1L2STAB_OK; failures++) {
        L1L2Stab *s = NULL;
        ck_assert_int_lt(failures, 1000);
        countdown = failures;
        result = l1l2stab_create(&s, &cfg);
        countdown = -1;
        if (result != L1L2STAB_OK) {
            ck_assert_int_eq(result, L1L2STAB_ERR_NOMEM);
            ck_assert_ptr_null(s);
        }
        l1l2stab_free(&s);
        ck_assert_int_eq(alive, 0);
    }
    ck_assert_int_gt(failures, 20);
    l1l2_mem_set_hook(NULL);
}
END_TEST

START_TEST(a_running_instance_takes_no_memory)
{
    const L1L2StabConfig cfg = small_config();
    SynthConfig scene = synth_defaults();
    scene.width = cfg.width, scene.height = cfg.height;
    Synth *synth = synth_new(&scene);
    enum { FRAMES = 40 };
    SynthPicture in[FRAMES];
    SynthPicture out = synth_picture_new(cfg.format, cfg.width, cfg.height);
    L1L2StabFrame frame = {0}, picture = {0};
    memcpy(picture.data, out.data, sizeof picture.data);
    memcpy(picture.stride, out.stride, sizeof picture.stride);
    L1L2Stab *s;
    l1l2_mem_set_hook(&hook);
    countdown = -1;
    ck_assert_int_eq(l1l2stab_create(&s, &cfg), L1L2STAB_OK);
    const int after_create = alive;
    for (int t = 0; t < FRAMES; t++) {
        in[t] = synth_picture_new(cfg.format, cfg.width, cfg.height);
        synth_render(synth, t, cfg.format, in[t].data, in[t].stride);
        memcpy(frame.data, in[t].data, sizeof frame.data);
        memcpy(frame.stride, in[t].stride, sizeof frame.stride);
        ck_assert_int_eq(l1l2stab_push(s, &frame), L1L2STAB_OK);
        ck_assert_int_ge(l1l2stab_pull(s, &picture, NULL), L1L2STAB_OK);
        ck_assert_int_eq(alive, after_create);
    }
    l1l2stab_free(&s);
    ck_assert_int_eq(alive, 0);
    l1l2_mem_set_hook(NULL);
    for (int t = 0; t < FRAMES; t++)
        synth_picture_free(&in[t]);
    synth_picture_free(&out);
    synth_free(synth);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("oom");
    TCase *tcase = tcase_create("oom");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, create_survives_the_failure_of_any_allocation);
    tcase_add_test(tcase, a_running_instance_takes_no_memory);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
