/* SPDX-License-Identifier: MIT */
/* The meta that maps a point of the picture to the source frame. */
#include <math.h>

#include "stabnoise.h"

#define WINDOW 6
#define N_FRAMES 24

static void
map_point (const gdouble m[9], gdouble * x, gdouble * y)
{
  const gdouble w = m[6] * *x + m[7] * *y + m[8];
  const gdouble u = (m[0] * *x + m[1] * *y + m[2]) / w;

  *y = (m[3] * *x + m[4] * *y + m[5]) / w;
  *x = u;
}

static const GstStructure *
get_meta (GstBuffer * buffer)
{
  GstCustomMeta *meta = gst_buffer_get_custom_meta (buffer, "GstL1L2StabMeta");

  return meta ? gst_custom_meta_get_structure (meta) : NULL;
}

/* A white square of 12 pixels on a dark background, away from the middle. */
static GstBuffer *
new_target (guint index, gdouble * x, gdouble * y)
{
  const guint left = 70 + index * 5 % 11, top = 50 + index * 3 % 7;
  GstBuffer *buffer = stab_noise_new (index);
  GstMapInfo map;
  guint i, row;

  fail_unless (gst_buffer_map (buffer, &map, GST_MAP_READWRITE));
  for (i = 0; i < map.size; i++)
    map.data[i] /= 4;
  for (row = top; row < top + 12; row++)
    memset (map.data + row * NOISE_WIDTH + left, 255, 12);
  gst_buffer_unmap (buffer, &map);
  *x = left + 6;
  *y = top + 6;
  return buffer;
}

/* A detector: the center of gravity of the white pixels. */
static void
find_target (GstBuffer * buffer, gdouble * x, gdouble * y)
{
  gdouble sum = 0, sum_x = 0, sum_y = 0;
  GstMapInfo map;
  guint i;

  fail_unless (gst_buffer_map (buffer, &map, GST_MAP_READ));
  for (i = 0; i < map.size; i++) {
    const gdouble weight = MAX (map.data[i], 80) - 80;

    sum += weight;
    sum_x += weight * (i % NOISE_WIDTH + 0.5);
    sum_y += weight * (i / NOISE_WIDTH + 0.5);
  }
  gst_buffer_unmap (buffer, &map);
  *x = sum_x / sum;
  *y = sum_y / sum;
}

GST_START_TEST (an_object_in_the_picture_is_mapped_back_to_the_source)
{
  GstHarness *h = stab_noise_harness_new (WINDOW);
  gdouble true_x[N_FRAMES], true_y[N_FRAMES], moved = 0;
  guint i;

  for (i = 0; i < N_FRAMES; i++)
    gst_harness_push (h, new_target (i, &true_x[i], &true_y[i]));
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < N_FRAMES; i++) {
    GstBuffer *buffer = gst_harness_pull (h);
    const GstStructure *meta = get_meta (buffer);
    gdouble to_source[9], from_source[9], x, y, found_x, found_y;

    fail_unless (meta != NULL);
    stab_get_matrix (meta, "to-source", to_source);
    stab_get_matrix (meta, "from-source", from_source);
    find_target (buffer, &found_x, &found_y);
    x = found_x;
    y = found_y;
    map_point (to_source, &x, &y);
    fail_unless (fabs (x - true_x[i]) < 0.1 && fabs (y - true_y[i]) < 0.1,
        "frame %u: (%g, %g) and not (%g, %g)", i, x, y, true_x[i], true_y[i]);
    moved = MAX (moved, fabs (found_x - true_x[i]));
    map_point (from_source, &x, &y);
    fail_unless (fabs (x - found_x) < 1e-9 && fabs (y - found_y) < 1e-9);
    gst_buffer_unref (buffer);
  }
  fail_unless (moved > 1);      /* there was something to map */
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (the_meta_has_sizes_and_a_number_and_is_copied)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);
  guint i;

  g_object_set (h->element, "output-size", 1, "crop-ratio", 0.75, NULL);
  gst_harness_set_src_caps_str (h, NOISE_CAPS);
  stab_noise_push (h, 0, WINDOW);
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < WINDOW; i++) {
    GstBuffer *buffer = gst_harness_pull (h);
    GstBuffer *copy = gst_buffer_copy (buffer);
    guint64 frame;
    gint width, height, source_width, source_height;

    fail_unless (gst_structure_is_equal (get_meta (buffer), get_meta (copy)));
    fail_unless (gst_structure_get (get_meta (copy), "frame", G_TYPE_UINT64,
            &frame, "width", G_TYPE_INT, &width, "height", G_TYPE_INT, &height,
            "source-width", G_TYPE_INT, &source_width, "source-height",
            G_TYPE_INT, &source_height, NULL));
    fail_unless_equals_uint64 (frame, i);
    fail_unless_equals_int (width, 120);
    fail_unless_equals_int (height, 90);
    fail_unless_equals_int (source_width, NOISE_WIDTH);
    fail_unless_equals_int (source_height, NOISE_HEIGHT);
    gst_buffer_unref (copy);
    gst_buffer_unref (buffer);
  }
  stab_harness_free (h);
}

