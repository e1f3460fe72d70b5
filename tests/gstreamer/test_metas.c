/* SPDX-License-Identifier: MIT */
/* Metas stay with their frame, and regions of interest move with the picture. */
#include "stabharness.h"

#define WINDOW 8
#define CROP_RATIO 0.8

static GstVideoOverlayComposition *
overlay_new (guint index)
{
  GstBuffer *pixels = gst_buffer_new_allocate (NULL, 4 * 4 * 4, NULL);
  GstVideoOverlayRectangle *rectangle;
  GstVideoOverlayComposition *overlay;

  gst_buffer_memset (pixels, 0, 0xff, 4 * 4 * 4);
  gst_buffer_add_video_meta (pixels, GST_VIDEO_FRAME_FLAG_NONE,
      GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB, 4, 4);
  rectangle = gst_video_overlay_rectangle_new_raw (pixels, index, 2, 4, 4,
      GST_VIDEO_OVERLAY_FORMAT_FLAG_NONE);
  gst_buffer_unref (pixels);
  overlay = gst_video_overlay_composition_new (rectangle);
  gst_video_overlay_rectangle_unref (rectangle);
  return overlay;
}

static void
add_metas (GstBuffer * buffer, GstCaps * clock, guint index)
{
  const guint8 caption[3] = { 0xfc, index, 0x20 };
  GstVideoOverlayComposition *overlay = overlay_new (index);

  gst_buffer_add_reference_timestamp_meta (buffer, clock, 1000 + index, 1);
  gst_buffer_add_video_time_code_meta_full (buffer, 25, 1, NULL,
      GST_VIDEO_TIME_CODE_FLAGS_NONE, 0, 0, 0, index, 0);
  gst_buffer_add_video_caption_meta (buffer, GST_VIDEO_CAPTION_TYPE_CEA708_RAW,
      caption, sizeof (caption));
  gst_buffer_add_video_overlay_composition_meta (buffer, overlay);
  gst_video_overlay_composition_unref (overlay);
  gst_buffer_add_video_afd_meta (buffer, 0, GST_VIDEO_AFD_SPEC_ATSC_A53,
      index % 2 ? GST_VIDEO_AFD_4_3_FULL_16_9_FULL :
      GST_VIDEO_AFD_16_9_LETTER_14_9_CENTER);
  gst_buffer_add_video_bar_meta (buffer, 0, TRUE, index, 2 * index);
}

static void
assert_metas (GstBuffer * buffer, GstCaps * clock, guint index)
{
  GstReferenceTimestampMeta *time =
      gst_buffer_get_reference_timestamp_meta (buffer, clock);
  GstVideoTimeCodeMeta *code = gst_buffer_get_video_time_code_meta (buffer);
  GstVideoCaptionMeta *caption = gst_buffer_get_video_caption_meta (buffer);
  GstVideoOverlayCompositionMeta *overlay =
      gst_buffer_get_video_overlay_composition_meta (buffer);
  GstVideoAFDMeta *afd = gst_buffer_get_video_afd_meta (buffer);
  GstVideoBarMeta *bar = gst_buffer_get_video_bar_meta (buffer);
  gint x;

  fail_unless (time && time->timestamp == 1000 + index);
  fail_unless (code && code->tc.frames == index);
  fail_unless (caption && caption->size == 3 && caption->data[1] == index);
  fail_unless (overlay != NULL);
  gst_video_overlay_rectangle_get_render_rectangle
      (gst_video_overlay_composition_get_rectangle (overlay->overlay, 0),
      &x, NULL, NULL, NULL);
  fail_unless_equals_int (x, index);
  fail_unless (afd && (afd->afd == GST_VIDEO_AFD_4_3_FULL_16_9_FULL)
      == (index % 2 == 1));
  fail_unless (bar && bar->bar_data1 == index && bar->bar_data2 == 2 * index);
}

GST_START_TEST (metas_stay_with_their_frame)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  GstCaps *clock = gst_caps_new_empty_simple ("timestamp/x-test");
  guint i;

  for (i = 0; i < 2 * WINDOW; i++) {
    GstBuffer *buffer = stab_frame_new (h, i);

    add_metas (buffer, clock, i);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < 2 * WINDOW; i++) {
    GstBuffer *buffer = gst_harness_pull (h);

    assert_metas (buffer, clock, i);
    gst_buffer_unref (buffer);
  }
  gst_caps_unref (clock);
  stab_harness_free (h);
}

