/* SPDX-License-Identifier: MIT */
#include "gstl1l2staballoc.h"

/* Buffers that upstream needs while a window is held: one that it fills, one on its way, two in reserve. */
#define SPARE_BUFFERS 4

/* The pool has no minimum and no maximum: it grows while the window fills. With a minimum of a window of buffers,
 * upstream would allocate them at once, even a decoder that renders into memory of its own. Measured with avdec_h264,
 * that took twice the memory of the window. */
void
gst_l1l2_stab_alloc_propose (GstQuery * query)
{
  GstBufferPool *pool = NULL;
  GstVideoInfo info;
  GstCaps *caps;
  gboolean need_pool;

  gst_query_parse_allocation (query, &caps, &need_pool);
  if (!caps || !gst_video_info_from_caps (&info, caps))
    return;

  if (need_pool) {
    GstStructure *config;

    pool = gst_video_buffer_pool_new ();
    config = gst_buffer_pool_get_config (pool);
    gst_buffer_pool_config_set_params (config, caps,
        GST_VIDEO_INFO_SIZE (&info), 0, 0);
    gst_buffer_pool_config_add_option (config,
        GST_BUFFER_POOL_OPTION_VIDEO_META);
    if (!gst_buffer_pool_set_config (pool, config))
      gst_clear_object (&pool);
  }
  gst_query_add_allocation_pool (query, pool, GST_VIDEO_INFO_SIZE (&info), 0,
      0);
  gst_query_add_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL);
  gst_clear_object (&pool);
}

void
gst_l1l2_stab_alloc_decide (GstQuery * query)
{
  GstBufferPool *pool = NULL;
  GstVideoInfo info;
  GstStructure *config;
  GstCaps *caps;
  guint size = 0, least = 0, most = 0;
  const gboolean offered = gst_query_get_n_allocation_pools (query) > 0;

  gst_query_parse_allocation (query, &caps, NULL);
  if (!caps || !gst_video_info_from_caps (&info, caps))
    return;

  if (offered)
    gst_query_parse_nth_allocation_pool (query, 0, &pool, &size, &least, &most);
  if (!pool)
    pool = gst_video_buffer_pool_new ();
  size = MAX (size, GST_VIDEO_INFO_SIZE (&info));

  /* The video meta describes the padding of the frames of a pool. */
  config = gst_buffer_pool_get_config (pool);
  gst_buffer_pool_config_set_params (config, caps, size, least, most);
  if (gst_buffer_pool_has_option (pool, GST_BUFFER_POOL_OPTION_VIDEO_META))
    gst_buffer_pool_config_add_option (config,
        GST_BUFFER_POOL_OPTION_VIDEO_META);
  gst_buffer_pool_set_config (pool, config);

  if (offered)
    gst_query_set_nth_allocation_pool (query, 0, pool, size, least, most);
  else
    gst_query_add_allocation_pool (query, pool, size, least, most);
  gst_object_unref (pool);
}

static gboolean
pool_is_small (GstBufferPool * pool, guint window)
{
  GstStructure *config = gst_buffer_pool_get_config (pool);
  guint most = 0;

  gst_buffer_pool_config_get_params (config, NULL, NULL, NULL, &most);
  gst_structure_free (config);
  return most > 0 && most < window + SPARE_BUFFERS;
}

gboolean
gst_l1l2_stab_alloc_is_scarce (GstBuffer * buffer, guint window)
{
  GstParentBufferMeta *parent;
  guint i;

  /* Memory of a device, such as DMABuf or a camera's, must go back soon. Read-only memory belongs to another owner:
   * shmsrc, for example, lends parts of one area that all of its frames share. */
  for (i = 0; i < gst_buffer_n_memory (buffer); i++) {
    GstMemory *memory = gst_buffer_peek_memory (buffer, i);

    if (!gst_memory_is_type (memory, GST_ALLOCATOR_SYSMEM)
        || GST_MEMORY_IS_READONLY (memory))
      return TRUE;
  }
  /* A buffer that is part of another one keeps the other one out of its pool. */
  while (!buffer->pool
      && (parent = gst_buffer_get_parent_buffer_meta (buffer)) != NULL)
    buffer = parent->buffer;
  return buffer->pool && pool_is_small (buffer->pool, window);
}

