/* SPDX-License-Identifier: MIT */
/*
 * Measures how much a video shakes. GStreamer decodes, and the library measures the motion without rendering.
 *
 *     measure-shake [--picture=OUT.png] [--motion=OUT.txt] A [B]
 *
 *     uridecodebin ! videoconvert ! videoflip ! appsink -> l1l2stab_push(), l1l2stab_pull(s, NULL, &info)
 *
 * The shake is the root mean square of the second difference of the frame's corners: the distance of a corner from the
 * place that its motion in the two frames before predicts. It is in pixels of a picture scaled to a width of 640. A
 * steady pan has no shake. Nothing is measured across a cut.
 *
 * The picture is a slit scan: each column is the middle column of one frame, and time runs to the right. A still camera
 * and a steady pan give smooth lines, and shake shows as ripples. A is above, B is below.
 */
#include <glib/gstdio.h>
#include <gst/app/gstappsink.h>
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <gst/video/video.h>
#include <l1l2stab/l1l2stab.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXIT_USAGE 2
#define REFERENCE_WIDTH 640.0
#define WINDOW 16 /* frames: the measured motion does not depend on it, the memory does */
#define PICTURE_WIDTH 900 /* pixels, approximately: a frame of a short clip gets several columns */
#define PICTURE_FRAMES 1800
#define SEPARATOR 6 /* pixels */

#define DECODER \
    "uridecodebin name=source ! videoconvert name=video ! " \
    "videoflip video-direction=auto ! video/x-raw, format=GRAY8 ! appsink name=frames sync=false max-buffers=4"
#define PNG_WRITER "appsrc name=picture ! pngenc snapshot=true ! filesink name=file"

typedef struct Corners {
    double x[4], y[4]; /* pixels */
} Corners;

/* One video and its measured shake. */
typedef struct Video {
    const char *path;
    L1L2Stab *stab;
    GstVideoInfo info;
    GByteArray *slits; /* the middle column of each frame */
    int frames;
    int lost;          /* number of frames whose motion could not be measured */
    Corners velocity;  /* of the frame before, pixels per frame */
    gboolean moving;   /* velocity is set */
    double sum;        /* sum of the squared accelerations over corners and frames */
    int count;         /* number of terms in sum */
    FILE *motion;      /* each frame's F_t is written to it; or NULL */
    gboolean failed;   /* an error was printed */
} Video;

/* A copy of a file name for a line of output: control characters, such as a newline, become question marks. */
static char *printable(const char *path)
{
    char *name = g_strdup(path);
    for (char *c = name; *c; c++)
        if (g_ascii_iscntrl(*c))
            *c = '?';
    return name;
}

/* Prints one line to stderr. Returns FALSE. */
static gboolean G_GNUC_PRINTF(2, 3) fail(const char *path, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *name = printable(path), *text = g_strdup_vprintf(format, args);
    va_end(args);
    g_printerr("measure-shake: %s: %s\n", name, text);
    g_free(text);
    g_free(name);
    return FALSE;
}