GST_END_TEST;

static const struct
{
  const gchar *name;
  const gchar *tags[3];
  gboolean kept;
} customs[] = {
  {"TestOfNothing", {NULL}, TRUE},
  {"TestOfVideo", {GST_META_TAG_VIDEO_STR, NULL}, TRUE},
  {"TestOfColors",
      {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_COLORSPACE_STR, NULL}, TRUE},
  {"TestOfSize",
      {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR, NULL}, FALSE},
  {"TestOfPlace", {GST_META_TAG_VIDEO_ORIENTATION_STR, NULL}, FALSE},
  {"TestOfMemory", {GST_META_TAG_MEMORY_STR, NULL}, FALSE},
};

GST_START_TEST (an_unknown_meta_is_copied_as_its_tags_say)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW, NULL);
  const gchar *name = customs[__i__].name;
  GstBuffer *buffer = stab_frame_new (h, 0);
  GstCustomMeta *meta;

  gst_meta_register_custom (name, (const gchar **) customs[__i__].tags, NULL,
      NULL, NULL);
  meta = gst_buffer_add_custom_meta (buffer, name);
  gst_structure_set (gst_custom_meta_get_structure (meta), "value", G_TYPE_INT,
      42, NULL);
  gst_harness_push (h, buffer);
  stab_push_frames (h, 1, 3);
  gst_harness_push_event (h, gst_event_new_eos ());

  buffer = gst_harness_pull (h);
  meta = gst_buffer_get_custom_meta (buffer, name);
  fail_unless_equals_int (meta != NULL, customs[__i__].kept);
  if (meta) {
    gint value = 0;

    gst_structure_get_int (gst_custom_meta_get_structure (meta), "value",
        &value);
    fail_unless_equals_int (value, 42);
  }
  gst_buffer_unref (buffer);
  stab_harness_free (h);
}

GST_END_TEST;

/* Nothing moves: the picture is zoomed about its center, (32, 24), by 1 / 0.8. */
static const struct
{
  GstVideoRectangle in, out;
  gboolean kept;
} regions[] = {
  {{28, 20, 8, 8}, {27, 19, 10, 10}, TRUE},
  {{32, 24, 16, 12}, {32, 24, 20, 15}, TRUE},
  {{0, 0, 64, 48}, {0, 0, 64, 48}, TRUE},
  {{0, 20, 12, 8}, {0, 19, 7, 10}, TRUE},
  {{0, 0, 4, 4}, {0, 0, 0, 0}, FALSE},
};

GST_START_TEST (a_region_of_interest_is_zoomed_with_the_picture_and_clipped)
{
  GstHarness *h = stab_harness_new (SMALL_CAPS, "window", WINDOW,
      "crop-ratio", CROP_RATIO, NULL);
  const GstVideoRectangle in = regions[__i__].in, out = regions[__i__].out;
  GstVideoRegionOfInterestMeta *region;
  GstBuffer *buffer = stab_frame_new (h, 0);

  region = gst_buffer_add_video_region_of_interest_meta (buffer, "face", in.x,
      in.y, in.w, in.h);
  region->id = 7;
  region->parent_id = 3;
  gst_video_region_of_interest_meta_add_param (region,
      gst_structure_new ("detection", "confidence", G_TYPE_DOUBLE, 0.5, NULL));
  gst_harness_push (h, buffer);
  stab_push_frames (h, 1, 3);
  gst_harness_push_event (h, gst_event_new_eos ());

  buffer = gst_harness_pull (h);
  region = gst_buffer_get_video_region_of_interest_meta_id (buffer, 7);
  fail_unless_equals_int (region != NULL, regions[__i__].kept);
  if (region) {
    fail_unless_equals_int (region->x, out.x);
    fail_unless_equals_int (region->y, out.y);
    fail_unless_equals_int (region->w, out.w);
    fail_unless_equals_int (region->h, out.h);
    fail_unless_equals_int (region->parent_id, 3);
    fail_unless_equals_string (g_quark_to_string (region->roi_type), "face");
    fail_unless (gst_video_region_of_interest_meta_get_param (region,
            "detection") != NULL);
  }
  gst_buffer_unref (buffer);
  buffer = gst_harness_pull (h);
  fail_if (gst_buffer_get_video_region_of_interest_meta_id (buffer, 7));
  gst_buffer_unref (buffer);
  stab_harness_free (h);
}

