/* SPDX-License-Identifier: MIT */
#include "gstl1l2stabpgm.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <sys/stat.h>

/* The largest number of levels that the format has. */
#define MAX_LEVEL 65535

/* Longer headers have comments that are no comments. */
#define MAX_HEADER 65536

typedef struct
{
  FILE *file;
  gint n_read;                  /* bytes of the header so far */
} Header;

static gint
next_byte (Header * header)
{
  return header->n_read++ < MAX_HEADER ? getc (header->file) : EOF;
}

/* The byte after blanks and comments. A comment reaches from # to the end of its line. */
static gint
skip_blanks (Header * header)
{
  gint byte = next_byte (header);

  while (byte == '#' || g_ascii_isspace (byte)) {
    if (byte == '#') {
      while (byte != '\n' && byte != '\r' && byte != EOF)
        byte = next_byte (header);
    } else {
      byte = next_byte (header);
    }
  }
  return byte;
}

/* A number of the header, and the one blank after it. Any number above `most` is as bad as most + 1. */
static gboolean
parse_number (Header * header, gint most, gint * number)
{
  gint byte = skip_blanks (header);

  *number = 0;
  if (!g_ascii_isdigit (byte))
    return FALSE;
  for (; g_ascii_isdigit (byte); byte = next_byte (header))
    *number = MIN (*number * 10 + byte - '0', most + 1);
  return g_ascii_isspace (byte);
}

/* Returns what is wrong with the header, or NULL. */
static gchar *
parse_header (FILE * file, GstL1L2StabPgm * pgm, gint * max_level)
{
  Header header = { file, 0 };
  const gint most = GST_L1L2_STAB_PGM_MAX_SIDE;

  if (next_byte (&header) != 'P' || next_byte (&header) != '5')
    return g_strdup ("is not a binary PGM file, which begins with P5");
  if (!parse_number (&header, most, &pgm->width)
      || !parse_number (&header, most, &pgm->height)
      || !parse_number (&header, MAX_LEVEL, max_level))
    return g_strdup ("has no PGM header: P5, the width, the height and the "
        "largest level");
  if (pgm->width < 1 || pgm->height < 1 || pgm->width > most
      || pgm->height > most)
    return g_strdup_printf ("has a side that is not from 1 to %d pixels", most);
  if (*max_level < 1 || *max_level > MAX_LEVEL)
    return g_strdup_printf ("has a largest level that is not from 1 to %d",
        MAX_LEVEL);
  return NULL;
}

/* A row of samples of one byte, or of two with the high one first. */
static void
convert_row (const guint8 * samples, gint max_level, guint8 * pixels, gint width)
{
  gint x;

  for (x = 0; x < width; x++) {
    const gint level = max_level < 256 ? samples[x]
        : samples[2 * x] << 8 | samples[2 * x + 1];

    pixels[x] = 2 * level < max_level ? 0 : 255;
  }
}

static gchar *
read_rows (FILE * file, gint max_level, GstL1L2StabPgm * pgm)
{
  const gsize bytes = (gsize) pgm->width * (max_level < 256 ? 1 : 2);
  guint8 *samples = g_malloc (bytes);
  gint y = 0;

  pgm->pixels = g_try_malloc ((gsize) pgm->width * pgm->height);
  while (pgm->pixels && y < pgm->height
      && fread (samples, 1, bytes, file) == bytes) {
    convert_row (samples, max_level, pgm->pixels + (gsize) y * pgm->width,
        pgm->width);
    y++;
  }
  g_free (samples);
  if (!pgm->pixels)
    return g_strdup ("is too large for the free memory");
  if (y < pgm->height)
    return g_strdup_printf ("ends in row %d of %d", y + 1, pgm->height);
  return NULL;
}

GstL1L2StabPgmResult
gst_l1l2_stab_pgm_read (GstL1L2StabPgm * pgm, const gchar * name,
    gchar ** fault)
{
  GStatBuf status;
  gint max_level;
  FILE *file;

  *pgm = (GstL1L2StabPgm) { 0 };
  *fault = NULL;
  /* Opening a pipe that nobody writes to would wait for ever. */
  if (g_stat (name, &status) == 0 && !S_ISREG (status.st_mode)) {
    *fault = g_strdup ("is not a regular file");
    return GST_L1L2_STAB_PGM_BAD;
  }
  file = g_fopen (name, "rb");
  if (!file) {
    *fault = g_strdup_printf ("cannot be opened: %s", g_strerror (errno));
    return GST_L1L2_STAB_PGM_CANNOT_OPEN;
  }
  *fault = parse_header (file, pgm, &max_level);
  if (!*fault)
    *fault = read_rows (file, max_level, pgm);
  fclose (file);
  if (!*fault)
    return GST_L1L2_STAB_PGM_OK;
  gst_l1l2_stab_pgm_clear (pgm);
  return GST_L1L2_STAB_PGM_BAD;
}

void
gst_l1l2_stab_pgm_clear (GstL1L2StabPgm * pgm)
{
  g_free (pgm->pixels);
  *pgm = (GstL1L2StabPgm) { 0 };
}
