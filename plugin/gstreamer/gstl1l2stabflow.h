/* SPDX-License-Identifier: MIT */
/* The path of a frame through the element, from the sink pad to the source pad. gstl1l2stabflow.c has the steps in
 * their order: take the frame in, let the stream hold it, push the frames that are ready.
 *
 * The element pushes every frame and every event by itself. GstBaseTransform pushes in one case only: when a buffer has
 * come in. Here a frame also leaves when its time is up, and before an event that it must precede. */
#ifndef GST_L1L2_STAB_FLOW_H
#define GST_L1L2_STAB_FLOW_H

#include <gst/base/gstbasetransform.h>

#include "gstl1l2stablatency.h"
#include "gstl1l2stabsettings.h"
#include "gstl1l2stabstream.h"
#include "gstl1l2stabtimer.h"

G_BEGIN_DECLS

typedef struct
{
  GstBaseTransform *trans;      /* not owned */
  GstL1L2StabSettings *settings;        /* not owned; has its own lock */
  GstL1L2StabLatency latency;   /* has its own lock */
  GstL1L2StabTimer timer;       /* has its own lock */

  /* Under the stream lock of the sink pad. */
  GstL1L2StabStream stream;
  GstSegment in_segment;        /* of the frames that come in; trans->segment is that of the frames that go out */
  GstClockTime last_push_end;   /* running time at which the last push returned */
  GstFlowReturn timer_flow;     /* result of the last push that the timer made; the next frame in returns it */

  /* Under the object lock of trans. */
  GstClockTime position;        /* stream time at the end of the last frame out; NONE: none in this segment */
} GstL1L2StabFlow;

void gst_l1l2_stab_flow_init (GstL1L2StabFlow * flow, GstBaseTransform * trans,
    GstL1L2StabSettings * settings);
void gst_l1l2_stab_flow_clear (GstL1L2StabFlow * flow);

/* Drops all frames and events and closes the files. The caller must not hold the stream lock of the sink pad: this
 * waits for a push that the timer has begun. */
void gst_l1l2_stab_flow_stop (GstL1L2StabFlow * flow);

/* Takes a frame. It gets the property values of its stream time and is held until it is ready. */
GstFlowReturn gst_l1l2_stab_flow_take_frame (GstL1L2StabFlow * flow,
    GstBuffer * frame);

/* TRUE: the event was taken and leaves in its place among the frames. FALSE: the caller forwards it now; all that must
 * precede it has been pushed. */
gboolean gst_l1l2_stab_flow_take_event (GstL1L2StabFlow * flow,
    GstEvent * event);

/* Renders and pushes the frames that are ready, and the events between them. The timer is set for the next one. */
GstFlowReturn gst_l1l2_stab_flow_push_ready (GstL1L2StabFlow * flow);

/* Pushes all frames and events that are held and ends the path. If a push fails, the remaining frames are dropped. */
GstFlowReturn gst_l1l2_stab_flow_drain (GstL1L2StabFlow * flow);

/* Answers a position query of the source pad. The frames that are held have not been played yet, so the position is the
 * end of the last frame out. FALSE: no frame of this segment has gone out. */
gboolean gst_l1l2_stab_flow_query_position (GstL1L2StabFlow * flow,
    GstQuery * query);

G_END_DECLS

#endif
