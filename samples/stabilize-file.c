/* SPDX-License-Identifier: MIT */
/*
 * A video file in, a stabilized video file out: how an application embeds the l1l2stab element.
 *
 *     stabilize-file [--lambda=0.5 --crop-ratio=0.9 ...] IN OUT.mp4
 *
 *     uridecodebin ! queue ! ... ! videoconvert ! l1l2stab ! queue ! x264enc ! h264parse ! mp4mux ! filesink
 *                  ! (audio, if any) audioconvert ! audioresample ! avenc_aac ! queue ! mp4mux
 *
 * - The stabilizer holds a window of frames back, so the muxer needs that much of the other streams too: the audio's
 *   queue is after the encoder, where it costs little, and has no limit. With the default limit of one second the
 *   pipeline would stand still for ever.
 * - AAC audio is taken over as it is; anything else is decoded and encoded anew.
 * - The options are the element's own properties, so this file knows none of their names, ranges and defaults.
 * - OUT appears only when it is complete: until then it is OUT.part, which is removed if anything goes wrong.
 */
#include <glib-unix.h>
#include <glib/gstdio.h>
#include <gst/gst.h>
#include <stdlib.h>
#include <unistd.h>

/* Where the decoder may stop: AAC as it lies in MP4 and Matroska needs no decoding. */
#define DECODED_CAPS "video/x-raw(ANY); audio/mpeg, mpegversion=4, stream-format=raw; audio/x-raw(ANY)"

/*
 * 4:2:0 at 8 bits is the H.264 that plays everywhere. videoflip turns what a phone filmed upright: the muxers drop the
 * tag that tells players to. Both it and deinterlace pass on untouched what does not concern them, and so does
 * capssetter, see drop_absurd_rate().
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
    char *in, *out;
    GMainLoop *loop;
    GstElement *pipeline;
    GstElement *source, *video, *stabilizer, *mux; /* the pipeline's own */
    gboolean has_video, has_audio;
    gboolean failed;
    gboolean terminal;       /* stderr is one: the progress line is overwritten */
    gint64 started_us;
    gint frames, reached_ms; /* given out; atomic: set in a streaming thread */
} App;

/* One line on stderr, and the end. For the main thread. */
static void G_GNUC_PRINTF(2, 3) fail(App *app, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *text = g_strdelimit(g_strdup_vprintf(format, args), "\n", ' ');
    va_end(args);
    if (!app->failed)
        g_printerr("%sstabilize-file: %s\n", app->terminal && app->frames ? "\n" : "", text);
    g_free(text);
    app->failed = TRUE;
    if (app->loop)
        g_main_loop_quit(app->loop);
}

/* Every property that the stabilizer adds to its base classes becomes an option of that name. */
static gboolean set_property_option(const char *option, const char *text, gpointer data, GError **error)
{
    App *app = data;
    const char *name = option + strlen("--");
    GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(app->stabilizer), name);
    GValue value = G_VALUE_INIT;

    g_value_init(&value, spec->value_type);
    gboolean ok = gst_value_deserialize_with_pspec(&value, text, spec);
    if (!ok)
        g_set_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE, "%s: '%s' is not a value for it", option, text);
    else if (g_param_value_validate(spec, &value)) {
        ok = FALSE;
        g_set_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
                    "%s: %s is out of range (gst-inspect-1.0 l1l2stab has the ranges)", option, text);
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
            {NULL},
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
        g_printerr("usage: stabilize-file [--lambda=0.5 ...] IN OUT.mp4     (--help has all options)\n");
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

/* The muxer that fits OUT's name; NULL if none does. */
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
                          ("the audio cannot be joined to the output: %s", error ? error->message : "its format"),
                          (NULL));
    g_clear_error(&error);
}

/* Some files call the clock of their timestamps, such as 90000, their frame rate. An encoder that believes it gives a
 * frame next to no bits; without a rate it goes by the timestamps. */
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
 * A decoded stream: the first of video and of audio are used. No data flows before all streams are known. This runs in
 * a streaming thread, so it reports by way of the bus.
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
        GST_ELEMENT_ERROR(app->pipeline, STREAM, DECODE, ("there is no video in it that can be decoded here"), (NULL));
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

    /* decodebin (1.22) now and then loses a demuxer's error that comes before it has the demuxer in place. */
    if (!app->has_video && !app->has_audio && seconds > FIND_STREAMS_S) {
        fail(app, "%s: no stream was found in it: is it complete?", app->in);
        return G_SOURCE_REMOVE;
    }
    if (frames > 0 && gst_element_query_duration(app->source, GST_FORMAT_TIME, &duration) && duration > 0) {
        const double reached = (double)g_atomic_int_get(&app->reached_ms) * GST_MSECOND / (double)duration;
        g_snprintf(percent, sizeof percent, "%3.0f %%, ", MIN(100.0, 100.0 * reached));
    }
    g_printerr("%s%s%d frames, %.1f frames/s%s", app->terminal ? "\r" : "", percent, frames,
               seconds > 0 ? frames / seconds : 0.0, app->terminal ? "   " : "\n");
    return G_SOURCE_CONTINUE;
}

