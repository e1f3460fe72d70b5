/* SPDX-License-Identifier: MIT */
/*
 * Reads a video file and writes a stabilized one. Shows how an application uses the l1l2stab element.
 *
 *     stabilize-file [--lambda=0.5 --crop-ratio=0.9 ...] IN OUT.mp4
 *
 *     uridecodebin ! queue ! ... ! videoconvert ! l1l2stab ! queue ! x264enc ! h264parse ! mp4mux ! fdsink
 *                  ! (audio, if any) audioconvert ! audioresample ! avenc_aac ! queue ! mp4mux
 *
 * - The stabilizer delays the video by its window, so the muxer has to wait, and the audio has to be stored meanwhile.
 *   The audio's queue therefore has no limit. It is behind the encoder, where the data are small. With the default
 *   limit of one second the pipeline would stop forever.
 * - AAC audio is copied. Any other audio is decoded and encoded again.
 * - The options are the properties of the element. This file does not know their names, ranges or defaults.
 * - The output is written to a temporary file in the folder of OUT, and renamed to OUT when it is complete. The
 *   temporary file is removed if anything goes wrong, or if the program is interrupted.
 */
#include <errno.h>
#include <fcntl.h>
#include <glib-unix.h>
#include <glib/gstdio.h>
#include <gst/gst.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* The decoder stops at these formats. AAC as MP4 and Matroska store it is not decoded. */
#define DECODED_CAPS "video/x-raw(ANY); audio/mpeg, mpegversion=4, stream-format=raw; audio/x-raw(ANY)"

/*
 * 4:2:0 with 8 bits is the H.264 format that every player supports. videoflip rotates what a phone filmed upright,
 * because the muxers drop the tag that asks the player to do it. videoflip and deinterlace change nothing in a video
 * that does not need them. For capssetter see drop_absurd_rate().
 */
#define VIDEO \
    "uridecodebin name=source  queue name=video ! capssetter name=rate ! deinterlace ! videoconvert ! " \
    "video/x-raw, format=(string){ I420, NV12 } ! videoflip video-direction=auto ! l1l2stab name=stabilizer ! " \
    "queue ! x264enc pass=qual quantizer=20 speed-preset=faster ! h264parse name=encoded"
#define AUDIO_AAC "queue max-size-time=0 max-size-buffers=0 max-size-bytes=0"
#define AUDIO_RAW "audioconvert ! audioresample ! avenc_aac ! " AUDIO_AAC

#define EXIT_USAGE 2
#define MAX_FRAME_RATE 1000 /* Hz */
#define PROGRESS_TERMINAL_MS 500
#define PROGRESS_LOG_MS 10000
#define FIND_STREAMS_S 19

typedef struct App {
    const char *in, *out;
    int in_fd;               /* of an input that is no regular file, or -1 */
    char *part;              /* the temporary file's name */
    int part_fd;
    GMainLoop *loop;         /* NULL while it does not run */
    GstElement *pipeline;
    GstElement *source, *video, *stabilizer, *mux; /* the pipeline's own */
    gboolean has_video, has_audio;
    gboolean failed;
    gboolean terminal;       /* stderr is a terminal: the progress line is overwritten */
    gint64 started_us;
    gint frames, reached_ms; /* count and timestamp of the emitted frames; atomic: set in a streaming thread */
} App;

/* Prints one line to stderr and ends the main loop. Only for the main thread. */
static void G_GNUC_PRINTF(2, 3) fail(App *app, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *text = g_strdelimit(g_strdup_vprintf(format, args), "\r\n", ' ');
    va_end(args);
    if (!app->failed)
        g_printerr("%sstabilize-file: %s\n", app->terminal && app->frames ? "\n" : "", text);
    g_free(text);
    app->failed = TRUE;
    if (app->loop)
        g_main_loop_quit(app->loop);
}

