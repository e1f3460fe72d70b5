/* SPDX-License-Identifier: MIT */
/* The properties region and mask: they choose what is measured, and a wrong one is an error that says what to do. */
#include <glib/gstdio.h>

#include "stabnoise.h"

#define WINDOW 4
#define N_FRAMES 12

static gchar *folder;
static gchar *mask_file;

static void
make_folder (void)
{
  folder = g_dir_make_tmp ("l1l2stab-area-XXXXXX", NULL);
  fail_unless (folder != NULL);
  mask_file = g_build_filename (folder, "mask.pgm", NULL);
}

static void
remove_folder (void)
{
  g_remove (mask_file);
  fail_unless_equals_int (g_rmdir (folder), 0);
  g_free (mask_file);
  g_free (folder);
}

/* Sets the mask file's contents: a text, and bytes after it. */
static void
write_mask (const gchar * header, const gchar * bytes, gsize n)
{
  GString *contents = g_string_new (header);

  g_string_append_len (contents, bytes, n);
  fail_unless (g_file_set_contents (mask_file, contents->str, contents->len,
          NULL));
  g_string_free (contents, TRUE);
}

/* The element in state NULL, with a bus. */
static GstHarness *
harness_new (const gchar * region, const gchar * mask)
{
  GstHarness *h = stab_harness_new (NULL, "window", WINDOW, NULL);

  gst_element_set_state (h->element, GST_STATE_NULL);
  g_object_set (h->element, "region", region, "mask", mask, "post-messages",
      TRUE, NULL);
  return h;
}

static void
play (GstHarness * h, const gchar * caps)
{
  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PLAYING), GST_STATE_CHANGE_SUCCESS);
  gst_harness_set_src_caps_str (h, caps);
}

/* Takes the error from the bus and checks that its text has all of the words. */
static void
assert_error_says (GstHarness * h, GQuark domain, gint code,
    const gchar * const *words)
{
  GstMessage *message = stab_harness_message (h, GST_MESSAGE_ERROR);
  GError *error = NULL;

  fail_unless (message != NULL, "no error was posted");
  gst_message_parse_error (message, &error, NULL);
  fail_unless (g_error_matches (error, domain, code), "%s", error->message);
  for (; *words; words++)
    fail_unless (strstr (error->message, *words) != NULL,
        "\"%s\" does not say %s", error->message, *words);
  g_clear_error (&error);
  gst_message_unref (message);
}

/* --- what they do --- */

/* The camera films the left quarter of the frame. The rest is covered by something else, which moves the other way. */
static void
fill (guint8 * pixels, guint index)
{
  guint8 *scene = g_malloc (NOISE_WIDTH * NOISE_HEIGHT);
  guint x, y;

  stab_noise_fill (scene, index);
  stab_noise_fill (pixels, 0);
  for (y = 0; y < NOISE_HEIGHT; y++) {
    guint8 *row = pixels + y * NOISE_WIDTH;

    for (x = 0; x < NOISE_WIDTH; x++)
      row[x] = x < NOISE_WIDTH / 4 ? scene[y * NOISE_WIDTH + x]
          : ((x + 1000 - 2 * index) / 8 * 83492791u ^ (y + index) / 8 * 2971215073u)
          * 2654435761u >> 24;
  }
  g_free (scene);
}

/* The scene's motion from frame `index` to the one before it, as stab_noise_fill() makes it. */
static void
scene_motion (guint index, gdouble * x, gdouble * y)
{
  *x = 3 + (gint) ((index * 5) % 7) - (gint) (((index - 1) * 5) % 7);
  *y = (gint) ((index * 3) % 5) - (gint) (((index - 1) * 3) % 5);
}

