/* SPDX-License-Identifier: MIT */
#include "output_file.h"

#include "fault.h"

#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define OWN_FILES "/proc/self/fd"

struct OutputFile {
    int fd;
    char *name;
    char *temporary; /* NULL: the file has no name yet */
};

static gboolean fail(GError **error, const char *name)
{
    const int reason = errno;
    char *shown = printable(name);
    fault(error, EXIT_OUTPUT, "%s: cannot be written: %s", shown, g_strerror(reason));
    g_free(shown);
    return FALSE;
}

gboolean output_file_check(const char *name, const char *input, GError **error)
{
    GStatBuf out, in;
    if (g_stat(name, &out) != 0)
        return TRUE;
    char *shown = printable(name);
    const gboolean same = g_stat(input, &in) == 0 && in.st_dev == out.st_dev && in.st_ino == out.st_ino;
    if (same)
        fault(error, EXIT_USAGE, "%s: is the input too, and will not be overwritten", shown);
    else if (!S_ISREG(out.st_mode))
        fault(error, EXIT_OUTPUT, "%s: exists and is not a regular file", shown);
    g_free(shown);
    return !same && S_ISREG(out.st_mode);
}

/* A name beside the final one that no other file has. */
static char *temporary_name(const char *name)
{
    char *folder = g_path_get_dirname(name), *file = g_strdup_printf(".l1l2stab-%08x%08x", g_random_int(),
                                                                     g_random_int());
    char *temporary = g_build_filename(folder, file, NULL);
    g_free(folder);
    g_free(file);
    return temporary;
}

OutputFile *output_file_open(const char *name, GError **error)
{
    OutputFile *file = g_new0(OutputFile, 1);
    char *folder = g_path_get_dirname(name);
    file->name = g_strdup(name);
    /* Where /proc is not mounted, as in some chroots, a file without a name could not get one at the end. */
    const gboolean named = g_access(OWN_FILES, X_OK) != 0;
    file->fd = named ? -1 : g_open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    if (named || (file->fd < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL))) {
        file->temporary = temporary_name(name);
        file->fd = g_open(file->temporary, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    }
    g_free(folder);
    if (file->fd >= 0)
        return file;
    fail(error, name);
    g_clear_pointer(&file->temporary, g_free); /* it is not ours */
    output_file_discard(file);
    return NULL;
}

int output_file_fd(const OutputFile *file)
{
    return file->fd;
}

/* A file without a name cannot replace another one. So it first gets a temporary name. */
static gboolean give_temporary_name(OutputFile *file)
{
    char source[64];
    if (file->temporary)
        return TRUE;
    g_snprintf(source, sizeof source, OWN_FILES "/%d", file->fd);
    char *temporary = temporary_name(file->name);
    if (linkat(AT_FDCWD, source, AT_FDCWD, temporary, AT_SYMLINK_FOLLOW) == 0)
        file->temporary = temporary;
    else
        g_free(temporary);
    return file->temporary != NULL;
}

gboolean output_file_commit(OutputFile *file, const char *name, GError **error)
{
    const gboolean ok = give_temporary_name(file) && g_rename(file->temporary, name) == 0;
    if (ok)
        g_clear_pointer(&file->temporary, g_free);
    else
        fail(error, name);
    output_file_discard(file);
    return ok;
}

void output_file_discard(OutputFile *file)
{
    if (!file)
        return;
    if (file->fd >= 0)
        close(file->fd);
    if (file->temporary)
        g_unlink(file->temporary);
    g_free(file->temporary);
    g_free(file->name);
    g_free(file);
}

char *output_file_partial_name(const char *name)
{
    const char *dot = strrchr(name, '.'), *slash = strrchr(name, '/');
    const int stem = dot && (!slash || dot > slash) ? (int)(dot - name) : (int)strlen(name);
    return g_strdup_printf("%.*s.partial%s", stem, name, name + stem);
}
