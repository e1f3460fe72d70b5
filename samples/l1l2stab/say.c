/* SPDX-License-Identifier: MIT */
#include "say.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#define TERMINAL_INTERVAL_US (G_USEC_PER_SEC / 4)
#define PLAIN_INTERVAL_US (5 * G_USEC_PER_SEC)
#define JSON_INTERVAL_US (G_USEC_PER_SEC / 2)

static struct {
    gboolean json, quiet, verbose, terminal;
    gboolean line_open;   /* a line of progress is on the terminal */
    gint64 last_us;       /* when progress was shown last; 0: never */
    GMutex lock;
} say;

void say_init(gboolean json, gboolean quiet, gboolean verbose)
{
    say.json = json;
    say.quiet = quiet;
    say.verbose = verbose;
    say.terminal = isatty(STDERR_FILENO);
}

char *say_json_string(const char *text)
{
    GString *out = g_string_new("\"");
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c == '"' || *c == '\\')
            g_string_append_printf(out, "\\%c", *c);
        else if (*c < 0x20 || *c == 0x7f)
            g_string_append_printf(out, "\\u%04x", *c);
        else
            g_string_append_c(out, (char)*c);
    }
    return g_string_free(g_string_append_c(out, '"'), FALSE);
}

static void json_line(const char *line)
{
    fputs(line, stdout);
    fputc('\n', stdout);
    fflush(stdout);
}

static void json_text(const char *type, const char *text)
{
    char *quoted = say_json_string(text), *line = g_strdup_printf("{\"type\": \"%s\", \"text\": %s}", type, quoted);
    json_line(line);
    g_free(line);
    g_free(quoted);
}

static void plain_line(const char *text)
{
    fprintf(stderr, "%s%s\n", say.line_open ? "\n" : "", text);
    say.line_open = FALSE;
}

static void message(const char *type, const char *text, gboolean for_people)
{
    g_mutex_lock(&say.lock);
    if (say.json)
        json_text(type, text);
    if (for_people && !say.json) {
        char *line = g_strconcat("l1l2stab: ", text, NULL);
        plain_line(line);
        g_free(line);
    }
    g_mutex_unlock(&say.lock);
}

void say_note(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *text = g_strdup_vprintf(format, args);
    va_end(args);
    message("note", text, !say.quiet);
    g_free(text);
}

void say_detail(const char *format, ...)
{
    va_list args;
    if (!say.verbose)
        return;
    va_start(args, format);
    char *text = g_strdup_vprintf(format, args);
    va_end(args);
    message("detail", text, TRUE);
    g_free(text);
}

void say_error(const char *text)
{
    message("error", text, TRUE);
}

static char *clock_text(double seconds)
{
    const int whole = (int)MIN(seconds + 0.5, 359999.0);
    return whole >= 3600 ? g_strdup_printf("%d:%02d:%02d", whole / 3600, whole / 60 % 60, whole % 60)
                         : g_strdup_printf("%d:%02d", whole / 60, whole % 60);
}

static double rate_of(const Progress *progress)
{
    return progress->elapsed > 0 ? (double)progress->frames / progress->elapsed : 0.0;
}

/* Seconds until the end, or -1. */
static double left_of(const Progress *progress)
{
    if (progress->duration <= 0 || progress->seconds <= 0)
        return -1;
    return progress->elapsed * MAX(0.0, progress->duration / progress->seconds - 1);
}

