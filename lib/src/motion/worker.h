/* SPDX-License-Identifier: MIT */
/*
 * Measures one frame's motion on a thread of the caller's pool, so that tracking of frame t + N - 1 and warping of
 * frame t overlap. The result depends on the order of the frames alone, not on the threads.
 */
#ifndef L1L2_MOTION_WORKER_H
#define L1L2_MOTION_WORKER_H

#include "common/pool.h"
#include "motion/motion.h"

typedef struct L1L2MotionWorker L1L2MotionWorker;

/* On error *out is NULL. pool and cfg->log must outlive the object. */
L1L2StabResult l1l2_motion_worker_create(L1L2MotionWorker **out, const L1L2MotionConfig *cfg, L1L2Pool *pool);

/* Waits for the frame that was begun. */
void l1l2_motion_worker_free(L1L2MotionWorker *a);

/* Waits for the frame that was begun and drops it, then resets the motion as l1l2_motion_reset() does. */
void l1l2_motion_worker_reset(L1L2MotionWorker *a);

/* Begins l1l2_motion_push() for a frame. The picture must stay valid until l1l2_motion_worker_take(). One frame at a
 * time: the one before must have been taken. */
void l1l2_motion_worker_begin(L1L2MotionWorker *a, const uint8_t *data, ptrdiff_t stride, bool starts_path);

/* True if a frame was begun and not yet taken. */
bool l1l2_motion_worker_is_open(const L1L2MotionWorker *a);

/* Waits for the frame that was begun and returns what l1l2_motion_push() did. Its messages are logged now, on the
 * caller's thread. */
L1L2StabResult l1l2_motion_worker_take(L1L2MotionWorker *a, L1L2MotionResult *out);

#endif