/* Sets the property that has the option's name. */
static gboolean set_property_option(const char *option, const char *text, gpointer data, GError **error)
{
    App *app = data;
    const char *name = option + strlen("--");
    GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(app->stabilizer), name);
    GValue value = G_VALUE_INIT;

    g_value_init(&value, spec->value_type);
    gboolean ok = gst_value_deserialize_with_pspec(&value, text, spec);
    if (!ok)
        g_set_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE, "%s: '%s' is not a valid value", option, text);
    else if (g_param_value_validate(spec, &value)) {
        ok = FALSE;
        g_set_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
                    "%s: %s is out of range (gst-inspect-1.0 l1l2stab lists the ranges)", option, text);
    } else
        g_object_set_property(G_OBJECT(app->stabilizer), name, &value);
    g_value_unset(&value);
    return ok;
}

static void add_property_options(App *app, GOptionGroup *group)
{
    guint count = 0;
    GParamSpec **specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(app->stabilizer), &count);

    for (guint i = 0; i < count; i++) {
        const GParamSpec *spec = specs[i];
        if (spec->owner_type != G_OBJECT_TYPE(app->stabilizer) || !(spec->flags & G_PARAM_WRITABLE))
            continue;
        GOptionEntry entry[2] = {
            {spec->name, 0, 0, G_OPTION_ARG_CALLBACK, (gpointer)set_property_option,
             g_param_spec_get_blurb((GParamSpec *)spec), g_type_name(spec->value_type)},
            G_OPTION_ENTRY_NULL,
        };
        g_option_group_add_entries(group, entry);
    }
    g_free(specs);
}

static gboolean parse_arguments(App *app, int *argc, char ***argv)
{
    GOptionContext *context = g_option_context_new("IN OUT.{mp4,m4v,mov,mkv}");
    GOptionGroup *group = g_option_group_new("l1l2stab", "", "", app, NULL);
    GError *error = NULL;

    g_option_context_set_summary(context, "Stabilizes a video file. The options are the element's properties.");
    add_property_options(app, group);
    g_option_context_set_main_group(context, group);
    gboolean ok = g_option_context_parse(context, argc, argv, &error);
    if (!ok) {
        g_printerr("stabilize-file: %s\n", error->message);
        g_clear_error(&error);
    } else if (*argc != 3) {
        ok = FALSE;
        g_printerr("usage: stabilize-file [--lambda=0.5 ...] IN OUT.mp4     (--help lists all options)\n");
    } else {
        app->in = (*argv)[1];
        app->out = (*argv)[2];
    }
    g_option_context_free(context);
    return ok;
}

static gboolean same_file(const char *a, const char *b)
{
    GStatBuf sa, sb;
    return g_stat(a, &sa) == 0 && g_stat(b, &sb) == 0 && sa.st_dev == sb.st_dev && sa.st_ino == sb.st_ino;
}

/* Returns the muxer for OUT's suffix, or NULL if there is none. */
static const char *muxer_for(const char *out)
{
    static const char *const known[][2] = {
        {".mp4", "mp4mux"}, {".m4v", "mp4mux"}, {".mov", "qtmux"}, {".mkv", "matroskamux"}};
    char *name = g_ascii_strdown(out, -1);
    const char *muxer = NULL;
    for (size_t i = 0; i < G_N_ELEMENTS(known) && !muxer; i++)
        muxer = g_str_has_suffix(name, known[i][0]) ? known[i][1] : NULL;
    g_free(name);
    return muxer;
}

static GstPadProbeReturn count_frame(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    App *app = data;
    const GstClockTime pts = GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info));
    (void)pad;
    g_atomic_int_inc(&app->frames);
    if (GST_CLOCK_TIME_IS_VALID(pts))
        g_atomic_int_set(&app->reached_ms, (gint)(pts / GST_MSECOND));
    return GST_PAD_PROBE_OK;
}

static gboolean link_to_sink(GstPad *pad, GstElement *element)
{
    GstPad *sink = gst_element_get_static_pad(element, "sink");
    const gboolean ok = gst_pad_link(pad, sink) == GST_PAD_LINK_OK;
    gst_object_unref(sink);
    return ok;
}

