/* SPDX-License-Identifier: MIT */
/* The properties of the element: one for each field of L1L2StabConfig that a user may choose, with the defaults of
 * l1l2stab_config_init(), and a few more. Some apply to single frames: lambda and crop-ratio are sampled when a frame
 * comes in, bypass and post-messages when it goes out. The others, and with output-size=crop the output size, keep
 * the values that they had when the caps last changed. */
#ifndef GST_L1L2_STAB_SETTINGS_H
#define GST_L1L2_STAB_SETTINGS_H

#include <gst/gst.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

/* Read-only. Its value comes from gst_l1l2_stab_report_stats(). */
#define GST_L1L2_STAB_PROP_STATS 1

typedef struct
{
  GstObject *object;            /* its lock guards the rest; not owned */
  L1L2StabConfig wanted;        /* the present values */
  L1L2StabConfig in_use;        /* the values when the caps last changed ... */
  gboolean has_caps;            /* ... if there are caps */
  gboolean bypass;
  gboolean post_messages;
  gboolean border_map;
  gchar *motion_in, *motion_out;        /* file names, or NULL */
  gchar *region;                /* a text, or NULL */
  gchar *mask;                  /* a file name, or NULL */
} GstL1L2StabSettings;

/* Installs the properties and registers their enumerations. */
void gst_l1l2_stab_settings_install (GObjectClass * klass);

void gst_l1l2_stab_settings_init (GstL1L2StabSettings * settings,
    GstObject * object);

void gst_l1l2_stab_settings_clear (GstL1L2StabSettings * settings);

/* FALSE: no such property. */
gboolean gst_l1l2_stab_settings_set (GstL1L2StabSettings * settings, guint id,
    const GValue * value);
gboolean gst_l1l2_stab_settings_get (GstL1L2StabSettings * settings, guint id,
    GValue * value);

/* Called when caps come in on `pad`. If they differ from those before, the present values become those in use. */
void gst_l1l2_stab_settings_adopt (GstL1L2StabSettings * settings,
    GstPad * pad, GstEvent * caps_event);

/* Called when the stream ends: there are no caps any more. */
void gst_l1l2_stab_settings_release (GstL1L2StabSettings * settings);

/* The values in use; before there are caps, the present ones. */
void gst_l1l2_stab_settings_in_use (GstL1L2StabSettings * settings,
    L1L2StabConfig * config);

/* The values for a frame that comes in at this stream time; NONE: not known. Controlled properties are updated
 * first. */
void gst_l1l2_stab_settings_sample (GstL1L2StabSettings * settings,
    GstClockTime stream_time, gdouble * lambda, gdouble * crop_ratio);

/* The values for a frame that goes out. stream_time: that of the frame. */
gboolean gst_l1l2_stab_settings_sample_bypass (GstL1L2StabSettings * settings,
    GstClockTime stream_time);

/* The present value of one of the settings' booleans. */
gboolean gst_l1l2_stab_settings_flag (GstL1L2StabSettings * settings,
    const gboolean * flag);

/* Copies of the texts and file names, each to be freed or NULL. */
void gst_l1l2_stab_settings_dup_files (GstL1L2StabSettings * settings,
    gchar ** motion_in, gchar ** motion_out);
void gst_l1l2_stab_settings_dup_area (GstL1L2StabSettings * settings,
    gchar ** region, gchar ** mask);

G_END_DECLS

#endif