static char *progress_json(const Progress *progress, const char *type, const char *more)
{
    char *file = say_json_string(progress->file);
    char seconds[G_ASCII_DTOSTR_BUF_SIZE], duration[G_ASCII_DTOSTR_BUF_SIZE], elapsed[G_ASCII_DTOSTR_BUF_SIZE],
        rate[G_ASCII_DTOSTR_BUF_SIZE], left[G_ASCII_DTOSTR_BUF_SIZE];
    const size_t size = G_ASCII_DTOSTR_BUF_SIZE;
    char *line = g_strdup_printf("{\"type\": \"%s\", \"file\": %s, \"frames\": %" G_GINT64_FORMAT
                                 ", \"seconds\": %s, \"duration\": %s, \"elapsed\": %s, \"fps\": %s, \"left\": %s, "
                                 "\"bytes\": %" G_GINT64_FORMAT "%s}",
                                 type, file, progress->frames,
                                 g_ascii_formatd(seconds, (int)size, "%.3f", progress->seconds),
                                 g_ascii_formatd(duration, (int)size, "%.3f", progress->duration),
                                 g_ascii_formatd(elapsed, (int)size, "%.3f", progress->elapsed),
                                 g_ascii_formatd(rate, (int)size, "%.1f", rate_of(progress)),
                                 g_ascii_formatd(left, (int)size, "%.0f", left_of(progress)),
                                 progress->bytes, more);
    g_free(file);
    return line;
}

static void show_line(const Progress *progress)
{
    const double left = left_of(progress);
    char *time_left = left >= 0 ? clock_text(left) : NULL, *size = g_format_size((guint64)progress->bytes);
    const double percent = progress->duration > 0 ? 100 * MIN(1.0, progress->seconds / progress->duration) : 0;
    GString *line = g_string_new(NULL);
    if (progress->duration > 0)
        g_string_append_printf(line, "%3.0f %%, ", percent);
    g_string_append_printf(line, "%" G_GINT64_FORMAT " frames, %.1f frames/s", progress->frames, rate_of(progress));
    if (time_left)
        g_string_append_printf(line, ", %s left", time_left);
    g_string_append_printf(line, ", %s", size);
    if (say.terminal) {
        fprintf(stderr, "\r%s\033[K", line->str);
        say.line_open = TRUE;
    } else
        fprintf(stderr, "l1l2stab: %s: %s\n", progress->file, line->str);
    g_string_free(line, TRUE);
    g_free(time_left);
    g_free(size);
}

void say_progress(const Progress *progress)
{
    const gint64 now = g_get_monotonic_time();
    const gint64 interval = say.json ? JSON_INTERVAL_US : say.terminal ? TERMINAL_INTERVAL_US : PLAIN_INTERVAL_US;
    g_mutex_lock(&say.lock);
    if (say.last_us == 0)
        say.last_us = now - (say.terminal || say.json ? interval : 0);
    const gboolean due = now - say.last_us >= interval && progress->frames > 0;
    if (due)
        say.last_us = now;
    if (due && say.json) {
        char *line = progress_json(progress, "progress", "");
        json_line(line);
        g_free(line);
    } else if (due && !say.quiet)
        show_line(progress);
    g_mutex_unlock(&say.lock);
}

void say_done(const Progress *progress, const char *out, int exit_code)
{
    g_mutex_lock(&say.lock);
    char *quoted = out ? say_json_string(out) : g_strdup("null");
    char *more = g_strdup_printf(", \"output\": %s, \"exit\": %d", quoted, exit_code);
    if (say.json) {
        char *line = progress_json(progress, "result", more);
        json_line(line);
        g_free(line);
    } else if (!say.quiet) {
        char *size = g_format_size((guint64)progress->bytes);
        char *text = g_strdup_printf("l1l2stab: %s: %" G_GINT64_FORMAT " frames, %.1f frames/s, %s", out
                                     ? out : progress->file,
                                     progress->frames, rate_of(progress), size);
        if (say.terminal && say.line_open)
            fputs("\r\033[K", stderr);
        say.line_open = FALSE;
        plain_line(text);
        g_free(text);
        g_free(size);
    }
    g_free(more);
    g_free(quoted);
    say.last_us = 0;
    g_mutex_unlock(&say.lock);
}

void say_result(const char *json, const char *text)
{
    g_mutex_lock(&say.lock);
    if (say.json)
        json_line(json);
    else if (text) {
        fputs(text, stdout);
        fflush(stdout);
    }
    g_mutex_unlock(&say.lock);
}
