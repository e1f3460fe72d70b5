/* SPDX-License-Identifier: MIT */
/* The element's properties: one for each field of L1L2StabConfig that a user may choose, with the defaults of
 * l1l2stab_config_init(), and a few of the element's own. Some are live: lambda and crop-ratio, which each frame
 * samples as it comes in, bypass and post-messages, as it goes out. The fields that are not, and with output-size=crop
 * the size that crop-ratio gives, stay as the last new caps found them. */
#ifndef GST_L1L2_STAB_SETTINGS_H
#define GST_L1L2_STAB_SETTINGS_H

#include <gst/gst.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

/* Read-only, and no setting: its value is the report's. */
#define GST_L1L2_STAB_PROP_STATS 1

typedef struct
{
  GstObject *object;            /* its lock guards the rest; not owned */
  L1L2StabConfig wanted;        /* the properties */
  L1L2StabConfig in_use;        /* as the last new caps found them ... */
  gboolean has_caps;            /* ... if there were any */
  gboolean bypass;
  gboolean post_messages;
  gchar *motion_in, *motion_out;        /* names of files, or NULL */
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

/* New caps come in on `pad`: from now on the properties of this moment are in use. The same caps once more change
 * nothing. */
void gst_l1l2_stab_settings_adopt (GstL1L2StabSettings * settings,
    GstPad * pad, GstEvent * caps_event);

/* There are no caps any more. */
void gst_l1l2_stab_settings_release (GstL1L2StabSettings * settings);

/* What is in use; before there are caps, the properties. */
void gst_l1l2_stab_settings_in_use (GstL1L2StabSettings * settings,
    L1L2StabConfig * config);

/* For a frame that comes in at this stream time; controlled properties are brought up to date. NONE: not known. */
void gst_l1l2_stab_settings_sample (GstL1L2StabSettings * settings,
    GstClockTime stream_time, gdouble * lambda, gdouble * crop_ratio);

/* For a frame that goes out, by its stream time. */
gboolean gst_l1l2_stab_settings_sample_bypass (GstL1L2StabSettings * settings,
    GstClockTime stream_time);
gboolean gst_l1l2_stab_settings_post_messages (GstL1L2StabSettings * settings);

/* Each NULL or to be freed. */
void gst_l1l2_stab_settings_dup_files (GstL1L2StabSettings * settings,
    gchar ** motion_in, gchar ** motion_out);

G_END_DECLS

#endif
