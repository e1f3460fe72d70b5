/* SPDX-License-Identifier: MIT */
/* Allocation: upstream never runs out of buffers because the window holds them. */
#include <gst/allocators/gstdmabuf.h>
#include <sys/mman.h>
#include <unistd.h>

#include "stabharness.h"

#define WINDOW 12

GST_START_TEST (upstream_is_offered_a_pool_without_a_limit)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstCaps *caps = gst_caps_from_string (SMALL_CAPS);
  GstQuery *query = gst_query_new_allocation (caps, TRUE);
  GstBufferPool *pool;
  guint size, least, most;

  fail_unless (gst_pad_peer_query (h->srcpad, query));
  fail_unless_equals_int (gst_query_get_n_allocation_pools (query), 1);
  gst_query_parse_nth_allocation_pool (query, 0, &pool, &size, &least, &most);
  fail_unless (pool != NULL);
  fail_unless_equals_int (least, 0);
  fail_unless_equals_int (most, 0);
  fail_unless_equals_int (size, 64 * 48 * 3 / 2);
  fail_unless (gst_query_find_allocation_meta (query, GST_VIDEO_META_API_TYPE,
          NULL));
  fail_if (gst_query_find_allocation_meta (query, GST_VIDEO_CROP_META_API_TYPE,
          NULL));
  gst_object_unref (pool);
  gst_query_unref (query);
  gst_caps_unref (caps);
  stab_harness_free (h);
}

GST_END_TEST;

static GstBufferPool *
pool_new (guint most)
{
  GstBufferPool *pool = gst_video_buffer_pool_new ();
  GstStructure *config = gst_buffer_pool_get_config (pool);
  GstCaps *caps = gst_caps_from_string (SMALL_CAPS);

  gst_buffer_pool_config_set_params (config, caps, 64 * 48 * 3 / 2, 0, most);
  gst_buffer_pool_config_add_option (config, GST_BUFFER_POOL_OPTION_VIDEO_META);
  fail_unless (gst_buffer_pool_set_config (pool, config));
  fail_unless (gst_buffer_pool_set_active (pool, TRUE));
  gst_caps_unref (caps);
  return pool;
}