GstBufferPool *
gst_l1l2_stab_alloc_own_pool (const GstVideoInfo * info)
{
  GstBufferPool *pool = gst_video_buffer_pool_new ();
  GstStructure *config = gst_buffer_pool_get_config (pool);
  GstCaps *caps = gst_video_info_to_caps (info);

  gst_buffer_pool_config_set_params (config, caps, GST_VIDEO_INFO_SIZE (info),
      0, 0);
  gst_caps_unref (caps);
  if (!gst_buffer_pool_set_config (pool, config)
      || !gst_buffer_pool_set_active (pool, TRUE))
    gst_clear_object (&pool);
  return pool;
}

/* The bytes from the first sample of a row to the end of its last one. */
static gsize
row_size (const GstVideoFrame * frame, guint plane)
{
  gsize size = 0;
  guint c;

  for (c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS (frame); c++) {
    const gint bytes = GST_VIDEO_FRAME_COMP_DEPTH (frame, c) > 8 ? 2 : 1;
    /* GStreamer 1.22 puts the second chroma component of P010 at byte 1 instead of 2. */
    const gint offset = (GST_VIDEO_FRAME_COMP_POFFSET (frame, c) + bytes - 1) / bytes * bytes;

    if (GST_VIDEO_FRAME_COMP_PLANE (frame, c) == plane)
      size = MAX (size, (gsize) (GST_VIDEO_FRAME_COMP_WIDTH (frame, c) - 1)
          * GST_VIDEO_FRAME_COMP_PSTRIDE (frame, c) + offset + bytes);
  }
  return size;
}

static gint
n_rows (const GstVideoFrame * frame, guint plane)
{
  guint c = 0;

  while (GST_VIDEO_FRAME_COMP_PLANE (frame, c) != plane)
    c++;
  return GST_VIDEO_FRAME_COMP_HEIGHT (frame, c);
}

/* Whether the rows of a plane lie within the memory that is mapped for it. A plane that is not in that memory at all
 * was mapped by a function of the meta's own, which alone knows its size. */
static gboolean
plane_fits (const GstVideoFrame * frame, guint plane)
{
  const GstMapInfo *map = &frame->map[frame->meta ? plane : 0];
  const guint8 *data = GST_VIDEO_FRAME_PLANE_DATA (frame, plane);
  const gint64 first = data - map->data;
  const gint64 last = first + (gint64) (n_rows (frame, plane) - 1)
      * GST_VIDEO_FRAME_PLANE_STRIDE (frame, plane);
  const gint64 size = map->size;

  if (first < 0 || first >= size)
    return TRUE;
  return MIN (first, last) >= 0
      && MAX (first, last) + (gint64) row_size (frame, plane) <= size;
}

/* GStreamer takes another format or a smaller size than that of the caps for a fault of the program, and may end it. */
static gboolean
meta_fits (GstBuffer * buffer, const GstVideoInfo * info)
{
  const GstVideoMeta *meta = gst_buffer_get_video_meta (buffer);

  return !meta || (meta->format == GST_VIDEO_INFO_FORMAT (info)
      && meta->width >= (guint) GST_VIDEO_INFO_WIDTH (info)
      && meta->height >= (guint) GST_VIDEO_INFO_HEIGHT (info));
}

gboolean
gst_l1l2_stab_alloc_map (GstVideoFrame * frame, const GstVideoInfo * info,
    GstBuffer * buffer, GstMapFlags flags)
{
  guint i;

  if (!meta_fits (buffer, info))
    return FALSE;
  if (!gst_video_frame_map (frame, info, buffer, flags))
    return FALSE;
  for (i = 0; i < GST_VIDEO_FRAME_N_PLANES (frame); i++) {
    if (!plane_fits (frame, i)) {
      gst_video_frame_unmap (frame);
      return FALSE;
    }
  }
  return TRUE;
}

GstBuffer *
gst_l1l2_stab_alloc_copy (GstBufferPool * own_pool, GstBuffer * buffer,
    const GstVideoInfo * info)
{
  GstVideoFrame from, to;
  GstBuffer *copy = NULL;
  gboolean copied = FALSE;

  if (gst_buffer_pool_acquire_buffer (own_pool, &copy, NULL) != GST_FLOW_OK)
    return NULL;
  if (gst_l1l2_stab_alloc_map (&from, info, buffer, GST_MAP_READ)) {
    if (gst_video_frame_map (&to, info, copy, GST_MAP_WRITE)) {
      copied = gst_video_frame_copy (&to, &from);
      gst_video_frame_unmap (&to);
    }
    gst_video_frame_unmap (&from);
  }
  if (!copied)
    gst_clear_buffer (&copy);
  return copy;
}
