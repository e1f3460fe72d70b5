/* SPDX-License-Identifier: MIT */
/* What GStreamer loads: the plugin "l1l2stab" and the one element in it. */
#include "gstl1l2stab.h"

static gboolean
plugin_init (GstPlugin * plugin)
{
  return GST_ELEMENT_REGISTER (l1l2stab, plugin);
}

/* 1.22 does not know the licence by its SPDX name. */
GST_PLUGIN_DEFINE (GST_VERSION_MAJOR, GST_VERSION_MINOR, l1l2stab,
    "Video stabilization with L1-L2 optimal camera paths",
    plugin_init, VERSION, "MIT/X11", PACKAGE, PACKAGE_ORIGIN)
