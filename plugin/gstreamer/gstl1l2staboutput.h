/* SPDX-License-Identifier: MIT */
/* How frames and events leave: one by one in the normal flow, sooner when their time has come, all at once before
 * something that they must precede. The base class pushes nothing itself: it knows only the first way, and marks a
 * wrong frame when a discontinuity comes in while others are held. */
#ifndef GST_L1L2_STAB_OUTPUT_H
#define GST_L1L2_STAB_OUTPUT_H

#include <gst/base/gstbasetransform.h>

#include "gstl1l2stablatency.h"
#include "gstl1l2stabstream.h"
#include "gstl1l2stabtimer.h"

G_BEGIN_DECLS

typedef struct
{
  GstBaseTransform *trans;      /* not owned */
  GstL1L2StabLatency latency;   /* locks by itself */
  GstL1L2StabTimer timer;       /* so does this */
  GstL1L2StabStream stream;     /* under the sink pad's stream lock */
  GstClockTime ready;           /* running time when the last push was over; under the stream lock, too */
  GstFlowReturn flow;           /* what the timer's last push met; under the same lock */
  GstClockTime position;        /* after the last frame out, in its segment; under the object lock; NONE: none yet */
} GstL1L2StabOutput;

void gst_l1l2_stab_output_init (GstL1L2StabOutput * output,
    GstBaseTransform * trans);
void gst_l1l2_stab_output_clear (GstL1L2StabOutput * output);

/* Drops everything. The sink pad's stream lock must not be held: a push that is under way is waited for. */
void gst_l1l2_stab_output_stop (GstL1L2StabOutput * output);

/* The running time, if frames have to leave by it: of a live source, while the clock runs. Else NONE. */
GstClockTime gst_l1l2_stab_output_now (GstL1L2StabOutput * output);

/* Makes the frames ready that have been held for the latency, when the input has come to `position`; `now`: as
 * above. */
GstFlowReturn gst_l1l2_stab_output_hurry (GstL1L2StabOutput * output,
    GstClockTime now, GstClockTime position);

/* What the timer's last push met, once: upstream has to know of it. */
GstFlowReturn gst_l1l2_stab_output_take_flow (GstL1L2StabOutput * output);

/* Pushes the frames that are ready, and the events whose turn it is. What is held then waits for other frames, but no
 * longer than the latency allows. */
GstFlowReturn gst_l1l2_stab_output_push_ready (GstL1L2StabOutput * output);

/* Pushes all that is held, frames and events, up to the first flow return that is not OK; what is left of the frames
 * is dropped. The stream is as new. */
GstFlowReturn gst_l1l2_stab_output_drain (GstL1L2StabOutput * output);

/* Drops all that is held, but keeps sticky events on the pad: they outlive a flush. */
void gst_l1l2_stab_output_flush (GstL1L2StabOutput * output);

/* Drains. The position means nothing in the segment that comes. */
void gst_l1l2_stab_output_end_segment (GstL1L2StabOutput * output);

/* Where playback is after the last frame that went out: the frames that are held are not played yet. FALSE: none did
 * in this segment. */
gboolean gst_l1l2_stab_output_query_position (GstL1L2StabOutput * output,
    GstQuery * query);

G_END_DECLS

#endif
