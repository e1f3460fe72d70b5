/* SPDX-License-Identifier: MIT */
#include "batch.h"

#include "encoder.h"
#include "fault.h"
#include "interrupt.h"
#include "say.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define DEFAULT_SUFFIX "-stabilized"
#define DEFAULT_FORMAT ".mp4"
#define THIS_PROGRAM "/proc/self/exe"

/* ---- names ---- */

char *batch_output_name(const Options *options, const char *in)
{
    if (options->out)
        return g_strdup(options->out);
    char *folder = options->out_dir ? g_strdup(options->out_dir) : g_path_get_dirname(in);
    char *base = g_path_get_basename(in), *dot = strrchr(base, '.');
    char *format = options->format       ? g_strconcat(".", options->format, NULL)
                   : container_of(base) ? g_strdup(dot)
                                        : g_strdup(DEFAULT_FORMAT);
    if (dot && dot != base)
        *dot = '\0';
    char *file = g_strconcat(base, options->suffix ? options->suffix : DEFAULT_SUFFIX, format, NULL);
    char *name = strcmp(folder, ".") == 0 && !options->out_dir ? g_strdup(file) : g_build_filename(folder, file, NULL);
    g_free(file);
    g_free(format);
    g_free(base);
    g_free(folder);
    return name;
}

/* Files in a folder that are taken for videos. A file that is named itself is always tried. */
static gboolean looks_like_video(const char *name)
{
    static const char *const suffixes[] = {".mp4", ".m4v", ".mov", ".mkv", ".webm", ".avi", ".ts", ".mts", ".m2ts",
                                           ".mpg",
                                           ".mpeg", ".vob", ".wmv", ".flv", ".3gp", ".mxf", ".dv", ".gif", ".ogv",
                                               ".insv"};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < G_N_ELEMENTS(suffixes); i++)
        if (g_ascii_strcasecmp(dot, suffixes[i]) == 0)
            return TRUE;
    return FALSE;
}

