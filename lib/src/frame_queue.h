/* SPDX-License-Identifier: MIT */
/*
 * The frames that are held, one record each: all that is known of a frame from push to pull, in one place. The queue
 * has a fixed capacity and gives each frame back to its owner exactly once.
 *
 * Frames are numbered from 0 since create or reset. The camera path and the rolling-shutter filter work on their fields
 * of these records (common/frame_column.h). They still read a few frames after these have been pulled, so their records
 * are kept for a while.
 */
#ifndef L1L2_FRAME_QUEUE_H
#define L1L2_FRAME_QUEUE_H

#include <stdbool.h>

#include "common/frame_column.h"
#include "motion/motion.h"
#include "path/path.h"
#include "rolling_shutter/filter.h"

typedef struct L1L2QueuedFrame {
    L1L2StabFrame frame;         /* the caller's */
    double lambda, crop_ratio;   /* as they were set when the frame was pushed */
    double step;                 /* time since the frame before, nominal frames (frame_time.h) */
    L1L2StabMotionSource source; /* of path.F */
    int tracks, inliers;
    double quality;
    bool failed;                 /* measuring met an error */
    bool bridged;                /* a bridge over frames that could not be tracked changed the motion */
    L1L2PathFrame path;          /* motion F, in diagonals, and what the path makes of it */
    double F_px[9];              /* the same motion as the caller sees it (units.h) */
    L1L2ShutterFrame shutter;    /* what the motion leaves */
    int64_t scale_ns, track_ns, fit_ns, solve_ns;
} L1L2QueuedFrame;

typedef struct L1L2FrameQueue {
    L1L2QueuedFrame *records; /* frame t is at t modulo rows */
    int capacity;             /* frames that can be held */
    int keep;                 /* frames that were dropped last whose pixels are kept */
    int rows;                 /* capacity, and L1L2_FRAME_QUEUE_PAST or keep, whichever is larger */
    int64_t begin, end;       /* held are the frames t with begin <= t < end */
    int64_t kept;             /* frames t with kept <= t < begin were dropped, but not yet released */
} L1L2FrameQueue;

enum { L1L2_FRAME_QUEUE_PAST = 8 }; /* pulled frames whose records are kept */

/* False when out of memory. */
bool l1l2_frame_queue_init(L1L2FrameQueue *queue, int capacity, int keep);

/* Releases what is held and kept, and frees the memory; fine on a zeroed queue. */
void l1l2_frame_queue_clear(L1L2FrameQueue *queue);

/* Releases what is held and kept; numbers begin at 0 again. */
void l1l2_frame_queue_reset(L1L2FrameQueue *queue);

/* How many frames are held. */
int l1l2_frame_queue_count(const L1L2FrameQueue *queue);

/* Appends a record, cleared to zero; the queue must not be full. The record does not move while the frame is held. */
L1L2QueuedFrame *l1l2_frame_queue_append(L1L2FrameQueue *queue);

/* One must be held. */
L1L2QueuedFrame *l1l2_frame_queue_oldest(const L1L2FrameQueue *queue);
L1L2QueuedFrame *l1l2_frame_queue_newest(const L1L2FrameQueue *queue);

/* A frame that is held or kept: number t, [kept, end). */
L1L2QueuedFrame *l1l2_frame_queue_at(const L1L2FrameQueue *queue, int64_t t);

/* Drops the oldest frame. A frame is released when `keep` more have been dropped. */
void l1l2_frame_queue_drop_oldest(L1L2FrameQueue *queue);

/* Releases the frames that were dropped and kept. */
void l1l2_frame_queue_release_kept(L1L2FrameQueue *queue);

/* The fields of all frames that the path and the filter work on, and the motions alone. */
L1L2FrameColumn l1l2_frame_queue_path_frames(const L1L2FrameQueue *queue);
L1L2FrameColumn l1l2_frame_queue_shutter_frames(const L1L2FrameQueue *queue);
L1L2FrameColumn l1l2_frame_queue_motions(const L1L2FrameQueue *queue);

#endif