/* An empty pool fails here instead of blocking forever. */
static GstBuffer *
frame_from_pool (GstHarness * h, GstBufferPool * pool, guint index)
{
  GstBufferPoolAcquireParams params = { 0 };
  GstBuffer *tight = stab_frame_new (h, index);
  GstBuffer *buffer = NULL;

  params.flags = GST_BUFFER_POOL_ACQUIRE_FLAG_DONTWAIT;
  fail_unless_equals_int (gst_buffer_pool_acquire_buffer (pool, &buffer,
          &params), GST_FLOW_OK);
  gst_buffer_memset (buffer, 0, stab_frame_level (index),
      gst_buffer_get_size (buffer));
  gst_buffer_copy_into (buffer, tight, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
  gst_buffer_add_video_time_code_meta_full (buffer, 25, 1, NULL,
      GST_VIDEO_TIME_CODE_FLAGS_NONE, 0, 0, index, 0, 0);
  gst_buffer_unref (tight);
  return buffer;
}

static GstBuffer *
as_it_is (GstBuffer * buffer)
{
  return buffer;
}

/* Another buffer with the memory of the pool, as after a tee and an element that adds metas. */
static GstBuffer *
shallow_copy (GstBuffer * buffer)
{
  GstBuffer *copy = gst_buffer_copy (buffer);

  gst_buffer_unref (buffer);
  return copy;
}

static GstBuffer *
cut_out (GstBuffer * buffer)
{
  GstBuffer *part = gst_buffer_copy_region (buffer, GST_BUFFER_COPY_ALL, 0,
      gst_buffer_get_size (buffer));

  gst_buffer_add_parent_buffer_meta (part, buffer);
  gst_buffer_unref (buffer);
  return part;
}

static GstBuffer *(*const disguises[]) (GstBuffer *) = {
  as_it_is, shallow_copy, cut_out
};

GST_START_TEST (an_upstream_pool_of_four_buffers_is_not_starved)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstBufferPool *pool = pool_new (4);
  guint i;

  for (i = 0; i < 3 * WINDOW; i++)
    fail_unless_equals_int (gst_harness_push (h,
            disguises[__i__] (frame_from_pool (h, pool, i))), GST_FLOW_OK);
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < 3 * WINDOW; i++) {
    GstBuffer *buffer = gst_harness_pull (h);
    GstVideoTimeCodeMeta *code = gst_buffer_get_video_time_code_meta (buffer);
    GstCaps *caps = gst_pad_get_current_caps (h->sinkpad);

    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), i * FRAME_DURATION);
    fail_unless (code && code->tc.seconds == i);
    stab_frame_assert_level (buffer, caps, stab_frame_level (i));
    gst_caps_unref (caps);
    gst_buffer_unref (buffer);
  }
  gst_buffer_pool_set_active (pool, FALSE);
  gst_object_unref (pool);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (buffers_of_a_pool_without_a_limit_are_held_and_not_copied)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstBufferPool *pool = pool_new (0);
  GstBuffer *buffer = frame_from_pool (h, pool, 0);

  fail_unless_equals_int (gst_harness_push (h, gst_buffer_ref (buffer)),
      GST_FLOW_OK);
  fail_unless (GST_MINI_OBJECT_REFCOUNT_VALUE (buffer) > 1);
  gst_harness_push_event (h, gst_event_new_eos ());
  ASSERT_BUFFER_REFCOUNT (buffer, "input", 1);
  gst_buffer_unref (buffer);
  gst_buffer_pool_set_active (pool, FALSE);
  gst_object_unref (pool);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (memory_of_a_device_is_released_at_once)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstAllocator *allocator = gst_dmabuf_allocator_new ();
  const gsize size = 64 * 48 * 3 / 2;
  const gint fd = memfd_create ("frame", MFD_CLOEXEC);
  GstBuffer *buffer = stab_frame_new (h, 0);

  fail_unless (fd >= 0 && ftruncate (fd, size) == 0);
  gst_buffer_replace_all_memory (buffer,
      gst_dmabuf_allocator_alloc (allocator, fd, size));
  gst_buffer_memset (buffer, 0, stab_frame_level (0), size);
  fail_unless_equals_int (gst_harness_push (h, gst_buffer_ref (buffer)),
      GST_FLOW_OK);
  ASSERT_BUFFER_REFCOUNT (buffer, "input", 1);
  gst_buffer_unref (buffer);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, 1);
  gst_object_unref (allocator);
  stab_harness_free (h);
}

GST_END_TEST;

/* Wrapped read-only memory, as from shmsrc. */
GST_START_TEST (memory_that_is_lent_is_released_at_once)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  const gsize size = 64 * 48 * 3 / 2;
  guint8 *area = g_malloc (size);
  GstBuffer *buffer = stab_frame_new (h, 0);

  memset (area, stab_frame_level (0), size);
  gst_buffer_replace_all_memory (buffer,
      gst_memory_new_wrapped (GST_MEMORY_FLAG_READONLY, area, size, 0, size,
          NULL, NULL));
  fail_unless_equals_int (gst_harness_push (h, gst_buffer_ref (buffer)),
      GST_FLOW_OK);
  ASSERT_BUFFER_REFCOUNT (buffer, "input", 1);
  gst_buffer_unref (buffer);
  memset (area, 0, size);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, 1);
  g_free (area);
  stab_harness_free (h);
}

GST_END_TEST;

