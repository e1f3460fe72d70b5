/* SPDX-License-Identifier: MIT */
/* What comes in: which frames and events have to wait, and which push others out. */
#ifndef GST_L1L2_STAB_INPUT_H
#define GST_L1L2_STAB_INPUT_H

#include <gst/gst.h>

#include "gstl1l2staboutput.h"
#include "gstl1l2stabsettings.h"

G_BEGIN_DECLS

/* Takes a frame, with the properties of its time. */
GstFlowReturn gst_l1l2_stab_input_frame (GstL1L2StabOutput * output,
    GstL1L2StabSettings * settings, GstBuffer * frame);

/* TRUE: the event was taken and waits for its turn. FALSE: it can go now; what must precede it has been pushed. */
gboolean gst_l1l2_stab_input_event (GstL1L2StabOutput * output,
    GstEvent * event);

G_END_DECLS

#endif