/* Runs a pipeline to its end. Returns FALSE if that was an error. */
static gboolean run(GstElement *pipeline, const char *path)
{
    GstBus *bus = gst_element_get_bus(pipeline);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    GstMessage *end = gst_bus_timed_pop_filtered(bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
    gst_element_set_state(pipeline, GST_STATE_NULL);

    const gboolean ok = GST_MESSAGE_TYPE(end) == GST_MESSAGE_EOS;
    if (!ok) {
        GError *error = NULL;
        gst_message_parse_error(end, &error, NULL);
        fail(path, "%s", error->message);
        g_clear_error(&error);
    }
    gst_message_unref(end);
    gst_object_unref(bus);
    return ok;
}

/* ---- the shake ---- */

static Corners corner_velocity(const double F[9], double width, double height)
{
    Corners v;
    for (int i = 0; i < 4; i++) {
        const double x = (i & 1 ? 0.5 : -0.5) * width, y = (i & 2 ? 0.5 : -0.5) * height;
        const double w = F[6] * x + F[7] * y + F[8];
        v.x[i] = (F[0] * x + F[1] * y + F[2]) / w - x;
        v.y[i] = (F[3] * x + F[4] * y + F[5]) / w - y;
    }
    return v;
}

static void add_motion(Video *video, const L1L2StabInfo *info)
{
    if (video->motion) {
        fprintf(video->motion, "%" G_GUINT64_FORMAT, info->index);
        for (int i = 0; i < 9; i++) { /* the decimal sign is a point in every locale */
            char number[G_ASCII_DTOSTR_BUF_SIZE];
            fprintf(video->motion, " %s", g_ascii_formatd(number, sizeof number, "%.12g", info->F[i]));
        }
        fputc('\n', video->motion);
    }
    video->lost += info->flags & L1L2STAB_INFO_MOTION_LOST ? 1 : 0;
    if (info->flags & (L1L2STAB_INFO_PATH_START | L1L2STAB_INFO_MOTION_LOST)) {
        video->moving = FALSE;
        return;
    }
    const Corners v = corner_velocity(info->F, video->info.width, video->info.height);
    for (int i = 0; i < 4 && video->moving; i++) {
        const double ax = v.x[i] - video->velocity.x[i], ay = v.y[i] - video->velocity.y[i];
        video->sum += ax * ax + ay * ay;
        video->count++;
    }
    video->velocity = v;
    video->moving = TRUE;
}

static double shake_of(const Video *video)
{
    return video->count ? sqrt(video->sum / video->count) * REFERENCE_WIDTH / video->info.width : 0.0;
}

/* ---- from GStreamer to the library ---- */

static void add_slit(Video *video, const GstVideoFrame *frame)
{
    const guint8 *column = (const guint8 *)GST_VIDEO_FRAME_PLANE_DATA(frame, 0) + GST_VIDEO_FRAME_WIDTH(frame) / 2;
    for (int y = 0; y < GST_VIDEO_FRAME_HEIGHT(frame); y++)
        g_byte_array_append(video->slits, column + (gssize)y * GST_VIDEO_FRAME_PLANE_STRIDE(frame, 0), 1);
}

/* The decoder's buffer stays mapped until the library releases the frame, so nothing is copied. */
static void release_frame(void *opaque)
{
    GstVideoFrame *frame = opaque;
    gst_video_frame_unmap(frame);
    g_free(frame);
}

static gboolean open_stabilizer(Video *video, GstCaps *caps)
{
    if (!gst_video_info_from_caps(&video->info, caps))
        return FALSE;

    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = video->info.width;
    cfg.height = video->info.height;
    cfg.window = WINDOW;
    if (video->motion)
        fprintf(video->motion, "# t, F_t: frame t to frame t-1, row-major, pixels, origin at the center of %dx%d\n",
                cfg.width, cfg.height);
    const L1L2StabResult r = l1l2stab_create(&video->stab, &cfg);
    return r == L1L2STAB_OK || fail(video->path, "%s", l1l2stab_strerror(r));
}

static L1L2StabResult drain(Video *video)
{
    L1L2StabInfo info;
    L1L2StabResult r;
    while ((r = l1l2stab_pull(video->stab, NULL, &info)) == L1L2STAB_OK)
        add_motion(video, &info);
    return r;
}

static gboolean push_sample(Video *video, GstSample *sample)
{
    if (!video->stab && !open_stabilizer(video, gst_sample_get_caps(sample)))
        return FALSE;

    GstVideoFrame *frame = g_new0(GstVideoFrame, 1);
    if (!gst_video_frame_map(frame, &video->info, gst_sample_get_buffer(sample), GST_MAP_READ)) {
        g_free(frame);
        return fail(video->path, "a frame cannot be read");
    }
    if (video->frames++ < PICTURE_FRAMES)
        add_slit(video, frame);

    L1L2StabFrame in = {
        .data = {GST_VIDEO_FRAME_PLANE_DATA(frame, 0)},
        .stride = {GST_VIDEO_FRAME_PLANE_STRIDE(frame, 0)},
        .opaque = frame,
        .release = release_frame,
    };
    L1L2StabResult r = l1l2stab_push(video->stab, &in);
    if (r != L1L2STAB_OK)
        release_frame(frame);
    else
        r = drain(video);
    return r >= 0 || fail(video->path, "%s", l1l2stab_strerror(r));
}

/* In the streaming thread. */
static GstFlowReturn on_sample(GstAppSink *sink, gpointer data)
{
    Video *video = data;
    GstSample *sample = gst_app_sink_pull_sample(sink);
    if (sample && !push_sample(video, sample)) {
        GST_ELEMENT_ERROR(sink, LIBRARY, FAILED, ("the measurement failed"), (NULL));
        video->failed = TRUE;
    }
    g_clear_pointer(&sample, gst_sample_unref);
    return video->failed ? GST_FLOW_ERROR : GST_FLOW_OK;
}

/* Without video the sink would receive neither a frame nor the end of the stream. */
static void on_no_more_pads(GstElement *source, gpointer data)
{
    GstPad *pad = gst_element_get_static_pad(data, "sink");
    if (!gst_pad_is_linked(pad))
        GST_ELEMENT_ERROR(source, STREAM, DECODE, ("it has no video that the installed decoders support"), (NULL));
    gst_object_unref(pad);
}

static gboolean measure_stream(Video *video, GstElement *pipeline, const char *uri)
{
    GstElement *source = gst_bin_get_by_name(GST_BIN(pipeline), "source");
    GstElement *convert = gst_bin_get_by_name(GST_BIN(pipeline), "video");
    GstElement *sink = gst_bin_get_by_name(GST_BIN(pipeline), "frames");
    GstAppSinkCallbacks callbacks = {.new_sample = on_sample};

    g_object_set(source, "uri", uri, NULL);
    g_signal_connect(source, "no-more-pads", G_CALLBACK(on_no_more_pads), convert);
    gst_app_sink_set_callbacks(GST_APP_SINK(sink), &callbacks, video, NULL);
    gboolean ok = run(pipeline, video->path);
    if (ok && video->stab && (l1l2stab_finish(video->stab) != L1L2STAB_OK || drain(video) != L1L2STAB_EOS))
        ok = fail(video->path, "the measurement failed");
    l1l2stab_free(&video->stab);

    gst_object_unref(sink);
    gst_object_unref(convert);
    gst_object_unref(source);
    return ok && (video->frames > 0 || fail(video->path, "it has no video"));
}

static gboolean measure(Video *video)
{
    GError *error = NULL;
    GstElement *pipeline = gst_parse_launch_full(DECODER, NULL, GST_PARSE_FLAG_FATAL_ERRORS, &error);
    char *uri = pipeline ? gst_filename_to_uri(video->path, &error) : NULL;
    gboolean ok = FALSE;

    if (!uri) {
        fail(video->path, "%s", error->message);
        g_clear_error(&error);
    } else {
        video->slits = g_byte_array_new();
        ok = measure_stream(video, pipeline, uri);
    }
    g_free(uri);
    g_clear_object(&pipeline);
    return ok;
}

/* ---- the picture ---- */

static void paint(GstVideoFrame *picture, int top, const Video *video, int frames, int columns)
{
    const gssize stride = GST_VIDEO_FRAME_PLANE_STRIDE(picture, 0);
    const int height = video->info.height;
    for (int y = 0; y < height; y++) {
        guint8 *row = (guint8 *)GST_VIDEO_FRAME_PLANE_DATA(picture, 0) + (top + y) * stride;
        for (int t = 0; t < frames; t++)
            memset(row + (gssize)t * columns, video->slits->data[(gssize)t * height + y], (size_t)columns);
    }
}

static GstBuffer *make_picture(const Video *a, const Video *b, GstVideoInfo *info)
{
    const int frames = MIN(PICTURE_FRAMES, MIN(a->frames, b->frames));
    const int columns = MAX(1, PICTURE_WIDTH / frames);
    gst_video_info_set_format(info, GST_VIDEO_FORMAT_GRAY8, (guint)(frames * columns),
                              (guint)(a->info.height + SEPARATOR + b->info.height));

    GstBuffer *buffer = gst_buffer_new_allocate(NULL, GST_VIDEO_INFO_SIZE(info), NULL);
    GstVideoFrame picture;
    gst_buffer_memset(buffer, 0, 255, GST_VIDEO_INFO_SIZE(info));
    if (gst_video_frame_map(&picture, info, buffer, GST_MAP_READWRITE)) {
        paint(&picture, 0, a, frames, columns);
        paint(&picture, a->info.height + SEPARATOR, b, frames, columns);
        gst_video_frame_unmap(&picture);
    }
    return buffer;
}

static gboolean write_picture(const char *path, const Video *a, const Video *b)
{
    GError *error = NULL;
    GstElement *pipeline = gst_parse_launch_full(PNG_WRITER, NULL, GST_PARSE_FLAG_FATAL_ERRORS, &error);
    if (!pipeline) {
        fail(path, "%s", error->message);
        g_clear_error(&error);
        return FALSE;
    }
    GstElement *source = gst_bin_get_by_name(GST_BIN(pipeline), "picture");
    GstElement *file = gst_bin_get_by_name(GST_BIN(pipeline), "file");
    GstVideoInfo info;
    GstBuffer *picture = make_picture(a, b, &info);
    GstCaps *caps = gst_video_info_to_caps(&info);
    g_object_set(file, "location", path, NULL);
    g_object_set(source, "caps", caps, NULL);
    gst_caps_unref(caps);

    gst_app_src_push_buffer(GST_APP_SRC(source), picture);
    gst_app_src_end_of_stream(GST_APP_SRC(source));
    const gboolean ok = run(pipeline, path);
    gst_object_unref(file);
    gst_object_unref(source);
    gst_object_unref(pipeline);
    return ok;
}

static void print_shake(const Video *video)
{
    char *name = printable(video->path);
    g_print("%s: %.3f px\n", name, shake_of(video));
    if (video->lost > 0)
        g_printerr("%s: the motion of %d of %d frames could not be measured\n", name, video->lost, video->frames);
    g_free(name);
}

/* An output that is one of the inputs would destroy it. */
static gboolean is_input(const char *output, const char *const inputs[2])
{
    GStatBuf out, in;
    for (int i = 0; i < 2; i++)
        if (output && inputs[i] && g_stat(output, &out) == 0 && g_stat(inputs[i], &in) == 0 &&
            out.st_dev == in.st_dev && out.st_ino == in.st_ino)
            return !fail(output, "is an input too, and will not be overwritten");
    return FALSE;
}

int main(int argc, char **argv)
{
    char *picture = NULL, *motion = NULL;
    const GOptionEntry options[] = {
        {"picture", 0, 0, G_OPTION_ARG_FILENAME, &picture, "Write a slit scan of A above that of B", "OUT.png"},
        {"motion", 0, 0, G_OPTION_ARG_FILENAME, &motion, "Write the measured motion of A, for smooth-path", "OUT.txt"},
        G_OPTION_ENTRY_NULL};
    GOptionContext *context = g_option_context_new("A [B]");
    g_option_context_add_main_entries(context, options, NULL);
    g_option_context_add_group(context, gst_init_get_option_group());
    const gboolean parsed = g_option_context_parse(context, &argc, &argv, NULL);
    g_option_context_free(context);
    if (!parsed || argc < 2 || argc > 3 || (picture && argc < 3)) {
        g_printerr("usage: measure-shake [--picture=OUT.png] [--motion=OUT.txt] A [B]\n");
        return EXIT_USAGE;
    }

    const char *const inputs[2] = {argv[1], argv[2]}; /* argv[argc] is NULL */
    Video videos[2] = {{.path = inputs[0]}, {.path = inputs[1]}};
    gboolean ok = !is_input(picture, inputs) && !is_input(motion, inputs);
    if (ok && motion && !(videos[0].motion = fopen(motion, "w")))
        ok = fail(motion, "cannot be written");
    for (int i = 0; i < argc - 1 && ok; i++) {
        ok = measure(&videos[i]);
        if (ok)
            print_shake(&videos[i]);
    }
    if (ok && argc == 3 && shake_of(&videos[0]) > 0)
        g_print("ratio: %.4f\n", shake_of(&videos[1]) / shake_of(&videos[0]));
    if (ok && picture)
        ok = write_picture(picture, &videos[0], &videos[1]);

    if (videos[0].motion && fclose(videos[0].motion) != 0)
        ok = fail(motion, "cannot be written");
    for (int i = 0; i < 2; i++)
        if (videos[i].slits)
            g_byte_array_unref(videos[i].slits);
    g_free(picture);
    g_free(motion);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
