/* SPDX-License-Identifier: MIT */
/* Shows the locks of GLib to ThreadSanitizer, which cannot see them because GLib is not built with it: a GMutex and a
 * GCond are made of atomics, and reference counts too. Built into the tests with -Db_sanitize=thread, these functions
 * replace those of GLib and GStreamer: they call them, and tell the sanitizer what they order. A GRecMutex is a mutex
 * of the system that GLib allocates; the sanitizer knows the mutex, but not how its address gets to another thread. */
#include <dlfcn.h>
#include <gst/gst.h>
#include <sanitizer/tsan_interface.h>

#define REAL(name) \
  static __typeof__ (name) *real; \
  if (!real) \
    *(void **) &real = dlsym (RTLD_NEXT, #name)

void
g_mutex_lock (GMutex * mutex)
{
  REAL (g_mutex_lock);
  real (mutex);
  __tsan_acquire (mutex);
}

gboolean
g_mutex_trylock (GMutex * mutex)
{
  REAL (g_mutex_trylock);
  if (!real (mutex))
    return FALSE;
  __tsan_acquire (mutex);
  return TRUE;
}

void
g_mutex_unlock (GMutex * mutex)
{
  REAL (g_mutex_unlock);
  __tsan_release (mutex);
  real (mutex);
}

void
g_rec_mutex_init (GRecMutex * mutex)
{
  REAL (g_rec_mutex_init);
  real (mutex);
  __tsan_release (mutex);
}

void
g_rec_mutex_lock (GRecMutex * mutex)
{
  REAL (g_rec_mutex_lock);
  __tsan_acquire (mutex);
  real (mutex);
}

gboolean
g_rec_mutex_trylock (GRecMutex * mutex)
{
  REAL (g_rec_mutex_trylock);
  __tsan_acquire (mutex);
  return real (mutex);
}

void
g_cond_wait (GCond * cond, GMutex * mutex)
{
  REAL (g_cond_wait);
  __tsan_release (mutex);
  real (cond, mutex);
  __tsan_acquire (mutex);
}

gboolean
g_cond_wait_until (GCond * cond, GMutex * mutex, gint64 end_time)
{
  REAL (g_cond_wait_until);
  gboolean signaled;

  __tsan_release (mutex);
  signaled = real (cond, mutex, end_time);
  __tsan_acquire (mutex);
  return signaled;
}

gboolean (g_once_init_enter) (volatile void *location)
{
  REAL (g_once_init_enter);
  const gboolean first = real (location);

  __tsan_acquire ((void *) location);
  return first;
}

void (g_once_init_leave) (volatile void *location, gsize result)
{
  REAL (g_once_init_leave);
  __tsan_release ((void *) location);
  real (location, result);
}


void
gst_mini_object_unref (GstMiniObject * object)
{
  REAL (gst_mini_object_unref);
  __tsan_release (object);
  __tsan_acquire (object);
  real (object);
}


/* A harness hands buffers from thread to thread by a queue, whose lock is inside GLib. */
void
g_async_queue_push (GAsyncQueue * queue, gpointer data)
{
  REAL (g_async_queue_push);
  __tsan_release (data);
  real (queue, data);
}

static gpointer
received (gpointer data)
{
  if (data)
    __tsan_acquire (data);
  return data;
}

gpointer
g_async_queue_try_pop (GAsyncQueue * queue)
{
  REAL (g_async_queue_try_pop);
  return received (real (queue));
}

gpointer
g_async_queue_timeout_pop (GAsyncQueue * queue, guint64 timeout)
{
  REAL (g_async_queue_timeout_pop);
  return received (real (queue, timeout));
}