static void link_audio(App *app, GstPad *pad, gboolean raw)
{
    GError *error = NULL;
    GstElement *audio = gst_parse_bin_from_description_full(raw ? AUDIO_RAW : AUDIO_AAC, TRUE, NULL,
                                                            GST_PARSE_FLAG_FATAL_ERRORS, &error);
    if (audio)
        gst_bin_add(GST_BIN(app->pipeline), audio);
    if (audio && gst_element_link_pads(audio, "src", app->mux, "audio_%u") && link_to_sink(pad, audio))
        gst_element_sync_state_with_parent(audio);
    else
        GST_ELEMENT_ERROR(app->pipeline, STREAM, FORMAT,
                          ("the audio cannot be written: %s", error ? error->message : "its format is not supported"),
                          (NULL));
    g_clear_error(&error);
}

/* Some files state the clock of their timestamps, such as 90000, as their frame rate. With that rate the encoder gives
 * each frame almost no bits. Without a rate it uses the timestamps. */
static void drop_absurd_rate(App *app, const GstCaps *caps)
{
    int numerator, denominator;
    if (!gst_structure_get_fraction(gst_caps_get_structure(caps, 0), "framerate", &numerator, &denominator) ||
        numerator <= MAX_FRAME_RATE * denominator)
        return;
    GstElement *rate = gst_bin_get_by_name(GST_BIN(app->pipeline), "rate");
    GstCaps *variable = gst_caps_from_string("video/x-raw, framerate=(fraction)0/1");
    g_object_set(rate, "caps", variable, NULL);
    gst_caps_unref(variable);
    gst_object_unref(rate);
}

/*
 * Links a decoded stream. The first video stream and the first audio stream are used. This runs in a streaming thread,
 * so it reports errors on the bus.
 */
static void on_pad_added(GstElement *source, GstPad *pad, App *app)
{
    (void)source;
    GstCaps *caps = gst_pad_get_current_caps(pad);
    if (!caps)
        caps = gst_pad_query_caps(pad, NULL);
    const char *type = gst_structure_get_name(gst_caps_get_structure(caps, 0));

    if (g_str_has_prefix(type, "video/") && !app->has_video) {
        app->has_video = TRUE;
        drop_absurd_rate(app, caps);
        if (!link_to_sink(pad, app->video))
            GST_ELEMENT_ERROR(app->pipeline, STREAM, FORMAT, ("the video's format is not supported"), (NULL));
    } else if (g_str_has_prefix(type, "audio/") && !app->has_audio) {
        app->has_audio = TRUE;
        link_audio(app, pad, g_str_equal(type, "audio/x-raw"));
    }
    gst_caps_unref(caps);
}

static void on_no_more_pads(GstElement *source, App *app)
{
    (void)source;
    if (!app->has_video)
        GST_ELEMENT_ERROR(app->pipeline, STREAM, DECODE, ("it has no video that the installed decoders support"),
                          (NULL));
}

static gboolean on_message(GstBus *bus, GstMessage *message, gpointer data)
{
    App *app = data;
    (void)bus;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS)
        g_main_loop_quit(app->loop);
    else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
        GError *error = NULL;
        gst_message_parse_error(message, &error, NULL);
        fail(app, "%s: %s", app->in, error->message);
        g_clear_error(&error);
    }
    return G_SOURCE_CONTINUE;
}

static gboolean on_signal(gpointer data)
{
    fail(data, "interrupted");
    return G_SOURCE_CONTINUE;
}

static gboolean show_progress(gpointer data)
{
    App *app = data;
    gint64 duration = 0;
    const int frames = g_atomic_int_get(&app->frames);
    const double seconds = (double)(g_get_monotonic_time() - app->started_us) / G_USEC_PER_SEC;
    char percent[16] = "";

    /* decodebin (1.22) sometimes loses an error that a demuxer posts before it is linked. */
    if (!app->has_video && !app->has_audio && seconds > FIND_STREAMS_S) {
        fail(app, "%s: no stream was found in it. Is it complete?", app->in);
        return G_SOURCE_REMOVE;
    }
    if (frames == 0)
        return G_SOURCE_CONTINUE;
    if (gst_element_query_duration(app->source, GST_FORMAT_TIME, &duration) && duration > 0) {
        const double reached = (double)g_atomic_int_get(&app->reached_ms) * GST_MSECOND / (double)duration;
        g_snprintf(percent, sizeof percent, "%3.0f %%, ", MIN(100.0, 100.0 * reached));
    }
    g_printerr("%s%s%d frames, %.1f frames/s%s", app->terminal ? "\r" : "", percent, frames,
               seconds > 0 ? frames / seconds : 0.0, app->terminal ? "   " : "\n");
    return G_SOURCE_CONTINUE;
}

