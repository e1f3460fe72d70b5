/* SPDX-License-Identifier: MIT */
/* The element's properties: one for each field of L1L2StabConfig that a user may choose. The defaults are those of
 * l1l2stab_config_init(). Two are live, lambda and crop-ratio: each frame samples them. The rest, and with
 * output-size=crop the size that crop-ratio gives, stay as the last new caps found them. */
#ifndef GST_L1L2_STAB_SETTINGS_H
#define GST_L1L2_STAB_SETTINGS_H

#include <gst/gst.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

typedef struct
{
  GstObject *object;            /* its lock guards the rest; not owned */
  L1L2StabConfig wanted;        /* the properties */
  L1L2StabConfig in_use;        /* as the last new caps found them ... */
  gboolean has_caps;            /* ... if there were any */
} GstL1L2StabSettings;

/* Installs the properties and registers their enumerations. */
void gst_l1l2_stab_settings_install (GObjectClass * klass);

void gst_l1l2_stab_settings_init (GstL1L2StabSettings * settings,
    GstObject * object);

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

/* The live properties at the time of this frame, whose segment it is: controlled ones are brought up to date. */
void gst_l1l2_stab_settings_sample (GstL1L2StabSettings * settings,
    const GstSegment * segment, GstBuffer * frame, gdouble * lambda,
    gdouble * crop_ratio);

G_END_DECLS

#endif
