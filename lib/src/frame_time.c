/* SPDX-License-Identifier: MIT */
#include "frame_time.h"

#include <math.h>

#include <l1l2stab/l1l2stab.h>

/*
 * Parameters
 *
 * name       value     unit    effect, and what chose the value
 * ---------  --------  ------  -------------------------------------------------------------------------------------
 * jitter_ns  2e6       ns      A smaller deviation from the nominal frame counts as none: containers round timestamps
 *                              to 1 ms, and live sources stamp frames when they come.
 * least_ns   1e6       ns      Shorter steps are not times: callers without times count 0, 1, 2. It is a quarter
 *                              of a frame at 250 frames/s.
 * shortest   0.25      frames  Bounds of a step. They bound the coefficients of the differences (path/problem.h), and
 * longest    4         frames  what a wrong timestamp can do. Longer gaps: docs/path.md, "Variable frame rate".
 */
static const double jitter_ns = 2e6, least_ns = 1e6;
static const double shortest = 0.25, longest = 4.0;

L1L2FrameTime l1l2_frame_time_start(double frame_rate)
{
    return (L1L2FrameTime){.nominal_ns = frame_rate > 0.0 ? 1e9 / frame_rate : 0.0, .pts = L1L2STAB_NO_PTS};
}

/* From the frame before to this one, ns; 0 where it is unknown. As floating point numbers they cannot overflow. */
static double elapsed_ns(const L1L2FrameTime *time, int64_t pts)
{
    if (pts == L1L2STAB_NO_PTS || time->pts == L1L2STAB_NO_PTS)
        return 0.0;
    const double elapsed = (double)pts - (double)time->pts;
    return fabs(elapsed) < least_ns ? 0.0 : elapsed;
}

double l1l2_frame_time_step(L1L2FrameTime *time, int64_t pts, bool starts_path)
{
    const double elapsed = starts_path ? 0.0 : elapsed_ns(time, pts);
    const int direction = elapsed > 0.0 ? 1 : elapsed < 0.0 ? -1 : 0;
    const bool counts = time->direction == 0 ? direction > 0 : direction == time->direction;
    time->pts = pts;
    time->direction = direction;
    if (!counts || time->nominal_ns == 0.0 || fabs(fabs(elapsed) - time->nominal_ns) < jitter_ns)
        return 1.0;
    return fmin(fmax(fabs(elapsed) / time->nominal_ns, shortest), longest);
}