/* Returns a named element of the pipeline. The pipeline owns it. */
static GstElement *element_named(App *app, const char *name)
{
    GstElement *element = gst_bin_get_by_name(GST_BIN(app->pipeline), name);
    gst_object_unref(element);
    return element;
}

/* Builds the pipeline except for the muxer and the file, which depend on the arguments. */
static gboolean build_video(App *app)
{
    GError *error = NULL;
    app->pipeline = gst_parse_launch_full(VIDEO, NULL, GST_PARSE_FLAG_FATAL_ERRORS, &error);
    if (!app->pipeline) {
        fail(app, "%s (is GST_PLUGIN_PATH set, and are the packages in .ci/packages installed?)", error->message);
        g_clear_error(&error);
        return FALSE;
    }
    app->source = element_named(app, "source");
    app->video = element_named(app, "video");
    app->stabilizer = element_named(app, "stabilizer");

    GstPad *pad = gst_element_get_static_pad(app->stabilizer, "src");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, count_frame, app, NULL);
    gst_object_unref(pad);
    return TRUE;
}

/* A regular file is opened by its name. Anything else, such as a FIFO, has been opened already. */
static char *input_uri(const App *app)
{
    return app->in_fd < 0 ? gst_filename_to_uri(app->in, NULL) : g_strdup_printf("fd://%d", app->in_fd);
}

static gboolean build_ends(App *app, const char *muxer)
{
    char *uri = input_uri(app);
    GstCaps *caps = gst_caps_from_string(DECODED_CAPS);
    g_object_set(app->source, "uri", uri, "caps", caps, NULL);
    g_signal_connect(app->source, "pad-added", G_CALLBACK(on_pad_added), app);
    g_signal_connect(app->source, "no-more-pads", G_CALLBACK(on_no_more_pads), app);
    gst_caps_unref(caps);
    g_free(uri);

    GstElement *file = gst_element_factory_make("fdsink", NULL);
    app->mux = gst_element_factory_make(muxer, NULL);
    if (!app->mux || !file) {
        fail(app, "GStreamer has no element %s. Is gstreamer1.0-plugins-good installed?", muxer);
        return FALSE;
    }
    g_object_set(file, "fd", app->part_fd, NULL);
    gst_bin_add_many(GST_BIN(app->pipeline), app->mux, file, NULL);
    if (!gst_element_link_pads(element_named(app, "encoded"), "src", app->mux, "video_%u") ||
        !gst_element_link(app->mux, file)) {
        fail(app, "the video cannot be linked to %s", muxer);
        return FALSE;
    }
    return TRUE;
}

static void run(App *app)
{
    GstBus *bus = gst_element_get_bus(app->pipeline);
    app->loop = g_main_loop_new(NULL, FALSE);
    app->started_us = g_get_monotonic_time();
    gst_bus_add_watch(bus, on_message, app);
    g_timeout_add(app->terminal ? PROGRESS_TERMINAL_MS : PROGRESS_LOG_MS, show_progress, app);

    gst_element_set_state(app->pipeline, GST_STATE_PLAYING);
    g_main_loop_run(app->loop);
    if (!app->failed) {
        g_atomic_int_set(&app->reached_ms, G_MAXINT); /* 100 % */
        show_progress(app);
        g_printerr(app->terminal ? "\n" : "");
    }
    gst_element_set_state(app->pipeline, GST_STATE_NULL);
    gst_bus_remove_watch(bus);
    gst_object_unref(bus);
    g_clear_pointer(&app->loop, g_main_loop_unref);
}

