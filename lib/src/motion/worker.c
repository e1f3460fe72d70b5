/* SPDX-License-Identifier: MIT */
#include "motion/worker.h"

#include <stdio.h>

#include "common/log.h"
#include "common/mem.h"

enum { MAX_MESSAGES = 8, MESSAGE_BYTES = 500 };

typedef struct Message {
    L1L2StabLogLevel level;
    char text[MESSAGE_BYTES];
} Message;

struct L1L2MotionWorker {
    L1L2Motion *motion;
    L1L2Pool *pool;
    const L1L2StabLogger *log; /* the caller's, which is called on the caller's thread alone */
    L1L2StabLogger keep;       /* the motion's, which keeps the messages until then */
    Message message[MAX_MESSAGES];
    int messages;

    /* The frame that was begun: used by the pool's thread until it is taken. */
    bool open;
    const uint8_t *data;
    ptrdiff_t stride;
    bool starts_path;
    L1L2StabResult result;
    L1L2MotionResult measured;
};

static void keep_message(void *cookie, L1L2StabLogLevel level, const char *text)
{
    L1L2MotionWorker *a = cookie;
    if (a->messages == MAX_MESSAGES)
        return;
    Message *message = &a->message[a->messages++];
    message->level = level;
    snprintf(message->text, sizeof message->text, "%s", text);
}

static void pass_messages_on(L1L2MotionWorker *a)
{
    for (int i = 0; i < a->messages; i++)
        l1l2_log(a->log, a->message[i].level, "%s", a->message[i].text);
    a->messages = 0;
}

L1L2StabResult l1l2_motion_worker_create(L1L2MotionWorker **out, const L1L2MotionConfig *cfg, L1L2Pool *pool)
{
    *out = NULL;
    L1L2MotionWorker *a = l1l2_mem_new(1, sizeof *a);
    if (!a)
        return L1L2STAB_ERR_NOMEM;
    a->pool = pool;
    a->log = cfg->log;
    a->keep = (L1L2StabLogger){.write = cfg->log && cfg->log->write ? keep_message : NULL, .cookie = a,
                               .max_level = cfg->log ? cfg->log->max_level : L1L2STAB_LOG_ERROR};
    L1L2MotionConfig motion = *cfg;
    motion.log = &a->keep;
    const L1L2StabResult result = l1l2_motion_create(&a->motion, &motion);
    pass_messages_on(a);
    if (result != L1L2STAB_OK) {
        l1l2_motion_worker_free(a);
        return result;
    }
    *out = a;
    return L1L2STAB_OK;
}

void l1l2_motion_worker_free(L1L2MotionWorker *a)
{
    if (!a)
        return;
    if (a->open)
        l1l2_pool_join(a->pool);
    l1l2_motion_free(a->motion);
    l1l2_mem_free(a);
}

void l1l2_motion_worker_reset(L1L2MotionWorker *a)
{
    if (a->open)
        l1l2_pool_join(a->pool);
    a->open = false;
    l1l2_motion_reset(a->motion);
    pass_messages_on(a);
}

static void measure(void *context)
{
    L1L2MotionWorker *a = context;
    a->result = l1l2_motion_push(a->motion, a->data, a->stride, a->starts_path, &a->measured);
}

void l1l2_motion_worker_begin(L1L2MotionWorker *a, const uint8_t *data, ptrdiff_t stride, bool starts_path)
{
    a->open = true;
    a->data = data;
    a->stride = stride;
    a->starts_path = starts_path;
    l1l2_pool_start(a->pool, measure, a);
}

bool l1l2_motion_worker_is_open(const L1L2MotionWorker *a)
{
    return a->open;
}

L1L2StabResult l1l2_motion_worker_take(L1L2MotionWorker *a, L1L2MotionResult *out)
{
    l1l2_pool_join(a->pool);
    a->open = false;
    pass_messages_on(a);
    *out = a->measured;
    return a->result;
}
