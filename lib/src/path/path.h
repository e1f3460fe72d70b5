/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, steps 2 and 3, over a stream of any length: inter-frame motions in, update transforms out.
 *
 * Time is counted in nominal frames. Where the frames are not evenly spaced, each is pushed with its step, and the path
 * is smooth in time (problem.h).
 *
 * Numbers only, no pixels. Unit: the frame's diagonal. All maps are of one motion model: with translations the picture
 * is moved, never turned or zoomed. A path is the frames from one cut to the next; windows, joins and ends are those of
 * window_schedule.h. C_t is taken relative to each window's first frame, so numbers stay near 1 however long the
 * video is.
 *
 * Joins (paper, section 4.1)
 *   continuous  the differences of a window reach back over the last three frames emitted before it, as constants.
 *   blend       eq. (8) on the K shared frames. As printed, v_i = i/K weighs the OLD window: it would jump at both
 *               ends. The weights run the other way here: old 1 - i/(K+1), new i/(K+1), i = 1..K.
 * Around an early window (window_schedule.h) every join is a continuous one.
 */
#ifndef L1L2_PATH_PATH_H
#define L1L2_PATH_PATH_H

#include <stdbool.h>
#include <stdint.h>

#include <l1l2stab/l1l2stab.h>

#include "common/frame_column.h"
#include "common/geom.h"
#include "path/solver.h"

typedef struct L1L2Path L1L2Path;

typedef struct L1L2PathConfig {
    double width, height; /* of the frame as it is shown: only their ratio matters */
    double frame_rate;  /* frames a second; 0: 30 */
    double weights[3];  /* of eq. (3); 1, 1, 1 in eq. (5) */
    int window, overlap; /* N, K */
    L1L2StabJoin join;
    L1L2StabMotionModel model; /* of F, and with it of B and of the paths */
    L1L2StabSolver solver;
    int fill_reach;     /* what a frame lacks comes from frames so many before and after it; 0: it is not shown */
    double fill_margin; /* at the sides of these frames, not relied on; diagonals */
    const L1L2StabLogger *log;
    L1L2FrameColumn frames; /* of L1L2PathFrame; at least window + L1L2_PATH_PAST rows, and window + fill_reach */
} L1L2PathConfig;

/* The path's part of a frame's record. Only the path writes it. */
typedef struct L1L2PathFrame {
    L1L2Mat F, B;        /* motion, update transform */
    L1L2Mat next_B;      /* for blend: the B that a window found for a frame that the next window emits */
    L1L2Mat S;           /* smooth step P_{t-1}^-1 P_t; identity at a path's first frame */
    uint64_t path_index; /* frames since the path's start */
    double lambda;       /* as it was when the frame was pushed */
    double crop_ratio;   /* in effect for this frame: after a change it ramps to the new setting */
    double room_ratio;   /* the crop ratio that bounds B: larger where a filled border would lack too much */
    bool linked;         /* F was measured or given */
    double step;         /* time since the frame before, nominal frames; 1 at a path's first frame */
    bool early;          /* decided by an early window, with a shorter look-ahead */
    bool fallback;       /* no solver converged: the path is feasible and continuous, but not the optimum */
    L1L2PathSolverReport report; /* of the frame's window */
} L1L2PathFrame;

/* A new frame. */
typedef struct L1L2PathInput {
    const L1L2Mat *F;    /* frame t to t-1. It is reduced to the path's model; a map that is not finite or not
                          * invertible counts as no motion */
    bool starts_path;    /* the path before it ends; F is not used */
    bool lost;           /* F is a guess: nothing is filled across it */
    double lambda;       /* of eq. (4) at 30 frames/s */
    double crop_ratio;   /* wanted. The one in effect changes by at most L1L2_CROP_STEP a frame: a slower change is
                          * followed exactly, a jump becomes a zoom. A path that starts has it at once */
    double step;         /* time since the frame before, nominal frames, > 0 and finite; 0: one frame. Not used where a
                          * path starts */
} L1L2PathInput;

#define L1L2_CROP_STEP 0.005

/* Pulled frames that the path still reads: three for a continuous join, and seven for l1l2_path_motion(). */
enum { L1L2_PATH_PAST = 7 };

/* On error *out is NULL. cfg->log and the rows of cfg->frames must outlive the object. */
L1L2StabResult l1l2_path_create(L1L2Path **out, const L1L2PathConfig *cfg);
void l1l2_path_free(L1L2Path *path);

/* As new, with its memory kept: the next frame is number 0. */
void l1l2_path_reset(L1L2Path *path);

/* The next frame. Fills in its row, and solves every window that is complete. At most `window` - 1 frames may be
 * waiting for l1l2_path_pull(). */
void l1l2_path_push(L1L2Path *path, const L1L2PathInput *input);

/* The frames that are not decided: the newest ones. */
int l1l2_path_undecided(const L1L2Path *path);

/* The motion of a frame as it is used: `back` frames before the newest, at most L1L2_PATH_PAST. */
L1L2Mat l1l2_path_motion(const L1L2Path *path, int back);

/* Another motion for one of these: `back` frames before the newest, 0 <= back < l1l2_path_undecided(). Not used where a
 * path starts. */
void l1l2_path_amend(L1L2Path *path, int back, const L1L2Mat *F);

/* Decides the `frames` oldest frames that have not been pulled, or all there are, by what has come. Those that already
 * are decided stay as they are. */
void l1l2_path_hurry(L1L2Path *path, int frames);

/* No more frames: all that are left get decided. */
void l1l2_path_finish(L1L2Path *path);

/* The row of the oldest frame that has not been pulled, if it is decided, else NULL: frame t is when frame
 * t + window - 1 has been pushed, if not sooner. */
const L1L2PathFrame *l1l2_path_pull(L1L2Path *path);

#endif