/* A named element of the pipeline, which goes on owning it. */
static GstElement *element_named(App *app, const char *name)
{
    GstElement *element = gst_bin_get_by_name(GST_BIN(app->pipeline), name);
    gst_object_unref(element);
    return element;
}

/* All but the muxer and the file, whose kind the arguments say. */
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

static gboolean build_ends(App *app, const char *part, const char *muxer)
{
    char *uri = gst_filename_to_uri(app->in, NULL);
    GstCaps *caps = gst_caps_from_string(DECODED_CAPS);
    g_object_set(app->source, "uri", uri, "caps", caps, NULL);
    g_signal_connect(app->source, "pad-added", G_CALLBACK(on_pad_added), app);
    g_signal_connect(app->source, "no-more-pads", G_CALLBACK(on_no_more_pads), app);
    gst_caps_unref(caps);
    g_free(uri);

    GstElement *file = gst_element_factory_make("filesink", NULL);
    app->mux = gst_element_factory_make(muxer, NULL);
    if (!app->mux || !file) {
        fail(app, "there is no %s: is gstreamer1.0-plugins-good installed?", muxer);
        return FALSE;
    }
    g_object_set(file, "location", part, NULL);
    gst_bin_add_many(GST_BIN(app->pipeline), app->mux, file, NULL);
    return gst_element_link_pads(element_named(app, "encoded"), "src", app->mux, "video_%u") &&
           gst_element_link(app->mux, file);
}

static void run(App *app)
{
    GstBus *bus = gst_element_get_bus(app->pipeline);
    app->loop = g_main_loop_new(NULL, FALSE);
    app->started_us = g_get_monotonic_time();
    gst_bus_add_watch(bus, on_message, app);
    g_unix_signal_add(SIGINT, on_signal, app);
    g_unix_signal_add(SIGTERM, on_signal, app);
    g_timeout_add(app->terminal ? PROGRESS_TERMINAL_MS : PROGRESS_LOG_MS, show_progress, app);

    gst_element_set_state(app->pipeline, GST_STATE_PLAYING);
    g_main_loop_run(app->loop);
    if (!app->failed) {
        g_atomic_int_set(&app->reached_ms, G_MAXINT); /* all of it */
        show_progress(app);
        g_printerr(app->terminal ? "\n" : "");
    }
    gst_element_set_state(app->pipeline, GST_STATE_NULL);
    gst_bus_remove_watch(bus);
    gst_object_unref(bus);
    g_main_loop_unref(app->loop);
}

/* Checks the arguments; NULL if they are fine. To be freed. */
static char *objection(const App *app, const char *muxer)
{
    if (!g_file_test(app->in, G_FILE_TEST_EXISTS))
        return g_strdup_printf("%s: there is no such file", app->in);
    if (g_file_test(app->in, G_FILE_TEST_IS_DIR) || g_access(app->in, R_OK) != 0)
        return g_strdup_printf("%s: cannot be read", app->in);
    if (same_file(app->in, app->out))
        return g_strdup_printf("%s: is the input too, and will not be overwritten", app->out);
    if (!muxer)
        return g_strdup_printf("%s: the name has to end with .mp4, .m4v, .mov or .mkv", app->out);
    return NULL;
}

static void stabilize(App *app)
{
    const char *muxer = muxer_for(app->out);
    char *reason = objection(app, muxer);
    if (reason) {
        fail(app, "%s", reason);
        g_free(reason);
        return;
    }

    char *part = g_strconcat(app->out, ".part", NULL);
    if (build_ends(app, part, muxer))
        run(app);
    if (app->failed)
        g_unlink(part);
    else if (g_rename(part, app->out) != 0)
        fail(app, "%s: cannot be written", app->out);
    g_free(part);
}

int main(int argc, char **argv)
{
    App app = {.terminal = isatty(STDERR_FILENO)};
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
