/* SPDX-License-Identifier: MIT */
/* The element's properties: one for each field of L1L2StabConfig that a user may choose. The defaults are those of
 * l1l2stab_config_init(). */
#ifndef GST_L1L2_STAB_SETTINGS_H
#define GST_L1L2_STAB_SETTINGS_H

#include <gst/gst.h>
#include <l1l2stab/l1l2stab.h>

G_BEGIN_DECLS

/* Installs the properties and registers their enumerations. */
void gst_l1l2_stab_settings_install (GObjectClass * klass);

/* FALSE: no such property. The caller locks `config`. */
gboolean gst_l1l2_stab_settings_set (L1L2StabConfig * config, guint id,
    const GValue * value);
gboolean gst_l1l2_stab_settings_get (const L1L2StabConfig * config, guint id,
    GValue * value);

G_END_DECLS

#endif
