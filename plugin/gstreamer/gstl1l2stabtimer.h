/* SPDX-License-Identifier: MIT */
/* Calls a function at a running time. A task waits on the pipeline's clock, so that frames of a live source leave in
 * time even if no other frame comes in. It waits only while the element is playing; otherwise running time stands
 * still. */
#ifndef GST_L1L2_STAB_TIMER_H
#define GST_L1L2_STAB_TIMER_H

#include <gst/gst.h>

G_BEGIN_DECLS

typedef struct
{
  GstElement *element;          /* whose clock is waited on; not owned */
  void (*expire) (gpointer user_data);
  gpointer user_data;
  GMutex lock;                  /* guards the rest; no lock of this element is taken while it is held */
  GCond changed;
  gboolean playing;
  gboolean stopping;
  GstClockTime due;             /* running time of the next call; NONE: no call */
  GstClockTime waiting_for;     /* running time that `id` waits for */
  GstClockID id;                /* NULL: the task does not wait on the clock */
  GstTask *task;                /* NULL: no call has been due yet */
  GRecMutex task_lock;
} GstL1L2StabTimer;

/* `expire` is called from the task, without a lock. It has to check whether anything is due, and to set the next
 * time. */
void gst_l1l2_stab_timer_init (GstL1L2StabTimer * timer, GstElement * element,
    void (*expire) (gpointer user_data), gpointer user_data);
void gst_l1l2_stab_timer_clear (GstL1L2StabTimer * timer);

/* Sets the running time of the next call; NONE: no call. If an earlier time was set before, the function can still be
 * called at that time, too. */
void gst_l1l2_stab_timer_set (GstL1L2StabTimer * timer, GstClockTime due);

/* Running time starts to advance, or stops. */
void gst_l1l2_stab_timer_set_playing (GstL1L2StabTimer * timer,
    gboolean playing);

/* The running time; NONE: it does not advance. */
GstClockTime gst_l1l2_stab_timer_now (GstL1L2StabTimer * timer);

/* Ends the task. No call is under way or will come when this returns. The caller must not hold the stream lock of the
 * sink pad, for which a call may be waiting. */
void gst_l1l2_stab_timer_stop (GstL1L2StabTimer * timer);

G_END_DECLS

#endif
