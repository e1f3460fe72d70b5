/* SPDX-License-Identifier: MIT */
/* A task that waits on the pipeline's clock, so that frames of a live source leave in time even when no other comes in.
 * It waits only while the element is playing: running time stands still otherwise. */
#ifndef GST_L1L2_STAB_TIMER_H
#define GST_L1L2_STAB_TIMER_H

#include <gst/gst.h>

G_BEGIN_DECLS

typedef struct
{
  GstElement *element;          /* whose clock it is; not owned */
  void (*expire) (gpointer user_data);
  gpointer user_data;
  GMutex lock;                  /* guards the rest; no other lock is taken under it */
  GCond changed;
  gboolean playing;
  gboolean stopping;
  GstClockTime due;             /* running time; NONE: nothing to wait for */
  GstClockID id;                /* what is waited for, or NULL */
  GstTask *task;                /* NULL until there is something to wait for */
  GRecMutex task_lock;
} GstL1L2StabTimer;

/* `expire` is called from the task, without a lock: it has to look whether anything is due, and to set the time
 * anew. */
void gst_l1l2_stab_timer_init (GstL1L2StabTimer * timer, GstElement * element,
    void (*expire) (gpointer user_data), gpointer user_data);
void gst_l1l2_stab_timer_clear (GstL1L2StabTimer * timer);

/* The next time to call, a running time; NONE: none. If it is later than the one set before, there is a call at that
 * one, too. */
void gst_l1l2_stab_timer_set (GstL1L2StabTimer * timer, GstClockTime due);

/* The clock starts to run, or stops. */
void gst_l1l2_stab_timer_set_playing (GstL1L2StabTimer * timer,
    gboolean playing);

/* The running time; NONE: the clock does not run. */
GstClockTime gst_l1l2_stab_timer_now (GstL1L2StabTimer * timer);

/* There are no more calls when this returns. Not to be called with the sink pad's stream lock. */
void gst_l1l2_stab_timer_stop (GstL1L2StabTimer * timer);

G_END_DECLS

#endif