/* The motions that the element measures. */
static void
measure (const gchar * region, const gchar * mask, gdouble motion[N_FRAMES][9])
{
  GstHarness *h = harness_new (region, mask);
  guint i;

  play (h, NOISE_CAPS);
  for (i = 0; i < N_FRAMES; i++) {
    GstBuffer *buffer = stab_noise_new (i);
    GstMapInfo map;

    fail_unless (gst_buffer_map (buffer, &map, GST_MAP_WRITE));
    fill (map.data, i);
    gst_buffer_unmap (buffer, &map);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (i = 0; i < N_FRAMES; i++) {
    GstMessage *message = stab_harness_message (h, GST_MESSAGE_ELEMENT);

    fail_unless (message != NULL);
    stab_get_matrix (gst_message_get_structure (message), "motion", motion[i]);
    gst_message_unref (message);
  }
  stab_harness_free (h);
}

/* The largest distance of the measured motion of the frame's center from the scene's. */
static gdouble
worst_error (gdouble motion[N_FRAMES][9])
{
  gdouble worst = 0;
  guint i;

  for (i = 1; i < N_FRAMES; i++) {
    gdouble x, y;

    scene_motion (i, &x, &y);
    worst = MAX (worst, MAX (ABS (motion[i][2] - x), ABS (motion[i][5] - y)));
  }
  return worst;
}

/* The left quarter, by each way to say so. */
static const struct
{
  const gchar *region;
  const gchar *mask_header;
  const gchar *mask_bytes;
  gsize n;
} quarters[] = {
  {"0,0,40,120", NULL, NULL, 0},
  {"0,0,25%,100%", NULL, NULL, 0},
  {" 0% , 0 ,40, 1e2%", NULL, NULL, 0},
  {"", "P5 4 1 255\n", "\377\0\0\0", 4},
  {NULL, "P5\n# a comment\n4 # and another\n2\n1\n", "\1\0\0\0\1\0\0\0", 8},
  {NULL, "P5 4 1 65535\n", "\200\0\177\377\0\377\0\0", 8},
  {NULL, "P5 4 1 200 ", "\144\143\0\1 and what comes after the picture", 37},
  {"0,0,100%,100%", "P5\r\n4\t1\n256\n", "\0\377\0\0\0\0\0\0", 8},
  {"0,0,50%,100%", "P5 4 1 255\n", "\377\0\377\377", 4},
};

GST_START_TEST (region_and_mask_decide_which_motion_is_followed)
{
  gdouble motion[N_FRAMES][9], first[N_FRAMES][9];
  guint i;

  measure (NULL, NULL, motion);
  fail_unless (worst_error (motion) > 3, "the scene is followed anyway");
  measure (quarters[0].region, NULL, first);
  for (i = 0; i < G_N_ELEMENTS (quarters); i++) {
    if (quarters[i].mask_header)
      write_mask (quarters[i].mask_header, quarters[i].mask_bytes,
          quarters[i].n);
    measure (quarters[i].region, quarters[i].mask_header ? mask_file : NULL,
        motion);
    fail_unless (worst_error (motion) < 0.5, "way %u: %g pixels off", i,
        worst_error (motion));
    fail_unless (memcmp (motion, first, sizeof (motion)) == 0, "way %u", i);
  }
}

GST_END_TEST;

GST_START_TEST (a_pipeline_runs_with_both)
{
  gchar *description;
  GstElement *pipeline;
  GError *error = NULL;

  write_mask ("P5 2 2 255\n", "\377\0\377\377", 4);
  description = g_strdup_printf ("videotestsrc num-buffers=20 pattern=zone-plate "
      "kx2=20 ky2=20 kt=1 ! video/x-raw, width=320, height=240 ! l1l2stab window=8 "
      "region=10%%,0,80%%,50%% mask=%s ! fakesink", mask_file);
  pipeline = gst_parse_launch (description, &error);
  fail_unless (error == NULL, "%s", error ? error->message : "");
  stab_play_to_end (pipeline, description);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
  g_free (description);
}

GST_END_TEST;

/* --- other sizes of frames --- */

#define LARGE_CAPS \
  "video/x-raw, format=I420, width=128, height=96, framerate=25/1"

GST_START_TEST (percents_fit_frames_of_every_size)
{
  GstHarness *h = harness_new ("50%,50%,50%,50%", NULL);

  play (h, LARGE_CAPS);
  gst_harness_set_src_caps_str (h, SMALL_CAPS);
  stab_push_frames (h, 0, 10);
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (h), 10);
  fail_unless (stab_harness_message (h, GST_MESSAGE_ERROR) == NULL);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (pixels_outside_of_later_frames_are_an_error)
{
  static const gchar *const words[] = { "region=64,48,64,48", "64x48", "% signs",
    NULL
  };
  GstHarness *h = harness_new ("64,48,64,48", NULL);

  play (h, LARGE_CAPS);
  stab_push_frames (h, 0, 10);
  fail_unless (stab_harness_message (h, GST_MESSAGE_ERROR) == NULL);
  gst_harness_set_src_caps_str (h, SMALL_CAPS);
  fail_unless_equals_int (gst_harness_buffers_received (h), 10);
  assert_error_says (h, GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_SETTINGS, words);
  fail_unless_equals_int (gst_harness_push (h, stab_frame_new (h, 10)),
      GST_FLOW_NOT_NEGOTIATED);
  stab_harness_free (h);
}

GST_END_TEST;

/* --- errors --- */

static const gchar *const no_regions[] = {
  "10,20", "1,2,3,4,5", "a,b,c,d", "10%,,80%,50%", "nan,0,1,1", "0,0,1e999,1",
  "0,0,50%%,1", "0,0,5 0%,1", ",", "0;0;50%;50%", "0,0,50%,50%x"
};

GST_START_TEST (a_text_that_is_no_region_fails_at_the_start)
{
  const gchar *const words[] = { "region is \"", no_regions[__i__],
    "x,y,width,height", "region=10%,0,80%,50%", NULL
  };
  GstHarness *h = harness_new (no_regions[__i__], NULL);

  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  assert_error_says (h, GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_SETTINGS, words);
  /* It can be corrected. */
  g_object_set (h->element, "region", "0,0,50%,50%", NULL);
  play (h, SMALL_CAPS);
  stab_push_frames (h, 0, 1);
  stab_harness_free (h);
}

GST_END_TEST;

static const struct
{
  const gchar *region, *word;
} misfits[] = {
  {"0,0,65,48", "beyond the frame"},
  {"-1,0,40,48", "beyond the frame"},
  {"0,40%,64,61%", "beyond the frame"},
  {"0,0,1e300,1", "beyond the frame"},
  {"0,0,7,48", "too narrow"},
  {"0,0,100%,12%", "too low"},
  {"50%,0,-10%,100%", "too narrow"},
};

GST_START_TEST (a_region_that_does_not_fit_the_frames_fails_at_their_caps)
{
  const gchar *const words[] = { misfits[__i__].region, misfits[__i__].word,
    "64x48", "at least 1/8", NULL
  };
  GstHarness *h = harness_new (misfits[__i__].region, NULL);

  play (h, SMALL_CAPS);
  assert_error_says (h, GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_SETTINGS, words);
  fail_unless_equals_int (gst_harness_push (h, stab_frame_new (h, 0)),
      GST_FLOW_NOT_NEGOTIATED);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_mask_that_leaves_nothing_fails_and_names_both_properties)
{
  static const gchar *const words[] = { "region and mask leave 0 %",
    "at least 1 %", NULL
  };
  GstHarness *h;

  write_mask ("P5 2 2 255\n", "\0\0\377\377", 4);
  h = harness_new ("0,0,100%,50%", mask_file);
  play (h, SMALL_CAPS);
  assert_error_says (h, GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_SETTINGS, words);
  stab_harness_free (h);
}

GST_END_TEST;

static const struct
{
  const gchar *contents, *words;
} no_masks[] = {
  {"", "begins with P5"},
  {"P", "begins with P5"},
  {"P6 1 1 255\nabc", "begins with P5"},
  {"P2 1 1 255\n7\n", "begins with P5"},
  {"\211PNG\r\n\032\n", "begins with P5"},
  {"P5", "no PGM header"},
  {"P5 3 3", "no PGM header"},
  {"P5 3 3 255", "no PGM header"},
  {"P5 -3 3 255\n123456789", "no PGM header"},
  {"P5 3 3 255x123456789", "no PGM header"},
  {"P5 #", "no PGM header"},
  {"P5 0 3 255\n", "from 1 to 16384"},
  {"P5 3 16385 255\n", "from 1 to 16384"},
  {"P5 99999999999999999999999999 1 255\n", "from 1 to 16384"},
  {"P5 4294967297 1 255\n0", "from 1 to 16384"},
  {"P5 1 1 0\n0", "largest level"},
  {"P5 1 1 65536\n00", "largest level"},
  {"P5 16384 16384 65535\n", "ends in row 1 of 16384"},
  {"P5 3 3 255\n12345678", "ends in row 3 of 3"},
  {"P5 3 3 256\n123456789", "ends in row 2 of 3"},
};

GST_START_TEST (a_file_that_is_no_mask_fails_at_the_start)
{
  const gchar *const words[] = { "mask: ", mask_file, no_masks[__i__].words,
    "binary PGM of 8 or 16 bits", NULL
  };
  GstHarness *h;

  write_mask (no_masks[__i__].contents, "", 0);
  h = harness_new (NULL, mask_file);
  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  assert_error_says (h, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ, words);
  /* The file is read again when the element starts again. */
  write_mask ("P5 1 1 255\n", "\377", 1);
  play (h, SMALL_CAPS);
  stab_push_frames (h, 0, 1);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_header_without_an_end_is_no_mask)
{
  const gchar *const words[] = { "no PGM header", NULL };
  gchar *comment = g_strnfill (1000000, 'c');
  GstHarness *h;

  write_mask ("P5 1 1 #", comment, 1000000);
  g_free (comment);
  h = harness_new (NULL, mask_file);
  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  assert_error_says (h, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ, words);
  stab_harness_free (h);
}

GST_END_TEST;

GST_START_TEST (a_mask_that_cannot_be_opened_fails_at_the_start)
{
  const gchar *const missing[] = { "mask: ", mask_file, "cannot be opened", NULL };
  const gchar *const no_file[] = { "mask: ", folder, "not a regular file", NULL };
  GstHarness *h = harness_new (NULL, mask_file);

  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  assert_error_says (h, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_OPEN_READ,
      missing);
  g_object_set (h->element, "mask", folder, NULL);
  fail_unless_equals_int (gst_element_set_state (h->element,
          GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  assert_error_says (h, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ, no_file);
  stab_harness_free (h);
}

GST_END_TEST;

static Suite *
area_suite (void)
{
  Suite *s = suite_create ("area");
  TCase *tc = tcase_create ("area");

  suite_add_tcase (s, tc);
  tcase_add_checked_fixture (tc, make_folder, remove_folder);
  tcase_add_test (tc, region_and_mask_decide_which_motion_is_followed);
  tcase_add_test (tc, a_pipeline_runs_with_both);
  tcase_add_test (tc, percents_fit_frames_of_every_size);
  tcase_add_test (tc, pixels_outside_of_later_frames_are_an_error);
  tcase_add_loop_test (tc, a_text_that_is_no_region_fails_at_the_start, 0,
      G_N_ELEMENTS (no_regions));
  tcase_add_loop_test (tc,
      a_region_that_does_not_fit_the_frames_fails_at_their_caps, 0,
      G_N_ELEMENTS (misfits));
  tcase_add_test (tc,
      a_mask_that_leaves_nothing_fails_and_names_both_properties);
  tcase_add_loop_test (tc, a_file_that_is_no_mask_fails_at_the_start, 0,
      G_N_ELEMENTS (no_masks));
  tcase_add_test (tc, a_header_without_an_end_is_no_mask);
  tcase_add_test (tc, a_mask_that_cannot_be_opened_fails_at_the_start);
  return s;
}

GST_CHECK_MAIN (area);