static int by_name(gconstpointer a, gconstpointer b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void add_folder(GPtrArray *inputs, const char *folder)
{
    GDir *dir = g_dir_open(folder, 0, NULL);
    GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
    const char *name;
    while (dir && (name = g_dir_read_name(dir)))
        g_ptr_array_add(names, g_build_filename(folder, name, NULL));
    g_clear_pointer(&dir, g_dir_close);
    g_ptr_array_sort(names, by_name);
    for (guint i = 0; i < names->len; i++) {
        const char *path = names->pdata[i];
        if (g_file_test(path, G_FILE_TEST_IS_DIR) && !g_file_test(path, G_FILE_TEST_IS_SYMLINK))
            add_folder(inputs, path);
        else if (looks_like_video(path))
            g_ptr_array_add(inputs, g_strdup(path));
    }
    g_ptr_array_unref(names);
}

static GPtrArray *find_inputs(const Options *options)
{
    GPtrArray *inputs = g_ptr_array_new_with_free_func(g_free);
    for (int i = 0; i < options->input_count; i++)
        if (g_file_test(options->inputs[i], G_FILE_TEST_IS_DIR))
            add_folder(inputs, options->inputs[i]);
        else
            g_ptr_array_add(inputs, g_strdup(options->inputs[i]));
    return inputs;
}

/* ---- the batch ---- */

typedef struct Batch {
    const Options *options;
    GMainLoop *loop;
    GPtrArray *inputs;       /* names */
    GPtrArray *arguments;    /* of each process, before the names */
    GHashTable *outputs;     /* canonical name of the output -> its input */
    GHashTable *running;     /* process -> its input */
    GPtrArray *failed;       /* names */
    guint next;              /* in inputs */
    int done, damaged, skipped;
    gint64 started_us;
    gboolean stopping;
} Batch;

/* In the new process. Its terminal's Ctrl-C comes to this program alone, which passes it on; and it ends with it. */
static void set_up_child(gpointer data)
{
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    signal(SIGPIPE, SIG_DFL);
}

static void say_batch_progress(const Batch *batch)
{
    static gint64 last_us;
    const gint64 now = g_get_monotonic_time();
    const int finished = batch->done + batch->damaged + (int)batch->failed->len;
    if (now - last_us < 5 * G_USEC_PER_SEC || batch->options->json)
        return;
    last_us = now;
    say_note("%d of %u files done, %u failed, %d skipped, %.1f files/min", finished, batch->inputs->len,
             batch->failed->len,
             batch->skipped, 60.0 * finished / MAX(1e-3, (double)(now - batch->started_us) / G_USEC_PER_SEC));
}

static void fail(Batch *batch, const char *in, const char *format, ...) G_GNUC_PRINTF(3, 4);
static void fail(Batch *batch, const char *in, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *reason = g_strdup_vprintf(format, args), *shown = printable(in), *text = g_strdup_printf("%s: %s", shown,
                                                                                                   reason);
    va_end(args);
    say_error(text);
    g_ptr_array_add(batch->failed, g_strdup(in));
    g_free(text);
    g_free(shown);
    g_free(reason);
}

static void start_more(Batch *batch);

static void on_process_end(GPid pid, gint status, gpointer data)
{
    Batch *batch = data;
    char *in = g_strdup(g_hash_table_lookup(batch->running, GINT_TO_POINTER(pid)));
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : EXIT_SIGNAL;
    g_hash_table_remove(batch->running, GINT_TO_POINTER(pid));
    g_spawn_close_pid(pid);
    if (WIFSIGNALED(status) && !batch->stopping)
        fail(batch, in, "its process was ended by signal %d", WTERMSIG(status));
    else if (code == EXIT_DAMAGED)
        batch->damaged++;
    else if (code == EXIT_DONE)
        batch->done++;
    else if (!batch->stopping)
        g_ptr_array_add(batch->failed, g_strdup(in)); /* the process has said why */
    g_free(in);
    say_batch_progress(batch);
    start_more(batch);
}

static gboolean spawn(Batch *batch, const char *in, const char *out, GError **error)
{
    GPtrArray *argv = g_ptr_array_new();
    GPid pid;
    for (guint i = 0; i < batch->arguments->len; i++)
        g_ptr_array_add(argv, batch->arguments->pdata[i]);
    char *last[] = {(char *)"-o", (char *)out, (char *)"--", (char *)in, NULL};
    for (size_t i = 0; i < G_N_ELEMENTS(last); i++)
        g_ptr_array_add(argv, last[i]);
    const gboolean ok = g_spawn_async(NULL, (char **)argv->pdata, NULL,
                                      G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_SEARCH_PATH, set_up_child, NULL,
                                      &pid, error);
    g_ptr_array_unref(argv);
    if (ok) {
        g_hash_table_insert(batch->running, GINT_TO_POINTER(pid), g_strdup(in));
        g_child_watch_add(pid, on_process_end, batch);
    }
    return ok;
}

/* Starts the process of a file, unless there is nothing to do. */
static void start(Batch *batch, const char *in)
{
    GError *error = NULL;
    char *out = batch_output_name(batch->options, in);
    char *in_key = g_canonicalize_filename(in, NULL), *out_key = g_canonicalize_filename(out, NULL);
    const char *other = g_hash_table_lookup(batch->outputs, out_key);
    if (g_hash_table_contains(batch->outputs, in_key)) /* a batch that is run again finds its own outputs */
        batch->skipped++;
    else if (other != in)
        fail(batch, in, "its output would replace that of %s: use another --out-dir", other);
    else if (batch->options->skip_existing && g_file_test(out, G_FILE_TEST_EXISTS))
        batch->skipped++;
    else if (!spawn(batch, in, out, &error)) {
        fail(batch, in, "%s", error->message);
        g_clear_error(&error);
    }
    g_free(out_key);
    g_free(in_key);
    g_free(out);
}

static void start_more(Batch *batch)
{
    const guint jobs = batch->options->jobs ? (guint)batch->options->jobs : (g_get_num_processors() + 1) / 2;
    while (!batch->stopping && batch->next < batch->inputs->len && g_hash_table_size(batch->running) < jobs)
        start(batch, batch->inputs->pdata[batch->next++]);
    if (g_hash_table_size(batch->running) == 0)
        g_main_loop_quit(batch->loop);
}

static gboolean start_first(gpointer data)
{
    start_more(data);
    return G_SOURCE_REMOVE;
}

static void on_interrupt(void *cookie, gboolean at_once)
{
    Batch *batch = cookie;
    GHashTableIter iter;
    gpointer pid;
    batch->stopping = TRUE;
    g_hash_table_iter_init(&iter, batch->running);
    while (g_hash_table_iter_next(&iter, &pid, NULL))
        kill(GPOINTER_TO_INT(pid), at_once ? SIGTERM : SIGINT);
}

static void say_end(const Batch *batch)
{
    GString *json = g_string_new(NULL), *text = g_string_new(NULL);
    g_string_printf(json, "{\"type\": \"batch\", \"files\": %u, \"done\": %d, \"damaged\": %d, "
                    "\"skipped\": %d, \"failed\": [",
                    batch->inputs->len, batch->done, batch->damaged, batch->skipped);
    for (guint i = 0; i < batch->failed->len; i++) {
        char *shown = printable(batch->failed->pdata[i]), *quoted = say_json_string(shown);
        g_string_append_printf(json, "%s%s", i ? ", " : "", quoted);
        g_string_append_printf(text, "%s%s", i ? ", " : ": ", shown);
        g_free(quoted);
        g_free(shown);
    }
    g_string_append(json, "]}");
    say_result(json->str, NULL);
    if (!batch->options->json) {
        GString *counts = g_string_new(NULL);
        g_string_printf(counts, "%u files: %d done", batch->inputs->len, batch->done);
        if (batch->damaged)
            g_string_append_printf(counts, ", %d damaged but done", batch->damaged);
        if (batch->skipped)
            g_string_append_printf(counts, ", %d skipped", batch->skipped);
        say_note("%s, %u failed%s", counts->str, batch->failed->len, text->str);
        g_string_free(counts, TRUE);
    }
    g_string_free(json, TRUE);
    g_string_free(text, TRUE);
}

/* Which output belongs to which input. The first of two inputs with the same output has it. */
static GHashTable *map_outputs(const Options *options, const GPtrArray *inputs)
{
    GHashTable *outputs = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
    for (guint i = 0; i < inputs->len; i++) {
        char *out = batch_output_name(options, inputs->pdata[i]), *key = g_canonicalize_filename(out, NULL);
        if (g_hash_table_contains(outputs, key))
            g_free(key);
        else
            g_hash_table_insert(outputs, key, inputs->pdata[i]);
        g_free(out);
    }
    return outputs;
}

int batch_run(const Options *options)
{
    Batch batch = {.options = options, .inputs = find_inputs(options), .arguments = options_for_one_file(options),
                   .running = g_hash_table_new_full(NULL, NULL, NULL, g_free),
                   .failed = g_ptr_array_new_with_free_func(g_free), .started_us = g_get_monotonic_time()};
    char *program = g_file_read_link(THIS_PROGRAM, NULL);
    g_ptr_array_insert(batch.arguments, 0, program ? program : g_strdup("l1l2stab"));
    if (!options->json && !options->verbose && !options->quiet) /* the processes only say what goes wrong */
        g_ptr_array_add(batch.arguments, g_strdup("--quiet"));
    batch.outputs = map_outputs(options, batch.inputs);
    batch.loop = g_main_loop_new(NULL, FALSE);
    interrupt_watch(on_interrupt, &batch);
    g_idle_add(start_first, &batch);
    g_main_loop_run(batch.loop);
    interrupt_unwatch();
    say_end(&batch);

    const int code = interrupt_signal()  ? EXIT_SIGNAL + interrupt_signal()
                     : batch.failed->len ? EXIT_BATCH
                     : batch.damaged     ? EXIT_DAMAGED
                                         : EXIT_DONE;
    g_main_loop_unref(batch.loop);
    g_hash_table_unref(batch.running);
    g_hash_table_unref(batch.outputs);
    g_ptr_array_unref(batch.arguments);
    g_ptr_array_unref(batch.failed);
    g_ptr_array_unref(batch.inputs);
    return code;
}
