/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabtimer.h"

#include "gstl1l2stabconvert.h"

#define GST_CAT_DEFAULT gst_l1l2_stab_debug

void
gst_l1l2_stab_timer_init (GstL1L2StabTimer * timer, GstElement * element,
    void (*expire) (gpointer user_data), gpointer user_data)
{
  memset (timer, 0, sizeof (*timer));
  timer->element = element;
  timer->expire = expire;
  timer->user_data = user_data;
  timer->due = GST_CLOCK_TIME_NONE;
  g_mutex_init (&timer->lock);
  g_cond_init (&timer->changed);
  g_rec_mutex_init (&timer->task_lock);
}

void
gst_l1l2_stab_timer_clear (GstL1L2StabTimer * timer)
{
  gst_l1l2_stab_timer_stop (timer);
  g_mutex_clear (&timer->lock);
  g_cond_clear (&timer->changed);
  g_rec_mutex_clear (&timer->task_lock);
}

/* Waits until the time that is due. Called with the lock held, and releases it while waiting. TRUE: the time has
 * come. */
static gboolean
wait_until_due (GstL1L2StabTimer * timer, GstClock * clock)
{
  GstClockID id = gst_clock_new_single_shot_id (clock,
      gst_element_get_base_time (timer->element) + timer->due);
  GstClockReturn result;

  timer->id = id;
  timer->waiting_for = timer->due;
  g_mutex_unlock (&timer->lock);
  result = gst_clock_id_wait (id, NULL);
  g_mutex_lock (&timer->lock);
  timer->id = NULL;
  gst_clock_id_unref (id);

  if (result == GST_CLOCK_OK || result == GST_CLOCK_EARLY)
    return timer->playing && !timer->stopping;
  if (result != GST_CLOCK_UNSCHEDULED) {
    GST_WARNING_OBJECT (timer->element, "waiting on the clock failed: "
        "frames leave only when other frames come in");
    timer->due = GST_CLOCK_TIME_NONE;
  }
  return FALSE;
}

/* The function of the task, which calls it again and again. */
static void
wait_once (gpointer user_data)
{
  GstL1L2StabTimer *timer = user_data;
  gboolean expired = FALSE;
  GstClock *clock;

  g_mutex_lock (&timer->lock);
  while (!timer->stopping && !(timer->playing
          && GST_CLOCK_TIME_IS_VALID (timer->due)))
    g_cond_wait (&timer->changed, &timer->lock);
  if (!timer->stopping) {
    clock = gst_element_get_clock (timer->element);
    if (clock) {
      expired = wait_until_due (timer, clock);
      gst_object_unref (clock);
    } else {
      timer->due = GST_CLOCK_TIME_NONE;
    }
  }
  g_mutex_unlock (&timer->lock);
  if (expired)
    timer->expire (timer->user_data);
}

static void
interrupt (GstL1L2StabTimer * timer)
{
  if (timer->id)
    gst_clock_id_unschedule (timer->id);
  g_cond_signal (&timer->changed);
}

void
gst_l1l2_stab_timer_set (GstL1L2StabTimer * timer, GstClockTime due)
{
  g_mutex_lock (&timer->lock);
  timer->due = due;
  if (GST_CLOCK_TIME_IS_VALID (due)) {
    if (!timer->task) {
      timer->task = gst_task_new (wait_once, timer, NULL);
      gst_task_set_lock (timer->task, &timer->task_lock);
      gst_task_start (timer->task);
    }
    if (timer->id && due < timer->waiting_for)
      gst_clock_id_unschedule (timer->id);
    g_cond_signal (&timer->changed);
  }
  g_mutex_unlock (&timer->lock);
}

void
gst_l1l2_stab_timer_set_playing (GstL1L2StabTimer * timer, gboolean playing)
{
  g_mutex_lock (&timer->lock);
  timer->playing = playing;
  interrupt (timer);
  g_mutex_unlock (&timer->lock);
}

GstClockTime
gst_l1l2_stab_timer_now (GstL1L2StabTimer * timer)
{
  gboolean playing;

  g_mutex_lock (&timer->lock);
  playing = timer->playing;
  g_mutex_unlock (&timer->lock);
  return playing ? gst_element_get_current_running_time (timer->element)
      : GST_CLOCK_TIME_NONE;
}

void
gst_l1l2_stab_timer_stop (GstL1L2StabTimer * timer)
{
  GstTask *task;

  g_mutex_lock (&timer->lock);
  task = g_steal_pointer (&timer->task);
  timer->stopping = TRUE;
  interrupt (timer);
  g_mutex_unlock (&timer->lock);
  if (task) {
    gst_task_join (task);
    gst_object_unref (task);
  }
  g_mutex_lock (&timer->lock);
  timer->stopping = FALSE;
  timer->due = GST_CLOCK_TIME_NONE;
  g_mutex_unlock (&timer->lock);
}
