/* SPDX-License-Identifier: MIT */
/* Informational: the time to load the plugin, and the time from the NULL state of a new element to its first output
 * caps, by frame size. Median ms. */
#include "stabharness.h"

#define ROUNDS 21

static gint
compare (gconstpointer a, gconstpointer b)
{
  const gint64 x = *(const gint64 *) a, y = *(const gint64 *) b;

  return (x > y) - (x < y);
}

static gint64
start_once (const gchar * caps)
{
  GstElement *element = gst_element_factory_make ("l1l2stab", NULL);
  GstHarness *h;
  GstCaps *negotiated;
  gint64 start, end;

  start = g_get_monotonic_time ();
  h = gst_harness_new_with_element (element, "sink", "src");
  gst_harness_set_src_caps_str (h, caps);
  negotiated = gst_pad_get_current_caps (h->sinkpad);
  end = g_get_monotonic_time ();
  g_assert_nonnull (negotiated);
  gst_caps_unref (negotiated);
  gst_harness_teardown (h);
  gst_object_unref (element);
  return end - start;
}

int
main (int argc, char **argv)
{
  static const gint sizes[][2] = { {640, 360}, {1920, 1080}, {3840, 2160} };
  GstPlugin *plugin;
  gint64 start;
  guint i, k;

  gst_init (&argc, &argv);
  start = g_get_monotonic_time ();
  plugin = gst_plugin_load_by_name ("l1l2stab");
  g_print ("loading the plugin: %.1f ms\n",
      (g_get_monotonic_time () - start) / 1000.0);
  g_assert_nonnull (plugin);

  for (i = 0; i < G_N_ELEMENTS (sizes); i++) {
    gchar *caps = g_strdup_printf ("video/x-raw, format=I420, width=%d, "
        "height=%d, framerate=30/1", sizes[i][0], sizes[i][1]);
    gint64 us[ROUNDS];

    for (k = 0; k < ROUNDS; k++)
      us[k] = start_once (caps);
    qsort (us, ROUNDS, sizeof us[0], compare);
    g_print ("%dx%d: %.1f ms to the first caps\n", sizes[i][0], sizes[i][1],
        us[ROUNDS / 2] / 1000.0);
    g_free (caps);
  }
  gst_object_unref (plugin);
  return 0;
}
