/* SPDX-License-Identifier: MIT */
/* Reads masks from binary PGM files (netpbm's format P5), which all image tools can write. */
#ifndef GST_L1L2_STAB_PGM_H
#define GST_L1L2_STAB_PGM_H

#include <glib.h>

G_BEGIN_DECLS

/* The largest side of a mask, which is the library's limit. */
#define GST_L1L2_STAB_PGM_MAX_SIDE 16384

typedef struct
{
  guint8 *pixels;               /* row by row, without padding: 0 where the file is darker than middle gray, else 255 */
  gint width, height;
} GstL1L2StabPgm;

typedef enum
{
  GST_L1L2_STAB_PGM_OK,
  GST_L1L2_STAB_PGM_CANNOT_OPEN,
  GST_L1L2_STAB_PGM_BAD         /* it cannot be read, or is no PGM of an acceptable size */
} GstL1L2StabPgmResult;

/* Reads the first picture of a file of 8 or 16 bits. Memory is bounded by the largest size. On failure *pgm is empty,
 * and *fault, to be freed, says what is wrong with the file: "has ..." or "is ...". */
GstL1L2StabPgmResult gst_l1l2_stab_pgm_read (GstL1L2StabPgm * pgm,
    const gchar * name, gchar ** fault);
void gst_l1l2_stab_pgm_clear (GstL1L2StabPgm * pgm);

G_END_DECLS

#endif
