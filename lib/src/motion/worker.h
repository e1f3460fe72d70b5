/* SPDX-License-Identifier: MIT */
/*
 * One frame's motion, measured beside the caller on a thread of its pool: tracking of frame t + N - 1 and warping of
 * frame t overlap. What is measured depends on the order of the frames alone, not on the threads.
 */
#ifndef L1L2_MOTION_WORKER_H
#define L1L2_MOTION_WORKER_H

#include "common/pool.h"
#include "motion/motion.h"

typedef struct L1L2MotionWorker L1L2MotionWorker;

/* On error *out is NULL. pool and cfg->log must outlive the object. */
L1L2StabResult l1l2_motion_worker_create(L1L2MotionWorker **out, const L1L2MotionConfig *cfg, L1L2Pool *pool);

/* Waits for what was begun. */
void l1l2_motion_worker_free(L1L2MotionWorker *a);

/* As new, with its memory kept; what was begun is waited for and dropped. */
void l1l2_motion_worker_reset(L1L2MotionWorker *a);

/* As l1l2_motion_push(), which may happen up to l1l2_motion_worker_take(): the picture must stay until then. One frame
 * at a time: the one before must have been taken. */
void l1l2_motion_worker_begin(L1L2MotionWorker *a, const uint8_t *data, ptrdiff_t stride, bool starts_path);

/* A frame was begun and not yet taken. */
bool l1l2_motion_worker_is_open(const L1L2MotionWorker *a);

/* What l1l2_motion_push() gave for the frame that was begun. Its messages are logged now, on the caller's thread. */
L1L2StabResult l1l2_motion_worker_take(L1L2MotionWorker *a, L1L2MotionResult *out);

#endif