GST_END_TEST;

#define SCENE_CAPS \
  "video/x-raw, format=GRAY8, width=160, height=120, framerate=25/1"
#define SQUARE 30

/* Blocks of different grays and one white square, all moved by (dx, dy). */
static GstBuffer *
scene_new (gint dx, gint dy)
{
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, 160 * 120, NULL);
  GstMapInfo map;
  gint x, y;

  fail_unless (gst_buffer_map (buffer, &map, GST_MAP_WRITE));
  for (y = 0; y < 120; y++) {
    for (x = 0; x < 160; x++) {
      const gint u = x - dx + 80, v = y - dy + 80;
      const guint32 hash =
          (guint32) (u / 9 * 7919 + v / 9 * 104729) * 2654435761u;
      const gboolean white = u >= 140 && u < 140 + SQUARE && v >= 130
          && v < 130 + SQUARE;

      map.data[160 * y + x] = white ? 255 : 20 + hash % 997 % 120;
    }
  }
  gst_buffer_unmap (buffer, &map);
  gst_buffer_add_video_region_of_interest_meta (buffer, "square",
      140 - 80 + dx, 130 - 80 + dy, SQUARE, SQUARE);
  return buffer;
}

/* The box around the pixels that are brighter than the background. */
static GstVideoRectangle
find_square (GstBuffer * buffer)
{
  gint left = 160, right = 0, top = 120, bottom = 0, x, y;
  GstVideoRectangle box;
  GstMapInfo map;

  fail_unless (gst_buffer_map (buffer, &map, GST_MAP_READ));
  for (y = 0; y < 120; y++) {
    for (x = 0; x < 160; x++) {
      if (map.data[160 * y + x] > 200) {
        left = MIN (left, x);
        right = MAX (right, x + 1);
        top = MIN (top, y);
        bottom = MAX (bottom, y + 1);
      }
    }
  }
  gst_buffer_unmap (buffer, &map);
  box.x = left;
  box.y = top;
  box.w = right - left;
  box.h = bottom - top;
  return box;
}

GST_START_TEST (a_region_of_interest_stays_on_what_it_enclosed)
{
  const gint shake[] = { 0, 4, -3, 5, -5, 2, -4, 3 };
  GstHarness *h = stab_harness_new (SCENE_CAPS, "window", WINDOW,
      "crop-ratio", CROP_RATIO, NULL);
  gint spread = 0;
  guint i;

  for (i = 0; i < 24; i++)
    fail_unless_equals_int (gst_harness_push (h, scene_new (shake[i % 8],
                shake[(i + 3) % 8])), GST_FLOW_OK);
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < 24; i++) {
    GstBuffer *buffer = gst_harness_pull (h);
    GstVideoRegionOfInterestMeta *region =
        gst_buffer_get_video_region_of_interest_meta (buffer);
    GstVideoRectangle seen = find_square (buffer);

    fail_unless (region != NULL);
    fail_unless (ABS (seen.x - (gint) region->x) <= 1);
    fail_unless (ABS (seen.y - (gint) region->y) <= 1);
    fail_unless (ABS (seen.w - (gint) region->w) <= 2);
    fail_unless (ABS (seen.h - (gint) region->h) <= 2);
    spread = MAX (spread, ABS (seen.x - 54));
    gst_buffer_unref (buffer);
  }
  /* A zoom about the center alone would keep the shake of 5 px. */
  fail_unless (spread <= 2, "the picture still moves by %d px", spread);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
metas_suite (void)
{
  Suite *s = suite_create ("metas");
  TCase *tc = tcase_create ("metas");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, metas_stay_with_their_frame);
  tcase_add_loop_test (tc, an_unknown_meta_is_copied_as_its_tags_say, 0,
      G_N_ELEMENTS (customs));
  tcase_add_loop_test (tc,
      a_region_of_interest_is_zoomed_with_the_picture_and_clipped, 0,
      G_N_ELEMENTS (regions));
  tcase_add_test (tc, a_region_of_interest_stays_on_what_it_enclosed);
  return s;
}

GST_CHECK_MAIN (metas);