/* Leaves a signal alone that the parent process ignores: nohup does so with SIGHUP. */
static void handle_signal(App *app, int number)
{
    struct sigaction old;
    if (sigaction(number, NULL, &old) != 0 || old.sa_handler != SIG_IGN)
        g_unix_signal_add(number, on_signal, app);
}

/* Each signal that would end the program removes the temporary file first. SIGPIPE is ignored: the output is complete
 * even if nobody reads the progress any more. */
static void handle_signals(App *app)
{
    handle_signal(app, SIGINT);
    handle_signal(app, SIGTERM);
    handle_signal(app, SIGHUP);
    signal(SIGPIPE, SIG_IGN);
}

/* Checks the arguments. Returns what is wrong, to be freed, or NULL. */
static char *check_arguments(const App *app, const char *muxer)
{
    if (!g_file_test(app->in, G_FILE_TEST_EXISTS))
        return g_strdup_printf("%s: no such file", app->in);
    if (g_file_test(app->in, G_FILE_TEST_IS_DIR) || g_access(app->in, R_OK) != 0)
        return g_strdup_printf("%s: cannot be read", app->in);
    if (same_file(app->in, app->out))
        return g_strdup_printf("%s: is the input too, and will not be overwritten", app->out);
    if (!muxer)
        return g_strdup_printf("%s: the name has to end with .mp4, .m4v, .mov or .mkv", app->out);
    if (g_file_test(app->out, G_FILE_TEST_EXISTS) && !g_file_test(app->out, G_FILE_TEST_IS_REGULAR))
        return g_strdup_printf("%s: exists and is not a regular file", app->out);
    return NULL;
}

/*
 * Opens an input that is no regular file, such as a FIFO. GStreamer's filesrc would wait in open() and read(), where it
 * cannot be interrupted. Its fdsrc waits in poll(), where it can.
 */
static gboolean open_input(App *app)
{
    if (g_file_test(app->in, G_FILE_TEST_IS_REGULAR))
        return TRUE;
    app->in_fd = g_open(app->in, O_RDONLY | O_NONBLOCK | O_CLOEXEC, 0);
    if (app->in_fd >= 0)
        return TRUE;
    fail(app, "%s: %s", app->in, g_strerror(errno));
    return FALSE;
}

/* Creates the temporary file beside OUT, so that it can be renamed. It never opens a file that exists. */
static gboolean create_part(App *app)
{
    char *folder = g_path_get_dirname(app->out);
    app->part = g_build_filename(folder, ".stabilize-file-XXXXXX", NULL);
    g_free(folder);
    app->part_fd = g_mkstemp_full(app->part, O_RDWR | O_CLOEXEC, 0666);
    if (app->part_fd >= 0)
        return TRUE;
    fail(app, "%s: cannot be written: %s", app->out, g_strerror(errno));
    return FALSE;
}

/* Gives the temporary file its final name, or removes it. */
static void finish_part(App *app)
{
    if (app->part_fd >= 0) {
        const gboolean closed = close(app->part_fd) == 0;
        if (!app->failed && (!closed || g_rename(app->part, app->out) != 0))
            fail(app, "%s: cannot be written: %s", app->out, g_strerror(errno));
        if (app->failed)
            g_unlink(app->part);
    }
    g_free(app->part);
}

static void stabilize(App *app)
{
    const char *muxer = muxer_for(app->out);
    char *fault = check_arguments(app, muxer);
    if (fault) {
        fail(app, "%s", fault);
        g_free(fault);
        return;
    }

    handle_signals(app);
    if (open_input(app) && create_part(app) && build_ends(app, muxer))
        run(app);
    finish_part(app);
    if (app->in_fd >= 0)
        close(app->in_fd);
}

int main(int argc, char **argv)
{
    App app = {.in_fd = -1, .part_fd = -1, .terminal = isatty(STDERR_FILENO)};
    int status = EXIT_USAGE;

    gst_init(NULL, NULL);
    if (!build_video(&app))
        return EXIT_FAILURE;
    if (parse_arguments(&app, &argc, &argv)) {
        stabilize(&app);
        status = app.failed ? EXIT_FAILURE : EXIT_SUCCESS;
    }
    gst_object_unref(app.pipeline);
    return status;
}