GST_END_TEST;

/* The first frame that comes out of a bin with these elements after l1l2stab. */
static GstBuffer *
first_through (const gchar * after)
{
  gchar *line = g_strdup_printf ("l1l2stab window=6 ! %s", after);
  GstHarness *h = gst_harness_new_parse (line);
  GstBuffer *buffer;

  gst_harness_set_src_caps_str (h, NOISE_CAPS);
  stab_noise_push (h, 0, WINDOW);
  buffer = gst_harness_pull (h);
  gst_harness_teardown (h);
  g_free (line);
  return buffer;
}

GST_START_TEST (a_scaler_downstream_adjusts_the_meta_and_a_cropper_drops_it)
{
  GstBuffer *plain = first_through ("identity");
  GstBuffer *scaled = first_through
      ("videoscale ! capsfilter caps=video/x-raw,width=320,height=90");
  GstBuffer *cropped = first_through ("videocrop left=16");
  gdouble plain_map[9], map[9], back[9];
  gint width, height;
  guint i;

  stab_get_matrix (get_meta (plain), "to-source", plain_map);
  stab_get_matrix (get_meta (scaled), "to-source", map);
  stab_get_matrix (get_meta (scaled), "from-source", back);
  gst_structure_get (get_meta (scaled), "width", G_TYPE_INT, &width, "height",
      G_TYPE_INT, &height, NULL);
  fail_unless_equals_int (width, 320);
  fail_unless_equals_int (height, 90);
  for (i = 0; i < 4; i++) {
    gdouble x = i & 1 ? 160 : 0, y = i & 2 ? 120 : 0;
    gdouble scaled_x = 2 * x, scaled_y = 0.75 * y;

    map_point (plain_map, &x, &y);
    map_point (map, &scaled_x, &scaled_y);
    fail_unless (fabs (x - scaled_x) < 1e-9 && fabs (y - scaled_y) < 1e-9);
    map_point (back, &x, &y);
    fail_unless (fabs (x - (i & 1 ? 320 : 0)) < 1e-9);
    fail_unless (fabs (y - (i & 2 ? 90 : 0)) < 1e-9);
  }
  fail_unless (get_meta (cropped) == NULL);
  gst_buffer_unref (plain);
  gst_buffer_unref (scaled);
  gst_buffer_unref (cropped);
}

GST_END_TEST;

static Suite *
map_suite (void)
{
  Suite *s = suite_create ("map");
  TCase *tc = tcase_create ("map");

  suite_add_tcase (s, tc);
  tcase_add_test (tc,
      an_object_in_the_picture_is_mapped_back_to_the_source);
  tcase_add_test (tc, the_meta_has_sizes_and_a_number_and_is_copied);
  tcase_add_test (tc,
      a_scaler_downstream_adjusts_the_meta_and_a_cropper_drops_it);
  return s;
}

GST_CHECK_MAIN (map);
