/* SPDX-License-Identifier: MIT */
#include "fault.h"

GQuark fault_quark(void)
{
    return g_quark_from_static_string("l1l2stab-fault");
}

gboolean fault(GError **error, int exit_code, const char *format, ...)
{
    va_list args;
    if (!error || *error)
        return FALSE;
    va_start(args, format);
    char *text = g_strdelimit(g_strdup_vprintf(format, args), "\r\n", ' ');
    va_end(args);
    *error = g_error_new_literal(FAULT, exit_code, text);
    g_free(text);
    return FALSE;
}

char *printable(const char *name)
{
    char *text = g_filename_display_name(name);
    for (char *c = text; *c; c = g_utf8_next_char(c))
        if (g_ascii_iscntrl(*c))
            *c = '?';
    return text;
}
