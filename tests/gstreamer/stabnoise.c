/* SPDX-License-Identifier: MIT */
#include "stabnoise.h"

void
stab_noise_fill (guint8 * pixels, guint index)
{
  const guint shift_x = index * 3 + (index * 5) % 7, shift_y = (index * 3) % 5;
  guint x, y;

  for (y = 0; y < NOISE_HEIGHT; y++)
    for (x = 0; x < NOISE_WIDTH; x++)
      *pixels++ = ((x + shift_x) / 8 * 73856093u
          ^ (y + shift_y) / 8 * 19349663u) * 2654435761u >> 24;
}

GstBuffer *
stab_noise_new (guint index)
{
  guint8 *pixels = g_malloc (NOISE_WIDTH * NOISE_HEIGHT);
  GstBuffer *buffer;

  stab_noise_fill (pixels, index);
  buffer = gst_buffer_new_wrapped (pixels, NOISE_WIDTH * NOISE_HEIGHT);
  GST_BUFFER_PTS (buffer) = index * FRAME_DURATION;
  GST_BUFFER_DURATION (buffer) = FRAME_DURATION;
  return buffer;
}

void
stab_noise_config (L1L2StabConfig * config, gint window)
{
  l1l2stab_config_init (config, sizeof (*config));
  config->format = L1L2STAB_FORMAT_GRAY8;
  config->width = NOISE_WIDTH;
  config->height = NOISE_HEIGHT;
  config->frame_rate = 25;
  config->window = window;
}

void
stab_noise_infos (gint window, guint n, L1L2StabInfo * infos)
{
  guint8 *pictures = g_malloc (n * NOISE_WIDTH * NOISE_HEIGHT);
  L1L2StabConfig config;
  L1L2Stab *stab = NULL;
  guint i, pulled = 0;

  stab_noise_config (&config, window);
  fail_unless_equals_int (l1l2stab_create (&stab, &config), L1L2STAB_OK);
  for (i = 0; i < n; i++) {
    L1L2StabFrame frame = { 0 };

    frame.data[0] = pictures + i * NOISE_WIDTH * NOISE_HEIGHT;
    stab_noise_fill (frame.data[0], i);
    frame.stride[0] = NOISE_WIDTH;
    fail_unless_equals_int (l1l2stab_push (stab, &frame), L1L2STAB_OK);
    if (l1l2stab_pull (stab, NULL, &infos[pulled]) == L1L2STAB_OK)
      pulled++;
  }
  l1l2stab_finish (stab);
  while (pulled < n)
    fail_unless_equals_int (l1l2stab_pull (stab, NULL, &infos[pulled++]),
        L1L2STAB_OK);
  l1l2stab_free (&stab);
  g_free (pictures);
}

GstHarness *
stab_noise_harness_new (gint window)
{
  return stab_harness_new (NOISE_CAPS, "window", window, NULL);
}

void
stab_noise_push (GstHarness * h, guint start, guint n)
{
  guint i;

  for (i = start; i < start + n; i++)
    fail_unless_equals_int (gst_harness_push (h, stab_noise_new (i)),
        GST_FLOW_OK);
}

void
stab_get_matrix (const GstStructure * structure, const gchar * field,
    gdouble matrix[9])
{
  const GValue *array = gst_structure_get_value (structure, field);
  guint i;

  fail_unless (array && GST_VALUE_HOLDS_ARRAY (array), "no array %s", field);
  fail_unless_equals_int (gst_value_array_get_size (array), 9);
  for (i = 0; i < 9; i++)
    matrix[i] = g_value_get_double (gst_value_array_get_value (array, i));
}
