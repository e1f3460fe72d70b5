/* SPDX-License-Identifier: MIT */
/* A program that leaks a buffer on purpose. It shows that no_leaks.sh finds leaks. */
#include <gst/check/gstcheck.h>

GST_START_TEST (a_buffer_is_left_behind)
{
  fail_unless (gst_buffer_new () != NULL);
}

GST_END_TEST;

static Suite *
leak_suite (void)
{
  Suite *s = suite_create ("leak");
  TCase *tc = tcase_create ("leak");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, a_buffer_is_left_behind);
  return s;
}

GST_CHECK_MAIN (leak);