/* Upstream can fill a window from the offered pool, and more. */
GST_START_TEST (the_offered_pool_holds_a_window_of_frames)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstCaps *caps = gst_caps_from_string (SMALL_CAPS);
  GstQuery *query = gst_query_new_allocation (caps, TRUE);
  GstBuffer *kept = NULL;
  GstBufferPool *pool;
  guint i;

  fail_unless (gst_pad_peer_query (h->srcpad, query));
  gst_query_parse_nth_allocation_pool (query, 0, &pool, NULL, NULL, NULL);
  fail_unless (gst_buffer_pool_set_active (pool, TRUE));
  for (i = 0; i < WINDOW - 1; i++) {
    GstBuffer *buffer = frame_from_pool (h, pool, i);

    if (i == 0)
      kept = gst_buffer_ref (buffer);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  /* The buffers are held, not copied. */
  fail_unless (GST_MINI_OBJECT_REFCOUNT_VALUE (kept) > 1);
  gst_buffer_unref (kept);
  for (; i < 3 * WINDOW; i++)
    fail_unless_equals_int (gst_harness_push (h, frame_from_pool (h, pool, i)),
        GST_FLOW_OK);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, 3 * WINDOW);
  gst_buffer_pool_set_active (pool, FALSE);
  gst_object_unref (pool);
  gst_query_unref (query);
  gst_caps_unref (caps);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (an_allocation_query_disturbs_no_frame)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstCaps *caps = gst_caps_from_string (SMALL_CAPS);
  GstQuery *query = gst_query_new_allocation (caps, TRUE);
  GString *out = stab_record_new (h);

  stab_push_frames (h, 0, 3);
  fail_unless (gst_pad_peer_query (h->srcpad, query));
  fail_unless_equals_string (out->str, "");
  stab_push_frames (h, 3, WINDOW);
  gst_harness_push_event (h, gst_event_new_eos ());
  stab_pull_frames (h, 0, WINDOW + 3);
  gst_query_unref (query);
  gst_caps_unref (caps);
  stab_harness_free (h);
}

GST_END_TEST;

/* --- a downstream whose allocator has no memory any more --- */

typedef GstAllocator StabPoorAllocator;
typedef GstAllocatorClass StabPoorAllocatorClass;
static GType stab_poor_allocator_get_type (void);
G_DEFINE_TYPE (StabPoorAllocator, stab_poor_allocator, GST_TYPE_ALLOCATOR);

static gboolean has_memory;

static GstMemory *
allocate (GstAllocator * allocator, gsize size, GstAllocationParams * params)
{
  return has_memory ? gst_allocator_alloc (NULL, size, params) : NULL;
}

static void
stab_poor_allocator_class_init (StabPoorAllocatorClass * klass)
{
  klass->alloc = allocate;
}

static void
stab_poor_allocator_init (StabPoorAllocator * allocator)
{
  allocator->mem_type = "poor";
}

/* Neither events nor queries can return the error of the frames that they drain. */
GST_START_TEST (frames_that_are_lost_for_lack_of_memory_are_an_error)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  GstAllocator *allocator = g_object_new (stab_poor_allocator_get_type (), NULL);
  GstQuery *query = gst_query_new_drain ();
  GstMessage *message;
  GstSegment segment;

  gst_object_ref_sink (allocator);
  has_memory = TRUE;
  gst_harness_set_propose_allocator (h, allocator, NULL);
  gst_harness_set_src_caps_str (h, SMALL_CAPS);
  stab_push_frames (h, 0, WINDOW + 2);
  fail_unless (stab_harness_message (h, GST_MESSAGE_ERROR) == NULL);

  has_memory = FALSE;
  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.start = GST_SECOND;
  if (__i__ == 0) {
    gst_harness_push_event (h, gst_event_new_eos ());
  } else if (__i__ == 1) {
    gst_harness_push_event (h, gst_event_new_segment (&segment));
  } else {
    gst_pad_peer_query (h->srcpad, query);
  }
  message = stab_harness_message (h, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_unref (message);
  gst_query_unref (query);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
memory_suite (void)
{
  Suite *s = suite_create ("memory");
  TCase *tc = tcase_create ("memory");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, upstream_is_offered_a_pool_without_a_limit);
  tcase_add_loop_test (tc, an_upstream_pool_of_four_buffers_is_not_starved, 0,
      G_N_ELEMENTS (disguises));
  tcase_add_test (tc,
      buffers_of_a_pool_without_a_limit_are_held_and_not_copied);
  tcase_add_test (tc, memory_of_a_device_is_released_at_once);
  tcase_add_test (tc, memory_that_is_lent_is_released_at_once);
  tcase_add_test (tc, the_offered_pool_holds_a_window_of_frames);
  tcase_add_test (tc, an_allocation_query_disturbs_no_frame);
  tcase_add_loop_test (tc, frames_that_are_lost_for_lack_of_memory_are_an_error, 0, 3);
  return s;
}

GST_CHECK_MAIN (memory);
